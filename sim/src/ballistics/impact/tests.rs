//! Ground impacts: nothing passes through, and what is reported is on the ground and on the path.

use super::super::chords::{COARSE_M, FINE_M};
use super::super::shape::Shape;
use super::super::targets::Pose;
use super::*;
use crate::integrate::rk4;
use glam::DVec2;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;
use terrain::{CELLS, Field, Grid, Ground, synthetic};

const SEED_SEGMENTS: u64 = 20_261_124;
const SEED_BENT: u64 = 20_261_125;
const SEED_FLIGHTS: u64 = 20_261_126;
const SEED_VOID: u64 = 20_261_127;

/// An impact's distance from its triangle that is asked for.
const ON_TRIANGLE_M: f64 = 1e-6;

/// Gaps that roundings decide: coordinates below 2^14 m and a slope of at most 50, 2^-39 m each, some ten of them.
const TOUCH_M: f64 = 10.0 * 50.0 / (1u64 << 39) as f64;

fn rough() -> Area {
    Ground::new(Arc::new(synthetic::rough(Grid::centred(200.0, 2, 2).unwrap(), 7, 800.0))).whole()
}

fn gap_m(area: &Area, point: DVec3) -> Option<f64> {
    area.height_m(point.x, point.z).map(|height| point.y - height)
}

/// The least distance from the point to a triangle that has it over it: plane distance, and how far it is out of its edges.
fn off_triangle_m(area: &Area, point: DVec3) -> f64 {
    let grid = area.grid();
    let place = |at: f64, cells: u32| (at.floor() as i64).clamp(0, i64::from(cells) - 1);
    let column = place((point.x - grid.west_m) / grid.step_m, grid.columns() - 1);
    let row = place((point.z - grid.north_m) / grid.step_m, grid.rows() - 1);
    let mut least = f64::INFINITY;
    for (dc, dr) in [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)] {
        let (c, r) = (column + dc, row + dr);
        if c < 0 || r < 0 || c >= i64::from(grid.columns() - 1) || r >= i64::from(grid.rows() - 1) {
            continue;
        }
        for triangle in area.field().cell_triangles(c as u32, r as u32).into_iter().flatten() {
            let [a, b, c] = triangle.corners;
            let off_plane = (point - a).dot(triangle.normal()).abs();
            let outside = [(a, b), (b, c), (c, a)].into_iter().map(|(p, q)| {
                let edge = DVec2::new(q.x - p.x, q.z - p.z);
                let to = DVec2::new(point.x - p.x, point.z - p.z);
                // Counter-clockwise from above, with Z to the south: inside is where this is not above 0.
                edge.perp_dot(to) / edge.length()
            });
            least = least.min(outside.fold(off_plane, f64::max));
        }
    }
    least
}

fn check_impact(area: &Area, path: &StepPath, impact: &Impact) {
    assert!((0.0..=1.0).contains(&impact.fraction), "{path:?}");
    assert!(off_triangle_m(area, impact.point_m) < ON_TRIANGLE_M, "{path:?} {impact:?}");
    // Off the chord by the path's bend, and along it by roundings.
    let off_path = path.position_m(impact.fraction).distance(impact.point_m);
    assert!(off_path < 2.0 * FINE_M, "{off_path} m off {path:?}");
    assert_eq!(impact.time_s, impact.fraction * path.step_s);
    assert!(impact.normal.is_normalized() && impact.normal.y > 0.0);
    let sine = impact.velocity_mps.normalize_or_zero().dot(impact.normal).abs();
    assert!((impact.grazing_rad.sin() - sine).abs() < 1e-9);
}

/// A point on a post, an edge or a diagonal of the ground, away from the world's edge.
fn delicate_point(area: &Area, random: &mut StdRng) -> DVec3 {
    let grid = area.grid();
    let column = i64::from(random.random_range(3..grid.columns() - 4));
    let row = i64::from(random.random_range(3..grid.rows() - 4));
    let part = random.random_range(0.0..1.0) * grid.step_m;
    let (x, z) = (grid.x_m(column), grid.z_m(row));
    let (x, z) = match random.random_range(0..4) {
        0 => (x, z),
        1 => (x + part, z),
        2 => (x, z + part),
        // From the cell's south-west to its north-east corner.
        _ => (x + part, grid.z_m(row + 1) - part),
    };
    DVec3::new(x, area.height_m(x, z).unwrap(), z)
}

/// A direction that goes down, in one case of four within a grid plane or straight down.
fn downward(random: &mut StdRng) -> DVec3 {
    let mut across = DVec2::new(random.random_range(-1.0..1.0), random.random_range(-1.0..1.0));
    match random.random_range(0..8) {
        0 => across.x = 0.0,
        1 => across.y = 0.0,
        _ => {}
    }
    DVec3::new(across.x, -random.random_range(0.02..2.0), across.y).normalize()
}

#[test]
fn a_million_segments_at_posts_edges_and_diagonals_do_not_pass() {
    let area = rough();
    let mut random = StdRng::seed_from_u64(SEED_SEGMENTS);
    let (mut passed_through, mut tried) = (0, 0);
    while tried < 1_000_000 {
        let aim = delicate_point(&area, &mut random);
        let direction = downward(&mut random);
        // Both ways along the plan direction.
        for direction in [direction, DVec3::new(-direction.x, direction.y, -direction.z)] {
            let from = aim - direction * random.random_range(0.1..400.0);
            let to = aim + direction * random.random_range(0.001..60.0);
            let above = gap_m(&area, from).is_some_and(|gap| gap > TOUCH_M);
            let under = gap_m(&area, to).is_some_and(|gap| gap < -TOUCH_M);
            if above && under {
                tried += 1;
                passed_through += i32::from(ground_impact(&StepPath::straight(from, to, 0.01), &area).is_none());
            }
        }
    }
    assert_eq!(passed_through, 0);
}

#[test]
fn bent_steps_at_posts_edges_and_diagonals_do_not_pass_either() {
    let area = rough();
    let mut random = StdRng::seed_from_u64(SEED_BENT);
    let mut tried = 0;
    while tried < 30_000 {
        let aim = delicate_point(&area, &mut random);
        let direction = downward(&mut random);
        let (from, to) =
            (aim - direction * random.random_range(0.1..40.0), aim + direction * random.random_range(0.001..9.0));
        let bend = |random: &mut StdRng| DVec3::from_array([(); 3].map(|()| random.random_range(-50.0..50.0)));
        let step_s = 1.0 / 120.0;
        let mean = (to - from) / step_s;
        let (from_mps, to_mps) = (mean + bend(&mut random), mean + bend(&mut random));
        let path = StepPath { from_m: from, from_mps, to_m: to, to_mps, step_s };
        let above = gap_m(&area, from).is_some_and(|gap| gap > TOUCH_M);
        let under = gap_m(&area, to).is_some_and(|gap| gap < -TOUCH_M);
        if !above || !under {
            continue;
        }
        tried += 1;
        let impact = ground_impact(&path, &area).expect("passed through");
        check_impact(&area, &path, &impact);
        // First: no sample before it is deeper under the ground than a chord may be off. Posts differ by at most 800 m
        // in 200 m each way, so the ground rises by at most sqrt(4^2 + 4^2) m a metre: sqrt(1 + 32) times the error.
        for i in 0..16 {
            let s = impact.fraction * f64::from(i) / 16.0;
            let gap = gap_m(&area, path.position_m(s)).unwrap();
            assert!(gap > -COARSE_M * 33f64.sqrt(), "{gap} m at {s} of {path:?}");
        }
    }
}

/// A shell with quadratic drag, `k` per metre: state and one step's path.
fn fly(place: DVec3, velocity: DVec3, k: f64, step_s: f64) -> StepPath {
    let y = [place.x, place.y, place.z, velocity.x, velocity.y, velocity.z];
    let y = rk4(0.0, &y, step_s, |_, y| {
        let v = DVec3::new(y[3], y[4], y[5]);
        let a = DVec3::new(0.0, -9.81, 0.0) - v * (k * v.length());
        [v.x, v.y, v.z, a.x, a.y, a.z]
    });
    StepPath {
        from_m: place,
        from_mps: velocity,
        to_m: DVec3::new(y[0], y[1], y[2]),
        to_mps: DVec3::new(y[3], y[4], y[5]),
        step_s,
    }
}

/// The flight's impact and the step it is in; `None` if it leaves the world. Every sample before it is above the ground.
fn impact_of_flight(
    area: &Area,
    mut place: DVec3,
    mut velocity: DVec3,
    k: f64,
    step_s: f64,
    samples: u32,
) -> Option<(StepPath, Impact)> {
    loop {
        let path = fly(place, velocity, k, step_s);
        let impact = ground_impact(&path, area);
        let end = impact.map_or(1.0, |impact| impact.fraction);
        for i in 1..=samples {
            // Up to the impact, that is to within what its own roundings leave.
            let s = end * f64::from(i) / f64::from(samples + u32::from(impact.is_some()));
            if let Some(gap) = gap_m(area, path.position_m(s)) {
                // A fall bends up from its chord: the chord is the lower one, and only a slope sees the drag's bend
                // across it, which is less than a rounding here.
                assert!(gap > -TOUCH_M, "{gap} m at {s} of {path:?}, {impact:?}");
            }
        }
        if let Some(impact) = impact {
            return Some((path, impact));
        }
        let grid = area.grid();
        if path.to_m.x.abs() > grid.east_m() || path.to_m.z.abs() > grid.south_m() {
            return None;
        }
        assert!(path.to_m.y > -1.0, "under all ground without an impact: {path:?}");
        (place, velocity) = (path.to_m, path.to_mps);
    }
}

#[test]
fn ten_thousand_flights_end_on_the_ground_and_only_there() {
    let area = Ground::new(Arc::new(synthetic::ridges(Grid::centred(200.0, 4, 4).unwrap(), 5))).whole();
    let mut random = StdRng::seed_from_u64(SEED_FLIGHTS);
    let (mut ended, mut compared, mut worst) = (0, 0, 0.0f64);
    for flight in 0..10_000 {
        let (x, z) = (random.random_range(-5e3..5e3), random.random_range(-5e3..5e3));
        let start = DVec3::new(x, area.height_m(x, z).unwrap() + random.random_range(0.5..300.0), z);
        let azimuth = random.random_range(0.0..std::f64::consts::TAU);
        let elevation = random.random_range(-1.2f64..1.2);
        let speed = 10f64.powf(random.random_range(50f64.log10()..3_000f64.log10()));
        let direction = DVec3::new(elevation.cos() * azimuth.cos(), elevation.sin(), elevation.cos() * azimuth.sin());
        let (k, step_s) = (10f64.powf(random.random_range(-4.0..-2.5)), 1.0 / 60.0);
        let Some((path, impact)) = impact_of_flight(&area, start, direction * speed, k, step_s, 2) else { continue };
        ended += 1;
        check_impact(&area, &path, &impact);
        // The very step again in ten: the impact is the same to the 2 mm over the sine that are asked for.
        if flight % 5 == 0 {
            let mut part = fly(path.from_m, path.from_mps, k, step_s / 10.0);
            let fine = (0..11).find_map(|_| {
                let hit = ground_impact(&part, &area);
                part = fly(part.to_m, part.to_mps, k, step_s / 10.0);
                hit
            });
            if let Some(fine) = fine {
                let off = fine.point_m.distance(impact.point_m) * impact.grazing_rad.sin();
                worst = worst.max(off);
                compared += 1;
            }
        }
    }
    println!("{ended} flights ended on the ground; {compared} compared, at most {worst:.2e} m times the sine apart");
    assert!(ended > 8_000 && compared > 1_500 && worst < 2e-3, "{ended} {compared} {worst}");
}

#[test]
fn the_same_shot_at_a_tenth_of_the_step_lands_in_the_same_place() {
    let area = Ground::new(Arc::new(synthetic::ridges(Grid::centred(200.0, 6, 6).unwrap(), 5))).whole();
    let mut random = StdRng::seed_from_u64(SEED_FLIGHTS);
    let mut worst = 0.0f64;
    for _ in 0..60 {
        let (x, z) = (random.random_range(-2e3..2e3), random.random_range(-2e3..2e3));
        let start = DVec3::new(x, area.height_m(x, z).unwrap() + 20.0, z);
        let azimuth = random.random_range(0.0f64..std::f64::consts::TAU);
        let launch = DVec3::new(azimuth.cos(), random.random_range(0.2..1.5), azimuth.sin()).normalize() * 800.0;
        let [whole, tenth] = [120.0, 1_200.0]
            .map(|hz| impact_of_flight(&area, start, launch, 3e-4, 1.0 / hz, 1).map(|(_, impact)| impact));
        let (Some(whole), Some(tenth)) = (whole, tenth) else { continue };
        worst = worst.max(whole.point_m.distance(tenth.point_m) * whole.grazing_rad.sin());
    }
    println!("whole flights of 1/120 and 1/1200 s: at most {worst:.2e} m times the sine apart");
    assert!(worst > 0.0 && worst < 2e-3, "{worst}");
}

#[test]
fn a_muzzle_on_or_under_the_ground_strikes_at_once() {
    let area = rough();
    let (x, z) = (123.0, -456.0);
    let height = area.height_m(x, z).unwrap();
    for depth in [0.001, 5.0, 5_000.0] {
        let from = DVec3::new(x, height - depth, z);
        let path = StepPath { from_mps: DVec3::Y * 900.0, ..StepPath::straight(from, from + DVec3::Y * 9e3, 1.0) };
        let impact = ground_impact(&path, &area).unwrap();
        assert_eq!((impact.fraction, impact.time_s, impact.point_m), (0.0, 0.0, from));
    }
    // At rest under it, too, and at rest over it not.
    let rest = |y: f64| StepPath::straight(DVec3::new(x, y, z), DVec3::new(x, y, z), 0.01);
    assert_eq!(ground_impact(&rest(height - 1.0), &area).unwrap().grazing_rad, 0.0);
    assert_eq!(ground_impact(&rest(height + 1.0), &area), None);
}

#[test]
fn straight_up_and_down_over_a_cell_line() {
    let area = rough();
    for (x, z) in [(0.0, 0.0), (200.0, 31.0), (50.0, 150.0), (17.0, 3.0)] {
        let height = area.height_m(x, z).unwrap();
        let (mut place, mut velocity) = (DVec3::new(x, height + 2.0, z), DVec3::Y * 300.0);
        let mut steps = 0;
        let impact = loop {
            let path = fly(place, velocity, 1e-4, 1.0 / 30.0);
            if let Some(impact) = ground_impact(&path, &area) {
                break impact;
            }
            (place, velocity, steps) = (path.to_m, path.to_mps, steps + 1);
            assert!(steps < 10_000);
        };
        assert!(steps > 900 && impact.point_m.distance(DVec3::new(x, height, z)) < ON_TRIANGLE_M);
        // The apex within one step: up, over and down again.
        let hop = fly(DVec3::new(x, height + 0.1, z), DVec3::Y * 4.0, 0.0, 1.0);
        assert!(hop.to_m.y < height);
        let time = ground_impact(&hop, &area).unwrap().time_s;
        // 0.1 + 4 t - g t^2 / 2 = 0
        let exact = (4.0 + (16.0f64 + 2.0 * 9.81 * 0.1).sqrt()) / 9.81;
        assert!((time - exact).abs() < 1e-9, "{time} {exact}");
    }
}

#[test]
fn a_dip_of_two_tenths_of_a_millimetre_is_seen_and_where_it_begins() {
    let area = Ground::new(Arc::new(synthetic::flat(Grid::centred(200.0, 1, 1).unwrap(), 0.0))).whole();
    // Down and up again within the step: y = start - rate t + rate t^2 / T, lowest by a quarter of rate T.
    let dip = |depth_m: f64, sagitta_m: f64| {
        let (step_s, start_m) = (0.01, sagitta_m - depth_m);
        let rate = 4.0 * sagitta_m / step_s;
        StepPath {
            from_m: DVec3::new(3.0, start_m, 1.0),
            from_mps: DVec3::new(800.0, -rate, 20.0),
            to_m: DVec3::new(11.0, start_m, 1.2),
            to_mps: DVec3::new(800.0, rate, 20.0),
            step_s,
        }
    };
    for sagitta_m in [0.001, 0.1, 3.0, 100.0] {
        for depth_m in [2.0 * COARSE_M, 0.0009] {
            let hit = ground_impact(&dip(depth_m, sagitta_m), &area).unwrap();
            // Under the ground between the roots of 4 sagitta s (1 - s) = start; FINE_M of depth moves them by this much.
            let exact = 0.5 - 0.5 * (depth_m / sagitta_m).sqrt();
            let slope_m = 4.0 * sagitta_m * (1.0 - 2.0 * exact);
            assert!((hit.fraction - exact).abs() < 2.0 * FINE_M / slope_m, "{sagitta_m} {depth_m}: {}", hit.fraction);
        }
        assert_eq!(ground_impact(&dip(-FINE_M, sagitta_m), &area), None, "above it all along");
    }
}

#[test]
fn steps_of_kilometres_and_of_huge_bend_are_answered() {
    // 9 km within one cell of 10 km, and 9 km and 400 km across a world.
    let wide = Ground::new(Arc::new(synthetic::flat(Grid::centred(10_000.0, 1, 1).unwrap(), 100.0))).whole();
    let down = StepPath::straight(DVec3::new(10.0, 9_000.0, 20.0), DVec3::new(500.0, 0.0, 900.0), 1.0);
    let hit = ground_impact(&down, &wide).unwrap();
    check_impact(&wide, &down, &hit);
    assert!((hit.fraction - 8_900.0 / 9_000.0).abs() < 1e-12);
    let across = StepPath::straight(DVec3::new(-2e5, 200.0, -2e5), DVec3::new(2e5, 99.0, 2e5), 1.0);
    assert!(ground_impact(&across, &wide).is_none(), "ends beyond the world, before that above it");
    let across = StepPath::straight(DVec3::new(-2e5, 200.0, -2e5), DVec3::new(2e5, -99.0, 2e5), 1.0);
    check_impact(&wide, &across, &ground_impact(&across, &wide).unwrap());
    // The path ends under the ground, so it strikes, however far it swings out: up to 1e11 m, where a rounding is more
    // than a micrometre from 1e7 m/s on.
    let area = rough();
    for exponent in 0..=12 {
        let bend = DVec3::new(1.0, 1.0, -0.7) * 10f64.powi(exponent);
        let (from, to) = (DVec3::new(-900.0, 2_000.0, 40.0), DVec3::new(700.0, -10.0, -300.0));
        let path = StepPath { from_m: from, from_mps: bend, to_m: to, to_mps: bend, step_s: 0.1 };
        let hit = ground_impact(&path, &area).unwrap();
        assert!(off_triangle_m(&area, hit.point_m) < ON_TRIANGLE_M || exponent > 6, "{hit:?}");
    }
}

#[test]
fn no_ground_over_void_and_beyond_the_world() {
    let grid = Grid::centred(200.0, 1, 1).unwrap();
    let mut random = StdRng::seed_from_u64(SEED_VOID);
    let half = f64::from(CELLS) * 100.0;
    let west_void = synthetic::from_fn(grid, |column, _| if column < 10 { f32::NAN } else { 50.0 });
    let area = Ground::new(Arc::new(west_void)).whole();
    for _ in 0..2_000 {
        let (x, z) = (random.random_range(-1.5 * half..1.5 * half), random.random_range(-1.5 * half..1.5 * half));
        let path = StepPath::straight(DVec3::new(x, 90.0, z), DVec3::new(x, -90.0, z), 0.1);
        assert_eq!(ground_impact(&path, &area).is_some(), area.height_m(x, z).is_some(), "{x} {z}");
    }
    let nowhere = Ground::new(Arc::new(Field::new(grid, vec![f32::NAN; grid.posts()]).unwrap())).whole();
    let path = StepPath::straight(DVec3::splat(90.0), DVec3::splat(-90.0), 0.1);
    assert_eq!(ground_impact(&path, &nowhere), None);
}

#[test]
fn numbers_that_are_none_strike_nothing_and_end() {
    let area = rough();
    let sound = StepPath::straight(DVec3::new(0.0, 900.0, 0.0), DVec3::new(3.0, -900.0, 5.0), 0.1);
    assert!(ground_impact(&sound, &area).is_some());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let spoil = |v: DVec3| {
                let mut v = v.to_array();
                v[axis] = bad;
                DVec3::from_array(v)
            };
            for path in [
                StepPath { from_m: spoil(sound.from_m), ..sound },
                StepPath { from_mps: spoil(sound.from_mps), ..sound },
                StepPath { to_m: spoil(sound.to_m), ..sound },
                StepPath { to_mps: spoil(sound.to_mps), ..sound },
                StepPath { step_s: bad, ..sound },
            ] {
                assert_eq!(ground_impact(&path, &area), None);
            }
        }
    }
    assert_eq!(ground_impact(&StepPath { step_s: 0.0, ..sound }, &area), None);
    // Finite, and nothing but: any answer, and in time.
    for huge in [1e12, 1e100, 1e200, f64::MAX] {
        for (a, b) in [(DVec3::splat(huge), DVec3::splat(-huge)), (sound.from_m, DVec3::splat(-huge))] {
            let _ = ground_impact(&StepPath::straight(a, b, 0.1), &area);
            let _ = ground_impact(&StepPath { from_mps: a, to_mps: b, ..sound }, &area);
            let _ = ground_impact(&StepPath { from_mps: b, ..sound }, &area);
        }
    }
}

#[test]
fn the_earlier_of_ground_and_target_is_first() {
    let area = Ground::new(Arc::new(synthetic::flat(Grid::centred(200.0, 1, 1).unwrap(), 0.0))).whole();
    let path = StepPath::straight(DVec3::new(0.0, 100.0, 0.0), DVec3::new(0.0, -100.0, 0.0), 0.1);
    let target = |id: u64, y: f64| {
        let pose = Pose::at(DVec3::new(0.0, y, 0.0));
        Target { id: StableId(id), shape: Shape::block(DVec3::splat(5.0)).unwrap(), from: pose, to: pose }
    };
    let first = |targets: &[Target], own| first_impact(&path, &area, targets, own);
    assert!(
        matches!(first(&[target(1, 40.0)], None), Some(FirstImpact::Target(hit)) if (hit.point_m.y - 45.0).abs() < 1e-12)
    );
    assert!(matches!(first(&[target(1, -40.0)], None), Some(FirstImpact::Ground(hit)) if hit.point_m.y.abs() < 1e-12));
    assert!(matches!(first(&[target(1, 40.0)], Some(StableId(1))), Some(FirstImpact::Ground(_))));
    assert!(matches!(first(&[], None), Some(FirstImpact::Ground(_))));
    // Level with the ground: both at 1/2, and the target is what was shot at.
    assert!(matches!(first(&[target(1, -5.0)], None), Some(FirstImpact::Target(hit)) if hit.fraction == 0.5));
}

#[test]
fn the_far_corner_of_a_world_of_400_km_is_as_exact() {
    let grid = Grid::centred(200.0, 67, 67).unwrap();
    let area = Ground::new(Arc::new(synthetic::rough(grid, 9, 800.0))).whole();
    let mut random = StdRng::seed_from_u64(SEED_BENT);
    let corner = DVec3::new(grid.east_m() - 3_000.0, 0.0, grid.south_m() - 3_000.0);
    let mut struck = 0;
    for _ in 0..6_000 {
        let aim = corner + DVec3::new(random.random_range(0.0..2_900.0), 0.0, random.random_range(0.0..2_900.0));
        let aim = DVec3 { y: area.height_m(aim.x, aim.z).unwrap(), ..aim };
        let velocity = downward(&mut random) * random.random_range(50.0..3_000.0);
        let path = fly(aim - velocity * 0.004, velocity, 1e-3, 1.0 / 120.0);
        // Coordinates below 2^19 m: roundings are 2^5 times those of TOUCH_M.
        if gap_m(&area, path.from_m).unwrap() < 32.0 * TOUCH_M {
            continue;
        }
        let under = gap_m(&area, path.to_m).is_some_and(|gap| gap < -32.0 * TOUCH_M);
        let impact = ground_impact(&path, &area);
        assert!(impact.is_some() || !under, "passed through: {path:?}");
        if let Some(impact) = impact {
            struck += 1;
            check_impact(&area, &path, &impact);
        }
    }
    assert!(struck > 2_000, "{struck}");
}

#[test]
fn a_shell_meets_the_wall_and_the_roof_of_a_building_where_they_are_drawn() {
    use terrain::features::index::{ObjectId, ObjectIndex};
    use terrain::features::model::{Building, BuildingClass, Features, Origin};
    let field = synthetic::from_fn(Grid::centred(200.0, 1, 1).unwrap(), |_, _| 300.0);
    let area = Ground::new(Arc::new(field)).whole();
    // 12 m along x, 9 m along z, eaves at 306 m; its west wall is at x = 40.
    let outline = [(40.0, 10.0), (40.0, 19.0), (52.0, 19.0), (52.0, 10.0)].map(|(x, z)| DVec2::new(x, z)).to_vec();
    let building = Building { class: BuildingClass::House, outline, height_m: 6.0, height_from: Origin::Stated };
    let features = Features { buildings: vec![building], ..Features::default() };
    let objects = ObjectIndex::new(Arc::new(features), &area);
    let step_s = 1.0 / 120.0;
    let flown = |from: DVec3, velocity: DVec3| {
        let fall = DVec3::NEG_Y * 9.81;
        let to_mps = velocity + fall * step_s;
        let to_m = from + velocity * step_s + fall * (0.5 * step_s * step_s);
        standing_impact(&StepPath { from_m: from, from_mps: velocity, to_m, to_mps, step_s }, &area, Some(&objects))
    };
    let wall = flown(DVec3::new(37.0, 303.0, 14.0), DVec3::new(800.0, -20.0, 5.0)).unwrap();
    assert_eq!(wall.object, Some(ObjectId::Building(0)));
    // Chords are followed to 1e-9 m.
    assert!((wall.point_m.x - 40.0).abs() < 1e-9 && wall.normal == DVec3::NEG_X, "{wall:?}");
    assert!((wall.time_s - 3.0 / 800.0).abs() < 1e-11);
    // Straight down on the ridge, which no roof's pitch of 35 to 46 degrees has higher than 4.9 m over the eaves.
    let roof = flown(DVec3::new(46.0, 312.0, 14.4), DVec3::new(0.0, -900.0, 0.0)).unwrap();
    assert_eq!(roof.object, Some(ObjectId::Building(0)));
    assert!(roof.point_m.y > 306.0 && roof.point_m.y < 311.0 && roof.normal.y > 0.5, "{roof:?}");
    // Beside it, the ground.
    let ground = flown(DVec3::new(30.0, 303.0, 14.0), DVec3::new(0.0, -900.0, 0.0)).unwrap();
    assert_eq!((ground.object, ground.point_m.y), (None, 300.0));
    assert_eq!(flown(DVec3::new(37.0, 330.0, 14.0), DVec3::new(800.0, 0.0, 0.0)), None);
}
