//! Procedural meshes: smooth, natural, awkward, technical and game models, and the demo.
//!
//! | file | idea |
//! |---|---|
//! | `solids.rs` | spheres and boxes |
//! | `tubes.rs` | tori, torus knots, open cylinders, Moebius strips |
//! | `nature.rs` | fractal terrain and rocks |
//! | `islands.rs` | many separate parts: a forest of leaf cards, a field of pebbles, a shell of two spheres |
//! | `awkward.rs` | the smallest meshes that break careless code |
//! | `cad.rs` | machine parts: plates with holes, shafts, gears, letters, boxes cut by boxes |
//! | `game.rs` | game assets: atlases, materials, mirrored halves, cards, facets, skins, paint |
//! | `demo.rs` | [`demo`]: seams, creases, materials, thin parts and relief in one closed model |
//! | `grid.rs` | grids of cells, and limits |
//! | `part.rs` | grids with texture coordinates, smooth normals, and their assembly |
//! | `noise.rs` | hash, gradient noise, sine and cosine: the same bits everywhere |
//!
//! All meshes are in object units, y up, with triangles counter-clockwise seen from outside or above. Where a surface
//! closes on itself (seams, poles, creases), positions are equal bit for bit, so welding closes it.
//!
//! Equal arguments give equal bytes on every platform: the code uses only sums, products, quotients and square roots.
//! Counts are clamped to a sensible minimum and to the capacity of a [`Mesh`](super::Mesh); lengths that are not
//! positive and finite are replaced. Each function states its limits.

mod awkward;
mod cad;
mod demo;
mod game;
mod grid;
mod islands;
mod nature;
mod noise;
mod part;
mod solids;
mod tubes;

pub use awkward::{book, bowtie, hub, pillow, plane, soup, spindle, tetrahedron, two_spheres_touching};
pub use cad::{
    cad_part, cut_in_four, gear, lettering, plate_with_hole, plate_with_seam_island, pocketed_block,
    ring_with_ramps, stepped_shaft, two_material_plate, washer,
};
pub use demo::demo;
pub use game::{flat_rock, painted_disc, prop, robot, skinned_tube, tree};
use grid::{MAX_CELLS, bare, cells, fit, length_or};
pub use islands::{forest, gravel, shell};
pub use nature::{rock, terrain};
pub use solids::{box_with_face_normals, cube, icosphere, uv_sphere};
pub use tubes::{moebius, open_cylinder, torus, torus_knot};
