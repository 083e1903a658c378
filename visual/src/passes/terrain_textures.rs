//! What the terrain pass keeps on the GPU: the window's toroidal textures, index lists and the block table.
//!
//! Slot (x, z) of a window of n x n has the texel square at (x, z) times the tile's side in every texture. One index
//! buffer holds the list of level 0, the list of level 1, and room for an own list a slot.

use super::detail::{self, SIDE as DETAIL_SIDE};
use terrain::block::ground_map;
use terrain::block::mesh::{self, TILE};
use terrain::block::window::{Level, Upload};

/// Indices that a slot's own list may have: level 0.
const OWN_INDICES: u32 = terrain::CELLS * terrain::CELLS * 2 * 3;

/// See the module.
pub struct TerrainTextures {
    blocks_side: u32,
    pub(super) heights: wgpu::Texture,
    pub(super) lights: wgpu::Texture,
    pub(super) ground_maps: wgpu::Texture,
    pub(super) detail: wgpu::Texture,
    pub(super) indices: wgpu::Buffer,
    level_0: u32,
    level_1: u32,
}

impl TerrainTextures {
    /// Makes everything for a window of `blocks_side` x `blocks_side` blocks.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, blocks_side: u32) -> Self {
        let texture = |label, side: u32, layers, mips, format| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: layers },
                mip_level_count: mips,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_DST
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let (posts, texels) = (blocks_side * TILE, blocks_side * ground_map::SIDE);
        let unorm = wgpu::TextureFormat::Rgba8Unorm;
        let detail_mips = DETAIL_SIDE.ilog2() + 1;
        let (level_0, level_1) = (mesh::level_0().len() as u32, mesh::level_1().len() as u32);
        let own = blocks_side * blocks_side * OWN_INDICES;
        let made = Self {
            blocks_side,
            heights: texture("heights", posts, 1, 1, wgpu::TextureFormat::R32Float),
            lights: texture("light maps", posts, 2, 1, unorm),
            ground_maps: texture("ground maps", texels, 1, 2, unorm),
            detail: texture("detail", DETAIL_SIDE, 1, detail_mips, unorm),
            indices: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("terrain indices"),
                size: u64::from(level_0 + level_1 + own) * 2,
                usage: wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            level_0,
            level_1,
        };
        queue.write_buffer(&made.indices, 0, bytemuck::cast_slice(mesh::level_0()));
        queue.write_buffer(&made.indices, u64::from(level_0) * 2, bytemuck::cast_slice(mesh::level_1()));
        for (level, texels) in detail::levels().iter().enumerate() {
            write(queue, &made.detail, level as u32, [0, 0, 0], DETAIL_SIDE >> level, texels);
        }
        made
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> usize {
        let posts = (self.blocks_side * TILE) as usize;
        let texels = (self.blocks_side * ground_map::SIDE) as usize;
        posts * posts * (4 + 2 * 4)
            + texels * texels * 5
            + self.indices.size() as usize
            + (DETAIL_SIDE * DETAIL_SIDE * 4) as usize * 4 / 3
    }

    /// Puts an upload where it belongs.
    pub fn apply(&self, queue: &wgpu::Queue, upload: &Upload) {
        let place = |slot: usize, side: u32, layer: usize| {
            let (x, z) = (slot as u32 % self.blocks_side, slot as u32 / self.blocks_side);
            [x * side, z * side, layer as u32]
        };
        match upload {
            Upload::Block { slot, layer, payload } => {
                let heights: &[u8] = bytemuck::cast_slice(&payload.heights_m);
                write(queue, &self.heights, 0, place(*slot, TILE, 0), TILE, heights);
                write(queue, &self.lights, 0, place(*slot, TILE, *layer), TILE, &payload.light);
                let side = ground_map::SIDE;
                let (map, mip) = payload.ground_map.split_at(ground_map::MAP_BYTES);
                write(queue, &self.ground_maps, 0, place(*slot, side, 0), side, map);
                write(queue, &self.ground_maps, 1, place(*slot, side / 2, 0), side / 2, mip);
            }
            Upload::Light { slot, layer, light } => {
                write(queue, &self.lights, 0, place(*slot, TILE, *layer), TILE, light);
            }
            Upload::Indices { slot, indices } => {
                let offset = u64::from(self.own_list(*slot)) * 2;
                // Lists are whole triangles; writes are whole words.
                let bytes: &[u8] = bytemuck::cast_slice(indices);
                if bytes.len().is_multiple_of(4) {
                    queue.write_buffer(&self.indices, offset, bytes);
                } else {
                    let mut padded = bytes.to_vec();
                    padded.extend([0, 0]);
                    queue.write_buffer(&self.indices, offset, &padded);
                }
            }
        }
    }

    /// The indices to draw for a block's level.
    pub fn range(&self, slot: usize, level: Level) -> std::ops::Range<u32> {
        match level {
            Level::Zero => 0..self.level_0,
            Level::One => self.level_0..self.level_0 + self.level_1,
            Level::Own { indices } => {
                let first = self.own_list(slot);
                first..first + indices
            }
        }
    }

    fn own_list(&self, slot: usize) -> u32 {
        self.level_0 + self.level_1 + slot as u32 * OWN_INDICES
    }
}

/// Writes a square of four-byte texels.
fn write(queue: &wgpu::Queue, texture: &wgpu::Texture, level: u32, [x, y, z]: [u32; 3], side: u32, texels: &[u8]) {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: level,
            origin: wgpu::Origin3d { x, y, z },
            aspect: wgpu::TextureAspect::All,
        },
        texels,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(side * 4), rows_per_image: Some(side) },
        wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
    );
}
