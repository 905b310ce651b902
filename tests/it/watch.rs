//! Brute-force checks of scenes with contact, frame by frame.

use isosheet_collide::{Contacts, Obstacle, Shape};
use isosheet_dynamics::{SheetModel, Simulation, StepReport};
use isosheet_geometry::distance::{edge_edge, point_triangle};
use isosheet_geometry::{ContactGeometry, ContactMesh, crossings, crossings_between};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Sides of the prism that stands for a cylinder, the default of the contact options.
const SEGMENTS: usize = 64;

/// Watches a scene: every frame is searched for intersections without any tree, candidate list or
/// barrier, and the step reports are held to their promises.
pub(crate) struct Watch {
    mesh: ContactMesh,
    bodies: Vec<(Obstacle, Option<ContactGeometry>)>,
    /// Largest relative length error so far.
    pub(crate) strain: f64,
    /// Smallest gap so far, metres.
    pub(crate) gap: f64,
    /// Newton iterations, sub-steps and rejected sub-steps so far.
    pub(crate) effort: [usize; 3],
}

impl Watch {
    pub(crate) fn new(model: &SheetModel, contacts: &Contacts) -> Self {
        let geometry = |b: &Obstacle| {
            inner(b.shape())
                .contact_geometry(SEGMENTS)
                .expect("enough sides")
        };
        Self {
            mesh: ContactMesh::from_topology(model.topology()),
            bodies: contacts
                .bodies()
                .map(|b| (b.clone(), geometry(b)))
                .collect(),
            strain: 0.0,
            gap: f64::INFINITY,
            effort: [0; 3],
        }
    }

    /// Takes one step of `h` seconds and checks the frame at its end: strain below 1e-10, gap above
    /// zero, nothing intersects.
    pub(crate) fn step(&mut self, simulation: &mut Simulation, h: f64) -> StepReport {
        let report = simulation.step(h).unwrap_or_else(|e| panic!("{e}"));
        let gap = report.gap.expect("a scene with contact");
        assert!(gap > 0.0, "gap {gap} at t = {}", report.t);
        assert!(
            report.strain < 1e-10,
            "strain {:e} at t = {}",
            report.strain,
            report.t
        );
        self.frame(report.t, &simulation.state().x);
        self.strain = self.strain.max(report.strain);
        self.gap = self.gap.min(gap);
        let done = [report.iterations, report.substeps, report.rejected];
        self.effort = std::array::from_fn(|i| self.effort[i] + done[i]);
        report
    }

    /// Searches positions for intersections of the sheet with itself and with the bodies at time `t`.
    pub(crate) fn frame(&self, t: f64, x: &[f64]) {
        let own = crossings(&self.mesh, x);
        assert!(own.is_empty(), "edges through faces at t = {t}: {own:?}");
        for (number, (body, geometry)) in self.bodies.iter().enumerate() {
            let open = x
                .as_chunks::<3>()
                .0
                .iter()
                .map(|p| body.signed_distance(t, &Vector3::from(*p)).value);
            let nearest = open.fold(f64::INFINITY, f64::min);
            assert!(
                nearest > 0.0,
                "a vertex is {nearest} m from body {number} at t = {t}"
            );
            let Some(geometry) = geometry else { continue };
            let mut y = vec![0.0; geometry.positions.len()];
            body.place(t, &geometry.positions, &mut y);
            let [a, b] = [&self.mesh, &geometry.mesh];
            let [through, pierced] = [
                crossings_between(a, x, b, &y),
                crossings_between(b, &y, a, x),
            ];
            assert!(
                through.is_empty(),
                "edges through body {number} at t = {t}: {through:?}"
            );
            assert!(
                pierced.is_empty(),
                "edges of body {number} through faces at t = {t}: {pierced:?}"
            );
            let distance = skeleton_distance(a, x, b, &y);
            assert!(
                distance > geometry.radius,
                "body {number} reaches {} m into the sheet at t = {t}",
                geometry.radius - distance
            );
        }
    }
}

/// The shape itself; of a cylinder the smaller one inside every prism with that many sides, since faces
/// and edges meet such a prism, turned anyhow about the axis.
fn inner(shape: &Shape) -> Shape {
    match shape.clone() {
        Shape::Cylinder {
            radius,
            half_height,
        } => {
            let radius = radius * (PI / SEGMENTS as f64).cos();
            Shape::Cylinder {
                radius,
                half_height,
            }
        }
        other => other,
    }
}

/// Smallest distance of the faces of `a` from the vertices of `b` and of the edges of `a` from the edges of
/// `b`, metres.
fn skeleton_distance(a: &ContactMesh, x: &[f64], b: &ContactMesh, y: &[f64]) -> f64 {
    let at = |x: &[f64], v: u32| {
        let i = 3 * v as usize;
        Vector3::new(x[i], x[i + 1], x[i + 2])
    };
    let mut least = f64::INFINITY;
    for p in y.as_chunks::<3>().0 {
        for [u, v, w] in a.faces() {
            let stencil = [Vector3::from(*p), at(x, *u), at(x, *v), at(x, *w)];
            least = least.min(point_triangle(&stencil).distance2);
        }
    }
    for [p, q] in b.edges() {
        for [u, v] in a.edges() {
            let stencil = [at(y, *p), at(y, *q), at(x, *u), at(x, *v)];
            least = least.min(edge_edge(&stencil).distance2);
        }
    }
    least.sqrt()
}
