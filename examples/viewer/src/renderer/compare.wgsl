// Pictures on a window: one as it is, the difference of two, or how far apart their surfaces lie.

@group(0) @binding(0) var first: texture_2d<f32>;
@group(0) @binding(1) var second: texture_2d<f32>;
// Reversed: 0 is infinitely far away. One sample of several is enough.
@group(0) @binding(0) var first_depth: texture_depth_multisampled_2d;
@group(0) @binding(1) var second_depth: texture_depth_multisampled_2d;
@group(0) @binding(2) var<uniform> gain: vec4<f32>;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let corner = vec2(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0), corner);
}

fn pixel(image: texture_2d<f32>, at: vec2<f32>) -> vec4<f32> {
    let size = textureDimensions(image);
    let place = min(vec2<u32>(at * vec2<f32>(size)), size - 1u);
    return textureLoad(image, place, 0);
}

// Light as sRGB, and back.
fn encoded(c: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, c <= vec3(0.0031308));
}

fn linear(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
}

// For a window whose bytes are taken as they are, and for one that turns light into sRGB by itself.
@fragment
fn show_bytes(in: Corner) -> @location(0) vec4<f32> {
    return vec4(encoded(pixel(first, in.at).rgb), 1.0);
}

@fragment
fn show_light(in: Corner) -> @location(0) vec4<f32> {
    return vec4(pixel(first, in.at).rgb, 1.0);
}

// Grey where the pictures agree, brighter the more they differ; where only one shows a surface, red or blue.
fn difference(at: vec2<f32>) -> vec3<f32> {
    let a = pixel(first, at);
    let b = pixel(second, at);
    let apart = abs(encoded(a.rgb) - encoded(b.rgb));
    let most = max(apart.r, max(apart.g, apart.b));
    return shown(8.0 * most, a.a, b.a);
}

// By the shares of a pixel that show a surface.
fn shown(apart: f32, a: f32, b: f32) -> vec3<f32> {
    if a - b > 0.5 { return vec3(0.95, 0.25, 0.2); }
    if b - a > 0.5 { return vec3(0.25, 0.5, 1.0); }
    return vec3(0.06 + 0.08 * b) + vec3(1.0, 0.82, 0.35) * min(apart, 1.0) * 0.85;
}

// The same of distances along the view, as they are seen from the nearer surface.
fn distances(at: vec2<f32>) -> vec3<f32> {
    let size = textureDimensions(first_depth);
    let place = min(vec2<u32>(at * vec2<f32>(size)), size - 1u);
    let a = textureLoad(first_depth, place, 0);
    let b = textureLoad(second_depth, place, 0);
    let apart = select(0.0, abs(a - b) / min(a, b), min(a, b) > 0.0);
    return shown(gain.x * apart, select(0.0, 1.0, a > 0.0), select(0.0, 1.0, b > 0.0));
}

@fragment
fn difference_bytes(in: Corner) -> @location(0) vec4<f32> {
    return vec4(difference(in.at), 1.0);
}

@fragment
fn difference_light(in: Corner) -> @location(0) vec4<f32> {
    return vec4(linear(difference(in.at)), 1.0);
}

@fragment
fn distance_bytes(in: Corner) -> @location(0) vec4<f32> {
    return vec4(distances(in.at), 1.0);
}

@fragment
fn distance_light(in: Corner) -> @location(0) vec4<f32> {
    return vec4(linear(distances(in.at)), 1.0);
}
