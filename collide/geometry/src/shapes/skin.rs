//! What of the surface of a shape is curved.

/// The surface that the triangles of a shape stand for. Lengths in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Skin {
    /// The triangles themselves.
    Flat,
    /// The plane z = 0, which has no end.
    Plane,
    /// All points at a radius from the z axis between `-half_length` and `half_length`: of a ball this is 0.
    Round {
        /// Half the length of the axis.
        half_length: f64,
        /// The radius.
        radius: f64,
    },
    /// A cylinder about the z axis between `-half_length` and `half_length`, flat at both ends.
    Tube {
        /// Half the length of the axis.
        half_length: f64,
        /// The radius.
        radius: f64,
    },
}
