//! Promise: a client that was killed, or whose line broke, goes on where it was; where that is impossible it begins anew, and draws
//! the right mesh.

mod support;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use multires_stream_example::service::ServiceOptions;
use support::{begin, browser, folder, near, rock, see, serve, slow, with_journal};
use tokio::io::{AsyncReadExt, copy};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::sleep;

fn length(file: &Path) -> u64 {
    std::fs::metadata(file).map_or(0, |data| data.len())
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_comes_back_resumes() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), slow()).await;
    let journal = folder("comes_back").join("journal");
    let mut first = with_journal(&journal);
    begin(&mut first, running.address, near(0.0), 3).await;
    let had = first.received();
    drop(first);

    let mut again = with_journal(&journal);
    assert_eq!(again.received().journal_packets, had.packets);
    assert_eq!(again.received().journal_bytes, had.bytes);
    assert!(again.triangles() > 0, "drawn before anything has come");
    see(&mut again, running.address, &server, near(0.0)).await;
    assert_eq!(again.received().streams, 0, "no stream began");
    let counts = running.service.counts();
    assert_eq!((counts.sessions, counts.resumed), (1, 1));
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_program_that_was_killed_resumes() {
    let running = serve(rock(20_000, 1), slow()).await;
    let folder = folder("killed");
    let journal = folder.join("journal");
    let browse = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_browse"));
        command.args(["--address", &running.address.to_string(), "--script", "detail", "--every", "0"]);
        command.arg("--journal").arg(&journal).arg("--out").arg(&folder);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    };
    let mut killed = browse().spawn().unwrap();
    while length(&journal) < 6_000 {
        assert!(killed.try_wait().unwrap().is_none(), "the program ended by itself");
        sleep(Duration::from_millis(5)).await;
    }
    killed.kill().unwrap();
    killed.wait().unwrap();

    let mut again = browse();
    let output = tokio::task::spawn_blocking(move || again.output()).await.unwrap().unwrap();
    let says = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{says}{errors}");
    assert!(says.contains("the journal has") && says.contains("resumed"), "{says}");
    let counts = running.service.counts();
    assert_eq!((counts.sessions, counts.resumed), (1, 1));
    running.end().await;
}

/// A line that breaks after `bytes` bytes towards the client, again and again.
async fn broken(listener: TcpListener, to: std::net::SocketAddr, bytes: u64) {
    loop {
        let (mut client, _) = listener.accept().await.unwrap();
        let mut server = TcpStream::connect(to).await.unwrap();
        let (mut from_client, mut to_client) = client.split();
        let (from_server, mut to_server) = server.split();
        let mut some = from_server.take(bytes);
        tokio::select! {
            _ = copy(&mut from_client, &mut to_server) => {}
            _ = copy(&mut some, &mut to_client) => {}
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_line_that_breaks_again_and_again_brings_all_the_same() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), slow()).await;
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let line = tokio::spawn(broken(listener, running.address, 5_000));
    let mut client = browser();
    see(&mut client, address, &server, near(0.0)).await;
    assert_eq!(client.received().streams, 1, "the stream that it began with");
    let counts = running.service.counts();
    assert_eq!(counts.sessions, 1);
    assert!(counts.resumed > 0);
    line.abort();
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_journal_that_lost_its_end_still_leads_to_the_right_mesh() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), ServiceOptions::default()).await;
    let journal = folder("lost_end").join("journal");
    let mut client = with_journal(&journal);
    for side in [0.0, 1.0, 2.0] {
        see(&mut client, running.address, &server, near(side)).await;
    }
    drop(client);
    let file = std::fs::read(&journal).unwrap();
    // The end is lost; the beginning alone is left; a byte in the middle is changed; nothing is left; there is no sense in it.
    let mut changed = file.clone();
    changed[file.len() / 2] ^= 1;
    for bytes in [&file[..file.len() - 1], &file[..100], &changed, &[], &[7; 5_000]] {
        std::fs::write(&journal, bytes).unwrap();
        let mut client = with_journal(&journal);
        see(&mut client, running.address, &server, near(0.5)).await;
    }
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_journal_of_another_server_is_of_no_use_and_does_no_harm() {
    let (server, other) = (rock(20_000, 1), rock(10_000, 2));
    let journal = folder("other_server").join("journal");
    let running = serve(server, ServiceOptions::default()).await;
    begin(&mut with_journal(&journal), running.address, near(0.0), 2).await;
    running.end().await;

    // Its first stream has the number that the journal's stream has.
    let running = serve(other.clone(), ServiceOptions::default()).await;
    let mut client = with_journal(&journal);
    assert!(client.triangles() > 0);
    see(&mut client, running.address, &other, near(0.0)).await;
    assert_eq!(client.received().streams, 1, "began anew");
    drop(client);
    let mut again = with_journal(&journal);
    see(&mut again, running.address, &other, near(0.0)).await;
    assert_eq!(again.received().streams, 0, "and the journal is of the new stream");
    running.end().await;
}
