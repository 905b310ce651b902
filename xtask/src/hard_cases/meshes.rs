//! Large degrees, long chains, irregular meshes, holes and several components.

use super::scenes::{FRAME, at_rest, go, pinned, released};
use super::{Case, Findings, Work};
use crate::report::{Bound, Effort, Table};
use anyhow::Result;
use isosheet_coords::{Start, sys_coord_assnmt_single};
use isosheet_dynamics::{Method, Simulation, leave_flat};
use isosheet_mesh::{Dof, Sheet, VertexId, generate};
use isosheet_tests::HangingStrip;
use isosheet_tests::{damped, energy_momentum};
use std::f64::consts::PI;

pub(crate) const LONG: Case = Case {
    name: "fan-and-strip",
    title: "Fan of 1000 edges, strip of 1000 links",
    expected: "A vertex with a thousand edges and a chain of a thousand links are solved like any other mesh, at a cost that grows with the \
               number of vertices; the chain swings at the frequency of the exact solution.",
    run: Work::Code(long),
};

fn long(f: &mut Findings, effort: Effort) -> Result<()> {
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
        let set_up = format!("{count} edges or links, {what}");
        f.swept(&set_up, &pinned(sheet, pins)?, sheet.positions(), 30);
        let steps = effort.pick(10, 10, 60);
        for (name, method) in damped() {
            let (c, _) = go(released(sheet, pins, method)?, FRAME, steps)?;
            f.of(&c, format!("{what}, {name}, {steps} steps"))
                .strain("edge strain");
        }
        let (c, _) = go(
            released(sheet, pins, energy_momentum())?,
            1e-3,
            effort.pick(5, 30, 200),
        )?;
        f.of(
            &c,
            format!("{what}, energy-momentum, from flat and horizontal, 1 ms"),
        )
        .strain("edge strain");
        f.of(&c, format!("{what}, energy-momentum")).at_most(
            "energy error, of the largest kinetic energy",
            c.drift / c.most_kinetic,
            1e-8,
        );
    }
    slowest_mode(f, effort)?;
    f.here = "Sparse factorisations with fill-reducing orderings: all edges at one vertex are one dense row. The frequencies of the chain \
              follow from the zeros of a Laguerre polynomial.";
    Ok(())
}

/// The slowest mode of the hanging chain, from a small displacement, over half a period.
fn slowest_mode(f: &mut Findings, effort: Effort) -> Result<()> {
    let rows = effort.pick(20, 200, 1000);
    let chain = HangingStrip {
        rows,
        spacing: 1.0 / rows as f64,
        gravity: 9.8,
        amplitude: 1e-4,
        mode: 0,
    };
    let half = 0.5 * std::f64::consts::TAU / chain.frequency();
    for (name, method) in [
        ("energy-momentum", energy_momentum()),
        ("BDF2", Method::default()),
    ] {
        let (c, end) = go(
            Simulation::new(chain.model(), chain.start(), method)?,
            half / 200.0,
            200,
        )?;
        let exact = chain.displacements(half);
        let off = exact.iter().zip(end.chunks(3));
        let error = off.map(|(y, p)| (y - p[1]).abs()).fold(0.0, f64::max);
        let quantity = "error of the slowest mode after half a period, of its amplitude";
        f.of(&c, format!("hanging chain of {rows} links, {name}"))
            .at_most(quantity, error / chain.amplitude, 1e-3);
    }
    Ok(())
}

pub(crate) const IRREGULAR: Case = Case {
    name: "irregular",
    title: "Irregular meshes, holes, several components",
    expected: "Nothing in the method needs a regular mesh, a disk, or one piece.",
    run: Work::Code(irregular),
};

fn irregular(f: &mut Findings, effort: Effort) -> Result<()> {
    let scenes = meshes(effort)?;
    for (what, sheet) in &scenes {
        let outcome = sys_coord_assnmt_single(sheet, Start::Pinned(VertexId(0)));
        let outcome = outcome.map_err(|e| e.to_string());
        let left = format!("{what}: edges that are left over as closure conditions");
        let closures = outcome.map(|assignment| assignment.closures().len() as f64);
        f.naive_run("The paper's front", left, closures, Bound::AtMost(0.0));
        let pins = [VertexId(0)];
        for (name, method) in damped() {
            let (c, _) = go(
                released(sheet, &pins, method)?,
                FRAME,
                effort.pick(10, 60, 120),
            )?;
            f.of(&c, format!("{what}, {name}, from flat"))
                .strain("edge strain");
        }
        let model = pinned(sheet, &pins)?;
        let mut x = sheet.positions().to_vec();
        leave_flat(&model, &mut x, 0.1, 5)?;
        let (c, _) = go(
            at_rest(model, &x, energy_momentum())?,
            2e-3,
            effort.pick(10, 100, 200),
        )?;
        f.of(
            &c,
            format!("{what}, energy-momentum, displaced by up to 10 % of an edge"),
        )
        .at_most(
            "energy error, of the largest kinetic energy",
            c.drift / c.most_kinetic,
            1e-8,
        );
    }
    f.tables.push(Table::of(
        "The meshes",
        &scenes,
        &[
            ("mesh", &|(what, _)| (*what).into()),
            ("V/F", &|(_, sheet)| {
                let t = sheet.topology();
                format!("{}/{}", t.vertex_count(), t.face_count()).into()
            }),
            ("Euler characteristic", &|(_, sheet)| {
                sheet.topology().euler_characteristic().to_string().into()
            }),
            ("DOF by counting", &|(_, sheet)| {
                Dof::of(sheet.topology()).total.to_string().into()
            }),
        ],
    ));
    f.here = "Topology is half-edges of any orientable manifold; every component keeps its own momentum.";
    Ok(())
}

/// Irregular, holed, non-convex and separate meshes.
fn meshes(effort: Effort) -> Result<[(&'static str, Sheet); 6]> {
    let delaunay = generate::delaunay_square(1.0, effort.pick(0.25, 0.12, 0.06), 7)?;
    let ring = generate::annulus(18, 3, 0.25, 0.5)?;
    let l_shape = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 0.5],
        [0.5, 0.5],
        [0.5, 1.0],
        [0.0, 1.0],
    ];
    let l_shape = generate::delaunay(&l_shape, 0.15, 3)?;
    let whole = generate::delaunay_square(1.0, 0.1, 11)?;
    let hole = whole.keep_faces(|face| {
        let corners = whole.topology().faces()[face.index()].map(|v| whole.position(v));
        let c = [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0);
        (c[0] - 0.5).hypot(c[1] - 0.5) > 0.2
    })?;
    let right = ring.map_positions(|[x, y, z]| [x + 3.0, y, z])?;
    let left = l_shape.map_positions(|[x, y, z]| [x - 3.0, y, z])?;
    let pieces = Sheet::union(&[&delaunay, &right, &left])?;
    Ok([
        ("irregular square", delaunay),
        ("ring", ring),
        ("L", l_shape),
        ("irregular square with a hole", hole),
        ("octagon of Fig. 15", generate::octagon_244(0.5)?),
        ("three pieces, two of them falling freely", pieces),
    ])
}
