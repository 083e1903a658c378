//! Bytes of a saved scene: little-endian numbers, lengths before lists, nothing else.
//!
//! Invariants others rely on: a number comes back to the bit; reading never panics, never allocates more than the bytes
//! it was given could fill, and refuses a number that is not finite, since no state holds one.

use crate::snapshot::StableId;
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::fmt;

/// Longest text, bytes: names of models, controls and failures.
pub const LONGEST_TEXT: usize = 4_096;

/// Why bytes are no scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SaveError {
    /// Where, counted in bytes from the start.
    pub at: usize,
    /// What was expected and what was found.
    pub why: String,
}

impl fmt::Display for SaveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "saved scene, byte {}: {}", self.at, self.why)
    }
}

impl std::error::Error for SaveError {}

/// Bytes being read.
#[derive(Debug, Clone)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    /// From the first byte.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// An error here.
    pub fn refuse(&self, why: impl fmt::Display) -> SaveError {
        SaveError { at: self.at, why: why.to_string() }
    }

    /// Bytes that are left.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next bytes.
    ///
    /// # Errors
    /// [`SaveError`] if there are not as many.
    pub fn bytes(&mut self, count: usize) -> Result<&'a [u8], SaveError> {
        let all = self.bytes;
        match self.at.checked_add(count).and_then(|end| all.get(self.at..end)) {
            Some(bytes) => {
                self.at += count;
                Ok(bytes)
            }
            None => Err(self.refuse(format_args!("expected {count} bytes, found {}", self.left()))),
        }
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], SaveError> {
        let mut array = [0; N];
        array.copy_from_slice(self.bytes(N)?);
        Ok(array)
    }

    /// The next thing.
    ///
    /// # Errors
    /// [`SaveError`] says what was expected and what was found.
    pub fn take<T: Coded>(&mut self) -> Result<T, SaveError> {
        T::take(self)
    }

    /// A length; each of so many things needs at least a byte, so more than are left is refused.
    ///
    /// # Errors
    /// [`SaveError`] if there cannot be as many.
    pub fn count(&mut self) -> Result<usize, SaveError> {
        let count = self.take::<u32>()? as usize;
        if count > self.left() {
            return Err(self.refuse(format_args!("expected at most {} things, found {count}", self.left())));
        }
        Ok(count)
    }
}

/// What can be written and read back.
pub trait Coded: Sized {
    /// Writes it.
    fn put(&self, out: &mut Vec<u8>);
    /// Reads it.
    ///
    /// # Errors
    /// [`SaveError`] says what was expected and what was found.
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError>;
}

macro_rules! coded_numbers {
    ($($number:ty),*) => {$(
        impl Coded for $number {
            fn put(&self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
            fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
                Ok(Self::from_le_bytes(from.array()?))
            }
        }
    )*};
}
coded_numbers!(u8, u32, u64, i64);

/// A struct field by field, in the order written here.
macro_rules! coded {
    ($name:ident { $($field:ident),* $(,)? }) => {
        impl $crate::scene::codec::Coded for $name {
            fn put(&self, out: &mut Vec<u8>) {
                $($crate::scene::codec::Coded::put(&self.$field, out);)*
            }
            fn take(
                from: &mut $crate::scene::codec::Reader<'_>,
            ) -> Result<Self, $crate::scene::codec::SaveError> {
                Ok(Self { $($field: from.take()?),* })
            }
        }
    };
}
/// An enum without data, by its number in the order written here.
macro_rules! coded_choice {
    ($name:ident { $($variant:ident),* $(,)? }) => {
        impl $crate::scene::codec::Coded for $name {
            fn put(&self, out: &mut Vec<u8>) {
                let all = [$(Self::$variant),*];
                out.push(all.iter().position(|one| one == self).map_or(u8::MAX, |place| place as u8));
            }
            fn take(
                from: &mut $crate::scene::codec::Reader<'_>,
            ) -> Result<Self, $crate::scene::codec::SaveError> {
                let all = [$(Self::$variant),*];
                let found = from.take::<u8>()?;
                all.get(usize::from(found)).copied().ok_or_else(|| {
                    let last = all.len() - 1;
                    from.refuse(format_args!(concat!(stringify!($name), ": expected 0..={}, found {}"), last, found))
                })
            }
        }
    };
}
pub(crate) use {coded, coded_choice};

impl Coded for f64 {
    fn put(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_bits().to_le_bytes());
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let found = Self::from_bits(from.take()?);
        if found.is_finite() {
            Ok(found)
        } else {
            Err(from.refuse(format_args!("expected a finite number, found {found}")))
        }
    }
}

impl Coded for bool {
    fn put(&self, out: &mut Vec<u8>) {
        out.push(u8::from(*self));
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        match from.take::<u8>()? {
            0 => Ok(false),
            1 => Ok(true),
            found => Err(from.refuse(format_args!("expected 0 or 1, found {found}"))),
        }
    }
}

impl Coded for String {
    fn put(&self, out: &mut Vec<u8>) {
        (self.len() as u32).put(out);
        out.extend_from_slice(self.as_bytes());
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let count = from.count()?;
        if count > LONGEST_TEXT {
            return Err(from.refuse(format_args!("expected a text of at most {LONGEST_TEXT} bytes, found {count}")));
        }
        let bytes = from.bytes(count)?;
        std::str::from_utf8(bytes)
            .map(str::to_owned)
            .map_err(|error| from.refuse(format_args!("expected a text: {error}")))
    }
}

impl<T: Coded> Coded for Option<T> {
    fn put(&self, out: &mut Vec<u8>) {
        self.is_some().put(out);
        if let Some(thing) = self {
            thing.put(out);
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        Ok(if from.take()? { Some(from.take()?) } else { None })
    }
}

impl<T: Coded> Coded for Vec<T> {
    fn put(&self, out: &mut Vec<u8>) {
        (self.len() as u32).put(out);
        for thing in self {
            thing.put(out);
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        // Grows with what is read: a length alone allocates nothing.
        (0..from.count()?).map(|_| from.take()).collect()
    }
}

impl<T: Coded, const N: usize> Coded for [T; N] {
    fn put(&self, out: &mut Vec<u8>) {
        for thing in self {
            thing.put(out);
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let things: Vec<T> = (0..N).map(|_| from.take()).collect::<Result<_, _>>()?;
        things.try_into().map_err(|_| from.refuse(format_args!("expected {N} things")))
    }
}

impl<A: Coded, B: Coded> Coded for (A, B) {
    fn put(&self, out: &mut Vec<u8>) {
        self.0.put(out);
        self.1.put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        Ok((from.take()?, from.take()?))
    }
}

impl Coded for DVec2 {
    fn put(&self, out: &mut Vec<u8>) {
        self.to_array().put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        from.take().map(Self::from_array)
    }
}

impl Coded for DVec3 {
    fn put(&self, out: &mut Vec<u8>) {
        self.to_array().put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        from.take().map(Self::from_array)
    }
}

impl Coded for DMat3 {
    fn put(&self, out: &mut Vec<u8>) {
        self.to_cols_array().put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        from.take().map(|columns| Self::from_cols_array(&columns))
    }
}

impl Coded for DQuat {
    fn put(&self, out: &mut Vec<u8>) {
        self.to_array().put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let found = from.take().map(Self::from_array)?;
        // Attitudes are normalised after each step; a hundred roundings are 1e-14.
        if (found.length() - 1.0).abs() < 1e-9 {
            Ok(found)
        } else {
            Err(from.refuse(format_args!("expected an attitude of length 1, found {}", found.length())))
        }
    }
}

impl Coded for StableId {
    fn put(&self, out: &mut Vec<u8>) {
        self.0.put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        from.take().map(Self)
    }
}

/// FNV-1a, 64 bits, of bytes, going on from `hash`.
///
/// Source: G. Fowler, L. Noll, P. Vo, FNV hash, 1991 (offset basis and prime of 64 bits).
pub fn fnv(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// Where an FNV hash starts.
pub const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

#[cfg(test)]
mod tests {
    use super::*;

    fn back<T: Coded>(thing: &T) -> Result<T, SaveError> {
        let mut out = Vec::new();
        thing.put(&mut out);
        let mut reader = Reader::new(&out);
        let thing = reader.take();
        assert_eq!(reader.left(), 0);
        thing
    }

    #[test]
    fn numbers_come_back_to_the_bit() {
        for number in [0.0, -0.0, 1e-310, f64::MAX, 0.1] {
            assert_eq!(back(&number).unwrap().to_bits(), f64::to_bits(number));
        }
        let things = vec![(1u8, Some("наводчик".to_owned())), (2, None)];
        assert_eq!(back(&things).unwrap(), things);
        for number in [f64::NAN, f64::INFINITY] {
            assert!(back(&number).unwrap_err().to_string().contains("expected a finite number"));
        }
    }

    #[test]
    fn lengths_that_lie_are_refused_before_anything_is_allocated() {
        let mut bytes = Vec::new();
        u32::MAX.put(&mut bytes);
        let refused = |error: SaveError| error.to_string();
        assert!(refused(Reader::new(&bytes).take::<Vec<u64>>().unwrap_err()).contains("found 4294967295"));
        assert!(refused(Reader::new(&bytes).take::<String>().unwrap_err()).contains("expected at most 0 things"));
        assert!(refused(Reader::new(&[3]).take::<bool>().unwrap_err()).contains("expected 0 or 1, found 3"));
        assert!(refused(Reader::new(&[]).take::<u64>().unwrap_err()).contains("expected 8 bytes, found 0"));
    }
}
