//! Pictures back from the device: offscreen targets, reading pixels and depth, PNG files, contact sheets, a hash.
//!
//! A [`Picture`] is 8-bit sRGB with alpha, rows from the top, no padding.

use crate::gpu::{Gpu, GpuError};
use std::fmt;
use std::path::{Path, PathBuf};

/// Colour format of offscreen targets.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A picture on the processor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height, pixels.
    pub size_px: [u32; 2],
    /// Red, green, blue, alpha, row by row from the top.
    pub rgba: Vec<u8>,
}

/// Why a picture could not be written.
#[derive(Debug)]
pub struct WriteError {
    path: PathBuf,
    reason: String,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected to write a picture to {}, failed: {}", self.path.display(), self.reason)
    }
}

impl std::error::Error for WriteError {}

/// A target to draw to where there is no window.
pub struct Offscreen {
    /// The texture.
    pub texture: wgpu::Texture,
    /// The whole of it.
    pub view: wgpu::TextureView,
    /// Width and height, pixels.
    pub size_px: [u32; 2],
}

impl Offscreen {
    /// Makes a target in [`FORMAT`].
    ///
    /// # Errors
    /// [`GpuError::Size`].
    pub fn new(gpu: &Gpu, size_px: [u32; 2]) -> Result<Self, GpuError> {
        Self::with_format(gpu, size_px, FORMAT)
    }

    /// Makes a target in another format of 4 bytes a texel, such as a window's.
    ///
    /// # Errors
    /// [`GpuError::Size`].
    pub fn with_format(gpu: &Gpu, size_px: [u32; 2], format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        gpu.check_size(size_px)?;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("offscreen"),
            size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { texture, view, size_px })
    }

    /// Clears the target to black and submits: the least that a frame can be.
    pub fn clear(&self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("clear") });
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..wgpu::RenderPassDescriptor::default()
        }));
        gpu.queue.submit([encoder.finish()]);
    }

    /// Waits for the drawing and reads the picture.
    ///
    /// # Errors
    /// [`GpuError::Lost`], [`GpuError::Refused`].
    pub fn read(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        let mut rgba = read_texels(gpu, &self.texture, wgpu::TextureAspect::All)?;
        if matches!(self.texture.format(), wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb) {
            rgba.chunks_exact_mut(4).for_each(|texel| texel.swap(0, 2));
        }
        Ok(Picture { size_px: self.size_px, rgba })
    }
}

/// Waits for the drawing and reads a 32-bit float depth texture, row by row from the top (reversed: near / distance).
///
/// # Errors
/// [`GpuError::Lost`], [`GpuError::Refused`].
pub fn read_depth(gpu: &Gpu, depth: &wgpu::Texture) -> Result<Vec<f32>, GpuError> {
    let bytes = read_texels(gpu, depth, wgpu::TextureAspect::DepthOnly)?;
    let texels = bytes.chunks_exact(4);
    Ok(texels.map(|texel| f32::from_ne_bytes([texel[0], texel[1], texel[2], texel[3]])).collect())
}

/// All texels of a texture of 4 bytes a texel, without the padding that the device wants between rows.
///
/// # Errors
/// [`GpuError::Lost`], [`GpuError::Refused`].
pub fn read_texels(gpu: &Gpu, texture: &wgpu::Texture, aspect: wgpu::TextureAspect) -> Result<Vec<u8>, GpuError> {
    let (width, height) = (texture.width(), texture.height());
    let row_bytes = width * 4;
    let padded_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: u64::from(padded_bytes) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { texture, mip_level: 0, origin: wgpu::Origin3d::ZERO, aspect },
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_bytes),
                rows_per_image: Some(height),
            },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| ());
    gpu.wait()?;
    let mapped = buffer.get_mapped_range(..).map_err(|error| GpuError::Refused(error.to_string()))?;
    let mut texels = Vec::with_capacity((row_bytes * height) as usize);
    for row in mapped.chunks_exact(padded_bytes as usize) {
        texels.extend_from_slice(&row[..row_bytes as usize]);
    }
    Ok(texels)
}

/// Waits and reads a buffer of 32-bit words.
///
/// # Errors
/// [`GpuError::Lost`], [`GpuError::Refused`].
pub fn read_words(gpu: &Gpu, words: &wgpu::Buffer) -> Result<Vec<u32>, GpuError> {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: words.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(words, 0, &buffer, 0, words.size());
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| ());
    gpu.wait()?;
    let mapped = buffer.get_mapped_range(..).map_err(|error| GpuError::Refused(error.to_string()))?;
    Ok(mapped.as_chunks::<4>().0.iter().map(|bytes| u32::from_ne_bytes(*bytes)).collect())
}

impl Picture {
    /// Writes a PNG file, making its folder where needed.
    ///
    /// # Errors
    /// [`WriteError`] with the path and the reason.
    pub fn write_png(&self, path: &Path) -> Result<(), WriteError> {
        let failed = |reason: String| WriteError { path: path.to_owned(), reason };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| failed(error.to_string()))?;
        }
        let [width, height] = self.size_px;
        image::save_buffer(path, &self.rgba, width, height, image::ExtendedColorType::Rgba8)
            .map_err(|error| failed(error.to_string()))
    }

    /// A hash of size and pixels (FNV-1a, 64 bits), the same on every machine.
    pub fn hash(&self) -> u64 {
        let size = self.size_px.iter().flat_map(|edge| edge.to_le_bytes());
        size.chain(self.rgba.iter().copied())
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }

    /// Pictures side by side in a grid, in reading order, each shrunk by the same whole factor (box filter).
    ///
    /// The cell is the first picture's shrunk size; what is larger is cut, what is missing is black.
    pub fn contact_sheet(pictures: &[Self], columns: u32, shrink: u32) -> Self {
        let columns = columns.max(1);
        let shrink = shrink.max(1);
        let Some(first) = pictures.first() else {
            return Self { size_px: [1, 1], rgba: vec![0, 0, 0, 255] };
        };
        let [cell_width, cell_height] = first.size_px.map(|edge| (edge / shrink).max(1));
        let rows = (pictures.len() as u32).div_ceil(columns);
        let size_px = [cell_width * columns, cell_height * rows];
        let mut rgba = [0, 0, 0, 255].repeat((size_px[0] * size_px[1]) as usize);
        for (number, picture) in pictures.iter().enumerate() {
            let (left, top) = (number as u32 % columns * cell_width, number as u32 / columns * cell_height);
            for y in 0..cell_height {
                for x in 0..cell_width {
                    if let Some(mean) = picture.mean([x * shrink, y * shrink], shrink) {
                        let at = (((top + y) * size_px[0] + left + x) * 4) as usize;
                        rgba[at..at + 4].copy_from_slice(&mean);
                    }
                }
            }
        }
        Self { size_px, rgba }
    }

    fn mean(&self, corner: [u32; 2], edge: u32) -> Option<[u8; 4]> {
        if corner[0] + edge > self.size_px[0] || corner[1] + edge > self.size_px[1] {
            return None;
        }
        let mut sum = [0_u32; 4];
        for y in corner[1]..corner[1] + edge {
            let start = ((y * self.size_px[0] + corner[0]) * 4) as usize;
            for texel in self.rgba[start..start + (edge * 4) as usize].chunks_exact(4) {
                for (total, &channel) in sum.iter_mut().zip(texel) {
                    *total += u32::from(channel);
                }
            }
        }
        Some(sum.map(|total| (total / (edge * edge)) as u8))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(size_px: [u32; 2], grey: u8) -> Picture {
        Picture { size_px, rgba: [grey, grey, grey, 255].repeat((size_px[0] * size_px[1]) as usize) }
    }

    #[test]
    fn the_hash_is_fnv_1a_and_sees_size_and_pixels() {
        // FNV-1a of the 8 bytes 0: eight multiplications of the offset basis by the prime.
        let empty = Picture { size_px: [0, 0], rgba: Vec::new() };
        let by_hand = (0..8).fold(0xcbf2_9ce4_8422_2325_u64, |h, _| h.wrapping_mul(0x0100_0000_01b3));
        assert_eq!(empty.hash(), by_hand);
        assert_ne!(plain([4, 2], 7).hash(), plain([2, 4], 7).hash());
        assert_ne!(plain([4, 2], 7).hash(), plain([4, 2], 8).hash());
    }

    #[test]
    fn a_sheet_has_every_picture_in_its_cell() {
        let pictures = [plain([8, 4], 10), plain([8, 4], 20), plain([8, 4], 30)];
        let sheet = Picture::contact_sheet(&pictures, 2, 2);
        assert_eq!(sheet.size_px, [8, 4]);
        let at = |x: u32, y: u32| sheet.rgba[((y * 8 + x) * 4) as usize];
        assert_eq!([at(0, 0), at(7, 1), at(3, 3), at(4, 2)], [10, 20, 30, 0]);
        assert_eq!(Picture::contact_sheet(&[], 3, 0).size_px, [1, 1]);
    }
}
