// objects.wgsl: draws buildings and other things that stand on the ground. The vertex stage lights and hazes.
// Reads:  group 0 frame; group 1 the window: posts and light maps. Vertex buffers: corners, instances.
// Writes: display colour; reverse-Z depth, near / distance.
// Host:   visual/src/passes/objects.rs, visual/src/passes/object_tiles.rs, visual/src/models/
// Invariant: a position is formed from whole-number post differences, as the ground's is.

//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"
//!include "shared/display.wgsl"
//!include "shared/posts.wgsl"
//!include "shared/light.wgsl"

// Sizes on screen, pixels, between which a thing sinks into the ground. Host: GONE_PX.
const GONE_PX: f32 = 1.2;
const WHOLE_PX: f32 = 2.4;

struct Corner {
    @location(0) position_m: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) colour: vec4<f32>,
    // Windows along the wall, storeys above its foot.
    @location(3) facade: vec2<f32>,
    @location(4) seed: u32,
    @location(5) anchor_post: vec2<i32>,
    @location(6) offset_m: vec3<f32>,
    @location(7) scale: f32,
    @location(8) rotation: vec4<f32>,
    @location(9) instance_seed: u32,
    // 1, or less where it is burnt.
    @location(10) shade: f32,
}

struct Surface {
    @builtin(position) @invariant clip: vec4<f32>,
    @location(0) albedo: vec3<f32>,
    @location(1) irradiance: vec3<f32>,
    @location(2) haze: vec4<f32>,
    @location(3) facade: vec2<f32>,
    // Radiance of the sky mirrored in glass.
    @location(4) mirrored: vec3<f32>,
    @location(5) @interpolate(flat) kind: u32,
    @location(6) @interpolate(flat) seed: u32,
}

fn turned(v: vec3<f32>, q: vec4<f32>) -> vec3<f32> {
    let t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}

// The light map where a thing stands: plan normal, sunlight, open sky. Full light where its block is not in the window.
fn light_on(post: vec2<f32>) -> vec4<f32> {
    let cells = f32(TILE - 2u);
    let block = floor(post / cells);
    let side = i32(1.0 / (window.light_texel * f32(TILE)) + 0.5);
    let first = vec2<i32>(block * cells);
    let number = vec2<i32>(block);
    let slot = ((number % side) + side) % side;
    let held = blocks[slot.y * side + slot.x].first_post;
    if held.x != first.x || held.y != first.y {
        return vec4<f32>(0.5, 0.5, step(0.0, frame.sun_direction.y), 1.0);
    }
    return light_at(post - block * cells, vec2<f32>(slot));
}

@vertex
fn objects_vertex(corner: Corner) -> Surface {
    let local_m = turned(corner.position_m * corner.scale, corner.rotation);
    let away = vec2<f32>(corner.anchor_post - window.eye_post);
    // Whole posts first, then the rest, which is small.
    let plan_m = away * window.step_m + (corner.offset_m.xz + local_m.xz - window.eye_fraction_m);
    let up_m = ((corner.offset_m.y + local_m.y) - frame.eye_high_m.y) - frame.eye_low_m.y;
    var relative_m = vec3<f32>(plan_m.x, up_m, plan_m.y);

    // A thing of a pixel or two sinks into the ground by its own size.
    let size_m = exp2(f32(corner.seed & 255u) / 16.0) * corner.scale;
    let size_px = size_m * frame.focal_px / max(length(relative_m), 0.1);
    let sunk = 1.0 - smoothstep(GONE_PX, WHOLE_PX, size_px);
    relative_m.y -= sunk * size_m;

    let normal = turned(corner.normal.xyz, corner.rotation);
    let post = vec2<f32>(corner.anchor_post) + (corner.offset_m.xz + local_m.xz) / window.step_m;
    let light = light_on(post);
    let sun = max(dot(normal, frame.sun_direction), 0.0) * key_seen(light);
    // Sky from above, ground from below: the ground mirrors a seventh of what falls on it.
    let up = 0.5 + 0.5 * normal.y;
    let ground = 0.15 * (frame.sun_irradiance * max(frame.sun_direction.y, 0.0) * key_seen(light) + frame.sky_irradiance * light.a);
    var surface: Surface;
    surface.clip = frame.clip_from_relative * vec4<f32>(relative_m, 1.0);
    surface.albedo = corner.colour.rgb * corner.colour.rgb * corner.shade;
    // The foot of a wall, below storey 0, sees less of the sky: by its neighbours.
    let open_sky = select(1.0, 0.72, corner.facade.y < 0.0);
    surface.irradiance =
        open_sky * (frame.sun_irradiance * sun + frame.sky_irradiance * (light.a * up) + ground * (1.0 - up));
    surface.haze = haze(relative_m);
    surface.facade = corner.facade;
    let view = normalize(relative_m);
    let mirror = reflect(view, normal);
    surface.mirrored = sky_radiance(normalize(vec3<f32>(mirror.x, max(mirror.y, 0.03), mirror.z)));
    surface.kind = u32(corner.colour.a * 255.0 + 0.5);
    surface.seed = (corner.seed >> 8u) ^ corner.instance_seed;
    return surface;
}

fn mixed(value: u32) -> u32 {
    var h = value * 747796405u + 2891336453u;
    h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
    return (h >> 22u) ^ h;
}

// Share of a pixel covered by a bar of a half width about the middle of its cell.
fn bar(at: f32, half_width: f32, pixel: f32) -> f32 {
    let edge = clamp((half_width - abs(at - 0.5)) / max(pixel, 1e-4) + 0.5, 0.0, 1.0);
    // Where a pixel spans cells: their mean.
    return mix(edge, 2.0 * half_width, clamp(pixel * 2.0 - 0.6, 0.0, 1.0));
}

@fragment
fn objects_fragment(surface: Surface) -> @location(0) vec4<f32> {
    let pixel = fwidth(surface.facade);
    let cell = floor(surface.facade);
    let within = surface.facade - cell;
    // By the sun, whatever the key light is.
    let night = 1.0 - smoothstep(-0.09, 0.0, frame.sun_sin);
    var colour = surface.albedo * surface.irradiance * (1.0 / 3.14159265);
    let windowed = surface.kind == 1u || surface.kind == 2u;
    if windowed && surface.facade.y > 0.0 {
        // Homes have upright panes, offices bands.
        let half_width = select(vec2<f32>(0.19, 0.25), vec2<f32>(0.42, 0.22), surface.kind == 2u);
        let pane = bar(within.x, half_width.x, pixel.x) * bar(within.y, half_width.y, pixel.y);
        let cell_hash = mixed(surface.seed ^ (u32(i32(cell.x) + 512) * 1973u) ^ (u32(i32(cell.y) + 512) * 9277u));
        let glass = surface.albedo * surface.irradiance * 0.05 + surface.mirrored * 0.16;
        colour = mix(colour, glass, pane);
        // Six windows of ten are lit in the end; where a pixel spans several, their mean.
        let share = 0.6 * frame.lamps;
        let lit_one = select(0.0, 1.0, f32(cell_hash & 255u) < 256.0 * share);
        let many = clamp(max(pixel.x, pixel.y) * 2.0 - 0.6, 0.0, 1.0);
        let on = mix(lit_one, share, many);
        let bright = mix(0.35 + f32((cell_hash >> 8u) & 255u) / 255.0 * 0.9, 0.8, many);
        let cool = (cell_hash >> 16u) % 5u == 0u;
        let lamp = select(vec3<f32>(1.0, 0.58, 0.26), vec3<f32>(0.72, 0.85, 1.0), cool && many < 0.5);
        colour += lamp * (night * pane * on * bright * 0.55);
    } else if surface.kind == 3u {
        colour = colour + surface.mirrored * 0.25 + vec3<f32>(0.5, 0.42, 0.3) * (0.12 * night * frame.lamps);
    } else if surface.kind == 4u {
        colour += surface.albedo * (2.5 * night * frame.lamps);
    }
    return shown(colour, surface.haze, surface.clip.xy);
}
