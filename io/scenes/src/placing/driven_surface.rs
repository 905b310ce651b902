//! Surfaces in prescribed motion in a simulation.

use isosheet_mesh::Part;
use std::ops::Range;

/// An obstacle whose surface is part of a simulation: its vertices are pinned, and follow a mesh in motion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DrivenSurface {
    /// The number of the obstacle in the scene.
    pub(crate) number: usize,
    /// Its vertices in the model.
    pub(crate) vertices: Range<usize>,
    /// Where its surface is among the sheets and the surfaces of bodies.
    pub(crate) part: Part,
}

/// The number in the scene of one of the obstacles that do not deform.
pub(crate) fn rigid_obstacle(driven: &[DrivenSurface], number: usize) -> usize {
    driven.iter().fold(number, |number, surface| {
        number + usize::from(surface.number <= number)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_rigid_obstacles_pass_over_those_that_deform() {
        let surface = |number| DrivenSurface {
            number,
            vertices: 0..0,
            part: Part {
                vertices: 0..0,
                edges: 0..0,
                faces: 0..0,
            },
        };
        let driven = [surface(0), surface(2), surface(3)];
        assert_eq!([0, 1, 2].map(|k| rigid_obstacle(&driven, k)), [1, 4, 5]);
        assert_eq!(rigid_obstacle(&[], 3), 3);
    }
}
