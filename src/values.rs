//! What a person types, as numbers that can be relied on.
//!
//! Degrees and the units in the flags' names appear here only; nothing is converted. Invariant others rely on: every
//! number that leaves this file is finite and within the range its message states. A refusal says what was expected
//! and what was found.

use clap::ValueEnum;
use std::fmt;
use std::ops::RangeInclusive;

/// Largest side of a picture: what every adapter that wgpu's default limits describe can draw, and 8K.
pub const MAX_SIDE_PX: u32 = 8192;

/// Why a value was refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    expected: String,
    found: String,
}

/// A point above or on the Earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Geodetic latitude (WGS84), degrees.
    pub lat_deg: f64,
    /// Longitude east of Greenwich, degrees.
    pub lon_deg: f64,
    /// How high.
    pub altitude: Altitude,
}

/// A height and what it is counted from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Altitude {
    /// Metres above mean sea level.
    SeaLevelM(f64),
    /// Metres above the ground at that place (`:agl`).
    GroundM(f64),
}

/// A point on the map, without a height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPoint {
    /// Geodetic latitude (WGS84), degrees.
    pub lat_deg: f64,
    /// Longitude east of Greenwich, degrees.
    pub lon_deg: f64,
}

/// A direction of view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Clockwise from true north, degrees.
    pub azimuth_deg: f64,
    /// Above the horizon, degrees; -90 is straight down.
    pub elevation_deg: f64,
}

/// A picture's size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Columns of pixels.
    pub width_px: u32,
    /// Rows of pixels.
    pub height_px: u32,
}

/// A rectangle of ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// West to east, kilometres.
    pub width_km: f64,
    /// North to south, kilometres.
    pub height_km: f64,
}

/// Settings that belong together, from dear to cheap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    /// For a graphics card: the long window, MSAA 4.
    Fine,
    /// The long window without MSAA.
    Standard,
    /// For a processor that draws: the short window, render scale 0.67.
    Software,
}

/// What may be drawn over the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Overlay {
    /// Colour each block by its kind: level 0, level 1, mixed.
    Blocks,
}

/// What may be left out of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Without {
    /// Roads, running water, runways.
    Overlays,
    /// Buildings and placed things.
    Objects,
    /// Trees and bushes.
    Plants,
    /// Light points, and the light of windows and lamps on buildings.
    Lights,
}

/// What `bench` measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Subject {
    /// Heights and segments against the ground.
    Ground,
    /// Whole frames.
    Frame,
    /// Making a world out of elevation data.
    Bake,
    /// Building blocks.
    Mesh,
    /// Steps of aircraft and shells.
    Flight,
    /// What each thing on the ground costs.
    Scene,
    /// Placing plants.
    Plants,
    /// All of them.
    All,
}

/// What `trade` measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Priced {
    /// Settings of the picture.
    Scene,
    /// Integrators, precisions, and depths of physics.
    Flight,
    /// Both.
    All,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {}, found `{}`", self.expected, self.found)
    }
}

impl std::error::Error for Refused {}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width_px, self.height_px)
    }
}

/// Longest piece of a refused value that is repeated to the person who typed it.
const SHOWN_CHARACTERS: usize = 60;

fn refuse<T>(expected: impl Into<String>, found: &str) -> Result<T, Refused> {
    let mut shown: String = found.chars().take(SHOWN_CHARACTERS).flat_map(char::escape_debug).collect();
    if found.chars().nth(SHOWN_CHARACTERS).is_some() {
        shown.push_str("...");
    }
    Err(Refused { expected: expected.into(), found: shown })
}

/// A finite number within a range; `what` names it with its unit.
///
/// # Errors
/// [`Refused`] if it is not a number, not finite or out of range.
pub fn number(text: &str, what: &str, range: RangeInclusive<f64>) -> Result<f64, Refused> {
    match text.trim().parse::<f64>() {
        Ok(value) if range.contains(&value) => Ok(value),
        _ => refuse(format!("{what} within {}..={}", range.start(), range.end()), text),
    }
}

fn pieces<'t, const N: usize>(text: &'t str, separator: char, form: &str) -> Result<[&'t str; N], Refused> {
    let all: Vec<&str> = text.split(separator).collect();
    <[&str; N]>::try_from(all).or_else(|_| refuse(form, text))
}

fn latitude(text: &str) -> Result<f64, Refused> {
    number(text, "a latitude in degrees", -90.0..=90.0)
}

fn longitude(text: &str) -> Result<f64, Refused> {
    number(text, "a longitude in degrees", -180.0..=180.0)
}

/// `LAT,LON,ALT` or `LAT,LON,ALT:agl`.
///
/// # Errors
/// [`Refused`] names the part that is wrong.
pub fn place(text: &str) -> Result<Place, Refused> {
    let (numbers, above_ground) = match text.split_once(':') {
        None => (text, false),
        Some((numbers, "agl")) => (numbers, true),
        Some((_, other)) => return refuse("`:agl` or nothing after the altitude", other),
    };
    let [lat, lon, alt] = pieces(numbers, ',', "LAT,LON,ALT in degrees and metres, with `:agl` for above ground")?;
    let altitude_m = number(alt, "an altitude in metres", -12_000.0..=1_000_000.0)?;
    let altitude = if above_ground { Altitude::GroundM(altitude_m) } else { Altitude::SeaLevelM(altitude_m) };
    Ok(Place { lat_deg: latitude(lat)?, lon_deg: longitude(lon)?, altitude })
}

/// A crater as a person names it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CraterMark {
    /// Latitude, degrees.
    pub lat_deg: f64,
    /// Longitude, degrees.
    pub lon_deg: f64,
    /// Radius, metres.
    pub radius_m: f64,
    /// Depth, metres; that of its radius where none is given.
    pub depth_m: Option<f64>,
}

/// `LAT,LON,RADIUS_M` or `LAT,LON,RADIUS_M,DEPTH_M`.
///
/// # Errors
/// [`Refused`] names the part that is wrong.
pub fn crater(text: &str) -> Result<CraterMark, Refused> {
    let expected = "LAT,LON,RADIUS_M or LAT,LON,RADIUS_M,DEPTH_M in degrees and metres";
    let ([lat, lon, radius], depth) = match text.matches(',').count() {
        3 => pieces(text, ',', expected).map(|[lat, lon, radius, depth]| ([lat, lon, radius], Some(depth)))?,
        _ => (pieces(text, ',', expected)?, None),
    };
    Ok(CraterMark {
        lat_deg: latitude(lat)?,
        lon_deg: longitude(lon)?,
        radius_m: number(radius, "a radius in metres", 1.0..=terrain::edit::MOST_RADIUS_M)?,
        depth_m: depth
            .map(|depth| number(depth, "a depth in metres", 0.1..=terrain::edit::MOST_DEPTH_M))
            .transpose()?,
    })
}

/// `LAT,LON`.
///
/// # Errors
/// [`Refused`] names the part that is wrong.
pub fn map_point(text: &str) -> Result<MapPoint, Refused> {
    let [lat, lon] = pieces(text, ',', "LAT,LON in degrees")?;
    Ok(MapPoint { lat_deg: latitude(lat)?, lon_deg: longitude(lon)? })
}

/// `AZ,EL`.
///
/// # Errors
/// [`Refused`] names the part that is wrong.
pub fn look(text: &str) -> Result<Look, Refused> {
    let [azimuth, elevation] = pieces(text, ',', "AZ,EL in degrees from true north and above the horizon")?;
    Ok(Look {
        azimuth_deg: heading_deg(azimuth)?,
        elevation_deg: number(elevation, "an elevation in degrees", -90.0..=90.0)?,
    })
}

/// `WxH` in pixels.
///
/// # Errors
/// [`Refused`] names the part that is wrong.
pub fn size(text: &str) -> Result<Size, Refused> {
    let [width, height] = pieces(text, 'x', "WxH in pixels, such as 1280x720")?;
    let side = |side: &str| match side.parse::<u32>() {
        Ok(pixels) if (1..=MAX_SIDE_PX).contains(&pixels) => Ok(pixels),
        _ => refuse(format!("a side of 1..={MAX_SIDE_PX} whole pixels"), side),
    };
    Ok(Size { width_px: side(width)?, height_px: side(height)? })
}

/// `WxH` in kilometres.
///
/// # Errors
/// [`Refused`] names the part that is wrong.
pub fn extent(text: &str) -> Result<Extent, Refused> {
    let [width, height] = pieces(text, 'x', "WxH in kilometres, such as 400x300")?;
    let side = |side: &str| number(side, "a side in kilometres", 0.1..=1000.0);
    Ok(Extent { width_km: side(width)?, height_km: side(height)? })
}

/// Blocks along a side of the far ring.
///
/// # Errors
/// [`Refused`] for anything but 12 and 24.
pub fn window(text: &str) -> Result<u32, Refused> {
    one_of(text, [12, 24], "12 or 24 blocks")
}

/// Samples a pixel.
///
/// # Errors
/// [`Refused`] for anything but 1 and 4.
pub fn msaa(text: &str) -> Result<u32, Refused> {
    one_of(text, [1, 4], "1 or 4 samples a pixel")
}

fn one_of(text: &str, choices: [u32; 2], expected: &str) -> Result<u32, Refused> {
    match text.parse() {
        Ok(value) if choices.contains(&value) => Ok(value),
        _ => refuse(expected, text),
    }
}

/// A heading, degrees clockwise from true north.
///
/// # Errors
/// [`Refused`] if it is not a number within a turn either way.
pub fn heading_deg(text: &str) -> Result<f64, Refused> {
    number(text, "degrees from true north", -360.0..=360.0)
}

/// A speed along the track.
///
/// # Errors
/// [`Refused`] if it is not within 0..=10,000 m/s.
pub fn speed_mps(text: &str) -> Result<f64, Refused> {
    number(text, "a speed in metres a second", 0.0..=10_000.0)
}

/// The vertical field of view.
///
/// # Errors
/// [`Refused`] if it is not within 1..=150 degrees.
pub fn fov_y_deg(text: &str) -> Result<f64, Refused> {
    number(text, "a vertical field of view in degrees", 1.0..=150.0)
}

/// How far one sees.
///
/// # Errors
/// [`Refused`] if it is not within 100 m..=1,000 km.
pub fn visibility_m(text: &str) -> Result<f64, Refused> {
    number(text, "a visibility in metres", 100.0..=1_000_000.0)
}

/// Pixels drawn for a pixel shown, along a side.
///
/// # Errors
/// [`Refused`] if it is not within 0.25..=1.
pub fn render_scale(text: &str) -> Result<f64, Refused> {
    number(text, "a scale", 0.25..=1.0)
}

/// A share of something.
///
/// # Errors
/// [`Refused`] if it is not within 0..=1.
pub fn share(text: &str) -> Result<f64, Refused> {
    number(text, "a share", 0.0..=1.0)
}

/// Frames a second to hold.
///
/// # Errors
/// [`Refused`] if it is not within 1..=1000.
pub fn pace_hz(text: &str) -> Result<f64, Refused> {
    number(text, "frames a second", 1.0..=1000.0)
}

/// How long to fly.
///
/// # Errors
/// [`Refused`] if it is not within 0.01 s..=1 day.
pub fn seconds(text: &str) -> Result<f64, Refused> {
    number(text, "seconds", 0.01..=86_400.0)
}

/// Distance between posts.
///
/// # Errors
/// [`Refused`] if it is not within 25..=400 m.
pub fn step_m(text: &str) -> Result<f64, Refused> {
    number(text, "a post step in metres", 25.0..=400.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: [&str; 18] = [
        "",
        " ",
        ",",
        ",,",
        ",,,",
        "x",
        "nan",
        "NaN,NaN,NaN",
        "inf",
        "1e999",
        "-inf,0,0",
        "１,２,３",
        "é",
        "\0",
        "1;2;3",
        "0x10",
        "--json",
        "💥x💥",
    ];

    #[test]
    fn places_are_read_and_their_altitude_knows_its_zero() {
        let altitude = Altitude::SeaLevelM(3000.0);
        assert_eq!(place("42.5,77.25,3000"), Ok(Place { lat_deg: 42.5, lon_deg: 77.25, altitude }));
        let altitude = Altitude::GroundM(0.5);
        assert_eq!(place("-42.5, -77.25 ,0.5:agl"), Ok(Place { lat_deg: -42.5, lon_deg: -77.25, altitude }));
        assert!(place("90,180,-430").is_ok() && place("-90,-180,1e6").is_ok());
    }

    #[test]
    fn a_refusal_says_what_was_expected_and_what_was_found() {
        let said = |text| place(text).unwrap_err().to_string();
        assert_eq!(said("91,0,0"), "expected a latitude in degrees within -90..=90, found `91`");
        assert_eq!(said("0,181,0"), "expected a longitude in degrees within -180..=180, found `181`");
        assert_eq!(said("0,0,1e999"), "expected an altitude in metres within -12000..=1000000, found `1e999`");
        assert_eq!(said("0,0,5:AGL"), "expected `:agl` or nothing after the altitude, found `AGL`");
        assert!(said("1,2").ends_with("found `1,2`"));
        assert_eq!(window("13").unwrap_err().to_string(), "expected 12 or 24 blocks, found `13`");
        assert_eq!(msaa("2").unwrap_err().to_string(), "expected 1 or 4 samples a pixel, found `2`");
    }

    #[test]
    fn what_is_repeated_is_short_and_printable() {
        let said = size(&"\u{1b}[31m".repeat(100)).unwrap_err().to_string();
        assert!(said.chars().all(|c| !c.is_control()) && said.chars().count() < 700, "{said}");
        let said = size(&"9".repeat(1_000_000)).unwrap_err().to_string();
        assert!(said.len() < 200 && said.ends_with("...`"), "{said}");
    }

    #[test]
    fn sizes_are_whole_and_bounded() {
        assert_eq!(size("1x8192"), Ok(Size { width_px: 1, height_px: 8192 }));
        assert_eq!(Size { width_px: 1280, height_px: 720 }.to_string(), "1280x720");
        for text in
            ["0x0", "0x720", "1e9x1", "1000000000x1", "8193x1", "-1x5", "1.5x2", "1280", "1x2x3", "1280X720", "x"]
        {
            assert!(size(text).is_err(), "{text}");
        }
        assert_eq!(extent("400x300.5"), Ok(Extent { width_km: 400.0, height_km: 300.5 }));
        for text in ["0x0", "-1x5", "1e9x1", "NaNx1", "infxinf", "400"] {
            assert!(extent(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_out_of_range_or_not_finite_are_refused_by_every_reader() {
        type Reader = fn(&str) -> Result<f64, Refused>;
        // A reader with a value just inside and just outside each end.
        let readers: [(Reader, [&str; 2], [&str; 2]); 8] = [
            (heading_deg, ["-360", "360"], ["-360.1", "360.1"]),
            (speed_mps, ["0", "10000"], ["-0.1", "10000.1"]),
            (fov_y_deg, ["1", "150"], ["0.99", "180"]),
            (visibility_m, ["100", "1e6"], ["99", "1000001"]),
            (render_scale, ["0.25", "1"], ["0.24", "1.01"]),
            (pace_hz, ["1", "1000"], ["0", "1001"]),
            (seconds, ["0.01", "86400"], ["0", "86401"]),
            (step_m, ["25", "400"], ["24.9", "400.1"]),
        ];
        for (read, inside, outside) in readers {
            for text in inside {
                assert!(read(text).is_ok(), "{text}");
            }
            for text in outside.into_iter().chain(HOSTILE) {
                assert!(read(text).is_err(), "{text}");
            }
        }
        for text in HOSTILE {
            assert!(place(text).is_err() && map_point(text).is_err() && look(text).is_err(), "{text}");
            assert!(size(text).is_err() && extent(text).is_err() && window(text).is_err() && msaa(text).is_err());
        }
    }

    #[test]
    fn directions_and_map_points_are_read() {
        assert_eq!(look("-15,-90"), Ok(Look { azimuth_deg: -15.0, elevation_deg: -90.0 }));
        assert!(look("0,90.1").is_err() && look("361,0").is_err() && look("1,2,3").is_err());
        assert_eq!(map_point("-42,77"), Ok(MapPoint { lat_deg: -42.0, lon_deg: 77.0 }));
        assert!(map_point("90.0001,0").is_err() && map_point("0,0,0").is_err());
    }
}
