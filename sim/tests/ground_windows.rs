//! A window for rigid bodies is the ground: every triangle of a thousand windows, on the embedded world and on made ones.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use sim::SceneGround;
use sim::loose::{WINDOW_CELLS, Window, middle_for};
use std::sync::Arc;
use terrain::{Area, Field, Grid, Ground, synthetic};

const SEED_WINDOWS: u64 = 20_261_127;
const WINDOWS: u32 = 1_000;

/// What was found of a window: triangles that are there, and cells with one missing.
#[derive(Debug, Default)]
struct Found {
    present: u64,
    missing: u64,
    beyond_edge: u64,
}

/// Compares every triangle of the window about a place with the ground's.
fn compare(area: &Area, x_m: f64, z_m: f64, found: &mut Found) {
    let ground = SceneGround::from(area.clone());
    let (field, grid) = (area.field(), *area.grid());
    let window = Window::new(&ground, middle_for(&ground, x_m, z_m));
    let half = i64::from(WINDOW_CELLS / 2);
    let first = (window.middle.0 - half, window.middle.1 - half);
    for row in 0..WINDOW_CELLS {
        for column in 0..WINDOW_CELLS {
            let theirs = window.field.as_ref().map(|field| field.triangles_at(row as usize, column as usize));
            let theirs = theirs.map_or([None, None], |(north_west, south_east)| [north_west, south_east]);
            let (world_column, world_row) = (first.0 + i64::from(column), first.1 + i64::from(row));
            let inside = (0..i64::from(grid.columns()) - 1).contains(&world_column)
                && (0..i64::from(grid.rows()) - 1).contains(&world_row);
            let ours = if inside { field.cell_triangles(world_column as u32, world_row as u32) } else { [None, None] };
            found.beyond_edge += u64::from(!inside);
            for (theirs, ours) in theirs.into_iter().zip(ours) {
                assert_eq!(theirs.is_some(), ours.is_some(), "cell {world_column}, {world_row}");
                let (Some(theirs), Some(ours)) = (theirs, ours) else {
                    found.missing += u64::from(inside);
                    continue;
                };
                found.present += 1;
                for (a, b) in [theirs.a, theirs.b, theirs.c].into_iter().zip(ours.corners) {
                    assert_eq!(a.y.to_bits(), b.y.to_bits(), "cell {world_column}, {world_row}");
                    let (x_m, z_m) = (a.x + window.middle_m.x, a.z + window.middle_m.y);
                    // Asked: 1e-9 m. Some roundings of coordinates below 2^18 m are 2^-34 m, a sixteenth of it.
                    assert!((x_m - b.x).abs() < 1e-9 && (z_m - b.z).abs() < 1e-9, "{x_m} {z_m} {b}");
                }
            }
        }
    }
}

/// Windows at random places of a world and up to 20 posts beyond its edge.
fn sweep(field: Field, windows: u32, random: &mut StdRng, found: &mut Found) {
    let area = Ground::new(Arc::new(field)).whole();
    let grid = *area.grid();
    let over_m = 20.0 * grid.step_m;
    for _ in 0..windows {
        let x_m = random.random_range(grid.west_m - over_m..grid.east_m() + over_m);
        let z_m = random.random_range(grid.north_m - over_m..grid.south_m() + over_m);
        compare(&area, x_m, z_m, found);
    }
}

#[test]
fn every_triangle_of_a_thousand_windows_is_the_grounds() {
    let mut random = StdRng::seed_from_u64(SEED_WINDOWS);
    let mut found = Found::default();
    let world = terrain::bake::default_world(&mut |_, _| {}).unwrap().world;
    sweep((*world.field).clone(), 400, &mut random, &mut found);
    // Steps that are no binary fractions, a tenth of the posts void, and a grid whose far corner is 204 km out.
    for (step_m, blocks_x, blocks_z, windows) in
        [(25.0, 9, 5, 200), (33.3, 4, 7, 200), (400.0, 34, 34, 100), (1.7, 3, 3, 100)]
    {
        let grid = Grid::centred(step_m, blocks_x, blocks_z).unwrap();
        let mut post = || if random.random_bool(0.1) { f32::NAN } else { random.random_range(-430.0f32..8_850.0) };
        let field = synthetic::from_fn(grid, |_, _| post());
        sweep(field, windows, &mut random, &mut found);
    }
    // 4,096 cells a window, two triangles each, of which a quarter or so lie beyond an edge and some are void.
    assert!(found.present > 3_000_000 && found.missing > 200_000 && found.beyond_edge > 300_000, "{found:?}");
    println!("{WINDOWS} windows: {found:?}");
}

#[test]
fn a_place_is_well_within_its_window_and_moves_to_another_by_whole_posts() {
    let grid = Grid::centred(25.0, 6, 6).unwrap();
    let ground = SceneGround::from(Ground::new(Arc::new(synthetic::flat(grid, 0.0))).whole());
    let (mut last, mut moves) = (middle_for(&ground, -2_000.0, 0.0), 0);
    for step in 0..40_000 {
        let x_m = -2_000.0 + 0.1 * f64::from(step);
        let middle = middle_for(&ground, x_m, 0.0);
        let off = (x_m - grid.x_m(middle.0)).abs() / grid.step_m;
        assert!(off <= f64::from(WINDOW_CELLS) / 8.0, "{off} cells from the middle");
        if middle != last {
            assert_eq!(middle.0 - last.0, i64::from(WINDOW_CELLS) / 4);
            moves += 1;
        }
        last = middle;
    }
    assert_eq!(moves, 10, "4,000 m in moves of 16 posts of 25 m");
}
