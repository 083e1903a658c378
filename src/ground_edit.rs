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
