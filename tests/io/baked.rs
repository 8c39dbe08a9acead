//! Promise: a baked value comes back equal, and no damage gets through; a file is whole or not there.
#![cfg(feature = "io")]

use std::io::Write;
use std::path::PathBuf;

use multires::io::{self, BakeError, atomic};
use multires::mesh::{Attribute, AttributeValues, Mesh};
use proptest::prelude::*;

/// Start of the only section: after the header and an entry of the table.
const PAYLOAD: usize = 128;

fn mesh() -> Mesh {
    let positions: Vec<[f32; 3]> = (0..7).map(|i| [i as f32, -0.0, 1.0 / (i + 1) as f32]).collect();
    let mesh = Mesh::new(positions, [[0, 1, 2], [2, 1, 3], [4, 5, 5]]).unwrap();
    let ids = Attribute::new("id", 1, AttributeValues::Uint((0..7).collect()));
    let mesh = mesh.with_attribute(ids).unwrap().with_materials([0, 1, 0]).unwrap();
    mesh.with_material_names(["a", "b"].map(str::to_owned)).with_locks([true; 7]).unwrap()
}

#[test]
fn a_value_comes_back_equal_and_from_equal_bytes() {
    let bytes = io::bake("mesh", &mesh()).unwrap();
    assert_eq!(io::bake("mesh", &mesh()).unwrap(), bytes);
    assert_eq!(io::baked_kind(&bytes).unwrap(), "mesh");
    assert_eq!(io::unbake::<Mesh>("mesh", &bytes).unwrap(), mesh());
    assert_eq!(&bytes[..16], b"\x89MRES\r\n\x1a\x04\0\0\0mesh");
    let large = (0..3_000_000_u32).collect::<Vec<_>>();
    assert_eq!(io::unbake::<Vec<u32>>("n", &io::bake("n", &large).unwrap()).unwrap(), large);
}

/// The bytes with a checksum that fits them, by the one property an outsider can use: bake computes it.
fn forged(payload: &[u8]) -> Vec<u8> {
    struct Raw<'a>(&'a [u8]);
    impl serde::Serialize for Raw<'_> {
        fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            use serde::ser::SerializeTuple;
            let mut tuple = serializer.serialize_tuple(self.0.len())?;
            self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
            tuple.end()
        }
    }
    io::bake("mesh", &Raw(payload)).unwrap()
}

#[test]
fn each_kind_of_mismatch_is_told_apart() {
    let bytes = io::bake("mesh", &mesh()).unwrap();
    let unbake = |bytes: &[u8]| io::unbake::<Mesh>("mesh", bytes).unwrap_err();
    assert!(matches!(unbake(b""), BakeError::NotBaked));
    assert!(matches!(unbake(b"ply\nformat ascii 1.0\n"), BakeError::NotBaked));
    let text_mode: Vec<u8> = bytes.iter().copied().filter(|&b| b != b'\r').collect();
    assert!(matches!(unbake(&text_mode), BakeError::NotBaked));
    assert!(matches!(unbake(&bytes[..30]), BakeError::Damaged { .. }));
    assert!(matches!(unbake(&bytes[..bytes.len() - 1]), BakeError::Damaged { .. }));
    assert!(matches!(unbake(&[&bytes[..], &[0, 0]].concat()), BakeError::Trailing { bytes: 2 }));
    let mut newer = bytes.clone();
    newer[8] = 9;
    assert!(matches!(unbake(&newer), BakeError::OtherVersion { found: 9, expected: 4 }));
    match io::unbake::<Mesh>("tom", &bytes).unwrap_err() {
        BakeError::OtherKind { found, expected } => assert_eq!((&*found, &*expected), ("mesh", "tom")),
        error => panic!("{error}"),
    }
    assert!(matches!(io::bake("a name too long for it", &0).unwrap_err(), BakeError::BadKind { .. }));
    assert!(matches!(io::bake("", &0).unwrap_err(), BakeError::BadKind { .. }));

    // A right checksum does not make content right: here left-over bytes, then an index that names nothing.
    let payload = &bytes[PAYLOAD..];
    assert_eq!(io::unbake::<Mesh>("mesh", &forged(payload)).unwrap(), mesh());
    assert!(matches!(unbake(&forged(&[payload, &[0; 3]].concat())), BakeError::Trailing { bytes: 3 }));
    let mut beyond = payload.to_vec();
    let first_index = 8 + 7 * 12 + 8;
    beyond[first_index] = 200;
    assert!(unbake(&forged(&beyond)).to_string().contains("names vertex 200"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_changed_byte_is_found(at in any::<prop::sample::Index>(), flip in 1..=255_u8) {
        let mut bytes = io::bake("mesh", &mesh()).unwrap();
        let at = at.index(bytes.len());
        bytes[at] ^= flip;
        prop_assert!(io::unbake::<Mesh>("mesh", &bytes).is_err(), "byte {} ^ {}", at, flip);
    }

    #[test]
    fn a_truncation_is_found(at in any::<prop::sample::Index>()) {
        let bytes = io::bake("mesh", &mesh()).unwrap();
        prop_assert!(io::unbake::<Mesh>("mesh", &bytes[..at.index(bytes.len())]).is_err());
    }

    #[test]
    fn any_content_is_a_valid_mesh_or_refused(
        at in any::<prop::sample::Index>(),
        value in any::<[u8; 4]>(),
        noise in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        let mut payload = io::bake("mesh", &mesh()).unwrap().split_off(PAYLOAD);
        let at = at.index(payload.len() - 4);
        payload[at..at + 4].copy_from_slice(&value);
        for content in [&payload[..], &noise] {
            if let Ok(mesh) = io::unbake::<Mesh>("mesh", &forged(content)) {
                prop_assert!(mesh.indices().iter().all(|&v| (v as usize) < mesh.positions().len()));
            }
        }
        let _ = io::unbake::<Mesh>("mesh", &noise);
        let _ = io::baked_kind(&noise);
    }
}

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("multires-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn entries(folder: &PathBuf) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}

#[test]
fn baked_files_are_written_and_read() {
    let folder = folder("baked");
    let path = folder.join("mesh.mres");
    io::write_baked(&path, "mesh", &mesh()).unwrap();
    assert_eq!(io::read_baked::<Mesh>(&path, "mesh").unwrap(), mesh());
    let missing = io::read_baked::<Mesh>(folder.join("none.mres"), "mesh").unwrap_err();
    assert!(missing.to_string().contains("none.mres"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let folder = folder("atomic");
    let path = folder.join("out.bin");
    atomic::write(&path, b"old").unwrap();
    let failed = atomic::write_with(&path, |file| {
        file.write_all(b"half of it")?;
        Err(std::io::Error::other("full"))
    });
    assert_eq!(failed.unwrap_err().to_string(), "full");
    assert_eq!((std::fs::read(&path).unwrap(), entries(&folder)), (b"old".to_vec(), 1));
    atomic::write(&path, b"new").unwrap();
    assert_eq!((std::fs::read(&path).unwrap(), entries(&folder)), (b"new".to_vec(), 1));

    assert!(atomic::write(folder.join("no/such/folder.bin"), b"x").is_err());
    std::fs::create_dir(folder.join("taken")).unwrap();
    assert!(atomic::write(folder.join("taken"), b"x").is_err());
    assert_eq!(entries(&folder), 2);

    // A mesh that the format cannot hold is found before any file is opened.
    let clash = Attribute::new("x", 1, AttributeValues::Int(vec![3]));
    let mesh = Mesh::new([[0.0; 3]], []).unwrap().with_attribute(clash).unwrap();
    assert!(io::write(folder.join("mesh.ply"), &mesh).is_err());
    assert_eq!(entries(&folder), 2);
    std::fs::remove_dir_all(folder).unwrap();
}

#[cfg(unix)]
#[test]
fn links_and_devices_stay_what_they_are() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    let folder = folder("links");
    let (target, link) = (folder.join("target.bin"), folder.join("link.bin"));
    std::fs::write(&target, b"old").unwrap();
    std::fs::set_permissions(&target, std::fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&target, &link).unwrap();
    atomic::write(&link, b"new").unwrap();
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(std::fs::read(&target).unwrap(), b"new");
    assert_eq!(std::fs::metadata(&target).unwrap().permissions().mode() & 0o777, 0o640);
    atomic::write("/dev/null", b"gone").unwrap();
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    std::fs::remove_dir_all(folder).unwrap();
}
