//! OpenStreetMap's data as both its formats have it, and from that to shapes.
//!
//! Nodes are kept in units of 1e-7 degrees, 16 bytes each, and found by bisection. Numbers of things are bounded, so
//! that a file of a few bytes cannot ask for all memory. A way that lacks nodes (an extract cuts them off) is what is
//! left of it: a line for each run of two or more. Of several elements with one number the first counts; the others are
//! features without a shape, so that the books have them.

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
/// Most points that areas of relations may be made of: many relations may name the same way, and many ways one relation's
/// holes.
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
    /// Its number.
    pub id: i64,
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
    points: Vec<(i64, Tags, [i32; 2])>,
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
            self.points.push((id, tags, at));
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
        self.points.sort_by_key(|(id, ..)| *id);
        self.ways.sort_by_key(|way| way.id);
        self.relations.sort_by_key(|relation| relation.id);
        let mut again: Vec<RawFeature> = Vec::new();
        let mut repeated =
            |tags: &Tags, element| again.push(RawFeature::new(tags.clone(), element, Shape::Broken(AGAIN)));
        self.points.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                repeated(&next.1, Element::Node);
            }
            same
        });
        self.ways.dedup_by(|next, kept| {
            let same = next.id == kept.id;
            if same && next.tagged {
                repeated(&next.tags, Element::Way);
            }
            same
        });
        self.relations.dedup_by(|next, kept| {
            let same = next.id == kept.id;
            if same && next.tagged {
                repeated(&next.tags, Element::Relation);
            }
            same
        });
        let mut areas: HashMap<usize, AreaOf> = HashMap::new();
        let numbered = |id: i64, mut feature: RawFeature| {
            feature.id = Some(id);
            feature
        };
        let mut features: Vec<RawFeature> = self
            .points
            .iter()
            .map(|(id, tags, at)| {
                numbered(*id, RawFeature::new(tags.clone(), Element::Node, Shape::Point(degrees(*at))))
            })
            .collect();
        let (mut whole, mut area_points) = (Vec::new(), 0);
        for relation in &self.relations {
            let multipolygon = relation.tags.is("type", "multipolygon");
            if multipolygon {
                let ways = relation.ways.iter().filter_map(|(id, _)| self.find_way(*id));
                area_points += ways.map(|at| self.ways[at].nodes.len()).sum::<usize>();
                bounded(area_points, MAX_AREA_POINTS, "points of areas")?;
            }
            let polygon = multipolygon.then(|| self.polygon(relation)).flatten();
            let kinds: Vec<Kind> =
                meanings(&relation.tags, Element::Relation).into_iter().map(|(kind, _)| kind).collect();
            match &polygon {
                Some(polygon) if kinds.is_empty() => {
                    self.give_to_ways(relation, polygon, &mut areas, &mut area_points)?;
                }
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
                    None if multipolygon => Shape::Broken("no outline that closes in the file"),
                    None => Shape::Broken("a relation that groups; its ways are read"),
                };
                whole.push(numbered(relation.id, RawFeature::new(relation.tags.clone(), Element::Relation, shape)));
            }
        }
        for (at, way) in self.ways.iter().enumerate().filter(|(_, way)| way.tagged) {
            let mut feature = numbered(way.id, RawFeature::new(way.tags.clone(), Element::Way, self.shape(way)));
            feature.area = areas.remove(&at).unwrap_or_default();
            features.push(feature);
        }
        features.append(&mut whole);
        features.append(&mut again);
        Ok(features)
    }

    /// Before 2016 a multipolygon's tags stood on its outer ways. One that closes gets the holes inside it; of several
    /// that make one outline the first gets all. `area_points` grows by what is looked at and by what is given.
    fn give_to_ways(
        &self,
        relation: &Relation,
        polygon: &Polygon,
        areas: &mut HashMap<usize, AreaOf>,
        area_points: &mut usize,
    ) -> Result<(), Unreadable> {
        let mut first = true;
        for at in self.outer_ways(relation) {
            let way = &self.ways[at];
            if meanings(&way.tags, Element::Way).is_empty() {
                continue;
            }
            *area_points += way.nodes.len() + polygon.inners.len();
            bounded(*area_points, MAX_AREA_POINTS, "points of areas")?;
            let area = match self.shape(way) {
                Shape::Lines(lines) if lines.len() == 1 && ring_of(&lines[0]).is_some() => {
                    let outer = lines[0][..lines[0].len() - 1].to_vec();
                    let inside = |hole: &&Vec<DVec2>| hole.first().is_some_and(|at| relations::holds(&outer, *at));
                    let inners: Vec<Vec<DVec2>> = polygon.inners.iter().filter(inside).cloned().collect();
                    *area_points += inners.iter().map(Vec::len).sum::<usize>();
                    AreaOf::Whole(Polygon { outers: vec![outer], inners })
                }
                _ if std::mem::take(&mut first) => {
                    // Outlines that close by themselves are given above.
                    *area_points += polygon.points();
                    AreaOf::Whole(polygon.clone())
                }
                _ => AreaOf::Another,
            };
            areas.entry(at).or_insert(area);
        }
        Ok(())
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

/// Why an element of a number that the file has had before has no shape.
const AGAIN: &str = "its number is there already";

fn degrees([lon, lat]: [i32; 2]) -> DVec2 {
    // Divided, not multiplied by 1e-7: so it is the double nearest to the decimal that the file means.
    DVec2::new(f64::from(lon) / 1e7, f64::from(lat) / 1e7)
}

fn bounded(number: usize, most: usize, what: &str) -> Result<(), Unreadable> {
    if number > most { Err(Unreadable::new(format!("at most {most} {what}"), "more")) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of a size in units of 1e-7 degrees about a point, as way `id` of nodes `4 id` to `4 id + 3`.
    fn square(data: &mut OsmData, id: i64, at: [i64; 2], half: i64, tags: Tags) {
        let corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
        for (number, [u, v]) in (4 * id..).zip(corners) {
            data.node(number, at[0] + u * half, at[1] + v * half, Tags::default()).unwrap();
        }
        let nodes = [0, 1, 2, 3, 0].map(|corner| 4 * id + corner);
        data.way(id, tags, true, nodes.into_iter()).unwrap();
    }

    fn wood() -> Tags {
        let mut tags = Tags::default();
        tags.push("natural", "wood");
        tags
    }

    /// A relation without tags of its own: outlines about each other, and holes in all of them.
    fn nested(number: i64, outline: Tags) -> OsmData {
        let mut data = OsmData::default();
        let mut ways = Vec::new();
        for id in 1..=number {
            square(&mut data, id, [0, 0], 10_000_000 + id, outline.clone());
            square(&mut data, number + id, [1_000 * id, 0], 10, Tags::default());
            ways.extend([(id, false), (number + id, true)]);
        }
        let mut tags = Tags::default();
        tags.push("type", "multipolygon");
        data.relation(Relation { id: 1, tags, tagged: false, ways }).unwrap();
        data
    }

    #[test]
    fn holes_of_every_outline_are_bounded() {
        let few = nested(30, wood()).features().unwrap();
        let with_all = |feature: &&RawFeature| matches!(&feature.area, AreaOf::Whole(all) if all.inners.len() == 30);
        assert_eq!(few.iter().filter(with_all).count(), 30);
        // 3,000 outlines of 3,000 holes each would be 36 million points, a gigabyte from a file of some 100 kB.
        let error = nested(3_000, wood()).features().unwrap_err().to_string();
        assert!(error.contains("points of areas"), "{error}");
        // Outlines that mean nothing are not given anything.
        assert!(nested(3_000, Tags::default()).features().is_ok());
        // Nor may one relation name the same way without end.
        let mut data = OsmData::default();
        square(&mut data, 1, [0, 0], 1_000, wood());
        let mut tags = wood();
        tags.push("type", "multipolygon");
        let ways = vec![(1, false); MAX_AREA_POINTS / 5 + 1];
        data.relation(Relation { id: 1, tags, tagged: true, ways }).unwrap();
        assert!(data.features().is_err());
    }

    #[test]
    fn what_is_in_a_file_twice_has_a_shape_once() {
        let mut data = OsmData::default();
        for id in [1, 1, 2] {
            square(&mut data, id, [0, 0], 1_000, wood());
        }
        let features = data.features().unwrap();
        let shapes = features.iter().filter(|feature| matches!(feature.shape, Shape::Lines(_))).count();
        assert_eq!((features.len(), shapes), (3, 2));
        assert_eq!(features[2].shape, Shape::Broken(AGAIN));
        assert_eq!((features[0].id, features[2].id), (Some(1), None));
    }
}
