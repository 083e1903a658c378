//! What the ground is like under a contact: its height, its slope, how it holds and how it rolls.
//!
//! Friction of a file is that of dry concrete; a surface has a share of it, and adds to what a rolling wheel loses.
//!
//! Source: D. P. Raymer, Aircraft Design: A Conceptual Approach, table 17.1 (rolling and braked friction of dry concrete
//! 0.03 and 0.5, hard turf 0.05 and 0.4, soft turf 0.07 and 0.2, icy 0.02 and 0.08); from memory, not checked. Sand and
//! snow are estimates.

use glam::DVec3;
use terrain::features::cover::CoverClass;

/// How a surface holds and rolls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Part of the friction of dry concrete.
    pub grip: f64,
    /// Added to the coefficient of rolling.
    pub rolling: f64,
    /// Whether it carries nothing: what meets it is down.
    pub is_water: bool,
}

impl Surface {
    /// Dry concrete.
    pub const PAVED: Self = Self { grip: 1.0, rolling: 0.0, is_water: false };

    /// The surface of a cover.
    pub fn of(cover: CoverClass) -> Self {
        let ground = |grip, rolling| Self { grip, rolling, is_water: false };
        match cover {
            CoverClass::Unknown | CoverClass::Paved | CoverClass::BuiltUp => Self::PAVED,
            CoverClass::Water => Self { is_water: true, ..ground(0.2, 0.5) },
            CoverClass::Grass | CoverClass::Rock => ground(0.8, 0.02),
            CoverClass::Field | CoverClass::Scrub => ground(0.4, 0.04),
            CoverClass::Conifer | CoverClass::Broadleaf | CoverClass::MixedForest => ground(0.4, 0.06),
            CoverClass::Snow => ground(0.16, 0.05),
            CoverClass::Sand => ground(0.4, 0.12),
        }
    }
}

/// The ground under a plan point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footing {
    /// A point of the ground, north, east, down.
    pub point_m: DVec3,
    /// Upward unit normal, north, east, down.
    pub normal: DVec3,
    /// What it is like.
    pub surface: Surface,
}
