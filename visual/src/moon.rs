//! Where the moon stands at a moment and a place, and how much light it gives.
//!
//! Position: the largest terms of the lunar theory ELP-2000/82 as in J. Meeus, Astronomical Algorithms, 2nd edition, 1998,
//! chapter 47 (24 in longitude and distance, 14 in latitude; what is left out sums to 0.02 degrees), without nutation
//! (0.005 degrees), made topocentric on the ellipsoid. No refraction, as for the sun. Azimuth is from TRUE north.
//!
//! Light: C. W. Allen, Astrophysical Quantities, 1976: magnitudes over those of the full moon, 0.026 a + 4e-9 a^4 at a phase
//! angle of `a` degrees. How bright a full moon is in a picture is the sky's to say.

use crate::frame::Scene;
use crate::sun::{self, SunError};
use glam::DVec3;
use solar_positioning::delta_t;

/// The moon's place in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoonPosition {
    /// Clockwise from true north, radians.
    pub true_azimuth_rad: f64,
    /// Above the horizon, radians, without refraction.
    pub elevation_rad: f64,
    /// From the place to the moon's centre, kilometres.
    pub distance_km: f64,
}

/// What the sky needs of the moon.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moonlight {
    /// Above the horizon, radians.
    pub elevation_rad: f64,
    /// Of a full moon's light, by phase; 0 where there is no moon or it is down.
    pub share: f64,
}

/// Mean distance of the sun over that of the moon.
const SUN_OVER_MOON: f64 = 389.2;
const EARTH_KM: f64 = 6_378.137;
const ECCENTRICITY_SQUARED: f64 = 0.006_694_38;

/// Multiples of D, M, M', F; then the sine's in longitude (1e-6 degrees) and the cosine's in distance (metres).
const LONGITUDE: [([i32; 4], f64, f64); 24] = [
    ([0, 0, 1, 0], 6_288_774.0, -20_905_355.0),
    ([2, 0, -1, 0], 1_274_027.0, -3_699_111.0),
    ([2, 0, 0, 0], 658_314.0, -2_955_968.0),
    ([0, 0, 2, 0], 213_618.0, -569_925.0),
    ([0, 1, 0, 0], -185_116.0, 48_888.0),
    ([0, 0, 0, 2], -114_332.0, -3_149.0),
    ([2, 0, -2, 0], 58_793.0, 246_158.0),
    ([2, -1, -1, 0], 57_066.0, -152_138.0),
    ([2, 0, 1, 0], 53_322.0, -170_733.0),
    ([2, -1, 0, 0], 45_758.0, -204_586.0),
    ([0, 1, -1, 0], -40_923.0, -129_620.0),
    ([1, 0, 0, 0], -34_720.0, 108_743.0),
    ([0, 1, 1, 0], -30_383.0, 104_755.0),
    ([2, 0, 0, -2], 15_327.0, 10_321.0),
    ([0, 0, 1, 2], -12_528.0, 0.0),
    ([0, 0, 1, -2], 10_980.0, 79_661.0),
    ([4, 0, -1, 0], 10_675.0, -34_782.0),
    ([0, 0, 3, 0], 10_034.0, -23_210.0),
    ([4, 0, -2, 0], 8_548.0, -21_636.0),
    ([2, 1, -1, 0], -7_888.0, 24_208.0),
    ([2, 1, 0, 0], -6_766.0, 30_824.0),
    ([1, 0, -1, 0], -5_163.0, -8_379.0),
    ([1, 1, 0, 0], 4_987.0, -16_675.0),
    ([2, -1, 1, 0], 4_036.0, -12_831.0),
];

/// The same for the sine's in latitude.
const LATITUDE: [([i32; 4], f64); 14] = [
    ([0, 0, 0, 1], 5_128_122.0),
    ([0, 0, 1, 1], 280_602.0),
    ([0, 0, 1, -1], 277_693.0),
    ([2, 0, 0, -1], 173_237.0),
    ([2, 0, -1, 1], 55_413.0),
    ([2, 0, -1, -1], 46_271.0),
    ([2, 0, 0, 1], 32_573.0),
    ([0, 0, 2, 1], 17_198.0),
    ([2, 0, 1, -1], 9_266.0),
    ([0, 0, 2, -1], 8_822.0),
    ([2, -1, 0, -1], 8_216.0),
    ([2, 0, -2, -1], 4_324.0),
    ([2, 0, 1, 1], 4_200.0),
    ([2, 1, 0, -1], -3_359.0),
];

/// The moon's position at `unix_s` seconds since 1970-01-01T00:00Z (UTC), seen from a place at sea level, degrees north and
/// east.
///
/// # Errors
/// As [`sun::position`].
pub fn position(unix_s: f64, latitude_deg: f64, longitude_deg: f64) -> Result<MoonPosition, SunError> {
    let year = sun::checked_year(unix_s, latitude_deg, longitude_deg)?;
    let delta_t_s = delta_t::estimate(year).map_err(|error| SunError::Moment { unix_s, reason: error.to_string() })?;
    let days = unix_s / 86_400.0 + 2_440_587.5 - 2_451_545.0;
    let centuries = (days + delta_t_s / 86_400.0) / 36_525.0;

    // Geocentric, in the equator's plane: x to the equinox, z to the pole, kilometres.
    let (longitude_rad, latitude_rad, distance_km) = geocentric(centuries);
    let obliquity_rad = (23.439_291_1 - 0.013_004_2 * centuries).to_radians();
    let ecliptic = DVec3::new(
        latitude_rad.cos() * longitude_rad.cos(),
        latitude_rad.cos() * longitude_rad.sin(),
        latitude_rad.sin(),
    ) * distance_km;
    let moon = DVec3::new(
        ecliptic.x,
        ecliptic.y * obliquity_rad.cos() - ecliptic.z * obliquity_rad.sin(),
        ecliptic.y * obliquity_rad.sin() + ecliptic.z * obliquity_rad.cos(),
    );
    // The place in the same frame: mean sidereal time at Greenwich (Meeus 12.4) and the longitude.
    let sidereal_deg = 280.460_618_37 + 360.985_647_366_29 * days + longitude_deg;
    let (sidereal_sin, sidereal_cos) = sidereal_deg.rem_euclid(360.0).to_radians().sin_cos();
    let (sin, cos) = latitude_deg.to_radians().sin_cos();
    let normal_km = EARTH_KM / (1.0 - ECCENTRICITY_SQUARED * sin * sin).sqrt();
    let place = DVec3::new(
        normal_km * cos * sidereal_cos,
        normal_km * cos * sidereal_sin,
        normal_km * (1.0 - ECCENTRICITY_SQUARED) * sin,
    );
    let seen = moon - place;
    let up = DVec3::new(cos * sidereal_cos, cos * sidereal_sin, sin);
    let east = DVec3::new(-sidereal_sin, sidereal_cos, 0.0);
    let north = up.cross(east);
    let distance_km = seen.length();
    Ok(MoonPosition {
        true_azimuth_rad: seen.dot(east).atan2(seen.dot(north)).rem_euclid(std::f64::consts::TAU),
        elevation_rad: (seen.dot(up) / distance_km).clamp(-1.0, 1.0).asin(),
        distance_km,
    })
}

/// Ecliptic longitude and latitude of the date, radians, and distance, kilometres.
fn geocentric(centuries: f64) -> (f64, f64, f64) {
    let t = centuries;
    let angle =
        |constant: f64, rate: f64, square: f64| (constant + rate * t + square * t * t).rem_euclid(360.0).to_radians();
    let mean_longitude = angle(218.316_447_7, 481_267.881_234_21, -0.001_578_6);
    let arguments = [
        angle(297.850_192_1, 445_267.111_403_4, -0.001_881_9),
        angle(357.529_109_2, 35_999.050_290_9, -0.000_153_6),
        angle(134.963_396_4, 477_198.867_505_5, 0.008_741_4),
        angle(93.272_095_0, 483_202.017_523_3, -0.003_653_9),
    ];
    let eccentricity = 1.0 - 0.002_516 * t - 0.000_007_4 * t * t;
    let argument = |multiples: &[i32; 4]| {
        let sum: f64 = multiples.iter().zip(arguments).map(|(multiple, angle)| f64::from(*multiple) * angle).sum();
        // Terms with the sun's anomaly follow the Earth's orbit, which gets rounder.
        (sum, eccentricity.powi(multiples[1].abs()))
    };
    let (mut longitude, mut latitude, mut distance_m) = (0.0, 0.0, 385_000_560.0);
    for (multiples, sine, cosine) in &LONGITUDE {
        let (angle, factor) = argument(multiples);
        longitude += sine * factor * angle.sin();
        distance_m += cosine * factor * angle.cos();
    }
    for (multiples, sine) in &LATITUDE {
        let (angle, factor) = argument(multiples);
        latitude += sine * factor * angle.sin();
    }
    // By Venus and by the Earth's flattening, the two largest of the additive terms.
    longitude += 3_958.0 * angle(119.75, 131.849, 0.0).sin() + 1_962.0 * (mean_longitude - arguments[3]).sin();
    latitude += -2_235.0 * mean_longitude.sin();
    (mean_longitude + (longitude * 1e-6).to_radians(), (latitude * 1e-6).to_radians(), distance_m / 1_000.0)
}

/// Unit vector from the moon to the sun, given those from the eye to either.
pub fn to_sun_from_moon(to_sun: DVec3, to_moon: DVec3) -> DVec3 {
    (to_sun * SUN_OVER_MOON - to_moon).normalize_or(DVec3::Y)
}

/// Phase angle, at the moon between the sun and the eye, radians: 0 full, pi new.
pub fn phase_rad(to_sun: DVec3, to_moon: DVec3) -> f64 {
    to_sun_from_moon(to_sun, to_moon).angle_between(-to_moon)
}

/// Share of the moon's disc that is lit.
pub fn illuminated(phase_rad: f64) -> f64 {
    0.5 * (1.0 + phase_rad.cos())
}

/// Moonlight over that of a full moon.
pub fn light_share(phase_rad: f64) -> f64 {
    let degrees = phase_rad.to_degrees().clamp(0.0, 180.0);
    10f64.powf(-0.4 * (0.026 * degrees + 4e-9 * degrees.powi(4)))
}

impl Moonlight {
    /// Of a sane scene.
    pub fn of(scene: &Scene) -> Self {
        match scene.moon_direction {
            Some(moon) if moon.y > -0.02 => Self {
                elevation_rad: moon.y.clamp(-1.0, 1.0).asin(),
                share: light_share(phase_rad(scene.sun_direction, moon)),
            },
            _ => Self::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worked_example_of_meeus() {
        // Example 47.a: 1992 April 12, 0h TD: longitude 133.162655, latitude -3.229126 degrees, 368,409.7 km.
        let (longitude_rad, latitude_rad, distance_km) = geocentric(-0.077_221_081_451);
        // What is left out: 0.02 degrees, and as much of the distance (130 km).
        assert!((longitude_rad.to_degrees().rem_euclid(360.0) - 133.162_655).abs() < 0.02, "{longitude_rad}");
        assert!((latitude_rad.to_degrees() + 3.229_126).abs() < 0.02, "{latitude_rad}");
        assert!((distance_km - 368_409.7).abs() < 130.0, "{distance_km}");
    }

    #[test]
    fn phases_are_those_of_the_angle_to_the_sun() {
        let sun = DVec3::X;
        assert!(phase_rad(sun, DVec3::NEG_X) < 1e-6);
        assert!((phase_rad(sun, DVec3::Y).to_degrees() - 90.0).abs() < 0.2);
        assert!(illuminated(phase_rad(sun, DVec3::X)) < 1e-6);
        assert_eq!(light_share(0.0), 1.0);
        // A half moon gives a ninth to a twelfth of a full one.
        assert!(
            (1.0 / 12.0..1.0 / 9.0).contains(&light_share(90_f64.to_radians())),
            "{}",
            light_share(90_f64.to_radians())
        );
    }

    #[test]
    fn no_place_and_no_moment_have_no_moon() {
        assert!(position(0.0, f64::NAN, 0.0).is_err());
        assert!(position(f64::NAN, 10.0, 0.0).is_err());
        assert!(position(1e12, 10.0, 0.0).is_err());
    }
}
