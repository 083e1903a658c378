//! OpenStreetMap's data as both its formats have it, and from that to shapes.
//!
//! Nodes are kept in units of 1e-7 degrees, 16 bytes each, and found by bisection. Numbers of things are bounded, so
//! that a file of a few bytes cannot ask for all memory. A way that lacks nodes (an extract cuts them off) is what is
//! left of it: a line for each run of two or more.

use super::kind::Kind;
use super::raw::{AreaOf, Element, Polygon, RawFeature, Shape, Tags, ring_of};
use super::relations;
use super::tags::meanings;
use crate::bake::raster::Unreadable;
use glam::DVec2;
use std::collections::HashMap;
use std::ops::Range;

/// Most nodes: half a gigabyte.
const MAX_NODES: usize = 1 << 25;
/// Most references from ways and relations: half a gigabyte.
const MAX_REFERENCES: usize = 1 << 26;
/// Most ways, relations and tagged nodes.
const MAX_ELEMENTS: usize = 1 << 22;

/// Most bytes of tags.
const MAX_TEXT: usize = 1 << 28;
/// Most points of all areas of relations: several may name the same way.
const MAX_AREA_POINTS: usize = 1 << 25;

/// A way: its nodes are a range of all references.
#[derive(Debug, Clone)]
pub struct Way {
    /// Its number.
    pub id: i64,
    /// Its tags.
    pub tags: Tags,
    /// Whether it has any tag, known or not.
    pub tagged: bool,
    nodes: Range<usize>,
}

/// A relation.
#[derive(Debug, Clone)]
pub struct Relation {
    /// Its tags.
    pub tags: Tags,
    /// Whether it has any tag but its type.
    pub tagged: bool,
    /// Its ways, each with whether it is a hole's outline.
    pub ways: Vec<(i64, bool)>,
}

/// A file's data.
#[derive(Debug, Clone, Default)]
pub struct OsmData {
    nodes: Vec<(i64, [i32; 2])>,
    points: Vec<(Tags, [i32; 2])>,
    ways: Vec<Way>,
    references: Vec<i64>,
    relations: Vec<Relation>,
    members: usize,
    text: usize,
}

impl OsmData {
    /// Adds a node, its place in units of 1e-7 degrees.
    ///
    /// # Errors
    /// There are too many, or it is no place on Earth.
    pub fn node(&mut self, id: i64, lon: i64, lat: i64, tags: Tags) -> Result<(), Unreadable> {
        if lat.abs() > 900_000_000 || lon.abs() > 1_800_000_000 {
            let found = format!("{} and {}", lon as f64 * 1e-7, lat as f64 * 1e-7);
            return Err(Unreadable::new("longitude and latitude in degrees", found));
        }
        let at = [lon as i32, lat as i32];
        self.nodes.push((id, at));
        if !meanings(&tags, Element::Node).is_empty() {
            self.text += tags.bytes();
            self.points.push((tags, at));
        }
        bounded(self.nodes.len(), MAX_NODES, "nodes")?;
        bounded(self.text, MAX_TEXT, "bytes of tags")?;
        bounded(self.points.len(), MAX_ELEMENTS, "tagged nodes")
    }

    /// Adds a way.
    ///
    /// # Errors
    /// There are too many.
    pub fn way(
        &mut self,
        id: i64,
        tags: Tags,
        tagged: bool,
        nodes: impl Iterator<Item = i64>,
    ) -> Result<(), Unreadable> {
        self.text += tags.bytes();
        bounded(self.text, MAX_TEXT, "bytes of tags")?;
        let first = self.references.len();
        self.references.extend(nodes.take(MAX_REFERENCES + 1));
        self.ways.push(Way { id, tags, tagged, nodes: first..self.references.len() });
        bounded(self.references.len(), MAX_REFERENCES, "points of ways")?;
        bounded(self.ways.len(), MAX_ELEMENTS, "ways")
    }

    /// Adds a relation.
    ///
    /// # Errors
    /// There are too many.
    pub fn relation(&mut self, relation: Relation) -> Result<(), Unreadable> {
        self.text += relation.tags.bytes();
        bounded(self.text, MAX_TEXT, "bytes of tags")?;
        self.members += relation.ways.len();
        self.relations.push(relation);
        bounded(self.members, MAX_REFERENCES, "members of relations")?;
        bounded(self.relations.len(), MAX_ELEMENTS, "relations")
    }

    /// All its features: tagged nodes that mean something, tagged ways, tagged relations.
    ///
    /// # Errors
    /// The areas of its relations have too many points.
    pub fn features(mut self) -> Result<Vec<RawFeature>, Unreadable> {
        // Stable, so the first of a number counts.
        self.nodes.sort_by_key(|(id, _)| *id);
        self.ways.sort_by_key(|way| way.id);
        self.ways.dedup_by_key(|way| way.id);
        let mut areas: HashMap<usize, AreaOf> = HashMap::new();
        let mut features: Vec<RawFeature> = self
            .points
            .iter()
            .map(|(tags, at)| RawFeature::new(tags.clone(), Element::Node, Shape::Point(degrees(*at))))
            .collect();
        let (mut whole, mut area_points) = (Vec::new(), 0);
        for relation in &self.relations {
            let polygon = relation.tags.is("type", "multipolygon").then(|| self.polygon(relation)).flatten();
            let kinds: Vec<Kind> =
                meanings(&relation.tags, Element::Relation).into_iter().map(|(kind, _)| kind).collect();
            area_points += polygon.as_ref().map_or(0, Polygon::points);
            bounded(area_points, MAX_AREA_POINTS, "points of areas")?;
            match &polygon {
                Some(polygon) if kinds.is_empty() => self.give_to_ways(relation, polygon, &mut areas),
                Some(_) => {
                    for at in self.outer_ways(relation) {
                        areas.entry(at).or_insert_with(|| AreaOf::Relation(kinds.clone()));
                    }
                }
                None => {}
            }
            if relation.tagged {
                let shape = match polygon {
                    Some(polygon) => Shape::Polygon(polygon),
                    None if relation.tags.is("type", "multipolygon") => {
                        Shape::Broken("no outline that closes in the file")
                    }
                    None => Shape::Broken("a relation that groups; its ways are read"),
                };
                whole.push(RawFeature::new(relation.tags.clone(), Element::Relation, shape));
            }
        }
        for (at, way) in self.ways.iter().enumerate().filter(|(_, way)| way.tagged) {
            let mut feature = RawFeature::new(way.tags.clone(), Element::Way, self.shape(way));
            feature.area = areas.remove(&at).unwrap_or_default();
            features.push(feature);
        }
        features.append(&mut whole);
        Ok(features)
    }

    /// Before 2016 a multipolygon's tags stood on its outer ways. One that closes gets the holes inside it; of several
    /// that make one outline the first gets all.
    fn give_to_ways(&self, relation: &Relation, polygon: &Polygon, areas: &mut HashMap<usize, AreaOf>) {
        let mut first = true;
        for at in self.outer_ways(relation) {
            let way = &self.ways[at];
            let area = match self.shape(way) {
                Shape::Lines(lines) if lines.len() == 1 && ring_of(&lines[0]).is_some() => {
                    let outer = lines[0][..lines[0].len() - 1].to_vec();
                    let inside = |hole: &&Vec<DVec2>| hole.first().is_some_and(|at| relations::holds(&outer, *at));
                    let inners = polygon.inners.iter().filter(inside).cloned().collect();
                    AreaOf::Whole(Polygon { outers: vec![outer], inners })
                }
                _ if meanings(&way.tags, Element::Way).is_empty() => continue,
                _ if std::mem::take(&mut first) => {
                    // Outlines that close by themselves are given above.
                    AreaOf::Whole(polygon.clone())
                }
                _ => AreaOf::Another,
            };
            areas.entry(at).or_insert(area);
        }
    }

    fn outer_ways<'a>(&'a self, relation: &'a Relation) -> impl Iterator<Item = usize> + 'a {
        relation.ways.iter().filter(|(_, inner)| !inner).filter_map(|(id, _)| self.find_way(*id))
    }

    fn find_way(&self, id: i64) -> Option<usize> {
        self.ways.binary_search_by_key(&id, |way| way.id).ok()
    }

    /// The rings of a multipolygon's ways; `None` if no outline closes.
    fn polygon(&self, relation: &Relation) -> Option<Polygon> {
        let rings = |inner: bool| {
            let ways = relation.ways.iter().filter(|(_, hole)| *hole == inner);
            let lines: Vec<&[i64]> = ways
                .filter_map(|(id, _)| Some(&self.references[self.ways[self.find_way(*id)?].nodes.clone()]))
                .collect();
            let closed = relations::rings(&lines);
            closed
                .iter()
                .filter_map(|ring| ring.iter().map(|node| self.place(*node)).collect::<Option<Vec<DVec2>>>())
                .filter(|ring| ring.len() >= 3)
                .collect::<Vec<_>>()
        };
        let outers = rings(false);
        (!outers.is_empty()).then(|| Polygon { outers, inners: rings(true) })
    }

    fn place(&self, node: i64) -> Option<DVec2> {
        let at = self.nodes.partition_point(|(id, _)| *id < node);
        self.nodes.get(at).filter(|(id, _)| *id == node).map(|(_, at)| degrees(*at))
    }

    fn shape(&self, way: &Way) -> Shape {
        let places = self.references[way.nodes.clone()].iter().map(|node| self.place(*node));
        let mut lines = vec![Vec::new()];
        for place in places {
            match (place, lines.last_mut()) {
                (Some(place), Some(line)) => line.push(place),
                _ => lines.push(Vec::new()),
            }
        }
        lines.retain(|line| line.len() >= 2);
        if lines.is_empty() {
            Shape::Broken("fewer than two of its points are in the file")
        } else {
            Shape::Lines(lines)
        }
    }
}

fn degrees([lon, lat]: [i32; 2]) -> DVec2 {
    // Divided, not multiplied by 1e-7: so it is the double nearest to the decimal that the file means.
    DVec2::new(f64::from(lon) / 1e7, f64::from(lat) / 1e7)
}

fn bounded(number: usize, most: usize, what: &str) -> Result<(), Unreadable> {
    if number > most { Err(Unreadable::new(format!("at most {most} {what}"), "more")) } else { Ok(()) }
}
