//! Many instances at a time, over all cores.

use crate::adapt::Change;
use crate::geometry::parallel;
use crate::view::ObjectView;

use super::Lod;

/// Instances that a core takes at least.
const LEAST: usize = 16;

/// Adapts many instances, each to its own views ([`Lod::adapt`]): on all cores with feature `parallel`. Returns the changes in the
/// order of the instances. Every instance is adapted as if alone, so the result is the same for any number of threads.
///
/// Takes any instances: of a slice, of a map, of a query of an engine. Of different structures as `&mut dyn Lod`. Allocates a list
/// of those not at rest, and the list of changes.
///
/// ```
/// use multires::lod::adapt_all;
/// use multires::view::{View, look_at};
/// use multires::{LodOptions, Structure, VertexHierarchy, mesh::shapes};
///
/// let mesh = shapes::rock(2_000, 1);
/// let model = VertexHierarchy::bake(&mesh)?;
/// let values = model.arrange(mesh.positions())?;
/// let mut lods = (0..50)
///     .map(|_| model.instance(values.clone(), &LodOptions::default()))
///     .collect::<Result<Vec<_>, _>>()?;
/// let view = View::perspective(look_at([0.0, 2.0, 9.0], [0.0; 3], [0.0, 1.0, 0.0]), 1.0, [1920, 1080])?;
/// let views = (0..50)
///     .map(|at| {
///         let place = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, -3.0 * at as f32, 1.0]];
///         Ok([view.of_object(place)?])
///     })
///     .collect::<Result<Vec<_>, multires::view::ViewError>>()?;
/// let changes = adapt_all(lods.iter_mut().zip(&views).map(|(lod, views)| (lod, &views[..])), 1.0 / 60.0);
/// assert!(changes[0].triangles > 2 * changes[49].triangles);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn adapt_all<'a, L: Lod + ?Sized + 'a>(
    instances: impl IntoIterator<Item = (&'a mut L, &'a [ObjectView])>,
    seconds: f32,
) -> Vec<Change> {
    let (mut changes, mut awake) = (Vec::new(), Vec::new());
    for (lod, views) in instances {
        // Instances at rest are not worth another core's while.
        let change = lod.adapt_at_rest(views);
        if change.is_none() {
            awake.push((changes.len(), lod, views));
        }
        changes.push(change.unwrap_or_default());
    }
    let made = parallel::map_mut(&mut awake, LEAST, |(_, lod, views)| lod.adapt(views, seconds));
    awake.iter().zip(made).for_each(|((at, ..), change)| changes[*at] = change);
    changes
}
