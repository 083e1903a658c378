//! The scene as a whole: determinism, modes, extremes, and the thread on the wall clock.

use proptest::prelude::*;
use sim::aircraft::AircraftState;
use sim::run::Message;
use sim::track::{Flight, ISSYK_KUL_FLIGHT, TrackHeight};
use sim::{Command, Condition, Controls, Mode, Scene, SceneGround, SimThread, Snapshot, Track, UtcTime, lockstep};
use std::sync::Arc;
use std::time::Duration;

fn noon() -> UtcTime {
    UtcTime::parse("2026-06-21T06:00:00Z").unwrap()
}

fn scene(altitude_m: f64, speed_mps: f64) -> Scene {
    Scene::new(AircraftState::level(glam::DVec3::new(0.0, altitude_m, 0.0), 0.3, speed_mps), noon())
}

fn hills(x_m: f64, z_m: f64) -> Option<f64> {
    Some(800.0 + 600.0 * (x_m / 2_500.0).sin() * (z_m / 1_900.0).cos())
}

fn hilly() -> SceneGround {
    SceneGround::heights(hills)
}

/// Stick movements that depend on the step alone.
fn stick(step: u32) -> Controls {
    let t = f64::from(step) / 120.0;
    Controls { pitch: 0.4 * (0.7 * t).sin(), roll: (0.3 * t).cos(), yaw: 0.1, throttle: 0.7 }
}

fn flown(steps: u32, ground: &SceneGround) -> (u64, Arc<Snapshot>) {
    let mut scene = scene(3_000.0, 180.0);
    let mut last = lockstep(&mut scene, ground, 0);
    for step in 0..steps {
        scene.set_controls(stick(step));
        last = lockstep(&mut scene, ground, 1);
    }
    (last.hash(), last)
}

#[test]
fn two_runs_give_the_same_hash_and_one_bit_another() {
    let (first, last) = flown(3_600, &hilly());
    assert_eq!(first, flown(3_600, &hilly()).0);
    let mut other = (*last).clone();
    other.aircraft.position_m.x = f64::from_bits(other.aircraft.position_m.x.to_bits() ^ 1);
    assert_ne!(other.hash(), first);
    assert_ne!(flown(3_599, &hilly()).0, first);
    let mut slowed = (*last).clone();
    slowed.slowed_s += 1.0;
    assert_eq!(slowed.hash(), first, "how slow the machine was is not part of the scene");
}

#[test]
fn interpolation_meets_its_ends_and_does_not_cross_a_jump() {
    let mut scene = scene(3_000.0, 180.0);
    scene.set_controls(stick(0));
    let a = lockstep(&mut scene, &hilly(), 30);
    let b = lockstep(&mut scene, &hilly(), 1);
    let start = Snapshot::interpolate(&a, &b, 0.0);
    assert!((start.aircraft.position_m - a.aircraft.position_m).length() < 1e-9);
    assert!(start.aircraft.attitude.dot(a.aircraft.attitude) > 1.0 - 1e-14);
    let middle = Snapshot::interpolate(&a, &b, 0.5);
    let expected = 0.5 * (a.aircraft.position_m + b.aircraft.position_m);
    assert!((middle.aircraft.position_m - expected).length() < 1e-9);
    assert!((middle.aircraft.attitude.length() - 1.0).abs() < 1e-12);
    for t in [1.0, 7.0, f64::NAN] {
        assert_eq!(Snapshot::interpolate(&a, &b, t).aircraft.position_m, b.aircraft.position_m);
    }
    scene.command(Command::Reset);
    let c = lockstep(&mut scene, &hilly(), 0);
    assert_eq!(Snapshot::interpolate(&b, &c, 0.1), *c);
}

#[test]
fn pause_stops_time_freeze_only_the_aircraft() {
    let mut scene = scene(3_000.0, 180.0);
    scene.command(Command::Pause);
    let before = lockstep(&mut scene, &hilly(), 100);
    assert_eq!((before.step, before.flags.paused), (0, true));
    scene.command(Command::Pause);
    scene.command(Command::Freeze);
    let after = lockstep(&mut scene, &hilly(), 120);
    assert_eq!((after.step, after.aircraft.position_m), (120, before.aircraft.position_m));
    assert_eq!(after.date, noon().plus_s(1.0));
    scene.command(Command::TimeForward);
    scene.command(Command::DateBack);
    assert_eq!(scene.snapshot().date, noon().plus_s(1.0 + 3_600.0 - 30.0 * 86_400.0));
}

#[test]
fn reset_flies_again_after_a_crash() {
    let mut scene = scene(900.0, 200.0);
    scene.set_controls(Controls { pitch: -1.0, ..Controls::default() });
    let plain = SceneGround::heights(|_, _| Some(500.0));
    let end = lockstep(&mut scene, &plain, 120 * 30);
    assert_eq!((end.aircraft.condition, end.flags.crashed), (Condition::Crashed, true));
    assert_eq!(end.aircraft.position_m.y, 502.0);
    scene.command(Command::Reset);
    scene.set_controls(Controls::default());
    let again = lockstep(&mut scene, &plain, 120);
    assert!(!again.flags.crashed && again.aircraft.airspeed_mps > 150.0);
}

#[test]
fn slewing_moves_and_leaving_it_flies() {
    let mut scene = scene(2_000.0, 150.0);
    scene.command(Command::Slew);
    scene.set_controls(Controls { pitch: -1.0, ..Controls::default() });
    let there = lockstep(&mut scene, &hilly(), 240);
    assert_eq!(there.flags.mode, Mode::Slew);
    assert!(there.aircraft.position_m.length() > 1_000.0);
    scene.command(Command::Slew);
    scene.set_controls(Controls::default());
    let flying = lockstep(&mut scene, &hilly(), 120);
    assert!(flying.flags.mode == Mode::Pilot && flying.aircraft.airspeed_mps > 100.0);
}

#[test]
fn a_track_is_flown_at_any_speed_and_can_be_taken_over() {
    for speed_mps in [0.0, 300.0, 3_000.0, 10_000.0] {
        let height = TrackHeight::AboveHighest { clearance_m: 200.0, ahead_m: 2_000.0 };
        let track = Track::centred((0.0, 0.0), 0.8, 60_000.0, speed_mps, height, &hills).unwrap();
        let start = track.at(0.0).position_m;
        let mut scene = scene(3_000.0, 100.0);
        scene.fly_track(track);
        let end = lockstep(&mut scene, &hilly(), 240);
        let way = (end.aircraft.position_m - start) * glam::DVec3::new(1.0, 0.0, 1.0);
        // Along a way with hills of at most 0.1 m/m the plan distance is shorter by under half a percent.
        assert!(
            (way.length() - 2.0 * speed_mps).abs() <= 0.005 * 2.0 * speed_mps + 1e-9,
            "{speed_mps}: {}",
            way.length()
        );
        assert!(end.height_above_ground_m.unwrap() >= 2.0);
        scene.command(Command::Track);
        let taken = lockstep(&mut scene, &hilly(), 120);
        assert!(taken.flags.mode == Mode::Pilot && taken.aircraft.is_finite());
    }
}

#[test]
fn the_scenic_flight_runs_in_a_scene() {
    let plan = |lat_deg: f64, lon_deg: f64| ((lon_deg - 78.35) * 82_200.0, -(lat_deg - 42.425) * 111_100.0);
    let track = Track::through(&Flight::parse(ISSYK_KUL_FLIGHT).unwrap(), &plan).unwrap();
    let end_m = track.length_m();
    let mut scene = scene(3_000.0, 100.0);
    scene.fly_track(track);
    assert!(!lockstep(&mut scene, &SceneGround::void(), 10).flags.track_ended);
    scene.seek_track(end_m);
    assert!(lockstep(&mut scene, &SceneGround::void(), 10).flags.track_ended);
}

#[test]
fn extremes_stay_finite() {
    for ground in [hilly(), SceneGround::void(), SceneGround::heights(|_, _| Some(f64::NAN))] {
        for (altitude_m, speed_mps) in
            [(0.0, 0.0), (-5_000.0, 50.0), (50_000.0, 10_000.0), (3_000.0, f64::NAN), (f64::INFINITY, 1.0)]
        {
            let mut scene = scene(altitude_m, speed_mps);
            for step in 0..1_200 {
                let v = [f64::NAN, 1.0, -1.0, f64::INFINITY, 1e300][step % 5];
                scene.set_controls(Controls { pitch: v, roll: -v, yaw: v, throttle: v });
                let snapshot = lockstep(&mut scene, &ground, 1);
                assert!(snapshot.aircraft.is_finite(), "{altitude_m} m, {speed_mps} m/s, step {step}");
                if let Some(height_m) = snapshot.height_above_ground_m {
                    assert!(height_m >= 2.0 - 1e-9, "{height_m}");
                }
            }
        }
    }
}

#[test]
fn the_thread_keeps_wall_time_publishes_and_hands_the_scene_back() {
    let thread = SimThread::start(scene(3_000.0, 180.0), hilly()).unwrap();
    std::thread::sleep(Duration::from_millis(600));
    let (before, last) = thread.last_two();
    assert_eq!(before.step + 1, last.step);
    // 72 steps in 0.6 s; a loaded machine may give fewer and then says so.
    let expected = (0.6 - last.slowed_s) * 120.0;
    assert!((last.step as f64) < expected + 30.0 && last.step > 5, "{} steps, slowed {}", last.step, last.slowed_s);
    let now = thread.now();
    assert!(now.time_s >= before.time_s && now.aircraft.is_finite());
    assert!(thread.send(Message::Command(Command::Pause)));
    std::thread::sleep(Duration::from_millis(200));
    let paused = thread.last_two().1;
    assert!(paused.flags.paused);
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(thread.last_two().1.step, paused.step);
    // Said twice is not taken back, as the command would be.
    assert!(thread.send(Message::Paused(true)));
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(thread.last_two().1.step, paused.step);
    assert!(thread.send(Message::Paused(false)) && thread.send(Message::Paused(false)));
    std::thread::sleep(Duration::from_millis(300));
    assert!(thread.last_two().1.step > paused.step);
    let scene = thread.stop().unwrap();
    assert!(scene.snapshot().step > paused.step);
}

#[test]
fn a_stall_in_the_ground_slows_and_does_not_spiral() {
    // Each step takes 20 ms where 8.3 would be due: the simulation runs at less than half its speed, for good.
    let slow = |x: f64, z: f64| {
        std::thread::sleep(Duration::from_millis(10));
        hills(x, z)
    };
    let thread = SimThread::start(scene(3_000.0, 180.0), SceneGround::heights(slow)).unwrap();
    std::thread::sleep(Duration::from_millis(1_500));
    let last = thread.last_two().1;
    assert!(last.slowed_s > 0.2 && last.step < 120, "{} steps, slowed {}", last.step, last.slowed_s);
    thread.stop().unwrap();
}

#[test]
fn a_ground_that_fails_is_reported_not_passed_on() {
    let broken = SceneGround::heights(|_, _| panic!("no tile"));
    let thread = SimThread::start(scene(3_000.0, 180.0), hilly()).unwrap();
    thread.send(Message::Ground(broken));
    let patience = std::time::Instant::now();
    while thread.is_running() && patience.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(!thread.is_running() && thread.now().aircraft.is_finite());
    assert_eq!(thread.stop().err().map(|e| e.to_string()).as_deref(), Some("the simulation stopped: no tile"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn any_flight_stays_above_ground_and_finite(
        altitude_m in 0.0..9_000.0, speed_mps in 0.0..2_000.0, pitch in -1.0..1.0, roll in -1.0..1.0, throttle in 0.0..1.0,
    ) {
        let mut scene = scene(altitude_m, speed_mps);
        scene.set_controls(Controls { pitch, roll, yaw: 0.0, throttle });
        for _ in 0..60 {
            let snapshot = lockstep(&mut scene, &hilly(), 20);
            prop_assert!(snapshot.aircraft.is_finite());
            prop_assert!(snapshot.height_above_ground_m.unwrap() > 2.0 - 1e-9);
            prop_assert!((snapshot.aircraft.attitude.length() - 1.0).abs() < 1e-9);
        }
    }
}
