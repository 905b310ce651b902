//! Tests that span several crates of isosheet live in `it/`; this library is empty.
