//! Anti-aliased strokes and text over the picture, in one draw. Shader: `shaders/lines.wgsl`.
//!
//! Positions are pixels of the final target, origin at the top left corner, y down. Every stroke is drawn twice: first
//! a soft dark halo, then the line, so that it reads before snow and before night; all halos come before all lines.
//! The letters are strokes too (see [`crate::glyphs`]), so text is as sharp as lines at any size.

use super::TargetFormat;
use super::upload::Growing;
use crate::{glyphs, shaders};
use bytemuck::{Pod, Zeroable};
use glam::Vec2;

/// A line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// At least two points, or one for a dot; pixels, origin top left.
    pub points_px: Vec<Vec2>,
    /// Width, pixels.
    pub width_px: f32,
    /// Linear red, green, blue as displayed, and alpha.
    pub colour: [f32; 4],
}

/// Where a text stands on its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// The point is the left end of the base line.
    Left,
    /// The middle of it.
    Middle,
    /// The right end.
    Right,
}

/// Strokes of a line of text. `base_px` is on the base line, `cap_px` the height of a capital.
///
/// Letters are shown as capitals; a character without a glyph is shown as a small box.
pub fn text(text: &str, base_px: Vec2, cap_px: f32, align: Align, colour: [f32; 4]) -> Vec<Stroke> {
    let unit_px = cap_px / glyphs::CAP;
    let width_px = (cap_px * 0.115).max(1.25);
    let shift = match align {
        Align::Left => 0.0,
        Align::Middle => 0.5,
        Align::Right => 1.0,
    };
    let mut pen_px = base_px - Vec2::new(shift * text_width_px(text, cap_px), 0.0);
    let mut strokes = Vec::new();
    for letter in text.chars() {
        for line in glyphs::strokes(letter) {
            let points_px = line.map(|at| pen_px + Vec2::new(at.x, -at.y) * unit_px).collect();
            strokes.push(Stroke { points_px, width_px, colour });
        }
        pen_px.x += glyphs::ADVANCE * unit_px;
    }
    strokes
}

/// Width of a line of text in pixels; every character is equally wide, so figures do not dance.
pub fn text_width_px(text: &str, cap_px: f32) -> f32 {
    let letters = text.chars().count() as f32;
    ((letters * glyphs::ADVANCE) - glyphs::GAP).max(0.0) * cap_px / glyphs::CAP
}

/// One segment as the shader takes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Segment {
    /// From x, y, to x, y.
    pub ends_px: [f32; 4],
    /// Inward unit normals of the cuts at both ends; zero at a free end.
    pub joints: [f32; 4],
    /// Linear colour and alpha.
    pub colour: [f32; 4],
    /// Half the width.
    pub half_width_px: f32,
    /// Width of the edge's fade.
    pub soft_px: f32,
}

const ATTRIBUTES: [wgpu::VertexAttribute; 5] = wgpu::vertex_attr_array![
    0 => Float32x4, 1 => Float32x4, 2 => Float32x4, 3 => Float32, 4 => Float32
];
const HALO_ALPHA: f32 = 0.8;
const HALO_PX: f32 = 1.8;
/// More than any display needs; what is beyond is left out rather than let memory grow.
const MOST_SEGMENTS: usize = 100_000;

/// The pipeline and its buffers.
pub struct LinesPass {
    pipeline: wgpu::RenderPipeline,
    target: wgpu::Buffer,
    group: wgpu::BindGroup,
    segments: Growing,
    count: u32,
}

impl LinesPass {
    /// Makes the pipeline for a target; where the target has depth it is neither tested nor written.
    pub fn new(device: &wgpu::Device, format: TargetFormat) -> Self {
        let module = shaders::module(device, "lines.wgsl");
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("lines"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("lines"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("lines"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("lines_vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Segment>() as u64,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes: &ATTRIBUTES,
                })],
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: format.depth_state(wgpu::CompareFunction::Always, false),
            multisample: format.multisample(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("lines_fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: format.colour,
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });
        let target = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("lines target"),
            size: 16,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("lines"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: target.as_entire_binding() }],
        });
        Self { pipeline, target, group, segments: Growing::new("lines", wgpu::BufferUsages::VERTEX), count: 0 }
    }

    /// Uploads strokes for a target of a size; call before the render pass begins.
    pub fn prepare(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, strokes: &[Stroke], target_px: [u32; 2]) {
        let segments = segments(strokes);
        self.count = segments.len() as u32;
        if segments.is_empty() {
            return;
        }
        self.segments.write(device, queue, &[bytemuck::cast_slice(&segments)]);
        let uniforms = [target_px[0] as f32, target_px[1] as f32, 0.0, 0.0];
        queue.write_buffer(&self.target, 0, bytemuck::cast_slice(&uniforms));
    }

    /// One draw of all segments. Replaces group 0.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(segments) = self.segments.buffer().filter(|_| self.count > 0) else { return };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_vertex_buffer(0, segments.slice(..));
        pass.draw(0..4, 0..self.count);
    }
}

/// All halos, then all lines.
fn segments(strokes: &[Stroke]) -> Vec<Segment> {
    let usable = |stroke: &&Stroke| {
        stroke.points_px.iter().all(|point| point.is_finite())
            && stroke.width_px.is_finite()
            && stroke.colour.iter().all(|channel| channel.is_finite())
    };
    let mut all = Vec::new();
    for stroke in strokes.iter().filter(usable) {
        let halo = [0.0, 0.0, 0.0, HALO_ALPHA * stroke.colour[3]];
        push_segments(&mut all, stroke, halo, 0.5 * stroke.width_px + HALO_PX, 2.0 * HALO_PX);
    }
    for stroke in strokes.iter().filter(usable) {
        push_segments(&mut all, stroke, stroke.colour, 0.5 * stroke.width_px, 1.0);
    }
    all
}

fn push_segments(all: &mut Vec<Segment>, stroke: &Stroke, colour: [f32; 4], half_width_px: f32, soft_px: f32) {
    let mut points = stroke.points_px.clone();
    points.dedup_by(|a, b| a.distance_squared(*b) < 1e-6);
    if let [dot] = points[..] {
        points.push(dot + Vec2::new(1e-3, 0.0));
    }
    let last = points.len().saturating_sub(1);
    // A stroke that ends where it began has a joint there as well.
    let closed = last > 2 && points[0].distance_squared(points[last]) < 1e-6;
    let direction = |i: usize| (points[i + 1] - points[i]).normalize_or_zero();
    // The cut at a joint halves the angle: its normal is the mean direction through the joint.
    let cut = |before: usize, after: usize| (direction(before) + direction(after)).normalize_or_zero();
    for i in 0..last {
        if all.len() >= MOST_SEGMENTS {
            return;
        }
        let start = match i {
            0 if closed => cut(last - 1, 0),
            0 => Vec2::ZERO,
            _ => cut(i - 1, i),
        };
        let end = match i + 1 {
            next if next < last => cut(i, next),
            _ if closed => cut(i, 0),
            _ => Vec2::ZERO,
        };
        let (from, to) = (points[i], points[i + 1]);
        all.push(Segment {
            ends_px: [from.x, from.y, to.x, to.y],
            joints: [start.x, start.y, -end.x, -end.y],
            colour,
            half_width_px,
            soft_px,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stroke(points: &[(f32, f32)]) -> Stroke {
        Stroke { points_px: points.iter().map(|&(x, y)| Vec2::new(x, y)).collect(), width_px: 2.0, colour: [1.0; 4] }
    }

    #[test]
    fn every_point_near_a_joint_belongs_to_one_segment() {
        let made = segments(&[stroke(&[(0.0, 0.0), (40.0, 0.0), (60.0, 30.0), (20.0, 50.0)])]);
        let lines = &made[made.len() / 2..];
        assert_eq!(lines.len(), 3);
        for step in 0..200 {
            let (sin, cos) = (step as f32 * 0.031_4 + 0.01).sin_cos();
            let at = Vec2::new(40.0, 0.0) + 2.0 * Vec2::new(cos, sin);
            let owners = lines[..2]
                .iter()
                .filter(|s| {
                    let from = at - Vec2::new(s.ends_px[0], s.ends_px[1]);
                    let to = at - Vec2::new(s.ends_px[2], s.ends_px[3]);
                    let start = Vec2::new(s.joints[0], s.joints[1]);
                    from.dot(start) + (1.0 - start.length_squared()) > 0.0
                        && to.dot(Vec2::new(s.joints[2], s.joints[3])) >= 0.0
                })
                .count();
            assert_eq!(owners, 1, "{at}");
        }
    }

    #[test]
    fn odd_strokes_are_drawn_or_left_out_without_harm() {
        assert!(segments(&[stroke(&[])]).is_empty());
        assert_eq!(segments(&[stroke(&[(3.0, 4.0)])]).len(), 2, "a dot and its halo");
        assert_eq!(segments(&[stroke(&[(3.0, 4.0), (3.0, 4.0)])]).len(), 2);
        assert!(segments(&[stroke(&[(f32::NAN, 0.0), (1.0, 1.0)])]).is_empty());
        // A line that doubles back has no cut there, and no NaN.
        let back = segments(&[stroke(&[(0.0, 0.0), (9.0, 0.0), (0.0, 0.0)])]);
        assert!(back.iter().all(|s| s.joints.iter().all(|v| v.is_finite())));
    }

    #[test]
    fn text_ends_where_its_width_says() {
        let strokes = text("H", Vec2::new(100.0, 50.0), 12.0, Align::Right, [1.0; 4]);
        let right = strokes.iter().flat_map(|s| &s.points_px).map(|p| p.x).fold(f32::MIN, f32::max);
        assert!((right - 100.0).abs() < 1e-4, "{right}");
    }
}
