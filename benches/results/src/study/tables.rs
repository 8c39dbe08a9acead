//! What the study finds as CSV, for programs, and as Markdown, for people.

use super::analysis::{Comparison, Contest, Correlations, Layout};
use super::grid::{MEASURES, METRICS, PLACEMENTS, Row};
use super::statistics::{Variance, mean};

/// A difference counts where chance alone makes one as large less often than this (Southern 4.4.2).
const SIGNIFICANT: f64 = 0.05;

/// Rows of one metric and one placement, or of either alone.
fn select(rows: &[Row], metric: Option<usize>, placement: Option<usize>) -> Vec<&Row> {
    let is = |wanted: Option<usize>, found: usize| wanted.is_none_or(|wanted| wanted == found);
    rows.iter().filter(|row| is(metric, row.metric) && is(placement, row.placement)).collect()
}

fn mean_of(rows: &[&Row], measure: usize) -> Option<f64> {
    mean(&rows.iter().filter_map(|row| row.values[measure]).collect::<Vec<_>>())
}

/// Microseconds of a collapse, down to each model's last level.
fn microseconds(rows: &[&Row]) -> Option<f64> {
    let last = rows.iter().map(|row| row.step).max()?;
    let (mut seconds, mut collapses) = (0.0, 0);
    for row in rows.iter().filter(|row| row.step == last) {
        seconds += row.seconds;
        collapses += row.collapses;
    }
    (collapses > 0).then(|| 1e6 * seconds / collapses as f64)
}

/// Means of every measure, for each metric with each placement.
pub fn means_csv(rows: &[Row]) -> String {
    let mut out = String::from("metric,placement,levels");
    MEASURES.iter().for_each(|measure| out += &format!(",{}", measure.name));
    out += ",microseconds_a_collapse\n";
    for (m, metric) in METRICS.iter().enumerate() {
        for (p, placement) in PLACEMENTS.iter().enumerate() {
            let chosen = select(rows, Some(m), Some(p));
            let measured = chosen.iter().filter(|row| row.values.iter().any(Option::is_some)).count();
            out += &format!("{},{},{measured}", metric.name, placement.1);
            (0..MEASURES.len()).for_each(|measure| out += &format!(",{}", csv(mean_of(&chosen, measure))));
            out += &format!(",{}\n", csv(microseconds(&chosen)));
        }
    }
    out
}

/// Every layout of every comparison, measure by measure, and Wilks's lambda over the measures.
pub fn variance_csv(comparisons: &[Comparison]) -> String {
    let mut out = String::from("comparison,layout,measure,freedom_between,freedom_residual,f,p,lambda\n");
    for comparison in comparisons {
        for (measure, layouts) in MEASURES.iter().zip(&comparison.variances) {
            for (layout, found) in Layout::ALL.iter().zip(layouts) {
                let Some(Variance { freedom, f, p, .. }) = found else { continue };
                let [between, residual] = freedom;
                let (name, layout, measure) = (comparison.name, layout.name(), measure.name);
                out += &format!("{name},{layout},{measure},{between},{residual},{f:.6e},{p:.6e},\n");
            }
        }
        if let Some(wilks) = comparison.wilks {
            let [between, residual] = wilks.freedom;
            let (name, f, p, lambda) = (comparison.name, wilks.f, wilks.p, wilks.lambda);
            out += &format!("{name},one-way,all,{between},{residual:.3},{f:.6e},{p:.6e},{lambda:.6e}\n");
        }
    }
    out
}

/// Every pair of every comparison.
pub fn scheffe_csv(comparisons: &[Comparison]) -> String {
    let mut out = String::from("comparison,layout,measure,a,b,levels_a,levels_b,mean_a,mean_b,p\n");
    for comparison in comparisons {
        for (measure, layouts) in comparison.variances.iter().enumerate() {
            for (layout, found) in layouts.iter().enumerate() {
                let Some(found) = found else { continue };
                let groups = &comparison.groups;
                let mean = |group: usize| csv(comparison.mean(measure, layout, group));
                let what = [comparison.name, Layout::ALL[layout].name(), MEASURES[measure].name].join(",");
                for a in 0..groups.len() {
                    for b in a + 1..groups.len() {
                        let (names, counts) = ([&groups[a], &groups[b]], [found.counts[a], found.counts[b]]);
                        out += &format!("{what},{},{},{},{}", names[0], names[1], counts[0], counts[1]);
                        out += &format!(",{},{},{}\n", mean(a), mean(b), csv(found.scheffe(a, b)));
                    }
                }
            }
        }
    }
    out
}

/// Every pair of measures in every matrix.
pub fn correlations_csv(all: &[Correlations]) -> String {
    let mut out = String::from("data,a,b,levels,r,p\n");
    for matrix in all {
        for (a, first) in MEASURES.iter().enumerate() {
            for (b, second) in MEASURES.iter().enumerate().skip(a + 1) {
                let (r, p) = (csv(matrix.of(a, b)), csv(matrix.chance(a, b)));
                out += &format!("{},{},{},{},{r},{p}\n", matrix.name, first.name, second.name, matrix.count);
            }
        }
    }
    out
}

/// Volume against distance as a sign of what is seen.
pub fn fisher_csv(all: &[Correlations]) -> String {
    let mut out = String::from("data,image,levels,r_volume,r_distance,z,p,r_distance_in_units\n");
    for matrix in all {
        for contest in matrix.contests() {
            let (z, p) = contest.fisher.unzip();
            let (image, volume, distance) = (MEASURES[contest.image].name, contest.volume, contest.distance);
            let (name, count) = (matrix.name, matrix.count);
            out += &format!("{name},{image},{count},{volume:.6},{distance:.6}");
            out += &format!(",{},{},{}\n", csv(z), csv(p), csv(contest.in_units));
        }
    }
    out
}

/// Everything, as the tables of Southern's appendix B. Bold: significant.
pub fn markdown(rows: &[Row], comparisons: &[Comparison], correlations: &[Correlations]) -> String {
    let mut out = String::from("# Tables\n\n");
    out += "Bold: p < 0.05. Numbers in brackets: the groups that a mean is told apart from, at p < 0.05 by Scheffe's test.\n";
    out += "K_L1 and K_L2 in grey levels, K_sil in pixels a view, K_metro and K_max in percent of the model's diagonal.\n";
    out += "\n## Means\n";
    for (measure, about) in MEASURES.iter().enumerate() {
        grid_table(&mut out, rows, about.symbol, |chosen| mean_of(chosen, measure));
    }
    grid_table(&mut out, rows, "microseconds a collapse", microseconds);
    for comparison in comparisons {
        out += &format!("\n## Comparison: {}\n", comparison.title);
        if let Some(wilks) = comparison.wilks {
            let of: Vec<&str> = comparison.wilks_of.iter().map(|&m| MEASURES[m].symbol).collect();
            out += &format!(
                "\nAll at once ({}): Wilks's lambda {:.4}, F({}, {:.1}) = {:.3}, p = {}\n",
                of.join(", "),
                wilks.lambda,
                wilks.freedom[0],
                wilks.freedom[1],
                wilks.f,
                chance(Some(wilks.p)),
            );
        }
        for layout in 0..Layout::ALL.len() {
            summary_table(&mut out, comparison, layout);
        }
        for (measure, layouts) in MEASURES.iter().zip(&comparison.variances) {
            if let Some(found) = &layouts[0] {
                scheffe_table(&mut out, measure.symbol, comparison, found);
            }
        }
    }
    correlations.iter().for_each(|matrix| correlation_table(&mut out, matrix));
    out
}

/// Metrics down, placements across, and both alone at the margins.
fn grid_table(out: &mut String, rows: &[Row], title: &str, value: impl Fn(&[&Row]) -> Option<f64>) {
    let head: Vec<&str> = PLACEMENTS.iter().map(|placement| placement.1).collect();
    *out += &format!("\n| {title} | {} | all |\n|---|{}\n", head.join(" | "), "--:|".repeat(head.len() + 1));
    let metrics = METRICS.iter().enumerate().map(|(m, metric)| (Some(m), metric.symbol));
    for (metric, name) in metrics.chain([(None, "all")]) {
        let places = (0..PLACEMENTS.len()).map(Some).chain([None]);
        let cells: Vec<String> = places.map(|place| figure(value(&select(rows, metric, place)))).collect();
        *out += &format!("| {name} | {} |\n", cells.join(" | "));
    }
}

/// Groups down, measures across: means, and the numbers of the groups that each is told apart from.
fn summary_table(out: &mut String, comparison: &Comparison, layout: usize) {
    let symbols: Vec<&str> = MEASURES.iter().map(|measure| measure.symbol).collect();
    let kind = Layout::ALL[layout].name();
    *out += &format!("\n| {kind} | {} |\n|---|{}\n", symbols.join(" | "), "--:|".repeat(symbols.len()));
    for (group, name) in comparison.groups.iter().enumerate() {
        let cell = |measure: usize| {
            let Some(found) = &comparison.variances[measure][layout] else { return "-".into() };
            let apart = |other: &usize| found.scheffe(group, *other).is_some_and(|p| p < SIGNIFICANT);
            let others = (0..comparison.groups.len()).filter(|other| *other != group).filter(apart);
            let numbers: Vec<String> = others.map(|other| (other + 1).to_string()).collect();
            let mean = figure(comparison.mean(measure, layout, group));
            if numbers.is_empty() { mean } else { format!("{mean} ({})", numbers.join(" ")) }
        };
        let cells: Vec<String> = (0..MEASURES.len()).map(cell).collect();
        *out += &format!("| {} {name} | {} |\n", group + 1, cells.join(" | "));
    }
}

/// One way: means in the first row, chances of pairs below, as Southern's tables B.1 to B.12.
fn scheffe_table(out: &mut String, title: &str, comparison: &Comparison, found: &Variance) {
    let groups = &comparison.groups;
    *out += &format!("\n| {title} | {} |\n|---|{}\n", groups.join(" | "), "--:|".repeat(groups.len()));
    let means: Vec<String> = found.means.iter().map(|&m| figure(Some(m))).collect();
    *out += &format!("| mean of {} | {} |\n", found.counts.iter().max().unwrap_or(&0), means.join(" | "));
    for (a, name) in groups.iter().enumerate() {
        let pair = |b: usize| if a == b { String::new() } else { chance(found.scheffe(a, b)) };
        let cells: Vec<String> = (0..groups.len()).map(pair).collect();
        *out += &format!("| {name} | {} |\n", cells.join(" | "));
    }
    let [between, residual] = found.freedom;
    *out += &format!("\nF({between}, {residual}) = {:.3}, p = {}\n", found.f, chance(Some(found.p)));
}

/// A matrix as Southern's tables B.13 to B.15, and volume against distance below it.
fn correlation_table(out: &mut String, matrix: &Correlations) {
    let symbols: Vec<&str> = MEASURES.iter().map(|measure| measure.symbol).collect();
    let rule = "--:|".repeat(symbols.len());
    *out += &format!("\n## Correlations: {}, {} levels\n", matrix.title, matrix.count);
    *out += &format!("\n| | {} |\n|---|{rule}\n", symbols.join(" | "));
    for (a, name) in symbols.iter().enumerate() {
        let cell = |b: usize| match matrix.of(a, b) {
            None => "-".into(),
            Some(r) if matrix.chance(a, b).is_some_and(|p| p < SIGNIFICANT) => format!("**{r:.3}**"),
            Some(r) => format!("{r:.3}"),
        };
        let cells: Vec<String> = (0..symbols.len()).map(cell).collect();
        *out += &format!("| {name} | {} |\n", cells.join(" | "));
    }
    for contest in matrix.contests() {
        let Contest { image, volume, distance, in_units, fisher } = contest;
        let image = MEASURES[image].symbol;
        *out += &format!("\n{image}: r = {volume:.3} with K_vol, {distance:.3} with K_metro");
        if let Some((z, p)) = fisher {
            *out += &format!(" (z = {z:.2}, p = {})", chance(Some(p)));
        }
        if let Some(r) = in_units {
            *out += &format!(", {r:.3} with K_metro in object units");
        }
        out.push('\n');
    }
}

fn csv(value: Option<f64>) -> String {
    value.map_or(String::new(), |x| format!("{x:.6e}"))
}

/// Four significant digits.
fn figure(value: Option<f64>) -> String {
    let Some(x) = value else { return "-".into() };
    if x == 0.0 {
        return "0".into();
    }
    let decimals = 3 - x.abs().log10().floor() as i32;
    if (0..9).contains(&decimals) { format!("{x:.*}", decimals as usize) } else { format!("{x:.3e}") }
}

/// A chance, bold where it is small.
fn chance(p: Option<f64>) -> String {
    match p {
        None => "-".into(),
        Some(p) if p >= SIGNIFICANT => format!("{p:.3}"),
        Some(p) if p >= 0.0001 => format!("**{p:.4}**"),
        Some(_) => "**<.0001**".into(),
    }
}
