//! Plots: what is drawn on a sheet, as SVG or as a picture.
//!
//! | file | what |
//! |---|---|
//! | `drawing.rs` | lines, dots and texts on a sheet, and its two forms |
//! | `axis.rs` | from values to places, with round marks |
//! | `chart.rs` | curves over a common quantity, and sheets of them |

pub mod axis;
pub mod chart;
pub mod drawing;
