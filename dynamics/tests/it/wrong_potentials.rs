//! What the comparison with differences says of potentials that are wrong.

use isosheet_dynamics::nalgebra::Matrix3;
use isosheet_dynamics::{At, HessianSink, Potential, check_derivatives};
use isosheet_mesh::{VertexId, generate};

/// The energy `|x|^2 / 2`, with factors of it, its gradient and its Hessian.
#[derive(Debug)]
struct Square([f64; 3]);

impl Potential for Square {
    fn energy(&self, at: At<'_>) -> f64 {
        0.5 * self.0[0] * at.x.iter().map(|x| x * x).sum::<f64>()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        for (g, x) in gradient.iter_mut().zip(at.x) {
            *g += self.0[1] * x;
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        for v in 0..at.x.len() / 3 {
            hessian.add_vertex(VertexId::from_index(v), &(self.0[2] * Matrix3::identity()));
        }
    }
}

#[test]
fn no_wrong_derivative_passes() {
    let sheet = generate::isotropic_square(1, 0.2).expect("a square");
    let errors = |factors: [f64; 3]| {
        let at = At::new(0.0, sheet.positions());
        let errors = check_derivatives(&Square(factors), sheet.topology(), at);
        [errors.gradient, errors.hessian]
    };
    assert!(errors([1.0; 3]).iter().all(|e| *e < 1e-6));
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(errors([bad, 1.0, 1.0])[0] > 1.0);
        assert!(errors([1.0, bad, 1.0])[0] > 1.0);
        assert!(errors([1.0, 1.0, bad])[1] > 1.0);
    }
    // Without a gradient, with one of the other sign, and with one that is a hundredth off.
    assert!(errors([1.0, 0.0, 0.0])[0] > 0.9);
    assert!(errors([1.0, -1.0, -1.0])[0] > 1.9);
    assert!((errors([1.0, 1.01, 1.01])[0] - 0.0099).abs() < 1e-4);
    // Where the gradient is right and the Hessian is not.
    assert!(errors([1.0, 1.0, 1.1])[1] > 0.05);
}
