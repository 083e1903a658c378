//! One file a pass, named as its shader. A pass owns its pipeline and buffers and has a plain `draw`.

mod bindings;
pub mod canopy;
pub mod decals;
pub mod detail;
pub mod heights;
pub mod lights;
pub mod lines;
pub mod object_tiles;
pub mod objects;
pub mod overlay;
pub mod particles;
pub mod plants;
pub mod plants_kinds;
pub mod plants_seen;
pub mod sky;
pub mod terrain;
pub mod terrain_textures;
mod upload;
pub mod upscale;

/// What a pipeline must know of the target that it draws to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TargetFormat {
    /// Colour format; an sRGB one, so that shaders write linear colour.
    pub colour: wgpu::TextureFormat,
    /// Depth format, where the pass has depth.
    pub depth: Option<wgpu::TextureFormat>,
    /// Samples a pixel, 1 or 4.
    pub samples: u32,
}

impl TargetFormat {
    /// The multisample state of a pipeline for this target.
    pub fn multisample(&self) -> wgpu::MultisampleState {
        wgpu::MultisampleState { count: self.samples, ..wgpu::MultisampleState::default() }
    }

    /// The depth state of a pipeline for this target; `None` where the target has no depth.
    pub fn depth_state(&self, compare: wgpu::CompareFunction, write: bool) -> Option<wgpu::DepthStencilState> {
        self.depth.map(|format| wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        })
    }
}
