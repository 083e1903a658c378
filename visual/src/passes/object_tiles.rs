//! What a tile of objects holds, made off the render thread.
//!
//! Frame of its buildings: x east and z south of the tile's anchor post, y above sea level, metres. A thing belongs to
//! the tile that holds the middle of its plan, so each is drawn once.

use super::objects::Instance;
use crate::models::things::Model;
use crate::models::{Mesh, building};
use glam::{DQuat, DVec2, DVec3};
use terrain::Grid;
use terrain::features::index::{Object, ObjectId, ObjectIndex};
use terrain::features::solid::{BuildingSolid, hash_of};
use terrain::near::TileIndex;

/// A thing that is an instance of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thing {
    /// Its shape.
    pub model: Model,
    /// Where it stands, for the device.
    pub instance: Instance,
    /// Where it stands, world metres.
    pub at_m: DVec3,
}

/// See the module.
#[derive(Debug, Default, PartialEq)]
pub struct Tile {
    /// Column and row of the post that the buildings count from.
    pub anchor_post: [i32; 2],
    /// All buildings, largest first.
    pub mesh: Mesh,
    /// For each building its size and the end of its indices.
    pub cuts: Vec<(f64, u32)>,
    /// Everything else.
    pub things: Vec<Thing>,
    /// Least corner of what it holds, world metres.
    pub low: DVec3,
    /// Greatest corner.
    pub high: DVec3,
    /// Size of the largest thing.
    pub largest_m: f64,
}

impl Tile {
    /// Whether nothing stands there.
    pub fn is_empty(&self) -> bool {
        self.cuts.is_empty() && self.things.is_empty()
    }

    /// Bytes of its buildings.
    pub fn bytes(&self) -> usize {
        size_of_val(self.mesh.vertices.as_slice()) + size_of_val(self.mesh.indices.as_slice())
    }
}

/// Makes a tile.
pub fn made(index: &ObjectIndex, grid: &Grid, tile: TileIndex, side_m: f64) -> Tile {
    let low = DVec2::new(grid.west_m + f64::from(tile.x) * side_m, grid.north_m + f64::from(tile.z) * side_m);
    let high = low + side_m;
    let post = ((low - DVec2::new(grid.west_m, grid.north_m)) / grid.step_m).floor();
    let anchor_post = [post.x as i32, post.y as i32];
    let from = DVec2::new(grid.x_m(i64::from(anchor_post[0])), grid.z_m(i64::from(anchor_post[1])));
    let mut made = Tile { anchor_post, low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, ..Tile::default() };
    let belongs = |object: &&Object| {
        let at = object.plan_middle();
        at.x >= low.x && at.x < high.x && at.y >= low.y && at.y < high.y
    };
    let mut all: Vec<&Object> = index.in_rectangle(low, high).filter(belongs).collect();
    // The tree's own order is no promise.
    all.sort_by_key(|object| object.id);
    let mut buildings: Vec<(f64, ObjectId, BuildingSolid)> = Vec::new();
    for object in all {
        made.low = made.low.min(object.low);
        made.high = made.high.max(object.high);
        if let Some(solid) = index.building(object) {
            buildings.push((building::size_m(&solid, object.high.y), object.id, solid));
        } else if let Some(thing) = thing(index, object, anchor_post, from) {
            let size_m = (object.high - object.low).length();
            made.largest_m = made.largest_m.max(1.5 * size_m);
            // Blades, arms and aerials reach beyond the box that shells meet: a turbine's blades by half its height.
            made.low -= DVec3::splat(0.55 * size_m);
            made.high += DVec3::splat(0.55 * size_m);
            made.things.push(thing);
        }
    }
    buildings.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    for (size_m, id, solid) in buildings {
        let ObjectId::Building(number) = id else { continue };
        let class = index.features().buildings[number as usize].class;
        building::add(&mut made.mesh, &solid, class, from, size_m);
        made.cuts.push((size_m, made.mesh.indices.len() as u32));
        made.largest_m = made.largest_m.max(size_m);
    }
    made
}

fn thing(index: &ObjectIndex, object: &Object, anchor_post: [i32; 2], from: DVec2) -> Option<Thing> {
    let stand = index.stand(object)?;
    let features = index.features();
    let (model, scale) = match object.id {
        ObjectId::Building(_) => return None,
        ObjectId::Placed(number) => (features.placed.get(number as usize)?.class.into(), 1.0),
        ObjectId::Mast(number) => {
            let mast = features.masts.get(number as usize)?;
            (mast.class.into(), mast.height_m)
        }
        ObjectId::PowerTower { line, .. } => (Model::PowerTower, features.power_lines.get(line as usize)?.height_m),
    };
    let at = DVec2::new(stand.at_m.x, stand.at_m.z);
    let offset = at - from;
    // Clockwise seen from above is a negative turn about up.
    let rotation = DQuat::from_rotation_y(-stand.grid_heading_rad).as_quat().to_array();
    let instance = Instance {
        anchor_post,
        offset_m: [offset.x as f32, stand.at_m.y as f32, offset.y as f32],
        scale,
        rotation,
        seed: hash_of(at) << 8,
        shade: 1.0,
    };
    Some(Thing { model, instance, at_m: stand.at_m })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use terrain::features::model::{Building, BuildingClass, Features, Mast, MastClass, Origin, Placed, PlacedClass};
    use terrain::{Ground, synthetic};

    #[test]
    fn every_thing_is_in_one_tile_and_buildings_stand_largest_first() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let field = synthetic::rough(grid, 4, 300.0);
        let area = Ground::new(Arc::new(field)).whole();
        let mut features = Features::default();
        for number in 0..400_u32 {
            let at = DVec2::new(f64::from(number * 7919 % 5_000), f64::from(number * 104_729 % 5_000)) - 2_500.0;
            let half = 4.0 + f64::from(number % 9);
            let outline = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let outline = outline.map(|(x, z)| at + DVec2::new(x, z) * half).to_vec();
            let height_from = Origin::Assumed;
            features.buildings.push(Building { class: BuildingClass::House, outline, height_m: 6.0, height_from });
        }
        features.masts.push(Mast { class: MastClass::Mast, at: DVec2::ZERO, height_m: 40.0 });
        let truck = Placed { class: PlacedClass::Truck, at: DVec2::new(9.0, 30.0), grid_heading_rad: 1.0 };
        features.placed.push(truck);
        let index = ObjectIndex::new(Arc::new(features), &area);
        let (mut buildings, mut things) = (0, 0);
        for z in 0..4 {
            for x in 0..4 {
                let tile = made(&index, &grid, TileIndex { x, z }, 1_500.0);
                assert_eq!(tile, made(&index, &grid, TileIndex { x, z }, 1_500.0));
                assert!(tile.cuts.windows(2).all(|pair| pair[0].0 >= pair[1].0 && pair[0].1 < pair[1].1));
                assert_eq!(tile.cuts.last().map_or(0, |(_, end)| *end as usize), tile.mesh.indices.len());
                let corner =
                    DVec2::new(grid.x_m(i64::from(tile.anchor_post[0])), grid.z_m(i64::from(tile.anchor_post[1])));
                for vertex in &tile.mesh.vertices {
                    let [east_m, up_m, south_m] = vertex.position_m.map(f64::from);
                    let at = DVec3::new(corner.x + east_m, up_m, corner.y + south_m);
                    // Heights below 2^10 m and offsets below 2^11 m in f32: half of 2^-12 m each.
                    assert!(at.cmpge(tile.low - 3e-4).all() && at.cmple(tile.high + 3e-4).all(), "{at}");
                }
                (buildings, things) = (buildings + tile.cuts.len(), things + tile.things.len());
            }
        }
        assert_eq!((buildings, things), (400, 2));
    }
}
