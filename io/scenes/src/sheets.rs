//! Sheets: what they are of, how they start, their creases.

pub(crate) mod creases;
pub(crate) mod curl;
pub(crate) mod fold_group;
pub(crate) mod folding;
pub(crate) mod material;
pub(crate) mod patch;
pub(crate) mod patched;
pub(crate) mod refined;
pub(crate) mod several;
pub(crate) mod sheet;
pub(crate) mod size;
pub(crate) mod start;
pub(crate) mod weight;
pub(crate) mod yields;
