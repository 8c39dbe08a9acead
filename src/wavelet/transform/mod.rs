//! Wavelet transforms: a function on a subdivision as its values on the base and a coefficient for every midpoint.
//!
//! | file | idea |
//! |---|---|
//! | `domain.rs` | nodes: vertices, or points; the degrees of freedom of a function |
//! | `products.rs` | exact inner products of hats; the L2 error |
//! | `disk.rs` | the weights of k-disk wavelets |
//! | `wavelet_transform.rs` | [`WaveletTransform`]: analysis and synthesis |
//! | `compress.rs` | [`Coefficients`]: dropping the smallest |

mod compress;
mod disk;
mod domain;
mod products;
mod wavelet_transform;

pub use compress::Coefficients;
pub use products::l2_error;
pub use wavelet_transform::{Wavelet, WaveletTransform};
