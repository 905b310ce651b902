//! Vertices constrained to bodies, or to one side of them.

use crate::Obstacle;
use isosheet_dynamics::VertexConstraint;
use isosheet_dynamics::constraint::{Side, Surface, SurfacePoint};
use isosheet_geometry::Shape;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

#[cfg(test)]
mod tests;

/// The surface of a body in its own frame; its level is [`Shape::oriented_distance`]. Outside a body the
/// gradient is continuous, and the second derivative jumps where the closest point passes from one face, edge
/// or corner to another; on the sharp edges of a box, a cylinder or triangles the gradient jumps too.
#[derive(Debug)]
struct Level(Shape);

impl Surface for Level {
    fn at(&self, p: &Vector3<f64>) -> SurfacePoint {
        let distance = self.0.oriented_distance(p);
        SurfacePoint {
            level: distance.value,
            gradient: distance.normal,
            hessian: distance.hessian,
        }
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
        let surface = VertexConstraint::on_surface(vertex, Level(self.shape().clone()), side);
        surface.moving(self.motion().clone())
    }
}
