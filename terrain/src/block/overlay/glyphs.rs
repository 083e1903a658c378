//! Runway designators as convex pieces: digits and the letters L, C, R.
//!
//! Frame: metres, right and up as a pilot on approach reads them, origin at the lower left corner; 9 m high as in ICAO Annex
//! 14, Volume I, figure 5-3, 3 m wide with strokes of 0.8 m. The figure's round shapes are drawn with straight strokes.

/// Height of a glyph, metres.
pub const HEIGHT_M: f64 = 9.0;
/// Width of a glyph, metres.
pub const WIDTH_M: f64 = 3.0;
/// Between the left edges of neighbouring glyphs, metres: figure 5-3 has some 2.3 m between figures.
pub const ADVANCE_M: f64 = 5.3;

/// Four corners of a stroke.
pub type Stroke = [[f64; 2]; 4];

const S: f64 = 0.8;
const W: f64 = WIDTH_M;
const H: f64 = HEIGHT_M;
/// Middle of the height.
const M: f64 = 0.5 * H;

const fn bar(left: f64, low: f64, right: f64, high: f64) -> Stroke {
    [[left, low], [right, low], [right, high], [left, high]]
}

const TOP: Stroke = bar(0.0, H - S, W, H);
const BOTTOM: Stroke = bar(0.0, 0.0, W, S);
const MIDDLE: Stroke = bar(S, M - 0.5 * S, W - S, M + 0.5 * S);
const LEFT: Stroke = bar(0.0, S, S, H - S);
const RIGHT: Stroke = bar(W - S, S, W, H - S);
const UPPER_LEFT: Stroke = bar(0.0, M - 0.5 * S, S, H - S);
const LOWER_LEFT: Stroke = bar(0.0, S, S, M + 0.5 * S);
const UPPER_RIGHT: Stroke = bar(W - S, M - 0.5 * S, W, H - S);
const LOWER_RIGHT: Stroke = bar(W - S, S, W, M + 0.5 * S);

/// The strokes of a character; none if it is not painted on runways.
pub fn strokes(letter: char) -> &'static [Stroke] {
    match letter {
        '0' => &[TOP, BOTTOM, LEFT, RIGHT],
        '1' => const { &[bar(0.5 * (W - S), 0.0, 0.5 * (W + S), H)] },
        '2' => &[TOP, UPPER_RIGHT, MIDDLE, LOWER_LEFT, BOTTOM],
        '3' => &[TOP, UPPER_RIGHT, MIDDLE, LOWER_RIGHT, BOTTOM],
        '4' => {
            const {
                &[
                    bar(W - 1.4, 0.0, W - 1.4 + S, H),
                    bar(0.0, 2.2, W, 2.2 + S),
                    [[0.0, 2.2 + S], [S, 2.2 + S], [W - 1.2, H], [W - 1.4, H]],
                ]
            }
        }
        '5' => &[TOP, UPPER_LEFT, MIDDLE, LOWER_RIGHT, BOTTOM],
        '6' => &[TOP, LEFT, MIDDLE, LOWER_RIGHT, BOTTOM],
        '7' => const { &[TOP, [[0.6, 0.0], [0.6 + S, 0.0], [W, H - S], [W - S, H - S]]] },
        '8' => &[TOP, LEFT, RIGHT, MIDDLE, BOTTOM],
        '9' => &[TOP, UPPER_LEFT, MIDDLE, RIGHT, BOTTOM],
        'L' => const { &[bar(0.0, 0.0, S, H), bar(S, 0.0, W, S)] },
        'C' => &[TOP, LEFT, BOTTOM],
        'R' => {
            const {
                &[
                    bar(0.0, 0.0, S, H),
                    bar(S, H - S, W, H),
                    UPPER_RIGHT,
                    MIDDLE,
                    [[W - S, 0.0], [W, 0.0], [S + S, M - 0.5 * S], [S, M - 0.5 * S]],
                ]
            }
        }
        _ => &[],
    }
}
