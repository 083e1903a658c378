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
use sim::ballistics::trajectory::{FLOOR, Trajectory, TrajectoryError, fly};
use sim::case::Case;
use sim::file::FileError;
use sim::world_ground::WorldGround;
use std::path::{Path, PathBuf};

/// Runs the verb.
///
/// # Errors
/// [`Failure::Misuse`] names the file and the key that cannot be used; [`Failure::Failed`] says what stopped the flight.
pub fn run(args: &TrajectoryArgs, output: Output) -> Result<(), Failure> {
    output::not_over(args.out.as_deref(), &[&args.projectile, &args.case])?;
    let misuse = |error: FileError| Failure::Misuse(error.to_string());
    let projectile = Projectile::read(&args.projectile).map_err(misuse)?;
    let case = Case::read(&args.case).map_err(misuse)?;
    output::not_over(args.out.as_deref(), &projectile.drag_file.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    let world = open_world::of_case(&case)?;
    let ground = world.as_ref().map(|world| WorldGround::new(world, &case));
    if let Some(ground) = &ground {
        let muzzle_m = case.initial.flat_m.unwrap_or_else(|| case.planet.position_m(case.initial.place));
        let why = "initial: expected a place that the world has ground for";
        let ground_m = ground.height_m(muzzle_m).ok_or_else(|| misuse(FileError::new(&args.case, why)))?;
        let under_m = ground_m - ground.place(muzzle_m).altitude_m;
        if under_m > 0.0 {
            output::tell(format_args!("poligon: the muzzle lies {under_m:.1} m under the ground"));
        }
    }
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
    if ground.is_some() && flown.end().event == FLOOR {
        output::tell(format_args!("poligon: the shot left the ground that the world has"));
    }
    if let Some(path) = &args.out {
        output::write_whole(path, flown.to_csv().as_bytes())?;
    }
    match (output, &args.out) {
        (Output::Table, None) => output::print_text(&flown.to_csv()),
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
