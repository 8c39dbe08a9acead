//! A view as plain numbers, and back: to travel to where a model is.

use glam::{DVec3, DVec4};

use super::camera::{ErrorKind, Eye};
use super::object::ObjectView;

impl ObjectView {
    /// Numbers of a view.
    pub(crate) const NUMBERS: usize = 36;

    /// Returns the view as numbers, all finite but for reaches.
    pub(crate) fn to_numbers(&self) -> [f64; Self::NUMBERS] {
        let (kind, eye, forward, pixels) = match self.eye {
            Eye::At { eye, forward, pixels } => (0.0, eye, forward, pixels),
            Eye::Along { forward, pixels } => (1.0, DVec3::ZERO, forward, pixels),
        };
        let (focus, radius) = self.focus.unwrap_or((DVec3::ZERO, -1.0));
        let flags = f64::from(u8::from(self.error == ErrorKind::Parametric))
            + 2.0 * f64::from(u8::from(self.frustum))
            + 4.0 * f64::from(u8::from(self.back_faces));
        let head = [kind, pixels, self.plane_count as f64, self.reach, self.silhouette_reach, flags, radius];
        let places = [eye, forward, focus].map(|v| v.to_array());
        let planes = self.planes.map(|plane| plane.to_array());
        let all = head.iter().chain(places.as_flattened()).chain(planes.as_flattened());
        let mut numbers = [0.0; Self::NUMBERS];
        numbers.iter_mut().zip(all).for_each(|(to, from)| *to = *from);
        numbers
    }

    /// Returns the view of numbers; `None` if they are of no view.
    pub(crate) fn from_numbers(numbers: [f64; Self::NUMBERS]) -> Option<Self> {
        let [kind, pixels, plane_count, reach, silhouette_reach, flags, radius, places @ ..] = numbers;
        let place = |at: usize| DVec3::from_slice(&places[3 * at..]);
        let plane = |at: usize| DVec4::from_slice(&places[9 + 4 * at..]);
        let [eye, forward, focus] = [0, 1, 2].map(place);
        let is_number = |x: f64| !x.is_nan() && x >= 0.0;
        let sound = places.iter().all(|x| x.is_finite())
            && pixels.is_finite()
            && pixels > 0.0
            && is_number(reach)
            && is_number(silhouette_reach)
            && !radius.is_nan()
            && [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].contains(&plane_count)
            && (0..8).any(|known| f64::from(known) == flags)
            && (kind == 0.0 || kind == 1.0);
        let flags = flags as u8;
        sound.then(|| Self {
            eye: if kind == 0.0 { Eye::At { eye, forward, pixels } } else { Eye::Along { forward, pixels } },
            planes: std::array::from_fn(plane),
            plane_count: plane_count as usize,
            reach,
            silhouette_reach,
            error: if flags & 1 != 0 { ErrorKind::Parametric } else { ErrorKind::Geometric },
            frustum: flags & 2 != 0,
            back_faces: flags & 4 != 0,
            focus: (radius >= 0.0).then_some((focus, radius)),
        })
    }
}
