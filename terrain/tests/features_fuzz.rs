//! Readers of features against hostile bytes: every format's valid file, cut short and changed, hundreds of times.
//!
//! What is asked: an answer or an error, no panic, nothing that takes long. The files are small and made here; where
//! `../shared` is there, real ones are damaged too. Places of the changes come from fixed seeds.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::io::{Cursor, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};
use terrain::bake::features;

fn changed(valid: &[u8], rng: &mut StdRng) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for _ in 0..rng.random_range(1..4) {
        if bytes.is_empty() {
            break;
        }
        let length = bytes.len();
        // Heads are worth a liar's while: half of the changes go there.
        let at = if rng.random_bool(0.5) { rng.random_range(0..length.min(1024)) } else { rng.random_range(0..length) };
        match rng.random_range(0..6) {
            0 => bytes[at] = rng.random(),
            1 => bytes[at] ^= 1 << rng.random_range(0..8),
            2 => bytes.truncate(at),
            3 => bytes[at..(at + 8).min(length)].fill(0xff),
            4 => bytes[at..(at + 6).min(length)].fill(b'9'),
            _ => {
                let piece: Vec<u8> = bytes[at..(at + 16).min(length)].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
    bytes
}

fn fuzz(what: &str, valid: &[u8], dbf: Option<&[u8]>, cases: u64) {
    let read = |bytes: &[u8], dbf: Option<&[u8]>, case: &str| {
        let started = Instant::now();
        let answer = catch_unwind(AssertUnwindSafe(|| features::read(bytes, dbf, None)));
        assert!(started.elapsed() < Duration::from_secs(10), "{what} {case}: {:?}", started.elapsed());
        match answer {
            Ok(Ok(_)) => true,
            Ok(Err(error)) => {
                assert!(!error.to_string().is_empty());
                false
            }
            Err(_) => panic!("{what} {case}: the reader panicked"),
        }
    };
    assert!(read(valid, dbf, "valid"));
    for length in (0..valid.len()).step_by((valid.len() / 60).max(1)) {
        read(&valid[..length], dbf, &format!("cut at {length}"));
    }
    let mut good = 0;
    for seed in 0..cases {
        let mut rng = StdRng::seed_from_u64(seed);
        good += u64::from(match dbf {
            Some(dbf) if seed % 2 == 0 => read(valid, Some(&changed(dbf, &mut rng)), &format!("dbf {seed}")),
            _ => read(&changed(valid, &mut rng), dbf, &format!("seed {seed}")),
        });
    }
    println!("{what}: {good} of {cases} changed files were read");
}

fn shared(file: &str) -> Option<Vec<u8>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/terrain").join(file);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
    }
    std::fs::read(path).ok()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

#[test]
fn text_formats() {
    let xml = br#"<?xml version="1.0"?><osm version="0.6"><node id="1" lat="42.0" lon="1.5"/><node id="2" lat="42.1" lon="1.5"/>
        <node id="3" lat="42.1" lon="1.6"><tag k="power" v="tower"/></node>
        <way id="7"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/><tag k="building" v="yes"/></way>
        <relation id="5"><member type="way" ref="7" role="outer"/><tag k="type" v="multipolygon"/></relation></osm>"#;
    fuzz("OSM XML", xml, None, 600);
    fuzz("OSM XML in a gzip", &gzip(xml), None, 300);
    let json = br#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"natural":"wood"},
        "geometry":{"type":"Polygon","coordinates":[[[1,42],[1.1,42],[1.1,42.1],[1,42]]]}}]}"#;
    fuzz("GeoJSON", json, None, 600);
    let csv =
        b"icao,iata,name,lat,lon,elev_ft,runways\nABCD,ABC,\"Somewhere, there\",42.1,1.2,1000,09/27 1000x30 grass\n";
    fuzz("CSV", csv, None, 600);
    for hostile in ["", "{", "<", "lat,lon", "\u{feff}  <osm", "{\"type\":\"Feature\"}"] {
        let _ = features::read(hostile.as_bytes(), None, None);
    }
    // JSON nested deeper than any stack.
    assert!(features::read("{\"a\":[".repeat(100_000).as_bytes(), None, None).is_err());
}

/// A PBF with plain blobs, so that changes meet its structure and not a packer's.
fn pbf() -> Vec<u8> {
    let varint = |mut number: u64| {
        let mut bytes = Vec::new();
        while number > 0x7f {
            bytes.push(number as u8 | 0x80);
            number >>= 7;
        }
        bytes.push(number as u8);
        bytes
    };
    let zigzag = |number: i64| ((number << 1) ^ (number >> 63)) as u64;
    let number = |field: u64, value: u64| [varint(field << 3), varint(value)].concat();
    let text = |field: u64, bytes: &[u8]| [varint(field << 3 | 2), varint(bytes.len() as u64), bytes.to_vec()].concat();
    let list =
        |field: u64, values: &[u64]| text(field, &values.iter().flat_map(|value| varint(*value)).collect::<Vec<u8>>());
    let signed =
        |field: u64, values: &[i64]| list(field, &values.iter().map(|value| zigzag(*value)).collect::<Vec<u64>>());
    let blob = |kind: &str, content: &[u8]| {
        let blob = [text(1, content), number(2, content.len() as u64)].concat();
        let head = [text(1, kind.as_bytes()), number(3, blob.len() as u64)].concat();
        [(head.len() as u32).to_be_bytes().to_vec(), head, blob].concat()
    };
    let strings: Vec<u8> =
        ["", "building", "yes", "type", "multipolygon", "outer"].iter().flat_map(|s| text(1, s.as_bytes())).collect();
    let dense = [
        signed(1, &[1, 1, 1]),
        signed(8, &[420_000_000, 1_000, 0]),
        signed(9, &[15_000_000, 0, 1_000]),
        list(10, &[0, 1, 2, 0, 0]),
    ]
    .concat();
    let way = [number(1, 7), list(2, &[1]), list(3, &[2]), signed(8, &[1, 1, 1, -2])].concat();
    let relation =
        [number(1, 5), list(2, &[1, 3]), list(3, &[2, 4]), list(8, &[5]), signed(9, &[7]), list(10, &[1])].concat();
    let group = [text(2, &dense), text(3, &way), text(4, &relation)].concat();
    let block = [text(1, &strings), text(2, &group)].concat();
    [blob("OSMHeader", &text(4, b"OsmSchema-V0.6")), blob("OSMData", &block)].concat()
}

#[test]
fn protocol_buffers() {
    let valid = pbf();
    let content = features::read(&valid, None, None).unwrap();
    assert_eq!(content.features.len(), 2, "{:?}", content.features);
    assert_eq!(content.features[1].tags.get("building"), Some("yes"));
    fuzz("OSM PBF, plain", &valid, None, 3_000);
}

#[test]
fn shapefiles() {
    let mut shp = Cursor::new(Vec::new());
    let mut writer = shapefile::ShapeWriter::new(&mut shp);
    let point = |x: f64, y: f64| shapefile::Point::new(x, y);
    let ring = vec![point(1.0, 42.0), point(1.0, 42.1), point(1.1, 42.1), point(1.0, 42.0)];
    writer.write_shape(&shapefile::Polygon::new(shapefile::PolygonRing::Outer(ring))).unwrap();
    writer.finalize().unwrap();
    drop(writer);
    let mut dbf = Cursor::new(Vec::new());
    let builder = shapefile::dbase::TableWriterBuilder::new();
    let builder = builder.add_character_field("natural".try_into().unwrap(), 20);
    let mut table = builder.build_with_dest(&mut dbf);
    let mut record = shapefile::dbase::Record::default();
    record.insert("natural".into(), shapefile::dbase::FieldValue::Character(Some("wood".into())));
    table.write_record(&record).unwrap();
    drop(table);
    let (shp, dbf) = (shp.into_inner(), dbf.into_inner());
    let content = features::read(&shp, Some(&dbf), None).unwrap();
    assert_eq!(content.features[0].tags.get("natural"), Some("wood"));
    assert!(features::read(&shp, None, Some("PROJCS[\"UTM\"]")).is_err());
    assert_eq!(features::read(&shp, None, None).unwrap().features[0].note, Some("read without a .dbf"));
    let error = features::read(&gzip(&shp), Some(&dbf), None).unwrap_err().to_string();
    assert!(error.contains("outside a gzip"), "{error}");
    fuzz("shapefile", &shp, Some(&dbf), 1_000);
}

/// Three square kilometres with a table of one column, and the bytes of both.
fn shapes_and_table(column: &str, values: [&str; 3]) -> (Vec<u8>, Vec<u8>) {
    let mut shp = Cursor::new(Vec::new());
    let mut writer = shapefile::ShapeWriter::new(&mut shp);
    for at in 0..3 {
        let west = 78.0 + 0.1 * f64::from(at);
        let ring =
            [(0.0, 0.0), (0.0, 0.05), (0.05, 0.05), (0.0, 0.0)].map(|(x, y)| shapefile::Point::new(west + x, 42.0 + y));
        writer.write_shape(&shapefile::Polygon::new(shapefile::PolygonRing::Outer(ring.to_vec()))).unwrap();
    }
    writer.finalize().unwrap();
    drop(writer);
    let mut dbf = Cursor::new(Vec::new());
    let builder = shapefile::dbase::TableWriterBuilder::new();
    let mut table = builder.add_character_field(column.try_into().unwrap(), 20).build_with_dest(&mut dbf);
    for value in values {
        let mut record = shapefile::dbase::Record::default();
        record.insert(column.into(), shapefile::dbase::FieldValue::Character(Some(value.into())));
        table.write_record(&record).unwrap();
    }
    drop(table);
    (shp.into_inner(), dbf.into_inner())
}

#[test]
fn a_row_belongs_to_its_shape() {
    let (shp, dbf) = shapes_and_table("natural", ["wood", "sand", "scrub"]);
    let told = |dbf: &[u8]| -> Vec<String> {
        let content = features::read(&shp, Some(dbf), None).unwrap();
        content.features.iter().map(|feature| feature.tags.get("natural").unwrap_or_default().to_owned()).collect()
    };
    assert_eq!(told(&dbf), ["wood", "sand", "scrub"]);
    // The first is marked as deleted: its shape is there, and so is what the row says of it.
    let head = usize::from(u16::from_le_bytes([dbf[8], dbf[9]]));
    let mut marked = dbf.clone();
    assert_eq!(marked[head], b' ');
    marked[head] = b'*';
    assert_eq!(told(&marked), ["wood", "sand", "scrub"]);
    let mut short = dbf.clone();
    short[4] = 2;
    let error = features::read(&shp, Some(&short), None).unwrap_err().to_string();
    assert!(error.contains("3 rows in the .dbf"), "{error}");
}

#[test]
fn only_an_outline_that_says_nothing_is_a_lake() {
    use terrain::bake::features::{RawFeature, place};
    let projection = terrain::Projection::new(terrain::Geodetic::from_degrees(42.0, 78.1)).unwrap();
    let grid = terrain::Grid::centred(200.0, 4, 4).unwrap();
    let waters = |features: &[RawFeature]| {
        let placed = place(features, &projection, &grid);
        (placed.waters.len(), placed.counts.described())
    };
    let json = |properties: &str| {
        let text = format!(
            r#"{{"type":"FeatureCollection","features":[{{"type":"Feature","properties":{properties},"geometry":
            {{"type":"Polygon","coordinates":[[[78.0,42.0],[78.05,42.0],[78.05,42.05],[78.0,42.0]]]}}}}]}}"#
        );
        waters(&features::read(text.as_bytes(), None, None).unwrap().features).0
    };
    for lake in [
        "null",
        "{}",
        r#"{"name":"A","level_m":9,"fid":3,"region":"alps","OSM_ID":"7","boundary":null}"#,
        r#"{"natural":"water"}"#,
    ] {
        assert_eq!(json(lake), 1, "{lake}");
    }
    for other in [
        r#"{"boundary":"x"}"#,
        r#"{"place":"town","name":"A"}"#,
        r#"{"featurecla":"Land"}"#,
        r#"{"fclass":"military"}"#,
    ] {
        assert_eq!(json(other), 0, "{other}");
    }
    let (shp, dbf) = shapes_and_table("fclass", ["water", "forest", "nature_reserve"]);
    let (number, counts) = waters(&features::read(&shp, Some(&dbf), None).unwrap().features);
    assert_eq!((number, counts["forests"].kept, counts["others"].skipped_for["no kind that is drawn"]), (1, 1, 1));
    let (shp, dbf) = shapes_and_table("name", ["A", "B", ""]);
    assert_eq!(waters(&features::read(&shp, Some(&dbf), None).unwrap().features).0, 3);
    let (number, counts) = waters(&features::read(&shp, None, None).unwrap().features);
    assert_eq!((number, counts["lakes"].notes["read without a .dbf"]), (3, 3));
}

#[test]
fn what_lies_beside_a_shapefile_is_found_or_missed_aloud() {
    use terrain::bake::Input;
    let folder = std::env::temp_dir().join(format!("poligon-beside-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (shp, dbf) = shapes_and_table("natural", ["wood", "sand", "scrub"]);
    let path = folder.join("AREAS.SHP");
    std::fs::write(&path, &shp).unwrap();
    std::fs::write(folder.join("AREAS.DBF"), &dbf).unwrap();
    let read = |path: &Path| features::open(&Input::File(path.into()));
    assert_eq!(read(&path).unwrap().features[1].tags.get("natural"), Some("sand"));
    std::fs::write(folder.join("AREAS.PRJ"), "PROJCS[\"UTM\"]").unwrap();
    assert!(read(&path).unwrap_err().to_string().contains("PROJCS"));
    std::fs::remove_file(folder.join("AREAS.PRJ")).unwrap();
    // A folder is no table.
    std::fs::create_dir(folder.join("AREAS.dbf")).unwrap();
    assert!(read(&path).is_err());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn real_files_damaged() {
    if let Some(pbf) = shared("tests/osm/andorra-20130528.osm.pbf") {
        fuzz("OSM PBF", &pbf, None, 150);
    }
    if let Some(xml) = shared("tests/osm/monaco.osm.gz") {
        fuzz("OSM XML in a gzip", &xml, None, 60);
    }
    if let Some(shp) = shared("tests/gis/ne_10m_lakes.shp") {
        fuzz("shapefile of lakes", &shp, None, 150);
    }
}
