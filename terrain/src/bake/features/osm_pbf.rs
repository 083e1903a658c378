//! OpenStreetMap's PBF (wiki.openstreetmap.org/wiki/PBF_Format) by the crate `osmpbf`.
//!
//! The crate adds up deltas without a check and trusts member types, so damaged bytes may panic inside it: such a panic
//! is caught and is an error as any other.

use super::osm::{OsmData, Relation};
use super::raw::Tags;
use crate::bake::raster::Unreadable;
use osmpbf::{BlobDecode, BlobReader, Element, RelMemberType};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Most blobs: each may unpack to 32 MiB.
const MAX_BLOBS: usize = 1 << 16;

/// Whether bytes begin as such a file does: the length of a head, and a head that says what it is.
pub fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0, 0]) && bytes.get(4..15) == Some(b"\x0a\x09OSMHeader")
}

/// Reads a file.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn read(bytes: &[u8]) -> Result<OsmData, Unreadable> {
    catch_unwind(AssertUnwindSafe(|| read_trusting(bytes)))
        .unwrap_or_else(|_| Err(Unreadable::new("an undamaged OSM PBF", "numbers out of range")))
}

fn read_trusting(bytes: &[u8]) -> Result<OsmData, Unreadable> {
    let damaged = |error: osmpbf::Error| Unreadable::new("an undamaged OSM PBF", error.to_string());
    let mut data = OsmData::default();
    for (number, blob) in BlobReader::new(bytes).enumerate() {
        if number >= MAX_BLOBS {
            return Err(Unreadable::new(format!("at most {MAX_BLOBS} blobs"), "more"));
        }
        if let BlobDecode::OsmData(block) = blob.map_err(damaged)?.decode().map_err(damaged)? {
            for element in block.elements() {
                take(&mut data, &element)?;
            }
        }
    }
    Ok(data)
}

fn take(data: &mut OsmData, element: &Element<'_>) -> Result<(), Unreadable> {
    // Nanodegrees to the 1e-7 degrees that the map is kept in.
    let units = |nano: i64| (nano + nano.signum() * 50) / 100;
    match element {
        Element::DenseNode(node) => {
            data.node(node.id(), units(node.nano_lon()), units(node.nano_lat()), known(node.tags()).0)
        }
        Element::Node(node) => {
            data.node(node.id(), units(node.nano_lon()), units(node.nano_lat()), known(node.tags()).0)
        }
        Element::Way(way) => {
            let (tags, number) = known(way.tags());
            data.way(way.id(), tags, number > 0, way.refs())
        }
        Element::Relation(relation) => {
            let (tags, number) = known(relation.tags());
            let ways = relation
                .members()
                .filter(|member| member.member_type == RelMemberType::Way)
                .map(|member| (member.member_id, member.role().is_ok_and(|role| role == "inner")))
                .collect();
            let tagged = number > usize::from(tags.get("type").is_some());
            data.relation(Relation { id: relation.id(), tags, tagged, ways })
        }
    }
}

/// The tags that are asked for, and the number of all.
fn known<'a>(all: impl Iterator<Item = (&'a str, &'a str)>) -> (Tags, usize) {
    let mut tags = Tags::default();
    let mut number = 0;
    for (key, value) in all {
        tags.push(key, value);
        number += 1;
    }
    (tags, number)
}
