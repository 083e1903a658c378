// heights.wgsl: where the vertex stage would put every post of the window, for proofs.
// Reads:  group 0 frame; group 1 the window, by the same function as terrain.wgsl.
// Writes: group 2 binding 0: bits of the height and of the position relative to the eye, a post of a slot each.
// Host:   visual/src/passes/heights.rs
// Twin:   terrain::Field (heights), terrain::verify::cracks (positions).

//!include "shared/frame.wgsl"
//!include "shared/posts.wgsl"

@group(2) @binding(0) var<storage, read_write> placed: array<vec4<u32>>;

// x: a post of the tile, y: a slot.
@compute @workgroup_size(64)
fn heights_compute(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < TILE * TILE {
        let post = post_of(id.x, id.y);
        placed[id.y * TILE * TILE + id.x] = vec4<u32>(bitcast<u32>(post.height_m), bitcast<vec3<u32>>(post.relative_m));
    }
}
