//! From the entities of a simulated scene to the shapes that show them.
//!
//! Which shape stands for an entity is decided once a scene, by the name in its catalogue ([`Cast`]). A body's or the own
//! aircraft's position is its centre of gravity, a shape's foot is on the ground under its wheels: the two are told apart
//! here. Body axes (x forward, y right, z down) become a shape's (x right, y up, z backward).

use glam::DVec3;
use sim::Snapshot;
use sim::scene::{Catalogue, EntityView};
use visual::models::things::{MODELS, Model};
use visual::passes::objects::ObjectInstance;

/// Height of a light aircraft's centre of gravity over its wheels' contact, metres.
const AIRCRAFT_CG_M: f64 = 1.25;

/// Which shape each entry of a catalogue is drawn with; `None` is not drawn as a shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cast {
    bodies: Vec<Option<Model>>,
    projectiles: Vec<Option<Model>>,
    targets: Vec<Option<Model>>,
}

impl Cast {
    /// By the names in a catalogue.
    pub fn of(catalogue: &Catalogue) -> Self {
        Self {
            bodies: catalogue.model_names().map(|name| Some(model(name).unwrap_or(Model::Aircraft))).collect(),
            projectiles: catalogue.projectile_names().map(model).collect(),
            targets: catalogue.shape_names().map(|name| Some(model(name).unwrap_or(Model::Truck))).collect(),
        }
    }

    /// Everything of a snapshot that has a shape; the own aircraft only where it is seen from outside.
    pub fn shapes(&self, snapshot: &Snapshot, inside: bool) -> Vec<ObjectInstance> {
        let own = (!inside).then(|| {
            let own = &snapshot.aircraft;
            let attitude = sim::frame::view_attitude(own.attitude);
            let position_m = own.position_m - attitude * DVec3::Y * AIRCRAFT_CG_M;
            ObjectInstance { class: Model::Aircraft, position_m, attitude, scale: 1.0 }
        });
        let body = |one: &EntityView, class: Model| {
            let attitude = sim::frame::view_attitude(one.attitude);
            let foot_m = if class == Model::Aircraft { AIRCRAFT_CG_M } else { 0.0 };
            let position_m = one.position_m - attitude * DVec3::Y * foot_m;
            ObjectInstance { class, position_m, attitude, scale: 1.0 }
        };
        let target = |one: &EntityView, class: Model| ObjectInstance {
            class,
            position_m: one.position_m,
            attitude: one.attitude,
            scale: 1.0,
        };
        own.into_iter()
            .chain(cast(&snapshot.bodies, &self.bodies, body))
            .chain(cast(&snapshot.projectiles, &self.projectiles, body))
            .chain(cast(&snapshot.targets, &self.targets, target))
            .collect()
    }
}

fn cast<'a>(
    entities: &'a [EntityView],
    models: &'a [Option<Model>],
    place: impl Fn(&EntityView, Model) -> ObjectInstance + 'a,
) -> impl Iterator<Item = ObjectInstance> + 'a {
    let of = |one: &EntityView| models.get(one.of as usize).copied().flatten();
    entities.iter().filter_map(move |one| of(one).map(|model| place(one, model)))
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
    use glam::DQuat;
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
            jumps: 0,
        };
        let scene = sim::Scene::new(AircraftState::level(DVec3::Y * 900.0, 0.0, 60.0), UtcTime { unix_ns: 0 });
        let mut snapshot = scene.snapshot();
        snapshot.targets = vec![view(0), view(7)].into();
        let shown = cast.shapes(&snapshot, true);
        assert_eq!(shown.len(), 1);
        assert_eq!((shown[0].class, shown[0].position_m), (Model::Tank, DVec3::new(1.0, 2.0, 3.0)));
    }
}
