//! Runs of the scenes that other programs have been measured on as well, and how their times compare.

mod comparison;
mod factorisation;
mod run;
mod scene;

pub(crate) use comparison::{COLUMNS, Entry, words};
pub(crate) use factorisation::{OrderRow, factorisation_time, order};
pub(crate) use run::{Measured, Timed, repeated};
pub(crate) use scene::{BUMP, CLEARANCE, Pairs, STEP, TABLE, Work, bumped, corner, hanging};
