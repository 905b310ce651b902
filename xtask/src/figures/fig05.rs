//! Fig. 5: angle triples of a folded pair of triangles, and the compatibility condition.

use super::sketch::{Sketch, captioned};
use super::{Made, Table, degrees, style, svg};
use crate::draw::spatial::angle_arc;
use crate::draw::{Colour, Drawing, Stroke, palette};
use crate::report::columns;
use anyhow::{Context, Result, ensure};
use isosheet_coords::EulerParameters;
use isosheet_mesh::{EdgeAngles, Sheet, VertexId, fold_angle};

/// Fold of the pair at time t: 70 degrees.
const FOLD: f64 = 70.0 * std::f64::consts::PI / 180.0;

const ALPHA: Colour = palette::BLUE;
const BETA: Colour = palette::GREEN;
const GAMMA: Colour = palette::VERMILION;

pub(super) fn make() -> Result<Made> {
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
    for (x, time) in [(&rest, "⁰"), (&folded, "ᵗ")] {
        let angles =
            EdgeAngles::at(&sheet, &x.concat(), edge).context("the common edge is interior")?;
        let ends = angles.ends;
        ensure!(
            ends.iter().all(|e| e.margin() > -1e-12),
            "Eq. 10 is violated by a fold: {ends:?}"
        );
        panels.push(panel(x, time));
        triples.push(ends);
    }
    let fold = fold_angle(sheet.topology(), &folded.concat(), edge)
        .context("the common edge is interior")?;
    ensure!(
        triples[1]
            .iter()
            .all(|end| (end.fold() - fold.abs()).abs() < 1e-12),
        "the angles of an end give another fold: {:?}",
        triples[1]
    );
    let folded_by = format!("at time t, folded by {}", degrees(fold.abs()));
    let names = [vec!["at rest".into()], vec![folded_by]];
    let all = captioned(panels, &names, 44.0);
    let ends = ["first (α, β, γ)", "second (α′, β′, γ′)"];
    let rows = (0..2).map(|k| (ends[k], triples[0][k].gamma, triples[1][k]));
    let table = Table::of(
        "Measured angles of the folded pair",
        rows,
        columns! { r;
            "end of the edge" => r.0,
            "α" => degrees(r.2.alpha),
            "β" => degrees(r.2.beta),
            "α + β" => degrees(r.2.alpha + r.2.beta),
            "γ⁰" => degrees(r.1),
            "γᵗ" => degrees(r.2.gamma),
            "fold by these three" => degrees(r.2.fold()),
            "γᵗ ≤ α + β" => {
                let holds = r.2.gamma <= r.2.alpha + r.2.beta;
                if holds { "holds" } else { "violated" }
            },
        },
    );
    let alt = "A pair of triangles at rest and folded, with the angles alpha, beta and gamma at both ends";
    Ok(Made {
        title: "Angle triples and the compatibility condition",
        paper: "Two triangles that share an edge can only fold about it, so γᵗ ≤ α + β = γ⁰ at either end (Eq. 10), and one end's \
                condition implies the other's.",
        here: "The angles are measured on the folded pair (right), whose fold follows from the angles at either end.",
        pictures: svg(5, &all, alt),
        tables: vec![table],
        ..Made::default()
    })
}

fn panel(x: &[[f64; 3]; 4], time: &str) -> Drawing {
    let mut d = Sketch::seen(-13.0, 56.0, 150.0);
    let [a, b, left, right] = *x;
    for corners in [[a, b, left], [a, right, b]] {
        d.face(corners, style::FACE);
    }
    d.line(&[a, b], Stroke::new(palette::INK, 1.5));
    for (k, (apex, other, prime)) in [(a, b, ""), (b, a, "′")].into_iter().enumerate() {
        // Where along the arc the name stands, how far outside of it and how much higher, points. At the far
        // end of the folded pair gamma's arc runs over the others, whose names stand outside then.
        let crowded = k == 0 && time != "⁰";
        let inside = [0.5, if crowded { 8.0 } else { -11.0 }, 0.0];
        let gamma = match (crowded, k) {
            (true, _) => [0.0, 4.0, 8.0],
            (false, 0) => [0.12, 12.0, 0.0],
            (false, _) => [0.3, 12.0, 0.0],
        };
        let [alpha, beta] = ["α", "β"].map(|name| format!("{name}{prime}"));
        for (from, to, radius, colour, name, [part, distance, lift]) in [
            (other, left, 0.21, ALPHA, alpha, inside),
            (other, right, 0.21, BETA, beta, inside),
            (left, right, 0.29, GAMMA, format!("γ{prime}{time}"), gamma),
        ] {
            let arc = angle_arc(&apex, &from, &to, radius);
            d.line(&arc, Stroke::new(colour, 1.0));
            let middle = arc[(part * arc.len() as f64) as usize];
            let (p, o) = (d.view.project(&middle), d.view.project(&apex));
            let l = (p[0] - o[0]).hypot(p[1] - o[1]);
            let [x, y] = [0, 1].map(|i| p[i] + (p[i] - o[i]) * distance / l);
            d.drawing.label([x, y + lift], &name, colour);
        }
    }
    let middle = [0, 1, 2].map(|i| 0.64 * a[i] + 0.36 * b[i]);
    d.label(&middle, [-7.0, 0.0], "e", palette::INK);
    d.drawing
}
