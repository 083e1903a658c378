//! What flies: a light aircraft, a jet, a helicopter, and what falls from one.
//!
//! Frame: see [`super`].

use super::mesh::{Mesh, Paint};
use super::parts::{DARK, GLASS, OLIVE, RED, SHEET, STEEL, WHITE, body, cuboid};
use super::vehicles::wheel;
use glam::Vec3;

/// A flat surface of an aircraft: root and tip chords (x, y, front z, back z), mirrored, with a thickness at the root.
pub(super) fn wing(mesh: &mut Mesh, root: [f32; 4], tip: [f32; 4], thick_m: f32, paint: Paint) {
    for side in [-1.0_f32, 1.0] {
        let section = |[x, y, front, back]: [f32; 4], thick: f32| {
            let third = front + 0.3 * (back - front);
            vec![
                Vec3::new(side * x, y, front),
                Vec3::new(side * x, y + 0.5 * thick, third),
                Vec3::new(side * x, y, back),
                Vec3::new(side * x, y - 0.5 * thick, third),
            ]
        };
        let (near, far) = (section(root, thick_m), section(tip, 0.6 * thick_m));
        if side > 0.0 {
            mesh.loft(
                &[near, far].map(|mut ring| {
                    ring.reverse();
                    ring
                }),
                paint,
            );
        } else {
            mesh.loft(&[near, far], paint);
        }
    }
}

pub(super) fn aircraft(mesh: &mut Mesh) {
    body(
        mesh,
        &[
            [-2.7, 1.2, 0.25, 0.25],
            [-2.4, 1.22, 0.45, 0.42],
            [-1.1, 1.28, 0.56, 0.55],
            [0.9, 1.4, 0.55, 0.62],
            [2.2, 1.45, 0.36, 0.4],
            [5.4, 1.55, 0.09, 0.16],
        ],
        10,
        WHITE,
    );
    // Windscreen and cabin under the wing.
    body(
        mesh,
        &[[-1.2, 1.78, 0.2, 0.05], [-0.6, 1.95, 0.5, 0.26], [1.0, 1.98, 0.5, 0.24], [1.9, 1.75, 0.2, 0.08]],
        8,
        GLASS,
    );
    wing(mesh, [0.0, 2.22, -0.85, 0.75], [5.5, 2.3, -0.7, 0.45], 0.2, WHITE);
    wing(mesh, [0.0, 1.6, 4.4, 5.4], [1.7, 1.6, 4.65, 5.3], 0.09, WHITE);
    let fin = |x: f32| [(3.9, 1.65), (5.5, 1.6), (5.75, 2.7), (5.2, 2.7)].map(|(z, y)| Vec3::new(x, y, z)).to_vec();
    mesh.loft(&[fin(0.06), fin(-0.06)], RED);
    body(mesh, &[[-3.05, 1.2, 0.04, 0.04], [-2.7, 1.2, 0.17, 0.17]], 6, RED);
    cuboid(mesh, [-0.95, 1.14, -2.85], [0.95, 1.26, -2.8], DARK);
    wheel(mesh, 0.0, -1.9, 0.2, 0.13);
    for x in [-1.15_f32, 1.15] {
        wheel(mesh, x, 0.3, 0.24, 0.16);
        let foot = Vec3::new(x, 0.3, 0.3);
        mesh.loft(
            &[
                [(-0.05, -0.06), (0.05, -0.06), (0.05, 0.06), (-0.05, 0.06)]
                    .map(|(a, b)| foot + Vec3::new(a, 0.0, -b))
                    .to_vec(),
                [(-0.05, -0.06), (0.05, -0.06), (0.05, 0.06), (-0.05, 0.06)]
                    .map(|(a, b)| Vec3::new(x * 0.35 + a, 0.95, 0.1 - b))
                    .to_vec(),
            ],
            STEEL,
        );
    }
}

/// A small jet with a swept wing, 15 x 10 x 4 m, on its wheels.
pub(super) fn jet(mesh: &mut Mesh) {
    jet_in_flight(mesh);
    wheel(mesh, 0.0, -4.4, 0.28, 0.16);
    for x in [-1.3_f32, 1.3] {
        wheel(mesh, x, 1.2, 0.36, 0.22);
        cuboid(mesh, [x - 0.06, 0.4, 1.12], [x + 0.06, 1.7, 1.28], STEEL);
    }
    cuboid(mesh, [-0.05, 0.3, -4.45], [0.05, 1.4, -4.35], STEEL);
}

/// The same with its wheels up.
pub(super) fn jet_in_flight(mesh: &mut Mesh) {
    let skin = SHEET.shaded(0.9);
    body(
        mesh,
        &[
            [-7.5, 1.85, 0.04, 0.04],
            [-6.2, 1.9, 0.32, 0.3],
            [-4.2, 1.95, 0.62, 0.6],
            [-1.0, 1.9, 0.78, 0.78],
            [3.5, 1.9, 0.78, 0.76],
            [6.6, 1.95, 0.5, 0.5],
        ],
        12,
        skin,
    );
    mesh.loft(&[nozzle(6.6, 0.46), nozzle(7.0, 0.4)], DARK);
    body(
        mesh,
        &[[-4.9, 2.35, 0.12, 0.04], [-4.2, 2.6, 0.36, 0.3], [-2.8, 2.62, 0.34, 0.26], [-1.6, 2.5, 0.12, 0.06]],
        8,
        GLASS,
    );
    wing(mesh, [0.5, 1.85, -1.6, 3.6], [5.0, 1.8, 2.2, 3.6], 0.24, skin);
    wing(mesh, [0.4, 1.85, 4.4, 6.8], [2.9, 1.85, 6.0, 7.2], 0.14, skin);
    let fin = |x: f32| [(3.4, 2.5), (6.9, 2.4), (7.4, 4.0), (6.2, 4.0)].map(|(z, y)| Vec3::new(x, y, z)).to_vec();
    mesh.loft(&[fin(0.07), fin(-0.07)], skin.shaded(0.95));
}

/// A light helicopter on skids, its rotor of 8 m as four blades that stand.
pub(super) fn helicopter(mesh: &mut Mesh) {
    let paint = OLIVE.shaded(1.15);
    body(
        mesh,
        &[
            [-1.9, 1.05, 0.1, 0.1],
            [-1.5, 1.1, 0.5, 0.5],
            [-0.6, 1.2, 0.72, 0.75],
            [0.5, 1.25, 0.7, 0.74],
            [1.4, 1.4, 0.38, 0.42],
            [2.2, 1.5, 0.16, 0.18],
            [5.2, 1.7, 0.07, 0.08],
        ],
        12,
        paint,
    );
    body(
        mesh,
        &[[-1.8, 1.2, 0.25, 0.12], [-1.2, 1.4, 0.6, 0.4], [-0.3, 1.55, 0.66, 0.46], [0.4, 1.6, 0.4, 0.3]],
        10,
        GLASS,
    );
    mesh.column(Vec3::new(0.0, 1.9, 0.1), 0.85, [0.09, 0.07], 6, STEEL);
    cuboid(mesh, [-0.13, 2.66, -0.03], [0.13, 2.78, 0.23], DARK);
    // Blades along both diagonals, so that none hides another from ahead.
    for turn in 0..4 {
        let (sin, cos) = (std::f32::consts::FRAC_PI_4 + std::f32::consts::FRAC_PI_2 * turn as f32).sin_cos();
        let (along, across) = (Vec3::new(cos, 0.0, sin), Vec3::new(-sin, 0.0, cos));
        let section = |away: f32, thick: f32| {
            let at = Vec3::new(0.0, 2.74, 0.1) + along * away;
            [(-0.09, -thick), (0.09, -thick), (0.09, thick), (-0.09, thick)]
                .map(|(a, b)| at + across * a + Vec3::Y * b)
                .to_vec()
        };
        mesh.loft(&[section(0.15, 0.012), section(4.0, 0.008)], DARK);
    }
    let fin = |x: f32| [(4.7, 1.2), (5.2, 1.15), (5.6, 2.5), (5.1, 2.5)].map(|(z, y)| Vec3::new(x, y, z)).to_vec();
    mesh.loft(&[fin(0.04), fin(-0.04)], paint.shaded(0.9));
    cuboid(mesh, [0.08, 1.0, 5.05], [0.11, 2.2, 5.15], DARK);
    for x in [-0.95_f32, 0.95] {
        cuboid(mesh, [x - 0.04, 0.0, -1.5], [x + 0.04, 0.08, 1.5], STEEL);
        for z in [-0.7_f32, 0.7] {
            let foot = Vec3::new(x, 0.06, z);
            let top = Vec3::new(0.45 * x, 0.7, z);
            let ring = |at: Vec3| {
                [(-0.03, -0.03), (0.03, -0.03), (0.03, 0.03), (-0.03, 0.03)]
                    .map(|(a, b)| at + Vec3::new(a, 0.0, -b))
                    .to_vec()
            };
            mesh.loft(&[ring(foot), ring(top)], STEEL);
        }
    }
}

fn nozzle(z: f32, radius: f32) -> Vec<Vec3> {
    (0..12)
        .map(|corner| {
            let (sin, cos) = (std::f32::consts::TAU * (corner as f32 + 0.5) / 12.0).sin_cos();
            Vec3::new(radius * cos, 1.95 + radius * sin, z)
        })
        .collect()
}

/// A bomb of 2.2 m about its own middle, nose along -z.
pub(super) fn bomb(mesh: &mut Mesh) {
    body(
        mesh,
        &[
            [-1.1, 0.0, 0.02, 0.02],
            [-0.8, 0.0, 0.1, 0.1],
            [-0.3, 0.0, 0.137, 0.137],
            [0.2, 0.0, 0.13, 0.13],
            [0.8, 0.0, 0.06, 0.06],
            [1.1, 0.0, 0.05, 0.05],
        ],
        10,
        OLIVE,
    );
    fins(mesh, 0.7, 1.1, 0.19);
}

/// An unguided rocket of 1.4 m about its own middle, nose along -z.
pub(super) fn rocket(mesh: &mut Mesh) {
    body(
        mesh,
        &[[-0.7, 0.0, 0.005, 0.005], [-0.5, 0.0, 0.03, 0.03], [-0.3, 0.0, 0.035, 0.035], [0.7, 0.0, 0.035, 0.035]],
        8,
        OLIVE.shaded(1.2),
    );
    fins(mesh, 0.55, 0.7, 0.1);
}

fn fins(mesh: &mut Mesh, front: f32, back: f32, reach: f32) {
    cuboid(mesh, [-reach, -0.008, front], [reach, 0.008, back], OLIVE.shaded(0.8));
    cuboid(mesh, [-0.008, -reach, front], [0.008, reach, back], OLIVE.shaded(0.8));
}
