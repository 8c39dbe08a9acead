//! Promise: a texture baked into the atlas of a remesh shows what the mesh shows, on every side of a seam, without colours
//! that bleed; a normal map gives the mesh's normals.

use crate::support::{self, distance, map, models, remesh, weights};
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::remesh::{BakedTexture, NormalSpace, Parameterisation, RemeshError, Texture};
use multires::wavelet::{Atlas, AtlasOptions, ChartSize, DomainPoint, WaveletError};

fn atlas(map: &Parameterisation, mesh: &Mesh, resolution: u32) -> Atlas {
    let options = AtlasOptions::default().with_resolution(resolution).with_gutter(2);
    Atlas::new(&remesh(map, mesh, 1), &options).unwrap()
}

/// Colours of a checkerboard of `n` by `n` fields, different in every field.
fn field(n: u32, x: u32, y: u32) -> [u8; 4] {
    let odd = (x + y) % 2 == 1;
    [(x * 200 / n + 20) as u8, (y * 200 / n + 20) as u8, if odd { 250 } else { 10 }, 255]
}

fn checker(n: u32, texels: u32) -> Vec<[u8; 4]> {
    let field = |i: u32| field(n, i % texels * n / texels, i / texels * n / texels);
    (0..texels * texels).map(field).collect()
}

fn uv_at(mesh: &Mesh, point: &multires::mesh::MeshPoint) -> [f64; 2] {
    let uv = mesh.attribute(names::UV).unwrap().as_floats().unwrap();
    let corners = mesh.triangles()[point.triangle as usize];
    std::array::from_fn(|i| {
        (0..3).map(|k| point.barycentric[k] * f64::from(uv[2 * corners[k] as usize + i])).sum()
    })
}

fn bake_checker(map: &Parameterisation, mesh: &Mesh, atlas: &Atlas, source: Texture<'_>) -> BakedTexture {
    let most = mesh.materials().iter().max().map_or(1, |&most| most as usize + 1);
    map.bake_texture(mesh, atlas, &vec![source; most]).unwrap()
}

#[test]
fn a_texture_is_read_as_gltf_reads_it() {
    let texels = [[0, 0, 0, 255], [200, 0, 0, 255], [0, 100, 0, 255], [200, 100, 40, 255]];
    let texture = Texture::new(2, 2, &texels).unwrap();
    assert_eq!((texture.size(), texture.texels()), ([2, 2], texels.as_slice()));
    // Centres of texels: the first row is at the top, where v is small.
    assert_eq!(texture.at([0.25, 0.25]), [0.0, 0.0, 0.0, 255.0]);
    assert_eq!(texture.at([0.75, 0.25]), [200.0, 0.0, 0.0, 255.0]);
    assert_eq!(texture.at([0.25, 0.75]), [0.0, 100.0, 0.0, 255.0]);
    // Between, and across the border.
    assert_eq!(texture.at([0.5, 0.5]), [100.0, 50.0, 10.0, 255.0]);
    assert_eq!(texture.at([0.5, 0.25]), [100.0, 0.0, 0.0, 255.0]);
    assert_eq!(texture.at([0.0, 0.25]), [100.0, 0.0, 0.0, 255.0]);
    for [u, v] in [[0.31, 0.77], [0.02, 0.99], [0.5, 0.0]] {
        let near = |a: [f64; 4], b: [f64; 4]| (0..4).all(|k| (a[k] - b[k]).abs() < 1e-9);
        assert!(near(texture.at([u, v]), texture.at([u + 3.0, v - 2.0])), "repeats");
    }
    assert_eq!(texture.at([f64::NAN, f64::INFINITY]), texture.at([0.0, 0.0]));
    assert_eq!(texture.at([-1e-30, 1e300]), texture.at([0.0, 0.0]));
    assert!(Texture::new(2, 3, &texels).is_err());
    assert!(Texture::new(0, 0, &[]).is_err());
    assert!(Texture::new(u32::MAX, u32::MAX, &texels).is_err());
}

#[test]
fn a_checkerboard_keeps_its_colours() {
    let mut textured = 0;
    for (name, mesh, faces) in models() {
        if mesh.attribute(names::UV).is_none() {
            continue;
        }
        textured += 1;
        let map = map(&mesh, faces);
        let (n, texels) = (8, 512);
        let source = checker(n, texels);
        let source = Texture::new(texels, texels, &source).unwrap();
        let charts = map.base().triangles().len() as u32;
        let atlas = atlas(&map, &mesh, 64 * (charts.isqrt() + 1));
        let baked = bake_checker(&map, &mesh, &atlas, source);
        assert_eq!((baked.width, baked.height), (atlas.resolution(), atlas.resolution()));
        assert!(baked.filled > atlas.coverage() && baked.filled <= 1.0, "{name}: {}", baked.filled);
        let view = baked.view().unwrap();
        let (mut seen, mut wrong) = (0, 0);
        for face in 0..charts {
            for sample in 0..80 {
                let place = DomainPoint::new(face, weights(u64::from(face), sample));
                let uv = uv_at(&mesh, &map.to_mesh(&place).unwrap());
                let expected = source.at(uv);
                // Away from borders of fields, a point is the colour of its field.
                let pure = (0..4).all(|corner| {
                    let [x, y] =
                        [corner & 1, corner >> 1].map(|i| 0.15 / f64::from(n) * (2.0 * f64::from(i) - 1.0));
                    source.at([uv[0] + x, uv[1] + y]) == expected
                });
                if pure {
                    seen += 1;
                    let found = view.at(atlas.uv(&place).unwrap());
                    wrong += usize::from((0..4).any(|k| (found[k] - expected[k]).abs() > 1.0));
                }
            }
        }
        println!("{name}: {wrong} of {seen} points differ; {:.2} of texels filled", baked.filled);
        // Texels of the bake are larger or smaller than those of the source: few points are within a texel of a border.
        assert!(seen > 200 && wrong * 50 < seen, "{name}: {wrong} of {seen}");
    }
    assert!(textured >= 8);
}

#[test]
fn smooth_pictures_are_shown_as_before_up_to_the_edges_of_charts() {
    // Colours are linear in space, so a texel is all that bilinear filters can miss; bleeding from other charts, or from
    // what is outside charts, would be seen.
    for (name, mesh, faces) in models() {
        let [low, high] = mesh.bounds().unwrap();
        let size = (0..3).map(|i| high[i] - low[i]).fold(0.0, f32::max);
        let colours: Vec<[f32; 3]> = mesh
            .positions()
            .iter()
            .map(|p| std::array::from_fn(|i| 0.25 + 0.5 * (p[i] - low[i]) / size))
            .collect();
        if mesh.attribute(names::COLOR).is_some() {
            continue;
        }
        let mesh = mesh.with_attribute(Attribute::floats(names::COLOR, &colours)).unwrap();
        let map = map(&mesh, faces);
        let charts = map.base().triangles().len() as u32;
        let atlas = atlas(&map, &mesh, 28 * (charts.isqrt() + 1));
        let baked = map.bake_colours(&mesh, &atlas).unwrap();
        let view = baked.view().unwrap();
        let mut worst = 0.0f64;
        for face in 0..charts {
            // The largest step between texels of the chart: its size over the texels of a leg.
            let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
                .map(|w| atlas.uv(&DomainPoint::new(face, w)).unwrap());
            let leg = (0..3)
                .map(|k| (0..2).map(|i| (corners[k][i] - corners[(k + 1) % 3][i]).abs()).fold(0.0, f64::max))
                .fold(0.0, f64::max)
                * f64::from(atlas.resolution());
            for sample in 0..60 {
                let place = DomainPoint::new(face, weights(u64::from(face), sample));
                let p = support::at(&mesh, &map.to_mesh(&place).unwrap());
                let found = view.at(atlas.uv(&place).unwrap());
                assert!((found[3] - 255.0).abs() < 1e-9, "{name}: {place:?} is mixed with what is outside");
                for i in 0..3 {
                    let expected = 255.0 * (0.25 + 0.5 * (p[i] - f64::from(low[i])) / f64::from(size));
                    worst = worst.max((found[i] - expected).abs() * leg / 255.0);
                }
            }
        }
        println!("{name}: {worst:.2} of a chart's range a texel");
        assert!(worst < 4.0, "{name}: {worst}");
    }
}

#[test]
fn materials_have_their_own_textures() {
    let mesh = shapes::prop(10);
    let map = map(&mesh, 150);
    let atlas = atlas(&map, &mesh, 512);
    let plain: Vec<[[u8; 4]; 1]> = (0..2).map(|m| [[10 + 100 * m, 77, 0, 255]]).collect();
    let textures: Vec<Texture> = plain.iter().map(|texel| Texture::new(1, 1, texel).unwrap()).collect();
    let baked = map.bake_texture(&mesh, &atlas, &textures).unwrap();
    let view = baked.view().unwrap();
    for (face, &material) in (0..).zip(map.base().materials()) {
        let found = view.at(atlas.uv(&DomainPoint::new(face, [0.2, 0.3, 0.5])).unwrap());
        assert_eq!(found, plain[material as usize][0].map(f64::from), "face {face}");
    }
    // A material without a texture stays empty.
    let some = map.bake_texture(&mesh, &atlas, &textures[..1]).unwrap();
    assert!(some.filled < baked.filled);
    assert_eq!(map.bake_texture(&mesh, &atlas, &[]).unwrap().filled, 0.0);
    assert!(some.texels.iter().all(|texel| [[10, 77, 0, 255], [0; 4]].contains(texel)));
}

fn unit(n: [f64; 3]) -> [f64; 3] {
    n.map(|x| x / distance(n, [0.0; 3]))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Shades a textured level as glTF asks for, at random points: returns position, shading normal, and the level's own.
fn shaded(level: &Mesh, baked: &BakedTexture, each: u64) -> Vec<[[f64; 3]; 3]> {
    let read = |name: &str, v: u32, i: usize| {
        let attribute = level.attribute(name).unwrap();
        f64::from(attribute.as_floats().unwrap()[v as usize * attribute.width() + i])
    };
    let view = baked.view().unwrap();
    let mut all = Vec::new();
    for (t, corners) in level.triangles().iter().enumerate() {
        for sample in 0..each {
            let weights = weights(t as u64, sample);
            let mix = |value: &dyn Fn(u32, usize) -> f64, i: usize| -> f64 {
                (0..3).map(|k| weights[k] * value(corners[k], i)).sum()
            };
            let vector =
                |name: &str| -> [f64; 3] { std::array::from_fn(|i| mix(&|v, i| read(name, v, i), i)) };
            let position =
                std::array::from_fn(|i| mix(&|v, i| f64::from(level.positions()[v as usize][i]), i));
            let (n, t, w) =
                (vector(names::NORMAL), vector(names::TANGENT), read(names::TANGENT, corners[0], 3));
            assert!(w.abs() == 1.0 && corners.iter().all(|&v| read(names::TANGENT, v, 3) == w));
            let uv = std::array::from_fn(|i| mix(&|v, i| read(names::UV, v, i), i));
            let b = cross(n, t).map(|x| w * x);
            let texel = view.at(uv).map(|x| x / 127.5 - 1.0);
            let shading = std::array::from_fn(|i| texel[0] * t[i] + texel[1] * b[i] + texel[2] * n[i]);
            all.push([position, unit(shading), unit(n)]);
        }
    }
    all
}

fn degrees(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum::<f64>().clamp(-1.0, 1.0).acos().to_degrees()
}

/// A sphere with its normals, smooth.
fn sphere(levels: u32) -> Mesh {
    let sphere = shapes::icosphere(levels);
    let normals = sphere.positions().to_vec();
    sphere.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap()
}

#[test]
fn a_normal_map_over_an_icosahedron_is_a_sphere() {
    let mesh = sphere(5);
    // Eleven vertices or so, as the icosahedron.
    let map = map(&mesh, 20);
    assert_eq!(map.base().triangles().len(), 20);
    let atlas = atlas(&map, &mesh, 512);
    for level in [0, 1, 2] {
        let baked = map.bake_normals(&mesh, &atlas, NormalSpace::Tangent { level }).unwrap();
        assert_eq!(baked.mesh.triangles().len(), 20 << (2 * level));
        // The normal of the sphere at the place's own point.
        let of = remesh(&map, &mesh, level).with_atlas(&atlas).unwrap();
        let of = of.subdivision();
        let faces = of.faces_of(level);
        let mut worst = [0.0f64; 2];
        let points = shaded(&baked.mesh, &baked.texture, 40);
        for (t, face) in faces.enumerate() {
            let corners = of.domain_of_face(face).unwrap();
            for sample in 0..40 {
                let w = weights(t as u64, sample);
                let place = std::array::from_fn(|i| (0..3).map(|k| w[k] * corners[k].barycentric[i]).sum());
                let place = DomainPoint::new(corners[0].base_face, place);
                let truth = unit(support::at(&mesh, &map.to_mesh(&place).unwrap()));
                let [_, shading, flat] = points[40 * t + sample as usize];
                worst[0] = worst[0].max(degrees(shading, truth));
                worst[1] = worst[1].max(degrees(flat, truth));
            }
        }
        println!("level {level}: {:.2} degrees with the map, {:.2} without", worst[0], worst[1]);
        assert!(worst[0] < 1.5, "level {level}: {} degrees", worst[0]);
        assert!(level > 0 || worst[1] > 3.0);
    }
}

#[test]
fn normal_maps_of_all_shapes_give_their_normals() {
    for (name, mesh, faces) in models() {
        let map = map(&mesh, faces);
        let charts = map.base().triangles().len() as u32;
        let atlas = atlas(&map, &mesh, 28 * (charts.isqrt() + 1));
        let object = map.bake_normals(&mesh, &atlas, NormalSpace::Object).unwrap();
        let tangent = map.bake_normals(&mesh, &atlas, NormalSpace::Tangent { level: 2 }).unwrap();
        assert!(object.texture.filled == tangent.texture.filled && object.texture.filled > 0.3, "{name}");
        let of = remesh(&map, &mesh, 2).with_atlas(&atlas).unwrap();
        assert_eq!(tangent.mesh.positions(), of.vertices().positions(), "{name}");
        assert_eq!(tangent.mesh.materials().is_empty(), mesh.materials().is_empty(), "{name}");
        let view = object.texture.view().unwrap();
        let level = &tangent.mesh;
        let points = shaded(level, &tangent.texture, 6);
        let uv = level.attribute(names::UV).unwrap().as_floats().unwrap();
        let (mut turned, mut seen) = (0, 0);
        for (i, [_, shading, flat]) in points.iter().enumerate() {
            let (t, w) = (i / 6, weights((i / 6) as u64, (i % 6) as u64));
            let corners = level.triangles()[t];
            let at = std::array::from_fn(|i| {
                (0..3).map(|k| w[k] * f64::from(uv[2 * corners[k] as usize + i])).sum()
            });
            let texel = view.at(at).map(|x| x / 127.5 - 1.0);
            let truth = [texel[0], texel[1], texel[2]];
            // Between texels of different normals neither map is exact, and no map gives a normal that faces away.
            if distance(truth, [0.0; 3]) > 0.99 && degrees(unit(truth), *flat) < 80.0 {
                seen += 1;
                turned += usize::from(degrees(*shading, unit(truth)) > 3.0);
            }
        }
        println!("{name}: {turned} of {seen} points turned");
        assert!(seen > points.len() / 3 && turned * 50 < seen, "{name}: {turned} of {seen}");
    }
}

#[test]
fn tangents_run_along_u_and_up_the_picture() {
    let mesh = shapes::rock(2_000, 1);
    let map = map(&mesh, 40);
    let atlas = atlas(&map, &mesh, 256);
    let level = map.bake_normals(&mesh, &atlas, NormalSpace::Tangent { level: 3 }).unwrap().mesh;
    let stream = |name: &str, width: usize, v: u32| {
        let all = level.attribute(name).unwrap().as_floats().unwrap();
        all[width * v as usize..width * (v as usize + 1)].iter().map(|&x| f64::from(x)).collect::<Vec<f64>>()
    };
    let (mut along, mut up, mut count) = (0, 0, 0);
    for corners in level.triangles() {
        let [p, q, r] = corners.map(|v| level.positions()[v as usize].map(f64::from));
        let [a, b, c] = corners.map(|v| stream(names::UV, 2, v));
        let (e, f): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|i| q[i] - p[i]), std::array::from_fn(|i| r[i] - p[i]));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let du: [f64; 3] = std::array::from_fn(|i| ((c[1] - a[1]) * e[i] - (b[1] - a[1]) * f[i]) / area);
        let dv: [f64; 3] = std::array::from_fn(|i| ((b[0] - a[0]) * f[i] - (c[0] - a[0]) * e[i]) / area);
        let (n, t) = (stream(names::NORMAL, 3, corners[0]), stream(names::TANGENT, 4, corners[0]));
        let b = cross([n[0], n[1], n[2]], [t[0], t[1], t[2]]).map(|x| t[3] * x);
        let dot = |a: &[f64], b: &[f64]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
        assert!(dot(&n, &t).abs() < 1e-5 && (dot(&t, &t) - 1.0).abs() < 1e-5);
        along += usize::from(dot(&t, &unit(du)) > 0.7);
        up += usize::from(dot(&b, &unit(dv)) < -0.3);
        count += 1;
    }
    assert!(along * 100 > 95 * count && up * 100 > 95 * count, "{along}, {up} of {count}");
}

#[test]
fn the_same_texels_for_any_number_of_threads() {
    let mesh = shapes::uv_sphere(32, 16);
    let map = map(&mesh, 40);
    let atlas = atlas(&map, &mesh, 256);
    let source = checker(8, 64);
    let source = Texture::new(64, 64, &source).unwrap();
    let make = || {
        let normals = map.bake_normals(&mesh, &atlas, NormalSpace::Tangent { level: 1 }).unwrap();
        (bake_checker(&map, &mesh, &atlas, source), normals)
    };
    let [one, two] = [1, 2]
        .map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(make));
    assert!(one == two);
}

#[test]
fn what_does_not_fit_is_refused() {
    let mesh = shapes::rock(500, 1);
    let map = map(&mesh, 40);
    let atlas = atlas(&map, &mesh, 256);
    let texel = [[1, 2, 3, 4]];
    let texture = Texture::new(1, 1, &texel).unwrap();
    let missing = |name, width| RemeshError::NoAttribute { name, width };
    assert_eq!(map.bake_texture(&mesh, &atlas, &[texture]).unwrap_err(), missing(names::UV, 2));
    assert_eq!(map.bake_colours(&mesh, &atlas).unwrap_err(), missing(names::COLOR, 3));
    let length = |what, found, expected| RemeshError::Wavelet(WaveletError::Length { what, found, expected });
    let other = shapes::rock(1_000, 1);
    let space = NormalSpace::Tangent { level: 1 };
    let (triangles, more) = (mesh.triangles().len(), other.triangles().len());
    assert_eq!(map.bake_normals(&other, &atlas, space).unwrap_err(), length("triangles", more, triangles));
    let own = support::map(&other, 60);
    let charts = AtlasOptions::default().with_size(ChartSize::Area);
    let wrong = Atlas::new(&remesh(&own, &other, 1), &charts).unwrap();
    assert_eq!(map.bake_normals(&mesh, &wrong, space).unwrap_err(), length("charts", 60, 40));
    assert_eq!(map.bake_colours(&mesh, &wrong).unwrap_err(), length("charts", 60, 40));
}

#[test]
fn nothing_is_too_odd() {
    for (name, mesh) in support::awkward() {
        let map = map(&mesh, 4);
        let charts = map.base().triangles().len() as u32;
        let atlas = atlas(&map, &mesh, 24 * (charts.isqrt() + 1));
        for space in
            [NormalSpace::Object, NormalSpace::Tangent { level: 0 }, NormalSpace::Tangent { level: 2 }]
        {
            let baked = map.bake_normals(&mesh, &atlas, space).unwrap();
            let finite = |a: &Attribute| a.as_floats().is_none_or(|all| all.iter().all(|x| x.is_finite()));
            assert!(baked.mesh.attributes().iter().all(finite), "{name}");
            // Tangent space has no normals that face away.
            let faces = |texel: &[u8; 4]| space == NormalSpace::Object || texel[2] >= 127;
            assert!(baked.texture.texels.iter().all(faces), "{name}");
        }
    }
}
