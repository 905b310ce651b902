//! Single everyday scenes with paper.

use super::Findings;
use super::dots::{Dot, Figure, Panel};
use super::isometry::{Isometry, Material, PAPER_RIGIDITY};
use super::meshes::vertices;
use super::records::Records;
use super::sample::{Sample, requirements};
use super::scene::Scene;
use crate::draw::{Axis, Charts, superscript};
use crate::report::{Effort, Table};
use crate::runs::Plan;
use anyhow::Result;
use isosheet_dynamics::{PointProfile, Profile, SheetModel};
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::fmt;

pub(super) const ABOUT: &str = "Paper of 80 g/m² with a flexural rigidity of 5e-4 N m, damping 2/s, in steps of 1/60 s by the default method. \
    Pushed together: a flat strip of 0.30 m x 0.10 m, the first and the last row of squares clamped, one of them moved by 10 % of the free length within 1 s; it has to buckle. \
    Roll: a sheet of 0.30 m x 0.20 m that starts as a roll of radius 0.05 m about mesh lines, one edge clamped, is let go. Banner: a square of 1 m, flat and \
    horizontal, is held at the two corners of one side and swings down. Opposite corners: the same square is held at two opposite corners at their distance in the flat state.";

/// Mass per area of office paper, kg/m2.
const DENSITY: f64 = 0.08;

/// Rate of damping, 1/s.
const DAMPING: f64 = 2.0;

/// Radius of the roll, metres.
const ROLL: f64 = 0.05;

/// Part of its free length by which the strip is pushed together.
const PUSH: f64 = 0.1;

/// A kind of scene, in the order of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Kind {
    Pushed,
    Roll,
    Banner,
    Corners,
}

/// Their names.
const KINDS: [&str; 4] = ["pushed together", "roll", "banner", "opposite corners"];

/// A scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Everyday {
    kind: Kind,
    /// Squares across, or the level of the mesh.
    size: u32,
}

impl fmt::Display for Everyday {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, size) = (KINDS[self.kind as usize], self.size);
        match self.kind {
            Kind::Pushed | Kind::Roll => write!(f, "{name}, {size} squares across"),
            Kind::Banner => write!(f, "{name} M^{size}"),
            Kind::Corners => write!(f, "{name}, M^{size}"),
        }
    }
}

impl Everyday {
    fn all(effort: Effort) -> Vec<Self> {
        let across: &[u32] = effort.quick_or(&[2], &[2, 4]);
        let levels: &[u32] = effort.quick_or(&[1], &[1, 2, 3]);
        let sizes = [
            (Kind::Pushed, across),
            (Kind::Roll, across),
            (Kind::Banner, levels),
            (Kind::Corners, levels),
        ];
        let of = |(kind, sizes): (Kind, &[u32])| {
            let of_size = |&size: &u32| Self { kind, size };
            sizes.iter().map(of_size).collect::<Vec<_>>()
        };
        sizes.into_iter().flat_map(of).collect()
    }

    /// The flat sheet in its plane of reference, z = 0.
    fn sheet(self) -> Result<Sheet> {
        let n = self.size as usize;
        Ok(match self.kind {
            Kind::Pushed => generate::grid(3 * n, n, 0.3, 0.1, Diagonals::UnionJack)?,
            Kind::Roll => generate::grid(6 * n, 2 * n, 0.3, 0.2, Diagonals::UnionJack)?,
            Kind::Banner | Kind::Corners => generate::isotropic_square(self.size, 1.0)?,
        })
    }

    /// Positions at the start.
    fn start(self, sheet: &Sheet) -> Vec<f64> {
        match self.kind {
            Kind::Roll => rolled(sheet),
            _ => sheet.positions().to_vec(),
        }
    }

    /// The vertices of faces that are clamped.
    fn clamp(self, sheet: &Sheet) -> Vec<VertexId> {
        let second = sheet.position(VertexId(1))[0];
        match self.kind {
            Kind::Pushed => vertices(sheet, |[x, ..]| {
                x < second + 1e-9 || x > 0.3 - second - 1e-9
            }),
            Kind::Roll => vertices(sheet, |[x, ..]| x < second + 1e-9),
            Kind::Banner | Kind::Corners => Vec::new(),
        }
    }

    fn model(self, isometry: Isometry, sheet: &Sheet) -> Result<SheetModel> {
        let clamp = self.clamp(sheet);
        let material = Material::plate(sheet, DENSITY, PAPER_RIGIDITY, &clamp);
        let model = isometry
            .model(sheet, material)?
            .with_gravity()
            .with_damping(DAMPING)?;
        let held = |x: f64, y: f64| match self.kind {
            Kind::Banner => y > 1.0 - 1e-9 && (x - 0.5).abs() > 0.5 - 1e-9,
            _ => (x + y - 1.0).abs() > 1.0 - 1e-9,
        };
        Ok(match self.kind {
            Kind::Pushed => pushed(model, sheet)?,
            Kind::Roll => model.with_pins(&clamp)?,
            _ => model.with_pins(&vertices(sheet, |[x, y, _]| held(x, y)))?,
        })
    }
}

/// Both ends of the strip clamped, the right one moving.
fn pushed(model: SheetModel, sheet: &Sheet) -> Result<SheetModel> {
    let second = sheet.position(VertexId(1))[0];
    let mut model = model.with_pins(&vertices(sheet, |[x, ..]| x < second + 1e-9))?;
    for v in vertices(sheet, |[x, ..]| x > 0.3 - second - 1e-9) {
        let push = PointProfile {
            offset: sheet.position(v),
            x: Profile::SmoothStep {
                from: 0.0,
                to: -PUSH * (0.3 - 2.0 * second),
                begin: 0.0,
                end: 1.0,
            },
            ..PointProfile::default()
        };
        model = model.with_moving_pin(v, push)?;
    }
    Ok(model)
}

/// The sheet of a grid rolled up about lines x = constant of the mesh: a prism with a panel for each column,
/// which has all lengths exactly. The first panel stays where it is.
fn rolled(sheet: &Sheet) -> Vec<f64> {
    let panel = sheet.position(VertexId(1))[0];
    let turn = 2.0 * (0.5 * panel / ROLL).asin();
    let place = |column: usize| -> [f64; 2] {
        let mut p = [0.0, 0.0];
        for k in 0..column {
            let (s, c) = (turn * k as f64).sin_cos();
            p = [p[0] + panel * c, p[1] + panel * s];
        }
        p
    };
    let points = sheet.positions().as_chunks::<3>().0;
    points
        .iter()
        .flat_map(|[x, y, _]| {
            let [a, b] = place((x / panel).round() as usize);
            [a, *y, b]
        })
        .collect()
}

/// Heights of the lowest and the highest vertex (metres), and energy of bending (joules) at the end.
type Day = Sample<Everyday, ([f64; 2], f64)>;

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let duration = effort.quick_or(0.5, 3.0);
    let plan = Plan::new(1.0 / 60.0, duration).within(effort.quick_or(0.3, 40.0));
    let scenes = Everyday::all(effort);
    let all = records.of_models(
        |_| scenes.clone(),
        |isometry, &scene| {
            let sheet = scene.sheet()?;
            let model = scene.model(isometry, &sheet)?;
            let start = scene.start(&sheet);
            let (course, end) = Scene::flat(model, &sheet).from(start).run(&plan)?;
            let bending = (PAPER_RIGIDITY, &*scene.clamp(&sheet));
            let bending = isometry.bending_energy(&sheet, bending, &end.x)?;
            let measured = (end.heights(), bending);
            Ok((sheet.topology().vertex_count(), course, measured))
        },
    )?;
    let targets = requirements(&all, |of| {
        let ended = Some(of.share_that_ends());
        let ended = of.at_least("part of the scenes that run to their end", 1.0, ended);
        vec![ended, of.strain()]
    });
    let findings = Findings {
        tables: vec![table(&all, &plan)],
        targets,
        ..Findings::default()
    };
    Ok((findings, Some(plot(&all, &scenes))))
}

fn table(all: &[Day], plan: &Plan) -> Table {
    Table::of(
        format!(
            "Everyday scenes: {} s simulated, at most {} s of wall time. The energy of bending is that at the end",
            plan.duration,
            plan.patience
        ),
        all,
        &[
            ("scene", &|d| d.job.to_string().into()),
            ("V", &|d| d.vertices.into()),
            ("model", &|d| d.isometry.to_string().into()),
            ("ending", &|d| d.course.ending.name().into()),
            ("t at the end, s", &|d| d.course.time.into()),
            ("factorisations per step", &|d| d.course.cost.factorisations_per_step().into()),
            ("CPU s per simulated s", &|d| d.course.cpu_rate().into()),
            ("most in a step", &|d| d.course.worst.into()),
            ("lowest vertex, m", &|d| d.measured.0[0].into()),
            ("highest vertex, m", &|d| d.measured.0[1].into()),
            ("energy of bending, J", &|d| d.measured.1.into()),
            ("strain", &|d| d.course.strain.into()),
            ("wall time, s", &|d| d.course.cost.wall.into()),
            ("message", &|d| d.course.ending.message().into()),
        ],
    )
    .named("everyday")
}

/// Factorisations a step of every scene, by the default method.
fn plot(all: &[Day], scenes: &[Everyday]) -> Charts {
    let dots = all.iter().filter_map(|d| {
        let scene = d.job;
        let place = scenes.iter().position(|s| *s == scene)?;
        Some(Dot::of(d, scene.kind as usize, place as f64, d.cost()))
    });
    let ticks = scenes.iter().enumerate().map(|(k, scene)| {
        let size = scene.size;
        let name = match scene.kind {
            Kind::Pushed | Kind::Roll => size.to_string(),
            Kind::Banner | Kind::Corners => format!("M{}", superscript(size)),
        };
        (k as f64, name)
    });
    let range = [-0.7, scenes.len() as f64 - 0.3];
    let x = Axis::named("squares across, or mesh", range, ticks.collect());
    let y = Axis::decades("factorisations a step", all.iter().filter_map(Day::cost));
    let panel = Panel::new("Everyday scenes", dots.collect());
    let kinds = KINDS.map(str::to_owned).to_vec();
    Figure::of_row(x, y, vec![panel], kinds, [260.0, 150.0]).draw()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_starts_with_its_lengths_and_pins() {
        for everyday in Everyday::all(Effort::Full) {
            let sheet = everyday.sheet().unwrap();
            let model = everyday.model(Isometry::Rods, &sheet).unwrap();
            let start = everyday.start(&sheet);
            let strain = model.rods().max_strain(&start);
            assert!(strain < 1e-13, "{everyday}: {strain}");
            let n = everyday.size as usize;
            let pins = match everyday.kind {
                Kind::Pushed => 2 * 2 * (n + 1),
                Kind::Roll => 2 * (2 * n + 1),
                Kind::Banner | Kind::Corners => 2,
            };
            assert_eq!(model.pins().len(), pins, "{everyday}");
        }
    }

    /// A regular polygon about a circle of the radius: all corners are at the same distance of its centre.
    #[test]
    fn the_roll_is_a_prism() {
        let (kind, size) = (Kind::Roll, 4);
        let sheet = Everyday { kind, size }.sheet().unwrap();
        let x = rolled(&sheet);
        let panel = 0.3 / 24.0;
        let centre = [0.5 * panel, (ROLL * ROLL - 0.25 * panel * panel).sqrt()];
        for p in x.as_chunks::<3>().0 {
            let r = (p[0] - centre[0]).hypot(p[2] - centre[1]);
            assert!((r - ROLL).abs() < 1e-12, "{r}");
        }
    }
}
