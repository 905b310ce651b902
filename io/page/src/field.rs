//! Values on the sheet, and quantities over time.

use isosheet_mesh::Topology;

use super::check;
use isosheet_files::DataError;
use serde::Serialize;

/// Where the values of a [`Field`] belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Centering {
    /// One value for each vertex.
    Vertex,
    /// One value for each edge, in the order of [`Topology::edges`]: by smaller, then by larger vertex.
    Edge,
    /// One value for each edge, in the order of [`Topology::edges`], of which values that are not zero are
    /// shown, on the two colours of the sheet: most edges are no creases.
    Crease,
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
    pub place: Centering,
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
pub struct TimeSeries {
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
    /// [`DataError`] when the triangles are no manifold, or a list has the wrong length.
    pub fn edge_strain(
        faces: &[[u32; 3]],
        rest: &[f64],
        positions: &[Vec<f64>],
    ) -> Result<Self, DataError> {
        let topology = check::topology(rest.len() / 3, faces)?;
        let size = 3 * topology.vertex_count();
        check::length("the rest positions", rest.len(), size)?;
        let strain = strains(&topology, rest);
        let mut values = Vec::with_capacity(positions.len());
        for (frame, x) in positions.iter().enumerate() {
            check::length_of(x.len(), size, || format!("the positions of frame {frame}"))?;
            values.push(strain(x));
        }
        Ok(Self {
            values,
            ..Self::strain()
        })
    }

    /// The field of the strains, without values.
    pub fn strain() -> Self {
        Self {
            name: "strain".into(),
            unit: String::new(),
            place: Centering::Edge,
            scale: Scale::Logarithmic,
            note: String::new(),
            values: Vec::new(),
        }
    }

    /// The name of the field in messages.
    pub(super) fn place_in_page(&self, index: usize) -> String {
        format!("field {index} (`{}`)", self.name)
    }

    /// Checks the values in a frame.
    pub(super) fn check_values(
        &self,
        values: &[f64],
        index: usize,
        frame: usize,
        topology: &Topology,
    ) -> Result<(), DataError> {
        let what = || format!("{}, frame {frame}", self.place_in_page(index));
        let expected = match self.place {
            Centering::Vertex => topology.vertex_count(),
            Centering::Edge | Centering::Crease => topology.edge_count(),
            Centering::Face => topology.face_count(),
        };
        check::length_of(values.len(), expected, what)?;
        check::finite_of(values, what)?;
        if matches!(self.scale, Scale::Logarithmic | Scale::Magnitude) {
            check::not_negative(values, what)?;
        }
        Ok(())
    }
}

/// What computes the strain of each edge from positions (length 3V).
pub fn strains(topology: &Topology, rest: &[f64]) -> impl Fn(&[f64]) -> Vec<f64> + use<> {
    let ends = topology.edges().iter().map(|e| e.map(|v| 3 * v.index()));
    let ends: Vec<[usize; 2]> = ends.collect();
    let length = |x: &[f64], [a, b]: [usize; 2]| {
        let d = [0, 1, 2].map(|k| x[a + k] - x[b + k]);
        (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
    };
    let at_rest: Vec<f64> = ends.iter().map(|&ends| length(rest, ends)).collect();
    move |x| {
        let edges = ends.iter().zip(&at_rest);
        let strain = edges.map(|(&ends, rest)| (length(x, ends) / rest - 1.0).abs());
        strain.collect()
    }
}

impl TimeSeries {
    pub(super) fn validate(&self, index: usize) -> Result<(), DataError> {
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
