//! What each thing on the ground costs: the same places with the ground alone, with one kind of thing more, with all.
//!
//! The places are those of the embedded gallery, at their own hours. All sceneries are alive at once, each with a device
//! of its own, and draw a place in turns; a round is the mean over all places. The floor is the ground alone. The last row
//! is a world that has nothing on it with everything switched on: it must cost what the ground alone costs.

use super::OWN;
use super::cameras::Camera;
use super::statistics::{Against, Better, alone, beside};
use crate::failure::Failure;
use crate::report::BenchResult;
use crate::scenery::{Content, Look, Scenery};
use crate::values::Quality;
use crate::views::Views;
use std::sync::Arc;
use std::time::Instant;
use terrain::features::cover::Cover;
use terrain::store::World;
use visual::capture::{self, Offscreen};
use visual::{Gpu, GpuError};

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// Picture size, pixels.
    pub size_px: [u32; 2],
    /// Rounds at each place.
    pub rounds: u32,
    /// Every how many-th place of the list is taken.
    pub stride: usize,
}

impl Load {
    /// What the program measures with.
    pub const FULL: Self = Self { size_px: [1280, 720], rounds: 9, stride: 1 };
}

/// One kind of content.
struct Variant {
    name: &'static str,
    content: Content,
    quality: Quality,
    empty: bool,
}

const NOTHING: Content = Content { overlays: false, objects: false, plants: 0.0, lights: false, ..Content::ALL };

fn variants() -> Vec<Variant> {
    let standard = |name, content| Variant { name, content, quality: Quality::Standard, empty: false };
    vec![
        standard("ground alone", NOTHING),
        standard("overlays", Content { overlays: true, ..NOTHING }),
        standard("objects", Content { objects: true, ..NOTHING }),
        standard("plants", Content { plants: 1.0, ..NOTHING }),
        standard("lights", Content { lights: true, ..NOTHING }),
        standard("everything", Content::ALL),
        Variant { quality: Quality::Software, ..standard("everything, software", Content::ALL) },
        Variant { empty: true, ..standard("everything on, nothing there", Content::ALL) },
    ]
}

/// Measures frames, start and memory over a world.
///
/// # Errors
/// [`GpuError`] as a [`Failure`], also where there is no adapter.
pub fn bench(world: &Arc<World>, views: &Views, load: Load) -> Result<Vec<BenchResult>, Failure> {
    let failed = |error: GpuError| Failure::while_doing("measuring a scene", error);
    let bare = Arc::new(World {
        features: Arc::default(),
        cover: Arc::new(Cover::unknown(world.field.grid())),
        ..World::clone(world)
    });
    let variants = variants();
    let (mut sceneries, mut targets, mut start_ms) = (Vec::new(), Vec::new(), Vec::new());
    for variant in &variants {
        let mut look = Look { size_px: load.size_px, ..Look::preset(variant.quality) };
        look.content = match variant.quality {
            Quality::Software => look.content,
            _ => variant.content,
        };
        let gpu = Gpu::headless().map_err(failed)?;
        let started = Instant::now();
        let scenery = Scenery::new(gpu, capture::FORMAT, if variant.empty { &bare } else { world }.clone(), look);
        start_ms.push(started.elapsed().as_secs_f64() * 1e3);
        targets.push(Offscreen::new(&scenery.gpu, load.size_px).map_err(failed)?);
        sceneries.push(scenery);
    }
    let places: Vec<_> = views.places(world, &sceneries[0].area)?.into_iter().step_by(load.stride).collect();
    let mut times_ms = vec![vec![0.0; load.rounds as usize]; variants.len()];
    let mut worst_ms = vec![0.0f64; variants.len()];
    let share = 1.0 / places.len() as f64;
    for place in &places {
        let camera = Camera { eye_m: place.stand.eye_m, attitude: place.stand.attitude };
        for (scenery, target) in sceneries.iter_mut().zip(&targets) {
            scenery.look.visibility_m = place.visibility_m;
            camera.settle(scenery, place.stand.heavens, target)?;
        }
        let mut round = vec![Vec::new(); variants.len()];
        for _ in 0..load.rounds {
            for ((scenery, target), round) in sceneries.iter_mut().zip(&targets).zip(&mut round) {
                round.push(camera.frame_ms(scenery, place.stand.heavens, target)?);
            }
        }
        for ((sum, worst), round) in times_ms.iter_mut().zip(&mut worst_ms).zip(&round) {
            for (sum, ms) in sum.iter_mut().zip(round) {
                *sum += share * ms;
                *worst = worst.max(*ms);
            }
        }
    }
    let mut results = Vec::new();
    let [width, height] = load.size_px;
    for (at, variant) in variants.iter().enumerate() {
        let note = format!(
            "{width}x{height}, mean over {} places, worst frame {:.0} ms, made in {:.0} ms, {:.1} MiB on the device",
            places.len(),
            worst_ms[at],
            start_ms[at],
            sceneries[at].gpu_bytes() as f64 / 1_048_576.0
        );
        let name = format!("scene: {}", variant.name);
        results.push(if at == 0 {
            alone(&name, "ms", &times_ms[0], note)
        } else {
            let ground = Against { name: "ground alone", version: OWN, values: &times_ms[0] };
            beside(&name, "ms", Better::Less, &times_ms[at], ground, note)
        });
    }
    Ok(results)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_thing_has_a_row() {
        if let Err(reason) = Gpu::headless() {
            println!("skipped: {reason}");
            return;
        }
        let world = Arc::new(crate::bench::tests::tiny_world());
        let list = std::env::temp_dir().join(format!("poligon-bench-scene-{}.toml", std::process::id()));
        std::fs::write(&list, "[[picture]]\nname = \"a\"\neye = \"42.5,78.5,900:agl\"\nlook = \"30,-10\"\n").unwrap();
        let views = Views::read(Some(&list)).unwrap();
        std::fs::remove_file(&list).unwrap();
        let results = bench(&world, &views, Load { size_px: [64, 36], rounds: 2, stride: 1 }).unwrap();
        assert_eq!(results.len(), variants().len());
        assert!(results.iter().all(|result| result.ours > 0.0 && result.rounds == 2), "{results:?}");
    }
}
