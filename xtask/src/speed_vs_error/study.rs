//! The study of one problem: all methods, all steps; its table, its plot, its words.

use super::analysis::{Measure, advice, cheapest, first_clause, on_front, order, short};
use super::effort::StudyEffort;
use super::measure::{Point, sweep};
use super::problem::{CHECKPOINTS, Problem};
use super::reference::{self, Reference};
use super::scheme::{DEFAULT, ROBUST, Scheme, is_paper};
use crate::draw::{Axis, Colour, Drawing, Legend, Line, Marker, Plot, Series, palette, row};
use crate::figures::Table;
use crate::progress::Progress;
use anyhow::Result;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// Everything measured on one problem.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Study {
    pub(crate) problem: Problem,
    pub(crate) reference: Reference,
    pub(crate) points: Vec<Point>,
}

/// Runs all methods on a problem.
pub(crate) fn make(problem: Problem, effort: StudyEffort) -> Result<Study> {
    let schemes = Scheme::all();
    let bar = Progress::start(problem.to_string(), schemes.len() + 1);
    let reference = reference::compute(problem, effort.reference(problem))?;
    bar.step();
    let mut points = Vec::new();
    for scheme in &schemes {
        let limit = if scheme.is_chart() {
            effort.chart_run()
        } else {
            effort.run()
        };
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

/// Round-off in energies, parts of the energy scale: orders are not fitted near it.
const ENERGY_FLOOR: f64 = 1e-13;

impl Study {
    /// All points as CSV.
    pub(crate) fn csv(&self) -> String {
        let mut out = String::from(
            "problem,method,step_or_tolerance,mean_step_s,wall_s_per_simulated_s,position_error_m,relative_energy_error,strain,\
             steps,rejected,factorisations,repetitions,failure\n",
        );
        for p in &self.points {
            let error = |m: Measure| {
                p.errors
                    .map_or(String::new(), |e| format!("{:e}", m.of(&e)))
            };
            // Writing to a string cannot fail.
            let _ = writeln!(
                out,
                "{},\"{}\",{:e},{:e},{:e},{},{},{},{},{},{},{},\"{}\"",
                self.problem,
                p.scheme,
                p.fineness,
                p.step,
                p.wall,
                error(Measure::Position),
                error(Measure::Energy),
                error(Measure::Strain),
                p.steps,
                p.rejected,
                p.factorisations,
                p.repetitions,
                p.failure.as_deref().unwrap_or("").replace('"', "'"),
            );
        }
        out
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

    /// What follows for the choice of a method.
    pub(crate) fn conclusions(&self) -> Vec<String> {
        let mut all: Vec<String> = [Measure::Position, Measure::Energy]
            .into_iter()
            .map(|m| {
                format!(
                    "Cheapest for a given {} error: {}.",
                    m.name(),
                    advice(&self.points, m)
                )
            })
            .collect();
        all.push(self.default_words());
        all
    }

    /// Whether the default is on the fronts, and what it costs where it is not.
    fn default_words(&self) -> String {
        let parts: Vec<String> = Measure::ALL
            .into_iter()
            .map(|measure| {
                let unit = measure.unit();
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
                format!("{}: {words}", measure.name())
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
        let ratios: Vec<f64> = self
            .of(DEFAULT)
            .filter_map(|p| {
                let level = p.errors?.position;
                Some(p.wall / cheapest(&self.points, Measure::Position, level)?.wall)
            })
            .collect();
        let low = ratios.iter().copied().reduce(f64::min)?;
        Some([low, ratios.iter().copied().fold(low, f64::max)])
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
        let levels = [1e-2, 1e-4, 1e-6, 1e-8];
        let mut head: Vec<String> = ["method", "order, position", "order, energy"]
            .map(str::to_owned)
            .to_vec();
        head.extend(levels.map(|l| format!("s/s for {l:.0e} m")));
        head.extend(
            [
                "best position error (m)",
                "best energy error",
                "largest strain",
                "remark",
            ]
            .map(str::to_owned),
        );
        let rows = self
            .names()
            .iter()
            .map(|name| {
                let order = |measure, floor| {
                    order(&self.points, name, measure, floor)
                        .map_or("–".to_owned(), |o| format!("{o:.1}"))
                };
                let mut row = vec![
                    (*name).to_owned(),
                    order(Measure::Position, self.reference.doubt()),
                    order(Measure::Energy, ENERGY_FLOOR),
                ];
                row.extend(levels.map(|l| {
                    cheapest(self.of(name), Measure::Position, l)
                        .map_or("–".to_owned(), |p| short(p.wall))
                }));
                let extreme = |measure: Measure, f: fn(f64, f64) -> f64| {
                    self.of(name)
                        .filter_map(|p| p.errors.map(|e| measure.of(&e)))
                        .reduce(f)
                        .map_or("–".to_owned(), |e| format!("{e:.0e}"))
                };
                row.push(extreme(Measure::Position, f64::min));
                row.push(extreme(Measure::Energy, f64::min));
                row.push(extreme(Measure::Strain, f64::max));
                row.push(self.remark(name));
                row
            })
            .collect();
        Table {
            caption: "Orders fitted to the finest steps; wall seconds for a simulated second to get below a position error".into(),
            head,
            rows,
        }
    }

    /// What kept a method from finishing, if it did.
    fn remark(&self, name: &str) -> String {
        let failed: Vec<&Point> = self.of(name).filter(|p| p.errors.is_none()).collect();
        let runs = self.of(name).count();
        match failed.last() {
            None => String::new(),
            Some(p) => {
                let reason = p.failure.as_deref().unwrap_or("not finished");
                // What to do about it is not asked here.
                let reason = first_clause(reason);
                format!(
                    "{} of {runs} runs not finished, the last: {}",
                    failed.len(),
                    crate::figures::rounded(reason)
                )
            }
        }
    }

    /// Three log-log panels: time against each error.
    pub(crate) fn plot(&self) -> Drawing {
        let drawn = self.drawn();
        let finished = |p: &&Point| p.errors.is_some();
        let walls = decades(self.points.iter().filter(finished).map(|p| p.wall));
        let panels: Vec<Drawing> = Measure::ALL
            .into_iter()
            .map(|measure| {
                let clip = |e: f64| e.max(CLIP);
                let errors = decades(drawn.iter().flat_map(|(name, ..)| {
                    self.of(name)
                        .filter_map(move |p| p.errors.map(|e| clip(measure.of(&e)).min(10.0)))
                }));
                let series = drawn
                    .iter()
                    .map(|(name, colour, marker, line)| Series {
                        name: (*name).to_owned(),
                        points: self
                            .of(name)
                            .filter_map(|p| {
                                let e = clip(measure.of(&p.errors?));
                                (e <= 10f64.powi(errors[1])).then_some([p.wall, e])
                            })
                            .collect(),
                        colour: *colour,
                        marker: *marker,
                        line: *line,
                    })
                    .collect();
                let label = match measure {
                    Measure::Position => "position error (m)",
                    Measure::Energy => "energy error / largest kinetic energy",
                    Measure::Strain => "largest edge strain",
                };
                Plot {
                    x: axis("wall time / simulated time", walls),
                    y: axis(label, errors),
                    size: [150.0, 160.0],
                    series,
                    legend: if measure == Measure::Strain {
                        Legend::Right
                    } else {
                        Legend::None
                    },
                }
                .draw()
            })
            .collect();
        row(&panels, 18.0)
    }

    /// The methods that are drawn, and how: those in charts in one chart with one solver only.
    fn drawn(&self) -> Vec<(&str, Colour, Option<Marker>, Line)> {
        let mut drawn: Vec<(&str, Colour, Option<Marker>, Line)> = [
            ("implicit Euler", palette::SKY, Marker::Disc),
            (DEFAULT, palette::BLUE, Marker::Disc),
            ("projection", palette::GREEN, Marker::Square),
            ("energy-momentum", palette::ORANGE, Marker::Triangle),
            ("RATTLE", palette::VERMILION, Marker::Diamond),
            ("RATTLE composition", palette::PURPLE, Marker::Diamond),
        ]
        .into_iter()
        .map(|(name, colour, marker)| (name, colour, Some(marker), Line::Solid))
        .collect();
        for name in self.names() {
            if is_paper(name) {
                let colour = if name.ends_with("creases") {
                    palette::GREY
                } else {
                    palette::BLACK
                };
                let marker = if name.ends_with("fixed steps") {
                    Marker::Diamond
                } else {
                    Marker::Square
                };
                drawn.push((name, colour, Some(marker), Line::Dashed));
            } else if name.ends_with("Cartesian chart, saddle") {
                let (colour, marker) = if name.starts_with("Runge") {
                    (palette::INK, Marker::Triangle)
                } else if name.starts_with("symplectic") {
                    (palette::GREY, Marker::Disc)
                } else {
                    (palette::GREY, Marker::Diamond)
                };
                drawn.push((name, colour, Some(marker), Line::Dashed));
            }
        }
        drawn.retain(|(name, ..)| self.of(name).any(|p| p.errors.is_some()));
        drawn
    }

    /// Time of a step in a chart by solver: rows of methods and charts.
    pub(crate) fn solver_table(&self) -> Table {
        let solvers = ["saddle", "Cholesky", "dense LU", "Cramer"];
        let mut stems: Vec<&str> = self
            .names()
            .into_iter()
            .filter_map(|n| n.strip_suffix(", saddle"))
            .collect();
        stems.dedup();
        let rows = stems
            .iter()
            .map(|stem| {
                let mut row = vec![(*stem).to_owned()];
                row.extend(solvers.map(|solver| {
                    let name = format!("{stem}, {solver}");
                    let steps = self.of(&name).filter(|p| p.errors.is_some());
                    let time = steps.map(|p| 1e6 * p.wall * p.step).reduce(f64::min);
                    time.map_or("–".to_owned(), short)
                }));
                row
            })
            .collect();
        let mut head = vec!["method, chart".to_owned()];
        head.extend(solvers.map(|s| format!("{s} (µs)")));
        Table {
            caption:
                "Time of one step in a chart by mass-matrix solver, the best over the step sizes"
                    .into(),
            head,
            rows,
        }
    }
}

/// Errors below this are drawn as this: round-off, and zero has no logarithm.
const CLIP: f64 = 1e-17;

/// The whole decades that hold some values.
pub(super) fn decades(values: impl Iterator<Item = f64>) -> [i32; 2] {
    let (low, high) = values
        .filter(|v| v.is_finite() && *v > 0.0)
        .fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return [-1, 0];
    }
    let first = low.log10().floor() as i32;
    [first, (high.log10().ceil() as i32).max(first + 1)]
}

/// A logarithmic axis over whole decades with at most six or so ticks.
pub(super) fn axis(label: &str, [first, last]: [i32; 2]) -> Axis {
    let every = ((last - first) as usize).div_ceil(6).max(1);
    Axis::decades(label, first, last, every)
}

/// When a doubt grows to the size of the sheet, 1 m; `None` when it does not.
fn horizon(rate: f64, doubt: f64) -> Option<String> {
    let time = -doubt.ln() / rate;
    (rate > 0.0 && time.is_finite()).then(|| short(time))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quick_study_of_the_pendulum_holds_together() {
        let study = make(Problem::Pendulum, StudyEffort::Quick).unwrap();
        let csv = study.csv();
        assert_eq!(csv.lines().count(), 1 + study.points.len());
        assert!(csv.contains("pendulum,\"BDF2 (default)\","), "{csv}");
        assert!(!csv.contains(",NaN") && !csv.contains(",inf"), "{csv}");
        let svg = study.plot().to_svg("t").unwrap();
        assert!(svg.contains("RATTLE composition"));
        assert_eq!(study.table().rows.len(), Scheme::all().len());
        assert_eq!(study.solver_table().rows.len(), 6);
        // Second order shows in a few milliseconds already.
        let order = order(
            &study.points,
            "RATTLE",
            Measure::Position,
            study.reference.doubt(),
        );
        assert!(order.is_some_and(|o| (o - 2.0).abs() < 0.2), "{order:?}");
        // Lengths: exact for us, drifting for the published scheme.
        let strain = |name: &str| {
            study
                .of(name)
                .filter_map(|p| p.errors.map(|e| e.strain))
                .fold(0.0, f64::max)
        };
        assert!(strain(DEFAULT) < 1e-11 && strain("published scheme") > 1e-4);
    }

    #[test]
    fn decades_hold_the_values() {
        assert_eq!(decades([2e-3, 0.5].into_iter()), [-3, 0]);
        assert_eq!(decades([1.0].into_iter()), [0, 1]);
        assert_eq!(decades(std::iter::empty()), [-1, 0]);
    }
}
