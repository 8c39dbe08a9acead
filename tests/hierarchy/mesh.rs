//! Promise: a hierarchy with its vertices draws, at every cut, the image of its mesh with all that the mesh has; comes back
//! from a file equal, and not from what does not fit; and is made by one call.

use crate::support;
use crate::support::content::{Content, content, words};
use crate::support::lod::{Random, bake_hierarchy, drawn, places};
use multires::hierarchy::{Dependencies, HierarchyBuilder, HierarchyLod, VertexHierarchy};
use multires::lod::{Baked, Lod, LodOptions, VertexBuffer};
use multires::mesh::{Attribute, AttributeValues, Mesh, Report, Topology, names, shapes};
use multires::simplify::{Order, Placement, Simplifier, metric};
use multires::view::{Motion, View, look_at};
use proptest::prelude::*;

const POLICIES: [Dependencies; 4] =
    [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours, Dependencies::Manifold];

fn without_uv(mesh: &Mesh) -> Mesh {
    let bare =
        Mesh::new(mesh.positions(), mesh.triangles()).unwrap().with_materials(mesh.materials()).unwrap();
    let others = mesh.attributes().iter().filter(|attribute| attribute.name() != names::UV);
    others.fold(bare, |mesh, attribute| mesh.with_attribute(attribute.clone()).unwrap())
}

/// Without triangles of two equal corners, which are not drawn.
fn whole(mesh: &Mesh) -> Content {
    let mut content = content(mesh);
    content.retain(|(c, _)| c[0] != c[1] && c[1] != c[2] && c[2] != c[0]);
    content
}

fn is_compact(mesh: &Mesh) -> bool {
    let mut used = vec![false; mesh.positions().len()];
    mesh.indices().iter().for_each(|&v| used[v as usize] = true);
    used.iter().all(|&u| u)
}

/// Attributes of every kind, wedges told apart, some locks.
fn dressed(mesh: Mesh) -> Mesh {
    let count = mesh.positions().len();
    let tint: Vec<[f32; 2]> = (0..count).map(|v| [v as f32, -1.0 / (v + 1) as f32]).collect();
    let wedges = AttributeValues::Uint(Topology::new(&mesh).wedge_of().to_vec());
    mesh.with_attribute(Attribute::floats("tint", &tint))
        .and_then(|m| m.with_attribute(Attribute::new("wedge", 1, wedges)))
        .and_then(|m| m.with_locks((0..count).map(|v| v % 5 == 0).collect::<Vec<_>>()))
        .unwrap()
        .with_material_names(["stone", "moss"].map(str::to_owned))
}

/// Instances of all vertices and of those in use.
fn instances(bundle: &Baked<VertexHierarchy>) -> [HierarchyLod<[f32; 3]>; 2] {
    [VertexBuffer::Shared, VertexBuffer::Packed]
        .map(|buffer| bundle.instance(places(bundle), &LodOptions::default().with_buffer(buffer)).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// The finest and the coarsest cut are the sequence's; those between have the attributes of the vertices they draw.
    #[test]
    fn meshes_at_cuts_have_all_that_the_mesh_has(
        (mesh, sequence) in support::any_placement(),
        policy in 0usize..4,
        seed in any::<u64>(),
    ) {
        let wedges = AttributeValues::Uint(Topology::new(&mesh).wedge_of().to_vec());
        let mesh = mesh.with_attribute(Attribute::new("wedge", 1, wedges)).unwrap();
        let bundle = bake_hierarchy(&mesh, &sequence, POLICIES[policy]);
        prop_assert!(bundle.vertices().triangles().is_empty());
        let [mut fixed, mut packed] = instances(&bundle);
        prop_assert_eq!(whole(&fixed.to_mesh()), whole(&sequence.extract(&mesh, sequence.len())));
        for (step, share) in [100, 60, 30].into_iter().enumerate() {
            let asked = Random::new(bundle.structure(), seed ^ step as u64, share);
            let mut meshes = Vec::new();
            for lod in [&mut fixed, &mut packed] {
                lod.adapt_by(&asked, Motion::Other, 0.0);
                let at = lod.to_mesh();
                prop_assert!(is_compact(&at));
                let vertices: Vec<[Vec<u32>; 3]> =
                    drawn(lod).iter().map(|(_, t)| t.map(|v| words(bundle.vertices(), v))).collect();
                let shown: Vec<[Vec<u32>; 3]> =
                    at.triangles().iter().map(|t| t.map(|v| words(&at, v))).collect();
                prop_assert_eq!(vertices, shown);
                meshes.push(at);
            }
            prop_assert_eq!(&meshes[0], &meshes[1]);
            if share == 100 {
                prop_assert_eq!(content(&meshes[0]), whole(&sequence.extract(&mesh, 0)));
                prop_assert_eq!(bundle.bounds(), meshes[0].bounds());
                let triangles = bundle.structure().triangle_count();
                prop_assert_eq!(triangles, meshes[0].triangles().len());
                // Vertices that collapses name but no triangle uses are leaves too.
                prop_assert!(bundle.plain_memory() >= meshes[0].memory());
            }
        }
    }
}

#[test]
fn a_model_keeps_all_it_has() {
    let mesh = shapes::demo();
    let mesh = mesh
        .clone()
        .with_locks((0..mesh.positions().len()).map(|v| v % 97 == 0).collect::<Vec<_>>())
        .unwrap();
    for placement in [Placement::Endpoint, Placement::Optimal] {
        let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
        let bundle = bake_hierarchy(&mesh, &sequence, Dependencies::None);
        let [mut lod, _] = instances(&bundle);
        // A level as a mesh of its own gives up fitted texture coordinates where they would mirror one of its triangles.
        let level = sequence.extract(&mesh, sequence.len());
        let seen = lod.to_mesh();
        match placement {
            Placement::Endpoint => assert!(content(&seen) == content(&level)),
            _ => assert!(content(&without_uv(&seen)) == content(&without_uv(&level))),
        }
        assert_eq!(lod.to_mesh().material_names(), mesh.material_names());
        lod.adapt_by(&Random::new(bundle.structure(), 1, 100), Motion::Other, 0.0);
        let finest = lod.to_mesh();
        assert!(content(&finest) == content(&mesh));
        assert_eq!(bundle.plain_memory(), finest.memory());
        // One of triangles alone has no vertices to make a mesh of.
        let mut bare = HierarchyLod::new(bundle.structure().clone());
        assert!(!bare.triangles(0).is_empty());
        assert_eq!(bare.to_mesh(), Mesh::default());
        bare.refine_fully();
        assert_eq!(bare.to_mesh(), Mesh::default());
    }
}

#[test]
fn nothing_makes_nothing() {
    for mesh in [Mesh::default(), Mesh::new([[0.0; 3]; 3], [[0, 1, 1]]).unwrap()] {
        let bundle = HierarchyBuilder::new().bake(&mesh).unwrap();
        let [mut lod, _] = instances(&bundle);
        let view = View::perspective(look_at([0.0; 3], [1.0; 3], [0.0, 1.0, 0.0]), 1.0, [8, 8]).unwrap();
        lod.adapt(&[view.of_world()], 1.0 / 60.0);
        assert_eq!(lod.to_mesh().triangles().len(), 0);
        assert_eq!((bundle.bounds(), bundle.structure().leaf_count()), (None, 0));
    }
}

/// Larger than distances that single precision can tell, smaller, and far away: what is built is valid and comes at any cut.
#[test]
fn meshes_at_the_edge_of_what_is_legal() {
    let rock = shapes::rock(400, 1);
    for (scale, shift) in [(3e38, 0.0), (1e-38, 0.0), (1e-44, 0.0), (1.0, 1e6), (1e30, 3e38)] {
        let place = |p: &[f32; 3]| p.map(|x| (x * scale + shift).clamp(-f32::MAX, f32::MAX));
        let positions: Vec<[f32; 3]> = rock.positions().iter().map(place).collect();
        let mesh = Mesh::new(positions, rock.triangles()).unwrap();
        for placement in [Placement::Endpoint, Placement::Midpoint] {
            let mut builder =
                HierarchyBuilder::new().placement(placement).dependencies(Dependencies::Adjacent);
            let bundle = builder.bake(&mesh).unwrap();
            assert_eq!(bundle.structure().validate(), Ok(()), "{scale} {shift}");
            let [mut lod, mut fresh] = instances(&bundle);
            for far in [0.1, 0.5, 1.0] {
                let at = |x: f32| x * scale * far + shift;
                let camera = look_at([at(1.0), at(0.5), at(0.2)], [shift; 3], [0.0, 1.0, 0.0]);
                let Ok(view) = View::perspective(camera, 1.0, [640, 480]) else { continue };
                lod.adapt(&[view.of_world()], 1.0 / 60.0);
                fresh.adapt(&[], 1.0 / 60.0);
                fresh.adapt(&[view.of_world()], 1.0 / 60.0);
                assert_eq!(lod.to_mesh(), fresh.to_mesh());
            }
        }
    }
}

/// The builder does what its parts do one by one.
#[test]
fn one_call_is_all_calls() {
    let mesh = dressed(shapes::rock(2_000, 4));
    let sequence = Simplifier::new()
        .metric(metric::VolumeArea::new())
        .placement(Placement::Optimal)
        .order(Order::Batched)
        .run(&mesh)
        .unwrap();
    let by_hand = bake_hierarchy(&mesh, &sequence, Dependencies::Adjacent);
    let built = HierarchyBuilder::new()
        .dependencies(Dependencies::Adjacent)
        .metric(metric::VolumeArea::new())
        .placement(Placement::Optimal)
        .order(Order::Batched)
        .bake(&mesh)
        .unwrap();
    assert_eq!(built, by_hand);
    assert_eq!(built.structure().dependency_kind(), Dependencies::Adjacent);
    let bad = Simplifier::new().join_distance(-1.0);
    assert!(HierarchyBuilder::new().simplifier(bad).bake(&mesh).unwrap_err().to_string().contains("join"));
}

/// Berkey and Song's system, on closed and open meshes: what is near and in the picture is at full resolution, the rest
/// coarse, and topology is kept at every frame.
#[test]
fn berkey_and_song() {
    for mesh in [shapes::rock(4_000, 2), shapes::terrain(48, 3), shapes::moebius(80)] {
        let bundle = HierarchyBuilder::berkey_song().bake(&mesh).unwrap();
        let hierarchy = bundle.structure();
        assert_eq!(hierarchy.dependency_kind(), Dependencies::Neighbours);
        let before = Report::welded(&mesh);
        let diagonal = mesh.diagonal() as f32;
        let [low, high] = mesh.bounds().unwrap();
        let middle: [f32; 3] = std::array::from_fn(|i| (low[i] + high[i]) * 0.5);
        let [mut lod, _] = instances(&bundle);
        let mut fewest = usize::MAX;
        for frame in 0..24 {
            let angle = frame as f32 * 0.3;
            let eye = [
                middle[0] + 0.6 * diagonal * angle.cos(),
                middle[1] + 0.2 * diagonal,
                middle[2] + 0.6 * diagonal * angle.sin(),
            ];
            let radius = 0.45 * diagonal;
            let matrix = look_at(eye, middle, [0.0, 1.0, 0.0]);
            let view = View::perspective(matrix, 0.8, [100, 100]).unwrap().with_radius_test(radius);
            lod.adapt(&[view.of_world()], 1.0 / 60.0);
            let at = lod.to_mesh();
            let after = Report::welded(&at);
            assert_eq!(after.euler_characteristic, before.euler_characteristic);
            assert_eq!(after.components, before.components);
            assert!(after.border_edges <= before.border_edges && after.is_manifold() == before.is_manifold());
            fewest = fewest.min(at.triangles().len());

            // A leaf in sight and near is drawn as itself.
            let clip = |p: [f32; 3]| -> [f32; 3] {
                std::array::from_fn(|row| (0..3).map(|c| matrix[c][row] * p[c]).sum::<f32>() + matrix[3][row])
            };
            let half = (0.4f32).tan();
            for (leaf, &p) in bundle.vertices().positions()[..hierarchy.leaf_count()].iter().enumerate() {
                let [x, y, z] = clip(p);
                let distance = (0..3).map(|i| (p[i] - eye[i]).powi(2)).sum::<f32>().sqrt();
                if distance < radius * 0.999 && z < 0.0 && x.abs().max(y.abs()) < -z * half * 0.999 {
                    assert_eq!(hierarchy.representative(leaf as u32, lod.cut()), leaf as u32);
                }
            }
        }
        assert!(2 * fewest < mesh.triangles().len());

        // Nothing but what is near counts, however large it is on the picture.
        let eye = [middle[0], middle[1], middle[2] + 1.2 * diagonal];
        let view = View::perspective(look_at(eye, middle, [0.0, 1.0, 0.0]), 0.8, [4000, 4000]).unwrap();
        lod.adapt(
            &[view.clone().with_silhouette_px(0.1).with_radius_test(0.1 * diagonal).of_world()],
            1.0 / 60.0,
        );
        assert_eq!(lod.to_mesh().triangles().len(), hierarchy.base_triangle_count());
        lod.adapt(&[view.with_radius_test(9.0 * diagonal).of_world()], 1.0 / 60.0);
        assert_eq!(lod.to_mesh().triangles().len(), mesh.triangles().len());
    }
}

#[cfg(feature = "io")]
mod files {
    use super::*;
    use multires::io::{bake, unbake};
    use multires::lod::{Origins, Structure};
    use multires::simplify::CollapseSequence;

    #[derive(serde::Serialize)]
    struct Parts<'a> {
        vertices: &'a Mesh,
        structure: &'a VertexHierarchy,
        origins: &'a Origins,
    }

    fn any_mesh() -> (Mesh, CollapseSequence) {
        let mesh = dressed(shapes::torus(1.0, 0.4, 20, 12));
        let sequence = Simplifier::new().placement(Placement::Optimal).run(&mesh).unwrap();
        (mesh, sequence)
    }

    #[test]
    fn it_comes_back_from_a_file_and_not_from_parts_that_do_not_fit() {
        let (mesh, sequence) = any_mesh();
        for policy in POLICIES {
            let bundle = bake_hierarchy(&mesh, &sequence, policy);
            let bytes = bake(VertexHierarchy::KIND, &bundle).unwrap();
            let back: Baked<VertexHierarchy> = unbake(VertexHierarchy::KIND, &bytes).unwrap();
            assert_eq!(back, bundle);
            let parts = |vertices: &Mesh, origins: &Origins| {
                let parts = Parts { vertices, structure: bundle.structure(), origins };
                bake(VertexHierarchy::KIND, &parts).unwrap()
            };
            assert!(parts(bundle.vertices(), bundle.origins()) == bytes);
            let refused = |vertices: &Mesh, origins: &Origins| {
                let bytes = parts(vertices, origins);
                unbake::<Baked<VertexHierarchy>>(VertexHierarchy::KIND, &bytes).unwrap_err().to_string()
            };
            let (positions, origins) = (bundle.vertices().positions(), bundle.origins());
            assert!(refused(&Mesh::new(&positions[1..], []).unwrap(), origins).contains("vertices"));
            assert!(refused(&Mesh::new(positions, [[0, 1, 2]]).unwrap(), origins).contains("triangles"));
            let other = HierarchyBuilder::new().bake(&shapes::icosphere(1)).unwrap();
            let (found, expected) = (other.origins().len(), positions.len());
            let said = refused(bundle.vertices(), other.origins());
            assert!(said.contains(&format!("{found} origins where {expected} are needed")), "{said}");

            let text = serde_json::to_string(&bundle).unwrap();
            assert_eq!(serde_json::from_str::<Baked<VertexHierarchy>>(&text).unwrap(), bundle);
            // Borrowed and owned parts are the same bytes.
            let owned = multires::hierarchy::HierarchyParts::from((**bundle.structure()).clone());
            assert!(bake("parts", &owned).unwrap() == bake("parts", &**bundle.structure()).unwrap());
            // Little more than the parts: everything else is derived.
            assert!(bytes.len() < bundle.memory() + 2048, "{} {}", bytes.len(), bundle.memory());
        }
    }

    fn config() -> impl bincode::config::Config {
        bincode::config::standard().with_fixed_int_encoding().with_limit::<{ 1 << 22 }>()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        /// Any bytes changed, in a way that often still fits.
        #[test]
        fn forged_bytes_are_refused_or_safe(
            (mesh, sequence) in support::any_placement(),
            policy in 0usize..4,
            damage in prop::collection::vec((any::<prop::sample::Index>(), any::<bool>(), any::<u32>()), 1..4),
            noise in prop::collection::vec(any::<u8>(), 0..300),
        ) {
            let bundle = bake_hierarchy(&dressed(mesh), &sequence, POLICIES[policy]);
            let mut bytes = bincode::serde::encode_to_vec(&bundle, config()).unwrap();
            for (at, word, value) in damage {
                if word {
                    let at = at.index(bytes.len() - 3);
                    bytes[at..at + 4].copy_from_slice(&(value % 64).to_le_bytes());
                } else {
                    let at = at.index(bytes.len());
                    bytes[at] ^= value as u8;
                }
            }
            for bytes in [&bytes, &noise] {
                let Ok((bundle, _)) = bincode::serde::decode_from_slice::<Baked<VertexHierarchy>, _>(bytes, config()) else {
                    continue;
                };
                prop_assert_eq!(bundle.structure().validate(), Ok(()));
                for mut lod in instances(&bundle) {
                    for share in [100, 40, 70, 0] {
                        lod.adapt_by(&Random::new(bundle.structure(), 7, share), Motion::Other, 0.0);
                        let at = lod.to_mesh();
                        prop_assert_eq!(at.triangles().len(), drawn(&lod).len());
                        prop_assert!(at.indices().iter().all(|&v| (v as usize) < at.positions().len()));
                    }
                }
                let _ = (bundle.memory(), bundle.plain_memory(), bundle.bounds());
            }
        }
    }
}
