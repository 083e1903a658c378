//! From a simulated scene to what is drawn of it: eye, attitude, sun, head-up display.
//!
//! The one file that knows both the simulation and the picture. The eye is the aircraft's reference point to the bit, in
//! f64; the attitude given here turns view axes (x right, y up, z backward) into the world's.

pub mod effects;

use crate::hud::{self, Anchor, HudInput};
use crate::scenery::{self, Heavens};
use glam::{DQuat, DVec3, Vec2};
use sim::input::Head;
use sim::{HeightAt, Snapshot, UtcTime};
use std::sync::Arc;
use terrain::Area;
use terrain::store::World;
use visual::camera::View;
use visual::passes::lines::{self, Align, Stroke};

/// How much wider than the font's own its lines are drawn: thin ones are lost before snow.
const BOLDER: f32 = 1.25;

/// What the display says beside the flight itself.
#[derive(Debug, Clone, Copy, Default)]
pub struct Captions<'a> {
    /// Time of the last frame, milliseconds; not shown if it is not a time.
    pub frame_ms: f64,
    /// States in capitals, after the simulation's own.
    pub status: &'a [&'a str],
    /// What a pilot can do next.
    pub hint: &'a str,
}

/// The ground as the simulation asks for it.
pub fn height_at(area: &Area) -> Arc<HeightAt> {
    let area = area.clone();
    Arc::new(move |x_m, z_m| area.height_m(x_m, z_m))
}

/// The eye, world metres.
pub fn eye_m(snapshot: &Snapshot) -> DVec3 {
    snapshot.aircraft.position_m
}

/// View axes to the world's, for a head turned from the nose.
pub fn attitude(snapshot: &Snapshot, head: &Head) -> DQuat {
    let nose = sim::frame::view_attitude(snapshot.aircraft.attitude);
    // The airframe's shake before and in a stall; the head's turn about it.
    let [up, right] = snapshot.instruments.map_or([0.0; 2], |shown| shown.shake_rad(snapshot.time_s));
    let nose = if up == 0.0 && right == 0.0 {
        nose
    } else {
        nose * DQuat::from_rotation_x(up) * DQuat::from_rotation_z(-right)
    };
    (nose * DQuat::from_rotation_y(-head.right_rad) * DQuat::from_rotation_x(head.up_rad)).normalize()
}

/// Plan speed of the eye, m/s: what the window of blocks builds ahead for.
pub fn ground_speed_mps(snapshot: &Snapshot) -> f64 {
    let velocity = snapshot.aircraft.velocity_mps;
    velocity.x.hypot(velocity.z)
}

/// Sun and moon over a world, taken anew each whole second of the scene's time.
#[derive(Debug, Clone, Copy)]
pub struct Sun {
    second: i64,
    heavens: Heavens,
}

impl Sun {
    /// Both at a moment.
    ///
    /// # Errors
    /// [`crate::failure::Failure::Failed`] where the sun's position is not known.
    pub fn new(world: &World, date: UtcTime) -> Result<Self, crate::failure::Failure> {
        let second = date.unix_ns.div_euclid(1_000_000_000);
        let heavens = scenery::heavens(world, UtcTime { unix_ns: second * 1_000_000_000 })?;
        Ok(Self { second, heavens })
    }

    /// Where they stand now; where the sun's position is not known, where they last stood.
    pub fn at(&mut self, world: &World, date: UtcTime) -> Heavens {
        if date.unix_ns.div_euclid(1_000_000_000) != self.second
            && let Ok(now) = Self::new(world, date)
        {
            *self = now;
        }
        self.heavens
    }
}

/// The head-up display over a view.
pub fn hud(world: &World, snapshot: &Snapshot, view: &View, head: &Head, captions: Captions<'_>) -> Vec<Stroke> {
    let aircraft = &snapshot.aircraft;
    let angles = aircraft.angles();
    let date = snapshot.date.to_string();
    let rate = format!("{}X", snapshot.rate);
    let mut status = snapshot.flags.names();
    if snapshot.rate != 1.0 {
        status.push(&rate);
    }
    if snapshot.instruments.is_some_and(|shown| shown.stall_warning) {
        status.push("STALL");
    }
    status.extend_from_slice(captions.status);
    let input = HudInput {
        speed_mps: aircraft.airspeed_mps,
        altitude_m: aircraft.position_m.y,
        height_above_ground_m: snapshot.height_above_ground_m,
        true_heading_rad: scenery::true_heading_rad(world, aircraft.position_m, angles.heading_rad),
        pitch_rad: angles.pitch_rad,
        roll_rad: angles.roll_rad,
        vertical_speed_mps: aircraft.climb_mps(),
        velocity_in_view_mps: (view.attitude.inverse() * aircraft.velocity_mps).to_array(),
        load_factor: aircraft.load_factor,
        throttle: aircraft.throttle,
        frame_ms: captions.frame_ms,
        date: &date,
        status: &status,
        hint: captions.hint,
        viewport_px: (view.size_px[0], view.size_px[1]),
        fov_y_rad: (view.top.atan() - view.bottom.atan()),
        looking_ahead: head.is_ahead(),
    };
    let (lines, texts) = hud::hud(&input);
    let mut strokes: Vec<Stroke> = lines
        .into_iter()
        .map(|line| Stroke {
            points_px: line.points_px.into_iter().map(Vec2::from).collect(),
            width_px: line.width_px,
            colour: line.colour,
        })
        .collect();
    // The font's letters are wider for their height than the display's layout counts with: they are drawn lower.
    let advance = lines::text_width_px("00", 1.0) - lines::text_width_px("0", 1.0);
    for text in texts {
        let cap_px = text.height_px * hud::ADVANCE / advance;
        let base = Vec2::from(text.at_px) + Vec2::new(0.0, 0.5 * cap_px);
        let align = match text.anchor {
            Anchor::Left => Align::Left,
            Anchor::Centre => Align::Middle,
            Anchor::Right => Align::Right,
        };
        let letters = lines::text(&text.text, base, cap_px, align, text.colour);
        strokes.extend(letters.into_iter().map(|stroke| Stroke { width_px: BOLDER * stroke.width_px, ..stroke }));
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim::aircraft::AircraftState;

    #[test]
    fn the_head_turns_the_view_about_the_pilots_axes() {
        let scene =
            sim::Scene::new(AircraftState::level(DVec3::new(0.0, 3e3, 0.0), 0.0, 200.0), UtcTime { unix_ns: 0 });
        let snapshot = scene.snapshot();
        let looks = |right_rad, up_rad| {
            let mut head = Head::default();
            (head.right_rad, head.up_rad) = (right_rad, up_rad);
            attitude(&snapshot, &head) * DVec3::NEG_Z
        };
        assert!((looks(0.0, 0.0) - DVec3::NEG_Z).length() < 1e-12);
        assert!((looks(std::f64::consts::FRAC_PI_2, 0.0) - DVec3::X).length() < 1e-12);
        assert!((looks(0.3, 0.4) - terrain::frame::direction(0.3, 0.4)).length() < 1e-12);
        assert_eq!(eye_m(&snapshot), DVec3::new(0.0, 3e3, 0.0));
    }
}
