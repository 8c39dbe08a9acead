//! The best split of a small scene: branch and bound, with Lagrange's bound.
//!
//! ```text
//!     object 0:   level 2      level 1     level 0      levels by error + slope * triangles, least first
//!                  /   \          |
//!     object 1:   2     0         cut: even the best of all other objects leads to more error than is known to do
//! ```

use super::ladder::LadderObject;

/// Most nodes of a search.
const NODES: usize = 20_000;

/// What is searched.
pub(super) struct Problem<'a> {
    pub objects: &'a [LadderObject<'a>],
    /// Screen error that needs no finer level, pixels.
    pub tolerance_px: f32,
    /// Most triangles.
    pub triangles: u64,
    /// Price of a triangle, for the bound.
    pub slope: f64,
    /// Error that a split must be below.
    pub threshold: f64,
}

#[derive(Debug, Clone, Copy)]
struct Choice {
    rung: u32,
    triangles: u64,
    error: f64,
    /// `error + slope * triangles`.
    priced: f64,
}

/// Objects from some depth on.
#[derive(Debug, Clone, Copy, Default)]
struct Rest {
    /// Where the object's choices begin.
    first: usize,
    object: u32,
    /// Least prices and least triangles, summed over this object and all deeper.
    priced: f64,
    triangles: u64,
}

/// Scratch and result of a search.
#[derive(Debug, Clone, Default)]
pub(super) struct Exact {
    choices: Vec<Choice>,
    rests: Vec<Rest>,
    /// At each depth: the choice to try next, and triangles and error of the depths before.
    path: Vec<(usize, u64, f64)>,
    best: Vec<u32>,
}

impl Exact {
    /// Returns the rung of each object of the split found.
    pub fn rungs(&self) -> &[u32] {
        &self.best
    }

    /// Returns triangles and error of a split below the threshold: within `gap` of the best, unless the search ended early.
    /// `None` if there is none, or none was found.
    pub fn search(&mut self, problem: &Problem<'_>, gap: f64) -> Option<(u64, f64)> {
        self.prepare(problem);
        let Self { choices, rests, path, best } = self;
        let depths = rests.len() - 1; // the last rest is empty
        let mut threshold = problem.threshold;
        let mut found = None;
        path.clear();
        path.push((rests[0].first, 0, 0.0));
        for _ in 0..NODES {
            let depth = path.len().saturating_sub(1);
            let Some(top) = path.last_mut() else { break };
            let (at, triangles, error) = *top;
            top.0 += 1;
            if depth == depths {
                path.pop();
                continue;
            }
            let below = rests[depth + 1];
            if at == below.first {
                path.pop();
                continue;
            }
            let choice = choices[at];
            let (triangles, error) = (triangles + choice.triangles, error + choice.error);
            let room = problem.triangles as f64 - triangles as f64;
            if error + below.priced - problem.slope * room >= threshold {
                // All later choices of this object have a higher price.
                path.pop();
                continue;
            }
            if triangles + below.triangles > problem.triangles {
                continue;
            }
            path.push((below.first, triangles, error));
            if depth + 1 == depths && error < threshold {
                found = Some((triangles, error));
                threshold = error * (1.0 - gap);
                for (rest, step) in rests.iter().zip(&path[..depths]) {
                    best[rest.object as usize] = choices[step.0 - 1].rung;
                }
            }
        }
        found
    }

    /// Lists the choices of each object, least price first.
    fn prepare(&mut self, problem: &Problem<'_>) {
        let Self { choices, rests, best, .. } = self;
        choices.clear();
        rests.clear();
        best.clear();
        best.resize(problem.objects.len(), 0);
        for (number, object) in problem.objects.iter().enumerate() {
            let (first, weight) = (choices.len(), object.weight());
            let finest = object.finest_rung(weight, problem.tolerance_px) as usize;
            let weight = f64::from(weight);
            for (rung, level) in object.ladder.rungs().iter().take(finest + 1).enumerate() {
                let (triangles, error) = (u64::from(level.triangles), weight * f64::from(level.error));
                let priced = error + problem.slope * triangles as f64;
                choices.push(Choice { rung: rung as u32, triangles, error, priced });
            }
            if choices.len() > first {
                choices[first..]
                    .sort_unstable_by(|a, b| a.priced.total_cmp(&b.priced).then(a.rung.cmp(&b.rung)));
                rests.push(Rest { first, object: number as u32, ..Rest::default() });
            }
        }
        rests.push(Rest { first: choices.len(), ..Rest::default() });
        for at in (0..rests.len() - 1).rev() {
            let own = &choices[rests[at].first..rests[at + 1].first];
            let least = own.iter().map(|choice| choice.triangles).min().unwrap_or(0);
            rests[at].priced = rests[at + 1].priced + own[0].priced;
            rests[at].triangles = rests[at + 1].triangles + least;
        }
    }
}
