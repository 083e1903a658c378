//! What the air tells an aircraft: indicated airspeed and altitude, from static and total pressure.
//!
//! SI. The altimeter reads the height of the static pressure in the standard atmosphere, less that of the pressure it is set
//! to (QNH): set to 101,325 Pa it reads flight levels, set to the QNH of an airfield it reads that airfield's elevation on its
//! ground. Heights are geopotential, as altimeters have them: 0.03 % less than geometric at 2,000 m. The airspeed is that of an
//! indicator without errors of its own, the calibrated one: the speed that gives the same impact pressure at sea level.
//!
//! Invariant others rely on: what is shown is finite.
//!
//! Source: NOAA-S/T 76-1562, equations 33a, 33b, solved for the height; isentropic flow below the speed of sound and Rayleigh's
//! formula for a probe behind its shock above it, NACA Report 1135, 1953, equations 44 and 100.

use crate::atmosphere::{AirSample, standard_height_m};

/// Pressure at sea level of the standard atmosphere, Pa.
pub const STANDARD_PA: f64 = 101_325.0;
/// Speed of sound there, m/s.
const STANDARD_SOUND_MPS: f64 = 340.294;
/// What an altimeter may be set to, Pa.
pub const SETTINGS_PA: (f64, f64) = (85_000.0, 110_000.0);

/// What the instruments of an aircraft's own air show.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AirData {
    /// Indicated airspeed, m/s.
    pub airspeed_mps: f64,
    /// Indicated altitude, metres.
    pub altitude_m: f64,
    /// What the altimeter is set to, Pa.
    pub setting_pa: f64,
}

impl AirData {
    /// In this air, at a speed through it, with an altimeter set to a pressure; `altitude_m` is shown where the air has no
    /// pressure.
    pub fn of(air: &AirSample, airspeed_mps: f64, setting_pa: f64, altitude_m: f64) -> Self {
        let shown_m = standard_height_m(air.pressure_pa) - standard_height_m(setting_pa);
        let has_pressure = air.pressure_pa > 0.0 && air.sound_mps > 0.0;
        let mach = if has_pressure { airspeed_mps / air.sound_mps } else { 0.0 };
        let impact_pa = air.pressure_pa * impact_ratio(mach);
        Self {
            airspeed_mps: if has_pressure { calibrated_mps(impact_pa) } else { 0.0 },
            altitude_m: if has_pressure { shown_m } else { altitude_m },
            setting_pa,
        }
    }
}

/// The setting that makes an altimeter read an altitude in air of a pressure, Pa.
pub fn setting_pa(pressure_pa: f64, altitude_m: f64) -> f64 {
    let (mut low, mut high) = SETTINGS_PA;
    let wanted_m = standard_height_m(pressure_pa) - altitude_m;
    // The height falls with the pressure; 50 halvings of 25 kPa are past what a float holds.
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if standard_height_m(middle) > wanted_m { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Impact pressure over static pressure at a Mach number.
fn impact_ratio(mach: f64) -> f64 {
    let m2 = mach * mach;
    if mach <= 1.0 {
        (1.0 + 0.2 * m2).powf(3.5) - 1.0
    } else {
        // 166.921 is 6^2.5 1.2^3.5, for a ratio of specific heats of 1.4.
        166.921_58 * mach.powi(7) / (7.0 * m2 - 1.0).powf(2.5) - 1.0
    }
}

/// The speed at sea level that has an impact pressure, m/s.
fn calibrated_mps(impact_pa: f64) -> f64 {
    let wanted = impact_pa / STANDARD_PA;
    let sonic = impact_ratio(1.0);
    if wanted <= sonic {
        return STANDARD_SOUND_MPS * (5.0 * ((wanted + 1.0).powf(1.0 / 3.5) - 1.0)).max(0.0).sqrt();
    }
    let (mut low, mut high) = (1.0_f64, 30.0_f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if impact_ratio(middle) < wanted { low = middle } else { high = middle }
    }
    STANDARD_SOUND_MPS * 0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atmosphere::{Atmosphere, Layers, Station};

    const KNOT_MPS: f64 = 1852.0 / 3600.0;

    #[test]
    fn in_standard_air_an_altimeter_set_to_the_standard_reads_the_height() {
        let air = Atmosphere::standard();
        for altitude_m in [-300.0, 0.0, 1_607.0, 8_848.0, 11_000.0, 15_000.0, 25_000.0] {
            let seen = AirData::of(&air.at(altitude_m), 0.0, STANDARD_PA, 0.0);
            let geopotential_m = 6_356_766.0 * altitude_m / (6_356_766.0 + altitude_m);
            assert!((seen.altitude_m - geopotential_m).abs() < 1e-6 * altitude_m.abs().max(1.0), "{seen:?}");
            assert_eq!(seen.airspeed_mps, 0.0);
        }
    }

    #[test]
    fn set_to_its_qnh_an_altimeter_reads_an_airfields_elevation_in_any_weather() {
        for (pressure_pa, temperature_k) in [(84_000.0, 258.0), (82_000.0, 303.0), (85_500.0, 288.0)] {
            let station = Station {
                altitude_m: 1_607.0,
                pressure_pa: Some(pressure_pa),
                temperature_k: Some(temperature_k),
                humidity: 0.0,
            };
            let air = Atmosphere::Layered(Layers::through(&station)).at(1_607.0);
            let qnh_pa = setting_pa(air.pressure_pa, 1_607.0);
            assert!((AirData::of(&air, 0.0, qnh_pa, 0.0).altitude_m - 1_607.0).abs() < 1e-6, "{qnh_pa}");
        }
        // ICAO Doc 7488's standard: 1 hPa near sea level is 8.3 m.
        let air = Atmosphere::standard().at(0.0);
        assert!((AirData::of(&air, 0.0, STANDARD_PA + 100.0, 0.0).altitude_m - 8.31).abs() < 0.02);
    }

    #[test]
    fn airspeed_is_true_at_sea_level_and_less_higher_up() {
        let standard = Atmosphere::standard();
        let sea = standard.at(0.0);
        for mps in [0.0, 30.0, 150.0, 340.0, 500.0, 900.0] {
            let seen = AirData::of(&sea, mps, STANDARD_PA, 0.0).airspeed_mps;
            // The standard's speed of sound is rounded to 1 mm/s, 3e-6.
            assert!((seen - mps).abs() <= 1e-5 * mps, "{mps} {seen}");
        }
        // At low speed the equivalent airspeed, true times the root of the density ratio; compressibility adds some
        // M2/8 of the difference of pressures, below 0.1 % at 60 m/s.
        let high = standard.at(3_000.0);
        let seen = AirData::of(&high, 60.0, STANDARD_PA, 0.0).airspeed_mps;
        let equivalent = 60.0 * (high.density_kgpm3 / sea.density_kgpm3).sqrt();
        assert!((seen / equivalent - 1.0).abs() < 2e-3, "{seen} {equivalent}");
        // Mach 0.80 at 35,000 ft is 272 kt calibrated, as every jet's table has it.
        let cruise = standard.at(35_000.0 * 0.3048 * 1.0017);
        let seen = AirData::of(&cruise, 0.80 * cruise.sound_mps, STANDARD_PA, 0.0).airspeed_mps / KNOT_MPS;
        assert!((seen - 272.0).abs() < 1.5, "{seen}");
    }

    #[test]
    fn nothing_shown_is_not_finite() {
        for air in [Atmosphere::None.at(0.0), Atmosphere::standard().at(1e9), Atmosphere::standard().at(f64::NAN)] {
            for speed in [0.0, 1e4, 1e8] {
                let seen = AirData::of(&air, speed, STANDARD_PA, 12.0);
                assert!(seen.airspeed_mps.is_finite() && seen.altitude_m.is_finite(), "{air:?} {seen:?}");
            }
        }
    }
}
