//! Draws marks that events left on the near ground: small craters, burnt ground. Shader: `shaders/overlay.wgsl`.
//!
//! A mark is draped like a road ([`terrain::block::overlay::decal`]) on the render thread, some ten microseconds each, and
//! drawn after the overlays with their shader. Only blocks that are drawn at level 0 show any. Without a mark there is no
//! pipeline and no byte. Marks lie in two lists; when the younger is full the older goes as a whole, so that none is draped
//! twice but where the ground becomes another. A new mark sends its block's list again, at most half of [`MOST_DECALS`] marks of
//! some 400 bytes, beside the budget of the ground's own uploads.
//!
//! Invariant: after [`DecalPass::set_field`] every mark lies on the new ground.

use super::TargetFormat;
use super::overlay::{self, Fragment};
use super::terrain::Terrain;
use super::upload::Growing;
use crate::gpu::Gpu;
use std::collections::HashMap;
use std::sync::Arc;
use terrain::block::overlay::decal::{self, Decal};
use terrain::block::overlay::{Overlay, Vertex};
use terrain::{BlockIndex, Field};

/// Most marks kept.
pub const MOST_DECALS: usize = 2_048;

/// The marks of a block.
struct Marked {
    overlay: Overlay,
    vertices: Growing,
    indices: Growing,
    /// Whether the device lacks some.
    stale: bool,
}

/// Marks that go together.
#[derive(Default)]
struct List {
    decals: Vec<Decal>,
    blocks: HashMap<BlockIndex, Marked>,
}

/// See the module.
pub struct DecalPass {
    field: Arc<Field>,
    /// Older and younger.
    lists: [List; 2],
    pipeline: Option<wgpu::RenderPipeline>,
    fragment: Fragment,
    /// For each view: list, block and slot.
    draws: Vec<Vec<(usize, BlockIndex, u32)>>,
}

impl DecalPass {
    /// Without a mark. `terrain` is the ground's group 1 layout.
    pub fn new(
        frame: &wgpu::BindGroupLayout,
        terrain: &wgpu::BindGroupLayout,
        format: TargetFormat,
        field: Arc<Field>,
    ) -> Self {
        let fragment =
            Fragment { frame: frame.clone(), terrain: terrain.clone(), format, entry: "overlay_fragment", detail: 0 };
        Self { field, lists: Default::default(), pipeline: None, fragment, draws: Vec::new() }
    }

    /// Adds marks; later ones lie over earlier.
    pub fn add(&mut self, decals: impl IntoIterator<Item = Decal>) {
        for decal in decals {
            if self.lists[1].decals.len() >= MOST_DECALS / 2 {
                self.lists[0] = std::mem::take(&mut self.lists[1]);
            }
            self.lists[1].add(&self.field, decal);
        }
    }

    /// Takes all away.
    pub fn clear(&mut self) {
        self.lists = Default::default();
    }

    /// Takes over another version of the ground: all marks are draped anew.
    pub fn set_field(&mut self, field: Arc<Field>) {
        self.field = field;
        for list in &mut self.lists {
            let decals = std::mem::take(list).decals;
            decals.into_iter().for_each(|decal| list.add(&self.field, decal));
        }
    }

    /// Marks that there are.
    pub fn count(&self) -> usize {
        self.lists.iter().map(|list| list.decals.len()).sum()
    }

    /// Bytes on the GPU.
    pub fn gpu_bytes(&self) -> usize {
        let blocks = self.lists.iter().flat_map(|list| list.blocks.values());
        blocks.map(|block| block.vertices.bytes() + block.indices.bytes()).sum()
    }

    /// Chooses what a view sees from the ground's blocks, which must be prepared, and uploads what is new of it.
    pub fn prepare(&mut self, gpu: &Gpu, view_index: usize, terrain: &Terrain) {
        if self.draws.len() <= view_index {
            self.draws.resize(view_index + 1, Vec::new());
        }
        let draws = &mut self.draws[view_index];
        draws.clear();
        for (number, list) in self.lists.iter_mut().enumerate().filter(|(_, list)| !list.blocks.is_empty()) {
            for draw in terrain.draws(view_index).iter().filter(|draw| draw.ring == 0) {
                let Some(marked) = list.blocks.get_mut(&draw.block) else { continue };
                if std::mem::take(&mut marked.stale) {
                    let words: Vec<[u32; 5]> = marked.overlay.vertices.iter().map(Vertex::words).collect();
                    marked.vertices.write(&gpu.device, &gpu.queue, &[bytemuck::cast_slice(&words)]);
                    marked.indices.write(&gpu.device, &gpu.queue, &[bytemuck::cast_slice(&marked.overlay.indices)]);
                }
                draws.push((number, draw.block, draw.slot as u32));
            }
        }
        if !draws.is_empty() && self.pipeline.is_none() {
            self.pipeline = Some(overlay::pipeline(gpu, &self.fragment));
        }
    }

    /// Records a prepared view's marks after its ground and overlays; group 0 must be bound.
    pub fn draw(&self, view_index: usize, terrain: &Terrain, pass: &mut wgpu::RenderPass<'_>) {
        let draws = self.draws.get(view_index).map_or(&[][..], Vec::as_slice);
        let Some(pipeline) = self.pipeline.as_ref().filter(|_| !draws.is_empty()) else { return };
        pass.set_bind_group(1, terrain.bindings().1, &[]);
        pass.set_pipeline(pipeline);
        for (list, block, slot) in draws {
            let Some(marked) = self.lists[*list].blocks.get(block) else { continue };
            let (Some(vertices), Some(indices)) = (marked.vertices.buffer(), marked.indices.buffer()) else { continue };
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..marked.overlay.indices.len() as u32, 0, *slot..*slot + 1);
        }
    }
}

impl List {
    fn add(&mut self, field: &Field, decal: Decal) {
        self.decals.push(decal);
        for (block, piece) in decal::drape(field, &decal) {
            let marked = self.blocks.entry(block).or_insert_with(|| Marked {
                overlay: Overlay::default(),
                vertices: Growing::new("decal vertices", wgpu::BufferUsages::VERTEX),
                indices: Growing::new("decal indices", wgpu::BufferUsages::INDEX),
                stale: false,
            });
            let first = marked.overlay.vertices.len() as u32;
            marked.overlay.vertices.extend(piece.vertices);
            marked.overlay.indices.extend(piece.indices.into_iter().map(|index| first + index));
            marked.stale = true;
        }
    }
}
