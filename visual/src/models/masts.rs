//! Masts and towers, 1 m high: they are scaled to their height.
//!
//! Frame: see [`super`].

use super::mesh::Mesh;
use super::parts::{CONCRETE, LAMP, RED, SHEET, STEEL, WHITE, body};
use glam::Vec3;
use std::f32::consts::TAU;

pub(super) fn tower(mesh: &mut Mesh) {
    mesh.column(Vec3::ZERO, 0.86, [0.055, 0.04], 10, CONCRETE);
    mesh.column(Vec3::new(0.0, 0.86, 0.0), 0.08, [0.06, 0.06], 10, SHEET);
    mesh.column(Vec3::new(0.0, 0.94, 0.0), 0.06, [0.006, 0.004], 4, STEEL);
}

pub(super) fn chimney(mesh: &mut Mesh) {
    let bands = [(0.0, 0.7, CONCRETE), (0.7, 0.1, RED), (0.8, 0.1, WHITE), (0.9, 0.1, RED)];
    for (from, tall, paint) in bands {
        let radius = |up: f32| 0.034 - 0.012 * up;
        mesh.column(Vec3::new(0.0, from, 0.0), tall, [radius(from), radius(from + tall)], 10, paint);
    }
}

pub(super) fn wind_turbine(mesh: &mut Mesh) {
    let white = WHITE;
    mesh.column(Vec3::ZERO, 1.0, [0.022, 0.012], 10, white);
    body(mesh, &[[-0.035, 1.01, 0.014, 0.014], [0.05, 1.01, 0.016, 0.017]], 6, white);
    body(mesh, &[[-0.06, 1.01, 0.004, 0.004], [-0.035, 1.01, 0.014, 0.014]], 8, white);
    for blade in 0..3_u8 {
        let (sin, cos) = (TAU * f32::from(blade) / 3.0 + 0.4).sin_cos();
        let across = Vec3::new(cos, -sin, 0.0);
        let out = Vec3::new(sin, cos, 0.0);
        let hub = Vec3::new(0.0, 1.01, -0.045);
        // Rotor of about the hub's height across; chord a fifteenth of the length at the root.
        let section = |away: f32, chord: f32, thick: f32| {
            [(0.3, 0.0), (0.0, 1.0), (-0.7, 0.0), (0.0, -1.0)]
                .map(|(c, t)| hub + out * away + across * (c * chord) + Vec3::Z * (t * thick))
                .to_vec()
        };
        let rings = [section(0.012, 0.014, 0.006), section(0.12, 0.032, 0.004), section(0.5, 0.007, 0.001)];
        mesh.loft(&rings, white);
    }
    let top = Vec3::new(0.0, 1.028, 0.03);
    mesh.cuboid(top - Vec3::splat(0.003), top + Vec3::splat(0.003), LAMP, LAMP);
}

/// A lattice tower of a 110 to 220 kV line, legs and braces as thin boxes, three cross arms across x.
pub(super) fn power_tower(mesh: &mut Mesh) {
    let beam = |mesh: &mut Mesh, a: Vec3, b: Vec3, half: f32| {
        let along = (b - a).normalize_or_zero();
        let side = if along.y.abs() > 0.9 { Vec3::X } else { Vec3::Y };
        let u = along.cross(side).normalize_or_zero() * half;
        let w = along.cross(u).normalize_or_zero() * half;
        let section = |at: Vec3| vec![at + u, at + w, at - u, at - w];
        mesh.loft(&[section(a), section(b)], STEEL);
    };
    let levels = [(0.0_f32, 0.085_f32), (0.3, 0.05), (0.6, 0.028), (0.85, 0.016), (1.0, 0.004)];
    let corner = |(y, r): (f32, f32), n: usize| {
        let (x, z) = [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)][n % 4];
        Vec3::new(x * r, y, z * r)
    };
    for pair in levels.windows(2) {
        for n in 0..4 {
            beam(mesh, corner(pair[0], n), corner(pair[1], n), 0.005);
            beam(mesh, corner(pair[0], n), corner(pair[1], n + 1), 0.003);
        }
    }
    for (y, reach) in [(0.62_f32, 0.16_f32), (0.74, 0.2), (0.86, 0.14)] {
        for side in [-1.0_f32, 1.0] {
            beam(mesh, Vec3::new(0.0, y + 0.03, 0.0), Vec3::new(side * reach, y, 0.0), 0.004);
            beam(mesh, Vec3::new(0.0, y, 0.0), Vec3::new(side * reach, y, 0.0), 0.004);
            beam(mesh, Vec3::new(side * reach, y, 0.0), Vec3::new(side * reach, y - 0.035, 0.0), 0.003);
        }
    }
}
