//! What a model of isometry is required to reach, and what was measured.

use super::isometry::Isometry;
use crate::report::{Bound, Cell, Table, Verdict, number};
use crate::runs::Course;

/// A requirement on a model, and what it reaches.
pub(super) type Target = crate::report::Finding;

/// A requirement that a value is at most `bound`, checked at the largest of all values; values of runs that
/// did not end are missing, and no values at all are missing, too.
pub(super) fn at_most(
    model: Isometry,
    quantity: &str,
    bound: f64,
    values: &[Option<f64>],
) -> Target {
    Target::worst(model.to_string(), quantity, Bound::AtMost(bound), values)
}

/// A requirement that a value is at least `bound`, checked at the smallest of all values.
pub(super) fn at_least(
    model: Isometry,
    quantity: &str,
    bound: f64,
    values: &[Option<f64>],
) -> Target {
    Target::worst(model.to_string(), quantity, Bound::AtLeast(bound), values)
}

/// No edge is longer or shorter by more than 1 % at any time: what the error in length of a sheet that stands
/// for paper may be at most. (Paper tears at a few per cent.) A model that meets other requirements by
/// stretching fails this one.
pub(super) const MOST_STRAIN: (&str, f64) = ("largest strain of an edge", 0.01);

/// What every accepted step guarantees, over all steps of all runs, those of runs included that did not
/// reach their end: equations of isometry to a tolerance of 1e-12 (of models that have some), gaps above 0
/// (of scenes with contact).
pub(super) fn kept<'a>(model: Isometry, runs: impl Iterator<Item = &'a Course>) -> Vec<Target> {
    let mut worst = Course::default();
    runs.for_each(|course| worst.add_run(course.clone()));
    let mut targets = Vec::new();
    if model.has_equations() {
        let quantity = "largest violation of the equations of isometry";
        targets.push(at_most(model, quantity, 1e-12, &[Some(worst.violation)]));
    }
    if worst.gap.is_some() {
        let (name, bound) = (model.to_string(), Bound::Above(0.0));
        targets.push(Target::worst(name, "smallest gap, m", bound, &[worst.gap]));
    }
    targets
}

/// All requirements with a column for each model; values that meet them are bold.
pub(super) fn by_model(targets: &[(String, Target)]) -> Table {
    let mut models = Isometry::ALL.map(|model| model.to_string()).to_vec();
    for (_, target) in targets {
        if !models.contains(&target.of) {
            models.push(target.of.clone());
        }
    }
    let head = ["yardstick", "quantity", "required"];
    let head: Vec<&str> = head
        .into_iter()
        .chain(models.iter().map(String::as_str))
        .collect();
    let mut table = Table::new(
        "Measured against target: the worst of all runs that the requirement names, bold where it is met. A dash: \
         one of these runs did not end, or the model is not asked.",
        &head,
    );
    let key = |(yardstick, t): &(String, Target)| {
        let required = t.bound.text();
        [yardstick.clone(), t.quantity.clone(), required]
    };
    let mut keys: Vec<[String; 3]> = Vec::new();
    for target in targets {
        if !keys.contains(&key(target)) {
            keys.push(key(target));
        }
    }
    for row in keys {
        let of = |model: &String| {
            let found = targets.iter().find(|t| t.1.of == *model && key(t) == row);
            let value = found.and_then(|(_, t)| Some((t.value?, t.verdict() == Verdict::Passed)));
            Cell::from(value.map(|(value, is_met)| match is_met {
                true => format!("**{}**", number(value)),
                false => number(value),
            }))
        };
        let values = models.iter().map(of);
        table.push(
            row.iter()
                .map(|name| Cell::from(name.as_str()))
                .chain(values)
                .collect(),
        );
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_have_columns_and_met_values_are_bold() {
        let pair = [
            ("y".into(), at_most(Isometry::Rods, "q", 2.0, &[Some(5.0)])),
            (
                "y".into(),
                at_most(Isometry::Elastic, "q", 2.0, &[Some(1.0)]),
            ),
        ];
        let text = by_model(&pair).text();
        let row: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
        assert_eq!(row, ["y", "q", "≤", "2", "5", "–", "**1**"]);
    }

    #[test]
    fn guarantees_are_those_of_the_worst_step() {
        let run = |violation, gap| Course {
            violation,
            gap,
            ..Course::default()
        };
        let met = |model, runs: &[&Course]| -> Vec<bool> {
            let targets = kept(model, runs.iter().copied());
            targets
                .iter()
                .map(|t| t.verdict() == Verdict::Passed)
                .collect()
        };
        let [good, loose] = [1e-13, 1e-11].map(|violation| run(violation, None));
        let (good, loose) = (&good, &loose);
        assert_eq!(met(Isometry::Rods, &[good, good]), [true]);
        assert_eq!(met(Isometry::Rods, &[good, loose, good]), [false]);
        let [near, touching] = [1e-6, 0.0].map(|gap| run(1e-13, Some(gap)));
        let (near, touching) = (&near, &touching);
        assert_eq!(met(Isometry::Rods, &[near, good]), [true, true]);
        assert_eq!(met(Isometry::Rods, &[near, touching]), [true, false]);
        // Elastic sheets have no equations.
        assert_eq!(met(Isometry::Paper, &[loose, near]), [true]);
        assert!(met(Isometry::Elastic, &[loose]).is_empty());
    }
}
