//! The study of one problem: all methods, all steps; its tables and its plot.

use super::point::{ENERGY, Measure, POSITION, Point, STRAIN, cheapest, order, sweep};
use super::problem::Problem;
use super::reference::{self, Reference};
use super::scheme::{Kind, ROBUST, Scheme};
use crate::cost::DEFAULT;
use crate::draw::{Axis, Chart, Charts, Legend, Series};
use crate::progress::Progress;
use crate::report::{Bound, Effort, Finding, LENGTHS, Table, columns};
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// Everything measured on one problem.
#[derive(Clone, Debug)]
pub(super) struct Study {
    problem: Problem,
    pub(super) reference: Reference,
    schemes: Vec<Scheme>,
    points: Vec<Point>,
}

/// Smallest error that is asked for, a power of ten.
const LEAST: i32 = -14;

/// Which method is the cheapest for an error, with CPU seconds for a simulated second. The fields are columns
/// of a table.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Front {
    problem: String,
    error: String,
    /// The largest error allowed.
    at_most: f64,
    /// Of all methods.
    cheapest: String,
    #[serde(rename = "s/s")]
    rate: f64,
    /// Of the methods that take flat states.
    cheapest_from_flat_states: Option<String>,
    #[serde(rename = "its_s/s")]
    its_rate: Option<f64>,
    /// What the default takes for it.
    #[serde(rename = "BDF2 (default)")]
    default: Option<f64>,
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
    /// Runs all methods on a problem.
    pub(super) fn of(problem: Problem, effort: Effort) -> Result<Self> {
        let schemes = Scheme::all();
        let bar = Progress::start(problem.name(), schemes.len() + 1);
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
        Ok(Self {
            problem,
            reference,
            schemes,
            points,
        })
    }

    /// All points, for programs.
    pub(super) fn data(&self) -> Result<Table> {
        Table::of_fields("", &self.points)
    }

    fn by<'a>(&'a self, method: &'a str) -> impl Iterator<Item = &'a Point> {
        self.points.iter().filter(move |p| p.method == method)
    }

    /// The orders and the lengths that docs/methods.md and README.md claim. An order is asked of methods with
    /// three and more runs that are fine enough to show one, on the problems whose motions are smooth: sheets
    /// flutter on finer scales than their steps.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let mut all = Vec::new();
        for (method, theory) in ORDERS {
            let order = order(&self.points, method, POSITION, self.reference.doubt);
            let order = order.filter(|_| self.problem.is_smooth());
            let (quantity, bound) = ("order of the position error", Bound::AtLeast(theory - FIT));
            all.extend(order.map(|o| Finding::worst(method, quantity, bound, &[Some(o)])));
        }
        for method in [DEFAULT, "implicit Euler"] {
            let strains = self.by(method).filter_map(STRAIN.of).map(Some);
            let strains: Vec<_> = strains.collect();
            let (quantity, bound) = ("largest strain of an edge", Bound::AtMost(LENGTHS));
            all.push(Finding::worst(method, quantity, bound, &strains));
        }
        all
    }

    /// The cheapest methods by error, of all and of those that take any state, beside the default.
    pub(super) fn fronts(&self) -> Vec<Front> {
        let robust = || self.points.iter().filter(|p| ROBUST.contains(&p.method));
        let mut all = Vec::new();
        for measure in [POSITION, ENERGY] {
            for power in (LEAST..=measure.useful).rev() {
                let level = 10f64.powi(power);
                let Some(best) = cheapest(&self.points, measure, level) else {
                    break;
                };
                let robust = cheapest(robust(), measure, level);
                all.push(Front {
                    problem: self.problem.name().to_owned(),
                    error: measure.name.to_owned(),
                    at_most: level,
                    cheapest: best.method.to_owned(),
                    rate: best.cpu_s_per_simulated_s,
                    cheapest_from_flat_states: robust.map(|p| p.method.to_owned()),
                    its_rate: robust.map(cpu),
                    default: cheapest(self.by(DEFAULT), measure, level).map(cpu),
                });
            }
        }
        all
    }

    /// Methods, their fitted orders and the time they take for given errors.
    pub(super) fn table(&self) -> Table {
        let order = |name, measure, floor| order(&self.points, name, measure, floor);
        let cost = |name, level| cheapest(self.by(name), POSITION, level).map(cpu);
        let least = |name, m: Measure| self.by(name).filter_map(m.of).reduce(f64::min);
        let failed = |name| self.by(name).filter(|p| p.failure.is_some());
        Table::of(
            "Orders fitted to the finest steps; CPU seconds for a simulated second to get below a position error; runs that did not \
             come to the end, and why the last of them did not",
            self.schemes.iter().map(|scheme| scheme.name),
            columns! { name;
                "method" => *name,
                "order, position" => order(name, POSITION, self.reference.doubt),
                "order, energy" => order(name, ENERGY, ENERGY_FLOOR),
                "s/s for 1e-2 m" => cost(name, 1e-2),
                "s/s for 1e-4 m" => cost(name, 1e-4),
                "s/s for 1e-6 m" => cost(name, 1e-6),
                "s/s for 1e-8 m" => cost(name, 1e-8),
                "best position error (m)" => least(name, POSITION),
                "best energy error" => least(name, ENERGY),
                "largest strain" => self.by(name).filter_map(STRAIN.of).reduce(f64::max),
                "runs" => self.by(name).count(),
                "not finished" => failed(name).count(),
                "remark" => failed(name).last().and_then(|p| p.failure.clone()),
            },
        )
    }

    /// Three log-log panels: time against each error.
    pub(super) fn plot(&self) -> Charts {
        let good = || self.points.iter().filter(|p| p.failure.is_none());
        let panel = |(measure, label, legend): (Measure, &str, Legend)| {
            let series = |scheme: &Scheme| {
                let (colour, marker) = scheme.look?;
                let place = |p: &Point| Some([cpu(p), (measure.of)(p)?.max(CLIP)]);
                let points: Vec<_> = self.by(scheme.name).filter_map(place).collect();
                let line = Series::line(scheme.name, colour, points).marked(marker);
                let is_free = matches!(scheme.kind, Kind::Free(_));
                let line = if is_free { line } else { line.dashed() };
                Some(line).filter(|line| !line.points.is_empty())
            };
            let series: Vec<Series> = self.schemes.iter().filter_map(series).collect();
            let errors = series.iter().flat_map(|s| &s.points);
            let errors: Vec<f64> = errors.map(|p| p[1].min(LARGEST)).collect();
            let x = Axis::decades("CPU time / simulated time", good().map(cpu));
            let y = Axis::decades(label, errors);
            Chart::new(x, y, [150.0, 160.0], series).with_legend(legend)
        };
        let energy = "energy error / largest kinetic energy";
        let panels = [
            (POSITION, "position error (m)", Legend::None),
            (ENERGY, energy, Legend::None),
            (STRAIN, "largest edge strain", Legend::Right),
        ];
        Charts::row(panels.map(panel))
    }
}

/// CPU seconds for a simulated second.
fn cpu(point: &Point) -> f64 {
    point.cpu_s_per_simulated_s
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
        let study = Study::of(Problem::Pendulum, Effort::Quick).unwrap();
        let csv = String::from_utf8(study.data().unwrap().csv().unwrap()).unwrap();
        assert_eq!(csv.lines().count(), 1 + study.points.len());
        assert!(csv.contains("BDF2 (default),"), "{csv}");
        assert!(!csv.contains(",NaN") && !csv.contains(",inf"), "{csv}");
        let svg = study.plot().to_svg("t");
        assert!(svg.contains("RATTLE composition"));
        // Second order shows in a few milliseconds already; a busy machine may take longer than the quick
        // limit.
        let rattle = study.schemes.iter().find(|s| s.name == "RATTLE").unwrap();
        let points = sweep(study.problem, rattle, &study.reference, 0.2).unwrap();
        let order = order(&points, "RATTLE", POSITION, study.reference.doubt);
        assert!(order.is_some_and(|o| (o - 2.0).abs() < 0.2), "{order:?}");
        // Lengths: exact for us, drifting for the published scheme.
        let strains = |name| study.by(name).filter_map(STRAIN.of);
        let strain = |name| strains(name).fold(0.0, f64::max);
        assert!(strain(DEFAULT) < 1e-11 && strain("published scheme") > 1e-4);
        // The default reaches small errors on the front of the methods that take any state, in this or that
        // time.
        let fronts = study.fronts();
        assert!(!fronts.is_empty());
        let is_slower = |f: &Front| f.default.is_none_or(|cpu| cpu >= f.rate);
        assert!(fronts.iter().all(is_slower));
    }
}
