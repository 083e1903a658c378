//! Tracers, flashes, explosions, dust, smoke and fire as plain data, and the sprites they are at a moment.
//!
//! Frame: the world's, metres, seconds. A sprite is a function of its emitter, its number and the time alone: nothing is
//! stepped and nothing remembered, so a pause holds, a replay repeats and a jump in time shows what would have been there.
//! Rates of rise and growth are those of small fires and of bursts of the emitter's size, by eye.

use glam::{DVec3, Vec3};
use std::f32::consts::TAU;

/// What is emitted.
#[allow(missing_docs, reason = "the names say themselves what they are")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EmitterKind {
    Tracer,
    MuzzleFlash,
    Explosion,
    Dust,
    Splash,
    Smoke,
    Fire,
}

/// How long a splash lasts, seconds; over its last one it fades.
const SPLASH_S: f32 = 5.0;

/// Where, since when and how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// What.
    pub kind: EmitterKind,
    /// When it began, scene seconds.
    pub born_s: f64,
    /// Where it was then.
    pub position_m: DVec3,
    /// Of a tracer its own velocity, of a flash the muzzle's direction, of smoke and dust the wind.
    pub velocity_mps: DVec3,
    /// Radius of a fire or burst, calibre of a tracer's glow, metres.
    pub size_m: f32,
}

/// A soft disc turned to the eye, or a streak along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sprite {
    /// Its middle.
    pub position_m: DVec3,
    /// Half its length along its own axis; zero for a disc.
    pub axis_m: Vec3,
    /// Its radius.
    pub radius_m: f32,
    /// Albedo where it is lit, or radiance where it shines.
    pub colour: Vec3,
    /// How much it hides, 0 to 1.
    pub opacity: f32,
    /// Share of it that shines by itself.
    pub shines: f32,
    /// What its ragged edge is made from.
    pub seed: u32,
}

/// Longest that an emitter of a kind shows after its birth, seconds; smoke and fire until they are taken away.
fn life_s(kind: EmitterKind) -> f64 {
    match kind {
        EmitterKind::Tracer => 30.0,
        EmitterKind::MuzzleFlash => 0.09,
        EmitterKind::Explosion => 9.0,
        EmitterKind::Dust => 4.0,
        EmitterKind::Splash => f64::from(SPLASH_S),
        EmitterKind::Smoke | EmitterKind::Fire => f64::INFINITY,
    }
}

impl Emitter {
    /// Whether every number is usable.
    pub fn is_sound(&self) -> bool {
        self.position_m.is_finite()
            && self.velocity_mps.is_finite()
            && self.born_s.is_finite()
            && self.size_m.is_finite()
            && self.size_m > 0.0
    }

    /// Adds its sprites at a moment.
    pub fn sprites(&self, time_s: f64, sprites: &mut Vec<Sprite>) {
        let age_s = time_s - self.born_s;
        if !self.is_sound() || !time_s.is_finite() || age_s < 0.0 || age_s > life_s(self.kind) {
            return;
        }
        let chance = Chance(place_hash(self.position_m) ^ self.born_s.to_bits() as u32);
        match self.kind {
            EmitterKind::Tracer => self.tracer(age_s, sprites),
            EmitterKind::MuzzleFlash => self.flash(age_s as f32, chance, sprites),
            EmitterKind::Explosion => self.explosion(age_s as f32, chance, sprites),
            EmitterKind::Dust => self.dust(age_s as f32, 1.0, chance, sprites),
            EmitterKind::Splash => self.splash(age_s as f32, chance, sprites),
            EmitterKind::Smoke => self.column(age_s, chance, sprites),
            EmitterKind::Fire => self.fire(age_s, chance, sprites),
        }
    }

    fn tracer(&self, age_s: f64, sprites: &mut Vec<Sprite>) {
        // The eye keeps a fiftieth of a second of it.
        let streak = self.velocity_mps * 0.02;
        sprites.push(Sprite {
            position_m: self.position_m + self.velocity_mps * age_s - 0.5 * streak,
            axis_m: (0.5 * streak).as_vec3(),
            radius_m: self.size_m,
            colour: Vec3::new(3.0, 0.9, 0.2),
            opacity: 0.95,
            shines: 1.0,
            seed: 0,
        });
    }

    fn flash(&self, age_s: f32, chance: Chance, sprites: &mut Vec<Sprite>) {
        let way = self.velocity_mps.as_vec3().normalize_or(Vec3::Y);
        let fade = 1.0 - age_s / 0.09;
        for number in 0..6_u32 {
            let along = self.size_m * (0.3 + 0.55 * number as f32);
            sprites.push(Sprite {
                position_m: self.position_m + (way * along).as_dvec3(),
                axis_m: Vec3::ZERO,
                radius_m: self.size_m * (0.75 - 0.09 * number as f32) * (0.8 + 0.4 * chance.at(number, 0)),
                colour: Vec3::new(2.6, 1.2, 0.35) * fade,
                opacity: 0.8 * fade,
                shines: 1.0,
                seed: chance.hash(number, 9),
            });
        }
    }

    fn explosion(&self, age_s: f32, chance: Chance, sprites: &mut Vec<Sprite>) {
        let size_m = self.size_m;
        // The fireball: out within a third of a second, cooling from white to red.
        if age_s < 0.5 {
            let grown = (age_s / 0.12).min(1.0).sqrt();
            let cool = (age_s / 0.5).min(1.0);
            for number in 0..14_u32 {
                let away = chance.direction(number, 1) * (size_m * 0.55 * grown * chance.at(number, 3).cbrt());
                sprites.push(Sprite {
                    position_m: self.position_m + (away + Vec3::Y * (size_m * (0.3 + age_s))).as_dvec3(),
                    axis_m: Vec3::ZERO,
                    radius_m: size_m * (0.25 + 0.35 * grown),
                    colour: Vec3::new(2.4, 0.95, 0.2).lerp(Vec3::new(0.7, 0.1, 0.015), cool),
                    opacity: (1.0 - cool).sqrt() * 0.85,
                    shines: 1.0,
                    seed: chance.hash(number, 4),
                });
            }
        }
        let dark = Vec3::new(0.10, 0.095, 0.09);
        for number in 0..22_u32 {
            let start_s = 0.05 + 0.25 * chance.at(number, 5);
            let own_s = age_s - start_s;
            let whole_s = 4.0 + 4.5 * chance.at(number, 6);
            if own_s <= 0.0 || own_s >= whole_s {
                continue;
            }
            // Thrown out, soon stopped by the air, then carried up and by the wind.
            let thrown = chance.direction(number, 7) * Vec3::new(1.0, 0.7, 1.0) * (1.0 - (-3.0 * own_s).exp());
            let up_m = size_m * (0.5 + 0.9 * (1.0 - (-0.6 * own_s).exp()) * (0.6 + chance.at(number, 8)));
            let at = thrown * (size_m * 0.9) + Vec3::Y * up_m + self.velocity_mps.as_vec3() * own_s;
            let part = own_s / whole_s;
            sprites.push(Sprite {
                position_m: self.position_m + at.as_dvec3(),
                axis_m: Vec3::ZERO,
                radius_m: size_m * (0.35 + 0.75 * part.sqrt()),
                colour: dark.lerp(Vec3::splat(0.26), 0.7 * part),
                opacity: 0.62 * (1.0 - part) * (own_s / 0.15).min(1.0),
                shines: 0.0,
                seed: chance.hash(number, 9),
            });
        }
        self.dust(age_s, 0.6, Chance(chance.0 ^ 0x5bd1), sprites);
    }

    fn dust(&self, age_s: f32, share: f32, chance: Chance, sprites: &mut Vec<Sprite>) {
        let size_m = self.size_m;
        for number in 0..16_u32 {
            let whole_s = 1.6 + 2.2 * chance.at(number, 10);
            if age_s >= whole_s {
                continue;
            }
            let (sin, cos) = (TAU * chance.at(number, 11)).sin_cos();
            let fast = 1.0 - (-2.5 * age_s).exp();
            let out_m = size_m * (0.3 + 1.3 * chance.at(number, 12)) * fast;
            let up_m = size_m * (0.2 + 1.1 * chance.at(number, 13)) * fast * (1.0 - 0.25 * age_s / whole_s);
            let at = Vec3::new(cos * out_m, up_m, sin * out_m) + self.velocity_mps.as_vec3() * (0.5 * age_s);
            let part = age_s / whole_s;
            sprites.push(Sprite {
                position_m: self.position_m + at.as_dvec3(),
                axis_m: Vec3::ZERO,
                radius_m: size_m * (0.22 + 0.6 * part.sqrt()),
                colour: Vec3::new(0.34, 0.29, 0.22),
                opacity: share * 0.55 * (1.0 - part) * (age_s / 0.06).min(1.0),
                shines: 0.0,
                seed: chance.hash(number, 14),
            });
        }
    }

    /// Water thrown up, that falls back; what is still up at the end of its life has faded by then.
    fn splash(&self, age_s: f32, chance: Chance, sprites: &mut Vec<Sprite>) {
        const GRAVITY_MPS2: f32 = 9.81;
        let size_m = self.size_m;
        // So fast that the highest drops rise five times the size.
        let fast_mps = (2.0 * GRAVITY_MPS2 * 5.0 * size_m).sqrt();
        for number in 0..30_u32 {
            let up_mps = fast_mps * (0.35 + 0.65 * chance.at(number, 15));
            let up_m = up_mps * age_s - 0.5 * GRAVITY_MPS2 * age_s * age_s;
            if up_m < -0.2 * size_m {
                continue;
            }
            let (sin, cos) = (TAU * chance.at(number, 16)).sin_cos();
            let out_m = size_m * (0.15 + 0.6 * chance.at(number, 17)) * (1.0 - (-1.5 * age_s).exp());
            let part = (age_s * GRAVITY_MPS2 / (2.0 * up_mps)).min(1.0);
            let at = Vec3::new(cos * out_m, up_m, sin * out_m) + self.velocity_mps.as_vec3() * (0.4 * age_s);
            sprites.push(Sprite {
                position_m: self.position_m + at.as_dvec3(),
                axis_m: Vec3::ZERO,
                radius_m: size_m * (0.16 + 0.45 * part),
                colour: Vec3::splat(0.78),
                opacity: 0.7 * (1.0 - 0.8 * part) * (age_s / 0.04).min(1.0) * (SPLASH_S - age_s).clamp(0.0, 1.0),
                shines: 0.0,
                seed: chance.hash(number, 18),
            });
        }
    }

    /// A column: a puff every so often since it began.
    fn column(&self, age_s: f64, chance: Chance, sprites: &mut Vec<Sprite>) {
        const EVERY_S: f64 = 0.22;
        const WHOLE_S: f64 = 16.0;
        let newest = (age_s / EVERY_S).floor();
        let count = (WHOLE_S / EVERY_S) as u32;
        for back in 0..count {
            let puff = newest - f64::from(back);
            if puff < 0.0 {
                break;
            }
            let own_s = (age_s - puff * EVERY_S) as f32;
            // Wraps after years: the pattern then repeats.
            let number = (puff as u64 & 0xffff_ffff) as u32;
            let part = own_s / WHOLE_S as f32;
            let sway = Vec3::new(chance.at(number, 15) - 0.5, 0.0, chance.at(number, 16) - 0.5) * (own_s * 0.7);
            let rise = Vec3::Y * ((2.6 + 1.2 * chance.at(number, 17)) * own_s * (1.0 - 0.25 * part));
            let at = sway + rise + self.velocity_mps.as_vec3() * (own_s * part.sqrt().min(1.0));
            sprites.push(Sprite {
                position_m: self.position_m + at.as_dvec3(),
                axis_m: Vec3::ZERO,
                radius_m: self.size_m * (0.45 + 3.4 * part),
                colour: Vec3::splat(0.09).lerp(Vec3::splat(0.3), part),
                opacity: 0.5 * (1.0 - part).powi(2) * (own_s / 0.4).min(1.0),
                shines: 0.0,
                seed: chance.hash(number, 18),
            });
        }
    }

    fn fire(&self, age_s: f64, chance: Chance, sprites: &mut Vec<Sprite>) {
        const EVERY_S: f64 = 0.06;
        const WHOLE_S: f64 = 0.9;
        let newest = (age_s / EVERY_S).floor();
        for back in 0..(WHOLE_S / EVERY_S) as u32 {
            let tongue = newest - f64::from(back);
            if tongue < 0.0 {
                break;
            }
            let own_s = (age_s - tongue * EVERY_S) as f32;
            let number = (tongue as u64 & 0xffff_ffff) as u32;
            let part = own_s / WHOLE_S as f32;
            let (sin, cos) = (TAU * chance.at(number, 19)).sin_cos();
            let out_m = 0.5 * self.size_m * chance.at(number, 20).sqrt() * (1.0 - 0.6 * part);
            let at = Vec3::new(cos * out_m, self.size_m * (0.2 + 2.4 * part), sin * out_m);
            sprites.push(Sprite {
                position_m: self.position_m + at.as_dvec3(),
                axis_m: Vec3::ZERO,
                radius_m: self.size_m * (0.5 - 0.32 * part),
                colour: Vec3::new(1.7, 0.62, 0.1).lerp(Vec3::new(0.8, 0.14, 0.015), part),
                opacity: 0.75 * (1.0 - part),
                shines: 1.0,
                seed: chance.hash(number, 21),
            });
        }
    }
}

/// Numbers without pattern by number and use.
#[derive(Clone, Copy)]
struct Chance(u32);

impl Chance {
    fn hash(self, number: u32, of: u32) -> u32 {
        let mut h = self.0 ^ number.wrapping_mul(0x9e37_79b9) ^ of.wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        h ^ (h >> 16)
    }

    /// 0 to 1.
    fn at(self, number: u32, of: u32) -> f32 {
        (self.hash(number, of) >> 8) as f32 / (1 << 24) as f32
    }

    /// A direction of the upper half space.
    fn direction(self, number: u32, of: u32) -> Vec3 {
        let up = self.at(number, of.wrapping_add(100));
        let (sin, cos) = (TAU * self.at(number, of.wrapping_add(200))).sin_cos();
        let level = (1.0 - up * up).max(0.0).sqrt();
        Vec3::new(cos * level, up, sin * level)
    }
}

fn place_hash(at: DVec3) -> u32 {
    let bits = at.x.to_bits() ^ at.y.to_bits().rotate_left(21) ^ at.z.to_bits().rotate_left(42);
    (bits ^ (bits >> 32)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [EmitterKind; 7] = [
        EmitterKind::Tracer,
        EmitterKind::MuzzleFlash,
        EmitterKind::Explosion,
        EmitterKind::Dust,
        EmitterKind::Splash,
        EmitterKind::Smoke,
        EmitterKind::Fire,
    ];

    #[test]
    fn sprites_depend_on_the_moment_alone_and_are_usable_numbers() {
        for kind in KINDS {
            let at = DVec3::new(1e5, 800.0, -2e5);
            let emitter = Emitter { kind, born_s: 10.0, position_m: at, velocity_mps: DVec3::X, size_m: 4.0 };
            let mut most = 0;
            for time_s in [9.0, 10.0, 10.01, 10.3, 12.0, 100.0, 1e7, f64::NAN] {
                let (mut one, mut other) = (Vec::new(), Vec::new());
                emitter.sprites(time_s, &mut one);
                emitter.sprites(time_s, &mut other);
                assert_eq!(one, other);
                assert!(one.len() < 120);
                for sprite in &one {
                    assert!(sprite.position_m.is_finite() && sprite.radius_m > 0.0 && sprite.colour.is_finite());
                    assert!((0.0..=1.0).contains(&sprite.opacity), "{kind:?} {time_s}: {}", sprite.opacity);
                }
                most = most.max(one.len());
                assert!(time_s >= 10.0 || one.is_empty(), "before its birth there is nothing");
            }
            assert!(most > 0, "{kind:?}");
            let broken = Emitter { size_m: f32::NAN, ..emitter };
            let mut none = Vec::new();
            broken.sprites(11.0, &mut none);
            assert!(none.is_empty());
        }
    }
}
