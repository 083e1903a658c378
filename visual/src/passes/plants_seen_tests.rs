//! What is seen is what asking every plant by itself says, over all plants of all tiles about the eye.

use super::*;
use std::sync::Arc;
use terrain::block::Landscape;
use terrain::block::ground_map::Climate;
use terrain::features::cover::{Cover, CoverClass};
use terrain::frame::attitude;
use terrain::near::TileIndex;
use terrain::{Grid, synthetic};
use vegetation::place::{Nursery, TIERS, corner_m};

/// 24 x 24 km of ridges below mixed forest, built-up ground and scrub.
fn nursery() -> Nursery {
    let grid = Grid::centred(200.0, 4, 4).unwrap();
    let side = grid.columns() - 1;
    let kinds = [CoverClass::MixedForest, CoverClass::Conifer, CoverClass::BuiltUp, CoverClass::Scrub];
    let cells = (0..side * side).map(|at| kinds[(at % side / 7 + at / side / 5) as usize % 4] as u8).collect();
    let mut landscape =
        Landscape::bare(Arc::new(synthetic::ridges(grid, 3)), [13.9, 27.8, 55.6], Climate::new(0.74, 1_500.0));
    landscape.cover = Arc::new(Cover::new(&grid, 1, cells).unwrap());
    Nursery::new(Arc::new(landscape), 0.74)
}

/// A plant as it is drawn: 0 mesh, 1 card, 2 triangle; the bits of its foot and height; its looks.
type Drawn = (u8, [u32; 4], u32);

fn drawn(way: u8, foot_m: [f32; 3], tall_m: f32, looks: u32) -> Drawn {
    let [x, y, z] = foot_m.map(f32::to_bits);
    (way, [x, y, z, tall_m.to_bits()], looks)
}

/// One plant, asked all there is to ask.
fn alone(plant: &Plant, tier: &Tier, foot_m: Vec3, view: &View, drawn_as: &mut Vec<Drawn>) {
    let species = &SPECIES[usize::from(plant.species)];
    let (distance_m, whole_m, reach_m) = (foot_m.length(), plant.tall_m(), plant.reach_m(tier));
    let middle_m = foot_m + Vec3::new(0.0, 0.5 * whole_m, 0.0);
    let around_m = 0.6 * (1.0 + 1.15 * species.width) * whole_m;
    let beside = |plane: &crate::camera::Plane| plane.normal.dot(middle_m) + plane.offset_m < -around_m;
    if distance_m >= reach_m || view.frustum().planes.iter().any(beside) {
        return;
    }
    let looks = u32::from_le_bytes([plant.species, plant.size, plant.turn, plant.tint]);
    let mesh_m = 200.0 * (whole_m / 20.0).clamp(0.2, 1.0);
    if distance_m < mesh_m {
        drawn_as.push(drawn(0, foot_m.to_array(), 0.0, looks));
    }
    let pixels = whole_m * view.focal_px() as f32 / distance_m.max(1.0);
    let share = grown(distance_m, reach_m) * shrunk(pixels);
    if distance_m > 0.85 * mesh_m && share * pixels >= LEAST_PX {
        let early = if plant.is_conifer() { 0.6 } else { 1.0 };
        let far_m = 1_400.0 * early * (0.8 + (1.0 - 0.8) * f32::from(plant.turn) / 255.0);
        let way = if distance_m < far_m { 1 } else { 2 };
        drawn_as.push(drawn(way, foot_m.to_array(), whole_m * share, looks));
    }
}

#[test]
fn what_is_seen_is_what_every_plant_by_itself_says() {
    let nursery = nursery();
    let grid = *nursery.area().grid();
    let mut ways = [0; 3];
    // Eyes in the thick of it: beside a plant of a full tile.
    let full: Vec<DVec2> = (0..48 * 48)
        .filter_map(|at| {
            let tile = TileIndex { x: at % 48, z: at / 48 };
            let planted = nursery.plants(&TIERS[2], tile, 1.0).plants;
            let corner = corner_m(&grid, TIERS[2].side_m, tile);
            (planted.len() > 1_000).then(|| planted[planted.len() / 2].plan_m(&TIERS[2], corner) + 3.0)
        })
        .collect();
    let eyes = [full[0], full[full.len() / 2], full[full.len() - 1]];
    for (eye, (above_m, heading, pitch)) in
        eyes.into_iter().zip([(5.0, 0.7, -0.1), (60.0, 3.9, -0.6), (900.0, 5.2, -0.3)])
    {
        let ground_m = nursery.area().height_m(eye.x, eye.y).unwrap();
        let eye_m = DVec3::new(eye.x, ground_m + above_m, eye.y);
        let view = View::fov_y(eye_m, attitude(heading, pitch, 0.2), 1.0, [1280, 720]);
        let frustum = view.frustum();
        let (mut fast, mut slow) = (Vec::new(), Vec::new());
        let mut seen = Seen::default();
        // What a view before saw must not stay.
        seen.far.push(Stand::default());
        for tier in &TIERS {
            let reaches = Reaches::of(tier);
            let mut tiles = Vec::new();
            let along = (24_000.0 / tier.side_m) as i32;
            for (tile_x, tile_z) in (0..along).flat_map(|z| (0..along).map(move |x| (x, z))) {
                let tile = TileIndex { x: tile_x, z: tile_z };
                let origin_m = corner_m(&grid, tier.side_m, tile) - eye;
                // A tile more than reach itself asks for.
                if DVec2::ZERO.clamp(origin_m, origin_m + tier.side_m).length() < tier.reach_m + 300.0 {
                    tiles.push((origin_m, nursery.plants(tier, tile, 1.0)));
                }
            }
            let mut found = Vec::new();
            for (origin_m, planted) in &tiles {
                parts(tier, &reaches, planted, *origin_m, eye_m.y, &frustum, &mut found);
                let origin_m = origin_m.as_vec2();
                for plant in &planted.plants {
                    let part_m = (tier.side_m / PARTS) as f32;
                    let foot_m = Vec3::new(
                        origin_m.x + f32::from(plant.at[0]) * part_m,
                        (f64::from(plant.height_m) - eye_m.y) as f32,
                        origin_m.y + f32::from(plant.at[1]) * part_m,
                    );
                    alone(plant, tier, foot_m, &view, &mut slow);
                }
            }
            seen.look(found, &view, &frustum);
            let near = seen.near.iter().flatten().map(|near| drawn(0, near.foot_m, 0.0, near.looks));
            fast.extend(near);
            fast.extend(seen.cards.iter().map(|s| drawn(1, s.foot_m, s.tall_m, s.looks)));
            fast.extend(seen.far.iter().map(|s| drawn(2, s.foot_m, s.tall_m, s.looks)));
        }
        fast.sort_unstable();
        slow.sort_unstable();
        assert_eq!(fast.len(), slow.len());
        assert!(fast == slow, "{:?}", fast.iter().zip(&slow).find(|(a, b)| a != b));
        slow.iter().for_each(|(way, ..)| ways[usize::from(*way)] += 1);
    }
    assert!(ways.iter().all(|count| *count > 300), "{ways:?}");
}

#[test]
fn no_plant_is_larger_than_parts_allow_for() {
    for (species, kind) in SPECIES.iter().zip(kinds()) {
        let [_, most_m] = species.height_m;
        assert!(most_m <= MOST_TALL_M && kind.around * most_m <= MOST_AROUND_M, "{}", species.name);
    }
}
