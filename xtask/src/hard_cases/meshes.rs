//! Large degrees, long chains, irregular meshes, holes and several components.

use super::Findings;
use super::scenes::{go, pinned};
use crate::report::{Bound, Effort};
use anyhow::Result;
use isosheet_coords::{Start, sys_coord_assnmt_single};
use isosheet_dynamics::{Method, Simulation};
use isosheet_mesh::{Sheet, VertexId, generate};
use isosheet_tests::HangingStrip;
use isosheet_tests::energy_momentum;
use std::f64::consts::PI;

/// What a naive method does to the fan and the strip, and how the chain swings.
pub(super) fn long(f: &mut Findings, effort: Effort) -> Result<()> {
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
    }
    slowest_mode(f, effort)
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

/// What the paper's front does on irregular meshes, without a hole and with one.
pub(super) fn irregular(f: &mut Findings, _: Effort) -> Result<()> {
    let l_shape = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 0.5],
        [0.5, 0.5],
        [0.5, 1.0],
        [0.0, 1.0],
    ];
    for (what, sheet) in [
        ("irregular square", generate::delaunay_square(1.0, 0.12, 7)?),
        ("ring", generate::annulus(18, 3, 0.25, 0.5)?),
        ("L", generate::delaunay(&l_shape, 0.15, 3)?),
        ("octagon of Fig. 15", generate::octagon_244(0.5)?),
    ] {
        let outcome = sys_coord_assnmt_single(&sheet, Start::Pinned(VertexId(0)));
        let outcome = outcome.map_err(|e| e.to_string());
        let left = format!("{what}: edges that are left over as closure conditions");
        let closures = outcome.map(|assignment| assignment.closures().len() as f64);
        f.naive_run("The paper's front", left, closures, Bound::AtMost(0.0));
    }
    Ok(())
}
