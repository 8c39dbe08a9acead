//! Makes the page and serves it.
//!
//! ```text
//!     cargo build --target wasm32-unknown-unknown     the library of this package, once for each program
//!     bindings                                        by the same release of wasm-bindgen
//!     demo.mres                                       the model that is shown first, baked as an application would ship it
//!     target/web/page                                 those, the files of `page/`, and all of them compressed (`.gz`)
//! ```
//!
//! All of it is static: any server will do for `target/web/page`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use multires::Structure;
use multires::hierarchy::VertexHierarchy;
use multires::io::{BakeOptions, Compression};
use multires::mesh::shapes;
use multires_web_viewer::bindings::{Bindings, compressed, copy_all, root, target_folder};
use tiny_http::{Header, Request, Response, Server, StatusCode};

/// Most bytes of the program of a worker, plain and compressed.
const MOST: [usize; 2] = [3_000_000, 1_200_000];

/// Makes the viewer's page and serves it.
#[derive(Parser)]
struct Arguments {
    /// Where to listen; port 0 is any that is free
    #[arg(long, default_value = "127.0.0.1:8080")]
    listen: String,
    /// Makes the page, and stops
    #[arg(long)]
    only_make: bool,
    /// Makes it in less time, and larger: for tests
    #[arg(long, conflicts_with = "as_made")]
    quick: bool,
    /// Serves the page as it was made last
    #[arg(long, conflicts_with = "only_make")]
    as_made: bool,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let page = target_folder().join("web/page");
    if !arguments.as_made {
        make(&page, arguments.quick)?;
    }
    if arguments.only_make {
        return Ok(());
    }
    let server = Server::http(&arguments.listen).map_err(|error| format!("{}: {error}", arguments.listen))?;
    println!("http://{}/", server.server_addr());
    for request in server.incoming_requests() {
        // Who is gone needs no answer.
        let _ = answer(request, &page);
    }
    Ok(())
}

fn make(page: &Path, quick: bool) -> Result<(), String> {
    for (feature, profile) in [("webgl", "web-small"), ("webgpu", "web-small"), ("build", "web")] {
        let name = format!("multires_{feature}");
        let package = "multires-web-viewer";
        let bindings = Bindings { package, profile, feature, to: page, name: &name, most: MOST, quick };
        println!("{}", bindings.make()?);
    }
    copy_all(&root().join("examples/web/page"), page)?;
    let demo = VertexHierarchy::bake(&shapes::demo()).map_err(|error| error.to_string())?;
    let options = BakeOptions::default().with_compression(Compression::Lz4);
    demo.write_with(page.join("demo.mres"), options).map_err(|error| error.to_string())?;
    compress_all(page).map_err(|error| format!("{}: {error}", page.display()))
}

/// Writes every file of the page once more, compressed.
fn compress_all(page: &Path) -> std::io::Result<()> {
    for file in std::fs::read_dir(page)? {
        let file = file?.path();
        if file.extension().is_some_and(|extension| extension != "gz") {
            std::fs::write(zipped(&file), compressed(&std::fs::read(&file)?))?;
        }
    }
    Ok(())
}

/// The file that holds another, compressed.
fn zipped(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".gz");
    name.into()
}

/// What a file is, by its name; `None` for files that a page does not have.
fn kind(name: &str) -> Option<&'static str> {
    Some(match name.rsplit_once('.')?.1 {
        "html" => "text/html; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "wasm" => "application/wasm",
        "svg" => "image/svg+xml",
        "mres" => "application/octet-stream",
        _ => return None,
    })
}

/// Answers with a file of the page's own folder; its name is all of the path.
fn answer(request: Request, page: &Path) -> std::io::Result<()> {
    let path = request.url().split(['?', '#']).next().unwrap_or_default();
    let name = match path.trim_start_matches('/') {
        "" => "index.html",
        name => name,
    }
    .to_owned();
    let is_plain =
        name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-'));
    let zips = request
        .headers()
        .iter()
        .any(|header| header.field.equiv("Accept-Encoding") && header.value.as_str().contains("gzip"));
    let path = page.join(&name);
    let file = kind(&name).filter(|_| is_plain).and_then(|kind| {
        let compressed = std::fs::read(zipped(&path)).ok().filter(|_| zips);
        let is_compressed = compressed.is_some();
        Some((kind, is_compressed, compressed.or_else(|| std::fs::read(&path).ok())?))
    });
    let Some((kind, is_compressed, bytes)) = file else {
        return request
            .respond(Response::from_string("there is no such page").with_status_code(StatusCode(404)));
    };
    // Isolated pages get the finer clock.
    let mut headers = vec![
        ("Content-Type", kind),
        ("Cache-Control", "no-cache"),
        ("Cross-Origin-Opener-Policy", "same-origin"),
        ("Cross-Origin-Embedder-Policy", "require-corp"),
    ];
    if is_compressed {
        headers.push(("Content-Encoding", "gzip"));
    }
    let headers = headers.iter().filter_map(|(field, value)| Header::from_bytes(*field, *value).ok());
    let mut response = Response::from_data(bytes);
    headers.for_each(|header| response.add_header(header));
    request.respond(response)
}
