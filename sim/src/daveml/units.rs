//! Units as S-119 spells them, to SI.
//!
//! A unit is a run of symbols with whole powers, then `_` before what divides: `slugft2`, `ft_s2`, `lbf_ft2`, `_deg`.
//! Angles count as pure numbers (SI: radian = 1), so `rad_s` and `_s` are alike. Scales with an offset (degrees Celsius
//! and Fahrenheit) have no factor and are unknown, as is any other symbol that is not in the table below.
//!
//! Source: NIST SP 811 (2008), appendix B, exact values; the notation is AIAA S-119-2011's.

use std::f64::consts::PI;

/// Foot, metres (exact).
const FT_M: f64 = 0.3048;
/// Avoirdupois pound, kilograms (exact).
const LBM_KG: f64 = 0.453_592_37;
/// Standard gravity, m/s2 (exact).
const GRAVITY_MPS2: f64 = 9.806_65;
/// Pound-force, newtons: the pound under standard gravity (exact).
const LBF_N: f64 = LBM_KG * GRAVITY_MPS2;
/// Slug, kilograms: the mass that a pound-force accelerates by 1 ft/s2 (exact).
const SLUG_KG: f64 = LBF_N / FT_M;

/// Powers of metre, kilogram, second and kelvin.
type Dimension = [i32; 4];

const NONE: Dimension = [0, 0, 0, 0];
const LENGTH: Dimension = [1, 0, 0, 0];
const MASS: Dimension = [0, 1, 0, 0];
const TIME: Dimension = [0, 0, 1, 0];
const TEMPERATURE: Dimension = [0, 0, 0, 1];
const FORCE: Dimension = [1, 1, -2, 0];
const PRESSURE: Dimension = [-1, 1, -2, 0];

/// Symbol, factor to SI, dimension. `lb` is a force, as the models that use it mean it; a mass is `lbm`.
const SYMBOLS: [(&str, f64, Dimension); 38] = [
    ("nd", 1.0, NONE),
    ("frac", 1.0, NONE),
    ("pct", 0.01, NONE),
    ("rad", 1.0, NONE),
    ("r", 1.0, NONE),
    ("deg", PI / 180.0, NONE),
    ("rev", 2.0 * PI, NONE),
    ("m", 1.0, LENGTH),
    ("mm", 1e-3, LENGTH),
    ("cm", 1e-2, LENGTH),
    ("km", 1e3, LENGTH),
    ("in", FT_M / 12.0, LENGTH),
    ("ft", FT_M, LENGTH),
    ("nmi", 1852.0, LENGTH),
    ("g", 1e-3, MASS),
    ("kg", 1.0, MASS),
    ("lbm", LBM_KG, MASS),
    ("slug", SLUG_KG, MASS),
    ("s", 1.0, TIME),
    ("sec", 1.0, TIME),
    ("ms", 1e-3, TIME),
    ("min", 60.0, TIME),
    ("h", 3600.0, TIME),
    ("hr", 3600.0, TIME),
    ("K", 1.0, TEMPERATURE),
    ("degK", 1.0, TEMPERATURE),
    ("R", 5.0 / 9.0, TEMPERATURE),
    ("degR", 5.0 / 9.0, TEMPERATURE),
    ("N", 1.0, FORCE),
    ("kN", 1e3, FORCE),
    ("lb", LBF_N, FORCE),
    ("lbf", LBF_N, FORCE),
    ("klbf", 1e3 * LBF_N, FORCE),
    ("Pa", 1.0, PRESSURE),
    ("hPa", 1e2, PRESSURE),
    ("kPa", 1e3, PRESSURE),
    ("J", 1.0, [2, 1, -2, 0]),
    ("W", 1.0, [2, 1, -3, 0]),
];

/// Factor from a unit to SI: a value in `units` times it is in metres, kilograms, seconds, kelvins, radians.
///
/// `None` if the unit is not known.
pub fn si_factor(units: &str) -> Option<f64> {
    parse(units).map(|(factor, _)| factor)
}

/// Factor that turns a value in `from` into one in `to`; `None` if one is not known or they measure different things.
///
/// Units that are spelt alike need not be known.
pub fn conversion(from: &str, to: &str) -> Option<f64> {
    if from.trim() == to.trim() {
        return Some(1.0);
    }
    let ((from, from_dimension), (to, to_dimension)) = (parse(from)?, parse(to)?);
    (from_dimension == to_dimension).then_some(from / to)
}

fn parse(units: &str) -> Option<(f64, Dimension)> {
    let mut parts = units.trim().split('_');
    let above = parts.next()?;
    let (mut factor, mut dimension) = (1.0, NONE);
    let mut symbols = 0;
    for (part, divides) in [(above, false)].into_iter().chain(parts.map(|part| (part, true))) {
        if divides && part.is_empty() {
            return None;
        }
        let mut rest = part;
        while !rest.is_empty() {
            // The longest symbol: `nmi` is not `n`, `m`, `i`.
            let (symbol, unit, powers) = SYMBOLS
                .iter()
                .filter(|(symbol, ..)| rest.starts_with(symbol))
                .max_by_key(|(symbol, ..)| symbol.len())?;
            rest = &rest[symbol.len()..];
            let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
            let power = if digits == 0 { 1 } else { rest[..digits].parse().ok().filter(|p| (1..=9).contains(p))? };
            rest = &rest[digits..];
            let power: i32 = if divides { -power } else { power };
            factor *= unit.powi(power);
            for (sum, of) in dimension.iter_mut().zip(powers) {
                *sum += of * power;
            }
            symbols += 1;
            if symbols > 8 {
                return None;
            }
        }
    }
    (symbols > 0).then_some((factor, dimension))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_of_sp_811() {
        // NIST SP 811 appendix B.8, as printed there (7 digits, or exact).
        for (units, factor) in [
            ("nd", 1.0),
            ("frac", 1.0),
            ("pct", 0.01),
            ("deg", 1.745_329e-2),
            ("deg_s", 1.745_329e-2),
            ("rad_s", 1.0),
            ("s", 1.0),
            ("ft", 0.3048),
            ("m", 1.0),
            ("ft2", 9.290_304e-2),
            ("m2", 1.0),
            ("ft_s", 0.3048),
            ("ft_s2", 0.3048),
            ("nmi_h", 0.514_444_4),
            ("slug", 14.593_90),
            ("kg", 1.0),
            ("lbm", 0.453_592_37),
            ("slugft2", 1.355_818),
            ("kgm2", 1.0),
            ("lbf", 4.448_222),
            ("lb", 4.448_222),
            ("N", 1.0),
            ("ftlbf", 1.355_818),
            ("Nm", 1.0),
            ("slug_ft3", 515.378_8),
            ("lbf_ft2", 47.880_26),
            ("R", 0.555_555_6),
            ("K", 1.0),
            ("_deg", 57.295_78),
            ("s_r", 1.0),
            ("h_nmi", 1.943_844),
        ] {
            let ours = si_factor(units).unwrap_or_else(|| panic!("{units}"));
            assert!((ours / factor - 1.0).abs() < 5e-7, "{units}: {ours} {factor}");
        }
    }

    #[test]
    fn what_is_no_unit_is_unknown() {
        for units in ["", "_", "ft_", "ft__s", "furlong", "degC", "m99999999999", "m0", "é_s", "nim_h", "ft d"] {
            assert_eq!(si_factor(units), None, "{units}");
        }
        assert_eq!(si_factor(&"m".repeat(1_000_000)), None);
    }

    #[test]
    fn only_what_measures_the_same_converts() {
        assert_eq!(conversion("ft", "m"), Some(0.3048));
        assert_eq!(conversion("nim_h", "nim_h"), Some(1.0));
        assert_eq!(conversion("ft", "ft2"), None);
        assert_eq!(conversion("nim_h", "m_s"), None);
        assert!(conversion("ftlbf", "Nm").is_some_and(|factor| (factor - 1.355_817_948).abs() < 1e-9));
    }
}
