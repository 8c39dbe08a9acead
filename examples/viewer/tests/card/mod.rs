//! What tests that draw share: the card, or word that there is none; buffers read back; the same slices drawn by the processor.

#![allow(dead_code)]

use std::ops::ControlFlow;
use std::sync::Arc;

use multires::adapt::{Blend, Geomorph};
use multires::lod::{Lod, LodOptions, VertexBuffer};
use multires::mesh::{Attribute, Mesh, names};
use multires::quality::{Camera, Colours, RenderOptions, render};
use multires_viewer::camera::Pose;
use multires_viewer::gpu::{self, Gpu};
use multires_viewer::renderer::{Vertex, card_morph};
use multires_viewer::scene::{BuildOptions, Model};

/// The card; without one says on stderr which test skips.
pub fn open(test: &str) -> Option<Gpu> {
    match Gpu::open(&gpu::instance(), None) {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            eprintln!("skipped {test}: {error}");
            None
        }
    }
}

/// With all vertices on the card, once for all instances.
pub fn shared() -> LodOptions {
    LodOptions::default().with_buffer(VertexBuffer::Shared)
}

/// With vertices that move in so many seconds.
pub fn moving(options: LodOptions, seconds: f32) -> LodOptions {
    options.with_geomorph(Geomorph::default().with_duration(seconds))
}

/// A model of a mesh.
pub fn model(mesh: &Mesh, options: &BuildOptions) -> Arc<Model> {
    Arc::new(Model::build(mesh, options, &mut |_| ControlFlow::Continue(())).unwrap())
}

/// The first bytes of a buffer on the card.
pub fn read_back(gpu: &Gpu, buffer: &wgpu::Buffer, bytes: usize) -> Vec<u8> {
    let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes as u64,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, bytes as u64);
    gpu.queue.submit([encoder.finish()]);
    copy.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    copy.slice(..).get_mapped_range().unwrap().to_vec()
}

/// What an instance draws, from its slices, as a mesh; vertices that move on the card are moved here.
pub fn mesh_of(lod: &dyn Lod, model: &Model) -> Mesh {
    let mut vertices: Vec<Vertex> = bytemuck::cast_slice(lod.vertex_bytes()).to_vec();
    if let Some(morph) = card_morph(lod) {
        let first = morph.first_moving as usize;
        for (own, &target) in vertices[first..].iter_mut().zip(&model.baked().morph_targets()[first..]) {
            *own = own.blend(&model.vertices()[target as usize], morph.share);
        }
    }
    let triangles: Vec<[u32; 3]> = (0..lod.groups()).flat_map(|g| lod.triangles(g).to_vec()).collect();
    let materials: Vec<u32> =
        (0..lod.groups()).flat_map(|g| vec![model.materials()[g]; lod.triangles(g).len()]).collect();
    let positions: Vec<_> = vertices.iter().map(|v| v.position).collect();
    let normals: Vec<_> = vertices.iter().map(|v| v.normal).collect();
    Mesh::new(positions, triangles)
        .unwrap()
        .with_materials(materials)
        .unwrap()
        .with_attribute(Attribute::floats(names::NORMAL, &normals))
        .unwrap()
}

/// A square picture of a mesh by rays, one or 2 x 2 a pixel.
pub fn ray_cast(mesh: &Mesh, pose: &Pose, field_of_view: f64, options: RenderOptions) -> Vec<[u8; 3]> {
    let camera = Camera::new(pose.eye, pose.target).with_up(pose.up).with_field_of_view(field_of_view);
    render(mesh, &camera, &options.with_occlusion_rays(0)).unwrap().pixels().to_vec()
}

/// Which pixels of such a picture show the mesh, by the ray through the middle of each.
pub fn shown(mesh: &Mesh, pose: &Pose, field_of_view: f64, options: RenderOptions) -> Vec<bool> {
    // A background that no light makes of a white surface.
    let key = [255, 0, 255];
    let options =
        options.with_supersampling(false).with_background(key, key).with_colours(Colours::Uniform([255; 3]));
    ray_cast(mesh, pose, field_of_view, options).into_iter().map(|pixel| pixel != key).collect()
}
