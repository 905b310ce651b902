//! How the time of a run compares: with the fastest exact run of the same scene and mesh, and with the time
//! of one factorisation a step, the least that an implicit method can do.

use crate::report::short;
use std::fmt::Write;

/// Largest relative edge length error of a run that counts as exact: the loosest tolerance that the runs of
/// the report ask for. Programs that let edges stretch are at 1e-5 and above.
const EXACT: f64 = 1e-9;

/// What a comparison knows about a run.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// The method, and the step where several are compared.
    pub(crate) name: String,
    /// Wall seconds for a simulated second; `None` for a run that did not come to the end.
    pub(crate) wall: Option<f64>,
    /// Largest relative edge length error.
    pub(crate) strain: f64,
    /// Wall seconds for a simulated second that one factorisation in each step would take.
    pub(crate) limit: f64,
}

impl Entry {
    /// The wall seconds of a run that came to the end and kept the lengths.
    fn exact(&self) -> Option<f64> {
        self.wall.filter(|_| self.strain <= EXACT)
    }

    /// The time as a multiple of that of the fastest exact run among `all`, and of one factorisation a step.
    pub(crate) fn multiples(&self, all: &[Self]) -> [Option<f64>; 2] {
        let fastest = fastest(all).and_then(Self::exact);
        [
            self.wall.zip(fastest).map(|(wall, f)| wall / f),
            self.wall.map(|wall| wall / self.limit),
        ]
    }
}

/// The fastest run that came to the end and kept the lengths.
fn fastest(all: &[Entry]) -> Option<&Entry> {
    let exact = all.iter().filter_map(|e| Some((e, e.exact()?)));
    Some(exact.min_by(|a, b| a.1.total_cmp(&b.1))?.0)
}

/// The comparison of all runs of a scene and mesh in words.
pub(crate) fn words(scene: &str, all: &[Entry]) -> String {
    let Some((best, wall)) = fastest(all).and_then(|e| Some((e, e.exact()?))) else {
        return format!("{scene}: no run came to the end with lengths kept to {EXACT:.0e}.");
    };
    let mut text = format!(
        "{scene}: the fastest method that keeps lengths to {EXACT:.0e} is {}: {} s/s, {} times the {} s/s of one factorisation a step.",
        best.name,
        short(wall),
        short(wall / best.limit),
        short(best.limit)
    );
    for other in all.iter().filter(|e| e.name != best.name) {
        if let [Some(times), Some(of_limit)] = other.multiples(all) {
            let _ = write!(
                text,
                " {} takes {} times as long, {} times one factorisation a step{}.",
                other.name,
                short(times),
                short(of_limit),
                if other.exact().is_none() {
                    format!(", and strains edges by {:.0e}", other.strain)
                } else {
                    String::new()
                }
            );
        } else {
            let _ = write!(text, " {} did not come to the end.", other.name);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(name: &str, wall: Option<f64>, strain: f64, limit: f64) -> Entry {
        Entry {
            name: name.into(),
            wall,
            strain,
            limit,
        }
    }

    #[test]
    fn the_fastest_is_the_fastest_of_those_that_end_and_keep_the_lengths() {
        let all = [
            entry("slow", Some(0.6), 1e-12, 0.1),
            entry("fast", Some(0.2), 1e-10, 0.1),
            entry("loose", Some(0.05), 1e-3, 0.1),
            entry("lost", None, 1e-12, 0.1),
        ];
        assert_eq!(fastest(&all).map(|e| e.name.as_str()), Some("fast"));
        let close = |a: Option<f64>, b: f64| (a.expect("a run that ended") - b).abs() < 1e-12;
        let [times, of_limit] = all[0].multiples(&all);
        assert!(close(times, 3.0) && close(of_limit, 6.0));
        let [times, of_limit] = all[2].multiples(&all);
        assert!(close(times, 0.25) && close(of_limit, 0.5));
        assert_eq!(all[3].multiples(&all), [None, None]);
        let text = words("Sheet", &all);
        assert!(
            text.contains("is fast: 0.20 s/s, 2.0 times the 0.10 s/s"),
            "{text}"
        );
        assert!(
            text.contains("slow takes 3.0 times as long, 6.0 times one factorisation a step."),
            "{text}"
        );
        assert!(text.contains("and strains edges by 1e-3"), "{text}");
        assert!(text.contains("lost did not come to the end"), "{text}");
        assert!(words("Sheet", &all[2..]).contains("no run came to the end with lengths kept"));
    }

    #[test]
    fn without_an_exact_run_the_limit_is_still_compared() {
        let all = [entry("loose", Some(0.05), 1e-3, 0.1)];
        assert_eq!(all[0].multiples(&all), [None, Some(0.5)]);
    }
}
