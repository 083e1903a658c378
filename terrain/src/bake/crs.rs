//! The coordinate systems that height data comes in.
//!
//! Two kinds: longitude and latitude in degrees, or a transverse Mercator map in metres (UTM and its like), each on a
//! datum. Datums are tied to WGS84 by one mean three-parameter shift of the Earth's centre, without grids: exact for
//! WGS84, within a metre for NAD83 and ETRS89, +-10 m for NAD27 and ED50. Heights are not changed.
//!
//! Source of the shifts: NIMA TR8350.2, 3rd edition, appendix B (NAD27: mean of the conterminous United States; ED50:
//! mean of western Europe). Codes: the EPSG registry.

use crate::projection::{Ellipsoid, Geodetic, TransverseMercator, WGS84};
use glam::{DVec2, DVec3};

/// An ellipsoid and where its centre lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Datum {
    /// As a person would call it.
    pub name: &'static str,
    /// The ellipsoid of its latitudes.
    pub ellipsoid: Ellipsoid,
    /// To be added to geocentric coordinates to reach WGS84, metres; `None`: the same as WGS84.
    pub shift_m: Option<DVec3>,
}

/// A coordinate system of height data.
#[derive(Debug, Clone, PartialEq)]
pub enum Crs {
    /// x longitude, y latitude, degrees.
    Geographic(Datum),
    /// x easting, y northing, metres.
    TransverseMercator {
        /// The map.
        map: Box<TransverseMercator>,
        /// What it is a map of.
        datum: Datum,
        /// As a person would call it.
        name: String,
    },
}

const GRS80: Ellipsoid = Ellipsoid { a_m: 6_378_137.0, f: 1.0 / 298.257_222_101 };
const CLARKE_1866: Ellipsoid = Ellipsoid { a_m: 6_378_206.4, f: 1.0 / 294.978_698_2 };
const INTERNATIONAL_1924: Ellipsoid = Ellipsoid { a_m: 6_378_388.0, f: 1.0 / 297.0 };
const WGS72_ELLIPSOID: Ellipsoid = Ellipsoid { a_m: 6_378_135.0, f: 1.0 / 298.26 };

/// The world's own datum.
pub const DATUM_WGS84: Datum = Datum { name: "WGS84", ellipsoid: WGS84, shift_m: None };
/// North American Datum 1927, mean shift.
pub const DATUM_NAD27: Datum =
    Datum { name: "NAD27", ellipsoid: CLARKE_1866, shift_m: Some(DVec3::new(-8.0, 160.0, 176.0)) };
/// North American Datum 1983; its ellipsoid differs from WGS84's by 0.1 mm.
pub const DATUM_NAD83: Datum = Datum { name: "NAD83", ellipsoid: GRS80, shift_m: None };
/// World Geodetic System 1972.
pub const DATUM_WGS72: Datum =
    Datum { name: "WGS72", ellipsoid: WGS72_ELLIPSOID, shift_m: Some(DVec3::new(0.0, 0.0, 4.5)) };
const DATUM_ETRS89: Datum = Datum { name: "ETRS89", ellipsoid: GRS80, shift_m: None };
const DATUM_ED50: Datum =
    Datum { name: "ED50", ellipsoid: INTERNATIONAL_1924, shift_m: Some(DVec3::new(-87.0, -98.0, -121.0)) };

impl Crs {
    /// The system of an EPSG code; `None` if it is not one of those known here.
    pub fn from_epsg(code: u32) -> Option<Self> {
        if let Some(datum) = geographic_datum(code) {
            return Some(Self::Geographic(datum));
        }
        let (zone, south, datum) = match code {
            32_601..=32_660 => (code - 32_600, false, DATUM_WGS84),
            32_701..=32_760 => (code - 32_700, true, DATUM_WGS84),
            32_201..=32_260 => (code - 32_200, false, DATUM_WGS72),
            32_301..=32_360 => (code - 32_300, true, DATUM_WGS72),
            26_701..=26_722 => (code - 26_700, false, DATUM_NAD27),
            26_901..=26_923 => (code - 26_900, false, DATUM_NAD83),
            25_828..=25_838 => (code - 25_800, false, DATUM_ETRS89),
            23_028..=23_038 => (code - 23_000, false, DATUM_ED50),
            _ => return None,
        };
        Some(Self::utm(zone, south, datum))
    }

    /// Universal transverse Mercator; zone 1..=60.
    pub fn utm(zone: u32, south: bool, datum: Datum) -> Self {
        let origin = Geodetic::from_degrees(0.0, f64::from(zone) * 6.0 - 183.0);
        let origin_m = DVec2::new(500_000.0, if south { 10_000_000.0 } else { 0.0 });
        let map = Box::new(TransverseMercator::new(datum.ellipsoid, origin, 0.9996, origin_m));
        let name = format!("UTM zone {zone}{} {}", if south { "S" } else { "N" }, datum.name);
        Self::TransverseMercator { map, datum, name }
    }

    /// As a person would call it.
    pub fn name(&self) -> String {
        match self {
            Self::Geographic(datum) => format!("longitude and latitude, {}", datum.name),
            Self::TransverseMercator { name, .. } => name.clone(),
        }
    }

    /// What a person must know about its accuracy, if anything.
    pub fn note(&self) -> Option<&'static str> {
        self.datum().shift_m.map(|_| "tied to WGS84 by a mean shift without grids: +-10 m in plan")
    }

    /// The datum.
    pub fn datum(&self) -> &Datum {
        match self {
            Self::Geographic(datum) | Self::TransverseMercator { datum, .. } => datum,
        }
    }

    /// Coordinates in this system of a place on WGS84.
    pub fn from_wgs84(&self, at: Geodetic) -> DVec2 {
        let at = match self.datum().shift_m {
            Some(shift_m) => shifted(at, &WGS84, &self.datum().ellipsoid, -shift_m),
            None => at,
        };
        match self {
            Self::Geographic(_) => DVec2::new(at.lon_deg(), at.lat_deg()),
            Self::TransverseMercator { map, .. } => map.forward(at),
        }
    }

    /// The place on WGS84 of coordinates in this system.
    pub fn to_wgs84(&self, at: DVec2) -> Geodetic {
        let place = match self {
            Self::Geographic(_) => Geodetic::from_degrees(at.y, at.x),
            Self::TransverseMercator { map, .. } => map.inverse(at),
        };
        match self.datum().shift_m {
            Some(shift_m) => shifted(place, &self.datum().ellipsoid, &WGS84, shift_m),
            None => place,
        }
    }
}

/// The datum of a geographic EPSG code.
pub fn geographic_datum(code: u32) -> Option<Datum> {
    match code {
        4326 | 4979 => Some(DATUM_WGS84),
        4267 => Some(DATUM_NAD27),
        4269 => Some(DATUM_NAD83),
        4322 => Some(DATUM_WGS72),
        4258 => Some(DATUM_ETRS89),
        4230 => Some(DATUM_ED50),
        _ => None,
    }
}

/// A place moved from one ellipsoid to another through geocentric coordinates, at the height of the ellipsoid.
fn shifted(at: Geodetic, from: &Ellipsoid, to: &Ellipsoid, shift_m: DVec3) -> Geodetic {
    let (sin_lat, cos_lat) = at.lat_rad.sin_cos();
    let (sin_lon, cos_lon) = at.lon_rad.sin_cos();
    let e2 = from.f * (2.0 - from.f);
    let normal_m = from.a_m / (1.0 - e2 * sin_lat * sin_lat).sqrt();
    let point = normal_m * DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, (1.0 - e2) * sin_lat) + shift_m;
    // Bowring's formula: exact on the ellipsoid, below a micrometre within a kilometre of it.
    let level = point.x.hypot(point.y);
    let polar_m = to.a_m * (1.0 - to.f);
    let e2 = to.f * (2.0 - to.f);
    let (sin_u, cos_u) = (point.z * to.a_m).atan2(level * polar_m).sin_cos();
    let second = e2 / (1.0 - e2) * polar_m * sin_u.powi(3);
    let lat_rad = (point.z + second).atan2(level - e2 * to.a_m * cos_u.powi(3));
    Geodetic { lat_rad, lon_rad: point.y.atan2(point.x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROJ: [(u32, f64, f64, f64, f64); 6] = [
        (26710, 46.2, -122.2, 561815.8496, 5116384.3768),
        (4267, 46.2, -122.2, -122.198807689, 46.200191421),
        (23031, 42.5, 1.5, 376841.6711, 4706585.2507),
        (32705, -19.8, -155.5, 238093.7600, 7808714.0649),
        (32605, 63.1, -151.0, 600946.3184, 6998302.4366),
        (26911, 34.3, -118.2, 389570.7218, 3796071.9218),
    ];

    /// EPSG code, latitude and longitude (degrees, WGS84), x, y by PROJ 9.5.1 (`cs2cs`, datum shift as `+towgs84=`).
    #[test]
    fn agrees_with_proj() {
        for (code, lat, lon, x, y) in PROJ {
            let crs = Crs::from_epsg(code).unwrap();
            let place = Geodetic::from_degrees(lat, lon);
            let at = crs.from_wgs84(place);
            let tolerance = if code < 5000 { 1e-8 } else { 1e-3 };
            assert!((at - DVec2::new(x, y)).length() < tolerance, "{code}: {at}, expected {x}, {y}");
            let back = crs.to_wgs84(at);
            // A shift taken at height 0 both ways: the ellipsoids part by up to 100 m, 2e-5 of a 300 m shift.
            let apart = (back.lat_rad - lat.to_radians()).hypot(back.lon_rad - lon.to_radians());
            assert!(apart * 6.4e6 < 0.02, "{code}: {apart}");
        }
        assert_eq!(Crs::from_epsg(3857), None);
    }
}
