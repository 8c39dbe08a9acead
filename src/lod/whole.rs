//! Structures drawn at a single resolution for all of the model: the error allowed by views, at the model's nearest point.

use crate::view::{Bounds, Criterion, Motion, ObjectView};

/// The error allowed in a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Allowed {
    /// No error: the model is in focus.
    Nothing,
    /// Errors up to this, object units.
    Error(f32),
    /// Any error: no view sees the model.
    Anything,
}

/// The bounding sphere of a model, as tested by views.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Whole {
    /// The sphere, with the diagonal as its error.
    bounds: Bounds,
    diagonal: f32,
}

impl Whole {
    /// Makes the sphere around the box of a model.
    pub fn new(extent: Option<[[f32; 3]; 2]>) -> Self {
        let [low, high] = extent.unwrap_or_default().map(glam::Vec3::from_array);
        // Halves first, so no box overflows.
        let (centre, radius) = (low * 0.5 + high * 0.5, (high * 0.5 - low * 0.5).length());
        let diagonal = (2.0 * radius).min(f32::MAX);
        Self { bounds: Bounds::new(centre.to_array(), radius, diagonal, diagonal), diagonal }
    }

    /// Returns the diagonal of the box, object units.
    pub fn diagonal(&self) -> f32 {
        self.diagonal
    }

    /// Returns the error allowed by all views together, with tolerances multiplied by a factor.
    pub fn allowed(&self, views: &[ObjectView], factor: f32) -> Allowed {
        // A model in focus is drawn at full resolution.
        let exact = Bounds { error: 0.0, parametric: 0.0, ..self.bounds };
        if views.test(&exact).refine {
            return Allowed::Nothing;
        }
        // The urgency is the factor by which tolerances must grow to allow an error of a whole diagonal. Hence the largest
        // allowed error is `diagonal * factor / urgency`.
        let urgency = views.urgency(&self.bounds);
        if urgency > 0.0 {
            Allowed::Error((f64::from(self.diagonal) * f64::from(factor) / urgency) as f32)
        } else {
            Allowed::Anything
        }
    }

    /// Whether some view may see the model.
    pub fn is_seen(&self, views: &[ObjectView]) -> bool {
        views.iter().any(|view| view.sees(&self.bounds))
    }

    /// Returns the motion of views since others; [`Motion::Other`] if there were none.
    pub fn motion(views: &[ObjectView], before: &[ObjectView]) -> Motion {
        match before.is_empty() {
            true => Motion::Other,
            false => Criterion::<Bounds>::motion(views, before),
        }
    }
}
