//! Where a bent path first touches something that answers for straight segments only.
//!
//! The path is halved until each piece is closer to its chord than [`COARSE_M`]; a piece whose chord touches is halved on
//! until the chord is within [`FINE_M`] of the path, so that what is reported is a touch of the path and not of a
//! chord. Neighbouring chords share their end to the bit: where the segment test is watertight, so is the chain.
//!
//! What may be missed is a touch shallower than [`COARSE_M`] by a path that comes out again within the same piece. A
//! path that ends inside is never missed: some chord of it does, too.

/// Chord error up to which a piece is searched by its chord, metres. A fall under gravity bends 0.085 mm in 1/120 s
/// (g h^2 / 8), so an ordinary step is one chord; and it is a twentieth of the 2 mm that an impact may be off.
pub(super) const COARSE_M: f64 = 1e-4;

/// Chord error of a reported touch, metres. A thousandth of what an impact may be off its triangle, and still above
/// the rounding of a step at the far corner of a 400 km world (2.8e5 m: 2^-34 m each, some ten of them: 6e-10 m).
pub(super) const FINE_M: f64 = 1e-9;

/// Halvings for [`COARSE_M`]: at most 4,096 chords, each with a 4^12th of the error. An error above 1.7 km (a turn of
/// 1,300 km/s^2 in 1/10 s) is then searched with coarser chords, still without a gap.
const COARSE_DEPTH: u32 = 12;

/// Halvings in all. From 1.7 km to [`FINE_M`] takes 21; numbers so large that their roundings are above it end here.
const FINE_DEPTH: u32 = 40;

/// Most halvings of a step, so most chords asked: 2 x 8,192 + 1. Those of [`COARSE_DEPTH`] are 4,095; a path that hugs a
/// surface within 0.1 mm all along may use up the rest and is then judged by the chords it has.
const MOST_SPLITS: u32 = 8_192;

/// A piece of a path.
pub(super) trait Piece: Sized {
    /// Most that the piece is away from its chord, metres.
    fn chord_error_m(&self) -> f64;
    /// The two halves in order, sharing their common end to the bit.
    fn halves(&self) -> [Self; 2];
    /// `false` only if the whole piece is clear; cheap.
    fn may_touch(&self) -> bool {
        true
    }
}

/// The first piece whose chord touches, closer to its chord than [`FINE_M`], and the touch.
pub(super) fn first_touch<P: Piece, T>(path: P, touch: &impl Fn(&P) -> Option<T>) -> Option<(P, T)> {
    search(path, 0, &mut { MOST_SPLITS }, touch)
}

fn search<P: Piece, T>(
    piece: P,
    depth: u32,
    splits_left: &mut u32,
    touch: &impl Fn(&P) -> Option<T>,
) -> Option<(P, T)> {
    if !piece.may_touch() {
        return None;
    }
    let error_m = piece.chord_error_m();
    // Halves have a smaller error: from here on only what its chord touches is halved, some nine times twice.
    if error_m <= COARSE_M || depth >= COARSE_DEPTH || *splits_left == 0 {
        let touched = touch(&piece)?;
        if error_m <= FINE_M || depth >= FINE_DEPTH || *splits_left == 0 {
            return Some((piece, touched));
        }
    }
    *splits_left -= 1;
    let [first, second] = piece.halves();
    search(first, depth + 1, splits_left, touch).or_else(|| search(second, depth + 1, splits_left, touch))
}
