// shared/sky.wgsl: sky radiance and haze, for the vertex or the fragment stage.
// Needs: shared/frame.wgsl. Twin: visual/src/uniforms.rs haze_from_eye, visual/src/sky.rs (the table).

const TABLE_WIDTH: f32 = 128.0;
const TABLE_HEIGHT: f32 = 64.0;
const MOLECULE_SCALE_HEIGHT_M: f32 = 8000.0;

// Exposed radiance of the sky along a unit direction; below the horizon the horizon's. One texture read.
fn sky_radiance(direction: vec3<f32>) -> vec3<f32> {
    let azimuth_cos = dot(direction.xz, frame.sun_level) * inverseSqrt(max(dot(direction.xz, direction.xz), 1e-12));
    let u = sqrt(max(0.5 - 0.5 * azimuth_cos, 0.0));
    // sqrt(sine of the elevation), flattened over the lowest degree: the sky's steep first rows would else
    // meet the even colour below the horizon in a visible edge.
    let rise = max(direction.y, 0.0);
    let v = rise * inverseSqrt(rise + 0.02);
    let texel = vec2<f32>(
        (u * (TABLE_WIDTH - 1.0) + 0.5) / TABLE_WIDTH,
        (v * (TABLE_HEIGHT - 1.0) + 0.5) / TABLE_HEIGHT,
    );
    return textureSampleLevel(sky_table, sky_sampler, texel, 0.0).rgb;
}

const AERIAL_WIDTH: f32 = 12.0;
const AERIAL_HEIGHT: f32 = 32.0;
const AERIAL_DEPTH: f32 = 24.0;

// What light scattered in over a distance tends to, so that times 1 - haze_from_eye it is that light: from the aerial table
// where there is one, else the sky's; the sky's as well where the ground fades into it. Two texture reads.
fn scattered(relative_m: vec3<f32>) -> vec3<f32> {
    let distance_m = length(relative_m);
    let direction = relative_m / max(distance_m, 1e-3);
    let azimuth_cos = dot(direction.xz, frame.sun_level) * inverseSqrt(max(dot(direction.xz, direction.xz), 1e-12));
    let u = sqrt(max(0.5 - 0.5 * azimuth_cos, 0.0));
    // As sky::aerial_elevation_sin: the fourth root of the sine, finest at the horizon, from -1 to 1.
    let v = 0.5 + 0.5 * sign(direction.y) * sqrt(sqrt(abs(direction.y)));
    let w = sqrt(min(distance_m / max(frame.aerial_reach_m, 1.0), 1.0));
    let size = vec3<f32>(AERIAL_WIDTH, AERIAL_HEIGHT, AERIAL_DEPTH);
    let texel = (vec3<f32>(u, v, w) * (size - 1.0) + 0.5) / size;
    let near = textureSampleLevel(aerial_table, sky_sampler, texel, 0.0).rgb;
    let faded = smoothstep(0.7 * frame.fade_end_m, frame.fade_end_m, length(relative_m.xz));
    // No `if` on a uniform alone: lavapipe would compile the shader anew for each draw that binds a group.
    return mix(near, sky_radiance(direction), select(faded, 1.0, frame.aerial_reach_m <= 0.0));
}

// Mean of a density exp(-height / scale) between two heights, given in scale heights above where it is 1.
fn mean_density(eye: f32, eye_density: f32, point: f32) -> f32 {
    let rise = point - eye;
    let even = exp(-0.5 * (eye + point));
    let slant = (eye_density - exp(-point)) / select(rise, 1.0, abs(rise) < 0.01);
    return select(slant, even, abs(rise) < 0.01);
}

// Share of a point's light that reaches the eye through the air between, with the fade at the end of the ground: 0 from
// fade_end_m on. On the level at the haze base it is 2 % at the visibility.
fn haze_from_eye(relative_m: vec3<f32>) -> f32 {
    let point_height_m = frame.eye_altitude_m + relative_m.y;
    let eye_haze = clamp((frame.eye_altitude_m - frame.haze_base_m) / frame.haze_scale_m, 0.0, 60.0);
    let point_haze = clamp((point_height_m - frame.haze_base_m) / frame.haze_scale_m, 0.0, 60.0);
    let eye_molecules = clamp(frame.eye_altitude_m / MOLECULE_SCALE_HEIGHT_M, 0.0, 60.0);
    let point_molecules = clamp(point_height_m / MOLECULE_SCALE_HEIGHT_M, 0.0, 60.0);
    let haze = frame.haze_per_m * mean_density(eye_haze, frame.eye_haze, point_haze);
    let molecules = frame.molecules_per_m * mean_density(eye_molecules, frame.eye_molecules, point_molecules);
    let faded = smoothstep(frame.fade_start_m, frame.fade_end_m, length(relative_m.xz));
    return exp(-length(relative_m) * (haze + molecules)) * (1.0 - faded);
}
