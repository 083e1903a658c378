//! Rounds and what is made of them: medians, quartiles, ratios with their intervals.
//!
//! The subjects of a comparison take turns within every round (A B A B ...), so what the machine does beside falls on
//! both. A ratio is of medians; its 95 % interval is that of a percentile bootstrap over whole rounds, so that a slow
//! round weighs on both sides as it did when it was measured. A ratio says how many times *better* ours is: for a rate
//! ours / yardstick, for a time yardstick / ours.

use crate::report::{BenchResult, Yardstick};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

/// Rounds that count.
pub const ROUNDS: u32 = 15;
/// Rounds before them, for caches and clocks.
pub const WARM_UPS: u32 = 3;

const RESAMPLES: usize = 2_000;
const SEED: u64 = 0x706f_6c69_676f_6e00;

/// Which of two values is the better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// A rate.
    More,
    /// A time.
    Less,
}

/// What ours is compared with.
#[derive(Debug, Clone, Copy)]
pub struct Against<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its version.
    pub version: &'a str,
    /// Its value in each round.
    pub values: &'a [f64],
}

/// Lets the subjects take turns; a list of values for each, a value a round.
///
/// # Errors
/// The first that a subject returns.
pub fn interleave<E>(
    warm_ups: u32,
    rounds: u32,
    subjects: &mut [&mut dyn FnMut() -> Result<f64, E>],
) -> Result<Vec<Vec<f64>>, E> {
    let mut values = vec![Vec::with_capacity(rounds as usize); subjects.len()];
    for round in 0..warm_ups + rounds {
        for (subject, values) in subjects.iter_mut().zip(&mut values) {
            let value = subject()?;
            if round >= warm_ups {
                values.push(value);
            }
        }
    }
    Ok(values)
}

/// A result without a yardstick.
pub fn alone(name: &str, unit: &str, ours: &[f64], note: impl Into<String>) -> BenchResult {
    let note = note.into();
    BenchResult {
        name: name.into(),
        unit: unit.into(),
        ours: median(ours),
        quartiles: quartiles(ours),
        rounds: ours.len() as u32,
        note: (!note.is_empty()).then_some(note),
        ..BenchResult::default()
    }
}

/// A result beside its yardstick; both have a value for every round.
pub fn beside(
    name: &str,
    unit: &str,
    better: Better,
    ours: &[f64],
    yardstick: Against,
    note: impl Into<String>,
) -> BenchResult {
    let theirs = yardstick.values;
    BenchResult {
        yardstick: Some(Yardstick {
            name: yardstick.name.into(),
            version: yardstick.version.into(),
            value: median(theirs),
        }),
        ratio: Some(ratio(better, median(ours), median(theirs))),
        ratio_ci: ratio_interval(better, ours, theirs),
        ..alone(name, unit, ours, note)
    }
}

/// The median, the mean of the middle two for an even number; NaN of nothing.
pub fn median(values: &[f64]) -> f64 {
    share(&sorted(values), 0.5)
}

/// First and third quartile, interpolated; `None` of nothing.
pub fn quartiles(values: &[f64]) -> Option<[f64; 2]> {
    let sorted = sorted(values);
    (!sorted.is_empty()).then(|| [share(&sorted, 0.25), share(&sorted, 0.75)])
}

/// 95 % interval of the ratio of medians; `None` for fewer than two rounds.
pub fn ratio_interval(better: Better, ours: &[f64], theirs: &[f64]) -> Option<[f64; 2]> {
    let rounds = ours.len().min(theirs.len());
    if rounds < 2 {
        return None;
    }
    let mut random = StdRng::seed_from_u64(SEED);
    let mut ratios: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let drawn: Vec<usize> = (0..rounds).map(|_| random.random_range(0..rounds)).collect();
            let of = |values: &[f64]| median(&drawn.iter().map(|&round| values[round]).collect::<Vec<_>>());
            ratio(better, of(ours), of(theirs))
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    Some([share(&ratios, 0.025), share(&ratios, 0.975)])
}

fn ratio(better: Better, ours: f64, theirs: f64) -> f64 {
    match better {
        Better::More => ours / theirs,
        Better::Less => theirs / ours,
    }
}

/// Values from the least to the greatest.
pub fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The value at a share (0..=1) of sorted ones, interpolated linearly between neighbours; NaN of nothing.
pub fn share(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let low = (place as usize).min(last);
    let high = (low + 1).min(last);
    sorted[low] + (sorted[high] - sorted[low]) * (place - low as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_quartiles_of_known_samples() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), 2.5);
        assert!(median(&[]).is_nan());
        // By R's quantile(c(1, 2, 4, 8, 16), c(.25, .75)), type 7, and that of one value.
        assert_eq!(quartiles(&[16.0, 1.0, 8.0, 2.0, 4.0]), Some([2.0, 8.0]));
        assert_eq!(quartiles(&[1.0, 2.0, 3.0, 4.0]), Some([1.75, 3.25]));
        assert_eq!((quartiles(&[7.0]), quartiles(&[])), (Some([7.0, 7.0]), None));
    }

    #[test]
    fn an_interval_holds_the_ratio_and_knows_which_way_is_better() {
        // Every round is twice as fast, whatever the machine did: paired resampling must give exactly 2.
        let theirs: Vec<f64> = (0..15).map(|round| 10.0 + f64::from(round % 4)).collect();
        let ours: Vec<f64> = theirs.iter().map(|ms| ms / 2.0).collect();
        assert_eq!(ratio_interval(Better::Less, &ours, &theirs), Some([2.0, 2.0]));
        assert_eq!(ratio_interval(Better::More, &ours, &theirs), Some([0.5, 0.5]));
        assert_eq!(ratio_interval(Better::Less, &ours[..1], &theirs), None);
        // Independent noise of 10..14 on both: the medians' ratio is near 1 and the interval around it is not empty.
        let turned: Vec<f64> = (0..15).map(|round| 10.0 + f64::from(round * 7 % 5)).collect();
        let [low, high] = ratio_interval(Better::Less, &turned, &theirs).unwrap();
        let middle = median(&theirs) / median(&turned);
        assert!(low < middle && middle <= high && low > 10.0 / 14.0 && high < 14.0 / 10.0, "{low} {middle} {high}");
    }

    #[test]
    fn subjects_take_turns_and_warm_ups_do_not_count() {
        let order = std::cell::RefCell::new(String::new());
        let mut a = || -> Result<f64, ()> {
            order.borrow_mut().push('a');
            Ok(order.borrow().len() as f64)
        };
        let mut b = || {
            order.borrow_mut().push('b');
            Ok(0.0)
        };
        let values = interleave(1, 2, &mut [&mut a, &mut b]).unwrap();
        assert_eq!(values, [vec![3.0, 5.0], vec![0.0, 0.0]]);
        assert_eq!(*order.borrow(), "ababab");
        assert_eq!(interleave(0, 1, &mut [&mut || Err("broken")]), Err("broken"));
    }
}
