//! A flight from start to end: steps on a grid of time, input edges, rows, stops.
//!
//! Steps end at multiples of `dt_s`; an input edge inside a step cuts it in two, so controls are constant within a step.
//! A step too long for the body's fastest mode is taken in pieces (see [`super::stiffness`]). A row between two steps is
//! a shorter step from the last state, by fourth order, that the flight itself does not take. Times within a billionth of
//! a second count as the same.
//!
//! Invariant: the same model, case, inputs and ground give the same rows; the rows' spacing changes nothing.

use super::column::{self, COLUMNS, Datum};
use super::inputs::Inputs;
use super::model::Model;
use super::motion::{self, N, RigidMotion, State};
use super::quantity::{Quantity, without_unit};
use super::start;
use super::stiffness::{self, MOST_PIECES, Mode, STEPS_A_MODE, Stiffness};
use super::stop::Stop;
use super::trim::{self, Trimmed};
use crate::case::{Case, Setting};
use crate::file::FileError;
use crate::integrate::{self, Before, Integrator, Motion};
use crate::planet::Place;
use crate::turbulence::Dryden;
use crate::world_ground::WorldGround;
use std::sync::Arc;

/// Times nearer to each other than this are one, seconds.
const SAME_S: f64 = 1e-9;
/// Steps between two looks at how stiff the flow makes the body.
const STEPS_A_LOOK: u32 = 16;

/// How a flight ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// At the time asked for.
    Time,
    /// At a stop, by its words.
    Stop(String),
    /// Where a number was no longer one, or a table refused; the rows hold what was good.
    Failed(String),
}

/// A flight.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// The body in its surroundings.
    pub motion: RigidMotion,
    /// What trim found, if it was asked for.
    pub trimmed: Option<Trimmed>,
    /// The fastest mode.
    pub stiffness: Stiffness,
    /// Most pieces that a step was cut into.
    pub most_pieces: u32,
    /// Steps taken, pieces counted.
    pub steps: u64,
    integrator: Integrator,
    dt_s: f64,
    datum: Datum,
    ground: Option<WorldGround>,
    gust: Option<Dryden>,
    inputs: Inputs,
    next_edge: usize,
    t_s: f64,
    y: State,
    before: Before<f64, N>,
    mode: Mode,
    pieces: u32,
    looks: u32,
    look_in: u32,
}

impl Simulation {
    /// A flight at its start, trimmed if the case asks for it.
    ///
    /// # Errors
    /// [`FileError`] names the key of the case: a step is missing, trim finds nothing, the body is too stiff.
    pub fn new(model: Model, case: &Case, inputs: Inputs, ground: Option<WorldGround>) -> Result<Self, FileError> {
        let fail = |why: String| FileError::new(&case.file, why);
        let Some(dt_s) = case.run.dt_s else {
            return Err(fail("run.dt_s: expected a step in seconds, found none".to_owned()));
        };
        let model = Arc::new(model);
        let mut motion = RigidMotion::new(model, case.planet, case.atmosphere.clone(), case.wind.clone());
        let mut initial = case.initial;
        let mut trimmed = None;
        if let Some(wanted) = &case.trim {
            let found = trim::trim(&mut motion, &initial, wanted).map_err(fail)?;
            initial = found.initial;
            trimmed = Some(found);
        }
        let y = start::state(&motion.planet, &initial);
        let datum = Datum::under(&motion, motion::position(&y));
        let gust = case.turbulence.map(|t| Dryden::new(t.sigma_mps, &[t.seed]));
        let mut simulation = Self {
            stiffness: Stiffness { speed_mps: 0.0, lambda_radps: 0.0, per_flow: 0.0 },
            most_pieces: 1,
            steps: 0,
            motion,
            trimmed,
            integrator: case.run.integrator,
            dt_s,
            datum,
            ground,
            gust,
            inputs,
            next_edge: 0,
            t_s: 0.0,
            y,
            before: None,
            mode: Mode::default(),
            pieces: 1,
            looks: 0,
            look_in: 0,
        };
        if let Some(wanted) = &case.trim {
            simulation.set_found(wanted).map_err(fail)?;
        }
        simulation.motion.settle_shaft(&simulation.y);
        simulation.stiffness = Stiffness::of(&simulation.motion, &simulation.y);
        if !simulation.y.iter().all(|x| x.is_finite()) {
            return Err(fail("initial: expected a state of finite numbers".to_owned()));
        }
        simulation.look().map_err(fail)?;
        if let Some(gust) = &simulation.gust {
            simulation.motion.gust_mps = gust.gust_mps();
        }
        simulation.apply_edges();
        Ok(simulation)
    }

    /// Copies columns of the trimmed state into controls and variables of DAVE-ML files.
    fn set_found(&mut self, wanted: &crate::case::Trim) -> Result<(), String> {
        let row = self.row();
        let mut found = Vec::new();
        for (name, setting) in &wanted.set {
            let control = self.motion.model.control(name);
            let si = match setting {
                Setting::Column(column) => {
                    let place = column::place_of(&self.motion, column)
                        .ok_or_else(|| format!("trim.set.{name}: expected a column, found {column}"))?;
                    trim::si_of_column(column, row[place])
                }
                // A number for a control was set before the search.
                Setting::Number(_) if control.is_some() => continue,
                Setting::Number(value) => *value,
            };
            match control {
                Some(place) => {
                    let unit = without_unit(name).map_or(1.0, |(_, si)| si);
                    let of = &self.motion.model.controls[place];
                    self.motion.controls[place] = (si / unit).clamp(of.min, of.max);
                }
                None if self.motion.model.has_variable(name) => found.push((name.clone(), si)),
                None => return Err(format!("trim.set: expected a control or a DAVE-ML variable, found {name}")),
            }
        }
        if !found.is_empty() {
            let model = self.motion.model.with_found(&found).map_err(|error| error.to_string())?;
            self.motion.set_model(Arc::new(model));
        }
        Ok(())
    }

    /// Time, seconds.
    pub fn t_s(&self) -> f64 {
        self.t_s
    }

    /// The state.
    pub fn state(&self) -> &State {
        &self.y
    }

    /// All columns of now.
    pub fn row(&self) -> Vec<f64> {
        self.row_of(self.t_s, &self.y)
    }

    fn row_of(&self, t_s: f64, y: &State) -> Vec<f64> {
        let place = self.place(y);
        column::row(&self.motion, &self.datum, t_s, y, place, self.ground_m(y))
    }

    /// The place of a state; over a world's plane by the world's projection.
    fn place(&self, y: &State) -> Place {
        let position = motion::position(y);
        self.ground.as_ref().map_or_else(|| self.motion.planet.place(position), |ground| ground.place(position))
    }

    /// Ground under a state, metres; 0 where no world is named, `None` over void.
    fn ground_m(&self, y: &State) -> Option<f64> {
        self.ground.as_ref().map_or(Some(0.0), |ground| ground.height_m(motion::position(y)))
    }

    /// Applies the inputs up to now.
    fn apply_edges(&mut self) {
        while let Some(edge) = self.inputs.edges().get(self.next_edge).filter(|edge| edge.t_s <= self.t_s + SAME_S) {
            for &(place, value) in &edge.changes {
                // A jump of a control breaks the history that some integrators keep.
                if self.motion.controls[place] != value {
                    self.before = None;
                    // It may change the fastest mode too.
                    (self.looks, self.look_in) = (0, 0);
                }
                self.motion.controls[place] = value;
            }
            self.next_edge += 1;
        }
    }

    /// How many pieces the state of now asks for.
    fn look(&mut self) -> Result<(), String> {
        let sample = self.motion.sample(&self.y, false);
        let (density, airspeed) = (sample.air.density_kgpm3, sample.slots[Quantity::TasMps.slot()]);
        let flow = density * airspeed;
        if self.looks.is_multiple_of(STEPS_A_MODE / STEPS_A_LOOK) {
            self.mode = Mode::of(&self.motion, &self.y, flow, airspeed);
        }
        self.looks = self.looks.wrapping_add(1);
        let lambda = self.mode.lambda_radps(&self.stiffness, flow);
        let spin = motion::rates(&self.y).length();
        self.pieces = stiffness::pieces(self.integrator, lambda, spin, self.dt_s).ok_or_else(|| {
            format!(
                "run.dt_s: expected a step that holds the body's fastest mode, {lambda:.3e} 1/s at {airspeed:.1} m/s, and its spin, {spin:.3e} rad/s, in at most {MOST_PIECES} pieces; found {} s",
                self.dt_s
            )
        })?;
        self.most_pieces = self.most_pieces.max(self.pieces);
        self.look_in = STEPS_A_LOOK;
        match self.motion.model.refused(&sample.slots) {
            Some(refused) => Err(refused),
            None => Ok(()),
        }
    }

    /// The state a part of a step later, by fourth order, without taking it.
    fn glimpse_from(&self, from_s: f64, from: &State, ahead_s: f64) -> State {
        let piece_s = ahead_s / f64::from(self.pieces);
        let mut y = *from;
        for piece in 0..self.pieces {
            let t_s = from_s + f64::from(piece) * piece_s;
            y = motion::normalised(integrate::rk4(t_s, &y, piece_s, |t, y| self.motion.rate(t, y)));
        }
        y
    }

    /// Takes one step up to `until_s`; controls must not change within.
    fn advance(&mut self, until_s: f64) {
        let piece_s = (until_s - self.t_s) / f64::from(self.pieces);
        for piece in 0..self.pieces {
            let t_s = self.t_s + f64::from(piece) * piece_s;
            let y = integrate::step(self.integrator, &self.motion, t_s, &self.y, piece_s, &mut self.before);
            self.y = motion::normalised(y);
            self.motion.turn_shaft(&self.y, piece_s);
            self.steps += 1;
        }
        self.t_s = until_s;
    }

    /// What a step ends with: the gust of the next one, and inputs up to now.
    fn settle(&mut self) {
        // Gusts change on the grid only, so that an input edge between draws no other air.
        let steps = self.t_s / self.dt_s;
        let on_grid = (steps - steps.round()).abs() * self.dt_s <= SAME_S;
        if let Some(gust) = self.gust.as_mut().filter(|_| on_grid) {
            gust.step(self.dt_s, self.motion.sample(&self.y, false).slots[Quantity::TasMps.slot()]);
            self.motion.gust_mps = gust.gust_mps();
        }
        self.apply_edges();
    }

    /// The end of the step that begins now: on the grid, or at an input edge before it.
    fn step_end(&self, end_s: f64) -> f64 {
        let grid = ((self.t_s / self.dt_s + 1e-6).floor() + 1.0) * self.dt_s;
        let edge = self.inputs.edges().get(self.next_edge).map_or(f64::INFINITY, |edge| edge.t_s);
        // Times that are one are the grid's, so that steps stay on it.
        let next = if edge < grid - SAME_S { edge } else { grid };
        if next > end_s - SAME_S { end_s } else { next }
    }

    /// One step of the grid, or up to an input edge inside it, without looking for stops: for callers that time it.
    pub fn step(&mut self) {
        let until_s = self.step_end(f64::INFINITY);
        if self.look_in == 0 && self.look().is_err() {
            self.pieces = MOST_PIECES;
        }
        self.look_in = self.look_in.saturating_sub(1);
        self.advance(until_s);
        self.settle();
    }

    /// Flies for `seconds`, and gives a row each `row_s` and at the start and end, with what happened there.
    pub fn run(&mut self, seconds: f64, row_s: f64, stops: &[Stop], mut emit: impl FnMut(&[f64], &str)) -> Ending {
        let end_s = self.t_s + seconds;
        let first_s = self.t_s;
        let mut rows = 1.0;
        let over = stops.iter().find(|stop| stop.limit.relation.at_start(self.beyond(stop, self.t_s, &self.y)));
        if let Some(stop) = over {
            emit(&self.row(), &format!("stop: {}", stop.limit.text));
            return Ending::Stop(stop.limit.text.clone());
        }
        emit(&self.row(), "start");
        if seconds <= SAME_S {
            return Ending::Time;
        }
        while self.t_s < end_s - SAME_S {
            if (self.look_in == 0 || self.motion.model.refuses())
                && let Err(why) = self.look()
            {
                emit(&self.row(), "failed");
                return Ending::Failed(format!("at {} s: {why}", self.t_s));
            }
            self.look_in -= 1;
            let until_s = self.step_end(end_s);
            let good = self.clone_at();
            self.advance(until_s);
            let finite = motion::is_flight(&self.y);
            let stop = if finite { self.first_stop(&good, stops) } else { None };
            let over_s = stop.map_or(until_s, |(ahead_s, _)| good.0 + ahead_s);
            while first_s + rows * row_s < over_s - SAME_S {
                let t_s = first_s + rows * row_s;
                rows += 1.0;
                let y = self.glimpse_from(good.0, &good.1, t_s - good.0);
                if motion::is_flight(&y) {
                    emit(&self.row_of(t_s, &y), "");
                }
            }
            if !finite {
                self.restore(good);
                emit(&self.row(), "failed");
                return Ending::Failed(format!("after {} s the state runs away", self.t_s));
            }
            if let Some((ahead_s, stop)) = stop {
                (self.y, self.t_s) = (self.glimpse_from(good.0, &good.1, ahead_s), over_s);
                emit(&self.row(), &format!("stop: {}", stop.limit.text));
                return Ending::Stop(stop.limit.text.clone());
            }
            self.settle();
            if self.t_s < end_s - SAME_S && (first_s + rows * row_s - self.t_s).abs() <= SAME_S {
                rows += 1.0;
                emit(&self.row(), "");
            }
        }
        emit(&self.row(), "end");
        Ending::Time
    }

    fn clone_at(&self) -> (f64, State, Before<f64, N>) {
        (self.t_s, self.y, self.before)
    }

    fn restore(&mut self, (t_s, y, before): (f64, State, Before<f64, N>)) {
        (self.t_s, self.y, self.before) = (t_s, y, before);
    }

    /// How far the column of a stop is above the stop's value.
    fn beyond(&self, stop: &Stop, t_s: f64, y: &State) -> f64 {
        let place = stop.limit.column;
        let value = match (place, COLUMNS.get(place)) {
            (column::AGL, _) => self.ground_m(y).map_or(f64::NAN, |ground| self.place(y).altitude_m - ground),
            (_, Some(&"altitude_m")) => self.motion.planet.altitude_m(motion::position(y)),
            _ => self.row_of(t_s, y)[place],
        };
        value - stop.limit.value
    }

    /// The first stop within the step from `good` to now: how far ahead of `good`, seconds.
    fn first_stop<'s>(&self, good: &(f64, State, Before<f64, N>), stops: &'s [Stop]) -> Option<(f64, &'s Stop)> {
        let step_s = self.t_s - good.0;
        let mut first: Option<(f64, &Stop)> = None;
        for stop in stops {
            let ends = |y: &State| (motion::position(y), motion::velocity(y));
            let ahead_s = match &self.ground {
                Some(ground) if stop.is_ground => {
                    ground.impact(ends(&good.1), ends(&self.y), step_s).map(|impact| impact.time_s)
                }
                _ => {
                    let (from, to) = (self.beyond(stop, good.0, &good.1), self.beyond(stop, self.t_s, &self.y));
                    stop.limit.relation.passed(from, to).then(|| self.crossing_s(stop, from, good, step_s))
                }
            };
            if let Some(ahead_s) = ahead_s.filter(|ahead_s| first.is_none_or(|(before, _)| *ahead_s < before)) {
                first = Some((ahead_s, stop));
            }
        }
        first
    }

    /// When a stop whose column is `from` above its value at the step's start is passed, seconds after it.
    fn crossing_s(&self, stop: &Stop, from: f64, good: &(f64, State, Before<f64, N>), step_s: f64) -> f64 {
        let (mut low, mut high) = (0.0, step_s);
        // The time to f64 rounding: each look halves the step.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            let there = self.glimpse_from(good.0, &good.1, middle);
            let passed = stop.limit.relation.passed(from, self.beyond(stop, good.0 + middle, &there));
            (low, high) = if passed { (low, middle) } else { (middle, high) };
        }
        high
    }
}
