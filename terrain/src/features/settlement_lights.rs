//! The lamps of towns and villages: street lamps along the roads of built-up ground, and a lamp at some houses.
//!
//! Frame and standing: [`super::light_point`]. A road has lamps where the cover beside it is built up or a building is
//! near. Which house has a lamp, and a lamp's rank, are hashes of its place: the same in any order and on any machine.
//! Ranks are even in 0..1, so that the lamps of the lowest ranks stand for all of them from afar.

use super::airfield_lights::along;
use super::cover::{Cover, CoverClass};
use super::light_point::{COOL, LightPoint, SODIUM};
use super::model::{Features, RoadClass};
use glam::DVec2;
use std::collections::{HashMap, HashSet};

/// Most lamps of a world; what is beyond is left dark.
const MOST: usize = 2_000_000;
/// Side of the squares in which a building lights the roads, and those of the squares about it, metres.
const NEAR_BUILDING_M: f64 = 100.0;

/// A lamp, small: a world has hundreds of thousands.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lamp {
    at: DVec2,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Avenue,
    Street,
    House,
}

/// All lamps of a world by the square tiles that they stand in.
#[derive(Debug, Clone, Default)]
pub struct Lamps {
    tiles: HashMap<(i32, i32), Vec<Lamp>>,
}

impl Lamps {
    /// Places lamps; tiles have a side (metres) and count east and south from a corner.
    pub fn new(features: &Features, cover: &Cover, corner: DVec2, side_m: f64) -> Self {
        let square = |at: DVec2| ((at.x / NEAR_BUILDING_M).floor() as i32, (at.y / NEAR_BUILDING_M).floor() as i32);
        let houses = || features.buildings.iter().filter_map(|building| building.outline.first().copied());
        let squares: HashSet<(i32, i32)> = houses().map(square).collect();
        let by_building = |at: DVec2| {
            let (x, z) = square(at);
            (-1..=1).any(|east| (-1..=1).any(|south| squares.contains(&(x + east, z + south))))
        };
        let mut lamps = Self::default();
        let mut count = 0;
        let mut put = |at: DVec2, kind| {
            let tile = (at - corner) / side_m;
            if count < MOST && at.is_finite() {
                count += 1;
                let tile = (tile.x.floor() as i32, tile.y.floor() as i32);
                lamps.tiles.entry(tile).or_default().push(Lamp { at, kind });
            }
        };
        for road in features.roads.iter().filter(|road| !road.tunnel) {
            let Some((kind, spacing_m)) = lit(road.class) else { continue };
            let mut side = 1.0;
            along(&road.line, spacing_m, |at, ahead| {
                let right = DVec2::new(-ahead.y, ahead.x);
                side = -side;
                // The road itself may be a cover of its own.
                let built = [-40.0, 0.0, 40.0].iter().any(|&out_m| {
                    let beside = at + right * out_m;
                    cover.class_at(beside.x, beside.y) == CoverClass::BuiltUp
                });
                if built || by_building(at) {
                    put(at + right * (side * (0.5 * f64::from(road.width_m) + 1.0)), kind);
                }
            });
        }
        for at in houses() {
            if hash(at).is_multiple_of(3) {
                put(at, Kind::House);
            }
        }
        lamps
    }

    /// Whether there is none at all.
    pub fn is_empty(&self) -> bool {
        self.tiles.is_empty()
    }

    /// The lights of a tile with their ranks in 0..1, lowest rank first.
    pub fn tile(&self, x: i32, z: i32) -> Vec<(LightPoint, f32)> {
        let lamps = self.tiles.get(&(x, z)).map_or(&[][..], Vec::as_slice);
        let mut lights: Vec<_> = lamps.iter().map(|lamp| (light(lamp), rank(lamp.at))).collect();
        lights.sort_by(|a, b| a.1.total_cmp(&b.1));
        lights
    }
}

/// Which roads have lamps, and how far apart, metres.
fn lit(class: RoadClass) -> Option<(Kind, f64)> {
    match class {
        RoadClass::Motorway | RoadClass::Trunk | RoadClass::Primary | RoadClass::Secondary => {
            Some((Kind::Avenue, 35.0))
        }
        RoadClass::Tertiary | RoadClass::Residential => Some((Kind::Street, 50.0)),
        RoadClass::Service => Some((Kind::Street, 90.0)),
        RoadClass::Track | RoadClass::Path | RoadClass::Railway => None,
    }
}

fn light(lamp: &Lamp) -> LightPoint {
    // One street in four, by the square kilometre that it lies in, has newer lamps.
    let district = DVec2::new((lamp.at.x / 1_000.0).floor(), (lamp.at.y / 1_000.0).floor());
    let street = if hash(district).is_multiple_of(4) { COOL } else { SODIUM };
    let (above_m, colour, intensity_cd) = match lamp.kind {
        Kind::Avenue => (10.0, street, 500.0),
        Kind::Street => (7.0, street, 200.0),
        Kind::House => (3.5, [1.0, 0.72, 0.40], 30.0),
    };
    // No two lamps are equally old or clean.
    let share = 0.6 + 0.8 * rank(lamp.at + DVec2::splat(0.37));
    LightPoint::even(lamp.at, above_m, colour, intensity_cd * share)
}

fn rank(at: DVec2) -> f32 {
    (hash(at) >> 40) as f32 / (1_u64 << 24) as f32
}

/// Of a place to the centimetre. Mixing: D. Stafford's variant 13, as in SplitMix64.
fn hash(at: DVec2) -> u64 {
    let [x, z] = [at.x, at.y].map(|m| (m * 100.0).round() as i64 as u64);
    let mut bits = x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ z.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::model::{Building, BuildingClass, Origin, Road};
    use crate::grid::Grid;

    fn village() -> Features {
        let road = |class, z: f64| Road {
            class,
            width_m: 6.0,
            paved: true,
            tunnel: false,
            bridge: false,
            line: vec![DVec2::new(-2_000.0, z), DVec2::new(2_000.0, z)],
        };
        let building = |x: f64| Building {
            class: BuildingClass::House,
            outline: vec![DVec2::new(x, 20.0), DVec2::new(x + 9.0, 20.0), DVec2::new(x, 30.0)],
            height_m: 5.0,
            height_from: Origin::Assumed,
        };
        Features {
            roads: vec![road(RoadClass::Residential, 0.0), road(RoadClass::Path, 5.0), road(RoadClass::Trunk, 900.0)],
            buildings: (0..20).map(|at| building(f64::from(at) * 30.0)).collect(),
            ..Features::default()
        }
    }

    #[test]
    fn lamps_stand_along_built_up_roads_only_and_in_their_tiles() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let features = village();
        let corner = DVec2::new(grid.west_m, grid.north_m);
        let lamps = Lamps::new(&features, &Cover::unknown(&grid), corner, 1_500.0);
        let mut all = Vec::new();
        for (&(x, z), tile) in &lamps.tiles {
            for (light, rank) in lamps.tile(x, z) {
                let low = corner + DVec2::new(f64::from(x), f64::from(z)) * 1_500.0;
                assert!(light.at.cmpge(low).all() && light.at.cmplt(low + 1_500.0).all());
                assert!((0.0..1.0).contains(&rank));
                all.push(light);
            }
            assert_eq!(tile.len(), lamps.tile(x, z).len());
        }
        // The houses reach from 0 to 570 m: squares from -100 to 700 m, a lamp every 50 m; the empty trunk road is dark.
        let street = all.iter().filter(|light| light.above_m == 7.0).count();
        assert_eq!(street, 16);
        assert!(all.iter().all(|light| light.at.y < 100.0));
        let houses = all.len() - street;
        assert!((1..20).contains(&houses), "{houses}");
    }

    #[test]
    fn the_order_of_the_file_does_not_show() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let (features, mut turned) = (village(), village());
        turned.roads.reverse();
        turned.buildings.reverse();
        let corner = DVec2::new(grid.west_m, grid.north_m);
        let tile = |features| Lamps::new(features, &Cover::unknown(&grid), corner, 3_000.0).tile(2, 2);
        assert!(!tile(&features).is_empty());
        assert_eq!(tile(&features), tile(&turned));
    }
}
