//! Fig. 8: fronts and rules of the assignment.

use super::{Made, caption, measured, rows, style, svg};
use crate::draw::{
    Anchor, Colour, Drawing, Marker, SMALL, Stroke, TEXT, Vertical, flat_edges, flat_faces,
    palette, plan, row,
};
use anyhow::{Result, ensure};
use isosheet_coords::{Assignment, Rule, StartVertex, sys_coord_assnmt_single};
use isosheet_mesh::generate::isotropic_square;
use isosheet_mesh::{Dof, Sheet, VertexId};

const SIDE: f64 = 168.0;

pub(super) fn make() -> Result<Made> {
    let sheet = isotropic_square(1, 1.0)?;
    let t = sheet.topology();
    // The left-upper corner, as in the paper.
    let start = t
        .vertex_ids()
        .min_by(|a, b| {
            let key = |v: VertexId| sheet.position(v)[0] - sheet.position(v)[1];
            key(*a).total_cmp(&key(*b))
        })
        .unwrap_or(VertexId(0));
    let assignment = sys_coord_assnmt_single(&sheet, StartVertex::Free(start))?;
    let dof = Dof::of(t).total;
    ensure!(
        assignment.dof() as i64 == dof && assignment.closures().is_empty(),
        "{} coordinates assigned, {dof} expected",
        assignment.dof()
    );
    let mut panels = [fronts(&sheet, &assignment), order(&sheet, &assignment)];
    let captions = [
        "(a) fronts, rules and coordinates",
        "(b) order, and the rods that place each vertex",
    ];
    for (panel, text) in panels.iter_mut().zip(captions) {
        caption(panel, [0.5 * SIDE, -22.0], TEXT, &[text.to_owned()]);
    }
    let [fronts, order] = panels;
    let all = row(&[fronts, order, legend(&assignment)], 20.0);
    let count = |letter| assignment.rule_count(letter);
    let alt = "Fronts, rules and order of the assignment of system coordinates on M1";
    Ok(Made {
        title: "Assignment of system coordinates",
        paper: "From the left-upper corner, front after front, each vertex is placed by the rule that its known neighbours \
                allow; the number of coordinates is the number of degrees of freedom.",
        here: "sys_coord_assnmt_single is applied to M¹; every rod is used exactly once, by the end that is placed later (b).",
        tables: vec![measured(rows! {
            "fronts" => assignment.front_count().to_string(),
            "vertices by rule h, two coordinates each" => count('h').to_string(),
            "vertices by rule g, one coordinate each" => count('g').to_string(),
            "vertices by rule f, no coordinate" => count('f').to_string(),
            "coordinates, three of the start vertex included" => assignment.dof().to_string(),
            "degrees of freedom" => dof.to_string(),
        })],
        pictures: svg(8, &all, alt),
        ..Made::default()
    })
}

/// Fronts in the order of a colour-blind-safe scale; the start has its own.
fn colour(front: u32) -> Colour {
    let fronts = [
        palette::INK,
        palette::ORANGE,
        palette::SKY,
        palette::GREEN,
        palette::PURPLE,
        palette::VERMILION,
        palette::BLUE,
    ];
    fronts[front as usize % fronts.len()]
}

fn marker(rule: &Rule) -> Marker {
    match rule.letter() {
        'h' => Marker::Diamond,
        'g' => Marker::Triangle,
        'f' => Marker::Disc,
        _ => Marker::Square,
    }
}

fn base(sheet: &Sheet) -> Drawing {
    let mut d = Drawing::new();
    flat_faces(&mut d, sheet, SIDE, |_| style::FACE);
    d
}

fn fronts(sheet: &Sheet, assignment: &Assignment) -> Drawing {
    let mut d = base(sheet);
    flat_edges(&mut d, sheet, SIDE, |_| {
        Some(Stroke::new(palette::PALE.mix(palette::GREY, 0.4), 0.6))
    });
    let place = plan(sheet, SIDE);
    // A front is joined up where its vertices are neighbours: it cuts the sheet in two.
    let t = sheet.topology();
    for e in t.edge_ids() {
        let [a, b] = t.edges()[e.index()];
        let front = assignment.placing(a).front;
        if front == assignment.placing(b).front {
            d.line(&[place(a), place(b)], Stroke::new(colour(front), 2.2));
        }
    }
    let rim = Stroke::new(palette::WHITE, 0.8);
    for placing in assignment.order() {
        let (p, fill) = (place(placing.vertex), colour(placing.front));
        marker(&placing.rule).draw(&mut d, p, 4.6, fill, rim);
        let names = match placing.rule {
            Rule::Start { q } => format!("q{}–{}", subscript(q + 1), subscript(q + 3)),
            Rule::H { q, .. } => format!("q{},{}", subscript(q + 1), subscript(q + 2)),
            Rule::G { q, .. } => format!("q{}", subscript(q + 1)),
            _ => continue,
        };
        label(&mut d, p, &names);
    }
    d
}

/// A number in subscript digits.
fn subscript(number: usize) -> String {
    let lowered = |digit: char| char::from_u32(0x2080 + digit.to_digit(10)?);
    number.to_string().chars().filter_map(lowered).collect()
}

/// A small text beside or at a point.
fn small(d: &mut Drawing, at: [f64; 2], text: &str, anchor: Anchor) {
    d.text(at, text, SMALL, anchor, Vertical::Centre, palette::INK);
}

/// A label below right of a vertex, on a pale ground so that lines do not run through it.
fn label(d: &mut Drawing, p: [f64; 2], text: &str) {
    let at = [p[0] + 5.5, p[1] - 8.5];
    let mut probe = Drawing::new();
    small(&mut probe, at, text, Anchor::Start);
    let b = probe.bounds();
    let ground = [b.min, [b.max[0], b.min[1]], b.max, [b.min[0], b.max[1]]];
    d.polygon(&ground, palette::WHITE.alpha(0.72));
    d.place(&probe, [0.0, 0.0]);
}

fn order(sheet: &Sheet, assignment: &Assignment) -> Drawing {
    let mut d = base(sheet);
    let place = plan(sheet, SIDE);
    for placing in assignment.order() {
        let to = place(placing.vertex);
        for known in placing.rule.known() {
            let from = place(*known);
            let l = (to[0] - from[0]).hypot(to[1] - from[1]);
            let at = |r: f64| [0, 1].map(|k| from[k] + (to[k] - from[k]) * r / l);
            d.arrow(
                &[at(7.0), at(l - 7.0)],
                Stroke::new(colour(placing.front), 0.8),
            );
        }
    }
    for (k, placing) in assignment.order().iter().enumerate() {
        let p = place(placing.vertex);
        d.disc(
            p,
            6.3,
            palette::WHITE,
            Stroke::new(colour(placing.front), 1.2),
        );
        small(&mut d, p, &k.to_string(), Anchor::Middle);
    }
    d
}

fn legend(assignment: &Assignment) -> Drawing {
    let mut d = Drawing::new();
    let mut y = SIDE - 4.0;
    let mut line = |d: &mut Drawing, symbol: Option<(Marker, Colour)>, text: &str| {
        if let Some((marker, fill)) = symbol {
            marker.draw(d, [4.0, y], 4.2, fill, Stroke::new(palette::WHITE, 0.8));
        }
        let x = if symbol.is_some() { 13.0 } else { 0.0 };
        small(d, [x, y], text, Anchor::Start);
        y -= 13.0;
    };
    for (marker, name) in [
        (Marker::Square, "start"),
        (Marker::Diamond, "rule h"),
        (Marker::Triangle, "rule g"),
        (Marker::Disc, "rule f"),
    ] {
        line(&mut d, Some((marker, palette::GREY)), name);
    }
    line(&mut d, None, "");
    for front in 1..=assignment.front_count() {
        line(
            &mut d,
            Some((Marker::Disc, colour(front))),
            &format!("front {front}"),
        );
    }
    d
}
