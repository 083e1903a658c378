// terrain.wgsl: draws blocks of ground. The vertex stage does the work.
// Reads:  group 0 frame; group 1 the window: height, light and ground map textures, toroidal by slot; one detail texture.
//         No vertex buffer: a vertex is its index among the block's posts, an instance is a slot.
// Writes: display colour; reverse-Z depth, near / distance.
// Host:   visual/src/passes/terrain.rs, visual/src/passes/terrain_textures.rs
// Twin:   position and height: terrain::Field (bit-equal, `poligon verify`).
// Invariant: a post's position is formed from whole-number differences, so neighbouring blocks agree on it to the bit.

//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"
//!include "shared/display.wgsl"
//!include "shared/posts.wgsl"
//!include "shared/light.wgsl"
//!include "shared/detail.wgsl"
//!include "shared/water.wgsl"

// How many of the detail texture's two scales are read: 0, 1 or 2.
override DETAIL: u32 = 2u;
// 1: tint by level.
override OVERLAY: u32 = 0u;
// The map's alpha at the shore line; more where water within its outlines is draped on the block, which the map's, known
// to a texel, must not stick out of.
override SHORE: f32 = 0.5;

struct Surface {
    @builtin(position) @invariant clip: vec4<f32>,
    // Column and row in the block, in posts; level of the ground map.
    @location(0) local: vec3<f32>,
    // Light scattered towards the eye, and the share of the ground's own light that arrives.
    @location(1) haze: vec4<f32>,
    // Slot's corner in the window, in blocks, and the level for the overlay.
    @location(2) @interpolate(flat) slot: vec3<f32>,
    // Places in the detail texture: coarse scale, fine scale.
    @location(5) detail: vec4<f32>,
}

struct WaterSurface {
    @builtin(position) @invariant clip: vec4<f32>,
    @location(0) local: vec3<f32>,
    @location(1) haze: vec4<f32>,
    @location(2) @interpolate(flat) slot: vec3<f32>,
    @location(3) relative_m: vec3<f32>,
    // Radiance of the sky mirrored in still water.
    @location(4) mirrored: vec3<f32>,
    @location(5) detail: vec4<f32>,
}

@vertex
fn terrain_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) slot: u32) -> Surface {
    let post = post_of(index, slot);
    var surface: Surface;
    surface.clip = frame.clip_from_relative * vec4<f32>(post.relative_m, 1.0);
    surface.local = vec3<f32>(vec2<f32>(post.local), map_level(post.relative_m));
    surface.haze = haze(post.relative_m);
    surface.slot = vec3<f32>(vec2<f32>(post.slot), post.level);
    surface.detail = detail_places(slot, post.local);
    return surface;
}

@vertex
fn water_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) slot: u32) -> WaterSurface {
    let post = post_of(index, slot);
    var surface: WaterSurface;
    surface.clip = frame.clip_from_relative * vec4<f32>(post.relative_m, 1.0);
    surface.local = vec3<f32>(vec2<f32>(post.local), map_level(post.relative_m));
    surface.haze = haze(post.relative_m);
    surface.slot = vec3<f32>(vec2<f32>(post.slot), post.level);
    surface.detail = detail_places(slot, post.local);
    surface.relative_m = post.relative_m;
    surface.mirrored = mirrored_sky(post.relative_m);
    return surface;
}

// Level 1 where a texel of level 0 spans less than about two pixels across, and so less than one up a slope.
fn map_level(relative_m: vec3<f32>) -> f32 {
    let texel_px = window.step_m * (f32(TILE - 2u) / (MAP_SIDE - 1.0)) * frame.focal_px / length(relative_m);
    return clamp(2.8 - texel_px, 0.0, 1.0);
}

@fragment
fn terrain_fragment(surface: Surface) -> @location(0) vec4<f32> {
    let light = light_at(surface.local.xy, surface.slot.xy);
    let map = map_at(surface.local, surface.slot.xy);
    var ground = Detail(map.rgb * map.rgb, vec2<f32>(0.0));
    if DETAIL > 0u {
        ground = detailed(map.rgb, surface.detail);
    }
    let colour = overlaid(lit(ground.albedo, light, ground.tilt), surface.slot.z);
    return shown(colour, surface.haze, surface.clip.xy);
}

@fragment
fn water_fragment(surface: WaterSurface) -> @location(0) vec4<f32> {
    let light = light_at(surface.local.xy, surface.slot.xy);
    let map = map_at(surface.local, surface.slot.xy);
    // The shore line between texels, about as wide as a pixel.
    let wet = smoothstep(SHORE - 0.01, SHORE + 0.01, map.a);
    // Without detail: no ripple, and ground as bright as its map.
    var near = vec4<f32>(0.5);
    if DETAIL > 0u {
        near = textureSample(detail_texture, detail_sampler, mix(surface.detail.xy, ripples_at(surface.local.xy), wet));
    }
    let bed = mix(map.rgb * map.rgb, water_bed(map), wet);
    let ground = lit(bed * mix(0.6 + 0.8 * near.b, 1.0, wet), light, (near.rg - 0.5) * 0.3 * (1.0 - wet));
    let water = water_seen(ground, light, surface.relative_m, near.rg, surface.mirrored);
    let colour = overlaid(mix(ground, water, wet), surface.slot.z);
    return shown(colour, surface.haze, surface.clip.xy);
}

fn overlaid(colour: vec3<f32>, level: f32) -> vec3<f32> {
    if OVERLAY == 0u {
        return colour;
    }
    // Level 0 green, level 1 blue, mixed orange.
    var tint = vec3<f32>(0.1, 0.7, 0.2);
    if level > 1.5 {
        tint = vec3<f32>(0.9, 0.45, 0.05);
    } else if level > 0.5 {
        tint = vec3<f32>(0.1, 0.25, 0.9);
    }
    return mix(colour, tint * (0.15 + dot(colour, vec3<f32>(0.3, 0.6, 0.1))), 0.6);
}
