//! Trim: the controls and angles that hold a state.
//!
//! With up to three unknowns, what must vanish is the forward and the vertical acceleration of the local frame (north,
//! east, down as it turns with the place) and the pitch acceleration; with more also the sideward, roll and yaw ones.
//! Rates given in the local or Earth frame follow the attitude while it is varied. The search is Levenberg and
//! Marquardt's with differences for derivatives; controls stay within their limits.
//!
//! m/s2 and rad/s2. Source: D. W. Marquardt, SIAM J. Applied Mathematics 11, 1963.

use super::model::Model;
use super::motion::{self, RigidMotion, State};
use super::quantity::without_unit;
use super::start;
use crate::case::{Attitude, Initial, Setting, Trim, Velocity};
use crate::integrate::Motion;
use glam::DVec3;
use std::sync::Arc;

/// Accelerations that count as none, m/s2 and rad/s2.
pub const HELD: f64 = 1e-9;

/// What trim found.
#[derive(Debug, Clone, PartialEq)]
pub struct Trimmed {
    /// The initial condition with the angles and the speed found.
    pub initial: Initial,
    /// Names and values found, in the units of the names.
    pub values: Vec<(String, f64)>,
    /// Names and sizes of what is left.
    pub residuals: Vec<(&'static str, f64)>,
}

const RESIDUALS: [&str; 6] =
    ["forward_mps2", "vertical_mps2", "pitch_radps2", "sideward_mps2", "roll_radps2", "yaw_radps2"];

/// A thing that is varied.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Unknown {
    Control(usize),
    Roll,
    Pitch,
    Yaw,
    Alpha,
    Speed,
}

/// Finds what holds the state of an initial condition, and leaves the controls of `motion` there.
///
/// # Errors
/// A sentence: an unknown is not known, or what is left is above [`HELD`].
pub fn trim(motion: &mut RigidMotion, initial: &Initial, wanted: &Trim) -> Result<Trimmed, String> {
    let model = motion.model.clone();
    for (name, setting) in &wanted.set {
        if let (Some(place), Setting::Number(value)) = (model.control(name), setting) {
            motion.controls[place] = checked(&model, place, *value)?;
        }
    }
    if wanted.vary.is_empty() || wanted.vary.len() > RESIDUALS.len() {
        let found = wanted.vary.len();
        return Err(format!("trim.vary: expected 1 to {} names, found {found}", RESIDUALS.len()));
    }
    if let Some(twice) = (1..wanted.vary.len()).find(|&i| wanted.vary[..i].contains(&wanted.vary[i])) {
        return Err(format!("trim.vary: expected each name once, found {} again", wanted.vary[twice]));
    }
    let meant = wanted.vary.iter().map(|name| unknown(&model, name)).collect::<Result<Vec<_>, _>>()?;
    let (unknowns, units): (Vec<Unknown>, Vec<f64>) = meant.into_iter().unzip();
    let mut angles = match initial.attitude {
        Attitude::Angles(angles) => angles,
        Attitude::Quaternion(_) => motion::angles_of(&glam::DMat3::from_quat(start::ned_from_body(&initial.attitude))),
    };
    if unknowns.contains(&Unknown::Alpha) {
        if matches!(initial.velocity, Velocity::Body(_)) {
            return Err("trim.vary: alpha_deg: expected velocity_ned_mps, velocity_body_mps fixes it".to_owned());
        }
        // An angle of attack is counted from the path.
        angles[1] = 0.0;
    }
    let (Velocity::Ned(velocity) | Velocity::Body(velocity)) = initial.velocity;
    if velocity == DVec3::ZERO && !unknowns.contains(&Unknown::Speed) {
        return Err("trim: expected a velocity in [initial] to hold, found none".to_owned());
    }
    let problem = Problem { initial, angles, unknowns: &unknowns };
    let mut x: Vec<f64> = unknowns.iter().map(|unknown| problem.value(motion, *unknown)).collect();
    let many = if unknowns.len() <= 3 { 3 } else { 6 };
    let mut left = problem.residuals(motion, &x, many);
    let mut damping = 1e-6;
    for _ in 0..200 {
        if size(&left) < 0.01 * HELD {
            break;
        }
        let columns: Vec<Vec<f64>> = (0..x.len())
            .map(|i| {
                let small = 1e-6 * problem.scale(motion, unknowns[i]);
                let mut at = |by: f64| {
                    let mut moved = x.clone();
                    moved[i] += by;
                    problem.residuals(motion, &moved, many)
                };
                let (above, below) = (at(small), at(-small));
                above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * small)).collect()
            })
            .collect();
        let Some(step) = damped_step(&columns, &left, damping) else { break };
        let tried: Vec<f64> =
            x.iter().zip(&step).zip(&unknowns).map(|((x, s), u)| limited(&model, *u, x - s)).collect();
        let after = problem.residuals(motion, &tried, many);
        if size(&after) < size(&left) {
            (x, left) = (tried, after);
            damping = (damping * 0.1).max(1e-15);
        } else {
            damping *= 10.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    let found = problem.apply(motion, &x);
    motion.settle_shaft(&start::state(&motion.planet, &found));
    let residuals: Vec<(&'static str, f64)> = RESIDUALS.into_iter().zip(left.iter().copied()).collect();
    if size(&left) >= HELD {
        let told: Vec<String> = residuals.iter().map(|(name, value)| format!("{name} {value:.3e}")).collect();
        let at = wanted.vary.iter().zip(x.iter().zip(&units));
        let at: Vec<String> = at.map(|(name, (x, si))| format!("{name} {}", x / si)).collect();
        let limits = unknowns.iter().zip(&x).filter_map(|(unknown, x)| match unknown {
            Unknown::Control(place) => {
                let control = &model.controls[*place];
                (*x <= control.min || *x >= control.max).then(|| format!("; {} stands at its limit", control.name))
            }
            _ => None,
        });
        let limits: String = limits.collect();
        return Err(format!(
            "trim: no balance found; nearest: {} left over at {}{limits}; {many} accelerations take {many} unknowns",
            told.join(", "),
            at.join(", ")
        ));
    }
    let values = wanted.vary.iter().cloned().zip(x.iter().zip(&units).map(|(x, si)| x / si));
    Ok(Trimmed { initial: found, values: values.collect(), residuals })
}

/// What a name means, and what one of its unit is in SI.
fn unknown(model: &Model, name: &str) -> Result<(Unknown, f64), String> {
    if let Some(place) = model.control(name) {
        // A control is varied in its own unit.
        return Ok((Unknown::Control(place), 1.0));
    }
    let known = match without_unit(name) {
        Some(("roll" | "phi", si)) => Some((Unknown::Roll, si)),
        Some(("pitch" | "theta", si)) => Some((Unknown::Pitch, si)),
        Some(("yaw" | "psi", si)) => Some((Unknown::Yaw, si)),
        Some(("alpha", si)) => Some((Unknown::Alpha, si)),
        Some(("speed", si)) => Some((Unknown::Speed, si)),
        _ => None,
    };
    known.ok_or_else(|| {
        let controls: Vec<&str> = model.controls.iter().map(|control| control.name.as_str()).collect();
        format!(
            "trim.vary: expected roll_deg, pitch_deg, yaw_deg, alpha_deg, speed_mps or a control [{}], found {name}",
            controls.join(", ")
        )
    })
}

fn checked(model: &Arc<Model>, place: usize, value: f64) -> Result<f64, String> {
    let control = &model.controls[place];
    if (control.min..=control.max).contains(&value) {
        Ok(value)
    } else {
        let (name, min, max) = (&control.name, control.min, control.max);
        Err(format!("trim.set.{name}: expected a number within {min} and {max}, found {value}"))
    }
}

fn limited(model: &Model, unknown: Unknown, value: f64) -> f64 {
    match unknown {
        Unknown::Control(place) => value.clamp(model.controls[place].min, model.controls[place].max),
        Unknown::Speed => value.clamp(0.0, 1e5),
        _ => value.clamp(-std::f64::consts::PI, std::f64::consts::PI),
    }
}

struct Problem<'a> {
    initial: &'a Initial,
    angles: [f64; 3],
    unknowns: &'a [Unknown],
}

impl Problem<'_> {
    fn value(&self, motion: &RigidMotion, unknown: Unknown) -> f64 {
        let (Velocity::Ned(velocity) | Velocity::Body(velocity)) = self.initial.velocity;
        match unknown {
            Unknown::Control(place) => motion.controls[place],
            Unknown::Roll => self.angles[0],
            Unknown::Pitch => self.angles[1],
            Unknown::Yaw => self.angles[2],
            Unknown::Alpha => 0.02,
            Unknown::Speed => velocity.length(),
        }
    }

    /// The pitch at which the angle of attack is a given one, at the roll and yaw of `angles`.
    fn pitch_rad(&self, motion: &RigidMotion, velocity: &Velocity, angles: [f64; 3], alpha_rad: f64) -> f64 {
        let (Velocity::Ned(ned) | Velocity::Body(ned)) = *velocity;
        let altitude_m = self.initial.flat_m.map_or(self.initial.place.altitude_m, |at| -at.z);
        let air = ned - motion.wind.ned_mps(altitude_m);
        let [roll, _, yaw] = angles;
        let mut pitch = alpha_rad + (-air.z).atan2(air.x.hypot(air.y));
        for _ in 0..30 {
            let body = start::ned_from_body(&Attitude::Angles([roll, pitch, yaw])).inverse() * air;
            let off = alpha_rad - body.z.atan2(body.x);
            // A step of pitch is one of the angle of attack, about the cosine of the roll of it: this settles.
            pitch += off;
            if off.abs() < 1e-15 {
                break;
            }
        }
        pitch
    }

    fn scale(&self, motion: &RigidMotion, unknown: Unknown) -> f64 {
        match unknown {
            Unknown::Control(place) => {
                let control = &motion.model.controls[place];
                (control.max - control.min).clamp(1e-6, 1e6)
            }
            Unknown::Speed => 100.0,
            _ => 1.0,
        }
    }

    /// Sets controls and gives the initial condition at a guess.
    fn apply(&self, motion: &mut RigidMotion, x: &[f64]) -> Initial {
        let mut angles = self.angles;
        let mut initial = *self.initial;
        let mut alpha_rad = None;
        for (unknown, value) in self.unknowns.iter().zip(x) {
            match unknown {
                Unknown::Control(place) => motion.controls[*place] = *value,
                Unknown::Roll => angles[0] = *value,
                Unknown::Pitch => angles[1] = *value,
                Unknown::Yaw => angles[2] = *value,
                Unknown::Alpha => alpha_rad = Some(*value),
                Unknown::Speed => initial.velocity = at_speed(&initial.velocity, *value),
            }
        }
        if let Some(alpha_rad) = alpha_rad {
            angles[1] = self.pitch_rad(motion, &initial.velocity, angles, alpha_rad);
        }
        initial.attitude = Attitude::Angles(angles);
        initial
    }

    fn residuals(&self, motion: &mut RigidMotion, x: &[f64], many: usize) -> Vec<f64> {
        let initial = self.apply(motion, x);
        let y = start::state(&motion.planet, &initial);
        motion.settle_shaft(&y);
        accelerations(motion, &y)[..many].to_vec()
    }
}

/// The six accelerations of [`RESIDUALS`].
fn accelerations(motion: &RigidMotion, y: &State) -> [f64; 6] {
    let rate = motion.rate(0.0, y);
    let place = motion.planet.place(motion::position(y));
    let frame_from_ned = motion.planet.frame_from_ned(place);
    let ned = frame_from_ned.transpose() * motion::velocity(y);
    let frame = DVec3::new(rate[8], rate[9], rate[10]);
    let local = frame_from_ned.transpose() * frame - motion.planet.transport_radps(place, ned).cross(ned);
    let nose = frame_from_ned.transpose() * (motion::attitude(y) * DVec3::X);
    let level = DVec3::new(ned.x, ned.y, 0.0);
    let ahead = if level.length() > 0.1 { level } else { DVec3::new(nose.x, nose.y, 0.0) }.normalize_or(DVec3::X);
    let right = DVec3::new(-ahead.y, ahead.x, 0.0);
    [local.dot(ahead), local.z, rate[12], local.dot(right), rate[11], rate[13]]
}

fn at_speed(velocity: &Velocity, speed_mps: f64) -> Velocity {
    let scaled = |v: DVec3| v.normalize_or(DVec3::X) * speed_mps;
    match *velocity {
        Velocity::Ned(ned) => Velocity::Ned(scaled(ned)),
        Velocity::Body(body) => Velocity::Body(scaled(body)),
    }
}

fn size(all: &[f64]) -> f64 {
    let squares = all.iter().map(|x| x * x).sum::<f64>();
    if squares.is_nan() { f64::INFINITY } else { squares.sqrt() }
}

/// The step of (J'J + damping diag(J'J)) s = J' r, by elimination.
fn damped_step(columns: &[Vec<f64>], left: &[f64], damping: f64) -> Option<Vec<f64>> {
    let n = columns.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row: Vec<f64> = (0..n).map(|j| dot(&columns[i], &columns[j])).collect();
            row[i] = row[i] * (1.0 + damping) + f64::MIN_POSITIVE;
            row.push(dot(&columns[i], left));
            row
        })
        .collect();
    for i in 0..n {
        let best = (i..n).max_by(|a, b| rows[*a][i].abs().total_cmp(&rows[*b][i].abs()))?;
        rows.swap(i, best);
        let pivot = rows[i].clone();
        if pivot[i] == 0.0 {
            return None;
        }
        for row in rows.iter_mut().skip(i + 1) {
            let by = row[i] / pivot[i];
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= by * p);
        }
    }
    let mut step = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| rows[i][j] * step[j]).sum();
        step[i] = (rows[i][n] - known) / rows[i][i];
    }
    step.iter().all(|s| s.is_finite()).then_some(step)
}

/// What a column of the trimmed state is worth in SI, by the unit that its name ends with.
pub fn si_of_column(name: &str, value: f64) -> f64 {
    value * without_unit(name).map_or(1.0, |(_, si)| si)
}
