//! Crease patterns of ORIPA as XML (`.opx`): what Java writes of its objects.

use super::{Segment, cp};
use isosheet_files::xml::Entities;
use isosheet_files::{DataError, xml};
use roxmltree::Node;

/// The lines of the drawing, in which y points downwards.
///
/// A line is an object of the class `OriLineProxy`, whose `type` is as in CP files. Coordinates of 0 are left
/// out.
pub(crate) fn parse(bytes: &[u8]) -> Result<Vec<Segment>, DataError> {
    let text = String::from_utf8_lossy(bytes);
    let document = xml::parse(text.trim_start_matches('\u{feff}'), Entities::Refused);
    let document =
        document.map_err(|e| DataError::new(e.to_string(), "copy or export it again"))?;
    let is_line = |node: &Node<'_, '_>| {
        let class = node.attribute("class").unwrap_or_default();
        node.has_tag_name("object") && class.ends_with("OriLineProxy")
    };
    let lines = document.descendants().filter(is_line).enumerate();
    lines.map(|(k, line)| segment(k, line)).collect()
}

fn segment(number: usize, line: Node<'_, '_>) -> Result<Segment, DataError> {
    let property = |name: &str| {
        let found = line
            .children()
            .find(|n| n.attribute("property") == Some(name))?;
        found
            .children()
            .find(Node::is_element)?
            .text()
            .map(str::trim)
    };
    let wrong = |name: &str, found: &str| {
        let found: String = found.chars().take(30).collect();
        let message = format!("line {number}, counted from 0, has the {name} {found:?}");
        DataError::new(message, "correct the file or export it again").at(number)
    };
    let coordinate = |name: &str| {
        let text = property(name).unwrap_or("0");
        let number = text.parse().ok().filter(|c: &f64| c.is_finite());
        number.ok_or_else(|| wrong(name, text))
    };
    let kind = property("type").unwrap_or("0");
    Ok(Segment {
        ends: [
            [coordinate("x0")?, -coordinate("y0")?],
            [coordinate("x1")?, -coordinate("y1")?],
        ],
        assignment: cp::assignment(kind).ok_or_else(|| wrong("type", kind))?,
        angle: None,
        drawn: None,
    })
}
