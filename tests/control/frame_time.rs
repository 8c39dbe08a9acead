//! Promise: a frame time is held by a target of triangles, through spikes, pauses, load screens and times that come late.

use std::collections::VecDeque;

use multires::control::{ControlError, Estimate, FrameTime, FrameTimeOptions, Sample};
use proptest::prelude::*;

const SECONDS: f64 = 1.0 / 60.0;

/// A card that takes `fixed` seconds and `cost` seconds a triangle.
struct Card {
    fixed: f64,
    cost: f64,
}

impl Card {
    fn seconds(&self, triangles: usize) -> f64 {
        self.fixed + self.cost * triangles as f64
    }

    /// Draws frames at the target. Returns the loads.
    fn draw(&self, time: &mut FrameTime, frames: usize) -> Vec<f64> {
        (0..frames)
            .map(|_| {
                let triangles = time.triangles();
                time.update(Sample { seconds: self.seconds(triangles), triangles }).unwrap();
                time.load()
            })
            .collect()
    }
}

fn settled(card: &Card) -> FrameTime {
    let mut time = FrameTime::new(FrameTimeOptions::default(), 300_000).unwrap();
    let loads = card.draw(&mut time, 120);
    assert!(loads[100..].iter().all(|load| (0.7..=1.0).contains(load)), "{loads:?}");
    time
}

#[test]
fn a_steady_scene_has_a_steady_target() {
    for card in [
        Card { fixed: 0.0, cost: 1e-8 },
        Card { fixed: 0.004, cost: 1e-8 },
        Card { fixed: 0.001, cost: 4e-8 },
    ] {
        let mut time = settled(&card);
        let target = time.triangles();
        card.draw(&mut time, 100);
        assert_eq!(time.triangles(), target);
    }
}

#[test]
fn a_cost_that_jumps_tenfold_is_met_within_five_frames() {
    let mut time = settled(&Card { fixed: 0.001, cost: 1e-8 });
    let loads = Card { fixed: 0.001, cost: 1e-7 }.draw(&mut time, 60);
    assert!(loads[0] > 5.0);
    assert!(loads[5..].iter().all(|&load| load <= 1.0), "{loads:?}");
    let target = time.triangles();
    Card { fixed: 0.001, cost: 1e-7 }.draw(&mut time, 50);
    assert_eq!(time.triangles(), target, "no oscillation");
}

#[test]
fn a_spike_changes_nothing() {
    let card = Card { fixed: 0.0, cost: 1e-8 };
    let mut time = settled(&card);
    let target = time.triangles();
    for _ in 0..10 {
        for spike in [0.2, 0.1] {
            time.update(Sample { seconds: spike, triangles: target }).unwrap();
            assert_eq!(time.triangles(), target);
        }
        card.draw(&mut time, 5);
        assert_eq!(time.triangles(), target);
    }
}

#[test]
fn a_pause_changes_nothing_and_lasting_ones_are_believed() {
    let card = Card { fixed: 0.0, cost: 1e-8 };
    let mut time = settled(&card);
    let target = time.triangles();
    for _ in 0..4 {
        // A debugger, a window dragged for some time.
        time.update(Sample { seconds: 45.0, triangles: target }).unwrap();
    }
    assert_eq!(time.triangles(), target);
    card.draw(&mut time, 3);
    assert_eq!(time.triangles(), target);
    // A card that is really so slow.
    let loads = Card { fixed: 0.0, cost: 1e-6 }.draw(&mut time, 12);
    assert!(loads[11] <= 1.0, "{loads:?}");
}

#[test]
fn a_load_screen_changes_nothing() {
    let card = Card { fixed: 0.0, cost: 1e-8 };
    let mut time = settled(&card);
    let target = time.triangles();
    // A picture with a bar: 40 triangles, at full speed, in slow frames, and with pauses.
    for frame in 0..300 {
        let seconds = [0.002, 0.03, 0.016, 1.3][frame % 4];
        time.update(Sample { seconds, triangles: 40 }).unwrap();
    }
    // A menu with a model that turns.
    for _ in 0..300 {
        time.update(Sample { seconds: 0.005, triangles: 20_000 }).unwrap();
    }
    assert_eq!(time.triangles(), target);
    let loads = card.draw(&mut time, 10);
    assert!(loads.iter().all(|load| (0.7..=1.0).contains(load)), "{loads:?}");
}

#[test]
fn times_that_come_late_do_not_make_it_swing() {
    let mut time = settled(&Card { fixed: 0.0, cost: 1e-8 });
    let slow = Card { fixed: 0.0, cost: 1e-7 };
    let mut under_way: VecDeque<Sample> = VecDeque::new();
    let mut targets = Vec::new();
    for _ in 0..60 {
        let triangles = time.triangles();
        under_way.push_back(Sample { seconds: slow.seconds(triangles), triangles });
        if under_way.len() > 3 {
            time.update(under_way.pop_front().unwrap()).unwrap();
        }
        targets.push(time.triangles());
    }
    let last = targets[59];
    assert!(slow.seconds(last) <= SECONDS);
    let lowest = *targets.iter().min().unwrap();
    assert!(last as f64 <= lowest as f64 * 1.3, "{targets:?}");
}

#[test]
fn the_target_rises_slowly_and_gives_a_factor() {
    let mut time = FrameTime::new(FrameTimeOptions::default(), 100_000).unwrap();
    let mut before = time.triangles();
    for _ in 0..100 {
        Card { fixed: 0.0, cost: 1e-9 }.draw(&mut time, 1);
        assert!(time.triangles() as f64 <= before as f64 * 1.1 + 1.0);
        before = time.triangles();
    }
    assert!(before > 1_000_000);
    let mut scene = Estimate::new(0);
    scene.observe(1.0, 4 * before);
    assert!((time.tolerance_factor(&scene) - 4.0).abs() < 0.01);
    scene.observe(1.0, before / 2);
    assert_eq!(time.tolerance_factor(&scene), 1.0);
    assert_eq!(time.tolerance_factor(&Estimate::new(usize::MAX)), 1.0);
}

#[test]
fn the_time_of_a_triangle_is_filtered_as_said() {
    let sample = |seconds: f64| Sample { seconds, triangles: 100_000 };
    // A fixed time is none of the triangles' time.
    let options = FrameTimeOptions::default().with_window(1).with_fixed(0.004);
    let mut time = FrameTime::new(options, 100_000).unwrap();
    time.update(sample(0.004 + 4e-3)).unwrap();
    assert!((time.seconds_per_triangle() - 4e-8).abs() < 1e-15);
    // A quarter of the way down, in logarithms; all of the way up.
    time.update(sample(0.004 + 1e-3)).unwrap();
    assert!((time.seconds_per_triangle() - 4e-8 * 0.25_f64.powf(0.25)).abs() < 1e-15);
    time.update(sample(0.004 + 9e-3)).unwrap();
    assert!((time.seconds_per_triangle() - 9e-8).abs() < 1e-15);
}

#[test]
fn a_load_inside_the_band_leaves_the_target() {
    let mut time = settled(&Card { fixed: 0.0, cost: 1e-8 });
    let target = time.triangles();
    let loads = Card { fixed: 0.0, cost: 1.1e-8 }.draw(&mut time, 20);
    assert!((0.72..0.99).contains(&loads[0]), "{loads:?}");
    assert_eq!(time.triangles(), target);
}

#[test]
fn pauses_apart_are_no_lasting_change() {
    let card = Card { fixed: 0.0, cost: 1e-8 };
    let mut time = settled(&card);
    let target = time.triangles();
    for _ in 0..5 {
        for _ in 0..4 {
            time.update(Sample { seconds: 2.0, triangles: target }).unwrap();
        }
        card.draw(&mut time, 1);
    }
    assert_eq!(time.triangles(), target);
}

#[test]
fn bad_times_and_options_are_refused() {
    let options = FrameTimeOptions::default();
    let mut time = FrameTime::new(options, 0).unwrap();
    assert_eq!(time.triangles(), 10_000);
    let before = time.clone();
    for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = time.update(Sample { seconds, triangles: 100_000 }).unwrap_err();
        assert!(matches!(error, ControlError::Time { .. }));
        assert_eq!(time, before);
    }
    for bad in [
        options.with_seconds(0.0),
        options.with_seconds(f64::INFINITY),
        options.with_fixed(1.0),
        options.with_fixed(f64::NAN),
        options.with_loads(0.0, 0.5, 1.0),
        options.with_loads(0.5, 0.5, 1.0),
        options.with_loads(0.5, 0.7, f64::INFINITY),
        options.with_window(0),
        options.with_window(4),
        options.with_window(17),
        options.with_smoothing(0.0),
        options.with_smoothing(1.1),
        options.with_pause(0.01),
        options.with_growth(1.0),
        options.with_triangles(0, 10),
        options.with_triangles(10, 9),
    ] {
        assert!(matches!(FrameTime::new(bad, 1), Err(ControlError::OutOfRange { .. })), "{bad:?}");
        assert!(time.set_options(bad).is_err());
    }
}

proptest! {
    /// Any samples: the target stays in its range and rises by no more than it may.
    #[test]
    fn any_sample_gives_a_target_in_range(
        samples in prop::collection::vec((prop_oneof![1e-6_f64..1.0, any::<f64>()], any::<usize>()), 0..60),
        window in prop::sample::select(vec![1_usize, 3, 15]),
    ) {
        let options = FrameTimeOptions::default().with_window(window).with_triangles(100, 50_000);
        let mut time = FrameTime::new(options, 1_000).unwrap();
        for (seconds, triangles) in samples {
            let before = time.triangles();
            let _ = time.update(Sample { seconds, triangles: triangles % 100_000 });
            prop_assert!((100..=50_000).contains(&time.triangles()));
            prop_assert!(time.triangles() as f64 <= before as f64 * 1.1 + 1.0);
        }
    }
}
