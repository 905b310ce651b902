//! Fig. 6: the three placement functions.

use super::{Made, caption, style, svg};
use crate::draw::spatial::{arc, axpy, dot, sub, unit};
use crate::draw::{Anchor, Drawing, Stroke, TEXT, Vertical, View, palette, row};
use anyhow::{Result, ensure};
use isosheet_coords::placement::{place_f, place_g, place_h};
use isosheet_coords::{Branch, EdgeFrame, EulerParameters, SphericalFrame};
use serde_json::json;

/// Squared height that counts as zero; nothing here is near it.
const TOLERANCE: f64 = 1e-12;

pub(super) const KNOWN: crate::draw::Colour = palette::BLUE;
pub(super) const PLACED: crate::draw::Colour = palette::VERMILION;

pub(super) fn make() -> Result<Made> {
    let mut panels = vec![rule_h()?, rule_g()?];
    let (f, error) = rule_f()?;
    panels.push(f);
    let names = [
        ["(a) function ~h~", "two coordinates"],
        ["(b) function ~g~", "one coordinate"],
        ["(c) function ~f~", "no coordinate"],
    ];
    let low = panels
        .iter()
        .map(|p| p.bounds().min[1])
        .fold(f64::INFINITY, f64::min)
        - 7.0;
    for (panel, words) in panels.iter_mut().zip(names) {
        let x = panel.bounds().centre()[0];
        caption(panel, [x, low], TEXT, &words.map(str::to_owned));
    }
    let all = row(&panels, 30.0);
    Ok(Made {
        title: "Basic geometric relations",
        paper: "A vertex with one known neighbour takes two spherical coordinates, with two known neighbours one angle, with three \
                none.",
        measured: format!(
            "Known vertices blue, placed vertices red, all placed by the functions h, g and f of the library. (a) the two arcs are \
             the coordinates. (b) five values of the one coordinate. (c) three known vertices of a pair of triangles folded by 55°; \
             the ghost is the mirror image, the other solution. f returns the vertex to {error:.0e} of its first edge length."
        ),
        pictures: svg(
            6,
            &all,
            "The placement functions h, g and f: one, two and three known neighbours",
        )?,
        pages: Vec::new(),
        tables: Vec::new(),
        facts: json!({ "f_error": error }),
    })
}

pub(super) fn known(d: &mut Drawing, p: [f64; 2]) {
    d.disc(p, 2.7, KNOWN, Stroke::new(palette::WHITE, 0.6));
}

pub(super) fn placed(d: &mut Drawing, p: [f64; 2]) {
    d.disc(p, 2.7, PLACED, Stroke::new(palette::WHITE, 0.6));
}

fn rule_h() -> Result<Drawing> {
    let view = View::from(-42.0, 22.0, 100.0);
    let mut d = Drawing::new();
    let v = [0.0; 3];
    let frame = SphericalFrame::along(&[1.0, 0.0, 0.0])?;
    let q = [0.85, 0.6];
    // Drawn with the axes of the frame as those of the picture.
    let at = |q| {
        let p = place_h(&v, 1.0, &frame, q);
        frame.axes().map(|axis| dot(&axis, &p))
    };
    let steps = |n: i32| (0..=n).map(move |k| f64::from(k) / f64::from(n));
    // Grid of the sphere of possible places, a quarter of it.
    for k in 0..=4 {
        let t = f64::from(k) / 4.0;
        let meridian: Vec<[f64; 3]> = steps(24).map(|s| at([1.4 * t, 1.2 * s])).collect();
        let parallel: Vec<[f64; 3]> = steps(24).map(|s| at([1.4 * s, 1.2 * t])).collect();
        d.line(
            &view.project_all(&meridian),
            Stroke::new(palette::PALE, 0.4),
        );
        d.line(
            &view.project_all(&parallel),
            Stroke::new(palette::PALE, 0.4),
        );
    }
    d.line(
        &view.project_all(&[v, at([0.0, 0.0])]),
        style::GHOST.dashed(),
    );
    d.line(
        &view.project_all(&[v, at([q[0], 0.0])]),
        style::GHOST.dashed(),
    );
    let first: Vec<[f64; 3]> = steps(24).map(|s| at([q[0] * s, 0.0])).collect();
    let second: Vec<[f64; 3]> = steps(24).map(|s| at([q[0], q[1] * s])).collect();
    d.arrow(&view.project_all(&first), Stroke::new(PLACED, 0.9));
    d.arrow(
        &view.project_all(&second[..second.len() - 1]),
        Stroke::new(PLACED, 0.9),
    );
    d.line(
        &view.project_all(&[v, at(q)]),
        Stroke::new(palette::INK, 1.2),
    );
    known(&mut d, view.project(&v));
    placed(&mut d, view.project(&at(q)));
    let mark = |d: &mut Drawing, p: [f64; 3], shift: [f64; 2], name: &str| {
        let s = view.project(&p);
        d.text(
            [s[0] + shift[0], s[1] + shift[1]],
            name,
            TEXT,
            Anchor::Middle,
            Vertical::Centre,
            palette::INK,
        );
    };
    mark(&mut d, v, [-8.0, 2.0], "~v~");
    mark(&mut d, first[12], [3.0, -8.0], "~q~_{1}");
    mark(&mut d, second[12], [9.0, -1.0], "~q~_{2}");
    Ok(d)
}

fn rule_g() -> Result<Drawing> {
    let view = View::from(-66.0, 24.0, 100.0);
    let mut d = Drawing::new();
    // The axis runs towards the viewer, so that the turn is counter-clockwise in the picture.
    let (a, b) = ([0.0, 1.0, 0.0], [0.0, 0.0, 0.0]);
    let rest = [0.8, 0.45, 0.0];
    let frame = EdgeFrame::from_triangle([&a, &b, &rest])?;
    let length = |p: &[f64; 3]| {
        let e = sub(&rest, p);
        dot(&e, &e).sqrt()
    };
    let lengths = [length(&a), length(&b)];
    let at = |q: f64| place_g([&a, &b], lengths, &frame, q, TOLERANCE).map(|p| p.position);
    let axis = unit(&sub(&b, &a));
    let zero = at(0.0)?;
    let foot = axpy(&a, dot(&sub(&zero, &a), &axis), &axis);
    let radius = sub(&zero, &foot);
    let turned = sub(&at(std::f64::consts::FRAC_PI_2)?, &foot);
    let circle = arc(&foot, &radius, &turned, 2.3);
    d.line(&view.project_all(&circle), Stroke::new(palette::PALE, 0.5));
    let shown = 1.15;
    for q in [0.0, 0.55, 1.7, 2.3] {
        let p = at(q)?;
        d.line(&view.project_all(&[a, p, b]), style::GHOST);
    }
    let p = at(shown)?;
    let corners = [a, b, p];
    d.polygon(
        &view.project_all(&corners),
        view.shade(palette::SKY.tint(0.55), &corners).alpha(0.9),
    );
    d.outline(&view.project_all(&corners), style::EDGE);
    d.line(&view.project_all(&[a, b]), Stroke::new(palette::INK, 1.5));
    let path = arc(&foot, &radius, &turned, shown);
    d.line(&view.project_all(&[foot, zero]), style::GHOST.dashed());
    d.arrow(
        &view.project_all(&path[..path.len() - 1]),
        Stroke::new(PLACED, 0.9),
    );
    known(&mut d, view.project(&a));
    known(&mut d, view.project(&b));
    placed(&mut d, view.project(&p));
    let middle = view.project(&path[path.len() / 3]);
    d.text(
        [middle[0] + 7.0, middle[1] + 4.0],
        "~q~",
        TEXT,
        Anchor::Middle,
        Vertical::Centre,
        palette::INK,
    );
    Ok(d)
}

fn rule_f() -> Result<(Drawing, f64)> {
    let view = View::from(-104.0, 36.0, 100.0);
    let mut d = Drawing::new();
    // The pair at rest, then the second triangle folded by 55 degrees about the common edge.
    let v = [0.0, 0.0, 0.0];
    let hub = [0.0, 1.0, 0.0];
    let first = [-0.8, 0.45, 0.0];
    let second =
        EulerParameters::about(&[0.0, 1.0, 0.0], -55f64.to_radians()).rotate(&[0.75, 0.6, 0.0]);
    let norm = |p: &[f64; 3]| dot(p, p).sqrt();
    let neighbours = [&first, &hub, &second];
    let lengths = neighbours.map(norm);
    let mut images = Vec::new();
    for branch in [Branch::Above, Branch::Below] {
        images.push(place_f(neighbours, lengths, branch, TOLERANCE)?.position);
    }
    images.sort_by(|p, q| norm(p).total_cmp(&norm(q)));
    let error = norm(&images[0]) / lengths[0];
    ensure!(error < 1e-12, "f does not give the vertex back: {images:?}");
    let mirror = images[1];
    for p in neighbours {
        d.line(&view.project_all(&[mirror, *p]), style::GHOST.dashed());
    }
    for corners in [[v, second, hub], [v, hub, first]] {
        let points = view.project_all(&corners);
        d.polygon(
            &points,
            view.shade(palette::SKY.tint(0.55), &corners).alpha(0.92),
        );
        d.outline(&points, style::EDGE);
    }
    d.line(&view.project_all(&[v, hub]), Stroke::new(palette::INK, 1.5));
    for p in neighbours {
        known(&mut d, view.project(p));
    }
    placed(&mut d, view.project(&v));
    let m = view.project(&mirror);
    d.disc(m, 2.4, palette::WHITE, Stroke::new(palette::GREY, 0.8));
    Ok((d, error))
}
