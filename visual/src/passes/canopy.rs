//! Draws the closed forest beyond the nearest trees. Shader: `shaders/canopy.wgsl`.
//!
//! A tile of [`vegetation::canopy`] is one vertex and one index buffer, written once, and one draw. It rises out of the ground where the
//! single trees grow sparse and sinks into it at its reach, so it never appears at once.
//!
//! Invariant: a tile's origin is subtracted from the eye in f64; what a world does not have makes no [`CanopyPass`].

use super::TargetFormat;
use super::bindings::{layout, texture, uniform};
use super::upload::{filled, mip};
use crate::camera::View;
use crate::gpu::Gpu;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;
use terrain::edit::Changed;
use terrain::near::{Change, NearTiles, Settings, TileIndex};
use vegetation::canopy::{self, Canopy};
use vegetation::pictures;
use vegetation::place::Nursery;

/// Where the canopy begins to rise, metres from the eye.
const START_M: f32 = 420.0;
/// Where it is gone: the near zone's end.
const REACH_M: f64 = 13_000.0;
/// Side of the crown texture on the ground, metres: crowns of some 6 m.
const CROWN_M: f64 = 120.0;
/// The same of its second scale: no small multiple of the first, so that the two repeat together nowhere in sight.
const TURNED_M: f64 = 197.0;
/// East of the second scale as cosine and sine of its turn, as in the shader's `turned`: 36.87 degrees.
const TURN: DVec2 = DVec2::new(0.8, 0.6);
/// Bytes handed to the GPU a frame.
const BUDGET_BYTES: usize = 200 << 10;
/// Tiles that may be drawn in a frame, and how far apart their entries lie in the table.
const MOST_TILES: usize = 256;
const ENTRY: u64 = 256;

/// Mirror of the shader's `Tile`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CanopyTile {
    /// East and south of the eye, metres.
    pub origin_m: [f32; 2],
    /// Side of a cell, metres.
    pub cell_m: f32,
    /// Where the surface begins to rise, metres.
    pub start_m: f32,
    /// Where it is gone, metres.
    pub reach_m: f32,
    /// Side of the crown texture, metres.
    pub crown_m: f32,
    /// Of the crown texture at the tile's corner.
    pub phase: [f32; 2],
    /// The same of its second scale.
    pub turned_phase: [f32; 2],
    /// Side of the crown texture on the ground at its second scale, metres.
    pub turned_m: f32,
    /// Unused.
    pub pad: f32,
}

/// A corner as the shader takes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Vertex {
    at: [u16; 2],
    ground_m: f32,
    high_m: f32,
    looks: [u8; 4],
}

const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Uint16x2, 1 => Float32, 2 => Float32, 3 => Unorm8x4];

struct Shown {
    canopy: Arc<Canopy>,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
}

/// What a view's canopy is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CanopyCounts {
    /// Stems that the tiles in sight stand for.
    pub stands_for: f64,
    /// Triangles sent.
    pub triangles: usize,
}

/// See the module.
pub struct CanopyPass {
    tiles: NearTiles<Canopy>,
    shown: BTreeMap<TileIndex, Shown>,
    cell_m: f64,
    reach_m: f64,
    pipeline: wgpu::RenderPipeline,
    crowns: wgpu::BindGroup,
    table: wgpu::Buffer,
    entry: wgpu::BindGroup,
    /// For each view the tiles that it sees, nearest first, with their entries.
    draws: Vec<Vec<(TileIndex, u32)>>,
}

impl CanopyPass {
    /// The canopy of a nursery; `None` where there is no forest. `near_m`: the near zone's radius; `terrain`: layout of group 1.
    pub fn new(
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        terrain: &wgpu::BindGroupLayout,
        format: TargetFormat,
        nursery: &Arc<Nursery>,
        near_m: f64,
        wait: bool,
    ) -> Option<Self> {
        if !nursery.has_forest() {
            return None;
        }
        let device = &gpu.device;
        let grid = *nursery.area().grid();
        let reach_m = if near_m.is_finite() { near_m.clamp(1_000.0, REACH_M) } else { REACH_M };
        let settings = Settings { side_m: canopy::side_m(&grid), reach_m, budget_bytes: BUDGET_BYTES, wait };
        let theirs = nursery.clone();
        let tiles = NearTiles::new(&grid, settings, bytes, move |tile| canopy::canopy(&theirs, tile));
        let crown_layout = layout(
            device,
            "crowns",
            &[
                (wgpu::ShaderStages::FRAGMENT, texture(wgpu::TextureViewDimension::D2)),
                (wgpu::ShaderStages::FRAGMENT, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ],
        );
        let tile_layout = layout(device, "canopy tile", &[(wgpu::ShaderStages::VERTEX_FRAGMENT, uniform(true))]);
        let table = filled(gpu, "canopy tiles", &vec![0; MOST_TILES * ENTRY as usize], wgpu::BufferUsages::UNIFORM);
        let entry = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("canopy tile"),
            layout: &tile_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &table,
                    offset: 0,
                    size: std::num::NonZeroU64::new(size_of::<CanopyTile>() as u64),
                }),
            }],
        });
        Some(Self {
            tiles,
            shown: BTreeMap::new(),
            cell_m: canopy::cell_m(&grid),
            reach_m,
            pipeline: pipeline(device, &[frame, terrain, &crown_layout, &tile_layout], format),
            crowns: crowns(gpu, &crown_layout),
            table,
            entry,
            draws: Vec::new(),
        })
    }

    /// Takes over a nursery on a new version of the ground.
    pub fn set_nursery(&mut self, nursery: &Arc<Nursery>, changed: &Changed) {
        let nursery = nursery.clone();
        self.tiles.remake_where(changed, move |tile| canopy::canopy(&nursery, tile));
    }

    /// Lets the tiles follow the eye.
    pub fn follow(&mut self, gpu: &Gpu, eye_m: DVec3, speed_mps: f64) {
        for change in self.tiles.update(DVec2::new(eye_m.x, eye_m.z), speed_mps) {
            match change {
                Change::Arrived(tile, canopy) if !canopy.indices.is_empty() => {
                    let corners: Vec<Vertex> = canopy
                        .corners
                        .iter()
                        .map(|c| Vertex { at: c.at, ground_m: c.ground_m, high_m: c.high_m, looks: c.looks })
                        .collect();
                    let vertices = filled(gpu, "canopy", bytemuck::cast_slice(&corners), wgpu::BufferUsages::VERTEX);
                    let indices =
                        filled(gpu, "canopy", bytemuck::cast_slice(&canopy.indices), wgpu::BufferUsages::INDEX);
                    self.shown.insert(tile, Shown { canopy, vertices, indices });
                }
                Change::Arrived(tile, _) | Change::Left(tile) => {
                    self.shown.remove(&tile);
                }
            }
        }
    }

    /// Culls for a view. All views of a frame share one eye.
    pub fn prepare(&mut self, gpu: &Gpu, view_index: usize, view: &View) {
        let frustum = view.frustum();
        let side_m = self.tiles.settings().side_m;
        let eye = DVec2::new(view.eye_m.x, view.eye_m.z);
        let mut near: Vec<(f64, TileIndex)> =
            self.shown.keys().map(|tile| (self.tiles.distance_m(eye, *tile), *tile)).collect();
        near.retain(|(distance_m, _)| *distance_m <= self.reach_m);
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(MOST_TILES);
        let mut table = Vec::with_capacity(near.len() * ENTRY as usize);
        let mut draws = Vec::new();
        for (entry, (_, tile)) in (0..).zip(&near) {
            let corner = self.tiles.corner_m(*tile);
            let origin = corner - eye;
            let phase = (corner / CROWN_M).map(|at| at - at.floor());
            let turned_phase = (TURN.rotate(corner) / TURNED_M).map(|at| at - at.floor());
            let bytes = CanopyTile {
                origin_m: origin.as_vec2().to_array(),
                cell_m: self.cell_m as f32,
                start_m: START_M,
                reach_m: self.reach_m as f32,
                crown_m: CROWN_M as f32,
                phase: phase.as_vec2().to_array(),
                turned_phase: turned_phase.as_vec2().to_array(),
                turned_m: TURNED_M as f32,
                pad: 0.0,
            };
            table.extend_from_slice(bytemuck::bytes_of(&bytes));
            table.resize((entry + 1) * ENTRY as usize, 0);
            let [least_m, most_m] = self.shown[tile].canopy.range_m.map(f64::from);
            let low = DVec3::new(origin.x, least_m - view.eye_m.y, origin.y);
            let high = DVec3::new(origin.x + side_m, most_m - view.eye_m.y, origin.y + side_m);
            if frustum.may_see_box(low.as_vec3() - 1.0, high.as_vec3() + 1.0) {
                draws.push((*tile, entry as u32));
            }
        }
        gpu.queue.write_buffer(&self.table, 0, &table);
        if self.draws.len() <= view_index {
            self.draws.resize(view_index + 1, Vec::new());
        }
        self.draws[view_index] = draws;
    }

    /// Draws a prepared view's canopy; group 0 is bound, group 1 is the ground's.
    pub fn draw(&self, view_index: usize, terrain: &wgpu::BindGroup, pass: &mut wgpu::RenderPass<'_>) {
        let Some(draws) = self.draws.get(view_index).filter(|draws| !draws.is_empty()) else { return };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, terrain, &[]);
        pass.set_bind_group(2, &self.crowns, &[]);
        for (tile, entry) in draws {
            let Some(shown) = self.shown.get(tile) else { continue };
            pass.set_bind_group(3, &self.entry, &[entry * ENTRY as u32]);
            pass.set_vertex_buffer(0, shown.vertices.slice(..));
            pass.set_index_buffer(shown.indices.slice(..), wgpu::IndexFormat::Uint16);
            pass.draw_indexed(0..shown.canopy.indices.len() as u32, 0, 0..1);
        }
    }

    /// Bytes on the GPU.
    pub fn gpu_bytes(&self) -> usize {
        let tiles = self.shown.values().map(|shown| (shown.vertices.size() + shown.indices.size()) as usize);
        tiles.sum::<usize>() + self.table.size() as usize + pictures::crowns().iter().map(Vec::len).sum::<usize>()
    }

    /// What the first view's canopy is made of.
    pub fn counts(&self) -> CanopyCounts {
        let mut counts = CanopyCounts::default();
        for shown in self.draws.first().into_iter().flatten().filter_map(|(tile, _)| self.shown.get(tile)) {
            counts.stands_for += shown.canopy.stands_for;
            counts.triangles += shown.canopy.indices.len() / 3;
        }
        counts
    }
}

fn bytes(canopy: &Canopy) -> usize {
    canopy.corners.len() * size_of::<Vertex>() + canopy.indices.len() * 2
}

/// The crown texture.
fn crowns(gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
    let device = &gpu.device;
    let mips = pictures::crowns();
    let side = pictures::CROWNS as u32;
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("crowns"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        mip_level_count: mips.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, texels) in (0..).zip(mips) {
        mip(&gpu.queue, &texture, level, 0, [side >> level; 2], texels);
    }
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("crowns"),
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Nearest,
        ..wgpu::SamplerDescriptor::default()
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("crowns"),
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    })
}

fn pipeline(device: &wgpu::Device, groups: &[&wgpu::BindGroupLayout; 4], format: TargetFormat) -> wgpu::RenderPipeline {
    let module = shaders::module(device, "canopy.wgsl");
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("canopy"),
        bind_group_layouts: &groups.map(Some),
        immediate_size: 0,
    });
    let constants = [("TILE", f64::from(terrain::block::mesh::TILE))];
    let options =
        wgpu::PipelineCompilationOptions { constants: &constants, ..wgpu::PipelineCompilationOptions::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("canopy"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("canopy_vertex"),
            compilation_options: options.clone(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Vertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &ATTRIBUTES,
            })],
        },
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..wgpu::PrimitiveState::default() },
        depth_stencil: format.depth_state(wgpu::CompareFunction::Greater, true),
        multisample: format.multisample(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("canopy_fragment"),
            compilation_options: options.clone(),
            targets: &[Some(format.colour.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
