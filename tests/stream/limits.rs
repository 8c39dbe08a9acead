//! Promise: a client's limits hold after every packet; what it has does not come again; a new view is heeded at once.

use multires::hierarchy::VertexHierarchy;
#[cfg(feature = "quality")]
use multires::mesh::Mesh;
use multires::mesh::shapes;
use multires::prelude::*;
use multires::stream::{Client, ClientOptions, Server, StreamError, StreamOptions};

use crate::sent::{client, content, exchange, view};

fn server(triangles: u32) -> Server {
    Server::new(&VertexHierarchy::bake(&shapes::rock(triangles, 1)).unwrap(), &StreamOptions::default())
        .unwrap()
}

#[test]
fn a_limit_of_triangles_holds_after_every_packet() {
    let server = server(4_000);
    for limit in [0, 100, 1_000, 2_000] {
        let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
        let mut options = LodOptions::default();
        options.triangles = Some(limit);
        client.set_options(&options).unwrap();
        let most = limit.max(server.model().structure().base_triangle_count());
        for step in 0..20 {
            let angle = step as f32 * 0.5;
            client.adapt(&[view([2.0 * angle.cos(), 0.3, 2.0 * angle.sin()], 0.3)], 0.0);
            exchange(&mut session, &mut client, 400, |client, _| assert!(client.triangles(0).len() <= most));
        }
        // Near the limit: a split brings a few triangles.
        assert!(
            limit < 100 || client.triangles(0).len() + 20 > limit,
            "{} of {limit}",
            client.triangles(0).len()
        );
    }
}

/// Some splits of this model bring whole components: thousands of bytes, which no packet can part.
#[test]
fn a_packet_of_several_splits_holds_its_budget() {
    let server =
        Server::new(&VertexHierarchy::bake(&shapes::demo()).unwrap(), &StreamOptions::default()).unwrap();
    let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
    client.adapt(&[view([0.0, 0.5, 4.0], 3.0)], 0.0);
    let mut alone = 0;
    loop {
        session.receive(&client.request()).unwrap();
        let Some(packet) = session.packet(500) else { break };
        let splits = client.receive(&packet).unwrap().splits;
        let over = packet.len() > 800;
        alone += usize::from(over);
        assert!(!over || splits == 1, "{splits} splits take {} bytes", packet.len());
    }
    assert!(alone > 0);
}

/// Levels come coarse first, and in a level the most urgent splits: on the way the surface is never much worse than the best of
/// as many triangles.
#[cfg(feature = "quality")]
#[test]
fn the_most_urgent_comes_first() {
    use multires::quality::{DistanceOptions, distance};
    use multires::view::look_at;
    let server = server(4_000);
    let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
    // From afar, so that errors count alike everywhere.
    let camera = look_at([0.0, 0.3, 400.0], [0.0; 3], [0.0, 1.0, 0.0]);
    let view = View::perspective(camera, 1.0, [1920, 1080]).unwrap().with_tolerance_px(1e-3);
    client.adapt(&[view.with_back_faces_culled(false).with_frustum(false).of_world()], 0.0);
    let mut found = Vec::new();
    exchange(&mut session, &mut client, 500, |client, _| found.push(client.to_mesh()));
    let whole = found.pop().unwrap();
    assert!(found.len() > 10);
    let error = |mesh: &Mesh| {
        distance(&whole, mesh, &DistanceOptions::default().with_samples(10_000)).unwrap().hausdorff()
    };
    for part in [3, 5, 7] {
        let mesh = &found[part * found.len() / 10];
        let best = server.model().level(Level::Triangles(mesh.triangles().len())).mesh;
        let ratio = error(mesh) / error(&best);
        assert!(ratio < 1.5, "{part}: {ratio} at {} triangles", mesh.triangles().len());
    }
}

#[test]
fn what_is_there_does_not_come_again() {
    let server = server(4_000);
    let (mut session, mut other) = (server.session(), client(ClientOptions::default()));
    let eye = |step: usize| [0.4 * (step as f32 * 0.1).sin(), 0.3, 1.6];
    let mut bytes = Vec::new();
    for step in 0..60 {
        other.adapt(&[view(eye(step), 1.0)], 0.0);
        bytes.push(exchange(&mut session, &mut other, 4_000, |_, _| {}));
    }
    let later: usize = bytes[1..].iter().sum();
    assert!(later < 10 * bytes[0], "{bytes:?}");
    // The same view again costs nothing.
    assert_eq!(exchange(&mut session, &mut other, 4_000, |_, _| {}), 0);
    assert!(session.counts().cached > 0);
    // A cache takes its share of what would come again.
    let (mut session, mut bare) = (server.session(), client(ClientOptions::default().with_cache_share(0.0)));
    let mut without = 0;
    for step in 0..60 {
        bare.adapt(&[view(eye(step), 1.0)], 0.0);
        without += exchange(&mut session, &mut bare, 4_000, |_, _| {});
    }
    assert!(bytes.iter().sum::<usize>() < without);
    assert!(content(&bare.to_mesh()) == content(&other.to_mesh()));
}

#[test]
fn a_new_view_is_heeded_at_the_next_packet() {
    let server = server(6_000);
    let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
    client.adapt(&[view([0.0, 0.3, 1.5], 0.2)], 0.0);
    for _ in 0..6 {
        session.receive(&client.request()).unwrap();
        client.receive(&session.packet(1_000).unwrap()).unwrap();
    }
    // From far away nothing of this is needed.
    client.adapt(&[view([0.0, 0.3, 300.0], 1.0)], 0.0);
    let bytes = exchange(&mut session, &mut client, 1_000, |_, _| {});
    let mut lod =
        server.model().instance(server.model().values(|_| [0_u8; 4]), &LodOptions::default()).unwrap();
    lod.adapt(&[view([0.0, 0.3, 300.0], 1.0)], 0.0);
    assert_eq!(client.triangles(0).len(), lod.triangles(0).len());
    assert!(bytes < 3_000, "{bytes}");
}

#[test]
fn a_client_may_keep_what_no_view_asks_for() {
    let server = server(2_000);
    let (mut session, mut client) = (server.session(), client(ClientOptions::default().with_keeps(true)));
    let mut last = 0;
    for eye in [[0.0, 0.3, 2.0], [0.0, 0.3, -2.0], [2.0, 0.3, 0.0], [0.0, 0.3, 50.0]] {
        client.adapt(&[view(eye, 1.0)], 0.0);
        exchange(&mut session, &mut client, 2_000, |_, _| {});
        assert!(client.triangles(0).len() >= last);
        last = client.triangles(0).len();
    }
    assert_eq!(session.counts().collapses, 0);
}

#[test]
fn a_session_is_light() {
    let server = server(20_000);
    let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
    for step in 0..10 {
        client.adapt(&[view([0.0, 0.3, 3.0 - 0.2 * step as f32], 1.0)], 0.0);
        exchange(&mut session, &mut client, 8_000, |_, _| {});
    }
    let splits = server.model().structure().split_count();
    // A bit a split, 4 bytes a place of the cache, models and a window.
    assert!(session.memory() <= splits / 8 + splits / 4 + 40_000, "{} for {splits}", session.memory());
    assert!(server.memory() <= 80 * server.model().structure().leaf_count());
}

#[test]
fn options_out_of_range_are_named() {
    let model = VertexHierarchy::bake(&shapes::rock(100, 1)).unwrap();
    for bits in [0, 32] {
        let options = StreamOptions::default().with_attribute_bits(Some(bits));
        let error = Server::new(&model, &options).unwrap_err();
        assert!(matches!(error, StreamError::OutOfRange { option: "attribute_bits", .. }));
    }
    // A client takes no more than it says.
    let server = server(2_000);
    let mut session = server.session();
    let mut small = Client::new(ClientOptions::default().with_most(1_000), |vertex| vertex.position());
    session.receive(&small.request()).unwrap();
    assert!(matches!(small.receive(&session.packet(1_000).unwrap()), Err(StreamError::TooLarge { .. })));
}

/// A client that asks for a cache of everything gets what its server grants, and draws the same.
#[test]
fn the_server_limits_the_cache() {
    let server = server(4_000);
    let memory = |asked: f32, most: f32| {
        let (mut session, mut client) =
            (server.session(), client(ClientOptions::default().with_cache_share(asked)));
        session.set_most_cache_share(most);
        for step in 0..12 {
            let angle = step as f32;
            client.adapt(&[view([2.0 * angle.cos(), 0.3, 2.0 * angle.sin()], 0.5)], 0.0);
            exchange(&mut session, &mut client, 1_000, |_, _| {});
        }
        (session.memory(), session.counts().cached, content(&client.to_mesh()))
    };
    let [none, little, granted, all] =
        [(1.0, 0.0), (0.05, 1.0), (1.0, 0.05), (1.0, 1.0)].map(|(a, b)| memory(a, b));
    assert_eq!(none.1, 0);
    assert!(little.0 == granted.0 && little.1 == granted.1, "{} {}", little.0, granted.0);
    assert!(all.0 > granted.0 && all.1 > granted.1 && granted.1 > 0);
    assert!(none.2 == all.2 && none.2 == granted.2);
}
