//! The layers of a flat-folded sheet as a drawing, drawn apart.

use super::{Layers, Recording};
use isosheet_mesh::Topology;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Width of the drawing, pixels, and the room around it.
const WIDTH: f64 = 640.0;
const ROOM: f64 = 24.0;

/// How the plane of the sheet is seen: what of the depth goes upward, and to the right.
const DEPTH: [f64; 2] = [0.45, 0.3];

/// The distance of two layers, beside the width of the folded sheet.
const APART: f64 = 0.28;

/// The colours of the front and the back, as the page of a run has them.
const SIDES: [&str; 2] = ["#faf0d6", "#78acd6"];

impl Layers {
    /// The layers of the last frame of a run as an SVG drawing: from below to above, each with its number,
    /// and the two sides of the sheet in two colours.
    pub fn drawing(&self, recording: &Recording) -> String {
        let last = recording.trajectory.len().saturating_sub(1);
        let x = recording.trajectory.frame(last).unwrap_or_default();
        self.drawn(recording.sheet.topology(), x)
    }

    /// Of faces at positions `x` (`3V`, metres).
    fn drawn(&self, topology: &Topology, x: &[f64]) -> String {
        let seen = self.seen(x);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let apart = APART * width(&seen);
        let place = |v: usize, level: usize| [seen[v][0], seen[v][1] + apart * level as f64];
        for (f, corners) in topology.faces().iter().enumerate() {
            for v in corners {
                let p = place(v.index(), self.levels[self.panels[f]]);
                for c in 0..2 {
                    (low[c], high[c]) = (low[c].min(p[c]), high[c].max(p[c]));
                }
            }
        }
        let scale = (WIDTH - 2.0 * ROOM) / (high[0] - low[0]).max(f64::MIN_POSITIVE);
        let height = (high[1] - low[1]) * scale + 2.0 * ROOM;
        let pixel = |[p, q]: [f64; 2]| {
            let (right, down) = (ROOM + (p - low[0]) * scale, ROOM + (high[1] - q) * scale);
            format!("{right:.1},{down:.1}")
        };
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {WIDTH} {height:.0}\" stroke-linejoin=\"round\" font-family=\"sans-serif\" font-size=\"13\">\n"
        );
        let mut by_level: Vec<usize> = (0..self.levels.len()).collect();
        by_level.sort_by_key(|panel| self.levels[*panel]);
        for panel in by_level {
            let level = self.levels[panel];
            let colour = SIDES[usize::from(!self.shows_front[panel])];
            let _ = writeln!(svg, "<g fill=\"{colour}\" stroke=\"{colour}\">");
            let own = (0..self.panels.len()).filter(|f| self.panels[*f] == panel);
            let own: Vec<usize> = own.collect();
            for &f in &own {
                let corners = topology.faces()[f].map(|v| pixel(place(v.index(), level)));
                let _ = writeln!(svg, "<polygon points=\"{}\"/>", corners.join(" "));
            }
            let _ = writeln!(svg, "</g>");
            for [a, b] in outline(topology, &own) {
                let [from, to] = [a, b].map(|v| pixel(place(v, level)));
                let _ = writeln!(
                    svg,
                    "<path d=\"M{from} L{to}\" stroke=\"#26221c\" fill=\"none\"/>"
                );
            }
            let corners = own.iter().flat_map(|f| topology.faces()[*f]);
            let corners: Vec<[f64; 2]> = corners.map(|v| place(v.index(), level)).collect();
            let count = corners.len() as f64;
            let middle = [0, 1].map(|c| corners.iter().map(|p| p[c]).sum::<f64>() / count);
            let middle = pixel(middle);
            if let Some((right, down)) = middle.split_once(',') {
                let number = level + 1;
                let _ = writeln!(
                    svg,
                    "<text x=\"{right}\" y=\"{down}\" text-anchor=\"middle\">{number}</text>"
                );
            }
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// The vertices as they are seen obliquely from above, without their heights.
    fn seen(&self, x: &[f64]) -> Vec<[f64; 2]> {
        let right = match self.up.cross(&Vector3::y()).norm() > 0.1 {
            true => Vector3::y().cross(&self.up).normalize(),
            false => Vector3::x(),
        };
        let deep = self.up.cross(&right);
        let points = x.as_chunks::<3>().0.iter().map(|p| Vector3::from(*p));
        let of_point = |p: Vector3<f64>| {
            let depth = deep.dot(&p);
            [right.dot(&p) + DEPTH[1] * depth, DEPTH[0] * depth]
        };
        points.map(of_point).collect()
    }
}

/// The extent to the right.
fn width(seen: &[[f64; 2]]) -> f64 {
    let low = seen.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let high = seen.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
    high - low
}

/// The edges that one of some faces alone has.
fn outline(topology: &Topology, faces: &[usize]) -> Vec<[usize; 2]> {
    let mut seen: BTreeMap<usize, usize> = BTreeMap::new();
    for f in faces {
        for e in topology.face_edges(isosheet_mesh::FaceId::from_index(*f)) {
            *seen.entry(e.index()).or_default() += 1;
        }
    }
    let once = seen.into_iter().filter(|(_, count)| *count == 1);
    once.map(|(e, _)| topology.edges()[e].map(|v| v.index()))
        .collect()
}
