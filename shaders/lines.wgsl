// lines.wgsl: anti-aliased strokes over the picture, in one draw.
// Reads:  one instance a segment (pixels, origin top left); group 0 of its own: the target's size.
// Writes: display colour, premultiplied alpha.
// Host:   visual/src/passes/lines.rs (offsets compared in tests/shader_contract.rs)

struct LineUniforms {
    target_px: vec2<f32>,
    unused: vec2<f32>,
}

@group(0) @binding(0) var<uniform> lines: LineUniforms;

struct Segment {
    @location(0) ends_px: vec4<f32>,   // from x y, to x y
    @location(1) joints: vec4<f32>,    // inward normals of the cut at each end; 0 0 at a free, round end
    @location(2) colour: vec4<f32>,    // linear, straight alpha
    @location(3) half_width_px: f32,
    @location(4) soft_px: f32,         // width over which the edge fades, 1 for a crisp line
}

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) at_px: vec2<f32>,
    @location(1) @interpolate(flat) ends_px: vec4<f32>,
    @location(2) @interpolate(flat) joints: vec4<f32>,
    @location(3) @interpolate(flat) colour: vec4<f32>,
    @location(4) @interpolate(flat) edge: vec2<f32>,
}

@vertex
fn lines_vertex(@builtin(vertex_index) index: u32, segment: Segment) -> Corner {
    let from_px = segment.ends_px.xy;
    let to_px = segment.ends_px.zw;
    let length_px = distance(from_px, to_px);
    let along = select(vec2<f32>(1.0, 0.0), (to_px - from_px) / max(length_px, 1e-6), length_px > 1e-6);
    let across = vec2<f32>(-along.y, along.x);
    // Beyond half the fade nothing is covered; half a pixel more, so that no covered pixel centre is missed.
    let reach_px = segment.half_width_px + 0.5 * segment.soft_px + 0.5;
    let end = f32(index & 1u);
    let side = f32((index >> 1u) & 1u) * 2.0 - 1.0;
    let at_px = mix(from_px, to_px, end) + (along * (end * 2.0 - 1.0) + across * side) * reach_px;
    var corner: Corner;
    corner.clip = vec4<f32>(at_px.x / lines.target_px.x * 2.0 - 1.0, 1.0 - at_px.y / lines.target_px.y * 2.0, 0.0, 1.0);
    corner.at_px = at_px;
    corner.ends_px = segment.ends_px;
    corner.joints = segment.joints;
    corner.colour = segment.colour;
    corner.edge = vec2<f32>(segment.half_width_px, segment.soft_px);
    return corner;
}

@fragment
fn lines_fragment(corner: Corner) -> @location(0) vec4<f32> {
    let from_px = corner.at_px - corner.ends_px.xy;
    let to_px = corner.at_px - corner.ends_px.zw;
    let along = corner.ends_px.zw - corner.ends_px.xy;
    let part = clamp(dot(from_px, along) / max(dot(along, along), 1e-9), 0.0, 1.0);
    let away_px = distance(from_px, along * part);
    // Where two segments meet, each keeps its own side of the cut, so nothing is painted twice.
    // The cut is moved a little, the same way for both, so that rounding cannot put a pixel centre on it; free ends pass.
    let free = 1.0 - dot(corner.joints.xy, corner.joints.xy);
    let mine = dot(from_px, corner.joints.xy) + free > 0.003 && dot(to_px, corner.joints.zw) >= -0.003;
    let cover = clamp((corner.edge.x - away_px) / corner.edge.y + 0.5, 0.0, 1.0);
    let alpha = select(0.0, cover * corner.colour.a, mine);
    return vec4<f32>(corner.colour.rgb * alpha, alpha);
}
