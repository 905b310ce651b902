//! What the page shows of a recorded motion.

use super::frame_field::{FrameField, check_frame};
use isosheet_collide::Obstacle;
use isosheet_files::DataError;
use isosheet_formats::{FrameQuantity, HistoryRow, MeasureRow, MotionFrames, Trajectory};
use isosheet_mesh::Sheet;
use isosheet_page::{Body, Replay, Scale, TimeSeries};
use isosheet_scenes::{Gauge, Origins};
use std::ops::ControlFlow;

/// The page of a recorded motion: the sheet, the bodies in their poses, and
///
/// - the field "strain" ([`Field::edge_strain`](isosheet_page::Field::edge_strain)), where there are bodies
///   "distance to obstacles" (of each vertex, without the thickness of the sheet), and where the trajectory
///   has them the forces of the rods, the forces of contact and the gaps of the vertices, and what has
///   yielded,
/// - the series of the history (see [`TimeSeries::of_history`]).
///
/// Titles, pins and texts are left to the caller.
///
/// # Errors
/// [`DataError`] if the trajectory is not one of this sheet.
pub fn replay_of(
    sheet: &Sheet,
    obstacles: &[Obstacle],
    trajectory: &Trajectory,
    history: &[HistoryRow],
) -> Result<Replay, DataError> {
    let has = |quantity: FrameQuantity| {
        let first = trajectory.first_data();
        first.is_some_and(|data| !quantity.of(&data).is_empty())
    };
    let fields = FrameField::all(sheet, &Origins::default(), obstacles, has);
    let still = still(sheet, obstacles, trajectory.times().to_vec(), history);
    with_frames(still, trajectory, sheet, &fields)
}

/// The page of a motion without its frames.
pub(super) fn still(
    sheet: &Sheet,
    obstacles: &[Obstacle],
    times: Vec<f64>,
    history: &[HistoryRow],
) -> Replay {
    let bodies = obstacles.iter().enumerate();
    let bodies = bodies.map(|(k, body)| Body::of_obstacle(&format!("obstacle[{k}]"), body, &times));
    Replay {
        bodies: bodies.collect(),
        series: TimeSeries::of_history(history),
        faces: sheet.face_indices(),
        rest: sheet.positions().to_vec(),
        times,
        ..Replay::default()
    }
}

/// A page with the frames of a trajectory, and with the values of fields.
pub(super) fn with_frames(
    mut replay: Replay,
    trajectory: &Trajectory,
    sheet: &Sheet,
    fields: &[FrameField<'_>],
) -> Result<Replay, DataError> {
    replay.fields = fields.iter().map(|field| field.head.clone()).collect();
    replay.bends = FrameField::of_bends(fields);
    let mut done = Ok(());
    let Ok(()) = trajectory.each(&mut |frame| {
        done = check_frame(frame, sheet);
        if done.is_err() {
            return ControlFlow::Break(());
        }
        replay.positions.push(frame.x.to_vec());
        for (field, of) in replay.fields.iter_mut().zip(fields) {
            field.values.push(of.values(frame));
        }
        ControlFlow::Continue(())
    });
    done.map(|()| replay)
}

/// What each of the gauges of a scene shows over time.
pub fn measure_series(rows: &[MeasureRow], gauges: &[Gauge]) -> Vec<TimeSeries> {
    let unit = |name: &str| {
        let gauge = gauges.iter().find(|gauge| gauge.name == name);
        gauge.map_or("m", Gauge::unit)
    };
    let mut series: Vec<TimeSeries> = Vec::new();
    for row in rows {
        let place = series.iter().position(|s| s.name == row.name);
        let place = place.unwrap_or_else(|| {
            series.push(TimeSeries {
                name: row.name.clone(),
                unit: unit(&row.name).into(),
                scale: Scale::Linear,
                times: Vec::new(),
                values: Vec::new(),
            });
            series.len() - 1
        });
        series[place].times.push(row.t);
        series[place].values.push(row.value);
    }
    series
}
