//! The bodies of a scene in its simulation.

use isosheet_dynamics::Simulation;
use isosheet_dynamics::contact::CarriedPoint;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;
use std::ops::Range;

/// A body as the vertices of a model carry it.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedBody {
    /// Its vertices.
    pub(crate) vertices: [VertexId; 4],
    /// The weights of these at its centre of mass.
    pub(crate) centre: CarriedPoint,
    /// The vertices of its surface, by their numbers among those of the sheets and of all surfaces.
    pub(crate) surface: Range<usize>,
}

/// What acts on a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyLoad {
    /// Force, newtons.
    pub force: [f64; 3],
    /// Torque about its centre of mass, newton metres.
    pub torque: [f64; 3],
}

impl CarriedBody {
    /// Its mean by the weights of its centre of mass: the place of the centre of positions, its velocity of
    /// velocities (`3V`).
    pub fn centre(&self, x: &[f64]) -> [f64; 3] {
        let parts = self.centre.iter().map(|(v, b)| *b * of_vertex(x, *v));
        parts.sum::<Vector3<f64>>().into()
    }

    /// The sum of forces on the vertices of the model (`3V`, newtons).
    fn load(&self, x: &[f64], forces: &[f64]) -> BodyLoad {
        let centre = Vector3::from(self.centre(x));
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for v in self.vertices {
            let own = of_vertex(forces, v);
            force += own;
            torque += (of_vertex(x, v) - centre).cross(&own);
        }
        BodyLoad {
            force: force.into(),
            torque: torque.into(),
        }
    }

    /// What touches bodies, does to each of them at the end of the last step. (The forces on its vertices have
    /// the sum and the torque of those on its surface.)
    pub(crate) fn contact_loads(bodies: &[Self], simulation: &Simulation) -> Vec<BodyLoad> {
        let forces = match bodies {
            [] => None,
            _ => simulation.contact_forces(),
        };
        let x = &simulation.state().x;
        let load = |body: &Self| forces.as_ref().map(|forces| body.load(x, forces));
        bodies
            .iter()
            .map(|body| load(body).unwrap_or_default())
            .collect()
    }
}

fn of_vertex(values: &[f64], v: VertexId) -> Vector3<f64> {
    Vector3::from(values.as_chunks::<3>().0[v.index()])
}
