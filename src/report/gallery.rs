//! What `gallery` reports.

use super::Shot;
use serde::Serialize;

/// `gallery`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Gallery {
    /// Each picture.
    pub pictures: Vec<Shot>,
    /// All of them on one sheet.
    pub contact_sheet: String,
}
