//! From tags to what they mean, by the keys of OpenStreetMap (wiki.openstreetmap.org/wiki/Map_features).
//!
//! An element has a kind by its keys alone ([`meanings`]): ways and relations with `highway`, `railway`, `waterway`,
//! `building`; any with the values of the table of areas; points also where one stands for the thing. So a count of a
//! file by its keys, with any other program, gives the same numbers. What is of a kind and not drawn is so for a
//! reason. Sizes that a file does not state are the defaults of this file; each says where it comes from.

use super::kind::Kind;
use super::measure::{metres, number};
use super::raw::{Element, Tags};
use crate::features::cover::CoverClass;
use crate::features::model::{BuildingClass, MastClass, Origin, RoadClass, RunwaySurface, WaterwayClass};

/// What an element is.
#[derive(Debug, Clone, PartialEq)]
pub enum Meaning {
    /// A road or railway.
    Road(RoadClass, f32, Origin),
    /// Running water.
    Waterway(WaterwayClass, f32, Origin),
    /// Still water, which may be a lake with one level; running water, which may not.
    Water { still: bool },
    /// An area of one cover.
    Area(CoverClass),
    /// A building and the height of its eaves.
    Building(BuildingClass, f32, Origin),
    /// A power line and the height of its towers.
    PowerLine(f32),
    /// A tower that is drawn with its line, if it has one.
    PowerTower(f32),
    /// A mast.
    Mast(MastClass, f32),
    /// A runway and what it is made of.
    Runway(RunwaySurface),
    /// A taxiway.
    Taxiway(f32),
    /// An apron.
    Apron,
    /// A helipad.
    Helipad,
    /// An airfield.
    Aerodrome,
}

/// Why an element is of a kind and not in the world.
pub type Skip = String;

/// Width of a lane: the middle of 2.75 to 3.75 m, the lanes of the German RAS-Q 96.
const LANE_M: f64 = 3.25;

/// All that an element is; empty if it is nothing that is known here.
pub fn meanings(tags: &Tags, element: Element) -> Vec<(Kind, Result<Meaning, Skip>)> {
    let mut found = Vec::new();
    let node = element == Element::Node;
    if !node {
        if let Some(value) = tags.get("highway") {
            found.push((Kind::Highways, highway(tags, value)));
        }
        if let Some(value) = tags.get("railway") {
            found.push((Kind::Railways, railway(tags, value)));
        }
        if let Some(value) = tags.get("waterway") {
            found.push((Kind::Waterways, waterway(tags, value, element)));
        }
        if let Some(value) = tags.get("building") {
            found.push((Kind::Buildings, building(tags, value)));
        }
        if tags.is_any("power", &["line", "minor_line"]) {
            let height_m = height_m(tags).unwrap_or(if tags.is("power", "line") { 30.0 } else { 9.0 });
            found.push((Kind::PowerLines, Ok(Meaning::PowerLine(height_m))));
        }
        if element == Element::Way && tags.is("natural", "coastline") {
            // What it encloses is known by `coast`.
            found.push((Kind::Coastlines, Ok(Meaning::Water { still: true })));
        }
        areas(tags, &mut found);
    }
    points(tags, node, &mut found);
    found
}

/// A road by `highway`; its width is `width`, else that of its `lanes`, else its class's.
///
/// Class widths: one carriageway of the cross-sections RQ 29.5 (motorway), RQ 10.5 with shoulders (trunk), RQ 10.5,
/// RQ 9.5, RQ 7.5 of RAS-Q 96; below those, assumed.
fn highway(tags: &Tags, value: &str) -> Result<Meaning, Skip> {
    let (class, default_m) = match value {
        "motorway" => (RoadClass::Motorway, 11.5),
        "motorway_link" => (RoadClass::Motorway, 5.5),
        "trunk" => (RoadClass::Trunk, 8.5),
        "trunk_link" => (RoadClass::Trunk, 5.5),
        "primary" => (RoadClass::Primary, 7.5),
        "primary_link" => (RoadClass::Primary, 5.0),
        "secondary" => (RoadClass::Secondary, 6.5),
        "secondary_link" => (RoadClass::Secondary, 5.0),
        "tertiary" | "tertiary_link" => (RoadClass::Tertiary, 5.5),
        "residential" | "unclassified" | "living_street" | "road" | "pedestrian" | "raceway" | "minor" => {
            (RoadClass::Residential, 5.0)
        }
        "service" | "services" | "bus_guideway" | "busway" => (RoadClass::Service, 3.5),
        "track" => (RoadClass::Track, 3.0),
        "path" | "footway" | "cycleway" | "bridleway" | "steps" | "via_ferrata" | "byway" => (RoadClass::Path, 1.5),
        other => return Err(format!("highway={} is no way to draw", known(other, &NO_ROADS))),
    };
    let (width_m, from) = width(tags, default_m);
    Ok(Meaning::Road(class, width_m, from))
}

const NO_ROADS: [&str; 12] = [
    "construction",
    "proposed",
    "platform",
    "rest_area",
    "bus_stop",
    "crossing",
    "elevator",
    "corridor",
    "abandoned",
    "disused",
    "planned",
    "escape",
];

/// A railway: 4 m of ballast a track (assumed).
fn railway(tags: &Tags, value: &str) -> Result<Meaning, Skip> {
    match value {
        "rail" | "light_rail" | "tram" | "narrow_gauge" | "funicular" | "preserved" | "monorail" | "rack" => {
            let stated = tags.get("width").and_then(metres).and_then(|width_m| sane(width_m, 0.5, 100.0));
            let from = if stated.is_some() { Origin::Stated } else { Origin::Assumed };
            Ok(Meaning::Road(RoadClass::Railway, stated.unwrap_or(4.0), from))
        }
        "subway" => Err("underground".into()),
        other => {
            const NO_TRACKS: [&str; 11] = [
                "platform",
                "station",
                "abandoned",
                "disused",
                "razed",
                "construction",
                "proposed",
                "turntable",
                "halt",
                "roundhouse",
                "historic",
            ];
            Err(format!("railway={} is no track", known(other, &NO_TRACKS)))
        }
    }
}

/// Running water by `waterway`; default widths are assumed.
fn waterway(tags: &Tags, value: &str, element: Element) -> Result<Meaning, Skip> {
    let (class, default_m) = match value {
        "river" => (WaterwayClass::River, 12.0),
        "stream" | "brook" | "tidal_channel" => (WaterwayClass::Stream, 2.0),
        "canal" => (WaterwayClass::Canal, 10.0),
        "ditch" | "drain" => (WaterwayClass::Ditch, 1.5),
        "riverbank" => return Ok(Meaning::Water { still: false }),
        "dock" => return Ok(Meaning::Water { still: true }),
        other => {
            const NO_WATER: [&str; 12] = [
                "dam",
                "weir",
                "waterfall",
                "lock_gate",
                "boatyard",
                "fuel",
                "rapids",
                "derelict_canal",
                "wadi",
                "pressurised",
                "fish_pass",
                "sluice_gate",
            ];
            return Err(format!("waterway={} is no running water to draw", known(other, &NO_WATER)));
        }
    };
    if element == Element::Relation && !tags.is("type", "multipolygon") {
        return Err("a relation that groups; its ways are read".into());
    }
    let stated = tags.get("width").and_then(metres).and_then(|width_m| sane(width_m, 0.2, 20_000.0));
    let from = if stated.is_some() { Origin::Stated } else { Origin::Assumed };
    Ok(Meaning::Waterway(class, stated.unwrap_or(default_m), from))
}

/// A building: its height is `height` less `roof:height`, else 3 m a level and 1 m of roof and plinth, else that of
/// its class (assumed: two levels for a house, four for flats, one high one for a hall).
fn building(tags: &Tags, value: &str) -> Result<Meaning, Skip> {
    if value == "no" {
        return Err("building=no".into());
    }
    let class = match value {
        "house" | "detached" | "terrace" | "semidetached_house" | "bungalow" | "cabin" | "farm" | "hut" | "villa"
        | "static_caravan" => BuildingClass::House,
        "apartments" | "residential" | "dormitory" | "hotel" | "tower" => BuildingClass::Apartments,
        "commercial" | "retail" | "office" | "supermarket" | "public" | "civic" | "school" | "university"
        | "hospital" | "government" | "train_station" | "college" | "kindergarten" | "stadium" => {
            BuildingClass::Commercial
        }
        "industrial" | "warehouse" | "manufacture" | "factory" => BuildingClass::Industrial,
        "church" | "chapel" | "cathedral" | "mosque" | "temple" | "synagogue" | "basilica" => BuildingClass::Church,
        "hangar" => BuildingClass::Hangar,
        "barn" | "farm_auxiliary" | "stable" | "cowshed" | "greenhouse" | "shed" | "garage" | "garages" | "carport"
        | "roof" => BuildingClass::Barn,
        _ if tags.is("aeroway", "hangar") => BuildingClass::Hangar,
        _ if tags.is("aeroway", "terminal") => BuildingClass::Commercial,
        _ if tags.is("amenity", "place_of_worship") => BuildingClass::Church,
        _ => BuildingClass::Other,
    };
    let roof_m = tags.get("roof:height").and_then(metres).unwrap_or(0.0);
    let stated = tags.get("height").and_then(metres).and_then(|height_m| sane(height_m - roof_m, 1.0, 900.0));
    let levels = tags.get("building:levels").and_then(number).and_then(|levels| sane(levels * 3.0 + 1.0, 1.0, 900.0));
    let (height_m, from) = match (stated, levels) {
        (Some(height_m), _) => (height_m, Origin::Stated),
        (None, Some(height_m)) => (height_m, Origin::Derived),
        (None, None) => (assumed_height_m(class, value), Origin::Assumed),
    };
    Ok(Meaning::Building(class, height_m, from))
}

fn assumed_height_m(class: BuildingClass, value: &str) -> f32 {
    match class {
        BuildingClass::Barn if matches!(value, "shed" | "garage" | "garages" | "carport") => 2.7,
        BuildingClass::House | BuildingClass::Other => 7.0,
        BuildingClass::Apartments => 13.0,
        BuildingClass::Commercial | BuildingClass::Hangar => 10.0,
        BuildingClass::Industrial => 8.0,
        BuildingClass::Church => 12.0,
        BuildingClass::Barn => 5.0,
    }
}

/// Areas of one cover.
fn areas(tags: &Tags, found: &mut Vec<(Kind, Result<Meaning, Skip>)>) {
    let (landuse, natural, leisure) = (
        |v: &[&str]| tags.is_any("landuse", v),
        |v: &[&str]| tags.is_any("natural", v),
        |v: &[&str]| tags.is_any("leisure", v),
    );
    if natural(&["water"]) || landuse(&["reservoir", "basin"]) {
        const RUNNING: [&str; 8] = ["river", "riverbank", "stream", "canal", "ditch", "drain", "rapids", "lock"];
        let still = !tags.is_any("water", &RUNNING) && !tags.is_any("waterway", &RUNNING);
        if tags.is_any("waterway", &["riverbank", "dock"]) {
            // One area, not two over each other.
            found.push((Kind::Lakes, Err("drawn as a waterway".into())));
        } else {
            found.push((Kind::Lakes, Ok(Meaning::Water { still })));
        }
    }
    let mut add = |kind, meaning| found.push((kind, Ok(meaning)));
    if landuse(&["forest"]) || natural(&["wood"]) {
        add(Kind::Forests, Meaning::Area(forest(tags)));
    }
    if landuse(&["farmland", "farm", "orchard", "vineyard", "plant_nursery", "allotments"]) {
        add(Kind::Fields, Meaning::Area(CoverClass::Field));
    }
    if landuse(&["meadow", "grass", "village_green", "recreation_ground", "cemetery"])
        || natural(&["grassland", "fell"])
        || leisure(&["park", "pitch", "golf_course", "garden", "common"])
    {
        add(Kind::Grass, Meaning::Area(CoverClass::Grass));
    }
    if natural(&["scrub", "heath"]) {
        add(Kind::Scrub, Meaning::Area(CoverClass::Scrub));
    }
    if landuse(&["residential", "commercial", "industrial", "retail", "construction", "farmyard", "garages"]) {
        add(Kind::BuiltUp, Meaning::Area(CoverClass::BuiltUp));
    }
    if natural(&["sand", "beach", "dune"]) {
        add(Kind::Sand, Meaning::Area(CoverClass::Sand));
    }
    if natural(&["bare_rock", "scree", "shingle"]) || landuse(&["quarry"]) {
        add(Kind::Rock, Meaning::Area(CoverClass::Rock));
    }
    if natural(&["glacier"]) {
        add(Kind::Snow, Meaning::Area(CoverClass::Snow));
    }
    if tags.is("amenity", "parking") && !tags.is_any("building", &["yes", "garage", "garages"]) {
        add(Kind::Paved, Meaning::Area(CoverClass::Paved));
    }
}

/// A wood by `leaf_type`, or by `wood` as it was before; mixed where neither says.
fn forest(tags: &Tags) -> CoverClass {
    match tags.get("leaf_type").or_else(|| tags.get("wood")) {
        Some("needleleaved" | "coniferous" | "evergreen") => CoverClass::Conifer,
        Some("broadleaved" | "deciduous") => CoverClass::Broadleaf,
        _ => CoverClass::MixedForest,
    }
}

/// What may be a point: masts, airfields and their parts. Default heights are assumed.
fn points(tags: &Tags, node: bool, found: &mut Vec<(Kind, Result<Meaning, Skip>)>) {
    let height_m = height_m(tags);
    if tags.is("power", "tower") {
        found.push((Kind::PowerTowers, Ok(Meaning::PowerTower(height_m.unwrap_or(30.0)))));
    }
    let mast = match (tags.get("man_made"), tags.get("power")) {
        (Some("mast" | "communications_tower"), _) => Some((MastClass::Mast, 40.0)),
        (Some("tower" | "water_tower"), _) if tags.is("tower:type", "communication") => Some((MastClass::Mast, 40.0)),
        (Some("tower" | "water_tower"), _) => Some((MastClass::Tower, 20.0)),
        (Some("chimney"), _) => Some((MastClass::Chimney, 40.0)),
        (_, Some("generator")) if tags.is("generator:source", "wind") || tags.is("power_source", "wind") => {
            Some((MastClass::WindTurbine, 90.0))
        }
        _ => None,
    };
    if let Some((class, default_m)) = mast {
        found.push((Kind::Masts, Ok(Meaning::Mast(class, height_m.unwrap_or(default_m)))));
    }
    match tags.get("aeroway") {
        Some("runway") if !node => found.push((Kind::Runways, Ok(Meaning::Runway(runway_surface(tags))))),
        Some("taxiway" | "taxilane") if !node => {
            // 15 m: ICAO Annex 14, code letter C.
            let (width_m, _) = width(tags, 15.0);
            found.push((Kind::Taxiways, Ok(Meaning::Taxiway(width_m))));
        }
        Some("apron") if !node => found.push((Kind::Aprons, Ok(Meaning::Apron))),
        Some("helipad") => found.push((Kind::Helipads, Ok(Meaning::Helipad))),
        Some("aerodrome") => found.push((Kind::Aerodromes, Ok(Meaning::Aerodrome))),
        _ => {}
    }
}

/// What a runway is made of; asphalt where the file does not say.
pub fn runway_surface(tags: &Tags) -> RunwaySurface {
    match tags.get("surface") {
        Some("concrete" | "concrete:plates") => RunwaySurface::Concrete,
        Some("grass" | "earth" | "ground" | "dirt") => RunwaySurface::Grass,
        Some("gravel" | "fine_gravel" | "unpaved" | "compacted" | "sand") => RunwaySurface::Gravel,
        _ => RunwaySurface::Asphalt,
    }
}

/// Whether a road of a class is sealed: by `surface`, else by `tracktype`, else tracks and paths are not.
pub fn is_paved(tags: &Tags, class: RoadClass) -> bool {
    match (tags.get("surface"), tags.get("tracktype")) {
        (Some(surface), _) => {
            ["paved", "asphalt", "concrete", "paving_stones", "sett", "cobblestone", "metal", "wood", "tarmac"]
                .iter()
                .any(|paved| surface.starts_with(paved))
        }
        (None, Some(grade)) => grade == "grade1",
        (None, None) => !matches!(class, RoadClass::Track | RoadClass::Path | RoadClass::Railway),
    }
}

/// `width`, else `lanes`, else a default.
fn width(tags: &Tags, default_m: f32) -> (f32, Origin) {
    let stated = tags.get("width").and_then(metres).and_then(|width_m| sane(width_m, 0.5, 200.0));
    let lanes = tags.get("lanes").and_then(number).and_then(|lanes| sane(lanes * LANE_M, LANE_M, 20.0 * LANE_M));
    match (stated, lanes) {
        (Some(width_m), _) => (width_m, Origin::Stated),
        (None, Some(width_m)) => (width_m, Origin::Derived),
        (None, None) => (default_m, Origin::Assumed),
    }
}

fn height_m(tags: &Tags) -> Option<f32> {
    tags.get("height").and_then(metres).and_then(|height_m| sane(height_m, 1.0, 900.0))
}

/// A measure that is within what such a thing can have.
fn sane(measure_m: f64, least_m: f64, most_m: f64) -> Option<f32> {
    (least_m..=most_m).contains(&measure_m).then_some(measure_m as f32)
}

/// A value if it is a known one: reasons are few, whatever a file invents.
fn known<'a>(value: &'a str, values: &[&'a str]) -> &'a str {
    values.iter().find(|known| **known == value).map_or("(another value)", |known| known)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tags(pairs: &[(&str, &str)]) -> Tags {
        let mut tags = Tags::default();
        pairs.iter().for_each(|(key, value)| tags.push(key, value));
        tags
    }

    fn only(pairs: &[(&str, &str)]) -> Result<Meaning, Skip> {
        let mut all = meanings(&tags(pairs), Element::Way);
        assert_eq!(all.len(), 1, "{pairs:?}: {all:?}");
        all.remove(0).1
    }

    #[test]
    fn widths_are_stated_derived_or_assumed() {
        let road = |more: &[(&str, &str)]| only(&[&[("highway", "primary")], more].concat()).unwrap();
        assert_eq!(road(&[]), Meaning::Road(RoadClass::Primary, 7.5, Origin::Assumed));
        assert_eq!(road(&[("lanes", "3")]), Meaning::Road(RoadClass::Primary, 9.75, Origin::Derived));
        assert_eq!(road(&[("lanes", "3"), ("width", "8 m")]), Meaning::Road(RoadClass::Primary, 8.0, Origin::Stated));
        assert_eq!(road(&[("width", "9999")]), Meaning::Road(RoadClass::Primary, 7.5, Origin::Assumed));
    }

    #[test]
    fn heights_are_stated_derived_or_assumed() {
        let house = |more: &[(&str, &str)]| only(&[&[("building", "house")], more].concat()).unwrap();
        assert_eq!(house(&[]), Meaning::Building(BuildingClass::House, 7.0, Origin::Assumed));
        assert_eq!(house(&[("building:levels", "3")]), Meaning::Building(BuildingClass::House, 10.0, Origin::Derived));
        let roofed = [("building:levels", "3"), ("height", "9 m"), ("roof:height", "2")];
        assert_eq!(house(&roofed), Meaning::Building(BuildingClass::House, 7.0, Origin::Stated));
        assert!(only(&[("building", "no")]).is_err());
    }

    #[test]
    fn areas_have_their_cover() {
        let forest = |pairs: &[(&str, &str)]| only(&[&[("natural", "wood")], pairs].concat()).unwrap();
        assert_eq!(forest(&[]), Meaning::Area(CoverClass::MixedForest));
        assert_eq!(forest(&[("leaf_type", "needleleaved")]), Meaning::Area(CoverClass::Conifer));
        assert_eq!(forest(&[("wood", "deciduous")]), Meaning::Area(CoverClass::Broadleaf));
        assert_eq!(only(&[("natural", "water")]), Ok(Meaning::Water { still: true }));
        assert_eq!(only(&[("natural", "water"), ("water", "river")]), Ok(Meaning::Water { still: false }));
        assert_eq!(meanings(&tags(&[("landuse", "forest"), ("highway", "track")]), Element::Way).len(), 2);
        for (value, still) in [("river", false), ("canal", false), ("dam", true)] {
            let both = meanings(&tags(&[("natural", "water"), ("waterway", value)]), Element::Way);
            assert_eq!(both[1], (Kind::Lakes, Ok(Meaning::Water { still })), "{value}");
        }
        // A bank is running water, once.
        let bank = meanings(&tags(&[("natural", "water"), ("waterway", "riverbank")]), Element::Way);
        assert_eq!(bank[0], (Kind::Waterways, Ok(Meaning::Water { still: false })));
        assert!(bank.len() == 2 && bank[1].1.is_err());
        assert!(meanings(&tags(&[("highway", "crossing")]), Element::Node).is_empty());
    }
}
