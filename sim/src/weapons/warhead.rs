//! What a burst does: one curve of the probability of a kill by distance.
//!
//! `P(kill | d, armour) = exp(-(d / R)^2)`, with R the warhead's lethal radius against that class of armour and d the
//! distance from the burst to the nearest point of the target's shape. A class without a radius is proof against it. The
//! area weighted by P is pi R^2: R is the radius of the lethal area. A target is damaged, short of killed, by the same
//! curve with [`DAMAGE_REACH`] times the radius. One uniform number of the stream (seed, target, projectile) decides both,
//! so damage is never less likely than a kill and nothing depends on the order of bursts or targets.
//!
//! Source: the curve is Carleton's damage function, circular and with P = 1 at 0 (M. R. Driels, Weaponeering, AIAA 2004,
//! chapter on single weapons against point targets; from memory). The radii in `assets/weapons` are estimates, not of
//! any manual. Effects of terrain between burst and target are not counted.

use super::armour::{Armour, ByArmour};
use serde::{Deserialize, Serialize};

/// How much farther a burst damages than it kills: an assumption.
pub const DAMAGE_REACH: f64 = 2.0;
/// A probability below this is none: beyond the distance of it nobody is asked.
pub const LEAST_PROBABILITY: f64 = 1e-3;
/// Heaviest charge, kg.
const MOST_TNT_KG: f64 = 1e9;
/// Largest radius, metres.
const MOST_RADIUS_M: f64 = 10_000.0;

/// A warhead.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Warhead {
    /// Mass of TNT with the same blast, kg.
    pub tnt_kg: f64,
    /// Fragments, for the picture.
    #[serde(default)]
    pub fragments: u32,
    /// R by class of armour, metres.
    pub lethal_radius_m: ByArmour,
    /// Distance at which the one who released it is safe from fragments, metres.
    pub safe_m: f64,
}

impl Warhead {
    pub(super) fn check(&self) -> Result<(), String> {
        let good = |key: &str, found: f64, most: f64| match found {
            found if found > 0.0 && found <= most => Ok(()),
            found => Err(format!("warhead.{key}: expected a number above 0 and up to {most}, found {found}")),
        };
        good("tnt_kg", self.tnt_kg, MOST_TNT_KG)?;
        good("safe_m", self.safe_m, MOST_RADIUS_M)?;
        self.lethal_radius_m.check("warhead.lethal_radius_m", MOST_RADIUS_M)
    }

    /// Probability that a target of this armour is killed by a burst so many metres from it.
    pub fn kills(&self, distance_m: f64, armour: Armour) -> f64 {
        self.lethal_radius_m.of(armour).map_or(0.0, |radius_m| curve(distance_m, radius_m))
    }

    /// Probability that it is killed or damaged.
    pub fn hurts(&self, distance_m: f64, armour: Armour) -> f64 {
        self.lethal_radius_m.of(armour).map_or(0.0, |radius_m| curve(distance_m, DAMAGE_REACH * radius_m))
    }

    /// Distance beyond which nothing is hurt with more than [`LEAST_PROBABILITY`], metres.
    pub fn reach_m(&self) -> f64 {
        DAMAGE_REACH * self.lethal_radius_m.most() * (-LEAST_PROBABILITY.ln()).sqrt()
    }
}

fn curve(distance_m: f64, radius_m: f64) -> f64 {
    let probability = (-(distance_m / radius_m).powi(2)).exp();
    if probability < LEAST_PROBABILITY { 0.0 } else { probability }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> Warhead {
        let lethal_radius_m = ByArmour { soft: Some(30.0), heavy: Some(4.0), ..ByArmour::default() };
        Warhead { tnt_kg: 90.0, fragments: 0, lethal_radius_m, safe_m: 400.0 }
    }

    #[test]
    fn the_curve_only_falls_with_distance_and_damage_reaches_farther() {
        let warhead = some();
        for armour in Armour::ALL {
            let mut last = (f64::INFINITY, f64::INFINITY);
            for step in 0..4_000 {
                let distance_m = f64::from(step) * 0.05;
                let now = (warhead.kills(distance_m, armour), warhead.hurts(distance_m, armour));
                assert!(now.0 <= last.0 && now.1 <= last.1 && now.0 <= now.1 && (0.0..=1.0).contains(&now.1));
                last = now;
            }
            assert_eq!(warhead.hurts(warhead.reach_m() + 1e-6, armour), 0.0);
        }
        assert_eq!(warhead.kills(0.0, Armour::Heavy), 1.0);
        assert_eq!(warhead.kills(0.0, Armour::Concrete), 0.0);
    }

    #[test]
    fn the_weighted_area_is_that_of_the_lethal_radius() {
        // Rings of 0.01 m to five radii; what lies beyond, and the cut at 1e-3, is 1e-3 of the whole.
        let (warhead, ring) = (some(), 0.01);
        let area: f64 = (0..15_000)
            .map(|i| (f64::from(i) + 0.5) * ring)
            .map(|d| warhead.kills(d, Armour::Soft) * std::f64::consts::TAU * d * ring)
            .sum();
        let whole = std::f64::consts::PI * 900.0;
        assert!((area / whole - (1.0 - LEAST_PROBABILITY)).abs() < 1e-5, "{}", area / whole);
    }
}
