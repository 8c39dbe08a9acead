//! Promise: a mesh whose base faces share no vertices is valid and comes back equal from parts and from bytes, whichever face is
//! split and wherever it stands in the order of faces.

use crate::wavelet::{bases, rough};
use multires::mesh::{Attribute, Mesh, shapes};
use multires::wavelet::{
    Atlas, AtlasOptions, Normals, WaveletBuilder, WaveletMesh, WaveletOptions, WaveletParts,
};

/// Splits one base face, and one of its children where `deep`.
fn with_one_split(base: &Mesh, split: u32, deep: bool) -> WaveletMesh {
    let mut builder = WaveletBuilder::new(base).unwrap();
    builder.subdivide_where(|face| face.base_face == split, rough(1, 0.25)).unwrap();
    if deep {
        let mut first = true;
        builder.subdivide_where(|_| std::mem::take(&mut first), rough(2, 0.25)).unwrap();
    }
    builder.build(&WaveletOptions::default()).unwrap()
}

fn comes_back(mesh: &WaveletMesh, name: &str) {
    assert_eq!(mesh.validate(), Ok(()), "{name}");
    assert!(WaveletMesh::try_from(WaveletParts::from(mesh.clone())).unwrap() == *mesh, "{name}");
    #[cfg(feature = "io")]
    {
        use multires::lod::Structure;
        let bytes = multires::io::bake(WaveletMesh::KIND, mesh).unwrap();
        assert!(multires::io::unbake::<WaveletMesh>(WaveletMesh::KIND, &bytes).unwrap() == *mesh, "{name}");
    }
}

#[test]
fn any_one_face_may_be_split() {
    let two = Mesh::new(
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        [[0, 1, 2], [0, 2, 3]],
    );
    let shapes = bases().into_iter().chain([("two triangles", two.unwrap()), ("grid", shapes::plane(2))]);
    for (name, base) in shapes {
        for split in 0..base.triangles().len() as u32 {
            for deep in [false, true] {
                let mesh = with_one_split(&base, split, deep);
                comes_back(&mesh, &format!("{name}, face {split}"));
                let options = AtlasOptions::default().with_resolution(256).with_gutter(1);
                let worn = mesh.with_atlas(&Atlas::new(&mesh, &options).unwrap()).unwrap();
                comes_back(&worn, &format!("{name}, face {split}, with an atlas"));
            }
        }
    }
}

/// The values differ at both ends of the shared edge and are one in its middle: there the faces share a vertex across the seam.
#[test]
fn seams_may_close_in_the_middle_of_an_edge() {
    // The split face, the other one, and the midpoints.
    let places = [[0, 0], [2, 0], [2, 2], [0, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 1]];
    let positions: Vec<[f32; 3]> = places.iter().map(|p| [p[0] as f32, p[1] as f32, 0.0]).collect();
    let uv: Vec<[f32; 2]> = (0..9).map(|v| [f32::from(u8::from((3..6).contains(&v))), 0.0]).collect();
    let split = [[0, 6, 8], [6, 1, 7], [8, 7, 2], [6, 7, 8]];
    let other = [[3, 8, 5], [8, 4, 5]];
    for triangles in [[&split[..], &other].concat(), [&other[..], &split].concat()] {
        let mesh = Mesh::new(positions.clone(), triangles).unwrap();
        let mesh = mesh.with_attribute(Attribute::floats("uv", &uv)).unwrap();
        let found = WaveletMesh::recognise(&mesh, &WaveletOptions::default()).unwrap();
        assert_eq!(found.finest(Normals::Kept).triangles().len(), 6);
        assert_eq!(found.subdivision().base_face_count(), 2);
        comes_back(&found, "closed in the middle");
    }
}
