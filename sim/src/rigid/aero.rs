//! Coefficients into forces and moments.
//!
//! A coefficient is a sum of terms; a term is a number or a table, times quantities of the flight and controls. CD, CY,
//! CL act along the axes of the wind (turned by the angles of attack and sideslip), of stability (by the angle of attack
//! alone) or of the body; CX and CZ always along the body's; Cl, Cm, Cn always about the body's.
//!
//! Force = dynamic pressure x area x coefficient; moments also x span (Cl, Cn) or chord (Cm). Without speed there is no
//! dynamic pressure, so no coefficient can do harm; in the rates' hats the speed is at least the model's least one.
//!
//! Source: B. L. Stevens, F. L. Lewis, Aircraft Control and Simulation, 2003, section 2.3 (axes and signs).

use super::quantity::SLOTS;
use crate::table::Table;
use glam::DVec3;

/// Most tables of a model.
pub const MOST_TABLES: usize = 64;

/// A coefficient; its number is its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
#[allow(missing_docs)]
pub enum Coefficient {
    CD,
    CY,
    CL,
    CX,
    CZ,
    Cl,
    Cm,
    Cn,
    /// CY along the body's axis whatever the axes are; only DAVE-ML files give it.
    BodyCY,
}

/// Number of coefficients.
pub const COEFFICIENTS: usize = 9;

impl Coefficient {
    /// The names that terms have for them, in order.
    pub const NAMES: [&'static str; COEFFICIENTS - 1] = ["CD", "CY", "CL", "CX", "CZ", "Cl", "Cm", "Cn"];

    /// The place of a name.
    pub fn place(name: &str) -> Option<usize> {
        Self::NAMES.iter().position(|known| *known == name)
    }
}

/// The axes of CD, CY and CL.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axes {
    /// Along the motion through the air.
    #[default]
    Wind,
    /// Turned by the angle of attack alone.
    Stability,
    /// CY along the body's; drag and lift, which only DAVE-ML files then give, along the wind's.
    Body,
}

/// A number or a table, times quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct Factors {
    /// The number.
    pub value: f64,
    /// The table, by its place in [`Tables`].
    pub table: Option<usize>,
    /// Another one.
    pub and_table: Option<usize>,
    /// Slots of the quantities.
    pub times: Vec<usize>,
}

/// A part of a coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// The coefficient's place.
    pub to: usize,
    /// What is added to it.
    pub of: Factors,
}

/// A force that acts at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Thrust {
    /// Its direction and strength before the factors, newtons, body axes.
    pub force_n: DVec3,
    /// Where it acts, metres from the reference point.
    pub at_m: DVec3,
    /// What it is multiplied with.
    pub of: Factors,
}

/// A table and the slots of its arguments.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundTable {
    /// Its name in `M.toml`.
    pub name: String,
    /// The table.
    pub table: Table,
    /// Slots of its arguments.
    pub slots: Vec<usize>,
    /// Their names.
    pub arguments: Vec<String>,
    /// Whether an argument outside is an error.
    pub refuse_outside: bool,
    /// Whether an argument is a signal, so that it waits for them.
    pub is_late: bool,
}

/// The tables of a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tables(pub Vec<BoundTable>);

/// The value of each table.
pub type TableValues = [f64; MOST_TABLES];

impl Tables {
    /// The value of each at the flight's quantities; of those that wait for signals only if `late`, of the others if not.
    #[inline]
    pub fn values(&self, slots: &[f64; SLOTS], late: bool) -> TableValues {
        let mut values = [0.0; MOST_TABLES];
        self.fill(slots, late, &mut values);
        values
    }

    /// The same into values, the others left as they are.
    #[inline]
    pub fn fill(&self, slots: &[f64; SLOTS], late: bool, values: &mut TableValues) {
        for (value, bound) in values.iter_mut().zip(&self.0).filter(|(_, bound)| bound.is_late == late) {
            *value = match bound.slots.as_slice() {
                [x] => bound.table.at(&[slots[*x]]),
                [x, y] => bound.table.at(&[slots[*x], slots[*y]]),
                many => {
                    let mut point = [0.0; crate::table::MAX_AXES];
                    for (argument, &slot) in point.iter_mut().zip(many) {
                        *argument = slots[slot];
                    }
                    bound.table.at(&point[..many.len()])
                }
            };
        }
    }

    /// The first argument outside a table that refuses it, as a sentence.
    pub fn refused(&self, slots: &[f64; SLOTS]) -> Option<String> {
        self.0.iter().filter(|bound| bound.refuse_outside).find_map(|bound| {
            let point: Vec<f64> = bound.slots.iter().map(|&slot| slots[slot]).collect();
            let outside = bound.table.outside(&point)?;
            let (name, argument) = (&bound.name, &bound.arguments[outside.axis]);
            Some(format!(
                "table.{name}: expected {argument} within {} and {}, found {}",
                outside.low, outside.high, outside.value
            ))
        })
    }
}

impl Factors {
    /// Their product.
    #[inline]
    pub fn product(&self, slots: &[f64; SLOTS], tables: &TableValues) -> f64 {
        let mut start = self.value * self.table.map_or(1.0, |table| tables[table]);
        if let Some(table) = self.and_table {
            start *= tables[table];
        }
        self.times.iter().fold(start, |product, &slot| product * slots[slot])
    }
}

/// Where the air comes from, as cosines and sines of the angles of attack and sideslip.
#[derive(Debug, Clone, Copy)]
pub struct Flow {
    cos_alpha: f64,
    sin_alpha: f64,
    cos_beta: f64,
    sin_beta: f64,
}

impl Flow {
    /// Of the body's velocity through the air, forward, right, down; straight from ahead where there is none.
    #[inline]
    pub fn of(through_air: DVec3) -> Self {
        let plan = (through_air.x * through_air.x + through_air.z * through_air.z).sqrt();
        let speed = through_air.length();
        let (cos_alpha, sin_alpha) = if plan > 0.0 { (through_air.x / plan, through_air.z / plan) } else { (1.0, 0.0) };
        let (cos_beta, sin_beta) = if speed > 0.0 { (plan / speed, through_air.y / speed) } else { (1.0, 0.0) };
        Self { cos_alpha, sin_alpha, cos_beta, sin_beta }
    }

    /// Drag, side force and lift along the wind's axes, in the body's.
    #[inline]
    fn in_wind(&self, drag: f64, side: f64, lift: f64) -> DVec3 {
        let Self { cos_alpha: ca, sin_alpha: sa, cos_beta: cb, sin_beta: sb } = *self;
        // Drag and side force in the body's plane of symmetry, before the angle of attack turns them.
        let (ahead, across) = (-drag * cb - side * sb, side * cb - drag * sb);
        DVec3::new(ahead * ca + lift * sa, across, ahead * sa - lift * ca)
    }

    /// The force in body axes, over dynamic pressure and area.
    #[inline]
    pub fn force(&self, axes: Axes, c: &[f64; COEFFICIENTS]) -> DVec3 {
        let [drag, side, lift, x, z, _, _, _, y] = *c;
        let (ca, sa) = (self.cos_alpha, self.sin_alpha);
        let along = match axes {
            Axes::Body => self.in_wind(drag, 0.0, lift) + DVec3::new(0.0, side, 0.0),
            Axes::Stability => DVec3::new(lift * sa - drag * ca, side, -drag * sa - lift * ca),
            Axes::Wind => self.in_wind(drag, side, lift),
        };
        along + DVec3::new(x, y, z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn only(place: Coefficient) -> [f64; COEFFICIENTS] {
        let mut all = [0.0; COEFFICIENTS];
        all[place as usize] = 1.0;
        all
    }

    #[test]
    fn drag_is_against_the_air_and_lift_across_it() {
        for through_air in [DVec3::new(50.0, 7.0, 9.0), DVec3::new(-50.0, 7.0, -9.0), DVec3::new(0.0, 0.0, 3.0)] {
            let flow = Flow::of(through_air);
            let drag = flow.force(Axes::Wind, &only(Coefficient::CD));
            let lift = flow.force(Axes::Wind, &only(Coefficient::CL));
            let side = flow.force(Axes::Wind, &only(Coefficient::CY));
            assert!((drag + through_air.normalize()).length() < 1e-15, "{drag}");
            assert!(drag.dot(lift).abs() < 1e-15 && drag.dot(side).abs() < 1e-15 && lift.dot(side).abs() < 1e-15);
            assert!(lift.y == 0.0 && (lift.length() - 1.0).abs() < 1e-15 && (side.length() - 1.0).abs() < 1e-15);
        }
        let level = Flow::of(DVec3::X);
        assert_eq!(level.force(Axes::Wind, &only(Coefficient::CL)), DVec3::NEG_Z);
        assert_eq!(level.force(Axes::Wind, &only(Coefficient::CY)), DVec3::Y);
    }

    #[test]
    fn stability_axes_are_wind_axes_without_sideslip() {
        let flow = Flow::of(DVec3::new(40.0, 0.0, 8.0));
        for place in [Coefficient::CD, Coefficient::CY, Coefficient::CL, Coefficient::CX, Coefficient::CZ] {
            let gap = flow.force(Axes::Wind, &only(place)) - flow.force(Axes::Stability, &only(place));
            assert!(gap.length() < 1e-15);
        }
        let slipping = Flow::of(DVec3::new(40.0, 10.0, 0.0));
        assert_eq!(slipping.force(Axes::Stability, &only(Coefficient::CY)), DVec3::Y);
        assert_eq!(slipping.force(Axes::Body, &only(Coefficient::CX)), DVec3::X);
    }

    #[test]
    fn still_air_has_no_direction_and_no_nan() {
        assert!(Flow::of(DVec3::ZERO).force(Axes::Wind, &[1.0; COEFFICIENTS]).is_finite());
    }
}
