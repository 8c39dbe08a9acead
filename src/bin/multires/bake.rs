//! `remesh --bake`: pictures for the atlas of a remesh, and the glTF file that refers to them.

use std::fs::File;
use std::io::BufReader;
use std::path::{Component, Path, PathBuf};

use clap::Args;
use clap::builder::RangedU64ValueParser;
use multires::io::{self, GltfTextures};
use multires::mesh::{Mesh, names};
use multires::remesh::{BakedTexture, NormalSpace, Parameterisation, Texture};
use multires::wavelet::{Atlas, AtlasOptions, WaveletMesh};
use serde_json::{Value, json};

use crate::files;
use crate::output::Failure;

/// Pictures to bake.
#[derive(Args)]
pub struct Baking {
    /// Bake pictures of IN for OUT (.glb or .gltf, of --levels) into this folder: normal.png, and base_color.png from --texture
    /// or else from vertex colours. OUT gets texture coordinates and tangents of its own, and refers to the pictures.
    #[arg(long = "bake", value_name = "DIR")]
    folder: Option<PathBuf>,
    /// The texture of IN, a PNG file, for all its materials.
    #[arg(long, value_name = "PNG", requires = "folder")]
    texture: Option<PathBuf>,
    /// Texels along each side of the baked pictures, 64 to 16384.
    #[arg(long, value_name = "N", default_value_t = 2048, requires = "folder",
        value_parser = RangedU64ValueParser::<u32>::new().range(64..=16_384))]
    texels: u32,
}

/// What was baked.
pub struct Pictures {
    /// The mesh for OUT.
    pub mesh: Mesh,
    /// Paths of the pictures, relative to OUT.
    pub textures: GltfTextures,
    pub json: Value,
    pub text: String,
}

impl Baking {
    /// Refuses, before the work, outputs that refer to no pictures.
    pub fn check(&self, output: &Path, is_uniform: bool) -> Result<(), Failure> {
        if self.folder.is_none() {
            return Ok(());
        }
        let refers =
            |extension: &std::ffi::OsStr| ["glb", "gltf"].iter().any(|e| extension.eq_ignore_ascii_case(e));
        if !output.extension().is_some_and(refers) {
            let output = output.display();
            return Err(Failure::Usage(format!(
                "{output}: --bake needs a .glb or .gltf, which refers to pictures"
            )));
        }
        match is_uniform {
            true => Ok(()),
            false => Err(Failure::Usage("--bake needs --levels: tangents are those of a level".to_owned())),
        }
    }

    /// Bakes and writes the pictures; `None` without `--bake`.
    pub fn run(
        &self,
        mesh: &Mesh,
        map: &Parameterisation,
        remesh: &WaveletMesh,
        output: &Path,
    ) -> Result<Option<Pictures>, Failure> {
        let Some(folder) = &self.folder else { return Ok(None) };
        let options = AtlasOptions::default().with_resolution(self.texels);
        let atlas = Atlas::new(remesh, &options).map_err(Failure::input)?;
        let colours = match &self.texture {
            Some(path) => {
                let (width, height, texels) = read(path)?;
                let texture = Texture::new(width, height, &texels).map_err(Failure::input)?;
                let materials = mesh.materials().iter().max().map_or(1, |&most| most as usize + 1);
                Some(map.bake_texture(mesh, &atlas, &vec![texture; materials]).map_err(Failure::input)?)
            }
            None if mesh.attribute(names::COLOR).is_some() => {
                Some(map.bake_colours(mesh, &atlas).map_err(Failure::input)?)
            }
            None => None,
        };
        let level = remesh.subdivision().depth();
        let normals =
            map.bake_normals(mesh, &atlas, NormalSpace::Tangent { level }).map_err(Failure::input)?;
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::Input(format!("{}: {error}", folder.display())))?;
        let mut textures = GltfTextures::default();
        let mut paths = Vec::new();
        if let Some(colours) = &colours {
            let path = folder.join("base_color.png");
            write(&path, colours)?;
            textures = textures.with_base_colour(relative(output, &path)?);
            paths.push(path);
        }
        let path = folder.join("normal.png");
        write(&path, &normals.texture)?;
        textures = textures.with_normal(relative(output, &path)?);
        paths.push(path);
        let filled = normals.texture.filled;
        let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        let text = format!("{} ({} texels, {:.0} % filled)", paths.join(", "), self.texels, 100.0 * filled);
        let json = json!({ "pictures": paths, "texels": self.texels, "filled": filled });
        Ok(Some(Pictures { mesh: normals.mesh, textures, json, text }))
    }
}

impl Pictures {
    /// Writes the mesh that refers to the pictures.
    pub fn write(&self, output: &Path) -> Result<(), Failure> {
        io::write_textured(output, &self.mesh, &self.textures)
            .map_err(|error| Failure::Input(format!("{}: {error}", output.display())))
    }
}

/// Reads a PNG file as RGBA.
fn read(path: &Path) -> Result<(u32, u32, Vec<[u8; 4]>), Failure> {
    let failure = |error: &dyn std::fmt::Display| Failure::Input(format!("{}: {error}", path.display()));
    let file = File::open(path).map_err(|error| failure(&error))?;
    let mut decoder = png::Decoder::new(BufReader::new(file));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(|error| failure(&error))?;
    let size = reader.output_buffer_size().ok_or_else(|| failure(&"too large a picture"))?;
    let mut bytes = vec![0; size];
    let info = reader.next_frame(&mut bytes).map_err(|error| failure(&error))?;
    let texels = match info.color_type {
        png::ColorType::Rgba => bytes.chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]]).collect(),
        png::ColorType::GrayscaleAlpha => bytes.chunks_exact(2).map(|t| [t[0], t[0], t[0], t[1]]).collect(),
        other => return Err(failure(&format!("cannot read pictures of type {other:?}"))),
    };
    Ok((info.width, info.height, texels))
}

/// Writes a PNG file.
fn write(path: &Path, picture: &BakedTexture) -> Result<(), Failure> {
    let encode = || -> Result<Vec<u8>, png::EncodingError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, picture.width, picture.height);
        encoder.set_color(png::ColorType::Rgba);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(picture.texels.as_flattened())?;
        writer.finish()?;
        Ok(file)
    };
    let bytes = encode().map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
    files::write_bytes(path, &bytes)
}

/// Returns the path of `picture` from the folder of `output`, with `/` between folders.
fn relative(output: &Path, picture: &Path) -> Result<String, Failure> {
    let folder = output.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let whole = |path: &Path| {
        path.canonicalize().map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
    };
    let (from, to) = (whole(folder)?, whole(picture)?);
    let (from, to): (Vec<Component>, Vec<Component>) =
        (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[common..].iter().map(|_| "..".to_owned());
    let down = to[common..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    Ok(up.chain(down).collect::<Vec<String>>().join("/"))
}
