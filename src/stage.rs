//! From a simulated scene to what is drawn of it: eye, attitude, sun, head-up display.
//!
//! The one file that knows both the simulation and the picture. The eye is the aircraft's reference point to the bit, in
//! f64; the attitude given here turns view axes (x right, y up, z backward) into the world's.

pub mod actors;
pub mod cameras;
pub mod effects;
pub mod marks;

use crate::hud::{self, Anchor, Engine, HudInput, Instruments, Sight, Store, WeaponPage};
use crate::scenery::{self, Heavens, Scenery};
use actors::Cast;
use cameras::{Camera, Cameras};
use glam::{DQuat, DVec3, Vec2};
use sim::input::Head;
use sim::scene;
use sim::weapons::{NoSolution, WeaponKind};
use sim::{HeightAt, Scene, Snapshot, UtcTime};
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
    /// Pitch and roll of a mouse that flies, -1..1.
    pub mouse: Option<[f64; 2]>,
    /// What a pilot can do next.
    pub hint: &'a str,
}

/// The ground as the simulation asks for it.
pub fn height_at(area: &Area) -> Arc<HeightAt> {
    let area = area.clone();
    Arc::new(move |x_m, z_m| area.height_m(x_m, z_m))
}

/// View axes to the world's, for a head turned from the nose.
pub fn attitude(snapshot: &Snapshot, head: &Head) -> DQuat {
    let nose = sim::frame::view_attitude(snapshot.aircraft.attitude);
    // Before and in the stall the airframe shakes: the picture, not the flight.
    let [up_rad, right_rad] = snapshot.instruments.map_or([0.0; 2], |of| of.shake_rad(snapshot.time_s));
    let nose = nose * DQuat::from_rotation_x(up_rad) * DQuat::from_rotation_z(-right_rad);
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

/// Who sees the flight: the head, the cameras, and what shapes the scene's entities have.
#[derive(Debug)]
pub struct Seat {
    /// The pilot's head.
    pub head: Head,
    /// From where it is seen.
    pub cameras: Cameras,
    cast: Cast,
}

impl Seat {
    /// For a scene over a world, beginning with a camera.
    pub fn new(world: &World, scene: &Scene, camera: Camera) -> Self {
        let cameras = Cameras::new(&world.features, camera);
        Self { head: Head::default(), cameras, cast: Cast::of(scene.catalogue()) }
    }

    /// The view of a snapshot, and whether it is from inside; what moves stands in the scenery from then on.
    pub fn view(&mut self, scenery: &mut Scenery, snapshot: &Snapshot, size_px: [u32; 2]) -> Seen {
        let eye = self.cameras.eye(snapshot, &self.head, &scenery.area);
        scenery.things.set_moving(&self.cast.shapes(snapshot, eye.inside));
        let fov_y_rad = eye.glass_rad.map_or(scenery.look.fov_y_rad, |glass| glass.min(scenery.look.fov_y_rad));
        let view = View::fov_y(eye.at_m, eye.attitude, fov_y_rad, size_px);
        Seen { view, ahead: eye.inside && self.head.is_ahead(), camera: self.cameras.now() }
    }
}

/// What is seen of a snapshot.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The view.
    pub view: View,
    /// Whether it looks along the nose: what lies on the world may be drawn over it.
    pub ahead: bool,
    /// Through which camera.
    pub camera: Camera,
}

fn stores(page: &scene::WeaponPage) -> Vec<Store<'_>> {
    page.rows.iter().map(|row| Store { name: &row.label, left: row.left }).collect()
}

/// How the selected weapon leaves, in words.
fn release(page: &scene::WeaponPage) -> String {
    let selected = page.selected.and_then(|selected| page.rows.get(selected));
    match (selected.map(|row| row.kind), page.ripple) {
        (None | Some(WeaponKind::Gun), _) => String::new(),
        (_, 1) => "SINGLE".to_owned(),
        (_, u32::MAX) => format!("ALL EVERY {} S", scene::RIPPLE_S),
        (_, ripple) => format!("{ripple} EVERY {} S", scene::RIPPLE_S),
    }
}

/// What a rigid body's instruments show; a point mass has none but its angle of attack.
fn instruments(snapshot: &Snapshot) -> Instruments {
    let qnh_pa = Some(snapshot.air_data.setting_pa);
    let Some(of) = &snapshot.instruments else { return Instruments { qnh_pa, ..Instruments::default() } };
    let levers = &snapshot.levers;
    let shown = |[now, most]: [f64; 2]| (most > 0.0).then_some([now, most]);
    Instruments {
        side_g: Some(of.side_g),
        alpha_rad: (snapshot.aircraft.airspeed_mps > 10.0).then_some(snapshot.aircraft.alpha_rad),
        stalling: of.stall_warning,
        qnh_pa,
        engine: shown(of.rpm).map(|[rpm, most_rpm]| Engine {
            rpm,
            most_rpm,
            throttle: of.throttle,
            mixture: Some(levers.mixture),
            running: rpm > 100.0,
        }),
        fuel_kg: shown(of.fuel_kg),
        flaps_rad: shown(of.flaps).map(|flaps| flaps.map(f64::to_radians)),
        trim: Some(levers.trim),
        gear: of.gear,
        brakes: Some(levers.brakes[0].max(levers.brakes[1])),
        parked: levers.parking_brake > 0.5,
    }
}

/// The prediction of a page in the axes of a view: a gun's pipper at its range, else the point of impact.
fn sight<'a>(page: &scene::WeaponPage, view: &View) -> Sight<'a> {
    let in_view_m = |at_m: DVec3| (view.attitude.inverse() * (at_m - view.eye_m)).to_array();
    match &page.ccip {
        Ok(found) => match found.pipper {
            Some(pipper) => Sight::Impact { in_view_m: in_view_m(pipper.point_m), time_s: pipper.time_s, safe: true },
            None => Sight::Impact {
                in_view_m: in_view_m(found.point_m),
                time_s: found.time_s,
                safe: found.safe && found.armed,
            },
        },
        Err(NoSolution::NoWeapon) => Sight::Off,
        Err(NoSolution::NothingWithin(_)) => Sight::None("no impact in reach"),
        Err(NoSolution::LeavesWorld) => Sight::None("no ground there"),
        Err(NoSolution::Stiff) => Sight::None("no solution"),
    }
}

/// The display's brightness by the sun's height: 1 by day, dim at night.
fn brightness(heavens: &Heavens) -> f64 {
    const NIGHT: f64 = 0.35;
    // From sunset to the end of nautical twilight, 12 degrees.
    let night = (-heavens.to_sun.y / 12f64.to_radians().sin()).clamp(0.0, 1.0);
    1.0 + (NIGHT - 1.0) * night
}

/// The head-up display over a view.
pub fn hud(world: &World, snapshot: &Snapshot, seen: &Seen, heavens: &Heavens, captions: Captions<'_>) -> Vec<Stroke> {
    let view = &seen.view;
    let aircraft = &snapshot.aircraft;
    let angles = aircraft.angles();
    let date = snapshot.date.to_string();
    let rate = format!("{}X", snapshot.rate);
    let mut status = snapshot.flags.names();
    if snapshot.rate != 1.0 {
        status.push(&rate);
    }
    if seen.camera != Camera::Cockpit {
        status.push(seen.camera.name());
    }
    status.extend_from_slice(captions.status);
    let stores = snapshot.weapons.as_ref().map(|page| stores(page)).unwrap_or_default();
    let release = snapshot.weapons.as_ref().map(|page| release(page)).unwrap_or_default();
    let weapons = snapshot.weapons.as_ref().map(|page| WeaponPage {
        stores: &stores,
        selected: page.selected,
        armed: page.master,
        release: &release,
        sight: sight(page, view),
    });
    let input = HudInput {
        speed_mps: snapshot.air_data.airspeed_mps,
        altitude_m: snapshot.air_data.altitude_m,
        height_above_ground_m: snapshot.height_above_ground_m,
        true_heading_rad: scenery::true_heading_rad(world, aircraft.position_m, angles.heading_rad),
        pitch_rad: angles.pitch_rad,
        roll_rad: angles.roll_rad,
        vertical_speed_mps: aircraft.climb_mps(),
        velocity_in_view_mps: (view.attitude.inverse() * aircraft.velocity_mps).to_array(),
        load_factor: aircraft.load_factor,
        throttle: snapshot.instruments.map_or(aircraft.throttle, |of| of.throttle),
        frame_ms: captions.frame_ms,
        date: &date,
        status: &status,
        hint: captions.hint,
        mouse: captions.mouse,
        viewport_px: (view.size_px[0], view.size_px[1]),
        fov_y_rad: (view.top.atan() - view.bottom.atan()),
        instruments: instruments(snapshot),
        weapons,
        brightness: brightness(heavens),
        looking_ahead: seen.ahead,
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
        let scene = Scene::new(AircraftState::level(DVec3::new(0.0, 3e3, 0.0), 0.0, 200.0), UtcTime { unix_ns: 0 });
        let snapshot = scene.snapshot();
        let looks = |right_rad, up_rad| {
            let mut head = Head::default();
            (head.right_rad, head.up_rad) = (right_rad, up_rad);
            attitude(&snapshot, &head) * DVec3::NEG_Z
        };
        assert!((looks(0.0, 0.0) - DVec3::NEG_Z).length() < 1e-12);
        assert!((looks(std::f64::consts::FRAC_PI_2, 0.0) - DVec3::X).length() < 1e-12);
        assert!((looks(0.3, 0.4) - terrain::frame::direction(0.3, 0.4)).length() < 1e-12);
    }
}
