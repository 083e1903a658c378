// canopy.wgsl: draws the closed forest where its trees are too far and too many to be drawn one by one.
// Reads:  group 0 frame; group 1 the window's light maps (vertex stage); group 2 a crown texture; group 3 a tile's place.
// Writes: display colour; reverse-Z depth, near / distance. Edges are cut out along the crowns.
// Host:   visual/src/passes/canopy.rs

//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"
//!include "shared/display.wgsl"
//!include "shared/posts.wgsl"
//!include "shared/light.wgsl"

struct Tile {
    origin_m: vec2<f32>,    // east and south of the eye
    cell_m: f32,
    start_m: f32,           // begins to rise from the ground
    reach_m: f32,           // is gone
    crown_m: f32,           // side of the crown texture on the ground
    phase: vec2<f32>,       // of the crown texture at the tile's corner
    turned_phase: vec2<f32>,    // the same of the second scale
    turned_m: f32,          // side of the crown texture on the ground, second scale
    pad: f32,
}

@group(2) @binding(0) var crowns: texture_2d<f32>;
@group(2) @binding(1) var crown_sampler: sampler;
@group(3) @binding(0) var<uniform> tile: Tile;

struct Surface {
    @builtin(position) clip: vec4<f32>,
    // Places in the crown texture: first scale, second scale.
    @location(0) uv: vec4<f32>,
    @location(1) haze: vec4<f32>,
    @location(2) light: vec4<f32>,
    // Share of forest, share of conifers, a shade, how far it is risen.
    @location(3) looks: vec4<f32>,
}

// Sun and sky light at a place on the ground, as its light map has them.
fn light_under(relative_m: vec2<f32>) -> vec4<f32> {
    let posts = (relative_m + window.eye_fraction_m) / window.step_m;
    let cells = i32(TILE) - 2;
    let whole = window.eye_post + vec2<i32>(floor(posts));
    let block = vec2<i32>(floor((vec2<f32>(whole) + 0.5) / f32(cells)));
    let local = vec2<f32>(whole - block * cells) + fract(posts);
    let side = blocks[0].side;
    let slot = ((block % side) + side) % side;
    return light_at(local, vec2<f32>(slot));
}

// The crown texture's mean red, as the last mip has it.
const MEAN_CROWN: f32 = 0.303;

// As the host's TURN.
fn turned(at: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(0.8 * at.x - 0.6 * at.y, 0.6 * at.x + 0.8 * at.y);
}

@vertex
fn canopy_vertex(
    @location(0) at: vec2<u32>,
    @location(1) ground_m: f32,
    @location(2) high_m: f32,
    @location(3) looks: vec4<f32>,
) -> Surface {
    let plan_m = tile.origin_m + vec2<f32>(at) * tile.cell_m;
    let foot_m = vec3<f32>(plan_m.x, (ground_m - frame.eye_high_m.y) - frame.eye_low_m.y, plan_m.y);
    let distance_m = length(foot_m);
    // Near the eye the trees themselves are enough, at the reach the ground map is.
    let risen = smoothstep(tile.start_m, 2.5 * tile.start_m, distance_m)
        * (1.0 - smoothstep(0.85 * tile.reach_m, tile.reach_m, distance_m));
    let at_m = foot_m + vec3<f32>(0.0, mix(-2.0, high_m, risen), 0.0);
    var surface: Surface;
    surface.clip = frame.clip_from_relative * vec4<f32>(at_m, 1.0);
    let within_m = vec2<f32>(at) * tile.cell_m;
    surface.uv = vec4<f32>(within_m / tile.crown_m + tile.phase, turned(within_m) / tile.turned_m + tile.turned_phase);
    surface.haze = haze(at_m);
    surface.light = light_under(plan_m);
    surface.looks = vec4<f32>(looks.xyz, risen);
    return surface;
}

@fragment
fn canopy_fragment(surface: Surface) -> @location(0) vec4<f32> {
    // Crowns of two sizes over each other: together the two scales repeat nowhere in sight.
    let small = textureSample(crowns, crown_sampler, surface.uv.xy);
    let large = textureSample(crowns, crown_sampler, surface.uv.zw);
    let crown = 0.5 * (small + large);
    // The edge runs between crowns: the tall ones stand farthest out.
    if surface.looks.x + 0.4 * (crown.a - 0.5) < 0.62 || surface.looks.w < 0.02 {
        discard;
    }
    // The means of the trees that stand in it (vegetation/src/species.rs), and stands that differ in age and kind.
    let conifer = vec3<f32>(0.036, 0.053, 0.025);
    let broadleaf = vec3<f32>(0.054, 0.077, 0.028);
    let stand = surface.looks.z - 0.5;
    let warm = vec3<f32>(1.0 + 0.30 * stand, 1.0, 1.0 - 0.30 * stand);
    let shade = 1.0 + 0.9 * stand + 4.0 * (crown.r - MEAN_CROWN);
    let albedo = mix(broadleaf, conifer, surface.looks.y) * warm * max(shade, 0.15);
    // The second scale's slopes, turned back.
    let turned_slope = large.gb * 2.0 - 1.0;
    let tilt = small.gb * 2.0 - 1.0 + vec2<f32>(dot(turned_slope, vec2<f32>(0.8, 0.6)), dot(turned_slope, vec2<f32>(-0.6, 0.8)));
    // Crowns are upright however the ground slopes: half of its tilt is seen, and light wraps around them as in
    // plants.wgsl's crown_light.
    let plan = (surface.light.rg * 2.0 - 1.0) * 0.5 + tilt * 0.5;
    let normal = normalize(vec3<f32>(plan.x, 0.8, plan.y));
    let wrapped = max(dot(normal, frame.sun_direction) + 0.30, 0.0) * (1.0 / 1.30) * key_seen(surface.light);
    let sky = surface.light.a * (0.55 + 0.45 * normal.y);
    let bounced = 0.10 * max(frame.sun_direction.y, 0.0);
    let light = (frame.sun_irradiance * (wrapped + bounced) + frame.sky_irradiance * sky) * (1.0 / 3.14159265);
    return shown(albedo * light, surface.haze, surface.clip.xy);
}
