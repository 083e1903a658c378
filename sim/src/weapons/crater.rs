//! Craters: how large a charge leaves one, and whether the posts of the ground can show it.
//!
//! A charge that bursts on the surface of dry soil leaves an apparent crater of diameter `0.8 W^(1/3)` metres, W in
//! kilograms of TNT, with a coefficient of variation of 30 % over some 200 explosions (G. F. Kinney, K. J. Graham,
//! Explosive Shocks in Air, 1985; figure from memory). A buried one is taken [`BURIED`] times as wide, an assumption
//! within what cratering curves show for shallow depths. Its depth is a quarter of its width (an assumption, too). A
//! burst above the ground leaves one only below half the radius, shrinking evenly with height.
//!
//! A crater changes the posts only where its radius is at least one step of the world; a smaller one is a decal.

/// Diameter of a surface burst's crater over the cube root of the charge, m/kg^(1/3).
const DIAMETER_M: f64 = 0.8;
/// A buried burst's crater over that of a surface burst.
const BURIED: f64 = 2.0;
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

/// The crater of a charge at a height over the ground; `None` if it leaves none.
pub fn crater(tnt_kg: f64, buried: bool, height_m: f64) -> Option<Crater> {
    let contact_m = 0.5 * DIAMETER_M * tnt_kg.cbrt();
    let radius_m =
        if buried { contact_m * BURIED } else { contact_m * (1.0 - 2.0 * height_m.max(0.0) / contact_m).max(0.0) };
    (radius_m >= LEAST_RADIUS_M).then_some(Crater { radius_m, depth_m: 2.0 * radius_m * DEPTH })
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
        let one = crater(1_000.0, false, 0.0).unwrap();
        assert!((one.radius_m - 4.0).abs() < 1e-12 && (one.depth_m - 2.0).abs() < 1e-12);
        assert!((crater(8_000.0, false, 0.0).unwrap().radius_m - 8.0).abs() < 1e-12);
        assert!((crater(1_000.0, true, 0.0).unwrap().radius_m - 8.0).abs() < 1e-12);
        assert!(crater(1_000.0, false, 1.0).unwrap().radius_m < 4.0);
        assert_eq!(crater(1_000.0, false, 2.0), None);
        assert_eq!(crater(0.01, false, 0.0), None, "a 23 mm shell leaves a mark only");
        assert!(changes_posts(25.0, 25.0) && !changes_posts(24.9, 25.0));
    }
}
