//! Names of sheets, bodies and obstacles by which other parts of a scene find them.

use crate::Scene;
use crate::bodies::body;
use crate::sheets::several;
use crate::words::key::{Key, KeyPart};
use crate::words::part::all;
use crate::words::problem::Checks;

impl Scene {
    /// Checks every text at a key `sheet` or `sheets`: something has this name.
    pub(crate) fn check_names(&self, checks: &mut Checks) {
        let of_sheets = || self.sheet.iter().filter_map(|sheet| sheet.name.clone());
        let of_bodies = || body::names(&self.body);
        let of_obstacles = || self.obstacle.iter().filter_map(|o| o.name.clone());
        for (at, name) in all::<String>(self, Key::root()) {
            let names: Vec<&str> = at.key.parts().iter().filter_map(name_of).collect();
            let (meant, known): (_, Vec<String>) = match names[..] {
                // Seams and the folding say more than that a name is unknown.
                ["glue" | "folding", ..] => continue,
                ["contact", "pair", "sheets"] => (
                    "sheet, body or obstacle",
                    of_sheets()
                        .chain(of_bodies())
                        .chain(of_obstacles())
                        .collect(),
                ),
                ["measure", "sheet"] if !self.body.is_empty() => {
                    ("sheet or body", of_sheets().chain(of_bodies()).collect())
                }
                [.., "sheet" | "sheets"] => ("sheet", of_sheets().collect()),
                _ => continue,
            };
            if !known.contains(name) {
                let problem = several::unknown_name(meant, known.into_iter(), name, &at.key);
                checks.problems.push(problem);
            }
        }
    }
}

fn name_of(part: &KeyPart) -> Option<&str> {
    match part {
        KeyPart::Name(name) => Some(name),
        KeyPart::Entry(_) => None,
    }
}
