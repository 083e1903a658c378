// particles.wgsl: draws soft sprites: smoke and dust lit by sun and sky, fire and tracers that shine.
// Reads:  group 0 frame; instances, far ones first.
// Writes: premultiplied display colour over what is there; depth tested, not written.
// Host:   visual/src/passes/particles.rs, visual/src/particles.rs

//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"
//!include "shared/display.wgsl"

struct Sprite {
    @location(0) relative_m: vec3<f32>,
    @location(1) radius_m: f32,
    @location(2) axis_m: vec3<f32>,
    @location(3) shines: f32,
    @location(4) colour: vec4<f32>,
    @location(5) seed: u32,
}

struct Surface {
    @builtin(position) clip: vec4<f32>,
    // -1 to 1 across and along.
    @location(0) at: vec2<f32>,
    // Light towards the eye before the air, and opacity.
    @location(1) colour: vec4<f32>,
    @location(2) haze: vec4<f32>,
    // Brightness of the side turned to the sun over the middle, as a direction in the sprite.
    @location(3) sunward: vec2<f32>,
    @location(4) @interpolate(flat) shines: f32,
    @location(5) @interpolate(flat) seed: u32,
}

@vertex
fn particles_vertex(sprite: Sprite, @builtin(vertex_index) index: u32) -> Surface {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let distance_m = max(length(sprite.relative_m), 0.1);
    let view = sprite.relative_m / distance_m;
    // A streak lies along its axis as it is seen; a disc's axes are any.
    var up = sprite.axis_m - view * dot(sprite.axis_m, view);
    let seen_m = length(up);
    if seen_m < 1e-3 {
        let steep = abs(view.y) > 0.99;
        up = select(vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(1.0, 0.0, 0.0), steep);
        up = up - view * dot(up, view);
    }
    up = normalize(up);
    let right = cross(view, up);
    // Never thinner than a pixel across; what is added to the width is taken from the strength.
    let least_m = 0.75 * distance_m / frame.focal_px;
    let radius_m = max(sprite.radius_m, least_m);
    let thin = clamp(sprite.radius_m / least_m, 0.25, 1.0);
    let place = sprite.relative_m + right * (corner.x * radius_m) + up * (corner.y * (radius_m + seen_m));

    let through = haze_from_eye(sprite.relative_m);
    // Smoke scatters the sun from all its depth: half of what a surface would.
    let sun_up = smoothstep(-0.02, 0.05, frame.sun_direction.y);
    let lit = (frame.sun_irradiance * (0.42 * sun_up) + frame.sky_irradiance * 0.85) * (1.0 / 3.14159265);
    var surface: Surface;
    surface.clip = frame.clip_from_relative * vec4<f32>(place, 1.0);
    surface.at = corner;
    surface.colour = vec4<f32>(sprite.colour.rgb * mix(lit, vec3<f32>(1.0), sprite.shines), sprite.colour.a * thin);
    surface.haze = vec4<f32>(scattered(sprite.relative_m) * (1.0 - through), through);
    surface.sunward = vec2<f32>(dot(frame.sun_direction, right), dot(frame.sun_direction, up)) * sun_up;
    surface.shines = sprite.shines;
    surface.seed = sprite.seed;
    return surface;
}

fn mixed(value: u32) -> f32 {
    var h = value * 747796405u + 2891336453u;
    h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
    return f32(((h >> 22u) ^ h) & 65535u) / 65535.0;
}

// Smooth noise of a plane, 0 to 1.
fn noise(at: vec2<f32>, seed: u32) -> f32 {
    let cell = floor(at);
    let part = at - cell;
    let blend = part * part * (3.0 - 2.0 * part);
    let base = vec2<u32>(vec2<i32>(cell) + 4096);
    let corner = seed ^ (base.x * 1973u) ^ (base.y * 9277u);
    let east = seed ^ ((base.x + 1u) * 1973u) ^ (base.y * 9277u);
    let south = seed ^ (base.x * 1973u) ^ ((base.y + 1u) * 9277u);
    let both = seed ^ ((base.x + 1u) * 1973u) ^ ((base.y + 1u) * 9277u);
    return mix(mix(mixed(corner), mixed(east), blend.x), mix(mixed(south), mixed(both), blend.x), blend.y);
}

@fragment
fn particles_fragment(surface: Surface) -> @location(0) vec4<f32> {
    let away = length(surface.at);
    // A soft ball with a ragged edge.
    let ragged = noise(surface.at * 2.6, surface.seed) * 0.65 + noise(surface.at * 6.1, surface.seed ^ 77u) * 0.35;
    let body = clamp(1.0 - away, 0.0, 1.0);
    let cover = smoothstep(0.0, 0.55, body - (ragged - 0.35) * 0.45 * select(1.0, 0.0, surface.seed == 0u));
    let shade = 1.0 + 0.45 * dot(surface.at, surface.sunward) - 0.25 * (ragged - 0.5);
    let alpha = surface.colour.a * cover;
    let hot = surface.colour.rgb * mix(max(shade, 0.2), 0.35 + body, surface.shines);
    let seen = display(hot * surface.haze.a + surface.haze.rgb * (1.0 - surface.shines));
    // What shines adds to what lies behind, and hides little of it.
    return vec4<f32>(seen * alpha, alpha * (1.0 - 0.6 * surface.shines));
}
