//! Small vibrations and lateral buckling of plates that are clamped at one side.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::linear::{Symmetric, eigenvalues, free, stiffness};
use super::rest::Rest;
use super::specimen::material;
use anyhow::Result;
use cpu_time::ThreadTime;
use isosheet_dynamics::SheetModel;

/// Leissa.
pub(super) const PLATES: Experiment = Experiment {
    name: "vibrating-plates",
    title: "Frequencies of cantilever plates",
    source: "Leissa 1969, chapter 4; 1973",
    about: "Plates clamped at one side, Poisson's ratio 0.3, length a: omega a^2 (rho h / D)^(1/2) of the first two \
            modes, of a square (bending, torsion) and of a plate five times as long as wide (both bending).",
    quantities: || {
        let names = [
            "square, first",
            "square, torsion",
            "5 : 1, first",
            "5 : 1, second bending",
        ];
        let of = |(name, value): (&str, f64)| Quantity::new(name, value);
        names
            .into_iter()
            .zip([3.4718, 8.509, 3.4018, 21.29])
            .map(of)
            .collect()
    },
    measure: |job| frequencies(job, &[1.0, 0.2], 0.3),
};

/// The beam.
pub(super) const STRIP: Experiment = Experiment {
    name: "vibrating-strip",
    title: "Frequencies of a strip",
    source: "Beam theory, beta L = 1.8751, 4.6941",
    about: "A strip ten times as long as wide, Poisson's ratio 0, clamped at one end: omega L^2 (rho h / D)^(1/2).",
    quantities: || {
        let of = |(name, root): (&str, f64)| Quantity::new(name, root * root);
        [("first", 1.875_104), ("second", 4.694_091)]
            .map(of)
            .to_vec()
    },
    measure: |job| frequencies(job, &[0.1], 0.0),
};

/// Of plates of unit length with some widths.
fn frequencies(job: Job, widths: &[f64], poisson: f64) -> Result<Measured> {
    let begun = ThreadTime::now();
    let mut measured = Measured::default();
    for &width in widths {
        let plate = job.cantilever([1.0, width])?;
        let model = SheetModel::of_material(&plate.sheet, &material(1.0, poisson, 1e-3))
            .clamped(&plate.clamp)
            .build()?;
        let masses = free(&model).into_iter();
        let masses: Vec<f64> = masses.map(|v| model.mass().vertex[v.index()]).collect();
        let bending = stiffness(&model, plate.sheet.positions());
        let found = eigenvalues(&bending, &Symmetric::diagonal(&masses))?;
        measured.values.extend(found[..2].iter().map(|v| v.sqrt()));
        measured.vertices = plate.sheet.topology().vertex_count();
        measured.factorisations += 1;
    }
    measured.cpu = begun.elapsed().as_secs_f64();
    Ok(measured)
}

/// Plates on edge.
pub(super) const ON_EDGE: Experiment = Experiment {
    name: "plate-on-edge",
    title: "Plate on edge under its weight",
    source: "Ritz's method for Kirchhoff's plate; narrow: Prandtl 1899, Michell 1899",
    about: "A plate of length L and width w stands on edge, clamped at one end, and bends sidewards from a weight of \
            Gamma = q L^3 / D per area on: the smallest eigenvalue of the bending stiffness against that of the \
            stresses of the sheet at rest under a thousandth of the weight.",
    quantities: || {
        let of = |(poisson, width, gamma): &(f64, f64, f64)| {
            Quantity::new(format!("w/L = {width}, Poisson's ratio {poisson}"), *gamma)
        };
        EDGES.iter().map(of).collect()
    },
    measure: on_edge,
};

/// Poisson's ratios, widths over lengths, critical loads.
const EDGES: [(f64, f64, f64); 6] = [
    (0.3, 0.1, 15.70),
    (0.3, 0.2, 17.02),
    (0.3, 0.5, 21.66),
    (0.0, 0.1, 19.41),
    (0.0, 0.2, 20.67),
    (0.0, 0.5, 25.00),
];

fn on_edge(job: Job) -> Result<Measured> {
    let begun = ThreadTime::now();
    let mut all = Measured::default();
    for (poisson, width, gamma) in EDGES {
        let plate = job.cantilever([1.0, width])?;
        let thickness = 1e-3;
        let material = material(1.0, poisson, thickness);
        let model = || {
            let model = SheetModel::of_material(&plate.sheet, &material);
            model.clamped(&plate.clamp).build()
        };
        let load = 1e-3 * gamma;
        let sag = 1.5 * load / (material.stiffness * width * width);
        let mut rest = Rest::new(&plate.sheet, sag, 1.0);
        rest.under(model()?.with_acceleration([0.0, -load, 0.0]))?;
        let bending = stiffness(&model()?, plate.sheet.positions());
        let stressed = stiffness(&model()?, &rest.x);
        let critical = eigenvalues(&bending, &bending.minus(&stressed, 1.0 / load))?;
        all.values
            .push(critical.first().copied().unwrap_or(f64::NAN));
        all.vertices = plate.sheet.topology().vertex_count();
        all.factorisations += rest.course.cost.factorisations + 1;
        all.failure = all.failure.or(rest.course.failure());
    }
    all.cpu = begun.elapsed().as_secs_f64();
    Ok(all)
}
