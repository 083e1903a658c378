//! What is draped on a real world lies in its ground; and how long a block of a town takes, as a figure and no limit.

use glam::DVec2;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use terrain::bake::{BakeRequest, Input, bake};
use terrain::block::ground_map::Climate;
use terrain::block::overlay::Overlays;
use terrain::block::overlay::lattice::Lattice;
use terrain::block::overlay::ribbon::{Quad, Ribbon};
use terrain::block::{Landscape, Rings};
use terrain::store::World;
use terrain::verify::overlay;
use terrain::{Area, Geodetic, Ground, RingMasks};

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
        lakes: Arc::new(world.lakes.clone()),
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

/// Width on the ground of a quad's cut across its direction, `share` of the way from where both its sides begin to where
/// both end, metres; `None` where they do not both go on for a decimetre.
fn width_m(lattice: &Lattice, area: &Area, quad: &Quad, share: f64) -> Option<f64> {
    let across = DVec2::new(-quad.along.y, quad.along.x);
    let corners: Vec<DVec2> = quad.polygon.corners().map(|spot| lattice.plan_m(spot)).collect();
    let mut along_m: Vec<f64> = corners.iter().map(|at| at.dot(quad.along)).collect();
    along_m.sort_by(f64::total_cmp);
    let (from_m, to_m) = (along_m[corners.len() / 2 - 1], along_m[corners.len() / 2]);
    if corners.len() % 2 == 1 || to_m - from_m < 0.1 {
        return None;
    }
    let at_m = from_m + (to_m - from_m) * share;
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossings = edges.filter_map(|(a, b)| {
        let (start, end) = (a.dot(quad.along) - at_m, b.dot(quad.along) - at_m);
        (start * end < 0.0).then(|| a.lerp(*b, start / (start - end)).dot(across))
    });
    let (low, high) = crossings.fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at), high.max(at)));
    let place = |step: u32| quad.along * at_m + across * (low + (high - low) * f64::from(step) / 32.0);
    let heights: Option<Vec<f64>> = (0..=32).map(|step| area.height_m(place(step).x, place(step).y)).collect();
    Some(heights?.windows(2).map(|pair| ((high - low) / 32.0).hypot(pair[1] - pair[0])).sum())
}

#[test]
fn roads_have_their_nominal_width_along_the_slopes_of_andorra() {
    for step_m in [200.0, 50.0] {
        let Some(world) = andorra(step_m) else { return };
        let area = Ground::new(world.field.clone()).whole();
        let lattice = Lattice::of(world.field.grid());
        let mut off: Vec<f64> = Vec::new();
        let (mut short, mut steepest) = (0_u32, 0.0_f64);
        for road in world.features.roads.iter().filter(|road| !road.tunnel) {
            let half_m = 0.5 * f64::from(road.width_m);
            for ribbon in Ribbon::of_line(&world.field, &lattice, &road.line, half_m, usize::MAX) {
                for segment in 0..ribbon.segments() {
                    ribbon.segment(&world.field, &lattice, segment, |quad| {
                        steepest = steepest.max(quad.stretch);
                        for share in [0.05, 0.5, 0.95] {
                            match width_m(&lattice, &area, &quad, share) {
                                Some(found_m) => off.push((found_m / (2.0 * half_m) - 1.0).abs()),
                                None => short += 1,
                            }
                        }
                    });
                }
            }
        }
        off.sort_by(f64::total_cmp);
        let within = off.partition_point(|off| *off <= 0.05) as f64 / off.len() as f64;
        let at = |share: f64| off[((off.len() - 1) as f64 * share) as usize];
        println!(
            "{step_m} m: {} widths, {short} in joints, {within:.5} within 5 %; off by {:.4} at the median, {:.4} at 99 %, {:.4} at 99.9 %, {:.4} at most; longest stretch {steepest:.2}",
            off.len(),
            at(0.5),
            at(0.99),
            at(0.999),
            at(1.0)
        );
        assert!(off.len() > 30_000 && steepest > 1.2, "{} {steepest}", off.len());
        // Off are places where the ground turns within the width (a width follows the slope under its middle), and ends at a
        // bend, which have the mean of both sides' widths.
        assert!(within > 0.995 && at(1.0) < 0.2, "{within} {}", at(1.0));
    }
}
