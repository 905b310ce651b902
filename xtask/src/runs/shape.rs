//! How a hanging sheet looks, in numbers.

use super::Scene;
use anyhow::Result;
use isosheet_mesh::{MassKind, MassMatrix, Sheet, VertexId, fold_angle};
use serde::{Deserialize, Serialize};

/// Measures of a state of a sheet that is held at a corner. Lengths in sides of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Shape {
    /// Depth of the centre of mass below the pin.
    pub(crate) centre_depth: f64,
    /// Depth of the corner opposite to the pin.
    pub(crate) corner_depth: f64,
    /// Largest horizontal distance between two vertices.
    pub(crate) extent: f64,
    /// Root of the mean square of the fold angles, weighted by edge length, degrees.
    pub(crate) fold: f64,
    /// Depth of the centre of mass that no sheet can exceed: every mass straight below the pin at its distance from it.
    pub(crate) deepest: f64,
}

/// Depth of the centre of mass of a rigid square plate that hangs from a corner, sides: half a diagonal.
pub(crate) const PLATE: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl Shape {
    /// Measures the positions `x`.
    pub(crate) fn of(scene: &Scene, sheet: &Sheet, x: &[f64]) -> Result<Self> {
        let t = sheet.topology();
        let at = |v: VertexId| [x[3 * v.index()], x[3 * v.index() + 1], x[3 * v.index() + 2]];
        let pin = scene.pin();
        let mass = MassMatrix::from_total(sheet, 1.0, MassKind::Lumped)?.vertex;
        let distance = |v: VertexId| {
            let (p, q) = (sheet.position(pin), sheet.position(v));
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let depth = |v: VertexId| at(pin)[2] - at(v)[2];
        let mean = |f: &dyn Fn(VertexId) -> f64| t.vertex_ids().map(|v| mass[v.index()] * f(v)).sum::<f64>();
        let far = t.vertex_ids().max_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(pin);
        let mut extent: f64 = 0.0;
        for a in t.vertex_ids() {
            for b in t.vertex_ids() {
                let (p, q) = (at(a), at(b));
                extent = extent.max((p[0] - q[0]).hypot(p[1] - q[1]));
            }
        }
        let (mut square, mut length) = (0.0, 0.0);
        for e in t.edge_ids() {
            if let Some(fold) = fold_angle(t, x, e) {
                let l = sheet.lengths()[e.index()];
                square += l * fold * fold;
                length += l;
            }
        }
        Ok(Self {
            centre_depth: mean(&depth) / scene.side,
            corner_depth: depth(far) / scene.side,
            extent: extent / scene.side,
            fold: (square / length).sqrt().to_degrees(),
            deepest: mean(&distance) / scene.side,
        })
    }

    /// Part of the way from the rigid plate to the deepest centre of mass possible: 0 for a plate that hangs flat, 1 for a
    /// sheet gathered into a line.
    pub(crate) fn softness(&self) -> f64 {
        (self.centre_depth - PLATE) / (self.deepest - PLATE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_that_hangs_flat_has_softness_zero() {
        let scene = Scene::paper(2, 1);
        let sheet = scene.sheet().unwrap();
        // Turned so that the diagonal from the pin points down.
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let x: Vec<f64> = sheet
            .positions()
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|p| {
                let (u, w) = (p[0], scene.side - p[1]);
                [h * (u - w), 0.0, -h * (u + w)]
            })
            .collect();
        let shape = Shape::of(&scene, &sheet, &x).unwrap();
        assert!((shape.centre_depth - PLATE).abs() < 1e-12 && shape.softness().abs() < 1e-10);
        assert!((shape.corner_depth - 2f64.sqrt()).abs() < 1e-12);
        assert!((shape.extent - 2f64.sqrt()).abs() < 1e-12);
        assert!(shape.fold < 1e-5);
    }

    #[test]
    fn the_bound_tends_to_the_mean_distance_from_a_corner() {
        // Mean distance of the points of the unit square from a corner.
        let exact = (2f64.sqrt() + (1.0 + 2f64.sqrt()).ln()) / 3.0;
        let deepest = |level| {
            let scene = Scene::paper(level, 1);
            let sheet = scene.sheet().unwrap();
            Shape::of(&scene, &sheet, sheet.positions()).unwrap().deepest - exact
        };
        assert!(deepest(4).abs() < 0.3 * deepest(3).abs() && deepest(4).abs() < 1e-3);
    }
}
