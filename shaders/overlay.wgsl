// overlay.wgsl: what is draped on the near ground: water, roads, railways, airfields and their paint; marks of events.
// Reads:  group 0 frame; group 1 the window: table of blocks, light maps; water also ground maps and detail. Vertex buffer: terrain::block::overlay::Vertex.
//         An instance is the slot of the block that the vertices belong to.
// Writes: display colour blended over the ground; depth is tested and not written.
// Host:   visual/src/passes/overlay.rs, visual/src/passes/decals.rs
// Twin:   kinds and packing: terrain::block::overlay (numbers compared in visual/tests/shader_contract.rs).
// Invariant: a vertex lies in a triangle of level 0, placed from whole-number differences like a post; towards the eye it
//         is moved in depth alone, by DEPTH_SHARE of its distance. The edges of what has a width are moved out along the
//         ground's plane by half a pixel, in which they fade, and farther where it would be thinner than a pixel.

//!include "shared/frame.wgsl"
//!include "shared/sky.wgsl"
//!include "shared/display.wgsl"
//!include "shared/posts.wgsl"
//!include "shared/light.wgsl"
//!include "shared/detail.wgsl"
//!include "shared/water.wgsl"

// As in terrain.wgsl.
override DETAIL: u32 = 2u;

const PLACE_BITS: u32 = 22u;
const ACROSS_PER_METRE: f32 = 256.0;
const EXTENT_PER_METRE: f32 = 8.0;
const UNITS: f32 = 65536.0;

const WATER: u32 = 0u;
const WATER_AREA: u32 = 1u;
const STILL_WATER: u32 = 2u;
const PATH: u32 = 3u;
const TRACK: u32 = 4u;
const GRAVEL: u32 = 5u;
const LANE: u32 = 6u;
const ROAD: u32 = 7u;
const MOTORWAY: u32 = 8u;
const RAILWAY: u32 = 9u;
const APRON: u32 = 10u;
const TAXIWAY: u32 = 11u;
const RUNWAY_ASPHALT: u32 = 12u;
const RUNWAY_CONCRETE: u32 = 13u;
const RUNWAY_GRAVEL: u32 = 14u;
const RUNWAY_GRASS: u32 = 15u;
const WHITE: u32 = 16u;
const CRATER: u32 = 17u;
const SCORCH: u32 = 18u;

// Depth of a large triangle near the eye is interpolated to some 1e-5 of the distance; a crest hides what lies 1.5 m
// behind it at 10 km.
const DEPTH_SHARE: f32 = 1.5e-4;

// Half the side of a mark's square, in its radii.
const REACH_RADII: f32 = 3.0;

// Roads are gone where one so wide would span a pixel.
const ROAD_M: f32 = 9.0;

struct Draped {
    @builtin(position) clip: vec4<f32>,
    // Column and row in the block, in posts.
    @location(0) local: vec2<f32>,
    @location(1) haze: vec4<f32>,
    // Along and across the feature, metres; of WATER_AREA and STILL_WATER distances from two shores.
    @location(2) place_m: vec2<f32>,
    @location(3) relative_m: vec3<f32>,
    // Radiance of the sky mirrored in still water.
    @location(4) mirrored: vec3<f32>,
    // Half the width and half the length, metres; 0: no edge to be smoothed. Of a mark: its radius and its turn, radians.
    @location(5) @interpolate(flat) half_m: vec2<f32>,
    @location(6) @interpolate(flat) kind: u32,
    @location(7) @interpolate(flat) slot: vec2<f32>,
}

// How much the ground rises a metre east and a metre south.
fn slope(slot: u32, cell: vec2<u32>, share: vec2<f32>) -> vec2<f32> {
    let side = u32(blocks[slot].side);
    // The last row and column of posts belong to the cell before; their posts lie in the tile's apron.
    let at = vec2<u32>(slot % side, slot / side) * TILE + cell;
    let north_east = textureLoad(heights, at + vec2<u32>(1u, 0u), 0).r;
    let south_west = textureLoad(heights, at + vec2<u32>(0u, 1u), 0).r;
    let north_west = textureLoad(heights, at, 0).r;
    let south_east = textureLoad(heights, at + vec2<u32>(1u, 1u), 0).r;
    let upper = vec2<f32>(north_east - north_west, south_west - north_west);
    let lower = vec2<f32>(south_east - south_west, south_east - north_east);
    let rise = select(lower, upper, share.x + share.y <= 1.0) / window.step_m;
    // Beside void.
    return select(vec2<f32>(0.0), rise, abs(rise) < vec2<f32>(1e3));
}

@vertex
fn overlay_vertex(
    @builtin(instance_index) slot: u32,
    @location(0) places: vec2<u32>,
    @location(1) height_m: f32,
    @location(2) along_m: f32,
    @location(3) across: u32,
) -> Draped {
    let block = blocks[slot];
    let units = places & vec2<u32>((1u << PLACE_BITS) - 1u);
    let cell = units >> vec2<u32>(16u);
    let share = vec2<f32>(units & vec2<u32>(0xffffu)) / UNITS;
    // As in post_of: whole numbers first.
    let away = vec2<f32>(block.first_post + vec2<i32>(cell) - window.eye_post);
    let plan_m = (away * window.step_m - window.eye_fraction_m) + share * window.step_m;
    var relative_m = vec3<f32>(plan_m.x, (height_m - frame.eye_high_m.y) - frame.eye_low_m.y, plan_m.y);

    var draped: Draped;
    draped.kind = places.x >> PLACE_BITS;
    let extra = places.y >> PLACE_BITS;
    let half_m = f32(across >> 16u) / ACROSS_PER_METRE;
    var across_m = f32(bitcast<i32>(across << 16u) >> 16u) / ACROSS_PER_METRE;
    draped.half_m = vec2<f32>(half_m, 0.0);
    if draped.kind >= CRATER {
        draped.half_m.y = f32(extra) * (6.2831853 / 1024.0);
    } else if draped.kind == WHITE {
        draped.half_m.y = f32(extra) / EXTENT_PER_METRE;
    } else if half_m > 0.0 {
        let turn = f32(extra) * (6.2831853 / 1024.0);
        let plan = vec2<f32>(cos(turn), sin(turn));
        let right = normalize(vec3<f32>(plan.x, dot(slope(slot, cell, share), plan), plan.y));
        let distance_m = length(relative_m);
        let away = dot(right, relative_m) / max(distance_m, 0.1);
        // Ground across the line that a pixel spans; more than that is not made up at a grazing angle.
        let pixel_m = distance_m / (frame.focal_px * max(sqrt(max(1.0 - away * away, 0.0)), 0.15));
        let wider = (max(half_m, 0.5 * pixel_m) + 0.5 * pixel_m) / half_m;
        relative_m += right * (across_m * (wider - 1.0));
        across_m *= wider;
    }
    draped.clip = frame.clip_from_relative * vec4<f32>(relative_m, 1.0);
    draped.clip.z *= 1.0 + DEPTH_SHARE;
    draped.local = vec2<f32>(cell) + share;
    draped.haze = haze(relative_m);
    draped.place_m = vec2<f32>(along_m, across_m);
    draped.relative_m = relative_m;
    draped.slot = vec2<f32>(f32(slot % u32(block.side)), f32(slot / u32(block.side)));
    draped.mirrored = vec3<f32>(0.0);
    if draped.kind <= STILL_WATER {
        draped.mirrored = mirrored_sky(relative_m);
    }
    return draped;
}

// Share of a pixel of `pixel_m` that a line of half a width covers, `away_m` from its middle.
fn line(away_m: f32, half_m: f32, pixel_m: f32) -> f32 {
    let low = max(away_m - 0.5 * pixel_m, -half_m);
    let high = min(away_m + 0.5 * pixel_m, half_m);
    return clamp((high - low) / pixel_m, 0.0, 1.0);
}

// The same of dashes `dash_m` long and `gap_m` apart; where a pixel holds several, their share.
fn dashes(along_m: f32, dash_m: f32, gap_m: f32, pixel_m: f32) -> f32 {
    let period_m = dash_m + gap_m;
    let away_m = abs(fract(along_m / period_m) - 0.5) * period_m;
    return mix(line(away_m, 0.5 * dash_m, pixel_m), dash_m / period_m, smoothstep(0.4, 1.0, pixel_m / period_m));
}

// Smooth noise, mean 0.5, with cells of 1.
fn speck(at: vec2<f32>) -> f32 {
    let cell = floor(at);
    let within = at - cell;
    let soft = within * within * (3.0 - 2.0 * within);
    let top = mix(hash(cell), hash(cell + vec2<f32>(1.0, 0.0)), soft.x);
    let bottom = mix(hash(cell + vec2<f32>(0.0, 1.0)), hash(cell + vec2<f32>(1.0, 1.0)), soft.x);
    return mix(top, bottom, soft.y);
}

// D. Hoskins. Hash without sine, 2014: the form for two numbers to one.
fn hash(cell: vec2<f32>) -> f32 {
    var p = fract(vec3<f32>(cell.xyx) * 0.1031);
    p += dot(p, p.yzx + 33.33);
    return fract((p.x + p.y) * p.z);
}

// Speck of cells of `size_m`, gone where a pixel is as large.
fn grain(place_m: vec2<f32>, size_m: f32, pixel_m: f32) -> f32 {
    return mix(speck(place_m / size_m) - 0.5, 0.0, smoothstep(0.4, 1.0, pixel_m / size_m));
}

const ASPHALT: vec3<f32> = vec3<f32>(0.095, 0.096, 0.10);
const CONCRETE: vec3<f32> = vec3<f32>(0.25, 0.242, 0.225);
const PAINT: vec3<f32> = vec3<f32>(0.68, 0.68, 0.66);
const RIVER_BED: vec3<f32> = vec3<f32>(0.028, 0.045, 0.042);
const YELLOW: vec3<f32> = vec3<f32>(0.55, 0.36, 0.04);

fn road(kind: u32, at_m: vec2<f32>, half_m: f32, pixel_m: vec2<f32>) -> vec3<f32> {
    let worn = grain(at_m, 6.0, pixel_m.x) * 0.25 + grain(at_m * vec2<f32>(0.3, 3.0), 2.0, pixel_m.y) * 0.18;
    var albedo = ASPHALT * (1.15 + worn);
    if kind == LANE {
        return albedo * 1.1;
    }
    let side = abs(at_m.y);
    // Lines along the edges, and dashes between lanes.
    var paint = line(side - (half_m - 0.3), 0.075, pixel_m.y);
    if kind == ROAD {
        paint += line(at_m.y, 0.07, pixel_m.y) * dashes(at_m.x, 3.0, 6.0, pixel_m.x);
    } else {
        // A strip of grass between carriageways of two lanes each.
        let strip_m = clamp(half_m - 8.5, 0.3, 3.0);
        albedo = mix(albedo, vec3<f32>(0.07, 0.095, 0.03), line(at_m.y, strip_m, pixel_m.y));
        paint += line(side - (strip_m + 0.35), 0.075, pixel_m.y);
        let middle_m = 0.5 * (strip_m + half_m);
        paint += line(side - middle_m, 0.075, pixel_m.y) * dashes(at_m.x, 4.0, 8.0, pixel_m.x);
    }
    return mix(albedo, PAINT, min(paint, 1.0) * 0.85);
}

fn rails(at_m: vec2<f32>, pixel_m: vec2<f32>) -> vec3<f32> {
    let ballast = vec3<f32>(0.16, 0.145, 0.13) * (1.0 + grain(at_m, 0.7, pixel_m.y) * 0.5);
    let sleeper = line(at_m.y, 1.3, pixel_m.y) * dashes(at_m.x, 0.25, 0.35, pixel_m.x);
    // Gauge 1.435 m between the rails' inner sides.
    let rail = line(abs(at_m.y) - 0.755, 0.04, pixel_m.y);
    return mix(mix(ballast, vec3<f32>(0.10, 0.09, 0.08), sleeper), vec3<f32>(0.05, 0.04, 0.035), rail);
}

fn gravel(kind: u32, at_m: vec2<f32>, pixel_m: vec2<f32>) -> vec3<f32> {
    let stones = grain(at_m, 0.5, pixel_m.y) * 0.3 + grain(at_m, 5.0, pixel_m.x) * 0.25;
    let pale = vec3<f32>(0.29, 0.25, 0.185) * (1.0 + stones);
    if kind != TRACK {
        return pale;
    }
    // Grass grows between the wheels.
    let green = line(at_m.y + grain(at_m, 3.0, pixel_m.y) * 0.4, 0.35, pixel_m.y);
    return mix(pale, vec3<f32>(0.10, 0.12, 0.045), green * 0.7);
}

fn slabs(at_m: vec2<f32>, pixel_m: f32) -> vec3<f32> {
    let slab = floor(at_m / 7.5);
    let within = abs(fract(at_m / 7.5) - 0.5) * 7.5;
    let near = 1.0 - smoothstep(0.4, 1.0, pixel_m / 7.5);
    let joint = max(line(3.75 - within.x, 0.05, pixel_m), line(3.75 - within.y, 0.05, pixel_m)) * near;
    let shade = 1.0 + (hash(slab) - 0.5) * 0.16 * near + grain(at_m, 2.5, pixel_m) * 0.1;
    return CONCRETE * shade * (1.0 - 0.5 * joint);
}

fn runway(kind: u32, at_m: vec2<f32>, half_m: f32, pixel_m: vec2<f32>) -> vec3<f32> {
    if kind == RUNWAY_GRASS {
        // Mown along.
        let mown = dashes(at_m.y, 3.0, 3.0, pixel_m.y) * 0.16;
        return vec3<f32>(0.085, 0.12, 0.038) * (0.92 + mown + grain(at_m, 4.0, pixel_m.x) * 0.2);
    }
    if kind == RUNWAY_GRAVEL {
        return gravel(GRAVEL, at_m, pixel_m);
    }
    var albedo = ASPHALT * (1.05 + grain(at_m * vec2<f32>(0.25, 1.0), 5.0, pixel_m.y) * 0.22);
    if kind == RUNWAY_CONCRETE {
        albedo = slabs(at_m, max(pixel_m.x, pixel_m.y)) * 0.85;
    }
    // Rubber where wheels touch down, mostly 200 to 700 m from the threshold and 2 to 5 m from the middle.
    let from_m = at_m.x - 420.0;
    let along = exp(from_m * from_m * (-1.0 / 62500.0)) + 0.25 * exp(at_m.x * at_m.x * (-1.0 / 1e6));
    let off_m = abs(at_m.y) - 3.2;
    let across = exp(off_m * off_m * (-1.0 / 5.0));
    let streaks = 0.75 + 0.5 * grain(at_m * vec2<f32>(0.02, 1.6), 1.0, pixel_m.y);
    return albedo * (1.0 - 0.6 * min(along * across * streaks, 1.0));
}

const EARTH: vec3<f32> = vec3<f32>(0.155, 0.122, 0.088);
const SOOT: vec3<f32> = vec3<f32>(0.022, 0.020, 0.018);

// A mark's albedo and its cover, and how it bends the ground: a rise a metre, away from the middle.
struct Mark {
    colour: vec4<f32>,
    rise: f32,
}

fn crater(at_m: vec2<f32>, radius_m: f32, turn: f32, pixel_m: f32) -> Mark {
    let at = at_m / radius_m;
    let away = length(at);
    let pixel = pixel_m / radius_m;
    let seed = turn * 37.0;
    // The rim is no circle; rays of what was thrown out reach unevenly far.
    let way = at / max(away, 1e-3);
    let ragged = speck(way * 2.3 + seed) - 0.5 + 0.6 * (speck(way * 6.1 + seed) - 0.5);
    let r = away * (1.0 + 0.16 * ragged);
    let clods = grain(at * 3.0 + seed, 0.55, pixel) + 0.6 * grain(at * 3.0 - seed, 0.21, pixel);
    var mark: Mark;
    // The bowl and the rim of terrain::edit, its sides as steep as loose earth stays.
    let outer = 1.0 / max(r * r * r * r, 1.0);
    mark.rise = select(-0.22 * outer, 0.85 * r, r < 1.0) * (1.0 - smoothstep(1.0, 3.0, pixel));
    let thrown = 1.0 - smoothstep(0.95, max(2.6 + 1.1 * ragged, 1.0), away);
    let dust = mix(EARTH * 1.35, EARTH, smoothstep(0.7, 1.3, r));
    var albedo = dust * (1.0 + 0.9 * clods);
    // Darker where little light comes in, and sooty in the middle.
    albedo *= mix(0.45 + 0.5 * smoothstep(0.1, 1.0, r), 1.0, step(1.0, r));
    albedo = mix(albedo, SOOT * 2.0, 0.55 * (1.0 - smoothstep(0.1, 0.75, r)));
    let inside = 1.0 - smoothstep(1.05, 1.25, r);
    let scattered = thrown * thrown * clamp(0.55 + 2.2 * clods + 0.9 * ragged, 0.0, 1.0);
    mark.colour = vec4<f32>(albedo, max(inside, 0.85 * scattered));
    return mark;
}

fn scorch(at_m: vec2<f32>, radius_m: f32, turn: f32, pixel_m: f32) -> Mark {
    let at = at_m / radius_m;
    let away = length(at);
    let way = at / max(away, 1e-3);
    let seed = turn * 37.0;
    let ragged = speck(way * 2.0 + seed) - 0.5 + 0.7 * (speck(at * 1.7 + seed) - 0.5);
    let cover = 1.0 - smoothstep(0.35, 1.9, away * (1.0 + 0.5 * ragged));
    let ash = max(grain(at * 4.0 + seed, 0.6, pixel_m / radius_m), 0.0);
    var mark: Mark;
    mark.rise = 0.0;
    mark.colour = vec4<f32>(SOOT * (1.0 + 3.0 * ash), cover * (0.92 - 0.5 * ash));
    return mark;
}

@fragment
fn overlay_fragment(draped: Draped) -> @location(0) vec4<f32> {
    let right = dpdx(draped.place_m);
    let down = dpdy(draped.place_m);
    // What a pixel spans along and across.
    let pixel_m = max(sqrt(right * right + down * down), vec2<f32>(1e-4));
    let light = light_at(draped.local, draped.slot);
    let at_m = draped.place_m;
    let half_m = draped.half_m;
    let kind = draped.kind;

    if kind >= CRATER {
        let across_m = max(pixel_m.x, pixel_m.y);
        var mark = scorch(at_m, half_m.x, half_m.y, across_m);
        if kind == CRATER {
            mark = crater(at_m, half_m.x, half_m.y, across_m);
        }
        // The right is at the turn; along is a quarter before it. On a rising side the normal leans back to the middle.
        let right = vec2<f32>(cos(half_m.y), sin(half_m.y));
        let out = at_m / max(length(at_m), 1e-3);
        let outward = vec2<f32>(right.y, -right.x) * out.x + right * out.y;
        let colour = lit(mark.colour.rgb, light, outward * -mark.rise);
        // What is smaller than a pixel is its share of it.
        let small = min(2.0 * REACH_RADII * half_m.x / across_m, 1.0);
        return vec4<f32>(shown(colour, draped.haze, draped.clip.xy).rgb, mark.colour.a * small);
    }

    var cover = 1.0;
    if half_m.x > 0.0 {
        let pixels = 2.0 * half_m.x / pixel_m.y;
        if kind == WHITE {
            cover = clamp((half_m.x - abs(at_m.y)) / pixel_m.y + 0.35, 0.0, 1.0) * smoothstep(0.1, 0.7, pixels);
        } else {
            // What is thinner than a pixel is drawn a pixel wide, and fades.
            cover = clamp((max(half_m.x, 0.5 * pixel_m.y) - abs(at_m.y)) / pixel_m.y + 0.5, 0.0, 1.0);
            cover *= min(pixels, 1.0) * smoothstep(0.08, 0.3, pixels);
            if kind >= PATH && kind <= RAILWAY {
                cover *= 1.0 - smoothstep(0.75, 1.0, length(draped.relative_m) / (ROAD_M * frame.focal_px));
            }
        }
    } else if kind == WHITE {
        cover = 1.0 - smoothstep(0.5, 1.5, pixel_m.y);
    }
    if half_m.y > 0.0 {
        cover *= clamp((half_m.y - abs(at_m.x)) / pixel_m.x + 0.35, 0.0, 1.0);
    }

    var colour = vec3<f32>(0.0);
    if kind == WATER {
        colour = water(draped, light, pixel_m);
    } else {
        var albedo = PAINT;
        if kind == RAILWAY {
            albedo = rails(at_m, pixel_m);
        } else if kind == PATH || kind == TRACK || kind == GRAVEL {
            albedo = gravel(kind, at_m, pixel_m);
        } else if kind == LANE || kind == ROAD || kind == MOTORWAY {
            albedo = road(kind, at_m, half_m.x, pixel_m);
        } else if kind == APRON {
            albedo = slabs(at_m, max(pixel_m.x, pixel_m.y));
        } else if kind == TAXIWAY {
            albedo = ASPHALT * (1.5 + grain(at_m, 5.0, pixel_m.x) * 0.25);
            albedo = mix(albedo, YELLOW, line(at_m.y, 0.12, pixel_m.y));
        } else if kind < WHITE {
            albedo = runway(kind, at_m, half_m.x, pixel_m);
        } else {
            albedo = PAINT * (1.0 + grain(at_m, 1.2, pixel_m.x) * 0.25);
        }
        colour = lit(albedo, light, vec2<f32>(0.0));
    }
    return vec4<f32>(shown(colour, draped.haze, draped.clip.xy).rgb, cover);
}

fn water(draped: Draped, light: vec4<f32>, pixel_m: vec2<f32>) -> vec3<f32> {
    let distance_m = length(draped.relative_m);
    let to_eye = draped.relative_m * (-1.0 / distance_m);
    // Ripples drift downstream at a metre a second.
    let at = vec2<f32>(draped.place_m.x - frame.time_s, draped.place_m.y);
    let tilt = vec2<f32>(grain(at, 1.4, pixel_m.x), grain(at.yx + 17.0, 1.1, pixel_m.x)) * 0.10;
    let normal = normalize(vec3<f32>(tilt.x, 1.0, tilt.y));
    let out = 1.0 - clamp(dot(normal, to_eye), 0.0, 1.0);
    // As in terrain.wgsl: Schlick, water's 2 % face on.
    let fresnel = 0.02 + 0.62 * (out * out) * (out * out) * out;
    // The bed shows at the banks.
    let shallow = smoothstep(0.55, 1.0, abs(draped.place_m.y) / max(draped.half_m.x, 0.1));
    let bed = mix(RIVER_BED, vec3<f32>(0.085, 0.085, 0.062), shallow);
    return lit(bed, light, vec2<f32>(0.0)) * (1.0 - fresnel) + draped.mirrored * fresnel;
}

// Water within its outlines: it ends at the outline, in a pixel.
@fragment
fn open_water_fragment(draped: Draped) -> @location(0) vec4<f32> {
    let right = dpdx(draped.place_m);
    let down = dpdy(draped.place_m);
    let pixel_m = max(sqrt(right * right + down * down), vec2<f32>(1e-4));
    let shores = clamp(draped.place_m / pixel_m, vec2<f32>(0.0), vec2<f32>(1.0));
    let light = light_at(draped.local, draped.slot);
    var ripple = vec2<f32>(0.5);
    if DETAIL > 0u {
        ripple = textureSample(detail_texture, detail_sampler, ripples_at(draped.local)).rg;
    }
    // Near the eye the map's finest level is in use.
    let bed = water_bed(map_at(vec3<f32>(draped.local, 0.0), draped.slot));
    let ground = lit(select(RIVER_BED, bed, draped.kind == STILL_WATER), light, vec2<f32>(0.0));
    let colour = water_seen(ground, light, draped.relative_m, ripple, draped.mirrored);
    return vec4<f32>(shown(colour, draped.haze, draped.clip.xy).rgb, shores.x * shores.y);
}
