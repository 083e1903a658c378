//! The white markings of a sealed runway, as rectangles and convex pieces in its own frame.
//!
//! Frame: metres; `along` from a threshold towards the other, `across` to the right of that direction. Figures are those of
//! ICAO Annex 14, Volume I, 5.2.2 to 5.2.7 (designation, centre line, threshold, aiming point, touchdown zone, side stripe);
//! where the annex gives a range the choice is said beside it.

use super::glyphs;
use crate::features::model::Runway;
use glam::DVec2;

/// A mark: its corners (along, across) from the first threshold, metres, and the frame that its edges are smoothed in.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Corners, convex.
    pub corners: [DVec2; 4],
    /// Middle.
    pub centre: DVec2,
    /// Half its width across.
    pub half_m: f64,
    /// Half its length along; 0 where its ends are not smoothed.
    pub half_length_m: f64,
}

/// 5.2.4.6: threshold stripes begin 6 m from the threshold.
const STRIPES_FROM_M: f64 = 6.0;
/// 5.2.4.6: stripes are at least 30 m long, about 1.80 m wide and 1.80 m apart.
const STRIPE_LENGTH_M: f64 = 30.0;
const STRIPE_M: f64 = 1.8;
/// Figure 5-2: the designation stands 12 m beyond the stripes.
const DESIGNATOR_GAP_M: f64 = 12.0;
/// 5.2.3.3: stripe and gap together 50 to 75 m, the stripe at least as long as the gap and 30 m.
const DASH_M: f64 = 30.0;
const DASH_GAP_M: f64 = 20.0;

/// All marks of a runway; none if it is not sealed or too small for any.
pub fn marks(runway: &Runway) -> Vec<Mark> {
    use crate::features::model::RunwaySurface::{Asphalt, Concrete};
    let length_m = runway.ends[0].distance(runway.ends[1]);
    let width_m = f64::from(runway.width_m);
    let mut marks = Vec::new();
    if !matches!(runway.surface, Asphalt | Concrete)
        || !(300.0..=10_000.0).contains(&length_m)
        || !(12.0..=100.0).contains(&width_m)
    {
        return marks;
    }
    side_stripes(length_m, width_m, &mut marks);
    let mut designators_end_m = 0.0;
    for (end, designator) in runway.designators.iter().enumerate() {
        let mut own = Vec::new();
        threshold_stripes(width_m, &mut own);
        designators_end_m = f64::max(designators_end_m, designation(designator, width_m, &mut own));
        aiming_and_touchdown(length_m, width_m, &mut own);
        if end == 1 {
            own.iter_mut().for_each(|mark| *mark = turned(mark, length_m));
        }
        marks.append(&mut own);
    }
    centre_line(length_m, width_m, designators_end_m + DESIGNATOR_GAP_M, &mut marks);
    marks
}

/// As seen from the other threshold.
fn turned(mark: &Mark, length_m: f64) -> Mark {
    let turn = |at: DVec2| DVec2::new(length_m - at.x, -at.y);
    Mark { corners: mark.corners.map(turn), centre: turn(mark.centre), ..mark.clone() }
}

fn rectangle(along_m: f64, length_m: f64, across_m: f64, width_m: f64) -> Mark {
    let (low, high) = (across_m - 0.5 * width_m, across_m + 0.5 * width_m);
    let corner = DVec2::new;
    let end_m = along_m + length_m;
    Mark {
        corners: [corner(along_m, low), corner(end_m, low), corner(end_m, high), corner(along_m, high)],
        centre: corner(along_m + 0.5 * length_m, across_m),
        half_m: 0.5 * width_m,
        half_length_m: 0.5 * length_m,
    }
}

/// 5.2.7.4: 0.9 m wide on runways of 30 m or more, else 0.45 m, at the edge.
fn side_stripes(length_m: f64, width_m: f64, marks: &mut Vec<Mark>) {
    let stripe_m = if width_m >= 30.0 { 0.9 } else { 0.45 };
    for side in [-1.0, 1.0] {
        let mark = rectangle(0.0, length_m, side * 0.5 * (width_m - stripe_m), stripe_m);
        marks.push(Mark { half_length_m: 0.0, ..mark });
    }
}

/// 5.2.4.5: the number of stripes says the width; a double space stands about the centre line.
fn threshold_stripes(width_m: f64, marks: &mut Vec<Mark>) {
    let table = [(60.0, 16), (45.0, 12), (30.0, 8), (23.0, 6)];
    let stripes = table.iter().find(|(from_m, _)| width_m >= *from_m).map_or(4, |(_, stripes)| *stripes);
    for pair in 0..stripes / 2 {
        let across_m = STRIPE_M + 0.5 * STRIPE_M + f64::from(pair) * 2.0 * STRIPE_M;
        // Narrow runways have room for fewer.
        if across_m + 0.5 * STRIPE_M > 0.5 * width_m - 0.5 {
            break;
        }
        for side in [-1.0, 1.0] {
            marks.push(rectangle(STRIPES_FROM_M, STRIPE_LENGTH_M, side * across_m, STRIPE_M));
        }
    }
}

/// The designator, a letter nearest to the threshold; says where it ends.
fn designation(designator: &str, width_m: f64, marks: &mut Vec<Mark>) -> f64 {
    let split = designator.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(designator.len());
    let (digits, letter) = designator.split_at(split);
    let mut along_m = STRIPES_FROM_M + STRIPE_LENGTH_M + DESIGNATOR_GAP_M;
    for row in [letter, digits] {
        let letters = row.chars().take(2).count() as f64;
        let row_m = letters * glyphs::ADVANCE_M - (glyphs::ADVANCE_M - glyphs::WIDTH_M);
        if letters == 0.0 || row_m > width_m - 2.0 {
            continue;
        }
        for (at, letter) in row.chars().take(2).enumerate() {
            let left_m = -0.5 * row_m + at as f64 * glyphs::ADVANCE_M;
            for stroke in glyphs::strokes(letter) {
                let corners = stroke.map(|[right, up]| DVec2::new(along_m + up, left_m + right));
                let centre = corners.iter().sum::<DVec2>() * 0.25;
                marks.push(Mark { corners, centre, half_m: 0.0, half_length_m: 0.0 });
            }
        }
        along_m += glyphs::HEIGHT_M + 3.0;
    }
    along_m
}

/// 5.2.5 and 5.2.6, pattern A; the least lengths and spacings of table 5-1.
fn aiming_and_touchdown(length_m: f64, width_m: f64, marks: &mut Vec<Mark>) {
    // Landing distance: from where on, length, width, between inner sides.
    let (aim_m, aim_length_m, aim_width_m, inner_m) = match length_m {
        ..800.0 => (150.0, 30.0, 4.0, 6.0),
        ..1_200.0 => (250.0, 30.0, 6.0, 9.0),
        ..2_400.0 => (300.0, 45.0, 6.0, 18.0),
        _ => (400.0, 45.0, 8.0, 18.0),
    };
    let fits = |inner_m: f64, mark_m: f64| 0.5 * inner_m + mark_m < 0.5 * width_m - 1.5;
    let inner_m = if fits(inner_m, aim_width_m) { inner_m } else { 6.0 };
    if fits(inner_m, aim_width_m) {
        for side in [-1.0, 1.0] {
            marks.push(rectangle(aim_m, aim_length_m, side * 0.5 * (inner_m + aim_width_m), aim_width_m));
        }
    }
    let pairs = match length_m {
        ..900.0 => 1,
        ..1_200.0 => 2,
        ..1_500.0 => 3,
        ..2_400.0 => 4,
        _ => 6,
    };
    for pair in 1..=pairs {
        let at_m = 150.0 * f64::from(pair);
        // 5.2.6.3: none within 50 m of the aiming point.
        if (at_m - aim_m).abs() < 50.0 || at_m + 22.5 > 0.5 * length_m || !fits(inner_m, 3.0) {
            continue;
        }
        for side in [-1.0, 1.0] {
            marks.push(rectangle(at_m, 22.5, side * 0.5 * (inner_m + 3.0), 3.0));
        }
    }
}

/// 5.2.3: 0.9 m wide on runways of precision approaches of categories II and III, which are not known: 0.45 m, and 0.3 m
/// on narrow ones.
fn centre_line(length_m: f64, width_m: f64, from_m: f64, marks: &mut Vec<Mark>) {
    let line_m = if width_m >= 30.0 { 0.45 } else { 0.3 };
    let mut along_m = from_m;
    while along_m + DASH_M <= length_m - from_m {
        marks.push(rectangle(along_m, DASH_M, 0.0, line_m));
        along_m += DASH_M + DASH_GAP_M;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::model::{Origin, RunwaySurface};

    fn runway(length_m: f64, width_m: f32, surface: RunwaySurface) -> Runway {
        Runway {
            ends: [DVec2::ZERO, DVec2::new(length_m, 0.0)],
            width_m,
            designators: ["06".into(), "24L".into()],
            surface,
            lit: false,
            from: Origin::Stated,
        }
    }

    #[test]
    fn the_number_of_threshold_stripes_says_the_width() {
        for (width_m, stripes) in [(18.0, 4), (23.0, 6), (30.0, 8), (45.0, 12), (60.0, 16)] {
            let marks = marks(&runway(2_000.0, width_m, RunwaySurface::Asphalt));
            let at_first = |mark: &&Mark| mark.corners[0].x == STRIPES_FROM_M;
            assert_eq!(marks.iter().filter(at_first).count(), stripes, "{width_m}");
        }
    }

    #[test]
    fn marks_lie_on_the_runway_and_mirror() {
        for (length_m, width_m) in [(700.0, 18.0), (1_100.0, 30.0), (2_000.0, 30.0), (3_500.0, 60.0)] {
            let marks = marks(&runway(length_m, width_m, RunwaySurface::Concrete));
            let half_m = 0.5 * f64::from(width_m);
            for corner in marks.iter().flat_map(|mark| mark.corners) {
                assert!((0.0..=length_m).contains(&corner.x) && corner.y.abs() <= half_m + 1e-9, "{corner}");
            }
            let middle_m = 0.5 * length_m;
            let stripes = |near: bool| {
                marks.iter().filter(|m| (m.centre.x < middle_m) == near && (m.half_m - 0.9).abs() < 1e-9).count()
            };
            assert_eq!(stripes(true), stripes(false));
        }
        assert!(marks(&runway(2_000.0, 30.0, RunwaySurface::Grass)).is_empty());
        assert!(marks(&runway(f64::NAN, 30.0, RunwaySurface::Asphalt)).is_empty());
    }
}
