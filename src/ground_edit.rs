//! Events that change the ground of a scenery: craters from a command line, and the scenery over a new version of its ground.

use crate::failure::Failure;
use crate::output;
use crate::scenery::Scenery;
use crate::values::CraterMark;
use std::sync::Arc;
use terrain::Geodetic;
use terrain::edit::{Changed, Crater, Edit, EditError};

impl Scenery {
    /// Makes edits. Physics meets the new ground at once; the picture shows it as soon as all that it reaches is made, which
    /// a scenery that waits does when it next follows.
    ///
    /// # Errors
    /// [`EditError`] says which edit cannot be made; none is then.
    pub fn edit_ground(&mut self, edits: &[Edit]) -> Result<Changed, EditError> {
        let (landscape, changed) = self.landscape.edited(edits)?;
        if changed.is_empty() {
            return Ok(changed);
        }
        self.landscape = Arc::new(landscape);
        self.area = self.landscape.ground.whole();
        let (standing, moved) = self.standing.edited(&self.area, &changed);
        self.standing = Arc::new(standing);
        self.terrain.set_landscape(self.landscape.clone(), &changed);
        self.things.set_landscape(&self.landscape, &self.standing, &moved, &changed);
        Ok(changed)
    }

    /// Makes the craters of a command line; says of those that are too small for the ground's posts that they are.
    ///
    /// # Errors
    /// [`Failure::Misuse`] for one that cannot be made.
    pub fn make_craters(&mut self, marks: &[CraterMark]) -> Result<(), Failure> {
        let step_m = self.area.grid().step_m;
        for mark in marks {
            let centre_m = self.world.projection.to_world(Geodetic::from_degrees(mark.lat_deg, mark.lon_deg));
            let simple = Crater::simple(centre_m, mark.radius_m);
            let crater = Crater { depth_m: mark.depth_m.unwrap_or(simple.depth_m), ..simple };
            let changed = self
                .edit_ground(&[Edit::Crater(crater)])
                .map_err(|error| Failure::Misuse(format!("--crater: {error}")))?;
            if changed.is_empty() {
                let why = if crater.reaches_posts(step_m) { "no ground there" } else { "smaller than a step" };
                output::tell(format_args!(
                    "poligon: a crater of {} m at {}, {} changes nothing: {why} (posts stand {step_m} m apart)",
                    mark.radius_m, mark.lat_deg, mark.lon_deg
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenery::Look;
    use crate::still::{self, Standpoint};
    use crate::values::Quality;
    use glam::{DVec2, DVec3};
    use visual::capture::{self, Offscreen};

    /// The same crater in the ground before the first picture, and after one was taken.
    #[test]
    fn a_picture_after_an_edit_is_that_of_a_ground_that_was_edited_before() {
        if let Err(reason) = visual::Gpu::headless() {
            println!("skipped: {reason}");
            return;
        }
        let world = Arc::new(crate::bench::tests::tiny_world());
        let edits = [Edit::Crater(Crater { centre_m: DVec2::new(0.0, -3_000.0), radius_m: 900.0, depth_m: 300.0 })];
        let at = Standpoint {
            eye_m: DVec3::new(0.0, 4_500.0, 1_000.0),
            attitude: terrain::frame::attitude(0.0, -0.6, 0.0),
            heavens: terrain::frame::direction(4.0, 0.15).into(),
        };
        let look = Look { size_px: [320, 180], ..Look::preset(Quality::Standard) };
        let scenery = || {
            let gpu = visual::Gpu::headless().expect("an adapter");
            Scenery::new(gpu, capture::FORMAT, world.clone(), look)
        };
        let shot = |scenery: &mut Scenery| {
            let target = Offscreen::new(&scenery.gpu, look.size_px).expect("a target");
            still::take(scenery, &at, &target).expect("a picture")
        };
        let (mut before, mut after) = (scenery(), scenery());
        before.edit_ground(&edits).expect("a crater");
        let edited = shot(&mut before);
        let unedited = shot(&mut after);
        after.edit_ground(&edits).expect("a crater");
        assert!(unedited.hash() != edited.hash(), "the crater shows");
        assert_eq!(shot(&mut after).hash(), edited.hash());
        assert_eq!(after.scene_ground().version(), 1);
    }
}
