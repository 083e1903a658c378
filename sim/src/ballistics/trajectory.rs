//! One shot from the muzzle to its end, as rows.
//!
//! Steps lie on a grid of `run.dt_s` (or [`STEP_S`]) from the muzzle, cut where the thrust of a burn has a row. A row or an end
//! within a step is found by taking a shorter step from the step's own start, so it is as exact as the integrator and lies
//! on no chord. Rows are at the muzzle, at each multiple of `shot.step_m` of range or `shot.step_s` (else
//! `run.output_dt_s`) of time, and at the end, in the order of time.
//!
//! What ends a shot first: `shot.until`, any of `run.stop`, `run.seconds`. With none of them it is the ground of
//! `run.world`; without a world the muzzle's altitude on the way down, or, for a shot that does not climb at first, the
//! altitude 0. Without `run.seconds` it ends in any case after an hour (event `time`) or 12 km below both the muzzle and
//! altitude 0 (event `floor`).
//! A muzzle in or under the ground, where ground ends a shot, ends it at once.

use super::column::{Column, End, IN_FILE, NAMES};
use super::drift::SpinDrift;
use super::launch::{Launch, STEP_S};
use super::motion::{ShellMotion, State, StepError, advance, parts, state};
use super::observer::Observer;
use super::projectile::Projectile;
use crate::case::{Case, MOST_STEPS};
use crate::file::FileError;
use crate::integrate::Before;
use crate::limit::ON_IT;
use crate::world_ground::WorldGround;
use std::fmt;

/// The event of a shot that fell below every ground.
pub const FLOOR: &str = "floor";

/// Longest flight where a case gives none, seconds.
pub const LONGEST_S: f64 = 3_600.0;
/// How far below muzzle and altitude 0 a shot is followed, metres.
pub const FLOOR_M: f64 = 12_000.0;
/// Most rows.
pub const MOST_ROWS: usize = 2_000_000;
/// A row this near to the end's is the end's row: part of the distance between rows.
const SAME_ROW: f64 = 1e-6;

/// One row: the columns of the file (see [`NAMES`]), and what happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// In the order of [`NAMES`].
    pub values: [f64; IN_FILE],
    /// `muzzle`, what ended the shot, or nothing.
    pub event: String,
}

/// A shot that was flown.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// From the muzzle to the end.
    pub rows: Vec<Row>,
    /// How it left.
    pub launch: Launch,
    /// How it drifted.
    pub drift: Option<SpinDrift>,
    /// Way over the ground along the azimuth, metres; see [`super::column`].
    pub range_m: f64,
    /// Descent under the horizontal of the place at the end, degrees.
    pub fall_deg: f64,
    /// Greatest altitude, metres.
    pub apex_altitude_m: f64,
    /// Steps of the integrator to the end, those within cut steps counted.
    pub steps: u64,
    /// Length of a step, seconds.
    pub dt_s: f64,
}

/// Why there is no trajectory.
#[derive(Debug, Clone, PartialEq)]
pub enum TrajectoryError {
    /// A file asks what cannot be.
    Input(FileError),
    /// A step cannot be taken.
    Step(StepError),
    /// More steps or rows than anyone wants.
    TooMuch {
        /// `steps` or `rows`.
        what: &'static str,
        /// How many are allowed.
        most: f64,
        /// Time since the shot, seconds.
        t_s: f64,
    },
}

impl fmt::Display for TrajectoryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(error) => error.fmt(f),
            Self::Step(error) => error.fmt(f),
            Self::TooMuch { what, most, t_s } => write!(f, "expected at most {most} {what}, found more after {t_s} s"),
        }
    }
}

impl std::error::Error for TrajectoryError {}

impl From<StepError> for TrajectoryError {
    fn from(error: StepError) -> Self {
        Self::Step(error)
    }
}

impl From<FileError> for TrajectoryError {
    fn from(error: FileError) -> Self {
        Self::Input(error)
    }
}

/// When rows are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Every {
    Metres(f64),
    Seconds(f64),
    Never,
}

/// One step, from which shorter ones are taken.
struct Step {
    from_s: f64,
    from: State,
    length_s: f64,
    /// The integrator's memory at its start.
    before: Before<f64, 6>,
}

/// Flies the shot of a case. `ground` is that of `run.world`, if the case names one.
///
/// # Errors
/// [`TrajectoryError::Input`] names the key of a file that contradicts another; the others tell what stopped the flight.
pub fn fly(projectile: &Projectile, case: &Case, ground: Option<&WorldGround>) -> Result<Trajectory, TrajectoryError> {
    Flight::new(projectile, case, ground)?.fly()
}

struct Flight<'a> {
    observer: Observer<'a>,
    motion: ShellMotion<'a>,
    burn: &'a [[f64; 2]],
    ends: Vec<End>,
    every: Every,
    longest_s: f64,
    floor_m: f64,
    dt_s: f64,
    start: State,
}

impl<'a> Flight<'a> {
    fn new(
        projectile: &'a Projectile,
        case: &'a Case,
        ground: Option<&'a WorldGround>,
    ) -> Result<Self, TrajectoryError> {
        let fail = |why: String| FileError::new(&case.file, why);
        for (key, given) in [("turbulence", case.turbulence.is_some()), ("trim", case.trim.is_some())] {
            if given {
                return Err(fail(format!("{key}: expected none for a trajectory")).into());
            }
        }
        let launch = Launch::of(case, projectile)?;
        let motion = ShellMotion::new(projectile, case.planet, &case.atmosphere, &case.wind, launch.bore());
        let start = state(launch.position_m, launch.velocity_mps);
        let muzzle_m = case.planet.altitude_m(launch.position_m);
        let speed_mps = launch.velocity_mps.length();
        let drift = SpinDrift::of(projectile, speed_mps, &case.atmosphere.at(muzzle_m));
        let observer = Observer { case, launch, drift, ground };
        let mut ends = Vec::new();
        if let Some(until) = case.shot.as_ref().and_then(|shot| shot.until.as_ref()) {
            ends.push(End::parse(until).map_err(|why| fail(format!("shot.until: {why}")))?);
        }
        for (i, stop) in case.run.stop.iter().enumerate() {
            ends.push(End::parse(stop).map_err(|why| fail(format!("run.stop[{i}]: {why}")))?);
        }
        if ground.is_some() && !ends.contains(&End::Ground) {
            // A world that is named is there.
            ends.push(End::Ground);
        } else if ends.is_empty() && case.run.seconds.is_none() {
            let climbs = observer.launch.climbs();
            ends.push(if climbs { End::Return } else { End::Ground });
        }
        let shot = case.shot.as_ref();
        let every = match (shot.and_then(|shot| shot.step_m), shot.and_then(|shot| shot.step_s), case.run.output_dt_s) {
            (Some(metres), ..) => Every::Metres(metres),
            (_, Some(seconds), _) | (_, _, Some(seconds)) => Every::Seconds(seconds),
            _ => Every::Never,
        };
        Ok(Self {
            observer,
            motion,
            burn: &projectile.burn,
            ends,
            every,
            longest_s: case.run.seconds.unwrap_or(LONGEST_S),
            floor_m: if case.run.seconds.is_some() { f64::NEG_INFINITY } else { muzzle_m.min(0.0) - FLOOR_M },
            dt_s: case.run.dt_s.unwrap_or(STEP_S),
            start,
        })
    }

    fn fly(mut self) -> Result<Trajectory, TrajectoryError> {
        let integrator = self.observer.case.run.integrator;
        let mut rows = vec![self.row(0.0, &self.start, "muzzle")];
        let mut apex_m = self.observer.altitude_m(&self.start);
        let (mut t_s, mut y, mut before): (f64, State, Before<f64, 6>) = (0.0, self.start, None);
        let (mut grid, mut taken, mut next_row) = (0u64, 0u64, 1u64);
        if let Some(event) = self.over_at_the_muzzle() {
            return Ok(self.finished(rows, 0.0, self.start, event, apex_m, 0));
        }
        loop {
            // The next of: the grid, a row of the burn, the longest flight.
            let grid_s = ((grid + 1) as f64 * self.dt_s).min(self.longest_s);
            let edge_s = self.burn.iter().map(|row| row[0]).find(|row_s| *row_s > t_s).unwrap_or(f64::INFINITY);
            let to_s = grid_s.min(edge_s);
            let step = Step { from_s: t_s, from: y, length_s: to_s - t_s, before };
            self.motion.burn_as_at(self.burn, 0.5 * (t_s + to_s));
            let (next, pieces) = advance(integrator, &self.motion, t_s, &y, step.length_s, &mut before)?;
            taken += pieces;
            let end = self.first_end(&step, &next)?;
            let (last_s, last) = end.as_ref().map_or((step.length_s, next), |(cut_s, last, _)| (*cut_s, *last));
            let over = end.is_some() || to_s >= self.longest_s;
            next_row = self.rows_within(&step, last_s, &last, over, next_row, &mut rows)?;
            apex_m = apex_m.max(self.highest_m(&step, last_s, &last)?);
            if let Some((cut_s, last, event)) = end {
                return Ok(self.finished(rows, t_s + cut_s, last, event, apex_m, taken));
            }
            if to_s >= self.longest_s {
                return Ok(self.finished(rows, to_s, next, "time".to_owned(), apex_m, taken));
            }
            if self.observer.altitude_m(&next) < self.floor_m {
                return Ok(self.finished(rows, to_s, next, FLOOR.to_owned(), apex_m, taken));
            }
            if taken as f64 > MOST_STEPS {
                return Err(TrajectoryError::TooMuch { what: "steps", most: MOST_STEPS, t_s });
            }
            if to_s == edge_s {
                // The rate jumps there: it is no memory for the next step.
                before = None;
            }
            if to_s == grid_s {
                grid += 1;
            }
            (t_s, y) = (to_s, next);
        }
    }

    /// What ends the shot before it has left.
    fn over_at_the_muzzle(&self) -> Option<String> {
        let seen = self.observer.seen(0.0, &self.start);
        let over = |end: &&End| match end {
            End::Return => false,
            End::Ground if self.observer.ground.is_some() => {
                let position_m = parts(&seen).0;
                let ground_m = self.observer.ground.and_then(|ground| ground.height_m(position_m));
                ground_m.is_some_and(|ground_m| self.observer.altitude_m(&seen) <= ground_m)
            }
            End::Ground => {
                let altitude_m = self.observer.altitude_m(&seen);
                altitude_m < -ON_IT || (altitude_m <= ON_IT && !self.observer.launch.climbs())
            }
            End::Column(limit) => {
                let beyond = self.observer.beyond(limit, &self.motion, 0.0, &seen);
                limit.relation.at_start(beyond)
            }
        };
        self.ends.iter().find(over).map(|end| end.event().to_owned())
    }

    /// The state a part of a step later.
    fn at(&self, step: &Step, cut_s: f64) -> Result<State, StepError> {
        if cut_s <= 0.0 {
            return Ok(step.from);
        }
        let mut before = step.before;
        let integrator = self.observer.case.run.integrator;
        advance(integrator, &self.motion, step.from_s, &step.from, cut_s, &mut before).map(|(state, _)| state)
    }

    /// The first end within a step: how far into it, the state there, the event.
    fn first_end(&self, step: &Step, next: &State) -> Result<Option<(f64, State, String)>, StepError> {
        let mut first: Option<(f64, State, String)> = None;
        let observer = &self.observer;
        let (from, to) = (observer.seen(step.from_s, &step.from), observer.seen(step.from_s + step.length_s, next));
        let muzzle_m = observer.launch.place.altitude_m;
        for end in &self.ends {
            let mut event = end.event().to_owned();
            let cut_s = match end {
                End::Ground if observer.ground.is_some() => observer
                    .ground
                    .and_then(|ground| ground.impact(parts(&from), parts(&to), step.length_s))
                    .map(|impact| {
                        if let Some(thing) = impact.object {
                            event = thing.to_string();
                        }
                        impact.time_s
                    }),
                End::Ground | End::Return => {
                    let level_m = if *end == End::Ground { 0.0 } else { muzzle_m };
                    let above = |_: f64, seen: &State| observer.altitude_m(seen) - level_m;
                    let (above_from, above_to) = (above(0.0, &from), above(0.0, &to));
                    if above_to <= 0.0 && (above_from > 0.0 || above_to < 0.0) {
                        Some(self.crossing(step, [above_from, above_to], above)?)
                    } else {
                        None
                    }
                }
                End::Column(limit) => {
                    let beyond = |t_s: f64, seen: &State| observer.beyond(limit, &self.motion, t_s, seen);
                    let values = [beyond(step.from_s, &from), beyond(step.from_s + step.length_s, &to)];
                    if limit.passed(values[0], values[1]) { Some(self.crossing(step, values, beyond)?) } else { None }
                }
            };
            if let Some(cut_s) = cut_s
                && first.as_ref().is_none_or(|(earliest, ..)| cut_s < *earliest)
            {
                let last = if cut_s < step.length_s { self.at(step, cut_s)? } else { *next };
                first = Some((cut_s, last, event));
            }
        }
        Ok(first)
    }

    /// Where a number of the seen state is 0 within a step; `values` are those at both ends, of different signs.
    ///
    /// Secants within a bracket, the stale end halved (Illinois): to the rounding of the time.
    fn crossing(&self, step: &Step, values: [f64; 2], number: impl Fn(f64, &State) -> f64) -> Result<f64, StepError> {
        let [at_start, at_end] = values;
        let value_at = |cut_s: f64| {
            let seen = self.observer.seen(step.from_s + cut_s, &self.at(step, cut_s)?);
            Ok(number(step.from_s + cut_s, &seen))
        };
        let (mut start_s, mut at_start) = (0.0, at_start);
        if at_end == 0.0 {
            return Ok(step.length_s);
        }
        if at_start * at_end >= 0.0 {
            // A shot that rises from its limit and is back within the step: where it is on the other side.
            let other = (1..60).map(|halvings| step.length_s * 0.5f64.powi(halvings));
            let mut found = None;
            for cut_s in other {
                let value = value_at(cut_s)?;
                if value * at_end < 0.0 {
                    found = Some((cut_s, value));
                    break;
                }
            }
            let Some(other) = found else { return Ok(0.0) };
            (start_s, at_start) = other;
        }
        // The newest point and the one across the zero.
        let (mut across, mut at_across, mut newest, mut at_newest) = (start_s, at_start, step.length_s, at_end);
        for _ in 0..80 {
            let rounding_s = f64::EPSILON * (step.from_s + newest);
            if at_newest == 0.0 || (newest - across).abs() <= rounding_s {
                break;
            }
            let secant = newest - at_newest * ((newest - across) / (at_newest - at_across));
            let cut_s = secant.clamp(newest.min(across), newest.max(across));
            if (cut_s - newest).abs() <= 0.25 * rounding_s {
                break;
            }
            let value = value_at(cut_s)?;
            if value * at_newest < 0.0 {
                (across, at_across) = (newest, at_newest);
            } else {
                at_across *= 0.5;
            }
            (newest, at_newest) = (cut_s, value);
        }
        Ok(newest)
    }

    /// Takes the rows up to a part of a step; gives the number of the next row.
    fn rows_within(
        &self,
        step: &Step,
        last_s: f64,
        last: &State,
        over: bool,
        mut next_row: u64,
        rows: &mut Vec<Row>,
    ) -> Result<u64, TrajectoryError> {
        let observer = &self.observer;
        let (every, reached, from) = match self.every {
            Every::Never => return Ok(next_row),
            Every::Seconds(seconds) => (seconds, step.from_s + last_s, step.from_s),
            Every::Metres(metres) => {
                let range =
                    |t_s: f64, y: &State| observer.value(Column::Range, &self.motion, t_s, &observer.seen(t_s, y));
                (metres, range(step.from_s + last_s, last), range(step.from_s, &step.from))
            }
        };
        // The end has its own row.
        let before = if over { reached - SAME_ROW * every } else { reached };
        while next_row as f64 * every <= before {
            let target = next_row as f64 * every;
            let cut_s = match self.every {
                Every::Seconds(_) => (target - step.from_s).clamp(0.0, last_s),
                _ => {
                    let beyond =
                        |t_s: f64, seen: &State| observer.value(Column::Range, &self.motion, t_s, seen) - target;
                    // A shot that turned back passes a row's range once, on the way out.
                    let whole = Step { from_s: step.from_s, from: step.from, length_s: last_s, before: step.before };
                    self.crossing(&whole, [from - target, reached - target], beyond)?
                }
            };
            let y = if cut_s < last_s { self.at(step, cut_s)? } else { *last };
            // A multiple of a time is printed as that, without the rounding of the sum.
            let t_s = if matches!(self.every, Every::Seconds(_)) { target } else { step.from_s + cut_s };
            rows.push(self.row(t_s, &y, ""));
            if rows.len() > MOST_ROWS {
                return Err(TrajectoryError::TooMuch { what: "rows", most: MOST_ROWS as f64, t_s: step.from_s });
            }
            next_row += 1;
        }
        Ok(next_row)
    }

    /// The greatest altitude within a part of a step.
    fn highest_m(&self, step: &Step, last_s: f64, last: &State) -> Result<f64, StepError> {
        let observer = &self.observer;
        let climb = |_: f64, seen: &State| observer.climb_mps(seen);
        let ends = [step.from, *last].map(|y| climb(0.0, &y));
        let higher_m = observer.altitude_m(&step.from).max(observer.altitude_m(last));
        if ends[0] <= 0.0 || ends[1] >= 0.0 {
            return Ok(higher_m);
        }
        let whole = Step { from_s: step.from_s, from: step.from, length_s: last_s, before: step.before };
        let cut_s = self.crossing(&whole, ends, climb)?;
        Ok(higher_m.max(observer.altitude_m(&self.at(&whole, cut_s)?)))
    }

    fn row(&self, t_s: f64, y: &State, event: &str) -> Row {
        let seen = self.observer.seen(t_s, y);
        let mut values = [0.0; IN_FILE];
        for (value, (column, _)) in values.iter_mut().zip(NAMES) {
            // No -0 is printed.
            *value = self.observer.value(column, &self.motion, t_s, &seen) + 0.0;
        }
        Row { values, event: event.to_owned() }
    }

    fn finished(
        &self,
        mut rows: Vec<Row>,
        t_s: f64,
        last: State,
        event: String,
        apex_altitude_m: f64,
        steps: u64,
    ) -> Trajectory {
        rows.push(self.row(t_s, &last, &event));
        let seen = self.observer.seen(t_s, &last);
        let value = |column| self.observer.value(column, &self.motion, t_s, &seen) + 0.0;
        Trajectory {
            rows,
            launch: self.observer.launch,
            drift: self.observer.drift,
            range_m: value(Column::Range),
            fall_deg: value(Column::Fall),
            apex_altitude_m,
            steps,
            dt_s: self.dt_s,
        }
    }
}

impl Row {
    /// A column of the row, in the order of the file.
    pub fn get(&self, column: Column) -> Option<f64> {
        NAMES[..IN_FILE].iter().position(|(known, _)| *known == column).map(|i| self.values[i])
    }
}

impl Trajectory {
    /// The first row's names, then a line a row. Numbers are plain decimals that read back to the same f64.
    pub fn to_csv(&self) -> String {
        use fmt::Write as _;
        let mut text = NAMES[..IN_FILE].iter().map(|(_, name)| *name).collect::<Vec<_>>().join(",") + ",event\n";
        for row in &self.rows {
            for value in row.values {
                // Writing to a String cannot fail.
                let _ = write!(text, "{value},");
            }
            text.push_str(&row.event);
            text.push('\n');
        }
        text
    }

    /// The row at the end.
    pub fn end(&self) -> &Row {
        &self.rows[self.rows.len() - 1]
    }
}
