//! Making and checking states to start from.

use crate::damped::restoration::{FirstMatrix, Restoration, RestorationGoal};
use crate::diagnosis::potentials::{Differences, find_fault};
use crate::linear::primal::PrimalMatrix;
use crate::report::effort::SolverEffort;
use crate::step::tuning::Tuning;
use crate::{SheetModel, SimulationError, State};
use isosheet_materials::potential::{At, Memories};
use isosheet_materials::vectors::point;
use isosheet_materials::{LimitError, OptionsError};
use isosheet_mesh::VertexId;
use isosheet_model::StepError;
use isosheet_model::Support;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// Largest relative length error of a start state. Files keep six to eight digits and are
/// projected first; anything within this bound is closed by the first step unnoticed.
const START_STRAIN: f64 = 1e-8;

/// Most iterations of [`project_positions`]; a thousand is ten times what crumpled states need.
const MAX_ITERATIONS: usize = 1000;

/// Moves positions (`3V`, in place) to nearby ones with the rest lengths, pinned vertices kept. Returns the
/// largest relative length error left.
///
/// # Errors
/// [`SimulationError`] if `x` has the wrong length, `tolerance` is not between 1e-15 and 1, or no
/// positions with a relative length error below it were found; `x` is then unchanged.
pub fn project_positions(
    model: &SheetModel,
    x: &mut [f64],
    tolerance: f64,
) -> Result<f64, SimulationError> {
    OptionsError::check_range("tolerance", tolerance, 1e-15, 1.0)?;
    check_count(model, x)?;
    let mut matrix = PrimalMatrix::of_rods(model)?;
    let mut effort = SolverEffort::default();
    let mut moved = x.to_vec();
    let strain = Restoration::new(model, Tuning::default()).positions(
        model,
        &mut matrix,
        None,
        &mut moved,
        RestorationGoal {
            tolerance,
            max_iterations: MAX_ITERATIONS,
            may_be_far: false,
            t: 0.0,
            loads: &[],
            matrix: FirstMatrix::Assembled,
        },
        &mut effort,
    );
    if strain <= tolerance {
        x.copy_from_slice(&moved);
        Ok(strain)
    } else {
        Err(SimulationError::Start(StepError::Projection {
            strain,
            tolerance,
            iterations: effort.iterations,
        }))
    }
}

fn check_count(model: &SheetModel, x: &[f64]) -> Result<(), SimulationError> {
    let expected = model.coordinate_count();
    if x.len() == expected {
        Ok(())
    } else {
        Err(SimulationError::StateLength {
            positions: x.len(),
            velocities: x.len(),
            expected,
        })
    }
}

/// Displaces positions (`3V`, in place) off a flat or otherwise singular state: every free vertex
/// by at most `amplitude` mean edge lengths in a random direction, then back onto the rest
/// lengths. Returns the largest relative length error left.
///
/// Which way the sheet will fold is decided by `seed`, so runs can be repeated.
///
/// # Errors
/// [`SimulationError`] if the amplitude is not between 0 and 1 or no positions with the rest
/// lengths were found; `x` is then unchanged.
pub fn leave_flat(
    model: &SheetModel,
    x: &mut [f64],
    amplitude: f64,
    seed: u64,
) -> Result<f64, SimulationError> {
    let all = 0..model.topology().vertex_count();
    leave_flat_in(model, all, x, amplitude, seed)
}

/// [`leave_flat`] for the vertices of a range alone, of one of several sheets
/// ([`Part::vertices`](isosheet_mesh::Part::vertices)).
///
/// # Errors
/// As [`leave_flat`].
pub fn leave_flat_in(
    model: &SheetModel,
    vertices: Range<usize>,
    x: &mut [f64],
    amplitude: f64,
    seed: u64,
) -> Result<f64, SimulationError> {
    OptionsError::check_range("amplitude", amplitude, 0.0, 1.0)?;
    check_count(model, x)?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let size = amplitude * model.mean_length();
    let mut displacement = vec![0.0; x.len()];
    for v in vertices {
        for c in displacement.iter_mut().skip(3 * v).take(3) {
            *c = rng.random_range(-size..=size);
        }
    }
    model.clear_pinned(&mut displacement);
    let mut moved: Vec<f64> = x.iter().zip(&displacement).map(|(x, d)| x + d).collect();
    let strain = project_positions(model, &mut moved, 1e-12)?;
    x.copy_from_slice(&moved);
    Ok(strain)
}

/// Refuses positions and velocities that are not finite.
pub(crate) fn check_finite(state: &State) -> Result<(), StepError> {
    if !state.t.is_finite() {
        return Err(StepError::Time { t: state.t });
    }
    for values in [&state.x, &state.v] {
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            return Err(StepError::NonFiniteState {
                vertex: VertexId((i / 3) as u32),
                value: values[i],
                t: state.t,
            });
        }
    }
    Ok(())
}

/// Refuses prescribed motions that are not finite or do not start where the state is.
pub(crate) fn check_motions(model: &SheetModel, state: &State) -> Result<(), StepError> {
    let t = state.t;
    if let Some((support, value)) = model.find_bad_motion(t) {
        return Err(StepError::NonFiniteMotion { support, value, t });
    }
    let mut placed = state.x.clone();
    model.place_pins(t, &mut placed);
    let pins = model.moving_pins().map(|v| {
        let v = VertexId(v as u32);
        let distance = (point(&placed, v) - point(&state.x, v)).norm();
        (Support::Pin(v), distance, v)
    });
    let constraints = model.constraints().iter().enumerate().map(|(index, c)| {
        let vertex = c.vertex();
        let distance = c.violation(t, &point(&state.x, vertex));
        (Support::Constraint { index, vertex }, distance, vertex)
    });
    for (support, distance, v) in pins.chain(constraints) {
        let allowed = START_STRAIN * model.shortest_edge(v.index());
        if distance.is_nan() || distance > allowed {
            return Err(StepError::OffSupport {
                support,
                distance,
                t,
            });
        }
    }
    Ok(())
}

/// Refuses times at which a sheet would swell or shrink by too much.
fn check_swelling(model: &SheetModel, t: f64) -> Result<(), StepError> {
    let elastic = model.elastic_sheet();
    match elastic.and_then(|elastic| elastic.swollen_too_much(t)) {
        Some(part) => Err(LimitError::Swelling { part, t }.into()),
        None => Ok(()),
    }
}

/// Refuses potentials that cannot be used at a state.
pub(crate) fn check_potentials(
    model: &SheetModel,
    memories: &Memories,
    State { t, x, .. }: &State,
) -> Result<(), StepError> {
    match find_fault(model, memories, (*t, x), Differences::Skip) {
        None => Ok(()),
        Some(bad) => Err(StepError::Potential {
            t: *t,
            bad: Box::new(bad),
        }),
    }
}

/// Refuses states that are not finite or not on the rest lengths.
pub(crate) fn check_state(model: &SheetModel, state: &State) -> Result<(), StepError> {
    check_finite(state)?;
    check_swelling(model, state.t)?;
    if let Some(elastic) = model.elastic_sheet()
        && let Some(worst) = elastic.beyond_limit(At::new(state.t, &state.x))
    {
        return Err(StepError::BeyondStrainLimit {
            face: worst.face,
            strain: worst.strain,
            limit: worst.limit,
            t: state.t,
        });
    }
    let rods = model.rods();
    if model.constrained_strain(&state.x) <= START_STRAIN {
        return Ok(());
    }
    let length = |e: usize| {
        let [a, b] = rods.edges()[e];
        (0..3)
            .map(|k| (state.x[3 * a + k] - state.x[3 * b + k]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let strain = |e: usize| (length(e) / rods.lengths()[e] - 1.0).abs();
    let worst = (0..rods.len())
        .max_by(|&a, &b| strain(a).total_cmp(&strain(b)))
        .unwrap_or(0);
    Err(StepError::OffConstraints {
        edge: model.rod_edges()[worst],
        length: length(worst),
        rest: rods.lengths()[worst],
        t: state.t,
    })
}
