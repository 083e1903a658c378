//! A line with a width as convex polygons on the lattice.
//!
//! Each segment becomes one polygon from joint to joint. Joints are mitred: both neighbours end in the same two spots,
//! `centre + offset` and `centre - offset`. Where a mitre would be longer than [`MITRE_LIMIT`] half widths, or reach past
//! a short neighbour, both segments end square and a wedge fills the outer side.
//!
//! A width is measured on the ground, across the line: on a slope of 35 degrees across it a road of 6 m covers 4.9 m of
//! the plan. Within a triangle of the ground the slope across a segment is one number; where it changes by more than
//! [`WIDTH_STEP`] from one triangle to the next, the segment is cut there and its width changes over a width's length.
//!
//! Invariant others rely on: a segment's polygons depend on the line and the ground alone, never on the block that asks.

use super::clip::Polygon;
use super::lattice::{Axis, Lattice, Spot, UNITS, slope};
use crate::field::Field;
use glam::DVec2;

/// Longest mitre, in half widths: turns of up to 97 degrees are mitred.
pub const MITRE_LIMIT: f64 = 1.5;

/// Greatest nominal width, metres: a block looks no farther beyond its border for what reaches into it.
pub const MOST_WIDTH_M: f64 = 250.0;

/// Share of its width by which a ribbon may be off before it is corrected.
pub const WIDTH_STEP: f64 = 0.02;

/// Nearer points of a line are one, metres: less than half a width of any road.
const LEAST_SEGMENT_M: f64 = 0.5;

/// Longest segment, post steps; a longer one is cut into equal parts, so that a block never works on much beyond it.
const LONGEST_SEGMENT: f64 = 10.0;

/// A line made ready: spots no nearer than [`LEAST_SEGMENT_M`] to each other and no farther than [`LONGEST_SEGMENT`].
#[derive(Debug, Clone, PartialEq)]
pub struct Ribbon {
    /// The middle.
    pub spots: Vec<Spot>,
    /// Half the nominal width, metres on the ground.
    pub half_m: f64,
    /// Whether the last spot is the first.
    pub closed: bool,
}

/// A polygon of a ribbon and where it lies along it.
#[derive(Debug, Clone, Copy)]
pub struct Quad {
    /// The polygon.
    pub polygon: Polygon,
    /// A spot on the middle.
    pub origin: Spot,
    /// Along the ribbon, unit, east and south.
    pub along: DVec2,
    /// Of `origin` along its segment, metres in plan.
    pub start_m: f64,
    /// Metres on the ground for one in plan, across.
    pub stretch: f64,
}

/// A cut across a ribbon: its middle, from there to the left edge, and whether the middle is a corner of its own.
#[derive(Debug, Clone, Copy)]
struct Station {
    centre: Spot,
    offset: (i64, i64),
    middle: bool,
}

impl Ribbon {
    /// Ribbons of a line: parts that lie beyond the lattice or wholly outside the grid, by more than a post step, are
    /// left out, and all from the spot on that would be one more than `room`.
    pub fn of_line(field: &Field, lattice: &Lattice, line: &[DVec2], half_m: f64, room: usize) -> Vec<Self> {
        let grid = field.grid();
        let margin = UNITS + (4.0 * half_m / lattice.unit_m()).min(1e9) as i64;
        let (east, south) = (i64::from(grid.columns() - 1) * UNITS, i64::from(grid.rows() - 1) * UNITS);
        let outside = |a: Spot, b: Spot| {
            a.u.max(b.u) < -margin
                || a.v.max(b.v) < -margin
                || a.u.min(b.u) > east + margin
                || a.v.min(b.v) > south + margin
        };
        let mut ribbons = Vec::new();
        let mut spots: Vec<Spot> = Vec::new();
        let mut left = room;
        let mut finish = |spots: &mut Vec<Spot>| {
            if spots.len() >= 2 {
                let closed = spots.len() > 3 && spots.first() == spots.last();
                ribbons.push(Self { spots: std::mem::take(spots), half_m, closed });
            }
            spots.clear();
        };
        for at in line {
            let Some(spot) = lattice.spot(*at) else {
                finish(&mut spots);
                continue;
            };
            let Some(&last) = spots.last() else {
                spots.push(spot);
                left = left.saturating_sub(1);
                continue;
            };
            let length_m = lattice.between_m(last, spot).length();
            if length_m < LEAST_SEGMENT_M {
                continue;
            }
            if outside(last, spot) {
                finish(&mut spots);
                spots.push(spot);
                continue;
            }
            let parts = (length_m / (LONGEST_SEGMENT * grid.step_m)).ceil().max(1.0) as i64;
            for part in 1..=parts {
                let between =
                    |from: i64, to: i64| from + ((i128::from(to - from) * i128::from(part)) / i128::from(parts)) as i64;
                let next = Spot { u: between(last.u, spot.u), v: between(last.v, spot.v) };
                // Of a long segment only the parts near the grid are kept.
                let before = spots.last().copied().unwrap_or(last);
                if parts > 1 && outside(before, next) {
                    finish(&mut spots);
                }
                if left == 0 {
                    return ribbons;
                }
                left -= 1;
                spots.push(next);
            }
        }
        finish(&mut spots);
        ribbons
    }

    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.spots.len() - 1
    }

    fn direction(&self, lattice: &Lattice, segment: usize) -> DVec2 {
        lattice.between_m(self.spots[segment], self.spots[segment + 1]).normalize_or(DVec2::X)
    }

    fn length_m(&self, lattice: &Lattice, segment: usize) -> f64 {
        lattice.between_m(self.spots[segment], self.spots[segment + 1]).length()
    }

    /// The segment before or after a joint, around a closed line too.
    fn beside(&self, joint: usize) -> (Option<usize>, Option<usize>) {
        let last = self.segments() - 1;
        let before = if joint > 0 { Some(joint - 1) } else { self.closed.then_some(last) };
        let after = if joint <= last { Some(joint) } else { self.closed.then_some(0) };
        (before, after)
    }

    /// Hands out the polygons of a segment, and the wedge at its start.
    pub fn segment(&self, field: &Field, lattice: &Lattice, segment: usize, mut quad: impl FnMut(Quad)) {
        let along = self.direction(lattice, segment);
        let shares = Shares::of(field, lattice, self.spots[segment], self.spots[segment + 1], along);
        let (start, wedge) = self.joint(field, lattice, segment, segment);
        let (end, _) = self.joint(field, lattice, segment + 1, segment);
        if let Some((corners, origin)) = wedge
            && let Some(polygon) = Polygon::new(&corners)
        {
            quad(Quad { polygon, origin, along, start_m: 0.0, stretch: 1.0 / shares.first() });
        }
        let length_m = self.length_m(lattice, segment);
        let mut stations = vec![(0.0, start)];
        for (at_m, share) in shares.stations(self.half_m, length_m) {
            let (du, dv) = lattice.units(along * at_m);
            let offset = lattice.units(left_of(along) * (self.half_m * share));
            stations.push((at_m, Station { centre: self.spots[segment].moved(du, dv), offset, middle: false }));
        }
        stations.push((length_m, end));
        for pair in stations.windows(2) {
            let ((from_m, from), (to_m, to)) = (pair[0], pair[1]);
            let stretch = 1.0 / shares.at(0.5 * (from_m + to_m));
            let out = |polygon| Quad { polygon, origin: from.centre, along, start_m: from_m, stretch };
            between(from, to, |polygon| quad(out(polygon)));
        }
    }

    /// The cut at a joint as one of its segments ends there, and the wedge if both end square.
    fn joint(
        &self,
        field: &Field,
        lattice: &Lattice,
        joint: usize,
        segment: usize,
    ) -> (Station, Option<([Spot; 3], Spot)>) {
        let centre = self.spots[joint];
        let share_of = |segment: usize, end: bool| {
            let along = self.direction(lattice, segment);
            let shares = Shares::of(field, lattice, self.spots[segment], self.spots[segment + 1], along);
            if end { shares.last() } else { shares.first() }
        };
        let square = |segment: usize, end: bool| {
            lattice.units(left_of(self.direction(lattice, segment)) * (self.half_m * share_of(segment, end)))
        };
        let (Some(before), Some(after)) = self.beside(joint) else {
            return (Station { centre, offset: square(segment, joint > segment), middle: false }, None);
        };
        let (inward, outward) = (self.direction(lattice, before), self.direction(lattice, after));
        let half_m = self.half_m * 0.5 * (share_of(before, true) + share_of(after, false));
        // Half the turn: the mitre is half a width over its cosine, and reaches back by its tangent.
        let bisector = (inward + outward).normalize_or_zero();
        let cosine = bisector.dot(outward);
        let back_m = half_m * (1.0 - cosine * cosine).max(0.0).sqrt() / cosine.max(1e-6);
        let room_m = 0.45 * self.length_m(lattice, before).min(self.length_m(lattice, after));
        if cosine * MITRE_LIMIT >= 1.0 && back_m <= room_m {
            let offset = lattice.units(left_of(bisector) * (half_m / cosine));
            return (Station { centre, offset, middle: false }, None);
        }
        let (ends, starts) = (square(before, true), square(after, false));
        let own = if segment == after && !(segment == before && joint > segment) { starts } else { ends };
        // A right turn leaves the left side open.
        let side = if inward.perp_dot(outward) >= 0.0 { 1 } else { -1 };
        let corner = |offset: (i64, i64)| centre.moved(side * offset.0, side * offset.1);
        let wedge = [centre, corner(ends), corner(starts)];
        (Station { centre, offset: own, middle: true }, Some((wedge, centre)))
    }
}

/// Left of a direction of travel, seen from above with x east and z south.
fn left_of(along: DVec2) -> DVec2 {
    DVec2::new(along.y, -along.x)
}

/// The polygon between two cuts; where rounding or a short segment spoils it, the triangles of what is left.
fn between(from: Station, to: Station, mut out: impl FnMut(Polygon)) {
    let left = |s: Station| s.centre.moved(s.offset.0, s.offset.1);
    let right = |s: Station| s.centre.moved(-s.offset.0, -s.offset.1);
    let mut corners = [Spot { u: 0, v: 0 }; 6];
    let mut len = 0;
    let mut add = |spot: Spot| {
        corners[len] = spot;
        len += 1;
    };
    add(left(from));
    if from.middle {
        add(from.centre);
    }
    add(right(from));
    add(right(to));
    if to.middle {
        add(to.centre);
    }
    add(left(to));
    match Polygon::new(&corners[..len]) {
        Some(polygon) => out(polygon),
        None => {
            for at in 1..len - 1 {
                if let Some(polygon) = Polygon::new(&[corners[0], corners[at], corners[at + 1]]) {
                    out(polygon);
                }
            }
        }
    }
}

/// Plan width over nominal width along a segment: one share for each triangle of the ground that it crosses.
struct Shares {
    /// From how many metres on, and the share.
    parts: Vec<(f64, f64)>,
}

impl Shares {
    fn of(field: &Field, lattice: &Lattice, from: Spot, to: Spot, along: DVec2) -> Self {
        let length_m = lattice.between_m(from, to).length();
        let mut crossings_m = vec![0.0];
        for axis in [Axis::U, Axis::V, Axis::W] {
            let (start, end) = (from.along(axis), to.along(axis));
            let (low, high) = (start.min(end), start.max(end));
            let mut line = (low.div_euclid(UNITS) + 1) * UNITS;
            while line < high {
                crossings_m.push((line - start) as f64 / (end - start) as f64 * length_m);
                line += UNITS;
            }
        }
        crossings_m.sort_by(f64::total_cmp);
        let across = left_of(along);
        let parts = (0..crossings_m.len()).map(|at| {
            let end_m = crossings_m.get(at + 1).copied().unwrap_or(length_m);
            let middle = along * (0.5 * (crossings_m[at] + end_m)) / lattice.unit_m();
            let rise = slope(field, from.u as f64 + middle.x, from.v as f64 + middle.y).dot(across);
            let share = 1.0 / (1.0 + rise * rise).sqrt();
            (crossings_m[at], if share > 1.0 - WIDTH_STEP { 1.0 } else { share })
        });
        let mut parts: Vec<(f64, f64)> = parts.collect();
        // Triangles whose shares hardly differ are one, so that level ground makes no cuts.
        parts.dedup_by(|next, kept| (next.1 - kept.1).abs() <= 0.5 * WIDTH_STEP * kept.1);
        Self { parts }
    }

    fn first(&self) -> f64 {
        self.parts.first().map_or(1.0, |part| part.1)
    }

    fn last(&self) -> f64 {
        self.parts.last().map_or(1.0, |part| part.1)
    }

    fn at(&self, at_m: f64) -> f64 {
        self.parts.iter().rev().find(|part| part.0 <= at_m).map_or(1.0, |part| part.1)
    }

    /// Cuts within the segment: half a width before and after each change.
    fn stations(&self, half_m: f64, length_m: f64) -> Vec<(f64, f64)> {
        let mut stations = Vec::new();
        if self.parts.iter().all(|part| part.1 == 1.0) {
            return stations;
        }
        // Also after the start and before the end, whose width is the mean of two segments'.
        let end_m = |at: usize| self.parts.get(at + 1).map_or(length_m, |next| next.0);
        for (at, (from_m, share)) in self.parts.iter().enumerate() {
            let long_m = end_m(at) - from_m;
            let reach_m = half_m.min(0.25 * long_m);
            if reach_m > 0.05 {
                stations.push((from_m + reach_m, *share));
                stations.push((from_m + long_m - reach_m, *share));
            }
        }
        stations
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::synthetic;

    fn quads(field: &Field, line: &[DVec2], width_m: f64) -> Vec<Quad> {
        let lattice = Lattice::of(field.grid());
        let mut found = Vec::new();
        for ribbon in Ribbon::of_line(field, &lattice, line, 0.5 * width_m, usize::MAX) {
            for segment in 0..ribbon.segments() {
                ribbon.segment(field, &lattice, segment, |quad| found.push(quad));
            }
        }
        found
    }

    fn inside(quad: &Quad, at: Spot) -> bool {
        let corners: Vec<Spot> = quad.polygon.corners().collect();
        (0..corners.len())
            .all(|c| super::super::lattice::twice_area(corners[c], corners[(c + 1) % corners.len()], at) >= 0)
    }

    /// Distance on the ground from edge to edge across a line at a place, by small steps.
    fn width_m(field: &Field, quads: &[Quad], at: DVec2, along: DVec2) -> f64 {
        let lattice = Lattice::of(field.grid());
        let area = crate::ground::Ground::new(std::sync::Arc::new(field.clone())).whole();
        let across = left_of(along);
        let step_m = 0.01;
        let mut sum = 0.0;
        for sign in [-1.0, 1.0] {
            for step in 0..4_000 {
                let (from, to) =
                    (at + across * sign * step_m * f64::from(step), at + across * sign * step_m * f64::from(step + 1));
                if !quads.iter().any(|quad| inside(quad, lattice.spot(to).unwrap())) {
                    break;
                }
                let rise = area.height_m(to.x, to.y).unwrap() - area.height_m(from.x, from.y).unwrap();
                sum += step_m.hypot(rise);
            }
        }
        sum
    }

    #[test]
    fn a_road_is_as_wide_as_it_should_be_on_the_level_and_along_a_slope_of_35_degrees() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let steep = (35f64.to_radians().tan() * 200.0) as f32;
        let plain = synthetic::flat(grid, 100.0);
        let east_rises = synthetic::from_fn(grid, |column, _| steep * column as f32);
        for field in [&plain, &east_rises] {
            for bearing_deg in [0.0, 20.0, 45.0, 90.0, 135.0, 171.0f64] {
                let along = DVec2::from_angle(bearing_deg.to_radians());
                let line: Vec<DVec2> = (-4..=4).map(|at| along * (170.0 * f64::from(at) + 13.0)).collect();
                let quads = quads(field, &line, 6.0);
                for at in [-500.0, -120.0, 1.0, 333.0] {
                    let found = width_m(field, &quads, along * at, along);
                    // 2 % before a width is corrected, and two steps of the measure.
                    assert!((found - 6.0).abs() < 6.0 * WIDTH_STEP + 0.03, "{bearing_deg}: {found}");
                }
            }
        }
    }

    #[test]
    fn where_the_slope_changes_the_width_follows_within_a_width() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let steep = (35f64.to_radians().tan() * 200.0) as f32;
        // Level north of the middle, rising to the east south of it.
        let field = synthetic::from_fn(grid, |column, row| {
            if row <= 30 { 0.0 } else { steep * column as f32 * ((row - 30) as f32).min(1.0) }
        });
        let line: Vec<DVec2> = (-8..=8).map(|at| DVec2::new(37.0, 130.0 * f64::from(at))).collect();
        let quads = quads(&field, &line, 8.0);
        let found = |z: f64| width_m(&field, &quads, DVec2::new(37.0, z), DVec2::Y);
        for z in [-900.0, -300.0, -10.0, 210.0, 300.0, 900.0] {
            assert!((found(z) - 8.0).abs() < 0.05 * 8.0, "{z}: {}", found(z));
        }
    }

    #[test]
    fn neighbours_share_their_joint_and_sharp_turns_are_filled() {
        let field = synthetic::flat(Grid::centred(200.0, 2, 2).unwrap(), 0.0);
        let lattice = Lattice::of(field.grid());
        for turn_deg in [-175.0, -120.0, -60.0, -5.0, 0.0, 5.0, 60.0, 90.0, 100.0, 150.0, 178.0f64] {
            let corner = DVec2::new(11.0, 7.0);
            let onward = DVec2::from_angle(turn_deg.to_radians());
            let line = [corner - DVec2::X * 60.0, corner, corner + onward * 60.0];
            let quads = quads(&field, &line, 8.0);
            assert_eq!(quads.len(), if turn_deg.abs() <= 96.0 { 2 } else { 3 }, "{turn_deg}");
            // All around the corner, out to nearly half a width on the outer side, there is road.
            let outer = -onward.perp().normalize() * onward.perp_dot(DVec2::X).signum();
            for share in [0.0, 0.5, 0.7] {
                for at in [corner + (outer * 4.0 * share), corner + DVec2::X * 0.02, corner - DVec2::X * 3.0] {
                    let spot = lattice.spot(at).unwrap();
                    assert!(turn_deg == 0.0 || quads.iter().any(|q| inside(q, spot)), "{turn_deg} {share} {at}");
                }
            }
        }
    }

    #[test]
    fn hostile_lines_are_bounded() {
        let field = synthetic::flat(Grid::centred(200.0, 2, 2).unwrap(), 0.0);
        let p = DVec2::new;
        let far = 1e7;
        for line in [
            vec![p(0.0, 0.0), p(0.0, 0.0)],
            vec![p(f64::NAN, 0.0), p(1.0, 1.0)],
            vec![p(-1e300, 0.0), p(1e300, 0.0)],
            vec![p(0.0, 0.0), p(100.0, 0.0), p(0.0, 0.0), p(100.0, 0.0), p(100.0, 0.1)],
            vec![p(-far, -far), p(far, far)],
        ] {
            let lattice = Lattice::of(field.grid());
            let ribbons = Ribbon::of_line(&field, &lattice, &line, 3.0, usize::MAX);
            assert!(ribbons.iter().map(|ribbon| ribbon.spots.len()).sum::<usize>() < 100, "{line:?}");
            assert!(quads(&field, &line, 6.0).len() < 1_000);
        }
    }
    #[test]
    fn no_more_is_made_than_there_is_room_for() {
        let field = synthetic::flat(Grid::centred(200.0, 2, 2).unwrap(), 0.0);
        let lattice = Lattice::of(field.grid());
        // Out of the grid and back: several ribbons of one line.
        let line: Vec<DVec2> =
            (0..200).map(|at| DVec2::new(f64::from(at), if at % 20 < 10 { 0.0 } else { 90_000.0 })).collect();
        let whole = Ribbon::of_line(&field, &lattice, &line, 3.0, usize::MAX);
        let spots = |ribbons: &[Ribbon]| ribbons.iter().map(|ribbon| ribbon.spots.len()).sum::<usize>();
        assert!(whole.len() > 5 && spots(&whole) > 100);
        for room in [0, 1, 2, 30, 90] {
            let part = Ribbon::of_line(&field, &lattice, &line, 3.0, room);
            assert!(spots(&part) <= room && part[..] == whole[..part.len()], "{room}");
        }
    }
}
