//! Draws the ground: the blocks of a [`Window`] that a view can see, near ones first. Shader: `shaders/terrain.wgsl`.
//!
//! One draw call a block, no vertex buffer. Near land, far land and blocks with water have a pipeline each, so that none
//! pays for another's looks: the detail texture fades out by itself well within the near radius. [`Terrain::follow`] streams within the window's budget, [`Terrain::prepare`] culls and writes what one view
//! needs, [`Terrain::draw`] records; all three run on the render thread and never wait.
//!
//! Invariant others rely on: a vertex lies at `(post - eye_post) * step - eye_fraction` east and south and `height - eye`
//! up, formed in that order in f32 by every pipeline, so shared vertices are equal to the bit.

use super::TargetFormat;
use super::terrain_textures::TerrainTextures;
use crate::camera::View;
use crate::gpu::Gpu;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Vec3};
use std::sync::Arc;
use terrain::block::mesh::TILE;
use terrain::block::payload::{Landscape, Mesh};
use terrain::block::window::{Draw, Level, MAX_BLOCKS, Upload, Window};
use terrain::edit::Changed;
use terrain::{BlockIndex, CELLS, Grid};

/// Beyond this the detail texture's mips are as good as even: a pixel spans more than its longest feature.
const DETAIL_REACH_M: f64 = 9_000.0;

/// How the ground is drawn; a change needs a new pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TerrainLook {
    /// How many scales of the detail texture are read: 0 to 2.
    pub detail: u32,
    /// Tint blocks by level.
    pub overlay: bool,
    /// Draw the edges of triangles only, where the adapter can.
    pub wireframe: bool,
}

/// Mirror of the shader's `WindowUniforms`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct WindowUniforms {
    /// Column and row of the post north-west of the eye.
    pub eye_post: [i32; 2],
    /// The eye's east and south of that post, metres.
    pub eye_fraction_m: [f32; 2],
    /// Metres between posts.
    pub step_m: f32,
    /// 1 / texels along the light maps.
    pub light_texel: f32,
    /// 1 / texels along the ground maps.
    pub map_texel: f32,
    /// Layer of the sun in use.
    pub light_layer: i32,
}

/// Mirror of the shader's `Block`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct BlockEntry {
    /// First column and row.
    pub first_post: [i32; 2],
    /// 0, 1, or 2 for mixed.
    pub level: i32,
    /// Slots along the window.
    pub side: i32,
}

/// The ground map's alpha from which it shows water where outlines are draped: between texels its shore is off by up to
/// 0.71 of one (0.085), which must stay within the outline.
const DRAPED_SHORE: f64 = 0.62;

/// What a view's ground is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawCounts {
    /// Blocks at level 0.
    pub near_blocks: u32,
    /// Blocks at level 1.
    pub level1_blocks: u32,
    /// Blocks between.
    pub mixed_blocks: u32,
    /// Triangles sent.
    pub triangles: u64,
    /// Triangles that the same blocks have at level 0.
    pub triangles_all_level0: u64,
}

/// The ground on the GPU.
pub struct Terrain {
    window: Window,
    textures: TerrainTextures,
    uniforms: wgpu::Buffer,
    table: wgpu::Buffer,
    entries: Vec<BlockEntry>,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    format: TargetFormat,
    look: TerrainLook,
    pipelines: [wgpu::RenderPipeline; 4],
    /// For each view: near land, far land, then water, each nearest first.
    draws: Vec<Vec<Draw>>,
    counts: DrawCounts,
}

/// Splits an eye into whole posts and the rest; the one place that rounds a plan position.
pub fn eye_uniforms(grid: &Grid, eye_m: DVec3) -> ([i32; 2], [f32; 2]) {
    let split = |at_m: f64, first_m: f64| {
        let post = ((at_m - first_m) / grid.step_m).floor().clamp(-1e9, 1e9);
        (post as i32, (at_m - (first_m + post * grid.step_m)) as f32)
    };
    let ((column, east_m), (row, south_m)) = (split(eye_m.x, grid.west_m), split(eye_m.z, grid.north_m));
    ([column, row], [east_m, south_m])
}

impl Terrain {
    /// Makes textures, pipelines and bindings for a window; nothing is uploaded before the first [`Self::follow`].
    pub fn new(
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        format: TargetFormat,
        window: Window,
        look: TerrainLook,
    ) -> Self {
        let device = &gpu.device;
        let side = window.settings().blocks;
        let textures = TerrainTextures::new(device, &gpu.queue, side);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrain"),
            entries: &layout_entries(),
        });
        let buffer = |label, size: usize| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let uniforms = buffer("terrain window", size_of::<WindowUniforms>());
        let table = buffer("terrain blocks", size_of::<BlockEntry>() * (MAX_BLOCKS * MAX_BLOCKS) as usize);
        let group = bind(device, &layout, &textures, &uniforms, &table);
        let pipelines = pipelines(gpu, frame, &layout, format, look);
        Self {
            entries: vec![BlockEntry::default(); (side * side) as usize],
            window,
            textures,
            uniforms,
            table,
            layout,
            group,
            format,
            look,
            pipelines,
            draws: Vec::new(),
            counts: DrawCounts::default(),
        }
    }

    /// The window and its counters.
    pub fn window(&self) -> &Window {
        &self.window
    }

    /// The textures, for reading back.
    pub fn textures(&self) -> &TerrainTextures {
        &self.textures
    }

    /// Layout and resources of group 1, for passes that read the ground too.
    pub fn bindings(&self) -> (&wgpu::BindGroupLayout, &wgpu::BindGroup) {
        (&self.layout, &self.group)
    }

    /// What the first view's ground was made of.
    pub fn counts(&self) -> DrawCounts {
        self.counts
    }

    /// The blocks of a prepared view.
    pub fn draws(&self, view: usize) -> &[Draw] {
        self.draws.get(view).map_or(&[], Vec::as_slice)
    }

    /// Bytes on the GPU.
    pub fn gpu_bytes(&self) -> usize {
        self.textures.bytes() + self.table.size() as usize + self.uniforms.size() as usize
    }

    /// Changes how the ground is drawn.
    pub fn set_look(&mut self, gpu: &Gpu, frame: &wgpu::BindGroupLayout, look: TerrainLook) {
        if look != self.look {
            self.pipelines = pipelines(gpu, frame, &self.layout, self.format, look);
            self.look = look;
        }
    }

    /// How the ground is drawn.
    pub fn look(&self) -> TerrainLook {
        self.look
    }

    /// Takes over a new version of the ground; see [`Window::set_landscape`].
    pub fn set_landscape(&mut self, landscape: Arc<Landscape>, changed: &Changed) {
        self.window.set_landscape(landscape, changed);
    }

    /// Lets the window follow the eye and the sun, and uploads what it asks for.
    pub fn follow(&mut self, gpu: &Gpu, eye_m: DVec3, speed_mps: f64, to_sun: DVec3) {
        self.window.set_sun(to_sun);
        let switches = self.window.counters().switches;
        let uploads = self.window.update(DVec2::new(eye_m.x, eye_m.z), speed_mps);
        for upload in &uploads {
            self.textures.apply(&gpu.queue, upload);
        }
        if !uploads.is_empty() || self.window.counters().switches != switches {
            self.write_table(gpu);
        }
    }

    /// Culls for a view and writes what the shader must know of the eye. All views of a frame share one eye.
    pub fn prepare(&mut self, gpu: &Gpu, view_index: usize, view: &View) {
        let grid = *self.window.landscape().ground.field().grid();
        let frustum = view.frustum();
        let side_m = grid.block_m();
        let mut draws = self.window.draws(|block, along, range| {
            let side_m = side_m * f64::from(along);
            let west_m = grid.x_m(block.first_column()) - view.eye_m.x;
            let north_m = grid.z_m(block.first_row()) - view.eye_m.z;
            let low = DVec3::new(west_m, f64::from(range.least_m) - view.eye_m.y, north_m);
            let high = DVec3::new(west_m + side_m, f64::from(range.greatest_m) - view.eye_m.y, north_m + side_m);
            // A hair wider than its f32 corners may be off.
            frustum.may_see_box(low.as_vec3() - Vec3::splat(0.1), high.as_vec3() + Vec3::splat(0.1))
        });
        // Stable: each part stays nearest first.
        draws.sort_by_key(Self::kind);
        if view_index == 0 {
            self.counts = self.count(&draws);
            let ([column, row], eye_fraction_m) = eye_uniforms(&grid, view.eye_m);
            let blocks = self.window.settings().blocks;
            let uniforms = WindowUniforms {
                eye_post: [column, row],
                eye_fraction_m,
                step_m: grid.step_m as f32,
                light_texel: 1.0 / (blocks * TILE) as f32,
                map_texel: 1.0 / (blocks * terrain::block::ground_map::SIDE) as f32,
                light_layer: self.window.light().0 as i32,
            };
            gpu.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&uniforms));
        }
        if self.draws.len() <= view_index {
            self.draws.resize(view_index + 1, Vec::new());
        }
        self.draws[view_index] = draws;
    }

    /// Draws a block of the first prepared view with another mesh, until the view is prepared again. For proofs: the slot
    /// keeps the list, so the window must not draw it afterwards.
    pub fn show_mesh(&mut self, gpu: &Gpu, block: BlockIndex, mesh: &Mesh) {
        let indices = Arc::new(mesh.indices().clone());
        let Some(draw) = self.draws.first_mut().and_then(|draws| draws.iter_mut().find(|d| d.block == block)) else {
            return;
        };
        draw.level = Level::Own { indices: indices.len() as u32 };
        self.textures.apply(&gpu.queue, &Upload::Indices { slot: draw.slot, indices });
    }

    /// Records a prepared view's ground; group 0 must be bound. `draped` says of a block whether water within its outlines
    /// is draped on it.
    pub fn draw(&self, view_index: usize, draped: &dyn Fn(BlockIndex) -> bool, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.textures.indices.slice(..), wgpu::IndexFormat::Uint16);
        let mut bound = None;
        for draw in self.draws(view_index) {
            let kind = Self::kind(draw);
            let kind = if kind == 2 && draw.ring == 0 && draped(draw.block) { 3 } else { kind };
            if bound != Some(kind) {
                pass.set_pipeline(&self.pipelines[kind]);
                bound = Some(kind);
            }
            let slot = draw.slot as u32;
            pass.draw_indexed(self.textures.range(draw.slot, draw.level), 0, slot..slot + 1);
        }
    }

    /// Which pipeline draws a block: 0 near land, 1 far land, 2 with water.
    fn kind(draw: &Draw) -> usize {
        if draw.has_water { 2 } else { usize::from(draw.distance_m > DETAIL_REACH_M) }
    }

    fn count(&self, draws: &[Draw]) -> DrawCounts {
        let mut counts = DrawCounts::default();
        for draw in draws {
            match (draw.ring, draw.level) {
                (0, _) | (_, Level::Zero) => counts.near_blocks += 1,
                (_, Level::One) => counts.level1_blocks += 1,
                (_, Level::Own { .. }) => counts.mixed_blocks += 1,
            }
            let range = self.textures.range(draw.slot, draw.level);
            counts.triangles += u64::from(range.end - range.start) / 3;
            counts.triangles_all_level0 += u64::from(draw.ground_triangles);
        }
        counts
    }

    /// Rewrites the table of blocks if a slot changed.
    fn write_table(&mut self, gpu: &Gpu) {
        let side = self.window.settings().blocks as i32;
        let mut changed = false;
        for (slot, entry) in self.entries.iter_mut().enumerate() {
            let Some(resident) = self.window.resident(slot) else { continue };
            let level = match (resident.ring, resident.level) {
                (0, _) | (_, Level::Zero) => 0,
                (_, Level::One) => 1,
                (_, Level::Own { .. }) => 2,
            };
            let first_post = [resident.block.x, resident.block.z].map(|at| at.saturating_mul(CELLS as i32));
            let new = BlockEntry { first_post, level, side };
            changed |= *entry != new;
            *entry = new;
        }
        if changed {
            gpu.queue.write_buffer(&self.table, 0, bytemuck::cast_slice(&self.entries));
        }
    }
}

fn layout_entries() -> [wgpu::BindGroupLayoutEntry; 8] {
    let vertex = wgpu::ShaderStages::VERTEX;
    let fragment = wgpu::ShaderStages::FRAGMENT;
    let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let buffer = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = |filterable, view_dimension| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable },
        view_dimension,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let flat = wgpu::TextureViewDimension::D2;
    let seen = vertex | fragment | wgpu::ShaderStages::COMPUTE;
    [
        entry(0, seen, buffer),
        entry(1, vertex | wgpu::ShaderStages::COMPUTE, buffer),
        entry(2, vertex | wgpu::ShaderStages::COMPUTE, texture(false, flat)),
        entry(3, vertex | fragment, texture(true, wgpu::TextureViewDimension::D2Array)),
        entry(4, fragment, texture(true, flat)),
        entry(5, fragment, texture(true, flat)),
        entry(6, vertex | fragment, sampler),
        entry(7, fragment, sampler),
    ]
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    textures: &TerrainTextures,
    uniforms: &wgpu::Buffer,
    table: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let whole = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
    let lights = textures.lights.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..wgpu::TextureViewDescriptor::default()
    });
    let (heights, maps, detail) = (whole(&textures.heights), whole(&textures.ground_maps), whole(&textures.detail));
    let linear = wgpu::FilterMode::Linear;
    let map_sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("maps"),
        mag_filter: linear,
        min_filter: linear,
        ..wgpu::SamplerDescriptor::default()
    });
    let detail_sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("detail"),
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: linear,
        min_filter: linear,
        mipmap_filter: wgpu::MipmapFilterMode::Nearest,
        ..wgpu::SamplerDescriptor::default()
    });
    let view = wgpu::BindingResource::TextureView;
    let resources = [
        uniforms.as_entire_binding(),
        table.as_entire_binding(),
        view(&heights),
        view(&lights),
        view(&maps),
        view(&detail),
        wgpu::BindingResource::Sampler(&map_sampler),
        wgpu::BindingResource::Sampler(&detail_sampler),
    ];
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("terrain"), layout, entries: &entries })
}

/// The pipelines for near land, far land, blocks with water, and blocks on which water is draped as well.
fn pipelines(
    gpu: &Gpu,
    frame: &wgpu::BindGroupLayout,
    window: &wgpu::BindGroupLayout,
    format: TargetFormat,
    look: TerrainLook,
) -> [wgpu::RenderPipeline; 4] {
    let device = &gpu.device;
    let module = shaders::module(device, "terrain.wgsl");
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("terrain"),
        bind_group_layouts: &[Some(frame), Some(window)],
        immediate_size: 0,
    });
    let lines = look.wireframe && gpu.draws_edges();
    let make = |vertex, fragment, detail: u32, shore: f64| {
        let constants = [
            ("TILE", f64::from(TILE)),
            ("DETAIL", f64::from(detail)),
            ("OVERLAY", f64::from(u8::from(look.overlay))),
            ("SHORE", shore),
        ];
        let options =
            wgpu::PipelineCompilationOptions { constants: &constants, ..wgpu::PipelineCompilationOptions::default() };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                compilation_options: options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState {
                cull_mode: Some(wgpu::Face::Back),
                polygon_mode: if lines { wgpu::PolygonMode::Line } else { wgpu::PolygonMode::Fill },
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
    let detail = look.detail.min(2);
    [
        make("terrain_vertex", "terrain_fragment", detail, 0.5),
        make("terrain_vertex", "terrain_fragment", 0, 0.5),
        make("water_vertex", "water_fragment", detail, 0.5),
        make("water_vertex", "water_fragment", detail, DRAPED_SHORE),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_posts_get_equal_bits_from_every_block() {
        // The shader's arithmetic, in the shader's order.
        let position =
            |first: i32, local: i32, eye: i32, fraction: f32, step: f32| (first + local - eye) as f32 * step - fraction;
        let grid = Grid::centred(200.0, 67, 67).unwrap();
        for at in 0..10_000 {
            let x = -201_000.0 + f64::from(at) * 40.2371;
            let ([column, _], [east, _]) = eye_uniforms(&grid, DVec3::new(x, 0.0, 0.0));
            assert!((0.0..=200.0).contains(&east));
            let cells = CELLS as i32;
            for block in [0, 1, 33, 66] {
                let here = position(block * cells, cells, column, east, 200.0);
                let there = position((block + 1) * cells, 0, column, east, 200.0);
                assert_eq!(here.to_bits(), there.to_bits());
                let exact = grid.x_m(i64::from((block + 1) * cells)) - x;
                // Two roundings at up to 402 km: half of 1/32 m each at worst.
                assert!((f64::from(here) - exact).abs() <= 0.032, "{here} {exact}");
            }
        }
    }
}
