//! Promise: no bytes make a client or a session panic, whatever the checksum says.

use multires::hierarchy::VertexHierarchy;
use multires::mesh::shapes;
use multires::prelude::*;
use multires::stream::{ClientOptions, Server, StreamOptions};
use proptest::prelude::*;

use crate::sent::{check_buffers, client, view};

/// The checksum of a message, as docs/wire.md says: for a forger who knows it.
fn forge(bytes: &mut [u8]) {
    if bytes.len() < 32 {
        return;
    }
    let length = (bytes.len() - 32) as u32;
    bytes[16..20].copy_from_slice(&length.to_le_bytes());
    let mix = |x: u64| {
        let product = u128::from(x ^ 0x9e37_79b9_7f4a_7c15) * 0xd6e8_feb8_6659_fd93_u128;
        (product as u64) ^ (product >> 64) as u64
    };
    let mut state = bytes.len() as u64;
    for part in [&bytes[..24], &bytes[32..]] {
        for word in part.chunks(8) {
            let mut whole = [0; 8];
            whole[..word.len()].copy_from_slice(word);
            state = mix(state ^ u64::from_le_bytes(whole)).rotate_left(1);
        }
    }
    bytes[24..32].copy_from_slice(&state.to_le_bytes());
}

/// A request and the packets that answer it.
fn talk() -> (Vec<u8>, Vec<Vec<u8>>) {
    let model = VertexHierarchy::bake(&shapes::prop(2)).unwrap();
    let server = Server::new(&model, &StreamOptions::default()).unwrap();
    let (mut session, mut client) = (server.session(), client(ClientOptions::default()));
    let mut packets = Vec::new();
    let mut first = Vec::new();
    for eye in [[0.0, 0.3, 3.0], [0.0, 0.3, 30.0], [1.0, 0.3, 2.0]] {
        client.adapt(&[view(eye, 1.0)], 0.0);
        loop {
            let request = client.request();
            session.receive(&request).unwrap();
            first = if first.is_empty() { request } else { first };
            let Some(packet) = session.packet(600) else { break };
            client.receive(&packet).unwrap();
            packets.push(packet);
        }
    }
    (first, packets)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn changed_packets(
        at in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        thread_local!(static TALK: (Vec<u8>, Vec<Vec<u8>>) = talk());
        TALK.with(|(_, packets)| {
            let mut packets = packets.clone();
            let faulty = at.index(packets.len());
            let packet = &mut packets[faulty];
            for (place, byte) in &changes {
                let place = 32 + place.index(packet.len() - 32);
                packet[place] = *byte;
            }
            if let Some(cut) = cut {
                packet.truncate(32 + cut.index(packet.len() - 31));
            }
            forge(packet);
            let mut client = client(ClientOptions::default().with_most(100_000));
            for packet in &packets {
                let _ = client.receive(packet);
                check_buffers(&client);
                let _ = client.to_mesh();
            }
        });
    }

    #[test]
    fn packets_of_noise(content in prop::collection::vec(any::<u8>(), 0..400), number in 0_u32..4) {
        thread_local!(static TALK: (Vec<u8>, Vec<Vec<u8>>) = talk());
        TALK.with(|(_, packets)| {
            let mut client = client(ClientOptions::default().with_most(100_000));
            for packet in &packets[..number as usize] {
                client.receive(packet).unwrap();
            }
            let mut noise = packets[number as usize][..32].to_vec();
            noise.extend_from_slice(&content);
            forge(&mut noise);
            let _ = client.receive(&noise);
            check_buffers(&client);
            let _ = client.receive(&content);
        });
    }

    #[test]
    fn requests_of_noise(
        content in prop::collection::vec(any::<u8>(), 0..700),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        stream in 0_u8..3,
    ) {
        thread_local!(static TALK: (Vec<u8>, Vec<Vec<u8>>) = talk());
        thread_local!(static SERVER: Server = {
            let model = VertexHierarchy::bake(&shapes::prop(2)).unwrap();
            Server::new(&model, &StreamOptions::default()).unwrap()
        });
        TALK.with(|(request, _)| SERVER.with(|server| {
            let mut session = server.session();
            let mut noise = request[..32].to_vec();
            noise.extend_from_slice(&content);
            let mut changed = request.clone();
            for (place, byte) in &changes {
                let place = 8 + place.index(changed.len() - 8);
                changed[place] = *byte;
            }
            for mut bytes in [noise, changed] {
                bytes[8] = stream;
                forge(&mut bytes);
                let _ = session.receive(&bytes);
                for _ in 0..3 {
                    let _ = session.packet(500);
                }
            }
        }));
    }
}
