//! The weapon page at the lower right, and the sight: where a round or bomb released now would strike.
//!
//! The sight is conformal: the pipper lies where the point of impact is in the picture, and a line leads from it to where
//! the aircraft goes, along which a bomb falls. One that is out of the picture is shown at its edge, dashed.

use super::attitude::{focal, ring};
use super::numbers::{rounded, shown, tenth};
use super::sheet::{AMBER, DIM, GREEN, MEDIUM, SMALL, Sheet};
use super::{Anchor, HudInput};

/// A store and how many are left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Store<'a> {
    /// Its name.
    pub name: &'a str,
    /// Rounds or pieces left.
    pub left: u32,
}

/// Where the selected weapon strikes if it leaves now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sight<'a> {
    /// Nothing is asked: no weapon, or none that is aimed.
    Off,
    /// The point of impact from the eye, in view axes (x right, y up, z backward), metres, and the time to it, seconds.
    Impact {
        /// From the eye to it.
        in_view_m: [f64; 3],
        /// Time of flight, seconds.
        time_s: f64,
        /// Whether a release is safe and will arm.
        safe: bool,
    },
    /// Why there is no point of impact.
    None(&'a str),
}

/// See the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeaponPage<'a> {
    /// All stores, in the order in which they are selected.
    pub stores: &'a [Store<'a>],
    /// Which one is selected.
    pub selected: Option<usize>,
    /// Whether the trigger does anything.
    pub armed: bool,
    /// How it is released, in words: `RIPPLE 4 X 0.2 S`.
    pub release: &'a str,
    /// The sight.
    pub sight: Sight<'a>,
}

const LEFT_X: f64 = 482.0;
const RIGHT_X: f64 = 620.0;
const TOP_Y: f64 = 178.0;
const ROW: f64 = 19.0;
/// Most stores listed.
const MOST: usize = 6;

/// The list at the lower right.
pub(super) fn page(sheet: &mut Sheet, page: &WeaponPage<'_>) {
    let mut y = TOP_Y;
    let (word, colour) = if page.armed { ("ARMED", AMBER) } else { ("SAFE", GREEN) };
    sheet.text([RIGHT_X, y], SMALL, word, Anchor::Right, colour);
    for (at, store) in page.stores.iter().take(MOST).enumerate() {
        y += ROW;
        let name: String = store.name.chars().take(12).collect::<String>().to_uppercase();
        let selected = page.selected == Some(at);
        let colour = if selected { GREEN } else { DIM };
        if selected {
            sheet.frame(LEFT_X - 8.0, RIGHT_X + 8.0, y, 9.0);
        }
        let left = store.left.min(99_999).to_string();
        sheet.text([LEFT_X, y], SMALL, &name, Anchor::Left, colour);
        sheet.text([RIGHT_X, y], SMALL, &left, Anchor::Right, if store.left == 0 { AMBER } else { colour });
    }
    y += ROW;
    let release: String = page.release.chars().take(24).collect();
    sheet.text([RIGHT_X, y], SMALL, &release, Anchor::Right, DIM);
    match page.sight {
        Sight::Impact { in_view_m, time_s, .. } => {
            let range_m = in_view_m.iter().map(|c| c * c).sum::<f64>().sqrt();
            let text = format!("{} M  {} S", shown(10.0 * rounded(range_m / 10.0), 0), shown(tenth(time_s), 1));
            sheet.text([RIGHT_X, y + ROW], SMALL, &text, Anchor::Right, GREEN);
        }
        Sight::None(why) => {
            let why: String = why.chars().take(24).collect::<String>().to_uppercase();
            sheet.text([RIGHT_X, y + ROW], SMALL, &why, Anchor::Right, AMBER);
        }
        Sight::Off => {}
    }
}

/// The pipper and its fall line.
pub(super) fn sight(sheet: &mut Sheet, input: &HudInput<'_>, page: &WeaponPage<'_>) {
    const RADIUS: f64 = 14.0;
    /// What is farther from the middle than this is shown at its edge, pixels.
    const MOST_X: f64 = 300.0;
    const MOST_Y: f64 = 330.0;
    let Sight::Impact { in_view_m: [right, up, back], safe, .. } = page.sight else { return };
    let Some(focal) = focal(sheet, input).filter(|_| input.looking_ahead && back < -1.0) else { return };
    let (x, y) = (-focal * right / back, focal * up / back);
    if !(x.is_finite() && y.is_finite()) {
        return;
    }
    let beyond = (x.abs() / MOST_X).max(y.abs() / MOST_Y).max(1.0);
    let (x, y) = (x / beyond, y / beyond);
    let colour = if safe { GREEN } else { AMBER };
    if beyond > 1.0 {
        // Dashed: not there, but that way.
        let whole = ring([x, y], RADIUS, 16);
        whole.chunks(2).for_each(|dash| sheet.line(dash, 1.8, colour));
        sheet.text([x, y], MEDIUM, "X", Anchor::Centre, colour);
    } else {
        sheet.line(&ring([x, y], RADIUS, 20), 2.0, colour);
        sheet.line(&ring([x, y], 1.6, 6), 2.4, colour);
        for (dx, dy) in [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)] {
            let from = [x + RADIUS * dx, y + RADIUS * dy];
            sheet.line(&[from, [from[0] + 6.0 * dx, from[1] + 6.0 * dy]], 1.8, colour);
        }
    }
    if !safe {
        sheet.text([x, y + RADIUS + 16.0], SMALL, "LOW", Anchor::Centre, AMBER);
    }
    // The fall line: from the pipper to where the aircraft goes.
    let [to_right, to_up, to_back] = input.velocity_in_view_mps;
    if to_back < -1.0 {
        let (to_x, to_y) = (-focal * to_right / to_back, focal * to_up / to_back);
        let (dx, dy) = (to_x - x, to_y - y);
        let length = dx.hypot(dy);
        if length.is_finite() && length > 2.0 * RADIUS {
            let from = [x + dx / length * RADIUS, y + dy / length * RADIUS];
            sheet.line(&[from, [to_x, to_y]], 1.4, colour);
        }
    }
}
