//! Tests of outlines cut along the ground: no gap, no overlap, no open edge.

use super::super::lattice::Lattice;
use super::*;
use crate::grid::CELLS;
use glam::DVec2;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::collections::HashMap;

/// A round shape of many corners with a wavy edge, from any corner on, either way around.
fn blob(rng: &mut StdRng, at: (i64, i64), radius: f64, corners: usize) -> Vec<Spot> {
    let phase = rng.random_range(0.0..6.0);
    let turns = if rng.random_range(0..2) == 0 { 1.0 } else { -1.0 };
    let spot = |i: usize| {
        let angle = turns * std::f64::consts::TAU * i as f64 / corners as f64;
        let reach = radius * (1.0 + 0.25 * (5.0 * angle + phase).sin() + 0.06 * (23.0 * angle).sin());
        let away = DVec2::from_angle(angle) * reach;
        Spot { u: at.0 + away.x.round() as i64, v: at.1 + away.y.round() as i64 }
    };
    (0..corners).map(spot).collect()
}

fn twice_ring_area(ring: &[Spot]) -> i128 {
    ring.windows(2).map(|pair| twice_area(ring[0], pair[0], pair[1])).sum()
}

type Edges = HashMap<(Spot, Spot), i32>;

/// Adds a triangle's edges to those that have no other side yet.
fn add(edges: &mut Edges, corners: [Spot; 3]) {
    for at in 0..3 {
        let (a, b) = (corners[at], corners[(at + 1) % 3]);
        *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
    }
}

/// A lake over four blocks with islands, one of them with a pond, some of them in one cell.
fn lake(seed: u64) -> Vec<Vec<Spot>> {
    let mut rng = StdRng::seed_from_u64(seed);
    let middle = (30 * UNITS + rng.random_range(0..UNITS), 30 * UNITS + rng.random_range(0..UNITS));
    let mut rings = vec![blob(&mut rng, middle, 20.0 * UNITS as f64, 900)];
    rings.push(blob(&mut rng, middle, 9.0 * UNITS as f64, 300));
    rings.push(blob(&mut rng, middle, 5.0 * UNITS as f64, 200));
    for k in 0..14 {
        let away = DVec2::from_angle(f64::from(k) * 0.448) * 12.9 * UNITS as f64;
        let radius = if k % 2 == 0 { 0.1 } else { 0.5 } * UNITS as f64;
        rings.push(blob(&mut rng, (middle.0 + away.x as i64, middle.1 + away.y as i64), radius, 24));
    }
    rings
}

#[test]
fn a_lake_with_islands_is_filled_without_gap_overlap_or_open_edge() {
    let grid = Grid::centred(200.0, 2, 2).unwrap();
    for seed in 0..12 {
        let rings = lake(seed);
        let sizes: Vec<i128> = rings.iter().map(|ring| twice_ring_area(ring).abs()).collect();
        // The lake, less its large island, and the pond on that, less all small islands.
        let exact = sizes[0] - sizes[1] + sizes[2] - sizes[3..].iter().sum::<i128>();
        let (mut sum, mut edges, mut pieces) = (0, Edges::new(), 0);
        for (block, part) in Region::new(&rings, &|_, _| true).by_block(&grid) {
            part.cut(block, |column, row, north_west, piece| {
                pieces += 1;
                piece.triangles(&mut |triangle| {
                    let area = twice_area(triangle.corners[0], triangle.corners[1], triangle.corners[2]);
                    assert!(area >= 0, "{triangle:?}");
                    sum += area;
                    add(&mut edges, triangle.corners);
                    let diagonal = (column + row + 1) * UNITS;
                    for spot in triangle.corners {
                        assert!((column * UNITS..=(column + 1) * UNITS).contains(&spot.u), "{spot:?}");
                        assert!((row * UNITS..=(row + 1) * UNITS).contains(&spot.v), "{spot:?}");
                        assert!(if north_west { spot.u + spot.v <= diagonal } else { spot.u + spot.v >= diagonal });
                    }
                });
            });
        }
        assert!(pieces > 2_000);
        // A crossing is off by half a unit, a corner by two, over outlines of about 190 cells.
        let most = 2 * 3 * 190 * i128::from(UNITS);
        assert!((sum - exact).abs() < most, "{seed}: {sum} {exact}");
        // What has no other side is the outline: no more of it than crossings and corners, and all of it inside a cell.
        for ((a, b), count) in edges.into_iter().filter(|(_, count)| *count != 0) {
            assert_eq!(count.abs(), 1, "{seed}: {a:?} {b:?}");
            let along = |axis: Axis| a.along(axis) == b.along(axis) && a.along(axis) % UNITS == 0;
            let long = (a.u - b.u).abs() + (a.v - b.v).abs();
            assert!(![Axis::U, Axis::V, Axis::W].into_iter().any(along) || long < 4, "{seed}: {a:?} {b:?}");
        }
    }
}

#[test]
fn the_area_is_that_of_the_even_odd_rule_for_outlines_that_cross_themselves() {
    let mut rng = StdRng::seed_from_u64(3);
    let grid = Grid::centred(200.0, 1, 1).unwrap();
    for _ in 0..60 {
        let side = 30 * UNITS;
        let ring: Vec<Spot> = (0..9)
            .map(|_| Spot { u: rng.random_range(-UNITS..side + UNITS), v: rng.random_range(-UNITS..side + UNITS) })
            .collect();
        let mut inside = [0_i128; 2];
        for (block, part) in Region::new(std::slice::from_ref(&ring), &|_, _| true).by_block(&grid) {
            part.cut(block, |column, row, north_west, piece| {
                // Cells that no edge passes are whole: they can be asked at their middle.
                let third = UNITS / 3;
                let (east, south) = if north_west { (third, third) } else { (2 * third, 2 * third) };
                let at = Spot { u: column * UNITS + east, v: row * UNITS + south };
                let mut sum = 0;
                let mut shore = false;
                piece.triangles(&mut |triangle| {
                    sum += twice_area(triangle.corners[0], triangle.corners[1], triangle.corners[2]);
                    shore |= triangle.shore.contains(&true);
                });
                inside[0] += sum;
                if !shore {
                    assert_eq!(sum, i128::from(UNITS).pow(2));
                    let corner = |spot: &Spot| Corner { at: *spot, edge: None };
                    let corners: Loop = ring.iter().map(corner).collect();
                    assert!(holds(&corners, &[corner(&at), corner(&at)]));
                    inside[1] += 1;
                }
            });
        }
    }
}

#[test]
fn hostile_rings_are_nothing_or_something_small() {
    let grid = Grid::centred(200.0, 1, 1).unwrap();
    let lattice = Lattice::of(&grid);
    let spot = |x: f64, z: f64| lattice.spot(DVec2::new(x, z)).unwrap();
    let count = |ring: Vec<Spot>| {
        let mut triangles = 0;
        for (block, part) in Region::new(&[ring], &|_, _| true).by_block(&grid) {
            part.cut(block, |_, _, _, piece| piece.triangles(&mut |_| triangles += 1));
        }
        triangles
    };
    assert_eq!(count(vec![]), 0);
    assert_eq!(count(vec![spot(1.0, 1.0); 5]), 0);
    assert_eq!(count(vec![spot(1.0, 1.0), spot(500.0, 1.0), spot(1.0, 1.0)]), 0);
    assert!(count(vec![spot(0.0, 0.0), spot(90.0, 90.0), spot(90.0, 0.0), spot(0.0, 90.0)]) < 20);
    // Far larger than the world: all of it is inside.
    let far = 1e6;
    assert_eq!(
        count(vec![spot(-far, -far), spot(far, -far), spot(far, far), spot(-far, far)]),
        2 * (CELLS * CELLS) as usize
    );
    // Along the lines of the ground.
    assert!(count(vec![spot(-200.0, -200.0), spot(400.0, -200.0), spot(400.0, 400.0), spot(-200.0, 400.0)]) >= 18);
}
