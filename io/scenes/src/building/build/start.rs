//! Where sheets and bodies are at the start, and how they move.

use super::builder::{Builder, StartPlaces};
use crate::placing::placed::PlacedSheet;
use crate::sheets::sheet::{IsometryKey, SheetKey};
use crate::words::error::SceneError;
use isosheet_dynamics::{State, leave_flat_in, project_positions};
use nalgebra::Vector3;

/// Relative error of edge lengths to which positions are projected: that of accepted steps.
const EXACT: f64 = 1e-12;

/// Largest relative error of an edge length that is taken for rounding. A file of six digits rounds the
/// coordinates of a sheet of size 1 by 5e-7, and edges of a hundredth of the sheet by 1e-4 of their length.
const ROUNDING: f64 = 1e-4;

impl Builder<'_> {
    /// The start is that of the scene as it was, whatever holds the sheets now.
    pub(super) fn mend_start(&mut self) -> Result<(), SceneError> {
        match &self.kept.start {
            Some(start) if !self.switches.are_at_start(self.scene) => {
                self.x.clone_from(&start.mended);
            }
            _ => {
                self.mend_lengths()?;
                self.kept.start = Some(StartPlaces {
                    mended: self.x.clone(),
                    perturbed: Vec::new(),
                });
            }
        }
        Ok(())
    }

    fn mend_lengths(&mut self) -> Result<(), SceneError> {
        let of_file =
            |sheet: &SheetKey| sheet.isometry() == IsometryKey::Rods && sheet.start.has_shape();
        if !self.scene.sheet.iter().any(of_file) {
            return Ok(());
        }
        self.part_rods()?;
        if (EXACT..=ROUNDING).contains(&self.model().rods().max_strain(&self.x)) {
            let mut mended = self.x.clone();
            if project_positions(self.model(), &mut mended, EXACT).is_ok() {
                self.x = mended;
            }
        }
        Ok(())
    }

    /// Displaces the vertices at the start at random, or as they were when the scene was built before.
    pub(super) fn perturb_start(&mut self) -> Result<(), SceneError> {
        if !self.switches.are_at_start(self.scene)
            && let Some(start) = &self.kept.start
        {
            self.x.clone_from(&start.perturbed);
            return Ok(());
        }
        self.perturb()?;
        if let Some(start) = &mut self.kept.start {
            start.perturbed.clone_from(&self.x);
        }
        Ok(())
    }

    fn perturb(&mut self) -> Result<(), SceneError> {
        let mut x = std::mem::take(&mut self.x);
        let mut is_perturbed = false;
        for PlacedSheet { of, part, .. } in &self.sheets.list {
            let (size, seed) = (of.start.perturbation, of.start.seed);
            if size > 0.0 {
                leave_flat_in(self.model(), part.vertices.clone(), &mut x, size, seed)
                    .map_err(|e| SceneError::from(self.origins.of_start(&e)))?;
                is_perturbed = true;
            }
        }
        self.x = x;
        if is_perturbed {
            self.modelled
                .push("random displacement at the start".into());
        }
        Ok(())
    }

    pub(super) fn start(&mut self) -> State {
        let mut v = vec![0.0; self.x.len()];
        for PlacedSheet { of, part, form, .. } in &self.sheets.list {
            if !of.start.is_moving() {
                continue;
            }
            let points = self.x[part.coordinates()].as_chunks::<3>().0;
            let masses = &self.model().mass().vertex[part.vertices.clone()];
            let moment = points
                .iter()
                .zip(masses)
                .map(|(p, m)| *m * Vector3::from(*p));
            let centre = moment.sum::<Vector3<f64>>() / masses.iter().sum::<f64>();
            let velocities = of.start.velocities(points, centre);
            v[part.coordinates()].copy_from_slice(velocities.as_flattened());
            let further = form.velocities.iter().flatten();
            for (v, further) in v[part.coordinates()].iter_mut().zip(further) {
                *v += further;
            }
        }
        for body in &self.bodies.list {
            let first = 3 * body.first.index();
            v[first..first + 12].copy_from_slice(body.velocities().as_flattened());
        }
        for pin in self.model().pins() {
            v[3 * pin.index()..3 * pin.index() + 3].fill(0.0);
        }
        if v.iter().any(|v| *v != 0.0) {
            self.modelled.push("velocities at the start".into());
        }
        State::moving(std::mem::take(&mut self.x), v)
    }
}
