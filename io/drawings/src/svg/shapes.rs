//! Shapes as curves.

use super::page::{Along, Viewport};
use super::path::sub_paths;
use isosheet_mesh::plane::{EllipticArc, PlaneCurve};
use roxmltree::Node;
use std::f64::consts::{FRAC_PI_2, TAU};
use svgtypes::NumberListParser;

/// The paths of a shape in its own units, of `most` curves at most; `None` for other elements.
///
/// # Errors
/// What is wrong with its attributes.
pub(super) fn paths(
    node: Node<'_, '_>,
    viewport: Viewport,
    most: usize,
) -> Result<Option<Vec<Vec<PlaneCurve>>>, String> {
    let get = |name: &str, along| viewport.attribute(node, name, along);
    let x = |name| get(name, Along::X).map(|c| c.unwrap_or(0.0));
    let y = |name| get(name, Along::Y).map(|c| c.unwrap_or(0.0));
    // A radius that is not given is the other one.
    let radii = || {
        let [rx, ry] = [get("rx", Along::X)?, get("ry", Along::Y)?];
        Ok::<_, String>([rx.or(ry), ry.or(rx)].map(|r| r.unwrap_or(0.0)))
    };
    Ok(Some(match node.tag_name().name() {
        "path" => sub_paths(node.attribute("d").unwrap_or_default(), most)?,
        "line" => vec![lines(&[[x("x1")?, y("y1")?], [x("x2")?, y("y2")?]])],
        "polyline" => vec![lines(&points(node)?)],
        "polygon" => {
            let mut corners = points(node)?;
            corners.extend(corners.first().copied());
            vec![lines(&corners)]
        }
        "rect" => vec![rectangle(
            [x("x")?, y("y")?],
            [x("width")?, y("height")?],
            radii()?,
        )],
        "circle" => {
            let radius = get("r", Along::Diagonal)?.unwrap_or(0.0);
            vec![ellipse([x("cx")?, y("cy")?], [radius; 2])]
        }
        "ellipse" => vec![ellipse([x("cx")?, y("cy")?], radii()?)],
        _ => return Ok(None),
    }))
}

fn points(node: Node<'_, '_>) -> Result<Vec<[f64; 2]>, String> {
    let text = node.attribute("points").unwrap_or_default();
    let numbers: Result<Vec<f64>, _> = NumberListParser::from(text.trim()).collect();
    let numbers = numbers.map_err(|e| format!("`points` is no list of numbers: {e}"))?;
    match numbers.as_chunks::<2>() {
        (points, []) => Ok(points.to_vec()),
        _ => Err(format!(
            "`points` has {} numbers, an odd number",
            numbers.len()
        )),
    }
}

fn lines(corners: &[[f64; 2]]) -> Vec<PlaneCurve> {
    let sides = corners.windows(2).filter(|side| side[0] != side[1]);
    sides
        .map(|side| PlaneCurve::Line([side[0], side[1]]))
        .collect()
}

fn arc(centre: [f64; 2], [rx, ry]: [f64; 2], angles: [f64; 2]) -> PlaneCurve {
    PlaneCurve::Arc(EllipticArc {
        centre,
        axes: [[rx, 0.0], [0.0, ry]],
        angles,
    })
}

fn ellipse(centre: [f64; 2], radii: [f64; 2]) -> Vec<PlaneCurve> {
    match radii.iter().all(|r| *r > 0.0) {
        true => vec![arc(centre, radii, [0.0, TAU])],
        false => Vec::new(),
    }
}

/// A rectangle, whose corners may be round.
fn rectangle([x, y]: [f64; 2], [w, h]: [f64; 2], radii: [f64; 2]) -> Vec<PlaneCurve> {
    if !(w > 0.0 && h > 0.0) {
        return Vec::new();
    }
    let [rx, ry] = [radii[0].clamp(0.0, 0.5 * w), radii[1].clamp(0.0, 0.5 * h)];
    if rx == 0.0 || ry == 0.0 {
        return lines(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]]);
    }
    // Each side, and the corner at its end.
    let (l, r, t, b) = (x + rx, x + w - rx, y + ry, y + h - ry);
    let sides = [
        ([l, y], [r, y], [r, t]),
        ([x + w, t], [x + w, b], [r, b]),
        ([r, y + h], [l, y + h], [l, b]),
        ([x, b], [x, t], [l, t]),
    ];
    let mut curves = Vec::new();
    for ((from, to, centre), k) in sides.into_iter().zip(-1_i32..) {
        curves.extend(lines(&[from, to]));
        let angle = f64::from(k) * FRAC_PI_2;
        curves.push(arc(centre, [rx, ry], [angle, angle + FRAC_PI_2]));
    }
    curves
}
