//! Made-up terrain for tests and benches.
