//! The angle and the moment of creases.

use crate::sheets::fold_group::FoldGroup;
use crate::sheets::folding::FoldTargets;
use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_dynamics::{At, CreaseSprings, Memories};
use isosheet_mesh::EdgeId;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

#[derive(Clone, Copy, Debug)]
pub(super) enum OfCrease {
    Angle,
    Moment,
    MomentPerLength,
}

/// The creases of a scene that measures may be of.
#[derive(Clone, Debug, Default)]
pub(crate) struct CreaseGauges {
    /// The creases that have names.
    pub(crate) named: BTreeMap<String, CreaseGauge>,
    /// The creases of the pattern that is folded, in the order of its targets, and the targets.
    pub(crate) folded: Option<(CreaseGauge, FoldTargets)>,
}

impl CreaseGauges {
    /// The creases of a group of the pattern that is folded.
    pub(super) fn of_group(&self, group: &FoldGroup, key: &Key) -> Result<CreaseGauge, Problem> {
        let own = match &self.folded {
            Some((crease, targets)) => {
                group.refuse_idle(targets.drawn(), key)?;
                let own = targets.of_group(group);
                let measured = own.iter().map(|&k| crease.measured[k]);
                CreaseGauge {
                    measured: measured.collect(),
                    ..crease.clone()
                }
            }
            // Refused by the checks.
            None => {
                return Err(Problem::new(
                    key.clone(),
                    "the scene has no `[folding]`",
                    "leave it out",
                ));
            }
        };
        match own.measured.is_empty() {
            false => Ok(own),
            true => {
                let message = "no crease that is driven is one of these";
                let remedy = "name creases by lines of the drawing or by the numbers of the edges in a FOLD file, which \
                              `isosheet convert PATTERN FILE.fold` writes; edges of the outline do not fold";
                Err(Problem::new(key.clone(), message, remedy))
            }
        }
    }
}

/// The springs of a crease, and where they are.
#[derive(Clone, Debug)]
pub(crate) struct CreaseGauge {
    pub(crate) springs: Arc<CreaseSprings>,
    /// The springs that are measured, by their numbers, with the rest length of the edge of each, metres.
    pub(crate) measured: Vec<(usize, f64)>,
    /// Its sheet.
    pub(crate) part: isosheet_mesh::Part,
    /// The number of the springs among the potentials of the model.
    pub(crate) potential: usize,
    /// Other springs at some of its edges, with their numbers.
    pub(crate) others: Vec<(Arc<CreaseSprings>, usize)>,
}

impl CreaseGauge {
    /// Finds which springs of its sheet, with their numbers among the potentials, share edges with it.
    /// (Springs of other sheets have other numbers.)
    pub(crate) fn find_others(&mut self, of_sheet: &[(Arc<CreaseSprings>, usize)]) {
        if !of_sheet.iter().any(|(_, k)| *k == self.potential) {
            return;
        }
        let own: BTreeSet<EdgeId> = self.springs.edges().collect();
        let others = of_sheet.iter().filter(|(springs, k)| {
            *k != self.potential && springs.edges().any(|e| own.contains(&e))
        });
        self.others = others.cloned().collect();
    }

    pub(super) fn value(&self, of: OfCrease, t: f64, x: &[f64], memories: &Memories) -> f64 {
        let own = At::new(t, &x[self.part.coordinates()]);
        let remembering = |potential: usize| own.with_memory(&memories.lists()[potential]);
        let at = remembering(self.potential);
        let length: f64 = self.measured.iter().map(|(_, length)| length).sum();
        let moment = || {
            let moments = self.springs.moments(at);
            -self.measured.iter().map(|(k, _)| moments[*k]).sum::<f64>()
        };
        match of {
            OfCrease::Angle => {
                let angles = self.springs.angles(at);
                let edges: Vec<EdgeId> = self.springs.edges().collect();
                let mut bends = BTreeMap::<EdgeId, f64>::new();
                let of_others = self.others.iter().map(|(springs, k)| (&**springs, *k));
                for (springs, k) in of_others.chain([(&*self.springs, self.potential)]) {
                    for (e, bend) in springs.bends_beside(remembering(k)) {
                        *bends.entry(e).or_default() += bend;
                    }
                }
                let kink = |k: usize| match bends.get(&edges[k]) {
                    Some(bend) => angles[k] - bend,
                    None => angles[k],
                };
                let weighted = self.measured.iter().map(|(k, length)| kink(*k) * length);
                (weighted.sum::<f64>() / length).to_degrees()
            }
            OfCrease::Moment => moment(),
            OfCrease::MomentPerLength => moment() / length,
        }
    }
}
