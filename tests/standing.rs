//! Everything stands on the ground that is asked: trees, buildings, placed things, masts, lights, roads and water of the
//! real Andorra, in every block of the near zone about its capital, at two post steps.
//!
//! The promise is a millimetre. What is stored as f32 is off by half an ulp, 0.12 mm below 4,096 m.

use glam::DVec2;
use std::path::Path;
use std::sync::Arc;
use terrain::bake::{BakeRequest, Input, bake};
use terrain::block::ground_map::Climate;
use terrain::block::{Landscape, Rings};
use terrain::features::index::{ObjectId, ObjectIndex};
use terrain::features::solid::FOOT_M;
use terrain::features::{airfield_lights, settlement_lights::Lamps};
use terrain::near::TileIndex;
use terrain::store::World;
use terrain::verify::overlay;
use terrain::{Geodetic, Grid, Ground};
use vegetation::place::{Nursery, TIERS, corner_m};
use visual::passes::lights::LightInstance;
use visual::passes::{object_tiles, objects::TILE_M};

/// All tiles of a side over a grid.
fn tiles_of(grid: &Grid, side_m: f64) -> impl Iterator<Item = TileIndex> {
    let number = |length_m: f64| (length_m / side_m).ceil() as i32;
    let (across, down) = (number(grid.east_m() - grid.west_m), number(grid.south_m() - grid.north_m));
    (0..down).flat_map(move |z| (0..across).map(move |x| TileIndex { x, z }))
}

/// What is promised, metres.
const PROMISED_M: f64 = 0.001;

fn andorra(step_m: f64) -> Option<World> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/terrain/tests");
    let file = |name: &str| data.join(name);
    let (heights, ways) = (file("dem/srtm3_pyrenees/N42E001.hgt.zip"), file("osm/andorra-20130528.osm.pbf"));
    let airfields = file("gis/airportsdata_airports.csv.gz");
    if let Some(missing) = [&heights, &ways, &airfields].into_iter().find(|path| !path.is_file()) {
        println!("skipped: {} is not there", missing.display());
        return None;
    }
    let request = BakeRequest {
        name: "andorra".into(),
        sources: vec![(Input::File(heights), 1.0)],
        features: vec![Input::File(ways), Input::File(airfields)],
        imagery: Vec::new(),
        step_m,
        centre: Some(Geodetic::from_degrees(42.5, 1.55)),
        size_km: Some([36.0, 36.0]),
    };
    Some(bake(&request, &mut |_, _| ()).unwrap_or_else(|error| panic!("{error}")))
}

fn landscape(world: &World) -> Arc<Landscape> {
    let rings = Rings::new(world.field.grid(), 24, 1.0);
    let climate = Climate::of(world.projection.centre(), world.info.statistics.mean_m);
    let bare = Landscape::bare(world.field.clone(), rings.limits_m, climate);
    Arc::new(Landscape {
        features: world.features.clone(),
        lakes: Arc::new(world.lakes.clone()),
        cover: world.cover.clone(),
        ..bare
    })
}

#[test]
fn all_that_stands_in_andorra_stands_on_the_ground() {
    for step_m in [200.0, 100.0] {
        let Some(world) = andorra(step_m) else { return };
        let landscape = landscape(&world);
        let area = Ground::new(world.field.clone()).whole();
        let grid = *world.field.grid();
        let eye = world.projection.to_world(Geodetic::from_degrees(42.507, 1.522));
        let near_m = Rings::new(&grid, 24, 1.0).radii_m[0];
        let worst = |worst: &mut f64, at: DVec2, base_m: f64| {
            let ground_m = area.height_m(at.x, at.y).unwrap_or_else(|| panic!("no ground at {at}"));
            *worst = worst.max((base_m - ground_m).abs());
        };

        let draped = overlay::look(&landscape, usize::MAX, |_| {});
        assert!(draped.vertices > 100_000, "{draped:?}");
        assert_eq!((draped.t_junctions, draped.border_mismatches, draped.crossings), (0, 0, 0), "{draped:?}");

        let nursery = Nursery::new(landscape.clone(), world.projection.centre().lat_rad);
        let (mut trees, mut trees_m) = (0, 0.0);
        for tier in &TIERS {
            let corner = corner_m(&grid, tier.side_m, TileIndex { x: 0, z: 0 });
            let tile = |at_m: f64| (at_m / tier.side_m).floor() as i32;
            let (low, high) = (eye - corner - near_m, eye - corner + near_m);
            for z in tile(low.y).max(0)..=tile(high.y) {
                for x in tile(low.x).max(0)..=tile(high.x) {
                    let index = TileIndex { x, z };
                    let planted = nursery.plants(tier, index, 1.0);
                    if tier.number == 0 {
                        assert!(planted.plants.len() <= 8_000, "{index:?}: {} plants", planted.plants.len());
                    }
                    for plant in &planted.plants {
                        let at = plant.plan_m(tier, corner_m(&grid, tier.side_m, index));
                        worst(&mut trees_m, at, plant.height_m.into());
                        trees += 1;
                    }
                }
            }
        }
        assert!(trees > 100_000, "{trees} trees");

        let index = ObjectIndex::new(world.features.clone(), &area);
        let (mut buildings, mut things, mut standing_m) = (0, 0, 0.0);
        for object in index.iter() {
            match object.id {
                ObjectId::Building(number) => {
                    // A building's base is the lowest ground under its corners.
                    let corners = &world.features.buildings[number as usize].outline;
                    let under = corners.iter().filter_map(|at| area.height_m(at.x, at.y)).fold(f64::INFINITY, f64::min);
                    standing_m = f64::max(standing_m, (object.base_m - under).abs());
                    buildings += 1;
                }
                _ => {
                    let stand = index.stand(object).expect("a thing in the tree");
                    worst(&mut standing_m, DVec2::new(stand.at_m.x, stand.at_m.z), stand.at_m.y);
                    things += 1;
                }
            }
        }
        assert!(buildings > 250 && things > 300, "{buildings} buildings, {things} things");

        // What is sent to the device: of each building the foot of its walls, of each thing its place.
        let (mut feet, mut instances) = (0, 0);
        for tile in tiles_of(&grid, TILE_M) {
            let tile = object_tiles::made(&index, &grid, tile, TILE_M);
            let post = tile.anchor_post.map(i64::from);
            let from = DVec2::new(grid.x_m(post[0]), grid.z_m(post[1]));
            let mut first = 0;
            for (_, end) in &tile.cuts {
                let vertices =
                    tile.mesh.indices[first..*end as usize].iter().map(|at| &tile.mesh.vertices[*at as usize]);
                let points: Vec<[f64; 3]> = vertices.map(|vertex| vertex.position_m.map(f64::from)).collect();
                let foot_m = points.iter().map(|at| at[1]).fold(f64::INFINITY, f64::min);
                // A corner's f32 is off by at most 0.1 mm in plan, and the ground there by as much times its slope.
                let corners = points.iter().filter(|at| at[1] == foot_m).map(|at| from + DVec2::new(at[0], at[2]));
                let ground_m = corners.filter_map(|at| area.height_m(at.x, at.y)).fold(f64::INFINITY, f64::min);
                standing_m = standing_m.max((foot_m + FOOT_M - ground_m).abs());
                first = *end as usize;
                feet += 1;
            }
            for thing in &tile.things {
                let [east_m, up_m, south_m] = thing.instance.offset_m.map(f64::from);
                worst(&mut standing_m, from + DVec2::new(east_m, south_m), up_m);
                instances += 1;
            }
        }
        assert_eq!((feet, instances), (buildings, things), "each in one tile");

        let lamps = Lamps::new(&world.features, &world.cover, DVec2::new(grid.west_m, grid.north_m), 6_000.0);
        let tiles = (0..6).flat_map(|z| (0..6).map(move |x| (x, z)));
        let street = tiles.flat_map(|(x, z)| lamps.tile(x, z)).map(|(light, _)| light);
        let (mut lights, mut lights_m) = (0, 0.0);
        for light in airfield_lights::all(&world.features).into_iter().chain(street) {
            // As the pass keeps it, in f32, less the lamp's own height.
            let Some(instance) = LightInstance::new(&area, &light, 0.0) else { continue };
            worst(&mut lights_m, light.at, f64::from(instance.height[0]) - f64::from(light.above_m));
            lights += 1;
        }
        assert!(lights > 500, "{lights} lights");

        println!(
            "{step_m} m: {} vertices {:.3} mm, {trees} trees {:.3} mm, {buildings} buildings and {things} things \
             {:.3} mm, {lights} lights {:.3} mm",
            draped.vertices,
            1e3 * draped.max_height_error_m,
            1e3 * trees_m,
            1e3 * standing_m,
            1e3 * lights_m
        );
        for (what, off_m) in [
            ("overlay", draped.max_height_error_m),
            ("trees", trees_m),
            ("buildings and things", standing_m),
            ("lights", lights_m),
        ] {
            assert!(off_m < PROMISED_M, "{what}: {off_m} m at {step_m} m posts");
        }
    }
}
