//! Holes: sky where ground should be.
