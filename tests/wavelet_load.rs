//! Promise: no file of a wavelet mesh reserves more than a multiple of its size, whatever it says, or takes long.
#![cfg(feature = "io")]

use multires::io::{bake, unbake};
use multires::lod::{Baked, Origins, Structure};
use multires::mesh::{Mesh, shapes};
use multires::wavelet::{WaveletBuilder, WaveletMesh, WaveletOptions, WaveletParts};
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

/// A model as it is written.
#[derive(serde::Serialize)]
struct Written<'a> {
    vertices: &'a Mesh,
    structure: &'a WaveletParts,
    origins: &'a Origins,
}

/// Peak of what comes of parts in a file, in bytes of the file; and why it is refused. The same of a model of them, which has
/// no origins.
fn load(parts: &WaveletParts) -> (f64, Option<String>) {
    let bytes = bake(WaveletMesh::KIND, parts).unwrap();
    let (most, result) = peak(|| unbake::<WaveletMesh>(WaveletMesh::KIND, &bytes));
    let factor = most as f64 / bytes.len() as f64;

    let model = Written { vertices: &Mesh::default(), structure: parts, origins: &Origins::default() };
    let bytes = bake(WaveletMesh::KIND, &model).unwrap();
    let (most, whole) = peak(|| unbake::<Baked<WaveletMesh>>(WaveletMesh::KIND, &bytes));
    let (refused, whole) = (result.err().map(|error| error.to_string()), whole.unwrap_err().to_string());
    match &refused {
        Some(why) => assert_eq!(&whole, why),
        None => assert!(whole.contains("there are 0 origins"), "{whole}"),
    }
    (factor.max(most as f64 / bytes.len() as f64), refused)
}

/// A strip of triangles, each at the edge of the last.
fn strip(count: u32) -> WaveletParts {
    let side = |k: u32| if k == 0 || k == count { u32::MAX } else { 2 * (k - 1) };
    WaveletParts {
        base: (0..count).map(|t| [t, t + 1, t + 2]).collect(),
        base_vertices: count + 2,
        sides: (0..count).map(|t| [side(t), side(t + 1), u32::MAX]).collect(),
        vertices: Mesh::new((0..count + 2).map(|v| [v as f32, (v % 2) as f32, 0.0]).collect::<Vec<_>>(), [])
            .unwrap(),
        ..WaveletParts::default()
    }
}

#[test]
fn memory_and_time_go_with_the_file() {
    // As it should be: buffers of a subdivision, the vertices, the bounds.
    let mut builder = WaveletBuilder::new(&shapes::icosphere(0)).unwrap();
    for _ in 0..6 {
        builder.subdivide(|midpoint| midpoint.middle).unwrap();
    }
    let good = WaveletParts::from(builder.build(&WaveletOptions::default()).unwrap());
    let (factor, refused) = load(&good);
    assert!(factor < 8.0 && refused.is_none(), "{factor} {refused:?}");

    // All faces split for as many levels as there are bits.
    let mut parts = good.clone();
    parts.split = vec![u64::MAX; 200_000];
    let (factor, refused) = load(&parts);
    assert!(
        factor < 8.0 && refused.as_ref().is_some_and(|why| why.contains("more faces are split")),
        "{factor} {refused:?}"
    );
    parts = WaveletParts { split: vec![u64::MAX; 200_000], ..strip(1000) };
    let (factor, refused) = load(&parts);
    assert!(factor < 8.0 && refused.is_some(), "{factor} {refused:?}");

    // Base vertices that are not there.
    parts = WaveletParts { base_vertices: u32::MAX, ..good.clone() };
    let (factor, refused) = load(&parts);
    assert!(
        factor < 3.0 && refused.as_ref().is_some_and(|why| why.contains("base vertices")),
        "{factor} {refused:?}"
    );

    // A long strip with a seam at every edge, one end split: faces beside it stay whole, and wedges of vertices that are missing
    // are counted without a walk along the strip.
    for reverse in [false, true] {
        let mut parts = strip(300_000);
        parts.sides.iter_mut().filter(|sides| sides[0] != u32::MAX).for_each(|sides| sides[0] ^= 1);
        let at = if reverse { 299_999 } else { 0 };
        parts.split = vec![0; 300_000_usize.div_ceil(64)];
        parts.split[at / 64] = 1 << (at % 64);
        let (factor, refused) = load(&parts);
        assert!(
            factor < 12.0 && refused.as_ref().is_some_and(|why| why.contains("vertices, not")),
            "{factor} {refused:?}"
        );
    }

    // As many triangles at an edge as may be, all but one coarse, and that one deep: most memory for what it is.
    let book: Vec<[u32; 3]> = (0..250).map(|page| [0, 1, 2 + page]).collect();
    let places: Vec<[f32; 3]> = (0..252).map(|v| [v as f32, (v * v % 17) as f32, (v % 5) as f32]).collect();
    let mut builder = WaveletBuilder::new(&Mesh::new(places, book).unwrap()).unwrap();
    for _ in 0..6 {
        let on_edge = |p: &[f32; 3]| p[1] == p[0] && p[0] == p[2];
        let at_edge = |face: &multires::wavelet::Face| {
            face.base_face == 0 && face.corners.iter().filter(|p| on_edge(p)).count() == 2
        };
        builder.subdivide_where(at_edge, |midpoint| midpoint.middle).unwrap();
    }
    let book = WaveletParts::from(builder.build(&WaveletOptions::default()).unwrap());
    let (factor, refused) = load(&book);
    assert!(factor < 40.0 && refused.is_none(), "{factor} {refused:?}");
    eprintln!("{factor} {refused:?}");
}
