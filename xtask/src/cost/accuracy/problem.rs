//! The problems of the study.

use super::barrier::Barrier;
use crate::runs::{Pairs, bumped, corner, on_table};
use anyhow::Result;
use isosheet_collide::{ContactOptions, Contacts};
use isosheet_dynamics::contact::ContactError;
use isosheet_dynamics::{Method, SheetModel, Simulation, SimulationError, State};
use isosheet_mesh::{MassKind, MassMatrix, Sheet, VertexId};
use isosheet_tests::{FreeTriangle, Pendulum};
use std::fmt;

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Problem {
    /// A triangle pinned along an edge: the pendulum at large amplitude, exact by elliptic functions.
    Pendulum,
    /// A free triangle: Euler's rigid body, exact by elliptic functions and one quadrature.
    Triangle,
    /// A strip of so many links hanging from its pinned top edge, released at an angle.
    Strip(u32),
    /// The square sheet M^k held at a corner, released from a bumped, not flat state.
    Sheet(u32),
    /// The square sheet M^k, free and bumped, dropped onto a table smaller than itself.
    Cloth(u32),
}

/// Points of time at which positions are compared.
pub(crate) const CHECKPOINTS: usize = 8;

impl Problem {
    /// All of them with their names, easy ones first.
    pub(crate) const ALL: [(Self, &str); 10] = [
        (Self::Pendulum, "pendulum"),
        (Self::Triangle, "triangle"),
        (Self::Strip(2), "strip-2"),
        (Self::Strip(8), "strip-8"),
        (Self::Strip(64), "strip-64"),
        (Self::Sheet(0), "sheet-0"),
        (Self::Sheet(1), "sheet-1"),
        (Self::Sheet(2), "sheet-2"),
        (Self::Sheet(3), "sheet-3"),
        (Self::Cloth(2), "cloth-2"),
    ];

    /// Whether the motion is so smooth that the orders of the methods show: sheets flutter on finer scales
    /// than their steps.
    pub(crate) fn is_smooth(self) -> bool {
        matches!(self, Self::Pendulum | Self::Triangle)
    }

    /// Title for people, with the mark-up of drawings.
    pub(crate) fn title(self) -> String {
        match self {
            Self::Pendulum => "Triangle pinned along an edge".into(),
            Self::Triangle => "Free triangle".into(),
            Self::Strip(n) => format!("Hanging strip of {n} links"),
            Self::Sheet(k) => format!("Sheet M^{k} held at a corner"),
            Self::Cloth(k) => format!("Tablecloth M^{k}"),
        }
    }

    /// The set-up in words.
    pub(crate) fn about(self) -> String {
        let time = format!("{} s are compared.", self.duration());
        match self {
            Self::Pendulum => format!(
                "A pendulum of 0.7 m released at 2 rad, one period; exact by Jacobi functions. {:.4} s are compared.",
                self.duration()
            ),
            Self::Triangle => format!(
                "A tumbling triangle without gravity, one period of its spin; the spin is exact by Jacobi functions, the attitude follows \
                 from it by quadrature to round-off. {:.4} s are compared.",
                self.duration()
            ),
            Self::Strip(n) => format!(
                "A strip 1 m long and 0.3 m wide of {n} rigid links (each cut by a diagonal, 0.1 kg in all, lumped), pinned along its top edge, \
                 straight, {STRIP_ANGLE} rad from the vertical, released at rest. {time}"
            ),
            Self::Sheet(k) => format!(
                "The union-jack square M^{k}, 1 m, 0.1 kg, lumped, horizontal with z = {BUMP} sin(πx) sin(πy) as the rest shape, held at the corner \
                 (0, 1), released at rest. {time}"
            ),
            Self::Cloth(k) => format!(
                "The same bumped square M^{k}, free, dropped onto a square table of side {} m whose top is at z = {TABLE_TOP} m, without friction. \
                 {time} Implicit Euler and BDF2 take contact, and check every motion for collisions. All other methods know the barrier as a \
                 potential like any other: the same energy, but no check, so that they pass through the table where their steps are too long. \
                 Reference and second opinion are of that kind, and not of the methods whose contact is measured.",
                2.0 * TABLE[0]
            ),
        }
    }

    /// The time over which motions are compared at most, seconds.
    pub(crate) fn duration(self) -> f64 {
        match self {
            Self::Pendulum => Pendulum::default().period(),
            Self::Triangle => FreeTriangle::default().period(),
            Self::Strip(2) => 1.6,
            Self::Strip(8) => 0.8,
            Self::Strip(_) => 0.4,
            Self::Sheet(0) => 0.8,
            Self::Sheet(1) => 0.4,
            Self::Sheet(2) => 0.24,
            Self::Sheet(_) => 0.08,
            Self::Cloth(_) => 0.16,
        }
    }

    /// The sheet, in the position of the start.
    pub(crate) fn sheet(self) -> Result<Sheet> {
        Ok(match self {
            Self::Pendulum => Sheet::new(Pendulum::default().start().x, &[[0, 1, 2]])?,
            Self::Triangle => Sheet::new(FreeTriangle::default().start().x, &[[0, 1, 2]])?,
            Self::Strip(links) => strip(links)?,
            Self::Sheet(level) | Self::Cloth(level) => bumped(level, BUMP),
        })
    }

    /// The vertices that are held.
    pub(crate) fn pins(self) -> Vec<VertexId> {
        match self {
            Self::Pendulum | Self::Strip(_) => vec![VertexId(0), VertexId(1)],
            Self::Triangle | Self::Cloth(_) => Vec::new(),
            Self::Sheet(level) => vec![corner(level)],
        }
    }

    /// The mechanical system, contact left out.
    pub(super) fn without_contact(self) -> Result<SheetModel> {
        Ok(match self {
            Self::Pendulum => Pendulum::default().model(),
            Self::Triangle => {
                let masses = vec![FreeTriangle::default().vertex_mass; 3];
                SheetModel::with_mass(&self.sheet()?, MassMatrix::from_vertex_masses(masses)?)?
            }
            Self::Strip(_) | Self::Sheet(_) | Self::Cloth(_) => {
                SheetModel::new(&self.sheet()?, 0.1, MassKind::Lumped)?
                    .with_gravity()
                    .with_pins(&self.pins())?
            }
        })
    }

    /// Contact, where there is any.
    pub(super) fn contacts(self) -> Result<Option<Contacts>> {
        if !matches!(self, Self::Cloth(_)) {
            return Ok(None);
        }
        let model = self.without_contact()?;
        let options = ContactOptions::for_sheet(&model);
        Ok(Some(on_table(
            &model,
            options,
            (TABLE, TABLE_TOP),
            Pairs::Table,
        )?))
    }

    /// The mechanical system as methods without a place for contact see it: the barrier is a potential.
    pub(crate) fn model(self) -> Result<SheetModel> {
        let model = self.without_contact()?;
        Ok(match self.contacts()? {
            None => model,
            Some(contacts) => {
                let barrier = Barrier::new(contacts, &model, &self.start()?)?;
                model.with_potential(barrier)
            }
        })
    }

    /// The problem at a state by a method without a chart; with contact where the method takes it. The inner
    /// error is that of the method.
    pub(crate) fn simulation(
        self,
        method: &Method,
        state: State,
    ) -> Result<std::result::Result<Simulation, SimulationError>> {
        if let Some(contacts) = self.contacts()? {
            let run = Simulation::new(self.without_contact()?, state.clone(), method.clone())
                .and_then(|run| run.with_contact(contacts));
            if !matches!(run, Err(SimulationError::Contact(ContactError::Method))) {
                return Ok(run);
            }
        }
        Ok(Simulation::new(self.model()?, state, method.clone()))
    }

    /// Positions and velocities at the start.
    pub(crate) fn start(self) -> Result<State> {
        Ok(match self {
            Self::Triangle => FreeTriangle::default().start(),
            _ => State::at_rest(self.sheet()?.positions().to_vec()),
        })
    }

    /// Exact positions at the given increasing times, where they are known.
    pub(crate) fn exact(self, times: &[f64]) -> Option<Vec<Vec<f64>>> {
        match self {
            Self::Pendulum => {
                let problem = Pendulum::default();
                Some(times.iter().map(|t| problem.exact(*t)).collect())
            }
            Self::Triangle => Some(FreeTriangle::default().positions(times)),
            Self::Strip(_) | Self::Sheet(_) | Self::Cloth(_) => None,
        }
    }
}

/// Angle of the released strips from the vertical, radians.
const STRIP_ANGLE: f64 = 0.5;

/// Height of the bump of the released sheets, metres.
const BUMP: f64 = 0.1;

/// Half of the sides of the table, metres. Its corners are below no vertex and no edge of the cloths.
const TABLE: [f64; 3] = [0.26, 0.26, 0.1];

/// Height of the table's top, metres: some millimetres below the lowest part of the cloth above it.
pub(super) const TABLE_TOP: f64 = 0.04;

fn strip(links: u32) -> Result<Sheet> {
    let (s, c) = STRIP_ANGLE.sin_cos();
    let positions = (0..=links)
        .flat_map(|row| {
            let r = f64::from(row) / f64::from(links);
            [0.0, r * s, -r * c, 0.3, r * s, -r * c]
        })
        .collect();
    let faces: Vec<[u32; 3]> = (0..links)
        .flat_map(|row| {
            let i = 2 * row;
            [[i, i + 2, i + 1], [i + 1, i + 2, i + 3]]
        })
        .collect();
    Ok(Sheet::new(positions, &faces)?)
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = Self::ALL.iter().find(|(problem, _)| problem == self);
        match named {
            Some((_, name)) => f.write_str(name),
            None => write!(f, "{self:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_tests::max_difference;

    #[test]
    fn starts_fit_their_models() {
        for (problem, name) in Problem::ALL {
            assert_eq!(problem.to_string(), name);
            let run = problem.simulation(&Method::default(), problem.start().unwrap());
            let run = run.unwrap().unwrap();
            assert_eq!(
                run.contacts().is_some(),
                matches!(problem, Problem::Cloth(_))
            );
        }
    }

    /// The attitude against the chart-free motion, and the corners against the lengths.
    #[test]
    fn the_tumbling_triangle_is_exact() {
        let problem = Problem::Triangle;
        let end = 0.25 * problem.duration();
        let exact = problem.exact(&[0.5 * end, end]).unwrap();
        let rods = problem.model().unwrap().rods().max_strain(&exact[1]);
        assert!(rods < 1e-12, "strain {rods:e}");
        let method = Method::RattleComposition(Default::default());
        let mut run =
            Simulation::new(problem.model().unwrap(), problem.start().unwrap(), method).unwrap();
        run.run(end, end / 400.0, &mut []).unwrap();
        let gap = max_difference(&run.state().x, &exact[1]);
        assert!(gap < 1e-10, "{gap:e} m");
    }
}
