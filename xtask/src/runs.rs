//! Simulations that figures are made of: made once, recorded in DIR/runs, used by several figures.

mod chart_run;
mod record;
mod scene;
mod shape;

pub(crate) use chart_run::{ChartScene, ChartSummary, Fate, Momenta, chart_run};
pub(crate) use record::{RunSummary, ensure, trajectory};
pub(crate) use scene::Scene;
pub(crate) use shape::{PLATE, Shape};
