//! How deep the physics of a shell must be: tiers from vacuum to the turning ellipsoid with spin drift, for the example
//! projectiles, near (1 km) and at the greatest range.
//!
//! Setting: the tier's place, each adds to the one before. Reference: the dearest tier. Error: at 1 km, metres up and
//! aside where the shot passes that range; at the greatest range, metres on the ground where it comes down to the
//! muzzle's height. Cost: nanoseconds a step of rk4. The shot goes east from 45 N 0 E at sea level.

use super::{Effort, costs_s};
use crate::failure::Failure;
use crate::report::{Knob, KnobPoint};
use sim::ballistics::column::Column;
use sim::ballistics::launch::Launch;
use sim::ballistics::motion::{ShellMotion, advance, state};
use sim::ballistics::projectile::Projectile;
use sim::ballistics::trajectory::{Trajectory, fly};
use sim::case::Case;
use sim::integrate::Integrator;
use std::fmt::Display;
use std::hint::black_box;
use std::path::Path;

/// A name, the file, and the speed at the muzzle, m/s.
pub const PROJECTILES: [(&str, &str, f64); 3] = [
    (".308 175 gr", include_str!("../../../assets/ballistics/projectiles/308_175gr.toml"), 792.48),
    ("30 mm", include_str!("../../../assets/ballistics/projectiles/30mm.toml"), 1_005.0),
    ("155 mm M107", include_str!("../../../assets/ballistics/projectiles/155mm_m107.toml"), 563.9),
];

const FLAT: &str = "[frame]\ng_mps2 = 9.80619777";
const TURNING: &str = "[frame]\nkind = 'ellipsoid'";
/// Gravity at 45 degrees of latitude by WGS84's formula (NIMA TR8350.2, 4-1).
const TURNING_FLAT: &str = "[frame]\ng_mps2 = 9.80619777\nlatitude_deg = 45\nrotation_radps = 7.292115e-5";
const TURNING_ROUND: &str =
    "[frame]\ng_mps2 = 9.80619777\nlatitude_deg = 45\nrotation_radps = 7.292115e-5\ngravity = 'inverse_square'";

/// What a tier has.
struct Tier {
    label: &'static str,
    surroundings: &'static str,
    atmosphere: &'static str,
    drag: bool,
    linear: bool,
    spin: bool,
}

const TIERS: [Tier; 8] = [
    Tier { label: "vacuum", surroundings: FLAT, atmosphere: "us1976", drag: false, linear: false, spin: false },
    Tier {
        label: "air as at the muzzle",
        surroundings: FLAT,
        atmosphere: "constant",
        drag: true,
        linear: true,
        spin: false,
    },
    Tier {
        label: "air by height, linear Cd",
        surroundings: FLAT,
        atmosphere: "us1976",
        drag: true,
        linear: true,
        spin: false,
    },
    Tier { label: "smooth Cd", surroundings: FLAT, atmosphere: "us1976", drag: true, linear: false, spin: false },
    Tier {
        label: "+ Coriolis",
        surroundings: TURNING_FLAT,
        atmosphere: "us1976",
        drag: true,
        linear: false,
        spin: false,
    },
    Tier { label: "+ g(h)", surroundings: TURNING_ROUND, atmosphere: "us1976", drag: true, linear: false, spin: false },
    Tier {
        label: "+ spin drift",
        surroundings: TURNING_ROUND,
        atmosphere: "us1976",
        drag: true,
        linear: false,
        spin: true,
    },
    Tier { label: "ellipsoid, J2", surroundings: TURNING, atmosphere: "us1976", drag: true, linear: false, spin: true },
];

/// Step of the flights, seconds.
const STEP_S: f64 = 0.005;
/// Elevation of the near shot, degrees.
const NEAR_DEG: f64 = 0.5;
const NEAR_END: &str = "x_m=1000";
/// Steps that are timed at once.
const TIMED_STEPS: u32 = 2_000;

fn failed(error: impl Display) -> Failure {
    Failure::while_doing("flying a built-in projectile", error)
}

/// The projectile of a tier.
fn projectile(text: &str, tier: &Tier) -> Result<Projectile, Failure> {
    let linear = if tier.linear { "interpolation = 'linear'\n" } else { "" };
    let mut read = Projectile::from_text(Path::new("projectile"), &format!("{linear}{text}")).map_err(failed)?;
    if !tier.drag {
        read.drag = None;
    }
    if !tier.spin {
        read.spin = None;
    }
    Ok(read)
}

/// A shot; `end` is its end, or nothing for the muzzle's height.
pub fn case(
    surroundings: &str,
    atmosphere: &str,
    speed_mps: f64,
    elevation_deg: f64,
    step_s: f64,
    end: &str,
) -> Result<Case, Failure> {
    let until = if end.is_empty() { String::new() } else { format!("until = '{end}'\n") };
    let text = format!(
        "{surroundings}\n[atmosphere]\nmodel = '{atmosphere}'\n[initial]\nlat_deg = 45\nlon_deg = 0\n[run]\n\
         dt_s = {step_s:?}\n[shot]\nspeed_mps = {speed_mps:?}\nazimuth_deg = 90\nelevation_deg = {elevation_deg:?}\n{until}"
    );
    Case::from_text(Path::new("shot"), &text).map_err(failed)
}

fn shot(text: &str, tier: &Tier, speed_mps: f64, elevation_deg: f64, end: &str) -> Result<Trajectory, Failure> {
    let case = case(tier.surroundings, tier.atmosphere, speed_mps, elevation_deg, STEP_S, end)?;
    fly(&projectile(text, tier)?, &case, None).map_err(failed)
}

/// The elevation of the greatest range in whole degrees, by the flat tier with smooth drag.
pub fn farthest_deg(text: &str, speed_mps: f64) -> Result<f64, Failure> {
    let mut best = (0.0, 0.0);
    for degrees in 25..=50 {
        let flown = shot(text, &TIERS[3], speed_mps, f64::from(degrees), "")?;
        if flown.range_m > best.0 {
            best = (flown.range_m, f64::from(degrees));
        }
    }
    Ok(best.1)
}

/// A knob for each projectile and range.
///
/// # Errors
/// [`Failure::Failed`] if a built-in projectile cannot be flown.
pub fn knobs(effort: Effort) -> Result<Vec<Knob>, Failure> {
    let mut knobs = Vec::new();
    for (name, text, speed_mps) in PROJECTILES {
        let costs_s = tier_costs_s(text, speed_mps, effort)?;
        let far_deg = farthest_deg(text, speed_mps)?;
        for (range, elevation_deg, end) in [("1 km", NEAR_DEG, NEAR_END), ("greatest range", far_deg, "")] {
            let mut ends = Vec::new();
            for tier in &TIERS {
                let flown = shot(text, tier, speed_mps, elevation_deg, end)?;
                let value = |column| flown.end().get(column).unwrap_or(f64::NAN);
                ends.push([flown.range_m, value(Column::Y), value(Column::Z)]);
            }
            let Some([reach_m, up_m, aside_m]) = ends.last().copied() else { continue };
            let near = !end.is_empty();
            let points = TIERS.iter().zip(&ends).zip(&costs_s).enumerate().map(|(at, ((tier, to), cost_s))| {
                let (along, up, aside) = (to[0] - reach_m, to[1] - up_m, to[2] - aside_m);
                KnobPoint {
                    setting: at as f64,
                    error: if near { up.hypot(aside) } else { along.hypot(aside) },
                    cost: cost_s * 1e9 / f64::from(TIMED_STEPS),
                    label: Some(tier.label.into()),
                    error_height: near.then_some(up.abs()),
                    error_horizontal: Some(if near { aside.abs() } else { along.hypot(aside) }),
                    ..KnobPoint::default()
                }
            });
            let what = if near {
                format!("m up and aside at 1 km, bore {NEAR_DEG} degrees up")
            } else {
                format!("m on the ground at {:.1} km, {elevation_deg} degrees", reach_m * 1e-3)
            };
            knobs.push(Knob {
                name: format!("ballistics {name} {range}"),
                unit: "tier of ballistics".into(),
                error_unit: format!("{what}, from the dearest tier"),
                cost_unit: "ns a step of rk4".into(),
                points: points.collect(),
                ..Knob::default()
            });
        }
    }
    Ok(knobs)
}

/// What so many steps from the muzzle on cost in each tier, seconds.
fn tier_costs_s(text: &str, speed_mps: f64, effort: Effort) -> Result<Vec<f64>, Failure> {
    let mut set = Vec::new();
    for tier in &TIERS {
        set.push((projectile(text, tier)?, case(tier.surroundings, tier.atmosphere, speed_mps, 30.0, STEP_S, "")?));
    }
    let mut works: Vec<Box<dyn FnMut() + '_>> = Vec::new();
    for (projectile, case) in &set {
        let launch = Launch::of(case, projectile).map_err(failed)?;
        let motion = ShellMotion::new(projectile, case.planet, &case.atmosphere, &case.wind, launch.bore());
        let from = state(launch.position_m, launch.velocity_mps);
        works.push(Box::new(move || {
            let mut y = black_box(from);
            for step in 0..TIMED_STEPS {
                let t_s = f64::from(step) * STEP_S;
                if let Ok((next, _)) = advance(Integrator::Rk4, &motion, t_s, &y, STEP_S, &mut None) {
                    y = next;
                }
            }
            black_box(y);
        }));
    }
    costs_s(effort.rounds, &mut works)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_tier_counts_where_it_should() {
        let knobs = knobs(Effort { quick: true, rounds: 1 }).unwrap();
        let error = |name: &str, tier: &str| {
            let knob = knobs.iter().find(|knob| knob.name == format!("ballistics {name}")).unwrap();
            knob.points.iter().find(|point| point.label.as_deref() == Some(tier)).unwrap().error
        };
        for knob in &knobs {
            for point in &knob.points {
                println!(
                    "{:42} {:26} {:12.4} m {:7.1} ns",
                    knob.name,
                    point.label.as_deref().unwrap(),
                    point.error,
                    point.cost
                );
            }
        }
        for (name, ..) in PROJECTILES {
            let far = format!("{name} greatest range");
            // Drag is never optional; density by height counts for whatever climbs.
            assert!(error(&far, "vacuum") > 1_000.0 && error(&far, "air as at the muzzle") > 50.0, "{name}");
            assert!(error(&far, "+ g(h)") < error(&far, "smooth Cd"), "{name}");
        }
        // Spin drift: only the rifle's file tells its twist.
        assert!(error(".308 175 gr 1 km", "+ spin drift") < 0.2 * error(".308 175 gr 1 km", "+ g(h)"));
    }
}
