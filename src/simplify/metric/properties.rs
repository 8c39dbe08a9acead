//! [`MetricProperties`]: what a metric declares about itself.

/// Facts about a metric, for the simplifier. They may change at [`MetricEvent::Begin`](super::MetricEvent::Begin) only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct MetricProperties<'a> {
    /// Name on the command line; default "custom".
    pub name: &'static str,
    /// Data that costs depend on besides the positions of the pair; default [`Dependence::Triangles`]. Limits how many
    /// costs are recomputed after a collapse.
    pub dependence: Dependence,
    /// Names of the mesh's attributes counted by the costs, so that a simplifier does not count them again; default
    /// `None`, no attributes. Vertices created by collapses get values of these attributes fitted to the surface. Values
    /// of all other attributes are blended.
    pub attributes: Option<&'a [String]>,
}

impl Default for MetricProperties<'_> {
    fn default() -> Self {
        Self::named("custom")
    }
}

impl<'a> MetricProperties<'a> {
    /// Returns the default properties under a name.
    pub const fn named(name: &'static str) -> Self {
        Self { name, dependence: Dependence::Triangles, attributes: None }
    }

    /// Sets the data that costs depend on.
    #[must_use]
    pub const fn with_dependence(mut self, dependence: Dependence) -> Self {
        self.dependence = dependence;
        self
    }

    /// Sets the names of the attributes counted.
    #[must_use]
    pub const fn with_attributes(mut self, names: &'a [String]) -> Self {
        self.attributes = Some(names);
        self
    }
}

/// The data that the cost of a pair depends on, besides the positions of its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dependence {
    /// Data accumulated at the lost point; data of the kept point only if the merged point is placed elsewhere. Costs of
    /// pairs must not fall when their points absorb other points.
    Lost,
    /// Data accumulated at both points.
    Both,
    /// The current triangles around both points: every collapse makes the costs around it stale.
    Triangles,
}
