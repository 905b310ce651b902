//! What unrolling found, in words.

use super::folds::Fold;
use crate::message::counted;
use isosheet_coords::{UnrollOptions, Unrolled};
use isosheet_drawings::Length;
use isosheet_formats::EdgeAssignment;
use isosheet_mesh::wording::{brief, given as digits};
use isosheet_mesh::{Opened, Sheet, VertexId};
use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;

/// Strains, and angle deficits in radians, below are round-off of coordinates with seven digits.
const ROUND_OFF: f64 = 1e-6;

/// What was read, cut and laid out.
pub(super) struct Report<'a> {
    pub(super) out: &'a Path,
    pub(super) opened: &'a Opened,
    pub(super) given: &'a Sheet,
    pub(super) unrolled: &'a Unrolled,
    pub(super) folds: &'a [Fold],
    /// How many rulings are drawn; `None` where none could be.
    pub(super) rulings: Option<usize>,
    pub(super) options: &'a UnrollOptions,
    /// Whether neither the file nor the command says how long its unit is.
    pub(super) unit_is_assumed: bool,
}

impl Report<'_> {
    /// A line for each step, and as the last one what was met.
    pub(super) fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.out.display(), self.sizes());
        let mut line = |name: &str, what: String| {
            let _ = writeln!(text, "{name:<10}{what}");
        };
        line("deficits", self.deficits());
        line("cuts", self.cuts());
        line("creases", self.creases());
        if let Some(count) = self.rulings.filter(|count| *count > 0) {
            line(
                "rulings",
                counted(count, "line, not to be cut", "lines, not to be cut"),
            );
        }
        for note in self.notes() {
            let _ = writeln!(text, "note: {note}");
        }
        let _ = writeln!(text, "unrolled: {}", self.verdict());
        text
    }

    /// The name of a vertex of the sheet, as its file numbers it.
    fn name(&self, v: VertexId) -> VertexId {
        VertexId(self.opened.origins[v.index()])
    }

    fn sizes(&self) -> String {
        let pieces = &self.unrolled.pieces;
        let faces = self.unrolled.flat.topology().face_count();
        let size = |sides: [f64; 2]| {
            let [w, h] = sides.map(|metres| Length { metres });
            format!("{w} by {h}")
        };
        let faces = counted(faces, "face", "faces");
        match &pieces[..] {
            [one] => format!("1 piece of {faces}, {}", size(one.sides)),
            several => {
                let area = |s: [f64; 2]| s[0] * s[1];
                let largest = several.iter().map(|p| p.sides);
                let largest = largest.fold([0.0; 2], |m, s| if area(s) > area(m) { s } else { m });
                let count = several.len();
                format!(
                    "{count} pieces of {faces} together, the largest one {}",
                    size(largest)
                )
            }
        }
    }

    fn deficits(&self) -> String {
        let own = self.unrolled.deficits.iter().enumerate();
        let count = own.clone().filter(|(_, d)| d.abs() > ROUND_OFF).count();
        let (v, most) = own.fold((0, 0.0_f64), |most, (v, d)| {
            if d.abs() > most.1.abs() {
                (v, *d)
            } else {
                most
            }
        });
        if count == 0 {
            return "none: the angles around each vertex inside are a whole turn".to_owned();
        }
        format!(
            "{}, the largest one {} degrees at {}",
            counted(count, "vertex inside has one", "vertices inside have one"),
            brief(most.to_degrees()),
            self.name(VertexId::from_index(v))
        )
    }

    fn cuts(&self) -> String {
        let cuts = &self.unrolled.cuts;
        if cuts.is_empty() {
            return "none".to_owned();
        }
        let lengths = cuts.iter().map(|e| self.given.lengths()[e.index()]);
        let metres = lengths.sum();
        let t = self.given.topology();
        let rim = self.unrolled.flat.topology();
        let reached: HashSet<VertexId> = rim
            .vertex_ids()
            .filter(|v| rim.is_boundary_vertex(*v))
            .map(|v| self.unrolled.vertices[v.index()])
            .filter(|v| !t.is_boundary_vertex(*v))
            .filter(|v| self.unrolled.deficits[v.index()].abs() > ROUND_OFF)
            .collect();
        let to = match reached.len() {
            0 => String::new(),
            n => format!(
                ", to {}",
                counted(n, "vertex with a deficit", "vertices with a deficit")
            ),
        };
        format!(
            "{}, {}{to}",
            counted(cuts.len(), "edge", "edges"),
            Length { metres }
        )
    }

    fn creases(&self) -> String {
        let own: Vec<&Fold> = self.folds.iter().filter(|f| f.is_crease).collect();
        if own.is_empty() {
            return "none".to_owned();
        }
        let count = |a: EdgeAssignment| own.iter().filter(|f| f.assignment == a).count();
        let mountains = count(EdgeAssignment::Mountain);
        let valleys = count(EdgeAssignment::Valley);
        let kinds = [
            (mountains, "mountain", "mountains"),
            (valleys, "valley", "valleys"),
            (
                own.len() - mountains - valleys,
                "of either side",
                "of either side",
            ),
        ];
        let kinds: Vec<String> = kinds
            .iter()
            .filter(|(n, ..)| *n > 0)
            .map(|(n, one, more)| counted(*n, one, more))
            .collect();
        let sizes = own.iter().filter(|f| f.angle.is_some()).map(|f| f.size());
        let [low, high] = sizes.fold([f64::INFINITY, 0.0_f64], |[low, high], s| {
            [low.min(s), high.max(s)]
        });
        let angles = match low <= high {
            true => {
                let [low, high] = [low, high].map(|a| brief(a.to_degrees()).to_string());
                let range = if low == high {
                    low
                } else {
                    format!("{low} to {high}")
                };
                format!(", folded by {range} degrees")
            }
            false => String::new(),
        };
        format!(
            "{}: {}{angles}",
            counted(own.len(), "edge", "edges"),
            kinds.join(", ")
        )
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let opened = self.opened;
        if self.unit_is_assumed {
            notes.push(
                "the file does not say how long its unit is, which is taken for a metre; if it is a millimetre, give `--unit mm`"
                    .to_owned(),
            );
        }
        if !opened.reversed.is_empty() {
            let faces = counted(opened.reversed.len(), "face was", "faces were");
            notes.push(format!("{faces} wound against the others, and turned over"));
        }
        if let Some([a, b]) = opened.seams.first() {
            notes.push(format!(
                "the surface is cut along {} where windings contradict each other or more than two faces meet, such as \
                 that between vertices {a} and {b}",
                counted(opened.seams.len(), "edge", "edges")
            ));
        }
        let soft = self.folds.iter().filter(|f| !f.is_crease && f.is_bent);
        let (count, most) = soft.fold((0, 0.0_f64), |(n, m), f| (n + 1, m.max(f.size())));
        if count > 0 {
            notes.push(format!(
                "{} less than {} degrees, by {} at most, and no crease: `--crease-angle` draws smaller ones",
                counted(count, "edge folds", "edges fold"),
                brief(self.options.crease.to_degrees()),
                brief(most.to_degrees())
            ));
        }
        let places: HashSet<[u64; 3]> = self
            .given
            .topology()
            .vertex_ids()
            .map(|v| self.given.position(v).map(|c| (c + 0.0).to_bits()))
            .collect();
        let twice = opened.origins.len() - places.len();
        if twice > 0 && opened.seams.is_empty() {
            notes.push(format!(
                "{} where another one is: `--weld 0` makes them one, and joins parts that touch",
                counted(twice, "vertex is", "vertices are")
            ));
        }
        notes
    }

    fn verdict(&self) -> String {
        let strain = self.unrolled.strain();
        let fits = "no triangles are turned over or lie on each other";
        if strain.abs() <= ROUND_OFF {
            let digits = brief(strain.abs().max(f64::EPSILON));
            return format!("all edges keep their lengths, to {digits} of them; {fits}");
        }
        let worst = self.unrolled.pieces.iter();
        let worst = worst.max_by(|a, b| a.strain.abs().total_cmp(&b.strain.abs()));
        let ends = worst.map_or([VertexId(0); 2], |piece| piece.ends);
        let [a, b] = ends.map(|v| self.name(v));
        format!(
            "not all edges keep their lengths: that between {a} and {b} has the strain {}, within the limit of {}; {fits}",
            brief(strain),
            digits(self.options.strain)
        )
    }
}
