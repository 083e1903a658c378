//! The columns of a trajectory: their names, and the numbers that may end one.
//!
//! `x_m`, `y_m`, `z_m` are downrange, up and to the right in the plane that touches the Earth at the muzzle. Two names are
//! no columns of the file but may be asked: `range_m`, the way over the ground along the azimuth (on a flat Earth `x_m`;
//! else the length of the shortest way over the surface times the cosine of its bearing against the azimuth), and
//! `fall_deg`, the angle of the path under the horizontal of the place.

use crate::limit::{Limit, Relation};
use std::fmt;

/// A number of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // The names say it; see the module and `NAMES`.
pub enum Column {
    Time,
    X,
    Y,
    Z,
    Drop,
    Path,
    Vx,
    Vy,
    Vz,
    Speed,
    Mach,
    Lat,
    Lon,
    Altitude,
    Range,
    Fall,
}

/// Every column with its name; the first 14 are those of the file, in its order.
pub const NAMES: [(Column, &str); 16] = [
    (Column::Time, "t_s"),
    (Column::X, "x_m"),
    (Column::Y, "y_m"),
    (Column::Z, "z_m"),
    (Column::Drop, "drop_m"),
    (Column::Path, "path_m"),
    (Column::Vx, "vx_mps"),
    (Column::Vy, "vy_mps"),
    (Column::Vz, "vz_mps"),
    (Column::Speed, "speed_mps"),
    (Column::Mach, "mach"),
    (Column::Lat, "lat_deg"),
    (Column::Lon, "lon_deg"),
    (Column::Altitude, "altitude_m"),
    (Column::Range, "range_m"),
    (Column::Fall, "fall_deg"),
];

/// Columns of the file before `event`.
pub const IN_FILE: usize = 14;

/// What ends a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// The ground of a world; without one the altitude 0, met from above.
    Ground,
    /// The muzzle's altitude, met from above.
    Return,
    /// A column reaches a value.
    Column(Limit<Column>),
}

impl End {
    /// Reads `ground`, `NAME=value`, `NAME<value` or `NAME>value`.
    ///
    /// # Errors
    /// A sentence with what was expected and what was found.
    pub fn parse(text: &str) -> Result<Self, String> {
        let column = |name: &str| NAMES.iter().find(|(_, known)| *known == name).map(|(column, _)| *column);
        let limit = Limit::parse(text, column, || NAMES.map(|(_, name)| name).join(", "))?;
        Ok(limit.map_or(Self::Ground, Self::Column))
    }

    /// The name of the event.
    pub fn event(&self) -> &str {
        match self {
            Self::Ground => "ground",
            Self::Return => "muzzle_altitude",
            Self::Column(limit) => &limit.text,
        }
    }
}

impl Limit<Column> {
    /// How far a value is from the limit; for longitudes the short way round.
    pub fn beyond(&self, value: f64) -> f64 {
        let beyond = value - self.value;
        match self.column {
            Column::Lon if self.relation == Relation::Equal => (beyond + 180.0).rem_euclid(360.0) - 180.0,
            _ => beyond,
        }
    }

    /// Whether the limit is passed between two values of [`Self::beyond`].
    pub fn passed(&self, from: f64, to: f64) -> bool {
        // A longitude opposite to the limit changes its sign too.
        let around = self.relation == Relation::Equal && self.column == Column::Lon && (to - from).abs() > 180.0;
        !around && self.relation.passed(from, to)
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(NAMES.iter().find(|(column, _)| column == self).map_or("", |(_, name)| name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_read_and_what_is_wrong_is_told() {
        assert_eq!(End::parse("ground"), Ok(End::Ground));
        let Ok(End::Column(limit)) = End::parse(" range_m = 1500 ") else { panic!("not read") };
        assert_eq!((limit.column, limit.relation, limit.value), (Column::Range, Relation::Equal, 1500.0));
        let Ok(End::Column(limit)) = End::parse("altitude_m<-1e3") else { panic!("not read") };
        assert_eq!((limit.relation, limit.value, limit.text.as_str()), (Relation::Below, -1000.0, "altitude_m<-1e3"));
        for text in
            ["", "range_m", "range=5", "range_m=nan", "range_m=inf", "range_m=", "=5", "<", "x_m==5", "é=1", "Ground"]
        {
            assert!(End::parse(text).unwrap_err().contains("expected"), "{text}");
        }
    }

    #[test]
    fn the_date_line_is_no_limit() {
        let Ok(End::Column(limit)) = End::parse("lon_deg=0") else { panic!("not read") };
        assert!(!limit.passed(limit.beyond(179.9), limit.beyond(-179.9)));
        assert!(limit.passed(limit.beyond(-0.1), limit.beyond(0.1)));
        let Ok(End::Column(limit)) = End::parse("lon_deg=180") else { panic!("not read") };
        assert!(limit.passed(limit.beyond(179.9), limit.beyond(-179.9)));
    }
}
