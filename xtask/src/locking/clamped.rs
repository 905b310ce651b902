//! Flat sheets that are clamped along lines of any direction.

use super::model::{Model, PAPER, Plate};
use super::runs::{Ran, Records, samples};
use super::scene::run;
use crate::report::{Effort, Table};
use crate::runs::Plan;
use anyhow::Result;
use isosheet_dynamics::{Method, SheetModel};
use isosheet_mesh::generate::Diagonals;
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use isosheet_tests::implicit_euler;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Depth of a sheet against that of the same sheet of elastic paper: from the first on it hangs as paper
/// does, below the second it hardly moves.
const AS_DEEP: f64 = 0.8;
const HARDLY: f64 = 0.1;

/// Kinds of sheets, one after another in the family.
const KINDS: [&str; 5] = ["union jack", "one-way", "Delaunay", "disk", "rectangle"];

/// Mass of a sheet, kilograms, and rate of its damping, 1/s.
const MASS: f64 = 0.1;
const DAMPING: f64 = 2.0;

/// Numbers of vertices of the family.
const VERTICES: std::ops::RangeInclusive<usize> = 25..=127;

/// Seed of the family.
const SEED: u64 = 20;

/// A sheet of the family.
#[derive(Debug)]
struct Clamped {
    sheet: Sheet,
    pins: Vec<VertexId>,
    /// Flexural rigidity, N m.
    rigidity: f64,
}

impl Clamped {
    /// The sheet of the given number in the family.
    fn new(number: usize) -> Result<Self> {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED + number as u64);
        let kind = KINDS[number % KINDS.len()];
        let sheet = loop {
            let sheet = random_sheet(kind, &mut rng)?;
            if VERTICES.contains(&sheet.topology().vertex_count()) {
                break sheet;
            }
        };
        let (s, c) = rng.random_range(0.0..TAU).sin_cos();
        let mut along: Vec<VertexId> = sheet.topology().vertex_ids().collect();
        let place = |v: &VertexId| {
            let [x, y, _] = sheet.position(*v);
            c * x + s * y
        };
        along.sort_by(|a, b| place(b).total_cmp(&place(a)));
        along.truncate(sheet.topology().vertex_count().div_ceil(4));
        let rigidity = 10f64.powf(rng.random_range(-4.0..0.0));
        Ok(Self {
            sheet,
            pins: along,
            rigidity,
        })
    }
}

fn random_sheet(kind: &str, rng: &mut ChaCha8Rng) -> Result<Sheet> {
    Ok(match kind {
        "union jack" => generate::isotropic_square(rng.random_range(1..=2), 1.0)?,
        "one-way" => {
            let cells = rng.random_range(4..=10);
            generate::anisotropic_grid(cells, cells, 1.0, 1.0)?
        }
        "Delaunay" => generate::delaunay_square(1.0, rng.random_range(0.1..0.24), rng.random())?,
        "disk" => generate::disk(rng.random_range(3..=6), 0.5)?,
        _ => {
            let (columns, rows) = (rng.random_range(6..=14), rng.random_range(3..=7));
            let height = rows as f64 / columns as f64;
            generate::grid(columns, rows, 1.0, height, Diagonals::UnionJack)?
        }
    })
}

/// A sheet of the family and a method.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ClampedJob {
    number: usize,
    method: String,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Fallen {
    kind: String,
    #[serde(rename = "D, N m")]
    rigidity: f64,
    #[serde(rename = "drop, m")]
    drop: Option<f64>,
    #[serde(rename = "factorisations before the refusal")]
    in_vain: Option<usize>,
    /// Whether a line of edges runs along the clamp, see [`SheetModel::clamps_across_the_mesh`].
    #[serde(rename = "edges along the clamp")]
    along: String,
    /// 1 or 0.
    #[serde(rename = "hang as paper")]
    is_deep: Option<u8>,
    #[serde(rename = "hardly move")]
    is_still: Option<u8>,
}

fn measure(model: Model, job: &ClampedJob, plan: &Plan) -> Result<(Ran, Fallen)> {
    let Clamped {
        sheet,
        pins,
        rigidity,
    } = Clamped::new(job.number)?;
    let plate = Plate {
        density: MASS / sheet.area(),
        rigidity,
        clamped: &pins,
        ..PAPER
    };
    let moved = model
        .sheet(&sheet, plate)?
        .with_gravity()
        .with_damping(DAMPING)?
        .with_pins(&pins)?;
    let named = |(name, method)| (name == job.method).then_some(method);
    let method = methods().into_iter().find_map(named).unwrap_or_default();
    let (course, end) = run(model, moved, &sheet, method, plan)?;
    let ran = Ran::of(model, &sheet, &course);
    let lowest = end.x.iter().skip(2).step_by(3).copied().fold(0.0, f64::min);
    let clamp = SheetModel::new(&sheet, MASS, MassKind::Lumped)?.with_pins(&pins)?;
    let across = clamp.clamps_across_the_mesh(sheet.positions());
    let fallen = Fallen {
        kind: KINDS[job.number % KINDS.len()].to_owned(),
        rigidity,
        drop: ran.if_good(-lowest),
        in_vain: course.in_vain,
        along: if across.is_empty() { "yes" } else { "no" }.to_owned(),
        is_deep: None,
        is_still: None,
    };
    Ok((ran, fallen))
}

/// The methods, the default first.
fn methods() -> [(&'static str, Method); 2] {
    [
        ("BDF2", Method::default()),
        ("implicit Euler", implicit_euler()),
    ]
}

/// The sheets and methods.
fn jobs(effort: Effort) -> Vec<ClampedJob> {
    let counts = effort.quick_or([10, 0], [200, 25]);
    let of = |((method, _), count): ((&str, Method), usize)| {
        let method = method.to_owned();
        (0..count).map(move |number| ClampedJob {
            number,
            method: method.clone(),
        })
    };
    methods().into_iter().zip(counts).flat_map(of).collect()
}

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let duration = effort.quick_or(0.5, 2.0);
    let plan = Plan::new(1.0 / 60.0, duration);
    let mut all = records.of_models(&jobs(effort), |model, job| measure(model, job, &plan))?;
    let papers = all
        .iter()
        .filter(|s| s.ran.model == Model::Material && s.job.method == methods()[0].0);
    let papers: Vec<Option<f64>> = papers.map(|s| s.measured.drop).collect();
    for s in &mut all {
        let share = s
            .measured
            .drop
            .zip(papers[s.job.number])
            .map(|(drop, paper)| drop / paper);
        s.measured.is_deep = share.map(|share| (share >= AS_DEEP).into());
        s.measured.is_still = share.map(|share| (share < HARDLY).into());
    }
    samples(&all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_family_is_what_it_says() {
        for number in 0..50 {
            let c = Clamped::new(number).unwrap();
            let count = c.sheet.topology().vertex_count();
            assert!(VERTICES.contains(&count), "{number}: {count}");
            assert_eq!(c.pins.len(), count.div_ceil(4));
            assert!((1e-4..1.0).contains(&c.rigidity));
            let again = Clamped::new(number).unwrap();
            assert_eq!((c.sheet, c.pins), (again.sheet, again.pins));
        }
    }
}
