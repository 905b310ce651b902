//! The first moments of the fall, between two limits: a rigid plate and matter that nothing holds together.

use super::hanging::gravity;
use super::{FigureScene, Hanging, Shape};
use anyhow::Result;
use isosheet_mesh::{MassKind, MassMatrix};

/// Time and depth of the centre of mass (seconds, sides) while a sheet falls from exactly flat, frame by
/// frame.
///
/// # Errors
/// Ctrl-C and errors of the simulation.
pub(crate) fn fall(scene: &FigureScene) -> Result<Vec<[f64; 2]>> {
    let hanging = Hanging::of(scene)?;
    let mut simulation = scene.setup()?.start()?;
    let frames = scene.play(&mut simulation)?;
    let later = frames.states()[1..]
        .iter()
        .map(|s| Ok([s.t, Shape::of(&hanging, &s.x)?.centre_depth]));
    std::iter::once(Ok([0.0, 0.0])).chain(later).collect()
}

/// The same for the sheet welded to a rigid plate that turns about the held corner.
///
/// With d half a diagonal, m the mass and I the moment of inertia of the vertex masses about the line through
/// the corner across the diagonal, the angle a below the horizon obeys `I a'' = m g d cos a - c I a'`;
/// damping c as in the scene.
pub(crate) fn plate_fall(scene: &FigureScene) -> Result<Vec<[f64; 2]>> {
    let Hanging { sheet, side, .. } = Hanging::of(scene)?;
    let (damping, gravity) = (scene.scene().sheet[0].damping, gravity(scene.scene()));
    let mass = MassMatrix::from_total(&sheet, 1.0, MassKind::Lumped)?.vertex;
    let inertia: f64 = sheet
        .topology()
        .vertex_ids()
        .map(|v| {
            let p = sheet.position(v);
            let along = super::PLATE * (p[0] + side - p[1]);
            mass[v.index()] * along * along
        })
        .sum();
    let d = side * super::PLATE;
    let rate = |a: f64, w: f64| [w, gravity * d / inertia * a.cos() - damping * w];
    // Steps of classical Runge-Kutta, a tenth of a frame each.
    let h = 0.1 * scene.frame();
    let (mut a, mut w) = (0.0, 0.0);
    let mut curve = vec![[0.0, 0.0]];
    for frame in 1..=scene.frames() {
        for _ in 0..10 {
            let k1 = rate(a, w);
            let k2 = rate(a + 0.5 * h * k1[0], w + 0.5 * h * k1[1]);
            let k3 = rate(a + 0.5 * h * k2[0], w + 0.5 * h * k2[1]);
            let k4 = rate(a + h * k3[0], w + h * k3[1]);
            a += h / 6.0 * (k1[0] + 2.0 * k2[0] + 2.0 * k3[0] + k4[0]);
            w += h / 6.0 * (k1[1] + 2.0 * k2[1] + 2.0 * k3[1] + k4[1]);
        }
        curve.push([frame as f64 * scene.frame(), d * a.sin() / side]);
    }
    Ok(curve)
}

/// The same for matter that falls freely with the damping of the scene: `g (t - (1 - exp(-c t)) / c) / c`.
///
/// # Errors
/// As [`Hanging::of`].
pub(crate) fn free_fall(scene: &FigureScene) -> Result<Vec<[f64; 2]>> {
    let side = Hanging::of(scene)?.side;
    let (c, gravity) = (scene.scene().sheet[0].damping, gravity(scene.scene()));
    let at = |k: usize| {
        let t = k as f64 * scene.frame();
        [t, gravity * (t + (-c * t).exp_m1() / c) / c / side]
    };
    Ok((0..=scene.frames()).map(at).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn falling(level: u32, frame: f64, frames: usize, more: &str) -> FigureScene {
        let edits = [
            format!("sheet.mesh.square.level={level}"),
            format!("method.step={frame:?}"),
            crate::runs::for_frames(frames, frame),
            more.to_owned(),
        ];
        let free = FigureScene::of("fig12", "test", &edits).unwrap();
        free.without_self_contact("falling").unwrap()
    }

    #[test]
    fn the_limits_start_as_they_must() {
        let scene = falling(4, 1e-3, 20, "sheet.damping=1e-6");
        let t: f64 = 0.02;
        let half = 0.5 * 9.8 * t * t / Hanging::of(&scene).unwrap().side;
        let (free, plate) = (
            free_fall(&scene).unwrap()[20][1],
            plate_fall(&scene).unwrap()[20][1],
        );
        assert!((free / half - 1.0).abs() < 1e-3, "{free} {half}");
        // A uniform square plate held at a corner: 1/2 / (1/2 + 1/12) of free fall.
        assert!((plate / half - 6.0 / 7.0).abs() < 2e-3, "{plate} {half}");
    }

    #[test]
    fn a_sheet_falls_between_the_limits() {
        let scene = falling(1, 1.0 / 240.0, 24, "sheet.damping=2.0");
        let (sheet, plate, free) = (
            fall(&scene).unwrap(),
            plate_fall(&scene).unwrap(),
            free_fall(&scene).unwrap(),
        );
        for k in 8..=24 {
            assert!(
                plate[k][1] < sheet[k][1] && sheet[k][1] < free[k][1],
                "frame {k}"
            );
        }
    }
}
