//! Runs of the scenes that other programs have been measured on as well, and how their times compare.

mod comparison;
mod factorisation;
mod matrices;
mod run;
mod scene;
mod table;

pub(crate) use comparison::{Entry, words};
pub(crate) use factorisation::{OrderRow, order};
pub(crate) use matrices::{Body, STIFFNESS, Sparse};
pub(crate) use run::{Limits, Measured, Mesh, NEIGHBOUR};
pub(crate) use scene::{
    BUMP, CLEARANCE, Pairs, STEP, TABLE, Work, bumped, corner, hanging, on_table, raised,
};
pub(crate) use table::{SHOWN, table};
