//! Light scattered in on the way from the ground, and the two grades of finding it.
//!
//! A point's light reaches the eye by the share that `haze_from_eye` gives, and over the same way the air adds light of its
//! own. By [`HazeGrade::Horizon`] that is the sky's radiance in the point's direction (below the horizon, the horizon's)
//! times what was taken away: one read of the sky table, right far away on the level. [`HazeGrade::Table`] integrates it
//! over distances, elevations and azimuths about the eye, by the same air and with the same steps as the sky, and keeps
//! light over what was taken away, which changes slowly; the shader multiplies by what was taken away, so that it is
//! exact at distance 0 and meets the sky where the ground fades. Colours are taken from the ground's own light by the
//! green share alone; what red and blue differ by is added here for ground of a mean albedo.
//!
//! Frame: flat ground about the eye, as the world is, the sun turning with the Earth's curvature.
//! Source: S. Hillaire 2020 (aerial perspective volume).

use super::{Air, HIGHEST_EYE_M, Light, PLANET_M, half, henyey_greenstein, rayleigh_phase};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Texels of the aerial table along azimuth (sine of half of it from the sun), elevation ([`aerial_elevation_sin`]) and
/// distance (square root of its share of the reach).
pub const AERIAL_SIZE: [u32; 3] = [12, 32, 24];
/// Least steps between two distances of the table; more where one goes through the haze's scale height in between.
const BETWEEN: usize = 3;
/// Most of them.
const MOST_BETWEEN: f32 = 48.0;
/// Albedo of ground whose light is coloured on the way.
const MEAN_ALBEDO: f32 = 0.15;

/// How light scattered on the way from the ground is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HazeGrade {
    /// The sky's radiance in the same direction.
    Horizon,
    /// Integrated, from a table.
    #[default]
    Table,
}

/// Sine of the elevation of a row of the table, `v` in 0..1: the horizon in the middle, finest there.
pub fn aerial_elevation_sin(v: f32) -> f32 {
    let t = 2.0 * v - 1.0;
    t * t * t * t * t.signum()
}

/// What one ray has gathered up to a distance.
#[derive(Clone, Copy)]
pub(super) struct Gathered {
    /// Light from the air, exposed as the sunlight is.
    pub light: Vec3,
    /// Optical depth.
    pub depth: Vec3,
}

impl Air {
    /// The aerial table for the light of an eye; `reach_m` is its greatest distance.
    pub fn aerial(&self, light: &Light, sun_elevation_rad: f64, eye_altitude_m: f64, reach_m: f64) -> Vec<u16> {
        let (sun_sin, sun_cos) = (sun_elevation_rad as f32).sin_cos();
        let sun = Vec3::new(sun_cos, sun_sin, 0.0);
        let eye_m = (eye_altitude_m as f32).clamp(10.0, HIGHEST_EYE_M);
        let ground = mean_ground(light, sun_sin) / light.exposure;
        let [width, height, slices] = AERIAL_SIZE.map(|count| count as usize);
        let mut table = vec![0; width * height * slices * 4];
        let distance_m = |slice: usize| {
            // Distance 0 is a limit, taken a little way off.
            let share = (slice as f32).max(0.25) / (slices - 1) as f32;
            reach_m as f32 * share * share
        };
        for row in 0..height {
            let rise = aerial_elevation_sin(row as f32 / (height - 1) as f32);
            let level = (1.0 - rise * rise).max(0.0).sqrt();
            for column in 0..width {
                let half_sin = column as f32 / (width - 1) as f32;
                let azimuth_cos = 1.0 - 2.0 * half_sin * half_sin;
                let azimuth_sin = (1.0 - azimuth_cos * azimuth_cos).max(0.0).sqrt();
                let direction = Vec3::new(level * azimuth_cos, rise, level * azimuth_sin);
                let mut so_far = Gathered { light: Vec3::ZERO, depth: Vec3::ZERO };
                let mut from_m = 0.0;
                for slice in 0..slices {
                    let to_m = distance_m(slice);
                    // Four steps a scale height: half the density's change within one is left to the rule of the middle.
                    let scales = (rise * (to_m - from_m)).abs() / self.haze_scale_m;
                    let steps = BETWEEN.max((4.0 * scales).min(MOST_BETWEEN) as usize);
                    so_far = self.march(so_far, direction, sun, eye_m, [from_m, to_m], steps);
                    from_m = to_m;
                    // What the night and the moon add to a hazy way tends to what they add to the horizon.
                    let tends = tends_to(&so_far, ground) + light.night_haze;
                    let value = (tends * light.exposure).max(Vec3::ZERO);
                    let texel = ((slice * height + row) * width + column) * 4;
                    table[texel..texel + 4].copy_from_slice(&[value.x, value.y, value.z, 1.0].map(half));
                }
            }
        }
        table
    }

    /// Gathers on from a distance to another in even steps, analytic within a step, over flat ground.
    pub(super) fn march(
        &self,
        mut so_far: Gathered,
        direction: Vec3,
        sun: Vec3,
        eye_m: f32,
        [from_m, to_m]: [f32; 2],
        steps: usize,
    ) -> Gathered {
        let cosine = direction.dot(sun);
        let (molecule_phase, haze_phase) = (rayleigh_phase(cosine), henyey_greenstein(cosine));
        let level = Vec2::new(direction.x, direction.z).length();
        let towards = if level > 0.0 { direction.x / level * sun.x } else { 0.0 };
        let step_m = (to_m - from_m) / steps as f32;
        for step in 0..steps {
            let at_m = from_m + (step as f32 + 0.5) * step_m;
            let height_m = (eye_m + direction.y * at_m).clamp(0.0, HIGHEST_EYE_M);
            // The sun is seen to sink or rise as one goes along the curved Earth.
            let turn = level * at_m / PLANET_M;
            let sun_sin = sun.y * (1.0 - 0.5 * turn * turn) + towards * turn;
            let (molecules, haze, extinction) = self.substance(height_m);
            let source = (molecules * molecule_phase + haze * haze_phase) * self.sunlight_at(height_m, sun_sin)
                + (molecules + haze) * self.orders_at(height_m, sun_sin);
            let passed = super::exp(-so_far.depth);
            so_far.light += passed * source * lost(extinction * step_m) / extinction.max(Vec3::splat(1e-12));
            so_far.depth += extinction * step_m;
        }
        so_far
    }
}

/// Share that is lost over an optical depth, with the digits that 1 - exp would lose.
fn lost(depth: Vec3) -> Vec3 {
    -Vec3::new((-depth.x).exp_m1(), (-depth.y).exp_m1(), (-depth.z).exp_m1())
}

/// What is gathered, and what the ground's light differs by from the green share of it, over what green loses.
pub(super) fn tends_to(gathered: &Gathered, ground: Vec3) -> Vec3 {
    let lost = lost(gathered.depth);
    (gathered.light + (Vec3::splat(lost.y) - lost) * ground) / lost.y.max(1e-9)
}

/// Radiance of level ground of the mean albedo, exposed.
pub(super) fn mean_ground(light: &Light, sun_sin: f32) -> Vec3 {
    (light.sun_irradiance * sun_sin.max(0.0) + light.sky_irradiance) * (MEAN_ALBEDO / PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_finest_at_the_horizon_and_reach_from_nadir_to_zenith() {
        assert_eq!(aerial_elevation_sin(0.0), -1.0);
        assert_eq!(aerial_elevation_sin(1.0), 1.0);
        // The twin in the shader: v = 0.5 + 0.5 sign(y) |y|^(1/4); two roundings of f32.
        for sine in [-0.9_f32, -0.02, 0.0, 0.001, 0.5] {
            let v = 0.5 + 0.5 * sine.signum() * sine.abs().sqrt().sqrt();
            assert!((aerial_elevation_sin(v) - sine).abs() < 2e-6, "{sine}");
        }
    }

    #[test]
    fn it_has_no_value_that_is_not_finite() {
        for visibility_m in [100.0, 300_000.0] {
            let air = Air::new(visibility_m, 600.0);
            for sun_deg in [70.0_f64, -1.0, -40.0] {
                let light = air.light(sun_deg.to_radians(), crate::moon::Moonlight::default(), 9_000.0);
                let table = air.aerial(&light, sun_deg.to_radians(), 9_000.0, 66_000.0);
                assert!(table.iter().all(|&bits| bits < 0x7bff), "{visibility_m} {sun_deg}");
            }
        }
    }
}
