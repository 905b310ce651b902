//! Beyond the paper: a strip of paper is fed into a bent guide, and passes or jams.

use super::feed::{Feed, INNER, OUTER, PLATE};
use super::show::View;
use super::{Effort, Made, Picture, Row, Table, measured, rows};
use crate::draw::{
    Anchor, Axis, Chart, Charts, Colour, Drawing, Series, Stroke, TEXT, Vertical, Viewpoint,
    column, palette, row,
};
use crate::report::{Cell, columns};
use crate::runs::{FigureScene, Run};
use crate::store::Store;
use anyhow::{Result, ensure};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Scene files and names of the runs: three bends that let the strip through, and the second one again with
/// something stuck in it.
const CASES: [(&str, &str); 4] = [
    ("fig16-45mm", "feed-45mm"),
    ("fig16-20mm", "feed-20mm"),
    ("fig16-8mm", "feed-8mm"),
    ("fig16", "feed-20mm-blocked"),
];

/// The case that jams, and the same guide with nothing in the way.
const JAM: usize = 3;
const OPEN: usize = 1;

const COLOURS: [Colour; 4] = [
    palette::BLUE,
    palette::GREEN,
    palette::ORANGE,
    palette::VERMILION,
];

fn scene((file, name): (&str, &str), effort: Effort) -> Result<FigureScene> {
    let edits = effort.quick_or(vec!["stop.time=0.03".to_owned()], Vec::new());
    FigureScene::of(file, name, &edits)
}

/// A run and what it says.
struct Fed {
    feed: Feed,
    run: Run,
    /// Displacement of the nip (metres) and force of the nip on the strip in the direction of this
    /// displacement (newtons), mean over [`WINDOW`] frames.
    force: Vec<[f64; 2]>,
    /// Whether the nip slipped.
    jammed: bool,
    /// The middle line of the strip at every frame: x and z, from the nip on.
    profiles: Vec<Vec<[f64; 2]>>,
}

/// The force is drawn as the mean over this many frames: contact of single vertices with single facets makes
/// it rough.
const WINDOW: usize = 5;

impl Fed {
    fn of(scene: FigureScene, store: &Store) -> Result<Self> {
        let feed = Feed::of(&scene)?;
        let run = Run::of(store, scene)?;
        let forces = &run.supports();
        let force = forces
            .windows(WINDOW)
            .map(|w| {
                let mean = w.iter().map(|f| f[1]).sum::<f64>() / WINDOW as f64;
                [feed.displacement.value(w[WINDOW / 2][0]), mean]
            })
            .collect();
        let [along, across] = feed.cells;
        let profile = |x: &[f64]| -> Vec<[f64; 2]> {
            // The nip holds the first two.
            let first = (across / 2) * (along + 1) + 1;
            let at = |v: usize| [x[3 * v], x[3 * v + 2]];
            (first..first + along).map(at).collect()
        };
        Ok(Self {
            profiles: run.frames().map(profile).collect(),
            jammed: forces
                .last()
                .is_some_and(|f| f[1].hypot(f[2]).hypot(f[3]) > feed.limit),
            force,
            run,
            feed,
        })
    }

    fn label(&self) -> String {
        let open = self.feed.plate().map_or("", |_| ", blocked");
        format!("{:.0} mm{open}", 1e3 * self.feed.radius())
    }

    fn peak(&self) -> [f64; 2] {
        let largest = self.force.iter().max_by(|a, b| a[1].total_cmp(&b[1]));
        largest.copied().unwrap_or_default()
    }

    fn feed_length_at(&self, frame: usize) -> f64 {
        self.feed
            .displacement
            .value(frame as f64 * self.run.scene.frame())
    }

    /// The frame in which the leading edge first feels the plate.
    fn arrival(&self) -> Option<usize> {
        let [_, plate] = self.feed.plate()?.line[0];
        let near = plate + self.feed.activation;
        self.profiles
            .iter()
            .position(|p| p.last().is_some_and(|end| end[1] < near))
    }

    /// Frames in which a force larger than `passing` stops growing after the strip has reached the plate, and
    /// the forces.
    fn buckles(&self, passing: f64) -> Vec<(usize, f64)> {
        let Some(first) = self.arrival() else {
            return Vec::new();
        };
        // Means are dated at the middle of their window, supports are known from frame 1 on.
        let of_frame = |k: usize| k + 1 + WINDOW / 2;
        let peaks = self.force.windows(3).enumerate();
        peaks
            .filter(|(k, w)| of_frame(k + 1) > first && w[1][1] > w[0][1] && w[1][1] > w[2][1])
            .map(|(k, w)| (of_frame(k + 1), w[1][1]))
            .filter(|(_, force)| *force > passing)
            .collect()
    }

    /// The first of them.
    fn buckle(&self, passing: f64) -> Option<(usize, f64)> {
        self.buckles(passing).first().copied()
    }

    /// Length of the straight part of the channel that is left between nip and bend at a frame, metres.
    fn column(&self, frame: usize) -> f64 {
        self.profiles.get(frame).map_or(0.0, |p| -p[0][0])
    }

    /// The fold angle at each rung in the straight part of the channel: x (metres), turn (radians, positive
    /// upwards).
    fn turns(&self, frame: usize) -> Vec<[f64; 2]> {
        let Some(line) = self.profiles.get(frame) else {
            return Vec::new();
        };
        line.windows(3)
            .filter(|w| w[1][0] < 0.0)
            .map(|w| {
                let (u, v) = (
                    [w[1][0] - w[0][0], w[1][1] - w[0][1]],
                    [w[2][0] - w[1][0], w[2][1] - w[1][1]],
                );
                let turn = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
                [w[1][0], turn]
            })
            .collect()
    }

    /// Where the strip is bent most in the straight part at a frame: x (metres) and turn of the rung
    /// (radians).
    fn sharpest(&self, frame: usize) -> [f64; 2] {
        let turns = self.turns(frame);
        let largest = turns
            .iter()
            .max_by(|a, b| a[1].abs().total_cmp(&b[1].abs()));
        largest.copied().unwrap_or_default()
    }

    /// How often the strip changes from one curvature to the other in the straight part at a frame.
    fn inflections(&self, frame: usize) -> usize {
        let turns = self.turns(frame);
        // Turns below this are straight.
        let bent: Vec<f64> = turns
            .iter()
            .map(|t| t[1])
            .filter(|t| t.abs() > 0.02)
            .collect();
        bent.windows(2).filter(|w| w[0] * w[1] < 0.0).count()
    }

    /// Buckling loads of a straight strip of a length between clamps, and between a clamp and a hinge,
    /// newtons.
    fn euler(&self, length: f64) -> [f64; 2] {
        let bending = self.feed.rigidity * self.feed.size[1] * (PI / length).powi(2);
        // The root of tan z = z over pi, squared.
        [4.0 * bending, 2.0457 * bending]
    }

    fn facts(&self, passing: f64) -> Value {
        json!({
            "run": self.run.summary, "jammed": self.jammed, "displacement_m_and_force_n": self.force,
            "arrival": self.arrival().map(|k| self.feed_length_at(k)),
            "buckle": self.buckle(passing).map(|(k, force)| json!({ "displacement": self.feed_length_at(k), "force": force, "column": self.column(k), "euler": self.euler(self.column(k)) })),
        })
    }
}

fn newtons(force: f64) -> String {
    if force < 0.1 {
        format!("{:.0} mN", 1e3 * force)
    } else {
        format!("{force:.2} N")
    }
}

/// What happens in front of the plate; `passing` is a force that the strip never needs to pass.
fn describe(jam: &Fed, passing: f64) -> Vec<Row> {
    let (Some(arrival), Some((k, force))) = (jam.arrival(), jam.buckle(passing)) else {
        return rows! {
            "displacement at which the strip reaches the plate" => "–",
        };
    };
    let mm = |frame: usize| format!("{:.1} mm", 1e3 * jam.feed_length_at(frame));
    let column = jam.column(k);
    let [clamped, hinged] = jam.euler(column).map(newtons);
    let last = jam.profiles.len() - 1;
    let [x, turn] = jam.sharpest(last);
    rows! {
        "displacement at which the strip reaches the plate" => mm(arrival),
        "displacement and force at which it buckles between nip and bend" =>
            format!("{}, {}", mm(k), newtons(force)),
        "length of the straight part there" => format!("{:.0} mm", 1e3 * column),
        "Euler's load of this length: both ends clamped, one hinged" => format!("{clamped}, {hinged}"),
        "further falls of the force, into shorter waves" => (jam.buckles(passing).len() - 1).to_string(),
        "displacement at the end" => mm(last),
        "force at which the nip slips" => format!("{} N", jam.feed.limit),
        "inflections in the straight part at the end" => jam.inflections(last).to_string(),
        "sharpest bend at the end" => format!(
            "{:.0}° over {:.0} mm, {:.0} mm before the bend of the guide", turn.abs().to_degrees(),
            1e3 * jam.feed.size[0] / jam.feed.cells[0] as f64, -1e3 * x
        ),
    }
}

fn table(all: &[Fed]) -> Table {
    let joules = |e: f64| Cell::from(format!("{:.2}", 1e3 * e));
    Table::of(
        "Energies at the end in millijoules. Stored: in bending, weight and contact. Missing: what the balance lacks; negative is taken out by the \
         integrator, which damps what it does not resolve; positive is the error of the work of the nip, by the trapezoidal rule \
         between forces that jump.",
        all,
        columns! { f;
            "bend" => f.label(),
            "displacement" => {
                let fed = f.feed_length_at(f.run.summary.course.cost.steps);
                format!("{:.0} mm", 1e3 * fed)
            },
            "largest force" => {
                let [fed, peak] = f.peak();
                format!("{} at {:.0} mm", newtons(peak), 1e3 * fed)
            },
            "work of the nip" => joules(f.run.summary.energy.work),
            "stored" => joules(-f.run.summary.energy.released),
            "friction" => joules(f.run.summary.energy.friction),
            "damping" => joules(f.run.summary.energy.damped),
            "missing" => joules(f.run.summary.energy.drift),
            "strain" => format!("{:.0e}", f.run.summary.course.strain),
            "gap" => super::gap(f.run.summary.course.gap),
            "rejected" => f.run.summary.course.cost.rejected.to_string(),
            "wall time" => format!("{:.1} s", f.run.summary.course.cost.wall),
        },
    )
}

/// How a run is shown: without the outer wall, which would hide the strip.
fn view(feed: &Feed) -> View {
    View {
        from: Viewpoint {
            azimuth: -72.0,
            elevation: 12.0,
            distance: 0.8,
            depth: 0.08,
        },
        columns: 2,
        pins: Vec::new(),
        bodies: match feed.plate() {
            None => &[INNER],
            Some(_) => &[INNER, PLATE],
        },
    }
}

/// Parts of the run at which the jam is shown: the fold-up happens at its end.
const SHOWN: [f64; 6] = [0.0, 0.5, 0.84, 0.91, 0.95, 1.0];

pub(super) fn make(store: &Store) -> Result<Made> {
    let fed = |case| Fed::of(scene(case, store.effort)?, store);
    let all: Vec<Fed> = CASES.into_iter().map(fed).collect::<Result<_>>()?;
    let jam = &all[JAM];
    let jams: Vec<bool> = all.iter().map(|f| f.jammed).collect();
    ensure!(
        store.effort == Effort::Quick || (0..all.len()).all(|k| jams[k] == (k == JAM)),
        "the blocked guide alone jams, but these do: {jams:?}"
    );
    let passing = 2.0 * all[OPEN].peak()[1];
    let times = SHOWN.map(|s| s * jam.run.summary.course.time);
    let alt = "A strip of paper is pushed round a bend against a plate, buckles and folds up";
    let alt_force = "Force of the nip over its displacement in four guides";
    let alt_side = "The strip from the side at five times in each of the four guides";
    let (s, of_scene) = (&jam.feed, jam.run.scene.scene());
    let mut rows = rows! {
        "strip of office paper" => format!(
            "{:.0} mm x {:.0} mm, {:.0} g/m², flexural rigidity {:.0e} N m, {}/{} vertices/faces",
            1e3 * s.size[0], 1e3 * s.size[1], 1e3 * of_scene.sheet[0].areal_density(), s.rigidity,
            jam.run.summary.vertices, jam.run.summary.faces
        ),
        "guide" => format!(
            "walls {:.0} mm apart, friction {} with them and itself", 1e3 * s.channel(),
            of_scene.contact.friction
        ),
        "speed of the nip" => format!("{} m/s", s.speed()),
    };
    rows.extend(describe(jam, passing));
    let side: Vec<Drawing> = all.iter().map(side_view).collect::<Result<_>>()?;
    let side = column(&[row(&side[..2], 30.0), row(&side[2..], 30.0)], 24.0);
    let page = |f: &Fed| {
        let label = format!("strip in a bend of {}", f.label());
        view(&f.feed).play(&f.run, store.effort, 16, &label)
    };
    Ok(Made {
        title: "Paper jam",
        paper: "The simulation of a paper jam is named as an application for the design of printers (Sec. 1), and none is shown.",
        here: "A strip that starts flat is pushed between two walls that turn downwards by 90°; bends let it through unless the outlet is \
               blocked (in the side view time goes from blue to vermilion).",
        pictures: vec![
            view(s).picture(&jam.run, store.effort, ["fig16.png", alt], &times)?,
            Picture::svg("fig16-force", &force_plot(&all), alt_force),
            Picture::svg("fig16-side", &side, alt_side),
        ],
        pages: all.iter().map(page).collect::<Result<_>>()?,
        tables: vec![measured(rows), table(&all)],
        facts: json!(all.iter().map(|f| f.facts(passing)).collect::<Vec<_>>()),
    })
}

fn force_plot(all: &[Fed]) -> Charts {
    let displacements = all.iter().flat_map(|f| &f.force).map(|p| 1e3 * p[0]);
    let far = displacements.fold(1e-3, f64::max);
    let top = all.iter().map(|f| f.peak()[1]).fold(1e-6, f64::max);
    let of = |(f, colour): (&Fed, Colour)| {
        let points = f.force.iter().map(|p| [1e3 * p[0], p[1]]);
        Series::line(&f.label(), colour, points.collect())
    };
    let series = all.iter().zip(COLOURS).map(of).collect();
    let x = Axis::linear("displacement of the nip (mm)", [0.0, far]);
    let y = Axis::linear("force of the nip (N)", [0.0, 1.05 * top]);
    Chart::new(x, y, [250.0, 140.0], series).into()
}

/// Points of a drawing for a metre.
const SCALE: f64 = 1300.0;

/// Times of the side views as parts of the run; the last are closest.
const MOMENTS: [f64; 5] = [0.0, 0.5, 0.8, 0.91, 1.0];

/// The walls and the strip from the side, from light to dark in the order of time.
fn side_view(fed: &Fed) -> Result<Drawing> {
    let mut d = Drawing::new();
    let scaled = |line: &[[f64; 2]]| -> Vec<[f64; 2]> {
        line.iter().map(|p| p.map(|c| SCALE * c)).collect()
    };
    for wall in &fed.feed.walls {
        d.line(&scaled(&wall.rounded()?), Stroke::new(palette::GREY, 1.6));
    }
    let last = (fed.profiles.len() - 1) as f64;
    for (k, part) in MOMENTS.into_iter().enumerate() {
        let colour = palette::SKY.mix(palette::VERMILION, k as f64 / 4.0);
        let frame = (part * last).round() as usize;
        d.line(&scaled(&fed.profiles[frame]), Stroke::new(colour, 1.0));
    }
    let [x, z] = fed.feed.walls[OUTER].line[0];
    let (at, start) = ([SCALE * x, SCALE * (z + 0.004)], Anchor::Start);
    let (label, centre) = (fed.label(), Vertical::Centre);
    d.text(at, &label, TEXT, start, centre, palette::INK);
    Ok(d)
}
