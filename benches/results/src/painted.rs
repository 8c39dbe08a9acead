//! A surface painted by what is on the base: colours and normals stay where they are, whatever triangles carry them.
//!
//! A drawn set of wavelets and the full resolution are functions on the same base faces (Azuma et al., section 3.1). So every vertex
//! of the full resolution has a place on what is drawn, and there it gets the colour and the normal that it has at full resolution:
//! a texture and a normal map with a texel a vertex, or more where triangles are few; and as with any texture, there are coarser ones
//! for where texels are smaller than pixels.

use std::error::Error;

use glam::Vec3;
use multires::mesh::{Attribute, Mesh, names};
use multires::wavelet::{Normals, WaveletMesh};

/// Triangles that carry the texture, about, where the full resolution has fewer.
const TEXELS: usize = 500_000;

/// What is painted, of the place and the normal at full resolution.
pub type Paint = fn(Vec3, Vec3) -> [u8; 3];

/// Normals and colours at the corners of what carries them.
struct Texture {
    normals: Vec<[f32; 3]>,
    colours: Vec<[u8; 3]>,
}

/// A surface and the colours of its vertices.
pub type Coloured = (Mesh, Vec<[u8; 3]>);

pub struct Painted {
    /// The full resolution, by the wavelet mesh's own vertices.
    triangles: Vec<[u32; 3]>,
    /// Wavelet, vertex and its ends, those of coarser levels first.
    order: Vec<(u32, u32, [u32; 2])>,
    /// Parts that a triangle's sides are cut in.
    parts: usize,
    fine: Vec<[u32; 3]>,
    /// Mean length of the edges at full resolution, object units.
    texel: f64,
    texture: Texture,
}

impl Painted {
    /// `paint` gets places about the middle of the box, in diagonals.
    pub fn new(mesh: &WaveletMesh, paint: Paint) -> Result<Self, Box<dyn Error>> {
        let of = mesh.subdivision();
        let kept = mesh.vertices().attribute(names::NORMAL).is_some();
        let full = mesh.finest(if kept { Normals::Kept } else { Normals::Recomputed });
        if full.positions().len() != of.vertex_count() {
            return Err("some vertices are in no triangle".into());
        }
        let triangles = full.triangles().to_vec();
        let ends = (0..of.vertex_count() as u32).filter_map(|v| Some((of.wavelet_of(v)?, v, of.ends(v)?)));
        let mut order: Vec<_> = ends.collect();
        order.sort_unstable();
        let place = |v: u32| full.positions().get(v as usize).map_or(Vec3::ZERO, |&p| Vec3::from_array(p));
        let lengths = triangles.iter().map(|&[a, b, _]| f64::from(place(a).distance(place(b))));
        let texel = lengths.sum::<f64>() / triangles.len().max(1) as f64;
        let parts = ((TEXELS / triangles.len().max(1)) as f64).sqrt() as usize;
        let parts = parts.clamp(1, 8);
        let texture = Texture { normals: Vec::new(), colours: Vec::new() };
        let mut painted = Self { triangles, order, parts, fine: Vec::new(), texel, texture };
        let own = full.attribute(names::NORMAL).and_then(Attribute::as_floats).unwrap_or_default();
        let own: Vec<[f32; 3]> = own.chunks_exact(3).map(|n| [n[0], n[1], n[2]]).collect();
        painted.texture.normals = painted.spread(&own);
        painted.fine = painted.cut();
        let [low, high] = mesh.extent().unwrap_or_default().map(Vec3::from_array);
        let size = mesh.diagonal() as f32;
        let places = painted.spread(full.positions());
        let colour = |(&p, &n): (&[f32; 3], &[f32; 3])| {
            paint((Vec3::from_array(p) - (low + high) * 0.5) / size, Vec3::from_array(n).normalize_or_zero())
        };
        painted.texture.colours = places.iter().zip(&painted.texture.normals).map(colour).collect();
        Ok(painted)
    }

    /// The painted surface of a set of wavelets that is closed under parents, and its colours, from where pixels span so much of it
    /// (object units).
    pub fn on(
        &self,
        mesh: &WaveletMesh,
        shows: impl Fn(u32) -> bool,
        pixel: f64,
    ) -> Result<Coloured, Box<dyn Error>> {
        let mut places = mesh.vertices().positions().to_vec();
        for &(wavelet, vertex, ends) in &self.order {
            if !shows(wavelet) {
                let [a, b] = ends.map(|end| Vec3::from_array(places[end as usize]));
                places[vertex as usize] = ((a + b) * 0.5).to_array();
            }
        }
        let of = mesh.subdivision();
        let coarser = (pixel / self.texel).log2().ceil().clamp(0.0, of.depth() as f64) as usize;
        let Texture { normals, colours } = &self.texture;
        let (normals, colours) = if coarser > 0 && self.parts == 1 {
            let up_to = of.wavelets_of(of.depth() - coarser).end;
            let shades: Vec<[f32; 3]> = colours.iter().map(|colour| colour.map(f32::from)).collect();
            let shades = self.filtered(shades, up_to);
            (self.filtered(normals.clone(), up_to), shades.iter().map(|c| c.map(|x| x as u8)).collect())
        } else {
            (normals.clone(), colours.clone())
        };
        let normals = Attribute::floats(names::NORMAL, &normals);
        Ok((Mesh::new(self.spread(&places), self.fine.clone())?.with_attribute(normals)?, colours))
    }

    /// Values without what is finer than the vertices of the first wavelets: means by hats, and between these in the middle of ends.
    fn filtered(&self, values: Vec<[f32; 3]>, up_to: u32) -> Vec<[f32; 3]> {
        let mut sums: Vec<(Vec3, f32)> = values.into_iter().map(|v| (Vec3::from_array(v), 1.0)).collect();
        let finer = self.order.partition_point(|&(wavelet, ..)| wavelet < up_to);
        for &(_, vertex, ends) in self.order[finer..].iter().rev() {
            let (sum, weight) = sums[vertex as usize];
            for end in ends {
                let at = &mut sums[end as usize];
                *at = (at.0 + sum * 0.5, at.1 + weight * 0.5);
            }
        }
        for &(_, vertex, [a, b]) in &self.order[finer..] {
            let [a, b] = [a, b].map(|end| sums[end as usize].0 / sums[end as usize].1);
            sums[vertex as usize] = ((a + b) * 0.5, 1.0);
        }
        sums.into_iter().map(|(sum, weight)| (sum / weight).to_array()).collect()
    }

    /// Values at the points that triangles are cut at: the vertices' own where they are not cut.
    fn spread(&self, values: &[[f32; 3]]) -> Vec<[f32; 3]> {
        if self.parts == 1 {
            return values.to_vec();
        }
        let n = self.parts;
        let mut out = Vec::new();
        for corners in &self.triangles {
            let [a, b, c] =
                corners.map(|v| values.get(v as usize).map_or(Vec3::ZERO, |&p| Vec3::from_array(p)));
            for i in 0..=n {
                for j in 0..=n - i {
                    let sum = a * (n - i - j) as f32 + b * j as f32 + c * i as f32;
                    out.push((sum / n as f32).to_array());
                }
            }
        }
        out
    }

    /// The triangles between those points.
    fn cut(&self) -> Vec<[u32; 3]> {
        if self.parts == 1 {
            return self.triangles.clone();
        }
        let n = self.parts as u32;
        let points = (n + 1) * (n + 2) / 2;
        let mut out = Vec::with_capacity(self.triangles.len() * self.parts * self.parts);
        for first in (0..self.triangles.len() as u32).map(|t| t * points) {
            let mut row = first;
            for left in (1..=n).rev() {
                let next = row + left + 1;
                for j in 0..left {
                    out.push([row + j, row + j + 1, next + j]);
                    if j + 1 < left {
                        out.push([row + j + 1, next + j + 1, next + j]);
                    }
                }
                row = next;
            }
        }
        out
    }
}

fn mix(a: [f32; 3], b: [f32; 3], t: f32) -> [u8; 3] {
    Vec3::from_array(a).lerp(Vec3::from_array(b), t.clamp(0.0, 1.0)).to_array().map(|x| x as u8)
}

fn step(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Bands that wind about.
pub fn marble(place: Vec3, _: Vec3) -> [u8; 3] {
    let p = place * 14.0;
    let wave = (2.1 * p.x + 1.3 * (1.1 * p.y + 0.6 * (1.7 * p.z).sin()).sin() + 0.9 * p.z).sin();
    let vein = (1.3 * p.y - 0.8 * p.x + 1.6 * (0.9 * p.z + p.x).sin()).sin().abs();
    let [r, g, b] = mix([226.0, 208.0, 176.0], [86.0, 126.0, 150.0], step(-0.25, 0.25, wave));
    mix([150.0, 72.0, 50.0], [r, g, b].map(f32::from), step(0.04, 0.14, vein))
}

/// Grass, rock where it is steep, snow above.
pub fn land(place: Vec3, normal: Vec3) -> [u8; 3] {
    let rough = 0.008 * ((70.0 * place.x).sin() + (83.0 * place.z + 40.0 * place.x).sin());
    let grass = mix([120.0, 148.0, 84.0], [176.0, 166.0, 112.0], step(-0.05, 0.0, place.y + rough));
    let rock = mix([118.0, 104.0, 92.0], [146.0, 138.0, 130.0], step(-0.02, 0.05, place.y));
    let ground = mix(grass.map(f32::from), rock.map(f32::from), step(0.86, 0.74, normal.y));
    let snow = step(0.02, 0.04, place.y + rough) * step(0.55, 0.75, normal.y);
    mix(ground.map(f32::from), [240.0, 243.0, 247.0], snow)
}
