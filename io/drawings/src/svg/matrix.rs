//! Affine maps of the plane.

use svgtypes::{TransformListParser, TransformListToken};

/// The map `p -> m[0] p[0] + m[1] p[1] + m[2]`.
pub(super) type Matrix = [[f64; 2]; 3];

pub(super) const IDENTITY: Matrix = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];

/// The map that takes `inner` first.
pub(super) fn compose(outer: Matrix, inner: Matrix) -> Matrix {
    let linear = |p: [f64; 2]| [0, 1].map(|k| outer[0][k] * p[0] + outer[1][k] * p[1]);
    let [u, v, w] = inner.map(linear);
    [u, v, [w[0] + outer[2][0], w[1] + outer[2][1]]]
}

/// The map of a property `transform`, which may have the units that the attribute has not; `None` if it
/// cannot be read.
pub(super) fn parse(text: &str) -> Option<Matrix> {
    let mut matrix = IDENTITY;
    if text == "none" {
        return Some(matrix);
    }
    let text = text.replace("px", "").replace("deg", "");
    for token in TransformListParser::from(text.as_str()) {
        let next = match token.ok()? {
            TransformListToken::Matrix { a, b, c, d, e, f } => [[a, b], [c, d], [e, f]],
            TransformListToken::Translate { tx, ty } => translation(tx, ty),
            TransformListToken::Scale { sx, sy } => scaling(sx, sy),
            TransformListToken::Rotate { angle } => {
                let (sin, cos) = angle.to_radians().sin_cos();
                [[cos, sin], [-sin, cos], [0.0, 0.0]]
            }
            TransformListToken::SkewX { angle } => {
                [[1.0, 0.0], [angle.to_radians().tan(), 1.0], [0.0, 0.0]]
            }
            TransformListToken::SkewY { angle } => {
                [[1.0, angle.to_radians().tan()], [0.0, 1.0], [0.0, 0.0]]
            }
        };
        matrix = compose(matrix, next);
    }
    Some(matrix)
}

/// A map about a point, which is written as two numbers; `None` if it is written in another way.
pub(super) fn about(point: &str, matrix: Matrix) -> Option<Matrix> {
    let numbers = point.split(|c: char| c == ',' || c.is_whitespace());
    let numbers = numbers.filter(|part| !part.is_empty());
    let numbers = numbers.map(|part| part.trim_end_matches("px").parse().ok());
    let [x, y] = numbers.collect::<Option<Vec<f64>>>()?[..] else {
        return None;
    };
    let there = compose(translation(x, y), matrix);
    Some(compose(there, translation(-x, -y)))
}

pub(super) fn translation(x: f64, y: f64) -> Matrix {
    [[1.0, 0.0], [0.0, 1.0], [x, y]]
}

pub(super) fn scaling(x: f64, y: f64) -> Matrix {
    [[x, 0.0], [0.0, y], [0.0, 0.0]]
}
