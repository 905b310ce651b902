//! What came of the folding of a crease pattern, in words.

use super::fold_order::OPEN;
use super::passing::Passing;
use super::{FoldOrder, Recording, TouchingFaces, UnfoldableVertex};
use isosheet_mesh::wording::{counted, quoted};
use isosheet_mesh::{EdgeId, Topology, fold_angle};
use isosheet_scenes::{FoldResidual, FoldTargets, FollowedFolds, IsometryKey};
use std::fmt;

/// How closely creases and panels do what they are meant to, at the end of a run that folds a pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldVerdict {
    /// Differences of all creases.
    pub residual: FoldResidual,
    /// The number of creases that are further from their angles than [`FoldVerdict::OPEN`].
    pub open: usize,
    /// The one that is furthest.
    pub furthest: Option<FoldedCrease>,
    /// What touches the panels beside that one, if it is open.
    pub held_open: Option<TouchingFaces>,
    /// The number of panels, and of panels that bend by more than [`FoldVerdict::BENDS`] at an edge.
    pub panels: [usize; 2],
    /// Whether they can bend.
    pub is_elastic: bool,
    /// The largest strain of an edge at the end, and of all frames.
    pub strain: [f64; 2],
    /// The part of the folding that is done when panels first pass through each other, if they do.
    pub passing: Option<f64>,
    /// Vertices at which the pattern does not fold flat, if it is folded to the whole angles.
    pub unfoldable: Vec<UnfoldableVertex>,
    /// Whether groups of creases fold in the order that is asked for.
    pub order: FoldOrder,
}

/// A crease of a folded sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldedCrease {
    /// The vertices at its ends.
    pub ends: [u32; 2],
    /// The name of the line of the drawing that it follows, if it has one.
    pub name: Option<String>,
    /// Where its middle is in the rest shape, metres.
    pub middle: [f64; 2],
    /// Its fold angle, followed from the start on, degrees: beyond 180 its panels have turned through each
    /// other.
    pub angle: f64,
}

/// The name, if there is one, the vertices and the place.
impl fmt::Display for FoldedCrease {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([a, b], [x, y]) = (self.ends, self.middle);
        if let Some(name) = &self.name {
            write!(f, "in {} ", quoted(name))?;
        }
        write!(f, "between the vertices {a} and {b} at ({x:.3}, {y:.3}) m")
    }
}

impl FoldVerdict {
    /// A crease is open that is further from its angle, degrees.
    pub const OPEN: f64 = OPEN;
    /// A panel bends that is folded further at an edge inside, degrees.
    pub const BENDS: f64 = 5.0;

    /// Panels are said to stretch by more than that, percent: no paper does.
    pub const STRETCHES: f64 = 1.0;

    /// Of a run that has frames; `None` if its scene does not fold a pattern.
    pub fn of(recording: &Recording) -> Option<Self> {
        let last = recording.trajectory.len().checked_sub(1);
        let x = last.and_then(|k| recording.trajectory.frame(k));
        let (Some(targets), Some(x)) = (recording.targets.folding.as_ref(), x) else {
            return None;
        };
        let topology = recording.sheet.topology();
        let frames = (0..recording.trajectory.len()).filter_map(|k| recording.trajectory.frame(k));
        let strains = frames.map(|x| recording.model.max_strain(x));
        let strain = [recording.model.max_strain(x), strains.fold(0.0, f64::max)];
        let frame = |k: usize| recording.trajectory.frame(k).unwrap_or_default();
        let mut folds = FollowedFolds::begin(targets, topology, frame(0));
        let mut passing = Passing::begin(topology, frame(0));
        let scene = recording.scene.scene();
        let mut order = FoldOrder::begin(scene.folding.as_ref());
        let times = recording.trajectory.times();
        for (k, t) in times.iter().enumerate().skip(1) {
            folds.follow(targets, topology, frame(k));
            passing.follow(*t, frame(k));
            order.follow(targets, *t, &folds.off(targets));
        }
        let off: Vec<(f64, usize)> = folds.off(targets).into_iter().zip(0..).collect();
        let refine = scene.sheet[0].refine;
        // The parts of a crease follow one another.
        let creases = off.chunks(1 << refine);
        let creases = creases.filter_map(|parts| {
            let parts = parts.iter().copied();
            parts.max_by(|a, b| a.0.total_cmp(&b.0))
        });
        let creases: Vec<(f64, usize)> = creases.collect();
        let furthest = creases.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let panel = panels(topology, targets);
        let held_open = furthest.and_then(|&(off, k)| {
            let [a, b] = topology.edge_faces(targets.creases[k].0);
            let beside = [panel[a?.index()], panel[b?.index()]];
            let is_held = off > Self::OPEN && scene.contact.self_contact;
            let reach = scene.contact.activation.filter(|_| is_held)?;
            TouchingFaces::find(&recording.sheet, x, &panel, beside, reach)
        });
        let furthest = furthest.map(|&(_, k)| {
            let ends = topology.edges()[targets.creases[k].0.index()];
            let [p, q] = ends.map(|v| recording.sheet.position(v));
            FoldedCrease {
                ends: ends.map(|v| v.0),
                name: targets.name(k).map(str::to_owned),
                middle: [0, 1].map(|k| 0.5 * (p[k] + q[k])),
                angle: folds.angle(k),
            }
        });
        let mut bends = vec![false; panel.len()];
        for e in inside_panels(topology, targets) {
            if fold_angle(topology, x, e).unwrap_or(0.0).abs().to_degrees() > Self::BENDS {
                let face = topology.edge_faces(e)[0].map_or(0, |f| f.index());
                bends[panel[face]] = true;
            }
        }
        let count = (0..panel.len()).filter(|&f| panel[f] == f).count();
        Some(Self {
            residual: folds.residual(targets, topology, x),
            open: creases.iter().filter(|(off, _)| *off > Self::OPEN).count(),
            furthest,
            held_open,
            panels: [count, bends.iter().filter(|b| **b).count()],
            strain,
            is_elastic: scene.sheet[0].isometry() != IsometryKey::Rods,
            passing: passing.part_of(scene.folding.as_ref()),
            unfoldable: UnfoldableVertex::all(
                &recording.sheet,
                targets,
                recording.fold_assignments.as_deref(),
            ),
            order,
        })
    }

    /// Sentences, the most telling first: what the creases do, what the panels do, what stands against the
    /// folding. `rigid` is how far rigid panels close, where that was tried.
    pub fn in_words(&self, rigid: Option<&FoldResidual>) -> Vec<String> {
        let mut words = vec![self.creases_in_words(), self.panels_in_words(rigid)];
        if let [first, others @ ..] = &self.unfoldable[..] {
            let besides = match others.len() {
                0 => String::new(),
                more => format!("; and {} besides", counted(more, "vertex", "vertices")),
            };
            words.push(format!("The {first}{besides}."));
        }
        words.extend(self.order.in_words());
        words.extend(self.passing.map(|part| {
            let part = 100.0 * part;
            format!("Panels pass through each other from {part:.0} % of the folding on.")
        }));
        words
    }

    fn creases_in_words(&self) -> String {
        let end = 100.0 * self.strain[0];
        let FoldResidual { rms, largest, .. } = self.residual;
        let held = self.held_open.map(|touching| format!(", where {touching}"));
        let held = held.unwrap_or_default();
        let creases = match (self.open, &self.furthest) {
            (0, _) | (_, None) => {
                let only = match self.unfoldable.is_empty() {
                    _ if end > Self::STRETCHES => {
                        ", but only with stretched panels, which is no shape of paper"
                    }
                    false => ", but only as panels pass through each other, which no paper does",
                    _ => "",
                };
                let open = Self::OPEN;
                format!("every crease ends within {open} degrees of its angle{only}")
            }
            (open, Some(crease)) => format!(
                "{} open by more than {} degrees, most by {largest:.0}{} {crease}{held}",
                counted(open, "crease stays", "creases stay"),
                Self::OPEN,
                match crease.angle.abs() > 180.0 + Self::OPEN {
                    true => " (its panels have turned through each other)",
                    false => "",
                }
            ),
        };
        format!("{creases}, {rms:.1} degrees rms.")
    }

    fn panels_in_words(&self, rigid: Option<&FoldResidual>) -> String {
        let [panels, bent] = self.panels;
        let all = counted(panels, "panel", "panels");
        let panels = match (self.is_elastic, bent) {
            (false, 0) => format!("{all} stay rigid"),
            (false, bent) => {
                format!("{bent} of {all} bend at edges of the pattern that fold freely")
            }
            (true, 0) => format!(
                "None of {all} bends by more than {} degrees at an edge",
                Self::BENDS
            ),
            (true, bent) => format!("{bent} of {all} bend"),
        };
        let rigid = match (self.is_elastic, rigid) {
            (true, Some(r)) => format!(" (rigid panels do not close: {:.1} degrees rms)", r.rms),
            (true, None) => " (rigid panels do not close)".to_owned(),
            (false, _) => String::new(),
        };
        let [end, largest] = self.strain.map(|s| 100.0 * s);
        let stretch = match largest > Self::STRETCHES {
            true => format!(
                ", and they stretch by {largest:.0} % on the way and by {end:.1} % at the end"
            ),
            false => String::new(),
        };
        format!("{panels}{rigid}{stretch}.")
    }
}

/// The edges inside of panels: all edges but the creases.
fn inside_panels(topology: &Topology, targets: &FoldTargets) -> impl Iterator<Item = EdgeId> {
    let mut is_crease = vec![false; topology.edge_count()];
    for (e, _) in &targets.creases {
        is_crease[e.index()] = true;
    }
    let edges = topology.edge_ids();
    edges.filter(move |e| !is_crease[e.index()] && !topology.is_boundary_edge(*e))
}

/// Of each face the number of the face that stands for its panel. Panels are what is left when the sheet is
/// cut along its creases.
pub(super) fn panels(topology: &Topology, targets: &FoldTargets) -> Vec<usize> {
    let mut panel: Vec<usize> = (0..topology.face_count()).collect();
    for e in inside_panels(topology, targets) {
        if let [Some(a), Some(b)] = topology.edge_faces(e) {
            let [a, b] = [a, b].map(|f| root(&mut panel, f.index()));
            panel[a] = b;
        }
    }
    (0..panel.len()).map(|f| root(&mut panel, f)).collect()
}

/// The representative of a set, with the path to it halved.
fn root(parent: &mut [usize], mut v: usize) -> usize {
    while parent[v] != v {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    v
}
