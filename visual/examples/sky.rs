//! Writes pictures of the sky from noon to night, with strokes and text over them, and says what a frame costs.
//!
//! `cargo run -p poligon-visual --example sky -- FOLDER`

use glam::{DVec3, Vec2};
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;
use visual::camera::View;
use visual::capture::{self, Offscreen, Picture};
use visual::passes::lines::{Align, Stroke, text};
use visual::{Frame, Gpu, Renderer, Scene, Settings};

const SIZE_PX: [u32; 2] = [1280, 720];
const GREEN: [f32; 4] = [0.25, 1.0, 0.35, 1.0];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "sky-pictures".into()));
    let gpu = Gpu::headless()?;
    println!("{} ({}, {})", gpu.report.name, gpu.report.backend, gpu.report.kind);
    let target = Offscreen::new(&gpu, SIZE_PX)?;

    let (mut air_ms, mut table_ms) = (f64::MAX, f64::MAX);
    for _ in 0..9 {
        let start = Instant::now();
        let air = visual::sky::Air::new(60_000.0, 1_600.0);
        air_ms = air_ms.min(start.elapsed().as_secs_f64() * 1e3);
        let start = Instant::now();
        std::hint::black_box(air.light(0.4, visual::moon::Moonlight::default(), 3_000.0));
        table_ms = table_ms.min(start.elapsed().as_secs_f64() * 1e3);
    }
    println!("least of 9: air {air_ms:.1} ms, sky table {table_ms:.1} ms");

    let cases = [
        ("noon", 62.0_f64, 60_000.0, 3_000.0),
        ("afternoon", 25.0, 60_000.0, 3_000.0),
        ("hazy", 25.0, 8_000.0, 1_800.0),
        ("low", 5.0, 60_000.0, 3_000.0),
        ("sunset", 0.5, 60_000.0, 3_000.0),
        ("dusk", -4.0, 60_000.0, 3_000.0),
        ("night", -25.0, 60_000.0, 3_000.0),
        ("high", 25.0, 60_000.0, 12_000.0),
    ];
    let mut pictures = Vec::new();
    let mut renderer = Renderer::new(&gpu, capture::FORMAT, Settings::default());
    for (name, sun_deg, visibility_m, altitude_m) in cases {
        let frame = frame(name, sun_deg, visibility_m, altitude_m);
        let start = Instant::now();
        renderer.render(&gpu, &frame, &[&target.view], |_, _, _| ())?;
        gpu.wait()?;
        let first_ms = start.elapsed().as_secs_f64() * 1e3;
        let picture = target.read(&gpu)?;
        picture.write_png(&folder.join(format!("{name}.png")))?;
        println!("{name:10} first frame {first_ms:6.1} ms  hash {:016x}", picture.hash());
        pictures.push(picture);
    }
    Picture::contact_sheet(&pictures, 2, 2).write_png(&folder.join("sheet.png"))?;

    for (name, settings) in [
        ("plain", Settings::default()),
        ("scale 0.67", Settings { render_scale: 0.67, ..Settings::default() }),
        ("msaa 4", Settings { msaa: 4, ..Settings::default() }),
    ] {
        let mut renderer = Renderer::new(&gpu, capture::FORMAT, settings);
        for (what, hud) in [("sky and lines", true), ("sky", false)] {
            let mut frame = frame("cost", 25.0, 60_000.0, 3_000.0);
            if !hud {
                frame.hud.clear();
            }
            let mut times_ms = Vec::new();
            for _ in 0..40 {
                let start = Instant::now();
                renderer.render(&gpu, &frame, &[&target.view], |_, _, _| ())?;
                gpu.wait()?;
                times_ms.push(start.elapsed().as_secs_f64() * 1e3);
            }
            times_ms.sort_by(f64::total_cmp);
            let median_ms = times_ms[times_ms.len() / 2];
            println!("{name:10} {what:14} median {median_ms:.2} ms a frame, least {:.2}", times_ms[0]);
            if hud {
                let file = format!("settings-{}.png", name.replace(' ', "-"));
                target.read(&gpu)?.write_png(&folder.join(file))?;
            }
        }
    }
    Ok(())
}

fn frame(name: &str, sun_deg: f64, visibility_m: f64, altitude_m: f64) -> Frame {
    let towards = terrain::frame::direction(0.35, sun_deg.to_radians());
    let attitude = terrain::frame::attitude(0.0, 8_f64.to_radians(), 0.12);
    let eye_m = DVec3::new(0.0, altitude_m, 0.0);
    Frame {
        scene: Scene { sun_direction: towards, visibility_m, haze_base_m: 1_600.0, ..Scene::default() },
        views: vec![View::fov_y(eye_m, attitude, 60_f64.to_radians(), SIZE_PX)],
        hud: display(name, sun_deg),
    }
}

fn display(name: &str, sun_deg: f64) -> Vec<Stroke> {
    let line = |points: &[(f32, f32)]| Stroke {
        points_px: points.iter().map(|&(x, y)| Vec2::new(x, y)).collect(),
        width_px: 1.6,
        colour: GREEN,
    };
    let mut strokes = vec![
        line(&[(600.0, 360.0), (625.0, 360.0), (640.0, 372.0), (655.0, 360.0), (680.0, 360.0)]),
        line(&[(300.0, 240.0), (300.0, 480.0)]),
    ];
    for tick in 0..13 {
        let y = 240.0 + 20.0 * tick as f32;
        strokes.push(line(&[(300.0, y), (if tick % 2 == 0 { 288.0 } else { 294.0 }, y)]));
    }
    let circle = (0..=48).map(|i| (i as f32 * std::f32::consts::TAU / 48.0).sin_cos());
    let circle: Vec<_> = circle.map(|(sin, cos)| (980.0 + 60.0 * cos, 360.0 + 60.0 * sin)).collect();
    strokes.push(line(&circle));
    let mut say = |words: &str, x, y, cap_px, align| strokes.extend(text(words, Vec2::new(x, y), cap_px, align, GREEN));
    say("ABCDEFGHIJKLMNOPQRSTUVWXYZ", 40.0, 60.0, 12.0, Align::Left);
    say("0123456789 +-./:% 42\u{b0}36'N ()[]<>=!?", 40.0, 90.0, 12.0, Align::Left);
    say("ALT 3000 M  SPD 250 KM/H", 40.0, 125.0, 18.0, Align::Left);
    say("small type, 8 px capitals: 16.7 ms 59 fps", 40.0, 150.0, 8.0, Align::Left);
    say(&format!("{name}: sun {sun_deg:.1}\u{b0}"), 640.0, 690.0, 14.0, Align::Middle);
    say("HDG 359\u{b0}", 1240.0, 60.0, 24.0, Align::Right);
    strokes
}
