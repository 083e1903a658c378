//! Where worlds are kept.
