//! From ways of `natural=coastline` to the sea, file by file.
//!
//! A coastline has land on its left and water on its right (wiki.openstreetmap.org/wiki/Tag:natural=coastline). Ways that
//! run into each other make rings (islands, or waters within land) and chains that leave the data. Chains are closed
//! clockwise along a box, which is that of all coastlines: a side on which one ends stays, one on which none ends is moved
//! out by up to [`MARGIN_DEG`] within the data. An end that is cut off inside goes straight on to the nearest side if that is
//! at most [`MARGIN_DEG`] away; else, or where two coasts in a row end or begin, the chains are left out, since half of a
//! coast would put land under water. Beyond the box, and where there is no coastline, level ground at 0 m is the sea by rule.
//!
//! What is made is one area: the first way carries it, the others are parts of it. Frame: degrees, (longitude, latitude).

use super::raw::{AreaOf, Element, Polygon, RawFeature, Shape};
use glam::DVec2;
use std::collections::HashMap;

/// See the module, degrees.
const MARGIN_DEG: f64 = 0.05;

/// Largest distance from a side of the box of what lies on it, degrees: a node is known to 1e-7.
const ON_SIDE_DEG: f64 = 1e-6;

const CUT_OFF: &str = "a coastline that breaks off inside the data";
const AGAINST: &str = "coastlines that disagree on which side is land";

/// Gives the coastlines among features the area of the sea, or the reason why they have none.
pub fn join(features: &mut [RawFeature]) {
    let is_coast = |feature: &RawFeature| feature.element == Element::Way && feature.tags.is("natural", "coastline");
    let coasts: Vec<usize> = (0..features.len()).filter(|at| is_coast(&features[*at])).collect();
    let lines: Vec<(usize, &[DVec2])> = coasts
        .iter()
        .flat_map(|at| match &features[*at].shape {
            Shape::Lines(lines) => lines.iter().map(|line| (*at, line.as_slice())).collect(),
            _ => Vec::new(),
        })
        .collect();
    if lines.is_empty() {
        return;
    }
    let (rings, chains) = joined(&lines);
    let all = lines.iter().flat_map(|(_, line)| line.iter().copied());
    let mut polygon = Polygon::default();
    let data = extent(features.iter().flat_map(points));
    let mut left_out: HashMap<usize, &'static str> = HashMap::new();
    match closed(&chains, extent(all), data) {
        Ok(outers) => polygon.outers = outers,
        Err(reason) => left_out.extend(chains.iter().flat_map(|chain| &chain.features).map(|at| (*at, reason))),
    }
    for ring in rings {
        if signed_area(&ring) < 0.0 { &mut polygon.outers } else { &mut polygon.inners }.push(ring);
    }
    if polygon.outers.is_empty() {
        // Islands alone: the sea about them.
        let reason = "an island whose sea is not in the data";
        coasts.iter().for_each(|at| _ = left_out.entry(*at).or_insert(reason));
    }
    let mut whole = Some(polygon);
    for at in coasts {
        let feature = &mut features[at];
        if let Some(reason) = left_out.get(&at) {
            feature.shape = Shape::Broken(reason);
            feature.area = AreaOf::Itself;
        } else if matches!(feature.shape, Shape::Lines(_)) {
            feature.tags.push("level_m", "0");
            feature.area = whole.take().map_or(AreaOf::Another, AreaOf::Whole);
        }
    }
}

/// Ways in a row, and which features they are.
struct Chain {
    points: Vec<DVec2>,
    features: Vec<usize>,
}

/// A box: west and south, east and north.
type Extent = (DVec2, DVec2);

fn points(feature: &RawFeature) -> Box<dyn Iterator<Item = DVec2> + '_> {
    match &feature.shape {
        Shape::Point(at) => Box::new(std::iter::once(*at)),
        Shape::Lines(lines) => Box::new(lines.iter().flatten().copied()),
        Shape::Polygon(polygon) => Box::new(polygon.outers.iter().flatten().copied()),
        Shape::Broken(_) => Box::new(std::iter::empty()),
    }
}

fn extent(points: impl Iterator<Item = DVec2>) -> Extent {
    points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
}

/// Lines joined where one ends at the first point of another: rings, without their first point repeated, and chains.
fn joined(lines: &[(usize, &[DVec2])]) -> (Vec<Vec<DVec2>>, Vec<Chain>) {
    let key = |at: DVec2| [at.x.to_bits(), at.y.to_bits()];
    let mut from: HashMap<[u64; 2], Vec<usize>> = HashMap::new();
    let mut ends: HashMap<[u64; 2], usize> = HashMap::new();
    for (number, (_, line)) in lines.iter().enumerate() {
        from.entry(key(line[0])).or_default().push(number);
        *ends.entry(key(line[line.len() - 1])).or_default() += 1;
    }
    let mut used = vec![false; lines.len()];
    let (mut rings, mut chains) = (Vec::new(), Vec::new());
    // First those that nothing runs into, so that a chain is found from its beginning.
    let begins = |number: &usize| !ends.contains_key(&key(lines[*number].1[0]));
    let order = (0..lines.len()).filter(begins).chain((0..lines.len()).filter(|number| !begins(number)));
    for first in order {
        if used[first] {
            continue;
        }
        let mut chain = Chain { points: vec![lines[first].1[0]], features: Vec::new() };
        let mut next = Some(first);
        while let Some(number) = next {
            used[number] = true;
            chain.points.extend(&lines[number].1[1..]);
            chain.features.push(lines[number].0);
            let end = chain.points[chain.points.len() - 1];
            next = if end == chain.points[0] {
                None
            } else {
                from.get_mut(&key(end)).and_then(|numbers| std::iter::from_fn(|| numbers.pop()).find(|n| !used[*n]))
            };
        }
        if chain.points.len() > 3 && chain.points.first() == chain.points.last() {
            chain.points.pop();
            rings.push(chain.points);
        } else {
            chains.push(chain);
        }
    }
    (rings, chains)
}

/// Outlines of the sea from chains; see the module.
fn closed(chains: &[Chain], coast: Extent, data: Extent) -> Result<Vec<Vec<DVec2>>, &'static str> {
    if chains.is_empty() {
        return Ok(Vec::new());
    }
    let tips = |chain: &Chain| [chain.points[0], chain.points[chain.points.len() - 1]];
    let on = |away: f64| away.abs() <= ON_SIDE_DEG;
    let any = |is: &dyn Fn(DVec2) -> bool| chains.iter().flat_map(tips).any(is);
    let (mut low, mut high) = coast;
    let (wide_low, wide_high) = ((low - MARGIN_DEG).max(data.0), (high + MARGIN_DEG).min(data.1));
    let (west, south) = (any(&|at| on(at.x - coast.0.x)), any(&|at| on(at.y - coast.0.y)));
    let (east, north) = (any(&|at| on(at.x - coast.1.x)), any(&|at| on(at.y - coast.1.y)));
    low = DVec2::new(if west { low.x } else { wide_low.x }, if south { low.y } else { wide_low.y });
    high = DVec2::new(if east { high.x } else { wide_high.x }, if north { high.y } else { wide_high.y });
    // Where ends lie along the box, clockwise from its south-western corner.
    let mut ends: Vec<(f64, usize, bool, DVec2)> = Vec::new();
    for (number, chain) in chains.iter().enumerate() {
        for (last, tip) in [false, true].into_iter().zip(tips(chain)) {
            let (at, away_deg) = nearest_side(low, high, tip);
            if away_deg > MARGIN_DEG {
                return Err(CUT_OFF);
            }
            ends.push((along(low, high, at), number, last, at));
        }
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    if (0..ends.len()).any(|at| ends[at].2 == ends[(at + 1) % ends.len()].2) {
        return Err(AGAINST);
    }
    let mut used = vec![false; chains.len()];
    let mut outlines = Vec::new();
    for first in 0..chains.len() {
        let mut outline: Vec<DVec2> = Vec::new();
        let mut number = first;
        while !std::mem::replace(&mut used[number], true) {
            let place = |last| ends.iter().position(|end| end.1 == number && end.2 == last).unwrap_or(0);
            outline.push(ends[place(false)].3);
            outline.extend(&chains[number].points);
            let leaves = place(true);
            let enters = (leaves + 1) % ends.len();
            outline.push(ends[leaves].3);
            outline.extend(corners_between(low, high, ends[leaves].0, ends[enters].0));
            number = ends[enters].1;
        }
        if outline.len() >= 3 {
            outlines.push(outline);
        }
    }
    Ok(outlines)
}

/// The nearest place on a side, and how far away it is, degrees.
fn nearest_side(low: DVec2, high: DVec2, at: DVec2) -> (DVec2, f64) {
    let sides = [
        (DVec2::new(low.x, at.y), at.x - low.x),
        (DVec2::new(at.x, high.y), high.y - at.y),
        (DVec2::new(high.x, at.y), high.x - at.x),
        (DVec2::new(at.x, low.y), at.y - low.y),
    ];
    sides.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((at, 0.0))
}

/// How far along the box a place on its sides lies, clockwise from the south-western corner, 0..4.
fn along(low: DVec2, high: DVec2, at: DVec2) -> f64 {
    let size = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
    let share = (at - low) / size;
    let sides =
        [(share.x, share.y), (1.0 - share.y, 1.0 + share.x), (1.0 - share.x, 3.0 - share.y), (share.y, 4.0 - share.x)];
    sides.into_iter().min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).map_or(0.0, |(_, along)| along)
}

/// The box's corners on the way clockwise.
fn corners_between(low: DVec2, high: DVec2, from: f64, to: f64) -> Vec<DVec2> {
    let to = if to > from { to } else { to + 4.0 };
    let corner = |number: i32| match number.rem_euclid(4) {
        0 => low,
        1 => DVec2::new(low.x, high.y),
        2 => high,
        _ => DVec2::new(high.x, low.y),
    };
    (0..8).filter(|number| f64::from(*number) > from && f64::from(*number) < to).map(corner).collect()
}

/// Area of a ring, positive if it turns counter-clockwise: land, then, within a coastline.
fn signed_area(ring: &[DVec2]) -> f64 {
    let Some(&first) = ring.first() else { return 0.0 };
    0.5 * ring.windows(2).map(|ends| (ends[0] - first).perp_dot(ends[1] - first)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::super::raw::Tags;
    use super::super::relations::holds;
    use super::*;

    fn feature(key: &str, value: &str, line: &[(f64, f64)]) -> RawFeature {
        let mut tags = Tags::default();
        tags.push(key, value);
        RawFeature::new(tags, Element::Way, Shape::Lines(vec![line.iter().map(|p| DVec2::from(*p)).collect()]))
    }

    fn coast(line: &[(f64, f64)]) -> RawFeature {
        feature("natural", "coastline", line)
    }

    fn is_sea(features: &[RawFeature], at: (f64, f64)) -> bool {
        let wholes = features.iter().filter_map(|feature| match &feature.area {
            AreaOf::Whole(polygon) => Some(polygon),
            _ => None,
        });
        wholes
            .flat_map(|polygon| polygon.outers.iter().chain(&polygon.inners))
            .filter(|ring| holds(ring, DVec2::from(at)))
            .count()
            % 2
            == 1
    }

    #[test]
    fn the_sea_is_right_of_a_coast_and_around_its_islands() {
        // Eastward, land to the north, in two ways out of order; an island and a road that says how far the data reach.
        let mut features = [
            coast(&[(0.5, 0.51), (0.8, 0.5), (1.0, 0.52)]),
            coast(&[(0.0, 0.5), (0.5, 0.51)]),
            coast(&[(0.4, 0.48), (0.5, 0.48), (0.45, 0.49), (0.4, 0.48)]),
            feature("highway", "track", &[(0.0, 0.0), (1.0, 1.0)]),
        ];
        join(&mut features);
        assert!(is_sea(&features, (0.1, 0.47)) && is_sea(&features, (0.9, 0.49)));
        // North of the coast, on the island, and farther south than the margin.
        assert!(![(0.1, 0.6), (0.45, 0.483), (0.1, 0.40)].into_iter().any(|at| is_sea(&features, at)));
        let others = features[..3].iter().filter(|feature| feature.area == AreaOf::Another).count();
        assert!(others == 2 && features[..3].iter().all(|feature| feature.tags.is("level_m", "0")));
        assert_eq!(features[3].area, AreaOf::Itself);
    }

    #[test]
    fn two_coasts_make_a_strait() {
        let mut features = [coast(&[(0.0, 0.5), (1.0, 0.5)]), coast(&[(1.0, 0.47), (0.0, 0.46)])];
        join(&mut features);
        assert!(is_sea(&features, (0.5, 0.48)));
        assert!(!is_sea(&features, (0.5, 0.45)) && !is_sea(&features, (0.5, 0.51)));
    }

    #[test]
    fn a_coast_with_a_gap_or_against_another_is_left_out_with_the_reason() {
        let gap = [coast(&[(0.0, 0.0), (0.3, 0.5)]), coast(&[(0.6, 0.5), (1.0, 1.0)])];
        let against = [coast(&[(0.0, 0.5), (1.0, 0.5)]), coast(&[(0.0, 0.6), (1.0, 0.6)])];
        let island = [coast(&[(0.4, 0.4), (0.5, 0.4), (0.45, 0.42), (0.4, 0.4)]), coast(&[(0.0, 0.0), (0.0, 0.0)])];
        for (mut features, reason) in [(gap, CUT_OFF), (against, AGAINST)] {
            join(&mut features);
            assert!(features.iter().all(|feature| feature.shape == Shape::Broken(reason)), "{features:?}");
        }
        let mut island = island;
        join(&mut island);
        assert!(island.iter().all(|feature| matches!(feature.shape, Shape::Broken(_) | Shape::Lines(_))));
    }
}
