//! A weapon: a gun's round, a rocket or a bomb, and how it leaves. `W.toml`.
//!
//! Its `[projectile]` is that of P.toml ([`crate::ballistics::projectile`]). A spread is given as a diameter in mil
//! (1/1000 rad) and the share of rounds that fall within it; rounds are spread as two equal normal numbers across the
//! bore, so that diameter D and share p make `sigma = D / 2 / sqrt(-2 ln(1 - p))`.
//!
//! Invariant others rely on: numbers are finite and within bounds that a scene takes.

use super::armour::ByArmour;
use super::fuze::{Fuze, FuzeFile};
use super::warhead::Warhead;
use crate::ballistics::projectile::Projectile;
use crate::file::{self, FileError};
use crate::scene::{MOST_PER_MINUTE, MOST_SPEED_MPS, Muzzle};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WeaponKind {
    /// Rounds of a gun.
    Gun,
    /// Unguided, with a motor.
    Rocket,
    /// Falls.
    Bomb,
}

/// A checked weapon.
#[derive(Debug, Clone, PartialEq)]
pub struct Weapon {
    /// The file it comes from.
    pub file: PathBuf,
    /// What people call it.
    pub label: String,
    /// What it is.
    pub kind: WeaponKind,
    /// How it flies.
    pub projectile: Projectile,
    /// Mass of one as carried (a round with its case), kg.
    pub carried_kg: f64,
    /// Drag area of one as carried, m2.
    pub carried_drag_area_m2: f64,
    /// Speed with which it leaves: along the bore; a bomb is pushed down, m/s.
    pub speed_mps: f64,
    /// Standard deviation of that speed, m/s.
    pub speed_sigma_mps: f64,
    /// Standard deviation of the direction about each of two axes, radians.
    pub sigma_rad: f64,
    /// Its own rate, rounds a minute.
    pub per_minute: f64,
    /// Every so many rounds one is a tracer; 0 is none.
    pub tracer_every: u32,
    /// As it is set where nobody sets it.
    pub fuze: Fuze,
    /// What bursts; nothing in a solid shot.
    pub warhead: Option<Warhead>,
    /// Direct hits that destroy, by class; a class without is proof against them.
    pub hits_to_kill: ByArmour,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WeaponFile {
    label: String,
    kind: WeaponKind,
    projectile: toml::Table,
    #[serde(default)]
    carried: CarriedFile,
    launch: LaunchFile,
    fuze: Option<FuzeFile>,
    warhead: Option<Warhead>,
    #[serde(default)]
    hits_to_kill: ByArmour,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct CarriedFile {
    mass_kg: Option<f64>,
    #[serde(default)]
    drag_area_m2: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LaunchFile {
    speed_mps: f64,
    #[serde(default)]
    speed_sigma_mps: f64,
    spread: Option<Spread>,
    per_minute: f64,
    #[serde(default)]
    tracer_every: u32,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(deny_unknown_fields)]
struct Spread {
    diameter_mil: f64,
    percent: f64,
}

impl Weapon {
    /// Reads and checks a weapon.
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
        let raw: WeaponFile = file::toml_text(file, text)?;
        let fail = |why: String| FileError::new(file, why);
        raw.check().map_err(fail)?;
        let projectile = Projectile::from_text(file, &raw.projectile.to_string())
            .map_err(|error| fail(format!("projectile.{}", error.why)))?;
        if (raw.kind == WeaponKind::Rocket) == projectile.burn.is_empty() {
            let expected = if raw.kind == WeaponKind::Rocket { "rows of a rocket's" } else { "none but of a rocket" };
            let found = projectile.burn.len();
            return Err(fail(format!("projectile.burn: expected {expected}, found {found} rows")));
        }
        Ok(Self {
            file: file.to_owned(),
            carried_kg: raw.carried.mass_kg.unwrap_or(projectile.mass_kg),
            carried_drag_area_m2: raw.carried.drag_area_m2,
            label: raw.label,
            kind: raw.kind,
            projectile,
            speed_mps: raw.launch.speed_mps,
            speed_sigma_mps: raw.launch.speed_sigma_mps,
            sigma_rad: raw.launch.spread.map_or(0.0, |spread| spread.sigma_rad()),
            per_minute: raw.launch.per_minute,
            tracer_every: raw.launch.tracer_every,
            fuze: raw.fuze.map_or(Ok(Fuze::default()), |fuze| fuze.fuze()).map_err(fail)?,
            warhead: raw.warhead,
            hits_to_kill: raw.hits_to_kill,
        })
    }

    /// Where and how one leaves a place of its owner, body axes.
    pub fn muzzle(&self, at_m: DVec3) -> Muzzle {
        let direction = if self.kind == WeaponKind::Bomb { DVec3::Z } else { DVec3::X };
        let Self { speed_mps, sigma_rad, speed_sigma_mps, .. } = *self;
        Muzzle { offset_m: at_m, direction, speed_mps, sigma_rad, speed_sigma_mps }
    }

    /// Whether a round of this number shows a light on its way.
    pub fn is_tracer(&self, round: u64) -> bool {
        self.tracer_every > 0 && round.is_multiple_of(u64::from(self.tracer_every))
    }

    /// Whether its motor burns so long after release.
    pub fn burns_at(&self, age_s: f64) -> bool {
        self.projectile.burn.last().is_some_and(|last| age_s < last[0])
    }
}

impl Spread {
    fn sigma_rad(self) -> f64 {
        0.5e-3 * self.diameter_mil / (-2.0 * (1.0 - 0.01 * self.percent).ln()).sqrt()
    }
}

impl WeaponFile {
    fn check(&self) -> Result<(), String> {
        let within = |key: &str, found: f64, least: f64, most: f64| match found {
            found if (least..=most).contains(&found) => Ok(()),
            found => Err(format!("{key}: expected {least}..={most}, found {found}")),
        };
        if self.label.is_empty() || self.label.len() > 100 {
            let found = self.label.len();
            return Err(format!("label: expected 1 to 100 bytes, found {found}"));
        }
        within("launch.speed_mps", self.launch.speed_mps, 0.0, MOST_SPEED_MPS)?;
        within("launch.speed_sigma_mps", self.launch.speed_sigma_mps, 0.0, MOST_SPEED_MPS)?;
        within("launch.per_minute", self.launch.per_minute, 1.0, MOST_PER_MINUTE)?;
        if let Some(spread) = self.launch.spread {
            within("launch.spread.diameter_mil", spread.diameter_mil, 0.0, 1_000.0)?;
            within("launch.spread.percent", spread.percent, 1.0, 99.9)?;
        }
        within("carried.drag_area_m2", self.carried.drag_area_m2, 0.0, 1e3)?;
        if let Some(mass_kg) = self.carried.mass_kg {
            within("carried.mass_kg", mass_kg, 1e-6, 1e6)?;
        }
        if self.fuze.is_some() && self.warhead.is_none() {
            return Err("fuze: expected a warhead with it, found none".to_owned());
        }
        self.warhead.as_ref().map_or(Ok(()), Warhead::check)?;
        self.hits_to_kill.check("hits_to_kill", 1e9)
    }
}

#[cfg(test)]
mod tests {
    use super::super::fuze::Trigger;
    use super::*;

    const GUN: &str = "label = 'a gun'\nkind = 'gun'\nhits_to_kill = { soft = 3 }\n\
        projectile = { mass_kg = 0.2, diameter_m = 0.023, drag = 'G1', form_factor = 1.0 }\n\
        launch = { speed_mps = 700.0, per_minute = 3000, spread = { diameter_mil = 8, percent = 80 } }\n";

    fn read(text: &str) -> Result<Weapon, String> {
        Weapon::from_text(Path::new("w.toml"), text).map_err(|error| error.to_string())
    }

    #[test]
    fn a_spread_is_a_share_within_a_diameter() {
        let gun = read(GUN).unwrap();
        let within = 1.0 - (-0.5 * (0.004 / gun.sigma_rad).powi(2)).exp();
        // Ten roundings.
        assert!((within - 0.8).abs() < 1e-14, "{within}");
        assert_eq!(gun.muzzle(DVec3::Y).direction, DVec3::X);
        assert_eq!((gun.carried_kg, gun.fuze), (0.2, Fuze::default()));
        assert!(!gun.is_tracer(0) && Weapon { tracer_every: 5, ..gun }.is_tracer(10));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_key() {
        let with = |line: &str| format!("{GUN}{line}\n");
        let warhead = "warhead = { tnt_kg = 1, safe_m = 50, lethal_radius_m = { soft = 2 } }";
        for (text, told) in [
            (GUN.replace("'gun'", "'missile'"), "missile"),
            (GUN.replace("mass_kg = 0.2", "mass_kg = 0"), "projectile.mass_kg: expected a number above 0"),
            (GUN.replace("'G1'", "'G9'"), "projectile.drag: expected one of G1"),
            (GUN.replace("'gun'", "'rocket'"), "projectile.burn: expected rows of a rocket's, found 0"),
            (GUN.replace("3000", "0"), "launch.per_minute: expected 1..=100000, found 0"),
            (GUN.replace("percent = 80", "percent = 100"), "launch.spread.percent: expected 1..=99.9, found 100"),
            (GUN.replace("soft = 3", "soft = -3"), "hits_to_kill.soft: expected a number above 0"),
            (GUN.replace("soft = 3", "wood = 3"), "wood"),
            (with("fuze = { trigger = 'impact' }"), "fuze: expected a warhead with it"),
            (with(&format!("{warhead}\nfuze = {{ trigger = 'delay' }}")), "fuze: expected delay_s alone"),
            (with(&format!("{warhead}\nfuze = {{ trigger = 'impact', delay_s = 1 }}")), "fuze: expected neither"),
            (with(&format!("{warhead}\nfuze = {{ trigger = 'height', height_m = -1 }}")), "fuze.height_m: expected 0"),
            (with(&warhead.replace("tnt_kg = 1", "tnt_kg = 0")), "warhead.tnt_kg: expected a number above 0"),
            (with("speed = 3"), "speed"),
        ] {
            let error = read(&text).unwrap_err();
            assert!(error.starts_with("w.toml") && error.contains(told), "{text}: {error}");
        }
        let delayed = read(&with(&format!("{warhead}\nfuze = {{ trigger = 'delay', delay_s = 0.1, arming_s = 2 }}")));
        assert_eq!(delayed.unwrap().fuze, Fuze { trigger: Trigger::Delay(0.1), arming_s: 2.0 });
    }
}
