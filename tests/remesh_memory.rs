//! Promise: a remesh takes at most 400 bytes a triangle of the mesh while it runs, and what it makes.

use multires::mesh::shapes;
use multires::remesh::{Depth, Remesher};
use multires::wavelet::WaveletOptions;
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Bytes a triangle of the mesh.
const MOST: f64 = 400.0;

/// One test, so that nothing else allocates meanwhile.
#[test]
fn memory_is_bounded_by_the_size_of_the_mesh() {
    let mesh = shapes::rock(60_000, 1);
    let triangles = mesh.triangles().len() as f64;
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let map = Remesher::new().run(&mesh).unwrap();
    let kept = ALLOCATOR.current_usage() - before;
    let peak = (ALLOCATOR.peak_usage() - before) as f64 / triangles;
    println!("map: at most {peak:.0} bytes a triangle, {:.0} kept", kept as f64 / triangles);
    assert!(peak < MOST, "{peak}");
    // What is kept is what the map reports, and the base.
    assert!(
        kept < map.memory() + 200 * map.base().triangles().len() + 10_000,
        "{kept}, {} reported",
        map.memory()
    );

    ALLOCATOR.reset_peak_usage();
    let model = map.bake(&mesh, Depth::Levels(3), &WaveletOptions::default()).unwrap();
    let peak = (ALLOCATOR.peak_usage() - before) as f64 / triangles;
    let count = model.structure().subdivision().triangle_count() as f64;
    let made = ALLOCATOR.current_usage() - before - kept;
    println!(
        "model of {count} triangles: at most {peak:.0} bytes a triangle of the mesh, {:.0} a triangle kept",
        made as f64 / count
    );
    assert!(peak < MOST, "{peak}");
}
