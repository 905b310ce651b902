//! A crease in a strip that bends.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, material, with_plate};
use crate::runs::meshes::with_line;
use anyhow::Result;
use isosheet_dynamics::{CreaseSpring, CreaseSprings, PlateBending, PlateEdges};
use isosheet_mesh::{EdgeId, fold_angle};
use std::sync::Arc;

/// Length and width, metres; the crease is in the middle.
const SIZE: [f64; 2] = [2.0, 1.0];

/// Force at the end, newtons, and stiffness of the crease, newtons: it folds by a thousandth of a radian.
const FORCE: f64 = 1e-3;
const STIFFNESS: f64 = 1.0;

/// Creases.
pub(super) const CREASED: Experiment = Experiment {
    name: "crease-law",
    title: "Crease across a strip",
    source: "Beam theory: a beam with a hinge of the stiffness k w, P L^3 / (3 D w) + P (L / 2)^2 / (k w)",
    about: "A strip of 2 x 1 with rigidity D = 1, Poisson's ratio 0, clamped at one end, with a crease of the \
            stiffness k = D / m across its middle, under a small force P up at the other end: the kink of the crease, \
            which is the angle of the faces beside it without their bend, the moment that it carries, and how far the \
            end moves.",
    quantities: || {
        vec![
            Quantity::new("kink 2 k w / (P L)", 1.0),
            Quantity::new("moment 2 / (P L)", 1.0),
            Quantity::new("deflection", 1.0),
        ]
    },
    measure: creased,
};

fn creased(job: Job) -> Result<Measured> {
    let [length, width] = SIZE;
    let mut strip = job.cantilever(SIZE)?;
    strip.sheet = with_line(&strip.sheet, 0.5 * length, width / job.across as f64)?;
    let sheet = &strip.sheet;
    let t = sheet.topology();
    let clamp = crate::runs::meshes::vertices(sheet, |[x, ..]| x < 1e-9 * length);
    let is_on = |e: &EdgeId| {
        let mut ends = t.edges()[e.index()].iter();
        !t.is_boundary_edge(*e) && ends.all(|v| (sheet.position(*v)[0] - 0.5 * length).abs() < 1e-9)
    };
    let creases: Vec<EdgeId> = t.edge_ids().filter(is_on).collect();
    let spring = |edge: &EdgeId| CreaseSpring {
        edge: *edge,
        stiffness: STIFFNESS * sheet.lengths()[edge.index()],
        rest: 0.0.into(),
        yields: None,
        in_series: None,
    };
    let mut springs: Vec<CreaseSpring> = creases.iter().map(spring).collect();
    let material = material(1.0, 0.0, 1e-2);
    CreaseSpring::put_in_sheet(&mut springs, sheet, material.rigidity);
    let springs = Arc::new(CreaseSprings::new(t, springs)?);
    let edges = PlateEdges {
        pinned: &clamp,
        creases: &creases,
        ..PlateEdges::default()
    };
    let plate = PlateBending::held(sheet, &material, &edges)?;
    let tip = Line::at(sheet, 0, length);
    let model = with_plate(sheet, &material, &clamp, plate)?;
    let model = model.with_potential(Arc::clone(&springs));
    let mut rest = Rest::new(sheet, FORCE, length * length);
    rest.under(model.with_force(tip.load(FORCE, [0.0, 0.0, 1.0])?))?;
    let at = isosheet_dynamics::At::new(0.0, &rest.x);
    let bends = springs.bends_beside(at);
    let moment: f64 = -springs.moments(at).iter().sum::<f64>();
    let kink: f64 = bends
        .iter()
        .map(|(e, bend)| {
            let fold = fold_angle(t, &rest.x, *e).unwrap_or(0.0);
            sheet.lengths()[e.index()] / width * (fold - bend)
        })
        .sum();
    let wanted = 0.5 * FORCE * length;
    let beam = FORCE * length.powi(3) / (3.0 * width);
    let hinge = wanted / (STIFFNESS * width);
    let moved = tip.moved(sheet, &rest.x, 2) / (beam + 0.5 * length * hinge);
    Ok(Measured::at_rest(
        &rest,
        vec![kink / hinge, moment / wanted, moved],
    ))
}
