//! The same work natively, for `tests/measure.mjs`: `native FILE ROUNDS`, where the file holds the number of coordinates and of indices,
//! and both, as 32-bit numbers. Prints the shortest time in milliseconds and the triangles left.
use std::time::Instant;

use multires::Mesh;
use multires::simplify::Simplifier;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (file, rounds) = (arguments.next().ok_or("no file")?, arguments.next().ok_or("no rounds")?);
    let bytes = std::fs::read(file)?;
    let words: Vec<[u8; 4]> = bytes.as_chunks::<4>().0.to_vec();
    let count = |i: usize| u32::from_le_bytes(words[i]) as usize;
    let (coordinates, rest) = words[2..].split_at(count(0));
    let positions: Vec<[f32; 3]> =
        coordinates.as_chunks::<3>().0.iter().map(|p| p.map(f32::from_le_bytes)).collect();
    let triangles: Vec<[u32; 3]> =
        rest[..count(1)].as_chunks::<3>().0.iter().map(|t| t.map(u32::from_le_bytes)).collect();
    let (mut best, mut left) = (f64::MAX, 0);
    for _ in 0..rounds.parse()? {
        let since = Instant::now();
        let mesh = Mesh::new(positions.clone(), triangles.clone())?;
        let sequence = Simplifier::new().run(&mesh)?;
        left = sequence.triangles_at(&mesh, sequence.len()).0.len();
        best = best.min(since.elapsed().as_secs_f64() * 1e3);
    }
    println!("{best} {left}");
    Ok(())
}
