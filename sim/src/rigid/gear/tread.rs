//! Where a contact holds the ground: the point that it held last and how far it was stretched there.
//!
//! Stretch is how far the contact stands from where it would pull nothing, along its rolling direction and across, metres.
//! While it neither slides nor rolls nothing of this changes, so that what stands does not creep. A wheel that rolls
//! forgets its stretch across over its relaxation length: across / rolled = slip angle / length, which is the side force
//! of a tyre of stiffness times length a radian.
//!
//! Source: H. B. Pacejka, Tire and Vehicle Dynamics, 2012, chapter 7 (relaxation length, stretched string).

use glam::DVec3;

/// See the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tread {
    /// The point held, north, east, down.
    pub at_m: DVec3,
    /// Stretch there: along the rolling direction, across to the right.
    pub stretch_m: [f64; 2],
}

/// Share of the relaxation length that may be rolled before the tread is taken anew.
const ROLLED: f64 = 1e-3;

impl Tread {
    /// A contact that just touched.
    pub fn new(at_m: DVec3) -> Self {
        Self { at_m, stretch_m: [0.0; 2] }
    }

    /// Stretch of a contact at a point now; `relaxation_m` is none for what does not roll.
    pub fn stretch_m(&self, at_m: DVec3, along: DVec3, across: DVec3, relaxation_m: Option<f64>) -> [f64; 2] {
        let moved = at_m - self.at_m;
        let (rolled, slid) = (moved.dot(along), moved.dot(across));
        let [first, second] = self.stretch_m;
        let Some(length_m) = relaxation_m else { return [first + rolled, second + slid] };
        let share = (rolled / length_m).abs();
        let left = (-share).exp();
        // (1 - exp(-a)) / a, which is 1 at rest.
        let mean = if share > 1e-9 { (1.0 - left) / share } else { 1.0 };
        [first + rolled, second * left + slid * mean]
    }

    /// Whether it has rolled so far that it should be taken anew.
    pub fn is_worn(&self, at_m: DVec3, along: DVec3, relaxation_m: Option<f64>) -> bool {
        relaxation_m.is_some_and(|length_m| ((at_m - self.at_m).dot(along) / length_m).abs() > ROLLED)
    }
}
