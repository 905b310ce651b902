//! Simulations that figures are made of: made once, recorded in DIR/runs, used by several figures.

mod chart_run;
mod drape;
mod ensemble;
mod fall;
mod feed;
mod fold;
mod guide;
mod record;
mod scene;
mod shape;
mod staged;
mod stamping;

pub(crate) use chart_run::{ChartScene, ChartScheme, ChartSummary, Fate, chart_run};
pub(crate) use drape::{Cloth, Drape, Outline};
pub(crate) use ensemble::{Member, ensemble};
pub(crate) use fall::{fall, free_fall, plate_fall};
pub(crate) use feed::Feed;
pub(crate) use fold::{Alike, Creases, Fold};
pub(crate) use guide::{Guide, Outlet};
pub(crate) use record::{RunSummary, ensure, forces, history, summary, supports, trajectory};
pub(crate) use scene::{PAPER_FRICTION, Scene, SelfContact};
pub(crate) use shape::{LIMIT, PLATE, Shape};
pub(crate) use staged::Staged;
pub(crate) use stamping::{DIE, Stamping};
