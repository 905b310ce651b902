//! Fig. 7: the degenerate case, three known vertices on a line.

use super::sketch::{PLACED, Sketch, captioned};
use super::{Made, degrees, measured, rows, style, svg};
use crate::draw::spatial::{angle_arc, arc};
use crate::draw::{Drawing, Stroke, palette};
use anyhow::{Result, bail, ensure};
use isosheet_coords::placement::{COLLINEAR, collinearity, place_f, place_on_line};
use isosheet_coords::{Branch, EulerParameters, PlacementError};
use isosheet_mesh::vec3::{axpy, dot, norm, sub, unit};
use std::f64::consts::PI;

const TOLERANCE: f64 = 1e-12;

/// The known vertices: the line of the outer two runs through the middle one.
const LINE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [0.0, 0.62, 0.0], [0.0, 1.3, 0.0]];
const VERTEX: [f64; 3] = [0.75, 0.55, 0.0];

pub(super) fn make() -> Result<Made> {
    let lengths = LINE.map(|k| norm(sub(VERTEX, k)));
    let near = [&LINE[0], &LINE[1], &LINE[2]];
    let sine = collinearity(near);
    match place_f(near, lengths, Branch::Above, TOLERANCE) {
        Err(PlacementError::Collinear { .. }) => {}
        other => bail!("three vertices on a line were not recognised: {other:?}"),
    }
    // What rule f does as the line bends: the two mirror images part.
    let bend: f64 = 0.45;
    let bent = [
        LINE[0],
        LINE[1],
        axpy(LINE[1], 0.68, [0.0, bend.cos(), bend.sin()]),
    ];
    let regular = regular(&bent, lengths)?;
    let (degenerate, worst) = degenerate(lengths)?;
    ensure!(
        worst < 1e-12,
        "the middle rod changes its length by {worst}"
    );
    let angle = degrees(PI - bend);
    let words = [
        [format!("γ = {angle}"), "two mirror images".to_owned()],
        ["γ = π", "one coordinate left"].map(str::to_owned),
    ];
    let words = words.map(|lines| lines.to_vec());
    let all = captioned(vec![regular, degenerate], &words, 50.0);
    let alt =
        "Three known vertices on a bent and on a straight line and the places of a fourth vertex";
    Ok(Made {
        title: "The degenerate case of function f",
        paper: "When the three known vertices lie on a line (γ = π), the vertex can still turn about that line: one coordinate has \
                to be assigned.",
        here: "On the bent line (left) the function f has two solutions; on the straight line (right) it refuses, and the vertex \
               keeps the angle that it had before.",
        tables: vec![measured(rows! {
            "γ on the left" => degrees(PI - bend),
            "sine of the smallest angle on the right" => sine.to_string(),
            "limit below which f refuses" => format!("{COLLINEAR:.0e}"),
            "change of the length of the middle rod, which is not used" => format!("{worst:.0e}"),
        })],
        pictures: svg(7, &all, alt),
        ..Made::default()
    })
}

/// Radius of the arc of the angle of the line.
const GAMMA: f64 = 0.2;

/// Draws the arc of the angle of the line at its middle vertex, and its name.
fn gamma(d: &mut Sketch, points: &[[f64; 3]]) {
    d.line(points, Stroke::new(palette::GREEN, 1.2));
    d.label(&points[points.len() / 4], [-7.0, 4.0], "γ", palette::GREEN);
}

/// How both panels are seen.
fn sketch() -> Sketch {
    Sketch::seen(-38.0, 27.0, 92.0)
}

/// The places of the vertex beside the straight line, and the largest relative error of the middle rod, which
/// is not used to find them.
fn degenerate(lengths: [f64; 3]) -> Result<(Drawing, f64)> {
    let mut d = sketch();
    let axis = unit(sub(LINE[2], LINE[0]));
    let foot = axpy(LINE[0], dot(sub(VERTEX, LINE[0]), axis), axis);
    let radius = sub(VERTEX, foot);
    let turned = |angle: f64| EulerParameters::about(&axis, -angle).rotate(&radius);
    let (known, outer) = ([&LINE[0], &LINE[2]], [lengths[0], lengths[2]]);
    let mut worst: f64 = 0.0;
    for turn in [0.0, 0.5, 1.0, 1.5, 2.0] {
        // The place that the function gives when the vertex was near the turned one before.
        let before = axpy(foot, 1.0, turned(turn));
        let p = place_on_line(known, outer, &before, TOLERANCE)?.position;
        worst = worst.max((norm(sub(p, LINE[1])) - lengths[1]).abs() / lengths[1]);
        if turn == 1.0 {
            d.blue_face([LINE[0], LINE[1], p], 0.92);
            d.blue_face([LINE[1], LINE[2], p], 0.92);
            d.placed(&p);
        } else {
            d.line(&[LINE[0], p, LINE[2]], style::GHOST);
            d.line(&[LINE[1], p], style::GHOST);
        }
    }
    let quarter = turned(std::f64::consts::FRAC_PI_2);
    let circle = arc(&foot, &radius, &quarter, 2.0);
    d.arrow(&circle, PLACED);
    // The name stands outside of the arc.
    let named = &circle[3 * circle.len() / 4];
    let (q, o) = (d.view.project(named), d.view.project(&foot));
    let out = (q[0] - o[0]).hypot(q[1] - o[1]) / 9.0;
    let shift = [(q[0] - o[0]) / out, (q[1] - o[1]) / out];
    d.label(named, shift, "q", palette::INK);
    // Half a turn, over the side on which the bent line has it.
    let (back, up) = ([0.0, -GAMMA, 0.0], [0.0, 0.0, GAMMA]);
    gamma(&mut d, &arc(&LINE[1], &back, &up, PI));
    d.known(&LINE);
    Ok((d.drawing, worst))
}

/// The places of the vertex beside a bent line, by both solutions of rule f.
fn regular(bent: &[[f64; 3]; 3], lengths: [f64; 3]) -> Result<Drawing> {
    let mut d = sketch();
    let mut images = Vec::new();
    for branch in [Branch::Below, Branch::Above] {
        images.push(place_f(bent.each_ref(), lengths, branch, TOLERANCE)?.position);
    }
    images.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [ghost, shown] = [images[0], images[1]];
    for p in bent {
        d.line(&[ghost, *p], style::GHOST.dashed());
    }
    d.blue_face([bent[0], bent[1], shown], 0.92);
    d.blue_face([bent[1], bent[2], shown], 0.92);
    gamma(&mut d, &angle_arc(&bent[1], &bent[0], &bent[2], GAMMA));
    d.known(bent);
    d.placed(&shown);
    d.mirrored(&ghost);
    Ok(d.drawing)
}
