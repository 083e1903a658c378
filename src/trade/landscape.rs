//! The knobs of what stands on the ground and of the air: plants, haze, the ground's detail.
//!
//! Priced where they show: at the low and near places of the embedded gallery, by day; over another world at the other
//! knobs' cameras. Plants and detail are compared with the most there is; haze with 1,000 steps of the same air, which
//! is what the figure's error is of, in parts of the radiance.

use super::Effort;
use super::knobs::{Setting, Value};
use super::stage::{Actor, play};
use crate::bench::cameras::Camera;
use crate::failure::Failure;
use crate::report::{Knob, KnobPoint};
use crate::scenery::{Content, Look};
use crate::views::Views;
use terrain::Ground;
use visual::passes::terrain::TerrainLook;
use visual::sky::{HazeGrade, haze_error};

/// Cameras at most, and in a quick run.
const CAMERAS: usize = 8;
const QUICK_CAMERAS: usize = 3;
/// Visibility that the haze's error is taken at: a clear day.
const VISIBILITY_M: f64 = 60_000.0;
/// The lowest sun that counts as day, sine of its elevation.
const DAY: f64 = 0.3;

/// Measures them.
///
/// # Errors
/// What a device reports.
pub(super) fn knobs(all: &Setting<'_>, tell: &mut dyn FnMut(&str)) -> Result<Vec<Knob>, Failure> {
    let setting = Setting { cameras: cameras(all)?, world: all.world, look: all.look, ..*all };
    let most = reference(&setting)?;
    let effort = setting.effort;
    let mut knobs = Vec::new();

    tell("plants");
    let shares: &[f64] = if effort.quick { &[0.0, 0.4, 1.0] } else { &[0.0, 0.1, 0.2, 0.4, 0.7, 1.0] };
    let plants =
        |share: f64| Look { content: Content { plants: share as f32, ..setting.look.content }, ..setting.look };
    knobs.push(setting.knob("plants", "share of all", &against("all plants"), values(shares, plants), &most, grey)?);

    tell("reach");
    let reaches: &[f64] =
        if effort.quick { &[2_500.0, 5_000.0, 13_000.0] } else { &[1_000.0, 2_500.0, 5_000.0, 8_000.0, 13_000.0] };
    let reach = |reach_m: f64| Look { content: Content { reach_m, ..setting.look.content }, ..setting.look };
    let unit = against("all within the near zone");
    knobs.push(setting.knob("reach of what stands", "m", &unit, values(reaches, reach), &most, grey)?);

    tell("haze");
    let grade = |number: f64| if number < 0.5 { HazeGrade::Horizon } else { HazeGrade::Table };
    let haze = |number: f64| Look { haze: grade(number), ..setting.look };
    let unit = format!("of the radiance, mean over 1 to 72 km at a visibility of {:.0} km", VISIBILITY_M * 1e-3);
    let mut knob = setting.knob("haze", "grade", &unit, values(&[0.0, 1.0], haze), &most, grey)?;
    for point in &mut knob.points {
        let error = haze_error(grade(point.setting), VISIBILITY_M);
        (point.error, point.error_max) = (error.mean, Some(error.max));
        point.label = Some(if point.setting < 0.5 { "the sky's own light" } else { "table" }.into());
    }
    knobs.push(knob);

    tell("ground detail");
    let detail =
        |scales: f64| Look { ground: TerrainLook { detail: scales as u32, ..setting.look.ground }, ..setting.look };
    let unit = against("both scales");
    knobs.push(setting.knob("ground detail", "scales read", &unit, values(&[0.0, 1.0, 2.0], detail), &most, grey)?);
    Ok(knobs)
}

fn against(what: &str) -> String {
    format!("grey of 255, root mean square of the picture against {what}")
}

fn values(settings: &[f64], look: impl Fn(f64) -> Look) -> Vec<Value> {
    settings.iter().map(|&setting| Value { setting, look: look(setting) }).collect()
}

fn grey(_: &super::stage::Seen, grey: f64) -> KnobPoint {
    KnobPoint { error: grey, ..KnobPoint::default() }
}

/// The places of the gallery where it is day.
fn cameras(all: &Setting<'_>) -> Result<Vec<Camera>, Failure> {
    let area = Ground::new(all.world.field.clone()).whole();
    let Ok(places) = Views::read(None).and_then(|views| views.places(all.world, &area)) else {
        return Ok(all.cameras.clone());
    };
    let lit = places.into_iter().filter(|place| place.stand.heavens.to_sun.y > DAY && place.visibility_m.is_none());
    let low: Vec<Camera> =
        lit.map(|place| Camera { eye_m: place.stand.eye_m, attitude: place.stand.attitude }).collect();
    let most = if all.effort.quick { QUICK_CAMERAS } else { CAMERAS };
    let stride = low.len().div_ceil(most).max(1);
    Ok(low.into_iter().step_by(stride).collect())
}

/// The pictures with all there is.
fn reference(setting: &Setting<'_>) -> Result<Vec<visual::capture::Picture>, Failure> {
    let look = Look {
        content: Content::ALL,
        ground: TerrainLook { detail: 2, ..setting.look.ground },
        haze: HazeGrade::Table,
        ..setting.look
    };
    let mut actors = [Actor::new(setting.world, look)?];
    play(&mut actors, &setting.cameras, setting.to_sun, &Effort { rounds: 0, ..*setting.effort })?;
    let [actor] = actors;
    Ok(actor.into_pictures())
}
