//! What covers a place where no file says it: belts by rule, from height, slope, aspect, wetness and latitude.
//!
//! One function, [`belts`], weighs what may grow or lie at a place. The bake takes the [class](Belts::class) from it
//! and the ground map its colours, so that a wood that is drawn dark is a wood in the cover too.
//!
//! The snow line falls with latitude and rises with the mass of the mountains (the *Massenerhebung* effect), the more
//! the drier they are, which is why the climate takes the world's mean height. Sources: belts of the inner Tian Shan
//! (semi-desert, steppe to 2,200 m, spruce on north slopes 1,700 to 2,900 m, alpine meadow to 3,500 m, snow from
//! 3,900 m); snow lines by latitude after C. Troll, Die dreidimensionale Landschaftsgliederung der Erde, 1962; dry
//! lands after the B climates of M. Peel et al., Updated world map of the Koeppen-Geiger climate classification, 2007;
//! all read off coarsely.

use super::cover::CoverClass;
use crate::block::light::normal;
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS};
use crate::noise::{noise, smooth, value_noise};
use crate::projection::Geodetic;

/// What the belts depend on besides the place itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Climate {
    /// Height above which snow stays on level ground in summer, metres.
    pub snow_line_m: f32,
    /// 0 wet and green down low, 1 semi-desert down low.
    pub dryness: f32,
    /// +1 where north slopes are the cold ones, -1 in the southern hemisphere.
    pub cold_side: f32,
    /// 0 where broadleaved trees grow down low, 1 where only conifers do, below 0 where conifers hardly grow at all.
    pub boreal: f32,
}

/// Dry lands: latitude and longitude of the middle, half the height and width, degrees.
const DRY_LANDS: [[f64; 4]; 8] = [
    // Inner Asia, Iran, the Sahara with Arabia, the west of North America.
    [42.0, 80.0, 10.0, 35.0],
    [33.0, 57.0, 7.0, 12.0],
    [23.0, 20.0, 10.0, 40.0],
    [38.0, -112.0, 11.0, 9.0],
    // The Atacama, Patagonia, the Kalahari, Australia.
    [-25.0, -69.0, 10.0, 3.0],
    [-44.0, -69.0, 7.0, 4.0],
    [-25.0, 20.0, 8.0, 7.0],
    [-25.0, 130.0, 8.0, 16.0],
];

impl Climate {
    /// Of a world about a place, with its mean height.
    pub fn of(centre: Geodetic, mean_height_m: f64) -> Self {
        let away = |[lat, lon, height, width]: [f64; 4]| {
            ((centre.lat_deg() - lat) / height).hypot((centre.lon_deg() - lon) / width)
        };
        let away = DRY_LANDS.map(away).into_iter().fold(f64::INFINITY, f64::min);
        Self::with_dryness(centre.lat_rad, mean_height_m, 1.0 - smooth(0.85, 1.15, away as f32))
    }

    /// From the latitude and mean height alone: high land counts as dry.
    pub fn new(latitude_rad: f64, mean_height_m: f64) -> Self {
        Self::with_dryness(latitude_rad, mean_height_m, smooth(400.0, 2_000.0, mean_height_m as f32))
    }

    fn with_dryness(latitude_rad: f64, mean_height_m: f64, dryness: f32) -> Self {
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
        let latitude_deg = latitude_deg as f32;
        Self {
            snow_line_m: (at + (0.1 + 0.25 * f64::from(dryness)) * mass_m) as f32,
            dryness,
            cold_side: if latitude_rad < 0.0 { -1.0 } else { 1.0 },
            boreal: smooth(52.0, 62.0, latitude_deg) - (1.0 - smooth(18.0, 32.0, latitude_deg)),
        }
    }
}

/// What the rules read at a post.
#[derive(Clone, Copy, Default)]
pub(crate) struct Site {
    pub height_m: f32,
    /// Sine of the slope's angle.
    pub steep: f32,
    /// 1 on slopes that face the pole, -1 on those that face the sun.
    pub cold: f32,
    /// Above 0 in hollows, below on ridges; about 1 in a gully.
    pub hollow: f32,
    /// Down the slope: east and south, as long as the slope is steep.
    pub down: [f32; 2],
}

/// Sites of the block's posts, row by row.
pub(crate) fn sites(field: &Field, block: BlockIndex, climate: &Climate) -> Vec<Site> {
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
pub(crate) fn site_at(sites: &[Site], u: f32, v: f32) -> Site {
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
pub(crate) fn sea_m(field: &Field, first_column: i64, first_row: i64, u: f64, v: f64) -> f64 {
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
    // Steeper in water, so that a cell away from it is open water.
    let per_part_m = if part > 0.75 { 8.0 } else { 2.0 } * step_m;
    if part > 0.0 { (0.75 - part) * per_part_m } else { f64::INFINITY }
}

/// What the rules make of a place: shares of 0 to 1, each laid over those before it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Belts {
    /// Height over the snow line's, with the place's own swing.
    pub relative: f32,
    /// Noises of 0 to 1: land forms, stands, patches, and gullies that run down the slope.
    pub broad: f32,
    pub middle: f32,
    pub fine: f32,
    pub gully: f32,
    /// Semi-desert: dark scrub and pale clay on gravel.
    pub scrub: f32,
    pub clay: f32,
    pub steppe: f32,
    pub meadow: f32,
    pub tilled: f32,
    pub forest: f32,
    pub tundra: f32,
    pub scree: f32,
    pub rock: f32,
    pub snow: f32,
    /// The part of the snow that is old ice.
    pub ice: f32,
    pub beach: f32,
}

/// Weighs what may cover a place on land; `shore_m` is the distance to the nearest water.
pub(crate) fn belts(site: &Site, climate: &Climate, x_m: f64, z_m: f64, shore_m: f32) -> Belts {
    // Three noises: land forms, stands, patches. World coordinates, so that neighbours agree.
    let broad = noise(x_m / 2_900.0, z_m / 2_900.0, 1);
    let middle = noise(x_m / 830.0, z_m / 830.0, 2);
    let fine = noise(x_m / 260.0, z_m / 260.0, 3);
    let mottle = 0.5 * broad + 0.3 * middle + 0.2 * fine;
    let gully = streaks(x_m, z_m, site.down);

    let relative = site.height_m / climate.snow_line_m.max(300.0) + 0.05 * (mottle - 0.5) - 0.04 * site.cold;
    let wet = (0.45 - 0.55 * climate.dryness * (1.0 - smooth(0.30, 0.62, relative)))
        + 0.30 * site.cold
        + 0.16 * site.hollow
        + 0.55 * (mottle - 0.5)
        + 0.35 * (1.0 - smooth(0.0, 5_000.0, shore_m.max(0.0)));

    // Valley floors that hold water are tilled.
    let tilled =
        smooth(0.22, 0.30, wet) * (1.0 - smooth(0.025, 0.06, site.steep)) * (1.0 - smooth(0.45, 0.55, relative));
    let belt = smooth(0.40, 0.48, relative) * (1.0 - smooth(0.70, 0.76, relative));
    // Where it rains enough, all slopes below the belt are wooded, and woods stand among the fields.
    let woods = smooth(0.05, 0.14, site.steep).max(smooth(0.57, 0.62, broad + 0.3 * (middle - 0.5)));
    let low_forest = (1.0 - climate.dryness) * (1.0 - smooth(0.55, 0.64, relative)) * woods;
    // Where it is dry, spruce stands on shaded slopes, which keep the snow's water longest.
    let shade = climate.dryness * (1.1 * site.cold - 0.06);
    let stand = wet + shade + 0.30 * (fine - 0.5) + 0.20 * (gully - 0.5);
    let forest = belt.max(low_forest) * smooth(0.44, 0.54, stand) * (1.0 - smooth(0.62, 0.75, site.steep));
    let scree = smooth(0.78, 0.96, relative + 0.30 * site.steep + 0.12 * (gully - 0.5));
    // Posts far apart and smooth sources flatten walls, so rock begins at slopes of 17 degrees.
    let wall = site.steep + 0.30 * (gully - 0.5) + 0.10 * (fine - 0.5) - 0.05 * site.hollow;
    let rock = smooth(0.30, 0.44, wall).max(scree * smooth(0.20, 0.36, wall));
    // Snow starts lower on cold slopes and in hollows, and slides off walls, less so the higher they stand.
    let lies = relative + 0.09 * site.cold + 0.035 * site.hollow + 0.10 * (fine - 0.5) + 0.05 * (gully - 0.5);
    let holds = 1.0 - 0.95 * smooth(0.32, 0.46, wall - 0.35 * (relative - 1.05).max(0.0));
    Belts {
        relative,
        broad,
        middle,
        fine,
        gully,
        scrub: smooth(0.50, 0.66, middle + 0.5 * (fine - 0.5)),
        clay: smooth(0.56, 0.66, broad + 0.25 * (fine - 0.5)) * (1.0 - smooth(0.03, 0.08, site.steep)),
        steppe: smooth(-0.1, 0.30, wet),
        meadow: smooth(0.25, 0.60, wet),
        tilled,
        forest,
        tundra: smooth(0.74, 0.88, relative),
        scree,
        rock: rock * (0.35 + 0.65 * smooth(0.55, 0.80, relative)),
        snow: smooth(0.965, 1.035, lies) * holds,
        ice: smooth(0.3, 1.2, site.hollow) * (1.0 - smooth(1.2, 1.4, relative)),
        beach: (1.0 - smooth(60.0, 220.0, shore_m)) * (1.0 - smooth(0.1, 0.3, site.steep)),
    }
}

impl Belts {
    /// The class of what lies on top.
    pub fn class(&self, climate: &Climate) -> CoverClass {
        const HALF: f32 = 0.5;
        if self.beach > HALF {
            CoverClass::Sand
        } else if self.snow > HALF {
            CoverClass::Snow
        } else if self.rock.max(self.scree) > HALF {
            CoverClass::Rock
        } else if self.tundra > HALF {
            CoverClass::Grass
        } else if self.forest > HALF {
            self.trees(climate)
        } else if self.tilled > HALF {
            CoverClass::Field
        } else if self.steppe > HALF {
            CoverClass::Grass
        } else if self.scrub > HALF {
            CoverClass::Scrub
        } else {
            CoverClass::Sand
        }
    }

    /// Broadleaved low, conifers high; in dry lands only these, since what rain there is falls high up.
    pub fn trees(&self, climate: &Climate) -> CoverClass {
        let cold = self.relative + 0.16 * (self.broad - 0.5) + 0.5 * climate.boreal;
        if climate.dryness > 0.5 || cold > 0.42 {
            CoverClass::Conifer
        } else if cold > 0.20 {
            CoverClass::MixedForest
        } else {
            CoverClass::Broadleaf
        }
    }
}

/// Noise smeared down a slope, 0..=1, mean 0.5; plain noise on level ground.
fn streaks(x_m: f64, z_m: f64, down: [f32; 2]) -> f32 {
    let steep = down[0].hypot(down[1]);
    let stride_m = f64::from(smooth(0.03, 0.2, steep)) * 70.0 / f64::from(steep.max(0.03));
    if stride_m == 0.0 {
        return (0.5 + 1.6 * (value_noise(x_m / 150.0, z_m / 150.0, 5) - 0.5)).clamp(0.0, 1.0);
    }
    let (dx, dz) = (f64::from(down[0]) * stride_m, f64::from(down[1]) * stride_m);
    let sum: f32 =
        (-2..=2).map(|k| value_noise((x_m + dx * f64::from(k)) / 150.0, (z_m + dz * f64::from(k)) / 150.0, 5)).sum();
    // Means huddle around the middle; spread them again.
    (0.5 + 1.6 * (sum / 5.0 - 0.5)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site(height_m: f32, steep: f32, cold: f32) -> Site {
        Site { height_m, steep, cold, ..Site::default() }
    }

    /// How often each of `wanted` comes at a hundred places of one kind.
    fn share(site: &Site, climate: &Climate, wanted: impl Fn(CoverClass) -> bool) -> f32 {
        let at = |i: i32| belts(site, climate, f64::from(i) * 977.0, f64::from(i) * 1_313.0, f32::INFINITY);
        (0..100).filter(|&i| wanted(at(i).class(climate))).count() as f32 / 100.0
    }

    #[test]
    fn the_dry_ranges_have_spruce_on_cold_slopes_between_steppe_and_snow() {
        let tian_shan = Climate::of(Geodetic::from_degrees(42.4, 78.3), 2_400.0);
        assert!((3_600.0..4_100.0).contains(&tian_shan.snow_line_m) && tian_shan.dryness == 1.0, "{tian_shan:?}");
        let forest = |height_m, cold| share(&site(height_m, 0.25, cold), &tian_shan, CoverClass::is_forest);
        assert!(forest(2_300.0, 0.25) > 0.5 && forest(2_300.0, -0.25) < 0.2);
        assert!(forest(1_200.0, 0.25) == 0.0 && forest(3_200.0, 0.25) == 0.0);
        assert!(share(&site(2_300.0, 0.25, 0.25), &tian_shan, |c| c == CoverClass::Broadleaf) == 0.0);
        assert!(share(&site(4_600.0, 0.05, 0.0), &tian_shan, |c| c == CoverClass::Snow) > 0.95);
        assert!(share(&site(900.0, 0.01, 0.0), &tian_shan, |c| c == CoverClass::Snow) == 0.0);
    }

    #[test]
    fn wet_lands_have_broadleaved_woods_low_and_conifers_high() {
        let bayreuth = Climate::of(Geodetic::from_degrees(49.9, 11.5), 450.0);
        assert_eq!(bayreuth.dryness, 0.0);
        let low = site(400.0, 0.1, 0.0);
        assert!(share(&low, &bayreuth, |c| matches!(c, CoverClass::Broadleaf | CoverClass::MixedForest)) > 0.15);
        assert!(share(&low, &bayreuth, |c| c == CoverClass::Conifer) == 0.0);
        assert!(share(&site(350.0, 0.0, 0.0), &bayreuth, |c| c == CoverClass::Field) > 0.3);
        let andorra = Climate::of(Geodetic::from_degrees(42.5, 1.5), 1_900.0);
        let woods = |height_m: f32, wanted| share(&site(height_m, 0.3, 0.1), &andorra, |c| c == wanted);
        assert!(woods(1_000.0, CoverClass::MixedForest) > woods(1_000.0, CoverClass::Conifer));
        assert!(woods(1_900.0, CoverClass::Conifer) > 0.3 && woods(2_700.0, CoverClass::Conifer) == 0.0);
        let lapland = Climate::of(Geodetic::from_degrees(66.0, 25.0), 150.0);
        assert!(share(&site(150.0, 0.1, 0.0), &lapland, |c| c == CoverClass::Broadleaf) == 0.0);
    }

    #[test]
    fn snow_lines_fall_towards_the_poles() {
        assert!(Climate::new(1.2, 300.0).snow_line_m < 1_500.0);
        assert_eq!(Climate::new(-0.6, 300.0).cold_side, -1.0);
        for lat_deg in [-90.0, -45.0, 0.0, 89.0, 90.0] {
            let climate = Climate::of(Geodetic::from_degrees(lat_deg, 180.0), f64::NAN.max(0.0));
            assert!(climate.snow_line_m.is_finite() && (0.0..=1.0).contains(&climate.dryness));
        }
    }
}
