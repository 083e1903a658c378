//! Flies an embedded situation by its script over the embedded world and prints where it is: `cargo run --example fly_script -- circuit 400`.

use sim::SceneGround;
use sim::situation::Situation;

fn main() {
    let name = std::env::args().nth(1).unwrap_or_else(|| "circuit".to_owned());
    let seconds: u32 = std::env::args().nth(2).and_then(|s| s.parse().ok()).unwrap_or(300);
    let world = match terrain::bake::default_world(&mut |_, _| {}) {
        Ok(baked) => baked.world,
        Err(error) => return eprintln!("{error}"),
    };
    let ground = SceneGround::from(terrain::Ground::new(world.field.clone()).whole());
    let read = if name.ends_with(".toml") { Situation::read(name.as_ref()) } else { Situation::builtin(&name) };
    let scene = read.and_then(|of| of.scene(&world, sim::UtcTime { unix_ns: 0 }, 120, Default::default(), true));
    let mut scene = match scene {
        Ok(scene) => scene,
        Err(error) => return eprintln!("{error}"),
    };
    let from_m = scene.aircraft().position_m;
    for target in scene.snapshot().targets.iter() {
        let at = target.position_m - from_m;
        println!("target {:?} x {:8.1} z {:8.1} height {:7.1}", target.id, at.x, at.z, target.position_m.y);
    }
    for second in 0..seconds {
        let now = sim::lockstep(&mut scene, &ground, 120);
        let own = &now.aircraft;
        let (at, angles) = (own.position_m - from_m, own.angles());
        println!(
            "{second:4} x {:8.1} z {:8.1} alt {:7.1} agl {:6.1} v {:5.1} vs {:5.2} hdg {:6.1} pitch {:5.1} roll {:5.1} thr {:.2} rpm {:4.0} {:?}",
            at.x,
            at.z,
            own.position_m.y,
            now.height_above_ground_m.unwrap_or(f64::NAN),
            own.airspeed_mps,
            own.velocity_mps.y,
            angles.heading_rad.to_degrees(),
            angles.pitch_rad.to_degrees(),
            angles.roll_rad.to_degrees(),
            own.throttle,
            now.instruments.map_or(0.0, |of| of.rpm[0]),
            own.condition
        );
        if let Some(Ok(found)) = now.weapons.as_ref().map(|page| page.ccip) {
            let nearest = now.targets.iter().map(|target| (target.position_m.distance(found.point_m), target.id));
            let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
            let at = found.point_m - from_m;
            println!("     ccip {:.1} s at {:.0} {:.0}, nearest target {nearest:?}", found.time_s, at.x, at.z);
        }
        for event in now.events.iter().filter(|event| event.time_s > now.time_s - 1.0) {
            println!("     {:?}", event.what);
        }
    }
}
