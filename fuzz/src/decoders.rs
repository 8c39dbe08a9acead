//! Decoders, each given any bytes.
//!
//! Checksums would keep a fuzzer at the door. So the first byte of the data says whether checksums are made to fit (odd), and what a
//! fuzzer changes arrives behind them.

use std::io::Cursor;
use std::sync::{Arc, LazyLock};

use multires::io::{Format, GltfDocument, GltfLevels, OpenOptions, open_model, read_bytes};
use multires::lod::Values;
use multires::mesh::shapes;
use multires::prelude::*;
use multires::stream::store::Store;
use multires::stream::{Client, ClientOptions, Server, StreamOptions, read_prefix};
use multires::view::{ObjectView, look_at};

use crate::mend;

/// Splits data into whether checksums are to fit, and the rest.
fn split(data: &[u8]) -> (bool, Vec<u8>) {
    match data.split_first() {
        Some((first, rest)) => (first % 2 == 1, rest.to_vec()),
        None => (false, Vec::new()),
    }
}

/// A view of the origin.
fn view(eye: [f32; 3]) -> ObjectView {
    let camera = look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
    View::perspective(camera, 1.0, [1920, 1080]).expect("a view").with_tolerance_px(0.5).of_world()
}

/// Views that an instance is flown through, from far to near.
fn views() -> [ObjectView; 3] {
    [[0.0, 0.3, 30.0], [0.5, 0.3, 2.0], [-1.0, 0.1, 0.4]].map(view)
}

/// Checks that drawn triangles name vertices.
fn check(lod: &dyn Lod, vertices: usize) {
    for group in 0..lod.groups() {
        for triangle in lod.triangles(group) {
            assert!(triangle.iter().all(|&corner| (corner as usize) < vertices));
        }
    }
}

/// Decodes a baked file of any structure, and draws what opens.
pub fn baked(data: &[u8]) -> bool {
    let (mends, mut bytes) = split(data);
    if mends {
        mend::sections(&mut bytes);
    }
    let Ok(model) = open_model(Arc::new(bytes), OpenOptions::default()) else { return false };
    let values = Values::from(model.vertices().positions().to_vec()).with_blending();
    let Ok(mut lod) = model.instance(&values, &LodOptions::default()) else { return false };
    for view in views() {
        lod.adapt(&[view], 1.0);
    }
    lod.to_mesh();
    true
}

/// Decodes a store and all of its pages, and flies an instance.
pub fn store(data: &[u8]) -> bool {
    let (mends, mut bytes) = split(data);
    if mends {
        mend::sections_in_a_row(&mut bytes);
    }
    let mut file = Cursor::new(bytes);
    let Ok(store) = Store::open(&mut file) else { return false };
    let mut lod = store.instance(1 << 20, &LodOptions::default(), |vertex| vertex.position());
    for view in views() {
        for _ in 0..8 {
            lod.adapt(std::slice::from_ref(&view), 0.0);
            check(&lod, lod.values().len());
            // A damaged page stays wanted: others may come.
            for wanted in lod.wanted() {
                let range = wanted.range.start as usize..wanted.range.end as usize;
                let page = file.get_ref().get(range).unwrap_or_default().to_vec();
                let _ = lod.supply(wanted.page, page);
            }
        }
    }
    lod.to_mesh();
    lod.adapt(&[], 0.0);
    check(&lod, lod.values().len());
    lod.pages() > 0
}

/// Gives messages to a client, one after the other.
pub fn packets(data: &[u8]) -> bool {
    let (mends, bytes) = split(data);
    let options = ClientOptions::default().with_most(1 << 16);
    let mut client = Client::new(options, |vertex: multires::stream::StreamVertex<'_>| vertex.position());
    client.adapt(&views()[..1], 0.0);
    let mut sound = false;
    for mut message in mend::messages(&bytes) {
        if mends {
            mend::message(&mut message);
        }
        sound |= client.receive(&message).is_ok();
        check(&client, client.values().len());
        client.request();
    }
    client.to_mesh();
    sound
}

/// The server that [`requests`] are sent to.
static SERVER: LazyLock<Server> = LazyLock::new(|| {
    let model = VertexHierarchy::bake(&shapes::rock(500, 1)).expect("a model");
    Server::new(&model, &StreamOptions::default()).expect("a server")
});

/// Gives messages to a session, one after the other, and takes its packets.
pub fn requests(data: &[u8]) -> bool {
    let (mends, bytes) = split(data);
    let mut session = SERVER.session();
    let mut sound = false;
    for mut message in mend::messages(&bytes) {
        if mends {
            mend::message(&mut message);
        }
        sound |= session.receive(&message).is_ok();
        for _ in 0..4 {
            let Some(packet) = session.packet(1_000) else { break };
            assert!(packet.len() < 1 << 16);
        }
    }
    sound
}

/// Decodes a file of which every beginning is a mesh.
pub fn prefix(data: &[u8]) -> bool {
    let (mends, mut bytes) = split(data);
    if mends {
        let mended = mend::messages(&bytes).into_iter().map(|mut message| {
            mend::message(&mut message);
            message
        });
        bytes = mended.collect::<Vec<_>>().concat();
    }
    read_prefix(&bytes).is_ok()
}

/// Decodes a mesh.
pub fn meshes(data: &[u8]) -> bool {
    let Some((format, bytes)) = data.get(1..).and_then(<[u8]>::split_first) else { return false };
    let formats = [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Glb, Format::Gltf];
    read_bytes(formats[usize::from(*format) % formats.len()], bytes).is_ok()
}

/// Opens a glTF document, takes its meshes out and puts them back as they are and as levels; what is written must open.
pub fn documents(data: &[u8]) -> bool {
    let Some(bytes) = data.get(1..) else { return false };
    let Ok(mut document) = GltfDocument::from_bytes(bytes) else { return false };
    for i in 0..document.mesh_count().min(4) {
        assert!(document.mesh_scale(i) > 0.0);
        let poses = document.poses(i, 3).unwrap_or_default();
        let Ok(Some(imported)) = document.mesh(i) else { continue };
        for pose in
            GltfDocument::extreme_poses(&poses, &imported.mesh, 2).iter().chain(&document.target_poses(i))
        {
            assert_eq!(pose.positions(&imported.mesh).len(), imported.mesh.positions().len());
        }
        let _ = document.replace(i, &imported.mesh);
        let _ = document.add_level(i, &imported.mesh, 0.5);
    }
    document.link_levels(GltfLevels::MsftLod);
    let Ok(written) = document.to_glb() else { return false };
    GltfDocument::from_bytes(&written).expect("what is written opens");
    true
}
