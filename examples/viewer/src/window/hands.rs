//! What hands do to the camera: mouse, touch, trackpad, keys.
//!
//! | | orbit | fly |
//! |---|---|---|
//! | drag, one finger | around | look about |
//! | right or middle drag, two fingers | along the picture | up and sideways |
//! | wheel, pinch | nearer, farther | faster, slower; pinch goes ahead |
//! | two fingers on a trackpad | around | look about |
//! | W A S D Q E | | ahead, left, back, right, down, up; shift is fast |

use egui::{Event, Key, MouseWheelUnit, PointerButton, Response};

use crate::camera::{Fly, Orbit, Pose};

/// Radians for a drag over all of the picture's height.
const TURN: f64 = 3.2;

/// The camera in somebody's hands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hands {
    /// Around a target.
    Orbit(Orbit),
    /// Wherever one likes.
    Fly(Fly),
}

impl Hands {
    /// Where that is.
    pub fn pose(&self) -> Pose {
        match self {
            Self::Orbit(orbit) => orbit.pose(),
            Self::Fly(fly) => fly.pose(),
        }
    }

    /// Takes another pose, as it is held.
    pub fn take(&mut self, pose: &Pose) {
        let z_up = pose.up[2] > pose.up[1];
        *self = match self {
            Self::Orbit(_) => Self::Orbit(Orbit::of(pose, z_up)),
            Self::Fly(fly) => Self::Fly(Fly::of(pose, fly.speed, z_up)),
        };
    }

    /// Changes how it is held, from where it is. `size` is the length of the scene.
    pub fn fly(&mut self, on: bool, size: f64) {
        let pose = self.pose();
        let z_up = pose.up[2] > pose.up[1];
        match (on, &self) {
            (true, Self::Orbit(_)) => *self = Self::Fly(Fly::of(&pose, 0.3 * size, z_up)),
            (false, Self::Fly(_)) => *self = Self::Orbit(Orbit::of(&pose, z_up)),
            _ => {}
        }
    }

    /// Moves by what was done over the picture in the last frame; whether anything was.
    pub fn move_by(&mut self, over: &Response, seconds: f64, size: f64, field_of_view: f64) -> bool {
        let before = *self;
        let height = f64::from(over.rect.height().max(1.0));
        let shares = |v: egui::Vec2| [f64::from(v.x) / height, f64::from(v.y) / height];
        let touch = over.ctx.multi_touch();
        let (mut turn, mut shift, mut zoom) = ([0.0; 2], [0.0; 2], 1.0);
        if let Some(touch) = touch {
            shift = shares(touch.translation_delta);
            zoom = f64::from(touch.zoom_delta);
        } else if over.dragged_by(PointerButton::Primary) {
            turn = shares(over.drag_delta());
        } else if over.dragged_by(PointerButton::Secondary) || over.dragged_by(PointerButton::Middle) {
            shift = shares(over.drag_delta());
        }
        let mut wheel = 0.0;
        if over.contains_pointer() && touch.is_none() {
            over.ctx.input(|input| {
                for event in &input.events {
                    match event {
                        // A trackpad says points, a wheel lines.
                        Event::MouseWheel { unit: MouseWheelUnit::Point, delta, modifiers, .. }
                            if !modifiers.command =>
                        {
                            let [x, y] = shares(*delta);
                            turn = [turn[0] + x, turn[1] + y];
                        }
                        Event::MouseWheel { delta, .. } => wheel += f64::from(delta.y),
                        Event::Zoom(factor) => zoom *= f64::from(*factor),
                        _ => {}
                    }
                }
            });
        }
        match self {
            Self::Orbit(orbit) => {
                orbit.turn(-TURN * turn[0], TURN * turn[1]);
                orbit.pan(-shift[0], shift[1], field_of_view);
                orbit.zoom(zoom * 1.15_f64.powf(wheel), size);
            }
            Self::Fly(fly) => {
                fly.turn(-0.5 * TURN * turn[0], 0.5 * TURN * turn[1]);
                fly.speed = (fly.speed * 1.25_f64.powf(wheel)).clamp(size * 1e-5, size * 1e2);
                let way = [-shift[0], shift[1], zoom.ln()].map(|x| x * 2.0);
                fly.go(way, f64::from(u8::from(way != [0.0; 3])));
                fly.go(keys(over), seconds);
            }
        }
        *self != before
    }
}

/// Right, up and ahead, by the keys that are held down.
fn keys(over: &Response) -> [f64; 3] {
    if over.ctx.egui_wants_keyboard_input() {
        return [0.0; 3];
    }
    over.ctx.input(|input| {
        let fast = if input.modifiers.shift { 1.0 } else { 0.3 };
        let way = |plus: [Key; 2], minus: [Key; 2]| {
            let held = |keys: [Key; 2]| f64::from(u8::from(keys.iter().any(|&key| input.key_down(key))));
            fast * (held(plus) - held(minus))
        };
        [
            way([Key::D, Key::ArrowRight], [Key::A, Key::ArrowLeft]),
            way([Key::E, Key::PageUp], [Key::Q, Key::PageDown]),
            way([Key::W, Key::ArrowUp], [Key::S, Key::ArrowDown]),
        ]
    })
}
