//! How soft a sheet is, by mesh level: what the paper says of Figs. 11 and 12 by eye.

use super::{Context, Effort, Picture, Table, crumple};
use crate::draw::{Axis, Legend, Marker, Plot, Series, palette};
use crate::runs;
use anyhow::Result;
use serde_json::{Value, json};

/// The plot and the table that go with Fig. 12.
pub(super) struct Softness {
    pub(super) picture: Picture,
    pub(super) table: Table,
    pub(super) facts: Value,
}

pub(super) fn make(context: &Context<'_>) -> Result<Softness> {
    let levels = match context.effort {
        Effort::Full => 0..4,
        Effort::Quick => 0..2,
    };
    let mut rows = Vec::new();
    let mut facts = Vec::new();
    let (mut depth, mut limit) = (Vec::new(), Vec::new());
    for level in levels.clone() {
        let s = runs::ensure(context.store, &crumple::scene(level, context.effort))?;
        let shape = s.shape;
        depth.push([f64::from(level), shape.centre_depth]);
        limit.push([f64::from(level), shape.deepest]);
        rows.push(vec![
            format!("M{}", ["⁰", "¹", "²", "³"][level as usize]),
            format!("{}/{}", s.vertices, s.faces),
            format!("{:.4}", shape.centre_depth),
            format!("{:.0} %", 100.0 * shape.softness()),
            format!("{:.3}", shape.corner_depth),
            format!("{:.3}", shape.extent),
            format!("{:.1}°", shape.fold),
            format!("{:.0e}", s.motion_left),
        ]);
        facts.push(json!({ "level": level, "softness": shape.softness(), "shape": shape, "motion_left": s.motion_left }));
    }
    let last = f64::from(levels.end - 1);
    let plate = vec![[0.0, runs::PLATE], [last, runs::PLATE]];
    let series = |name: &str, points, colour, marker, dash| Series { name: name.to_owned(), points, colour, marker, dash };
    let plot = Plot {
        x: Axis::linear(
            "mesh",
            [-0.15, last + 0.15],
            levels.map(|k| (f64::from(k), format!("~M~^{{{k}}}"))).collect(),
        ),
        y: Axis::round("depth of the centre of mass (sides)", [0.70, 0.78], 4),
        size: [190.0, 120.0],
        series: vec![
            series("limit: gathered into a line", limit, palette::GREY, None, Some([2.6, 2.0])),
            series("measured at the end of the run", depth, palette::VERMILION, Some(Marker::Disc), None),
            series("rigid plate", plate, palette::INK, None, Some([2.6, 2.0])),
        ],
        legend: Legend::Right,
    };
    let alt = "Depth of the centre of mass of the hanging sheet against the mesh level";
    Ok(Softness {
        picture: Picture {
            file: "fig12-softness.svg".into(),
            alt: alt.into(),
            bytes: plot.draw().to_svg(alt)?.into_bytes(),
        },
        table: Table {
            caption: "Softness by mesh, at the end of the same run (lengths in sides of the sheet). Softness: how far the centre of \
                      mass has come from its depth in a rigid plate (0 %) towards the greatest depth that unstretchable paper \
                      allows (100 %). Fold: root mean square over the inner edges, weighted by length."
                .into(),
            head: ["mesh", "V/F", "centre of mass", "softness", "free corner", "width", "fold", "motion left"]
                .map(str::to_owned)
                .to_vec(),
            rows,
        },
        facts: Value::Array(facts),
    })
}
