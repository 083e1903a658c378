//! A point of light as plain data: a runway light, a street lamp, a lamp on a mast.
//!
//! Frame: [`crate::frame`]. A light has a plan point (x, z) and a height above the ground query there, so it stands on
//! the one ground whatever asks. Intensities are in candela, in the middle of the beam; colours are linear with the
//! brightest channel 1.

use crate::ground::Area;
use glam::{DVec2, DVec3};

/// Variable white: a halogen lamp's.
pub const WHITE: [f32; 3] = [1.0, 0.86, 0.62];
/// Aviation yellow.
pub const YELLOW: [f32; 3] = [1.0, 0.62, 0.05];
/// Aviation red.
pub const RED: [f32; 3] = [1.0, 0.04, 0.02];
/// Aviation green.
pub const GREEN: [f32; 3] = [0.04, 1.0, 0.35];
/// Aviation blue.
pub const BLUE: [f32; 3] = [0.06, 0.16, 1.0];
/// A side that is dark.
pub const DARK: [f32; 3] = [0.0; 3];
/// High-pressure sodium, as street lamps are.
pub const SODIUM: [f32; 3] = [1.0, 0.55, 0.16];
/// White of a street or flood lamp with LEDs.
pub const COOL: [f32; 3] = [1.0, 0.93, 0.80];

/// When a light is lit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Lit {
    /// By day as well: what an approach is flown by.
    Always,
    /// In the dark and in poor visibility: the rest of an airfield, obstructions.
    Dusk,
}

/// How a light shines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Beam {
    /// Alike all around.
    Even,
    /// `colour` along the axis, `back` the other way; half as bright at the half angles.
    TwoSided,
    /// `colour` all around but where a [`Beam::TwoSided`] light of the same axis and half angles shines: what goes past its
    /// lenses.
    Beside,
    /// `colour` above the axis' elevation and `back` below it, over a transition of this whole angle, radians.
    Slope {
        /// From one colour to the other.
        transition_rad: f32,
    },
    /// Two opposite beams that turn about the vertical: `colour` and `back` by turns.
    Turning {
        /// Time of a whole turn, seconds.
        period_s: f32,
    },
}

/// See the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightPoint {
    /// Plan point.
    pub at: DVec2,
    /// Above the ground there, metres.
    pub above_m: f32,
    /// Colour in front.
    pub colour: [f32; 3],
    /// Colour behind, below, or of the other beam (see [`Beam`]).
    pub back: [f32; 3],
    /// In the middle of the beam.
    pub intensity_cd: f32,
    /// Unit vector along the beam; of no meaning for an even light.
    pub axis: DVec3,
    /// Half angles across and upright at which half the intensity is left, radians.
    pub half_rad: [f32; 2],
    /// How it shines.
    pub beam: Beam,
    /// When it is lit.
    pub lit: Lit,
}

impl LightPoint {
    /// An even light for the dark.
    pub fn even(at: DVec2, above_m: f32, colour: [f32; 3], intensity_cd: f32) -> Self {
        Self {
            at,
            above_m,
            colour,
            back: colour,
            intensity_cd,
            axis: DVec3::Y,
            half_rad: [std::f32::consts::PI; 2],
            beam: Beam::Even,
            lit: Lit::Dusk,
        }
    }

    /// Height above sea level, metres; `None` where there is no ground.
    pub fn height_m(&self, area: &Area) -> Option<f64> {
        Some(area.height_m(self.at.x, self.at.y)? + f64::from(self.above_m))
    }

    /// Colour that an eye at a relative position sees, times the share of the intensity that goes there. The twin of
    /// `shaders/lights.wgsl`, for tests; a turning light is given at rest.
    pub fn towards(&self, eye_minus_light_m: DVec3) -> [f32; 3] {
        let to_eye = eye_minus_light_m;
        let up_rad = to_eye.y.atan2(to_eye.x.hypot(to_eye.z));
        let axis_up_rad = self.axis.y.atan2(self.axis.x.hypot(self.axis.z));
        let turn = |ahead: f64| {
            let across = self.axis.x * to_eye.z - self.axis.z * to_eye.x;
            across.atan2(ahead * (self.axis.x * to_eye.x + self.axis.z * to_eye.z)).abs()
        };
        let share = |across_rad: f64| {
            let a = across_rad / f64::from(self.half_rad[0]);
            let b = (up_rad - axis_up_rad) / f64::from(self.half_rad[1]);
            (-(a * a + b * b)).exp2() as f32
        };
        let scaled = |colour: [f32; 3], share: f32| colour.map(|channel| channel * share);
        match self.beam {
            Beam::Even => self.colour,
            Beam::TwoSided | Beam::Turning { .. } => {
                let (front, back) = (share(turn(1.0)), share(turn(-1.0)));
                if front >= back { scaled(self.colour, front) } else { scaled(self.back, back) }
            }
            Beam::Beside => scaled(self.colour, 1.0 - share(turn(1.0)).max(share(turn(-1.0)))),
            Beam::Slope { transition_rad } => {
                let t = ((up_rad - axis_up_rad) / f64::from(transition_rad) + 0.5).clamp(0.0, 1.0) as f32;
                let mixed: [f32; 3] = std::array::from_fn(|i| self.back[i] + t * (self.colour[i] - self.back[i]));
                let across = turn(1.0) / f64::from(self.half_rad[0]);
                scaled(mixed, (-(across * across)).exp2() as f32)
            }
        }
    }
}
