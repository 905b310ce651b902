//! Mechanical problems, shared by the tests that span several crates and by reports. Each model gives a
//! sheet, a start state and the exact motion, but for [`tumbling`], which gives a start alone, for [`bumped`]
//! and [`bent`] sheets, for [`RigidBody`], which gives the motion of any sheet that cannot bend, and for
//! states of rest: [`Elastica`], [`buckled`] strips and [`ExcessCone`]. [`pushed`] has loads of all kinds
//! with the exact motion, and [`held_strip`] all kinds of supports, whose forces have to balance.

mod bent;
mod buckled;
mod bumped;
mod catenary;
mod elastica;
mod elliptic;
mod excess_cone;
pub mod flag;
mod flap;
pub mod held_strip;
mod linkage;
mod methods;
mod pendulum;
pub mod pushed;
mod rigid_body;
mod strip;
mod triangle;
mod tumbling;

pub use bent::bent;
pub use buckled::buckled;
pub use bumped::{bumped, corner, raised};
pub use catenary::Catenary;
pub use elastica::{Elastica, Hanging};
pub use elliptic::{agm, complete_k, jacobi};
pub use excess_cone::ExcessCone;
pub use flap::Flap;
pub use linkage::Linkage;
pub use methods::{
    Named, conservative, damped, damped_to, energy_momentum, implicit_euler, methods,
    rattle_composition,
};
pub use pendulum::Pendulum;
pub use rigid_body::RigidBody;
pub use strip::{HangingStrip, laguerre, laguerre_zeros, strip_faces};
pub use triangle::FreeTriangle;
pub use tumbling::{tumbling, tumbling_from};

/// Observed orders `log2(e_k / e_{k+1})` of a sequence of errors at halved steps.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect()
}

/// Largest absolute difference of two vectors.
pub fn max_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "vectors of equal length");
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

/// The Rust samples of the book and of the README, compiled and run as documentation tests.
#[cfg(doctest)]
mod book {
    #[doc = include_str!("../README.md")]
    pub struct Readme;

    #[doc = include_str!("../../README.md")]
    pub struct OfRepository;

    #[doc = include_str!("../../docs/start.md")]
    pub struct Start;

    #[doc = include_str!("../../docs/methods.md")]
    pub struct Methods;

    #[doc = include_str!("../../docs/rust.md")]
    pub struct InRust;

    #[doc = include_str!("../../docs/gradients.md")]
    pub struct Gradients;

    #[doc = include_str!("../../docs/contribute.md")]
    pub struct Contribute;
}
