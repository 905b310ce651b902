//! Simulations that figures are made of: made once, recorded in DIR/runs, used by several figures.

mod chart_run;
mod ensemble;
mod fall;
mod hanging;
mod record;
mod scene;
mod shape;

pub(crate) use chart_run::{ChartSummary, Fate, chart_run};
pub(crate) use ensemble::{Member, ensemble};
pub(crate) use fall::{fall, free_fall, plate_fall};
pub(crate) use hanging::{Hanging, mass};
pub(crate) use record::{RunSummary, end, ensure, forces, history, summary, supports, trajectory};
pub(crate) use scene::{FigureScene, for_frames};
pub(crate) use shape::{LIMIT, PLATE, Shape};
