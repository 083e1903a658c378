//! Kinds of loose things: what can be knocked over, and what flies off when something breaks.
//!
//! Sizes are halves of the sides of the box about a thing, in its own axes: x right, y up, z back, metres, the middle at
//! the origin. Round ones have their axis along y. Sizes and masses are estimates: a drum of 200 litres is 0.58 m wide,
//! 0.88 m high and some 20 kg when empty (from memory, not checked); the others are plausible things of their kind.
//!
//! Invariant others rely on: every half is at least 4 cm, so that a resting thing's middle is well above the ground.

use crate::scene::codec::coded_choice;
use glam::DVec3;
use rapier3d::parry::shape::SharedShape;

/// What a loose thing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LooseKind {
    /// An empty steel drum.
    Barrel,
    /// A wooden crate.
    Crate,
    /// A traffic cone.
    Cone,
    /// A range pole.
    Pole,
    /// A plate of armour.
    Plate,
    /// A piece of sheet metal.
    Sheet,
    /// A wheel.
    Wheel,
    /// A beam of a frame.
    Beam,
    /// A lump of concrete.
    Lump,
}
coded_choice!(LooseKind { Barrel, Crate, Cone, Pole, Plate, Sheet, Wheel, Beam, Lump });

/// Its form within the box about it.
#[derive(Clone, Copy)]
enum Form {
    Block,
    Cylinder,
    Cone,
}

impl LooseKind {
    /// Every kind, in the order of their numbers.
    pub const ALL: [Self; 9] = [
        Self::Barrel,
        Self::Crate,
        Self::Cone,
        Self::Pole,
        Self::Plate,
        Self::Sheet,
        Self::Wheel,
        Self::Beam,
        Self::Lump,
    ];

    /// Its place in [`Self::ALL`].
    pub fn number(self) -> u32 {
        self as u32
    }

    /// What files and shapes call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Barrel => "barrel",
            Self::Crate => "crate",
            Self::Cone => "cone",
            Self::Pole => "pole",
            Self::Plate => "plate",
            Self::Sheet => "sheet",
            Self::Wheel => "wheel",
            Self::Beam => "beam",
            Self::Lump => "lump",
        }
    }

    /// The kind of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    fn row(self) -> (Form, [f64; 3], f64) {
        match self {
            Self::Barrel => (Form::Cylinder, [0.29, 0.44, 0.29], 20.0),
            Self::Crate => (Form::Block, [0.5, 0.4, 0.5], 90.0),
            Self::Cone => (Form::Cone, [0.2, 0.375, 0.2], 4.0),
            Self::Pole => (Form::Block, [0.06, 1.5, 0.06], 12.0),
            Self::Plate => (Form::Block, [0.6, 0.05, 0.4], 150.0),
            Self::Sheet => (Form::Block, [0.7, 0.04, 0.5], 15.0),
            Self::Wheel => (Form::Cylinder, [0.5, 0.15, 0.5], 70.0),
            Self::Beam => (Form::Block, [0.08, 0.08, 1.2], 60.0),
            Self::Lump => (Form::Block, [0.35, 0.25, 0.3], 480.0),
        }
    }

    /// Halves of the sides of the box about it, metres.
    pub fn half_m(self) -> DVec3 {
        DVec3::from_array(self.row().1)
    }

    /// Mass, kg.
    pub fn mass_kg(self) -> f64 {
        self.row().2
    }

    /// Radius of the ball about it, metres.
    pub fn radius_m(self) -> f64 {
        self.half_m().length()
    }

    /// Least half of a side: how high its middle is over flat ground at least, metres.
    pub fn least_half_m(self) -> f64 {
        self.half_m().min_element()
    }

    /// Area that it shows on average over all sides, m2: a quarter of the surface of the box (A. Cauchy, 1850).
    pub fn area_m2(self) -> f64 {
        let half = self.half_m();
        2.0 * (half.x * half.y + half.y * half.z + half.z * half.x)
    }

    /// Whether it comes from something that broke.
    pub fn is_debris(self) -> bool {
        self.number() >= Self::Plate.number()
    }

    /// Whether it stands upright on a slope too.
    pub fn stands_upright(self) -> bool {
        self == Self::Pole
    }

    /// Radius that it rolls on, metres; `None` of what does not roll.
    pub(super) fn rolls_on_m(self) -> Option<f64> {
        let (form, half, _) = self.row();
        (!matches!(form, Form::Block)).then_some(half[0])
    }

    /// Its shape for the physics engine.
    pub fn collider(self) -> SharedShape {
        let (form, half, _) = self.row();
        match form {
            Form::Block => SharedShape::cuboid(half[0], half[1], half[2]),
            Form::Cylinder => SharedShape::cylinder(half[1], half[0]),
            Form::Cone => SharedShape::cone(half[1], half[0]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_tell_kinds_apart_and_all_are_thick_enough() {
        for (place, kind) in LooseKind::ALL.into_iter().enumerate() {
            assert_eq!((kind.number() as usize, LooseKind::named(kind.name())), (place, Some(kind)));
            assert!(kind.least_half_m() >= 0.04 && kind.radius_m() < 2.0 && kind.mass_kg() > 0.0, "{kind:?}");
        }
        assert_eq!(LooseKind::named("barrels"), None);
    }
}
