//! Single everyday scenes with paper.

use super::course::{Course, Plan, Scene};
use super::findings::Findings;
use super::isometry::{Isometry, Material, PAPER_RIGIDITY};
use super::meshes::vertices;
use super::plot::{Dot, Figure, Joined, Panel};
use super::records::Records;
use super::targets::{at_least, kept, strain};
use crate::draw::{Axis, Drawing};
use crate::report::Effort;
use crate::report::Table;
use anyhow::Result;
use isosheet_dynamics::{Method, PointProfile, Profile, SheetModel};
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

/// A scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Everyday {
    Pushed(usize),
    Roll(usize),
    Banner(u32),
    Corners(u32),
}

impl fmt::Display for Everyday {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pushed(n) => write!(f, "pushed together, {n} squares across"),
            Self::Roll(n) => write!(f, "roll, {n} squares across"),
            Self::Banner(level) => write!(f, "banner M^{level}"),
            Self::Corners(level) => write!(f, "opposite corners, M^{level}"),
        }
    }
}

impl Everyday {
    fn all(effort: Effort) -> Vec<Self> {
        let mut all = vec![
            Self::Pushed(2),
            Self::Roll(2),
            Self::Banner(1),
            Self::Corners(1),
        ];
        if effort == Effort::Full {
            all.extend([
                Self::Pushed(4),
                Self::Roll(4),
                Self::Banner(2),
                Self::Banner(3),
                Self::Corners(2),
                Self::Corners(3),
            ]);
        }
        all.sort_by_key(|scene| match scene {
            Self::Pushed(n) => (0, *n as u32),
            Self::Roll(n) => (1, *n as u32),
            Self::Banner(level) => (2, *level),
            Self::Corners(level) => (3, *level),
        });
        all
    }

    /// The flat sheet in its plane of reference, z = 0.
    fn sheet(self) -> Result<Sheet> {
        Ok(match self {
            Self::Pushed(n) => generate::grid(3 * n, n, 0.3, 0.1, Diagonals::UnionJack)?,
            Self::Roll(n) => generate::grid(6 * n, 2 * n, 0.3, 0.2, Diagonals::UnionJack)?,
            Self::Banner(level) | Self::Corners(level) => generate::isotropic_square(level, 1.0)?,
        })
    }

    /// Positions at the start.
    fn start(self, sheet: &Sheet) -> Vec<f64> {
        match self {
            Self::Roll(_) => rolled(sheet),
            _ => sheet.positions().to_vec(),
        }
    }

    /// The vertices of faces that are clamped.
    fn clamp(self, sheet: &Sheet) -> Vec<VertexId> {
        let second = sheet.position(VertexId(1))[0];
        match self {
            Self::Pushed(_) => vertices(sheet, |[x, ..]| {
                x < second + 1e-9 || x > 0.3 - second - 1e-9
            }),
            Self::Roll(_) => vertices(sheet, |[x, ..]| x < second + 1e-9),
            Self::Banner(_) | Self::Corners(_) => Vec::new(),
        }
    }

    fn model(self, isometry: Isometry, sheet: &Sheet) -> Result<SheetModel> {
        let material = Material {
            mass: DENSITY * sheet.area(),
            rigidity: Some(PAPER_RIGIDITY),
            clamped: &self.clamp(sheet),
        };
        let model = isometry
            .model(sheet, material)?
            .with_gravity()
            .with_damping(DAMPING)?;
        Ok(match self {
            Self::Pushed(_) => pushed(model, sheet)?,
            Self::Roll(_) => {
                let panel = sheet.position(VertexId(1))[0];
                model.with_pins(&vertices(sheet, |[x, _, _]| x < panel + 1e-9))?
            }
            Self::Banner(_) => model.with_pins(&vertices(sheet, |[x, y, _]| {
                y > 1.0 - 1e-9 && (x - 0.5).abs() > 0.5 - 1e-9
            }))?,
            Self::Corners(_) => model.with_pins(&vertices(sheet, |[x, y, _]| {
                (x + y - 1.0).abs() > 1.0 - 1e-9
            }))?,
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

/// What happened in a scene.
#[derive(Serialize, Deserialize)]
struct Day {
    isometry: Isometry,
    scene: Everyday,
    vertices: usize,
    course: Course,
    /// Heights of the lowest and the highest vertex at the end, metres.
    heights: [f64; 2],
    /// Energy of bending at the end, joules.
    bending: f64,
}

impl Day {
    fn measure(isometry: Isometry, scene: Everyday, plan: &Plan) -> Result<Self> {
        let sheet = scene.sheet()?;
        let course = Scene {
            model: scene.model(isometry, &sheet)?,
            start: scene.start(&sheet),
            method: Method::default(),
            contacts: None,
        }
        .run(plan)?;
        let bending = (PAPER_RIGIDITY, scene.clamp(&sheet));
        Ok(Self {
            isometry,
            scene,
            vertices: sheet.topology().vertex_count(),
            heights: [course.lowest(), course.highest()],
            bending: isometry.bending_energy(&sheet, (bending.0, &bending.1), &course.x)?,
            course,
        })
    }
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Drawing>)> {
    let effort = records.effort;
    let plan = Plan {
        step: 1.0 / 60.0,
        duration: effort.quick_or(0.5, 3.0),
        rest_speed: None,
        patience: effort.patience(0.3, 10.0),
    };
    let scenes = Everyday::all(effort);
    let all = records.of_models(
        |_| scenes.clone(),
        |isometry, scene| Day::measure(isometry, *scene, &plan),
    )?;
    let targets = |isometry: &Isometry| {
        let isometry = *isometry;
        let of: Vec<&Day> = all.iter().filter(|d| d.isometry == isometry).collect();
        let ended = of.iter().filter(|d| d.course.ending.is_good()).count();
        let share = Some(ended as f64 / of.len() as f64);
        let quantity = "part of the scenes that run to their end";
        let mut targets = vec![
            at_least(isometry, quantity, 1.0, &[share]),
            strain(isometry, of.iter().map(|d| &d.course)),
        ];
        targets.extend(kept(isometry, of.iter().map(|d| d.course.kept)));
        targets
    };
    let drawing = plot(&all, &scenes);
    Ok((
        Findings {
            tables: vec![table(&all, &plan)],
            targets: Isometry::ALL.iter().flat_map(targets).collect(),
            ..Findings::default()
        },
        Some(drawing),
    ))
}

fn table(all: &[Day], plan: &Plan) -> Table {
    Table::of(
        format!(
            "Everyday scenes: {} s simulated, at most {} s of wall time. The energy of bending is that at the end",
            plan.duration,
            plan.patience.as_secs_f64()
        ),
        all,
        &[
            ("scene", &|d| d.scene.to_string().into()),
            ("V", &|d| d.vertices.into()),
            ("model", &|d| d.isometry.to_string().into()),
            ("ending", &|d| d.course.ending.name().into()),
            ("t at the end, s", &|d| d.course.t.into()),
            ("factorisations per step", &|d| d.course.cost.factorisations_per_step().into()),
            ("most in a step", &|d| d.course.worst.into()),
            ("lowest vertex, m", &|d| d.heights[0].into()),
            ("highest vertex, m", &|d| d.heights[1].into()),
            ("energy of bending, J", &|d| d.bending.into()),
            ("strain", &|d| d.course.strain.into()),
            ("wall time, s", &|d| d.course.cost.wall.into()),
            ("message", &|d| d.course.ending.message().into()),
        ],
    )
    .named("everyday")
}

/// Factorisations a step of every scene.
fn plot(all: &[Day], scenes: &[Everyday]) -> Drawing {
    let kinds = ["pushed together", "roll", "banner", "opposite corners"];
    let kind = |scene: Everyday| match scene {
        Everyday::Pushed(_) => 0,
        Everyday::Roll(_) => 1,
        Everyday::Banner(_) => 2,
        Everyday::Corners(_) => 3,
    };
    let dots: Vec<Dot> = all
        .iter()
        .filter_map(|d| {
            let cost = d
                .course
                .cost
                .factorisations_per_step()
                .filter(|_| d.course.ending.is_good());
            Some(Dot {
                isometry: d.isometry,
                mesh: kind(d.scene),
                x: scenes.iter().position(|s| *s == d.scene)? as f64,
                y: cost,
            })
        })
        .collect();
    let ticks = scenes.iter().enumerate().map(|(k, scene)| {
        let size = match scene {
            Everyday::Pushed(n) | Everyday::Roll(n) => format!("{n}"),
            Everyday::Banner(level) | Everyday::Corners(level) => format!("M^{{{level}}}"),
        };
        (k as f64, size)
    });
    let range = [-0.7, scenes.len() as f64 - 0.3];
    let x = Axis::linear("squares across, or mesh", range, ticks.collect());
    let cost = all
        .iter()
        .filter_map(|d| d.course.cost.factorisations_per_step());
    Figure {
        x: (x),
        rows: vec![(
            Axis::holding("factorisations a step", cost),
            vec![Panel {
                title: "Everyday scenes".into(),
                dots,
                guides: Vec::new(),
            }],
        )],
        meshes: kinds.map(str::to_owned).to_vec(),
        guide: String::new(),
        joined: Joined::No,
        size: [260.0, 150.0],
    }
    .draw()
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
            let pins = match everyday {
                Everyday::Pushed(n) => 2 * 2 * (n + 1),
                Everyday::Roll(n) => 2 * (2 * n + 1),
                Everyday::Banner(_) | Everyday::Corners(_) => 2,
            };
            assert_eq!(model.pins().len(), pins, "{everyday}");
        }
    }

    /// A regular polygon about a circle of the radius: all corners are at the same distance of its centre.
    #[test]
    fn the_roll_is_a_prism() {
        let sheet = Everyday::Roll(4).sheet().unwrap();
        let x = rolled(&sheet);
        let panel = 0.3 / 24.0;
        let centre = [0.5 * panel, (ROLL * ROLL - 0.25 * panel * panel).sqrt()];
        for p in x.as_chunks::<3>().0 {
            let r = (p[0] - centre[0]).hypot(p[2] - centre[1]);
            assert!((r - ROLL).abs() < 1e-12, "{r}");
        }
    }
}
