//! Sheets whose bends stay.

use isosheet_dynamics::{
    At, Checkpoint, CheckpointError, CreaseSprings, ElasticSheet, HessianSink, Method,
    PlateBending, Potential, SheetModel, Simulation, SimulationError, State, StepControl, Yield,
};
use isosheet_mesh::generate::Diagonals;
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::{Matrix3, Vector3};

const LENGTH: f64 = 0.1;
/// Size of the squares of its mesh.
const CELL: f64 = 0.01;
const RIGIDITY: f64 = 1e-3;
/// Bent to this curvature, 1/m.
const BENT: f64 = 12.0;
/// Begins to yield at 4/m.
const SECTION: Yield = Yield {
    moment: 4e-3,
    hardening: 0.0,
    layers: 1,
};

/// Holds the vertices of a strip by springs at a cylinder whose curvature grows until 0.1 s, and lets go.
#[derive(Debug)]
struct Form {
    rest: Vec<f64>,
}

impl Form {
    /// Newton per metre and vertex: bends of the strip are held within a few millimetres.
    fn stiffness(t: f64) -> f64 {
        if t < 0.1001 { 2e3 } else { 0.0 }
    }

    /// The distances of the vertices from where they are to be.
    fn off(&self, t: f64, x: &[f64]) -> impl Iterator<Item = Vector3<f64>> {
        // The lines across the strip keep their distance.
        let angle_of_cell = CELL * BENT * (t / 0.1).clamp(1e-6, 1.0);
        let radius = 0.5 * CELL / (0.5 * angle_of_cell).sin();
        let points = self
            .rest
            .as_chunks::<3>()
            .0
            .iter()
            .zip(x.as_chunks::<3>().0);
        points.map(move |(p, x)| {
            let angle = angle_of_cell * (p[0] - 0.5 * LENGTH) / CELL;
            let rolled = [
                0.5 * LENGTH + radius * angle.sin(),
                p[1],
                2.0 * radius * (0.5 * angle).sin().powi(2),
            ];
            Vector3::from(*x) - Vector3::from(rolled)
        })
    }
}

impl Potential for Form {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { t, x, .. } = at;
        let squares: f64 = self.off(t, x).map(|d| d.norm_squared()).sum();
        0.5 * Self::stiffness(t) * squares
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { t, x, .. } = at;
        let rows = gradient.as_chunks_mut::<3>().0.iter_mut();
        for (g, off) in rows.zip(self.off(t, x)) {
            (0..3).for_each(|k| g[k] += Self::stiffness(t) * off[k]);
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let At { t, x, .. } = at;
        let block = Matrix3::from_diagonal_element(Self::stiffness(t));
        (0..x.len() / 3).for_each(|v| hessian.add_vertex(VertexId::from_index(v), &block));
    }

    fn is_driven(&self) -> bool {
        true
    }
}

fn strip() -> Sheet {
    generate::grid(10, 2, LENGTH, 0.02, Diagonals::UnionJack).expect("valid")
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Rods,
    Elastic,
}

fn model(sheet: &Sheet, kind: Kind, section: Option<Yield>) -> SheetModel {
    let model = SheetModel::new(sheet, 1e-4, MassKind::Lumped)
        .and_then(|m| m.with_damping(1e3))
        .expect("valid")
        .with_potential(Form {
            rest: sheet.positions().to_vec(),
        });
    match kind {
        Kind::Rods => {
            let mut springs = CreaseSprings::bending(sheet, RIGIDITY).expect("rigidity");
            if let Some(section) = section {
                springs = springs.with_yield(sheet, section).expect("yield");
            }
            model.with_potential(springs)
        }
        Kind::Elastic => {
            let mut plate = PlateBending::new(sheet, RIGIDITY).expect("rigidity");
            if let Some(section) = section {
                plate = plate.with_yield(sheet, section).expect("yield");
            }
            let elastic = ElasticSheet::new(sheet, 1e5, 0.3).expect("stiffness");
            let model = model.with_potential(plate).with_elastic_sheet(elastic);
            model.expect("its own sheet")
        }
    }
}

fn start(sheet: &Sheet, kind: Kind, section: Option<Yield>, method: Method) -> Simulation {
    let start = State::at_rest(sheet.positions().to_vec());
    Simulation::new(model(sheet, kind, section), start, method).expect("valid")
}

/// Curvature of the circle through three points of the middle line, the outer ones at a quarter of the length
/// from the ends.
fn curvature(sheet: &Sheet, x: &[f64]) -> f64 {
    let at = |s: f64| {
        let points = sheet.positions().as_chunks::<3>().0.iter();
        let off = points.map(|p| (p[0] - s * LENGTH).abs() + (p[1] - 0.01).abs());
        let nearest = off.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        Vector3::from(x.as_chunks::<3>().0[nearest.expect("a vertex").0])
    };
    let [a, b, c] = [at(0.2), at(0.5), at(0.8)];
    let area = (b - a).cross(&(c - a)).norm();
    2.0 * area / ((b - a).norm() * (c - b).norm() * (a - c).norm())
}

/// The curvature at the end, and what has been dissipated.
fn sprung_back(kind: Kind, section: Option<Yield>, h: f64) -> (f64, f64) {
    let sheet = strip();
    let mut run = start(&sheet, kind, section, Method::Bdf2(Default::default()));
    let mut report = run.step(h).expect("accepted");
    for _ in 1..(0.4 / h).round() as usize {
        report = run.step(h).expect("accepted");
    }
    (curvature(&sheet, &run.state().x), report.plastic)
}

/// The closed form of springback, with perfect plasticity and with hardening, of both kinds of sheets;
/// without a yield it comes back flat.
#[test]
fn a_strip_springs_back_by_its_yield_moment() {
    for kind in [Kind::Rods, Kind::Elastic] {
        let (flat, dissipated) = sprung_back(kind, None, 5e-3);
        assert!(flat < 1e-3 * BENT && dissipated == 0.0, "{kind:?}: {flat}");
        for hardening in [0.0, 3e-4] {
            let section = Yield {
                hardening,
                ..SECTION
            };
            let expected = (RIGIDITY * BENT - section.moment) / (RIGIDITY + hardening);
            let (kept, dissipated) = sprung_back(kind, Some(section), 5e-3);
            assert!(
                (kept - expected).abs() < 0.01 * expected,
                "{kind:?}: {kept} {expected}"
            );
            // Rods bend at edges, and half of the cells at the ends do not.
            let bent = match kind {
                Kind::Rods => LENGTH - CELL,
                Kind::Elastic => LENGTH,
            };
            let lost = section.moment * expected * bent * 0.02;
            assert!(
                (dissipated - lost).abs() < 0.01 * lost,
                "{kind:?}: {dissipated} {lost}"
            );
        }
    }
}

/// A section that yields from its faces inwards: the curvature after springback is Gardiner's.
#[test]
fn a_strip_in_layers_springs_back_as_one_that_yields_from_its_faces() {
    let section = SECTION.in_layers(8);
    // Half the curvature of the first yield, in parts of that to which it is bent.
    let q = section.moment / (3.0 * RIGIDITY * BENT);
    let expected = BENT * (4.0 * q.powi(3) - 3.0 * q + 1.0);
    for kind in [Kind::Rods, Kind::Elastic] {
        let (kept, dissipated) = sprung_back(kind, Some(section), 5e-3);
        assert!(
            (kept - expected).abs() < 0.01 * expected,
            "{kind:?}: {kept} {expected}"
        );
        // Less than the work of the largest moment.
        assert!(dissipated > 0.0 && dissipated < section.moment * BENT * LENGTH * 0.02);
    }
}

/// Plasticity has no rate: the same at half the step, up to how the strip swings when it is let go.
#[test]
fn what_stays_does_not_depend_on_the_step() {
    let kept = [1e-2, 5e-3, 2.5e-3].map(|h| sprung_back(Kind::Elastic, Some(SECTION), h).0);
    for pair in kept.windows(2) {
        assert!((pair[1] - pair[0]).abs() < 0.01 * pair[1], "{kept:?}");
    }
}

/// Refuses to be evaluated after a time.
#[derive(Debug)]
struct Until(f64);

impl Potential for Until {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { t, .. } = at;
        if t > self.0 { f64::NAN } else { 0.0 }
    }

    fn add_gradient(&self, _at: At<'_>, _gradient: &mut [f64]) {}
}

#[test]
fn a_refused_step_leaves_what_has_yielded() {
    for kind in [Kind::Rods, Kind::Elastic] {
        let sheet = strip();
        let model = model(&sheet, kind, Some(SECTION)).with_potential(Until(0.072));
        let start = State::at_rest(sheet.positions().to_vec());
        let control = StepControl {
            min_fraction: 1.0,
            ..StepControl::default()
        };
        let run = Simulation::new(model, start, Method::default());
        let mut run = run
            .and_then(|run| run.with_control(control))
            .unwrap_or_else(|e| panic!("{e}"));
        for _ in 0..14 {
            run.step(5e-3).expect("accepted");
        }
        let before = run.checkpoint();
        assert!(run.step(5e-3).is_err());
        assert_eq!(before, run.checkpoint());
    }
}

/// What all potentials remember.
fn remembered(run: &Simulation) -> Vec<f64> {
    run.memories().lists().concat()
}

#[test]
fn a_resumed_run_goes_on_with_the_same_bits() {
    for (kind, layers) in [(Kind::Rods, 1), (Kind::Elastic, 1), (Kind::Elastic, 3)] {
        let section = Some(SECTION.in_layers(layers));
        let sheet = strip();
        let mut run = start(&sheet, kind, section, Method::default());
        for _ in 0..18 {
            run.step(5e-3).expect("accepted");
        }
        let bytes = run.checkpoint().to_bytes().expect("encodes");
        let before = remembered(&run);
        assert!(before.iter().any(|p| *p != 0.0));
        let checkpoint = Checkpoint::from_bytes(&bytes).expect("decodes");
        let mut resumed = Simulation::resume(model(&sheet, kind, section), None, checkpoint)
            .expect("the same model");
        for _ in 0..10 {
            let reports = (run.step(5e-3), resumed.step(5e-3));
            assert!(reports.0.as_ref().expect("accepted").plastic > 0.0);
            assert_eq!(reports.0, reports.1);
        }
        assert_eq!(run.state(), resumed.state());
        assert_eq!(run.checkpoint(), resumed.checkpoint());
        // Other potentials may come and go.
        let checkpoint = Checkpoint::from_bytes(&bytes).expect("decodes");
        let with_weight = model(&sheet, kind, section).with_gravity();
        let resumed = Simulation::resume(with_weight, None, checkpoint);
        let resumed = resumed.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(remembered(&resumed), before);
        // A model that does not yield has no place for it.
        let checkpoint = Checkpoint::from_bytes(&bytes).expect("decodes");
        let refused = Simulation::resume(model(&sheet, kind, None), None, checkpoint);
        assert!(matches!(
            refused.err(),
            Some(SimulationError::Checkpoint(CheckpointError::Length { .. }))
        ));
    }
}
