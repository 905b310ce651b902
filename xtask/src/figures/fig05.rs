//! Fig. 5: angle triples of a folded pair of triangles, and the compatibility condition.

use super::{Made, Table, caption, degrees, style, svg};
use crate::draw::spatial::angle_arc;
use crate::draw::{Align, Anchor, Colour, Drawing, Stroke, TEXT, Vertical, View, palette, row};
use anyhow::{Context, Result, ensure};
use isosheet_coords::EulerParameters;
use isosheet_mesh::{EdgeAngles, Sheet, VertexId, fold_angle};
use serde_json::json;

/// Fold of the pair at time t: 75 degrees.
const FOLD: f64 = 75.0 * std::f64::consts::PI / 180.0;

const ALPHA: Colour = palette::BLUE;
const BETA: Colour = palette::GREEN;
const GAMMA: Colour = palette::VERMILION;

pub(super) fn make() -> Result<Made> {
    let view = View::from(-60.0, 33.0, 128.0);
    let rest = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.30, 0.80, 0.0], [0.62, -0.72, 0.0]];
    let sheet = Sheet::new(rest.concat(), &[[0, 1, 2], [0, 3, 1]])?;
    let edge = sheet.topology().find_edge(VertexId(0), VertexId(1)).context("the pair has a common edge")?;
    let mut folded = rest;
    folded[2] = EulerParameters::about(&[1.0, 0.0, 0.0], FOLD).rotate(&rest[2]);
    let mut panels = Vec::new();
    let mut triples = Vec::new();
    for (x, time) in [(&rest, "0"), (&folded, "t")] {
        let angles = EdgeAngles::at(&sheet, &x.concat(), edge).context("the common edge is interior")?;
        let ends = angles.ends;
        ensure!(ends.iter().all(|e| e.margin() > -1e-12), "Eq. 10 is violated by a fold: {ends:?}");
        panels.push(panel(&view, x, time));
        triples.push(ends);
    }
    let fold = fold_angle(sheet.topology(), &folded.concat(), edge).context("the common edge is interior")?;
    let low = panels.iter().map(|p| p.bounds().min[1]).fold(f64::INFINITY, f64::min) - 8.0;
    for (panel, name) in panels.iter_mut().zip(["at rest", "at time ~t~, folded by "]) {
        let text = if name.ends_with(' ') { format!("{name}{}", degrees(fold.abs())) } else { name.to_owned() };
        let x = panel.bounds().centre()[0];
        caption(panel, [x, low], TEXT, &[text]);
    }
    let all = row(&panels, 44.0, Align::Origin);
    let rows = (0..2)
        .map(|k| {
            let (r, t) = (triples[0][k], triples[1][k]);
            vec![
                ["first (α, β, γ)", "second (α′, β′, γ′)"][k].to_owned(),
                degrees(t.alpha),
                degrees(t.beta),
                degrees(t.alpha + t.beta),
                degrees(r.gamma),
                degrees(t.gamma),
                if t.gamma <= t.alpha + t.beta { "holds" } else { "violated" }.to_owned(),
            ]
        })
        .collect();
    let head = ["end of the edge", "α", "β", "α + β", "γ⁰", "γᵗ", "γᵗ ≤ α + β"].map(str::to_owned).to_vec();
    let [one, two] = triples[1];
    Ok(Made {
        title: "Angle triples and the compatibility condition",
        paper: "Two triangles that share an edge can only fold about it, so γᵗ ≤ α + β = γ⁰ at either end (Eq. 10), and one end's \
                condition implies the other's.",
        measured: format!(
            "Angles measured on a pair folded by {}: γᵗ = {} at one end and {} at the other. The fold angle follows from either triple \
             alone: {} and {}.",
            degrees(fold.abs()),
            degrees(one.gamma),
            degrees(two.gamma),
            degrees(one.fold()),
            degrees(two.fold()),
        ),
        pictures: svg(5, &all, "A pair of triangles at rest and folded, with the angles alpha, beta and gamma at both ends")?,
        tables: vec![Table { caption: "Measured angles of the folded pair".into(), head, rows }],
        facts: json!({
            "fold_degrees": fold.to_degrees(),
            "ends": triples[1].map(|t| json!({
                "alpha": t.alpha, "beta": t.beta, "gamma": t.gamma, "flat": t.flat(), "fold": t.fold(),
            })),
        }),
    })
}

fn panel(view: &View, x: &[[f64; 3]; 4], time: &str) -> Drawing {
    let mut d = Drawing::new();
    let [a, b, left, right] = *x;
    for corners in [[a, b, left], [a, right, b]] {
        let points = view.project_all(&corners);
        d.polygon(&points, view.shade(style::FACE, &corners));
        d.outline(&points, style::EDGE);
    }
    d.line(&view.project_all(&[left, right]), Stroke::new(GAMMA, 0.6).dashed());
    d.line(&view.project_all(&[a, b]), Stroke::new(palette::INK, 1.5));
    let prime = [String::new(), "′".to_owned()];
    for (k, (apex, other)) in [(a, b), (b, a)].into_iter().enumerate() {
        let p = &prime[k];
        let marks = [
            (other, left, 0.20, ALPHA, format!("α{p}")),
            (other, right, 0.16, BETA, format!("β{p}")),
            (left, right, 0.30, GAMMA, format!("γ{p}^{{{time}}}")),
        ];
        for (from, to, radius, colour, name) in marks {
            let arc = angle_arc(&apex, &from, &to, radius);
            d.line(&view.project_all(&arc), Stroke::new(colour, 1.0));
            let middle = arc[arc.len() / 2];
            let at = [0, 1, 2].map(|i| apex[i] + (middle[i] - apex[i]) * (1.0 + 0.085 / radius));
            d.text(view.project(&at), &name, TEXT, Anchor::Middle, Vertical::Centre, colour);
        }
    }
    let names = [("~e~", [0, 1, 2].map(|i| 0.5 * (a[i] + b[i])))];
    for (name, p) in names {
        let at = view.project(&p);
        d.text([at[0] + 1.0, at[1] - 3.0], name, TEXT, Anchor::Middle, Vertical::Below, palette::INK);
    }
    d
}
