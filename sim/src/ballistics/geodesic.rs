//! The shortest way over the surface between two places: its length and its bearing at the start.
//!
//! On a sphere it is exact; on WGS84 good to a millimetre. Metres, radians, bearings clockwise from north. Places that are
//! nearly opposite on the globe (where the iteration does not settle) are answered to some kilometres.
//!
//! Source: T. Vincenty, Direct and inverse solutions of geodesics on the ellipsoid, Survey Review 23, 1975.

use crate::planet::{Place, Shape};
use terrain::WGS84;

/// Length and bearing of the way from one place to another; `None` on a flat Earth, where they are plain geometry.
pub fn inverse(shape: Shape, from: Place, to: Place) -> Option<(f64, f64)> {
    let (a, f) = match shape {
        Shape::Flat { .. } => return None,
        Shape::Round { radius_m } => (radius_m, 0.0),
        Shape::Ellipsoid => (WGS84.a_m, WGS84.f),
    };
    let b = a * (1.0 - f);
    let reduced = |place: Place| {
        let (sin, cos) = place.lat_rad.sin_cos();
        let length = cos.hypot((1.0 - f) * sin);
        ((1.0 - f) * sin / length, cos / length)
    };
    let ((sin_1, cos_1), (sin_2, cos_2)) = (reduced(from), reduced(to));
    let apart = to.lon_rad - from.lon_rad;
    let mut lambda = apart;
    let mut answer = (0.0, 0.0);
    for _ in 0..100 {
        let (sin_lambda, cos_lambda) = lambda.sin_cos();
        let (east, north) = (cos_2 * sin_lambda, cos_1 * sin_2 - sin_1 * cos_2 * cos_lambda);
        let sin_sigma = east.hypot(north);
        if sin_sigma == 0.0 {
            return Some((0.0, 0.0));
        }
        let cos_sigma = sin_1 * sin_2 + cos_1 * cos_2 * cos_lambda;
        let sigma = sin_sigma.atan2(cos_sigma);
        let sin_alpha = cos_1 * cos_2 * sin_lambda / sin_sigma;
        let squared = 1.0 - sin_alpha * sin_alpha;
        // Along the equator the middle has no meaning, and no weight.
        let cos_middle = if squared > 1e-14 { cos_sigma - 2.0 * sin_1 * sin_2 / squared } else { 0.0 };
        let second = squared * (a * a - b * b) / (b * b);
        let big_a = 1.0 + second / 16_384.0 * (4_096.0 + second * (-768.0 + second * (320.0 - 175.0 * second)));
        let big_b = second / 1_024.0 * (256.0 + second * (-128.0 + second * (74.0 - 47.0 * second)));
        let twice = 2.0 * cos_middle * cos_middle - 1.0;
        let correction = big_b
            * sin_sigma
            * (cos_middle
                + big_b / 4.0
                    * (cos_sigma * twice
                        - big_b / 6.0 * cos_middle * (4.0 * sin_sigma * sin_sigma - 3.0) * (2.0 * twice - 1.0)));
        answer = (b * big_a * (sigma - correction), east.atan2(north));
        let c = f / 16.0 * squared * (4.0 + f * (4.0 - 3.0 * squared));
        let next = apart + (1.0 - c) * f * sin_alpha * (sigma + c * sin_sigma * (cos_middle + c * cos_sigma * twice));
        if (next - lambda).abs() <= 1e-15 {
            break;
        }
        lambda = next;
    }
    Some(answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(lat_deg: f64, lon_deg: f64) -> Place {
        Place { lat_rad: lat_deg.to_radians(), lon_rad: lon_deg.to_radians(), altitude_m: 0.0 }
    }

    #[test]
    fn known_ways_are_met() {
        // Flinders Peak to Buninyong, the worked example of Geoscience Australia's technical manual (on GRS80, which
        // differs from WGS84 by 0.1 mm in the minor axis): 54,972.271 m at 306 52' 05.37".
        let from = place(-(37.0 + 57.0 / 60.0 + 3.720_30 / 3600.0), 144.0 + 25.0 / 60.0 + 29.524_40 / 3600.0);
        let to = place(-(37.0 + 39.0 / 60.0 + 10.156_10 / 3600.0), 143.0 + 55.0 / 60.0 + 35.383_90 / 3600.0);
        let (length, bearing) = inverse(Shape::Ellipsoid, from, to).unwrap();
        assert!((length - 54_972.271).abs() < 1e-3, "{length}");
        let expected = 306.0 + 52.0 / 60.0 + 5.37 / 3600.0;
        assert!((bearing.to_degrees().rem_euclid(360.0) - expected).abs() < 0.01 / 3600.0, "{bearing}");
        let (quarter, north) = inverse(Shape::Round { radius_m: 2.0 }, place(0.0, 5.0), place(90.0, 5.0)).unwrap();
        assert!((quarter - std::f64::consts::PI).abs() < 1e-14 && north.abs() < 1e-15);
        // One degree of the equator is a pi / 180, and the date line is no border.
        let (degree, east) = inverse(Shape::Ellipsoid, place(0.0, 179.5), place(0.0, -179.5)).unwrap();
        assert!((degree - WGS84.a_m.to_radians()).abs() < 1e-6 && (east.to_degrees() - 90.0).abs() < 1e-9);
        assert_eq!(inverse(Shape::Ellipsoid, place(10.0, 5.0), place(10.0, 5.0)), Some((0.0, 0.0)));
        assert!(inverse(Shape::Ellipsoid, place(0.0, 0.0), place(0.1, 179.9)).unwrap().0.is_finite());
    }
}
