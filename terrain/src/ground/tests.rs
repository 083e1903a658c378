//! Ground queries against slow, obvious twins: all triangles, one by one.

use super::*;
use crate::synthetic;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng, rngs::StdRng};

/// Coordinates reach 12 km and heights 10 km: f64 steps of 2e-12 m. A query does some ten roundings, and a grazing ray
/// magnifies them along itself by at most 1e5 for the slopes met here (10 km in a cell of 200 m, rays of 12 km).
const AGREE_M: f64 = 1e-6;

/// Below this gap a rounding decides whether a segment meets the ground at all.
const TOUCH_M: f64 = 1e-9;

fn fields() -> Vec<(&'static str, Field)> {
    let grid = Grid::centred(200.0, 2, 1).unwrap();
    let mut holed = synthetic::ridges(grid, 3).heights_m().to_vec();
    for at in [5, 200, 201, 202, 263, 900, 1500] {
        holed[at] = f32::NAN;
    }
    vec![
        ("flat sea", synthetic::flat(grid, 0.0)),
        ("trench", synthetic::flat(grid, -11_000.0)),
        ("spike of 9 km", synthetic::spike(grid, 17, 11, 9_000.0)),
        ("step of 10 km", synthetic::cliff(grid, 24, 10_000.0)),
        ("ridges", synthetic::ridges(grid, 1)),
        ("rough", synthetic::rough(grid, 2, 800.0)),
        ("with voids", Field::new(grid, holed).unwrap()),
    ]
}

fn triangles(field: &Field) -> Vec<[DVec3; 3]> {
    let grid = *field.grid();
    (0..grid.rows() - 1)
        .flat_map(|row| (0..grid.columns() - 1).map(move |column| (column, row)))
        .flat_map(|(column, row)| field.cell_triangles(column, row).into_iter().flatten())
        .map(|t| t.corners)
        .collect()
}

/// Signed distance of a plan point inside the edge a-b of a counter-clockwise (from above) triangle.
fn inside(a: DVec3, b: DVec3, x: f64, z: f64) -> f64 {
    let (ex, ez) = (b.x - a.x, b.z - a.z);
    (ez * (x - a.x) - ex * (z - a.z)) / ex.hypot(ez)
}

fn plane_m([a, b, c]: [DVec3; 3], x: f64, z: f64) -> f64 {
    let n = (b - a).cross(c - a);
    a.y - (n.x * (x - a.x) + n.z * (z - a.z)) / n.y
}

fn slow_height_m(triangles: &[[DVec3; 3]], x: f64, z: f64) -> Option<f64> {
    triangles
        .iter()
        .find(|[a, b, c]| [(a, b), (b, c), (c, a)].iter().all(|(p, q)| inside(**p, **q, x, z) >= -1e-9))
        .map(|t| plane_m(*t, x, z))
}

/// First fraction on or under the ground, and the least gap met, over all triangles.
fn slow_segment(triangles: &[[DVec3; 3]], from: DVec3, to: DVec3) -> (Option<f64>, f64) {
    let (mut first, mut least) = (None::<f64>, f64::INFINITY);
    for &[a, b, c] in triangles {
        let (mut enter, mut exit) = (0.0f64, 1.0f64);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (d0, d1) = (inside(p, q, from.x, from.z), inside(p, q, to.x, to.z));
            // Edges closed, and a hair wider so that none of two neighbours loses a segment between them.
            let (d0, d1) = (d0 + 1e-10, d1 + 1e-10);
            if d0 < 0.0 && d1 < 0.0 {
                (enter, exit) = (1.0, 0.0);
            } else if d0 < 0.0 {
                enter = enter.max(d0 / (d0 - d1));
            } else if d1 < 0.0 {
                exit = exit.min(d0 / (d0 - d1));
            }
        }
        if enter > exit {
            continue;
        }
        let gap = |t: f64| {
            let p = from + (to - from) * t;
            p.y - plane_m([a, b, c], p.x, p.z)
        };
        let (gap_in, gap_out) = (gap(enter), gap(exit));
        least = least.min(gap_in).min(gap_out);
        let hit = if gap_in <= 0.0 {
            Some(enter)
        } else if gap_out <= 0.0 {
            Some(enter + (exit - enter) * gap_in / (gap_in - gap_out))
        } else {
            None
        };
        if let Some(hit) = hit {
            first = Some(first.map_or(hit, |f| f.min(hit)));
        }
    }
    (first, least)
}

fn agree(name: &str, area: &Area, triangles: &[[DVec3; 3]], from: DVec3, to: DVec3) {
    let quick = area.segment(from, to);
    let (slow, least_gap) = slow_segment(triangles, from, to);
    match (quick, slow) {
        (Some(hit), Some(fraction)) => {
            let apart = (hit.fraction - fraction).abs() * (to - from).length();
            assert!(apart <= AGREE_M || least_gap.abs() < TOUCH_M, "{name}: {from} to {to}: {apart} m apart");
            assert!(hit.normal.is_normalized() && hit.normal.y > 0.0, "{name}: normal {}", hit.normal);
        }
        (None, None) => {}
        _ => assert!(least_gap.abs() < TOUCH_M, "{name}: {from} to {to}: {quick:?}, slow {slow:?}, gap {least_gap}"),
    }
}

#[test]
fn height_and_normal_are_the_triangles() {
    for (name, field) in fields() {
        let all = triangles(&field);
        let area = Ground::new(Arc::new(field)).whole();
        let mut random = StdRng::seed_from_u64(1);
        let mut points: Vec<DVec2> = (0..400)
            .map(|_| DVec2::new(random.random_range(-6500.0..6500.0), random.random_range(-3300.0..3300.0)))
            .collect();
        // On posts, cell lines and diagonals too.
        for _ in 0..200 {
            let (c, r) = (random.random_range(-30..=30), random.random_range(-15..=15));
            let t = f64::from(random.random_range(0..8)) * 25.0;
            let (x, z) = (f64::from(c) * 200.0, f64::from(r) * 200.0);
            points.extend([DVec2::new(x, z), DVec2::new(x + t, z), DVec2::new(x, z + t), DVec2::new(x + t, z - t)]);
        }
        let mut batch = vec![0.0; points.len()];
        area.heights_m(&points, &mut batch);
        for (p, together) in points.iter().zip(batch) {
            let slow = slow_height_m(&all, p.x, p.y);
            let quick = area.height_m(p.x, p.y);
            assert_eq!(quick.is_some(), slow.is_some(), "{name} at {p}");
            if let (Some(quick), Some(slow)) = (quick, slow) {
                assert!((quick - slow).abs() < 1e-8, "{name} at {p}: {quick} and {slow}");
                assert_eq!(quick, together);
                assert_eq!(area.height_and_normal(p.x, p.y).unwrap().0, quick);
            } else {
                assert!(together.is_nan());
            }
        }
    }
}

#[test]
fn exact_at_every_post() {
    // A step that is no binary fraction, and a far corner.
    let grid = Grid { west_m: -201_000.3, north_m: -12_345.6, step_m: 200.1, blocks_x: 3, blocks_z: 2 };
    let field = synthetic::rough(grid, 5, 8_000.0);
    let area = Ground::new(Arc::new(field.clone())).whole();
    let even = Grid::centred(200.0, 3, 2).unwrap();
    let even_area = Ground::new(Arc::new(Field::new(even, field.heights_m().to_vec()).unwrap())).whole();
    for row in 0..i64::from(grid.rows()) {
        for column in 0..i64::from(grid.columns()) {
            let post = f64::from(field.post_m(column, row));
            assert_eq!(even_area.height_m(even.x_m(column), even.z_m(row)), Some(post));
            // x = west + column * step carries one rounding of 3e-11 m, on slopes of up to 40.
            if let Some(height) = area.height_m(grid.x_m(column), grid.z_m(row)) {
                assert!((height - post).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn segments_meet_what_all_triangles_meet() {
    for (name, field) in fields() {
        let all = triangles(&field);
        let range = Pyramid::new(&field).all();
        let (low, high) = (f64::from(range.least_m), f64::from(range.greatest_m));
        let area = Ground::new(Arc::new(field)).whole();
        let mut random = StdRng::seed_from_u64(2);
        for _ in 0..150 {
            let mut point = |margin: f64| {
                DVec3::new(
                    random.random_range(-6_000.0 - margin..6_000.0 + margin),
                    random.random_range(low - 50.0..high + 300.0),
                    random.random_range(-3_000.0 - margin..3_000.0 + margin),
                )
            };
            let (a, b) = (point(500.0), point(500.0));
            agree(name, &area, &all, a, b);
            agree(name, &area, &all, b, a);
            agree(name, &area, &all, a, a + (b - a) * 0.01);
        }
    }
}

#[test]
fn segments_along_lines_posts_and_diagonals_are_watertight() {
    for (name, field) in fields() {
        let all = triangles(&field);
        let range = Pyramid::new(&field).all();
        let (low, high) = (f64::from(range.least_m), f64::from(range.greatest_m));
        let area = Ground::new(Arc::new(field)).whole();
        let mut random = StdRng::seed_from_u64(3);
        for _ in 0..60 {
            let post = |random: &mut StdRng, y: f64| {
                let (c, r) = (random.random_range(-30..=30), random.random_range(-15..=15));
                DVec3::new(f64::from(c) * 200.0, y, f64::from(r) * 200.0)
            };
            let y = random.random_range(low + 1.0..high + 200.0);
            let from = post(&mut random, y);
            let down = DVec3::new(0.0, low - 100.0 - y, 0.0);
            let reach = 200.0 * f64::from(random.random_range(1..12));
            for (dx, dz) in [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, -1), (-1, 1), (1, 1), (-1, -1)] {
                let plan = DVec3::new(f64::from(dx) * reach, 0.0, f64::from(dz) * reach);
                for to in [from + plan + down, from + plan, from + plan + down * 0.1] {
                    agree(name, &area, &all, from, to);
                    agree(name, &area, &all, to, from);
                }
            }
            let to = post(&mut random, low - 5.0);
            agree(name, &area, &all, from, to);
        }
    }
}

#[test]
fn a_hundred_thousand_shots_at_posts_edges_and_diagonals_never_pass() {
    let grid = Grid::centred(200.0, 4, 4).unwrap();
    let area = Ground::new(Arc::new(synthetic::ridges(grid, 9))).whole();
    let mut random = StdRng::seed_from_u64(4);
    for _ in 0..100_000 {
        let c = f64::from(random.random_range(-59..=59)) * 200.0;
        let r = f64::from(random.random_range(-59..=59)) * 200.0;
        let t = random.random_range(0.0..200.0);
        let (x, z) = [(c, r), (c + t, r), (c, r + t), (c + t, r - t)][random.random_range(0..4)];
        let ground = area.height_m(x.clamp(-12_000.0, 12_000.0), z.clamp(-12_000.0, 12_000.0)).unwrap();
        let aim = DVec3::new(x, ground, z);
        let back = DVec3::new(random.random_range(-900.0..900.0), 3_000.0, random.random_range(-900.0..900.0));
        let from = aim + back;
        if area.height_m(from.x, from.z).is_none() {
            continue;
        }
        // Ends a metre below the ground it was aimed at, so it must meet it.
        assert!(area.segment(from, aim - back.normalize()).is_some(), "from {from} at {aim}");
    }
}

#[test]
fn numbers_that_are_none_meet_nothing() {
    let area = Ground::new(Arc::new(synthetic::flat(Grid::centred(200.0, 1, 1).unwrap(), 0.0))).whole();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(area.height_m(bad, 0.0), None);
        assert_eq!(area.height_m(0.0, bad), None);
        assert!(area.segment(DVec3::new(0.0, bad, 0.0), DVec3::ZERO).is_none());
        assert!(area.segment(DVec3::ZERO, DVec3::new(bad, 0.0, 0.0)).is_none());
    }
    assert_eq!(area.height_m(1e300, -1e300), None);
    assert!(area.segment(DVec3::new(-1e12, 10.0, 0.0), DVec3::new(1e12, 10.0, 0.0)).is_none());
    assert_eq!(area.segment(DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.0, 9.0, 0.0)).unwrap().fraction, 0.0);
    assert!(Ground::new(Arc::new(area.field().clone())).area(DVec2::NAN, DVec2::ONE).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_segment_over_any_rough_field(
        seed in 0u32..1000, reach in 1.0f32..9000.0,
        from in (-7e3..7e3f64, -100.0..9e3f64, -4e3..4e3f64), to in (-7e3..7e3f64, -100.0..9e3f64, -4e3..4e3f64),
    ) {
        let field = synthetic::rough(Grid::centred(200.0, 2, 1).unwrap(), seed, reach);
        let all = triangles(&field);
        let area = Ground::new(Arc::new(field)).whole();
        agree("any", &area, &all, DVec3::new(from.0, from.1, from.2), DVec3::new(to.0, to.1, to.2));
    }
}
