//! Value noise on a square lattice of hashed numbers, 0..1: what makes glades, thickets and stands.
//!
//! Products and sums only, so that it is the same on every machine. [`noise`] answers for one place; [`Lattice`] keeps the numbers of
//! a rectangle, for many places in it, and answers the same to the bit.

use crate::scatter::{hash, uniform};
use glam::DVec2;

/// Noise at a place, in sides of the lattice; a salt names what it is for.
pub fn noise(at: DVec2, salt: u32) -> f32 {
    let (x, z) = (whole(at.x), whole(at.y));
    let corner = |dx: i32, dz: i32| number(x.wrapping_add(dx), z.wrapping_add(dz), salt);
    between(at, x, z, [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)])
}

/// The numbers of a lattice over a rectangle.
#[derive(Debug, Clone)]
pub struct Lattice {
    side_m: f64,
    west: i32,
    north: i32,
    wide: usize,
    numbers: Vec<f32>,
}

impl Lattice {
    /// Over the plan rectangle from `low` to `high`, metres, with squares of a side.
    pub fn new(low: DVec2, high: DVec2, side_m: f64, salt: u32) -> Self {
        // A division never decreases with its dividend: no place of the rectangle lies beyond these.
        let [west, north, east, south] = [low.x, low.y, high.x, high.y].map(|at_m| whole(at_m / side_m));
        let numbers = (north..=south + 1).flat_map(|z| (west..=east + 1).map(move |x| number(x, z, salt)));
        Self { side_m, west, north, wide: (east - west + 2) as usize, numbers: numbers.collect() }
    }

    /// [`noise`] at a place of the rectangle, metres.
    pub fn at(&self, at_m: DVec2) -> f32 {
        let at = at_m / self.side_m;
        let (x, z) = (whole(at.x), whole(at.y));
        let first = (z - self.north) as usize * self.wide + (x - self.west) as usize;
        let [north, south] = [first, first + self.wide].map(|at| &self.numbers[at..at + 2]);
        between(at, x, z, [north[0], north[1], south[0], south[1]])
    }
}

fn number(x: i32, z: i32, salt: u32) -> f32 {
    uniform(hash(x, z, salt)[0])
}

/// The greatest whole number that is not greater. Without the call that `floor` is on processors that lack it.
fn whole(value: f64) -> i32 {
    let towards_zero = value as i32;
    towards_zero.wrapping_sub(i32::from(f64::from(towards_zero) > value))
}

/// Eased between the numbers at the corners of a square: north-west, north-east, south-west, south-east.
fn between(at: DVec2, x: i32, z: i32, [nw, ne, sw, se]: [f32; 4]) -> f32 {
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease((at.x - f64::from(x)) as f32), ease((at.y - f64::from(z)) as f32));
    let (north, south) = (nw + u * (ne - nw), sw + u * (se - sw));
    north + v * (south - north)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_lattice_answers_as_the_hash_does() {
        let (low, high) = (DVec2::new(-3_100.0, -870.0), DVec2::new(2_900.0, 5_130.0));
        for (side_m, salt) in [(310.0, 101), (87.0, 102), (0.5 * 6_000.0, 9)] {
            let lattice = Lattice::new(low, high, side_m, salt);
            for i in 0..20_000 {
                let [a, b, _] = crate::scatter::uniforms(i, 2, 77).map(f64::from);
                let at = low + (high - low) * DVec2::new(a, b);
                assert_eq!(lattice.at(at).to_bits(), noise(at / side_m, salt).to_bits(), "{at} {side_m}");
            }
            for at in [low, high, DVec2::new(low.x, high.y), DVec2::ZERO] {
                assert_eq!(lattice.at(at).to_bits(), noise(at / side_m, salt).to_bits(), "{at} {side_m}");
            }
        }
    }

    #[test]
    fn whole_numbers_are_those_of_floor() {
        for value in [-2.0, -1.5, -0.0, 0.0, 0.999, 1.0, -1e-300, 123_456.7, -123_456.7] {
            assert_eq!(f64::from(whole(value)), value.floor(), "{value}");
        }
    }
}
