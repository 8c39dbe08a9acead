//! Promise: a mesh of faces split to different depths, whose vertices are in the order of levels, is recognised and drawn as it
//! was.

use crate::subdivide::uneven::{Chosen, uneven};
use crate::subdivide::*;
use multires::mesh::{Mesh, shapes};
use multires::wavelet::{Normals, WaveletMesh, WaveletOptions, recognise, recognise_uneven};

/// Triangles by the values at their corners, turned and sorted.
fn drawn(mesh: &Mesh) -> Vec<(Vec<Vec<u32>>, u32)> {
    let value = |v: u32| {
        let mut value: Vec<u32> = mesh.positions()[v as usize].iter().map(|x| x.to_bits()).collect();
        for attribute in mesh.attributes() {
            let (floats, width) = (attribute.as_floats().unwrap(), attribute.width());
            value.extend(floats[v as usize * width..][..width].iter().map(|x| x.to_bits()));
        }
        value
    };
    let triangle = |(at, corners): (usize, &[u32; 3])| {
        let mut corners: Vec<_> = corners.iter().map(|&v| value(v)).collect();
        let least = (0..3).min_by_key(|&k| &corners[k]).unwrap();
        corners.rotate_left(least);
        (corners, mesh.materials().get(at).copied().unwrap_or(0))
    };
    let mut drawn: Vec<_> = mesh.triangles().iter().enumerate().map(triangle).collect();
    drawn.sort_unstable();
    drawn
}

fn bases() -> Vec<(&'static str, Mesh)> {
    let ball = Faces::of(&shapes::icosphere(0));
    let halves: Vec<u32> = (0..20).map(|t| t / 10).collect();
    vec![
        ("ball", shapes::icosphere(0)),
        ("rock", shapes::rock(120, 1)),
        ("torus", shapes::torus(1.0, 0.4, 5, 4)),
        ("moebius", shapes::moebius(9)),
        ("charts", ball.charted(&halves)),
        ("gear", shapes::gear(6, 0.3)),
    ]
}

const CHOSEN: [Chosen; 5] =
    [Chosen::Alone(40), Chosen::Alone(128), Chosen::Alone(220), Chosen::Near(40), Chosen::Near(128)];

/// Recognises a mesh; checks that it is drawn as it was, and returns the number of base faces, if it is recognised.
fn base_faces(mesh: &Mesh) -> Option<usize> {
    let found = WaveletMesh::recognise(mesh, &WaveletOptions::default()).ok()?;
    assert_eq!(drawn(&found.finest(Normals::Kept)), drawn(mesh));
    Some(found.subdivision().base_face_count())
}

/// A mesh with its triangles in another order, and turned; vertices keep their order.
fn reordered(mesh: &Mesh, seed: u64) -> Mesh {
    let (other, triangle) = shuffled(mesh, seed);
    let turned = triangle.iter().zip(0_u64..).map(|(&t, at)| {
        let corners = mesh.triangles()[t as usize];
        [0, 1, 2].map(|k| corners[(k + at as usize) % 3])
    });
    let mut result = Mesh::new(mesh.positions().to_vec(), turned.collect::<Vec<_>>()).unwrap();
    for attribute in mesh.attributes() {
        result = result.with_attribute(attribute.clone()).unwrap();
    }
    match other.materials() {
        [] => result,
        materials => result.with_materials(materials.to_vec()).unwrap(),
    }
}

/// Down to the base from which the mesh was made, or to a coarser one.
#[test]
fn files_of_uneven_depth_are_recognised() {
    for (name, base) in bases() {
        for chosen in CHOSEN {
            for seed in 0..10 {
                let model = uneven(&base, 1 + seed as usize % 4, chosen, seed);
                if model.subdivision().is_uniform() {
                    continue;
                }
                let mesh = model.finest(Normals::Kept);
                for mesh in [reordered(&mesh, seed), mesh] {
                    let found = base_faces(&mesh);
                    assert!(
                        found.is_some_and(|faces| faces <= base.triangles().len()),
                        "{name} {chosen:?} {seed}: {found:?} of {} base faces",
                        base.triangles().len(),
                    );
                }
            }
        }
    }
}

/// On a regular lattice, and where materials change on it, a region may be read in two ways, and a wrong choice leaves base faces
/// unmerged. Whatever is recognised is drawn as it was.
#[test]
fn regular_lattices_are_drawn_as_they_were() {
    let ball = Faces::of(&shapes::icosphere(0));
    let halves: Vec<u32> = (0..20).map(|t| t / 10).collect();
    let mut two = Faces::of(&shapes::rock(60, 3));
    two.add(&Faces::of(&shapes::plane(3)));
    let bases = [shapes::plane(4), two.mesh(), ball.mesh().with_materials(halves).unwrap()];
    let (mut whole, mut all) = (0, 0);
    for base in &bases {
        for chosen in CHOSEN {
            for seed in 0..10 {
                let model = uneven(base, 1 + seed as usize % 4, chosen, seed);
                if model.subdivision().is_uniform() {
                    continue;
                }
                let found = base_faces(&model.finest(Normals::Kept));
                whole += usize::from(found.is_some_and(|faces| faces <= base.triangles().len()));
                all += 1;
            }
        }
    }
    assert!(10 * whole >= 9 * all, "{whole} of {all}");
}

/// Without the order of vertices there is no telling: such a mesh may be refused or have a finer base, but is drawn as it was.
#[test]
fn shuffled_vertices_are_drawn_as_they_were() {
    for (_, base) in bases() {
        for chosen in CHOSEN {
            for seed in 0..4 {
                let mesh = uneven(&base, 1 + seed as usize % 3, chosen, seed).finest(Normals::Kept);
                base_faces(&shuffled(&mesh, seed).0);
            }
        }
    }
}

/// Faces beside deeper ones are a single leaf each.
#[test]
fn leaves_are_triangles_with_midpoints_left_out() {
    let model = uneven(&shapes::icosphere(0), 3, Chosen::Near(128), 1);
    let mesh = model.finest(Normals::Kept);
    let found = recognise_uneven(&mesh);
    let component = found.components[0];
    assert!(component.uneven && component.levels == model.subdivision().depth() as u32);
    assert_eq!(component.triangles as usize, mesh.triangles().len());
    let leaves = found.leaves(&mesh);
    assert_eq!(leaves.len(), found.quadrisection.triangles());
    assert_eq!(leaves.len(), model.subdivision().leaf_count());
    assert!(leaves.len() < mesh.triangles().len());
    let corners = found.quadrisection.corners(&leaves);
    for (face, first) in found.quadrisection.splits() {
        let ([c0, c1, c2], [m0, m1, m2]) = (corners[face], corners[first + 3]);
        assert_eq!(corners[first..first + 3], [[c0, m0, m2], [c1, m1, m0], [c2, m2, m1]]);
    }
    let even = shapes::icosphere(2);
    assert_eq!(*recognise_uneven(&even).leaves(&even), *even.triangles());
}

/// Irregular meshes have the patterns of uneven depth here and there, and are refused all the same.
#[test]
fn irregular_meshes_are_refused() {
    for mesh in [shapes::rock(5_000, 1), shapes::gear(24, 0.3), shapes::uv_sphere(40, 30), shapes::robot(40)]
    {
        let found = recognise_uneven(&mesh);
        assert!(found.components.iter().all(|component| !component.uneven));
        assert_eq!(found.components, recognise(&mesh).components);
    }
}

/// A remesh of uneven depth through a file and back.
#[cfg(feature = "io")]
#[test]
fn remeshes_of_uneven_depth_come_back_from_files() {
    use multires::io::{self, Format};
    use multires::remesh::{Depth, Remesher};

    let mesh = shapes::rock(5_000, 1);
    let map = Remesher::new().base_faces(100).run(&mesh).unwrap();
    for share in [0.02, 0.005] {
        let depth = Depth::Error(share * mesh.diagonal() as f32);
        let model = map.bake(&mesh, depth, &WaveletOptions::default()).unwrap();
        let subdivision = model.structure().subdivision();
        assert!(!subdivision.is_uniform());
        let finest = model.structure().finest(Normals::Kept);
        for format in [Format::Obj, Format::Ply, Format::Glb] {
            let bytes = io::write_bytes(format, &finest).unwrap();
            let read = io::read_bytes(format, &bytes).unwrap();
            let found = WaveletMesh::recognise(&read, &WaveletOptions::default()).unwrap();
            assert_eq!(drawn(&found.finest(Normals::Kept)), drawn(&read));
            let found = found.subdivision();
            assert_eq!(found.base_face_count(), 100);
            assert_eq!((found.depth(), found.leaf_count()), (subdivision.depth(), subdivision.leaf_count()));
        }
    }
}
