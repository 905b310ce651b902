//! The sizes of accelerations and speeds that barriers have to withstand.

use crate::{SheetModel, State};
use isosheet_materials::potential::At;
use isosheet_materials::vectors::largest_norm;
use isosheet_materials::{PAPER_GRAVITY, PotentialShape};
use nalgebra::Vector3;

/// What a barrier has to withstand, estimated at a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadScale {
    /// Largest acceleration of a vertex by constant forces, metres per second squared; 9.8 if there are none.
    pub acceleration: f64,
    /// Largest speed of a vertex, metres per second.
    pub speed: f64,
}

impl LoadScale {
    /// Of a sheet at a state.
    pub fn at(model: &SheetModel, state: &State) -> Self {
        Self {
            acceleration: constant_acceleration(model, state)
                .unwrap_or_else(|| Vector3::from(PAPER_GRAVITY).norm()),
            speed: largest_norm(&state.v),
        }
    }
}

impl SheetModel {
    /// Tells an elastic sheet what its barrier has to withstand, for a simulation that starts or goes on at a
    /// state.
    pub fn set_load(&mut self, state: &State) {
        let acceleration = LoadScale::at(self, state).acceleration;
        // Of what there is besides, the mass is no measure: it may be anywhere.
        let masses = self.mass.row_sums(&self.topology);
        let (total, all) = (self.mass.total(), masses.iter().sum::<f64>());
        if let Some(elastic) = &mut self.elastic {
            let own: f64 = masses[elastic.vertices()].iter().sum();
            elastic.set_load(total * (own / all), acceleration);
        }
    }
}

/// Largest acceleration of a vertex by potentials that are linear, metres per second squared; nothing if they
/// accelerate none.
pub fn constant_acceleration(model: &SheetModel, state: &State) -> Option<f64> {
    let mut gradient = vec![0.0; state.x.len()];
    for p in model.potentials() {
        if p.shape() == PotentialShape::Linear {
            p.add_gradient(At::new(state.t, &state.x), &mut gradient);
        }
    }
    for (g, m) in gradient
        .as_chunks_mut::<3>()
        .0
        .iter_mut()
        .zip(&model.mass().vertex)
    {
        g.iter_mut().for_each(|g| *g /= m);
    }
    let largest = largest_norm(&gradient);
    (largest > 0.0 && largest.is_finite()).then_some(largest)
}
