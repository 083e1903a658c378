//! Pictures along the track: one each at its places, and a contact sheet of all.
//!
//! Taken after the flight by a scenery of their own that waits for every block, so that they do not depend on how far was
//! flown or on the machine's speed; nothing in them is measured time.

use super::device_failed;
use super::plan::{PicturePlace, Plan};
use super::record::RunningHash;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::scenery::{Look, Scenery};
use crate::stage::{self, Captions, Sun};
use sim::input::Head;
use std::path::{Path, PathBuf};
use visual::capture::{self, Offscreen, Picture};

/// Pictures in a row of the contact sheet.
const COLUMNS: u32 = 4;
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

/// Takes the plan's pictures at a date into a folder, on the device of the flight's scenery, which ends here.
///
/// # Errors
/// [`Failure::Failed`] if the device fails or a file cannot be written.
pub fn take(flown: Scenery, plan: &Plan, date: sim::UtcTime, folder: &Path) -> Result<Taken, Failure> {
    let bar = Progress::new("taking pictures");
    let own_models = flown.things.own_models().to_vec();
    let (gpu, world, look) = (flown.gpu.clone(), flown.world.clone(), flown.look);
    // All of it goes now; a scenery taken apart would keep what is not taken until the end.
    drop(flown);
    let mut scenery = Scenery::new(gpu, capture::FORMAT, world.clone(), Look { wait: true, keep_depth: false, ..look });
    let gpu = scenery.gpu.clone();
    scenery.things.use_models(&gpu, own_models);
    let size_px = look.size_px;
    let target = Offscreen::new(&scenery.gpu, size_px).map_err(device_failed)?;
    let ground = scenery.scene_ground();
    let mut scene = plan.scene(date);
    let heavens = Sun::new(&world, date)?.at(&world, date);
    let head = Head::default();
    let shrink = (COLUMNS * size_px[0]).div_ceil(SHEET_PX).max(1);
    let mut taken = Taken::default();
    let mut small = Vec::new();
    for (number, place) in plan.pictures.iter().enumerate() {
        bar.show(number as f64 / plan.pictures.len() as f64);
        scene.seek_track(place.distance_m);
        // A step keeps a track that runs under the ground above it.
        let snapshot = sim::lockstep(&mut scene, &ground, 1);
        let view = scenery.view(stage::eye_m(&snapshot), stage::attitude(&snapshot, &head), size_px);
        for _ in 0..MOST_UPDATES {
            scenery.follow(&view, 0.0, heavens);
            if !scenery.terrain.window().is_jumping() && scenery.terrain.window().late_blocks() == 0 {
                break;
            }
        }
        let captions = Captions { frame_ms: f64::NAN, ..Captions::default() };
        let hud = stage::hud(&world, &snapshot, &view, &head, captions);
        scenery.draw(&view, heavens, snapshot.time_s, hud, &target.view).map_err(device_failed)?;
        let picture = target.read(&scenery.gpu).map_err(device_failed)?;
        taken.hash.add(picture.hash());
        taken.files.push(write(&picture, folder, &file_name(number + 1, place))?);
        small.push(Picture::contact_sheet(&[picture], 1, shrink));
    }
    let sheet = Picture::contact_sheet(&small, COLUMNS.min(small.len() as u32), 1);
    taken.files.push(write(&sheet, folder, "contact-sheet.png")?);
    Ok(taken)
}

fn write(picture: &Picture, folder: &Path, name: &str) -> Result<PathBuf, Failure> {
    let path = folder.join(name);
    picture.write_png(&path).map_err(|error| Failure::Failed(error.to_string()))?;
    Ok(path)
}

/// `3-central-tian-shan.png`: letters and digits, the rest as dashes.
fn file_name(number: usize, place: &PicturePlace) -> String {
    let words = place.name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let words: Vec<String> = words.map(str::to_ascii_lowercase).collect();
    format!("{number}-{}.png", words.join("-"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_in_order() {
        let place = |name: &str| PicturePlace { distance_m: 0.0, name: name.to_owned() };
        assert_eq!(file_name(3, &place("central Tian Shan")), "3-central-tian-shan.png");
        assert_eq!(file_name(1, &place("../12.5 km")), "1-12-5-km.png");
    }
}
