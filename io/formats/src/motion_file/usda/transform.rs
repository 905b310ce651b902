//! Where parts of a scene of Universal Scene Description are.

use super::layer::{Attribute, Prim, Value};
use nalgebra::{Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3};

/// A transformation of a part.
#[derive(Clone, Copy)]
struct Operation<'a> {
    /// The kind after `xformOp:`.
    kind: &'a str,
    is_inverted: bool,
    values: &'a Attribute,
}

/// The transformations of a part and of those that it is in, the outermost first.
#[derive(Clone, Default)]
pub(super) struct Placing<'a>(Vec<Operation<'a>>);

impl<'a> Placing<'a> {
    /// The transformations of a part in this one, with those of this one before them.
    pub(super) fn within(&self, prim: &'a Prim) -> Result<Self, String> {
        let mut all = self.0.clone();
        let order = prim.attribute("xformOpOrder").and_then(Attribute::at_first);
        for name in order.iter().flat_map(|value| &value.texts) {
            if name == "!resetXformStack!" {
                all.clear();
                continue;
            }
            let (is_inverted, attribute) = match name.strip_prefix("!invert!") {
                Some(attribute) => (true, attribute),
                None => (false, &name[..]),
            };
            let values = prim.attribute(attribute);
            let values = values.ok_or_else(|| format!("has no attribute {attribute}"))?;
            let kind = attribute.strip_prefix("xformOp:").unwrap_or(attribute);
            let kind = kind.split(':').next().unwrap_or_default();
            all.push(Operation {
                kind,
                is_inverted,
                values,
            });
        }
        Ok(Self(all))
    }

    /// The time codes of its samples.
    pub(super) fn codes(&self) -> impl Iterator<Item = f64> {
        let samples = self
            .0
            .iter()
            .flat_map(|operation| &operation.values.samples);
        samples.map(|(code, _)| *code)
    }

    /// The transformation at a time code; none if nothing is moved.
    pub(super) fn at(&self, code: f64) -> Result<Option<Matrix4<f64>>, String> {
        let mut whole = None;
        for operation in &self.0 {
            let one = operation.at(code)?;
            whole = Some(whole.map_or(one, |outer: Matrix4<f64>| outer * one));
        }
        Ok(whole)
    }
}

impl Operation<'_> {
    fn at(&self, code: f64) -> Result<Matrix4<f64>, String> {
        let kind = self.kind;
        let (before, after, part) = self.values.about(code);
        let of = |number: usize| self.values.value(number).unwrap_or(&EMPTY);
        let (from, to) = (&of(before).numbers, &of(after).numbers);
        let wrong = || format!("has an operation xformOp:{kind} that is not understood");
        let matrix = if kind == "orient" {
            let turn = |numbers: &[f64]| match *numbers {
                [w, x, y, z] => UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 0.0),
                _ => None,
            };
            let (from, to) = (turn(from).ok_or_else(wrong)?, turn(to).ok_or_else(wrong)?);
            let between = from.try_slerp(&to, part, 0.0).unwrap_or(from);
            between.to_homogeneous()
        } else {
            let numbers = from.iter().zip(to).map(|(a, b)| a + part * (b - a));
            let numbers: Vec<f64> = numbers.collect();
            match (kind, &numbers[..]) {
                ("translate", &[x, y, z]) => Matrix4::new_translation(&Vector3::new(x, y, z)),
                ("scale", &[x, y, z]) => Matrix4::new_nonuniform_scaling(&Vector3::new(x, y, z)),
                // Rows of the file are columns: points are rows that are multiplied from the left.
                ("transform", numbers) if numbers.len() == 16 => {
                    Matrix4::from_column_slice(numbers)
                }
                (_, angles) => {
                    let axes = kind.strip_prefix("rotate").ok_or_else(wrong)?;
                    let given: Option<Vec<f64>> = match (axes.len(), angles) {
                        (1, [angle]) => Some(vec![*angle]),
                        // One for each of x, y and z, whatever the order.
                        (3, [x, y, z]) => Some(vec![*x, *y, *z]),
                        _ => None,
                    };
                    let given = given.ok_or_else(wrong)?;
                    let mut whole = Rotation3::identity();
                    for axis in axes.bytes() {
                        let (number, axis) = match axis {
                            b'X' => (0, Vector3::x_axis()),
                            b'Y' => (1, Vector3::y_axis()),
                            b'Z' => (2, Vector3::z_axis()),
                            _ => return Err(wrong()),
                        };
                        let angle = given[if given.len() == 1 { 0 } else { number }];
                        // The first of the name is the first to turn a point.
                        whole = Rotation3::from_axis_angle(&axis, angle.to_radians()) * whole;
                    }
                    whole.to_homogeneous()
                }
            }
        };
        if self.is_inverted {
            return matrix.try_inverse().ok_or_else(wrong);
        }
        Ok(matrix)
    }
}

/// Nothing.
static EMPTY: Value = Value {
    numbers: Vec::new(),
    texts: Vec::new(),
};

/// A point in its place.
pub(super) fn apply(place: &Matrix4<f64>, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let moved = place * nalgebra::Vector4::new(x, y, z, 1.0);
    [moved.x, moved.y, moved.z]
}
