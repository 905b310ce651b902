//! Time reversal, renumbering, turning the frame, and the number of threads.

use super::naive::{GAUSS_SEIDEL, TEXTBOOK, gauss_seidel_step, textbook_step};
use super::scenes::{apart, at_rest, course, pinned, tumbling};
use super::{Case, Findings};
use crate::draw::Series;
use crate::interrupt;
use crate::methods::{conservative, damped, energy_momentum};
use crate::report::Effort;
use crate::report::number;
use crate::timing::{bumped, corner, hanging};
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{Method, SheetModel, Simulation, State, project_positions};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use nalgebra::{Isometry3, Rotation3, Vector3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(crate) const REVERSAL: Case = Case {
    name: "time-reversal",
    title: "Time reversal",
    expected: "The equations of motion do not know the direction of time. A symmetric method that runs forward, turns the velocities round and runs as \
               many steps comes back to its start, but for rounding.",
    run: reversal,
};

fn reversal(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let (model, start) = tumbling(0.1)?;
    let h = 4e-3;
    let (mut x, mut v) = (start.x.clone(), start.v.clone());
    let mut ended = None;
    for k in 0..200 {
        if let Err(e) = textbook_step(&model, &mut x, &mut v, h) {
            ended = Some(format!("step {}: {e}", k + 1));
            break;
        }
        if k == 99 {
            v.iter_mut().for_each(|v| *v = -*v);
        }
    }
    let off = apart(&x, &start.x);
    f.naive(
        TEXTBOOK,
        ended.clone().map_or_else(
            || {
                format!(
                    "100 steps of 4 ms there and back: ends {} m from the start.",
                    number(off)
                )
            },
            |e| format!("{e}."),
        ),
        ended.is_some() || off > 1e-6,
    );
    let counts: &[usize] = effort.pick(
        &[10, 40],
        &[10, 20, 50, 100, 200, 500, 1000],
        &[10, 20, 50, 100, 200, 500, 1000, 2000],
    );
    let mut lines = Vec::new();
    for (k, (name, method)) in conservative()
        .into_iter()
        .chain([("BDF2 (damped)", Method::default())])
        .enumerate()
    {
        let mut points = Vec::new();
        let mut early = (f64::NAN, None);
        for &n in counts {
            let mut run = Simulation::new(tumbling(0.1)?.0, start.clone(), method.clone())?;
            let there = course(&mut run, h, n, |_, _| {})?;
            let State { x, v, .. } = run.state().clone();
            let back = State::moving(x, v.iter().map(|v| -v).collect());
            let mut run = Simulation::new(tumbling(0.1)?.0, back, method.clone())?;
            let c = course(&mut run, h, n, |_, _| {})?;
            let error = there.if_finished(c.if_finished(apart(&run.state().x, &start.x)));
            points.push([n as f64 * h, error]);
            if n == 50 || counts.len() == 2 {
                early = (error, there.said().or(c.said()));
            }
        }
        if k < 3 {
            f.at_most(
                format!(
                    "{name}: distance from the start after {} steps there and back, m",
                    effort.pick(40, 50, 50)
                ),
                early.0,
                1e-9,
            )
            .remark(early.1);
        }
        lines.push(Series::styled(k, name, points));
    }
    f.here = "M^1 folded, tumbling freely at about 2 rad/s, steps of 4 ms. Rounding grows with the motion's own instability and, for longer runs, decides; \
              a damped method is not meant to come back."
        .into();
    f.drawing(
        "time-reversal",
        &super::semi_log(
            "time of the way out, s",
            "distance from the start, m",
            lines,
        ),
        "There and back: distance from the start",
    );
    Ok(f)
}

pub(crate) const SYMMETRY: Case = Case {
    name: "symmetry",
    title: "Renumbering and turning the frame",
    expected: "The motion does not depend on how vertices and faces are numbered, nor on the axes. In floating point it differs by rounding, which the motion \
               then amplifies as it amplifies any difference at the start.",
    run: symmetry,
};

/// Twin runs start this far apart, metres.
const TWIN: f64 = 1e-10;

/// A map of positions onto those of the reference.
type Back = Box<dyn Fn(&[f64]) -> Vec<f64>>;

/// A scene that moves like the reference: its sheet, pin and gravity, and the map of its positions onto
/// those of the reference.
struct Image {
    sheet: Sheet,
    pin: VertexId,
    gravity: [f64; 3],
    back: Back,
}

impl Image {
    fn model(&self) -> Result<SheetModel> {
        Ok(SheetModel::new(&self.sheet, 0.1, MassKind::Lumped)?
            .with_acceleration(self.gravity)
            .with_pins(&[self.pin])?)
    }

    /// Positions after every step, mapped back.
    fn motion(
        &self,
        method: Method,
        x: Option<&[f64]>,
        h: f64,
        steps: usize,
    ) -> Result<Vec<Vec<f64>>> {
        let mut run = at_rest(self.model()?, x.unwrap_or(self.sheet.positions()), method)?;
        let mut all = Vec::with_capacity(steps);
        course(&mut run, h, steps, |_, s| all.push((self.back)(&s.x)))?;
        Ok(all)
    }
}

fn reference(level: u32) -> Result<Image> {
    Ok(Image {
        sheet: bumped(level, 0.05)?,
        pin: corner(level),
        gravity: [0.0, 0.0, -9.8],
        back: Box::new(<[f64]>::to_vec),
    })
}

fn renumbered(level: u32, seed: u64) -> Result<Image> {
    let sheet = bumped(level, 0.05)?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let n = sheet.topology().vertex_count();
    // Vertex v becomes number[v].
    let mut number: Vec<usize> = (0..n).collect();
    number.shuffle(&mut rng);
    let mut x = vec![0.0; 3 * n];
    for v in 0..n {
        x[3 * number[v]..3 * number[v] + 3].copy_from_slice(&sheet.positions()[3 * v..3 * v + 3]);
    }
    let mut faces: Vec<[u32; 3]> = sheet
        .face_indices()
        .iter()
        .map(|f| {
            let mut g = f.map(|v| number[v as usize] as u32);
            g.rotate_left(rng.random_range(0..3));
            g
        })
        .collect();
    faces.shuffle(&mut rng);
    let pin = VertexId(number[corner(level).index()] as u32);
    Ok(Image {
        sheet: Sheet::new(x, &faces)?,
        pin,
        gravity: [0.0, 0.0, -9.8],
        back: Box::new(move |x| {
            number
                .iter()
                .flat_map(|&k| x[3 * k..3 * k + 3].to_vec())
                .collect()
        }),
    })
}

fn turned(level: u32) -> Result<Image> {
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let sheet = bumped(level, 0.05)?.map_positions(|p| (turn * Vector3::from(p)).into())?;
    Ok(Image {
        sheet,
        pin: corner(level),
        gravity: (turn * Vector3::new(0.0, 0.0, -9.8)).into(),
        back: Box::new(move |x| {
            x.chunks(3)
                .flat_map(|p| <[f64; 3]>::from(turn.inverse() * Vector3::from_column_slice(p)))
                .collect()
        }),
    })
}

fn symmetry(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let level = 1;
    let (h, steps) = (5e-3, effort.pick(60, 400, 1000));
    // Gauss-Seidel goes through the rods in the order of their numbers.
    let naive = |image: &Image| -> Result<Vec<f64>> {
        let model = image.model()?;
        let (mut x, mut v) = (
            image.sheet.positions().to_vec(),
            vec![0.0; image.sheet.positions().len()],
        );
        for _ in 0..20 {
            gauss_seidel_step(&model, &mut x, &mut v, h);
        }
        Ok((image.back)(&x))
    };
    let off = apart(&naive(&reference(level)?)?, &naive(&renumbered(level, 1)?)?);
    f.naive(
        GAUSS_SEIDEL,
        format!("Renumbered, M^1 is {} m away after 20 steps of 5 ms: the result depends on the order of the rods.", number(off)),
        off > 1e-6,
    );
    // What a step is exact to: rounding, or the tolerance of the lengths.
    for (name, method, unit) in [
        ("energy-momentum", energy_momentum(), f64::EPSILON),
        ("BDF2", Method::default(), 1e-12),
    ] {
        let base = reference(level)?;
        let want = base.motion(method.clone(), None, h, steps)?;
        // The growth of a small difference: the larger of two twins.
        let mut growth = vec![0.0_f64; want.len()];
        for seed in [3, 4] {
            interrupt::check()?;
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut x = base.sheet.positions().to_vec();
            let pin = 3 * base.pin.index();
            for (i, x) in x.iter_mut().enumerate() {
                if !(pin..pin + 3).contains(&i) {
                    *x += rng.random_range(-TWIN..TWIN);
                }
            }
            project_positions(&base.model()?, &mut x, 2e-14)?;
            let first = apart(&x, base.sheet.positions());
            let twin = base.motion(method.clone(), Some(&x), h, steps)?;
            let mut largest = 1.0_f64;
            for (g, (a, b)) in growth.iter_mut().zip(twin.iter().zip(&want)) {
                largest = largest.max(apart(a, b) / first);
                *g = g.max(largest);
            }
        }
        let mut lines = vec![Series::guide(
            "error of a step × growth",
            growth
                .iter()
                .enumerate()
                .map(|(k, g)| [(k + 1) as f64 * h, unit * g])
                .collect(),
        )];
        for (k, (what, image)) in [
            ("vertices and faces renumbered", renumbered(level, 1)?),
            ("frame turned", turned(level)?),
        ]
        .into_iter()
        .enumerate()
        {
            let got = image.motion(method.clone(), None, h, steps)?;
            let differences: Vec<f64> = got.iter().zip(&want).map(|(a, b)| apart(a, b)).collect();
            // While it is small: afterwards two motions are simply different.
            let worst = differences
                .iter()
                .zip(&growth)
                .filter(|(d, _)| **d < 1e-2)
                .map(|(d, g)| d / (unit * g))
                .fold(0.0, f64::max);
            f.at_most(
                format!(
                    "{name}, {what}: largest difference over measured growth, in units of {}",
                    if unit < 1e-15 {
                        "rounding (2.2e-16 m)"
                    } else {
                        "the tolerance of the lengths (1e-12 m)"
                    }
                ),
                if got.len() == steps { worst } else { f64::NAN },
                // Errors of all steps add up, several of them a step, each grown since.
                10.0 * steps as f64,
            );
            f.at_most(
                format!("{name}, {what}: difference after the first 10 steps, m"),
                differences[9],
                1e2 * unit,
            );
            lines.push(Series::curve(
                k,
                what,
                differences
                    .iter()
                    .enumerate()
                    .map(|(k, d)| [(k + 1) as f64 * h, *d])
                    .collect(),
            ));
        }
        let last = growth
            .iter()
            .zip(1..)
            .map(|(g, k)| (g, f64::from(k) * h))
            .find(|(g, _)| **g > 1e6);
        if let Some((_, t)) = last {
            f.here.push_str(&format!(
                "{name}: a difference has grown a million times after {t:.2} s. "
            ));
        }
        let file = format!(
            "symmetry-{}",
            if name == "BDF2" {
                "bdf2"
            } else {
                "energy-momentum"
            }
        );
        f.drawing(&file, &super::semi_log("time, s", "largest difference, m", lines), &format!("M^1 held at a corner, {name}, 5 ms: difference from the reference run, and the error of one step (2e-16 m for the conservative method, 1e-12 m for the damped one) times the growth measured with twin runs"));
    }
    Ok(f)
}

pub(crate) const THREADS: Case = Case {
    name: "threads",
    title: "Number of threads",
    expected: "The same bits on one thread, on two, and beside other work.",
    run: threads,
};

/// Numbers that differ between runs on pools of 1, 2 and 4 threads and two runs at the same time.
fn differing(run: impl Fn() -> Result<Vec<f64>> + Sync) -> Result<usize> {
    let mut ends = Vec::new();
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        ends.push(pool.install(&run)?);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let (a, b) = pool.install(|| rayon::join(&run, &run));
    ends.extend([a?, b?]);
    Ok(ends[1..]
        .iter()
        .flat_map(|e| e.iter().zip(&ends[0]))
        .filter(|(a, b)| a.to_bits() != b.to_bits())
        .count())
}

fn threads(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let steps = effort.pick(20, 120, 600);
    let level = effort.pick(1, 2, 3);
    let motion = |method: Method, bump: f64| -> Result<Vec<f64>> {
        let mut run = hanging(level, bump, method)?;
        course(&mut run, super::scenes::FRAME, steps, |_, _| {})?;
        Ok(run.state().x.clone())
    };
    // Thousands of pairs to judge, whose order decides the last bits of sums and of safe motions.
    let cloth_steps = effort.pick(1, 4, 12);
    let cloth = || -> Result<Vec<f64>> {
        let sheet = bumped(4, 0.1)?;
        let model = pinned(&sheet, &[])?;
        let options = ContactOptions::for_sheet(&model);
        let table = Shape::Cuboid {
            half: [0.25, 0.25, 0.1],
        };
        // Just below the lowest part of the bump above it.
        let pose = Isometry3::translation(0.5, 0.5, 0.05 - 0.1 - 0.95 * options.activation);
        let contacts = Contacts::new(&model, options)?
            .with_body(Obstacle::fixed(table, pose)?, Coefficients::FRICTIONLESS)?
            .with_self_contact(Coefficients::FRICTIONLESS)?;
        let run = at_rest(model, sheet.positions(), Method::default())?;
        let mut run = run.with_contact(contacts)?;
        match course(&mut run, 1e-3, cloth_steps, |_, _| {})?.refusal {
            None => Ok(run.state().x.clone()),
            Some(error) => Err(error.into()),
        }
    };
    let methods = damped().map(|m| (m.0, m.1, 0.0)).into_iter().chain([(
        "energy-momentum",
        energy_momentum(),
        0.1,
    )]);
    for (name, method, bump) in methods {
        let different = differing(|| motion(method.clone(), bump))?;
        f.at_most(
            format!("M^{level}, {name}: numbers that differ after {steps} steps"),
            different as f64,
            0.0,
        );
    }
    f.at_most(
        format!("M^4 on a table and itself, BDF2: numbers that differ after {cloth_steps} steps"),
        differing(cloth)? as f64,
        0.0,
    );
    // What a sum over threads does when its order is left to chance.
    let values: Vec<f64> = (0..200_000)
        .map(|k| 1.0 / f64::from(k + 1).powf(1.3) * if k % 2 == 0 { 1.0 } else { -1.0 })
        .collect();
    let sums: Vec<f64> = [1_usize, 2, 3, 4, 5, 7]
        .iter()
        .map(|parts| {
            values
                .chunks(values.len().div_ceil(*parts))
                .map(|c| c.iter().sum::<f64>())
                .sum()
        })
        .collect();
    let spread = sums
        .iter()
        .fold(0.0_f64, |m, s| m.max((s - sums[0]).abs() / sums[0].abs()));
    f.naive(
        "A sum over as many parts as there are threads",
        format!(
            "200 000 terms in 1 to 7 parts: the sums differ by {} relative.",
            number(spread)
        ),
        spread > 0.0,
    );
    f.here = "One run uses one thread, for its linear algebra and for contact, and keeps a fixed order; threads are used across runs. Compared: pools \
              of 1, 2 and 4 threads, and two runs at the same time."
        .into();
    Ok(f)
}
