//! The ground map of a block: what the ground looks like from the air, one colour a texel, water folded in.
//!
//! 64 x 64 RGBA8: red, green, blue are the square roots of the linear albedo, so the dark colours of forest and water
//! keep their steps; alpha is 0..255 for a shore distance of +-[`SHORE_RAMP_M`], over 127 in water, so that a shader finds
//! a smooth shore line between texels; within [`LAND_COLOURED_TEXELS`] of the shore water has the land's colour, and
//! shaders their own. Texels 0 and 63 lie on the block's borders and are computed from the same posts
//! and the same noise by both neighbours: no seam.
//!
//! Colours follow [`crate::features::cover_rules`].

use crate::features::by_block::{KINDS, Strip, StripKind, coverage};
use crate::features::cover::{CLASSES, Cover, CoverClass, FROM_FEATURES};
use crate::features::cover_rules::{Belts, Site, belts, sea_m, site_at, sites};
use crate::features::imagery::Imagery;
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS, Grid};
pub use crate::noise::unit;
use crate::noise::{smooth, value_noise};

pub use crate::features::cover_rules::Climate;

/// Texels along a ground map.
pub const SIDE: u32 = 64;

/// Bytes of a ground map: all texels, then those of its one mip, each the mean of four.
pub const BYTES: usize = MAP_BYTES + MAP_BYTES / 4;

/// Bytes of the texels without the mip.
pub const MAP_BYTES: usize = (SIDE * SIDE * 4) as usize;

/// Shore distance at which alpha saturates, metres, at a post step of 200 m; scales with the step.
pub const SHORE_RAMP_M: f64 = 400.0;

/// How far from its outline a texel in water has the land's colour, texels: a place just outside is mixed from texels up to
/// 1.41 away, and hardly from those beyond this.
const LAND_COLOURED_TEXELS: f64 = 1.2;

/// How much farther from the shore a texel within an outline is taken to be where it is sea by rule as well, texels: more than
/// the above, so that the line along which a sea is closed is not seen.
const JOINED_TEXELS: f64 = 1.3;

/// What lies on the ground beside its water, as far as the ground map shows it.
pub struct Dress<'a> {
    /// What covers it.
    pub cover: &'a Cover,
    /// The block's strips.
    pub strips: &'a [Strip],
    /// What photographs say of it.
    pub imagery: Option<&'a Imagery>,
}

/// The ground map of a block. `shore_m` is the signed distance to the nearest water's edge at a world point (x, z),
/// negative in water, infinite where there is none; `sea_known` says whether a coastline decides there what is sea, and no
/// rule.
pub fn ground_map(
    field: &Field,
    block: BlockIndex,
    climate: &Climate,
    dress: &Dress,
    shore_m: &dyn Fn(f64, f64) -> f64,
    sea_known: &dyn Fn(f64, f64) -> bool,
) -> Box<[u8]> {
    let grid = field.grid();
    let texel_m = grid.block_m() / f64::from(SIDE - 1);
    let covered = has_features(dress.cover, grid, block);
    let coverage = KINDS.map(|kind| (kind, coverage(dress.strips, kind, texel_m as f32)));
    let sites = sites(field, block, climate);
    let (first_column, first_row) = (block.first_column(), block.first_row());
    let ramp_m = SHORE_RAMP_M * grid.step_m / 200.0;
    let photo = dress.imagery.and_then(|imagery| imagery.texels(grid, block));
    let mut texels = Vec::with_capacity(BYTES);
    for row in 0..SIDE {
        for column in 0..SIDE {
            let place = |texel: u32| f64::from(texel) * f64::from(CELLS) / f64::from(SIDE - 1);
            let (u, v) = (place(column), place(row));
            let site = site_at(&sites, u as f32, v as f32);
            let (x_m, z_m) = (
                grid.west_m + (first_column as f64 + u) * grid.step_m,
                grid.north_m + (first_row as f64 + v) * grid.step_m,
            );
            let outline = shore_m(x_m, z_m);
            let by_rule = !sea_known(x_m, z_m);
            let sea = if by_rule { sea_m(field, first_column, first_row, u, v) } else { f64::INFINITY };
            // Where the sea by rule meets that within an outline, the outline is no shore.
            let shore =
                if outline < 0.0 { sea.max(outline - JOINED_TEXELS * texel_m).min(outline) } else { outline.min(sea) };
            // Texels in water whose colour reaches over the outline have the land's: the water's own is drawn to the metre.
            let land = shore >= -LAND_COLOURED_TEXELS * texel_m;
            let mut albedo = albedo(site, climate, x_m, z_m, if land { shore.max(0.0) } else { shore } as f32);
            if land {
                if let Some(imagery) = dress.imagery {
                    let factors = imagery.factors(grid, x_m, z_m);
                    albedo = std::array::from_fn(|c| albedo[c] * factors[c]);
                }
                if covered {
                    albedo = with_features(albedo, dress.cover, x_m, z_m, texel_m, shore.max(0.0));
                }
                for (kind, shares) in coverage.iter().filter(|(_, shares)| !shares.is_empty()) {
                    albedo = mix(albedo, strip_colour(*kind), shares[(row * SIDE + column) as usize]);
                }
                // A photograph has roads, fields and woods already.
                if let Some(texel) = photo.as_ref().map(|photo| &photo[((row * SIDE + column) * 4) as usize..][..4]) {
                    let seen = std::array::from_fn(|c| (f32::from(texel[c]) / 255.0).powi(2));
                    albedo = mix(albedo, seen, f32::from(texel[3]) / 255.0);
                }
            }
            texels.extend(albedo.map(|c| (c.clamp(0.0, 1.0).sqrt() * 255.0).round() as u8));
            texels.push((127.5 - 127.5 * (shore / ramp_m).clamp(-1.0, 1.0)).round() as u8);
        }
    }
    add_mip(&mut texels);
    texels.into_boxed_slice()
}

/// Appends the mip: from some 37 km on a texel is less than a pixel high, and its contrast would only flicker.
fn add_mip(texels: &mut Vec<u8>) {
    let side = SIDE as usize;
    for at in 0..side * side / 4 {
        let (column, row) = (2 * (at % (side / 2)), 2 * (at / (side / 2)));
        for channel in 0..4 {
            let texel = |dc: usize, dr: usize| u16::from(texels[((row + dr) * side + column + dc) * 4 + channel]);
            texels.push(((texel(0, 0) + texel(1, 0) + texel(0, 1) + texel(1, 1) + 2) / 4) as u8);
        }
    }
}

/// Whether files of features decided any cell of a block or its rim, beside water.
fn has_features(cover: &Cover, grid: &Grid, block: BlockIndex) -> bool {
    let (west, north) = cover.place(grid.x_m(block.first_column()), grid.z_m(block.first_row()));
    let cells = (grid.block_m() / cover.cell_m()).round() as i64;
    let (first_column, first_row) = (west.round() as i64, north.round() as i64);
    let water = CoverClass::Water as u8 | FROM_FEATURES;
    !cover.cells().is_empty()
        && (first_row - 2..first_row + cells + 2).any(|row| {
            (first_column - 2..first_column + cells + 2).any(|column| {
                let cell = cover.cell(column, row);
                cell & FROM_FEATURES != 0 && cell != water
            })
        })
}

/// A colour by rule with what files say laid over it: each class by the share of the texel that it holds. The places
/// looked at are shaken a little, so that the cells' edges do not show.
fn with_features(by_rule: [f32; 3], cover: &Cover, x_m: f64, z_m: f64, texel_m: f64, shore_m: f64) -> [f32; 3] {
    const TAPS: i32 = 4;
    let shaken = |seed| 0.9 * cover.cell_m().min(60.0) * (f64::from(value_noise(x_m / 140.0, z_m / 140.0, seed)) - 0.5);
    let (x0_m, z0_m) = (x_m + shaken(61), z_m + shaken(67));
    let width_m = texel_m.max(cover.cell_m());
    let mut taps = [0_u8; CLASSES.len()];
    for i in 0..TAPS * TAPS {
        let away_m = |k: i32| ((f64::from(k) + 0.5) / f64::from(TAPS) - 0.5) * width_m;
        let (u, v) = cover.place(x0_m + away_m(i % TAPS), z0_m + away_m(i / TAPS));
        let cell = cover.cell(u.floor() as i64, v.floor() as i64);
        if cell & FROM_FEATURES != 0 {
            taps[CoverClass::of(cell) as usize] += 1;
        }
    }
    if shore_m < 2.0 * width_m {
        // Cells of a lake reach over its shore, which is drawn to the metre.
        taps[CoverClass::Water as usize] = 0;
    }
    taps[CoverClass::Unknown as usize] = 0;
    let mut colour = by_rule;
    let mut so_far =
        f32::from(u8::try_from(TAPS * TAPS).unwrap_or(1)) - taps.iter().map(|n| f32::from(*n)).sum::<f32>();
    for (class, &number) in CLASSES.iter().zip(&taps).filter(|(_, number)| **number > 0) {
        so_far += f32::from(number);
        colour = mix(colour, class_colour(*class, x_m, z_m, by_rule), f32::from(number) / so_far);
    }
    colour
}

/// Linear albedo of a class at a place.
fn class_colour(class: CoverClass, x_m: f64, z_m: f64, by_rule: [f32; 3]) -> [f32; 3] {
    let patch = 0.5 * value_noise(x_m / 310.0, z_m / 310.0, 71) + 0.5 * value_noise(x_m / 120.0, z_m / 120.0, 73);
    let even = match class {
        CoverClass::Unknown => return by_rule,
        CoverClass::Field => return field_colour(x_m, z_m).map(|c| c * (0.85 + 0.3 * patch)),
        CoverClass::BuiltUp => {
            // Roofs, yards, streets and gardens; no texel is like its neighbour.
            const PARTS: [[f32; 3]; 4] =
                [[0.175, 0.105, 0.080], [0.165, 0.158, 0.150], [0.085, 0.098, 0.050], [0.195, 0.170, 0.135]];
            let part =
                |seed| PARTS[(unit((x_m / 90.0).floor() as i32, (z_m / 90.0).floor() as i32, seed) * 3.999) as usize];
            return mix(mix(part(81), part(83), 0.5), [0.140, 0.125, 0.105], 0.45);
        }
        CoverClass::Water => return WATER,
        CoverClass::Conifer => FOREST,
        CoverClass::Broadleaf => BROADLEAF,
        CoverClass::MixedForest => MIXED_FOREST,
        CoverClass::Scrub => [0.105, 0.105, 0.055],
        CoverClass::Grass => [0.098, 0.122, 0.046],
        CoverClass::Rock => [0.150, 0.138, 0.125],
        CoverClass::Snow => SNOW,
        CoverClass::Sand => [0.340, 0.290, 0.210],
        CoverClass::Paved => [0.150, 0.148, 0.145],
    };
    even.map(|c| c * (0.80 + 0.40 * patch))
}

/// Linear albedo of the trees that grow by rule.
fn wood_colour(belts: &Belts, climate: &Climate) -> [f32; 3] {
    match belts.trees(climate) {
        CoverClass::Broadleaf => BROADLEAF,
        CoverClass::MixedForest => MIXED_FOREST,
        _ => FOREST,
    }
}

/// Running water and still water that is no lake, from the air.
const WATER: [f32; 3] = [0.024, 0.052, 0.055];

fn strip_colour(kind: StripKind) -> [f32; 3] {
    match kind {
        StripKind::Water => WATER,
        StripKind::Gravel => [0.230, 0.200, 0.165],
        StripKind::Asphalt => [0.085, 0.085, 0.088],
        StripKind::Concrete => [0.225, 0.220, 0.205],
    }
}

// Of closed forest seen from far, the shade between the crowns included; nearer by, trees stand on it.
const FOREST: [f32; 3] = [0.026, 0.040, 0.019];
const BROADLEAF: [f32; 3] = [0.041, 0.061, 0.022];
const MIXED_FOREST: [f32; 3] = [0.033, 0.050, 0.020];
const SNOW: [f32; 3] = [0.78, 0.80, 0.83];

/// Linear albedo by the belts.
fn albedo(site: Site, climate: &Climate, x_m: f64, z_m: f64, shore_m: f32) -> [f32; 3] {
    const DESERT: [f32; 3] = [0.30, 0.235, 0.155];
    const SCRUB: [f32; 3] = [0.150, 0.125, 0.080];
    const CLAY: [f32; 3] = [0.400, 0.340, 0.255];
    const STEPPE: [f32; 3] = [0.205, 0.170, 0.085];
    const MEADOW: [f32; 3] = [0.100, 0.125, 0.042];
    const TUNDRA: [f32; 3] = [0.150, 0.130, 0.080];
    const SCREE: [f32; 3] = [0.200, 0.175, 0.150];
    const ROCK: [f32; 3] = [0.085, 0.075, 0.068];
    const ICE: [f32; 3] = [0.56, 0.65, 0.72];
    const SHALLOW: [f32; 3] = [0.030, 0.085, 0.090];
    const DEEP: [f32; 3] = [0.008, 0.030, 0.048];
    const BEACH: [f32; 3] = [0.27, 0.235, 0.175];

    if shore_m < 0.0 {
        return mix(SHALLOW, DEEP, smooth(0.0, 1_400.0, -shore_m));
    }
    let belts = belts(&site, climate, x_m, z_m, shore_m);
    // Semi-desert is gravel, pale clay pans and dark scrub.
    let mut colour = mix(mix(DESERT, SCRUB, 0.7 * belts.scrub), CLAY, 0.8 * belts.clay);
    colour = mix(colour, STEPPE, belts.steppe);
    colour = mix(colour, MEADOW, belts.meadow);
    colour = mix(colour, field_colour(x_m, z_m), 0.85 * belts.tilled);
    let wood = wood_colour(&belts, climate);
    colour = mix(colour, wood, 0.92 * belts.forest);
    colour = mix(colour, TUNDRA, belts.tundra);
    colour = mix(colour, SCREE, belts.scree);
    colour = mix(colour, ROCK, belts.rock);
    colour = mix(colour, mix(SNOW, ICE, belts.ice), belts.snow);
    // A strip of sand, narrower than what the cover takes for shore, and none where the shore is steep.
    let sand = 0.75 * (1.0 - smooth(10.0, 130.0, shore_m)) * (1.0 - smooth(0.05, 0.16, site.steep));
    colour = mix(colour, BEACH, sand.min(belts.beach));
    // No two patches of one cover are the same shade; snow hardly varies.
    let uneven = 0.34 * (belts.fine - 0.5) + 0.18 * (belts.middle - 0.5) + 0.30 * (belts.gully - 0.5);
    let shade = 1.0 + (1.0 - 0.8 * belts.snow) * uneven;
    colour.map(|c| c * shade)
}

/// A patchwork of fields, 450 by 330 m, turned against the grid: green crops, stubble, fallow.
fn field_colour(x_m: f64, z_m: f64) -> [f32; 3] {
    const CROPS: [[f32; 3]; 5] = [
        [0.055, 0.100, 0.025],
        [0.085, 0.120, 0.035],
        [0.230, 0.190, 0.085],
        [0.160, 0.140, 0.070],
        [0.120, 0.095, 0.065],
    ];
    // 20 degrees.
    let (along, across) = (0.9397 * x_m + 0.3420 * z_m, -0.3420 * x_m + 0.9397 * z_m);
    let (column, row) = ((along / 450.0).floor() as i32, (across / 330.0).floor() as i32);
    CROPS[(unit(column, row, 77) * CROPS.len() as f32) as usize % CROPS.len()]
}

fn mix(a: [f32; 3], b: [f32; 3], part: f32) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::by_block::StripsByBlock;
    use crate::features::cover_bake::bake_cover;
    use crate::features::lakes::Lakes;
    use crate::features::model::{Features, LandArea, Road, RoadClass};
    use crate::{Grid, synthetic};
    use glam::DVec2;

    /// A wood over the middle of four blocks, a town west of it, and a road through all.
    fn dressed(field: &Field, climate: &Climate) -> (Features, Cover) {
        let square = |x: f64, z: f64, half_m: f64| {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            vec![corners.map(|(u, v)| DVec2::new(x + u * half_m, z + v * half_m)).to_vec()]
        };
        let areas = vec![
            LandArea { cover: CoverClass::Broadleaf, rings: square(300.0, -2_500.0, 2_000.0) },
            LandArea { cover: CoverClass::BuiltUp, rings: square(-3_000.0, -3_000.0, 600.0) },
        ];
        let line = vec![DVec2::new(-5_000.0, -3_000.0), DVec2::new(5_000.0, -1_500.0)];
        let road = Road { class: RoadClass::Motorway, width_m: 24.0, paved: true, tunnel: false, bridge: false, line };
        let features = Features { areas, roads: vec![road], ..Features::default() };
        let cover = bake_cover(field, &Lakes::default(), &features, climate);
        (features, cover)
    }

    #[test]
    fn an_area_has_its_colour_and_a_soft_edge() {
        let field = synthetic::ridges(Grid::centred(200.0, 2, 2).unwrap(), 4);
        let climate = Climate::new(0.74, 1_500.0);
        let (side_m, edge_m) = (field.grid().block_m(), field.grid().block_m() * 24.47 / f64::from(SIDE - 1));
        let ring = [(0.0, -side_m), (edge_m, -side_m), (edge_m, 0.0), (0.0, 0.0)].map(DVec2::from).to_vec();
        let areas = vec![LandArea { cover: CoverClass::Snow, rings: vec![ring] }];
        let features = Features { areas, ..Features::default() };
        let cover = bake_cover(&field, &Lakes::default(), &features, &climate);
        let dress = Dress { cover: &cover, strips: &[], imagery: None };
        let map = ground_map(&field, BlockIndex { x: 1, z: 0 }, &climate, &dress, &|_, _| f64::INFINITY, &|_, _| false);
        let green = |column: usize, row: usize| map[(row * SIDE as usize + column) * 4 + 1];
        let mut between = 0;
        for row in 2..62 {
            // Snow is 0.8 times 0.8 at its darkest, 204 as a square root; the edge is at texel 24.
            assert!(green(10, row) > 195 && green(40, row) < 190, "{} {}", green(10, row), green(40, row));
            // A tenth of the snow already tells a texel from what is beside it.
            let beside = green(40, row) + 10;
            between += usize::from((22..28).any(|column| (beside..195).contains(&green(column, row))));
        }
        assert!(between > 20, "{between} rows have a texel of the edge between snow and what is beside it");
    }

    #[test]
    fn neighbours_agree_on_their_border() {
        let field = synthetic::ridges(Grid::centred(200.0, 2, 2).unwrap(), 4);
        let climate = Climate::new(0.74, 1_500.0);
        let lake = |x: f64, z: f64| x.hypot(z - 900.0) - 2_000.0;
        let (features, cover) = dressed(&field, &climate);
        let strips = StripsByBlock::new(field.grid(), &features);
        let map = |x, z| {
            let block = BlockIndex { x, z };
            ground_map(
                &field,
                block,
                &climate,
                &Dress { cover: &cover, strips: strips.of(block), imagery: None },
                &lake,
                &|_, _| false,
            )
        };
        let (nw, ne, sw) = (map(0, 0), map(1, 0), map(0, 1));
        let texel = |map: &[u8], column: u32, row: u32| -> [u8; 4] {
            let at = ((row * SIDE + column) * 4) as usize;
            map[at..at + 4].try_into().unwrap()
        };
        let mut wet = 0;
        for i in 0..SIDE {
            // The same posts and noise; a last digit may differ as each block counts cells from its own corner.
            for (a, b) in [(texel(&nw, SIDE - 1, i), texel(&ne, 0, i)), (texel(&nw, i, SIDE - 1), texel(&sw, i, 0))] {
                assert!(a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1), "{a:?} and {b:?}");
                wet += i32::from(a[3] > 127);
            }
        }
        assert!(wet > 0, "the test's lake crosses the border");
    }

    #[test]
    fn belts_stand_in_order() {
        let climate = Climate::new(42.4f64.to_radians(), 2_400.0);
        assert!((3_600.0..4_100.0).contains(&climate.snow_line_m), "{}", climate.snow_line_m);
        let brightness = |height_m: f32, cold: f32| {
            let site = Site { height_m, steep: 0.2, cold, ..Site::default() };
            let mut sum = 0.0;
            for i in 0..100 {
                sum += albedo(site, &climate, f64::from(i) * 977.0, f64::from(i) * 1_313.0, f32::INFINITY)[1];
            }
            sum / 100.0
        };
        let (basin, forest, summit) = (brightness(800.0, 0.0), brightness(2_400.0, 0.6), brightness(5_000.0, 0.0));
        assert!(forest < basin && basin < summit, "{forest} {basin} {summit}");
    }
}
