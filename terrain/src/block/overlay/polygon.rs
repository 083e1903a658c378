//! Rings as triangles on the lattice.
//!
//! The triangulation is made once, from the ring alone, so every block cuts the same triangles.

use super::clip::Polygon;
use super::lattice::{Lattice, Spot};
use earcut::Earcut;
use glam::DVec2;

/// Most points of a ring that is drawn.
const MOST_POINTS: usize = 100_000;

/// Triangles of a ring; empty if it has no area, too many points or one beyond the lattice.
pub fn triangles(lattice: &Lattice, ring: &[DVec2]) -> Vec<Polygon> {
    let spots: Option<Vec<Spot>> = ring.iter().map(|at| lattice.spot(*at)).collect();
    let Some(mut spots) = spots.filter(|spots| spots.len() <= MOST_POINTS) else { return Vec::new() };
    spots.dedup();
    if spots.len() > 1 && spots.first() == spots.last() {
        spots.pop();
    }
    let Some(&first) = spots.first() else { return Vec::new() };
    // From the first spot on, so that products stay exact in f64 for anything the size of an airfield.
    let points = spots.iter().map(|spot| [(spot.u - first.u) as f64, (spot.v - first.v) as f64]);
    let mut places: Vec<u32> = Vec::new();
    Earcut::new().earcut(points, &[] as &[u32], &mut places);
    let corners = |triangle: &[u32]| Polygon::new(&[0, 1, 2].map(|at: usize| spots[triangle[at] as usize]));
    places.chunks_exact(3).filter_map(corners).collect()
}

#[cfg(test)]
mod tests {
    use super::super::lattice::twice_area;
    use super::*;
    use crate::grid::Grid;

    #[test]
    fn triangles_have_the_rings_area() {
        let lattice = Lattice::of(&Grid::centred(200.0, 1, 1).unwrap());
        let ring = [(0.0, 0.0), (300.0, 10.0), (310.0, 200.0), (150.0, 80.0), (20.0, 220.0)];
        let ring: Vec<DVec2> = ring.into_iter().map(DVec2::from).collect();
        let spots: Vec<Spot> = ring.iter().map(|at| lattice.spot(*at).unwrap()).collect();
        let exact: i128 = (1..4).map(|at| twice_area(spots[0], spots[at], spots[at + 1])).sum();
        let triangles = triangles(&lattice, &ring);
        let sum: i128 = triangles
            .iter()
            .map(|triangle| {
                let corners: Vec<Spot> = triangle.corners().collect();
                twice_area(corners[0], corners[1], corners[2])
            })
            .sum();
        assert_eq!((triangles.len(), sum), (3, exact.abs()));
    }

    #[test]
    fn hostile_rings_are_nothing_or_something_small() {
        let lattice = Lattice::of(&Grid::centred(200.0, 1, 1).unwrap());
        let p = DVec2::new;
        assert!(triangles(&lattice, &[p(0.0, 0.0), p(1.0, f64::NAN), p(1.0, 1.0)]).is_empty());
        assert!(triangles(&lattice, &[p(0.0, 0.0), p(0.0, 0.0), p(0.0, 0.0)]).is_empty());
        assert!(triangles(&lattice, &[p(0.0, 0.0), p(1e200, 0.0), p(0.0, 1.0)]).is_empty());
        // A bow tie has some triangles, and no panic.
        assert!(triangles(&lattice, &[p(0.0, 0.0), p(9.0, 9.0), p(9.0, 0.0), p(0.0, 9.0)]).len() <= 2);
    }
}
