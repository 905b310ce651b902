//! Time reversal, renumbering, turning the frame, and the number of threads.

use super::naive::{GAUSS_SEIDEL, SWEEPS, TEXTBOOK, gauss_seidel_step, textbook_steps};
use super::scenes::{FRAME, apart, at_rest, course, go, pinned, tumbling};
use super::{Case, Findings, Work, semi_log};
use crate::draw::Series;
use crate::interrupt;
use crate::report::{Bound, Effort, Table};
use crate::runs::{Pairs, bumped, corner, hanging, on_table};
use crate::threads::pool;
use anyhow::Result;
use isosheet_collide::ContactOptions;
use isosheet_dynamics::{Method, SheetModel, Simulation, State, project_positions};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use isosheet_tests::{conservative, damped, energy_momentum};
use nalgebra::{Rotation3, Vector3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(crate) const REVERSAL: Case = Case {
    name: "time-reversal",
    title: "Time reversal",
    expected: "The equations of motion do not know the direction of time. A symmetric method that runs forward, turns the velocities round and runs as \
               many steps comes back to its start, but for rounding.",
    run: Work::Code(reversal),
};

/// Length of a step there and back, seconds.
const STEP: f64 = 4e-3;

fn reversal(f: &mut Findings, effort: Effort) -> Result<()> {
    let (model, start) = tumbling(0.1)?;
    let (mut x, mut v) = (start.x.clone(), start.v.clone());
    let turn = |k: usize, _: &[f64], v: &mut [f64]| {
        if k == 100 {
            v.iter_mut().for_each(|v| *v = -*v);
        }
    };
    let outcome = textbook_steps(&model, (&mut x, &mut v), STEP, 200, turn);
    let outcome = outcome.map(|()| apart(&x, &start.x));
    let what = "100 steps of 4 ms there and back: distance from the start, m";
    f.naive_run(TEXTBOOK, what, outcome, Bound::AtMost(1e-6));
    let counts = [10, 20, 50, 100, 200, 500, 1000, 2000];
    let counts = effort.pick(&[10, 40][..], &counts[..7], &counts);
    let judged = effort.pick(40, 50, 50);
    let mut lines = Vec::new();
    let bdf2 = ("BDF2 (damped)", Method::default());
    for (k, (name, method)) in conservative().into_iter().chain([bdf2]).enumerate() {
        let mut points = Vec::new();
        for &n in counts {
            let mut run = Simulation::new(tumbling(0.1)?.0, start.clone(), method.clone())?;
            let mut c = course(&mut run, STEP, n, |_, _| {})?;
            let State { x, v, .. } = run.state().clone();
            let back = State::moving(x, v.iter().map(|v| -v).collect());
            let run = Simulation::new(tumbling(0.1)?.0, back, method.clone())?;
            let (back, end) = go(run, STEP, n)?;
            c.add_run(back);
            let error = apart(&end, &start.x);
            points.push([n as f64 * STEP, c.if_good(error)]);
            if n == judged && k < 3 {
                let quantity = format!("distance from the start after {n} steps there and back, m");
                f.of(&c, name).at_most(&quantity, error, 1e-9);
            }
        }
        lines.push(Series::styled(k, name, points));
    }
    f.here = "M^1 folded, tumbling freely at about 2 rad/s, steps of 4 ms. Rounding grows with the motion's own instability and, for longer runs, decides; \
              a damped method is not meant to come back.";
    let drawing = semi_log(
        "time of the way out, s",
        "distance from the start, m",
        lines,
    );
    f.drawing(
        "time-reversal",
        &drawing,
        "There and back: distance from the start",
    );
    Ok(())
}

pub(crate) const SYMMETRY: Case = Case {
    name: "symmetry",
    title: "Renumbering and turning the frame",
    expected: "The motion does not depend on how vertices and faces are numbered, nor on the axes. In floating point it differs by rounding, which the motion \
               then amplifies as it amplifies any difference at the start.",
    run: Work::Code(symmetry),
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

impl Image {
    /// Of a sheet in the frame of the reference, with its positions as they are.
    fn of(sheet: Sheet, pin: VertexId) -> Self {
        Self {
            sheet,
            pin,
            gravity: [0.0, 0.0, -9.8],
            back: Box::new(<[f64]>::to_vec),
        }
    }
}

fn reference(level: u32) -> Result<Image> {
    Ok(Image::of(bumped(level, 0.05), corner(level)))
}

fn renumbered(level: u32, seed: u64) -> Result<Image> {
    let sheet = bumped(level, 0.05);
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
    let back = move |x: &[f64]| {
        let places = number.iter().flat_map(|&k| x[3 * k..3 * k + 3].to_vec());
        places.collect()
    };
    Ok(Image {
        back: Box::new(back),
        ..Image::of(Sheet::new(x, &faces)?, pin)
    })
}

fn turned(level: u32) -> Result<Image> {
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let sheet = bumped(level, 0.05).map_positions(|p| (turn * Vector3::from(p)).into())?;
    let back = move |x: &[f64]| {
        let places = x.chunks(3).map(Vector3::from_column_slice);
        let places = places.flat_map(|p| <[f64; 3]>::from(turn.inverse() * p));
        places.collect()
    };
    Ok(Image {
        gravity: (turn * Vector3::new(0.0, 0.0, -9.8)).into(),
        back: Box::new(back),
        ..Image::of(sheet, corner(level))
    })
}

/// Length of a step of the images, seconds.
const H: f64 = 5e-3;

fn symmetry(f: &mut Findings, effort: Effort) -> Result<()> {
    let steps = effort.pick(60, 400, 1000);
    // Gauss-Seidel goes through the rods in the order of their numbers.
    let naive = |image: &Image| -> Result<Vec<f64>> {
        let model = image.model()?;
        let mut x = image.sheet.positions().to_vec();
        let mut v = vec![0.0; x.len()];
        for _ in 0..20 {
            gauss_seidel_step(&model, (&mut x, &mut v), H, SWEEPS);
        }
        Ok((image.back)(&x))
    };
    let off = apart(&naive(&reference(1)?)?, &naive(&renumbered(1, 1)?)?);
    let what = "M^1 with other numbers of its rods: difference after 20 steps of 5 ms, m";
    f.naive(GAUSS_SEIDEL, what, off, Bound::AtMost(1e-6));
    let rounding = (f64::EPSILON, "rounding (2.2e-16 m)");
    let tolerance = (1e-12, "the tolerance of the lengths (1e-12 m)");
    // What a step is exact to: rounding, or the tolerance of the lengths.
    compare_images(f, "energy-momentum", &energy_momentum(), rounding, steps)?;
    compare_images(f, "BDF2", &Method::default(), tolerance, steps)?;
    f.here = "M^1 held at a corner, steps of 5 ms, beside the same sheet with other numbers and in another frame. Twin runs, which start 1e-10 m \
              apart, measure how a difference grows; the images differ by no more than errors of the steps that grow so.";
    Ok(())
}

/// How a small difference at the start grows over the steps `want` of the reference: the larger of two twins.
fn twin_growth(base: &Image, method: &Method, want: &[Vec<f64>]) -> Result<Vec<f64>> {
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
        let twin = base.motion(method.clone(), Some(&x), H, want.len())?;
        let mut largest = 1.0_f64;
        for (g, (a, b)) in growth.iter_mut().zip(twin.iter().zip(want)) {
            largest = largest.max(apart(a, b) / first);
            *g = g.max(largest);
        }
    }
    Ok(growth)
}

/// The renumbered and the turned sheet against the reference, by a method that is exact to `unit` metres.
fn compare_images(
    f: &mut Findings,
    name: &str,
    method: &Method,
    (unit, unit_name): (f64, &str),
    steps: usize,
) -> Result<()> {
    let base = reference(1)?;
    let want = base.motion(method.clone(), None, H, steps)?;
    let growth = twin_growth(&base, method, &want)?;
    let over_time = |values: &mut dyn Iterator<Item = f64>| -> Vec<[f64; 2]> {
        let points = (1..).zip(values);
        points.map(|(k, v)| [f64::from(k) * H, v]).collect()
    };
    let grown = over_time(&mut growth.iter().map(|g| unit * g));
    let mut lines = vec![Series::guide("error of a step × growth", grown)];
    let images = [
        ("vertices and faces renumbered", renumbered(1, 1)?),
        ("frame turned", turned(1)?),
    ];
    for (k, (what, image)) in images.into_iter().enumerate() {
        let got = image.motion(method.clone(), None, H, steps)?;
        let differences: Vec<f64> = got.iter().zip(&want).map(|(a, b)| apart(a, b)).collect();
        // While it is small: afterwards two motions are simply different.
        let small = differences.iter().zip(&growth).filter(|(d, _)| **d < 1e-2);
        let worst = small.map(|(d, g)| d / (unit * g)).fold(0.0, f64::max);
        // Errors of all steps add up, several of them a step, each grown since.
        f.at_most(
            format!(
                "{name}, {what}: largest difference over measured growth, in units of {unit_name}"
            ),
            if got.len() == steps { worst } else { f64::NAN },
            10.0 * steps as f64,
        );
        let first = format!("{name}, {what}: difference after the first 10 steps, m");
        f.at_most(first, differences[9], 1e2 * unit);
        let points = over_time(&mut differences.into_iter());
        lines.push(Series::curve(k, what, points));
    }
    if let Some(k) = growth.iter().position(|g| *g > 1e6) {
        let t = (k + 1) as f64 * H;
        let caption = format!("How fast differences grow, {name}");
        let grown = "a difference has grown a million times after, s";
        let row = vec![format!("{t:.2}")];
        f.tables
            .push(Table::new(caption, &[grown]).with_texts([row]));
    }
    let file = format!("symmetry-{}", name.to_lowercase());
    let alt = format!(
        "M^1 held at a corner, {name}, 5 ms: difference from the reference run, and the error of one step (2e-16 m for the conservative method, 1e-12 m for the damped one) times the growth measured with twin runs"
    );
    f.drawing(
        &file,
        &semi_log("time, s", "largest difference, m", lines),
        &alt,
    );
    Ok(())
}

pub(crate) const THREADS: Case = Case {
    name: "threads",
    title: "Number of threads",
    expected: "The same bits on one thread, on two, and beside other work.",
    run: Work::Code(threads),
};

/// Numbers that differ between runs on pools of 1, 2 and 4 threads and two runs at the same time.
fn differing(run: impl Fn() -> Result<Vec<f64>> + Sync) -> Result<usize> {
    let mut ends = Vec::new();
    for threads in [1, 2, 4] {
        ends.push(pool(threads)?.install(&run)?);
    }
    let (a, b) = pool(2)?.install(|| rayon::join(&run, &run));
    ends.extend([a?, b?]);
    Ok(ends[1..]
        .iter()
        .flat_map(|e| e.iter().zip(&ends[0]))
        .filter(|(a, b)| a.to_bits() != b.to_bits())
        .count())
}

fn threads(f: &mut Findings, effort: Effort) -> Result<()> {
    let steps = effort.pick(20, 120, 600);
    let level = effort.pick(1, 2, 3);
    let damped = damped().map(|(name, method)| (name, method, 0.0));
    let conservative = ("energy-momentum", energy_momentum(), 0.1);
    for (name, method, bump) in damped.into_iter().chain([conservative]) {
        let different = differing(|| {
            let (_, end) = go(hanging(level, bump, method.clone())?, FRAME, steps)?;
            Ok(end)
        })?;
        let what = format!("M^{level}, {name}: numbers that differ after {steps} steps");
        f.at_most(what, different as f64, 0.0);
    }
    // Thousands of pairs to judge, whose order decides the last bits of sums and of safe motions.
    let steps = effort.pick(1, 4, 12);
    let what = format!("M^4 on a table and itself, BDF2: numbers that differ after {steps} steps");
    f.at_most(what, differing(|| cloth(steps))? as f64, 0.0);
    // What a sum over threads does when its order is left to chance.
    let sign = |k: i32| if k % 2 == 0 { 1.0 } else { -1.0 };
    let values = (0..200_000).map(|k| 1.0 / f64::from(k + 1).powf(1.3) * sign(k));
    let values: Vec<f64> = values.collect();
    let sums = [1_usize, 2, 3, 4, 5, 7].map(|parts| {
        let parts = values.chunks(values.len().div_ceil(parts));
        parts.map(|c| c.iter().sum::<f64>()).sum::<f64>()
    });
    let offs = sums.iter().map(|s| (s - sums[0]).abs() / sums[0].abs());
    let spread = offs.fold(0.0, f64::max);
    let method = "A sum over as many parts as there are threads";
    let what = "200 000 terms in 1 to 7 parts: relative difference of the sums";
    f.naive(method, what, spread, Bound::AtMost(0.0));
    f.here = "Large factorisations share the subtrees of their elimination trees among threads and add them up in a fixed order; all else of a run is \
              done by one thread. Compared: pools of 1, 2 and 4 threads, and two runs at the same time.";
    Ok(())
}

/// The end of some steps of a cloth that touches a table and itself.
fn cloth(steps: usize) -> Result<Vec<f64>> {
    let sheet = bumped(4, 0.1);
    let model = pinned(&sheet, &[])?;
    let options = ContactOptions::for_sheet(&model);
    // Just below the lowest part of the bump above it.
    let table = ([0.25, 0.25, 0.1], 0.05 - 0.95 * options.activation);
    let contacts = on_table(&model, options, table, Pairs::TableAndItself)?;
    let run = at_rest(model, sheet.positions(), Method::default())?;
    let (c, end) = go(run.with_contact(contacts)?, 1e-3, steps)?;
    c.error.map_or(Ok(end), |error| Err(error.into()))
}
