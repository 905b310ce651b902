//! Tests that span several crates.

mod conservation;
mod flat;
mod forces;
mod orders;
mod scenes;
