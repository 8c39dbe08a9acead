//! A service on a port of its own, and clients that wait for the right mesh.

#![allow(dead_code)]

#[path = "../../../../tests/support/sent.rs"]
pub mod sent;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use multires::mesh::shapes;
use multires::prelude::*;
use multires::stream::{ClientOptions, Server};
use multires::view::ObjectView;
use multires_stream_example::browser::Browser;
use multires_stream_example::service::{Service, ServiceOptions};
use multires_stream_example::{line, model};
use tokio::net::TcpListener;
use tokio::task::JoinHandle;
use tokio::time::timeout;

pub use sent::{content, view};

/// Time after which a test that hangs is ended.
const HANGS: Duration = Duration::from_secs(300);

/// A service that is running.
pub struct Running {
    pub service: Arc<Service>,
    pub address: SocketAddr,
    task: JoinHandle<()>,
}

impl Running {
    /// Stops the service, and waits until it has ended.
    pub async fn end(self) {
        self.service.stop();
        timeout(HANGS, self.task).await.unwrap().unwrap();
    }
}

/// Returns a server of a rock.
pub fn rock(triangles: u32, seed: u32) -> Server {
    model::server(&VertexHierarchy::bake(&shapes::rock(triangles, seed)).unwrap(), 12).unwrap()
}

/// Serves a model on a free port of this machine.
pub async fn serve(server: Server, options: ServiceOptions) -> Running {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let service = Service::new(server, options);
    let task = tokio::spawn(Arc::clone(&service).run(listener));
    Running { service, address, task }
}

/// Returns options of a line that takes a moment for the views of these tests: packets of 2,000 bytes.
pub fn slow() -> ServiceOptions {
    ServiceOptions { rate: 40_000.0, ..ServiceOptions::default() }
}

/// Returns a view that needs some 10,000 bytes or more of a rock of 20,000 triangles.
pub fn near(side: f32) -> ObjectView {
    view([2.0 * side.sin(), 0.3, 2.0 * side.cos()], 1.0)
}

/// Opens a client without a journal.
pub fn browser() -> Browser {
    Browser::open(ClientOptions::default(), None, None).unwrap()
}

/// Opens a client with a journal.
pub fn with_journal(file: &std::path::Path) -> Browser {
    Browser::open(ClientOptions::default(), None, Some(file)).unwrap()
}

/// Looks at a view until the client draws what an instance of the whole model draws.
pub async fn see(browser: &mut Browser, address: SocketAddr, server: &Server, view: ObjectView) {
    let mut local = model::local(server).unwrap();
    let triangles = local.adapt(std::slice::from_ref(&view), 0.0).triangles;
    let right = content(&local.to_mesh());
    let mut watch = |browser: &Browser, _: Duration, _: Duration| {
        let all = browser.triangles() == triangles && content(&browser.client().to_mesh()) == right;
        Ok(if all { None } else { Some(vec![view.clone()]) })
    };
    timeout(HANGS, line::run(browser, &address.to_string(), &mut watch)).await.unwrap().unwrap();
}

/// Looks at a view until some packets have come, and ends without a word.
pub async fn begin(browser: &mut Browser, address: SocketAddr, view: ObjectView, packets: usize) {
    let mut watch = |browser: &Browser, _: Duration, _: Duration| {
        Ok(if browser.received().packets >= packets { None } else { Some(vec![view.clone()]) })
    };
    timeout(HANGS, line::run(browser, &address.to_string(), &mut watch)).await.unwrap().unwrap();
}

/// Returns an empty folder for a test.
pub fn folder(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
