// shared/detail.wgsl: what the ground near the eye is made of, from one tiling texture at two scales.
// Needs: shared/posts.wgsl. Group 1, bindings 5 and 7.
// Host: visual/src/passes/detail.rs, which says what the channels are; its test has the twin of `detail_places`.

@group(1) @binding(5) var detail_texture: texture_2d<f32>;
@group(1) @binding(7) var detail_sampler: sampler;

// Repeats along a block's side: each scale is turned by whole numbers, so that borders match; 513 m and 62 m at a step
// of 200 m.
const COARSE: vec2<f32> = vec2<f32>(11.0, 4.0);
const FINE: vec2<f32> = vec2<f32>(89.0, -38.0);
// How far the coarse scale is bent, in repeats, and over how many posts a radian of the bend's waves goes (2 to 6 km a
// wave): one repeat from a place the pattern has moved by more than its longest feature, and is stretched by half at most.
const BEND: f32 = 0.32;
const BEND_POSTS: vec3<f32> = vec3<f32>(1.7, 2.3, 5.1);
// How far the fine scale is moved by the clumps of the coarse one, in repeats.
const STIR: vec2<f32> = vec2<f32>(0.05, -0.035);

// Places of a post in the detail texture: coarse scale, fine scale.
fn detail_places(slot: u32, local: vec2<u32>) -> vec4<f32> {
    let at = vec2<f32>(local) * (1.0 / f32(TILE - 2u));
    let post = vec2<f32>(blocks[slot].first_post + vec2<i32>(local));
    let wave = sin(vec4<f32>(post.yx / BEND_POSTS.x, post.xy / BEND_POSTS.y) + sin(post.xyyx / BEND_POSTS.z).xyzw);
    let coarse = vec2<f32>(dot(at, COARSE), dot(at, vec2<f32>(-COARSE.y, COARSE.x)));
    let fine = vec2<f32>(dot(at, FINE), dot(at, vec2<f32>(-FINE.y, FINE.x)));
    return vec4<f32>(coarse + BEND * (wave.xy + wave.zw), fine);
}

struct Detail {
    albedo: vec3<f32>,
    // Bends the normal.
    tilt: vec2<f32>,
}

// Ground of a colour, `root` its square root as the ground map has it, seen from near.
fn detailed(root: vec3<f32>, places: vec4<f32>) -> Detail {
    // What the colour says of the cover.
    let snow = smoothstep(0.66, 0.86, root.b);
    let green = clamp((root.g - root.r) * 14.0, 0.0, 1.0);
    let dry = clamp((root.r - root.b) * 6.0, 0.0, 1.0) * (1.0 - green);
    let stone = (1.0 - green) * (1.0 - dry) * (1.0 - snow);
    let even = 1.0 - 0.75 * snow;

    let coarse = textureSampleBias(detail_texture, detail_sampler, places.xy, -0.5);
    let relief = (0.10 + 0.75 * stone + 0.16 * dry) * even;
    var tilt = (coarse.rg - 0.5) * relief;
    // Tussocks among steppe, bushes on gravel; grass is more even than either.
    let clumps = (0.50 * dry + 0.50 * green + 0.40 * stone) * even;
    let grains = (0.55 + 0.50 * stone) * even;
    var shade = (coarse.b - 0.5) * clumps + (coarse.a - 0.5) * grains * 0.8;
    var hue = coarse.b - 0.5;
    if DETAIL > 1u {
        let place = places.zw + STIR * (coarse.b - 0.5);
        let fine = textureSampleBias(detail_texture, detail_sampler, place, -0.6);
        // The fine scale is turned the other way: so are its slopes, nearly.
        tilt += vec2<f32>(fine.g - 0.5, 0.5 - fine.r) * relief * 0.9;
        shade += (fine.b - 0.5) * clumps * 1.1 + (fine.a - 0.5) * grains;
        hue += 0.7 * (fine.b - 0.5);
    }
    // Dark clumps are never as dark as light ones are light: among steppe soil and straw show between the leaves.
    shade = max(shade, 0.0) + 0.7 * min(shade, 0.0);
    // Light clumps of grass are dry and yellow, dark ones green; among steppe dark ones are brown.
    let tint = hue * (vec3<f32>(0.24, 0.10, -0.10) * green + vec3<f32>(-0.04, 0.02, 0.10) * dry);
    var detail: Detail;
    detail.albedo = root * root * max(1.0 + shade + tint, vec3<f32>(0.25));
    detail.tilt = tilt;
    return detail;
}
