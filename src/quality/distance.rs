//! Distance between two surfaces: Metro's two one-sided distances.
//!
//! ```text
//!     a  ~~o~~~~~o~~~~o~~     sample a, find the nearest point of b for every sample: max, mean, rms
//!          |     |    |       and the other way round, which is not the same
//!     b  --x-----x----x--
//! ```
//!
//! Source: Cignoni, Rocchini and Scopigno, "Metro: measuring error on simplified surfaces", Computer Graphics Forum
//! 17(2), 1998. Mean and rms are over samples of equal area. The maximum is also over all corners of triangles and over
//! samples along all edges, where it is most often attained. Branch and bound refines it from there (`maximum.rs`).

use glam::DVec3;

use crate::geometry::bvh::Walker;
use crate::mesh::Mesh;

use super::{QualityError, maximum::largest, sums::Sums, surface::Surface};

/// Number and seed of the samples of [`distance`] and related measures.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DistanceOptions {
    /// Samples on the faces of each mesh, 1 to 2^32 - 1; default 500,000. A quarter as many are added along its edges.
    pub samples: usize,
    /// Seed of the jitter: another seed moves samples within the same shares of area; default 0.
    pub seed: u64,
}

impl Default for DistanceOptions {
    fn default() -> Self {
        Self { samples: 500_000, seed: 0 }
    }
}

impl DistanceOptions {
    /// Sets the number of samples on the faces of each mesh.
    #[must_use]
    pub fn with_samples(mut self, samples: usize) -> Self {
        self.samples = samples;
        self
    }

    /// Sets the seed of the samples' jitter.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }
}

/// Distance from a surface to another surface, object units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct OneSided {
    /// Largest distance found: a lower bound of the one-sided Hausdorff distance.
    pub max: f64,
    /// Proven upper bound of the one-sided Hausdorff distance. Within 0.1 % of `max`, or 1e-9 of the larger surface's
    /// size, unless reaching this precision takes more pieces of the surface than there are samples.
    pub max_bound: f64,
    /// Mean distance over the area.
    pub mean: f64,
    /// Root of the mean square distance over the area.
    pub rms: f64,
    /// Point of the sampled surface where the largest distance was found.
    pub max_at: [f64; 3],
    /// Point of the other surface nearest to `max_at`.
    pub max_to: [f64; 3],
    /// Samples on faces: mean and rms are taken over these.
    pub face_samples: usize,
    /// Corners and samples along edges: only the maximum uses these.
    pub edge_samples: usize,
}

/// Distance of two surfaces in both directions, object units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Distance {
    /// Distance from the first surface to the second.
    pub forward: OneSided,
    /// Distance from the second surface to the first.
    pub backward: OneSided,
    /// Diagonal of the first mesh's box ([`Mesh::diagonal`]); [`percent`](Self::percent) refers to it.
    pub diagonal: f64,
}

impl Distance {
    /// Returns the larger of both maxima: a lower bound of the Hausdorff distance.
    pub fn hausdorff(&self) -> f64 {
        self.forward.max.max(self.backward.max)
    }

    /// Returns a proven upper bound of the Hausdorff distance: no point of either surface is farther from the other.
    pub fn hausdorff_bound(&self) -> f64 {
        self.forward.max_bound.max(self.backward.max_bound)
    }

    /// Returns the mean of both directions' means.
    pub fn mean(&self) -> f64 {
        (self.forward.mean + self.backward.mean) * 0.5
    }

    /// Returns the root of the mean of both directions' mean squares.
    pub fn rms(&self) -> f64 {
        ((self.forward.rms.powi(2) + self.backward.rms.powi(2)) * 0.5).sqrt()
    }

    /// Converts a length to percent of the first mesh's diagonal.
    pub fn percent(&self, length: f64) -> f64 {
        100.0 * length / self.diagonal
    }

    /// Returns [`hausdorff`](Self::hausdorff) in percent of the first mesh's diagonal.
    pub fn hausdorff_percent(&self) -> f64 {
        self.percent(self.hausdorff())
    }

    /// Returns [`mean`](Self::mean) in percent of the first mesh's diagonal.
    pub fn mean_percent(&self) -> f64 {
        self.percent(self.mean())
    }

    /// Returns [`rms`](Self::rms) in percent of the first mesh's diagonal.
    pub fn rms_percent(&self) -> f64 {
        self.percent(self.rms())
    }
}

/// Measures the distance between the surfaces of two meshes, in both directions.
///
/// The surface consists of the triangles with an area. Coincident triangles count once. Vertices used only by other
/// triangles do not count. Nearest points are exact to double precision; only the query points are sampled. Equal
/// meshes and options give the same bytes for any number of threads. To measure many meshes against a single mesh,
/// prepare it once: [`Surface`].
///
/// O((n + samples) log n); some 200 bytes a triangle of working memory.
///
/// # Errors
/// A mesh has no surface; `samples` is not in 1 to 2^32 - 1.
///
/// ```
/// use multires::{mesh::Mesh, quality::{distance, DistanceOptions}};
/// let corners = |z: f32| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
/// let (low, high) = (Mesh::new(corners(0.0), [[0, 1, 2]])?, Mesh::new(corners(0.5), [[0, 1, 2]])?);
/// let apart = distance(&low, &high, &DistanceOptions::default().with_samples(1000))?;
/// assert_eq!((apart.hausdorff(), apart.mean()), (0.5, 0.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn distance(a: &Mesh, b: &Mesh, options: &DistanceOptions) -> Result<Distance, QualityError> {
    options.check()?;
    Surface::named(a, "first")?.distance(&Surface::named(b, "second")?, options)
}

/// Measures the distance of every vertex of a mesh from the surface of another mesh, object units. Colours for the
/// distances: [`palette::colours`](super::palette::colours). O((n + m) log m).
///
/// # Errors
/// The second mesh has no surface. The first mesh needs none.
///
/// ```
/// use multires::{mesh::shapes, quality::vertex_distances};
///
/// // The vertices of a coarse sphere are vertices of the finer one.
/// let distances = vertex_distances(&shapes::icosphere(2), &shapes::icosphere(3))?;
/// assert!(distances.iter().all(|distance| *distance < 1e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn vertex_distances(from: &Mesh, to: &Mesh) -> Result<Vec<f64>, QualityError> {
    Ok(Surface::named(to, "second")?.point_distances(from.positions()))
}

impl Surface<'_> {
    /// Measures the distance between this surface and another, in both directions: [`distance`] on prepared surfaces.
    ///
    /// # Errors
    /// `samples` is not in 1 to 2^32 - 1.
    pub fn distance(&self, other: &Surface<'_>, options: &DistanceOptions) -> Result<Distance, QualityError> {
        Ok(Distance {
            forward: self.distance_to(other, options)?,
            backward: other.distance_to(self, options)?,
            diagonal: self.diagonal(),
        })
    }

    /// Measures the distance from this surface to another: the forward direction of [`distance`].
    ///
    /// # Errors
    /// `samples` is not in 1 to 2^32 - 1.
    pub fn distance_to(
        &self,
        other: &Surface<'_>,
        options: &DistanceOptions,
    ) -> Result<OneSided, QualityError> {
        options.check()?;
        let start = || (other.bvh().walker(), Lengths::NONE);
        let joined = |sums: Vec<(Walker<'_>, Lengths)>| {
            sums.into_iter().map(|(_, sums)| sums).fold(Lengths::NONE, Lengths::join)
        };
        let faces = joined(self.on_faces(options, start, |(walker, sums), _, _, point| {
            add(sums, walker, point);
        }));
        let edges = joined(self.on_edges(options, start, |(walker, sums), point| {
            add(sums, walker, point);
        }));
        let corners = self.on_corners(
            || (other.bvh().walker(), Vec::new()),
            |(walker, found), vertex, point| {
                let nearest = walker.closest(point);
                found.push((vertex, nearest.distance_squared.sqrt(), (point, nearest.point)));
            },
        );
        let mut outline = Lengths::NONE;
        let mut at_vertex = vec![0.0; self.mesh().positions().len()];
        for (vertex, distance, at) in corners.into_iter().flat_map(|(_, found)| found) {
            outline.add(distance, at);
            at_vertex[vertex as usize] = distance;
        }
        let at_corners = |slot: u32| {
            let triangle = self.bvh().triangle_of()[slot as usize];
            self.mesh().triangles()[triangle as usize].map(|v| at_vertex[v as usize])
        };
        let found = faces.join(outline).join(edges).highest().unwrap_or_default();
        let ((max, (max_at, max_to)), max_bound) =
            largest(self.bvh(), other.bvh(), at_corners, found, options.samples);
        Ok(OneSided {
            max,
            max_bound,
            mean: faces.mean(options.samples),
            rms: faces.rms(options.samples),
            max_at: max_at.to_array(),
            max_to: max_to.to_array(),
            face_samples: options.samples,
            edge_samples: self.outline_samples(options),
        })
    }
}

/// Distances; for the largest, the sampled point and its nearest point.
type Lengths = Sums<(DVec3, DVec3)>;

fn add(sums: &mut Lengths, walker: &mut Walker<'_>, point: DVec3) {
    let nearest = walker.closest(point);
    sums.add(nearest.distance_squared.sqrt(), (point, nearest.point));
}
