//! Which lines are cuts, creases and so on.

use super::class::LineClass;
use super::selector::Selector;
use crate::Pen;
use isosheet_mesh::wording::quoted;

/// What lines are taken for. A selector by layer counts before one by colour, and that before one by dash;
/// what is selected by none goes by the words in the names of its layers, then by its colour as in Origami
/// Simulator, then by its dash.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineRules {
    /// The selectors with what they mean.
    pub selectors: Vec<(Selector, LineClass)>,
}

/// Words of names of layers, and what lines there are.
const WORDS: [(LineClass, &[&str]); 6] = [
    (
        LineClass::Cut,
        &[
            "cut", "cuts", "cutting", "outline", "contour", "knife", "boundary", "border", "hole",
            "holes", "slit", "slits", "slot", "slots",
        ],
    ),
    (LineClass::Mountain, &["mountain", "mountains"]),
    (LineClass::Valley, &["valley", "valleys"]),
    (
        LineClass::Crease,
        &[
            "crease",
            "creases",
            "unassigned",
            "fold",
            "folds",
            "folding",
            "score",
            "scores",
            "scoring",
            "bend",
            "bends",
            "perf",
            "perfs",
            "perforation",
            "perforations",
            "hinge",
            "hinges",
        ],
    ),
    (LineClass::Flat, &["facet", "facets", "flat"]),
    (
        LineClass::Ignored,
        &[
            "dim",
            "dims",
            "dimension",
            "dimensions",
            "annotation",
            "annotations",
            "note",
            "notes",
            "text",
            "texts",
            "guide",
            "guides",
            "hint",
            "hints",
            "bleed",
            "print",
            "artwork",
            "safety",
            "title",
        ],
    ),
];

/// Colours of solid lines as Origami Simulator reads them, and white, which cannot be seen.
const COLOURS: [(&str, LineClass); 7] = [
    ("black", LineClass::Cut),
    ("green", LineClass::Cut),
    ("red", LineClass::Mountain),
    ("blue", LineClass::Valley),
    ("magenta", LineClass::Crease),
    ("yellow", LineClass::Flat),
    ("white", LineClass::Ignored),
];

impl LineRules {
    /// What lines of a pen are, with the reason in words; `None` where nothing says it.
    pub fn class(&self, pen: &Pen) -> Option<(LineClass, String)> {
        let selected = self.selectors.iter().filter(|(s, _)| s.selects(pen));
        if let Some((selector, class)) = selected.min_by_key(|(s, _)| s.rank()) {
            return Some((*class, selector.to_string()));
        }
        let by_word =
            |name: &String| Some((class_of_name(name)?, format!("layer {}", quoted(name))));
        if let Some(found) = pen.layers.iter().find_map(by_word) {
            return Some(found);
        }
        let colour = pen.colour.name();
        if pen.dashed && matches!(colour, Some("black" | "grey") | None) {
            return Some((LineClass::Crease, "dashed".to_owned()));
        }
        let known = COLOURS.iter().find(|(name, _)| Some(*name) == colour);
        known.map(|(name, class)| (*class, (*name).to_owned()))
    }
}

/// What the words of a name say; nothing if they say several things, but that mountains and valleys are
/// creases.
fn class_of_name(name: &str) -> Option<LineClass> {
    let name = spaced(name).replace("half cut", "score");
    let words: Vec<&str> = name.split(' ').collect();
    // Long words may begin others: `foldlines`, `scored`.
    let begins =
        |word: &str, known: &&str| word == *known || known.len() > 3 && word.starts_with(known);
    let is_said = |known: &[&str]| words.iter().any(|w| known.iter().any(|k| begins(w, k)));
    let said = WORDS.iter().filter(|(_, known)| is_said(known));
    let said: Vec<LineClass> = said.map(|(class, _)| *class).collect();
    match said[..] {
        [class]
        | [
            class @ (LineClass::Mountain | LineClass::Valley),
            LineClass::Crease,
        ] => Some(class),
        _ => None,
    }
}

/// The words of a name in small letters with blanks between them: what has capitals inside is several words.
fn spaced(name: &str) -> String {
    let (mut words, mut before) = (String::new(), ' ');
    for c in name.chars() {
        let c = if c.is_alphabetic() { c } else { ' ' };
        if c.is_uppercase() && before.is_lowercase() || c == ' ' {
            words.push(' ');
        }
        words.extend(c.to_lowercase().filter(|c| *c != ' '));
        before = c;
    }
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Colour;

    fn pen(colour: [u8; 3], dashed: bool, layers: &[&str]) -> Pen {
        Pen {
            colour: Colour(colour),
            dashed,
            opacity: 1.0,
            layers: layers.iter().map(|l| (*l).to_owned()).collect(),
        }
    }

    #[test]
    fn layers_count_before_colours_and_these_before_dashes() {
        let rules = LineRules::default();
        let class = |pen: &Pen| rules.class(pen).map(|(class, _)| class);
        for (pen, expected) in [
            (pen([0; 3], false, &[]), Some(LineClass::Cut)),
            (pen([0; 3], true, &[]), Some(LineClass::Crease)),
            (pen([255, 0, 0], true, &[]), Some(LineClass::Mountain)),
            (
                pen([255, 0, 0], false, &["Cut_Lines"]),
                Some(LineClass::Cut),
            ),
            (
                pen([0; 3], false, &["a", "Score lines"]),
                Some(LineClass::Crease),
            ),
            (
                pen([0; 3], false, &["mountain-folds"]),
                Some(LineClass::Mountain),
            ),
            (
                pen([0, 0, 255], false, &["cut and crease"]),
                Some(LineClass::Valley),
            ),
            (pen([0; 3], false, &["foldlines"]), Some(LineClass::Crease)),
            (pen([0; 3], false, &["Scored"]), Some(LineClass::Crease)),
            (pen([255; 3], false, &["cutLines"]), Some(LineClass::Cut)),
            (pen([255; 3], false, &["OuterCUT"]), Some(LineClass::Cut)),
            (pen([0; 3], false, &["halfCut"]), Some(LineClass::Crease)),
            (pen([0; 3], false, &["HalfCut"]), Some(LineClass::Crease)),
            (pen([0; 3], false, &["half cut"]), Some(LineClass::Crease)),
            (pen([0; 3], false, &["half-cut 2"]), Some(LineClass::Crease)),
            (pen([255, 128, 0], false, &["Layer 1"]), None),
            (
                pen([128; 3], false, &["dimensions"]),
                Some(LineClass::Ignored),
            ),
            (pen([0; 3], false, &["hint"]), Some(LineClass::Ignored)),
        ] {
            assert_eq!(class(&pen), expected, "{pen:?}");
        }
        let selectors = [
            ("red", LineClass::Cut),
            ("layer:X", LineClass::Crease),
            ("solid", LineClass::Flat),
        ];
        let selectors = selectors.map(|(text, class)| (text.parse().unwrap(), class));
        let rules = LineRules {
            selectors: selectors.to_vec(),
        };
        let class = |pen: &Pen| rules.class(pen).map(|(class, _)| class);
        assert_eq!(
            class(&pen([250, 0, 0], false, &["cut"])),
            Some(LineClass::Cut)
        );
        assert_eq!(
            class(&pen([250, 0, 0], false, &["x"])),
            Some(LineClass::Crease)
        );
        assert_eq!(class(&pen([0, 0, 250], false, &[])), Some(LineClass::Flat));
        assert_eq!(class(&pen([0, 0, 250], true, &[])), Some(LineClass::Valley));
    }
}
