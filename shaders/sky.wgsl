// sky.wgsl: the sky and the sun's disc, wherever nothing nearer was drawn.
// Reads:  group 0. No vertex buffer: one triangle over the picture, one strip of two about the sun.
// Writes: display colour at depth 0 (infinitely far), tested GreaterEqual, so that covered pixels cost nothing. The sun
//         is added to it.
// Host:   visual/src/passes/sky.rs

//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"
//!include "shared/display.wgsl"

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) ray: vec3<f32>,
}

@vertex
fn sky_vertex(@builtin(vertex_index) index: u32) -> Corner {
    // (0, 0), (2, 0), (0, 2): the picture is the unit square of it.
    let at = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    var corner: Corner;
    corner.clip = vec4<f32>(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0);
    corner.ray = frame.ray_corner + frame.ray_right * at.x + frame.ray_down * at.y;
    return corner;
}

@fragment
fn sky_fragment(corner: Corner) -> @location(0) vec4<f32> {
    let direction = corner.ray * inverseSqrt(dot(corner.ray, corner.ray));
    return vec4<f32>(dither(display(sky_radiance(direction)), corner.clip.xy), 1.0);
}

// The sun's disc and close glow: a small square about the sun, added to what is there already.

const GLOW_RADII: f32 = 30.0;

struct SunCorner {
    @builtin(position) clip: vec4<f32>,
    @location(0) away: vec2<f32>,    // from the sun's centre, in radii of the disc
    @location(1) height: f32,        // about the sine of the elevation
}

@vertex
fn sun_vertex(@builtin(vertex_index) index: u32) -> SunCorner {
    let away = (vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0) * GLOW_RADII;
    let upright = abs(frame.sun_direction.y) < 0.9;
    let level = normalize(cross(frame.sun_direction, select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), upright)));
    let across = cross(level, frame.sun_direction);
    let direction = frame.sun_direction + (level * away.x + across * away.y) * frame.sun_radius_rad;
    let clip = frame.clip_from_relative * vec4<f32>(direction, 0.0);
    var corner: SunCorner;
    // A direction has clip z 0 by itself: infinitely far.
    corner.clip = vec4<f32>(clip.xy, 0.0, clip.w);
    corner.away = away;
    corner.height = direction.y;
    return corner;
}

@fragment
fn sun_fragment(corner: SunCorner) -> @location(0) vec4<f32> {
    let radii = length(corner.away);
    let radius_px = frame.sun_radius_rad * frame.focal_px;
    let disc = 2.0 * clamp((1.0 - radii) * radius_px + 0.5, 0.0, 1.0);
    // 0 at the square's edge, so that the square is not seen.
    let glow = 0.9 * max(1.0 / (1.0 + 0.1 * radii * radii) - 1.0 / (1.0 + 0.1 * GLOW_RADII * GLOW_RADII), 0.0);
    // The horizon cuts the disc; the glow ends softly, since the ground that fades into the horizon has none.
    let above = clamp(corner.height * frame.focal_px + 0.5, 0.0, 1.0);
    let aloft = clamp(corner.height * 40.0, 0.0, 1.0);
    return vec4<f32>(frame.disc * (disc * above + glow * aloft), 0.0);
}
