//! Reading OFF files (Object File Format of Geomview).

use super::error::{Located, Location, cut_short, excerpt, unexpected};
use super::faces::Polyhedron;
use std::str::FromStr;

/// Reads the vertices and faces of an OFF file in text form.
///
/// Understood: the keyword `OFF`, which may be missing, stick to the counts or have the prefixes `ST`, `C`
/// and `N`; comments; one vertex and one face a line. What follows the coordinates of a vertex (normals,
/// colours) or the corners of a face (colours) on its line is skipped, and so is the number of edges.
pub(super) fn parse(bytes: &[u8]) -> Result<Polyhedron, Located> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = Lines::new(&text);
    let mut mesh = Polyhedron::default();
    let [vertices, faces] = counts(&mut lines)?;
    for k in 0..vertices {
        let mut line = lines.next(&format!("vertex {k} of {vertices}"))?;
        let mut p = [0.0; 3];
        for c in &mut p {
            *c = line.number("a coordinate")?;
        }
        let pushed = mesh.push_vertex(p);
        pushed.map_err(|problem| (Some(line.place), problem.into()))?;
    }
    for k in 0..faces {
        let mut line = lines.next(&format!("face {k} of {faces}"))?;
        let corners: usize = line.number("the number of corners of a face")?;
        let mut face = Vec::new();
        for _ in 0..corners {
            face.push(line.number("the index of a vertex")?);
        }
        mesh.push_face(face, line.place);
    }
    Ok(mesh)
}

/// The numbers of vertices and faces.
fn counts(lines: &mut Lines<'_>) -> Result<[usize; 2], Located> {
    let mut line = lines.next("the keyword OFF")?;
    if let Some(word) = line.words.first().copied() {
        let name = word.strip_prefix("ST").unwrap_or(word);
        let name = name.strip_prefix('C').unwrap_or(name);
        let name = name.strip_prefix('N').unwrap_or(name);
        match name.strip_prefix("OFF") {
            Some("") => line.next = 1,
            Some(count) if count.starts_with(|c: char| c.is_ascii_digit()) => {
                line.words[0] = count;
            }
            _ => {}
        }
    }
    if line.next == line.words.len() {
        line = lines.next("the numbers of vertices and faces")?;
    }
    let vertices = line.number("the keyword OFF or the number of vertices")?;
    Ok([vertices, line.number("the number of faces")?])
}

/// The lines with content.
struct Lines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
}

/// What is left of a line.
struct Line<'a> {
    place: Location,
    words: Vec<&'a str>,
    next: usize,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            lines: text.lines().enumerate(),
        }
    }

    /// The next line with content; `missing` names it.
    fn next(&mut self, missing: &str) -> Result<Line<'a>, Located> {
        for (k, line) in self.lines.by_ref() {
            let content = line.split('#').next().unwrap_or_default();
            let words: Vec<&str> = content.split_whitespace().collect();
            if !words.is_empty() {
                return Ok(Line {
                    place: Location::Line(k + 1),
                    words,
                    next: 0,
                });
            }
        }
        Err((None, cut_short(missing).into()))
    }
}

impl Line<'_> {
    /// The next word as a number; `expected` names it.
    fn number<T: FromStr>(&mut self, expected: &str) -> Result<T, Located> {
        let word = self.words.get(self.next).copied();
        self.next += 1;
        word.and_then(|w| w.parse().ok()).ok_or_else(|| {
            let found = excerpt(word.unwrap_or("the end of the line"));
            (Some(self.place), unexpected(expected, &found).into())
        })
    }
}
