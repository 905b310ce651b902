//! Sheets that are folded from exactly flat by driven angles at their creases, compared with the kinematics
//! of rigid origami.

use isosheet_dynamics::{
    CreaseSpring, CreaseSprings, Interpolation, Method, Profile, SheetModel, Simulation, State,
};
use isosheet_mesh::generate::{FoldAssignment, FoldPattern, degree_four, miura};
use isosheet_mesh::origami::{DegreeFour, FoldingMode, Miura};
use isosheet_mesh::{EdgeId, MassKind, VertexId, fold_angle};
use isosheet_tests::max_difference;

/// Folds by an angle in a second, at rest before and after.
fn folded_by(full: f64) -> Profile {
    Profile::Keyframes {
        interpolation: Interpolation::MonotoneCubic,
        keys: vec![[0.0, 0.0], [1.0, full]],
    }
}

fn spring(edge: EdgeId, stiffness: f64, full: f64) -> CreaseSpring {
    CreaseSpring {
        edge,
        stiffness,
        rest: folded_by(full).into(),
        yields: None,
        in_series: None,
    }
}

fn fold(pattern: &FoldPattern, springs: Vec<CreaseSpring>, damping: f64) -> Simulation {
    let sheet = &pattern.sheet;
    let springs = CreaseSprings::new(sheet.topology(), springs).expect("interior edges");
    let model = SheetModel::new(sheet, 0.08 * sheet.area(), MassKind::Lumped)
        .and_then(|m| m.with_potential(springs).with_damping(damping))
        .expect("valid");
    let start = State::at_rest(sheet.positions().to_vec());
    Simulation::new(model, start, Method::default()).expect("valid")
}

/// One vertex, two assignments, two branches of folding. The crease that folds most is driven. The springs
/// of the other creases are a hundred times as weak and have a rest angle that is wrong for all of them
/// except the crease opposite to the driven one: they only say to which side a crease folds.
#[test]
fn the_assignment_chooses_the_branch_of_a_vertex() {
    let exact = DegreeFour {
        sectors: [1.0, 1.5],
    };
    for mode in [FoldingMode::EvenAlike, FoldingMode::OddAlike] {
        let assignment = exact.assignment(mode);
        let pattern = degree_four(exact.sectors, 0.05, assignment).expect("valid");
        let crease = |k: usize| {
            let end = VertexId::from_index(k + 1);
            let edge = pattern.sheet.topology().find_edge(VertexId(0), end);
            edge.expect("a crease")
        };
        let lead = usize::from(mode == FoldingMode::EvenAlike);
        let springs = (0..4).map(|k| {
            let stiffness = if k == lead { 1e-3 } else { 1e-5 };
            spring(crease(k), stiffness, 2.0 * assignment[k].sign())
        });
        let mut run = fold(&pattern, springs.collect(), 5.0);
        for step in 1..=150 {
            let report = run.step(0.01).expect("accepted");
            assert!(report.strain < 1e-11, "strain {:e}", report.strain);
            let angle = |k: usize| {
                let t = pattern.sheet.topology();
                fold_angle(t, &run.state().x, crease(k)).expect("interior")
            };
            let expected = exact.angles(mode, angle(0));
            // The lengths fix the angles to their error over the fold angle.
            if step >= 10 {
                for (k, e) in expected.into_iter().enumerate() {
                    assert!(
                        (angle(k) - e).abs() < 1e-8,
                        "{mode:?}, step {step}, crease {}: {} instead of {e}",
                        k + 1,
                        angle(k)
                    );
                }
            }
            if step == 150 {
                let folded = assignment[lead].sign() * angle(lead);
                assert!(
                    (folded - 2.0).abs() < 0.1,
                    "{mode:?}: folded to {folded} rad"
                );
                assert!(
                    report.energy_drift.abs() < 0.05 * report.work,
                    "{:e} J of {:e} J",
                    report.energy_drift,
                    report.work
                );
            }
        }
    }
}

const MIURA: Miura = Miura {
    straight: 0.02,
    zigzag: 0.02,
    angle: 1.0,
};

fn is_zigzag(pattern: &FoldPattern, e: EdgeId) -> bool {
    let [a, b] = pattern.sheet.topology().edges()[e.index()];
    b.index() - a.index() == 1
}

/// Springs on zigzags, straight creases and diagonals of panels, newton metres per radian.
fn miura_springs(pattern: &FoldPattern, [zigzag, straight, panel]: [f64; 3]) -> Vec<CreaseSpring> {
    let edges = pattern.sheet.topology().edge_ids();
    edges
        .filter(|e| pattern.assignment(*e) != FoldAssignment::Boundary)
        .map(|e| {
            let assignment = pattern.assignment(e);
            let stiffness = match assignment {
                FoldAssignment::Flat => panel,
                _ if is_zigzag(pattern, e) => zigzag,
                _ => straight,
            };
            spring(e, stiffness, 2.0 * assignment.sign())
        })
        .collect()
}

/// Folds 4 x 4 panels. Returns the largest error of the straight creases against the mean angle of the
/// zigzags (radians), the largest error of all distances in the sheet against the exact ones (metres), and
/// the largest fold of a panel (radians).
fn miura_errors(stiffness: [f64; 3]) -> [f64; 3] {
    let (columns, rows) = (4, 4);
    let pattern = miura(columns, rows, MIURA.straight, MIURA.zigzag, MIURA.angle).expect("valid");
    let mut run = fold(&pattern, miura_springs(&pattern, stiffness), 5.0);
    for _ in 0..75 {
        let report = run.step(0.02).expect("accepted");
        assert!(report.strain < 1e-11, "strain {:e}", report.strain);
    }
    let t = pattern.sheet.topology();
    let x = &run.state().x;
    let folds = |kind: fn(&FoldPattern, EdgeId) -> bool| -> Vec<f64> {
        t.edge_ids()
            .filter(|e| kind(&pattern, *e))
            .map(|e| {
                let sign = pattern.assignment(e).sign();
                let fold = fold_angle(t, x, e).expect("interior");
                if sign == 0.0 { fold } else { sign * fold }
            })
            .collect()
    };
    let zigzags = folds(|p, e| p.assignment(e).sign() != 0.0 && is_zigzag(p, e));
    let straights = folds(|p, e| p.assignment(e).sign() != 0.0 && !is_zigzag(p, e));
    let panels = folds(|p, e| p.assignment(e) == FoldAssignment::Flat);
    let mean = zigzags.iter().sum::<f64>() / zigzags.len() as f64;
    let expected = MIURA.straight_fold(0.5 * mean);
    let largest =
        |values: &[f64], about: f64| values.iter().fold(0.0f64, |m, v| m.max((v - about).abs()));
    let distances = |x: &[f64]| -> Vec<f64> {
        let at = |v: usize| nalgebra::Vector3::from_column_slice(&x[3 * v..3 * v + 3]);
        let n = x.len() / 3;
        (0..n)
            .flat_map(|a| (0..a).map(move |b| (at(a) - at(b)).norm()))
            .collect()
    };
    let rigid = MIURA.positions(columns, rows, 0.5 * mean);
    [
        largest(&straights, expected),
        max_difference(&distances(x), &distances(&rigid)),
        largest(&panels, 0.0),
    ]
}

#[test]
fn driven_zigzags_fold_a_miura_pattern_and_the_straight_creases_follow() {
    // Nothing acts on the straight creases: geometry alone folds them.
    let [angle, distance, panel] = miura_errors([1e-4, 0.0, 1e-3]);
    assert!(angle < 1e-9, "straight creases {angle:e} rad off");
    assert!(distance < 1e-11, "distances {distance:e} m off");
    assert!(panel < 1e-9, "panels folded by {panel:e} rad");
}

#[test]
fn panels_bend_in_proportion_to_their_compliance_where_the_drive_is_wrong() {
    // All creases are driven to the same angle, which no rigid pattern has.
    let bent = [1e-3, 1e-2, 1e-1].map(|panel| miura_errors([1e-4, 1e-4, panel])[2]);
    for pair in bent.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((6.0..14.0).contains(&ratio), "{bent:?}");
    }
}
