//! Exact answers about the ground: height, normal, where a segment first meets it.
//!
//! Frame: see [`crate::frame`]. The ground is the level-0 triangles of a [`Field`] and nothing else. A segment *meets*
//! the ground at its first point that is on or under it; over void there is no ground.
//!
//! Invariant others rely on: watertight. In each triangle that a segment crosses, the gap between segment and plane is
//! taken at the entry and at the exit; the exit of one is the entry of the next at the very same parameter, so no
//! rounding of a cell line, a diagonal or a post can let a segment through.

use crate::edit::{Changed, Edit, EditError};
use crate::field::Field;
use crate::grid::Grid;
use crate::pyramid::{self, Pyramid};
use glam::{DVec2, DVec3};
use std::fmt;
use std::hint::select_unpredictable;
use std::sync::Arc;

/// The ground of a world; cheap to clone.
#[derive(Debug, Clone)]
pub struct Ground {
    field: Arc<Field>,
    pyramid: Arc<Pyramid>,
}

/// A part of the ground that is at hand, on which every question has an exact and immediate answer.
#[derive(Debug, Clone)]
pub struct Area {
    field: Arc<Field>,
    pyramid: Arc<Pyramid>,
    cells: Cells,
}

/// Why an area cannot be had.
#[derive(Debug, Clone, PartialEq)]
pub enum AreaError {
    /// A corner is not a finite number, or the rectangle is inside out.
    Rectangle {
        /// Least x and z.
        low: DVec2,
        /// Greatest x and z.
        high: DVec2,
    },
}

/// Where a segment meets the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceHit {
    /// Fraction of the way from the segment's start to its end, 0..=1.
    pub fraction: f64,
    /// The point, on the segment.
    pub point: DVec3,
    /// Upward unit normal of the triangle.
    pub normal: DVec3,
}

impl fmt::Display for AreaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rectangle { low, high } => {
                write!(f, "an area needs finite corners, low before high; got {low} and {high}")
            }
        }
    }
}

impl std::error::Error for AreaError {}

impl Ground {
    /// The ground of a field; builds its pyramid.
    pub fn new(field: Arc<Field>) -> Self {
        let pyramid = Arc::new(Pyramid::new(&field));
        Self { field, pyramid }
    }

    /// The next version of the ground ([`Field::edited`]) and what it changed.
    ///
    /// # Errors
    /// [`EditError`] says which edit cannot be made; none is then.
    pub fn edited(&self, edits: &[Edit]) -> Result<(Self, Changed), EditError> {
        let (field, changed) = self.field.edited(edits)?;
        let pyramid = Arc::new(self.pyramid.edited(&field, &changed));
        Ok((Self { field: Arc::new(field), pyramid }, changed))
    }

    /// Counts the edits that made it, from 0.
    pub fn version(&self) -> u32 {
        self.field.version()
    }

    /// The part of the ground over the plan rectangle (x, z) from `low` to `high`, metres.
    ///
    /// Where posts are fetched from afar this may wait or fail; with all posts in memory the area is the whole world.
    ///
    /// # Errors
    /// [`AreaError::Rectangle`] if a corner is not finite or the rectangle is inside out.
    pub fn area(&self, low: DVec2, high: DVec2) -> Result<Area, AreaError> {
        if !low.is_finite() || !high.is_finite() || low.x > high.x || low.y > high.y {
            return Err(AreaError::Rectangle { low, high });
        }
        Ok(self.whole())
    }

    /// All of the ground.
    pub fn whole(&self) -> Area {
        Area { field: self.field.clone(), pyramid: self.pyramid.clone(), cells: Cells::of(self.field.grid()) }
    }

    /// The posts.
    pub fn field(&self) -> &Arc<Field> {
        &self.field
    }

    /// The ranges of height.
    pub fn pyramid(&self) -> &Arc<Pyramid> {
        &self.pyramid
    }
}

/// A plan point in its cell: column and row, and how far east and south in it, 0..=1.
#[derive(Clone, Copy)]
struct InCell {
    column: usize,
    row: usize,
    east: f64,
    south: f64,
}

/// What a height needs of the grid, ready as floats. They are not made from the whole numbers at each query: the
/// processor's conversion waits for what its target register last held, which is the post before, so that no two
/// queries would overlap.
#[derive(Debug, Clone, Copy)]
struct Cells {
    west_m: f64,
    north_m: f64,
    step_m: f64,
    /// Number of cells from west to east and from north to south.
    across: f64,
    down: f64,
    last_column: u32,
    last_row: u32,
}

impl Cells {
    fn of(grid: &Grid) -> Self {
        let (across, down) = (grid.columns() - 1, grid.rows() - 1);
        Self {
            west_m: grid.west_m,
            north_m: grid.north_m,
            step_m: grid.step_m,
            across: f64::from(across),
            down: f64::from(down),
            last_column: across - 1,
            last_row: down - 1,
        }
    }
}

impl InCell {
    /// `None` outside the grid, or if a number is NaN.
    #[inline(always)]
    fn of(cells: &Cells, x_m: f64, z_m: f64) -> Option<Self> {
        // A division, not a product with the inverse: at a post it is exact.
        let (u, v) = ((x_m - cells.west_m) / cells.step_m, (z_m - cells.north_m) / cells.step_m);
        if !(u >= 0.0 && u <= cells.across && v >= 0.0 && v <= cells.down) {
            return None;
        }
        // The last post belongs to the last cell.
        let (column, row) = ((u as u32).min(cells.last_column), (v as u32).min(cells.last_row));
        let (east, south) = (u - float(column), v - float(row));
        Some(Self { column: column as usize, row: row as usize, east, south })
    }
}

/// The number as a float, by its bits over those of 2^52: as exact as the processor's conversion, and waits for nothing
/// (see [`Cells`]).
#[inline(always)]
fn float(whole: u32) -> f64 {
    const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
    f64::from_bits(TWO_TO_52.to_bits() | u64::from(whole)) - TWO_TO_52
}

/// Heights of a cell's posts: north-west, north-east, south-west, south-east.
type Cell = [f64; 4];

/// Height over a point of the cell. NaN if the point's triangle has a void corner.
#[inline(always)]
fn height_in_cell([nw, ne, sw, se]: Cell, east: f64, south: f64) -> f64 {
    let north_west = nw + east * (ne - nw) + south * (sw - nw);
    let south_east = se + (1.0 - east) * (sw - se) + (1.0 - south) * (ne - se);
    // Which half is a coin toss: a branch would be guessed wrong every other time, and every guess stops the next
    // answers from fetching their posts meanwhile.
    select_unpredictable(east + south <= 1.0, north_west, south_east)
}

/// Upward unit normal of the cell's triangle: the north-western or the south-eastern.
fn normal_in_cell([nw, ne, sw, se]: Cell, north_west: bool, step_m: f64) -> DVec3 {
    let (rise_east, rise_south) = if north_west { (ne - nw, sw - nw) } else { (se - sw, se - ne) };
    DVec3::new(-rise_east, step_m, -rise_south).normalize()
}

impl Area {
    /// The same part of the next version of the ground ([`Field::edited`]) and what it changed.
    ///
    /// # Errors
    /// [`EditError`] says which edit cannot be made; none is then.
    pub fn edited(&self, edits: &[Edit]) -> Result<(Self, Changed), EditError> {
        let ground = Ground { field: self.field.clone(), pyramid: self.pyramid.clone() };
        ground.edited(edits).map(|(ground, changed)| (ground.whole(), changed))
    }

    /// Where the posts lie.
    pub fn grid(&self) -> &Grid {
        self.field.grid()
    }

    /// The posts.
    pub fn field(&self) -> &Field {
        &self.field
    }

    #[inline(always)]
    fn cell(&self, column: usize, row: usize) -> Cell {
        self.field.cell_m(column, row).map(f64::from)
    }

    /// Ground height over a plan point, metres above mean sea level; `None` over void and beyond the world.
    ///
    /// Exact at posts; between them it lies on the triangle under the point, to f64 rounding.
    #[inline]
    pub fn height_m(&self, x_m: f64, z_m: f64) -> Option<f64> {
        let at = InCell::of(&self.cells, x_m, z_m)?;
        let height = height_in_cell(self.cell(at.column, at.row), at.east, at.south);
        if height.is_nan() { self.beside_void(x_m, z_m).map(|(h, _)| h) } else { Some(height) }
    }

    /// Ground heights over many points (x, z); NaN where [`Self::height_m`] has `None`. Takes as many as both slices hold.
    ///
    /// Works in groups whose posts are asked for together, so that a core waits for memory once a group, not once a point.
    pub fn heights_m(&self, points: &[DVec2], heights_m: &mut [f64]) {
        const GROUP: usize = 16;
        let outside = InCell { column: 0, row: 0, east: f64::NAN, south: f64::NAN };
        for (points, heights) in points.chunks(GROUP).zip(heights_m.chunks_mut(GROUP)) {
            let mut places = [outside; GROUP];
            for (place, p) in places.iter_mut().zip(points) {
                *place = InCell::of(&self.cells, p.x, p.y).unwrap_or(outside);
            }
            let mut cells = [[0.0; 4]; GROUP];
            for (cell, place) in cells.iter_mut().zip(&places).take(points.len()) {
                *cell = self.cell(place.column, place.row);
            }
            for (((height, cell), place), p) in heights.iter_mut().zip(&cells).zip(&places).zip(points) {
                *height = height_in_cell(*cell, place.east, place.south);
                if height.is_nan() && !place.east.is_nan() {
                    *height = self.beside_void(p.x, p.y).map_or(f64::NAN, |(h, _)| h);
                }
            }
        }
    }

    /// Ground height and upward unit normal over a plan point; `None` over void and beyond the world.
    pub fn height_and_normal(&self, x_m: f64, z_m: f64) -> Option<(f64, DVec3)> {
        let at = InCell::of(&self.cells, x_m, z_m)?;
        let cell = self.cell(at.column, at.row);
        let height = height_in_cell(cell, at.east, at.south);
        if height.is_nan() {
            return self.beside_void(x_m, z_m);
        }
        Some((height, normal_in_cell(cell, at.east + at.south <= 1.0, self.field.grid().step_m)))
    }

    /// For a point on the rim of a void: the triangle with data that has it on an edge or corner, if there is one.
    fn beside_void(&self, x_m: f64, z_m: f64) -> Option<(f64, DVec3)> {
        let grid = self.field.grid();
        let at = InCell::of(&self.cells, x_m, z_m)?;
        for row in [at.row as i64, at.row as i64 - 1, at.row as i64 + 1] {
            for column in [at.column as i64, at.column as i64 - 1, at.column as i64 + 1] {
                let inside = (0..i64::from(grid.columns() - 1)).contains(&column)
                    && (0..i64::from(grid.rows() - 1)).contains(&row);
                let east = at.east + (at.column as i64 - column) as f64;
                let south = at.south + (at.row as i64 - row) as f64;
                if !inside || !(0.0..=1.0).contains(&east) || !(0.0..=1.0).contains(&south) {
                    continue;
                }
                let cell @ [nw, ne, sw, se] = self.cell(column as usize, row as usize);
                let north_west = nw + east * (ne - nw) + south * (sw - nw);
                if east + south <= 1.0 && north_west.is_finite() {
                    return Some((north_west, normal_in_cell(cell, true, grid.step_m)));
                }
                let south_east = se + (1.0 - east) * (sw - se) + (1.0 - south) * (ne - se);
                if east + south >= 1.0 && south_east.is_finite() {
                    return Some((south_east, normal_in_cell(cell, false, grid.step_m)));
                }
            }
        }
        None
    }

    /// Where the segment from `from` to `to` first meets the ground; `None` if it stays above it, or over void.
    ///
    /// A segment that starts on or under the ground meets it at fraction 0. A segment with a coordinate that is not
    /// finite meets nothing.
    pub fn segment(&self, from: DVec3, to: DVec3) -> Option<SurfaceHit> {
        if !from.is_finite() || !to.is_finite() {
            return None;
        }
        let mut march = March::new(&self.field, from, to)?;
        let fraction = loop {
            match march.level {
                0 => match self.cross_cell(&march) {
                    Some(fraction) => break fraction,
                    None => {
                        if !march.step_cell() {
                            return None;
                        }
                    }
                },
                level => {
                    let (column, row) = (march.column as u32, march.row as u32);
                    let (exit, cross) = march.exit(level);
                    let lowest = march.height_m(march.at).min(march.height_m(exit));
                    if lowest > f64::from(self.pyramid.node(level, column, row).greatest_m) {
                        if !march.leave(level, exit, cross) {
                            return None;
                        }
                        // The next node's parent is only worth a look where the march has entered it.
                        march.level = (level + 1).min(self.pyramid.top()).min(march.aligned());
                    } else {
                        march.level = if level > pyramid::BASE { level - 1 } else { 0 };
                    }
                }
            }
        };
        let point = from + (to - from) * fraction;
        // The normal of the triangle the march was in: its own cell, the half that holds the point.
        let cell = self.cell(march.column as usize, march.row as usize);
        let (east, south) = march.local(fraction);
        let grid = self.field.grid();
        let own = normal_in_cell(cell, east + south <= 1.0, grid.step_m);
        let normal = if own.is_finite() {
            own
        } else {
            // On the rim of a void: a triangle beside it was met. The nearest point of the grid is the point itself.
            let x_m = point.x.clamp(grid.west_m, grid.east_m());
            let z_m = point.z.clamp(grid.north_m, grid.south_m());
            self.beside_void(x_m, z_m).map_or(DVec3::Y, |(_, normal)| normal)
        };
        Some(SurfaceHit { fraction, point, normal })
    }

    /// First parameter in the march's cell where the segment is on or under one of its two triangles.
    #[inline]
    fn cross_cell(&self, march: &March) -> Option<f64> {
        let cell @ [nw, ne, sw, se] = self.cell(march.column as usize, march.row as usize);
        let (enter, (exit, _)) = (march.at, march.exit(0));
        let (enter_m, exit_m) = (march.height_m(enter), march.height_m(exit));
        // max ignores NaN, so a void corner counts for nothing here.
        if enter_m.min(exit_m) > nw.max(ne).max(sw.max(se)) {
            return None;
        }
        if (nw + ne + sw + se).is_nan() {
            return self.cross_rim(march, enter, exit);
        }
        let (u0, v0) = march.local(enter);
        let (u1, v1) = march.local(exit);
        let (side0, side1) = (u0 + v0 - 1.0, u1 + v1 - 1.0);
        if (side0 < 0.0) != (side1 < 0.0) && side0 != side1 {
            let middle = (enter + (exit - enter) * (side0 / (side0 - side1))).clamp(enter, exit);
            self.cross_triangle(cell, march, side0 < 0.0, enter, middle)
                .or_else(|| self.cross_triangle(cell, march, side1 < 0.0, middle, exit))
        } else {
            // On the diagonal all along, both halves hold the segment.
            let north_west = side0 + side1 <= 0.0;
            self.cross_triangle(cell, march, north_west, enter, exit).or_else(|| {
                (side0 == 0.0 && side1 == 0.0)
                    .then(|| self.cross_triangle(cell, march, !north_west, enter, exit))
                    .flatten()
            })
        }
    }

    /// [`Self::cross_cell`] for a cell with a void corner: a segment on its rim may only touch triangles of the cells
    /// around it, so all their triangles are tried, edges included.
    #[cold]
    fn cross_rim(&self, march: &March, enter: f64, exit: f64) -> Option<f64> {
        let mut first: Option<f64> = None;
        for row in (march.row - 1).max(0)..=(march.row + 1).min(march.cells_z - 1) {
            for column in (march.column - 1).max(0)..=(march.column + 1).min(march.cells_x - 1) {
                let here = March { column, row, ..*march };
                let cell = self.cell(column as usize, row as usize);
                for north_west in [true, false] {
                    // Signed distances to the triangle's three edges at both ends; inside where none is negative.
                    let edges = |t: f64| {
                        let (u, v) = here.local(t);
                        let half = if north_west { 1.0 - u - v } else { u + v - 1.0 };
                        if north_west { [u, v, half] } else { [1.0 - u, 1.0 - v, half] }
                    };
                    let (mut a, mut b) = (enter, exit);
                    for (d0, d1) in edges(enter).into_iter().zip(edges(exit)) {
                        let line = enter + (exit - enter) * (d0 / (d0 - d1));
                        match (d0 < 0.0, d1 < 0.0) {
                            (true, true) => (a, b) = (1.0, 0.0),
                            (true, false) => a = a.max(line),
                            (false, true) => b = b.min(line),
                            (false, false) => {}
                        }
                    }
                    if a <= b
                        && let Some(hit) = self.cross_triangle(cell, &here, north_west, a, b)
                    {
                        first = Some(first.map_or(hit, |f| f.min(hit)));
                    }
                }
            }
        }
        first
    }

    /// First parameter within `enter..=exit` where the segment is on or under the plane of one half of the cell.
    #[inline]
    fn cross_triangle(&self, cell: Cell, march: &March, north_west: bool, enter: f64, exit: f64) -> Option<f64> {
        let [nw, ne, sw, se] = cell;
        let gap = |t: f64| {
            let (u, v) = march.local(t);
            let ground = if north_west {
                nw + u * (ne - nw) + v * (sw - nw)
            } else {
                se + (1.0 - u) * (sw - se) + (1.0 - v) * (ne - se)
            };
            march.height_m(t) - ground
        };
        let gap_in = gap(enter);
        if gap_in <= 0.0 {
            return Some(enter);
        }
        let gap_out = gap(exit);
        (gap_out <= 0.0).then(|| (enter + (exit - enter) * (gap_in / (gap_in - gap_out))).clamp(enter, exit))
    }
}

/// A segment on its way through the cells, in cell units, with whole-number cells so that it can neither skip nor stall.
#[derive(Clone, Copy)]
struct March {
    start: DVec3,
    along: DVec3,
    /// 1 / `along`, infinite where it is 0.
    inverse: DVec2,
    at: f64,
    end: f64,
    column: i64,
    row: i64,
    cells_x: i64,
    cells_z: i64,
    /// 0: cell by cell; otherwise the pyramid's level to try next.
    level: u32,
}

/// Which cell lines an exit lies on.
#[derive(Clone, Copy)]
struct Crosses {
    x: bool,
    z: bool,
}

impl March {
    /// `None` if the segment does not pass over the grid.
    #[inline]
    fn new(field: &Field, from: DVec3, to: DVec3) -> Option<Self> {
        let grid = field.grid();
        let start = DVec3::new((from.x - grid.west_m) / grid.step_m, from.y, (from.z - grid.north_m) / grid.step_m);
        let end = DVec3::new((to.x - grid.west_m) / grid.step_m, to.y, (to.z - grid.north_m) / grid.step_m);
        let along = end - start;
        let (cells_x, cells_z) = (i64::from(grid.columns() - 1), i64::from(grid.rows() - 1));
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for (s, d, cells) in [(start.x, along.x, cells_x), (start.z, along.z, cells_z)] {
            let cells = cells as f64;
            if d == 0.0 {
                if !(0.0..=cells).contains(&s) {
                    return None;
                }
            } else {
                let (a, b) = ((0.0 - s) / d, (cells - s) / d);
                first = first.max(a.min(b));
                last = last.min(a.max(b));
            }
        }
        if first > last {
            return None;
        }
        let place = |s: f64, d: f64, cells: i64| ((s + d * first).floor() as i64).clamp(0, cells - 1);
        let mut march = Self {
            start,
            along,
            inverse: DVec2::new(1.0 / along.x, 1.0 / along.z),
            at: first,
            end: last,
            column: place(start.x, along.x, cells_x),
            row: place(start.z, along.z, cells_z),
            cells_x,
            cells_z,
            level: 0,
        };
        // A start on a cell line belongs to the cell that the segment goes into.
        if along.x < 0.0 && march.column > 0 && start.x + along.x * first == march.column as f64 {
            march.column -= 1;
        }
        if along.z < 0.0 && march.row > 0 && start.z + along.z * first == march.row as f64 {
            march.row -= 1;
        }
        let cells_crossed = ((last - first) * along.x.abs().max(along.z.abs())) as u32;
        // Short segments go straight to the cells; long ones begin where a node is about a quarter of their length.
        if cells_crossed >= 8 {
            march.level = (cells_crossed.ilog2().saturating_sub(2)).max(pyramid::BASE);
            let top = (cells_x.max(cells_z) as u64).next_power_of_two().ilog2().max(pyramid::BASE);
            march.level = march.level.min(top);
        }
        Some(march)
    }

    #[inline(always)]
    fn height_m(&self, t: f64) -> f64 {
        self.start.y + self.along.y * t
    }

    /// East and south of the north-west corner of the current cell, in cells.
    #[inline(always)]
    fn local(&self, t: f64) -> (f64, f64) {
        (self.start.x + self.along.x * t - self.column as f64, self.start.z + self.along.z * t - self.row as f64)
    }

    /// Parameter where the segment leaves the node of a level (0: the cell), and over which lines.
    #[inline(always)]
    fn exit(&self, level: u32) -> (f64, Crosses) {
        let line = |place: i64, d: f64| {
            let node = place >> level;
            (if d > 0.0 { node + 1 } else { node } << level) as f64
        };
        let to_x = if self.along.x == 0.0 {
            f64::INFINITY
        } else {
            (line(self.column, self.along.x) - self.start.x) * self.inverse.x
        };
        let to_z = if self.along.z == 0.0 {
            f64::INFINITY
        } else {
            (line(self.row, self.along.z) - self.start.z) * self.inverse.y
        };
        let exit = to_x.min(to_z);
        if exit >= self.end {
            // The segment's own end; a line that lies there is not crossed.
            return (self.end, Crosses { x: false, z: false });
        }
        (exit.max(self.at), Crosses { x: to_x <= to_z, z: to_z <= to_x })
    }

    /// Moves on to the next cell; `false` at the segment's end.
    #[inline(always)]
    fn step_cell(&mut self) -> bool {
        let (exit, cross) = self.exit(0);
        let (column, row) = (self.column, self.row);
        if !self.leave(0, exit, cross) {
            return false;
        }
        // Out of a node of the base level: try to skip the next one.
        if (column ^ self.column) >> pyramid::BASE != 0 || (row ^ self.row) >> pyramid::BASE != 0 {
            self.level = pyramid::BASE;
        }
        true
    }

    /// Moves to the cell behind the exit of a node; `false` at the segment's or the grid's end.
    #[inline(always)]
    fn leave(&mut self, level: u32, exit: f64, cross: Crosses) -> bool {
        if !cross.x && !cross.z {
            return false;
        }
        let side = 1i64 << level;
        let beyond = |place: i64, d: f64| {
            if d > 0.0 { ((place >> level) << level) + side } else { ((place >> level) << level) - 1 }
        };
        // Along the line not crossed the cell is read off the point, but may not leave the node.
        let within = |place: i64, s: f64, d: f64| {
            let low = (place >> level) << level;
            ((s + d * exit).floor() as i64).clamp(low, low + side - 1)
        };
        self.column = if cross.x {
            beyond(self.column, self.along.x)
        } else {
            within(self.column, self.start.x, self.along.x).min(self.cells_x - 1)
        };
        self.row = if cross.z {
            beyond(self.row, self.along.z)
        } else {
            within(self.row, self.start.z, self.along.z).min(self.cells_z - 1)
        };
        self.at = exit;
        (0..self.cells_x).contains(&self.column) && (0..self.cells_z).contains(&self.row)
    }

    /// The coarsest level of which the current cell is just being entered.
    #[inline(always)]
    fn aligned(&self) -> u32 {
        let free = |place: i64, d: f64| {
            if d > 0.0 {
                place.trailing_zeros()
            } else if d < 0.0 {
                (place + 1).trailing_zeros()
            } else {
                63
            }
        };
        free(self.column, self.along.x).max(free(self.row, self.along.z)).clamp(pyramid::BASE, 31)
    }
}

#[cfg(test)]
mod tests;
