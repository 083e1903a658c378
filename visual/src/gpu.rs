//! The graphics device: which adapter was chosen, and what went wrong with it.
//!
//! Hardware is preferred, software Vulkan (lavapipe) is the accepted fallback. wgpu's own habit is to panic on an
//! error that nobody catches; here every such error and a lost device are kept and returned by [`Gpu::check`], so a
//! caller that checks once a frame never panics. Anisotropic filtering is never requested: on Mesa 22.3's llvmpipe it
//! hangs the rasteriser.

use std::fmt;
use std::sync::{Arc, Mutex};

/// Largest texture and target edge in pixels that is asked of an adapter (less where the adapter has less).
pub const MAX_TEXTURE_EDGE_PX: u32 = 8192;

/// Whether pixels are made by a graphics chip or by the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdapterKind {
    /// A graphics chip, integrated or not, also through a virtual machine.
    Hardware,
    /// A software rasteriser such as lavapipe.
    Software,
}

impl fmt::Display for AdapterKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Hardware => "hardware",
            Self::Software => "software",
        })
    }
}

/// What a report says of the adapter.
#[derive(Clone, Debug)]
pub struct AdapterReport {
    /// Name given by the driver.
    pub name: String,
    /// Graphics interface in lower case, such as `vulkan`.
    pub backend: String,
    /// Chip or processor.
    pub kind: AdapterKind,
}

/// What can go wrong with the device.
#[derive(Clone, Debug)]
pub enum GpuError {
    /// No adapter at all; the text is the driver loader's own reason.
    NoAdapter(String),
    /// The adapter refused to open a device.
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// The driver's reason.
        reason: String,
    },
    /// The window system refused a surface for the window.
    NoSurface(String),
    /// The device stopped working: driver reset, unplugged, out of memory.
    Lost(String),
    /// A call was refused: a fault of this program, or memory ran out.
    Refused(String),
    /// A size is zero or beyond what the adapter can draw to.
    Size {
        /// The size asked for, pixels.
        asked_px: [u32; 2],
        /// The largest edge possible, pixels.
        largest_px: u32,
    },
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter(reason) => write!(
                f,
                "expected a Vulkan adapter (hardware or software), found none; \
                 on Debian install mesa-vulkan-drivers ({reason})"
            ),
            Self::NoDevice { adapter, reason } => {
                write!(f, "expected adapter \"{adapter}\" to open a device, it refused: {reason}")
            }
            Self::NoSurface(reason) => write!(f, "expected a surface for the window, got none: {reason}"),
            Self::Lost(reason) => write!(f, "the graphics device was lost: {reason}"),
            Self::Refused(reason) => write!(f, "the graphics device refused a call: {reason}"),
            Self::Size { asked_px: [width, height], largest_px } => {
                write!(f, "expected a picture of 1 to {largest_px} pixels an edge, got {width} x {height}")
            }
        }
    }
}

impl std::error::Error for GpuError {}

/// An open device with its queue. Cloning shares the device.
#[derive(Clone)]
pub struct Gpu {
    /// Makes resources.
    pub device: wgpu::Device,
    /// Takes work.
    pub queue: wgpu::Queue,
    /// The chosen adapter, for surface capabilities.
    pub adapter: wgpu::Adapter,
    /// The adapter as a report names it.
    pub report: AdapterReport,
    trouble: Arc<Mutex<Option<GpuError>>>,
}

impl Gpu {
    /// Opens a device that draws to textures only.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], [`GpuError::NoDevice`].
    pub fn headless() -> Result<Self, GpuError> {
        Self::open(&instance(), None)
    }

    /// Opens a device that can present to `surface`, which must come from the same instance.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], [`GpuError::NoDevice`].
    pub fn for_surface(instance: &wgpu::Instance, surface: &wgpu::Surface<'_>) -> Result<Self, GpuError> {
        Self::open(instance, Some(surface))
    }

    fn open(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, GpuError> {
        let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        adapters.retain(|adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface)));
        // Stable order, so that two equal chips give the same choice each time.
        adapters.sort_by_key(|adapter| preference(adapter.get_info().device_type));
        let Some(adapter) = adapters.into_iter().next() else {
            let what = if surface.is_some() { "that can present to this window" } else { "was listed" };
            return Err(GpuError::NoAdapter(format!("no adapter {what}")));
        };
        let info = adapter.get_info();
        let report = AdapterReport {
            name: info.name.clone(),
            backend: info.backend.to_string(),
            kind: match info.device_type {
                wgpu::DeviceType::Cpu => AdapterKind::Software,
                _ => AdapterKind::Hardware,
            },
        };
        let able = adapter.limits();
        let mut limits = wgpu::Limits::downlevel_defaults().using_resolution(able.clone());
        limits.max_texture_dimension_2d = able.max_texture_dimension_2d.min(MAX_TEXTURE_EDGE_PX);
        limits.max_buffer_size = able.max_buffer_size.min(256 << 20);
        limits.max_storage_buffer_binding_size = able.max_storage_buffer_binding_size.min(128 << 20);
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("poligon"),
            // Only for the wireframe; where it is missing, that overlay is.
            required_features: adapter.features() & wgpu::Features::POLYGON_MODE_LINE,
            required_limits: limits,
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice { adapter: info.name, reason: error.to_string() })?;

        let trouble = Arc::new(Mutex::new(None));
        let refused = Arc::clone(&trouble);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            keep_first(&refused, GpuError::Refused(error.to_string()));
        }));
        let lost = Arc::clone(&trouble);
        device.set_device_lost_callback(move |reason, text| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                keep_first(&lost, GpuError::Lost(text));
            }
        });
        Ok(Self { device, queue, adapter, report, trouble })
    }

    /// The first error since the device was opened, if any; a loss comes before refused calls. Call once a frame; after an error open a new device.
    ///
    /// # Errors
    /// [`GpuError::Lost`], [`GpuError::Refused`].
    pub fn check(&self) -> Result<(), GpuError> {
        match self.trouble.lock() {
            Ok(kept) => kept.clone().map_or(Ok(()), Err),
            Err(_) => Err(GpuError::Lost("the error record was left locked by a crashed thread".into())),
        }
    }

    /// Checks that a picture of this size can be drawn.
    ///
    /// # Errors
    /// [`GpuError::Size`].
    pub fn check_size(&self, size_px: [u32; 2]) -> Result<(), GpuError> {
        let largest_px = self.device.limits().max_texture_dimension_2d;
        if size_px.iter().all(|&edge| (1..=largest_px).contains(&edge)) {
            return Ok(());
        }
        Err(GpuError::Size { asked_px: size_px, largest_px })
    }

    /// Whether edges of triangles can be drawn alone: the wireframe.
    pub fn draws_edges(&self) -> bool {
        self.device.features().contains(wgpu::Features::POLYGON_MODE_LINE)
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// [`GpuError::Lost`] where the device does not answer.
    pub fn wait(&self) -> Result<(), GpuError> {
        if let Err(error) = self.device.poll(wgpu::PollType::wait_indefinitely()) {
            keep_first(&self.trouble, GpuError::Lost(error.to_string()));
        }
        self.check()
    }
}

/// The graphics interface itself; needed before a window's surface can be made.
pub fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    wgpu::Instance::new(descriptor)
}

fn preference(kind: wgpu::DeviceType) -> u8 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// Keeps the first error, but a loss before a refused call: calls are refused because a device is going, and only a
/// loss is answered with a new one.
fn keep_first(kept: &Mutex<Option<GpuError>>, error: GpuError) {
    if let Ok(mut kept) = kept.lock() {
        match (&*kept, &error) {
            (None, _) | (Some(GpuError::Refused(_)), GpuError::Lost(_)) => *kept = Some(error),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_error_is_kept_but_a_loss_before_a_refusal() {
        let kept_of = |errors: &[GpuError]| {
            let kept = Mutex::new(None);
            errors.iter().for_each(|error| keep_first(&kept, error.clone()));
            kept.into_inner().unwrap().map(|error| error.to_string())
        };
        let (lost, refused) = (|text: &str| GpuError::Lost(text.into()), |text: &str| GpuError::Refused(text.into()));
        let shown = |error: GpuError| Some(error.to_string());
        assert_eq!(kept_of(&[]), None);
        assert_eq!(kept_of(&[refused("a"), refused("b")]), shown(refused("a")));
        assert_eq!(kept_of(&[refused("a"), lost("b"), lost("c")]), shown(lost("b")));
        assert_eq!(kept_of(&[lost("a"), refused("b")]), shown(lost("a")));
    }
}
