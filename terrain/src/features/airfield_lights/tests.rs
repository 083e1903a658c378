//! What a pilot sees of an airfield's lights, from where.

use super::*;
use crate::features::model::{Mast, MastClass, Origin};
use crate::field::Field;
use crate::grid::Grid;
use crate::ground::Ground;
use std::sync::Arc;

fn field(length_m: f64, heading_deg: f64) -> Airfield {
    let (sin, cos) = heading_deg.to_radians().sin_cos();
    let ahead = DVec2::new(sin, -cos);
    let first = DVec2::new(137.0, -411.0);
    Airfield {
        code: "TEST".into(),
        name: "Test".into(),
        reference: first,
        level_m: 681.0,
        runways: vec![Runway {
            ends: [first, first + ahead * length_m],
            width_m: 45.0,
            designators: ["06".into(), "24".into()],
            surface: RunwaySurface::Asphalt,
            lit: true,
            from: Origin::Stated,
        }],
        taxiways: vec![(vec![first + DVec2::new(0.0, 180.0), first + DVec2::new(900.0, 180.0)], 23.0)],
        aprons: vec![],
    }
}

/// What is seen of a light, by name of colour.
fn seen(light: &LightPoint, eye: DVec3) -> &'static str {
    let base = DVec3::new(light.at.x, 681.0 + f64::from(light.above_m), light.at.y);
    let [red, green, blue] = light.towards(eye - base);
    if red.max(green).max(blue) < 0.01 {
        "dark"
    } else if green < 0.1 * red {
        "red"
    } else if red < 0.1 * green {
        "green"
    } else if blue < 0.2 * red {
        "yellow"
    } else {
        "white"
    }
}

#[test]
fn a_papi_shows_the_glide_slope_from_either_side() {
    for (length_m, heading_deg) in [(4_400.0, 53.0), (2_200.0, 301.0), (900.0, 180.0)] {
        let field = field(length_m, heading_deg);
        for end in [0, 1] {
            let runway = &field.runways[0];
            let (ahead, right) = ahead_and_right(runway, end);
            let mut units = Vec::new();
            papi(runway, end, &mut units);
            let aim = runway.ends[end] + ahead * aiming_point_m(length_m);
            for unit in &units {
                assert!((unit.at - aim).dot(right) < -0.5 * 45.0, "left of the runway");
                assert!((unit.at - aim).dot(ahead).abs() < 1e-9, "beside the aiming point");
            }
            for (glide_deg, whites) in [(2.3_f64, 0), (2.7, 1), (3.0, 2), (3.3, 3), (3.7, 4)] {
                let plan = aim - ahead * 4_000.0;
                let eye = DVec3::new(plan.x, 681.0 + 4_000.0 * glide_deg.to_radians().tan(), plan.y);
                let colours: Vec<_> = units.iter().map(|unit| seen(unit, eye)).collect();
                // The unit nearest the runway is first and the last to turn white.
                let expected: Vec<_> = (0..4).map(|at| if at < 4 - whites { "red" } else { "white" }).collect();
                assert_eq!(colours, expected, "{glide_deg} degrees, runway {length_m}");
            }
        }
    }
}

#[test]
fn a_unit_turns_from_red_to_white_within_three_minutes_of_arc() {
    let field = field(2_500.0, 0.0);
    let mut units = Vec::new();
    papi(&field.runways[0], 0, &mut units);
    let (ahead, _) = ahead_and_right(&field.runways[0], 0);
    let colour = |minutes: f64| {
        let up = (PAPI_DEG[1] + minutes / 60.0).to_radians();
        units[1].towards(DVec3::new(-ahead.x * up.cos(), up.sin(), -ahead.y * up.cos()) * 5_000.0)
    };
    // Half the transition either side, and 0.01 minutes for the angle as f32.
    assert_eq!(colour(-1.51), RED);
    assert_eq!(colour(1.51), COOL);
    let between = colour(0.0);
    assert!(between[1] > RED[1] + 0.3 && between[1] < COOL[1] - 0.3, "{between:?}");
}

#[test]
fn edges_are_white_then_yellow_and_no_more_than_sixty_metres_apart() {
    for (length_m, caution_m) in [(4_400.0, 600.0), (1_230.0, 410.0)] {
        let field = field(length_m, 53.0);
        let runway = &field.runways[0];
        let mut lights = Vec::new();
        edges(runway, &mut lights);
        for end in [0, 1] {
            let (ahead, right) = ahead_and_right(runway, end);
            let mut left: Vec<&LightPoint> =
                lights.iter().filter(|light| (light.at - runway.ends[end]).dot(right) < 0.0).collect();
            left.retain(|light| light.beam == Beam::TwoSided);
            left.sort_by(|a, b| a.at.dot(ahead).total_cmp(&b.at.dot(ahead)));
            assert!(left.windows(2).all(|pair| pair[0].at.distance(pair[1].at) <= EDGE_SPACING_M + 1e-6));
            let plan = runway.ends[end] - ahead * 3_000.0;
            let eye = DVec3::new(plan.x, 681.0 + 180.0, plan.y);
            let around: Vec<&LightPoint> = lights.iter().filter(|light| light.beam == Beam::Beside).collect();
            for light in left {
                // What shines all around takes less than a tenth of the colour of the beam, set down to 4 % as by night.
                let beside = around.iter().find(|beside| beside.at == light.at).unwrap();
                let base = DVec3::new(light.at.x, 681.0 + f64::from(light.above_m), light.at.y);
                let cd = |one: &LightPoint| one.intensity_cd * one.towards(eye - base).into_iter().fold(0.0, f32::max);
                assert!(cd(beside) < 0.1 * 0.04 * cd(light), "{} beside {}", cd(beside), cd(light));
                let to_go_m = length_m - (light.at - runway.ends[end]).dot(ahead);
                let expected = if to_go_m < caution_m { "yellow" } else { "white" };
                // On the border itself rounding decides.
                if (to_go_m - caution_m).abs() > 1e-6 {
                    assert_eq!(seen(light, eye), expected, "{to_go_m} m to go of {length_m}");
                }
            }
        }
    }
}

#[test]
fn edges_are_seen_from_all_around() {
    for (surface, least_cd) in [(RunwaySurface::Asphalt, 50.0), (RunwaySurface::Grass, 25.0)] {
        let mut field = field(2_500.0, 53.0);
        field.runways[0].surface = surface;
        let runway = &field.runways[0];
        let mut lights = Vec::new();
        edges(runway, &mut lights);
        let (_, right) = ahead_and_right(runway, 0);
        let middle = runway.ends[0].midpoint(runway.ends[1]);
        for (abeam_m, up_m) in [(2_000.0, 300.0), (-2_000.0, 300.0), (2_000.0, 535.0), (-900.0, 60.0)] {
            let plan = middle + right * abeam_m;
            let eye = DVec3::new(plan.x, 681.0 + up_m, plan.y);
            for light in &lights {
                let sent_cd: f32 = lights
                    .iter()
                    .filter(|other| other.at == light.at)
                    .map(|one| {
                        let base = DVec3::new(one.at.x, 681.0 + f64::from(one.above_m), one.at.y);
                        one.intensity_cd * one.towards(eye - base).into_iter().fold(0.0, f32::max)
                    })
                    .sum();
                assert!(sent_cd >= least_cd, "{sent_cd} cd at {abeam_m} m");
            }
        }
    }
}

#[test]
fn who_comes_sees_a_green_threshold_and_a_red_end() {
    let field = field(2_500.0, 210.0);
    let runway = &field.runways[0];
    let mut near = Vec::new();
    direction(runway, 0, &mut near);
    let mut far = Vec::new();
    direction(runway, 1, &mut far);
    let (ahead, _) = ahead_and_right(runway, 0);
    let plan = runway.ends[0] - ahead * 2_000.0;
    let eye = DVec3::new(plan.x, 681.0 + 120.0, plan.y);
    let count = |lights: &[LightPoint], colour| {
        lights.iter().filter(|light| light.above_m > 0.0 && seen(light, eye) == colour).count()
    };
    assert!(count(&near, "green") >= 16 && count(&near, "red") == 0);
    assert!(count(&far, "red") == 6 && count(&far, "green") == 0);
    // 30 bars of 5 and the crossbar's 12, all before the threshold, the farthest 900 m.
    assert_eq!(count(&near, "white"), 162);
    let before_m = |light: &LightPoint| (runway.ends[0] - light.at).dot(ahead);
    let farthest = near.iter().map(before_m).fold(0.0, f64::max);
    assert!((farthest - 900.0).abs() < 1e-6, "{farthest}");
    assert_eq!(count(&far, "white"), 0);
}

#[test]
fn taxiways_are_blue_and_stay_off_the_runway() {
    let mut field = field(2_500.0, 90.0);
    field.taxiways.push((vec![DVec2::new(700.0, -300.0), DVec2::new(700.0, -600.0)], 23.0));
    let lights = airfield(&field);
    let blue: Vec<_> = lights.iter().filter(|light| light.colour == BLUE).collect();
    assert!(blue.len() > 50, "{}", blue.len());
    assert!(blue.iter().all(|light| distance_m(light.at, &field.runways[0].ends) > 22.5));
    assert_eq!(lights.iter().filter(|light| matches!(light.beam, Beam::Turning { .. })).count(), 1);
    field.runways[0].lit = false;
    assert!(airfield(&field).is_empty());
}

#[test]
fn masts_are_red_from_forty_five_metres_on() {
    let mast = |height_m| Mast { class: MastClass::Mast, at: DVec2::ZERO, height_m };
    let features = Features { masts: vec![mast(30.0), mast(60.0), mast(180.0)], ..Features::default() };
    let lights = all(&features);
    assert_eq!(lights.iter().map(|light| light.above_m).collect::<Vec<_>>(), [60.0, 180.0, 90.0]);
    assert!(lights.iter().all(|light| light.colour == RED));
}

#[test]
fn lights_stand_on_the_ground_query() {
    let grid = Grid::centred(200.0, 2, 2).unwrap();
    let heights = (0..grid.posts()).map(|at| 700.0 + ((at * 7919) % 613) as f32).collect();
    let area = Ground::new(Arc::new(Field::new(grid, heights).unwrap())).whole();
    for light in airfield(&field(2_500.0, 53.0)) {
        let ground_m = area.height_m(light.at.x, light.at.y).unwrap();
        assert_eq!(light.height_m(&area), Some(ground_m + f64::from(light.above_m)));
    }
}

#[test]
fn odd_geometry_ends_and_is_finite() {
    let mut flat = field(0.0, 0.0);
    flat.taxiways = vec![(vec![DVec2::ZERO, DVec2::ZERO], 20.0), (vec![DVec2::ZERO, DVec2::splat(1e9)], 20.0)];
    assert!(airfield(&flat).is_empty(), "a runway without length has no lights");
    let mut long = field(1e9, 10.0);
    long.taxiways = flat.taxiways;
    let lights = airfield(&long);
    assert!(lights.len() < 30_000 && lights.iter().all(|light| light.at.is_finite() && light.axis.is_finite()));
}
