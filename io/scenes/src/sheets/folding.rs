//! Folding to the angles of a FOLD file.

use crate::Mesh;
use crate::meshes::foreign;
use crate::meshes::mesh_file::{Files, MeshFileKey};
use crate::sheets::fold_group::{FoldGroup, PatternCrease};
use crate::sheets::refined::Refined;
use crate::sheets::sheet::{IsometryKey, SheetKey};
use crate::time::profile::{Change, Course, ProfileKey};
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_drawings::DrawnLines;
use isosheet_dynamics::{CreaseSpring, FLAT, RestAngle};
use isosheet_formats::{EdgeAssignment, FoldFrame};
use isosheet_mesh::{EdgeId, Sheet, Topology, VertexId, angle_near, fold_angle};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::sync::Arc;

/// Folding to the angles of the crease pattern that is the mesh of the sheet: a FOLD, SVG, CP or OPX file, or
/// a drawing with mountains and valleys.
///
/// A torsion spring at each crease drives it from the angle that it has at the start (before a perturbation)
/// to its target. A stiffer spring at each edge inside of a panel of rods keeps the panel flat, or makes it
/// flat. Panels of an elastic sheet bend as its material does, where `sheet.refine` divides them finely
/// enough. Angles that no such shape has are approached as far as the springs come to an equilibrium: the
/// summary of the run says how large the differences are at the end.
///
/// Mountains and valleys are driven to the angles that the file gives them (`edges_foldAngle` of FOLD files,
/// the opacity of lines of SVG files), and where it gives none to 180 degrees; edges of the kinds `F` and `J`
/// and the cuts of polygons stay flat; `U`, and `B` inside the sheet, are driven where their angle is not 0
/// and move freely elsewhere.
///
/// ```toml
/// [sheet]
/// mesh = { file = { path = "crane.fold" } }
///
/// [folding]
/// stiffness = 0.05
/// time = 2
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Folding {
    /// The name of the sheet, if there are several.
    #[serde(default)]
    pub sheet: Option<String>,
    /// When the angles of the springs have reached their targets, seconds. They begin at the fold angles of
    /// the start and change smoothly.
    pub time: f64,
    /// Torsional stiffness of a metre of crease, N (newton metres per radian and metre).
    pub stiffness: f64,
    /// Torsional stiffness of a metre of the edges that stay flat, N. By default 50 times the stiffness of
    /// the creases in a sheet of rods, and no such springs in an elastic sheet, since its bending stiffness
    /// keeps panels flat.
    #[serde(default)]
    pub flat_stiffness: Option<f64>,
    /// Which part of their angles the springs are at, from 0 to 1, as a function of time. If left out, they
    /// go smoothly from the angles of the start to the whole ones within `time`. Not beside an `order`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[unit(Factor)]
    pub course: Option<ProfileKey>,
    /// Which part of its angle each crease is driven to, from -1 to 1. Angles of 180 degrees lay panels on
    /// each other, which cross without self-contact: take less than 1.
    #[serde(default = "whole")]
    pub part: f64,
    /// The frame of the file that has the angles, by its number from 0 or by its title; if left out, the
    /// frame that is the mesh of the sheet. If its vertices are not in a plane, the creases are driven to the
    /// angles that they have there, and otherwise to its `edges_foldAngle`.
    #[serde(default)]
    #[schemars(with = "Option<foreign::FoldFrame>")]
    pub frame: Option<FoldFrame>,
    /// Groups of creases that fold one after the other, each in an equal part of `time`. Creases of no group
    /// fold with the last one. If left out, all fold at the same time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub order: Vec<FoldGroup>,
}

fn whole() -> f64 {
    1.0
}

/// Stiffness of the edges that stay flat beside that of the creases, if the scene does not say it: the
/// creases of a panel together turn one of its flat edges by a few degrees at most.
pub(crate) const FLAT_STIFFNESS: f64 = 50.0;

/// Where the edges of a sheet are driven.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FoldTargets {
    /// The driven creases with their fold angles at the end, radians, positive for a valley.
    pub creases: Vec<(EdgeId, f64)>,
    /// Of each of them the number of the group that it folds with.
    pub groups: Vec<usize>,
    /// What each of them is in the pattern.
    of_pattern: Vec<PatternCrease>,
    /// The lines of the drawing that the pattern is made of.
    drawn: DrawnLines,
    /// The edges that stay flat.
    pub flat: Vec<EdgeId>,
}

/// How far the fold angles of a shape are from their targets, degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FoldResidual {
    /// Number of driven creases.
    pub creases: usize,
    /// Largest difference at a driven crease.
    pub largest: f64,
    /// Root of the mean square of the differences at the driven creases.
    pub rms: f64,
    /// Largest fold angle of an edge that should stay flat.
    pub largest_flat: f64,
    /// Number of driven creases that are folded to the other side: further from their angles than a flat
    /// sheet is.
    pub wrong_side: usize,
}

impl FoldTargets {
    /// Gives the edges other numbers.
    pub(crate) fn renumber(&mut self, number: impl Fn(EdgeId) -> EdgeId) {
        self.creases.iter_mut().for_each(|(e, _)| *e = number(*e));
        self.flat.iter_mut().for_each(|e| *e = number(*e));
    }

    /// The numbers of the driven creases that a group has.
    pub(crate) fn of_group(&self, group: &FoldGroup) -> Vec<usize> {
        let creases = self.of_pattern.iter().enumerate();
        let own = creases.filter(|(_, crease)| group.has(crease, &self.drawn));
        own.map(|(k, _)| k).collect()
    }

    /// The lines of the drawing that the pattern is made of.
    pub(crate) fn drawn(&self) -> &DrawnLines {
        &self.drawn
    }

    /// The name of the line of the drawing that a driven crease follows, if it has one.
    pub fn name(&self, crease: usize) -> Option<&str> {
        self.drawn.name(self.of_pattern[crease].drawn)
    }

    /// The differences at positions `x` (`3V`, metres), taken the short way round as the springs do. (A run
    /// follows angles from its start on: one that was folded the other way round is further from its target.)
    ///
    /// # Panics
    /// If `x` is not of length `3V`.
    pub fn residual(&self, t: &Topology, x: &[f64]) -> FoldResidual {
        let difference = |e: EdgeId, target: f64| off_target(t, x, e, target);
        let mut residual = FoldResidual {
            creases: self.creases.len(),
            ..FoldResidual::default()
        };
        let mut squares = 0.0;
        for &(e, target) in &self.creases {
            let d = difference(e, target);
            residual.largest = residual.largest.max(d);
            squares += d * d;
            let angle = fold_angle(t, x, e).unwrap_or(0.0);
            // A crease that is folded by nearly 180 degrees may have passed them.
            let is_other = angle.sin() * target < -FLAT * target.abs();
            residual.wrong_side += usize::from(is_other && d > target.abs().to_degrees());
        }
        residual.rms = (squares / self.creases.len().max(1) as f64).sqrt();
        for &e in &self.flat {
            residual.largest_flat = residual.largest_flat.max(difference(e, 0.0));
        }
        residual
    }
}

/// The fold angles of driven creases, followed through a motion: one that was folded the other way round is
/// at -180 degrees, and not at 180.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FollowedFolds {
    /// Radians, in the order of the creases.
    angles: Vec<f64>,
}

impl FollowedFolds {
    /// Where the motion begins, at positions `x` (`3V`, metres).
    pub fn begin(targets: &FoldTargets, t: &Topology, x: &[f64]) -> Self {
        let creases = targets.creases.iter();
        let angles = creases.map(|&(e, _)| fold_angle(t, x, e).unwrap_or(0.0));
        Self {
            angles: angles.collect(),
        }
    }

    /// At the next positions, where no angle has changed by more than 180 degrees.
    pub fn follow(&mut self, targets: &FoldTargets, t: &Topology, x: &[f64]) {
        for (angle, &(e, _)) in self.angles.iter_mut().zip(&targets.creases) {
            *angle = angle_near(fold_angle(t, x, e).unwrap_or(0.0), *angle);
        }
    }

    /// The angle of a crease, degrees.
    pub fn angle(&self, crease: usize) -> f64 {
        self.angles[crease].to_degrees()
    }

    /// How far each crease is from its target, degrees.
    pub fn off(&self, targets: &FoldTargets) -> Vec<f64> {
        let targets = targets.creases.iter().map(|(_, target)| target);
        let off = |(angle, target): (&f64, &f64)| (angle - target).abs().to_degrees();
        self.angles.iter().zip(targets).map(off).collect()
    }

    /// The differences at positions `x`, at creases as they were followed.
    pub fn residual(&self, targets: &FoldTargets, t: &Topology, x: &[f64]) -> FoldResidual {
        let off = self.off(targets);
        let squares: f64 = off.iter().map(|d| d * d).sum();
        let creases = self.angles.iter().zip(&targets.creases).zip(&off);
        let is_other = |((angle, (_, target)), off): &((&f64, &(EdgeId, f64)), &f64)| {
            **angle * target < 0.0 && **off > target.abs().to_degrees()
        };
        let others = creases.filter(is_other);
        FoldResidual {
            largest: off.iter().copied().fold(0.0, f64::max),
            rms: (squares / off.len().max(1) as f64).sqrt(),
            wrong_side: others.count(),
            ..targets.residual(t, x)
        }
    }
}

impl Folding {
    pub(crate) fn check(&self, mesh: &Mesh, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("time"), self.time, Unit::Second);
        checks.positive(key.name("stiffness"), self.stiffness, Unit::Newton);
        checks.positive(
            key.name("flat_stiffness"),
            self.flat_stiffness,
            Unit::Newton,
        );
        checks.within(key.name("part"), self.part, [-1.0, 1.0]);
        if self.course.is_some() && !self.order.is_empty() {
            let message = "groups of creases fold one after the other in a course of their own";
            checks.report(key.name("course"), message, "leave out `course` or `order`");
        }
        for (k, group) in self.order.iter().enumerate() {
            group.check(&key.name("order").entry(k), checks);
        }
        match mesh {
            Mesh::File(_) => {}
            Mesh::Drawing(_) if self.frame.is_none() => {}
            Mesh::Drawing(_) => {
                let message = "a frame is asked for, and a drawing has none";
                checks.report(key.name("frame"), message, "leave it out");
            }
            _ => {
                let message = "the angles come from a file, but `sheet.mesh` is no file";
                let remedy = "write `mesh = { file = { path = ... } }` or `mesh = { drawing = { ... } }`, or fold by \
                              `[[crease]]`";
                checks.report(key.clone(), message, remedy);
            }
        }
    }

    /// Where the edges of the sheet are driven, whose mesh is `mesh`: a file or a drawing.
    pub(crate) fn targets(
        &self,
        key: &Key,
        mesh: &Mesh,
        refined: &Refined,
        files: &mut Files,
    ) -> Result<FoldTargets, Problem> {
        let t = refined.mesh().topology();
        let of_mesh = |name: &str| Key::root().name("sheet.mesh").name(name);
        let (frame, name) = match (mesh, &self.frame) {
            (Mesh::Drawing(drawing), _) => {
                let drawn = drawing.sheet(&of_mesh("drawing"), files)?;
                (Arc::new(drawn.mesh), "the drawing".to_owned())
            }
            (Mesh::File(file), None) => {
                let read = files.read(file, &of_mesh("file"))?;
                (read, "the frame of the sheet".to_owned())
            }
            (Mesh::File(file), Some(number)) => {
                let frame = Some(number.clone());
                let file = MeshFileKey {
                    frame,
                    ..file.clone()
                };
                let read = files.mesh(&file);
                let read = read.map_err(|e| Problem::from_error(key.name("frame"), &e))?;
                (read, format!("frame {number}"))
            }
            // Refused by the checks.
            _ => return Ok(FoldTargets::default()),
        };
        let mut frame = Arc::unwrap_or_clone(frame);
        if frame.vertex_count() != t.vertex_count() {
            let message = format!(
                "{name} has {} vertices, and the sheet has {}",
                frame.vertex_count(),
                t.vertex_count()
            );
            let remedy = "choose a frame of the same vertices";
            return Err(Problem::new(key.name("frame"), message, remedy));
        }
        frame
            .orient_creases(t)
            .map_err(|e| Problem::from_error(key.name("frame"), &e))?;
        let drawn = std::mem::take(&mut frame.drawn);
        let mut targets = FoldTargets {
            flat: refined.inside_faces(),
            drawn: drawn.clone(),
            ..FoldTargets::default()
        };
        for (k, group) in self.order.iter().enumerate() {
            group.refuse_idle(&drawn, &key.name("order").entry(k))?;
        }
        let shape = (!is_plane(t, &frame.positions)).then_some(&frame.positions[..]);
        let mut known = vec![false; self.order.len()];
        for (number, crease) in frame.creases.iter().enumerate() {
            let [a, b] = crease.ends.map(VertexId);
            let Some(e) = t.find_edge(a, b).filter(|&e| !t.is_boundary_edge(e)) else {
                continue;
            };
            let angle = match shape {
                Some(x) => fold_angle(t, x, e),
                None => crease.angle,
            };
            let parts = refined.parts(e).into_iter();
            let mut drive = |angle| {
                let driven = parts.clone().map(|e| (e, self.part * angle));
                let of_pattern = PatternCrease {
                    edge: number,
                    angle,
                    drawn: crease.drawn,
                };
                let has = |group: &FoldGroup| group.has(&of_pattern, &drawn);
                let group = self.order.iter().position(has);
                if let Some(group) = group {
                    known[group] = true;
                }
                let last = self.order.len().saturating_sub(1);
                let groups = std::iter::repeat_n(group.unwrap_or(last), parts.len());
                targets.groups.extend(groups);
                targets
                    .of_pattern
                    .extend(std::iter::repeat_n(of_pattern, parts.len()));
                targets.creases.extend(driven);
            };
            let angle = angle.or(match crease.assignment {
                EdgeAssignment::Mountain => Some(-PI),
                EdgeAssignment::Valley => Some(PI),
                _ => None,
            });
            match (crease.assignment, angle) {
                (EdgeAssignment::Flat | EdgeAssignment::Join, _) => targets.flat.extend(parts),
                (EdgeAssignment::Mountain | EdgeAssignment::Valley, Some(angle)) => drive(angle),
                (_, Some(angle)) if angle != 0.0 => drive(angle),
                _ => {}
            }
        }
        if targets.creases.is_empty() {
            let message = format!("{name} gives no crease inside the sheet a fold angle");
            let remedy = "take a file with mountains and valleys, or with `edges_foldAngle`; of a drawing `isosheet mesh DRAWING \
                          -o FILE.fold --spacing 5mm --valley layer:NAME` (or a colour) makes one";
            return Err(Problem::new(key.clone(), message, remedy));
        }
        if let Some(empty) = known.iter().position(|known| !known) {
            let message =
                format!("no crease that is driven folds with group {empty}, counted from 0");
            let remedy = "name creases that no group before has, by lines of the drawing or by the numbers of the edges in a FOLD \
                          file, which `isosheet convert PATTERN FILE.fold` writes; edges of the outline do not fold";
            return Err(Problem::new(
                key.name("order").entry(empty),
                message,
                remedy,
            ));
        }
        Ok(targets)
    }

    /// The springs that drive creases to targets from positions `x` (`3V`, metres), and the springs that keep
    /// edges flat.
    pub(crate) fn springs(
        &self,
        targets: &FoldTargets,
        of: &SheetKey,
        sheet: &Sheet,
        x: &[f64],
    ) -> [Vec<CreaseSpring>; 2] {
        let spring = |edge: EdgeId, stiffness: f64, target: f64, within: [f64; 2]| {
            let start = fold_angle(sheet.topology(), x, edge).unwrap_or(0.0);
            CreaseSpring {
                edge,
                stiffness: stiffness * sheet.lengths()[edge.index()],
                rest: course(start, target, within),
                yields: None,
                in_series: None,
            }
        };
        let flat_stiffness = self.flat_stiffness.or(match of.isometry() {
            IsometryKey::Rods => Some(FLAT_STIFFNESS * self.stiffness),
            IsometryKey::Elastic { .. } => None,
        });
        let driven = targets.creases.iter().zip(&targets.groups);
        let smooth = ProfileKey::smooth_step(1.0, self.time);
        let other = self.course.as_ref().filter(|course| **course != smooth);
        let driven = driven.map(|(&(edge, target), &group)| {
            let spring = spring(edge, self.stiffness, target, self.turn_of(group));
            match other {
                None => spring,
                Some(course) => CreaseSpring {
                    rest: course.scaled(target.clamp(-PI, PI)).into(),
                    ..spring
                },
            }
        });
        let flat = flat_stiffness.into_iter().flat_map(|stiffness| {
            let flat = targets.flat.iter();
            flat.map(move |&edge| spring(edge, stiffness, 0.0, [0.0, self.time]))
        });
        [driven.collect(), flat.collect()]
    }

    /// The part of the way to their angles that the springs have gone at a time (seconds), from 0 to 1.
    pub fn progress(&self, t: f64) -> f64 {
        if let Some(course) = &self.course {
            return course.value(t);
        }
        let turns = self.order.len().max(1);
        let parts = (0..turns).map(|group| course(0.0, 1.0, self.turn_of(group)).at(t));
        parts.sum::<f64>() / turns as f64
    }

    /// When the creases of a group begin to fold and when they have reached their angles, seconds.
    pub fn turn_of(&self, group: usize) -> [f64; 2] {
        let turns = self.order.len().max(1) as f64;
        [group, group + 1].map(|k| self.time * k as f64 / turns)
    }
}

/// The rest angle of a spring that goes from one angle to another, radians, between two times, seconds.
fn course(start: f64, target: f64, [begin, end]: [f64; 2]) -> RestAngle {
    // A target that is a last digit above pi because of rounding would be refused.
    let target = target.clamp(-PI, PI);
    if start == target {
        return target.into();
    }
    let change = Change {
        from: start,
        to: target,
        begin,
        end,
    };
    ProfileKey::Course(Course::SmoothStep(change))
        .as_given()
        .into()
}

/// The difference of a fold angle (degrees, not negative) from a target (radians), taken the short way round
/// as the springs do.
pub fn off_target(topology: &Topology, x: &[f64], edge: EdgeId, target: f64) -> f64 {
    let angle = fold_angle(topology, x, edge).unwrap_or(0.0) - target;
    angle_near(angle, 0.0).abs().to_degrees()
}

/// Whether the sheet is in a plane at positions `x`: every edge is flat or folded shut.
fn is_plane(t: &Topology, x: &[f64]) -> bool {
    let mut angles = t.edge_ids().filter_map(|e| fold_angle(t, x, e));
    angles.all(|angle| angle.sin().abs() < FLAT)
}
