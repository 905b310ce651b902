//! Whole simulations of sheets: what one file of the solver cannot see alone.

mod creases;
mod elastic_sheet;
mod glue;
mod pins;
mod plate_yield;
mod swelling;
mod taut_sheets;
