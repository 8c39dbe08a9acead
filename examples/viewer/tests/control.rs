//! Promise: controllers hold the triangles of a whole scene, whatever its structure, and let it go again.

mod card;

use card::{model, open, shared};
use multires::gmesh::Gmesh;
use multires::mesh::shapes;
use multires_viewer::camera::{Lens, Orbit, Tolerances};
use multires_viewer::gpu::Gpu;
use multires_viewer::headless::{STEP, Stage};
use multires_viewer::scene::{
    Adapted, BuildOptions, Builtin, ControlOptions, Controller, Overlays, SceneControlError, StructureKind,
};

const LENS: Lens = Lens { field_of_view: 0.8, size: [1280, 720] };
const STRUCTURES: [StructureKind; 4] =
    [StructureKind::Hierarchy, StructureKind::Tom, StructureKind::Gmesh, StructureKind::Wavelet];

/// Sixty rocks of 1,280 triangles.
fn stage(gpu: &Gpu, structure: StructureKind) -> Stage {
    let options = BuildOptions::default().with_structure(structure);
    let rock = model(&shapes::rock(1_280, 1), &options);
    let places: Vec<_> = Builtin::Crowd.places().into_iter().take(60).collect();
    Stage::new(gpu.clone(), rock, &places, shared(), [64, 36], 1).unwrap()
}

/// A frame on a way around the scene.
fn frame(stage: &mut Stage, frame: usize) -> Adapted {
    frame_within(stage, frame, 1.0)
}

/// The same with a tolerance, pixels.
fn frame_within(stage: &mut Stage, frame: usize, tolerance: f32) -> Adapted {
    let (centre, diagonal) = (stage.scene().centre(), stage.scene().diagonal());
    let orbit = Orbit::framing(centre, 0.4 * diagonal, LENS.field_of_view, false);
    let pose = Orbit { around: 0.01 * frame as f64, distance: 0.5 * diagonal, ..orbit }.pose();
    let views = [pose.view(&LENS, &Tolerances::default().with_anywhere(tolerance)).unwrap()];
    stage.frame(&views, None, Overlays::default(), STEP).adapted
}

#[test]
fn a_budget_is_never_exceeded() {
    let Some(gpu) = open("a_budget_is_never_exceeded") else { return };
    for structure in STRUCTURES {
        let mut stage = stage(&gpu, structure);
        let free = frame(&mut stage, 0).change.triangles;
        let most = free / 2;
        let options = ControlOptions::default().with_controller(Controller::Triangles).with_triangles(most);
        stage.scene_mut().set_control(options).unwrap();
        for at in 0..60 {
            let adapted = frame(&mut stage, at);
            assert!(adapted.change.triangles <= most, "{structure:?}, frame {at}: {adapted:?}");
            assert!(adapted.change.triangles * 3 > most, "{structure:?}, frame {at}: {adapted:?}");
            assert!(adapted.controlled.unwrap().output >= 1.0);
        }
        stage.scene_mut().set_control(ControlOptions::default()).unwrap();
        let adapted = frame(&mut stage, 0);
        assert_eq!((adapted.change.triangles, adapted.controlled), (free, None), "{structure:?}");
    }
}

#[test]
fn a_frame_time_is_kept() {
    let Some(gpu) = open("a_frame_time_is_kept") else { return };
    for structure in STRUCTURES {
        let mut stage = stage(&gpu, structure);
        let free = frame(&mut stage, 0).change.triangles;
        let options = ControlOptions::default().with_controller(Controller::Time).with_triangles(free);
        stage.scene_mut().set_control(options).unwrap();
        // A card on which everything takes twice the time there is.
        let each = 2.0 * options.seconds / free as f64;
        let mut triangles = free;
        for at in 0..60 {
            stage.scene_mut().measured(each * triangles as f64);
            triangles = frame(&mut stage, at).change.triangles;
            let load = each * triangles as f64 / options.seconds;
            assert!(at < 8 || load <= 1.0, "{structure:?}, frame {at}: load {load}");
        }
        let load = each * triangles as f64 / options.seconds;
        assert!(load > 0.3, "{structure:?}: load {load} in the end");
        // Times that are none change nothing.
        stage.scene_mut().measured(0.0);
        stage.scene_mut().measured(f64::NAN);
    }
}

#[test]
fn a_bias_holds_a_number_from_both_sides() {
    let Some(gpu) = open("a_bias_holds_a_number_from_both_sides") else { return };
    let mut stage = stage(&gpu, StructureKind::Gmesh);
    // Levels between the finest and the coarsest.
    let frame = |stage: &mut Stage, at| frame_within(stage, at, 12.0);
    let free = frame(&mut stage, 0).change.triangles;
    let gmesh: &Gmesh = stage.scene().model().gmesh().unwrap().structure();
    let step = gmesh.levels().windows(2).map(|pair| pair[0].triangles - pair[1].triangles).max().unwrap();
    for wanted in [free / 2, free * 3 / 2] {
        let options = ControlOptions::default().with_controller(Controller::Bias).with_triangles(wanted);
        stage.scene_mut().set_control(options).unwrap();
        for at in 0..120 {
            let adapted = frame(&mut stage, at);
            let apart = adapted.change.triangles.abs_diff(wanted);
            assert!(at < 60 || apart <= step, "frame {at}: {} of {wanted}", adapted.change.triangles);
        }
        assert_eq!(frame(&mut stage, 0).controlled.unwrap().output > 0.0, wanted < free);
    }
    stage.scene_mut().set_control(ControlOptions::default()).unwrap();
    assert_eq!(frame(&mut stage, 0).change.triangles, free);
}

#[test]
fn what_has_no_parameter_has_no_bias() {
    let Some(gpu) = open("what_has_no_parameter_has_no_bias") else { return };
    let mut stage = stage(&gpu, StructureKind::Hierarchy);
    let options = ControlOptions::default().with_controller(Controller::Bias);
    assert_eq!(stage.scene_mut().set_control(options), Err(SceneControlError::NoGmesh));
    assert_eq!(stage.scene().control(), &ControlOptions::default());
    let options = ControlOptions::default().with_controller(Controller::Time).with_seconds(-1.0);
    assert!(matches!(stage.scene_mut().set_control(options), Err(SceneControlError::Control(_))));
}
