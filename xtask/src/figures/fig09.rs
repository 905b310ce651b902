//! Fig. 9: the construction of function g.

use super::fig06::{PLACED, known, placed};
use super::{Made, style, svg};
use crate::draw::spatial::{angle_arc, arc, axpy, cross, dot, sub, unit};
use crate::draw::{Anchor, Colour, Drawing, Stroke, TEXT, Vertical, View, palette};
use anyhow::{Result, ensure};
use isosheet_coords::placement::place_g;
use isosheet_coords::{EdgeFrame, EulerParameters};
use serde_json::json;

/// The coordinate that is drawn, radians.
const Q: f64 = 1.0;

pub(super) fn make() -> Result<Made> {
    let norm = |p: &[f64; 3]| dot(p, p).sqrt();
    let add = |a: &[f64; 3], b: &[f64; 3]| axpy(a, 1.0, b);
    let rest: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [0.95, 0.0, 0.0], [0.55, 0.72, 0.0]];
    // The known edge at time t: moved, and turned out of the plane.
    let first = [1.35, 0.35, 0.28];
    let a0 = unit(&sub(&rest[1], &rest[0]));
    let at = unit(&[0.78, 0.30, 0.58]);
    let second = axpy(&first, norm(&sub(&rest[1], &rest[0])), &at);
    let apex = sub(&rest[2], &rest[0]);
    let align = EulerParameters::aligning(&a0, &at, &[0.0, 0.0, 1.0]);
    let aligned = add(&first, &align.rotate(&apex));
    let turn = EulerParameters::about(&at, Q);
    let turned = add(&first, &turn.rotate(&align.rotate(&apex)));
    // The library's g gives the same place.
    let frame = EdgeFrame::from_triangle([&rest[0], &rest[1], &rest[2]])?;
    let lengths = [norm(&apex), norm(&sub(&rest[2], &rest[1]))];
    let g = place_g([&first, &second], lengths, &frame, Q, 1e-12)?.position;
    let error = norm(&sub(&g, &turned)) / lengths[0];
    ensure!(error < 1e-12, "g differs from the construction by {error}");
    let theta = norm(&cross(&a0, &at)).atan2(dot(&a0, &at));

    let view = View::from(-68.0, 27.0, 112.0);
    let mut d = Drawing::new();
    let face = |d: &mut Drawing, corners: [[f64; 3]; 3], colour: Colour, alpha: f64| {
        let points = view.project_all(&corners);
        d.polygon(&points, view.shade(colour, &corners).alpha(alpha));
        d.outline(&points, style::EDGE);
    };
    face(&mut d, rest, style::FACE, 1.0);
    let moved = rest.map(|p| add(&first, &p));
    let ghost = view.project_all(&moved);
    d.outline(&ghost, style::GHOST.dashed());
    let mut faces = [
        ([first, second, aligned], palette::SKY.tint(0.5)),
        ([first, second, turned], palette::ORANGE.tint(0.5)),
    ];
    faces.sort_by(|(a, _), (b, _)| view.nearness(&a[2]).total_cmp(&view.nearness(&b[2])));
    for (corners, colour) in faces {
        face(&mut d, corners, colour, 0.66);
    }
    d.line(
        &view.project_all(&[first, second]),
        Stroke::new(palette::INK, 1.5),
    );
    // Axis and angle of the first rotation.
    let r = unit(&cross(&a0, &at));
    d.arrow(
        &view.project_all(&[first, axpy(&first, 0.55, &r)]),
        Stroke::new(palette::BLUE, 0.9),
    );
    let theta_arc = angle_arc(&first, &moved[1], &second, 0.42);
    d.arrow(
        &view.project_all(&theta_arc),
        Stroke::new(palette::BLUE, 0.9),
    );
    // The second rotation moves the vertex on a circle about the edge.
    let foot = axpy(&first, dot(&sub(&aligned, &first), &at), &at);
    let u = sub(&aligned, &foot);
    let w = cross(&at, &u);
    d.line(
        &view.project_all(&[aligned, foot, turned]),
        style::GHOST.dashed(),
    );
    let q_arc = arc(&foot, &u, &w, Q);
    d.arrow(&view.project_all(&q_arc), Stroke::new(PLACED, 0.9));
    for p in [rest[0], rest[1], rest[2], first, second] {
        known(&mut d, view.project(&p));
    }
    placed(&mut d, view.project(&turned));
    let mark = |d: &mut Drawing, p: &[f64; 3], shift: [f64; 2], name: &str, colour: Colour| {
        let s = view.project(p);
        d.text(
            [s[0] + shift[0], s[1] + shift[1]],
            name,
            TEXT,
            Anchor::Middle,
            Vertical::Centre,
            colour,
        );
    };
    let ink = palette::INK;
    mark(&mut d, &rest[0], [-9.0, -7.0], "~v~_{I}^{0}", ink);
    mark(&mut d, &rest[1], [8.0, -8.0], "~v~_{II}^{0}", ink);
    mark(&mut d, &rest[2], [0.0, 11.0], "~v~_{III}^{0}", ink);
    mark(&mut d, &first, [-10.0, -7.0], "~v~_{I}^{~t~}", ink);
    mark(&mut d, &second, [12.0, 1.0], "~v~_{II}^{~t~}", ink);
    mark(&mut d, &turned, [-4.0, 11.0], "~v~_{III}^{~t~}", ink);
    mark(
        &mut d,
        &axpy(&first, 0.55, &r),
        [-6.0, 4.0],
        "~r~",
        palette::BLUE,
    );
    mark(
        &mut d,
        &theta_arc[theta_arc.len() / 2],
        [8.0, -2.0],
        "θ",
        palette::BLUE,
    );
    mark(&mut d, &q_arc[q_arc.len() / 2], [6.0, 6.0], "~q~", PLACED);
    Ok(Made {
        title: "Construction of function g",
        paper: "The rest triangle is turned by A(θ) so that its edge lies on the known edge at time t, then by A(q) about that edge: \
                the system coordinate q places the third vertex.",
        measured: format!(
            "The rest triangle (left), aligned with the known edge by θ = {:.1}° about r (blue), and turned by q = {:.1}° (orange), by the \
             Euler parameters of the paper. The library's g, which takes the same lengths and q but no rotation matrix, \
             gives the same place to {error:.0e} of the edge length.",
            theta.to_degrees(),
            Q.to_degrees()
        ),
        pictures: svg(
            9,
            &d,
            "A triangle at rest, aligned with the known edge, and turned about it",
        )?,
        pages: Vec::new(),
        tables: Vec::new(),
        facts: json!({ "theta": theta, "q": Q, "difference": error }),
    })
}
