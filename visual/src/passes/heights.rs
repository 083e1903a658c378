//! Reads back where the vertex stage puts every post of the window. For proofs only. Shader: `shaders/heights.wgsl`.

use super::terrain::Terrain;
use crate::camera::View;
use crate::capture;
use crate::frame::Scene;
use crate::gpu::{Gpu, GpuError};
use crate::shaders;
use crate::sky::Light;
use crate::uniforms::{FrameBindings, FrameUniforms};
use terrain::block::mesh::TILE;

/// Posts of a workgroup, as in the shader.
const GROUP: u32 = 64;

/// A post as the device has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlacedPost {
    /// Bits of the height.
    pub height: u32,
    /// Bits of the position minus the eye: x, y, z.
    pub relative: [u32; 3],
}

/// All posts of all slots, slot by slot, `TILE` x `TILE` row by row. The terrain must be prepared for the view.
///
/// # Errors
/// What the device reports.
pub fn read(gpu: &Gpu, terrain: &Terrain, view: &View) -> Result<Vec<PlacedPost>, GpuError> {
    let device = &gpu.device;
    let mut frame = FrameBindings::new(device);
    // Only the eye counts here.
    let dark = Light::none();
    let uniforms = FrameUniforms::new(view, &Scene::default(), &dark, view.size_px);
    let frame_group = frame.write_view(device, &gpu.queue, 0, &uniforms);

    let (window_layout, window_group) = terrain.bindings();
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("placed posts"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: false },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    });
    let slots = terrain.window().settings().blocks.pow(2);
    let placed = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("placed posts"),
        size: u64::from(slots * TILE * TILE) * 16,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("placed posts"),
        layout: &layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: placed.as_entire_binding() }],
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("heights"),
        layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("heights"),
            bind_group_layouts: &[Some(&frame.layout), Some(window_layout), Some(&layout)],
            immediate_size: 0,
        })),
        module: &shaders::module(device, "heights.wgsl"),
        entry_point: Some("heights_compute"),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants: &[("TILE", f64::from(TILE))],
            ..wgpu::PipelineCompilationOptions::default()
        },
        cache: None,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("heights") });
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &frame_group, &[]);
    pass.set_bind_group(1, window_group, &[]);
    pass.set_bind_group(2, &group, &[]);
    pass.dispatch_workgroups((TILE * TILE).div_ceil(GROUP), slots, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    let words = capture::read_words(gpu, &placed)?;
    let posts = words.as_chunks::<4>().0.iter();
    Ok(posts.map(|&[height, x, y, z]| PlacedPost { height, relative: [x, y, z] }).collect())
}
