//! Saving in mid-run: a restored scene goes on to the bit, and what is no saved scene is refused.

mod proving_ground;

use glam::{DQuat, DVec2};
use proving_ground::{busy, catalogue, mountains};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use sim::Scene;
use sim::ballistics::shape::Shape;
use sim::loose::LooseKind;
use sim::scene::{Catalogue, LooseStart};
use std::sync::Arc;

const SEED_BYTES: u64 = 20_261_132;

/// FNV-1a, 64 bits, written out once more: the format's promise to others.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 8;
    let sum = checksum(&bytes[..end]);
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

fn refused(bytes: &[u8]) -> String {
    Scene::restore(bytes, catalogue()).err().map_or_else(|| "taken".to_owned(), |error| error.to_string())
}

/// The busy scene with things that fall on the ground and lie about.
fn strewn() -> Scene {
    let mut scene = busy();
    for (number, kind) in LooseKind::ALL.into_iter().enumerate() {
        let (plan_m, over_ground_m) = (DVec2::new(2.0 * number as f64, 300.0), number as f64 * 0.7);
        scene.add_loose(&LooseStart { kind, plan_m, over_ground_m, attitude: DQuat::IDENTITY }).unwrap();
    }
    scene
}

#[test]
fn a_restored_scene_goes_on_to_the_bit() {
    let ground = mountains();
    let mut whole = strewn();
    let mut saves = Vec::new();
    for step in 0..300 {
        // Before anything, in the middle of bursts, before and after failures set in and commands fall due.
        if [0, 1, 41, 64, 65, 151, 260].contains(&step) {
            let counts = whole.counts();
            assert!(step == 0 || counts[1] > 0, "shells are in the air");
            saves.push((step, whole.save(), whole.snapshot().hash()));
        }
        whole.step(&ground);
    }
    assert!(whole.pending().is_empty() && !saves.is_empty());
    for (step, bytes, snapshot) in saves {
        let mut restored = Scene::restore(&bytes, catalogue()).unwrap();
        assert_eq!(restored.save(), bytes, "saved again at step {step}");
        assert_eq!(restored.snapshot().hash(), snapshot);
        for _ in step..300 {
            restored.step(&ground);
        }
        assert_eq!(restored.hash(), whole.hash(), "saved at step {step}");
        assert_eq!(restored.snapshot(), whole.snapshot());
    }
}

#[test]
fn another_catalogue_version_or_file_is_refused_by_name() {
    let bytes = busy().save();
    assert!(refused(b"").contains("expected a saved scene"));
    assert!(refused(b"PNG what").contains("expected a saved scene"));
    assert!(refused(&bytes[..bytes.len() - 1]).contains("expected the checksum"));
    let mut newer = bytes.clone();
    newer[8] = 9;
    assert!(refused(&newer).contains("expected version 4, found 9"));
    let mut longer = bytes.clone();
    longer.splice(bytes.len() - 8..bytes.len() - 8, [0; 3]);
    assert!(refused(&sealed(longer)).contains("expected the end, found 3 bytes more"));

    let with = |catalogue: Catalogue| Scene::restore(&bytes, Arc::new(catalogue)).err().unwrap().to_string();
    assert!(with(Catalogue::new()).contains("expected the model light, found none"));
    let mut more = (*catalogue()).clone();
    more.add_shape("barn", Shape::sphere(9.0).unwrap()).unwrap();
    assert!(with(more).contains("expected its end, found barn"));
    let mut changed = Catalogue::new();
    let text = proving_ground::LIGHT.replace("mass_kg = 1000.0", "mass_kg = 1000.0000000000001");
    let model = sim::rigid::Model::from_text(std::path::Path::new("light.toml"), &text).unwrap();
    changed.add_model("light", model).unwrap();
    assert!(with(changed).contains("expected the model light that was saved, found a changed one"));
}

#[test]
fn hostile_bytes_are_refused_or_step_but_never_panic() {
    let ground = mountains();
    let mut scene = strewn();
    for _ in 0..70 {
        scene.step(&ground);
    }
    let good = scene.save();
    let mut random = StdRng::seed_from_u64(SEED_BYTES);
    let (mut taken, mut told) = (0, 0);
    for round in 0..3_000 {
        let mut bytes = good.clone();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(12..bytes.len() - 8);
            bytes[at] = match round % 3 {
                0 => random.random_range(0..=255u8),
                1 => 0xff,
                _ => bytes[at] ^ (1 << random.random_range(0..8u32)),
            };
        }
        if round % 7 == 0 {
            bytes.truncate(random.random_range(20..good.len()));
        }
        match Scene::restore(&sealed(bytes), catalogue()) {
            Ok(mut scene) => {
                taken += 1;
                for _ in 0..2 {
                    scene.step(&ground);
                }
                assert!(scene.snapshot().aircraft.is_finite());
            }
            Err(error) => {
                told += 1;
                assert!(error.to_string().contains("expected"), "{error}");
            }
        }
    }
    assert!(taken > 100 && told > 100, "{taken} taken, {told} refused");
}
