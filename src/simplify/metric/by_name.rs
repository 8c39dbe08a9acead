//! Metrics by their names on the command line.

use super::{
    EdgeLength, ErrorMetric, Hybrid, LindstromTurk, MemorylessQuadric, ProgressiveMeshMetric, Quadric,
    UnsignedVolume, VolumeArea,
};

/// All names known to [`by_name`].
pub const NAMES: [&str; 8] = [
    "quadric",
    "memoryless-quadric",
    "lindstrom-turk",
    "volume-area",
    "unsigned-volume",
    "hybrid",
    "progressive-mesh",
    "edge-length",
];

/// Returns the metric named `name`
/// ([`MetricProperties::name`](super::MetricProperties::name)) with its defaults; `None` if `name` is not among [`NAMES`].
///
/// ```
/// use multires::simplify::metric::{NAMES, by_name};
///
/// assert!(NAMES.into_iter().all(|name| by_name(name).is_some_and(|metric| metric.properties().name == name)));
/// assert!(by_name("no such metric").is_none());
/// ```
pub fn by_name(name: &str) -> Option<Box<dyn ErrorMetric>> {
    Some(match name {
        "quadric" => Box::new(Quadric::new()),
        "memoryless-quadric" => Box::new(MemorylessQuadric::new()),
        "lindstrom-turk" => Box::new(LindstromTurk::new()),
        "volume-area" => Box::new(VolumeArea::new()),
        "unsigned-volume" => Box::new(UnsignedVolume::new()),
        "hybrid" => Box::new(Hybrid::new()),
        "progressive-mesh" => Box::new(ProgressiveMeshMetric::new()),
        "edge-length" => Box::new(EdgeLength::new()),
        _ => return None,
    })
}
