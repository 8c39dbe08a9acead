//! What flights measure, as tables and as JSON.

use serde_json::{Value, json};

/// One contender on the path.
pub(crate) struct Flight {
    pub name: &'static str,
    pub build_ms: f64,
    /// Triangles: mean, least, most.
    pub drawn: [f64; 3],
    pub in_frustum: f64,
    /// Means a frame.
    pub tests: f64,
    pub operations: f64,
    pub front: f64,
    pub bytes: f64,
    /// To the selection or the cut; copying what is drawn or changed; both.
    pub median_us: [f64; 3],
    pub p99_us: [f64; 3],
    /// Without and with copying.
    pub ns_a_triangle: [f64; 2],
    pub hierarchy_bytes_a_vertex: f64,
    pub instance_bytes_a_vertex: f64,
}

/// One slow path.
pub(crate) struct Slow {
    pub name: &'static str,
    /// The frame of the path around whose pose it goes.
    pub frame: usize,
    pub motion: &'static str,
    /// Means a frame.
    pub tests: f64,
    pub operations: f64,
    pub front: f64,
    pub median_us: f64,
}

/// All splits and all collapses.
pub(crate) struct Bulk {
    pub name: &'static str,
    pub splits: usize,
    pub split_ns: f64,
    pub collapse_ns: f64,
}

/// The first is what the others are compared with.
pub(crate) fn print_flight(flights: &[Flight]) {
    println!(
        "  {:<12} {:>9} {:>8} {:>17} {:>9} {:>6} {:>7} {:>6} {:>7} {:>8} {:>15} {:>15} {:>15} {:>6} {:>7} {:>9} {:>8}",
        "contender",
        "build ms",
        "drawn",
        "least - most",
        "in frust.",
        "%",
        "tests",
        "ops",
        "front",
        "bytes",
        "us cut/select",
        "us copy",
        "us both",
        "times",
        "ns/tri",
        "hier B/v",
        "inst B/v"
    );
    let Some(first) = flights.first() else { return };
    for f in flights {
        let range = format!("{:.0} - {:.0}", f.drawn[1], f.drawn[2]);
        let time = |i: usize| format!("{:.1} / {:.1}", f.median_us[i], f.p99_us[i]);
        println!(
            "  {:<12} {:>9.0} {:>8.0} {:>17} {:>9.0} {:>6.1} {:>7.0} {:>6.0} {:>7.0} {:>8.0} {:>15} {:>15} {:>15} {:>6.2} {:>7.2} {:>9.1} {:>8.1}",
            f.name,
            f.build_ms,
            f.drawn[0],
            range,
            f.in_frustum,
            100.0 * f.drawn[0] / first.in_frustum,
            f.tests,
            f.operations,
            f.front,
            f.bytes,
            time(0),
            time(1),
            time(2),
            // What the first copies is what others have ready when they return.
            f.median_us[if std::ptr::eq(f, first) { 2 } else { 0 }] / first.median_us[2],
            f.ns_a_triangle[0],
            f.hierarchy_bytes_a_vertex,
            f.instance_bytes_a_vertex,
        );
    }
}

pub(crate) fn print_slow(rows: &[Slow]) {
    if rows.is_empty() {
        return;
    }
    println!(
        "  {:<12} {:>6} {:<15} {:>8} {:>8} {:>8} {:>7} {:>10}",
        "slow path", "frame", "a frame", "tests", "front", "%", "ops", "median us"
    );
    for r in rows {
        println!(
            "  {:<12} {:>6} {:<15} {:>8.0} {:>8.0} {:>8.2} {:>7.1} {:>10.1}",
            r.name,
            r.frame,
            r.motion,
            r.tests,
            r.front,
            100.0 * r.tests / r.front,
            r.operations,
            r.median_us
        );
    }
}

pub(crate) fn print_bulk(rows: &[Bulk]) {
    println!("  {:<12} {:>8} {:>9} {:>12}", "everything", "splits", "split ns", "collapse ns");
    for r in rows {
        println!("  {:<12} {:>8} {:>9.0} {:>12.0}", r.name, r.splits, r.split_ns, r.collapse_ns);
    }
}

impl Flight {
    pub fn json(&self) -> Value {
        json!({
            "contender": self.name,
            "build_ms": self.build_ms,
            "drawn": { "mean": self.drawn[0], "least": self.drawn[1], "most": self.drawn[2] },
            "in_frustum": self.in_frustum,
            "tests": self.tests,
            "operations": self.operations,
            "front": self.front,
            "bytes": self.bytes,
            "median_us": { "cut": self.median_us[0], "copy": self.median_us[1], "both": self.median_us[2] },
            "p99_us": { "cut": self.p99_us[0], "copy": self.p99_us[1], "both": self.p99_us[2] },
            "ns_a_triangle": { "cut": self.ns_a_triangle[0], "both": self.ns_a_triangle[1] },
            "hierarchy_bytes_a_vertex": self.hierarchy_bytes_a_vertex,
            "instance_bytes_a_vertex": self.instance_bytes_a_vertex,
        })
    }
}

impl Slow {
    pub fn json(&self) -> Value {
        json!({
            "contender": self.name,
            "frame": self.frame,
            "motion": self.motion,
            "tests": self.tests,
            "operations": self.operations,
            "front": self.front,
            "median_us": self.median_us,
        })
    }
}

impl Bulk {
    pub fn json(&self) -> Value {
        json!({
            "contender": self.name,
            "splits": self.splits,
            "split_ns": self.split_ns,
            "collapse_ns": self.collapse_ns,
        })
    }
}
