//! Running water turned the way the ground falls.
//!
//! OpenStreetMap draws running water downstream, but not everybody does. Along each line the ground is asked at equal
//! distances and a straight line is fitted to its heights; if that rises from end to end by more than
//! [`NOISE_M`], the line is turned. Below that the file is believed: the relative error of SRTM is 5 to 10 m (90 %, E.
//! Rodriguez et al., A global assessment of the SRTM performance, 2006, table 1), and posts cut the valleys' floors.

use super::kind::{Counts, Kind};
use crate::features::model::Waterway;
use crate::ground::Area;
use glam::DVec2;

/// Rise that the posts may invent, metres.
const NOISE_M: f64 = 10.0;

/// Places along a line where the ground is asked.
const SAMPLES: usize = 24;

/// Turns what runs uphill and notes how many did.
pub fn turn_downstream(waterways: &mut [Waterway], ground: &Area, counts: &mut Counts) {
    for water in waterways {
        if rise_m(&water.line, |at| ground.height_m(at.x, at.y)) > NOISE_M {
            water.line.reverse();
            counts.note(Kind::Waterways, "turned downstream");
        }
    }
}

/// Rise of the fitted line from a line's first point to its last; 0 where the ground is not known at three places.
fn rise_m(line: &[DVec2], height_m: impl Fn(DVec2) -> Option<f64>) -> f64 {
    let length_m: f64 = line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    let mut known: Vec<(f64, f64)> = Vec::with_capacity(SAMPLES);
    let (mut segment, mut passed_m) = (0, 0.0);
    for number in 0..SAMPLES {
        let share = number as f64 / (SAMPLES - 1) as f64;
        while segment + 2 < line.len() && passed_m + line[segment].distance(line[segment + 1]) < share * length_m {
            passed_m += line[segment].distance(line[segment + 1]);
            segment += 1;
        }
        let (a, b) = (line[segment], line[segment + 1]);
        let along = ((share * length_m - passed_m) / a.distance(b)).clamp(0.0, 1.0);
        if let Some(height_m) = height_m(a.lerp(b, along)) {
            known.push((share, height_m));
        }
    }
    if known.len() < 3 {
        return 0.0;
    }
    let number = known.len() as f64;
    let (mean_s, mean_h) = known.iter().fold((0.0, 0.0), |(s, h), k| (s + k.0 / number, h + k.1 / number));
    let (cross, square) = known.iter().fold((0.0, 0.0), |(cross, square), (s, h)| {
        (cross + (s - mean_s) * (h - mean_h), square + (s - mean_s).powi(2))
    });
    if square > 0.0 { cross / square } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rise_is_that_of_the_ground() {
        let line = [DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::new(1_000.0, 0.0)];
        let plane = |at: DVec2| Some(0.05 * at.x + 7.0);
        assert!((rise_m(&line, plane) - 50.0).abs() < 1e-9);
        assert_eq!(rise_m(&line, |_| None), 0.0);
        assert_eq!(rise_m(&[DVec2::ZERO, DVec2::ZERO], |_| Some(f64::NAN)).max(0.0), 0.0);
    }
}
