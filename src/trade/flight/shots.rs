//! The step of a shell: where it comes down after steps of 1 to 1,000 ms against where it comes down with the finest.
//!
//! Setting: milliseconds. Error: metres on the ground at the greatest range over a flat Earth with standard air. Cost:
//! microseconds a simulated second of the whole flight, with the search for its end. Reference: rk4 with steps of an
//! eighth of a millisecond. Drag curves bend at their nodes, which no rule of high order steps over at its full order;
//! coarse steps are cut in pieces where drag is stiff (see `sim::ballistics::motion`), so their curve flattens.

use super::ballistics::{PROJECTILES, case, farthest_deg};
use super::{Effort, best, costs_s};
use crate::failure::Failure;
use crate::report::{Knob, KnobPoint};
use sim::ballistics::column::Column;
use sim::ballistics::projectile::Projectile;
use sim::ballistics::trajectory::fly;
use std::hint::black_box;
use std::path::Path;

const STEPS_MS: [f64; 10] = [1_000.0, 500.0, 200.0, 100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0];
const QUICK_MS: [f64; 5] = [1_000.0, 200.0, 50.0, 10.0, 2.0];
const REFERENCE_MS: f64 = 0.125;

/// A knob for each projectile.
///
/// # Errors
/// [`Failure::Failed`] if a built-in projectile cannot be flown.
pub fn knobs(effort: Effort) -> Result<Vec<Knob>, Failure> {
    let rows: &[f64] = if effort.quick { &QUICK_MS } else { &STEPS_MS };
    let mut knobs = Vec::new();
    for (name, text, speed_mps) in PROJECTILES {
        let failed = |error: String| Failure::while_doing("flying a built-in projectile", error);
        let projectile = Projectile::from_text(Path::new("projectile"), text).map_err(|e| failed(e.to_string()))?;
        let degrees = farthest_deg(text, speed_mps)?;
        let end = |step_ms: f64| {
            let case = case("", "us1976", speed_mps, degrees, step_ms * 1e-3, "")?;
            let flown = fly(&projectile, &case, None).map_err(|e| failed(e.to_string()))?;
            let aside_m = flown.end().get(Column::Z).unwrap_or(f64::NAN);
            let time_s = flown.end().get(Column::Time).unwrap_or(f64::NAN);
            Ok::<_, Failure>(([flown.range_m, aside_m], time_s))
        };
        let ([reach_m, aside_m], _) = end(REFERENCE_MS)?;
        let mut points = Vec::new();
        let mut works: Vec<Box<dyn FnMut() + '_>> = Vec::new();
        for &step_ms in rows {
            let ([to_m, to_aside_m], time_s) = end(step_ms)?;
            points.push((step_ms, (to_m - reach_m).hypot(to_aside_m - aside_m), time_s));
            works.push(Box::new(move || {
                let _ = black_box(end(black_box(step_ms)));
            }));
        }
        let costs_s = costs_s(effort.rounds, &mut works)?;
        let points: Vec<KnobPoint> = points
            .iter()
            .zip(costs_s)
            .map(|(&(setting, error, time_s), cost_s)| KnobPoint {
                setting,
                error,
                cost: cost_s * 1e6 / time_s,
                ..KnobPoint::default()
            })
            .collect();
        knobs.push(Knob {
            name: format!("shell step {name}"),
            unit: "ms".into(),
            error_unit: format!("m on the ground at the greatest range, from steps of {REFERENCE_MS} ms"),
            cost_unit: "microseconds a simulated second".into(),
            group: Some("shell step".into()),
            best: best(&points),
            points,
        });
    }
    Ok(knobs)
}
