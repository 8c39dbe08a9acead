//! The default model: all challenges of level of detail in a single closed model.
//!
//! ```text
//!      .-""-.       gold: two thin rings, sharp-edged        crystal: flat facets, every edge a crease
//!    /  .--.  \     bronze: a trefoil knot, half of it smooth and half carved
//!   |  ( <> )  |
//!    \  '--'  /
//!      '_||_'       marble: a turned and fluted plinth, creases between mouldings
//!    .--'  '--.     stone: a weathered rock with relief at every scale
//!   (__________)
//! ```

use glam::{DMat3, DVec3};

use super::super::Mesh;
use super::noise::{noise, octaves, ridges, sin_cos, smoothstep};
use super::part::{Assembly, Part};
use super::solids::{FACES, face_axes, icosahedron};
use super::tubes::Knot;

const STONE: u32 = 0;
const MARBLE: u32 = 1;
const BRONZE: u32 = 2;
const GOLD: u32 = 3;
const CRYSTAL: u32 = 4;

/// Middle of the knot, the rings and the crystal.
const HEART: DVec3 = DVec3::new(0.0, 1.12, 0.0);

/// A sculpture of about 70 000 triangles, 2 units wide and 2.6 high: a knot and a crystal in two thin rings, on a
/// turned plinth, on a rock.
///
/// Five materials, normals with creases, texture coordinates with seams. Welded, it is closed and manifold, with six
/// components. Three components have a handle: the knot and the rings.
pub fn demo() -> Mesh {
    let mut assembly = Assembly::default();
    assembly.add(stone(), STONE);
    plinth().into_iter().for_each(|part| assembly.add(part, MARBLE));
    assembly.add(knot(), BRONZE);
    for (radius, turned) in [(0.80, 0.06), (0.88, -0.11)] {
        ring(radius, turned).into_iter().for_each(|part| assembly.add(part, GOLD));
    }
    crystal().into_iter().for_each(|part| assembly.add(part, CRYSTAL));
    assembly.finish(&["stone", "marble", "bronze", "gold", "crystal"])
}

/// A flat-topped rock: the six faces of a cube, rounded and worn. Each face has a cell of the texture.
fn stone() -> Part {
    let n = 40;
    let mut part = Part::default();
    for (face, (axis, side)) in FACES.into_iter().enumerate() {
        let [right, up] = face_axes(axis, side);
        let cell = [face % 3, face / 3].map(|i| i as f64);
        part.add_grid(n, n, |column, row| {
            // Integers until here: both faces at an edge find equal directions.
            let mut d = [if side { f64::from(n) } else { -f64::from(n) }; 3];
            d[right] = f64::from(2 * column) - f64::from(n);
            d[up] = f64::from(2 * row) - f64::from(n);
            let uv = [
                (cell[0] + f64::from(column) / f64::from(n)) / 3.0,
                (cell[1] + f64::from(row) / f64::from(n)) / 2.0,
            ];
            (worn(DVec3::from(d).normalize()), uv.map(|x| x as f32))
        });
    }
    part
}

/// The rock's surface in a direction.
fn worn(d: DVec3) -> DVec3 {
    let p = d.as_vec3();
    let lumps = f64::from(octaves(1.9 * p, 3, 11));
    let crests = f64::from(ridges(2.4 * p, 5, 31));
    let grain = f64::from(octaves(11.0 * p, 4, 51));
    // The top is trodden smooth, the flanks are rough.
    let rough = 1.0 - 0.6 * smoothstep(0.25, 0.85, d.y);
    let radius = 0.80 + rough * (0.30 * lumps + 0.20 * crests + 0.05 * grain);
    let point = d * radius * DVec3::new(0.92, 0.7, 0.92);
    // Pressed flat towards the top, without a crease.
    let height = point.y.min(0.0) + 0.3 * (1.0 - 1.0 / (1.0 + point.y.max(0.0) / 0.3));
    DVec3::new(point.x, height - 0.08, point.z)
}

/// A moulding of a turned shape.
struct Moulding {
    /// Radius and height at both ends.
    ends: [[f64; 2]; 2],
    rows: u32,
    /// How far the middle swells outwards.
    swell: f64,
    /// Depth of flutes.
    flutes: f64,
}

impl Moulding {
    const fn flat(from: [f64; 2], to: [f64; 2], rows: u32) -> Self {
        Self { ends: [from, to], rows, swell: 0.0, flutes: 0.0 }
    }

    fn length(&self) -> f64 {
        let [[r0, h0], [r1, h1]] = self.ends;
        ((r1 - r0) * (r1 - r0) + (h1 - h0) * (h1 - h0)).sqrt()
    }

    /// Radius and height at a row. Both ends are exact, to meet the neighbours.
    fn at(&self, row: u32) -> [f64; 2] {
        let [from @ [r0, h0], to @ [r1, h1]] = self.ends;
        if row == 0 {
            return from;
        }
        if row == self.rows {
            return to;
        }
        let t = f64::from(row) / f64::from(self.rows);
        let swell = 4.0 * t * (1.0 - t) * self.swell / self.length();
        [r0 + (r1 - r0) * t + swell * (h1 - h0), h0 + (h1 - h0) * t + swell * (r0 - r1)]
    }
}

const PLINTH: [Moulding; 9] = [
    Moulding::flat([0.00, -0.10], [0.46, -0.10], 2),
    Moulding::flat([0.46, -0.10], [0.46, 0.14], 3),
    Moulding::flat([0.46, 0.14], [0.42, 0.14], 1),
    Moulding { ends: [[0.42, 0.14], [0.36, 0.20]], rows: 8, swell: 0.03, flutes: 0.0 },
    Moulding::flat([0.36, 0.20], [0.33, 0.20], 1),
    Moulding { ends: [[0.33, 0.20], [0.26, 0.46]], rows: 12, swell: -0.015, flutes: 0.02 },
    Moulding::flat([0.26, 0.46], [0.30, 0.46], 1),
    Moulding { ends: [[0.30, 0.46], [0.30, 0.50]], rows: 4, swell: 0.025, flutes: 0.0 },
    Moulding::flat([0.30, 0.50], [0.00, 0.50], 3),
];

/// A turned plinth with a fluted shaft: a part per moulding, creases between.
fn plinth() -> Vec<Part> {
    let columns = 96;
    let total: f64 = PLINTH.iter().map(Moulding::length).sum();
    let mut done = 0.0;
    let mut parts = Vec::new();
    for moulding in &PLINTH {
        parts.push(Part::grid(columns, moulding.rows, |column, row| {
            let t = f64::from(row) / f64::from(moulding.rows);
            let [radius, height] = moulding.at(row);
            // Flutes run out before both ends.
            let [_, wave] = sin_cos(16.0 * f64::from(column % columns) / f64::from(columns));
            let fluted = smoothstep(0.0, 0.15, t) * smoothstep(0.0, 0.15, 1.0 - t) * moulding.flutes;
            let radius = (radius - fluted * (1.0 - wave.abs())).max(0.0);
            let [sin, cos] = sin_cos(f64::from(column % columns) / f64::from(columns));
            let uv = [f64::from(column) / f64::from(columns), (done + moulding.length() * t) / total];
            (DVec3::new(radius * cos, height, -radius * sin), uv.map(|x| x as f32))
        }));
        done += moulding.length();
    }
    parts
}

/// A trefoil standing upright: a smooth half, and a half with twisted grooves and hammer marks.
fn knot() -> Part {
    let (segments, sides) = (480, 42);
    let knot = Knot::new(2, 3);
    Part::grid(segments, sides, |column, row| {
        let along = f64::from(column % segments) / f64::from(segments);
        let around = f64::from(row % sides) / f64::from(sides);
        let [_, half] = sin_cos(along);
        let carved = smoothstep(-0.15, 0.35, half);
        let [_, wave] = sin_cos(7.0 * around + 36.0 * along);
        // Round in the groove, sharp on the crest.
        let groove = 1.0 - wave.abs();
        let frame = knot.frame(along);
        let marks = f64::from(noise((9.0 * frame.point(around, knot.tube)).as_vec3(), 71));
        let radius = knot.tube * (1.0 - carved * (0.28 * groove + 0.05 * marks));
        let p = 0.46 * frame.point(around, radius);
        // From lying to standing: y towards the viewer.
        let upright = DVec3::new(p.x, -p.z, p.y);
        let uv = [column as f32 / segments as f32, row as f32 / sides as f32];
        (HEART + upright, uv)
    })
}

/// A thin tilted ring of rectangular section around the heart: four smooth bands, creases between.
fn ring(radius: f64, turned: f64) -> [Part; 4] {
    let columns = 160;
    let [sin, cos] = sin_cos(turned);
    let tilt = DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z)
        * DMat3::from_cols(DVec3::X, DVec3::new(0.0, cos, sin), DVec3::new(0.0, -sin, cos));
    // Outside, top, inside, bottom: corners of the section in order.
    let corners = [[0.012, -0.03], [0.012, 0.03], [-0.012, 0.03], [-0.012, -0.03]];
    std::array::from_fn(|band| {
        Part::grid(columns, 2, |column, row| {
            let ([a, b], [c, d]) = (corners[band], corners[(band + 1) % 4]);
            let [out, up] = match row {
                0 => [a, b],
                1 => [(a + c) / 2.0, (b + d) / 2.0],
                _ => [c, d],
            };
            let [sin, cos] = sin_cos(f64::from(column % columns) / f64::from(columns));
            let p = DVec3::new((radius + out) * cos, up, -(radius + out) * sin);
            let uv = [column as f32 / columns as f32, (band as f32 + row as f32 / 2.0) / 4.0];
            (HEART + tilt * p, uv)
        })
    })
}

/// A faceted stone at the heart: a part per facet.
fn crystal() -> Vec<Part> {
    let (positions, triangles) = icosahedron();
    let place = |v: u32| {
        let p = DVec3::from(positions[v as usize].map(f64::from));
        (HEART + p * DVec3::new(0.11, 0.19, 0.11)).as_vec3().to_array()
    };
    let facet = |(index, corners): (usize, &[u32; 3])| {
        let [u, v] = [index % 5, index / 5].map(|i| i as f32);
        Part {
            positions: corners.map(place).to_vec(),
            uv: [[u, v], [u + 1.0, v], [u + 0.5, v + 1.0]].map(|[u, v]| [u / 5.0, v / 4.0]).to_vec(),
            triangles: vec![[0, 1, 2]],
        }
    };
    triangles.iter().enumerate().map(facet).collect()
}
