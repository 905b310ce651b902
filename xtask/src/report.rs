//! What all reports are made with: options, pages, tables, pictures, what a run cost, numbers in words.

mod cost;
mod effort;
pub(crate) mod excerpt;
mod finding;
mod machine;
mod memory;
mod number;
mod options;
mod page;
mod picture;
mod record;
mod table;

pub(crate) use cost::Cost;
pub(crate) use effort::Effort;
pub(crate) use excerpt::Part;
pub(crate) use finding::{Bound, Finding, LENGTHS, Limitation, Shortfall, Verdict};
pub(crate) use finding::{demand, findings};
pub(crate) use machine::machine;
pub(crate) use memory::{peak_memory, reset_peak_memory};
pub(crate) use number::{exponent, extremes, median, number, rounded};
pub(crate) use options::{FullOptions, Options, one_of};
pub(crate) use page::{Page, Section};
pub(crate) use picture::{Picture, plot};
pub(crate) use record::{Record, Report, all_findings};
pub(crate) use table::{Cell, Table, columns};
