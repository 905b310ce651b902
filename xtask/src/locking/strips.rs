//! Strips whose shape and energy are known in closed form: loaded, hanging, pushed together, bent.

use super::model::{Model, PAPER, Plate};
use super::nudge::Nudge;
use super::runs::{Ran, Records, samples};
use super::scene::{DAMPING, End, run, until_rest};
use crate::report::Table;
use crate::runs::Plan;
use crate::runs::meshes::{Grid, vertices, with_line};
use anyhow::Result;
use isosheet_dynamics::{PointProfile, Profile, SheetModel, Support};
use isosheet_mesh::{Sheet, VertexId};
use isosheet_tests::{Elastica, buckled, implicit_euler};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Unit of length, metres: the width. Length of the free part, and of each clamp.
const WIDTH: f64 = 0.1;
const LENGTH: f64 = 4.0 * WIDTH;
const CLAMP: f64 = 0.5 * WIDTH;

/// Distance of the clamps of the strip that is pushed together, and curvature of the one that is bent, 1/m.
const PUSHED: f64 = 1.2 * WIDTH;
const CURVATURE: f64 = 1.0 / LENGTH;

/// How long the clamps move, and until when a force chooses the side, seconds.
const MOVING: f64 = 4.0;
const NUDGED: f64 = 2.0;

/// The force that chooses the side, over `D / a`: it lifts the middle of the flat strip by about a tenth of
/// its width.
const NUDGE: f64 = 0.5;

/// What is done to a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum StripCase {
    /// A load upwards, 1.6 in units of `D / L^3`: the one of Bartels.
    #[serde(rename = "loaded")]
    Loaded,
    /// A weight in units of `D / L^3`.
    #[serde(rename = "heavy, Γ = 1")]
    Heavy1,
    #[serde(rename = "heavy, Γ = 10")]
    Heavy10,
    #[serde(rename = "heavy, Γ = 100")]
    Heavy100,
    #[serde(rename = "pushed together")]
    Pushed,
    #[serde(rename = "bent")]
    Bent,
}

/// A strip of a case on a mesh.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct StripJob {
    strip: StripCase,
    mesh: Grid,
    #[serde(rename = "squares across")]
    across: usize,
}

/// What is measured of a strip: energies in joules, places of the tip or of the middle in metres; errors at
/// rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Rested {
    #[serde(rename = "energy, J")]
    energy: f64,
    #[serde(rename = "exact energy, J")]
    exact: f64,
    #[serde(rename = "in the plane, J")]
    membrane: f64,
    #[serde(rename = "x, m")]
    x: f64,
    #[serde(rename = "exact x, m")]
    exact_x: f64,
    #[serde(rename = "z, m")]
    z: f64,
    #[serde(rename = "exact z, m")]
    exact_z: f64,
    #[serde(rename = "error of the energy")]
    energy_error: Option<f64>,
    /// Distance of the tip from its exact place, over how far that place is from the flat strip.
    #[serde(rename = "error of the place")]
    place_error: Option<f64>,
    #[serde(rename = "error of the moment")]
    moment_error: Option<f64>,
}

impl StripCase {
    const ALL: [Self; 6] = [
        Self::Loaded,
        Self::Heavy1,
        Self::Heavy10,
        Self::Heavy100,
        Self::Pushed,
        Self::Bent,
    ];

    /// Load per area upwards, newtons per square metre.
    fn load(self) -> Option<f64> {
        let unit = PAPER.rigidity / LENGTH.powi(3);
        match self {
            Self::Loaded => Some(0.025 * PAPER.rigidity / WIDTH.powi(3)),
            Self::Heavy1 => Some(-unit),
            Self::Heavy10 => Some(-10.0 * unit),
            Self::Heavy100 => Some(-100.0 * unit),
            Self::Pushed | Self::Bent => None,
        }
    }

    /// Energy in joules and the place of the tip or of the middle, metres (along x and z).
    fn exact(self) -> (f64, [f64; 2]) {
        if self == Self::Bent {
            let [x, _, z] = bent(CURVATURE, [0.5 * LENGTH, 0.0]);
            return (
                0.5 * PAPER.rigidity * CURVATURE * CURVATURE * LENGTH * WIDTH,
                [x, z],
            );
        }
        let Some(load) = self.load() else {
            let [energy, height] = buckled(PUSHED / LENGTH);
            let energy = energy * PAPER.rigidity * WIDTH / LENGTH;
            return (energy, [0.5 * PUSHED, height * LENGTH]);
        };
        let elastica = Elastica {
            length: LENGTH,
            rigidity: PAPER.rigidity,
            weight: load.abs(),
        };
        let hanging = elastica.at_rest();
        (
            hanging.energy * WIDTH,
            [hanging.tip[0], load.signum() * hanging.tip[1]],
        )
    }

    fn sheet(self, mesh: Grid, across: usize) -> Result<Sheet> {
        let cell = WIDTH / across as f64;
        let beyond = self.load().map_or(CLAMP, |_| 0.0);
        let mut sheet = mesh.rectangle([-CLAMP, 0.0], [LENGTH + beyond, WIDTH], cell)?;
        for (x, is_there) in [
            (0.0, true),
            (0.5 * LENGTH, beyond > 0.0),
            (LENGTH, beyond > 0.0),
        ] {
            if is_there {
                sheet = with_line(&sheet, x, cell)?;
            }
        }
        Ok(sheet)
    }

    fn clamp(self, sheet: &Sheet) -> Vec<VertexId> {
        let beyond = self.load().map_or(LENGTH - 1e-9, |_| f64::INFINITY);
        vertices(sheet, |[x, ..]| x < 1e-9 || x > beyond)
    }

    /// The vertices whose mean place is measured.
    fn measured(self, sheet: &Sheet) -> Vec<VertexId> {
        let place = self.load().map_or(0.5 * LENGTH, |_| LENGTH);
        vertices(sheet, |[x, ..]| (x - place).abs() < 1e-9)
    }

    fn model(self, model: Model, sheet: &Sheet, plate: Plate<'_>) -> Result<SheetModel> {
        let mut moved = model.sheet(sheet, plate)?.with_damping(DAMPING)?;
        if let Some(load) = self.load() {
            let moved = moved.with_acceleration([0.0, 0.0, load / plate.density]);
            return Ok(moved.with_pins(plate.clamped)?);
        }
        if self == Self::Pushed {
            let middle = self.measured(sheet);
            let force = NUDGE * plate.rigidity / WIDTH / middle.len() as f64;
            moved = moved.with_potential(Nudge {
                forces: middle.into_iter().map(|v| (v, force)).collect(),
                end: NUDGED,
            });
        }
        let course = |to| Profile::SmoothStep {
            from: 0.0,
            to,
            begin: 0.0,
            end: MOVING,
        };
        for &v in plate.clamped {
            let offset = sheet.position(v);
            moved = match self {
                _ if offset[0] < 1e-9 => moved.with_pins(&[v])?,
                Self::Bent => {
                    let curvature = course(CURVATURE);
                    moved.with_moving_pin(v, move |t| {
                        bent(curvature.value(t), [offset[0], offset[1]])
                    })?
                }
                _ => {
                    let x = course(PUSHED - LENGTH);
                    let push = PointProfile {
                        offset,
                        x,
                        ..PointProfile::default()
                    };
                    moved.with_moving_pin(v, push)?
                }
            };
        }
        Ok(moved)
    }
}

/// The place of the point (x, y) of the flat strip when the part between the clamps has the curvature `k`,
/// metres.
fn bent(k: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let s = x.clamp(0.0, LENGTH);
    // (sin ks) / k and (1 - cos ks) / k = tan(ks / 2) (sin ks) / k.
    let along = if k == 0.0 { s } else { (k * s).sin() / k };
    let (sin, cos) = (k * s).sin_cos();
    let (beyond, height) = (x - s, (0.5 * k * s).tan() * along);
    [along + beyond * cos, y, height + beyond * sin]
}

/// The moment of the pins on the moving clamp of a bent strip about its line, over D k per width; positive
/// where it bends towards +z.
fn moment(sheet: &Sheet, end: &End) -> f64 {
    let line = Vector3::from(bent(CURVATURE, [LENGTH, 0.0]));
    let mut moment = 0.0;
    for reaction in &end.reactions {
        if let Support::Pin(v) = reaction.support
            && sheet.position(v)[0] > 0.5 * LENGTH
        {
            let at: [f64; 3] = std::array::from_fn(|k| end.x[3 * v.index() + k]);
            // The right-handed moment about y turns +x towards -z.
            moment -= (Vector3::from(at) - line).cross(&reaction.force).y;
        }
    }
    moment / (PAPER.rigidity * CURVATURE * WIDTH)
}

fn measure(model: Model, force: f64, job: StripJob, plan: &Plan) -> Result<(Ran, Rested)> {
    let StripJob {
        strip,
        mesh,
        across,
    } = job;
    let sheet = strip.sheet(mesh, across)?;
    let clamped = strip.clamp(&sheet);
    let plate = Plate {
        force,
        clamped: &clamped,
        ..PAPER
    };
    let moved = strip.model(model, &sheet, plate)?;
    let (course, end) = run(model, moved, &sheet, implicit_euler(), plan)?;
    let ran = Ran::of(model, &sheet, &course);
    let elastic = model.energy(&sheet, plate, &end.x)?;
    let mut energy = elastic;
    if let Some(load) = strip.load() {
        let loaded = model.sheet(&sheet, plate)?;
        let loaded = loaded.with_acceleration([0.0, 0.0, load / plate.density]);
        energy = loaded.potential_energy(0.0, &end.x);
    }
    let at = strip.measured(&sheet);
    let [x, z] = [0, 2].map(|k| end.mean(&at, k, |value| value));
    let (exact, [exact_x, exact_z]) = strip.exact();
    let moment_error = (strip == StripCase::Bent).then(|| (moment(&sheet, &end) - 1.0).abs());
    let rested = Rested {
        energy,
        exact,
        membrane: elastic - model.bending_energy(&sheet, plate, &end.x)?,
        x,
        exact_x,
        z,
        exact_z,
        energy_error: ran.if_good((energy / exact - 1.0).abs()),
        place_error: ran.if_good((x - exact_x).hypot(z - exact_z) / exact_z.abs()),
        moment_error: moment_error.and_then(|error| ran.if_good(error)),
    };
    Ok((ran, rested))
}

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4, 8]);
    let grids: &[Grid] = effort.quick_or(&[Grid::Aligned, Grid::Delaunay1], &Grid::ALL);
    let plan = until_rest(effort.quick_or(2.0, 30.0));
    let mut jobs = Vec::new();
    for strip in StripCase::ALL {
        for &mesh in grids {
            jobs.extend(sizes.iter().map(|&across| StripJob {
                strip,
                mesh,
                across,
            }));
        }
    }
    samples(&records.of_models(&jobs, |model, job| measure(model, PAPER.force, *job, &plan))?)
}

/// Strips that bend much on meshes without lines across the bend, with another force of the slack: the
/// largest errors of energy and place; nothing where one of the strips does not come to rest.
pub(super) fn with_force(
    model: Model,
    force: f64,
    across: usize,
    plan: &Plan,
) -> Result<[Option<f64>; 2]> {
    let mut worst = [Some(0.0_f64); 2];
    for strip in [StripCase::Heavy100, StripCase::Pushed] {
        for mesh in Grid::ALL
            .into_iter()
            .filter(|g| !matches!(g, Grid::Aligned | Grid::Crossed))
        {
            let job = StripJob {
                strip,
                mesh,
                across,
            };
            let (_, rested) = measure(model, force, job, plan)?;
            let errors = [rested.energy_error, rested.place_error];
            worst = std::array::from_fn(|k| worst[k].zip(errors[k]).map(|(a, b)| a.max(b)));
        }
    }
    Ok(worst)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_strip_has_its_clamps_and_its_middle() {
        for case in StripCase::ALL {
            for grid in Grid::ALL {
                for across in [2, 4] {
                    let sheet = case.sheet(grid, across).unwrap();
                    let on = |x: f64| vertices(&sheet, |p| (p[0] - x).abs() < 1e-9).len();
                    assert!(on(0.0) > across && on(LENGTH) > across, "{case:?} {grid:?}");
                    assert!(case.clamp(&sheet).len() > on(0.0));
                    assert!(case.measured(&sheet).len() > across);
                }
            }
        }
    }

    /// Lengths along the strip are kept, and the clamps stay flat, at every curvature.
    #[test]
    fn the_cylinder_is_isometric_and_the_clamps_are_flat() {
        for k in [0.0, 1e-9, 1.0, CURVATURE] {
            let at = |x: f64| Vector3::from(bent(k, [x, 0.3]));
            let whole = LENGTH + 2.0 * CLAMP;
            let place = |i: u32| at(-CLAMP + whole * f64::from(i) / 4000.0);
            let length: f64 = (0..4000).map(|i| (place(i + 1) - place(i)).norm()).sum();
            assert!((length - whole).abs() < 1e-7, "{k} {length}");
            let [a, b, c] = [0.0, 0.5, 1.0].map(|part| at(LENGTH + part * CLAMP));
            assert!((0.5 * (a + c) - b).norm() < 1e-15);
        }
    }

    /// On mesh lines a coarse elastic strip has the energy of the cylinder, and pulls with its moment.
    #[test]
    fn an_aligned_strip_has_energy_and_moment_of_the_cylinder() {
        let job = StripJob {
            strip: StripCase::Bent,
            mesh: Grid::Aligned,
            across: 4,
        };
        let plan = until_rest(20.0);
        let (ran, rested) = measure(Model::Elastic, PAPER.force, job, &plan).unwrap();
        assert_eq!(ran.is_good, 1, "{ran:?}");
        for error in [rested.energy_error, rested.place_error, rested.moment_error] {
            assert!(error.unwrap() < 0.05, "{rested:?}");
        }
    }
}
