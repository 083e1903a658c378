//! Lengths and heights as people write them in tags: `12`, `12.5 m`, `12,5`, `40 ft`, `40'`, `6'8"`, `0.2 km`.

/// Metres of a written length; `None` if it is none, negative or not finite.
pub fn metres(text: &str) -> Option<f64> {
    let text = text.trim().trim_start_matches('~');
    if let Some((feet, inches)) = text.split_once(['\'', '\u{2032}']) {
        let inches = inches.trim().trim_end_matches(['"', '\u{2033}', '\'']);
        let inches = if inches.is_empty() { 0.0 } else { number(inches)? };
        return Some(0.3048 * (number(feet)? + inches / 12.0));
    }
    let end = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | ','))).unwrap_or(text.len());
    let unit_m = match text[end..].trim() {
        "" | "m" | "metre" | "metres" | "meter" | "meters" => 1.0,
        "km" => 1_000.0,
        "cm" => 0.01,
        "ft" | "feet" => 0.3048,
        "mi" => 1_609.344,
        _ => return None,
    };
    Some(number(&text[..end])? * unit_m)
}

/// A number with a point or a comma, not negative.
pub fn number(text: &str) -> Option<f64> {
    let number: f64 = text.trim().replace(',', ".").parse().ok()?;
    (number.is_finite() && number >= 0.0).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_with_their_units() {
        let cases =
            [("12", 12.0), (" 12.5 m", 12.5), ("12,5", 12.5), ("10 ft", 3.048), ("10'", 3.048), ("0.2km", 200.0)];
        for (text, expected) in cases {
            assert!((metres(text).unwrap() - expected).abs() < 1e-9, "{text}");
        }
        assert!((metres("6'8\"").unwrap() - 2.032).abs() < 1e-9);
        for wrong in ["", "wide", "-3", "3 furlongs", "nan", "inf", "1e999", "'", "3;4"] {
            assert_eq!(metres(wrong), None, "{wrong}");
        }
    }
}
