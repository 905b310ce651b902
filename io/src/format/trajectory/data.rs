//! What frames have besides positions.

use super::TrajectoryError;

/// What a frame has besides its positions. An empty slice says that there is nothing of its kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameData<'a> {
    /// Forces of the rods (length E, newtons, tension positive).
    pub rod_forces: &'a [f64],
    /// Force of contact on each vertex (length 3V, newtons).
    pub contact_forces: &'a [f64],
    /// Gap of each vertex (length V, metres).
    pub gaps: &'a [f64],
}

/// One kind of data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    RodForces,
    ContactForces,
    Gaps,
}

impl Quantity {
    pub(super) const ALL: [Self; 3] = [Self::RodForces, Self::ContactForces, Self::Gaps];

    /// The name of its array in a file.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::RodForces => "rod_forces",
            Self::ContactForces => "contact_forces",
            Self::Gaps => "gaps",
        }
    }

    /// The shape of one frame of it on a mesh with `vertices` and `edges`.
    pub(super) fn shape(self, vertices: usize, edges: usize) -> Vec<u64> {
        match self {
            Self::RodForces => vec![edges as u64],
            Self::ContactForces => vec![vertices as u64, 3],
            Self::Gaps => vec![vertices as u64],
        }
    }

    /// The numbers in one frame of it.
    pub(super) fn size(self, vertices: usize, edges: usize) -> usize {
        let shape = self.shape(vertices, edges);
        shape.iter().product::<u64>() as usize
    }

    /// What a frame has of it.
    pub(super) fn of<'a>(self, data: &FrameData<'a>) -> &'a [f64] {
        match self {
            Self::RodForces => data.rod_forces,
            Self::ContactForces => data.contact_forces,
            Self::Gaps => data.gaps,
        }
    }

    /// Checks the values of a frame that follows others: as many as these have, all finite.
    pub(super) fn check(
        self,
        values: &[f64],
        frame: usize,
        expected: usize,
    ) -> Result<(), TrajectoryError> {
        let (array, got) = (self.name(), values.len());
        if got != expected {
            return Err(TrajectoryError::DataCount {
                frame,
                array,
                got,
                expected,
            });
        }
        match values.iter().position(|f| !f.is_finite()) {
            None => Ok(()),
            Some(index) => Err(TrajectoryError::DataNotFinite {
                frame,
                array,
                index,
                value: values[index],
            }),
        }
    }
}
