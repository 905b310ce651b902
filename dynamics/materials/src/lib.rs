//! Potential energies of sheets, and materials.
//!
//! A [`Potential`] is an energy of the positions of all vertices, `V(t, x)`, with a gradient, and a Hessian
//! that it gives to a [`HessianSink`] block by block. This crate has the trait, and the energies of a sheet:
//!
//! | potential | of |
//! |---|---|
//! | [`ElasticSheet`] | stretching of the faces, orthotropic too, with a limit of the strain |
//! | [`PlateBending`] | bending of a sheet, orthotropic and curled too, with clamps and yield |
//! | [`CreaseSprings`] | angles of edges: creases, driven and yielding ones |
//! | [`Glue`] | vertices that are held together until they peel |
//! | [`Gravity`] | weight |
//!
//! A [`Material`] says what a square metre of paper, cloth or metal weighs, and how it resists stretching and
//! bending. What moves sheets by these energies is in `isosheet-dynamics`; anything else can be, which needs
//! no more than this crate.
//!
//! SI units; positions and forces are slices of length `3V`; fold angles are positive for valleys.

mod crease;
mod derivative;
mod direction;
mod elastic_sheet;
mod evaluation;
mod glue;
pub mod hessian;
mod limit_error;
mod material;
mod options;
mod orthotropy;
mod patched;
mod plasticity;
mod plate_bending;
pub mod potential;
mod stiffening;
#[cfg(test)]
mod testing;
pub mod vectors;

pub use crease::{CreaseError, CreaseSpring, CreaseSprings, FLAT, RestAngle, folding_from_flat};
pub use derivative::NoDerivative;
pub use direction::{DirectionError, MaterialDirection};
pub use elastic_sheet::{
    CurvedFace, ElasticSheet, ElasticSheetError, MembraneLaw, OrthotropicMembrane, StrainOfFace,
};
pub use glue::{Glue, GlueError};
pub use hessian::HessianSink;
pub use limit_error::{LimitError, Refused};
pub use material::{Directions, Isotropic, Material, NamedMaterial, Orthotropic, UnknownMaterial};
pub use options::OptionsError;
pub use patched::{NoFace, Patched};
pub use plasticity::Yield;
pub use plate_bending::{
    Curl, CurlError, Curvature, FaceCurvature, LineClamp, NaturalTensor, OrthotropicPlate,
    PlateBending, PlateBendingError, PlateEdges, PlateLaw, PlateStiffness,
};
pub use potential::{
    At, CouplingKind, Difference, Force, Gravity, HessianKind, Limited, MaterialReport, Memories,
    PAPER_GRAVITY, Potential, PotentialShape, Reached, Remembering, Settled,
};
pub use stiffening::Stiffening;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
