//! What `trade` reports: settings with their errors and costs.

use serde::Serialize;

/// `trade`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Trade {
    /// Every setting that trades accuracy for cost.
    pub knobs: Vec<Knob>,
    /// How it was measured.
    pub conditions: String,
}

/// One setting, measured.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Knob {
    /// Its name.
    pub name: String,
    /// Unit of the setting.
    pub unit: String,
    /// Unit of `error`, and what it is the error against.
    pub error_unit: String,
    /// Unit of `cost`.
    pub cost_unit: String,
    /// From coarsest to finest.
    pub points: Vec<KnobPoint>,
    /// The plot that it shares with other knobs, as one curve of several.
    pub group: Option<String>,
    /// The setting with the least error, where finer is not always better.
    pub best: Option<f64>,
}

/// One value of a setting.
#[derive(Debug, Clone, Default, Serialize)]
pub struct KnobPoint {
    /// The value.
    pub setting: f64,
    /// How wrong the picture or the ground is.
    pub error: f64,
    /// What it costs.
    pub cost: f64,
    /// Triangles of a frame, where the knob changes them.
    pub triangles: Option<u64>,
    /// Bytes held, where the knob changes them.
    pub bytes: Option<u64>,
    /// The largest error, in the unit of `error`.
    pub error_max: Option<f64>,
    /// Root mean square difference of the picture from the reference's, grey of 255.
    pub image_rms_grey: Option<f64>,
    /// Time to make the world anew, where the knob needs it.
    pub bake_s: Option<f64>,
    /// The value in words, where `setting` is only its place in a row of models.
    pub label: Option<String>,
    /// The part of `error` that is height.
    pub error_height: Option<f64>,
    /// The part of `error` that is not.
    pub error_horizontal: Option<f64>,
}
