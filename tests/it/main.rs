//! Tests that span several crates.

mod charts;
mod conservation;
mod constraints;
mod flat;
mod forces;
mod orders;
mod robust;
mod scenes;
