//! How deep a projectile goes into the ground before it stops, and how far in a time.
//!
//! Young's equation for soil, in SI: depth `1.8e-5 K S N (m/A)^0.7 (v - 30.5)` from 61 m/s on and
//! `9.3e-4 K S N (m/A)^0.7 ln(1 + 2.15e-4 v^2)` below, metres, with m in kg, A in m2, v in m/s (converted from its form in
//! feet, pounds and inches, 0.00178 and 0.3, whose branches meet). K is `0.27 m^0.4` below 27 kg and 1 above, S says how soft the
//! ground is, N how sharp the nose. It slows down evenly, along the line that it struck on; below [`LEAST_GRAZING_RAD`] to the
//! ground it does not go in.
//!
//! Source: C. W. Young, Penetration Equations, Sandia SAND97-2426, 1997, equations and S-numbers from memory, not checked:
//! rock 1, dense soil 5, loose sand 8, snow 30 (an estimate). A bomb's ogive is taken as N = 0.9. Even slowing and the
//! grazing angle are assumptions.

use terrain::features::cover::CoverClass;

/// Nose performance of an ogive of some two calibres.
const NOSE: f64 = 0.9;
/// Flatter than this, a projectile stays on the ground, radians.
const LEAST_GRAZING_RAD: f64 = 0.35;
/// Deepest that is answered, metres: the equation is for bodies that stay whole.
const DEEPEST_M: f64 = 60.0;

/// How soft ground is: Young's S.
pub fn softness(cover: Option<CoverClass>) -> f64 {
    match cover {
        Some(CoverClass::Rock | CoverClass::Paved) => 1.0,
        Some(CoverClass::Sand) => 8.0,
        Some(CoverClass::Snow) => 30.0,
        _ => 5.0,
    }
}

/// Length of the way into the ground until it stops, metres.
pub fn way_m(mass_kg: f64, diameter_m: f64, speed_mps: f64, softness: f64) -> f64 {
    let area_m2 = 0.25 * std::f64::consts::PI * diameter_m * diameter_m;
    let light = if mass_kg < 27.0 { 0.27 * mass_kg.powf(0.4) } else { 1.0 };
    let body = light * softness * NOSE * (mass_kg / area_m2).powf(0.7);
    let way_m = if speed_mps >= 61.0 {
        1.8e-5 * body * (speed_mps - 30.5)
    } else {
        9.3e-4 * body * (1.0 + 2.15e-4 * speed_mps * speed_mps).ln()
    };
    if way_m.is_finite() { way_m.clamp(0.0, DEEPEST_M) } else { 0.0 }
}

/// How much of its way it has gone after a time.
pub fn gone_m(way_m: f64, speed_mps: f64, after_s: f64) -> f64 {
    let stops_s = if speed_mps > 0.0 { 2.0 * way_m / speed_mps } else { 0.0 };
    if after_s >= stops_s {
        return way_m;
    }
    let share = after_s.max(0.0) / stops_s;
    way_m * (2.0 * share - share * share)
}

/// Whether what strikes at this sine of the angle to the ground goes in.
pub fn goes_in(sine: f64) -> bool {
    sine >= LEAST_GRAZING_RAD.sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bomb_goes_some_metres_into_soil_and_less_into_rock() {
        // 241 kg, 273 mm, 250 m/s, dense soil: 4,117 kg/m2 to the power of 0.7 is 338.8;
        // 1.8e-5 x 5 x 0.9 x 338.8 x 219.5 = 6.02 m, by hand.
        let soil_m = way_m(241.0, 0.273, 250.0, softness(None));
        assert!((soil_m - 6.02).abs() < 0.02, "{soil_m}");
        assert!((way_m(241.0, 0.273, 250.0, softness(Some(CoverClass::Rock))) - soil_m / 5.0).abs() < 1e-9);
        // The two branches meet at 61 m/s, to the digits of their figures.
        let [below, above] = [60.9, 61.1].map(|mps| way_m(241.0, 0.273, mps, 5.0));
        assert!((below / above - 1.0).abs() < 0.02, "{below} {above}");
        for odd in [f64::NAN, f64::INFINITY, -5.0, 1e9] {
            assert!((0.0..=DEEPEST_M).contains(&way_m(241.0, 0.273, odd, 5.0)));
        }
    }

    #[test]
    fn it_slows_down_evenly_and_stops() {
        let (way, speed) = (6.0, 250.0);
        assert_eq!(gone_m(way, speed, 0.0), 0.0);
        assert!((gone_m(way, speed, 1e-4) / (speed * 1e-4) - 1.0).abs() < 2e-3, "at first it keeps its speed");
        assert_eq!(gone_m(way, speed, 1.0), way);
        assert_eq!(gone_m(0.0, 0.0, 0.0), 0.0);
        let mut before = 0.0;
        for step in 1..=100 {
            let now = gone_m(way, speed, 0.048 * f64::from(step) / 100.0);
            assert!(now > before && now <= way);
            before = now;
        }
    }
}
