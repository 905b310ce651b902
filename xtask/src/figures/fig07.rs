//! Fig. 7: the degenerate case, three known vertices on a line.

use super::fig06::{PLACED, known, placed};
use super::{Made, caption, degrees, style, svg};
use crate::draw::spatial::{arc, axpy, dot, sub, unit};
use crate::draw::{Anchor, Drawing, Stroke, TEXT, Vertical, View, palette, row};
use anyhow::{Result, bail, ensure};
use isosheet_coords::placement::{COLLINEAR, collinearity, place_f, place_on_line};
use isosheet_coords::{Branch, EulerParameters, PlacementError};
use serde_json::json;

const TOLERANCE: f64 = 1e-12;

/// The known vertices: the line of the outer two runs through the middle one.
const LINE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [0.0, 0.62, 0.0], [0.0, 1.3, 0.0]];
const VERTEX: [f64; 3] = [0.75, 0.55, 0.0];

pub(super) fn make() -> Result<Made> {
    let norm = |p: &[f64; 3]| dot(p, p).sqrt();
    let lengths = LINE.map(|k| norm(&sub(&VERTEX, &k)));
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
        axpy(&LINE[1], 0.68, &[0.0, bend.cos(), bend.sin()]),
    ];
    let regular = regular(&bent, lengths)?;
    let mut degenerate = Drawing::new();
    let view = View::from(-38.0, 27.0, 92.0);
    let axis = unit(&sub(&LINE[2], &LINE[0]));
    let foot = axpy(&LINE[0], dot(&sub(&VERTEX, &LINE[0]), &axis), &axis);
    let radius = sub(&VERTEX, &foot);
    let mut worst: f64 = 0.0;
    for turn in [0.0, 0.5, 1.0, 1.5, 2.0] {
        // The place that the function gives when the vertex was near the turned one before.
        let before = axpy(
            &foot,
            1.0,
            &EulerParameters::about(&axis, -turn).rotate(&radius),
        );
        let p = place_on_line(
            [&LINE[0], &LINE[2]],
            [lengths[0], lengths[2]],
            &before,
            TOLERANCE,
        )?
        .position;
        worst = worst.max((norm(&sub(&p, &LINE[1])) - lengths[1]).abs() / lengths[1]);
        if turn == 1.0 {
            for corners in [[LINE[0], LINE[1], p], [LINE[1], LINE[2], p]] {
                let points = view.project_all(&corners);
                degenerate.polygon(
                    &points,
                    view.shade(palette::SKY.tint(0.55), &corners).alpha(0.92),
                );
                degenerate.outline(&points, style::EDGE);
            }
            placed(&mut degenerate, view.project(&p));
        } else {
            degenerate.line(&view.project_all(&[LINE[0], p, LINE[2]]), style::GHOST);
            degenerate.line(&view.project_all(&[LINE[1], p]), style::GHOST);
        }
    }
    ensure!(
        worst < 1e-12,
        "the middle rod changes its length by {worst}"
    );
    let w = EulerParameters::about(&axis, -std::f64::consts::FRAC_PI_2).rotate(&radius);
    let circle = arc(&foot, &radius, &w, 2.0);
    degenerate.arrow(&view.project_all(&circle), Stroke::new(PLACED, 0.9));
    let (q, o) = (
        view.project(&circle[3 * circle.len() / 4]),
        view.project(&foot),
    );
    let out = (q[0] - o[0]).hypot(q[1] - o[1]) / 9.0;
    degenerate.text(
        [q[0] + (q[0] - o[0]) / out, q[1] + (q[1] - o[1]) / out],
        "~q~",
        TEXT,
        Anchor::Middle,
        Vertical::Centre,
        palette::INK,
    );
    for p in LINE {
        known(&mut degenerate, view.project(&p));
    }
    let mut panels = [regular, degenerate];
    let low = panels
        .iter()
        .map(|p| p.bounds().min[1])
        .fold(f64::INFINITY, f64::min)
        - 7.0;
    let words = [
        vec![
            format!("γ = {}", degrees(std::f64::consts::PI - bend)),
            "two mirror images".to_owned(),
        ],
        vec!["γ = π".to_owned(), "one coordinate left".to_owned()],
    ];
    for (panel, words) in panels.iter_mut().zip(words) {
        let x = panel.bounds().centre()[0];
        caption(panel, [x, low], TEXT, &words);
    }
    let all = row(&panels, 50.0);
    Ok(Made {
        title: "The degenerate case of function f",
        paper: "When the three known vertices lie on a line (γ = π), the vertex can still turn about that line: one coordinate has \
                to be assigned.",
        measured: format!(
            "Left, the line bent by {}: function f has two solutions. Right, straight: f refuses (sine of the smallest angle \
             {sine}, limit {COLLINEAR:.0e}) and the vertex keeps the angle it had before; for the five angles drawn the middle rod, \
             which is not used, keeps its length to {worst:.0e}.",
            degrees(bend)
        ),
        pictures: svg(
            7,
            &all,
            "Three known vertices on a bent and on a straight line and the places of a fourth vertex",
        )?,
        pages: Vec::new(),
        tables: Vec::new(),
        facts: json!({ "sine": sine, "limit": COLLINEAR, "middle_rod_error": worst }),
    })
}

/// The same vertices with a bent line: both solutions of rule f.
fn regular(bent: &[[f64; 3]; 3], lengths: [f64; 3]) -> Result<Drawing> {
    let view = View::from(-38.0, 27.0, 92.0);
    let mut d = Drawing::new();
    let mut images = Vec::new();
    for branch in [Branch::Below, Branch::Above] {
        images.push(place_f([&bent[0], &bent[1], &bent[2]], lengths, branch, TOLERANCE)?.position);
    }
    images.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [ghost, shown] = [images[0], images[1]];
    for p in bent {
        d.line(&view.project_all(&[ghost, *p]), style::GHOST.dashed());
    }
    for corners in [[bent[0], bent[1], shown], [bent[1], bent[2], shown]] {
        let points = view.project_all(&corners);
        d.polygon(
            &points,
            view.shade(palette::SKY.tint(0.55), &corners).alpha(0.92),
        );
        d.outline(&points, style::EDGE);
    }
    for p in bent {
        known(&mut d, view.project(p));
    }
    placed(&mut d, view.project(&shown));
    d.disc(
        view.project(&ghost),
        2.4,
        palette::WHITE,
        Stroke::new(palette::GREY, 0.8),
    );
    Ok(d)
}
