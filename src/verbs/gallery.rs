//! `poligon gallery`: many pictures of one world, from a list ([`crate::views`]), and a contact sheet of them.

use crate::args::GalleryArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::Output;
use crate::progress::Progress;
use crate::report;
use crate::scenery::{Look, Scenery};
use crate::still;
use crate::views::Views;
use std::sync::Arc;
use visual::capture::{self, Offscreen, Picture};

/// Pictures in a row of the contact sheet.
const COLUMNS: u32 = 4;
/// Most pixels that the contact sheet is wide.
const SHEET_PX: u32 = 2560;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &GalleryArgs, output: Output) -> Result<(), Failure> {
    if args.world.is_some() && args.list.is_none() {
        return Err(Failure::Misuse("a world of one's own needs --list FILE.toml".to_owned()));
    }
    let views = Views::read(args.list.as_deref())?;
    std::fs::create_dir_all(&args.out).map_err(|error| Failure::while_doing(args.out.display(), error))?;
    let world = Arc::new(open_world::open(args.world.as_deref())?);
    let failed = |error: visual::GpuError| Failure::while_doing("taking pictures", error);
    let gpu = visual::Gpu::headless().map_err(failed)?;
    let look = Look::of(&args.view, gpu.report.kind, true);
    let mut scenery = Scenery::new(gpu, capture::FORMAT, world.clone(), look);
    scenery.use_models_of(args.world.as_deref())?;
    scenery.make_craters(&args.craters)?;
    // Every entry is placed before the first picture is drawn.
    let places = views.places(&world, &scenery.area)?;
    let target = Offscreen::new(&scenery.gpu, look.size_px).map_err(failed)?;
    let bar = Progress::new("taking pictures");
    let shrink = (COLUMNS * look.size_px[0]).div_ceil(SHEET_PX).max(1);
    let mut gallery = report::Gallery::default();
    let mut small = Vec::new();
    for (number, place) in places.iter().enumerate() {
        bar.show(number as f64 / places.len() as f64);
        scenery.look.visibility_m = place.visibility_m.or(look.visibility_m);
        scenery.look.fov_y_rad = place.fov_y_rad.unwrap_or(look.fov_y_rad);
        let picture = still::take(&mut scenery, &place.stand, &target)?;
        gallery.pictures.push(still::write(&scenery, &picture, &args.out.join(file_name(number + 1, &place.name)))?);
        small.push(Picture::contact_sheet(&[picture], 1, shrink));
    }
    let sheet = Picture::contact_sheet(&small, COLUMNS.min(small.len() as u32), 1);
    let path = args.out.join("contact-sheet.png");
    sheet.write_png(&path).map_err(|error| Failure::Failed(error.to_string()))?;
    gallery.contact_sheet = path.display().to_string();
    drop(bar);
    output.print(&gallery)
}

/// `03-forest-at-60-m.png`: letters and digits, the rest as dashes.
fn file_name(number: usize, name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let words: Vec<String> = words.map(str::to_ascii_lowercase).collect();
    format!("{number:02}-{}.png", words.join("-"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain() {
        assert_eq!(file_name(3, "Forest, low: 60 m"), "03-forest-low-60-m.png");
    }
}
