//! `poligon simulate`: a body from files, flown, as CSV.

use crate::args::SimulateArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::{self, Output};
use crate::report::{Simulated, Stiffness, TrimFound};
use sim::case::Case;
use sim::file::FileError;
use sim::rigid::column::{AGL, COLUMNS};
use sim::rigid::simulation::Ending;
use sim::rigid::stop::Stop;
use sim::rigid::{Inputs, Model, Simulation};
use sim::world_ground::WorldGround;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Runs the verb.
///
/// # Errors
/// [`Failure::Misuse`] if a file cannot be used, [`Failure::Failed`] if the flight fails or its rows cannot be written.
pub fn run(args: &SimulateArgs, output: Output) -> Result<(), Failure> {
    let read = [Some(&args.model), Some(&args.case), args.inputs.as_ref()];
    let read: Vec<&Path> = read.into_iter().flatten().map(PathBuf::as_path).collect();
    output::not_over(args.out.as_deref(), &read)?;
    let unusable = |error: FileError| Failure::Misuse(error.to_string());
    let model = Model::read(&args.model).map_err(unusable)?;
    let case = Case::read(&args.case).map_err(unusable)?;
    let inputs = match &args.inputs {
        Some(file) => Inputs::read(file, &model.controls).map_err(unusable)?,
        None => Inputs::default(),
    };
    for note in model.notes.iter().map(|note| format!("{}: {note}", args.model.display())) {
        output::tell(format_args!("poligon: {note}"));
    }
    if let Some(file) = &args.inputs {
        inputs.notes.iter().for_each(|note| output::tell(format_args!("poligon: {}: {note}", file.display())));
    }
    output::not_over(args.out.as_deref(), &model.daveml_files().collect::<Vec<_>>())?;
    let wrong = |why: String| Failure::Misuse(FileError::new(&args.case, why).to_string());
    let Some(seconds) = case.run.seconds else {
        return Err(wrong("run.seconds: expected how long to fly, found none".to_owned()));
    };
    if case.shot.is_some() {
        return Err(wrong("shot: expected none, it is for `poligon trajectory`".to_owned()));
    }
    let ground = open_world::of_case(&case)?.map(|world| WorldGround::new(&world, &case));
    let names: Vec<String> =
        COLUMNS.iter().map(|name| (*name).to_owned()).chain(model.controls.iter().map(|c| c.name.clone())).collect();
    let mut flight = Simulation::new(model, &case, inputs, ground).map_err(unusable)?;
    let start_agl_m = flight.row()[AGL];
    if case.run.world.is_some() && start_agl_m.is_nan() {
        return Err(wrong("initial: expected a place that the world has ground for".to_owned()));
    }
    if case.run.world.is_some() && start_agl_m < 0.0 {
        output::tell(format_args!("poligon: the start lies {:.1} m under the ground", -start_agl_m));
    }
    // A world that is named is there.
    let ground = case.run.world.is_some().then_some("ground");
    let words = case.run.stop.iter().map(String::as_str).chain(ground);
    let stops: Vec<Stop> =
        words.map(|words| Stop::parse(words, &flight.motion)).collect::<Result<_, _>>().map_err(wrong)?;
    let dt_s = case.run.dt_s.unwrap_or(seconds);

    let mut text = format!("{},event\n", names.join(","));
    let (mut rows, mut last, mut event) = (0, Vec::new(), String::new());
    let wants_rows = args.out.is_some() || output == Output::Table;
    let ending = flight.run(seconds, case.run.output_dt_s.unwrap_or(dt_s), &stops, |row, told| {
        if wants_rows {
            write_row(&mut text, row, told);
        }
        rows += 1;
        (last, event) = (row.to_vec(), told.to_owned());
    });
    match &args.out {
        Some(file) => output::write_whole(file, text.as_bytes())?,
        None if output == Output::Table => output::print_text(&text)?,
        None => {}
    }
    if case.run.world.is_some() && last.get(AGL).is_some_and(|agl_m| agl_m.is_nan()) {
        output::tell(format_args!("poligon: the flight left the ground that the world has"));
    }
    let fastest = flight.stiffness;
    let limit = case.run.integrator.damping_limit();
    if flight.most_pieces > 1 {
        output::tell(format_args!(
            "poligon: steps of {dt_s} s were taken in up to {} pieces, for the body's fastest mode or its spin",
            flight.most_pieces
        ));
    }
    if output == Output::Json || args.out.is_some() {
        output.print(&Simulated {
            event,
            time_s: flight.t_s(),
            rows,
            steps: flight.steps,
            stiffness: Stiffness {
                speed_mps: fastest.speed_mps,
                lambda_radps: fastest.lambda_radps,
                lambda_h: fastest.lambda_radps * dt_s,
                limit,
                pieces: flight.most_pieces,
            },
            trim: flight.trimmed.as_ref().map(|found| TrimFound {
                values: found.values.iter().cloned().collect(),
                residuals: found.residuals.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
            }),
            // Zero is added so that no -0 is printed.
            last: names.into_iter().zip(last.into_iter().map(|value| (value + 0.0).into())).collect(),
            out: args.out.as_ref().map(|path| path.display().to_string()),
        })?;
    }
    match ending {
        Ending::Failed(why) => Err(Failure::Failed(why)),
        Ending::Time | Ending::Stop(_) => Ok(()),
    }
}

/// A row; what is not known is an empty cell. Numbers read back to the same bits.
fn write_row(text: &mut String, row: &[f64], event: &str) {
    for value in row {
        // Writing to a String cannot fail.
        let _ = if value.is_finite() { write!(text, "{value:?},") } else { write!(text, ",") };
    }
    let _ = writeln!(text, "{event}");
}
