//! Things that are placed, masts and power line towers, each from code: a detailed shape and a coarse one.
//!
//! Frame: see [`super`]. Sizes are those of [`terrain::features::shape`], whose boxes shells meet; sources stand there.
//! Masts and towers are made 1 m high and scaled to their height.

use super::mesh::{Mesh, Paint};
use glam::Vec3;
use std::f32::consts::TAU;
use terrain::features::model::{MastClass, PlacedClass};
use terrain::features::shape;

/// All shapes there are.
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Model {
    Hangar,
    ControlTower,
    Terminal,
    FuelTank,
    Truck,
    Tank,
    Aircraft,
    Ship,
    Boat,
    Windsock,
    Mast,
    Tower,
    Chimney,
    WindTurbine,
    PowerTower,
}

/// Every model, in the order of their numbers.
pub const MODELS: [Model; 15] = [
    Model::Hangar,
    Model::ControlTower,
    Model::Terminal,
    Model::FuelTank,
    Model::Truck,
    Model::Tank,
    Model::Aircraft,
    Model::Ship,
    Model::Boat,
    Model::Windsock,
    Model::Mast,
    Model::Tower,
    Model::Chimney,
    Model::WindTurbine,
    Model::PowerTower,
];

const SHEET: Paint = Paint::matt(0.36, 0.37, 0.37);
const GREY: Paint = Paint::matt(0.30, 0.30, 0.31);
const DARK: Paint = Paint::matt(0.05, 0.05, 0.055);
const WHITE: Paint = Paint::matt(0.56, 0.56, 0.54);
const CONCRETE: Paint = Paint::matt(0.34, 0.33, 0.31);
const OLIVE: Paint = Paint::matt(0.125, 0.13, 0.08);
const CANVAS: Paint = Paint::matt(0.17, 0.165, 0.115);
const RED: Paint = Paint::matt(0.42, 0.07, 0.05);
const GLASS: Paint = Paint::matt(0.04, 0.05, 0.06).of_kind(3);
const STEEL: Paint = Paint::matt(0.33, 0.34, 0.35);
const LAMP: Paint = Paint::matt(0.55, 0.10, 0.08).of_kind(4);

impl From<PlacedClass> for Model {
    fn from(class: PlacedClass) -> Self {
        match class {
            PlacedClass::Hangar => Self::Hangar,
            PlacedClass::ControlTower => Self::ControlTower,
            PlacedClass::Terminal => Self::Terminal,
            PlacedClass::FuelTank => Self::FuelTank,
            PlacedClass::Truck => Self::Truck,
            PlacedClass::Tank => Self::Tank,
            PlacedClass::Aircraft => Self::Aircraft,
            PlacedClass::Ship => Self::Ship,
            PlacedClass::Boat => Self::Boat,
            PlacedClass::Windsock => Self::Windsock,
        }
    }
}

impl From<MastClass> for Model {
    fn from(class: MastClass) -> Self {
        match class {
            MastClass::Mast => Self::Mast,
            MastClass::Tower => Self::Tower,
            MastClass::Chimney => Self::Chimney,
            MastClass::WindTurbine => Self::WindTurbine,
        }
    }
}

impl Model {
    /// Its place in [`MODELS`].
    pub fn number(self) -> usize {
        self as usize
    }

    /// What a file with its shape would be called, without ending.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hangar => "hangar",
            Self::ControlTower => "control_tower",
            Self::Terminal => "terminal",
            Self::FuelTank => "fuel_tank",
            Self::Truck => "truck",
            Self::Tank => "tank",
            Self::Aircraft => "aircraft",
            Self::Ship => "ship",
            Self::Boat => "boat",
            Self::Windsock => "windsock",
            Self::Mast => "mast",
            Self::Tower => "tower",
            Self::Chimney => "chimney",
            Self::WindTurbine => "wind_turbine",
            Self::PowerTower => "power_tower",
        }
    }

    /// The placed class that it draws, if it is one's.
    pub fn placed(self) -> Option<PlacedClass> {
        use PlacedClass as P;
        let all = [
            P::Hangar,
            P::ControlTower,
            P::Terminal,
            P::FuelTank,
            P::Truck,
            P::Tank,
            P::Aircraft,
            P::Ship,
            P::Boat,
            P::Windsock,
        ];
        all.into_iter().find(|class| Self::from(*class) == self)
    }

    /// Whether it is made 1 m high and scaled to its height; a turbine's is the hub's.
    pub fn is_scaled_to_height(self) -> bool {
        matches!(self, Self::Mast | Self::Tower | Self::Chimney | Self::WindTurbine | Self::PowerTower)
    }

    /// Its shape: level 0 in detail, level 1 of a few boxes.
    pub fn mesh(self, level: usize) -> Mesh {
        let mut mesh = Mesh::default();
        if level > 0 && self.boxes(&mut mesh) {
            return mesh;
        }
        match self {
            Self::Hangar => hangar(&mut mesh),
            Self::ControlTower => control_tower(&mut mesh),
            Self::Terminal => terminal(&mut mesh),
            Self::FuelTank => fuel_tank(&mut mesh),
            Self::Truck => truck(&mut mesh),
            Self::Tank => tank(&mut mesh),
            Self::Aircraft => aircraft(&mut mesh),
            Self::Ship => ship(&mut mesh),
            Self::Boat => boat(&mut mesh),
            Self::Windsock => windsock(&mut mesh),
            Self::Mast => mesh.column(Vec3::ZERO, 1.0, [0.006, 0.004], 4, STEEL),
            Self::Tower => tower(&mut mesh),
            Self::Chimney => chimney(&mut mesh),
            Self::WindTurbine => wind_turbine(&mut mesh),
            Self::PowerTower => power_tower(&mut mesh),
        }
        mesh
    }

    /// The boxes that shells meet, painted; false where there is nothing coarser than the shape itself.
    fn boxes(self, mesh: &mut Mesh) -> bool {
        let Some(class) = self.placed() else { return false };
        let paint = match self {
            Self::Truck => CANVAS,
            Self::Tank => OLIVE,
            Self::Aircraft | Self::Boat | Self::FuelTank => WHITE,
            Self::Ship => GREY,
            Self::ControlTower | Self::Terminal => CONCRETE,
            _ => SHEET,
        };
        for one in shape::placed(class) {
            mesh.cuboid(one.low.as_vec3(), one.high.as_vec3(), paint, paint);
        }
        true
    }
}

/// An upright ring of points about a middle, in the plane across z, counter-clockwise seen from +z.
fn ring(middle: Vec3, half: [f32; 2], sides: u32) -> Vec<Vec3> {
    (0..sides)
        .map(|side| {
            let (sin, cos) = (TAU * (side as f32 + 0.5) / sides as f32).sin_cos();
            middle + Vec3::new(half[0] * cos, half[1] * sin, 0.0)
        })
        .collect()
}

/// A body along z through rings (z, middle height, half width, half height), from the front (least z) backward.
fn body(mesh: &mut Mesh, sections: &[[f32; 4]], sides: u32, paint: Paint) {
    let rings: Vec<Vec<Vec3>> =
        sections.iter().map(|[z, y, w, h]| ring(Vec3::new(0.0, *y, *z), [*w, *h], sides)).collect();
    mesh.loft(&rings, paint);
}

fn cuboid(mesh: &mut Mesh, low: [f32; 3], high: [f32; 3], paint: Paint) {
    mesh.cuboid(low.into(), high.into(), paint, paint);
}

fn hangar(mesh: &mut Mesh) {
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

fn control_tower(mesh: &mut Mesh) {
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
fn level_ring(y: f32, radius: f32, sides: u32) -> Vec<Vec3> {
    (0..sides)
        .map(|side| {
            let (sin, cos) = (-TAU * (side as f32 + 0.5) / sides as f32).sin_cos();
            Vec3::new(radius * cos, y, radius * sin)
        })
        .collect()
}

fn terminal(mesh: &mut Mesh) {
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

fn fuel_tank(mesh: &mut Mesh) {
    mesh.column(Vec3::ZERO, 6.0, [4.0, 4.0], 18, WHITE);
    mesh.column(Vec3::new(0.0, 6.0, 0.0), 0.5, [4.0, 0.4], 18, WHITE.shaded(0.9));
}

fn wheel(mesh: &mut Mesh, x: f32, z: f32, radius: f32, width: f32) {
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

fn truck(mesh: &mut Mesh) {
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

fn tank(mesh: &mut Mesh) {
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

/// A flat surface of an aircraft: root and tip chords (x, y, front z, back z), mirrored, with a thickness at the root.
fn wing(mesh: &mut Mesh, root: [f32; 4], tip: [f32; 4], thick_m: f32, paint: Paint) {
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

fn aircraft(mesh: &mut Mesh) {
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

/// A hull: sections along z of half widths at the deck and at the keel.
fn hull(mesh: &mut Mesh, sections: &[[f32; 5]], paint: Paint) {
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

fn ship(mesh: &mut Mesh) {
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

fn boat(mesh: &mut Mesh) {
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

fn windsock(mesh: &mut Mesh) {
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

fn tower(mesh: &mut Mesh) {
    mesh.column(Vec3::ZERO, 0.86, [0.055, 0.04], 10, CONCRETE);
    mesh.column(Vec3::new(0.0, 0.86, 0.0), 0.08, [0.06, 0.06], 10, SHEET);
    mesh.column(Vec3::new(0.0, 0.94, 0.0), 0.06, [0.006, 0.004], 4, STEEL);
}

fn chimney(mesh: &mut Mesh) {
    let bands = [(0.0, 0.7, CONCRETE), (0.7, 0.1, RED), (0.8, 0.1, WHITE), (0.9, 0.1, RED)];
    for (from, tall, paint) in bands {
        let radius = |up: f32| 0.034 - 0.012 * up;
        mesh.column(Vec3::new(0.0, from, 0.0), tall, [radius(from), radius(from + tall)], 10, paint);
    }
}

fn wind_turbine(mesh: &mut Mesh) {
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
fn power_tower(mesh: &mut Mesh) {
    let beam = |mesh: &mut Mesh, a: Vec3, b: Vec3, half: f32| {
        let along = (b - a).normalize_or_zero();
        let side = if along.y.abs() > 0.9 { Vec3::X } else { Vec3::Y };
        let (u, v) = (along.cross(side).normalize_or_zero() * half, Vec3::ZERO);
        let w = along.cross(u).normalize_or_zero() * half;
        let _ = v;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_have_their_real_sizes_and_stay_near_the_boxes_that_shells_meet() {
        for model in MODELS {
            assert_eq!(MODELS[model.number()], model);
            for level in 0..2 {
                let mesh = model.mesh(level);
                assert!(mesh.indices.iter().all(|index| (*index as usize) < mesh.vertices.len()));
                assert!(mesh.indices.len() >= 36 / (1 + level) && mesh.indices.len() < 6_000, "{model:?}");
                let (low, high) = mesh.bounds_m();
                let Some(class) = model.placed() else {
                    assert!(high.y > 0.9 && high.y < 1.6 && low.y > -0.1, "{model:?} {low} {high}");
                    continue;
                };
                let around = shape::bounds(shape::placed(class));
                let (low, high) = (low.as_dvec3() - around.low, high.as_dvec3() - around.high);
                // Aerials, propellers and a windsock's cloth reach beyond.
                let detail_m = if model == Model::Windsock || model == Model::ControlTower { 4.0 } else { 1.7 };
                assert!(
                    low.abs().max_element() < detail_m && high.abs().max_element() < detail_m,
                    "{model:?} {low} {high}"
                );
            }
        }
    }

    #[test]
    fn faces_look_outward() {
        // Of a closed skin the signed volume is positive.
        for model in MODELS {
            let mesh = model.mesh(0);
            let mut volume = 0.0;
            for triangle in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|n| Vec3::from(mesh.vertices[triangle[n] as usize].position_m));
                volume += a.dot(b.cross(c)) / 6.0;
            }
            assert!(volume > 0.0, "{model:?}: {volume}");
        }
    }
}
