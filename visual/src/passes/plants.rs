//! Draws single plants: meshes near the eye, cards that face it farther away, triangles far away.
//! Shader: `shaders/plants.wgsl`.
//!
//! Each of the three tiers of [`vegetation::place`] streams its tiles by a thread of its own. A tile's plants are one storage buffer,
//! written once; a card is four vertices that read it. [`Plants::prepare`] picks the parts of tiles that a view sees and gathers the
//! few plants near the eye that are drawn as meshes. A plant changes from mesh to card by dissolving over the last part of the
//! meshes' reach, and leaves at the end of its own reach by shrinking, so nothing appears at once.
//!
//! Invariant: a tile's origin is subtracted from the eye in f64; what a world does not have makes no [`Plants`].

use super::TargetFormat;
use crate::camera::{Frustum, View};
use crate::gpu::Gpu;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Vec3};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use terrain::near::{Change, NearTiles, Settings, TileIndex};
use vegetation::detail::{self, WIDTHS};
use vegetation::pictures;
use vegetation::place::{Nursery, PARTS, Planted, SQUARES, TIERS, Tier};
use vegetation::species::{SHAPES, SPECIES};

/// Up to where tall plants are meshes, metres; low ones change sooner.
pub const MESH_M: f64 = 200.0;
/// From where plants are single triangles, metres.
pub const FAR_M: f64 = 1_400.0;
/// From where conifers are, which look like one early; as the shader's `card_reach`.
const CONIFER_FAR_M: f64 = 0.6 * FAR_M;
/// Each plant changes somewhere between this share of that and all of it.
const FAR_SPREAD: f64 = 0.8;
/// A plant so tall is a mesh up to [`MESH_M`].
const TALL_M: f32 = 20.0;
/// Most that a plant may stand above its foot, metres.
const MOST_TALL_M: f32 = 45.0;
/// Bytes handed to the GPU a frame and tier.
const BUDGET_BYTES: usize = 200 << 10;
/// Tiles that may be drawn in a frame, and how far apart their entries lie in the table.
const MOST_TILES: usize = 512;
const ENTRY: u64 = 256;
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

/// Mirror of the shader's `Tile`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct TileEntry {
    /// East and south of the eye, metres.
    pub origin_m: [f32; 2],
    /// A part of the side, metres.
    pub part_m: f32,
    /// Where the last of the plants is gone, metres.
    pub reach_m: f32,
    /// Share of reach up to which all stand.
    pub full: f32,
    /// Nearer plants are meshes, metres.
    pub mesh_m: f32,
    /// Farther ones are triangles, metres.
    pub far_m: f32,
    /// Unused.
    pub pad: f32,
}

/// A plant drawn as a mesh.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Near {
    foot_m: [f32; 3],
    looks: u32,
}

impl Near {
    fn distance_squared(&self) -> f32 {
        Vec3::from_array(self.foot_m).length_squared()
    }
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
    /// Plants that stand in sight, by their feet: as many are drawn.
    pub drawn: usize,
    /// Of them as meshes.
    pub meshes: usize,
    /// Triangles sent for them.
    pub triangles: usize,
    /// Draw calls.
    pub draw_calls: usize,
}

/// What a tile brings to the render thread.
struct Grown {
    planted: Planted,
    words: Vec<[u32; 3]>,
}

struct Shown {
    grown: Arc<Grown>,
    group: wgpu::BindGroup,
}

struct TierTiles {
    tier: Tier,
    tiles: NearTiles<Grown>,
    shown: HashMap<TileIndex, Shown>,
}

/// Something to draw: a tile's group, its entry, and plants.
struct Draw {
    distance_m: f32,
    far: bool,
    group: wgpu::BindGroup,
    entry: u32,
    plants: Range<u32>,
}

#[derive(Default)]
struct ViewDraws {
    draws: Vec<Draw>,
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
    tile_layout: wgpu::BindGroupLayout,
    table: wgpu::Buffer,
    /// For meshes, which have no tile.
    no_tile: wgpu::BindGroup,
    quads: wgpu::Buffer,
    model_vertices: wgpu::Buffer,
    model_indices: wgpu::Buffer,
    /// Indices and first vertex of each shape.
    models: Vec<Place>,
    views: Vec<ViewDraws>,
    placed_ms_max: f64,
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
            let nursery = nursery.clone();
            let settings = Settings { side_m: tier.side_m, reach_m: tier.reach_m, budget_bytes: BUDGET_BYTES, wait };
            let tiles = NearTiles::new(&grid, settings, bytes, move |tile| grow(&nursery, &tier, tile, share));
            TierTiles { tier, tiles, shown: HashMap::new() }
        });
        let (vertices, indices, models) = models();
        let quads: Vec<u16> = (0..MOST_PLANTS as u16).flat_map(|p| [0, 1, 2, 2, 1, 3].map(|i| 4 * p + i)).collect();
        let common_layout = layout(device, "plants", &COMMON);
        let tile_layout = layout(device, "plants tile", &TILE);
        let table = buffer(device, "plants tiles", MOST_TILES as u64 * ENTRY, wgpu::BufferUsages::UNIFORM);
        let nothing = buffer(device, "no plants", 12, wgpu::BufferUsages::STORAGE);
        Some(Self {
            no_tile: tile_group(device, &tile_layout, &table, &nothing),
            pipelines: pipelines(device, &[frame, terrain, &common_layout, &tile_layout], format),
            common: common(gpu, &common_layout),
            tiers: tiers.into(),
            tile_layout,
            table,
            quads: filled(gpu, "plants cards", bytemuck::cast_slice(&quads), wgpu::BufferUsages::INDEX),
            model_vertices: filled(gpu, "plants models", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            model_indices: filled(gpu, "plants models", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            models,
            views: Vec::new(),
            placed_ms_max: 0.0,
        })
    }

    /// Lets the tiles follow the eye.
    pub fn follow(&mut self, gpu: &Gpu, eye_m: DVec3, speed_mps: f64) {
        for tier in &mut self.tiers {
            for change in tier.tiles.update(DVec2::new(eye_m.x, eye_m.z), speed_mps) {
                match change {
                    Change::Arrived(tile, grown) => {
                        self.placed_ms_max = self.placed_ms_max.max(grown.planted.took_ms);
                        if grown.words.is_empty() {
                            continue;
                        }
                        let words = bytemuck::cast_slice(&grown.words);
                        let plants = filled(gpu, "plants", words, wgpu::BufferUsages::STORAGE);
                        let group = tile_group(&gpu.device, &self.tile_layout, &self.table, &plants);
                        tier.shown.insert(tile, Shown { grown, group });
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
        let mut draws = Vec::new();
        let mut near: [Vec<Near>; SHAPES] = Default::default();
        let mut table = vec![0u8; 0];
        for tier in &self.tiers {
            let mut tiles: Vec<(&TileIndex, &Shown)> = tier.shown.iter().collect();
            tiles.sort_by_key(|(tile, _)| **tile);
            for (tile, shown) in tiles {
                let entry = table.len() / ENTRY as usize;
                let corner = tier.tiles.corner_m(*tile);
                let origin_m = DVec2::new(corner.x - view.eye_m.x, corner.y - view.eye_m.z);
                if tier.tiles.distance_m(DVec2::new(view.eye_m.x, view.eye_m.z), *tile) > tier.tier.reach_m
                    || entry >= MOST_TILES
                {
                    continue;
                }
                // Views of one eye see the same tiles, each a part of them: every tile has its entry in each view.
                let bytes = TileEntry {
                    origin_m: origin_m.as_vec2().to_array(),
                    part_m: (tier.tier.side_m / PARTS) as f32,
                    reach_m: tier.tier.reach_m as f32,
                    full: tier.tier.full,
                    mesh_m: MESH_M as f32,
                    far_m: FAR_M as f32,
                    pad: 0.0,
                };
                table.extend_from_slice(bytemuck::bytes_of(&bytes));
                table.resize((entry + 1) * ENTRY as usize, 0);
                pick(&tier.tier, shown, origin_m, view.eye_m.y, &frustum, entry as u32, &mut draws, &mut near);
            }
        }
        if table.is_empty() {
            // Meshes need the reach of meshes, and there are none.
            table.resize(ENTRY as usize, 0);
        }
        gpu.queue.write_buffer(&self.table, 0, &table);
        draws.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
        if self.views.len() <= view_index {
            self.views.resize_with(view_index + 1, ViewDraws::default);
        }
        let prepared = &mut self.views[view_index];
        prepared.draws = draws;
        prepared.gather(gpu, &near, &self.models);
    }

    /// Draws a prepared view's plants; groups 0 and 1 (the ground's, given here) are bound.
    pub fn draw(&self, view_index: usize, terrain: &wgpu::BindGroup, pass: &mut wgpu::RenderPass<'_>) {
        let Some(view) = self.views.get(view_index) else { return };
        if view.draws.is_empty() {
            return;
        }
        pass.set_bind_group(1, terrain, &[]);
        pass.set_bind_group(2, &self.common, &[]);
        if let Some(near) = view.near.as_ref().filter(|_| view.counts.meshes > 0) {
            pass.set_pipeline(&self.pipelines.leaf);
            pass.set_bind_group(3, &self.no_tile, &[0]);
            pass.set_vertex_buffer(0, self.model_vertices.slice(..));
            pass.set_vertex_buffer(1, near.slice(..));
            pass.set_index_buffer(self.model_indices.slice(..), wgpu::IndexFormat::Uint16);
            for ((indices, first), meshes) in self.models.iter().zip(&view.meshes) {
                if meshes.start < meshes.end {
                    pass.draw_indexed(indices.clone(), *first, meshes.clone());
                }
            }
        }
        pass.set_index_buffer(self.quads.slice(..), wgpu::IndexFormat::Uint16);
        for far in [false, true] {
            pass.set_pipeline(if far { &self.pipelines.far } else { &self.pipelines.card });
            for draw in view.draws.iter().filter(|draw| draw.far == far) {
                pass.set_bind_group(3, &draw.group, &[draw.entry * ENTRY as u32]);
                let Range { start, end } = draw.plants;
                if far {
                    pass.draw(3 * start..3 * end, 0..1);
                } else {
                    pass.draw_indexed(6 * start..6 * end, 0, 0..1);
                }
            }
        }
    }

    /// What the first view's plants were made of; looks at every plant.
    pub fn counts(&self, view: &View) -> PlantCounts {
        let mut counts = self.views.first().map_or_else(PlantCounts::default, |view| view.counts);
        let frustum = view.frustum();
        for tier in &self.tiers {
            for (tile, shown) in &tier.shown {
                let corner = tier.tiles.corner_m(*tile);
                counts.drawn += shown
                    .grown
                    .planted
                    .plants
                    .iter()
                    .filter(|plant| {
                        let plan = plant.plan_m(&tier.tier, corner);
                        let foot = DVec3::new(plan.x, f64::from(plant.height_m), plan.y) - view.eye_m;
                        let top = foot + DVec3::Y * f64::from(plant.tall_m());
                        foot.length() < f64::from(plant.reach_m(&tier.tier))
                            && frustum.may_see_box(foot.as_vec3(), top.as_vec3())
                    })
                    .count();
            }
        }
        counts
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

/// Most plants of a tile: those of the middle tier.
const MOST_PLANTS: usize = 10_000;

fn grow(nursery: &Nursery, tier: &Tier, tile: TileIndex, share: f32) -> Grown {
    let planted = nursery.plants(tier, tile, share);
    let words = planted.plants.iter().map(|plant| {
        let looks = u32::from_le_bytes([plant.species, plant.size, plant.turn, plant.tint]);
        [u32::from(plant.at[0]) | u32::from(plant.at[1]) << 16, plant.height_m.to_bits(), looks]
    });
    let words = words.collect();
    Grown { planted, words }
}

fn bytes(grown: &Grown) -> usize {
    size_of_val(grown.words.as_slice())
}

/// Up to where a plant of a height is a mesh; the shader's `mesh_reach`.
fn mesh_reach_m(tall_m: f32) -> f32 {
    MESH_M as f32 * (tall_m / TALL_M).clamp(0.2, 1.0)
}

/// The parts of a tile that a view sees, and its plants near the eye.
fn pick(
    tier: &Tier,
    shown: &Shown,
    origin_m: DVec2,
    eye_height_m: f64,
    frustum: &Frustum,
    entry: u32,
    draws: &mut Vec<Draw>,
    near: &mut [Vec<Near>; SHAPES],
) {
    let planted = &shown.grown.planted;
    let side_m = tier.side_m / f64::from(SQUARES);
    let mut start = 0;
    for (number, square) in (0..).zip(&planted.squares) {
        let plants = start..square.end;
        start = square.end;
        if plants.is_empty() {
            continue;
        }
        let [least_m, most_m] = square.feet_m;
        let west = origin_m.x + f64::from(number % SQUARES) * side_m;
        let north = origin_m.y + f64::from(number / SQUARES) * side_m;
        let low = DVec3::new(west, f64::from(least_m) - eye_height_m, north).as_vec3();
        let high = DVec3::new(west + side_m, f64::from(most_m + MOST_TALL_M) - eye_height_m, north + side_m).as_vec3();
        let margin = Vec3::new(15.0, 1.0, 15.0);
        if !frustum.may_see_box(low - margin, high + margin) {
            continue;
        }
        let nearest_m = Vec3::ZERO.clamp(low, high).length();
        let farthest_m = low.abs().max(high.abs()).length();
        if f64::from(nearest_m) > tier.reach_m {
            continue;
        }
        let conifers = plants.start..square.conifers_end;
        for (kind, far_m) in [(conifers, CONIFER_FAR_M), (square.conifers_end..square.end, FAR_M)] {
            // What is gone by now stands at the list's end.
            let standing = &planted.plants[kind.start as usize..kind.end as usize];
            let count = standing.partition_point(|plant| plant.reach_m(tier) >= nearest_m) as u32;
            for far in [false, true] {
                let wanted =
                    if far { f64::from(farthest_m) > far_m * FAR_SPREAD } else { f64::from(nearest_m) < far_m };
                if count > 0 && wanted {
                    let plants = kind.start..kind.start + count;
                    draws.push(Draw { distance_m: nearest_m, far, group: shown.group.clone(), entry, plants });
                }
            }
        }
        if f64::from(nearest_m) >= MESH_M {
            continue;
        }
        for plant in &planted.plants[plants.start as usize..plants.end as usize] {
            let plan_m = plant.plan_m(tier, origin_m);
            let foot_m = DVec3::new(plan_m.x, f64::from(plant.height_m) - eye_height_m, plan_m.y).as_vec3();
            let tall_m = plant.tall_m();
            let around = Vec3::new(0.5, 0.0, 0.5) * tall_m.max(3.0);
            if foot_m.length() < mesh_reach_m(tall_m)
                && frustum.may_see_box(foot_m - around, foot_m + around + Vec3::Y * tall_m)
            {
                let shape = SPECIES[usize::from(plant.species) % SPECIES.len()].shape as usize;
                let looks = u32::from_le_bytes([plant.species, plant.size, plant.turn, plant.tint]);
                near[shape].push(Near { foot_m: foot_m.to_array(), looks });
            }
        }
    }
}

impl ViewDraws {
    /// Uploads the meshes and counts.
    fn gather(&mut self, gpu: &Gpu, near: &[Vec<Near>; SHAPES], models: &[Place]) {
        let mut all: Vec<Near> = Vec::new();
        self.counts = PlantCounts { draw_calls: self.draws.len(), ..PlantCounts::default() };
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
        self.counts.triangles += self.draws.iter().map(|d| d.plants.len() * if d.far { 1 } else { 2 }).sum::<usize>();
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

const TILE: [(wgpu::ShaderStages, wgpu::BindingType); 2] = [
    (wgpu::ShaderStages::VERTEX, uniform(true)),
    (
        wgpu::ShaderStages::VERTEX,
        wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
    ),
];

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

fn tile_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    table: &wgpu::Buffer,
    plants: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let entry = wgpu::BufferBinding {
        buffer: table,
        offset: 0,
        size: std::num::NonZeroU64::new(size_of::<TileEntry>() as u64),
    };
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("plants tile"),
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(entry) },
            wgpu::BindGroupEntry { binding: 1, resource: plants.as_entire_binding() },
        ],
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
    let constants = [("TILE", f64::from(terrain::block::mesh::TILE))];
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
