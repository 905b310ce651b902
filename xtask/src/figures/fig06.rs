//! Fig. 6: the three placement functions.

use super::sketch::{PLACED, Sketch, captioned};
use super::{Made, measured, rows, style, svg};
use crate::draw::spatial::arc;
use crate::draw::{Drawing, Stroke, palette};
use anyhow::{Result, ensure};
use isosheet_coords::placement::{place_f, place_g, place_h};
use isosheet_coords::{Branch, EdgeFrame, EulerParameters, SphericalFrame};
use isosheet_mesh::vec3::{axpy, dot, norm, sub, unit};

/// Squared height that counts as zero; nothing here is near it.
const TOLERANCE: f64 = 1e-12;

pub(super) fn make() -> Result<Made> {
    let (f, error) = rule_f()?;
    let names = [
        ["(a) function h", "two coordinates"],
        ["(b) function g", "one coordinate"],
        ["(c) function f", "no coordinate"],
    ];
    let names = names.map(|lines| lines.map(str::to_owned).to_vec());
    let all = captioned(vec![rule_h()?, rule_g()?, f], &names, 30.0);
    let alt = "The placement functions h, g and f: one, two and three known neighbours";
    Ok(Made {
        title: "Basic geometric relations",
        paper: "A vertex with one known neighbour takes two spherical coordinates, with two known neighbours one angle, with three \
                none.",
        here: "Known vertices are blue, and placed vertices red: the arcs of (a) are the two coordinates, (b) has five values of \
               the one coordinate, and the ghost of (c) is the other solution, the mirror image.",
        tables: vec![measured(rows! {
            "f returns the vertex to its first place, to (edge lengths)" => format!("{error:.0e}"),
        })],
        pictures: svg(6, &all, alt),
        ..Made::default()
    })
}

fn rule_h() -> Result<Drawing> {
    let mut d = Sketch::seen(-42.0, 22.0, 100.0);
    let v = [0.0; 3];
    let frame = SphericalFrame::along(&[1.0, 0.0, 0.0])?;
    let q = [0.85, 0.6];
    // Drawn with the axes of the frame as axes of the picture.
    let at = |q| {
        let p = place_h(&v, 1.0, &frame, q);
        frame.axes().map(|axis| dot(axis, p))
    };
    let curve = |f: &dyn Fn(f64) -> [f64; 2]| -> Vec<[f64; 3]> {
        let steps = (0..=24).map(|k| f64::from(k) / 24.0);
        steps.map(|s| at(f(s))).collect()
    };
    // Grid of the sphere of possible places, a quarter of it.
    for k in 0..=4 {
        let t = f64::from(k) / 4.0;
        let grid = Stroke::new(palette::PALE, 0.4);
        d.line(&curve(&|s| [1.4 * t, 1.2 * s]), grid);
        d.line(&curve(&|s| [1.4 * s, 1.2 * t]), grid);
    }
    d.line(&[v, at([0.0, 0.0])], style::GHOST.dashed());
    d.line(&[v, at([q[0], 0.0])], style::GHOST.dashed());
    let first = curve(&|s| [q[0] * s, 0.0]);
    let second = curve(&|s| [q[0], q[1] * s]);
    d.arrow(&first, PLACED);
    d.arrow(&second[..second.len() - 1], PLACED);
    d.line(&[v, at(q)], Stroke::new(palette::INK, 1.2));
    d.known([&v]);
    d.placed(&at(q));
    d.label(&v, [-8.0, 2.0], "v", palette::INK);
    d.label(&first[12], [3.0, -8.0], "q₁", palette::INK);
    d.label(&second[12], [9.0, -1.0], "q₂", palette::INK);
    Ok(d.drawing)
}

fn rule_g() -> Result<Drawing> {
    let mut d = Sketch::seen(-66.0, 24.0, 100.0);
    // The axis runs towards the viewer, so that the turn is counter-clockwise in the picture.
    let (a, b) = ([0.0, 1.0, 0.0], [0.0, 0.0, 0.0]);
    let rest = [0.8, 0.45, 0.0];
    let frame = EdgeFrame::from_triangle([&a, &b, &rest])?;
    let lengths = [&a, &b].map(|p| norm(sub(rest, p)));
    let at = |q: f64| place_g([&a, &b], lengths, &frame, q, TOLERANCE).map(|p| p.position);
    let axis = unit(sub(b, a));
    let zero = at(0.0)?;
    let foot = axpy(a, dot(sub(zero, a), axis), axis);
    let radius = sub(zero, foot);
    let turned = sub(at(std::f64::consts::FRAC_PI_2)?, foot);
    let circle = arc(&foot, &radius, &turned, 2.3);
    d.line(&circle, Stroke::new(palette::PALE, 0.5));
    let shown = 1.15;
    for q in [0.0, 0.55, 1.7, 2.3] {
        d.line(&[a, at(q)?, b], style::GHOST);
    }
    let p = at(shown)?;
    d.blue_face([a, b, p], 0.9);
    d.line(&[a, b], Stroke::new(palette::INK, 1.5));
    let path = arc(&foot, &radius, &turned, shown);
    d.line(&[foot, zero], style::GHOST.dashed());
    d.arrow(&path[..path.len() - 1], PLACED);
    d.known([&a, &b]);
    d.placed(&p);
    d.label(&path[path.len() / 3], [7.0, 4.0], "q", palette::INK);
    Ok(d.drawing)
}

fn rule_f() -> Result<(Drawing, f64)> {
    let mut d = Sketch::seen(-104.0, 36.0, 100.0);
    // The pair at rest, then the second triangle folded by 55 degrees about the common edge.
    let (v, hub, first) = ([0.0; 3], [0.0, 1.0, 0.0], [-0.8, 0.45, 0.0]);
    let fold = EulerParameters::about(&[0.0, 1.0, 0.0], -55f64.to_radians());
    let second = fold.rotate(&[0.75, 0.6, 0.0]);
    let neighbours = [&first, &hub, &second];
    let lengths = neighbours.map(norm);
    let mut images = Vec::new();
    for branch in [Branch::Above, Branch::Below] {
        images.push(place_f(neighbours, lengths, branch, TOLERANCE)?.position);
    }
    images.sort_by(|p, q| norm(p).total_cmp(&norm(q)));
    let error = norm(images[0]) / lengths[0];
    ensure!(error < 1e-12, "f does not give the vertex back: {images:?}");
    for p in neighbours {
        d.line(&[images[1], *p], style::GHOST.dashed());
    }
    d.blue_face([v, second, hub], 0.92);
    d.blue_face([v, hub, first], 0.92);
    d.line(&[v, hub], Stroke::new(palette::INK, 1.5));
    d.known(neighbours);
    d.placed(&v);
    d.mirrored(&images[1]);
    Ok((d.drawing, error))
}
