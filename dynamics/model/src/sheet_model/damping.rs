//! Velocity damping of sheets.

use super::PINNED;
use super::damped_range::Damping;
use crate::{ModelError, SheetModel};
use std::ops::Range;

impl SheetModel {
    /// Sets the rate `gamma` (1/s) of the velocity damping: a force `-gamma M v` on all vertices of sheets
    /// that are not pinned, the paper's "we add this damping force to the velocity" (Sec. 6).
    ///
    /// Every method takes it exactly where nothing else acts, `v(t + h) = v(t) exp(-gamma h)`, and keeps its
    /// order with it: backward differentiation formulas act on `v exp(gamma t)` (the integrating factor of J.
    /// D. Lawson, SIAM J. Numer. Anal. 4, 1967), and energy-momentum and RATTLE stand between two halves of
    /// it (G. Strang, SIAM J. Numer. Anal. 5, 1968). In a chart it follows each step as published, with an
    /// error of first order.
    ///
    /// # Errors
    /// [`ModelError::Damping`] if the rate is negative or not finite.
    pub fn with_damping(self, rate: f64) -> Result<Self, ModelError> {
        let all = 0..self.sheet_vertices;
        self.with_dampings([(all, rate)])
    }

    /// As [`SheetModel::with_damping`], with a rate for each of several sheets, whose vertices these are;
    /// without damping elsewhere.
    ///
    /// # Errors
    /// [`ModelError::Damping`] if a rate is negative or not finite.
    pub fn with_dampings(
        mut self,
        sheets: impl IntoIterator<Item = (Range<usize>, f64)>,
    ) -> Result<Self, ModelError> {
        self.damping.clear();
        for (vertices, rate) in sheets {
            if !(rate.is_finite() && rate >= 0.0) {
                return Err(ModelError::Damping { rate });
            }
            match self.damping.last_mut() {
                Some(last) if last.rate == rate && last.vertices.end == vertices.start => {
                    last.vertices.end = vertices.end;
                }
                _ => self.damping.push(Damping { vertices, rate }),
            }
        }
        Ok(self)
    }

    /// The rate of the velocity damping, 1/s, if that is the same of all sheets.
    pub fn damping(&self) -> Option<f64> {
        match &self.damping[..] {
            [] => Some(0.0),
            [all] if all.vertices.len() >= self.sheet_vertices => Some(all.rate),
            several => several.iter().all(|own| own.rate == 0.0).then_some(0.0),
        }
    }

    /// The coordinates of what is damped, each with the part of its velocities that `h` seconds leave.
    fn damped(&self, h: f64) -> impl Iterator<Item = (Range<usize>, f64)> {
        let damped = self.damping.iter().filter(|own| own.rate > 0.0);
        damped.map(move |own| {
            let end = own.vertices.end.min(self.sheet_vertices);
            let coordinates = 3 * own.vertices.start.min(end)..3 * end;
            (coordinates, (-own.rate * h).exp())
        })
    }

    /// Leaves of velocities (`3V`) what damping over `h` seconds leaves of them; pinned vertices keep theirs.
    pub fn damp(&self, v: &mut [f64], h: f64) {
        for (coordinates, factor) in self.damped(h) {
            let free = &self.free_index[coordinates.start / 3..coordinates.end / 3];
            let rows = v[coordinates].as_chunks_mut::<3>().0.iter_mut().zip(free);
            for (row, _) in rows.filter(|(_, index)| **index != PINNED) {
                row.iter_mut().for_each(|v| *v *= factor);
            }
        }
    }

    /// Damps velocities (`3V`, metres per second) over `h` seconds; the energy that this takes, joules.
    pub fn brake(&self, v: &mut [f64], h: f64) -> f64 {
        if self.damped(h).next().is_none() {
            return 0.0;
        }
        let before = self.kinetic_energy(v);
        self.damp(v, h);
        before - self.kinetic_energy(v)
    }

    /// The energy that damping takes from velocities (`3V`, metres per second) in `h` seconds, joules.
    pub fn damping_loss(&self, v: &[f64], h: f64) -> f64 {
        if self.damped(h).next().is_none() {
            return 0.0;
        }
        self.brake(&mut v.to_vec(), h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{MassKind, generate};

    #[test]
    fn rates_that_make_no_sense_are_refused() {
        let sheet = generate::isotropic_square(1, 0.1).expect("a square");
        for rate in [-1.0, f64::NAN, f64::INFINITY] {
            let model = SheetModel::new(&sheet, 0.2, MassKind::Lumped).expect("a model");
            let refused = model.with_dampings([(0..5, 1.0), (5..25, rate)]);
            assert!(matches!(refused, Err(ModelError::Damping { .. })));
        }
    }
}
