//! Pictures along the track or of a situation's moments, a contact sheet of all, strips of those that belong together; of a
//! situation also plots of what was flown.
//!
//! Taken after the flight by a scenery of their own that waits for every block, so that they do not depend on how far was
//! flown or on the machine's speed; nothing in them is measured time.

use super::device_failed;
use super::inputs;
use super::plan::Plan;
use super::record::RunningHash;
use super::trace::Trace;
use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::scenery::{Look, Scenery};
use crate::stage::cameras::Camera;
use crate::stage::effects::Effects;
use crate::stage::marks::Marks;
use crate::stage::{self, Captions, Seat, Sun};
use sim::situation::Moment;
use sim::{Snapshot, UtcTime};
use std::ops::Range;
use std::path::{Path, PathBuf};
use visual::capture::{self, Offscreen, Picture};

/// Pictures in a row of the contact sheet.
const COLUMNS: u32 = 4;
/// Pixels to a unit of a plot.
const PLOT_SCALE: f64 = 2.0;
/// Most pixels that the contact sheet is wide.
const SHEET_PX: u32 = 2560;
/// Updates after which a window that waits for every block has uploaded them all, however small its budget.
const MOST_UPDATES: u32 = 1_000;

/// Pictures as they were written.
#[derive(Debug, Clone, Default)]
pub struct Taken {
    /// The files.
    pub files: Vec<PathBuf>,
    /// Over the pixels of all.
    pub hash: RunningHash,
}

/// Takes the plan's pictures at a date, on the device of the flight's scenery, which ends here. A situation is flown once
/// more, by its script or by the inputs that are played.
///
/// # Errors
/// [`Failure::Failed`] if the device fails or a file cannot be written.
pub fn take(flown: Scenery, plan: &Plan, args: &FlyArgs, date: UtcTime) -> Result<Taken, Failure> {
    let own_models = flown.things.own_models().to_vec();
    let (gpu, world, look) = (flown.gpu.clone(), flown.world.clone(), flown.look);
    // All of it goes now; a scenery taken apart would keep what is not taken until the end.
    drop(flown);
    let look = Look { wait: true, keep_depth: false, ..look };
    let mut scenery = Scenery::new(gpu.clone(), capture::FORMAT, world.clone(), look);
    scenery.things.use_models(&gpu, own_models);
    let mut ground = scenery.scene_ground();
    let mut scene = plan.scene(&world, date, args.inputs.is_none())?;
    inputs::prepare(args, &mut scene)?;
    let mut album = Album {
        bar: Progress::new("taking pictures"),
        seat: Seat::new(&world, &scene, args.camera),
        effects: Effects::default(),
        marks: Marks::default(),
        trace: Trace::default(),
        sun: Sun::new(&world, date)?,
        target: Offscreen::new(&scenery.gpu, look.size_px).map_err(device_failed)?,
        scenery,
        folder: &args.shots,
        taken: Taken::default(),
        small: Vec::new(),
        names: Vec::new(),
    };
    match plan {
        Plan::Track { pictures, .. } => {
            for (number, place) in pictures.iter().enumerate() {
                album.bar.show(number as f64 / pictures.len() as f64);
                scene.seek_track(place.distance_m);
                // A step keeps a track that runs under the ground above it.
                let snapshot = sim::lockstep(&mut scene, &ground, 1);
                album.add(&snapshot, &place.name)?;
            }
        }
        Plan::Situation(situation) => {
            let hz = f64::from(scene.clock.step_hz());
            let mut moments = situation.moments().to_vec();
            moments.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
            if moments.is_empty() {
                moments.push(Moment { at_s: 0.0, name: situation.name().to_owned(), camera: None });
            }
            for (number, moment) in moments.iter().enumerate() {
                album.bar.show(number as f64 / moments.len() as f64);
                let at = (moment.at_s * hz).round() as u64;
                while scene.clock.step() < at {
                    let snapshot = sim::advance(&mut scene, &mut ground);
                    album.effects.of(&snapshot, &ground);
                    album.trace.add(&snapshot);
                    album.marks.leave(&snapshot.events, &snapshot, &mut album.scenery);
                    album.seat.cameras.follow_weapon(&snapshot);
                }
                let camera = moment.camera.as_deref().map_or(Ok(args.camera), |name| {
                    <Camera as clap::ValueEnum>::from_str(name, true).map_err(|_| {
                        Failure::Failed(format!("picture {}: expected a camera, found {name}", moment.name))
                    })
                })?;
                album.seat.cameras.set(camera);
                let snapshot = sim::advance(&mut scene, &mut ground);
                album.marks.leave(&snapshot.events, &snapshot, &mut album.scenery);
                album.add(&snapshot, &moment.name)?;
            }
            album.plots(situation.name())?;
        }
    }
    album.bound()
}

/// Pictures as they come.
struct Album<'a> {
    bar: Progress,
    scenery: Scenery,
    seat: Seat,
    effects: Effects,
    marks: Marks,
    trace: Trace,
    sun: Sun,
    target: Offscreen,
    folder: &'a Path,
    taken: Taken,
    small: Vec<Picture>,
    names: Vec<String>,
}

impl Album<'_> {
    fn add(&mut self, snapshot: &Snapshot, name: &str) -> Result<(), Failure> {
        let size_px = self.scenery.look.size_px;
        let scenery = &mut self.scenery;
        let emitters = self.effects.of(snapshot, &scenery.scene_ground());
        scenery.things.set_particles(emitters);
        let seen = self.seat.view(scenery, snapshot, size_px);
        let world = scenery.world.clone();
        let heavens = self.sun.at(&world, snapshot.date);
        for _ in 0..MOST_UPDATES {
            scenery.follow(&seen.view, 0.0, heavens);
            let window = scenery.terrain.window();
            if !window.is_jumping() && !window.is_changing() && window.late_blocks() == 0 {
                break;
            }
        }
        let captions = Captions { frame_ms: f64::NAN, ..Captions::default() };
        let hud = stage::hud(&world, snapshot, &seen, &heavens, captions);
        scenery.draw(&seen.view, heavens, snapshot.time_s, hud, &self.target.view).map_err(device_failed)?;
        let picture = self.target.read(&scenery.gpu).map_err(device_failed)?;
        self.taken.hash.add(picture.hash());
        self.taken.files.push(write(&picture, self.folder, &file_name(self.taken.files.len() + 1, name))?);
        let shrink = (COLUMNS * size_px[0]).div_ceil(SHEET_PX).max(1);
        self.small.push(Picture::contact_sheet(&[picture], 1, shrink));
        self.names.push(name.to_owned());
        Ok(())
    }

    /// Plots of what was flown up to the last picture.
    fn plots(&mut self, name: &str) -> Result<(), Failure> {
        let plots = [("flight.png", self.trace.flight(name)), ("landing.png", self.trace.landing(name))];
        for (file, plot) in plots {
            if let Some(plot) = plot {
                self.taken.files.push(write(&plot.picture(PLOT_SCALE), self.folder, file)?);
            }
        }
        Ok(())
    }

    fn bound(mut self) -> Result<Taken, Failure> {
        let sheet = Picture::contact_sheet(&self.small, COLUMNS.min(self.small.len() as u32), 1);
        self.taken.files.push(write(&sheet, self.folder, "contact-sheet.png")?);
        for (number, (name, places)) in strips(&self.names).into_iter().enumerate() {
            let strip = Picture::contact_sheet(&self.small[places], COLUMNS, 1);
            self.taken.files.push(write(&strip, self.folder, &format!("strip-{}-{}.png", number + 1, dashed(&name)))?);
        }
        Ok(self.taken)
    }
}

fn write(picture: &Picture, folder: &Path, name: &str) -> Result<PathBuf, Failure> {
    let path = folder.join(name);
    picture.write_png(&path).map_err(|error| Failure::Failed(error.to_string()))?;
    Ok(path)
}

/// `3-central-tian-shan.png`.
fn file_name(number: usize, name: &str) -> String {
    format!("{number}-{}.png", dashed(name))
}

/// Letters and digits, the rest as dashes.
fn dashed(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let words: Vec<String> = words.map(str::to_ascii_lowercase).collect();
    words.join("-")
}

/// Pictures in a row whose names differ by a number at the end alone, three or more: the name and their places.
fn strips(names: &[String]) -> Vec<(String, Range<usize>)> {
    let stem = |name: &str| name.trim_end_matches(|c: char| c.is_ascii_digit() || c == ' ').to_owned();
    let mut found: Vec<(String, Range<usize>)> = Vec::new();
    for (at, name) in names.iter().enumerate() {
        let stem = stem(name);
        match found.last_mut() {
            Some((known, places)) if *known == stem => places.end = at + 1,
            _ => found.push((stem, at..at + 1)),
        }
    }
    found.retain(|(_, places)| places.len() >= 3);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_in_order() {
        assert_eq!(file_name(3, "central Tian Shan"), "3-central-tian-shan.png");
        assert_eq!(file_name(1, "../12.5 km"), "1-12-5-km.png");
        let names = ["start", "dive 1", "dive 2", "dive 3", "away 1", "away 2"].map(str::to_owned);
        assert_eq!(strips(&names), [("dive".to_owned(), 1..4)]);
    }
}
