//! The mouse: a stick while it flies, else a head that turns while its right button is held.
//!
//! Places are in halves of the window's height, right and down: 1 is a full deflection. Flying is taken up and given back by a
//! command; the stick is in the middle where the pointer is then, and where it is when looking about ends. The pointer is the
//! stick's top, seen from above: down is back. The wheel moves the throttle.
//!
//! Invariant others rely on: a mouse that does not fly moves no axis.

use super::Curve;

/// A wheel's line of throttle.
const THROTTLE_A_LINE: f64 = 0.04;
/// A middle that is easy to hold, and soft.
const CURVE: Curve = Curve { dead_zone: 0.04, softness: 0.5, inverted: false };

/// The mouse's state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mouse {
    at: [f64; 2],
    /// Where the stick is in the middle.
    origin: [f64; 2],
    flies: bool,
    looks: bool,
    turned: [f64; 2],
    throttle: f64,
}

impl Mouse {
    /// The pointer moved to a place; one that is not finite is none.
    pub fn moved(&mut self, right: f64, down: f64) {
        if !(right.is_finite() && down.is_finite()) {
            return;
        }
        if self.looks {
            self.turned[0] += right - self.at[0];
            self.turned[1] -= down - self.at[1];
        }
        self.at = [right, down];
    }

    /// The wheel turned, away positive.
    pub fn wheel(&mut self, lines: f64) {
        if self.flies && lines.is_finite() {
            self.throttle += lines.clamp(-10.0, 10.0) * THROTTLE_A_LINE;
        }
    }

    /// The button that looks went down or up.
    pub fn look(&mut self, down: bool) {
        (self.looks, self.turned, self.origin) = (down, [0.0; 2], self.at);
    }

    /// Takes up the stick or gives it back; gives whether it flies now.
    pub fn take_or_give_back(&mut self) -> bool {
        (self.flies, self.origin) = (!self.flies, self.at);
        self.flies
    }

    /// Lets go of everything, as when the window loses the focus.
    pub fn release(&mut self) {
        *self = Self { at: self.at, ..Self::default() };
    }

    /// Whether it flies.
    pub fn flies(&self) -> bool {
        self.flies
    }

    /// Pitch and roll as a stick has them, -1..1; nothing while the mouse looks about.
    pub fn stick(&self) -> [f64; 2] {
        if !self.flies || self.looks {
            return [0.0; 2];
        }
        let [roll, pitch] = [0, 1].map(|way| CURVE.apply(self.at[way] - self.origin[way]).unwrap_or(0.0));
        [pitch, roll]
    }

    /// How far the head was turned since the last call, right and up, in halves of the window's height.
    pub fn take_turn(&mut self) -> [f64; 2] {
        std::mem::take(&mut self.turned)
    }

    /// How far the throttle was moved since the last call.
    pub fn take_throttle(&mut self) -> f64 {
        std::mem::take(&mut self.throttle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pointer_is_the_stick_only_while_the_mouse_flies() {
        let mut mouse = Mouse::default();
        mouse.moved(0.5, 1.0);
        mouse.wheel(3.0);
        assert_eq!((mouse.stick(), mouse.take_throttle()), ([0.0; 2], 0.0));
        assert!(mouse.take_or_give_back());
        assert_eq!(mouse.stick(), [0.0; 2], "taken up in the middle");
        mouse.moved(1.0, 2.0);
        let [pitch, roll] = mouse.stick();
        assert_eq!(pitch, 1.0, "down is back");
        assert!(roll > 0.2 && roll < 0.5, "soft in the middle: {roll}");
        mouse.moved(f64::NAN, 0.0);
        mouse.moved(0.52, -7.0);
        assert_eq!(mouse.stick(), [-1.0, 0.0]);
        mouse.wheel(f64::INFINITY);
        mouse.wheel(-2.0);
        assert_eq!((mouse.take_throttle(), mouse.take_throttle()), (-0.08, 0.0));
        mouse.look(true);
        mouse.moved(0.9, 0.3);
        mouse.look(false);
        assert_eq!(mouse.stick(), [0.0; 2], "no jump after looking");
        mouse.release();
        assert_eq!((mouse.flies(), mouse.stick()), (false, [0.0; 2]));
    }

    #[test]
    fn the_head_turns_with_the_pointer_while_the_button_is_held() {
        let mut mouse = Mouse::default();
        mouse.moved(0.1, 0.1);
        mouse.look(true);
        mouse.moved(0.4, 0.0);
        let [right, up] = mouse.take_turn();
        assert!((right - 0.3).abs() < 1e-12 && (up - 0.1).abs() < 1e-12);
        mouse.look(false);
        mouse.moved(0.0, 0.0);
        assert_eq!(mouse.take_turn(), [0.0; 2]);
    }
}
