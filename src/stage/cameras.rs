//! Where the flight is seen from: the cockpit, behind or about the aircraft, an airfield's tower, a weapon, a fixed place.
//!
//! World frame, metres. Every camera but the weapon's and the free one is a function of the snapshot and the head alone,
//! so pictures of a paused or repeated flight are the same. An eye outside the cockpit stays above the ground.
//! Attitudes turn view axes (x right, y up, z backward) into the world's.

use glam::{DMat3, DQuat, DVec2, DVec3};
use sim::Snapshot;
use sim::input::Head;
use sim::snapshot::StableId;
use terrain::Area;
use terrain::features::model::{Features, PlacedClass};

/// Places to see from, in the order in which one key goes through them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Camera {
    /// The pilot's eye.
    #[default]
    Cockpit,
    /// Behind the aircraft, along the way it goes.
    Chase,
    /// About the aircraft: the head turns round it.
    Orbit,
    /// The nearest airfield's tower, or the ground beside the flight.
    Tower,
    /// Behind a round, rocket or bomb to its end; then where it struck, then the one fired last.
    Weapon,
    /// Where the eye was when it was chosen, looking at the aircraft.
    Free,
}

/// All, in order.
pub const CAMERAS: [Camera; 6] =
    [Camera::Cockpit, Camera::Chase, Camera::Orbit, Camera::Tower, Camera::Weapon, Camera::Free];

/// Distance behind and height over the aircraft of the chase camera, and distance of the one about it, metres.
const CHASE_M: [f64; 2] = [24.0, 5.0];
const ORBIT_M: f64 = 22.0;
/// An eye at the edge of a tower's roof: its height over the foot and its distance from the middle; the height of a person
/// beside the way, metres.
const TOWER_M: [f64; 2] = [24.2, 5.6];
const PERSON_M: f64 = 1.8;
/// A tower farther than this sees nothing of the flight, metres.
const TOWER_REACH_M: f64 = 12_000.0;
/// How far apart places beside the way lie, and how far aside, metres.
const BESIDE_M: [f64; 2] = [1_200.0, 120.0];
/// A watcher takes up a glass until the aircraft's surroundings, so wide, fill half of the picture's height, metres; the
/// narrowest view of a glass, radians.
const GLASS_M: f64 = 90.0;
const GLASS_RAD: f64 = 0.07;
/// Distance behind a weapon, metres; behind and over where it struck; how long its strike is watched, scene seconds.
const WEAPON_M: f64 = 12.0;
const STRIKE_M: [f64; 2] = [70.0, 18.0];
const WATCHED_S: f64 = 4.0;
/// Least height of an eye over the ground, metres.
const CLEAR_M: f64 = 1.2;

/// An eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eye {
    /// Where, world metres.
    pub at_m: DVec3,
    /// View axes to the world's.
    pub attitude: DQuat,
    /// Whether it is the pilot's: the aircraft itself is not drawn, and the display lies on the world.
    pub inside: bool,
    /// Vertical field of view through a glass, radians, where it is narrower than the eye's own.
    pub glass_rad: Option<f64>,
}

/// See the module.
#[derive(Debug)]
pub struct Cameras {
    now: Camera,
    /// Where towers stand, plan (x, z).
    towers: Vec<DVec2>,
    /// Where the last weapon was, which way it went, and when.
    weapon: Option<(DVec3, DVec3, f64)>,
    followed: Option<StableId>,
    free_m: Option<DVec3>,
    last_m: DVec3,
}

impl Camera {
    /// The one after it.
    pub fn next(self) -> Self {
        let at = CAMERAS.iter().position(|one| *one == self).unwrap_or(0);
        CAMERAS[(at + 1) % CAMERAS.len()]
    }

    /// As a display names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cockpit => "COCKPIT",
            Self::Chase => "CHASE",
            Self::Orbit => "EXTERNAL",
            Self::Tower => "TOWER",
            Self::Weapon => "WEAPON",
            Self::Free => "FREE",
        }
    }
}

impl Cameras {
    /// Of a world's features, beginning with one of them.
    pub fn new(features: &Features, begin: Camera) -> Self {
        let towers = features.placed.iter().filter(|placed| placed.class == PlacedClass::ControlTower);
        let towers = towers.map(|tower| tower.at).collect();
        Self { now: begin, towers, weapon: None, followed: None, free_m: None, last_m: DVec3::ZERO }
    }

    /// The camera that is on.
    pub fn now(&self) -> Camera {
        self.now
    }

    /// Turns another on.
    pub fn set(&mut self, camera: Camera) {
        self.now = camera;
        self.free_m = (camera == Camera::Free).then_some(self.last_m);
    }

    /// Where the picture of a snapshot is taken from.
    pub fn eye(&mut self, snapshot: &Snapshot, head: &Head, area: &Area) -> Eye {
        let aircraft = &snapshot.aircraft;
        let at_m = aircraft.position_m;
        let way = way(snapshot);
        self.follow_weapon(snapshot);
        let eye = match self.now {
            Camera::Cockpit => Eye { at_m, attitude: super::attitude(snapshot, head), inside: true, glass_rad: None },
            Camera::Chase => {
                let (sin, cos) = head.right_rad.sin_cos();
                let level = DVec3::new(way.x * cos - way.z * sin, way.y, way.x * sin + way.z * cos);
                looking(at_m - level * CHASE_M[0] + DVec3::Y * CHASE_M[1], at_m + level * 30.0, area)
            }
            Camera::Orbit => {
                let nose = aircraft.angles().heading_rad;
                // From behind the right shoulder, where the head rests.
                let from =
                    terrain::frame::direction(nose + head.right_rad + 0.7, (head.up_rad - 0.22).clamp(-1.4, 1.4));
                looking(at_m - from * ORBIT_M, at_m, area)
            }
            Camera::Tower => through_glass(looking(self.tower_m(at_m, way, area), at_m, area), at_m),
            Camera::Weapon => match self.weapon {
                Some((struck_m, along, since_s)) if since_s < snapshot.time_s => {
                    let level = DVec3::new(along.x, 0.0, along.z).try_normalize().unwrap_or(DVec3::NEG_Z);
                    looking(struck_m - level * STRIKE_M[0] + DVec3::Y * STRIKE_M[1], struck_m, area)
                }
                Some((weapon_m, along, _)) => {
                    looking(weapon_m - along * WEAPON_M + DVec3::Y * 2.0, weapon_m + along * 40.0, area)
                }
                None => looking(at_m - way * CHASE_M[0] + DVec3::Y * CHASE_M[1], at_m + way * 30.0, area),
            },
            Camera::Free => looking(self.free_m.unwrap_or(self.last_m), at_m, area),
        };
        self.last_m = eye.at_m;
        eye
    }

    /// The nearest tower in reach; else the next of the places beside the way.
    fn tower_m(&self, at_m: DVec3, way: DVec3, area: &Area) -> DVec3 {
        let near = |tower: &&DVec2| tower.distance_squared(DVec2::new(at_m.x, at_m.z));
        let tower = self.towers.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
        if let Some(tower) = tower.filter(|tower| near(tower) < TOWER_REACH_M * TOWER_REACH_M) {
            // At the edge that the aircraft is on.
            let aside = (DVec2::new(at_m.x, at_m.z) - tower).try_normalize().unwrap_or(DVec2::X) * TOWER_M[1];
            let foot_m = area.height_m(tower.x, tower.y).unwrap_or(at_m.y);
            return DVec3::new(tower.x + aside.x, foot_m + TOWER_M[0], tower.y + aside.y);
        }
        // Places are fixed in the world: the eye jumps on when the aircraft is past one.
        let along = if way.x.abs() > way.z.abs() { DVec3::X } else { DVec3::Z };
        let place = |value: f64| ((value / BESIDE_M[0]).round()) * BESIDE_M[0];
        let aside = DVec3::new(along.z, 0.0, -along.x) * BESIDE_M[1];
        let stand = DVec3::new(
            if along.x > 0.0 { place(at_m.x) } else { at_m.x - at_m.x.rem_euclid(60.0) },
            at_m.y,
            if along.z > 0.0 { place(at_m.z) } else { at_m.z - at_m.z.rem_euclid(60.0) },
        ) + aside;
        let ground_m = area.height_m(stand.x, stand.z).unwrap_or(at_m.y - 100.0);
        DVec3::new(stand.x, ground_m + PERSON_M, stand.z)
    }

    /// Keeps to a weapon to its end, and to where it was last seen for a while; then to the youngest there is.
    pub fn follow_weapon(&mut self, snapshot: &Snapshot) {
        let flying = |id| snapshot.projectiles.iter().find(|weapon| Some(weapon.id) == id);
        let is_watched =
            self.weapon.is_some_and(|(.., since_s)| (0.0..WATCHED_S).contains(&(snapshot.time_s - since_s)));
        let youngest = || snapshot.projectiles.iter().max_by_key(|weapon| weapon.id).filter(|_| !is_watched);
        if let Some(weapon) = flying(self.followed).or_else(youngest) {
            let along = weapon.velocity_mps.try_normalize().unwrap_or(DVec3::NEG_Y);
            self.weapon = Some((weapon.position_m, along, snapshot.time_s));
            self.followed = Some(weapon.id);
        } else if self.weapon.is_some_and(|(.., since_s)| !(0.0..WATCHED_S).contains(&(snapshot.time_s - since_s))) {
            self.weapon = None;
        }
    }
}

/// Where the aircraft goes; where it stands, where its nose points.
fn way(snapshot: &Snapshot) -> DVec3 {
    let aircraft = &snapshot.aircraft;
    if aircraft.velocity_mps.length() > 8.0 { aircraft.velocity_mps.normalize() } else { aircraft.attitude * DVec3::X }
}

/// The same eye with a glass, if what it looks at is far.
fn through_glass(eye: Eye, to_m: DVec3) -> Eye {
    let distance_m = eye.at_m.distance(to_m).max(1.0);
    Eye { glass_rad: Some((2.0 * (GLASS_M / distance_m).atan()).max(GLASS_RAD)), ..eye }
}

/// An eye that looks at a place, kept above the ground.
fn looking(from_m: DVec3, to_m: DVec3, area: &Area) -> Eye {
    let floor_m = area.height_m(from_m.x, from_m.z).map_or(f64::NEG_INFINITY, |ground_m| ground_m + CLEAR_M);
    let at_m = DVec3::new(from_m.x, from_m.y.max(floor_m), from_m.z);
    let ahead = (to_m - at_m).try_normalize().unwrap_or(DVec3::NEG_Z);
    // Straight up and down any side will do.
    let right = ahead.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
    let attitude = DQuat::from_mat3(&DMat3::from_cols(right, right.cross(ahead), -ahead)).normalize();
    Eye { at_m, attitude, inside: false, glass_rad: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim::UtcTime;
    use sim::aircraft::AircraftState;
    use sim::scene::{EntityKind, EntityView};
    use std::sync::Arc;
    use terrain::{Grid, Ground, synthetic};

    fn area() -> Area {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        Ground::new(Arc::new(synthetic::rough(grid, 4, 300.0))).whole()
    }

    fn snapshot(at_m: DVec3) -> Snapshot {
        sim::Scene::new(AircraftState::level(at_m, 0.5, 60.0), UtcTime { unix_ns: 0 }).snapshot()
    }

    #[test]
    fn every_camera_outside_sees_the_aircraft_from_above_the_ground() {
        let area = area();
        for height_m in [-200.0, 1.0, 40.0, 3_000.0] {
            let ground_m = area.height_m(10.0, -20.0).unwrap();
            let snapshot = snapshot(DVec3::new(10.0, ground_m + height_m, -20.0));
            let mut cameras = Cameras::new(&Features::default(), Camera::Cockpit);
            assert!(cameras.eye(&snapshot, &Head::default(), &area).inside);
            for camera in &CAMERAS[1..] {
                cameras.set(*camera);
                let eye = cameras.eye(&snapshot, &Head::default(), &area);
                assert!(!eye.inside && eye.at_m.is_finite() && (eye.attitude.length() - 1.0).abs() < 1e-12);
                let floor_m = area.height_m(eye.at_m.x, eye.at_m.z).unwrap();
                assert!(eye.at_m.y >= floor_m + CLEAR_M - 1e-9, "{camera:?}");
                let to = snapshot.aircraft.position_m - eye.at_m;
                // Within the picture: 60 degrees high.
                if to.length() > 5.0 && height_m > 0.0 {
                    assert!((eye.attitude * DVec3::NEG_Z).dot(to.normalize()) > 0.87, "{camera:?} {height_m} {to}");
                }
            }
        }
    }

    #[test]
    fn a_tower_sees_the_aircraft_through_a_glass_from_the_edge_of_its_roof() {
        let area = area();
        let tower = terrain::features::model::Placed {
            class: PlacedClass::ControlTower,
            at: DVec2::new(-900.0, 700.0),
            grid_heading_rad: 0.0,
        };
        let features = Features { placed: vec![tower], ..Features::default() };
        let mut cameras = Cameras::new(&features, Camera::Tower);
        let ground_m = area.height_m(-900.0, 700.0).unwrap();
        let snapshot = snapshot(DVec3::new(300.0, ground_m + 300.0, -900.0));
        let eye = cameras.eye(&snapshot, &Head::default(), &area);
        let away = eye.at_m - DVec3::new(-900.0, ground_m, 700.0);
        assert!((away.y - TOWER_M[0]).abs() < 1e-9 && (away.x.hypot(away.z) - TOWER_M[1]).abs() < 1e-9, "{away}");
        let to = snapshot.aircraft.position_m - eye.at_m;
        assert!((eye.attitude * DVec3::NEG_Z).dot(to.normalize()) > 1.0 - 1e-9);
        // Twice 90 m fill the picture's height at its distance.
        let seen_m = 2.0 * to.length() * (0.5 * eye.glass_rad.unwrap()).tan();
        assert!((seen_m - 2.0 * GLASS_M).abs() < 1e-6, "{seen_m}");
    }

    #[test]
    fn the_weapon_camera_follows_the_youngest_and_stays_where_it_struck() {
        let area = area();
        let mut cameras = Cameras::new(&Features::default(), Camera::Weapon);
        let mut flying = snapshot(DVec3::new(0.0, 2_000.0, 0.0));
        let weapon = |id: u64, at_m: DVec3| EntityView {
            id: StableId(id),
            kind: EntityKind::Projectile,
            of: 0,
            position_m: at_m,
            attitude: DQuat::IDENTITY,
            velocity_mps: DVec3::new(0.0, -100.0, 0.0),
            condition: sim::Condition::Flying,
            hits: 0,
            damage: sim::weapons::Damage::Intact,
            burning: false,
            gear_down: true,
            jumps: 0,
        };
        let old = weapon(3, DVec3::new(0.0, 1_500.0, 0.0));
        let young = weapon(7, DVec3::new(50.0, 1_900.0, 0.0));
        flying.projectiles = vec![old, young].into();
        let eye = cameras.eye(&flying, &Head::default(), &area);
        assert!(eye.at_m.distance(young.position_m) < 1.5 * WEAPON_M + 2.0, "{}", eye.at_m);
        flying.projectiles = Arc::default();
        flying.time_s += 1.0;
        let watcher = cameras.eye(&flying, &Head::default(), &area);
        let away = young.position_m - watcher.at_m;
        assert!((40.0..=1.1 * STRIKE_M[0]).contains(&away.length()), "{away}");
        assert!((watcher.attitude * DVec3::NEG_Z).dot(away.normalize()) > 0.999, "{away}");
        flying.time_s += WATCHED_S;
        assert!(cameras.eye(&flying, &Head::default(), &area).at_m.distance(flying.aircraft.position_m) < 40.0);
    }

    #[test]
    fn one_key_goes_through_all_and_comes_back() {
        let mut seen = vec![Camera::Cockpit];
        while seen.len() < CAMERAS.len() + 1 {
            seen.push(seen.last().unwrap().next());
        }
        assert_eq!(seen[..CAMERAS.len()], CAMERAS);
        assert_eq!(seen.last(), Some(&Camera::Cockpit));
    }
}
