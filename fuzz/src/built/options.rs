//! Any options.

use multires::adapt::Geomorph;
use multires::lod::{LodOptions, Triangulation, VertexBuffer};
use multires::mesh::{Mesh, Tolerances};
use multires::simplify::metric::{ErrorMetric, NAMES, by_name};
use multires::simplify::{
    AttributeWeights, ErrorMeasure, Guard, Independence, Normals, Order, Parts, Permissive, Placement,
    Simplifier, Target,
};
use multires::view::{ErrorKind, Focus, ObjectView, View, look_at};

use super::choices::Choices;

/// A simplifier, and what is promised of its levels.
pub struct AnySimplifier {
    /// It.
    pub simplifier: Simplifier<Box<dyn ErrorMetric>>,
    /// Whether every vertex is one of the input.
    pub keeps_vertices: bool,
    /// Whether closed surfaces of one fan a point stay so, with their handles.
    pub keeps_topology: bool,
    /// Whether no point is left without triangles, so that corners of the input are as near to a level as told.
    pub is_honest: bool,
}

/// Any simplifier for a mesh. `all_levels`: down to the base mesh.
pub fn any_simplifier(choices: &mut Choices<'_>, mesh: &Mesh, all_levels: bool) -> AnySimplifier {
    // The defaults most often.
    let name = if choices.once_in(2) { choices.one(&NAMES) } else { NAMES[0] };
    let metric = by_name(name).expect("a metric of the list");
    let placement =
        choices.one(&[Placement::Endpoint, Placement::Optimal, Placement::Midpoint, Placement::Subset]);
    let order = choices.one(&[Order::Linear, Order::Linear, Order::Batched]);
    let permissive = choices.one(&[Permissive::Auto, Permissive::Off, Permissive::On]);
    let parts = choices.one(&[Parts::Vanish, Parts::Keep]);
    let measure = choices.one(&[ErrorMeasure::Measured, ErrorMeasure::Parametric, ErrorMeasure::Verified]);
    let join = if choices.once_in(4) { choices.between(0.0, 1.0) } else { 0.0 };
    let mut simplifier = Simplifier::new()
        .metric(metric)
        .placement(placement)
        .order(order)
        .independence(choices.one(&[Independence::Ring, Independence::Domain, Independence::Matching]))
        .permissive(permissive)
        .parts(parts)
        .error_measure(measure)
        .join_distance(join)
        .guard(choices.one(&[Guard::On, Guard::Off]))
        .attributes(choices.one(&[0, 0, 0, 1, 2]).into_weights(mesh))
        .normals(choices.one(&[
            Normals::Automatic,
            Normals::Automatic,
            Normals::Keep,
            Normals::Recompute { crease_angle: None },
            Normals::Recompute { crease_angle: Some(40.0) },
            Normals::Drop,
        ]))
        .tolerances(match choices.below(4) {
            3 => Tolerances::exact(),
            2 => Tolerances::default().with_normal(20.0).with_uv(8.0).with_position(64.0),
            _ => Tolerances::default(),
        });
    let rules = !choices.once_in(8);
    if !rules {
        simplifier = simplifier.oracles(Vec::new());
    }
    let count = mesh.triangles().len();
    let targets = if all_levels { 0 } else { choices.below(3) };
    for _ in 0..targets {
        simplifier = simplifier.target(match choices.below(5) {
            0 => Target::Triangles(choices.below(count + 1)),
            1 => Target::Ratio(f64::from(choices.between(0.0, 1.0))),
            2 => Target::Vertices(choices.below(mesh.positions().len() + 1)),
            3 => Target::Error(choices.between(0.0, 0.5)),
            _ => Target::Bytes { bytes: choices.below(20_000), per_vertex: choices.below(64) },
        });
    }
    AnySimplifier {
        simplifier,
        keeps_vertices: placement.keeps_vertices(),
        keeps_topology: rules
            && join == 0.0
            && parts == Parts::Keep
            && permissive != Permissive::On
            && targets == 0,
        is_honest: rules,
    }
}

/// The attributes that count, by a number.
trait IntoWeights {
    fn into_weights(self, mesh: &Mesh) -> AttributeWeights;
}

impl IntoWeights for i32 {
    fn into_weights(self, mesh: &Mesh) -> AttributeWeights {
        match self {
            1 => AttributeWeights::Off,
            2 => {
                let floats = mesh.attributes().iter().filter(|a| a.as_floats().is_some());
                AttributeWeights::Chosen(floats.map(|a| (a.name().to_owned(), 0.3)).collect())
            }
            _ => AttributeWeights::Customary,
        }
    }
}

/// Any options of an instance.
pub fn lod_options(choices: &mut Choices<'_>) -> LodOptions {
    let geomorph = choices.perhaps_between(-0.1, 0.4).map(|seconds| {
        let travel = choices.one(&[0.5, 0.0, f32::INFINITY, f32::NAN]);
        Geomorph::default().with_duration(seconds).with_travel(travel)
    });
    let triangles = choices.once_in(3).then(|| choices.below(600));
    let operations = choices.once_in(3).then(|| choices.below(80));
    LodOptions::default()
        .with_buffer(choices.one(&[VertexBuffer::Packed, VertexBuffer::Whole, VertexBuffer::Shared]))
        .with_geomorph(geomorph)
        .with_triangles(triangles)
        .with_operations(operations)
        .with_triangulation(choices.one(&[Triangulation::Exact, Triangulation::Minimal]))
}

/// Any view of a mesh from somewhere around it, or from within.
pub fn view(choices: &mut Choices<'_>, mesh: &Mesh) -> Option<ObjectView> {
    let [low, high] = mesh.bounds().unwrap_or_default();
    let diagonal = mesh.diagonal() as f32;
    let mut place = |reach: f32| -> [f32; 3] {
        std::array::from_fn(|i| low[i] * 0.5 + high[i] * 0.5 + diagonal * choices.between(-reach, reach))
    };
    let [eye, target] = [place(2.0), place(0.3)];
    let up = choices.one(&[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]]);
    let size = [1 + choices.below(2000) as u32, 1 + choices.below(2000) as u32];
    let mut view = View::perspective(look_at(eye, target, up), choices.between(0.05, 3.0), size).ok()?;
    view = view.with_tolerance_px(match choices.below(8) {
        0 => choices.float(),
        1 => 0.0,
        2 => f32::NAN,
        3 => f32::INFINITY,
        _ => choices.between(0.2, 30.0),
    });
    if choices.once_in(3) {
        view = view.with_silhouette_px(choices.between(0.1, 3.0));
    }
    if choices.once_in(4) {
        view = view.with_error(ErrorKind::Parametric);
    }
    view = view.with_frustum(!choices.once_in(4)).with_back_faces_culled(!choices.once_in(4));
    if choices.once_in(6) {
        view = view.with_focus(Some(Focus { centre: target, radius: choices.between(0.0, 1.0) * diagonal }));
    }
    if choices.once_in(6) {
        let mut matrix: [[f32; 4]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| choices.float()));
        for (i, column) in matrix.iter_mut().enumerate() {
            column[3] = f32::from(u8::from(i == 3));
        }
        return view.of_object(matrix).ok();
    }
    Some(view.of_world())
}
