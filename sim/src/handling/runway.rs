//! Take-off and landing on a level, paved runway, flown in a scene.
//!
//! The take-off: brakes off, full throttle, the elevator held neutral and pulled near the speed at which it leaves the ground;
//! the roll ends where no wheel touches. The landing begins with the wheels on the ground at a speed, flaps out, throttle
//! closed, brakes full; the roll ends at rest.

use super::performance::Figure;
use super::{control, needed};
use crate::aircraft::{AircraftState, Condition};
use crate::rigid::Model;
use crate::scene::{BodyStart, Catalogue, Command, Happening, Scene, SceneGround, Surroundings};
use crate::snapshot::StableId;
use crate::utc::UtcTime;
use glam::DVec3;
use std::sync::Arc;

/// Steps a second.
const STEP_HZ: u32 = 120;
/// Longest roll, seconds.
const LONGEST_S: u32 = 120;

/// Height of the centre of gravity over level ground at which the lowest wheel just touches, metres.
pub fn standing_height_m(model: &Model) -> f64 {
    let wheels = model.contacts.iter().filter(|one| one.rolling.is_some());
    wheels.map(|one| one.at_m.z + one.radius_m - model.cg_m.z).fold(0.0, f64::max)
}

/// A scene with one body on a level runway at sea level, northward, at a speed.
///
/// # Errors
/// A sentence: the body cannot be.
pub fn on_runway(model: &Arc<Model>, speed_mps: f64) -> Result<(Scene, StableId, SceneGround), String> {
    let mut catalogue = Catalogue::new();
    catalogue.add_model("body", (**model).clone()).map_err(|error| error.to_string())?;
    let far = AircraftState::level(DVec3::new(0.0, 9_000.0, 0.0), 0.0, 150.0);
    let date = UtcTime { unix_ns: 0 };
    let mut scene = Scene::furnished(far, date, STEP_HZ, Surroundings::default(), Arc::new(catalogue))
        .map_err(|error| error.to_string())?;
    let start = BodyStart {
        model: "body".to_owned(),
        position_m: DVec3::Y * standing_height_m(model),
        velocity_mps: DVec3::NEG_Z * speed_mps,
        attitude: crate::frame::attitude(crate::frame::Angles::default()),
        rates_radps: DVec3::ZERO,
        fuel: None,
    };
    let id = scene.add_body(&start).map_err(|error| error.to_string())?;
    Ok((scene, id, SceneGround::heights(|_, _| Some(0.0))))
}

/// A control by its stem, at a part of its way from 0 to its end.
pub(crate) fn set(scene: &mut Scene, model: &Model, id: StableId, stem: &str, part: f64) -> Result<(), String> {
    let Some(place) = control(model, stem) else { return Ok(()) };
    let of = &model.controls[place];
    let value = if part < 0.0 { -part * of.min } else { part * of.max };
    let order = Command::Control { id, control: of.name.clone(), value };
    scene.order(order).map_err(|error| error.to_string())
}

/// What a roll ended with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roll {
    /// Way over the ground, metres.
    pub way_m: f64,
    /// Speed at its end, m/s.
    pub speed_mps: f64,
}

fn crashed(scene: &Scene) -> Option<String> {
    scene.snapshot().events.iter().find_map(|event| match &event.what {
        Happening::Crash { reason, .. } => Some(reason.words().to_owned()),
        _ => None,
    })
}

/// The ground roll of a take-off.
///
/// # Errors
/// A sentence: a control is missing, it does not leave the ground, or it breaks.
pub fn takeoff(model: &Arc<Model>, lifts_off_mps: f64) -> Result<Roll, String> {
    needed(model, "throttle")?;
    let (mut scene, id, ground) = on_runway(model, 0.0)?;
    let order = |scene: &mut Scene, stem, part| set(scene, model, id, stem, part);
    // It settles on its wheels and runs up against its brakes.
    order(&mut scene, "parking_brake", 1.0)?;
    order(&mut scene, "throttle", 1.0)?;
    for _ in 0..3 * STEP_HZ {
        scene.step(&ground);
    }
    order(&mut scene, "parking_brake", 0.0)?;
    let from = scene.snapshot().bodies[0].position_m;
    for _ in 0..LONGEST_S * STEP_HZ {
        scene.step(&ground);
        let now = scene.snapshot().bodies[0];
        let speed_mps = now.velocity_mps.length();
        if now.condition == Condition::Crashed {
            return Err(crashed(&scene).unwrap_or_default());
        }
        if now.condition == Condition::Flying && speed_mps > 0.5 * lifts_off_mps {
            return Ok(Roll { way_m: from.z - now.position_m.z, speed_mps });
        }
        order(&mut scene, "elevator", if speed_mps > 0.93 * lifts_off_mps { 0.5 } else { 0.0 })?;
        steer(&mut scene, model, id, &now)?;
    }
    Err(format!("expected it to leave the ground within {LONGEST_S} s, found it on the ground"))
}

/// Holds the runway's heading with the pedals and the wings level.
fn steer(scene: &mut Scene, model: &Model, id: StableId, now: &crate::scene::EntityView) -> Result<(), String> {
    let nose = now.attitude * DVec3::X;
    let wing = now.attitude * DVec3::Y;
    set(scene, model, id, "rudder", (-2.0 * nose.x - 0.02 * now.position_m.x).clamp(-1.0, 1.0))?;
    set(scene, model, id, "aileron", (2.0 * wing.y).clamp(-1.0, 1.0))
}

/// The ground roll of a landing with flaps full out and full brakes.
///
/// # Errors
/// A sentence: a control is missing, it does not stop, or it breaks.
pub fn landing(model: &Arc<Model>, touches_mps: f64) -> Result<Roll, String> {
    let (mut scene, id, ground) = on_runway(model, touches_mps)?;
    for stem in ["flaps", "brake_left", "brake_right"] {
        set(&mut scene, model, id, stem, 1.0)?;
    }
    let from = scene.snapshot().bodies[0].position_m;
    for _ in 0..LONGEST_S * STEP_HZ {
        scene.step(&ground);
        let now = scene.snapshot().bodies[0];
        if now.condition == Condition::Crashed {
            return Err(crashed(&scene).unwrap_or_default());
        }
        if now.velocity_mps.length() < 0.05 {
            return Ok(Roll { way_m: from.z - now.position_m.z, speed_mps: 0.0 });
        }
        set(&mut scene, model, id, "elevator", 0.3)?;
        steer(&mut scene, model, id, &now)?;
    }
    Err(format!("expected it to stop within {LONGEST_S} s, found it rolling"))
}

/// Every figure of the model's handbook that is rolled on a runway.
///
/// # Errors
/// A sentence: a roll does not end as it should.
pub fn figures(model: &Arc<Model>) -> Result<Vec<Figure>, String> {
    let Some(book) = &model.handbook else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    if let Some([speed_mps, way_m]) = book.takeoff {
        let found = takeoff(model, speed_mps)?.way_m;
        all.push(Figure { name: "take-off roll".to_owned(), unit: "m", found, handbook: way_m, within: 0.15 });
    }
    if let Some([speed_mps, way_m]) = book.landing {
        let found = landing(model, speed_mps)?.way_m;
        all.push(Figure { name: "landing roll".to_owned(), unit: "m", found, handbook: way_m, within: 0.15 });
    }
    Ok(all)
}
