//! Simulations that figures are made of: made once, recorded in DIR/runs, used by several figures.

mod chart_run;
mod ensemble;
mod fall;
mod record;
mod scene;
mod shape;

pub(crate) use chart_run::{ChartScene, ChartScheme, ChartSummary, Fate, chart_run};
pub(crate) use ensemble::{Member, ensemble};
pub(crate) use fall::{fall, free_fall, plate_fall};
pub(crate) use record::{RunSummary, ensure, trajectory};
pub(crate) use scene::Scene;
pub(crate) use shape::{LIMIT, PLATE, Shape};
