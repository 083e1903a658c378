//! Bytes to the device: buffers with a content, buffers that grow as frames need, mips of a texture's layer.

use crate::gpu::Gpu;

/// A buffer that is filled anew each frame, and replaced by a larger one where a frame needs more.
#[derive(Debug)]
pub(super) struct Growing {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: Option<wgpu::Buffer>,
}

impl Growing {
    /// Nothing yet.
    pub(super) const fn new(label: &'static str, usage: wgpu::BufferUsages) -> Self {
        Self { label, usage, buffer: None }
    }

    /// Writes parts one behind another, each a multiple of four bytes long. Says whether the buffer is another one now, which
    /// bind groups do not know yet.
    pub(super) fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, parts: &[&[u8]]) -> bool {
        let size = parts.iter().map(|part| part.len() as u64).sum::<u64>();
        if size == 0 {
            return false;
        }
        let fits = self.buffer.as_ref().is_some_and(|buffer| buffer.size() >= size);
        if !fits {
            self.buffer = Some(empty(device, self.label, size.next_power_of_two().max(4_096), self.usage));
        }
        if let Some(buffer) = &self.buffer {
            let mut at = 0;
            for part in parts.iter().filter(|part| !part.is_empty()) {
                queue.write_buffer(buffer, at, part);
                at += part.len() as u64;
            }
        }
        !fits
    }

    /// Bytes on the GPU.
    pub(super) fn bytes(&self) -> usize {
        self.buffer.as_ref().map_or(0, |buffer| buffer.size() as usize)
    }

    /// The buffer last written, if any was.
    pub(super) fn buffer(&self) -> Option<&wgpu::Buffer> {
        self.buffer.as_ref()
    }
}

/// A buffer to be written.
pub(super) fn empty(device: &wgpu::Device, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A buffer with a content, filled up to a multiple of four bytes.
pub(super) fn filled(gpu: &Gpu, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let made = empty(&gpu.device, label, (bytes.len() as u64).next_multiple_of(4).max(4), usage);
    let whole = bytes.len() / 4 * 4;
    gpu.queue.write_buffer(&made, 0, &bytes[..whole]);
    if whole < bytes.len() {
        let mut rest = [0; 4];
        rest[..bytes.len() - whole].copy_from_slice(&bytes[whole..]);
        gpu.queue.write_buffer(&made, whole as u64, &rest);
    }
    made
}

/// Writes a mip of a layer of four-byte texels.
pub(super) fn mip(
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    mip_level: u32,
    z: u32,
    [width, height]: [u32; 2],
    texels: &[u8],
) {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level,
            origin: wgpu::Origin3d { x: 0, y: 0, z },
            aspect: wgpu::TextureAspect::All,
        },
        texels,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: Some(height) },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}
