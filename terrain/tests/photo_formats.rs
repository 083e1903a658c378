//! Photographs in files made here: what each kind of colours is read as, and hostile bytes.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use terrain::bake::photo::read;
use tiff::encoder::TiffEncoder;
use tiff::tags::Tag;

const SIDE: u32 = 16;

/// What a TIFF says of its samples.
struct Samples<'a> {
    photometric: u16,
    bands: u16,
    /// One for each band beyond those of `photometric`.
    extra: &'a [u16],
    no_data: Option<&'a str>,
    /// 1 is none, 7 JPEG.
    compression: u16,
    strip: &'a [u8],
}

impl Samples<'_> {
    /// A GeoTIFF of 16 by 16 pixels in one strip.
    fn tiff(&self) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
        let mut tags = encoder.image_directory().unwrap();
        let at = tags.write_data(self.strip).unwrap();
        for (tag, value) in [(Tag::ImageWidth, SIDE), (Tag::ImageLength, SIDE), (Tag::RowsPerStrip, SIDE)] {
            tags.write_tag(tag, value).unwrap();
        }
        tags.write_tag(Tag::BitsPerSample, &vec![8_u16; usize::from(self.bands)][..]).unwrap();
        tags.write_tag(Tag::Compression, self.compression).unwrap();
        tags.write_tag(Tag::PhotometricInterpretation, self.photometric).unwrap();
        tags.write_tag(Tag::StripOffsets, at as u32).unwrap();
        tags.write_tag(Tag::SamplesPerPixel, self.bands).unwrap();
        tags.write_tag(Tag::StripByteCounts, self.strip.len() as u32).unwrap();
        if !self.extra.is_empty() {
            tags.write_tag(Tag::ExtraSamples, self.extra).unwrap();
        }
        if self.photometric == 6 {
            tags.write_tag(Tag::ChromaSubsampling, &[1_u16, 1][..]).unwrap();
        }
        if let Some(text) = self.no_data {
            tags.write_tag(Tag::GdalNodata, text).unwrap();
        }
        tags.write_tag(Tag::ModelPixelScaleTag, &[0.01_f64, 0.01, 0.0][..]).unwrap();
        tags.write_tag(Tag::ModelTiepointTag, &[0.0_f64, 0.0, 0.0, 10.0, 50.0, 0.0][..]).unwrap();
        let keys: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326];
        tags.write_tag(Tag::GeoKeyDirectoryTag, &keys[..]).unwrap();
        tags.finish().unwrap();
        bytes.into_inner()
    }
}

/// Samples of all pixels: the first ones, then others.
fn pixels(first: &[u8], others: &[u8]) -> Vec<u8> {
    [first, &others.repeat((SIDE * SIDE) as usize - first.len() / others.len())].concat()
}

fn plain<'a>(photometric: u16, bands: u16, extra: &'a [u16], strip: &'a [u8]) -> Samples<'a> {
    Samples { photometric, bands, extra, no_data: None, compression: 1, strip }
}

/// A JPEG of one colour but for a square of another, as luminance and colour differences.
fn jpeg() -> Vec<u8> {
    let picture =
        image::RgbImage::from_fn(SIDE, SIDE, |x, _| image::Rgb(if x < 8 { [200, 30, 40] } else { [10, 90, 220] }));
    let mut bytes = Cursor::new(Vec::new());
    picture.write_with_encoder(image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100)).unwrap();
    bytes.into_inner()
}

#[test]
fn colours_are_what_the_file_says_they_are() {
    let first = |samples: &Samples| read(&samples.tiff(), None).unwrap().pixels[0];
    assert_eq!(first(&plain(2, 3, &[], &pixels(&[], &[10, 20, 30]))), [10, 20, 30, 255]);
    assert_eq!(first(&plain(2, 4, &[2], &pixels(&[], &[10, 20, 30, 40]))), [10, 20, 30, 40]);
    // Infrared is no alpha.
    let strip = pixels(&[10, 20, 30, 40, 50, 60, 70, 80], &[1, 2, 3, 4]);
    let infrared = read(&plain(2, 4, &[0], &strip).tiff(), None).unwrap();
    assert_eq!(infrared.pixels[..3], [[10, 20, 30, 255], [50, 60, 70, 255], [1, 2, 3, 255]]);
    // Pure red is (76, 85, 255) by JFIF, and grey has both differences at 128.
    assert_eq!(first(&plain(6, 3, &[], &pixels(&[], &[76, 85, 255]))), [254, 0, 0, 255]);
    assert_eq!(first(&plain(6, 3, &[], &pixels(&[], &[90, 128, 128]))), [90, 90, 90, 255]);
    // As JPEG: within the rounding of both conversions and of the coefficients, some 2 each.
    let packed = Samples { compression: 7, ..plain(6, 3, &[], &jpeg()) }.tiff();
    let photo = read(&packed, None).unwrap();
    for (at, expected) in [(0, [200, 30, 40]), (15, [10, 90, 220])] {
        let near = photo.pixels[at][..3].iter().zip(expected).all(|(c, e): (&u8, u8)| c.abs_diff(e) <= 6);
        assert!(near, "{:?} for {expected:?}", photo.pixels[at]);
    }
}

#[test]
fn no_data_shows_nothing_and_other_colours_are_refused() {
    let strip = pixels(&[0, 0, 0, 0, 0, 9], &[10, 20, 30]);
    let alpha = |no_data| {
        let photo = read(&Samples { no_data, ..plain(2, 3, &[], &strip) }.tiff(), None).unwrap();
        [photo.pixels[0][3], photo.pixels[1][3], photo.pixels[2][3]]
    };
    assert_eq!(alpha(Some("0")), [0, 255, 255]);
    assert_eq!(alpha(Some("-9999")), [255; 3]);
    assert_eq!(alpha(None), [255; 3]);
    let print = pixels(&[], &[1, 2, 3, 4]);
    for (photometric, bands, what) in [(5, 4, "CMYK"), (1, 1, "Gray")] {
        let error = read(&plain(photometric, bands, &[], &print).tiff(), None).unwrap_err().to_string();
        assert!(error.contains("perhaps alpha of 8 bits") && error.contains(what), "{error}");
    }
}

#[test]
fn damaged_photographs_are_errors() {
    let mut png = Cursor::new(Vec::new());
    image::RgbImage::from_fn(SIDE, SIDE, |x, y| image::Rgb([x as u8, y as u8, 7]))
        .write_to(&mut png, image::ImageFormat::Png)
        .unwrap();
    let jpeg = jpeg();
    let files = [
        ("GeoTIFF", plain(2, 4, &[2], &pixels(&[], &[10, 20, 30, 40])).tiff()),
        ("GeoTIFF of JPEG", Samples { compression: 7, no_data: Some("0"), ..plain(6, 3, &[], &jpeg) }.tiff()),
        ("PNG", png.into_inner()),
        ("JPEG", jpeg.clone()),
    ];
    for (what, valid) in files {
        let answer = |bytes: &[u8], case: &str| {
            let world_file = Some("0.01 0 0 -0.01 10 50");
            match catch_unwind(AssertUnwindSafe(|| read(bytes, world_file))) {
                Ok(Ok(photo)) => {
                    assert_eq!(photo.pixels.len(), photo.place.columns * photo.place.rows, "{what} {case}")
                }
                Ok(Err(error)) => assert!(!error.to_string().is_empty()),
                Err(_) => panic!("{what}, {case}: the reader panicked"),
            }
        };
        assert!(read(&valid, Some("0.01 0 0 -0.01 10 50")).is_ok(), "{what}");
        (0..valid.len()).for_each(|cut| answer(&valid[..cut], &format!("cut at {cut}")));
        for seed in 0..3_000 {
            let mut rng = StdRng::seed_from_u64(seed);
            let mut bytes = valid.clone();
            for _ in 0..rng.random_range(1..5) {
                let at = rng.random_range(0..bytes.len());
                match rng.random_range(0..4) {
                    0 => bytes[at] ^= 1 << rng.random_range(0..8),
                    1 => bytes[at] = rng.random(),
                    2 => bytes[at] = 0xff,
                    _ => bytes.truncate(at.max(8)),
                }
            }
            answer(&bytes, &format!("seed {seed}"));
        }
    }
}
