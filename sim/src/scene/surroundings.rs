//! What surrounds the entities of a scene: the Earth, the air, its motion, and the seed of everything random.
//!
//! A scene is flat: the world's plane. Over a place of known latitude gravity falls with height as over the sphere that
//! the plane touches there, and the Earth's rotation adds Coriolis; without one it is a plane with standard gravity.
//! The frame of models and shells is north, east, down from the world's origin; [`crate::frame`] turns it.
//!
//! Source: NIMA TR8350.2, WGS 84, 1997, equation 4-1 (Somigliana's gravity at the ellipsoid, its constants table 3.4).

use super::Refused;
use super::codec::{Coded, Reader, SaveError, coded};
use crate::atmosphere::{AirSample, Atmosphere, Layers};
use crate::planet::{EARTH_MEAN_RADIUS_M, EARTH_ROTATION_RADPS, Gravity, Place, Planet, Shape};
use crate::random::Stream;
use crate::turbulence::Dryden;
use crate::wind::Wind;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Fastest wind and turbulence taken, m/s.
pub const MOST_WIND_MPS: f64 = 500.0;

/// Earth, air and seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Surroundings {
    lat_rad: Option<f64>,
    planet: Planet,
    /// The air by height.
    pub atmosphere: Atmosphere,
    /// Its motion: of now, if commands changed it.
    pub wind: Wind,
    /// Standard deviation of turbulence, m/s; 0 is none.
    pub turbulence_mps: f64,
    /// The scenario's seed: what is random depends on it, an entity's id and a round's number, and on nothing else.
    pub seed: u64,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self {
            lat_rad: None,
            planet: Planet::flat(),
            atmosphere: Atmosphere::standard(),
            wind: Wind::still(),
            turbulence_mps: 0.0,
            seed: 0,
        }
    }
}

impl Surroundings {
    /// Standard air over a place at this latitude.
    ///
    /// # Errors
    /// [`Refused`] if it is no latitude.
    pub fn over(lat_rad: f64) -> Result<Self, Refused> {
        if !(lat_rad.is_finite() && lat_rad.abs() <= FRAC_PI_2) {
            return Err(Refused::new(format_args!("lat_rad: expected a latitude within +-pi/2, found {lat_rad}")));
        }
        let sin2 = lat_rad.sin().powi(2);
        let plumb_mps2 =
            9.780_325_335_9 * (1.0 + 0.001_931_852_652_41 * sin2) / (1.0 - 0.006_694_379_990_14 * sin2).sqrt();
        let planet = Planet {
            shape: Shape::Flat { origin: Place { lat_rad, ..Place::default() }, radius_m: EARTH_MEAN_RADIUS_M },
            gravity: Gravity::PlumbInverseSquare(plumb_mps2),
            rotation_radps: EARTH_ROTATION_RADPS,
        };
        Ok(Self { lat_rad: Some(lat_rad), planet, ..Self::default() })
    }

    /// The same with no gravity at all: a proving ground for what only forces do.
    #[must_use]
    pub fn weightless(self) -> Self {
        let planet = Planet { gravity: Gravity::Constant(0.0), ..Planet::flat() };
        Self { lat_rad: None, planet, ..self }
    }

    /// The Earth.
    pub fn planet(&self) -> Planet {
        self.planet
    }

    pub(super) fn check(&self) -> Result<(), Refused> {
        Self::checked_wind(&self.wind.rows)?;
        Self::checked_turbulence(self.turbulence_mps).map(|_| ())
    }

    pub(super) fn checked_wind(rows: &[(f64, DVec3)]) -> Result<Wind, Refused> {
        let bad = |(height_m, velocity): &(f64, DVec3)| {
            !height_m.is_finite() || !velocity.is_finite() || velocity.length() > MOST_WIND_MPS
        };
        if let Some(row) = rows.iter().position(bad) {
            let (height_m, velocity) = rows[row];
            return Err(Refused::new(format_args!(
                "wind[{row}]: expected a height and a velocity of at most {MOST_WIND_MPS} m/s, found {height_m}, {velocity}"
            )));
        }
        Wind::new(rows.to_vec()).map_err(|error| {
            let (row, before_m, found_m) = (error.row, error.before_m, error.found_m);
            Refused::new(format_args!("wind[{row}]: expected a height above {before_m} m, found {found_m}"))
        })
    }

    pub(super) fn checked_turbulence(sigma_mps: f64) -> Result<f64, Refused> {
        if (0.0..=MOST_WIND_MPS).contains(&sigma_mps) {
            Ok(sigma_mps)
        } else {
            Err(Refused::new(format_args!("turbulence: expected 0..={MOST_WIND_MPS} m/s, found {sigma_mps}")))
        }
    }
}

impl Coded for Surroundings {
    fn put(&self, out: &mut Vec<u8>) {
        self.lat_rad.put(out);
        (self.planet.gravity == Gravity::Constant(0.0)).put(out);
        self.atmosphere.put(out);
        self.wind.rows.put(out);
        self.turbulence_mps.put(out);
        self.seed.put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let refuse = |from: &Reader<'_>, why: Refused| from.refuse(why);
        let base = match from.take::<Option<f64>>()? {
            Some(lat_rad) => Self::over(lat_rad).map_err(|why| refuse(from, why))?,
            None => Self::default(),
        };
        let base = if from.take()? { base.weightless() } else { base };
        let atmosphere = from.take()?;
        let wind = Self::checked_wind(&from.take::<Vec<_>>()?).map_err(|why| refuse(from, why))?;
        let turbulence_mps = Self::checked_turbulence(from.take()?).map_err(|why| refuse(from, why))?;
        Ok(Self { atmosphere, wind, turbulence_mps, seed: from.take()?, ..base })
    }
}

coded!(Layers { bases, humidity });
coded!(AirSample { density_kgpm3, pressure_pa, temperature_k, sound_mps });
coded!(Stream { state });
coded!(Dryden { sigma_mps, stream, along, across });

impl Coded for Atmosphere {
    fn put(&self, out: &mut Vec<u8>) {
        match self {
            Self::None => out.push(0),
            Self::Constant(sample) => {
                out.push(1);
                sample.put(out);
            }
            Self::Layered(layers) => {
                out.push(2);
                layers.put(out);
            }
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        match from.take::<u8>()? {
            0 => Ok(Self::None),
            1 => {
                let sample: AirSample = from.take()?;
                let AirSample { density_kgpm3, pressure_pa, temperature_k, sound_mps } = sample;
                if density_kgpm3 >= 0.0 && pressure_pa >= 0.0 && temperature_k > 0.0 && sound_mps > 0.0 {
                    Ok(Self::Constant(sample))
                } else {
                    Err(from.refuse("air: expected numbers above 0"))
                }
            }
            2 => {
                let layers: Layers = from.take()?;
                if layers.bases.iter().all(|(k, pa)| *k > 0.0 && *pa >= 0.0) && (0.0..=1.0).contains(&layers.humidity) {
                    Ok(Self::Layered(layers))
                } else {
                    Err(from.refuse("air: expected temperatures above 0 and a humidity of 0..=1"))
                }
            }
            found => Err(from.refuse(format_args!("air: expected 0..=2, found {found}"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_over_a_place_is_the_ellipsoids_and_turns_what_moves() {
        // TR8350.2, table 3.4: 9.7803253359 at the equator, 9.8321849378 at the pole; ten digits printed.
        for (lat_rad, expected) in [(0.0, 9.780_325_335_9), (FRAC_PI_2, 9.832_184_937_8)] {
            let planet = Surroundings::over(lat_rad).unwrap().planet();
            assert!((planet.gravity_mps2(DVec3::ZERO) - expected).abs() < 1e-9);
        }
        let planet = Surroundings::over(0.7).unwrap().planet();
        assert!(planet.fall_mps2(DVec3::ZERO, DVec3::X * 100.0).y > 0.0, "north goes east");
        assert!(planet.gravity_mps2(DVec3::Z * -10_000.0) < planet.gravity_mps2(DVec3::ZERO));
        assert_eq!(Surroundings::default().planet().rotation_radps, 0.0);
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for lat_rad in [f64::NAN, 1.6, f64::INFINITY] {
            assert!(Surroundings::over(lat_rad).unwrap_err().to_string().contains("expected a latitude"));
        }
        assert!(Surroundings::checked_wind(&[(0.0, DVec3::NAN)]).is_err());
        assert!(Surroundings::checked_wind(&[(f64::NAN, DVec3::X)]).is_err());
        assert!(Surroundings::checked_wind(&[(1.0, DVec3::X), (0.0, DVec3::X)]).is_err());
        assert!(Surroundings::checked_turbulence(f64::NAN).is_err());
    }
}
