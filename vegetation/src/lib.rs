//! vegetation
