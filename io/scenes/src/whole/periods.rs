//! What of a scene does not hold at all times.

use crate::holding::switch::{Holder, Period};
use crate::words::key::Key;
use crate::words::problem::Checks;
use crate::{Integrator, Scene};

impl Scene {
    /// Whether something of it does not hold at all times.
    pub fn has_periods(&self) -> bool {
        self.periods().next().is_some()
    }

    /// The periods of all that does not hold at all times.
    pub(crate) fn periods(&self) -> impl Iterator<Item = Period<'_>> {
        let supports = self.support.iter().enumerate();
        let supports = supports.map(|(k, s)| (Holder::Support(k), &s.from, &s.until));
        let glue = self.glue.iter().enumerate();
        let glue = glue.map(|(k, g)| (Holder::Glue(k), &g.from, &g.until));
        let pairs = self.contact.pair.iter().enumerate();
        let pairs = pairs.map(|(k, p)| (Holder::Contact(k), &p.from, &p.until));
        let all = supports.chain(glue).chain(pairs);
        let all = all.map(|(of, from, until)| Period {
            of,
            from: from.as_ref(),
            until: until.as_ref(),
        });
        all.filter(|period| period.from.is_some() || period.until.is_some())
    }

    pub(crate) fn check_periods(&self, checks: &mut Checks) {
        self.check_gas(checks);
        for period in self.periods() {
            period.check(&self.measure, checks);
            let key = period.of.key();
            if !self.method.integrator.is_minimising() {
                checks.report(
                    key.name(period.first_name()),
                    match self.method.integrator {
                        Integrator::Chart => "what holds a sheet in a chart holds it at all times",
                        _ => "this integrator has no place for what comes and goes",
                    },
                    "choose `bdf2` or `implicit_euler` as `method.integrator`",
                );
            }
            if self.folding.is_some() && matches!(period.of, Holder::Support(_)) {
                checks.report(
                    key.name(period.first_name()),
                    "the supports of a sheet that `folding` folds hold it at all times",
                    "leave the key out, or drive the creases by `[[crease]]`",
                );
            }
        }
    }

    /// The surface around a gas is closed at all times.
    fn check_gas(&self, checks: &mut Checks) {
        for (key, gas) in Key::root().name("forces.gas").entries(&self.forces.gas) {
            let named = gas.sheets.as_ref();
            let is_around = |name: &String| named.is_none_or(|all| all.contains(name));
            let opens = self.glue.iter().position(|glue| {
                let switches = glue.from.is_some() || glue.until.is_some();
                // Without names it is of the only sheet.
                switches
                    && glue
                        .sheets
                        .as_ref()
                        .is_none_or(|two| two.iter().any(is_around))
            });
            if let Some(k) = opens {
                let message = format!(
                    "`glue[{k}]`, which opens or closes in time, is a seam of the sheets around it"
                );
                let remedy =
                    "let the seams around a gas hold at all times, or take `forces.pressure`";
                checks.report(key, message, remedy);
            }
        }
    }
}
