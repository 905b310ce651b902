//! The angle at which air comes to sheets along which it flows.

use isosheet_mesh::wording::brief;
use isosheet_scenes::{AttachedFlowKey, Scene, UnderWay};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::fmt;

/// An angle between sheet and relative wind, the mean of the faces by what blows at them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Incidence {
    /// Degrees, from 0 along the sheet to 90 across.
    pub angle: f64,
    /// Time, seconds.
    pub t: f64,
}

impl fmt::Display for Incidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (angle, t) = (brief(self.angle), brief(self.t));
        write!(f, "{angle} degrees at {t} s")
    }
}

impl Incidence {
    /// The angle after a step of a scene with attached flow; none where no air comes to its sheets.
    pub(crate) fn after(scene: &Scene, under_way: &UnderWay) -> Option<Self> {
        let air = scene.air.as_ref()?;
        let AttachedFlowKey { sheet, .. } = air.attached.as_ref()?;
        let (model, state) = (under_way.simulation.model(), under_way.simulation.state());
        let wind = air
            .wind
            .each_ref()
            .map(|component| component.value(state.t));
        let at = |values: &[f64], v: usize| Vector3::from_column_slice(&values[3 * v..3 * v + 3]);
        let (mut across, mut whole) = (0.0, 0.0);
        for faces in under_way.facts.faces_of_sheets(sheet.as_deref()) {
            for corners in &model.topology().faces()[faces] {
                let [a, b, c] = corners.map(|v| at(&state.x, v.index()));
                let velocity = corners
                    .map(|v| at(&state.v, v.index()))
                    .iter()
                    .sum::<Vector3<f64>>()
                    / 3.0;
                let (area, relative) = ((b - a).cross(&(c - a)), Vector3::from(wind) - velocity);
                across += area.dot(&relative).abs();
                whole += area.norm() * relative.norm();
            }
        }
        (whole > 0.0).then(|| Self {
            angle: (across / whole).min(1.0).asin().to_degrees(),
            t: state.t,
        })
    }

    /// The larger one of two.
    pub(crate) fn larger(self, other: Option<Self>) -> Self {
        match other {
            Some(other) if other.angle >= self.angle => other,
            _ => self,
        }
    }
}
