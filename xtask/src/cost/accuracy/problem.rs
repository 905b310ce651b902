//! The problems of the study.

use super::barrier::Barrier;
use crate::runs::{Pairs, bumped, corner, on_table};
use anyhow::Result;
use isosheet_collide::{ContactOptions, Contacts};
use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use isosheet_tests::{FreeTriangle, Pendulum, strip_faces};

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
pub(super) const CHECKPOINTS: usize = 8;

/// A problem at its start.
pub(super) struct Setup {
    /// The mechanical system, contact left out.
    pub(super) model: SheetModel,
    pub(super) state: State,
    pub(super) contacts: Option<Contacts>,
}

impl Setup {
    /// The mechanical system as methods without a place for contact see it: the barrier is a potential.
    pub(super) fn with_barrier(self) -> Result<(SheetModel, State)> {
        let Self { model, state, .. } = self;
        let Some(contacts) = self.contacts else {
            return Ok((model, state));
        };
        let barrier = Barrier::new(contacts, &model, &state)?;
        Ok((model.with_potential(barrier), state))
    }
}

impl Problem {
    /// All of them with their names and their titles, easy ones first.
    pub(super) const ALL: [(Self, &str, &str); 10] = [
        (Self::Pendulum, "pendulum", "Triangle pinned along an edge"),
        (Self::Triangle, "triangle", "Free triangle"),
        (Self::Strip(2), "strip-2", "Hanging strip of 2 links"),
        (Self::Strip(8), "strip-8", "Hanging strip of 8 links"),
        (Self::Strip(64), "strip-64", "Hanging strip of 64 links"),
        (Self::Sheet(0), "sheet-0", "Sheet M^0 held at a corner"),
        (Self::Sheet(1), "sheet-1", "Sheet M^1 held at a corner"),
        (Self::Sheet(2), "sheet-2", "Sheet M^2 held at a corner"),
        (Self::Sheet(3), "sheet-3", "Sheet M^3 held at a corner"),
        (Self::Cloth(2), "cloth-2", "Tablecloth M^2"),
    ];

    /// Whether the motion is so smooth that the orders of the methods show: sheets flutter on finer scales
    /// than their steps.
    pub(super) fn is_smooth(self) -> bool {
        matches!(self, Self::Pendulum | Self::Triangle)
    }

    /// All of them with their names.
    pub(crate) fn named() -> Vec<(&'static str, Self)> {
        let all = Self::ALL.into_iter();
        all.map(|(problem, name, _)| (name, problem)).collect()
    }

    fn words(self) -> [&'static str; 2] {
        let words = Self::ALL.iter().find(|(problem, ..)| *problem == self);
        words.map_or([""; 2], |(_, name, title)| [name, title])
    }

    /// Name on the command line and in tables.
    pub(crate) fn name(self) -> &'static str {
        self.words()[0]
    }

    /// Title for people, with the mark-up of drawings.
    pub(super) fn title(self) -> &'static str {
        self.words()[1]
    }

    /// Whether quick reports have no time for it.
    pub(crate) fn is_costly(self) -> bool {
        matches!(self, Self::Strip(64) | Self::Sheet(2 | 3))
    }

    /// The set-up in words.
    pub(super) fn about(self) -> &'static str {
        match self {
            Self::Pendulum => {
                "A pendulum of 0.7 m released at 2 rad, one period; exact by Jacobi functions."
            }
            Self::Triangle => {
                "A tumbling triangle without gravity, one period of its spin; the spin is exact by Jacobi functions, the attitude \
                 follows from it by quadrature to round-off."
            }
            Self::Strip(_) => {
                "A strip 1 m long and 0.3 m wide of rigid links (each cut by a diagonal, 0.1 kg in all, lumped), pinned along its \
                 top edge, straight, 0.5 rad from the vertical, released at rest."
            }
            Self::Sheet(_) => {
                "The union-jack square, 1 m, 0.1 kg, lumped, horizontal with z = 0.1 sin(πx) sin(πy) as the rest shape, held at \
                 the corner (0, 1), released at rest."
            }
            Self::Cloth(_) => {
                "The same bumped square, free, dropped onto a square table of side 0.52 m whose top is at z = 0.04 m, without \
                 friction. Implicit Euler and BDF2 take contact, and check every motion for collisions. All other methods know \
                 the barrier as a potential like any other: the same energy, but no check, so that they pass through the table \
                 where their steps are too long. Reference and second opinion are of that kind, and not of the methods whose \
                 contact is measured."
            }
        }
    }

    /// The time over which motions are compared at most, seconds.
    fn duration(self) -> f64 {
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

    /// The time between two checkpoints, seconds.
    pub(super) fn interval(self) -> f64 {
        self.duration() / CHECKPOINTS as f64
    }

    /// The problem at its start.
    pub(super) fn setup(self) -> Result<Setup> {
        let (sheet, pins) = match self {
            Self::Pendulum => {
                let pendulum = Pendulum::default();
                return Ok(free_of_contact(pendulum.model(), pendulum.start()));
            }
            Self::Triangle => {
                let triangle = FreeTriangle::default();
                return Ok(free_of_contact(triangle.model(), triangle.start()));
            }
            Self::Strip(links) => (strip(links)?, vec![VertexId(0), VertexId(1)]),
            Self::Sheet(level) => (bumped(level, BUMP), vec![corner(level)]),
            Self::Cloth(level) => (bumped(level, BUMP), Vec::new()),
        };
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?
            .with_gravity()
            .with_pins(&pins)?;
        let mut setup = free_of_contact(model, State::at_rest(sheet.positions().to_vec()));
        if let Self::Cloth(_) = self {
            let options = ContactOptions::for_sheet(&setup.model);
            let table = (TABLE, TABLE_TOP);
            setup.contacts = Some(on_table(&setup.model, options, table, Pairs::Table)?);
        }
        Ok(setup)
    }

    /// Exact positions at the given increasing times, where they are known.
    pub(super) fn exact(self, times: &[f64]) -> Option<Vec<Vec<f64>>> {
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

fn free_of_contact(model: SheetModel, state: State) -> Setup {
    let contacts = None;
    Setup {
        model,
        state,
        contacts,
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
    let row = |row: u32| {
        let r = f64::from(row) / f64::from(links);
        [0.0, r * s, -r * c, 0.3, r * s, -r * c]
    };
    let positions = (0..=links).flat_map(row).collect();
    Ok(Sheet::new(positions, &strip_faces(links))?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_dynamics::{Method, Simulation};
    use isosheet_tests::max_difference;

    /// The attitude against the chart-free motion, and the corners against the lengths.
    #[test]
    fn the_tumbling_triangle_is_exact() {
        let problem = Problem::Triangle;
        let end = 0.25 * problem.duration();
        let exact = problem.exact(&[0.5 * end, end]).unwrap();
        let (model, start) = problem.setup().unwrap().with_barrier().unwrap();
        let strain = model.rods().max_strain(&exact[1]);
        assert!(strain < 1e-12, "strain {strain:e}");
        let method = Method::RattleComposition(Default::default());
        let mut run = Simulation::new(model, start, method).unwrap();
        run.run(end, end / 400.0, &mut []).unwrap();
        let gap = max_difference(&run.state().x, &exact[1]);
        assert!(gap < 1e-10, "{gap:e} m");
    }
}
