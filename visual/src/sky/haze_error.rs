//! How far each grade of haze is from the light that the same air scatters, integrated until nothing changes.
//!
//! The reference is single scattering and the estimate of all other orders, per colour, in 1,000 steps from the eye to a
//! point of level ground of the mean albedo at the haze base, with the ground's light behind it. A grade is evaluated as the shader does
//! it: the 16-bit tables between their texels, and one share of the ground's light for all colours.

use super::aerial::{AERIAL_SIZE, Gathered, mean_ground};
use super::{Air, HazeGrade, Light, TABLE_HEIGHT, TABLE_WIDTH};
use crate::moon::Moonlight;
use glam::Vec3;

/// Steps of the reference.
pub const STEPS: usize = 1_000;
/// Distances to the points, metres.
pub const DISTANCES_M: [f32; 7] = [1_000.0, 2_000.0, 5_000.0, 10_000.0, 20_000.0, 40_000.0, 72_000.0];
/// Heights of the eye above the ground, metres.
pub const HEIGHTS_M: [f64; 4] = [100.0, 1_000.0, 3_000.0, 9_000.0];
/// Elevations of the sun, degrees.
pub const SUNS_DEG: [f64; 4] = [60.0, 20.0, 5.0, -2.0];
/// Azimuths from the sun, degrees.
pub const AZIMUTHS_DEG: [f32; 3] = [0.0, 70.0, 180.0];

/// Relative error of radiance: the sum over the colours of the difference over the sum of the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HazeError {
    /// Over all points.
    pub mean: f64,
    /// The worst.
    pub max: f64,
    /// Points compared.
    pub points: usize,
}

/// The error of a grade in air of a visibility over ground at sea level, over all of the module's points.
pub fn haze_error(grade: HazeGrade, visibility_m: f64) -> HazeError {
    let air = Air::new(visibility_m, 0.0);
    let mut error = HazeError::default();
    for height_m in HEIGHTS_M {
        for sun_deg in SUNS_DEG {
            let sun_rad = sun_deg.to_radians();
            let mut light = air.light(sun_rad, Moonlight::default(), height_m);
            if grade == HazeGrade::Table {
                light.aerial = air.aerial(&light, sun_rad, height_m, 72_000.0);
            }
            for distance_m in DISTANCES_M.into_iter().filter(|distance_m| *distance_m > height_m as f32) {
                for azimuth_deg in AZIMUTHS_DEG {
                    let off = point_error(&air, &light, [height_m as f32, distance_m], sun_rad, azimuth_deg);
                    error.mean += f64::from(off);
                    error.max = error.max.max(f64::from(off));
                    error.points += 1;
                }
            }
        }
    }
    error.mean /= error.points.max(1) as f64;
    error
}

fn point_error(air: &Air, light: &Light, [eye_m, distance_m]: [f32; 2], sun_rad: f64, azimuth_deg: f32) -> f32 {
    let (sun_sin, sun_cos) = (sun_rad as f32).sin_cos();
    let sun = Vec3::new(sun_cos, sun_sin, 0.0);
    let rise = -eye_m / distance_m;
    let level = (1.0 - rise * rise).sqrt();
    let (azimuth_sin, azimuth_cos) = azimuth_deg.to_radians().sin_cos();
    let direction = Vec3::new(level * azimuth_cos, rise, level * azimuth_sin);
    let ground = mean_ground(light, sun_sin);

    let none = Gathered { light: Vec3::ZERO, depth: Vec3::ZERO };
    let all = air.march(none, direction, sun, eye_m, [0.0, distance_m], STEPS);
    let left = super::exp(-all.depth);
    // What the night adds is no part of the model that is checked: it is given to both.
    let night = light.night_haze * light.exposure * (Vec3::ONE - left);
    let reference = all.light * light.exposure + night + ground * left;

    let scattered = if light.aerial.is_empty() {
        sky_radiance(light, azimuth_cos)
    } else {
        aerial(light, direction, azimuth_cos, distance_m)
    };
    let shown = scattered * (1.0 - left.y) + ground * left.y;
    (shown - reference).abs().element_sum() / reference.element_sum().max(1e-12)
}

/// The twin of the shader's `sky_radiance` at and below the horizon.
fn sky_radiance(light: &Light, azimuth_cos: f32) -> Vec3 {
    let u = (0.5 - 0.5 * azimuth_cos).max(0.0).sqrt();
    let size = [TABLE_WIDTH as usize, TABLE_HEIGHT as usize, 1];
    between(&light.table, size, [u, 0.0, 0.0])
}

/// The twin of the shader's `scattered` with a table.
fn aerial(light: &Light, direction: Vec3, azimuth_cos: f32, distance_m: f32) -> Vec3 {
    let u = (0.5 - 0.5 * azimuth_cos).max(0.0).sqrt();
    let v = 0.5 + 0.5 * direction.y.signum() * direction.y.abs().sqrt().sqrt();
    let w = (distance_m / 72_000.0).min(1.0).sqrt();
    between(&light.aerial, AERIAL_SIZE.map(|count| count as usize), [u, v, w])
}

/// Linear between the texels of a table of halves.
fn between(table: &[u16], size: [usize; 3], at: [f32; 3]) -> Vec3 {
    let place: [(usize, f32); 3] = std::array::from_fn(|axis| {
        let t = at[axis].clamp(0.0, 1.0) * (size[axis] - 1) as f32;
        let cell = (t as usize).min(size[axis].saturating_sub(2));
        (cell, t - cell as f32)
    });
    let mut sum = Vec3::ZERO;
    for corner in 0..8 {
        let mut weight = 1.0;
        let mut index = [0; 3];
        for axis in 0..3 {
            let (cell, t) = place[axis];
            let upper = corner >> axis & 1;
            weight *= if upper == 1 { t } else { 1.0 - t };
            index[axis] = (cell + upper).min(size[axis] - 1);
        }
        let texel = ((index[2] * size[1] + index[1]) * size[0] + index[0]) * 4;
        let channel = |number: usize| whole(table.get(texel + number).copied().unwrap_or(0));
        sum += weight * Vec3::new(channel(0), channel(1), channel(2));
    }
    sum
}

/// The value of a 16-bit float that is not negative.
fn whole(bits: u16) -> f32 {
    if bits < 0x0400 { f32::from(bits) / 16_777_216.0 } else { f32::from_bits((u32::from(bits) << 13) + 0x3800_0000) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_read_back() {
        for value in [0.0, 1.0, 0.5, 0.333_251_95, 5.960_464_5e-8, 6.103_515_6e-5, 65_504.0] {
            assert_eq!(whole(super::super::half(value)), value);
        }
    }

    #[test]
    fn a_thousand_steps_have_converged() {
        let air = Air::new(20_000.0, 0.0);
        let (sin, cos) = 5_f32.to_radians().sin_cos();
        let sun = Vec3::new(cos, sin, 0.0);
        let none = Gathered { light: Vec3::ZERO, depth: Vec3::ZERO };
        let direction = Vec3::new(0.9, -0.1, 0.42).normalize();
        let gathered = |steps| air.march(none, direction, sun, 3_000.0, [0.0, 30_000.0], steps).light;
        let (half, all) = (gathered(STEPS / 2), gathered(STEPS));
        // The rule of the middle is of second order: halving the steps quarters what is left.
        assert!(((half - all) / all).abs().max_element() < 3e-5, "{half} {all}");
    }

    #[test]
    fn the_table_is_nearer_to_the_reference_than_the_horizon_is() {
        for visibility_m in [1_000.0, 5_000.0, 20_000.0, 60_000.0, 200_000.0] {
            let horizon = haze_error(HazeGrade::Horizon, visibility_m);
            let table = haze_error(HazeGrade::Table, visibility_m);
            println!("visibility {visibility_m} m: horizon {horizon:?}, table {table:?}");
            assert!(table.mean < 0.25 * horizon.mean, "{visibility_m}: {table:?}, {horizon:?}");
            // The least contrast that is seen, 2 % (Koschmieder's own threshold); in fog no detail is left to be judged by it.
            assert!(visibility_m < 5_000.0 || table.mean < 0.02, "{visibility_m}: {table:?}");
        }
    }
}
