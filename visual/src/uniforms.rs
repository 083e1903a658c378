//! What every shader knows of the frame: group 0 of every pipeline, for the vertex and the fragment stage.
//!
//! [`FrameUniforms`] mirrors `shaders/shared/frame.wgsl` field by field; `tests/shader_contract.rs` compares the
//! offsets. Binding 0 is the uniforms, 1 the sky table, 2 its sampler, 3 the
//! aerial table.

use crate::camera::View;
use crate::frame::Scene;
use crate::sky;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec2, Vec3};

/// The mirror of the shader's `FrameUniforms`. Light is exposed (see [`sky::Light`]).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FrameUniforms {
    /// Clip from a world position minus the eye.
    pub clip_from_relative: [[f32; 4]; 4],
    /// Eye in the world, rounded to f32, metres.
    pub eye_high_m: [f32; 3],
    /// Eye above sea level, metres.
    pub eye_altitude_m: f32,
    /// What the rounding left, metres.
    pub eye_low_m: [f32; 3],
    /// Scene time, seconds, wrapped every hour.
    pub time_s: f32,
    /// World direction through the top left corner of the picture, 1 along the axis.
    pub ray_corner: [f32; 3],
    /// Exposure asked by the scene, beside the one already in the light.
    pub exposure: f32,
    /// Added to the ray from the left edge to the right.
    pub ray_right: [f32; 3],
    /// Near plane, metres.
    pub near_m: f32,
    /// Added to the ray from the top edge to the bottom.
    pub ray_down: [f32; 3],
    /// Pixels of the scene's target per unit of tangent, vertically.
    pub focal_px: f32,
    /// Unit vector towards the key light: the sun, or the moon where that gives more.
    pub sun_direction: [f32; 3],
    /// Half the angle of the sun's disc, radians.
    pub sun_radius_rad: f32,
    /// Irradiance by the key light on a surface turned to it, near the ground.
    pub sun_irradiance: [f32; 3],
    /// Extinction of green light by molecules at sea level, per metre.
    pub molecules_per_m: f32,
    /// Irradiance by the sky on level ground.
    pub sky_irradiance: [f32; 3],
    /// Extinction by haze at its base, per metre.
    pub haze_per_m: f32,
    /// Colour of the sun's disc, brightest channel at most 1.
    pub disc: [f32; 3],
    /// Haze base above sea level, metres.
    pub haze_base_m: f32,
    /// Unit vector of the sun's azimuth: x and z.
    pub sun_level: [f32; 2],
    /// Size of the scene's target, pixels (before upscaling).
    pub viewport_px: [f32; 2],
    /// Plan distance where the ground begins to fade into the sky, metres.
    pub fade_start_m: f32,
    /// Plan distance where it is gone, metres.
    pub fade_end_m: f32,
    /// Density of molecules at the eye, 1 at sea level.
    pub eye_molecules: f32,
    /// Density of haze at the eye, 1 at the haze base.
    pub eye_haze: f32,
    /// Unit vector towards the sun itself.
    pub disc_direction: [f32; 3],
    /// Least illuminance that makes a point of light seen, lux.
    pub threshold_lux: f32,
    /// Unit vector towards the moon.
    pub moon_direction: [f32; 3],
    /// Half the angle of the moon's disc, radians; 0 where there is no moon or it is down.
    pub moon_radius_rad: f32,
    /// Unit vector from the moon to the sun.
    pub moon_to_sun: [f32; 3],
    /// 1 where the moon is the key light.
    pub moon_key: f32,
    /// Radiance of the moon's lit side as the eye sees it.
    pub moon_light: [f32; 3],
    /// Height over which haze thins by a factor e, metres.
    pub haze_scale_m: f32,
    /// Greatest distance of the aerial table, metres; 0 where there is none.
    pub aerial_reach_m: f32,
    /// Share of lamps and windows that are lit.
    pub lamps: f32,
    /// Of the moon's light, by phase.
    pub moon_share: f32,
    /// Of the sun's own elevation.
    pub sun_sin: f32,
}

impl FrameUniforms {
    /// The uniforms of one view; `scene` and `view` must be sane, `target_px` is the size drawn at.
    pub fn new(view: &View, scene: &Scene, light: &sky::Light, target_px: [u32; 2]) -> Self {
        let corner = view.ray(0.0, 0.0);
        let eye_high_m = view.eye_m.as_vec3();
        let eye_altitude_m = view.eye_m.y as f32;
        let haze_base_m = scene.haze_base_m as f32;
        let sun = scene.sun_direction.as_vec3();
        let sun_level = Vec2::new(sun.x, sun.z).try_normalize().unwrap_or(Vec2::X);
        let target = [target_px[0] as f32, target_px[1] as f32];
        let haze_scale_m = sky::haze_scale_m(scene.visibility_m);
        let to_moon = scene.moon_direction.unwrap_or(DVec3::NEG_Y);
        let moonlight = crate::moon::Moonlight::of(scene);
        let moon_is_key = light.moon_irradiance.element_sum() > light.sun_irradiance.element_sum();
        let (key, key_irradiance) =
            if moon_is_key { (to_moon.as_vec3(), light.moon_irradiance) } else { (sun, light.sun_irradiance) };
        // Half a degree below the horizon its last limb is gone; an eye on a mountain may see it a little longer.
        let moon_is_up = scene.moon_direction.is_some() && to_moon.y > -0.02;
        Self {
            clip_from_relative: view.clip_from_relative().to_cols_array_2d(),
            eye_high_m: eye_high_m.to_array(),
            eye_altitude_m,
            eye_low_m: (view.eye_m - DVec3::from(eye_high_m)).as_vec3().to_array(),
            time_s: scene.time_s.rem_euclid(3600.0) as f32,
            ray_corner: corner.as_vec3().to_array(),
            exposure: scene.exposure,
            ray_right: (view.ray(1.0, 0.0) - corner).as_vec3().to_array(),
            near_m: view.near_m as f32,
            ray_down: (view.ray(0.0, 1.0) - corner).as_vec3().to_array(),
            focal_px: target[1] / (view.top - view.bottom) as f32,
            sun_direction: key.to_array(),
            sun_radius_rad: 0.004_65,
            sun_irradiance: key_irradiance.to_array(),
            molecules_per_m: sky::MOLECULES_PER_M.y,
            sky_irradiance: light.sky_irradiance.to_array(),
            haze_per_m: sky::haze_per_m(scene.visibility_m, scene.haze_base_m),
            disc: light.disc.to_array(),
            haze_base_m,
            sun_level: sun_level.to_array(),
            viewport_px: target,
            fade_start_m: 0.85 * scene.view_range_m as f32,
            fade_end_m: scene.view_range_m as f32,
            eye_molecules: (-scales(eye_altitude_m, 0.0, sky::MOLECULE_SCALE_HEIGHT_M)).exp(),
            eye_haze: (-scales(eye_altitude_m, haze_base_m, haze_scale_m)).exp(),
            disc_direction: sun.to_array(),
            threshold_lux: light.threshold_lux,
            moon_direction: to_moon.as_vec3().to_array(),
            moon_radius_rad: if moon_is_up { 0.004_52 } else { 0.0 },
            moon_to_sun: crate::moon::to_sun_from_moon(scene.sun_direction, to_moon).as_vec3().to_array(),
            moon_key: f32::from(u8::from(moon_is_key)),
            moon_light: light.moon_disc.to_array(),
            haze_scale_m,
            aerial_reach_m: if light.aerial.is_empty() { 0.0 } else { scene.view_range_m as f32 },
            lamps: f32::from(u8::from(scene.lamps)) * sky::lamps(scene.sun_elevation_rad()),
            moon_share: moonlight.share as f32,
            sun_sin: scene.sun_direction.y as f32,
        }
    }

    /// The twin of the shader's `haze_from_eye`: share of a point's light that reaches the eye.
    pub fn haze_from_eye(&self, relative_m: Vec3) -> f32 {
        let (eye_m, point_m) = (self.eye_altitude_m, self.eye_altitude_m + relative_m.y);
        let mean = |base_m, scale_m| mean_density(scales(eye_m, base_m, scale_m), scales(point_m, base_m, scale_m));
        let per_m = self.haze_per_m * mean(self.haze_base_m, self.haze_scale_m)
            + self.molecules_per_m * mean(0.0, sky::MOLECULE_SCALE_HEIGHT_M);
        let plan_m = Vec2::new(relative_m.x, relative_m.z).length();
        let t = ((plan_m - self.fade_start_m) / (self.fade_end_m - self.fade_start_m)).clamp(0.0, 1.0);
        (-relative_m.length() * per_m).exp() * (1.0 - t * t * (3.0 - 2.0 * t))
    }
}

/// Height in scale heights above a base; nothing is denser than at its base, nothing is left at 60.
fn scales(height_m: f32, base_m: f32, scale_m: f32) -> f32 {
    ((height_m - base_m) / scale_m).clamp(0.0, 60.0)
}

/// Mean of exp(-height) between two heights: the integral in closed form, its middle value where they are close.
fn mean_density(eye: f32, point: f32) -> f32 {
    let rise = point - eye;
    if rise.abs() < 0.01 { (-0.5 * (eye + point)).exp() } else { ((-eye).exp() - (-point).exp()) / rise }
}

/// Bind group layout and resources of group 0.
pub struct FrameBindings {
    /// The layout, for the pipelines of every pass.
    pub layout: wgpu::BindGroupLayout,
    sky_table: wgpu::Texture,
    sky_view: wgpu::TextureView,
    aerial: wgpu::Texture,
    aerial_view: wgpu::TextureView,
    sky_sampler: wgpu::Sampler,
    views: Vec<(wgpu::Buffer, wgpu::BindGroup)>,
}

impl FrameBindings {
    /// Makes the layout and the sky table's texture.
    pub fn new(device: &wgpu::Device) -> Self {
        // Compute only for proofs: it reads the eye.
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: stages, ty, count: None };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("frame"),
            entries: &[
                entry(
                    0,
                    wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Uniform,
                        has_dynamic_offset: false,
                        min_binding_size: std::num::NonZeroU64::new(size_of::<FrameUniforms>() as u64),
                    },
                ),
                entry(
                    1,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                ),
                entry(2, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
                entry(
                    3,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D3,
                        multisampled: false,
                    },
                ),
            ],
        });
        let sky_table = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("sky table"),
            size: table_size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let sky_view = sky_table.create_view(&wgpu::TextureViewDescriptor::default());
        let aerial = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("aerial table"),
            size: aerial_size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let aerial_view = aerial.create_view(&wgpu::TextureViewDescriptor::default());
        let sky_sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("sky table"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        Self { layout, sky_table, sky_view, aerial, aerial_view, sky_sampler, views: Vec::new() }
    }

    /// Replaces the sky table (64 KiB) and, where there is one, the aerial table (72 KiB).
    pub fn write_sky(&self, queue: &wgpu::Queue, light: &sky::Light) {
        queue.write_texture(
            self.sky_table.as_image_copy(),
            bytemuck::cast_slice(&light.table),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(sky::TABLE_WIDTH * 8),
                rows_per_image: Some(sky::TABLE_HEIGHT),
            },
            table_size(),
        );
        if !light.aerial.is_empty() {
            queue.write_texture(
                self.aerial.as_image_copy(),
                bytemuck::cast_slice(&light.aerial),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(sky::AERIAL_SIZE[0] * 8),
                    rows_per_image: Some(sky::AERIAL_SIZE[1]),
                },
                aerial_size(),
            );
        }
    }

    /// Writes one view's uniforms and gives its bind group.
    pub fn write_view(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        index: usize,
        uniforms: &FrameUniforms,
    ) -> wgpu::BindGroup {
        while self.views.len() <= index {
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("frame"),
                size: size_of::<FrameUniforms>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("frame"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&self.sky_view) },
                    wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(&self.sky_sampler) },
                    wgpu::BindGroupEntry {
                        binding: 3,
                        resource: wgpu::BindingResource::TextureView(&self.aerial_view),
                    },
                ],
            });
            self.views.push((buffer, group));
        }
        let (buffer, group) = &self.views[index];
        queue.write_buffer(buffer, 0, bytemuck::bytes_of(uniforms));
        group.clone()
    }
}

fn aerial_size() -> wgpu::Extent3d {
    let [width, height, depth_or_array_layers] = sky::AERIAL_SIZE;
    wgpu::Extent3d { width, height, depth_or_array_layers }
}

fn table_size() -> wgpu::Extent3d {
    wgpu::Extent3d { width: sky::TABLE_WIDTH, height: sky::TABLE_HEIGHT, depth_or_array_layers: 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn uniforms(eye_m: f64, scene: &Scene) -> FrameUniforms {
        let view = View::fov_y(DVec3::new(0.0, eye_m, 0.0), DQuat::IDENTITY, 1.0, [64, 64]);
        let light = sky::Light {
            table: Vec::new(),
            sun_irradiance: Vec3::ONE,
            sky_irradiance: Vec3::ONE,
            disc: Vec3::ONE,
            exposure: 1.0,
            ..sky::Light::none()
        };
        FrameUniforms::new(&view, scene, &light, [64, 64])
    }

    #[test]
    fn contrast_at_the_visibility_is_two_percent() {
        for (visibility_m, base_m) in [(5_000.0, 0.0), (40_000.0, 1_600.0), (60_000.0, 0.0)] {
            let scene = Scene { visibility_m, haze_base_m: base_m, view_range_m: 1e7, ..Scene::default() };
            let left = uniforms(base_m, &scene).haze_from_eye(Vec3::new(0.0, 0.0, -visibility_m as f32));
            // Three decimals in 3.912, f32 sums of two extinctions.
            assert!((left - 0.02).abs() < 1e-4, "{visibility_m} {base_m}: {left}");
        }
    }

    #[test]
    fn slant_haze_equals_a_sum_over_many_steps() {
        let scene = Scene { visibility_m: 30_000.0, haze_base_m: 500.0, view_range_m: 1e7, ..Scene::default() };
        for (eye_m, point_m) in [(500.0, 9_000.0), (6_000.0, 1_000.0), (3_000.0, 3_010.0), (12_000.0, 600.0)] {
            let uniforms = uniforms(eye_m, &scene);
            let relative = Vec3::new(15_000.0, (point_m - eye_m) as f32, -4_000.0);
            let steps = 10_000;
            let depth: f64 = (0..steps)
                .map(|i| {
                    let height_m = eye_m + (point_m - eye_m) * (f64::from(i) + 0.5) / f64::from(steps);
                    let haze =
                        f64::from(uniforms.haze_per_m) * (-(height_m - 500.0) / f64::from(uniforms.haze_scale_m)).exp();
                    let molecules = f64::from(uniforms.molecules_per_m)
                        * (-height_m / f64::from(sky::MOLECULE_SCALE_HEIGHT_M)).exp();
                    (haze + molecules) * f64::from(relative.length()) / f64::from(steps)
                })
                .sum();
            let (got, want) = (f64::from(uniforms.haze_from_eye(relative)), (-depth).exp());
            assert!((got - want).abs() < 1e-5 * want.max(0.1), "{eye_m} {point_m}: {got} {want}");
        }
    }

    #[test]
    fn the_ground_is_gone_at_the_end_of_the_range_and_clear_before_the_fade() {
        let scene = Scene { visibility_m: 300_000.0, view_range_m: 60_000.0, ..Scene::default() };
        let uniforms = uniforms(8_000.0, &scene);
        assert_eq!(uniforms.haze_from_eye(Vec3::new(60_000.0, -8_000.0, 0.0)), 0.0);
        assert!(uniforms.haze_from_eye(Vec3::new(50_000.0, -8_000.0, 0.0)) > 0.5);
    }
}
