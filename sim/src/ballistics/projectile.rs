//! A projectile: its mass, its drag, its spin and its motor. `P.toml`.
//!
//! Units are SI except `bc_lbpin2`, the ballistic coefficient as cartridges are labelled. Drag decelerates by
//! `drag_m2pkg rho Cd(M) u2`, where u is the speed through the air. How much a curve counts is given in one of four ways:
//!
//! | key | meaning | `drag_m2pkg` |
//! |---|---|---|
//! | `form_factor` i | drag over that of the curve's own shape at the same diameter d | pi d2 i / (8 m) |
//! | `bc_lbpin2` | sectional density over form factor, pounds an inch squared | pi / (8 BC), BC in kg/m2 |
//! | `bc_kgpm2` | the same, m / (i d2), kilograms a metre squared | pi / (8 BC) |
//! | `drag_area_m2` S | the area that the curve's Cd refers to | S / (2 m) |
//!
//! `drag = "none"` is a body without drag and takes none of the four. The mass stays what it is while a motor burns:
//! the file has no key for its loss.
//!
//! Invariant others rely on: numbers are finite, masses and lengths above 0, the times of a burn rise.
//!
//! Source: R. L. McCoy, Modern Exterior Ballistics, 1999, chapter 6 (BC = m / (i d2)).

use super::drag::{DragCurve, NAMES};
use crate::file::{self, FileError};
use crate::table::Interpolation;
use serde::Deserialize;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// One pound an inch squared in kilograms a metre squared.
pub const KGPM2_PER_LBPIN2: f64 = 0.453_592_37 / (0.0254 * 0.0254);

/// Largest `drag_m2pkg`: 10 g behind a square kilometre. Beyond it the stiffness of drag is no number of use.
const MOST_DRAG_M2PKG: f64 = 1e8;

/// A checked projectile.
#[derive(Debug, Clone, PartialEq)]
pub struct Projectile {
    /// The file it comes from.
    pub file: PathBuf,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Diameter, metres; only some ways to give the drag need it.
    pub diameter_m: Option<f64>,
    /// The file of its drag curve, if that is its own.
    pub drag_file: Option<PathBuf>,
    /// Its drag; none in a vacuum of its own.
    pub drag: Option<Drag>,
    /// Its spin.
    pub spin: Option<Spin>,
    /// Thrust along the velocity: seconds and newtons, linear between rows, 0 outside.
    pub burn: Vec<[f64; 2]>,
}

/// A curve and how much it counts.
#[derive(Debug, Clone, PartialEq)]
pub struct Drag {
    /// The coefficient by Mach number.
    pub curve: DragCurve,
    /// Deceleration over density, coefficient and square of speed, m2/kg.
    pub drag_m2pkg: f64,
}

/// What the rifling gives.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spin {
    /// Way of one turn in the barrel, metres.
    pub twist_m: f64,
    /// Whether the turn is clockwise, seen from behind.
    pub right: bool,
    /// Length of the projectile, metres.
    pub length_m: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProjectileFile {
    mass_kg: f64,
    diameter_m: Option<f64>,
    drag: String,
    form_factor: Option<f64>,
    bc_lbpin2: Option<f64>,
    bc_kgpm2: Option<f64>,
    drag_area_m2: Option<f64>,
    #[serde(default)]
    interpolation: InterpolationName,
    spin: Option<Spin>,
    #[serde(default, deserialize_with = "file::rows")]
    burn: Vec<[f64; 2]>,
}

#[derive(Deserialize, Default, Clone, Copy)]
#[serde(rename_all = "snake_case")]
enum InterpolationName {
    #[default]
    Pchip,
    Linear,
}

impl Projectile {
    /// Reads and checks a projectile; a drag file is named relative to it.
    ///
    /// # Errors
    /// [`FileError`] names the key, what was expected and what was found.
    pub fn read(file: &Path) -> Result<Self, FileError> {
        Self::from_text(file, &file::text(file)?)
    }

    /// The same of a text; `file` is what errors call it.
    ///
    /// # Errors
    /// [`FileError`] names the key, what was expected and what was found.
    pub fn from_text(file: &Path, text: &str) -> Result<Self, FileError> {
        let raw: ProjectileFile = file::toml_text(file, text)?;
        let fail = |why: String| FileError::new(file, why);
        raw.check().map_err(fail)?;
        let drag = match raw.curve(file)? {
            None => None,
            Some(curve) => Some(Drag { curve, drag_m2pkg: raw.drag_m2pkg().map_err(fail)? }),
        };
        Ok(Self {
            file: file.to_owned(),
            mass_kg: raw.mass_kg,
            diameter_m: raw.diameter_m,
            drag_file: raw.drag.ends_with(".csv").then(|| raw.beside(file)),
            drag,
            spin: raw.spin,
            burn: raw.burn,
        })
    }
}

/// Checks that a number, if it is there, is above 0 and no larger than a bound.
fn above_0(key: &str, value: Option<f64>, most: f64) -> Result<(), String> {
    match value {
        Some(found) if !(found > 0.0 && found <= most) => {
            Err(format!("{key}: expected a number above 0 and up to {most}, found {found}"))
        }
        _ => Ok(()),
    }
}

impl ProjectileFile {
    fn check(&self) -> Result<(), String> {
        above_0("mass_kg", Some(self.mass_kg), 1e9)?;
        above_0("diameter_m", self.diameter_m, 100.0)?;
        above_0("form_factor", self.form_factor, 1e6)?;
        above_0("bc_lbpin2", self.bc_lbpin2, 1e9)?;
        above_0("bc_kgpm2", self.bc_kgpm2, 1e12)?;
        above_0("drag_area_m2", self.drag_area_m2, 1e6)?;
        if let Some(spin) = &self.spin {
            above_0("spin.twist_m", Some(spin.twist_m), 1e3)?;
            above_0("spin.length_m", Some(spin.length_m), 100.0)?;
            if self.diameter_m.is_none() {
                return Err("diameter_m: expected a number with spin, found none".to_owned());
            }
        }
        if self.burn.len() == 1 {
            return Err("burn: expected two rows or more, thrust is linear between them; found one".to_owned());
        }
        for (i, &[_, newton]) in self.burn.iter().enumerate() {
            if newton.abs() > 1e9 {
                return Err(format!("burn[{i}]: expected a thrust within 1e9 N, found {newton}"));
            }
        }
        let falls = self.burn.windows(2).position(|pair| pair[1][0] <= pair[0][0]);
        if let Some(i) = falls {
            let (before, found) = (self.burn[i][0], self.burn[i + 1][0]);
            return Err(format!("burn[{}]: expected a time above {before}, the one before, found {found}", i + 1));
        }
        Ok(())
    }

    fn curve(&self, file: &Path) -> Result<Option<DragCurve>, FileError> {
        let interpolation = match self.interpolation {
            InterpolationName::Pchip => Interpolation::Pchip,
            InterpolationName::Linear => Interpolation::Linear,
        };
        if self.drag == "none" {
            let given = self.ways();
            return match given.first() {
                None => Ok(None),
                Some((key, _)) => Err(FileError::new(file, format!("{key}: expected none with drag = \"none\""))),
            };
        }
        if let Some(curve) = DragCurve::standard(&self.drag, interpolation) {
            return Ok(Some(curve));
        }
        if !self.drag.ends_with(".csv") {
            let (names, found) = (NAMES.join(", "), &self.drag);
            let why = format!("drag: expected one of {names}, none or a file that ends in .csv, found {found:?}");
            return Err(FileError::new(file, why));
        }
        DragCurve::read(&self.beside(file), interpolation).map(Some)
    }

    /// The file that `drag` names, beside the projectile's.
    fn beside(&self, file: &Path) -> PathBuf {
        file.parent().map_or_else(|| PathBuf::from(&self.drag), |folder| folder.join(&self.drag))
    }

    /// Which of the four ways are used.
    fn ways(&self) -> Vec<(&'static str, f64)> {
        [
            ("form_factor", self.form_factor),
            ("bc_lbpin2", self.bc_lbpin2),
            ("bc_kgpm2", self.bc_kgpm2),
            ("drag_area_m2", self.drag_area_m2),
        ]
        .into_iter()
        .filter_map(|(key, value)| Some((key, value?)))
        .collect()
    }

    fn drag_m2pkg(&self) -> Result<f64, String> {
        let expected = "expected one of form_factor, bc_lbpin2, bc_kgpm2 and drag_area_m2";
        let drag_m2pkg = match self.ways().as_slice() {
            [("form_factor", factor)] => {
                let Some(diameter_m) = self.diameter_m else {
                    return Err("diameter_m: expected a number with form_factor, found none".to_owned());
                };
                PI * diameter_m * diameter_m * factor / (8.0 * self.mass_kg)
            }
            [("bc_lbpin2", bc)] => PI / (8.0 * bc * KGPM2_PER_LBPIN2),
            [("bc_kgpm2", bc)] => PI / (8.0 * bc),
            [(_, area_m2)] => area_m2 / (2.0 * self.mass_kg),
            [] => return Err(format!("{expected}, found none")),
            [first, second, ..] => return Err(format!("{expected}, found both {} and {}", first.0, second.0)),
        };
        if drag_m2pkg > MOST_DRAG_M2PKG {
            let key = self.ways()[0].0;
            return Err(format!(
                "{key}: expected at most {MOST_DRAG_M2PKG:e} m2 of drag a kilogram, found {drag_m2pkg:e}"
            ));
        }
        Ok(drag_m2pkg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Projectile, String> {
        Projectile::from_text(Path::new("p.toml"), text).map_err(|error| error.to_string())
    }

    #[test]
    fn four_ways_say_the_same() {
        let (mass_kg, d, i) = (43.09, 0.155, 0.9);
        let bc = mass_kg / (i * d * d);
        let area = std::f64::consts::FRAC_PI_4 * d * d * i;
        let texts = [
            format!("form_factor = {i}"),
            format!("bc_lbpin2 = {}", bc / KGPM2_PER_LBPIN2),
            format!("bc_kgpm2 = {bc}"),
            format!("drag_area_m2 = {area}"),
        ];
        for text in texts {
            let text = format!("mass_kg = {mass_kg}\ndiameter_m = {d}\ndrag = 'G7'\n{text}");
            let drag = read(&text).unwrap().drag.unwrap();
            // Ten roundings at most.
            assert!((drag.drag_m2pkg / (area / (2.0 * mass_kg)) - 1.0).abs() < 1e-15, "{text}");
        }
        assert!((KGPM2_PER_LBPIN2 - 703.069_58).abs() < 1e-5);
        assert!(read("mass_kg = 1\ndrag = 'none'").unwrap().drag.is_none());
    }

    #[test]
    fn what_is_wrong_is_named_with_its_key() {
        let base = "mass_kg = 1\ndiameter_m = 0.1\ndrag = 'G1'\n";
        for (text, told) in [
            ("diameter_m = 0.1\ndrag = 'G1'\nform_factor = 1", "mass_kg"),
            ("mass_kg = 1\nform_factor = 1", "drag"),
            ("mass_kg = 0\ndrag = 'G1'\nbc_kgpm2 = 1", "mass_kg: expected a number above 0"),
            ("mass_kg = nan\ndrag = 'G1'\nbc_kgpm2 = 1", "mass_kg: expected a finite number"),
            ("mass_kg = 1\ndrag = 'G3'\nbc_kgpm2 = 1", "drag: expected one of G1"),
            ("mass_kg = 1\ndrag = 'no/such.csv'\nbc_kgpm2 = 1", "no/such.csv"),
            ("mass_kg = 1\ndrag = 'G1'\nform_factor = 1", "diameter_m"),
            ("mass_kg = 1\ndrag = 'none'\nform_factor = 1", "form_factor"),
            (base, "expected one of form_factor"),
            (&format!("{base}form_factor = 1\nbc_kgpm2 = 1"), "found both form_factor and bc_kgpm2"),
            (&format!("{base}form_factor = -1"), "form_factor"),
            (&format!("{base}bc_lbpin2 = inf"), "bc_lbpin2"),
            (&format!("{base}bc_kgpm2 = 1e-300"), "bc_kgpm2: expected at most"),
            (&format!("{base}form_factor = 1\nfin = 2"), "fin"),
            (&format!("{base}form_factor = 1\ninterpolation = 'cubic'"), "cubic"),
            (&format!("{base}form_factor = 1\nspin = {{twist_m = 0, right = true, length_m = 1}}"), "spin.twist_m"),
            (&format!("{base}form_factor = 1\nspin = {{twist_m = 1, right = true}}"), "length_m"),
            (&format!("{base}form_factor = 1\nburn = [[0, 5], [0, 6]]"), "burn[1]: expected a time above 0"),
            (&format!("{base}form_factor = 1\nburn = [[0, nan]]"), "burn[0][1]"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(told), "{text}: {error}");
        }
    }
}
