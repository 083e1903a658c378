//! DAVE-ML files bound to a model and to each other, by their AIAA S-119 names and units.
//!
//! An input takes, in this order: what `set` says (a number in the file's own unit, or the name of a quantity or
//! control); the control of that name (its name without the unit it ends with); an output of another file; a quantity of
//! the flight; its initial value. A control with the name of a quantity is added to it: an offset of the sensor.
//! Outputs with a standard name are coefficients, thrusts, reference lengths and mass properties. Mass properties are
//! computed once.
//!
//! Slots hold SI numbers; each file gets and gives its own units.

use super::aero::{COEFFICIENTS, Coefficient};
use super::model::Control;
use super::quantity::{Quantity, SLOTS, without_unit};
use crate::case::Setting;
use crate::daveml::{Document, Kind, Memory, Program, Variable, si_factor};
use crate::file::FileError;
use glam::{DMat3, DVec3};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

/// A DAVE-ML file of a model.
#[derive(Debug, Clone)]
pub struct Source {
    /// The file.
    pub file: PathBuf,
    /// What it says.
    pub document: Arc<Document>,
    /// What the model sets in it.
    pub set: BTreeMap<String, Setting>,
}

/// A value that trim found for a variable of any file, SI.
pub type Found = (String, f64);

/// The files of a model, compiled and in the order in which they are run.
#[derive(Debug, Clone, Default)]
pub struct Links {
    links: Vec<Link>,
    /// Slots of coefficients.
    coefficients: Vec<(usize, usize)>,
    /// Slots of thrust along body axes.
    force: [Option<usize>; 3],
    /// Slots of its moment about body axes.
    moment: [Option<usize>; 3],
    /// Which quantities are read.
    pub(super) quantities: BTreeSet<usize>,
}

/// A slot, and what its number is multiplied with to have another unit.
type Scaled = (usize, f64);

#[derive(Debug, Clone)]
struct Link {
    program: Program,
    /// One slot, or two to add up, into the file's units.
    inputs: Vec<(Scaled, Option<Scaled>)>,
    /// The file's units into SI.
    outputs: Vec<Scaled>,
}

/// Memory of all programs of a model, for one thread.
#[derive(Debug, Clone, Default)]
pub struct LinkMemory(Vec<(Memory, Vec<f64>, Vec<f64>)>);

/// Coefficients by their standard names.
const COEFFICIENT_NAMES: [(&str, Coefficient); 8] = [
    ("aeroBodyForceCoefficient_X", Coefficient::CX),
    ("aeroBodyForceCoefficient_Y", Coefficient::BodyCY),
    ("aeroBodyForceCoefficient_Z", Coefficient::CZ),
    ("aeroBodyMomentCoefficient_Roll", Coefficient::Cl),
    ("aeroBodyMomentCoefficient_Pitch", Coefficient::Cm),
    ("aeroBodyMomentCoefficient_Yaw", Coefficient::Cn),
    ("totalCoefficientOfDrag", Coefficient::CD),
    ("totalCoefficientOfLift", Coefficient::CL),
];
const FORCE_NAMES: [&str; 3] = ["thrustBodyForce_X", "thrustBodyForce_Y", "thrustBodyForce_Z"];
const MOMENT_NAMES: [&str; 3] = ["thrustBodyMoment_Roll", "thrustBodyMoment_Pitch", "thrustBodyMoment_Yaw"];

/// Where an input comes from.
enum From {
    Number(f64),
    /// One slot, or two to add up, into SI.
    Slots(Scaled, Option<Scaled>),
    Output(usize, String),
    Initial,
}

impl Links {
    /// Binds the files. `found` goes before everything else; their outputs stand behind the controls and so many signals.
    ///
    /// # Errors
    /// [`FileError`] names the file and the variable: no value for an input, an unknown name or unit, a cycle of files.
    pub fn bind(sources: &[Source], controls: &[Control], signals: usize, found: &[Found]) -> Result<Self, FileError> {
        let mut origins = Vec::new();
        for (index, source) in sources.iter().enumerate() {
            check_names(source)?;
            let inputs = source.document.variables().iter().filter(|v| v.kind != Kind::Calculated);
            let mut all = Vec::new();
            for variable in inputs {
                all.push((variable, origin(sources, index, variable, controls, found)?));
            }
            origins.push(all);
        }
        let mut asked: Vec<BTreeSet<String>> = sources.iter().map(standard_outputs).collect();
        for from in origins.iter().flatten().map(|(_, from)| from) {
            if let From::Output(of, name) = from {
                asked[*of].insert(name.clone());
            }
        }
        let mut links = Self::default();
        let mut slot_of = BTreeMap::new();
        let mut next = super::quantity::QUANTITIES + controls.len() + signals;
        for (index, names) in asked.iter().enumerate() {
            for name in names {
                slot_of.insert((index, name.clone()), next);
                let variable = sources[index].document.variables().iter().find(|v| v.id == *name);
                links.sink(variable.map_or("", |variable| &variable.name), next);
                next += 1;
            }
        }
        if next > SLOTS {
            let file = sources.first().map(|s| s.file.clone()).unwrap_or_default();
            return Err(FileError::new(file, format_args!("expected at most {SLOTS} quantities, found {next}")));
        }
        for index in run_order(sources, &origins)? {
            let names: Vec<&String> = asked[index].iter().collect();
            if !names.is_empty() {
                let link = links.compile(&sources[index], &origins[index], &names, index, &slot_of)?;
                links.links.push(link);
            }
        }
        Ok(links)
    }

    /// Notes what a standard output is for.
    fn sink(&mut self, name: &str, slot: usize) {
        let same = |known: &&str| known.eq_ignore_ascii_case(name);
        if let Some((_, coefficient)) = COEFFICIENT_NAMES.iter().find(|(known, _)| same(known)) {
            self.coefficients.push((slot, *coefficient as usize));
        }
        for axis in 0..3 {
            if same(&FORCE_NAMES[axis]) {
                self.force[axis] = Some(slot);
            }
            if same(&MOMENT_NAMES[axis]) {
                self.moment[axis] = Some(slot);
            }
        }
    }

    fn compile(
        &mut self,
        source: &Source,
        origins: &[(&Variable, From)],
        outputs: &[&String],
        index: usize,
        slot_of: &BTreeMap<(usize, String), usize>,
    ) -> Result<Link, FileError> {
        let mut set = Vec::new();
        let (mut names, mut inputs) = (Vec::new(), Vec::new());
        for (variable, from) in origins {
            let (first, second) = match from {
                From::Initial => continue,
                From::Number(value) => {
                    set.push((variable.id.as_str(), *value));
                    continue;
                }
                From::Slots(first, second) => (*first, *second),
                From::Output(of, name) => ((slot_of[&(*of, name.clone())], 1.0), None),
            };
            let per_unit = 1.0 / unit(source, variable)?;
            names.push(variable.id.as_str());
            let scaled = |(slot, si): Scaled| (slot, si * per_unit);
            inputs.push((scaled(first), second.map(scaled)));
            self.quantities.extend([Some(first), second].into_iter().flatten().map(|(slot, _)| slot));
        }
        let wanted: Vec<&str> = outputs.iter().map(|name| name.as_str()).collect();
        let program = source.document.program(&set, &names, &wanted).map_err(|e| FileError::new(&source.file, e))?;
        let mut outputs = Vec::new();
        for name in wanted {
            let variable = source.document.variable(name).map_err(|e| FileError::new(&source.file, e))?;
            outputs.push((slot_of[&(index, name.to_owned())], unit(source, variable)?));
        }
        Ok(Link { program, inputs, outputs })
    }

    /// Memory for [`Self::run`].
    pub fn memory(&self) -> LinkMemory {
        let one = |link: &Link| (link.program.memory(), vec![0.0; link.inputs.len()], vec![0.0; link.outputs.len()]);
        LinkMemory(self.links.iter().map(one).collect())
    }

    /// Runs the files on the slots, and adds their coefficients to `coefficients`.
    #[inline]
    pub fn run(&self, slots: &mut [f64; SLOTS], memory: &mut LinkMemory, coefficients: &mut [f64; COEFFICIENTS]) {
        for (link, (memory, inputs, outputs)) in self.links.iter().zip(&mut memory.0) {
            for (input, &((first, factor), second)) in inputs.iter_mut().zip(&link.inputs) {
                *input = slots[first] * factor + second.map_or(0.0, |(slot, factor)| slots[slot] * factor);
            }
            link.program.run(inputs, memory, outputs);
            for (&output, &(slot, factor)) in outputs.iter().zip(&link.outputs) {
                slots[slot] = output * factor;
            }
        }
        for &(slot, place) in &self.coefficients {
            coefficients[place] += slots[slot];
        }
    }

    /// Thrust and its moment about the centre of gravity, after [`Self::run`].
    pub fn thrust(&self, slots: &[f64; SLOTS]) -> (DVec3, DVec3) {
        let of = |axes: &[Option<usize>; 3]| DVec3::from_array(axes.map(|slot| slot.map_or(0.0, |slot| slots[slot])));
        (of(&self.force), of(&self.moment))
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.links.is_empty()
    }
}

/// What files say of mass and reference, SI.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Constants {
    /// Mass, kg.
    pub mass_kg: Option<f64>,
    /// Inertia tensor about the centre of gravity.
    pub inertia_kgm2: Option<DMat3>,
    /// Centre of gravity from the moment reference centre.
    pub cg_m: Option<DVec3>,
    /// Area, span, chord.
    pub area_m2: Option<f64>,
    /// Span, metres.
    pub span_m: Option<f64>,
    /// Chord, metres.
    pub chord_m: Option<f64>,
}

/// Reads mass properties and reference lengths out of the files.
///
/// # Errors
/// [`FileError`] if one depends on an input without a value, or has a unit that is not known.
pub fn constants(sources: &[Source]) -> Result<Constants, FileError> {
    let value = |name: &str| -> Result<Option<f64>, FileError> {
        for source in sources {
            let is = |v: &&Variable| v.is_output && v.name.eq_ignore_ascii_case(name);
            let Some(variable) = source.document.variables().iter().find(is) else { continue };
            let fail = |e: &dyn std::fmt::Display| FileError::new(&source.file, e);
            let set: Vec<(&str, f64)> = source
                .set
                .iter()
                .filter_map(|(name, to)| if let Setting::Number(n) = to { Some((name.as_str(), *n)) } else { None })
                .collect();
            let program = source.document.program(&set, &[], &[&variable.id]).map_err(|e| fail(&e))?;
            let mut out = [0.0];
            program.run(&[], &mut program.memory(), &mut out);
            return Ok(Some(out[0] * unit(source, variable)?));
        }
        Ok(None)
    };
    let three = |names: [&str; 3]| -> Result<Option<DVec3>, FileError> {
        let [x, y, z] = [value(names[0])?, value(names[1])?, value(names[2])?];
        Ok((x.is_some() || y.is_some() || z.is_some())
            .then(|| DVec3::new(x.unwrap_or(0.0), y.unwrap_or(0.0), z.unwrap_or(0.0))))
    };
    let moments = three(["bodyMomentOfInertia_Roll", "bodyMomentOfInertia_Pitch", "bodyMomentOfInertia_Yaw"])?;
    // S-119's products of inertia are the integrals of xy, yz, zx; the tensor holds their negatives.
    let products =
        three(["bodyProductOfInertia_XY", "bodyProductOfInertia_YZ", "bodyProductOfInertia_ZX"])?.unwrap_or_default();
    Ok(Constants {
        mass_kg: value("totalMass")?,
        inertia_kgm2: moments.map(|m| {
            let DVec3 { x: xy, y: yz, z: zx } = -products;
            DMat3::from_cols_array(&[m.x, xy, zx, xy, m.y, yz, zx, yz, m.z])
        }),
        cg_m: three(["bodyPositionOfCmWrtMrc_X", "bodyPositionOfCmWrtMrc_Y", "bodyPositionOfCmWrtMrc_Z"])?,
        area_m2: value("referenceWingArea")?,
        span_m: value("referenceWingSpan")?,
        chord_m: value("referenceWingChord")?,
    })
}

fn standard_outputs(source: &Source) -> BTreeSet<String> {
    let standard = |name: &str| {
        let same = |known: &str| known.eq_ignore_ascii_case(name);
        COEFFICIENT_NAMES.iter().any(|(known, _)| same(known))
            || FORCE_NAMES.iter().chain(&MOMENT_NAMES).any(|known| same(known))
    };
    source.document.variables().iter().filter(|v| v.is_output && standard(&v.name)).map(|v| v.id.clone()).collect()
}

fn check_names(source: &Source) -> Result<(), FileError> {
    for name in source.set.keys() {
        source.document.variable(name).map_err(|e| FileError::new(&source.file, format_args!("set: {e}")))?;
    }
    Ok(())
}

/// SI over the unit of a variable.
fn unit(source: &Source, variable: &Variable) -> Result<f64, FileError> {
    si_factor(&variable.units).ok_or_else(|| {
        let (id, units) = (&variable.id, &variable.units);
        FileError::new(&source.file, format_args!("{id}: expected a unit of AIAA S-119, found \"{units}\""))
    })
}

/// Whether a name that someone wrote means this variable.
fn means(name: &str, variable: &Variable) -> bool {
    name == variable.id || name.eq_ignore_ascii_case(&variable.name)
}

fn origin(
    sources: &[Source],
    index: usize,
    variable: &Variable,
    controls: &[Control],
    found: &[Found],
) -> Result<From, FileError> {
    let source = &sources[index];
    if let Some((_, si)) = found.iter().find(|(name, _)| means(name, variable)) {
        return Ok(From::Number(si / unit(source, variable)?));
    }
    // Controls stand in their own units.
    let control = |stem: &str| {
        controls.iter().enumerate().find_map(|(place, control)| {
            let (bare, si) = without_unit(&control.name)?;
            let slot = super::quantity::QUANTITIES + place;
            (control.name == stem || bare.eq_ignore_ascii_case(stem)).then_some((slot, si))
        })
    };
    match source.set.iter().find(|(name, _)| means(name, variable)) {
        Some((_, Setting::Number(value))) => return Ok(From::Number(*value)),
        Some((key, Setting::Column(name))) => {
            let slot = Quantity::named(name).map(|quantity| (quantity.slot(), 1.0)).or_else(|| control(name));
            return slot.map(|slot| From::Slots(slot, None)).ok_or_else(|| {
                FileError::new(&source.file, format_args!("set.{key}: expected a quantity or a control, found {name}"))
            });
        }
        None => {}
    }
    if variable.kind == Kind::Constant {
        return Ok(From::Initial);
    }
    let quantity = Quantity::in_s119(&variable.name).map(|quantity| (quantity.slot(), 1.0));
    if let Some(slot) = control(&variable.name) {
        return Ok(quantity.map_or(From::Slots(slot, None), |quantity| From::Slots(quantity, Some(slot))));
    }
    for (of, other) in sources.iter().enumerate().filter(|(of, _)| *of != index) {
        let gives = |v: &&Variable| v.is_output && v.name.eq_ignore_ascii_case(&variable.name);
        if let Some(output) = other.document.variables().iter().find(gives) {
            return Ok(From::Output(of, output.id.clone()));
        }
    }
    Ok(quantity.map_or(From::Initial, |slot| From::Slots(slot, None)))
}

/// The files so that each stands behind those whose outputs it reads.
fn run_order(sources: &[Source], origins: &[Vec<(&Variable, From)>]) -> Result<Vec<usize>, FileError> {
    let mut order: Vec<usize> = Vec::new();
    while order.len() < sources.len() {
        let ready = (0..sources.len()).find(|index| {
            let waits = |from: &From| matches!(from, From::Output(of, _) if !order.contains(of));
            !order.contains(index) && !origins[*index].iter().any(|(_, from)| waits(from))
        });
        let Some(ready) = ready else {
            let left: Vec<String> = (0..sources.len())
                .filter(|index| !order.contains(index))
                .flat_map(|index| {
                    origins[index].iter().filter_map(move |(v, from)| match from {
                        From::Output(of, _) => Some(format!(
                            "{} needs {} of {}",
                            sources[index].file.display(),
                            v.name,
                            sources[*of].file.display()
                        )),
                        _ => None,
                    })
                })
                .collect();
            let first = (0..sources.len()).find(|index| !order.contains(index)).unwrap_or(0);
            let why =
                format_args!("expected files that feed each other in one order, found a cycle: {}", left.join("; "))
                    .to_string();
            return Err(FileError::new(&sources[first].file, why));
        };
        order.push(ready);
    }
    Ok(order)
}
