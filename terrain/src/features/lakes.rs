//! Lakes: outlines in the world's plane, each with one level.
//!
//! Frame: see [`crate::frame`]; rings are polygons in world x and z, metres, closed without repeating the first point;
//! a point is in the lake by the even-odd rule over all its rings, so an island is a ring too. Distances are exact to
//! the polygon's edges.
//!
//! How they come from a file into the ground is in [`super::lake_bake`].

use glam::DVec2;

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
        let mut near = LakesNear { low, high, reach_m, shore: Vec::new(), crossing: Vec::new(), seas: Vec::new() };
        let reach = DVec2::splat(reach_m);
        for (lake, &(lake_low, lake_high)) in self.lakes.iter().zip(&self.bounds_m) {
            if lake_low.cmple(high + reach).all() && lake_high.cmpge(low - reach).all() {
                near.take(lake);
                if lake.level_m == 0.0 {
                    near.seas.push((lake_low + SEA_RIM_M, lake_high - SEA_RIM_M));
                }
            }
        }
        near
    }
}

/// An edge of an outline.
type Edge = (DVec2, DVec2);

/// The edges of lakes that matter in one plan rectangle, sorted so that a point meets few of them.
#[derive(Debug, Clone, PartialEq)]
pub struct LakesNear {
    low: DVec2,
    high: DVec2,
    reach_m: f64,
    /// For each of [`BUCKETS`] squared parts of the rectangle, row by row, the edges within reach of it and the level of
    /// their lake; empty if there are none at all.
    shore: Vec<Vec<(Edge, f64)>>,
    /// For each lake its level and, for each of [`STRIPS`] parts from north to south, what a ray eastward may cross.
    crossing: Vec<(f64, Vec<Vec<Edge>>)>,
    /// Where a coastline says what is sea: the boxes of waters at 0 m, less [`SEA_RIM_M`].
    seas: Vec<(DVec2, DVec2)>,
}

/// A sea is closed along a box in degrees, which is turned a little in the world's plane, metres.
const SEA_RIM_M: f64 = 100.0;

const BUCKETS: usize = 16;
const STRIPS: usize = 64;

impl LakesNear {
    fn take(&mut self, lake: &Lake) {
        let reach = DVec2::splat(self.reach_m);
        let mut strips = Vec::new();
        for (a, b) in edges(&lake.rings) {
            let (low, high) = (a.min(b), a.max(b));
            if low.cmple(self.high + reach).all() && high.cmpge(self.low - reach).all() {
                self.shore.resize(BUCKETS * BUCKETS, Vec::new());
                let ((first, top), (last, bottom)) = (self.bucket(low - reach), self.bucket(high + reach));
                for row in top..=bottom {
                    for bucket in &mut self.shore[row * BUCKETS + first..=row * BUCKETS + last] {
                        bucket.push(((a, b), lake.level_m));
                    }
                }
            }
            if low.y <= self.high.y && high.y >= self.low.y && high.x >= self.low.x {
                strips.resize(STRIPS, Vec::new());
                for strip in &mut strips[self.strip(low.y)..=self.strip(high.y)] {
                    strip.push((a, b));
                }
            }
        }
        if !strips.is_empty() {
            self.crossing.push((lake.level_m, strips));
        }
    }

    /// The part that holds a point, column and row: never decreasing with either coordinate, so an edge whose box holds
    /// the point is in the point's part.
    fn bucket(&self, at: DVec2) -> (usize, usize) {
        (part(at.x, self.low.x, self.high.x, BUCKETS), part(at.y, self.low.y, self.high.y, BUCKETS))
    }

    fn strip(&self, z: f64) -> usize {
        part(z, self.low.y, self.high.y, STRIPS)
    }

    /// To which distances it answers, metres.
    pub fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// Whether no shore is within reach and the rectangle on no lake: every distance is then the reach.
    pub fn is_dry(&self) -> bool {
        self.shore.is_empty() && self.crossing.is_empty()
    }

    /// Whether a coastline says what is sea about a point.
    pub fn knows_the_sea(&self, at: DVec2) -> bool {
        self.seas.iter().any(|(low, high)| at.cmpge(*low).all() && at.cmple(*high).all())
    }

    /// Distance to the nearest shore within +-reach, metres, negative on a lake. Exact for points of the rectangle.
    pub fn signed_distance_m(&self, at: DVec2) -> f64 {
        let distance_m = self.shore_at(at).map_or(self.reach_m, |(distance_m, _)| distance_m);
        if self.level_at(at).is_some() { -distance_m } else { distance_m }
    }

    /// Distance to the nearest shore and the level of its lake, metres, if that is within reach of a point of the
    /// rectangle.
    pub fn shore_at(&self, at: DVec2) -> Option<(f64, f64)> {
        let (column, row) = self.bucket(at);
        let edges = self.shore.get(row * BUCKETS + column)?.iter();
        edges
            .map(|&(edge, level_m)| (edge_distance_m(edge, at), level_m))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(distance_m, _)| *distance_m <= self.reach_m)
    }

    /// Level of the lake that holds a point of the rectangle, metres.
    pub fn level_at(&self, at: DVec2) -> Option<f64> {
        let strip = self.strip(at.y);
        self.crossing.iter().find(|(_, strips)| inside(strips[strip].iter().copied(), at)).map(|(level_m, _)| *level_m)
    }
}

/// Which of `parts` equal parts of an interval holds a value; the outer ones also hold what lies beyond.
fn part(value: f64, low: f64, high: f64, parts: usize) -> usize {
    let share = (value - low) / (high - low).max(1e-9);
    // A cast saturates: what is below 0, and NaN, becomes 0.
    ((share * parts as f64) as usize).min(parts - 1)
}

pub(super) fn edges(rings: &[Vec<DVec2>]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    rings.iter().flat_map(|ring| ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)))
}

pub(super) fn bounds_m(rings: &[Vec<DVec2>]) -> (DVec2, DVec2) {
    rings.iter().flatten().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
}

/// Where a horizontal line crosses an edge; an edge owns its northern end only, so that corners count once.
pub(super) fn crossing_x((a, b): (DVec2, DVec2), z: f64) -> Option<f64> {
    ((a.y <= z) != (b.y <= z)).then(|| a.x + (b.x - a.x) * ((z - a.y) / (b.y - a.y)))
}

/// Even-odd rule: whether an odd number of edges lies east of the point.
pub(super) fn inside(edges: impl Iterator<Item = (DVec2, DVec2)>, at: DVec2) -> bool {
    edges.filter(|&edge| crossing_x(edge, at.y).is_some_and(|x| x > at.x)).count() % 2 == 1
}

fn edge_distance_m((a, b): (DVec2, DVec2), at: DVec2) -> f64 {
    let along = b - a;
    let length2 = along.length_squared();
    let t = if length2 > 0.0 { ((at - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (at - (a + t * along)).length()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    fn square(low: f64, high: f64) -> Vec<DVec2> {
        vec![DVec2::new(low, low), DVec2::new(high, low), DVec2::new(high, high), DVec2::new(low, high)]
    }

    /// A lake of 2 km with an island of 400 m, and a pond.
    pub fn lakes() -> Lakes {
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
    fn a_point_of_a_tile_meets_few_edges() {
        // A shore of 20,000 points, as a digitised lake has, around the world's middle.
        let shore = |i: i32| {
            let angle = f64::from(i) * std::f64::consts::TAU / 20_000.0;
            DVec2::from_angle(angle) * (50_000.0 + 3_000.0 * (37.0 * angle).sin())
        };
        let rings = vec![(0..20_000).map(shore).collect()];
        let lakes = Lakes::new(vec![Lake { name: String::new(), level_m: 0.0, rings }]);
        let near = |x: f64| lakes.near(DVec2::new(x, 0.0), DVec2::new(x + 6_000.0, 6_000.0), 400.0);
        let most = |lists: &[Vec<_>]| lists.iter().map(Vec::len).max();
        // Some 400 edges of 16 m lie in the first tile; a part and its reach are 1175 m wide.
        assert!(most(&near(47_000.0).shore).is_some_and(|edges| edges < 120));
        assert!(near(0.0).shore.is_empty() && near(0.0).level_at(DVec2::new(10.0, 10.0)) == Some(0.0));
        assert!(near(0.0).crossing[0].1.iter().all(|edges| edges.len() < 30));
        assert!(near(80_000.0).is_dry());
    }
}
