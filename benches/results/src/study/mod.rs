//! A repetition of Southern's evaluation of simplification ("Quality control tools for interactive rendering of 3D
//! triangle meshes", chapter 4 and appendix B), with metrics that he did not have.
//!
//! | file | idea |
//! |---|---|
//! | `grid.rs` | which metrics, placements, levels and measures there are, and the row that one level makes |
//! | `measure.rs` | a model simplified in every way, and every level measured |
//! | `images.rs` | the measures that are taken from pictures |
//! | `statistics.rs` | layouts of variance, Scheffe's test, correlations |
//! | `analysis.rs` | from rows to comparisons: who is compared with whom |
//! | `tables.rs` | what is found as CSV and Markdown |
//! | `charts.rs` | what is found as pictures |

pub mod analysis;
pub mod charts;
pub mod grid;
mod images;
pub mod measure;
pub mod statistics;
pub mod tables;

use std::error::Error;
use std::fs;
use std::path::Path;

use grid::Row;

/// Writes everything that follows from the rows into a folder.
pub fn write(rows: &[Row], folder: &Path) -> Result<(), Box<dyn Error>> {
    let write = |name: &str, text: String| {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))
    };
    let comparisons = analysis::comparisons(rows);
    let correlations = analysis::correlations(rows);
    write("levels.csv", grid::to_csv(rows))?;
    write("means.csv", tables::means_csv(rows))?;
    write("variance.csv", tables::variance_csv(&comparisons))?;
    write("scheffe.csv", tables::scheffe_csv(&comparisons))?;
    write("correlations.csv", tables::correlations_csv(&correlations))?;
    write("fisher.csv", tables::fisher_csv(&correlations))?;
    write("tables.md", tables::markdown(rows, &comparisons, &correlations))?;
    write("metrics.svg", charts::sheet(rows, charts::Lines::Metrics)?)?;
    write("placements.svg", charts::sheet(rows, charts::Lines::Placements)?)?;
    Ok(())
}
