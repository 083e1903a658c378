//! Casts against the physics engine's, and against the distance to the shape, which is written another way.

use super::*;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rapier3d::parry::query::{Ray, RayCast};
use rapier3d::parry::shape as engine;

const SEED_CASTS: u64 = 20_261_124;
const SEED_ENDS: u64 = 20_261_125;

fn vector(random: &mut StdRng, size: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| random.random_range(-size..size)))
}

/// One shape of each kind, of sizes up to 10 m.
pub(in crate::ballistics) fn any_shapes(random: &mut StdRng) -> [Shape; 5] {
    let mut size = || random.random_range(0.2..6.0);
    let (a, b, c) = (size(), size(), size());
    let points: Vec<DVec3> = (0..16).map(|_| vector(random, 6.0)).collect();
    [
        Shape::sphere(a).unwrap(),
        Shape::block(DVec3::new(a, b, c)).unwrap(),
        Shape::capsule(a, b).unwrap(),
        Shape::cylinder(b, c).unwrap(),
        Shape::hull(&points).unwrap(),
    ]
}

#[test]
fn casts_are_the_engines() {
    let mut random = StdRng::seed_from_u64(SEED_CASTS);
    let (mut hits, mut worst, mut lost) = ([0; 5], [0.0f64; 5], [0; 5]);
    for _ in 0..200 {
        let shapes = any_shapes(&mut random);
        for (kind, shape) in shapes.iter().enumerate() {
            let theirs: Box<dyn RayCast> = match &shape.form {
                Form::Sphere { radius_m } => Box::new(engine::Ball::new(*radius_m)),
                Form::Block { half_m } => Box::new(engine::Cuboid::new(Vector::new(half_m.x, half_m.y, half_m.z))),
                Form::Capsule { half_height_m, radius_m } => {
                    Box::new(engine::Capsule::new_y(*half_height_m, *radius_m))
                }
                Form::Cylinder { half_height_m, radius_m } => {
                    Box::new(engine::Cylinder::new(*half_height_m, *radius_m))
                }
                // A hull is tested by its own planes below.
                Form::Hull { .. } => continue,
            };
            for _ in 0..100 {
                let (from, to) = (vector(&mut random, 20.0), vector(&mut random, 6.0));
                let along = to - from;
                let ray = Ray::new(Vector::new(from.x, from.y, from.z), Vector::new(along.x, along.y, along.z));
                let engine = theirs.cast_local_ray_and_get_normal(&ray, 1.0, true);
                match (shape.enter(from, to), engine) {
                    (Some(ours), Some(theirs)) => {
                        hits[kind] += 1;
                        worst[kind] = worst[kind].max((ours.fraction - theirs.time_of_impact).abs() * along.length());
                    }
                    (None, None) => {}
                    _ => lost[kind] += 1,
                }
            }
        }
    }
    println!("hits {hits:?}, at most {worst:?} m apart, one only {lost:?}");
    // Closed forms on both sides: some ten roundings of 30 m, magnified by at most 1e3 at a graze of the round ones.
    let roundings_m = 10.0 * 30.0 * f64::EPSILON * 1e3;
    for kind in 0..3 {
        assert!(
            hits[kind] > 5_000 && lost[kind] == 0 && worst[kind] < roundings_m,
            "{kind}: {hits:?} {worst:?} {lost:?}"
        );
    }
    // The engine iterates on a cylinder until the square root of ten epsilons of a distance, here of up to 40 m.
    let iterated_m = (10.0 * f64::EPSILON).sqrt() * 40.0;
    assert!(hits[3] > 5_000 && worst[3] < iterated_m && lost[3] == 0, "iterated: {worst:?} {lost:?}");
}

#[test]
fn an_entry_is_on_the_surface_and_the_first() {
    let mut random = StdRng::seed_from_u64(SEED_CASTS);
    for _ in 0..400 {
        for shape in any_shapes(&mut random) {
            for _ in 0..20 {
                let (from, to) = (vector(&mut random, 15.0), vector(&mut random, 5.0));
                let entry = shape.enter(from, to);
                let end = entry.map_or(1.0, |entry| entry.fraction);
                // A start inside is at fraction 0: nothing comes before it.
                for i in 0..if end > 0.0 { 20 } else { 0 } {
                    let p = from.lerp(to, end * f64::from(i) / 20.0);
                    // Roundings of 30 m: ten of 2^-48 m.
                    assert!(shape.distance_m(p) > -4e-14, "{shape:?} {from} {to}");
                }
                let Some(entry) = entry else { continue };
                let p = from.lerp(to, entry.fraction);
                if let Some(normal) = entry.normal {
                    assert!(shape.distance_m(p).abs() < 4e-13, "{} {shape:?}", shape.distance_m(p));
                    assert!((normal.length() - 1.0).abs() < 1e-12 && normal.dot(to - from) <= 1e-12);
                    let out = shape.distance_m(p + normal * 0.01);
                    assert!((out - 0.01).abs() < 1e-9, "not the surface's normal: {out} {shape:?}");
                } else {
                    assert!(entry.fraction == 0.0 && shape.distance_m(from) <= 0.0);
                }
            }
        }
    }
}

/// Chains of segments through points on and beside the surface: what ends inside has entered.
#[test]
fn no_chain_of_segments_gets_in_unseen() {
    let mut random = StdRng::seed_from_u64(SEED_ENDS);
    for _ in 0..400 {
        for shape in any_shapes(&mut random) {
            let outside = vector(&mut random, 1.0).normalize() * 20.0;
            let aim = vector(&mut random, 3.0);
            let Some(entry) = shape.enter(outside, aim) else { continue };
            let surface = outside.lerp(aim, entry.fraction);
            for ulps in -3..=3 {
                let via = surface + (aim - outside) * (f64::from(ulps) * f64::EPSILON);
                let beyond = surface.lerp(aim, 0.01);
                if shape.distance_m(beyond) < -1e-12 {
                    assert!(shape.enter(outside, via).or_else(|| shape.enter(via, beyond)).is_some(), "{shape:?}");
                }
            }
        }
    }
}

#[test]
fn a_point_at_rest_is_in_or_out() {
    let block = Shape::block(DVec3::new(1.0, 2.0, 3.0)).unwrap();
    assert_eq!(block.enter(DVec3::ZERO, DVec3::ZERO), Some(Entry { fraction: 0.0, normal: None }));
    assert_eq!(block.enter(DVec3::X, DVec3::X).unwrap().fraction, 0.0);
    assert_eq!(block.enter(DVec3::X * 1.1, DVec3::X * 1.1), None);
    assert_eq!(block.radius_m(), 14f64.sqrt());
    assert_eq!(Shape::capsule(2.0, 0.5).unwrap().radius_m(), 2.5);
}

#[test]
fn sizes_that_are_none_are_named() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 2e5] {
        let text = Shape::sphere(bad).unwrap_err().to_string();
        assert!(text.contains("radius_m") && text.contains(&bad.to_string()), "{text}");
        assert!(matches!(Shape::cylinder(bad, 1.0), Err(ShapeError::Size { name: "half_height_m", .. })));
        assert!(matches!(Shape::capsule(1.0, bad), Err(ShapeError::Size { name: "radius_m", .. })));
        let half = DVec3::new(1.0, bad, 1.0);
        assert!(matches!(Shape::block(half), Err(ShapeError::Size { name: "half_m.y", .. })));
    }
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    assert!(Shape::hull(&corners).is_ok());
    let spoilt = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, f64::NAN, 0.0), DVec3::Z];
    assert!(matches!(Shape::hull(&spoilt), Err(ShapeError::Point { index: 2, .. })));
    let sheet = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y, DVec3::new(0.3, 0.2, 0.0)];
    assert_eq!(Shape::hull(&sheet), Err(ShapeError::Flat { points: 5 }));
    for few in [&corners[..0], &corners[..1], &corners[..3], &[DVec3::ONE; 9][..]] {
        assert_eq!(Shape::hull(few), Err(ShapeError::Flat { points: few.len() }));
    }
}

#[test]
fn a_hull_of_a_box_is_the_box() {
    let half = DVec3::new(1.0, 2.0, 3.0);
    let corners: Vec<DVec3> = (0..8)
        .map(|i| half * DVec3::from_array([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -1.0 } else { 1.0 })))
        .collect();
    let (hull, block) = (Shape::hull(&corners).unwrap(), Shape::block(half).unwrap());
    let Form::Hull { planes, .. } = &hull.form else { panic!() };
    assert_eq!(planes.len(), 6);
    let mut random = StdRng::seed_from_u64(SEED_CASTS);
    for _ in 0..5_000 {
        let (from, to) = (vector(&mut random, 9.0), vector(&mut random, 4.0));
        let [ours, theirs] = [&hull, &block].map(|shape| shape.enter(from, to).map(|entry| entry.fraction));
        match (ours, theirs) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-12, "{a} {b}"),
            (a, b) => assert_eq!(a, b),
        }
    }
}
