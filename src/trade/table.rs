//! All knobs as one CSV table: a line a value, a header first, decimal points, empty where there is no figure.

use crate::report::Trade;
use std::fmt::Write as _;

/// The table.
pub fn csv(trade: &Trade) -> String {
    let mut text = String::from(
        "knob,unit,setting,error,error_unit,error_max,image_rms_grey,cost,cost_unit,triangles,bytes,bake_s,label,error_height,error_horizontal\n",
    );
    let optional = |value: Option<f64>| value.filter(|v| v.is_finite()).map_or(String::new(), |v| v.to_string());
    let whole = |value: Option<u64>| value.map_or(String::new(), |v| v.to_string());
    for knob in &trade.knobs {
        for point in &knob.points {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
                quoted(&knob.name),
                quoted(&knob.unit),
                point.setting,
                optional(Some(point.error)),
                quoted(&knob.error_unit),
                optional(point.error_max),
                optional(point.image_rms_grey),
                optional(Some(point.cost)),
                quoted(&knob.cost_unit),
                whole(point.triangles),
                whole(point.bytes),
                optional(point.bake_s),
                quoted(point.label.as_deref().unwrap_or("")),
                optional(point.error_height),
                optional(point.error_horizontal),
            );
        }
    }
    text
}

/// RFC 4180: in quotes where there is a comma or a quote.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Knob, KnobPoint};

    #[test]
    fn every_line_has_as_many_fields_as_the_header() {
        let points = vec![KnobPoint { setting: 0.25, error: f64::NAN, cost: 1.5, ..KnobPoint::default() }];
        let knob = Knob { name: "a".into(), error_unit: "m, \"rms\"".into(), points, ..Knob::default() };
        let text = csv(&Trade { knobs: vec![knob], ..Trade::default() });
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1], "a,,0.25,,\"m, \"\"rms\"\"\",,,1.5,,,,,,,");
        // One comma is within quotes.
        assert_eq!(lines[0].matches(',').count(), lines[1].matches(',').count() - 1);
    }
}
