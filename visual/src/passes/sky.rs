//! Draws the sky, the sun's disc and its glow wherever nothing nearer was drawn. Shader: `shaders/sky.wgsl`.
//!
//! Drawn after everything solid, at depth 0 with `GreaterEqual`: only pixels still cleared run the shader.

use super::TargetFormat;
use crate::shaders;

/// The sky's pipeline. Group 0 must be bound.
pub struct SkyPass {
    pipeline: wgpu::RenderPipeline,
}

impl SkyPass {
    /// Makes the pipeline; `frame_layout` is group 0's.
    pub fn new(device: &wgpu::Device, frame_layout: &wgpu::BindGroupLayout, format: TargetFormat) -> Self {
        let module = shaders::module(device, "sky.wgsl");
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("sky"),
            bind_group_layouts: &[Some(frame_layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("sky"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("sky_vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: format.depth_state(wgpu::CompareFunction::GreaterEqual, false),
            multisample: format.multisample(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("sky_fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(format.colour.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline }
    }

    /// One triangle.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
