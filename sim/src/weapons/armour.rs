//! Classes of armour, and the states that a target goes through.
//!
//! Five classes stand for what a weapon's file must tell apart; the figures are the weapon's. Invariant others rely on: a
//! target's damage only grows, and its state follows from it alone.

use crate::scene::codec::coded_choice;
use serde::{Deserialize, Serialize};

/// What a target is made of, as weapons see it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Armour {
    /// Sheet metal: lorries, radars, parked aircraft, hangars.
    Soft,
    /// Proof against rifle fire and splinters: carriers of infantry.
    Light,
    /// Tanks.
    Heavy,
    /// Plates of a ship.
    Hull,
    /// Bunkers and shelters.
    Concrete,
}
coded_choice!(Armour { Soft, Light, Heavy, Hull, Concrete });

/// What is left of a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Damage {
    /// All of it works.
    #[default]
    Intact,
    /// It is hurt, and goes on.
    Damaged,
    /// It stands still for good.
    Destroyed,
}
coded_choice!(Damage { Intact, Damaged, Destroyed });

/// Share of the damage that destroys, from which on a target counts as damaged.
pub const DAMAGED_FROM: f64 = 0.5;

/// A figure for each class; a class that a file leaves out has none.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ByArmour {
    /// For [`Armour::Soft`].
    pub soft: Option<f64>,
    /// For [`Armour::Light`].
    pub light: Option<f64>,
    /// For [`Armour::Heavy`].
    pub heavy: Option<f64>,
    /// For [`Armour::Hull`].
    pub hull: Option<f64>,
    /// For [`Armour::Concrete`].
    pub concrete: Option<f64>,
}

impl Armour {
    /// All classes.
    pub const ALL: [Self; 5] = [Self::Soft, Self::Light, Self::Heavy, Self::Hull, Self::Concrete];

    /// As files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Soft => "soft",
            Self::Light => "light",
            Self::Heavy => "heavy",
            Self::Hull => "hull",
            Self::Concrete => "concrete",
        }
    }
}

impl Damage {
    /// The state of so much damage, where 1 destroys.
    pub fn of(amount: f64) -> Self {
        if amount >= 1.0 {
            Self::Destroyed
        } else if amount >= DAMAGED_FROM {
            Self::Damaged
        } else {
            Self::Intact
        }
    }
}

impl ByArmour {
    /// The figure for a class.
    pub fn of(&self, armour: Armour) -> Option<f64> {
        match armour {
            Armour::Soft => self.soft,
            Armour::Light => self.light,
            Armour::Heavy => self.heavy,
            Armour::Hull => self.hull,
            Armour::Concrete => self.concrete,
        }
    }

    /// The largest figure; 0 if there is none.
    pub fn most(&self) -> f64 {
        Armour::ALL.iter().filter_map(|armour| self.of(*armour)).fold(0.0, f64::max)
    }

    /// Checks that each figure is above 0 and no larger than a bound.
    pub(super) fn check(&self, key: &str, most: f64) -> Result<(), String> {
        for armour in Armour::ALL {
            if let Some(found) = self.of(armour).filter(|found| !(*found > 0.0 && *found <= most)) {
                let name = armour.name();
                return Err(format!("{key}.{name}: expected a number above 0 and up to {most}, found {found}"));
            }
        }
        Ok(())
    }
}
