//! Promise: stress brings the load of a scene back below 1, and neither oscillates nor winds up.

use multires::control::{ControlError, Stress, StressFrame, StressOptions};
use proptest::prelude::*;

/// A scene of objects alike, with 200 to 10,200 triangles each.
struct Scene {
    /// Objects in view.
    visible: usize,
    /// Share of the screen that each covers.
    coverage: f64,
    /// Seconds a triangle.
    cost: f64,
}

impl Scene {
    /// Draws a frame at the stress, and takes it in. Returns the load.
    fn frame(&self, stress: &mut Stress) -> f64 {
        let triangles = self.visible * stress.triangles(self.coverage, [200, 10_200]);
        let resolution = stress.resolution(self.coverage);
        let all = |at: bool| if at { self.visible } else { 0 };
        let frame = StressFrame::new(1e-4 + self.cost * triangles as f64, self.visible);
        stress.update(frame.with_ends(all(resolution >= 1.0), all(resolution <= 0.0))).unwrap();
        stress.load()
    }
}

#[test]
fn the_formulas_are_the_papers() {
    let mut stress = Stress::new(StressOptions::paper()).unwrap();
    assert_eq!(stress.stress(), 1.0);
    for (seconds, expected) in
        [(0.101, 1.4), (0.1, 1.4), (0.05, 1.4), (0.049, 1.4 * 0.6), (9.0, 1.4 * 0.6 * 1.4)]
    {
        assert!((stress.update(StressFrame::new(seconds, 1)).unwrap() - expected).abs() < 1e-12);
        assert_eq!(stress.load(), seconds / 0.1);
    }
    let stress = Stress::new(StressOptions::default()).unwrap();
    assert_eq!([0.25, 1.0, 3.0, -1.0, f64::NAN].map(|c| stress.resolution(c)), [0.25, 1.0, 1.0, 0.0, 0.0]);
    assert_eq!(stress.triangles(0.5, [100, 300]), 200);
    assert_eq!(stress.triangles(0.5, [300, 100]), 300);
}

#[test]
fn a_cost_that_jumps_tenfold_is_met_within_five_frames() {
    // Where the coarsest levels, times ten, fit: 200 of 5,200 to 10,200 triangles.
    for (visible, coverage) in [(100, 0.5), (300, 0.8), (30, 1.0)] {
        for share in [0.55, 0.75, 0.98] {
            let mut stress = Stress::new(StressOptions::default()).unwrap();
            let triangles = visible as f64 * (200.0 + 10_000.0 * coverage);
            let mut scene = Scene { visible, coverage, cost: share / 60.0 / triangles };
            for _ in 0..30 {
                scene.frame(&mut stress);
            }
            scene.cost *= 10.0;
            let loads: Vec<f64> = (0..60).map(|_| scene.frame(&mut stress)).collect();
            assert!(loads[0] > 5.0);
            assert!(loads[5..].iter().all(|load| (0.5..=1.0).contains(load)), "{loads:?}");
            let rest = stress.stress();
            scene.frame(&mut stress);
            assert_eq!(stress.stress(), rest, "no oscillation");
        }
    }
}

#[test]
fn idle_frames_wind_up_nothing() {
    let mut stress = Stress::new(StressOptions::default()).unwrap();
    let busy = Scene { visible: 200, coverage: 0.5, cost: 2e-8 };
    for _ in 0..30 {
        busy.frame(&mut stress);
    }
    let before = stress.stress();
    // Nothing in view: whatever the time, even none.
    for seconds in [1e-4, 0.0, f64::NAN, -1.0] {
        assert_eq!(stress.update(StressFrame::new(seconds, 0)), Ok(before));
    }
    // 20 frames with a single object at full resolution, then many again.
    let idle = Scene { visible: 1, coverage: 1.0, cost: 2e-8 };
    for _ in 0..20 {
        idle.frame(&mut stress);
    }
    assert!(stress.stress() >= 0.5, "{}", stress.stress());
    let loads: Vec<f64> = (0..6).map(|_| busy.frame(&mut stress)).collect();
    assert!(loads[2..].iter().all(|&load| load <= 1.0), "{loads:?}");
}

#[test]
fn overload_at_the_coarsest_winds_up_nothing() {
    let mut stress = Stress::new(StressOptions::default()).unwrap();
    for _ in 0..100 {
        stress.update(StressFrame::new(1.0, 5).with_ends(0, 5)).unwrap();
    }
    assert_eq!((stress.stress(), stress.load()), (1.0, 60.0));
    // And the range holds in any case.
    for _ in 0..100 {
        stress.update(StressFrame::new(1.0, 5)).unwrap();
    }
    assert_eq!((stress.stress(), stress.tolerance_factor()), (1024.0, 1024.0));
}

#[test]
fn factors_of_tolerances_are_not_below_one() {
    let mut stress = Stress::new(StressOptions::for_tolerances()).unwrap();
    for _ in 0..20 {
        stress.update(StressFrame::new(1e-4, 1)).unwrap();
    }
    assert_eq!(stress.tolerance_factor(), 1.0);
}

#[test]
fn bad_times_and_options_are_refused() {
    let mut stress = Stress::new(StressOptions::default()).unwrap();
    let before = stress.clone();
    for seconds in [0.0, -0.016, f64::NAN, f64::INFINITY] {
        let error = stress.update(StressFrame::new(seconds, 1)).unwrap_err();
        assert!(matches!(error, ControlError::Time { .. }));
        assert!(multires::Error::from(error).to_string().contains("seconds"));
        assert_eq!(stress, before);
    }
    let options = StressOptions::default();
    for bad in [
        options.with_seconds(0.0),
        options.with_seconds(f64::NAN),
        options.with_alpha(0.0),
        options.with_alpha(1.0),
        options.with_band(0.0, 1.0),
        options.with_band(0.5, f64::INFINITY),
        options.with_band(0.9, 1.0),
        options.with_leap(0.5),
        options.with_range(0.0, 1.0),
        options.with_range(2.0, 1.0),
    ] {
        assert!(matches!(Stress::new(bad), Err(ControlError::OutOfRange { .. })), "{bad:?}");
        assert!(stress.set_options(bad).is_err());
    }
    let message = Stress::new(options.with_band(0.9, 1.0)).unwrap_err().to_string();
    assert!(message.starts_with("upper over lower load is 1.1"), "{message}");
    assert!(Stress::new(options.with_band(0.6, 1.0)).is_ok());
}

proptest! {
    /// Any frames: stress stays in its range, load is never NaN, and equal calls are equal.
    #[test]
    fn any_frame_gives_a_defined_stress(
        frames in prop::collection::vec((any::<f64>(), any::<usize>(), any::<usize>(), any::<usize>()), 0..30),
        coverage in any::<f64>(),
        counts in any::<[usize; 2]>(),
    ) {
        let mut stress = Stress::new(StressOptions::default()).unwrap();
        let mut again = stress.clone();
        for (seconds, visible, full, base) in frames {
            let frame = StressFrame::new(seconds, visible).with_ends(full, base);
            prop_assert_eq!(stress.update(frame).is_ok(), again.update(frame).is_ok());
            prop_assert_eq!(&stress, &again);
            prop_assert!((1.0 / 1024.0..=1024.0).contains(&stress.stress()));
            prop_assert!((0.0..=1.0).contains(&stress.resolution(coverage)));
            let triangles = stress.triangles(coverage, counts);
            prop_assert!(triangles >= counts[0] && triangles <= counts[1].max(counts[0]));
        }
    }
}
