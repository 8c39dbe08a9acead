//! What tests of levels of detail share.

use std::collections::BTreeMap;

use multires::adapt::{Cut, Refinements};
use multires::hierarchy::{Dependencies, HierarchyLod, HierarchyOptions, VertexHierarchy};
use multires::lod::{Baked, Lod, LodOptions, Structure, Values, Vertex};
use multires::mesh::{Mesh, shapes};
use multires::simplify::CollapseSequence;
use multires::tom::{TomOptions, TotallyOrderedMesh};
use multires::view::{Answer, Bounds, Criterion, Motion, View};

pub const POLICIES: [Dependencies; 4] =
    [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours, Dependencies::Manifold];

/// A totally ordered mesh of a sequence, with its vertices.
pub fn bake_tom(mesh: &Mesh, sequence: &CollapseSequence) -> Baked<TotallyOrderedMesh> {
    Baked::of_sequence(mesh, sequence, &TomOptions::default()).unwrap()
}

/// A hierarchy of a sequence, with its vertices.
pub fn bake_hierarchy(
    mesh: &Mesh,
    sequence: &CollapseSequence,
    dependencies: Dependencies,
) -> Baked<VertexHierarchy> {
    let options = HierarchyOptions::default().with_dependencies(dependencies);
    Baked::of_sequence(mesh, sequence, &options).unwrap()
}

/// The positions of a model, as values that may move.
pub fn places<S: Structure>(model: &Baked<S>) -> Values<[f32; 3]> {
    model.values(|v| model.vertices().positions()[v]).with_blending()
}

/// Changes how an instance follows the view, not which vertices lie in its buffer.
pub trait Limited: Lod + Sized {
    fn limit(&mut self, options: LodOptions) {
        let buffer = self.options().buffer;
        self.set_options(&options.with_buffer(buffer)).unwrap();
    }

    fn limited(mut self, options: LodOptions) -> Self {
        self.limit(options);
        self
    }
}

impl<L: Lod> Limited for L {}

/// Needs what a hash says, as far as parents are needed: any closed set can be asked for, with all splits of the same bounds.
#[derive(Clone)]
pub struct Random {
    pub needed: Vec<bool>,
    pub seen: bool,
    of_bounds: BTreeMap<[u32; 7], bool>,
}

fn bits(bounds: &Bounds) -> [u32; 7] {
    let Bounds { centre: [x, y, z], radius, error, parametric, cone } = *bounds;
    let numbers = [x, y, z, radius, error, parametric].map(f32::to_bits);
    let [x, y, z, radius, error, parametric] = numbers;
    [x, y, z, radius, error, parametric, u32::from_ne_bytes(cone.map(|byte| byte as u8))]
}

impl Random {
    pub fn new(hierarchy: &VertexHierarchy, seed: u64, share: u64) -> Self {
        let splits = 0..hierarchy.split_count() as u32;
        let key = |split: u32| bits(&hierarchy.bounds(split));
        let mut of_bounds = BTreeMap::new();
        for split in splits.clone() {
            let hash =
                (u64::from(split) + 1).wrapping_mul(seed | 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
            of_bounds.entry(key(split)).or_insert(hash % 100 < share);
        }
        // Parents come first, but for those of splits with the same bounds.
        loop {
            let mut settled = true;
            for split in splits.clone() {
                if of_bounds[&key(split)] && !hierarchy.parents(split).all(|parent| of_bounds[&key(parent)]) {
                    of_bounds.insert(key(split), false);
                    settled = false;
                }
            }
            if settled {
                break;
            }
        }
        Self { needed: splits.map(|split| of_bounds[&key(split)]).collect(), seen: true, of_bounds }
    }
}

impl Criterion for Random {
    fn test(&self, bounds: &Bounds) -> Answer {
        Answer::once(self.of_bounds[&bits(bounds)])
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }

    fn sees(&self, _: &Bounds) -> bool {
        self.seen
    }
}

/// The triangles that are drawn, by number, as vertices of the hierarchy.
pub fn drawn<V: Vertex>(lod: &HierarchyLod<V>) -> Vec<(u32, [u32; 3])> {
    let mut all = Vec::new();
    for group in 0..lod.groups() {
        let named = lod.triangles(group).iter().map(|t| match lod.vertices() {
            Some(vertices) => t.map(|slot| vertices[slot as usize]),
            None => *t,
        });
        all.extend(lod.surface().drawn(group).iter().copied().zip(named));
    }
    all.sort_unstable();
    all
}

/// The same from the definition.
pub fn image<V: Vertex>(lod: &HierarchyLod<V>) -> Vec<(u32, [u32; 3])> {
    let triangles = lod.hierarchy().triangles().iter().enumerate();
    let all = triangles.map(|(t, corners)| (t as u32, corners.map(|v| lod.representative(v))));
    all.filter(|(_, [a, b, c])| a != b && b != c && c != a).collect()
}

/// The image of all triangles at a cut, less those with two equal corners.
pub fn image_at(hierarchy: &VertexHierarchy, cut: &Cut) -> Vec<(u32, [u32; 3])> {
    let triangles = hierarchy.triangles().iter().enumerate();
    let all = triangles.map(|(t, corners)| (t as u32, corners.map(|v| hierarchy.representative(v, cut))));
    all.filter(|(_, [a, b, c])| a != b && b != c && c != a).collect()
}

/// Whether a cut holds with each split those it needs.
pub fn is_closed(hierarchy: &VertexHierarchy, cut: &Cut) -> bool {
    let splits = (0..hierarchy.split_count() as u32).filter(|&split| cut.holds(split));
    let mut needed = splits.flat_map(|split| hierarchy.parents(split).chain(hierarchy.dependencies(split)));
    needed.all(|split| cut.holds(split))
}

/// The splits that are drawn.
pub fn shown<V: Vertex>(lod: &HierarchyLod<V>) -> Vec<u32> {
    (0..lod.hierarchy().split_count() as u32).filter(|&split| lod.shows(split)).collect()
}

/// The splits that are asked for.
pub fn wanted(hierarchy: &VertexHierarchy, cut: &Cut) -> Vec<u32> {
    (0..hierarchy.split_count() as u32).filter(|&split| cut.holds(split)).collect()
}

/// What is drawn is a closed set of splits and the image of the input under it.
pub fn assert_valid<V: Vertex>(lod: &HierarchyLod<V>) {
    let hierarchy = lod.hierarchy();
    for split in shown(lod) {
        assert!(hierarchy.parents(split).chain(hierarchy.dependencies(split)).all(|other| lod.shows(other)));
    }
    assert_eq!(drawn(lod), image(lod));
}

pub fn shape(which: usize) -> Mesh {
    match which {
        0 => shapes::rock(2_000, 1),
        1 => shapes::terrain(24, 3),
        2 => shapes::uv_sphere(24, 12),
        3 => shapes::book(5),
        4 => shapes::two_spheres_touching(2),
        5 => shapes::soup(200, 4),
        6 => super::naive::torus(20, 30, true, true),
        _ => shapes::box_with_face_normals(6),
    }
}

/// A view of a mesh from somewhere around it (diagonals from its middle), turned about y; turned by 0 it looks along -z.
pub fn view(mesh: &Mesh, [x, y, z]: [f32; 3], turn: f32, tolerance: f32) -> View {
    let [low, high] = mesh.bounds().unwrap();
    let diagonal = mesh.diagonal() as f32;
    let middle = |i: usize| (low[i] + high[i]) * 0.5;
    let eye = [middle(0) + x * diagonal, middle(1) + y * diagonal, middle(2) + z * diagonal];
    let (sine, cosine) = turn.sin_cos();
    let rows = [[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]];
    let along = |row: [f32; 3]| -(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2]);
    let column = |i: usize| [rows[0][i], rows[1][i], rows[2][i], 0.0];
    let matrix = [column(0), column(1), column(2), [along(rows[0]), along(rows[1]), along(rows[2]), 1.0]];
    View::perspective(matrix, 1.0, [640, 480])
        .unwrap()
        .with_tolerance_px(tolerance)
        .with_silhouette_px(tolerance * 0.5)
}
