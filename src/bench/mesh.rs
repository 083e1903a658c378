//! Building blocks: index lists, masks, payloads; microseconds a block on one core.
//!
//! Processor time of the one thread that does it, over the same sample of blocks spread over the world. Yardstick of an index list: copying the list of
//! level 0, what a renderer without levels would do at most.

use super::OWN;
use super::statistics::{Against, Better, ROUNDS, WARM_UPS, alone, beside, interleave};
use crate::failure::Failure;
use crate::open_world;
use crate::report::BenchResult;
use glam::{DVec2, DVec3};
use std::hint::black_box;
use terrain::block::mask::{Mask, block_posts};
use terrain::block::{Landscape, Rings, light, mesh};
use terrain::edit::{Changed, Crater, Edit};
use terrain::store::World;
use terrain::thread_time;
use terrain::{BlockIndex, CELLS, Grid};

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// Blocks.
    pub blocks: usize,
    /// Rounds that count.
    pub rounds: u32,
}

impl Load {
    /// What the program measures with.
    pub const FULL: Self = Self { blocks: 48, rounds: ROUNDS };
}

/// Measures on a world.
///
/// # Errors
/// None today; timing functions share their signature.
pub fn bench(world: &World, load: Load) -> Result<Vec<BenchResult>, Failure> {
    let field = &world.field;
    let rings = Rings::new(field.grid(), 24, 1.0);
    let landscape = open_world::landscape(world, &rings);
    let all: Vec<BlockIndex> = field.grid().blocks().collect();
    // A step that has no common factor with the rows spreads them evenly.
    let stride = (all.len() / load.blocks.max(1)).max(1) | 1;
    let blocks: Vec<BlockIndex> = all.iter().copied().step_by(stride).take(load.blocks).collect();
    let posts: Vec<_> = blocks.iter().map(|&block| block_posts(field, block)).collect();
    let masks: Vec<Mask> = blocks.iter().map(|&block| landscape.masks.mask(field.grid(), block, 1)).collect();
    let to_sun = DVec3::new(0.5, 0.6, 0.6).normalize();
    let count = blocks.len();
    let pyramid = landscape.ground.pyramid();
    let (whole, none) = (Mask::all(), Mask::NONE);
    let low_sun = terrain::frame::direction(2.0, 5f64.to_radians());
    let craters: Vec<Edit> = blocks.iter().map(|&block| crater(field.grid(), block)).collect();
    // Lists take a microsecond or ten: many times, so that the clock's own step does not show.
    let lists = 16 * count;
    let values = interleave::<Failure>(
        WARM_UPS,
        load.rounds,
        &mut [
            &mut || Ok(each_us(lists, |_| mesh::indices(&whole, None))),
            &mut || Ok(each_us(lists, |_| mesh::indices(&none, None))),
            &mut || Ok(each_us(lists, |at| mesh::indices(&masks[at % count], None))),
            &mut || Ok(each_us(lists, |_| mesh::level_0().clone())),
            &mut || Ok(each_us(count, |at| rings.limits_m.map(|limit_m| Mask::for_limit(&posts[at], limit_m)))),
            &mut || Ok(each_us(count, |at| landscape.payload(blocks[at], to_sun))),
            &mut || Ok(each_us(count, |at| light::light_map(field, pyramid, blocks[at], to_sun))),
            &mut || Ok(each_us(count, |at| light::light_map(field, pyramid, blocks[at], low_sun))),
            &mut || Ok(each_us(count, |at| landscape.edited(std::slice::from_ref(&craters[at])))),
            &mut || Ok(each_us(1, |_| field.heights_m().to_vec())),
            &mut || Ok(each_us(count, |at| whole_edit(&landscape, &craters[at], to_sun))),
        ],
    )?;
    let [level_0, level_1, mixed, copy, mask, payload, light, low, edit, posts_copy, whole] = values.as_slice() else {
        return Ok(Vec::new());
    };
    let fine: u32 = masks.iter().map(Mask::fine).sum();
    let sub_blocks = (terrain::block::mask::SUBS * terrain::block::mask::SUBS) as f64;
    let share = 100.0 * f64::from(fine) / (count as f64 * sub_blocks);
    let copied = Against { name: "copy of the level-0 list", version: OWN, values: copy };
    let all_posts = Against { name: "copy of all posts", version: OWN, values: posts_copy };
    let reached = craters.iter().map(|edit| whole_edit(&landscape, edit, to_sun)).sum::<usize>() as f64 / count as f64;
    let (less, us) = (Better::Less, "us a block");
    // The rest of a payload is heights, box and ground map; copies of posts are microseconds.
    let rest: Vec<f64> = payload.iter().zip(light).map(|(payload, light)| payload - light).collect();
    Ok(vec![
        beside("indices, level 0", us, less, level_0, copied, "1800 triangles"),
        beside("indices, level 1", us, less, level_1, copied, "510 triangles"),
        beside("indices, mixed", us, less, mixed, copied, format!("1 px ring; {share:.0} % of sub-blocks fine")),
        alone("masks of three rings", us, mask, format!("{count} blocks")),
        alone("payload", us, payload, format!("{count} blocks")),
        alone("payload, light map", us, light, "normals and shadows"),
        alone("payload, light map, sun at 5 degrees", us, low, "longer shadows to look for"),
        alone("payload, ground map and heights", us, &rest, "payload less light map"),
        beside("crater: posts, pyramid, masks", "us an edit", less, edit, all_posts, "radius of three steps"),
        alone("crater: all that it reaches", "us an edit", whole, format!("{reached:.1} blocks an edit; no shadows")),
    ])
}

/// A crater of three steps in a block.
fn crater(grid: &Grid, block: BlockIndex) -> Edit {
    let at = |first: i64| first + i64::from(CELLS) / 3;
    let centre_m = DVec2::new(grid.x_m(at(block.first_column())), grid.z_m(at(block.first_row())));
    Edit::Crater(Crater::simple(centre_m, 3.0 * grid.step_m))
}

/// Makes an edit and every payload and near mesh that it reaches by more than a shadow; says how many blocks.
fn whole_edit(landscape: &Landscape, edit: &Edit, to_sun: DVec3) -> usize {
    let Ok((landscape, changed)) = landscape.edited(std::slice::from_ref(edit)) else { return 0 };
    let blocks = changed.blocks(landscape.ground.field().grid(), Changed::reaches_payload);
    for block in &blocks {
        black_box((landscape.payload(*block, to_sun), landscape.mesh(*block, 1)));
    }
    blocks.len()
}

/// Microseconds for each of so many pieces of work.
fn each_us<T>(count: usize, mut work: impl FnMut(usize) -> T) -> f64 {
    let start = thread_time::spent();
    for at in 0..count {
        black_box(work(at));
    }
    (thread_time::spent() - start).as_secs_f64() * 1e6 / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_a_block_is_measured() {
        let world = crate::bench::tests::tiny_world();
        let results = bench(&world, Load { blocks: 3, rounds: 2 }).unwrap();
        assert_eq!(results.len(), 10);
        assert!(results.iter().all(|result| result.rounds == 2 && result.ours.is_finite()), "{results:?}");
    }
}
