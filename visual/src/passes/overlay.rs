//! Draws what is draped on the near ground: water, roads, airfields. Shader: `shaders/overlay.wgsl`.
//!
//! Each block's triangles are made off the render thread ([`terrain::block::overlay`]) and drawn after the ground, blended
//! over it, depth tested and not written. Only blocks that are drawn at level 0 have any, so what is draped lies in the
//! triangles that are drawn.
//!
//! A world without roads, water or airfields has no such pass: [`OverlayPass::new`] says so.

use super::TargetFormat;
use super::terrain::Terrain;
use super::upload::filled;
use crate::camera::View;
use crate::gpu::Gpu;
use crate::shaders;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use terrain::BlockIndex;
use terrain::block::Landscape;
use terrain::block::overlay::{self, Kind, Overlay, Overlays, Vertex};
use terrain::edit::Changed;
use terrain::near::{Change, NearTiles, Settings, TileIndex};

/// Bytes uploaded in a frame; one block of a town is about a MiB.
const BUDGET_BYTES: usize = 2 << 20;

/// Roads are drawn where one of this width spans a pixel, metres; the shader fades them out before.
pub const ROAD_M: f64 = 9.0;

/// How overlays are kept and drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverlaySettings {
    /// Plan distance within which a block's overlay is wanted, metres; at most the near radius is of use.
    pub reach_m: f64,
    /// How many of the detail texture's scales the ground has; without any, water has no ripples.
    pub detail: u32,
    /// Wait for every wanted block.
    pub wait: bool,
}

/// See the module.
pub struct OverlayPass {
    tiles: NearTiles<Overlay>,
    blocks: HashMap<BlockIndex, OnDevice>,
    /// For all but open water, and for that.
    pipelines: [wgpu::RenderPipeline; 2],
    /// For each view: block, slot, and whether its roads are near enough.
    draws: Vec<Vec<(BlockIndex, u32, bool)>>,
    triangles: u64,
}

/// A block's triangles on the device.
struct OnDevice {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// Where open water begins and ends in the list: running water before, roads after.
    water: Range<u32>,
    /// Where roads begin and end: airfields after.
    roads: Range<u32>,
    count: u32,
}

impl OverlayPass {
    /// The pass, if the landscape has anything to drape. `terrain` is the ground's group 1 layout.
    pub fn new(
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        terrain: &wgpu::BindGroupLayout,
        format: TargetFormat,
        landscape: Arc<Landscape>,
        settings: OverlaySettings,
    ) -> Option<Self> {
        if !overlay::any(&landscape.features, &landscape.lakes) {
            return None;
        }
        let grid = *landscape.ground.field().grid();
        let make = |entry| {
            let (frame, terrain) = (frame.clone(), terrain.clone());
            pipeline(gpu, &Fragment { frame, terrain, format, entry, detail: settings.detail })
        };
        let pipelines = ["overlay_fragment", "open_water_fragment"].map(make);
        let settings = Settings {
            side_m: grid.block_m(),
            reach_m: settings.reach_m,
            budget_bytes: BUDGET_BYTES,
            wait: settings.wait,
        };
        let tiles = NearTiles::new(&grid, settings, Overlay::upload_bytes, maker(landscape));
        Some(Self { tiles, blocks: HashMap::new(), pipelines, draws: Vec::new(), triangles: 0 })
    }

    /// Takes over a new version of the ground.
    pub fn set_landscape(&mut self, landscape: Arc<Landscape>, changed: &Changed) {
        self.tiles.remake_where(changed, maker(landscape));
    }

    /// Blocks within reach that were not there after the last update.
    pub fn late(&self) -> usize {
        self.tiles.late()
    }

    /// Triangles sent for the first view.
    pub fn triangles(&self) -> u64 {
        self.triangles
    }

    /// Bytes on the GPU.
    pub fn gpu_bytes(&self) -> usize {
        self.blocks.values().map(|block| (block.vertices.size() + block.indices.size()) as usize).sum()
    }

    /// Streams within the budget.
    pub fn follow(&mut self, gpu: &Gpu, eye_m: DVec3, speed_mps: f64) {
        for change in self.tiles.update(DVec2::new(eye_m.x, eye_m.z), speed_mps) {
            match change {
                Change::Arrived(tile, made) => {
                    let block = BlockIndex { x: tile.x, z: tile.z };
                    match OnDevice::new(gpu, &made) {
                        Some(there) => drop(self.blocks.insert(block, there)),
                        None => drop(self.blocks.remove(&block)),
                    }
                }
                Change::Left(tile) => {
                    self.blocks.remove(&BlockIndex { x: tile.x, z: tile.z });
                }
            }
        }
    }

    /// Chooses what a view sees from the ground's blocks, which must be prepared.
    pub fn prepare(&mut self, view_index: usize, view: &View, terrain: &Terrain) {
        let focal_px = f64::from(view.size_px[1]) / (view.top - view.bottom);
        let roads_m = ROAD_M * focal_px;
        let near = terrain.draws(view_index).iter().filter(|draw| draw.ring == 0);
        let draws: Vec<_> = near
            .filter(|draw| self.blocks.contains_key(&draw.block))
            .map(|draw| (draw.block, draw.slot as u32, draw.distance_m < roads_m))
            .collect();
        if view_index == 0 {
            let ranges = draws.iter().filter_map(|(block, _, roads)| Some(self.blocks.get(block)?.ranges(*roads)));
            self.triangles = ranges.flatten().map(|range| u64::from(range.end - range.start) / 3).sum();
        }
        if self.draws.len() <= view_index {
            self.draws.resize(view_index + 1, Vec::new());
        }
        self.draws[view_index] = draws;
    }

    /// Records a prepared view's overlays after its ground; group 0 must be bound.
    pub fn draw(&self, view_index: usize, terrain: &Terrain, pass: &mut wgpu::RenderPass<'_>) {
        let draws = self.draws.get(view_index).map_or(&[][..], Vec::as_slice);
        if draws.is_empty() {
            return;
        }
        pass.set_bind_group(1, terrain.bindings().1, &[]);
        for (stage, pipeline) in STAGES.into_iter().enumerate() {
            let mut bound = false;
            for (block, slot, roads) in draws {
                let Some(there) = self.blocks.get(block) else { continue };
                let range = there.ranges(*roads)[stage].clone();
                if range.is_empty() {
                    continue;
                }
                if !std::mem::replace(&mut bound, true) {
                    pass.set_pipeline(&self.pipelines[pipeline]);
                }
                pass.set_vertex_buffer(0, there.vertices.slice(..));
                pass.set_index_buffer(there.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(range, 0, *slot..*slot + 1);
            }
        }
    }

    /// Whether water within its outlines is draped on a block.
    pub fn has_water(&self, block: BlockIndex) -> bool {
        self.blocks.get(&block).is_some_and(|there| !there.water.is_empty())
    }
}

/// Makes a block's triangles; made ready by the thread that uses it.
fn maker(landscape: Arc<Landscape>) -> impl Fn(TileIndex) -> Overlay + Send + 'static {
    let overlays = OnceLock::new();
    move |tile| overlays.get_or_init(|| Overlays::new(&landscape)).block(BlockIndex { x: tile.x, z: tile.z })
}

impl OnDevice {
    fn new(gpu: &Gpu, overlay: &Overlay) -> Option<Self> {
        if overlay.indices.is_empty() {
            return None;
        }
        let words: Vec<[u32; 5]> = overlay.vertices.iter().map(Vertex::words).collect();
        // Triangles come in the order of their kinds.
        let before = |kind: Kind| {
            let triangles = overlay.indices.as_chunks::<3>().0;
            let first = triangles.partition_point(|corners| overlay.vertices[corners[0] as usize].kind() < kind as u8);
            3 * first as u32
        };
        Some(Self {
            water: before(Kind::WaterArea)..before(Kind::Path),
            roads: before(Kind::Path)..before(Kind::Apron),
            count: overlay.indices.len() as u32,
            vertices: filled(gpu, "overlay vertices", bytemuck::cast_slice(&words), wgpu::BufferUsages::VERTEX),
            indices: filled(gpu, "overlay indices", bytemuck::cast_slice(&overlay.indices), wgpu::BufferUsages::INDEX),
        })
    }

    /// What is drawn of it, in the order of [`STAGES`], with or without its roads.
    fn ranges(&self, roads: bool) -> [Range<u32>; 4] {
        let end = if roads { self.roads.end } else { self.roads.start };
        [0..self.water.start, self.water.clone(), self.roads.start..end, self.roads.end..self.count]
    }
}

/// Which pipeline draws each of a block's ranges.
const STAGES: [usize; 4] = [0, 1, 0, 0];

/// Of a vertex, by location.
const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Uint32x2, 1 => Float32, 2 => Float32, 3 => Uint32];

/// What a pipeline of the shader is made for.
pub(super) struct Fragment {
    /// Layouts of groups 0 and 1.
    pub frame: wgpu::BindGroupLayout,
    pub terrain: wgpu::BindGroupLayout,
    pub format: TargetFormat,
    /// The fragment stage's entry.
    pub entry: &'static str,
    /// How many of the detail texture's scales the ground has.
    pub detail: u32,
}

pub(super) fn pipeline(gpu: &Gpu, of: &Fragment) -> wgpu::RenderPipeline {
    let device = &gpu.device;
    let module = shaders::module(device, "overlay.wgsl");
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("overlay"),
        bind_group_layouts: &[Some(&of.frame), Some(&of.terrain)],
        immediate_size: 0,
    });
    let constants = [("TILE", f64::from(terrain::block::mesh::TILE)), ("DETAIL", f64::from(of.detail.min(2)))];
    let options =
        wgpu::PipelineCompilationOptions { constants: &constants, ..wgpu::PipelineCompilationOptions::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(of.entry),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("overlay_vertex"),
            compilation_options: options.clone(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Vertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &ATTRIBUTES,
            })],
        },
        // A sliver may be turned over by the rounding of a spot: nothing is culled.
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: of.format.depth_state(wgpu::CompareFunction::GreaterEqual, false),
        multisample: of.format.multisample(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(of.entry),
            compilation_options: options,
            targets: &[Some(wgpu::ColorTargetState {
                format: of.format.colour,
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
