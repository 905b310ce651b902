//! Simple bodies in their own frames. Each form is described in one file, by the trait [`Form`].

mod capsule;
mod contact_geometry;
mod cuboid;
mod cylinder;
mod form;
mod half_space;
mod moments;
mod skin;
mod sphere;
mod surface;
#[cfg(test)]
mod tests;
mod triangles;

pub use contact_geometry::ContactGeometry;
pub use form::{Form, ShapeError, Symmetry};
pub use moments::Moments;
pub use skin::Skin;
pub use surface::{SurfaceError, TriangleSurface, rounded_line};
pub use triangles::Triangles;

use crate::signed_distance::SignedDistance;
use capsule::Capsule;
use cuboid::Cuboid;
use cylinder::Cylinder;
use half_space::HalfSpace;
use nalgebra::Vector3;
use sphere::Sphere;
use std::sync::Arc;

/// The form of a body in its own frame. Lengths in metres.
#[derive(Debug, Clone)]
pub enum Shape {
    /// Everything with `z <= 0`: a floor.
    HalfSpace,
    /// A box about the origin with edges along the axes.
    Cuboid {
        /// Half the edge lengths.
        half: [f64; 3],
    },
    /// A ball about the origin.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A solid cylinder about the z axis, flat at both ends.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Half its height.
        half_height: f64,
    },
    /// A cylinder about the z axis with half balls at both ends.
    Capsule {
        /// Its radius.
        radius: f64,
        /// Half the length between the centres of the balls.
        half_length: f64,
    },
    /// Triangles.
    Surface(Arc<TriangleSurface>),
    /// A form that a program describes.
    Other(Arc<dyn Form>),
}

impl Shape {
    /// Asks the form that the shape is. Nothing else knows which forms there are.
    fn ask<T>(&self, question: impl FnOnce(&dyn Form) -> T) -> T {
        match *self {
            Self::HalfSpace => question(&HalfSpace),
            Self::Cuboid { half } => question(&Cuboid { half }),
            Self::Sphere { radius } => question(&Sphere { radius }),
            Self::Cylinder {
                radius,
                half_height,
            } => question(&Cylinder {
                radius,
                half_height,
            }),
            Self::Capsule {
                radius,
                half_length,
            } => question(&Capsule {
                radius,
                half_length,
            }),
            Self::Surface(ref surface) => question(&**surface),
            Self::Other(ref form) => question(&**form),
        }
    }

    /// What it is called in messages.
    pub fn name(&self) -> &'static str {
        self.ask(|form| form.name())
    }

    /// # Errors
    /// [`ShapeError::Length`] naming the first length that is not positive.
    pub fn validate(&self) -> Result<(), ShapeError> {
        let lengths = self.ask(|form| form.lengths());
        match lengths.iter().find(|(_, l)| !(*l > 0.0 && l.is_finite())) {
            Some(&(name, value)) => Err(ShapeError::Length {
                shape: self.name(),
                name,
                value,
            }),
            None => Ok(()),
        }
    }

    /// Distance of `p` (body frame, metres) with derivatives, negative inside.
    pub fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        self.ask(|form| form.signed_distance(p))
    }

    /// Distance of `p` (body frame, metres) with derivatives, which has a sign on both sides of an open
    /// surface too: there it is [`TriangleSurface::oriented_distance`]. The zero level that a point can be
    /// constrained to.
    pub fn oriented_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        self.ask(|form| form.oriented_distance(p))
    }

    /// The primitives by which faces and edges of a mesh, not only its vertices, are kept away:
    /// a point for a ball, a segment for a capsule, both exact; the faces of a box; a prism with
    /// `segments` sides and the same rim points for a cylinder, smaller by up to
    /// `radius (1 - cos(pi / segments))`. `None` for a half-space, from which a flat face is away
    /// if its corners are.
    ///
    /// # Errors
    /// [`ShapeError::Segments`] for a cylinder with fewer than three.
    pub fn contact_geometry(&self, segments: usize) -> Result<Option<ContactGeometry>, ShapeError> {
        self.ask(|form| form.contact_geometry(segments))
    }

    /// Triangles that approximate the surface, with corners on it and so many sides of circles: what pictures
    /// and files show. `None` for a half-space, which has no end.
    ///
    /// # Errors
    /// [`ShapeError::Segments`] for fewer than four sides, or more than the shape can have.
    pub fn triangles(&self, sides: usize) -> Result<Option<Triangles>, ShapeError> {
        if sides < 4 {
            return Err(ShapeError::Segments(sides));
        }
        self.ask(|form| form.triangles(sides))
    }

    /// The least and the largest coordinates of its points (body frame, metres); `None` for a half-space.
    pub fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        self.ask(|form| form.bounds())
    }

    /// Volume with its moments in closed form; `None` where there is none: of a half-space, and of triangles,
    /// whose moments are sums over them.
    pub fn moments(&self) -> Option<Moments> {
        self.ask(|form| form.moments())
    }

    /// The rotations that leave it as it is.
    pub fn symmetry(&self) -> Symmetry {
        self.ask(|form| form.symmetry())
    }

    /// Whether it is known to be convex, as all shapes but triangles are; see [`Form::is_convex`].
    pub fn is_convex(&self) -> bool {
        self.ask(|form| form.is_convex())
    }

    /// Whether it has an inside, as all shapes have but open surfaces of triangles.
    pub fn is_solid(&self) -> bool {
        self.ask(|form| form.is_solid())
    }

    /// What of its surface is curved, and how.
    pub fn skin(&self) -> Skin {
        self.ask(|form| form.skin())
    }
}
