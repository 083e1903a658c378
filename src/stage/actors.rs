//! From the entities of a simulated scene to the shapes that show them.
//!
//! Which shape stands for an entity is decided once a scene, by what its catalogue says of it ([`Cast`]). A body's or the
//! own aircraft's position is its centre of gravity, a target's the middle of what shells strike, a loose thing's its own middle; a shape's foot is on the
//! ground under its wheels: they are told apart here. Body axes (x forward, y right, z down) become a shape's (x right, y
//! up, z backward).

use glam::{DQuat, DVec3};
use sim::Snapshot;
use sim::loose::LooseKind;
use sim::scene::{Catalogue, EntityView};
use sim::weapons::{Damage, WeaponKind};
use visual::models::things::{MODELS, Model};
use visual::passes::objects::ObjectInstance;

/// Height over its wheels' contact of the centre of gravity of an aircraft that has no wheels, metres.
const AIRCRAFT_CG_M: f64 = 1.25;

/// Bombs of a station that are drawn, and how far apart they hang, metres.
const MOST_IN_A_ROW: u32 = 3;
const BESIDE_M: f64 = 0.42;

/// Share of its paint's brightness that a damaged and a destroyed target have left: soot.
const DAMAGED_SHADE: f32 = 0.6;
const DESTROYED_SHADE: f32 = 0.16;

/// A shape, and how far its foot is under the position of what it shows, metres.
type Part = Option<(Model, f64)>;

/// Which shape each entry of a catalogue is drawn with; `None` is not drawn as a shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cast {
    /// With the gear up and down.
    bodies: Vec<[Part; 2]>,
    projectiles: Vec<Part>,
    targets: Vec<Part>,
    loose: Vec<Part>,
}

impl Cast {
    /// Of a catalogue.
    pub fn of(catalogue: &Catalogue) -> Self {
        let body = |(name, of): (&str, &sim::rigid::Model)| {
            let up = model(of.looks.as_deref().unwrap_or(name)).unwrap_or(Model::Aircraft);
            // A shape stands on what its wheels or skids stand on.
            let wheels = of.contacts.iter().map(|one| one.at_m.z + one.radius_m);
            let below_m = wheels.reduce(f64::max).map_or(AIRCRAFT_CG_M, |foot_m| foot_m - of.cg_m.z);
            let down = if up == Model::Jet { Model::ParkedAircraft } else { up };
            [up, down].map(|shape| Some((shape, below_m)))
        };
        let projectile = |name: &str| match catalogue.weapon_of_projectile(name)?.kind {
            WeaponKind::Bomb => Some((Model::Bomb, 0.0)),
            WeaponKind::Rocket => Some((Model::Rocket, 0.0)),
            WeaponKind::Gun => None,
        };
        let target = |(place, name): (usize, &str)| {
            let kind = catalogue.kind_of_shape(place as u32);
            let named = kind.map_or(name, |kind| kind.model.as_str());
            Some((model(named).unwrap_or(Model::Truck), kind.map_or(0.0, |kind| kind.stand.below_m)))
        };
        Self {
            bodies: catalogue.models().map(body).collect(),
            projectiles: catalogue.projectile_names().map(projectile).collect(),
            targets: catalogue.shape_names().enumerate().map(target).collect(),
            loose: LooseKind::ALL.map(|kind| Some((model(kind.name())?, kind.half_m().y))).to_vec(),
        }
    }

    /// Everything of a snapshot that has a shape; the own aircraft only where it is seen from outside.
    pub fn shapes(&self, snapshot: &Snapshot, inside: bool) -> Vec<ObjectInstance> {
        // An own aircraft that is a body is drawn as that.
        let own = (!inside && snapshot.flown.is_none()).then(|| {
            let own = &snapshot.aircraft;
            let attitude = sim::frame::view_attitude(own.attitude);
            let position_m = own.position_m - attitude * DVec3::Y * AIRCRAFT_CG_M;
            ObjectInstance { class: Model::Aircraft, position_m, attitude, scale: 1.0, shade: 1.0 }
        });
        let in_body_axes = |one: &EntityView| sim::frame::view_attitude(one.attitude);
        let seen = move |one: &&EntityView| !(inside && snapshot.flown == Some(one.id));
        own.into_iter()
            .chain(hanging(snapshot, inside))
            .chain(cast(
                snapshot.bodies.iter().filter(seen),
                |one| self.bodies.get(one.of as usize)?[usize::from(one.gear_down)],
                in_body_axes,
            ))
            .chain(cast(snapshot.projectiles.iter(), part(&self.projectiles), in_body_axes))
            .chain(cast(snapshot.targets.iter(), part(&self.targets), |one| one.attitude))
            .chain(cast(snapshot.loose.iter(), part(&self.loose), |one| one.attitude))
            .collect()
    }
}

/// Bombs under the own aircraft: those of a station side by side.
fn hanging(snapshot: &Snapshot, inside: bool) -> impl Iterator<Item = ObjectInstance> {
    let own = &snapshot.aircraft;
    let attitude = sim::frame::view_attitude(own.attitude);
    let stations = snapshot.weapons.as_ref().filter(|_| !inside).map_or(&[][..], |page| &page.hanging[..]);
    let bombs = stations.iter().filter(|station| station.kind == WeaponKind::Bomb);
    let bombs = bombs.flat_map(move |station| {
        let row = station.left.min(MOST_IN_A_ROW);
        (0..row).map(move |number| {
            let aside_m = (f64::from(number) - 0.5 * f64::from(row - 1)) * BESIDE_M;
            let at = DVec3::new(station.at_m.y + aside_m, -station.at_m.z, -station.at_m.x);
            let position_m = own.position_m + attitude * at;
            ObjectInstance { class: Model::Bomb, position_m, attitude, scale: 1.0, shade: 1.0 }
        })
    });
    bombs.collect::<Vec<_>>().into_iter()
}

/// What an entity of a list is drawn with.
fn part(parts: &[Part]) -> impl Fn(&EntityView) -> Part {
    |one| parts.get(one.of as usize).copied().flatten()
}

fn cast<'a>(
    entities: impl Iterator<Item = &'a EntityView> + 'a,
    part: impl Fn(&EntityView) -> Part + 'a,
    attitude: impl Fn(&EntityView) -> DQuat + 'a,
) -> impl Iterator<Item = ObjectInstance> + 'a {
    entities.filter_map(move |one| {
        let (class, below_m) = part(one)?;
        let attitude = attitude(one);
        let position_m = one.position_m - attitude * DVec3::Y * below_m;
        let shade = match one.damage {
            Damage::Intact => 1.0,
            Damage::Damaged => DAMAGED_SHADE,
            Damage::Destroyed => DESTROYED_SHADE,
        };
        Some(ObjectInstance { class, position_m, attitude, scale: 1.0, shade })
    })
}

/// The shape whose name a catalogue's name is or begins with: `truck`, `truck_2`, `aircraft`.
fn model(name: &str) -> Option<Model> {
    let name = name.to_ascii_lowercase();
    let fits =
        |model: &Model| name.strip_prefix(model.name()).is_some_and(|rest| !rest.starts_with(char::is_alphanumeric));
    MODELS.into_iter().find(fits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim::UtcTime;
    use sim::aircraft::AircraftState;
    use sim::ballistics::shape::Shape;

    #[test]
    fn names_find_their_shapes() {
        assert_eq!(model("truck"), Some(Model::Truck));
        assert_eq!(model("Truck_2"), Some(Model::Truck));
        assert_eq!(model("control_tower"), Some(Model::ControlTower));
        assert_eq!((model("trucker"), model("")), (None, None));
    }

    #[test]
    fn the_own_aircraft_stands_under_its_centre_and_is_not_seen_from_inside() {
        let scene = sim::Scene::new(AircraftState::level(DVec3::Y * 900.0, 0.0, 60.0), UtcTime { unix_ns: 0 });
        let snapshot = scene.snapshot();
        let cast = Cast::of(scene.catalogue());
        assert!(cast.shapes(&snapshot, true).is_empty());
        let shown = cast.shapes(&snapshot, false);
        assert_eq!(shown.len(), 1);
        assert!((shown[0].position_m - DVec3::Y * (900.0 - AIRCRAFT_CG_M)).length() < 1e-9);
        // Its front looks north, along -z.
        assert!((shown[0].attitude * DVec3::NEG_Z - DVec3::NEG_Z).length() < 1e-12);
    }

    #[test]
    fn every_embedded_target_and_weapon_has_its_shape() {
        let mut catalogue = Catalogue::new();
        sim::weapons::builtin::add_all(&mut catalogue).unwrap();
        let cast = Cast::of(&catalogue);
        for (place, name) in catalogue.shape_names().enumerate() {
            let kind = catalogue.kind_of_shape(place as u32).unwrap();
            let (drawn, below_m) = cast.targets[place].unwrap();
            assert_eq!((drawn.name(), below_m), (kind.model.as_str(), kind.stand.below_m), "{name}");
        }
        let shown: Vec<bool> = cast.projectiles.iter().map(Option::is_some).collect();
        assert_eq!(shown.iter().filter(|shown| **shown).count(), 4, "bombs and rockets, not rounds");
    }

    #[test]
    fn an_aircraft_is_drawn_as_it_looks_on_its_wheels_or_without_them() {
        let mut catalogue = Catalogue::new();
        for (name, text) in sim::rigid::builtin::ALL {
            let model = sim::rigid::Model::from_text(std::path::Path::new(name), text).unwrap();
            catalogue.add_model(name, model).unwrap();
        }
        let cast = Cast::of(&catalogue);
        let shapes: Vec<[Model; 2]> = cast.bodies.iter().map(|both| both.map(|part| part.unwrap().0)).collect();
        let [jet, parked] = [Model::Jet, Model::ParkedAircraft];
        let expected = [[Model::Aircraft; 2], [jet, parked], [Model::Helicopter; 2]];
        assert_eq!(shapes, expected, "{:?}", catalogue.model_names().collect::<Vec<_>>());
        // A trainer's wheels hang 1.29 m under its centre of gravity.
        assert!((cast.bodies[0][1].unwrap().1 - 1.29).abs() < 0.01);
    }

    #[test]
    fn loose_things_are_drawn_as_large_as_they_lie() {
        let cast = Cast::of(&Catalogue::new());
        for kind in LooseKind::ALL {
            let (drawn, below_m) = cast.loose[kind.number() as usize].unwrap();
            assert_eq!(drawn.name(), kind.name());
            let (low, high) = drawn.mesh(0).bounds_m();
            let (size, half) = ((high - low).as_dvec3(), kind.half_m());
            // A polygon of 14 sides is narrower than its circle by 2.5 %; a bent plate is all but as thick as its box.
            assert!((size - 2.0 * half).abs().max_element() < 0.03, "{kind:?}: {size}");
            assert!((f64::from(high.y) - 2.0 * below_m).abs() < 0.01 && low.y.abs() < 1e-6, "{kind:?}");
        }
    }

    #[test]
    fn targets_stand_where_they_are_and_strange_numbers_of_a_catalogue_show_nothing() {
        let mut catalogue = Catalogue::new();
        catalogue.add_shape("tank", Shape::sphere(1.0).unwrap()).unwrap();
        let cast = Cast::of(&catalogue);
        let view = |of: u32| EntityView {
            id: sim::snapshot::StableId(9),
            kind: sim::scene::EntityKind::Target,
            of,
            position_m: DVec3::new(1.0, 2.0, 3.0),
            attitude: DQuat::IDENTITY,
            velocity_mps: DVec3::ZERO,
            condition: sim::Condition::OnGround,
            hits: 0,
            damage: Damage::Destroyed,
            burning: true,
            gear_down: true,
            jumps: 0,
        };
        let scene = sim::Scene::new(AircraftState::level(DVec3::Y * 900.0, 0.0, 60.0), UtcTime { unix_ns: 0 });
        let mut snapshot = scene.snapshot();
        snapshot.targets = vec![view(0), view(7)].into();
        let shown = cast.shapes(&snapshot, true);
        assert_eq!(shown.len(), 1);
        assert_eq!((shown[0].class, shown[0].position_m), (Model::Tank, DVec3::new(1.0, 2.0, 3.0)));
        assert_eq!(shown[0].shade, DESTROYED_SHADE);
    }
}
