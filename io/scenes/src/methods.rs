//! How a scene is run: the method, the end and the files.

pub(crate) mod chart;
pub(crate) mod integration;
pub(crate) mod method;
pub(crate) mod output;
pub(crate) mod stop;
