//! The index against every object one by one, and standing things against the ground query.

use super::*;
use crate::edit::{Crater, Edit};
use crate::features::model::{Building, BuildingClass, Mast, MastClass, Origin, Placed, PlacedClass, PowerLine};
use crate::grid::Grid;
use crate::ground::Ground;
use crate::synthetic;
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

const CLASSES: [BuildingClass; 8] = [
    BuildingClass::House,
    BuildingClass::Apartments,
    BuildingClass::Commercial,
    BuildingClass::Industrial,
    BuildingClass::Church,
    BuildingClass::Hangar,
    BuildingClass::Barn,
    BuildingClass::Other,
];

/// A dense town on steep hills.
fn town(random: &mut SmallRng) -> (Area, ObjectIndex) {
    let field = synthetic::rough(Grid::centred(200.0, 2, 2).unwrap(), 3, 500.0);
    let area = Ground::new(Arc::new(field)).whole();
    let mut features = Features::default();
    for number in 0..600 {
        let mut middle = || DVec2::new(random.random_range(-700.0..700.0), random.random_range(-700.0..700.0));
        let at = middle();
        let turn = DVec2::from_angle(random.random_range(0.0..6.3));
        let half = DVec2::new(random.random_range(3.0..20.0), random.random_range(3.0..12.0));
        let mut corners = vec![(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        if number % 4 == 0 {
            corners = vec![(-1.0, -1.0), (1.0, -1.0), (1.0, 0.0), (0.2, 0.1), (0.0, 1.0), (-1.0, 1.0)];
        }
        let outline = corners.iter().map(|(x, z)| at + turn.rotate(DVec2::new(*x, *z) * half)).collect();
        features.buildings.push(Building {
            class: CLASSES[number % 8],
            outline,
            height_m: random.random_range(3.0..40.0),
            height_from: Origin::Assumed,
        });
    }
    let mut at = || DVec2::new(random.random_range(-700.0..700.0), random.random_range(-700.0..700.0));
    for class in [PlacedClass::Hangar, PlacedClass::Truck, PlacedClass::Aircraft, PlacedClass::ControlTower] {
        for turn in 0..20 {
            features.placed.push(Placed { class, at: at(), grid_heading_rad: turn as f32 });
        }
    }
    for class in [MastClass::Mast, MastClass::Tower, MastClass::Chimney, MastClass::WindTurbine] {
        features.masts.extend((1..15).map(|n| Mast { class, at: at(), height_m: 10.0 * n as f32 }));
    }
    features.power_lines.push(PowerLine { line: (0..10).map(|_| at()).collect(), height_m: 35.0 });
    assert!(features.is_sound());
    let index = ObjectIndex::new(Arc::new(features), &area);
    (area, index)
}

#[test]
fn a_segment_meets_what_a_search_through_all_things_meets() {
    let mut random = SmallRng::seed_from_u64(11);
    let (area, index) = town(&mut random);
    assert_eq!(index.len(), 600 + 80 + 56 + 10);
    let mut met = 0;
    for number in 0..10_000 {
        let mut point = || {
            let at = DVec2::new(random.random_range(-750.0..750.0), random.random_range(-750.0..750.0));
            DVec3::new(at.x, area.height_m(at.x, at.y).unwrap() + random.random_range(-5.0..60.0), at.y)
        };
        let from = point();
        let to = if number % 2 == 0 { point() } else { from + (point() - from).normalize() * 8.0 };
        let slow = first(index.iter().filter_map(|object| index.enter(object, from, to)));
        assert_eq!(index.segment(from, to), slow, "{from} {to}");
        met += usize::from(slow.is_some());
    }
    assert!(met > 1_500, "{met}");
    assert_eq!(index.segment(DVec3::NAN, DVec3::ZERO), None);
    assert_eq!(index.segment(DVec3::splat(1e9), DVec3::splat(1e9)), None);
}

#[test]
fn everything_stands_on_the_ground_query() {
    let (area, index) = town(&mut SmallRng::seed_from_u64(12));
    for object in index.iter() {
        match index.stand(object) {
            Some(stand) => assert_eq!(area.height_m(stand.at_m.x, stand.at_m.z), Some(stand.at_m.y)),
            None => {
                let solid = index.building(object).unwrap();
                let heights = solid.outline.iter().map(|at| area.height_m(at.x, at.y).unwrap());
                assert_eq!(heights.fold(f64::INFINITY, f64::min), solid.base_m);
            }
        }
        let found = index.in_rectangle(object.plan_middle(), object.plan_middle()).any(|one| one.id == object.id);
        assert!(found, "{:?}", object.id);
    }
}

#[test]
fn an_edited_ground_has_things_stand_as_on_one_that_was_so_from_the_start() {
    let mut random = SmallRng::seed_from_u64(12);
    let (mut area, mut index) = town(&mut random);
    for round in 0..12 {
        let centre_m = DVec2::new(random.random_range(-900.0..900.0), random.random_range(-900.0..900.0));
        let edit = Edit::Crater(Crater::simple(centre_m, random.random_range(200.0..400.0)));
        let (after, changed) = area.edited(&[edit]).unwrap();
        let (edited, moved) = index.edited(&after, &changed);
        let fresh = ObjectIndex::new(index.features.clone(), &after);
        let sorted = |index: &ObjectIndex| {
            let mut all: Vec<Object> = index.iter().copied().collect();
            all.sort_by_key(|object| object.id);
            all
        };
        let (before, now) = (sorted(&index), sorted(&edited));
        assert_eq!(now, sorted(&fresh), "round {round}");
        let differ = before.iter().zip(&now).filter(|(a, b)| a != b).count();
        assert_eq!((differ, before.len()), (moved.len(), now.len()));
        assert!(round > 0 || differ > 10, "{differ}");
        (area, index) = (after, edited);
    }
}
