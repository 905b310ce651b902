//! What all reports are made with: pages, tables, charts, what a run cost, numbers in words.

mod cost;
mod effort;
mod machine;
mod number;
mod page;
mod picture;
mod table;

pub(crate) use cost::Cost;
pub(crate) use effort::Effort;
pub(crate) use machine::machine;
pub(crate) use number::{exponent, number, order_line, percent, rounded, short};
pub(crate) use page::{Page, drawing, list};
pub(crate) use picture::{Picture, plot_files};
pub(crate) use table::{Cell, Table};
