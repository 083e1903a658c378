//! What is laid on a world, left out, told.

use super::*;

fn world() -> (Projection, Grid) {
    (Projection::new(Geodetic::from_degrees(42.0, 78.0)).unwrap(), Grid::centred(200.0, 2, 2).unwrap())
}

fn feature(pairs: &[(&str, &str)], points: &[(f64, f64)]) -> RawFeature {
    let mut tags = Tags::default();
    pairs.iter().for_each(|(key, value)| tags.push(key, value));
    let line = points.iter().map(|(lon, lat)| DVec2::new(*lon, *lat)).collect();
    RawFeature::new(tags, Element::Way, Shape::Lines(vec![line]))
}

#[test]
fn buildings_run_counter_clockwise_and_lines_lose_repetitions() {
    let (projection, grid) = world();
    let square = [(78.0, 42.0), (78.001, 42.0), (78.001, 42.001), (78.0, 42.001), (78.0, 42.0)];
    let mut turned = square;
    turned.reverse();
    for outline in [square, turned] {
        let placed = place(&[feature(&[("building", "yes")], &outline)], &projection, &grid);
        let building = &placed.features.buildings[0];
        assert!(building.outline.len() == 4 && signed_area_m2(&building.outline) < -8_000.0);
        assert!(placed.features.is_sound());
    }
    let road = feature(&[("highway", "track")], &[(78.0, 42.0), (78.0, 42.0), (78.001, 42.0)]);
    assert_eq!(place(&[road], &projection, &grid).features.roads[0].line.len(), 2);
}

#[test]
fn what_is_left_out_has_a_reason() {
    let (projection, grid) = world();
    let all = [
        feature(&[("highway", "track")], &[(10.0, 42.0), (10.1, 42.0)]),
        feature(&[("highway", "track")], &[(78.0, 42.0), (78.0, 42.0)]),
        feature(&[("highway", "proposed")], &[(78.0, 42.0), (78.1, 42.0)]),
        feature(&[("highway", "track")], &[(79.0, 42.0), (79.1, 42.0)]),
        feature(&[("natural", "wood")], &[(78.0, 42.0), (78.01, 42.0), (78.01, 42.01)]),
        feature(&[("boundary", "x")], &[(78.0, 42.0), (78.01, 42.0)]),
    ];
    let counts = place(&all, &projection, &grid).counts.described();
    let highways = &counts["highways"];
    assert_eq!((highways.read, highways.kept, highways.skipped), (4, 0, 4));
    assert_eq!((highways.skipped_for[OUTSIDE], highways.skipped_for["fewer than two points"]), (2, 1));
    assert_eq!(counts["forests"].skipped_for["an outline that does not close"], 1);
    assert_eq!(counts["others"].skipped, 1);
}

#[test]
fn a_runway_outside_is_outside_and_endless_outlines_are_refused() {
    let (projection, grid) = world();
    let ring = |number: usize| -> Vec<(f64, f64)> {
        let angle = |i: usize| std::f64::consts::TAU * (i % number) as f64 / number as f64;
        (0..=number).map(|i| (78.0 + 0.002 * angle(i).cos(), 42.0 + 0.001 * angle(i).sin())).collect()
    };
    let all = [
        feature(&[("aeroway", "runway")], &[(79.0, 42.0), (79.02, 42.0)]),
        feature(&[("aeroway", "runway")], &ring(20_001)),
        feature(&[("aeroway", "taxiway")], &ring(20_001)),
        feature(&[("aeroway", "apron")], &ring(20_001)),
        feature(&[("building", "yes")], &ring(20_001)),
        feature(&[("building", "yes")], &ring(2_000)),
        feature(&[("waterway", "river"), ("width", "400")], &[(78.0, 42.0), (78.01, 42.0)]),
    ];
    let placed = place(&all, &projection, &grid);
    let counts = placed.counts.described();
    assert_eq!(counts["runways"].skipped_for[OUTSIDE], 1);
    for kind in ["runways", "taxiways", "aprons", "buildings"] {
        assert_eq!(counts[kind].skipped_for["more than 20,000 points"], 1, "{kind}");
    }
    assert_eq!(counts["buildings"].kept, 1);
    assert_eq!(counts["waterways"].notes["drawn 250 m wide, the most of a line"], 1);
}

#[test]
fn an_element_is_there_once_however_many_files_have_it() {
    let (projection, grid) = world();
    let road = |id| RawFeature {
        id: Some(id),
        ..feature(&[("highway", "track"), ("landuse", "forest")], &[(78.0, 42.0), (78.01, 42.0), (78.0, 42.01)])
    };
    let node = RawFeature { element: Element::Node, ..road(1) };
    let placed = place(&[road(1), road(2), road(1), node], &projection, &grid);
    assert_eq!(placed.features.roads.len(), 2);
    let counts = placed.counts.described();
    assert_eq!((counts["highways"].read, counts["highways"].skipped_for["again in another file"]), (3, 1));
    assert_eq!(counts["forests"].skipped_for["again in another file"], 1);
    assert_eq!(counts["others"].read, 1);
}

#[test]
fn courtyards_are_told() {
    let (projection, grid) = world();
    let square = |half: f64| -> Vec<DVec2> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(u, v)| DVec2::new(78.0 + u * half, 42.0 + v * half))
            .to_vec()
    };
    let mut house = feature(&[("building", "yes")], &[]);
    house.shape = Shape::Polygon(Polygon { outers: vec![square(1e-3)], inners: vec![square(5e-4)] });
    let placed = place(&[house], &projection, &grid);
    assert_eq!(placed.counts.described()["buildings"].notes["courtyard left out"], 1);
}
