//! Pictures that plants are drawn with: leaves for near models, and whole plants for cards, made from the models.
//!
//! A texel is RGBA8: red a shade (128 is 1), green and blue the normal's part to the right and up in the picture (128 is
//! 0), alpha the coverage. A card picture fills its frame: the box around the plant as an eye sees it that looks down
//! by one of [`ELEVATIONS_RAD`]: as wide as the crown, `height cos + width sin` high, the plant's middle in the middle.
//!
//! Invariant: the share of texels with alpha over a half is that of the whole picture in every mip, so crowns neither
//! thin out nor swell with distance.

use crate::detail::{ALL, Model, WIDTHS, model};
use crate::scatter::uniform;
use glam::{Vec2, Vec3};
use std::sync::OnceLock;

/// Texels of a picture, across and down.
pub const SIZE: [usize; 2] = [64, 128];

/// Looking down by so much is drawn with this picture, radians: 4, 32 and 68 degrees.
pub const ELEVATIONS_RAD: [f32; 3] = [0.070, 0.559, 1.187];

/// Pictures of leaves, before those of plants.
pub const LEAVES: usize = 3;

/// All pictures: leaves, then for each shape its elevations.
pub const COUNT: usize = LEAVES + ALL.len() * ELEVATIONS_RAD.len();

/// Mips of a picture, down to 2 x 4 texels.
pub const MIPS: usize = 6;

/// A picture while it is made: shade, normal x and y, alpha; all 0..=1 but normals -1..=1.
#[derive(Debug, Clone)]
struct Canvas {
    size: [usize; 2],
    texels: Vec<[f32; 4]>,
}

/// Mips of a picture, largest first, as texture bytes.
pub type Picture = Vec<Vec<u8>>;

/// All of them, in the order of their layers. Made once a process: some 0.1 s of work, which a thread may do ahead.
pub fn all() -> &'static [Picture] {
    static ALL: OnceLock<Vec<Picture>> = OnceLock::new();
    ALL.get_or_init(make_all)
}

fn make_all() -> Vec<Picture> {
    let leaves: Vec<Canvas> = (0..LEAVES as u8).map(leaf).collect();
    let mut pictures: Vec<Canvas> = leaves.clone();
    for (shape, width) in ALL.into_iter().zip(WIDTHS) {
        let model = model(shape);
        pictures.extend(ELEVATIONS_RAD.map(|elevation_rad| card(&model, width, elevation_rad, &leaves)));
    }
    pictures.into_iter().map(finish).collect()
}

/// A leaf picture.
fn leaf(number: u8) -> Canvas {
    let [wide, high] = SIZE;
    let texels = (0..wide * high).map(|at| {
        let (u, v) = ((at % wide) as f32 / (wide - 1) as f32, (at / wide) as f32 / (high - 1) as f32);
        let (shade, alpha) = match number {
            crate::detail::SKIRT => skirt(u, v),
            crate::detail::CLUMP => clump(u, v),
            _ => (0.4 + 0.3 * noise(u * 14.0, v * 9.0, 5), 1.0),
        };
        [shade, 0.0, 0.0, alpha]
    });
    Canvas { size: SIZE, texels: texels.collect() }
}

/// Fronds that hang from the top edge and thin out downwards.
fn skirt(u: f32, v: f32) -> (f32, f32) {
    const FRONDS: f32 = 4.0;
    let frond = (u * FRONDS).floor();
    let across = ((u * FRONDS).fract() - 0.5).abs() * 2.0;
    let long = 0.72 + 0.28 * noise(frond * 3.7 + 1.0, 0.5, 1);
    let ragged = 0.35 * (noise(u * 26.0, v * 22.0, 2) - 0.5);
    let wide = 1.12 - (v / long).powi(3) * 0.95 + ragged * (0.3 + v);
    let needles = noise(u * 40.0, v * 9.0, 3);
    let shade = 0.24 + 0.26 * v + 0.22 * (needles - 0.5) + 0.12 * (1.0 - across);
    (shade, if across < wide && v < long { 1.0 } else { 0.0 })
}

/// A bunch of leaves with a torn edge and holes.
fn clump(u: f32, v: f32) -> (f32, f32) {
    let at = Vec2::new(u - 0.5, v - 0.5) * 2.0;
    let leaves = 0.55 * noise(u * 9.0, v * 9.0, 7) + 0.45 * noise(u * 21.0, v * 21.0, 8);
    let solid = 1.05 - at.length() + 0.85 * (leaves - 0.5);
    let shade = 0.38 + 0.34 * (leaves - 0.5) + 0.16 * (0.5 - v);
    (shade, if solid > 0.16 { 1.0 } else { 0.0 })
}

/// A plant as a card shows it.
fn card(model: &Model, width: f32, elevation_rad: f32, leaves: &[Canvas]) -> Canvas {
    /// Samples along a texel.
    const FINE: usize = 2;
    let [wide, high] = SIZE.map(|side| side * FINE);
    let (sin, cos) = elevation_rad.sin_cos();
    let tall = cos + width * sin;
    let mut depth = vec![f32::NEG_INFINITY; wide * high];
    let mut fine = Canvas { size: [wide, high], texels: vec![[0.0; 4]; wide * high] };
    // Right, up, to the eye.
    let seen = |p: Vec3| Vec3::new(p.x, p.y * cos - p.z * sin, p.y * sin + p.z * cos);
    for triangle in model.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| &model.vertices[usize::from(triangle[i])]);
        let place = |v: &crate::detail::Vertex| {
            let at = seen((v.position - Vec3::Y * 0.5) * Vec3::new(width, 1.0, width));
            Vec3::new((at.x / width + 0.5) * wide as f32, (0.5 - at.y / tall) * high as f32, at.z)
        };
        let corners = [place(a), place(b), place(c)];
        let area = (corners[1] - corners[0]).truncate().perp_dot((corners[2] - corners[0]).truncate());
        if area.abs() < 1e-6 {
            continue;
        }
        let low = corners.iter().fold(Vec3::INFINITY, |low, p| low.min(*p)).max(Vec3::ZERO);
        let most = corners.iter().fold(Vec3::NEG_INFINITY, |most, p| most.max(*p));
        let rows = low.y as usize..(most.y.max(0.0) as usize + 1).min(high);
        for y in rows {
            for x in low.x as usize..(most.x.max(0.0) as usize + 1).min(wide) {
                let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let part = |i: usize, j: usize| {
                    (corners[j].truncate() - corners[i].truncate()).perp_dot(at - corners[i].truncate()) / area
                };
                let (pa, pb, pc) = (part(1, 2), part(2, 0), part(0, 1));
                if pa < 0.0 || pb < 0.0 || pc < 0.0 {
                    continue;
                }
                let here = y * wide + x;
                let near = corners[0].z * pa + corners[1].z * pb + corners[2].z * pc;
                let [shade, _, _, alpha] = leaves[usize::from(a.leaf)].at(a.uv * pa + b.uv * pb + c.uv * pc);
                if alpha < 0.5 || near <= depth[here] {
                    continue;
                }
                depth[here] = near;
                let normal = seen((a.normal * pa + b.normal * pb + c.normal * pc).normalize_or(Vec3::Y));
                let open = a.open * pa + b.open * pb + c.open * pc;
                fine.texels[here] = [shade * open, normal.x, normal.y, 1.0];
            }
        }
    }
    let mut card = fine;
    for _ in 0..FINE.ilog2() {
        card = card.half();
    }
    // One shade for all: a species' colour is that of the whole crown.
    let (sum, weight) = card.texels.iter().fold((0.0, 0.0), |(s, w), t| (s + t[0] * t[3], w + t[3]));
    let level = 0.5 * weight / f32::max(sum, 1e-6);
    for texel in &mut card.texels {
        texel[0] *= level;
    }
    card
}

impl Canvas {
    fn at(&self, uv: Vec2) -> [f32; 4] {
        let index = |share: f32, side: usize| ((share * side as f32) as usize).min(side - 1);
        self.texels[index(uv.y, self.size[1]) * self.size[0] + index(uv.x, self.size[0])]
    }

    /// The mean of each four texels, weighted by their coverage.
    fn half(&self) -> Self {
        let [wide, high] = self.size.map(|side| side / 2);
        let texels = (0..wide * high).map(|at| {
            let (x, y) = (at % wide * 2, at / wide * 2);
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| self.texels[(y + dy) * self.size[0] + x + dx]);
            let alpha: f32 = four.iter().map(|t| t[3]).sum();
            let mean = |channel: usize| {
                let plain = four.iter().map(|t| t[channel]).sum::<f32>() / 4.0;
                if alpha > 0.0 { four.iter().map(|t| t[channel] * t[3]).sum::<f32>() / alpha } else { plain }
            };
            [mean(0), mean(1), mean(2), alpha / 4.0]
        });
        Self { size: [wide, high], texels: texels.collect() }
    }

    /// Share of texels whose alpha times a factor is over a half.
    fn coverage(&self, factor: f32) -> f32 {
        self.texels.iter().filter(|t| t[3] * factor > 0.5).count() as f32 / self.texels.len() as f32
    }
}

/// Mips with kept coverage; texels without any get the colour of the mip below, so that filtering finds no dark rims.
fn finish(canvas: Canvas) -> Picture {
    let share = canvas.coverage(1.0);
    let mut mips = vec![canvas];
    for _ in 1..MIPS {
        mips.extend(mips.last().map(Canvas::half));
    }
    for level in (1..MIPS).rev() {
        let (finer, coarser) = mips.split_at_mut(level);
        let (finer, coarser) = (&mut finer[level - 1], &coarser[0]);
        let wide = finer.size[0];
        for (at, texel) in finer.texels.iter_mut().enumerate() {
            if texel[3] <= 0.0 {
                let from = coarser.texels[at / wide / 2 * coarser.size[0] + at % wide / 2];
                texel[..3].copy_from_slice(&from[..3]);
            }
        }
    }
    let factor = |mip: &Canvas| {
        let (mut low, mut high) = (0.25_f32, 16.0_f32);
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if mip.coverage(middle) < share { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    mips.iter()
        .map(|mip| {
            let factor = factor(mip);
            let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
            let texel =
                |t: &[f32; 4]| [byte(t[0]), byte(0.5 + 0.5 * t[1]), byte(0.5 + 0.5 * t[2]), byte(t[3] * factor)];
            mip.texels.iter().flat_map(texel).collect()
        })
        .collect()
}

/// Side of the crown texture, texels.
pub const CROWNS: usize = 128;

/// A closed forest from above, tiling, with mips: red a shade, green and blue the slope east and south, alpha the height of
/// the crowns. About 20 crowns a side. Made once a process, as [`all`] is.
pub fn crowns() -> &'static Picture {
    static CROWNS: OnceLock<Picture> = OnceLock::new();
    CROWNS.get_or_init(make_crowns)
}

fn make_crowns() -> Picture {
    const ACROSS: i32 = 20;
    let side = CROWNS as f32;
    let height = |x: f32, z: f32| {
        let at = Vec2::new(x, z) * ACROSS as f32 / side;
        let cell = at.floor();
        let mut top = 0.0_f32;
        for dz in -1..=1 {
            for dx in -1..=1 {
                let here = cell + Vec2::new(dx as f32, dz as f32);
                let wrapped = [here.x as i32, here.y as i32].map(|i| i.rem_euclid(ACROSS));
                let [jx, jz, tall] = crate::scatter::uniforms(wrapped[0], wrapped[1], 31);
                let away = at - here - Vec2::new(0.15 + 0.7 * jx, 0.15 + 0.7 * jz);
                top = top.max((0.55 + 0.45 * tall) * (1.0 - 1.15 * away.length_squared()));
            }
        }
        top.max(0.0)
    };
    let mut texels = Vec::new();
    for z in 0..CROWNS {
        for x in 0..CROWNS {
            let (x, z) = (x as f32, z as f32);
            let slope = |dx: f32, dz: f32| 1.9 * (height(x - dx, z - dz) - height(x + dx, z + dz));
            let tall = height(x, z);
            texels.push([0.06 + 0.62 * tall * tall, slope(0.5, 0.0), slope(0.0, 0.5), tall]);
        }
    }
    let mut mips = vec![Canvas { size: [CROWNS, CROWNS], texels }];
    while mips.last().is_some_and(|mip| mip.size[0] > 1) {
        mips.extend(mips.last().map(|mip| {
            let [wide, _] = mip.size.map(|s| s / 2);
            let texels = (0..wide * wide).map(|at| {
                let (x, y) = (at % wide * 2, at / wide * 2);
                let mean = |c: usize| {
                    [(0, 0), (1, 0), (0, 1), (1, 1)]
                        .iter()
                        .map(|(dx, dy)| mip.texels[(y + dy) * mip.size[0] + x + dx][c])
                        .sum::<f32>()
                        / 4.0
                };
                [mean(0), mean(1), mean(2), mean(3)]
            });
            Canvas { size: [wide, wide], texels: texels.collect() }
        }));
    }
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let texel = |t: &[f32; 4]| [byte(t[0]), byte(0.5 + 0.5 * t[1]), byte(0.5 + 0.5 * t[2]), byte(t[3])];
    mips.iter().map(|mip| mip.texels.iter().flat_map(texel).collect()).collect()
}

/// Value noise, 0..=1.
fn noise(x: f32, y: f32, salt: u32) -> f32 {
    let (x0, y0) = (x.floor(), y.floor());
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease(x - x0), ease(y - y0));
    let at = |dx: i32, dy: i32| uniform(crate::scatter::hash(x0 as i32 + dx, y0 as i32 + dy, 200 + salt)[0]);
    let (top, bottom) = (at(0, 0) + u * (at(1, 0) - at(0, 0)), at(0, 1) + u * (at(1, 1) - at(0, 1)));
    top + v * (bottom - top)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_is_kept_in_every_mip() {
        let start = std::time::Instant::now();
        let pictures = all();
        println!("{} pictures in {:.1} ms", pictures.len(), start.elapsed().as_secs_f64() * 1e3);
        assert_eq!(pictures.len(), COUNT);
        for (number, mips) in pictures.iter().enumerate() {
            assert_eq!(mips.len(), MIPS);
            let share = |mip: &[u8]| mip.chunks_exact(4).filter(|t| t[3] > 127).count() as f32 / (mip.len() / 4) as f32;
            let whole = share(&mips[0]);
            assert!((0.2..=1.0).contains(&whole), "picture {number}: {whole}");
            for (level, mip) in mips.iter().enumerate() {
                assert_eq!(mip.len(), (SIZE[0] >> level) * (SIZE[1] >> level) * 4);
                // Leaves are cut out sharply, so alpha in the first mips has few values and many texels cross together;
                // the last mips have few texels.
                let step = 6.0 * (mip.len() as f32 / 4.0).recip();
                assert!(
                    (share(mip) - whole).abs() <= step.max(0.05),
                    "picture {number}, mip {level}: {} of {whole}",
                    share(mip)
                );
            }
        }
    }

    #[test]
    fn crowns_tile() {
        let mips = crowns();
        assert_eq!(mips.len(), 8);
        let texel = |x: usize, z: usize| mips[0][(z * CROWNS + x) * 4 + 3];
        // Neighbours across the border differ no more than neighbours inside may: the steepest crown falls by less than
        // its whole height over half a crown, three texels.
        for i in 0..CROWNS {
            assert!(texel(0, i).abs_diff(texel(CROWNS - 1, i)) < 130);
            assert!(texel(i, 0).abs_diff(texel(i, CROWNS - 1)) < 130);
        }
    }
}
