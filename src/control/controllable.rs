//! An object whose triangles depend on a bias.

/// Direction of a change of the bias.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Toward {
    /// Bias rises, triangles fall.
    Coarse,
    /// Bias falls, triangles rise.
    Fine,
}

/// A change of an object's number of triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// First bias, on the way, at which the object has the new number of triangles.
    pub bias: f64,
    /// Triangles saved (toward coarse) or added (toward fine) by this change: `P_prev` or `P_next` of Southern.
    pub triangles: usize,
}

/// An object whose number of triangles falls with a bias, in steps: what [`Bias`](super::Bias) needs of an object. For objects
/// with levels by parameter, [`StairObject`](super::StairObject) is one. Implement it for your own mesh type.
///
/// ```
/// use multires::control::{Bias, BiasOptions, Controllable, Crossing, Toward};
///
/// /// A sprite: 2 triangles from a bias of 0.5 on, before 100.
/// struct Tree;
///
/// impl Controllable for Tree {
///     fn triangles(&self, bias: f64) -> usize {
///         if bias < 0.5 { 100 } else { 2 }
///     }
///
///     fn next(&self, bias: f64, toward: Toward) -> Option<Crossing> {
///         match toward {
///             Toward::Coarse => (bias < 0.5).then_some(Crossing { bias: 0.5, triangles: 98 }),
///             Toward::Fine => (bias >= 0.5).then_some(Crossing { bias: 0.5_f64.next_down(), triangles: 98 }),
///         }
///     }
/// }
///
/// let options = BiasOptions::default().with_triangles(10).with_tolerance(10).with_change(None);
/// let mut bias = Bias::new(options)?;
/// assert_eq!(bias.update(&[Tree, Tree], false).triangles, 4);
/// assert_eq!(bias.bias(), 0.5);
/// # Ok::<(), multires::Error>(())
/// ```
pub trait Controllable {
    /// Returns the triangles drawn at a bias; 0 if the object is not drawn. Falls, or stays, as the bias rises.
    fn triangles(&self, bias: f64) -> usize;

    /// Returns the first change of the number of triangles beyond `bias`; `None` if there is no further change. The returned
    /// bias must lie beyond `bias` in the direction asked for: any other is taken for `None`.
    fn next(&self, bias: f64, toward: Toward) -> Option<Crossing>;
}

impl<C: Controllable + ?Sized> Controllable for &C {
    fn triangles(&self, bias: f64) -> usize {
        (**self).triangles(bias)
    }

    fn next(&self, bias: f64, toward: Toward) -> Option<Crossing> {
        (**self).next(bias, toward)
    }
}

impl<C: Controllable + ?Sized> Controllable for Box<C> {
    fn triangles(&self, bias: f64) -> usize {
        (**self).triangles(bias)
    }

    fn next(&self, bias: f64, toward: Toward) -> Option<Crossing> {
        (**self).next(bias, toward)
    }
}
