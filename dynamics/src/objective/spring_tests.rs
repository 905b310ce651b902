//! A new term of the objective is one type: a spring between two vertices as a term, against the same spring
//! as a potential.

use crate::{ImplicitOptions, Method, SheetModel, Simulation, State, StepError, leave_flat};
use isosheet_materials::hessian::{BlockSink, HessianPart, HessianSink};
use isosheet_materials::potential::{At, CouplingKind, Force, Potential};
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::{MassKind, VertexId, generate};
use isosheet_model::term::{Exchange, ImplicitForce, Iterate, StepStart, Term, Value};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// `V = k |x_a - x_b|^2 / 2`.
#[derive(Debug, Clone, Copy)]
struct Spring {
    /// The lower number first.
    ends: [VertexId; 2],
    stiffness: f64,
}

impl Spring {
    /// The force on the first end, newtons.
    fn pull(&self, x: &[f64]) -> Vector3<f64> {
        let [a, b] = self.ends.map(|v| point(x, v));
        self.stiffness * (b - a)
    }

    fn stored(&self, x: &[f64]) -> f64 {
        0.5 * self.pull(x).norm_squared() / self.stiffness
    }

    fn add_forces(&self, x: &[f64], scale: f64, out: &mut [f64]) {
        let pull = scale * self.pull(x);
        let [a, b] = self.ends;
        add(out, a, &pull);
        add(out, b, &-pull);
    }

    fn block(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal_element(self.stiffness)
    }
}

impl Potential for Spring {
    fn energy(&self, at: At<'_>) -> f64 {
        self.stored(at.x)
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        self.add_forces(at.x, -1.0, gradient);
    }

    fn add_hessian(&self, _at: At<'_>, hessian: &mut dyn HessianSink) {
        let [a, b] = self.ends;
        hessian.add_vertex(a, &self.block());
        hessian.add_vertex(b, &self.block());
        hessian.add_pair(a, b, &-self.block());
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        vec![self.ends]
    }

    fn coupling_kind(&self) -> CouplingKind {
        CouplingKind::Stiff
    }
}

/// The spring as a force that damped steps take as a term.
#[derive(Debug)]
struct AsTerm(Spring);

impl Force for AsTerm {
    fn add_force(&self, _t: f64, x: &[f64], _v: &[f64], force: &mut [f64]) {
        self.0.add_forces(x, 1.0, force);
    }
}

impl ImplicitForce for AsTerm {
    fn term(&self, _free: Arc<[bool]>) -> Box<dyn Term> {
        Box::new(self.0)
    }
}

impl Term for Spring {
    fn begin(&mut self, _step: &StepStart<'_>) -> Result<(), StepError> {
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        Value::of(self.stored(at.x))
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        self.add_forces(at.x, -scale, out);
    }

    fn add_hessian(&mut self, _at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        let [a, b] = self.ends.map(|v| v.0);
        sink.add(a, a, &self.block());
        sink.add(b, b, &self.block());
        sink.add(a, b, &-self.block());
    }

    fn append_couplings(&mut self, _at: Iterate<'_>, out: &mut Vec<[u32; 2]>) {
        out.push(self.ends.map(|v| v.0));
    }

    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        Ok(Exchange {
            stored: self.stored(at.x) - self.stored(&step.state.x),
            ..Exchange::default()
        })
    }
}

#[test]
fn a_spring_moves_a_sheet_alike_as_a_term_and_as_a_potential() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let spring = Spring {
        ends: [VertexId(4), VertexId(20)],
        stiffness: 2.0,
    };
    let base = || {
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
        model.with_gravity().with_pins(&[VertexId(0)]).unwrap()
    };
    let mut x = sheet.positions().to_vec();
    leave_flat(&base(), &mut x, 0.1, 3).unwrap();
    let options = ImplicitOptions {
        tolerance: Some(1e-12),
        ..ImplicitOptions::default()
    };
    for method in [
        Method::Bdf2(options.clone()),
        Method::ImplicitEuler(options),
    ] {
        let end = |model: SheetModel| {
            let start = State::at_rest(x.clone());
            let mut run = Simulation::new(model, start, method.clone()).unwrap();
            for _ in 0..12 {
                run.step(0.01).unwrap();
            }
            run.state().x.clone()
        };
        let without = end(base());
        let potential = end(base().with_potential(spring));
        let term = end(base().with_implicit_force(AsTerm(spring)));
        let gap = |other: &[f64]| {
            let apart = potential.iter().zip(other).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max)
        };
        let (apart, pulled) = (gap(&term), gap(&without));
        assert!(pulled > 1e-2, "{pulled} m");
        assert!(apart < 1e-6 * pulled, "{apart} of {pulled} m");
    }
}
