//! Why a bake fails, said so that a person can mend it.

use super::extent::{MAX_POSTS, MAX_SIDE_KM, MAX_STEP_M, MIN_STEP_M};
use super::raster::Unreadable;
use crate::projection::ProjectionError;
use std::fmt;

/// Why a bake fails.
#[derive(Debug, Clone, PartialEq)]
pub enum BakeError {
    /// No source of heights was named.
    NoSource,
    /// A source cannot be read.
    Source {
        /// Its name.
        file: String,
        /// What is wrong with it.
        problem: Unreadable,
    },
    /// A file of features cannot be read.
    Features {
        /// Its name.
        file: String,
        /// What is wrong with it.
        problem: Unreadable,
    },
    /// The height scale of a source is not a factor.
    HeightScale {
        /// The source's name.
        file: String,
        /// What was given.
        scale: f64,
    },
    /// The step is out of range.
    Step(f64),
    /// The size is out of range.
    Size([f64; 2]),
    /// The size and the step need too many posts.
    Posts(u64),
    /// The centre is not a place for a world.
    Centre(ProjectionError),
    /// No post lies on data.
    NoOverlap {
        /// Where the data is, as a person would say it.
        data: String,
    },
    /// All samples on the world are void.
    AllVoid,
}

impl fmt::Display for BakeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSource => write!(f, "expected at least one file of heights, got none"),
            Self::Source { file, problem } => write!(f, "{file}: {problem}"),
            Self::Features { file, problem } => write!(f, "{file}: {problem}"),
            Self::HeightScale { file, scale } => {
                write!(f, "{file}: expected a height scale that is finite and not 0 after the `@`, found {scale}")
            }
            Self::Step(step_m) => write!(f, "the step must be within {MIN_STEP_M}..={MAX_STEP_M} m, got {step_m}"),
            Self::Size([width, height]) => {
                write!(f, "the size must be above 0 and at most {MAX_SIDE_KM} km each way, got {width} x {height}")
            }
            Self::Posts(posts) => {
                write!(
                    f,
                    "a world has at most {MAX_POSTS} posts, this one needs {posts}; take a larger step or a smaller size"
                )
            }
            Self::Centre(error) => error.fmt(f),
            Self::NoOverlap { data } => write!(f, "expected data under the world, found it only at {data}"),
            Self::AllVoid => write!(f, "expected heights, found only voids in the sources under the world"),
        }
    }
}

impl std::error::Error for BakeError {}
