//! What to draw, as plain data: one scene, a list of views, the strokes drawn over the first view.
//!
//! Nothing here knows a simulation or a device. The frame of all positions is the world's (see `terrain::frame`).

use crate::camera::View;
use crate::passes::lines::Stroke;
use glam::DVec3;

/// Everything that one picture, or one set of pictures at one instant, is made from.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Light and air, common to all views.
    pub scene: Scene,
    /// The views; each is drawn to its own target.
    pub views: Vec<View>,
    /// Lines and text drawn over the first view.
    pub hud: Vec<Stroke>,
}

/// Light and air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Unit vector towards the sun, world axes (already turned by the grid's convergence).
    pub sun_direction: DVec3,
    /// Unit vector towards the moon, world axes; none where there is no moon. Its phase follows from the sun's place.
    pub moon_direction: Option<DVec3>,
    /// Distance at which a dark object on the level at `haze_base_m` has 2 % contrast (Koschmieder), metres.
    pub visibility_m: f64,
    /// Height above sea level that `visibility_m` holds at: the lowest ground of the scene, metres.
    pub haze_base_m: f64,
    /// Plan distance at which the ground has faded wholly into the sky, metres; the last 15 % are the fade.
    pub view_range_m: f64,
    /// Multiplies the exposure chosen from the light (see `sky::exposure`); 1 is neutral.
    pub exposure: f32,
    /// Whether what people light in the dark is lit: lamps, windows.
    pub lamps: bool,
    /// Scene time, seconds; drives only what moves by itself, such as ripples on water.
    pub time_s: f64,
}

impl Default for Scene {
    /// A clear day with the sun 40 degrees high in the south.
    fn default() -> Self {
        Self {
            sun_direction: terrain::frame::direction(std::f64::consts::PI, 40_f64.to_radians()),
            moon_direction: None,
            visibility_m: 60_000.0,
            haze_base_m: 0.0,
            view_range_m: 66_000.0,
            exposure: 1.0,
            lamps: true,
            time_s: 0.0,
        }
    }
}

impl Scene {
    /// The sun's elevation above the horizon, radians, without refraction.
    pub fn sun_elevation_rad(&self) -> f64 {
        self.sun_direction.y.clamp(-1.0, 1.0).asin()
    }

    /// The same scene with every number finite and inside its sensible range.
    ///
    /// Every consumer starts from this, so that no NaN reaches a shader whatever the caller gave.
    pub fn sane(&self) -> Self {
        let or = |value: f64, fallback: f64| if value.is_finite() { value } else { fallback };
        let fallback = Self::default();
        let sun = self.sun_direction;
        let usable = |towards: DVec3| towards.is_finite() && (1e-6..1e6).contains(&towards.length());
        Self {
            sun_direction: if usable(sun) { sun.normalize() } else { fallback.sun_direction },
            moon_direction: self.moon_direction.filter(|moon| usable(*moon)).map(DVec3::normalize),
            visibility_m: or(self.visibility_m, fallback.visibility_m).clamp(100.0, 300_000.0),
            haze_base_m: or(self.haze_base_m, 0.0).clamp(-12_000.0, 9_000.0),
            view_range_m: or(self.view_range_m, fallback.view_range_m).clamp(1_000.0, 1e7),
            lamps: self.lamps,
            exposure: if self.exposure.is_finite() { self.exposure.clamp(0.01, 100.0) } else { 1.0 },
            time_s: or(self.time_s, 0.0),
        }
    }
}
