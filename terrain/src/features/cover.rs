//! What covers the ground, cell by cell: a raster over the whole world.
//!
//! Cell (column, row) is the square of [`Cover::cell_m`] whose north-west corner lies that many cells east and south of the
//! world's north-west corner; a whole number of cells makes a post step. Each cell says its class and whether a file of
//! features said so or a rule.

use crate::grid::Grid;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What covers a cell.
#[allow(missing_docs, reason = "the names are the field's own")]
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum CoverClass {
    Unknown = 0,
    Water = 1,
    Conifer = 2,
    Broadleaf = 3,
    MixedForest = 4,
    Scrub = 5,
    Field = 6,
    Grass = 7,
    Rock = 8,
    Snow = 9,
    BuiltUp = 10,
    Sand = 11,
    Paved = 12,
}

/// All classes, by number.
pub const CLASSES: [CoverClass; 13] = [
    CoverClass::Unknown,
    CoverClass::Water,
    CoverClass::Conifer,
    CoverClass::Broadleaf,
    CoverClass::MixedForest,
    CoverClass::Scrub,
    CoverClass::Field,
    CoverClass::Grass,
    CoverClass::Rock,
    CoverClass::Snow,
    CoverClass::BuiltUp,
    CoverClass::Sand,
    CoverClass::Paved,
];

/// Set in a cell that a file of features decided; clear where a rule did.
pub const FROM_FEATURES: u8 = 0x80;

/// See the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Cover {
    west_m: f64,
    north_m: f64,
    cell_m: f64,
    columns: u32,
    rows: u32,
    /// Row by row; empty: nothing is known.
    cells: Arc<[u8]>,
}

impl CoverClass {
    /// Of a cell's number, with or without [`FROM_FEATURES`].
    pub fn of(cell: u8) -> Self {
        CLASSES.get(usize::from(cell & !FROM_FEATURES)).copied().unwrap_or(Self::Unknown)
    }

    /// Whether trees grow on it.
    pub fn is_forest(self) -> bool {
        matches!(self, Self::Conifer | Self::Broadleaf | Self::MixedForest)
    }
}

impl Cover {
    /// Nothing known of a grid's ground.
    pub fn unknown(grid: &Grid) -> Self {
        Self {
            west_m: grid.west_m,
            north_m: grid.north_m,
            cell_m: grid.step_m,
            columns: grid.columns() - 1,
            rows: grid.rows() - 1,
            cells: Arc::from([]),
        }
    }

    /// A raster with `per_step` cells along a post step; `cells` row by row. `None` if their number is not the grid's.
    pub fn new(grid: &Grid, per_step: u32, cells: Vec<u8>) -> Option<Self> {
        let (columns, rows) = ((grid.columns() - 1).checked_mul(per_step)?, (grid.rows() - 1).checked_mul(per_step)?);
        let fits = per_step > 0 && cells.len() as u64 == u64::from(columns) * u64::from(rows);
        fits.then(|| Self {
            west_m: grid.west_m,
            north_m: grid.north_m,
            cell_m: grid.step_m / f64::from(per_step),
            columns,
            rows,
            cells: cells.into(),
        })
    }

    /// Side of a cell, metres.
    pub fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// Cells along a row and along a column.
    pub fn size(&self) -> [u32; 2] {
        [self.columns, self.rows]
    }

    /// All cells row by row; empty if nothing is known.
    pub fn cells(&self) -> &[u8] {
        &self.cells
    }

    /// Whether any cell is of a kind.
    pub fn has(&self, kind: impl Fn(CoverClass) -> bool) -> bool {
        let is: Vec<bool> = (0..=u8::MAX).map(|cell| kind(CoverClass::of(cell))).collect();
        self.cells.iter().any(|cell| is[usize::from(*cell)])
    }

    /// A cell's number, [`CoverClass::Unknown`] outside.
    pub fn cell(&self, column: i64, row: i64) -> u8 {
        if (0..i64::from(self.columns)).contains(&column) && (0..i64::from(self.rows)).contains(&row) {
            self.cells.get((row * i64::from(self.columns) + column) as usize).copied().unwrap_or(0)
        } else {
            0
        }
    }

    /// Cell coordinates of a plan point: whole numbers at the cells' north-west corners.
    pub fn place(&self, x_m: f64, z_m: f64) -> (f64, f64) {
        ((x_m - self.west_m) / self.cell_m, (z_m - self.north_m) / self.cell_m)
    }

    /// What covers a plan point; [`CoverClass::Unknown`] outside and for NaN.
    pub fn class_at(&self, x_m: f64, z_m: f64) -> CoverClass {
        let (u, v) = self.place(x_m, z_m);
        // Towards zero is down where nothing is negative; `floor` would be a call.
        let inside = u >= 0.0 && v >= 0.0 && u < f64::from(self.columns) && v < f64::from(self.rows);
        if inside { CoverClass::of(self.cell(u as i64, v as i64)) } else { CoverClass::Unknown }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_their_numbers() {
        for (number, class) in (0..).zip(CLASSES) {
            assert_eq!(class as u8, number);
            assert_eq!(CoverClass::of(number | FROM_FEATURES), class);
        }
        assert_eq!(CoverClass::of(77), CoverClass::Unknown);
    }

    #[test]
    fn a_point_finds_its_cell() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let side = u64::from(crate::CELLS * 2);
        let cells = (0..side * side).map(|at| (at % 13) as u8).collect();
        let cover = Cover::new(&grid, 2, cells).unwrap();
        assert_eq!(cover.cell_m(), 100.0);
        assert_eq!(cover.class_at(grid.west_m + 350.0, grid.north_m + 50.0), CLASSES[3]);
        assert_eq!(cover.class_at(grid.west_m + 50.0, grid.north_m + 150.0), CLASSES[(side % 13) as usize]);
        assert_eq!(cover.class_at(grid.west_m - 1.0, 0.0), CoverClass::Unknown);
        assert_eq!(cover.class_at(f64::NAN, 0.0), CoverClass::Unknown);
        assert!(Cover::new(&grid, 2, vec![0; 5]).is_none());
        assert!(cover.has(CoverClass::is_forest));
        let rock = vec![CoverClass::Rock as u8 | FROM_FEATURES; (side * side) as usize];
        let rock = Cover::new(&grid, 2, rock).unwrap();
        assert!(rock.has(|class| class == CoverClass::Rock) && !rock.has(CoverClass::is_forest));
        assert!(!Cover::unknown(&grid).has(|_| true));
        assert_eq!(Cover::unknown(&grid).class_at(0.0, 0.0), CoverClass::Unknown);
    }
}
