//! What the renderer draws, looked at pixel by pixel on whatever adapter there is. Without one, each test says so.

use glam::{DQuat, DVec3, Vec2, Vec3};
use visual::camera::View;
use visual::capture::{self, Offscreen, Picture};
use visual::passes::lines::Stroke;
use visual::uniforms::FrameUniforms;
use visual::{Frame, Gpu, GpuError, Layer, Renderer, Scene, Settings, shaders};

fn gpu() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}

fn frame(scene: Scene, heading_rad: f64, size_px: [u32; 2]) -> Frame {
    let attitude = terrain::frame::attitude(heading_rad, 0.0, 0.0);
    Frame { scene, views: vec![View::fov_y(DVec3::new(0.0, 3e3, 0.0), attitude, 1.0, size_px)], hud: Vec::new() }
}

fn drawn(gpu: &Gpu, frame: &Frame, settings: Settings) -> Picture {
    let target = Offscreen::new(gpu, frame.views[0].size_px).expect("target");
    let mut renderer = Renderer::new(gpu, capture::FORMAT, settings);
    renderer.render(gpu, frame, &[&target.view], |_, _, _| ()).expect("rendered");
    target.read(gpu).expect("read")
}

fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 4] {
    let at = ((y * picture.size_px[0] + x) * 4) as usize;
    [picture.rgba[at], picture.rgba[at + 1], picture.rgba[at + 2], picture.rgba[at + 3]]
}

/// Linear light of an 8-bit sRGB value (IEC 61966-2-1).
fn linear(value: f64) -> f64 {
    let v = value / 255.0;
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

#[test]
fn the_sky_meets_the_horizon_without_a_rim() {
    let Some(gpu) = gpu() else { return };
    let size = [64, 256];
    for sun_deg in [60.0_f64, 12.0, 1.0, -5.0] {
        for heading in [0.0, 1.0, 3.0] {
            let scene =
                Scene { sun_direction: terrain::frame::direction(0.0, sun_deg.to_radians()), ..Scene::default() };
            let picture = drawn(&gpu, &frame(scene, heading, size), Settings::default());
            // The mean of a row takes the dither out: 64 pixels of +-0.5 steps leave below 0.1 step.
            let row = |y: u32| (0..64).map(|x| f64::from(pixel(&picture, x, y)[1])).sum::<f64>() / 64.0;
            // Rows 127 and 128 lie 0.1 degrees above and below the horizon; ground that has faded has row 128's colour.
            let (above, below) = (linear(row(127)), linear(row(128)));
            let contrast = (above - below).abs() / (above + below);
            assert!(contrast <= 0.02, "sun {sun_deg}, heading {heading}: {contrast}");
            assert!((row(128) - row(250)).abs() < 0.2, "below the horizon all is one colour");
        }
    }
}

#[test]
fn noon_is_blue_above_night_is_dark_and_both_are_smooth() {
    let Some(gpu) = gpu() else { return };
    let sky = |sun_deg: f64| {
        let scene = Scene { sun_direction: terrain::frame::direction(3.0, sun_deg.to_radians()), ..Scene::default() };
        let picture = drawn(&gpu, &frame(scene, 0.0, [64, 64]), Settings::default());
        pixel(&picture, 32, 2)
    };
    let (noon, night) = (sky(60.0), sky(-30.0));
    assert!(noon[2] > noon[0] + 30 && noon[2] > 90, "{noon:?}");
    assert!(night[2] < 50 && night[2] > 2, "{night:?}");
}

#[test]
fn every_setting_and_size_gives_the_same_picture_within_its_sharpness() {
    let Some(gpu) = gpu() else { return };
    for size in [[1, 1], [7, 3], [257, 129]] {
        let frame = frame(Scene::default(), 0.5, size);
        let plain = drawn(&gpu, &frame, Settings::default());
        assert_eq!(plain.hash(), drawn(&gpu, &frame, Settings::default()).hash(), "{size:?}: twice");
        for settings in [
            Settings { msaa: 4, ..Settings::default() },
            Settings { render_scale: 0.67, ..Settings::default() },
            Settings { render_scale: f32::NAN, msaa: 0, ..Settings::default() },
        ] {
            let other = drawn(&gpu, &frame, settings);
            assert_eq!(other.size_px, size);
            if size[1] < 100 {
                // So few rows that the horizon's place within one decides its colour.
                continue;
            }
            let middle = [size[0] / 2, size[1] / 2];
            let (a, b) = (pixel(&plain, middle[0], middle[1]), pixel(&other, middle[0], middle[1]));
            // A coarser grid shifts the horizon's gradient by up to a pixel.
            assert!(a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 12), "{size:?} {settings:?}: {a:?} {b:?}");
        }
    }
}

#[test]
fn nonsense_is_refused_or_drawn_but_never_fatal() {
    let Some(gpu) = gpu() else { return };
    for size in [[0, 10], [10, 0], [100_000, 10]] {
        assert!(matches!(Offscreen::new(&gpu, size), Err(GpuError::Size { .. })), "{size:?}");
    }
    let broken = Scene {
        moon_direction: Some(DVec3::NAN),
        sun_direction: DVec3::NAN,
        visibility_m: f64::NAN,
        haze_base_m: f64::INFINITY,
        view_range_m: -1.0,
        exposure: f32::NAN,
        lamps: true,
        time_s: f64::NEG_INFINITY,
    };
    for eye_m in [DVec3::NAN, DVec3::new(1e7, 1e6, -1e7), DVec3::new(0.0, -11_000.0, 0.0)] {
        for attitude in
            [DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), DQuat::IDENTITY, DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2)]
        {
            let mut frame = frame(broken, 0.0, [16, 16]);
            frame.views[0].eye_m = eye_m;
            frame.views[0].attitude = attitude;
            let picture = drawn(&gpu, &frame, Settings::default());
            // From 1,000 km up the sky is rightly black; elsewhere it is not.
            assert!(pixel(&picture, 8, 2)[2] > 0 || eye_m.y > 6e4, "{eye_m} {attitude}");
        }
    }
    let target = Offscreen::new(&gpu, [16, 16]).expect("target");
    let mut renderer = Renderer::new(&gpu, capture::FORMAT, Settings::default());
    let empty = Frame { scene: Scene::default(), views: Vec::new(), hud: Vec::new() };
    renderer.render(&gpu, &empty, &[&target.view], |_, _, _| ()).expect("no views, no work");
    let mut zero = frame(Scene::default(), 0.0, [16, 16]);
    zero.views[0].size_px = [0, 16];
    assert!(matches!(renderer.render(&gpu, &zero, &[&target.view], |_, _, _| ()), Err(GpuError::Size { .. })));
}

#[test]
fn a_stroke_lies_where_it_was_put_with_a_dark_edge() {
    let Some(gpu) = gpu() else { return };
    for settings in [Settings::default(), Settings { render_scale: 0.5, ..Settings::default() }] {
        let mut frame = frame(Scene::default(), 0.0, [64, 64]);
        let without = drawn(&gpu, &frame, settings);
        let points_px = vec![Vec2::new(20.5, 5.0), Vec2::new(20.5, 60.0)];
        frame.hud.push(Stroke { points_px, width_px: 2.0, colour: [1.0, 0.0, 0.0, 1.0] });
        let with = drawn(&gpu, &frame, settings);
        let [red, green, blue, _] = pixel(&with, 20, 30);
        assert!(red > 250 && green < 5 && blue < 5, "the line's middle");
        assert!(pixel(&with, 22, 30)[2] < pixel(&without, 22, 30)[2] - 20, "the halo");
        assert_eq!(pixel(&with, 30, 30), pixel(&without, 30, 30), "elsewhere nothing changes");
    }
}

/// Draws the shader's own haze as grey, one column a distance and one row a height, through the caller's closure.
const HAZE_AS_GREY: &str = r#"
//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32((index << 1u) & 2u) * 2.0 - 1.0, 1.0 - f32(index & 2u) * 2.0, 0.5, 1.0);
}
@fragment
fn grey(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let relative_m = vec3<f32>(at.x * 1000.0, at.y * 200.0 - 4000.0, -at.x * 500.0);
    return vec4<f32>(vec3<f32>(haze_from_eye(relative_m)), 1.0);
}
"#;

#[test]
fn the_shaders_haze_is_its_twins_and_solid_things_hide_the_sky() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { haze_base_m: 500.0, visibility_m: 40_000.0, ..Scene::default() };
    let frame = frame(scene, 0.0, [64, 64]);
    let target = Offscreen::new(&gpu, [64, 64]).expect("target");
    let settings = Settings { keep_depth: true, ..Settings::default() };
    let mut renderer = Renderer::new(&gpu, capture::FORMAT, settings);
    let device = &gpu.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(shaders::join(HAZE_AS_GREY).into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(renderer.frame_layout())],
        immediate_size: 0,
    });
    let format = renderer.scene_format();
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("cover"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: format.depth_state(visual::camera::DEPTH_COMPARE, true),
        multisample: format.multisample(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("grey"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(format.colour.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    renderer
        .render(&gpu, &frame, &[&target.view], |_, layer, pass| {
            if layer != Layer::Solid {
                return;
            }
            pass.set_pipeline(&pipeline);
            pass.draw(0..3, 0..1);
        })
        .expect("rendered");
    let picture = target.read(&gpu).expect("read");
    let light = renderer.light().expect("light");
    let uniforms = FrameUniforms::new(&frame.views[0], &scene, light, [64, 64]);
    for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let twin = f64::from(uniforms.haze_from_eye(Vec3::new(at.x * 1e3, at.y * 200.0 - 4e3, -at.x * 500.0)));
        let [red, ..] = pixel(&picture, x, y).map(f64::from);
        // The target keeps 8 bits: half a step, and a little for the device's own exp and sRGB curve.
        let (low, high) = (linear((red - 0.75).max(0.0)), linear((red + 0.75).min(255.0)));
        assert!((low..=high).contains(&twin) || (twin - linear(red)).abs() < 2e-4, "{x} {y}: {twin} {}", linear(red));
    }
    let depth = capture::read_depth(&gpu, renderer.depth(0).expect("kept")).expect("read");
    assert!(depth.len() == 64 * 64 && depth.iter().all(|&d| d == 0.5));
}
