//! The lines of a remesh's parameters as a pattern: base faces divided into triangular cells, every other cell dark.
//!
//! ```text
//!          /\              Cells that point as their base face does are dark. Along edges of the base dark cells meet, so that
//!         /##\             the edges show.
//!        /----\
//!       /#\  /#\
//!      /###\/###\
//! ```

use multires::wavelet::{Normals, WaveletMesh};

use super::picture::Shown;
use super::say::grouped;

const DARK: [u8; 3] = [70, 104, 156];
const LIGHT: [u8; 3] = [240, 238, 230];

/// The finest mesh, each base face divided into 4^level cells. For meshes with all base faces split alike.
pub fn checkered(wavelets: &WaveletMesh, level: usize) -> Shown {
    let of = wavelets.subdivision();
    let cells = f64::from(1u32 << level);
    // Triangles of the finest mesh are its faces, in order.
    let colour = |face: u32| {
        let Some(corners) = of.domain_of_face(face) else { return LIGHT };
        let middle: [f64; 3] =
            std::array::from_fn(|k| corners.iter().map(|corner| corner.barycentric[k]).sum::<f64>() / 3.0);
        let below: f64 = middle.iter().map(|weight| (weight * cells).floor()).sum();
        if below + 1.0 >= cells { DARK } else { LIGHT }
    };
    let mesh = wavelets.finest(Normals::Kept);
    let colours = of.faces_of(of.depth()).map(colour).collect();
    let faces = grouped(of.base_face_count());
    Shown { caption: format!("parameters over {faces} base faces"), mesh, colours: Some(colours), edges: 0.0 }
}
