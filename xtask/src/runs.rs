//! Simulations that figures are made of: made once, recorded in DIR/runs, used by several figures.

mod chart_run;
mod ensemble;
mod record;
mod scene;
mod shape;

pub(crate) use chart_run::{ChartScene, ChartScheme, ChartSummary, Fate, chart_run};
pub(crate) use ensemble::{Member, ensemble};
pub(crate) use record::{RunSummary, ensure, trajectory};
pub(crate) use scene::Scene;
pub(crate) use shape::{LIMIT, PLATE, Shape};
