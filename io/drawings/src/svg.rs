//! Scalable Vector Graphics.
//!
//! Shapes are read as curves with all digits: arcs stay arcs. (Crates that render drawings have coordinates
//! of 32 bits, arcs of Bezier curves and no layers.)

mod matrix;
mod page;
mod path;
mod shapes;
mod style;
mod style_sheet;
mod writer;

pub(crate) use writer::text;

use super::colour::Colour;
use super::lines::{Drawing, DrawnLine, Pen};
use super::unit::DrawingUnit;
use isosheet_files::xml::Entities;
use isosheet_files::{Allowance, DataError, xml};
use isosheet_mesh::plane::PlaneCurve;
use matrix::{Matrix, compose, scaling, translation};
use page::{Along, Viewport, content, page_size};
use roxmltree::{Document, Node};
use std::collections::HashMap;
use style::{Ink, Style};
use style_sheet::{Rules, without_comments};

/// Groups in groups, and elements that use others, are followed so deep.
const DEEPEST: usize = 200;

const EXPORT: &str = "export it again as plain SVG";

/// What becomes of shapes that have no stroke, whether they are filled or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Areas {
    /// What bounds a filled area is a line of its colour.
    Outlined,
    /// They are left out.
    LeftOut,
}

/// Reads the shapes of a drawing, `scale` times as large, by the unit of the file unless another is given.
/// Its y axis points upwards, from the lower edge of the page.
///
/// # Errors
/// [`DataError`] for a text that is no SVG, or asks for more than a file of its length may.
pub fn parse(
    bytes: &[u8],
    areas: Areas,
    unit: Option<DrawingUnit>,
    scale: f64,
) -> Result<Drawing, DataError> {
    let text = std::str::from_utf8(bytes)
        .map_err(|e| DataError::new(format!("byte {} is not UTF-8", e.valid_up_to()), EXPORT))?;
    let document =
        xml::parse(text, Entities::Expanded).map_err(|e| DataError::new(e.to_string(), EXPORT))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let found = root.tag_name().name();
        let message = format!("its root is <{found}>, and not <svg>");
        return Err(DataError::new(message, EXPORT));
    }
    let allowance = Allowance::of(bytes.len());
    let styles = document
        .descendants()
        .filter(|n| n.tag_name().name() == "style");
    let texts = styles.flat_map(|n| n.children()).filter_map(|n| n.text());
    let texts: Vec<String> = texts.map(without_comments).collect();
    let rules = Rules::parse(&texts, allowance);
    let mut drawing = Drawing::default();
    let (size, is_absolute) = page_size(root).map_err(|e| wrong(root, &e))?;
    let of_page = |size| content(root, size).map_err(|e| wrong(root, &e));
    let (length, size) = match unit {
        // A unit of the drawing is known, whatever the page says.
        Some(unit) => {
            let ([[own, _], ..], viewport) = of_page(size)?;
            let own = own * DrawingUnit::Pixel.metres(1.0) / unit.metres(1.0);
            drawing.by_own_unit = is_absolute.then_some(own);
            (unit, viewport.size)
        }
        None => (DrawingUnit::Pixel, size),
    };
    let (place, viewport) = of_page(size)?;
    if unit.is_none() && !is_absolute {
        drawing.assumed_unit = Some("1 px is 1/96 in");
    }
    let metres = length.metres(scale);
    let upright = compose(scaling(metres, -metres), translation(0.0, -size[1]));
    let style = Style::initial().of(root, &rules)?;
    let mut reader = Reader {
        named: named(&document),
        rules,
        drawing,
        areas,
        memory: allowance.half(),
        steps: allowance,
    };
    let state = State {
        matrix: compose(upright, place),
        viewport,
        style,
        layers: Vec::new(),
        depth: 0,
        memory_of_curve: MEMORY_OF_CURVE,
    };
    for child in root.children() {
        reader.element(child, &state)?;
    }
    Ok(reader.drawing)
}

/// The error of an element.
fn wrong(node: Node<'_, '_>, problem: &str) -> DataError {
    let line = node.document().text_pos_at(node.range().start).row;
    let name = node.tag_name().name();
    DataError::new(format!("line {line}: <{name}>: {problem}"), EXPORT).at(line as usize)
}

/// The elements by their identifiers, the first of each.
fn named<'a, 'input>(document: &'a Document<'input>) -> HashMap<&'a str, Node<'a, 'input>> {
    let mut named = HashMap::new();
    for node in document.descendants() {
        if let Some(id) = node.attribute("id") {
            named.entry(id).or_insert(node);
        }
    }
    named
}

struct Reader<'a, 'input> {
    named: HashMap<&'a str, Node<'a, 'input>>,
    rules: Rules<'a>,
    drawing: Drawing,
    areas: Areas,
    /// For lines and pens.
    memory: Allowance,
    /// For elements with their attributes and the names around them, each time that they are drawn.
    steps: Allowance,
}

/// What an element takes over from the elements around it.
#[derive(Clone)]
struct State {
    matrix: Matrix,
    viewport: Viewport,
    style: Style,
    /// The outermost first.
    layers: Vec<String>,
    depth: usize,
    /// The bytes for a curve.
    memory_of_curve: usize,
}

impl Reader<'_, '_> {
    fn element(&mut self, node: Node<'_, '_>, around: &State) -> Result<(), DataError> {
        if !node.is_element() {
            return Ok(());
        }
        if around.depth > DEEPEST {
            let message = "elements are nested or used too often";
            return Err(DataError::new(message, EXPORT));
        }
        // Elements that use each other can ask for any number of them.
        let names_around: usize = around.layers.iter().map(|name| memory_of_name(name)).sum();
        let attributes: usize = node.attributes().map(|a| a.value().len()).sum();
        let cost = size_of::<State>() + names_around + attributes;
        self.steps.spend(cost, "the elements")?;
        let name = node.tag_name().name();
        let style = around.style.of(node, &self.rules)?;
        if !style.shown {
            self.drawing.leave_out("hidden element");
            return Ok(());
        }
        let mut state = State {
            style,
            depth: around.depth + 1,
            ..around.clone()
        };
        if let Some(text) = &state.style.transform {
            let Some(matrix) = matrix::parse(text) else {
                return Err(wrong(node, &format!("{text:?} is no transform")));
            };
            let origin = state.style.transform_origin.as_deref().unwrap_or("0 0");
            let Some(matrix) = matrix::about(origin, matrix) else {
                let problem =
                    format!("the transform is about {origin:?}, which is no point of two numbers");
                return Err(wrong(node, &problem));
            };
            state.matrix = compose(state.matrix, matrix);
        }
        state.layers.extend(names(node));
        match name {
            "g" | "a" => self.children(node, &state),
            // The first that asks for no extension. (Illustrator has its own data before the drawing.)
            "switch" => match node
                .children()
                .find(|child| child.is_element() && child.attribute("requiredExtensions").is_none())
            {
                Some(first) => self.element(first, &state),
                None => Ok(()),
            },
            "svg" => self.nested(node, node, state),
            "use" => self.used(node, state),
            "text" => {
                self.drawing.leave_out("text");
                Ok(())
            }
            "image" | "foreignObject" => {
                self.drawing.leave_out("image");
                Ok(())
            }
            _ => {
                let left = self.memory.left() / state.memory_of_curve;
                let paths = shapes::paths(node, state.viewport, left);
                match paths.map_err(|e| wrong(node, &e))? {
                    Some(paths) => self.shape(node, paths, &state),
                    None => Ok(()),
                }
            }
        }
    }

    fn children(&mut self, node: Node<'_, '_>, state: &State) -> Result<(), DataError> {
        node.children()
            .try_for_each(|child| self.element(child, state))
    }

    /// Draws what is in an element with a viewport of its own, whose size `sized` says where it has one, and
    /// otherwise the element itself.
    fn nested(
        &mut self,
        node: Node<'_, '_>,
        sized: Node<'_, '_>,
        mut state: State,
    ) -> Result<(), DataError> {
        let outer = state.viewport;
        let get = |of: Node<'_, '_>, name, along| {
            let found = outer.attribute(of, name, along);
            found.map_err(|e| wrong(of, &e))
        };
        let side = |name, along, all: f64| {
            let own = get(node, name, along)?.unwrap_or(all);
            Ok::<_, DataError>(get(sized, name, along)?.unwrap_or(own))
        };
        let [w, h] = outer.size;
        let size = [side("width", Along::X, w)?, side("height", Along::Y, h)?];
        let at = [get(node, "x", Along::X)?, get(node, "y", Along::Y)?];
        let [x, y] = at.map(|c| c.unwrap_or(0.0));
        let (place, viewport) = content(node, size).map_err(|e| wrong(node, &e))?;
        state.matrix = compose(state.matrix, compose(translation(x, y), place));
        state.viewport = viewport;
        self.children(node, &state)
    }

    /// Draws the element that another one uses.
    fn used(&mut self, node: Node<'_, '_>, mut state: State) -> Result<(), DataError> {
        let link = node.attributes().find(|a| a.name() == "href");
        let id = link.and_then(|a| a.value().strip_prefix('#'));
        let Some(target) = id.and_then(|id| self.named.get(id).copied()) else {
            self.drawing.leave_out("use of what is not in the file");
            return Ok(());
        };
        let get = |name, along| {
            let found = state.viewport.attribute(node, name, along);
            found.map_err(|e| wrong(node, &e))
        };
        let [x, y] = [get("x", Along::X)?, get("y", Along::Y)?].map(|c| c.unwrap_or(0.0));
        state.matrix = compose(state.matrix, translation(x, y));
        state.memory_of_curve = MEMORY_OF_USED_CURVE;
        match target.tag_name().name() {
            "symbol" | "svg" => {
                state.style = state.style.of(target, &self.rules)?;
                state.layers.extend(names(target));
                self.nested(target, node, state)
            }
            _ => self.element(target, &state),
        }
    }

    fn shape(
        &mut self,
        node: Node<'_, '_>,
        paths: Vec<Vec<PlaneCurve>>,
        state: &State,
    ) -> Result<(), DataError> {
        let style = &state.style;
        let is_area = node.tag_name().name() != "line";
        let (ink, opacity) = match (&style.stroke, self.areas) {
            (Ink::Nothing, Areas::LeftOut) => {
                self.drawing.leave_out("shape without a stroke");
                return Ok(());
            }
            (Ink::Nothing, Areas::Outlined) if is_area => (&style.fill, style.fill_opacity),
            (stroke, _) => (stroke, style.stroke_opacity),
        };
        let opacity = opacity * style.group_opacity;
        let pen = match ink {
            Ink::Unknown(text) if style.visible => {
                let what = format!("shape of the colour {text:?}, which is not understood");
                self.drawing.leave_out(what);
                return Ok(());
            }
            Ink::Paint { colour, alpha } if style.visible && alpha * opacity > 0.0 => {
                pen(*colour, alpha * opacity, state)
            }
            _ => {
                self.drawing.leave_out("invisible shape");
                return Ok(());
            }
        };
        if node.attribute("clip-path").is_some() {
            self.drawing.leave_out("clipping of a shape");
        }
        let curves: usize = paths.iter().map(Vec::len).sum();
        let of_pen = size_of::<Pen>()
            + pen
                .layers
                .iter()
                .map(|name| memory_of_name(name))
                .sum::<usize>();
        let cost = curves * state.memory_of_curve + paths.len() * of_pen;
        self.memory.spend(cost, "the lines")?;
        for path in paths {
            let curves = path.iter().map(|c| c.transformed(state.matrix));
            self.drawing.push(pen.clone(), curves);
        }
        Ok(())
    }
}

/// The bytes for a curve, as it is read and as it is drawn.
const MEMORY_OF_CURVE: usize = size_of::<DrawnLine>() + size_of::<PlaneCurve>();

/// The bytes for a curve of an element that is used, for which the file has no text: as many as it takes
/// until it is a part of a mesh, with its chords, their boxes and its pieces.
const MEMORY_OF_USED_CURVE: usize = 4 * MEMORY_OF_CURVE;

fn memory_of_name(name: &str) -> usize {
    size_of::<String>() + name.len()
}

fn pen(colour: Colour, opacity: f64, state: &State) -> Pen {
    Pen {
        colour,
        dashed: state.style.dashed,
        opacity,
        layers: state.layers.iter().rev().cloned().collect(),
    }
}

/// The names of an element as drawing programs write them, and its identifier: Inkscape has labels of layers,
/// Illustrator has names, and identifiers in which other characters than letters are written as `_x20_`. The
/// last of them is the one that people see.
fn names(node: Node<'_, '_>) -> Vec<String> {
    let of = |name: &'static str| node.attributes().filter(move |a| a.name() == name);
    let identifiers = of("id").chain(of("class"));
    let mut names: Vec<String> = identifiers
        .map(|a| a.value().replace("_x20_", " "))
        .collect();
    let labels = of("data-name").chain(of("label"));
    names.extend(labels.map(|a| a.value().to_owned()));
    names.dedup();
    names
}
