//! Weapons in a scene: stations and releases, fuzes, damage, scores, columns, saves and replays.

mod firing_range;

use firing_range::{arm, armed, bombs_over, load, release, run, scores};
use glam::{DQuat, DVec2, DVec3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use sim::aircraft::AircraftState;
use sim::scene::{Column, Command, Happening, Height, Reaction, Scene, SceneGround, TargetStart};
use sim::snapshot::StableId;
use sim::weapons::{Aim, Damage, Fuze, Outcome, Trigger};
use std::sync::Arc;
use terrain::{Grid, Ground, synthetic};

const SEED_BYTES: u64 = 20_261_203;

fn plain() -> SceneGround {
    Ground::new(Arc::new(synthetic::flat(Grid::centred(200.0, 2, 2).unwrap(), 0.0))).whole().into()
}

fn rough() -> SceneGround {
    Ground::new(Arc::new(synthetic::rough(Grid::centred(25.0, 10, 10).unwrap(), 3, 12.0))).whole().into()
}

#[test]
fn a_ripple_leaves_in_time_from_both_sides_and_lightens_its_owner() {
    let ground = plain();
    let mut scene = armed(DVec3::new(0.0, 1_000.0, 0.0), 200.0);
    let own = scene.own_id();
    for side_m in [-1.5, 1.5] {
        scene.order(load(own, "mk82", 3, DVec3::new(0.0, side_m, 0.8))).unwrap();
    }
    let full = scene.stores_load(own);
    assert_eq!((full.mass_kg, full.cg_m.y), (6.0 * 241.0, 0.0));
    let refused = scene.order(release(own, "mk82", 6, 2, 0.25, Aim::Nearest)).unwrap_err();
    assert!(refused.to_string().contains("master arm"), "{refused}");
    scene.order(arm(own, "mk82", None)).unwrap();
    scene.order(release(own, "mk82", 9, 2, 0.25, Aim::Nearest)).unwrap();
    let mut left = Vec::new();
    for _ in 0..100 {
        scene.step(&ground);
        left.push(scene.rounds_left(own, "mk82"));
    }
    // At 0, 0.25 and 0.5 s: two each, in the step that holds the time; more than 6 there are not.
    assert_eq!((left[0], left[29], left[30], left[59], left[60], left[99]), (4, 4, 2, 2, 0, 0));
    assert_eq!(scene.stores_load(own).mass_kg, 0.0);
    assert_eq!(scene.counts()[1], 6);
    let page = scene.snapshot().weapons.unwrap();
    assert_eq!((page.rows[0].left, page.rows[0].loaded, page.selected), (0, 6, Some(0)));
    assert!(scene.order(release(own, "mk82", 1, 1, 0.25, Aim::Nearest)).unwrap_err().to_string().contains("none left"));
    assert_eq!(scene.tallies()[0].tally.released, 6);
}

#[test]
fn a_bodys_stores_are_part_of_its_mass() {
    let mut scene = armed(DVec3::new(0.0, 3_000.0, 0.0), 200.0);
    let id = scene.add_body(&firing_range::brick(DVec3::new(0.0, 3_000.0, 0.0))).unwrap();
    let bare = scene.add_body(&firing_range::brick(DVec3::new(500.0, 3_000.0, 0.0))).unwrap();
    scene.order(load(id, "mk82", 4, DVec3::ZERO)).unwrap();
    run(&mut scene, &plain(), 120);
    let at = |id: StableId| scene.snapshot().bodies.iter().find(|body| body.id == id).unwrap().velocity_mps.length();
    // Drag slows the brick of 100 kg; with 964 kg of stores it slows a tenth as much.
    let (lost, bare) = (100.0 - at(id), 100.0 - at(bare));
    assert!(bare > 5.0 && lost < bare, "{lost} {bare}");
}

#[test]
fn impact_burst_and_score_are_one_point_also_on_moving_targets() {
    let ground = plain();
    let mut scene = armed(DVec3::new(0.0, 1_000.0, 0.0), 200.0);
    let own = scene.own_id();
    for i in 0..12 {
        // In the line of the bombs, which the Earth's turning moves some metres to the east, and driving towards them.
        let at = DVec2::new(1.8 + 1.2 * f64::from(i % 2), -3_150.0 - 25.0 * f64::from(i));
        let route_m = vec![at + DVec2::new(0.0, 400.0), at + DVec2::new(400.0, 400.0)];
        let start = TargetStart { route_m, speed_mps: 15.0, ..TargetStart::standing("truck", at) };
        scene.add_target(&start).unwrap();
    }
    scene.order(load(own, "mk82", 40, DVec3::ZERO)).unwrap();
    scene.order(arm(own, "mk82", Some(Fuze { trigger: Trigger::Impact, arming_s: 1.0 }))).unwrap();
    let in_steps = scene.clock.step() + 120;
    let command = release(own, "mk82", 40, 1, 0.05, Aim::Nearest);
    scene.schedule(sim::scene::Stamped { step: in_steps, command }).unwrap();
    let (mut before, mut on_targets, mut scored) = (scene.snapshot(), 0, 0);
    for _ in 0..4_000 {
        scene.step(&ground);
        let now = scene.snapshot();
        let events = now.events_since(&before);
        for event in events {
            let Happening::Impact(strike) = &event.what else { continue };
            let of = |what: &Happening| match what {
                Happening::Burst { projectile, point_m, .. } if *projectile == strike.projectile => Some(*point_m),
                _ => None,
            };
            let burst_m = events.iter().find_map(|event| of(&event.what)).expect("an armed bomb bursts");
            let score = scores(events).into_iter().find(|score| score.projectile == strike.projectile).unwrap();
            assert_eq!((burst_m, score.point_m), (strike.point_m, strike.point_m));
            scored += 1;
            let Some(id) = strike.target else { continue };
            // Where the picture draws the target at that instant: between the two snapshots.
            let fraction = (event.time_s - before.time_s) / (now.time_s - before.time_s);
            let drawn = sim::Snapshot::interpolate(&before, &now, fraction);
            let target = drawn.targets.iter().find(|target| target.id == id).unwrap();
            let drawn_m = target.position_m + target.attitude * strike.point_in_target_m;
            // A step of at most 15 m/s and 2 m of arm; places of 3 km: roundings of 1e-12, and the sweep's 1e-9.
            assert!(drawn_m.distance(strike.point_m) < 1e-8, "{drawn_m} {}", strike.point_m);
            assert_eq!(score.target, Some(id), "the nearest is the one that it hit");
            on_targets += 1;
        }
        before = now;
    }
    assert!(on_targets >= 3 && scored == 40, "{on_targets} of {scored}");
    let row = &scene.tallies()[0];
    assert!(row.tally.kills >= 3 && row.tally.measured == 40 && row.tally.duds == 0, "{row:?}");
    let destroyed = before.targets.iter().filter(|target| target.damage == Damage::Destroyed);
    assert!(destroyed.clone().count() as u64 == row.tally.kills);
    assert!(destroyed.clone().all(|target| target.burning && target.velocity_mps == DVec3::ZERO));
}

#[test]
fn a_bomb_that_is_not_armed_is_a_dud_and_one_that_is_bursts() {
    for (arming_s, expected) in [(3.0, Outcome::Miss), (20.0, Outcome::Dud)] {
        let fuze = Fuze { trigger: Trigger::Impact, arming_s };
        let events = bombs_over(&plain(), DVec3::new(0.0, 500.0, 0.0), fuze, 1);
        let bursts = events.iter().filter(|event| matches!(event.what, Happening::Burst { .. })).count();
        assert_eq!(scores(&events)[0].outcome, expected);
        assert_eq!(bursts, usize::from(expected == Outcome::Miss));
    }
}

#[test]
fn a_delay_bursts_so_much_later_and_a_deeper_crater_than_an_impact() {
    let crater = |fuze: Fuze| {
        let events = bombs_over(&rough(), DVec3::new(0.0, 800.0, 0.0), fuze, 1);
        let time = |is: &dyn Fn(&Happening) -> bool| events.iter().find(|event| is(&event.what)).unwrap().time_s;
        let (struck_s, burst_s) =
            (time(&|what| matches!(what, Happening::Impact(_))), time(&|what| matches!(what, Happening::Burst { .. })));
        let radius = |what: &Happening| match what {
            Happening::Crater { radius_m, changes_posts, .. } => Some((*radius_m, *changes_posts)),
            _ => None,
        };
        let place = |what: &Happening| match what {
            Happening::Burst { point_m, .. } => Some(*point_m),
            _ => None,
        };
        let impact = |what: &Happening| match what {
            Happening::Impact(strike) => Some(strike.point_m),
            _ => None,
        };
        let first = |is: &dyn Fn(&Happening) -> Option<DVec3>| events.iter().find_map(|event| is(&event.what)).unwrap();
        let way_m = first(&place).distance(first(&impact));
        (burst_s - struck_s, way_m, events.iter().find_map(|event| radius(&event.what)))
    };
    let (now_s, way_m, found) = crater(Fuze { trigger: Trigger::Impact, arming_s: 1.0 });
    let (shallow_m, decal) = found.unwrap();
    assert!(now_s == 0.0 && way_m == 0.0 && !decal);
    let mut before_m = 0.0;
    for delay_s in [0.001, 0.01, 0.05] {
        let (later_s, way_m, found) = crater(Fuze { trigger: Trigger::Delay(delay_s), arming_s: 1.0 });
        let deep_m = found.unwrap().0;
        // Scene times of some tens of seconds: a few roundings.
        assert!((later_s - delay_s).abs() < 1e-12, "{later_s}");
        assert!(way_m > before_m && deep_m > shallow_m && deep_m <= 2.0 * shallow_m, "{way_m} {deep_m} {shallow_m}");
        before_m = way_m;
    }
    // It stops within some tens of milliseconds: a longer delay is no deeper.
    let [(_, stopped_m, _), (_, later_m, _)] =
        [0.5, 1.5].map(|delay_s| crater(Fuze { trigger: Trigger::Delay(delay_s), arming_s: 1.0 }));
    assert!(stopped_m == later_m && stopped_m >= before_m, "{stopped_m} {later_m}");
}

#[test]
fn a_delayed_burst_goes_along_with_what_it_struck_and_is_scored_where_it_struck() {
    let ground = plain();
    let mut scene = armed(DVec3::new(0.0, 2_000.0, 0.0), 200.0);
    let own = scene.own_id();
    let start = TargetStart {
        route_m: vec![DVec2::new(200.0, -900.0), DVec2::new(200.0, 500.0)],
        speed_mps: 20.0,
        ..TargetStart::standing("truck", DVec2::new(0.0, -900.0))
    };
    let id = scene.add_target(&start).unwrap();
    scene.order(load(own, "mk82", 1, DVec3::ZERO)).unwrap();
    scene.order(arm(own, "mk82", Some(Fuze { trigger: Trigger::Delay(0.05), arming_s: 0.0 }))).unwrap();
    run(&mut scene, &ground, 120);
    scene.order(release(own, "mk82", 1, 1, 0.0, Aim::Target(id))).unwrap();
    scene.step(&ground);
    let now = scene.snapshot();
    let (bomb, truck) = (now.projectiles[0].id, now.targets[0]);
    scene
        .order(Command::Reposition {
            id: bomb,
            position_m: truck.position_m + DVec3::new(0.5, 30.0, 0.3),
            velocity_mps: truck.velocity_mps + DVec3::NEG_Y * 300.0,
            attitude: DQuat::IDENTITY,
        })
        .unwrap();
    // As a solid shot of its mass it kills already: what is asked here is where it bursts.
    let (mut before, mut strike, mut seen) = (scene.snapshot(), None, 0);
    for _ in 0..60 {
        scene.step(&ground);
        let now = scene.snapshot();
        for event in now.events_since(&before) {
            match &event.what {
                Happening::Impact(found) => strike = Some(*found),
                Happening::Burst { point_m, buried, .. } => {
                    let fraction = (event.time_s - before.time_s) / (now.time_s - before.time_s);
                    let drawn = sim::Snapshot::interpolate(&before, &now, fraction).targets[0];
                    let struck: sim::scene::Strike = strike.unwrap();
                    let drawn_m = drawn.position_m + drawn.attitude * struck.point_in_target_m;
                    assert!(drawn_m.distance(*point_m) < 1e-8 && !buried, "{drawn_m} {point_m}");
                    seen += 1;
                }
                Happening::Score(score) => {
                    assert_eq!((score.point_m, score.outcome), (strike.unwrap().point_m, Outcome::Kill));
                    seen += 1;
                }
                _ => {}
            }
        }
        before = now;
    }
    assert_eq!(seen, 2);
}

#[test]
fn one_burst_kills_and_hurts_the_share_that_the_curve_gives() {
    let ground = plain();
    let mut scene = armed(DVec3::new(0.0, 2_000.0, 0.0), 200.0);
    let (own, count, radius_m) = (scene.own_id(), 400, 32.0);
    // Lorries all round, their fronts to the middle: the nearest point of each is at the lethal radius, on the ground.
    for i in 0..count {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(count)).sin_cos();
        let at = DVec2::new(sin, cos) * (radius_m + 3.7);
        let start =
            TargetStart { attitude: DQuat::from_rotation_y(sin.atan2(cos)), ..TargetStart::standing("truck", at) };
        scene.add_target(&start).unwrap();
    }
    scene.order(load(own, "mk82", 1, DVec3::ZERO)).unwrap();
    scene.order(arm(own, "mk82", Some(Fuze { trigger: Trigger::Impact, arming_s: 0.0 }))).unwrap();
    scene.order(release(own, "mk82", 1, 1, 0.0, Aim::Place(DVec3::ZERO))).unwrap();
    scene.step(&ground);
    let id = scene.snapshot().projectiles[0].id;
    let (position_m, velocity_mps) = (DVec3::Y * 50.0, DVec3::NEG_Y * 300.0);
    scene.order(Command::Reposition { id, position_m, velocity_mps, attitude: DQuat::IDENTITY }).unwrap();
    let (last, events) = run(&mut scene, &ground, 60);
    let share = |of: fn(Damage) -> bool| {
        last.targets.iter().filter(|target| of(target.damage)).count() as f64 / f64::from(count)
    };
    // Four standard deviations of a share of 400: 0.097 and 0.083.
    let (killed, hurt) = (share(|damage| damage == Damage::Destroyed), share(|damage| damage != Damage::Intact));
    assert!((killed - (-1f64).exp()).abs() < 0.097, "{killed}");
    assert!((hurt - (-0.25f64).exp()).abs() < 0.083, "{hurt}");
    assert_eq!(f64::from(scores(&events)[0].kills), killed * f64::from(count));
}

#[test]
fn a_place_is_an_aim_and_short_and_long_left_and_right_are_told_by_the_clock() {
    let drop = |aim_m: DVec3| {
        let mut scene = armed(DVec3::new(0.0, 1_000.0, 0.0), 200.0);
        let own = scene.own_id();
        scene.order(load(own, "mk82", 1, DVec3::ZERO)).unwrap();
        scene.order(arm(own, "mk82", None)).unwrap();
        scene.order(release(own, "mk82", 1, 1, 0.0, Aim::Place(aim_m))).unwrap();
        scores(&run(&mut scene, &plain(), 120 * 20).1)[0]
    };
    let struck_m = drop(DVec3::ZERO).point_m;
    // The attack goes north (-z); what is aimed 50 m farther was struck short, at 6 o'clock.
    for (off, clock) in [(DVec3::NEG_Z, 6), (DVec3::Z, 12), (DVec3::X, 9), (DVec3::NEG_X, 3)] {
        let score = drop(struck_m + off * 50.0);
        assert_eq!((score.point_m, score.clock, score.target), (struck_m, Some(clock), None));
        assert!((score.miss_m.unwrap() - 50.0).abs() < 1e-9);
    }
}

#[test]
fn a_height_fuze_bursts_at_its_height_over_the_exact_ground() {
    let ground = rough();
    for height_m in [2.0, 15.0, 60.0] {
        let fuze = Fuze { trigger: Trigger::Height(height_m), arming_s: 1.0 };
        let events = bombs_over(&ground, DVec3::new(0.0, 900.0, 500.0), fuze, 8);
        let burst = |what: &Happening| match what {
            Happening::Burst { point_m, in_air: true, .. } => Some(*point_m),
            _ => None,
        };
        let points: Vec<DVec3> = events.iter().filter_map(|event| burst(&event.what)).collect();
        assert_eq!(points.len(), 8);
        for at in points {
            let over_m = at.y - ground.height_m(at.x, at.z).unwrap();
            // The point is on a triangle moved up: a rounding of its height and of the triangle's.
            assert!((over_m - height_m).abs() < 1e-9, "{over_m} m");
        }
    }
    // Armed only when it is lower already: it bursts as it arms.
    let fuze = Fuze { trigger: Trigger::Height(400.0), arming_s: 8.0 };
    let events = bombs_over(&plain(), DVec3::new(0.0, 500.0, 0.0), fuze, 1);
    let burst_s = events.iter().find(|event| matches!(event.what, Happening::Burst { .. })).unwrap().time_s;
    assert!((burst_s - 8.0).abs() < 1e-9, "{burst_s}");
}

#[test]
fn rounds_of_a_gun_add_up_by_class_of_armour() {
    let ground = plain();
    let hits_needed = |kind: &str| {
        let mut scene = armed(DVec3::new(0.0, 300.0, 0.0), 200.0);
        let own = scene.own_id();
        let mut state = AircraftState::level(DVec3::new(0.0, 2.0, 0.0), 0.0, 0.0);
        state.condition = sim::Condition::OnGround;
        scene.place(state);
        scene.order(Command::Freeze(sim::scene::Freeze::Flight)).unwrap();
        let target = TargetStart::standing(kind, DVec2::new(0.0, -60.0));
        let id = scene.add_target(&target).unwrap();
        scene.order(load(own, "m61", 200, DVec3::ZERO)).unwrap();
        scene.order(arm(own, "m61", None)).unwrap();
        scene.order(release(own, "m61", 200, 1, 0.0, Aim::Target(id))).unwrap();
        let (last, events) = run(&mut scene, &ground, 400);
        let hits = last.targets[0].hits;
        assert!(hits > 150, "{hits} of 200 at 60 m");
        assert!(scores(&events).is_empty(), "a gun's rounds are counted, not listed");
        let row = &scene.tallies()[0];
        assert_eq!((row.tally.released, row.weapon.as_str(), row.owner), (200, "m61", own.0));
        (last.targets[0].damage, row.tally.kills)
    };
    assert_eq!(hits_needed("truck"), (Damage::Destroyed, 1));
    assert_eq!(hits_needed("apc"), (Damage::Destroyed, 1));
    assert_eq!(hits_needed("tank"), (Damage::Intact, 0));
    assert_eq!(hits_needed("bunker"), (Damage::Intact, 0));
}

#[test]
fn a_column_drives_at_its_spacing_and_reacts_when_one_is_struck() {
    let ground = rough();
    for reaction in [Reaction::Stop, Reaction::Scatter, Reaction::DriveOn] {
        let mut scene = armed(DVec3::new(0.0, 1_500.0, 2_000.0), 200.0);
        let own = scene.own_id();
        let at = DVec2::new(-2_000.0, 0.0);
        let ids: Vec<StableId> = (0..4)
            .map(|place| {
                let start = TargetStart {
                    route_m: vec![DVec2::new(0.0, 0.0), DVec2::new(0.0, -2_000.0), DVec2::new(1_500.0, -1_500.0)],
                    speed_mps: 10.0,
                    ahead_s: 4.0 * f64::from(3 - place),
                    column: Some(Column { number: 0, reaction }),
                    ..TargetStart::standing("truck", at)
                };
                scene.add_target(&start).unwrap()
            })
            .collect();
        let (first, _) = run(&mut scene, &ground, 240);
        let plan = |of: &sim::scene::EntityView| DVec2::new(of.position_m.x, of.position_m.z);
        for pair in first.targets.windows(2) {
            assert!((plan(&pair[0]).distance(plan(&pair[1])) - 40.0).abs() < 1e-6);
        }
        // A blast beside the second: it stops; the others do what their column does.
        let struck = first.targets[1].position_m + DVec3::new(0.0, 1.0, 2.0);
        // Its blast does not reach 40 m.
        scene.order(load(own, "hydra70", 1, DVec3::ZERO)).unwrap();
        scene.order(arm(own, "hydra70", Some(Fuze { trigger: Trigger::Impact, arming_s: 0.0 }))).unwrap();
        scene.order(release(own, "hydra70", 1, 1, 0.0, Aim::Target(ids[1]))).unwrap();
        scene.step(&ground);
        let bomb = scene.snapshot().projectiles[0].id;
        let above = DVec3 { y: struck.y + 20.0, ..struck };
        scene
            .order(Command::Reposition {
                id: bomb,
                position_m: above,
                velocity_mps: DVec3::NEG_Y * 300.0,
                attitude: DQuat::IDENTITY,
            })
            .unwrap();
        let (after, _) = run(&mut scene, &ground, 120);
        assert_eq!(after.targets[1].damage, Damage::Destroyed);
        let (later, _) = run(&mut scene, &ground, 2_400);
        let way = |i: usize| plan(&later.targets[i]).distance(plan(&after.targets[i]));
        let speed = |i: usize| later.targets[i].velocity_mps.length();
        assert!(way(1) == 0.0);
        match reaction {
            Reaction::Stop => assert!(way(0) == 0.0 && way(3) == 0.0),
            Reaction::DriveOn => assert!((way(0) - 200.0).abs() < 1e-6),
            // 40 m ahead and aside, less what it drove in the second before.
            Reaction::Scatter => {
                assert!(way(3) > 30.0 && way(3) < 75.0 && speed(3) == 0.0, "{} {}", way(3), speed(3));
                let aside = |i: usize| (later.targets[i].position_m - after.targets[i].position_m).z;
                assert!(aside(2) * aside(3) < 0.0, "to the left and to the right");
            }
        }
    }
}

/// Trucks that drive round under an own aircraft that is armed and will do nothing.
fn quiet(delay_s: f64) -> Scene {
    let mut scene = armed(DVec3::new(-1_500.0, 900.0, 500.0), 220.0);
    let own = scene.own_id();
    for i in 0..10 {
        let at = DVec2::new(-1_560.0 + 13.0 * f64::from(i), -2_560.0);
        let route_m = vec![at + DVec2::new(200.0, 50.0), at + DVec2::new(100.0, 300.0)];
        let kind = ["truck", "tank", "apc"][i as usize % 3];
        let column = Some(Column { number: 1, reaction: Reaction::Scatter });
        let start = TargetStart { route_m, speed_mps: 9.0, loops: true, column, ..TargetStart::standing(kind, at) };
        scene.add_target(&start).unwrap();
    }
    for (weapon, rounds, at_m) in [("mk82", 6, DVec3::Y), ("hydra70", 19, DVec3::NEG_Y), ("gsh23", 200, DVec3::X)] {
        scene.order(load(own, weapon, rounds, at_m)).unwrap();
    }
    scene.order(arm(own, "mk82", Some(Fuze { trigger: Trigger::Delay(delay_s), arming_s: 0.5 }))).unwrap();
    scene
}

/// The same, and it will release everything that it has.
fn attack(delay_s: f64) -> Scene {
    let mut scene = quiet(delay_s);
    let own = scene.own_id();
    for (step, weapon, rounds) in [(10, "gsh23", 120), (20, "hydra70", 12), (40, "mk82", 6)] {
        let command = release(own, weapon, rounds, 1, 0.1, Aim::Nearest);
        scene.schedule(sim::scene::Stamped { step, command }).unwrap();
    }
    scene
}

#[test]
fn hostile_bytes_are_refused_or_step_but_never_panic() {
    let ground = rough();
    let mut scene = attack(0.4);
    let mut random = StdRng::seed_from_u64(SEED_BYTES);
    let (mut taken, mut told) = (0, 0);
    // With bursts under way; and with scores, damage and a delay that runs.
    for steps in [60, 1_560] {
        run(&mut scene, &ground, steps);
        let good = scene.save();
        for _ in 0..1_000 {
            let mut bytes = good.clone();
            for _ in 0..random.random_range(1..4) {
                let at = random.random_range(12..bytes.len() - 8);
                bytes[at] = if random.random_bool(0.5) { 0xff } else { random.random_range(0..=255u8) };
            }
            match Scene::restore(&sealed(bytes), scene.catalogue().clone()) {
                Ok(mut scene) => {
                    taken += 1;
                    run(&mut scene, &ground, 2);
                }
                Err(error) => {
                    told += 1;
                    assert!(error.to_string().contains("expected"), "{error}");
                }
            }
        }
    }
    assert!(taken > 100 && told > 100, "{taken} taken, {told} refused");
}

/// Bytes with the checksum (FNV-1a) that they should have.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 8;
    let sum = bytes[..end]
        .iter()
        .fold(0xcbf2_9ce4_8422_2325u64, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3));
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

/// A delay after which a bomb in the ground is not yet so deep that its burst is smothered.
const SHALLOW_S: f64 = 0.012;

#[test]
fn a_run_with_weapons_repeats_replays_and_restores_to_the_bit() {
    let ground = rough();
    let mut whole = attack(SHALLOW_S);
    whole.start_record();
    let (last, events) = run(&mut whole, &ground, 2_400);
    let hurt = events.iter().any(|event| matches!(event.what, Happening::Damage { .. }));
    let told: Vec<_> = scores(&events).iter().map(|one| (one.weapon, one.miss_m, one.clock, one.point_m)).collect();
    assert!(hurt, "something was hurt: {told:?}");
    let mut again = attack(SHALLOW_S);
    let (twin, _) = run(&mut again, &ground, 2_400);
    assert_eq!((whole.hash(), last.hash()), (again.hash(), twin.hash()));
    let mut replayed = quiet(SHALLOW_S);
    assert_eq!(whole.record().len(), 3);
    for stamped in whole.record() {
        replayed.schedule(stamped.clone()).unwrap();
    }
    run(&mut replayed, &ground, 2_400);
    assert_eq!(replayed.hash(), whole.hash());
    // Cut anywhere, also while a delay runs.
    let mut cut = attack(SHALLOW_S);
    for step in 0..2_400 {
        if step % 97 == 0 {
            cut = Scene::restore(&cut.save(), cut.catalogue().clone()).unwrap();
        }
        cut.step(&ground);
    }
    assert_eq!(cut.hash(), whole.hash());
    assert_eq!(cut.snapshot().weapons, last.weapons, "the page follows from the rest");
}

#[test]
fn ships_keep_the_level_and_turn_no_faster_than_they_can() {
    let mut scene = armed(DVec3::new(0.0, 3_000.0, 0.0), 200.0);
    let start = TargetStart {
        route_m: vec![DVec2::new(0.0, -600.0), DVec2::new(600.0, -600.0), DVec2::new(0.0, -500.0)],
        speed_mps: 10.0,
        height: Height::Msl(1_607.0),
        ..TargetStart::standing("ship", DVec2::ZERO)
    };
    scene.add_target(&start).unwrap();
    let mut before = scene.snapshot().targets[0].attitude;
    let most_rad = 4f64.to_radians() / 120.0;
    for _ in 0..120 * 200 {
        scene.step(&SceneGround::void());
        let ship = scene.snapshot().targets[0];
        // Its reference point is 4 m over the keel, 2 m of which are under water.
        assert_eq!(ship.position_m.y, 1_609.0);
        let turn = before.angle_between(ship.attitude);
        assert!(turn <= most_rad + 1e-7, "{turn}");
        before = ship.attitude;
    }
    assert!(scene.snapshot().targets[0].position_m.distance(DVec3::new(0.0, 1_609.0, -500.0)) < 1e-6);
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let mut scene = armed(DVec3::new(0.0, 3_000.0, 0.0), 200.0);
    let own = scene.own_id();
    scene.order(load(own, "mk82", 2, DVec3::ZERO)).unwrap();
    scene.order(arm(own, "mk82", None)).unwrap();
    let before = scene.hash();
    for (command, told) in [
        (load(StableId(99), "mk82", 1, DVec3::ZERO), "found 99"),
        (load(own, "moab", 1, DVec3::ZERO), "expected one of [gsh23"),
        (load(own, "mk82", 1, DVec3::X * 1e6), "offset_m"),
        (load(own, "mk82", 1, DVec3::NAN), "finite"),
        (load(own, "mk82", 5_000, DVec3::ZERO), "expected stores of up to 1000000 kg"),
        (arm(own, "moab", None), "found moab"),
        (arm(own, "mk82", Some(Fuze { trigger: Trigger::Delay(-1.0), arming_s: 0.0 })), "fuze.delay_s"),
        (arm(StableId(99), "mk82", None), "found 99"),
        (release(own, "mk82", 0, 1, 0.1, Aim::Nearest), "rounds"),
        (release(own, "mk82", 1, 0, 0.1, Aim::Nearest), "together"),
        (release(own, "mk82", 1, 1, -0.1, Aim::Nearest), "interval_s"),
        (release(own, "s5", 1, 1, 0.1, Aim::Nearest), "found none left"),
        (release(own, "mk82", 1, 1, 0.1, Aim::Target(StableId(7))), "found 7"),
    ] {
        let why = scene.order(command.clone()).unwrap_err().to_string();
        assert!(why.contains(told), "{command:?}: {why}");
    }
    assert_eq!(scene.hash(), before);
    let fast =
        TargetStart { route_m: vec![DVec2::X * 90.0], speed_mps: 90.0, ..TargetStart::standing("truck", DVec2::ZERO) };
    assert!(scene.add_target(&fast).unwrap_err().to_string().contains("at most 22"));
}
