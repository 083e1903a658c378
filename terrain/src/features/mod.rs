//! What lies on the ground.
use glam::DVec2;
/// Stub until the merge.
#[derive(Debug, Default)]
pub struct Lakes;
impl Lakes {
    /// Stub.
    pub fn near(&self, _: DVec2, _: DVec2, _: f64) -> Lakes {
        Lakes
    }
    /// Stub.
    pub fn signed_distance_m(&self, _: DVec2) -> f64 {
        f64::INFINITY
    }
}
