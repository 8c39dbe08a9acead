//! Promise: a store's instance draws what has arrived of what an instance of its model draws, in whatever order pages come, within
//! its cache; damaged pages change nothing.

use std::io::Cursor;

use multires::hierarchy::{Dependencies, HierarchyBuilder, VertexHierarchy};
use multires::io::Compression;
use multires::mesh::{Mesh, shapes};
use multires::prelude::*;
use multires::stream::store::{Store, StoreError, StoreLod, StoreOptions, write_store};
use multires::stream::{Server, StreamOptions, StreamVertex};
use multires::view::{ObjectView, look_at};
use multires::{Baked, LodOptions};
use proptest::prelude::*;

use crate::sent::{check_buffers, content, upload, view};

type Positions = StoreLod<[f32; 3], fn(StreamVertex<'_>) -> [f32; 3]>;

fn file(model: &Baked<VertexHierarchy>, options: &StoreOptions) -> Cursor<Vec<u8>> {
    let mut file = Vec::new();
    write_store(model, options, &mut file).unwrap();
    Cursor::new(file)
}

fn instance(store: &Store, cache: usize) -> Positions {
    store.instance(cache, &LodOptions::default(), |vertex| vertex.position())
}

/// Adapts and fetches until nothing is wanted. Returns the number of rounds.
fn fetch_all(lod: &mut Positions, file: &mut Cursor<Vec<u8>>, views: &[ObjectView]) -> usize {
    for round in 1.. {
        lod.adapt(views, 0.0);
        if lod.fetch(file, 1 << 17).unwrap() == 0 {
            return round;
        }
        assert!(round < 10_000);
    }
    unreachable!()
}

const EYES: [[f32; 3]; 6] =
    [[0.0, 0.3, 6.0], [0.0, 0.2, 1.6], [1.6, 0.1, 0.3], [0.0, -1.5, -0.6], [0.0, 0.3, 60.0], [0.1, 0.3, 1.7]];

fn check(model: &Baked<VertexHierarchy>, options: &StoreOptions) {
    let server = Server::new(model, &options.scalars).unwrap();
    let local = server.model();
    let values = local.values(|v| local.vertices().positions()[v]);
    let mut whole = local.instance(values, &LodOptions::default()).unwrap();
    let mut file = file(model, options);
    let store = Store::open(&mut file).unwrap();
    assert_eq!(store.full_triangles(), local.structure().triangle_count());
    let mut lod = instance(&store, usize::MAX);
    let mut buffers = Vec::new();
    for eye in EYES {
        let views = [view(eye, 1.0)];
        whole.adapt(&views, 0.0);
        let expected = content(&whole.to_mesh());
        for round in 0.. {
            lod.adapt(&views, 0.0);
            check_buffers(&lod);
            upload(&mut lod, &mut buffers);
            assert!(lod.refinements() <= whole.refinements());
            if lod.fetch(&mut file, 1 << 16).unwrap() == 0 {
                break;
            }
            assert!(round < 1_000);
        }
        assert_eq!(lod.refinements(), whole.refinements());
        assert!(content(&lod.to_mesh()) == expected, "{eye:?}");
        assert_eq!(lod.faults(), 0);
    }
    lod.refine_fully();
    while lod.fetch(&mut file, usize::MAX).unwrap() > 0 {
        lod.refine_fully();
    }
    whole.refine_fully();
    assert!(content(&lod.to_mesh()) == content(&whole.to_mesh()));
    assert_eq!(lod.pages(), store.page_count());
}

#[test]
fn draws_what_its_model_draws() {
    for mesh in [shapes::rock(12_000, 1), shapes::robot(4), shapes::demo()] {
        for kind in [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours] {
            let model = HierarchyBuilder::new().dependencies(kind).bake(&mesh).unwrap();
            check(&model, &StoreOptions::default());
        }
        let model = VertexHierarchy::bake(&mesh).unwrap();
        let scalars = StreamOptions::default().with_position_bits(Some(12));
        let options = StoreOptions::default().with_scalars(scalars).with_compression(Compression::None);
        check(&model, &options);
    }
}

#[test]
fn of_nothing() {
    let model = VertexHierarchy::bake(&Mesh::default()).unwrap();
    check(&model, &StoreOptions::default());
}

/// Over a terrain, with a cache of a quarter of its pages.
#[test]
fn the_cache_keeps_its_size() {
    let mesh = shapes::terrain(300, 1);
    let model = VertexHierarchy::bake(&mesh).unwrap();
    let mut file = file(&model, &StoreOptions::default());
    let store = Store::open(&mut file).unwrap();
    let mut whole = instance(&store, usize::MAX);
    whole.refine_fully();
    while whole.fetch(&mut file, usize::MAX).unwrap() > 0 {
        whole.refine_fully();
    }
    assert_eq!(whole.pages(), store.page_count());
    let cache = whole.cached_bytes() / 4;
    let mut lod = instance(&store, cache);
    let mut local = model.instance(model.arrange(mesh.positions()).unwrap(), &LodOptions::default()).unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for step in 0..60 {
        let [x, z] = [0.7 * (step as f32 / 60.0 - 0.5), 0.3 * (step as f32 * 0.2).sin()];
        let camera = look_at([x, 0.25, z], [x + 0.3, 0.0, z], [0.0, 1.0, 0.0]);
        let view = View::perspective(camera, 1.0, [1280, 720]).unwrap().with_tolerance_px(4.0);
        let views = [view.of_world()];
        lod.adapt(&views, 0.0);
        assert!(lod.cached_bytes() <= cache);
        check_buffers(&lod);
        seen.extend(lod.wanted().into_iter().map(|wanted| wanted.page));
        lod.fetch(&mut file, 1 << 16).unwrap();
        lod.clean();
        if step % 10 == 9 {
            fetch_all(&mut lod, &mut file, &views);
            local.adapt(&views, 0.0);
            assert!(content(&lod.to_mesh()) == content(&local.to_mesh()), "step {step}");
        }
    }
    assert!(seen.len() > lod.pages(), "no page went: {} {}", seen.len(), lod.pages());
    // Far too small a cache: coarse, and nothing wrong.
    let mut lod = instance(&store, cache / 8);
    fetch_all(&mut lod, &mut file, &[view([0.1, 0.2, 0.1], 0.1)]);
    assert!(lod.cached_bytes() <= cache / 8 && lod.refinements() > 0);
    check_buffers(&lod);
}

#[test]
fn a_limit_of_triangles_is_kept() {
    let model = VertexHierarchy::bake(&shapes::rock(20_000, 1)).unwrap();
    let mut file = file(&model, &StoreOptions::default());
    let store = Store::open(&mut file).unwrap();
    let mut options = LodOptions::default();
    options.triangles = Some(3_000);
    let mut lod: Positions = store.instance(usize::MAX, &options, |vertex| vertex.position());
    for eye in EYES {
        let views = [view(eye, 0.1)];
        for _ in 0..200 {
            lod.adapt(&views, 0.0);
            assert!(lod.triangles(0).len() <= 3_000);
            lod.fetch(&mut file, 1 << 16).unwrap();
        }
        assert!(lod.wanted().is_empty());
        if eye[2] < 10.0 {
            assert!(lod.triangles(0).len() > 2_700, "{eye:?}: {}", lod.triangles(0).len());
        }
        check_buffers(&lod);
    }
}

/// Operations a frame: pages of splits that are on their way stay.
#[test]
fn limits_of_operations_are_kept() {
    let model = VertexHierarchy::bake(&shapes::rock(20_000, 1)).unwrap();
    let mut file = file(&model, &StoreOptions::default());
    let store = Store::open(&mut file).unwrap();
    let mut options = LodOptions::default();
    options.operations = Some(300);
    let mut lod: Positions = store.instance(1 << 19, &options, |vertex| vertex.position());
    for step in 0..400 {
        let angle = step as f32 * 0.05;
        let change = lod.adapt(&[view([1.3 * angle.cos(), 0.3, 1.3 * angle.sin()], 2.0)], 0.0);
        assert!(change.cut.splits + change.cut.collapses <= 300);
        lod.fetch(&mut file, 1 << 17).unwrap();
        assert!(lod.cached_bytes() <= 1 << 19);
        if step % 20 == 0 {
            check_buffers(&lod);
        }
    }
}

/// A byte of a page or of the header is another: an error, or the same content.
#[test]
fn damage_is_detected() {
    let model = VertexHierarchy::bake(&shapes::rock(5_000, 1)).unwrap();
    for compression in [Compression::None, Compression::Lz4] {
        let whole = file(&model, &StoreOptions::default().with_compression(compression)).into_inner();
        let store = Store::open(&mut Cursor::new(&whole)).unwrap();
        let header = Store::header_length(&whole).unwrap() as usize;
        for at in (0..header).step_by(97) {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << (at % 8);
            assert!(Store::open(&mut Cursor::new(bytes)).is_err(), "byte {at}");
        }
        assert!(Store::from_header(whole[..header].to_vec(), whole.len() as u64 + 1).is_err());
        assert!(Store::open(&mut Cursor::new(&whole[..whole.len() - 1])).is_err());
        let mut lod = instance(&store, usize::MAX);
        lod.adapt(&[view(EYES[1], 0.1)], 0.0);
        let wanted = lod.wanted().remove(0);
        let range = wanted.range.start as usize..wanted.range.end as usize;
        let page = &whole[range];
        for at in (0..page.len()).step_by(389) {
            let mut bytes = page.to_vec();
            bytes[at] ^= 1 << (at % 8);
            assert!(lod.supply(wanted.page, bytes).is_err(), "byte {at}");
        }
        for length in [0, 1, 63, 64, 1_000, page.len() - 1] {
            assert!(lod.supply(wanted.page, page[..length].to_vec()).is_err());
        }
        let other = lod.supply(wanted.page + 1, page.to_vec());
        assert!(matches!(other, Err(StoreError::OtherPage { .. })));
        let beyond = lod.supply(1_000, page.to_vec());
        assert!(matches!(beyond, Err(StoreError::NoPage { page: 1_000, .. })));
        assert_eq!(lod.pages(), 0);
        assert!(lod.supply(wanted.page, page.to_vec()).unwrap());
        assert_eq!(lod.pages(), 1);
    }
}

/// Pages of another version of the model are refused.
#[test]
fn pages_of_another_store_are_refused() {
    let stores = [1, 2].map(|seed| {
        file(&VertexHierarchy::bake(&shapes::rock(5_000, seed)).unwrap(), &StoreOptions::default())
            .into_inner()
    });
    let store = Store::open(&mut Cursor::new(&stores[0])).unwrap();
    let other = Store::open(&mut Cursor::new(&stores[1])).unwrap();
    let range = other.page_range(0).unwrap();
    let page = stores[1][range.start as usize..range.end as usize].to_vec();
    assert!(matches!(instance(&store, usize::MAX).supply(0, page), Err(StoreError::OtherPage { page: 0 })));
}

#[test]
fn equal_models_give_equal_bytes() {
    let model = VertexHierarchy::bake(&shapes::robot(3)).unwrap();
    let bytes = || file(&model, &StoreOptions::default()).into_inner();
    assert!(bytes() == bytes());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Pages come late, in any order, while the eye moves.
    #[test]
    fn the_order_of_pages_does_not_matter(seed in any::<u64>(), kind in 0..3_usize) {
        let kind = [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours][kind];
        let mesh = shapes::rock(8_000, 5);
        let model = HierarchyBuilder::new().dependencies(kind).bake(&mesh).unwrap();
        let whole = file(&model, &StoreOptions::default()).into_inner();
        let store = Store::open(&mut Cursor::new(&whole)).unwrap();
        let mut lod = instance(&store, usize::MAX);
        let mut state = seed | 1;
        let mut random = |most: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % most
        };
        for _ in 0..40 {
            let eye = EYES[random(EYES.len())];
            lod.adapt(&[view(eye, [0.5, 2.0][random(2)])], 0.0);
            check_buffers(&lod);
            // Any page, wanted or not.
            let page = random(store.page_count());
            let range = store.page_range(page as u32).unwrap();
            if random(3) == 0 {
                lod.supply(page as u32, whole[range.start as usize..range.end as usize].to_vec()).unwrap();
            }
        }
        let views = [view(EYES[1], 0.7)];
        fetch_all(&mut lod, &mut Cursor::new(whole), &views);
        let mut local = model.instance(model.arrange(mesh.positions()).unwrap(), &LodOptions::default()).unwrap();
        local.adapt(&views, 0.0);
        prop_assert!(content(&lod.to_mesh()) == content(&local.to_mesh()));
    }
}
