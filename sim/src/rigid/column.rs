//! What is reported of a state: the columns of `O.csv`, in their order.
//!
//! Degrees where the name says so. `north_m`, `east_m` lie in the plane that touches the Earth under the start (a flat
//! frame's own axes); `agl_m` is empty over void. The quaternion is body to north, east, down, with `qw` not negative.
//! `p_degps` and its like are against the stars, `p_local_degps` against the turning local axes. Forces and moments are
//! those of air and engines, in body axes, about the centre of gravity; `nz_g` is the force upward over weight at
//! standard gravity.

use super::motion::{self, RigidMotion, State, angles_of};
use super::quantity::Quantity;
use crate::planet::{Place, STANDARD_GRAVITY_MPS2};
use glam::{DMat3, DQuat, DVec3};

/// Columns before the controls.
pub const COLUMNS: [&str; 42] = [
    "t_s",
    "lat_deg",
    "lon_deg",
    "altitude_m",
    "north_m",
    "east_m",
    "agl_m",
    "vn_mps",
    "ve_mps",
    "vd_mps",
    "u_mps",
    "v_mps",
    "w_mps",
    "qw",
    "qx",
    "qy",
    "qz",
    "roll_deg",
    "pitch_deg",
    "yaw_deg",
    "p_degps",
    "q_degps",
    "r_degps",
    "p_local_degps",
    "q_local_degps",
    "r_local_degps",
    "tas_mps",
    "eas_mps",
    "mach",
    "alpha_deg",
    "beta_deg",
    "density_kgpm3",
    "pressure_Pa",
    "temperature_K",
    "gravity_mps2",
    "fx_N",
    "fy_N",
    "fz_N",
    "mx_Nm",
    "my_Nm",
    "mz_Nm",
    "nz_g",
];

/// The place of `agl_m`.
pub const AGL: usize = 6;

/// Where `north_m` and `east_m` count from: a position, and the frame's axes of north, east, down there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Datum {
    origin_m: DVec3,
    frame_from_ned: DMat3,
}

impl Datum {
    /// The datum under a start: flat frames have their own.
    pub fn under(motion: &RigidMotion, start: DVec3) -> Self {
        if matches!(motion.planet.shape, crate::planet::Shape::Flat { .. }) {
            return Self { origin_m: DVec3::ZERO, frame_from_ned: DMat3::IDENTITY };
        }
        let place = Place { altitude_m: 0.0, ..motion.planet.place(start) };
        Self { origin_m: motion.planet.position_m(place), frame_from_ned: motion.planet.frame_from_ned(place) }
    }
}

/// The place of a column's name; controls stand behind [`COLUMNS`].
pub fn place_of(motion: &RigidMotion, name: &str) -> Option<usize> {
    let own = COLUMNS.iter().position(|column| *column == name);
    own.or_else(|| motion.model.control(name).map(|control| COLUMNS.len() + control))
}

/// All numbers of a state, in the order of [`COLUMNS`] and of the controls.
///
/// `place` is the state's, and `ground_m` the ground's height under it, where there is any.
pub fn row(motion: &RigidMotion, datum: &Datum, t_s: f64, y: &State, place: Place, ground_m: Option<f64>) -> Vec<f64> {
    let sample = motion.sample(y, true);
    let position = motion::position(y);
    let frame_from_ned = motion.planet.frame_from_ned(motion.planet.place(position));
    let ned_from_body = frame_from_ned.transpose() * sample.frame_from_body;
    let ned = frame_from_ned.transpose() * motion::velocity(y);
    let body = sample.frame_from_body.transpose() * motion::velocity(y);
    let quaternion = DQuat::from_mat3(&ned_from_body).normalize();
    let quaternion = if quaternion.w < 0.0 { -quaternion } else { quaternion };
    let [roll, pitch, yaw] = angles_of(&ned_from_body).map(f64::to_degrees);
    let rates = motion::rates(y);
    let transport = motion.planet.transport_radps(motion.planet.place(position), ned);
    let local = sample.earth_rates - ned_from_body.transpose() * transport;
    let offset = datum.frame_from_ned.transpose() * (position - datum.origin_m);
    let slot = |quantity: Quantity| sample.slots[quantity.slot()];
    let (force, moment) = (sample.loads.force_n, sample.loads.moment_nm);
    let [p, q, r] = rates.to_array().map(f64::to_degrees);
    let [pl, ql, rl] = local.to_array().map(f64::to_degrees);
    let mut values = vec![
        t_s,
        place.lat_rad.to_degrees(),
        place.lon_rad.to_degrees(),
        place.altitude_m,
        offset.x,
        offset.y,
        ground_m.map_or(f64::NAN, |ground| place.altitude_m - ground),
        ned.x,
        ned.y,
        ned.z,
        body.x,
        body.y,
        body.z,
        quaternion.w,
        quaternion.x,
        quaternion.y,
        quaternion.z,
        roll,
        pitch,
        yaw,
        p,
        q,
        r,
        pl,
        ql,
        rl,
        slot(Quantity::TasMps),
        slot(Quantity::EasMps),
        slot(Quantity::Mach),
        slot(Quantity::AlphaRad).to_degrees(),
        slot(Quantity::BetaRad).to_degrees(),
        sample.air.density_kgpm3,
        sample.air.pressure_pa,
        sample.air.temperature_k,
        motion.planet.gravity_mps2(position),
        force.x,
        force.y,
        force.z,
        moment.x,
        moment.y,
        moment.z,
        -force.z / (motion.model.mass_kg * STANDARD_GRAVITY_MPS2),
    ];
    values.extend_from_slice(&motion.controls);
    values
}
