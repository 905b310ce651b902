//! Fig. 14: a rectangular cloth on a rectangular table. Fig. 15: an octagonal one on an octagonal table, and
//! on towards the round.

use super::cloths::{Layout, irregular, octagon, polygon, rectangle, ringed};
use super::folds::{Folds, Hem};
use super::play::play;
use super::sequence::{View, choose, sequence};
use super::{Context, Made, Picture, Play, RenderEffort, Table};
use crate::draw::{Axis, Legend, Line, Marker, Plot, Series, palette, row};
use crate::runs::{self, FigureScene, RunSummary};
use anyhow::{Context as _, Result};
use isosheet_mesh::{Dof, Sheet};
use serde_json::{Value, json};

/// Times of the pictures, seconds.
const TIMES: [f64; 6] = [0.0, 0.15, 0.3, 0.6, 1.2, 8.0];

/// A cloth at the end of its run.
struct Draped {
    label: String,
    scene: FigureScene,
    run: RunSummary,
    folds: Folds,
    hem: Hem,
    /// How far the hem hangs below the table, as part of its distance from the table in the flat cloth (means
    /// over the vertices of the hem): 1 for a cloth that hangs straight down.
    drop: f64,
    /// Internal degrees of freedom.
    internal: i64,
}

fn drape(label: &str, scene: FigureScene, context: &Context<'_>) -> Result<Draped> {
    let run = runs::ensure(context.store, &scene)?;
    let sheet = scene.sheet()?;
    let trajectory = runs::trajectory(context.store, &scene)?;
    let x = trajectory
        .frame(trajectory.len() - 1)
        .context("last frame")?;
    let layout = Layout::of(scene.scene())?;
    Ok(Draped {
        label: label.into(),
        folds: Folds::of(&sheet, x, &layout.table, &layout.cloth),
        hem: Hem::of(&sheet, x),
        drop: drop(&sheet, x, &layout),
        internal: Dof::of(sheet.topology()).internal,
        run,
        scene,
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
    fn picture(&self, file: &str, context: &Context<'_>) -> Result<Picture> {
        let trajectory = runs::trajectory(context.store, &self.scene)?;
        let frames = choose(&trajectory, &TIMES);
        Ok(Picture {
            file: file.into(),
            alt: format!(
                "{}: it is let go flat above a table, falls and drapes",
                self.label
            ),
            bytes: sequence(&self.scene, &trajectory, &frames, &VIEW, context.effort)?,
        })
    }

    fn facts(&self) -> Value {
        json!({ "run": self.run, "folds": self.folds, "drop": self.drop, "internal_dof": self.internal, "hem": {
            "folds": self.hem.folds, "spacing_spread": self.hem.spacing_spread, "size_spread": self.hem.size_spread, "wave": self.hem.wave,
        } })
    }
}

/// How a cloth is shown.
const VIEW: View<'static> = View {
    azimuth: -62.0,
    elevation: 24.0,
    distance: 6.0,
    columns: 3,
    pins: &[],
    bodies: &[0],
    depth: 0.4,
};

/// The page that plays the run of a cloth.
pub(super) fn page(
    figure: u8,
    label: &str,
    scene: &FigureScene,
    context: &Context<'_>,
) -> Result<Play> {
    let free = if scene.scene().contact.self_contact {
        ""
    } else {
        ", passing through itself"
    };
    let label = format!("draped cloth, {}{free}", label.replace('~', ""));
    play(figure, &label, scene, &VIEW, context)
}

/// The pages of some cloths; one that is there twice has a single page.
fn pages<'a>(
    figure: u8,
    all: impl Iterator<Item = &'a Draped>,
    context: &Context<'_>,
) -> Result<Vec<Play>> {
    let mut pages: Vec<Play> = Vec::new();
    let mut played: Vec<&str> = Vec::new();
    for d in all {
        if !played.contains(&d.scene.name()) {
            played.push(d.scene.name());
            pages.push(page(figure, &d.label, &d.scene, context)?);
        }
    }
    Ok(pages)
}

fn percent(v: f64) -> String {
    format!("{:.0} %", 100.0 * v)
}

fn fold_table(all: &[Draped]) -> Table {
    let rows = all.iter().map(|d| {
        let f = &d.folds;
        vec![
            d.label.clone(),
            format!("{}/{}", d.run.vertices, d.run.faces),
            percent(f.share_at_corners),
            percent(f.length_at_corners),
            format!("{:.1}", f.density_at_corners),
            format!("{} of {}", f.strongest[1], f.strongest[0]),
            format!("{:.0}° ({:.0}°)", f.angle[0], f.angle[1]),
            d.internal.to_string(),
            percent(d.drop),
        ]
    });
    Table::new("Principal folds at rest, in the part of the cloth that hangs beyond the first row of cells at the table's edge. Bending is edge length \
                  times size of the fold angle. At the corners: within one mean edge of a line from a table corner to its cloth \
                  corner. Strongest edges: the fewest that carry half of the bending. Angle with the nearest of these \
                  lines: weighted by bending (in brackets: of all edges, what the mesh alone gives). Drop: how far the hem hangs below the table, of its distance \
                  from the table in the flat cloth.", &["cloth", "V/F", "bending at the corners", "edges there", "density, all = 1", "strongest edges there", "angle", "internal DOF", "drop"]).with_texts(rows)
}

/// Bending at the corner lines that is this many times as dense as on the mean of the overhang makes
/// principal folds.
const PRINCIPAL: f64 = 1.25;

/// Whether folds gather at the corners, in words.
fn at_corners(all: &[Draped]) -> String {
    let list = |principal: bool| {
        let with = all
            .iter()
            .filter(|d| (d.folds.density_at_corners >= PRINCIPAL) == principal);
        let names: Vec<String> = with
            .map(|d| format!("{} ({:.1})", d.label, d.folds.density_at_corners))
            .collect();
        names.join(", ")
    };
    let (yes, no) = (list(true), list(false));
    let none = "none of them".to_owned();
    let gathered = if yes.is_empty() { &none } else { &yes };
    let rest = if no.is_empty() {
        String::new()
    } else {
        format!("; hardly so: {no}")
    };
    format!(
        "Principal folds from table corners to cloth corners, with bending at least {PRINCIPAL} times as dense as on the mean of the overhang: {gathered}{rest}."
    )
}

/// Why these cloths hang less steeply than woven ones, in words.
fn locking<'a>(all: impl Iterator<Item = &'a Draped>) -> String {
    let (mut dof, mut drop) = ([i64::MAX, 0], [f64::INFINITY, 0.0_f64]);
    for d in all {
        dof = [dof[0].min(d.internal), dof[1].max(d.internal)];
        drop = [drop[0].min(d.drop), drop[1].max(d.drop)];
    }
    format!(
        "Triangles whose edges keep their lengths leave a cloth only as many internal degrees of freedom as it has boundary edges less three, here {} to {}: \
         it cannot shear as woven cloth does, and its hem hangs by {} to {} of what it could.",
        dof[0],
        dof[1],
        percent(drop[0]),
        percent(drop[1])
    )
}

/// Bending density by distance from the corner lines.
fn profiles(all: &[Draped]) -> Plot {
    let looks = [
        (palette::VERMILION, Marker::Square),
        (palette::BLUE, Marker::Disc),
        (palette::GREEN, Marker::Triangle),
        (palette::ORANGE, Marker::Diamond),
    ];
    let all_points = || all.iter().flat_map(|d| &d.folds.profile);
    let far = all_points().map(|p| p[0] + 0.5).fold(1.0, f64::max);
    let top = 1.1 * all_points().map(|p| p[1]).fold(1.0, f64::max);
    Plot {
        x: Axis::round(
            "distance from the nearest corner line (mean edges)",
            [0.0, far],
            6,
        ),
        y: Axis::round("bending (mean = 1)", [0.0, top], 4),
        size: [230.0, 130.0],
        series: all
            .iter()
            .zip(looks)
            .map(|(d, (colour, marker))| Series {
                name: d.label.clone(),
                points: d.folds.profile.clone(),
                colour,
                marker: Some(marker),
                line: Line::Solid,
            })
            .collect(),
        legend: Legend::Right,
    }
}

/// What holds for a run, in words.
fn describe(d: &Draped, effort: RenderEffort) -> String {
    let r = &d.run;
    let rest = match (r.at_rest_from, effort) {
        (Some(t), _) => format!("at rest from {t:.1} s on"),
        (None, RenderEffort::Quick) => "cut short".to_owned(),
        (None, RenderEffort::Full) => format!(
            "kinetic energy at the end {:.0e} of the potential energy released",
            r.motion_left
        ),
    };
    format!(
        "{}: {rest}, {:.2} s of wall time per simulated second, largest strain {:.0e}, smallest gap {}.",
        d.label,
        r.slowness(),
        r.max_strain,
        super::gap(r.smallest_gap),
    )
}

const CONDITIONS: &str = "Cloth of 0.2 kg/m², velocity damping 2/s, friction 0.3 with the table and itself, self-contact on, gap below which contact acts 5 mm; \
                          let go exactly flat 5 mm above the table, 8 s. At rest: kinetic energy below 1e-6 of the potential energy released, to the end of the run. ";

pub(super) fn fig14(context: &Context<'_>) -> Result<Made> {
    let effort = context.effort;
    let fine = if effort == RenderEffort::Full { 3 } else { 1 };
    let all = vec![
        drape("M²", rectangle(2, effort)?, context)?,
        drape(
            if fine == 3 { "M³" } else { "M¹" },
            rectangle(fine, effort)?,
            context,
        )?,
        drape("irregular", irregular(effort)?, context)?,
    ];
    let alt = "How the bending of the overhang depends on the distance from the lines from table corners to cloth corners";
    let words: Vec<String> = all.iter().map(|d| describe(d, effort)).collect();
    Ok(Made {
        title: "Rectangular cloth on a rectangular table",
        paper: "A rectangular plastic tablecloth draped over a rectangular table with M², and with a second resolution: the principal folds run from the \
                table corners to the cloth corners.",
        measured: format!(
            "{CONDITIONS}The cloth is 1.2 m x 0.9 m, the table 0.58 m x 0.435 m. The diagonals of M^k lead through the corners of the table, so the \
             mesh could favour what is to be shown: an irregular triangulation, which has no such lines, is the check. {} {} {}",
            at_corners(&all),
            locking(all.iter()),
            words.join(" ")
        ),
        pictures: vec![
            all[0].picture("fig14.png", context)?,
            all[1].picture("fig14-fine.png", context)?,
            all[2].picture("fig14-irregular.png", context)?,
            Picture {
                file: "fig14-folds.svg".into(),
                alt: alt.into(),
                bytes: profiles(&all).draw().to_svg(alt)?.into_bytes(),
            },
        ],
        pages: pages(14, all.iter(), context)?,
        tables: vec![fold_table(&all)],
        facts: json!(all.iter().map(Draped::facts).collect::<Vec<_>>()),
    })
}

/// Corners and rings of the polygons with about as many faces as the octagon, whose rings are as wide as the
/// cells of M³.
const RINGS: [(u32, u32); 5] = [(4, 11), (6, 9), (8, 8), (12, 7), (16, 6)];

/// Corners of the irregular polygons of the study; the last stands for the circle.
const SIDES: [u32; 6] = [4, 6, 8, 12, 16, 48];

pub(super) fn fig15(context: &Context<'_>) -> Result<Made> {
    let effort = context.effort;
    let fine = if effort == RenderEffort::Full {
        0.045
    } else {
        0.2
    };
    let octagons = vec![
        drape("244/440", octagon(effort)?, context)?,
        drape(
            "finer",
            polygon("drape-octagon-fine", 8, fine, effort)?,
            context,
        )?,
        drape("rings", ringed(8, RINGS[2].1, effort)?, context)?,
    ];
    let mut polygons = Vec::new();
    let (sides, spacing): (&[u32], f64) = match effort {
        RenderEffort::Full => (&SIDES, 0.06),
        RenderEffort::Quick => (&SIDES[..1], 0.2),
    };
    for n in sides {
        let label = if *n == 48 {
            "round".to_owned()
        } else {
            format!("~n~ = {n}")
        };
        polygons.push(drape(
            &label,
            polygon(&format!("drape-{n}-gon"), *n, spacing, effort)?,
            context,
        )?);
    }
    let round = polygons.len() - 1;
    let of_rings = match effort {
        RenderEffort::Full => &RINGS[..],
        RenderEffort::Quick => &RINGS[2..3],
    };
    for &(n, rings) in of_rings {
        let label = format!("~n~ = {n}, rings");
        polygons.push(drape(&label, ringed(n, rings, effort)?, context)?);
    }
    let hem = hems(&polygons);
    let alt = "Distance of the hem from the axis, that of the flat cloth = 1, by angle, for polygons with more and more corners";
    let folds_alt = "How the bending of the overhang depends on the distance from the lines from table corners to cloth corners";
    let words: Vec<String> = octagons
        .iter()
        .chain(&polygons)
        .map(|d| describe(d, effort).replace('~', ""))
        .collect();
    Ok(Made {
        title: "Octagonal cloth on an octagonal table",
        paper: "An octagonal plastic tablecloth (244/440) draped over an octagonal table, with two resolutions: principal folds from table corners to cloth corners. For n-gonal \
                cloths on n-gonal tables with more and more corners the paper infers that uniform folding patterns will occur.",
        measured: format!(
            "{CONDITIONS}Cloths of circumscribed radius 0.6 m on tables of 0.33 m. Folds of the hem are outward bulges of its distance from the axis, divided by that of the flat cloth, that stand out by more than 0.02. A cloth folds along mesh lines: in the irregular triangulations and in 244/440, \
             a lattice of triangles, none runs from a table corner to its cloth corner; the last mesh, concentric rings of triangles, has these lines among its edges. {} {} {} {}",
            at_corners(&octagons),
            uniform(&polygons),
            locking(octagons.iter().chain(&polygons)),
            words.join(" ")
        ),
        pictures: vec![
            octagons[0].picture("fig15.png", context)?,
            octagons[1].picture("fig15-fine.png", context)?,
            Picture {
                file: "fig15-folds.svg".into(),
                alt: folds_alt.into(),
                bytes: profiles(&octagons).draw().to_svg(folds_alt)?.into_bytes(),
            },
            octagons[2].picture("fig15-rings.png", context)?,
            polygons[round].picture("fig15-round.png", context)?,
            Picture {
                file: "fig15-hems.svg".into(),
                alt: alt.into(),
                bytes: hem.to_svg(alt)?.into_bytes(),
            },
        ],
        pages: pages(15, octagons.iter().chain(&polygons), context)?,
        tables: vec![fold_table(&octagons), hem_table(&polygons)],
        facts: json!({
            "octagons": octagons.iter().map(Draped::facts).collect::<Vec<_>>(),
            "polygons": polygons.iter().map(Draped::facts).collect::<Vec<_>>(),
        }),
    })
}

/// Spacing and size of folds that spread by less than this part of their means make a uniform pattern.
const UNIFORM: f64 = 0.2;

/// Whether the folds become uniform towards the round cloth, in words.
fn uniform(all: &[Draped]) -> String {
    let even = |d: &&Draped| {
        d.hem.folds > 1 && d.hem.spacing_spread < UNIFORM && d.hem.size_spread < UNIFORM
    };
    let names: Vec<String> = all
        .iter()
        .filter(even)
        .map(|d| d.label.replace('~', ""))
        .collect();
    let which = if names.is_empty() {
        "none of them".to_owned()
    } else {
        names.join(", ")
    };
    format!(
        "Patterns whose folds are spaced and sized alike to {}: {which}.",
        percent(UNIFORM)
    )
}

/// The hems of the polygons, one small plot each.
fn hems(all: &[Draped]) -> crate::draw::Drawing {
    let plots: Vec<_> = all
        .iter()
        .map(|d| {
            let ticks = [0.0, 180.0, 360.0].map(|a| (a, format!("{a:.0}")));
            Plot {
                x: Axis::linear(
                    &format!("angle (°), {}", d.label),
                    [0.0, 360.0],
                    ticks.to_vec(),
                ),
                y: Axis::round("distance", [0.5, 1.0], 3),
                size: [120.0, 60.0],
                series: vec![Series {
                    name: String::new(),
                    points: d.hem.curve.clone(),
                    colour: palette::BLUE,
                    marker: None,
                    line: Line::Solid,
                }],
                legend: Legend::None,
            }
            .draw()
        })
        .collect();
    let rows: Vec<_> = plots.chunks(3).map(|c| row(c, 20.0)).collect();
    crate::draw::column(&rows, 16.0)
}

fn hem_table(all: &[Draped]) -> Table {
    let rows = all.iter().map(|d| {
        let h = &d.hem;
        vec![
            d.label.replace('~', ""),
            format!("{}/{}", d.run.vertices, d.run.faces),
            h.folds.to_string(),
            percent(h.spacing_spread),
            percent(h.size_spread),
            format!("{} ({})", h.wave.0, percent(h.wave.1)),
            d.internal.to_string(),
            percent(d.drop),
            d.run
                .at_rest_from
                .map_or("–".into(), |t| format!("{t:.1} s")),
        ]
    });
    Table::new("Polygonal cloths on polygonal tables, irregular meshes of one spacing and meshes of rings: folds of the hem at rest. Spreads are standard deviations over means, of \
                  the angles between neighbouring folds and of how far the folds stand out: both are 0 for a uniform pattern. Wave: the wave number with the \
                  largest part of the variance of the hem's relative distance from the axis, and that part.", &["cloth", "V/F", "folds", "spread of spacing", "spread of size", "wave", "internal DOF", "drop", "at rest from"]).with_texts(rows)
}
