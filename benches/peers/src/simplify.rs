//! Runs every contender on every mesh to every count, and says how long each took.
//!
//! ```text
//! for each mesh, for each count:
//!     every contender: the warm-ups, and its mesh written out
//!     the rounds: every contender once a round     <- interleaved, so that a slow spell of the machine hits all
//!     median and least CPU time of each
//! ```

use std::error::Error;
use std::path::Path;

use multires::mesh::Mesh;
use serde_json::{Value, json};

use crate::Options;
use crate::clock::timed;
use crate::contender::{CONTENDERS, Contender};
use crate::input::Input;
use crate::statistics::{median, sorted};

/// One line of the table.
struct Row {
    mesh: String,
    triangles: usize,
    contender: &'static str,
    percent: f64,
    target: usize,
    reached: usize,
    /// CPU time of the calling thread, ms.
    median_ms: f64,
    least_ms: f64,
    /// CPU time of all threads, ms.
    process_ms: f64,
}

pub(crate) fn run(inputs: &[Input], options: &Options) -> Result<(), Box<dyn Error>> {
    if let Some(directory) = &options.out {
        std::fs::create_dir_all(directory)?;
    }
    let wanted = |c: &&Contender| options.only.is_empty() || options.only.iter().any(|name| name == c.name);
    let contenders: Vec<&Contender> = CONTENDERS.iter().filter(wanted).collect();

    let mut rows = Vec::new();
    if !options.json {
        heading();
    }
    for input in inputs {
        if let Some(directory) = &options.out {
            save(directory, &format!("{}.original", input.name), &input.mesh)?;
        }
        for &percent in &options.percents {
            for row in measure(input, percent, &contenders, options)? {
                if !options.json {
                    print(&row);
                }
                rows.push(row);
            }
        }
    }
    if options.json {
        let rows: Vec<Value> = rows.iter().map(Row::json).collect();
        let object = json!({ "unit": "ms", "clock": CLOCK, "runs": options.runs, "warmups": options.warmups, "rows": rows });
        println!("{object}");
    }
    Ok(())
}

pub(crate) const CLOCK: &str = if cfg!(unix) { "thread CPU time" } else { "wall time" };

/// One mesh to one count.
fn measure(
    input: &Input,
    percent: f64,
    contenders: &[&Contender],
    options: &Options,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let triangles = input.mesh.triangles().len();
    let target = (triangles as f64 * percent / 100.0).floor() as usize;

    let mut reached = Vec::new();
    for contender in contenders {
        for _ in 1..options.warmups {
            (contender.run)(&input.mesh, target)?;
        }
        let output = (contender.run)(&input.mesh, target)?;
        reached.push(output.triangles());
        if let Some(directory) = &options.out {
            let name = format!("{}.{}.{percent}", input.name, contender.name);
            save(directory, &name, &output.into_mesh(&input.mesh)?)?;
        }
    }

    let mut times = vec![Vec::new(); contenders.len()];
    for _ in 0..options.runs {
        for (contender, times) in contenders.iter().zip(&mut times) {
            let (output, time) = timed(|| (contender.run)(&input.mesh, target));
            output?;
            times.push(time);
        }
    }

    Ok(contenders
        .iter()
        .zip(&times)
        .zip(&reached)
        .map(|((contender, times), &reached)| {
            let [thread, process] = [0, 1].map(|clock| sorted(times.iter().map(|t: &[f64; 2]| t[clock])));
            Row {
                mesh: input.name.clone(),
                triangles,
                contender: contender.name,
                percent,
                target,
                reached,
                median_ms: median(&thread),
                least_ms: thread.first().copied().unwrap_or(f64::NAN),
                process_ms: median(&process),
            }
        })
        .collect())
}

fn save(directory: &Path, name: &str, mesh: &Mesh) -> Result<(), Box<dyn Error>> {
    let path = directory.join(format!("{name}.ply"));
    Ok(multires::io::write(&path, mesh).map_err(|e| format!("{}: {e}", path.display()))?)
}

fn heading() {
    println!(
        "{:<20} {:>9} {:<20} {:>5} {:>8} {:>8} {:>10} {:>10}",
        "mesh", "triangles", "contender", "%", "target", "reached", "median ms", "least ms"
    );
}

fn print(row: &Row) {
    // More than the thread's own time means that other threads worked too: then the columns tell half the truth.
    let threads = if row.process_ms > row.median_ms * 1.1 + 0.1 {
        format!("  (all threads: {:.2})", row.process_ms)
    } else {
        String::new()
    };
    println!(
        "{:<20} {:>9} {:<20} {:>5} {:>8} {:>8} {:>10.2} {:>10.2}{threads}",
        row.mesh,
        row.triangles,
        row.contender,
        row.percent,
        row.target,
        row.reached,
        row.median_ms,
        row.least_ms
    );
}

impl Row {
    fn json(&self) -> Value {
        json!({
            "mesh": self.mesh,
            "triangles": self.triangles,
            "contender": self.contender,
            "percent": self.percent,
            "target": self.target,
            "reached": self.reached,
            "median_ms": self.median_ms,
            "least_ms": self.least_ms,
            "process_ms": self.process_ms,
        })
    }
}
