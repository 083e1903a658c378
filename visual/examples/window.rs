//! Opens a window with sky and text; shows the last key and the frame time. Escape or the close button ends it.

use glam::{DVec3, Vec2};
use std::time::Instant;
use visual::camera::View;
use visual::passes::lines::{Align, text};
use visual::window::{self, Call, Event, Flow};
use visual::{Frame, Renderer, Scene, Settings};

fn main() -> Result<(), window::WindowError> {
    let start = Instant::now();
    let mut renderer = None;
    let mut last_key = String::from("none");
    let (mut turn_rad, mut frames, mut size) = (0.0_f64, 0_u32, [0, 0]);
    window::run("sky", [1280, 720], |call| {
        match call {
            Call::Ready { gpu, format, size_px, scale_factor } => {
                eprintln!("{} ({}), {format:?}, {size_px:?}, scale {scale_factor}", gpu.report.name, gpu.report.kind);
                renderer =
                    Some(Renderer::new(gpu, format, Settings { sky_in_background: true, ..Settings::default() }));
            }
            Call::Event(event) => {
                eprintln!("{event:?}");
                match event {
                    Event::CloseRequested => return Ok(Flow::Close),
                    Event::Key { name, down: true, .. } => match name.as_str() {
                        "Escape" => return Ok(Flow::Close),
                        "ArrowLeft" => turn_rad -= 0.1,
                        "ArrowRight" => turn_rad += 0.1,
                        _ => last_key = name,
                    },
                    _ => {}
                }
            }
            Call::Frame { gpu, target, size_px, .. } => {
                frames += 1;
                size = size_px;
                let mean_ms = start.elapsed().as_secs_f64() * 1e3 / f64::from(frames);
                let attitude = terrain::frame::attitude(turn_rad, 0.1, 0.0);
                let words = format!("key {last_key}, {} x {}, {mean_ms:.1} ms", size[0], size[1]);
                let hud = text(&words, Vec2::new(40.0, 60.0), 18.0, Align::Left, [0.25, 1.0, 0.35, 1.0]);
                let sun_direction = terrain::frame::direction(0.3, 0.3);
                let frame = Frame {
                    scene: Scene { sun_direction, ..Scene::default() },
                    views: vec![View::fov_y(DVec3::new(0.0, 2e3, 0.0), attitude, 1.05, size_px)],
                    hud,
                };
                if let Some(renderer) = &mut renderer {
                    renderer.render(gpu, &frame, &[target], |_, _, _| ())?;
                }
            }
        }
        Ok(Flow::Continue)
    })
}
