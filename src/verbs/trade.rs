//! `poligon trade`: accuracy against cost of every setting, as a report and, with `--out`, as files: `trade.csv`,
//! `trade.json`, a plot a knob and `all.svg`.

use crate::args::TradeArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::{self, Output};
use crate::report::Trade;
use crate::trade::{self, Effort};
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &TradeArgs, output: Output) -> Result<(), Failure> {
    if let Some(folder) = &args.out {
        // Before minutes of work, not after.
        fs::create_dir_all(folder).map_err(|error| Failure::while_doing(folder.display(), error))?;
    }
    let world = Arc::new(open_world::open(None)?);
    let effort = if args.quick { Effort::QUICK } else { Effort::FULL };
    let request = terrain::bake::default_request();
    let trade = trade::measure(&world, &request, &effort, &mut |what| {
        output::tell(format_args!("poligon: measuring {what}"));
    })?;
    if let Some(folder) = &args.out {
        write(folder, &trade)?;
    }
    output.print(&trade)
}

fn write(folder: &Path, trade: &Trade) -> Result<(), Failure> {
    let put = |name: String, text: String| {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|error| Failure::while_doing(path.display(), error))
    };
    put("trade.csv".into(), trade::csv(trade))?;
    put("trade.json".into(), format!("{}\n", output::to_value(trade)?))?;
    for knob in &trade.knobs {
        put(format!("{}.svg", knob.name.replace(' ', "_")), trade::plot(knob))?;
    }
    put("all.svg".into(), trade::sheet(&trade.knobs))
}
