//! The pilot's head: where the view points beside the nose, and how it gets there.
//!
//! The head eases towards what is held and back; angles stay within what a neck allows, so a view built from them has
//! no pole.

use super::{Command, ViewLook};

/// How much of the way to its aim the head has left after a second: quick, without a jerk at the end.
const LEFT_AFTER_1_S: f64 = 1e-4;

/// The head's direction from the nose, radians.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Head {
    /// To the right positive.
    pub right_rad: f64,
    /// Up positive.
    pub up_rad: f64,
    aim: (f64, f64),
}

impl Head {
    /// Takes a command; others than looking are ignored.
    pub fn command(&mut self, command: Command) {
        self.aim = match command {
            Command::LookEnd | Command::Look(ViewLook::Ahead) => (0.0, 0.0),
            Command::Look(ViewLook::Left) => (-1.2, 0.0),
            Command::Look(ViewLook::Right) => (1.2, 0.0),
            Command::Look(ViewLook::Up) => (0.0, 0.8),
            Command::Look(ViewLook::Down) => (0.0, -0.6),
            Command::Look(ViewLook::Back) => (std::f64::consts::PI, 0.0),
            _ => self.aim,
        };
    }

    /// Turns the head at once, as a mouse does; radians. It stays until another command.
    pub fn turn(&mut self, right_rad: f64, up_rad: f64) {
        const MOST_RAD: (f64, f64) = (2.9, 1.3);
        if !(right_rad.is_finite() && up_rad.is_finite()) {
            return;
        }
        self.aim = (
            (self.right_rad + right_rad).clamp(-MOST_RAD.0, MOST_RAD.0),
            (self.up_rad + up_rad).clamp(-MOST_RAD.1, MOST_RAD.1),
        );
        (self.right_rad, self.up_rad) = self.aim;
    }

    /// Moves the head for `wall_s`; what is not a time counts as none.
    pub fn update(&mut self, wall_s: f64) {
        let dt_s = if wall_s.is_finite() { wall_s.max(0.0) } else { 0.0 };
        let left = LEFT_AFTER_1_S.powf(dt_s);
        let eased = |now: f64, aim: f64| {
            let next = aim + (now - aim) * left;
            // Close enough to rest: a view that never quite stops would never be still.
            if (next - aim).abs() < 1e-4 { aim } else { next }
        };
        self.right_rad = eased(self.right_rad, self.aim.0);
        self.up_rad = eased(self.up_rad, self.aim.1);
    }

    /// Whether the view lies along the nose.
    pub fn is_ahead(&self) -> bool {
        self.right_rad == 0.0 && self.up_rad == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_head_turns_holds_and_comes_to_rest_ahead() {
        let mut head = Head::default();
        head.command(Command::Look(ViewLook::Left));
        head.command(Command::Hud);
        for _ in 0..120 {
            head.update(1.0 / 60.0);
        }
        assert_eq!((head.right_rad, head.is_ahead()), (-1.2, false));
        head.command(Command::LookEnd);
        head.update(0.1);
        assert!(head.right_rad < 0.0 && head.right_rad > -1.2);
        head.update(f64::NAN);
        head.update(1e9);
        assert!(head.is_ahead());
        head.turn(0.5, -9.0);
        head.turn(f64::NAN, 0.0);
        head.update(10.0);
        assert_eq!((head.right_rad, head.up_rad), (0.5, -1.3), "a mouse's turn holds");
    }
}
