//! Yardstick 3: a square with a natural curvature, which a smooth inextensible sheet follows exactly.

use super::course::{Course, Plan, Scene};
use super::cylinder_fit::{CylinderFit, aligned, fit};
use super::effort::LockingEffort;
use super::findings::Findings;
use super::isometry::{Isometry, bending_energy};
use super::meshes::Pattern;
use super::plot::{order, panels, series};
use super::table::{Results, number};
use crate::draw::Drawing;
use crate::progress::Progress;
use anyhow::Result;
use isosheet_dynamics::{CreaseSpring, CreaseSprings, Method};
use isosheet_mesh::{Sheet, fold_angle, generate};

pub(super) const ABOUT: &str = "A free square of 1 m with the flexural rigidity 1 N m and without weight has a natural curvature of 1/m about an axis in its \
    plane. A smooth inextensible sheet takes the shape of that cylinder, with bending energy D κ² / 2 per area and nothing left of the energy of \
    misfit; there are no boundary layers. In the mesh the rest angle of every crease is the fold angle between the triangles whose corners are on the exact cylinder. \
    The axis is turned against the mesh: at 0 degrees it runs along mesh lines. Measured at rest, relative to the exact values: the \
    energy of bending against the flat state; the energy of misfit, of D κ² / 2; the curvature of the cylinder that fits the vertices best (least squares); \
    the root mean square distance of the vertices from it.";

/// Natural curvature, 1/m.
const CURVATURE: f64 = 1.0;

/// Flexural rigidity, N m. The state at rest does not depend on it; with the mass per area it makes a
/// fundamental period of a fraction of a second.
const RIGIDITY: f64 = 1.0;

/// Mass, kilograms, and rate of damping, 1/s.
const MASS: f64 = 0.1;
const DAMPING: f64 = 4.0;

/// Steps of implicit Euler, seconds: long ones, which damp all motion.
const STEP: f64 = 0.05;

/// The sheet is at rest when no vertex is faster, metres per second.
const REST: f64 = 1e-4;

/// Relative energies and curvatures and distances (metres) below this are those of a sheet that has come to
/// rest to within [`REST`], and say nothing about the mesh.
const FLOOR: f64 = 1e-8;

/// Directions of the axis against the mesh, degrees.
pub(super) const DIRECTIONS: [f64; 5] = [0.0, 15.0, 22.5, 30.0, 45.0];

/// A square about the origin, its mesh lines turned by `degrees` against the axis of curvature, y.
fn square(pattern: Pattern, cells: usize, degrees: f64) -> Result<Sheet> {
    let cell = 1.0 / cells as f64;
    let sheet = match pattern {
        Pattern::UnionJack if cells.is_power_of_two() => {
            generate::isotropic_square(cells.ilog2() - 1, 1.0)?
        }
        _ => pattern.rectangle([0.0; 2], [1.0; 2], cell, 0.0)?,
    };
    let (s, c) = degrees.to_radians().sin_cos();
    Ok(sheet.map_positions(|[x, y, z]| {
        let (x, y) = (x - 0.5, y - 0.5);
        [c * x - s * y, s * x + c * y, z]
    })?)
}

/// The vertices on the exact cylinder about the y direction that bends towards +z.
fn exact(sheet: &Sheet) -> Vec<f64> {
    let points = sheet.positions().as_chunks::<3>().0;
    points
        .iter()
        .flat_map(|[x, y, _]| {
            let (s, c) = (CURVATURE * x).sin_cos();
            [s / CURVATURE, *y, (1.0 - c) / CURVATURE]
        })
        .collect()
}

/// Springs as stiff as those of [`CreaseSprings::bending`], at rest on the exact cylinder.
fn natural(sheet: &Sheet) -> Result<CreaseSprings> {
    let (t, target) = (sheet.topology(), exact(sheet));
    let mut springs = Vec::new();
    for edge in t.edge_ids() {
        let [Some(left), Some(right)] = t.edge_faces(edge) else {
            continue;
        };
        let area = sheet.face_areas()[left.index()] + sheet.face_areas()[right.index()];
        springs.push(CreaseSpring {
            edge,
            stiffness: RIGIDITY * sheet.lengths()[edge.index()].powi(2) / area,
            rest: fold_angle(t, &target, edge).unwrap_or(0.0).into(),
        });
    }
    Ok(CreaseSprings::new(t, springs)?)
}

/// A square at rest.
struct Bent {
    pattern: Pattern,
    cells: usize,
    degrees: f64,
    vertices: usize,
    isometry: Isometry,
    course: Course,
    /// Energy of bending of the exact cylinder's vertices and at rest, of D k^2 / 2 per area.
    hinges: f64,
    bending: f64,
    /// Energy of misfit at rest, of the same.
    misfit: f64,
    fit: Option<CylinderFit>,
}

impl Bent {
    fn measure(
        isometry: Isometry,
        pattern: Pattern,
        cells: usize,
        degrees: f64,
        plan: &Plan,
    ) -> Result<Self> {
        let sheet = square(pattern, cells, degrees)?;
        let springs = natural(&sheet)?;
        let model = isometry
            .model(&sheet, MASS)?
            .with_potential(springs)
            .with_damping(DAMPING)?;
        let scene = Scene {
            model,
            start: sheet.positions().to_vec(),
            method: Method::ImplicitEuler(Default::default()),
            contacts: None,
        };
        let course = scene.run(plan)?;
        let (target, smooth) = (
            exact(&sheet),
            0.5 * RIGIDITY * CURVATURE * CURVATURE * sheet.area(),
        );
        let misfit = isosheet_dynamics::Potential::energy(&natural(&sheet)?, 0.0, &course.x);
        Ok(Self {
            pattern,
            cells,
            degrees,
            vertices: sheet.topology().vertex_count(),
            isometry,
            hinges: bending_energy(&sheet, RIGIDITY, &target)? / smooth,
            bending: bending_energy(&sheet, RIGIDITY, &course.x)? / smooth,
            misfit: misfit / smooth,
            fit: fit(&aligned(&course.x, &target), CURVATURE),
            course,
        })
    }

    fn spacing(&self) -> f64 {
        1.0 / self.cells as f64
    }

    /// The fit of a run that came to rest.
    fn at_rest(&self) -> Option<CylinderFit> {
        self.fit.filter(|_| self.course.ending.is_good())
    }

    fn curvature_error(&self) -> Option<f64> {
        Some((self.at_rest()?.curvature / CURVATURE - 1.0).abs())
    }

    fn distance(&self) -> Option<f64> {
        Some(self.at_rest()?.distance)
    }

    fn misfit_at_rest(&self) -> Option<f64> {
        self.course.ending.is_good().then_some(self.misfit)
    }
}

/// Runs the yardstick.
pub(super) fn make(effort: LockingEffort) -> Result<(Findings, Option<Drawing>)> {
    let plan = Plan {
        step: STEP,
        duration: 10.0,
        rest_speed: Some(REST),
        patience: effort.patience(0.4, 6.0),
    };
    let sizes: &[usize] = effort.pick(&[4], &[4, 8, 16, 32]);
    let directions: &[f64] = effort.pick(&[0.0, 22.5, 45.0], &DIRECTIONS);
    let count = Isometry::ALL.len() * Pattern::ALL.len() * sizes.len() * directions.len();
    let bar = Progress::start("cylinder", count);
    let mut all = Vec::new();
    for isometry in Isometry::ALL {
        for pattern in Pattern::ALL {
            for &degrees in directions {
                for &cells in sizes {
                    all.push(Bent::measure(isometry, pattern, cells, degrees, &plan)?);
                    bar.step();
                }
            }
        }
    }
    bar.finish("measured");
    let orders = orders(&all, directions);
    let drawing = plot(&all, directions);
    Ok((
        Findings {
            remarks: vec![remark(&all)],
            tables: vec![table(&all, &plan), orders],
            files: Vec::new(),
        },
        Some(drawing),
    ))
}

fn table(all: &[Bent], plan: &Plan) -> Results {
    let mut table = Results::new(
        "cylinder",
        format!(
            "Squares with a natural curvature of 1/m: implicit Euler, steps of {STEP} s, until no vertex is faster than {REST} m/s; at most \
             {} s of wall time. The energy of the exact cylinder's vertices is that of the springs alone: its error is not one of locking",
            plan.patience.as_secs_f64()
        ),
        &[
            "mesh",
            "axis, degrees",
            "h, m",
            "V",
            "model",
            "ending",
            "t at the end, s",
            "factorisations",
            "bending energy of the exact vertices",
            "bending energy",
            "misfit energy",
            "curvature",
            "distance, m",
            "axis off by, degrees",
            "message",
        ],
    );
    for b in all {
        let fit = b.fit;
        table.push(vec![
            b.pattern.to_string().into(),
            b.degrees.into(),
            b.spacing().into(),
            b.vertices.into(),
            b.isometry.to_string().into(),
            b.course.ending.name().into(),
            b.course.t.into(),
            b.course.factorisations.into(),
            b.hinges.into(),
            b.bending.into(),
            b.misfit.into(),
            fit.map(|f| f.curvature / CURVATURE).into(),
            fit.map(|f| f.distance).into(),
            fit.map(|f| f.turned.to_degrees()).into(),
            b.course.ending.message().into(),
        ]);
    }
    table
}

type Measure = fn(&Bent) -> Option<f64>;

/// Points of an error against the spacing.
fn points(
    all: &[Bent],
    pattern: Pattern,
    isometry: Isometry,
    degrees: f64,
    measure: Measure,
) -> Vec<[f64; 2]> {
    all.iter()
        .filter(|b| b.pattern == pattern && b.isometry == isometry && b.degrees == degrees)
        .filter_map(|b| Some([b.spacing(), measure(b)?]))
        .collect()
}

fn orders(all: &[Bent], directions: &[f64]) -> Results {
    let mut table = Results::new(
        "cylinder-orders",
        "Fitted powers of h, of the runs that came to rest: misfit energy, error of the curvature, distance from the cylinder; values below 1e-8 are left out, in the figure too",
        &[
            "mesh",
            "axis, degrees",
            "model",
            "runs at rest",
            "misfit energy",
            "curvature",
            "distance",
        ],
    );
    for isometry in Isometry::ALL {
        for pattern in Pattern::ALL {
            for &degrees in directions {
                let of = |measure: Measure| points(all, pattern, isometry, degrees, measure);
                table.push(vec![
                    pattern.to_string().into(),
                    degrees.into(),
                    isometry.to_string().into(),
                    of(Bent::distance).len().into(),
                    order(&of(Bent::misfit_at_rest), FLOOR).into(),
                    order(&of(Bent::curvature_error), FLOOR).into(),
                    order(&of(Bent::distance), FLOOR).into(),
                ]);
            }
        }
    }
    table
}

fn remark(all: &[Bent]) -> String {
    let at_rest = all.iter().filter(|b| b.course.ending.is_good()).count();
    let worst = all
        .iter()
        .filter_map(|b| Some((b, b.misfit_at_rest()?)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let mut text = format!("{at_rest} of {} squares come to rest.", all.len());
    if let Some((b, misfit)) = worst {
        text.push_str(&format!(
            " The largest energy of misfit among them is {} of D κ² / 2 per area: {} with {} cells, axis at {} degrees.",
            number(misfit),
            b.pattern,
            b.cells,
            b.degrees
        ));
    }
    text
}

/// The energy of misfit against the spacing, for every direction.
fn plot(all: &[Bent], directions: &[f64]) -> Drawing {
    let panel = |pattern: Pattern| {
        let line = |(k, &degrees): (usize, &f64)| {
            let mut points = points(all, pattern, Isometry::Rods, degrees, Bent::misfit_at_rest);
            points.retain(|p| p[1] > FLOOR);
            series(k, &format!("{degrees}°"), points)
        };
        let lines = directions.iter().enumerate().map(line).collect();
        (format!("{pattern}: misfit energy"), lines)
    };
    panels("~h~, m", Pattern::ALL.map(panel).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_dynamics::Potential;

    /// On mesh lines the hinges have the energy of the plate, up to the ends of the sheet: of n columns n - 1
    /// creases are inside, and each folds by exactly the angle of a cell.
    #[test]
    fn the_energy_of_an_aligned_cylinder_is_known() {
        for cells in [4, 8, 16] {
            let sheet = square(Pattern::UnionJack, cells, 0.0).unwrap();
            let energy = bending_energy(&sheet, RIGIDITY, &exact(&sheet)).unwrap();
            // n - 1 creases of n edges; an edge of length h between two triangles of h c / 2 each, c the
            // chord of the flat mesh: k = D h^2 / h^2 = D, and the angle is k h.
            let h = 1.0 / cells as f64;
            let known = 0.5 * RIGIDITY * (CURVATURE * h).powi(2) * (cells * (cells - 1)) as f64;
            assert!((energy / known - 1.0).abs() < 1e-12, "{energy} {known}");
        }
    }

    /// The exact cylinder is a minimum of the energy of misfit: energy and gradient vanish there, and the
    /// energy of the flat sheet is the one of bending the cylinder flat.
    #[test]
    fn the_exact_cylinder_is_the_rest_state() {
        for pattern in Pattern::ALL {
            for degrees in DIRECTIONS {
                let sheet = square(pattern, 8, degrees).unwrap();
                let (springs, target) = (natural(&sheet).unwrap(), exact(&sheet));
                assert!(springs.energy(0.0, &target) < 1e-25);
                let mut gradient = vec![0.0; target.len()];
                springs.add_gradient(0.0, &target, &mut gradient);
                assert!(gradient.iter().all(|g| g.abs() < 1e-10));
                let flat = springs.energy(0.0, sheet.positions());
                let bending = bending_energy(&sheet, RIGIDITY, &target).unwrap();
                assert!((flat - bending).abs() < 1e-12 * bending);
            }
        }
    }
}
