//! The default against the published scheme at equal wall time.

use super::measure::{Errors, Point};
use super::problem::Problem;
use super::scheme::{DEFAULT, is_paper};
use super::study::Study;
use crate::report::{extremes, rounded, short};

/// A run of the published scheme and the best that the default does in no more time.
struct Match<'a> {
    paper: &'a Point,
    theirs: Errors,
    /// Smallest energy error and strain of the default.
    ours: Option<[f64; 2]>,
}

fn matches(study: &Study) -> Vec<Match<'_>> {
    study
        .points
        .iter()
        .filter(|p| is_paper(&p.scheme))
        .filter_map(|paper| {
            let theirs = paper
                .errors
                .or(paper.partial)
                .filter(|_| paper.cost.substeps >= FEWEST)?;
            let ours = study
                .points
                .iter()
                .filter(|p| p.scheme == DEFAULT && p.wall <= paper.wall)
                .filter_map(|p| p.errors)
                .map(|e| [e.energy, e.strain])
                .reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])]);
            Some(Match {
                paper,
                theirs,
                ours,
            })
        })
        .collect()
}

/// Fewest steps of a run that says something: the first step of forward Euler from rest moves nothing.
const FEWEST: usize = 5;

/// Smallest strain that counts: of lengths in double precision.
const ROUND_OFF: f64 = f64::EPSILON;

/// The verdict on one study, in words.
pub(crate) fn words(study: &Study) -> String {
    let title = study.problem.title();
    let paper: Vec<&Point> = study
        .points
        .iter()
        .filter(|p| is_paper(&p.scheme))
        .collect();
    let ours = study
        .points
        .iter()
        .filter(|p| p.scheme == DEFAULT && p.errors.is_some())
        .count();
    let matches = matches(study);
    if matches.is_empty() {
        return format!(
            "{title}: none of the {} runs of the published scheme came to the first checkpoint ({}); {ours} of the default came to the \
             end.",
            paper.len(),
            reasons(&paper)
        );
    }
    let ratios: Vec<[f64; 2]> = matches
        .iter()
        .filter_map(|m| {
            let [energy, strain] = m.ours?;
            Some([
                m.theirs.energy / energy.max(ROUND_OFF),
                m.theirs.strain / strain.max(ROUND_OFF),
            ])
        })
        .collect();
    let unmatched = matches.len() - ratios.len();
    let walls = extremes(matches.iter().map(|m| m.paper.wall)).unwrap_or_default();
    let ended = matches.iter().filter(|m| m.paper.errors.is_some()).count();
    let furthest = matches.iter().map(|m| m.paper.reached).fold(0.0, f64::max);
    let mut text = format!(
        "{title}: {ended} of {} runs of the published scheme came to the end{}; {} are compared up to the last checkpoint that they reached, the furthest at {} s \
         ({} to {} s/s).",
        paper.len(),
        if ended == 0 {
            format!(" ({})", reasons(&paper))
        } else {
            String::new()
        },
        matches.len(),
        short(furthest),
        short(walls[0]),
        short(walls[1]),
    );
    if ratios.is_empty() {
        text.push_str(
            " All of them are faster than the fastest run of the default that came to the end.",
        );
        return text;
    }
    for (k, name) in ["energy error", "strain"].into_iter().enumerate() {
        let range = extremes(ratios.iter().map(|r| r[k])).unwrap_or([f64::NAN; 2]);
        let [low, high] = range.map(short);
        text.push_str(&format!(
            " In no more time, the {name} of the default is {low} to {high} times smaller."
        ));
    }
    if unmatched > 0 {
        text.push_str(&format!(
            " {unmatched} runs of the published scheme are faster than the fastest of the default."
        ));
    }
    text
}

/// Why runs did not come to the end: the last reason of each variant.
fn reasons(paper: &[&Point]) -> String {
    let mut last: Vec<(&str, String)> = Vec::new();
    for p in paper {
        let Some(failure) = &p.failure else { continue };
        let reason = rounded(failure);
        match last.last_mut() {
            Some((name, text)) if *name == p.scheme => *text = reason,
            _ => last.push((&p.scheme, reason)),
        }
    }
    let parts: Vec<String> = last.iter().map(|(n, r)| format!("{n}: {r}")).collect();
    parts.join("; ")
}

/// The problems on which the verdict is passed.
pub(crate) fn concerns(problem: Problem) -> bool {
    matches!(problem, Problem::Sheet(1..=3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Effort;
    use crate::speed_vs_error::study;

    /// Made-up points in a real study: the words follow the numbers.
    #[test]
    fn words_follow_the_numbers() {
        let mut study = study::make(Problem::Triangle, Effort::Quick).unwrap();
        let mut one = study.points[0].clone();
        one.failure = None;
        let mut at = |scheme: &str, wall, energy, strain| {
            one.scheme = scheme.into();
            one.wall = wall;
            one.cost.substeps = 100;
            one.errors = Some(Errors {
                position: 1.0,
                energy,
                strain,
            });
            one.clone()
        };
        let paper = at("published scheme", 1.0, 1.0, 1e-2);
        let ours = at(DEFAULT, 0.5, 1e-4, 1e-13);
        let late = at(DEFAULT, 2.0, 1e-9, 1e-13);
        study.points = vec![paper.clone(), ours, late];
        let text = words(&study);
        assert!(
            text.contains("the energy error of the default is 1.0e4 to 1.0e4 times smaller."),
            "{text}"
        );
        assert!(
            text.contains("the strain of the default is 1.0e11 to 1.0e11 times smaller."),
            "{text}"
        );
        study.points[1].wall = 1.5;
        assert!(words(&study).contains("faster than the fastest run of the default"));
        let partial = study.points[0].errors.take();
        assert!(words(&study).contains("none of the 1 runs"));
        study.points[0].partial = partial;
        study.points[0].wall = 3.0;
        let text = words(&study);
        assert!(
            text.contains("0 of 1 runs of the published scheme came to the end"),
            "{text}"
        );
        assert!(text.contains("1.0e9 to 1.0e9 times smaller"), "{text}");
    }
}
