//! How a target stands: its pose from a place in plan, the way it faces and the ground under it.
//!
//! World frame, metres; the shape's has forward -Z, up +Y. The rules are those of [`crate::weapons::target_kind`]. On
//! wheels the pose is the fixed point of "the plane through the ground under the three points of contact": over one
//! triangle it is found at the second look, across an edge within a few.
//!
//! Invariant others rely on: on wheels the three points of contact are within [`CONTACT_M`] of the ground, measured
//! straight up, wherever there is ground under all of them and no cliff between.

use super::codec::{Coded, Reader, SaveError};
use super::ground::SceneGround;
use crate::ballistics::targets::Pose;
use crate::weapons::target_kind::{Stand, StandOn};
use glam::{DMat3, DQuat, DVec2, DVec3};

/// How far a point of contact may be off the ground, metres.
pub const CONTACT_M: f64 = 1e-6;
/// Most looks at the ground. Each moves the contacts by the change of tilt times their arm's height over the ground; where
/// that does not settle (over a cliff) the last pose is kept.
const MOST_LOOKS: u32 = 48;

/// Level, facing a unit direction in plan (x, z).
pub(super) fn upright(facing: DVec2) -> DQuat {
    DQuat::from_rotation_y((-facing.x).atan2(-facing.y))
}

/// The unit direction in plan that an attitude faces; north where it faces straight up or down.
pub(super) fn facing(attitude: DQuat) -> DVec2 {
    let forward = attitude * DVec3::NEG_Z;
    DVec2::new(forward.x, forward.z).try_normalize().unwrap_or(DVec2::NEG_Y)
}

/// With its up along a unit normal that points up, facing a unit direction in plan.
fn tilted(up: DVec3, facing: DVec2) -> DMat3 {
    let forward = DVec3::new(facing.x, -(up.x * facing.x + up.z * facing.y) / up.y, facing.y).normalize();
    DMat3::from_cols(forward.cross(up), up, -forward)
}

/// Level at an altitude of the plane on which it stands.
pub(super) fn level(stand: &Stand, pose: &Pose, altitude_m: f64) -> Pose {
    let position_m = DVec3 { y: altitude_m + stand.below_m, ..pose.position_m };
    Pose { position_m, attitude: upright(facing(pose.attitude)) }
}

/// On the ground, or so far straight above it; `None` where there is none under it.
pub(super) fn on_ground(stand: &Stand, pose: &Pose, ground: &SceneGround, over_m: f64) -> Option<Pose> {
    let plan = DVec2::new(pose.position_m.x, pose.position_m.z);
    let facing = facing(pose.attitude);
    match stand.on {
        StandOn::Wheels => on_wheels(stand, plan, facing, ground, over_m),
        StandOn::Upright | StandOn::Water => {
            let (ahead, right) = (facing, facing.perp());
            let corner = |along: f64, aside: f64| {
                let at = plan + ahead * along + right * aside;
                ground.height_m(at.x, at.y)
            };
            let w = stand.half_width_m;
            let corners = [
                corner(stand.front_m, w),
                corner(stand.front_m, -w),
                corner(-stand.rear_m, w),
                corner(-stand.rear_m, -w),
            ];
            let lowest = corners.into_iter().flatten().reduce(f64::min)?;
            Some(level(stand, pose, lowest + over_m))
        }
    }
}

fn on_wheels(stand: &Stand, plan: DVec2, facing: DVec2, ground: &SceneGround, over_m: f64) -> Option<Pose> {
    // From the middle of the plane of contact, its axes.
    let arms = [
        DVec3::new(0.0, 0.0, -stand.front_m),
        DVec3::new(stand.half_width_m, 0.0, stand.rear_m),
        DVec3::new(-stand.half_width_m, 0.0, stand.rear_m),
    ];
    let mut foot = DVec3::new(plan.x, ground.height_m(plan.x, plan.y)?, plan.y);
    let mut axes = tilted(DVec3::Y, facing);
    for _ in 0..MOST_LOOKS {
        // The reference point is over `plan`: a tilt moves the foot aside.
        let up = axes.y_axis;
        (foot.x, foot.z) = (plan.x - up.x * stand.below_m, plan.y - up.z * stand.below_m);
        let touch = arms.map(|arm| {
            let at = foot + axes * arm;
            (at, ground.height_m(at.x, at.z))
        });
        let [Some(a), Some(b), Some(c)] = touch.map(|(at, height)| height.map(|y| DVec3 { y, ..at })) else {
            break;
        };
        if touch.iter().all(|(at, height)| height.is_some_and(|height| (at.y - height).abs() <= 0.5 * CONTACT_M)) {
            break;
        }
        let across = (b - a).cross(c - a);
        let Some(up) = (if across.y < 0.0 { -across } else { across }).try_normalize() else { break };
        if up.y < 1e-3 {
            break;
        }
        axes = tilted(up, facing);
        // The plane's height over the new foot.
        (foot.x, foot.z) = (plan.x - up.x * stand.below_m, plan.y - up.z * stand.below_m);
        foot.y = a.y - (up.x * (foot.x - a.x) + up.z * (foot.z - a.z)) / up.y;
    }
    let position_m = foot + axes.y_axis * stand.below_m + DVec3::Y * over_m;
    Some(Pose { position_m, attitude: DQuat::from_mat3(&axes).normalize() })
}

impl Coded for Stand {
    fn put(&self, out: &mut Vec<u8>) {
        out.push(self.on as u8);
        [self.front_m, self.rear_m, self.half_width_m, self.below_m].put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let on = match from.take::<u8>()? {
            0 => StandOn::Wheels,
            1 => StandOn::Upright,
            2 => StandOn::Water,
            found => return Err(from.refuse(format_args!("stand: expected 0..=2, found {found}"))),
        };
        let all: [f64; 4] = from.take()?;
        if all.iter().any(|metres| metres.abs() > 1_000.0) {
            return Err(from.refuse("stand: expected metres within 1000"));
        }
        let [front_m, rear_m, half_width_m, below_m] = all;
        Ok(Self { on, front_m, rear_m, half_width_m, below_m })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use std::sync::Arc;
    use terrain::{Grid, Ground, synthetic};

    const SEED_PLACES: u64 = 20_261_201;
    const TANK: Stand = Stand { on: StandOn::Wheels, front_m: 2.1, rear_m: 2.1, half_width_m: 1.4, below_m: 1.1 };

    fn contacts(stand: &Stand, pose: &Pose) -> [DVec3; 3] {
        let arms = [(0.0, -stand.front_m), (stand.half_width_m, stand.rear_m), (-stand.half_width_m, stand.rear_m)];
        arms.map(|(x, z)| pose.position_m + pose.attitude * DVec3::new(x, -stand.below_m, z))
    }

    #[test]
    fn three_contacts_lie_on_rough_ground_also_across_its_edges() {
        let grid = Grid::centred(25.0, 4, 4).unwrap();
        // Steps of up to 15 m in 25 m: slopes of 30 degrees and more, an edge under every fourth vehicle or so.
        let ground = SceneGround::from(Ground::new(Arc::new(synthetic::rough(grid, 7, 15.0))).whole());
        let mut random = StdRng::seed_from_u64(SEED_PLACES);
        let mut farthest_m = 0f64;
        for _ in 0..5_000 {
            let at = DVec3::new(random.random_range(-1_400.0..1_400.0), 0.0, random.random_range(-1_400.0..1_400.0));
            let attitude = DQuat::from_rotation_y(random.random_range(-3.2..3.2));
            let pose = on_ground(&TANK, &Pose { position_m: at, attitude }, &ground, 0.0).unwrap();
            assert!((pose.position_m.x - at.x).abs() < 1e-9 && (pose.position_m.z - at.z).abs() < 1e-9);
            assert!(facing(pose.attitude).distance(facing(attitude)) < 1e-9);
            for at in contacts(&TANK, &pose) {
                farthest_m = farthest_m.max((at.y - ground.height_m(at.x, at.z).unwrap()).abs());
            }
        }
        assert!(farthest_m <= CONTACT_M, "{farthest_m} m");
    }

    #[test]
    fn on_a_slope_of_45_degrees_it_lies_flat_and_upright_things_do_not_tilt() {
        let ground = SceneGround::heights(|x_m, _| Some(x_m));
        let pose = Pose { position_m: DVec3::new(3.0, 0.0, 4.0), attitude: upright(DVec2::new(0.6, 0.8)) };
        let stood = on_ground(&TANK, &pose, &ground, 0.0).unwrap();
        let normal = DVec3::new(-1.0, 1.0, 0.0).normalize();
        // Roundings of a few steps of coordinates below 8 m.
        assert!((stood.attitude * DVec3::Y).distance(normal) < 1e-12);
        assert!(contacts(&TANK, &stood).iter().all(|at| (at.y - at.x).abs() < 1e-12));
        let house = Stand { on: StandOn::Upright, ..TANK };
        let stood = on_ground(&house, &pose, &ground, 5.0).unwrap();
        assert!((stood.attitude * DVec3::Y).distance(DVec3::Y) < 1e-15);
        // The lowest corner: 3 - (2.1 * 0.6 + 1.4 * 0.8).
        assert!((stood.position_m.y - (3.0 - 2.38 + 1.1 + 5.0)).abs() < 1e-12, "{}", stood.position_m.y);
        assert_eq!(on_ground(&TANK, &pose, &SceneGround::void(), 0.0), None);
    }
}
