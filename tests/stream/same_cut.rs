//! Promise: after the last packet of a view a client draws what a local instance draws, bit for bit, and uploads what changed.

use multires::hierarchy::{Dependencies, HierarchyBuilder, VertexHierarchy};
use multires::mesh::{Mesh, shapes};
use multires::prelude::*;
use multires::stream::{ClientOptions, Server, StreamOptions};
use multires::{Baked, LodOptions};

use crate::sent::{check_buffers, client, content, exchange, upload, view};

fn check(model: &Baked<VertexHierarchy>, options: &StreamOptions, budget: usize) {
    let server = Server::new(model, options).unwrap();
    let mut session = server.session();
    let mut client = client(ClientOptions::default());
    let local = server.model();
    let values = local.values(|v| local.vertices().positions()[v]);
    let mut lod = local.instance(values, &LodOptions::default()).unwrap();
    let eyes = [
        [0.0, 0.3, 6.0],
        [0.0, 0.2, 2.0],
        [2.0, 0.1, 0.3],
        [0.0, -1.5, -0.6],
        [0.0, 0.3, 30.0],
        [0.1, 0.3, 2.5],
    ];
    let mut buffers = Vec::new();
    for (at, eye) in eyes.into_iter().enumerate() {
        let views = [view(eye, 2.0)];
        client.adapt(&views, 0.0);
        lod.adapt(&views, 0.0);
        exchange(&mut session, &mut client, budget, |client, _| {
            check_buffers(client);
            upload(client, &mut buffers);
        });
        let (sent, drawn) = (client.to_mesh(), lod.to_mesh());
        assert_eq!(sent.triangles().len(), drawn.triangles().len(), "view {at}");
        assert!(content(&sent) == content(&drawn), "view {at}");
        assert_eq!(session.triangles(), sent.triangles().len());
        assert_eq!(session.splits(), client.refinements());
        assert_eq!(lod.refinements(), client.refinements());
    }
}

fn check_all(mesh: &Mesh) {
    for kind in [Dependencies::None, Dependencies::Adjacent] {
        let model = HierarchyBuilder::new().dependencies(kind).bake(mesh).unwrap();
        for options in [StreamOptions::default(), StreamOptions::exact()] {
            for budget in [300, 5_000] {
                check(&model, &options, budget);
            }
        }
    }
}

#[test]
fn of_a_closed_surface() {
    check_all(&shapes::rock(1_000, 1));
    check_all(&shapes::torus(1.0, 0.4, 30, 16));
}

#[test]
fn of_seams_and_materials() {
    check_all(&shapes::prop(2));
    check_all(&shapes::robot(2));
    check_all(&shapes::demo());
}

/// Vertices of a split's own place: two vertices become a third.
#[test]
fn of_optimal_placement() {
    use multires::simplify::{Placement, Simplifier};
    for placement in [Placement::Midpoint, Placement::Optimal] {
        let simplifier = Simplifier::new().placement(placement);
        let model = HierarchyBuilder::new().simplifier(simplifier).bake(&shapes::rock(2_000, 3)).unwrap();
        for options in [StreamOptions::default(), StreamOptions::exact()] {
            check(&model, &options, 1_000);
        }
    }
}

#[test]
fn of_nothing() {
    let model = VertexHierarchy::bake(&Mesh::default()).unwrap();
    check(&model, &StreamOptions::default(), 1_000);
}

/// Rounded positions stay within half a step, and equal requests give equal bytes.
#[test]
fn within_half_a_step() {
    let mesh = shapes::rock(1_000, 2);
    let model = VertexHierarchy::bake(&mesh).unwrap();
    let server = Server::new(&model, &StreamOptions::default().with_position_bits(Some(10))).unwrap();
    let [low, high] = model.bounds().unwrap();
    let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f32::max);
    let pairs = model.vertices().positions().iter().zip(server.model().vertices().positions());
    for (exact, sent) in pairs {
        let apart = (0..3).map(|axis| (exact[axis] - sent[axis]).abs()).fold(0.0, f32::max);
        assert!(apart <= longest / 1023.0 * 0.5001, "{apart}");
    }
    let mut runs = (0..2).map(|_| {
        let server = Server::new(&model, &StreamOptions::default()).unwrap();
        let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
        client.adapt(&[view([0.0, 0.2, 2.0], 1.0)], 0.0);
        let mut all = Vec::new();
        exchange(&mut session, &mut client, 700, |_, packet| all.extend_from_slice(packet));
        all
    });
    assert!(runs.next() == runs.next());
}
