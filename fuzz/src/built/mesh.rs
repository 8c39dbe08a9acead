//! Any mesh: a small shape, bent out of shape.

use multires::mesh::{Attribute, AttributeValues, Mesh, names, shapes};

use super::choices::Choices;

/// A mesh, and what is known of it.
pub struct AnyMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// Whether single precision is far from its ends.
    pub is_moderate: bool,
}

/// Any mesh of up to about a thousand triangles.
pub fn any_mesh(choices: &mut Choices<'_>) -> AnyMesh {
    let shape = shape(choices);
    let mut arrays = Arrays::new(&shape);
    for _ in 0..choices.below(4) {
        arrays.bend(choices);
    }
    let is_moderate = arrays.scale(choices);
    AnyMesh { mesh: arrays.into_mesh(choices), is_moderate }
}

fn shape(choices: &mut Choices<'_>) -> Mesh {
    let seed = choices.below(1000) as u32;
    let mut number = |low: u32, high: u32| low + choices.below((high - low + 1) as usize) as u32;
    match number(0, 27) {
        0 => shapes::icosphere(number(0, 2)),
        1 => shapes::terrain(number(2, 12), seed),
        2 => shapes::plane(number(1, 12)),
        3 => shapes::book(number(1, 14)),
        4 => shapes::bowtie(),
        5 => shapes::pillow(),
        6 => shapes::two_spheres_touching(number(0, 2)),
        7 => shapes::hub(number(3, 60)),
        8 => shapes::spindle(number(3, 60)),
        9 => shapes::soup(number(1, 80), seed),
        10 => shapes::box_with_face_normals(number(1, 5)),
        11 => shapes::tree(number(1, 30)),
        12 => shapes::skinned_tube(number(3, 10), number(1, 12)),
        13 => shapes::painted_disc(number(3, 16), number(1, 8)),
        14 => shapes::forest(number(1, 12), number(1, 4), seed),
        15 => shapes::gravel(number(1, 8), seed),
        16 => shapes::shell(number(0, 1), 0.9),
        17 => shapes::torus(1.0, 0.4, number(3, 16), number(3, 10)),
        18 => shapes::moebius(number(3, 24)),
        19 => shapes::uv_sphere(number(3, 16), number(2, 10)),
        20 => shapes::cad_part(seed),
        21 => shapes::plate_with_hole(number(3, 24), 0.2),
        22 => shapes::prop(1),
        23 => shapes::open_cylinder(number(3, 16), number(1, 8)),
        24 => shapes::flat_rock(number(20, 300), seed),
        25 => shapes::rock(number(20, 600), seed),
        26 => Mesh::default(),
        _ => tangle(choices),
    }
}

/// Triangles between points of a small grid, whichever.
fn tangle(choices: &mut Choices<'_>) -> Mesh {
    let positions: Vec<[f32; 3]> =
        (0..2 + choices.below(20)).map(|_| std::array::from_fn(|_| choices.below(4) as f32)).collect();
    let triangles: Vec<[u32; 3]> = (0..choices.below(60))
        .map(|_| std::array::from_fn(|_| choices.below(positions.len()) as u32))
        .collect();
    Mesh::new(positions, triangles).expect("positions are finite, corners exist")
}

/// A mesh taken apart.
struct Arrays {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    materials: Vec<u32>,
    attributes: Vec<Attribute>,
}

impl Arrays {
    fn new(mesh: &Mesh) -> Self {
        Self {
            positions: mesh.positions().to_vec(),
            triangles: mesh.triangles().to_vec(),
            materials: mesh.materials().to_vec(),
            attributes: mesh.attributes().to_vec(),
        }
    }

    fn bend(&mut self, choices: &mut Choices<'_>) {
        let (points, count) = (self.positions.len(), self.triangles.len());
        if points == 0 || count == 0 {
            return;
        }
        match choices.below(9) {
            // Triangles twice, also the other way round.
            0 => {
                for _ in 0..1 + choices.below(8) {
                    let [a, b, c] = self.triangles[choices.below(count)];
                    self.triangles.push(choices.one(&[[a, b, c], [c, b, a], [b, c, a]]));
                }
            }
            // Holes.
            1 => {
                for _ in 0..1 + choices.below(8) {
                    let last = self.triangles.len() - 1;
                    if last > 0 {
                        self.triangles.swap_remove(choices.below(last));
                    }
                }
            }
            // Vertices that become others, triangles without area among them.
            2 => {
                for _ in 0..1 + choices.below(6) {
                    let at = choices.below(self.triangles.len());
                    self.triangles[at][choices.below(3)] = choices.below(points) as u32;
                }
            }
            // Vertices of its own for each triangle.
            3 => {
                let order: Vec<u32> = self.triangles.as_flattened().to_vec();
                self.positions = order.iter().map(|&v| self.positions[v as usize]).collect();
                self.attributes = self.attributes.iter().map(|of| gathered(of, &order)).collect();
                self.triangles = (0..order.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            }
            // Positions on a coarse grid.
            4 => {
                let step = choices.one(&[0.25_f32, 0.5, 1.0]);
                for at in self.positions.as_flattened_mut() {
                    *at = (*at / step).round() * step;
                }
            }
            // Points that fall into one.
            5 => {
                for _ in 0..1 + choices.below(6) {
                    let from = choices.below(points);
                    self.positions[choices.below(points)] = self.positions[from];
                }
            }
            // A few points anywhere.
            6 => {
                for _ in 0..1 + choices.below(4) {
                    let (at, to) = (choices.below(points), choices.between(-3.0, 3.0));
                    self.positions[at][choices.below(3)] = to;
                }
            }
            // A second one beside it, or upon it.
            7 => {
                let offset = choices.one(&[0.0_f32, 0.01, 3.0]);
                let second: Vec<[f32; 3]> =
                    self.positions.iter().map(|&[x, y, z]| [x + offset, y, z]).collect();
                self.positions.extend(second);
                let twice: Vec<u32> = (0..points as u32).chain(0..points as u32).collect();
                self.attributes = self.attributes.iter().map(|of| gathered(of, &twice)).collect();
                let shifted: Vec<[u32; 3]> =
                    self.triangles.iter().map(|t| t.map(|v| v + points as u32)).collect();
                self.triangles.extend(shifted);
            }
            // Any order of triangles and corners.
            _ => {
                for at in 0..count {
                    let other = (at * 7 + choices.below(5)) % count;
                    self.triangles.swap(at, other);
                    self.triangles[at].rotate_left(at % 3);
                }
            }
        }
        self.materials.clear();
    }

    /// Scales, shifts, and sets some coordinates to the ends of single precision. Returns whether none of it was extreme.
    fn scale(&mut self, choices: &mut Choices<'_>) -> bool {
        let kind = choices.below(16);
        let [scale, shift] = match kind {
            8 => [1e-3, 0.0],
            9 => [1e6, 0.0],
            10 => [1.0, 1e4],
            11 => [1e30, 0.0],
            12 => [1e-30, 0.0],
            13 => [1e-44, 0.0],
            14 => [1e37, 0.0],
            _ => [1.0_f32, 0.0],
        };
        for at in self.positions.as_flattened_mut() {
            *at = (*at * scale + shift).clamp(-f32::MAX, f32::MAX);
        }
        let picks = if kind == 15 { 1 + choices.below(5) } else { 0 };
        for _ in 0..picks {
            let at = choices.below(self.positions.len());
            let axis = choices.below(3);
            let to = choices.float();
            if let Some(position) = self.positions.get_mut(at) {
                position[axis] = to;
            }
        }
        kind < 10
    }

    fn into_mesh(self, choices: &mut Choices<'_>) -> Mesh {
        let Self { positions, triangles, mut materials, attributes } = self;
        let (count, triangle_count) = (positions.len(), triangles.len());
        let mut mesh = Mesh::new(positions, triangles).expect("finite positions, corners that exist");
        let kept = choices.below(4) != 3;
        for attribute in attributes.into_iter().filter(|_| kept) {
            mesh = mesh.with_attribute(attribute).expect("an attribute of a mesh");
        }
        if choices.once_in(3) {
            let patches = 1 + choices.below(4) as u32;
            let run = 1 + choices.below(20) as u32;
            materials = (0..triangle_count as u32).map(|t| t / run % patches * 7).collect();
        }
        if !materials.is_empty() {
            mesh = mesh.with_materials(materials).expect("a material for each triangle");
        }
        let extra = choices.below(8);
        let given = match extra {
            // Names that others know, a few values so that some vertices agree.
            0 => Some((names::UV, 2)),
            1 => Some((names::NORMAL, 3)),
            2 => Some((names::COLOR, 4)),
            3 => Some(("of its own", 1)),
            _ => None,
        };
        if let Some((name, width)) = given.filter(|(name, _)| mesh.attribute(name).is_none()) {
            let palette: Vec<f32> = (0..1 + choices.below(6)).map(|_| choices.float()).collect();
            let values = (0..count * width).map(|i| palette[i * i / 3 % palette.len()]).collect();
            let attribute = Attribute::new(name, width, AttributeValues::Float(values));
            if let Ok(worn) = mesh.clone().with_attribute(attribute) {
                mesh = worn;
            }
        }
        if choices.once_in(12) {
            let every = 2 + choices.below(9);
            mesh = mesh.with_locks((0..count).map(|v| v % every == 0).collect::<Vec<_>>()).expect("locks");
        }
        mesh
    }
}

/// The values of some vertices.
fn gathered(attribute: &Attribute, order: &[u32]) -> Attribute {
    fn of<T: Copy>(values: &[T], width: usize, order: &[u32]) -> Vec<T> {
        order.iter().flat_map(|&v| values[v as usize * width..][..width].iter().copied()).collect()
    }
    let width = attribute.width();
    let values = match attribute.values() {
        AttributeValues::Float(values) => AttributeValues::Float(of(values, width, order)),
        AttributeValues::Int(values) => AttributeValues::Int(of(values, width, order)),
        AttributeValues::Uint(values) => AttributeValues::Uint(of(values, width, order)),
        other => other.clone(),
    };
    Attribute::new(attribute.name(), width, values)
}
