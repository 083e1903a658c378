//! Every shader compiles, mirrors its host structs to the byte, and keeps its promised number of texture reads.
//!
//! All on the processor, with the shader compiler that the renderer itself uses.

use std::mem::offset_of;
use terrain::block::window::MAX_BLOCKS;
use visual::passes::canopy::CanopyTile;
use visual::passes::lights::{LightInstance, LightsUniforms};
use visual::passes::lines::Segment;
use visual::passes::plants_kinds::{MOST_SPECIES, SpeciesEntry};
use visual::passes::plants_seen::Stand;
use visual::passes::terrain::{BlockEntry, WindowUniforms};
use visual::shaders;
use visual::uniforms::FrameUniforms;
use wgpu::naga;

/// Name and offset of every field of a host struct, as [`layout`] gives those of the shader's.
macro_rules! host {
    ($mirror:ident: $($field:ident),* $(,)?) => {
        vec![$((stringify!($field).to_owned(), offset_of!($mirror, $field) as u32)),*]
    };
}

fn parsed(name: &str) -> naga::Module {
    let source = shaders::joined(name);
    let module = naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&source)));
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::default());
    if let Err(error) = validator.validate(&module) {
        panic!("{name}: {}", error.emit_to_string(&source));
    }
    module
}

/// Name and offset of every member of a struct, and its size.
fn layout(module: &naga::Module, name: &str) -> (Vec<(String, u32)>, u32) {
    for (_, found) in module.types.iter() {
        if let (Some(found_name), naga::TypeInner::Struct { members, span }) = (&found.name, &found.inner)
            && found_name == name
        {
            let named = |member: &naga::StructMember| (member.name.clone().unwrap_or_default(), member.offset);
            return (members.iter().map(named).collect(), *span);
        }
    }
    panic!("expected a struct {name} in the shader, found none");
}

/// Texture sample calls that one run of an entry can reach, and whether any stands in a loop.
fn samples(module: &naga::Module, entry: &naga::EntryPoint) -> (usize, bool) {
    in_block(module, &entry.function, &entry.function.body, false)
}

fn in_block(module: &naga::Module, function: &naga::Function, block: &naga::Block, looped: bool) -> (usize, bool) {
    let mut total = (0, false);
    let mut add = |(count, in_loop): (usize, bool)| total = (total.0 + count, total.1 || in_loop);
    for statement in block {
        use naga::Statement as S;
        match statement {
            S::Emit(range) => {
                let count = range
                    .clone()
                    .filter(|&handle| matches!(function.expressions[handle], naga::Expression::ImageSample { .. }))
                    .count();
                add((count, looped && count > 0));
            }
            S::Block(inner) => add(in_block(module, function, inner, looped)),
            // A branch that a constant closes costs nothing.
            S::If { condition, accept, reject } if closed(function, *condition).is_some() => {
                let taken = if closed(function, *condition) == Some(true) { accept } else { reject };
                add(in_block(module, function, taken, looped));
            }
            S::If { accept, reject, .. } => {
                // Both sides count: a software rasteriser runs both.
                add(in_block(module, function, accept, looped));
                add(in_block(module, function, reject, looped));
            }
            S::Switch { cases, .. } => {
                for case in cases {
                    add(in_block(module, function, &case.body, looped));
                }
            }
            S::Loop { body, continuing, .. } => {
                add(in_block(module, function, body, true));
                add(in_block(module, function, continuing, true));
            }
            S::Call { function: called, .. } => {
                let called = &module.functions[*called];
                add(in_block(module, called, &called.body, looped));
            }
            _ => {}
        }
    }
    total
}

/// What a condition is, where the compiler knows it.
fn closed(function: &naga::Function, condition: naga::Handle<naga::Expression>) -> Option<bool> {
    match function.expressions[condition] {
        naga::Expression::Literal(naga::Literal::Bool(is)) => Some(is),
        _ => None,
    }
}

#[test]
fn every_shader_parses_and_validates() {
    for (name, _) in shaders::SOURCES {
        let module = parsed(name);
        assert!(!module.entry_points.is_empty(), "{name} has no entry point");
    }
}

#[test]
fn the_moon_reaches_whatever_the_sun_does() {
    for (name, _) in shaders::SOURCES {
        // A light map's sunlight is nothing while the moon is the key light: `key_seen` alone may read it.
        let source = shaders::joined(name);
        let reads = source.split("light.b").skip(1).filter(|rest| !rest.starts_with(char::is_alphanumeric)).count();
        assert!(reads <= usize::from(source.contains("fn key_seen")), "{name}: {reads} reads of light.b");
    }
}

#[test]
fn frame_uniforms_are_the_same_on_both_sides() {
    let host = host![
        FrameUniforms:
        clip_from_relative,
        eye_high_m,
        eye_altitude_m,
        eye_low_m,
        time_s,
        ray_corner,
        exposure,
        ray_right,
        near_m,
        ray_down,
        focal_px,
        sun_direction,
        sun_radius_rad,
        sun_irradiance,
        molecules_per_m,
        sky_irradiance,
        haze_per_m,
        disc,
        haze_base_m,
        sun_level,
        viewport_px,
        fade_start_m,
        fade_end_m,
        eye_molecules,
        eye_haze,
        disc_direction,
        threshold_lux,
        moon_direction,
        moon_radius_rad,
        moon_to_sun,
        moon_key,
        moon_light,
        haze_scale_m,
        aerial_reach_m,
        lamps,
        moon_share,
        sun_sin,
    ];
    for (name, source) in shaders::SOURCES {
        if source.contains("shared/frame.wgsl") {
            let (shader, span) = layout(&parsed(name), "FrameUniforms");
            assert_eq!(shader, host, "{name}");
            assert_eq!(span as usize, size_of::<FrameUniforms>(), "{name}");
        }
    }
}

#[test]
fn the_windows_uniforms_and_table_of_blocks_are_the_same_on_both_sides() {
    let window = host![WindowUniforms: eye_post, eye_fraction_m, step_m, light_texel, map_texel, light_layer];
    let block = host![BlockEntry: first_post, level, side];
    let mut seen = 0;
    for (name, source) in shaders::SOURCES {
        if !source.contains("shared/posts.wgsl") {
            continue;
        }
        seen += 1;
        let module = parsed(name);
        let (shader, span) = layout(&module, "WindowUniforms");
        assert_eq!((shader, span as usize), (window.clone(), size_of::<WindowUniforms>()), "{name}");
        let (shader, span) = layout(&module, "Block");
        assert_eq!((shader, span as usize), (block.clone(), size_of::<BlockEntry>()), "{name}");

        let table = module.global_variables.iter().find(|(_, global)| global.name.as_deref() == Some("blocks"));
        let (_, table) = table.expect("a table of blocks");
        let naga::TypeInner::Array { size: naga::ArraySize::Constant(length), stride, .. } =
            module.types[table.ty].inner
        else {
            panic!("{name}: expected an array of fixed length, found {:?}", module.types[table.ty].inner);
        };
        assert_eq!(length.get(), MAX_BLOCKS * MAX_BLOCKS, "{name}");
        assert_eq!(stride as usize, size_of::<BlockEntry>(), "{name}");
    }
    assert!(seen >= 3, "terrain.wgsl, overlay.wgsl, objects.wgsl and heights.wgsl place posts");
}

#[test]
fn plants_and_canopy_are_the_same_on_both_sides() {
    let species = host![SpeciesEntry: height_m, width, shape, colour];
    let plants = parsed("plants.wgsl");
    let (shader, span) = layout(&plants, "Species");
    assert_eq!((shader, span as usize), (species, size_of::<SpeciesEntry>()));
    let (_, span) = layout(&plants, "Plant");
    assert_eq!(span as usize, size_of::<Stand>());
    let tile = host![
        CanopyTile: origin_m, cell_m, start_m, reach_m, crown_m, phase, turned_phase, turned_m, pad
    ];
    let (shader, span) = layout(&parsed("canopy.wgsl"), "Tile");
    assert_eq!((shader, span as usize), (tile, size_of::<CanopyTile>()));

    assert!(vegetation::species::SPECIES.len() <= MOST_SPECIES);
    let source = shaders::joined("plants.wgsl");
    let elevations = vegetation::pictures::ELEVATIONS_RAD;
    for line in [
        format!("const LEAVES: u32 = {}u;", vegetation::pictures::LEAVES),
        format!("const ELEVATIONS: u32 = {}u;", elevations.len()),
        format!("array<Species, {MOST_SPECIES}>"),
    ] {
        assert!(source.contains(&line), "expected \"{line}\" in plants.wgsl");
    }
}

#[test]
fn line_segments_are_tightly_packed_in_the_order_of_their_locations() {
    let offsets = [
        offset_of!(Segment, ends_px),
        offset_of!(Segment, joints),
        offset_of!(Segment, colour),
        offset_of!(Segment, half_width_px),
        offset_of!(Segment, soft_px),
    ];
    assert_eq!(offsets, [0, 16, 32, 48, 52]);
    let (members, _) = layout(&parsed("lines.wgsl"), "Segment");
    let names: Vec<_> = members.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["ends_px", "joints", "colour", "half_width_px", "soft_px"]);
}

#[test]
fn lights_are_tightly_packed_in_the_order_of_their_locations() {
    let host = host![LightInstance: post, local_m, height, half_rad, axis, colour, back];
    assert_eq!(host.iter().map(|(_, offset)| *offset).collect::<Vec<_>>(), [0, 8, 16, 24, 32, 40, 44]);
    let module = parsed("lights.wgsl");
    let (members, _) = layout(&module, "Light");
    assert_eq!(
        members.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        host.iter().map(|(name, _)| name).collect::<Vec<_>>()
    );
    let uniforms = host![LightsUniforms: eye_post, eye_fraction_m, step_m, thin_from_m, thinnest, directed];
    assert_eq!(layout(&module, "LightsUniforms"), (uniforms, size_of::<LightsUniforms>() as u32));
}

#[test]
fn fragments_read_few_textures_and_none_in_a_loop() {
    for (name, _) in shaders::SOURCES {
        let module = parsed(name);
        for entry in &module.entry_points {
            let (count, in_loop) = samples(&module, entry);
            let most = match (*name, entry.stage) {
                ("terrain.wgsl", naga::ShaderStage::Fragment) => 4,
                // Crowns at two scales, or their repeats show from above.
                ("canopy.wgsl", naga::ShaderStage::Fragment) => 2,
                // Draped water is ground: what the ground's own water reads, light, map and ripples.
                ("overlay.wgsl", naga::ShaderStage::Fragment) if entry.name == "open_water_fragment" => 3,
                (_, naga::ShaderStage::Fragment) => 1,
                // The vertex stage does the work: only loops are forbidden there.
                _ => usize::MAX,
            };
            assert!(count <= most && !in_loop, "{name} {}: {count} reads, in a loop: {in_loop}", entry.name);
        }
    }
}

#[test]
fn each_scale_of_detail_costs_the_ground_one_read_and_without_there_are_two() {
    const FREE: &str = "override DETAIL: u32 = 2u;";
    let source = shaders::joined("terrain.wgsl");
    assert!(source.contains(FREE), "expected \"{FREE}\" in terrain.wgsl");
    // Water has one scale of ripples.
    for (detail, land, water) in [(0, 2, 2), (1, 3, 3), (2, 4, 3)] {
        let fixed = source.replace(FREE, &format!("const DETAIL: u32 = {detail}u;"));
        let module = naga::front::wgsl::parse_str(&fixed).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&fixed)));
        for (name, most) in [("terrain_fragment", land), ("water_fragment", water)] {
            let entry = module.entry_points.iter().find(|entry| entry.name == name).expect(name);
            assert_eq!(samples(&module, entry), (most, false), "{name} at detail {detail}");
        }
    }
}

#[test]
fn the_counter_of_reads_sees_loops_calls_and_branches() {
    let source = "
        @group(0) @binding(0) var t: texture_2d<f32>;
        @group(0) @binding(1) var s: sampler;
        fn two(at: vec2<f32>) -> vec4<f32> {
            return textureSampleLevel(t, s, at, 0.0) + textureSampleLevel(t, s, at * 2.0, 0.0);
        }
        @fragment fn flat_reads(@location(0) at: vec2<f32>) -> @location(0) vec4<f32> {
            var sum = two(at);
            if (at.x > 0.5) { sum += textureSampleLevel(t, s, at, 0.0); }
            return sum;
        }
        @fragment fn looped(@location(0) at: vec2<f32>) -> @location(0) vec4<f32> {
            var sum = vec4<f32>(0.0);
            for (var i = 0; i < 3; i++) { sum += two(at * f32(i)); }
            return sum;
        }";
    let module = naga::front::wgsl::parse_str(source).expect("the test's own shader");
    let counts: Vec<_> = module.entry_points.iter().map(|entry| samples(&module, entry)).collect();
    assert_eq!(counts, [(3, false), (2, true)]);
}

#[test]
fn what_is_draped_has_the_same_numbers_on_both_sides() {
    use terrain::block::overlay::{ACROSS_PER_METRE, EXTENT_PER_METRE, Kind, PLACE_BITS, Vertex, lattice};
    let source = shaders::joined("overlay.wgsl");
    let kinds = [
        ("WATER", Kind::Water),
        ("WATER_AREA", Kind::WaterArea),
        ("STILL_WATER", Kind::StillWater),
        ("PATH", Kind::Path),
        ("TRACK", Kind::Track),
        ("GRAVEL", Kind::Gravel),
        ("LANE", Kind::Lane),
        ("ROAD", Kind::Road),
        ("MOTORWAY", Kind::Motorway),
        ("RAILWAY", Kind::Railway),
        ("APRON", Kind::Apron),
        ("TAXIWAY", Kind::Taxiway),
        ("RUNWAY_ASPHALT", Kind::RunwayAsphalt),
        ("RUNWAY_CONCRETE", Kind::RunwayConcrete),
        ("RUNWAY_GRAVEL", Kind::RunwayGravel),
        ("RUNWAY_GRASS", Kind::RunwayGrass),
        ("WHITE", Kind::White),
        ("CRATER", Kind::Crater),
        ("SCORCH", Kind::Scorch),
    ];
    let mut lines: Vec<String> =
        kinds.iter().map(|(name, kind)| format!("const {name}: u32 = {}u;", *kind as u32)).collect();
    lines.push(format!("const PLACE_BITS: u32 = {PLACE_BITS}u;"));
    lines.push(format!("const ACROSS_PER_METRE: f32 = {ACROSS_PER_METRE:.1};"));
    lines.push(format!("const EXTENT_PER_METRE: f32 = {EXTENT_PER_METRE:.1};"));
    lines.push(format!("const REACH_RADII: f32 = {:.1};", terrain::block::overlay::decal::REACH_RADII));
    lines.push(format!("const UNITS: f32 = {:.1};", lattice::UNITS as f64));
    lines.push(format!("const ROAD_M: f32 = {:.1};", visual::passes::overlay::ROAD_M));
    for line in lines {
        assert!(source.contains(&line), "expected \"{line}\" in overlay.wgsl");
    }
    let offsets = [
        offset_of!(Vertex, east),
        offset_of!(Vertex, south),
        offset_of!(Vertex, height_m),
        offset_of!(Vertex, along_m),
        offset_of!(Vertex, across),
    ];
    assert_eq!((offsets, size_of::<Vertex>()), ([0, 4, 8, 12, 16], 20));
}

#[test]
fn the_sky_table_has_the_same_size_on_both_sides() {
    let source = shaders::joined("sky.wgsl");
    for (name, value) in [
        ("TABLE_WIDTH", visual::sky::TABLE_WIDTH as f32),
        ("TABLE_HEIGHT", visual::sky::TABLE_HEIGHT as f32),
        ("AERIAL_WIDTH", visual::sky::AERIAL_SIZE[0] as f32),
        ("AERIAL_HEIGHT", visual::sky::AERIAL_SIZE[1] as f32),
        ("AERIAL_DEPTH", visual::sky::AERIAL_SIZE[2] as f32),
        ("MOLECULE_SCALE_HEIGHT_M", visual::sky::MOLECULE_SCALE_HEIGHT_M),
    ] {
        let line = format!("const {name}: f32 = {value:.1};");
        assert!(source.contains(&line), "expected \"{line}\" in shared/sky.wgsl");
    }
}
