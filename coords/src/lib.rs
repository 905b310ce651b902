//! System coordinates of a developable mesh, after Liu, Tang and Joneja, *Modeling dynamic
//! developable meshes by the Hamilton principle*, Computer-Aided Design 39 (2007) 719-731, Sec. 3.

mod frames;
pub mod linalg;
pub mod placement;
mod vec3;

pub use frames::{EdgeFrame, EulerParameters, SphericalFrame};
pub use placement::{Branch, PlacementError};
