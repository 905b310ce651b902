//! How a hanging sheet looks, in numbers.

use super::Hanging;
use anyhow::Result;
use isosheet_mesh::{EdgeId, MassKind, MassMatrix, VertexId, fold_angle};
use serde::{Deserialize, Serialize};

/// Measures of a state of a sheet that is held at a corner. Lengths in sides of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SheetShape {
    /// Depth of the centre of mass below the pin.
    pub(crate) centre_depth: f64,
    /// Largest horizontal distance between two vertices.
    pub(crate) extent: f64,
    /// Total bending: the sum of edge length times size of the fold angle, radians times sides. Unlike the
    /// fold angles themselves it does not depend on how many edges share a bend.
    pub(crate) bending: f64,
}

/// Depth of the centre of mass of a rigid square plate that hangs from a corner, sides: half a diagonal.
pub(crate) const PLATE: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl SheetShape {
    /// Measures the positions `x`.
    pub(crate) fn of(hanging: &Hanging, x: &[f64]) -> Result<Self> {
        let (sheet, side) = (&hanging.sheet, hanging.side);
        let t = sheet.topology();
        let at = |v: VertexId| [x[3 * v.index()], x[3 * v.index() + 1], x[3 * v.index() + 2]];
        let pin = hanging.pin;
        let mass = MassMatrix::from_total(sheet, 1.0, MassKind::Lumped)?.vertex;
        let depth = |v: VertexId| at(pin)[2] - at(v)[2];
        let mean = |f: &dyn Fn(VertexId) -> f64| {
            t.vertex_ids().map(|v| mass[v.index()] * f(v)).sum::<f64>()
        };
        let mut extent: f64 = 0.0;
        for a in t.vertex_ids() {
            for b in t.vertex_ids() {
                let (p, q) = (at(a), at(b));
                extent = extent.max((p[0] - q[0]).hypot(p[1] - q[1]));
            }
        }
        let bend = |e: EdgeId| {
            fold_angle(t, x, e).map_or(0.0, |fold| sheet.lengths()[e.index()] * fold.abs())
        };
        Ok(Self {
            centre_depth: mean(&depth) / side,
            extent: extent / side,
            bending: t.edge_ids().map(bend).sum::<f64>() / side,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::FigureScene;

    /// The sheet of Fig. 12 with another mesh.
    fn hanging(level: u32) -> Hanging {
        let edits = [format!("sheet.mesh.square.level={level}")];
        let scene = FigureScene::of("fig12", "test", &edits).unwrap();
        Hanging::of(&scene).unwrap()
    }

    #[test]
    fn the_pin_is_the_left_upper_corner() {
        for level in 0..4 {
            let hanging = hanging(level);
            assert_eq!(
                hanging.sheet.position(hanging.pin),
                [0.0, hanging.side, 0.0]
            );
        }
    }

    #[test]
    fn a_plate_that_hangs_flat() {
        let hanging = hanging(2);
        let sheet = &hanging.sheet;
        // Turned so that the diagonal from the pin points down.
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let x: Vec<f64> = sheet
            .positions()
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|p| {
                let (u, w) = (p[0], hanging.side - p[1]);
                [h * (u - w), 0.0, -h * (u + w)]
            })
            .collect();
        let shape = SheetShape::of(&hanging, &x).unwrap();
        assert!((shape.centre_depth - PLATE).abs() < 1e-12);
        assert!((shape.extent - 2f64.sqrt()).abs() < 1e-12);
        assert!(shape.bending < 1e-5);
    }

    #[test]
    fn a_sheet_folded_in_half_along_the_diagonal_has_the_centroid_of_a_triangle() {
        let hanging = hanging(1);
        let sheet = &hanging.sheet;
        // In the plane of the triangle with corners pin (0, 0), far (0, -sqrt 2) and side (h, -h), then
        // turned so that the centroid is below the pin.
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let tilt = (h / 3.0f64).atan2((2f64.sqrt() + h) / 3.0);
        let (s, c) = tilt.sin_cos();
        let x: Vec<f64> = sheet
            .positions()
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|p| {
                let (u, w) = (p[0], hanging.side - p[1]);
                let (across, down) = ((h * (u - w)).abs(), h * (u + w));
                [c * across - s * down, 0.0, -s * across - c * down]
            })
            .collect();
        let shape = SheetShape::of(&hanging, &x).unwrap();
        assert!(
            (shape.centre_depth - 5f64.sqrt() / 3.0).abs() < 1e-12,
            "{shape:?}"
        );
        assert!((shape.bending - 2f64.sqrt() * std::f64::consts::PI).abs() < 1e-10);
    }
}
