//! What is draped on a real world lies in its ground; and how long a block of a town takes, as a figure and no limit.

use std::path::{Path, PathBuf};
use std::time::Instant;
use terrain::bake::{BakeRequest, Input, bake};
use terrain::block::ground_map::Climate;
use terrain::block::overlay::Overlays;
use terrain::block::{Landscape, Rings};
use terrain::store::World;
use terrain::verify::overlay;
use terrain::{Geodetic, Ground, RingMasks};

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/terrain/tests").join(file)
}

/// Andorra with its roads and rivers of 2013, or why not.
fn andorra(step_m: f64) -> Option<World> {
    let heights = data("dem/srtm3_pyrenees/N42E001.hgt.zip");
    let features = data("osm/andorra-20130528.osm.pbf");
    if let Some(missing) = [&heights, &features].into_iter().find(|path| !path.exists()) {
        println!("skipped: {} is not there", missing.display());
        return None;
    }
    let request = BakeRequest {
        name: "andorra".into(),
        sources: vec![(Input::File(heights), 1.0)],
        features: vec![Input::File(features)],
        imagery: Vec::new(),
        step_m,
        centre: Some(Geodetic::from_degrees(42.55, 1.6)),
        size_km: Some([24.0, 24.0]),
    };
    Some(bake(&request, &mut |_, _| ()).unwrap_or_else(|error| panic!("{error}")))
}

fn landscape(world: &World) -> Landscape {
    let rings = Rings::new(world.field.grid(), 24, 1.0);
    Landscape {
        masks: RingMasks::new(&world.field, rings.limits_m),
        features: world.features.clone(),
        ..Landscape::bare(world.field.clone(), rings.limits_m, Climate::new(0.74, 1_500.0))
    }
}

#[test]
fn every_vertex_of_andorras_roads_and_rivers_is_on_the_ground_and_no_seam_is_open() {
    for step_m in [200.0, 50.0] {
        let Some(world) = andorra(step_m) else { return };
        let found = overlay::look(&landscape(&world), usize::MAX, |_| {});
        println!("{step_m} m: {found:?}");
        assert!(found.vertices > 20_000, "{found:?}");
        assert_eq!((found.t_junctions, found.border_mismatches, found.crossings), (0, 0, 0), "{found:?}");
        // Half an ulp of an f32 below 4,096 m is 0.12 mm; the promise is a millimetre.
        assert!(found.max_height_error_m < 0.001, "{found:?}");
    }
}

#[test]
fn how_long_a_block_takes() {
    let Some(world) = andorra(200.0) else { return };
    let landscape = Landscape { ground: Ground::new(world.field.clone()), ..landscape(&world) };
    let started = Instant::now();
    let overlays = Overlays::new(&landscape);
    println!("made ready in {:.1} ms", started.elapsed().as_secs_f64() * 1e3);
    for block in overlays.blocks() {
        let started = Instant::now();
        let overlay = overlays.block(block);
        let ms = started.elapsed().as_secs_f64() * 1e3;
        println!(
            "{block:?}: {} features, {} triangles, {} bytes, {ms:.2} ms",
            overlay.parts.len(),
            overlay.indices.len() / 3,
            overlay.upload_bytes()
        );
        assert!(overlay.indices.iter().all(|index| (*index as usize) < overlay.vertices.len()));
    }
}
