//! Lists the sticks of this machine and prints what they command for some seconds: `cargo run --example sticks -- 5`.

use sim::input::joystick::Joystick;
use std::time::{Duration, Instant};

fn main() {
    let seconds = std::env::args().nth(1).and_then(|s| s.parse().ok()).filter(|s: &f64| (0.0..3_600.0).contains(s));
    let mut joystick = match Joystick::open() {
        Ok(joystick) => joystick,
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(1);
        }
    };
    for device in joystick.devices() {
        println!("device {device}");
    }
    let (start, mut before) = (Instant::now(), None);
    while start.elapsed() < Duration::from_secs_f64(seconds.unwrap_or(5.0)) {
        for command in joystick.poll() {
            println!("command {command}");
        }
        let axes = joystick.bindings().axes();
        if before != Some(axes) {
            println!(
                "axes roll {:?} pitch {:?} yaw {:?} throttle {:?}",
                axes.roll, axes.pitch, axes.yaw, axes.throttle
            );
            before = Some(axes);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}
