//! Loose things at their extremes: thrown, on slopes, over edges, blown about, broken.

use super::*;
use crate::ballistics::shape::Shape;
use crate::scene::EndReason;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;
use terrain::edit::{Crater, Edit};
use terrain::features::cover::{Cover, CoverClass};
use terrain::{Grid, Ground, synthetic};

const SEED_PIECES: u64 = 20_261_128;
const DT_S: f64 = 1.0 / 120.0;
const GRAVITY_MPS2: f64 = 9.81;

fn plain() -> SceneGround {
    SceneGround::from(Ground::new(Arc::new(synthetic::flat(Grid::centred(25.0, 4, 4).unwrap(), 40.0))).whole())
}

/// Slopes of 30 degrees and more, an edge every 25 m.
fn rough() -> SceneGround {
    SceneGround::from(Ground::new(Arc::new(synthetic::rough(Grid::centred(25.0, 4, 4).unwrap(), 7, 15.0))).whole())
}

fn piece(kind: LooseKind, position_m: DVec3) -> Piece {
    let (velocity_mps, rates_radps) = (DVec3::ZERO, DVec3::ZERO);
    Piece { kind, position_m, attitude: DQuat::IDENTITY, velocity_mps, rates_radps, phase: Phase::Moves(0.0) }
}

fn step_among(loose: &mut Loose, ground: &SceneGround, movers: &[Mover]) -> Vec<(StableId, EndReason)> {
    loose.step(&Around { ground, movers, gravity_mps2: GRAVITY_MPS2, dt_s: DT_S })
}

/// Steps until all rest, at most so long; seconds that it took.
fn rest(loose: &mut Loose, ground: &SceneGround, most_s: f64) -> f64 {
    let mut time_s = 0.0;
    while loose.any_moves() && time_s < most_s {
        step_among(loose, ground, &[]);
        time_s += DT_S;
    }
    time_s
}

fn over(ground: &SceneGround, x_m: f64, z_m: f64, over_m: f64) -> DVec3 {
    DVec3::new(x_m, ground.height_m(x_m, z_m).unwrap() + over_m, z_m)
}

/// The invariant: middles not under the ground, numbers that things can have.
fn holds(loose: &Loose, ground: &SceneGround) {
    for (id, piece) in loose.pieces() {
        let at = piece.position_m;
        assert!(
            piece.is_sound() && ground.height_m(at.x, at.z).is_some_and(|height| at.y >= height),
            "{id:?} {piece:?}"
        );
    }
}

#[test]
fn every_kind_comes_to_rest_on_its_side_and_stays() {
    let ground = plain();
    let mut random = StdRng::seed_from_u64(SEED_PIECES);
    let mut loose = Loose::default();
    for number in 0..90u32 {
        let kind = LooseKind::ALL[number as usize % 9];
        let at = over(&ground, f64::from(number % 10) * 5.0, f64::from(number / 10) * 5.0, 3.0);
        let mut one = piece(kind, at);
        let mut part = || random.random_range(-1.0..1.0);
        one.attitude = DQuat::from_xyzw(part(), part(), part(), part()).normalize();
        assert!(loose.add(StableId(u64::from(number)), one));
    }
    let time_s = rest(&mut loose, &ground, 60.0);
    assert!(!loose.any_moves(), "after {time_s} s {:?}", loose.pieces().iter().find(|(_, piece)| piece.moves()));
    holds(&loose, &ground);
    assert_eq!(loose.counts.put_back, 0, "at 8 m/s the engine holds them by itself");
    for (_, piece) in loose.pieces() {
        let (half, up) = (piece.kind.half_m(), piece.attitude * DVec3::Y);
        let level_m = (1.0 - up.y * up.y).max(0.0).sqrt() * half.x;
        let below_m = match piece.kind {
            LooseKind::Cone => (up.y * half.y + level_m).max(-up.y * half.y),
            LooseKind::Barrel | LooseKind::Wheel => (up.y * half.y).abs() + level_m,
            _ => [DVec3::X, DVec3::Y, DVec3::Z]
                .map(|axis| ((piece.attitude * axis).y * axis.dot(half)).abs())
                .iter()
                .sum(),
        };
        let low = piece.position_m.y - below_m;
        assert!((low - 40.0).abs() < 0.005, "{low} {piece:?}");
    }
    let before = loose.pieces().to_vec();
    for _ in 0..120 * 600 {
        step_among(&mut loose, &ground, &[]);
    }
    assert_eq!(loose.pieces(), before, "10 minutes later, to the bit");
}

#[test]
fn thrown_at_500_mps_nothing_goes_through_the_ground() {
    let ground = rough();
    let mut random = StdRng::seed_from_u64(SEED_PIECES + 1);
    let mut put_back = 0;
    for lot in 0..8u64 {
        let mut loose = Loose::default();
        for number in 0..25 {
            let kind = LooseKind::ALL[random.random_range(0..9)];
            let mut place = || random.random_range(-600.0..600.0);
            let mut one = piece(kind, over(&ground, place(), place(), 2.0));
            let way = DVec3::new(
                random.random_range(-1.0..1.0),
                random.random_range(-1.0..0.5),
                random.random_range(-1.0..1.0),
            );
            one.push(way.normalize_or(DVec3::NEG_Y) * 500.0, DVec3::new(80.0, 0.0, -40.0));
            assert!(loose.add(StableId(lot * 100 + number), one));
        }
        for _ in 0..240 {
            step_among(&mut loose, &ground, &[]);
            holds(&loose, &ground);
        }
        put_back += loose.counts.put_back;
    }
    // Most of 200 fly into a slope at more than 2 m a step.
    assert!(put_back > 100, "{put_back}");
}

#[test]
fn on_45_degrees_things_slide_or_lie_and_never_sink_in() {
    let grid = Grid::centred(25.0, 4, 4).unwrap();
    let ground =
        SceneGround::from(Ground::new(Arc::new(synthetic::from_fn(grid, |column, _| 25.0 * column as f32))).whole());
    let mut loose = Loose::default();
    for (number, kind) in LooseKind::ALL.into_iter().enumerate() {
        let at = over(&ground, 1_000.0, number as f64 * 10.0, 0.0) + DVec3::new(-1.0, 1.0, 0.0).normalize() * 1.2;
        assert!(loose.add(StableId(number as u64), piece(kind, at)));
    }
    let high_m = loose.pieces()[0].1.position_m.y;
    for _ in 0..120 * 20 {
        step_among(&mut loose, &ground, &[]);
        holds(&loose, &ground);
    }
    assert_eq!(loose.pieces().len(), 9);
    // Friction of 0.8 is less than the slope: all go down, what rolls farthest.
    assert!(loose.pieces().iter().all(|(_, piece)| piece.position_m.y < high_m - 5.0), "{:?}", loose.pieces());
    assert!(loose.pieces().iter().all(|(_, piece)| piece.velocity_mps.length() < 100.0));
}

#[test]
fn over_the_edge_over_void_and_on_water_they_are_gone() {
    let grid = Grid::centred(25.0, 4, 4).unwrap();
    let field =
        synthetic::from_fn(grid, |column, row| if (70..72).contains(&column) && row == 60 { f32::NAN } else { 5.0 });
    let ground = SceneGround::from(Ground::new(Arc::new(field)).whole());
    let mut loose = Loose::default();
    let mut over_edge = piece(LooseKind::Barrel, over(&ground, grid.east_m() - 3.0, 0.0, 0.5));
    over_edge.push(DVec3::X * 30.0, DVec3::ZERO);
    let hole_m = grid.x_m(70) + 10.0;
    let into_void = piece(LooseKind::Crate, DVec3::new(hole_m, 6.0, 0.0));
    loose.add(StableId(1), over_edge);
    loose.add(StableId(2), into_void);
    loose.add(StableId(3), piece(LooseKind::Crate, over(&ground, 0.0, 0.0, 0.5)));
    let mut gone = Vec::new();
    for _ in 0..240 {
        gone.extend(step_among(&mut loose, &ground, &[]));
    }
    gone.sort_by_key(|(id, _)| *id);
    assert_eq!(gone, [(StableId(1), EndReason::LeftWorld), (StableId(2), EndReason::LeftWorld)]);
    assert_eq!(loose.pieces().len(), 1);
    let cells = vec![CoverClass::Water as u8; ((grid.columns() - 1) * (grid.rows() - 1)) as usize];
    let lake = ground.with_cover(Arc::new(Cover::new(&grid, 1, cells).unwrap()));
    loose.add(StableId(4), piece(LooseKind::Sheet, over(&lake, 50.0, 0.0, 4.0)));
    let gone: Vec<_> = (0..240).flat_map(|_| step_among(&mut loose, &lake, &[])).collect();
    assert_eq!(gone.last(), Some(&(StableId(4), EndReason::Water)), "{gone:?}");
}

#[test]
fn what_is_no_number_is_told_and_its_neighbour_goes_on() {
    let ground = plain();
    let mut loose = Loose::default();
    for number in 0..3 {
        loose.add(StableId(number), piece(LooseKind::Crate, over(&ground, 3.0 * number as f64, 0.0, 1.0)));
    }
    loose.pieces[1].1.velocity_mps.x = f64::NAN;
    assert_eq!(step_among(&mut loose, &ground, &[]), [(StableId(1), EndReason::NotFinite)]);
    rest(&mut loose, &ground, 10.0);
    assert_eq!(loose.pieces().len(), 2);
    holds(&loose, &ground);
    assert!(!loose.any_moves());
}

#[test]
fn ten_thousand_bursts_keep_every_number_in_bounds() {
    let ground = rough();
    let mut random = StdRng::seed_from_u64(SEED_PIECES + 2);
    let mut loose = Loose::default();
    for number in 0..40u32 {
        let kind = LooseKind::ALL[number as usize % 9];
        loose.add(StableId(u64::from(number)), piece(kind, over(&ground, f64::from(number) * 2.0 - 40.0, 0.0, 1.0)));
    }
    let mut moved = 0;
    for burst in 0..10_000u64 {
        // Somewhere near one of them: they are soon far apart.
        let one = loose.pieces()[random.random_range(0..loose.pieces().len())].1.position_m;
        let at = one
            + DVec3::new(
                random.random_range(-9.0..9.0),
                random.random_range(-2.0..2.0),
                random.random_range(-9.0..9.0),
            );
        moved += u32::from(loose.blow(at, [0.5, 87.0, 430.0][burst as usize % 3], [7, burst, 1]));
        if burst % 5 == 0 {
            step_among(&mut loose, &ground, &[]);
            holds(&loose, &ground);
        }
    }
    assert!(moved > 5_000, "{moved}");
}

#[test]
fn a_vehicle_knocks_over_what_stands_in_its_way_and_wakes_nothing_else() {
    let ground = plain();
    let mut loose = Loose::default();
    for (number, z_m) in [(1, 0.0), (2, 8.0)] {
        let mut pole = piece(LooseKind::Pole, DVec3::new(0.0, 0.0, z_m));
        stand(&mut pole, &ground, 0.0);
        pole.phase = Phase::Put(0.0);
        loose.add(StableId(number), pole);
    }
    let shape = Shape::block(DVec3::new(1.25, 1.45, 3.7)).unwrap();
    let mut truck = Mover {
        shape: shape.collider(),
        position_m: DVec3::new(-12.0, 41.45, 0.0),
        attitude: DQuat::from_rotation_y(-std::f64::consts::FRAC_PI_2),
        velocity_mps: DVec3::X * 8.0,
        rates_radps: DVec3::ZERO,
        radius_m: shape.radius_m(),
    };
    for _ in 0..120 * 4 {
        step_among(&mut loose, &ground, std::slice::from_ref(&truck));
        truck.position_m += truck.velocity_mps * DT_S;
        holds(&loose, &ground);
    }
    rest(&mut loose, &ground, 20.0);
    let [(_, struck), (_, beside)] = loose.pieces() else { panic!("{:?}", loose.pieces()) };
    assert!((struck.attitude * DVec3::Y).y.abs() < 0.2 && struck.position_m.x > 0.5, "it lies ahead: {struck:?}");
    assert!(matches!(beside.phase, Phase::Put(_)) && beside.position_m == DVec3::new(0.0, 41.5, 8.0), "{beside:?}");
}

#[test]
fn a_crater_lets_what_rests_fall_into_it() {
    let ground = plain();
    let mut loose = Loose::default();
    loose.add(StableId(1), piece(LooseKind::Crate, over(&ground, 0.0, 0.0, 0.5)));
    loose.add(StableId(2), piece(LooseKind::Crate, over(&ground, 600.0, 0.0, 0.5)));
    rest(&mut loose, &ground, 10.0);
    let far = loose.pieces()[1];
    let crater = Crater::simple(glam::DVec2::ZERO, 60.0);
    let edited = ground.edited(&[Edit::Crater(crater)]).unwrap();
    assert!(edited.height_m(0.0, 0.0).unwrap() < 39.0);
    loose.ground_changed(&edited);
    rest(&mut loose, &edited, 20.0);
    holds(&loose, &edited);
    let fell = loose.pieces()[0].1.position_m;
    assert!((fell.y - edited.height_m(fell.x, fell.z).unwrap()).abs() < 1.0 && fell.y < 39.5, "{fell}");
    assert_eq!(loose.pieces()[1], far, "nothing changed there");
}

#[test]
fn the_same_things_go_the_same_way_also_when_taken_up_in_between() {
    let ground = rough();
    let make = || {
        let mut loose = Loose::default();
        for number in 0..60u32 {
            let kind = LooseKind::ALL[number as usize % 9];
            let at =
                over(&ground, f64::from(number % 8) * 0.9, f64::from(number / 8) * 0.9, 2.0 + f64::from(number) * 0.1);
            loose.add(StableId(u64::from(number)), piece(kind, at));
        }
        loose
    };
    let (mut whole, mut taken_up) = (make(), make());
    for step in 0..600 {
        if step % 50 == 7 {
            taken_up = Loose::of(taken_up.pieces().to_vec(), taken_up.counts);
        }
        if step == 300 {
            assert!(whole.blow(DVec3::new(3.0, 5.0, 3.0), 20.0, [1, 2, 3]));
            taken_up.blow(DVec3::new(3.0, 5.0, 3.0), 20.0, [1, 2, 3]);
        }
        step_among(&mut whole, &ground, &[]);
        step_among(&mut taken_up, &ground, &[]);
        assert_eq!(whole.pieces(), taken_up.pieces(), "step {step}");
    }
    assert_eq!(whole.counts, taken_up.counts);
}

#[test]
fn where_there_is_no_room_the_oldest_debris_that_rests_goes() {
    let ground = plain();
    let mut loose = Loose::default();
    let mut barrel = piece(LooseKind::Barrel, over(&ground, -9.0, 0.0, 0.44));
    barrel.phase = Phase::Put(0.0);
    loose.add(StableId(0), barrel);
    for number in 1..MOST_LOOSE as u64 {
        let mut one = piece(LooseKind::Sheet, over(&ground, number as f64, 0.0, 0.04));
        if number > 3 {
            one.phase = Phase::Rests(40.0);
        }
        assert!(loose.add(StableId(number), one));
    }
    assert!(loose.add(StableId(9_999), piece(LooseKind::Sheet, over(&ground, 0.0, 9.0, 1.0))));
    assert_eq!((loose.pieces().len(), loose.counts.forgotten), (MOST_LOOSE, 1));
    assert!(loose.pieces().iter().all(|(id, _)| id.0 != 4), "the first that rested");
    let mut full = Loose::default();
    (0..MOST_LOOSE as u64).for_each(|number| assert!(full.add(StableId(number), barrel)));
    assert!(!full.add(StableId(9_999), barrel), "what was put is never taken for debris");
}
