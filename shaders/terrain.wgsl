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

// Texels along a block's ground map.
const MAP_SIDE: f32 = 64.0;

// How many of the detail texture's two scales are read: 0, 1 or 2.
override DETAIL: u32 = 2u;
// 1: tint by level.
override OVERLAY: u32 = 0u;

@group(1) @binding(4) var ground_maps: texture_2d<f32>;

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
    let direction = normalize(post.relative_m);
    // Waves tilt the mirror, so even a grazing view sees sky a little above the horizon.
    surface.mirrored = sky_radiance(normalize(vec3<f32>(direction.x, abs(direction.y) + 0.06, direction.z)));
    return surface;
}

fn map_at(local: vec3<f32>, slot: vec2<f32>) -> vec4<f32> {
    let texel = slot * MAP_SIDE + local.xy * ((MAP_SIDE - 1.0) / f32(TILE - 2u)) + 0.5;
    return textureSampleLevel(ground_maps, map_sampler, texel * window.map_texel, local.z);
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
    let wet = smoothstep(0.49, 0.51, map.a);
    let ripple_at = surface.local.xy * (60.0 / f32(TILE - 2u)) + vec2<f32>(frame.time_s * 0.004, frame.time_s * 0.0027);
    // Without detail: no ripple, and ground as bright as its map.
    var near = vec4<f32>(0.5);
    if DETAIL > 0u {
        near = textureSample(detail_texture, detail_sampler, mix(surface.detail.xy, ripple_at, wet));
    }
    // Within a texel of the shore the map's colour is half the beach's: water has its own there, as the map's SHALLOW.
    let open_water = smoothstep(0.5, 0.78, map.a);
    let bed = mix(map.rgb * map.rgb, mix(vec3<f32>(0.030, 0.085, 0.090), map.rgb * map.rgb, open_water), wet);
    let ground = lit(bed * mix(0.6 + 0.8 * near.b, 1.0, wet), light, (near.rg - 0.5) * 0.3 * (1.0 - wet));

    let distance_m = length(surface.relative_m);
    let to_eye = surface.relative_m * (-1.0 / distance_m);
    let tilt = (near.rg - 0.5) * 0.16;
    let normal = normalize(vec3<f32>(tilt.x, 1.0, tilt.y));
    let facing = clamp(dot(normal, to_eye), 0.0, 1.0);
    // Schlick, water's 2 % face on; waves keep it from becoming a perfect mirror at the horizon.
    let out = 1.0 - facing;
    let fresnel = 0.02 + 0.62 * (out * out) * (out * out) * out;
    // Sun glitter: the share of waves that have the slope which mirrors the sun to the eye, at a wind of 3 m/s.
    // Source: C. Cox, W. Munk. Measurement of the roughness of the sea surface from photographs of the sun's glitter.
    // 1954: mean square slope 0.003 + 0.00512 * wind.
    let half_way = normalize(to_eye + frame.sun_direction);
    let slope = half_way.xz / max(half_way.y, 0.05) - tilt;
    let waves = exp(dot(slope, slope) * (-1.0 / 0.0184)) * (1.0 / (3.14159265 * 0.0184));
    let steep = half_way.y * half_way.y;
    let toward = 1.0 - max(dot(half_way, to_eye), 0.0);
    let mirror = 0.02 + 0.98 * (toward * toward) * (toward * toward) * toward;
    let glitter = mirror * waves / (4.0 * max(to_eye.y, 0.12) * max(steep * steep, 0.05)) * key_seen(light) * step(0.0, frame.sun_direction.y);
    let water = ground * (1.0 - fresnel) + surface.mirrored * fresnel + frame.sun_irradiance * min(glitter, 3.0);
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
