//! Promise: a texture drawn by an atlas of the base lies on every set of wavelets as it lies on the full resolution, without
//! cracks and without colours that bleed.
#![cfg(feature = "quality")]

use std::sync::Arc;

use crate::wavelet::{bases, buffer, drawn_positions, hash, instance, patchy, positions, uniform, view};
use multires::adapt::Geomorph;
use multires::lod::{Lod, Triangulation, Values};
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::quality::{DistanceOptions, texture_deviation};
use multires::wavelet::{
    Atlas, AtlasOptions, ChartSize, DomainPoint, Face, Normals, WaveletBuilder, WaveletError, WaveletLod,
    WaveletMesh, WaveletOptions, WaveletParts,
};

const BOTH: [Triangulation; 2] = [Triangulation::Exact, Triangulation::Minimal];

/// Meshes of all kinds, split everywhere alike or not.
fn meshes(seed: u64) -> Vec<(String, WaveletMesh)> {
    let options = WaveletOptions::default();
    let mut bases = bases();
    bases.push(("uvs with seams", shapes::uv_sphere(6, 4)));
    let mut all = Vec::new();
    for (name, base) in bases {
        all.push((format!("{name}, uniform"), uniform(&base, 3, seed, &options)));
        all.push((format!("{name}, patchy"), patchy(&base, 4, seed, &options)));
    }
    all
}

fn atlas(mesh: &WaveletMesh, gutter: u32, size: ChartSize) -> Atlas {
    // A power of two with enough room.
    let charts = mesh.subdivision().base_face_count() as u32;
    let resolution = (charts.isqrt() + 2) * (4 * gutter + 6);
    let options = AtlasOptions::default()
        .with_resolution(resolution.next_power_of_two())
        .with_gutter(gutter)
        .with_size(size);
    Atlas::new(mesh, &options).unwrap()
}

fn uvs(mesh: &Mesh) -> Vec<[f32; 2]> {
    let uv = mesh.attribute(names::UV).and_then(|uv| uv.as_floats()).unwrap();
    uv.chunks_exact(2).map(|uv| [uv[0], uv[1]]).collect()
}

/// Texture coordinates in single precision.
fn uv(atlas: &Atlas, point: &DomainPoint) -> [f32; 2] {
    atlas.uv(point).unwrap().map(|x| x as f32)
}

fn middle(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
}

#[test]
fn places_on_the_base_are_halves_of_halves() {
    for (name, mesh) in meshes(1) {
        let of = mesh.subdivision();
        for vertex in 0..of.vertex_count() as u32 {
            let Some(ends) = of.ends(vertex) else { continue };
            let ends = ends.map(|end| of.domain_of(end).collect::<Vec<_>>());
            let points: Vec<DomainPoint> = of.domain_of(vertex).collect();
            assert!(!points.is_empty(), "{name}, vertex {vertex}");
            for point in points {
                let there = |end: usize| ends[end].iter().filter(move |e| e.base_face == point.base_face);
                let halved = |a: &DomainPoint| {
                    there(1).any(|b| middle(a.barycentric, b.barycentric) == point.barycentric)
                };
                assert!(there(0).any(halved), "{name}, vertex {vertex} at {point:?}");
            }
        }
        for face in 0..of.face_count() as u32 {
            let corners = of.face(face).unwrap().into_iter().zip(of.domain_of_face(face).unwrap());
            for (vertex, point) in corners {
                assert!(of.domain_of(vertex).any(|p| p == point), "{name}, face {face}");
            }
        }
        assert_eq!(of.domain_of(of.vertex_count() as u32).count(), 0);
        assert_eq!(of.domain_of_face(of.face_count() as u32), None);
    }
}

#[test]
fn places_are_exact_as_deep_as_levels_go() {
    let mut builder = WaveletBuilder::new(&shapes::tetrahedron()).unwrap();
    let mut deeper = |shift: bool| {
        let mut face = 0;
        let first = |_: &Face| {
            face += 1;
            face == 2 || shift && face == 1
        };
        builder.subdivide_where(first, |midpoint| midpoint.middle).map(|_| ())
    };
    for level in 0..52 {
        deeper(level == 0).unwrap();
    }
    assert_eq!(deeper(false), Err(WaveletError::TooMany { what: "levels", count: 53, limit: 52 }));
    let mesh = builder.build(&WaveletOptions::default()).unwrap();
    let of = mesh.subdivision();
    for vertex in 0..of.vertex_count() as u32 {
        let Some(ends) = of.ends(vertex) else { continue };
        let ends = ends.map(|end| of.domain_of(end).collect::<Vec<_>>());
        for point in of.domain_of(vertex) {
            let there = |end: usize| ends[end].iter().filter(|e| e.base_face == point.base_face);
            let halved =
                |a: &DomainPoint| there(1).any(|b| middle(a.barycentric, b.barycentric) == point.barycentric);
            assert!(there(0).any(halved));
            assert_eq!(point.barycentric.iter().sum::<f64>(), 1.0);
        }
    }
    let atlas = atlas(&mesh, 1, ChartSize::Equal);
    assert_eq!(positions_of(&mesh.with_atlas(&atlas).unwrap()), positions_of(&mesh));
}

#[test]
fn charts_and_their_gutters_do_not_overlap() {
    for (name, mesh) in meshes(2) {
        for (gutter, size) in [(0, ChartSize::Equal), (1, ChartSize::Area), (3, ChartSize::Equal)] {
            let atlas = atlas(&mesh, gutter, size);
            assert_eq!(atlas.len(), mesh.subdivision().base_face_count());
            let scale = f64::from(atlas.resolution());
            let charts: Vec<[[f64; 2]; 3]> = (0..atlas.len() as u32)
                .map(|face| atlas.chart(face).unwrap().map(|uv| uv.map(|x| f64::from(x) * scale)))
                .collect();
            // Enlarged by the gutter both ways; what parts them is one of the directions of their sides.
            let room = f64::from(gutter);
            let spans = |chart: &[[f64; 2]; 3]| {
                [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|axis: [f64; 2]| {
                    let at = chart.map(|p| p[0] * axis[0] + p[1] * axis[1]);
                    let reach = room * (axis[0] + axis[1]);
                    let low = at.into_iter().fold(f64::INFINITY, f64::min);
                    [low - reach, at.into_iter().fold(low, f64::max) + reach]
                })
            };
            let spans: Vec<_> = charts.iter().map(spans).collect();
            for (a, one) in spans.iter().enumerate() {
                assert!(
                    one[..2].iter().all(|s| s[0] >= 0.0 && s[1] <= scale),
                    "{name}: chart {a} sticks out"
                );
                for (b, two) in spans.iter().enumerate().take(a) {
                    let apart = one.iter().zip(two).any(|(s, t)| s[1] <= t[0] || t[1] <= s[0]);
                    assert!(apart, "{name}: charts {a} and {b}");
                }
            }
            // They turn the way of their faces.
            for [a, b, c] in charts {
                assert!((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]), "{name}");
            }
            assert!(atlas.coverage() > 0.0 && atlas.coverage() <= 1.0);
        }
    }
}

#[test]
fn charts_are_sized_by_area_where_asked() {
    let mesh = uniform(&shapes::torus(1.0, 0.4, 7, 4), 2, 3, &WaveletOptions::default());
    let options = AtlasOptions::default().with_resolution(1024).with_gutter(1);
    let double = |[a, b, c]: [[f32; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let areas = |options: &AtlasOptions| -> Vec<f32> {
        let atlas = Atlas::new(&mesh, options).unwrap();
        (0..atlas.len() as u32).map(|face| double(atlas.chart(face).unwrap())).collect()
    };
    let equal = areas(&options);
    assert!(equal.iter().all(|a| *a == equal[0]));
    let sized = areas(&options.with_size(ChartSize::Area));
    let full = mesh.sampler();
    // Of the torus outer faces are larger than inner ones.
    let size = |face: u32| {
        let at = full.at(&DomainPoint::new(face, [1.0; 3])).unwrap().position;
        (at, sized[face as usize])
    };
    let far = |p: [f32; 3]| p.iter().map(|x| x * x).sum::<f32>();
    let mut faces: Vec<_> = (0..sized.len() as u32).map(size).collect();
    faces.sort_by(|a, b| far(a.0).total_cmp(&far(b.0)));
    let mean = |faces: &[([f32; 3], f32)]| faces.iter().map(|f| f.1).sum::<f32>() / faces.len() as f32;
    let third = faces.len() / 3;
    assert!(mean(&faces[faces.len() - third..]) > 1.2 * mean(&faces[..third]));
}

#[test]
fn any_point_of_a_chart_is_filtered_from_its_own_texels() {
    for (name, mesh) in meshes(3) {
        for size in [ChartSize::Equal, ChartSize::Area] {
            let atlas = atlas(&mesh, 1, size);
            let width = atlas.resolution() as usize;
            let texels = atlas.bake(&mesh, |point| point.domain.base_face + 1).unwrap();
            assert_eq!(texels.len(), width * width);
            for face in 0..atlas.len() as u32 {
                for sample in 0..40 {
                    let seed = u64::from(face) * 64 + sample;
                    let mut weights = [0, 1, 2].map(|k| hash(seed, k));
                    // Inside, on a side, at a corner.
                    (0..sample % 3).for_each(|k| weights[((sample + k) % 3) as usize] = 0.0);
                    let sum: f64 = weights.iter().sum();
                    let point = DomainPoint::new(face, weights.map(|w| w / sum));
                    let at = atlas.uv(&point).unwrap().map(|x| x * width as f64 - 0.5);
                    for corner in 0..4 {
                        let shares = [corner & 1, corner >> 1];
                        let [x, y] = [0, 1].map(|i| (at[i].floor() as i64 + shares[i]) as usize);
                        let counts = (0..2).all(|i| shares[i] == 0 || at[i] > at[i].floor() + 1e-9);
                        let texel = texels[y * width + x];
                        assert!(!counts || texel == face + 1, "{name}: face {face} at {at:?}, {texel}");
                    }
                }
            }
        }
    }
}

#[test]
fn texels_hold_points_of_the_full_resolution() {
    let mesh = uniform(&shapes::terrain(3, 1), 2, 4, &WaveletOptions::default());
    let atlas = atlas(&mesh, 2, ChartSize::Equal);
    let sampler = mesh.sampler();
    let texels = atlas.bake(&mesh, |p| (p.position, p.normal)).unwrap();
    let width = atlas.resolution();
    let mut inside = 0;
    for face in 0..atlas.len() as u32 {
        let chart = atlas.chart(face).unwrap();
        let [low, high] = [0, 1].map(|i| {
            let at = chart.map(|corner| (corner[i] * width as f32) as u32);
            (*at.iter().min().unwrap(), *at.iter().max().unwrap())
        });
        for (x, y) in (low.0..low.1).flat_map(|x| (high.0..high.1).map(move |y| (x, y))) {
            // Weights from the coordinates of the texel's centre.
            let [a, b, c] = chart.map(|p| p.map(|x| f64::from(x) * f64::from(width)));
            let p = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let cross = |o: [f64; 2], p: [f64; 2], q: [f64; 2]| {
                (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
            };
            let whole = cross(a, b, c);
            let weights = [cross(p, b, c), cross(a, p, c), cross(a, b, p)].map(|w| w / whole);
            if weights.iter().any(|&w| w < 1e-9) {
                continue;
            }
            inside += 1;
            let point = sampler.at(&DomainPoint::new(face, weights)).unwrap();
            let (position, normal) = texels[(y * width + x) as usize];
            for i in 0..3 {
                assert!((position[i] - point.position[i]).abs() < 1e-5);
                assert!(
                    (normal[i] - point.normal[i]).abs() < 1e-3 || weights.iter().any(|w| w % 0.25 < 1e-6)
                );
            }
        }
    }
    assert!(inside > 100);
}

#[test]
fn coordinates_are_affine_on_base_faces_and_all_else_stays() {
    for (name, mesh) in meshes(5) {
        let atlas = atlas(&mesh, 1, ChartSize::Area);
        let worn = mesh.with_atlas(&atlas).unwrap();
        let (of, before) = (worn.subdivision(), mesh.subdivision());
        let uvs = uvs(worn.vertices());
        for vertex in 0..of.vertex_count() as u32 {
            let points: Vec<DomainPoint> = of.domain_of(vertex).collect();
            assert_eq!(points.len(), 1, "{name}: {vertex} is in one base face");
            assert_eq!(uv(&atlas, &points[0]), uvs[vertex as usize], "{name}: {vertex}");
            if let Some([a, b]) = of.ends(vertex) {
                let half = std::array::from_fn(|i| 0.5 * (uvs[a as usize][i] + uvs[b as usize][i]));
                assert_eq!(uvs[vertex as usize], half, "{name}: {vertex}");
            }
        }
        assert_eq!((of.face_count(), of.wavelet_count()), (before.face_count(), before.wavelet_count()));
        for face in 0..of.face_count() as u32 {
            let at = |mesh: &WaveletMesh| {
                let corners = mesh.subdivision().face(face).unwrap().map(|v| v as usize);
                let normals = mesh.vertices().attribute(names::NORMAL).and_then(|n| n.as_floats());
                let normals = normals.map(|normals| corners.map(|v| normals[3 * v..3 * v + 3].to_vec()));
                (corners.map(|v| mesh.vertices().positions()[v]), normals)
            };
            assert_eq!(at(&worn), at(&mesh), "{name}");
        }
        for tolerance in [0.0, 0.01, 0.1] {
            let level = |mesh: &WaveletMesh| {
                positions(&mesh.at_tolerance(tolerance, Triangulation::Exact, Normals::Kept))
            };
            assert_eq!(level(&worn), level(&mesh), "{name}: bounds");
        }
        let names = |mesh: &WaveletMesh| -> Vec<String> {
            mesh.vertices().attributes().iter().map(|a| a.name().to_owned()).collect()
        };
        let before: Vec<String> = names(&mesh).into_iter().filter(|name| name != names::UV).collect();
        let after: Vec<String> = names(&worn).into_iter().filter(|name| name != names::UV).collect();
        assert_eq!(before, after);
        assert_eq!(worn.materials(), mesh.materials());
        assert!(worn.with_atlas(&atlas).unwrap() == worn, "{name}: twice is once");

        // It is a mesh like others: checked, and back from its parts; but not with parts of those beside deeper neighbours.
        worn.validate().unwrap();
        let parts = WaveletParts::from(worn.clone());
        assert!(parts.beside.is_empty() == mesh.subdivision().is_uniform(), "{name}");
        assert!(WaveletMesh::try_from(parts.clone()).unwrap() == worn, "{name}");
        for change in 0..6 {
            let mut forged = parts.clone();
            let Some(at) = forged.beside.len().checked_sub(1 + change % 2) else { continue };
            match change / 2 {
                0 => drop(forged.beside.remove(at)),
                1 => forged.beside[at][1] ^= 1,
                _ => forged.beside[at][2] ^= 1,
            }
            assert!(WaveletMesh::try_from(forged).is_err(), "{name}: {change}");
        }
    }
}

#[test]
fn any_set_is_the_same_surface_with_and_without() {
    for (name, mesh) in meshes(6) {
        let atlas = atlas(&mesh, 1, ChartSize::Equal);
        let worn = mesh.with_atlas(&atlas).unwrap();
        for (share, triangulation) in
            [0.0, 0.05, 0.3, 0.8, 1.0].into_iter().flat_map(|s| BOTH.map(|t| (s, t)))
        {
            let level = |mesh: &WaveletMesh| {
                mesh.extract(|wavelet| hash(u64::from(wavelet), 77) < share, triangulation, Normals::Kept)
            };
            let (before, after) = (level(&mesh), level(&worn));
            assert_eq!(positions(&before), positions(&after), "{name}, {share}, {triangulation:?}");
            // Every triangle is within one chart.
            let uvs = uvs(&after);
            let charts_of = |uv: [f32; 2]| {
                let holds = |&face: &u32| {
                    let [a, b, c] = atlas.chart(face).unwrap().map(|p| p.map(f64::from));
                    let p = uv.map(f64::from);
                    let side = |o: [f64; 2], q: [f64; 2]| {
                        (q[0] - o[0]) * (p[1] - o[1]) - (q[1] - o[1]) * (p[0] - o[0])
                    };
                    [side(a, b), side(b, c), side(c, a)].iter().all(|&s| s >= 0.0)
                };
                (0..atlas.len() as u32).filter(holds).collect::<Vec<_>>()
            };
            for t in after.triangles() {
                let charts = t.map(|v| charts_of(uvs[v as usize]));
                assert!(charts.iter().all(|c| c.len() == 1 && c == &charts[0]), "{name}: {charts:?}");
            }
        }
    }
}

#[test]
fn seams_stay_closed_while_views_move() {
    type Value = [f32; 5];
    for (at, (name, mesh)) in meshes(7).into_iter().enumerate() {
        let mesh = Arc::new(mesh);
        let atlas = atlas(&mesh, 1, ChartSize::Equal);
        let worn = Arc::new(mesh.with_atlas(&atlas).unwrap());
        let of = worn.subdivision();
        let uvs = uvs(worn.vertices());
        let values: Arc<[Value]> = (worn.vertices().positions().iter().zip(&uvs))
            .map(|(p, uv)| [p[0], p[1], p[2], uv[0], uv[1]])
            .collect();
        for triangulation in BOTH {
            let geomorph = Geomorph::default();
            let drawing = buffer(at % 2 == 0).with_triangulation(triangulation).with_geomorph(Some(geomorph));
            let mut plain = instance(&mesh, &drawing);
            let values = Values::from(Arc::clone(&values)).with_blending();
            let mut lod = WaveletLod::<Value>::new(Arc::clone(&worn), values, &drawing).unwrap();
            let mut moved = 0;
            for step in 0..12_u64 {
                let view = view(&mesh, 40 + step / 4, 8.0).of_world();
                let change = lod.adapt(std::slice::from_ref(&view), 0.07);
                assert_eq!(plain.adapt(&[view], 0.07), change, "{name}");
                moved += change.moving;
                let mut drawn: Vec<[[f32; 3]; 3]> = Vec::new();
                for group in 0..lod.groups() {
                    for (t, base_face) in lod.triangles(group).iter().zip(lod.base_faces(group)) {
                        let corners = t.map(|v| lod.values()[v as usize]);
                        drawn.push(corners.map(|v| [v[0], v[1], v[2]]));
                        // No vertex of the texture ever moves.
                        for (slot, corner) in t.iter().zip(corners) {
                            let vertex = lod.vertices().map_or(*slot, |vertices| vertices[*slot as usize]);
                            let point = of.domain_of(vertex).next().unwrap();
                            assert_eq!(point.base_face, base_face, "{name}");
                            assert_eq!(uv(&atlas, &point), [corner[3], corner[4]], "{name}");
                        }
                    }
                }
                let key = |p: &[f32; 3]| p.map(|x| (x + 0.0).to_bits());
                drawn.iter_mut().for_each(|t| {
                    let low = (0..3).min_by_key(|&k| key(&t[k])).unwrap();
                    t.rotate_left(low);
                });
                drawn.sort_unstable_by_key(|t| t.map(|p| key(&p)));
                assert_eq!(drawn, drawn_positions(&plain), "{name}, {triangulation:?}, step {step}");
                for wavelet in 0..of.wavelet_count() as u32 {
                    let own = lod.value(of.vertex_of(wavelet)).unwrap();
                    for double in of.seam_vertices_of(wavelet) {
                        let other = lod.value(double).unwrap();
                        assert_eq!(own[..3], other[..3], "{name}: wavelet {wavelet} is torn");
                    }
                }
            }
            assert!(moved > 0 || of.wavelet_count() < 20, "{name}");
        }
    }
}

/// On a flat surface the point nearest to one is that point itself, at whatever level.
#[test]
fn textures_do_not_slide() {
    let mut builder = WaveletBuilder::new(&shapes::plane(3)).unwrap();
    builder.subdivide(|midpoint| midpoint.middle).unwrap();
    builder.subdivide_where(|face| face.base_face % 3 == 0, |midpoint| midpoint.middle).unwrap();
    builder.subdivide_where(|face| face.base_face % 2 == 0, |midpoint| midpoint.middle).unwrap();
    let mesh = builder.build(&WaveletOptions::default()).unwrap();
    let mesh = mesh.with_atlas(&atlas(&mesh, 1, ChartSize::Equal)).unwrap();
    let full = mesh.finest(Normals::Kept);
    for (seed, triangulation) in (0..4).flat_map(|seed| BOTH.map(|t| (seed, t))) {
        let level = mesh.extract(|w| hash(u64::from(w), seed) < 0.2, triangulation, Normals::Kept);
        let options = DistanceOptions::default().with_samples(5000);
        let slid = texture_deviation(&full, &level, &options).unwrap();
        assert!(slid.max < 1e-5, "{slid:?}");
    }
}

/// Where coordinates had seams inside base faces, these had to be split wherever they are in view; charts have none. Seams of other
/// attributes stay.
#[test]
fn seams_inside_base_faces_go() {
    let mesh = shapes::terrain(9, 3);
    let count = mesh.positions().len() as u32;
    let chart = |t: &[u32; 3]| u32::from(t.iter().map(|v| v % 9).sum::<u32>() > 7);
    let corners: Vec<[u32; 3]> = mesh.triangles().iter().map(|t| t.map(|v| v + count * chart(t))).collect();
    let positions = [mesh.positions(), mesh.positions()].concat();
    for (name, torn) in [(names::UV, false), ("uv1", true)] {
        let values: Vec<[f32; 2]> =
            (0..2 * count).map(|v| [positions[v as usize][0], (v / count) as f32]).collect();
        let torn_mesh = Mesh::new(positions.clone(), corners.clone()).unwrap();
        let torn_mesh = torn_mesh.with_attribute(Attribute::floats(name, &values)).unwrap();
        let found = WaveletMesh::recognise(&torn_mesh, &WaveletOptions::default()).unwrap();
        assert!(found.subdivision().base_face_count() < 32);
        let coarsest = |mesh: &WaveletMesh| {
            mesh.at_tolerance(1e30, Triangulation::Exact, Normals::Kept).triangles().len()
        };
        assert!(coarsest(&found) > found.subdivision().base_face_count());
        let worn = found.with_atlas(&atlas(&found, 1, ChartSize::Equal)).unwrap();
        assert_eq!(coarsest(&worn) > worn.subdivision().base_face_count(), torn, "{name}");
        assert_eq!(positions_of(&worn), positions_of(&found));
        if torn {
            let sides = worn.finest(Normals::Kept);
            let values = sides.attribute(name).unwrap().as_floats().unwrap();
            for t in sides.triangles() {
                assert!(t.iter().all(|&v| values[2 * v as usize + 1] == values[2 * t[0] as usize + 1]));
            }
        }
    }
}

fn positions_of(mesh: &WaveletMesh) -> Vec<[[f32; 3]; 3]> {
    positions(&mesh.finest(Normals::Kept))
}

#[test]
fn textures_without_room_are_refused_and_those_with_just_enough_are_not() {
    let mesh = uniform(&shapes::torus(1.0, 0.4, 7, 4), 1, 0, &WaveletOptions::default());
    for size in [ChartSize::Equal, ChartSize::Area] {
        let options = AtlasOptions::default().with_gutter(3).with_size(size);
        let Err(error) = Atlas::new(&mesh, &options.with_resolution(50)) else { panic!("fits") };
        let WaveletError::AtlasTooSmall { charts: 56, gutter: 3, resolution: 50, needed } = error else {
            panic!("{error}")
        };
        let fits = |resolution: u64| Atlas::new(&mesh, &options.with_resolution(resolution as u32)).is_ok();
        assert!(fits(needed) && !fits(needed - 1));
        assert!(!fits(1 << 20));
        assert!(Atlas::new(&mesh, &options.with_gutter(u32::MAX)).is_err());
    }
    let other = uniform(&shapes::tetrahedron(), 1, 0, &WaveletOptions::default());
    let atlas = Atlas::new(&other, &AtlasOptions::default()).unwrap();
    let wrong = WaveletError::Length { what: "charts", found: 4, expected: 56 };
    assert_eq!(mesh.with_atlas(&atlas).unwrap_err(), wrong);
    assert_eq!(atlas.bake(&mesh, |_| 0_u8).unwrap_err(), wrong);
    assert_eq!((atlas.chart(4), atlas.uv(&DomainPoint::new(4, [1.0, 0.0, 0.0]))), (None, None));

    let empty = WaveletBuilder::new(&Mesh::default()).unwrap().build(&WaveletOptions::default()).unwrap();
    let atlas = Atlas::new(&empty, &AtlasOptions::default().with_resolution(0)).unwrap();
    assert!(atlas.is_empty() && atlas.bake(&empty, |_| 0_u8).unwrap().is_empty());
    assert_eq!(empty.with_atlas(&atlas).unwrap().finest(Normals::Kept).triangles().len(), 0);
    let nowhere = [f64::NAN, 0.0, 1.0];
    assert!(mesh.sampler().at(&DomainPoint::new(0, nowhere)).is_none());
    assert!(mesh.sampler().at(&DomainPoint::new(56, [1.0; 3])).is_none());
}
