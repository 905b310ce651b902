//! Fig. 14: a rectangular cloth on a rectangular table. Fig. 15: an octagonal one on an octagonal table, and
//! on towards the round.

use super::cloths::{Layout, irregular, octagon, polygon, rectangle, ringed};
use super::folds::{CornerFolds, Hem};
use super::show::View;
use super::{Effort, Made, Picture, Play, Table, whole_percent};
use crate::draw::{Viewpoint, mesh_name};
use crate::report::columns;
use crate::runs::{Ensemble, FigureScene, Run, about_ensembles, members};
use crate::store::Store;
use anyhow::{Result, bail, ensure};
use isosheet_mesh::{Dof, Sheet};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// What elastic tablecloths are made of. The bending length of this film, the third root of its rigidity over
/// its weight, is 5 cm: longer than the edges of the finer meshes, and a fifth of the overhang.
const PLASTIC: &str = "acetate film";

/// Times of the pictures, seconds.
const TIMES: [f64; 6] = [0.0, 0.15, 0.3, 0.6, 1.2, 8.0];

/// A cloth and its neighbours.
struct Draped {
    label: String,
    run: Run,
    all: Ensemble<Drapery>,
}

/// What is measured of a cloth at the end of its run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Drapery {
    folds: CornerFolds,
    hem: Hem,
    /// How far the hem hangs below the table, as part of its distance from the table in the flat cloth (means
    /// over the vertices of the hem): 1 for a cloth that hangs straight down.
    drop: f64,
}

impl Drapery {
    fn of(run: &Run) -> Result<Self> {
        let (sheet, x) = (&run.sheet, run.end());
        let layout = Layout::of(run.scene.scene())?;
        Ok(Self {
            folds: CornerFolds::of(sheet, x, &layout.table, &layout.cloth),
            hem: Hem::of(sheet, x),
            drop: drop(sheet, x, &layout),
        })
    }

    fn along(&self) -> f64 {
        self.folds.along as f64
    }

    fn folds(&self) -> f64 {
        self.hem.folds as f64
    }
}

/// A cloth of which the ensemble has so many members.
fn drape(label: &str, scene: FigureScene, members: usize, store: &Store) -> Result<Draped> {
    let run = Run::of(store, scene)?;
    Ok(Draped {
        label: label.into(),
        all: Ensemble::of(store, &run, members, Drapery::of)?,
        run,
    })
}

/// A cloth that is to be made: its name, its scene, and how many members its ensemble has.
type Planned = (String, FigureScene, usize);

/// Cloths of rods and the same of plastic, alternately.
fn of_both(scenes: Vec<Planned>, store: &Store) -> Result<Vec<Draped>> {
    let mut all = Vec::new();
    for (label, scene, members) in scenes {
        let elastic = scene.made_of(PLASTIC)?;
        for scene in [scene, elastic] {
            all.push(drape(&label, scene, members, store)?);
        }
    }
    Ok(all)
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
        let alt = format!(
            "{}: it is let go flat above a table, falls and drapes",
            self.name()
        );
        VIEW.picture(&self.run, effort, [file, &alt], &TIMES)
    }

    fn name(&self) -> String {
        format!("{}, {}", self.label, self.sheet())
    }

    fn sheet(&self) -> &str {
        self.run.scene.sheet_name()
    }

    /// Whether its lengths are kept by rods.
    fn is_of_rods(&self) -> bool {
        self.run.summary.elastic.is_none()
    }

    /// The number of corner lines along which folds may run.
    fn lines(&self) -> f64 {
        self.all.median(|d| d.folds.lines as f64)
    }

    /// Corner lines along which folds run, of how many, with the part that chance gives.
    fn along(&self) -> String {
        let along = self.all.spread(Drapery::along).text(count);
        let chance = whole_percent(self.all.median(|d| d.folds.part));
        format!("{along} of {} ({chance})", count(self.lines()))
    }

    fn percent(&self, value: impl Fn(&Drapery) -> f64) -> String {
        self.all.spread(value).text(whole_percent)
    }

    /// Internal degrees of freedom, which rods leave.
    fn internal(&self) -> Option<String> {
        let dof = Dof::of(self.run.sheet.topology()).internal;
        self.is_of_rods().then(|| dof.to_string())
    }
}

/// A number of folds, of which a median may be between two.
fn count(folds: f64) -> String {
    format!("{folds}")
}

/// How a cloth is shown.
const VIEW: View = View {
    from: Viewpoint {
        azimuth: -62.0,
        elevation: 24.0,
        distance: 6.0,
        depth: 0.4,
    },
    columns: 3,
    pins: Vec::new(),
    bodies: &[0],
};

/// The pages of some cloths.
fn pages(figure: u8, all: &[&Draped], effort: Effort) -> Result<Vec<Play>> {
    let of = |d: &&Draped| {
        let label = format!("draped cloth, {}", d.name());
        VIEW.play(&d.run, effort, figure, &label)
    };
    all.iter().map(of).collect()
}

/// The ends of cloths: rods in the first row, plastic below.
fn ends(file: &str, all: &[&Draped], effort: Effort) -> Result<Picture> {
    let of = |rods: bool| all.iter().filter(move |d| d.is_of_rods() == rods);
    let rows: Vec<_> = of(true)
        .chain(of(false))
        .map(|d| (d.name(), &d.run))
        .collect();
    let view = View {
        columns: rows.len() / 2,
        ..VIEW
    };
    let alt = format!("The cloths at rest: of rods in the first row, of {PLASTIC} in the second");
    view.ends(&rows, effort, [file, &alt])
}

/// The caption of a table of ensembles.
fn of_medians(about: &str) -> String {
    format!("{about} {}", about_ensembles())
}

fn fold_table(all: &[Draped]) -> Table {
    Table::of(
        of_medians(
            "Principal folds at rest. A fold runs along a corner line, from a table corner to its cloth corner, if the cloth is in the outer \
         half of a bulge there at all of three distances from the table (in brackets: the part of all directions from the axis in which it \
         is, which is what chance gives). Drop: how far the hem hangs below the table, of its distance from the table in the flat cloth. \
         Triangles whose edges keep their lengths leave a cloth only as many internal degrees of freedom as it has boundary edges less three: \
         it cannot shear as woven cloth does.",
        ),
        all,
        columns! { d;
            "cloth" => d.label.as_str(),
            "sheet" => d.sheet(),
            "V/F" => d.run.summary.mesh(),
            "mean edge, mm" => 1e3 * d.run.sheet.mean_length(),
            "internal DOF" => d.internal(),
            "runs" => d.all.len(),
            "folds along corner lines" => d.along(),
            "drop" => d.percent(|d| d.drop),
        },
    )
}

/// What holds for each run.
fn runs_table(all: &[&Draped]) -> Table {
    Table::of(
        CONDITIONS,
        all,
        columns! { d;
            "cloth" => d.label.as_str(),
            "sheet" => d.sheet(),
            "V/F" => d.run.summary.mesh(),
            "at rest from" => d.run.summary.at_rest_from.map(|t| format!("{t:.1} s")),
            "kinetic energy left" => format!("{:.0e}", d.run.summary.motion_left),
            "CPU s per simulated s" => d.run.summary.course.cpu_rate(),
            "factorisations per frame" => d.run.summary.course.cost.factorisations_per_step(),
            "largest strain" => format!("{:.0e}", d.run.summary.strain()),
            "membrane stiffness" => d.run.summary.stiffness(),
            "smallest gap" => super::gap(d.run.summary.course.gap),
        },
    )
}

const CONDITIONS: &str = "Rods of 0.2 kg/m², films of their own mass, velocity damping 2/s, friction 0.3 with the table and itself, self-contact on, gap below which contact acts 5 mm; \
                          let go exactly flat 5 mm above the table, 8 s. At rest: kinetic energy below 1e-6 of the potential energy released, to the end of the run.";

pub(super) fn fig14(store: &Store) -> Result<Made> {
    let effort = store.effort;
    let levels = effort.quick_or(&[2, 1][..], &[2, 3, 4]);
    let mut scenes = Vec::new();
    for &level in levels {
        let scene = rectangle(level, effort)?;
        scenes.push((mesh_name(level), scene, members(effort)));
    }
    scenes.push(("irregular".to_owned(), irregular(effort)?, members(effort)));
    let all = of_both(scenes, store)?;
    let each: Vec<&Draped> = all.iter().collect();
    // Of ensembles: a single drape says little.
    if effort == Effort::Full {
        check_corners(&each[2 * levels.len() - 2..2 * levels.len()])?;
    }
    Ok(Made {
        title: "Rectangular cloth on a rectangular table",
        paper: "A rectangular plastic tablecloth is draped over a rectangular table with M², and with a second resolution: the principal folds run from \
                the table corners to the cloth corners.",
        here: "The paper's own model, rods that do not resist bending, has such folds at one or two of the four corners, at others in \
               every run; the regular meshes have diagonals through the corners of the table that could favour what is to be shown, and \
               the irregular triangulation has none. On the finest regular mesh of acetate film, an elastic sheet that resists \
               bending (the second sequence), folds run along most of these lines, and more than of rods.",
        pictures: vec![
            all[0].picture("fig14.png", effort)?,
            all[2 * levels.len() - 1].picture("fig14-elastic.png", effort)?,
            ends("fig14-ends.png", &each, effort)?,
        ],
        pages: pages(14, &each, effort)?,
        tables: vec![fold_table(&all), runs_table(&each)],
    })
}

/// What is seen of the folds of film where the mesh is fine enough, on the finest regular mesh of the
/// rectangle and on the finer octagons: they run along most corner lines, and along more than folds of rods.
/// Cloths of rods and of film by turns.
fn check_corners(fine: &[&Draped]) -> Result<()> {
    for pair in fine.chunks(2) {
        let [rods, film] = pair else {
            bail!("there is no film of {}", pair[0].name());
        };
        let along = [rods, film].map(|d| d.all.median(Drapery::along));
        ensure!(
            along[1] > 0.5 * film.lines() && along[1] > along[0],
            "folds of rods and of {} run along {along:?} of {} corner lines",
            film.name(),
            film.lines()
        );
    }
    Ok(())
}

/// What is seen of the folds: on the roundest cloth with the finest mesh folds of film are more uniform than
/// folds of rods.
fn check_folds(irregular: &[Draped]) -> Result<()> {
    let [.., rods, film] = irregular else {
        bail!("there are no irregular meshes");
    };
    let spreads = |d: &Draped| {
        [
            d.all.median(|d| d.hem.spacing_spread),
            d.all.median(|d| d.hem.size_spread),
        ]
    };
    let [rods, film] = [rods, film].map(spreads);
    ensure!(
        film[0] < rods[0] && film[1] < rods[1],
        "spacing and size of folds of rods spread by {rods:?}, those of film by {film:?}"
    );
    Ok(())
}

/// Corners and rings of the polygons with about as many faces as the octagon, whose rings are as wide as the
/// cells of M³.
const RINGS: [(u32, u32); 5] = [(4, 11), (6, 9), (8, 8), (12, 7), (16, 6)];

/// Corners of the irregular polygons of the study; 48 stand for the circle.
const SIDES: [u32; 5] = [4, 6, 8, 12, 16];

/// Members of the ensembles of Fig. 15 but of those with the smallest meshes: with all of them the figure
/// would take a quarter of an hour.
const FEW: usize = 4;

/// Polygons that the picture shows.
const SHOWN: [&str; 4] = ["n = 4", "n = 8", "n = 16", "round, finer"];

/// The octagons, and the polygons with more and more corners.
fn fig15_cloths(store: &Store) -> Result<[Vec<Draped>; 2]> {
    let effort = store.effort;
    let fine = |name: &str, spacing| {
        let name = format!("drape-octagon-{name}");
        polygon(&name, 8, effort.quick_or(0.2, spacing), effort)
    };
    let (many, few) = (members(effort), members(effort).min(FEW));
    let mut octagons = vec![
        ("244/440".to_owned(), octagon(effort)?, many),
        ("finer".to_owned(), fine("fine", 0.045)?, few),
    ];
    if effort != Effort::Quick {
        octagons.push(("finest".to_owned(), fine("finest", 0.03)?, few));
    }
    octagons.push(("rings".to_owned(), ringed(8, RINGS[2].1, effort)?, many));
    let irregular = |n: u32, spacing| {
        let name = format!("drape-{n}-gon");
        polygon(&name, n, effort.quick_or(0.2, spacing), effort)
    };
    let mut polygons = Vec::new();
    for &n in effort.quick_or(&SIDES[..1], &SIDES) {
        polygons.push((format!("n = {n}"), irregular(n, 0.06)?, few));
    }
    if effort != Effort::Quick {
        polygons.push(("round".to_owned(), irregular(48, 0.06)?, few));
        let finer = polygon("drape-48-gon-finer", 48, 0.03, effort)?;
        polygons.push(("round, finer".to_owned(), finer, few));
    }
    for &(n, rings) in effort.quick_or(&RINGS[2..3], &RINGS) {
        // The octagon has as many as above.
        let members = if n == 8 { many } else { few };
        polygons.push((
            format!("n = {n}, rings"),
            ringed(n, rings, effort)?,
            members,
        ));
    }
    Ok([of_both(octagons, store)?, of_both(polygons, store)?])
}

pub(super) fn fig15(store: &Store) -> Result<Made> {
    let effort = store.effort;
    let [octagons, polygons] = fig15_cloths(store)?;
    // Some cloths belong to more than one group.
    let mut seen = BTreeSet::new();
    let mut all: Vec<&Draped> = octagons.iter().chain(&polygons).collect();
    all.retain(|d| seen.insert(d.run.scene.name()));
    let irregular = polygons.iter().take_while(|d| !d.label.ends_with("rings"));
    let irregular = &polygons[..irregular.count()];
    let is_shown = |d: &&Draped| SHOWN.contains(&d.label.as_str());
    let shown: Vec<&Draped> = polygons.iter().filter(is_shown).collect();
    if effort == Effort::Full {
        let finer = octagons.iter().filter(|d| d.label.starts_with("fine"));
        check_corners(&finer.collect::<Vec<_>>())?;
        check_folds(irregular)?;
    }
    Ok(Made {
        title: "Octagonal cloth on an octagonal table",
        paper: "An octagonal plastic tablecloth (244/440) is draped over an octagonal table: principal folds run from table corners to cloth corners, and for \
                more and more corners the paper infers that uniform folding patterns will occur.",
        here: "The paper's own model, rods that do not resist bending, has such folds at some of the corners; in the irregular \
               meshes and in 244/440, a lattice of triangles, no mesh line runs from a table corner to its cloth corner, and in \
               the meshes of concentric rings some do. On the finer meshes of acetate film (the second sequence) folds run along most of these \
               lines, and on round cloths its folds are more evenly spaced and more alike than those of rods.",
        pictures: vec![
            octagons[0].picture("fig15.png", effort)?,
            // The last ones are the rings.
            octagons[octagons.len() - 3].picture("fig15-elastic.png", effort)?,
            ends(
                "fig15-ends.png",
                &octagons.iter().collect::<Vec<_>>(),
                effort,
            )?,
            ends("fig15-polygons.png", &shown, effort)?,
        ],
        pages: pages(15, &all, effort)?,
        tables: vec![
            fold_table(&octagons),
            hem_table(&polygons),
            runs_table(&all),
        ],
    })
}

fn hem_table(all: &[Draped]) -> Table {
    Table::of(
        of_medians(
            "Polygonal cloths on polygonal tables, irregular meshes of one spacing and meshes of rings: folds of the hem at rest. Spreads are \
         standard deviations over means, of the angles between neighbouring folds and of how far the folds stand out: both are 0 for a \
         uniform pattern. Folds are outward bulges of the hem's distance from the axis, divided by that of the flat cloth, that stand out by \
         more than 0.02 of that distance.",
        ),
        all,
        columns! { d;
            "cloth" => d.label.as_str(),
            "sheet" => d.sheet(),
            "V/F" => d.run.summary.mesh(),
            "mean edge, mm" => 1e3 * d.run.sheet.mean_length(),
            "internal DOF" => d.internal(),
            "runs" => d.all.len(),
            "folds" => d.all.spread(Drapery::folds).text(count),
            "along corner lines" => d.along(),
            "spread of spacing" => d.percent(|d| d.hem.spacing_spread),
            "spread of size" => d.percent(|d| d.hem.size_spread),
            "drop" => d.percent(|d| d.drop),
        },
    )
}
