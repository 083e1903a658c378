//! The slow and obvious way to place a tile's plants, and that the fast one gives the same.

use super::bed::{NOISES, SEA_M, SHORE_M, density, thicket};
use super::tests::{nursery, tiles};
use super::*;
use crate::noise::noise;
use crate::scatter::{hash, uniform};
use crate::species::Site;
use terrain::features::cover::CoverClass;

/// What grows on a site, asking every species.
fn choose(flora: &Flora, latitude_deg: f32, site: Site, height_m: f32, steep: f32, number: f32) -> Option<usize> {
    let within = |range: [f32; 2], value: f32| (range[0]..=range[1]).contains(&value);
    let weights = SPECIES.map(|species| {
        let grows = within(species.belt, height_m / flora.tree_line_m)
            && within(species.latitudes_deg, latitude_deg)
            && within(species.dryness, flora.dryness)
            && steep <= species.steepest;
        if grows { species.weights[site as usize] } else { 0.0 }
    });
    let mut rest = number * weights.iter().sum::<f32>();
    for (at, weight) in weights.iter().enumerate() {
        if rest < *weight {
            return Some(at);
        }
        rest -= weight;
    }
    // Rounding may leave a little.
    weights.iter().rposition(|weight| *weight > 0.0)
}

/// The plant of a hash cell.
fn plant(nursery: &Nursery, tier: &Tier, tile: TileIndex, [column, row]: [u32; 2], share: f32) -> Option<Plant> {
    let corner = corner_m(nursery.area().grid(), tier.side_m, tile);
    let words = [0, 1, 2, 3].map(|salt| {
        let cell = |tile: i32, at: u32| tile * tier.cells as i32 + at as i32;
        hash(cell(tile.x, column), cell(tile.z, row), tier.number * 8 + salt)
    });
    let [places, kinds, edges, looks] = words;
    let parts = |at: u32, word: u32| ((u64::from(word >> 16) + (u64::from(at) << 16)) / u64::from(tier.cells)) as u16;
    let at = [parts(column, places[0]), parts(row, places[1])];
    let mut plant = Plant { at, turn: (looks[0] >> 24) as u8, tint: (looks[1] >> 24) as u8, ..Plant::default() };
    let plan = plant.plan_m(tier, corner);
    let blur_m = nursery.cover().cell_m() * 0.7;
    let off = DVec2::new(f64::from(uniform(edges[0])) - 0.5, f64::from(uniform(edges[1])) - 0.5) * blur_m;
    let cover = nursery.cover().class_at(plan.x + off.x, plan.y + off.y);
    let site = Site::of(cover)?;
    let here = nursery.cover().class_at(plan.x, plan.y);
    let (height_m, normal) = nursery.area().height_and_normal(plan.x, plan.y)?;
    plant.height_m = height_m as f32;
    let noises = NOISES.map(|(side_m, salt)| noise(plan / side_m, salt));
    let dense = density(tier, cover) * thicket(cover, noises);
    let rank = uniform(places[2]);
    let steep = (1.0 - normal.y * normal.y).max(0.0).sqrt() as f32;
    let species =
        choose(nursery.flora(), 0.74_f64.to_degrees() as f32, site, plant.height_m, steep, uniform(kinds[1]))?;
    plant.species = species as u8;
    let high = ((plant.height_m / nursery.flora().tree_line_m - 0.8) / 0.3).clamp(0.0, 1.0);
    let grown = (0.5 * uniform(kinds[2]) + 0.5 * uniform(edges[2])) * (1.0 - 0.75 * high);
    plant.size = (grown * 255.0) as u8;
    let stands = uniform(kinds[0]) < share
        && rank < dense
        && rank < dense * nursery.moisture(cover, plant.height_m)
        && !matches!(here, CoverClass::Water | CoverClass::Sand | CoverClass::Paved)
        && height_m.abs() >= SEA_M
        && !nursery.clearings().holds(plan)
        && nursery.landscape.lakes.signed_distance_m(plan) >= SHORE_M;
    stands.then_some(plant)
}

fn planted(nursery: &Nursery, tier: &Tier, tile: TileIndex, share: f32) -> Planted {
    let cells = (0..tier.cells).flat_map(|row| (0..tier.cells).map(move |column| [column, row]));
    let all: Vec<Plant> = cells.filter_map(|cell| plant(nursery, tier, tile, cell, share)).collect();
    let mut planted = Planted::default();
    for number in 0..SQUARES * SQUARES {
        let part = |at: u16| u32::from(at) * SQUARES / 65_536;
        let mut square: Vec<Plant> = all.clone();
        square.retain(|plant| part(plant.at[1]) * SQUARES + part(plant.at[0]) == number);
        square.sort_by_key(|plant| (!plant.is_conifer(), u8::MAX - plant.turn));
        let heights = square.iter().map(|plant| plant.height_m);
        let feet_m = [heights.clone().fold(f32::INFINITY, f32::min), heights.fold(f32::NEG_INFINITY, f32::max)];
        let conifers = square.iter().filter(|plant| plant.is_conifer()).count();
        let conifers_end = (planted.plants.len() + conifers) as u32;
        planted.plants.extend(square);
        planted.squares.push(Square { conifers_end, end: planted.plants.len() as u32, feet_m });
    }
    planted
}

#[test]
fn placing_a_tile_at_once_is_placing_every_plant_by_itself() {
    let nursery = nursery();
    let (mut plants, mut conifers) = (0, 0);
    for (tier, share) in TIERS.iter().zip([1.0, 0.6, 1.0]) {
        let tiles = tiles(nursery.area().grid(), tier);
        for tile in tiles.iter().copied().step_by(tier.number as usize * 3 + 1) {
            let (fast, slow) = (nursery.plants(tier, tile, share), planted(&nursery, tier, tile, share));
            assert_eq!(fast.squares, slow.squares, "{tier:?} {tile:?}");
            assert_eq!(fast.plants, slow.plants, "{tier:?} {tile:?}");
            plants += fast.plants.len();
            conifers += fast.plants.iter().filter(|plant| plant.is_conifer()).count();
        }
    }
    assert!(plants > 30_000 && conifers > 1_000, "{plants} plants, {conifers} conifers");
}
