//! No T-junction in any combination of templates, blocks and masks, and shared vertices equal to the bit.
//!
//! The enumeration covers all there is: a template depends on its own sub-block and the four beside it, so all states of
//! those are all pairs of neighbours. Whole windows over made-up worlds at the extremes follow, and each check is shown
//! to fail on a mesh that is wrong.

use glam::DVec3;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;
use terrain::block::mask::{Mask, SUBS};
use terrain::block::payload::tile_heights_m;
use terrain::block::{Landscape, Rings, ground_map::Climate, mesh, template};
use terrain::verify::cracks::{self, Cracks, Sheet, Side};
use terrain::verify::flight::Piece;
use terrain::{BlockIndex, Field, Grid, synthetic};
use visual::passes::terrain::eye_uniforms;

fn landscape(field: Field, rings: &Rings) -> Landscape {
    Landscape::bare(Arc::new(field), rings.limits_m, Climate::new(0.7, 1_000.0))
}

#[test]
fn every_template_fits_every_neighbour_that_it_can_have_inside_a_block() {
    let (found, met) = cracks::templates();
    assert_eq!((found.t_junctions, found.position_mismatches), (0, 0));
    for side in Side::ALL {
        // Both coarse: 8 x 8 without the midpoint; one fine: 8 with it, twice; both fine.
        assert_eq!(met.iter().filter(|(_, s, _)| *s == side).count(), 64 + 8 + 8 + 1, "{side:?}");
    }
    // Every place, side and state: two sub-blocks and up to six beside them.
    assert!(found.edges > 4 * 13 * 13 * 256, "{}", found.edges);
}

#[test]
fn every_state_of_a_block_s_border_fits_every_other_s() {
    let (found, met) = cracks::pairs();
    assert_eq!((found.t_junctions, found.position_mismatches), (0, 0));
    for side in Side::ALL {
        // Eight templates with the border's midpoint and the fine one, on either side.
        assert_eq!(met.iter().filter(|(_, s, _)| *s == side).count(), 9 * 9, "{side:?}");
    }
    assert!(found.edges > 4 * 13 * 256, "{}", found.edges);
}

#[test]
fn of_all_pairs_of_templates_those_fit_whose_midpoints_agree_and_no_others_ever_meet() {
    let (inside, across) = (cracks::templates().1, cracks::pairs().1);
    let bit = |side: Side| match side {
        Side::North => template::NORTH,
        Side::East => template::EAST,
        Side::South => template::SOUTH,
        Side::West => template::WEST,
    };
    let cut = |template: usize, side: Side| template == template::FINE || template & bit(side) != 0;
    let mut misfits = 0;
    for here in 0..=template::FINE {
        for there in 0..=template::FINE {
            for side in Side::ALL {
                let agree = cut(here, side) == cut(there, side.opposite());
                assert_eq!(cracks::fit(here, side, there), agree, "{here} {side:?} {there}");
                let pair = (here, side, there);
                assert_eq!(agree, inside.contains(&pair) || across.contains(&pair), "{here} {side:?} {there}");
                misfits += u32::from(!agree);
            }
        }
    }
    // 9 templates with a midpoint and 8 without, both ways, on four sides: the check can fail.
    assert_eq!(misfits, 4 * 2 * 9 * 8);
}

#[test]
fn whole_blocks_with_random_masks_fit() {
    let grid = Grid::centred(200.0, 2, 2).unwrap();
    let field = synthetic::rough(grid, 9, 500.0);
    let mut rng = StdRng::seed_from_u64(4);
    let origin = BlockIndex { x: 0, z: 0 };
    for round in 0..300 {
        let mut sheet = Sheet::new(&field, origin, 2, DVec3::new(123.4, 567.8, -2_345.6), eye_uniforms);
        let share = f64::from(round % 10) / 9.0;
        for block in grid.blocks() {
            let mut mask = Mask::NONE;
            for at in 0..SUBS * SUBS {
                if rng.random_bool(share) {
                    mask.set_fine(at % SUBS, at / SUBS);
                }
            }
            let heights_m = tile_heights_m(&field, block);
            sheet.add(Piece { block, indices: &mesh::indices(&mask, None), heights_m: &heights_m });
        }
        let found = sheet.check();
        assert_eq!((found.t_junctions, found.position_mismatches), (0, 0), "round {round}");
    }
}

/// Worlds at the extremes, each with the eyes' windows all over it.
#[test]
fn windows_over_extreme_worlds_have_no_crack() {
    let grid = |blocks_x, blocks_z| Grid::centred(200.0, blocks_x, blocks_z).unwrap();
    let holes = |column: u32, row: u32| {
        let (x, z) = (f64::from(column) - 290.0, f64::from(row) - 310.0);
        // A ring of void, a void column, single void posts on a block's border.
        let ring = (60.0..75.0).contains(&x.hypot(z));
        ring || (column == 300 && row > 100) || (row.is_multiple_of(30) && column.is_multiple_of(17))
    };
    let ridged = synthetic::ridges(grid(20, 20), 5);
    let columns = ridged.grid().columns();
    let worlds = [
        ("ridges", ridged.clone()),
        ("noise", synthetic::rough(grid(14, 14), 1, 300.0)),
        ("flat sea", synthetic::flat(grid(14, 14), 0.0)),
        ("spike of 9 km", synthetic::spike(grid(14, 14), 215, 210, 9_000.0)),
        ("cliff of 10 km", synthetic::cliff(grid(14, 14), 209, 10_000.0)),
        ("one block", synthetic::ridges(grid(1, 1), 2)),
        ("a strip smaller than a window", synthetic::ridges(grid(3, 20), 3)),
        (
            "holes",
            synthetic::from_fn(*ridged.grid(), |column, row| {
                if holes(column, row) { f32::NAN } else { ridged.heights_m()[(row * columns + column) as usize] }
            }),
        ),
        ("all void", synthetic::from_fn(grid(2, 2), |_, _| f32::NAN)),
    ];
    let rings = Rings::with_near_radius(6_000.0, 1.0);
    let mut rng = StdRng::seed_from_u64(8);
    for (name, field) in worlds {
        let landscape = landscape(field, &rings);
        let grid = *landscape.ground.field().grid();
        for _ in 0..12 {
            let mut at = |low: f64, high: f64| rng.random_range(low - 9_000.0..high + 9_000.0);
            let eye_m = DVec3::new(at(grid.west_m, grid.east_m()), at(0.0, 5_000.0), at(grid.north_m, grid.south_m()));
            let found = cracks::window(&landscape, &rings, 12, eye_m, eye_uniforms);
            assert_eq!((found.t_junctions, found.position_mismatches), (0, 0), "{name} from {eye_m}");
            assert!(name == "all void" || name == "one block" || found.edges > 10_000, "{name}: {found:?}");
        }
    }
}

/// Two blocks of noise, one of them drawn with `spoil`ed triangles and heights.
fn spoiled(spoil: impl Fn(&mut Vec<u16>, &mut [f32])) -> Cracks {
    let grid = Grid::centred(200.0, 2, 1).unwrap();
    let field = synthetic::rough(grid, 9, 500.0);
    let mut sheet = Sheet::new(&field, BlockIndex { x: 0, z: 0 }, 2, DVec3::new(1.0, 2.0, 3.0), eye_uniforms);
    for block in grid.blocks() {
        let (mut indices, mut heights_m) = (mesh::level_0().clone(), tile_heights_m(&field, block));
        if block.x == 0 {
            spoil(&mut indices, &mut heights_m);
        }
        sheet.add(Piece { block, indices: &indices, heights_m: &heights_m });
    }
    sheet.check()
}

#[test]
fn a_wrong_mesh_is_found() {
    assert_eq!(spoiled(|_, _| ()), Cracks { edges: 2 * mesh::level_0().len() as u64, ..Cracks::default() });
    // A triangle is missing, is twice there, faces down.
    assert_eq!(spoiled(|list, _| drop(list.drain(600..603))).t_junctions, 3);
    assert!(spoiled(|list, _| list.extend_from_within(600..603)).t_junctions >= 3);
    assert!(spoiled(|list, _| list.swap(600, 601)).t_junctions >= 3);
    // Level 1 without midpoints on the border: what a mask that forgets the border would give.
    let forgets = |list: &mut Vec<u16>, _: &mut [f32]| {
        list.clear();
        for row in 0..SUBS as u16 {
            for column in 0..SUBS as u16 {
                let post = |c: u16, r: u16| (2 * row + r) * mesh::TILE as u16 + 2 * column + c;
                list.extend([post(0, 0), post(0, 2), post(2, 0), post(0, 2), post(2, 2), post(2, 0)]);
            }
        }
    };
    // The shared border: each of its long edges has a vertex inside and no opposite; and the world's rim is not cut.
    assert!(spoiled(forgets).t_junctions >= 2 * SUBS as u64);
    // A post of the border one bit higher: it and its apron twin.
    let higher = |_: &mut Vec<u16>, heights: &mut [f32]| {
        let at = 7 * mesh::TILE as usize + terrain::CELLS as usize;
        heights[at] = heights[at].next_up();
    };
    assert_eq!(spoiled(higher).position_mismatches, 1);
}
