//! The nearly flat square that most comparisons hang by a corner.

use isosheet_mesh::{Sheet, VertexId, generate};
use std::f64::consts::PI;

/// The union-jack square `M^level` of side 1 m with `z = bump sin(pi x) sin(pi y)`, metres.
pub fn bumped(level: u32, bump: f64) -> Sheet {
    let flat = generate::isotropic_square(level, 1.0).expect("a level that memory can hold");
    let raised = flat.map_positions(|p| raised(p, bump));
    raised.expect("no two vertices are at one place")
}

/// A point of the flat square on the bump.
pub fn raised([x, y, _]: [f64; 3], bump: f64) -> [f64; 3] {
    [x, y, bump * (PI * x).sin() * (PI * y).sin()]
}

/// The corner (0, 1) of `M^level`.
pub fn corner(level: u32) -> VertexId {
    let n = (2 << level) + 1;
    VertexId(n * (n - 1))
}
