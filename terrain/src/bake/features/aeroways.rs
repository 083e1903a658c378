//! Runways, taxiways, aprons and airfields as OpenStreetMap draws them, on the world's plane.

use crate::features::model::RunwaySurface;
use glam::DVec2;

/// What is drawn of airfields, before anybody knows whose it is.
#[derive(Debug, Clone, Default)]
pub struct Aeroways {
    /// Runways.
    pub runways: Vec<DrawnRunway>,
    /// Middles of taxiways and their width; those of one feature together.
    pub taxiways: Vec<(Vec<Vec<DVec2>>, f32)>,
    /// Outlines of aprons; those of one feature together.
    pub aprons: Vec<Vec<Vec<DVec2>>>,
    /// Airfields.
    pub aerodromes: Vec<Aerodrome>,
}

/// A runway as drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnRunway {
    /// Middles of its ends.
    pub ends: [DVec2; 2],
    /// Width, if stated or drawn.
    pub width_m: Option<f32>,
    /// Its designators, if stated.
    pub designators: Option<[String; 2]>,
    /// What it is made of.
    pub surface: RunwaySurface,
    /// Whether it has lights, if stated.
    pub lit: Option<bool>,
    /// Features that it was made of.
    pub features: usize,
}

/// An airfield as drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Aerodrome {
    /// Its code; may be empty.
    pub code: String,
    /// Its name; may be empty.
    pub name: String,
    /// Its middle.
    pub at: DVec2,
    /// Its elevation, if stated.
    pub elevation_m: Option<f64>,
}

impl Aeroways {
    /// Whether there is nothing at all.
    pub fn is_empty(&self) -> bool {
        self.runways.is_empty() && self.taxiways.is_empty() && self.aprons.is_empty() && self.aerodromes.is_empty()
    }
}

impl DrawnRunway {
    /// Length between its ends.
    pub fn length_m(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }
}

/// The middles of a ring's short sides and their length: those of the rectangle of least area about it.
pub fn ends_of_ring(ring: &[DVec2]) -> Option<([DVec2; 2], f64)> {
    let mut best: Option<(f64, [DVec2; 2], f64)> = None;
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        let Some(along) = (*b - *a).try_normalize() else { continue };
        let across = along.perp();
        let range = |axis: DVec2| {
            let all = ring.iter().map(|at| at.dot(axis));
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)))
        };
        let ((low, high), (left, right)) = (range(along), range(across));
        let area = (high - low) * (right - left);
        if high - low >= right - left && best.as_ref().is_none_or(|(least, ..)| area < *least) {
            let middle = across * (0.5 * (left + right));
            best = Some((area, [middle + along * low, middle + along * high], right - left));
        }
    }
    best.map(|(_, ends, width_m)| (ends, width_m))
}

/// Runways that are drawn in pieces become whole, whatever the order: pieces of the same designators that end at the same
/// point. The whole has the place of its first piece, and lights if any piece has.
pub fn merge_pieces(runways: &mut Vec<DrawnRunway>) {
    let mut done: Vec<DrawnRunway> = Vec::with_capacity(runways.len());
    for mut whole in runways.drain(..) {
        let mut place = done.len();
        // What has grown may meet others.
        while let Some((at, joined)) = done.iter().enumerate().find_map(|(at, other)| Some((at, other.joined(&whole)?)))
        {
            done.remove(at);
            place = place.min(at);
            whole = joined;
        }
        done.insert(place.min(done.len()), whole);
    }
    *runways = done;
}

impl DrawnRunway {
    /// With another piece of it; `None` if that is none.
    fn joined(&self, piece: &Self) -> Option<Self> {
        /// Nodes that both pieces have are the same point but for rounding.
        const SAME_M: f64 = 1.0;
        if self.designators.is_none() || self.designators != piece.designators {
            return None;
        }
        let meet = |(i, j): &(usize, usize)| self.ends[*i].distance(piece.ends[*j]) < SAME_M;
        let (i, j) = [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().find(meet)?;
        let mut whole = self.clone();
        whole.ends[i] = piece.ends[1 - j];
        whole.features += piece.features;
        whole.width_m = self.width_m.or(piece.width_m);
        whole.lit = match (self.lit, piece.lit) {
            (Some(one), Some(other)) => Some(one || other),
            (one, other) => one.or(other),
        };
        // Pieces of equal ends are one runway drawn twice, and both together have no length.
        (whole.length_m() > self.length_m().max(piece.length_m())).then_some(whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_has_ends() {
        let (along, across) = (DVec2::from_angle(0.3), DVec2::from_angle(0.3).perp());
        let corner = |u: f64, v: f64| along * u + across * v;
        let ring = [corner(0.0, 0.0), corner(900.0, 0.0), corner(900.0, 30.0), corner(0.0, 30.0)];
        let (ends, width_m) = ends_of_ring(&ring).unwrap();
        assert!((width_m - 30.0).abs() < 1e-9);
        assert!(ends[0].distance(corner(0.0, 15.0)) < 1e-9 && ends[1].distance(corner(900.0, 15.0)) < 1e-9);
        assert_eq!(ends_of_ring(&[DVec2::ZERO; 3]), None);
    }

    #[test]
    fn pieces_become_one() {
        let piece = |from: f64, to: f64| DrawnRunway {
            ends: [DVec2::new(from, 0.0), DVec2::new(to, 0.0)],
            width_m: None,
            designators: Some(["09".into(), "27".into()]),
            surface: RunwaySurface::Asphalt,
            lit: None,
            features: 1,
        };
        let mut runways = vec![piece(0.0, 300.0), piece(2_000.0, 300.0), piece(5_000.0, 6_000.0)];
        merge_pieces(&mut runways);
        assert_eq!((runways.len(), runways[0].length_m(), runways[0].features), (2, 2_000.0, 2));
        // In any order; and of what the pieces say of lights, yes counts most and nothing least.
        let parts = [(0.0, 300.0, None), (300.0, 600.0, Some(true)), (600.0, 900.0, Some(false))];
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let mut runways =
                order.map(|at| DrawnRunway { lit: parts[at].2, ..piece(parts[at].0, parts[at].1) }).to_vec();
            runways.insert(1, piece(5_000.0, 6_000.0));
            merge_pieces(&mut runways);
            let [whole, alone] = runways.as_slice() else { panic!("{order:?}: {runways:?}") };
            assert_eq!((whole.length_m(), whole.features, whole.lit), (900.0, 3, Some(true)), "{order:?}");
            assert_eq!((alone.length_m(), alone.lit), (1_000.0, None));
        }
        let mut twice = vec![piece(0.0, 300.0), piece(300.0, 0.0)];
        merge_pieces(&mut twice);
        assert_eq!(twice.len(), 2);
    }
}
