//! Promise: any number of clients are served at once, each with what it looks at, and a shutdown ends all of them.

mod support;

use std::time::Duration;

use multires::stream::ClientOptions;
use multires_stream_example::browser::Browser;
use multires_stream_example::line;
use multires_stream_example::service::ServiceOptions;
use support::{begin, browser, near, rock, see, serve, slow};
use tokio::task::JoinSet;

#[tokio::test(flavor = "multi_thread")]
async fn several_clients_at_once_see_what_they_look_at() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), slow()).await;
    let mut clients = JoinSet::new();
    for number in 0..8 {
        let (server, address) = (server.clone(), running.address);
        clients.spawn(async move {
            let mut client = browser();
            for step in 0..3 {
                see(&mut client, address, &server, near(number as f32 + 0.3 * step as f32)).await;
            }
            client.received().streams
        });
    }
    while let Some(end) = clients.join_next().await {
        assert_eq!(end.unwrap(), 1);
    }
    assert_eq!(running.service.counts().sessions, 8);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn the_limit_of_triangles_holds_for_each_client() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), slow()).await;
    let mut clients = JoinSet::new();
    for most in [300, 1_000, 2_000] {
        let address = running.address.to_string();
        clients.spawn(async move {
            let mut client = Browser::open(ClientOptions::default(), Some(most), None).unwrap();
            let mut drawn = 0;
            let mut watch = |browser: &Browser, _: Duration, quiet: Duration| {
                drawn = browser.triangles();
                assert!(drawn <= most, "{drawn} of at most {most}");
                let ends = drawn > most * 9 / 10 && quiet > Duration::from_millis(300);
                Ok(if ends { None } else { Some(vec![near(0.0)]) })
            };
            line::run(&mut client, &address, &mut watch).await.unwrap();
        });
    }
    while let Some(end) = clients.join_next().await {
        end.unwrap();
    }
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_shutdown_ends_all_connections() {
    let server = rock(20_000, 1);
    let running = serve(server.clone(), slow()).await;
    let _silent = tokio::net::TcpStream::connect(running.address).await.unwrap();
    let mut clients = JoinSet::new();
    for _ in 0..3 {
        let address = running.address;
        clients.spawn(async move {
            // These clients want more packets than the model has.
            let mut client = browser();
            begin(&mut client, address, near(0.0), usize::MAX).await;
        });
    }
    let service = running.service.clone();
    while service.counts().bytes < 10_000 {
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    running.end().await;
    clients.shutdown().await;
    assert_eq!(service.lobby().count(), [3, 3], "the clients may come back");
    assert_eq!(service.counts().failed, 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_service_that_was_stopped_before_ends_at_once() {
    let running = serve(rock(2_000, 1), ServiceOptions::default()).await;
    running.end().await;
}
