//! Promise: on every model, from everywhere, with any dependencies, what a cut draws is a surface like the input: the border is
//! the input's border, what is closed stays closed, seams are not torn, materials stay apart, and hardly any triangle
//! faces the other way.
//!
//! *Flipped* is a triangle whose normal is more than 90 degrees from its original's. Levels of the sequence have some, since
//! many small turns add up. *New* ones are those that no level has; *in front* those in the picture whose
//! original faces the eye. Of all models together, in percent of what is drawn (levels of as many triangles as are drawn
//! without dependencies have 0.055 % flipped):
//!
//! | dependencies | drawn | flipped | new | new in front | images that no level has |
//! |---|--:|--:|--:|--:|--:|
//! | none | 1,198,205 | 0.197 | 0.143 | 0.045 | 8.4 |
//! | adjacent | 1,456,009 | 0.045 | 0.001 | 0.001 | 0.4 |
//! | neighbours | 1,658,680 | 0.036 | 0 | 0 | 0 |
#![cfg(feature = "io")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::flown::path::{Pose, VIEWPORT, approach};
use crate::flown::{History, NEVER, Placed, drawn};
use glam::DVec3;
use multires::adapt::Refinements;
use multires::hierarchy::{
    Dependencies, HierarchyBuild, HierarchyLod, HierarchyOptions, HierarchyParts, VertexHierarchy,
};
use multires::io::{self, Format};
use multires::lod::{Baked, Lod};
use multires::mesh::{Mesh, shapes};
use multires::simplify::{CollapseSequence, Simplifier};
use multires::view::{Answer, Bounds, Criterion, Motion};

const POLICIES: [Dependencies; 3] = [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours];
/// Frames of the path: far, half way, near, beside, and away again.
const FRAMES: [usize; 6] = [0, 200, 320, 399, 460, 540];
/// Triangles thinner than this share of the square of their longest edge have no normal worth the name.
const FLAT: f64 = 1e-6;

/// Border of triangles as a chain: how much more often the edge from the lower to the higher point is run through in
/// this direction than in the other. Triangles are corners by point.
fn border(triangles: impl Iterator<Item = [u32; 3]>) -> BTreeMap<[u32; 2], i32> {
    let edges = triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    chain(edges.map(|edge| (edge, 1)))
}

fn chain(edges: impl Iterator<Item = ([u32; 2], i32)>) -> BTreeMap<[u32; 2], i32> {
    let mut all: Vec<([u32; 2], i32)> = edges
        .filter(|([a, b], _)| a != b)
        .map(|([a, b], n)| if a < b { ([a, b], n) } else { ([b, a], -n) })
        .collect();
    all.sort_unstable();
    let mut chain = BTreeMap::new();
    for run in all.chunk_by(|a, b| a.0 == b.0) {
        let sum: i32 = run.iter().map(|(_, n)| n).sum();
        if sum != 0 {
            chain.insert(run[0].0, sum);
        }
    }
    chain
}

/// Normal of a triangle, not of unit length; `None` where it has none worth the name.
fn normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let normal = (b - a).cross(c - a);
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (normal.length() > 2.0 * FLAT * longest).then_some(normal)
}

/// Triangles that face away from their originals, counted.
#[derive(Debug, Clone, Copy, Default)]
struct Flips {
    drawn: usize,
    /// Images that no level of the sequence has.
    unseen: usize,
    flipped: usize,
    /// Flipped images that no level of the sequence has.
    new: usize,
    /// Drawn in the picture, where the original faces the eye.
    front: usize,
    new_in_front: usize,
}

impl Flips {
    fn add(&mut self, other: Self) {
        self.drawn += other.drawn;
        self.unseen += other.unseen;
        self.flipped += other.flipped;
        self.new += other.new;
        self.front += other.front;
        self.new_in_front += other.new_in_front;
    }
}

struct Model<'a> {
    name: &'a str,
    mesh: &'a Mesh,
    sequence: &'a CollapseSequence,
    history: History,
    /// Per input vertex its point, by position.
    point: Vec<u32>,
}

impl<'a> Model<'a> {
    fn new(name: &'a str, mesh: &'a Mesh, sequence: &'a CollapseSequence) -> Self {
        let point = multires::mesh::Topology::new(mesh).point_of().to_vec();
        Self { name, mesh, sequence, history: History::new(sequence), point }
    }

    /// Checks the cut and counts flips.
    fn check(
        &self,
        built: &HierarchyBuild,
        placed: &Placed,
        lod: &HierarchyLod,
        pose: &Pose,
        what: &str,
    ) -> Flips {
        let (hierarchy, input) = (lod.hierarchy(), |v: u32| built.vertex_order[v as usize]);
        let all = drawn(lod);
        let what = format!("{} {what}", self.name);

        // Every vertex of the input that is drawn, where it is drawn: all wedges of a point at one.
        let mut drawn_at = vec![u32::MAX; self.mesh.positions().len()];
        for &leaf in hierarchy.triangles().as_flattened() {
            let to = self.point[input(hierarchy.representative(leaf, lod.cut())) as usize];
            let at = &mut drawn_at[self.point[input(leaf) as usize] as usize];
            assert!(*at == u32::MAX || *at == to, "{what}: a seam is torn at vertex {}", input(leaf));
            *at = to;
        }

        // The border of the image is the image of the border: nothing opens, nothing closes.
        let points = |corners: [u32; 3]| corners.map(|v| self.point[input(v) as usize]);
        let image = border(all.iter().map(|&(_, corners)| points(corners)));
        let whole = border(hierarchy.triangles().iter().map(|&corners| points(corners)));
        let expected = chain(whole.iter().map(|(&edge, &n)| (edge.map(|p| drawn_at[p as usize]), n)));
        assert!(image == expected, "{what}: {} border edges, not {}", image.len(), expected.len());
        assert!(!whole.is_empty() || image.is_empty(), "{what}: opened");

        // Materials: every group has one, and draws its triangles only.
        for group in 0..lod.groups() {
            for &triangle in lod.surface().drawn(group) {
                let of = built.triangle_order[triangle as usize] as usize;
                let known = self.mesh.materials().get(of);
                assert_eq!(hierarchy.materials().get(group), known, "{what}: material of {of}");
            }
        }

        let mut flips = Flips { drawn: all.len(), ..Flips::default() };
        for &(triangle, corners) in &all {
            let leaves = hierarchy.triangles()[triangle as usize];
            let stays: [[u32; 2]; 3] =
                std::array::from_fn(|k| self.history.stay(input(leaves[k]), input(corners[k])));
            // Some level has the image where there are steps at which all corners are where they are drawn.
            let unseen = stays.iter().map(|stay| stay[0]).max() >= stays.iter().map(|stay| stay[1]).min();
            flips.unseen += usize::from(unseen);
            let (original, image) = (placed.corners(leaves), placed.corners(corners));
            let (Some(was), Some(is)) = (normal(original), normal(image)) else { continue };
            let flip = was.dot(is) < 0.0;
            flips.flipped += usize::from(flip);
            flips.new += usize::from(flip && unseen);
            let middle = (image[0] + image[1] + image[2]) / 3.0;
            if pose.sees(middle) && was.dot(pose.eye - original[0]) > 0.0 {
                flips.front += 1;
                flips.new_in_front += usize::from(flip && unseen);
            }
        }
        flips
    }

    /// Flips of the sequence's own level of at most so many triangles.
    fn level(&self, triangles: usize) -> Flips {
        let steps = self.sequence.steps_for_triangles(triangles);
        let (images, origins) = self.sequence.triangles_at(self.mesh, steps);
        let position = |v: u32| DVec3::from_array(self.mesh.positions()[v as usize].map(f64::from));
        let mut flips = Flips { drawn: images.len(), ..Flips::default() };
        for (image, origin) in images.iter().zip(origins) {
            let original = normal(self.mesh.triangles()[origin as usize].map(position));
            if let (Some(was), Some(is)) = (original, normal(image.map(position))) {
                flips.flipped += usize::from(was.dot(is) < 0.0);
            }
        }
        flips
    }
}

/// So many percent, and two more: a mesh of few triangles may have them.
fn at_most(count: usize, percent: f64) -> usize {
    (count as f64 * percent / 100.0) as usize + 2
}

/// Checks a mesh from all views with all dependencies. Returns flips of every policy, and of the sequence's own
/// levels of as many triangles as are drawn without dependencies.
fn check(name: &str, mesh: &Mesh) -> [Flips; 4] {
    let mut sums = [Flips::default(); 4];
    let sequence = Simplifier::new().run(mesh).unwrap();
    let model = Model::new(name, mesh, &sequence);
    let path = approach(DVec3::Y);
    for (policy, dependencies) in POLICIES.into_iter().enumerate() {
        let built = VertexHierarchy::build(mesh, &sequence, dependencies).unwrap();
        let options = HierarchyOptions::default().with_dependencies(dependencies);
        let baked = Baked::<VertexHierarchy>::of_sequence(mesh, &sequence, &options).unwrap();
        assert!(**baked.structure() == built.hierarchy && baked.origins().order() == built.vertex_order);
        let placed = Placed::new(baked.vertices());
        let mut lod = HierarchyLod::new(Arc::new(built.hierarchy.clone()));
        for frame in FRAMES {
            let pose = path[frame].about(mesh);
            lod.adapt(&[pose.view(VIEWPORT).unwrap().of_world()], 1.0 / 60.0);
            let flips = model.check(&built, &placed, &lod, &pose, &format!("{dependencies:?} frame {frame}"));
            sums[policy].add(flips);
            if policy == 0 {
                sums[3].add(model.level(flips.drawn));
            }
        }
    }
    let [none, adjacent, neighbours, level] = &sums;
    // In the very stars of the sequence no triangle can be drawn as the sequence never drew it.
    assert_eq!(neighbours.unseen, 0, "{name}: {neighbours:?}");
    // The next nearest leaves next to nothing; without dependencies some turn over, most of them where nobody looks.
    assert!(adjacent.new <= at_most(adjacent.drawn, 0.02), "{name}: {adjacent:?}");
    assert!(none.new <= at_most(none.drawn, 0.4), "{name}: {none:?}");
    assert!(none.new_in_front <= at_most(none.front, 0.2), "{name}: {none:?}");
    assert_eq!((level.new, neighbours.new), (0, 0));
    sums
}

/// All model files of the collection's parts, with their names.
fn files(root: &Path) -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> =
        ["real", "game", "subdivision"].iter().map(|part| root.join(part)).collect();
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
            if path.is_dir() {
                folders.push(path);
            } else if Format::from_path(&path).is_some() {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

#[test]
fn models_keep_their_surface_from_everywhere() {
    let Some(root) = crate::models::all("hierarchy/every_model") else { return };
    let mut sums = [Flips::default(); 4];
    for file in files(&root) {
        let name = file.file_name().unwrap().to_string_lossy();
        let mesh = io::read(&file).unwrap();
        for (sum, flips) in sums.iter_mut().zip(check(&name, &mesh)) {
            sum.add(flips);
        }
    }
    // Of all that all models draw from everywhere: hardly more flips with dependencies than the levels have themselves.
    let [none, adjacent, neighbours, levels] = &sums;
    let share = |n: usize, of: usize| 100.0 * n as f64 / of as f64;
    assert!(share(none.new_in_front, none.front) <= 0.1, "{none:?}");
    assert!(share(none.new, none.drawn) <= 0.2, "{none:?}");
    assert!(share(adjacent.new, adjacent.drawn) <= 0.005, "{adjacent:?}");
    let own = share(levels.flipped, levels.drawn);
    assert!(share(neighbours.flipped, neighbours.drawn) <= 1.2 * own, "{neighbours:?} {levels:?}");
}

#[test]
fn shapes_keep_their_surface_from_everywhere() {
    for (name, mesh) in [
        ("demo", shapes::demo()),
        ("rock", shapes::rock(20_000, 1)),
        ("terrain", shapes::terrain(64, 3)),
        ("book", shapes::book(5)),
        ("soup", shapes::soup(300, 2)),
        ("spheres", shapes::two_spheres_touching(3)),
        ("box", shapes::box_with_face_normals(12)),
        ("sphere", shapes::uv_sphere(48, 24)),
        ("cylinder", shapes::open_cylinder(40, 20)),
        ("moebius", shapes::moebius(60)),
    ] {
        check(name, &mesh);
    }
}

/// Splits done one after the other in any order that needs allow: each finds its vertices in the very stars that its
/// collapse left in the sequence.
fn replays_the_stars(mesh: &Mesh, seed: u64) {
    let sequence = Simplifier::new().run(mesh).unwrap();
    let built = VertexHierarchy::build(mesh, &sequence, Dependencies::Neighbours).unwrap();
    let hierarchy = Arc::new(numbered(built.hierarchy.clone()));
    let history = History::new(&sequence);
    let input = |v: u32| built.vertex_order[v as usize];
    let triangles = |lod: &HierarchyLod| -> BTreeSet<(u32, [u32; 3])> {
        let all = drawn(lod).into_iter();
        all.map(|(t, corners)| (built.triangle_order[t as usize], corners.map(input))).collect()
    };
    let mut lod = HierarchyLod::new(hierarchy.clone());
    let mut holds = Given::new(&hierarchy);
    let mut state = seed;
    for _ in 0..hierarchy.split_count() {
        let free: Vec<u32> = (0..hierarchy.split_count() as u32)
            .filter(|&s| !holds.get(s))
            .filter(|&s| hierarchy.parents(s).chain(hierarchy.dependencies(s)).all(|other| holds.get(other)))
            .collect();
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        // As deep as it gets first, so that levels are as mixed as can be; now and then another.
        let at = if state >> 62 == 0 { (state >> 33) as usize % free.len() } else { free.len() - 1 };
        holds.needed[free[at] as usize] = true;
        let before = triangles(&lod);
        assert_eq!(lod.adapt_by(&holds, Motion::Other, 0.0).cut.splits, 1);
        let after: BTreeSet<u32> = triangles(&lod).iter().flat_map(|(_, corners)| *corners).collect();
        let old: BTreeSet<u32> = before.iter().flat_map(|(_, corners)| *corners).collect();
        for &vertex in after.difference(&old) {
            let end = history.end(vertex);
            if end == NEVER {
                continue;
            }
            // The star of what took the vertex's place, now and right after that collapse.
            let to = history.substitute(vertex);
            let (images, origins) = sequence.triangles_at(mesh, end as usize);
            let then = origins.into_iter().zip(images).filter(|(_, corners)| corners.contains(&to));
            let now = before.iter().copied().filter(|(_, corners)| corners.contains(&to));
            assert_eq!(now.collect::<BTreeSet<_>>(), then.collect(), "split of {to} to {vertex}");
        }
    }
    assert_eq!(lod.surface().triangle_count(), hierarchy.triangle_count());
}

/// With numbers of splits, counted from the last, in place of parametric errors: larger in parents, as they must be.
fn numbered(hierarchy: VertexHierarchy) -> VertexHierarchy {
    let mut parts = HierarchyParts::from(hierarchy);
    parts.bounds.iter_mut().rev().enumerate().for_each(|(i, bounds)| bounds.parametric = i as f32);
    parts.try_into().unwrap()
}

/// Needs exactly the splits that are marked, of a hierarchy that is [`numbered`].
struct Given {
    needed: Vec<bool>,
}

impl Given {
    fn new(hierarchy: &VertexHierarchy) -> Self {
        Self { needed: vec![false; hierarchy.split_count()] }
    }

    fn get(&self, split: u32) -> bool {
        self.needed[split as usize]
    }
}

impl Criterion for Given {
    fn test(&self, bounds: &Bounds) -> Answer {
        Answer::once(self.needed[self.needed.len() - 1 - bounds.parametric as usize])
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }
}

#[test]
fn with_neighbours_every_split_finds_the_star_of_its_collapse() {
    for (seed, mesh) in [
        shapes::rock(600, 1),
        shapes::terrain(14, 3),
        shapes::icosphere(3),
        shapes::uv_sphere(20, 12),
        shapes::box_with_face_normals(6),
        shapes::open_cylinder(14, 10),
        shapes::book(5),
    ]
    .iter()
    .enumerate()
    {
        replays_the_stars(mesh, seed as u64 + 1);
    }
}
