//! ESRI shapefiles: `.shp`, with the attributes of the `.dbf` beside it as tags if there is one.
//!
//! Longitude and latitude are expected; a `.prj` beside it that says `PROJCS` is refused. Attributes are named as the
//! keys of OpenStreetMap (DBF names end after ten letters) or as Natural Earth and Geofabrik do. Polygons that say
//! nothing but a name, a number or a level are lakes. A row that is marked as deleted still belongs to its shape.

use super::MAX_POINTS;
use super::raw::{Element, Polygon, RawFeature, Shape, Tags, is_place, ring_of, says_what};
use super::schemes::{geofabrik, natural_earth};
use crate::bake::raster::Unreadable;
use glam::DVec2;
use shapefile::PolygonRing;
use shapefile::dbase::{self, FieldValue};
use shapefile::record::traits::HasXY;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Whether bytes begin as a `.shp` does.
pub fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0, 0, 0x27, 0x0a])
}

/// Reads a `.shp` with the bytes of its `.dbf` and the text of its `.prj`, where they are there.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn read(shp: &[u8], dbf: Option<&[u8]>, prj: Option<&str>) -> Result<Vec<RawFeature>, Unreadable> {
    if prj.is_some_and(|prj| prj.trim_start().starts_with("PROJCS")) {
        return Err(Unreadable::new("longitude and latitude in the .prj", "PROJCS, a map"));
    }
    // The crates that read these add and index without a check in places; damaged bytes are an error here all the same.
    let reading = || {
        let rows = dbf.map(attributes).transpose()?;
        shapes(shp, rows)
    };
    catch_unwind(AssertUnwindSafe(reading))
        .unwrap_or_else(|_| Err(Unreadable::new("an undamaged shapefile", "numbers out of range")))
}

/// A row of a table: its tags, and whether a column may say what the shape is.
type Row = (Tags, bool);

/// A table whose rows all count: the crate `dbase` leaves out those marked as deleted, and all after one would be another
/// shape's.
fn undeleted(dbf: &[u8]) -> Vec<u8> {
    let mut dbf = dbf.to_vec();
    let length = |at: usize| dbf.get(at..at + 2).map_or(0, |two| usize::from(u16::from_le_bytes([two[0], two[1]])));
    let (head, row) = (length(8), length(10));
    if row > 0
        && let Some(rows) = dbf.get_mut(head..)
    {
        rows.iter_mut().step_by(row).filter(|mark| **mark == b'*').for_each(|mark| *mark = b' ');
    }
    dbf
}

fn attributes(dbf: &[u8]) -> Result<Vec<Row>, Unreadable> {
    let damaged = |e: dbase::Error| Unreadable::new("an undamaged .dbf", e.to_string());
    let mut reader = dbase::Reader::new(Cursor::new(undeleted(dbf))).map_err(damaged)?;
    let mut rows = Vec::new();
    // A row takes at least a byte, whatever the head says.
    for row in reader.iter_records().take(dbf.len()) {
        let (mut tags, mut said) = (Tags::default(), false);
        for (name, value) in row.map_err(damaged)? {
            let text = match value {
                FieldValue::Character(Some(text)) => text,
                FieldValue::Numeric(Some(number)) => number.to_string(),
                FieldValue::Float(Some(number)) => number.to_string(),
                FieldValue::Integer(number) => number.to_string(),
                FieldValue::Double(number) => number.to_string(),
                FieldValue::Logical(Some(yes)) => if yes { "yes" } else { "no" }.to_owned(),
                _ => continue,
            };
            let name = name.to_ascii_lowercase();
            let text = text.trim();
            if !text.is_empty() {
                said |= says_what(&name);
                tags.push(if name == "building:l" { "building:levels" } else { &name }, text);
                natural_earth(&mut tags, &name, text);
            }
        }
        rows.push((tags, said));
    }
    Ok(rows)
}

fn shapes(shp: &[u8], rows: Option<Vec<Row>>) -> Result<Vec<RawFeature>, Unreadable> {
    let damaged = |e: shapefile::Error| Unreadable::new("an undamaged .shp", e.to_string());
    let mut reader = shapefile::ShapeReader::new(Cursor::new(shp)).map_err(damaged)?;
    let (table, number) = (rows.is_some(), rows.as_ref().map_or(0, Vec::len));
    let mut rows = rows.into_iter().flatten();
    let mut points = 0;
    let mut read = Vec::new();
    for shape in reader.iter_shapes() {
        let shape = match shape.map_err(damaged)? {
            shapefile::Shape::Point(point) => Shape::Point(place(&point)?),
            shapefile::Shape::PointM(point) => Shape::Point(place(&point)?),
            shapefile::Shape::PointZ(point) => Shape::Point(place(&point)?),
            shapefile::Shape::Polyline(lines) => self::lines(lines.parts(), &mut points)?,
            shapefile::Shape::PolylineM(lines) => self::lines(lines.parts(), &mut points)?,
            shapefile::Shape::PolylineZ(lines) => self::lines(lines.parts(), &mut points)?,
            shapefile::Shape::Polygon(polygon) => rings(polygon.rings(), &mut points)?,
            shapefile::Shape::PolygonM(polygon) => rings(polygon.rings(), &mut points)?,
            shapefile::Shape::PolygonZ(polygon) => rings(polygon.rings(), &mut points)?,
            shapefile::Shape::NullShape => Shape::Broken("no geometry"),
            _ => Shape::Broken("several points or a mesh"),
        };
        let element = if matches!(shape, Shape::Point(_)) { Element::Node } else { Element::Way };
        let (mut tags, said) = rows.next().unwrap_or_default();
        geofabrik(&mut tags, matches!(shape, Shape::Polygon(_)));
        let mut raw = RawFeature::new(tags, element, shape);
        raw.lake_by_default = !said;
        raw.note = (!table).then_some("read without a .dbf");
        read.push(raw);
    }
    if table && number != read.len() {
        return Err(Unreadable::new(
            format!("{} rows in the .dbf, one for each shape", read.len()),
            number.to_string(),
        ));
    }
    Ok(read)
}

fn lines<P: HasXY>(parts: &[Vec<P>], points: &mut usize) -> Result<Shape, Unreadable> {
    let mut lines = Vec::with_capacity(parts.len());
    for part in parts {
        let line = places(part, points)?;
        if line.len() >= 2 {
            lines.push(line);
        }
    }
    Ok(if lines.is_empty() { Shape::Broken("fewer than two points") } else { Shape::Lines(lines) })
}

fn rings<P: HasXY>(rings: &[PolygonRing<P>], points: &mut usize) -> Result<Shape, Unreadable> {
    let mut polygon = Polygon::default();
    for ring in rings {
        let (into, all) = match ring {
            PolygonRing::Outer(all) => (&mut polygon.outers, all),
            PolygonRing::Inner(all) => (&mut polygon.inners, all),
        };
        let line = places(all, points)?;
        let ring = ring_of(&line).unwrap_or(line);
        if ring.len() >= 3 {
            into.push(ring);
        }
    }
    Ok(if polygon.outers.is_empty() { Shape::Broken("no outline of three points") } else { Shape::Polygon(polygon) })
}

fn places<P: HasXY>(all: &[P], points: &mut usize) -> Result<Vec<DVec2>, Unreadable> {
    *points += all.len();
    if *points > MAX_POINTS {
        return Err(Unreadable::new(format!("at most {MAX_POINTS} points"), "more"));
    }
    all.iter().map(place).collect()
}

fn place<P: HasXY>(point: &P) -> Result<DVec2, Unreadable> {
    let at = DVec2::new(point.x(), point.y());
    if is_place(at) {
        Ok(at)
    } else {
        Err(Unreadable::new("longitude and latitude in degrees", format!("{}, {}", at.x, at.y)))
    }
}
