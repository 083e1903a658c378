//! What grows where. For now the one thing all of it stands on: repeatable numbers of a cell.
//!
//! No GPU, no state: the same cell and salt give the same numbers in any order, on any machine and thread.
#![forbid(unsafe_code)]

pub mod scatter;
