//! The stroke font: digits, capitals and the signs of a display, drawn as lines on a small grid.
//!
//! Grid: x 0 to 4, y 0 (base line) to 6 (cap height), corners cut at 45 degrees like those of cockpit displays; a point
//! is two characters `xy`, a half step is written as a letter (`a` = 0.5, `b` = 1.5, .. `f` = 5.5). Strokes are
//! separated by a blank. Descents below the base line use `m` (-1).

use glam::Vec2;

/// Height of capitals in grid units.
pub const CAP: f32 = 6.0;
/// Width of one character with the gap after it.
pub const ADVANCE: f32 = 5.6;
/// The gap after a character.
pub const GAP: f32 = 1.6;

/// The lines of a character, in grid units, y up from the base line.
pub fn strokes(letter: char) -> impl Iterator<Item = impl Iterator<Item = Vec2>> {
    outline(letter).split(' ').filter(|stroke| !stroke.is_empty()).map(|stroke| {
        let points = stroke.as_bytes();
        points.chunks_exact(2).map(|point| Vec2::new(step(point[0]), step(point[1])))
    })
}

fn step(code: u8) -> f32 {
    match code {
        b'0'..=b'9' => f32::from(code - b'0'),
        b'a'..=b'f' => f32::from(code - b'a') + 0.5,
        _ => -1.0,
    }
}

fn outline(letter: char) -> &'static str {
    match letter.to_ascii_uppercase() {
        '0' => "103041453616050110",
        '1' => "152620",
        '2' => "05163645440040",
        '3' => "05163645443313 334241301001",
        '4' => "30360242",
        '5' => "460603334241301001",
        '6' => "4536160501103041423303",
        '7' => "0646452220",
        '8' => "130405163645443313 1302011030414233",
        '9' => "0110304145361605041343",
        'A' => "0004264440 0242",
        'B' => "00063645443303 3342413000",
        'C' => "4536160501103041",
        'D' => "00063645413000",
        'E' => "46060040 0333",
        'F' => "460600 0333",
        'G' => "45361605011030414323",
        'H' => "0006 4046 0343",
        'I' => "2026 1636 1030",
        'J' => "4641301001",
        'K' => "0006 460340",
        'L' => "060040",
        'M' => "0006234640",
        'N' => "00064046",
        'O' => "103041453616050110",
        'P' => "00063645443303",
        'Q' => "103041453616050110 2240",
        'R' => "00063645443303 2340",
        'S' => "453616050413334241301001",
        'T' => "0646 2620",
        'U' => "060110304146",
        'V' => "062046",
        'W' => "0610243046",
        'X' => "0046 0640",
        'Y' => "062346 2320",
        'Z' => "06460040",
        ' ' => "",
        '+' => "2125 0343",
        '.' => "202a",
        ',' => "2a1m",
        ':' => "212b 242e",
        ';' => "242e 2b1m",
        '/' => "0046",
        '\\' => "0640",
        '%' => "0046 0616150506 3141403031",
        '°' => "1626cfce2414aeaf16",
        '(' => "36252130",
        ')' => "16252110",
        '[' => "36262030",
        ']' => "16262010",
        '<' => "351331",
        '>' => "153311",
        '=' => "0242 0444",
        '_' => "0040",
        '*' => "0244 0442 2125",
        '!' => "2622 202a",
        '?' => "05163645442322 202a",
        '\'' => "2624",
        '"' => "1614 3634",
        '#' => "1016 3036 0242 0444",
        '|' => "2026",
        '·' => "232d",
        '±' => "2226 0444 0040",
        '↑' => "2026 042644",
        '↓' => "2620 022042",
        '→' => "0343 254321",
        '←' => "4303 250321",
        '-' | '\u{2013}' | '\u{2212}' => "0343",
        _ => "0004444000",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_glyph_is_well_written_and_inside_its_cell() {
        for code in (0x20_u32..0x7f).chain([0xb0, 0xb1, 0xb7, 0x2190, 0x2191, 0x2192, 0x2193, 0x2212]) {
            let letter = char::from_u32(code).unwrap_or(' ');
            for stroke in outline(letter).split(' ').filter(|stroke| !stroke.is_empty()) {
                assert!(stroke.len() >= 4 && stroke.len() % 2 == 0, "{letter}: {stroke}");
                assert!(stroke.chars().all(|c| "0123456abcdefm".contains(c)), "{letter}: {stroke}");
            }
            for point in strokes(letter).flatten() {
                assert!((0.0..=4.0).contains(&point.x) && (-1.0..=CAP).contains(&point.y), "{letter}: {point}");
            }
        }
    }

    #[test]
    fn every_digit_and_capital_is_its_own() {
        let all: Vec<_> = ('0'..='9').chain('A'..='Z').filter(|&c| c != 'O').map(outline).collect();
        for (i, glyph) in all.iter().enumerate() {
            assert!(!all[..i].contains(glyph), "{glyph}");
        }
    }
}
