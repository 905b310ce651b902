//! What is said of scenes: keys, units, what is wrong and where.

pub(crate) mod edit;
pub(crate) mod error;
pub(crate) mod key;
pub(crate) mod part;
pub(crate) mod plain_name;
pub(crate) mod problem;
pub(crate) mod resolution;
pub(crate) mod toml_problem;
pub(crate) mod unit;
pub(crate) mod warning;
