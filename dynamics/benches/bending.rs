//! What bending stiffness costs: CPU seconds and factorisations for each simulated second of a square that
//! hangs by a corner, with the mass (0.1 kg), the size (1 m) and the stiffness of office paper.
//!
//! All models run one after another on one thread, and each is compared with bare rods in the same run.
//! Arguments choose models whose names contain one of them.

use cpu_time::ProcessTime;
use isosheet_dynamics::{
    CreaseSprings, ElasticSheet, Method, PlateBending, SheetModel, Simulation, State,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use std::error::Error;
use std::f64::consts::PI;

/// Steps of 1/60 s in a simulated second.
const STEPS: usize = 60;
/// Flexural rigidity, newton metres.
const RIGIDITY: f64 = 5e-4;
/// Membrane stiffness, newtons per metre.
const MEMBRANE: f64 = 3e5;

/// What resists stretching and bending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Material {
    Rods,
    RodsAndHinges,
    RodsAndPlate,
    ElasticSheet,
}

impl Material {
    const ALL: [Self; 4] = [
        Self::Rods,
        Self::RodsAndHinges,
        Self::RodsAndPlate,
        Self::ElasticSheet,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Rods => "rods",
            Self::RodsAndHinges => "rods, hinges",
            Self::RodsAndPlate => "rods, plate",
            Self::ElasticSheet => "elastic, plate",
        }
    }

    fn add_to(self, model: SheetModel, sheet: &Sheet) -> Result<SheetModel, Box<dyn Error>> {
        Ok(match self {
            Self::Rods => model,
            Self::RodsAndHinges => model.with_potential(CreaseSprings::bending(sheet, RIGIDITY)?),
            Self::RodsAndPlate => model.with_potential(PlateBending::new(sheet, RIGIDITY)?),
            Self::ElasticSheet => {
                let plate = PlateBending::new(sheet, RIGIDITY)?;
                let elastic = ElasticSheet::new(sheet, MEMBRANE, 0.3)?.beside(sheet, &plate);
                model.with_elastic_sheet(elastic)?.with_potential(plate)
            }
        })
    }
}

/// The union-jack square `M^level`, nearly flat, that hangs by a corner.
fn hanging(level: u32, material: Material) -> Result<Simulation, Box<dyn Error>> {
    let flat = generate::isotropic_square(level, 1.0)?;
    let sheet = flat.map_positions(|[x, y, _]| [x, y, 1e-3 * (PI * x).sin() * (PI * y).sin()])?;
    let n = (2 << level) + 1;
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?
        .with_gravity()
        .with_pins(&[VertexId(n * (n - 1))])?;
    let model = material.add_to(model, &sheet)?;
    let start = State::at_rest(sheet.positions().to_vec());
    Ok(Simulation::new(model, start, Method::default())?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let filters: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    println!(
        "mesh  model            CPU s/s  to rods  factorisations  iterations  lowest vertex, m"
    );
    for level in [2, 3, 4] {
        let mut bare = f64::NAN;
        for material in Material::ALL {
            let name = format!("M^{level}  {:15}", material.name());
            if !(filters.is_empty() || filters.iter().any(|f| name.contains(f.as_str()))) {
                continue;
            }
            let mut run = hanging(level, material)?;
            let (mut factorisations, mut iterations) = (0, 0);
            let start = ProcessTime::now();
            for _ in 0..STEPS {
                let report = run.step(1.0 / STEPS as f64)?;
                factorisations += report.factorisations;
                iterations += report.iterations;
            }
            let spent = start.elapsed().as_secs_f64();
            if material == Material::Rods {
                bare = spent;
            }
            let lowest = run
                .state()
                .x
                .chunks(3)
                .fold(f64::INFINITY, |z, p| z.min(p[2]));
            println!(
                "{name}  {spent:7.3}  {:7.2}  {factorisations:14}  {iterations:10}  {lowest:16.5}",
                spent / bare
            );
        }
    }
    Ok(())
}
