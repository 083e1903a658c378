//! Craters: how large a charge leaves one, and whether the posts of the ground can show it.
//!
//! A charge that bursts on the surface of dry soil leaves an apparent crater of diameter `0.8 W^(1/3)` metres, W in
//! kilograms of TNT, with a coefficient of variation of 30 % over some 200 explosions (G. F. Kinney, K. J. Graham,
//! Explosive Shocks in Air, 1985; figure from memory). A buried one is wider, up to [`BURIED`] times at [`BEST_M`] times the
//! cube root of the charge, and narrower deeper down: at [`CLOSED_M`] the ground stays closed over it. Cratering curves have this
//! shape; the three figures are assumptions near theirs (from memory). Its depth is a quarter of its width (an assumption,
//! too). A burst above the ground leaves one only below half the radius, shrinking evenly with height.
//!
//! A crater changes the posts only where its radius is at least one step of the world; a smaller one is a decal.

use std::f64::consts::FRAC_PI_2;

/// Diameter of a surface burst's crater over the cube root of the charge, m/kg^(1/3).
const DIAMETER_M: f64 = 0.8;
/// A buried burst's crater over that of a surface burst.
const BURIED: f64 = 2.0;
/// Depth of the burst over the cube root of the charge that leaves the widest crater, and that leaves none, m/kg^(1/3).
const BEST_M: f64 = 0.5;
const CLOSED_M: f64 = 1.5;
/// Depth over diameter.
const DEPTH: f64 = 0.25;
/// Smallest radius that is worth a mark, metres: below it the mark of the impact is all there is.
pub const LEAST_RADIUS_M: f64 = 0.25;

/// A crater's sizes, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crater {
    /// Of its rim, in plan.
    pub radius_m: f64,
    /// Below the ground before.
    pub depth_m: f64,
}

/// The crater of a charge at a height over the ground, below it negative; `None` if it leaves none.
pub fn crater(tnt_kg: f64, height_m: f64) -> Option<Crater> {
    let contact_m = 0.5 * DIAMETER_M * tnt_kg.cbrt();
    let deep = (-height_m).max(0.0) / tnt_kg.cbrt();
    let wider = if deep <= BEST_M {
        1.0 + (BURIED - 1.0) * (FRAC_PI_2 * deep / BEST_M).sin()
    } else {
        BURIED * (FRAC_PI_2 * ((deep - BEST_M) / (CLOSED_M - BEST_M)).min(1.0)).cos()
    };
    let radius_m = contact_m * wider * (1.0 - 2.0 * height_m.max(0.0) / contact_m).max(0.0);
    (radius_m >= LEAST_RADIUS_M).then_some(Crater { radius_m, depth_m: 2.0 * radius_m * DEPTH })
}

/// Share of its lethal radii that a charge has at a height over the ground: what lies deep is smothered, wholly where it
/// leaves no crater. An assumption.
pub fn vented(tnt_kg: f64, height_m: f64) -> f64 {
    (1.0 - (-height_m).max(0.0) / (CLOSED_M * tnt_kg.cbrt())).max(0.0)
}

/// Whether posts this far apart can show it.
pub fn changes_posts(radius_m: f64, step_m: f64) -> bool {
    radius_m >= step_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn craters_grow_with_the_cube_root_and_shrink_with_height() {
        let one = crater(1_000.0, 0.0).unwrap();
        assert!((one.radius_m - 4.0).abs() < 1e-12 && (one.depth_m - 2.0).abs() < 1e-12);
        assert!((crater(8_000.0, 0.0).unwrap().radius_m - 8.0).abs() < 1e-12);
        assert!((crater(1_000.0, -5.0).unwrap().radius_m - 8.0).abs() < 1e-12, "widest");
        let [shallow, deep] = [-1.0, -12.0].map(|height_m| crater(1_000.0, height_m).unwrap().radius_m);
        assert!(shallow > 4.0 && shallow < 8.0 && deep < 8.0, "{shallow} {deep}");
        assert_eq!(crater(1_000.0, -15.0), None, "the ground stays closed");
        assert_eq!([0.0, 3.0, -7.5, -20.0].map(|height_m| vented(1_000.0, height_m)), [1.0, 1.0, 0.5, 0.0]);
        assert!(crater(1_000.0, 1.0).unwrap().radius_m < 4.0);
        assert_eq!(crater(1_000.0, 2.0), None);
        assert_eq!(crater(0.01, 0.0), None, "a 23 mm shell leaves a mark only");
        assert!(changes_posts(25.0, 25.0) && !changes_posts(24.9, 25.0));
    }
}
