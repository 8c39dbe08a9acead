//! Promise: what a client draws after the last packet of a view is what a local instance draws.
#![cfg(feature = "stream")]

use multires::hierarchy::{Dependencies, HierarchyBuilder, VertexHierarchy};
use multires::mesh::{Mesh, shapes};
use multires::prelude::*;
use multires::stream::{Client, ClientOptions, Server, Session, StreamOptions, StreamVertex};
use multires::view::{ObjectView, look_at};
use multires::{Baked, LodOptions};

/// Triangles with the bits of everything at their corners, in an order that depends on nothing else.
fn content(mesh: &Mesh) -> Vec<(u32, Vec<Vec<u32>>)> {
    let corner = |v: u32| {
        let mut words: Vec<u32> = mesh.positions()[v as usize].iter().map(|x| x.to_bits()).collect();
        for attribute in mesh.attributes().iter().filter(|attribute| attribute.name() != "vertex") {
            let values = attribute.as_floats().unwrap();
            let width = attribute.width();
            words.extend(values[v as usize * width..][..width].iter().map(|x| x.to_bits()));
        }
        words
    };
    let mut all: Vec<_> = mesh
        .triangles()
        .iter()
        .enumerate()
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

fn view(eye: [f32; 3], pixels: f32) -> ObjectView {
    let camera = look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
    View::perspective(camera, 1.0, [1920, 1080]).unwrap().with_tolerance_px(pixels).of_world()
}

fn position(vertex: StreamVertex<'_>) -> [f32; 3] {
    vertex.position()
}

type Positions = Client<[f32; 3], fn(StreamVertex<'_>) -> [f32; 3]>;

fn client(options: ClientOptions) -> Positions {
    Client::new(options, position)
}

/// Sends until there is nothing left to send. Returns the bytes.
fn exchange(session: &mut Session, client: &mut Positions, budget: usize) -> usize {
    let mut bytes = 0;
    loop {
        session.receive(&client.request()).unwrap();
        let Some(packet) = session.packet(budget) else { break };
        bytes += packet.len();
        client.receive(&packet).unwrap();
        assert_eq!(client.triangles(0).len().min(1), usize::from(client.triangles(0).len() > 0));
    }
    assert!(session.is_done());
    bytes
}

fn check(model: &Baked<VertexHierarchy>, options: &StreamOptions, budget: usize) {
    let server = Server::new(model, options).unwrap();
    let mut session = server.session();
    let mut client = client(ClientOptions::default());
    let local = server.model();
    let mut lod =
        local.instance(local.values(|v| local.vertices().positions()[v]), &LodOptions::default()).unwrap();
    for (at, eye) in [[0.0, 0.3, 6.0], [0.0, 0.2, 2.0], [2.0, 0.1, 0.3], [0.0, -1.5, -0.6], [0.0, 0.3, 30.0]]
        .into_iter()
        .enumerate()
    {
        let views = [view(eye, 2.0)];
        client.adapt(&views, 0.0);
        lod.adapt(&views, 0.0);
        exchange(&mut session, &mut client, budget);
        let (sent, drawn) = (client.to_mesh(), lod.to_mesh());
        assert_eq!(sent.triangles().len(), drawn.triangles().len(), "view {at}");
        assert!(content(&sent) == content(&drawn), "view {at}");
        assert_eq!(session.triangles(), sent.triangles().len());
        // Buffers hold what is drawn.
        let slots = client.vertices().unwrap();
        assert_eq!(client.values().len(), slots.len());
    }
}

#[test]
fn a_client_draws_what_a_local_instance_draws() {
    let meshes = [
        shapes::rock(3_000, 1),
        shapes::torus(1.0, 0.4, 60, 30),
        shapes::prop(4),
        shapes::robot(4),
        shapes::demo(),
    ];
    for (number, mesh) in meshes.iter().enumerate() {
        for kind in [Dependencies::None, Dependencies::Adjacent] {
            let model = HierarchyBuilder::new().dependencies(kind).bake(mesh).unwrap();
            for options in [StreamOptions::default(), StreamOptions::exact()] {
                for budget in [200, 5_000] {
                    println!("mesh {number}, {kind:?}, {options:?}, {budget}");
                    check(&model, &options, budget);
                }
            }
        }
    }
}
