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
    let upright = abs(frame.disc_direction.y) < 0.9;
    let level = normalize(cross(frame.disc_direction, select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), upright)));
    let across = cross(level, frame.disc_direction);
    let direction = frame.disc_direction + (level * away.x + across * away.y) * frame.sun_radius_rad;
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

// The moon: a sphere lit by the sun, and its glow; added to what is there.

const MOON_RADII: f32 = 10.0;

struct MoonCorner {
    @builtin(position) clip: vec4<f32>,
    @location(0) away: vec2<f32>,                             // from the moon's centre, in its radii
    @location(1) height: f32,                                 // about the sine of the elevation
    @location(2) @interpolate(flat) to_sun: vec3<f32>,        // from the moon: right, up, towards the eye
}

@vertex
fn moon_vertex(@builtin(vertex_index) index: u32) -> MoonCorner {
    let away = (vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0) * MOON_RADII;
    let to_moon = frame.moon_direction;
    let upright = abs(to_moon.y) < 0.9;
    let level = normalize(cross(to_moon, select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), upright)));
    let across = cross(level, to_moon);
    let direction = to_moon + (level * away.x + across * away.y) * frame.moon_radius_rad;
    let clip = frame.clip_from_relative * vec4<f32>(direction, 0.0);
    var corner: MoonCorner;
    corner.clip = vec4<f32>(clip.xy, 0.0, clip.w);
    corner.away = away;
    corner.height = direction.y;
    corner.to_sun = vec3<f32>(
        dot(frame.moon_to_sun, level),
        dot(frame.moon_to_sun, across),
        -dot(frame.moon_to_sun, to_moon),
    );
    return corner;
}

@fragment
fn moon_fragment(corner: MoonCorner) -> @location(0) vec4<f32> {
    let radii = length(corner.away);
    let radius_px = frame.moon_radius_rad * frame.focal_px;
    let cover = clamp((1.0 - radii) * radius_px + 0.5, 0.0, 1.0);
    let normal = vec3<f32>(corner.away, sqrt(max(1.0 - radii * radii, 0.0)));
    // The moon's dust sends light back the way it came: the disc is nearly flat but for the border of the night, which is
    // a pixel soft at least.
    let lit = smoothstep(-0.3 / max(radius_px, 1.0), 0.2, dot(normal, corner.to_sun));
    let glow = frame.moon_share * 0.06 * max(1.0 / (1.0 + 0.3 * radii * radii) - 1.0 / (1.0 + 0.3 * MOON_RADII * MOON_RADII), 0.0);
    let above = clamp(corner.height * frame.focal_px + 0.5, 0.0, 1.0);
    let aloft = clamp(corner.height * 40.0, 0.0, 1.0);
    // The night side has a little light from the Earth.
    return vec4<f32>(display(frame.moon_light) * (cover * above * (lit + 0.015) + glow * aloft), 0.0);
}
