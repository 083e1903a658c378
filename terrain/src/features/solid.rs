//! The solid of a building: its outline pulled up from the ground to the eaves, and a roof over it.
//!
//! Frame: the world's (X east, Y up, Z south), metres; a plan point is (x, z). The roof is the least of a few planes, so
//! the solid is `{ plan point in the outline, foot <= y <= every plane }`: the picture draws its faces, a shell meets its
//! faces, and both are the same numbers. One plane is a flat roof, two a gable, four a hip, six a barrel.
//!
//! Invariant others rely on: the eaves are `height_m` above the lowest ground under the outline's corners. A height that
//! was assumed is lowered on what is narrow, and at least [`CLEAR`] of it stands above the highest ground, or houses on a
//! hillside would drown in it. Walls go down to [`FOOT_M`] below the lowest ground, so nothing floats on a slope.

use super::model::{Building, BuildingClass, Origin};
use glam::{DVec2, DVec3};

/// How far walls go down below the lowest ground under a corner, metres: posts between corners may lie lower.
pub const FOOT_M: f64 = 1.5;

/// Least share of an assumed height that stands over the highest ground under a corner.
pub const CLEAR: f64 = 0.75;

/// Rounding allowed where a wall meets the roof, metres: thousands of roundings of a world's far corner, and invisible.
const SEAM_M: f64 = 1e-9;

/// A roof plane: `height_m + gradient . (p - at)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoofPlane {
    /// A plan point under it.
    pub at: DVec2,
    /// Rise per metre east and south.
    pub gradient: DVec2,
    /// Its height over `at`, metres above sea level.
    pub height_m: f64,
}

/// What a roof looks like from afar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RoofKind {
    /// Level.
    Flat,
    /// Two or more slopes with tiles.
    Pitched,
    /// An arch of sheet metal.
    Barrel,
}

/// See the module.
#[derive(Debug, Clone, PartialEq)]
pub struct BuildingSolid {
    /// Corners; the outside is on the right hand of each edge as seen on a map (x east, z south).
    pub outline: Vec<DVec2>,
    /// Lowest ground under a corner.
    pub base_m: f64,
    /// Top of the walls.
    pub eaves_m: f64,
    /// The roof is the least of these; at least one.
    pub planes: Vec<RoofPlane>,
    /// What it looks like.
    pub roof: RoofKind,
}

impl RoofPlane {
    /// Height over a plan point.
    pub fn height_m(&self, at: DVec2) -> f64 {
        self.height_m + self.gradient.dot(at - self.at)
    }

    /// Upward unit normal.
    pub fn normal(&self) -> DVec3 {
        DVec3::new(-self.gradient.x, 1.0, -self.gradient.y).normalize()
    }
}

/// Twice the area inside a ring, positive where the outside is on the right hand of each edge on a map.
pub fn doubled_area_m2(ring: &[DVec2]) -> f64 {
    // About the first point: world coordinates are large and their products would lose the area.
    let first = ring.first().copied().unwrap_or_default();
    pairs(ring).map(|(a, b)| (b - first).perp_dot(a - first)).sum()
}

/// Edges of a ring.
pub fn pairs(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    (0..ring.len()).map(|at| (ring[at], ring[(at + 1) % ring.len()]))
}

/// Whether a plan point is in a ring, by the even-odd rule.
pub fn inside(ring: &[DVec2], at: DVec2) -> bool {
    pairs(ring).fold(false, |held, (a, b)| {
        let crossed = (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x);
        held != crossed
    })
}

/// A number without pattern from a plan point, the same on every machine.
pub fn hash_of(at: DVec2) -> u32 {
    // Centimetres: the same point read from another file keeps its look.
    let (x, z) = ((at.x * 100.0).round() as i64 as u64, (at.y * 100.0).round() as i64 as u64);
    let mut h = x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ z.wrapping_mul(0xc2b2_ae3d_27d4_eb4f).rotate_left(31);
    h = (h ^ (h >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    h = (h ^ (h >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    (h ^ (h >> 33)) as u32
}

impl BuildingSolid {
    /// The solid of a building over the lowest and highest ground under its corners.
    pub fn new(building: &Building, [base_m, highest_m]: [f64; 2]) -> Self {
        let mut outline = building.outline.clone();
        outline.dedup();
        if outline.len() > 1 && outline.first() == outline.last() {
            outline.pop();
        }
        if doubled_area_m2(&outline) < 0.0 {
            outline.reverse();
        }
        let mut height_m = f64::from(building.height_m);
        if building.height_from == Origin::Assumed {
            // No one builds a shed of 3 m as high as a house.
            let (.., half_width_m) = rectangle(&outline);
            height_m = height_m.min(2.2 + 0.9 * half_width_m);
        }
        let eaves_m = match building.height_from {
            Origin::Assumed => (base_m + height_m).max(highest_m + CLEAR * height_m),
            Origin::Stated | Origin::Derived => base_m + height_m,
        };
        let (roof, planes) = roof(building, &outline, eaves_m);
        Self { outline, base_m, eaves_m, planes, roof }
    }

    /// Height of the roof over a plan point, inside the outline or not.
    pub fn roof_m(&self, at: DVec2) -> f64 {
        self.planes.iter().map(|plane| plane.height_m(at)).fold(f64::INFINITY, f64::min)
    }

    /// Highest point.
    pub fn top_m(&self) -> f64 {
        match self.planes.as_slice() {
            [_] => self.eaves_m,
            // The highest point lies on a corner of a piece of the roof.
            _ => self
                .roof_pieces()
                .iter()
                .flat_map(|(plane, piece)| piece.iter().map(|at| self.planes[*plane].height_m(*at)))
                .fold(self.eaves_m, f64::max),
        }
    }

    /// Whether a point is in the solid.
    pub fn contains(&self, at: DVec3) -> bool {
        let plan = DVec2::new(at.x, at.z);
        at.y >= self.base_m - FOOT_M && at.y <= self.roof_m(plan) && inside(&self.outline, plan)
    }

    /// Where a segment first enters the solid, as a fraction of it, and the outward unit normal there. A start inside
    /// enters at 0, against its own way.
    pub fn enter(&self, from: DVec3, to: DVec3) -> Option<(f64, DVec3)> {
        if self.contains(from) {
            return Some((0.0, (from - to).try_normalize().unwrap_or(DVec3::Y)));
        }
        let (start, way) = (DVec2::new(from.x, from.z), DVec2::new(to.x - from.x, to.z - from.z));
        let mut first: Option<(f64, DVec3)> = None;
        let mut take = |fraction: f64, normal: DVec3| {
            if first.is_none_or(|(best, _)| fraction < best) {
                first = Some((fraction, normal));
            }
        };
        for (a, b) in pairs(&self.outline) {
            let edge = b - a;
            let outward = DVec2::new(-edge.y, edge.x);
            let against = way.dot(outward);
            if against >= 0.0 {
                continue;
            }
            let fraction = (a - start).dot(outward) / against;
            let at = start + way * fraction;
            let along = (at - a).dot(edge) / edge.length_squared();
            let y_m = from.y + (to.y - from.y) * fraction;
            let held = y_m >= self.base_m - FOOT_M && y_m <= self.roof_m(at) + SEAM_M;
            if (0.0..=1.0).contains(&fraction) && (0.0..=1.0).contains(&along) && held {
                let outward = outward.normalize();
                take(fraction, DVec3::new(outward.x, 0.0, outward.y));
            }
        }
        for plane in &self.planes {
            let (over, under) = (from.y - plane.height_m(start), to.y - plane.height_m(start + way));
            if over < 0.0 || under > 0.0 || over == under {
                continue;
            }
            let fraction = over / (over - under);
            let at = start + way * fraction;
            if plane.height_m(at) <= self.roof_m(at) + SEAM_M && inside(&self.outline, at) {
                take(fraction, plane.normal());
            }
        }
        first
    }

    /// The roof cut along its ridges: the number of the plane, and the polygon (x, z) that it covers.
    pub fn roof_pieces(&self) -> Vec<(usize, Vec<DVec2>)> {
        let pieces = (0..self.planes.len()).map(|own| {
            let mut piece = self.outline.clone();
            for other in (0..self.planes.len()).filter(|other| *other != own) {
                let (own, other) = (self.planes[own], self.planes[other]);
                piece = clipped(&piece, |at| other.height_m(at) - own.height_m(at));
            }
            (own, piece)
        });
        pieces.filter(|(_, piece)| piece.len() >= 3 && doubled_area_m2(piece).abs() > 1e-4).collect()
    }

    /// The top of a wall from one corner to the next: fractions of the way and heights.
    pub fn wall_top(&self, a: DVec2, b: DVec2) -> Vec<(f64, f64)> {
        let mut fractions = vec![0.0, 1.0];
        for (at, one) in self.planes.iter().enumerate() {
            for other in &self.planes[at + 1..] {
                let (from, to) = (one.height_m(a) - other.height_m(a), one.height_m(b) - other.height_m(b));
                if from * to < 0.0 {
                    fractions.push(from / (from - to));
                }
            }
        }
        fractions.sort_by(f64::total_cmp);
        fractions.dedup_by(|b, a| (*b - *a) < 1e-6);
        fractions.into_iter().map(|fraction| (fraction, self.roof_m(a.lerp(b, fraction)))).collect()
    }
}

/// Triangles of a polygon, each three corners' numbers, wound as the polygon.
pub fn triangulated(ring: &[DVec2]) -> Vec<u32> {
    let mut indices = Vec::new();
    let first = ring.first().copied().unwrap_or_default();
    earcut::Earcut::new().earcut(ring.iter().map(|at| (*at - first).to_array()), &[], &mut indices);
    indices
}

/// The part of a polygon where a linear function is not negative.
fn clipped(ring: &[DVec2], side: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(ring.len() + 2);
    for (a, b) in pairs(ring) {
        let (from, to) = (side(a), side(b));
        if from >= 0.0 {
            kept.push(a);
        }
        if (from < 0.0) != (to < 0.0) && from != to {
            kept.push(a.lerp(b, from / (from - to)));
        }
    }
    kept
}

/// A rectangle around an outline along its longest edge: middle, direction of the longer side, half length, half width.
fn rectangle(outline: &[DVec2]) -> (DVec2, DVec2, f64, f64) {
    let longest = pairs(outline).max_by(|(a, b), (c, d)| a.distance_squared(*b).total_cmp(&c.distance_squared(*d)));
    let along = longest.and_then(|(a, b)| (b - a).try_normalize()).unwrap_or(DVec2::X);
    let across = along.perp();
    let first = outline.first().copied().unwrap_or_default();
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for corner in outline {
        let at = DVec2::new((corner - first).dot(along), (corner - first).dot(across));
        (low, high) = (low.min(at), high.max(at));
    }
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let middle = first + along * middle.x + across * middle.y;
    if half.x >= half.y { (middle, along, half.x, half.y) } else { (middle, across, half.y, half.x) }
}

/// The roof by class, size and hash. Pitches are those of central Europe: 35 to 45 degrees under tiles, 50 on churches,
/// some 10 on halls.
fn roof(building: &Building, outline: &[DVec2], eaves_m: f64) -> (RoofKind, Vec<RoofPlane>) {
    let (middle, along, half_length_m, half_width_m) = rectangle(outline);
    let flat = (RoofKind::Flat, vec![RoofPlane { at: middle, gradient: DVec2::ZERO, height_m: eaves_m }]);
    let across = along.perp();
    let area_m2 = 0.5 * doubled_area_m2(outline).abs();
    let filled = area_m2 / (4.0 * half_length_m * half_width_m).max(1e-6);
    let chance = hash_of(middle) % 100;
    // A plane that rises from the rectangle's side, at that distance from the middle, inward.
    let slope = |outward: DVec2, half_m: f64, pitch: f64| RoofPlane {
        at: middle + outward * half_m,
        gradient: -outward * pitch,
        height_m: eaves_m,
    };
    let gable = |pitch| vec![slope(across, half_width_m, pitch), slope(-across, half_width_m, pitch)];
    let hip = |pitch| {
        let mut planes = gable(pitch);
        planes.extend([slope(along, half_length_m, 1.2 * pitch), slope(-along, half_length_m, 1.2 * pitch)]);
        planes
    };
    if half_width_m < 1.0 {
        return flat;
    }
    let tiles = 0.70 + 0.003 * f64::from(chance);
    let (most_width_m, pitch) = match building.class {
        BuildingClass::House => (16.0, tiles),
        BuildingClass::Apartments if building.height_m < 19.0 && chance < 55 => (17.0, 0.7 * tiles),
        BuildingClass::Apartments | BuildingClass::Commercial if chance < 25 && building.height_m < 15.0 => (15.0, 0.6),
        BuildingClass::Church => (24.0, 1.2),
        BuildingClass::Barn => (24.0, 0.55 * tiles),
        BuildingClass::Industrial => (30.0, 0.17),
        BuildingClass::Other if area_m2 < 450.0 && building.height_m < 14.0 => (14.0, tiles),
        BuildingClass::Hangar if filled > 0.8 && half_width_m < 60.0 => {
            return (RoofKind::Barrel, barrel(middle, across, half_width_m, eaves_m));
        }
        _ => return flat,
    };
    if 2.0 * half_width_m > most_width_m || area_m2 < 20.0 {
        return flat;
    }
    if filled < 0.75 {
        // An L or a T: slopes from every side, cut off level, so that no wall of an inner corner rises far.
        let mut planes = hip(0.6 * pitch);
        planes.push(RoofPlane { at: middle, gradient: DVec2::ZERO, height_m: eaves_m + 1.8 });
        return (RoofKind::Pitched, planes);
    }
    let hipped = chance % 10 < 3 && matches!(building.class, BuildingClass::House | BuildingClass::Apartments);
    (RoofKind::Pitched, if hipped { hip(pitch) } else { gable(pitch) })
}

/// An arch as tangent planes of a circle that rises a quarter of the width.
fn barrel(middle: DVec2, across: DVec2, half_width_m: f64, eaves_m: f64) -> Vec<RoofPlane> {
    let rise_m = 0.5 * half_width_m;
    let radius_m = (half_width_m * half_width_m + rise_m * rise_m) / (2.0 * rise_m);
    let edge_rad = (half_width_m / radius_m).asin();
    [-0.8, -0.45, -0.15, 0.15, 0.45, 0.8]
        .map(|part: f64| {
            let (sin, cos) = (part * edge_rad).sin_cos();
            RoofPlane {
                at: middle + across * (radius_m * sin),
                gradient: -across * (sin / cos),
                height_m: eaves_m + rise_m - radius_m * (1.0 - cos),
            }
        })
        .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn building(class: BuildingClass, outline: &[(f64, f64)], height_m: f32) -> Building {
        let outline = outline.iter().map(|(x, z)| DVec2::new(1_000.0 + x, 2_000.0 + z)).collect();
        Building { class, outline, height_m, height_from: Origin::Stated }
    }

    const ELL: [(f64, f64); 6] = [(0.0, 0.0), (14.0, 0.0), (14.0, 7.0), (6.0, 7.0), (6.0, 13.0), (0.0, 13.0)];
    const OBLONG: [(f64, f64); 4] = [(0.0, 0.0), (0.0, 9.0), (13.0, 9.0), (13.0, 0.0)];

    fn solids() -> Vec<BuildingSolid> {
        use BuildingClass as C;
        let all = [
            building(C::House, &OBLONG, 5.5),
            building(C::House, &ELL, 6.0),
            building(C::Hangar, &[(0.0, 0.0), (40.0, 3.0), (39.0, 33.0), (-1.0, 30.0)], 9.0),
            building(C::Apartments, &ELL, 30.0),
            building(C::Church, &OBLONG, 12.0),
        ];
        all.iter().map(|one| BuildingSolid::new(one, [500.0; 2])).collect()
    }

    #[test]
    fn entering_is_what_small_steps_find() {
        let mut seed = 7_u64;
        let mut random = |low: f64, high: f64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * ((seed >> 33) as f64 / f64::from(1_u32 << 31))
        };
        let mut met = 0;
        for solid in solids() {
            for _ in 0..400 {
                let mut point = || DVec3::new(random(980.0, 1_060.0), random(500.0, 540.0), random(1_980.0, 2_050.0));
                let (from, to) = (point(), point());
                const STEPS: usize = 4_000;
                let slow =
                    (0..=STEPS).map(|step| step as f64 / STEPS as f64).find(|f| solid.contains(from.lerp(to, *f)));
                let fast = solid.enter(from, to);
                match (fast, slow) {
                    (Some((fraction, normal)), Some(slow)) => {
                        // A step is a 4,000th of the way; a corner shorter than it may be cut off before the same wall.
                        assert!(fraction <= slow + 1e-12 && slow - fraction < 0.02, "{fraction} {slow}");
                        assert!((normal.length() - 1.0).abs() < 1e-12 && normal.dot(to - from) <= 1e-9);
                        met += 1;
                    }
                    (None, None) => {}
                    // What lies between two steps is entered for less than two of them.
                    (Some((fraction, _)), None) => {
                        let after = from.lerp(to, fraction + 2.0 / STEPS as f64);
                        assert!(!solid.contains(after), "{fraction}");
                    }
                    (None, Some(slow)) => panic!("missed at {slow}"),
                }
            }
        }
        assert!(met > 150, "{met}");
    }

    #[test]
    fn pieces_of_a_roof_cover_the_outline_once() {
        for solid in solids() {
            let whole_m2 = doubled_area_m2(&solid.outline);
            let pieces_m2: f64 = solid.roof_pieces().iter().map(|(_, piece)| doubled_area_m2(piece)).sum();
            assert!(whole_m2 > 0.0);
            // Slivers below 1e-4 m2 are left out.
            assert!((whole_m2 - pieces_m2).abs() < 1e-2, "{whole_m2} {pieces_m2}");
            assert!(solid.top_m() >= solid.eaves_m);
            for (a, b) in pairs(&solid.outline) {
                for (fraction, height_m) in solid.wall_top(a, b) {
                    assert!((solid.roof_m(a.lerp(b, fraction)) - height_m).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn either_winding_gives_the_same_solid() {
        let mut turned = building(BuildingClass::House, &OBLONG, 5.5);
        let one = BuildingSolid::new(&turned, [500.0; 2]);
        turned.outline.reverse();
        let other = BuildingSolid::new(&turned, [500.0; 2]);
        let (from, to) = (DVec3::new(990.0, 503.0, 2_003.0), DVec3::new(1_020.0, 503.0, 2_003.0));
        let (hit, normal) = one.enter(from, to).unwrap();
        assert_eq!(other.enter(from, to).unwrap(), (hit, normal));
        assert!((hit - 1.0 / 3.0).abs() < 1e-12 && normal == DVec3::NEG_X);
    }
}
