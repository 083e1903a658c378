//! What coefficients, thrusts and DAVE-ML files may depend on: quantities of the flight, after them the controls, then the
//! model's own signals.
//!
//! All stand in one array of [`SLOTS`] numbers, so that a term is a few indices and no name is looked up in flight.

/// Numbers that one evaluation works on.
pub const SLOTS: usize = 96;

/// Most controls of a model.
pub const MOST_CONTROLS: usize = 32;

/// Most signals of a model.
pub const MOST_SIGNALS: usize = 24;

/// A quantity of the flight; its number is its slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
#[allow(missing_docs)]
pub enum Quantity {
    AlphaRad,
    BetaRad,
    Mach,
    AltitudeM,
    PHat,
    QHat,
    RHat,
    TasMps,
    EasMps,
    PRadps,
    QRadps,
    RRadps,
    RollRad,
    PitchRad,
    YawRad,
    LatRad,
    LonRad,
    CrossTrackM,
    DensityKgpm3,
    DynamicPressurePa,
    AglM,
    AheadMps,
    RightMps,
    DownMps,
}

/// Number of [`Quantity`] slots; controls and signals follow.
pub const QUANTITIES: usize = 24;

/// Each quantity, its name in `M.toml`, and the names it has in AIAA S-119.
pub const ALL: [(Quantity, &str, &[&str]); QUANTITIES] = [
    (Quantity::AlphaRad, "alpha_rad", &["angleOfAttack"]),
    (Quantity::BetaRad, "beta_rad", &["angleOfSideslip"]),
    (Quantity::Mach, "mach", &["mach", "machNumber"]),
    (Quantity::AltitudeM, "altitude_m", &["altitudeMsl", "altitudeMSL"]),
    (Quantity::PHat, "p_hat", &[]),
    (Quantity::QHat, "q_hat", &[]),
    (Quantity::RHat, "r_hat", &[]),
    (Quantity::TasMps, "tas_mps", &["trueAirspeed"]),
    (Quantity::EasMps, "eas_mps", &["equivalentAirspeed"]),
    (Quantity::PRadps, "p_radps", &["bodyAngularRate_Roll"]),
    (Quantity::QRadps, "q_radps", &["bodyAngularRate_Pitch"]),
    (Quantity::RRadps, "r_radps", &["bodyAngularRate_Yaw"]),
    (Quantity::RollRad, "roll_rad", &["eulerAngle_Roll"]),
    (Quantity::PitchRad, "pitch_rad", &["eulerAngle_Pitch"]),
    (Quantity::YawRad, "yaw_rad", &["eulerAngle_Yaw"]),
    (Quantity::LatRad, "lat_rad", &["geLatitude"]),
    (Quantity::LonRad, "lon_rad", &["geLongitude"]),
    (Quantity::CrossTrackM, "cross_track_m", &["lateralDeviationError"]),
    (Quantity::DensityKgpm3, "density_kgpm3", &["airDensity"]),
    (Quantity::DynamicPressurePa, "dynamic_pressure_Pa", &["dynamicPressure"]),
    (Quantity::AglM, "agl_m", &[]),
    (Quantity::AheadMps, "ahead_mps", &[]),
    (Quantity::RightMps, "right_mps", &[]),
    (Quantity::DownMps, "down_mps", &[]),
];

impl Quantity {
    /// Its slot.
    pub const fn slot(self) -> usize {
        self as usize
    }

    /// The quantity of a name in `M.toml`.
    pub fn named(name: &str) -> Option<Self> {
        ALL.iter().find(|(_, own, _)| *own == name).map(|(quantity, ..)| *quantity)
    }

    /// The quantity of a name in AIAA S-119; small and capital letters count alike.
    pub fn in_s119(name: &str) -> Option<Self> {
        let is = |known: &&str| known.eq_ignore_ascii_case(name);
        ALL.iter().find(|(.., known)| known.iter().any(is)).map(|(quantity, ..)| *quantity)
    }
}

/// A unit that a control's name ends with, and how much of its SI unit it is.
const SUFFIXES: [(&str, f64); 14] = [
    ("_rad", 1.0),
    ("_deg", std::f64::consts::PI / 180.0),
    ("_norm", 1.0),
    ("_m", 1.0),
    ("_ft", 0.3048),
    ("_mps", 1.0),
    ("_kt", 1_852.0 / 3_600.0),
    ("_radps", 1.0),
    ("_degps", std::f64::consts::PI / 180.0),
    ("_N", 1.0),
    ("_kg", 1.0),
    ("_s", 1.0),
    ("_kgps", 1.0),
    ("_Nm", 1.0),
];

/// A name without its unit, and how much of the SI unit that unit is; `None` if it ends with no unit.
pub fn without_unit(name: &str) -> Option<(&str, f64)> {
    SUFFIXES
        .iter()
        .find_map(|&(suffix, si)| Some((name.strip_suffix(suffix)?, si)))
        .filter(|(stem, _)| !stem.is_empty())
}

/// The units that a name may end with, for errors.
pub fn unit_names() -> String {
    SUFFIXES.map(|(suffix, _)| suffix).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_stand_in_their_order() {
        for (slot, (quantity, name, s119)) in ALL.iter().enumerate() {
            assert_eq!(quantity.slot(), slot, "{name}");
            assert_eq!(Quantity::named(name), Some(*quantity));
            for known in *s119 {
                assert_eq!(Quantity::in_s119(&known.to_uppercase()), Some(*quantity));
            }
        }
        const { assert!(QUANTITIES + MOST_CONTROLS + MOST_SIGNALS < SLOTS) };
    }

    #[test]
    fn a_name_ends_with_its_unit() {
        assert_eq!(without_unit("elevator_rad"), Some(("elevator", 1.0)));
        assert_eq!(without_unit("altitudeMslCommand_ft"), Some(("altitudeMslCommand", 0.3048)));
        assert_eq!(without_unit("throttle"), None);
        assert_eq!(without_unit("_norm"), None);
    }
}
