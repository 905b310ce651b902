//! Clamped sheets with contact and in moving clamps.

use super::scenes::{FRAME, STRAIN, at_rest, go};
use super::{Case, Findings, Work};
use crate::locking::clamped::{Clamped, DAMPING, MASS};
use crate::report::{Effort, Table, number};
use crate::runs::Course;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{CreaseSprings, Method, PointMotion, SheetModel, Simulation, StepControl};
use isosheet_mesh::MassKind;
use nalgebra::{Isometry3, Rotation3, Vector3};

pub(crate) const CLAMPS: Case = Case {
    name: "clamps",
    title: "Clamped sheets above a floor and in moving clamps",
    expected: "Every run reaches its end with exact lengths and nothing passed through, or is refused because the rods lock, after a bounded number of \
               factorisations.",
    run: Work::Code(clamps),
};

/// What a clamped sheet has to do with.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scene {
    /// A floor so many metres below, and contact of the sheet with itself.
    Floor(f64),
    /// The clamp goes up by 10 cm in 0.3 s.
    Lift,
    /// The clamp turns by one radian about the y axis in 0.5 s.
    Turn,
}

const SCENES: [(&str, Scene); 5] = [
    ("floor out of reach", Scene::Floor(10.0)),
    ("floor 20 cm below", Scene::Floor(0.2)),
    ("floor 5 cm below", Scene::Floor(0.05)),
    ("clamp lifted", Scene::Lift),
    ("clamp turned", Scene::Turn),
];

const FRICTION: f64 = 0.3;

/// Goes from 0 to 1 in a time (seconds), without a jump of the velocity.
fn smooth(t: f64, duration: f64) -> f64 {
    let s = (t / duration).min(1.0);
    s * s * (3.0 - 2.0 * s)
}

impl Scene {
    /// Where the clamp takes a point, `None` if it stays where it is.
    fn motion(self, p: Vector3<f64>) -> Option<PointMotion> {
        match self {
            Self::Floor(_) => None,
            Self::Lift => {
                let up = move |t: f64| [p.x, p.y, p.z + 0.1 * smooth(t, 0.3)];
                Some(up.into())
            }
            Self::Turn => {
                let turn = move |t: f64| {
                    let rotation = Rotation3::from_axis_angle(&Vector3::y_axis(), smooth(t, 0.5));
                    (rotation * p).into()
                };
                Some(turn.into())
            }
        }
    }

    /// The simulation of a sheet of the family of locking.
    fn simulation(self, clamped: &Clamped) -> Result<Simulation> {
        let sheet = &clamped.sheet;
        let mut model = SheetModel::new(sheet, MASS, MassKind::Lumped)?
            .with_potential(CreaseSprings::bending(sheet, clamped.rigidity)?)
            .with_gravity()
            .with_damping(DAMPING)?
            .with_pins(&clamped.pins)?;
        for &v in &clamped.pins {
            if let Some(motion) = self.motion(sheet.position(v).into()) {
                model = model.with_moving_pin(v, motion)?;
            }
        }
        let Self::Floor(depth) = self else {
            return at_rest(model, sheet.positions(), Method::default());
        };
        let pose = Isometry3::translation(0.0, 0.0, -depth);
        let floor = Obstacle::fixed(Shape::HalfSpace, pose)?;
        let friction = Coefficients::equal(FRICTION);
        let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))?
            .with_body(floor, friction)?
            .with_self_contact(friction)?;
        let run = at_rest(model, sheet.positions(), Method::default())?;
        Ok(run.with_contact(contacts)?)
    }
}

/// The runs of a scene.
struct Runs {
    name: &'static str,
    /// Their number, and those of the ones that reached their end and that were refused because rods lock.
    runs: usize,
    complete: usize,
    locked: usize,
    /// All together.
    course: Course,
}

fn clamps(f: &mut Findings, effort: Effort) -> Result<()> {
    let (sheets, steps) = (effort.pick(5, 40, 200), effort.pick(20, 60, 120));
    let mut all = Vec::new();
    for (name, scene) in SCENES {
        let (mut course, mut complete, mut locked) = (Course::default(), 0, 0);
        for number in 0..sheets {
            let run = scene.simulation(&Clamped::new(number)?)?;
            let (own, _) = go(run, FRAME, steps)?;
            complete += usize::from(own.is_good());
            locked += usize::from(own.in_vain.is_some());
            course.add_run(own);
        }
        f.at_least(
            format!("{sheets} sheets, {name}: runs of {steps} steps that reach their end or are refused as locked"),
            (complete + locked) as f64,
            sheets as f64,
        );
        f.at_most(format!("{name}: edge strain"), course.strain, STRAIN);
        f.at_most(
            format!("{name}: most factorisations before a sheet is refused as locked"),
            course.in_vain.unwrap_or(0) as f64,
            StepControl::default().max_factorisations as f64,
        );
        if let Some(gap) = course.gap {
            let what = format!("{name}: smallest gap, m");
            f.at_least(what, gap, f64::MIN_POSITIVE);
        }
        all.push(Runs {
            name,
            runs: sheets,
            complete,
            locked,
            course,
        });
    }
    f.tables.push(table_of(&all));
    f.here = "A sheet of rods folds along lines of edges only. Where it is clamped across them its rods lock, and the step is refused with the vertices that \
              cannot move. What does not lock goes on to its end.";
    Ok(())
}

fn table_of(all: &[Runs]) -> Table {
    let of = |runs: &Runs| runs.course.cost.factorisations as f64 / runs.course.cost.steps as f64;
    Table::of(
        "Sheets of the family of clamped sheets (`cargo xtask locking`), BDF2 at 1/60 s from flat",
        all,
        &[
            ("scene", &|runs| runs.name.into()),
            ("runs that reach their end", &|runs| {
                format!("{} of {}", runs.complete, runs.runs).into()
            }),
            ("refused as locked", &|runs| runs.locked.to_string().into()),
            ("factorisations before a refusal, at most", &|runs| {
                (runs.course.in_vain).map_or("–".into(), |most| most.to_string().into())
            }),
            ("factorisations a step", &|runs| {
                format!("{:.1}", of(runs)).into()
            }),
            ("CPU s per simulated s", &|runs| {
                runs.course
                    .cpu_rate()
                    .map_or("–".into(), |cpu| number(cpu).into())
            }),
            ("most in a step", &|runs| {
                runs.course.worst.to_string().into()
            }),
            ("edge strain", &|runs| number(runs.course.strain).into()),
            ("smallest gap, m", &|runs| {
                runs.course.gap.map_or("–".into(), |gap| number(gap).into())
            }),
        ],
    )
}
