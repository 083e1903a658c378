// shared/light.wgsl: light on the ground and on what stands on it, and the way from there to the display.
// Needs: shared/frame.wgsl, shared/sky.wgsl, shared/display.wgsl, shared/posts.wgsl. Group 1, bindings 3 and 6.
// Host: visual/src/passes/terrain.rs.

@group(1) @binding(3) var light_maps: texture_2d_array<f32>;
@group(1) @binding(6) var map_sampler: sampler;

// Light scattered towards the eye on the way to a point, and the share of the point's own light that arrives.
fn haze(relative_m: vec3<f32>) -> vec4<f32> {
    let through = haze_from_eye(relative_m);
    return vec4<f32>(scattered(relative_m) * (1.0 - through), through);
}

fn light_at(local: vec2<f32>, slot: vec2<f32>) -> vec4<f32> {
    let texel = slot * f32(TILE) + local + 0.5;
    return textureSampleLevel(light_maps, map_sampler, texel * window.light_texel, window.light_layer, 0.0);
}

// Share of the key light that reaches a place, by its texel of the light map: no light map shadows the moon.
fn key_seen(light: vec4<f32>) -> f32 {
    return max(light.b, frame.moon_key);
}

// Radiance of ground of an albedo under sun and sky; `light` is a texel of the light map, `tilt` bends its normal.
fn lit(albedo: vec3<f32>, light: vec4<f32>, tilt: vec2<f32>) -> vec3<f32> {
    let plan = light.rg * 2.0 - 1.0;
    let up = sqrt(max(1.0 - dot(plan, plan), 0.01));
    // The tilt is small: the bent normal is not made unit length again.
    let sun = max(dot(vec3<f32>(plan + tilt, up).xzy, frame.sun_direction), 0.0) * key_seen(light);
    let sky = light.a * (0.5 + 0.5 * up);
    // What the sky does not reach is lit by other ground a little.
    let bounced = 0.12 * (1.0 - sky) * max(frame.sun_direction.y, 0.0);
    return albedo * (1.0 / 3.14159265) * (frame.sun_irradiance * (sun + bounced) + frame.sky_irradiance * sky);
}

fn shown(colour: vec3<f32>, haze: vec4<f32>, pixel: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(dither(display(colour * haze.a + haze.rgb), pixel), 1.0);
}
