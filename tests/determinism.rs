//! Promise: the same bytes on every machine, for any number of threads, with and without optimisation.
//!
//! What changes results on purpose changes the table: the test prints the new one.
#![cfg(feature = "io")]

use std::fmt::Write;

use multires::hierarchy::{Dependencies, HierarchyBuilder, HierarchyOptions};
use multires::io::Stored;
use multires::lod::{Baked, Structure};
use multires::mesh::{Mesh, shapes};
use multires::simplify::metric::{EdgeLength, ErrorMetric, Hybrid, VolumeArea};
use multires::simplify::{ErrorMeasure, Order, Permissive, Placement, Simplifier};
use multires::{Gmesh, TotallyOrderedMesh, VertexHierarchy, WaveletMesh};
use rayon::ThreadPoolBuilder;
use twox_hash::XxHash3_64;

fn baked<S: Structure + Stored>(mesh: &Mesh) -> Vec<u8> {
    let Ok(model) = S::bake(mesh) else { panic!("{} of it", S::KIND) };
    model.to_bytes().unwrap()
}

/// The bytes of a sequence: steps, errors and new vertices are in those of a hierarchy of it.
fn sequence<M: ErrorMetric>(mesh: &Mesh, mut simplifier: Simplifier<M>) -> Vec<u8> {
    let sequence = simplifier.run(mesh).unwrap();
    let options = HierarchyOptions::default();
    Baked::<VertexHierarchy>::of_sequence(mesh, &sequence, &options).unwrap().to_bytes().unwrap()
}

fn hierarchy(mesh: &Mesh, dependencies: Dependencies) -> Vec<u8> {
    HierarchyBuilder::default().dependencies(dependencies).bake(mesh).unwrap().to_bytes().unwrap()
}

type Case = (&'static str, fn() -> Vec<u8>);

const CASES: [Case; 32] = [
    ("hierarchy, rock", || baked::<VertexHierarchy>(&shapes::rock(6_000, 1))),
    ("hierarchy, terrain", || baked::<VertexHierarchy>(&shapes::terrain(40, 2))),
    ("hierarchy, prop", || baked::<VertexHierarchy>(&shapes::prop(6))),
    ("hierarchy, robot", || baked::<VertexHierarchy>(&shapes::robot(3))),
    ("hierarchy, tree", || baked::<VertexHierarchy>(&shapes::tree(60))),
    ("hierarchy, tube with a skin", || baked::<VertexHierarchy>(&shapes::skinned_tube(16, 20))),
    ("hierarchy, painted disc", || baked::<VertexHierarchy>(&shapes::painted_disc(24, 10))),
    ("hierarchy, gear", || baked::<VertexHierarchy>(&shapes::gear(20, 0.3))),
    ("hierarchy, lettering", || baked::<VertexHierarchy>(&shapes::lettering(4, 1, 0.2))),
    ("hierarchy, part", || baked::<VertexHierarchy>(&shapes::cad_part(3))),
    ("hierarchy, box", || baked::<VertexHierarchy>(&shapes::box_with_face_normals(8))),
    ("hierarchy, forest", || baked::<VertexHierarchy>(&shapes::forest(40, 8, 1))),
    ("hierarchy, gravel", || baked::<VertexHierarchy>(&shapes::gravel(12, 1))),
    ("hierarchy, strip with one side", || baked::<VertexHierarchy>(&shapes::moebius(40))),
    ("hierarchy, fewest triangles", || {
        HierarchyBuilder::fewest_triangles().bake(&shapes::rock(3_000, 2)).unwrap().to_bytes().unwrap()
    }),
    ("hierarchy, manifold", || hierarchy(&shapes::torus_knot(2, 3, 80, 10), Dependencies::Manifold)),
    ("hierarchy, adjacent", || hierarchy(&shapes::torus_knot(2, 3, 80, 10), Dependencies::Adjacent)),
    ("ordered, sphere", || baked::<TotallyOrderedMesh>(&shapes::icosphere(4))),
    ("ordered, shell", || baked::<TotallyOrderedMesh>(&shapes::shell(3, 0.9))),
    ("ordered, soup", || baked::<TotallyOrderedMesh>(&shapes::soup(400, 3))),
    ("ordered, plate", || baked::<TotallyOrderedMesh>(&shapes::two_material_plate(30, 0.4))),
    ("ordered, hub", || baked::<TotallyOrderedMesh>(&shapes::hub(300))),
    ("optimal", || sequence(&shapes::rock(3_000, 3), Simplifier::new().placement(Placement::Optimal))),
    ("volume and area, midpoint", || {
        sequence(
            &shapes::rock(3_000, 4),
            Simplifier::new().metric(VolumeArea::new()).placement(Placement::Midpoint),
        )
    }),
    ("edge length, batches", || {
        sequence(&shapes::terrain(32, 4), Simplifier::new().metric(EdgeLength::new()).order(Order::Batched))
    }),
    ("hybrid", || sequence(&shapes::stepped_shaft(4, 20, 1), Simplifier::new().metric(Hybrid::new()))),
    ("verified", || sequence(&shapes::prop(5), Simplifier::new().error_measure(ErrorMeasure::Verified))),
    ("permissive", || sequence(&shapes::robot(2), Simplifier::new().permissive(Permissive::On))),
    ("wavelets, sphere", || baked::<WaveletMesh>(&shapes::icosphere(4))),
    ("wavelets, prop cut in four twice", || {
        baked::<WaveletMesh>(&shapes::cut_in_four(&shapes::cut_in_four(&shapes::prop(3))))
    }),
    ("g-mesh, rock", || baked::<Gmesh>(&shapes::rock(4_000, 6))),
    ("g-mesh, box", || baked::<Gmesh>(&shapes::box_with_face_normals(8))),
];

const HASHES: [u64; CASES.len()] = [
    0x7cc4_a044_020a_0f93, // hierarchy, rock
    0x300e_eb3e_eeb1_0d8f, // hierarchy, terrain
    0xd973_0f30_5e3d_0322, // hierarchy, prop
    0x17cf_c6c4_9bdf_b735, // hierarchy, robot
    0xeee9_6103_6373_d5f2, // hierarchy, tree
    0x15de_0faf_5283_ae4c, // hierarchy, tube with a skin
    0xc2e4_9d87_ecc8_79af, // hierarchy, painted disc
    0xf640_c146_e296_992d, // hierarchy, gear
    0x57ec_a9f0_9240_b966, // hierarchy, lettering
    0x2e16_3a3c_598f_f889, // hierarchy, part
    0x4013_84ff_5c82_9367, // hierarchy, box
    0x9b0c_585b_2235_8fa4, // hierarchy, forest
    0x433f_b9d2_59f2_7b8c, // hierarchy, gravel
    0x168b_746a_eb27_fde3, // hierarchy, strip with one side
    0x40d1_8a49_8118_8e0d, // hierarchy, fewest triangles
    0xda7c_1187_9b0a_c7c8, // hierarchy, manifold
    0x8460_f239_82b8_9fa7, // hierarchy, adjacent
    0xcb25_1425_9166_2c12, // ordered, sphere
    0xf83f_022b_b485_ee25, // ordered, shell
    0x79be_77a6_a4d5_7d6a, // ordered, soup
    0x4e0e_7848_524c_9496, // ordered, plate
    0xda21_23ec_6363_8201, // ordered, hub
    0x9349_e78a_391c_e79e, // optimal
    0xdb57_c5b0_d5d0_c898, // volume and area, midpoint
    0x34d6_9713_154f_bbbe, // edge length, batches
    0x357a_e8ba_c8b0_2507, // hybrid
    0x5c1c_9169_105d_ae55, // verified
    0xe690_d734_4638_c50b, // permissive
    0xa709_fc5f_d9db_23e2, // wavelets, sphere
    0x55bf_130f_9bcd_b17a, // wavelets, prop cut in four twice
    0x3391_20d3_3372_61f5, // g-mesh, rock
    0x2a14_8ac4_7f8d_c664, // g-mesh, box
];

fn hash(bytes: &[u8]) -> u64 {
    XxHash3_64::oneshot(bytes)
}

#[test]
fn every_machine_bakes_the_same_bytes() {
    let mut table = String::new();
    let mut same = true;
    for ((what, bake), &known) in CASES.iter().zip(&HASHES) {
        let found = hash(&bake());
        writeln!(table, "    0x{found:016x}, // {what}").unwrap();
        if found != known {
            eprintln!("{what}: 0x{found:016x}, not 0x{known:016x}");
            same = false;
        }
    }
    assert!(same, "all:\n{table}");
}

#[test]
fn any_number_of_threads_bakes_the_same_bytes() {
    for threads in [1, 2, 7] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for ((what, bake), &known) in CASES.iter().zip(&HASHES) {
            assert_eq!(pool.install(|| hash(&bake())), known, "{what} on {threads} threads");
        }
    }
}
