//! Refused sub-steps change nothing. This is tested for the step control, with an integrator that follows a
//! script of refusals, and for every integrator, with proposals that are not committed.

use super::*;
use crate::contact::contact_tests::{Floor, model, sheet};
use crate::report::effort::SolverEffort;
use crate::report::totals::not_converged;
use crate::step::integrator::{MethodTraits, StepAccount};
use isosheet_mesh::{MassKind, Sheet, generate};
use isosheet_model::Reason;
use serde::Serialize;
use std::sync::{Arc, Mutex};

/// What a scripted integrator does with an attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    /// Flies on.
    Accept,
    /// Flies on twice as fast, which the energy account refuses.
    Gain,
    /// Does not converge.
    Diverge,
}

/// An attempt as the integrator saw it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Seen {
    t: f64,
    h: f64,
    memory: Memory,
}

/// An integrator that answers as a script says, and accepts when the script has ended.
struct Scripted {
    script: Vec<Answer>,
    seen: Arc<Mutex<Vec<Seen>>>,
}

impl Integrator for Scripted {
    fn propose(
        &mut self,
        _scene: Scene<'_>,
        attempt: Attempt<'_>,
        proposal: &mut Proposal,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError> {
        let mut seen = self.seen.lock().unwrap();
        let answer = self.script.get(seen.len()).copied();
        let (start, h) = (attempt.state, attempt.h);
        if !effort.count_factorisation() {
            return Err(not_converged(
                start.t,
                h,
                effort,
                Reason::Iterations,
                1.0,
                1.0,
            ));
        }
        seen.push(Seen {
            t: start.t,
            h,
            memory: match (attempt.previous(), attempt.multipliers().rods.len()) {
                (None, 0) => Memory::Restart,
                (Some(_), 0) => Memory::State,
                (Some(_), _) => Memory::All,
                (None, _) => panic!("multipliers without a state before"),
            },
        });
        effort.iterations += 1;
        let motion = &mut proposal.motion;
        // A refusal leaves its marks on the whole proposal.
        motion.state.x.fill(f64::NAN);
        motion.history.multipliers.rods.clear();
        motion.balance.pins.fill(f64::NAN);
        let factor = match answer.unwrap_or(Answer::Accept) {
            Answer::Diverge => {
                return Err(not_converged(
                    start.t,
                    h,
                    effort,
                    Reason::Iterations,
                    1.0,
                    1.0,
                ));
            }
            Answer::Gain => 2.0,
            Answer::Accept => 1.0,
        };
        let State { t, x, v } = &mut motion.state;
        *t = start.t + h;
        for i in 0..x.len() {
            v[i] = factor * start.v[i];
            x[i] = start.x[i] + h * v[i];
        }
        motion.history.set_previous(Some(start));
        let multipliers = &mut motion.history.multipliers;
        (multipliers.step, multipliers.rods) = (h, vec![h]);
        motion.balance.pins.fill(h);
        proposal.account = StepAccount::of_forces(h, 0.0, StepOutcome::Newton);
        Ok(())
    }

    fn traits(&self) -> MethodTraits {
        MethodTraits {
            demand: RodDemand::Nothing,
            contact: ContactSupport::None,
        }
    }
}

/// A sheet in free flight, moved by a scripted integrator that stores one step of history, and a list of
/// what the integrator was given in each call.
fn scripted(script: &[Answer], control: StepControl) -> (Engine, Arc<Mutex<Vec<Seen>>>) {
    scripted_on(&[], script, control)
}

/// A sheet that has pins, in free flight, moved by a scripted integrator that stores one step of history, and
/// a list of what the integrator was given in each call. (The integrator takes no notice of the pins.)
fn scripted_on(
    pins: &[VertexId],
    script: &[Answer],
    control: StepControl,
) -> (Engine, Arc<Mutex<Vec<Seen>>>) {
    // A folded sheet, whose rods are independent.
    let flat = generate::isotropic_square(1, 1.0).unwrap();
    let fold = |p: &[f64; 3]| [p[0], p[1], 0.2 * (3.0 * p[0]).sin() * (1.0 + p[1])];
    let x: Vec<f64> = flat
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(fold)
        .collect();
    let sheet = Sheet::new(x.clone(), &flat.face_indices()).unwrap();
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
    let model = model.with_pins(pins).unwrap();
    let v = [0.3, -0.2, 0.5].repeat(x.len() / 3);
    let method = Method::ImplicitEuler(Default::default());
    let mut engine = Engine::new(model, method, State::moving(x, v)).unwrap();
    engine.set_control(control).unwrap();
    let seen = Arc::new(Mutex::new(Vec::new()));
    engine.integrator = Box::new(Scripted {
        script: Vec::new(),
        seen: seen.clone(),
    });
    engine.advance(0.125, &mut StepTotals::default()).unwrap();
    seen.lock().unwrap().clear();
    engine.integrator = Box::new(Scripted {
        script: script.to_vec(),
        seen: seen.clone(),
    });
    (engine, seen)
}

/// The step of the tests, seconds: a power of two, so that sub-steps have no round-off.
const H: f64 = 0.5;

fn attempts(script: &[Answer]) -> (Vec<Seen>, StepTotals<'static>) {
    let (mut engine, seen) = scripted(script, StepControl::default());
    let mut totals = StepTotals::default();
    engine.advance(H, &mut totals).unwrap();
    assert_eq!(engine.state().t, 0.125 + H);
    let seen = seen.lock().unwrap().clone();
    (seen, totals)
}

/// Every bit that a checkpoint keeps.
fn bits(value: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(value).unwrap()
}

#[test]
fn an_energy_gain_is_answered_by_one_restart_and_then_by_halving() {
    use Answer::Gain;
    let (seen, totals) = attempts(&[Gain; 4]);
    let first: Vec<(f64, Memory)> = seen[..5].iter().map(|s| (s.h, s.memory)).collect();
    let expected = [
        (H, Memory::All),
        (H, Memory::Restart),
        (H / 2.0, Memory::Restart),
        (H / 4.0, Memory::Restart),
        (H / 8.0, Memory::Restart),
    ];
    assert_eq!(first, expected);
    // What was committed is remembered again.
    assert!(seen[5..].iter().all(|s| s.memory == Memory::All));
    assert_eq!((totals.rejected, totals.substeps), (4, seen.len() - 4));
}

#[test]
fn other_refusals_halve_at_once_and_drop_the_multipliers() {
    use Answer::{Diverge, Gain};
    let (seen, _) = attempts(&[Diverge, Diverge, Gain, Diverge]);
    let first: Vec<(f64, Memory)> = seen[..5].iter().map(|s| (s.h, s.memory)).collect();
    let expected = [
        (H, Memory::All),
        (H / 2.0, Memory::State),
        (H / 4.0, Memory::State),
        // The first gain of energy, with a history.
        (H / 4.0, Memory::Restart),
        (H / 8.0, Memory::Restart),
    ];
    assert_eq!(first, expected);
}

/// Runs all scripts of six answers. No attempt repeats an earlier one, and what follows a refusal is what
/// the table of the step control says.
#[test]
fn no_problem_is_proposed_twice() {
    let answers = [Answer::Accept, Answer::Gain, Answer::Diverge];
    let mut restarts = 0;
    for number in 0..3_usize.pow(6) {
        let script: Vec<Answer> = (0..6)
            .map(|k| answers[number / 3_usize.pow(k) % 3])
            .collect();
        let (seen, totals) = attempts(&script);
        let refused = script.iter().filter(|a| **a != Answer::Accept).count();
        // A script that outlasts the step cannot have been used up.
        assert!(totals.rejected <= refused && totals.rejected + totals.substeps == seen.len());
        for (k, s) in seen.iter().enumerate() {
            assert!(!seen[..k].contains(s), "{script:?}: {s:?} again");
        }
        for (pair, answer) in seen.windows(2).zip(&script) {
            let [before, after] = [pair[0], pair[1]];
            let restart = *answer == Answer::Gain && before.memory > Memory::Restart;
            restarts += usize::from(restart);
            let expected = match answer {
                Answer::Accept => (before.t + before.h, after.h, Memory::All),
                Answer::Gain if restart => (before.t, before.h, Memory::Restart),
                _ => (before.t, 0.5 * before.h, before.memory.min(Memory::State)),
            };
            assert_eq!((after.t, after.h, after.memory), expected, "{script:?}");
        }
    }
    assert!(restarts > 500, "only {restarts} restarts were checked");
}

#[test]
fn a_step_that_fails_altogether_changes_nothing() {
    for answer in [Answer::Gain, Answer::Diverge] {
        let control = StepControl {
            min_fraction: 1.0 / 16.0,
            ..StepControl::default()
        };
        let (mut engine, seen) = scripted(&[answer; 20], control);
        let before = bits(&engine.motion.compact());
        let mut totals = StepTotals::default();
        let error = engine.advance(H, &mut totals).unwrap_err();
        let StepError::StepTooSmall {
            t, min_step, cause, ..
        } = error
        else {
            panic!("{error}");
        };
        assert_eq!((t, min_step), (0.125, H / 16.0));
        let gains = matches!(*cause, StepError::EnergyGain { .. });
        assert_eq!(gains, answer == Answer::Gain, "{cause}");
        // Five lengths, and one restart after a gain.
        let count = seen.lock().unwrap().len();
        assert_eq!(count, if gains { 6 } else { 5 });
        assert_eq!((totals.rejected, totals.substeps), (count, 0));
        assert_eq!(totals.effort.iterations, count);
        assert_eq!(
            (totals.work, totals.dissipated, totals.friction),
            (0.0, 0.0, 0.0)
        );
        assert!(
            bits(&engine.motion.compact()) == before,
            "{answer:?} left a trace"
        );
    }
}

#[test]
fn a_step_that_fails_half_way_keeps_what_was_committed() {
    use Answer::{Accept, Diverge};
    let control = StepControl {
        min_fraction: 0.25,
        ..StepControl::default()
    };
    // A half is committed; of the other half nothing.
    let mut script = vec![Diverge, Accept];
    script.extend([Diverge; 5]);
    let (mut engine, _) = scripted(&script, control.clone());
    assert!(engine.advance(H, &mut StepTotals::default()).is_err());
    let (mut half, _) = scripted(&[], control);
    half.motion.history.multipliers.clear();
    half.advance(0.5 * H, &mut StepTotals::default()).unwrap();
    assert!(bits(&engine.motion.compact()) == bits(&half.motion.compact()));
}

/// The fallback is used after the smallest sub-step was refused. It takes the longest sub-step that fits
/// and is given no history.
#[test]
fn the_fallback_starts_without_a_history() {
    for refusals in [[Answer::Gain; 6], [Answer::Diverge; 6]] {
        let control = StepControl {
            min_fraction: 0.25,
            fallback: Fallback::ImplicitEuler(Default::default()),
            ..StepControl::default()
        };
        let (mut engine, seen) = scripted(&refusals, control);
        // Tumbling, so that multipliers matter; with multipliers that are wrong.
        let State { x, v, .. } = &mut engine.motion.state;
        for (p, v) in x.chunks(3).zip(v.chunks_mut(3)) {
            v.copy_from_slice(&[-2.0 * p[1], 2.0 * p[0], 0.3]);
        }
        let rods = engine.model.rods().len();
        engine.motion.history.multipliers.rods = vec![1.0; rods];
        let expected = |engine: &mut Engine, memory| {
            let traits = engine.integrator.traits();
            let mut proposal = Proposal::new(&engine.model, traits);
            let mut method = Implicit::new(
                Formula::OneStep,
                &engine.model,
                Default::default(),
                &engine.tuning,
            )
            .unwrap();
            let scene = Scene {
                model: &engine.model,
                objective: &mut engine.objective,
            };
            let attempt = Attempt::new(&engine.motion, H, memory);
            method
                .propose(scene, attempt, &mut proposal, &mut SolverEffort::default())
                .unwrap();
            bits(&(&proposal.motion.state.x, &proposal.motion.state.v))
        };
        let without = expected(&mut engine, Memory::Restart);
        let with = expected(&mut engine, Memory::All);
        assert!(with != without, "the multipliers make no difference");
        let mut totals = StepTotals::default();
        engine.advance(H, &mut totals).unwrap();
        assert_eq!(
            (totals.outcome, totals.substeps),
            (StepOutcome::Fallback, 1)
        );
        let smallest = seen.lock().unwrap().last().map(|s| s.h);
        assert_eq!(smallest, Some(0.25 * H));
        let State { x, v, .. } = engine.state();
        assert!(bits(&(x, v)) == without);
        let history = &engine.motion.history;
        assert!(history.previous.is_none() && history.multipliers.rods.is_empty());
    }
}

/// The fallback is held to the energy balance like every other damped step.
#[test]
fn a_fallback_that_gains_energy_is_refused() {
    let control = StepControl {
        min_fraction: 1.0,
        fallback: Fallback::ImplicitEuler(Default::default()),
        ..StepControl::default()
    };
    let (mut engine, _) = scripted(&[Answer::Diverge], control);
    engine.fallback = Some(Box::new(Scripted {
        script: vec![Answer::Gain],
        seen: Arc::default(),
    }));
    let before = engine.state().clone();
    let error = engine.advance(H, &mut StepTotals::default()).unwrap_err();
    let StepError::StepTooSmall { cause, .. } = &error else {
        panic!("{error}");
    };
    assert!(matches!(**cause, StepError::EnergyGain { .. }), "{error}");
    assert_eq!(engine.state(), &before);
}

/// An attempt that the limit of the effort ends is made again without a limit, and what is accepted is the
/// same.
#[test]
fn the_limit_of_the_effort_changes_nothing_that_is_accepted() {
    use Answer::Diverge;
    let corners = [0, 24].map(VertexId);
    let run = |max_factorisations| {
        let control = StepControl {
            max_factorisations,
            ..StepControl::default()
        };
        let (mut engine, seen) = scripted_on(&corners, &[Diverge; 4], control);
        let mut totals = StepTotals::default();
        engine.advance(H, &mut totals).unwrap();
        let lengths: Vec<f64> = seen.lock().unwrap().iter().map(|s| s.h / H).collect();
        (bits(engine.state()), totals.substeps, lengths)
    };
    // (Each attempt takes one factorisation, and five are made before the first is accepted.)
    let free = run(1_000_000);
    assert_eq!(free.2[..5], [1.0, 0.5, 0.25, 0.125, 0.0625]);
    for limit in [1, 2, 3] {
        assert_eq!(run(limit), free, "{limit}");
    }
}

/// Only sheets of rods with supports at two vertices lock, and only methods that take dependent rods tell.
#[test]
fn sheets_that_may_lock_have_a_limit() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    for (k, method) in methods().into_iter().enumerate() {
        for pins in [&[][..], &[VertexId(0)], &[VertexId(0), VertexId(24)]] {
            let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
            let model = model.with_pins(pins).unwrap();
            let state = State::at_rest(sheet.positions().to_vec());
            let mut engine = Engine::new(model, method.clone(), state).unwrap();
            let may_lock = k < 2 && pins.len() > 1;
            assert_eq!(
                engine.work_limit(H).is_some(),
                may_lock,
                "{pins:?}, {method:?}"
            );
        }
    }
}

/// The chart-free methods.
fn methods() -> [Method; 5] {
    [
        Method::Bdf2(Default::default()),
        Method::ImplicitEuler(Default::default()),
        Method::EnergyMomentum(Default::default()),
        Method::Rattle(Default::default()),
        Method::RattleComposition(Default::default()),
    ]
}

/// A proposal from a motion: its bits, or the error.
fn propose(engine: &mut Engine, start: &Motion, h: f64) -> Result<Vec<u8>, StepError> {
    let Engine {
        model,
        objective,
        integrator,
        proposal,
        ..
    } = engine;
    let scene = Scene { model, objective };
    let attempt = Attempt::new(start, h, Memory::All);
    let effort = &mut SolverEffort::default();
    integrator.propose(scene, attempt, proposal, effort)?;
    let StepAccount {
        residual,
        outcome,
        exchange,
        damped,
        error,
        lowest_frequency,
    } = proposal.account;
    let exchange = [
        exchange.work,
        exchange.driven,
        exchange.stored,
        exchange.friction,
        exchange.length_slack,
        damped,
    ];
    let error = error.map(|error| error.size);
    let account = (residual, outcome, exchange, error, lowest_frequency);
    Ok(bits(&(&proposal.motion.compact(), account)))
}

/// Proposals of an integrator do not depend on what it proposed before.
///
/// Returns the motion from which the proposals start.
fn check_purity(mut engine: Engine, what: &str) -> Motion {
    let h = 1.0 / 240.0;
    let mut moments = vec![engine.motion.clone()];
    for _ in 0..12 {
        engine.advance(h, &mut StepTotals::default()).unwrap();
        moments.push(engine.motion.clone());
    }
    let start = moments.last().unwrap();
    let first = propose(&mut engine, start, h).unwrap_or_else(|e| panic!("{what}: {e}"));
    let others = [
        (start, 10.0 * h),
        (start, h / 3.0),
        (&moments[0], h),
        (&moments[5], 2.0 * h),
        // A refusal, if anything is one.
        (start, 1e6 * h),
    ];
    for (motion, length) in others {
        let other = propose(&mut engine, motion, length);
        assert!(other.as_ref() != Ok(&first), "{what}: not another proposal");
        let again = propose(&mut engine, start, h);
        assert!(again.as_ref() == Ok(&first), "{what}: after {length} s");
    }
    // Nor on what its maker did before: an integrator that has proposed nothing says the same.
    engine.integrator = engine.method.build(&engine.model, &engine.tuning).unwrap();
    let fresh = propose(&mut engine, start, h);
    assert!(fresh.as_ref() == Ok(&first), "{what}: anew");
    start.clone()
}

#[test]
fn proposals_of_every_method_depend_on_nothing_before() {
    let flat = generate::isotropic_square(1, 1.0).unwrap();
    let mut x = flat.positions().to_vec();
    for p in x.chunks_mut(3) {
        p[2] = 0.2 * (3.0 * p[0]).sin() * (1.0 + p[1]);
    }
    let folded = Sheet::new(x.clone(), &flat.face_indices()).unwrap();
    for method in methods() {
        let model = model(&folded).with_pins(&[VertexId(20)]).unwrap();
        let what = format!("{method:?}");
        let engine = Engine::new(model, method, State::at_rest(x.clone())).unwrap();
        check_purity(engine, &what);
    }
}

#[test]
fn proposals_in_contact_depend_on_nothing_before() {
    for method in methods().into_iter().take(2) {
        // Falls 2 mm to the floor and rests on it: in contact at the sixth step.
        let (sheet, start) = sheet(1, 1.5e-3);
        let what = format!("{method:?} in contact");
        let mut engine = Engine::new(model(&sheet), method, start).unwrap();
        engine.set_contact(Box::new(Floor::new(|_| 0.0))).unwrap();
        let touching = check_purity(engine, &what).contacts;
        let touching = touching.map_or(0, |c| c.active.list().len());
        assert!(touching > 0, "{what}: nothing touches");
    }
}
