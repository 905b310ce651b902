//! The bodies of a scene in its simulation.

use isosheet_dynamics::Simulation;
use isosheet_dynamics::contact::CarriedPoint;
use isosheet_mesh::{Part, VertexId};
use nalgebra::Vector3;
use std::ops::Range;

/// A body as the vertices of a model carry it.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedBody {
    /// Its vertices.
    pub vertices: [VertexId; 4],
    /// The weights of these at its centre of mass.
    pub(crate) centre: CarriedPoint,
    /// The weights at the point about which torques of its guide are given, if it has one.
    pub(crate) pivot: Option<CarriedPoint>,
    /// Where its surface is among the sheets and the surfaces of all bodies.
    pub(crate) part: Part,
    /// Whether it touches by its true surface and not by the one that is seen.
    pub(crate) is_round: bool,
}

/// What acts on a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force, newtons.
    pub force: [f64; 3],
    /// Torque, newton metres: of contact about its centre of mass, of a guide about the point of that.
    pub torque: [f64; 3],
}

impl Wrench {
    /// The sum of forces on vertices at positions `x`, with its torque about a point.
    fn sum(
        forces: impl IntoIterator<Item = (VertexId, Vector3<f64>)>,
        x: &[f64],
        about: Vector3<f64>,
    ) -> Self {
        let (mut sum, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (v, force) in forces {
            sum += force;
            torque += (of_vertex(x, v) - about).cross(&force);
        }
        Self {
            force: sum.into(),
            torque: torque.into(),
        }
    }
}

impl Wrench {
    /// The sum of the forces on some vertices, of those on all (`3V`), with its torque about a point.
    pub(crate) fn of_vertices(
        vertices: impl IntoIterator<Item = VertexId>,
        forces: &[f64],
        x: &[f64],
        about: Vector3<f64>,
    ) -> Self {
        let own = vertices.into_iter().map(|v| (v, of_vertex(forces, v)));
        Self::sum(own, x, about)
    }
}

impl CarriedBody {
    /// Its mean by the weights of its centre of mass: the place of the centre of positions, its velocity of
    /// velocities (`3V`).
    pub fn centre(&self, x: &[f64]) -> [f64; 3] {
        of_point(x, &self.centre).into()
    }

    /// The vertices of the model that carry it.
    pub fn vertices(&self) -> [VertexId; 4] {
        self.vertices
    }

    /// The vertices of its surface, by their numbers among the vertices of the sheets and of all surfaces.
    pub fn surface(&self) -> Range<usize> {
        self.part.vertices.clone()
    }

    /// Adds to the forces on the surfaces that are seen (`3V`, newtons), at positions `x`, those on bodies
    /// that touch by others: the whole of each where its surface reaches farthest against it, which is where
    /// a round body is touched.
    pub fn add_round_forces(
        bodies: &[Self],
        simulation: &Simulation,
        x: &[f64],
        forces: &mut [f64],
    ) {
        let round = bodies.iter().any(|body| body.is_round);
        if !round || forces.is_empty() {
            return;
        }
        let loads = Self::contact_loads(bodies, simulation);
        for (body, load) in bodies.iter().zip(loads).filter(|(body, _)| body.is_round) {
            let force = Vector3::from(load.force);
            let along = |v: &usize| force.dot(&of_vertex(x, VertexId::from_index(*v)));
            let touched = body.surface().min_by(|a, b| along(a).total_cmp(&along(b)));
            let place = touched.map_or(0..0, |v| 3 * v..3 * v + 3);
            for (sum, f) in forces[place].iter_mut().zip(&force) {
                *sum += f;
            }
        }
    }

    /// What its guide does to it, if it has one: the torque about the point of a hinge or a ball joint, or
    /// about the centre of mass on a slider.
    pub fn guide_load(&self, simulation: &Simulation) -> Option<Wrench> {
        let x = &simulation.state().x;
        let pivot = of_point(x, self.pivot.as_ref()?);
        let reactions = simulation.reactions().into_iter();
        let own = reactions.filter_map(|reaction| {
            let vertex = reaction.support.vertex();
            self.vertices
                .contains(&vertex)
                .then_some((vertex, reaction.force))
        });
        Some(Wrench::sum(own, x, pivot))
    }

    /// What touches bodies, does to each of them at the end of the last step. (The forces on its vertices
    /// have the sum and the torque of those on its surface.)
    pub fn contact_loads(bodies: &[Self], simulation: &Simulation) -> Vec<Wrench> {
        let forces = match bodies {
            [] => None,
            _ => simulation.contact_forces(),
        };
        let x = &simulation.state().x;
        let load = |body: &Self| {
            let forces = forces.as_ref()?;
            let centre = of_point(x, &body.centre);
            Some(Wrench::of_vertices(body.vertices, forces, x, centre))
        };
        bodies
            .iter()
            .map(|body| load(body).unwrap_or_default())
            .collect()
    }
}

fn of_point(values: &[f64], at: &CarriedPoint) -> Vector3<f64> {
    at.iter().map(|(v, b)| *b * of_vertex(values, *v)).sum()
}

fn of_vertex(values: &[f64], v: VertexId) -> Vector3<f64> {
    Vector3::from(values.as_chunks::<3>().0[v.index()])
}
