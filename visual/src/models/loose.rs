//! What lies about: drum, crate, cone, pole; plates, sheets, wheels, beams and lumps of what broke.
//!
//! Frame: see [`super`]. Sizes are those by which the simulation lets them lie (`sim::loose::LooseKind`); a test of the
//! program compares them.

use super::mesh::{Mesh, Paint};
use super::parts::{CONCRETE, DARK, OLIVE, SHEET, STEEL, WHITE, cuboid};
use glam::Vec3;

const WOOD: Paint = Paint::matt(0.30, 0.21, 0.12);
const BLUE: Paint = Paint::matt(0.05, 0.13, 0.26);
const ORANGE: Paint = Paint::matt(0.62, 0.16, 0.03);
const RUST: Paint = Paint::matt(0.13, 0.085, 0.06);

/// A box with its bottom, which is seen when it lies on its side.
fn whole(mesh: &mut Mesh, low: [f32; 3], high: [f32; 3], paint: Paint) {
    let [l, h] = [low, high];
    cuboid(mesh, low, high, paint);
    let at = |x: f32, z: f32| Vec3::new(x, l[1], z);
    mesh.face(&[at(l[0], h[2]), at(l[0], l[2]), at(h[0], l[2]), at(h[0], h[2])], paint);
}

/// A drum of 200 litres with its two hoops.
pub(super) fn barrel(mesh: &mut Mesh) {
    mesh.column(Vec3::ZERO, 0.88, [0.28, 0.28], 14, BLUE);
    for y in [0.0_f32, 0.28, 0.56, 0.85] {
        mesh.column(Vec3::Y * y, 0.03, [0.29, 0.29], 14, BLUE.shaded(0.8));
    }
}

/// A crate of boards.
pub(super) fn crate_of_boards(mesh: &mut Mesh) {
    whole(mesh, [-0.47, 0.02, -0.47], [0.47, 0.78, 0.47], WOOD.shaded(0.75));
    for x in [-0.5_f32, 0.4] {
        for z in [-0.5_f32, 0.4] {
            whole(mesh, [x, 0.0, z], [x + 0.1, 0.8, z + 0.1], WOOD);
        }
    }
    for y in [0.0_f32, 0.7] {
        whole(mesh, [-0.5, y, -0.485], [0.5, y + 0.1, 0.485], WOOD);
        whole(mesh, [-0.485, y, -0.5], [0.485, y + 0.1, 0.5], WOOD);
    }
}

/// A traffic cone with a white band.
pub(super) fn cone(mesh: &mut Mesh) {
    whole(mesh, [-0.2, 0.0, -0.2], [0.2, 0.04, 0.2], ORANGE.shaded(0.8));
    mesh.column(Vec3::Y * 0.04, 0.30, [0.155, 0.095], 10, ORANGE);
    mesh.column(Vec3::Y * 0.34, 0.16, [0.095, 0.06], 10, WHITE);
    mesh.column(Vec3::Y * 0.50, 0.25, [0.06, 0.02], 10, ORANGE);
}

/// A range pole of 3 m in red and white.
pub(super) fn pole(mesh: &mut Mesh) {
    for part in 0..6 {
        let y = 0.5 * part as f32;
        let paint = if part % 2 == 0 { ORANGE } else { WHITE };
        whole(mesh, [-0.06, y, -0.06], [0.06, y + 0.5, 0.06], paint);
    }
}

/// A plate of armour, bent at one edge.
pub(super) fn plate(mesh: &mut Mesh) {
    let side = |x: f32| {
        [(-0.4, 0.02), (0.2, 0.0), (0.4, 0.07), (0.4, 0.1), (0.18, 0.05), (-0.4, 0.07)]
            .map(|(z, y)| Vec3::new(x, y, z))
            .to_vec()
    };
    mesh.loft(&[side(-0.6), side(0.6)], OLIVE.shaded(0.6));
}

/// A crumpled piece of sheet metal.
pub(super) fn sheet(mesh: &mut Mesh) {
    let line = |x: f32, up: f32| {
        [(-0.5, 0.02), (-0.2, 0.0), (0.1, 0.055), (0.5, 0.01), (0.5, 0.03), (0.1, 0.08), (-0.2, 0.02), (-0.5, 0.045)]
            .map(|(z, y): (f32, f32)| Vec3::new(x, (y + up).clamp(0.0, 0.08), z))
            .to_vec()
    };
    mesh.loft(&[line(-0.7, 0.0), line(-0.2, 0.02), line(0.2, -0.005), line(0.7, 0.015)], SHEET.shaded(0.45));
}

/// A wheel on its side, its axle upright.
pub(super) fn wheel_off(mesh: &mut Mesh) {
    mesh.column(Vec3::ZERO, 0.30, [0.5, 0.5], 14, DARK);
    mesh.column(Vec3::ZERO, 0.302, [0.24, 0.24], 8, STEEL.shaded(0.5));
}

/// A beam of a frame.
pub(super) fn beam(mesh: &mut Mesh) {
    whole(mesh, [-0.08, 0.0, -1.2], [0.08, 0.03, 1.2], RUST);
    whole(mesh, [-0.02, 0.03, -1.2], [0.02, 0.13, 1.2], RUST.shaded(0.9));
    whole(mesh, [-0.08, 0.13, -1.2], [0.08, 0.16, 1.2], RUST);
}

/// A lump of concrete.
pub(super) fn lump(mesh: &mut Mesh) {
    let ring = |y: f32, points: [(f32, f32); 5]| points.map(|(x, z)| Vec3::new(x, y, z)).to_vec();
    mesh.loft(
        &[
            ring(0.0, [(0.3, 0.05), (0.1, 0.27), (-0.26, 0.2), (-0.28, -0.16), (0.12, -0.26)]),
            ring(0.22, [(0.35, 0.02), (0.12, 0.3), (-0.3, 0.24), (-0.35, -0.2), (0.15, -0.3)]),
            ring(0.5, [(0.24, 0.02), (0.06, 0.2), (-0.2, 0.16), (-0.18, -0.14), (0.1, -0.2)]),
        ],
        CONCRETE,
    );
}
