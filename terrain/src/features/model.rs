//! What lies on the ground, as the bake leaves it: plain data in the world's plane.
//!
//! Frame: [`crate::frame`]; a plan point is (x, z) in metres. Widths, heights and levels in metres. Nothing here has a
//! height of its own except water, airfields and what a file states: everything else stands on the ground query.
//! Invariant: every number is finite, every line has at least two points and every ring at least three.

use super::cover::CoverClass;
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// All features of a world but its lakes, which are in [`super::lakes`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Features {
    /// Roads and railways.
    pub roads: Vec<Road>,
    /// Rivers, streams, canals.
    pub waterways: Vec<Waterway>,
    /// Areas of one cover.
    pub areas: Vec<LandArea>,
    /// Buildings.
    pub buildings: Vec<Building>,
    /// Airfields.
    pub airfields: Vec<Airfield>,
    /// Power lines.
    pub power_lines: Vec<PowerLine>,
    /// Masts, towers, chimneys.
    pub masts: Vec<Mast>,
    /// Single things that are placed: hangars, control towers, vehicles, ships.
    pub placed: Vec<Placed>,
}

impl Features {
    /// Whether the module's invariant holds.
    pub fn is_sound(&self) -> bool {
        let line = |line: &[DVec2]| line.len() >= 2 && line.iter().all(|p| p.is_finite());
        let ring = |ring: &[DVec2]| ring.len() >= 3 && ring.iter().all(|p| p.is_finite());
        let positive = |width_m: f32| width_m.is_finite() && width_m > 0.0;
        self.roads.iter().all(|road| line(&road.line) && positive(road.width_m))
            && self.waterways.iter().all(|water| line(&water.line) && positive(water.width_m))
            && self.areas.iter().all(|area| area.rings.iter().all(|r| ring(r)))
            && self.buildings.iter().all(|building| ring(&building.outline) && positive(building.height_m))
            && self.airfields.iter().all(|airfield| {
                airfield.reference.is_finite()
                    && airfield.level_m.is_finite()
                    && airfield.runways.iter().all(|runway| line(&runway.ends) && positive(runway.width_m))
                    && airfield.taxiways.iter().all(|(way, width_m)| line(way) && positive(*width_m))
                    && airfield.aprons.iter().all(|apron| ring(apron))
            })
            && self.power_lines.iter().all(|power| line(&power.line) && positive(power.height_m))
            && self.masts.iter().all(|mast| mast.at.is_finite() && positive(mast.height_m))
            && self.placed.iter().all(|placed| placed.at.is_finite() && placed.grid_heading_rad.is_finite())
    }
}

/// Kinds of roads, widest first.
#[allow(missing_docs, reason = "the names are the field's own")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum RoadClass {
    Motorway,
    Trunk,
    Primary,
    Secondary,
    Tertiary,
    Residential,
    Service,
    Track,
    Path,
    Railway,
}

/// A road or railway.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Road {
    /// Its class.
    pub class: RoadClass,
    /// Nominal width.
    pub width_m: f32,
    /// Whether its surface is sealed.
    pub paved: bool,
    /// Whether it runs underground, and is not drawn.
    pub tunnel: bool,
    /// Whether it runs over a bridge (drawn on the ground for now).
    pub bridge: bool,
    /// Its middle.
    pub line: Vec<DVec2>,
}

/// Kinds of running water.
#[allow(missing_docs, reason = "the names are the field's own")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum WaterwayClass {
    River,
    Stream,
    Canal,
    Ditch,
}

/// Running water, from its source on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Waterway {
    /// Its class.
    pub class: WaterwayClass,
    /// Nominal width.
    pub width_m: f32,
    /// Whether it runs underground, and is not drawn.
    pub tunnel: bool,
    /// Its middle, downstream.
    pub line: Vec<DVec2>,
}

/// An area of one cover: even-odd rule over all rings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LandArea {
    /// What covers it.
    pub cover: CoverClass,
    /// Outlines and holes.
    pub rings: Vec<Vec<DVec2>>,
}

/// What a building looks like.
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum BuildingClass {
    House,
    Apartments,
    Commercial,
    Industrial,
    Church,
    Hangar,
    Barn,
    Other,
}

/// Where a number came from.
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Origin {
    /// The file states it.
    Stated,
    /// Worked out from something the file states, as a height from levels.
    Derived,
    /// A default of this program.
    Assumed,
}

/// A building: its outline, pulled up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Building {
    /// What it looks like.
    pub class: BuildingClass,
    /// Outline without repetition of the first point, counter-clockwise seen from above (x east, z south).
    pub outline: Vec<DVec2>,
    /// Eaves above the ground at the outline's lowest point.
    pub height_m: f32,
    /// Where the height came from.
    pub height_from: Origin,
}

/// What a runway is made of.
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum RunwaySurface {
    Asphalt,
    Concrete,
    Gravel,
    Grass,
}

/// A runway.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Runway {
    /// Middle of its two thresholds; the first is that of `designators[0]`, from which one flies towards the second.
    pub ends: [DVec2; 2],
    /// Width.
    pub width_m: f32,
    /// As painted, such as `06` and `24L`.
    pub designators: [String; 2],
    /// What it is made of.
    pub surface: RunwaySurface,
    /// Whether it has lights.
    pub lit: bool,
    /// Where its geometry came from.
    pub from: Origin,
}

/// An airfield. Its ground was set to one level by the bake.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Airfield {
    /// ICAO code, or the file's own.
    pub code: String,
    /// Name.
    pub name: String,
    /// Reference point.
    pub reference: DVec2,
    /// Level of its surfaces above sea level.
    pub level_m: f64,
    /// Runways.
    pub runways: Vec<Runway>,
    /// Middles of taxiways and their width.
    pub taxiways: Vec<(Vec<DVec2>, f32)>,
    /// Outlines of aprons.
    pub aprons: Vec<Vec<DVec2>>,
}

/// A power line: a tower at each point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PowerLine {
    /// Its towers.
    pub line: Vec<DVec2>,
    /// Height of its towers.
    pub height_m: f32,
}

/// Kinds of masts.
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum MastClass {
    Mast,
    Tower,
    Chimney,
    WindTurbine,
}

/// A mast.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mast {
    /// Its kind.
    pub class: MastClass,
    /// Where.
    pub at: DVec2,
    /// Height.
    pub height_m: f32,
}

/// Kinds of things that are placed.
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PlacedClass {
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
}

/// A thing that is placed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Placed {
    /// Its kind.
    pub class: PlacedClass,
    /// Where its middle stands.
    pub at: DVec2,
    /// Where its front looks, clockwise from grid north.
    pub grid_heading_rad: f32,
}
