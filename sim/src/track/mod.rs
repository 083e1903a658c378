//! A track through the world at constant speed: what flies where no pilot does.
//!
//! A track is positions at equal distances along its way, joined by cubic pieces with common tangents, so that position
//! and direction have no jumps; bank is that of a coordinated turn. State is a function of the distance alone, hence of
//! time: a late frame or another step rate flies the same track. Beyond its end a track goes straight on, level.

mod flight;
mod way;

pub use flight::{Flight, ISSYK_KUL_FLIGHT, Waypoint};

use crate::HeightAt;
use crate::aircraft::{AircraftState, Condition};
use crate::atmosphere::GRAVITY_MPS2;
use crate::frame;
use glam::DVec3;
use std::fmt;
use way::{evenly, highest, smoothed, spline};

/// Longest track, metres: once around the Earth.
pub const LONGEST_M: f64 = 40_000_000.0;
/// Most samples a track keeps.
const MOST_SAMPLES: f64 = 400_000.0;
/// Steepest bank of a track, radians.
const MAX_BANK_RAD: f64 = 0.8;

/// How high a straight track runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TrackHeight {
    /// At one altitude above mean sea level, metres.
    Msl(f64),
    /// This far above the highest ground within `ahead_m` before and behind, metres: never lower, without kinks.
    AboveHighest {
        /// Over the highest ground, metres.
        clearance_m: f64,
        /// How far before and behind to look, metres.
        ahead_m: f64,
    },
}

/// Why there is no track.
#[derive(Debug, Clone, PartialEq)]
pub enum TrackError {
    /// The text is not a flight.
    Syntax(String),
    /// A number is out of range: what it is, the range, the value.
    Range(&'static str, &'static str, f64),
    /// Fewer than two places, or all at one.
    TooShort(usize),
}

impl fmt::Display for TrackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(why) => {
                write!(f, "expected a flight as TOML with name, speed_mps and [[waypoint]] places: {why}")
            }
            Self::Range(what, range, found) => write!(f, "{what} must be within {range}, found {found}"),
            Self::TooShort(found) => write!(f, "a track needs at least 2 places apart from each other, found {found}"),
        }
    }
}

impl std::error::Error for TrackError {}

/// A place on a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackPoint {
    /// Position, metres.
    pub position_m: DVec3,
    /// Unit direction of flight.
    pub direction: DVec3,
    /// Turn of the heading a metre of way, to the right positive, rad/m.
    pub turn_radpm: f64,
}

/// A track: see the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    samples_m: Vec<DVec3>,
    spacing_m: f64,
    speed_mps: f64,
    pictures: Vec<(f64, String)>,
}

impl Track {
    /// A smooth track through a flight's places; `plan` gives world x and z of latitude and longitude in degrees.
    ///
    /// # Errors
    /// [`TrackError`] if there are fewer than two different places or the way is too long.
    pub fn through(flight: &Flight, plan: &dyn Fn(f64, f64) -> (f64, f64)) -> Result<Self, TrackError> {
        let places: Vec<DVec3> = flight
            .waypoint
            .iter()
            .map(|place| {
                let (x_m, z_m) = plan(place.lat_deg, place.lon_deg);
                DVec3::new(x_m, place.alt_m, z_m)
            })
            .collect();
        let (dense, starts) = spline(&places)?;
        let (samples_m, spacing_m, lengths) = evenly(&dense)?;
        let pictures = flight.waypoint.iter().zip(&starts);
        let pictures = pictures.filter_map(|(place, &at)| Some((lengths[at], place.picture.clone()?))).collect();
        Ok(Self { samples_m, spacing_m, speed_mps: flight.speed_mps, pictures })
    }

    /// A straight level track from a plan point (x, z) at a grid heading.
    ///
    /// # Errors
    /// [`TrackError`] names the number out of range.
    pub fn straight(
        start_m: (f64, f64),
        grid_heading_rad: f64,
        distance_m: f64,
        speed_mps: f64,
        height: TrackHeight,
        height_at: &HeightAt,
    ) -> Result<Self, TrackError> {
        check("a track's distance_m", "1..=4e7", distance_m, 1.0, LONGEST_M)?;
        check("a track's speed_mps", "0..=12000", speed_mps, 0.0, 12_000.0)?;
        for coordinate in [start_m.0, start_m.1, grid_heading_rad] {
            check("a track's start and heading", "-1e7..=1e7", coordinate, -1e7, 1e7)?;
        }
        let pieces = (distance_m / 100.0).ceil().clamp(1.0, MOST_SAMPLES);
        let spacing_m = distance_m / pieces;
        let along = terrain::frame::direction(grid_heading_rad, 0.0);
        let start = DVec3::new(start_m.0, 0.0, start_m.1);
        let mut samples_m: Vec<DVec3> = (0..=pieces as usize).map(|i| start + along * (i as f64 * spacing_m)).collect();
        match height {
            TrackHeight::Msl(altitude_m) => {
                check("a track's altitude", "-12000..=120000", altitude_m, -12_000.0, 120_000.0)?;
                samples_m.iter_mut().for_each(|s| s.y = altitude_m);
            }
            TrackHeight::AboveHighest { clearance_m, ahead_m } => {
                check("a track's clearance", "-1000..=100000", clearance_m, -1_000.0, 100_000.0)?;
                check("a track's ahead_m", "0..=1e6", ahead_m, 0.0, 1e6)?;
                let ground: Vec<f64> = samples_m
                    .iter()
                    .map(|s| height_at(s.x, s.z).filter(|h| h.is_finite()).unwrap_or(f64::MIN))
                    .collect();
                let reach = ((ahead_m / spacing_m).round() as usize).clamp(1, ground.len());
                let heights = smoothed(&highest(&ground, 2 * reach), reach);
                for (sample, ground_m) in samples_m.iter_mut().zip(heights) {
                    sample.y = ground_m + clearance_m;
                }
            }
        }
        Ok(Self { samples_m, spacing_m, speed_mps, pictures: Vec::new() })
    }

    /// A straight track of a distance whose middle is at a plan point (x, z): a diagonal of a world, say.
    ///
    /// # Errors
    /// As [`Track::straight`].
    pub fn centred(
        middle_m: (f64, f64),
        grid_heading_rad: f64,
        distance_m: f64,
        speed_mps: f64,
        height: TrackHeight,
        height_at: &HeightAt,
    ) -> Result<Self, TrackError> {
        let back = terrain::frame::direction(grid_heading_rad, 0.0) * (-0.5 * distance_m);
        let start_m = (middle_m.0 + back.x, middle_m.1 + back.z);
        Self::straight(start_m, grid_heading_rad, distance_m, speed_mps, height, height_at)
    }

    /// Its length, metres.
    pub fn length_m(&self) -> f64 {
        (self.samples_m.len() - 1) as f64 * self.spacing_m
    }

    /// Its speed, m/s.
    pub fn speed_mps(&self) -> f64 {
        self.speed_mps
    }

    /// The same way at another speed, held within 0..=12,000 m/s; NaN is ignored.
    #[must_use]
    pub fn at_speed(mut self, speed_mps: f64) -> Self {
        if !speed_mps.is_nan() {
            self.speed_mps = speed_mps.clamp(0.0, 12_000.0);
        }
        self
    }

    /// Distances along the way, metres, and names of the pictures that the flight asks for.
    pub fn pictures(&self) -> &[(f64, String)] {
        &self.pictures
    }

    /// Place and direction after a distance; before the start and beyond the end straight on.
    pub fn at(&self, distance_m: f64) -> TrackPoint {
        let distance_m = if distance_m.is_finite() { distance_m } else { 0.0 };
        let last = self.samples_m.len() - 1;
        let place = distance_m / self.spacing_m;
        if place < 0.0 || place >= last as f64 {
            let (end, over_m) = if place < 0.0 { (0, distance_m) } else { (last, distance_m - self.length_m()) };
            let tangent = self.tangent(end);
            let level = DVec3::new(tangent.x, 0.0, tangent.z).normalize_or(tangent.normalize_or(DVec3::NEG_Z));
            return TrackPoint { position_m: self.samples_m[end] + level * over_m, direction: level, turn_radpm: 0.0 };
        }
        let i = place as usize;
        let t = place - i as f64;
        let (a, b) = (self.samples_m[i], self.samples_m[i + 1]);
        let (ta, tb) = (self.tangent(i), self.tangent(i + 1));
        // Cubic Hermite piece and its derivative in t.
        let (t2, t3) = (t * t, t * t * t);
        let position_m =
            a * (2.0 * t3 - 3.0 * t2 + 1.0) + ta * (t3 - 2.0 * t2 + t) + b * (3.0 * t2 - 2.0 * t3) + tb * (t3 - t2);
        let rate = (b - a) * (6.0 * t - 6.0 * t2) + ta * (3.0 * t2 - 4.0 * t + 1.0) + tb * (3.0 * t2 - 2.0 * t);
        let direction = rate.normalize_or((b - a).normalize_or(DVec3::NEG_Z));
        let turn_radpm = self.turn_radpm(i) * (1.0 - t) + self.turn_radpm(i + 1) * t;
        TrackPoint { position_m, direction, turn_radpm }
    }

    /// The aircraft's state after a distance along the way.
    pub fn state(&self, distance_m: f64, throttle: f64) -> AircraftState {
        let point = self.at(distance_m);
        let (heading_rad, pitch_rad) = terrain::frame::heading_elevation(point.direction);
        let lateral = point.turn_radpm * self.speed_mps * self.speed_mps / GRAVITY_MPS2;
        let roll_rad = lateral.atan().clamp(-MAX_BANK_RAD, MAX_BANK_RAD);
        let attitude = frame::attitude(frame::Angles { heading_rad, pitch_rad, roll_rad });
        let turn_radps = DVec3::new(0.0, 0.0, point.turn_radpm * self.speed_mps);
        AircraftState {
            position_m: point.position_m,
            velocity_mps: point.direction * self.speed_mps,
            attitude,
            // The turn is about the vertical, down in north-east-down axes.
            rates_radps: attitude.inverse() * frame::world_from_ned(turn_radps),
            load_factor: lateral.hypot(1.0).min(20.0),
            alpha_rad: 0.0,
            airspeed_mps: self.speed_mps,
            throttle,
            condition: Condition::Flying,
        }
    }

    /// Change of position a sample.
    fn tangent(&self, i: usize) -> DVec3 {
        let last = self.samples_m.len() - 1;
        let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
        (self.samples_m[after] - self.samples_m[before]) / (after - before) as f64
    }

    /// Turn about a sample, averaged over some 600 m so that a corner of the way does not rock the wings.
    fn turn_radpm(&self, i: usize) -> f64 {
        let reach = (300.0 / self.spacing_m).ceil() as usize;
        let (before, after) = (i.saturating_sub(reach), (i + reach).min(self.samples_m.len() - 1));
        let heading = |d: DVec3| d.x.atan2(-d.z);
        let turn = heading(self.tangent(after)) - heading(self.tangent(before));
        let turn = (turn + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        // The track goes straight on beyond its ends: the wings level over the last kilometre.
        let to_end_m = i.min(self.samples_m.len() - 1 - i) as f64 * self.spacing_m;
        turn / ((after - before) as f64 * self.spacing_m) * (to_end_m / 1_000.0).min(1.0)
    }
}

fn check(what: &'static str, range: &'static str, found: f64, low: f64, high: f64) -> Result<(), TrackError> {
    if (low..=high).contains(&found) { Ok(()) } else { Err(TrackError::Range(what, range, found)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn flat(_: f64, _: f64) -> Option<f64> {
        Some(100.0)
    }

    /// Plan metres of the default world to a percent: enough for a flight's shape.
    fn plan(lat_deg: f64, lon_deg: f64) -> (f64, f64) {
        ((lon_deg - 78.35) * 82_200.0, -(lat_deg - 42.425) * 111_100.0)
    }

    #[test]
    fn a_straight_track_is_straight_and_goes_on_beyond_its_end() {
        for speed_mps in [0.0, 300.0, 10_000.0] {
            let track = Track::centred((0.0, 0.0), 0.8, 60_000.0, speed_mps, TrackHeight::Msl(5_000.0), &flat).unwrap();
            assert!((track.length_m() - 60_000.0).abs() < 1e-6);
            for distance_m in [-500.0, 0.0, 12_345.6, 60_000.0, 75_000.0] {
                let state = track.state(distance_m, 0.5);
                let expected = terrain::frame::direction(0.8, 0.0) * (distance_m - 30_000.0) + DVec3::Y * 5_000.0;
                assert!((state.position_m - expected).length() < 1e-6, "{distance_m}");
                assert!((state.velocity_mps.length() - speed_mps).abs() < 1e-9 && state.is_finite());
                assert!(state.angles().roll_rad.abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_track_above_the_highest_ground_keeps_its_clearance() {
        let hills =
            |x: f64, z: f64| (x.abs() < 20_000.0).then(|| 2_000.0 * ((x / 3_000.0).sin() * (z / 4_000.0).cos()).abs());
        let height = TrackHeight::AboveHighest { clearance_m: 300.0, ahead_m: 4_000.0 };
        let track = Track::centred((0.0, 0.0), 0.7, 50_000.0, 300.0, height, &hills).unwrap();
        for i in 0..=500 {
            let at = track.at(f64::from(i) * 100.0);
            if let Some(ground_m) = hills(at.position_m.x, at.position_m.z) {
                // Samples of the ground are 100 m apart; the hills rise at most 0.8 m/m between them.
                assert!(at.position_m.y - ground_m > 300.0 - 80.0, "{at:?}");
            }
            assert!(at.direction.y.abs() < 0.5, "steep at {i}");
        }
        let void = Track::straight((0.0, 0.0), 0.0, 1_000.0, 10.0, height, &|_, _| None).unwrap();
        assert_eq!(void.at(500.0).position_m.y, 300.0);
    }

    #[test]
    fn the_scenic_flight_is_smooth_and_has_its_eight_pictures() {
        let flight = Flight::parse(ISSYK_KUL_FLIGHT).unwrap();
        let track = Track::through(&flight, &plan).unwrap();
        assert_eq!(track.pictures().len(), 8);
        assert!(track.pictures().is_sorted_by(|a, b| a.0 < b.0));
        for ((distance_m, name), place) in
            track.pictures().iter().zip(flight.waypoint.iter().filter(|w| w.picture.is_some()))
        {
            let (x_m, z_m) = plan(place.lat_deg, place.lon_deg);
            let off_m = (track.at(*distance_m).position_m - DVec3::new(x_m, place.alt_m, z_m)).length();
            assert!(off_m < 60.0, "{name} {off_m} m off its place");
        }
        let step_s = 1.0 / 120.0;
        let mut before = track.state(0.0, 0.5);
        let mut distance_m = 0.0;
        while distance_m < track.length_m() {
            distance_m += track.speed_mps() * step_s;
            let now = track.state(distance_m, 0.5);
            let moved_m = (now.position_m - before.position_m).length();
            assert!((moved_m / (track.speed_mps() * step_s) - 1.0).abs() < 0.02, "{moved_m} m at {distance_m} m");
            let turned = before.attitude.angle_between(now.attitude);
            assert!(turned < 0.5 * step_s, "{} rad/s at {distance_m} m", turned / step_s);
            assert!(now.angles().pitch_rad.abs() < 0.35);
            before = now;
        }
    }

    #[test]
    fn hostile_flights_are_refused_with_a_reason() {
        for text in [
            "",
            "name = 3",
            "name='a'\nspeed_mps=nan\nwaypoint=[]",
            "name='a'\nspeed_mps=1e9\nwaypoint=[]",
            "name='a'\nspeed_mps=1\nwaypoint=[{lat_deg=91,lon_deg=0,alt_m=0}]",
            "name='a'\nspeed_mps=1\nextra=1\nwaypoint=[]",
        ] {
            assert!(Flight::parse(text).is_err(), "{text}");
        }
        let one =
            Flight::parse("name='a'\nspeed_mps=1.0\nwaypoint=[{lat_deg=42.0,lon_deg=78.0,alt_m=1000.0}]").unwrap();
        assert_eq!(Track::through(&one, &plan), Err(TrackError::TooShort(1)));
        assert!(Track::straight((f64::NAN, 0.0), 0.0, 1e3, 1.0, TrackHeight::Msl(0.0), &flat).is_err());
        assert!(Track::straight((0.0, 0.0), 0.0, f64::INFINITY, 1.0, TrackHeight::Msl(0.0), &flat).is_err());
        assert!(Track::straight((0.0, 0.0), 0.0, 1e3, 1e5, TrackHeight::Msl(0.0), &flat).is_err());
    }

    proptest! {
        #[test]
        fn any_flight_gives_finite_states(places in prop::collection::vec((41.0..44.0, 76.0..81.0, 0.0..9_000.0), 2..12), distance: f64) {
            let waypoint = places.iter().map(|&(lat_deg, lon_deg, alt_m)| Waypoint { lat_deg, lon_deg, alt_m, picture: None });
            let flight = Flight { name: String::new(), speed_mps: 200.0, waypoint: waypoint.collect() };
            if let Ok(track) = Track::through(&flight, &plan) {
                for at in [distance, 0.0, 0.37 * track.length_m(), track.length_m()] {
                    prop_assert!(track.state(at, 0.5).is_finite());
                }
            }
        }
    }
}
