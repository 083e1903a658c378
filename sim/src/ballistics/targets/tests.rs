//! Moving and turning targets against a slow, obvious twin that marches the motion and asks for the distance.

use super::super::chords::{COARSE_M, FINE_M};
use super::super::shape::tests::any_shapes;
use super::*;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

const SEED_TWIN: u64 = 20_261_124;
const SEED_SHARED: u64 = 20_261_125;
const SEED_ORDER: u64 = 20_261_126;

fn vector(random: &mut StdRng, size: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| random.random_range(-size..size)))
}

fn attitude(random: &mut StdRng) -> DQuat {
    DQuat::from_scaled_axis(vector(random, 1.8))
}

fn still(id: u64, shape: Shape, position_m: DVec3) -> Target {
    Target { id: StableId(id), shape, from: Pose::at(position_m), to: Pose::at(position_m) }
}

/// A shell and a target that meet, or nearly: both bend, move and turn.
fn any_meeting(random: &mut StdRng, shape: Shape, most_turn: f64) -> (StepPath, Target) {
    let step_s = 1.0 / random.random_range(10.0..240.0);
    let meet = vector(random, 1e3);
    let (at, radius) = (random.random_range(0.0..1.0), shape.radius_m());
    let (shell, own) = (vector(random, 900.0), vector(random, 200.0));
    let bend_mps = 10f64.powf(random.random_range(-1.0..3.0));
    let curve = vector(random, bend_mps / step_s);
    let aim = meet + vector(random, radius);
    let path = StepPath {
        from_m: aim - shell * (at * step_s),
        from_mps: shell - curve * (0.5 * step_s),
        to_m: aim + shell * ((1.0 - at) * step_s),
        to_mps: shell + curve * (0.5 * step_s),
        step_s,
    };
    let first = attitude(random);
    let turn = vector(random, 1.0).normalize() * random.random_range(0.0..most_turn);
    let from = Pose { position_m: meet - own * (at * step_s), attitude: first };
    let to = Pose { position_m: meet + own * ((1.0 - at) * step_s), attitude: first * DQuat::from_scaled_axis(turn) };
    (path, Target { id: StableId(7), shape, from, to })
}

/// The shell in the target's frame, as said: straight between places, slerp between attitudes.
fn in_target(path: &StepPath, target: &Target, s: f64) -> DVec3 {
    let place = target.from.position_m.lerp(target.to.position_m, s);
    let (from, to) = (target.from.attitude, target.to.attitude);
    let to = if from.dot(to) < 0.0 { -to } else { to };
    from.slerp(to, s).conjugate() * (path.position_m(s) - place)
}

/// Least signed distance that the shell has to the shape up to a fraction, in steps of 1e-4 or of what it is away.
fn least_distance_m(path: &StepPath, target: &Target, until: f64) -> f64 {
    let turn = 2.0 * (target.from.attitude.conjugate() * target.to.attitude).xyz().length().min(1.0).asin();
    let velocity = (target.to.position_m - target.from.position_m) / path.step_s;
    let rate_m = 2.0 * (path.from_mps - velocity).length().max((path.to_mps - velocity).length()) * path.step_s
        + turn * 1.5 * (path.from_m - target.from.position_m).length().max((path.to_m - target.to.position_m).length());
    let (mut s, mut least) = (0.0, f64::INFINITY);
    while s < until {
        let distance = target.shape.distance_m(in_target(path, target, s));
        least = least.min(distance);
        s += (distance / rate_m).max(1e-4);
    }
    least
}

#[test]
fn a_hundred_thousand_meetings_are_the_twins() {
    let mut random = StdRng::seed_from_u64(SEED_TWIN);
    let (mut hits, mut misses, mut deepest) = (0, 0, f64::INFINITY);
    for round in 0..20_000 {
        for shape in any_shapes(&mut random) {
            let most_turn = [0.0001, 0.05, 1.0, 3.0][round % 4];
            let (path, target) = any_meeting(&mut random, shape, most_turn);
            let hit = target_impact(&path, std::slice::from_ref(&target), None);
            // Chords are within COARSE_M of the path, so before the hit, or without one, it is nowhere deeper.
            let least = least_distance_m(&path, &target, hit.map_or(1.0, |hit| hit.fraction));
            assert!(least > -COARSE_M, "{least} m inside unseen: {path:?} {target:?} {hit:?}");
            deepest = deepest.min(least);
            let Some(hit) = hit else {
                misses += 1;
                continue;
            };
            hits += 1;
            // Off the path by the fine chords, and by roundings of coordinates below 2^11 m.
            let roundings_m = 20.0 * 2f64.powi(-42);
            let on_path = in_target(&path, &target, hit.fraction);
            assert!(on_path.distance(hit.point_in_target_m) < FINE_M + roundings_m);
            assert!(hit.point_m.distance(path.position_m(hit.fraction)) < FINE_M + roundings_m);
            let depth = target.shape.distance_m(hit.point_in_target_m);
            assert!(depth < roundings_m && (depth > -roundings_m || hit.fraction == 0.0), "{depth}");
            // A difference of places 2e-5 of the step apart, against the velocity in the target's frame.
            if hit.fraction > 1e-4 && hit.fraction < 1.0 - 1e-4 {
                let [before, after] = [-1e-5, 1e-5].map(|d| in_target(&path, &target, hit.fraction + d));
                let velocity = (after - before) / (2e-5 * path.step_s);
                assert!((velocity.length() - hit.velocity_mps.length()).abs() < 1e-3, "{velocity} {hit:?}");
            }
        }
    }
    println!("{hits} hits, {misses} misses; deepest unseen {deepest:.2e} m");
    assert!(hits > 20_000 && misses > 20_000, "{hits} {misses}");
}

#[test]
fn a_target_at_rest_is_a_plain_cast() {
    let mut random = StdRng::seed_from_u64(SEED_TWIN);
    for _ in 0..2_000 {
        for shape in any_shapes(&mut random) {
            let (from, to, turned) = (vector(&mut random, 20.0), vector(&mut random, 6.0), attitude(&mut random));
            let place = vector(&mut random, 100.0);
            let pose = Pose { position_m: place, attitude: turned };
            let path = StepPath::straight(place + turned * from, place + turned * to, 0.01);
            let target = Target { id: StableId(1), shape: shape.clone(), from: pose, to: pose };
            match (target_impact(&path, &[target], None), shape.enter(from, to)) {
                (Some(hit), Some(entry)) => {
                    // Roundings of 120 m, magnified by a graze of at most a thousandth.
                    assert!(hit.point_in_target_m.distance(from.lerp(to, entry.fraction)) < 1e-9);
                    if let Some(normal) = entry.normal {
                        assert!(hit.normal.distance(turned * normal) < 1e-9);
                    }
                }
                (None, None) => {}
                other => panic!("{other:?}"),
            }
        }
    }
}

#[test]
fn a_moving_target_strikes_a_shell_at_rest() {
    let shell = StepPath::straight(DVec3::new(0.3, 0.2, 0.1), DVec3::new(0.3, 0.2, 0.1), 0.1);
    let mut target = still(1, Shape::block(DVec3::ONE).unwrap(), DVec3::new(-5.0, 0.0, 0.0));
    target.to.position_m.x += 100.0 * shell.step_s;
    let hit = target_impact(&shell, &[target], None).unwrap();
    // The face is 4.3 m away.
    assert!((hit.time_s - 0.043).abs() < 1e-12 && hit.normal == DVec3::X);
    assert!(hit.velocity_mps.distance(DVec3::X * -100.0) < 1e-9);
    assert!(hit.point_in_target_m.distance(DVec3::new(1.0, 0.2, 0.1)) < 1e-12);
}

#[test]
fn one_velocity_for_both_is_no_hit() {
    let velocity = DVec3::new(700.0, 30.0, -250.0);
    let mut target = still(1, Shape::capsule(2.0, 1.0).unwrap(), DVec3::new(1e4, 3e3, -2e4));
    target.to.position_m += velocity * 0.1;
    let from = target.from.position_m + DVec3::new(1.001, 0.5, 0.0);
    let path = StepPath::straight(from, from + velocity * 0.1, 0.1);
    assert_eq!(target_impact(&path, &[target], None), None);
}

#[test]
fn a_velocity_that_all_share_changes_nothing() {
    let mut random = StdRng::seed_from_u64(SEED_SHARED);
    let mut compared = 0;
    for _ in 0..4_000 {
        for shape in any_shapes(&mut random) {
            let (path, target) = any_meeting(&mut random, shape, 0.5);
            let shared = vector(&mut random, 1e3);
            let way = shared * path.step_s;
            let carried = StepPath {
                to_m: path.to_m + way,
                from_mps: path.from_mps + shared,
                to_mps: path.to_mps + shared,
                ..path
            };
            let mut with_it = target.clone();
            with_it.to.position_m += way;
            let [one, other] = [(path, target), (carried, with_it)].map(|(p, t)| target_impact(&p, &[t], None));
            let graze = |hit: &TargetImpact| hit.normal.dot(hit.velocity_mps.normalize_or_zero()).abs();
            match (one, other) {
                // Roundings of 2 km (2^-42 m, some twenty) are magnified by 1 / graze, on an edge by the other face's.
                (Some(a), Some(b)) if graze(&a) > 0.02 => {
                    assert!(a.point_in_target_m.distance(b.point_in_target_m) < 1e-9, "{a:?} {b:?}");
                    compared += 1;
                }
                (None, None) => {}
                (Some(_), Some(_)) => {}
                (Some(hit), None) | (None, Some(hit)) => assert!(graze(&hit) < 1e-3, "{hit:?}"),
            }
        }
    }
    assert!(compared > 5_000, "{compared}");
}

#[test]
fn a_bar_that_spins_fast_strikes_what_it_sweeps() {
    // 3 rad in 1/120 s about the vertical: 57 turns a second. X goes towards -Z.
    let turn = 3.0;
    let pose = |angle: f64| Pose { position_m: DVec3::ZERO, attitude: DQuat::from_rotation_y(angle) };
    let shape = Shape::block(DVec3::new(5.0, 0.2, 0.1)).unwrap();
    let bar = Target { id: StableId(1), shape, from: pose(0.3), to: pose(0.3 + turn) };
    for i in 1..28 {
        let ahead = 0.1 * f64::from(i);
        let point = DQuat::from_rotation_y(0.3 + ahead) * DVec3::new(4.0, 0.0, 0.0);
        let hit = target_impact(&StepPath::straight(point, point, 1.0 / 120.0), std::slice::from_ref(&bar), None);
        let hit = hit.unwrap_or_else(|| panic!("unseen at {ahead}"));
        // Where its face, 0.1 m before its axis, comes to the point 4 m out.
        let exact = (ahead - (0.1f64 / 4.0).asin()) / turn;
        assert!((hit.fraction - exact).abs() < 2.0 * FINE_M / (4.0 * turn), "{} {exact}", hit.fraction);
        // The speed of the bar there, and not 0, which is that of its middle.
        assert!((hit.velocity_mps.length() - 4.0 * turn * 120.0).abs() < 1e-6);
    }
    // Above it, and beyond its end, it passes.
    for point in [DVec3::new(3.0, 0.201, -1.0), DVec3::new(0.0, 0.0, -5.01)] {
        let path = StepPath::straight(point, point, 1.0 / 120.0);
        assert_eq!(target_impact(&path, std::slice::from_ref(&bar), None), None);
    }
}

#[test]
fn the_order_of_the_targets_does_not_matter() {
    let mut random = StdRng::seed_from_u64(SEED_ORDER);
    for _ in 0..300 {
        let path = StepPath::straight(vector(&mut random, 50.0), vector(&mut random, 50.0), 0.02);
        let mut targets: Vec<Target> =
            (0..20).map(|id| still(id, Shape::sphere(4.0).unwrap(), vector(&mut random, 40.0))).collect();
        // Each once more at its very place, with another name: a tie.
        let twins: Vec<Target> = targets.iter().map(|t| Target { id: StableId(100 - t.id.0), ..t.clone() }).collect();
        targets.extend(twins);
        let first = target_impact(&path, &targets, None);
        assert!(first.is_none_or(|hit| hit.id.0 < 50), "the lower of two equal");
        for _ in 0..5 {
            for i in (1..targets.len()).rev() {
                targets.swap(i, random.random_range(0..=i));
            }
            assert_eq!(target_impact(&path, &targets, None), first);
        }
    }
}

#[test]
fn a_start_inside_strikes_at_once_but_not_the_own_ship() {
    let path = StepPath::straight(DVec3::ZERO, DVec3::X * 10.0, 0.01);
    let targets =
        [still(3, Shape::sphere(2.0).unwrap(), DVec3::X), still(4, Shape::sphere(1.0).unwrap(), DVec3::X * 6.0)];
    let hit = target_impact(&path, &targets, None).unwrap();
    assert_eq!((hit.id, hit.fraction, hit.normal), (StableId(3), 0.0, DVec3::NEG_X));
    let hit = target_impact(&path, &targets, Some(StableId(3))).unwrap();
    assert_eq!((hit.id, hit.normal), (StableId(4), DVec3::NEG_X));
    assert_eq!(target_impact(&path, &targets[..1], Some(StableId(3))), None);
}

#[test]
fn numbers_that_are_none_are_no_target() {
    let path = StepPath::straight(DVec3::X * -5.0, DVec3::X * 5.0, 0.01);
    let sound = still(1, Shape::sphere(1.0).unwrap(), DVec3::ZERO);
    assert!(target_impact(&path, std::slice::from_ref(&sound), None).is_some());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200, f64::MAX] {
        for at_end in [false, true] {
            let mut spoilt = sound.clone();
            let pose = if at_end { &mut spoilt.to } else { &mut spoilt.from };
            pose.position_m.y = bad;
            let _ = target_impact(&path, std::slice::from_ref(&spoilt), None);
            let mut spoilt = sound.clone();
            let pose = if at_end { &mut spoilt.to } else { &mut spoilt.from };
            pose.attitude.x = bad;
            let hit = target_impact(&path, std::slice::from_ref(&spoilt), None);
            assert!(bad.is_finite() || hit.is_none(), "{bad}");
        }
        let spoilt = StepPath { to_m: DVec3::splat(bad), ..path };
        let hit = target_impact(&spoilt, std::slice::from_ref(&sound), None);
        assert!(bad.is_finite() || hit.is_none());
    }
    let mut none = sound;
    none.from.attitude = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    assert_eq!(target_impact(&path, &[none], None), None);
}
