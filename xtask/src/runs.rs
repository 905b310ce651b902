//! Runs: their course, and the runs of which figures are made, made once and recorded in DIR/runs.

mod bumped;
mod chart_run;
mod course;
mod ensemble;
mod hanging;
pub(crate) mod meshes;
mod record;
mod scene;
mod shape;

pub(crate) use bumped::{Bumped, STEP};
pub(crate) use chart_run::{ChartSummary, chart_run};
pub(crate) use course::{Course, Ending, Plan, unseen};
pub(crate) use ensemble::{Ensemble, Spread, about_ensembles, members, spreads};
pub(crate) use hanging::{Hanging, mass};
pub(crate) use record::{Run, RunSummary, recorded};
pub(crate) use scene::{FigureScene, displaced, scene_fingerprint};
pub(crate) use shape::{PLATE, SheetShape};
