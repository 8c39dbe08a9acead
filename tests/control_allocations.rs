//! Promise: controllers allocate nothing once warm.

#[path = "../examples/support/crowd.rs"]
mod crowd;

use crowd::{Crowd, circle, stairs, through};
use multires::control::{
    Bias, BiasOptions, Budget, BudgetOptions, FrameTime, FrameTimeOptions, Ladder, LadderObject, Sample,
    Stress, StressFrame, StressOptions,
};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

#[test]
fn nothing_is_allocated_once_warm() {
    let (crowd, stairs) = (Crowd::new(10), stairs());
    let ladder = Ladder::new(&[(10_000, 0.0), (5_000, 0.01), (2_000, 0.05), (700, 0.2), (200, 1.0)]).unwrap();
    let mut bias = Bias::new(BiasOptions::default().with_change(None)).unwrap();
    let mut budget = Budget::new(BudgetOptions::default()).unwrap();
    let mut small = Budget::new(BudgetOptions::default().with_triangles(9_000).with_gap(1e-6)).unwrap();
    let mut stress = Stress::new(StressOptions::default()).unwrap();
    let mut time = FrameTime::new(FrameTimeOptions::default(), 1_000_000).unwrap();
    let (mut objects, mut split) = (Vec::new(), Vec::new());
    let mut fly = || {
        for path in [circle, through] {
            for frame in 0..120 {
                crowd.objects(&stairs, path(frame), &mut objects);
                bias.update(&objects, true);
                split.clear();
                split.extend(objects.iter().map(|o| LadderObject::new(&ladder, 1.0 / (0.1 + o.parameter))));
                budget.set_triangles(time.triangles());
                let triangles = budget.split(&split).triangles;
                small.split(&split[frame..frame + 6]);
                time.update(Sample { seconds: 1.6e-8 * triangles as f64, triangles }).unwrap();
                stress.update(StressFrame::new(0.01, 9)).unwrap();
            }
        }
    };
    fly();
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    fly();
    assert_eq!((ALLOCATOR.peak_usage(), ALLOCATOR.current_usage()), (before, before));
}
