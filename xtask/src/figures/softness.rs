//! How soft a sheet is, by mesh level: what the paper says of Figs. 11 and 12 by eye.

use super::{Context, Effort, Picture, Table, crumple};
use crate::draw::{Axis, Colour, Legend, Line, Marker, Plot, Series, palette, row};
use crate::runs::{self, Member};
use anyhow::Result;
use isosheet_mesh::Dof;
use serde_json::{Value, json};

/// Falls of each mesh: they settle in different folds, so one says little.
const MEMBERS: u64 = 8;

/// Random displacement at the start of a fall, mean edge lengths: two hundredths of a millimetre on M^3.
const BUMP: f64 = 1e-3;

/// The plot and the table that go with Fig. 12.
pub(super) struct Softness {
    pub(super) picture: Picture,
    pub(super) table: Table,
    pub(super) facts: Value,
}

/// The falls of one mesh.
struct Level {
    level: u32,
    vertices: usize,
    faces: usize,
    internal: i64,
    falls: Vec<Member>,
}

impl Level {
    fn values(&self, f: impl Fn(&Member) -> f64) -> Vec<f64> {
        self.falls.iter().map(f).collect()
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn smallest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

pub(super) fn make(context: &Context<'_>) -> Result<Softness> {
    let (levels, members) = match context.effort {
        Effort::Full => (0..4, MEMBERS),
        Effort::Quick => (0..2, 2),
    };
    let mut all = Vec::new();
    for level in levels {
        let scene = crumple::scene(level, context.effort);
        let sheet = scene.sheet()?;
        let t = sheet.topology();
        all.push(Level {
            level,
            vertices: t.vertex_count(),
            faces: t.face_count(),
            internal: Dof::of(t).internal,
            falls: runs::ensemble(&scene, BUMP, members)?,
        });
    }
    let alt = "Total bending of the falling sheet and its width at rest against the mesh level";
    Ok(Softness {
        picture: Picture {
            file: "fig12-softness.svg".into(),
            alt: alt.into(),
            bytes: plots(&all).to_svg(alt)?.into_bytes(),
        },
        table: table(&all),
        facts: Value::Array(
            all.iter()
                .map(|l| json!({ "level": l.level, "bump": BUMP, "falls": l.falls }))
                .collect(),
        ),
    })
}

fn plots(all: &[Level]) -> crate::draw::Drawing {
    let last = all.last().map_or(0.0, |l| f64::from(l.level));
    let mesh = || {
        let ticks = all
            .iter()
            .map(|l| (f64::from(l.level), format!("~M~^{{{}}}", l.level)));
        Axis::linear("mesh", [-0.25, last + 0.25], ticks.collect())
    };
    let series = |name: &str, points: Vec<[f64; 2]>, colour: Colour, marker, line| Series {
        name: name.to_owned(),
        points,
        colour,
        marker,
        line,
    };
    let cloud = |f: &dyn Fn(&Member) -> f64| {
        all.iter()
            .flat_map(|l| l.values(f).into_iter().map(|v| [f64::from(l.level), v]))
            .collect::<Vec<_>>()
    };
    let line = |f: &dyn Fn(&Member) -> f64| {
        all.iter()
            .map(|l| [f64::from(l.level), mean(&l.values(f))])
            .collect::<Vec<_>>()
    };
    let bending = |m: &Member| m.mean_bending;
    let width = |m: &Member| m.shape.extent;
    let top = 1.1 * largest(&cloud(&bending).iter().map(|p| p[1]).collect::<Vec<_>>());
    let size = [160.0, 118.0];
    let panel = |y: Axis, f: &dyn Fn(&Member) -> f64| Plot {
        x: mesh(),
        y,
        size,
        series: vec![
            series(
                "each fall",
                cloud(f),
                palette::SKY,
                Some(Marker::Disc),
                Line::None,
            ),
            series(
                "mean",
                line(f),
                palette::VERMILION,
                Some(Marker::Square),
                Line::Solid,
            ),
        ],
        legend: Legend::None,
    };
    let left = panel(
        Axis::round("total bending (rad · side)", [0.0, top], 4),
        &bending,
    );
    let mut right = panel(Axis::round("width at rest (sides)", [0.0, 1.5], 3), &width);
    let plate = vec![[-0.25, 2f64.sqrt()], [last + 0.25, 2f64.sqrt()]];
    right.series.push(series(
        "rigid plate",
        plate,
        palette::INK,
        None,
        Line::Dashed,
    ));
    right.legend = Legend::Right;
    row(&[left.draw(), right.draw()], 26.0)
}

fn table(all: &[Level]) -> Table {
    let range = |v: &[f64], digits: usize| {
        format!(
            "{:.digits$} ({:.digits$}–{:.digits$})",
            mean(v),
            smallest(v),
            largest(v)
        )
    };
    let rows = all
        .iter()
        .map(|l| {
            vec![
                format!("M{}", ["⁰", "¹", "²", "³"][l.level as usize % 4]),
                format!("{}/{}", l.vertices, l.faces),
                l.internal.to_string(),
                range(&l.values(|m| m.mean_bending), 2),
                range(&l.values(|m| m.shape.extent), 3),
                range(&l.values(|m| m.shape.corner_depth), 3),
                range(&l.values(|m| m.shape.centre_depth), 4),
                format!("{:.0} %", 100.0 * mean(&l.values(|m| m.shape.softness()))),
                format!(
                    "{} of {}",
                    l.falls
                        .iter()
                        .filter(|m| m.shape.is_folded_in_half())
                        .count(),
                    l.falls.len()
                ),
            ]
        })
        .collect();
    Table {
        caption: format!(
            "Softness by mesh: mean (range) of {} falls from flat up to a random {:.1} % of an edge. Lengths in sides. Total bending, \
             averaged over the run: sum of edge length times fold angle, which does not depend on how many edges share a bend. \
             Width: largest horizontal distance at rest; it falls as the sheet gathers. The depth of the centre of mass lies between \
             that of a rigid plate ({:.4}: 0 %) and the limit of any unstretchable sheet ({:.4}: 100 %), but need not grow: a sheet \
             folded in half along the diagonal, at √5/3, hangs deeper than many richer folds.",
            all.first().map_or(0, |l| l.falls.len()),
            100.0 * BUMP,
            runs::PLATE,
            runs::LIMIT,
        ),
        head: [
            "mesh",
            "V/F",
            "internal DOF",
            "total bending",
            "width",
            "free corner",
            "centre of mass",
            "of the limit",
            "folded in half",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
    }
}
