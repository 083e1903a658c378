//! What plants are drawn with, whichever stand in sight: the table of species, their pictures, their models.

use super::bindings::{texture, uniform};
use super::upload::{filled, mip};
use crate::gpu::Gpu;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;
use vegetation::detail::{self, WIDTHS};
use vegetation::pictures;
use vegetation::species::SPECIES;

/// Species that the shader has room for.
pub const MOST_SPECIES: usize = 32;

/// Mirror of the shader's `Species`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct SpeciesEntry {
    /// Least and greatest height, metres.
    pub height_m: [f32; 2],
    /// Crown width over height.
    pub width: f32,
    /// Number of its shape.
    pub shape: f32,
    /// Linear albedo; the width that the shape's pictures are made for.
    pub colour: [f32; 4],
}

/// A corner of a model.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct ModelVertex {
    position: [f32; 3],
    normal_open: [i8; 4],
    uv_leaf: [u8; 4],
}

pub(super) const MODEL_ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm8x4, 2 => Unorm8x4];
pub(super) const COMMON: [(wgpu::ShaderStages, wgpu::BindingType); 3] = [
    (wgpu::ShaderStages::VERTEX, uniform(false)),
    (wgpu::ShaderStages::FRAGMENT, texture(wgpu::TextureViewDimension::D2Array)),
    (wgpu::ShaderStages::FRAGMENT, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
];

/// Species and pictures.
pub(super) fn common(gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
    let device = &gpu.device;
    let mut kinds = [SpeciesEntry::default(); MOST_SPECIES];
    for (entry, species) in kinds.iter_mut().zip(SPECIES) {
        let [r, g, b] = species.colour;
        let shape = species.shape as usize;
        *entry = SpeciesEntry {
            height_m: species.height_m,
            width: species.width,
            shape: shape as f32,
            colour: [r, g, b, WIDTHS[shape]],
        };
    }
    let kinds = filled(gpu, "species", bytemuck::cast_slice(&kinds), wgpu::BufferUsages::UNIFORM);
    let [width, height] = pictures::SIZE.map(|side| side as u32);
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("plants pictures"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: pictures::COUNT as u32 },
        mip_level_count: pictures::MIPS as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (layer, mips) in (0..).zip(pictures::all()) {
        for (level, texels) in (0..).zip(mips) {
            mip(&gpu.queue, &texture, level, layer, [width >> level, height >> level], texels);
        }
    }
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..wgpu::TextureViewDescriptor::default()
    });
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("plants pictures"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Nearest,
        ..wgpu::SamplerDescriptor::default()
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("plants"),
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: kinds.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    })
}

/// Bytes on the GPU of species and pictures.
pub(super) fn common_bytes() -> usize {
    pictures::all().iter().flatten().map(Vec::len).sum::<usize>() + MOST_SPECIES * size_of::<SpeciesEntry>()
}

/// Indices and first vertex of a shape's model.
pub(super) type Place = (Range<u32>, i32);

/// Corners and indices of all models, and where each is.
pub(super) fn models() -> (Vec<ModelVertex>, Vec<u16>, Vec<Place>) {
    let (mut vertices, mut indices, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for shape in detail::ALL {
        let model = detail::model(shape);
        places.push((indices.len() as u32..(indices.len() + model.indices.len()) as u32, vertices.len() as i32));
        indices.extend(&model.indices);
        let signed = |value: f32| (value.clamp(-1.0, 1.0) * 127.0).round() as i8;
        let share = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        vertices.extend(model.vertices.iter().map(|v| ModelVertex {
            position: v.position.to_array(),
            normal_open: [signed(v.normal.x), signed(v.normal.y), signed(v.normal.z), signed(v.open)],
            uv_leaf: [share(v.uv.x), share(v.uv.y), v.leaf, 0],
        }));
    }
    (vertices, indices, places)
}
