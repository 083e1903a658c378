//! Where the air blows to, by height.
//!
//! A wind is the velocity OF the air, m/s, in north, east, down of the place; linear in height between rows, held below
//! the first and above the last. Turbulence comes on top of it (see [`crate::turbulence`]).

use glam::DVec3;

/// Wind by height.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Wind {
    /// Heights, metres, rising, and velocities.
    pub(crate) rows: Vec<(f64, DVec3)>,
}

/// A height that does not rise over the one before: its row, counted from 0, and the two heights, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NotRising {
    /// The row.
    pub row: usize,
    /// The height before.
    pub before_m: f64,
    /// The height found.
    pub found_m: f64,
}

impl Wind {
    /// Still air.
    pub fn still() -> Self {
        Self::default()
    }

    /// The wind of rows of height and velocity (north, east, down).
    ///
    /// # Errors
    /// [`NotRising`] names the first row that is not above the one before.
    pub fn new(rows: Vec<(f64, DVec3)>) -> Result<Self, NotRising> {
        let falls =
            rows.windows(2).position(|pair| pair[0].0.partial_cmp(&pair[1].0) != Some(std::cmp::Ordering::Less));
        match falls {
            Some(at) => Err(NotRising { row: at + 1, before_m: rows[at].0, found_m: rows[at + 1].0 }),
            None => Ok(Self { rows }),
        }
    }

    /// Whether there is none at any height.
    pub fn is_still(&self) -> bool {
        self.rows.iter().all(|row| row.1 == DVec3::ZERO)
    }

    /// The air's velocity at a height, m/s, north, east, down.
    #[inline]
    pub fn ned_mps(&self, altitude_m: f64) -> DVec3 {
        let Some(last) = self.rows.last() else { return DVec3::ZERO };
        let above = self.rows.partition_point(|row| row.0 <= altitude_m);
        if above == 0 {
            return self.rows[0].1;
        }
        let Some(&(high_m, high)) = self.rows.get(above) else { return last.1 };
        let (low_m, low) = self.rows[above - 1];
        low + (high - low) * ((altitude_m - low_m) / (high_m - low_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wind_is_linear_between_rows_and_held_outside() {
        let wind = Wind::new(vec![(0.0, DVec3::X), (100.0, DVec3::new(3.0, 4.0, 0.0))]).unwrap();
        assert_eq!(wind.ned_mps(-50.0), DVec3::X);
        assert_eq!(wind.ned_mps(50.0), DVec3::new(2.0, 2.0, 0.0));
        assert_eq!(wind.ned_mps(100.0), DVec3::new(3.0, 4.0, 0.0));
        assert_eq!(wind.ned_mps(f64::INFINITY), DVec3::new(3.0, 4.0, 0.0));
        assert!(wind.ned_mps(f64::NAN).is_finite());
        assert_eq!(Wind::still().ned_mps(10.0), DVec3::ZERO);
        let one = Wind::new(vec![(7.0, DVec3::Y)]).unwrap();
        assert_eq!((one.ned_mps(0.0), one.ned_mps(9.0)), (DVec3::Y, DVec3::Y));
    }

    #[test]
    fn rows_that_do_not_rise_are_refused() {
        let rows = vec![(0.0, DVec3::X), (10.0, DVec3::X), (10.0, DVec3::X)];
        assert_eq!(Wind::new(rows), Err(NotRising { row: 2, before_m: 10.0, found_m: 10.0 }));
        assert!(Wind::new(vec![(0.0, DVec3::X), (f64::NAN, DVec3::X)]).is_err());
    }
}
