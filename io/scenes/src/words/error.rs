//! Errors of a scene, shown at their place in its text.

use crate::words::edit::has_one_entry;
use crate::words::key::{Key, KeyPart};
use crate::words::problem::Problem;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use isosheet_mesh::Advice;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;
use toml_edit::{Document, Item};

/// The text of a scene, with the name under which messages show it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneText {
    /// The file.
    pub path: PathBuf,
    /// What is in it, edits included.
    pub text: String,
    /// The edits, `key=value`.
    pub edits: Vec<String>,
}

impl SceneText {
    /// The name of the file, with the edits: the file itself may have no such line.
    fn name(&self) -> String {
        let path = self.path.to_string_lossy();
        match self.edits.is_empty() {
            true => path.into_owned(),
            false => format!("{path} with {}", self.edits.join(", ")),
        }
    }

    /// The bytes of the value at a key, or of the nearest key above it that the text has; of a value on
    /// several lines the first line.
    fn locate(&self, key: &Key) -> Range<usize> {
        let Ok(document) = Document::parse(self.text.as_str()) else {
            return 0..0;
        };
        let (mut item, mut span) = (document.as_item(), 0..0);
        for part in key.parts() {
            if matches!(part, KeyPart::Name(_)) && has_one_entry(item) {
                item = &item[0];
            }
            let next: Option<&Item> = match part {
                KeyPart::Name(name) => item.get(name.as_str()),
                KeyPart::Entry(number) => item.get(*number),
            };
            let Some(next) = next else {
                break;
            };
            item = next;
            span = item.span().unwrap_or(span);
        }
        self.first_line(span)
    }

    fn first_line(&self, span: Range<usize>) -> Range<usize> {
        let Range { start, end } = span;
        match self.text.get(start..end).and_then(|text| text.find('\n')) {
            Some(length) => start..start + length,
            None => start..end,
        }
    }

    fn span_of(&self, problem: &Problem) -> Range<usize> {
        match &problem.span {
            Some(span) => self.first_line(span.clone()),
            None => self.locate(&problem.key),
        }
    }

    /// Line and column of a byte, from 1.
    fn line_and_column(&self, byte: usize) -> [usize; 2] {
        let before = self.text.get(..byte).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |l| l.chars().count()) + 1;
        [line, column]
    }
}

/// Most problems that are shown at once.
const MOST_PROBLEMS: usize = 50;

/// Most problems that are shown of the entries of one list: they tend to have one cause.
const MOST_OF_LIST: usize = 3;

/// The problems without most of the entries of one list, whose number is told instead.
fn first_of_lists(problems: Vec<Problem>) -> Vec<Problem> {
    // Of each list, or key of its entries, which one was the last that is shown, and how many are not.
    let mut lists: BTreeMap<String, (usize, usize, usize)> = BTreeMap::new();
    let mut shown: Vec<Problem> = Vec::new();
    for problem in problems {
        let Some(list) = problem.key.of_entries() else {
            shown.push(problem);
            continue;
        };
        let (count, last, hidden) = lists.entry(list).or_default();
        if *count == MOST_OF_LIST {
            *hidden += 1;
            continue;
        }
        *count += 1;
        *last = shown.len();
        shown.push(problem);
    }
    let mut hidden: Vec<(usize, usize)> = lists
        .into_values()
        .filter_map(|(_, last, hidden)| (hidden > 0).then_some((last, hidden)))
        .collect();
    hidden.sort_unstable();
    for (last, hidden) in hidden.into_iter().rev() {
        let list = shown[last].key.list();
        let message = format!(
            "`{list}` has {} more such {}",
            hidden,
            if hidden == 1 { "problem" } else { "problems" }
        );
        let more = Problem::new(list, message, "correct those above first");
        shown.insert(last + 1, more);
    }
    shown
}

/// A problem with its place, as a value for programs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PlacedProblem {
    /// The file, if the scene is one.
    pub file: Option<PathBuf>,
    /// The line, from 1.
    pub line: Option<usize>,
    /// The column, from 1.
    pub column: Option<usize>,
    /// The key.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub remedy: Option<String>,
}

/// Whether messages are coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageStyle {
    /// For files and pipes.
    Plain,
    /// For terminals.
    Terminal,
}

/// One or more problems of a scene. Shown with file, line, marker and remedy where the scene is a text, and
/// with the key otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    problems: Vec<Problem>,
    text: Option<Box<SceneText>>,
}

impl SceneError {
    /// The error of some problems, if there are any.
    pub(crate) fn of(problems: Vec<Problem>) -> Result<(), Self> {
        if problems.is_empty() {
            return Ok(());
        }
        let mut problems = first_of_lists(problems);
        if let Some(more) = problems.len().checked_sub(MOST_PROBLEMS).filter(|&n| n > 0) {
            problems.truncate(MOST_PROBLEMS);
            let message = format!("{more} further problems are not shown");
            problems.push(Problem::new(
                Key::root(),
                message,
                "correct those above first",
            ));
        }
        let text = None;
        Err(Self { problems, text })
    }

    /// The problems, at least one.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// The error, shown at its place in a text.
    #[must_use]
    pub fn in_text(mut self, text: &SceneText) -> Self {
        self.text = Some(Box::new(text.clone()));
        self
    }

    /// The problems with their places.
    pub fn placed(&self) -> Vec<PlacedProblem> {
        let place = |problem: &Problem| {
            let text = self.text.as_ref();
            let start = text.map(|t| t.line_and_column(t.span_of(problem).start));
            PlacedProblem {
                file: text.map(|t| t.path.clone()),
                line: start.map(|[line, _]| line),
                column: start.map(|[_, column]| column),
                key: problem.key.to_string(),
                message: problem.message.clone(),
                remedy: problem.remedy.clone(),
            }
        };
        self.problems.iter().map(place).collect()
    }

    /// The message.
    pub fn render(&self, colours: MessageStyle) -> String {
        let Some(whole) = &self.text else {
            let lines: Vec<String> = self.problems.iter().map(without_place).collect();
            return lines.join("\n");
        };
        let renderer = match colours {
            MessageStyle::Plain => Renderer::plain(),
            MessageStyle::Terminal => Renderer::styled(),
        };
        let name = whole.name();
        let mut shown = Vec::new();
        for problem in &self.problems {
            let span = whole.span_of(problem);
            shown.push(renderer.render(&[group(problem, &name, &whole.text, span)]));
        }
        shown.join("\n\n")
    }
}

/// A problem of a scene that is no text.
fn without_place(problem: &Problem) -> String {
    match &problem.remedy {
        Some(remedy) => format!("{problem}\n  = help: {remedy}"),
        None => problem.to_string(),
    }
}

fn group<'a>(problem: &'a Problem, name: &str, text: &'a str, span: Range<usize>) -> Group<'a> {
    let marker = AnnotationKind::Primary.span(span);
    let snippet = Snippet::source(text)
        .path(without_colours(name))
        .annotation(marker);
    let group = Level::ERROR
        .primary_title(without_colours(&problem.message))
        .element(snippet);
    match &problem.remedy {
        Some(remedy) => group.element(Level::HELP.message(without_colours(remedy))),
        None => group,
    }
}

/// A text whose escape characters are shown, so that all escape characters of a rendered message are its own.
/// The source is rendered without them.
fn without_colours(text: &str) -> String {
    text.replace('\u{1b}', "\\u001b")
}

impl From<Problem> for SceneError {
    fn from(problem: Problem) -> Self {
        Self {
            problems: vec![problem],
            text: None,
        }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(MessageStyle::Plain))
    }
}

impl std::error::Error for SceneError {}

impl Advice for SceneError {
    /// Always `None`: each problem has its own [remedy](Problem::remedy), which the text shows below it.
    fn advice(&self) -> Option<&'static str> {
        None
    }
}
