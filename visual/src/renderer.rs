//! Draws a [`Frame`]: solid things, then the sky behind them, then the strokes over them.
//!
//! At render scale 1 everything is drawn in one pass straight into the final target (through a multisampled texture
//! where MSAA is on). Below 1 the scene is drawn small, then stretched over the final target, and strokes are drawn at
//! full resolution in that second pass. Shaders write display colour themselves; there is no HDR target between.
//!
//! What a scene holds is drawn by the caller's closure, inside the scene's pass and with group 0 bound: once for
//! [`Layer::Solid`] before the sky, once for [`Layer::Blended`] after it. Its pipelines are made for
//! [`Renderer::scene_format`] and [`Renderer::frame_layout`].

use crate::camera::{DEPTH_CLEAR, DEPTH_FORMAT, View};
use crate::frame::{Frame, Scene};
use crate::gpu::{Gpu, GpuError};
use crate::passes::TargetFormat;
use crate::passes::lines::LinesPass;
use crate::passes::sky::SkyPass;
use crate::passes::upscale::UpscalePass;
use crate::sky::HazeGrade;
use crate::sky_feed::SkyFeed;
use crate::uniforms::{FrameBindings, FrameUniforms};

/// How a picture is made; a change needs a new renderer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Samples a pixel, 1 or 4 (anything else becomes the nearer of the two).
    pub msaa: u32,
    /// Edge of the drawn picture over the edge of the final one, 0.25 to 1.
    pub render_scale: f32,
    /// Keeps the depth after the pass, so that it can be read back; needs `msaa` 1.
    pub keep_depth: bool,
    /// Sky tables are computed by a thread of their own and arrive a few frames late; false waits for each, so that
    /// the same frames give the same pictures.
    pub sky_in_background: bool,
    /// How light scattered on the way from the ground is found.
    pub haze: HazeGrade,
}

impl Default for Settings {
    fn default() -> Self {
        Self { msaa: 1, render_scale: 1.0, keep_depth: false, sky_in_background: false, haze: HazeGrade::Table }
    }
}

impl Settings {
    fn sane(self) -> Self {
        let render_scale = if self.render_scale.is_finite() { self.render_scale.clamp(0.25, 1.0) } else { 1.0 };
        // So near to 1 that a pass more would cost more than it saves.
        let render_scale = if render_scale > 0.98 { 1.0 } else { render_scale };
        Self { msaa: if self.msaa >= 3 { 4 } else { 1 }, render_scale, ..self }
    }
}

/// Makes pictures of frames on one device.
pub struct Renderer {
    settings: Settings,
    colour: wgpu::TextureFormat,
    bindings: FrameBindings,
    feed: SkyFeed,
    sky: SkyPass,
    lines: LinesPass,
    upscale: Option<UpscalePass>,
    targets: Vec<Targets>,
}

/// The textures of one view, remade when its size changes.
struct Targets {
    final_px: [u32; 2],
    scene_px: [u32; 2],
    depth: wgpu::Texture,
    depth_view: wgpu::TextureView,
    multisampled: Option<wgpu::TextureView>,
    small: Option<(wgpu::TextureView, wgpu::BindGroup)>,
}

/// When in a view's pass something is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Before the sky, with depth written.
    Solid,
    /// After the sky, blended over what is there, depth tested and not written: lights, particles.
    Blended,
}

/// What a pass of the scene may need to know of the view it draws, beside group 0.
pub struct SceneView<'a> {
    /// Which of the frame's views.
    pub index: usize,
    /// The view itself.
    pub view: &'a View,
    /// Size of the target that the scene is drawn to, pixels.
    pub target_px: [u32; 2],
    /// Group 0, already bound; bind it again after a pipeline that had another.
    pub frame_group: &'a wgpu::BindGroup,
}

impl Renderer {
    /// Makes pipelines for a final target of this colour format, which should be an sRGB one.
    pub fn new(gpu: &Gpu, colour: wgpu::TextureFormat, settings: Settings) -> Self {
        let settings = settings.sane();
        let device = &gpu.device;
        let bindings = FrameBindings::new(device);
        let scene = TargetFormat { colour, depth: Some(DEPTH_FORMAT), samples: settings.msaa };
        let last = TargetFormat { colour, depth: None, samples: 1 };
        let small = settings.render_scale < 1.0;
        Self {
            settings,
            colour,
            sky: SkyPass::new(device, &bindings.layout, scene),
            lines: LinesPass::new(device, if small { last } else { scene }),
            upscale: small.then(|| UpscalePass::new(device, last)),
            feed: SkyFeed::new(settings.sky_in_background, settings.haze),
            bindings,
            targets: Vec::new(),
        }
    }

    /// Layout of group 0, for pipelines of solid passes.
    pub fn frame_layout(&self) -> &wgpu::BindGroupLayout {
        &self.bindings.layout
    }

    /// Formats and samples of the scene's pass, for pipelines of solid passes.
    pub fn scene_format(&self) -> TargetFormat {
        TargetFormat { colour: self.colour, depth: Some(DEPTH_FORMAT), samples: self.settings.msaa }
    }

    /// Size that a final picture's scene is drawn at.
    pub fn scene_px(&self, final_px: [u32; 2]) -> [u32; 2] {
        final_px.map(|edge| ((edge as f32 * self.settings.render_scale).round() as u32).max(1))
    }

    /// The depth of a view as last drawn (`keep_depth`), for reading back.
    pub fn depth(&self, view_index: usize) -> Option<&wgpu::Texture> {
        let kept = self.settings.keep_depth && self.settings.msaa == 1;
        self.targets.get(view_index).filter(|_| kept).map(|targets| &targets.depth)
    }

    /// The light of the last frame drawn.
    pub fn light(&self) -> Option<&crate::sky::Light> {
        self.feed.light()
    }

    /// Draws each view into its target and submits. Views without a target, and targets without a view, are left.
    ///
    /// `draw` draws inside the scene's pass, a layer at a time, with group 0 bound; it may draw nothing.
    ///
    /// # Errors
    /// [`GpuError::Size`] for a view that is empty or too large, and what the device reports ([`Gpu::check`]).
    pub fn render(
        &mut self,
        gpu: &Gpu,
        frame: &Frame,
        targets: &[&wgpu::TextureView],
        mut draw: impl FnMut(&SceneView<'_>, Layer, &mut wgpu::RenderPass<'_>),
    ) -> Result<(), GpuError> {
        let scene = frame.scene.sane();
        let altitude_m = frame.views.first().map_or(0.0, |view| view.eye_m.y);
        if self.feed.update(&scene, altitude_m)
            && let Some(light) = self.feed.light()
        {
            self.bindings.write_sky(&gpu.queue, light);
        }
        if let Some(view) = frame.views.first() {
            self.lines.prepare(&gpu.device, &gpu.queue, &frame.hud, view.size_px);
        }
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        for (index, (view, target)) in frame.views.iter().zip(targets).enumerate() {
            gpu.check_size(view.size_px)?;
            self.fit(gpu, index, view.size_px);
            self.draw_view(gpu, &mut encoder, &scene, index, view, target, &mut draw);
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.check()
    }

    fn draw_view(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        index: usize,
        view: &View,
        target: &wgpu::TextureView,
        draw: &mut impl FnMut(&SceneView<'_>, Layer, &mut wgpu::RenderPass<'_>),
    ) {
        let Some(light) = self.feed.light() else { return };
        // An insane view would reach the shader as NaN; the sky straight ahead is a picture, garbage is not.
        let safe = if view.is_sane() {
            *view
        } else {
            View::fov_y(glam::DVec3::ZERO, glam::DQuat::IDENTITY, 1.0, view.size_px)
        };
        let targets = &self.targets[index];
        let uniforms = FrameUniforms::new(&safe, scene, light, targets.scene_px);
        let frame_group = self.bindings.write_view(&gpu.device, &gpu.queue, index, &uniforms);

        let drawn = targets.small.as_ref().map_or(target, |(small, _)| small);
        let (view_drawn, resolve_target) = match &targets.multisampled {
            Some(multisampled) => (multisampled, Some(drawn)),
            None => (drawn, None),
        };
        let keep = |kept| if kept { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: view_drawn,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: keep(resolve_target.is_none()),
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth_view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(DEPTH_CLEAR),
                    store: keep(self.settings.keep_depth),
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &frame_group, &[]);
        let about = SceneView { index, view: &safe, target_px: targets.scene_px, frame_group: &frame_group };
        draw(&about, Layer::Solid, &mut pass);
        pass.set_bind_group(0, &frame_group, &[]);
        self.sky.draw(&mut pass, uniforms.moon_radius_rad > 0.0);
        draw(&about, Layer::Blended, &mut pass);
        pass.set_bind_group(0, &frame_group, &[]);
        if targets.small.is_none() && index == 0 {
            self.lines.draw(&mut pass);
        }
        drop(pass);

        if let (Some((_, small)), Some(upscale)) = (&targets.small, &self.upscale) {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("upscale"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    // Every pixel is written; a clear is cheaper than a load.
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            upscale.draw(&mut pass, small);
            if index == 0 {
                self.lines.draw(&mut pass);
            }
        }
    }

    /// Makes the textures of a view where there are none of its size.
    fn fit(&mut self, gpu: &Gpu, index: usize, final_px: [u32; 2]) {
        if self.targets.get(index).is_some_and(|targets| targets.final_px == final_px) {
            return;
        }
        let scene_px = self.scene_px(final_px);
        let texture = |label, format: wgpu::TextureFormat, samples, usage, view_formats: &[wgpu::TextureFormat]| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: scene_px[0], height: scene_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats,
            })
        };
        let whole = wgpu::TextureViewDescriptor::default();
        let samples = self.settings.msaa;
        let readable = self.settings.keep_depth && samples == 1;
        let depth_usage = if readable { wgpu::TextureUsages::COPY_SRC } else { wgpu::TextureUsages::empty() };
        let depth = texture("scene depth", DEPTH_FORMAT, samples, depth_usage, &[]);
        let multisampled = (samples > 1).then(|| {
            texture("scene samples", self.colour, samples, wgpu::TextureUsages::empty(), &[]).create_view(&whole)
        });
        let small = self.upscale.as_ref().map(|upscale| {
            let usage = wgpu::TextureUsages::TEXTURE_BINDING;
            let plain = self.colour.remove_srgb_suffix();
            let small = texture("small scene", self.colour, 1, usage, &[plain]);
            let view = small.create_view(&whole);
            let encoded = small.create_view(&wgpu::TextureViewDescriptor {
                format: Some(plain),
                usage: Some(usage),
                ..wgpu::TextureViewDescriptor::default()
            });
            let group = upscale.bind(&gpu.device, &encoded);
            (view, group)
        });
        let depth_view = depth.create_view(&whole);
        let made = Targets { final_px, scene_px, depth, depth_view, multisampled, small };
        // Views come in order, so the index is at most one past the end.
        match self.targets.get_mut(index) {
            Some(targets) => *targets = made,
            None => self.targets.push(made),
        }
    }
}
