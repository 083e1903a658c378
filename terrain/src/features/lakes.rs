//! Lakes: outlines in the world's plane, each with one level.
//!
//! Frame: see [`crate::frame`]; rings are polygons in world x and z, metres, closed without repeating the first point;
//! a point is in the lake by the even-odd rule over all its rings, so an island is a ring too. Distances are exact to
//! the polygon's edges.
//!
//! At bake a lake's posts are set to its level ([`burn`]): elevation rasters show noise on water. Between the outline
//! and [`TAPER_POSTS`] posts beyond it the ground is blended from the level to the raster in proportion to distance,
//! because the noise does not end at the outline either; it is the one place where the bake departs from its source.

use crate::grid::Grid;
use crate::projection::{Geodetic, Projection};
use geojson::{GeoJson, GeometryValue};
use glam::DVec2;
use rayon::prelude::*;
use std::fmt;

/// Width of the blended shore outside an outline, posts.
pub const TAPER_POSTS: f64 = 2.0;

/// Outlines and levels are whole millimetres: so few digits that text keeps them to the bit.
const PER_METRE: f64 = 1000.0;

/// Most points of all outlines of a file: a lake district at a metre.
const MAX_POINTS: usize = 4_000_000;

/// One lake.
#[derive(Debug, Clone, PartialEq)]
pub struct Lake {
    /// As a person would call it; may be empty.
    pub name: String,
    /// Height of the water, metres above mean sea level.
    pub level_m: f64,
    /// Outline and islands, world x and z in metres.
    pub rings: Vec<Vec<DVec2>>,
}

/// All lakes of a world, made ready to be asked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lakes {
    lakes: Vec<Lake>,
    /// Rectangle of each lake.
    bounds_m: Vec<(DVec2, DVec2)>,
}

/// An outline read from a file, before its level is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// As the file calls it; may be empty.
    pub name: String,
    /// The level if the file says it, metres.
    pub level_m: Option<f64>,
    /// World x and z in metres.
    pub rings: Vec<Vec<DVec2>>,
}

/// What a file has.
#[derive(Debug, Clone, PartialEq)]
pub struct OutlinesRead {
    /// Outlines that come near the grid.
    pub outlines: Vec<Outline>,
    /// Features in the file, those left out too.
    pub features: usize,
}

/// Why a file has no lakes.
#[derive(Debug, Clone, PartialEq)]
pub struct LakesError {
    /// What should have been there.
    pub expected: String,
    /// What was there.
    pub found: String,
}

impl fmt::Display for LakesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {}, found {}", self.expected, self.found)
    }
}

impl std::error::Error for LakesError {}

/// Reads lakes from GeoJSON: (multi)polygons with the optional properties `name` and `level_m`.
///
/// Features that are no polygons and outlines that come nowhere near the grid are left out.
///
/// # Errors
/// [`LakesError`] if it is not GeoJSON, a point is no place on Earth, or a level no height.
pub fn read_geojson(text: &str, projection: &Projection, grid: &Grid) -> Result<OutlinesRead, LakesError> {
    let wrong = |expected: &str, found: String| LakesError { expected: expected.into(), found };
    let features = match text.parse::<GeoJson>() {
        Ok(GeoJson::FeatureCollection(collection)) => collection.features,
        Ok(GeoJson::Feature(feature)) => vec![feature],
        Ok(GeoJson::Geometry(_)) => return Err(wrong("features", "a bare geometry".into())),
        Err(error) => return Err(wrong("GeoJSON", error.to_string())),
    };
    let mut points = 0;
    let count = features.len();
    let mut outlines = Vec::new();
    for feature in features {
        let property = |key| feature.properties.as_ref().and_then(|p| p.get(key));
        let name = property("name").and_then(|v| v.as_str()).unwrap_or_default().to_owned();
        let level_m = match property("level_m") {
            None => None,
            Some(value) => match value.as_f64().filter(|level| level.abs() <= f64::from(crate::field::MAX_HEIGHT_M)) {
                Some(level) => Some(level),
                None if value.is_null() => None,
                None => return Err(wrong("a height in level_m", value.to_string())),
            },
        };
        let polygons = match feature.geometry.map(|g| g.value) {
            Some(GeometryValue::Polygon { coordinates }) => vec![coordinates],
            Some(GeometryValue::MultiPolygon { coordinates }) => coordinates,
            _ => continue,
        };
        let mut rings = Vec::new();
        for ring in polygons.iter().flatten() {
            points += ring.len();
            if points > MAX_POINTS {
                return Err(wrong(&format!("at most {MAX_POINTS} points"), "more".into()));
            }
            let mut places = Vec::with_capacity(ring.len());
            for point in ring {
                let (lon, lat) = match point.as_slice() {
                    [lon, lat, ..] if lat.abs() <= 90.0 && lon.abs() <= 360.0 => (*lon, *lat),
                    other => return Err(wrong("longitude and latitude in degrees", format!("{other:?}"))),
                };
                let at = projection.to_world(Geodetic::from_degrees(lat, lon));
                places.push((at * PER_METRE).round() / PER_METRE);
            }
            if places.first() == places.last() {
                places.pop();
            }
            if places.len() >= 3 && places.iter().all(|p| p.is_finite()) {
                rings.push(places);
            }
        }
        let outline = Outline { name, level_m, rings };
        let (low, high) = bounds_m(&outline.rings);
        let reach = TAPER_POSTS * grid.step_m;
        let near = low.x <= grid.east_m() + reach && high.x >= grid.west_m - reach;
        if near && low.y <= grid.south_m() + reach && high.y >= grid.north_m - reach {
            outlines.push(outline);
        }
    }
    Ok(OutlinesRead { outlines, features: count })
}

impl Lakes {
    /// Lakes to be asked; rings of fewer than three points or with points that are not finite are left out.
    pub fn new(mut lakes: Vec<Lake>) -> Self {
        for lake in &mut lakes {
            lake.rings.retain(|ring| ring.len() >= 3 && ring.iter().all(|p| p.is_finite()));
        }
        lakes.retain(|lake| lake.level_m.is_finite() && !lake.rings.is_empty());
        let bounds_m = lakes.iter().map(|lake| bounds_m(&lake.rings)).collect();
        Self { lakes, bounds_m }
    }

    /// The lakes themselves.
    pub fn lakes(&self) -> &[Lake] {
        &self.lakes
    }

    /// The lake that holds a plan point.
    pub fn lake_at(&self, at: DVec2) -> Option<&Lake> {
        let held = |(lake, (low, high)): &(&Lake, &(DVec2, DVec2))| {
            at.cmpge(*low).all() && at.cmple(*high).all() && inside(edges(&lake.rings), at)
        };
        self.lakes.iter().zip(&self.bounds_m).find(held).map(|(lake, _)| lake)
    }

    /// Distance to the nearest shore, metres, negative on a lake; infinite without lakes, NaN where `at` is not finite.
    ///
    /// Looks at every edge of every lake that may be nearest; for many points near each other use [`Lakes::near`].
    pub fn signed_distance_m(&self, at: DVec2) -> f64 {
        if !at.is_finite() {
            return f64::NAN;
        }
        let mut nearest = f64::INFINITY;
        let mut held = false;
        for (lake, &(low, high)) in self.lakes.iter().zip(&self.bounds_m) {
            let to_box = at.clamp(low, high).distance(at);
            if to_box < nearest {
                held |= to_box == 0.0 && inside(edges(&lake.rings), at);
                nearest = edges(&lake.rings).map(|edge| edge_distance_m(edge, at)).fold(nearest, f64::min);
            } else if to_box == 0.0 {
                held |= inside(edges(&lake.rings), at);
            }
        }
        if held { -nearest } else { nearest }
    }

    /// What is needed to answer for points of a plan rectangle to distances of `reach_m`.
    pub fn near(&self, low: DVec2, high: DVec2, reach_m: f64) -> LakesNear {
        let reach = DVec2::splat(reach_m);
        let mut near = LakesNear { shore: Vec::new(), crossing: Vec::new(), reach_m };
        for (lake, &(lake_low, lake_high)) in self.lakes.iter().zip(&self.bounds_m) {
            if lake_low.cmpgt(high + reach).any() || lake_high.cmplt(low - reach).any() {
                continue;
            }
            let mut crossing = Vec::new();
            for (a, b) in edges(&lake.rings) {
                let (edge_low, edge_high) = (a.min(b), a.max(b));
                if edge_low.cmple(high + reach).all() && edge_high.cmpge(low - reach).all() {
                    near.shore.push((a, b));
                }
                // All that a ray eastward from a point of the rectangle may cross.
                if edge_low.y <= high.y && edge_high.y >= low.y && edge_high.x >= low.x {
                    crossing.push((a, b));
                }
            }
            if !crossing.is_empty() {
                near.crossing.push((lake.level_m, crossing));
            }
        }
        near
    }
}

/// The edges of lakes that matter in one plan rectangle.
#[derive(Debug, Clone, PartialEq)]
pub struct LakesNear {
    shore: Vec<(DVec2, DVec2)>,
    /// Each lake's level and the edges that decide what is inside it.
    crossing: Vec<(f64, Vec<(DVec2, DVec2)>)>,
    reach_m: f64,
}

impl LakesNear {
    /// Whether no shore is within reach and the rectangle on no lake: every distance is then the reach.
    pub fn is_dry(&self) -> bool {
        self.shore.is_empty() && self.crossing.is_empty()
    }

    /// Distance to the nearest shore within +-reach, metres, negative on a lake. Exact for points of the rectangle.
    pub fn signed_distance_m(&self, at: DVec2) -> f64 {
        let nearest = self.shore.iter().map(|&edge| edge_distance_m(edge, at)).fold(self.reach_m, f64::min);
        if self.level_at(at).is_some() { -nearest } else { nearest }
    }

    /// Level of the lake that holds a point of the rectangle, metres.
    pub fn level_at(&self, at: DVec2) -> Option<f64> {
        self.crossing.iter().find(|(_, edges)| inside(edges.iter().copied(), at)).map(|(level_m, _)| *level_m)
    }
}

/// The lake of an outline: its own level, or the median of the posts inside, or `None` if there are none.
pub fn with_level(outline: Outline, grid: &Grid, heights_m: &[f32]) -> Option<Lake> {
    let level_m = outline.level_m.or_else(|| {
        let mut found = Vec::new();
        for (row, mut columns) in rows_inside(&outline.rings, grid) {
            found
                .extend(columns.by_ref().map(|c| heights_m[row * grid.columns() as usize + c]).filter(|h| !h.is_nan()));
        }
        let middle = found.len() / 2;
        (!found.is_empty()).then(|| f64::from(*found.select_nth_unstable_by(middle, f32::total_cmp).1))
    })?;
    Some(Lake { name: outline.name, level_m: (level_m * PER_METRE).round() / PER_METRE, rings: outline.rings })
}

/// Sets the posts on lakes to their level and blends the shore; posts without data stay without. Returns how many
/// posts lie on each lake.
pub fn burn(lakes: &Lakes, grid: &Grid, heights_m: &mut [f32]) -> Vec<usize> {
    let columns = grid.columns() as usize;
    let reach_m = TAPER_POSTS * grid.step_m;
    heights_m.par_chunks_mut(columns).enumerate().for_each(|(row, heights)| {
        let z = grid.z_m(row as i64);
        // Pieces of a row, so that few edges are looked at for each post.
        for (piece, heights) in heights.chunks_mut(64).enumerate() {
            let x = |i: usize| grid.x_m((piece * 64 + i) as i64);
            let near = lakes.near(DVec2::new(x(0), z), DVec2::new(x(heights.len() - 1), z), reach_m);
            if near.is_dry() {
                continue;
            }
            for (i, height) in heights.iter_mut().enumerate().filter(|(_, h)| !h.is_nan()) {
                let at = DVec2::new(x(i), z);
                if let Some(level_m) = near.level_at(at) {
                    *height = level_m as f32;
                } else if let Some((lake, distance_m)) = nearest_lake(lakes, at, near.signed_distance_m(at), reach_m) {
                    let share = distance_m / reach_m;
                    *height = (lake.level_m + (f64::from(*height) - lake.level_m) * share) as f32;
                }
            }
        }
    });
    lakes.lakes.iter().map(|lake| rows_inside(&lake.rings, grid).map(|(_, columns)| columns.count()).sum()).collect()
}

/// The lake whose shore is at that distance, if it is within reach.
fn nearest_lake(lakes: &Lakes, at: DVec2, distance_m: f64, reach_m: f64) -> Option<(&Lake, f64)> {
    if distance_m >= reach_m {
        return None;
    }
    let close = |(lake, &(low, high)): (&'_ Lake, &(DVec2, DVec2))| {
        at.clamp(low, high).distance(at) <= distance_m
            && edges(&lake.rings).any(|edge| edge_distance_m(edge, at) <= distance_m)
    };
    let index = lakes.lakes.iter().zip(&lakes.bounds_m).position(close)?;
    Some((&lakes.lakes[index], distance_m))
}

/// Each row of posts that the rings touch, with the columns inside.
fn rows_inside<'a>(
    rings: &'a [Vec<DVec2>],
    grid: &'a Grid,
) -> impl Iterator<Item = (usize, Box<dyn Iterator<Item = usize> + 'a>)> + 'a {
    let (low, high) = bounds_m(rings);
    let row = |z: f64| ((z - grid.north_m) / grid.step_m).clamp(0.0, f64::from(grid.rows()));
    let rows = row(low.y).floor() as usize..(row(high.y).ceil() as usize + 1).min(grid.rows() as usize);
    rows.map(move |row| {
        let z = grid.z_m(row as i64);
        // Where the row crosses the rings, from west to east: inside between the odd and the even.
        let mut crossings: Vec<f64> = edges(rings).filter_map(|edge| crossing_x(edge, z)).collect();
        crossings.sort_by(f64::total_cmp);
        let column = |x: f64| ((x - grid.west_m) / grid.step_m).ceil().clamp(0.0, f64::from(grid.columns())) as usize;
        let runs: Vec<(usize, usize)> = crossings.chunks_exact(2).map(|c| (column(c[0]), column(c[1]))).collect();
        let columns: Box<dyn Iterator<Item = usize>> = Box::new(runs.into_iter().flat_map(|(from, to)| from..to));
        (row, columns)
    })
}

fn edges(rings: &[Vec<DVec2>]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    rings.iter().flat_map(|ring| ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)))
}

fn bounds_m(rings: &[Vec<DVec2>]) -> (DVec2, DVec2) {
    rings.iter().flatten().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
}

/// Where a horizontal line crosses an edge; an edge owns its northern end only, so that corners count once.
fn crossing_x((a, b): (DVec2, DVec2), z: f64) -> Option<f64> {
    ((a.y <= z) != (b.y <= z)).then(|| a.x + (b.x - a.x) * ((z - a.y) / (b.y - a.y)))
}

/// Even-odd rule: whether an odd number of edges lies east of the point.
fn inside(edges: impl Iterator<Item = (DVec2, DVec2)>, at: DVec2) -> bool {
    edges.filter(|&edge| crossing_x(edge, at.y).is_some_and(|x| x > at.x)).count() % 2 == 1
}

fn edge_distance_m((a, b): (DVec2, DVec2), at: DVec2) -> f64 {
    let along = b - a;
    let length2 = along.length_squared();
    let t = if length2 > 0.0 { ((at - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (at - (a + t * along)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: f64, high: f64) -> Vec<DVec2> {
        vec![DVec2::new(low, low), DVec2::new(high, low), DVec2::new(high, high), DVec2::new(low, high)]
    }

    /// A lake of 2 km with an island of 400 m, and a pond.
    fn lakes() -> Lakes {
        let pond = vec![DVec2::new(2_000.0, 0.0), DVec2::new(2_500.0, 100.0), DVec2::new(2_200.0, 700.0)];
        Lakes::new(vec![
            Lake { name: "lake".into(), level_m: 100.0, rings: vec![square(-1_000.0, 1_000.0), square(-200.0, 200.0)] },
            Lake { name: "pond".into(), level_m: 50.0, rings: vec![pond] },
        ])
    }

    #[test]
    fn distances_are_exact_and_negative_on_water() {
        let lakes = lakes();
        for (x, z, expected) in [
            (0.0, 0.0, 200.0),
            (-600.0, 0.0, -400.0),
            (-1_300.0, -1_400.0, 500.0),
            (0.0, 1_250.0, 250.0),
            (300.0, 10.0, -100.0),
        ] {
            assert_eq!(lakes.signed_distance_m(DVec2::new(x, z)), expected, "{x}, {z}");
        }
        assert_eq!(lakes.lake_at(DVec2::new(2_200.0, 300.0)).map(|l| l.level_m), Some(50.0));
        assert_eq!(lakes.lake_at(DVec2::ZERO), None);
        assert!(lakes.signed_distance_m(DVec2::NAN).is_nan());
        assert_eq!(Lakes::default().signed_distance_m(DVec2::ZERO), f64::INFINITY);
    }

    #[test]
    fn pruned_edges_give_the_same_answer() {
        let lakes = lakes();
        for (low, high) in [(-1_200.0, -900.0), (-700.0, -500.0), (-3_000.0, 3_000.0), (150.0, 2_300.0), (5e3, 6e3)] {
            let (low, high) = (DVec2::splat(low), DVec2::splat(high));
            let near = lakes.near(low, high, 400.0);
            for i in 0..400 {
                let t = DVec2::new(f64::from(i % 20), f64::from(i / 20)) / 19.0;
                let at = low + (high - low) * t;
                let expected = lakes.signed_distance_m(at).clamp(-400.0, 400.0);
                assert_eq!(near.signed_distance_m(at), expected, "{at}");
                assert_eq!(near.level_at(at), lakes.lake_at(at).map(|l| l.level_m), "{at}");
            }
        }
        assert!(lakes.near(DVec2::splat(5e3), DVec2::splat(6e3), 400.0).is_dry());
    }

    #[test]
    fn posts_on_a_lake_get_its_level_and_the_shore_is_blended() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let lakes = lakes();
        let mut heights = vec![300.0; grid.posts()];
        heights[0] = f32::NAN;
        let posts = burn(&lakes, &grid, &mut heights);
        let at = |x: f64, z: f64| {
            let (column, row) = ((x - grid.west_m) / grid.step_m, (z - grid.north_m) / grid.step_m);
            heights[row as usize * grid.columns() as usize + column as usize]
        };
        assert_eq!((at(-600.0, 0.0), at(-1_200.0, 0.0), at(-1_400.0, 0.0)), (100.0, 200.0, 300.0));
        assert!(heights[0].is_nan());
        // By the even-odd rule in the plain double loop.
        for (number, lake) in lakes.lakes().iter().enumerate() {
            let all = (0..grid.posts()).map(|i| (i % grid.columns() as usize, i / grid.columns() as usize));
            let slow =
                all.filter(|&(c, r)| inside(edges(&lake.rings), DVec2::new(grid.x_m(c as i64), grid.z_m(r as i64))));
            assert_eq!(slow.count(), posts[number]);
        }
    }

    #[test]
    fn geojson_gives_outlines_and_says_what_is_wrong() {
        let grid = Grid::centred(200.0, 4, 4).unwrap();
        let projection = Projection::new(Geodetic::from_degrees(42.0, 78.0)).unwrap();
        let polygon = |properties: &str, lon: &str| {
            format!(
                r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"Polygon","coordinates":
                [[[{lon},42.0],[78.05,42.0],[78.05,42.05],[{lon},42.0]]]}}}}"#
            )
        };
        let read = |text: &str| read_geojson(text, &projection, &grid).map(|read| read.outlines);
        let outlines = read(&polygon(r#"{"name":"A"}"#, "78.0")).unwrap();
        assert_eq!((outlines.len(), outlines[0].rings[0].len(), outlines[0].level_m), (1, 3, None));
        let heights: Vec<f32> = vec![7.0; grid.posts()];
        assert_eq!(with_level(outlines[0].clone(), &grid, &heights).unwrap().level_m, 7.0);
        assert_eq!(read(&polygon(r#"{"level_m":12.5}"#, "78.0")).unwrap()[0].level_m, Some(12.5));
        for bad in ["", "{}", "[1]", &polygon(r#"{"level_m":"x"}"#, "78.0"), &polygon("{}", "1e9")] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
