//! What the page shows of a recorded motion.

use super::frame_field::{FrameField, check_frame};
use crate::view::{Body, BodyShape, Replay, Scale, TimeSeries};
use isosheet_collide::{Obstacle, Shape};
use isosheet_files::DataError;
use isosheet_formats::{BodyPose, FrameQuantity, HistoryRow, MeasureRow, Motion, Trajectory};
use isosheet_mesh::Sheet;
use isosheet_scenes::{Gauge, Origins};
use nalgebra::Isometry3;
use std::ops::ControlFlow;

impl Replay {
    /// The page of a recorded motion: the sheet, the bodies in their poses, and
    ///
    /// - the field "strain" ([`Field::edge_strain`](crate::view::Field::edge_strain)), where there are bodies
    ///   "distance to obstacles" (of each vertex, without the thickness of the sheet), and where the trajectory has
    ///   them the forces of the rods, the forces of contact and the gaps of the vertices, and what has yielded,
    /// - the series of the history (see [`TimeSeries::of_history`]).
    ///
    /// Titles, pins and texts are left to the caller.
    ///
    /// # Errors
    /// [`DataError`] if the trajectory is not one of this sheet.
    pub fn of_motion(
        sheet: &Sheet,
        obstacles: &[Obstacle],
        trajectory: &Trajectory,
        history: &[HistoryRow],
    ) -> Result<Self, DataError> {
        let has = |quantity: FrameQuantity| {
            let first = trajectory.first_data();
            first.is_some_and(|data| !quantity.of(&data).is_empty())
        };
        let fields = FrameField::all(sheet, &Origins::default(), obstacles, has);
        let still = Self::still(sheet, obstacles, trajectory.times().to_vec(), history);
        still.with_frames(trajectory, sheet, &fields)
    }

    /// The page of a motion without its frames.
    pub(super) fn still(
        sheet: &Sheet,
        obstacles: &[Obstacle],
        times: Vec<f64>,
        history: &[HistoryRow],
    ) -> Self {
        let bodies = obstacles.iter().enumerate();
        let bodies =
            bodies.map(|(k, body)| Body::of_obstacle(&format!("obstacle[{k}]"), body, &times));
        Self {
            bodies: bodies.collect(),
            series: TimeSeries::of_history(history),
            faces: sheet.face_indices(),
            rest: sheet.positions().to_vec(),
            times,
            ..Self::default()
        }
    }

    /// The same with the frames of a trajectory, and with the values of fields.
    pub(super) fn with_frames(
        mut self,
        trajectory: &Trajectory,
        sheet: &Sheet,
        fields: &[FrameField<'_>],
    ) -> Result<Self, DataError> {
        self.fields = fields.iter().map(|field| field.head.clone()).collect();
        self.bends = FrameField::of_bends(fields);
        let mut done = Ok(());
        let Ok(()) = trajectory.each(&mut |frame| {
            done = check_frame(frame, sheet);
            if done.is_err() {
                return ControlFlow::Break(());
            }
            self.positions.push(frame.x.to_vec());
            for (field, of) in self.fields.iter_mut().zip(fields) {
                field.values.push(of.values(frame));
            }
            ControlFlow::Continue(())
        });
        done.map(|()| self)
    }
}

impl From<&Shape> for BodyShape {
    fn from(shape: &Shape) -> Self {
        match *shape {
            Shape::HalfSpace => Self::HalfSpace,
            Shape::Cuboid { half } => Self::Cuboid { half },
            Shape::Sphere { radius } => Self::Sphere { radius },
            Shape::Cylinder {
                radius,
                half_height,
            } => Self::Cylinder {
                radius,
                half_height,
            },
            Shape::Capsule {
                radius,
                half_length,
            } => Self::Capsule {
                radius,
                half_length,
            },
            Shape::Surface(ref surface) => Self::Mesh {
                vertices: surface
                    .positions()
                    .iter()
                    .flat_map(|p| [p.x, p.y, p.z])
                    .collect(),
                faces: surface.mesh().faces().to_vec(),
            },
        }
    }
}

impl Body {
    /// A body that is at `pose(t)` at the times `t` (seconds) of the frames. One that does not move has a
    /// single pose.
    pub fn moving(
        name: &str,
        shape: BodyShape,
        times: &[f64],
        pose: impl Fn(f64) -> Isometry3<f64>,
    ) -> Self {
        let mut poses: Vec<BodyPose> = times.iter().map(|&t| pose(t).into()).collect();
        if poses.windows(2).all(|pair| pair[0] == pair[1]) {
            poses.truncate(1);
        }
        Self {
            name: name.into(),
            shape,
            poses,
        }
    }

    /// An obstacle at the times (seconds) of the frames.
    pub fn of_obstacle(name: &str, obstacle: &Obstacle, times: &[f64]) -> Self {
        Self::moving(name, obstacle.shape().into(), times, |t| {
            obstacle.motion().pose(t)
        })
    }
}

impl TimeSeries {
    /// The columns of a history over time: energies, largest strain, smallest gap (in runs that have one; 0,
    /// which plots leave out, while nothing is within reach), change of the total energy, length of the step,
    /// and the iterations, factorisations and rejected sub-steps of each step.
    pub fn of_history(rows: &[HistoryRow]) -> Vec<Self> {
        // The row of the start is no step.
        let steps: Vec<&HistoryRow> = rows.iter().filter(|row| row.h > 0.0).collect();
        let all: Vec<&HistoryRow> = rows.iter().collect();
        let one = |name: &str, unit: &str, scale, rows: &[&HistoryRow], of: HistoryColumn| Self {
            name: name.into(),
            unit: unit.into(),
            scale,
            times: rows.iter().map(|row| row.t).collect(),
            values: rows.iter().map(|row| of(row)).collect(),
        };
        let (linear, logarithmic) = (Scale::Linear, Scale::Logarithmic);
        let mut series = vec![
            one("kinetic energy", "J", linear, &all, |row| row.kinetic),
            one("potential energy", "J", linear, &all, |row| row.potential),
            one("total energy", "J", linear, &all, |row| row.total),
            one("largest strain", "", logarithmic, &all, |row| row.strain),
        ];
        if rows.iter().any(|row| row.gap.is_some()) {
            series.push(one("smallest gap", "m", logarithmic, &all, |row| {
                row.gap.unwrap_or_default()
            }));
        }
        if rows.iter().any(|row| row.plastic.is_some()) {
            series.push(one("dissipated by yielding", "J", linear, &all, |row| {
                row.plastic.unwrap_or_default()
            }));
        }
        series.extend([
            one("change of the total energy", "J", linear, &all, |row| {
                row.drift
            }),
            one("length of the step", "s", linear, &steps, |row| row.h),
            one("iterations", PER_STEP, linear, &steps, |row| {
                row.iterations as f64
            }),
            one("factorisations", PER_STEP, linear, &steps, |row| {
                row.factorisations as f64
            }),
            one("rejected", PER_STEP, linear, &steps, |row| {
                row.rejected as f64
            }),
        ]);
        series
    }

    /// What each of the gauges of a scene shows over time.
    pub fn of_measures(rows: &[MeasureRow], gauges: &[Gauge]) -> Vec<Self> {
        let unit = |name: &str| {
            let gauge = gauges.iter().find(|gauge| gauge.name == name);
            gauge.map_or("m", Gauge::unit)
        };
        let mut series: Vec<Self> = Vec::new();
        for row in rows {
            let place = series.iter().position(|s| s.name == row.name);
            let place = place.unwrap_or_else(|| {
                series.push(Self {
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
}

/// A number of a row.
type HistoryColumn = fn(&HistoryRow) -> f64;

/// The unit of counts, which share a plot.
const PER_STEP: &str = "per step";
