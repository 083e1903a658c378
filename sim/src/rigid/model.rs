//! The checked model of a rigid body: `M.toml`.
//!
//! Points are metres from the reference point, body axes (forward, right, down): the centre of gravity, the point that
//! moments are about, the points where thrusts act; what is left out is the reference point itself. The inertia tensor
//! is about the centre of gravity, its products with the sign they have in the tensor.
//!
//! Invariant others rely on: mass and inertia are those of a body that can exist, and every name is a slot.

use super::aero::{Axes, COEFFICIENTS, Flow, Tables, Term, Thrust};
use super::gear::contact::Contact;
use super::gear::file::contacts;
use super::handbook::Handbook;
use super::links::{self, Found, LinkMemory, Links, Source};
use super::model_checks::{
    bound_tables, check_body, controls, names_of, needs, notes, sources, stall_cues, tank, tensor, terms, thrusts,
};
use super::model_file::{AxesFile, ModelFile};
use super::power::file::power_plant;
use super::power::shaft::PowerPlant;
use super::quantity::{QUANTITIES, Quantity, SLOTS, without_unit};
use super::signal::{Signal, signals, tables_and_signals};
use crate::autopilot::Tuning;
use crate::case::Setting;
use crate::daveml::si_factor;
use crate::file::{self, FileError};
use glam::{DMat3, DVec3};
use std::path::{Path, PathBuf};

/// A control of a model, in the unit that its name ends with.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// Its name.
    pub name: String,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Value before any input.
    pub initial: f64,
    /// How fast it moves, in its own unit a second; `None`: at once.
    pub per_s: Option<f64>,
    /// Time constant with which it follows what it is told, seconds; `None`: at once.
    pub lag_s: Option<f64>,
}

impl Control {
    /// Whether it takes its time.
    pub fn is_slow(&self) -> bool {
        self.per_s.is_some() || self.lag_s.is_some()
    }
}

/// Where fuel lies, and how much goes in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FuelTank {
    /// Metres from the reference point.
    pub at_m: DVec3,
    /// kg.
    pub capacity_kg: f64,
    /// Slot of the signal that is the engine's flow, kg/s.
    pub flow_slot: Option<usize>,
}

/// Angles of attack at which a stall tells itself, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StallCues {
    /// The warning sounds from here on.
    pub warning_rad: f64,
    /// The airframe begins to shake.
    pub buffet_rad: f64,
    /// It shakes fully.
    pub full_buffet_rad: f64,
}

/// The course that the cross-track counts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Course {
    /// Nothing asks for the cross-track.
    None,
    /// A fixed one, radians from north.
    Fixed(f64),
    /// A control, by its place, and what turns it into radians.
    Control(usize, f64),
}

/// A rigid body and what the air and its engines do to it.
#[derive(Debug, Clone)]
pub struct Model {
    /// The file it comes from.
    pub file: PathBuf,
    /// What it looks like: the name of a shape of whoever draws it.
    pub looks: Option<String>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Inertia tensor about the centre of gravity, kg m2.
    pub inertia_kgm2: DMat3,
    /// Its inverse.
    pub inverse_inertia: DMat3,
    /// Centre of gravity.
    pub cg_m: DVec3,
    /// Never-exceed speed, if the model tells it.
    pub never_exceed_mps: Option<f64>,
    /// Reference area, m2.
    pub area_m2: f64,
    /// Reference span, metres.
    pub span_m: f64,
    /// Reference chord, metres.
    pub chord_m: f64,
    /// The point that coefficients of moments are about.
    pub moment_point_m: DVec3,
    /// Axes of CD, CY, CL.
    pub axes: Axes,
    /// Least speed in the hats of the rates, m/s.
    pub min_speed_mps: f64,
    /// Controls, by name.
    pub controls: Vec<Control>,
    /// Wheels, and parts that should not touch.
    pub contacts: Vec<Contact>,
    /// Engine and propeller, if it has them.
    pub power: Option<PowerPlant>,
    /// Its fuel, if that counts in the centre of gravity. Mass and centre of gravity of `[body]` are with full tanks.
    pub tank: Option<FuelTank>,
    /// Stall cues, if it has any.
    pub stall: Option<StallCues>,
    /// What its handbook says.
    pub handbook: Option<Handbook>,
    /// How an autopilot flies it.
    pub autopilot: Tuning,
    signals: Vec<Signal>,
    terms: Vec<Term>,
    thrusts: Vec<Thrust>,
    tables: Tables,
    sources: Vec<Source>,
    links: Links,
    uses: [bool; QUANTITIES],
    course: Course,
    refuses: bool,
    /// What looks like a slip in the file, though it can be flown; sentences.
    pub notes: Vec<String>,
}

/// Force and moment about the centre of gravity, body axes, without gravity.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Loads {
    /// Newtons.
    pub force_n: DVec3,
    /// Newton metres.
    pub moment_nm: DVec3,
}

impl Model {
    /// Reads and checks a model, and the DAVE-ML files that it names.
    ///
    /// # Errors
    /// [`FileError`] names the file and the key, what was expected and what was found.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        Self::from_text(path, &file::text(path)?)
    }

    /// The same of a text; other files are looked for beside `path`.
    ///
    /// # Errors
    /// [`FileError`] names the file and the key, what was expected and what was found.
    pub fn from_text(path: &Path, text: &str) -> Result<Self, FileError> {
        let file: ModelFile = file::toml_text(path, text)?;
        let sources = sources(path, &file)?;
        let constants = links::constants(&sources)?;
        let here = |why: String| FileError::new(path, why);
        let controls = controls(&file.controls).map_err(here)?;

        let body = match (&file.body, constants.mass_kg, constants.inertia_kgm2) {
            (Some(body), ..) => (body.mass_kg, tensor(body.inertia_kgm2), DVec3::from_array(body.cg_m)),
            (None, Some(mass_kg), Some(inertia)) => (mass_kg, inertia, constants.cg_m.unwrap_or_default()),
            _ => {
                return Err(here(
                    "body: expected mass_kg and inertia_kgm2, found neither them nor a DAVE-ML file with both"
                        .to_owned(),
                ));
            }
        };
        let (mass_kg, inertia_kgm2, cg_m) = body;
        check_body(mass_kg, inertia_kgm2).map_err(here)?;

        let table_names: Vec<String> = file.table.keys().cloned().collect();
        let signals = signals(&file, &controls, &table_names).map_err(here)?;
        let mut names = names_of(&controls);
        names.extend(signals.iter().map(|signal| signal.name.clone()));
        let tables = bound_tables(&file, &names, QUANTITIES + controls.len()).map_err(here)?;
        let terms = terms(&file, &names, &table_names).map_err(here)?;
        let thrusts = thrusts(&file.thrust, &names, &table_names).map_err(here)?;
        let links = Links::bind(&sources, &controls, signals.len(), &[])?;
        let (area, span, chord) = (
            file.reference.area_m2.or(constants.area_m2),
            file.reference.span_m.or(constants.span_m),
            file.reference.chord_m.or(constants.chord_m),
        );
        for (key, length) in [("area_m2", area), ("span_m", span), ("chord_m", chord)] {
            if length.is_some_and(|length| !(length > 0.0 && length < 1e6)) {
                return Err(here(format!(
                    "reference.{key}: expected a number above 0, found {}",
                    length.unwrap_or(0.0)
                )));
            }
            if length.is_none() && !(terms.is_empty() && links.is_empty()) && needs(key, &terms, &file) {
                return Err(here(format!("reference.{key}: expected a number above 0, found none")));
            }
        }
        let min_speed_mps = file.aero.min_speed_mps.unwrap_or(1e-3);
        if !(min_speed_mps > 0.0 && min_speed_mps < 1e4) {
            return Err(here(format!("aero.min_speed_mps: expected a number above 0, found {min_speed_mps}")));
        }
        let never_exceed_mps = file.body.as_ref().and_then(|body| body.never_exceed_mps);
        if let Some(found) = never_exceed_mps.filter(|v| !(*v > 0.0 && *v < 1e5)) {
            return Err(here(format!("body.never_exceed_mps: expected a number above 0, found {found}")));
        }
        let contacts = contacts(&file.wheel, &file.skid, &controls, mass_kg).map_err(here)?;
        let power = power_plant(file.engine.as_ref(), file.propeller.as_ref(), &controls).map_err(here)?;
        let tank = file.fuel.as_ref().map(|fuel| tank(fuel, mass_kg, &names)).transpose().map_err(here)?;
        let stall = file.stall.as_ref().map(stall_cues).transpose().map_err(here)?;
        let autopilot = file.autopilot.unwrap_or_default();
        autopilot.check().map_err(here)?;
        let mut model = Self {
            file: path.to_owned(),
            looks: file.looks.clone(),
            mass_kg,
            inertia_kgm2,
            inverse_inertia: inertia_kgm2.inverse(),
            cg_m,
            never_exceed_mps,
            area_m2: area.unwrap_or(1.0),
            span_m: span.unwrap_or(1.0),
            chord_m: chord.unwrap_or(1.0),
            moment_point_m: DVec3::from_array(file.reference.moment_point_m.unwrap_or_default()),
            axes: match file.aero.axes {
                AxesFile::Wind => Axes::Wind,
                AxesFile::Stability => Axes::Stability,
                AxesFile::Body => Axes::Body,
            },
            min_speed_mps,
            controls,
            contacts,
            power,
            tank,
            stall,
            handbook: file.handbook.clone(),
            autopilot,
            signals,
            terms,
            thrusts,
            tables,
            sources,
            links,
            uses: [false; QUANTITIES],
            course: Course::None,
            refuses: false,
            notes: notes(&file),
        };
        model.refuses = model.tables.0.iter().any(|bound| bound.refuse_outside);
        model.note_uses();
        Ok(model)
    }

    /// The same model with values for variables of its DAVE-ML files, SI, that go before all others.
    ///
    /// # Errors
    /// [`FileError`] if no file has a variable of such a name.
    pub fn with_found(&self, found: &[Found]) -> Result<Self, FileError> {
        let mut model = self.clone();
        model.links = Links::bind(&self.sources, &self.controls, self.signals.len(), found)?;
        model.note_uses();
        Ok(model)
    }

    /// The DAVE-ML files of the model.
    pub fn daveml_files(&self) -> impl Iterator<Item = &Path> {
        self.sources.iter().map(|source| source.file.as_path())
    }

    /// The same model without the places of its files, only their names: what it is made of, wherever it lies.
    #[must_use]
    pub fn placeless(&self) -> Self {
        let mut model = self.clone();
        model.file = PathBuf::new();
        for source in &mut model.sources {
            source.file = source.file.file_name().map(PathBuf::from).unwrap_or_default();
        }
        model
    }

    /// Whether a DAVE-ML file of the model has such a variable.
    pub fn has_variable(&self, name: &str) -> bool {
        self.sources.iter().any(|source| source.document.variable(name).is_ok())
    }

    /// The place of a control.
    pub fn control(&self, name: &str) -> Option<usize> {
        self.controls.iter().position(|control| control.name == name)
    }

    /// The slot of a signal.
    pub fn signal_slot(&self, name: &str) -> Option<usize> {
        let place = self.signals.iter().position(|signal| signal.name == name)?;
        Some(QUANTITIES + self.controls.len() + place)
    }

    /// Values of all controls before any input.
    pub fn initial_controls(&self) -> Vec<f64> {
        self.controls.iter().map(|control| control.initial).collect()
    }

    /// Whether anything depends on a quantity.
    #[inline]
    pub fn uses(&self, quantity: Quantity) -> bool {
        self.uses[quantity.slot()]
    }

    /// Memory for [`Self::loads`], one a thread.
    pub fn memory(&self) -> LinkMemory {
        self.links.memory()
    }

    fn note_uses(&mut self) {
        let factors = self.terms.iter().map(|t| &t.of).chain(self.thrusts.iter().map(|t| &t.of));
        let factors = factors.chain(self.signals.iter().flat_map(|signal| &signal.terms));
        let slots = factors.flat_map(|of| of.times.iter().copied());
        let of_tables = self.tables.0.iter().flat_map(|bound| bound.slots.iter().copied());
        let mut uses = [false; QUANTITIES];
        for slot in slots.chain(of_tables).chain(self.links.quantities.iter().copied()).filter(|s| *s < QUANTITIES) {
            uses[slot] = true;
        }
        self.uses = uses;
        self.course = if self.uses(Quantity::CrossTrackM) { self.commanded_course() } else { Course::None };
    }

    /// The course that the autopilot's files are given: by a control, or by what the model sets.
    fn commanded_course(&self) -> Course {
        const NAME: &str = "trueBaseCourseCommand";
        for (place, control) in self.controls.iter().enumerate() {
            if let Some((_, si)) = without_unit(&control.name).filter(|(stem, _)| stem.eq_ignore_ascii_case(NAME)) {
                return Course::Control(place, si);
            }
        }
        let fixed = self.sources.iter().find_map(|source| {
            let variable = source.document.variable(NAME).ok()?;
            let set = source.set.iter().find(|(name, _)| **name == variable.id || name.eq_ignore_ascii_case(NAME));
            match set {
                Some((_, Setting::Number(value))) => Some(value * si_factor(&variable.units)?),
                _ => variable.initial.map(|value| value * si_factor(&variable.units).unwrap_or(1.0)),
            }
        });
        Course::Fixed(fixed.unwrap_or(0.0))
    }

    /// The course that the cross-track counts from.
    #[inline]
    pub fn course(&self) -> Course {
        self.course
    }

    /// Mass and centre of gravity with so much less fuel than full tanks.
    pub fn lighter(&self, less_kg: f64) -> (f64, DVec3) {
        let mass_kg = self.mass_kg - less_kg;
        let Some(tank) = self.tank else { return (mass_kg, self.cg_m) };
        (mass_kg, (self.cg_m * self.mass_kg - tank.at_m * less_kg) / mass_kg)
    }

    /// Force and moment about a centre of gravity at the flight's quantities, which stand in `slots` with the controls behind them.
    ///
    /// `through_air` is the body's velocity through the air, forward, right, down; `thrust_share` scales all thrusts.
    #[inline]
    pub fn loads(
        &self,
        slots: &mut [f64; SLOTS],
        through_air: DVec3,
        dynamic_pressure_pa: f64,
        thrust_share: f64,
        cg_m: DVec3,
        memory: &mut LinkMemory,
    ) -> Loads {
        let tables = tables_and_signals(&self.tables, &self.signals, QUANTITIES + self.controls.len(), slots);
        let mut c = [0.0; COEFFICIENTS];
        for term in &self.terms {
            c[term.to] += term.of.product(slots, &tables);
        }
        let mut loads = Loads::default();
        if !self.links.is_empty() {
            self.links.run(slots, memory, &mut c);
            let (force_n, moment_nm) = self.links.thrust(slots);
            loads = Loads { force_n: force_n * thrust_share, moment_nm: moment_nm * thrust_share };
        }
        let pressed = dynamic_pressure_pa * self.area_m2;
        let force = Flow::of(through_air).force(self.axes, &c) * pressed;
        let [.., roll, pitch, yaw, _] = c;
        let moment = DVec3::new(roll * self.span_m, pitch * self.chord_m, yaw * self.span_m) * pressed;
        loads.force_n += force;
        loads.moment_nm += moment + (self.moment_point_m - cg_m).cross(force);
        for thrust in &self.thrusts {
            let force = thrust.force_n * (thrust.of.product(slots, &tables) * thrust_share);
            loads.force_n += force;
            loads.moment_nm += (thrust.at_m - cg_m).cross(force);
        }
        loads
    }

    /// Whether a table of the model refuses arguments outside it.
    #[inline]
    pub fn refuses(&self) -> bool {
        self.refuses
    }

    /// The first argument outside a table that refuses it, as a sentence.
    pub fn refused(&self, slots: &[f64; SLOTS]) -> Option<String> {
        self.tables.refused(slots)
    }
}
