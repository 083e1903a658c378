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
use super::bindings::layout;
use super::plants_kinds::{self, COMMON, MODEL_ATTRIBUTES, ModelVertex, Place, common, models};
use super::plants_seen::{self, MESH_M, Near, Reaches, Seen, Stand};
use super::upload::{Growing, empty, filled};
use crate::camera::View;
use crate::gpu::Gpu;
use crate::shaders;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use terrain::edit::Changed;
use terrain::near::{Change, NearTiles, Settings, TileIndex};
use vegetation::place::{Nursery, Planted, TIERS, Tier};
use vegetation::species::SHAPES;

/// Bytes handed to the GPU a frame and tier.
const BUDGET_BYTES: usize = 200 << 10;
/// Meshes in a view at most.
const MOST_MESHES: usize = 6_000;

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
    reaches: Reaches,
    tiles: NearTiles<Planted>,
    shown: BTreeMap<TileIndex, Arc<Planted>>,
}

/// Plants a tile of a tier.
fn maker(nursery: Arc<Nursery>, tier: Tier, share: f32) -> impl Fn(TileIndex) -> Planted + Send + 'static {
    move |tile| nursery.plants(&tier, tile, share)
}

struct ViewDraws {
    /// Cards, then triangles.
    stands: Growing,
    /// With them.
    group: Option<wgpu::BindGroup>,
    cards: Range<u32>,
    far: Range<u32>,
    near: Growing,
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
    /// What the view last prepared sees; kept for its memory.
    seen: Seen,
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
            TierTiles { tier, reaches: Reaches::of(&tier), tiles, shown: BTreeMap::new() }
        });
        let (vertices, indices, models) = models();
        let quads: Vec<u16> = (0..CARDS_A_DRAW as u16).flat_map(|p| [0, 1, 2, 2, 1, 3].map(|i| 4 * p + i)).collect();
        let common_layout = layout(device, "plants", &COMMON);
        let stands_layout = layout(device, "plants in sight", &STANDS);
        let nothing = empty(device, "no plants", size_of::<Stand>() as u64, wgpu::BufferUsages::STORAGE);
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
            seen: Seen::default(),
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
            for (tile, planted) in &tier.shown {
                if tier.tiles.distance_m(eye, *tile) <= tier.tier.reach_m {
                    let origin_m = tier.tiles.corner_m(*tile) - eye;
                    plants_seen::parts(
                        &tier.tier,
                        &tier.reaches,
                        planted,
                        origin_m,
                        view.eye_m.y,
                        &frustum,
                        &mut parts,
                    );
                }
            }
        }
        self.seen.look(parts, view, &frustum);
        if self.views.len() <= view_index {
            self.views.resize_with(view_index + 1, ViewDraws::default);
        }
        let prepared = &mut self.views[view_index];
        prepared.upload(gpu, &self.stands_layout, &self.seen);
        prepared.gather(gpu, &mut self.seen.near, &self.models);
        prepared.counts.drawn = self.seen.plants;
    }

    /// Draws a prepared view's plants; groups 0 and 1 (the ground's, given here) are bound.
    pub fn draw(&self, view_index: usize, terrain: &wgpu::BindGroup, pass: &mut wgpu::RenderPass<'_>) {
        let Some(view) = self.views.get(view_index) else { return };
        if view.counts.draw_calls == 0 {
            return;
        }
        pass.set_bind_group(1, terrain, &[]);
        pass.set_bind_group(2, &self.common, &[]);
        pass.set_bind_group(3, view.group.as_ref().unwrap_or(&self.no_stands), &[]);
        if let Some(near) = view.near.buffer().filter(|_| view.counts.meshes > 0) {
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

    /// Bytes on the GPU.
    pub fn gpu_bytes(&self) -> usize {
        let shared = self.quads.size() + self.model_vertices.size() + self.model_indices.size();
        let views = self.views.iter().map(|view| view.stands.bytes() + view.near.bytes());
        views.sum::<usize>() + shared as usize + plants_kinds::common_bytes()
    }

    /// What the first view's plants were made of.
    pub fn counts(&self) -> PlantCounts {
        self.views.first().map_or_else(PlantCounts::default, |view| view.counts)
    }

    /// Longest that a tile's plants took to place, milliseconds of the thread's own time.
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

impl Default for ViewDraws {
    fn default() -> Self {
        Self {
            stands: Growing::new("plants in sight", wgpu::BufferUsages::STORAGE),
            group: None,
            cards: 0..0,
            far: 0..0,
            near: Growing::new("plants near", wgpu::BufferUsages::VERTEX),
            meshes: std::array::from_fn(|_| 0..0),
            counts: PlantCounts::default(),
        }
    }
}

impl ViewDraws {
    /// Uploads cards and triangles.
    fn upload(&mut self, gpu: &Gpu, layout: &wgpu::BindGroupLayout, seen: &Seen) {
        let cards = &seen.cards[..seen.cards.len().min(MOST_STANDS)];
        let far = &seen.far[..seen.far.len().min(MOST_STANDS - cards.len())];
        self.cards = 0..cards.len() as u32;
        self.far = self.cards.end..self.cards.end + far.len() as u32;
        let [cards, far]: [&[u8]; 2] = [bytemuck::cast_slice(cards), bytemuck::cast_slice(far)];
        if self.stands.write(&gpu.device, &gpu.queue, &[cards, far]) {
            self.group = self.stands.buffer().map(|stands| stands_group(&gpu.device, layout, stands));
        }
    }

    /// Uploads the meshes and counts.
    fn gather(&mut self, gpu: &Gpu, near: &mut [Vec<Near>; SHAPES], models: &[Place]) {
        let mut all: Vec<Near> = Vec::new();
        let draw_calls = self.cards.len().div_ceil(CARDS_A_DRAW) + usize::from(!self.far.is_empty());
        self.counts = PlantCounts { draw_calls, ..PlantCounts::default() };
        for ((meshes, near), (indices, _)) in self.meshes.iter_mut().zip(near).zip(models) {
            let first = all.len() as u32;
            // Nearest first: what is behind is not shaded.
            near.sort_by(|a, b| a.distance_squared().total_cmp(&b.distance_squared()));
            all.extend(near.iter().take(MOST_MESHES - all.len()));
            *meshes = first..all.len() as u32;
            self.counts.draw_calls += usize::from(meshes.start < meshes.end);
            self.counts.triangles += meshes.len() * indices.len() / 3;
        }
        self.counts.meshes = all.len();
        self.counts.triangles += 2 * self.cards.len() + self.far.len();
        self.near.write(&gpu.device, &gpu.queue, &[bytemuck::cast_slice(&all)]);
    }
}

const STANDS: [(wgpu::ShaderStages, wgpu::BindingType); 1] = [(
    wgpu::ShaderStages::VERTEX,
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: false,
        min_binding_size: None,
    },
)];

fn stands_group(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, stands: &wgpu::Buffer) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("plants in sight"),
        layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: stands.as_entire_binding() }],
    })
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
