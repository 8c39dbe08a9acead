//! Promise: a baked hierarchy takes no more memory than a multiple of its file, whatever the file says; nor do its instances.
#![cfg(feature = "io")]

use multires::hierarchy::{Dependencies, HierarchyBuilder, HierarchyLod, VertexHierarchy};
use multires::io::{bake, unbake};
use multires::lod::{Baked, Lod, Structure};
use multires::mesh::shapes;
use multires::simplify::Placement;
use multires::view::{View, look_at};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Most bytes held at once by a call, above what was held before.
fn peak<T>(call: impl FnOnce() -> T) -> (usize, T) {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let result = call();
    (ALLOCATOR.peak_usage().saturating_sub(before), result)
}

/// What serde reserves at most for an array before its elements are there, twice.
const FLOOR: usize = 2 << 20;
const FACTOR: usize = 4;

/// Bytes that serialise as themselves.
struct Raw<'a>(&'a [u8]);

impl serde::Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeTuple;
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

#[test]
fn memory_is_a_multiple_of_the_file() {
    let mesh = shapes::rock(20_000, 1);
    let bundle = HierarchyBuilder::new()
        .placement(Placement::Optimal)
        .dependencies(Dependencies::Neighbours)
        .bake(&mesh)
        .unwrap();
    let bytes = bake(VertexHierarchy::KIND, &bundle).unwrap();
    let (held, back) = peak(|| unbake::<Baked<VertexHierarchy>>(VertexHierarchy::KIND, &bytes).unwrap());
    assert!(held <= FACTOR * bytes.len() + FLOOR, "{held} of {}", bytes.len());

    let (held, lod) = peak(|| {
        let mut lod = HierarchyLod::packed(back.structure().clone());
        let matrix = look_at([0.0, 0.0, 0.1], [0.0; 3], [0.0, 1.0, 0.0]);
        let view = View::perspective(matrix, 1.0, [1000, 1000]).unwrap().with_tolerance_px(0.0);
        lod.adapt(&[view.with_frustum(false).with_back_faces_culled(false).of_world()], 1.0 / 60.0);
        lod
    });
    assert_eq!(lod.triangles(0).len(), mesh.triangles().len());
    assert!(held <= FACTOR * bytes.len() + FLOOR, "{held} of {}", bytes.len());

    // Any length or number in a small file made as large as can be.
    let small = HierarchyBuilder::new().bake(&shapes::icosphere(2)).unwrap();
    let content = bake(VertexHierarchy::KIND, &small).unwrap().split_off(128);
    for at in (0..content.len() - 8).step_by(4) {
        for value in [u64::MAX, 1 << 32, 1 << 30, 1 << 24] {
            let mut forged = content.clone();
            forged[at..at + 8].copy_from_slice(&value.to_le_bytes());
            let bytes = bake(VertexHierarchy::KIND, &Raw(&forged)).unwrap();
            let (held, _) = peak(|| unbake::<Baked<VertexHierarchy>>(VertexHierarchy::KIND, &bytes).is_ok());
            assert!(held <= FACTOR * bytes.len() + FLOOR, "{held} of {} at {at}", bytes.len());
        }
    }
}
