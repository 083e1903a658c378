//! World coordinates and geodetic ones.
