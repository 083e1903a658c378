//! What an aircraft did on a flight, ten times a second, and the plots of it: the whole flight, and the last landing.
//!
//! SI inside; plots have metres, m/s and degrees. A landing is the last time that a wheel or skid met the ground after the aircraft
//! had been higher than [`AIRBORNE_M`] over it; what is across is the way along the ground to that point.

use crate::plot::chart::{self, Chart, Curve};
use crate::plot::drawing::Drawing;
use glam::DVec2;
use sim::{Condition, Snapshot};

/// Time between rows, seconds.
const EVERY_S: f64 = 0.1;
/// Height over the ground that counts as flying, metres.
const AIRBORNE_M: f64 = 15.0;
/// How much of the way before and after a touchdown is plotted, metres.
const BEFORE_M: f64 = 1_500.0;
const AFTER_M: f64 = 600.0;
/// An approach of three degrees, to compare with.
const GLIDE_SLOPE: f64 = 0.0524;

/// A moment of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    t_s: f64,
    way_m: f64,
    altitude_m: f64,
    above_m: Option<f64>,
    on_ground: bool,
    airspeed_mps: f64,
    climb_mps: f64,
    pitch_rad: f64,
    roll_rad: f64,
    alpha_rad: f64,
    load: f64,
    throttle: f64,
}

/// See the module.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    rows: Vec<Row>,
    last: Option<(DVec2, u32)>,
    way_m: f64,
}

impl Trace {
    /// Takes in a snapshot; of those closer in time than [`EVERY_S`] only the first counts.
    pub fn add(&mut self, snapshot: &Snapshot) {
        let own = &snapshot.aircraft;
        let at = DVec2::new(own.position_m.x, own.position_m.z);
        // A jump is no way.
        if let Some((before, _)) = self.last.filter(|(_, jumps)| *jumps == snapshot.jumps) {
            self.way_m += at.distance(before);
        }
        self.last = Some((at, snapshot.jumps));
        if self.rows.last().is_some_and(|row| snapshot.time_s < row.t_s + EVERY_S - 1e-9) {
            return;
        }
        let angles = own.angles();
        self.rows.push(Row {
            t_s: snapshot.time_s,
            way_m: self.way_m,
            altitude_m: own.position_m.y,
            above_m: snapshot.height_above_ground_m,
            on_ground: own.condition == Condition::OnGround,
            airspeed_mps: snapshot.air_data.airspeed_mps,
            climb_mps: own.climb_mps(),
            pitch_rad: angles.pitch_rad,
            roll_rad: angles.roll_rad,
            alpha_rad: own.alpha_rad,
            load: own.load_factor,
            throttle: snapshot.instruments.map_or(own.throttle, |of| of.throttle),
        });
    }

    /// The whole flight over time; none of a flight shorter than a second.
    pub fn flight(&self, name: &str) -> Option<Drawing> {
        if self.rows.len() < 10 {
            return None;
        }
        let rows = &self.rows[..];
        Some(chart::sheet(name, &charts(rows, "time, s", &|row| row.t_s), 2))
    }

    /// The last landing over the way along the ground; none of a flight without.
    pub fn landing(&self, name: &str) -> Option<Drawing> {
        let (touch, standing_m) = self.touchdown()?;
        let from_m = self.rows[touch].way_m;
        let near = |row: &&Row| (-BEFORE_M..=AFTER_M).contains(&(row.way_m - from_m));
        let rows: Vec<Row> = self.rows.iter().filter(near).copied().collect();
        let mut charts = charts(&rows, "way from the touchdown, m", &|row| row.way_m - from_m);
        let height = rows.iter().filter_map(|row| Some([row.way_m - from_m, row.above_m? - standing_m]));
        let slope = [[-BEFORE_M, BEFORE_M * GLIDE_SLOPE], [0.0, 0.0]];
        charts[0] = Chart {
            name: "height of the wheels over the ground".into(),
            up: "m".into(),
            across: "way from the touchdown, m".into(),
            curves: vec![Curve::new("flown", height), Curve::new("3 degrees", slope).dashed()],
        };
        let down_mps = -self.rows[touch.saturating_sub(1)].climb_mps;
        let speed_mps = self.rows[touch].airspeed_mps;
        let name = format!("{name}: touchdown at {speed_mps:.1} m/s, sinking {down_mps:.2} m/s");
        Some(chart::sheet(&name, &charts, 2))
    }

    /// The row of the last touchdown, and the least height that the aircraft has on the ground, metres.
    fn touchdown(&self) -> Option<(usize, f64)> {
        let high = self.rows.iter().rposition(|row| row.above_m.is_some_and(|above_m| above_m > AIRBORNE_M))?;
        let touch = high + self.rows[high..].iter().position(|row| row.on_ground)?;
        let standing = self.rows.iter().filter(|row| row.on_ground).filter_map(|row| row.above_m);
        let standing_m = standing.fold(f64::INFINITY, f64::min);
        Some((touch, standing_m))
    }
}

/// The six charts of rows over something.
fn charts(rows: &[Row], across: &str, x: &dyn Fn(&Row) -> f64) -> Vec<Chart> {
    type Value<'a> = &'a dyn Fn(&Row) -> f64;
    let chart = |name: &str, up: &str, curves: &[(&str, Value<'_>)]| Chart {
        name: name.into(),
        up: up.into(),
        across: across.into(),
        curves: curves.iter().map(|(name, y)| Curve::new(*name, rows.iter().map(|row| [x(row), y(row)]))).collect(),
    };
    let ground = |row: &Row| row.above_m.map_or(f64::NAN, |above_m| row.altitude_m - above_m);
    vec![
        chart("altitude", "m above sea level", &[("own", &|row| row.altitude_m), ("ground", &ground)]),
        chart("indicated airspeed", "m/s", &[("", &|row| row.airspeed_mps)]),
        chart("vertical speed", "m/s", &[("", &|row| row.climb_mps)]),
        chart(
            "attitude",
            "degrees",
            &[
                ("pitch", &|row| row.pitch_rad.to_degrees()),
                ("roll", &|row| row.roll_rad.to_degrees()),
                ("angle of attack", &|row| row.alpha_rad.to_degrees()),
            ],
        ),
        chart("load factor", "g", &[("", &|row| row.load)]),
        chart("throttle", "of its way", &[("", &|row| row.throttle)]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(t_s: f64, above_m: f64) -> Row {
        Row {
            t_s,
            way_m: 40.0 * t_s,
            altitude_m: 1_600.0 + above_m,
            above_m: Some(above_m),
            on_ground: above_m < 1.5,
            airspeed_mps: 35.0,
            climb_mps: -1.0,
            pitch_rad: 0.02,
            roll_rad: 0.0,
            alpha_rad: 0.1,
            load: 1.0,
            throttle: 0.3,
        }
    }

    #[test]
    fn a_landing_is_the_last_coming_down_and_a_flight_that_stays_up_has_none() {
        let heights = [1.2, 1.1, 30.0, 60.0, 20.0, 8.0, 1.3, 1.1, 1.1];
        let rows: Vec<Row> = heights.iter().enumerate().map(|(at, height)| row(at as f64, *height)).collect();
        let trace = Trace { rows: rows.clone(), ..Trace::default() };
        let (touch, standing_m) = trace.touchdown().expect("a landing");
        assert_eq!((touch, standing_m), (6, 1.1));
        assert!(trace.landing("x").unwrap().svg().contains("touchdown at 35.0 m/s, sinking 1.00 m/s"));
        let up = Trace { rows: rows[..5].to_vec(), ..Trace::default() };
        assert_eq!(up.touchdown(), None);
        let low = [500.0, 400.0, 300.0, 20.0, 2.0].iter().enumerate().map(|(at, height)| row(at as f64, *height));
        assert_eq!(Trace { rows: low.collect(), ..Trace::default() }.touchdown(), None, "low is not down");
        assert!(up.flight("x").is_none(), "too short");
        assert!(Trace::default().landing("x").is_none());
    }
}
