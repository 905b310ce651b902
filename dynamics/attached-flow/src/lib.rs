#![doc = include_str!("../README.md")]

mod error;
mod flow;
mod lattice;
mod step;
#[cfg(test)]
mod tests;
mod vortex;
mod wake;

pub use error::AttachedFlowError;

use flow::InAir;
use isosheet_dynamics::{
    Air, At, Memories, Potential, PotentialShape, Reached, Remembering, Settled, SheetModel,
};
use isosheet_mesh::{EdgeId, FaceId};
use lattice::Lattice;
use std::sync::Arc;
use wake::{Past, Size};

/// Faces that the flow is attached to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AttachedFlow {
    /// The faces.
    pub faces: Vec<FaceId>,
    /// Edges at the rim of these faces where the flow leaves them.
    pub trailing: Vec<EdgeId>,
    /// Rows of vortices of the wake, one for each step; older ones become one.
    pub rows: usize,
}

impl AttachedFlow {
    /// The largest number of faces: a step solves a dense system of as many equations, and its matrix couples
    /// all vertices of these faces.
    pub const MOST_FACES: usize = 2000;
    /// The largest number of rows of the wake, each of which takes part in the flow at every face: minutes of
    /// steps of a hundredth of a second.
    pub const MOST_ROWS: usize = 10_000;

    /// The default of [`AttachedFlow::rows`].
    pub const ROWS: usize = 80;
}

/// A lattice in the air, whose wake is the memory of the potential of a number.
#[derive(Debug, Clone)]
struct Attached {
    air: Arc<InAir>,
    size: Size,
    potential: usize,
}

impl Attached {
    /// What the flow remembers.
    fn past(&self, memories: &Memories) -> Past {
        Past::read(self.size, &memories.lists()[self.potential])
    }
}

impl AttachedFlow {
    /// Surrounds a sheet with air whose flow is attached to the faces: it flows along both sides and leaves
    /// at the trailing edges. The drag across these faces stays: at small angles it is small against the
    /// lift, and it bounds motions in which the flow would separate (Eloy, Kofman and Schouveiler, J. Fluid
    /// Mech. 691, 2012).
    ///
    /// # Errors
    /// [`AttachedFlowError`].
    pub fn around(&self, model: SheetModel, air: Air) -> Result<SheetModel, AttachedFlowError> {
        air.validate()?;
        let faces = self.faces.len();
        if faces > AttachedFlow::MOST_FACES {
            let most = AttachedFlow::MOST_FACES;
            return Err(AttachedFlowError::TooManyFaces { faces, most });
        }
        if !(2..=AttachedFlow::MOST_ROWS).contains(&self.rows) {
            return Err(AttachedFlowError::Rows { rows: self.rows });
        }
        let lengths = model.edges().lengths();
        let lattice = Lattice::new(model.topology(), lengths, &self.faces, &self.trailing)?;
        let attached = Attached {
            size: Size::of(&lattice, self.rows),
            air: Arc::new(InAir {
                lattice,
                density: air.density,
                wind: air.wind.clone(),
            }),
            potential: model.next_potential(),
        };
        let wake = Wake(attached.clone());
        let model = model.with_air(air)?;
        Ok(model.with_potential(wake).with_implicit_force(attached))
    }
}

/// The wake, which remembers and has no energy.
#[derive(Debug)]
struct Wake(Attached);

impl Potential for Wake {
    fn energy(&self, _at: At<'_>) -> f64 {
        0.0
    }

    fn add_gradient(&self, _at: At<'_>, _gradient: &mut [f64]) {}

    fn shape(&self) -> PotentialShape {
        PotentialShape::Linear
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        Some(self)
    }
}

impl Remembering for Wake {
    fn memory(&self) -> Vec<f64> {
        vec![0.0; self.0.size.len()]
    }

    fn start(&self, Reached { t, x, v }: Reached<'_>, memory: &mut [f64]) {
        let Attached { air, size, .. } = &self.0;
        let edge = air.lattice.edge(&air.lattice.shape(x));
        let none = vec![0.0; air.lattice.faces.len()];
        let mut past = Past::at_start(*size, t, none, &edge);
        // (Where there is no flow the first step says so.)
        if let Ok(flow) = air.flow(&past, t, x) {
            let circulation = air.circulation(&flow, v);
            past = Past::at_start(*size, t, circulation, &edge);
        }
        past.write(memory);
    }

    fn settle(&self, Reached { t, x, v }: Reached<'_>, memory: &mut [f64]) -> Settled {
        let Attached { air, size, .. } = &self.0;
        let past = Past::read(*size, memory);
        let mut past = past.carried(&air.wind, t - past.times[0]);
        if let Ok(flow) = air.flow(&past, t, x) {
            let circulation = air.circulation(&flow, v);
            past = flow.settled(t, circulation);
        }
        past.write(memory);
        Settled::default()
    }
}
