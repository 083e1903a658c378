//! Airfields: a table's points and elevations joined with what OpenStreetMap draws, and the rest assumed.
//!
//! A runway, taxiway or apron belongs to the nearest airfield within [`JOIN_M`] of it. An airfield without a drawn
//! runway gets those of its table or the default of its size ([`default_runway`]), centred on its point, along the
//! designators' heading or, without, where the ground departs least from its elevation. One without a drawn apron gets
//! one beside the first runway's middle and a taxiway to it. What is assumed is so marked. The ground must be within
//! [`MOST_APART_M`] of the stated elevation; [`super::flatten`] then sets it there.

use super::aeroways::{Aerodrome, Aeroways, DrawnRunway, merge_pieces};
use super::airfield_csv::{AirfieldRow, AirfieldSize, StatedRunway};
use super::flatten::flatten;
use super::kind::{Counts, Kind};
use super::place::to_world;
use crate::features::lakes::Lakes;
use crate::features::model::{Airfield, Origin, Runway, RunwaySurface};
use crate::ground::Area;
use crate::projection::{Geodetic, Projection};
use glam::DVec2;
use std::collections::HashMap;

/// How far from its airfield's point a runway may be.
const JOIN_M: f64 = 3_000.0;

/// Most that a stated elevation may be off the ground.
const MOST_APART_M: f64 = 150.0;

/// Farthest that a taxiway or an apron may reach from its airfield's point.
const REACH_M: f64 = 8_000.0;

/// Most airfields of a world: they are compared with each other and with all runways.
const MAX_AIRFIELDS: usize = 2_000;

/// Distance from a runway's middle to an assumed apron's near side: half the strip of a large runway (ICAO Annex 14,
/// 3.4.3: 140 m) and a little.
const APRON_OFF_M: f64 = 150.0;

/// Half of an assumed apron along and across the runway.
const APRON_HALF_M: [f64; 2] = [120.0, 50.0];

/// Width of an assumed taxiway: ICAO Annex 14, code letter C.
const TAXIWAY_M: f32 = 15.0;

/// What is known of the world when airfields are laid out.
pub struct Site<'a> {
    /// The map.
    pub projection: &'a Projection,
    /// The ground before any airfield.
    pub ground: &'a Area,
    /// The lakes in it.
    pub lakes: &'a Lakes,
}

/// An airfield in the making.
struct Candidate {
    kind: Kind,
    code: String,
    name: String,
    at: DVec2,
    elevation_m: Option<f64>,
    size: AirfieldSize,
    stated: Vec<StatedRunway>,
    drawn: Vec<DrawnRunway>,
    taxiways: Vec<(Vec<Vec<DVec2>>, f32)>,
    aprons: Vec<Vec<Vec<DVec2>>>,
}

/// All airfields of the world, set into the ground, and the books on all that belongs to them.
pub fn set_airfields(
    rows: &[AirfieldRow],
    mut drawn: Aeroways,
    site: &Site<'_>,
    heights_m: &mut [f32],
    counts: &mut Counts,
) -> Vec<Airfield> {
    let mut candidates = of_rows(rows, site, counts);
    of_aerodromes(&drawn.aerodromes, &mut candidates, counts);
    merge_pieces(&mut drawn.runways);
    for runway in drawn.runways {
        match nearest(&mut candidates, |at| segment_distance_m(at, runway.ends)) {
            Some(candidate) => candidate.drawn.push(runway),
            None => (0..runway.features).for_each(|_| counts.skip(Kind::Runways, ALONE)),
        }
    }
    for taxiway in drawn.taxiways {
        match nearest(&mut candidates, |at| least_m(at, &taxiway.0)) {
            Some(candidate) if !candidate.is_reached_by(&taxiway.0) => counts.skip(Kind::Taxiways, TOO_FAR),
            Some(candidate) => candidate.taxiways.push(taxiway),
            None => counts.skip(Kind::Taxiways, ALONE),
        }
    }
    for apron in drawn.aprons {
        match nearest(&mut candidates, |at| least_m(at, &apron)) {
            Some(candidate) if !candidate.is_reached_by(&apron) => counts.skip(Kind::Aprons, TOO_FAR),
            Some(candidate) => candidate.aprons.push(apron),
            None => counts.skip(Kind::Aprons, ALONE),
        }
    }
    let mut books = Vec::new();
    let mut airfields = Vec::new();
    for candidate in candidates {
        let drawn: usize = candidate.drawn.iter().map(|runway| runway.features).sum();
        let parts = [
            (Kind::Runways, drawn),
            (Kind::Taxiways, candidate.taxiways.len()),
            (Kind::Aprons, candidate.aprons.len()),
        ];
        let kind = candidate.kind;
        let made = lay_out(candidate, site).map(|airfield| {
            airfields.push(airfield);
            airfields.len() - 1
        });
        books.push((kind, parts, made));
    }
    let refused: HashMap<usize, &str> =
        flatten(&airfields, site.lakes, site.ground.grid(), heights_m).into_iter().collect();
    let mut airfields: Vec<Option<Airfield>> = airfields.into_iter().map(Some).collect();
    let mut kept = Vec::new();
    for (kind, parts, made) in books {
        let made = made.and_then(|number| match refused.get(&number) {
            Some(reason) => Err((*reason).to_owned()),
            None => airfields[number].take().ok_or_else(|| "laid out twice".to_owned()),
        });
        for (part, number) in parts {
            (0..number).for_each(|_| match &made {
                Ok(_) => counts.keep(part),
                Err(_) => counts.skip(part, "its airfield is left out"),
            });
        }
        match made {
            Ok(airfield) => {
                counts.keep(kind);
                let from = airfield.runways.first().map_or(Origin::Assumed, |runway| runway.from);
                counts.note(
                    kind,
                    match from {
                        Origin::Stated => "runways drawn",
                        Origin::Derived => "runways of the table",
                        Origin::Assumed => "runway assumed",
                    },
                );
                kept.push(airfield);
            }
            Err(reason) => counts.skip(kind, reason),
        }
    }
    kept
}

const ALONE: &str = "no airfield within 3 km";
const TOO_FAR: &str = "reaches more than 8 km from its airfield";
const TOO_MANY: &str = "more than 2,000 airfields";

impl Candidate {
    /// Whether all of some lines is as near as an airfield's parts are.
    fn is_reached_by(&self, lines: &[Vec<DVec2>]) -> bool {
        lines.iter().flatten().all(|at| at.distance(self.at) <= REACH_M)
    }
}

fn of_rows(rows: &[AirfieldRow], site: &Site<'_>, counts: &mut Counts) -> Vec<Candidate> {
    let grid = site.ground.grid();
    let mut candidates: Vec<Candidate> = Vec::new();
    for row in rows {
        let Some(lon_lat) = row.at else {
            counts.skip(Kind::Airfields, "no place: its latitude or longitude is none");
            continue;
        };
        let at = to_world(site.projection, lon_lat);
        let inside = |at: &DVec2| {
            (grid.west_m..=grid.east_m()).contains(&at.x) && (grid.north_m..=grid.south_m()).contains(&at.y)
        };
        let Some(at) = at.filter(inside) else {
            counts.skip(Kind::Airfields, "outside the world");
            continue;
        };
        if candidates.len() >= MAX_AIRFIELDS {
            counts.skip(Kind::Airfields, TOO_MANY);
            continue;
        }
        if candidates.iter().any(|other| other.at.distance(at) < 1.0) {
            counts.skip(Kind::Airfields, "at the place of another");
            continue;
        }
        candidates.push(Candidate {
            kind: Kind::Airfields,
            code: row.code.clone(),
            name: row.name.clone(),
            at,
            elevation_m: row.elevation_m,
            size: row.size,
            stated: row.runways.clone(),
            drawn: Vec::new(),
            taxiways: Vec::new(),
            aprons: Vec::new(),
        });
    }
    candidates
}

/// Airfields that only the map has.
fn of_aerodromes(aerodromes: &[Aerodrome], candidates: &mut Vec<Candidate>, counts: &mut Counts) {
    let table = candidates.len();
    for aerodrome in aerodromes {
        let same = |row: &Candidate| {
            row.at.distance(aerodrome.at) < JOIN_M || (!row.code.is_empty() && row.code == aerodrome.code)
        };
        if candidates[..table].iter().any(same) {
            counts.keep(Kind::Aerodromes);
            counts.note(Kind::Aerodromes, "in the table of airfields");
            continue;
        }
        if candidates.len() >= MAX_AIRFIELDS {
            counts.skip(Kind::Aerodromes, TOO_MANY);
            continue;
        }
        candidates.push(Candidate {
            kind: Kind::Aerodromes,
            code: aerodrome.code.clone(),
            name: aerodrome.name.clone(),
            at: aerodrome.at,
            elevation_m: aerodrome.elevation_m,
            size: AirfieldSize::None,
            stated: Vec::new(),
            drawn: Vec::new(),
            taxiways: Vec::new(),
            aprons: Vec::new(),
        });
    }
}

fn nearest(candidates: &mut [Candidate], distance_m: impl Fn(DVec2) -> f64) -> Option<&mut Candidate> {
    let with = candidates.iter_mut().map(|candidate| (distance_m(candidate.at), candidate));
    with.filter(|(distance_m, _)| *distance_m <= JOIN_M)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

fn lay_out(candidate: Candidate, site: &Site<'_>) -> Result<Airfield, String> {
    let Candidate { code, name, at, size, stated, drawn, taxiways, aprons, .. } = candidate;
    let ground_m = site.ground.height_m(at.x, at.y).ok_or("no ground there")?;
    let elevation_m = match candidate.elevation_m {
        Some(elevation_m) => elevation_m,
        None if candidate.kind == Kind::Airfields => return Err("no elevation".into()),
        None if drawn.is_empty() => return Err("no runway, and no table says more".into()),
        None => drawn_level_m(&drawn, site).unwrap_or(ground_m),
    };
    if (elevation_m - ground_m).abs() > MOST_APART_M {
        return Err(format!("its elevation is more than {MOST_APART_M} m off the ground"));
    }
    let level_m = f64::from(elevation_m as f32);
    let mut runways: Vec<Runway> = drawn.into_iter().map(|runway| of_drawn(runway, site.projection)).collect();
    if runways.is_empty() {
        let from = if stated.is_empty() { Origin::Assumed } else { Origin::Derived };
        let mut wanted = if stated.is_empty() { vec![default_runway(size).ok_or("no runway")?] } else { stated };
        // From the left to the right one, as each next is laid to the right.
        let side = |runway: &StatedRunway| "LCR".find(runway.designators[0].chars().last().unwrap_or(' '));
        wanted.sort_by_key(side);
        for (number, runway) in wanted.into_iter().enumerate() {
            // Several of a table lie side by side, 250 m apart.
            runways.push(assumed(&runway, at, 250.0 * number as f64, level_m, from, site));
        }
    }
    runways.sort_by(|a, b| b.ends[0].distance(b.ends[1]).total_cmp(&a.ends[0].distance(a.ends[1])));
    let mut aprons: Vec<Vec<DVec2>> = aprons.into_iter().flatten().collect();
    let mut taxiways: Vec<(Vec<DVec2>, f32)> =
        taxiways.into_iter().flat_map(|(lines, width_m)| lines.into_iter().map(move |line| (line, width_m))).collect();
    if aprons.is_empty() {
        let (apron, taxiway) = assumed_apron(&runways, level_m, site);
        aprons.push(apron);
        taxiways.push((taxiway, TAXIWAY_M));
    }
    Ok(Airfield { code, name, reference: at, level_m, runways, taxiways, aprons })
}

/// Mean of the ground along drawn runways.
fn drawn_level_m(drawn: &[DrawnRunway], site: &Site<'_>) -> Option<f64> {
    let along =
        drawn.iter().flat_map(|runway| (0..=16).map(|i| runway.ends[0].lerp(runway.ends[1], f64::from(i) / 16.0)));
    let (sum, number) = along
        .filter_map(|at| site.ground.height_m(at.x, at.y))
        .fold((0.0, 0.0), |(sum, number), height_m| (sum + height_m, number + 1.0));
    (number > 0.0).then(|| sum / number)
}

fn of_drawn(drawn: DrawnRunway, projection: &Projection) -> Runway {
    let heading_deg = true_heading_deg(drawn.ends, projection);
    // Widths by length where nothing says: ICAO Annex 14, 3.1.10, code numbers 4, 3 and 2, letter C and below.
    let by_length = if drawn.length_m() >= 1_800.0 {
        45.0
    } else if drawn.length_m() >= 800.0 {
        30.0
    } else {
        23.0
    };
    let mut ends = drawn.ends;
    let lit = drawn.lit.unwrap_or_else(|| assumed_lit(drawn.length_m(), drawn.surface));
    let designators = match drawn.designators {
        Some(designators) => {
            let off = |text: &str| heading_of(text).map_or(90.0, |named| angle_between_deg(named, heading_deg));
            if off(&designators[0]) > 90.0 {
                ends.reverse();
            }
            designators
        }
        None => designators_of(heading_deg),
    };
    Runway {
        ends,
        width_m: drawn.width_m.unwrap_or(by_length),
        designators,
        surface: drawn.surface,
        lit,
        from: Origin::Stated,
    }
}

/// What a runway is that nobody states, by the airfield's size: assumed, and told so.
fn default_runway(size: AirfieldSize) -> Option<StatedRunway> {
    let (length_m, width_m) = match size {
        AirfieldSize::Large => (3_000.0, 45.0),
        AirfieldSize::Medium => (2_400.0, 45.0),
        AirfieldSize::Small => (1_200.0, 30.0),
        AirfieldSize::None => return None,
    };
    let designators = [const { String::new() }; 2];
    Some(StatedRunway { designators, length_m, width_m, surface: RunwaySurface::Asphalt })
}

/// A runway about a point: along its designators, or where the ground departs least from the level.
fn assumed(stated: &StatedRunway, at: DVec2, aside_m: f64, level_m: f64, from: Origin, site: &Site<'_>) -> Runway {
    let half_m = 0.5 * stated.length_m;
    let convergence_rad = site.projection.grid_convergence_rad(site.projection.to_geodetic(at));
    let direction = match heading_of(&stated.designators[0]) {
        Some(named_deg) => direction_of(named_deg.to_radians() - convergence_rad),
        None => {
            // Every five degrees of half a circle; the first of equals.
            let all = (0..36).map(|i| direction_of(f64::from(i) * 5.0_f64.to_radians()));
            let worst =
                |direction: &DVec2| worst_m([at - *direction * half_m, at + *direction * half_m], level_m, site);
            all.min_by(|a, b| worst(a).total_cmp(&worst(b))).unwrap_or(DVec2::X)
        }
    };
    let middle = at + direction.perp() * aside_m;
    let ends = [middle - direction * half_m, middle + direction * half_m];
    let heading_deg = true_heading_deg(ends, site.projection);
    let named = stated.designators.iter().all(|one| !one.is_empty());
    let designators = if named { stated.designators.clone() } else { designators_of(heading_deg) };
    let lit = assumed_lit(stated.length_m, stated.surface);
    Runway { ends, width_m: stated.width_m as f32, designators, surface: stated.surface, lit, from }
}

/// Whether a runway has lights where nothing says: one for jets, paved and 2,000 m long or more, does.
fn assumed_lit(length_m: f64, surface: RunwaySurface) -> bool {
    length_m >= 2_000.0 && matches!(surface, RunwaySurface::Asphalt | RunwaySurface::Concrete)
}

/// Most that the ground along a line departs from a level; a lake or no ground counts as a kilometre for each place.
fn worst_m(ends: [DVec2; 2], level_m: f64, site: &Site<'_>) -> f64 {
    const PLACES: i32 = 24;
    let (mut worst_m, mut bad) = (0.0_f64, 0.0);
    for place in 0..=PLACES {
        let at = ends[0].lerp(ends[1], f64::from(place) / f64::from(PLACES));
        match site.ground.height_m(at.x, at.y) {
            Some(height_m) if site.lakes.lake_at(at).is_none() => worst_m = worst_m.max((height_m - level_m).abs()),
            _ => bad += 1_000.0,
        }
    }
    worst_m + bad
}

/// An apron beside the first runway's middle, on the better side, and the taxiway to it.
fn assumed_apron(runways: &[Runway], level_m: f64, site: &Site<'_>) -> (Vec<DVec2>, Vec<DVec2>) {
    let ends = runways.first().map_or([DVec2::ZERO, DVec2::X], |runway| runway.ends);
    let along = (ends[1] - ends[0]).try_normalize().unwrap_or(DVec2::X);
    let middle = 0.5 * (ends[0] + ends[1]);
    let off_m = APRON_OFF_M + APRON_HALF_M[1];
    let cost = |across: &DVec2| {
        let centre = middle + *across * off_m;
        let crowded = runways.iter().skip(1).any(|other| segment_distance_m(centre, other.ends) < off_m);
        worst_m([middle, centre + *across * APRON_HALF_M[1]], level_m, site) + if crowded { 1e6 } else { 0.0 }
    };
    let sides = [along.perp(), -along.perp()];
    let across = if cost(&sides[1]) < cost(&sides[0]) { sides[1] } else { sides[0] };
    let centre = middle + across * off_m;
    let corner = |u: f64, v: f64| centre + along * (u * APRON_HALF_M[0]) + across * (v * APRON_HALF_M[1]);
    (vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], vec![middle, centre])
}

/// Direction on the plane of a grid heading: clockwise from -z.
fn direction_of(grid_heading_rad: f64) -> DVec2 {
    DVec2::new(grid_heading_rad.sin(), -grid_heading_rad.cos())
}

/// True heading from the first end to the second, degrees, 0..360.
fn true_heading_deg(ends: [DVec2; 2], projection: &Projection) -> f64 {
    let towards = ends[1] - ends[0];
    let place: Geodetic = projection.to_geodetic(0.5 * (ends[0] + ends[1]));
    (towards.x.atan2(-towards.y) + projection.grid_convergence_rad(place)).to_degrees().rem_euclid(360.0)
}

/// Designators of a true heading; painted ones are magnetic, and not known here.
fn designators_of(heading_deg: f64) -> [String; 2] {
    let number = |heading_deg: f64| match (heading_deg / 10.0).round() as i32 % 36 {
        0 => "36".to_owned(),
        number => format!("{number:02}"),
    };
    [number(heading_deg), number((heading_deg + 180.0).rem_euclid(360.0))]
}

/// Heading that a designator names, degrees.
fn heading_of(designator: &str) -> Option<f64> {
    let digits = designator.trim_end_matches(['L', 'C', 'R', 'T']);
    digits.parse::<u32>().ok().filter(|number| (1..=36).contains(number)).map(|number| f64::from(number) * 10.0)
}

fn angle_between_deg(a: f64, b: f64) -> f64 {
    let apart = (a - b).rem_euclid(360.0);
    apart.min(360.0 - apart)
}

/// Distance from a point to a segment.
pub fn segment_distance_m(at: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let share = if along == DVec2::ZERO { 0.0 } else { ((at - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
    at.distance(a + along * share)
}

/// Distance from a point to the nearest of lines.
fn least_m(at: DVec2, lines: &[Vec<DVec2>]) -> f64 {
    lines.iter().map(|line| line_distance_m(at, line)).fold(f64::INFINITY, f64::min)
}

/// Distance from a point to a line of points.
pub fn line_distance_m(at: DVec2, line: &[DVec2]) -> f64 {
    line.windows(2).map(|ends| segment_distance_m(at, [ends[0], ends[1]])).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Field;
    use crate::grid::Grid;
    use crate::ground::Ground;
    use std::sync::Arc;

    fn row(code: &str, lon: f64, lat: f64, elevation_m: Option<f64>) -> AirfieldRow {
        AirfieldRow {
            code: code.into(),
            name: code.into(),
            at: Some(DVec2::new(lon, lat)),
            elevation_m,
            size: AirfieldSize::Small,
            runways: Vec::new(),
        }
    }

    #[test]
    fn runways_lie_along_the_flat_and_what_cannot_be_is_said() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        // A ridge from north to south: flat along z.
        let mut heights: Vec<f32> = (0..grid.posts()).map(|i| (i % grid.columns() as usize) as f32 * 20.0).collect();
        let ground = Ground::new(Arc::new(Field::new(grid, heights.clone()).unwrap())).whole();
        let projection = Projection::new(Geodetic::from_degrees(42.0, 78.0)).unwrap();
        let lakes = Lakes::default();
        let site = Site { projection: &projection, ground: &ground, lakes: &lakes };
        let rows = [
            row("GOOD", 78.0, 42.0, Some(600.0)),
            row("HIGH", 78.03, 42.0, Some(5_000.0)),
            row("NONE", 78.0, 42.03, None),
            row("AWAY", 10.0, 42.0, Some(600.0)),
        ];
        let mut counts = Counts::default();
        let airfields = set_airfields(&rows, Aeroways::default(), &site, &mut heights, &mut counts);
        assert_eq!(airfields.len(), 1);
        let runway = &airfields[0].runways[0];
        assert_eq!((runway.designators.clone(), runway.from), (["36".into(), "18".into()], Origin::Assumed));
        assert!((runway.ends[0].distance(runway.ends[1]) - 1_200.0).abs() < 1e-9 && runway.ends[1].y < 0.0);
        assert_eq!((airfields[0].aprons.len(), airfields[0].taxiways.len()), (1, 1));
        let counts = &counts.described()["airfields"];
        assert_eq!((counts.read, counts.kept, counts.skipped), (4, 1, 3));
        assert_eq!(counts.skipped_for.len(), 3);
    }

    #[test]
    fn the_first_end_is_that_of_the_first_designator() {
        let projection = Projection::new(Geodetic::from_degrees(42.0, 78.0)).unwrap();
        let east = [DVec2::new(-900.0, 0.0), DVec2::new(900.0, 0.0)];
        for (names, first) in [(["09", "27"], east[0]), (["27", "09"], east[1])] {
            let drawn = DrawnRunway {
                ends: east,
                width_m: None,
                designators: Some(names.map(str::to_owned)),
                surface: RunwaySurface::Asphalt,
                lit: None,
                features: 1,
            };
            // 1,800 m that say nothing of lights have none; 2,200 m have unless they say no, and grass has not.
            let long = DrawnRunway { ends: east.map(|end| end * (11.0 / 9.0)), ..drawn.clone() };
            let lit = |drawn: &DrawnRunway| of_drawn(drawn.clone(), &projection).lit;
            assert!(lit(&long) && !lit(&drawn) && lit(&DrawnRunway { lit: Some(true), ..drawn.clone() }));
            assert!(!lit(&DrawnRunway { lit: Some(false), ..long.clone() }));
            assert!(!lit(&DrawnRunway { surface: RunwaySurface::Grass, ..long }));
            let runway = of_drawn(drawn, &projection);
            assert_eq!((runway.ends[0], runway.width_m), (first, 45.0));
        }
        assert_eq!(designators_of(4.0), ["36", "18"]);
        assert_eq!(designators_of(236.0), ["24", "06"]);
    }
}
