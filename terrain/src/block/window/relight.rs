//! Light for another sun: made block by block into the layer that is not drawn, and flipped for all at once.

use super::{Upload, Window};
use glam::DVec3;

/// A turn of the sun that asks for new light: 0.5 degrees.
const RELIGHT_COS: f64 = 0.999_961_923;

impl Window {
    /// Towards the sun, unit, world frame. Light follows when it has turned by half a degree.
    pub fn set_sun(&mut self, to_sun: DVec3) {
        if !to_sun.is_finite() || !self.started {
            if to_sun.is_finite() {
                self.suns = [to_sun; 2];
            }
            return;
        }
        if self.relighting {
            // A relight under way is finished first, or a fast clock would never see one.
            self.next_sun = Some(to_sun);
        } else if to_sun.dot(self.suns[self.front]) < RELIGHT_COS {
            let back = 1 - self.front;
            self.suns[back] = to_sun;
            self.relighting = true;
            self.quiet = None;
            self.slots.iter_mut().flatten().for_each(|resident| resident.lit[back] = false);
            self.relight_change();
        }
    }

    /// Uploads light for the new sun; flips when every block has it.
    pub(super) fn relight(&mut self, uploads: &mut Vec<Upload>, left: &mut usize) {
        if !self.relighting {
            return;
        }
        let back = 1 - self.front;
        let mut done = true;
        for slot in 0..self.slots.len() {
            let Some(resident) = &self.slots[slot] else { continue };
            if resident.lit[back] {
                continue;
            }
            let block = resident.block;
            match self.lights.remove(&block) {
                Some((_, light)) if light.len() <= *left => {
                    *left -= light.len();
                    uploads.push(Upload::Light { slot, layer: back, light });
                    if let Some(resident) = &mut self.slots[slot] {
                        resident.lit[back] = true;
                    }
                }
                kept => {
                    done = false;
                    if let Some(light) = kept {
                        self.lights.insert(block, light);
                    }
                }
            }
        }
        if done && !self.jumping && self.shift.is_none() {
            self.front = back;
            self.relighting = false;
            self.counters.relights += 1;
            self.lights.clear();
            self.ready.clear();
            self.slots.iter_mut().flatten().for_each(|resident| resident.lit[1 - back] = false);
            self.relight_change();
            if let Some(to_sun) = self.next_sun.take() {
                self.set_sun(to_sun);
            }
        }
    }
}
