//! What the own aircraft's crew does with its weapons by switch and trigger: a pilot's commands become the scene's own
//! orders, which a script gives by name.
//!
//! A gun fires from the trigger's press to its release. A bomb or rocket leaves at the press, or as many in a row as are
//! set, each [`RIPPLE_S`] after the other. Without stations every one of these commands does nothing.

use super::arms::Arms;
use super::{Command, Scene};
use crate::input;
use crate::weapons::{Aim, WeaponKind};

/// Between two of a row, seconds: a common setting of intervalometers.
pub const RIPPLE_S: f64 = 0.2;
/// How many leave at a press of the trigger, in the order in which one command goes through them.
pub const RIPPLES: [u32; 5] = [1, 2, 4, 8, u32::MAX];

impl Arms {
    /// Weapons that are or were carried, in the order of their stations.
    pub fn kinds(&self) -> Vec<u32> {
        let mut kinds = Vec::new();
        for station in &self.stations {
            if !kinds.contains(&station.weapon) {
                kinds.push(station.weapon);
            }
        }
        kinds
    }
}

impl Scene {
    pub(super) fn crew(&mut self, command: input::Command) {
        let owner = self.own_id;
        let Some(arms) = self.arms.get_mut(&owner) else { return };
        match command {
            input::Command::MasterArm => arms.master = !arms.master,
            input::Command::NextWeapon => {
                let kinds = arms.kinds();
                let now = arms.selected.and_then(|selected| kinds.iter().position(|kind| *kind == selected));
                let next = now.map_or(0, |now| (now + 1) % kinds.len().max(1));
                arms.selected = kinds.get(next).copied();
            }
            input::Command::NextRipple => {
                let now = RIPPLES.iter().position(|ripple| *ripple == arms.ripple).unwrap_or(0);
                arms.ripple = RIPPLES[(now + 1) % RIPPLES.len()];
            }
            input::Command::Jettison => {
                // What is refused (too many in the air) leaves everything as it was; the page shows what is left.
                let _ = self.order(Command::Jettison { owner, weapon: None });
            }
            input::Command::Trigger => self.trigger(),
            input::Command::TriggerEnd if self.own_kind() == Some(WeaponKind::Gun) => {
                // Ceasing needs nothing that could be missing.
                let _ = self.order(Command::CeaseFire { owner });
            }
            _ => {}
        }
    }

    fn own_kind(&self) -> Option<WeaponKind> {
        let selected = self.arms.get(&self.own_id)?.selected?;
        self.catalogue.weapons.get(selected as usize).map(|named| named.thing.kind)
    }

    fn trigger(&mut self) {
        let (owner, kind) = (self.own_id, self.own_kind());
        let Some((arms, kind)) = self.arms.get(&owner).zip(kind) else { return };
        let Some(selected) = arms.selected.filter(|selected| arms.master && arms.rounds(*selected).0 > 0) else {
            return;
        };
        let left = arms.rounds(selected).0;
        let (rounds, interval_s) = match kind {
            WeaponKind::Gun => (left, 0.0),
            WeaponKind::Bomb | WeaponKind::Rocket => (arms.ripple.clamp(1, left), RIPPLE_S),
        };
        let weapon = self.catalogue.weapons[selected as usize].name.clone();
        let release = Command::Release { owner, weapon, rounds, together: 1, interval_s, aim: Aim::Nearest };
        // What is refused (too many in the air) leaves everything as it was; the page shows what is left.
        let _ = self.order(release);
    }
}
