//! Fig. 5: angle triples of a folded pair of triangles, and the compatibility condition.

use super::{Made, Table, caption, degrees, style, svg};
use crate::draw::spatial::angle_arc;
use crate::draw::{Anchor, Colour, Drawing, Stroke, TEXT, Vertical, View, palette, row};
use anyhow::{Context, Result, ensure};
use isosheet_coords::EulerParameters;
use isosheet_mesh::{EdgeAngles, Sheet, VertexId, fold_angle};
use serde_json::json;

/// Fold of the pair at time t: 70 degrees.
const FOLD: f64 = 70.0 * std::f64::consts::PI / 180.0;

const ALPHA: Colour = palette::BLUE;
const BETA: Colour = palette::GREEN;
const GAMMA: Colour = palette::VERMILION;

pub(super) fn make() -> Result<Made> {
    let view = View::from(-13.0, 56.0, 150.0);
    let rest = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.30, 0.80, 0.0],
        [0.62, -0.72, 0.0],
    ];
    let sheet = Sheet::new(rest.concat(), &[[0, 1, 2], [0, 3, 1]])?;
    let edge = sheet
        .topology()
        .find_edge(VertexId(0), VertexId(1))
        .context("the pair has a common edge")?;
    let mut folded = rest;
    // Half of the fold on either side, so that neither face hides the other.
    folded[2] = EulerParameters::about(&[1.0, 0.0, 0.0], 0.5 * FOLD).rotate(&rest[2]);
    folded[3] = EulerParameters::about(&[1.0, 0.0, 0.0], -0.5 * FOLD).rotate(&rest[3]);
    let mut panels = Vec::new();
    let mut triples = Vec::new();
    for (x, time) in [(&rest, "0"), (&folded, "~t~")] {
        let angles =
            EdgeAngles::at(&sheet, &x.concat(), edge).context("the common edge is interior")?;
        let ends = angles.ends;
        ensure!(
            ends.iter().all(|e| e.margin() > -1e-12),
            "Eq. 10 is violated by a fold: {ends:?}"
        );
        panels.push(panel(&view, x, time));
        triples.push(ends);
    }
    let fold = fold_angle(sheet.topology(), &folded.concat(), edge)
        .context("the common edge is interior")?;
    let low = panels
        .iter()
        .map(|p| p.bounds().min[1])
        .fold(f64::INFINITY, f64::min)
        - 8.0;
    for (panel, name) in panels
        .iter_mut()
        .zip(["at rest", "at time ~t~, folded by "])
    {
        let text = if name.ends_with(' ') {
            format!("{name}{}", degrees(fold.abs()))
        } else {
            name.to_owned()
        };
        let x = panel.bounds().centre()[0];
        caption(panel, [x, low], TEXT, &[text]);
    }
    let all = row(&panels, 44.0);
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
                if t.gamma <= t.alpha + t.beta {
                    "holds"
                } else {
                    "violated"
                }
                .to_owned(),
            ]
        })
        .collect::<Vec<_>>();
    let head = [
        "end of the edge",
        "α",
        "β",
        "α + β",
        "γ⁰",
        "γᵗ",
        "γᵗ ≤ α + β",
    ];
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
        pictures: svg(
            5,
            &all,
            "A pair of triangles at rest and folded, with the angles alpha, beta and gamma at both ends",
        )?,
        pages: Vec::new(),
        tables: vec![Table::new("Measured angles of the folded pair", &head).with_texts(rows)],
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
    d.line(&view.project_all(&[a, b]), Stroke::new(palette::INK, 1.5));
    let prime = [String::new(), "′".to_owned()];
    for (k, (apex, other)) in [(a, b), (b, a)].into_iter().enumerate() {
        let prime = &prime[k];
        // Where along the arc the name stands, how far outside of it and how much higher, points. At the far
        // end of the folded pair gamma's arc runs over the others, whose names stand outside then.
        let crowded = k == 0 && time != "0";
        let inside = if crowded { 8.0 } else { -11.0 };
        let gamma =
            [[0.3, 12.0, 0.0], [0.12, 12.0, 0.0], [0.0, 4.0, 8.0]][if crowded { 2 } else { 1 - k }];
        let marks = [
            (
                other,
                left,
                0.21,
                ALPHA,
                format!("α{prime}"),
                [0.5, inside, 0.0],
            ),
            (
                other,
                right,
                0.21,
                BETA,
                format!("β{prime}"),
                [0.5, inside, 0.0],
            ),
            (
                left,
                right,
                0.29,
                GAMMA,
                format!("γ{prime}^{{{time}}}"),
                gamma,
            ),
        ];
        for (from, to, radius, colour, name, [part, distance, lift]) in marks {
            let arc = angle_arc(&apex, &from, &to, radius);
            d.line(&view.project_all(&arc), Stroke::new(colour, 1.0));
            let middle = arc[(part * arc.len() as f64) as usize];
            let (p, o) = (view.project(&middle), view.project(&apex));
            let l = (p[0] - o[0]).hypot(p[1] - o[1]);
            let mut at = [0, 1].map(|i| p[i] + (p[i] - o[i]) * distance / l);
            at[1] += lift;
            d.text(at, &name, TEXT, Anchor::Middle, Vertical::Centre, colour);
        }
    }
    let middle = view.project(&[0, 1, 2].map(|i| 0.64 * a[i] + 0.36 * b[i]));
    d.text(
        [middle[0] - 7.0, middle[1]],
        "~e~",
        TEXT,
        Anchor::Middle,
        Vertical::Centre,
        palette::INK,
    );
    d
}
