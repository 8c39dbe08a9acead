//! Bytes of a whole mesh by codecs: meshoptimizer's beside a stream of splits, positions rounded alike.
//!
//! meshoptimizer's codec has no order from coarse to fine, and is meant to be followed by a general compressor. Its index codec
//! turns triangles, and its vertices are in the order of first use. A progressive file can be cut anywhere.

use std::error::Error;
use std::time::Instant;

use multires::Structure;
use multires::hierarchy::VertexHierarchy;
use multires::stream::{StreamOptions, read_prefix, write_prefix};

use super::input::Input;

/// Prints a table: bytes a vertex, geometry and connectivity together, by bits of a position.
pub(crate) fn run(inputs: &[Input], bits: &[u32]) -> Result<(), Box<dyn Error>> {
    println!(
        "{:>20} {:>10} {:>5} {:>14} {:>14} {:>14}",
        "model", "vertices", "bits", "meshopt B/v", "splits B/v", "decode ms"
    );
    for input in inputs {
        let model = VertexHierarchy::bake(&input.mesh)?;
        for &bits in bits {
            let options = StreamOptions::default().with_position_bits(Some(bits));
            let bytes = write_prefix(&model, &options)?;
            let start = Instant::now();
            let whole = read_prefix(&bytes)?;
            let decode = start.elapsed().as_secs_f64() * 1e3;
            let vertices = whole.mesh.positions().len();
            let peer = meshopt_bytes(whole.mesh.positions(), whole.mesh.indices(), bits)?;
            println!(
                "{:>20} {vertices:>10} {bits:>5} {:>14.2} {:>14.2} {decode:>14.0}",
                input.name,
                peer as f64 / vertices as f64,
                bytes.len() as f64 / vertices as f64,
            );
        }
    }
    Ok(())
}

/// Returns the bytes of indices and rounded positions, in the order that the codec likes best.
fn meshopt_bytes(positions: &[[f32; 3]], indices: &[u32], bits: u32) -> Result<usize, Box<dyn Error>> {
    let axes = [0, 1, 2].map(|axis| {
        positions.iter().fold([f32::MAX, f32::MIN], |[low, high], p| [low.min(p[axis]), high.max(p[axis])])
    });
    let longest = axes.iter().map(|[low, high]| high - low).fold(0.0, f32::max);
    let step = longest / ((1_u32 << bits) - 1) as f32;
    let round = |p: &[f32; 3]| {
        let number = |axis: usize| ((p[axis] - axes[axis][0]) / step).round() as u16;
        [number(0), number(1), number(2), 0]
    };
    let vertices: Vec<[u16; 4]> = positions.iter().map(round).collect();
    let mut order = meshopt::optimize_vertex_cache(indices, vertices.len());
    let vertices = meshopt::optimize_vertex_fetch(&mut order, &vertices);
    let indices = meshopt::encode_index_buffer(&order, vertices.len())?;
    Ok(indices.len() + meshopt::encode_vertex_buffer(&vertices)?.len())
}
