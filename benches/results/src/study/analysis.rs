//! From rows to comparisons: who is compared with whom, and by what.
//!
//! Southern compares metrics with one another (his experiment 1), then placements (experiment 2), then measures
//! (experiment 3). The first two are made here twice: with the ways he paired (his table 4.1), and over the whole grid.
//! Each is laid out one way, as his; in blocks, where levels of the same model at the same step are compared with one
//! another, which takes the models' own differences out of what counts as chance; and in blocks of logarithms, where
//! they are compared by ratio, since an error that is twice another's on a fine level is so on a coarse one too.

use std::collections::BTreeMap;

use super::grid::{
    HYBRID, L1, L2, MEASURES, METRICS, METRO, MIDPOINT, OPTIMAL, PLACEMENTS, QUADRIC, Row, SILHOUETTE, SIX,
    SOUTHERNS, SUBSET, VOLUME,
};
use super::statistics::{Variance, Wilks, correlation_p, fisher, pearson, spearman};

/// How a comparison is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    OneWay,
    Blocked,
    /// Blocks of logarithms; only blocks where every group has something to take one of (`Measure::floor`).
    Ratios,
}

impl Layout {
    pub const ALL: [Self; 3] = [Self::OneWay, Self::Blocked, Self::Ratios];

    pub fn name(self) -> &'static str {
        match self {
            Self::OneWay => "one-way",
            Self::Blocked => "blocked",
            Self::Ratios => "blocked-ratios",
        }
    }
}

/// Groups of rows beside each other.
pub struct Comparison {
    pub name: &'static str,
    pub title: &'static str,
    pub groups: Vec<String>,
    /// Of each measure ([`MEASURES`]), for each [`Layout`]; `None` where there is too little to say anything.
    pub variances: Vec<[Option<Variance>; Layout::ALL.len()]>,
    /// Southern's six measures at once, or as many of them as vary.
    pub wilks: Option<Wilks>,
    /// The measures that [`wilks`](Self::wilks) is of.
    pub wilks_of: Vec<usize>,
}

impl Comparison {
    /// Mean of a group: of ratios the geometric one.
    pub fn mean(&self, measure: usize, layout: usize, group: usize) -> Option<f64> {
        let mean = *self.variances.get(measure)?.get(layout)?.as_ref()?.means.get(group)?;
        Some(if Layout::ALL[layout] == Layout::Ratios { mean.exp() } else { mean })
    }
}

/// Which group a row belongs to (if any), and what else its block is told by besides model and step.
type Sort = fn(&Row) -> Option<(usize, usize)>;

/// All comparisons. O(rows log rows).
pub fn comparisons(rows: &[Row]) -> Vec<Comparison> {
    let metrics = |count: usize| METRICS[..count].iter().map(|m| m.symbol.to_owned()).collect::<Vec<_>>();
    let placements = || PLACEMENTS.iter().map(|p| p.1.to_owned()).collect::<Vec<_>>();
    let paired: Sort = |row| (METRICS[row.metric].paired == row.placement).then_some((row.metric, 0));
    let southern: Sort = |row| {
        let pair = METRICS[row.metric].paired == row.placement;
        (pair && row.metric < SOUTHERNS).then_some((row.metric, 0))
    };
    let four: Sort = |row| {
        let metric = if row.placement == OPTIMAL { QUADRIC } else { HYBRID };
        (row.metric == metric).then_some((row.placement, 0))
    };
    let by_metric: Sort = |row| Some((row.metric, row.placement));
    let by_placement: Sort = |row| Some((row.placement, row.metric));
    vec![
        compare(
            rows,
            "southern-metrics",
            "Southern's metrics as he paired them",
            metrics(SOUTHERNS),
            southern,
        ),
        compare(
            rows,
            "paired-metrics",
            "all metrics, edge length at the midpoint and the others at the best of three places",
            metrics(METRICS.len()),
            paired,
        ),
        compare(
            rows,
            "southern-placements",
            "placements as Southern paired them: E_hybrid, and E_quadric where optimal",
            placements(),
            four,
        ),
        compare(rows, "metrics", "all metrics, over all placements", metrics(METRICS.len()), by_metric),
        compare(rows, "placements", "all placements, over all metrics", placements(), by_placement),
    ]
}

fn compare(
    rows: &[Row],
    name: &'static str,
    title: &'static str,
    groups: Vec<String>,
    sort: Sort,
) -> Comparison {
    let count = groups.len();
    // One layout's groups are the other's columns: a block counts only where every group has a value in it.
    let mut blocks: BTreeMap<(&str, usize, usize), Vec<Option<&Row>>> = BTreeMap::new();
    for row in rows {
        if let Some((group, other)) = sort(row) {
            let block = blocks.entry((&row.model, row.step, other)).or_insert_with(|| vec![None; count]);
            block[group] = Some(row);
        }
    }
    let variances = (0..MEASURES.len())
        .map(|measure| {
            let value = |row: &Option<&Row>| row.and_then(|row| row.values[measure]);
            let column = |g: usize| blocks.values().filter_map(|block| value(&block[g])).collect();
            let groups: Vec<Vec<f64>> = (0..count).map(column).collect();
            let whole =
                blocks.values().filter_map(|block| block.iter().map(value).collect::<Option<Vec<_>>>());
            let whole: Vec<f64> = whole.flatten().collect();
            let positive =
                whole.chunks(count).filter(|block| block.iter().all(|&x| x > MEASURES[measure].floor));
            let logarithms: Vec<f64> = positive.flatten().map(|x| x.ln()).collect();
            let blocked = |blocks: &[f64]| Variance::blocked(blocks, count);
            [Variance::one_way(&groups), blocked(&whole), blocked(&logarithms)]
        })
        .collect();
    let whole = |of: &[usize]| -> Vec<Vec<f64>> {
        let row = |row: &Row| of.iter().map(|&m| row.values[m]).collect::<Option<Vec<_>>>();
        (0..count)
            .map(|g| blocks.values().filter_map(|block| block[g].and_then(row)).flatten().collect())
            .collect()
    };
    // Measures that were not taken, as of open models, are left out rather than all rows.
    let wilks_of: Vec<usize> =
        (0..SIX).filter(|&m| rows.iter().any(|row| sort(row).is_some() && row.values[m].is_some())).collect();
    let wilks = Wilks::new(&whole(&wilks_of), wilks_of.len());
    Comparison { name, title, groups, variances, wilks, wilks_of }
}

/// The measures from pictures, first of all measures.
const IMAGES: [usize; 3] = [L1, L2, SILHOUETTE];

/// A matrix of correlations between all measures.
pub struct Correlations {
    pub name: &'static str,
    pub title: &'static str,
    /// Rows that have all measures.
    pub count: usize,
    /// Row after row of the matrix.
    pub values: Vec<Option<f64>>,
    /// Of K_L1, K_L2 and K_sil with K_metro in the models' own units, which a model's size is part of.
    pub in_units: [Option<f64>; 3],
    /// Whether each value comes from one sample of `count` pairs, so that its significance can be told.
    pub one_sample: bool,
}

/// Volume against distance as a sign of what is seen (Southern 4.5.3).
pub struct Contest {
    pub image: usize,
    pub volume: f64,
    pub distance: f64,
    /// The distance in object units.
    pub in_units: Option<f64>,
    /// Fisher's deviate of the difference of both sizes, and its chance.
    pub fisher: Option<(f64, f64)>,
}

impl Correlations {
    pub fn of(&self, a: usize, b: usize) -> Option<f64> {
        self.values.get(a * MEASURES.len() + b).copied().flatten()
    }

    /// Chance of a value as far from 0 where nothing is correlated.
    pub fn chance(&self, a: usize, b: usize) -> Option<f64> {
        if self.one_sample && a != b { correlation_p(self.of(a, b)?, self.count) } else { None }
    }

    /// Whose correlation with each measure from pictures is larger.
    pub fn contests(&self) -> Vec<Contest> {
        let contest = |image: usize| {
            let (volume, distance) = (self.of(image, VOLUME)?, self.of(image, METRO)?);
            let fisher =
                if self.one_sample { fisher(volume.abs(), distance.abs(), self.count) } else { None };
            Some(Contest { image, volume, distance, in_units: self.in_units[image], fisher })
        };
        IMAGES.into_iter().filter_map(contest).collect()
    }
}

/// All matrices: Southern's three, and two that the differences between models do not reach.
pub fn correlations(rows: &[Row]) -> Vec<Correlations> {
    let all: Vec<&Row> = rows.iter().collect();
    let part = |keep: fn(&Row) -> bool| rows.iter().filter(|row| keep(row)).collect::<Vec<_>>();
    let optimal = part(|row| row.placement == OPTIMAL && row.metric == QUADRIC);
    let subset = part(|row| row.placement == SUBSET && row.metric == HYBRID);
    let midpoint = part(|row| row.placement == MIDPOINT && row.metric == HYBRID);
    vec![
        matrix("all", "all data", &all, pearson),
        matrix("optimal", "E_quadric, optimal placement", &optimal, pearson),
        matrix("subset", "E_hybrid, best of three places", &subset, pearson),
        matrix("midpoint", "E_hybrid, midpoint", &midpoint, pearson),
        matrix("all-ranks", "all data, by rank (Spearman)", &all, spearman),
        within_models(&all),
    ]
}

type Coefficient = fn(&[f64], &[f64]) -> Option<f64>;

fn matrix(name: &'static str, title: &'static str, rows: &[&Row], of: Coefficient) -> Correlations {
    let rows = whole(rows);
    let column = |m: usize| rows.iter().filter_map(|row| row.values[m]).collect::<Vec<_>>();
    let columns: Vec<Vec<f64>> = (0..MEASURES.len()).map(column).collect();
    let units: Vec<f64> =
        rows.iter().filter_map(|row| row.values[METRO].map(|x| x * row.diagonal / 100.0)).collect();
    let pair = |at: usize| {
        let (a, b) = (at / MEASURES.len(), at % MEASURES.len());
        of(&columns[a], &columns[b])
    };
    let values = (0..MEASURES.len() * MEASURES.len()).map(pair).collect();
    let in_units = IMAGES.map(|image| of(&columns[image], &units));
    Correlations { name, title, count: rows.len(), values, in_units, one_sample: true }
}

/// The mean of every model's own correlation by rank.
fn within_models(rows: &[&Row]) -> Correlations {
    let mut models: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    rows.iter().for_each(|row| models.entry(&row.model).or_default().push(row));
    let own: Vec<Correlations> = models.values().map(|rows| matrix("", "", rows, spearman)).collect();
    let mean = |at: usize| {
        let found: Vec<f64> = own.iter().filter_map(|matrix| matrix.values[at]).collect();
        super::statistics::mean(&found)
    };
    Correlations {
        name: "within-models",
        title: "mean of every model's own correlation by rank",
        count: own.iter().map(|matrix| matrix.count).sum(),
        values: (0..MEASURES.len() * MEASURES.len()).map(mean).collect(),
        in_units: [None; 3],
        one_sample: false,
    }
}

/// The rows that have all measures that any row has.
fn whole<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let taken: Vec<usize> =
        (0..MEASURES.len()).filter(|&m| rows.iter().any(|row| row.values[m].is_some())).collect();
    rows.iter().copied().filter(|row| taken.iter().all(|&m| row.values[m].is_some())).collect()
}
