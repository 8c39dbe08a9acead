//! Promise: levels of what games are made of lie as far from their models as the sequence says, sampled both ways on the
//! surface and along borders, seams and borders between materials.
//!
//! The models lie in `$MULTIRES_MODELS`, `../shared/models` by default; what is missing is skipped by name.
#![cfg(all(feature = "quality", feature = "io"))]

use crate::apart::Input;
use multires::mesh::Mesh;
use multires::simplify::{Parts, Simplifier};

fn model(file: &str) -> Option<Mesh> {
    crate::models::read("error/games", file)
}

/// Game models and small cases of made things.
const FILES: [&str; 13] = [
    "game/pigman/scene.gltf",
    "game/Fox.glb",
    "game/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf",
    "real/beetle.obj",
    "real/fandisk.obj",
    "real/suzanne.obj",
    "real/cow.obj",
    "real/teapot.obj",
    "cases/plate_with_hole/plate32.obj",
    "cases/flat_hole_open/washer.obj",
    "cases/cad_needles/beam60.obj",
    "cases/mirrored_uv/mirror.obj",
    "cases/colour_edge/disc.obj",
];

/// Creases at most: a cosine of 3/4.
const CREASE: f64 = 0.75;

#[test]
fn levels_of_models_lie_as_far_away_as_is_said() {
    let (mut close, mut near, mut all) = (0, 0, 0);
    let mut far = Vec::new();
    for file in FILES {
        let Some(mesh) = model(file) else { continue };
        // Cracks of rounding are closed by the simplifier, and no curves to it.
        let mesh = mesh.welded(1e-6 * mesh.diagonal());
        // Which creases count is the simplifier's to choose where a mesh is no drawing: some, or all.
        let [input, with_creases] = [-2.0, CREASE].map(|cosine| Input::new(&mesh, cosine));
        // Curves of a part that vanishes are held against the surface that is left, not against its curves.
        let sequence = Simplifier::new().parts(Parts::Keep).run(&mesh).unwrap();
        for percent in [70, 50, 35, 25, 18, 12, 8, 5] {
            let steps = sequence.steps_for_triangles(mesh.triangles().len() * percent / 100);
            let apart = input.apart(&sequence, steps);
            let said = f64::from(sequence.error_after(steps));
            let (found, slack) = (apart.largest(), 3e-6 * mesh.diagonal());
            all += 1;
            near += usize::from(found <= 1.1 * said + slack);
            let most = if said <= 1.1 * found + slack {
                found
            } else {
                found.max(with_creases.curves_apart(&sequence, steps))
            };
            if found <= 1.1 * said + slack && said <= 1.1 * most + slack {
                close += 1;
            } else {
                eprintln!(
                    "{:.2} to {:.2}: {file} at {percent} %: {apart:?} of {said}",
                    found / said,
                    most / said
                );
            }
            if found > 1.3 * said + slack {
                far.push(format!("{file} at {percent} %: {apart:?} of {said}"));
            }
        }
    }
    assert!(far.is_empty(), "{far:#?}");
    eprintln!("{close} of {all} within a tenth, {near} at most a tenth farther");
    assert!(10 * near >= 9 * all, "{near} of {all} at most a tenth farther than is said");
    assert!(5 * close >= 4 * all, "{close} of {all} within a tenth of what is said");
}
