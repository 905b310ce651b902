//! How far a step of a scene takes its sheet.

use crate::Scene;
use crate::words::key::Key;
use crate::words::problem::Problem;
use crate::words::resolution::{reach, shortest};
use isosheet_dynamics::SheetModel;
use isosheet_mesh::wording::{brief, given};
use nalgebra::Vector3;

/// Refuses steps in which inertia and loads alone take a sheet of some area (square metres) so far that its
/// edges are lost in round-off.
pub(crate) fn check_step(
    scene: &Scene,
    model: &SheetModel,
    area: f64,
    v: &[f64],
) -> Result<(), Problem> {
    let speeds = v.as_chunks::<3>().0.iter();
    let speed = speeds.map(|v| Vector3::from(*v).norm()).fold(0.0, f64::max);
    let forces = &scene.forces;
    let largest = |range: [f64; 2]| range[0].abs().max(range[1].abs());
    let gravity = forces.gravity.map_or(0.0, |g| Vector3::from(g).norm());
    let fields = forces.acceleration.iter();
    let fields: f64 = fields.map(|f| largest(f.size.range(scene.stop.time))).sum();
    // Whatever a load acts on, it takes all of the mass along before long.
    let loads = forces.load.iter();
    let loads: f64 = loads
        .map(|load| largest(load.size.range(scene.stop.time)))
        .sum();
    let pressures = forces.pressure.iter();
    let pressures: f64 = pressures
        .map(|p| largest(p.size.range(scene.stop.time)))
        .sum();
    let loads = (loads + pressures * area) / model.mass().total();
    let h = scene.method.step;
    let path = h * speed + h * h * (gravity + fields + loads);
    let shortest = shortest(model.edges().lengths());
    if path <= reach(shortest) {
        return Ok(());
    }
    let message = format!(
        "in a step of {} s inertia and loads alone take the sheet {} m away, where its edges of {} m are lost in round-off",
        given(h),
        brief(path),
        brief(shortest)
    );
    let key = Key::root().name("method.step");
    let remedy = "choose a shorter step, or look for a load that is not of the size meant";
    Err(Problem::new(key, message, remedy))
}
