// upscale.wgsl: stretches a picture drawn small over the final target, bilinear.
// Reads:  group 0 of its own: the small picture, seen as plain 8-bit values, and a linear sampler. Four encoded texels
//         are blended and decoded once: on software that costs half of decoding each.
// Writes: linear colour. Host: visual/src/passes/upscale.rs

@group(0) @binding(0) var small_picture: texture_2d<f32>;
@group(0) @binding(1) var small_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) texel: vec2<f32>,
}

@vertex
fn upscale_vertex(@builtin(vertex_index) index: u32) -> Corner {
    let at = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    var corner: Corner;
    corner.clip = vec4<f32>(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0);
    corner.texel = at;
    return corner;
}

@fragment
fn upscale_fragment(corner: Corner) -> @location(0) vec4<f32> {
    let c = textureSampleLevel(small_picture, small_sampler, corner.texel, 0.0).rgb;
    // sRGB to linear by a cubic, within half an 8-bit step above black (C. Hable's fit).
    return vec4<f32>(c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878), 1.0);
}
