//! GeoJSON (RFC 7946): geometries in longitude and latitude, properties as tags.
//!
//! Keys are those of OpenStreetMap, Natural Earth's `featurecla` or Geofabrik's `fclass`. A polygon that has no property
//! but a name, a number, a region and `level_m` is a lake.

use super::MAX_POINTS;
use super::raw::{Element, Polygon, RawFeature, Shape, Tags, is_place, ring_of, says_what};
use super::schemes::{geofabrik, natural_earth};
use crate::bake::raster::Unreadable;
use geojson::{GeoJson, GeometryValue, JsonValue, Position};
use glam::DVec2;

/// Reads a file.
///
/// # Errors
/// [`Unreadable`] if it is not GeoJSON, a point is no place on Earth, or a level no height.
pub fn read(text: &str) -> Result<Vec<RawFeature>, Unreadable> {
    let features = match text.parse::<GeoJson>() {
        Ok(GeoJson::FeatureCollection(collection)) => collection.features,
        Ok(GeoJson::Feature(feature)) => vec![feature],
        Ok(GeoJson::Geometry(_)) => return Err(Unreadable::new("features", "a bare geometry")),
        Err(error) => return Err(Unreadable::new("GeoJSON", error.to_string())),
    };
    let mut points = 0;
    let mut read = Vec::with_capacity(features.len());
    for feature in features {
        let mut tags = tags(feature.properties.as_ref())?;
        let shape = match feature.geometry {
            Some(geometry) => shape(&geometry.value, &mut points)?,
            None => Shape::Broken("no geometry"),
        };
        let element = if matches!(shape, Shape::Point(_)) { Element::Node } else { Element::Way };
        geofabrik(&mut tags, matches!(shape, Shape::Polygon(_)));
        let mut raw = RawFeature::new(tags, element, shape);
        let said = |(key, value): (&String, &JsonValue)| says_what(key) && !value.is_null();
        raw.lake_by_default = !feature.properties.iter().flatten().any(said);
        read.push(raw);
    }
    Ok(read)
}

fn tags(properties: Option<&geojson::JsonObject>) -> Result<Tags, Unreadable> {
    let mut tags = Tags::default();
    for (key, value) in properties.into_iter().flatten() {
        let text = match value {
            JsonValue::String(text) => text.clone(),
            JsonValue::Number(number) => number.to_string(),
            JsonValue::Bool(yes) => if *yes { "yes" } else { "no" }.to_owned(),
            _ => continue,
        };
        if key == "level_m" && !matches!(value, JsonValue::Number(_)) {
            return Err(Unreadable::new("a height in level_m", value.to_string()));
        }
        tags.push(key, &text);
        natural_earth(&mut tags, key, &text);
    }
    Ok(tags)
}

fn shape(value: &GeometryValue, points: &mut usize) -> Result<Shape, Unreadable> {
    let mut line = |positions: &[Position]| line(positions, points);
    Ok(match value {
        GeometryValue::Point { coordinates } => Shape::Point(place(coordinates)?),
        GeometryValue::LineString { coordinates } => lines(vec![line(coordinates)?]),
        GeometryValue::MultiLineString { coordinates } => {
            lines(coordinates.iter().map(|c| line(c)).collect::<Result<_, _>>()?)
        }
        GeometryValue::Polygon { coordinates } => {
            polygon(vec![coordinates.iter().map(|c| line(c)).collect::<Result<_, _>>()?])
        }
        GeometryValue::MultiPolygon { coordinates } => polygon(
            coordinates
                .iter()
                .map(|rings| rings.iter().map(|c| line(c)).collect::<Result<_, _>>())
                .collect::<Result<_, _>>()?,
        ),
        _ => Shape::Broken("several points or a mixture of geometries"),
    })
}

fn line(positions: &[Position], points: &mut usize) -> Result<Vec<DVec2>, Unreadable> {
    *points += positions.len();
    if *points > MAX_POINTS {
        return Err(Unreadable::new(format!("at most {MAX_POINTS} points"), "more"));
    }
    positions.iter().map(place).collect()
}

fn place(position: &Position) -> Result<DVec2, Unreadable> {
    match position.as_slice() {
        [lon, lat, ..] if is_place(DVec2::new(*lon, *lat)) => Ok(DVec2::new(*lon, *lat)),
        other => Err(Unreadable::new("longitude and latitude in degrees", format!("{other:?}"))),
    }
}

fn lines(mut lines: Vec<Vec<DVec2>>) -> Shape {
    lines.retain(|line| line.len() >= 2);
    if lines.is_empty() { Shape::Broken("fewer than two points") } else { Shape::Lines(lines) }
}

/// Of each polygon the first ring is the outline.
fn polygon(polygons: Vec<Vec<Vec<DVec2>>>) -> Shape {
    let mut all = Polygon::default();
    for rings in polygons {
        for (number, ring) in rings.into_iter().enumerate() {
            let ring = ring_of(&ring).unwrap_or(ring);
            if ring.len() >= 3 {
                if number == 0 { &mut all.outers } else { &mut all.inners }.push(ring);
            }
        }
    }
    if all.outers.is_empty() { Shape::Broken("no outline of three points") } else { Shape::Polygon(all) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn properties_are_tags_and_what_is_wrong_is_said() {
        let polygon = |properties: &str, lon: &str| {
            format!(
                r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"Polygon","coordinates":
                [[[{lon},42.0],[78.05,42.0],[78.05,42.05],[{lon},42.0]]]}}}}"#
            )
        };
        let lake = &read(&polygon(r#"{"name":"A","level_m":12.5,"x":[1]}"#, "78.0")).unwrap()[0];
        assert_eq!((lake.tags.get("name"), lake.tags.get("level_m")), (Some("A"), Some("12.5")));
        let Shape::Polygon(shape) = &lake.shape else { panic!("{lake:?}") };
        assert_eq!(shape.outers[0].len(), 3);
        for bad in ["", "{}", "[1]", &polygon(r#"{"level_m":"x"}"#, "78.0"), &polygon("{}", "1e9")] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
