//! What tests of views share: cameras from their definition, and balls with cones of normals and errors.

use multires::view::{Bounds, ErrorKind, Focus, View};
use proptest::prelude::*;

pub type V = [f64; 3];
pub type Matrix = [[f32; 4]; 4];

pub const FOV: f32 = 1.0;
pub const VIEWPORT: [u32; 2] = [640, 480];

pub fn add(a: V, b: V, times: f64) -> V {
    std::array::from_fn(|i| a[i] + times * b[i])
}

pub fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn length(a: V) -> f64 {
    dot(a, a).sqrt()
}

pub fn unit(a: V) -> V {
    let length = length(a);
    if length > 1e-9 { a.map(|x| x / length) } else { [0.0, 0.0, 1.0] }
}

/// Two unit vectors at right angles to one and to each other.
pub fn beside(a: V) -> [V; 2] {
    let other = if a[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let x = unit(cross(a, other));
    [x, cross(a, x)]
}

/// Turns `v` about a unit axis.
pub fn turned(v: V, axis: V, angle: f64) -> V {
    let (sine, cosine) = angle.sin_cos();
    let along = dot(v, axis);
    std::array::from_fn(|i| v[i] * cosine + cross(axis, v)[i] * sine + axis[i] * along * (1.0 - cosine))
}

/// Where a camera stands and how it is turned: right, up, backwards.
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    pub eye: V,
    pub axes: [V; 3],
}

impl Camera {
    pub fn matrix(&self) -> Matrix {
        let column = |i: usize| [self.axes[0][i] as f32, self.axes[1][i] as f32, self.axes[2][i] as f32, 0.0];
        let [x, y, z] = self.axes.map(|axis| -dot(axis, self.eye) as f32);
        [column(0), column(1), column(2), [x, y, z, 1.0]]
    }

    pub fn view(&self) -> View {
        View::perspective(self.matrix(), FOV, VIEWPORT).unwrap()
    }

    /// Unit normals of the sides of the picture, inward, and the direction ahead.
    pub fn normals(&self) -> [V; 5] {
        let [x, y, ahead] = [self.axes[0], self.axes[1], self.axes[2].map(|c| -c)];
        let high = (f64::from(FOV) * 0.5).tan();
        let wide = high * f64::from(VIEWPORT[0]) / f64::from(VIEWPORT[1]);
        let side = |axis: V, reach: f64| unit(add(ahead, axis, 1.0 / reach));
        [side(x, wide), side(x, -wide), side(y, high), side(y, -high), ahead]
    }

    /// Whether a point is in the pyramid of the picture, from the definition; by at least `margin` inside.
    pub fn sees(&self, point: V, margin: f64) -> bool {
        let to = add(point, self.eye, -1.0);
        let [x, y, z] = self.axes.map(|axis| dot(axis, to));
        let high = (f64::from(FOV) * 0.5).tan();
        let wide = high * f64::from(VIEWPORT[0]) / f64::from(VIEWPORT[1]);
        -z > margin && x.abs() + margin < -z * wide && y.abs() + margin < -z * high
    }
}

pub fn vector(size: f64) -> impl Strategy<Value = V> {
    prop::array::uniform3(-size..size)
}

pub fn camera() -> impl Strategy<Value = Camera> {
    (vector(4.0), vector(1.0), 0.0..6.3).prop_map(|(eye, back, roll)| {
        let back = unit(back);
        let [x, _] = beside(back);
        let x = turned(x, back, roll);
        Camera { eye, axes: [x, cross(back, x), back] }
    })
}

#[derive(Debug, Clone, Copy)]
pub struct Ball {
    pub centre: V,
    pub radius: f64,
    pub axis: V,
    pub angle: f64,
    pub error: f64,
}

impl Ball {
    pub fn bounds(&self) -> Bounds {
        let centre = self.centre.map(|x| x as f32);
        Bounds::new(centre, self.radius as f32, self.error as f32, 2.0 * self.error as f32)
            .with_cone(self.axis, self.angle)
    }

    /// A point of the sphere and a normal of the cone.
    pub fn sample(&self, way: V, depth: f64, around: f64, aside: f64) -> (V, V) {
        let [x, y] = beside(self.axis);
        let side: V = std::array::from_fn(|i| x[i] * around.cos() + y[i] * around.sin());
        (
            add(self.centre, unit(way), self.radius * depth),
            turned(self.axis, cross(self.axis, side), self.angle * aside),
        )
    }
}

pub fn ball() -> impl Strategy<Value = Ball> {
    (vector(3.0), -4.0..1.0, vector(1.0), 0.0..1.7, -6.0..0.0).prop_map(
        |(centre, radius, axis, angle, error)| Ball {
            centre: centre.map(|x| f64::from(x as f32)),
            radius: f64::from(10f64.powf(radius) as f32),
            axis: unit(axis),
            angle,
            error: f64::from(10f64.powf(error) as f32),
        },
    )
}

/// Tolerance, silhouette tolerance, frustum, back faces, parametric error, and the ball of focus.
pub type Settings = (f32, Option<f32>, bool, bool, bool, Option<(V, f64)>);

pub fn settings() -> impl Strategy<Value = Settings> {
    (
        0.1f32..10.0,
        prop::option::of(0.05f32..5.0),
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
        prop::option::of((vector(3.0), 0.0..2.0)),
    )
}

pub fn set(view: View, (tolerance, silhouette, frustum, backs, parametric, focus): Settings) -> View {
    let kind = if parametric { ErrorKind::Parametric } else { ErrorKind::Geometric };
    let focus =
        focus.map(|(centre, radius)| Focus { centre: centre.map(|x| x as f32), radius: radius as f32 });
    let view = view.with_tolerance_px(tolerance).with_frustum(frustum).with_back_faces_culled(backs);
    let view = view.with_error(kind).with_focus(focus);
    silhouette.map_or(view.clone(), |pixels| view.with_silhouette_px(pixels))
}
