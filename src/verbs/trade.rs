//! `poligon trade`: accuracy against cost of every setting, as a report and, with `--out`, as files: `trade.csv`,
//! `trade.json`, and plots as SVG and PNG: one a knob, one for each group of curves, and all on one sheet.

use crate::args::TradeArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::{self, Output};
use crate::report::{Knob, KnobPoint, Trade};
use crate::trade::{self, Effort, flight};
use crate::values::Priced;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// A plot of 640 x 360 units becomes a picture of 1280 x 720.
const PIXELS_A_UNIT: f64 = 2.0;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &TradeArgs, output: Output) -> Result<(), Failure> {
    if let Some(folder) = &args.out {
        // Before minutes of work, not after.
        fs::create_dir_all(folder).map_err(|error| Failure::while_doing(folder.display(), error))?;
    }
    let mut tell = |what: &str| output::tell(format_args!("poligon: measuring {what}"));
    let (mut knobs, mut conditions) = (Vec::new(), Vec::new());
    if args.subject != Priced::Flight {
        let world = Arc::new(open_world::open(None)?);
        let effort = if args.quick { Effort::QUICK } else { Effort::FULL };
        let scene = trade::measure(&world, &terrain::bake::default_request(), &effort, &mut tell)?;
        knobs.extend(scene.knobs);
        conditions.push(scene.conditions);
    }
    if args.subject != Priced::Scene {
        let effort = if args.quick { flight::Effort::QUICK } else { flight::Effort::FULL };
        let flown = flight::measure(effort, &mut tell)?;
        knobs.extend(flown.knobs);
        conditions.push(flown.conditions);
    }
    let trade = Trade { knobs, conditions: conditions.join("; ") };
    if let Some(folder) = &args.out {
        write(folder, &trade)?;
    }
    match output {
        Output::Json => output.print(&trade),
        Output::Table => output.print(&table(&trade)),
    }
}

/// The report with a line a value, for a person.
fn table(trade: &Trade) -> Value {
    let unit = |knob: &Knob| json!({"knob": knob.name, "setting": knob.unit, "error": knob.error_unit, "cost": knob.cost_unit, "best": knob.best});
    let line = |knob: &Knob, point: &KnobPoint| {
        json!({
            "knob": knob.name, "setting": point.setting, "error": point.error, "error_max": point.error_max,
            "image_rms_grey": point.image_rms_grey, "cost": point.cost, "triangles": point.triangles,
            "bytes": point.bytes, "bake_s": point.bake_s, "label": point.label, "error_height": point.error_height,
            "error_horizontal": point.error_horizontal,
        })
    };
    let lines = trade.knobs.iter().flat_map(|knob| knob.points.iter().map(move |point| line(knob, point)));
    json!({
        "conditions": trade.conditions,
        "points": lines.collect::<Vec<_>>(),
        "units": trade.knobs.iter().map(unit).collect::<Vec<_>>(),
    })
}

fn write(folder: &Path, trade: &Trade) -> Result<(), Failure> {
    let put = |name: String, text: String| {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|error| Failure::while_doing(path.display(), error))
    };
    put("trade.csv".into(), trade::csv(trade))?;
    put("trade.json".into(), format!("{}\n", output::to_value(trade)?))?;
    for (name, plot) in trade::plots(&trade.knobs).into_iter().chain([("all".into(), trade::sheet(&trade.knobs))]) {
        put(format!("{name}.svg"), plot.svg())?;
        let picture = plot.picture(PIXELS_A_UNIT);
        let path = folder.join(format!("{name}.png"));
        picture.write_png(&path).map_err(|error| Failure::Failed(error.to_string()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_files_are_written_and_the_table_has_a_line_a_value() {
        let points = vec![KnobPoint { setting: 12.0, error: 3.0, cost: 2.0, ..KnobPoint::default() }; 2];
        let knob = Knob { name: "post step".into(), points, ..Knob::default() };
        let trade = Trade { knobs: vec![knob.clone(), knob], conditions: "none".into() };
        assert_eq!(table(&trade)["points"].as_array().map(Vec::len), Some(4));
        let folder = std::env::temp_dir().join(format!("poligon-trade-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        write(&folder, &trade).unwrap();
        let mut names: Vec<_> =
            fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        assert_eq!(names, ["all.png", "all.svg", "post_step.png", "post_step.svg", "trade.csv", "trade.json"]);
        fs::remove_dir_all(&folder).unwrap();
        assert!(write(Path::new("/dev/null/none"), &trade).is_err());
    }
}
