//! `poligon verify`: cracks, near = ground, the far error and the pop, proven on this world.

use crate::args::VerifyArgs;
use crate::failure::Failure;
use crate::gpu_proof::{self, Subject};
use crate::open_world;
use crate::output::{self, Output};
use crate::progress::Progress;
use crate::report;
use crate::scenery;
use glam::{DVec2, DVec3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use terrain::block::{Landscape, Rings};
use terrain::store::World;
use terrain::verify::cracks::{self, Cracks, Sheet};
use terrain::verify::far;
use terrain::verify::flight::Flight;
use terrain::verify::near::Near;
use terrain::verify::overlay;
use terrain::verify::pop::{self, Pop};
use visual::Scene;
use visual::passes::terrain::eye_uniforms;

/// Blocks along the window that is proven: the default.
const WINDOW: u32 = 24;

/// Random eyes whose windows are laid out.
const EYES: usize = 100;

/// Length of each of the two tracks, metres.
const TRACK_M: f64 = 100_000.0;

/// A frame's flight, metres: at 60 frames a second, 5 m is 300 m/s; five frames are taken as one.
const STEP_M: f64 = 25.0;
const SPEED_MPS: f64 = 300.0;

/// What is promised of a switch: pixels, and grey of 255.
const POP_PX: f64 = 1.0;
const POP_GREY: f64 = 2.0;

/// Share of pixels that may lie on silhouettes.
const EXCLUDED: f64 = 0.02;

/// Most blocks whose overlays are looked at.
const OVERLAY_BLOCKS: usize = 600;

/// What is draped may be off the ground by the rounding of its height: half an ulp of an f32 at 16 km at most, metres.
const DRAPED_M: f64 = 0.001;

/// Where the post step is no whole number of metres, places and so heights are rounded: by this at most, metres.
const ROUNDING_M: f64 = 1e-9;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &VerifyArgs, output: Output) -> Result<(), Failure> {
    let world = Arc::new(open_world::open(args.world.as_deref())?);
    let rings = Rings::new(world.field.grid(), WINDOW, 1.0);
    let landscape = open_world::landscape(&world, &rings);
    let mut report = report::Verify::default();

    random_windows(&landscape, &rings, &mut report);
    {
        let _bar = Progress::new("far error of every block");
        let far = far::prove(&landscape);
        report.far = report::Far {
            error_max_m: far.errors_max_m.into_iter().fold(0.0, f64::max),
            errors_max_m: far.errors_max_m.to_vec(),
            limits_m: rings.limits_m.to_vec(),
            violations: far.violations,
        };
    }
    if terrain::block::overlay::any(&landscape.features, &landscape.lakes) {
        let bar = Progress::new("what is draped on the ground");
        report.overlay = Some(overlay::look(&landscape, OVERLAY_BLOCKS, |share| bar.show(share)).into());
    }
    let pops = flights(&landscape, &rings, &mut report);
    let due = picture(&world, landscape, rings, &pops, &mut report)?;

    output.print(&report)?;
    let broken = broken(&report, due);
    if broken.is_empty() { Ok(()) } else { Err(Failure::Failed(format!("not proven: {}", broken.join("; ")))) }
}

/// How much the proofs on a device must have looked at: one that looked at nothing proves nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Due {
    /// Pixels of depth; 0 over void alone.
    pixels: u64,
    /// Whether a switch moved a surface in sight.
    switch: bool,
}

/// What was promised and does not hold, in words.
fn broken(report: &report::Verify, due: Due) -> Vec<String> {
    let mut broken = Vec::new();
    let mut promise = |holds: bool, sentence: String| {
        if !holds {
            broken.push(sentence);
        }
    };
    promise(report.t_junctions == 0, format!("expected no T-junction, found {}", report.t_junctions));
    promise(
        report.position_mismatches == 0,
        format!("expected shared vertices equal to the bit, found {} that are not", report.position_mismatches),
    );
    let far = &report.far;
    promise(
        far.violations == 0,
        format!(
            "expected every far block within its ring's limit, found {} beyond, worst {} m",
            far.violations, far.error_max_m
        ),
    );
    let pop = &report.pop;
    promise(pop.max_px <= POP_PX, format!("expected a switch to move at most {POP_PX} px, found {}", pop.max_px));
    if let Some(grey) = pop.max_grey {
        promise(grey <= POP_GREY, format!("expected a switch to change at most {POP_GREY} of 255 grey, found {grey}"));
    }
    let near = &report.near;
    promise(
        near.height_changes == 0,
        format!("expected nothing near to change while the eye moves, found {} changes", near.height_changes),
    );
    promise(
        near.max_difference_m <= ROUNDING_M,
        format!("expected the near surface to be the ground, found {} m between them", near.max_difference_m),
    );
    if let Some(draped) = &report.overlay {
        promise(
            draped.t_junctions == 0 && draped.border_mismatches == 0 && draped.crossings == 0,
            format!(
                "expected what is draped to have no seam, found {} T-junctions, {} differences at borders, {} triangles \
                 across an edge of the ground",
                draped.t_junctions, draped.border_mismatches, draped.crossings
            ),
        );
        promise(
            draped.max_height_error_m <= DRAPED_M,
            format!("expected what is draped within {DRAPED_M} m of the ground, found {}", draped.max_height_error_m),
        );
    }
    if let Some(gpu) = &report.gpu {
        promise(
            gpu.pixels_checked >= due.pixels,
            format!("expected at least {} pixels compared with the ground, found {}", due.pixels, gpu.pixels_checked),
        );
        promise(
            gpu.vertices_checked > 0 || due.pixels == 0,
            "expected vertices on the device to compare, found none".to_owned(),
        );
        promise(
            report.pop.grey_switches > Some(0) || !due.switch,
            "expected a switch in sight to show in the picture, found none that does".to_owned(),
        );
        promise(
            gpu.height_mismatches == 0 && gpu.position_mismatches == 0,
            format!(
                "expected the device's posts equal to the bit, found {} heights and {} positions that are not",
                gpu.height_mismatches, gpu.position_mismatches
            ),
        );
        promise(
            gpu.pixels_outside == 0,
            format!("expected every near pixel's depth on the ground, found {} outside", gpu.pixels_outside),
        );
        let all = (gpu.pixels_checked + gpu.pixels_excluded) as f64;
        promise(
            gpu.pixels_excluded as f64 <= EXCLUDED * all,
            format!(
                "expected at most {} % of pixels on silhouettes, found {} of {all}",
                100.0 * EXCLUDED,
                gpu.pixels_excluded
            ),
        );
    }
    broken
}

/// Templates, pairs, and the windows of random eyes: over the world, above and below it, and some way off it.
fn random_windows(landscape: &Landscape, rings: &Rings, report: &mut report::Verify) {
    let grid = *landscape.ground.field().grid();
    let (templates, pairs) = (cracks::templates().0, cracks::pairs().0);
    let mut rng = StdRng::seed_from_u64(1);
    let mut along = |low_m: f64, high_m: f64| {
        let off_m = 0.1 * (high_m - low_m);
        rng.random_range(low_m - off_m..high_m + off_m)
    };
    let eyes: Vec<DVec3> = (0..EYES)
        .map(|_| {
            DVec3::new(along(grid.west_m, grid.east_m()), along(-500.0, 12_000.0), along(grid.north_m, grid.south_m()))
        })
        .collect();
    let bar = Progress::new("cracks");
    let done = AtomicU64::new(0);
    let next = AtomicU64::new(0);
    let threads = std::thread::available_parallelism().map_or(1, |cores| cores.get().min(16));
    let work = || {
        let mut sum = Cracks::default();
        while let Some(eye_m) = eyes.get(next.fetch_add(1, Ordering::Relaxed) as usize) {
            sum = sum.and(cracks::window(landscape, rings, WINDOW, *eye_m, eye_uniforms));
            bar.show((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / EYES as f64);
        }
        sum
    };
    let windows = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        // A worker that panicked has found something very wrong.
        let wrong = Cracks { t_junctions: 1, ..Cracks::default() };
        workers.into_iter().map(|worker| worker.join().unwrap_or(wrong)).fold(Cracks::default(), Cracks::and)
    });
    report.edges_checked =
        report::EdgesChecked { templates: templates.edges, pairs: pairs.edges, window: windows.edges };
    let all = templates.and(pairs).and(windows);
    report.t_junctions = all.t_junctions;
    report.position_mismatches = all.position_mismatches;
    report.eyes = EYES as u64;
}

/// Two tracks and a random walk, with pops, near ground and cracks looked at on the way.
fn flights(landscape: &Arc<Landscape>, rings: &Rings, report: &mut report::Verify) -> Vec<Pop> {
    let area = landscape.ground.whole();
    let grid = *area.grid();
    let mut near = Near::new(area.clone());
    let mut pops = Vec::new();
    let over = |at: DVec2, above_m: f64| DVec3::new(at.x, area.height_m(at.x, at.y).unwrap_or(0.0) + above_m, at.y);

    let middle = DVec2::new(grid.west_m + grid.east_m(), grid.north_m + grid.south_m()) * 0.5;
    let highest = highest(landscape).unwrap_or(middle);
    let diagonal = DVec2::splat(0.5f64.sqrt() * 0.5 * TRACK_M);
    let east = DVec2::new(0.5 * TRACK_M, 0.0);
    let tracks = [(middle - diagonal, middle + diagonal, 1_500.0), (highest - east, highest + east, 150.0)];
    let bar = Progress::new("flying 100 km twice, and astray");
    for (number, (from, to, above_m)) in tracks.into_iter().enumerate() {
        let mut flight = Flight::new(landscape.clone(), *rings, WINDOW);
        let track = pop::line(from, to, STEP_M);
        // The first update fills the window by distance alone, the second brings the margins of flight: no one sees it.
        flight.fly_to(from, SPEED_MPS);
        flight.fly_to(from, SPEED_MPS);
        for (at, eye) in track.iter().enumerate() {
            let eye_m = over(*eye, above_m);
            pops.extend(pop::step(&mut flight, eye_m, SPEED_MPS));
            near.look(&flight, *eye, if at % 50 == 0 { 4 } else { 0 });
            if at % 200 == 0 {
                lay_out(&flight, eye_m, report);
                bar.show((number as f64 + at as f64 / track.len() as f64) / 3.0);
            }
        }
        report.pop.track_km += (to - from).length() * 1e-3;
    }
    astray(landscape, rings, middle, &mut near, report);

    report.pop.switches = pops.len() as u64;
    report.pop.max_px = pops.iter().map(|pop| pop.px).fold(0.0, f64::max);
    report.pop.max_move_m = pops.iter().map(|pop| pop.move_m).fold(0.0, f64::max);
    report.near = report::Near {
        height_changes: near.height_changes,
        max_difference_m: near.max_difference_m,
        places: near.places,
    };
    pops
}

/// A random walk about a corner of four blocks, at all speeds and with jumps.
fn astray(landscape: &Arc<Landscape>, rings: &Rings, middle: DVec2, near: &mut Near, report: &mut report::Verify) {
    let grid = *landscape.ground.field().grid();
    let corner = grid.block_at(middle.x, middle.y);
    let start = DVec2::new(grid.x_m(corner.first_column()), grid.z_m(corner.first_row()));
    let mut rng = StdRng::seed_from_u64(3);
    let mut flight = Flight::new(landscape.clone(), *rings, WINDOW);
    let (mut eye, mut heading_rad, mut speed_mps) = (start, 0.0f64, 300.0);
    for step in 0..1_500 {
        if step % 100 == 0 {
            heading_rad = rng.random_range(0.0..std::f64::consts::TAU);
            speed_mps = 10f64.powf(rng.random_range(0.5..3.5));
            if step % 300 == 0 {
                eye = start + DVec2::from_angle(heading_rad) * rng.random_range(0.0..2.5) * grid.block_m();
            }
        }
        eye += DVec2::from_angle(heading_rad) * speed_mps / 60.0;
        flight.fly_to(eye, speed_mps);
        // After a jump the window fills within its budget; until then the picture is known to be incomplete.
        for _ in 0..100 {
            if step % 300 != 0 || (flight.window().late_blocks() == 0 && !flight.window().is_jumping()) {
                break;
            }
            flight.fly_to(eye, 0.0);
        }
        near.look(&flight, eye, if step % 50 == 0 { 4 } else { 0 });
        if step % 150 == 0 {
            lay_out(&flight, DVec3::new(eye.x, 2_000.0, eye.y), report);
        }
    }
}

/// Looks for cracks in a window as it is drawn.
fn lay_out(flight: &Flight, eye_m: DVec3, report: &mut report::Verify) {
    let window = flight.window();
    let field = window.landscape().ground.field();
    let mut sheet = Sheet::new(field, window.origin(), window.settings().blocks, eye_m, eye_uniforms);
    for draw in flight.draws() {
        match flight.drawn(&draw) {
            Some(piece) => sheet.add(piece),
            None => report.t_junctions += 1,
        }
    }
    let cracks = sheet.check();
    report.edges_checked.window += cracks.edges;
    report.t_junctions += cracks.t_junctions;
    report.position_mismatches += cracks.position_mismatches;
    report.eyes += 1;
}

fn highest(landscape: &Landscape) -> Option<DVec2> {
    let field = landscape.ground.field();
    let grid = field.grid();
    let heights = field.heights_m();
    let heights = heights.iter().enumerate().filter(|(_, h)| !h.is_nan());
    let (at, _) = heights.max_by(|a, b| a.1.total_cmp(b.1))?;
    let columns = grid.columns() as usize;
    Some(DVec2::new(grid.x_m((at % columns) as i64), grid.z_m((at / columns) as i64)))
}

/// The proofs on a device, where there is one, and what they must have looked at.
fn picture(
    world: &World,
    landscape: Arc<Landscape>,
    rings: Rings,
    pops: &[Pop],
    report: &mut report::Verify,
) -> Result<Due, Failure> {
    let Some(gpu) = gpu_proof::device() else { return Ok(Due::default()) };
    let scene = Scene {
        sun_direction: scenery::to_sun(world, scenery::default_moment(world))?,
        moon_direction: None,
        visibility_m: f64::MAX,
        haze_base_m: world.info.statistics.min_m.max(0.0),
        ..Scene::default()
    };
    let subject = Subject { landscape, rings, blocks: WINDOW, scene };
    let bar = Progress::new("pictures");
    let found = gpu_proof::prove(&gpu, &subject, pops, &|share| bar.show(share))
        .map_err(|error| Failure::while_doing("verifying the picture", error))?;
    report.pop.grey_switches = Some(found.grey_switches);
    report.pop.max_grey = Some(found.grey);
    report.pop.max_grey_any = Some(found.grey_any);
    report.pop.worst_pixel_grey = Some(found.grey_worst_pixel);
    report.gpu = Some(report::Gpu {
        vertices_checked: found.heights.vertices_checked,
        height_mismatches: found.heights.height_mismatches,
        position_mismatches: found.heights.position_mismatches,
        pixels_checked: found.depths.pixels_checked,
        pixels_outside: found.depths.pixels_outside,
        pixels_excluded: found.depths.pixels_excluded,
    });
    let due = Due { pixels: gpu_proof::pixels_due(&world.field), switch: found.switches_in_sight > 0 };
    if found.depths.pixels_checked < gpu_proof::PIXELS && due.pixels < gpu_proof::PIXELS {
        output::tell(format_args!(
            "poligon: the world has less than a block of ground: {} pixels were compared with it, not {}",
            found.depths.pixels_checked,
            gpu_proof::PIXELS
        ));
    }
    Ok(due)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_proof_that_looked_at_nothing_is_none() {
        let seen = report::Gpu { vertices_checked: 1, pixels_checked: 10, ..report::Gpu::default() };
        let mut whole = report::Verify { gpu: Some(seen), ..report::Verify::default() };
        whole.pop.grey_switches = Some(1);
        let due = Due { pixels: 10, switch: true };
        assert_eq!(broken(&whole, due), [""; 0]);
        let blind = report::Verify { gpu: Some(report::Gpu::default()), ..report::Verify::default() };
        let words = broken(&blind, due);
        assert!(
            words.len() == 3 && words[0].contains("at least 10 pixels") && words[0].ends_with("found 0"),
            "{words:?}"
        );
        // Over void, and without an adapter, there is nothing to look at.
        assert_eq!(broken(&blind, Due::default()), [""; 0]);
        assert_eq!(broken(&report::Verify::default(), due), [""; 0]);
    }
}
