//! Pictures that take long to make, made by threads of their own while a world and a device are opened.
//!
//! Each is made once a process. Whoever needs one takes it, waits for the thread that is making it, or makes it itself, so what is
//! begun here changes no picture.

use crate::args::ViewArgs;
use crate::values::Without;
use terrain::store::World;
use vegetation::pictures;
use visual::passes::detail;

/// Begins what any ground is drawn with.
pub fn begin_ground() {
    std::thread::spawn(detail::levels);
}

/// Begins what the plants of a world are drawn with, if it has any and they are wanted.
pub fn begin_plants(world: &World, view: &ViewArgs) {
    let wanted = view.plants != Some(0.0) && !view.without.contains(&Without::Plants);
    if wanted && !world.cover.cells().is_empty() {
        std::thread::spawn(|| (pictures::crowns(), pictures::all()));
    }
}
