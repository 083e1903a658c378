// shared/frame.wgsl: what every pass knows of the frame. Group 0, vertex and fragment stage.
// Host: visual/src/uniforms.rs, field by field (offsets compared in tests/shader_contract.rs).
// Light is exposed: radiance and irradiance are already multiplied by the exposure chosen from the light.

struct FrameUniforms {
    clip_from_relative: mat4x4<f32>, // of a world position minus the eye
    eye_high_m: vec3<f32>,           // world position of the eye is eye_high + eye_low
    eye_altitude_m: f32,             // above sea level
    eye_low_m: vec3<f32>,
    time_s: f32,                     // wraps every hour
    ray_corner: vec3<f32>,           // direction through the top left corner of the picture, 1 along the axis
    exposure: f32,                   // of the scene, beside the one already in the light
    ray_right: vec3<f32>,            // added from the left edge to the right
    near_m: f32,
    ray_down: vec3<f32>,             // added from the top edge to the bottom
    focal_px: f32,                   // pixels per unit of tangent, vertically
    sun_direction: vec3<f32>,        // unit, towards the key light: the sun, or the moon where that is brighter
    sun_radius_rad: f32,
    sun_irradiance: vec3<f32>,       // exposed, by the key light on a surface turned to it, near the ground
    molecules_per_m: f32,            // extinction of green light by molecules at sea level
    sky_irradiance: vec3<f32>,       // exposed, on level ground
    haze_per_m: f32,                 // extinction by haze at its base
    disc: vec3<f32>,                 // colour of the sun's disc, brightest channel at most 1
    haze_base_m: f32,                // above sea level
    sun_level: vec2<f32>,            // unit, x and z of the sun's direction
    viewport_px: vec2<f32>,          // of the scene's target, before upscaling
    fade_start_m: f32,               // plan distance where the ground begins to fade into the sky
    fade_end_m: f32,                 // and where it is gone
    eye_molecules: f32,              // density at the eye's height, 1 at sea level
    eye_haze: f32,                   // density at the eye's height, 1 at the haze base
    disc_direction: vec3<f32>,       // unit, towards the sun itself
    threshold_lux: f32,              // least illuminance that makes a point of light seen
    moon_direction: vec3<f32>,       // unit
    moon_radius_rad: f32,            // 0 where there is no moon
    moon_to_sun: vec3<f32>,          // unit, from the moon to the sun
    moon_key: f32,                   // 1 where the moon is the key light, which no light map shadows
    moon_light: vec3<f32>,           // exposed radiance of the moon's lit side, as the eye sees it
    haze_scale_m: f32,               // height over which haze thins by a factor e
    aerial_reach_m: f32,             // greatest distance of the aerial table; 0: there is none
    lamps: f32,                      // share of lamps and windows that are lit, 0 by day and where no lights are drawn
    moon_share: f32,                 // of the moon's light, by phase: 1 when full
    sun_sin: f32,                    // of the sun's own elevation
}

@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var sky_table: texture_2d<f32>;
@group(0) @binding(2) var sky_sampler: sampler;
@group(0) @binding(3) var aerial_table: texture_3d<f32>;
