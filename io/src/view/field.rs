//! Values on the sheet, and quantities over time.

use crate::format::Trajectory;
use isosheet_mesh::Topology;

use super::check;
use super::error::ViewError;
use serde::Serialize;

/// Where the values of a [`Field`] belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// One value for each vertex.
    Vertex,
    /// One value for each edge, in the order of [`Topology::edges`]: by smaller, then by larger vertex.
    Edge,
    /// One value for each face.
    Face,
}

/// How values are laid out along a scale of colours or an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// By value.
    #[default]
    Linear,
    /// By logarithm: no value is negative. Zeros are shown as zeros in colours and left out of plots.
    Logarithmic,
    /// By value, with colours that have zero in the middle and reach as far to both sides; for forces, which
    /// are of either sign and differ by orders of magnitude. A page keeps values to 0.02 %, and those below a
    /// millionth of the largest as zero. In plots as [`Scale::Linear`].
    Signed,
    /// By value, with colours that begin at zero and reach as far as 98 % of the values that are not zero;
    /// for sizes of forces, which are not negative and differ by orders of magnitude. Kept as with
    /// [`Scale::Signed`]. In plots as [`Scale::Linear`].
    Magnitude,
}

/// A quantity on the sheet, such as the strain of the edges or the gap of the vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its unit, empty for a number without one.
    pub unit: String,
    /// Where its values belong.
    pub place: Place,
    /// The scale of its colours.
    pub scale: Scale,
    /// What to know of the values, a sentence that is shown with them; empty if there is nothing.
    pub note: String,
    /// The values in each frame (T lists with one value for each vertex, edge or face).
    pub values: Vec<Vec<f64>>,
}

/// A quantity over time, such as an energy or the number of iterations.
///
/// Series that follow each other and have the same unit (not empty), scale and times share a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// Its unit, empty for a number without one.
    pub unit: String,
    /// The scale of its axis.
    pub scale: Scale,
    /// Times, ascending, in seconds. They need not be the times of the frames.
    pub times: Vec<f64>,
    /// The value at each time.
    pub values: Vec<f64>,
}

impl Field {
    /// The relative change of the length of each edge, `| |x_a - x_b| / l_e - 1 |`, in each frame, on a
    /// logarithmic scale. The rest length `l_e` is that of the rest positions (length 3V); `positions` has a
    /// list of length 3V for each frame. The page cannot recover strains from its rounded positions.
    ///
    /// # Errors
    /// [`ViewError`] when the triangles are no manifold, or a list has the wrong length.
    pub fn edge_strain(
        faces: &[[u32; 3]],
        rest: &[f64],
        positions: &[Vec<f64>],
    ) -> Result<Self, ViewError> {
        let topology = Topology::from_faces(rest.len() / 3, faces)?;
        let size = 3 * topology.vertex_count();
        check::length("the rest positions", rest.len(), size)?;
        let length = |x: &[f64]| -> Vec<f64> {
            let ends = topology.edges().iter().map(|e| e.map(|v| 3 * v.index()));
            ends.map(|[a, b]| {
                let d = [0, 1, 2].map(|k| x[a + k] - x[b + k]);
                (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
            })
            .collect()
        };
        let at_rest = length(rest);
        let mut values = Vec::with_capacity(positions.len());
        for (frame, x) in positions.iter().enumerate() {
            check::length_of(x.len(), size, || format!("the positions of frame {frame}"))?;
            let strain = length(x).into_iter().zip(&at_rest);
            values.push(strain.map(|(l, rest)| (l / rest - 1.0).abs()).collect());
        }
        Ok(Self {
            name: "strain".into(),
            unit: String::new(),
            place: Place::Edge,
            scale: Scale::Logarithmic,
            note: String::new(),
            values,
        })
    }

    /// The force of the rod along each edge in each frame (newtons, tension positive), if the trajectory has
    /// forces.
    pub fn rod_forces(trajectory: &Trajectory) -> Option<Self> {
        let frames = 0..trajectory.len();
        let values: Option<Vec<_>> = frames
            .map(|k| trajectory.rod_forces(k).map(<[f64]>::to_vec))
            .collect();
        Some(Self {
            name: "rod force (tension +)".into(),
            unit: "N".into(),
            place: Place::Edge,
            scale: Scale::Signed,
            note: "Where rods depend on each other, as in a flat part of the sheet, their forces are not unique."
                .into(),
            values: values?,
        })
    }

    /// What the trajectory has of contact: the size of the force of contact on each vertex (newtons; of
    /// bodies and of the sheet on itself), and the gap of each vertex (metres, see [`Trajectory::gaps`]).
    pub fn contact(trajectory: &Trajectory) -> Vec<Self> {
        let frames = || 0..trajectory.len();
        let size = |f: &[f64; 3]| f[0].hypot(f[1]).hypot(f[2]);
        let sizes = |forces: &[f64]| forces.as_chunks::<3>().0.iter().map(size).collect();
        let forces = frames().map(|k| trajectory.contact_forces(k).map(sizes));
        let gaps = frames().map(|k| trajectory.gaps(k).map(<[f64]>::to_vec));
        let field = |name: &str, unit: &str, scale, values: Option<Vec<Vec<f64>>>| {
            Some(Self {
                name: name.into(),
                unit: unit.into(),
                place: Place::Vertex,
                scale,
                note: String::new(),
                values: values?,
            })
        };
        let forces = field("contact force", "N", Scale::Magnitude, forces.collect());
        let gaps = field("gap", "m", Scale::Linear, gaps.collect());
        forces.into_iter().chain(gaps).collect()
    }

    /// What the trajectory has of yielding: of plates the principal value of the plastic curvature of each
    /// face (1/m) that is larger in size, of edges that yield the plastic angle (degrees), positive for
    /// valleys.
    pub fn plastic(trajectory: &Trajectory) -> Vec<Self> {
        let frames = || 0..trajectory.len();
        let first = |values: &[f64]| values.as_chunks::<2>().0.iter().map(|p| p[0]).collect();
        let degrees = |values: &[f64]| values.iter().map(|a| a.to_degrees()).collect();
        let curvatures = frames().map(|k| trajectory.plastic_curvatures(k).map(first));
        let angles = frames().map(|k| trajectory.plastic_angles(k).map(degrees));
        let field = |name: &str, unit: &str, place, values: Option<Vec<Vec<f64>>>| {
            Some(Self {
                name: name.into(),
                unit: unit.into(),
                place,
                scale: Scale::Signed,
                note: "What has yielded, and stays where no moment acts.".into(),
                values: values?,
            })
        };
        let curvatures = field(
            "curvature that stays (valley +)",
            "1/m",
            Place::Face,
            curvatures.collect(),
        );
        let angles = field(
            "angle that stays (valley +)",
            "°",
            Place::Edge,
            angles.collect(),
        );
        curvatures.into_iter().chain(angles).collect()
    }

    pub(super) fn validate(
        &self,
        index: usize,
        topology: &Topology,
        frames: usize,
    ) -> Result<(), ViewError> {
        let what = format!("field {index} (`{}`)", self.name);
        check::length(&what, self.values.len(), frames)?;
        let expected = match self.place {
            Place::Vertex => topology.vertex_count(),
            Place::Edge => topology.edge_count(),
            Place::Face => topology.face_count(),
        };
        for (frame, values) in self.values.iter().enumerate() {
            let what = || format!("{what}, frame {frame}");
            check::length_of(values.len(), expected, what)?;
            check::finite_of(values, what)?;
            if matches!(self.scale, Scale::Logarithmic | Scale::Magnitude) {
                check::not_negative(values, what)?;
            }
        }
        Ok(())
    }
}

impl Series {
    pub(super) fn validate(&self, index: usize) -> Result<(), ViewError> {
        let what = format!("series {index} (`{}`)", self.name);
        check::length(&what, self.values.len(), self.times.len())?;
        check::times(&format!("{what}: the times"), &self.times)?;
        check::finite(&what, &self.values)?;
        if self.scale == Scale::Logarithmic {
            check::not_negative(&self.values, || what.clone())?;
        }
        Ok(())
    }
}
