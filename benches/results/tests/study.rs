//! The study of metrics, placements and measures: its statistics agree with textbooks (in `statistics.rs`), its rows
//! survive being written and read, its outcome is the same twice, and its comparisons find what is there.

use multires::mesh::shapes;
use multires_results::study::analysis::{comparisons, correlations};
use multires_results::study::grid::{
    self, CHANGE, L1, MAX, MEASURES, METRICS, METRO, MIDPOINT, OPTIMAL, PLACEMENTS, Row, SLIVER, Schedule,
    VOLUME,
};
use multires_results::study::measure::{self, Options};

/// The placement between midpoint and subset.
const ENDPOINT: usize = 1;

fn options() -> Options {
    Options { views: 3, size: 24, samples: 300, steps: 4, schedule: Schedule::Even }
}

fn rows() -> Vec<Row> {
    let knot = shapes::torus_knot(2, 3, 60, 8);
    let terrain = shapes::terrain(15, 1);
    let mut rows = measure::rows("knot", &knot, &options(), |_| ()).expect("a knot has a surface");
    rows.extend(measure::rows("terrain", &terrain, &options(), |_| ()).expect("a terrain has a surface"));
    rows
}

fn without_times(mut rows: Vec<Row>) -> Vec<Row> {
    rows.iter_mut().for_each(|row| row.seconds = 0.0);
    rows
}

#[test]
fn every_way_makes_every_level() {
    let rows = rows();
    assert_eq!(rows.len(), 2 * METRICS.len() * PLACEMENTS.len() * 4);
    for row in &rows {
        let whole = if row.model == "knot" { 960.0 } else { 392.0 };
        assert_eq!(row.kept, 1.0 - 0.25 * row.step as f64);
        assert!(
            row.triangles as f64 <= (whole * row.kept).round()
                && row.triangles as f64 >= whole * row.kept - 3.0
        );
        // A closed model has a volume, an open one none.
        assert_eq!(row.values[VOLUME].is_some(), row.model == "knot");
        assert!(row.values[SLIVER].is_some_and(|sliver| sliver > 1.0));
        assert!(row.values[L1].is_some_and(|l1| (l1 > 0.0) == (row.step > 0)));
        let (mean, max) = (row.values[METRO].expect("measured"), row.values[MAX].expect("measured"));
        assert!(if row.step == 0 { max < 1e-5 } else { 0.0 < mean && mean < max });
    }
    // What the measures must agree on: coarser is farther.
    for ways in rows.chunks(4) {
        assert!(ways.windows(2).all(|pair| pair[0].values[METRO] < pair[1].values[METRO]), "{ways:?}");
        assert!(ways.windows(2).all(|pair| pair[0].seconds <= pair[1].seconds));
    }
}

#[test]
fn levels_beyond_the_base_mesh_have_no_values() {
    let deep = Options { steps: 9, schedule: Schedule::Halving, ..options() };
    let rows = measure::rows("ball", &shapes::icosphere(1), &deep, |_| ()).expect("a ball has a surface");
    let (reached, beyond): (Vec<&Row>, Vec<&Row>) =
        rows.iter().partition(|row| row.triangles as f64 <= (80.0 * row.kept).round());
    assert!(!beyond.is_empty() && beyond.iter().all(|row| row.values == [None; MEASURES.len()]));
    assert!(reached.iter().all(|row| row.values[SLIVER].is_some()));
}

#[test]
fn rows_come_back_from_csv() {
    let rows = rows();
    let text = grid::to_csv(&rows);
    let back = grid::from_csv(&text).expect("own rows are read");
    assert!(back == rows);
    let spoiled = text.replacen("hybrid", "hybird", 1);
    assert!(grid::from_csv(&spoiled).is_err_and(|error| error.starts_with("line ")));
    assert!(grid::from_csv(&text.replacen(",1,", ",1,7,", 1)).is_err());
}

#[test]
fn the_outcome_is_the_same_twice_and_complete() {
    let folder = std::env::temp_dir().join(format!("multires-study-{}", std::process::id()));
    let write = |name: &str| {
        let folder = folder.join(name);
        std::fs::create_dir_all(&folder).expect("a folder can be made");
        multires_results::study::write(&without_times(rows()), &folder).expect("the study can be written");
        let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(&folder)
            .expect("the folder is there")
            .map(|entry| {
                let path = entry.expect("the folder can be listed").path();
                let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
                (name.unwrap_or_default(), std::fs::read(path).expect("the file is there"))
            })
            .collect();
        files.sort();
        files
    };
    let (first, second) = (write("first"), write("second"));
    std::fs::remove_dir_all(&folder).expect("the folder goes away");
    assert!(first == second);
    let names: Vec<&str> = first.iter().map(|file| file.0.as_str()).collect();
    let expected = [
        "correlations.csv",
        "fisher.csv",
        "levels.csv",
        "means.csv",
        "metrics.svg",
        "placements.svg",
        "scheffe.csv",
        "tables.md",
        "variance.csv",
    ];
    assert_eq!(names, expected);
    for (name, bytes) in &first {
        let text = String::from_utf8_lossy(bytes);
        assert!(bytes.len() > 50 && !text.contains("NaN") && !text.contains("inf"), "{name}");
    }
}

/// Rows made up: two models far apart, a metric that is always a little worse, a volume that says the same as the
/// pictures.
fn made_up() -> Vec<Row> {
    let mut rows = Vec::new();
    for (model, base) in [("large", 100.0), ("small", 1.0)] {
        for metric in 0..METRICS.len() {
            for placement in 0..PLACEMENTS.len() {
                for step in 1..10 {
                    let ripple =
                        f64::from((7 * metric as u32 + 3 * placement as u32 + 5 * step as u32) % 11) * 1e-3;
                    let worse = if metric == 0 { 0.5 } else { 0.0 };
                    let mut values = [Some(1.0 + ripple); MEASURES.len()];
                    values[L1] = Some(base + step as f64 + worse + ripple);
                    values[VOLUME] = Some(1000.0 - base - step as f64 - worse - ripple);
                    values[METRO] = Some(ripple * ripple + f64::from(step as u32 % 2));
                    values[CHANGE] = None;
                    let (model, kept) = (model.to_owned(), 1.0 - 0.1 * step as f64);
                    let row = Row {
                        model,
                        diagonal: 1.0,
                        metric,
                        placement,
                        step,
                        kept,
                        triangles: 10,
                        collapses: 5,
                        seconds: 1.0,
                        values,
                    };
                    rows.push(row);
                }
            }
        }
    }
    rows
}

#[test]
fn blocks_see_what_models_hide() {
    let found = comparisons(&made_up());
    let metrics = found.iter().find(|comparison| comparison.name == "metrics").expect("metrics are compared");
    let [one_way, blocked, ratios] = &metrics.variances[L1];
    let (one_way, blocked) = (one_way.as_ref().expect("values vary"), blocked.as_ref().expect("values vary"));
    assert!(one_way.p > 0.99 && blocked.p < 1e-20, "{} {}", one_way.p, blocked.p);
    assert!(blocked.scheffe(0, 1).is_some_and(|p| p < 1e-6));
    assert!(blocked.scheffe(1, 2).is_some_and(|p| p > 0.05));
    // Half more of a hundred is a smaller ratio than of one; by ratio the mean is the geometric one.
    assert!(ratios.as_ref().is_some_and(|ratios| ratios.p < 1e-6));
    let geometric = metrics.mean(L1, 2, 0).expect("values are positive");
    assert!(geometric > 20.0 && geometric < 0.5 * one_way.means[0], "{geometric}");
    // A measure that nobody took compares nothing, and leaves the others alone.
    assert_eq!(metrics.variances[CHANGE], [None, None, None]);
    assert_eq!(one_way.counts, vec![2 * 4 * 9; METRICS.len()]);
}

#[test]
fn groups_are_southerns() {
    let found = comparisons(&made_up());
    let placements = found.iter().find(|c| c.name == "southern-placements").expect("placements are compared");
    let means = &placements.variances[L1][0].as_ref().expect("values vary").means;
    let mean_of = |metric: &str, placement: usize| {
        let rows = made_up();
        let chosen: Vec<f64> = rows
            .iter()
            .filter(|row| METRICS[row.metric].name == metric && row.placement == placement)
            .filter_map(|row| row.values[L1])
            .collect();
        chosen.iter().sum::<f64>() / chosen.len() as f64
    };
    assert_eq!(means[MIDPOINT], mean_of("hybrid", MIDPOINT));
    assert_eq!(means[ENDPOINT], mean_of("hybrid", ENDPOINT));
    assert_eq!(means[OPTIMAL], mean_of("memoryless-quadric", OPTIMAL));
    let metrics = found.iter().find(|c| c.name == "southern-metrics").expect("metrics are compared");
    assert_eq!(
        metrics.variances[L1][0].as_ref().expect("values vary").means[0],
        mean_of("edge-length", MIDPOINT)
    );
}

#[test]
fn correlations_are_found() {
    let found = correlations(&made_up());
    for matrix in &found {
        let contest = &matrix.contests()[0];
        assert_eq!(contest.image, L1);
        // Models of the same size: the unit is no matter.
        assert!(contest.in_units.is_none_or(|r| (r - contest.distance).abs() < 1e-12));
        assert!((contest.volume + 1.0).abs() < 1e-9 && contest.distance.abs() < 0.2, "{}", matrix.name);
        assert_eq!((matrix.of(L1, CHANGE), matrix.chance(L1, CHANGE)), (None, None));
    }
    assert_eq!(found[0].count, made_up().len());
}
