//! Placing plants: milliseconds of a processor's own time a tile, for each population ([`vegetation::place`]).
//!
//! Tiles spread over the world are placed once each: their median, 99th percentile and worst stand in the note. The fullest
//! of them are placed again in rounds. Floor: what no way of placing can do without, the cover of every hash cell and the
//! ground under every plant, read at the same places and in the same order; the answer's bytes stand in the note.

use super::OWN;
use super::statistics::{Against, Better, ROUNDS, WARM_UPS, beside, interleave, share, sorted};
use crate::failure::Failure;
use crate::open_world;
use crate::report::BenchResult;
use glam::DVec2;
use std::hint::black_box;
use terrain::block::Rings;
use terrain::near::TileIndex;
use terrain::store::World;
use terrain::thread_time;
use vegetation::place::{Nursery, Plant, TIERS, Tier, corner_m};

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// Tiles of each population that are placed once.
    pub tiles: usize,
    /// The fullest of them, which are placed in rounds.
    pub fullest: usize,
    /// Rounds that count.
    pub rounds: u32,
}

impl Load {
    /// What the program measures with: some seconds.
    pub const FULL: Self = Self { tiles: 2_000, fullest: 32, rounds: ROUNDS };
}

/// Measures on a world; nothing where nothing grows.
///
/// # Errors
/// None today; timing functions share their signature.
pub fn bench(world: &World, load: Load) -> Result<Vec<BenchResult>, Failure> {
    let rings = Rings::new(world.field.grid(), 24, 1.0);
    let nursery = Nursery::new(open_world::landscape(world, &rings), world.projection.centre().lat_rad);
    let mut results = Vec::new();
    if !nursery.is_bare() {
        for tier in &TIERS {
            results.push(placing(&nursery, tier, load)?);
        }
    }
    Ok(results)
}

fn placing(nursery: &Nursery, tier: &Tier, load: Load) -> Result<BenchResult, Failure> {
    let grid = *nursery.area().grid();
    let along = |length_m: f64| (length_m / tier.side_m).ceil() as usize;
    let (wide, high) = (along(grid.east_m() - grid.west_m), along(grid.south_m() - grid.north_m));
    // A step that has no common factor with the rows spreads them evenly.
    let stride = (wide * high / load.tiles.max(1)).max(1) | 1;
    let spread = (0..wide * high).step_by(stride).map(|at| TileIndex { x: (at % wide) as i32, z: (at / wide) as i32 });
    let mut once: Vec<(f64, TileIndex, Vec<Plant>)> = spread
        .map(|tile| {
            let planted = nursery.plants(tier, tile, 1.0);
            (planted.took_ms, tile, planted.plants)
        })
        .collect();
    let times_ms = sorted(&once.iter().map(|(ms, ..)| *ms).collect::<Vec<_>>());
    let count = once.len();
    once.sort_by_key(|(_, tile, plants)| (usize::MAX - plants.len(), *tile));
    once.truncate(load.fullest.max(1));
    let mean = |sum_ms: f64| sum_ms / once.len() as f64;
    let mut worst_ms = vec![f64::INFINITY; once.len()];
    let values = interleave::<Failure>(
        WARM_UPS,
        load.rounds,
        &mut [
            &mut || {
                let mut sum_ms = 0.0;
                for ((_, tile, _), least_ms) in once.iter().zip(&mut worst_ms) {
                    let took_ms = black_box(nursery.plants(tier, *tile, 1.0)).took_ms;
                    *least_ms = least_ms.min(took_ms);
                    sum_ms += took_ms;
                }
                Ok(mean(sum_ms))
            },
            &mut || Ok(mean(once.iter().map(|(_, tile, plants)| floor_ms(nursery, tier, *tile, plants)).sum())),
        ],
    )?;
    let [ours, floor] = values.as_slice() else { return Ok(BenchResult::default()) };
    let plants: usize = once.iter().map(|(.., plants)| plants.len()).sum();
    let [middle, most] = [0.5, 0.99].map(|at| share(&times_ms, at));
    let note = format!(
        "the {} fullest, {:.0} plants of {} bytes each on average, slowest at its best {:.2} ms; {count} tiles spread over \
         the world, once each: median {middle:.2}, p99 {most:.2}, worst {:.2} ms",
        once.len(),
        plants as f64 / once.len() as f64,
        size_of::<Plant>(),
        worst_ms.iter().copied().fold(0.0, f64::max),
        times_ms.last().copied().unwrap_or(f64::NAN),
    );
    let name = format!("plants of a tile of {} km", tier.side_m * 1e-3);
    let floor = Against { name: "cover of every cell, ground under every plant", version: OWN, values: floor };
    Ok(beside(&name, "ms of a processor", Better::Less, ours, floor, note))
}

fn floor_ms(nursery: &Nursery, tier: &Tier, tile: TileIndex, plants: &[Plant]) -> f64 {
    let corner = corner_m(nursery.area().grid(), tier.side_m, tile);
    let before = thread_time::spent();
    for row in 0..tier.cells {
        for column in 0..tier.cells {
            let at = corner + DVec2::new(f64::from(column), f64::from(row)) * tier.cell_m();
            black_box(nursery.cover().class_at(at.x, at.y));
        }
    }
    for plant in plants {
        let at = plant.plan_m(tier, corner);
        black_box(nursery.area().height_and_normal(at.x, at.y));
    }
    thread_time::spent().saturating_sub(before).as_secs_f64() * 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_population_is_measured() {
        let world = crate::bench::tests::tiny_world();
        let results = bench(&world, Load { tiles: 5, fullest: 2, rounds: 2 }).unwrap();
        assert_eq!(results.len(), TIERS.len());
        assert!(results.iter().all(|result| result.ours > 0.0 && result.rounds == 2), "{results:?}");
    }
}
