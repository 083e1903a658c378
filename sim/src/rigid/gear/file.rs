//! `[[wheel]]` and `[[skid]]` of `M.toml`, checked.

use super::contact::{Contact, Part, Rolling, Steer};
use crate::rigid::model::Control;
use glam::DVec3;
use serde::Deserialize;

/// Most wheels and parts of a model.
const MOST: usize = 32;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(in crate::rigid) struct WheelFile {
    name: String,
    #[serde(deserialize_with = "crate::file::exactly")]
    at_m: [f64; 3],
    radius_m: f64,
    travel_m: f64,
    spring_Npm: f64,
    compress_Nspm: f64,
    extend_Nspm: f64,
    grip_Npm: f64,
    relaxation_m: f64,
    static_friction: f64,
    sliding_friction: f64,
    rolling_friction: f64,
    #[serde(default)]
    brake_friction: f64,
    #[serde(default)]
    brakes: Vec<String>,
    steer: Option<SteerFile>,
    /// The control that lowers it; without one it is always down.
    lowered_by: Option<String>,
    breaks_mps: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SteerFile {
    control: String,
    gain_rad: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(in crate::rigid) struct SkidFile {
    name: String,
    part: Part,
    #[serde(deserialize_with = "crate::file::exactly")]
    at_m: [f64; 3],
    spring_Npm: f64,
    damper_Nspm: f64,
    static_friction: f64,
    sliding_friction: f64,
    breaks_mps: f64,
}

/// Damping along the ground of a contact that carries a part of the body: critical for a third of its mass.
fn grip_nspm(grip_npm: f64, mass_kg: f64) -> f64 {
    (grip_npm * mass_kg / 3.0).sqrt()
}

pub(in crate::rigid) fn contacts(
    wheels: &[WheelFile],
    skids: &[SkidFile],
    controls: &[Control],
    mass_kg: f64,
) -> Result<Vec<Contact>, String> {
    if wheels.len() + skids.len() > MOST {
        return Err(format!("wheel, skid: expected at most {MOST}, found {}", wheels.len() + skids.len()));
    }
    let within = |key: &str, value: f64, low: f64, high: f64| {
        let good = value >= low && value <= high;
        if good { Ok(value) } else { Err(format!("{key}: expected a number within {low} and {high}, found {value}")) }
    };
    let control = |key: &str, name: &String| {
        let known = || controls.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join(", ");
        let place = controls.iter().position(|one| one.name == *name);
        place.ok_or_else(|| format!("{key}: expected a control [{}], found {name}", known()))
    };
    let mut all = Vec::new();
    for (i, wheel) in wheels.iter().enumerate() {
        let key = |what: &str| format!("wheel[{i}].{what}");
        let place = |name: &String| control(&key("brakes"), name);
        let steer = wheel.steer.as_ref().map(|steer| {
            within(&key("steer.gain_rad"), steer.gain_rad, -1.6, 1.6)?;
            Ok::<_, String>(Steer { control: control(&key("steer"), &steer.control)?, gain_rad: steer.gain_rad })
        });
        let lowered_by = wheel.lowered_by.as_ref().map(|name| control(&key("lowered_by"), name)).transpose()?;
        if let Some(of) = lowered_by.map(|place| &controls[place]).filter(|of| (of.min, of.max) != (0.0, 1.0)) {
            return Err(format!(
                "{}: expected a control from 0 to 1, found {} from {} to {}",
                key("lowered_by"),
                of.name,
                of.min,
                of.max
            ));
        }
        let grip_npm = within(&key("grip_Npm"), wheel.grip_Npm, 1.0, 1e9)?;
        let [fixed, sliding] = [wheel.static_friction, wheel.sliding_friction];
        all.push(Contact {
            name: wheel.name.clone(),
            part: Part::Wheel,
            at_m: DVec3::from_array(wheel.at_m),
            radius_m: within(&key("radius_m"), wheel.radius_m, 1e-3, 10.0)?,
            travel_m: within(&key("travel_m"), wheel.travel_m, 1e-3, 10.0)?,
            spring_npm: within(&key("spring_Npm"), wheel.spring_Npm, 1.0, 1e9)?,
            compress_nspm: within(&key("compress_Nspm"), wheel.compress_Nspm, 0.0, 1e9)?,
            extend_nspm: within(&key("extend_Nspm"), wheel.extend_Nspm, 0.0, 1e9)?,
            friction: [
                within(&key("static_friction"), fixed, 0.0, 3.0)?,
                within(&key("sliding_friction"), sliding, 0.0, fixed)?,
            ],
            grip_npm,
            grip_nspm: grip_nspm(grip_npm, mass_kg),
            rolling: Some(Rolling {
                friction: within(&key("rolling_friction"), wheel.rolling_friction, 0.0, 3.0)?,
                relaxation_m: within(&key("relaxation_m"), wheel.relaxation_m, 1e-3, 10.0)?,
                brake_friction: within(&key("brake_friction"), wheel.brake_friction, 0.0, 3.0)?,
                brakes: wheel.brakes.iter().map(place).collect::<Result<_, _>>()?,
                steer: steer.transpose()?,
            }),
            lowered_by,
            breaks_mps: within(&key("breaks_mps"), wheel.breaks_mps, 0.0, 100.0)?,
        });
    }
    for (i, skid) in skids.iter().enumerate() {
        let key = |what: &str| format!("skid[{i}].{what}");
        if skid.part == Part::Wheel {
            return Err(format!("{}: expected hull, wing_tip, tail or propeller, found wheel", key("part")));
        }
        let spring_npm = within(&key("spring_Npm"), skid.spring_Npm, 1.0, 1e9)?;
        let [fixed, sliding] = [skid.static_friction, skid.sliding_friction];
        let damping = within(&key("damper_Nspm"), skid.damper_Nspm, 0.0, 1e9)?;
        all.push(Contact {
            name: skid.name.clone(),
            part: skid.part,
            at_m: DVec3::from_array(skid.at_m),
            radius_m: 0.0,
            travel_m: 0.0,
            spring_npm,
            compress_nspm: damping,
            extend_nspm: damping,
            friction: [
                within(&key("static_friction"), fixed, 0.0, 3.0)?,
                within(&key("sliding_friction"), sliding, 0.0, fixed)?,
            ],
            grip_npm: spring_npm,
            grip_nspm: grip_nspm(spring_npm, mass_kg),
            rolling: None,
            lowered_by: None,
            breaks_mps: within(&key("breaks_mps"), skid.breaks_mps, 0.0, 100.0)?,
        });
    }
    Ok(all)
}
