//! Draws the sprites of emitters, far ones first, blended over what is there. Shader: `shaders/particles.wgsl`.
//!
//! [`Particles::prepare`] works out a view's sprites for the scene's time ([`crate::particles`]) and uploads them;
//! [`Particles::draw`] records them in [`crate::Layer::Blended`]: depth tested, not written. Without emitters nothing is
//! worked out, uploaded or drawn.

use super::TargetFormat;
use super::upload::Growing;
use crate::camera::{DEPTH_COMPARE, View};
use crate::gpu::Gpu;
use crate::particles::{Emitter, Sprite};
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

/// Most sprites of a view; the nearest are kept.
pub const MOST_SPRITES: usize = 20_000;
/// Streaks whose end is nearer to the eye are not drawn, metres.
const STREAK_M: f64 = 12.0;
/// Farthest that a sprite is drawn, metres.
const REACH_M: f64 = 30_000.0;

/// Mirror of the shader's instance inputs.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SpriteInstance {
    /// Middle minus the eye, metres.
    pub relative_m: [f32; 3],
    /// Metres.
    pub radius_m: f32,
    /// Half a streak's length along its axis.
    pub axis_m: [f32; 3],
    /// Share that shines by itself.
    pub shines: f32,
    /// Albedo or radiance, and opacity.
    pub colour: [f32; 4],
    /// What its edge is made from.
    pub seed: u32,
}

struct Prepared {
    instances: Growing,
    count: u32,
}

/// See the module.
pub struct Particles {
    pipeline: Option<wgpu::RenderPipeline>,
    frame: wgpu::BindGroupLayout,
    format: TargetFormat,
    emitters: Vec<Emitter>,
    views: Vec<Prepared>,
}

impl Particles {
    /// A pass; its pipeline is made when there first is something to draw.
    pub fn new(frame: &wgpu::BindGroupLayout, format: TargetFormat) -> Self {
        Self { pipeline: None, frame: frame.clone(), format, emitters: Vec::new(), views: Vec::new() }
    }

    /// Replaces the emitters.
    pub fn set(&mut self, emitters: impl IntoIterator<Item = Emitter>) {
        self.emitters.clear();
        self.emitters.extend(emitters);
    }

    /// Sprites drawn in a view.
    pub fn count(&self, view_index: usize) -> u32 {
        self.views.get(view_index).map_or(0, |prepared| prepared.count)
    }

    /// Bytes on the GPU.
    pub fn gpu_bytes(&self) -> usize {
        self.views.iter().map(|prepared| prepared.instances.bytes()).sum()
    }

    /// Works out and uploads a view's sprites at a moment.
    pub fn prepare(&mut self, gpu: &Gpu, view_index: usize, view: &View, time_s: f64) {
        while self.views.len() <= view_index {
            self.views.push(Prepared { instances: Growing::new("sprites", wgpu::BufferUsages::VERTEX), count: 0 });
        }
        let prepared = &mut self.views[view_index];
        prepared.count = 0;
        if self.emitters.is_empty() {
            return;
        }
        let instances = instances(&self.emitters, view, time_s);
        if instances.is_empty() {
            return;
        }
        if self.pipeline.is_none() {
            self.pipeline = Some(pipeline(gpu, &self.frame, self.format));
        }
        prepared.instances.write(&gpu.device, &gpu.queue, &[bytemuck::cast_slice(&instances)]);
        prepared.count = instances.len() as u32;
    }

    /// Records a prepared view's sprites; group 0 must be bound.
    pub fn draw(&self, view_index: usize, pass: &mut wgpu::RenderPass<'_>) {
        let Some(prepared) = self.views.get(view_index).filter(|prepared| prepared.count > 0) else { return };
        let (Some(pipeline), Some(instances)) = (&self.pipeline, prepared.instances.buffer()) else { return };
        pass.set_pipeline(pipeline);
        pass.set_vertex_buffer(0, instances.slice(..));
        pass.draw(0..4, 0..prepared.count);
    }
}

/// A view's sprites, farthest first.
fn instances(emitters: &[Emitter], view: &View, time_s: f64) -> Vec<SpriteInstance> {
    let forward = view.attitude * DVec3::NEG_Z;
    let mut sprites: Vec<Sprite> = Vec::new();
    for emitter in emitters {
        // What one emitter may spread to, far away and behind, is not looked at in detail.
        if sprites.len() < 4 * MOST_SPRITES {
            emitter.sprites(time_s, &mut sprites);
        }
    }
    let mut seen: Vec<(f64, &Sprite)> = sprites
        .iter()
        .filter_map(|sprite| {
            let away = sprite.position_m - view.eye_m;
            let reach_m = f64::from(sprite.radius_m + sprite.axis_m.length());
            let ahead_m = away.dot(forward);
            // A streak that passes the eye would fill the picture.
            let is_past = sprite.axis_m != Vec3::ZERO && away.length() < f64::from(sprite.axis_m.length()) + STREAK_M;
            (ahead_m + reach_m > view.near_m && away.length() < REACH_M && sprite.opacity > 0.002 && !is_past)
                .then_some((ahead_m, sprite))
        })
        .collect();
    seen.sort_by(|a, b| b.0.total_cmp(&a.0));
    let skipped = seen.len().saturating_sub(MOST_SPRITES);
    seen[skipped..]
        .iter()
        .map(|(_, sprite)| SpriteInstance {
            relative_m: (sprite.position_m - view.eye_m).as_vec3().to_array(),
            radius_m: sprite.radius_m,
            axis_m: sprite.axis_m.to_array(),
            shines: sprite.shines,
            colour: sprite.colour.max(Vec3::ZERO).extend(sprite.opacity).to_array(),
            seed: sprite.seed,
        })
        .collect()
}

fn pipeline(gpu: &Gpu, frame: &wgpu::BindGroupLayout, format: TargetFormat) -> wgpu::RenderPipeline {
    let device = &gpu.device;
    let module = shaders::module(device, "particles.wgsl");
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("particles"),
        bind_group_layouts: &[Some(frame)],
        immediate_size: 0,
    });
    let instance = wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Float32, 4 => Float32x4, 5 => Uint32
    ];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("particles"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("particles_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<SpriteInstance>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &instance,
            })],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: format.depth_state(DEPTH_COMPARE, false),
        multisample: format.multisample(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("particles_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: format.colour,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
