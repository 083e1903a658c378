//! Windows on the ground: squares of [`WINDOW_CELLS`] cells of the world's own posts, for rigid bodies to lie on.
//!
//! A window's middle is a post whose column and row are multiples of a quarter of its side, the nearest to the place asked
//! for; so a place is never nearer to a window's edge than three eighths of its side, and which window it has follows from
//! the place alone. Coordinates in a window count from its middle post, at the height of the sea: small numbers, whatever
//! the world's size. Heights are the world's. World frame: X east, Y up, Z south, metres.
//!
//! A ground without posts (a function, as tests have it) is looked at every [`LOOK_M`] metres.
//!
//! Invariant others rely on: a window's triangles are the ground's cells there, heights to the bit, with the same ones
//! missing over void and beyond the world's edge; it is made anew when the ground is another.

use crate::ground_contact::height_field;
use crate::scene::{LOOK_M, SceneGround};
use glam::DVec2;
use rapier3d::parry::shape::{HeightField, SharedShape};
use std::sync::Arc;
use terrain::PostRect;

/// Cells along a window's side.
pub const WINDOW_CELLS: u32 = 64;
/// Posts from one window's middle to the next.
const SHIFT: i64 = WINDOW_CELLS as i64 / 4;
/// Windows kept for places that come back to them; 38 KB each. More places than that make theirs anew each step.
const MOST_KEPT: usize = 64;

/// Column and row of the post in a window's middle.
pub type Middle = (i64, i64);

/// A square of the ground.
#[derive(Debug, Clone)]
pub struct Window {
    /// Its middle post.
    pub middle: Middle,
    /// Plan position of the middle post, metres.
    pub middle_m: DVec2,
    /// Its triangles about the middle post; `None` where all is void.
    pub field: Option<Arc<HeightField>>,
}

/// Where the posts of a ground lie.
#[derive(Debug, Clone, Copy)]
struct Lattice {
    west_m: f64,
    north_m: f64,
    step_m: f64,
}

impl Lattice {
    fn of(ground: &SceneGround) -> Self {
        match ground.area().map(|area| area.grid()) {
            Some(grid) => Self { west_m: grid.west_m, north_m: grid.north_m, step_m: grid.step_m },
            None => Self { west_m: 0.0, north_m: 0.0, step_m: LOOK_M },
        }
    }

    // As `Grid::x_m` has it: one rounding.
    fn x_m(&self, column: i64) -> f64 {
        self.west_m + column as f64 * self.step_m
    }

    fn z_m(&self, row: i64) -> f64 {
        self.north_m + row as f64 * self.step_m
    }
}

/// The middle of the window for a place in plan (x, z).
pub fn middle_for(ground: &SceneGround, x_m: f64, z_m: f64) -> Middle {
    let lattice = Lattice::of(ground);
    let nearest = |posts: f64| (posts / SHIFT as f64).round() as i64 * SHIFT;
    (nearest((x_m - lattice.west_m) / lattice.step_m), nearest((z_m - lattice.north_m) / lattice.step_m))
}

impl Window {
    /// The window about a middle post.
    pub fn new(ground: &SceneGround, middle: Middle) -> Self {
        let lattice = Lattice::of(ground);
        let half = i64::from(WINDOW_CELLS / 2);
        let (column, row, side) = (middle.0 - half, middle.1 - half, WINDOW_CELLS + 1);
        let posts_m = match ground.area() {
            Some(area) => area.field().read(PostRect { column, row, columns: side, rows: side }),
            None => (row..row + i64::from(side))
                .flat_map(|row| (column..column + i64::from(side)).map(move |column| (column, row)))
                .map(|(column, row)| ground.height_m(lattice.x_m(column), lattice.z_m(row)))
                .map(|height_m| height_m.map_or(f32::NAN, |height_m| height_m as f32))
                .collect(),
        };
        Self {
            middle,
            middle_m: DVec2::new(lattice.x_m(middle.0), lattice.z_m(middle.1)),
            // Posts of a world are finite or void: what fails is a window that is void all over.
            field: height_field(&posts_m, side, side, lattice.step_m).ok().map(Arc::new),
        }
    }

    /// Its shape for the physics engine.
    pub(super) fn collider(&self) -> Option<SharedShape> {
        self.field.clone().map(|field| SharedShape(field))
    }
}

/// The windows made so far of one version of the ground. What is kept changes no answer.
#[derive(Debug, Default)]
pub(super) struct Windows {
    ground: Option<SceneGround>,
    made: Vec<Window>,
}

impl Windows {
    /// The window about a middle post.
    pub fn about(&mut self, ground: &SceneGround, middle: Middle) -> Window {
        if !self.ground.as_ref().is_some_and(|known| known.is_same_surface(ground)) {
            (self.ground, self.made) = (Some(ground.clone()), Vec::new());
        }
        if let Some(window) = self.made.iter().find(|window| window.middle == middle) {
            return window.clone();
        }
        if self.made.len() >= MOST_KEPT {
            self.made.remove(0);
        }
        let window = Window::new(ground, middle);
        self.made.push(window.clone());
        window
    }

    /// Drops all.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
}
