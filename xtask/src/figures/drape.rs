//! Fig. 14: a rectangular cloth on a rectangular table. Fig. 15: an octagonal one on an octagonal table, and
//! on towards the round.

use super::cloths::{Layout, irregular, octagon, polygon, rectangle, ringed};
use super::folds::{Folds, Hem};
use super::show::View;
use super::{Effort, Made, Picture, Play, Table, through_itself, whole_percent};
use crate::draw::{Axis, Chart, Charts, Legend, Marker, Series, palette};
use crate::report::Cell;
use crate::runs::{FigureScene, Run};
use crate::store::Store;
use anyhow::Result;
use isosheet_mesh::{Dof, Sheet};
use serde_json::{Value, json};

/// Times of the pictures, seconds.
const TIMES: [f64; 6] = [0.0, 0.15, 0.3, 0.6, 1.2, 8.0];

/// A cloth at the end of its run.
struct Draped {
    label: String,
    run: Run,
    folds: Folds,
    hem: Hem,
    /// How far the hem hangs below the table, as part of its distance from the table in the flat cloth (means
    /// over the vertices of the hem): 1 for a cloth that hangs straight down.
    drop: f64,
    /// Internal degrees of freedom.
    internal: i64,
}

fn drape(label: &str, scene: FigureScene, store: &Store) -> Result<Draped> {
    let run = Run::of(store, scene)?;
    let (sheet, x) = (&run.sheet, run.end());
    let layout = Layout::of(run.scene.scene())?;
    Ok(Draped {
        label: label.into(),
        folds: Folds::of(sheet, x, &layout.table, &layout.cloth),
        hem: Hem::of(sheet, x),
        drop: drop(sheet, x, &layout),
        internal: Dof::of(sheet.topology()).internal,
        run,
    })
}

fn drop(sheet: &Sheet, x: &[f64], layout: &Layout) -> f64 {
    let t = sheet.topology();
    let hem = || t.vertex_ids().filter(|v| t.is_boundary_vertex(*v));
    // The table's top is below the start of the cloth.
    let depth: f64 = hem().map(|v| -layout.drop - x[3 * v.index() + 2]).sum();
    let reach = |v| {
        let [a, b, _] = sheet.position(v);
        layout.table.outside([a, b])
    };
    depth / hem().map(reach).sum::<f64>()
}

impl Draped {
    fn picture(&self, file: &str, effort: Effort) -> Result<Picture> {
        let label = &self.label;
        let alt = format!("{label}: it is let go flat above a table, falls and drapes");
        VIEW.picture(&self.run, effort, [file, &alt], &TIMES)
    }

    fn facts(&self) -> Value {
        json!({ "run": self.run.summary, "folds": self.folds, "drop": self.drop, "internal_dof": self.internal, "hem": {
            "folds": self.hem.folds, "spacing_spread": self.hem.spacing_spread, "size_spread": self.hem.size_spread, "wave": self.hem.wave,
        } })
    }
}

/// How a cloth is shown.
const VIEW: View = View {
    azimuth: -62.0,
    elevation: 24.0,
    distance: 6.0,
    columns: 3,
    pins: Vec::new(),
    bodies: &[0],
    depth: 0.4,
};

/// The page that plays the run of a cloth.
pub(super) fn page(figure: u8, label: &str, run: &Run, effort: Effort) -> Result<Play> {
    let (label, free) = (label, through_itself(&run.scene));
    VIEW.play(run, effort, figure, &format!("draped cloth, {label}{free}"))
}

/// The pages of some cloths; one that is there twice has a single page.
fn pages<'a>(
    figure: u8,
    all: impl Iterator<Item = &'a Draped>,
    effort: Effort,
) -> Result<Vec<Play>> {
    let mut pages: Vec<Play> = Vec::new();
    let mut played: Vec<&str> = Vec::new();
    for d in all {
        if !played.contains(&d.run.scene.name()) {
            played.push(d.run.scene.name());
            pages.push(page(figure, &d.label, &d.run, effort)?);
        }
    }
    Ok(pages)
}

fn mesh(d: &Draped) -> Cell {
    format!("{}/{}", d.run.summary.vertices, d.run.summary.faces).into()
}

fn fold_table(all: &[Draped]) -> Table {
    let part = |part: f64| Cell::from(whole_percent(part));
    Table::of(
        "Principal folds at rest, in the part of the cloth that hangs beyond the first row of cells at the table's edge. Bending is edge length \
                  times size of the fold angle. At the corners: within one mean edge of a line from a table corner to its cloth \
                  corner. Strongest edges: the fewest that carry half of the bending. Angle with the nearest of these \
                  lines: weighted by bending (in brackets: of all edges, what the mesh alone gives). Drop: how far the hem hangs below the table, of its distance \
                  from the table in the flat cloth. Triangles whose edges keep their lengths leave a cloth only as many internal degrees of freedom as it has \
                  boundary edges less three: it cannot shear as woven cloth does.",
        all,
        &[
            ("cloth", &|d| d.label.as_str().into()),
            ("V/F", &|d| mesh(d)),
            ("bending at the corners", &|d| {
                part(d.folds.share_at_corners)
            }),
            ("edges there", &|d| part(d.folds.length_at_corners)),
            ("density, all = 1", &|d| {
                format!("{:.1}", d.folds.density_at_corners).into()
            }),
            ("strongest edges there", &|d| {
                let [all, there] = d.folds.strongest;
                format!("{there} of {all}").into()
            }),
            ("angle", &|d| {
                format!("{:.0}° ({:.0}°)", d.folds.angle[0], d.folds.angle[1]).into()
            }),
            ("internal DOF", &|d| d.internal.to_string().into()),
            ("drop", &|d| part(d.drop)),
        ],
    )
}

/// Bending density by distance from the corner lines.
fn profiles(all: &[Draped]) -> Charts {
    let looks = [
        (palette::VERMILION, Marker::Square),
        (palette::BLUE, Marker::Disc),
        (palette::GREEN, Marker::Triangle),
        (palette::ORANGE, Marker::Diamond),
    ];
    let all_points = || all.iter().flat_map(|d| &d.folds.profile);
    let far = all_points().map(|p| p[0] + 0.5).fold(1.0, f64::max);
    let top = 1.1 * all_points().map(|p| p[1]).fold(1.0, f64::max);
    let label = "distance from the nearest corner line (mean edges)";
    let of = |(d, (colour, marker)): (&Draped, _)| {
        Series::line(&d.label, colour, d.folds.profile.clone()).marked(marker)
    };
    let series = all.iter().zip(looks).map(of).collect();
    let y = Axis::linear("bending (mean = 1)", [0.0, top]);
    Chart::new(Axis::linear(label, [0.0, far]), y, [230.0, 130.0], series).into()
}

/// What holds for each run.
fn runs_table(all: &[&Draped]) -> Table {
    Table::of(
        CONDITIONS,
        all,
        &[
            ("cloth", &|d| d.label.as_str().into()),
            ("V/F", &|d| mesh(d)),
            ("at rest from", &|d| {
                let time = d.run.summary.at_rest_from;
                time.map(|t| format!("{t:.1} s")).into()
            }),
            ("kinetic energy left", &|d| {
                format!("{:.0e}", d.run.summary.motion_left).into()
            }),
            ("wall s per simulated s", &|d| {
                format!("{:.2}", d.run.summary.slowness()).into()
            }),
            ("largest strain", &|d| {
                format!("{:.0e}", d.run.summary.course.strain).into()
            }),
            ("smallest gap", &|d| {
                super::gap(d.run.summary.course.gap).into()
            }),
        ],
    )
}

const CONDITIONS: &str = "Cloth of 0.2 kg/m², velocity damping 2/s, friction 0.3 with the table and itself, self-contact on, gap below which contact acts 5 mm; \
                          let go exactly flat 5 mm above the table, 8 s. At rest: kinetic energy below 1e-6 of the potential energy released, to the end of the run.";

pub(super) fn fig14(store: &Store) -> Result<Made> {
    let effort = store.effort;
    let (fine, name) = effort.quick_or((1, "M¹"), (3, "M³"));
    let all = vec![
        drape("M²", rectangle(2, effort)?, store)?,
        drape(name, rectangle(fine, effort)?, store)?,
        drape("irregular", irregular(effort)?, store)?,
    ];
    let alt = "How the bending of the overhang depends on the distance from the lines from table corners to cloth corners";
    Ok(Made {
        title: "Rectangular cloth on a rectangular table".into(),
        paper: "A rectangular plastic tablecloth is draped over a rectangular table with M², and with a second resolution: the principal folds run from \
                the table corners to the cloth corners.".into(),
        here: "The diagonals of the regular meshes lead through the corners of the table and could favour what is to be shown: the irregular \
               triangulation, which has no such lines, is the check."
            .into(),
        pictures: vec![
            all[0].picture("fig14.png", effort)?,
            all[1].picture("fig14-fine.png", effort)?,
            all[2].picture("fig14-irregular.png", effort)?,
            Picture::svg("fig14-folds", &profiles(&all), alt),
        ],
        pages: pages(14, all.iter(), effort)?,
        tables: vec![fold_table(&all), runs_table(&all.iter().collect::<Vec<_>>())],
        facts: json!(all.iter().map(Draped::facts).collect::<Vec<_>>()),
    })
}

/// Corners and rings of the polygons with about as many faces as the octagon, whose rings are as wide as the
/// cells of M³.
const RINGS: [(u32, u32); 5] = [(4, 11), (6, 9), (8, 8), (12, 7), (16, 6)];

/// Corners of the irregular polygons of the study; the last stands for the circle.
const SIDES: [u32; 6] = [4, 6, 8, 12, 16, 48];

/// The octagons, and the polygons with more and more corners, of which the second number is the round one.
fn fig15_cloths(store: &Store) -> Result<(Vec<Draped>, Vec<Draped>, usize)> {
    let effort = store.effort;
    let fine = polygon("drape-octagon-fine", 8, effort.quick_or(0.2, 0.045), effort)?;
    let octagons = vec![
        drape("244/440", octagon(effort)?, store)?,
        drape("finer", fine, store)?,
        drape("rings", ringed(8, RINGS[2].1, effort)?, store)?,
    ];
    let mut polygons = Vec::new();
    let (sides, spacing) = effort.quick_or((&SIDES[..1], 0.2), (&SIDES, 0.06));
    for &n in sides {
        let label = match n {
            48 => "round".to_owned(),
            _ => format!("n = {n}"),
        };
        let scene = polygon(&format!("drape-{n}-gon"), n, spacing, effort)?;
        polygons.push(drape(&label, scene, store)?);
    }
    let round = polygons.len() - 1;
    for &(n, rings) in effort.quick_or(&RINGS[2..3], &RINGS) {
        let label = format!("n = {n}, rings");
        polygons.push(drape(&label, ringed(n, rings, effort)?, store)?);
    }
    Ok((octagons, polygons, round))
}

pub(super) fn fig15(store: &Store) -> Result<Made> {
    let (octagons, polygons, round) = fig15_cloths(store)?;
    let alt = "Distance of the hem from the axis, that of the flat cloth = 1, by angle, for polygons with more and more corners";
    let folds_alt = "How the bending of the overhang depends on the distance from the lines from table corners to cloth corners";
    let all = || octagons.iter().chain(&polygons);
    Ok(Made {
        title: "Octagonal cloth on an octagonal table".into(),
        paper: "An octagonal plastic tablecloth (244/440) is draped over an octagonal table: principal folds run from table corners to cloth corners, and for \
                more and more corners the paper infers that uniform folding patterns will occur.".into(),
        here: "In the irregular meshes and in 244/440, a lattice of triangles, no mesh line runs from a table corner to its cloth corner, and in \
               the meshes of concentric rings some do."
            .into(),
        pictures: vec![
            octagons[0].picture("fig15.png", store.effort)?,
            octagons[1].picture("fig15-fine.png", store.effort)?,
            Picture::svg("fig15-folds", &profiles(&octagons), folds_alt),
            octagons[2].picture("fig15-rings.png", store.effort)?,
            polygons[round].picture("fig15-round.png", store.effort)?,
            Picture::svg("fig15-hems", &hems(&polygons), alt),
        ],
        pages: pages(15, all(), store.effort)?,
        tables: vec![
            fold_table(&octagons),
            hem_table(&polygons),
            runs_table(&all().collect::<Vec<_>>()),
        ],
        facts: json!({
            "octagons": octagons.iter().map(Draped::facts).collect::<Vec<_>>(),
            "polygons": polygons.iter().map(Draped::facts).collect::<Vec<_>>(),
        }),
    })
}

/// Spacing and size of folds that spread by less than this part of their means make a uniform pattern.
const UNIFORM: f64 = 0.2;

/// The hems of the polygons, one small plot each.
fn hems(all: &[Draped]) -> Charts {
    let plot = |d: &Draped| {
        let ticks = [0.0, 180.0, 360.0].map(|a| (a, format!("{a:.0}")));
        let label = format!("angle (°), {}", d.label);
        let x = Axis::named(&label, [0.0, 360.0], ticks.to_vec());
        let y = Axis::linear("distance", [0.5, 1.0]);
        let hem = Series::line("", palette::BLUE, d.hem.curve.clone());
        Chart::new(x, y, [120.0, 60.0], vec![hem]).with_legend(Legend::None)
    };
    let charts: Vec<Chart> = all.iter().map(plot).collect();
    Charts(charts.chunks(3).map(<[Chart]>::to_vec).collect())
}

fn hem_table(all: &[Draped]) -> Table {
    let part = |part: f64| Cell::from(whole_percent(part));
    Table::of(
        "Polygonal cloths on polygonal tables, irregular meshes of one spacing and meshes of rings: folds of the hem at rest. Spreads are standard deviations over means, of \
                  the angles between neighbouring folds and of how far the folds stand out: both are 0 for a uniform pattern. Wave: the wave number with the \
                  largest part of the variance of the hem's relative distance from the axis, and that part. Folds are outward bulges of the hem's distance from \
                  the axis, divided by that of the flat cloth, that stand out by more than 0.02; a pattern is uniform where both spreads are below 20 %.",
        all,
        &[
            ("cloth", &|d| d.label.as_str().into()),
            ("V/F", &|d| mesh(d)),
            ("folds", &|d| d.hem.folds.to_string().into()),
            ("spread of spacing", &|d| part(d.hem.spacing_spread)),
            ("spread of size", &|d| part(d.hem.size_spread)),
            ("uniform", &|d| {
                let Hem {
                    folds,
                    spacing_spread,
                    size_spread,
                    ..
                } = d.hem;
                let is_uniform = folds > 1 && spacing_spread.max(size_spread) < UNIFORM;
                if is_uniform { "yes" } else { "no" }.into()
            }),
            ("wave", &|d| {
                let (wave, share) = d.hem.wave;
                format!("{wave} ({})", whole_percent(share)).into()
            }),
            ("internal DOF", &|d| d.internal.to_string().into()),
            ("drop", &|d| part(d.drop)),
            ("at rest from", &|d| {
                let time = d.run.summary.at_rest_from;
                time.map(|t| format!("{t:.1} s")).into()
            }),
        ],
    )
}
