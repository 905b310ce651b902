//! Runs: their course, and those that figures are made of, made once and recorded in DIR/runs.

mod bumped;
mod chart_run;
mod course;
mod ensemble;
mod fall;
mod hanging;
mod record;
mod scene;
mod shape;

pub(crate) use isosheet_tests::{bumped, corner};

pub(crate) use bumped::{Bumped, CLEARANCE, Pairs, STEP, TABLE, hanging, on_table};
pub(crate) use chart_run::{ChartSummary, chart_run};
pub(crate) use course::{Course, Ending, Plan, unseen};
pub(crate) use ensemble::{Member, ensemble};
pub(crate) use fall::{fall, free_fall, plate_fall};
pub(crate) use hanging::{Hanging, mass};
pub(crate) use record::{Run, RunSummary};
pub(crate) use scene::{FigureScene, displaced, for_frames, scene_fingerprint};
pub(crate) use shape::{LIMIT, PLATE, Shape};
