//! Whatever bytes choose, built, and held to what is promised of it.
//!
//! | file | contents |
//! |---|---|
//! | `choices.rs` | choices by bytes |
//! | `mesh.rs`, `options.rs` | any mesh, any options, any view |
//! | `distance.rs`, `edges.rs` | how far a point is from a triangle, whether a surface is closed |
//! | `flight.rs` | an instance through any frames |

use std::fmt::Debug;

use multires::gmesh::{Gmesh, GmeshOptions};
use multires::hierarchy::{Dependencies, HierarchyOptions};
use multires::io::Stored;
use multires::lod::{Baked, Level, Structure};
use multires::mesh::Mesh;
use multires::remesh::{Depth, Fitting, Remesher, Smoothing};
use multires::tom::TomOptions;
use multires::view::ErrorShape;
use multires::wavelet::{
    Atlas, AtlasOptions, DetailFrame, DomainPoint, ErrorBound, Midpoint, WaveletBuilder, WaveletMesh,
    WaveletOptions,
};
use multires::{ProgressiveMesh, TotallyOrderedMesh, VertexHierarchy};

mod choices;
mod distance;
mod edges;
mod flight;
#[path = "../../../examples/support/gpu.rs"]
#[allow(missing_docs)]
mod gpu;
mod mesh;
mod options;

use choices::Choices;
use distance::distance;
use edges::Edges;
use flight::{Promise, fly};
use mesh::{AnyMesh, any_mesh};
use options::{AnySimplifier, any_simplifier};

/// Simplifies a mesh and looks at levels: triangles as many as told, closed where the input is, no farther from the input than told.
pub fn simplified(data: &[u8]) -> bool {
    let mut choices = Choices::new(data);
    let AnyMesh { mesh, is_moderate, .. } = any_mesh(&mut choices);
    let AnySimplifier { mut simplifier, is_honest, .. } = any_simplifier(&mut choices, &mesh, false);
    let Ok(sequence) = simplifier.run(&mesh) else { return false };
    assert_eq!(sequence.validate(), Ok(()));
    let is_closed = Edges::of_mesh(&mesh).are_even();
    for steps in [sequence.len(), choices.below(sequence.len() + 1), choices.below(sequence.len() + 1)] {
        let level = sequence.extract(&mesh, steps);
        // The input comes as it is, with triangles that are degenerate.
        if steps > 0 {
            assert_eq!(level.triangles().len(), sequence.triangles_after(steps));
        }
        assert!(!is_closed || Edges::of_mesh(&level).are_even(), "a closed mesh has opened");
        let fitted = sequence.extract_fitted(&mesh, steps);
        assert_eq!(fitted.triangles(), level.triangles());
        sequence.attribute_deviations(&mesh, steps, &fitted);
        if is_moderate && is_honest {
            assert_within(&mesh, &level, sequence.error_after(steps));
        }
    }
    assert_eq!(sequence.triangles_after(sequence.len()), sequence.report().triangles);
    !sequence.is_empty()
}

/// Every corner of a mesh lies within a distance of a level.
fn assert_within(mesh: &Mesh, level: &Mesh, error: f32) {
    let corners = |of: &Mesh| -> Vec<[[f32; 3]; 3]> {
        let places = of.triangles().iter().map(|t| t.map(|v| of.positions()[v as usize]));
        // Triangles with two corners at one place are no part of the surface.
        places.filter(|[a, b, c]| a != b && b != c && c != a).collect()
    };
    let level = corners(level);
    if level.is_empty() {
        return;
    }
    let distance =
        |point| level.iter().map(|&corners| distance(point, corners)).fold(f64::INFINITY, f64::min);
    let points: Vec<[f32; 3]> = corners(mesh).into_iter().flatten().collect();
    // A few of many, so that it does not take longer than all else.
    let apart = 1 + points.len() * level.len() / 100_000;
    let farthest = points.into_iter().step_by(apart).map(distance).fold(0.0, f64::max);
    let rounding = 1e-5 * mesh.positions().as_flattened().iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    assert!(farthest <= f64::from(error) * 1.0001 + f64::from(rounding), "{farthest} beyond {error}");
}

fn comes_back<S: Stored + PartialEq + Debug>(model: &Baked<S>) {
    let bytes = model.to_bytes().expect("bytes");
    let back = Baked::<S>::from_bytes(&bytes);
    let back = back.unwrap_or_else(|error| panic!("{}: {error}", S::KIND));
    assert!(back == *model, "{} comes back", S::KIND);
}

/// Any level of a model.
fn levels<S: Structure>(choices: &mut Choices<'_>, model: &Baked<S>, is_closed: bool) {
    for _ in 0..3 {
        let count = model.structure().triangle_count();
        let level = match choices.below(3) {
            0 => Level::Triangles(choices.below(count + 2)),
            1 => Level::Error(choices.float()),
            _ => Level::Vertices(choices.below(model.structure().vertex_count() + 2)),
        };
        let mesh = model.level(level).mesh;
        assert!(!is_closed || Edges::of_mesh(&mesh).are_even(), "{}: {level:?} has opened", S::KIND);
    }
}

/// Builds a structure from a simplification down to the base mesh, and flies an instance of what its bytes give.
pub fn structures(data: &[u8]) -> bool {
    let mut choices = Choices::new(data);
    let AnyMesh { mesh, .. } = any_mesh(&mut choices);
    let any = any_simplifier(&mut choices, &mesh, true);
    let AnySimplifier { mut simplifier, keeps_vertices, keeps_topology, .. } = any;
    let Ok(sequence) = simplifier.run(&mesh) else { return false };
    let edges = Edges::of_mesh(&mesh);
    let closed = Promise { is_closed: edges.are_even(), is_exact: true, euler: None };
    match choices.below(4) {
        0 => {
            let built = Baked::<TotallyOrderedMesh>::of_sequence(&mesh, &sequence, &TomOptions::default());
            // Its vertices are those of the input.
            assert!(built.is_ok() || !sequence.new_vertices().is_empty());
            let Ok(model) = built else { return false };
            assert_eq!(model.structure().validate(), Ok(()));
            comes_back(&model);
            levels(&mut choices, &model, closed.is_closed);
            fly(&mut choices, &mesh, &model, closed)
        }
        1 => {
            let options = GmeshOptions::default().with_share(choices.between(0.01, 0.9));
            let Ok(model) = Baked::<Gmesh>::of_sequence(&mesh, &sequence, &options) else { return false };
            comes_back(&model);
            levels(&mut choices, &model, closed.is_closed);
            fly(&mut choices, &mesh, &model, closed)
        }
        2 => {
            let Ok(mut model) = ProgressiveMesh::new(&mesh, &sequence) else { return false };
            assert_eq!(model.validate(), Ok(()));
            for _ in 0..6 {
                let steps = choices.below(model.len() + 2);
                model.seek(steps);
                // The input comes as it is, with triangles that are degenerate.
                if model.steps() > 0 {
                    assert_eq!(model.triangles().len(), sequence.triangles_after(model.steps()));
                }
                let drawn = model.triangles().iter().map(|t| t.map(|v| model.positions()[v as usize]));
                assert!(!closed.is_closed || Edges::of(drawn).are_even(), "a closed mesh has opened");
            }
            assert_eq!(model.validate(), Ok(()));
            !model.is_empty()
        }
        _ => {
            let dependencies = choices.one(&[
                Dependencies::None,
                Dependencies::Manifold,
                Dependencies::Adjacent,
                Dependencies::Neighbours,
            ]);
            let options = HierarchyOptions::default().with_dependencies(dependencies);
            let model: Baked<VertexHierarchy> =
                Baked::of_sequence(&mesh, &sequence, &options).expect("a sequence of the mesh");
            assert_eq!(model.structure().validate(), Ok(()));
            comes_back(&model);
            levels(&mut choices, &model, closed.is_closed);
            let stays = keeps_vertices && keeps_topology && dependencies != Dependencies::None;
            let euler = (stays && edges.are_two()).then(|| edges.euler());
            fly(&mut choices, &mesh, &model, Promise { euler, ..closed })
        }
    }
}

/// Subdivides a mesh anyhow and flies an instance of what its bytes give; edits and an atlas keep it sound.
pub fn wavelets(data: &[u8]) -> bool {
    let mut choices = Choices::new(data);
    let AnyMesh { mesh: base, is_moderate } = any_mesh(&mut choices);
    let is_closed = Edges::of_mesh(&base).are_even();
    // A face with two corners at one place shares no edge: what it is split into has a border.
    let place = |v: u32| base.positions()[v as usize].map(|x| x + 0.0);
    let is_closed = is_closed
        && base.triangles().iter().map(|t| t.map(place)).all(|[a, b, c]| a != b && b != c && c != a);
    let Ok(mut builder) = WaveletBuilder::new(&base) else { return false };
    let share = choices.below(101);
    let wild = choices.once_in(4);
    for level in 0..1 + choices.below(3) {
        let most = if level == 0 { 1_000 } else { 300 };
        let mut left = most;
        let mut places = Choices::new(&data[data.len() / 2..]);
        let mut which = Choices::new(&data[data.len() / 3..]);
        let split = builder.subdivide_where(
            |_| {
                left -= usize::from(left > 0);
                left > 0 && which.below(101) <= share
            },
            |midpoint: &Midpoint| {
                let mut place = midpoint.middle;
                if wild && places.once_in(8) {
                    place[places.below(3)] = places.float();
                } else {
                    let reach: f32 = (0..3)
                        .map(|i| (midpoint.positions[0][i] - midpoint.positions[1][i]).abs())
                        .fold(0.0, f32::max);
                    for at in &mut place {
                        *at = (*at + reach.min(1e30) * places.between(-0.2, 0.2)).clamp(-f32::MAX, f32::MAX);
                    }
                }
                place
            },
        );
        if split.is_err() {
            return false;
        }
    }
    let options = WaveletOptions::default()
        .with_bound(choices.one(&[ErrorBound::Conservative, ErrorBound::WithoutSiblings]))
        .with_shape(choices.one(&[ErrorShape::Spheroid, ErrorShape::SphereAndCones]));
    let Ok(model) = builder.bake_with(&options, |_| std::ops::ControlFlow::Continue(())) else {
        return false;
    };
    assert_eq!(model.structure().validate(), Ok(()));
    comes_back(&model);
    levels(&mut choices, &model, is_closed);
    let mut mesh = WaveletMesh::clone(model.structure());
    for _ in 0..choices.below(3) {
        let vertices = mesh.vertices().positions().len();
        let level = choices.below(4);
        let moves: Vec<(u32, [f32; 3])> = (0..choices.below(4))
            .map(|_| {
                let to = if is_moderate { choices.between(-2.0, 2.0) } else { choices.float() };
                (choices.below(vertices + 1) as u32, [to, choices.between(-1.0, 1.0), 0.5])
            })
            .collect();
        let frame = choices.one(&[DetailFrame::Global, DetailFrame::Local]);
        let before = mesh.clone();
        let Ok(edited) = mesh.edit(level, &moves, frame) else {
            assert!(mesh == before, "a refused edit changes nothing");
            continue;
        };
        assert_eq!(mesh.validate(), Ok(()), "after an edit");
        if choices.once_in(2) {
            mesh.undo(&edited).expect("an edit of this mesh");
            assert!(mesh == before, "an undone edit leaves nothing");
        }
    }
    if choices.once_in(3) {
        let options = AtlasOptions::default().with_resolution(64 << choices.below(4)).with_gutter(1);
        if let Ok(worn) = Atlas::new(&mesh, &options).and_then(|atlas| mesh.with_atlas(&atlas)) {
            assert_eq!(worn.validate(), Ok(()), "with an atlas");
            let bytes = multires::io::bake(WaveletMesh::KIND, &worn).expect("bytes");
            assert!(
                multires::io::unbake::<WaveletMesh>(WaveletMesh::KIND, &bytes).expect("its bytes") == worn
            );
        }
    }
    // Halves of the smallest numbers are rounded.
    let is_small = |x: &f32| *x != 0.0 && x.abs() < 1e-30;
    let is_exact = !model.vertices().positions().as_flattened().iter().any(is_small);
    fly(&mut choices, &base, &model, Promise { is_closed, is_exact, euler: None })
}

/// Remeshes a mesh, and takes points there and back.
pub fn remeshed(data: &[u8]) -> bool {
    let mut choices = Choices::new(data);
    let AnyMesh { mesh, is_moderate, .. } = any_mesh(&mut choices);
    let run = Remesher::new()
        .base_faces(choices.below(200))
        .smoothing(choices.one(&[Smoothing::Harmonic, Smoothing::Off]))
        .fitting(choices.one(&[Fitting::LeastSquares, Fitting::Off]))
        .run(&mesh);
    let Ok(map) = run else { return false };
    for face in (0..map.base().triangles().len() as u32).take(50) {
        let [a, b] = [choices.between(0.0, 0.5), choices.between(0.0, 0.5)].map(f64::from);
        let at = DomainPoint::new(face, [a, b, 1.0 - a - b]);
        let point = map.to_mesh(&at).expect("a point of the base");
        assert!((point.triangle as usize) < mesh.triangles().len());
        map.to_base(&point).expect("a point of the mesh");
    }
    // None of 0, for which curves of the mesh are followed by the finest cells that there are.
    let error = choices.between(0.01, 0.3) * mesh.diagonal() as f32;
    let depth = match choices.below(3) {
        0 if error > 1e-30 => Depth::Error(error),
        _ => Depth::Levels(choices.below(3)),
    };
    let Ok(model) = map.bake(&mesh, depth, &WaveletOptions::default()) else { return false };
    assert_eq!(model.structure().validate(), Ok(()));
    comes_back(&model);
    let finest = model.level(Level::Ratio(1.0)).mesh;
    assert!(!is_moderate || !Edges::of_mesh(&mesh).are_even() || Edges::of_mesh(&finest).are_even());
    true
}
