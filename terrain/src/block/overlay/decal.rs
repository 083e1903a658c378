//! Marks that events leave on the ground and that its posts cannot show: small craters, burnt ground.
//!
//! Plan coordinates, metres. A mark is a square of [`REACH_RADII`] radii about its middle, cut along the ground's triangles
//! like everything that is draped; its vertices count along and across from its middle. It is turned by an angle that its
//! place gives, so that no two look alike.
//!
//! Invariant others rely on: a mark's triangles depend on the mark and the ground alone.

use super::build::{Drape, Frame};
use super::clip::{CellSquare, Polygon};
use super::lattice::Lattice;
use super::{ACROSS_PER_METRE, Kind, Overlay};
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS};
use glam::DVec2;
use std::f64::consts::TAU;

/// Half the side of a mark's square over its radius: what a crater throws out lies within three radii of its middle
/// (see [`crate::edit`]).
pub const REACH_RADII: f64 = 3.0;
/// Largest radius of a mark, metres: coordinates of its vertices are packed.
pub const MOST_RADIUS_M: f64 = 32_767.0 / ACROSS_PER_METRE / (REACH_RADII * std::f64::consts::SQRT_2);
/// Smallest one, metres: more than a unit of the lattice in the widest step.
pub const LEAST_RADIUS_M: f64 = 0.05;

/// A mark on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decal {
    /// Its middle, world x and z, metres.
    pub centre_m: DVec2,
    /// Of a crater's rim, or of what is burnt, metres; held within [`LEAST_RADIUS_M`] and [`MOST_RADIUS_M`].
    pub radius_m: f64,
    /// [`Kind::Crater`] or [`Kind::Scorch`].
    pub kind: Kind,
}

/// A mark's triangles, by block; nothing of one that is nowhere or on void.
pub fn drape(field: &Field, decal: &Decal) -> Vec<(BlockIndex, Overlay)> {
    let (grid, lattice) = (field.grid(), Lattice::of(field.grid()));
    let radius_m = decal.radius_m.clamp(LEAST_RADIUS_M, MOST_RADIUS_M);
    let Some(origin) = lattice.spot(decal.centre_m).filter(|_| radius_m.is_finite()) else { return Vec::new() };
    // Low bits of the place: neighbours turn differently.
    let bits = (origin.u.wrapping_mul(0x9e37_79b9) ^ origin.v.wrapping_mul(0x85eb_ca6b)) as u64;
    let turn = (bits >> 8) as u16 as f64 / 65_536.0 * TAU;
    let along = DVec2::new(turn.cos(), turn.sin());
    let across = DVec2::new(-along.y, along.x);
    let reach_m = REACH_RADII * radius_m;
    let corner = |(a, b): (f64, f64)| lattice.spot(decal.centre_m + (along * a + across * b) * reach_m);
    let [Some(a), Some(b), Some(c), Some(d)] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner) else {
        return Vec::new();
    };
    let Some(polygon) = Polygon::new(&[a, b, c, d]) else { return Vec::new() };
    let frame = Frame { kind: decal.kind, origin, along, across, start_m: 0.0, half_m: radius_m, half_length_m: 0.0 };

    let half = DVec2::splat(reach_m * std::f64::consts::SQRT_2);
    let block_at = |at: DVec2| {
        let place = |metres: f64, first_m: f64, blocks: u32| {
            (((metres - first_m) / grid.block_m()).floor().max(0.0) as i32).min(blocks as i32 - 1)
        };
        (place(at.x, grid.west_m, grid.blocks_x), place(at.y, grid.north_m, grid.blocks_z))
    };
    let (first, last) = (block_at(decal.centre_m - half), block_at(decal.centre_m + half));
    let mut found = Vec::new();
    for z in first.1..=last.1 {
        for x in first.0..=last.0 {
            let block = BlockIndex { x, z };
            let mut overlay = Overlay::default();
            let square = CellSquare { column: block.first_column(), row: block.first_row(), cells: i64::from(CELLS) };
            Drape { field, lattice, square, overlay: &mut overlay }.polygon(polygon, &frame);
            if !overlay.indices.is_empty() {
                found.push((block, overlay));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::ground::Ground;
    use crate::synthetic;
    use std::sync::Arc;

    fn field() -> Field {
        synthetic::rough(Grid::centred(200.0, 2, 2).unwrap(), 7, 40.0)
    }

    fn area_m2(parts: &[(BlockIndex, Overlay)], unit_m: f64) -> f64 {
        let triangle = |overlay: &Overlay, corners: &[u32]| {
            let at = |corner: u32| overlay.vertices[corner as usize].place();
            let [a, b, c] = [0, 1, 2].map(|of| at(corners[of]));
            ((b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)).abs() as f64 * 0.5 * unit_m * unit_m
        };
        parts.iter().flat_map(|(_, of)| of.indices.chunks_exact(3).map(move |corners| triangle(of, corners))).sum()
    }

    #[test]
    fn a_mark_covers_its_square_on_the_very_ground_of_every_block_that_it_touches() {
        let field = field();
        let area = Ground::new(Arc::new(field.clone())).whole();
        let grid = *field.grid();
        let lattice = Lattice::of(&grid);
        // The world's middle is a corner of four blocks; then within a cell, then over a diagonal.
        for (centre_m, blocks) in
            [(DVec2::new(0.0, 0.0), 4), (DVec2::new(-730.0, 410.0), 1), (DVec2::new(300.0, 300.0), 1)]
        {
            let decal = Decal { centre_m, radius_m: 9.0, kind: Kind::Crater };
            let parts = drape(&field, &decal);
            assert_eq!(parts.len(), blocks, "{centre_m}");
            let whole_m2 = (2.0 * REACH_RADII * decal.radius_m).powi(2);
            // Corners are moved to the nearest spot: half a unit of 3 mm along sides of 54 m.
            assert!((area_m2(&parts, lattice.unit_m()) - whole_m2).abs() < 4.0 * 54.0 * lattice.unit_m());
            for (block, overlay) in &parts {
                for vertex in &overlay.vertices {
                    let (u, v) = vertex.place();
                    let cells = i64::from(CELLS) * super::super::lattice::UNITS;
                    assert!((0..=cells).contains(&u) && (0..=cells).contains(&v));
                    let at_m = lattice.plan_m(super::super::lattice::Spot {
                        u: u + block.first_column() * super::super::lattice::UNITS,
                        v: v + block.first_row() * super::super::lattice::UNITS,
                    });
                    let ground_m = area.height_m(at_m.x, at_m.y).expect("ground");
                    // One rounding to f32 at heights of some 100 m.
                    assert!((f64::from(vertex.height_m) - ground_m).abs() < 1e-5, "{} {ground_m}", vertex.height_m);
                }
            }
        }
    }

    #[test]
    fn a_mark_that_is_nowhere_is_none() {
        let field = field();
        for centre_m in [DVec2::NAN, DVec2::splat(1e12), DVec2::splat(f64::NEG_INFINITY), DVec2::splat(50_000.0)] {
            assert_eq!(drape(&field, &Decal { centre_m, radius_m: 3.0, kind: Kind::Scorch }), Vec::new());
        }
        let odd = |radius_m| drape(&field, &Decal { centre_m: DVec2::ZERO, radius_m, kind: Kind::Scorch });
        assert!(!odd(1e9).is_empty() && !odd(-1.0).is_empty());
        assert!(odd(f64::NAN).is_empty());
    }
}
