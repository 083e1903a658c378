//! Heights and segments against the ground: how many a second, on one core.
//!
//! Yardsticks: a plain lookup written here, bare loads of the same posts (the floor: no arithmetic, nothing to wait
//! for but memory), and parry3d's height field over the very same posts, the physics engine's own answer to both
//! questions. Points and segments are the same for all and in every run. The whole world is asked at random, the worst
//! case for caches: the posts that one height needs are 16 bytes on two rows, 2.13 lines of 64 bytes on average.

use super::statistics::{Against, Better, ROUNDS, WARM_UPS, alone, beside, interleave};
use super::{OWN, locked_version};
use crate::failure::Failure;
use crate::report::BenchResult;
use glam::{DVec2, DVec3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rapier3d::parry::math::Vector;
use rapier3d::parry::query::{Ray, RayCast};
use rapier3d::parry::shape::HeightField;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;
use terrain::{Area, Field, Ground};

const SEED: u64 = 20_261_122;

/// Lengths of the three thirds of the fixed mix, kilometres.
const LENGTHS_KM: [[f64; 2]; 3] = [[0.1, 1.0], [1.0, 20.0], [20.0, 400.0]];

/// How much is asked in a round.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// Points.
    pub points: usize,
    /// Segments of each third.
    pub segments: usize,
    /// Rounds that count.
    pub rounds: u32,
}

impl Load {
    /// What the program measures with: some 0.3 s a round.
    pub const FULL: Self = Self { points: 1 << 20, segments: 4_000, rounds: ROUNDS };
}

struct Segment {
    from: DVec3,
    to: DVec3,
}

/// Measures on a world's posts.
///
/// # Errors
/// [`Failure::Failed`] if the posts make no height field (all void).
pub fn bench(field: &Arc<Field>, load: Load) -> Result<Vec<BenchResult>, Failure> {
    let area = Ground::new(field.clone()).whole();
    let grid = *field.grid();
    let engine = sim::ground_contact::height_field(&field.heights_m(), grid.columns(), grid.rows(), grid.step_m)
        .map_err(|error| Failure::while_doing("making the yardstick's height field", error))?;
    let mut results = heights(&area, &engine, load)?;
    results.extend(segments(&area, &engine, load)?);
    Ok(results)
}

fn heights(area: &Area, engine: &HeightField, load: Load) -> Result<Vec<BenchResult>, Failure> {
    let (grid, posts) = (*area.grid(), area.field().heights_m());
    let posts = &*posts;
    let mut random = StdRng::seed_from_u64(SEED);
    let points: Vec<DVec2> = (0..load.points)
        .map(|_| {
            let x_m = random.random_range(grid.west_m..grid.east_m());
            DVec2::new(x_m, random.random_range(grid.north_m..grid.south_m()))
        })
        .collect();
    let wide = grid.columns() as usize;
    let corners: Vec<u32> = points
        .iter()
        .map(|p| {
            let (u, v) = ((p.x - grid.west_m) / grid.step_m, (p.y - grid.north_m) / grid.step_m);
            (v as usize * wide + u as usize) as u32
        })
        .collect();
    let mut answers = vec![0.0; points.len()];
    // A ray costs a hundred times a lookup.
    let rays = &points[..points.len().div_ceil(16)];
    let top_m = area.field().heights_m().iter().copied().fold(0.0, f32::max) + 10.0;
    let values = interleave::<Failure>(
        WARM_UPS,
        load.rounds,
        &mut [
            &mut || Ok(rate(points.len(), || area.heights_m(&points, black_box(&mut answers)))),
            &mut || {
                Ok(rate(points.len(), || {
                    points.iter().for_each(|p| {
                        black_box(area.height_m(p.x, p.y));
                    });
                }))
            },
            &mut || {
                Ok(rate(points.len(), || {
                    let mut wait = 0.0;
                    for p in &points {
                        // Each point is known only when the last answer is: nothing overlaps.
                        let height = area.height_m(p.x + wait, p.y).unwrap_or(0.0);
                        wait = black_box(height) * 1e-300;
                    }
                }))
            },
            &mut || {
                Ok(rate(points.len(), || {
                    points.iter().for_each(|p| {
                        black_box(plain_height_m(posts, &grid, *p));
                    });
                }))
            },
            &mut || {
                Ok(rate(corners.len(), || {
                    let mut sum = 0.0;
                    for &at in &corners {
                        let at = at as usize;
                        sum += (posts[at] + posts[at + 1]) + (posts[at + wide] + posts[at + wide + 1]);
                    }
                    black_box(sum);
                }))
            },
            &mut || {
                Ok(rate(rays.len(), || {
                    rays.iter().for_each(|p| {
                        black_box(engine_height_m(engine, &grid, *p, f64::from(top_m)));
                    });
                }))
            },
        ],
    )?;
    let [batch, single, waiting, plain, loads, ray] = values.as_slice() else { return Ok(Vec::new()) };
    let bytes = format!(
        "{:.1} MiB of posts; floor a height: 16 bytes on 2.13 cache lines",
        size_of_val(posts) as f64 / f64::from(1 << 20)
    );
    let unit = "million/s";
    let plain = Against { name: "plain lookup", version: OWN, values: plain };
    let engine_name = format!("parry3d-f64 height field over all {} posts, vertical ray", posts.len());
    let engine = Against { name: &engine_name, version: locked_version("parry3d-f64"), values: ray };
    let loads = Against { name: "bare loads of the same posts", version: OWN, values: loads };
    let more = Better::More;
    Ok(vec![
        beside("heights, batch, one core", unit, more, batch, plain, bytes.as_str()),
        beside("heights, batch, against the floor", unit, more, batch, loads, bytes.as_str()),
        beside("heights, batch, against the engine", unit, more, batch, engine, ""),
        beside("heights, one at a time", unit, more, single, plain, "answers may overlap"),
        beside("heights, one at a time, against the engine", unit, more, single, engine, ""),
        alone("heights, each after the last answer", unit, waiting, "nothing overlaps: the whole latency"),
    ])
}

fn segments(area: &Area, engine: &HeightField, load: Load) -> Result<Vec<BenchResult>, Failure> {
    let mut random = StdRng::seed_from_u64(SEED + 1);
    let thirds = LENGTHS_KM.map(|lengths_km| -> Vec<Segment> {
        (0..load.segments).filter_map(|_| segment(area, &mut random, lengths_km)).collect()
    });
    let (mut ours, mut theirs) = ([const { Vec::new() }; 3], [const { Vec::new() }; 3]);
    for round in 0..WARM_UPS + load.rounds {
        for (third, segments) in thirds.iter().enumerate() {
            let start = Instant::now();
            segments.iter().for_each(|s| {
                black_box(area.segment(s.from, s.to));
            });
            let own_s = start.elapsed().as_secs_f64();
            let start = Instant::now();
            segments.iter().for_each(|s| {
                black_box(engine_segment(engine, area, s));
            });
            let engine_s = start.elapsed().as_secs_f64();
            if round >= WARM_UPS {
                ours[third].push(own_s);
                theirs[third].push(engine_s);
            }
        }
    }
    let (mut hits, mut differ, mut total) = (0, 0, 0);
    for s in thirds.iter().flatten() {
        let hit = area.segment(s.from, s.to).is_some();
        hits += usize::from(hit);
        differ += usize::from(hit != engine_segment(engine, area, s).is_some());
        total += 1;
    }
    let note = format!("{} of {total} meet the ground; parry3d answers {differ} otherwise", hits);
    let name = format!("parry3d-f64 height field over all {} posts, ray", area.field().heights_m().len());
    let result = |what: &str, count: usize, ours_s: &[f64], theirs_s: &[f64], note: &str| {
        let rate = |times_s: &[f64]| times_s.iter().map(|s| count as f64 * 1e-6 / s).collect::<Vec<_>>();
        let (ours, theirs) = (rate(ours_s), rate(theirs_s));
        let yardstick = Against { name: &name, version: locked_version("parry3d-f64"), values: &theirs };
        beside(what, "million/s", Better::More, &ours, yardstick, note)
    };
    let sums = |times: &[Vec<f64>; 3]| -> Vec<f64> {
        (0..times[0].len()).map(|round| times.iter().map(|third| third[round]).sum()).collect()
    };
    let mut results = vec![result("segments, mix of three equal thirds", total, &sums(&ours), &sums(&theirs), &note)];
    for (third, [from, to]) in LENGTHS_KM.iter().enumerate() {
        let what = format!("segments of {from}..{to} km");
        results.push(result(&what, thirds[third].len(), &ours[third], &theirs[third], ""));
    }
    Ok(results)
}

/// A segment of a length within a range (in plan, evenly in its logarithm), within the world: from 2 to 3,000 m above
/// the ground to a place that in every other case is a metre under it (on it, rounding would decide), else as high again.
fn segment(area: &Area, random: &mut StdRng, [least_km, most_km]: [f64; 2]) -> Option<Segment> {
    let grid = *area.grid();
    let above_m = |random: &mut StdRng| 2.0 * 1_500f64.powf(random.random_range(0.0..1.0));
    // A small world has no place for the longest: then they are as long as it is wide.
    let room_m = 0.9 * (grid.east_m() - grid.west_m).min(grid.south_m() - grid.north_m);
    for _ in 0..1_000 {
        let x_m = random.random_range(grid.west_m..grid.east_m());
        let z_m = random.random_range(grid.north_m..grid.south_m());
        let length_m = (1_000.0 * least_km * (most_km / least_km).powf(random.random_range(0.0..1.0))).min(room_m);
        let heading = random.random_range(0.0..std::f64::consts::TAU);
        let end = DVec2::new(x_m + length_m * heading.sin(), z_m - length_m * heading.cos());
        let (Some(from_m), Some(to_m)) = (area.height_m(x_m, z_m), area.height_m(end.x, end.y)) else { continue };
        let from = DVec3::new(x_m, from_m + above_m(random), z_m);
        let target_m = if random.random_bool(0.5) { -1.0 } else { above_m(random) };
        return Some(Segment { from, to: DVec3::new(end.x, to_m + target_m, end.y) });
    }
    None
}

/// Millions a second.
fn rate(count: usize, work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    count as f64 * 1e-6 / start.elapsed().as_secs_f64()
}

/// What one would write first: which cell, which half, interpolate; no voids, no care for the edge.
#[inline]
fn plain_height_m(posts: &[f32], grid: &terrain::Grid, at: DVec2) -> Option<f64> {
    let (u, v) = ((at.x - grid.west_m) / grid.step_m, (at.y - grid.north_m) / grid.step_m);
    let (column, row) = (u.floor(), v.floor());
    let (east, south) = (u - column, v - row);
    let wide = grid.columns() as usize;
    let corner = row as usize * wide + column as usize;
    let post = |at: usize| posts.get(at).map(|h| f64::from(*h));
    let (nw, ne, sw, se) = (post(corner)?, post(corner + 1)?, post(corner + wide)?, post(corner + wide + 1)?);
    Some(if east + south <= 1.0 {
        nw + east * (ne - nw) + south * (sw - nw)
    } else {
        se + (1.0 - east) * (sw - se) + (1.0 - south) * (ne - se)
    })
}

/// The engine's field is centred on its own origin.
fn engine_middle(grid: &terrain::Grid) -> DVec2 {
    DVec2::new(0.5 * (grid.west_m + grid.east_m()), 0.5 * (grid.north_m + grid.south_m()))
}

fn engine_height_m(engine: &HeightField, grid: &terrain::Grid, at: DVec2, top_m: f64) -> Option<f64> {
    let at = at - engine_middle(grid);
    let ray = Ray::new(Vector::new(at.x, top_m, at.y), Vector::new(0.0, -1.0, 0.0));
    engine.cast_local_ray(&ray, 100_000.0, true).map(|fall_m| top_m - fall_m)
}

fn engine_segment(engine: &HeightField, area: &Area, segment: &Segment) -> Option<f64> {
    let middle = engine_middle(area.grid());
    let along = segment.to - segment.from;
    let from = Vector::new(segment.from.x - middle.x, segment.from.y, segment.from.z - middle.y);
    engine.cast_local_ray(&Ray::new(from, Vector::new(along.x, along.y, along.z)), 1.0, true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::{Grid, synthetic};

    #[test]
    fn all_yardsticks_answer_the_same_question() {
        let grid = Grid::centred(200.0, 3, 2).unwrap();
        let field = Arc::new(synthetic::ridges(grid, 5));
        let area = Ground::new(field.clone()).whole();
        let engine =
            sim::ground_contact::height_field(&field.heights_m(), grid.columns(), grid.rows(), grid.step_m).unwrap();
        let mut random = StdRng::seed_from_u64(SEED);
        for _ in 0..500 {
            let x_m = random.random_range(grid.west_m..grid.east_m());
            let at = DVec2::new(x_m, random.random_range(grid.north_m..grid.south_m()));
            let ours = area.height_m(at.x, at.y).unwrap();
            // Heights to 6 km in f64: a few roundings of 1e-12; the engine scales by the world's extent, some more.
            assert!((plain_height_m(&field.heights_m(), &grid, at).unwrap() - ours).abs() < 1e-9);
            assert!((engine_height_m(&engine, &grid, at, 10_000.0).unwrap() - ours).abs() < 1e-6);
        }
        let mut same = 0;
        for _ in 0..200 {
            let s = segment(&area, &mut random, [0.1, 400.0]).unwrap();
            assert!(s.from.y > area.height_m(s.from.x, s.from.z).unwrap());
            let ours = area.segment(s.from, s.to).map(|hit| hit.fraction);
            same += usize::from(match (ours, engine_segment(&engine, &area, &s)) {
                (Some(a), Some(b)) => (a - b).abs() < 1e-6,
                (a, b) => a.is_none() && b.is_none(),
            });
        }
        // The engine loses hits on cell lines.
        assert!(same >= 195, "{same} of 200");
    }

    #[test]
    fn results_have_ratios_and_names_of_their_own() {
        let field = Arc::new(synthetic::ridges(Grid::centred(200.0, 2, 2).unwrap(), 5));
        let results = bench(&field, Load { points: 64, segments: 8, rounds: 2 }).unwrap();
        assert_eq!(results.len(), 10);
        for (at, result) in results.iter().enumerate() {
            assert!(result.ours > 0.0 && result.rounds == 2, "{result:?}");
            assert_eq!(result.ratio.is_some(), result.yardstick.is_some());
            assert!(results[..at].iter().all(|other| other.name != result.name));
        }
    }
}
