//! A model on its way to a client: what tests of streams share.

use multires::mesh::Mesh;
use multires::prelude::*;
use multires::stream::{Client, ClientOptions, Session, StreamVertex};
use multires::view::{ObjectView, look_at};

/// A client that draws positions.
pub type Positions = Client<[f32; 3], fn(StreamVertex<'_>) -> [f32; 3]>;

pub fn client(options: ClientOptions) -> Positions {
    Client::new(options, |vertex| vertex.position())
}

/// A view of the origin.
pub fn view(eye: [f32; 3], pixels: f32) -> ObjectView {
    let camera = look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
    View::perspective(camera, 1.0, [1920, 1080]).unwrap().with_tolerance_px(pixels).of_world()
}

/// Triangles with the bits of everything at their corners, in an order that depends on nothing else.
pub fn content(mesh: &Mesh) -> Vec<(u32, Vec<Vec<u32>>)> {
    let corner = |v: u32| {
        let mut words: Vec<u32> = mesh.positions()[v as usize].iter().map(|x| x.to_bits()).collect();
        for attribute in mesh.attributes().iter().filter(|attribute| attribute.name() != "vertex") {
            let values = attribute.as_floats().unwrap();
            let width = attribute.width();
            words.extend(values[v as usize * width..][..width].iter().map(|x| x.to_bits()));
        }
        words
    };
    let triangles = mesh.triangles().iter().enumerate();
    let mut all: Vec<_> = triangles
        .map(|(at, triangle)| {
            let corners = triangle.map(corner);
            let turned =
                (0..3).map(|turn| (0..3).map(|k| corners[(k + turn) % 3].clone()).collect::<Vec<_>>());
            (mesh.materials().get(at).copied().unwrap_or(0), turned.min().unwrap())
        })
        .collect();
    all.sort();
    all
}

/// Sends until there is nothing left to send. Calls `each` after every packet. Returns the bytes.
pub fn exchange(
    session: &mut Session,
    client: &mut Positions,
    budget: usize,
    mut each: impl FnMut(&mut Positions, &[u8]),
) -> usize {
    let mut bytes = 0;
    loop {
        session.receive(&client.request()).unwrap();
        let Some(packet) = session.packet(budget) else { break };
        bytes += packet.len();
        client.receive(&packet).unwrap();
        each(client, &packet);
    }
    assert!(session.is_done());
    bytes
}

/// Checks that packed buffers of positions are a mesh: corners name slots, and no triangle has two equal corners.
pub fn check_buffers(lod: &dyn Lod) {
    let slots = lod.vertices().unwrap().len();
    assert_eq!(lod.vertex_bytes().len(), slots * 12);
    for group in 0..lod.groups() {
        for triangle in lod.triangles(group) {
            assert!(triangle.iter().all(|&slot| (slot as usize) < slots), "{triangle:?} of {slots}");
            assert!(triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0]);
        }
    }
}

/// Writes uploads into copies of the buffers, and checks that the copies are what is drawn.
pub fn upload(lod: &mut dyn Lod, buffers: &mut Vec<Vec<u8>>) {
    for upload in lod.uploads() {
        buffers.resize(buffers.len().max(upload.buffer + 1), Vec::new());
        let buffer = &mut buffers[upload.buffer];
        buffer.resize(buffer.len().max(upload.offset as usize + upload.bytes.len()), 0);
        buffer[upload.offset as usize..][..upload.bytes.len()].copy_from_slice(upload.bytes);
    }
    lod.clean();
    let vertices = lod.vertex_bytes();
    assert!(buffers.first().is_none_or(|buffer| &buffer[..vertices.len()] == vertices));
    for group in 0..lod.groups() {
        let indices = lod.triangles(group).as_flattened().iter();
        let indices: Vec<u8> = indices.flat_map(|index| index.to_ne_bytes()).collect();
        assert!(buffers.get(1 + group).is_none_or(|buffer| buffer[..indices.len()] == indices));
    }
}
