//! What a model of isometry is required to reach, and what was measured.

use super::isometry::Isometry;
use crate::report::{Cell, Table, number};
use crate::runs::Course;
use serde::{Deserialize, Serialize};

/// On which side of its bound a measured number has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Bound {
    AtMost,
    AtLeast,
    Above,
}

impl Bound {
    /// For people.
    fn words(self) -> &'static str {
        match self {
            Self::AtMost => "at most",
            Self::AtLeast => "at least",
            Self::Above => "above",
        }
    }
}

/// A requirement, and what a model reaches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Target {
    pub(super) model: Isometry,
    /// What is required, in words, without the bound.
    pub(super) quantity: String,
    pub(super) side: Bound,
    pub(super) bound: f64,
    /// The worst value measured; nothing where a run that it needs did not end.
    pub(super) measured: Option<f64>,
}

impl Target {
    /// Whether the requirement is met; a missing value does not meet it.
    pub(super) fn is_met(&self) -> bool {
        self.measured.is_some_and(|value| match self.side {
            Bound::AtMost => value <= self.bound,
            Bound::AtLeast => value >= self.bound,
            Bound::Above => value > self.bound,
        })
    }
}

/// A requirement that a value is at most `bound`, checked at the largest of all values; values of runs that
/// did not end are missing, and no values at all are missing, too.
pub(super) fn at_most(
    model: Isometry,
    quantity: &str,
    bound: f64,
    values: &[Option<f64>],
) -> Target {
    worst(model, quantity, (Bound::AtMost, bound), values, f64::max)
}

/// A requirement that a value is at least `bound`, checked at the smallest of all values.
pub(super) fn at_least(
    model: Isometry,
    quantity: &str,
    bound: f64,
    values: &[Option<f64>],
) -> Target {
    worst(model, quantity, (Bound::AtLeast, bound), values, f64::min)
}

fn worst(
    model: Isometry,
    quantity: &str,
    (side, bound): (Bound, f64),
    values: &[Option<f64>],
    select: fn(f64, f64) -> f64,
) -> Target {
    let finite = |v: &Option<f64>| v.filter(|v| v.is_finite());
    let known: Option<Vec<f64>> = values.iter().map(finite).collect();
    Target {
        model,
        quantity: quantity.to_owned(),
        side,
        bound,
        measured: known.and_then(|values| values.into_iter().reduce(select)),
    }
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
        targets.push(Target {
            model,
            quantity: "smallest gap, m".into(),
            side: Bound::Above,
            bound: 0.0,
            measured: worst.gap,
        });
    }
    targets
}

/// All requirements as a table.
pub(super) fn table(targets: &[(String, Target)]) -> Table {
    Table::of(
        "Measured against target. A number is the worst of all runs that the requirement names; where it is missing, one of these runs did not end",
        targets,
        &[
            ("yardstick", &|(yardstick, _)| yardstick.as_str().into()),
            ("quantity", &|(_, t)| t.quantity.as_str().into()),
            ("model", &|(_, t)| t.model.to_string().into()),
            ("required", &|(_, t)| t.side.words().into()),
            ("bound", &|(_, t)| t.bound.into()),
            ("measured", &|(_, t)| t.measured.into()),
            ("met", &|(_, t)| if t.is_met() { "yes" } else { "no" }.into()),
        ],
    )
    .named("targets")
}

/// All requirements with a column for each model; values that meet them are bold.
pub(super) fn by_model(targets: &[(String, Target)]) -> Table {
    let models = Isometry::ALL.map(|model| model.to_string());
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
        let required = format!("{} {}", t.side.words(), number(t.bound));
        [yardstick.clone(), t.quantity.clone(), required]
    };
    let mut keys: Vec<[String; 3]> = Vec::new();
    for target in targets {
        if !keys.contains(&key(target)) {
            keys.push(key(target));
        }
    }
    for row in keys {
        let of = |model: Isometry| {
            let found = targets.iter().find(|t| t.1.model == model && key(t) == row);
            let value = found.and_then(|(_, t)| Some((t.measured?, t.is_met())));
            Cell::from(value.map(|(value, is_met)| match is_met {
                true => format!("**{}**", number(value)),
                false => number(value),
            }))
        };
        let values = Isometry::ALL.map(of);
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
    fn the_worst_value_decides_and_a_missing_one_fails() {
        let model = Isometry::Rods;
        let met = |values: &[Option<f64>]| {
            let [most, least] = [at_most, at_least].map(|f| f(model, "q", 2.0, values));
            (most.is_met(), least.is_met())
        };
        assert_eq!(met(&[Some(1.0), Some(2.0)]), (true, false));
        assert_eq!(met(&[Some(2.0), Some(3.0)]), (false, true));
        assert_eq!(met(&[Some(2.0), None]), (false, false));
        assert_eq!(met(&[Some(2.0), Some(f64::NAN)]), (false, false));
        assert_eq!(met(&[]), (false, false));
        let worst = at_most(model, "q", 2.0, &[Some(1.0), Some(5.0)]);
        assert_eq!(worst.measured, Some(5.0));
        let csv = table(&[("y".into(), worst)]).csv().unwrap();
        let text = String::from_utf8(csv).unwrap();
        assert!(text.ends_with("y,q,rods,at most,2,5,no\n"), "{text}");
        let pair = [
            ("y".into(), at_most(Isometry::Rods, "q", 2.0, &[Some(5.0)])),
            ("y".into(), at_most(Isometry::Weak, "q", 2.0, &[Some(1.0)])),
        ];
        let text = by_model(&pair).text();
        let row: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
        assert_eq!(row, ["y", "q", "at", "most", "2", "5", "–", "–", "**1**"]);
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
            targets.iter().map(Target::is_met).collect()
        };
        let [good, loose] = [1e-13, 1e-11].map(|violation| run(violation, None));
        let (good, loose) = (&good, &loose);
        assert_eq!(met(Isometry::Weak, &[good, good]), [true]);
        assert_eq!(met(Isometry::Weak, &[good, loose, good]), [false]);
        let [near, touching] = [1e-6, 0.0].map(|gap| run(1e-13, Some(gap)));
        let (near, touching) = (&near, &touching);
        assert_eq!(met(Isometry::Rods, &[near, good]), [true, true]);
        assert_eq!(met(Isometry::Rods, &[near, touching]), [true, false]);
        // Elastic sheets have no equations.
        assert_eq!(met(Isometry::Paper, &[loose, near]), [true]);
        assert!(met(Isometry::Soft, &[loose]).is_empty());
    }
}
