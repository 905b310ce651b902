//! The mesh of a drawing.

use crate::{EdgeAssignment, FileCrease, MeshFile};
use isosheet_drawings::{
    ClassCount, Drawing, DrawingOptions, DrawingReport, DrawnLine, DrawnLines, LineClass, Places,
    listed, read_drawing, refuse_idle,
};
use isosheet_files::{DataError, FileError};
use isosheet_mesh::plane::{
    Piece, PlaneCurve, PlaneError, PlaneGraph, PlaneMesh, PlaneOptions, Role,
};
use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, MeshError, Sheet};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::f64::consts::PI;
use std::path::Path;
use thiserror::Error;

/// Why a drawing does not become a sheet.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DrawingError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// An option is out of range, or it is not known what lines are.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A line that bounds the sheet crosses itself.
    #[error(transparent)]
    Crossing(DataError),
    /// The lines bound no sheet.
    #[error(transparent)]
    Plane(#[from] PlaneError),
    /// The triangles are no sheet.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl Advice for DrawingError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::File(error) => error.advice(),
            Self::Data(error) | Self::Crossing(error) => error.advice(),
            Self::Plane(error) => error.advice(),
            Self::Mesh(error) => error.advice(),
        }
    }
}

/// A drawing that has become a sheet.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct DrawnSheet {
    /// The mesh, metres, in the plane z = 0, with its creases. Cuts have vertices of their own on both sides.
    pub mesh: MeshFile,
    /// What was taken for what, and what was changed.
    pub report: DrawingReport,
}

/// The default tolerance for snapping, as a part of the diagonal of the drawing.
const SNAP: f64 = 1e-4;

/// Makes a triangle mesh of a drawing whose edges follow its lines.
///
/// # Errors
/// [`DrawingError`]
pub fn mesh_drawing(
    drawing: &Drawing,
    options: &DrawingOptions,
) -> Result<DrawnSheet, DrawingError> {
    options.validate()?;
    let kinds = classify(drawing, options)?;
    let of_line = |line: &DrawnLine| kinds[line.pen].0;
    let is_drawn = |line: &&DrawnLine| of_line(line) != LineClass::Ignored;
    let lines: Vec<&DrawnLine> = drawing.lines.iter().filter(is_drawn).collect();
    if lines.is_empty() {
        let message = match drawing.lines.is_empty() {
            true => "the drawing has no lines",
            false => "all lines of the drawing are left out",
        };
        return Err(DataError::new(message, "draw the outline of the sheet as lines").into());
    }
    let diagonal = diagonal(&lines);
    let snap = options.snap.unwrap_or(SNAP * diagonal);
    let snap = snap.max(f64::MIN_POSITIVE);
    let lines = without_short_ones(&lines, snap);
    let lines: Vec<&DrawnLine> = lines.iter().collect();
    let curves: Vec<_> = lines.iter().map(|l| l.curve).collect();
    let graph = PlaneGraph::new(&curves, snap)?;
    refuse_self_crossing(&graph, &lines, of_line).map_err(DrawingError::Crossing)?;
    let mut classes: Vec<LineClass> = graph
        .pieces
        .iter()
        .map(|p| class_of(p.sources.iter().map(|s| of_line(lines[*s]))))
        .collect();
    let roles: Vec<Role> = classes.iter().map(|class| role(*class)).collect();
    let plane = PlaneOptions {
        spacing: options.spacing,
        seed: options.seed,
    };
    let plane = PlaneMesh::new(&graph, &roles, &plane).map_err(|error| match error {
        PlaneError::NoOutline => no_outline(options, diagonal),
        error => error.into(),
    })?;
    for &piece in &plane.closing {
        classes[piece] = LineClass::Cut;
    }
    let angle = |piece: usize| {
        let sources = graph.pieces[piece].sources.iter().map(|s| lines[*s]);
        let mut own = sources.filter(|line| of_line(line) == classes[piece]);
        let opacity = drawing.pens[own.next()?.pen].opacity;
        let sign = match classes[piece] {
            LineClass::Mountain => -1.0,
            LineClass::Valley => 1.0,
            _ => return None,
        };
        (opacity < 1.0).then_some(sign * opacity * PI)
    };
    let (mut drawn, numbers) = DrawnLines::of_pens(&drawing.pens);
    let of_piece = graph.pieces.iter().map(|piece| {
        let pens = piece.sources.iter().map(|s| numbers[lines[*s].pen]);
        drawn.set(pens.collect())
    });
    let of_piece: Vec<u32> = of_piece.collect();
    let creases: Vec<FileCrease> = plane
        .edges
        .iter()
        .map(|(ends, piece)| FileCrease {
            ends: *ends,
            assignment: assignment(classes[*piece]),
            angle: angle(*piece),
            drawn: Some(of_piece[*piece]),
        })
        .collect();
    let mut mesh = assemble(&plane, creases);
    mesh.drawn = drawn;
    mesh.in_metres = drawing.assumed_unit.is_none();
    let sheet = Sheet::new(mesh.positions.clone(), &mesh.faces)?;
    let places = |pieces: &[usize]| {
        let pieces = pieces.iter().map(|k| &graph.pieces[*k]);
        Places::of(pieces.map(|piece| (piece.length(), piece.middle())))
    };
    let report = DrawingReport {
        size: extent(&plane.points),
        spacing: options.spacing,
        classes: count(drawing, &kinds),
        joined: Places::of(graph.joins.iter().map(|j| (j.gap, j.at))),
        doubled: Places::of(doubled(&graph).map(|p| (p.length(), p.middle()))),
        contradicting: Places::of(
            doubled(&graph)
                .filter(|p| {
                    let classes = p.sources.iter().map(|s| of_line(lines[*s]));
                    classes.collect::<BTreeSet<_>>().len() > 1
                })
                .map(|p| (p.length(), p.middle())),
        ),
        closing: places(&plane.closing),
        beyond: places(&plane.outside),
        pieces: sheet.topology().component_count(),
        too_short: graph.dropped.len(),
        left_out: drawing.left_out.clone(),
        assumed_unit: drawing.assumed_unit,
        by_own_unit: drawing.by_own_unit,
    };
    Ok(DrawnSheet { mesh, report })
}

/// No line bounds an area, perhaps because a tolerance that was given has joined all of them.
fn no_outline(options: &DrawingOptions, diagonal: f64) -> DrawingError {
    match options.snap {
        Some(snap) if snap > SNAP * diagonal => {
            let message = format!(
                "no line bounds an area once ends that are {} m apart are joined, in a drawing of {} m from corner to \
                 corner",
                given(snap),
                brief(diagonal)
            );
            let error = DataError::new(
                message,
                "give a smaller tolerance for snapping, with its unit",
            );
            error.value(snap).into()
        }
        _ => PlaneError::NoOutline.into(),
    }
}

/// Larger tolerances that are tried for a drawing that makes no sheet, as parts of its diagonal: from the
/// default on to a millimetre on a drawing of twenty centimetres.
const LARGER: [f64; 2] = [SNAP, 5e-3];

impl DrawnSheet {
    /// The smallest of the tolerances 0.1, 0.2, 0.5, 1 mm, ... (metres) with which a drawing becomes a sheet
    /// that does not without one; `None` if none of them helps, or one was given.
    pub fn helping_snap(drawing: &Drawing, options: &DrawingOptions) -> Option<f64> {
        let lines: Vec<&DrawnLine> = drawing.lines.iter().collect();
        let diagonal = diagonal(&lines);
        let [least, most] = LARGER.map(|part| part * diagonal);
        let decade = 10.0_f64.powf(least.log10().floor());
        let round = (0..9).map(|k| decade * [1.0, 2.0, 5.0][k % 3] * 10.0_f64.powi(k as i32 / 3));
        let mut larger =
            round.filter(|snap| (least..=most).contains(snap) && options.snap.is_none());
        larger.find(|snap| {
            let coarse = DrawingOptions {
                spacing: diagonal,
                snap: Some(*snap),
                ..options.clone()
            };
            mesh_drawing(drawing, &coarse).is_ok()
        })
    }

    /// The sheet of a file.
    ///
    /// # Errors
    /// [`DrawingError`]
    pub fn read(path: &Path, options: &DrawingOptions) -> Result<Self, DrawingError> {
        options.validate()?;
        mesh_drawing(&read_drawing(path, options)?, options)
    }
}

/// The assignment of edges along a line of a class.
fn assignment(class: LineClass) -> EdgeAssignment {
    match class {
        LineClass::Cut => EdgeAssignment::Cut,
        LineClass::Mountain => EdgeAssignment::Mountain,
        LineClass::Valley => EdgeAssignment::Valley,
        LineClass::Crease => EdgeAssignment::Unassigned,
        LineClass::Flat | LineClass::Ignored => EdgeAssignment::Flat,
    }
}

/// The lines of paths with fine parts in longer ones: as many of them become one straight line as are needed
/// for its ends to be further apart than four times the tolerance within which ends become one.
fn without_short_ones(lines: &[&DrawnLine], snap: f64) -> Vec<DrawnLine> {
    let least = 4.0 * snap;
    let apart = |[a, b]: [[f64; 2]; 2]| (b[0] - a[0]).hypot(b[1] - a[1]);
    let mut kept: Vec<DrawnLine> = Vec::new();
    let mut open: Option<(DrawnLine, [[f64; 2]; 2])> = None;
    for line in lines {
        let ends = line.curve.ends();
        let bulges = apart([line.curve.point(0.5), ends[0]]) > least;
        let is_long = apart(ends) > least || bulges;
        let goes_on = |first: &DrawnLine, end: [f64; 2]| {
            !is_long && (first.path, first.pen) == (line.path, line.pen) && end == ends[0]
        };
        let (first, run) = match open.take() {
            Some((first, [begin, end])) if goes_on(&first, end) => (first, [begin, ends[1]]),
            ended => {
                kept.extend(ended.map(|(first, ends)| straight(first, ends)));
                if is_long {
                    kept.push(**line);
                    continue;
                }
                (**line, ends)
            }
        };
        match apart(run) > least {
            true => kept.push(straight(first, run)),
            false => open = Some((first, run)),
        }
    }
    kept.extend(open.map(|(first, ends)| straight(first, ends)));
    kept
}

fn straight(line: DrawnLine, ends: [[f64; 2]; 2]) -> DrawnLine {
    DrawnLine {
        curve: PlaneCurve::Line(ends),
        ..line
    }
}

/// The class of each pen with the reason. Where all lines that nothing is known of are drawn alike and there
/// are no others, they are the outline.
fn classify(
    drawing: &Drawing,
    options: &DrawingOptions,
) -> Result<Vec<(LineClass, String)>, DataError> {
    refuse_idle_selectors(drawing, options)?;
    let known: Vec<_> = drawing
        .pens
        .iter()
        .map(|p| options.rules.class(p))
        .collect();
    let open = drawing.pens.iter().zip(&known).filter(|(_, k)| k.is_none());
    let open: BTreeSet<String> = open
        .map(|(p, _)| format!("{}{}", if p.dashed { "dashed " } else { "" }, p.colour))
        .collect();
    let is_outline = open.len() == 1 && known.iter().all(Option::is_none);
    if !is_outline && !open.is_empty() {
        let colours = if open.len() == 1 { "colour" } else { "colours" };
        let open = listed(open.into_iter().collect());
        let message = format!("it is not known what the lines of the {colours} {open} are");
        let remedy =
            "say it by their colour or layer: cut, crease, mountain, valley, flat or ignore";
        return Err(DataError::new(message, remedy));
    }
    let outline = || (LineClass::Cut, "the only lines".to_owned());
    Ok(known
        .into_iter()
        .map(|k| k.unwrap_or_else(outline))
        .collect())
}

/// Refuses selectors that select nothing.
fn refuse_idle_selectors(drawing: &Drawing, options: &DrawingOptions) -> Result<(), DataError> {
    for (index, (selector, _)) in options.rules.selectors.iter().enumerate() {
        refuse_idle(selector, &drawing.pens).map_err(|e| e.at(index))?;
    }
    Ok(())
}

/// The class of lines that lie on each other: a mountain on a valley is a crease.
fn class_of(classes: impl Iterator<Item = LineClass>) -> LineClass {
    let classes: BTreeSet<LineClass> = classes.collect();
    match classes.first() {
        Some(LineClass::Mountain) if classes.contains(&LineClass::Valley) => LineClass::Crease,
        Some(class) => *class,
        None => LineClass::Ignored,
    }
}

fn role(class: LineClass) -> Role {
    match class {
        LineClass::Cut => Role::Cut,
        _ => Role::Crease,
    }
}

fn refuse_self_crossing(
    graph: &PlaneGraph,
    lines: &[&DrawnLine],
    of_line: impl Fn(&DrawnLine) -> LineClass,
) -> Result<(), DataError> {
    let is_own =
        |[a, b]: [usize; 2]| lines[a].path == lines[b].path && of_line(lines[a]) == LineClass::Cut;
    let Some((_, at)) = graph.crossings.iter().find(|(pair, _)| is_own(*pair)) else {
        return Ok(());
    };
    let [x, y] = at.map(|c| (1e5 * c).round() / 1e2 + 0.0);
    let message = format!("an outline crosses itself at ({x}, {y}) mm");
    let remedy = "draw it without the crossing, or give a larger tolerance for snapping where it is that small";
    Err(DataError::new(message, remedy))
}

fn doubled(graph: &PlaneGraph) -> impl Iterator<Item = &Piece> {
    graph.pieces.iter().filter(|p| p.sources.len() > 1)
}

fn extent(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|k| {
        let along = points.iter().map(|p| p[k]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), c| {
            (l.min(c), h.max(c))
        });
        high - low
    })
}

fn diagonal(lines: &[&DrawnLine]) -> f64 {
    let points = lines
        .iter()
        .flat_map(|l| [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| l.curve.point(t)));
    let [w, h] = extent(&points.collect::<Vec<_>>());
    w.hypot(h)
}

/// The mesh with vertices of their own on both sides of cuts; edges within panels stay flat.
fn assemble(plane: &PlaneMesh, mut creases: Vec<FileCrease>) -> MeshFile {
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut known: HashSet<[u32; 2]> = creases.iter().map(|c| sorted(c.ends)).collect();
    for &[a, b, c] in &plane.faces {
        for ends in [[a, b], [b, c], [c, a]].map(sorted) {
            if known.insert(ends) {
                creases.push(FileCrease {
                    ends,
                    assignment: EdgeAssignment::Flat,
                    angle: None,
                    drawn: None,
                });
            }
        }
    }
    let positions = plane.points.iter().flat_map(|p| [p[0], p[1], 0.0]);
    let mut mesh = MeshFile::of_frame(positions.collect(), plane.faces.clone(), creases);
    mesh.separate_cuts();
    for crease in &mut mesh.creases {
        if crease.assignment == EdgeAssignment::Cut {
            crease.assignment = EdgeAssignment::Boundary;
        }
    }
    mesh
}

fn count(drawing: &Drawing, kinds: &[(LineClass, String)]) -> Vec<ClassCount> {
    let mut classes = Vec::new();
    for class in LineClass::ALL {
        let own = drawing.lines.iter().filter(|l| kinds[l.pen].0 == class);
        let mut reasons = BTreeMap::new();
        let (mut lines, mut length) = (0, 0.0);
        for line in own {
            lines += 1;
            let t = line.curve.subdivide([0.0, 1.0], f64::INFINITY, 0.02);
            let points: Vec<[f64; 2]> = t.iter().map(|t| line.curve.point(*t)).collect();
            let chord = |p: &[[f64; 2]]| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1]);
            length += points.windows(2).map(chord).sum::<f64>();
            *reasons.entry(kinds[line.pen].1.clone()).or_default() += 1;
        }
        if lines > 0 {
            classes.push(ClassCount {
                class,
                lines,
                length,
                reasons,
            });
        }
    }
    classes
}
