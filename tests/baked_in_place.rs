//! Promise: a baked file is used in place: arrays lie in the bytes given, and equal the model written, compressed or not; damaged
//! and hostile files are refused or give a valid model, without a panic and without reserving more than a multiple of their size.
#![cfg(feature = "io")]

use std::ops::Range;
use std::sync::Arc;

use multires::io::{self, Aligned, BakeError, BakeOptions, Compression, OpenOptions, Stored, Trust};
use multires::lod::{Baked, FromSequence, Level, Structure};
use multires::mesh::{Attribute, AttributeValues, Mesh, names, shapes};
use multires::wavelet::WaveletMesh;
use multires::{Gmesh, TotallyOrderedMesh, VertexHierarchy};
use peak_alloc::PeakAlloc;
use twox_hash::XxHash3_64;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// A mesh that all structures take, with two attributes, two materials and locks.
fn mesh(triangles: u32) -> Mesh {
    let rock = shapes::rock(triangles, 2);
    let uv: Vec<[f32; 2]> = rock.positions().iter().map(|p| [p[0] - p[2], p[1]]).collect();
    let ids = (0..rock.positions().len() as u32).map(|_| 7).collect();
    let locks = vec![false; rock.positions().len()];
    rock.with_attribute(Attribute::floats(names::UV, &uv))
        .unwrap()
        .with_attribute(Attribute::new("id", 1, AttributeValues::Uint(ids)))
        .unwrap()
        .with_material_names(["a".to_owned()])
        .with_locks(locks)
        .unwrap()
}

/// A mesh of two materials.
fn two_materials() -> Mesh {
    let mesh = shapes::rock(320, 3);
    let materials: Vec<u32> =
        mesh.triangles().iter().map(|t| u32::from(mesh.positions()[t[0] as usize][1] > 0.0)).collect();
    mesh.with_materials(materials).unwrap()
}

fn options() -> [BakeOptions; 3] {
    let default = BakeOptions::default();
    [default, default.with_derived(false), default.with_compression(Compression::Lz4)]
}

fn checked() -> OpenOptions {
    OpenOptions::default()
}

fn own() -> OpenOptions {
    OpenOptions::default().with_trust(Trust::Own)
}

/// Whether a slice lies in bytes.
fn lies_in<T>(slice: &[T], bytes: &[u8]) -> bool {
    let (own, all) = (slice.as_ptr_range(), bytes.as_ptr_range());
    !slice.is_empty() && own.start.cast() >= all.start && own.end.cast() <= all.end
}

fn comes_back<S: Stored + PartialEq + std::fmt::Debug>(model: &Baked<S>) {
    for options in options() {
        let bytes = model.to_bytes_with(options).unwrap();
        assert_eq!(model.to_bytes_with(options).unwrap(), bytes);
        let copied = Baked::<S>::from_bytes(&bytes).unwrap();
        let shared = Baked::<S>::from_shared(Arc::new(bytes.clone()), checked()).unwrap();
        let trusted = Baked::<S>::from_shared(Arc::new(bytes.clone()), own()).unwrap();
        for back in [&copied, &shared, &trusted] {
            assert_eq!(back, model);
            assert_eq!(back.to_bytes_with(options).unwrap(), bytes);
            assert_eq!(back.level(Level::Ratio(0.3)).mesh, model.level(Level::Ratio(0.3)).mesh);
        }
        assert_eq!(io::baked_kind(&bytes).unwrap(), S::KIND);
        assert_eq!(io::baked_version(&bytes).unwrap(), 4);
        let sections = io::baked_sections(&bytes).unwrap();
        assert!(sections.iter().all(|section| section.offset % 64 == 0));
        assert!(
            sections.iter().any(|section| section.compressed) == (options.compression != Compression::None)
        );
    }
    let sizes = options().map(|options| model.to_bytes_with(options).unwrap().len());
    assert!(sizes[2] < sizes[1] && sizes[1] <= sizes[0], "{}: {sizes:?}", S::KIND);
}

#[test]
fn every_structure_comes_back() {
    for mesh in [mesh(1_280), two_materials()] {
        comes_back(&VertexHierarchy::bake(&mesh).unwrap());
        comes_back(&TotallyOrderedMesh::bake(&mesh).unwrap());
        comes_back(&Gmesh::bake(&mesh).unwrap());
    }
    comes_back(&WaveletMesh::bake(&mesh(1_280)).unwrap());
    let optimal = VertexHierarchy::simplifier().placement(multires::simplify::Placement::Optimal);
    let needs = multires::hierarchy::HierarchyOptions::default()
        .with_dependencies(multires::hierarchy::Dependencies::Neighbours);
    let mut builder = multires::hierarchy::HierarchyBuilder::new().simplifier(optimal).options(needs);
    comes_back(&builder.bake(&shapes::rock(600, 1)).unwrap());
}

#[test]
fn arrays_lie_in_the_bytes() {
    let mesh = mesh(1_280);
    fn open<S: Stored>(bytes: Vec<u8>) -> (Baked<S>, Arc<Vec<u8>>) {
        let bytes = Arc::new(bytes);
        (Baked::from_shared(bytes.clone(), checked()).unwrap(), bytes)
    }
    fn vertices_lie_in<S: Stored>(model: &Baked<S>, bytes: &[u8]) {
        assert!(lies_in(model.vertices().positions(), bytes), "{}", S::KIND);
        assert!(lies_in(model.vertices().attribute(names::UV).unwrap().as_floats().unwrap(), bytes));
        assert!(lies_in(model.origins().order(), bytes));
        // An attribute's values are a copy, made when asked for.
        let AttributeValues::Uint(ids) = model.vertices().attribute("id").unwrap().values() else { panic!() };
        assert!(!lies_in(ids, bytes) && ids.iter().all(|&id| id == 7));
    }
    let model = VertexHierarchy::bake(&mesh).unwrap();
    let (hierarchy, bytes) = open::<VertexHierarchy>(model.to_bytes().unwrap());
    assert!(lies_in(hierarchy.structure().triangles(), &bytes));
    vertices_lie_in(&hierarchy, &bytes);
    // The model keeps the bytes alive, and clones share them.
    let whole = Arc::downgrade(&bytes);
    let clone = hierarchy.clone();
    drop((hierarchy, bytes));
    assert!(whole.upgrade().is_some());
    assert_eq!(clone, model);
    drop(clone);
    assert!(whole.upgrade().is_none());

    let (tom, bytes) =
        open::<TotallyOrderedMesh>(TotallyOrderedMesh::bake(&mesh).unwrap().to_bytes().unwrap());
    assert!(lies_in(tom.structure().triangles(), &bytes) && lies_in(tom.structure().error_marks(), &bytes));
    vertices_lie_in(&tom, &bytes);
    let (gmesh, bytes) = open::<Gmesh>(Gmesh::bake(&mesh).unwrap().to_bytes().unwrap());
    assert!(
        lies_in(gmesh.structure().targets(), &bytes) && lies_in(gmesh.structure().index_buffer(0), &bytes)
    );
    vertices_lie_in(&gmesh, &bytes);
    let (wavelet, bytes) = open::<WaveletMesh>(WaveletMesh::bake(&mesh).unwrap().to_bytes().unwrap());
    vertices_lie_in(&wavelet, &bytes);

    let compressed = BakeOptions::default().with_compression(Compression::Lz4);
    let (copied, bytes) = open::<VertexHierarchy>(model.to_bytes_with(compressed).unwrap());
    assert!(!lies_in(copied.structure().triangles(), &bytes));
}

/// Bytes at an odd address.
struct Shifted(Vec<u8>, usize);

impl AsRef<[u8]> for Shifted {
    fn as_ref(&self) -> &[u8] {
        &self.0[self.1..]
    }
}

#[test]
fn misaligned_bytes_are_copied() {
    let model = TotallyOrderedMesh::bake(&mesh(320)).unwrap();
    let bytes = model.to_bytes().unwrap();
    for shift in 0..=8 {
        let shifted = [&vec![0; shift], &bytes[..]].concat();
        let shifted = Arc::new(Shifted(shifted, shift));
        let opened = Baked::<TotallyOrderedMesh>::from_shared(shifted.clone(), checked()).unwrap();
        assert_eq!(opened, model);
        let address = (*shifted).as_ref().as_ptr() as usize;
        assert_eq!(lies_in(opened.structure().triangles(), (*shifted).as_ref()), address.is_multiple_of(4));
    }
    static STATIC: &Aligned<[u8]> = &Aligned(*b"\x89MRES");
    assert_eq!(STATIC.0.as_ptr() as usize % 64, 0);
    assert!(matches!(io::open_model::<u8>(Arc::new(STATIC), checked()), Err(BakeError::NotBaked)));
}

#[test]
fn shared_bytes_of_any_kind_open() {
    let model = Gmesh::bake(&mesh(320)).unwrap();
    let bytes = model.to_bytes().unwrap();
    let any = io::open_model::<[f32; 3]>(Arc::new(bytes.clone()), checked()).unwrap();
    assert!(any.as_any().downcast_ref::<Baked<Gmesh>>() == Some(&model));
    let leaked: &'static [u8] = bytes.clone().leak();
    assert_eq!(Baked::<Gmesh>::from_shared(Arc::new(leaked), own()).unwrap(), model);
    let path = std::env::temp_dir().join(format!("multires-in-place-{}.mres", std::process::id()));
    any.write_with(&path, BakeOptions::default()).unwrap();
    let read = io::read_model_with::<[f32; 3]>(&path, own()).unwrap();
    assert!(read.as_any().downcast_ref::<Baked<Gmesh>>() == Some(&model));
    assert_eq!(Baked::<Gmesh>::read_with(&path, checked()).unwrap(), model);
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    std::fs::remove_file(&path).unwrap();
}

fn flips<S: Stored + PartialEq + std::fmt::Debug>(model: &Baked<S>, bits: &[u8]) {
    for options in [options()[0], options()[2]] {
        let bytes = model.to_bytes_with(options).unwrap();
        let mut damaged = bytes.clone();
        for at in 0..bytes.len() {
            for bit in bits {
                damaged[at] ^= 1 << bit;
                if let Ok(back) = Baked::<S>::from_bytes(&damaged) {
                    assert_eq!(&back, model, "byte {at}");
                }
                // Of a trusted file only this: it does not panic here.
                let _ = Baked::<S>::from_shared(Arc::new(damaged.clone()), own());
                damaged[at] = bytes[at];
            }
        }
        for end in 0..bytes.len() {
            assert!(Baked::<S>::from_bytes(&bytes[..end]).is_err(), "{end} bytes");
            assert!(Baked::<S>::from_shared(Arc::new(bytes[..end].to_vec()), own()).is_err());
        }
        let longer = [&bytes[..], &[0; 3]].concat();
        assert!(matches!(Baked::<S>::from_bytes(&longer), Err(BakeError::Trailing { bytes: 3 })));
    }
}

#[test]
fn no_flipped_bit_and_no_truncation_gets_through() {
    flips(&VertexHierarchy::bake(&mesh(20)).unwrap(), &[0, 1, 2, 3, 4, 5, 6, 7]);
    flips(&TotallyOrderedMesh::bake(&mesh(20)).unwrap(), &[2, 7]);
    flips(&Gmesh::bake(&mesh(80)).unwrap(), &[4]);
    flips(&WaveletMesh::bake(&mesh(80)).unwrap(), &[0]);
}

/// A file to be forged: entries of 64 bytes and sections.
struct Forged {
    kind: [u8; 16],
    sections: Vec<([u8; 64], Vec<u8>)>,
}

const OFFSET: Range<usize> = 16..24;
const STORED: Range<usize> = 24..32;
const PLAIN: Range<usize> = 32..40;

impl Forged {
    fn of(bytes: &[u8]) -> Self {
        let count = u32::from_le_bytes(bytes[28..32].try_into().unwrap()) as usize;
        let number =
            |entry: &[u8], at: Range<usize>| u64::from_le_bytes(entry[at].try_into().unwrap()) as usize;
        let entries = bytes[64..64 * (1 + count)].chunks(64);
        let section = |entry: &[u8]| {
            let start = number(entry, OFFSET);
            let own = bytes[start..start + number(entry, STORED)].to_vec();
            (entry.try_into().unwrap(), own)
        };
        Self { kind: bytes[12..28].try_into().unwrap(), sections: entries.map(section).collect() }
    }

    /// Returns the file with offsets, lengths and checksums that fit; `forge` changes the table then, and the header's
    /// checksum fits that.
    fn bytes(&self, forge: impl Fn(&mut [u8])) -> Vec<u8> {
        let mut bytes = vec![0; 64 * (1 + self.sections.len())];
        for (i, (entry, section)) in self.sections.iter().enumerate() {
            bytes.resize(bytes.len().next_multiple_of(64), 0);
            let offset = bytes.len() as u64;
            bytes.extend(section);
            let own = &mut bytes[64 * (1 + i)..64 * (2 + i)];
            own.copy_from_slice(entry);
            own[OFFSET].copy_from_slice(&offset.to_le_bytes());
            own[STORED].copy_from_slice(&(section.len() as u64).to_le_bytes());
            if own[52] == 0 {
                own[PLAIN].copy_from_slice(&(section.len() as u64).to_le_bytes());
            }
            own[40..48].copy_from_slice(&XxHash3_64::oneshot(section).to_le_bytes());
        }
        let length = bytes.len() as u64;
        bytes[..8].copy_from_slice(b"\x89MRES\r\n\x1a");
        bytes[8..12].copy_from_slice(&4_u32.to_le_bytes());
        bytes[12..28].copy_from_slice(&self.kind);
        bytes[28..32].copy_from_slice(&(self.sections.len() as u32).to_le_bytes());
        bytes[32..40].copy_from_slice(&length.to_le_bytes());
        bytes[40..48].fill(0);
        forge(&mut bytes);
        let table = (64 * (1 + self.sections.len())).min(bytes.len());
        let sum = XxHash3_64::oneshot(&bytes[..table]);
        bytes[40..48].copy_from_slice(&sum.to_le_bytes());
        bytes
    }
}

#[test]
fn hostile_tables_are_refused() {
    let model = VertexHierarchy::bake(&mesh(320)).unwrap();
    let compressed = BakeOptions::default().with_compression(Compression::Lz4);
    let good = Forged::of(&model.to_bytes().unwrap());
    let packed = Forged::of(&model.to_bytes_with(compressed).unwrap());
    assert_eq!(Baked::<VertexHierarchy>::from_bytes(&good.bytes(|_| ())).unwrap(), model);
    assert_eq!(good.bytes(|_| ()), model.to_bytes().unwrap());
    assert_eq!(packed.bytes(|_| ()), model.to_bytes_with(compressed).unwrap());
    // Entry 3 has an array.
    let entry = |field: Range<usize>| 4 * 64 + field.start..4 * 64 + field.end;
    let set = |field: Range<usize>, value: u64| {
        move |bytes: &mut [u8]| bytes[entry(field.clone())].copy_from_slice(&value.to_le_bytes())
    };
    type Forge = Box<dyn Fn(&mut [u8])>;
    let forgeries: Vec<(&str, Forge)> = vec![
        ("overlap", Box::new(move |b| b.copy_within(3 * 64 + 16..3 * 64 + 24, 4 * 64 + 16))),
        ("beyond the end", Box::new(set(OFFSET, 1 << 40))),
        ("at the end of addresses", Box::new(set(OFFSET, u64::MAX - 63))),
        ("unaligned", Box::new(move |b| b[4 * 64 + 16] += 4)),
        ("huge", Box::new(set(STORED, u64::MAX))),
        ("huge array", Box::new(set(PLAIN, 1 << 40))),
        ("wrong element", Box::new(|b| b[4 * 64 + 48] = 8)),
        ("no element", Box::new(|b| b[4 * 64 + 48] = 0)),
        ("unknown codec", Box::new(|b| b[4 * 64 + 52] = 9)),
        ("LZ4 that is none", Box::new(|b| b[4 * 64 + 52] = 1)),
        ("a name twice", Box::new(|b| b.copy_within(3 * 64..3 * 64 + 16, 4 * 64))),
        ("no name", Box::new(|b| b[4 * 64..4 * 64 + 16].fill(0))),
        ("another name", Box::new(|b| b[4 * 64] ^= 1)),
        ("a name with a hole", Box::new(|b| b[4 * 64 + 1] = 0)),
        ("many sections", Box::new(|b| b[28..32].fill(0xff))),
        ("more sections", Box::new(|b| b[29] = 0xff)),
        ("fewer sections", Box::new(|b| b[28] -= 1)),
        ("longer", Box::new(|b| b[32] ^= 0x80)),
        ("another version", Box::new(|b| b[8] = 5)),
    ];
    ALLOCATOR.reset_peak_usage();
    let before = ALLOCATOR.current_usage();
    for (what, forge) in &forgeries {
        for file in [&good, &packed] {
            let bytes = file.bytes(forge);
            for options in [checked(), own()] {
                let opened = Baked::<VertexHierarchy>::from_shared(Arc::new(bytes.clone()), options);
                let is_same = opened.as_ref().is_ok_and(|opened| *opened == model);
                assert!(opened.is_err() || is_same && what.starts_with("LZ4"), "{what}");
                assert_eq!(opened.err().map_or(1, |error| error.to_string().lines().count()), 1);
            }
        }
    }
    // Other tests of this file run at the same time.
    assert!(ALLOCATOR.peak_usage() < before + (256 << 20));
}

/// A compressed section may hold at most 32 times its bytes.
#[test]
fn compressed_sections_reserve_no_more_than_a_multiple() {
    let model = VertexHierarchy::bake(&mesh(320)).unwrap();
    let compressed = BakeOptions::default().with_compression(Compression::Lz4);
    let packed = Forged::of(&model.to_bytes_with(compressed).unwrap());
    for (i, (entry, section)) in packed.sections.iter().enumerate() {
        if entry[52] == 0 {
            continue;
        }
        let element = u64::from(u32::from_le_bytes(entry[48..52].try_into().unwrap()));
        for times in [31, 33, 1 << 20] {
            let plain = (times * section.len() as u64 / element * element).to_le_bytes();
            let bytes = packed.bytes(|bytes| bytes[64 * (1 + i)..][PLAIN].copy_from_slice(&plain));
            let refused = Baked::<VertexHierarchy>::from_bytes(&bytes).unwrap_err().to_string();
            assert!(refused.contains("lengths do not fit") == (times > 31), "{times}: {refused}");
        }
    }
}

#[test]
fn missing_sections_are_named_and_unknown_ones_left_alone() {
    let model = VertexHierarchy::bake(&mesh(80)).unwrap();
    let bytes = model.to_bytes().unwrap();
    for (i, section) in io::baked_sections(&bytes).unwrap().iter().enumerate() {
        let mut less = Forged::of(&bytes);
        less.sections.remove(i);
        match Baked::<VertexHierarchy>::from_bytes(&less.bytes(|_| ())) {
            Err(BakeError::Missing { section: named }) => assert_eq!(named, section.name),
            // Without locks another model; without the first of the derived arrays all are derived anew.
            Ok(other) => assert!(other == model && section.name == "split_of" || section.name == "locks"),
            Err(error) => panic!("{}: {error}", section.name),
        }
    }
    let mut more = Forged::of(&bytes);
    let mut entry = [0; 64];
    entry[..3].copy_from_slice(b"new");
    (entry[48], entry[52]) = (5, 3);
    entry[PLAIN].copy_from_slice(&1_000_u64.to_le_bytes());
    more.sections.insert(2, (entry, vec![1, 2, 3]));
    assert_eq!(Baked::<VertexHierarchy>::from_bytes(&more.bytes(|_| ())).unwrap(), model);
}

/// Changes every array of a file, with checksums that fit: what opens is valid.
fn forge_content<S: Stored + PartialEq + std::fmt::Debug>(model: &Baked<S>, is_valid: impl Fn(&S) -> bool) {
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as u32
    };
    let mut opened = 0;
    for options in options() {
        let good = model.to_bytes_with(options).unwrap();
        let mut forged = Forged::of(&good);
        for section in 0..forged.sections.len() {
            let length = forged.sections[section].1.len();
            let whole = forged.sections[section].1.clone();
            for _ in 0..200.min(4 * length) {
                let at = random() as usize % length;
                let word = [0, 1, 2, u32::MAX, 1 << 31, random() % 64, random()][random() as usize % 7];
                let own = &mut forged.sections[section].1;
                let end = length.min(at / 4 * 4 + 4);
                own[at / 4 * 4..end].copy_from_slice(&word.to_le_bytes()[..end - at / 4 * 4]);
                if let Ok(back) = Baked::<S>::from_bytes(&forged.bytes(|_| ())) {
                    assert!(is_valid(back.structure()));
                    let _ = (back.level(Level::Ratio(0.5)), back.level(Level::Error(0.0)));
                    opened += 1;
                }
                forged.sections[section].1.clone_from(&whole);
            }
            // A section of another length.
            if length > 0 {
                forged.sections[section].1.truncate(length / 2);
                // Half of the triangles may be all of another model.
                if let Ok(half) = Baked::<S>::from_bytes(&forged.bytes(|_| ())) {
                    assert!(is_valid(half.structure()));
                }
                forged.sections[section].1.clone_from(&whole);
            }
        }
    }
    assert!(opened > 0);
}

#[test]
fn forged_arrays_are_refused_or_valid() {
    forge_content(&VertexHierarchy::bake(&mesh(80)).unwrap(), |hierarchy| hierarchy.validate().is_ok());
    forge_content(&TotallyOrderedMesh::bake(&mesh(80)).unwrap(), |tom| tom.validate().is_ok());
    forge_content(&Gmesh::bake(&mesh(320)).unwrap(), |gmesh| {
        Gmesh::try_from(multires::gmesh::GmeshParts::from(gmesh.clone())).as_ref() == Ok(gmesh)
    });
    forge_content(&WaveletMesh::bake(&mesh(80)).unwrap(), |wavelet| wavelet.validate().is_ok());
}

/// A hierarchy of a grid of 4 x 4 vertices, by the last version that wrote version 3.
const VERSION_3: &str = "\
    894d5245530d0a1a030000006869657261726368790000000000000030050000000000009d86f81535fa5b091000000000000000 \
    0000000000000000000000000000803f0000803f000000000000803f00000040cdcccc3d000000000000803fcdcccc3d00000000 \
    00000040cdcc4c3e0000803f000000009a99993e000000400000803f9a99993e0000404000000000cdcccc3d0000004000000000 \
    cdcc4c3e000040400000803fcdcc4c3e0000404000004040000000000000004000000040000000000000004000004040cdcccc3d \
    00004040000000409a99993e00000000000040409a99993e0000803f00004040cdcc4c3e00000000000000000000000000000000 \
    00000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000010000000 \
    00000000000000000000000001000000000000000300000000000000050000000700000007000000070000000a0000000a000000 \
    0a0000000a0000000a0000000e00000000000000000000000e000000000000000000000001000000020000000300000004000000 \
    05000000060000000700000008000000090000000a0000000b0000000c0000000d0000000d000000000000000e00000005000000 \
    0d000000030000000c0000000b0000000f0000000100000002000000040000000600000009000000080000000e00000000000000 \
    00000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000 \
    000000000000000000000000000000000d000000000000008038cb3febcb0840bcbf353ecec7ed3f12d2364027f54040fd037f53 \
    fe2d9c3fce89a73f9a99193e46b3104083f1b53efe631040fe027f5800000040000000409a99193ef308b63f83f1b53ef604b53f \
    f8087e490000803f0000c03f9a99193e73caf53f4750e1315c400f4004fc7f4b00000040000000409a99193eee08b63f851c1d24 \
    f504b53ffc047f4000000040000000409a99193ee908b63f851c1d24f404b53ff30d7e2f0000803f00002040cdcc4c3e01ae8f3f \
    35fca8316fa3803f0df37e010000803f0000c03f9a99193e6ccaf53fa663c4245b400f4000007f420000803f00000040cdcccc3d \
    ae78b53f851c1d246fa3803f0df37e010000003f00000040cdcc4c3e01ae8f3f35fca8316fa3803f0df37e01000000400000803f \
    9a99193ee908b63f423b5324f404b53ff30d7e2fffff0f40fdff3f3fcdcc4c3e41efbc3fd7d1a93170a3803f0df37e0300000040 \
    0000003fcdcc4c3e01ae8f3fd7d1a9316fa3803f0df37e01120000000000000006000000090000000d000000020000000c000000 \
    0f00000001000000060000000b000000060000000d0000000b00000004000000020000000f000000020000000b0000000c000000 \
    0b0000000d0000000a0000000b0000000a0000000c000000040000000f0000000e00000000000000050000000100000000000000 \
    0100000003000000030000000100000002000000010000000b000000020000000300000002000000040000000500000008000000 \
    060000000500000006000000010000000800000009000000060000000800000007000000090000000e0000000000000001000000 \
    020000000300000004000000050000000600000008000000090000000b0000000d0000000e000000100000001100000012000000 \
    00000000000000000000000000000000fd7e64ca4f03114010000000100000000000000000000000050000000900000004000000 \
    0800000001000000060000000300000002000000070000000f0000000a0000000e0000000b0000000c0000000d00000000000000 \
    0000000000000000000000000000000000000000";

#[test]
fn files_of_version_3_open() {
    let digit = |c: u8| (c as char).to_digit(16);
    let digits: Vec<u8> = VERSION_3.bytes().filter_map(digit).map(|d| d as u8).collect();
    let bytes: Vec<u8> = digits.chunks(2).map(|pair| pair[0] << 4 | pair[1]).collect();
    assert_eq!((bytes.len(), io::baked_version(&bytes).unwrap()), (1_372, 3));
    assert!(io::baked_sections(&bytes).unwrap().is_empty());
    let model = Baked::<VertexHierarchy>::from_bytes(&bytes).unwrap();
    let whole = model.level(Level::Error(0.0)).mesh;
    assert_eq!((whole.positions().len(), whole.triangles().len()), (16, 18));
    assert_eq!(whole.bounds(), Some([[0.0, 0.0, 0.0], [3.0, 3.0, 0.3]]));
    assert_eq!((model.structure().split_count(), model.structure().base_triangle_count()), (13, 1));
    assert_eq!(Baked::from_shared(Arc::new(bytes.clone()), own()).unwrap(), model);
    assert_eq!(Baked::<VertexHierarchy>::from_bytes(&model.to_bytes().unwrap()).unwrap(), model);
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1;
        assert!(Baked::<VertexHierarchy>::from_bytes(&damaged).is_err(), "byte {at}");
        assert!(Baked::<VertexHierarchy>::from_bytes(&bytes[..at]).is_err());
    }
}

#[cfg(feature = "cli")]
#[test]
fn the_command_line_compresses_and_lists_sections() {
    let run = |arguments: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_multires"));
        let output = command.args(arguments).arg("--json").output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let folder = std::env::temp_dir().join(format!("multires-sections-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let [rock, plain, small] =
        ["rock.ply", "plain.mres", "small.mres"].map(|name| folder.join(name).display().to_string());
    io::write(&rock, &shapes::rock(2_000, 1)).unwrap();
    run(&["build", &rock, &plain, "--structure", "hierarchy"]);
    run(&["build", &rock, &small, "--structure", "hierarchy", "--compress"]);
    let [plain_info, small_info] = [&plain, &small].map(|file| run(&["info", file]));
    let bytes = |info: &serde_json::Value| info["bytes"].as_u64().unwrap();
    assert!(2 * bytes(&small_info) < bytes(&plain_info));
    let section = |info: &serde_json::Value, name: &str| {
        let sections = info["sections"].as_array().unwrap();
        sections.iter().find(|section| section["name"] == name).cloned()
    };
    let (own, packed) = (section(&plain_info, "bounds").unwrap(), section(&small_info, "bounds").unwrap());
    assert_eq!((&own["compressed"], &packed["compressed"]), (&false.into(), &true.into()));
    assert_eq!(
        (&own["plain"], &own["stored"], &own["element"]),
        (&packed["plain"], &packed["plain"], &28.into())
    );
    assert!(section(&small_info, "split_of").is_none() && section(&plain_info, "split_of").is_some());
    assert_eq!(io::read_model::<u8>(&small).unwrap().to_bytes().unwrap(), std::fs::read(&plain).unwrap());
    std::fs::remove_dir_all(folder).unwrap();
}
