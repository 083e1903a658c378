// shared/water.wgsl: what open water looks like, in the ground map and in the outlines draped on it alike.
// Needs: shared/frame.wgsl, shared/posts.wgsl, shared/light.wgsl, shared/detail.wgsl. Group 1, bindings 4 and 6.
// Host: visual/src/passes/terrain.rs; the maps: terrain::block::ground_map.

// Texels along a block's ground map.
const MAP_SIDE: f32 = 64.0;

@group(1) @binding(4) var ground_maps: texture_2d<f32>;

// `local` is column and row in the block, in posts, and the level of the map.
fn map_at(local: vec3<f32>, slot: vec2<f32>) -> vec4<f32> {
    let texel = slot * MAP_SIDE + local.xy * ((MAP_SIDE - 1.0) / f32(TILE - 2u)) + 0.5;
    return textureSampleLevel(ground_maps, map_sampler, texel * window.map_texel, local.z);
}

// Albedo of the water of a ground map's texel: near a shore the map has the land's, and water its own.
fn water_bed(map: vec4<f32>) -> vec3<f32> {
    return mix(vec3<f32>(0.030, 0.085, 0.090), map.rgb * map.rgb, smoothstep(0.84, 0.97, map.a));
}

// Where ripples are in the detail texture.
fn ripples_at(local: vec2<f32>) -> vec2<f32> {
    return local * (60.0 / f32(TILE - 2u)) + vec2<f32>(frame.time_s * 0.004, frame.time_s * 0.0027);
}

// What still water mirrors of the sky, for the vertex stage. Waves tilt the mirror, so even a grazing view sees sky a
// little above the horizon.
fn mirrored_sky(relative_m: vec3<f32>) -> vec3<f32> {
    let direction = normalize(relative_m);
    return sky_radiance(normalize(vec3<f32>(direction.x, abs(direction.y) + 0.06, direction.z)));
}

// Radiance of water whose bed has the radiance `ground`; `ripple` is the detail texture's slope, 0.5 where it is level.
fn water_seen(ground: vec3<f32>, light: vec4<f32>, relative_m: vec3<f32>, ripple: vec2<f32>, mirrored: vec3<f32>) -> vec3<f32> {
    let to_eye = relative_m * (-1.0 / length(relative_m));
    let tilt = (ripple - 0.5) * 0.16;
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
    return ground * (1.0 - fresnel) + mirrored * fresnel + frame.sun_irradiance * min(glitter, 3.0);
}
