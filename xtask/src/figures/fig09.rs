//! Fig. 9: the construction of function g.

use super::sketch::{PLACED, Sketch};
use super::{Made, degrees, measured, rows, style, svg};
use crate::draw::spatial::{angle_arc, arc};
use crate::draw::{Stroke, palette};
use anyhow::{Result, ensure};
use isosheet_coords::placement::place_g;
use isosheet_coords::{EdgeFrame, EulerParameters};
use isosheet_mesh::vec3::{axpy, cross, dot, norm, sub, unit};

/// The coordinate that is drawn, radians.
const Q: f64 = 1.0;

pub(super) fn make() -> Result<Made> {
    let add = |a: &[f64; 3], b: &[f64; 3]| axpy(a, 1.0, b);
    let rest: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [0.95, 0.0, 0.0], [0.55, 0.72, 0.0]];
    // The known edge at time t: moved, and turned out of the plane.
    let first = [1.35, 0.35, 0.28];
    let a0 = unit(sub(rest[1], rest[0]));
    let at = unit([0.78, 0.30, 0.58]);
    let second = axpy(first, norm(sub(rest[1], rest[0])), at);
    let apex = sub(rest[2], rest[0]);
    let align = EulerParameters::aligning(&a0, &at, &[0.0, 0.0, 1.0]);
    let aligned = add(&first, &align.rotate(&apex));
    let turn = EulerParameters::about(&at, Q);
    let turned = add(&first, &turn.rotate(&align.rotate(&apex)));
    // The library's g gives the same place.
    let frame = EdgeFrame::from_triangle([&rest[0], &rest[1], &rest[2]])?;
    let lengths = [norm(apex), norm(sub(rest[2], rest[1]))];
    let g = place_g([&first, &second], lengths, &frame, Q, 1e-12)?.position;
    let error = norm(sub(g, turned)) / lengths[0];
    ensure!(error < 1e-12, "g differs from the construction by {error}");
    let theta = norm(cross(a0, at)).atan2(dot(a0, at));

    let mut d = Sketch::seen(-68.0, 27.0, 112.0);
    d.face(rest, style::FACE);
    let moved = rest.map(|p| add(&first, &p));
    let ghost = d.view.project_all(&moved);
    d.drawing.outline(&ghost, style::GHOST.dashed());
    let mut faces = [
        ([first, second, aligned], palette::SKY.tint(0.5)),
        ([first, second, turned], palette::ORANGE.tint(0.5)),
    ];
    faces.sort_by(|(a, _), (b, _)| d.view.nearness(&a[2]).total_cmp(&d.view.nearness(&b[2])));
    for (corners, colour) in faces {
        d.face(corners, colour.alpha(0.66));
    }
    d.line(&[first, second], Stroke::new(palette::INK, 1.5));
    // Axis and angle of the first rotation.
    let axis = axpy(first, 0.55, unit(cross(a0, at)));
    d.arrow(&[first, axis], palette::BLUE);
    let theta_arc = angle_arc(&first, &moved[1], &second, 0.42);
    d.arrow(&theta_arc, palette::BLUE);
    // The second rotation moves the vertex on a circle about the edge.
    let foot = axpy(first, dot(sub(aligned, first), at), at);
    let u = sub(aligned, foot);
    d.line(&[aligned, foot, turned], style::GHOST.dashed());
    let q_arc = arc(&foot, &u, &cross(at, u), Q);
    d.arrow(&q_arc, PLACED);
    d.known(rest.iter().chain([&first, &second]));
    d.placed(&turned);
    for (p, shift, name) in [
        (&rest[0], [-9.0, -7.0], "v₁⁰"),
        (&rest[1], [8.0, -8.0], "v₂⁰"),
        (&rest[2], [0.0, 11.0], "v₃⁰"),
        (&first, [-10.0, -7.0], "v₁ᵗ"),
        (&second, [12.0, 1.0], "v₂ᵗ"),
        (&turned, [-4.0, 11.0], "v₃ᵗ"),
    ] {
        d.label(p, shift, name, palette::INK);
    }
    let middle = |points: &[[f64; 3]]| points[points.len() / 2];
    d.label(&axis, [-6.0, 4.0], "r", palette::BLUE);
    d.label(&middle(&theta_arc), [8.0, -2.0], "θ", palette::BLUE);
    d.label(&middle(&q_arc), [6.0, 6.0], "q", PLACED);
    let alt = "A triangle at rest, aligned with the known edge, and turned about it";
    Ok(Made {
        title: "Construction of function g",
        paper: "The rest triangle is turned by A(θ) so that its edge lies on the known edge at time t, then by A(q) about that edge: \
                the system coordinate q places the third vertex.",
        here: "The rest triangle (left) is aligned with the known edge by θ about r (blue) and turned by q (orange), by the Euler \
               parameters of the paper; the function g of the library has the same lengths and q, but no rotation matrix.",
        tables: vec![measured(rows! {
            "θ" => degrees(theta),
            "q" => degrees(Q),
            "distance of the two places (edge lengths)" => format!("{error:.0e}"),
        })],
        pictures: svg(9, &d.drawing, alt),
        ..Made::default()
    })
}
