// A surface in a studio of soft lights that go with the camera, and lines and backdrop around it.

struct Frame {
    // From places seen from the eye (world axes) to clip space; depth is reversed: 1 at the near plane, 0 at infinity.
    clip: mat4x4<f32>,
    // Where the eye is; w: pixels that a unit of length takes at distance 1.
    eye: vec4<f32>,
    // The picture's axes in the world; right.w: the tolerance in pixels.
    right: vec4<f32>,
    up: vec4<f32>,
    forward: vec4<f32>,
    // Linear colours at the top and at the foot.
    top: vec4<f32>,
    foot: vec4<f32>,
    // x: what colours the surface; y: 1 for one normal a triangle.
    mode: vec4<u32>,
}

const MATERIAL = 0u;
const LEVEL = 1u;
const ERROR = 2u;
const NORMAL = 3u;
const TEXTURE = 4u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var smooth_sampler: sampler;
@group(0) @binding(2) var scale: texture_2d<f32>;
@group(1) @binding(0) var picture: texture_2d<f32>;
@group(1) @binding(1) var picture_sampler: sampler;
// In tangent space; a single texel: none.
@group(1) @binding(2) var normal_map: texture_2d<f32>;

struct Corner {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    // Level and error.
    @location(3) detail: vec2<f32>,
    @location(4) row_x: vec4<f32>,
    @location(5) row_y: vec4<f32>,
    @location(6) row_z: vec4<f32>,
    @location(7) colour: vec4<f32>,
    // Where the corner moves to, and how far it is: share 0 unless the card moves vertices.
    @location(8) target_position: vec3<f32>,
    @location(9) target_normal: vec3<f32>,
    @location(10) target_uv: vec2<f32>,
    @location(11) target_detail: vec2<f32>,
    @location(12) first_moving: u32,
    @location(13) share: f32,
}

struct Point {
    @builtin(position) clip: vec4<f32>,
    // From the eye, world axes. At the middle of the pixel, so that its derivatives are those of the plane.
    @location(0) offset: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal: vec3<f32>,
    @location(2) @interpolate(perspective, centroid) uv: vec2<f32>,
    @location(3) @interpolate(perspective, centroid) detail: vec2<f32>,
    @location(4) @interpolate(flat) colour: vec4<f32>,
    // The texture coordinates at the middle of the pixel, for derivatives.
    @location(5) uv_at_middle: vec2<f32>,
}

fn place(index: u32, corner: Corner) -> Point {
    // multires::gmesh::MORPH_WGSL, which is appended.
    let share = multires_morph_share(index, corner.first_moving, corner.share);
    let at = vec4(multires_morph3(corner.position, corner.target_position, share), 1.0);
    let normal = multires_morph3(corner.normal, corner.target_normal, share);
    let detail = multires_morph2(corner.detail, corner.target_detail, share);
    let world = vec3(dot(corner.row_x, at), dot(corner.row_y, at), dot(corner.row_z, at));
    var point: Point;
    point.offset = world - frame.eye.xyz;
    point.clip = frame.clip * vec4(point.offset, 1.0);
    point.normal = vec3(
        dot(corner.row_x.xyz, normal),
        dot(corner.row_y.xyz, normal),
        dot(corner.row_z.xyz, normal),
    );
    point.uv = multires_morph2(corner.uv, corner.target_uv, share);
    point.uv_at_middle = point.uv;
    // The error in world units.
    point.detail = vec2(detail.x, detail.y * length(corner.row_x.xyz));
    point.colour = corner.colour;
    return point;
}

@vertex
fn surface_corner(@builtin(vertex_index) index: u32, corner: Corner) -> Point {
    return place(index, corner);
}

// The same a little nearer, to lie on top of the surface.
@vertex
fn overlay_corner(@builtin(vertex_index) index: u32, corner: Corner) -> Point {
    var point = place(index, corner);
    point.clip.z *= 1.0005;
    return point;
}

fn unit_or(v: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let square = dot(v, v);
    if square > 1e-20 {
        return v * inverseSqrt(square);
    }
    return other;
}

fn soft(normal: vec3<f32>, light: vec3<f32>, wrap: f32) -> f32 {
    return max((dot(normal, light) + wrap) / (1.0 + wrap), 0.0);
}

fn gloss(normal: vec3<f32>, light: vec3<f32>, ray: vec3<f32>, power: f32) -> f32 {
    return pow(max(dot(normal, normalize(light - ray)), 0.0), power);
}

fn towards(x: f32, y: f32, z: f32) -> vec3<f32> {
    return normalize(frame.right.xyz * x + frame.up.xyz * y - frame.forward.xyz * z);
}

// Key from above the left shoulder, fill from the right, rim from behind; sky above and ground below.
fn lit(base: vec3<f32>, normal: vec3<f32>, ray: vec3<f32>) -> vec3<f32> {
    let key = towards(-0.55, 0.75, 0.65);
    let fill = towards(0.9, 0.05, 0.55);
    let rim = towards(0.35, 0.65, -0.75);
    let sky = 0.5 + 0.5 * dot(normal, frame.up.xyz);
    let grazing = clamp(1.0 + dot(normal, ray), 0.0, 1.0);
    let ambient = mix(vec3(0.13, 0.125, 0.12), vec3(0.37, 0.40, 0.45), sky);
    let direct = vec3(1.0, 0.975, 0.94) * (1.12 * pow(soft(normal, key, 0.1), 1.3))
        + vec3(0.72, 0.84, 1.0) * (0.22 * soft(normal, fill, 0.3));
    let outline = vec3(0.95, 0.98, 1.0) * (0.55 * soft(normal, rim, 0.0) * grazing * grazing);
    let shine = 0.10 * gloss(normal, key, ray, 48.0) + 0.03 * gloss(normal, fill, ray, 24.0);
    return base * (ambient + direct + outline * 0.6) + outline * 0.12 + vec3(shine);
}

// A colour of the scale from 0 to 1.
fn on_scale(t: f32) -> vec3<f32> {
    let across = (0.5 + clamp(t, 0.0, 1.0) * 255.0) / 256.0;
    return textureSampleLevel(scale, smooth_sampler, vec2(across, 0.5), 0.0).rgb;
}

// The normal of the map about a normal, by how places and texture coordinates change over the picture: u runs along the tangent, v
// against the bitangent, as in glTF.
fn bumped(
    normal: vec3<f32>,
    texel: vec3<f32>,
    place_x: vec3<f32>,
    place_y: vec3<f32>,
    uv_x: vec2<f32>,
    uv_y: vec2<f32>,
) -> vec3<f32> {
    let turn = sign(uv_x.x * uv_y.y - uv_x.y * uv_y.x);
    let along_u = turn * (place_x * uv_y.y - place_y * uv_x.y);
    let along_v = turn * (place_y * uv_x.x - place_x * uv_y.x);
    let tangent = unit_or(along_u - normal * dot(along_u, normal), vec3(0.0));
    let down = along_v - normal * dot(along_v, normal);
    let bitangent = unit_or(tangent * dot(down, tangent) - down, vec3(0.0));
    let n = 2.0 * texel - 1.0;
    return unit_or(tangent * n.x + bitangent * n.y + normal * n.z, normal);
}

// What back faces look like, so that flipped triangles and open insides are seen.
const BACK = vec3(0.434154, 0.187821, 0.138432);

@fragment
fn surface(point: Point, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    let ray = normalize(point.offset);
    // Derivatives and samples before anything depends on the pixel.
    var flat = unit_or(cross(dpdx(point.offset), dpdy(point.offset)), -ray);
    let painted = textureSample(picture, picture_sampler, point.uv).rgb;
    let texel = textureSample(normal_map, picture_sampler, point.uv).xyz;
    let place_x = dpdx(point.offset);
    let place_y = dpdy(point.offset);
    let uv_x = dpdx(point.uv_at_middle);
    let uv_y = dpdy(point.uv_at_middle);
    if dot(flat, ray) > 0.0 {
        flat = -flat;
    }
    var normal = flat;
    if frame.mode.y == 0u {
        normal = unit_or(point.normal, vec3(0.0));
        if !front {
            normal = -normal;
        }
        if dot(normal, normal) == 0.0 {
            normal = flat;
        }
        let shows_map = frame.mode.x == TEXTURE || frame.mode.x == NORMAL;
        if shows_map && textureDimensions(normal_map).x > 1u {
            normal = bumped(normal, texel, place_x, place_y, uv_x, uv_y);
        }
        // Where the triangle is seen and its smooth normal points away: the nearest that does not.
        let away = dot(normal, ray);
        if away > 0.0 {
            normal = unit_or(normal - ray * away, flat);
        }
    }
    var base = point.colour.rgb;
    switch frame.mode.x {
        case LEVEL: { base = on_scale(point.detail.x); }
        case ERROR: {
            // In tolerances, by octaves: the middle of the scale is one.
            let pixels = point.detail.y * frame.eye.w / max(length(point.offset), 1e-20);
            base = on_scale(0.5 + log2(max(pixels / max(frame.right.w, 1e-6), 1e-6)) / 8.0);
        }
        case NORMAL: { return vec4(pow(0.5 + 0.5 * normal, vec3(2.2)), 1.0); }
        case TEXTURE: { base = painted; }
        default: {}
    }
    if !front && frame.mode.x != LEVEL && frame.mode.x != ERROR {
        base = BACK;
    }
    return vec4(lit(base, normal, ray), 1.0);
}

// One colour, faded where it does not face the eye.
@fragment
fn overlay(point: Point) -> @location(0) vec4<f32> {
    return point.colour;
}

struct Backdrop {
    @builtin(position) clip: vec4<f32>,
    @location(0) down: f32,
}

@vertex
fn backdrop_corner(@builtin(vertex_index) index: u32) -> Backdrop {
    let corner = vec2(f32((index << 1u) & 2u), f32(index & 2u));
    // At depth 0: behind everything.
    return Backdrop(vec4(corner * 2.0 - 1.0, 0.0, 1.0), 1.0 - corner.y);
}

@fragment
fn backdrop(at: Backdrop) -> @location(0) vec4<f32> {
    // Opacity 0, so that a picture says what of it is surface.
    return vec4(mix(frame.top.rgb, frame.foot.rgb, at.down), 0.0);
}

struct Line {
    @builtin(position) clip: vec4<f32>,
    @location(0) colour: vec4<f32>,
}

@vertex
fn line_end(@location(0) position: vec3<f32>, @location(1) colour: vec4<f32>) -> Line {
    return Line(frame.clip * vec4(position - frame.eye.xyz, 1.0), colour);
}

@fragment
fn line(at: Line) -> @location(0) vec4<f32> {
    return at.colour;
}
