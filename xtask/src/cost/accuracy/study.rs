//! The study of one problem: all methods, all steps; its tables and its plot.

use super::analysis::{ENERGY, Measure, POSITION, STRAIN, cheapest, order};
use super::measure::{Point, sweep};
use super::problem::Problem;
use super::reference::{self, Reference};
use super::scheme::{ROBUST, Scheme, is_paper};
use crate::cost::DEFAULT;
use crate::draw::{Axis, Chart, Charts, Colour, Legend, Marker, Series, palette};
use crate::progress::Progress;
use crate::report::Effort;
use crate::report::{Bound, Cell, Finding, LENGTHS, Table, rounded, short};
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// Everything measured on one problem.
#[derive(Clone, Debug)]
pub(crate) struct Study {
    pub(crate) problem: Problem,
    pub(crate) reference: Reference,
    pub(crate) points: Vec<Point>,
}

/// Smallest error that is asked for, a power of ten.
const LEAST: i32 = -14;

/// Which method is the cheapest for an error, with CPU seconds for a simulated second.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Front {
    problem: String,
    error: String,
    /// The largest error allowed.
    level: f64,
    /// Of all methods.
    best: (String, f64),
    /// Of the methods that take flat states.
    robust: Option<(String, f64)>,
    /// What the default takes for it.
    default: Option<f64>,
}

impl Front {
    /// Rows of all problems.
    pub(crate) fn table(rows: &[Self]) -> Table {
        Table::of(
            "The cheapest method for an error of positions or of energy: of all, and of those that take flat states, beside the default; CPU \
             seconds for a simulated second (s/s)",
            rows,
            &[
                ("problem", &|f| f.problem.as_str().into()),
                ("error", &|f| f.error.as_str().into()),
                ("at_most", &|f| f.level.into()),
                ("cheapest", &|f| f.best.0.as_str().into()),
                ("s/s", &|f| f.best.1.into()),
                ("cheapest_from_flat_states", &|f| {
                    f.robust.as_ref().map(|(name, _)| name.as_str()).into()
                }),
                ("its_s/s", &|f| f.robust.as_ref().map(|(_, cpu)| *cpu).into()),
                (DEFAULT, &|f| f.default.into()),
            ],
        )
        .named("fronts")
    }
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
                ("reached_s", &|p| p.reached.into()),
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
    pub(crate) fn reference_table(&self) -> Table {
        let r = &self.reference;
        Table::of(
            "The reference: two motions by other methods or other steps, the largest distance between them over the time that is \
             compared, and the rate at which a displaced start parts from it. After that time the two part, and nothing is compared",
            [r],
            &[
                ("reference", &|r| r.source.as_str().into()),
                ("compared_for_s", &|r| r.meaningful().into()),
                ("distance_m", &|r| r.doubt().into()),
                ("rate_of_parting_1_per_s", &|r| {
                    r.growth.map(|g| g.rate).into()
                }),
            ],
        )
    }

    /// The orders and the lengths that docs/methods.md and README.md claim. An order is asked of methods with
    /// three and more runs that are fine enough to show one, on the problems whose motions are smooth: sheets
    /// flutter on finer scales than their steps.
    pub(crate) fn findings(&self) -> Vec<Finding> {
        let mut all = Vec::new();
        if self.problem.is_smooth() {
            for (method, theory) in ORDERS {
                let doubt = self.reference.doubt();
                let fitted = order(&self.points, method, POSITION, doubt);
                let bound = Bound::AtLeast(theory - FIT);
                let of = |order| {
                    Finding::worst(method, "order of the position error", bound, &[Some(order)])
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
            all.push(Finding::worst(
                method,
                quantity,
                Bound::AtMost(LENGTHS),
                &strains,
            ));
        }
        all
    }

    /// The cheapest methods by error, of all and of those that take any state, beside the default.
    pub(crate) fn fronts(&self) -> Vec<Front> {
        let is_robust = |p: &&Point| ROBUST.contains(&p.scheme.as_str());
        let named = |p: &Point| (p.scheme.clone(), p.cpu);
        let mut all = Vec::new();
        for measure in [POSITION, ENERGY] {
            for power in (LEAST..=measure.useful).rev() {
                let level = 10f64.powi(power);
                let Some(best) = cheapest(&self.points, measure, level) else {
                    break;
                };
                all.push(Front {
                    problem: self.problem.to_string(),
                    error: measure.name.to_owned(),
                    level,
                    best: named(best),
                    robust: cheapest(self.points.iter().filter(is_robust), measure, level)
                        .map(named),
                    default: cheapest(self.of(DEFAULT), measure, level).map(|p| p.cpu),
                });
            }
        }
        all
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
        // Second order shows in a few milliseconds already; a busy machine may take longer than the quick
        // limit.
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
        // The default reaches small errors on the front of the methods that take any state, in this or that
        // time.
        let fronts = study.fronts();
        assert!(
            fronts
                .iter()
                .all(|f| f.default.is_none_or(|cpu| cpu >= f.best.1))
        );
        assert_eq!(Front::table(&fronts).rows.len(), fronts.len());
    }
}
