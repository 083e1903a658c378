//! Values in memory of which a later version shares all but the pages that changed.
//!
//! A version costs a table of one number a page (a thousandth of the values) and a copy of each page that it changes, 4 KiB.
//! A version without changes reads its values straight, behind one branch that is always guessed right.

use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

/// Marks a page that has not changed.
const AS_BEFORE: u32 = u32::MAX;

/// See the module.
#[derive(Clone)]
pub struct Paged<T> {
    base: Arc<Vec<T>>,
    changed: Option<Arc<Changed<T>>>,
}

#[derive(Clone)]
struct Changed<T> {
    /// For each page of the base: where in `pages` its values are now.
    places: Vec<u32>,
    pages: Vec<Arc<[T]>>,
}

impl<T: Copy> Paged<T> {
    /// Values of a page: a power of two that makes it 4 KiB at most.
    const PAGE: usize = 1 << (4096 / size_of::<T>()).ilog2();

    /// Values, none of them changed.
    pub fn new(values: Vec<T>) -> Self {
        Self { base: Arc::new(values), changed: None }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.base.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.base.is_empty()
    }

    /// All values in a row, if none has changed.
    #[inline(always)]
    pub fn whole(&self) -> Option<&[T]> {
        if self.changed.is_none() { Some(&self.base) } else { None }
    }

    /// All values; a copy if any has changed.
    pub fn all(&self) -> Cow<'_, [T]> {
        match self.whole() {
            Some(values) => Cow::Borrowed(values),
            None => Cow::Owned((0..self.len()).map(|at| self.get(at)).collect()),
        }
    }

    /// A value; `at` is within [`Self::len`].
    #[inline(always)]
    pub fn get(&self, at: usize) -> T {
        match &self.changed {
            None => self.base[at],
            Some(changed) => changed.get(&self.base, at),
        }
    }

    /// Copies the values from `from` on.
    pub fn read(&self, from: usize, into: &mut [T]) {
        match self.whole() {
            Some(values) => into.copy_from_slice(&values[from..from + into.len()]),
            None => into.iter_mut().enumerate().for_each(|(at, value)| *value = self.get(from + at)),
        }
    }

    /// The same values with some of them others: place and value.
    #[must_use]
    pub fn with(&self, changes: impl IntoIterator<Item = (usize, T)>) -> Self {
        let mut changed = match &self.changed {
            Some(changed) => Changed::clone(changed),
            None => Changed { places: vec![AS_BEFORE; self.len().div_ceil(Self::PAGE)], pages: Vec::new() },
        };
        for (at, value) in changes {
            let page = at / Self::PAGE;
            if changed.places[page] == AS_BEFORE {
                let from = page * Self::PAGE;
                let to = (from + Self::PAGE).min(self.len());
                changed.places[page] = changed.pages.len() as u32;
                changed.pages.push(self.base[from..to].into());
            }
            let page = &mut changed.pages[changed.places[page] as usize];
            // Copies the page the first time only: later it is this version's own.
            Arc::make_mut(page)[at % Self::PAGE] = value;
        }
        let changed = (!changed.pages.is_empty()).then(|| Arc::new(changed));
        Self { base: self.base.clone(), changed }
    }

    /// Bytes, changed pages included.
    pub fn bytes(&self) -> usize {
        let changed = self.changed.as_ref().map_or(0, |changed| {
            size_of_val(changed.places.as_slice())
                + changed.pages.iter().map(|page| size_of_val(&**page)).sum::<usize>()
        });
        size_of_val(self.base.as_slice()) + changed
    }
}

impl<T: Copy> Changed<T> {
    #[cold]
    fn get(&self, base: &[T], at: usize) -> T {
        match self.places[at / Paged::<T>::PAGE] {
            AS_BEFORE => base[at],
            place => self.pages[place as usize][at % Paged::<T>::PAGE],
        }
    }
}

impl<T: Copy + PartialEq> PartialEq for Paged<T> {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len() && (0..self.len()).all(|at| self.get(at) == other.get(at))
    }
}

impl<T: Copy> fmt::Debug for Paged<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let changed = self.changed.as_ref().map_or(0, |changed| changed.pages.len());
        write!(f, "Paged({} values, {changed} pages changed)", self.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    #[test]
    fn versions_are_vectors_that_are_copied_whole() {
        let mut random = StdRng::seed_from_u64(3);
        let values: Vec<u32> = (0..5_000).collect();
        let mut versions = vec![(Paged::new(values.clone()), values)];
        for _ in 0..60 {
            let (paged, plain) = versions[random.random_range(0..versions.len())].clone();
            let number = random.random_range(0..40);
            let changes: Vec<(usize, u32)> =
                (0..number).map(|_| (random.random_range(0..plain.len()), random.random())).collect();
            let mut plain = plain;
            changes.iter().for_each(|(at, value)| plain[*at] = *value);
            versions.push((paged.with(changes), plain));
        }
        for (paged, plain) in &versions {
            assert_eq!(&*paged.all(), plain.as_slice());
            assert!((0..plain.len()).all(|at| paged.get(at) == plain[at]));
            let mut part = [0; 300];
            paged.read(950, &mut part);
            assert_eq!(part, plain[950..1_250]);
        }
        assert!(versions[0].0.whole().is_some() && versions[0].0.with([]).whole().is_some());
    }
}
