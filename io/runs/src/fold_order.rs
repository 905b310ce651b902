//! Whether groups of creases fold in the order that is asked for.

use isosheet_scenes::{FoldTargets, Folding};

/// Creases that are further from their angles than this, degrees, are open.
pub(super) const OPEN: f64 = 5.0;

/// How near to their angles the creases of a group come.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupFold {
    /// The creases of the group in words.
    pub name: String,
    /// How far the one that is furthest is from its angle when the next group begins, degrees; `None` of the
    /// last group.
    pub at_next: Option<f64>,
    /// How far the crease of the group that is furthest is from its angle at the end, degrees.
    pub at_end: f64,
}

/// The groups of a folding, one after the other, followed through a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FoldOrder {
    /// None if all creases fold at the same time.
    pub groups: Vec<GroupFold>,
    /// When each group should have reached its angles, seconds.
    ends: Vec<f64>,
}

impl FoldOrder {
    /// Where the motion begins.
    pub(super) fn begin(folding: Option<&Folding>) -> Self {
        let order = folding.into_iter().flat_map(|folding| {
            let groups = folding.order.iter().enumerate();
            groups.map(|(k, group)| (group.in_words(), folding.turn_of(k)[1]))
        });
        let (names, ends): (Vec<_>, Vec<_>) = order.unzip();
        let group = |name| GroupFold {
            name,
            at_next: None,
            at_end: 0.0,
        };
        Self {
            groups: names.into_iter().map(group).collect(),
            ends,
        }
    }

    /// At the next time (seconds), when the creases are so far from their targets, degrees.
    pub(super) fn follow(&mut self, targets: &FoldTargets, t: f64, off: &[f64]) {
        let last = self.groups.len().saturating_sub(1);
        for (k, group) in self.groups.iter_mut().enumerate() {
            let own = targets.groups.iter().zip(off).filter(|(of, _)| **of == k);
            group.at_end = own.map(|(_, off)| *off).fold(0.0, f64::max);
            if k < last && t >= self.ends[k] {
                group.at_next.get_or_insert(group.at_end);
            }
        }
    }

    /// What is not as it was asked for, a sentence; `None` if all groups have reached their angles in turn.
    pub(super) fn in_words(&self) -> Option<String> {
        let is_short = |off: &f64| *off > OPEN;
        let told = self.groups.iter().enumerate().filter_map(|(k, group)| {
            let GroupFold { name, at_end, .. } = group;
            let next = self.groups.get(k + 1).map(|next| &next.name);
            match (group.at_next.filter(is_short), next) {
                (Some(off), Some(next)) => Some(format!(
                    "\"{name}\" is up to {off:.0} degrees from its angles when \"{next}\" begins, and {at_end:.0} at the end"
                )),
                (_, Some(_)) if is_short(at_end) => Some(format!(
                    "\"{name}\" has reached its angles, and is up to {at_end:.0} degrees from them at the end"
                )),
                (_, None) if is_short(at_end) => {
                    Some(format!("\"{name}\" is up to {at_end:.0} degrees from its angles at the end"))
                }
                _ => None,
            }
        });
        let told: Vec<String> = told.collect();
        (!told.is_empty()).then(|| format!("The order is not achieved: {}.", told.join("; ")))
    }
}
