//! Air in which an aircraft flies: the standard atmosphere's density, and wind.
//!
//! US Standard Atmosphere 1976 up to 32 km of geopotential height, isothermal above; good to 0.1 % of density to 32 km,
//! and only a smooth decline beyond. Source: NOAA-S/T 76-1562, 1976, table 4 and equations 18, 33a, 33b.

use glam::DVec3;

/// Gravity that the layers are defined with, and that scenes fly in, m/s2.
pub const GRAVITY_MPS2: f64 = 9.806_65;
/// Density at sea level, kg/m3.
pub const SEA_LEVEL_DENSITY_KGPM3: f64 = 1.225;

/// Specific gas constant of dry air as the standard defines it (8314.32 / 28.9644), J/(kg K).
const GAS_JPKGK: f64 = 287.052_874;
/// Earth's radius that turns geometric into geopotential height, metres.
const RADIUS_M: f64 = 6_356_766.0;
/// Layers: base in geopotential metres, temperature there (K), lapse (K/m), pressure there (Pa).
const LAYERS: [(f64, f64, f64, f64); 3] =
    [(0.0, 288.15, -0.006_5, 101_325.0), (11_000.0, 216.65, 0.0, 22_632.06), (20_000.0, 216.65, 0.001, 5_474.889)];
/// Top of the third layer: (geopotential metres, K, Pa); isothermal from here up.
const TOP: (f64, f64, f64) = (32_000.0, 228.65, 868.018_7);

/// Air around an aircraft.
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

/// Density of the standard atmosphere at a geometric height above mean sea level, kg/m3.
///
/// Taken at -5 km below that, so that a wild height gives neither an infinity nor NaN.
pub fn density_kgpm3(altitude_m: f64) -> f64 {
    let altitude_m = if altitude_m.is_nan() { 0.0 } else { altitude_m.clamp(-5_000.0, 1_000_000.0) };
    let height_m = RADIUS_M * altitude_m / (RADIUS_M + altitude_m);
    if height_m > TOP.0 {
        let (base_m, temperature_k, pressure_pa) = TOP;
        let fall = (-GRAVITY_MPS2 * (height_m - base_m) / (GAS_JPKGK * temperature_k)).exp();
        return pressure_pa * fall / (GAS_JPKGK * temperature_k);
    }
    let layer = LAYERS.iter().rposition(|layer| height_m >= layer.0).unwrap_or(0);
    let (base_m, base_k, lapse_kpm, base_pa) = LAYERS[layer];
    let temperature_k = base_k + lapse_kpm * (height_m - base_m);
    let pressure_pa = if lapse_kpm == 0.0 {
        base_pa * (-GRAVITY_MPS2 * (height_m - base_m) / (GAS_JPKGK * base_k)).exp()
    } else {
        base_pa * (base_k / temperature_k).powf(GRAVITY_MPS2 / (GAS_JPKGK * lapse_kpm))
    };
    pressure_pa / (GAS_JPKGK * temperature_k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_is_that_of_the_1976_tables() {
        // Table I of NOAA-S/T 76-1562, geometric metres and kg/m3, printed to four or five digits.
        for (altitude_m, table) in [
            (-1_000.0, 1.3470),
            (0.0, 1.2250),
            (1_000.0, 1.1117),
            (5_000.0, 0.73643),
            (11_000.0, 0.36480),
            (20_000.0, 0.088910),
            (30_000.0, 0.018410),
        ] {
            let ours = density_kgpm3(altitude_m);
            assert!((ours / table - 1.0).abs() < 2e-4, "{altitude_m} m: {ours} against {table}");
        }
    }

    #[test]
    fn wild_heights_give_air_that_can_be_flown_in() {
        for altitude_m in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e9, 1e9, 80_000.0] {
            let density = density_kgpm3(altitude_m);
            assert!((0.0..3.0).contains(&density), "{altitude_m} m: {density}");
        }
    }
}
