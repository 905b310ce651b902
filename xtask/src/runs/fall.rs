//! The first moments of the fall, between two limits: a rigid plate and matter that nothing holds together.

use super::{Scene, Shape, Staged};
use crate::interrupt;
use anyhow::Result;
use isosheet_dynamics::Frames;
use isosheet_mesh::{MassKind, MassMatrix};

/// Acceleration of gravity of the scenes, m/s2.
const GRAVITY: f64 = 9.8;

/// Time and depth of the centre of mass (seconds, sides) while a sheet falls from exactly flat, frame by
/// frame.
///
/// # Errors
/// Ctrl-C and errors of the simulation.
pub(crate) fn fall(scene: &Scene) -> Result<Vec<[f64; 2]>> {
    let sheet = scene.sheet()?;
    let mut simulation = scene.simulation(&sheet)?;
    let mut frames = Frames::every(1);
    let duration = scene.frames as f64 * scene.frame;
    simulation.run(
        duration,
        scene.frame,
        &mut [&mut frames, &mut interrupt::observe],
    )?;
    interrupt::check()?;
    let later = frames.states()[1..]
        .iter()
        .map(|s| Ok([s.t, Shape::of(scene, &sheet, &s.x)?.centre_depth]));
    std::iter::once(Ok([0.0, 0.0])).chain(later).collect()
}

/// The same for the sheet welded to a rigid plate that turns about the held corner.
///
/// With d half a diagonal, m the mass and I the moment of inertia of the vertex masses about the line through
/// the corner across the diagonal, the angle a below the horizon obeys `I a'' = m g d cos a - c I a'`;
/// damping c as in the scene.
pub(crate) fn plate_fall(scene: &Scene) -> Result<Vec<[f64; 2]>> {
    let sheet = scene.sheet()?;
    let mass = MassMatrix::from_total(&sheet, 1.0, MassKind::Lumped)?.vertex;
    let inertia: f64 = sheet
        .topology()
        .vertex_ids()
        .map(|v| {
            let p = sheet.position(v);
            let along = super::PLATE * (p[0] + scene.side - p[1]);
            mass[v.index()] * along * along
        })
        .sum();
    let d = scene.side * super::PLATE;
    let rate = |a: f64, w: f64| [w, GRAVITY * d / inertia * a.cos() - scene.damping * w];
    // Steps of classical Runge-Kutta, a tenth of a frame each.
    let h = 0.1 * scene.frame;
    let (mut a, mut w) = (0.0, 0.0);
    let mut curve = vec![[0.0, 0.0]];
    for frame in 1..=scene.frames {
        for _ in 0..10 {
            let k1 = rate(a, w);
            let k2 = rate(a + 0.5 * h * k1[0], w + 0.5 * h * k1[1]);
            let k3 = rate(a + 0.5 * h * k2[0], w + 0.5 * h * k2[1]);
            let k4 = rate(a + h * k3[0], w + h * k3[1]);
            a += h / 6.0 * (k1[0] + 2.0 * k2[0] + 2.0 * k3[0] + k4[0]);
            w += h / 6.0 * (k1[1] + 2.0 * k2[1] + 2.0 * k3[1] + k4[1]);
        }
        curve.push([frame as f64 * scene.frame, d * a.sin() / scene.side]);
    }
    Ok(curve)
}

/// The same for matter that falls freely with the damping of the scene: `g (t - (1 - exp(-c t)) / c) / c`.
pub(crate) fn free_fall(scene: &Scene) -> Vec<[f64; 2]> {
    let c = scene.damping;
    (0..=scene.frames)
        .map(|k| {
            let t = k as f64 * scene.frame;
            [t, GRAVITY * (t + (-c * t).exp_m1() / c) / c / scene.side]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limits_start_as_they_must() {
        let scene = Scene {
            frame: 1e-3,
            damping: 1e-6,
            ..Scene::paper(4, 20)
        };
        let t: f64 = 0.02;
        let half = 0.5 * GRAVITY * t * t / scene.side;
        let (free, plate) = (free_fall(&scene)[20][1], plate_fall(&scene).unwrap()[20][1]);
        assert!((free / half - 1.0).abs() < 1e-3, "{free} {half}");
        // A uniform square plate held at a corner: 1/2 / (1/2 + 1/12) of free fall.
        assert!((plate / half - 6.0 / 7.0).abs() < 2e-3, "{plate} {half}");
    }

    #[test]
    fn a_sheet_falls_between_the_limits() {
        let scene = Scene {
            frame: 1.0 / 240.0,
            ..Scene::paper(1, 24)
        };
        let (sheet, plate, free) = (
            fall(&scene).unwrap(),
            plate_fall(&scene).unwrap(),
            free_fall(&scene),
        );
        for k in 8..=24 {
            assert!(
                plate[k][1] < sheet[k][1] && sheet[k][1] < free[k][1],
                "frame {k}"
            );
        }
    }
}
