//! Promise: a hostile client neither kills the server nor keeps others from what they look at.

mod support;

use std::net::SocketAddr;
use std::time::Duration;

use multires_stream_example::messages::MOST_REQUEST;
use multires_stream_example::service::ServiceOptions;
use support::{begin, browser, near, rock, see, serve, slow};
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;
use tokio::time::sleep;

/// Returns a request as a client sends it first.
fn request() -> Vec<u8> {
    let mut client = browser();
    client.look(&[near(0.0)]);
    client.request().unwrap()
}

/// Returns a head that says that `length` bytes of content follow.
fn head(length: u32) -> Vec<u8> {
    let mut head = request();
    head.truncate(32);
    head[16..20].copy_from_slice(&length.to_le_bytes());
    head
}

/// Returns bytes that no client sends.
fn garbage() -> Vec<Vec<u8>> {
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 56) as u8
    };
    let (request, noise) = (request(), (0..20_000).map(|_| noise()).collect::<Vec<u8>>());
    let changed = |at: usize, value: u8| {
        let mut bytes = request.clone();
        bytes[at] ^= value;
        bytes
    };
    let mut packet = None;
    let (server, mut client) = (rock(500, 3), browser());
    let mut session = server.session();
    client.look(&[]);
    if let Some(request) = client.request() {
        session.receive(&request).unwrap();
        packet = session.packet(1_000);
    }
    vec![
        noise.clone(),
        b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n".to_vec(),
        [head(u32::MAX), noise.clone()].concat(),
        [head((1 << 24) - 32), noise.clone()].concat(),
        [head(MOST_REQUEST as u32), noise.clone()].concat(),
        [head(0), head(0)].concat(),
        head(300),
        request[..request.len() / 2].to_vec(),
        changed(3, 1),
        changed(4, 3),
        changed(24, 1),
        changed(60, 1),
        [request.clone(), noise].concat(),
        [request.clone(), changed(60, 1)].concat(),
        packet.unwrap(),
        Vec::new(),
    ]
}

async fn send(address: SocketAddr, bytes: &[u8]) -> TcpStream {
    let mut socket = TcpStream::connect(address).await.unwrap();
    // Refused in the middle: the server closes at the first byte that no client sends.
    let _ = socket.write_all(bytes).await;
    socket
}

#[tokio::test(flavor = "multi_thread")]
async fn garbage_and_silence_harm_nobody() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), slow()).await;
    let mut honest = browser();
    begin(&mut honest, running.address, near(0.0), 2).await;
    let mut open = Vec::new();
    for bytes in garbage() {
        open.push(send(running.address, &bytes).await);
    }
    see(&mut honest, running.address, &server, near(0.0)).await;
    let mut other = browser();
    see(&mut other, running.address, &server, near(2.0)).await;
    assert_eq!(honest.received().streams, 1);
    while running.service.counts().failed < 8 {
        sleep(Duration::from_millis(5)).await;
    }
    drop(open);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_silent_client_gives_its_place_up() {
    let server = rock(5_000, 1);
    let options =
        ServiceOptions { clients: 2, greeting: Duration::from_millis(200), ..ServiceOptions::default() };
    let running = serve(server.clone(), options).await;
    let mut silent = Vec::new();
    for _ in 0..6 {
        silent.push(send(running.address, &request()[..100]).await);
    }
    see(&mut browser(), running.address, &server, near(0.0)).await;
    drop(silent);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_does_not_read_gives_its_place_up() {
    let server = rock(20_000, 1);
    let options =
        ServiceOptions { clients: 1, patience: Duration::from_millis(300), ..ServiceOptions::default() };
    let running = serve(server.clone(), options).await;
    let deaf = send(running.address, &request()).await;
    see(&mut browser(), running.address, &server, near(0.0)).await;
    drop(deaf);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_flood_of_requests_leaves_others_their_share() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), slow()).await;
    let mut floods = Vec::new();
    for number in 0..4 {
        let address = running.address;
        floods.push(tokio::spawn(async move {
            let mut socket = TcpStream::connect(address).await.unwrap();
            let mut client = browser();
            for step in 0_u64.. {
                client.look(&[near(number as f32 + step as f32 * 0.01)]);
                let Some(request) = client.request() else { break };
                if socket.write_all(&request).await.is_err() {
                    break;
                }
            }
        }));
    }
    see(&mut browser(), running.address, &server, near(0.0)).await;
    floods.iter().for_each(tokio::task::JoinHandle::abort);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_whose_stream_another_takes_still_sees_what_it_looks_at() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), slow()).await;
    // Both servers number their streams alike.
    let other = serve(rock(5_000, 2), ServiceOptions::default()).await;
    let mut thief = browser();
    begin(&mut thief, other.address, near(0.0), 2).await;
    thief.connected();
    let stolen = thief.request().unwrap();

    let (mut honest, address) = (browser(), running.address);
    let looks = tokio::spawn(async move {
        see(&mut honest, address, &server, near(0.0)).await;
        honest.received()
    });
    while running.service.counts().bytes < 5_000 {
        sleep(Duration::from_millis(5)).await;
    }
    let thief = send(running.address, &stolen).await;
    looks.await.unwrap();
    drop(thief);
    other.end().await;
    running.end().await;
}
