//! Tables of airfields: a line each with a place, and an elevation in feet.
//!
//! Columns by their heads, in any order: `icao`, `ident` or `code`; `name`; `lat`, `lon`; `elev_ft`, `elevation` or
//! `elevation_ft`; and, where a table has them, `iata`, `type` (`large_airport`, `medium_airport`, `small_airport`,
//! `heliport`, `closed`) and `runways`, such as `05/23 2400x45 asphalt; 14/32 800x20 grass` (metres). Others are passed
//! over. So are read the tables of airportsdata and OurAirports.

use super::measure::number;
use super::raw::is_place;
use crate::bake::raster::Unreadable;
use crate::features::model::RunwaySurface;
use glam::DVec2;

/// Feet to metres.
const FOOT_M: f64 = 0.3048;

/// Most airfields of a table; the world has a tenth of that.
const MAX_ROWS: usize = 1 << 19;

/// Most runways of one airfield.
const MAX_RUNWAYS: usize = 12;

/// Longest text kept, characters.
const MAX_TEXT: usize = 80;

/// An airfield as a table has it.
#[derive(Debug, Clone, PartialEq)]
pub struct AirfieldRow {
    /// Its code.
    pub code: String,
    /// Its name.
    pub name: String,
    /// Longitude and latitude; `None` if the line has no place.
    pub at: Option<DVec2>,
    /// Elevation above mean sea level.
    pub elevation_m: Option<f64>,
    /// How large it is.
    pub size: AirfieldSize,
    /// Its runways, if the table says.
    pub runways: Vec<StatedRunway>,
}

/// Sizes of airfields, for what nobody states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AirfieldSize {
    /// Airliners come.
    Large,
    /// An airport with an IATA code.
    Medium,
    /// A field.
    Small,
    /// No runway at all: a heliport, or closed.
    None,
}

/// A runway of a table: it has no place.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedRunway {
    /// Both designators; empty if not said.
    pub designators: [String; 2],
    /// Length.
    pub length_m: f64,
    /// Width.
    pub width_m: f64,
    /// What it is made of.
    pub surface: RunwaySurface,
}

/// Whether text begins with the head of such a table.
pub fn looks_like(text: &[u8]) -> bool {
    let line = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let heads = String::from_utf8_lossy(&line[..line.len().min(2048)]).to_lowercase();
    let has = |head: &str| heads.split(',').any(|h| h.trim().trim_matches('"') == head);
    (has("lat") || has("latitude_deg")) && (has("lon") || has("longitude_deg"))
}

/// Reads a table.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn read(text: &[u8]) -> Result<Vec<AirfieldRow>, Unreadable> {
    let damaged = |e: csv::Error| Unreadable::new("a table of airfields", e.to_string());
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text);
    let heads = reader.byte_headers().map_err(damaged)?.clone();
    let column = |names: &[&str]| {
        heads.iter().position(|head| {
            let head = String::from_utf8_lossy(head).trim().to_lowercase();
            names.contains(&head.as_str())
        })
    };
    let (lat, lon) = (column(&["lat", "latitude_deg"]), column(&["lon", "longitude_deg"]));
    let code = column(&["icao", "ident", "code"]);
    let elevation = column(&["elev_ft", "elevation", "elevation_ft"]);
    let (name, iata, size, runways) =
        (column(&["name"]), column(&["iata", "iata_code"]), column(&["type"]), column(&["runways"]));
    let mut rows = Vec::new();
    for row in reader.byte_records() {
        let row = row.map_err(damaged)?;
        if rows.len() >= MAX_ROWS {
            return Err(Unreadable::new(format!("at most {MAX_ROWS} airfields"), "more"));
        }
        let text = |column: Option<usize>| {
            let bytes = column.and_then(|column| row.get(column)).unwrap_or_default();
            String::from_utf8_lossy(bytes).trim().chars().take(MAX_TEXT).collect::<String>()
        };
        let degrees = |column| text(column).parse::<f64>().ok();
        let at = degrees(lon).zip(degrees(lat)).map(|(lon, lat)| DVec2::new(lon, lat)).filter(|at| is_place(*at));
        let feet = text(elevation).parse::<f64>().ok().filter(|feet| feet.abs() < 30_000.0);
        rows.push(AirfieldRow {
            code: text(code),
            name: text(name),
            at,
            elevation_m: feet.map(|feet| feet * FOOT_M),
            size: size_of(&text(size), &text(iata)),
            runways: runways_of(&text(runways)),
        });
    }
    Ok(rows)
}

fn size_of(kind: &str, iata: &str) -> AirfieldSize {
    match kind {
        "large_airport" => AirfieldSize::Large,
        "medium_airport" => AirfieldSize::Medium,
        "small_airport" => AirfieldSize::Small,
        "heliport" | "closed" | "seaplane_base" | "balloonport" => AirfieldSize::None,
        _ if !iata.is_empty() => AirfieldSize::Medium,
        _ => AirfieldSize::Small,
    }
}

/// The runways of `05/23 2400x45 asphalt; ..`; what is not so written is passed over.
fn runways_of(text: &str) -> Vec<StatedRunway> {
    let one = |text: &str| {
        let mut words = text.split_whitespace();
        let mut word = words.next()?;
        let mut designators = [const { String::new() }; 2];
        if let Some((low, high)) = word.split_once('/') {
            designators = [low, high].map(|one| one.chars().take(3).collect());
            word = words.next()?;
        }
        let (length, width) = word.split_once('x')?;
        let (length_m, width_m) = (number(length)?, number(width)?);
        let surface = match words.next() {
            Some("concrete") => RunwaySurface::Concrete,
            Some("gravel") => RunwaySurface::Gravel,
            Some("grass") => RunwaySurface::Grass,
            _ => RunwaySurface::Asphalt,
        };
        let sane = (100.0..=8_000.0).contains(&length_m) && (5.0..=200.0).contains(&width_m);
        sane.then_some(StatedRunway { designators, length_m, width_m, surface })
    };
    text.split(';').filter_map(one).take(MAX_RUNWAYS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_tables_are_read() {
        let table = "region,icao,iata,name,country,lat,lon,elev_ft,runways\n\
                     x,UCFL,IKU,Issyk-Kul,KG,42.5883,76.7133,5426,05/23 2400x45 concrete; nonsense; 300x20\nx,Q,,No place,KG,,1,\n";
        assert!(looks_like(table.as_bytes()));
        let rows = read(table.as_bytes()).unwrap();
        assert_eq!((rows.len(), rows[0].size, rows[1].size), (2, AirfieldSize::Medium, AirfieldSize::Small));
        assert!((rows[0].elevation_m.unwrap() - 1653.8448).abs() < 1e-9);
        assert_eq!((rows[0].runways.len(), rows[0].runways[0].surface), (2, RunwaySurface::Concrete));
        assert_eq!((rows[0].runways[0].designators[1].as_str(), rows[0].runways[1].length_m), ("23", 300.0));
        assert_eq!((rows[1].at, rows[1].elevation_m), (None, None));
        let other =
            "\"icao\",\"iata\",\"name\",\"elevation\",\"lat\",\"lon\"\n\"00AA\",\"\",\"A, B\",3435,38.7,-101.4\n";
        assert_eq!(read(other.as_bytes()).unwrap()[0].name, "A, B");
    }
}
