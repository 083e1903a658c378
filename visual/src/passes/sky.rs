//! Draws the sky, the sun's disc and glow and the moon wherever nothing nearer was drawn. Shader: `shaders/sky.wgsl`.
//!
//! Drawn after everything solid, at depth 0 with `GreaterEqual`: only pixels still cleared run the shader.

use super::TargetFormat;
use crate::shaders;

/// The pipelines of the sky and of the sun in it. Group 0 must be bound.
pub struct SkyPass {
    sky: wgpu::RenderPipeline,
    sun: wgpu::RenderPipeline,
    moon: wgpu::RenderPipeline,
}

impl SkyPass {
    /// Makes the pipelines; `frame_layout` is group 0's.
    pub fn new(device: &wgpu::Device, frame_layout: &wgpu::BindGroupLayout, format: TargetFormat) -> Self {
        let module = shaders::module(device, "sky.wgsl");
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("sky"),
            bind_group_layouts: &[Some(frame_layout)],
            immediate_size: 0,
        });
        let pipeline = |vertex, fragment, topology, blend| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(fragment),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState { topology, ..wgpu::PrimitiveState::default() },
                depth_stencil: format.depth_state(wgpu::CompareFunction::GreaterEqual, false),
                multisample: format.multisample(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: format.colour,
                        blend,
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        // Alpha 0 in premultiplied blending adds.
        let add = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
        Self {
            sky: pipeline("sky_vertex", "sky_fragment", wgpu::PrimitiveTopology::TriangleList, None),
            sun: pipeline("sun_vertex", "sun_fragment", wgpu::PrimitiveTopology::TriangleStrip, add),
            moon: pipeline("moon_vertex", "moon_fragment", wgpu::PrimitiveTopology::TriangleStrip, add),
        }
    }

    /// One triangle for the sky, two for the sun, two for a moon that is up.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, moon: bool) {
        pass.set_pipeline(&self.sky);
        pass.draw(0..3, 0..1);
        pass.set_pipeline(&self.sun);
        pass.draw(0..4, 0..1);
        if moon {
            pass.set_pipeline(&self.moon);
            pass.draw(0..4, 0..1);
        }
    }
}
