//! Areas of water: which are lakes that shape the ground, and which only cover it.
//!
//! A lake is still water that is at least a post step wide, by [`width_m`], and holds at least one post, or one whose
//! level a file states: its posts are set to its level by [`lake_bake`]. Smaller water would carve a pit of a post's
//! size where there is a pond of a tenth of it, and a river's area has no one level: both are areas with the cover
//! water, and the ground is left as it is.

use super::kind::{Counts, Kind};
use super::place::signed_area_m2;
use crate::features::cover::CoverClass;
use crate::features::lake_bake::{self, Outline, TAPER_POSTS};
use crate::features::lakes::Lakes;
use crate::features::model::LandArea;
use crate::grid::Grid;
use crate::store::LakeInfo;
use glam::DVec2;

/// An area of water before it is known what it does to the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenWater {
    /// What it is counted as.
    pub kind: Kind,
    /// Its name; may be empty.
    pub name: String,
    /// Its level, if a file states it.
    pub level_m: Option<f64>,
    /// Whether it can have one level.
    pub still: bool,
    /// Outline and islands.
    pub rings: Vec<Vec<DVec2>>,
}

/// Outlines and levels are whole millimetres: so few digits that text keeps them to the bit.
const PER_METRE: f64 = 1000.0;

/// Sets lakes into the ground; returns them, what is said of them, and the water that is none.
pub fn set_lakes(
    waters: Vec<OpenWater>,
    grid: &Grid,
    heights_m: &mut [f32],
    counts: &mut Counts,
) -> (Lakes, Vec<LakeInfo>, Vec<LandArea>) {
    let (mut lakes, mut level_from, mut areas) = (Vec::new(), Vec::new(), Vec::new());
    for water in waters {
        let wide = width_m(&water.rings) >= grid.step_m;
        if water.level_m.is_some() || (water.still && wide) {
            let rings = water.rings.iter().map(|ring| rounded(ring)).filter(|ring| ring.len() >= 3).collect();
            let outline = Outline { name: water.name, level_m: water.level_m, rings };
            if let Some(lake) = lake_bake::with_level(outline, grid, heights_m) {
                lakes.push(lake);
                level_from.push(if water.level_m.is_some() { "file" } else { "median of the raster inside" });
                continue;
            }
        }
        let why = if water.still { "kept as cover: narrower than a post step" } else { "kept as cover: running water" };
        counts.note(water.kind, why);
        areas.push(LandArea { cover: CoverClass::Water, rings: water.rings });
    }
    let lakes = Lakes::new(lakes);
    let posts = lake_bake::burn(&lakes, grid, heights_m);
    let infos = lakes.lakes().iter().zip(level_from).zip(posts).map(|((lake, from), posts)| LakeInfo {
        name: lake.name.clone(),
        level_m: lake.level_m,
        level_from: from.into(),
        posts,
        taper_m: TAPER_POSTS * grid.step_m,
    });
    let infos = infos.collect();
    (lakes, infos, areas)
}

/// Width of an area: four times its area by its outline's length, which is a square's side and a circle's diameter.
/// Islands take from the area and add to the shore.
fn width_m(rings: &[Vec<DVec2>]) -> f64 {
    let mut sizes: Vec<f64> = rings.iter().map(|ring| signed_area_m2(ring).abs()).collect();
    let length_m: f64 =
        rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1))).map(|(a, b)| a.distance(*b)).sum();
    sizes.sort_by(f64::total_cmp);
    // The largest ring is an outline; smaller ones count as islands only if they are inside, which few are not.
    let area_m2 = sizes.pop().unwrap_or(0.0);
    if length_m > 0.0 { 4.0 * area_m2 / length_m } else { 0.0 }
}

fn rounded(ring: &[DVec2]) -> Vec<DVec2> {
    let mut ring: Vec<DVec2> = ring.iter().map(|at| (*at * PER_METRE).round() / PER_METRE).collect();
    ring.dedup();
    ring
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side_m: f64) -> Vec<Vec<DVec2>> {
        let corner = |x, z| DVec2::new(x, z) * side_m;
        vec![vec![corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)]]
    }

    #[test]
    fn only_still_water_wider_than_a_step_shapes_the_ground() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let water = |side_m, still, level_m| OpenWater {
            kind: Kind::Lakes,
            name: String::new(),
            level_m,
            still,
            rings: square(side_m),
        };
        let lakes = |water: OpenWater| {
            let mut heights: Vec<f32> = (0..grid.posts()).map(|i| i as f32).collect();
            let before = heights.clone();
            let (lakes, infos, areas) = set_lakes(vec![water], &grid, &mut heights, &mut Counts::default());
            assert_eq!((lakes.lakes().len(), infos.len(), areas.len()), (infos.len(), infos.len(), 1 - infos.len()));
            assert_eq!(heights == before, infos.is_empty());
            infos.len()
        };
        assert!((width_m(&square(300.0)) - 300.0).abs() < 1e-9);
        assert_eq!(lakes(water(300.0, true, None)), 1);
        assert_eq!(lakes(water(150.0, true, None)), 0);
        assert_eq!(lakes(water(900.0, false, None)), 0);
        assert_eq!(lakes(water(150.0, true, Some(7.0))), 1);
    }
}
