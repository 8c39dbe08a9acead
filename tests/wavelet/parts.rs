//! Promise: the parts of a wavelet mesh come back equal, from files bit for bit; forged ones are refused by name, or are a mesh
//! that can be drawn at any cut.

use std::sync::Arc;

use crate::wavelet::{bases, buffer, hash, instance, patchy, rough, uniform, view};
use multires::adapt::Geomorph;
use multires::lod::{Lod, Triangulation};
use multires::mesh::{Attribute, AttributeValues, Mesh, shapes};
use multires::view::ErrorShape;
use multires::wavelet::{
    ErrorBound, Normals, Subdivision, WaveletBounds, WaveletBuilder, WaveletMesh, WaveletOptions,
    WaveletParts,
};
use proptest::prelude::*;

const BOTH: [Triangulation; 2] = [Triangulation::Exact, Triangulation::Minimal];

fn options() -> [WaveletOptions; 3] {
    let plain = WaveletOptions::default();
    [
        plain,
        plain.with_shape(ErrorShape::SphereAndCones),
        plain.with_bound(ErrorBound::WithoutSiblings).with_shape(ErrorShape::SphereAndCones),
    ]
}

/// Attributes of every kind, materials, locks.
fn dressed(mesh: Mesh) -> Mesh {
    let (vertices, triangles) = (mesh.positions().len(), mesh.triangles().len());
    let tint: Vec<[f32; 2]> = (0..vertices).map(|v| [v as f32, -1.0 / (v + 1) as f32]).collect();
    let label = AttributeValues::Uint((0..vertices as u32).collect());
    mesh.with_attribute(Attribute::floats("tint", &tint))
        .and_then(|m| m.with_attribute(Attribute::new("label", 1, label)))
        .and_then(|m| m.with_materials((0..triangles).map(|t| [9, 4, 7][t % 3]).collect::<Vec<_>>()))
        .and_then(|m| m.with_locks((0..vertices).map(|v| v % 5 == 0).collect::<Vec<_>>()))
        .unwrap()
        .with_material_names(["stone", "moss"].map(str::to_owned))
}

/// Three triangles, a seam between the first two; the first is split, which drags the second along, and so is its first child.
fn small() -> WaveletMesh {
    let places = [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [0., 0.], [1., 1.], [2., 0.]];
    let positions: Vec<[f32; 3]> = places.iter().map(|p| [p[0], p[1], 0.1 * p[0] * p[1]]).collect();
    let uv: Vec<[f32; 2]> = (0..7).map(|v| [v as f32, 0.0]).collect();
    let base = Mesh::new(positions, [[0, 1, 2], [4, 5, 3], [1, 6, 2]])
        .and_then(|m| m.with_attribute(Attribute::floats("uv", &uv)))
        .and_then(|m| m.with_materials([4, 7, 4]))
        .unwrap();
    let mut builder = WaveletBuilder::new(&base).unwrap();
    builder.subdivide_where(|face| face.base_face == 0, rough(1, 0.25)).unwrap();
    let mut first = true;
    builder.subdivide_where(|_| std::mem::take(&mut first), rough(1, 0.25)).unwrap();
    builder.build(&WaveletOptions::default()).unwrap()
}

fn refusal(parts: WaveletParts) -> String {
    WaveletMesh::try_from(parts).expect_err("broken parts").to_string()
}

/// The same vertices, but with these positions alone.
fn only(vertices: &Mesh, count: usize) -> Mesh {
    Mesh::new(vertices.positions().iter().cycle().take(count).copied().collect::<Vec<_>>(), []).unwrap()
}

type Break = fn(&mut WaveletParts);

/// One break of each promise, and what is then said.
const BREAKS: [(&str, Break); 35] = [
    // The base.
    ("99 base vertices are more than", |p| p.base_vertices = 99),
    ("there are 2 sides of base faces, not 3", |p| p.sides.truncate(2)),
    ("there are 3 sides of base faces, not 2", |p| p.base.truncate(2)),
    ("no base vertex at a corner of base face 1", |p| p.base[1][2] = 7),
    ("no base vertex at a corner of base face 2", |p| p.base_vertices = 6),
    ("wavelets along base face 0", |p| p.sides[0][1] = 18),
    ("wavelets along base face 0", |p| p.sides[0][1] = u32::MAX - 1),
    ("wavelets along base face 0", |p| p.sides[0][1] = p.sides[0][0]),
    ("wavelets along base face 0", |p| p.sides[0][1] = u32::MAX),
    ("wavelets along base face 2", |p| p.sides[2][0] = 10),
    ("wavelets along base face 0", |p| {
        let swap = |side: u32| if side < 4 { side ^ 2 } else { side };
        p.sides.as_flattened_mut().iter_mut().for_each(|side| *side = swap(*side));
    }),
    // Splits.
    ("vertices, not", |p| p.split[0] &= !2),
    ("vertices, not", |p| p.split[0] &= !8),
    ("bits of split faces, word 0", |p| p.split[0] |= 1 << 60),
    ("bits of split faces, word 1", |p| p.split.push(0)),
    ("more faces are split than there are vertices for, of level 2", |p| p.split[0] |= 0xff8),
    ("vertices", |p| p.split[0] |= 1 << 4),
    ("vertices", |p| p.split.clear()),
    // Seams.
    ("vertices, not", |p| p.seams[0][1] += 1),
    ("corners at seams, entry 2", |p| {
        let last = p.seams[1];
        p.seams.insert(1, last);
    }),
    ("vertices", |p| p.seams.clear()),
    ("corners at seams, entry 0", |p| p.seams.swap(0, 1)),
    // Values.
    ("vertices, not", |p| p.vertices = only(&p.vertices, p.vertices.positions().len() - 1)),
    ("vertices, not", |p| p.vertices = only(&p.vertices, p.vertices.positions().len() + 1)),
    ("there are 1 triangles beside the faces, not 0", |p| {
        p.vertices = Mesh::new(p.vertices.positions(), [[0, 1, 2]]).unwrap();
    }),
    ("65537 materials are more", |p| p.materials = (0..65_537).collect()),
    ("materials that do not ascend 1", |p| p.materials = vec![7, 7]),
    ("there are 2 groups of base faces, not 3", |p| p.group_of.truncate(2)),
    ("there are 3 groups of base faces, not 0", |p| p.materials.clear()),
    ("no such material of base face 1", |p| p.group_of[1] = 2),
    ("bounds, not", |p| p.bounds.truncate(3)),
    ("no lengths, of wavelet 1", |p| p.bounds[1].radius = f32::NAN),
    ("no lengths, of wavelet 2", |p| p.bounds[2].along = -1.0),
    ("no lengths, of wavelet 3", |p| p.bounds[3].across = f32::INFINITY),
    ("not within a parent's, of wavelet 5", |p| p.bounds[5].radius = 99.0),
];

#[test]
fn every_promise_is_checked() {
    let mesh = small();
    assert_eq!(mesh.validate(), Ok(()));
    let good = WaveletParts::from(mesh.clone());
    assert_eq!((good.base.len(), good.base_vertices, good.split[0] & 7), (3, 7, 0b011));
    assert!(good.seams.len() >= 2 && mesh.subdivision().depth() == 2);
    assert_eq!(WaveletMesh::try_from(good.clone()).unwrap(), mesh);
    let mut missed = Vec::new();
    for (at, (why, damage)) in BREAKS.into_iter().enumerate() {
        let mut parts = good.clone();
        damage(&mut parts);
        let said =
            WaveletMesh::try_from(parts).map_or_else(|error| error.to_string(), |_| "taken".to_owned());
        if !said.contains(why) {
            missed.push(format!("{at}: {why}: {said}"));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn nothing_is_a_wavelet_mesh_too() {
    let mesh = WaveletMesh::try_from(WaveletParts::default()).unwrap();
    let built = WaveletBuilder::new(&Mesh::default()).unwrap().build(&WaveletOptions::default()).unwrap();
    assert_eq!(mesh, built);
    use_it(mesh, 1);
    assert_eq!(Subdivision::default().depth(), 0);
}

/// Deep in one corner: as deep as may be, and no deeper.
#[test]
fn there_are_only_so_many_levels() {
    let mut builder = WaveletBuilder::new(&shapes::tetrahedron()).unwrap();
    for _ in 0..52 {
        let mut first = true;
        builder.subdivide_where(|_| std::mem::take(&mut first), |midpoint| midpoint.middle).unwrap();
    }
    let more = builder.subdivide(|midpoint| midpoint.middle).unwrap_err();
    assert!(more.to_string().contains("53 levels are more than 52"), "{more}");
    use_it(builder.build(&WaveletOptions::default()).unwrap(), 3);
}

/// So many triangles as may be along one edge, and one more.
#[test]
fn edges_have_only_so_many_triangles() {
    let book = |pages: u32| WaveletParts {
        base: (0..pages).map(|page| [0, 1, 2 + page]).collect(),
        base_vertices: 2 + pages,
        sides: (0..pages).map(|_| [0, u32::MAX, u32::MAX]).collect(),
        ..WaveletParts::default()
    };
    for pages in [250, 251] {
        let mut parts = book(pages);
        // All split: the shared edge, then two of every page.
        parts.sides[0] = [0, 2, 4];
        (1..pages).for_each(|page| parts.sides[page as usize] = [0, 4 * page + 2, 4 * page + 4]);
        parts.split = (0..pages.div_ceil(64)).map(|w| u64::MAX >> (64 - (pages - 64 * w).min(64))).collect();
        let count = (2 + pages + 1 + 2 * pages) as usize;
        let places: Vec<[f32; 3]> = (0..count).map(|v| [v as f32, hash(v as u64, 1) as f32, 0.0]).collect();
        parts.vertices = Mesh::new(places, []).unwrap();
        parts.bounds = vec![
            WaveletBounds { radius: 1.0, along: 1.0, across: 1.0, cone: [0; 4] };
            1 + 2 * pages as usize
        ];
        if pages == 250 {
            use_it(WaveletMesh::try_from(parts).unwrap(), 5);
        } else {
            assert!(refusal(parts).contains("251 triangles meet along an edge"));
        }
    }
}

/// Cuts of all kinds, drawn in all ways.
fn use_it(mesh: WaveletMesh, seed: u64) {
    assert_eq!(mesh.validate(), Ok(()));
    let again = WaveletMesh::try_from(WaveletParts::from(mesh.clone())).unwrap();
    // Attributes may be no numbers, which nothing is equal to.
    assert!(again == mesh || mesh.clone() != mesh);
    let of = mesh.subdivision();
    let (vertices, depth) = (of.vertex_count() as u32, of.depth());
    (0..=vertices)
        .for_each(|vertex| assert_eq!(mesh.coefficient(vertex).is_none(), of.ends(vertex).is_none()));
    let sound = |mesh: &Mesh| assert!(mesh.indices().iter().all(|&v| (v as usize) < mesh.positions().len()));
    sound(&mesh.finest(Normals::Recomputed));
    (0..=depth + 1).for_each(|level| sound(&mesh.at_level(level, Normals::Kept)));
    for triangulation in BOTH {
        let full = mesh.extract(|_| true, triangulation, Normals::Kept).triangles().len();
        assert_eq!(full, of.triangle_count());
        sound(&mesh.extract(|w| hash(w.into(), seed) < 0.3, triangulation, Normals::Kept));
        let set = mesh.largest_within(full / 2, triangulation);
        let drawn = mesh.extract(|wavelet| set[wavelet as usize], triangulation, Normals::Kept);
        assert!(drawn.triangles().len() <= (full / 2).max(of.base_face_count()));
    }
    let mesh = Arc::new(mesh);
    for kind in 0..4 {
        let options = buffer(kind / 2 == 1)
            .with_triangulation(BOTH[kind % 2])
            .with_geomorph((kind > 1).then(Geomorph::default))
            .with_triangles((kind > 0).then_some(of_half(&mesh)))
            .with_operations((kind == 3).then_some(20));
        let mut lod = instance(&mesh, &options);
        for frame in 0..4 {
            match mesh.extent() {
                Some(_) if mesh.diagonal() > 0.0 && frame != 2 => {
                    lod.adapt(&[view(&mesh, seed + frame, 0.5 + frame as f32).of_world()], 1.0 / 60.0);
                }
                _ => {
                    lod.adapt(&[], 1.0 / 60.0);
                }
            }
            for group in 0..lod.groups() {
                let known = lod.values().len();
                assert!(lod.triangles(group).as_flattened().iter().all(|&v| (v as usize) < known));
                assert_eq!(lod.base_faces(group).count(), lod.triangles(group).len());
            }
            lod.clean();
        }
        lod.settle();
        sound(&lod.to_mesh_with(Normals::Kept));
    }
}

fn of_half(mesh: &WaveletMesh) -> usize {
    mesh.subdivision().triangle_count() / 2
}

/// Changes entries of any of the arrays.
fn forge(parts: &mut WaveletParts, changes: &[(u8, prop::sample::Index, u32)]) {
    fn entry<'a, T>(all: &'a mut [T], at: &prop::sample::Index) -> Option<&'a mut T> {
        if all.is_empty() { None } else { Some(&mut all[at.index(all.len())]) }
    }
    for (kind, at, value) in changes {
        let small = value % 40;
        let set = |slot: Option<&mut u32>| slot.into_iter().for_each(|slot| *slot = small);
        match kind % 12 {
            0 => set(entry(parts.base.as_flattened_mut(), at)),
            1 => parts.base_vertices = small,
            2 => set(entry(parts.sides.as_flattened_mut(), at)),
            3 => entry(parts.sides.as_flattened_mut(), at).into_iter().for_each(|side| *side ^= 1),
            4 => entry(&mut parts.split, at).into_iter().for_each(|word| *word ^= 1 << (value % 64)),
            5 => set(entry(parts.seams.as_flattened_mut(), at)),
            6 => parts.seams.truncate(at.index(parts.seams.len() + 1)),
            7 => {
                let count = at.index(parts.vertices.positions().len() + 2);
                if !parts.vertices.positions().is_empty() {
                    parts.vertices = only(&parts.vertices, count);
                }
            }
            8 => entry(&mut parts.group_of, at).into_iter().for_each(|group| *group = (value % 4) as u16),
            9 => set(entry(&mut parts.materials, at)),
            10 => entry(&mut parts.bounds, at).into_iter().for_each(|bounds| {
                bounds.radius = f32::from_bits(*value);
                bounds.cone[(value % 4) as usize] = *value as i8;
            }),
            _ => entry(&mut parts.bounds, at)
                .into_iter()
                .for_each(|bounds| bounds.across = f32::from_bits(*value)),
        }
    }
}

fn any_mesh(kind: usize, seed: u64) -> WaveletMesh {
    if kind == 0 {
        return small();
    }
    let bases = bases();
    let base = dressed(bases[kind % bases.len()].1.clone());
    let options = options()[seed as usize % 3];
    if kind.is_multiple_of(2) { uniform(&base, 2, seed, &options) } else { patchy(&base, 3, seed, &options) }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn forged_parts_are_refused_or_safe(
        kind in 0usize..12,
        seed in 0u64..50,
        changes in prop::collection::vec((any::<u8>(), any::<prop::sample::Index>(), any::<u32>()), 1..4),
    ) {
        let mut parts = WaveletParts::from(any_mesh(kind, seed));
        forge(&mut parts, &changes);
        if let Ok(mesh) = WaveletMesh::try_from(parts) {
            use_it(mesh, seed);
        }
    }
}

/// Whatever is built is valid, with bounds of all kinds, and comes back.
#[test]
fn what_is_built_holds_its_promises() {
    for (at, options) in options().into_iter().enumerate() {
        for seed in 0..3 {
            for (name, base) in bases() {
                let base = dressed(base);
                for mesh in [uniform(&base, 3, seed, &options), patchy(&base, 5, seed, &options)] {
                    assert_eq!(mesh.validate(), Ok(()), "{name}, options {at}, seed {seed}");
                    assert_eq!(
                        WaveletMesh::try_from(WaveletParts::from(mesh.clone())).unwrap(),
                        mesh,
                        "{name}"
                    );
                    let found = WaveletMesh::recognise(&mesh.finest(Normals::Kept), &options);
                    if let Ok(found) = found {
                        assert_eq!(found.validate(), Ok(()), "{name} found");
                        assert_eq!(WaveletMesh::try_from(WaveletParts::from(found.clone())).unwrap(), found);
                    }
                }
            }
        }
    }
}

/// Larger than distances that single precision can tell, smaller, and far away.
#[test]
fn bounds_are_nested_at_the_edge_of_what_is_legal() {
    let sphere = shapes::icosphere(3);
    for (scale, shift) in [(3e38, 0.0), (1e-38, 0.0), (1e-44, 0.0), (1.0, 1e6), (1e30, 3e38)] {
        let place = |p: &[f32; 3]| p.map(|x| (x * scale + shift).clamp(-f32::MAX, f32::MAX));
        let positions: Vec<[f32; 3]> = sphere.positions().iter().map(place).collect();
        let mesh = Mesh::new(positions, sphere.triangles()).unwrap();
        for options in options() {
            // Where places fall together there is nothing to recognise.
            let Ok(mesh) = WaveletMesh::recognise(&mesh, &options) else { continue };
            assert_eq!(mesh.validate(), Ok(()), "{scale} {shift}");
        }
    }
}

#[cfg(feature = "io")]
mod files {
    use super::*;
    use multires::io::{bake, unbake};
    use multires::lod::Structure;

    #[test]
    fn bytes_come_back_as_they_were() {
        for kind in 0..10 {
            let mesh = any_mesh(kind, kind as u64);
            let bytes = bake(WaveletMesh::KIND, &mesh).unwrap();
            let back: WaveletMesh = unbake(WaveletMesh::KIND, &bytes).unwrap();
            assert_eq!(back, mesh);
            assert!(bake(WaveletMesh::KIND, &back).unwrap() == bytes);
            // Borrowed and owned parts are the same bytes.
            assert!(bake(WaveletMesh::KIND, &WaveletParts::from(mesh.clone())).unwrap() == bytes);
            let text = serde_json::to_string(&mesh).unwrap();
            assert_eq!(serde_json::from_str::<WaveletMesh>(&text).unwrap(), mesh);
            // What is built by another route is what comes back too.
            let at = |mesh: &WaveletMesh| mesh.extract(|w| w % 3 == 0, Triangulation::Minimal, Normals::Kept);
            assert_eq!(at(&back), at(&mesh));
        }
        // Mostly positions and bounds.
        let mesh = uniform(&shapes::icosphere(0), 5, 1, &WaveletOptions::default());
        let bytes = bake(WaveletMesh::KIND, &mesh).unwrap().len();
        assert!(bytes < 28 * mesh.subdivision().vertex_count() + 3000, "{bytes}");
    }

    fn config() -> impl bincode::config::Config {
        bincode::config::standard().with_fixed_int_encoding().with_limit::<{ 1 << 22 }>()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Any bytes changed, in a way that often still fits.
        #[test]
        fn forged_bytes_are_refused_or_safe(
            kind in 0usize..12,
            seed in 0u64..50,
            damage in prop::collection::vec((any::<prop::sample::Index>(), any::<bool>(), any::<u32>()), 1..4),
            noise in prop::collection::vec(any::<u8>(), 0..300),
        ) {
            let mut bytes = bincode::serde::encode_to_vec(any_mesh(kind, seed), config()).unwrap();
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
                if let Ok((mesh, _)) = bincode::serde::decode_from_slice::<WaveletMesh, _>(bytes, config()) {
                    use_it(mesh, seed);
                }
            }
        }
    }
}
