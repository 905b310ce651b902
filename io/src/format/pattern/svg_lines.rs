//! The strokes of an SVG drawing as straight lines, each as it is painted.

use crate::format::DataError;
use resvg::usvg::tiny_skia_path::{PathSegment, Point, Transform};
use resvg::usvg::{Group, Node, Options, Paint, Tree};

/// A straight part of a stroke.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StrokeLine {
    /// Where it begins and ends, in pixels of which 96 are an inch, x to the right and y downwards.
    pub(super) ends: [[f64; 2]; 2],
    /// Red, green and blue; none of gradients and patterns.
    pub(super) colour: Option<[u8; 3]>,
    /// From 0 to 1, that of the groups that it is in included.
    pub(super) opacity: f64,
}

/// The strokes of a drawing, with styles, groups, transformations and the view box resolved. Curves become straight
/// lines that are nowhere further from them than `flatness`, as a part of the longer side of the drawing.
pub(super) fn stroke_lines(bytes: &[u8], flatness: f64) -> Result<Vec<StrokeLine>, DataError> {
    let tree = Tree::from_data(bytes, &Options::default()).map_err(|e| {
        let message = format!("the file is not valid SVG: {e}");
        DataError::new(message, "copy or export it again")
    })?;
    let size = f64::from(tree.size().width().max(tree.size().height()));
    let mut lines = Vec::new();
    of_group(tree.root(), 1.0, flatness * size, &mut lines);
    Ok(lines)
}

fn of_group(group: &Group, opacity: f64, flatness: f64, lines: &mut Vec<StrokeLine>) {
    let opacity = opacity * f64::from(group.opacity().get());
    for node in group.children() {
        match node {
            Node::Group(group) => of_group(group, opacity, flatness, lines),
            Node::Path(path) => {
                let Some(stroke) = path.stroke() else {
                    continue;
                };
                let colour = match stroke.paint() {
                    Paint::Color(c) => Some([c.red, c.green, c.blue]),
                    _ => None,
                };
                let opacity = opacity * f64::from(stroke.opacity().get());
                for ends in straight(path.data().segments(), path.abs_transform(), flatness) {
                    lines.push(StrokeLine {
                        ends,
                        colour,
                        opacity,
                    });
                }
            }
            Node::Image(_) | Node::Text(_) => {}
        }
    }
}

/// The straight lines of a path.
fn straight(
    segments: impl Iterator<Item = PathSegment>,
    transform: Transform,
    flatness: f64,
) -> Vec<[[f64; 2]; 2]> {
    let placed = |p: Point| {
        let [a, b, c, d, e, f] = [
            transform.sx,
            transform.ky,
            transform.kx,
            transform.sy,
            transform.tx,
            transform.ty,
        ]
        .map(f64::from);
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        [a * x + c * y + e, b * x + d * y + f]
    };
    let mut lines = Vec::new();
    let (mut first, mut last) = ([0.0; 2], [0.0; 2]);
    let mut curve = |controls: Vec<[f64; 2]>, last: &mut [f64; 2]| {
        for to in points_of_curve(&controls, flatness) {
            if to != *last {
                lines.push([*last, to]);
            }
            *last = to;
        }
    };
    for segment in segments {
        match segment {
            PathSegment::MoveTo(p) => (first, last) = (placed(p), placed(p)),
            PathSegment::LineTo(p) => curve(vec![last, placed(p)], &mut last),
            PathSegment::QuadTo(p, q) => curve(vec![last, placed(p), placed(q)], &mut last),
            PathSegment::CubicTo(p, q, r) => {
                curve(vec![last, placed(p), placed(q), placed(r)], &mut last);
            }
            PathSegment::Close => curve(vec![last, first], &mut last),
        }
    }
    lines
}

/// Most parts of a curve.
const MOST_PARTS: f64 = 64.0;

/// Points on a Bezier curve after its first one: between two of them it is as far from its chord as `flatness` at most.
fn points_of_curve(controls: &[[f64; 2]], flatness: f64) -> Vec<[f64; 2]> {
    let degree = (controls.len() - 1) as f64;
    let second = controls.windows(3).map(|c| {
        let d = [0, 1].map(|k| c[0][k] - 2.0 * c[1][k] + c[2][k]);
        d[0].hypot(d[1])
    });
    // The distance of a curve from its chord is at most an eighth of its second derivative.
    let bend = degree * (degree - 1.0) * second.fold(0.0, f64::max);
    let parts = (bend / (8.0 * flatness))
        .sqrt()
        .ceil()
        .clamp(1.0, MOST_PARTS) as usize;
    let point = |part: usize| {
        let t = part as f64 / parts as f64;
        let mut p = controls.to_vec();
        while p.len() > 1 {
            p = p
                .windows(2)
                .map(|w| [0, 1].map(|k| w[0][k] + t * (w[1][k] - w[0][k])))
                .collect();
        }
        p[0]
    };
    let last = controls[controls.len() - 1];
    (1..parts).map(point).chain([last]).collect()
}
