//! Derivatives against differences.

use isosheet_materials::hessian::HessianProduct;
use isosheet_materials::potential::{At, Potential};
use isosheet_materials::vectors::dot;
use isosheet_mesh::Topology;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Displacements of central differences, as parts of the size of the positions. The error of a difference of
/// smooth energies falls by the square of the displacement until round-off takes over; the best of these is
/// that of neither.
const DISPLACEMENTS: [f64; 6] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];

/// By how much derivatives differ from central differences, as parts of their size: zero where the
/// differences do not resolve it, since the energy is large against its change or near a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DerivativeErrors {
    /// Of the gradient against the energy.
    pub gradient: f64,
    /// Of the Hessian against the gradient. A Hessian may leave blocks out, which costs iterations and no
    /// accuracy: then it differs.
    pub hessian: f64,
}

/// Compares gradient and Hessian of a potential of a sheet of this topology with central differences at a
/// place, along its gradient and along two directions that are random with a fixed seed.
///
/// ```
/// use isosheet_dynamics::{At, CreaseSprings, check_derivatives};
/// use isosheet_mesh::generate;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(1, 0.2)?;
/// let bending = CreaseSprings::bending(&sheet, 5e-4)?;
/// // A shape that is bent: in a flat one the gradient is zero.
/// let bent = sheet.map_positions(|[x, y, _]| [x, y, x * x + 0.3 * x * y])?;
/// let errors = check_derivatives(&bending, sheet.topology(), At::new(0.0, bent.positions()));
/// assert!(errors.gradient < 1e-6 && errors.hessian < 1e-6);
/// # Ok(())
/// # }
/// ```
///
/// # Panics
/// If the positions are not `3V`.
pub fn check_derivatives(
    potential: &dyn Potential,
    topology: &Topology,
    at: At<'_>,
) -> DerivativeErrors {
    let edges: Vec<[usize; 2]> = topology
        .edges()
        .iter()
        .map(|ends| ends.map(|v| v.index()))
        .collect();
    let at_x = |x: &[f64], f: &mut dyn FnMut(At<'_>)| f(At { x, ..at });
    let mut energy = |x: &[f64]| {
        let mut value = 0.0;
        at_x(x, &mut |at| value = potential.energy(at));
        value
    };
    let mut gradient = |x: &[f64]| {
        let mut sum = vec![0.0; x.len()];
        at_x(x, &mut |at| potential.add_gradient(at, &mut sum));
        sum
    };
    let mut product = |d: &[f64]| {
        let mut sum = vec![0.0; d.len()];
        let mut sink = HessianProduct {
            edges: &edges,
            scale: 1.0,
            vector: d,
            product: &mut sum,
        };
        potential.add_hessian(at, &mut sink);
        sum
    };
    errors(at.x, &mut energy, &mut gradient, &mut product)
}

/// The errors of a gradient and a Hessian, which is given by its products.
fn errors(
    x: &[f64],
    energy: &mut dyn FnMut(&[f64]) -> f64,
    gradient: &mut dyn FnMut(&[f64]) -> Vec<f64>,
    product: &mut dyn FnMut(&[f64]) -> Vec<f64>,
) -> DerivativeErrors {
    let size = x
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()))
        .max(f64::MIN_POSITIVE);
    let own = gradient(x);
    let largest = norm(&own);
    if !largest.is_finite() || !energy(x).is_finite() {
        return DerivativeErrors {
            gradient: f64::INFINITY,
            hessian: f64::INFINITY,
        };
    }
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut directions: Vec<Vec<f64>> = (0..2)
        .map(|_| x.iter().map(|_| random.random_range(-1.0..1.0)).collect())
        .collect();
    if largest > 0.0 {
        directions.push(own.iter().map(|g| g / largest).collect());
    }
    let mut errors = DerivativeErrors {
        gradient: 0.0,
        hessian: 0.0,
    };
    for direction in &directions {
        let along = norm(direction);
        let slope = dot(&own, direction);
        let second = product(direction);
        let mut slopes = Vec::new();
        let mut best_second = f64::INFINITY;
        if !norm(&second).is_finite() {
            errors.hessian = f64::INFINITY;
        }
        for part in DISPLACEMENTS {
            let h = part * size / along;
            let moved = |sign: f64| -> Vec<f64> {
                let pairs = x.iter().zip(direction);
                pairs.map(|(x, d)| x + sign * h * d).collect()
            };
            let places = [moved(1.0), moved(-1.0)];
            let energies = [energy(&places[0]), energy(&places[1])];
            let gradients = [gradient(&places[0]), gradient(&places[1])];
            // What the round-off of energies and of positions makes of the difference.
            let energies_size = energies[0].abs() + energies[1].abs();
            let forces = norm(&gradients[0]) + norm(&gradients[1]);
            let noise = f64::EPSILON * (energies_size + size * forces) / h;
            slopes.push(((energies[0] - energies[1]) / (2.0 * h), noise));
            let [ahead, behind] = gradients;
            let pairs = ahead.iter().zip(&behind);
            let change: Vec<f64> = pairs.map(|(a, b)| (a - b) / (2.0 * h)).collect();
            let off: Vec<f64> = change.iter().zip(&second).map(|(a, b)| a - b).collect();
            best_second = best_second.min(norm(&off) / norm(&change).max(norm(&second)));
        }
        if let Some((found, off)) = resolved(&slopes, slope) {
            let size = (largest * along).max(found.abs());
            errors.gradient = errors.gradient.max(off / size);
        }
        if best_second.is_finite() {
            errors.hessian = errors.hessian.max(best_second);
        }
    }
    errors
}

/// The difference of a derivative from the most certain of its central differences, after that itself; none
/// where the differences do not resolve it.
fn resolved(differences: &[(f64, f64)], derivative: f64) -> Option<(f64, f64)> {
    let (found, uncertainty) = settled(differences)?;
    let off = (found - derivative).abs();
    // What the differences do not resolve says nothing.
    (off > 10.0 * uncertainty).then_some((found, off))
}

/// By how much the derivative of a function of a number differs from central differences at `x > 0`, as a
/// part of the larger of the two; zero where the differences do not resolve it.
pub(super) fn error_at(x: f64, f: impl Fn(f64) -> f64, derivative: f64) -> f64 {
    let differences = DISPLACEMENTS.map(|part| {
        let h = part * x;
        let [ahead, behind] = [f(x + h), f(x - h)];
        let noise = f64::EPSILON * (ahead.abs() + behind.abs() + x * derivative.abs()) / h;
        ((ahead - behind) / (2.0 * h), noise)
    });
    let part = |(found, off): (f64, f64)| off / derivative.abs().max(found.abs());
    resolved(&differences, derivative).map_or(0.0, part)
}

/// Of values with their noise the most certain one, and how uncertain it is: by the noise, or by how much it
/// differs from the one before.
fn settled(values: &[(f64, f64)]) -> Option<(f64, f64)> {
    let pairs = values.windows(2).map(|pair| {
        let [(before, _), (value, noise)] = [pair[0], pair[1]];
        (value, (value - before).abs().max(noise))
    });
    let finite = pairs.filter(|(value, uncertainty)| value.is_finite() && uncertainty.is_finite());
    finite.min_by(|a, b| a.1.total_cmp(&b.1))
}

fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}
