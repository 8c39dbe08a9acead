//! Serves a model to any number of viewers over TCP, until ctrl-c.
//!
//! ```text
//! cargo run --release -p multires-stream-example --bin serve                     a model that the crate makes
//! cargo run --release -p multires-stream-example --bin serve -- FILE [--host ADDRESS] [--port 7878]
//!         [--rate BYTES_PER_SECOND] [--bits 12] [--clients 64]
//! ```
//!
//! `FILE` is a mesh (.obj .ply .stl .off .glb .gltf), baked at the start, or a baked vertex hierarchy (.mres).

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use clap::Parser;
use multires_stream_example::service::{Service, ServiceOptions};
use multires_stream_example::{AnyError, model};
use tokio::net::TcpListener;

/// Serves a model to viewers (`browse`) over TCP.
#[derive(Debug, Parser)]
struct Arguments {
    /// Mesh or baked vertex hierarchy; default: a model that the crate makes.
    file: Option<PathBuf>,
    /// Address to listen at; 0.0.0.0 for all networks.
    #[arg(long, default_value = "127.0.0.1")]
    host: String,
    /// Port; 0 for a free port.
    #[arg(long, default_value_t = 7878)]
    port: u16,
    /// Most bytes a second to each client; default: no limit.
    #[arg(long)]
    rate: Option<f64>,
    /// Bits of each coordinate of a position, 1 to 31.
    #[arg(long, default_value_t = 12)]
    bits: u32,
    /// Most clients at once.
    #[arg(long, default_value_t = 64)]
    clients: usize,
}

#[tokio::main]
async fn main() -> ExitCode {
    match run(Arguments::parse()).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

async fn run(arguments: Arguments) -> Result<(), AnyError> {
    let Arguments { file, host, port, rate, bits, clients } = arguments;
    let mut options = ServiceOptions { clients, ..ServiceOptions::default() };
    if let Some(rate) = rate {
        if rate.is_nan() || rate < 1.0 {
            return Err("--rate must be at least 1".into());
        }
        options.rate = rate;
    }
    let server = model::server(&model::open(file.as_deref())?, bits)?;
    let listener =
        TcpListener::bind((host.as_str(), port)).await.map_err(|error| format!("{host}:{port}: {error}"))?;
    let triangles = server.model().structure().triangle_count();
    println!("{}, {triangles} triangles, at {}", model::name(file.as_deref()), listener.local_addr()?);
    let service = Service::new(server, options);
    let mut running = tokio::spawn(Arc::clone(&service).run(listener));
    tokio::select! {
        end = &mut running => end?,
        interrupt = tokio::signal::ctrl_c() => {
            interrupt?;
            service.stop();
            running.await?;
        }
    }
    let counts = service.counts();
    println!("{} connections, {} sessions, {} bytes", counts.connections, counts.sessions, counts.bytes);
    Ok(())
}
