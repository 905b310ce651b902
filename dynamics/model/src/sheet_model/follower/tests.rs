use super::*;
use crate::term::Formula;
use crate::{SheetModel, State, TurningLoad};
use isosheet_materials::hessian::HessianProduct;
use isosheet_materials::potential::Memories;
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use isosheet_motion::Profile;

/// The derivatives of the loads at positions agree with differences of the forces, and loads are forces
/// alone: they do not turn the whole by themselves.
pub(in crate::sheet_model) fn check_derivatives(load: &impl FaceLoad, x: &[f64]) {
    for (number, face) in load.faces().iter().enumerate() {
        let corners = places(face, x);
        let derivatives = load.derivatives(number, 0.3, &corners);
        let largest = derivatives.iter().flatten().map(Matrix3::norm);
        let largest = largest.fold(0.0, f64::max);
        assert!(largest > 0.0, "face {number}");
        for (j, k) in (0..3).flat_map(|j| (0..3).map(move |k| (j, k))) {
            let moved = |d: f64| {
                let mut corners = corners;
                corners[j][k] += d;
                load.forces(number, 0.3, &corners)
            };
            let (up, down) = (moved(1e-6), moved(-1e-6));
            for i in 0..3 {
                let slope = (up[i] - down[i]) / 2e-6;
                let error = (slope - derivatives[i][j].column(k)).norm();
                assert!(error < 1e-7 * largest, "face {number}, {i} by {j}: {error}");
            }
        }
    }
}

pub(in crate::sheet_model) fn wave(size: f64, i: usize) -> f64 {
    size * (1.7 * i as f64).sin()
}

/// A crumpled square.
pub(in crate::sheet_model) fn crumpled() -> Sheet {
    let flat = generate::isotropic_square(0, 0.4).expect("a square");
    let x = flat.positions().iter().enumerate();
    let x: Vec<f64> = x.map(|(i, x)| x + wave(0.03, i)).collect();
    Sheet::new(x, &flat.face_indices()).expect("a sheet")
}

/// The term has the derivatives that it says, vanishes at the start of the step, and once renewed has the
/// forces of the iterate, which it does not renew again.
#[test]
fn the_term_follows_the_load() {
    let sheet = crumpled();
    let x = sheet.positions();
    let size = Profile::Ramp {
        from: 1.0,
        to: 2.0,
        begin: 0.0,
        end: 1.0,
    };
    let vertices = [VertexId(0), VertexId(4), VertexId(7)];
    let load = TurningLoad::new(sheet.topology(), &vertices, [1.0, 0.5, 2.0], size, x).unwrap();
    let model = SheetModel::new(&sheet, 0.02, MassKind::Lumped).unwrap();
    let model = model.with_turning_load(load);
    let force = model.implicit_forces().next().expect("the load");
    let mut term = force.term(vec![true; x.len() / 3].into());
    let start = State::at_rest(x.to_vec());
    let moved = |size: f64, first: usize| {
        let moved = x.iter().enumerate();
        moved
            .map(|(i, x)| x + wave(size, i + first))
            .collect::<Vec<f64>>()
    };
    let (ahead, end) = (moved(0.01, 3), moved(0.02, 5));
    let memories = model.memories();
    let step = StepStart {
        state: &start,
        memories: &memories,
        span: 0.02,
        sliding_time: 0.02,
        h: 0.02,
        formula: Formula::OneStep,
        back: 0.0,
        before: None,
        rest: x,
        prediction: &ahead,
        ahead: &ahead,
    };
    term.begin(&step).expect("finite loads");
    let memories: Memories = model.memories();
    fn iterate<'a>(x: &'a [f64], memories: &'a Memories) -> Iterate<'a> {
        let t = 0.02;
        Iterate { t, x, memories }
    }
    assert_eq!(term.value(iterate(x, &memories)).energy, 0.0);
    let gradient = |term: &mut dyn Term, x: &[f64]| {
        let mut gradient = vec![0.0; x.len()];
        term.add_gradient(iterate(x, &memories), 1.0, &mut gradient);
        gradient
    };
    let slopes = gradient(&mut *term, &end);
    let direction = moved(1.0, 11);
    let along = |d: f64| {
        let mut there = end.clone();
        there
            .iter_mut()
            .zip(&direction)
            .for_each(|(x, v)| *x += d * v);
        there
    };
    let [up, down] = [1e-5, -1e-5].map(along);
    let change =
        term.value(iterate(&up, &memories)).energy - term.value(iterate(&down, &memories)).energy;
    let slope: f64 = slopes.iter().zip(&direction).map(|(g, v)| g * v).sum();
    assert!(
        (change / 2e-5 - slope).abs() < 1e-9 * slope.abs(),
        "{slope}"
    );
    let mut product = vec![0.0; x.len()];
    term.add_hessian(
        iterate(&end, &memories),
        HessianPart::Full,
        &mut HessianProduct {
            edges: model.edges().edges(),
            scale: 1.0,
            vector: &direction,
            product: &mut product,
        },
    );
    let [up, down] = [up, down].map(|x| gradient(&mut *term, &x));
    for (i, p) in product.iter().enumerate() {
        let slope = (up[i] - down[i]) / 2e-5;
        assert!((slope - p).abs() < 1e-6, "{i}: {slope} {p}");
    }
    assert!(term.renew(
        iterate(&end, &memories),
        Lagging {
            friction: 0.05,
            loads: 0.05
        }
    ));
    let mut exact = vec![0.0; x.len()];
    model.add_applied_force(0.02, &end, &[], &mut exact);
    let found = gradient(&mut *term, &end);
    let error = found.iter().zip(&exact).map(|(g, f)| (g + f).abs());
    assert!(error.fold(0.0, f64::max) < 1e-12);
    assert!(!term.renew(
        iterate(&end, &memories),
        Lagging {
            friction: 0.05,
            loads: 0.05
        }
    ));
}
