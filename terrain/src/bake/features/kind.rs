//! The kinds that features are counted by, and the counts.
//!
//! Invariant: of every kind `read = kept + skipped`, and `skipped` is the sum over the reasons. An element is counted
//! once for every kind that it is: a way may be a building and an apron.

use crate::store::FeatureCount;
use std::collections::BTreeMap;

/// A kind; its name is that of the world's description.
#[allow(missing_docs, reason = "the names are the field's own; `name` and the table in `tags` say what each is")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    Highways,
    Railways,
    Waterways,
    Lakes,
    Coastlines,
    Forests,
    Fields,
    Grass,
    Scrub,
    BuiltUp,
    Sand,
    Rock,
    Snow,
    Paved,
    Buildings,
    PowerLines,
    PowerTowers,
    Masts,
    Runways,
    Taxiways,
    Aprons,
    Helipads,
    Aerodromes,
    Airfields,
    Others,
}

impl Kind {
    /// As reports call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Highways => "highways",
            Self::Railways => "railways",
            Self::Waterways => "waterways",
            Self::Lakes => "lakes",
            Self::Coastlines => "coastlines",
            Self::Forests => "forests",
            Self::Fields => "fields",
            Self::Grass => "grass",
            Self::Scrub => "scrub",
            Self::BuiltUp => "built_up",
            Self::Sand => "sand",
            Self::Rock => "rock",
            Self::Snow => "snow",
            Self::Paved => "paved",
            Self::Buildings => "buildings",
            Self::PowerLines => "power_lines",
            Self::PowerTowers => "power_towers",
            Self::Masts => "masts",
            Self::Runways => "runways",
            Self::Taxiways => "taxiways",
            Self::Aprons => "aprons",
            Self::Helipads => "helipads",
            Self::Aerodromes => "aerodromes",
            Self::Airfields => "airfields",
            Self::Others => "others",
        }
    }
}

/// Counts by kind.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counts(BTreeMap<Kind, FeatureCount>);

impl Counts {
    /// One that is in the world.
    pub fn keep(&mut self, kind: Kind) {
        let count = self.0.entry(kind).or_default();
        count.read += 1;
        count.kept += 1;
    }

    /// One that is not, and why.
    pub fn skip(&mut self, kind: Kind, reason: impl Into<String>) {
        let count = self.0.entry(kind).or_default();
        count.read += 1;
        count.skipped += 1;
        *count.skipped_for.entry(reason.into()).or_default() += 1;
    }

    /// What was done with one of those kept.
    pub fn note(&mut self, kind: Kind, what: impl Into<String>) {
        *self.0.entry(kind).or_default().notes.entry(what.into()).or_default() += 1;
    }

    /// The counts as a world's description has them; lakes are always there.
    pub fn described(mut self) -> BTreeMap<String, FeatureCount> {
        self.0.entry(Kind::Lakes).or_default();
        self.0.into_iter().map(|(kind, count)| (kind.name().to_owned(), count)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_dropped_silently() {
        let mut counts = Counts::default();
        counts.keep(Kind::Sand);
        counts.skip(Kind::Sand, "why");
        counts.skip(Kind::Sand, "why");
        counts.note(Kind::Sand, "odd");
        let all = counts.described();
        let sand = &all["sand"];
        assert_eq!((sand.read, sand.kept, sand.skipped), (3, 1, 2));
        assert_eq!((sand.skipped_for["why"], sand.notes["odd"]), (2, 1));
        assert_eq!(all["lakes"], FeatureCount::default());
    }
}
