//! Where the viewer of a film is.

use isosheet_collide::Obstacle;
use isosheet_mesh::{Topology, VertexId};
use isosheet_runs::Recording;
use nalgebra::{Point3, Vector3};

/// Where the viewer is as seen from the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Degrees counter-clockwise from the x axis as seen from above.
    pub azimuth: f64,
    /// Degrees above the horizon.
    pub elevation: f64,
}

/// The viewpoint that is taken where the sheet is seen from there, and others: from all sides, from high
/// above and from below.
const VIEWPOINTS: [[f64; 2]; 16] = [
    [-60.0, 25.0],
    [-120.0, 25.0],
    [-30.0, 25.0],
    [-150.0, 25.0],
    [60.0, 25.0],
    [120.0, 25.0],
    [30.0, 25.0],
    [150.0, 25.0],
    [-60.0, 60.0],
    [-120.0, 60.0],
    [60.0, 60.0],
    [120.0, 60.0],
    [-60.0, -25.0],
    [-120.0, -25.0],
    [60.0, -25.0],
    [120.0, -25.0],
];

/// The part of the sheet that bodies may hide from a viewpoint.
const HIDDEN: f64 = 0.5;

/// A sheet is seen on its edge from where its area is less than this part of the largest one: a level sheet
/// from 25 degrees above the horizon has 0.49 of its area from 60 degrees.
const ON_EDGE: f64 = 1.0 / 3.0;

/// Vertices that are looked at in a frame, about.
const SAMPLES: usize = 150;

/// Bodies that are nearer to a line of sight than this part of the size of the sheet are in its way.
const NEAR: f64 = 5e-3;

impl Viewpoint {
    /// The first viewpoint from which the sheet is not seen on its edge, and bodies hide no more than half of
    /// it, in some frames, seen from a distance in metres; without one that from which most is seen.
    pub(super) fn of_sight(
        recording: &Recording,
        frames: &[usize],
        size: f64,
        distance: f64,
    ) -> Self {
        let looked_at = [0, frames.len() / 2, frames.len() - 1].map(|k| frames[k]);
        let trajectory = &recording.trajectory;
        let points_of = |frame: usize| {
            let x = trajectory.frame(frame).unwrap_or_default();
            x.as_chunks::<3>().0
        };
        let points = looked_at.iter().flat_map(|&frame| {
            let (points, t) = (points_of(frame), trajectory.times()[frame]);
            points
                .iter()
                .step_by(points.len() / SAMPLES + 1)
                .map(move |p| (t, Vector3::from(*p)))
        });
        let points: Vec<(f64, Vector3<f64>)> = points.collect();
        let hidden = |view: &Self| {
            let toward = view.direction();
            let is_hidden = |(t, p): &&(f64, Vector3<f64>)| {
                let mut bodies = recording.obstacles.iter();
                bodies.any(|body| is_between(body, *t, [*p, toward], NEAR * size, distance))
            };
            points.iter().filter(is_hidden).count() as f64 / points.len().max(1) as f64
        };
        let views = VIEWPOINTS.map(|[azimuth, elevation]| Self { azimuth, elevation });
        // Of each frame the areas from all viewpoints, as parts of the largest one.
        let areas = looked_at.map(|frame| {
            let normals = normals(recording.sheet.topology(), points_of(frame));
            let areas = views.map(|view| {
                let toward = view.direction();
                normals.iter().map(|n| n.dot(&toward).abs()).sum::<f64>()
            });
            let largest = areas.into_iter().fold(f64::MIN_POSITIVE, f64::max);
            areas.map(|area| area / largest)
        });
        let mut best = (Self::default(), f64::NEG_INFINITY);
        for (k, view) in views.into_iter().enumerate() {
            let area = areas.iter().map(|areas| areas[k]).sum::<f64>() / areas.len() as f64;
            let hidden = hidden(&view);
            if hidden <= HIDDEN && area >= ON_EDGE {
                return view;
            }
            let seen = (1.0 - hidden) * area;
            if seen > best.1 {
                best = (view, seen);
            }
        }
        best.0
    }

    /// The unit vector from the sheet to the viewer.
    fn direction(&self) -> Vector3<f64> {
        let (sa, ca) = self.azimuth.to_radians().sin_cos();
        let (se, ce) = self.elevation.to_radians().sin_cos();
        Vector3::new(ce * ca, ce * sa, se)
    }
}

/// -60 degrees from the x axis and 25 degrees above the horizon.
impl Default for Viewpoint {
    fn default() -> Self {
        let [azimuth, elevation] = VIEWPOINTS[0];
        Self { azimuth, elevation }
    }
}

/// The vector areas of faces, twice.
fn normals(topology: &Topology, points: &[[f64; 3]]) -> Vec<Vector3<f64>> {
    let normal = |face: &[VertexId; 3]| {
        let [a, b, c] = face.map(|v| Vector3::from(points[v.index()]));
        (b - a).cross(&(c - a))
    };
    let faces = topology.faces().iter();
    faces
        .filter(|face| face.iter().all(|v| v.index() < points.len()))
        .map(normal)
        .collect()
}

/// Whether a body is between a point and a viewer at a distance in some direction. A body that the point is
/// close to is so only if the line of sight leads into it.
fn is_between(
    body: &Obstacle,
    t: f64,
    [from, toward]: [Vector3<f64>; 2],
    near: f64,
    distance: f64,
) -> bool {
    let pose = body.motion().pose(t).inverse();
    let (from, toward) = (pose * Point3::from(from), pose * toward);
    let gap = |s: f64| {
        body.shape()
            .signed_distance(&(from + s * toward).coords)
            .value
    };
    let (mut s, mut is_away) = (near, false);
    while s < distance {
        let gap = gap(s);
        if gap < -near || gap < near && is_away {
            return true;
        }
        is_away |= gap > 2.0 * near;
        s += gap.max(near);
    }
    false
}
