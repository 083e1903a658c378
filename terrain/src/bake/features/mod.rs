//! Features from files: read, understood, laid on a world, counted.
//!
//! Each format has its file and gives [`raw::RawFeature`]s; what a file is is told from its content. [`tags`] says what
//! they mean, [`place`] lays them on a world's plane and keeps the books ([`kind::Counts`]): of every kind
//! `read = kept + skipped`, with the reason for each. [`coast`] joins coastlines to the sea, [`waters`] makes lakes of the water that is large enough for the
//! posts, [`airfields`] joins airfields with their runways and sets them into the ground, [`downhill`] turns rivers the
//! way the ground falls. Frame of what comes out: [`crate::frame`].

mod aeroways;
mod airfield_csv;
mod airfields;
mod coast;
mod downhill;
mod flatten;
mod geojson;
mod kind;
mod measure;
mod osm;
mod osm_pbf;
mod osm_xml;
mod place;
mod raw;
mod relations;
mod schemes;
mod shapefile;
mod tags;
mod waters;

use super::bake_world::Input;
use super::raster::Unreadable;
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;

pub use airfield_csv::AirfieldRow;
pub use airfields::{Site, set_airfields};
pub use downhill::turn_downstream;
pub use kind::{Counts, Kind};
pub use place::{Placed, place};
pub use raw::RawFeature;
pub use waters::{OpenWater, set_lakes};

/// Largest file, also unpacked.
pub const MAX_BYTES: u64 = 1 << 30;

/// Largest GeoJSON and largest table, also unpacked: parsed, text takes many times its size.
const MAX_TEXT_BYTES: usize = 1 << 28;

/// Most points of a GeoJSON file or a shapefile: the lakes of a continent.
const MAX_POINTS: usize = 4_000_000;

/// What a file holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Content {
    /// Tagged shapes.
    pub features: Vec<RawFeature>,
    /// Lines of a table of airfields.
    pub airfields: Vec<AirfieldRow>,
}

/// Reads a file of features in any of the known formats.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn open(input: &Input) -> Result<Content, Unreadable> {
    match input {
        Input::Embedded(bytes) => read(bytes.content, None, None),
        Input::File(path) => {
            let bytes = bounded_file(path)?;
            if shapefile::looks_like(&bytes) {
                let prj = beside(path, ["prj", "PRJ"])?.map(|prj| String::from_utf8_lossy(&prj).into_owned());
                return read(&bytes, beside(path, ["dbf", "DBF"])?.as_deref(), prj.as_deref());
            }
            read(&bytes, None, None)
        }
    }
}

/// Reads the bytes of a file; `dbf` and `prj` are what lies beside a shapefile.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn read(bytes: &[u8], dbf: Option<&[u8]>, prj: Option<&str>) -> Result<Content, Unreadable> {
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let inner = bounded(MultiGzDecoder::new(bytes))?;
        if shapefile::looks_like(&inner) {
            return Err(Unreadable::new("a shapefile outside a gzip, its .dbf and .prj beside it", "one inside"));
        }
        return read_plain(&inner, dbf, prj);
    }
    read_plain(bytes, dbf, prj)
}

fn read_plain(bytes: &[u8], dbf: Option<&[u8]>, prj: Option<&str>) -> Result<Content, Unreadable> {
    let shapes = |mut features: Vec<RawFeature>| {
        coast::join(&mut features);
        Content { features, airfields: Vec::new() }
    };
    if osm_pbf::looks_like(bytes) {
        return osm_pbf::read(bytes)?.features().map(shapes);
    }
    if shapefile::looks_like(bytes) {
        return shapefile::read(bytes, dbf, prj).map(shapes);
    }
    // A byte order mark and white space may stand before text.
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    if osm_xml::looks_like(text) {
        return osm_xml::read(text)?.features().map(shapes);
    }
    let table = airfield_csv::looks_like(text);
    if (table || text.starts_with(b"{")) && text.len() > MAX_TEXT_BYTES {
        return Err(Unreadable::new(format!("at most {MAX_TEXT_BYTES} bytes of text"), text.len().to_string()));
    }
    if text.starts_with(b"{") {
        let text = std::str::from_utf8(text).map_err(|e| Unreadable::new("GeoJSON", e.to_string()))?;
        return geojson::read(text).map(shapes);
    }
    if table {
        return Ok(Content { features: Vec::new(), airfields: airfield_csv::read(text)? });
    }
    Err(Unreadable::new(
        "OSM PBF, OSM XML, GeoJSON or a CSV of airfields, perhaps in a gzip, or a shapefile (.shp)",
        format!("{} bytes that begin with {:02x?}", bytes.len(), &bytes[..bytes.len().min(8)]),
    ))
}

/// What lies beside a file under one of the endings; `None` if nothing does.
fn beside(path: &Path, endings: [&str; 2]) -> Result<Option<Vec<u8>>, Unreadable> {
    for ending in endings {
        match std::fs::File::open(path.with_extension(ending)) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => return Err(Unreadable::new(format!("a readable .{ending} beside it"), error.to_string())),
            Ok(file) => return bounded(file).map(Some),
        }
    }
    Ok(None)
}

fn bounded_file(path: &Path) -> Result<Vec<u8>, Unreadable> {
    let file = std::fs::File::open(path).map_err(|e| Unreadable::new("a readable file", e.to_string()))?;
    bounded(file)
}

fn bounded(stream: impl Read) -> Result<Vec<u8>, Unreadable> {
    let mut bytes = Vec::new();
    stream
        .take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| Unreadable::new("a readable file", e.to_string()))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(Unreadable::new(format!("at most {MAX_BYTES} bytes"), "more"));
    }
    Ok(bytes)
}
