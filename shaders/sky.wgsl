// sky.wgsl: the sky and the sun's disc, wherever nothing nearer was drawn.
// Reads:  group 0. No vertex buffer: one triangle over the picture.
// Writes: display colour at depth 0 (infinitely far), tested GreaterEqual, so that covered pixels cost nothing.
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
    let direction = normalize(corner.ray);
    let shown = display(sky_radiance(direction) + sun(direction));
    return vec4<f32>(dither(shown, corner.clip.xy), 1.0);
}

// The disc and a close glow, as display light; the horizon cuts both.
fn sun(direction: vec3<f32>) -> vec3<f32> {
    let away = direction - frame.sun_direction;
    // Chord; equal to the angle to within 1 % up to half a radian.
    let angle = sqrt(dot(away, away));
    let pixel_rad = 1.0 / frame.focal_px;
    let disc = 8.0 * clamp((frame.sun_radius_rad - angle) / pixel_rad + 0.5, 0.0, 1.0);
    let near = angle / frame.sun_radius_rad;
    let glow = 0.6 / (1.0 + 0.15 * near * near);
    let above = clamp(direction.y / pixel_rad + 0.5, 0.0, 1.0);
    // The glow ends softly: the ground that fades into the horizon has none.
    let aloft = clamp(direction.y * 40.0, 0.0, 1.0);
    return frame.disc * ((disc * above + glow * aloft) / frame.exposure);
}
