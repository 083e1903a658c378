//! World coordinates and geodetic ones: the only place that converts between them.
//!
//! A world's plane is a transverse Mercator map on WGS84 about the world's centre, scale 1 at the centre, no false
//! origin: world x is the easting, world z minus the northing. 200 km from the central meridian the map is 0.05 % too
//! long. Latitudes and longitudes are radians, distances metres. Input that is not finite gives NaN, never a panic.
//!
//! [`TransverseMercator`] is Krueger's series to the sixth order in the third flattening, better than a micrometre
//! within 3000 km of the meridian. It is written here and not taken from a crate because the bake calls it for every
//! post (0.15 us each way where proj4rs 0.3 takes 0.23), survey grids on other ellipsoids need it too, and the
//! convergence comes out of the same sums. A test holds it to proj4rs and to PROJ.
//!
//! Source: C. F. F. Karney, Transverse Mercator with an accuracy of a few nanometers, J. Geodesy 85, 2011, equations
//! 7-9, 11, 23-25, 35, 36; latitude from conformal latitude by the series of K. Kawase, Bull. GSI 59, 2011.

use glam::DVec2;
use std::f64::consts::{PI, TAU};
use std::fmt;

/// A place on the ellipsoid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    /// Geodetic latitude, radians, north positive.
    pub lat_rad: f64,
    /// Longitude, radians, east positive.
    pub lon_rad: f64,
}

/// The map of one world.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    centre: Geodetic,
    map: TransverseMercator,
}

/// An ellipsoid of revolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// Equatorial radius, metres.
    pub a_m: f64,
    /// Flattening.
    pub f: f64,
}

/// Transverse Mercator on any ellipsoid, with scale and false origin.
#[derive(Debug, Clone, PartialEq)]
pub struct TransverseMercator {
    lon_0_rad: f64,
    /// Scale times rectifying radius, metres.
    radius_m: f64,
    /// Added to easting and northing, metres.
    false_origin_m: DVec2,
    e: f64,
    alpha: [f64; 6],
    beta: [f64; 6],
    delta: [f64; 6],
}

/// Why a world cannot lie there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProjectionError {
    /// The centre's latitude is not within +-[`MAX_CENTRE_LAT_DEG`] or its longitude not within +-360 degrees.
    Centre {
        /// Latitude given, degrees.
        lat_deg: f64,
        /// Longitude given, degrees.
        lon_deg: f64,
    },
}

/// The northernmost and, negative, southernmost centre of a world: 400 km around it stay clear of the pole.
pub const MAX_CENTRE_LAT_DEG: f64 = 86.0;

/// WGS84.
pub const WGS84: Ellipsoid = Ellipsoid { a_m: 6_378_137.0, f: 1.0 / 298.257_223_563 };

impl fmt::Display for ProjectionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Centre { lat_deg, lon_deg } = self;
        write!(
            f,
            "a world's centre must lie within +-{MAX_CENTRE_LAT_DEG} degrees of latitude and +-360 of longitude, got {lat_deg}, {lon_deg}"
        )
    }
}

impl std::error::Error for ProjectionError {}

impl Geodetic {
    /// From degrees.
    pub fn from_degrees(lat_deg: f64, lon_deg: f64) -> Self {
        Self { lat_rad: lat_deg.to_radians(), lon_rad: lon_deg.to_radians() }
    }

    /// Latitude, degrees.
    pub fn lat_deg(&self) -> f64 {
        self.lat_rad.to_degrees()
    }

    /// Longitude, degrees.
    pub fn lon_deg(&self) -> f64 {
        self.lon_rad.to_degrees()
    }
}

impl Projection {
    /// The map about a centre.
    ///
    /// # Errors
    /// [`ProjectionError`] if the centre is not a place or too near a pole.
    pub fn new(centre: Geodetic) -> Result<Self, ProjectionError> {
        let (lat_deg, lon_deg) = (centre.lat_deg(), centre.lon_deg());
        // A rounding of the degrees given must not refuse the bound itself.
        if !(lat_deg.abs() <= MAX_CENTRE_LAT_DEG + 1e-9 && lon_deg.abs() <= 360.0 + 1e-9) {
            return Err(ProjectionError::Centre { lat_deg, lon_deg });
        }
        let centre = Geodetic { lat_rad: centre.lat_rad, lon_rad: wrapped_rad(centre.lon_rad) };
        Ok(Self { centre, map: TransverseMercator::new(WGS84, centre, 1.0, DVec2::ZERO) })
    }

    /// The place of the world's origin.
    pub fn centre(&self) -> Geodetic {
        self.centre
    }

    /// World x and z in metres of a place; NaN if it is not finite.
    pub fn to_world(&self, at: Geodetic) -> DVec2 {
        let map = self.map.forward(at);
        DVec2::new(map.x, -map.y)
    }

    /// The place at world x and z in metres, longitude within -pi..=pi; NaN if not finite.
    pub fn to_geodetic(&self, at: DVec2) -> Geodetic {
        self.map.inverse(DVec2::new(at.x, -at.y))
    }

    /// Bearing of grid north (-z) from true north, clockwise positive, radians: true heading = grid heading + this.
    pub fn grid_convergence_rad(&self, at: Geodetic) -> f64 {
        self.map.convergence_rad(at)
    }
}

impl TransverseMercator {
    /// A map with its natural origin at `origin`, the scale on its meridian and the easting and northing of the origin.
    pub fn new(ellipsoid: Ellipsoid, origin: Geodetic, scale: f64, origin_m: DVec2) -> Self {
        let Ellipsoid { a_m, f } = ellipsoid;
        let n = f / (2.0 - f);
        let n2 = n * n;
        let rectifying_m = a_m / (1.0 + n) * (1.0 + n2 * (1.0 / 4.0 + n2 * (1.0 / 64.0 + n2 / 256.0)));
        let series = |rows: &[[f64; 6]; 6]| rows.map(|row| n * row.iter().rev().fold(0.0, |sum, term| sum * n + term));
        let mut map = Self {
            lon_0_rad: origin.lon_rad,
            radius_m: scale * rectifying_m,
            false_origin_m: DVec2::ZERO,
            e: (f * (2.0 - f)).sqrt(),
            alpha: series(&ALPHA),
            beta: series(&BETA),
            delta: series(&DELTA),
        };
        map.false_origin_m = origin_m - map.forward(origin);
        map
    }

    /// Easting and northing, metres.
    pub fn forward(&self, at: Geodetic) -> DVec2 {
        let (xi, eta) = self.on_sphere(at);
        let (sum_xi, sum_eta) = clenshaw_sin(&self.alpha, xi, eta);
        self.false_origin_m + self.radius_m * DVec2::new(eta + sum_eta, xi + sum_xi)
    }

    /// The place at an easting and northing, longitude within -pi..=pi.
    pub fn inverse(&self, at_m: DVec2) -> Geodetic {
        let at = (at_m - self.false_origin_m) / self.radius_m;
        let (sum_xi, sum_eta) = clenshaw_sin(&self.beta, at.y, at.x);
        let (xi, eta) = (at.y - sum_xi, at.x - sum_eta);
        let (sin_xi, cos_xi) = xi.sin_cos();
        let (sinh_eta, cosh_eta) = sinh_cosh(eta);
        let level = sinh_eta.hypot(cos_xi);
        let chi = sin_xi.atan2(level);
        // cosh^2(eta) = sin^2(xi) + level^2, so these are the sine and cosine of the conformal latitude.
        let (sin_chi, cos_chi) = (sin_xi / cosh_eta, level / cosh_eta);
        let (sin_2, cos_2) = (2.0 * sin_chi * cos_chi, 1.0 - 2.0 * sin_chi * sin_chi);
        let (mut later, mut sum) = (0.0, 0.0);
        for term in self.delta.iter().rev() {
            (later, sum) = (sum, term + 2.0 * cos_2 * sum - later);
        }
        Geodetic { lat_rad: chi + sin_2 * sum, lon_rad: wrapped_rad(self.lon_0_rad + sinh_eta.atan2(cos_xi)) }
    }

    /// Bearing of grid north from true north, clockwise positive, radians.
    pub fn convergence_rad(&self, at: Geodetic) -> f64 {
        let (xi, eta) = self.on_sphere(at);
        // Derivative of the series, p - iq: its argument turns the sphere's convergence into the ellipsoid's.
        let (mut p, mut q) = (1.0, 0.0);
        for (j, term) in (1..).zip(self.alpha) {
            let k = 2.0 * f64::from(j);
            p += k * term * (k * xi).cos() * (k * eta).cosh();
            q += k * term * (k * xi).sin() * (k * eta).sinh();
        }
        // On the sphere tan(convergence) = tan(xi) tanh(eta).
        (xi.sin() * eta.sinh()).atan2(xi.cos() * eta.cosh()) + q.atan2(p)
    }

    /// The place on the conformal sphere's transverse Mercator map: northward and eastward, radians.
    fn on_sphere(&self, at: Geodetic) -> (f64, f64) {
        let (sin_lat, cos_lat) = at.lat_rad.sin_cos();
        let (sin_lon, cos_lon) = wrapped_rad(at.lon_rad - self.lon_0_rad).sin_cos();
        let tau = sin_lat / cos_lat;
        let sigma = (self.e * (self.e * sin_lat).atanh()).sinh();
        let conformal = tau * sigma.mul_add(sigma, 1.0).sqrt() - sigma * tau.mul_add(tau, 1.0).sqrt();
        let level = conformal.hypot(cos_lon);
        (conformal.atan2(cos_lon), (sin_lon / level).asinh())
    }
}

/// The angle within -pi..=pi; NaN if not finite.
pub(crate) fn wrapped_rad(angle_rad: f64) -> f64 {
    if (-PI..=PI).contains(&angle_rad) { angle_rad } else { (angle_rad + PI).rem_euclid(TAU) - PI }
}

/// Sum over j of c_j sin(2 j (xi + i eta)), real and imaginary part, by Clenshaw's recurrence.
fn clenshaw_sin(c: &[f64; 6], xi: f64, eta: f64) -> (f64, f64) {
    let (sin, cos) = (2.0 * xi).sin_cos();
    let (sinh, cosh) = sinh_cosh(2.0 * eta);
    let (re, im) = (2.0 * cos * cosh, -2.0 * sin * sinh);
    let (mut later, mut sum) = ((0.0, 0.0), (0.0, 0.0));
    for term in c.iter().rev() {
        let next = (term + re * sum.0 - im * sum.1 - later.0, re * sum.1 + im * sum.0 - later.1);
        (later, sum) = (sum, next);
    }
    let (a, b) = (sin * cosh, cos * sinh);
    (a * sum.0 - b * sum.1, a * sum.1 + b * sum.0)
}

/// Both hyperbolic functions from one exponential; near 0, where that cancels, the sine from its series.
fn sinh_cosh(x: f64) -> (f64, f64) {
    let e = x.exp();
    let (up, down) = (0.5 * e, 0.5 / e);
    let x2 = x * x;
    // Below 0.3 the first term left out is under 1e-16 of the sum.
    let sinh = if x.abs() < 0.3 {
        x * (1.0 + x2 / 6.0 * (1.0 + x2 / 20.0 * (1.0 + x2 / 42.0 * (1.0 + x2 / 72.0 * (1.0 + x2 / 110.0)))))
    } else {
        up - down
    };
    (sinh, up + down)
}

/// Row j: coefficients of n, n^2 .. n^6 in alpha_j (sphere to ellipsoid).
const ALPHA: [[f64; 6]; 6] = [
    [1.0 / 2.0, -2.0 / 3.0, 5.0 / 16.0, 41.0 / 180.0, -127.0 / 288.0, 7_891.0 / 37_800.0],
    [0.0, 13.0 / 48.0, -3.0 / 5.0, 557.0 / 1_440.0, 281.0 / 630.0, -1_983_433.0 / 1_935_360.0],
    [0.0, 0.0, 61.0 / 240.0, -103.0 / 140.0, 15_061.0 / 26_880.0, 167_603.0 / 181_440.0],
    [0.0, 0.0, 0.0, 49_561.0 / 161_280.0, -179.0 / 168.0, 6_601_661.0 / 7_257_600.0],
    [0.0, 0.0, 0.0, 0.0, 34_729.0 / 80_640.0, -3_418_889.0 / 1_995_840.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 212_378_941.0 / 319_334_400.0],
];

/// The same for beta_j (ellipsoid to sphere).
const BETA: [[f64; 6]; 6] = [
    [1.0 / 2.0, -2.0 / 3.0, 37.0 / 96.0, -1.0 / 360.0, -81.0 / 512.0, 96_199.0 / 604_800.0],
    [0.0, 1.0 / 48.0, 1.0 / 15.0, -437.0 / 1_440.0, 46.0 / 105.0, -1_118_711.0 / 3_870_720.0],
    [0.0, 0.0, 17.0 / 480.0, -37.0 / 840.0, -209.0 / 4_480.0, 5_569.0 / 90_720.0],
    [0.0, 0.0, 0.0, 4_397.0 / 161_280.0, -11.0 / 504.0, -830_251.0 / 7_257_600.0],
    [0.0, 0.0, 0.0, 0.0, 4_583.0 / 161_280.0, -108_847.0 / 3_991_680.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 20_648_693.0 / 638_668_800.0],
];

/// The same for the geodetic latitude from the conformal one.
const DELTA: [[f64; 6]; 6] = [
    [2.0, -2.0 / 3.0, -2.0, 116.0 / 45.0, 26.0 / 45.0, -2_854.0 / 675.0],
    [0.0, 7.0 / 3.0, -8.0 / 5.0, -227.0 / 45.0, 2_704.0 / 315.0, 2_323.0 / 945.0],
    [0.0, 0.0, 56.0 / 15.0, -136.0 / 35.0, -1_262.0 / 105.0, 73_814.0 / 2_835.0],
    [0.0, 0.0, 0.0, 4_279.0 / 630.0, -332.0 / 35.0, -399_572.0 / 14_175.0],
    [0.0, 0.0, 0.0, 0.0, 4_174.0 / 315.0, -144_838.0 / 6_237.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 601_676.0 / 22_275.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Centre, place (degrees), easting, northing (metres), meridian convergence (degrees), by PROJ 9.5.1 (pyproj
    /// 3.7.2, `+proj=tmerc +k=1 +datum=WGS84`), printed to 0.01 mm and 1e-9 degrees.
    const PROJ: [[f64; 7]; 20] = [
        [42.425, 78.35, 42.425, 78.35, 0.00000, 0.00000, 0.0],
        [42.425, 78.35, 42.524722, 78.942928, 48718.96819, 11247.76003, 0.400772792],
        [42.425, 78.35, 41.139202, 80.034398, 141421.33981, -141444.55806, 1.108332923],
        [42.425, 78.35, 43.296412, 74.875148, -281987.49106, 102672.90576, -2.384523818],
        [-28.5, -71.5, -28.5, -71.5, 0.00000, 0.00000, 0.0],
        [-28.5, -71.5, -28.397603, -71.002863, 48719.00103, 11247.80274, -0.236436761],
        [-28.5, -71.5, -29.768054, -70.037755, 141421.36037, -141444.66603, -0.726110693],
        [-28.5, -71.5, -27.544188, -74.354237, -281987.76441, 102673.16635, 1.320764761],
        [68.0, -150.0, 68.0, -150.0, 0.00000, 0.00000, 0.0],
        [68.0, -150.0, 68.096706, -148.830132, 48718.95938, 11247.72713, 1.085441903],
        [68.0, -150.0, 66.699172, -146.79625, 141421.35990, -141444.41946, 2.942935462],
        [68.0, -150.0, 68.776516, -156.989901, -281987.04782, 102672.61902, -6.520054133],
        [-16.5, 179.9, -16.5, 179.9, 0.00000, 0.00000, 0.0],
        [-16.5, 179.9, -16.397866, -179.64392, 48718.90684, 11247.75096, -0.128756545],
        [-16.5, 179.9, -17.773527, -178.76643, 141421.35504, -141444.68719, -0.407147277],
        [-16.5, 179.9, -15.556484, 177.271961, -281987.88086, 102673.25583, 0.705276839],
        [0.0, 0.0, 0.0, 0.0, 0.00000, 0.00000, 0.0],
        [0.0, 0.0, 0.101718, 0.437646, 48718.93055, 11247.72464, 0.000776974],
        [0.0, 0.0, -1.278864, 1.270619, 141421.32220, -141444.69884, -0.028363095],
        [0.0, 0.0, 0.927633, -2.532641, -281988.01908, 102673.38614, -0.041029562],
    ];

    #[test]
    fn agrees_with_proj_to_its_printed_digits() {
        for [lat_0, lon_0, lat, lon, easting, northing, convergence] in PROJ {
            let projection = Projection::new(Geodetic::from_degrees(lat_0, lon_0)).unwrap();
            let place = Geodetic::from_degrees(lat, lon);
            let world = projection.to_world(place);
            assert!((world - DVec2::new(easting, -northing)).length() < 1e-5, "{world} at {lat}, {lon}");
            let turned = projection.grid_convergence_rad(place).to_degrees();
            // PROJ differentiates numerically.
            assert!((turned - convergence).abs() < 2e-7, "{turned}, expected {convergence}");
            let back = projection.to_geodetic(DVec2::new(easting, -northing));
            // 1e-5 m is 1.6e-12 rad of latitude, and up to 2.7 times that of longitude at 68 degrees.
            assert!((back.lat_rad - place.lat_rad).abs() < 2e-12 && (back.lon_rad - place.lon_rad).abs() < 5e-12);
        }
    }

    #[test]
    fn agrees_with_proj4rs() {
        let lonlat = proj4rs::Proj::from_proj_string("+proj=longlat +ellps=WGS84").unwrap();
        for (lat_0, lon_0) in [(42.425, 78.35), (-28.5, -71.5), (68.0, -150.0)] {
            let text = format!("+proj=etmerc +lat_0={lat_0} +lon_0={lon_0} +k=1 +ellps=WGS84");
            let map = proj4rs::Proj::from_proj_string(&text).unwrap();
            let projection = Projection::new(Geodetic::from_degrees(lat_0, lon_0)).unwrap();
            for (dlat, dlon) in [(0.1, 0.2), (-1.9, 2.4), (2.0, -3.0)] {
                let place = Geodetic::from_degrees(lat_0 + dlat, lon_0 + dlon);
                let mut point = (place.lon_rad, place.lat_rad, 0.0);
                proj4rs::transform::transform(&lonlat, &map, &mut point).unwrap();
                let world = projection.to_world(place);
                assert!((world - DVec2::new(point.0, -point.1)).length() < 1e-6, "{world} {point:?}");
            }
        }
    }

    #[test]
    fn there_and_back_is_below_a_tenth_of_a_micrometre() {
        for lat_0 in [-86.0, -40.0, 0.0, 42.425, 86.0] {
            let projection = Projection::new(Geodetic::from_degrees(lat_0, 179.0)).unwrap();
            for i in 0..400 {
                let at = DVec2::new(f64::from(i % 20 - 10) * 30_000.0, f64::from(i / 20 - 10) * 30_000.0);
                let back = projection.to_world(projection.to_geodetic(at));
                assert!((back - at).length() < 1e-7, "{at} became {back} about {lat_0}");
            }
        }
    }

    #[test]
    fn what_is_not_a_place_gives_nan_or_an_error() {
        let projection = Projection::new(Geodetic::from_degrees(42.0, 78.0)).unwrap();
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!projection.to_world(Geodetic { lat_rad: bad, lon_rad: 1.0 }).is_finite());
            assert!(!projection.to_world(Geodetic { lat_rad: 0.5, lon_rad: bad }).is_finite());
            let place = projection.to_geodetic(DVec2::new(bad, 0.0));
            assert!(!(place.lat_rad.is_finite() && place.lon_rad.is_finite()));
            assert!(Projection::new(Geodetic { lat_rad: bad, lon_rad: 0.0 }).is_err());
            assert!(Projection::new(Geodetic { lat_rad: 0.0, lon_rad: bad }).is_err());
        }
        assert!(Projection::new(Geodetic::from_degrees(89.0, 0.0)).is_err());
    }
}
