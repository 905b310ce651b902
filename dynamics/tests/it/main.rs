//! Whole simulations of sheets: what one file of the solver cannot see alone.

mod air;
mod creases;
mod damping;
mod dashpots;
mod elastic_sheet;
mod friction_law;
mod glue;
mod hands;
mod immobile;
mod loads;
mod of_material;
mod pins;
mod plate_yield;
mod rigid_bodies;
mod swelling;
mod taut_sheets;
mod wrong_potentials;
