//! The ground map of a block: what the ground looks like from the air, one colour a texel, water folded in.
//!
//! 64 x 64 RGBA8: red, green, blue are the square roots of the linear albedo, so the dark colours of forest and water
//! keep their steps; alpha is 0..255 for a shore distance of +-[`SHORE_RAMP_M`], over 127 in water, so that a shader finds
//! a smooth shore line between texels. Texels 0 and 63 lie on the block's borders and are computed from the same posts
//! and the same noise by both neighbours: no seam.
//!
//! Colours follow altitudinal belts by rule: from height against the snow line, slope, aspect, hollows and noise. The
//! snow line falls with latitude and rises with the mass of the mountains (the *Massenerhebung* effect), which is why
//! the climate takes the world's mean height. Sources: belts of the inner Tian Shan (semi-desert, steppe to 2,200 m,
//! spruce on north slopes 1,700 to 2,900 m, alpine meadow to 3,500 m, snow from 3,900 m); snow lines by latitude after
//! C. Troll, Die dreidimensionale Landschaftsgliederung der Erde, 1962, read off coarsely.

use super::light::normal;
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS};

/// Texels along a ground map.
pub const SIDE: u32 = 64;

/// Bytes of a ground map: all texels, then those of its one mip, each the mean of four.
pub const BYTES: usize = MAP_BYTES + MAP_BYTES / 4;

/// Bytes of the texels without the mip.
pub const MAP_BYTES: usize = (SIDE * SIDE * 4) as usize;

/// Shore distance at which alpha saturates, metres, at a post step of 200 m; scales with the step.
pub const SHORE_RAMP_M: f64 = 400.0;

/// What the belts depend on besides the place itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Climate {
    /// Height above which snow stays on level ground in summer, metres.
    pub snow_line_m: f32,
    /// 0 wet and green down low, 1 semi-desert down low.
    pub dryness: f32,
    /// +1 where north slopes are the cold ones, -1 in the southern hemisphere.
    pub cold_side: f32,
}

impl Climate {
    /// From the latitude and mean height of a world.
    pub fn new(latitude_rad: f64, mean_height_m: f64) -> Self {
        let latitude_deg = latitude_rad.to_degrees().abs().min(90.0);
        // Level-ground snow lines over lowlands, by latitude.
        let table = [
            (0.0, 4_700.0),
            (25.0, 5_000.0),
            (35.0, 3_900.0),
            (42.0, 3_050.0),
            (50.0, 2_600.0),
            (60.0, 1_500.0),
            (70.0, 700.0),
            (90.0, 0.0),
        ];
        let at = table.windows(2).find(|w| latitude_deg <= w[1].0).map_or(0.0, |w| {
            let part = (latitude_deg - w[0].0) / (w[1].0 - w[0].0);
            w[0].1 + part * (w[1].1 - w[0].1)
        });
        let mass_m = mean_height_m.clamp(0.0, 4_500.0);
        Self {
            snow_line_m: (at + 0.35 * mass_m) as f32,
            dryness: smooth(400.0, 2_000.0, mass_m as f32),
            cold_side: if latitude_rad < 0.0 { -1.0 } else { 1.0 },
        }
    }
}

/// What the rules read at a post.
#[derive(Clone, Copy, Default)]
struct Site {
    height_m: f32,
    /// Sine of the slope's angle.
    steep: f32,
    /// 1 on slopes that face the pole, -1 on those that face the sun.
    cold: f32,
    /// Above 0 in hollows, below on ridges; about 1 in a gully.
    hollow: f32,
    /// Down the slope: east and south, as long as the slope is steep.
    down: [f32; 2],
}

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

/// Sites of the block's posts, row by row.
fn sites(field: &Field, block: BlockIndex, climate: &Climate) -> Vec<Site> {
    let side = i64::from(CELLS) + 1;
    let mut sites = Vec::with_capacity((side * side) as usize);
    for row in block.first_row()..block.first_row() + side {
        for column in block.first_column()..block.first_column() + side {
            let here = field.post_m(column, row);
            if here.is_nan() {
                sites.push(Site::default());
                continue;
            }
            let n = normal(field, column, row);
            let around = [(3, 0), (-3, 0), (0, 3), (0, -3), (2, 2), (-2, 2), (2, -2), (-2, -2)]
                .map(|(dc, dr)| field.post_m(column + dc, row + dr))
                .map(|h| if h.is_nan() { here } else { h });
            let mean = around.iter().sum::<f32>() / around.len() as f32;
            let steep = (1.0 - n.y * n.y).max(0.0).sqrt() as f32;
            sites.push(Site {
                height_m: here,
                steep,
                cold: -n.z as f32 * climate.cold_side,
                // A dry bed in a plain is as much of a hollow as a gorge in the mountains.
                hollow: ((mean - here) / ((0.06 + 0.75 * steep) * field.grid().step_m as f32)).clamp(-2.0, 2.0),
                down: [n.x as f32, n.z as f32],
            });
        }
    }
    sites
}

/// Site between four posts, bilinear; `u`, `v` in cells from the block's north-west.
fn site_at(sites: &[Site], u: f32, v: f32) -> Site {
    let side = CELLS as usize + 1;
    let (column, row) = ((u as usize).min(side - 2), (v as usize).min(side - 2));
    let (east, south) = (u - column as f32, v - row as f32);
    let mix = |read: fn(&Site) -> f32| {
        let at = |dc: usize, dr: usize| read(&sites[(row + dr) * side + column + dc]);
        let (north, below) = (at(0, 0) + east * (at(1, 0) - at(0, 0)), at(0, 1) + east * (at(1, 1) - at(0, 1)));
        north + south * (below - north)
    };
    Site {
        height_m: mix(|s| s.height_m),
        steep: mix(|s| s.steep),
        cold: mix(|s| s.cold),
        hollow: mix(|s| s.hollow),
        down: [mix(|s| s.down[0]), mix(|s| s.down[1])],
    }
}

/// Stand-in shore distance of the sea: level ground at 0 m is water, half a cell around it is shore. A sea floor below
/// 0 m is drawn as the land that it is in the data.
fn sea_m(field: &Field, first_column: i64, first_row: i64, u: f64, v: f64) -> f64 {
    let (column, row) = (first_column + u as i64, first_row + v as i64);
    let step_m = field.grid().step_m;
    let level = |c: i64, r: i64| field.post_m(c, r).abs() < 0.5;
    let wet = |dc: i64, dr: i64| {
        let (c, r) = (column + dc, row + dr);
        let sea = level(c, r) && level(c - 1, r) && level(c + 1, r) && level(c, r - 1) && level(c, r + 1);
        if sea { 1.0 } else { 0.0 }
    };
    let (east, south) = (u.fract(), v.fract());
    let north = wet(0, 0) + east * (wet(1, 0) - wet(0, 0));
    let below = wet(0, 1) + east * (wet(1, 1) - wet(0, 1));
    let part = north + south * (below - north);
    if part > 0.0 { (0.75 - part) * 2.0 * step_m } else { f64::INFINITY }
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
    // Three noises: land forms, stands, patches. World coordinates, so that neighbours agree.
    let broad = noise(x_m / 2_900.0, z_m / 2_900.0, 1);
    let middle = noise(x_m / 830.0, z_m / 830.0, 2);
    let fine = noise(x_m / 260.0, z_m / 260.0, 3);
    let mottle = 0.5 * broad + 0.3 * middle + 0.2 * fine;
    // Gullies run down the slope: a noise smeared along it.
    let gully = streaks(x_m, z_m, site.down);

    let relative = site.height_m / climate.snow_line_m.max(300.0) + 0.05 * (mottle - 0.5) - 0.04 * site.cold;
    let wet = (0.45 - 0.55 * climate.dryness * (1.0 - smooth(0.30, 0.62, relative)))
        + 0.30 * site.cold
        + 0.16 * site.hollow
        + 0.55 * (mottle - 0.5)
        + 0.35 * (1.0 - smooth(0.0, 5_000.0, shore_m.max(0.0)));

    // Semi-desert is gravel, pale clay pans and dark scrub.
    let clay = smooth(0.56, 0.66, broad + 0.25 * (fine - 0.5)) * (1.0 - smooth(0.03, 0.08, site.steep));
    let scrub = smooth(0.50, 0.66, middle + 0.5 * (fine - 0.5));
    let mut colour = mix(mix(DESERT, SCRUB, 0.7 * scrub), CLAY, 0.8 * clay);
    colour = mix(colour, STEPPE, smooth(-0.1, 0.30, wet));
    colour = mix(colour, MEADOW, smooth(0.25, 0.60, wet));
    // Valley floors that hold water are tilled.
    let tilled =
        smooth(0.34, 0.44, wet) * (1.0 - smooth(0.025, 0.06, site.steep)) * (1.0 - smooth(0.45, 0.55, relative));
    colour = mix(colour, field_colour(x_m, z_m), 0.85 * tilled);
    let belt = smooth(0.40, 0.48, relative) * (1.0 - smooth(0.70, 0.76, relative));
    let low_forest = (1.0 - climate.dryness) * (1.0 - smooth(0.55, 0.64, relative)) * smooth(0.05, 0.14, site.steep);
    let stand = wet + 0.30 * (fine - 0.5) + 0.20 * (gully - 0.5);
    let forest = belt.max(low_forest) * smooth(0.44, 0.54, stand) * (1.0 - smooth(0.62, 0.75, site.steep));
    colour = mix(colour, FOREST, 0.92 * forest);
    colour = mix(colour, TUNDRA, smooth(0.74, 0.88, relative));
    let bare = smooth(0.78, 0.96, relative + 0.30 * site.steep + 0.12 * (gully - 0.5));
    colour = mix(colour, SCREE, bare);
    // Posts far apart and smooth sources flatten walls, so rock begins at slopes of 17 degrees.
    let wall = site.steep + 0.30 * (gully - 0.5) + 0.10 * (fine - 0.5) - 0.05 * site.hollow;
    let rock = smooth(0.30, 0.44, wall).max(bare * smooth(0.20, 0.36, wall));
    colour = mix(colour, ROCK, rock * (0.35 + 0.65 * smooth(0.55, 0.80, relative)));
    // Snow starts lower on cold slopes and in hollows, and slides off walls, less so the higher they stand.
    let cover = relative + 0.09 * site.cold + 0.035 * site.hollow + 0.10 * (fine - 0.5) + 0.05 * (gully - 0.5);
    let holds = 1.0 - 0.95 * smooth(0.32, 0.46, wall - 0.35 * (relative - 1.05).max(0.0));
    let snow = smooth(0.965, 1.035, cover) * holds;
    let old = smooth(0.3, 1.2, site.hollow) * (1.0 - smooth(1.2, 1.4, relative));
    colour = mix(colour, mix(SNOW, ICE, old), snow);
    colour = mix(colour, BEACH, (1.0 - smooth(60.0, 220.0, shore_m)) * (1.0 - smooth(0.1, 0.3, site.steep)) * 0.8);
    // No two patches of one cover are the same shade; snow hardly varies.
    let shade = 1.0 + (1.0 - 0.8 * snow) * (0.34 * (fine - 0.5) + 0.18 * (middle - 0.5) + 0.30 * (gully - 0.5));
    colour.map(|c| c * shade)
}

/// Noise smeared down a slope, 0..=1, mean 0.5; plain noise on level ground.
fn streaks(x_m: f64, z_m: f64, down: [f32; 2]) -> f32 {
    let steep = down[0].hypot(down[1]);
    let stride_m = f64::from(smooth(0.03, 0.2, steep)) * 70.0 / f64::from(steep.max(0.03));
    let (dx, dz) = (f64::from(down[0]) * stride_m, f64::from(down[1]) * stride_m);
    let sum: f32 =
        (-2..=2).map(|k| value_noise((x_m + dx * f64::from(k)) / 150.0, (z_m + dz * f64::from(k)) / 150.0, 5)).sum();
    // Means huddle around the middle; spread them again.
    (0.5 + 1.6 * (sum / 5.0 - 0.5)).clamp(0.0, 1.0)
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

/// 0 at `low` and below, 1 at `high` and above, smooth between.
fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Value noise of two octaves on a whole-number lattice, 0..=1.
fn noise(x: f64, z: f64, seed: u32) -> f32 {
    0.65 * value_noise(x, z, seed) + 0.35 * value_noise(x * 2.17 + 31.7, z * 2.17 - 17.3, seed ^ 0x5bd1_e995)
}

fn value_noise(x: f64, z: f64, seed: u32) -> f32 {
    let (x0, z0) = (x.floor(), z.floor());
    let at = |dx: i32, dz: i32| unit(x0 as i32 + dx, z0 as i32 + dz, seed);
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease((x - x0) as f32), ease((z - z0) as f32));
    let (north, south) = (at(0, 0) + u * (at(1, 0) - at(0, 0)), at(0, 1) + u * (at(1, 1) - at(0, 1)));
    north + v * (south - north)
}

/// A number in 0..1 of a lattice point (the finaliser of MurmurHash3, public domain, A. Appleby).
pub fn unit(x: i32, z: i32, seed: u32) -> f32 {
    let mut h =
        (x as u32).wrapping_mul(0x9E37_79B1) ^ (z as u32).wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    h ^= h >> 16;
    h = h.wrapping_mul(0x85EB_CA6B);
    h ^= h >> 13;
    h = h.wrapping_mul(0xC2B2_AE35);
    h ^= h >> 16;
    (h >> 8) as f32 / (1u32 << 24) as f32
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
        assert!(Climate::new(1.2, 300.0).snow_line_m < 1_500.0);
        assert_eq!(Climate::new(-0.6, 300.0).cold_side, -1.0);
    }
}
