//! Tests that span several crates.

mod air;
mod balance;
mod broken_motions;
mod buckling;
mod charts;
mod checkpoint;
mod closures;
mod conservation;
mod constraints;
mod contact;
mod contact_forces;
mod elastic;
mod flat;
mod forces;
mod impacts;
mod invariance;
mod locking;
mod materials;
mod modules;
mod orders;
mod origami;
mod robust;
mod scenes;
mod statics;
mod stress;
mod watch;
