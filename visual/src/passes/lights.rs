//! Draws points of light: airfields, obstructions, towns by night. Shader: `shaders/lights.wgsl`.
//!
//! Lights come in tiles, made off the render thread ([`NearTiles`]), a vertex buffer and a draw a tile. In a tile of an
//! airfield the lights that are lit by day come first, in a tile of a town those of low rank, so that a prefix is drawn by
//! day or from afar. Lamps of towns are placed only once it is dark. A world without lights has no pass ([`Lights::new`]).
//!
//! Invariant: a light lies at `(post - eye_post) * step - eye_fraction + local` east and south and `height - eye` up, as
//! the ground's vertices do, and its height is the ground query's with the light's own height added.

use super::TargetFormat;
use super::terrain::eye_uniforms;
use super::upload::filled;
use crate::camera::View;
use crate::gpu::Gpu;
use crate::shaders;
use crate::sky;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Vec3};
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};
use terrain::edit::Changed;
use terrain::features::cover::Cover;
use terrain::features::light_point::{Beam, LightPoint, Lit};
use terrain::features::model::Features;
use terrain::features::{airfield_lights, settlement_lights::Lamps};
use terrain::near::{Change, NearTiles, Settings, TileIndex};
use terrain::{Area, Grid};

/// Side of a tile, metres.
const SIDE_M: f64 = 3_000.0;
/// Most bytes taken over in a frame.
const BUDGET_BYTES: usize = 192 << 10;
/// Lamps of towns are thinned beyond this, metres.
const THIN_FROM_M: f64 = 9_000.0;
/// The least share of lamps that is left.
const THINNEST: f64 = 1.0 / 12.0;
/// Airfields are, below this, radians, or where one sees less than [`AIRFIELD_DIM_M`].
const AIRFIELD_DARK_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// See [`AIRFIELD_DARK_RAD`]; metres.
const AIRFIELD_DIM_M: f64 = 5_000.0;

/// How far lights are kept, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Airfields and obstructions.
    pub airfields_m: f64,
    /// Towns.
    pub towns_m: f64,
    /// Wait for every tile.
    pub wait: bool,
}

/// Which lights are lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dark {
    /// All of an airfield's, not only those of its approach.
    pub airfields: bool,
    /// Some lamps of towns at least; the shader has the share of them.
    pub towns: bool,
    /// Share of their intensity that runway and approach lights are set to: all by day, 4 % in a clear night, more in
    /// poor visibility (stages after ICAO Annex 14, 5.3.1.10).
    pub directed: f32,
}

impl Default for Dark {
    /// Broad day.
    fn default() -> Self {
        Self { airfields: false, towns: false, directed: 1.0 }
    }
}

impl Dark {
    /// Under a sun at an elevation (radians), in air of a visibility (metres).
    pub fn of(sun_elevation_rad: f64, visibility_m: f64) -> Self {
        let night = ((2.0 - sun_elevation_rad.to_degrees()) / 10.0).clamp(0.0, 1.0);
        let least: f64 = if visibility_m < AIRFIELD_DIM_M { 0.3 } else { 0.04 };
        Self {
            directed: least.powf(night) as f32,
            airfields: sun_elevation_rad < AIRFIELD_DARK_RAD || visibility_m < AIRFIELD_DIM_M,
            towns: sky::lamps(sun_elevation_rad) > 0.0,
        }
    }
}

/// Mirror of the shader's `LightsUniforms`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct LightsUniforms {
    /// Column and row of the post north-west of the eye.
    pub eye_post: [i32; 2],
    /// The eye's east and south of that post, metres.
    pub eye_fraction_m: [f32; 2],
    /// Metres between posts.
    pub step_m: f32,
    /// Beyond this lights with a rank are thinned, metres.
    pub thin_from_m: f32,
    /// The least share of them that is left.
    pub thinnest: f32,
    /// Share of their intensity that lights with a beam are set to.
    pub directed: f32,
}

/// Mirror of the shader's `Light`: one instance.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct LightInstance {
    /// Column and row of the post north-west of it.
    pub post: [i32; 2],
    /// East and south of that post, metres.
    pub local_m: [f32; 2],
    /// Above sea level, metres, and intensity, candela.
    pub height: [f32; 2],
    /// Half angles across and upright, radians; a slope's transition for the second.
    pub half_rad: [f32; 2],
    /// Along the beam, of 32767; the fourth is the rank.
    pub axis: [i16; 4],
    /// In front; the fourth is the kind.
    pub colour: [u8; 4],
    /// Behind; the fourth is the period in tenths of a second.
    pub back: [u8; 4],
}

const ATTRIBUTES: [wgpu::VertexAttribute; 7] = wgpu::vertex_attr_array![
    0 => Sint32x2, 1 => Float32x2, 2 => Float32x2, 3 => Float32x2, 4 => Snorm16x4, 5 => Unorm8x4, 6 => Unorm8x4
];

impl LightInstance {
    /// Of a light and its rank (0 for a light that is never thinned); `None` where there is no ground.
    pub fn new(area: &Area, light: &LightPoint, rank: f32) -> Option<Self> {
        let height_m = light.height_m(area)?;
        let ([column, row], local_m) = eye_uniforms(area.grid(), DVec3::new(light.at.x, 0.0, light.at.y));
        let byte = |share: f32| (share * 255.0).round() as u8;
        let colour = |[red, green, blue]: [f32; 3], fourth| [byte(red), byte(green), byte(blue), fourth];
        let (kind, second_rad, period_s) = match light.beam {
            Beam::Even => (0, light.half_rad[1], 0.0),
            Beam::TwoSided => (1, light.half_rad[1], 0.0),
            Beam::Slope { transition_rad } => (2, transition_rad, 0.0),
            Beam::Beside => (4, light.half_rad[1], 0.0),
            Beam::Turning { period_s } => (3, light.half_rad[1], period_s),
        };
        let part = |share: f64| (share * 32_767.0).round() as i16;
        Some(Self {
            post: [column, row],
            local_m,
            height: [height_m as f32, light.intensity_cd],
            half_rad: [light.half_rad[0].max(1e-5), second_rad.max(1e-5)],
            axis: [part(light.axis.x), part(light.axis.y), part(light.axis.z), part(f64::from(rank))],
            colour: colour(light.colour, kind),
            back: colour(light.back, (period_s * 10.0).round() as u8),
        })
    }
}

/// What the thread makes of a tile.
struct Made {
    instances: Vec<LightInstance>,
    /// How many of the first are lit by day.
    by_day: u32,
    /// Least and greatest height, metres.
    range_m: [f32; 2],
}

impl Made {
    fn new(area: &Area, mut lights: Vec<(LightPoint, f32)>) -> Self {
        lights.sort_by_key(|(light, _)| light.lit);
        let stands = |(light, rank): &(LightPoint, f32)| {
            LightInstance::new(area, light, *rank).map(|instance| (light.lit, instance))
        };
        let standing: Vec<_> = lights.iter().filter_map(stands).collect();
        let by_day = standing.iter().filter(|(lit, _)| *lit == Lit::Always).count() as u32;
        let instances: Vec<_> = standing.into_iter().map(|(_, instance)| instance).collect();
        let heights = || instances.iter().map(|instance| instance.height[0]);
        let range_m = [heights().fold(f32::INFINITY, f32::min), heights().fold(f32::NEG_INFINITY, f32::max)];
        Self { instances, by_day, range_m }
    }

    fn bytes(&self) -> usize {
        self.instances.len() * size_of::<LightInstance>()
    }
}

/// Tiles of one kind of lights and their buffers.
struct Tiles {
    near: NearTiles<Made>,
    shown: BTreeMap<TileIndex, Shown>,
}

struct Shown {
    buffer: wgpu::Buffer,
    count: u32,
    by_day: u32,
    range_m: [f32; 2],
}

/// Lights of airfields with their ranks, by tile.
type ByTile = BTreeMap<(i32, i32), Vec<(LightPoint, f32)>>;

fn airfields_maker(area: Area, lights: Arc<ByTile>) -> impl Fn(TileIndex) -> Made + Send + 'static {
    move |tile| Made::new(&area, lights.get(&(tile.x, tile.z)).cloned().unwrap_or_default())
}

/// Lamps are placed by the tiles' own thread, once.
fn towns_maker(
    grid: Grid,
    area: Area,
    features: Arc<Features>,
    cover: Arc<Cover>,
) -> impl Fn(TileIndex) -> Made + Send + 'static {
    let lamps = OnceLock::new();
    move |tile| {
        let corner = DVec2::new(grid.west_m, grid.north_m);
        let lamps = lamps.get_or_init(|| Lamps::new(&features, &cover, corner, SIDE_M));
        Made::new(&area, lamps.tile(tile.x, tile.z))
    }
}

impl Tiles {
    fn new(grid: &Grid, reach_m: f64, wait: bool, make: impl Fn(TileIndex) -> Made + Send + 'static) -> Self {
        let settings = Settings { side_m: SIDE_M, reach_m, budget_bytes: BUDGET_BYTES, wait };
        Self { near: NearTiles::new(grid, settings, Made::bytes, make), shown: BTreeMap::new() }
    }

    fn follow(&mut self, gpu: &Gpu, eye: DVec2, speed_mps: f64) {
        for change in self.near.update(eye, speed_mps) {
            match change {
                Change::Arrived(tile, made) if !made.instances.is_empty() => {
                    let bytes = bytemuck::cast_slice(&made.instances);
                    let buffer = filled(gpu, "lights", bytes, wgpu::BufferUsages::VERTEX);
                    let count = made.instances.len() as u32;
                    self.shown.insert(tile, Shown { buffer, count, by_day: made.by_day, range_m: made.range_m });
                }
                Change::Arrived(tile, _) | Change::Left(tile) => drop(self.shown.remove(&tile)),
            }
        }
    }

    /// Tiles that a view may see and how many of their lights, by a rule for a tile and its distance.
    fn seen(&self, view: &View, rule: impl Fn(&Shown, f64) -> u32, draws: &mut Vec<(wgpu::Buffer, u32)>) {
        let frustum = view.frustum();
        for (tile, shown) in &self.shown {
            let corner = self.near.corner_m(*tile) - DVec2::new(view.eye_m.x, view.eye_m.z);
            let [low_m, high_m] = shown.range_m.map(|height_m| f64::from(height_m) - view.eye_m.y);
            // A halo is wider than its light, but not by more than this.
            let low = DVec3::new(corner.x, low_m, corner.y).as_vec3() - Vec3::splat(50.0);
            let high = DVec3::new(corner.x + SIDE_M, high_m, corner.y + SIDE_M).as_vec3() + Vec3::splat(50.0);
            let count = rule(shown, self.near.distance_m(DVec2::new(view.eye_m.x, view.eye_m.z), *tile));
            if count > 0 && frustum.may_see_box(low, high) {
                draws.push((shown.buffer.clone(), count.min(shown.count)));
            }
        }
    }
}

/// See the module.
pub struct Lights {
    grid: Grid,
    area: Area,
    features: Arc<Features>,
    cover: Arc<Cover>,
    reach: Reach,
    dark: Dark,
    airfields: Option<Tiles>,
    airfield_lights: Arc<ByTile>,
    towns: Option<Tiles>,
    pipeline: wgpu::RenderPipeline,
    uniforms: wgpu::Buffer,
    group: wgpu::BindGroup,
    draws: Vec<Vec<(wgpu::Buffer, u32)>>,
}

impl Lights {
    /// The lights of a world; `None` where it has nothing that could be lit.
    pub fn new(
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        format: TargetFormat,
        area: Area,
        features: Arc<Features>,
        cover: Arc<Cover>,
        reach: Reach,
    ) -> Option<Self> {
        let points = airfield_lights::all(&features);
        let towns = !features.roads.is_empty() || !features.buildings.is_empty();
        if points.is_empty() && !towns {
            return None;
        }
        let device = &gpu.device;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("lights"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: std::num::NonZeroU64::new(size_of::<LightsUniforms>() as u64),
                },
                count: None,
            }],
        });
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("lights"),
            size: size_of::<LightsUniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("lights"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() }],
        });
        let grid = *area.grid();
        let airfields = (!points.is_empty()).then(|| {
            let mut by_tile = ByTile::new();
            for light in points {
                let tile = (light.at - DVec2::new(grid.west_m, grid.north_m)) / SIDE_M;
                by_tile.entry((tile.x.floor() as i32, tile.y.floor() as i32)).or_default().push((light, 0.0));
            }
            Arc::new(by_tile)
        });
        let make = |lights: &Arc<ByTile>| airfields_maker(area.clone(), lights.clone());
        let airfield_lights = airfields.clone();
        let airfields = airfields.as_ref().map(|lights| Tiles::new(&grid, reach.airfields_m, reach.wait, make(lights)));
        Some(Self {
            pipeline: pipeline(device, frame, &layout, format),
            grid,
            area,
            features,
            cover,
            reach,
            dark: Dark::default(),
            airfields,
            airfield_lights: airfield_lights.unwrap_or_default(),
            towns: None,
            uniforms,
            group,
            draws: Vec::new(),
        })
    }

    /// Takes over a new version of the ground.
    pub fn set_area(&mut self, area: &Area, changed: &Changed) {
        self.area = area.clone();
        if let Some(tiles) = &mut self.airfields {
            tiles.near.remake_where(changed, airfields_maker(area.clone(), self.airfield_lights.clone()));
        }
        if let Some(towns) = &mut self.towns {
            let make = towns_maker(self.grid, area.clone(), self.features.clone(), self.cover.clone());
            towns.near.remake_where(changed, make);
        }
    }

    /// Streams the tiles about the eye; lamps of towns from the first dark on.
    pub fn follow(&mut self, gpu: &Gpu, eye_m: DVec3, speed_mps: f64, dark: Dark) {
        self.dark = dark;
        let eye = DVec2::new(eye_m.x, eye_m.z);
        if let Some(tiles) = &mut self.airfields {
            tiles.follow(gpu, eye, speed_mps);
        }
        if dark.towns && (!self.features.roads.is_empty() || !self.features.buildings.is_empty()) {
            let towns = self.towns.get_or_insert_with(|| {
                let make = towns_maker(self.grid, self.area.clone(), self.features.clone(), self.cover.clone());
                Tiles::new(&self.grid, self.reach.towns_m, self.reach.wait, make)
            });
            towns.follow(gpu, eye, speed_mps);
        }
    }

    /// Chooses what a view may see and writes where the eye is. All views of a frame share one eye.
    pub fn prepare(&mut self, gpu: &Gpu, view_index: usize, view: &View) {
        let dark = self.dark;
        let mut draws = Vec::new();
        if let Some(tiles) = &self.airfields {
            let lit = |tile: &Shown, _| if dark.airfields { tile.count } else { tile.by_day };
            tiles.seen(view, lit, &mut draws);
        }
        if let Some(tiles) = self.towns.as_ref().filter(|_| dark.towns) {
            // The shader lets a rank fade out an eighth beyond what it keeps; a rank is even in 0..1.
            let lit = |tile: &Shown, distance_m: f64| {
                let keep = (THIN_FROM_M / distance_m.max(THIN_FROM_M)).powi(2).max(THINNEST);
                (f64::from(tile.count) * keep * 1.3).ceil() as u32 + 8
            };
            tiles.seen(view, lit, &mut draws);
        }
        if self.draws.len() <= view_index {
            self.draws.resize(view_index + 1, Vec::new());
        }
        if view_index == 0 && !draws.is_empty() {
            let (eye_post, eye_fraction_m) = eye_uniforms(&self.grid, view.eye_m);
            let (step_m, thin_from_m) = (self.grid.step_m as f32, THIN_FROM_M as f32);
            let thinnest = THINNEST as f32;
            let uniforms =
                LightsUniforms { eye_post, eye_fraction_m, step_m, thin_from_m, thinnest, directed: dark.directed };
            gpu.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&uniforms));
        }
        self.draws[view_index] = draws;
    }

    /// Records a prepared view's lights; group 0 must be bound. Group 1 is replaced.
    pub fn draw(&self, view_index: usize, pass: &mut wgpu::RenderPass<'_>) {
        let draws = self.draws.get(view_index).map_or(&[][..], Vec::as_slice);
        if draws.is_empty() {
            return;
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        for (buffer, count) in draws {
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..4, 0..*count);
        }
    }

    /// Bytes on the GPU.
    pub fn gpu_bytes(&self) -> usize {
        let tiles = self.airfields.iter().chain(&self.towns).flat_map(|tiles| tiles.shown.values());
        tiles.map(|tile| tile.buffer.size() as usize).sum::<usize>() + self.uniforms.size() as usize
    }

    /// Lights that the last prepared views send, for reports.
    pub fn drawn(&self) -> u64 {
        self.draws.iter().flatten().map(|(_, count)| u64::from(*count)).sum()
    }
}

fn pipeline(
    device: &wgpu::Device,
    frame: &wgpu::BindGroupLayout,
    own: &wgpu::BindGroupLayout,
    format: TargetFormat,
) -> wgpu::RenderPipeline {
    let module = shaders::module(device, "lights.wgsl");
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("lights"),
        bind_group_layouts: &[Some(frame), Some(own)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("lights"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("lights_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<LightInstance>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &ATTRIBUTES,
            })],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: format.depth_state(wgpu::CompareFunction::GreaterEqual, false),
        multisample: format.multisample(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("lights_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: format.colour,
                // Alpha 0 in premultiplied blending adds.
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::features::light_point::{RED, WHITE};
    use terrain::{Field, Ground};

    fn area() -> Area {
        let grid = Grid::centred(200.0, 2, 2).expect("grid");
        let heights = (0..grid.posts()).map(|at| 700.0 + ((at * 7919) % 2_613) as f32).collect();
        Ground::new(Arc::new(Field::new(grid, heights).expect("field"))).whole()
    }

    #[test]
    fn an_instance_lies_within_a_millimetre_of_its_light() {
        let area = area();
        let grid = *area.grid();
        for number in 0..1_000 {
            let at = DVec2::new(f64::from(number) * 11.37 - 5_600.0, 5_500.0 - f64::from(number) * 10.91);
            let light = LightPoint::even(at, 0.35, WHITE, 100.0);
            let instance = LightInstance::new(&area, &light, 0.0).expect("on the ground");
            let x_m = grid.west_m + f64::from(instance.post[0]) * grid.step_m + f64::from(instance.local_m[0]);
            let z_m = grid.north_m + f64::from(instance.post[1]) * grid.step_m + f64::from(instance.local_m[1]);
            let ground_m = area.height_m(at.x, at.y).expect("ground");
            // Half the last digit of an f32: below 200 m in plan 0.008 mm, below 4,096 m of height 0.122 mm.
            assert!((x_m - at.x).abs() < 1e-5 && (z_m - at.y).abs() < 1e-5);
            assert!((f64::from(instance.height[0]) - ground_m - f64::from(0.35_f32)).abs() < 1.3e-4);
        }
        let beyond = LightPoint::even(DVec2::splat(1e7), 1.0, RED, 1.0);
        assert_eq!(LightInstance::new(&area, &beyond, 0.0), None);
    }

    #[test]
    fn what_is_lit_by_day_comes_first() {
        let area = area();
        let light = |x: f64, lit| (LightPoint { lit, ..LightPoint::even(DVec2::new(x, 0.0), 1.0, RED, x as f32) }, 0.0);
        let made = Made::new(&area, vec![light(1.0, Lit::Dusk), light(2.0, Lit::Always), light(3.0, Lit::Always)]);
        assert_eq!(made.by_day, 2);
        assert_eq!(made.instances.iter().map(|i| i.height[1]).collect::<Vec<_>>(), [2.0, 3.0, 1.0]);
        assert_eq!(Dark::of(0.5, 60_000.0), Dark::default());
        let night = Dark::of(-0.3, 60_000.0);
        assert!(night.airfields && night.towns && (night.directed - 0.04).abs() < 1e-6);
        assert_eq!(Dark::of(0.5, 800.0), Dark { airfields: true, ..Dark::default() });
    }
}
