//! The README's picture and figures, without a window: `cargo run --release -p bevy_multires --example picture`
//!
//! With `conversion`, `models` or `terrain` behind it, only that.
//!
//! Draws 500 models with levels and without, writes both pictures to `target/bevy_multires/`, and prints triangles, frame times, the
//! difference, what a flight over a terrain uploads, and how long a conversion takes.

#[path = "models/headless.rs"]
mod headless;
#[path = "models/scene.rs"]
mod scene;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use bevy::prelude::*;
use bevy_multires::convert::{from_bevy, to_bevy};
use bevy_multires::{AutoLod, LodSettings, LodStats};
use headless::{Headless, difference};
use multires::mesh::shapes;
use scene::Field;

const SIZE: UVec2 = UVec2::new(1280, 720);
const FRAMES: usize = 5;

fn main() -> ExitCode {
    let folder = Path::new("target/bevy_multires");
    let what = std::env::args().nth(1);
    match run(folder, what.as_deref()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(folder: &Path, what: Option<&str>) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let wanted = |name| what.is_none_or(|what| what == name);
    if wanted("conversion") {
        convert();
    }
    if wanted("models") {
        models(folder)?;
    }
    if wanted("terrain") {
        terrain(folder)?;
    }
    Ok(())
}

/// Converts a mesh of 100,000 triangles there and back.
fn convert() {
    let mesh = Torus::new(0.5, 1.0).mesh().major_resolution(500).minor_resolution(100).build();
    let mut times = Vec::new();
    let mut equal = true;
    for _ in 0..15 {
        let begin = Instant::now();
        let back = from_bevy(&mesh).and_then(|(there, layout)| layout.to_bevy(&there));
        times.push(begin.elapsed());
        equal &= back.is_ok_and(|back| back == mesh);
    }
    let triangles = mesh.indices().map_or(0, |indices| indices.len() / 3);
    println!("conversion of {triangles} triangles there and back: {:.1?}, equal: {equal}", median(times));
}

fn median<T: Ord + Copy>(mut times: Vec<T>) -> T {
    times.sort_unstable();
    times[times.len() / 2]
}

/// Draws the field with levels and without.
fn models(folder: &Path) -> Result<(), Box<dyn Error>> {
    let field = Field { models: 500, triangles: 20_000 };
    let mut headless = Headless::new(SIZE, scene::eye(&field), scene::SKY, |app| {
        app.insert_resource(field).add_systems(Startup, scene::spawn);
        app.insert_resource(LodSettings::default().with_all(AutoLod::default()));
    })
    .ok_or("there is no adapter to draw with")?;
    let begin = Instant::now();
    headless.settle();
    println!(
        "adapter: {}; levels and pipelines after {:.1?}",
        headless::adapter().unwrap_or_default(),
        begin.elapsed()
    );
    let mut pictures = Vec::new();
    for (name, enabled) in [("with", true), ("without", false)] {
        headless.app.world_mut().resource_mut::<LodSettings>().enabled = enabled;
        let picture = headless.picture();
        let time = median((0..FRAMES).map(|_| headless.frame()).collect());
        let stats = headless.app.world().resource::<LodStats>();
        println!(
            "{name} levels: {} of {} triangles, {time:.0?} a frame",
            stats.triangles, stats.full_triangles
        );
        write(&folder.join(format!("{name}.png")), SIZE, &picture)?;
        pictures.push(picture);
    }
    println!("mean difference: {:.2} of 255", difference(&pictures[0], &pictures[1]));
    Ok(())
}

/// Flies over a terrain that follows the view.
fn terrain(folder: &Path) -> Result<(), Box<dyn Error>> {
    let place = |step: usize| {
        let z = 0.55 - 0.01 * step as f32;
        Transform::from_xyz(0.0, 0.22, z).looking_at(Vec3::new(0.0, 0.05, z - 0.5), Vec3::Y)
    };
    let mut headless =
        Headless::new(SIZE, place(0), scene::SKY, |_| {}).ok_or("there is no adapter to draw with")?;
    let world = headless.app.world_mut();
    let mesh = to_bevy(&shapes::terrain(512, 5))?.with_computed_area_weighted_normals();
    let bytes = mesh.get_vertex_buffer_size() + mesh.get_index_buffer_bytes().map_or(0, <[u8]>::len);
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let paint = world.resource_mut::<Assets<StandardMaterial>>().add(Color::srgb(0.5, 0.55, 0.4));
    world.spawn((Mesh3d(mesh), MeshMaterial3d(paint), AutoLod::view_dependent()));
    let sun = Transform::from_xyz(2.0, 2.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y);
    world.spawn((DirectionalLight { illuminance: 7_000.0, ..default() }, sun));
    headless.settle();
    write(&folder.join("terrain.png"), SIZE, &headless.picture())?;
    let (mut uploads, mut triangles) = (Vec::new(), Vec::new());
    for step in 1..=40 {
        let mut cameras = headless.app.world_mut().query_filtered::<&mut Transform, With<Camera3d>>();
        for mut camera in cameras.iter_mut(headless.app.world_mut()) {
            *camera = place(step);
        }
        headless.frame();
        let stats = headless.app.world().resource::<LodStats>();
        uploads.push(stats.changed_bytes);
        triangles.push(stats.triangles);
    }
    let full = headless.app.world().resource::<LodStats>().full_triangles;
    let most = uploads.iter().max().copied().unwrap_or_default();
    println!(
        "terrain of {full} triangles ({bytes} bytes): {} drawn, {} bytes uploaded a frame, at most {most}",
        median(triangles),
        median(uploads)
    );
    Ok(())
}

/// Writes a picture as a PNG file.
fn write(path: &Path, size: UVec2, pixels: &[u8]) -> Result<(), Box<dyn Error>> {
    let mut encoder =
        png::Encoder::new(std::io::BufWriter::new(std::fs::File::create(path)?), size.x, size.y);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    println!("{}", path.display());
    Ok(())
}
