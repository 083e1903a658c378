//! The air: density, pressure, temperature and speed of sound at a height; and where it blows to (see [`crate::wind`]).
//!
//! US Standard Atmosphere 1976 from -5 to 86 km, or the same layers moved so that they pass through what a weather
//! station measured: the temperature of every layer is shifted by the station's difference, and pressure follows from
//! the station's by hydrostatics. Below -5 km the air is that at -5 km; above 86 km it is isothermal and still thins
//! out. Temperatures are those of molecular scale, which above 80 km are up to 0.04 % above the kinetic ones.
//!
//! Humidity lightens the air (water vapour weighs 0.622 of dry air) up to the tropopause; air above is taken as dry.
//! The speed of sound is that of dry air: vapour would raise it by 0.25 % at most at 15 degrees.
//!
//! Heights are geometric metres above mean sea level, other units SI. Invariant: for any height, also NaN, every number
//! is finite and not negative.
//!
//! Source: NOAA-S/T 76-1562, U.S. Standard Atmosphere, 1976, table 4 and equations 18, 23, 33a, 33b, 50; saturation
//! pressure of A. L. Buck, J. Appl. Meteorology 20, 1981, in the form of the Buck Research CR-1A manual, 1996.

use glam::DVec3;
use std::sync::OnceLock;

/// Gravity that the layers are defined with, and that the track and the point mass fly in, m/s2.
pub const GRAVITY_MPS2: f64 = crate::planet::STANDARD_GRAVITY_MPS2;
/// Density at sea level, kg/m3.
pub const SEA_LEVEL_DENSITY_KGPM3: f64 = 1.225;

/// Specific gas constant of dry air, J/(kg K), as ICAO Doc 7488 and the NASA check cases round the standard's
/// 8314.32 / 28.9644.
pub const GAS_JPKGK: f64 = 287.052_87;
/// Ratio of specific heats.
const GAMMA: f64 = 1.4;
/// Earth's radius that turns geometric into geopotential height, metres.
const RADIUS_M: f64 = 6_356_766.0;
/// Base of each layer in geopotential metres, and its lapse, K/m.
const LAYERS: [(f64, f64); 8] = [
    (0.0, -0.006_5),
    (11_000.0, 0.0),
    (20_000.0, 0.001),
    (32_000.0, 0.002_8),
    (47_000.0, 0.0),
    (51_000.0, -0.002_8),
    (71_000.0, -0.002),
    (84_852.0, 0.0),
];
/// Standard temperature and pressure at sea level.
const SEA_LEVEL: (f64, f64) = (288.15, 101_325.0);
/// Bounds of a station's difference from the standard: every layer keeps a temperature that air can have.
const MOST_SHIFT_K: (f64, f64) = (-130.0, 200.0);
/// Geopotential height up to which humidity counts, metres.
const TROPOPAUSE_M: f64 = 11_000.0;

/// The air at one place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AirSample {
    /// Density, kg/m3.
    pub density_kgpm3: f64,
    /// Pressure, Pa.
    pub pressure_pa: f64,
    /// Temperature, K.
    pub temperature_k: f64,
    /// Speed of sound, m/s; 0 where there is no air.
    pub sound_mps: f64,
}

/// The air of a scene, by height.
#[derive(Debug, Clone, PartialEq)]
pub enum Atmosphere {
    /// Layers, standard or moved.
    Layered(Layers),
    /// The same everywhere.
    Constant(AirSample),
    /// No air.
    None,
}

/// What a weather station measured; what it did not is that of the standard.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Station {
    /// Its height, metres.
    pub altitude_m: f64,
    /// Temperature, K.
    pub temperature_k: Option<f64>,
    /// Pressure, Pa.
    pub pressure_pa: Option<f64>,
    /// Relative humidity, 0..=1.
    pub humidity: f64,
}

/// Layers of constant lapse, with their temperature and pressure at the base.
#[derive(Debug, Clone, PartialEq)]
pub struct Layers {
    /// Temperature and pressure at the base of each of [`LAYERS`].
    pub(crate) bases: [(f64, f64); 8],
    pub(crate) humidity: f64,
}

/// Air around an aircraft of the point-mass kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Air {
    /// Density, kg/m3.
    pub density_kgpm3: f64,
    /// Velocity of the air in the world's frame, m/s: where it blows to.
    pub wind_mps: DVec3,
}

impl Air {
    /// Still standard air at a height above mean sea level, metres.
    pub fn standard(altitude_m: f64) -> Self {
        Self { density_kgpm3: density_kgpm3(altitude_m), wind_mps: DVec3::ZERO }
    }
}

impl Atmosphere {
    /// The standard atmosphere.
    pub fn standard() -> Self {
        Self::Layered(standard_layers().clone())
    }

    /// Air of one density, with the standard's temperature at sea level.
    pub fn constant(density_kgpm3: f64) -> Self {
        let temperature_k = SEA_LEVEL.0;
        Self::Constant(AirSample {
            density_kgpm3,
            pressure_pa: density_kgpm3 * GAS_JPKGK * temperature_k,
            temperature_k,
            sound_mps: sound_mps(temperature_k),
        })
    }

    /// The air at a height, metres.
    #[inline]
    pub fn at(&self, altitude_m: f64) -> AirSample {
        match self {
            Self::Layered(layers) => layers.at(altitude_m),
            Self::Constant(sample) => *sample,
            Self::None => AirSample::default(),
        }
    }

    /// Whether the air depends on height.
    pub fn depends_on_height(&self) -> bool {
        matches!(self, Self::Layered(_))
    }
}

impl Layers {
    /// The layers through a station's temperature and pressure, with its relative humidity.
    pub fn through(station: &Station) -> Self {
        let standard = standard_layers();
        let at_m = geopotential_m(station.altitude_m);
        let (standard_k, standard_pa) = standard.temperature_and_pressure(at_m);
        let shift_k = station.temperature_k.map_or(0.0, |k| (k - standard_k).clamp(MOST_SHIFT_K.0, MOST_SHIFT_K.1));
        let mut bases = standard.bases.map(|(k, pa)| (k + shift_k, pa));
        let here = layer_of(at_m);
        // Pressure at the base of the station's layer, then layer by layer down and up.
        let station_k = bases[here].0 + LAYERS[here].1 * (at_m - LAYERS[here].0);
        let station_pa = station.pressure_pa.unwrap_or(standard_pa);
        bases[here].1 = station_pa * fall(station_k, LAYERS[here].1, LAYERS[here].0 - at_m);
        for layer in (0..here).rev() {
            let (above, depth) = (bases[layer + 1], LAYERS[layer].0 - LAYERS[layer + 1].0);
            bases[layer].1 = above.1 * fall(above.0, LAYERS[layer].1, depth);
        }
        for layer in here + 1..bases.len() {
            let (below, depth) = (bases[layer - 1], LAYERS[layer].0 - LAYERS[layer - 1].0);
            bases[layer].1 = below.1 * fall(below.0, LAYERS[layer - 1].1, depth);
        }
        Self { bases, humidity: station.humidity.clamp(0.0, 1.0) }
    }

    /// The air at a geometric height, metres.
    #[inline]
    pub fn at(&self, altitude_m: f64) -> AirSample {
        let height_m = geopotential_m(altitude_m);
        let (temperature_k, pressure_pa) = self.temperature_and_pressure(height_m);
        let mut dry_pa = pressure_pa;
        if self.humidity > 0.0 && height_m <= TROPOPAUSE_M {
            let vapour_pa = (self.humidity * saturation_pa(temperature_k)).min(pressure_pa);
            dry_pa -= (1.0 - 0.622) * vapour_pa;
        }
        AirSample {
            density_kgpm3: dry_pa / (GAS_JPKGK * temperature_k),
            pressure_pa,
            temperature_k,
            sound_mps: sound_mps(temperature_k),
        }
    }

    #[inline]
    fn temperature_and_pressure(&self, height_m: f64) -> (f64, f64) {
        let layer = layer_of(height_m);
        let ((base_m, lapse_kpm), (base_k, base_pa)) = (LAYERS[layer], self.bases[layer]);
        let up_m = height_m - base_m;
        (base_k + lapse_kpm * up_m, base_pa * fall(base_k, lapse_kpm, up_m))
    }
}

/// Density of the standard atmosphere at a geometric height above mean sea level, kg/m3.
pub fn density_kgpm3(altitude_m: f64) -> f64 {
    standard_layers().at(altitude_m).density_kgpm3
}

/// Geopotential height at which the standard atmosphere has a pressure, metres: what an altimeter reads. A pressure that
/// is none, or less than any layer has, counts as that of 200 km.
pub fn standard_height_m(pressure_pa: f64) -> f64 {
    const HIGHEST_M: f64 = 200_000.0;
    let bases = &standard_layers().bases;
    if pressure_pa.is_nan() || pressure_pa <= 0.0 {
        return HIGHEST_M;
    }
    let layer = (0..bases.len()).rev().find(|layer| pressure_pa <= bases[*layer].1).unwrap_or(0);
    let ((base_m, lapse_kpm), (base_k, base_pa)) = (LAYERS[layer], bases[layer]);
    let up_m = if lapse_kpm == 0.0 {
        -GAS_JPKGK * base_k / GRAVITY_MPS2 * (pressure_pa / base_pa).ln()
    } else {
        base_k / lapse_kpm * ((pressure_pa / base_pa).powf(-GAS_JPKGK * lapse_kpm / GRAVITY_MPS2) - 1.0)
    };
    (base_m + up_m).min(HIGHEST_M)
}

/// Pressure over that at the base, `up_m` geopotential metres above it.
#[inline]
fn fall(base_k: f64, lapse_kpm: f64, up_m: f64) -> f64 {
    if lapse_kpm == 0.0 {
        (-GRAVITY_MPS2 * up_m / (GAS_JPKGK * base_k)).exp()
    } else {
        (1.0 + lapse_kpm * up_m / base_k).powf(-GRAVITY_MPS2 / (GAS_JPKGK * lapse_kpm))
    }
}

#[inline]
fn layer_of(height_m: f64) -> usize {
    LAYERS.iter().skip(1).take_while(|layer| height_m >= layer.0).count()
}

fn geopotential_m(altitude_m: f64) -> f64 {
    let altitude_m = if altitude_m.is_nan() { 0.0 } else { altitude_m.clamp(-5_000.0, 1_000_000.0) };
    RADIUS_M * altitude_m / (RADIUS_M + altitude_m)
}

fn sound_mps(temperature_k: f64) -> f64 {
    (GAMMA * GAS_JPKGK * temperature_k).sqrt()
}

/// Pressure of water vapour over a flat surface of water, Pa.
fn saturation_pa(temperature_k: f64) -> f64 {
    let celsius = (temperature_k - 273.15).max(-200.0);
    611.21 * ((18.678 - celsius / 234.5) * (celsius / (257.14 + celsius))).exp()
}

fn standard_layers() -> &'static Layers {
    static STANDARD: OnceLock<Layers> = OnceLock::new();
    STANDARD.get_or_init(|| {
        let mut bases = [SEA_LEVEL; 8];
        for layer in 1..bases.len() {
            let ((base_m, lapse_kpm), (base_k, base_pa)) = (LAYERS[layer - 1], bases[layer - 1]);
            let deep_m = LAYERS[layer].0 - base_m;
            bases[layer] = (base_k + lapse_kpm * deep_m, base_pa * fall(base_k, lapse_kpm, deep_m));
        }
        Layers { bases, humidity: 0.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_air_is_that_of_the_1976_standard_to_80_km() {
        // K, Pa, kg/m3, m/s by the package ussa1976 0.3.4, an independent reading of the standard. It adds up the
        // molar mass from the gases, 9e-7 heavier, which is 1e-5 of pressure at 80 km; its temperatures are kinetic.
        for (altitude_m, kelvin, pascal, density, sound) in [
            (0.0, 288.15, 101_325.0, 1.225_000_225, 340.293_959_3),
            (5_000.0, 255.675_543_2, 54_048.256_5, 0.736_428_659_6, 320.545_379_8),
            (11_000.0, 216.773_512_7, 22_699.931_1, 0.364_801_406_3, 295.153_566_5),
            (20_000.0, 216.65, 5_529.297_858, 0.088_909_767_0, 295.069_468_6),
            (30_000.0, 226.509_083_6, 1_197.027_003, 0.018_410_115_14, 301.708_634_6),
            (47_400.0, 270.65, 110.219_405_3, 1.418_692_301e-3, 329.798_703_2),
            (60_000.0, 247.020_884_8, 21.958_504_45, 3.096_757_977e-4, 315.073_418_0),
            (71_000.0, 216.845_910_7, 4.479_524_047, 7.196_458_342e-5, 295.202_850_1),
            (75_000.0, 208.399_130_8, 2.388_120_699, 3.992_073_692e-5, 289.396_236_8),
            (80_000.0, 198.638_576_3, 1.052_463_005, 1.845_786_329e-5, 282.537_907_7),
        ] {
            let ours = standard_layers().at(altitude_m);
            for (ours, theirs) in [
                (ours.temperature_k, kelvin),
                (ours.pressure_pa, pascal),
                (ours.density_kgpm3, density),
                (ours.sound_mps, sound),
            ] {
                assert!((ours / theirs - 1.0).abs() < 1e-5, "{altitude_m} m: {ours} against {theirs}");
            }
        }
        assert!((standard_layers().at(0.0).sound_mps - 340.294).abs() < 1e-3);
    }

    #[test]
    fn wild_heights_give_air_that_can_be_flown_in() {
        let frost = Layers::through(&Station { temperature_k: Some(1.0), ..Station::default() });
        for layers in [standard_layers(), &frost] {
            for altitude_m in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e9, 1e9, 80_000.0] {
                let air = layers.at(altitude_m);
                assert!(air.density_kgpm3.is_finite() && air.density_kgpm3 >= 0.0, "{altitude_m} m: {air:?}");
                assert!(air.pressure_pa.is_finite() && air.temperature_k > 0.0 && air.sound_mps > 0.0);
            }
        }
        assert_eq!(standard_layers().at(-9_000.0), standard_layers().at(-5_000.0));
        assert!(standard_layers().at(100_000.0).density_kgpm3 < standard_layers().at(86_000.0).density_kgpm3);
    }

    #[test]
    fn a_standard_station_changes_nothing_and_another_is_met() {
        let standard = standard_layers();
        for altitude_m in [0.0, 1_607.0, 15_000.0, 40_000.0] {
            let sample = standard.at(altitude_m);
            let same = Layers::through(&Station {
                altitude_m,
                temperature_k: Some(sample.temperature_k),
                pressure_pa: Some(sample.pressure_pa),
                humidity: 0.0,
            });
            for height_m in [-1_000.0, 0.0, 10_000.0, 30_000.0, 75_000.0] {
                let (ours, theirs) = (same.at(height_m), standard.at(height_m));
                // Up to seven layers of a few roundings each in the exponent's result.
                assert!((ours.pressure_pa / theirs.pressure_pa - 1.0).abs() < 1e-13, "{height_m}");
            }
        }
        let hot =
            Station { altitude_m: 1_607.0, temperature_k: Some(308.15), pressure_pa: Some(84_000.0), humidity: 0.5 };
        let air = Layers::through(&hot).at(1_607.0);
        assert!((air.temperature_k - 308.15).abs() < 1e-9 && (air.pressure_pa - 84_000.0).abs() < 1e-7);
        assert!(air.density_kgpm3 < 84_000.0 / (GAS_JPKGK * 308.15));
    }

    #[test]
    fn pressure_falls_as_density_and_gravity_say() {
        // Hydrostatics, dp/dH = -rho g, by a difference over 1 m: p'' h2 / 24 of p is 1e-9.
        let moved = Layers::through(&Station { temperature_k: Some(303.15), ..Station::default() });
        for height_m in [-500.0, 5_500.0, 15_000.0, 25_000.0, 40_000.0, 49_000.0, 60_000.0, 80_000.0] {
            let (k, pa) = moved.temperature_and_pressure(height_m);
            let (_, above) = moved.temperature_and_pressure(height_m + 0.5);
            let (_, below) = moved.temperature_and_pressure(height_m - 0.5);
            let weight = pa / (GAS_JPKGK * k) * GRAVITY_MPS2;
            assert!(((below - above) / weight - 1.0).abs() < 1e-8, "{height_m}");
        }
    }

    #[test]
    fn vapour_saturates_as_published() {
        // IAPWS values over water: 611.2 Pa at 0 C, 2,339 at 20 C, 4,246 at 30 C; Buck's fit is good to 0.1 %.
        for (celsius, pascal) in [(0.0, 611.2), (20.0, 2_339.0), (30.0, 4_246.0)] {
            assert!((saturation_pa(celsius + 273.15) / pascal - 1.0).abs() < 1e-3);
        }
    }
}
