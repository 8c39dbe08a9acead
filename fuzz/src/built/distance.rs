//! Distance of a point from a triangle, which may be a line or a point.

type Vector = [f64; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The distance: from the plane where the point lies over the triangle, else from the nearest side.
pub fn distance(point: [f32; 3], corners: [[f32; 3]; 3]) -> f64 {
    let point = point.map(f64::from);
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let normal = cross(minus(b, a), minus(c, a));
    let square = dot(normal, normal);
    let sides = [(a, b), (b, c), (c, a)];
    let is_over =
        sides.iter().all(|&(from, to)| dot(cross(minus(to, from), minus(point, from)), normal) >= 0.0);
    if square > 0.0 && is_over {
        return dot(minus(point, a), normal).abs() / square.sqrt();
    }
    let from_side = |(from, to): (Vector, Vector)| {
        let (along, at) = (minus(to, from), minus(point, from));
        let length = dot(along, along);
        let share = if length > 0.0 { (dot(at, along) / length).clamp(0.0, 1.0) } else { 0.0 };
        let off: Vector = std::array::from_fn(|i| at[i] - share * along[i]);
        dot(off, off).sqrt()
    };
    sides.map(from_side).into_iter().fold(f64::INFINITY, f64::min)
}
