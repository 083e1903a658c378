//! What the entities of a scene are made of: models, projectiles and shapes by name, shared and never changed.
//!
//! A saved scene holds names and fingerprints, not the things: who restores it brings the same catalogue. A fingerprint
//! is a hash over everything that the thing is made of as this build prints it, the name of its file left out (that of
//! a model's DAVE-ML files counts, as the model names them). Another build may print otherwise: then a saved scene is
//! refused, never misread.
//!
//! Invariant others rely on: a place in a list means the same thing for as long as the scene lasts.

use super::Refused;
use super::codec::{FNV_BASIS, LONGEST_TEXT, fnv};
use crate::ballistics::projectile::Projectile;
use crate::ballistics::shape::Shape;
use crate::rigid::Model;
use crate::track::Track;
use crate::weapons::{TargetKind, Weapon};
use std::fmt::{self, Debug, Write};
use std::path::PathBuf;
use std::sync::Arc;

/// A thing with its name.
#[derive(Debug, Clone)]
pub(super) struct Named<T> {
    pub name: String,
    pub thing: T,
    pub fingerprint: u64,
}

/// Models, projectiles and shapes by name.
#[derive(Debug, Clone, Default)]
pub struct Catalogue {
    pub(super) models: Vec<Named<Arc<Model>>>,
    pub(super) projectiles: Vec<Named<Arc<Projectile>>>,
    pub(super) shapes: Vec<Named<Shape>>,
    /// Weapons; the projectile of each has its name, too.
    pub(super) weapons: Vec<Named<Arc<Weapon>>>,
    /// Kinds of targets; the shape of each has its name, too.
    pub(super) kinds: Vec<Named<Arc<TargetKind>>>,
    /// The own aircraft's track, for restoring a scene that has one.
    pub track: Option<Track>,
}

impl Catalogue {
    /// An empty one.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a rigid body's model.
    ///
    /// # Errors
    /// [`Refused`] if the name is taken or too long.
    pub fn add_model(&mut self, name: &str, model: Model) -> Result<(), Refused> {
        let print = fingerprint(&model.placeless());
        add(&mut self.models, "model", name, Arc::new(model), print)
    }

    /// Adds a projectile.
    ///
    /// # Errors
    /// [`Refused`] if the name is taken or too long.
    pub fn add_projectile(&mut self, name: &str, projectile: Projectile) -> Result<(), Refused> {
        let nameless = Projectile { file: PathBuf::new(), drag_file: None, ..projectile.clone() };
        add(&mut self.projectiles, "projectile", name, Arc::new(projectile), fingerprint(&nameless))
    }

    /// Adds a target's shape.
    ///
    /// # Errors
    /// [`Refused`] if the name is taken or too long.
    pub fn add_shape(&mut self, name: &str, shape: Shape) -> Result<(), Refused> {
        let print = fingerprint(&shape);
        add(&mut self.shapes, "shape", name, shape, print)
    }

    /// Adds a weapon, and its projectile under the same name.
    ///
    /// # Errors
    /// [`Refused`] if the name is taken or too long.
    pub fn add_weapon(&mut self, name: &str, weapon: Weapon) -> Result<(), Refused> {
        self.add_projectile(name, weapon.projectile.clone())?;
        let projectile = Projectile { file: PathBuf::new(), drag_file: None, ..weapon.projectile.clone() };
        let print = fingerprint(&Weapon { file: PathBuf::new(), projectile, ..weapon.clone() });
        add(&mut self.weapons, "weapon", name, Arc::new(weapon), print)
    }

    /// Adds a kind of target, and its shape under the same name.
    ///
    /// # Errors
    /// [`Refused`] if the name is taken or too long.
    pub fn add_target_kind(&mut self, name: &str, kind: TargetKind) -> Result<(), Refused> {
        self.add_shape(name, kind.shape.clone())?;
        let print = fingerprint(&TargetKind { file: PathBuf::new(), ..kind.clone() });
        add(&mut self.kinds, "target", name, Arc::new(kind), print)
    }

    /// The weapon of an event or a score.
    pub fn weapon_at(&self, place: u32) -> Option<(&str, &Weapon)> {
        self.weapons.get(place as usize).map(|named| (named.name.as_str(), &*named.thing))
    }

    /// The kind of target whose shape has this place; `None` of a bare shape.
    pub fn kind_of_shape(&self, shape: u32) -> Option<&TargetKind> {
        let name = &self.shapes.get(shape as usize)?.name;
        self.kind(name).map(|kind| &*self.kinds[kind as usize].thing)
    }

    /// The kind of target of a name.
    ///
    /// # Errors
    /// [`Refused`] names those that there are.
    pub fn target_kind(&self, name: &str) -> Result<&TargetKind, Refused> {
        place("target", &self.kinds, name).map(|kind| &*self.kinds[kind as usize].thing)
    }

    /// The place of a kind of target, if there is one of this name.
    pub(super) fn kind(&self, name: &str) -> Option<u32> {
        self.kinds.iter().position(|named| named.name == name).map(|place| place as u32)
    }

    pub(super) fn weapon(&self, name: &str) -> Result<u32, Refused> {
        place("weapon", &self.weapons, name)
    }

    pub(super) fn model(&self, name: &str) -> Result<u32, Refused> {
        place("model", &self.models, name)
    }

    pub(super) fn projectile(&self, name: &str) -> Result<u32, Refused> {
        place("projectile", &self.projectiles, name)
    }

    pub(super) fn shape(&self, name: &str) -> Result<u32, Refused> {
        place("shape", &self.shapes, name)
    }

    /// The weapon whose rounds are this projectile.
    pub fn weapon_of_projectile(&self, name: &str) -> Option<&Weapon> {
        self.weapons.iter().find(|named| named.name == name).map(|named| &*named.thing)
    }

    /// The models, in order.
    pub fn models(&self) -> impl Iterator<Item = (&str, &Model)> {
        self.models.iter().map(|named| (named.name.as_str(), &*named.thing))
    }

    /// Names of the models, in order.
    pub fn model_names(&self) -> impl Iterator<Item = &str> {
        self.models.iter().map(|named| named.name.as_str())
    }

    /// Names of the projectiles, in order.
    pub fn projectile_names(&self) -> impl Iterator<Item = &str> {
        self.projectiles.iter().map(|named| named.name.as_str())
    }

    /// Names of the targets' shapes, in order.
    pub fn shape_names(&self) -> impl Iterator<Item = &str> {
        self.shapes.iter().map(|named| named.name.as_str())
    }

    /// Kind, name and fingerprint of everything, in order.
    pub(super) fn prints(&self) -> impl Iterator<Item = (u8, &str, u64)> {
        let models = self.models.iter().map(|named| (0, named.name.as_str(), named.fingerprint));
        let projectiles = self.projectiles.iter().map(|named| (1, named.name.as_str(), named.fingerprint));
        let shapes = self.shapes.iter().map(|named| (2, named.name.as_str(), named.fingerprint));
        let weapons = self.weapons.iter().map(|named| (3, named.name.as_str(), named.fingerprint));
        let kinds = self.kinds.iter().map(|named| (4, named.name.as_str(), named.fingerprint));
        models.chain(projectiles).chain(shapes).chain(weapons).chain(kinds)
    }
}

fn add<T>(list: &mut Vec<Named<T>>, what: &str, name: &str, thing: T, fingerprint: u64) -> Result<(), Refused> {
    if name.is_empty() || name.len() > LONGEST_TEXT {
        return Err(Refused::new(format_args!(
            "{what}: expected a name of 1 to {LONGEST_TEXT} bytes, found {}",
            name.len()
        )));
    }
    if list.iter().any(|named| named.name == name) {
        return Err(Refused::new(format_args!("{what}: expected a name that is not taken, found {name}")));
    }
    list.push(Named { name: name.to_owned(), thing, fingerprint });
    Ok(())
}

fn place<T>(what: &str, list: &[Named<T>], name: &str) -> Result<u32, Refused> {
    let missing = || {
        let known: Vec<&str> = list.iter().map(|named| named.name.as_str()).collect();
        Refused::new(format_args!("{what}: expected one of [{}], found {name}", known.join(", ")))
    };
    list.iter().position(|named| named.name == name).map(|place| place as u32).ok_or_else(missing)
}

/// A hash of what is written to it, so that no text of a large model is ever held.
struct Hashing(u64);

impl Write for Hashing {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0 = fnv(self.0, text.as_bytes());
        Ok(())
    }
}

/// A hash over all that a thing is made of. Numbers print with all their digits.
pub(super) fn fingerprint(thing: &impl Debug) -> u64 {
    let mut hashing = Hashing(FNV_BASIS);
    // A hash takes any text.
    let _ = write!(hashing, "{thing:?}");
    hashing.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_one_bit_is_another_fingerprint() {
        let mut catalogue = Catalogue::new();
        catalogue.add_shape("ball", Shape::sphere(1.0).unwrap()).unwrap();
        catalogue.add_shape("other", Shape::sphere(1.0 + f64::EPSILON).unwrap()).unwrap();
        let again = catalogue.add_shape("ball", Shape::sphere(2.0).unwrap()).unwrap_err();
        assert!(again.to_string().contains("not taken, found ball"));
        assert!(catalogue.add_shape("", Shape::sphere(2.0).unwrap()).is_err());
        let prints: Vec<u64> = catalogue.prints().map(|(_, _, print)| print).collect();
        assert_ne!(prints[0], prints[1]);
        assert!(catalogue.shape("cube").unwrap_err().to_string().contains("expected one of [ball, other], found cube"));
    }

    #[test]
    fn a_daveml_model_has_one_fingerprint_wherever_and_however_often_it_is_read() {
        let dml = r#"<DAVEfunc xmlns="http://daveml.org/2010/DAVEML"><fileHeader name="x"/>
            <variableDef name="angleOfAttack" varID="a" units="deg"><isInput/></variableDef>
            <variableDef name="k" varID="k" units="nd" initialValue="0.1"/>
            <variableDef name="totalCoefficientOfLift" varID="cl" units="nd"><calculation><math>
            <apply><times/><ci>k</ci><ci>a</ci></apply></math></calculation><isOutput/></variableDef></DAVEfunc>"#;
        let text = "[body]\nmass_kg = 1\ninertia_kgm2 = [[1,0,0],[0,1,0],[0,0,1]]\n[reference]\narea_m2 = 1\n\
                    [[daveml]]\nfile = \"wing.dml\"\n";
        let print = |folder: &str, dml: &str| {
            let folder = std::env::temp_dir().join(format!("poligon-print-{}-{folder}", std::process::id()));
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(folder.join("wing.dml"), dml).unwrap();
            let model = Model::from_text(&folder.join("m.toml"), text).unwrap();
            std::fs::remove_dir_all(&folder).unwrap();
            fingerprint(&model.placeless())
        };
        let first = print("a", dml);
        assert!((0..8).all(|_| print("a", dml) == first) && print("b", dml) == first);
        assert_ne!(print("a", &dml.replace("0.1", "0.2")), first);
    }
}
