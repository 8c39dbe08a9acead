//! Promise: a glTF file's base colours and normal map are painted on every structure, from beside the file or from inside; a picture
//! that cannot be had is a warning.

mod card;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use card::{open, shared};
use glam::Vec3;
use multires::io::{self, GltfTextures};
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::view::View;
use multires_viewer::camera::{Lens, Orbit, Tolerances};
use multires_viewer::headless::{STEP, Stage, write_png};
use multires_viewer::renderer::{Look, Shading};
use multires_viewer::scene::{BuildOptions, Model, Overlays, Source, StructureKind};

const LENS: Lens = Lens { field_of_view: 0.8, size: [200, 200] };
const STRUCTURES: [StructureKind; 4] =
    [StructureKind::Hierarchy, StructureKind::Tom, StructureKind::Gmesh, StructureKind::Wavelet];

/// A folder of its own.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("multires-gltf-pictures-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A ball with a picture from left to right: u grows with x.
fn ball() -> Mesh {
    let ball = shapes::icosphere(4);
    let uv: Vec<[f32; 2]> = ball.positions().iter().map(|p| [0.5 + 0.49 * p[0], 0.5 - 0.49 * p[1]]).collect();
    ball.with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}

/// Red at the left, blue at the right.
fn picture(path: &Path) {
    let pixels: Vec<[u8; 4]> =
        (0..64 * 64).map(|i| if i % 64 < 32 { [220, 30, 30, 255] } else { [30, 30, 220, 255] }).collect();
    write_png(path, [64; 2], &pixels).unwrap();
}

fn load(path: &Path, structure: StructureKind) -> Model {
    let options = BuildOptions::default().with_structure(structure);
    Source::File(path.to_owned()).load(&options, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// Pixels of the surface that are more red than blue, and more blue than red, by much.
fn red_and_blue(pixels: &[[u8; 4]]) -> [usize; 2] {
    let surface = || pixels.iter().filter(|pixel| pixel[3] > 0);
    [[0, 2], [2, 0]]
        .map(|[much, little]| surface().filter(|p| p[much] > p[little].saturating_add(60)).count())
}

#[test]
fn all_structures_wear_the_base_colours_of_their_file() {
    let Some(gpu) = open("all_structures_wear_the_base_colours_of_their_file") else { return };
    let folder = folder("drawn");
    picture(&folder.join("base colour.png"));
    let path = folder.join("ball.glb");
    let textures = GltfTextures::default().with_base_colour("base colour.png");
    io::write_textured(&path, &ball(), &textures).unwrap();
    for structure in STRUCTURES {
        let model = Arc::new(load(&path, structure));
        assert!(model.warnings().is_empty() && model.texture().is_some());
        let mut orbit = Orbit::framing([0.0; 3], 1.0, LENS.field_of_view, false);
        orbit.around = 0.0;
        let pose = orbit.pose();
        let view: View = pose.view(&LENS, &Tolerances::default().with_anywhere(1.0)).unwrap();
        let place = glam::Mat4::IDENTITY.to_cols_array_2d();
        let mut stage = Stage::new(gpu.clone(), model, &[place], shared(), LENS.size, 1).unwrap();
        let [plain, painted] = [Shading::Material, Shading::Texture].map(|shading| {
            let look = Look { shading, ..pose.look(&LENS, 2.0) };
            stage.frame(std::slice::from_ref(&view), Some(&look), Overlays::default(), STEP);
            stage.picture().unwrap()
        });
        if let Some(folder) = std::env::var_os("MULTIRES_PICTURES") {
            let path = PathBuf::from(folder).join(format!("base-colours-{structure:?}.png"));
            write_png(&path, LENS.size, &painted).unwrap();
        }
        let surface = painted.iter().filter(|pixel| pixel[3] > 0).count();
        let [red, blue] = red_and_blue(&painted);
        assert!(
            10 * red > 3 * surface && 10 * blue > 3 * surface,
            "{structure:?}: {red}, {blue} of {surface}"
        );
        assert_eq!(red_and_blue(&plain), [0; 2], "{structure:?}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Normals that a pixel of [`Shading::Normal`] shows.
fn normal_of(pixel: [u8; 4]) -> Vec3 {
    Vec3::from_array([0, 1, 2].map(|k| f32::from(pixel[k]) / 127.5 - 1.0)).normalize()
}

#[test]
fn normals_lean_as_the_map_says() {
    let Some(gpu) = open("normals_lean_as_the_map_says") else { return };
    let folder = folder("normals");
    // Along growing u, which is x; and against growing v, which is up.
    for (name, axis, texel) in
        [("right", Vec3::X, [204, 128, 230, 255]), ("up", Vec3::Y, [128, 204, 230, 255])]
    {
        let path = folder.join(name).with_extension("glb");
        let textures = GltfTextures::default().with_normal(format!("{name}.png"));
        io::write_textured(&path, &ball(), &textures).unwrap();
        write_png(&folder.join(name).with_extension("png"), [8; 2], &[texel; 64]).unwrap();
        let mapped = Arc::new(load(&path, StructureKind::Tom));
        assert!(mapped.warnings().is_empty() && mapped.normal_map().is_some());
        let plain_path = folder.join("plain.glb");
        io::write(&plain_path, &ball()).unwrap();
        let plain = Arc::new(load(&plain_path, StructureKind::Tom));
        let mut orbit = Orbit::framing([0.0; 3], 1.0, LENS.field_of_view, false);
        orbit.around = 0.0;
        let pose = orbit.pose();
        let view: View = pose.view(&LENS, &Tolerances::default().with_anywhere(0.1)).unwrap();
        let place = glam::Mat4::IDENTITY.to_cols_array_2d();
        let [plain, mapped] = [plain, mapped].map(|model| {
            let mut stage = Stage::new(gpu.clone(), model, &[place], shared(), LENS.size, 1).unwrap();
            let look = Look { shading: Shading::Normal, ..pose.look(&LENS, 2.0) };
            stage.frame(std::slice::from_ref(&view), Some(&look), Overlays::default(), STEP);
            stage.picture().unwrap()
        });
        let [width, height] = LENS.size.map(|side| side as usize);
        for (x, y) in [(0, 0), (10, 0), (-10, 5), (0, -15)] {
            let at = ((height as i32 / 2 + y) * width as i32 + width as i32 / 2 + x) as usize;
            let (own, found) = (normal_of(plain[at]), normal_of(mapped[at]));
            let tangent = (axis - own * axis.dot(own)).normalize();
            let expected = 0.6 * tangent + 0.8 * own;
            assert!(found.dot(expected) > 0.99, "{name} at {x}, {y}: {own} leans to {found}, not {expected}");
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn pictures_inside_the_file_are_read_and_lost_ones_are_warnings() {
    let folder = folder("read");
    picture(&folder.join("a.png"));
    let (beside, inside) = (folder.join("ball.gltf"), folder.join("inside.glb"));
    let textures = GltfTextures::default().with_base_colour("a.png");
    io::write_textured(&beside, &ball(), &textures).unwrap();
    let size = |model: &Model| model.texture().map(|texture| texture.size);
    assert_eq!(size(&load(&beside, StructureKind::Tom)), Some([64; 2]));

    // The picture moves into the binary chunk.
    io::write_textured(&inside, &ball(), &textures).unwrap();
    let bytes = std::fs::read(&inside).unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let (json_end, png) = (20 + word(12), std::fs::read(folder.join("a.png")).unwrap());
    let mut document: serde_json::Value = serde_json::from_slice(&bytes[20..json_end]).unwrap();
    let mut binary = bytes[json_end + 8..].to_vec();
    let views = document["bufferViews"].as_array_mut().unwrap();
    views.push(serde_json::json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": png.len() }));
    let view = views.len() - 1;
    document["images"] = serde_json::json!([{ "bufferView": view, "mimeType": "image/png" }]);
    binary.extend(&png);
    binary.resize(binary.len().next_multiple_of(4), 0);
    document["buffers"][0]["byteLength"] = binary.len().into();
    let mut text = serde_json::to_vec(&document).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    let numbers = [2, 28 + text.len() + binary.len(), text.len(), 0x4E4F_534A];
    numbers.iter().for_each(|&number| file.extend((number as u32).to_le_bytes()));
    file.extend(&text);
    [binary.len(), 0x004E_4942].iter().for_each(|&number| file.extend((number as u32).to_le_bytes()));
    file.extend(&binary);
    std::fs::write(&inside, file).unwrap();
    let model = load(&inside, StructureKind::Tom);
    assert_eq!((size(&model), model.warnings().len()), (Some([64; 2]), 0));

    std::fs::write(folder.join("a.png"), b"no picture").unwrap();
    let broken = load(&beside, StructureKind::Tom);
    std::fs::remove_file(folder.join("a.png")).unwrap();
    for model in [broken, load(&beside, StructureKind::Tom)] {
        assert_eq!((size(&model), model.warnings().len()), (None, 1));
    }
    std::fs::remove_dir_all(folder).unwrap();
}
