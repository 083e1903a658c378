//! The ground map of a block: what the ground looks like from the air, one colour a texel, water folded in.
//!
//! 64 x 64 RGBA8: red, green, blue are the square roots of the linear albedo, so the dark colours of forest and water
//! keep their steps; alpha is 0..255 for a shore distance of +-[`SHORE_RAMP_M`], over 127 in water, so that a shader finds
//! a smooth shore line between texels. Texels 0 and 63 lie on the block's borders and are computed from the same posts
//! and the same noise by both neighbours: no seam.
//!
//! Colours follow [`crate::features::cover_rules`].

use crate::features::cover_rules::{Site, belts, sea_m, site_at, sites};
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS};
use crate::noise::smooth;
pub use crate::noise::unit;

pub use crate::features::cover_rules::Climate;

/// Texels along a ground map.
pub const SIDE: u32 = 64;

/// Bytes of a ground map: all texels, then those of its one mip, each the mean of four.
pub const BYTES: usize = MAP_BYTES + MAP_BYTES / 4;

/// Bytes of the texels without the mip.
pub const MAP_BYTES: usize = (SIDE * SIDE * 4) as usize;

/// Shore distance at which alpha saturates, metres, at a post step of 200 m; scales with the step.
pub const SHORE_RAMP_M: f64 = 400.0;

/// The ground map of a block. `shore_m` is the signed distance to the nearest water's edge at a world point (x, z),
/// negative in water, infinite where there is none.
pub fn ground_map(field: &Field, block: BlockIndex, climate: &Climate, shore_m: &dyn Fn(f64, f64) -> f64) -> Box<[u8]> {
    let grid = field.grid();
    let sites = sites(field, block, climate);
    let (first_column, first_row) = (block.first_column(), block.first_row());
    let ramp_m = SHORE_RAMP_M * grid.step_m / 200.0;
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
            let shore = shore_m(x_m, z_m).min(sea_m(field, first_column, first_row, u, v));
            let albedo = albedo(site, climate, x_m, z_m, shore as f32);
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

/// Linear albedo by the belts.
fn albedo(site: Site, climate: &Climate, x_m: f64, z_m: f64, shore_m: f32) -> [f32; 3] {
    const DESERT: [f32; 3] = [0.30, 0.235, 0.155];
    const SCRUB: [f32; 3] = [0.150, 0.125, 0.080];
    const CLAY: [f32; 3] = [0.400, 0.340, 0.255];
    const STEPPE: [f32; 3] = [0.205, 0.170, 0.085];
    const MEADOW: [f32; 3] = [0.100, 0.125, 0.042];
    const FOREST: [f32; 3] = [0.020, 0.036, 0.017];
    const TUNDRA: [f32; 3] = [0.150, 0.130, 0.080];
    const SCREE: [f32; 3] = [0.200, 0.175, 0.150];
    const ROCK: [f32; 3] = [0.085, 0.075, 0.068];
    const SNOW: [f32; 3] = [0.78, 0.80, 0.83];
    const ICE: [f32; 3] = [0.56, 0.65, 0.72];
    const SHALLOW: [f32; 3] = [0.030, 0.085, 0.090];
    const DEEP: [f32; 3] = [0.008, 0.030, 0.048];
    const BEACH: [f32; 3] = [0.33, 0.29, 0.22];

    if shore_m < 0.0 {
        return mix(SHALLOW, DEEP, smooth(0.0, 1_400.0, -shore_m));
    }
    let belts = belts(&site, climate, x_m, z_m, shore_m);
    // Semi-desert is gravel, pale clay pans and dark scrub.
    let mut colour = mix(mix(DESERT, SCRUB, 0.7 * belts.scrub), CLAY, 0.8 * belts.clay);
    colour = mix(colour, STEPPE, belts.steppe);
    colour = mix(colour, MEADOW, belts.meadow);
    colour = mix(colour, field_colour(x_m, z_m), 0.85 * belts.tilled);
    colour = mix(colour, FOREST, 0.92 * belts.forest);
    colour = mix(colour, TUNDRA, belts.tundra);
    colour = mix(colour, SCREE, belts.scree);
    colour = mix(colour, ROCK, belts.rock);
    colour = mix(colour, mix(SNOW, ICE, belts.ice), belts.snow);
    colour = mix(colour, BEACH, 0.8 * belts.beach);
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
    use crate::{Grid, synthetic};

    #[test]
    fn neighbours_agree_on_their_border() {
        let field = synthetic::ridges(Grid::centred(200.0, 2, 2).unwrap(), 4);
        let climate = Climate::new(0.74, 1_500.0);
        let lake = |x: f64, z: f64| x.hypot(z - 900.0) - 2_000.0;
        let map = |x, z| ground_map(&field, BlockIndex { x, z }, &climate, &lake);
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
