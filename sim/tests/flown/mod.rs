//! What tests of flights share: a flight from texts as columns, and tables from files.

#![allow(dead_code)]

use sim::case::Case;
use sim::rigid::column::COLUMNS;
use sim::rigid::simulation::Ending;
use sim::rigid::stop::Stop;
use sim::rigid::{Inputs, Model, Simulation};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Columns by name.
pub type Columns = HashMap<String, Vec<f64>>;

pub const FT_M: f64 = 0.3048;
pub const KT_MPS: f64 = 1_852.0 / 3_600.0;

/// A file of the repository's assets.
pub fn asset(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/flight").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A model of the assets.
pub fn model(name: &str) -> Model {
    Model::from_text(Path::new(name), &asset(name)).unwrap()
}

/// A case of a text.
pub fn case(text: &str) -> Case {
    Case::from_text(Path::new("case.toml"), text).unwrap()
}

/// A folder of the large test data beside the repository; `None` says that the test is skipped.
pub fn shared(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/physics").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: {folder} is not beside the repository");
    None
}

/// Flies and gives all rows as columns, and how it ended.
pub fn fly_to(model: Model, case: &Case, inputs: &str) -> (Columns, Ending) {
    let inputs = if inputs.is_empty() {
        Inputs::default()
    } else {
        Inputs::from_text(Path::new("inputs.csv"), inputs, &model.controls).unwrap()
    };
    let names: Vec<String> =
        COLUMNS.iter().map(|n| (*n).to_owned()).chain(model.controls.iter().map(|c| c.name.clone())).collect();
    let mut flight = Simulation::new(model, case, inputs, None).unwrap();
    let stops: Vec<Stop> = case.run.stop.iter().map(|words| Stop::parse(words, &flight.motion).unwrap()).collect();
    let mut columns: Columns = names.iter().map(|name| (name.clone(), Vec::new())).collect();
    let row_s = case.run.output_dt_s.or(case.run.dt_s).unwrap();
    let ending = flight.run(case.run.seconds.unwrap(), row_s, &stops, |row, _| {
        for (name, value) in names.iter().zip(row) {
            columns.get_mut(name).unwrap().push(*value);
        }
    });
    (columns, ending)
}

/// Flies to the end of time.
pub fn fly(model: Model, case: &Case, inputs: &str) -> Columns {
    let (columns, ending) = fly_to(model, case, inputs);
    assert_eq!(ending, Ending::Time);
    columns
}

/// A CSV file with a header, as columns; lines shorter than the header are passed over.
pub fn table(path: &Path) -> Columns {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').map(str::trim).collect();
    let mut columns: Columns = names.iter().map(|name| ((*name).to_owned(), Vec::new())).collect();
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        // A header may name a column twice, as two of NASA's do: the first counts.
        if cells.len() < names.len() {
            continue;
        }
        for (i, name) in names.iter().enumerate() {
            if names[..i].contains(name) {
                continue;
            }
            columns.get_mut(*name).unwrap().push(cells[i].trim().parse().unwrap_or(f64::NAN));
        }
    }
    columns
}

/// The greatest difference of two columns at times that both have, `ours` times `factor`; times that `skip` holds for
/// are left out. Panics if fewer than `least` times are common.
pub fn apart(ours: (&[f64], &[f64], f64), theirs: (&[f64], &[f64]), least: usize, skip: &dyn Fn(f64) -> bool) -> f64 {
    let (mut most, mut common) = (0.0f64, 0);
    for (t, value) in theirs.0.iter().zip(theirs.1) {
        let at = ours.0.partition_point(|own| *own < t - 1e-5);
        if ours.0.get(at).is_some_and(|own| (own - t).abs() < 1e-5) && !skip(*t) {
            common += 1;
            most = most.max((ours.1[at] * ours.2 - value).abs());
        }
    }
    assert!(common >= least, "{common} common times");
    most
}
