//! What drives, sails and is dug in: truck, tank, carrier, radar, ship, boat, bunker.
//!
//! Frame: see [`super`].

use super::mesh::{Mesh, Paint};
use super::parts::{CANVAS, CONCRETE, DARK, GLASS, OLIVE, RED, STEEL, WHITE, body, cuboid};
use glam::Vec3;
use std::f32::consts::TAU;

pub(super) fn wheel(mesh: &mut Mesh, x: f32, z: f32, radius: f32, width: f32) {
    let side = |x: f32| -> Vec<Vec3> {
        (0..8)
            .map(|step| {
                let (sin, cos) = (-TAU * step as f32 / 8.0).sin_cos();
                Vec3::new(x, radius + radius * sin, z + radius * cos)
            })
            .collect()
    };
    mesh.loft(&[side(x - 0.5 * width), side(x + 0.5 * width)], DARK);
}

pub(super) fn truck(mesh: &mut Mesh) {
    cuboid(mesh, [-1.1, 0.55, -3.9], [1.1, 0.95, 4.0], DARK);
    cuboid(mesh, [-1.2, 0.95, -3.3], [1.2, 2.7, -1.9], OLIVE);
    cuboid(mesh, [-1.0, 0.95, -4.0], [1.0, 1.75, -3.3], OLIVE);
    cuboid(mesh, [-1.05, 1.85, -3.36], [1.05, 2.5, -3.3], GLASS);
    for x in [-1.23_f32, 1.17] {
        cuboid(mesh, [x, 1.85, -2.9], [x + 0.06, 2.5, -2.2], GLASS);
    }
    cuboid(mesh, [-1.25, 0.95, -1.7], [1.25, 1.5, 4.0], OLIVE.shaded(0.9));
    let tilt = [[-1.7, 1.5], [4.0, 1.5]];
    let bow = |z: f32, y: f32| {
        [(1.22, 0.0), (1.22, 1.35), (0.8, 1.85), (-0.8, 1.85), (-1.22, 1.35), (-1.22, 0.0)]
            .map(|(x, up)| Vec3::new(x, y + up, z))
            .to_vec()
    };
    mesh.loft(&[bow(tilt[0][0], tilt[0][1]), bow(tilt[1][0], tilt[1][1])], CANVAS);
    for z in [-3.1_f32, 1.7, 3.0] {
        for x in [-1.05_f32, 1.05] {
            wheel(mesh, x, z, 0.55, 0.35);
        }
    }
}

pub(super) fn tank(mesh: &mut Mesh) {
    // The hull in side view, drawn out to both sides.
    let hull = |x: f32| {
        [(-3.5, 1.0), (-3.0, 0.45), (3.0, 0.45), (3.5, 0.9), (3.4, 1.5), (-2.2, 1.5)]
            .map(|(z, y)| Vec3::new(x, y, z))
            .to_vec()
    };
    mesh.loft(&[hull(-1.1), hull(1.1)], OLIVE);
    for x in [-1.75_f32, 1.15] {
        let track = |x: f32| {
            [(-3.5, 0.75), (-2.9, 0.0), (2.8, 0.0), (3.5, 0.7), (3.3, 1.05), (-3.2, 1.05)]
                .map(|(z, y)| Vec3::new(x, y, z))
                .to_vec()
        };
        mesh.loft(&[track(x), track(x + 0.6)], DARK.shaded(1.4));
        cuboid(mesh, [x - 0.05, 1.05, -3.2], [x + 0.65, 1.45, 3.3], OLIVE.shaded(0.9));
    }
    let turret = |y: f32, grow: f32| {
        [(0.0, -1.5), (-0.85, -1.1), (-1.25, 0.2), (-1.0, 1.5), (1.0, 1.5), (1.25, 0.2), (0.85, -1.1)]
            .map(|(x, z)| Vec3::new(x * grow, y, z * grow))
            .to_vec()
    };
    mesh.loft(&[turret(1.5, 1.0), turret(1.95, 0.98), turret(2.35, 0.62)], OLIVE.shaded(1.05));
    mesh.column(Vec3::new(0.45, 2.3, 0.2), 0.2, [0.35, 0.3], 8, OLIVE);
    body(mesh, &[[-6.0, 1.85, 0.07, 0.07], [-1.2, 1.85, 0.1, 0.1]], 6, OLIVE.shaded(0.8));
}

/// A hull: sections along z of half widths at the deck and at the keel.
pub(super) fn hull(mesh: &mut Mesh, sections: &[[f32; 5]], paint: Paint) {
    let rings: Vec<Vec<Vec3>> = sections
        .iter()
        .map(|[z, deck, deck_m, keel, keel_m]| {
            [(*deck, *deck_m), (-*deck, *deck_m), (-*keel, *keel_m), (*keel, *keel_m)]
                .map(|(x, y)| Vec3::new(x, y, *z))
                .to_vec()
        })
        .collect();
    mesh.loft(&rings, paint);
}

pub(super) fn ship(mesh: &mut Mesh) {
    let dark = Paint::matt(0.07, 0.085, 0.10);
    hull(
        mesh,
        &[
            [-30.0, 0.2, 4.6, 0.1, 0.5],
            [-24.0, 3.4, 3.6, 2.0, -2.5],
            [-16.0, 5.0, 3.0, 4.4, -3.0],
            [24.0, 5.0, 3.0, 4.4, -3.0],
            [30.0, 4.2, 3.6, 2.5, -0.5],
        ],
        dark,
    );
    for z in [-15.0_f32, -4.0, 7.0] {
        cuboid(mesh, [-3.6, 3.0, z], [3.6, 4.3, z + 9.0], Paint::matt(0.24, 0.15, 0.11));
    }
    let (low, high) = (Vec3::new(-4.2, 3.0, 18.0), Vec3::new(4.2, 9.0, 26.0));
    mesh.cuboid(low, high, WHITE, WHITE.shaded(0.9));
    mesh.windowed(
        low - Vec3::new(0.02, 0.0, 0.02),
        high + Vec3::new(0.02, 0.0, 0.02),
        Vec3::new(6.0, 2.0, 5.0),
        WHITE.of_kind(1),
    );
    cuboid(mesh, [-4.6, 9.0, 18.0], [4.6, 11.6, 22.0], WHITE);
    cuboid(mesh, [-4.7, 10.2, 17.94], [4.7, 11.2, 22.02], GLASS);
    mesh.column(Vec3::new(0.0, 9.0, 24.0), 4.0, [1.0, 0.9], 8, RED.shaded(0.7));
    mesh.column(Vec3::new(0.0, 4.3, -19.0), 9.0, [0.25, 0.12], 5, WHITE.shaded(0.8));
}

pub(super) fn boat(mesh: &mut Mesh) {
    hull(
        mesh,
        &[
            [-3.5, 0.05, 1.05, 0.02, 0.6],
            [-1.8, 0.95, 0.95, 0.5, -0.35],
            [0.0, 1.2, 0.85, 0.8, -0.5],
            [3.5, 1.1, 0.8, 0.8, -0.3],
        ],
        WHITE,
    );
    cuboid(mesh, [-0.8, 0.85, -0.9], [0.8, 1.5, 1.3], WHITE.shaded(0.9));
    cuboid(mesh, [-0.82, 1.5, -0.8], [0.82, 1.95, 1.2], GLASS);
    cuboid(mesh, [-0.85, 1.95, -0.85], [0.85, 2.08, 1.35], WHITE);
}

/// An eight-wheeled carrier, 7.6 x 2.9 x 2.4 m.
pub(super) fn apc(mesh: &mut Mesh) {
    // The hull in cross section: narrow below, widest at the fenders, sloping to the roof.
    let section = |z: f32, grow: f32, top: f32| {
        [(0.75, 0.5), (1.35, 1.1), (1.0, top), (-1.0, top), (-1.35, 1.1), (-0.75, 0.5)]
            .map(|(x, y)| Vec3::new(x * grow, y, z))
            .to_vec()
    };
    let rings = [section(-3.8, 0.75, 1.15), section(-3.0, 1.0, 1.75), section(3.2, 1.0, 1.85), section(3.8, 0.95, 1.4)];
    mesh.loft(&rings, OLIVE);
    for z in [-2.6_f32, -1.2, 0.5, 1.9] {
        for x in [-1.25_f32, 1.25] {
            wheel(mesh, x, z, 0.52, 0.36);
        }
    }
    mesh.column(Vec3::new(0.0, 1.83, -0.6), 0.5, [0.65, 0.4], 8, OLIVE.shaded(1.05));
    body(mesh, &[[-2.6, 2.1, 0.04, 0.04], [-0.9, 2.1, 0.06, 0.06]], 6, DARK.shaded(1.6));
    for x in [-0.85_f32, 0.35] {
        cuboid(mesh, [x, 1.45, -3.36], [x + 0.5, 1.62, -3.2], GLASS);
    }
}

/// A radar on a truck, 7 x 3 x 4.4 m: the cabin, the box with the set, the dish.
pub(super) fn radar(mesh: &mut Mesh) {
    cuboid(mesh, [-1.1, 0.55, -3.5], [1.1, 0.95, 3.5], DARK);
    cuboid(mesh, [-1.2, 0.95, -3.5], [1.2, 2.5, -2.0], OLIVE);
    cuboid(mesh, [-1.05, 1.7, -3.56], [1.05, 2.35, -3.5], GLASS);
    cuboid(mesh, [-1.25, 0.95, -1.7], [1.25, 2.7, 3.4], OLIVE.shaded(0.95));
    mesh.column(Vec3::new(0.0, 2.7, 0.6), 0.5, [0.3, 0.22], 8, STEEL);
    // A curved mesh of a reflector, seen from both sides.
    let bow = |z: f32| {
        [(-1.45, -0.35), (-0.75, -0.05), (0.0, 0.05), (0.75, -0.05), (1.45, -0.35)]
            .map(|(x, back)| Vec3::new(x, 0.0, z - back))
            .to_vec()
    };
    for (low, high) in [(3.1_f32, 4.4_f32)] {
        for pair in bow(0.7).windows(2) {
            let at = |p: Vec3, y: f32| Vec3::new(p.x, y, p.z);
            let face = [at(pair[0], low), at(pair[1], low), at(pair[1], high), at(pair[0], high)];
            mesh.face(&face, STEEL);
            let back: Vec<Vec3> = face.iter().rev().map(|p| *p - Vec3::Z * 0.06).collect();
            mesh.face(&back, STEEL.shaded(0.7));
        }
    }
    for z in [-2.7_f32, 1.6, 2.7] {
        for x in [-1.05_f32, 1.05] {
            wheel(mesh, x, z, 0.55, 0.35);
        }
    }
}

/// A concrete shelter under earth, 10 x 4 x 10 m, its slit to the front.
pub(super) fn bunker(mesh: &mut Mesh) {
    let earth = Paint::matt(0.20, 0.17, 0.11);
    let ring = |y: f32, half: f32| {
        [(half, half), (half, -half), (-half, -half), (-half, half)].map(|(x, z)| Vec3::new(x, y, z)).to_vec()
    };
    mesh.loft(&[ring(0.0, 5.0), ring(2.2, 4.7), ring(3.2, 3.8), ring(4.0, 2.2)], earth);
    cuboid(mesh, [-3.4, 0.0, -5.05], [3.4, 2.4, -4.2], CONCRETE);
    cuboid(mesh, [-2.6, 1.35, -5.1], [2.6, 1.75, -5.04], DARK);
    cuboid(mesh, [-0.7, 3.9, 0.2], [0.7, 4.3, 1.6], CONCRETE.shaded(0.8));
}
