//! Keeps the sky's light up to date as the sun moves, the eye climbs and the visibility changes.
//!
//! A new table is made only when one of them has moved far enough to be seen. In the background it is made by a short
//! thread and taken over when ready; otherwise the caller waits (a few milliseconds in a release build).

use crate::frame::Scene;
use crate::moon::Moonlight;
use crate::sky::{Air, HazeGrade, Light};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Sun elevation that is passed over, radians: a quarter of a degree.
const SUN_STEP_RAD: f64 = 0.25 * std::f64::consts::PI / 180.0;
/// Altitude that is passed over, metres: 3 % of the molecules' scale height, about one grey level of sky.
const ALTITUDE_STEP_M: f64 = 250.0;

#[derive(Clone, Copy, PartialEq)]
struct Wanted {
    sun_elevation_rad: f64,
    altitude_m: f64,
    visibility_m: f64,
    haze_base_m: f64,
    moon: Moonlight,
    haze: HazeGrade,
    view_range_m: f64,
}

/// Elevation of the moon that is passed over, radians.
const MOON_STEP_RAD: f64 = std::f64::consts::PI / 180.0;
/// Share of the full moon's light that is passed over.
const MOON_STEP: f64 = 0.01;
/// The moon's light is nothing beside a sun above this elevation, radians.
const MOON_DARK_RAD: f64 = -std::f64::consts::PI / 180.0;

impl Wanted {
    fn near(&self, other: &Self) -> bool {
        (self.sun_elevation_rad - other.sun_elevation_rad).abs() <= SUN_STEP_RAD
            && (self.altitude_m - other.altitude_m).abs() <= other.altitude_step_m()
            && (self.moon.elevation_rad - other.moon.elevation_rad).abs() <= MOON_STEP_RAD
            && (self.moon.share - other.moon.share).abs() <= MOON_STEP
            && self.view_range_m == other.view_range_m
            && self.same_air(other)
    }

    /// In thin fog a smaller step is seen.
    fn altitude_step_m(&self) -> f64 {
        ALTITUDE_STEP_M.min(0.2 * f64::from(crate::sky::haze_scale_m(self.visibility_m)))
    }

    fn same_air(&self, other: &Self) -> bool {
        self.visibility_m == other.visibility_m && self.haze_base_m == other.haze_base_m
    }
}

/// The light in use and the one being made.
pub struct SkyFeed {
    in_background: bool,
    haze: HazeGrade,
    current: Option<(Wanted, Arc<Air>, Light)>,
    coming: Option<Receiver<(Wanted, Arc<Air>, Light)>>,
}

impl SkyFeed {
    /// An empty feed; the first [`SkyFeed::update`] always waits.
    pub fn new(in_background: bool, haze: HazeGrade) -> Self {
        Self { in_background, haze, current: None, coming: None }
    }

    /// The light in use.
    pub fn light(&self) -> Option<&Light> {
        self.current.as_ref().map(|(_, _, light)| light)
    }

    /// Asks for the light of a sane scene at an eye's altitude; true where the light in use has changed.
    pub fn update(&mut self, scene: &Scene, altitude_m: f64) -> bool {
        let wanted = Wanted {
            sun_elevation_rad: scene.sun_elevation_rad(),
            altitude_m: if altitude_m.is_finite() { altitude_m.clamp(0.0, 60_000.0) } else { 0.0 },
            visibility_m: scene.visibility_m,
            haze_base_m: scene.haze_base_m,
            moon: if scene.sun_elevation_rad() < MOON_DARK_RAD { Moonlight::of(scene) } else { Moonlight::default() },
            haze: self.haze,
            view_range_m: scene.view_range_m,
        };
        let mut changed = false;
        if let Some(coming) = &self.coming {
            match coming.try_recv() {
                Ok(made) => {
                    self.current = Some(made);
                    self.coming = None;
                    changed = true;
                }
                Err(TryRecvError::Empty) => return false,
                Err(TryRecvError::Disconnected) => self.coming = None,
            }
        }
        if self.current.as_ref().is_some_and(|(have, _, _)| have.near(&wanted)) {
            return changed;
        }
        let air = self.current.as_ref().filter(|(have, _, _)| have.same_air(&wanted)).map(|(_, air, _)| air.clone());
        if self.in_background && self.current.is_some() {
            let (sender, receiver) = channel();
            let spare = air.clone();
            let made = std::thread::Builder::new().name("sky".into()).spawn(move || {
                // The receiver is gone only where the renderer is; then nobody wants the light.
                let _ = sender.send(make(wanted, spare));
            });
            if made.is_ok() {
                self.coming = Some(receiver);
                return changed;
            }
        }
        self.current = Some(make(wanted, air));
        true
    }
}

fn make(wanted: Wanted, air: Option<Arc<Air>>) -> (Wanted, Arc<Air>, Light) {
    let air = air.unwrap_or_else(|| Arc::new(Air::new(wanted.visibility_m, wanted.haze_base_m)));
    let mut light = air.light(wanted.sun_elevation_rad, wanted.moon, wanted.altitude_m);
    if wanted.haze == HazeGrade::Table {
        light.aerial = air.aerial(&light, wanted.sun_elevation_rad, wanted.altitude_m, wanted.view_range_m);
    }
    (wanted, air, light)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_remade_only_when_something_moved() {
        let mut feed = SkyFeed::new(false, HazeGrade::Table);
        let mut scene = Scene::default();
        assert!(feed.update(&scene, 1_000.0));
        assert!(!feed.update(&scene, 1_000.0 + 0.9 * ALTITUDE_STEP_M));
        assert!(feed.update(&scene, 1_000.0 + 1.1 * ALTITUDE_STEP_M));
        scene.sun_direction = terrain::frame::direction(1.0, scene.sun_elevation_rad());
        assert!(!feed.update(&scene, 1_200.0), "an azimuth alone changes no table");
        scene.visibility_m = 20_000.0;
        assert!(feed.update(&scene, 1_200.0));
        assert!(!feed.update(&scene, f64::NAN) || feed.light().is_some());
    }
}
