//! What an owner carries: stations with weapons, which are left, and what its crew has set.
//!
//! Body axes of the owner (x forward, y right, z down), metres from its reference point. Rounds are taken from the
//! station of the weapon that has most left, of several the first: so pairs leave from both sides in turn.
//!
//! Invariant others rely on: rounds left only fall, except by loading; what they weigh and how they drag follows from
//! them alone.

use super::catalogue::Catalogue;
use super::codec::coded;
use super::{Refused, Scene, SceneGround};
use crate::ballistics::projectile::Projectile;
use crate::snapshot::StableId;
use crate::weapons::ccip::{self, Leaving, NoSolution, Settings, Solution};
use crate::weapons::score::{Aim, TallyRow};
use crate::weapons::{Fuze, Weapon, WeaponKind};
use glam::{DMat3, DVec2, DVec3};
use std::sync::Arc;

/// Most stations of an owner.
pub const MOST_STATIONS: usize = 64;
/// Heaviest stores of an owner, kg.
pub const MOST_STORES_KG: f64 = 1e6;

/// A place that carries a weapon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Station {
    pub weapon: u32,
    pub at_m: DVec3,
    pub loaded: u32,
    pub left: u32,
}
coded!(Station { weapon, at_m, loaded, left });

/// The stations of an owner, and what is set.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Arms {
    pub stations: Vec<Station>,
    /// Whether anything may be released.
    pub master: bool,
    pub selected: Option<u32>,
    /// How many bombs or rockets leave at a press of the trigger; 0 counts as 1.
    pub ripple: u32,
    /// As the crew has set it; `None` leaves every weapon its own.
    pub fuze: Option<Fuze>,
}
coded!(Arms { stations, master, selected, ripple, fuze });

/// What goes with a projectile of a weapon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Load {
    pub weapon: u32,
    pub fuze: Fuze,
    pub aim: Aim,
    /// The owner's way over the ground at the release, plan (x, z).
    pub way: DVec2,
}
coded!(Load { weapon, fuze, aim, way });

/// What stores do to the one that carries them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StoresLoad {
    /// Their mass, kg.
    pub mass_kg: f64,
    /// Their common centre of gravity, metres from the owner's reference point, its body axes; zero without any.
    pub cg_m: DVec3,
    /// Their inertia about it, each taken as a point, kg m2.
    pub inertia_kgm2: DMat3,
    /// Sum of their drag areas, m2.
    pub drag_area_m2: f64,
}
coded!(StoresLoad { mass_kg, cg_m, inertia_kgm2, drag_area_m2 });

/// Inertia of a unit of mass at an arm.
fn at_arm(arm_m: DVec3) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(arm_m.length_squared()))
        - DMat3::from_cols(arm_m * arm_m.x, arm_m * arm_m.y, arm_m * arm_m.z)
}

impl StoresLoad {
    /// Of points: mass, place, drag area of each.
    pub fn of(points: impl Iterator<Item = (f64, DVec3, f64)> + Clone) -> Self {
        let mut load = points.clone().fold(Self::default(), |sum, (mass_kg, at_m, area_m2)| Self {
            mass_kg: sum.mass_kg + mass_kg,
            cg_m: sum.cg_m + at_m * mass_kg,
            drag_area_m2: sum.drag_area_m2 + area_m2,
            ..sum
        });
        if load.mass_kg > 0.0 {
            load.cg_m /= load.mass_kg;
        }
        load.inertia_kgm2 =
            points.fold(DMat3::ZERO, |sum, (mass_kg, at_m, _)| sum + at_arm(at_m - load.cg_m) * mass_kg);
        load
    }

    /// What they add to the inertia of a body of a mass and centre of gravity: their own, and that of both masses about
    /// their common centre of gravity, which is that of the reduced mass at the arm between them (Steiner's theorem).
    pub fn adds_kgm2(&self, body_kg: f64, body_cg_m: DVec3) -> DMat3 {
        let reduced_kg = body_kg * self.mass_kg / (body_kg + self.mass_kg);
        self.inertia_kgm2 + at_arm(self.cg_m - body_cg_m) * reduced_kg
    }

    /// Whether an inertia like this can be; what is restored is not believed.
    pub(super) fn is_sound(&self) -> bool {
        let inertia = self.inertia_kgm2;
        let symmetric = inertia == inertia.transpose();
        let [x, y, z] = [inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z];
        let positive = [x, y, z, y * x - inertia.x_axis.y.powi(2), z * x - inertia.x_axis.z.powi(2)];
        // Points in a line have a determinant that rounds to either side of 0.
        let slack = -1e-9 * (x + y + z).powi(2).max(1e-9);
        symmetric && positive.into_iter().all(|minor| minor >= slack) && self.drag_area_m2 >= 0.0
    }
}

/// A weapon on the page.
#[derive(Debug, Clone, PartialEq)]
pub struct PageRow {
    /// Its name in the catalogue.
    pub weapon: String,
    /// What people call it.
    pub label: String,
    /// What it is.
    pub kind: WeaponKind,
    /// How many are left.
    pub left: u32,
    /// How many were loaded.
    pub loaded: u32,
}

/// What hangs at a station of the own aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hanging {
    /// What it is.
    pub kind: WeaponKind,
    /// Where, body axes, metres from the reference point.
    pub at_m: DVec3,
    /// How many are left there.
    pub left: u32,
}

/// What the own aircraft's crew sees of its weapons.
#[derive(Debug, Clone, PartialEq)]
pub struct WeaponPage {
    /// Every weapon that is or was carried, in the order of its stations.
    pub rows: Vec<PageRow>,
    /// Every station.
    pub hanging: Vec<Hanging>,
    /// Place of the selected one in `rows`.
    pub selected: Option<usize>,
    /// Whether anything may be released.
    pub master: bool,
    /// How many bombs or rockets leave at a press of the trigger.
    pub ripple: u32,
    /// The fuze of the selected one.
    pub fuze: Option<Fuze>,
    /// Where the selected one would strike if it were released now.
    pub ccip: Result<Solution, NoSolution>,
}

impl Arms {
    /// The station that the next round of a weapon leaves.
    pub fn next(&self, weapon: u32) -> Option<usize> {
        let having = self.stations.iter().enumerate().filter(|(_, one)| one.weapon == weapon && one.left > 0);
        having.fold(None, |best: Option<usize>, (place, one)| match best {
            Some(best) if self.stations[best].left >= one.left => Some(best),
            _ => Some(place),
        })
    }

    /// Takes a round; where it hung.
    pub fn take(&mut self, weapon: u32) -> Option<DVec3> {
        let place = self.next(weapon)?;
        let station = &mut self.stations[place];
        station.left -= 1;
        Some(station.at_m)
    }

    /// Rounds left of a weapon, and loaded.
    pub fn rounds(&self, weapon: u32) -> (u32, u32) {
        let of = self.stations.iter().filter(|station| station.weapon == weapon);
        of.fold((0, 0), |sum, one| (sum.0.saturating_add(one.left), sum.1.saturating_add(one.loaded)))
    }

    pub fn load(&self, catalogue: &Catalogue) -> StoresLoad {
        StoresLoad::of(self.points(catalogue))
    }

    /// What hangs on each station: mass, place, drag area.
    pub fn points<'a>(&'a self, catalogue: &'a Catalogue) -> impl Iterator<Item = (f64, DVec3, f64)> + Clone + 'a {
        self.stations.iter().map(|station| {
            let weapon = &catalogue.weapons[station.weapon as usize].thing;
            let left = f64::from(station.left);
            (weapon.carried_kg * left, station.at_m, weapon.carried_drag_area_m2 * left)
        })
    }

    /// What restored ones must be.
    pub fn check(&self, catalogue: &Catalogue) -> Result<(), Refused> {
        let weapons = catalogue.weapons.len();
        let beyond = |weapon: u32| weapon as usize >= weapons;
        let bad = |one: &Station| beyond(one.weapon) || one.left > one.loaded || one.at_m.length() > 1_000.0;
        if self.stations.len() > MOST_STATIONS || self.stations.iter().any(bad) || self.selected.is_some_and(beyond) {
            return Err(Refused::new("arms: expected stations with weapons of the catalogue"));
        }
        Ok(())
    }
}

impl Scene {
    /// What an owner's stores weigh and how they drag; nothing of one without any.
    pub fn stores_load(&self, owner: StableId) -> StoresLoad {
        self.arms.get(&owner).map_or(StoresLoad::default(), |arms| arms.load(&self.catalogue))
    }

    /// Rounds that an owner has left of a weapon of this name.
    pub fn rounds_left(&self, owner: StableId, weapon: &str) -> u32 {
        let arms = self.arms.get(&owner).zip(self.catalogue.weapon(weapon).ok());
        arms.map_or(0, |(arms, weapon)| arms.rounds(weapon).0)
    }

    /// Sums of scores, by owner and weapon.
    pub fn tallies(&self) -> Vec<TallyRow> {
        let row = |(&(owner, weapon), &tally): (&(StableId, u32), &_)| {
            let tally: crate::weapons::Tally = tally;
            let mean_miss_m = (tally.measured > 0).then(|| tally.miss_sum_m / tally.measured as f64);
            let weapon = self.catalogue.weapons[weapon as usize].name.clone();
            TallyRow { owner: owner.0, weapon, tally, mean_miss_m }
        };
        self.tallies.iter().map(row).collect()
    }

    /// Where an owner's selected weapon would strike if it were released now.
    ///
    /// # Errors
    /// [`NoSolution`] says why there is no point.
    pub fn ccip(&self, owner: StableId, ground: &SceneGround) -> Result<Solution, NoSolution> {
        let (weapon, arms) = self.selected(owner).ok_or(NoSolution::NoWeapon)?;
        let station = arms.next(weapon).ok_or(NoSolution::NoWeapon)?;
        let carriage = self.carriage(owner).ok_or(NoSolution::NoWeapon)?;
        let of: &Weapon = &self.catalogue.weapons[weapon as usize].thing;
        let muzzle = of.muzzle(arms.stations[station].at_m);
        let shot = muzzle.aimed(&carriage);
        let leaving = Leaving {
            position_m: shot.position_m,
            velocity_mps: shot.velocity_mps,
            bore: shot.bore,
            owner_m: carriage.position_m,
            owner_mps: carriage.velocity_mps,
        };
        let settings = Settings::of(of, arms.fuze.unwrap_or(of.fuze));
        let projectile: &Projectile = &of.projectile;
        ccip::predict(projectile, &self.surroundings, ground, &leaving, &settings)
    }

    fn selected(&self, owner: StableId) -> Option<(u32, &Arms)> {
        let arms = self.arms.get(&owner)?;
        Some((arms.selected?, arms))
    }

    /// Makes the own aircraft's page anew; without arms it costs one look into an empty map.
    pub(super) fn look_at_arms(&mut self, ground: &SceneGround) {
        if self.arms.is_empty() {
            return;
        }
        let Some(arms) = self.arms.get(&self.own_id) else {
            self.page = None;
            return;
        };
        let kinds = arms.kinds();
        let row = |&weapon: &u32| {
            let named = &self.catalogue.weapons[weapon as usize];
            let (left, loaded) = arms.rounds(weapon);
            PageRow {
                weapon: named.name.clone(),
                label: named.thing.label.clone(),
                kind: named.thing.kind,
                left,
                loaded,
            }
        };
        let selected = arms.selected.and_then(|weapon| kinds.iter().position(|kind| *kind == weapon));
        let fuze = arms.selected.map(|of| arms.fuze.unwrap_or(self.catalogue.weapons[of as usize].thing.fuze));
        let rows = kinds.iter().map(row).collect();
        let hanging = arms.stations.iter().map(|station| Hanging {
            kind: self.catalogue.weapons[station.weapon as usize].thing.kind,
            at_m: station.at_m,
            left: station.left,
        });
        let hanging = hanging.collect();
        let ccip = self.ccip(self.own_id, ground);
        self.page = Some(Arc::new(WeaponPage {
            rows,
            hanging,
            selected,
            master: arms.master,
            ripple: arms.ripple.max(1),
            fuze,
            ccip,
        }));
    }
}
