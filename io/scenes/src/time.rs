//! Functions of time, and motions that are made of them.

pub(crate) mod kinks;
pub(crate) mod led;
pub(crate) mod pose;
pub(crate) mod poses;
pub(crate) mod profile;
