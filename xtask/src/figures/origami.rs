//! Beyond the paper: crease patterns folded by driven angles.

use super::show::View;
use super::{Effort, Made, Picture, Play, course, degrees, mean, measured, nearest, rows};
use crate::draw::{Axis, Chart, Charts, Colour, Marker, Series, Viewpoint, palette};
use crate::runs::{FigureScene, Run, RunSummary};
use crate::store::Store;
use anyhow::{Context, Result, bail, ensure};
use isosheet_io::scene::{AlikeCreases, DegreeFour, Mesh, Miura};
use isosheet_mesh::generate::{FoldAssignment, FoldPattern, miura_zigzags};
use isosheet_mesh::origami;
use isosheet_mesh::{VertexId, fold_angle};
use serde_json::json;

/// Rest angle of the driven creases in the end, radians: 150 degrees.
const FULL: f64 = 150.0 * std::f64::consts::PI / 180.0;

/// The edits of a quick run: 15 frames.
fn edits(effort: Effort) -> Vec<String> {
    effort.quick_or(vec![format!("method.step={:?}", 2.5 / 15.0)], Vec::new())
}

/// The Miura pattern of the figure.
fn miura(effort: Effort) -> Result<FigureScene> {
    let mut edits = edits(effort);
    if effort == Effort::Quick {
        edits.extend(["columns", "rows"].map(|key| format!("sheet.mesh.miura.{key}=4")));
    }
    FigureScene::of("fig17", "origami-miura", &edits)
}

fn vertex(alike: AlikeCreases, effort: Effort) -> Result<FigureScene> {
    let (file, name) = match alike {
        AlikeCreases::Odd => ("fig17-vertex-odd", "origami-vertex-odd"),
        AlikeCreases::Even => ("fig17-vertex-even", "origami-vertex-even"),
    };
    FigureScene::of(file, name, &edits(effort))
}

/// The Miura pattern of a scene.
fn miura_of(scene: &FigureScene) -> Result<&Miura> {
    match &scene.scene().sheet[0].mesh {
        Mesh::Miura(miura) => Ok(miura),
        other => bail!("a Miura pattern, not {other:?}"),
    }
}

/// The vertex of degree four of a scene.
fn vertex_of(scene: &FigureScene) -> Result<&DegreeFour> {
    match &scene.scene().sheet[0].mesh {
        Mesh::DegreeFour(vertex) => Ok(vertex),
        other => bail!("a vertex of degree four, not {other:?}"),
    }
}

/// A folded Miura pattern at a frame, in numbers.
struct Folded {
    /// Mean fold of the zigzags, and mean of the straight creases, radians; mountains count as positive.
    zigzag: f64,
    straight: f64,
    /// Mean width and depth of the panels over those when flat.
    size: [f64; 2],
    /// Largest difference of a straight crease from its exact fold, of any panel from flat (radians), of any
    /// distance of two vertices from the exact one (metres).
    errors: [f64; 3],
}

impl Folded {
    fn of(miura: &Miura, pattern: &FoldPattern, x: &[f64]) -> Self {
        let (exact, t) = (miura.kinematics(), pattern.sheet.topology());
        let driven = miura_zigzags(pattern);
        let (mut zigzags, mut straights, mut flats) = (Vec::new(), Vec::new(), Vec::new());
        for e in t.edge_ids() {
            let Some(fold) = fold_angle(t, x, e) else {
                continue;
            };
            match pattern.assignment(e) {
                FoldAssignment::Flat => flats.push(fold),
                a if driven.contains(&e) => zigzags.push(a.sign() * fold),
                a => straights.push(a.sign() * fold),
            }
        }
        let off = |v: &[f64], about: f64| v.iter().fold(0.0f64, |m, a| m.max((a - about).abs()));
        let zigzag = mean(&zigzags);
        let theta = 0.5 * zigzag;
        let at = |x: &[f64], v: usize| -> [f64; 3] { [x[3 * v], x[3 * v + 1], x[3 * v + 2]] };
        let distance = |x: &[f64], a: usize, b: usize| {
            let (p, q) = (at(x, a), at(x, b));
            (p[0] - q[0]).hypot(p[1] - q[1]).hypot(p[2] - q[2])
        };
        let (columns, rows) = (miura.columns, miura.rows);
        let rigid = exact.positions(columns, rows, theta);
        let n = t.vertex_count();
        let mut apart: f64 = 0.0;
        for a in 0..n {
            for b in 0..a {
                apart = apart.max((distance(x, a, b) - distance(&rigid, a, b)).abs());
            }
        }
        // Between vertices two panels apart, which lie in the plane of the folded sheet.
        let vertex = |i: usize, j: usize| i + j * (columns + 1);
        let flat = exact.panel(0.0);
        let size = [
            distance(x, vertex(0, 0), vertex(columns, 0)) / (columns as f64 * flat[0]),
            distance(x, vertex(0, 0), vertex(0, rows)) / (rows as f64 * flat[1]),
        ];
        Self {
            zigzag,
            straight: mean(&straights),
            size,
            errors: [
                off(&straights, exact.straight_fold(theta)),
                off(&flats, 0.0),
                apart,
            ],
        }
    }
}

/// The fold angles of the four creases of a vertex at every frame, with the first crease a valley.
fn vertex_angles(run: &Run) -> Result<Vec<[f64; 4]>> {
    let t = run.sheet.topology();
    let of_frame = |x: &[f64]| {
        let mut angles = [0.0; 4];
        for (c, angle) in angles.iter_mut().enumerate() {
            let e = t.find_edge(VertexId(0), VertexId::from_index(c + 1));
            *angle = e.and_then(|e| fold_angle(t, x, e)).context("a crease")?;
        }
        Ok(angles)
    };
    run.frames().map(of_frame).collect()
}

/// Folds below this say more about round-off than about kinematics: the lengths, kept to 1e-12, fix an angle
/// to that over the angle.
const LEAST: f64 = 0.05;

/// Largest error of the fold angles of a vertex, radians: rods change their lengths by less than 1e-10 in
/// every run of a figure, and errors count from [`LEAST`] on.
const EXACT: f64 = 1e-10 / LEAST;

/// The crease, from 0, that folds most and is driven.
fn lead(mode: origami::FoldingMode) -> usize {
    match mode {
        origami::FoldingMode::OddAlike => 0,
        origami::FoldingMode::EvenAlike => 1,
    }
}

/// How the runs are shown.
const VIEW: View = View {
    from: Viewpoint {
        azimuth: -62.0,
        elevation: 38.0,
        distance: 1.2,
        depth: 0.0,
    },
    columns: 3,
    pins: Vec::new(),
    bodies: &[],
};

/// Every so many frames are marked in plots.
const EVERY: usize = 6;

/// Exact curves are grey.
fn exact_curve(name: &str, points: Vec<[f64; 2]>) -> Series {
    Series::line(name, palette::GREY, points)
}

/// A fold angle from 0 to 150 degrees.
fn fold_axis(label: &str) -> Axis {
    Axis::linear(label, [0.0, 150.0])
}

/// The fold of the straight creases and the size of the sheet over the fold of the zigzags.
fn folds_plot(exact: &origami::Miura, folded: &[Folded]) -> Charts {
    let thetas = (0..=80).map(|k| 0.5 * FULL * f64::from(k) / 80.0);
    let thetas: Vec<f64> = thetas.collect();
    let curve = |name: &str, f: &dyn Fn(f64) -> f64| {
        let points = thetas.iter().map(|t| [2.0 * t.to_degrees(), f(*t)]);
        exact_curve(name, points.collect())
    };
    let measured = |f: &dyn Fn(&Folded) -> f64| -> Vec<[f64; 2]> {
        let marked = folded.iter().step_by(EVERY);
        marked.map(|m| [m.zigzag.to_degrees(), f(m)]).collect()
    };
    let (flat, size) = (exact.panel(0.0), [190.0, 150.0]);
    let straight = measured(&|m| m.straight.to_degrees());
    let angles = Chart::new(
        fold_axis("fold of the zigzags (°)"),
        fold_axis("fold of the straight creases (°)"),
        size,
        vec![
            curve("exact", &|t| exact.straight_fold(t).to_degrees()),
            Series::dots("simulated", palette::BLUE, Marker::Disc, straight),
        ],
    );
    let (along, across) = (measured(&|m| m.size[0]), measured(&|m| m.size[1]));
    let sizes = Chart::new(
        fold_axis("fold of the zigzags (°)"),
        Axis::linear("size (flat = 1)", [0.0, 1.0]),
        size,
        vec![
            curve("exact", &|t| exact.panel(t)[0] / flat[0]),
            curve("", &|t| exact.panel(t)[1] / flat[1]),
            Series::dots("along zigzags", palette::VERMILION, Marker::Square, along),
            Series::dots("across", palette::GREEN, Marker::Triangle, across),
        ],
    );
    Charts::row([angles, sizes])
}

/// A vertex of degree four in one of its two modes.
struct Vertex {
    run: RunSummary,
    page: Play,
    /// Largest difference of an angle from the exact one, radians.
    error: f64,
    /// The angles at the end, radians.
    end: [f64; 4],
    series: [Series; 2],
}

/// The two modes, their names, and how they are drawn.
const MODES: [(AlikeCreases, &str, Colour, Marker); 2] = [
    (
        AlikeCreases::Odd,
        "1 and 3 alike",
        palette::BLUE,
        Marker::Disc,
    ),
    (
        AlikeCreases::Even,
        "2 and 4 alike",
        palette::VERMILION,
        Marker::Square,
    ),
];

impl Vertex {
    fn of(
        (alike, name, colour, marker): (AlikeCreases, &str, Colour, Marker),
        store: &Store,
    ) -> Result<Self> {
        let run = Run::of(store, vertex(alike, store.effort)?)?;
        let (exact, mode) = (
            vertex_of(&run.scene)?.kinematics(),
            vertex_of(&run.scene)?.mode(),
        );
        let label = format!("vertex of degree four, creases {name}");
        let found = vertex_angles(&run)?;
        let folded = found.iter().filter(|a| a[lead(mode)].abs() > LEAST);
        let errors = folded.flat_map(|a| {
            let e = exact.angles(mode, a[0]);
            (0..4).map(move |k| (a[k] - e[k]).abs())
        });
        let end = *found.last().context("frames")?;
        let two = |a: &[f64; 4]| [a[0].to_degrees(), a[1].to_degrees()];
        let curve = (0..=80).map(|k| two(&exact.angles(mode, end[0] * f64::from(k) / 80.0)));
        let exact_name = ["exact", ""][alike as usize];
        let measured = found.iter().step_by(EVERY).map(two).collect();
        Ok(Self {
            page: VIEW.play(&run, store.effort, 17, &label)?,
            run: run.summary,
            error: errors.fold(0.0, f64::max),
            end,
            series: [
                exact_curve(exact_name, curve.collect()),
                Series::dots(name, colour, marker, measured),
            ],
        })
    }
}

pub(super) fn make(store: &Store) -> Result<Made> {
    let whole = Run::of(store, miura(store.effort)?)?;
    let (run, miura) = (&whole.summary, miura_of(&whole.scene)?);
    let (pattern, exact) = (miura.pattern()?, miura.kinematics());
    let folded = whole.frames().map(|x| Folded::of(miura, &pattern, x));
    let folded: Vec<Folded> = folded.collect();
    let beyond = || folded.iter().filter(|f| f.zigzag > LEAST);
    let errors = [0, 1, 2].map(|k| beyond().fold(0.0f64, |m, f| m.max(f.errors[k])));
    let last = folded.last().context("frames")?;
    let mut vertices = Vec::new();
    for mode in MODES {
        vertices.push(Vertex::of(mode, store)?);
    }
    ensure!(
        vertices.iter().all(|v| v.error < EXACT),
        "the creases of a vertex of degree four do not fold as geometry says"
    );
    let branches = Chart::new(
        Axis::linear("fold of crease 1 (°)", [0.0, 160.0]),
        Axis::linear("fold of crease 2 (°)", [-160.0, 0.0]),
        [190.0, 150.0],
        vertices.iter().flat_map(|v| v.series.clone()).collect(),
    );
    let times = [0.0, 30.0, 60.0, 90.0, 120.0, 150.0].map(|angle: f64| {
        let angles = folded.iter().map(|f| f.zigzag.to_degrees());
        whole.trajectory.times()[nearest(angles, angle)]
    });
    let (work, lack) = (run.energy.work, run.energy.drift);
    let mut rows = rows! {
        "sheet" => format!(
            "{}/{} vertices/faces, panels of 20 mm with an angle of 60°, 80 g/m², no gravity", run.vertices,
            run.faces
        ),
        "fold of the zigzags from which errors count" => degrees(LEAST),
        "error of tan(s/2) = cos 60° tan(z/2) at the straight creases" => format!("{:.0e} rad", errors[0]),
        "fold of the panels, which are flat" => format!("{:.0e} rad", errors[1]),
        "difference of distances from the rigid pattern: inertia of the panels" =>
            format!("{:.0e} m", errors[2]),
        "fold of the zigzags half a second after the drive has stopped" => degrees(last.zigzag),
        "fold of the straight creases then, and its error" =>
            format!("{}, {:.0e} rad", degrees(last.straight), last.errors[0]),
        "vertex of degree four, creases 1 and 3 alike: largest error" =>
            format!("{:.0e} rad", vertices[0].error),
        "vertex of degree four, creases 2 and 4 alike: largest error" =>
            format!("{:.0e} rad", vertices[1].error),
        "work of the drive, and what the balance lacks" => format!("{work:.2e} J, {lack:.1e} J"),
    };
    rows.extend(course(run));
    let alt = "A flat sheet with a Miura pattern folds up";
    let alt_folds = "Fold of the straight creases, and size of the sheet, over the fold of the zigzags: simulated and exact";
    let alt_vertex = "Fold of the second crease of a vertex over that of the first in its two modes: simulated and exact";
    let mut pages = vec![VIEW.play(&whole, store.effort, 17, "Miura's pattern")?];
    pages.extend(vertices.iter().map(|v| v.page.clone()));
    Ok(Made {
        title: "Origami: crease patterns folded by driven angles",
        paper: "Origami is named as an application (Sec. 1), and no crease pattern is folded.",
        here: "Springs drive the zigzag creases of a flat sheet alone, and geometry folds the rest; a vertex of degree four leaves the flat state one \
               way or the other by its mountains and valleys.",
        pictures: vec![
            VIEW.picture(&whole, store.effort, ["fig17.png", alt], &times)?,
            Picture::svg("fig17-folds", &folds_plot(&exact, &folded), alt_folds),
            Picture::svg("fig17-vertex", &Charts::from(branches), alt_vertex),
        ],
        pages,
        tables: vec![measured(rows)],
        facts: json!({
            "run": run,
            "errors": { "straight_rad": errors[0], "panels_rad": errors[1], "distances_m": errors[2] },
            "folds": folded.iter().map(|f| [f.zigzag, f.straight, f.size[0], f.size[1]]).collect::<Vec<_>>(),
            "vertices": vertices.iter().map(|v| json!({ "run": v.run, "error_rad": v.error, "end_rad": v.end })).collect::<Vec<_>>(),
            "name": whole.scene.name(),
        }),
    })
}
