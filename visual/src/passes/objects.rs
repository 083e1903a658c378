//! Draws what stands on the ground near the eye: buildings, placed things, masts, power line towers, and what moves.
//! Shader: `shaders/objects.wgsl`.
//!
//! Tiles of [`TILE_M`] are made off the render thread ([`super::object_tiles`]) and streamed within a budget. A tile's
//! buildings are one list of triangles, largest first, so that those below a pixel and a half are left out by drawing
//! fewer; on the way there a thing sinks into the ground, so none pops. Everything else is an instance of a shared shape
//! with two levels of detail. [`Objects::follow`] streams, [`Objects::prepare`] culls, [`Objects::draw`] records.
//!
//! Invariants others rely on: positions are formed from whole-number post differences as the ground's are, so a wall
//! meets the ground where the ground query says, within the rounding of f32 heights; a world without objects has no
//! thread, no buffer and no draw.

use super::TargetFormat;
use super::object_tiles::{self, Tile};
use super::terrain::eye_uniforms;
use super::upload::{Growing, filled};
use crate::camera::{DEPTH_COMPARE, Frustum, View};
use crate::gpu::Gpu;
use crate::models::glb::{self, Fit};
use crate::models::things::{MODELS, Model};
use crate::models::{Mesh, Vertex};
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use glam::{DQuat, DVec2, DVec3, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use terrain::Grid;
use terrain::features::index::ObjectIndex;
use terrain::features::shape;
use terrain::near::{Change, NearTiles, Settings, TileIndex};

/// Side of a tile, metres.
pub const TILE_M: f64 = 1_500.0;
/// Most bytes uploaded in an update beside one tile.
const BUDGET_BYTES: usize = 2 << 20;
/// Size on screen at which a thing has sunk away, pixels; mirrored in the shader.
pub const GONE_PX: f64 = 1.2;
/// Size on screen below which a thing is drawn as boxes, pixels.
const COARSE_PX: f64 = 12.0;
/// Most things that move.
const MOST_DYNAMIC: usize = 65_536;

/// A shape somewhere; mirror of the instance inputs of `shaders/objects.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Instance {
    /// Column and row of the post that `offset_m` counts from.
    pub anchor_post: [i32; 2],
    /// East of the post, above sea level, south of it.
    pub offset_m: [f32; 3],
    /// Metres for a unit of the shape.
    pub scale: f32,
    /// Turns the shape's axes to the world's: x, y, z, w.
    pub rotation: [f32; 4],
    /// 0, or a hash that tells its windows from others'.
    pub seed: u32,
    /// What its paint's albedo is multiplied with: 1, or less where it is burnt.
    pub shade: f32,
}

/// A thing that a scene moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectInstance {
    /// Its shape.
    pub class: Model,
    /// Where its foot is, world metres.
    pub position_m: DVec3,
    /// Turns its axes (x right, y up, z backward) to the world's.
    pub attitude: DQuat,
    /// 1 for its real size; a mast's is its height in metres.
    pub scale: f64,
    /// 1, or less where it is burnt.
    pub shade: f32,
}

/// What a view's objects are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjectCounts {
    /// Buildings drawn.
    pub buildings: u32,
    /// Other things drawn.
    pub things: u32,
    /// Triangles sent.
    pub triangles: u64,
    /// Draw calls.
    pub draw_calls: u32,
}

impl ObjectCounts {
    /// All that stood there.
    pub fn all(&self) -> u32 {
        self.buildings + self.things
    }
}

/// A shape's two levels in the shared buffers.
#[derive(Clone, Debug)]
struct Shape {
    /// Index range and first vertex of each level.
    levels: [(std::ops::Range<u32>, i32); 2],
    /// Diagonal for a scale of 1.
    size_m: f64,
}

/// A tile on the device.
struct Resident {
    tile: Arc<Tile>,
    buffers: Option<(wgpu::Buffer, wgpu::Buffer)>,
}

/// What one view draws.
struct Prepared {
    /// Tile, indices, number of its instance.
    tiles: Vec<(TileIndex, u32, u32)>,
    /// Model, level, instances.
    things: Vec<(usize, usize, std::ops::Range<u32>)>,
    instances: Growing,
}

/// See the module.
pub struct Objects {
    grid: Grid,
    tiles: Option<NearTiles<Tile>>,
    resident: BTreeMap<TileIndex, Resident>,
    dynamic: Vec<ObjectInstance>,
    shapes: Vec<Shape>,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    pipeline: wgpu::RenderPipeline,
    views: Vec<Prepared>,
    counts: ObjectCounts,
    gpu_bytes: usize,
}

impl Objects {
    /// A pass over a world's objects within `reach_m` of the eye.
    pub fn new(
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        window: &wgpu::BindGroupLayout,
        format: TargetFormat,
        grid: &Grid,
        index: Arc<ObjectIndex>,
        reach_m: f64,
        wait: bool,
    ) -> Self {
        let (shapes, vertices, indices) = shapes(gpu, &[]);
        let settings = Settings { side_m: TILE_M, reach_m, budget_bytes: BUDGET_BYTES, wait };
        let world = *grid;
        let tiles = (!index.is_empty()).then(|| {
            NearTiles::new(grid, settings, Tile::bytes, move |tile| object_tiles::made(&index, &world, tile, TILE_M))
        });
        Self {
            grid: *grid,
            tiles,
            resident: BTreeMap::new(),
            dynamic: Vec::new(),
            shapes,
            vertices,
            indices,
            pipeline: pipeline(gpu, frame, window, format),
            views: Vec::new(),
            counts: ObjectCounts::default(),
            gpu_bytes: 0,
        }
    }

    /// Replaces generated shapes by others, scaled to the real length of what they are.
    pub fn set_models(&mut self, gpu: &Gpu, own: &[(Model, Mesh)]) {
        (self.shapes, self.vertices, self.indices) = shapes(gpu, own);
    }

    /// Replaces what a scene moves; drawn from the next [`Self::prepare`] on.
    pub fn set_dynamic(&mut self, instances: &[ObjectInstance]) {
        self.dynamic.clear();
        let sound = |one: &&ObjectInstance| {
            one.position_m.is_finite()
                && one.attitude.is_finite()
                && one.attitude.length_squared() > 1e-12
                && one.scale.is_finite()
                && one.shade.is_finite()
        };
        self.dynamic.extend(instances.iter().filter(sound).take(MOST_DYNAMIC));
    }

    /// What the first view's objects were made of.
    pub fn counts(&self) -> ObjectCounts {
        self.counts
    }

    /// Tiles wanted and not there.
    pub fn late(&self) -> usize {
        self.tiles.as_ref().map_or(0, NearTiles::late)
    }

    /// Bytes on the GPU.
    pub fn gpu_bytes(&self) -> usize {
        let views = self.views.iter().map(|view| view.instances.bytes());
        views.sum::<usize>() + self.gpu_bytes + (self.vertices.size() + self.indices.size()) as usize
    }

    /// Streams tiles after the eye.
    pub fn follow(&mut self, gpu: &Gpu, eye_m: DVec3, speed_mps: f64) {
        let Some(tiles) = &mut self.tiles else { return };
        for change in tiles.update(DVec2::new(eye_m.x, eye_m.z), speed_mps) {
            match change {
                Change::Arrived(at, tile) => {
                    self.forget(at);
                    if tile.is_empty() {
                        continue;
                    }
                    let buffers = (!tile.mesh.indices.is_empty()).then(|| {
                        let vertices = bytemuck::cast_slice(&tile.mesh.vertices);
                        let indices = bytemuck::cast_slice(&tile.mesh.indices);
                        (
                            filled(gpu, "buildings", vertices, wgpu::BufferUsages::VERTEX),
                            filled(gpu, "buildings", indices, wgpu::BufferUsages::INDEX),
                        )
                    });
                    self.gpu_bytes += tile.bytes();
                    self.resident.insert(at, Resident { tile, buffers });
                }
                Change::Left(at) => self.forget(at),
            }
        }
    }

    fn forget(&mut self, at: TileIndex) {
        if let Some(gone) = self.resident.remove(&at) {
            self.gpu_bytes = self.gpu_bytes.saturating_sub(gone.tile.bytes());
        }
    }

    /// Takes over an index in which things stand anew; `moved` are their middles in plan (x, z).
    pub fn set_index(&mut self, index: Arc<ObjectIndex>, moved: &[DVec2]) {
        let Some(tiles) = &mut self.tiles else { return };
        let grid = self.grid;
        let corner = DVec2::new(grid.west_m, grid.north_m);
        let at: BTreeSet<TileIndex> = moved
            .iter()
            .map(|middle| ((middle - corner) / TILE_M).floor().as_ivec2())
            .map(|tile| TileIndex { x: tile.x, z: tile.y })
            .collect();
        let make = move |tile| object_tiles::made(&index, &grid, tile, TILE_M);
        tiles.remake(make, |tile| at.contains(&tile));
    }

    /// Culls for a view and uploads its instances.
    pub fn prepare(&mut self, gpu: &Gpu, view_index: usize, view: &View) {
        while self.views.len() <= view_index {
            let instances = Growing::new("object instances", wgpu::BufferUsages::VERTEX);
            self.views.push(Prepared { tiles: Vec::new(), things: Vec::new(), instances });
        }
        let frustum = view.frustum();
        let focal_px = view.focal_px();
        let mut counts = ObjectCounts::default();
        let mut instances: Vec<Instance> = Vec::new();
        let mut tiles = Vec::new();
        let mut things: Vec<Vec<Instance>> = vec![Vec::new(); 2 * MODELS.len()];
        for (at, resident) in &self.resident {
            let tile = &resident.tile;
            let distance_m = nearest_m(view.eye_m, tile.low, tile.high);
            if focal_px * tile.largest_m < GONE_PX * distance_m || !sees(&frustum, view, tile.low, tile.high) {
                continue;
            }
            let smallest_m = GONE_PX * distance_m / focal_px;
            let drawn = tile.cuts.partition_point(|(size_m, _)| *size_m >= smallest_m);
            if let Some((_, end)) = drawn.checked_sub(1).and_then(|last| tile.cuts.get(last)) {
                tiles.push((*at, *end, instances.len() as u32));
                instances.push(Instance {
                    anchor_post: tile.anchor_post,
                    offset_m: [0.0; 3],
                    scale: 1.0,
                    rotation: [0.0, 0.0, 0.0, 1.0],
                    seed: 0,
                    shade: 1.0,
                });
                counts.buildings += drawn as u32;
                counts.triangles += u64::from(*end) / 3;
            }
            for thing in &tile.things {
                let size_m = self.shapes[thing.model.number()].size_m * f64::from(thing.instance.scale);
                self.show(thing.model, thing.instance, thing.at_m, size_m, view, &frustum, &mut things);
            }
        }
        for one in &self.dynamic {
            let size_m = self.shapes[one.class.number()].size_m * one.scale.abs();
            let (anchor_post, [east_m, south_m]) = eye_uniforms(&self.grid, one.position_m);
            let instance = Instance {
                anchor_post,
                offset_m: [east_m, one.position_m.y as f32, south_m],
                scale: one.scale as f32,
                rotation: one.attitude.normalize().as_quat().to_array(),
                seed: 0,
                shade: one.shade,
            };
            self.show(one.class, instance, one.position_m, size_m, view, &frustum, &mut things);
        }
        let mut ranges = Vec::new();
        for (number, list) in things.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
            let first = instances.len() as u32;
            instances.extend_from_slice(list);
            let (model, level) = (number / 2, number % 2);
            ranges.push((model, level, first..instances.len() as u32));
            counts.things += list.len() as u32;
            let (indices, _) = &self.shapes[model].levels[level];
            counts.triangles += u64::from(indices.end - indices.start) / 3 * list.len() as u64;
        }
        counts.draw_calls = (tiles.len() + ranges.len()) as u32;
        if view_index == 0 {
            self.counts = counts;
        }
        let prepared = &mut self.views[view_index];
        (prepared.tiles, prepared.things) = (tiles, ranges);
        prepared.instances.write(&gpu.device, &gpu.queue, &[bytemuck::cast_slice(&instances)]);
    }

    /// Adds a thing to its list if it is in sight and large enough.
    fn show(
        &self,
        model: Model,
        instance: Instance,
        at_m: DVec3,
        size_m: f64,
        view: &View,
        frustum: &Frustum,
        things: &mut [Vec<Instance>],
    ) {
        let size_px = focal(view, at_m) * size_m;
        let reach = DVec3::splat(size_m);
        if size_px >= GONE_PX && sees(frustum, view, at_m - reach, at_m + reach) {
            things[2 * model.number() + usize::from(size_px < COARSE_PX)].push(instance);
        }
    }

    /// Records a prepared view's objects; group 0 must be bound, `window` is the ground's group 1.
    pub fn draw(&self, view_index: usize, window: &wgpu::BindGroup, pass: &mut wgpu::RenderPass<'_>) {
        let Some(prepared) = self.views.get(view_index) else { return };
        let Some(instances) = prepared.instances.buffer() else { return };
        if prepared.tiles.is_empty() && prepared.things.is_empty() {
            return;
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, window, &[]);
        pass.set_vertex_buffer(1, instances.slice(..));
        for (at, indices, instance) in &prepared.tiles {
            let Some((vertices, list)) = self.resident.get(at).and_then(|resident| resident.buffers.as_ref()) else {
                continue;
            };
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.set_index_buffer(list.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..*indices, 0, *instance..*instance + 1);
        }
        if prepared.things.is_empty() {
            return;
        }
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (model, level, range) in &prepared.things {
            let (indices, first) = self.shapes[*model].levels[*level].clone();
            pass.draw_indexed(indices, first, range.clone());
        }
    }
}

/// Pixels on screen for a metre at a place.
fn focal(view: &View, at_m: DVec3) -> f64 {
    view.focal_px() / at_m.distance(view.eye_m).max(view.near_m)
}

fn nearest_m(eye_m: DVec3, low: DVec3, high: DVec3) -> f64 {
    eye_m.clamp(low, high).distance(eye_m).max(1.0)
}

fn sees(frustum: &Frustum, view: &View, low: DVec3, high: DVec3) -> bool {
    frustum
        .may_see_box((low - view.eye_m).as_vec3() - Vec3::splat(0.1), (high - view.eye_m).as_vec3() + Vec3::splat(0.1))
}

/// All shapes in one pair of buffers.
fn shapes(gpu: &Gpu, own: &[(Model, Mesh)]) -> (Vec<Shape>, wgpu::Buffer, wgpu::Buffer) {
    let (mut vertices, mut indices): (Vec<Vertex>, Vec<u32>) = Default::default();
    let mut shapes = Vec::with_capacity(MODELS.len());
    for model in MODELS {
        let replaced = own.iter().find(|(of, _)| *of == model).map(|(_, mesh)| in_place_of(model, mesh.clone()));
        let is_own = replaced.is_some();
        let whole = replaced.unwrap_or_else(|| model.mesh(0));
        let (low, high) = whole.bounds_m();
        let size_m = f64::from((high - low).length());
        let mut add = |mut mesh: Mesh| {
            mesh.seal(size_m as f32, model.number() as u32);
            let (first, base) = (indices.len() as u32, vertices.len() as i32);
            vertices.extend_from_slice(&mesh.vertices);
            indices.extend_from_slice(&mesh.indices);
            (first..indices.len() as u32, base)
        };
        let near = add(whole);
        // A shape of a world's own keeps its looks from afar.
        let far = if is_own { near.clone() } else { add(model.mesh(1)) };
        shapes.push(Shape { levels: [near, far], size_m });
    }
    let vertices = filled(gpu, "shapes", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX);
    let indices = filled(gpu, "shapes", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX);
    (shapes, vertices, indices)
}

/// A shape of a world's own in the units of the one that it replaces: as long as a placed thing really is, as high as a mast
/// that is scaled to its height, as long as the generated shape of what only a scene moves.
fn in_place_of(model: Model, mesh: Mesh) -> Mesh {
    match model.placed() {
        Some(class) => {
            let around = shape::bounds(shape::placed(class));
            let size = around.high - around.low;
            glb::fitted(mesh, Fit::LengthM(size.x.max(size.z) as f32))
        }
        None if model.is_scaled_to_height() => {
            let (low, high) = model.mesh(0).bounds_m();
            glb::fitted(mesh, Fit::HeightM(high.y - low.y))
        }
        None => {
            let (low, high) = model.mesh(0).bounds_m();
            glb::fitted(mesh, Fit::LengthM((high - low).x.max((high - low).z)))
        }
    }
}

fn pipeline(
    gpu: &Gpu,
    frame: &wgpu::BindGroupLayout,
    window: &wgpu::BindGroupLayout,
    format: TargetFormat,
) -> wgpu::RenderPipeline {
    let device = &gpu.device;
    let module = shaders::module(device, "objects.wgsl");
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("objects"),
        bind_group_layouts: &[Some(frame), Some(window)],
        immediate_size: 0,
    });
    let vertex = wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm8x4, 2 => Unorm8x4, 3 => Float32x2, 4 => Uint32];
    let instance = wgpu::vertex_attr_array![5 => Sint32x2, 6 => Float32x3, 7 => Float32, 8 => Float32x4, 9 => Uint32, 10 => Float32];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("objects"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("objects_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[
                Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Vertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &vertex,
                }),
                Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Instance>() as u64,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes: &instance,
                }),
            ],
        },
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..wgpu::PrimitiveState::default() },
        depth_stencil: format.depth_state(DEPTH_COMPARE, true),
        multisample: format.multisample(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("objects_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(format.colour.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::Paint;

    #[test]
    fn own_shapes_are_as_large_as_those_that_they_replace() {
        let mut tall = Mesh::default();
        let grey = Paint::matt(0.3, 0.3, 0.3);
        tall.cuboid(Vec3::new(-7.0, 20.0, -5.0), Vec3::new(7.0, 120.0, 5.0), grey, grey);
        let size = |mesh: &Mesh| {
            let (low, high) = mesh.bounds_m();
            assert!(low.y.abs() < 1e-5, "stands on its foot");
            high - low
        };
        for model in MODELS {
            let (is, was) = (size(&in_place_of(model, tall.clone())), model.mesh(0).bounds_m());
            // Placed things and masts alike; f32 of sizes below 200 m.
            if model.is_scaled_to_height() {
                assert!((is.y - (was.1.y - was.0.y)).abs() < 1e-5 && is.y < 2.0, "{model:?}: {is}");
            } else if let Some(class) = model.placed() {
                let around = shape::bounds(shape::placed(class));
                let long_m = (around.high - around.low).x.max((around.high - around.low).z) as f32;
                assert!((is.x - long_m).abs() < 1e-4, "{model:?}: {is}");
            } else {
                let long_m = (was.1 - was.0).x.max((was.1 - was.0).z);
                assert!((is.x - long_m).abs() < 1e-4, "{model:?}: {is}");
            }
        }
    }
}
