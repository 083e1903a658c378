//! Draws single plants: meshes near the eye, cards that face it farther away, triangles far away.
//! Shader: `shaders/plants.wgsl`.
//!
//! Each of the three tiers of [`vegetation::place`] streams its tiles by a thread of its own. [`Plants::prepare`] sorts out
//! which plants a view sees and as what ([`super::plants_seen`]) and sends those as one list; a card is four vertices that read
//! it. A plant changes from mesh to card by dissolving over the last part of the meshes' reach, and leaves at the end of its own
//! reach by shrinking, so nothing appears at once.
//!
//! Invariant: a tile's origin is subtracted from the eye in f64; what a world does not have makes no [`Plants`].

use super::TargetFormat;
use super::plants_seen::{self, MESH_M, Near, Seen, Stand};
use crate::camera::View;
use crate::gpu::Gpu;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use terrain::edit::Changed;
use terrain::near::{Change, NearTiles, Settings, TileIndex};
use vegetation::detail::{self, WIDTHS};
use vegetation::pictures;
use vegetation::place::{Nursery, Planted, TIERS, Tier};
use vegetation::species::{SHAPES, SPECIES};

/// Bytes handed to the GPU a frame and tier.
const BUDGET_BYTES: usize = 200 << 10;
/// Meshes in a view at most.
const MOST_MESHES: usize = 6_000;

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
struct ModelVertex {
    position: [f32; 3],
    normal_open: [i8; 4],
    uv_leaf: [u8; 4],
}

const MODEL_ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm8x4, 2 => Unorm8x4];
const NEAR_ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![3 => Float32x3, 4 => Uint32];

/// What a view's plants are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlantCounts {
    /// Plants that are sent to be drawn: in sight, within reach and not too small.
    pub drawn: usize,
    /// Of them as meshes.
    pub meshes: usize,
    /// Triangles sent for them.
    pub triangles: usize,
    /// Draw calls.
    pub draw_calls: usize,
}

struct TierTiles {
    tier: Tier,
    tiles: NearTiles<Planted>,
    shown: HashMap<TileIndex, Arc<Planted>>,
}

/// Plants a tile of a tier.
fn maker(nursery: Arc<Nursery>, tier: Tier, share: f32) -> impl Fn(TileIndex) -> Planted + Send + 'static {
    move |tile| nursery.plants(&tier, tile, share)
}

#[derive(Default)]
struct ViewDraws {
    /// Cards, then triangles, and a group with them.
    stands: Option<(wgpu::Buffer, wgpu::BindGroup)>,
    cards: Range<u32>,
    far: Range<u32>,
    near: Option<wgpu::Buffer>,
    /// Instances of each shape.
    meshes: [Range<u32>; SHAPES],
    counts: PlantCounts,
}

/// See the module.
pub struct Plants {
    tiers: Vec<TierTiles>,
    pipelines: Pipelines,
    common: wgpu::BindGroup,
    stands_layout: wgpu::BindGroupLayout,
    /// For meshes, which read no list.
    no_stands: wgpu::BindGroup,
    quads: wgpu::Buffer,
    model_vertices: wgpu::Buffer,
    model_indices: wgpu::Buffer,
    /// Indices and first vertex of each shape.
    models: Vec<Place>,
    views: Vec<ViewDraws>,
    placed_ms_max: f64,
    share: f32,
}

struct Pipelines {
    card: wgpu::RenderPipeline,
    far: wgpu::RenderPipeline,
    leaf: wgpu::RenderPipeline,
}

impl Plants {
    /// The plants of a nursery, `share` (0..=1) of them; `None` where none can grow. `terrain`: layout of
    /// group 1; `near_m`: the near zone's radius.
    pub fn new(
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        terrain: &wgpu::BindGroupLayout,
        format: TargetFormat,
        nursery: &Arc<Nursery>,
        share: f32,
        near_m: f64,
        wait: bool,
    ) -> Option<Self> {
        if nursery.is_bare() || share.is_nan() || share <= 0.0 {
            return None;
        }
        let device = &gpu.device;
        let grid = *nursery.area().grid();
        let tiers = TIERS.map(|tier| {
            // Beyond the near zone the picture's ground is not the one that plants stand on.
            let tier = Tier { reach_m: tier.reach_m.min(near_m.max(500.0)), ..tier };
            let settings = Settings { side_m: tier.side_m, reach_m: tier.reach_m, budget_bytes: BUDGET_BYTES, wait };
            let tiles = NearTiles::new(&grid, settings, bytes, maker(nursery.clone(), tier, share));
            TierTiles { tier, tiles, shown: HashMap::new() }
        });
        let (vertices, indices, models) = models();
        let quads: Vec<u16> = (0..CARDS_A_DRAW as u16).flat_map(|p| [0, 1, 2, 2, 1, 3].map(|i| 4 * p + i)).collect();
        let common_layout = layout(device, "plants", &COMMON);
        let stands_layout = layout(device, "plants in sight", &STANDS);
        let nothing = buffer(device, "no plants", size_of::<Stand>() as u64, wgpu::BufferUsages::STORAGE);
        Some(Self {
            no_stands: stands_group(device, &stands_layout, &nothing),
            pipelines: pipelines(device, &[frame, terrain, &common_layout, &stands_layout], format),
            common: common(gpu, &common_layout),
            tiers: tiers.into(),
            stands_layout,
            quads: filled(gpu, "plants cards", bytemuck::cast_slice(&quads), wgpu::BufferUsages::INDEX),
            model_vertices: filled(gpu, "plants models", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            model_indices: filled(gpu, "plants models", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            models,
            views: Vec::new(),
            placed_ms_max: 0.0,
            share,
        })
    }

    /// Takes over a nursery on a new version of the ground.
    pub fn set_nursery(&mut self, nursery: &Arc<Nursery>, changed: &Changed) {
        for TierTiles { tier, tiles, .. } in &mut self.tiers {
            tiles.remake_where(changed, maker(nursery.clone(), *tier, self.share));
        }
    }

    /// Lets the tiles follow the eye.
    pub fn follow(&mut self, eye_m: DVec3, speed_mps: f64) {
        for tier in &mut self.tiers {
            for change in tier.tiles.update(DVec2::new(eye_m.x, eye_m.z), speed_mps) {
                match change {
                    Change::Arrived(tile, planted) => {
                        self.placed_ms_max = self.placed_ms_max.max(planted.took_ms);
                        if planted.plants.is_empty() {
                            tier.shown.remove(&tile);
                        } else {
                            tier.shown.insert(tile, planted);
                        }
                    }
                    Change::Left(tile) => {
                        tier.shown.remove(&tile);
                    }
                }
            }
        }
    }

    /// Culls for a view. All views of a frame share one eye.
    pub fn prepare(&mut self, gpu: &Gpu, view_index: usize, view: &View) {
        let frustum = view.frustum();
        let eye = DVec2::new(view.eye_m.x, view.eye_m.z);
        let mut parts = Vec::new();
        for tier in &self.tiers {
            let mut tiles: Vec<(&TileIndex, &Arc<Planted>)> = tier.shown.iter().collect();
            tiles.sort_by_key(|(tile, _)| **tile);
            for (tile, planted) in tiles {
                if tier.tiles.distance_m(eye, *tile) <= tier.tier.reach_m {
                    let origin_m = tier.tiles.corner_m(*tile) - eye;
                    plants_seen::parts(&tier.tier, planted, origin_m, view.eye_m.y, &frustum, &mut parts);
                }
            }
        }
        let seen = Seen::of(parts, view, &frustum);
        if self.views.len() <= view_index {
            self.views.resize_with(view_index + 1, ViewDraws::default);
        }
        let prepared = &mut self.views[view_index];
        prepared.upload(gpu, &self.stands_layout, &seen);
        prepared.gather(gpu, &seen.near, &self.models);
        prepared.counts.drawn = seen.plants;
    }

    /// Draws a prepared view's plants; groups 0 and 1 (the ground's, given here) are bound.
    pub fn draw(&self, view_index: usize, terrain: &wgpu::BindGroup, pass: &mut wgpu::RenderPass<'_>) {
        let Some(view) = self.views.get(view_index) else { return };
        if view.counts.draw_calls == 0 {
            return;
        }
        pass.set_bind_group(1, terrain, &[]);
        pass.set_bind_group(2, &self.common, &[]);
        pass.set_bind_group(3, view.stands.as_ref().map_or(&self.no_stands, |(_, group)| group), &[]);
        if let Some(near) = view.near.as_ref().filter(|_| view.counts.meshes > 0) {
            pass.set_pipeline(&self.pipelines.leaf);
            pass.set_vertex_buffer(0, self.model_vertices.slice(..));
            pass.set_vertex_buffer(1, near.slice(..));
            pass.set_index_buffer(self.model_indices.slice(..), wgpu::IndexFormat::Uint16);
            for ((indices, first), meshes) in self.models.iter().zip(&view.meshes) {
                if meshes.start < meshes.end {
                    pass.draw_indexed(indices.clone(), *first, meshes.clone());
                }
            }
        }
        if !view.cards.is_empty() {
            pass.set_pipeline(&self.pipelines.card);
            pass.set_index_buffer(self.quads.slice(..), wgpu::IndexFormat::Uint16);
            for first in view.cards.clone().step_by(CARDS_A_DRAW) {
                let count = (view.cards.end - first).min(CARDS_A_DRAW as u32);
                pass.draw_indexed(0..6 * count, 4 * first as i32, 0..1);
            }
        }
        if !view.far.is_empty() {
            pass.set_pipeline(&self.pipelines.far);
            pass.draw(3 * view.far.start..3 * view.far.end, 0..1);
        }
    }

    /// What the first view's plants were made of.
    pub fn counts(&self) -> PlantCounts {
        self.views.first().map_or_else(PlantCounts::default, |view| view.counts)
    }

    /// Longest that a tile's plants took to place, milliseconds.
    pub fn placed_ms_max(&self) -> f64 {
        self.placed_ms_max
    }

    /// Tiles within reach that were not there after the last update.
    pub fn late(&self) -> usize {
        self.tiers.iter().map(|tier| tier.tiles.late()).sum()
    }
}

/// Cards of a draw call: four corners of each have 16-bit numbers.
const CARDS_A_DRAW: usize = 16_000;
/// Cards and triangles in a view at most.
const MOST_STANDS: usize = 1_000_000;

fn bytes(planted: &Planted) -> usize {
    size_of_val(planted.plants.as_slice())
}

impl ViewDraws {
    /// Uploads cards and triangles.
    fn upload(&mut self, gpu: &Gpu, layout: &wgpu::BindGroupLayout, seen: &Seen) {
        let cards = &seen.cards[..seen.cards.len().min(MOST_STANDS)];
        let far = &seen.far[..seen.far.len().min(MOST_STANDS - cards.len())];
        self.cards = 0..cards.len() as u32;
        self.far = self.cards.end..self.cards.end + far.len() as u32;
        let [cards, far]: [&[u8]; 2] = [bytemuck::cast_slice(cards), bytemuck::cast_slice(far)];
        let size = (cards.len() + far.len()) as u64;
        if size == 0 {
            return;
        }
        if self.stands.as_ref().is_none_or(|(buffer, _)| buffer.size() < size) {
            let buffer = buffer(&gpu.device, "plants in sight", size.next_power_of_two(), wgpu::BufferUsages::STORAGE);
            let group = stands_group(&gpu.device, layout, &buffer);
            self.stands = Some((buffer, group));
        }
        if let Some((buffer, _)) = &self.stands {
            gpu.queue.write_buffer(buffer, 0, cards);
            gpu.queue.write_buffer(buffer, cards.len() as u64, far);
        }
    }

    /// Uploads the meshes and counts.
    fn gather(&mut self, gpu: &Gpu, near: &[Vec<Near>; SHAPES], models: &[Place]) {
        let mut all: Vec<Near> = Vec::new();
        let draw_calls = self.cards.len().div_ceil(CARDS_A_DRAW) + usize::from(!self.far.is_empty());
        self.counts = PlantCounts { draw_calls, ..PlantCounts::default() };
        for ((meshes, near), (indices, _)) in self.meshes.iter_mut().zip(near).zip(models) {
            let first = all.len() as u32;
            // Nearest first: what is behind is not shaded.
            let mut near = near.clone();
            near.sort_by(|a, b| a.distance_squared().total_cmp(&b.distance_squared()));
            all.extend(near.iter().take(MOST_MESHES - all.len()));
            *meshes = first..all.len() as u32;
            self.counts.draw_calls += usize::from(meshes.start < meshes.end);
            self.counts.triangles += meshes.len() * indices.len() / 3;
        }
        self.counts.meshes = all.len();
        self.counts.triangles += 2 * self.cards.len() + self.far.len();
        if all.is_empty() {
            return;
        }
        let bytes: &[u8] = bytemuck::cast_slice(&all);
        if self.near.as_ref().is_none_or(|buffer| buffer.size() < bytes.len() as u64) {
            let size = bytes.len().next_power_of_two() as u64;
            self.near = Some(buffer(&gpu.device, "plants near", size, wgpu::BufferUsages::VERTEX));
        }
        if let Some(near) = &self.near {
            gpu.queue.write_buffer(near, 0, bytes);
        }
    }
}

fn buffer(device: &wgpu::Device, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A buffer with content; a multiple of four bytes long.
pub(super) fn filled(gpu: &Gpu, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let made = buffer(&gpu.device, label, (bytes.len() as u64).next_multiple_of(4).max(4), usage);
    let whole = bytes.len() / 4 * 4;
    gpu.queue.write_buffer(&made, 0, &bytes[..whole]);
    if whole < bytes.len() {
        let mut rest = [0; 4];
        rest[..bytes.len() - whole].copy_from_slice(&bytes[whole..]);
        gpu.queue.write_buffer(&made, whole as u64, &rest);
    }
    made
}

const COMMON: [(wgpu::ShaderStages, wgpu::BindingType); 3] = [
    (wgpu::ShaderStages::VERTEX, uniform(false)),
    (
        wgpu::ShaderStages::FRAGMENT,
        wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        },
    ),
    (wgpu::ShaderStages::FRAGMENT, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
];

const STANDS: [(wgpu::ShaderStages, wgpu::BindingType); 1] = [(
    wgpu::ShaderStages::VERTEX,
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: false,
        min_binding_size: None,
    },
)];

/// A uniform buffer's binding.
pub(super) const fn uniform(has_dynamic_offset: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset, min_binding_size: None }
}

/// A layout of bindings numbered as they come.
pub(super) fn layout(
    device: &wgpu::Device,
    label: &str,
    bindings: &[(wgpu::ShaderStages, wgpu::BindingType)],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(bindings)
        .map(|(binding, (visibility, ty))| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: *visibility,
            ty: *ty,
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

fn stands_group(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, stands: &wgpu::Buffer) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("plants in sight"),
        layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: stands.as_entire_binding() }],
    })
}

/// Species and pictures.
fn common(gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
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
        for (level, texels) in (0..).zip(&mips) {
            write(&gpu.queue, &texture, level, layer, [width >> level, height >> level], texels);
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

/// Species that the shader has room for.
pub const MOST_SPECIES: usize = 32;

/// Writes a mip of a layer.
pub(super) fn write(
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    mip_level: u32,
    z: u32,
    [width, height]: [u32; 2],
    texels: &[u8],
) {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level,
            origin: wgpu::Origin3d { x: 0, y: 0, z },
            aspect: wgpu::TextureAspect::All,
        },
        texels,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: Some(height) },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}

/// Indices and first vertex of a shape's model.
type Place = (Range<u32>, i32);

/// Corners and indices of all models, and where each is.
fn models() -> (Vec<ModelVertex>, Vec<u16>, Vec<Place>) {
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

fn pipelines(device: &wgpu::Device, groups: &[&wgpu::BindGroupLayout; 4], format: TargetFormat) -> Pipelines {
    let module = shaders::module(device, "plants.wgsl");
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("plants"),
        bind_group_layouts: &groups.map(Some),
        immediate_size: 0,
    });
    let constants = [("TILE", f64::from(terrain::block::mesh::TILE)), ("MESH_M", MESH_M)];
    let options =
        wgpu::PipelineCompilationOptions { constants: &constants, ..wgpu::PipelineCompilationOptions::default() };
    let make = |vertex, fragment, buffers: &[Option<wgpu::VertexBufferLayout<'_>>]| {
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                compilation_options: options.clone(),
                buffers,
            },
            primitive: wgpu::PrimitiveState {
                cull_mode: if buffers.is_empty() { None } else { Some(wgpu::Face::Back) },
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: format.depth_state(wgpu::CompareFunction::Greater, true),
            multisample: format.multisample(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: options.clone(),
                targets: &[Some(format.colour.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    };
    let buffers = [
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<ModelVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &MODEL_ATTRIBUTES,
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Near>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &NEAR_ATTRIBUTES,
        }),
    ];
    Pipelines {
        card: make("card_vertex", "card_fragment", &[]),
        far: make("far_vertex", "far_fragment", &[]),
        leaf: make("leaf_vertex", "leaf_fragment", &buffers),
    }
}
