//! Tests of the whole display.

use super::*;

fn level() -> HudInput<'static> {
    HudInput {
        speed_mps: 250.0,
        altitude_m: 4_210.0,
        height_above_ground_m: Some(1_234.0),
        true_heading_rad: 1.2,
        pitch_rad: 0.0,
        roll_rad: 0.0,
        vertical_speed_mps: -3.25,
        velocity_in_view_mps: [0.0, -6.0, -250.0],
        load_factor: 1.0,
        throttle: 0.5,
        frame_ms: 16.7,
        date: "2026-06-21 06:30 UTC",
        status: &["PAUSED", "SLEW"],
        hint: "ESC QUIT",
        mouse: Some([0.3, -0.5]),
        viewport_px: (1280, 720),
        fov_y_rad: 60f64.to_radians(),
        instruments: Instruments {
            side_g: Some(0.02),
            alpha_rad: Some(0.06),
            stalling: false,
            qnh_pa: Some(101_325.0),
            engine: Some(Engine { rpm: 2_330.0, most_rpm: 2_700.0, throttle: 0.75, mixture: Some(1.0), running: true }),
            fuel_kg: Some([98.0, 116.0]),
            flaps_rad: Some([0.0, 0.7]),
            trim: Some(-0.1),
            gear: Some(1.0),
            brakes: Some(0.5),
            parked: false,
        },
        weapons: Some(WeaponPage {
            stores: &[Store { name: "GUN 23 mm", left: 480 }, Store { name: "Mk 82", left: 4 }],
            selected: Some(1),
            armed: true,
            release: "RIPPLE 2 X 0.2 S",
            sight: Sight::Impact { in_view_m: [20.0, -300.0, -1_200.0], time_s: 6.2, safe: true },
        }),
        brightness: 1.0,
        looking_ahead: true,
    }
}

fn assert_inside(input: &HudInput) -> usize {
    let (lines, texts) = hud(input);
    let (width, height) = (input.viewport_px.0 as f32, input.viewport_px.1 as f32);
    // A float's rounding of a pixel place of up to 8,192.
    let slack = 1e-3;
    for line in &lines {
        assert!(line.points_px.len() >= 2 && line.width_px.is_finite() && line.width_px > 0.0);
        for [x, y] in &line.points_px {
            assert!((0.0..=width + slack).contains(x) && (0.0..=height + slack).contains(y), "{input:?} {x} {y}");
        }
    }
    for text in &texts {
        let long = text_width(&text.text) * text.height_px;
        let left = match text.anchor {
            Anchor::Left => text.at_px[0],
            Anchor::Centre => text.at_px[0] - 0.5 * long,
            Anchor::Right => text.at_px[0] - long,
        };
        assert!(left >= -slack && left + long <= width + slack, "{text:?}");
        let half = 0.5 * text.height_px;
        assert!(text.at_px[1] - half >= -slack && text.at_px[1] + half <= height + slack, "{text:?}");
        assert!(text.text.is_ascii() && !text.text.contains("NaN") && !text.text.contains("inf"), "{text:?}");
    }
    lines.len() + texts.len()
}

#[test]
fn everything_stays_within_the_viewport_at_every_attitude_and_size() {
    for viewport_px in [
        (0, 0),
        (1, 1),
        (1, 4_320),
        (7_680, 1),
        (64, 64),
        (320, 200),
        (720, 1_280),
        (1_280, 720),
        (3_440, 1_440),
        (7_680, 4_320),
    ] {
        for pitch in -9..=9 {
            for roll in -6..=6 {
                let input = HudInput {
                    pitch_rad: f64::from(pitch) * 0.1745,
                    roll_rad: f64::from(roll) * std::f64::consts::FRAC_PI_6,
                    true_heading_rad: f64::from(pitch * 7 + roll),
                    viewport_px,
                    ..level()
                };
                assert_inside(&input);
            }
        }
    }
}

#[test]
fn wild_numbers_are_dashes_not_nan() {
    for v in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0, -0.0] {
        let input = HudInput {
            speed_mps: v,
            altitude_m: v,
            height_above_ground_m: Some(v),
            true_heading_rad: v,
            pitch_rad: v,
            roll_rad: v,
            vertical_speed_mps: v,
            velocity_in_view_mps: [v; 3],
            load_factor: v,
            throttle: v,
            frame_ms: v,
            fov_y_rad: v,
            date: "юный \u{0} date that is much longer than anything one would ever want to read here",
            status: &["A STATUS LONGER THAN ANY SCREEN IS WIDE, AND THEN SOME MORE OF IT, AND MORE STILL"],
            hint: "A HINT LONGER THAN ANY SCREEN IS WIDE, AND THEN SOME MORE OF IT, AND MORE STILL, AND ON AND ON",
            ..level()
        };
        assert!(assert_inside(&input) > 10);
    }
}

#[test]
fn the_horizon_rung_lies_on_the_horizon() {
    let input = HudInput { pitch_rad: 0.1, roll_rad: 0.4, ..level() };
    let focal_px = 360.0 / 30f64.to_radians().tan();
    let (lines, _) = hud(&input);
    // The horizon is the set of screen points (x, y) whose ray is level: in view axes (x, -y, -focal) dot up = 0,
    // with up turned by pitch and roll.
    let (sin_roll, cos_roll) = 0.4f64.sin_cos();
    let off_px = |p: &[f32; 2]| {
        let (x, y) = (f64::from(p[0]) - 640.0, 360.0 - f64::from(p[1]));
        let across = -x * sin_roll + y * cos_roll;
        across * 0.1f64.cos() + focal_px * 0.1f64.sin()
    };
    let on_horizon = lines.iter().filter(|line| line.points_px.iter().all(|p| off_px(p).abs() < 0.01)).count();
    assert_eq!(on_horizon, 2);
}

#[test]
fn level_flight_is_symmetric_left_and_right() {
    let (lines, _) = hud(&HudInput {
        true_heading_rad: 0.0,
        speed_mps: 0.0,
        altitude_m: 0.0,
        instruments: Instruments { side_g: Some(0.0), ..Instruments::default() },
        weapons: None,
        ..level()
    });
    let ends = |line: &HudLine, mirror: bool| {
        let key = |p: &[f32; 2]| {
            let x = if mirror { 1_280.0 - p[0] } else { p[0] };
            ((x * 8.0).round() as i32, (p[1] * 8.0).round() as i32)
        };
        let mut keys: Vec<_> = line.points_px.iter().map(key).collect();
        keys.sort_unstable();
        keys.dedup();
        keys
    };
    // The tapes' scales differ by nature; all else has its mirror image.
    let middle: Vec<&HudLine> =
        lines.iter().filter(|l| l.points_px.iter().all(|p| (p[0] - 640.0).abs() < 320.0)).collect();
    assert!(middle.len() > 40);
    for line in &middle {
        assert!(middle.iter().any(|other| ends(other, true) == ends(line, false)), "{line:?}");
    }
}

#[test]
fn numbers_read_as_a_pilot_expects() {
    let (_, texts) = hud(&HudInput { instruments: Instruments::default(), ..level() });
    let has = |text: &str| texts.iter().any(|t| t.text == text);
    for text in ["900", "4210", "069", "AGL 1234", "V/S -3.3", "G 1.0", "THR 50", "PAUSED  SLEW", "16.7 MS 60 FPS"] {
        assert!(has(text), "{text} in {:?}", texts.iter().map(|t| &t.text).collect::<Vec<_>>());
    }
    let (_, texts) = hud(&HudInput { true_heading_rad: -0.001, vertical_speed_mps: -0.01, ..level() });
    assert!(texts.iter().any(|t| t.text == "000") && texts.iter().any(|t| t.text == "V/S 0.0"));
}

#[test]
fn instruments_take_no_place_where_there_are_none_and_warn_in_amber() {
    let texts = |instruments: Instruments| hud(&HudInput { instruments, weapons: None, ..level() }).1;
    let all = level().instruments;
    let bare = texts(Instruments::default());
    for name in ["RPM", "THR", "MIX", "FUEL", "FLAP", "TRIM", "GEAR", "BRK", "QNH 1013", "AOA 3.4"] {
        assert!(!bare.iter().any(|t| t.text == name), "{name}");
        assert!(texts(all).iter().any(|t| t.text == name), "{name}");
    }
    let value = |texts: &[HudText], of: &str| texts.iter().find(|t| t.text == of).map(|t| t.colour);
    let engine = all.engine.map(|engine| Engine { running: false, ..engine });
    assert_eq!(value(&texts(Instruments { engine, ..all }), "OFF"), Some(sheet::AMBER));
    assert_eq!(value(&texts(Instruments { fuel_kg: Some([9.0, 116.0]), ..all }), "9 KG"), Some(sheet::AMBER));
    assert_eq!(value(&texts(Instruments { gear: Some(0.4), ..all }), "MOVING"), Some(sheet::AMBER));
    assert_eq!(value(&texts(Instruments { parked: true, ..all }), "PARKED"), Some(sheet::AMBER));
    assert!(value(&texts(Instruments { stalling: true, ..all }), "STALL").is_some());
}

#[test]
fn the_pipper_lies_where_the_impact_is_in_the_picture() {
    let sight = Sight::Impact { in_view_m: [20.0, -150.0, -1_200.0], time_s: 6.2, safe: true };
    let weapons = level().weapons.map(|page| WeaponPage { sight, ..page });
    let bare = hud(&HudInput { weapons: None, ..level() }).0;
    let with = hud(&HudInput { weapons, ..level() }).0;
    let focal_px = 360.0 / 30f64.to_radians().tan();
    let at = [640.0 + focal_px * 20.0 / 1_200.0, 360.0 + focal_px * 150.0 / 1_200.0];
    let is_ring = |line: &&HudLine| {
        let middle = |axis: usize| {
            let points = &line.points_px[1..];
            points.iter().map(|p| f64::from(p[axis])).sum::<f64>() / points.len() as f64
        };
        line.points_px.len() == 21 && (middle(0) - at[0]).abs() < 0.01 && (middle(1) - at[1]).abs() < 0.01
    };
    assert_eq!(with.iter().filter(is_ring).count(), 1);
    assert_eq!(bare.iter().filter(is_ring).count(), 0);
    // Behind the eye there is no picture of it, and none is drawn.
    let behind = Sight::Impact { in_view_m: [0.0, -150.0, 900.0], time_s: 6.2, safe: true };
    let weapons = level().weapons.map(|page| WeaponPage { sight: behind, ..page });
    assert_eq!(hud(&HudInput { weapons, ..level() }).0.iter().filter(|line| line.points_px.len() == 21).count(), 0);
}

#[test]
fn at_night_it_is_dimmed_as_a_whole() {
    let day = hud(&level());
    let night = hud(&HudInput { brightness: 0.25, ..level() });
    assert_eq!(day.0.len(), night.0.len());
    for (day, night) in day.0.iter().zip(&night.0) {
        assert_eq!(night.colour, [day.colour[0] * 0.25, day.colour[1] * 0.25, day.colour[2] * 0.25, day.colour[3]]);
    }
}
