//! How far two surfaces are apart: Metro's two one-sided distances.
//!
//! ```text
//!     a  ~~o~~~~~o~~~~o~~     sample a, find the nearest point of b for every sample: max, mean, rms
//!          |     |    |       and the other way round, which is not the same
//!     b  --x-----x----x--
//! ```
//!
//! Source: Cignoni, Rocchini and Scopigno, "Metro: measuring error on simplified surfaces", Computer Graphics Forum
//! 17(2), 1998. Mean and rms are over samples of equal area; the maximum is also over all corners of triangles and
//! over samples along all edges, where it is most often attained, and from there it is closed in on (`maximum.rs`).

use glam::DVec3;

use crate::mesh::Mesh;

use super::{QualityError, bvh::Walker, maximum::largest, sums::Sums, surface::Surface};

/// What to sample a [`distance`] and its kin with.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DistanceOptions {
    /// Samples on the faces of each mesh, 1 to 2^32 - 1; default 500,000. A quarter as many again go along its edges.
    pub samples: usize,
    /// Which samples: another seed jitters them differently within the same shares of area; default 0.
    pub seed: u64,
}

impl Default for DistanceOptions {
    fn default() -> Self {
        Self { samples: 500_000, seed: 0 }
    }
}

impl DistanceOptions {
    /// With this many samples on the faces of each mesh.
    #[must_use]
    pub fn with_samples(mut self, samples: usize) -> Self {
        self.samples = samples;
        self
    }

    /// With other samples.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }
}

/// Distance from one surface to another, object units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct OneSided {
    /// Largest distance found: the one-sided Hausdorff distance, from below.
    pub max: f64,
    /// A proven bound for it, from above. Within 0.1 % of `max`, or 1e-9 of the larger surface's size, unless more pieces of
    /// the surface than there are samples would have to be looked at for that.
    pub max_bound: f64,
    /// Mean distance over the area.
    pub mean: f64,
    /// Root of the mean square distance over the area.
    pub rms: f64,
    /// Where on the sampled surface the largest distance is.
    pub max_at: [f64; 3],
    /// The point of the other surface nearest to `max_at`.
    pub max_to: [f64; 3],
    /// Samples on faces, which mean and rms are taken over.
    pub face_samples: usize,
    /// Corners and samples along edges, which only the maximum heeds.
    pub edge_samples: usize,
}

/// Distance of two surfaces in both directions, object units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Distance {
    /// From the first to the second.
    pub forward: OneSided,
    /// From the second to the first.
    pub backward: OneSided,
    /// Diagonal of the first mesh's box ([`Mesh::diagonal`]), which [`percent`](Self::percent) refers to.
    pub diagonal: f64,
}

impl Distance {
    /// The Hausdorff distance: the larger of both maxima, from below.
    pub fn hausdorff(&self) -> f64 {
        self.forward.max.max(self.backward.max)
    }

    /// A proven bound for the Hausdorff distance, from above: no point of either surface is farther from the other.
    pub fn hausdorff_bound(&self) -> f64 {
        self.forward.max_bound.max(self.backward.max_bound)
    }

    /// Mean of both directions' means.
    pub fn mean(&self) -> f64 {
        (self.forward.mean + self.backward.mean) * 0.5
    }

    /// Root of the mean of both directions' mean squares.
    pub fn rms(&self) -> f64 {
        ((self.forward.rms.powi(2) + self.backward.rms.powi(2)) * 0.5).sqrt()
    }

    /// A length in percent of the first mesh's diagonal.
    pub fn percent(&self, length: f64) -> f64 {
        100.0 * length / self.diagonal
    }

    /// [`hausdorff`](Self::hausdorff) in percent of the first mesh's diagonal.
    pub fn hausdorff_percent(&self) -> f64 {
        self.percent(self.hausdorff())
    }

    /// [`mean`](Self::mean) in percent of the first mesh's diagonal.
    pub fn mean_percent(&self) -> f64 {
        self.percent(self.mean())
    }

    /// [`rms`](Self::rms) in percent of the first mesh's diagonal.
    pub fn rms_percent(&self) -> f64 {
        self.percent(self.rms())
    }
}

/// How far apart the surfaces of two meshes are, in both directions.
///
/// The surface is the triangles that have an area; coincident ones count once, and vertices that only other triangles
/// use do not count. Nearest points are exact to double precision; what is sampled is only where they are asked for. The
/// same meshes and options give the same bytes for any number of threads. To measure many meshes against one, prepare
/// it once: [`Surface`].
///
/// O((n + samples) log n), with some 200 bytes a triangle while it runs.
///
/// # Errors
/// A mesh without a surface; a number of samples that is not 1 to 2^32 - 1.
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

/// Distance of every vertex of a mesh from the surface of another, object units: to colour the mesh by its error
/// ([`palette::colours`](super::palette::colours)). O((n + m) log m).
///
/// # Errors
/// The second mesh has no surface. The first needs none.
pub fn vertex_distances(from: &Mesh, to: &Mesh) -> Result<Vec<f64>, QualityError> {
    Ok(Surface::named(to, "second")?.point_distances(from.positions()))
}

impl Surface<'_> {
    /// How far this surface and another are apart, in both directions: [`distance`] without building anything.
    ///
    /// # Errors
    /// A number of samples that is not 1 to 2^32 - 1.
    pub fn distance(&self, other: &Surface<'_>, options: &DistanceOptions) -> Result<Distance, QualityError> {
        Ok(Distance {
            forward: self.distance_to(other, options)?,
            backward: other.distance_to(self, options)?,
            diagonal: self.diagonal(),
        })
    }

    /// How far this surface is from another: one direction of [`distance`].
    ///
    /// # Errors
    /// A number of samples that is not 1 to 2^32 - 1.
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

/// Distances, and where the largest lies and leads to.
type Lengths = Sums<(DVec3, DVec3)>;

fn add(sums: &mut Lengths, walker: &mut Walker<'_>, point: DVec3) {
    let nearest = walker.closest(point);
    sums.add(nearest.distance_squared.sqrt(), (point, nearest.point));
}
