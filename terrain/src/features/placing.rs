//! Single things that no file names: what belongs to an airfield, and boats on water. Called at bake.
//!
//! Everything is a function of the features by integer hash, so a bake gives the same world on every machine. Nothing is
//! put on a runway's strip (ICAO Annex 14: 75 to 140 m to either side of an instrument runway's middle, 30 m of a small
//! one's), on a taxiway, in a building or in another thing.

use super::lakes::Lakes;
use super::model::{Airfield, Features, Placed, PlacedClass, Runway, RunwaySurface};
use super::shape::{self, Stand};
use super::solid::{hash_of, inside, pairs};
use crate::field::Field;
use glam::{DVec2, DVec3};

/// Buildings farther from an airfield's reference than this are not its own, metres.
const FIELD_REACH_M: f64 = 5_000.0;
/// Side of the squares of sea that may have a boat each, metres.
const SEA_SQUARE_M: f64 = 2_000.0;
/// Most boats of a lake, and of the sea.
const MOST_BOATS: usize = 24;
const MOST_AT_SEA: usize = 200;

/// The things of a world: for each airfield a tower, hangars, a terminal, fuel tanks, parked aircraft, trucks and a
/// windsock; a few boats and ships near the shores of large lakes and of the sea.
pub fn placed(features: &Features, lakes: &Lakes, field: &Field) -> Vec<Placed> {
    let mut all = Vec::new();
    for airfield in &features.airfields {
        on_airfield(airfield, features, &mut all);
    }
    on_lakes(lakes, &mut all);
    at_sea(field, lakes, &mut all);
    let void = |thing: &Placed| post_height_m(field, thing.at).is_none();
    all.retain(|thing| !void(thing));
    all
}

/// Height of the post nearest to a plan point; `None` over void and beyond the world.
fn post_height_m(field: &Field, at: DVec2) -> Option<f64> {
    let grid = field.grid();
    let column = ((at.x - grid.west_m) / grid.step_m).round() as i64;
    let row = ((at.y - grid.north_m) / grid.step_m).round() as i64;
    let height = field.post_m(column, row);
    (!height.is_nan()).then_some(f64::from(height))
}

/// Half the width of the strip that is kept clear along a runway.
fn strip_m(runway: &Runway) -> f64 {
    match runway.surface {
        RunwaySurface::Asphalt | RunwaySurface::Concrete => 75.0,
        RunwaySurface::Gravel | RunwaySurface::Grass => 40.0,
    }
}

fn to_line_m(line: &[DVec2], at: DVec2) -> f64 {
    let to_segment = |pair: &[DVec2]| {
        let way = pair[1] - pair[0];
        let part = ((at - pair[0]).dot(way) / way.length_squared().max(1e-9)).clamp(0.0, 1.0);
        at.distance(pair[0] + way * part)
    };
    line.windows(2).map(to_segment).fold(f64::INFINITY, f64::min)
}

/// Where things may stand on an airfield.
struct Site<'a> {
    airfield: &'a Airfield,
    /// Outlines of buildings near it.
    buildings: Vec<&'a [DVec2]>,
    taken: Vec<(DVec2, f64)>,
}

impl Site<'_> {
    /// Radius of a thing's plan.
    fn radius_m(class: PlacedClass) -> f64 {
        let around = shape::bounds(shape::placed(class));
        DVec2::new(around.high.x - around.low.x, around.high.z - around.low.z).length() * 0.5
    }

    fn is_free(&self, at: DVec2, radius_m: f64, by_strip: bool) -> bool {
        let strip = |runway: &Runway| if by_strip { 0.5 * f64::from(runway.width_m) + 12.0 } else { strip_m(runway) };
        let field = self.airfield;
        field.runways.iter().all(|runway| to_line_m(&runway.ends, at) > strip(runway) + radius_m)
            && field.taxiways.iter().all(|(way, width_m)| to_line_m(way, at) > 0.5 * f64::from(*width_m) + radius_m)
            && self.taken.iter().all(|(other, other_m)| other.distance(at) > other_m + radius_m + 2.0)
            && self.buildings.iter().all(|outline| {
                !inside(outline, at) && pairs(outline).all(|(a, b)| to_line_m(&[a, b], at) > radius_m + 3.0)
            })
    }

    /// Puts a thing at the first free of some places.
    fn put(
        &mut self,
        class: PlacedClass,
        places: impl IntoIterator<Item = DVec2>,
        heading_rad: f64,
        fits: impl Fn(DVec2) -> bool,
        all: &mut Vec<Placed>,
    ) -> bool {
        let radius_m = Self::radius_m(class);
        let by_strip = class == PlacedClass::Windsock;
        let Some(at) = places.into_iter().find(|at| fits(*at) && self.is_free(*at, radius_m, by_strip)) else {
            return false;
        };
        self.taken.push((at, radius_m));
        all.push(Placed { class, at: rounded(at), grid_heading_rad: heading_rad as f32 });
        true
    }
}

/// Whole centimetres: few digits, and the same after storing.
fn rounded(at: DVec2) -> DVec2 {
    (at * 100.0).round() / 100.0
}

fn heading_rad(way: DVec2) -> f64 {
    way.x.atan2(-way.y)
}

fn on_airfield(airfield: &Airfield, features: &Features, all: &mut Vec<Placed>) {
    let length_m = |runway: &Runway| runway.ends[0].distance(runway.ends[1]);
    let Some(main) = airfield.runways.iter().max_by(|a, b| length_m(a).total_cmp(&length_m(b))) else { return };
    let long_m = length_m(main);
    let middle = main.ends[0].midpoint(main.ends[1]);
    let Some(along) = (main.ends[1] - main.ends[0]).try_normalize() else { return };
    let paved = matches!(main.surface, RunwaySurface::Asphalt | RunwaySurface::Concrete);
    let hash = hash_of(middle);
    // The side of the aprons, else of the reference point, else any.
    let apron = airfield.aprons.iter().max_by(|a, b| extent_m(a).total_cmp(&extent_m(b)));
    let mean = |ring: &[DVec2]| ring.iter().sum::<DVec2>() / ring.len() as f64;
    let towards = apron.map_or(airfield.reference, |ring| mean(ring)) - middle;
    let mut out = along.perp();
    let side = if towards.dot(out).abs() > 40.0 { towards.dot(out) } else { f64::from(hash & 1) - 0.5 };
    if side < 0.0 {
        out = -out;
    }
    let (centre_m, near_m, far_m) = match apron {
        Some(ring) => {
            let away = |at: &DVec2| (*at - middle).dot(out);
            let low = ring.iter().map(away).fold(f64::INFINITY, f64::min);
            let high = ring.iter().map(away).fold(f64::NEG_INFINITY, f64::max);
            (towards.dot(along), low, high)
        }
        None => (0.0, strip_m(main) + 25.0, strip_m(main) + 85.0),
    };
    let near = |outline: &[DVec2]| outline.first().is_some_and(|at| at.distance(airfield.reference) < FIELD_REACH_M);
    let buildings: Vec<&[DVec2]> =
        features.buildings.iter().map(|building| building.outline.as_slice()).filter(|outline| near(outline)).collect();
    let mut site = Site { airfield, buildings, taken: Vec::new() };
    let place = |along_m: f64, out_m: f64| middle + along * (centre_m + along_m) + out * out_m;
    let facing = heading_rad(-out);
    let anywhere = |_: DVec2| true;
    // A row along the far side of the apron, looking at the runway; each slides away from the middle until it is free.
    let row = |from_m: f64, away_m: f64, by_m: f64| {
        let place = &place;
        (0..40).map(move |step| place(from_m + by_m * f64::from(step), far_m + away_m)).collect::<Vec<_>>()
    };
    if paved && long_m > 1_500.0 {
        site.put(PlacedClass::Terminal, row(0.0, 16.0, 8.0), facing, anywhere, all);
    }
    if paved || long_m > 900.0 {
        site.put(PlacedClass::ControlTower, row(46.0, 14.0, 8.0), facing, anywhere, all);
    }
    let hangars = (1.0 + long_m / 700.0).min(5.0) as u32;
    for _ in 0..hangars {
        site.put(PlacedClass::Hangar, row(-58.0, 18.0, -9.0), facing, anywhere, all);
    }
    if paved {
        for _ in 0..3 {
            site.put(PlacedClass::FuelTank, row(80.0, 30.0, 6.0), facing, anywhere, all);
        }
    }
    let on_apron = |at: DVec2| airfield.aprons.is_empty() || airfield.aprons.iter().any(|ring| inside(ring, at));
    let parked = if paved { 8 } else { 4 };
    for number in 0..parked {
        let jitter = f64::from(hash_of(place(f64::from(number), 0.0)) % 100) / 100.0;
        let depth_m = (far_m - near_m).clamp(20.0, 60.0);
        let places = (0..60).map(|step| {
            let along_m = 15.0 * f64::from(step / 2) * if step % 2 == 0 { 1.0 } else { -1.0 };
            place(along_m, far_m - 0.45 * depth_m)
        });
        site.put(PlacedClass::Aircraft, places.collect::<Vec<_>>(), facing + 0.12 * (jitter - 0.5), on_apron, all);
    }
    for number in 0..3_i32 {
        let jitter = f64::from(hash_of(place(0.0, f64::from(number))) % 628) / 100.0;
        site.put(PlacedClass::Truck, row(25.0 - 60.0 * f64::from(number), 4.0, 7.0), jitter, anywhere, all);
    }
    // Beside the first threshold, left of the strip's middle and clear of the runway itself.
    let beside_m = 0.5 * f64::from(main.width_m) + 30.0;
    let sock = (0..20).map(|step| main.ends[0] + along * (150.0 + 20.0 * f64::from(step)) + out * beside_m);
    let wind_rad = f64::from(hash % 628) / 100.0;
    site.put(PlacedClass::Windsock, sock.collect::<Vec<_>>(), wind_rad, anywhere, all);
}

fn extent_m(ring: &[DVec2]) -> f64 {
    let around = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = ring.iter().fold(around, |(low, high), at| (low.min(*at), high.max(*at)));
    (high - low).length()
}

fn on_lakes(lakes: &Lakes, all: &mut Vec<Placed>) {
    for lake in lakes.lakes() {
        let Some(ring) = lake.rings.first() else { continue };
        let around = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = ring.iter().fold(around, |(low, high), at| (low.min(*at), high.max(*at)));
        let size = high - low;
        let area_km2 = size.x * size.y * 1e-6;
        if area_km2 < 2.0 {
            continue;
        }
        let wanted = ((2.0 + area_km2.sqrt() * 0.4) as usize).min(MOST_BOATS);
        let mut afloat = 0;
        // Few points of a box are near a shore: looked at until there are enough, but not for ever.
        for number in 0..400_u32 {
            if afloat >= wanted {
                break;
            }
            let hash = hash_of(low + DVec2::splat(f64::from(number) * 17.0));
            let other = hash_of(high - DVec2::splat(f64::from(number) * 29.0));
            let at = low + size * DVec2::new(f64::from(hash & 0xffff), f64::from(other & 0xffff)) / 65_536.0;
            let from_shore_m = -lakes.signed_distance_m(at);
            let large = area_km2 > 600.0 && number % 6 == 0;
            let wanted_m = if large { 600.0..4_000.0 } else { 120.0..1_500.0 };
            if wanted_m.contains(&from_shore_m) {
                let class = if large { PlacedClass::Ship } else { PlacedClass::Boat };
                all.push(Placed { class, at: rounded(at), grid_heading_rad: (hash % 628) as f32 / 100.0 });
                afloat += 1;
            }
        }
    }
}

/// Boats where posts are at sea level all around and land is not far.
fn at_sea(field: &Field, lakes: &Lakes, all: &mut Vec<Placed>) {
    let grid = field.grid();
    let squares = |length_m: f64| (length_m / SEA_SQUARE_M).floor() as i32;
    let mut afloat = 0;
    for row in 0..squares(grid.south_m() - grid.north_m) {
        for column in 0..squares(grid.east_m() - grid.west_m) {
            let corner =
                DVec2::new(grid.west_m, grid.north_m) + DVec2::new(f64::from(column), f64::from(row)) * SEA_SQUARE_M;
            let hash = hash_of(corner);
            let at = corner + DVec2::new(f64::from(hash & 255), f64::from((hash >> 8) & 255)) * (SEA_SQUARE_M / 256.0);
            let ring = |radius_m: f64| {
                (0..8).map(move |turn| at + DVec2::from_angle(f64::from(turn) * std::f64::consts::FRAC_PI_4) * radius_m)
            };
            let level = |at: DVec2| post_height_m(field, at) == Some(0.0);
            let sea = level(at) && ring(2.0 * grid.step_m).all(level);
            if !sea || afloat >= MOST_AT_SEA || lakes.lake_at(at).is_some() {
                continue;
            }
            let shore = [600.0, 1_200.0, 2_000.0].iter().any(|radius_m| {
                ring(*radius_m).any(|at| post_height_m(field, at).is_some_and(|height_m| height_m > 2.0))
            });
            if shore && hash & 0x3_0000 != 0 {
                let class = if hash & 0x1c_0000 == 0 { PlacedClass::Ship } else { PlacedClass::Boat };
                all.push(Placed { class, at: rounded(at), grid_heading_rad: (hash % 628) as f32 / 100.0 });
                afloat += 1;
            }
        }
    }
}

/// The corners of a thing's plan, for those who look whether it covers something.
pub fn plan_corners(thing: &Placed) -> [DVec2; 4] {
    let around = shape::bounds(shape::placed(thing.class));
    let at_m = DVec3::new(thing.at.x, 0.0, thing.at.y);
    let stand = Stand { at_m, grid_heading_rad: f64::from(thing.grid_heading_rad) };
    [
        (around.low.x, around.low.z),
        (around.high.x, around.low.z),
        (around.high.x, around.high.z),
        (around.low.x, around.high.z),
    ]
    .map(|(x, z)| {
        let at = stand.world_m(DVec3::new(x, 0.0, z));
        DVec2::new(at.x, at.z)
    })
}

#[cfg(test)]
mod tests {
    use super::super::lakes::Lake;
    use super::super::model::Origin;
    use super::*;
    use crate::grid::Grid;
    use crate::synthetic;

    fn airfield(apron: bool, surface: RunwaySurface) -> Airfield {
        let turn = DVec2::from_angle(0.4);
        let at = |x: f64, z: f64| turn.rotate(DVec2::new(x, z)) + DVec2::new(500.0, -300.0);
        let aprons = if apron {
            vec![vec![at(100.0, 150.0), at(400.0, 150.0), at(400.0, 260.0), at(100.0, 260.0)]]
        } else {
            vec![]
        };
        Airfield {
            code: "XXXX".into(),
            name: "Test".into(),
            reference: at(0.0, 50.0),
            level_m: 500.0,
            runways: vec![Runway {
                ends: [at(-1_000.0, 0.0), at(1_000.0, 0.0)],
                width_m: 45.0,
                designators: ["09".into(), "27".into()],
                surface,
                lit: true,
                from: Origin::Stated,
            }],
            taxiways: vec![(vec![at(250.0, 0.0), at(250.0, 160.0)], 18.0)],
            aprons,
        }
    }

    #[test]
    fn airfields_get_their_things_and_runways_and_taxiways_stay_clear() {
        let field = synthetic::from_fn(Grid::centred(200.0, 2, 2).unwrap(), |_, _| 500.0);
        for apron in [true, false] {
            for surface in [RunwaySurface::Asphalt, RunwaySurface::Grass] {
                let features = Features { airfields: vec![airfield(apron, surface)], ..Features::default() };
                let things = placed(&features, &Lakes::default(), &field);
                assert_eq!(things, placed(&features, &Lakes::default(), &field));
                let count = |class| things.iter().filter(|thing| thing.class == class).count();
                assert_eq!((count(PlacedClass::ControlTower), count(PlacedClass::Windsock)), (1, 1));
                assert!(count(PlacedClass::Hangar) >= 2 && count(PlacedClass::Aircraft) >= 3, "{apron} {surface:?}");
                let field = &features.airfields[0];
                for thing in &things {
                    for corner in plan_corners(thing) {
                        let clear_m = if thing.class == PlacedClass::Windsock { 22.5 } else { 40.0 };
                        assert!(to_line_m(&field.runways[0].ends, corner) > clear_m, "{thing:?}");
                        assert!(to_line_m(&field.taxiways[0].0, corner) > 9.0, "{thing:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn boats_are_afloat_near_a_shore() {
        let field = synthetic::from_fn(Grid::centred(200.0, 2, 2).unwrap(), |_, _| 500.0);
        let ring = [(-4e3, -4e3), (4e3, -4e3), (4e3, 4e3), (-4e3, 4e3)].map(|(x, z)| DVec2::new(x, z)).to_vec();
        let lakes = Lakes::new(vec![Lake { name: "L".into(), level_m: 500.0, rings: vec![ring] }]);
        let things = placed(&Features::default(), &lakes, &field);
        assert!((2..=24).contains(&things.len()), "{}", things.len());
        assert!(things.iter().all(|thing| lakes.signed_distance_m(thing.at) < -100.0));
        // A sea of 0 m with land in the east.
        let sea =
            synthetic::from_fn(Grid::centred(200.0, 2, 2).unwrap(), |column, _| if column > 40 { 30.0 } else { 0.0 });
        let things = placed(&Features::default(), &Lakes::default(), &sea);
        assert!(!things.is_empty() && things.iter().all(|thing| post_height_m(&sea, thing.at) == Some(0.0)));
    }
}
