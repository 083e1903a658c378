//! What every format is read into: tagged shapes in degrees, before anybody asks what they mean.
//!
//! A point is (longitude, latitude) in degrees on WGS84. Invariant: every point is finite, with |latitude| <= 90 and
//! |longitude| <= 360; a ring does not repeat its first point and has at least three, a line has at least two.

use super::kind::Kind;
use glam::DVec2;

/// Keys that any meaning is read from; all others are not kept.
const KEYS: [&str; 37] = [
    "aeroway",
    "amenity",
    "area",
    "bridge",
    "building",
    "building:levels",
    "ele",
    "fclass",
    "generator:source",
    "height",
    "highway",
    "icao",
    "landuse",
    "lanes",
    "leaf_type",
    "leisure",
    "level_m",
    "lit",
    "location",
    "man_made",
    "name",
    "natural",
    "power",
    "power_source",
    "railway",
    "ref",
    "roof:height",
    "surface",
    "tracktype",
    "tunnel",
    "type",
    "voltage",
    "water",
    "waterway",
    "width",
    "wood",
    "tower:type",
];

/// Keys that say which a thing is, or where, and not what.
const SAY_NOTHING: [&str; 8] = ["name", "level_m", "id", "fid", "osm_id", "objectid", "ogc_fid", "region"];

/// Longest value kept, bytes; a longer one is cut.
const MAX_VALUE_BYTES: usize = 255;

/// Keys and values, those of [`KEYS`] only.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tags(Vec<(&'static str, String)>);

/// What an element of OpenStreetMap is; files of other formats have a node for a point, else a way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Element {
    /// A point.
    Node,
    /// A line or an outline.
    Way,
    /// Several of them.
    Relation,
}

/// Rings of an area.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polygon {
    /// Outlines.
    pub outers: Vec<Vec<DVec2>>,
    /// Holes.
    pub inners: Vec<Vec<DVec2>>,
}

/// The shape of a feature.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A point.
    Point(DVec2),
    /// Lines; one whose first point is its last may be an outline.
    Lines(Vec<Vec<DVec2>>),
    /// An area.
    Polygon(Polygon),
    /// None, and why.
    Broken(&'static str),
}

/// What the area of a way is where a relation has a say in it.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum AreaOf {
    /// What its own line encloses.
    #[default]
    Itself,
    /// This: its outline with holes, or the whole that it is a part of.
    Whole(Polygon),
    /// Another way of the same outline carries the whole.
    Another,
    /// For these kinds, the relation that it outlines.
    Relation(Vec<Kind>),
}

/// A feature as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct RawFeature {
    /// Its tags.
    pub tags: Tags,
    /// What it is in its file.
    pub element: Element,
    /// Its shape.
    pub shape: Shape,
    /// Its area, if it has one.
    pub area: AreaOf,
    /// Its number in its file, if such numbers are the same in all files.
    pub id: Option<i64>,
    /// Whether nothing says what it is and its format is one for outlines of lakes too: then a polygon is one.
    pub lake_by_default: bool,
    /// What the books say of it if it is kept.
    pub note: Option<&'static str>,
}

impl Tags {
    /// Keeps a tag if it is one that is asked for; the first of a key counts.
    pub fn push(&mut self, key: &str, value: &str) {
        let Some(key) = KEYS.iter().find(|known| **known == key) else { return };
        if self.get(key).is_none() {
            let end = (0..=value.len().min(MAX_VALUE_BYTES)).rev().find(|at| value.is_char_boundary(*at)).unwrap_or(0);
            self.0.push((key, value[..end].to_owned()));
        }
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| *known == key).map(|(_, value)| value.as_str())
    }

    /// Bytes of all values.
    pub fn bytes(&self) -> usize {
        self.0.iter().map(|(_, value)| value.len()).sum()
    }

    /// Whether a key has that value.
    pub fn is(&self, key: &str, value: &str) -> bool {
        self.get(key) == Some(value)
    }

    /// Whether a key has one of those values.
    pub fn is_any(&self, key: &str, values: &[&str]) -> bool {
        self.get(key).is_some_and(|value| values.contains(&value))
    }

    /// Whether a key says yes: it is there and is not `no`, or `F` as Geofabrik has it.
    pub fn says(&self, key: &str) -> bool {
        self.get(key).is_some_and(|value| !matches!(value, "no" | "false" | "0" | "F"))
    }
}

impl RawFeature {
    /// A feature whose area, if any, is its own.
    pub fn new(tags: Tags, element: Element, shape: Shape) -> Self {
        Self { tags, element, shape, area: AreaOf::Itself, id: None, lake_by_default: false, note: None }
    }
}

impl Polygon {
    /// Points of all rings.
    pub fn points(&self) -> usize {
        self.outers.iter().chain(&self.inners).map(Vec::len).sum()
    }
}

/// Whether a key, in whatever case, may say what a thing is.
pub fn says_what(key: &str) -> bool {
    !SAY_NOTHING.iter().any(|nothing| key.eq_ignore_ascii_case(nothing))
}

/// Whether a point is a place on Earth.
pub fn is_place(lon_lat: DVec2) -> bool {
    lon_lat.y.abs() <= 90.0 && lon_lat.x.abs() <= 360.0
}

/// A closed line as a ring; `None` if it does not close or has fewer than three points.
pub fn ring_of(line: &[DVec2]) -> Option<Vec<DVec2>> {
    (line.len() >= 4 && line.first() == line.last()).then(|| line[..line.len() - 1].to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_tags_are_kept_and_cut_between_characters() {
        let mut tags = Tags::default();
        tags.push("highway", "track");
        tags.push("highway", "path");
        tags.push("source", "survey");
        tags.push("name", &"я".repeat(200));
        assert_eq!((tags.get("highway"), tags.get("source")), (Some("track"), None));
        assert_eq!(tags.get("name").map(str::len), Some(254));
        assert!(tags.says("highway") && !tags.says("tunnel"));
    }
}
