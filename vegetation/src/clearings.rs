//! Where no tree may stand: roads, running water, buildings, airfields.
//!
//! Shapes are sorted once into squares of [`SQUARE_M`] of the world's plane, each into every square that it comes near, so
//! a plant asks few of them. [`Clearings::near`] looks up the squares of a tile once. Plan metres, f64; only +, -, *, / and comparisons decide, so the answer is the same on
//! every machine. Lakes are not here: see [`terrain::features::lakes`].

use glam::DVec2;
use std::collections::HashMap;
use terrain::features::model::Features;

/// Side of a square, metres.
pub const SQUARE_M: f64 = 128.0;

/// Kept free beside a road, metres.
const ROAD_SIDE_M: f64 = 3.0;
/// Kept free beside running water, metres.
const BANK_M: f64 = 1.0;
/// Kept free around a building, metres.
const WALL_M: f64 = 3.0;
/// A runway's strip beside its edges and beyond its ends, metres: ICAO annex 14, volume I, 3.4 asks 60 m beyond the
/// ends and, for runways without instruments, up to 75 m from the middle.
const STRIP_M: f64 = 60.0;
/// Kept free beside taxiways and aprons, metres.
const TAXIWAY_SIDE_M: f64 = 20.0;

/// A piece of what is kept free.
#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// All that is nearer than the reach to a segment.
    Strip { from: DVec2, to: DVec2, reach_m: f64 },
    /// Inside a ring (even-odd).
    Ring(usize),
}

/// What is kept free in and about a rectangle.
#[derive(Debug)]
pub struct ClearingsNear<'a> {
    all: &'a Clearings,
    /// The square at its north-west corner.
    first: (i32, i32),
    wide: usize,
    /// Square by square, row by row; empty where nothing is kept free.
    squares: Vec<&'a [Shape]>,
}

/// See the module.
#[derive(Debug, Default)]
pub struct Clearings {
    squares: HashMap<(i32, i32), Vec<Shape>>,
    rings: Vec<Vec<DVec2>>,
}

impl Clearings {
    /// Of a world's features.
    pub fn new(features: &Features) -> Self {
        let mut made = Self::default();
        for road in features.roads.iter().filter(|road| !road.tunnel) {
            made.add_line(&road.line, 0.5 * f64::from(road.width_m) + ROAD_SIDE_M);
        }
        for water in features.waterways.iter().filter(|water| !water.tunnel) {
            made.add_line(&water.line, 0.5 * f64::from(water.width_m) + BANK_M);
        }
        for power in &features.power_lines {
            made.add_line(&power.line, 12.0);
        }
        for building in &features.buildings {
            made.add_ring(&building.outline, WALL_M);
        }
        for airfield in &features.airfields {
            for runway in &airfield.runways {
                made.add_line(&runway.ends, 0.5 * f64::from(runway.width_m) + STRIP_M);
            }
            for (line, width_m) in &airfield.taxiways {
                made.add_line(line, 0.5 * f64::from(*width_m) + TAXIWAY_SIDE_M);
            }
            for apron in &airfield.aprons {
                made.add_ring(apron, TAXIWAY_SIDE_M);
            }
        }
        made
    }

    /// Whether a plan point must stay free.
    pub fn holds(&self, at: DVec2) -> bool {
        self.squares.get(&square(at)).is_some_and(|shapes| self.any_holds(shapes, at))
    }

    /// What is needed to answer for the points of a plan rectangle.
    pub fn near(&self, low: DVec2, high: DVec2) -> ClearingsNear<'_> {
        let (first, last) = (square(low), square(high));
        let wide = (last.0 - first.0 + 1) as usize;
        let mut squares = Vec::new();
        if !self.squares.is_empty() {
            let rows = (first.1..=last.1).flat_map(|z| (first.0..=last.0).map(move |x| (x, z)));
            squares.extend(rows.map(|at| self.squares.get(&at).map_or(&[][..], Vec::as_slice)));
        }
        if squares.iter().all(|shapes| shapes.is_empty()) {
            squares.clear();
        }
        ClearingsNear { all: self, first, wide, squares }
    }

    fn any_holds(&self, shapes: &[Shape], at: DVec2) -> bool {
        shapes.iter().any(|shape| match shape {
            Shape::Strip { from, to, reach_m } => distance_squared(at, *from, *to) < reach_m * reach_m,
            Shape::Ring(ring) => inside(at, &self.rings[*ring]),
        })
    }

    fn add_line(&mut self, line: &[DVec2], reach_m: f64) {
        for pair in line.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            // A long segment is cut, so that its box stays near it.
            let pieces = ((from.distance(to) / (2.0 * SQUARE_M)).ceil() as usize).clamp(1, 4_096);
            for piece in 0..pieces {
                let at = |i: usize| from + (to - from) * (i as f64 / pieces as f64);
                let (a, b) = (at(piece), at(piece + 1));
                self.put(a.min(b) - reach_m, a.max(b) + reach_m, &Shape::Strip { from, to, reach_m });
            }
        }
    }

    fn add_ring(&mut self, ring: &[DVec2], reach_m: f64) {
        let Some(&first) = ring.first() else { return };
        let (low, high) = ring.iter().fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)));
        self.rings.push(ring.to_vec());
        let number = self.rings.len() - 1;
        self.put(low, high, &Shape::Ring(number));
        for (at, from) in ring.iter().enumerate() {
            self.add_line(&[*from, ring[(at + 1) % ring.len()]], reach_m);
        }
    }

    fn put(&mut self, low: DVec2, high: DVec2, shape: &Shape) {
        let ((west, north), (east, south)) = (square(low), square(high));
        for z in north..=south {
            for x in west..=east {
                let shapes = self.squares.entry((x, z)).or_default();
                if shapes.last() != Some(shape) {
                    shapes.push(shape.clone());
                }
            }
        }
    }
}

impl ClearingsNear<'_> {
    /// [`Clearings::holds`] of a point of the rectangle.
    pub fn holds(&self, at: DVec2) -> bool {
        if self.squares.is_empty() {
            return false;
        }
        let (x, z) = square(at);
        let number = (z - self.first.1) as usize * self.wide + (x - self.first.0) as usize;
        self.squares.get(number).is_some_and(|shapes| self.all.any_holds(shapes, at))
    }
}

fn square(at: DVec2) -> (i32, i32) {
    ((at.x / SQUARE_M).floor() as i32, (at.y / SQUARE_M).floor() as i32)
}

/// Of a point from a segment.
fn distance_squared(at: DVec2, from: DVec2, to: DVec2) -> f64 {
    let (along, away) = (to - from, at - from);
    let length_squared = along.x * along.x + along.y * along.y;
    let share = if length_squared > 0.0 { (away.x * along.x + away.y * along.y) / length_squared } else { 0.0 };
    let off = away - along * share.clamp(0.0, 1.0);
    off.x * off.x + off.y * off.y
}

/// Even-odd rule.
fn inside(at: DVec2, ring: &[DVec2]) -> bool {
    let mut odd = false;
    for (i, a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            odd = !odd;
        }
    }
    odd
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::features::model::{Building, BuildingClass, Origin, Road, RoadClass};

    #[test]
    fn the_index_answers_as_asking_every_shape_does() {
        let line: Vec<DVec2> = (0..40i32)
            .map(|i| {
                let [a, b, _] = crate::scatter::uniforms(i, 0, 9);
                DVec2::new(f64::from(a), f64::from(b)) * 3_000.0 - 1_500.0
            })
            .collect();
        let road = Road {
            class: RoadClass::Primary,
            width_m: 8.0,
            paved: true,
            tunnel: false,
            bridge: false,
            line: line.clone(),
        };
        let outline = vec![DVec2::new(10.0, 10.0), DVec2::new(300.0, 40.0), DVec2::new(250.0, 400.0)];
        let building = Building {
            class: BuildingClass::House,
            outline: outline.clone(),
            height_m: 8.0,
            height_from: Origin::Assumed,
        };
        let features = Features { roads: vec![road], buildings: vec![building], ..Features::default() };
        let clearings = Clearings::new(&features);
        let at_hand = clearings.near(DVec2::splat(-1_600.0), DVec2::splat(1_600.0));
        let mut held = 0;
        for i in 0..20_000 {
            let [a, b, _] = crate::scatter::uniforms(i, 1, 5);
            let at = DVec2::new(f64::from(a), f64::from(b)) * 3_200.0 - 1_600.0;
            let near =
                |line: &[DVec2], reach: f64| line.windows(2).any(|p| distance_squared(at, p[0], p[1]) < reach * reach);
            let ring: Vec<DVec2> = outline.iter().chain(&outline[..1]).copied().collect();
            let slow = near(&line, 7.0) || near(&ring, 3.0) || inside(at, &outline);
            assert_eq!(clearings.holds(at), slow, "{at}");
            assert_eq!(at_hand.holds(at), slow, "{at}");
            held += i32::from(slow);
        }
        assert!(held > 300, "{held}");
        let nothing = Clearings::default();
        assert!(!nothing.holds(DVec2::ZERO) && !nothing.near(DVec2::ZERO, DVec2::ONE).holds(DVec2::ONE));
    }
}
