//! The weather of a situation as a station measured it: `[air]`.
//!
//! Hectopascals and degrees Celsius, as stations report them. What is left out is that of the standard atmosphere at the
//! station's height. The altimeter of the own aircraft is set to the QNH of its start.

use crate::air_data;
use crate::atmosphere::{Atmosphere, Layers, Station};
use serde::Deserialize;

/// Melting point of ice, K.
const ICE_K: f64 = 273.15;

/// A station's report as the file has it.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Report {
    altitude_m: f64,
    #[serde(rename = "pressure_hPa")]
    pressure_hpa: Option<f64>,
    #[serde(rename = "temperature_C")]
    temperature_c: Option<f64>,
    #[serde(default)]
    humidity: f64,
}

impl Report {
    /// The air through it.
    ///
    /// # Errors
    /// The key, what was expected and what was found.
    pub fn atmosphere(&self) -> Result<Atmosphere, String> {
        let within = |key: &str, found: f64, least: f64, most: f64| match found {
            found if (least..=most).contains(&found) => Ok(found),
            found => Err(format!("{key}: expected {least}..={most}, found {found}")),
        };
        let altitude_m = within("altitude_m", self.altitude_m, -500.0, 9_000.0)?;
        let pressure_pa = self.pressure_hpa.map(|hpa| within("pressure_hPa", hpa, 250.0, 1_100.0)).transpose()?;
        let temperature_k = self.temperature_c.map(|c| within("temperature_C", c, -90.0, 60.0)).transpose()?;
        let humidity = within("humidity", self.humidity, 0.0, 1.0)?;
        Ok(Atmosphere::Layered(Layers::through(&Station {
            altitude_m,
            temperature_k: temperature_k.map(|c| c + ICE_K),
            pressure_pa: pressure_pa.map(|hpa| 100.0 * hpa),
            humidity,
        })))
    }
}

/// The altimeter's setting over ground of a height, Pa: the QNH there.
pub(super) fn qnh_pa(air: &Atmosphere, ground_m: f64) -> f64 {
    let pressure_pa = air.at(ground_m).pressure_pa;
    if pressure_pa > 0.0 { air_data::setting_pa(pressure_pa, ground_m) } else { air_data::STANDARD_PA }
}
