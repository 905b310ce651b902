//! Polynomials with rational coefficients, their real roots, and signs at these: exact.

use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};
use std::rc::Rc;

/// A polynomial: its coefficients from the constant one on, the last of which is not zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polynomial(Vec<BigRational>);

impl Polynomial {
    fn new(mut coefficients: Vec<BigRational>) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    /// `x + t dx` of numbers as they are.
    pub(super) fn motion(x: f64, dx: f64) -> Self {
        let exactly = |x| BigRational::from_float(x).expect("a finite number");
        Self::new(vec![exactly(x), exactly(dx)])
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    fn at(&self, t: &BigRational) -> BigRational {
        let terms = self.0.iter().rev();
        terms.fold(BigRational::zero(), |value, c| value * t + c)
    }

    fn sign(&self, t: &BigRational) -> Ordering {
        self.at(t).cmp(&BigRational::zero())
    }

    fn derivative(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self::new(
            terms
                .map(|(k, c)| c * BigRational::from_integer(k.into()))
                .collect(),
        )
    }

    /// Quotient and remainder of a division.
    fn divided(&self, by: &Self) -> [Self; 2] {
        let last = by.0.last().expect("no division by zero");
        let mut rest = self.0.clone();
        let mut quotient = Vec::new();
        while rest.len() >= by.0.len() {
            let factor = rest.pop().expect("a coefficient") / last;
            let shift = rest.len() + 1 - by.0.len();
            for (k, c) in by.0[..by.0.len() - 1].iter().enumerate() {
                rest[shift + k] -= &factor * c;
            }
            quotient.push(factor);
        }
        quotient.reverse();
        [quotient, rest].map(Self::new)
    }

    /// The greatest common divisor.
    fn common(&self, other: &Self) -> Self {
        let (mut a, mut b) = (self.clone(), other.clone());
        while !b.is_zero() {
            let [_, rest] = a.divided(&b);
            (a, b) = (b, rest.reduced());
        }
        a
    }

    /// The polynomial with the same roots, each of them simple.
    fn with_simple_roots(&self) -> Self {
        let [quotient, _] = self.divided(&self.common(&self.derivative()));
        quotient
    }

    /// Over the size of the last coefficient, which keeps the numbers short.
    fn reduced(self) -> Self {
        match self.0.last().map(Signed::abs) {
            Some(last) => Self(self.0.into_iter().map(|c| c / &last).collect()),
            None => self,
        }
    }

    /// The roots from 0 to 1; of a polynomial that is not zero.
    pub(super) fn roots(&self) -> Vec<Root> {
        let of = Rc::new(Sturm::of(self));
        let [zero, one] = [BigRational::zero(), BigRational::one()];
        let mut roots = Vec::new();
        if self.sign(&zero).is_eq() {
            roots.push(Root::zero());
        }
        let mut parts = vec![[zero, one]];
        while let Some([low, high]) = parts.pop() {
            match of.count(&low, &high) {
                0 => {}
                1 => roots.push(Root {
                    of: of.clone(),
                    low,
                    high,
                }),
                _ => {
                    let middle = middle(&low, &high);
                    parts.extend([[low, middle.clone()], [middle, high]]);
                }
            }
        }
        roots
    }
}

/// The chain of polynomials whose signs count the roots of the first one, which are simple.
#[derive(Debug)]
struct Sturm(Vec<Polynomial>);

impl Sturm {
    /// The chain for the roots of a polynomial that is not zero, each counted once.
    fn of(polynomial: &Polynomial) -> Self {
        let first = polynomial.with_simple_roots().reduced();
        let mut chain = vec![first.derivative(), first];
        chain.reverse();
        while let [.., a, b] = &chain[..]
            && !b.is_zero()
        {
            let [_, rest] = a.divided(b);
            chain.push((-&rest).reduced());
        }
        Self(chain)
    }

    /// The number of roots in `(low, high]`.
    fn count(&self, low: &BigRational, high: &BigRational) -> usize {
        let changes = |t| {
            let signs = self.0.iter().map(|p| p.sign(t)).filter(|s| s.is_ne());
            let signs: Vec<Ordering> = signs.collect();
            signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
        };
        changes(low) - changes(high)
    }
}

fn middle(low: &BigRational, high: &BigRational) -> BigRational {
    (low + high) / BigRational::from_integer(2.into())
}

/// A real number: the only root of a polynomial in `(low, high]`.
#[derive(Clone, Debug)]
pub(super) struct Root {
    of: Rc<Sturm>,
    low: BigRational,
    high: BigRational,
}

impl Root {
    pub(super) fn zero() -> Self {
        Self {
            of: Rc::new(Sturm::of(&Polynomial::motion(0.0, 1.0))),
            low: -BigRational::one(),
            high: BigRational::zero(),
        }
    }

    /// This root in half of its interval.
    fn narrowed(self) -> Self {
        let middle = middle(&self.low, &self.high);
        match self.of.count(&self.low, &middle) {
            1 => Self {
                high: middle,
                ..self
            },
            _ => Self {
                low: middle,
                ..self
            },
        }
    }

    /// The sign of a polynomial at this number.
    pub(super) fn sign(&self, of: &Polynomial) -> Ordering {
        let is_common = || Sturm::of(&self.of.0[0].common(of)).count(&self.low, &self.high) == 1;
        if of.is_zero() {
            return Ordering::Equal;
        }
        let roots = Sturm::of(of);
        if roots.count(&self.low, &self.high) > 0 && is_common() {
            return Ordering::Equal;
        }
        // It is not zero here, so that an interval without any of its roots is found.
        let mut here = self.clone();
        while roots.count(&here.low, &here.high) > 0 {
            here = here.narrowed();
        }
        of.sign(&here.high)
    }

    /// Whether this number is greater than another.
    pub(super) fn is_above(&self, number: f64) -> bool {
        self.sign(&Polynomial::motion(-number, 1.0)).is_gt()
    }

    /// The number to thirteen digits.
    pub(super) fn rounded(&self) -> f64 {
        let narrow = (0..45).fold(self.clone(), |here, _| here.narrowed());
        narrow.high.to_f64().expect("a number from 0 to 1")
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;

    fn add(self, other: Self) -> Polynomial {
        let mut sum = self.0.clone();
        sum.resize(sum.len().max(other.0.len()), BigRational::zero());
        sum.iter_mut().zip(&other.0).for_each(|(a, b)| *a += b);
        Polynomial::new(sum)
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;

    fn neg(self) -> Polynomial {
        Polynomial(self.0.iter().map(|c| -c).collect())
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;

    fn sub(self, other: Self) -> Polynomial {
        self.add(&-other)
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;

    fn mul(self, other: Self) -> Polynomial {
        let length = self.0.len() + other.0.len();
        let mut product = vec![BigRational::zero(); length];
        for (j, a) in self.0.iter().enumerate() {
            for (k, b) in other.0.iter().enumerate() {
                product[j + k] += a * b;
            }
        }
        Polynomial::new(product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(coefficients: &[f64]) -> Polynomial {
        let terms = coefficients
            .iter()
            .map(|c| BigRational::from_float(*c).unwrap());
        Polynomial::new(terms.collect())
    }

    fn roots(coefficients: &[f64]) -> Vec<f64> {
        let mut roots: Vec<f64> = of(coefficients).roots().iter().map(Root::rounded).collect();
        roots.sort_by(f64::total_cmp);
        roots
    }

    #[test]
    fn roots_from_0_to_1_are_found_once_each() {
        let close = |a: Vec<f64>, b: &[f64]| {
            assert_eq!(a.len(), b.len(), "{a:?}");
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?}");
        };
        close(roots(&[-0.5, 0.0, 1.0]), &[0.5_f64.sqrt()]);
        // Double, at both ends, and outside.
        close(roots(&[0.25, -1.0, 1.0]), &[0.5]);
        close(roots(&[0.0, -1.0, 1.0]), &[0.0, 1.0]);
        close(roots(&[-2.0, 1.0]), &[]);
        close(roots(&[1.0]), &[]);
        // (t - 1/4)(t - 3/4)(t - 3/8)
        close(
            roots(&[-9.0 / 128.0, 9.0 / 16.0, -11.0 / 8.0, 1.0]),
            &[0.25, 0.375, 0.75],
        );
    }

    #[test]
    fn signs_at_roots_are_exact() {
        let golden = &of(&[-1.0, 1.0, 1.0]).roots()[0];
        assert_eq!(golden.sign(&of(&[-1.0, 1.0, 1.0])), Ordering::Equal);
        // (t^2 + t - 1)(t - 3)
        assert_eq!(golden.sign(&of(&[3.0, -4.0, -2.0, 1.0])), Ordering::Equal);
        let number = (5.0_f64.sqrt() - 1.0) / 2.0;
        assert!(golden.is_above(number.next_down()) != golden.is_above(number.next_up()));
        let one = &of(&[-1.0, 1.0]).roots()[0];
        assert!(!one.is_above(1.0) && one.is_above(1.0_f64.next_down()));
    }
}
