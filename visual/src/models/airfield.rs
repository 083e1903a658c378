//! What stands on an airfield: hangar, tower, terminal, fuel tank, windsock.
//!
//! Frame: see [`super`].

use super::mesh::{Mesh, Paint};
use super::parts::{CONCRETE, GLASS, LAMP, SHEET, STEEL, WHITE, body, cuboid};
use glam::Vec3;
use std::f32::consts::TAU;

pub(super) fn hangar(mesh: &mut Mesh) {
    const ARCH: usize = 10;
    // A third of a circle over walls of 4.5 m: 30 m wide, 9.6 m high, 25 m long.
    let arch: Vec<(f32, f32)> = (0..=ARCH)
        .map(|step| {
            let part = -1.0 + 2.0 * step as f32 / ARCH as f32;
            let turn = part * 0.65;
            (15.0 * turn.sin() / 0.65_f32.sin(), 4.5 + 5.1 * (turn.cos() - 0.65_f32.cos()) / (1.0 - 0.65_f32.cos()))
        })
        .collect();
    for pair in arch.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let at = |x, y, z| Vec3::new(x, y, z);
        mesh.face(&[at(x0, y0, 12.5), at(x1, y1, 12.5), at(x1, y1, -12.5), at(x0, y0, -12.5)], SHEET.shaded(0.8));
    }
    for end in [-12.5_f32, 12.5] {
        let mut corners: Vec<Vec3> = arch.iter().rev().map(|(x, y)| Vec3::new(*x, *y, end)).collect();
        corners.extend([Vec3::new(-15.0, 0.0, end), Vec3::new(15.0, 0.0, end)]);
        if end < 0.0 {
            corners.reverse();
        }
        mesh.face(&corners, SHEET);
    }
    for (x, outward) in [(-15.0_f32, -1.0_f32), (15.0, 1.0)] {
        let z = 12.5 * outward;
        let corners = [Vec3::new(x, 0.0, z), Vec3::new(x, 0.0, -z), Vec3::new(x, 4.5, -z), Vec3::new(x, 4.5, z)];
        mesh.face(&corners, SHEET.shaded(0.9));
    }
    // The gate, a little before the front.
    cuboid(mesh, [-11.0, 0.0, -12.7], [11.0, 5.6, -12.5], SHEET.shaded(0.55));
}

pub(super) fn control_tower(mesh: &mut Mesh) {
    let (low, high) = (Vec3::new(-6.0, 0.0, -5.0), Vec3::new(6.0, 4.0, 5.0));
    mesh.cuboid(low, high, CONCRETE, CONCRETE.shaded(0.8));
    mesh.windowed(
        low - Vec3::new(0.02, 0.0, 0.02),
        high + Vec3::new(0.02, -0.02, 0.02),
        Vec3::new(4.0, 1.0, 3.0),
        CONCRETE.of_kind(1),
    );
    cuboid(mesh, [-2.5, 4.0, -2.5], [2.5, 18.0, 2.5], CONCRETE);
    // Eight sides: a floor that widens, panes that lean outward, a roof.
    let rings: Vec<Vec<Vec3>> = [(18.0, 2.6), (18.6, 3.6), (19.4, 3.6)].map(|(y, r)| level_ring(y, r, 8)).to_vec();
    mesh.loft(&rings, CONCRETE);
    mesh.loft(&[level_ring(19.4, 3.55, 8), level_ring(21.6, 4.0, 8)], GLASS);
    mesh.loft(&[level_ring(21.6, 4.2, 8), level_ring(22.2, 4.2, 8)], SHEET);
    mesh.column(Vec3::new(0.0, 22.2, 0.0), 3.0, [0.06, 0.03], 4, STEEL);
    cuboid(mesh, [-0.2, 25.2, -0.2], [0.2, 25.6, 0.2], LAMP);
}

/// A level ring, so that rings upward make an outward skin.
pub(super) fn level_ring(y: f32, radius: f32, sides: u32) -> Vec<Vec3> {
    (0..sides)
        .map(|side| {
            let (sin, cos) = (-TAU * (side as f32 + 0.5) / sides as f32).sin_cos();
            Vec3::new(radius * cos, y, radius * sin)
        })
        .collect()
}

pub(super) fn terminal(mesh: &mut Mesh) {
    let hall = [Vec3::new(-30.0, 0.0, -10.0), Vec3::new(30.0, 7.0, 10.0)];
    let upper = [Vec3::new(-12.0, 7.0, -8.0), Vec3::new(12.0, 11.0, 8.0)];
    for ([low, high], windows) in [(hall, Vec3::new(20.0, 2.0, 6.0)), (upper, Vec3::new(8.0, 1.0, 5.0))] {
        let roof = [
            Vec3::new(low.x, high.y, low.z),
            Vec3::new(low.x, high.y, high.z),
            Vec3::new(high.x, high.y, high.z),
            Vec3::new(high.x, high.y, low.z),
        ];
        mesh.face(&roof, CONCRETE.shaded(0.85));
        mesh.windowed(low, high, windows, WHITE.shaded(0.85).of_kind(2));
    }
}

pub(super) fn fuel_tank(mesh: &mut Mesh) {
    mesh.column(Vec3::ZERO, 6.0, [4.0, 4.0], 18, WHITE);
    mesh.column(Vec3::new(0.0, 6.0, 0.0), 0.5, [4.0, 0.4], 18, WHITE.shaded(0.9));
}

pub(super) fn windsock(mesh: &mut Mesh) {
    mesh.column(Vec3::ZERO, 6.0, [0.09, 0.06], 6, WHITE);
    let orange = Paint::matt(0.62, 0.20, 0.05);
    for band in 0..5_u8 {
        let start = 0.15 + 0.7 * f32::from(band);
        let droop = |z: f32| 5.7 - 0.045 * z * z;
        let radius = |z: f32| 0.45 - 0.065 * z;
        let paint = if band % 2 == 0 { orange } else { WHITE };
        let end = start + 0.7;
        body(
            mesh,
            &[[start, droop(start), radius(start), radius(start)], [end, droop(end), radius(end), radius(end)]],
            8,
            paint,
        );
    }
}
