//! The file of a case as it is written, and every check on the way to a [`Case`].

use super::{Attitude, Case, DEFAULT_WORLD, Initial, MOST_STEPS, RatesFrame, Run, Shot, Trim, Turbulence, Velocity};
use crate::atmosphere::{AirSample, Atmosphere, Layers, Station};
use crate::integrate::Integrator;
use crate::planet::{
    EARTH_GM_M3PS2, EARTH_J2, EARTH_MEAN_RADIUS_M, EARTH_ROTATION_RADPS, Gravity, Place, Planet, STANDARD_GRAVITY_MPS2,
    Shape,
};
use crate::wind::Wind;
use glam::DVec3;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use terrain::WGS84;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CaseFile {
    #[serde(default)]
    frame: FrameFile,
    #[serde(default)]
    atmosphere: AtmosphereFile,
    #[serde(default)]
    wind: Vec<WindFile>,
    turbulence: Option<TurbulenceFile>,
    #[serde(default)]
    initial: InitialFile,
    trim: Option<Trim>,
    #[serde(default)]
    run: RunFile,
    shot: Option<ShotFile>,
}

#[derive(Deserialize, Default, Clone, Copy, PartialEq)]
#[serde(rename_all = "snake_case")]
enum FrameKind {
    #[default]
    Flat,
    Round,
    Ellipsoid,
}

#[derive(Deserialize, Clone, Copy, PartialEq)]
#[serde(rename_all = "snake_case")]
enum GravityKind {
    Constant,
    InverseSquare,
    J2,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct FrameFile {
    #[serde(default)]
    kind: FrameKind,
    gravity: Option<GravityKind>,
    g_mps2: Option<f64>,
    gm_m3ps2: Option<f64>,
    j2: Option<f64>,
    radius_m: Option<f64>,
    rotation_radps: Option<f64>,
    latitude_deg: Option<f64>,
}

#[derive(Deserialize, Default, Clone, Copy, PartialEq)]
#[serde(rename_all = "snake_case")]
enum AtmosphereKind {
    #[default]
    Us1976,
    Constant,
    None,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct AtmosphereFile {
    #[serde(default)]
    model: AtmosphereKind,
    density_kgpm3: Option<f64>,
    station: Option<StationFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
struct StationFile {
    #[serde(default)]
    altitude_m: f64,
    temperature_K: Option<f64>,
    pressure_Pa: Option<f64>,
    #[serde(default)]
    humidity: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WindFile {
    #[serde(default)]
    altitude_m: f64,
    #[serde(default)]
    north_mps: f64,
    #[serde(default)]
    east_mps: f64,
    #[serde(default)]
    up_mps: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TurbulenceFile {
    kind: TurbulenceKind,
    sigma_mps: Option<f64>,
    #[serde(default)]
    seed: u64,
}

#[derive(Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum TurbulenceKind {
    None,
    Dryden,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct InitialFile {
    lat_deg: Option<f64>,
    lon_deg: Option<f64>,
    altitude_m: Option<f64>,
    north_m: Option<f64>,
    east_m: Option<f64>,
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    velocity_ned_mps: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    velocity_body_mps: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    attitude_deg: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    quaternion: Option<[f64; 4]>,
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    rates_degps: Option<[f64; 3]>,
    rates_frame: Option<RatesFrame>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RunFile {
    seconds: Option<f64>,
    dt_s: Option<f64>,
    output_dt_s: Option<f64>,
    #[serde(default)]
    integrator: Integrator,
    #[serde(default)]
    stop: Vec<String>,
    world: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShotFile {
    speed_mps: Option<f64>,
    elevation_deg: Option<f64>,
    azimuth_deg: Option<f64>,
    zero_range_m: Option<f64>,
    sight_height_m: Option<f64>,
    look_angle_deg: Option<f64>,
    until: Option<String>,
    step_m: Option<f64>,
    step_s: Option<f64>,
}

/// Checks that a number, if it is there, lies within bounds; the key and the bounds are told.
fn within(key: &str, value: Option<f64>, low: f64, high: f64) -> Result<(), String> {
    match value {
        Some(found) if !(low..=high).contains(&found) => {
            Err(format!("{key}: expected a number within {low} and {high}, found {found}"))
        }
        _ => Ok(()),
    }
}

impl CaseFile {
    pub(super) fn checked(self, file: &Path) -> Result<Case, String> {
        let origin = self.initial.checked_place()?;
        let planet = self.frame.planet(&self.initial, origin)?;
        Ok(Case {
            file: file.to_owned(),
            planet,
            atmosphere: self.atmosphere.checked()?,
            wind: wind(&self.wind)?,
            turbulence: self.turbulence.map(TurbulenceFile::checked).transpose()?.flatten(),
            initial: self.initial.checked(planet, origin)?,
            trim: self.trim,
            run: self.run.checked(file)?,
            shot: self.shot.map(ShotFile::checked).transpose()?,
        })
    }
}

impl FrameFile {
    fn planet(&self, initial: &InitialFile, place: Place) -> Result<Planet, String> {
        within("frame.g_mps2", self.g_mps2, 0.0, 1_000.0)?;
        within("frame.gm_m3ps2", self.gm_m3ps2, 0.0, 1e21)?;
        within("frame.j2", self.j2, -0.1, 0.1)?;
        within("frame.radius_m", self.radius_m, 1e5, 1e12)?;
        within("frame.rotation_radps", self.rotation_radps, -1.0, 1.0)?;
        within("frame.latitude_deg", self.latitude_deg, -90.0, 90.0)?;
        let (g, gm) = (self.g_mps2.unwrap_or(STANDARD_GRAVITY_MPS2), self.gm_m3ps2.unwrap_or(EARTH_GM_M3PS2));
        let radius_m = self.radius_m.unwrap_or(EARTH_MEAN_RADIUS_M);
        let kind = self.gravity.unwrap_or(match self.kind {
            FrameKind::Flat => GravityKind::Constant,
            FrameKind::Round => GravityKind::InverseSquare,
            FrameKind::Ellipsoid => GravityKind::J2,
        });
        let gravity = match (kind, self.kind) {
            (GravityKind::Constant, _) => Gravity::Constant(g),
            (GravityKind::InverseSquare, FrameKind::Flat) if self.gm_m3ps2.is_none() => Gravity::PlumbInverseSquare(g),
            (GravityKind::InverseSquare, _) => Gravity::InverseSquare(gm),
            (GravityKind::J2, FrameKind::Flat) => {
                return Err("frame.gravity: expected constant or inverse_square in a flat frame, found j2".to_owned());
            }
            (GravityKind::J2, _) => Gravity::J2(gm, self.j2.unwrap_or(EARTH_J2)),
        };
        let (shape, turning) = match self.kind {
            FrameKind::Flat => {
                // The plane touches the Earth where the body starts, unless a latitude is given.
                let lat_rad = self.latitude_deg.map_or(place.lat_rad, f64::to_radians);
                let lon_rad = if initial.lon_deg.is_some() { place.lon_rad } else { 0.0 };
                (Shape::Flat { origin: Place { lat_rad, lon_rad, altitude_m: 0.0 }, radius_m }, 0.0)
            }
            FrameKind::Round => (Shape::Round { radius_m }, EARTH_ROTATION_RADPS),
            FrameKind::Ellipsoid => {
                let of_wgs84 = |radius_m: &f64| (radius_m - WGS84.a_m).abs() < 1.0;
                if let Some(found) = self.radius_m.filter(|radius_m| !of_wgs84(radius_m)) {
                    return Err(format!(
                        "frame.radius_m: expected none or that of WGS84, {}, found {found}",
                        WGS84.a_m
                    ));
                }
                (Shape::Ellipsoid, EARTH_ROTATION_RADPS)
            }
        };
        // Elsewhere the latitude is the body's own; the same number there is no contradiction.
        let other = |lat_deg: &f64| (lat_deg.to_radians() - place.lat_rad).abs() > 1e-9;
        if let Some(found) = self.latitude_deg.filter(|lat| self.kind != FrameKind::Flat && other(lat)) {
            return Err(format!("frame.latitude_deg: expected only in a flat frame, found {found}"));
        }
        Ok(Planet { shape, gravity, rotation_radps: self.rotation_radps.unwrap_or(turning) })
    }
}

impl AtmosphereFile {
    fn checked(&self) -> Result<Atmosphere, String> {
        within("atmosphere.density_kgpm3", self.density_kgpm3, 0.0, 2_000.0)?;
        if let Some(station) = &self.station {
            within("atmosphere.station.altitude_m", Some(station.altitude_m), -5_000.0, 80_000.0)?;
            within("atmosphere.station.temperature_K", station.temperature_K, 150.0, 400.0)?;
            within("atmosphere.station.pressure_Pa", station.pressure_Pa, 0.1, 200_000.0)?;
            within("atmosphere.station.humidity", Some(station.humidity), 0.0, 1.0)?;
        }
        let unasked = |key: &str, model: &str| format!("atmosphere.{key}: expected none with model {model}");
        match self.model {
            AtmosphereKind::Us1976 => {
                if self.density_kgpm3.is_some() {
                    return Err(unasked("density_kgpm3", "us1976"));
                }
                Ok(self.station.as_ref().map_or_else(Atmosphere::standard, |station| {
                    Atmosphere::Layered(Layers::through(&Station {
                        altitude_m: station.altitude_m,
                        temperature_k: station.temperature_K,
                        pressure_pa: station.pressure_Pa,
                        humidity: station.humidity,
                    }))
                }))
            }
            AtmosphereKind::Constant => {
                let Some(station) = &self.station else {
                    return Ok(Atmosphere::constant(self.density_kgpm3.unwrap_or(1.225)));
                };
                // The air at the station, everywhere; a density given counts more than the one that follows.
                let layers = Layers::through(&Station {
                    altitude_m: station.altitude_m,
                    temperature_k: station.temperature_K,
                    pressure_pa: station.pressure_Pa,
                    humidity: station.humidity,
                });
                let air = layers.at(station.altitude_m);
                let density_kgpm3 = self.density_kgpm3.unwrap_or(air.density_kgpm3);
                Ok(Atmosphere::Constant(AirSample { density_kgpm3, ..air }))
            }
            AtmosphereKind::None => match (self.density_kgpm3, &self.station) {
                (None, None) => Ok(Atmosphere::None),
                (Some(_), _) => Err(unasked("density_kgpm3", "none")),
                (_, Some(_)) => Err(unasked("station", "none")),
            },
        }
    }
}

fn wind(rows: &[WindFile]) -> Result<Wind, String> {
    for (i, row) in rows.iter().enumerate() {
        for (key, found) in [("north_mps", row.north_mps), ("east_mps", row.east_mps), ("up_mps", row.up_mps)] {
            within(&format!("wind[{i}].{key}"), Some(found), -1_000.0, 1_000.0)?;
        }
    }
    let rows = rows.iter().map(|row| (row.altitude_m, DVec3::new(row.north_mps, row.east_mps, -row.up_mps)));
    Wind::new(rows.collect()).map_err(|wrong| {
        let (row, before_m, found_m) = (wrong.row, wrong.before_m, wrong.found_m);
        format!("wind[{row}].altitude_m: expected above {before_m}, found {found_m}")
    })
}

impl TurbulenceFile {
    fn checked(self) -> Result<Option<Turbulence>, String> {
        within("turbulence.sigma_mps", self.sigma_mps, 0.0, 100.0)?;
        match (self.kind, self.sigma_mps) {
            (TurbulenceKind::None, _) => Ok(None),
            (TurbulenceKind::Dryden, None) => Err("turbulence.sigma_mps: expected m/s, found none".to_owned()),
            (TurbulenceKind::Dryden, Some(sigma_mps)) => Ok(Some(Turbulence { sigma_mps, seed: self.seed })),
        }
    }
}

impl InitialFile {
    fn checked_place(&self) -> Result<Place, String> {
        within("initial.lat_deg", self.lat_deg, -90.0, 90.0)?;
        within("initial.lon_deg", self.lon_deg, -360.0, 360.0)?;
        within("initial.altitude_m", self.altitude_m, -12_000.0, 1e8)?;
        within("initial.north_m", self.north_m, -1e8, 1e8)?;
        within("initial.east_m", self.east_m, -1e8, 1e8)?;
        let lon_deg = self.lon_deg.unwrap_or(0.0);
        let lon_deg = if lon_deg.abs() <= 180.0 { lon_deg } else { (lon_deg + 180.0).rem_euclid(360.0) - 180.0 };
        Ok(Place {
            lat_rad: self.lat_deg.unwrap_or(0.0).to_radians(),
            lon_rad: lon_deg.to_radians(),
            altitude_m: self.altitude_m.unwrap_or(0.0),
        })
    }

    fn checked(&self, planet: Planet, place: Place) -> Result<Initial, String> {
        let flat = matches!(planet.shape, Shape::Flat { .. });
        let metres = self.north_m.is_some() || self.east_m.is_some();
        if metres && !flat {
            return Err("initial.north_m, east_m: expected lat_deg and lon_deg on a round Earth".to_owned());
        }
        if metres && (self.lat_deg.is_some() || self.lon_deg.is_some()) {
            return Err("initial: expected either lat_deg and lon_deg or north_m and east_m, found both".to_owned());
        }
        let velocity = match (self.velocity_ned_mps, self.velocity_body_mps) {
            (Some(_), Some(_)) => {
                return Err("initial: expected one of velocity_ned_mps and velocity_body_mps, found both".to_owned());
            }
            (_, Some(body)) => Velocity::Body(DVec3::from_array(body)),
            (ned, None) => Velocity::Ned(DVec3::from_array(ned.unwrap_or_default())),
        };
        let (Velocity::Ned(speed) | Velocity::Body(speed)) = velocity;
        within("initial velocity, its length", Some(speed.length()), 0.0, 100_000.0)?;
        let attitude = match (self.attitude_deg, self.quaternion) {
            (Some(_), Some(_)) => {
                return Err("initial: expected one of attitude_deg and quaternion, found both".to_owned());
            }
            (_, Some(q)) => {
                let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
                within("initial.quaternion, its length", Some(length), 0.99, 1.01)?;
                Attitude::Quaternion(q.map(|c| c / length))
            }
            (angles, None) => Attitude::Angles(angles.unwrap_or_default().map(f64::to_radians)),
        };
        let rates = self.rates_degps.unwrap_or_default();
        for rate in rates {
            within("initial.rates_degps", Some(rate), -1e6, 1e6)?;
        }
        Ok(Initial {
            place,
            // Without a place a flat frame starts at its origin.
            flat_m: (flat && self.lat_deg.is_none() && self.lon_deg.is_none()).then(|| {
                DVec3::new(self.north_m.unwrap_or(0.0), self.east_m.unwrap_or(0.0), -self.altitude_m.unwrap_or(0.0))
            }),
            velocity,
            attitude,
            rates_radps: DVec3::from_array(rates.map(f64::to_radians)),
            rates_frame: self.rates_frame.unwrap_or_default(),
        })
    }
}

impl RunFile {
    fn checked(self, file: &Path) -> Result<Run, String> {
        within("run.seconds", self.seconds, 0.0, 1e6)?;
        within("run.dt_s", self.dt_s, 1e-6, 10.0)?;
        within("run.output_dt_s", self.output_dt_s, 1e-6, 1e6)?;
        if let (Some(seconds), Some(dt_s)) = (self.seconds, self.dt_s) {
            within("run.seconds / run.dt_s", Some(seconds / dt_s), 0.0, MOST_STEPS)?;
        }
        let beside = |world: PathBuf| match file.parent() {
            Some(folder) if world.as_os_str() != DEFAULT_WORLD => folder.join(world),
            _ => world,
        };
        Ok(Run {
            seconds: self.seconds,
            dt_s: self.dt_s,
            output_dt_s: self.output_dt_s,
            integrator: self.integrator,
            stop: self.stop,
            world: self.world.map(beside),
        })
    }
}

impl ShotFile {
    fn checked(self) -> Result<Shot, String> {
        within("shot.speed_mps", self.speed_mps, 0.0, 20_000.0)?;
        within("shot.elevation_deg", self.elevation_deg, -90.0, 90.0)?;
        within("shot.azimuth_deg", self.azimuth_deg, -360.0, 360.0)?;
        within("shot.zero_range_m", self.zero_range_m, 1e-3, 100_000.0)?;
        within("shot.sight_height_m", self.sight_height_m, -10.0, 10.0)?;
        within("shot.look_angle_deg", self.look_angle_deg, -90.0, 90.0)?;
        within("shot.step_m", self.step_m, 1e-3, 1e6)?;
        within("shot.step_s", self.step_s, 1e-6, 1e6)?;
        if self.step_m.is_some() && self.step_s.is_some() {
            return Err("shot: expected one of step_m and step_s, found both".to_owned());
        }
        Ok(Shot {
            speed_mps: self.speed_mps,
            elevation_rad: self.elevation_deg.unwrap_or(0.0).to_radians(),
            azimuth_rad: self.azimuth_deg.unwrap_or(0.0).to_radians(),
            zero_range_m: self.zero_range_m,
            sight_height_m: self.sight_height_m.unwrap_or(0.0),
            look_angle_rad: self.look_angle_deg.unwrap_or(0.0).to_radians(),
            until: self.until,
            step_m: self.step_m,
            step_s: self.step_s,
        })
    }
}
