//! The light of the sky and of the sun, computed on the processor from one model of the air.
//!
//! The air is a sphere of three substances: molecules (Rayleigh, scale height 8 km above sea level), haze (Mie, scale
//! height [`haze_scale_m`] above the scene's haze base, its amount set by the visibility) and ozone. The same
//! figures go to the shaders for the haze before the ground ([`crate::uniforms::FrameUniforms`]), so sky and haze agree.
//!
//! [`Air::new`] prepares what depends on the air alone: transmittance and an estimate of multiple scattering.
//! [`Air::light`] integrates single scattering with 40 steps a ray, spaced by squares from the eye, analytic within
//! a step, and adds the estimate: every order after the first taken as isotropic and summed as a geometric series.
//! By night the moon does the same, its light spread evenly over the azimuths so that the table stays symmetric.
//! The table covers elevations from the horizon up, half the azimuths (it is symmetric about the sun); whatever looks
//! below the horizon takes the horizon's value, so ground that fades into it meets the sky without a rim.
//!
//! Light is relative: the sun above the air gives an irradiance of 1, and everything handed out is already multiplied
//! by an exposure chosen from the light ([`Light::exposure`]), so that a table of 16-bit floats serves day and night. The
//! one thing beside it that is of the eye and not of the air: under a low sun half of the colour of the sky's light on the
//! ground is taken for white (chromatic adaptation); the sky itself keeps its colours.
//!
//! Sources: T. Nishita et al., Display of the Earth taking into account atmospheric scattering, 1993 (single
//! scattering); S. Hillaire, A scalable and production ready sky and atmosphere rendering technique, 2020 (series and
//! coefficients); E. Bruneton, Precomputed atmospheric scattering, 2017 (table axes); H. Koschmieder, 1924 (visibility).

mod aerial;
mod haze_error;

pub use aerial::{AERIAL_SIZE, HazeGrade};
pub use haze_error::{HazeError, haze_error};

use crate::moon::Moonlight;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Columns of the sky table: sine of half the azimuth from the sun, 0 to 1.
pub const TABLE_WIDTH: u32 = 128;
/// Rows of the sky table: square root of the sine of the elevation, 0 at the horizon, 1 straight up.
pub const TABLE_HEIGHT: u32 = 64;
/// Steps of one ray of the table, by day.
pub const RAY_STEPS: usize = 40;
/// Height over which haze thins by a factor e in good visibility, metres: between 1.2 km (clean sea-level air) and the
/// 3 km and more of a well mixed summer layer over dry land.
const HAZE_SCALE_M: f32 = 2_000.0;
/// The same in fog: a layer that one looks out of from a few hundred metres up (radiation fog is 15 to 300 m deep).
const FOG_SCALE_M: f32 = 100.0;
/// Visibilities between which a fog becomes a haze, metres: the definition of fog, and of haze that is no longer mist.
const FOG_TO_HAZE_M: [f64; 2] = [1_000.0, 8_000.0];
/// Height over which molecules thin by a factor e, metres.
pub const MOLECULE_SCALE_HEIGHT_M: f32 = 8_000.0;
/// Scattering by molecules at sea level, per metre, for red, green, blue: Bucholtz's 1.2406e-6 over the fourth power of the
/// wavelength in micrometres, at [the display's own](OZONE_PER_M).
pub const MOLECULES_PER_M: Vec3 = Vec3::new(8.90e-6, 13.558e-6, 26.8e-6);
/// Optical depth at which contrast is 2 %.
pub const KOSCHMIEDER: f32 = 3.912;

/// Shares of red, green and blue in luminance (IEC 61966-2-1).
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Absorption by ozone at its densest, per metre, at 611, 550 and 464 nm, where the display's primaries lie (IEC 61966-2-1: the
/// dominant wavelengths). The usual red of 680 nm is beyond ozone's band, which takes yellow, orange and red alike: with it
/// twilight, whose light goes a long way through ozone, loses its green alone and turns purple instead of blue.
/// Cross-sections: 4.25e-25, 3.50e-25 and 0.42e-25 m2 (V. Gorshelev, A. Serdyuchenko 2014).
const OZONE_PER_M: Vec3 = Vec3::new(2.284e-6, 1.881e-6, 0.226e-6);
const HAZE_ALBEDO: f32 = 0.9;
/// Below the usual 0.8, which one lobe needs to match the glow within a few degrees of the sun but which makes the sky
/// too bright at 10 to 30 degrees; the pass draws the close glow itself.
const HAZE_FORWARD: f32 = 0.7;
const PLANET_M: f32 = 6_360_000.0;
const AIR_M: f32 = 100_000.0;
const HIGHEST_EYE_M: f32 = 60_000.0;
const GROUND_ALBEDO: f32 = 0.3;
/// Starlight and airglow, far above nature's so that a screen can show it.
const NIGHT: Vec3 = Vec3::new(1.0e-6, 1.4e-6, 2.3e-6);
/// What the ground gets by night beside that: the eye adapted to the dark sees the ground, a screen's black would not show it.
const NIGHT_GROUND: Vec3 = Vec3::new(2.4e-5, 3.0e-5, 4.2e-5);
/// Irradiance by the full moon above the air, above nature's 2e-6 as [`NIGHT`] is but less so; bluish, as an eye sees it
/// that has few cones left.
const FULL_MOON: Vec3 = Vec3::new(2.5e-4, 3.0e-4, 3.8e-4);
/// Radiance of the full moon's disc: nature's (0.25 lux of the sun's 133,000 over 6.4e-5 sr).
const MOON_RADIANCE: f32 = 0.03;
/// Illuminance by the sun above the air, lux: what an irradiance of 1 is (683 lm/W, 98 lm/W of 1,361 W/m2).
pub const SUN_LUX: f32 = 133_000.0;
/// Sunlit ground is lit as seen from this far above the haze base, metres; in fog from half its scale, or from the eye
/// above it: what an eye above a fog sees of the ground stands out of it.
const SURFACE_ABOVE_BASE_M: f32 = 1_000.0;

const SUN_COLUMNS: usize = 128;
const SUN_ROWS: usize = 32;
const ORDERS_COLUMNS: usize = 24;
const ORDERS_ROWS: usize = 12;

/// The air of a scene, with what depends on it alone.
#[derive(Clone)]
pub struct Air {
    base_m: f32,
    haze_per_m: f32,
    haze_scale_m: f32,
    /// What is left of sunlight, by height and sun.
    sunlight: Vec<Vec3>,
    /// Radiance scattered into any direction by all orders after the first, per unit of scattering, by height and sun.
    orders: Vec<Vec3>,
}

/// What the sky and the sun give, exposed.
#[derive(Clone)]
pub struct Light {
    /// Sky radiance, `TABLE_WIDTH` x `TABLE_HEIGHT` texels of four 16-bit floats, first row at the horizon.
    pub table: Vec<u16>,
    /// Irradiance by the sun on a surface turned to it, near the ground.
    pub sun_irradiance: Vec3,
    /// Irradiance by the whole sky on level ground.
    pub sky_irradiance: Vec3,
    /// Colour of the sun's disc seen from the eye, brightest channel 1; zero where the planet hides it.
    pub disc: Vec3,
    /// Irradiance by the moon on a surface turned to it, near the ground.
    pub moon_irradiance: Vec3,
    /// Radiance of the moon's lit side seen from the eye, by the strength of its light.
    pub moon_disc: Vec3,
    /// What night and moon add to the radiance at the horizon, the one thing here that is not exposed.
    pub night_haze: Vec3,
    /// Aerial table, [`AERIAL_SIZE`] texels of four 16-bit floats; empty where there is none.
    pub aerial: Vec<u16>,
    /// What all of the above is multiplied by already.
    pub exposure: f32,
    /// Least illuminance that makes a point of light seen by an eye adapted to this, lux.
    pub threshold_lux: f32,
}

impl Light {
    /// No light at all, not exposed.
    pub fn none() -> Self {
        Self {
            table: Vec::new(),
            sun_irradiance: Vec3::ZERO,
            sky_irradiance: Vec3::ZERO,
            disc: Vec3::ZERO,
            moon_irradiance: Vec3::ZERO,
            moon_disc: Vec3::ZERO,
            night_haze: Vec3::ZERO,
            aerial: Vec::new(),
            exposure: 1.0,
            threshold_lux: threshold_lux(Vec3::ZERO),
        }
    }
}

/// One step of a ray, without what depends on the azimuth.
struct Step {
    /// Unit vector from the planet's centre: level along the ray, and up at the eye.
    outward: Vec2,
    height_m: f32,
    molecules: Vec3,
    haze: Vec3,
    /// Share of light scattered here that reaches the eye, times the length, metres.
    weight: Vec3,
}

impl Air {
    /// Prepares air with a visibility at a base height, both metres (a sane [`crate::frame::Scene`]'s).
    pub fn new(visibility_m: f64, haze_base_m: f64) -> Self {
        let mut air = Self {
            base_m: haze_base_m as f32,
            haze_per_m: haze_per_m(visibility_m, haze_base_m),
            haze_scale_m: haze_scale_m(visibility_m),
            sunlight: Vec::new(),
            orders: Vec::new(),
        };
        air.sunlight = air.fill_sunlight();
        air.orders = air.fill_orders();
        air
    }

    /// Light for a sun elevation (radians), a moon and an eye's altitude above sea level (metres).
    pub fn light(&self, sun_elevation_rad: f64, moon: Moonlight, eye_altitude_m: f64) -> Light {
        let (sun_sin, sun_cos) = (sun_elevation_rad as f32).sin_cos();
        let sun = Vec3::new(sun_cos, sun_sin, 0.0);
        let eye_m = (eye_altitude_m as f32).clamp(10.0, HIGHEST_EYE_M);
        let least_m = SURFACE_ABOVE_BASE_M.min(0.5 * self.haze_scale_m);
        let above_m = (eye_m - self.base_m).clamp(least_m, SURFACE_ABOVE_BASE_M);
        let surface_m = (self.base_m + above_m).clamp(10.0, HIGHEST_EYE_M);
        let moon_sin = moon.elevation_rad.sin() as f32;
        let moon_above = FULL_MOON * moon.share as f32;

        let sun_irradiance = self.sunlight_at(surface_m, sun_sin);
        let moon_irradiance = self.sunlight_at(surface_m, moon_sin) * moon_above;
        let moonlit = |height_m, elevation_sin, steps| {
            if moon.share > 0.0 {
                self.moonlit(&self.ray(height_m, elevation_sin, steps), elevation_sin, moon)
            } else {
                Vec3::ZERO
            }
        };
        let sky_irradiance = adapted(self.sky_irradiance(surface_m, sun), sun_sin);
        let sky_irradiance = sky_irradiance + NIGHT_GROUND + moonlit(surface_m, 0.7, 20) * PI;
        let all = sun_irradiance * sun_sin.max(0.6) + sky_irradiance + moon_irradiance * moon_sin.max(0.0);
        let exposure = exposure(all);

        // The edge of the Earth's shadow falls between steps: more of them make it smooth.
        let steps = if sun_sin < 0.05 { 3 * RAY_STEPS } else { RAY_STEPS };
        let mut table = Vec::with_capacity((TABLE_WIDTH * TABLE_HEIGHT * 4) as usize);
        for row in 0..TABLE_HEIGHT {
            let elevation_sin = (row as f32 / (TABLE_HEIGHT - 1) as f32).powi(2);
            let level = (1.0 - elevation_sin * elevation_sin).max(0.0).sqrt();
            let ray = self.ray(eye_m, elevation_sin, steps);
            let moonlit = if moon.share > 0.0 { self.moonlit(&ray, elevation_sin, moon) } else { Vec3::ZERO };
            for column in 0..TABLE_WIDTH {
                let half_sin = column as f32 / (TABLE_WIDTH - 1) as f32;
                let azimuth_cos = 1.0 - 2.0 * half_sin * half_sin;
                let azimuth_sin = (1.0 - azimuth_cos * azimuth_cos).max(0.0).sqrt();
                let direction = Vec3::new(level * azimuth_cos, elevation_sin, level * azimuth_sin);
                let radiance = (self.gather(&ray, direction, sun) + moonlit) * exposure;
                table.extend([radiance.x, radiance.y, radiance.z, 1.0].map(half));
            }
        }
        let seen = self.sunlight_at(eye_m, sun_sin);
        let brightest = seen.max_element();
        let disc = if brightest > 1e-9 { seen / brightest * (brightest * 50.0).min(1.0) } else { Vec3::ZERO };
        Light {
            table,
            sun_irradiance: sun_irradiance * exposure,
            sky_irradiance: sky_irradiance * exposure,
            disc,
            moon_irradiance: moon_irradiance * exposure,
            // Beyond 3 the display is white.
            moon_disc: self.sunlight_at(eye_m, moon_sin) * (MOON_RADIANCE * exposure).min(3.0),
            night_haze: NIGHT * 2.5 + moonlit(eye_m, 0.0, RAY_STEPS),
            aerial: Vec::new(),
            exposure,
            threshold_lux: threshold_lux(all),
        }
    }

    /// The steps of a ray from a height (metres) at or above the horizon: all that does not depend on the azimuth.
    fn ray(&self, height_m: f32, elevation_sin: f32, steps: usize) -> Vec<Step> {
        let eye_m = PLANET_M + height_m;
        let level = (1.0 - elevation_sin * elevation_sin).max(0.0).sqrt();
        let end_m = to_top_m(eye_m, elevation_sin);
        let mut passed = Vec3::ONE;
        let mut from_m = 0.0;
        let step = |number: usize| {
            let to_m = end_m * ((number + 1) as f32 / steps as f32).powi(2);
            let at_m = 0.5 * (from_m + to_m);
            let point = Vec2::new(level * at_m, eye_m + elevation_sin * at_m);
            let radius_m = point.length();
            let (molecules, haze, extinction) = self.substance(radius_m - PLANET_M);
            let through = exp(-extinction * (to_m - from_m));
            // The source is even within a step, extinction is not neglected: exact for even air.
            let weight = passed * (Vec3::ONE - through) / extinction.max(Vec3::splat(1e-12));
            passed *= through;
            from_m = to_m;
            Step { outward: point / radius_m, height_m: radius_m - PLANET_M, molecules, haze, weight }
        };
        (0..steps).map(step).collect()
    }

    /// Sky radiance along a ray in the direction whose steps are given, the sun being in the x-y plane.
    fn gather(&self, ray: &[Step], direction: Vec3, sun: Vec3) -> Vec3 {
        // Airglow is seen through more air, and so brighter, near the horizon.
        self.scattered(ray, direction, sun) + NIGHT * (1.0 + 1.5 * (1.0 - direction.y.max(0.0)).powi(4))
    }

    /// The part of it that comes from the sun.
    fn scattered(&self, ray: &[Step], direction: Vec3, sun: Vec3) -> Vec3 {
        let cosine = direction.dot(sun);
        let (molecule_phase, haze_phase) = (rayleigh_phase(cosine), henyey_greenstein(cosine));
        // Cosine of the azimuth from the sun, times the cosine of the sun's elevation.
        let level = Vec2::new(direction.x, direction.z).length();
        let towards = if level > 0.0 { direction.x / level * sun.x } else { 0.0 };
        let mut sum = Vec3::ZERO;
        for step in ray {
            let sun_sin = step.outward.x * towards + step.outward.y * sun.y;
            let source = (step.molecules * molecule_phase + step.haze * haze_phase)
                * self.sunlight_at(step.height_m, sun_sin)
                + (step.molecules + step.haze) * self.orders_at(step.height_m, sun_sin);
            sum += step.weight * source;
        }
        sum
    }

    /// Radiance of moonlit air along a ray that rises by a sine, the mean over the azimuths of the moon.
    fn moonlit(&self, ray: &[Step], elevation_sin: f32, moon: Moonlight) -> Vec3 {
        const SPOKES: usize = 4;
        let (sin, cos) = (moon.elevation_rad as f32).sin_cos();
        let level = (1.0 - elevation_sin * elevation_sin).max(0.0).sqrt();
        let around = (0..SPOKES).map(|spoke| {
            let (azimuth_sin, azimuth_cos) = (PI * (spoke as f32 + 0.5) / SPOKES as f32).sin_cos();
            let direction = Vec3::new(level * azimuth_cos, elevation_sin, level * azimuth_sin);
            self.scattered(ray, direction, Vec3::new(cos, sin, 0.0))
        });
        around.sum::<Vec3>() / SPOKES as f32 * FULL_MOON * moon.share as f32
    }

    fn sky_irradiance(&self, height_m: f32, sun: Vec3) -> Vec3 {
        const RINGS: usize = 8;
        const SPOKES: usize = 12;
        let mut sum = Vec3::ZERO;
        for ring in 0..RINGS {
            // Even in the square of the sine: each ring then has the same weight of cosine times solid angle.
            let elevation_sin = ((ring as f32 + 0.5) / RINGS as f32).sqrt();
            let level = (1.0 - elevation_sin * elevation_sin).sqrt();
            let ray = self.ray(height_m, elevation_sin, 20);
            for spoke in 0..SPOKES {
                let (sin, cos) = (PI * (spoke as f32 + 0.5) / SPOKES as f32).sin_cos();
                sum += self.gather(&ray, Vec3::new(level * cos, elevation_sin, level * sin), sun);
            }
        }
        sum * (PI / (RINGS * SPOKES) as f32)
    }

    /// Scattering by molecules and by haze, and all extinction, per metre at a height.
    fn substance(&self, height_m: f32) -> (Vec3, Vec3, Vec3) {
        let height_m = height_m.max(0.0);
        let molecules = MOLECULES_PER_M * (-height_m / MOLECULE_SCALE_HEIGHT_M).exp();
        let haze = self.haze_per_m * (-(height_m - self.base_m).max(0.0) / self.haze_scale_m).exp();
        let ozone = OZONE_PER_M * (1.0 - (height_m - 25_000.0).abs() / 15_000.0).max(0.0);
        (molecules, Vec3::splat(haze * HAZE_ALBEDO), molecules + Vec3::splat(haze) + ozone)
    }

    /// What is left of the sun's light at a height when the sun has this sine of elevation there; 0 behind the planet.
    fn sunlight_at(&self, height_m: f32, sun_sin: f32) -> Vec3 {
        let radius_m = PLANET_M + height_m.clamp(1.0, AIR_M - 1.0);
        // The disc sets over half a degree.
        let horizon = -(1.0 - (PLANET_M / radius_m).powi(2)).max(0.0).sqrt();
        let risen = ((sun_sin - horizon) / 0.0093 + 0.5).clamp(0.0, 1.0);
        if risen == 0.0 {
            return Vec3::ZERO;
        }
        let (u, v) = sunlight_axes(radius_m, sun_sin.max(horizon));
        sample(&self.sunlight, SUN_COLUMNS, SUN_ROWS, u, v) * (risen * risen * (3.0 - 2.0 * risen))
    }

    fn orders_at(&self, height_m: f32, sun_sin: f32) -> Vec3 {
        let u = ((sun_sin + 0.25) / 1.25).clamp(0.0, 1.0);
        let v = (height_m.max(0.0) / HIGHEST_EYE_M).sqrt().min(1.0);
        sample(&self.orders, ORDERS_COLUMNS, ORDERS_ROWS, u, v)
    }

    fn fill_sunlight(&self) -> Vec<Vec3> {
        let top_m = PLANET_M + AIR_M;
        let reach_m = (top_m * top_m - PLANET_M * PLANET_M).sqrt();
        grid(SUN_COLUMNS, SUN_ROWS, |u, v| {
            let rho_m = reach_m * v;
            let radius_m = (rho_m * rho_m + PLANET_M * PLANET_M).sqrt();
            let (least_m, most_m) = (top_m - radius_m, rho_m + reach_m);
            let far_m = least_m + u * (most_m - least_m);
            let sine = if far_m > 0.0 {
                ((reach_m * reach_m - rho_m * rho_m - far_m * far_m) / (2.0 * radius_m * far_m)).clamp(-1.0, 1.0)
            } else {
                1.0
            };
            let mut depth = Vec3::ZERO;
            let mut from_m = 0.0;
            for step in 0..RAY_STEPS {
                let to_m = far_m * ((step + 1) as f32 / RAY_STEPS as f32).powi(2);
                let at_m = 0.5 * (from_m + to_m);
                let height_m =
                    (radius_m * radius_m + at_m * at_m + 2.0 * radius_m * at_m * sine).max(0.0).sqrt() - PLANET_M;
                depth += self.substance(height_m).2 * (to_m - from_m);
                from_m = to_m;
            }
            exp(-depth)
        })
    }

    fn fill_orders(&self) -> Vec<Vec3> {
        const RINGS: usize = 8;
        const SPOKES: usize = 4;
        const STEPS: usize = 12;
        grid(ORDERS_COLUMNS, ORDERS_ROWS, |u, v| {
            let sun_sin = u * 1.25 - 0.25;
            let sun = Vec3::new((1.0 - sun_sin * sun_sin).max(0.0).sqrt(), sun_sin, 0.0);
            let radius_m = PLANET_M + (HIGHEST_EYE_M * v * v).max(10.0);
            let (mut second, mut returned) = (Vec3::ZERO, Vec3::ZERO);
            for ring in 0..RINGS {
                let sine = (ring as f32 + 0.5) / RINGS as f32 * 2.0 - 1.0;
                let level = (1.0 - sine * sine).sqrt();
                let ground_m = to_ground_m(radius_m, sine);
                let end_m = ground_m.unwrap_or_else(|| to_top_m(radius_m, sine));
                for spoke in 0..SPOKES {
                    let (azimuth_sin, azimuth_cos) = (PI * (spoke as f32 + 0.5) / SPOKES as f32).sin_cos();
                    let direction = Vec3::new(level * azimuth_cos, sine, level * azimuth_sin);
                    let mut passed = Vec3::ONE;
                    let mut from_m = 0.0;
                    for step in 0..STEPS {
                        let to_m = end_m * ((step + 1) as f32 / STEPS as f32).powi(2);
                        let point = Vec3::new(0.0, radius_m, 0.0) + direction * (0.5 * (from_m + to_m));
                        let length_m = point.length();
                        let (molecules, haze, extinction) = self.substance(length_m - PLANET_M);
                        let through = exp(-extinction * (to_m - from_m));
                        let weight =
                            passed * (molecules + haze) * (Vec3::ONE - through) / extinction.max(Vec3::splat(1e-12));
                        let sunlight = self.sunlight_at(length_m - PLANET_M, point.dot(sun) / length_m);
                        second += weight * sunlight / (2.0 * TAU);
                        returned += weight;
                        passed *= through;
                        from_m = to_m;
                    }
                    if ground_m.is_some() {
                        let point = (Vec3::new(0.0, radius_m, 0.0) + direction * end_m).normalize();
                        let lit = point.dot(sun).max(0.0) * GROUND_ALBEDO / PI;
                        second += passed * self.sunlight_at(1.0, point.dot(sun)) * lit;
                    }
                }
            }
            let rays = (RINGS * SPOKES) as f32;
            // The series 1 + f + f^2 + ...; f stays below 1 because some light always leaves or is absorbed.
            second / rays / (Vec3::ONE - (returned / rays).min(Vec3::splat(0.97)))
        })
    }
}

/// Extinction by haze at its base, per metre, so that with the molecules there green light has the visibility.
pub fn haze_per_m(visibility_m: f64, haze_base_m: f64) -> f32 {
    (KOSCHMIEDER / visibility_m as f32 - molecules_at(haze_base_m as f32)).max(1e-6)
}

/// Height over which haze thins by a factor e in a visibility, metres: a fog is shallow, a haze deep. Even in logarithms.
pub fn haze_scale_m(visibility_m: f64) -> f32 {
    let [fog_m, haze_m] = FOG_TO_HAZE_M;
    let share = ((visibility_m / fog_m).ln() / (haze_m / fog_m).ln()).clamp(0.0, 1.0) as f32;
    FOG_SCALE_M * (HAZE_SCALE_M / FOG_SCALE_M).powf(share)
}

/// Share of fog in a visibility: 1 in fog, 0 in haze and clear air, as [`haze_scale_m`] goes.
pub fn fog_share(visibility_m: f64) -> f64 {
    let [fog_m, haze_m] = FOG_TO_HAZE_M;
    1.0 - ((visibility_m / fog_m).ln() / (haze_m / fog_m).ln()).clamp(0.0, 1.0)
}

/// Share of lamps and windows that are lit under a sun at an elevation, radians: they come on one after another about two
/// degrees under the horizon.
pub fn lamps(sun_elevation_rad: f64) -> f32 {
    ((-1.5 - sun_elevation_rad.to_degrees()) / 1.5).clamp(0.0, 1.0) as f32
}

/// Least illuminance at the eye that makes a point of light seen before a background lit by an irradiance, lux.
///
/// Source: ICAO Annex 3, attachment D: log10 E = 0.57 log10 B + 0.05 (log10 B)^2 - 6.66, B the luminance in cd/m2; by night
/// not below IALA's 2e-7 lux (recommendation R0202).
pub fn threshold_lux(irradiance: Vec3) -> f32 {
    const ALBEDO: f32 = 0.25;
    let luminance = irradiance.dot(LUMINANCE) * SUN_LUX * ALBEDO / PI;
    let b = luminance.max(1e-3).log10();
    10f32.powf(0.57 * b + 0.05 * b * b - 6.66).clamp(2e-7, 1e-2)
}

/// Extinction of green light by molecules at a height, per metre.
pub fn molecules_at(height_m: f32) -> f32 {
    MOLECULES_PER_M.y * (-height_m.max(0.0) / MOLECULE_SCALE_HEIGHT_M).exp()
}

/// Exposure for an irradiance on ground that faces the light somewhat: the eye adapts to most of a change, not to all;
/// from deep dusk on to all of it, so that night is dark by its sky and shadows and its ground stays readable.
pub fn exposure(irradiance: Vec3) -> f32 {
    const DEEP_DUSK: f32 = 0.01;
    let luminance = irradiance.dot(LUMINANCE).max(1e-7);
    3.1 * luminance.max(DEEP_DUSK).powf(-0.6) * (luminance / DEEP_DUSK).min(1.0).powf(-1.0)
}

/// Light of the whole sky as an eye adapted to it sees it: under a low sun, where it is all the light there is, half as far
/// from white as it is. By day the sun decides what white is.
fn adapted(sky: Vec3, sun_sin: f32) -> Vec3 {
    const SHARE: f32 = 0.5;
    let low = ((0.12 - sun_sin) / 0.14).clamp(0.0, 1.0);
    sky.lerp(Vec3::splat(sky.dot(LUMINANCE)), SHARE * low)
}

fn rayleigh_phase(cosine: f32) -> f32 {
    3.0 / (16.0 * PI) * (1.0 + cosine * cosine)
}

/// Cornette and Shanks' form, as the thesis gives it, normalised over the sphere.
fn henyey_greenstein(cosine: f32) -> f32 {
    let g = HAZE_FORWARD;
    let spread = 1.0 + g * g - 2.0 * g * cosine;
    3.0 * (1.0 - g * g) * (1.0 + cosine * cosine) / (8.0 * PI * (2.0 + g * g) * spread * spread.sqrt())
}

fn exp(v: Vec3) -> Vec3 {
    Vec3::new(v.x.exp(), v.y.exp(), v.z.exp())
}

/// Distance along a ray to the top of the air, metres.
fn to_top_m(radius_m: f32, sine: f32) -> f32 {
    let top_m = PLANET_M + AIR_M;
    // (top - r)(top + r) keeps the digits that top^2 - r^2 would lose.
    let b = radius_m * sine;
    (b * b + (top_m - radius_m) * (top_m + radius_m)).max(0.0).sqrt() - b
}

fn to_ground_m(radius_m: f32, sine: f32) -> Option<f32> {
    let b = radius_m * sine;
    let inside = b * b - (radius_m - PLANET_M) * (radius_m + PLANET_M);
    (sine < 0.0 && inside >= 0.0).then(|| (-b - inside.sqrt()).max(0.0))
}

fn sunlight_axes(radius_m: f32, sine: f32) -> (f32, f32) {
    let top_m = PLANET_M + AIR_M;
    let reach_m = (top_m * top_m - PLANET_M * PLANET_M).sqrt();
    let rho_m = ((radius_m - PLANET_M) * (radius_m + PLANET_M)).max(0.0).sqrt();
    let (least_m, most_m) = (top_m - radius_m, rho_m + reach_m);
    ((to_top_m(radius_m, sine) - least_m) / (most_m - least_m), rho_m / reach_m)
}

fn grid(columns: usize, rows: usize, value: impl Fn(f32, f32) -> Vec3) -> Vec<Vec3> {
    let mut all = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            all.push(value(column as f32 / (columns - 1) as f32, row as f32 / (rows - 1) as f32));
        }
    }
    all
}

fn sample(table: &[Vec3], columns: usize, rows: usize, u: f32, v: f32) -> Vec3 {
    let along = |t: f32, count: usize| {
        let at = t.clamp(0.0, 1.0) * (count - 1) as f32;
        let cell = (at as usize).min(count - 2);
        (cell, at - cell as f32)
    };
    let ((column, x), (row, y)) = (along(u, columns), along(v, rows));
    let at = |row: usize, column: usize| table.get(row * columns + column).copied().unwrap_or(Vec3::ZERO);
    let low = at(row, column).lerp(at(row, column + 1), x);
    let high = at(row + 1, column).lerp(at(row + 1, column + 1), x);
    low.lerp(high, y)
}

/// A 16-bit float nearest to a value that is not negative; NaN becomes 0, too large becomes the largest.
pub(crate) fn half(value: f32) -> u16 {
    if value.is_nan() || value <= 0.0 {
        return 0;
    }
    let value = value.min(65_504.0);
    if value < 6.103_515_6e-5 {
        // Subnormal: a multiple of 2^-24. Rounding up to 1024 gives the first normal number, as it should.
        return (value * 16_777_216.0).round() as u16;
    }
    let bits = value.to_bits();
    // Rebias the exponent from 127 to 15 and drop 13 digits, to nearest.
    let rounded = bits + 0x0fff + ((bits >> 13) & 1);
    ((rounded - 0x3800_0000) >> 13) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_those_of_ieee_754() {
        let known: [(f32, u16); 9] = [
            (0.0, 0),
            (1.0, 0x3c00),
            (0.5, 0x3800),
            (65_504.0, 0x7bff),
            (1e9, 0x7bff),
            (6.103_515_6e-5, 0x0400),
            (5.960_464_5e-8, 0x0001),
            (0.333_251_95, 0x3555),
            (f32::NAN, 0),
        ];
        for (value, bits) in known {
            assert_eq!(half(value), bits, "{value}");
        }
    }

    #[test]
    fn phases_scatter_as_much_as_they_receive() {
        for phase in [rayleigh_phase, henyey_greenstein] {
            let steps = 20_000;
            let sum: f64 =
                (0..steps).map(|i| f64::from(phase((i as f32 + 0.5) / steps as f32 * 2.0 - 1.0))).sum::<f64>()
                    * (2.0 / f64::from(steps))
                    * std::f64::consts::TAU;
            assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        }
    }

    #[test]
    fn forty_steps_agree_with_two_thousand() {
        let air = Air::new(60_000.0, 1_600.0);
        for sun_deg in [60.0_f32, 10.0, 1.0] {
            let (sin, cos) = sun_deg.to_radians().sin_cos();
            let sun = Vec3::new(cos, sin, 0.0);
            for (elevation_deg, azimuth_deg) in [(0.0_f32, 10.0_f32), (1.0, 90.0), (20.0, 170.0), (90.0, 0.0)] {
                let (y, level) = elevation_deg.to_radians().sin_cos();
                let (azimuth_sin, azimuth_cos) = azimuth_deg.to_radians().sin_cos();
                let direction = Vec3::new(level * azimuth_cos, y, level * azimuth_sin);
                let fast = air.gather(&air.ray(2_000.0, direction.y, RAY_STEPS), direction, sun);
                let slow = air.gather(&air.ray(2_000.0, direction.y, 2_000), direction, sun);
                let off = ((fast - slow) / slow).abs().max_element();
                assert!(off < 0.02, "sun {sun_deg}, {elevation_deg}, {azimuth_deg}: {off}");
            }
        }
    }

    #[test]
    fn light_is_finite_and_ordered_from_noon_to_night() {
        let air = Air::new(40_000.0, 0.0);
        let mut last = f32::INFINITY;
        for sun_deg in [80.0_f64, 30.0, 5.0, 0.0, -3.0, -8.0, -30.0] {
            let light = air.light(sun_deg.to_radians(), Moonlight::default(), 1_000.0);
            assert!(light.table.iter().all(|&bits| bits < 0x7bff), "sun {sun_deg}");
            let given = (light.sky_irradiance + light.sun_irradiance * sun_deg.to_radians().sin().max(0.0) as f32)
                / light.exposure;
            assert!(given.is_finite() && given.min_element() > 0.0, "sun {sun_deg}: {given}");
            assert!(given.y < last, "sun {sun_deg}: {given}");
            last = given.y;
        }
        // Clear sky, high sun: the sky gives a tenth to a third of what the sun gives (Iqbal 1983: diffuse share).
        let noon = air.light(60_f64.to_radians(), Moonlight::default(), 0.0);
        let share = noon.sky_irradiance.y / (noon.sun_irradiance.y * 60_f32.to_radians().sin());
        assert!((0.08..0.35).contains(&share), "{share}");
        // The zenith is blue.
        let zenith = &noon.table[noon.table.len() - 4..];
        assert!(zenith[2] > zenith[1] && zenith[1] > zenith[0], "{zenith:?}");
    }
}
