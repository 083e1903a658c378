// plants.wgsl: draws plants as meshes near the eye, as cards that face it farther away, and as single triangles far away.
// Reads:  group 0 frame; group 1 the window's light maps (vertex stage); group 2 species and pictures; group 3 the
//         plants in sight. Cards and triangles have no vertex buffer: a plant is four or three vertices in a row.
// Writes: display colour; reverse-Z depth, near / distance. Cut out by alpha, never blended.
// Host:   visual/src/passes/plants.rs
// Twin:   vegetation/src/pictures.rs ELEVATIONS_RAD and the frame of a card's picture.

//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"
//!include "shared/display.wgsl"
//!include "shared/posts.wgsl"
//!include "shared/light.wgsl"

struct Species {
    height_m: vec2<f32>,    // least and greatest
    width: f32,             // of the crown over the height
    shape: f32,
    colour: vec4<f32>,      // linear albedo of the crown; the shape's own width
}

// A plant in sight.
struct Plant {
    foot_x_m: f32,          // relative to the eye
    foot_y_m: f32,
    foot_z_m: f32,
    tall_m: f32,            // as it stands now
    looks: u32,             // species, size, turn, tint
}

// Up to where tall plants are meshes.
override MESH_M: f32 = 200.0;

const LEAVES: u32 = 3u;
const ELEVATIONS: u32 = 3u;

@group(2) @binding(0) var<uniform> kinds: array<Species, 32>;
@group(2) @binding(1) var pictures: texture_2d_array<f32>;
@group(2) @binding(2) var picture_sampler: sampler;
@group(3) @binding(0) var<storage, read> plants: array<Plant>;

struct Stand {
    foot_m: vec3<f32>,      // relative to the eye
    tall_m: f32,
    wide_m: f32,            // of the crown
    distance_m: f32,
    species: u32,
    turn: f32,              // 0 to 1
    tint: f32,
}

struct Card {
    @builtin(position) clip: vec4<f32>,
    // Place in the picture, and the dissolve against the mesh: 0 shown, 1 gone.
    @location(0) uv: vec3<f32>,
    @location(1) haze: vec4<f32>,
    // Light along the card's right, up and facing, and what comes from everywhere.
    @location(2) @interpolate(flat) sun: vec4<f32>,
    @location(3) @interpolate(flat) albedo: vec4<f32>,
    @location(4) @interpolate(flat) sky: vec4<f32>,
}

struct Plain {
    @builtin(position) clip: vec4<f32>,
    @location(0) colour: vec3<f32>,
}

struct Leaf {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) haze: vec4<f32>,
    @location(3) @interpolate(flat) layer: u32,
}

// Sun and sky light at a place on the ground, as its light map has them.
fn light_under(relative_m: vec2<f32>) -> vec4<f32> {
    let posts = (relative_m + window.eye_fraction_m) / window.step_m;
    let cells = i32(TILE) - 2;
    let whole = window.eye_post + vec2<i32>(floor(posts));
    let block = vec2<i32>(floor((vec2<f32>(whole) + 0.5) / f32(cells)));
    let local = vec2<f32>(whole - block * cells) + fract(posts);
    let side = blocks[0].side;
    let slot = ((block % side) + side) % side;
    return light_at(local, vec2<f32>(slot));
}

fn stand_of(index: u32) -> Stand {
    let plant = plants[index];
    let looks = unpack4x8unorm(plant.looks);
    var stand: Stand;
    stand.species = plant.looks & 0xffu;
    stand.foot_m = vec3<f32>(plant.foot_x_m, plant.foot_y_m, plant.foot_z_m);
    stand.distance_m = length(stand.foot_m);
    stand.turn = looks.z;
    stand.tint = looks.w;
    stand.tall_m = plant.tall_m;
    stand.wide_m = stand.tall_m * kinds[stand.species].width * (0.85 + 0.3 * looks.w);
    return stand;
}

fn crown_colour(species: u32, tint: f32, turn: f32) -> vec3<f32> {
    // No two plants are of one shade: lighter and darker, greyer and greener, a little to yellow or blue.
    let warm = (turn - 0.5) * 0.34;
    let pure = kinds[species].colour.rgb;
    let grey = vec3<f32>(dot(pure, vec3<f32>(0.2126, 0.7152, 0.0722)));
    let colour = mix(pure, grey, 0.28 * fract(tint * 16.0));
    return colour * (0.60 + 0.68 * tint) * vec3<f32>(1.0 + warm, 1.0, 1.0 - warm);
}

// How far a plant has changed from a mesh to a card; the host's `mesh_reach_m` is where this is 1.
fn meshless(distance_m: f32, tall_m: f32) -> f32 {
    let reach_m = MESH_M * clamp(tall_m / 20.0, 0.2, 1.0);
    return clamp((distance_m - 0.85 * reach_m) / (0.15 * reach_m), 0.0, 1.0);
}

@vertex
fn card_vertex(@builtin(vertex_index) index: u32) -> Card {
    let stand = stand_of(index / 4u);
    var card: Card;
    let gone = 1.0 - meshless(stand.distance_m, stand.tall_m);
    let middle_m = stand.foot_m + vec3<f32>(0.0, 0.5 * stand.tall_m, 0.0);
    let kind = kinds[stand.species];
    let to_eye = -normalize(middle_m);
    let level = normalize(vec3<f32>(-to_eye.z, 0.0, to_eye.x) + vec3<f32>(1e-6, 0.0, 0.0));
    let right = -level;
    let up = cross(to_eye, right);
    // Which picture: the nearest elevation, a little blurred from plant to plant.
    let down = clamp(to_eye.y + (stand.turn - 0.5) * 0.10, 0.0, 1.0);
    let view = select(select(0u, 1u, down > 0.30), 2u, down > 0.76);
    let sin_view = select(select(0.0698, 0.530, view == 1u), 0.927, view == 2u);
    let cos_view = sqrt(1.0 - sin_view * sin_view);
    // The picture's frame, as its twin has it.
    let half_wide = 0.5 * stand.wide_m;
    let half_high = 0.5 * (stand.tall_m * cos_view + stand.wide_m * sin_view);
    let corner = vec2<f32>(f32(index & 1u), f32((index >> 1u) & 1u));
    // Seen from the side a conifer leaves the upper corners of its frame empty.
    let narrow = select(1.0, 0.3, kind.shape < 1.5 && view == 0u && corner.y > 0.5);
    let across = (corner.x * 2.0 - 1.0) * narrow;
    let offset = vec2<f32>(across * half_wide, (corner.y * 2.0 - 1.0) * half_high);
    let at_m = middle_m + right * offset.x + up * offset.y;
    card.clip = frame.clip_from_relative * vec4<f32>(at_m, 1.0);
    let hand = select(1.0, -1.0, fract(stand.turn * 64.0) < 0.5);
    card.uv = vec3<f32>(0.5 + 0.5 * across * hand, 1.0 - corner.y, gone);
    card.haze = haze(middle_m);
    let light = light_under(stand.foot_m.xz);
    let sun = frame.sun_direction;
    card.sun = vec4<f32>(dot(sun, right) * hand, dot(sun, up), dot(sun, to_eye), key_seen(light));
    card.albedo = vec4<f32>(crown_colour(stand.species, stand.tint, stand.turn), f32(LEAVES + u32(kind.shape) * ELEVATIONS + view));
    // The picture's mip, once a card: texels over pixels, of the side that has more.
    let px_per_m = frame.focal_px / length(middle_m);
    let texels = max(32.0 / (half_wide * px_per_m), 64.0 / (half_high * px_per_m));
    card.sky = vec4<f32>(light.a, up.y, to_eye.y, clamp(log2(texels) - 0.3, 0.0, 5.0));
    return card;
}

// Light that a crown sends on: sun wrapped around it, some of it through the leaves, and sky from above.
fn crown_light(facing: f32, sun: f32, open: f32, upward: f32) -> vec3<f32> {
    let wrapped = max(facing + 0.30, 0.0) * (1.0 / 1.30);
    let sky = open * (0.55 + 0.45 * upward);
    let bounced = 0.10 * max(frame.sun_direction.y, 0.0);
    return (frame.sun_irradiance * (wrapped * sun + bounced) + frame.sky_irradiance * sky) * (1.0 / 3.14159265);
}

fn noise_of(pixel: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715))));
}

@fragment
fn card_fragment(card: Card) -> @location(0) vec4<f32> {
    let texel = textureSampleLevel(pictures, picture_sampler, card.uv.xy, u32(card.albedo.a + 0.5), card.sky.w);
    if texel.a < 0.5 || noise_of(card.clip.xy) < card.uv.z {
        discard;
    }
    let plan = texel.gb * 2.0 - 1.0;
    let facing = sqrt(max(1.0 - dot(plan, plan), 0.0));
    let normal = vec3<f32>(plan, facing);
    let light = crown_light(dot(normal, card.sun.xyz), card.sun.w, card.sky.x, normal.y * card.sky.y + normal.z * card.sky.z);
    return shown(card.albedo.rgb * (2.0 * texel.r) * light, card.haze, card.clip.xy);
}

@vertex
fn far_vertex(@builtin(vertex_index) index: u32) -> Plain {
    let stand = stand_of(index / 3u);
    var plain: Plain;
    let to_eye = -normalize(stand.foot_m);
    let right = normalize(vec3<f32>(to_eye.z, 0.0, -to_eye.x) + vec3<f32>(1e-6, 0.0, 0.0));
    let up = cross(to_eye, right);
    // A triangle of about the area of the crown; seen from above it is as high as the crown is wide.
    let down = clamp(to_eye.y, 0.0, 1.0);
    let high_m = mix(stand.tall_m, max(stand.wide_m, 0.6 * stand.tall_m), down);
    let corner = index % 3u;
    let side = select(select(0.0, 0.42, corner == 1u), -0.42, corner == 0u);
    let at_m = stand.foot_m + right * (side * stand.wide_m) + up * select(0.0, high_m, corner == 2u);
    plain.clip = frame.clip_from_relative * vec4<f32>(at_m, 1.0);
    let light = light_under(stand.foot_m.xz);
    // A round crown: its sides look aside, its top up; low down it is in its own shade.
    let outward = right * (side * 1.1) + to_eye * 0.7;
    let facing = dot(outward, frame.sun_direction) + select(0.0, 0.25, corner == 2u);
    let open = select(0.62, 1.25, corner == 2u);
    let shaded = crown_colour(stand.species, stand.tint, stand.turn)
        * (open * crown_light(facing, key_seen(light), light.a, 0.3 + 0.5 * down));
    let air = haze(stand.foot_m);
    plain.colour = display(shaded * air.a + air.rgb);
    return plain;
}

@fragment
fn far_fragment(plain: Plain) -> @location(0) vec4<f32> {
    return vec4<f32>(dither(plain.colour, plain.clip.xy), 1.0);
}

// A near plant's mesh: `at` is its foot relative to the eye, `looks` as a plant's.
@vertex
fn leaf_vertex(
    @location(0) position: vec3<f32>,
    @location(1) normal_open: vec4<f32>,
    @location(2) uv_leaf: vec4<f32>,
    @location(3) foot_m: vec3<f32>,
    @location(4) looks: u32,
) -> Leaf {
    let parts = unpack4x8unorm(looks);
    let species = looks & 0xffu;
    let kind = kinds[species];
    let distance_m = length(foot_m);
    let tall_m = mix(kind.height_m.x, kind.height_m.y, parts.y);
    let wide_m = tall_m * kind.width * (0.85 + 0.3 * parts.w);
    let angle = parts.z * 6.2831853;
    let turn = vec2<f32>(cos(angle), sin(angle));
    let turned = vec3<f32>(turn.x * position.x - turn.y * position.z, position.y, turn.y * position.x + turn.x * position.z);
    let at_m = foot_m + turned * vec3<f32>(wide_m, tall_m, wide_m);
    var leaf: Leaf;
    leaf.clip = frame.clip_from_relative * vec4<f32>(at_m, 1.0);
    let gone = meshless(distance_m, tall_m);
    leaf.uv = vec3<f32>(uv_leaf.xy, gone);
    leaf.layer = u32(uv_leaf.z * 255.0 + 0.5);
    let flat = normal_open.xyz;
    let normal = vec3<f32>(turn.x * flat.x - turn.y * flat.z, flat.y, turn.y * flat.x + turn.x * flat.z);
    let light = light_under(foot_m.xz);
    let bark = vec3<f32>(0.080, 0.068, 0.056) * (0.8 + 0.4 * parts.w);
    let albedo = select(crown_colour(species, parts.w, parts.z), bark, leaf.layer == 2u);
    // A leaf picture's mean shade is near 0.38.
    leaf.light = albedo * crown_light(dot(normal, frame.sun_direction), key_seen(light), light.a, normal.y) * (normal_open.w * 2.9);
    leaf.haze = haze(at_m);
    return leaf;
}

@fragment
fn leaf_fragment(leaf: Leaf) -> @location(0) vec4<f32> {
    let texel = textureSample(pictures, picture_sampler, leaf.uv.xy, leaf.layer);
    if texel.a < 0.5 || noise_of(leaf.clip.xy) >= 1.0 - leaf.uv.z {
        discard;
    }
    return shown(leaf.light * texel.r, leaf.haze, leaf.clip.xy);
}
