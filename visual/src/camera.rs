//! One view: where an eye is, how it is turned, and the frustum it sees through.
//!
//! View axes: x right, y up, z backward; the attitude turns them into the world's. The projection is reversed-Z with
//! an infinite far plane: `depth = near / distance along the axis`, 1 at the near plane and 0 at infinity, cleared to
//! 0 and compared with `Greater`. Matrices are formed in f64 about the eye and only then rounded to f32, so no world
//! coordinate ever reaches a shader in single precision.
//!
//! Source of the depth: its step is at most 1.2e-7 of the distance at every distance.

use glam::{DQuat, DVec3, Mat4, Vec3};

/// Depth format of every scene pass.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Depth test of everything solid: nearer is larger.
pub const DEPTH_COMPARE: wgpu::CompareFunction = wgpu::CompareFunction::Greater;
/// What depth is cleared to: infinitely far.
pub const DEPTH_CLEAR: f32 = 0.0;

/// An eye and its frustum; may be asymmetric, as for one screen of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The eye in the world, metres.
    pub eye_m: DVec3,
    /// Turns view axes (x right, y up, z backward) into the world's.
    pub attitude: DQuat,
    /// Tangent of the angle to the left edge; negative left of the axis.
    pub left: f64,
    /// Tangent of the angle to the right edge.
    pub right: f64,
    /// Tangent of the angle to the bottom edge; negative below the axis.
    pub bottom: f64,
    /// Tangent of the angle to the top edge.
    pub top: f64,
    /// Distance of the near plane, metres (0.1 to 1 is sensible).
    pub near_m: f64,
    /// Size of the picture, pixels.
    pub size_px: [u32; 2],
}

impl View {
    /// A symmetric view with square pixels and the given full vertical angle, radians; near plane at 0.5 m.
    pub fn fov_y(eye_m: DVec3, attitude: DQuat, fov_y_rad: f64, size_px: [u32; 2]) -> Self {
        let top = (fov_y_rad.clamp(1e-3, 3.1) * 0.5).tan();
        let right = top * f64::from(size_px[0].max(1)) / f64::from(size_px[1].max(1));
        Self { eye_m, attitude, left: -right, right, bottom: -top, top, near_m: 0.5, size_px }
    }

    /// Pixels per unit of tangent, vertically: an object of `s` metres at `d` metres on the axis is `s / d` of it.
    pub fn focal_px(&self) -> f64 {
        f64::from(self.size_px[1]) / (self.top - self.bottom)
    }

    /// Clip from a world position *relative to the eye* (subtract in f64 first).
    pub fn clip_from_relative(&self) -> Mat4 {
        // Rows of the projection in view axes; depth = near / distance, so clip z is the near distance itself.
        let (width, height) = (self.right - self.left, self.top - self.bottom);
        let projection = glam::DMat4::from_cols_array(&[
            2.0 / width,
            0.0,
            0.0,
            0.0,
            0.0,
            2.0 / height,
            0.0,
            0.0,
            (self.right + self.left) / width,
            (self.top + self.bottom) / height,
            0.0,
            -1.0,
            0.0,
            0.0,
            self.near_m,
            0.0,
        ]);
        (projection * glam::DMat4::from_quat(self.attitude.normalize().inverse())).as_mat4()
    }

    /// Direction through a point of the picture in world axes, not normalised: one unit along the axis.
    ///
    /// `x`, `y` run from 0 to 1 from the top left corner.
    pub fn ray(&self, x: f64, y: f64) -> DVec3 {
        let right = self.left + (self.right - self.left) * x;
        let up = self.top + (self.bottom - self.top) * y;
        self.attitude * DVec3::new(right, up, -1.0)
    }

    /// The planes that bound what is seen, for boxes relative to the eye.
    pub fn frustum(&self) -> Frustum {
        let plane = |view_axes: DVec3, offset_m: f64| {
            let length = view_axes.length();
            Plane { normal: (self.attitude * (view_axes / length)).as_vec3(), offset_m: (offset_m / length) as f32 }
        };
        Frustum {
            planes: [
                plane(DVec3::new(1.0, 0.0, self.left), 0.0),
                plane(DVec3::new(-1.0, 0.0, -self.right), 0.0),
                plane(DVec3::new(0.0, 1.0, self.bottom), 0.0),
                plane(DVec3::new(0.0, -1.0, -self.top), 0.0),
                plane(DVec3::new(0.0, 0.0, -1.0), -self.near_m),
            ],
        }
    }

    /// Whether every number is usable: finite, edges in order, near plane ahead, turn not zero.
    pub fn is_sane(&self) -> bool {
        self.eye_m.is_finite()
            && self.attitude.is_finite()
            && self.attitude.length_squared() > 1e-12
            && [self.left, self.right, self.bottom, self.top].iter().all(|edge| edge.is_finite())
            && self.left < self.right
            && self.bottom < self.top
            && self.near_m.is_finite()
            && self.near_m > 0.0
    }
}

/// A half space: points with `normal . p + offset_m >= 0` are inside.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Unit vector pointing inside.
    pub normal: Vec3,
    /// Metres.
    pub offset_m: f32,
}

/// Left, right, bottom, top and near; there is no far plane. Positions are relative to the eye, world axes.
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    /// The five planes in that order.
    pub planes: [Plane; 5],
}

impl Frustum {
    /// False only where the box lies wholly outside one plane, so a box that is seen is never refused.
    ///
    /// `low_m`, `high_m`: corners relative to the eye, world axes.
    pub fn may_see_box(&self, low_m: Vec3, high_m: Vec3) -> bool {
        self.planes.iter().all(|plane| {
            // The corner farthest along the normal decides.
            let corner = Vec3::select(plane.normal.cmpge(Vec3::ZERO), high_m, low_m);
            plane.normal.dot(corner) + plane.offset_m >= 0.0
        })
    }

    /// True only where the whole box lies inside every plane.
    pub fn holds_box(&self, low_m: Vec3, high_m: Vec3) -> bool {
        self.planes.iter().all(|plane| {
            let corner = Vec3::select(plane.normal.cmpge(Vec3::ZERO), low_m, high_m);
            plane.normal.dot(corner) + plane.offset_m >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::frame::attitude;

    fn view() -> View {
        let mut view = View::fov_y(DVec3::new(1e5, 3e3, -2e5), attitude(0.7, -0.3, 0.4), 1.0, [1280, 720]);
        view.left *= 0.3;
        view.top *= 1.4;
        view
    }

    #[test]
    fn a_ray_lands_on_its_pixel_and_depth_is_near_over_distance() {
        let view = view();
        let clip_from_relative = view.clip_from_relative();
        for (x, y) in [(0.0, 0.0), (1.0, 1.0), (0.25, 0.8), (0.5, 0.5)] {
            for distance_m in [1.0, 100.0, 72_000.0] {
                let clip = clip_from_relative * (view.ray(x, y) * distance_m).as_vec3().extend(1.0);
                // Six f32 roundings of numbers about 1.
                let tolerance = 6.0 * f32::EPSILON * 4.0;
                assert!((clip.x / clip.w - (2.0 * x - 1.0) as f32).abs() < tolerance, "{x} {y} {distance_m}");
                assert!((clip.y / clip.w - (1.0 - 2.0 * y) as f32).abs() < tolerance, "{x} {y} {distance_m}");
                let depth = (view.near_m / distance_m) as f32;
                assert!((clip.z / clip.w - depth).abs() <= depth * tolerance, "{x} {y} {distance_m}");
            }
        }
    }

    #[test]
    fn boxes_are_kept_exactly_where_a_corner_projects_inside_or_planes_cannot_tell() {
        let view = view();
        let frustum = view.frustum();
        // A tiny box at a point: kept if and only if the point is inside the picture and beyond the near plane.
        for step in 0..4000 {
            let at = |n: i32, of: i32| f64::from(step * n % of) / f64::from(of) * 1.6 - 0.3;
            let (x, y) = (at(37, 101), at(53, 97));
            let inside = (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y);
            let edge = [x, y, 1.0 - x, 1.0 - y].iter().any(|d| d.abs() < 1e-3);
            let point = (view.ray(x, y) * 500.0).as_vec3();
            if !edge {
                assert_eq!(frustum.may_see_box(point - 1e-3, point + 1e-3), inside, "{x} {y}");
                assert_eq!(frustum.holds_box(point - 1e-3, point + 1e-3), inside, "{x} {y}");
            }
            assert!(!frustum.may_see_box(-point - 1e-3, -point + 1e-3), "behind: {x} {y}");
        }
        assert!(frustum.may_see_box(Vec3::splat(-1e4), Vec3::splat(1e4)), "the box around the eye");
        assert!(!frustum.holds_box(Vec3::splat(-1e4), Vec3::splat(1e4)), "the box around the eye");
    }
}
