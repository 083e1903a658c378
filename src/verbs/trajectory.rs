//! `poligon trajectory`: a shell or a bomb from its muzzle to its end.
//!
//! The rows go to `--out`; without it and without `--json` to stdout, and then they are all that is printed. A file that
//! cannot be used is misuse; a flight that cannot be stepped is a failure.

use crate::args::TrajectoryArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::{self, Output};
use crate::report::TrajectoryReport;
use sim::ballistics::column::Column;
use sim::ballistics::drift::MOST_STABILITY;
use sim::ballistics::projectile::Projectile;
use sim::ballistics::trajectory::{Trajectory, TrajectoryError, fly};
use sim::ballistics::world_ground::WorldGround;
use sim::case::Case;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Runs the verb.
///
/// # Errors
/// [`Failure::Misuse`] names the file and the key that cannot be used; [`Failure::Failed`] says what stopped the flight.
pub fn run(args: &TrajectoryArgs, output: Output) -> Result<(), Failure> {
    let misuse = |error: sim::file::FileError| Failure::Misuse(error.to_string());
    let projectile = Projectile::read(&args.projectile).map_err(misuse)?;
    let case = Case::read(&args.case).map_err(misuse)?;
    let world = case.run.world.as_deref().map(|path| open_world::open(Some(path))).transpose()?;
    let ground = world.as_ref().map(|world| WorldGround::new(world, &case));
    let flown = fly(&projectile, &case, ground.as_ref()).map_err(|error| match error {
        TrajectoryError::Input(error) => misuse(error),
        error => Failure::Failed(error.to_string()),
    })?;
    if let Some(drift) = flown.drift
        && !(1.0..MOST_STABILITY).contains(&drift.stability)
    {
        let stability = drift.stability;
        output::tell(format_args!("poligon: gyroscopic stability {stability:.2}: spin drift is no estimate there"));
    }
    if let Some(path) = &args.out {
        write(path, &flown.to_csv())?;
    }
    match (output, &args.out) {
        (Output::Table, None) => match io::stdout().lock().write_all(flown.to_csv().as_bytes()) {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                Err(Failure::while_doing("writing to stdout", error))
            }
            _ => Ok(()),
        },
        _ => output.print(&report(&flown, &projectile, &case, args.out.as_deref())),
    }
}

fn report(flown: &Trajectory, projectile: &Projectile, case: &Case, out: Option<&Path>) -> TrajectoryReport {
    let end = flown.end();
    let value = |column| end.get(column).unwrap_or(f64::NAN);
    let airless = projectile.drag.is_none() || case.atmosphere == sim::atmosphere::Atmosphere::None;
    TrajectoryReport {
        range_m: flown.range_m,
        time_s: value(Column::Time),
        speed_mps: value(Column::Speed),
        fall_deg: flown.fall_deg,
        aside_m: value(Column::Z),
        drop_m: value(Column::Drop),
        mach: value(Column::Mach),
        lat_deg: value(Column::Lat),
        lon_deg: value(Column::Lon),
        altitude_m: value(Column::Altitude),
        apex_altitude_m: flown.apex_altitude_m,
        event: end.event.clone(),
        tier: match (flown.drift, airless) {
            (Some(_), _) => "modified point mass",
            (None, true) => "vacuum",
            (None, false) => "drag table",
        },
        elevation_deg: flown.launch.elevation_rad.to_degrees(),
        azimuth_deg: flown.launch.azimuth_rad.to_degrees(),
        stability: flown.drift.map(|drift| drift.stability),
        integrator: case.run.integrator.name(),
        dt_s: flown.dt_s,
        steps: flown.steps,
        rows: flown.rows.len(),
        out: out.map(|path| path.display().to_string()),
    }
}

/// Writes a file beside its place and renames it there, so that a reader finds a whole one or none.
fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error: io::Error| Failure::while_doing(format_args!("writing {}", path.display()), error);
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let beside = PathBuf::from(beside);
    std::fs::write(&beside, text).map_err(failed)?;
    std::fs::rename(&beside, path).map_err(failed)
}
