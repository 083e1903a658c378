//! Every thing that is drawn as a shape, each from code: a detailed shape and, of what is placed, one of boxes.
//!
//! Frame: see [`super`]. Sizes are those of [`terrain::features::shape`], whose boxes shells meet; sources stand there.
//! Masts and towers are made 1 m high and scaled to their height.

use super::mesh::Mesh;
use super::parts::{CANVAS, CONCRETE, GREY, OLIVE, SHEET, STEEL, WHITE};
use super::{aircraft, airfield, loose, masts, vehicles};
use glam::Vec3;
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
    Apc,
    Radar,
    Bunker,
    ParkedAircraft,
    Bomb,
    Rocket,
    Barrel,
    Crate,
    Cone,
    Pole,
    Plate,
    Sheet,
    Wheel,
    Beam,
    Lump,
    Jet,
    Helicopter,
}

/// Every model, in the order of their numbers.
pub const MODELS: [Model; 32] = [
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
    Model::Apc,
    Model::Radar,
    Model::Bunker,
    Model::ParkedAircraft,
    Model::Bomb,
    Model::Rocket,
    Model::Barrel,
    Model::Crate,
    Model::Cone,
    Model::Pole,
    Model::Plate,
    Model::Sheet,
    Model::Wheel,
    Model::Beam,
    Model::Lump,
    Model::Jet,
    Model::Helicopter,
];

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
            Self::Apc => "apc",
            Self::Radar => "radar",
            Self::Bunker => "bunker",
            Self::ParkedAircraft => "parked_aircraft",
            Self::Bomb => "bomb",
            Self::Rocket => "rocket",
            Self::Barrel => "barrel",
            Self::Crate => "crate",
            Self::Cone => "cone",
            Self::Pole => "pole",
            Self::Plate => "plate",
            Self::Sheet => "sheet",
            Self::Wheel => "wheel",
            Self::Beam => "beam",
            Self::Lump => "lump",
            Self::Jet => "jet",
            Self::Helicopter => "helicopter",
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
            Self::Hangar => airfield::hangar(&mut mesh),
            Self::ControlTower => airfield::control_tower(&mut mesh),
            Self::Terminal => airfield::terminal(&mut mesh),
            Self::FuelTank => airfield::fuel_tank(&mut mesh),
            Self::Truck => vehicles::truck(&mut mesh),
            Self::Tank => vehicles::tank(&mut mesh),
            Self::Aircraft => aircraft::aircraft(&mut mesh),
            Self::Ship => vehicles::ship(&mut mesh),
            Self::Boat => vehicles::boat(&mut mesh),
            Self::Windsock => airfield::windsock(&mut mesh),
            Self::Mast => mesh.column(Vec3::ZERO, 1.0, [0.006, 0.004], 4, STEEL),
            Self::Tower => masts::tower(&mut mesh),
            Self::Chimney => masts::chimney(&mut mesh),
            Self::WindTurbine => masts::wind_turbine(&mut mesh),
            Self::PowerTower => masts::power_tower(&mut mesh),
            Self::Apc => vehicles::apc(&mut mesh),
            Self::Radar => vehicles::radar(&mut mesh),
            Self::Bunker => vehicles::bunker(&mut mesh),
            Self::ParkedAircraft => aircraft::jet(&mut mesh),
            Self::Bomb => aircraft::bomb(&mut mesh),
            Self::Rocket => aircraft::rocket(&mut mesh),
            Self::Barrel => loose::barrel(&mut mesh),
            Self::Crate => loose::crate_of_boards(&mut mesh),
            Self::Cone => loose::cone(&mut mesh),
            Self::Pole => loose::pole(&mut mesh),
            Self::Plate => loose::plate(&mut mesh),
            Self::Sheet => loose::sheet(&mut mesh),
            Self::Wheel => loose::wheel_off(&mut mesh),
            Self::Beam => loose::beam(&mut mesh),
            Self::Lump => loose::lump(&mut mesh),
            Self::Jet => aircraft::jet_in_flight(&mut mesh),
            Self::Helicopter => aircraft::helicopter(&mut mesh),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Halves of the block that shells strike, from `assets/targets`; of weapons their length and fins.
    fn target(model: Model) -> Option<Vec3> {
        match model {
            Model::Apc => Some(Vec3::new(1.45, 1.1, 3.8)),
            Model::Radar => Some(Vec3::new(1.5, 2.2, 3.5)),
            Model::Bunker => Some(Vec3::new(5.0, 2.0, 5.0)),
            Model::ParkedAircraft => Some(Vec3::new(5.0, 2.0, 7.5)),
            Model::Bomb => Some(Vec3::new(0.19, 0.19, 1.1)),
            Model::Rocket => Some(Vec3::new(0.1, 0.1, 0.7)),
            _ => None,
        }
    }

    #[test]
    fn shapes_have_their_real_sizes_and_stay_near_the_boxes_that_shells_meet() {
        for model in MODELS {
            assert_eq!(MODELS[model.number()], model);
            for level in 0..2 {
                let mesh = model.mesh(level);
                assert!(mesh.indices.iter().all(|index| (*index as usize) < mesh.vertices.len()));
                assert!(mesh.indices.len() >= 36 / (1 + level) && mesh.indices.len() < 6_000, "{model:?}");
                let (low, high) = mesh.bounds_m();
                if let Some(half_m) = target(model) {
                    let middle = if matches!(model, Model::Bomb | Model::Rocket) { 0.0 } else { half_m.y };
                    let off = (high.max(-low) - Vec3::new(half_m.x, half_m.y + middle, half_m.z)).abs();
                    assert!(off.x < 0.6 && off.y < 0.6 && off.z < 0.6, "{model:?} {low} {high}");
                    continue;
                }
                if let Model::Jet | Model::Helicopter = model {
                    // 15 x 10 x 4 m without its wheels, on which its foot would be; four blades of 4 m along the diagonals, 2.83 m
                    // ahead and aside, skids on the ground.
                    let size = high - low;
                    let expected =
                        if model == Model::Jet { Vec3::new(10.0, 2.9, 14.9) } else { Vec3::new(5.8, 2.8, 8.4) };
                    assert!((size - expected).abs().max_element() < 0.1 && low.y >= 0.0, "{model:?} {low} {high}");
                    continue;
                }
                if (Model::Barrel..=Model::Lump).contains(&model) {
                    // Compared with what the simulation lets lie by a test of the program.
                    assert!(low.y.abs() < 1e-6 && (high - low).max_element() < 3.1, "{model:?} {low} {high}");
                    continue;
                }
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
