//! OpenStreetMap's XML (wiki.openstreetmap.org/wiki/OSM_XML), also as Overpass writes it.

use super::osm::{OsmData, Relation};
use super::raw::Tags;
use crate::bake::raster::Unreadable;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

/// Whether text begins as such a file does.
pub fn looks_like(text: &[u8]) -> bool {
    let start = &text[..text.len().min(4096)];
    text.first() == Some(&b'<') && start.windows(4).any(|four| four == b"<osm")
}

/// The element that is being read.
enum Open {
    Nothing,
    Node { id: i64, lon: i64, lat: i64 },
    Way { id: i64, nodes: Vec<i64> },
    Relation { id: i64, ways: Vec<(i64, bool)> },
}

/// Reads a file.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn read(bytes: &[u8]) -> Result<OsmData, Unreadable> {
    let mut reader = Reader::from_reader(bytes);
    let (mut data, mut open, mut tags, mut number) = (OsmData::default(), Open::Nothing, Tags::default(), 0);
    let mut root = false;
    loop {
        let at = reader.buffer_position();
        let event = reader.read_event().map_err(|e| Unreadable::new("OSM XML", format!("at byte {at}: {e}")))?;
        match &event {
            Event::Start(start) | Event::Empty(start) => {
                match start.name().as_ref() {
                    "osm" => root = true,
                    "node" | "way" | "relation" if is_deleted(start)? => open = Open::Nothing,
                    "node" => {
                        let [id, lon, lat] = attributes(start, ["id", "lon", "lat"])?;
                        open = Open::Node { id: whole(&id)?, lon: units(&lon)?, lat: units(&lat)? };
                    }
                    "way" => open = Open::Way { id: whole(&attributes(start, ["id"])?[0])?, nodes: Vec::new() },
                    "relation" => {
                        open = Open::Relation { id: whole(&attributes(start, ["id"])?[0])?, ways: Vec::new() }
                    }
                    // Those of areas, changesets and what is deleted are nobody's.
                    "tag" if !matches!(open, Open::Nothing) => {
                        let [key, value] = attributes(start, ["k", "v"])?;
                        tags.push(&key, &value);
                        number += 1;
                    }
                    "nd" => {
                        if let Open::Way { nodes, .. } = &mut open {
                            nodes.push(whole(&attributes(start, ["ref"])?[0])?);
                        }
                    }
                    "member" => {
                        if let Open::Relation { ways, .. } = &mut open {
                            let [kind, id, role] = attributes(start, ["type", "ref", "role"])?;
                            if kind == "way" {
                                ways.push((whole(&id)?, role == "inner"));
                            }
                        }
                    }
                    _ => {}
                }
                let element = matches!(start.name().as_ref(), "node" | "way" | "relation");
                if element && matches!(event, Event::Empty(_)) {
                    close(&mut data, &mut open, &mut tags, &mut number)?;
                }
            }
            Event::End(end) if matches!(end.name().as_ref(), "node" | "way" | "relation") => {
                close(&mut data, &mut open, &mut tags, &mut number)?;
            }
            Event::Eof if root => return Ok(data),
            Event::Eof => return Err(Unreadable::new("an `osm` element", "none")),
            _ => {}
        }
    }
}

/// Hands over what was read since the last.
fn close(data: &mut OsmData, open: &mut Open, tags: &mut Tags, number: &mut usize) -> Result<(), Unreadable> {
    let (tags, number) = (std::mem::take(tags), std::mem::take(number));
    match std::mem::replace(open, Open::Nothing) {
        Open::Nothing => Ok(()),
        Open::Node { id, lon, lat } => data.node(id, lon, lat, tags),
        Open::Way { id, nodes } => data.way(id, tags, number > 0, nodes.into_iter()),
        Open::Relation { id, ways } => {
            let tagged = number > usize::from(tags.get("type").is_some());
            data.relation(Relation { id, tags, tagged, ways })
        }
    }
}

/// Whether an element is there no longer: an editor's file has it to be deleted, or a history after it was.
fn is_deleted(start: &BytesStart<'_>) -> Result<bool, Unreadable> {
    let [action, visible] = attributes(start, ["action", "visible"])?;
    Ok(action == "delete" || visible == "false")
}

/// Attributes by name, empty where absent.
fn attributes<const N: usize>(start: &BytesStart<'_>, names: [&str; N]) -> Result<[String; N], Unreadable> {
    let mut values = [const { String::new() }; N];
    for attribute in start.attributes() {
        let damaged = |e: &dyn std::fmt::Display| Unreadable::new("OSM XML", e.to_string());
        let attribute = attribute.map_err(|e| damaged(&e))?;
        if let Some(at) = names.iter().position(|name| *name == attribute.key.as_ref()) {
            values[at] = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| damaged(&e))?.into_owned();
        }
    }
    Ok(values)
}

fn whole(text: &str) -> Result<i64, Unreadable> {
    text.parse().map_err(|_| Unreadable::new("a whole number", format!("`{text}`")))
}

/// Degrees in units of 1e-7.
fn units(text: &str) -> Result<i64, Unreadable> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees.abs() <= 360.0 => Ok((degrees * 1e7).round() as i64),
        _ => Err(Unreadable::new("degrees", format!("`{text}`"))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::raw::{Element, Shape};
    use super::*;

    #[test]
    fn a_small_file_is_read() {
        let text = r#"<?xml version="1.0"?><osm version="0.6"><note>a &amp; b</note>
            <node id="1" lat="42.0" lon="1.5"/><node id="2" lat="42.1" lon="1.5"><tag k="man_made" v="mast"/></node>
            <node id="3" lat="42.1" lon="1.6"/>
            <way id="7"><nd ref="1"/><nd ref="2"/><nd ref="99"/><tag k="highway" v="track"/></way>
            <way id="8"><nd ref="1"/><nd ref="2"/><nd ref="3"/></way><way id="9"><nd ref="3"/><nd ref="1"/></way>
            <relation id="5"><member type="way" ref="9" role="outer"/><member type="way" ref="8" role=""/>
            <tag k="type" v="multipolygon"/><tag k="natural" v="wood"/></relation></osm>"#;
        assert!(looks_like(text.as_bytes()));
        let features = read(text.as_bytes()).unwrap().features().unwrap();
        let kinds: Vec<Element> = features.iter().map(|feature| feature.element).collect();
        assert_eq!(kinds, [Element::Node, Element::Way, Element::Relation]);
        let Shape::Lines(lines) = &features[1].shape else { panic!("{:?}", features[1]) };
        assert_eq!((lines.len(), lines[0].len(), lines[0][1].y), (1, 2, 42.1));
        let Shape::Polygon(polygon) = &features[2].shape else { panic!("{:?}", features[2]) };
        assert_eq!((polygon.outers.len(), polygon.outers[0].len(), polygon.inners.len()), (1, 3, 0));
    }

    #[test]
    fn tags_stay_with_their_element_and_what_is_deleted_is_not_there() {
        let text = r#"<osm version="0.6"><area id="1"><tag k="building" v="yes"/></area>
            <node id="1" lat="42.0" lon="1.5"/><node id="2" lat="42.1" lon="1.5"/>
            <node id="3" visible="false"><tag k="man_made" v="mast"/></node>
            <way id="7"><nd ref="1"/><nd ref="2"/><tag k="highway" v="track"/></way>
            <way id="8" action="delete"><nd ref="1"/><nd ref="2"/><tag k="highway" v="path"/></way>
            <way id="9"><nd ref="2"/><nd ref="1"/><tag k="highway" v="steps"/></way></osm>"#;
        let features = read(text.as_bytes()).unwrap().features().unwrap();
        let roads: Vec<Option<&str>> = features.iter().map(|feature| feature.tags.get("highway")).collect();
        assert_eq!(roads, [Some("track"), Some("steps")]);
        assert!(features.iter().all(|feature| feature.tags.get("building").is_none()));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for bad in
            ["<osm><node id=\"1\" lat=\"x\" lon=\"0\"/></osm>", "<osm><way id=\"\"/></osm>", "<gpx/>", "<osm", ""]
        {
            assert!(read(bad.as_bytes()).is_err(), "{bad}");
        }
    }
}
