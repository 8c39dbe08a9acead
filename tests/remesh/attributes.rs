//! Promise: a vertex of a remesh has the attributes of its point of the mesh.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;

use crate::support::{self, distance, map, models};
use bytemuck::{Pod, Zeroable};
use multires::adapt::Blend;
use multires::lod::Baked;
use multires::mesh::{Attribute, AttributeValues, Mesh, names, shapes};
use multires::remesh::{Depth, Fitting, Parameterisation, Remesher};
use multires::wavelet::{WaveletMesh, WaveletOptions};

fn bake(map: &Parameterisation, mesh: &Mesh, levels: usize) -> Baked<WaveletMesh> {
    map.bake(mesh, Depth::Levels(levels), &WaveletOptions::default()).unwrap()
}

fn rows<const WIDTH: usize>(mesh: &Mesh, name: &str) -> Option<Vec<[f32; WIDTH]>> {
    let attribute = mesh.attribute(name)?;
    assert_eq!(attribute.width(), WIDTH, "{name}");
    Some(attribute.as_floats()?.chunks_exact(WIDTH).map(|row| std::array::from_fn(|i| row[i])).collect())
}

/// Values of the corners of every finest triangle, with the points of the mesh there.
fn corners<'a>(
    map: &'a Parameterisation,
    remesh: &'a WaveletMesh,
) -> impl Iterator<Item = (u32, multires::mesh::MeshPoint)> + 'a {
    let of = remesh.subdivision();
    (0..of.face_count() as u32).filter(move |&face| !of.is_split(face)).flat_map(move |face| {
        let corners = of.face(face).unwrap().into_iter().zip(of.domain_of_face(face).unwrap());
        // The middle of the face tells on which side of a seam the corner is.
        corners.map(|(vertex, place)| (vertex, map.to_mesh(&place).unwrap()))
    })
}

#[test]
fn attributes_have_the_range_and_kind_of_the_source() {
    let mut seen = BTreeMap::new();
    for (name, mesh, faces) in models() {
        let map = map(&mesh, faces);
        let remesh = bake(&map, &mesh, 3);
        let vertices = remesh.vertices();
        let list = |mesh: &Mesh| -> Vec<(String, usize)> {
            mesh.attributes().iter().map(|a| (a.name().to_owned(), a.width())).collect()
        };
        assert_eq!(list(vertices), list(&mesh), "{name}");
        assert_eq!(vertices.material_names(), mesh.material_names(), "{name}");
        for attribute in mesh.attributes() {
            *seen.entry(attribute.name().to_owned()).or_insert(0) += 1;
            let after = vertices.attribute(attribute.name()).unwrap();
            let (Some(before), Some(after)) = (attribute.as_floats(), after.as_floats()) else { continue };
            assert!(after.iter().all(|x| x.is_finite()), "{name}: {}", attribute.name());
            let width = attribute.width();
            if [names::NORMAL, names::TANGENT].contains(&attribute.name()) {
                for n in after.chunks_exact(width) {
                    let length = n[..3].iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt();
                    assert!((length - 1.0).abs() < 2e-5, "{name}: {n:?}");
                }
                continue;
            }
            if attribute.name() == names::WEIGHTS {
                let sum = |w: &[f32]| (w.iter().sum::<f32>() - 1.0).abs();
                assert!(after.chunks_exact(width).all(|w| sum(w) < 1e-4), "{name}");
                continue;
            }
            for k in 0..width {
                let range = |all: &[f32]| {
                    let column = all.iter().skip(k).step_by(width).copied();
                    column.fold([f32::INFINITY, f32::NEG_INFINITY], |r, x| [r[0].min(x), r[1].max(x)])
                };
                let ([low, high], [least, most]) = (range(before), range(after));
                assert!(least >= low && most <= high, "{name}: {} {least}..{most}", attribute.name());
            }
        }
    }
    for name in [names::NORMAL, names::UV, names::COLOR, names::JOINTS, names::WEIGHTS] {
        assert!(seen.contains_key(name), "no shape has {name}");
    }
}

#[test]
fn coordinates_and_colours_are_those_of_the_point() {
    let mut seamed = 0;
    for (name, mesh, faces) in models() {
        for stream in [names::UV, names::COLOR] {
            let Some(attribute) = mesh.attribute(stream) else { continue };
            let width = attribute.width();
            let map = map(&mesh, faces);
            let go_on = |_| ControlFlow::Continue(());
            let baked = map.bake_with(&mesh, Depth::Levels(3), &WaveletOptions::default(), go_on).unwrap();
            let remesh = baked.model;
            let mut moved = BTreeSet::new();
            let (before, after) = (
                attribute.as_floats().unwrap(),
                remesh.vertices().attribute(stream).unwrap().as_floats().unwrap(),
            );
            let range = before.iter().fold(0.0f32, |most, x| most.max(x.abs()));
            seamed += remesh.structure().subdivision().vertex_count()
                - remesh.structure().subdivision().wavelet_count()
                - remesh.structure().subdivision().base_vertex_count();
            for (vertex, point) in corners(&map, remesh.structure()) {
                let corners = mesh.triangles()[point.triangle as usize];
                for k in 0..width {
                    let value = |c: usize| f64::from(before[corners[c] as usize * width + k]);
                    let expected: f64 = (0..3).map(|c| point.barycentric[c] * value(c)).sum();
                    let found = f64::from(after[vertex as usize * width + k]);
                    // As the source tells wedges apart: within a step of 16 bits.
                    let near = (expected - found).abs() < 4e-5 * f64::from(range.max(1.0));
                    if !near {
                        moved.insert(vertex);
                    }
                }
            }
            // Corners of triangles that would face away are moved.
            assert!(moved.len() <= 3 * (baked.unfolded + baked.folded), "{name}: {stream} of {moved:?}");
        }
    }
    assert!(seamed > 500, "{seamed} vertices at seams");
}

#[test]
fn a_seam_within_one_base_edge_stays_open() {
    // A sheet with a cut in texture space between two inner points: values agree at its ends, and nowhere else.
    let n = 16u32;
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let (mut positions, mut uv) = (Vec::new(), Vec::new());
    for (x, y) in (0..=n).flat_map(|y| (0..=n).map(move |x| (x, y))) {
        positions.push([x as f32 / n as f32, y as f32 / n as f32, 0.0]);
        uv.push([x as f32 / n as f32, y as f32 / n as f32]);
    }
    let mut lower = BTreeMap::new();
    for x in 5..=11 {
        let bump = (std::f32::consts::PI * (x - 4) as f32 / 8.0).sin();
        lower.insert(at(x, 8), positions.len() as u32);
        positions.push(positions[at(x, 8) as usize]);
        uv.push([x as f32 / n as f32, 0.5 - 0.25 * bump]);
    }
    let cell = |x: u32, y: u32| {
        let quad = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        let [a, b, c, d] = quad.map(|v| if y < 8 { lower.get(&v).copied().unwrap_or(v) } else { v });
        [[a, b, c], [a, c, d]]
    };
    let triangles: Vec<[u32; 3]> =
        (0..n).flat_map(|y| (0..n).flat_map(move |x| [(x, y)])).flat_map(|(x, y)| cell(x, y)).collect();
    let mesh =
        Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &uv)).unwrap();
    let map = map(&mesh, 8);
    let remesh = bake(&map, &mesh, 4);
    let after: Vec<[f32; 2]> = rows(remesh.vertices(), names::UV).unwrap();
    for (vertex, point) in corners(&map, remesh.structure()) {
        let of = mesh.triangles()[point.triangle as usize];
        let expected: [f64; 2] = std::array::from_fn(|i| {
            (0..3).map(|k| point.barycentric[k] * f64::from(uv[of[k] as usize][i])).sum()
        });
        let found = after[vertex as usize].map(f64::from);
        assert!(
            (0..2).all(|i| (expected[i] - found[i]).abs() < 1e-4),
            "{vertex}: {found:?}, not {expected:?}"
        );
    }
}

#[test]
fn coordinates_are_continuous_within_charts() {
    for (name, mesh, faces) in models() {
        let Some(before) = rows::<2>(&mesh, names::UV) else { continue };
        let length = |uv: &[[f32; 2]], t: &[u32; 3]| {
            let of = |a: u32, b: u32| {
                (0..2).map(|i| (uv[a as usize][i] - uv[b as usize][i]).powi(2)).sum::<f32>().sqrt()
            };
            of(t[0], t[1]).max(of(t[1], t[2])).max(of(t[2], t[0]))
        };
        let area = |uv: &[[f32; 2]], t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| uv[v as usize].map(f64::from));
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
        };
        let map = map(&mesh, faces);
        let remesh = bake(&map, &mesh, 4);
        let finest = remesh.structure().finest(multires::wavelet::Normals::Kept);
        let after = rows::<2>(&finest, names::UV).unwrap();
        // Small triangles are small in the texture, so no triangle reaches across a seam.
        let longest =
            |uv: &[[f32; 2]], mesh: &Mesh| mesh.triangles().iter().map(|t| length(uv, t)).fold(0.0, f32::max);
        let (most, base) =
            (longest(&after, &finest), longest(&rows::<2>(map.base(), names::UV).unwrap(), map.base()));
        assert!(most < 0.6 * base, "{name}: {most} of {base}");
        // And the texture is used as before.
        let sum = |uv: &[[f32; 2]], mesh: &Mesh| mesh.triangles().iter().map(|t| area(uv, t)).sum::<f64>();
        let share = sum(&after, &finest) / sum(&before, &mesh);
        assert!((0.98..1.02).contains(&share), "{name}: {share}");
    }
}

#[test]
fn skins_are_blended_as_sets() {
    let mesh = shapes::skinned_tube(16, 60);
    let map = map(&mesh, 24);
    let remesh = bake(&map, &mesh, 4);
    let dense = |mesh: &Mesh, v: u32| {
        let AttributeValues::Uint(joints) = mesh.attribute(names::JOINTS).unwrap().values() else { panic!() };
        let weights = mesh.attribute(names::WEIGHTS).unwrap().as_floats().unwrap();
        let mut dense = [0.0f64; 8];
        for slot in 4 * v as usize..4 * v as usize + 4 {
            dense[joints[slot] as usize] += f64::from(weights[slot]);
        }
        dense
    };
    for (vertex, point) in corners(&map, remesh.structure()) {
        let found = dense(remesh.vertices(), vertex);
        assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-5);
        let corners = mesh.triangles()[point.triangle as usize].map(|v| dense(&mesh, v));
        let expected: [f64; 8] =
            std::array::from_fn(|j| (0..3).map(|k| point.barycentric[k] * corners[k][j]).sum());
        assert!((0..8).all(|j| (found[j] - expected[j]).abs() < 1e-3), "{found:?}, not {expected:?}");
    }
}

/// A user's own vertex: a position, texture coordinates and a colour.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Own {
    place: [f32; 3],
    uv: [f32; 2],
    color: [f32; 3],
}

impl Blend for Own {}

#[test]
fn own_vertices_get_the_values_of_the_streams() {
    let color = |p: &[f32; 3]| [0.5 + 0.3 * p[0], 0.5 - 0.2 * p[1], 0.4 + 0.1 * p[2]];
    for (mesh, faces) in
        [(shapes::torus_knot(2, 3, 120, 8), 200), (shapes::prop(10), 150), (shapes::uv_sphere(32, 16), 40)]
    {
        let colors: Vec<[f32; 3]> = mesh.positions().iter().map(color).collect();
        let mesh = mesh.with_attribute(Attribute::floats(names::COLOR, &colors)).unwrap();
        let uv: Vec<[f32; 2]> = rows(&mesh, names::UV).unwrap();
        let own = |v: usize| Own { place: mesh.positions()[v], uv: uv[v], color: colors[v] };
        let all: Vec<Own> = (0..uv.len()).map(own).collect();
        let map = map(&mesh, faces);
        let baked = bake(&map, &mesh, 3);
        let values = baked.arrange_blended(&all, |own, place| own.place = place).unwrap();
        let vertices = baked.vertices();
        let (uv, colors) =
            (rows::<2>(vertices, names::UV).unwrap(), rows::<3>(vertices, names::COLOR).unwrap());
        assert_eq!(values.len(), vertices.positions().len());
        for (v, own) in values.iter().enumerate() {
            let near = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(near(&own.uv, &uv[v]) && near(&own.color, &colors[v]), "{v}: {own:?}, {:?}", uv[v]);
            assert!(near(&own.place, &vertices.positions()[v]), "{v}: {own:?}");
        }
    }
}

#[test]
fn hard_normals_become_smooth_up_to_features() {
    // A rock shaded flat: normals as of the rock with shared vertices.
    let (flat, smooth) = (shapes::flat_rock(3_000, 3), shapes::rock(3_000, 3));
    let map = map(&flat, 60);
    assert_eq!(map.base().triangles().len(), 60);
    let remesh = bake(&map, &flat, 4);
    let normals: Vec<[f32; 3]> = rows(remesh.vertices(), names::NORMAL).unwrap();
    let mut of_vertex = vec![[0.0f64; 3]; smooth.positions().len()];
    let bits = |p: &[f32; 3]| p.map(f32::to_bits);
    let number: BTreeMap<[u32; 3], usize> =
        smooth.positions().iter().enumerate().map(|(v, p)| (bits(p), v)).collect();
    for t in smooth.triangles() {
        let [a, b, c] = t.map(|v| smooth.positions()[v as usize].map(f64::from));
        let (e, f): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        t.iter().for_each(|&v| (0..3).for_each(|i| of_vertex[v as usize][i] += n[i]));
    }
    let unit = |n: [f64; 3]| n.map(|x| x / distance(n, [0.0; 3]));
    let mut worst = 1.0f64;
    for (vertex, point) in corners(&map, remesh.structure()) {
        let corners = flat.triangles()[point.triangle as usize];
        let at = |k: usize| unit(of_vertex[number[&bits(&flat.positions()[corners[k] as usize])]]);
        let expected = unit(std::array::from_fn(|i| (0..3).map(|k| point.barycentric[k] * at(k)[i]).sum()));
        let found = normals[vertex as usize].map(f64::from);
        worst = worst.min((0..3).map(|i| expected[i] * found[i]).sum());
    }
    println!("flat rock: within {:.2} degrees", worst.min(1.0).acos().to_degrees());
    assert!(worst > 0.999, "{worst}");

    // A box keeps its edges: all normals are axes.
    let cube = shapes::box_with_face_normals(6);
    let remesh = bake(&support::map(&cube, 12), &cube, 3);
    let normals: Vec<[f32; 3]> = rows(remesh.vertices(), names::NORMAL).unwrap();
    assert!(normals.iter().all(|n| n.iter().filter(|x| x.abs() > 1e-6).count() == 1));
}

#[test]
fn another_pose_is_remeshed_by_the_same_map() {
    let mesh = shapes::skinned_tube(16, 40);
    let map = Remesher::new().base_faces(40).fitting(Fitting::Off).run(&mesh).unwrap();
    let bend = |p: &[f32; 3]| {
        let (sine, cosine) = (0.8 * p[1]).sin_cos();
        [cosine * (2.0 + p[0]) - 2.0, sine * (2.0 + p[0]), p[2]]
    };
    let positions: Vec<[f32; 3]> = mesh.positions().iter().map(bend).collect();
    let mut posed = Mesh::new(positions, mesh.triangles()).unwrap();
    for attribute in mesh.attributes() {
        posed = posed.with_attribute(attribute.clone()).unwrap();
    }
    let [rest, bent] = [&mesh, &posed].map(|mesh| bake(&map, mesh, 3));
    let [of_rest, of_bent] = [&rest, &bent].map(|baked| baked.structure().subdivision());
    assert_eq!(of_rest, of_bent);
    assert_eq!(rest.vertices().attributes(), bent.vertices().attributes());
    bent.structure().validate().unwrap();
    for (vertex, point) in corners(&map, bent.structure()) {
        let position = bent.vertices().positions()[vertex as usize].map(f64::from);
        assert!(distance(position, point.position(&posed).unwrap()) < 1e-6 * posed.diagonal());
    }
    // Itself: the bytes of the first run.
    assert!(bake(&map, &mesh, 3) == rest);
}

#[test]
fn origins_and_locks_do_not_get_lost() {
    let mesh = shapes::rock(500, 1).with_origin([1e6, -2e6, 0.5]).unwrap();
    let map = map(&mesh, 40);
    assert_eq!(map.base().origin(), mesh.origin());
    assert_eq!(bake(&map, &mesh, 1).vertices().origin(), mesh.origin());
}
