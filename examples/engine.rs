//! One program text for every structure: what an engine does with a model, from its vertex and index arrays to drawn frames.
//!
//! ```text
//! cargo run --release --example engine
//! ```
//!
//! The card is a mock that applies uploads byte by byte, so that after every frame what it would draw can be compared with what
//! the library says is drawn. Vertices are 52 bytes (position, normal, texture coordinates, colour, joints, weights), of two
//! materials that meet in a seam.

#[path = "support/asset.rs"]
mod asset;
#[path = "support/gpu.rs"]
mod gpu;

use asset::{Asset, Vertex};
use gpu::{Drawn, Gpu};
use multires::prelude::*;
use multires::view::look_at;

const FRAMES: usize = 120;
const SECONDS: f32 = 1.0 / 60.0;
const PLACE: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn main() -> Result<(), multires::Error> {
    let asset = asset::patch(32);
    println!(
        "{} vertices of {} bytes, {} triangles, 2 materials\n",
        asset.vertices.len(),
        size_of::<Vertex>(),
        asset.indices.len() / 3
    );
    println!("structure   vertices         triangles drawn   bytes a frame   moving");
    run::<VertexHierarchy>(&asset)?;
    run::<TotallyOrderedMesh>(&asset)?;
    run::<WaveletMesh>(&asset)?;
    run::<Gmesh>(&asset)
}

/// All ways to draw a structure, each along the same flight.
fn run<S: Structure>(asset: &Asset) -> Result<(), multires::Error>
where
    multires::Error: From<S::Error>,
{
    // Once: a mesh from what the engine has, a structure of it, the engine's vertices in the structure's order.
    let mesh = Mesh::from_vertices(&asset.vertices, &asset.indices, |v| v.position)?
        .with_attribute(Attribute::of(names::UV, &asset.vertices, |v| v.uv))?
        .with_material_ranges(&asset.ranges)?;
    let model = S::bake(&mesh)?;
    let values = model.arrange(&asset.vertices)?.with_blending();

    let morph = Geomorph::default().with_duration(0.2);
    for buffer in [VertexBuffer::Packed, VertexBuffer::Whole, VertexBuffer::Shared] {
        for geomorph in [None, Some(morph)] {
            let options = LodOptions::default().with_buffer(buffer).with_geomorph(geomorph);
            // For each drawn object.
            let mut lod = model.instance(values.clone(), &options)?;
            fly(S::KIND, &mut lod, &values)?;
        }
    }
    Ok(())
}

/// What happens every frame, and what must be true after it.
fn fly(kind: &str, lod: &mut dyn Lod, values: &[Vertex]) -> Result<(), multires::Error> {
    let mut gpu = Gpu::default();
    let (mut triangles, mut first, mut moved) = (0, 0, 0);
    for frame in 0..FRAMES {
        let turn = frame as f32 / FRAMES as f32 * std::f32::consts::TAU;
        let far = 2.6 + 1.2 * turn.cos();
        let eye = [far * turn.sin(), 0.3 * far, far * turn.cos()];
        let world_to_eye = look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
        let view = View::perspective(world_to_eye, 1.0, [1280, 720])?.with_tolerance_px(3.0);

        let change = lod.adapt(&[view.of_object(PLACE)?], SECONDS);
        gpu.upload(lod);
        lod.clean();
        let drawn = gpu.draw(lod, values);

        check(lod, &drawn, change.moving > 0);
        triangles += drawn.len();
        moved += usize::from(change.moving > 0);
        if frame == 0 {
            first = gpu.written;
        }
    }
    // At rest, all is where it belongs.
    lod.settle();
    gpu.upload(lod);
    lod.clean();
    check(lod, &gpu.draw(lod, values), false);

    let options = lod.options();
    println!(
        "{kind:<11} {:<16} {:>15} {:>15} {:>8}",
        format!("{:?}{}", options.buffer, if options.geomorph.is_some() { ", morphed" } else { "" }),
        triangles / FRAMES,
        (gpu.written - first) / (FRAMES - 1),
        moved,
    );
    Ok(())
}

/// What is drawn is what [`Lod::to_mesh`] says, with seams intact.
fn check(lod: &dyn Lod, drawn: &[Drawn<Vertex>], moving: bool) {
    for (material, corners) in drawn {
        // Each material keeps to its own chart of the atlas, also while vertices move.
        assert!(corners.iter().all(|v| (v.uv[0] >= 0.55) == (*material == 1)), "a seam is torn");
    }
    let mesh = lod.to_mesh();
    let mut here: Vec<u32> = drawn.iter().map(|(material, _)| *material).collect();
    let mut there = mesh.materials().to_vec();
    here.sort_unstable();
    there.sort_unstable();
    assert_eq!(here, there, "triangles of each material");
    if moving {
        return;
    }
    let uv: &[[f32; 2]] =
        mesh.attribute(names::UV).and_then(Attribute::as_floats).map_or(&[], bytemuck::cast_slice);
    let of_mesh = mesh.triangles().iter().zip(mesh.materials()).map(|(triangle, &material)| {
        (material, triangle.map(|v| bits(mesh.positions()[v as usize], uv[v as usize])))
    });
    let of_card =
        drawn.iter().map(|(material, corners)| (*material, corners.map(|v| bits(v.position, v.uv))));
    assert_eq!(sorted(of_card), sorted(of_mesh), "what is drawn is not what is said to be");
}

type Corner = [u32; 5];

fn bits([x, y, z]: [f32; 3], [u, v]: [f32; 2]) -> Corner {
    [x, y, z, u, v].map(f32::to_bits)
}

/// In an order that does not depend on where triangles lie in buffers, nor on which corner comes first.
fn sorted(triangles: impl Iterator<Item = (u32, [Corner; 3])>) -> Vec<(u32, [Corner; 3])> {
    let turned = triangles.map(|(material, mut corners)| {
        let least = (0..3).min_by_key(|&i| corners[i]).unwrap_or_default();
        corners.rotate_left(least);
        (material, corners)
    });
    let mut all: Vec<_> = turned.collect();
    all.sort_unstable();
    all
}
