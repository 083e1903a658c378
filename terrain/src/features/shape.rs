//! What placed things and masts are made of, as boxes: what a shell meets, and the size that a picture draws.
//!
//! Frame of a thing: x to its right, y up from the ground, z backward, metres; its front looks along -z. The boxes are
//! no smaller than what is drawn by more than a detail, such as an aerial or the slope of a bow.
//!
//! Sources of sizes: ICAO Annex 14 practice and drawings of common types. Aircraft: Cessna 172, 8.3 x 11.0 x 2.7 m.
//! Tank: 3.6 x 9.5 x 2.4 m with the gun. Truck: 2.5 x 8.0 x 3.4 m. Boat: 7 m. Ship: a coaster of 60 m.

use super::model::{MastClass, PlacedClass};
use glam::{DVec2, DVec3};

/// A box in a thing's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalBox {
    /// Least corner.
    pub low: DVec3,
    /// Greatest corner.
    pub high: DVec3,
}

/// A thing's place: where it stands and how it is turned about the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// The ground under it, world metres.
    pub at_m: DVec3,
    /// Where its front looks, clockwise from grid north.
    pub grid_heading_rad: f64,
}

const fn cuboid(low: [f64; 3], high: [f64; 3]) -> LocalBox {
    LocalBox { low: DVec3::from_array(low), high: DVec3::from_array(high) }
}

/// Boxes of a placed thing.
pub const fn placed(class: PlacedClass) -> &'static [LocalBox] {
    match class {
        PlacedClass::Hangar => {
            const {
                &[
                    cuboid([-15.0, 0.0, -12.5], [15.0, 6.0, 12.5]),
                    cuboid([-10.5, 6.0, -12.5], [10.5, 8.5, 12.5]),
                    cuboid([-5.0, 8.5, -12.5], [5.0, 9.6, 12.5]),
                ]
            }
        }
        PlacedClass::ControlTower => {
            const {
                &[
                    cuboid([-6.0, 0.0, -5.0], [6.0, 4.0, 5.0]),
                    cuboid([-2.5, 4.0, -2.5], [2.5, 18.0, 2.5]),
                    cuboid([-4.0, 18.0, -4.0], [4.0, 22.5, 4.0]),
                ]
            }
        }
        PlacedClass::Terminal => {
            const { &[cuboid([-30.0, 0.0, -10.0], [30.0, 7.0, 10.0]), cuboid([-12.0, 7.0, -8.0], [12.0, 11.0, 8.0])] }
        }
        PlacedClass::FuelTank => const { &[cuboid([-4.0, 0.0, -4.0], [4.0, 6.5, 4.0])] },
        PlacedClass::Truck => {
            const { &[cuboid([-1.25, 0.0, -4.0], [1.25, 2.7, -1.9]), cuboid([-1.25, 0.5, -1.8], [1.25, 3.4, 4.0])] }
        }
        PlacedClass::Tank => {
            const {
                &[
                    cuboid([-1.8, 0.0, -3.5], [1.8, 1.5, 3.5]),
                    cuboid([-1.2, 1.5, -1.3], [1.2, 2.4, 1.7]),
                    cuboid([-0.1, 1.7, -6.0], [0.1, 1.95, -1.3]),
                ]
            }
        }
        PlacedClass::Aircraft => {
            const {
                &[
                    cuboid([-0.6, 0.6, -2.6], [0.6, 2.1, 1.6]),
                    cuboid([-0.35, 1.0, 1.6], [0.35, 1.8, 5.5]),
                    cuboid([-5.5, 2.1, -0.9], [5.5, 2.3, 0.7]),
                    cuboid([-1.7, 1.4, 4.5], [1.7, 1.6, 5.5]),
                    cuboid([-0.1, 1.6, 4.3], [0.1, 2.7, 5.6]),
                ]
            }
        }
        PlacedClass::Ship => {
            const { &[cuboid([-5.0, -3.0, -30.0], [5.0, 3.0, 30.0]), cuboid([-4.0, 3.0, 17.0], [4.0, 12.0, 27.0])] }
        }
        PlacedClass::Boat => {
            const { &[cuboid([-1.2, -0.5, -3.5], [1.2, 0.9, 3.5]), cuboid([-0.8, 0.9, -0.8], [0.8, 2.1, 1.4])] }
        }
        PlacedClass::Windsock => const { &[cuboid([-0.1, 0.0, -0.1], [0.1, 6.0, 0.1])] },
    }
}

/// Boxes of a mast of a height.
pub fn mast(class: MastClass, height_m: f64) -> Vec<LocalBox> {
    let shaft = |half_m: f64| cuboid([-half_m, 0.0, -half_m], [half_m, height_m, half_m]);
    match class {
        MastClass::Mast => vec![shaft(0.5)],
        MastClass::Tower => vec![shaft((0.06 * height_m).clamp(1.5, 6.0))],
        MastClass::Chimney => vec![shaft((0.035 * height_m).clamp(0.8, 5.0))],
        MastClass::WindTurbine => {
            // The height is the hub's; the rotor turns and stops no shell.
            let half_m = (0.018 * height_m).clamp(0.5, 2.5);
            let nacelle =
                cuboid([-half_m, height_m - half_m, -2.0 * half_m], [half_m, height_m + half_m, 3.0 * half_m]);
            vec![shaft(half_m), nacelle]
        }
    }
}

/// Box of a power line's tower of a height: its shaft; lattice arms and wires stop no shell.
pub fn power_tower(height_m: f64) -> LocalBox {
    cuboid([-0.9, 0.0, -0.9], [0.9, height_m, 0.9])
}

/// The smallest box around others.
pub fn bounds(boxes: &[LocalBox]) -> LocalBox {
    let start = cuboid([0.0; 3], [0.0; 3]);
    boxes.iter().fold(start, |all, one| LocalBox { low: all.low.min(one.low), high: all.high.max(one.high) })
}

impl Stand {
    /// A point of the thing's frame in the world.
    pub fn world_m(&self, local: DVec3) -> DVec3 {
        self.at_m + self.turned(local)
    }

    /// A direction of the thing's frame in the world.
    pub fn turned(&self, local: DVec3) -> DVec3 {
        let (sin, cos) = self.grid_heading_rad.sin_cos();
        DVec3::new(local.x * cos - local.z * sin, local.y, local.x * sin + local.z * cos)
    }

    /// A direction of the world in the thing's frame.
    pub fn local(&self, world: DVec3) -> DVec3 {
        let (sin, cos) = self.grid_heading_rad.sin_cos();
        DVec3::new(world.x * cos + world.z * sin, world.y, world.z * cos - world.x * sin)
    }

    /// Where a segment first enters one of the boxes, as a fraction, and the outward unit normal in the world.
    pub fn enter(&self, boxes: &[LocalBox], from: DVec3, to: DVec3) -> Option<(f64, DVec3)> {
        let (start, end) = (self.local(from - self.at_m), self.local(to - self.at_m));
        let entered = boxes.iter().filter_map(|one| one.enter(start, end));
        let (fraction, normal) = entered.reduce(|first, other| if other.0 < first.0 { other } else { first })?;
        Some((fraction, self.turned(normal)))
    }

    /// Least and greatest plan corner of a box's four.
    pub fn plan(&self, of: &LocalBox) -> (DVec2, DVec2) {
        let corners = [(of.low.x, of.low.z), (of.high.x, of.low.z), (of.high.x, of.high.z), (of.low.x, of.high.z)];
        corners.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), (x, z)| {
            let at = self.world_m(DVec3::new(*x, 0.0, *z));
            (low.min(DVec2::new(at.x, at.z)), high.max(DVec2::new(at.x, at.z)))
        })
    }
}

impl LocalBox {
    /// Where a segment enters the box, as a fraction, and the outward unit normal; a start inside enters at 0, against
    /// its own way.
    pub fn enter(&self, from: DVec3, to: DVec3) -> Option<(f64, DVec3)> {
        let way = to - from;
        let (mut enter, mut exit, mut normal) = (0.0_f64, 1.0_f64, None);
        for axis in 0..3 {
            let (start, along, low, high) = (from[axis], way[axis], self.low[axis], self.high[axis]);
            if along == 0.0 {
                if start < low || start > high {
                    return None;
                }
                continue;
            }
            let (near, far) = if along > 0.0 { (low, high) } else { (high, low) };
            let (first, last) = ((near - start) / along, (far - start) / along);
            if first >= enter {
                enter = first;
                normal = Some(axis);
            }
            exit = exit.min(last);
        }
        if enter > exit {
            return None;
        }
        let outward = match normal {
            Some(axis) => {
                let mut out = DVec3::ZERO;
                out[axis] = -way[axis].signum();
                out
            }
            None => (-way).try_normalize().unwrap_or(DVec3::Y),
        };
        Some((enter, outward))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_front_looks_along_its_heading() {
        let stand = Stand { at_m: DVec3::new(5.0, 6.0, 7.0), grid_heading_rad: FRAC_PI_2 };
        let front = stand.turned(DVec3::NEG_Z);
        assert!((front - crate::frame::direction(FRAC_PI_2, 0.0)).length() < 1e-15);
        assert!((stand.turned(DVec3::X) - DVec3::Z).length() < 1e-15, "right of east is south");
        assert!((stand.local(stand.turned(DVec3::new(1.0, 2.0, 3.0))) - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-15);
    }

    #[test]
    fn a_box_is_entered_on_the_face_that_is_met() {
        let one = cuboid([-1.0, 0.0, -2.0], [1.0, 3.0, 2.0]);
        let (fraction, normal) = one.enter(DVec3::new(-5.0, 1.0, 0.0), DVec3::new(5.0, 1.0, 0.0)).unwrap();
        assert!((fraction - 0.4).abs() < 1e-15 && normal == DVec3::NEG_X);
        assert_eq!(one.enter(DVec3::new(-5.0, 4.0, 0.0), DVec3::new(5.0, 4.0, 0.0)), None);
        assert_eq!(one.enter(DVec3::new(0.0, 1.0, 0.0), DVec3::new(9.0, 1.0, 0.0)).unwrap(), (0.0, DVec3::NEG_X));
        assert_eq!(one.enter(DVec3::new(-5.0, 1.0, 0.0), DVec3::new(-2.0, 1.0, 0.0)), None);
    }
}
