//! Features of real files: counted against another program, laid on real ground, airfields as planes.
//!
//! The counts in `data/osm_counts.csv` come from pyosmium by `data/count_osm.py`, which says what is counted.

use glam::DVec2;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use terrain::Ground;
use terrain::bake::{BakeRequest, Bytes, Input, bake, default_request};
use terrain::features::cover::CoverClass;
use terrain::features::model::{Airfield, Origin};
use terrain::store::{FeatureCount, World};

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/terrain").join(file)
}

/// Bakes real files, or says why not.
fn real(sources: &[&str], features: Vec<Input>, step_m: f64) -> Option<World> {
    let missing = sources.iter().map(|file| data(file)).chain(features.iter().filter_map(|input| match input {
        Input::File(path) => Some(path.clone()),
        Input::Embedded(_) => None,
    }));
    if let Some(missing) = missing.into_iter().find(|path| !path.exists()) {
        println!("skipped: {} is not there", missing.display());
        return None;
    }
    let sources = sources.iter().map(|file| (Input::File(data(file)), 1.0)).collect();
    let request = BakeRequest {
        name: "test".into(),
        sources,
        features,
        imagery: Vec::new(),
        step_m,
        centre: None,
        size_km: None,
    };
    let started = Instant::now();
    let world = bake(&request, &mut |_, _| ()).unwrap_or_else(|e| panic!("{e}"));
    println!("baked in {:.2} s", started.elapsed().as_secs_f64());
    check(&world);
    Some(world)
}

fn file(name: &str) -> Input {
    Input::File(data(name))
}

/// What holds of every world.
fn check(world: &World) {
    assert!(world.features.is_sound());
    for (kind, count) in &world.info.features {
        println!("{kind}: {count:?}");
        assert_eq!(count.read, count.kept + count.skipped, "{kind}");
        assert_eq!(count.skipped, count.skipped_for.values().sum::<usize>(), "{kind}");
    }
    let ground = Ground::new(world.field.clone()).whole();
    for airfield in &world.features.airfields {
        let at = airfield.reference;
        // The level is an f32, and so is every post: the ground is it to the bit but for the interpolation's rounding.
        let level = |at: DVec2| (ground.height_m(at.x, at.y).unwrap() - airfield.level_m).abs() < 1e-3;
        assert!(level(at), "{}", airfield.name);
        assert!(!airfield.runways.is_empty() && !airfield.aprons.is_empty() && !airfield.taxiways.is_empty());
        for surface in surfaces(airfield) {
            assert!(surface.into_iter().all(level), "{}", airfield.name);
        }
    }
}

/// Points of an airfield's surfaces, their edges too.
fn surfaces(airfield: &Airfield) -> Vec<Vec<DVec2>> {
    let band = |line: &[DVec2], width_m: f32| {
        let mut points = Vec::new();
        for ends in line.windows(2) {
            let across = (ends[1] - ends[0]).normalize_or_zero().perp() * 0.5 * f64::from(width_m);
            for i in 0..=500 {
                let at = ends[0].lerp(ends[1], f64::from(i) / 500.0);
                points.extend([at - across, at, at + across]);
            }
        }
        points
    };
    let mut all: Vec<Vec<DVec2>> = airfield.runways.iter().map(|runway| band(&runway.ends, runway.width_m)).collect();
    all.extend(airfield.taxiways.iter().map(|(line, width_m)| band(line, *width_m)));
    all.extend(airfield.aprons.iter().map(|ring| band(ring, 0.0)));
    all
}

#[test]
fn counts_are_those_of_another_program() {
    let mut counted: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
    for line in include_str!("data/osm_counts.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number: usize = fields[2..].iter().map(|field| field.parse::<usize>().unwrap()).sum();
        counted.entry(fields[0]).or_default().insert(fields[1], number);
    }
    assert_eq!(counted.len(), 4);
    for (name, kinds) in counted {
        // Anywhere: what is read does not depend on the world.
        let Some(world) = real(&["tests/dem/srtm/N43E007.hgt.zip"], vec![file(&format!("tests/osm/{name}"))], 400.0)
        else {
            return;
        };
        for kind in ["highways", "waterways", "buildings", "forests", "railways", "lakes"] {
            let read = world.info.features.get(kind).map_or(0, |count| count.read);
            // Riverbanks and docks are counted as waterways here and there.
            assert_eq!(read, kinds.get(kind).copied().unwrap_or(0), "{name} {kind}");
        }
    }
}

fn count<'a>(world: &'a World, kind: &str) -> &'a FeatureCount {
    &world.info.features[kind]
}

#[test]
fn andorra_has_its_roads_rivers_and_airfields() {
    let features = vec![file("tests/osm/andorra-20130528.osm.pbf"), file("tests/gis/airportsdata_airports.csv.gz")];
    let Some(world) = real(&["tests/dem/srtm3_pyrenees/N42E001.hgt.zip"], features, 100.0) else { return };
    assert!(count(&world, "highways").kept >= 1_600 && world.features.roads.len() >= 1_600);
    // Mappers draw downstream, so few may be turned.
    assert!(count(&world, "waterways").notes["turned downstream"] <= count(&world, "waterways").kept / 10);
    let ground = Ground::new(world.field.clone()).whole();
    let at = |p: DVec2| ground.height_m(p.x, p.y).unwrap_or(f64::NAN);
    let falls = |line: &[DVec2]| at(line[0]) - at(line[line.len() - 1]);
    // None may still rise by more than the noise, 10 m, as a straight line through heights at 24 equal distances does.
    for water in &world.features.waterways {
        let length_m: f64 = water.line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
        let place = |share: f64| {
            let mut rest_m = share * length_m;
            for ends in water.line.windows(2) {
                let part_m = ends[0].distance(ends[1]);
                if rest_m <= part_m {
                    return ends[0].lerp(ends[1], rest_m / part_m);
                }
                rest_m -= part_m;
            }
            water.line[water.line.len() - 1]
        };
        let known =
            (0..24).map(|i| f64::from(i) / 23.0).map(|share| (share, at(place(share)))).filter(|k| k.1.is_finite());
        let known: Vec<(f64, f64)> = known.collect();
        let mean = |of: fn(&(f64, f64)) -> f64| known.iter().map(of).sum::<f64>() / known.len() as f64;
        let (share, height_m) = (mean(|k| k.0), mean(|k| k.1));
        let (covariance, variance) = known
            .iter()
            .fold((0.0, 0.0), |(c, v), k| (c + (k.0 - share) * (k.1 - height_m), v + (k.0 - share).powi(2)));
        // A millimetre for places that two sums of lengths put at two sides of a joint.
        assert!(known.len() < 3 || covariance / variance <= 10.001, "{:?}", water.line[0]);
    }
    let mean =
        world.features.waterways.iter().map(|w| falls(&w.line)).sum::<f64>() / world.features.waterways.len() as f64;
    assert!(mean > 50.0, "{mean}");
    let woods = world.features.areas.iter().filter(|area| area.cover.is_forest()).count();
    assert!(woods >= 50, "{woods}");
    // La Seu d'Urgell and La Cerdanya, at their elevations in feet.
    let levels: Vec<f64> = world.features.airfields.iter().map(|airfield| airfield.level_m).collect();
    for feet in [2_625.0, 3_586.0] {
        assert!(levels.iter().any(|level| (level - feet * 0.3048_f64).abs() < 1e-3), "{levels:?}");
    }
    // Written and read, it is the same.
    let folder = std::env::temp_dir().join(format!("poligon-features-{}.world", std::process::id()));
    world.write(&folder).unwrap();
    let again = World::read(&folder).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(again.features == world.features && again.info.features == world.info.features);
}

#[test]
fn bayreuth_and_monaco_have_their_houses_and_ponds() {
    let tiles = ["tests/dem/srtm/N49E011.hgt.zip", "tests/dem/srtm/N50E011.hgt.zip"];
    let table = || file("tests/gis/airportsdata_airports.csv.gz");
    if let Some(world) = real(&tiles, vec![file("tests/osm/north-bayreuth.osm.gz"), table()], 200.0) {
        assert!(world.features.buildings.len() >= 4_200);
        // One pond there is wider than a post step; no other shapes the ground.
        let names: Vec<&str> = world.lakes.lakes().iter().map(|lake| lake.name.as_str()).collect();
        assert_eq!(names, ["Harsdorfer Weiher"]);
        assert!(world.features.areas.iter().filter(|area| area.cover == CoverClass::Water).count() >= 140);
        assert!(world.features.airfields.len() >= 15);
    }
    if let Some(world) =
        real(&["tests/dem/srtm/N43E007.hgt.zip"], vec![file("tests/osm/monaco.osm.gz"), table()], 100.0)
    {
        assert!(world.features.buildings.len() >= 950);
        let stated = world.features.buildings.iter().filter(|b| b.height_from != Origin::Assumed).count();
        println!("{stated} of {} buildings have levels or a height", world.features.buildings.len());
    }
}

#[test]
fn a_shapefile_of_lakes_is_read() {
    let Some(world) =
        real(&["committable/dem/gebco2023_15s_tianshan_400km.tif"], vec![file("tests/gis/ne_10m_lakes.shp")], 400.0)
    else {
        return;
    };
    // Natural Earth's 1,354 lakes of version 5; Issyk-Kul is one, at about 1,607 m.
    let lakes = count(&world, "lakes");
    assert!(lakes.read > 1_300 && lakes.kept >= 1 && lakes.skipped_for["outside the world"] > 1_300);
    assert!(world.lakes.lakes().iter().any(|lake| (1_600.0..1_615.0).contains(&lake.level_m)));
}

#[test]
fn the_default_world_has_airfields_on_planes() {
    let world = bake(&default_request(), &mut |_, _| ()).unwrap();
    check(&world);
    let airfields = count(&world, "airfields");
    assert_eq!((airfields.read, airfields.kept), (9, 8));
    let almaty = world.features.airfields.iter().find(|airfield| airfield.code == "UAAA").unwrap();
    assert_eq!(almaty.runways.len(), 2);
    assert!((almaty.level_m - 2_238.0 * 0.3048).abs() < 1e-3);
    // The right one of two lies to the right of the left one.
    let [left, right] = ["05L", "05R"].map(|name| almaty.runways.iter().find(|r| r.designators[0] == name).unwrap());
    assert!((left.ends[1] - left.ends[0]).perp_dot(right.ends[0] - left.ends[0]) > 0.0);
    // The tapers add no slope above 1:8 but where mountains stand nearer than the widest taper: below one edge in a
    // hundred.
    let mut bare = default_request();
    bare.features.truncate(1);
    let bare = bake(&bare, &mut |_, _| ()).unwrap();
    let columns = world.field.grid().columns() as usize;
    let step_m = world.field.grid().step_m;
    let (after, before) = (world.field.heights_m(), bare.field.heights_m());
    let (mut changed, mut steep, mut steepest) = (0, 0, 0.0_f64);
    for post in 0..after.len() - columns {
        for beside in [post + 1, post + columns] {
            if after[post] != before[post] || after[beside] != before[beside] {
                let slope = |heights: &[f32]| f64::from((heights[post] - heights[beside]).abs()) / step_m;
                changed += 1;
                steep += usize::from(slope(&after) > 0.1251 && slope(&after) > slope(&before));
                steepest = steepest.max(slope(&after));
            }
        }
    }
    println!(
        "{changed} edges of the ground changed, {steep} of them steeper than 1:8 and than before, at most {steepest:.3}"
    );
    assert!(changed > 1_000 && steep * 100 < changed);
    for airfield in &world.features.airfields {
        println!("{} {} {:.1} m {:?}", airfield.code, airfield.name, airfield.level_m, airfield.runways);
    }
}

#[test]
fn roads_and_rivers_come_from_geojson_too() {
    const MAP: &str = r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{"highway":"primary","lanes":2},"geometry":{"type":"LineString","coordinates":[[78.3,42.9],[78.4,42.9]]}},
        {"type":"Feature","properties":{"waterway":"river","width":"30 m"},"geometry":{"type":"MultiLineString","coordinates":[[[78.3,42.9],[78.4,42.9]],[[78.5,42.9],[78.6,42.9]]]}},
        {"type":"Feature","properties":{"building":"yes","height":"40 ft"},"geometry":{"type":"Polygon","coordinates":[[[78.3,42.9],[78.301,42.9],[78.301,42.901],[78.3,42.9]]]}},
        {"type":"Feature","properties":{"landuse":"military"},"geometry":{"type":"Polygon","coordinates":[[[78.3,42.9],[78.4,42.9],[78.4,43.0],[78.3,42.9]]]}}]}"#;
    let mut request = default_request();
    request.features = vec![Input::Embedded(Bytes { name: "map.geojson", content: MAP.as_bytes() })];
    request.step_m = 400.0;
    let world = bake(&request, &mut |_, _| ()).unwrap();
    check(&world);
    assert_eq!((world.features.roads[0].width_m, world.features.waterways[1].width_m), (6.5, 30.0));
    assert!((world.features.buildings[0].height_m - 12.192).abs() < 1e-4);
    assert_eq!((count(&world, "others").read, count(&world, "lakes").read), (1, 0));
}
