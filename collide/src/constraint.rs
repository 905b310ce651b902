//! Vertices constrained to bodies, or to one side of them.

use crate::{Obstacle, Shape, SignedDistance, TriangleSurface};
use isosheet_dynamics::VertexConstraint;
use isosheet_dynamics::constraint::{Side, Surface, SurfacePoint};
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

#[cfg(test)]
mod tests;

impl From<SignedDistance> for SurfacePoint {
    fn from(d: SignedDistance) -> Self {
        Self {
            level: d.value,
            gradient: d.normal,
            hessian: d.hessian,
        }
    }
}

/// The level is [`Shape::signed_distance`], in the body's own frame. Outside a body its gradient is
/// continuous, and the second derivative jumps where the closest point passes from one face, edge or corner
/// to another; on the sharp edges of a box, a cylinder or triangles the gradient jumps too.
impl Surface for Shape {
    fn at(&self, p: &Vector3<f64>) -> SurfacePoint {
        match self {
            Self::Surface(surface) => surface.at(p),
            _ => self.signed_distance(p).into(),
        }
    }
}

/// The level is [`TriangleSurface::signed_distance`] if the surface is closed. Of an open surface the level
/// is the distance with the sign of the side, negative on the side that the face normals point away from:
/// the distance alone has a kink on the surface, where a constraint needs its gradient. Beyond the rim of an
/// open surface the level is the distance from the rim, and its sign jumps where the surface would go on.
impl Surface for TriangleSurface {
    fn at(&self, p: &Vector3<f64>) -> SurfacePoint {
        self.oriented_distance(p).into()
    }
}

impl Obstacle {
    /// Constrains a vertex to the body, or to one side of it, without friction; the constraint moves as the
    /// body does.
    ///
    /// ```
    /// use isosheet_collide::{Obstacle, Shape};
    /// use isosheet_dynamics::{SheetModel, constraint::Side};
    /// use isosheet_mesh::{MassKind, VertexId, generate};
    /// use nalgebra::Isometry3;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(1, 1.0)?;
    /// let ball = Obstacle::fixed(
    ///     Shape::Sphere { radius: 0.5 },
    ///     Isometry3::translation(0.0, 0.0, -0.5),
    /// )?;
    /// let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?
    ///     .with_constraint(ball.constraint(VertexId(0), Side::On))?;
    /// assert_eq!(model.largest_violation(0.0, sheet.positions()), Some(0.0));
    /// # Ok(())
    /// # }
    /// ```
    pub fn constraint(&self, vertex: VertexId, side: Side) -> VertexConstraint {
        let surface = VertexConstraint::on_surface(vertex, self.shape().clone(), side);
        surface.moving(self.motion().clone())
    }
}
