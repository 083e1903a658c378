// shared/posts.wgsl: where a post of the window is. The only place that forms a terrain position.
// Needs: shared/frame.wgsl. Group 1, bindings 0 to 2.
// Host: visual/src/passes/terrain.rs (offsets compared in tests/shader_contract.rs).

// Texels along a block's height and light tile: its posts and an apron.
override TILE: u32 = 32u;

struct WindowUniforms {
    eye_post: vec2<i32>,         // column and row of the post north-west of the eye
    eye_fraction_m: vec2<f32>,   // the eye's east and south of that post
    step_m: f32,                 // between posts
    light_texel: f32,            // 1 / texels along the light maps
    map_texel: f32,              // 1 / texels along the ground maps
    light_layer: i32,            // of the sun in use
}

// First column and row of the block in a slot, its level (0, 1, 2 mixed), and the slots along the window.
struct Block {
    first_post: vec2<i32>,
    level: i32,
    side: i32,
}

@group(1) @binding(0) var<uniform> window: WindowUniforms;
@group(1) @binding(1) var<uniform> blocks: array<Block, 1024>;
@group(1) @binding(2) var heights: texture_2d<f32>;

struct Post {
    relative_m: vec3<f32>,  // position minus the eye
    height_m: f32,
    local: vec2<u32>,       // column and row in the block
    slot: vec2<u32>,        // column and row of the slot in the window
    level: f32,
}

fn post_of(index: u32, slot: u32) -> Post {
    let block = blocks[slot];
    var post: Post;
    post.local = vec2<u32>(index % TILE, index / TILE);
    post.slot = vec2<u32>(slot % u32(block.side), slot / u32(block.side));
    post.height_m = textureLoad(heights, post.slot * TILE + post.local, 0).r;
    // Whole numbers first: exact, so the same post gives the same bits from every block that has it.
    let away = vec2<f32>(block.first_post + vec2<i32>(post.local) - window.eye_post);
    let plan_m = away * window.step_m - window.eye_fraction_m;
    post.relative_m = vec3<f32>(plan_m.x, (post.height_m - frame.eye_high_m.y) - frame.eye_low_m.y, plan_m.y);
    post.level = f32(block.level);
    return post;
}
