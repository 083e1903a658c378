//! `poligon modes`: how a model flies, measured by flying it.

use crate::args::ModesArgs;
use crate::failure::Failure;
use crate::output::{self, Output};
use crate::plot::chart::{self, Chart, Curve};
use crate::report::{FigureFound, LimitFound, ModeFound, ModesReport};
use sim::handling::linear::Mode;
use sim::handling::{Fixed, level, modes, performance, runway};
use sim::rigid::Model;
use std::sync::Arc;

/// Runs the verb.
///
/// # Errors
/// [`Failure::Misuse`] if the file cannot be used, [`Failure::Failed`] if it does not fly, or flies outside a limit.
pub fn run(args: &ModesArgs, output: Output) -> Result<(), Failure> {
    let model = Arc::new(Model::read(&args.model).map_err(|error| Failure::Misuse(error.to_string()))?);
    let failed = |why: String| Failure::Failed(format!("{}: {why}", args.model.display()));
    let fastest = model.never_exceed_mps.unwrap_or(80.0);
    let speed_mps = args.speed_mps.unwrap_or(0.7 * fastest);
    let held = level(&model, args.altitude_m, Fixed::Speed(speed_mps)).map_err(failed)?;
    let responses = modes::responses(&held).map_err(failed)?;
    let found = modes::found_in(&responses).map_err(failed)?;
    if let Some(folder) = &args.plots {
        let name = format!(
            "{}: {speed_mps:.0} m/s at {:.0} m; short period {:.2}, phugoid {:.2}, Dutch roll {:.2} of critical, roll {:.2} s",
            args.model.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
            args.altitude_m,
            found.short_period.damping(),
            found.phugoid.damping(),
            found.dutch_roll.damping(),
            found.roll.time_s(),
        );
        let sheet = chart::sheet(&name, &responses.iter().flat_map(charts).collect::<Vec<_>>(), 2);
        output::write_whole(&folder.join("modes.svg"), sheet.svg().as_bytes())?;
        let picture = sheet.picture(2.0);
        let file = folder.join("modes.png");
        picture.write_png(&file).map_err(|error| Failure::Failed(error.to_string()))?;
    }
    let mut figures = performance::figures(&model).map_err(failed)?;
    figures.extend(runway::figures(&model).map_err(failed)?);
    let judged = found.judged();
    let passes = judged.iter().all(modes::Judged::passes) && figures.iter().all(performance::Figure::passes);
    let mode = |name, mode: Mode| ModeFound {
        name,
        rate_radps: mode.rate_radps,
        swing_radps: mode.swing_radps,
        damping: (mode.swing_radps > 0.0).then(|| mode.damping()),
        time_s: mode.time_s(),
    };
    output.print(&ModesReport {
        model: args.model.display().to_string(),
        altitude_m: args.altitude_m,
        speed_mps,
        modes: vec![
            mode("short period", found.short_period),
            mode("phugoid", found.phugoid),
            mode("Dutch roll", found.dutch_roll),
            mode("roll", found.roll),
            mode("spiral", found.spiral),
        ],
        limits: judged
            .iter()
            .map(|one| LimitFound {
                name: one.name,
                found: one.found,
                least: one.least,
                most: one.most,
                passes: one.passes(),
            })
            .collect(),
        handbook_source: model.handbook.as_ref().map(|book| book.source.clone()),
        handbook: figures
            .iter()
            .map(|one| FigureFound {
                name: one.name.clone(),
                unit: one.unit,
                found: one.found,
                handbook: one.handbook,
                off: one.off(),
                within: one.within,
                passes: one.passes(),
            })
            .collect(),
        passes,
    })?;
    if passes {
        Ok(())
    } else {
        Err(failed("expected every mode and figure within its limits, found some outside".to_owned()))
    }
}

/// A chart of each signal of a response, and where its free part begins.
fn charts(of: &modes::Response) -> Vec<Chart> {
    let time_s = |row: usize| row as f64 * modes::DT_S;
    let chart = |(at, signal): (usize, &&str)| {
        let values = || of.rows.iter().map(|row| row[at]);
        let most = values().fold(0.0, |most: f64, value| most.max(value.abs()));
        let back = [[of.free_s, -0.2 * most], [of.free_s, 0.2 * most]];
        Chart {
            name: format!("{}: {}", of.name, signal.split(',').next().unwrap_or(signal)),
            up: format!("{signal}, from trim"),
            across: "time, s".to_owned(),
            curves: vec![
                Curve::new("flown", values().enumerate().map(|(row, value)| [time_s(row), value])),
                Curve::new("fitted from here", back).dashed(),
            ],
        }
    };
    of.signals.iter().enumerate().map(chart).collect()
}
