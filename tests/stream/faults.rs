//! Promise: loss, doubling, reordering and damage are detected, and answered within a round trip by the right mesh.

use multires::hierarchy::VertexHierarchy;
use multires::mesh::shapes;
use multires::prelude::*;
use multires::stream::{ClientOptions, Server, Session, StreamError, StreamOptions, message_length};

use crate::sent::{Positions, check_buffers, client, content, view};

/// What the line does to one packet.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    Dropped,
    Doubled,
    Swapped,
    Cut,
    Changed,
}

/// A flight of a few packets a frame, over a line that does something to one packet. Returns the meshes drawn after each frame,
/// and the number of packets.
fn fly(server: &Server, fault: Option<(usize, Fault)>) -> (Vec<usize>, Positions, usize) {
    let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
    let (mut number, mut drawn) = (0, Vec::new());
    for frame in 0..30 {
        let angle = frame as f32 * 0.1;
        client.adapt(&[view([2.0 * angle.sin(), 0.3, 2.0 * angle.cos()], 3.0)], 0.0);
        session.receive(&client.request()).unwrap();
        let mut packets = Vec::new();
        while let (Some(packet), true) = (session.packet(300), packets.len() < 4) {
            packets.push(packet);
        }
        let mut line = packets.clone();
        for at in 0..packets.len() {
            match fault {
                Some((faulty, kind)) if faulty == number + at => match kind {
                    Fault::Dropped => line[at].clear(),
                    Fault::Doubled => line[at].extend_from_slice(&packets[at]),
                    Fault::Swapped => line.swap(at, (at + 1) % packets.len()),
                    Fault::Cut => line[at].truncate(packets[at].len() * 2 / 3),
                    Fault::Changed => {
                        let middle = packets[at].len() / 2;
                        line[at][middle] ^= 4;
                    }
                },
                _ => {}
            }
        }
        number += packets.len();
        for bytes in line {
            take(&mut client, bytes);
        }
        drawn.push(client.triangles(0).len());
    }
    // What is still missing comes within a round trip. If the last packet is lost, nothing tells but time.
    client.ask_again();
    settle(&mut session, &mut client);
    (drawn, client, number)
}

/// Takes in packets as they come from the line.
fn take(client: &mut Positions, mut bytes: Vec<u8>) {
    while !bytes.is_empty() {
        let length = match message_length(&bytes) {
            Ok(Some(length)) if length <= bytes.len() => length,
            _ => bytes.len(),
        };
        let rest = bytes.split_off(length);
        match client.receive(&bytes) {
            Ok(_) | Err(StreamError::NoMessage { .. } | StreamError::Missing { .. }) => check_buffers(client),
            Err(error) => panic!("{error}"),
        }
        bytes = rest;
    }
}

fn settle(session: &mut Session, client: &mut Positions) {
    for _ in 0..1_000 {
        session.receive(&client.request()).unwrap();
        let Some(packet) = session.packet(2_000) else { break };
        take(client, packet);
    }
    assert!(session.is_done());
}

#[test]
fn every_packet_may_be_dropped_doubled_swapped_cut_or_changed() {
    let model = VertexHierarchy::bake(&shapes::rock(1_000, 1)).unwrap();
    let server = Server::new(&model, &StreamOptions::default()).unwrap();
    let (_, right, packets) = fly(&server, None);
    let right = content(&right.to_mesh());
    assert!(packets > 40, "{packets}");
    for number in 0..packets {
        for kind in [Fault::Dropped, Fault::Doubled, Fault::Swapped, Fault::Cut, Fault::Changed] {
            let (_, client, _) = fly(&server, Some((number, kind)));
            assert!(content(&client.to_mesh()) == right, "packet {number} {kind:?}");
        }
    }
}

/// A flight of 300 frames in which every eighth packet suffers the same when it is sent first; in eight flights it is each.
#[test]
fn every_packet_of_a_long_flight() {
    const APART: u32 = 8;
    let model = VertexHierarchy::bake(&shapes::rock(4_000, 1)).unwrap();
    let server = Server::new(&model, &StreamOptions::default()).unwrap();
    let faults = [Fault::Dropped, Fault::Doubled, Fault::Swapped, Fault::Cut, Fault::Changed];
    let mut faulty = 0;
    for (fault, turn) in faults.into_iter().flat_map(|fault| (0..APART).map(move |turn| (fault, turn))) {
        let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
        // Packets before this number went bad; of the last, its number and its frame.
        let (mut suffered, mut missing) = (0, None);
        for frame in 0..300 {
            let angle = frame as f32 * 0.05;
            let distance = 1.6 + 0.5 * (frame as f32 * 0.03).cos();
            client.adapt(&[view([distance * angle.sin(), 0.3, distance * angle.cos()], 2.0)], 0.0);
            client.ask_again();
            session.receive(&client.request()).unwrap();
            let mut packets: Vec<Vec<u8>> = Vec::new();
            while let (true, Some(packet)) = (packets.len() < 4, session.packet(300)) {
                packets.push(packet);
            }
            let number = |packet: &[u8]| u32::from_le_bytes(packet[12..16].try_into().unwrap());
            if let Some((lost, since)) = missing.take() {
                assert_eq!(frame, since + 1);
                assert!(
                    packets.iter().any(|packet| number(packet) == lost),
                    "{fault:?}: {lost} does not come again"
                );
            }
            let mut line = packets.clone();
            let of_turn = |packet: &Vec<u8>| number(packet) % APART == turn && number(packet) >= suffered;
            if let Some(at) = packets.iter().position(of_turn) {
                suffered = number(&packets[at]) + 1;
                faulty += 1;
                let half = packets[at].len() / 2;
                match fault {
                    Fault::Dropped => line[at].clear(),
                    Fault::Doubled => line[at].extend_from_slice(&packets[at]),
                    Fault::Swapped => line.swap(at, (at + 1) % packets.len()),
                    Fault::Cut => line[at].truncate(half),
                    Fault::Changed => line[at][half] ^= 4,
                }
                if !matches!(fault, Fault::Doubled | Fault::Swapped) {
                    missing = Some((number(&packets[at]), frame));
                }
            }
            line.into_iter().for_each(|bytes| take(&mut client, bytes));
        }
        client.ask_again();
        settle(&mut session, &mut client);
        let values = server.model().values(|vertex| server.model().vertices().positions()[vertex]);
        let mut local = server.model().instance(values, &LodOptions::default()).unwrap();
        let angle = 299.0 * 0.05_f32;
        let distance = 1.6 + 0.5 * (299.0 * 0.03_f32).cos();
        local.adapt(&[view([distance * angle.sin(), 0.3, distance * angle.cos()], 2.0)], 0.0);
        assert!(content(&client.to_mesh()) == content(&local.to_mesh()), "{fault:?} {turn}");
    }
    assert!(faulty > 5 * 300, "{faulty} packets went bad");
}

/// The frame after a loss draws what it would have drawn: the missing packets are sent again with the next request.
#[test]
fn a_loss_is_made_good_within_a_round_trip() {
    let model = VertexHierarchy::bake(&shapes::rock(1_000, 1)).unwrap();
    let server = Server::new(&model, &StreamOptions::default()).unwrap();
    let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
    client.adapt(&[view([0.0, 0.3, 2.0], 1.0)], 0.0);
    session.receive(&client.request()).unwrap();
    let packets: Vec<Vec<u8>> = (0..6).map(|_| session.packet(400).unwrap()).collect();
    client.receive(&packets[0]).unwrap();
    client.receive(&packets[1]).unwrap();
    // The third never comes.
    assert!(matches!(client.receive(&packets[3]), Err(StreamError::Missing { expected: 2, found: 3 })));
    assert!(client.has_request());
    session.receive(&client.request()).unwrap();
    for packet in &packets[2..] {
        assert_eq!(session.packet(400).as_ref(), Some(packet));
        client.receive(packet).unwrap();
    }
    // A client that hears nothing asks again, and gets only what it lacks.
    client.ask_again();
    session.receive(&client.request()).unwrap();
    assert!(session.packet(400).is_none_or(|packet| client.receive(&packet).is_ok()));
}

/// A client that comes back with what it had goes on where it was; one that comes back with nothing begins anew.
#[test]
fn a_client_that_comes_back_goes_on() {
    let model = VertexHierarchy::bake(&shapes::rock(2_000, 1)).unwrap();
    let server = Server::new(&model, &StreamOptions::default()).unwrap();
    let mut session = server.session();
    let mut first = client(ClientOptions::default());
    let views = [view([0.0, 0.3, 2.0], 1.0)];
    first.adapt(&views, 0.0);
    for _ in 0..5 {
        session.receive(&first.request()).unwrap();
        first.receive(&session.packet(500).unwrap()).unwrap();
    }
    // Two packets on their way are lost with the connection.
    assert!(session.packet(500).is_some() && session.packet(500).is_some());
    let before = session.counts().bytes;
    let mut back = first.clone();
    back.ask_again();
    settle(&mut session, &mut back);
    let rest = session.counts().bytes - before;
    let mut anew = client(ClientOptions::default());
    anew.adapt(&views, 0.0);
    let before = session.counts().bytes;
    settle(&mut session, &mut anew);
    assert!(session.counts().bytes - before > rest);
    assert!(content(&anew.to_mesh()) == content(&back.to_mesh()));
    // Another session does not know the stream: the client begins anew by itself.
    let mut other = server.session();
    back.ask_again();
    settle(&mut other, &mut back);
    assert!(content(&anew.to_mesh()) == content(&back.to_mesh()));
}

/// Servers number their streams alike. A client of one that comes to another, with a number that is taken there, begins anew.
#[test]
fn a_client_of_another_server_begins_anew() {
    let server = |seed: u32| {
        let model = VertexHierarchy::bake(&shapes::rock(1_000, seed)).unwrap();
        Server::new(&model, &StreamOptions::default()).unwrap()
    };
    let (old, new) = (server(1), server(2));
    let views = [view([0.0, 0.3, 2.0], 1.0)];
    for [had, sent] in [[3, 2], [3, 3], [3, 5], [2, 8]] {
        let (mut session, mut client) = (old.session(), client(ClientOptions::default()));
        client.adapt(&views, 0.0);
        for _ in 0..had {
            session.receive(&client.request()).unwrap();
            client.receive(&session.packet(300).unwrap()).unwrap();
        }
        // Another client has been sent packets that it did not acknowledge.
        let (mut session, mut other) = (new.session(), self::client(ClientOptions::default()));
        other.adapt(&views, 0.0);
        session.receive(&other.request()).unwrap();
        (0..sent).for_each(|_| assert!(session.packet(300).is_some()));
        client.ask_again();
        settle(&mut session, &mut client);
        let mut right = self::client(ClientOptions::default());
        right.adapt(&views, 0.0);
        settle(&mut new.session(), &mut right);
        assert!(content(&client.to_mesh()) == content(&right.to_mesh()), "{had} of {sent}");
    }
}
