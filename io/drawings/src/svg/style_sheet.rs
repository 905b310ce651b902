//! Style sheets: the rules for an element are found by its name, its classes and its identifier.

use isosheet_files::{Allowance, DataError};
use roxmltree::Node;
use simplecss::{
    AttributeOperator, Declaration, DeclarationTokenizer, Element, PseudoClass, Selector,
};
use std::cell::Cell;
use std::collections::{BTreeSet, HashMap};

/// The rules of all style sheets of a file.
pub(super) struct Rules<'a> {
    /// The selectors with the numbers of their blocks, the least specific first.
    rules: Vec<(Selector<'a>, usize)>,
    blocks: Vec<Vec<Declaration<'a>>>,
    /// The rules that elements with a key may have.
    of_key: HashMap<String, Vec<usize>>,
    /// For comparisons of elements with selectors.
    steps: Cell<Allowance>,
}

/// The key of rules that any element may have.
const ANY: &str = "*";

impl<'a> Rules<'a> {
    /// Parses style sheets [`without_comments`]; what cannot be read is left out.
    pub(super) fn parse(texts: &'a [String], steps: Allowance) -> Self {
        let (mut rules, mut blocks) = (Vec::new(), Vec::new());
        for (prelude, block) in texts.iter().flat_map(|text| blocks_of(text)) {
            let texts = prelude.split(',').map(str::trim);
            let selectors = texts.filter_map(|t| Some((key(t), Selector::parse(t)?)));
            rules.extend(selectors.map(|(key, selector)| (key, selector, blocks.len())));
            blocks.push(DeclarationTokenizer::from(block).collect());
        }
        rules.sort_by_cached_key(|(_, selector, _)| selector.specificity());
        let mut of_key: HashMap<String, Vec<usize>> = HashMap::new();
        for (k, (key, ..)) in rules.iter().enumerate() {
            of_key.entry(key.clone()).or_default().push(k);
        }
        Self {
            rules: rules.into_iter().map(|(_, s, block)| (s, block)).collect(),
            blocks,
            of_key,
            steps: Cell::new(steps),
        }
    }

    /// The declarations for an element, the least specific first.
    ///
    /// # Errors
    /// [`DataError`] where that takes more steps than a file of its length has.
    pub(super) fn of(&self, node: Node<'_, '_>) -> Result<Vec<&Declaration<'a>>, DataError> {
        if self.rules.is_empty() {
            return Ok(Vec::new());
        }
        let classes = node.attribute("class").unwrap_or_default().split(' ');
        let mut keys: BTreeSet<String> = classes.map(|class| format!(".{class}")).collect();
        keys.extend(node.attribute("id").map(|id| format!("#{id}")));
        keys.extend([node.tag_name().name().to_owned(), ANY.to_owned()]);
        let found = keys.iter().filter_map(|key| self.of_key.get(key));
        let mut found: Vec<usize> = found.flatten().copied().collect();
        found.sort_unstable();
        let mut declarations = Vec::new();
        let styled = Styled {
            node,
            steps: &self.steps,
        };
        for (selector, block) in found.into_iter().map(|rule| &self.rules[rule]) {
            if selector.matches(&styled) && styled.takes(self.blocks[*block].len()) {
                declarations.extend(&self.blocks[*block]);
            }
        }
        // Without a step left no further selector matches.
        let mut steps = self.steps.get();
        steps.spend(1, "the comparisons of elements with styles")?;
        self.steps.set(steps);
        Ok(declarations)
    }
}

/// The text of a style sheet, each comment of which becomes a blank.
pub(super) fn without_comments(text: &str) -> String {
    let (mut kept, mut rest) = (String::new(), text);
    while let Some((before, after)) = rest.split_once("/*") {
        kept.push_str(before);
        kept.push(' ');
        rest = after.split_once("*/").map_or("", |(_, after)| after);
    }
    kept + rest
}

/// The rules of a text: their selectors, and the declarations between braces. Rules that begin with `@` are
/// left out.
fn blocks_of(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let mut rest = text;
    std::iter::from_fn(move || {
        loop {
            rest = rest.trim_start();
            if !rest.starts_with('@') {
                let (selectors, after) = rest.split_once('{')?;
                let (block, after) = after.split_once('}').unwrap_or((after, ""));
                rest = after;
                return Some((selectors, block));
            }
            rest = after_at_rule(rest);
        }
    })
}

/// What follows a rule that begins with `@`: it ends with a semicolon, or with the brace that closes its
/// block.
fn after_at_rule(text: &str) -> &str {
    let mut depth = 0_usize;
    for (place, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 && [';', '}'].contains(&c) {
            return &text[place + 1..];
        }
    }
    ""
}

/// An identifier, a class or a name that each element has that a selector selects.
fn key(selector: &str) -> String {
    if selector.contains(['[', ':', '\\', '"', '\'']) {
        return ANY.to_owned();
    }
    let last = selector.rsplit(|c: char| c.is_whitespace() || ['>', '+', '~'].contains(&c));
    let last = last.into_iter().next().unwrap_or_default();
    let name = |text: &str| text.split(['.', '#']).next().unwrap_or_default().to_owned();
    if let Some((_, id)) = last.split_once('#') {
        return format!("#{}", name(id));
    }
    match last.split_once('.') {
        Some((_, class)) => format!(".{}", name(class)),
        None => last.to_owned(),
    }
}

/// An element as selectors see it, which has no more properties once all steps are taken.
struct Styled<'s, 'a, 'input> {
    node: Node<'a, 'input>,
    steps: &'s Cell<Allowance>,
}

impl Styled<'_, '_, '_> {
    /// Takes so many steps, if they are left.
    fn takes(&self, count: usize) -> bool {
        let mut steps = self.steps.get();
        let done = steps.spend(count, "").is_ok();
        self.steps.set(steps);
        done
    }

    fn before(&self) -> Option<Self> {
        let mut before = self.node.prev_siblings().skip(1);
        let node = before.find(|node| !self.takes(1) || node.is_element())?;
        node.is_element().then_some(Self { node, ..*self })
    }
}

impl Element for Styled<'_, '_, '_> {
    fn parent_element(&self) -> Option<Self> {
        let node = self.node.parent_element().filter(|_| self.takes(1))?;
        Some(Self { node, ..*self })
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.before()
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.takes(1) && self.node.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
        let value = self.node.attribute(name);
        let cost = self.node.attributes().len() + value.map_or(0, str::len);
        self.takes(cost) && value.is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.takes(1) && self.before().is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    #[test]
    fn the_most_specific_rule_is_the_last() {
        let text = "/* .b{x:0} */ @import 'a'; @media print { .b { x: 1 } } line.b#c, g > .b { x: 5 }
                    .b, line { x: 2 } g .d { x: 6 } #c { x: 4 } *{x:3} [y='1'] { x: 7 } .b:first-child { x: 8 } g + .b {x:9}";
        let texts = [without_comments(text)];
        let rules = Rules::parse(&texts, Allowance::of(0));
        let file = "<g><line class='a b' id='c' y='1'/></g>";
        let document = Document::parse(file).unwrap();
        let line = document.root_element().first_child().unwrap();
        let found = rules.of(line).unwrap();
        let values: Vec<&str> = found.iter().map(|d| d.value).collect();
        assert_eq!(values, ["3", "2", "2", "7", "5", "8", "4", "5"]);
    }

    /// A selector of many parts may match in as many ways as there are choices of elements around an element.
    #[test]
    fn comparisons_end() {
        let texts = [format!("x {} {{ stroke: red }}", "* ".repeat(30))];
        let depth = 60;
        let file = format!("{}{}", "<g>".repeat(depth), "</g>".repeat(depth));
        let document = Document::parse(&file).unwrap();
        let innermost = document.descendants().next_back().unwrap();
        let rules = Rules::parse(&texts, Allowance::of(file.len()));
        let error = rules.of(innermost).unwrap_err().to_string();
        let said =
            "the comparisons of elements with styles of the file would take more than 64 MiB";
        assert_eq!(error, said);
    }
}
