//! The study of one problem: all methods, all steps; its table, its plot, its words.

use super::analysis::{ENERGY, Measure, POSITION, STRAIN, advice, cheapest, on_front, order};
use super::measure::{Point, sweep};
use super::problem::{CHECKPOINTS, Problem};
use super::reference::{self, Reference};
use super::scheme::{ROBUST, Scheme, is_paper};
use crate::cost::DEFAULT;
use crate::draw::{Axis, Chart, Charts, Colour, Legend, Marker, Series, palette};
use crate::progress::Progress;
use crate::report::Effort;
use crate::report::{Bound, Cell, LENGTHS, Requirement, Table, extremes, rounded, short};
use anyhow::Result;
use std::fmt::Write;

/// Everything measured on one problem.
#[derive(Clone, Debug)]
pub(crate) struct Study {
    pub(crate) problem: Problem,
    pub(crate) reference: Reference,
    pub(crate) points: Vec<Point>,
}

/// Runs all methods on a problem.
pub(crate) fn make(problem: Problem, effort: Effort) -> Result<Study> {
    let schemes = Scheme::all();
    let bar = Progress::start(problem.to_string(), schemes.len() + 1);
    let reference = reference::compute(problem, reference::budget(problem, effort))?;
    bar.step();
    let mut points = Vec::new();
    for scheme in &schemes {
        // Steps are halved until a run takes longer, seconds.
        let limit = effort.pick(0.01, 1.0, 8.0);
        points.extend(sweep(problem, scheme, &reference, limit)?);
        bar.step();
    }
    bar.finish(&format!("{} runs", points.len()));
    Ok(Study {
        problem,
        reference,
        points,
    })
}

/// The orders of the methods by docs/methods.md.
const ORDERS: [(&str, f64); 6] = [
    ("implicit Euler", 1.0),
    (DEFAULT, 2.0),
    ("projection", 1.0),
    ("energy-momentum", 2.0),
    ("RATTLE", 2.0),
    ("RATTLE composition", 4.0),
];

/// An order that is fitted to a few runs with finite steps may be smaller by this much.
const FIT: f64 = 0.3;

/// Round-off in energies, parts of the energy scale: orders are not fitted near it.
const ENERGY_FLOOR: f64 = 1e-13;

impl Study {
    /// All points, for programs.
    pub(crate) fn data(&self) -> Table {
        let error = |p: &Point, m: Measure| Cell::from(p.errors.map(|e| (m.of)(&e)));
        Table::of(
            "",
            &self.points,
            &[
                ("problem", &|_| self.problem.to_string().into()),
                ("method", &|p| p.scheme.as_str().into()),
                ("step_or_tolerance", &|p| p.fineness.into()),
                ("mean_step_s", &|p| p.step.into()),
                ("cpu_s_per_simulated_s", &|p| p.cpu.into()),
                ("position_error_m", &|p| error(p, POSITION)),
                ("relative_energy_error", &|p| error(p, ENERGY)),
                ("strain", &|p| error(p, STRAIN)),
                ("steps", &|p| p.cost.substeps.into()),
                ("rejected", &|p| p.cost.rejected.into()),
                ("factorisations", &|p| p.cost.factorisations.into()),
                ("repetitions", &|p| p.repetitions.into()),
                ("failure", &|p| p.failure.clone().into()),
            ],
        )
    }

    fn of<'a>(&'a self, scheme: &'a str) -> impl Iterator<Item = &'a Point> {
        self.points.iter().filter(move |p| p.scheme == scheme)
    }

    /// Names of the methods in the order in which they were run.
    fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.points.iter().map(|p| p.scheme.as_str()).collect();
        names.dedup();
        names
    }

    /// How the reference was made and how far it goes.
    pub(crate) fn reference_words(&self) -> String {
        let r = &self.reference;
        let mut text = format!(
            "{}; the two are at most {:.0e} m apart over the {} s that are compared",
            r.source,
            r.doubt(),
            short(r.meaningful())
        );
        if r.usable() < CHECKPOINTS {
            let _ = write!(
                text,
                " ({} of {CHECKPOINTS} checkpoints: after that they part, and nothing is compared)",
                r.usable()
            );
        }
        if let Some(g) = r.growth {
            let _ = write!(
                text,
                ". A start displaced by {:.0e} m leads {:.0e} m away: neighbouring motions part {} times as far, on average with the rate {} per \
                 second",
                g.start,
                g.end,
                short(g.end / g.start),
                short(g.rate)
            );
            if let Some(hint) = horizon(g.rate, r.doubt()) {
                let _ = write!(text, "; at this rate the reference is lost after {hint} s");
            }
        }
        text.push('.');
        text
    }

    /// The orders and the lengths that docs/methods.md and README.md claim. An order is asked of methods with
    /// three and more runs that are fine enough to show one, on the problems whose motions are smooth: sheets
    /// flutter on finer scales than their steps.
    pub(crate) fn requirements(&self) -> Vec<Requirement> {
        let mut all = Vec::new();
        if self.problem.is_smooth() {
            for (method, theory) in ORDERS {
                let doubt = self.reference.doubt();
                let fitted = order(&self.points, method, POSITION, doubt);
                let bound = (Bound::AtLeast, theory - FIT);
                let of = |order| {
                    Requirement::of(method, "order of the position error", bound, &[Some(order)])
                };
                all.extend(fitted.map(of));
            }
        }
        for method in [DEFAULT, "implicit Euler"] {
            let strains = self
                .of(method)
                .filter_map(|p| p.errors)
                .map(|e| Some(e.strain));
            let strains: Vec<_> = strains.collect();
            let quantity = "largest strain of an edge";
            all.push(Requirement::of(
                method,
                quantity,
                (Bound::AtMost, LENGTHS),
                &strains,
            ));
        }
        all
    }

    /// What follows for the choice of a method.
    pub(crate) fn conclusions(&self) -> Vec<String> {
        let mut all: Vec<String> = [POSITION, ENERGY]
            .into_iter()
            .map(|m| {
                format!(
                    "Cheapest for a given {} error: {}.",
                    m.name,
                    advice(&self.points, m)
                )
            })
            .collect();
        all.push(self.default_words());
        all
    }

    /// Whether the default is on the fronts, and what it costs where it is not.
    fn default_words(&self) -> String {
        let parts: Vec<String> = [POSITION, ENERGY, STRAIN]
            .into_iter()
            .map(|measure| {
                let unit = measure.unit;
                let range = |[high, low]: [f64; 2]| {
                    if low < high {
                        format!("from {high:.0e} to {low:.0e}{unit}")
                    } else {
                        format!("at {high:.0e}{unit}")
                    }
                };
                let words = match self.default_on_front(measure) {
                    [Some(all), _] => format!("on the front {}", range(all)),
                    [None, Some(robust)] => format!(
                        "not on the front of all methods, but on that of the methods that take flat states {}",
                        range(robust)
                    ),
                    [None, None] => "not on the front".into(),
                };
                format!("{}: {words}", measure.name)
            })
            .collect();
        let mut text = format!("The default, {DEFAULT}, in {}.", parts.join("; "));
        if let Some([low, high]) = self.default_price() {
            let _ = write!(
                text,
                " For the position errors that it reaches it takes {} to {} times the time of the cheapest method.",
                short(low),
                short(high)
            );
        }
        text
    }

    /// Smallest and largest ratio of the default's time to that of the cheapest method with as small a
    /// position error.
    fn default_price(&self) -> Option<[f64; 2]> {
        extremes(self.of(DEFAULT).filter_map(|p| {
            let level = p.errors?.position;
            Some(p.cpu / cheapest(&self.points, POSITION, level)?.cpu)
        }))
    }

    /// The default's part of the front, of all methods and of those that take any state.
    pub(crate) fn default_on_front(&self, measure: Measure) -> [Option<[f64; 2]>; 2] {
        let robust: Vec<Point> = self
            .points
            .iter()
            .filter(|p| ROBUST.contains(&p.scheme.as_str()))
            .cloned()
            .collect();
        [
            on_front(&self.points, DEFAULT, measure),
            on_front(&robust, DEFAULT, measure),
        ]
    }

    /// Methods, their fitted orders and the time they take for given errors.
    pub(crate) fn table(&self) -> Table {
        let order = |name: &str, measure, floor| {
            let order = order(&self.points, name, measure, floor);
            Cell::from(order.map(|o| format!("{o:.1}")))
        };
        let cost = |name: &str, level: f64| {
            let point = cheapest(self.of(name), POSITION, level);
            Cell::from(point.map(|p| short(p.cpu)))
        };
        let extreme = |name: &str, measure: Measure, f: fn(f64, f64) -> f64| {
            let errors = self.of(name).filter_map(|p| p.errors);
            let extreme = errors.map(|e| (measure.of)(&e)).reduce(f);
            Cell::from(extreme.map(|e| format!("{e:.0e}")))
        };
        Table::of(
            "Orders fitted to the finest steps; CPU seconds for a simulated second to get below a position error",
            self.names(),
            &[
                ("method", &|name| (*name).into()),
                ("order, position", &|name| {
                    order(name, POSITION, self.reference.doubt())
                }),
                ("order, energy", &|name| order(name, ENERGY, ENERGY_FLOOR)),
                ("s/s for 1e-2 m", &|name| cost(name, 1e-2)),
                ("s/s for 1e-4 m", &|name| cost(name, 1e-4)),
                ("s/s for 1e-6 m", &|name| cost(name, 1e-6)),
                ("s/s for 1e-8 m", &|name| cost(name, 1e-8)),
                ("best position error (m)", &|name| {
                    extreme(name, POSITION, f64::min)
                }),
                ("best energy error", &|name| extreme(name, ENERGY, f64::min)),
                ("largest strain", &|name| extreme(name, STRAIN, f64::max)),
                ("remark", &|name| self.remark(name).into()),
            ],
        )
    }

    /// How far the published scheme comes, its variants included, on the sheets that the paper shows.
    pub(crate) fn published(&self) -> Option<String> {
        if !matches!(self.problem, Problem::Sheet(1..)) {
            return None;
        }
        let runs: Vec<&Point> = self.points.iter().filter(|p| is_paper(&p.scheme)).collect();
        let ended = runs.iter().filter(|p| p.errors.is_some()).count();
        let furthest = runs.iter().map(|p| p.reached).fold(0.0, f64::max);
        let names = self.names().into_iter().filter(|name| is_paper(name));
        let reasons: Vec<String> = names
            .filter_map(|name| {
                let last = self.of(name).filter_map(|p| p.failure.as_deref()).last()?;
                Some(format!("{name}: {}", rounded(last)))
            })
            .collect();
        Some(format!(
            "{}: {ended} of {} runs of the published scheme came to the end of {} s, the furthest to {} s ({}); {} of {} runs of the \
             default did.",
            self.problem.title(),
            runs.len(),
            short(self.reference.meaningful()),
            short(furthest),
            reasons.join("; "),
            self.of(DEFAULT).filter(|p| p.errors.is_some()).count(),
            self.of(DEFAULT).count()
        ))
    }

    /// What kept a method from finishing, if it did.
    fn remark(&self, name: &str) -> String {
        let failed: Vec<&Point> = self.of(name).filter(|p| p.errors.is_none()).collect();
        let runs = self.of(name).count();
        match failed.last() {
            None => String::new(),
            Some(p) => {
                let reason = p.failure.as_deref().unwrap_or("not finished");
                format!(
                    "{} of {runs} runs not finished, the last: {}",
                    failed.len(),
                    rounded(reason)
                )
            }
        }
    }

    /// Three log-log panels: time against each error.
    pub(crate) fn plot(&self) -> Charts {
        let drawn = self.drawn();
        let times = || self.points.iter().filter_map(|p| p.errors.map(|_| p.cpu));
        let error = |measure: Measure, p: &Point| Some((measure.of)(&p.errors?).max(CLIP));
        let panel = |(measure, label, legend): (Measure, &str, Legend)| {
            let points = |name: &str| -> Vec<[f64; 2]> {
                let of = self
                    .of(name)
                    .filter_map(|p| Some([p.cpu, error(measure, p)?]));
                of.collect()
            };
            let all = drawn.iter().flat_map(|look| points(&look.name));
            let errors = all.map(|p| p[1].min(LARGEST)).collect::<Vec<_>>();
            let series = drawn.iter().map(|look| Series {
                points: points(&look.name),
                ..look.clone()
            });
            let x = Axis::decades("CPU time / simulated time", times());
            let y = Axis::decades(label, errors);
            let chart = Chart::new(x, y, [150.0, 160.0], series.collect());
            chart.with_legend(legend)
        };
        let panels = [
            (POSITION, "position error (m)", Legend::None),
            (
                ENERGY,
                "energy error / largest kinetic energy",
                Legend::None,
            ),
            (STRAIN, "largest edge strain", Legend::Right),
        ];
        Charts::row(panels.map(panel))
    }

    /// How the methods are drawn that are: of those in charts, those in one chart only.
    fn drawn(&self) -> Vec<Series> {
        let look = |(name, colour, marker): (&str, Colour, Marker)| {
            Series::line(name, colour, Vec::new()).marked(marker)
        };
        let free = [
            ("implicit Euler", palette::SKY, Marker::Disc),
            (DEFAULT, palette::BLUE, Marker::Disc),
            ("projection", palette::GREEN, Marker::Square),
            ("energy-momentum", palette::ORANGE, Marker::Triangle),
            ("RATTLE", palette::VERMILION, Marker::Diamond),
            ("RATTLE composition", palette::PURPLE, Marker::Diamond),
        ];
        let mut drawn: Vec<Series> = free.map(look).to_vec();
        for name in self.names() {
            let (colour, marker) = if name.ends_with("fixed steps") {
                (palette::BLACK, Marker::Diamond)
            } else if name.ends_with("free creases") {
                (palette::GREY, Marker::Square)
            } else if is_paper(name) {
                (palette::BLACK, Marker::Square)
            } else if !name.ends_with("Cartesian chart") {
                continue;
            } else if name.starts_with("Runge") {
                (palette::INK, Marker::Triangle)
            } else {
                (palette::GREY, Marker::Diamond)
            };
            drawn.push(look((name, colour, marker)).dashed());
        }
        drawn.retain(|look| self.of(&look.name).any(|p| p.errors.is_some()));
        drawn
    }
}

/// Errors below this are drawn as this: round-off, and zero has no logarithm.
const CLIP: f64 = 1e-17;

/// Errors above this are left out of the plots.
const LARGEST: f64 = 10.0;

/// When a doubt grows to the size of the sheet, 1 m; `None` when it does not.
fn horizon(rate: f64, doubt: f64) -> Option<String> {
    let time = -doubt.ln() / rate;
    (rate > 0.0 && time.is_finite()).then(|| short(time))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Vector;

    #[test]
    fn a_quick_study_of_the_pendulum_holds_together() {
        let study = make(Problem::Pendulum, Effort::Quick).unwrap();
        let csv = String::from_utf8(study.data().csv().unwrap()).unwrap();
        assert_eq!(csv.lines().count(), 1 + study.points.len());
        assert!(csv.contains("pendulum,BDF2 (default),"), "{csv}");
        assert!(!csv.contains(",NaN") && !csv.contains(",inf"), "{csv}");
        let svg = study.plot().to_svg("t");
        assert!(svg.contains("RATTLE composition"));
        assert_eq!(study.table().rows.len(), Scheme::all().len());
        // Second order shows in a few milliseconds already; a busy machine may take longer than the quick limit.
        let schemes = Scheme::all();
        let rattle = schemes.iter().find(|s| s.name == "RATTLE").unwrap();
        let points = sweep(Problem::Pendulum, rattle, &study.reference, 0.2).unwrap();
        let order = order(&points, "RATTLE", POSITION, study.reference.doubt());
        assert!(order.is_some_and(|o| (o - 2.0).abs() < 0.2), "{order:?}");
        // Lengths: exact for us, drifting for the published scheme.
        let strain = |name: &str| {
            study
                .of(name)
                .filter_map(|p| p.errors.map(|e| e.strain))
                .fold(0.0, f64::max)
        };
        assert!(strain(DEFAULT) < 1e-11 && strain("published scheme") > 1e-4);
        assert_eq!(study.published(), None);
        let sheet = Study {
            problem: Problem::Sheet(1),
            ..study
        };
        let text = sheet.published().expect("a sheet of the paper");
        let paper = sheet.points.iter().filter(|p| is_paper(&p.scheme)).count();
        assert!(
            text.contains(&format!(" of {paper} runs of the published scheme")),
            "{text}"
        );
    }
}
