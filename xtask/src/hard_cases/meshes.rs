//! Large degrees, long chains, irregular meshes, holes and several components.

use super::naive::{GAUSS_SEIDEL, gauss_seidel};
use super::scenes::{FRAME, STRAIN, at_rest, course, pinned};
use super::{Case, Findings};
use crate::methods::{conservative, damped};
use crate::report::Effort;
use crate::report::number;
use anyhow::Result;
use isosheet_coords::{Start, sys_coord_assnmt_single};
use isosheet_dynamics::{Method, Simulation, leave_flat};
use isosheet_mesh::{Dof, Sheet, VertexId, generate};
use isosheet_tests::HangingStrip;
use std::f64::consts::PI;

pub(crate) const LONG: Case = Case {
    name: "fan-and-strip",
    title: "Fan of 1000 edges, strip of 1000 links",
    expected: "A vertex with a thousand edges and a chain of a thousand links are solved like any other mesh, at a cost that grows with the \
               number of vertices; the chain swings at the frequency of the exact solution.",
    run: long,
};

fn long(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let count = effort.pick(100, 1000, 1000);
    let fan = generate::fan(count, 1.0, 1.8 * PI)?;
    let strip = generate::ladder(count + 1, 0.01, 1.0 / count as f64)?;
    let scenes: [(&str, &Sheet, Vec<VertexId>); 2] = [
        ("fan held at its apex", &fan, vec![VertexId(0)]),
        (
            "strip held at an end",
            &strip,
            vec![VertexId(0), VertexId(1)],
        ),
    ];
    for (what, sheet, pins) in &scenes {
        let model = pinned(sheet, pins)?;
        let (strain, _) = gauss_seidel(&model, sheet.positions(), FRAME, 30);
        f.naive(
            GAUSS_SEIDEL,
            format!(
                "{count} edges or links, {what}, 30 steps: largest edge strain {}.",
                number(strain)
            ),
            strain > 1e-2,
        );
        for (name, method) in damped() {
            let mut run = at_rest(pinned(sheet, pins)?, sheet.positions(), method)?;
            let c = course(&mut run, FRAME, effort.pick(10, 10, 60), |_, _| {})?;
            f.at_most(
                format!(
                    "{what}, {name}, {} steps: edge strain",
                    effort.pick(10, 10, 60)
                ),
                c.if_finished(c.strain),
                STRAIN,
            )
            .remark(c.said());
        }
        for (name, method) in conservative().into_iter().take(1) {
            let mut run = at_rest(pinned(sheet, pins)?, sheet.positions(), method)?;
            let c = course(
                &mut run,
                effort.pick(1e-3, 1e-3, 1e-3),
                effort.pick(5, 30, 200),
                |_, _| {},
            )?;
            f.at_most(
                format!("{what}, {name}, from flat and horizontal, 1 ms: edge strain"),
                c.if_finished(c.strain),
                STRAIN,
            )
            .remark(c.said());
            f.at_most(
                format!("{what}, {name}: energy error, of the largest kinetic energy"),
                c.if_finished(c.drift / c.kinetic),
                1e-8,
            );
        }
    }
    // The slowest mode of the hanging chain, from a small displacement, over half a period.
    let chain = HangingStrip {
        rows: effort.pick(20, 200, 1000),
        spacing: 1.0 / effort.pick(20.0, 200.0, 1000.0),
        gravity: 9.8,
        amplitude: 1e-4,
        mode: 0,
    };
    let period = std::f64::consts::TAU / chain.frequency();
    for (name, method) in [conservative()[0].clone(), ("BDF2", Method::default())] {
        let mut run = Simulation::new(chain.model(), chain.start(), method)?;
        let steps = 200;
        let c = course(&mut run, 0.5 * period / steps as f64, steps, |_, _| {})?;
        let exact = chain.displacements(0.5 * period);
        let error = exact
            .iter()
            .zip(run.state().x.chunks(3))
            .map(|(y, p)| (y - p[1]).abs())
            .fold(0.0, f64::max);
        f.at_most(
            format!("hanging chain of {} links, {name}: error of the slowest mode after half a period, of its amplitude", chain.rows),
            c.if_finished(error / chain.amplitude),
            1e-3,
        )
        .remark(c.said());
    }
    f.here = format!(
        "Sparse factorisations with fill-reducing orderings: {count} edges at one vertex are one dense row. The frequencies of the chain follow \
         from the zeros of a Laguerre polynomial."
    );
    Ok(f)
}

pub(crate) const IRREGULAR: Case = Case {
    name: "irregular",
    title: "Irregular meshes, holes, several components",
    expected: "Nothing in the method needs a regular mesh, a disk, or one piece.",
    run: irregular,
};

fn irregular(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let delaunay = generate::delaunay_square(1.0, effort.pick(0.25, 0.12, 0.06), 7)?;
    let ring = generate::annulus(18, 3, 0.25, 0.5)?;
    let corner_shape = generate::delaunay(
        &[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 0.5],
            [0.5, 0.5],
            [0.5, 1.0],
            [0.0, 1.0],
        ],
        0.15,
        3,
    )?;
    let hole = {
        let whole = generate::delaunay_square(1.0, 0.1, 11)?;
        whole.keep_faces(|face| {
            let corners = whole.topology().faces()[face.index()].map(|v| whole.position(v));
            let c = [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0);
            (c[0] - 0.5).hypot(c[1] - 0.5) > 0.2
        })?
    };
    let away = ring.map_positions(|[x, y, z]| [x + 3.0, y, z])?;
    let pieces = Sheet::union(&[
        &delaunay,
        &away,
        &corner_shape.map_positions(|[x, y, z]| [x - 3.0, y, z])?,
    ])?;
    let scenes: [(&str, &Sheet); 6] = [
        ("irregular square", &delaunay),
        ("ring", &ring),
        ("L", &corner_shape),
        ("irregular square with a hole", &hole),
        ("octagon of Fig. 15", &generate::octagon_244(0.5)?),
        ("three pieces, two of them falling freely", &pieces),
    ];
    let mut rows = Vec::new();
    for (what, sheet) in scenes {
        let pins = [VertexId(0)];
        let dof = Dof::of(sheet.topology());
        rows.push(vec![
            what.to_owned(),
            format!(
                "{}/{}",
                sheet.topology().vertex_count(),
                sheet.topology().face_count()
            ),
            sheet.topology().euler_characteristic().to_string(),
            dof.total.to_string(),
        ]);
        match sys_coord_assnmt_single(sheet, Start::Pinned(pins[0])) {
            Ok(assignment) => {
                let closures = assignment.closures().len();
                f.naive(
                    &format!("The paper's front on the {what}"),
                    format!(
                        "{} coordinates assigned for {} degrees of freedom; {closures} edges are left over as closure conditions.",
                        assignment.coordinate_count(),
                        assignment.dof()
                    ),
                    closures > 0,
                );
            }
            Err(e) => {
                f.naive(
                    &format!("The paper's front on the {what}"),
                    format!("{e}."),
                    true,
                );
            }
        }
        for (name, method) in damped() {
            let mut run = at_rest(pinned(sheet, &pins)?, sheet.positions(), method)?;
            let c = course(&mut run, FRAME, effort.pick(10, 60, 120), |_, _| {})?;
            f.at_most(
                format!("{what}, {name}, from flat: edge strain"),
                c.if_finished(c.strain),
                STRAIN,
            )
            .remark(c.said());
        }
        let model = pinned(sheet, &pins)?;
        let mut x = sheet.positions().to_vec();
        leave_flat(&model, &mut x, 0.1, 5)?;
        let mut run = at_rest(model, &x, conservative()[0].1.clone())?;
        let c = course(&mut run, 2e-3, effort.pick(10, 100, 200), |_, _| {})?;
        f.at_most(
            format!("{what}, energy-momentum, displaced by up to 10 % of an edge: energy error, of the largest kinetic energy"),
            c.if_finished(c.drift / c.kinetic),
            1e-8,
        )
        .remark(c.said());
    }
    f.table(
        "The meshes",
        &["mesh", "V/F", "Euler characteristic", "DOF by counting"],
        rows,
    );
    f.here = "Topology is half-edges of any orientable manifold; every component keeps its own momentum.".into();
    Ok(f)
}
