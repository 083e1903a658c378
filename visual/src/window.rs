//! A window: opens it, keeps its surface usable, and hands plain events and frames to one callback.
//!
//! The callback gets [`Call::Ready`] whenever there is a new device (at the start, and again after a lost one: make the
//! renderer there), [`Call::Event`] for what the user does, and [`Call::Frame`] once a frame *after* the next image has
//! been waited for, so that an eye sampled there is as late as it can be. Frame latency is 1. A minimised or covered
//! window asks for no frames. Keys go by the place on the keyboard (W3C names such as `KeyW`, `ArrowUp`, `Space`).

use crate::gpu::{self, Gpu, GpuError};
use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::PhysicalKey;
use winit::window::{Window, WindowId};

/// How often a minimised window looks whether it is shown again.
const ASLEEP: Duration = Duration::from_millis(100);
/// A device lost more often than this in a run is given up.
const MOST_LOSSES: u32 = 3;

/// What the user or the window system did.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A key by its place on the keyboard.
    Key {
        /// W3C code name, such as `KeyW`; empty where the key has none.
        name: String,
        /// Pressed, or let go.
        down: bool,
        /// True for the repeats of a held key.
        repeat: bool,
    },
    /// The pointer moved; pixels from the top left corner.
    MouseMoved {
        /// To the right.
        x_px: f64,
        /// Down.
        y_px: f64,
    },
    /// A mouse button: 0 left, 1 right, 2 middle, 3 back, 4 forward, others from 5.
    MouseButton {
        /// Which.
        number: u16,
        /// Pressed, or let go.
        down: bool,
    },
    /// The wheel turned; lines, away from the user positive.
    Wheel {
        /// Lines, may be a fraction.
        lines: f32,
    },
    /// The picture's size changed; never zero (a minimised window sends nothing).
    Resized {
        /// Pixels.
        size_px: [u32; 2],
    },
    /// Display pixels per logical pixel changed.
    ScaleFactor(f64),
    /// The window gained or lost the keyboard. Keys held when it is lost are not reported as let go.
    Focused(bool),
    /// The user asked to close the window.
    CloseRequested,
}

/// What is asked of the callback.
pub enum Call<'a> {
    /// There is a (new) device: make everything that lives on it.
    Ready {
        /// The device.
        gpu: &'a Gpu,
        /// Colour format of the targets to come; an sRGB one.
        format: wgpu::TextureFormat,
        /// Size of the picture, pixels.
        size_px: [u32; 2],
        /// Display pixels per logical pixel.
        scale_factor: f64,
    },
    /// Something happened.
    Event(Event),
    /// Sample the eye, draw and submit one picture.
    Frame {
        /// The device.
        gpu: &'a Gpu,
        /// Where to draw.
        target: &'a wgpu::TextureView,
        /// Its size, pixels.
        size_px: [u32; 2],
        /// The window was minimised or covered since the last frame: the time since then is no frame's.
        slept: bool,
    },
}

/// What the callback wants next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Go on.
    Continue,
    /// Close the window and return from [`run`].
    Close,
}

/// Why there is no window, or no longer.
#[derive(Debug)]
pub enum WindowError {
    /// No display to open a window on.
    NoDisplay(String),
    /// The device failed and could not be had again.
    Gpu(GpuError),
    /// The callback failed.
    Caller(Box<dyn std::error::Error>),
}

impl fmt::Display for WindowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDisplay(reason) => write!(f, "expected a display to open a window on, found none: {reason}"),
            Self::Gpu(error) => error.fmt(f),
            Self::Caller(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for WindowError {}

/// What a callback answers.
pub type Answer = Result<Flow, Box<dyn std::error::Error>>;

/// Opens a window of a size and runs it until the callback or an error closes it. Must be called on the main thread.
///
/// # Errors
/// [`WindowError`].
pub fn run(title: &str, size_px: [u32; 2], callback: impl FnMut(Call<'_>) -> Answer) -> Result<(), WindowError> {
    let event_loop = EventLoop::new().map_err(|error| {
        // The library puts its own source file before the reason.
        let text = error.to_string();
        WindowError::NoDisplay(
            text.rsplit(".rs:").next().unwrap_or(&text).trim_start_matches(|c: char| !c.is_alphabetic()).to_owned(),
        )
    })?;
    let mut shell = Shell {
        title: title.to_owned(),
        size_px,
        callback,
        open: None,
        losses: 0,
        covered: false,
        asleep: false,
        slept: false,
        failed: None,
    };
    let ended = event_loop.run_app(&mut shell);
    match (shell.failed, ended) {
        (Some(error), _) => Err(error),
        (None, Err(error)) => Err(WindowError::NoDisplay(error.to_string())),
        (None, Ok(())) => Ok(()),
    }
}

struct Shell<F> {
    title: String,
    size_px: [u32; 2],
    callback: F,
    open: Option<Open>,
    losses: u32,
    /// What the window system last said; only [`WindowEvent::Occluded`] sets it.
    covered: bool,
    /// No frame is asked for until the window is looked at again.
    asleep: bool,
    /// Minimised or covered at some time since the last frame.
    slept: bool,
    failed: Option<WindowError>,
}

/// The window with its surface; dropped as a whole when the device is lost.
struct Open {
    window: Arc<Window>,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    gpu: Gpu,
    config: wgpu::SurfaceConfiguration,
    view_format: wgpu::TextureFormat,
}

impl Open {
    fn new(window: Arc<Window>) -> Result<Self, GpuError> {
        let instance = gpu::instance();
        let surface = surface(&instance, &window)?;
        let gpu = Gpu::for_surface(&instance, &surface)?;
        let able = surface.get_capabilities(&gpu.adapter);
        // Shaders write linear colour, so the target must encode: an sRGB format, or an sRGB view of a plain one.
        let srgb = able.formats.iter().copied().find(wgpu::TextureFormat::is_srgb);
        let format = srgb
            .or_else(|| able.formats.iter().copied().find(|format| format.add_srgb_suffix().is_srgb()))
            .ok_or_else(|| GpuError::NoSurface(format!("no 8-bit colour format among {:?}", able.formats)))?;
        let view_format = format.add_srgb_suffix();
        // Never wait for the screen's refresh where there is a choice without tearing; else tear, else wait.
        let present_mode = [wgpu::PresentMode::Mailbox, wgpu::PresentMode::Immediate]
            .into_iter()
            .find(|mode| able.present_modes.contains(mode))
            .unwrap_or(wgpu::PresentMode::Fifo);
        let size = window.inner_size();
        let config = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format,
            color_space: wgpu::SurfaceColorSpace::Auto,
            width: size.width,
            height: size.height,
            present_mode,
            desired_maximum_frame_latency: 1,
            alpha_mode: wgpu::CompositeAlphaMode::Auto,
            view_formats: if view_format == format { Vec::new() } else { vec![view_format] },
        };
        let mut open = Self { window, instance, surface, gpu, config, view_format };
        open.resize(size);
        Ok(open)
    }

    /// Configures the surface for a size; a zero size is kept but not configured.
    fn resize(&mut self, size: PhysicalSize<u32>) {
        let largest_px = self.gpu.device.limits().max_texture_dimension_2d;
        self.config.width = size.width.min(largest_px);
        self.config.height = size.height.min(largest_px);
        if self.is_shown() {
            self.surface.configure(&self.gpu.device, &self.config);
        }
    }

    fn is_shown(&self) -> bool {
        self.config.width > 0 && self.config.height > 0
    }

    fn size_px(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Waits for the next image to draw to; `None` where this frame must be left out.
    fn next_image(&mut self) -> Result<Option<wgpu::SurfaceTexture>, GpuError> {
        use wgpu::CurrentSurfaceTexture as Next;
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                Next::Success(image) => return Ok(Some(image)),
                Next::Suboptimal(image) => {
                    // Drawn as it is; a resize event brings the right size.
                    return Ok(Some(image));
                }
                Next::Timeout | Next::Occluded => return Ok(None),
                Next::Outdated => self.resize(self.window.inner_size()),
                Next::Lost => {
                    self.gpu.check()?;
                    self.surface = surface(&self.instance, &self.window)?;
                    self.resize(self.window.inner_size());
                }
                Next::Validation => {
                    self.gpu.check()?;
                    return Ok(None);
                }
            }
            if !self.is_shown() {
                return Ok(None);
            }
        }
        Ok(None)
    }
}

fn surface(instance: &wgpu::Instance, window: &Arc<Window>) -> Result<wgpu::Surface<'static>, GpuError> {
    instance.create_surface(Arc::clone(window)).map_err(|error| GpuError::NoSurface(error.to_string()))
}

impl<F: FnMut(Call<'_>) -> Answer> Shell<F> {
    fn open(&mut self, event_loop: &ActiveEventLoop) {
        let window = match self.open.take() {
            Some(open) => Arc::clone(&open.window),
            None => {
                let [width, height] = self.size_px;
                let attributes = Window::default_attributes()
                    .with_title(&self.title)
                    .with_inner_size(PhysicalSize::new(width, height));
                match event_loop.create_window(attributes) {
                    Ok(window) => Arc::new(window),
                    Err(error) => return self.fail(event_loop, WindowError::NoDisplay(error.to_string())),
                }
            }
        };
        match Open::new(window) {
            Ok(open) => {
                let answer = (self.callback)(Call::Ready {
                    gpu: &open.gpu,
                    format: open.view_format,
                    size_px: open.size_px().map(|edge| edge.max(1)),
                    scale_factor: open.window.scale_factor(),
                });
                open.window.request_redraw();
                self.open = Some(open);
                self.follow(event_loop, answer);
            }
            Err(error) => self.fail(event_loop, WindowError::Gpu(error)),
        }
    }

    fn tell(&mut self, event_loop: &ActiveEventLoop, event: Event) {
        let answer = (self.callback)(Call::Event(event));
        self.follow(event_loop, answer);
    }

    fn follow(&mut self, event_loop: &ActiveEventLoop, answer: Answer) {
        match answer {
            Ok(Flow::Continue) => {}
            Ok(Flow::Close) => event_loop.exit(),
            // A lost device shows in the callback's own calls first; it is not the callback's failure.
            Err(_) if self.device_is_lost() => self.reopen(event_loop),
            Err(error) => self.fail(event_loop, WindowError::Caller(error)),
        }
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, error: WindowError) {
        self.failed.get_or_insert(error);
        event_loop.exit();
    }

    fn device_is_lost(&self) -> bool {
        self.open.as_ref().is_some_and(|open| matches!(open.gpu.check(), Err(GpuError::Lost(_))))
    }

    fn reopen(&mut self, event_loop: &ActiveEventLoop) {
        self.losses += 1;
        match self.open.as_ref().map(|open| open.gpu.check()) {
            Some(Err(error)) if self.losses > MOST_LOSSES => self.fail(event_loop, WindowError::Gpu(error)),
            _ => self.open(event_loop),
        }
    }

    fn draw(&mut self, event_loop: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        self.asleep = self.covered || !open.is_shown();
        if self.asleep {
            self.slept = true;
            return;
        }
        let image = match open.next_image() {
            Ok(Some(image)) => image,
            Ok(None) => {
                self.asleep = true;
                return;
            }
            Err(GpuError::Lost(_)) => return self.reopen(event_loop),
            Err(error) => return self.fail(event_loop, WindowError::Gpu(error)),
        };
        let target = image.texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(open.view_format),
            ..wgpu::TextureViewDescriptor::default()
        });
        // The image's own size: right after a resize it can differ from the window's.
        let size_px = [image.texture.width(), image.texture.height()];
        let slept = std::mem::take(&mut self.slept);
        let answer = (self.callback)(Call::Frame { gpu: &open.gpu, target: &target, size_px, slept });
        open.window.pre_present_notify();
        open.gpu.queue.present(image);
        match open.gpu.check() {
            Err(GpuError::Lost(_)) => self.reopen(event_loop),
            Err(error) => self.fail(event_loop, WindowError::Gpu(error)),
            Ok(()) => self.follow(event_loop, answer),
        }
    }
}

impl<F: FnMut(Call<'_>) -> Answer> ApplicationHandler for Shell<F> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_none() {
            self.open(event_loop);
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &self.open) {
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::RedrawRequested => self.draw(event_loop),
            WindowEvent::Resized(size) => {
                let Some(open) = &mut self.open else { return };
                open.resize(size);
                if open.is_shown() {
                    self.asleep = self.covered;
                    let size_px = open.size_px();
                    self.tell(event_loop, Event::Resized { size_px });
                }
            }
            WindowEvent::ScaleFactorChanged { scale_factor, .. } => {
                self.tell(event_loop, Event::ScaleFactor(scale_factor));
            }
            WindowEvent::Occluded(covered) => {
                self.covered = covered;
                self.asleep = covered || !self.open.as_ref().is_some_and(Open::is_shown);
                self.slept |= covered;
            }
            WindowEvent::Focused(focused) => self.tell(event_loop, Event::Focused(focused)),
            WindowEvent::CloseRequested => self.tell(event_loop, Event::CloseRequested),
            WindowEvent::KeyboardInput { event, .. } => {
                let name = match event.physical_key {
                    PhysicalKey::Code(code) => format!("{code:?}"),
                    PhysicalKey::Unidentified(_) => String::new(),
                };
                let down = event.state == ElementState::Pressed;
                self.tell(event_loop, Event::Key { name, down, repeat: event.repeat });
            }
            WindowEvent::CursorMoved { position, .. } => {
                self.tell(event_loop, Event::MouseMoved { x_px: position.x, y_px: position.y });
            }
            WindowEvent::MouseInput { state, button, .. } => {
                let number = match button {
                    MouseButton::Left => 0,
                    MouseButton::Right => 1,
                    MouseButton::Middle => 2,
                    MouseButton::Back => 3,
                    MouseButton::Forward => 4,
                    MouseButton::Other(other) => other.saturating_add(5),
                };
                self.tell(event_loop, Event::MouseButton { number, down: state == ElementState::Pressed });
            }
            WindowEvent::MouseWheel { delta, .. } => {
                let lines = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => lines,
                    // A common height of a line of text.
                    MouseScrollDelta::PixelDelta(by) => (by.y / 20.0) as f32,
                };
                self.tell(event_loop, Event::Wheel { lines });
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let Some(open) = &self.open else { return };
        if self.asleep {
            event_loop.set_control_flow(ControlFlow::WaitUntil(Instant::now() + ASLEEP));
        } else {
            event_loop.set_control_flow(ControlFlow::Poll);
            open.window.request_redraw();
        }
    }
}
