//! `[engine]` and `[propeller]` of `M.toml`, checked.

use super::engine::Engine;
use super::propeller::Propeller;
use super::shaft::PowerPlant;
use crate::rigid::model::Control;
use crate::table::{Interpolation, Table};
use glam::DVec3;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(in crate::rigid) struct EngineFile {
    power_W: f64,
    speed_rpm: f64,
    friction: f64,
    idle: f64,
    fuel_kgps: f64,
    rich: f64,
    /// Fuel-air ratio over that of best power, and power over the best.
    #[serde(deserialize_with = "crate::file::rows")]
    mixture: Vec<[f64; 2]>,
    #[serde(default)]
    starter: f64,
    inertia_kgm2: f64,
    throttle_control: String,
    mixture_control: Option<String>,
    starter_control: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::rigid) struct PropellerFile {
    diameter_m: f64,
    #[serde(deserialize_with = "crate::file::exactly")]
    at_m: [f64; 3],
    /// Advance ratio, CT, CP.
    #[serde(deserialize_with = "crate::file::rows")]
    coefficients: Vec<[f64; 3]>,
}

fn above(key: &str, value: f64, most: f64) -> Result<f64, String> {
    let good = value > 0.0 && value <= most;
    if good { Ok(value) } else { Err(format!("{key}: expected a number above 0 and at most {most}, found {value}")) }
}

fn curve(key: &str, x: Vec<f64>, y: Vec<f64>) -> Result<Table, String> {
    Table::new(vec![x], y, Interpolation::Pchip).map_err(|error| format!("{key}: {error}"))
}

pub(in crate::rigid) fn power_plant(
    engine: Option<&EngineFile>,
    propeller: Option<&PropellerFile>,
    controls: &[Control],
) -> Result<Option<PowerPlant>, String> {
    let (engine, propeller) = match (engine, propeller) {
        (None, None) => return Ok(None),
        (Some(engine), Some(propeller)) => (engine, propeller),
        _ => return Err("engine, propeller: expected both or none, found one".to_owned()),
    };
    let control = |key: &str, name: &String| {
        let known = || controls.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join(", ");
        let place = controls.iter().position(|one| one.name == *name);
        place.ok_or_else(|| format!("engine.{key}: expected a control [{}], found {name}", known()))
    };
    let may_be = |key: &str, name: &Option<String>| name.as_ref().map(|name| control(key, name)).transpose();
    let column = |i: usize| propeller.coefficients.iter().map(|row| row[i]).collect::<Vec<f64>>();
    let most_advance = propeller.coefficients.last().map_or(0.0, |row| row[0]);
    if propeller.coefficients.last().is_some_and(|row| row[2] >= 0.0) {
        return Err("propeller.coefficients: expected a last row with a CP below 0, where the air drives it".to_owned());
    }
    Ok(Some(PowerPlant {
        engine: Engine {
            rated_w: above("engine.power_W", engine.power_W, 1e9)?,
            rated_radps: above("engine.speed_rpm", engine.speed_rpm, 1e5)? * std::f64::consts::TAU / 60.0,
            friction: above("engine.friction", engine.friction, 1.0)?,
            idle: above("engine.idle", engine.idle, 1.0)?,
            fuel_kgps: above("engine.fuel_kgps", engine.fuel_kgps, 1e3)?,
            rich: above("engine.rich", engine.rich, 10.0)?,
            mixture: curve(
                "engine.mixture",
                engine.mixture.iter().map(|row| row[0]).collect(),
                engine.mixture.iter().map(|row| row[1]).collect(),
            )?,
            starter: if engine.starter == 0.0 { 0.0 } else { above("engine.starter", engine.starter, 1.0)? },
        },
        propeller: Propeller {
            diameter_m: above("propeller.diameter_m", propeller.diameter_m, 100.0)?,
            thrust: curve("propeller.coefficients", column(0), column(1))?,
            power: curve("propeller.coefficients", column(0), column(2))?,
            most_advance: above("propeller.coefficients", most_advance, 100.0)?,
        },
        inertia_kgm2: above("engine.inertia_kgm2", engine.inertia_kgm2, 1e6)?,
        at_m: DVec3::from_array(propeller.at_m),
        throttle: control("throttle_control", &engine.throttle_control)?,
        mixture: may_be("mixture_control", &engine.mixture_control)?,
        starter: may_be("starter_control", &engine.starter_control)?,
    }))
}
