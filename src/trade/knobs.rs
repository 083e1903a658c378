//! The five knobs, each with its values from coarsest to finest.

use super::Effort;
use super::landscape;
use super::post_step;
use super::stage::{Actor, Seen, play};
use crate::bench::cameras::{self, Camera};
use crate::failure::Failure;
use crate::report::{Knob, KnobPoint, Trade};
use crate::scenery::{self, Look};
use crate::values::Quality;
use glam::DVec3;
use std::sync::Arc;
use terrain::bake::BakeRequest;
use terrain::block::window::MAX_BLOCKS;
use terrain::store::World;
use visual::capture::Picture;

const FRAME_MS: &str = "ms a frame (median)";
const SURFACE_PX: &str = "px of 1080 rows over 60 degrees, root mean square of the surface drawn against level 0";
const GREY: &str = "grey of 255, root mean square of the picture against all at level 0";

/// One value to try.
pub(super) struct Value {
    pub setting: f64,
    pub look: Look,
}

/// What all knobs share.
pub(super) struct Setting<'a> {
    pub world: &'a Arc<World>,
    pub look: Look,
    pub cameras: Vec<Camera>,
    pub to_sun: DVec3,
    pub effort: &'a Effort,
}

/// Measures every knob over a world that was baked from a request; `tell` hears what is being done.
///
/// # Errors
/// [`Failure`] where there is no adapter, or a bake fails.
pub fn measure(
    world: &Arc<World>,
    request: &BakeRequest,
    effort: &Effort,
    tell: &mut dyn FnMut(&str),
) -> Result<Trade, Failure> {
    // From the crest of the range on: mountains near and far ahead, plains or the lake behind.
    let shares: Vec<f64> = (0..effort.places).map(|i| 0.17 + 0.7 * f64::from(i) / f64::from(effort.places)).collect();
    let ahead = cameras::along_track(world, &shares)?;
    let cameras = ahead.iter().flat_map(|camera| [*camera, camera.turned(std::f64::consts::PI)]).collect();
    let look = Look { size_px: effort.size_px, ..Look::preset(Quality::Standard) };
    let to_sun = scenery::to_sun(world, scenery::default_moment(world))?;
    let setting = Setting { world, look, cameras, to_sun, effort };

    tell("the reference: all at level 0");
    let reference = setting.reference(look)?;
    let values = |quick: &[f64], full: &[f64], look: &dyn Fn(f64) -> Look| -> Vec<Value> {
        let settings = if effort.quick { quick } else { full };
        settings.iter().map(|&setting| Value { setting, look: look(setting) }).collect()
    };
    let mut knobs = Vec::new();

    tell("window");
    let widest = setting.reference(Look { window: MAX_BLOCKS, ..look })?;
    let windows = values(&[12.0, 24.0], &[12.0, 16.0, 20.0, 24.0], &|n| Look { window: n as u32, ..look });
    let unit = format!("{GREY} and a window of {MAX_BLOCKS}");
    knobs.push(setting.knob("window", "blocks along a side", &unit, windows, &widest, |seen, grey| KnobPoint {
        error: grey,
        bytes: Some(seen.gpu_bytes),
        ..KnobPoint::default()
    })?);
    drop(widest);

    let by_surface = |seen: &Seen, _: f64| KnobPoint {
        error: seen.surface_rms_px,
        error_max: Some(seen.surface_max_px),
        ..KnobPoint::default()
    };
    tell("pixel limit");
    let limits =
        values(&[8.0, 4.0, 2.0, 1.0, 0.5, 0.25], &[8.0, 5.6, 4.0, 2.8, 2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25], &|px| {
            Look { limit_px: px, ..look }
        });
    knobs.push(setting.knob("pixel limit", "px", SURFACE_PX, limits, &reference, by_surface)?);

    tell("near radius");
    let radii =
        values(&[6.5, 13.0, 26.0], &[6.5, 9.2, 13.0, 18.4, 26.0], &|km| Look { near_radius_m: Some(1e3 * km), ..look });
    knobs.push(setting.knob("near radius", "km", SURFACE_PX, radii, &reference, by_surface)?);

    tell("post step");
    knobs.push(setting.post_step(request)?);

    tell("render scale");
    let scales = values(&[0.5, 0.67, 0.8, 1.0], &[0.5, 0.6, 0.67, 0.75, 0.85, 1.0], &|scale| Look {
        render_scale: scale as f32,
        ..look
    });
    knobs.push(setting.knob(
        "render scale",
        "px drawn a px shown, along a side",
        GREY,
        scales,
        &reference,
        |_, grey| KnobPoint { error: grey, ..KnobPoint::default() },
    )?);

    knobs.extend(landscape::knobs(&setting, tell)?);

    let [width, height] = effort.size_px;
    let conditions = format!(
        "{width}x{height}, {} cameras on {}, {} rounds each, the values of a knob in turns; all else as in `standard`",
        setting.cameras.len(),
        world.name,
        effort.rounds,
    );
    Ok(Trade { knobs, conditions })
}

impl Setting<'_> {
    /// The pictures of a look with everything at level 0.
    fn reference(&self, look: Look) -> Result<Vec<Picture>, Failure> {
        let mut actors = [Actor::new(self.world, Look { all_level_0: true, ..look })?];
        play(&mut actors, &self.cameras, self.to_sun, &Effort { rounds: 0, ..*self.effort })?;
        let [actor] = actors;
        Ok(actor.into_pictures())
    }

    /// A knob whose values are looks.
    pub(super) fn knob(
        &self,
        name: &str,
        unit: &str,
        error_unit: &str,
        values: Vec<Value>,
        reference: &[Picture],
        point: impl Fn(&Seen, f64) -> KnobPoint,
    ) -> Result<Knob, Failure> {
        let mut actors = Vec::with_capacity(values.len());
        for value in &values {
            actors.push(Actor::new(self.world, value.look)?);
        }
        play(&mut actors, &self.cameras, self.to_sun, self.effort)?;
        let points = values.iter().zip(&actors).map(|(value, actor)| {
            let (seen, grey) = (actor.seen(), actor.grey_rms_from(reference));
            KnobPoint {
                setting: value.setting,
                cost: seen.ms,
                triangles: Some(seen.triangles),
                image_rms_grey: Some(grey),
                ..point(&seen, grey)
            }
        });
        Ok(Knob {
            name: name.into(),
            unit: unit.into(),
            error_unit: error_unit.into(),
            cost_unit: FRAME_MS.into(),
            points: points.collect(),
            ..Knob::default()
        })
    }

    /// The post step: worlds instead of looks.
    fn post_step(&self, request: &BakeRequest) -> Result<Knob, Failure> {
        let steps: &[f64] =
            if self.effort.quick { &[400.0, 200.0, 100.0] } else { &[400.0, 300.0, 200.0, 150.0, 100.0] };
        let (mut actors, mut points) = (Vec::new(), Vec::new());
        for &step_m in steps {
            let request = post_step::at_step(request, step_m);
            let (world, bake_s) = post_step::baked(&request)?;
            let Some(window) = post_step::window(&world) else { continue };
            let errors_m = post_step::source_errors_m(&world, &request)?;
            let world = Arc::new(world);
            let look = Look { window, visibility_m: Some(post_step::RANGE_M), ..self.look };
            let actor = Actor::new(&world, look)?;
            points.push(KnobPoint {
                setting: step_m,
                error: errors_m.rms(),
                error_max: Some(errors_m.largest),
                bytes: Some(world.field.bytes() as u64),
                bake_s: Some(bake_s),
                ..KnobPoint::default()
            });
            actors.push(actor);
        }
        play(&mut actors, &self.cameras, self.to_sun, self.effort)?;
        for (point, actor) in points.iter_mut().zip(&actors) {
            let seen = actor.seen();
            (point.cost, point.triangles) = (seen.ms, Some(seen.triangles));
        }
        Ok(Knob {
            name: "post step".into(),
            unit: "m".into(),
            error_unit: "m, root mean square of the ground against the source's samples, off lakes".into(),
            cost_unit: format!("{FRAME_MS}, {:.0} km of sight", post_step::RANGE_M * 1e-3),
            points,
            ..Knob::default()
        })
    }
}
