// lights.wgsl: points of light, as sprites that face the eye, all of a tile in one draw.
// Reads:  group 0; group 1: where the eye is among the posts; one instance a light.
// Writes: display colour added to what is there; depth tested, the lower half on level ground, not written.
// Host:   visual/src/passes/lights.rs (offsets compared in tests/shader_contract.rs).
//
// A light gives the eye an illuminance, in lux, by the inverse square and what the air lets through. It is seen where that
// exceeds the threshold for the brightness around (frame.threshold_lux), and it looks as bright as the square root of the
// ratio (S. S. Stevens 1961: exponent 0.5 for a point source). A sprite never is smaller than the bell of SOFT_PX, whose
// sum over the pixels is the same wherever it falls between them, so that no light sparkles: a faint one is dimmer, not
// smaller, a bright one is wider and has a halo.

//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"

struct LightsUniforms {
    eye_post: vec2<i32>,         // column and row of the post north-west of the eye
    eye_fraction_m: vec2<f32>,   // the eye's east and south of that post
    step_m: f32,                 // between posts
    thin_from_m: f32,            // beyond this only lights of low rank are left, brighter
    thinnest: f32,               // the least share of them that is left
    directed: f32,               // share of their intensity that lights with a beam are set to
}

@group(1) @binding(0) var<uniform> lights: LightsUniforms;

struct Light {
    @location(0) post: vec2<i32>,       // column and row of the post north-west of it
    @location(1) local_m: vec2<f32>,    // east and south of that post
    @location(2) height: vec2<f32>,     // above sea level, metres; intensity, candela
    @location(3) half_rad: vec2<f32>,   // half angles across and upright; a slope's transition for the second
    @location(4) axis: vec4<f32>,       // along the beam; w: rank
    @location(5) colour: vec4<f32>,     // in front; w: kind / 255
    @location(6) back: vec4<f32>,       // behind; w: period in tenths of a second / 255
}

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) away_px: vec2<f32>,
    @location(1) @interpolate(flat) colour: vec3<f32>,
    @location(2) @interpolate(flat) shape: vec4<f32>,   // 1 / (2 soft^2), peak, the halo's of both
}

const SOFT_PX: f32 = 0.6;
const WIDEST_PX: f32 = 10.0;
// Brightness shown, of display white, at the threshold.
const AT_THRESHOLD: f32 = 0.08;
const LAMP_RADIUS_M: f32 = 0.12;
const TAU: f32 = 6.2831853;

// Elevation of a direction.
fn elevation(direction: vec3<f32>) -> f32 {
    return atan2(direction.y, length(direction.xz));
}

// Angle in plan between the beam's azimuth and a direction's, 0 to pi.
fn turned(axis: vec2<f32>, to_eye: vec2<f32>) -> f32 {
    return abs(atan2(axis.x * to_eye.y - axis.y * to_eye.x, dot(axis, to_eye)));
}

// Colour towards the eye times the share of the intensity that goes there. Twin: terrain's LightPoint::towards.
fn emitted(light: Light, to_eye: vec3<f32>) -> vec3<f32> {
    let kind = u32(round(light.colour.w * 255.0));
    if kind == 0u {
        return light.colour.rgb;
    }
    let up = elevation(to_eye) - elevation(light.axis.xyz);
    var axis = light.axis.xz;
    if kind == 3u {
        let angle = frame.time_s * TAU / max(light.back.w * 25.5, 0.1);
        axis = vec2<f32>(axis.x * cos(angle) - axis.y * sin(angle), axis.x * sin(angle) + axis.y * cos(angle));
    }
    let front = turned(axis, to_eye.xz) / light.half_rad.x;
    if kind == 2u {
        let t = clamp(up / light.half_rad.y + 0.5, 0.0, 1.0);
        return mix(light.back.rgb, light.colour.rgb, t) * exp2(-front * front);
    }
    let behind = turned(-axis, to_eye.xz) / light.half_rad.x;
    let upright = up / light.half_rad.y;
    let nearer = min(front, behind);
    let lobe = exp2(-nearer * nearer - upright * upright);
    let beam = select(light.back.rgb, light.colour.rgb, front <= behind) * lobe;
    return select(beam, light.colour.rgb * (1.0 - lobe), kind == 4u);
}

@vertex
fn lights_vertex(@builtin(vertex_index) index: u32, light: Light) -> Corner {
    let plan_m = vec2<f32>(light.post - lights.eye_post) * lights.step_m - lights.eye_fraction_m + light.local_m;
    let relative_m = vec3<f32>(plan_m.x, (light.height.x - frame.eye_high_m.y) - frame.eye_low_m.y, plan_m.y);
    let distance_m = max(length(relative_m), 0.5);

    // Far lights of a town are thinned by rank; who stays shines for who is left out.
    let thin = lights.thin_from_m / max(distance_m, lights.thin_from_m);
    let keep = max(thin * thin, lights.thinnest);
    let stays = clamp((keep - light.axis.w) / (0.25 * keep) + 0.5, 0.0, 1.0) / keep;
    // At dusk they come on one after another, in an order of their own, each over a tenth of the time.
    let turn = fract(light.axis.w * 97.0);
    let on = clamp(frame.lamps * 11.0 - turn * 10.0, 0.0, 1.0);
    let shares = select(1.0, stays * on, light.axis.w > 0.0);

    let sent = emitted(light, -relative_m);
    let most = max(max(sent.r, sent.g), sent.b);
    // Runway and approach lights are set down as it gets dark; a beacon is not.
    let kind = u32(round(light.colour.w * 255.0));
    let set_to = select(1.0, lights.directed, kind == 1u || kind == 2u);
    let lux = light.height.y * most * shares * set_to * haze_from_eye(relative_m) / (distance_m * distance_m);
    let ratio = lux / frame.threshold_lux;
    // Below the threshold it goes out softly.
    let bright = AT_THRESHOLD * sqrt(ratio) * smoothstep(0.1, 1.0, ratio) * frame.exposure;

    let scale = max(1.0, frame.viewport_px.y / 1080.0);
    let lamp_px = 0.5 * LAMP_RADIUS_M / distance_m * frame.focal_px;
    let wide = 1.0 + 0.4 * log2(max(bright, 1.0));
    let soft_px = min(max(SOFT_PX * scale * wide, lamp_px), WIDEST_PX * scale);
    let halo = clamp(0.05 * log2(max(0.5 * bright, 1.0)), 0.0, 0.25);
    let halo_px = 4.0 * soft_px;
    let reach_px = select(3.0 * soft_px, 2.6 * halo_px, halo > 0.002);

    var clip = frame.clip_from_relative * vec4<f32>(relative_m, 1.0);
    // Which way is down on the screen, pixels of which y runs down too.
    let under = frame.clip_from_relative * vec4<f32>(relative_m - vec3<f32>(0.0, 1e-3 * distance_m, 0.0), 1.0);
    let fall = (under.xy * clip.w - clip.xy * under.w) * frame.viewport_px * vec2<f32>(1.0, -1.0);
    let fall_length = length(fall);
    let down = select(vec2<f32>(0.0, 1.0), fall / max(fall_length, 1e-12), fall_length > 1e-12);
    // A square on its corner: bottom, both sides, top. Its sides join the two triangles.
    let corner_px = vec2<f32>(f32(i32(index & 1u) - i32(index >> 1u)), f32(i32(index == 0u) - i32(index == 3u)));
    let half_px = reach_px * 1.41421356;
    let away_px = half_px * (corner_px.x * vec2<f32>(-down.y, down.x) + corner_px.y * down);
    // Level ground under the light is nearer the lower it is seen: its depth, which runs evenly over the screen, grows by
    // its value at the light times the angle over the slope of the look. The lower half lies on that ground, the upper
    // half is as far as the light; all of it half a pixel's worth nearer, since far ground is drawn up to a pixel off. What
    // stands higher than that before the light hides it.
    let slope = clamp(abs(relative_m.y) / distance_m, 0.02, 1.0);
    let below_px = max(corner_px.y, 0.0) * half_px + 0.5;
    clip.z = clip.z * (1.0 + below_px / (frame.focal_px * slope) + 1.0 / distance_m);
    let shown = bright > 0.004 && clip.w > 0.0;
    var corner: Corner;
    let out = vec4<f32>(clip.xy + away_px * vec2<f32>(2.0, -2.0) / frame.viewport_px * clip.w, clip.zw);
    // All corners in one place: nothing is drawn.
    corner.clip = select(vec4<f32>(2.0, 2.0, 0.0, 1.0), out, shown);
    corner.away_px = away_px;
    corner.colour = sent / max(most, 1e-6);
    corner.shape = vec4<f32>(0.5 / (soft_px * soft_px), min(bright, 1.0), 0.5 / (halo_px * halo_px), halo);
    return corner;
}

@fragment
fn lights_fragment(corner: Corner) -> @location(0) vec4<f32> {
    let square = dot(corner.away_px, corner.away_px);
    let bell = corner.shape.y * exp(-square * corner.shape.x);
    // The halo ends at the square's nearest edge (2.6 of its widths: exp(-3.4)) without being seen to end.
    let halo = corner.shape.w * max(exp(-square * corner.shape.z) - 0.034, 0.0);
    return vec4<f32>(corner.colour * (bell + halo), 0.0);
}
