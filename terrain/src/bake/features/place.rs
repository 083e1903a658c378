//! Features laid on a world: projected, judged, made into what the world keeps, and counted.
//!
//! What lies outside the world's rectangle is left out; what crosses its edge is kept whole. Points that repeat the one
//! before are dropped first.

use super::aeroways::{Aerodrome, Aeroways, DrawnRunway, ends_of_ring};
use super::kind::{Counts, Kind};
use super::measure::metres;
use super::raw::{AreaOf, Element, Polygon, RawFeature, Shape, Tags, ring_of};
use super::tags::{Meaning, is_paved, meanings};
use super::waters::OpenWater;
use crate::block::overlay::ribbon::MOST_WIDTH_M;
use crate::features::cover::CoverClass;
use crate::features::model::{Building, Features, LandArea, Mast, MastClass, Origin, PowerLine, Road, Waterway};
use crate::grid::Grid;
use crate::projection::{Geodetic, Projection};
use glam::DVec2;
use std::collections::HashSet;

/// A thing with a point so far from the world's centre is left out: the map is not made for it.
const FAR_RAD: f64 = 0.5;

/// Smallest building, square metres.
const LEAST_BUILDING_M2: f64 = 1.0;

/// Most runways: they are compared with each other.
const MAX_RUNWAYS: usize = 10_000;

/// Most points of a building's outline and of a line or outline of an airfield: all are looked at for each place about
/// them. OpenStreetMap allows 2,000 to a way.
const MAX_POINTS: usize = 20_000;

const OUTSIDE: &str = "outside the world";

/// Features on a world's plane; waters and aeroways still wait for the ground.
#[derive(Debug, Clone, Default)]
pub struct Placed {
    /// What is finished.
    pub features: Features,
    /// Lakes, ponds, river areas.
    pub waters: Vec<OpenWater>,
    /// What is drawn of airfields; not in the books yet.
    pub aeroways: Aeroways,
    /// The books.
    pub counts: Counts,
}

/// When a feature is counted.
enum Book {
    Keep,
    Later,
}

struct Placer<'a> {
    projection: &'a Projection,
    grid: &'a Grid,
    placed: Placed,
    /// Where power lines have points, in 1e-7 degrees.
    power_points: HashSet<[i64; 2]>,
    towers: Vec<(DVec2, f32)>,
    /// Elements with a number that were met: files of neighbouring regions share what crosses the border.
    met: HashSet<(Element, i64)>,
}

/// Lays features on a world.
pub fn place(features: &[RawFeature], projection: &Projection, grid: &Grid) -> Placed {
    let (placed, power_points, towers, met) = Default::default();
    let mut placer = Placer { projection, grid, placed, power_points, towers, met };
    for feature in features {
        placer.take(feature);
    }
    placer.finish_towers();
    placer.placed
}

impl Placer<'_> {
    fn take(&mut self, feature: &RawFeature) {
        let mut all = meanings(&feature.tags, feature.element);
        if all.is_empty() {
            let (kind, meaning) = unnamed(feature);
            all.push((kind, meaning));
        }
        // A coastline may carry the sea of its whole file.
        let met = feature.id.is_some_and(|id| !self.met.insert((feature.element, id)));
        let again = met && !feature.tags.is("natural", "coastline");
        for (kind, meaning) in all {
            if again {
                self.placed.counts.skip(kind, "again in another file");
                continue;
            }
            match meaning.and_then(|meaning| self.make(feature, kind, &meaning)) {
                Ok(book) => {
                    if let Some(note) = feature.note {
                        self.placed.counts.note(kind, note);
                    }
                    if matches!(book, Book::Keep) {
                        self.placed.counts.keep(kind);
                    }
                }
                Err(reason) => self.placed.counts.skip(kind, reason),
            }
        }
    }

    fn make(&mut self, feature: &RawFeature, kind: Kind, meaning: &Meaning) -> Result<Book, String> {
        let tags = &feature.tags;
        match *meaning {
            Meaning::Road(class, width_m, from) => {
                if tags.is("area", "yes") || matches!(feature.shape, Shape::Polygon(_)) {
                    self.area(feature, kind, CoverClass::Paved)?;
                    self.placed.counts.note(kind, "kept as a paved area");
                    return Ok(Book::Keep);
                }
                let (tunnel, bridge) = (under(tags), tags.says("bridge"));
                let paved = is_paved(tags, class);
                let roads = self.lines(feature)?.into_iter();
                self.placed.features.roads.extend(roads.map(|line| Road {
                    class,
                    width_m,
                    paved,
                    tunnel,
                    bridge,
                    line,
                }));
                self.placed.counts.note(kind, format!("width {}", word(from)));
            }
            Meaning::Waterway(class, width_m, from) => {
                if matches!(feature.shape, Shape::Polygon(_)) {
                    self.water(feature, kind, false)?;
                    return Ok(Book::Keep);
                }
                let tunnel = under(tags);
                let lines = self.lines(feature)?.into_iter();
                self.placed.features.waterways.extend(lines.map(|line| Waterway { class, width_m, tunnel, line }));
                self.placed.counts.note(kind, format!("width {}", word(from)));
                if f64::from(width_m) > MOST_WIDTH_M {
                    self.placed.counts.note(kind, format!("drawn {MOST_WIDTH_M} m wide, the most of a line"));
                }
            }
            Meaning::Water { still } => self.water(feature, kind, still)?,
            Meaning::Area(cover) => self.area(feature, kind, cover)?,
            Meaning::Building(class, height_m, height_from) => {
                let polygon = self.polygon(feature, kind, 0.0)?;
                few_points(&polygon.outers)?;
                if !polygon.inners.is_empty() {
                    self.placed.counts.note(kind, "courtyard left out");
                }
                let outlines = polygon.outers.into_iter().map(counter_clockwise);
                let large: Vec<Vec<DVec2>> =
                    outlines.filter(|ring| signed_area_m2(ring).abs() >= LEAST_BUILDING_M2).collect();
                if large.is_empty() {
                    return Err("smaller than a square metre".into());
                }
                let buildings = large.into_iter().map(|outline| Building { class, outline, height_m, height_from });
                self.placed.features.buildings.extend(buildings);
                self.placed.counts.note(kind, format!("height {}", word(height_from)));
            }
            Meaning::PowerLine(height_m) => {
                if tags.is("location", "underground") || under(tags) {
                    return Err("underground".into());
                }
                let lines = self.lines(feature)?;
                if let Shape::Lines(raw) = &feature.shape {
                    self.power_points.extend(raw.iter().flatten().map(|at| units(*at)));
                }
                self.placed.features.power_lines.extend(lines.into_iter().map(|line| PowerLine { line, height_m }));
            }
            Meaning::PowerTower(height_m) => {
                // Judged when all lines are known.
                self.towers.push((self.middle_degrees(feature)?, height_m));
                return Ok(Book::Later);
            }
            Meaning::Mast(class, height_m) => {
                let at = self.point(feature)?;
                self.placed.features.masts.push(Mast { class, at, height_m });
            }
            Meaning::Runway(_) | Meaning::Taxiway(_) | Meaning::Apron | Meaning::Aerodrome => {
                self.aeroway(feature, kind, meaning)?;
                return Ok(Book::Later);
            }
            Meaning::Helipad => match feature.shape {
                Shape::Point(_) => {
                    // 20 m across, assumed.
                    let at = self.point(feature)?;
                    let ring =
                        (0..8).map(|i| at + 10.0 * DVec2::from_angle(f64::from(i) * std::f64::consts::FRAC_PI_4));
                    let rings = vec![ring.collect()];
                    self.placed.features.areas.push(LandArea { cover: CoverClass::Paved, rings });
                }
                _ => self.area(feature, kind, CoverClass::Paved)?,
            },
        }
        Ok(Book::Keep)
    }

    /// What belongs to an airfield: it is known later to which.
    fn aeroway(&mut self, feature: &RawFeature, kind: Kind, meaning: &Meaning) -> Result<(), String> {
        let tags = &feature.tags;
        match *meaning {
            Meaning::Runway(surface) => {
                let designators = tags.get("ref").and_then(|text| {
                    let (low, high) = text.split_once('/')?;
                    Some([low, high].map(|one| one.trim().chars().take(3).collect::<String>()))
                });
                let drawn = match feature.shape {
                    Shape::Polygon(_) => None,
                    _ => self.lines(feature)?.into_iter().next(),
                };
                let outline = match &drawn {
                    Some(line) if line.first() != line.last() => None,
                    _ => Some(self.polygon(feature, kind, 0.0)?.outers.remove(0)),
                };
                few_points(drawn.iter().chain(&outline))?;
                let (ends, drawn_m) = match (outline, drawn) {
                    (Some(outline), _) => ends_of_ring(&outline).map(|(ends, width_m)| (ends, Some(width_m as f32))),
                    (None, Some(line)) => line.first().zip(line.last()).map(|(a, b)| ([*a, *b], None)),
                    (None, None) => None,
                }
                .ok_or("an outline without a length")?;
                let stated = tags.get("width").and_then(metres).map(|width_m| width_m as f32);
                let sane = |width_m: &f32| (5.0..=200.0).contains(width_m);
                let width_m = stated.filter(sane).or(drawn_m.filter(sane));
                let lit = tags.get("lit").map(|_| tags.says("lit"));
                let runway = DrawnRunway { ends, width_m, designators, surface, lit, features: 1 };
                if !(50.0..=8_000.0).contains(&runway.length_m()) {
                    return Err("not 50 to 8,000 m long".into());
                }
                if self.placed.aeroways.runways.len() >= MAX_RUNWAYS {
                    return Err("more than 10,000 runways".into());
                }
                self.placed.aeroways.runways.push(runway);
            }
            Meaning::Taxiway(width_m) => {
                let lines = self.lines(feature)?;
                few_points(&lines)?;
                self.placed.aeroways.taxiways.push((lines, width_m));
            }
            Meaning::Apron => {
                let polygon = self.polygon(feature, kind, 0.0)?;
                few_points(&polygon.outers)?;
                self.placed.aeroways.aprons.push(polygon.outers);
            }
            _ => {
                let at = self.point(feature)?;
                let text = |key| tags.get(key).unwrap_or_default().to_owned();
                let (code, name) = (text("icao"), text("name"));
                let elevation_m = tags.get("ele").and_then(metres);
                self.placed.aeroways.aerodromes.push(Aerodrome { code, name, at, elevation_m });
            }
        }
        Ok(())
    }

    /// A tower that stands where a line has a point is drawn with the line; others stand alone.
    fn finish_towers(&mut self) {
        for (at, height_m) in std::mem::take(&mut self.towers) {
            let place = self.to_world(at).filter(|at| self.near(*at, *at, 0.0));
            match place {
                None => self.placed.counts.skip(Kind::PowerTowers, OUTSIDE),
                Some(_) if self.power_points.contains(&units(at)) => {
                    self.placed.counts.keep(Kind::PowerTowers);
                    self.placed.counts.note(Kind::PowerTowers, "drawn with its line");
                }
                Some(at) => {
                    self.placed.counts.keep(Kind::PowerTowers);
                    self.placed.features.masts.push(Mast { class: MastClass::Tower, at, height_m });
                }
            }
        }
    }

    fn area(&mut self, feature: &RawFeature, kind: Kind, cover: CoverClass) -> Result<(), String> {
        if feature.area == AreaOf::Another {
            self.placed.counts.note(kind, "part of an outline");
            return Ok(());
        }
        let polygon = self.polygon(feature, kind, 0.0)?;
        let rings = [polygon.outers, polygon.inners].concat();
        self.placed.features.areas.push(LandArea { cover, rings });
        Ok(())
    }

    fn water(&mut self, feature: &RawFeature, kind: Kind, still: bool) -> Result<(), String> {
        if feature.area == AreaOf::Another {
            self.placed.counts.note(kind, "part of an outline");
            return Ok(());
        }
        let reach_m = crate::features::lake_bake::TAPER_POSTS * self.grid.step_m;
        let polygon = self.polygon(feature, kind, reach_m)?;
        let level_m = match feature.tags.get("level_m").map(str::parse::<f64>) {
            Some(Ok(level_m)) if level_m.abs() <= f64::from(crate::field::MAX_HEIGHT_M) => Some(level_m),
            Some(_) => return Err("its level is no height".into()),
            None => None,
        };
        let name = feature.tags.get("name").unwrap_or_default();
        let name = if kind == Kind::Coastlines { "sea" } else { name }.to_owned();
        let rings = [polygon.outers, polygon.inners].concat();
        self.placed.waters.push(OpenWater { kind, name, level_m, still, rings });
        Ok(())
    }

    /// Its lines on the plane.
    fn lines(&self, feature: &RawFeature) -> Result<Vec<Vec<DVec2>>, String> {
        let lines = match &feature.shape {
            Shape::Lines(lines) => lines,
            Shape::Point(_) => return Err("a point, not a line".into()),
            Shape::Polygon(_) => return Err("an area, not a line".into()),
            Shape::Broken(reason) => return Err((*reason).into()),
        };
        let mut inside = Vec::new();
        let mut short = false;
        for line in lines {
            let Some(line) = self.all_to_world(line, 0.0) else { continue };
            if line.len() >= 2 {
                inside.push(line);
            } else {
                short = true;
            }
        }
        match (inside.is_empty(), short) {
            (false, _) => Ok(inside),
            (true, true) => Err("fewer than two points".into()),
            (true, false) => Err(OUTSIDE.into()),
        }
    }

    /// Its area on the plane.
    fn polygon(&self, feature: &RawFeature, kind: Kind, reach_m: f64) -> Result<Polygon, String> {
        let whole = match (&feature.area, &feature.shape) {
            (AreaOf::Relation(kinds), _) if kinds.contains(&kind) => {
                return Err("outline of a relation of its kind, which is read".into());
            }
            (AreaOf::Another, _) => return Err("part of another outline".into()),
            (AreaOf::Whole(polygon), _) | (_, Shape::Polygon(polygon)) => polygon.clone(),
            (_, Shape::Lines(lines)) => {
                let outers: Vec<Vec<DVec2>> = lines.iter().filter_map(|line| ring_of(line)).collect();
                if outers.is_empty() {
                    return Err("an outline that does not close".into());
                }
                Polygon { outers, inners: Vec::new() }
            }
            (_, Shape::Point(_)) => return Err("a point, not an area".into()),
            (_, Shape::Broken(reason)) => return Err((*reason).into()),
        };
        let rings = |rings: &[Vec<DVec2>]| -> Vec<Vec<DVec2>> {
            let all = rings.iter().filter_map(|ring| self.all_to_world(ring, reach_m));
            all.map(open_ring).filter(|ring| ring.len() >= 3).collect()
        };
        let outers = rings(&whole.outers);
        if outers.is_empty() {
            let near = whole.outers.iter().any(|ring| self.all_to_world(ring, reach_m).is_some());
            return Err(if near { "fewer than three points".into() } else { OUTSIDE.into() });
        }
        Ok(Polygon { outers, inners: rings(&whole.inners) })
    }

    fn point(&self, feature: &RawFeature) -> Result<DVec2, String> {
        let at = self.to_world(self.middle_degrees(feature)?);
        at.filter(|at| self.near(*at, *at, 0.0)).ok_or_else(|| OUTSIDE.into())
    }

    /// A point's place, or the middle of what it is drawn as.
    fn middle_degrees(&self, feature: &RawFeature) -> Result<DVec2, String> {
        let points: &[DVec2] = match &feature.shape {
            Shape::Point(at) => std::slice::from_ref(at),
            Shape::Lines(lines) => lines.first().map_or(&[], |line| line),
            Shape::Polygon(polygon) => polygon.outers.first().map_or(&[], |ring| ring),
            Shape::Broken(reason) => return Err((*reason).into()),
        };
        let low = points.iter().copied().reduce(DVec2::min).ok_or("no point")?;
        let high = points.iter().copied().reduce(DVec2::max).ok_or("no point")?;
        Ok(if low == high { low } else { 0.5 * (low + high) })
    }

    /// Points on the plane without repetitions; `None` if they do not come near the world.
    fn all_to_world(&self, line: &[DVec2], reach_m: f64) -> Option<Vec<DVec2>> {
        let mut points = line.iter().map(|at| self.to_world(*at)).collect::<Option<Vec<DVec2>>>()?;
        points.dedup();
        let low = points.iter().copied().reduce(DVec2::min)?;
        let high = points.iter().copied().reduce(DVec2::max)?;
        self.near(low, high, reach_m).then_some(points)
    }

    fn near(&self, low: DVec2, high: DVec2, reach_m: f64) -> bool {
        let grid = self.grid;
        low.x <= grid.east_m() + reach_m
            && high.x >= grid.west_m - reach_m
            && low.y <= grid.south_m() + reach_m
            && high.y >= grid.north_m - reach_m
    }

    fn to_world(&self, lon_lat: DVec2) -> Option<DVec2> {
        to_world(self.projection, lon_lat)
    }
}

/// A place on the plane; `None` if it is too far away for that.
pub fn to_world(projection: &Projection, lon_lat: DVec2) -> Option<DVec2> {
    let place = Geodetic::from_degrees(lon_lat.y, lon_lat.x);
    if angle_rad(place, projection.centre()) >= FAR_RAD {
        return None;
    }
    Some(projection.to_world(place)).filter(|at| at.is_finite())
}

/// What a feature is whose tags say nothing known.
fn unnamed(feature: &RawFeature) -> (Kind, Result<Meaning, String>) {
    if feature.lake_by_default {
        let meaning = match feature.shape {
            Shape::Polygon(_) => Ok(Meaning::Water { still: true }),
            Shape::Broken(reason) => Err(reason.into()),
            _ => Err("no polygon, and no tag that says what it is".into()),
        };
        return (Kind::Lakes, meaning);
    }
    let reason = if feature.element == Element::Relation {
        "a relation of no kind that is drawn"
    } else {
        "no kind that is drawn"
    };
    (Kind::Others, Err(reason.into()))
}

/// Refuses lines of more than [`MAX_POINTS`].
fn few_points<'a>(lines: impl IntoIterator<Item = &'a Vec<DVec2>>) -> Result<(), String> {
    if lines.into_iter().any(|line| line.len() > MAX_POINTS) { Err("more than 20,000 points".into()) } else { Ok(()) }
}

fn under(tags: &Tags) -> bool {
    tags.says("tunnel")
}

fn word(from: Origin) -> &'static str {
    match from {
        Origin::Stated => "stated",
        Origin::Derived => "derived",
        Origin::Assumed => "assumed",
    }
}

fn units(lon_lat: DVec2) -> [i64; 2] {
    (lon_lat * 1e7).round().to_array().map(|units| units as i64)
}

/// A ring without its first point repeated.
fn open_ring(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}

/// A ring counter-clockwise seen from above: x east, z south, so its signed area is negative.
fn counter_clockwise(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    if signed_area_m2(&ring) > 0.0 {
        ring.reverse();
    }
    ring
}

/// Area of a ring in x and z, positive if clockwise seen from above.
pub fn signed_area_m2(ring: &[DVec2]) -> f64 {
    let Some(&from) = ring.first() else { return 0.0 };
    0.5 * ring.windows(2).map(|ends| (ends[0] - from).perp_dot(ends[1] - from)).sum::<f64>()
}

/// Angle between two places seen from the centre of a sphere.
fn angle_rad(a: Geodetic, b: Geodetic) -> f64 {
    let half = |d: f64| (0.5 * d).sin().powi(2);
    let across = a.lat_rad.cos() * b.lat_rad.cos() * half(a.lon_rad - b.lon_rad);
    2.0 * (half(a.lat_rad - b.lat_rad) + across).min(1.0).sqrt().asin()
}

#[cfg(test)]
#[path = "place_tests.rs"]
mod tests;
