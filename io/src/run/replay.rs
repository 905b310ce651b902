//! What the page shows of a recorded motion.

use crate::format::{HistoryRow, MeasureRow, Trajectory};
use crate::view::{Body, BodyShape, Field, Place, Pose, Replay, Scale, Series, ViewError};
use isosheet_collide::{Obstacle, Shape};
use isosheet_mesh::Sheet;
use nalgebra::{Isometry3, Point3};

impl Replay {
    /// The page of a recorded motion: the sheet, the bodies in their poses, and
    ///
    /// - the field "strain" ([`Field::edge_strain`]), where there are bodies "distance to obstacles" (see
    ///   [`Field::obstacle_distance`]), and where the trajectory has them the forces of the rods
    ///   ([`Field::rod_forces`]), the forces of contact and the gaps of the vertices ([`Field::contact`]), and what has
    ///   yielded ([`Field::plastic`]),
    /// - the series of the history (see [`Series::of_history`]).
    ///
    /// Titles, pins and texts are left to the caller.
    ///
    /// # Errors
    /// [`ViewError`] if the trajectory is not one of this sheet.
    pub fn of_motion(
        sheet: &Sheet,
        obstacles: &[Obstacle],
        trajectory: &Trajectory,
        history: &[HistoryRow],
    ) -> Result<Self, ViewError> {
        let times = trajectory.times().to_vec();
        let frames = (0..times.len()).filter_map(|k| trajectory.frame(k));
        let positions: Vec<Vec<f64>> = frames.map(<[f64]>::to_vec).collect();
        let (faces, rest) = (sheet.face_indices(), sheet.positions().to_vec());
        let mut fields = vec![Field::edge_strain(&faces, &rest, &positions)?];
        if !obstacles.is_empty() {
            fields.push(Field::obstacle_distance(obstacles, &times, &positions));
        }
        fields.extend(Field::rod_forces(trajectory));
        fields.extend(Field::contact(trajectory));
        fields.extend(Field::plastic(trajectory));
        let bodies = obstacles.iter().enumerate();
        let bodies =
            bodies.map(|(k, body)| Body::of_obstacle(&format!("obstacle[{k}]"), body, &times));
        Ok(Self {
            bodies: bodies.collect(),
            series: Series::of_history(history),
            faces,
            rest,
            times,
            positions,
            fields,
            ..Self::default()
        })
    }
}

impl From<Isometry3<f64>> for Pose {
    fn from(pose: Isometry3<f64>) -> Self {
        let q = pose.rotation.quaternion();
        Self {
            rotation: [q.i, q.j, q.k, q.w],
            translation: pose.translation.vector.into(),
        }
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
        let mut poses: Vec<Pose> = times.iter().map(|&t| pose(t).into()).collect();
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

impl Field {
    /// The distance of each vertex from the nearest obstacle, metres, on a logarithmic scale: times (seconds)
    /// and positions (length 3V) of the frames. The thickness of the sheet is not subtracted, and a face or
    /// an edge may be nearer to an obstacle than its vertices are; the series "smallest gap" has both.
    pub fn obstacle_distance(
        obstacles: &[Obstacle],
        times: &[f64],
        positions: &[Vec<f64>],
    ) -> Self {
        let of_frame = |(t, x): (&f64, &Vec<f64>)| {
            let into_body: Vec<_> = obstacles
                .iter()
                .map(|body| (body.shape(), body.motion().pose(*t).inverse()))
                .collect();
            let distance = |p: &[f64; 3]| {
                let distances = into_body.iter().map(|(shape, pose)| {
                    let local = pose * Point3::from(*p);
                    shape.signed_distance(&local.coords).value.abs()
                });
                distances.fold(f64::INFINITY, f64::min)
            };
            x.as_chunks::<3>().0.iter().map(distance).collect()
        };
        Self {
            name: "distance to obstacles".into(),
            unit: "m".into(),
            place: Place::Vertex,
            scale: Scale::Logarithmic,
            note: String::new(),
            values: times.iter().zip(positions).map(of_frame).collect(),
        }
    }
}

impl Series {
    /// The columns of a history over time: energies, largest strain, smallest gap (in runs that have one; 0,
    /// which plots leave out, while nothing is within reach), change of the total energy, length of the step,
    /// and the iterations, factorisations and rejected sub-steps of each step.
    pub fn of_history(rows: &[HistoryRow]) -> Vec<Self> {
        // The row of the start is no step.
        let steps: Vec<&HistoryRow> = rows.iter().filter(|row| row.h > 0.0).collect();
        let all: Vec<&HistoryRow> = rows.iter().collect();
        let one = |name: &str, unit: &str, scale, rows: &[&HistoryRow], of: Column| Self {
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

    /// What each measure shows over time, metres, in the order of the scene.
    pub fn of_measures(rows: &[MeasureRow]) -> Vec<Self> {
        let mut series: Vec<Self> = Vec::new();
        for row in rows {
            let place = series.iter().position(|s| s.name == row.name);
            let place = place.unwrap_or_else(|| {
                series.push(Self {
                    name: row.name.clone(),
                    unit: "m".into(),
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
type Column = fn(&HistoryRow) -> f64;

/// The unit of counts, which share a plot.
const PER_STEP: &str = "per step";
