//! Tests that span several crates.

mod conservation;
mod orders;
