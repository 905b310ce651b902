//! Creases with rest angles.

use crate::meshes::drawing;
use crate::meshes::pattern::EdgeRoles;
use crate::meshes::selection::{ON_LINE, beside_line, size};
use crate::sheets::refined::Refined;
use crate::sheets::yields::CreaseYield;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use crate::words::warning::Warning;
use isosheet_drawings::Selector;
use isosheet_dynamics::CreaseSpring;
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::wording::{brief, place};
use isosheet_mesh::{EdgeId, Sheet, VertexId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Torsion springs along some edges. They have one rest angle, which may be driven.
///
/// ```toml
/// [[crease]]
/// at = { line = { from = [0, 0.1, 0], to = [0.2, 0.1, 0] } }
/// stiffness = 0.01
/// angle = { ramp = { to = 90, end = 1 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Crease {
    /// A name, by which measures find it, and which messages say.
    #[serde(default)]
    pub name: Option<String>,
    /// The name of the sheet, if there are several.
    #[serde(default)]
    pub sheet: Option<String>,
    /// Which edges.
    pub at: CreaseEdges,
    /// Torsional stiffness of a metre of crease, N (newton metres per radian and metre). It takes the place
    /// of the bending stiffness of the sheet along the crease; springs `at = { pattern = "flat" }` add to it.
    pub stiffness: f64,
    /// Fold angle at rest, degrees: 0 for flat, positive for a valley as seen from the side from which faces
    /// are counter-clockwise, negative for a mountain.
    #[serde(default)]
    #[unit(Degree)]
    pub angle: ProfileKey,
    /// When it yields. If left out, never: it comes back to its angle.
    #[serde(default, rename = "yield")]
    pub yields: Option<CreaseYield>,
}

/// Which edges a crease consists of. Points are in the rest shape before it is placed.
///
/// ```toml
/// [[crease]]
/// at = { line = { from = [0, 0.1, 0], to = [0.2, 0.1, 0] } }
/// stiffness = 0.01
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum CreaseEdges {
    /// Edges of `sheet.mesh` by the numbers of their two vertices.
    Ends(Vec<[usize; 2]>),
    /// The interior edges on a straight line.
    Line {
        /// Where the line begins, metres.
        from: [f64; 3],
        /// Where the line ends, metres.
        to: [f64; 3],
    },
    /// Edges of a crease pattern by what they are meant to do.
    Pattern(PatternEdges),
    /// The edges along lines of `sheet.mesh.drawing`, in the words that select lines there:
    /// `["layer:Crease", "#e6007e"]`, also where the mesh is a FOLD file that `isosheet mesh` made of the
    /// drawing, or an SVG file of a crease pattern. A positive angle makes valleys of all of them.
    Drawn(Vec<String>),
}

/// Whether the sheet folds at an edge that has a spring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EdgeFolds {
    /// A crease: its spring takes the place of the bending stiffness of the sheet there.
    Yes,
    /// The spring keeps the edge flat, besides the bending stiffness of the sheet.
    No,
}

/// The springs of a scene, in groups by the keys that they come from.
#[derive(Default)]
pub(crate) struct FoldSprings {
    groups: Vec<(Key, EdgeFolds, Vec<CreaseSpring>)>,
}

impl FoldSprings {
    pub(crate) fn add(&mut self, key: Key, folds: EdgeFolds, springs: Vec<CreaseSpring>) {
        if !springs.is_empty() {
            self.groups.push((key, folds, springs));
        }
    }

    /// The edges at which the sheet folds, each once.
    pub(crate) fn creases(&self) -> Vec<EdgeId> {
        let creases = self.groups.iter().filter(|g| g.1 == EdgeFolds::Yes);
        let edges = creases.flat_map(|(_, _, springs)| springs.iter().map(|s| s.edge));
        edges.collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Has the springs of creases replace the bending stiffness of the sheet at their edges.
    pub(crate) fn put_in_sheet(&mut self, sheet: &Sheet, rigidity: f64) {
        let creases = self.groups.iter_mut().filter(|g| g.1 == EdgeFolds::Yes);
        let springs = creases.flat_map(|(_, _, springs)| springs);
        CreaseSpring::put_in_sheet(springs, sheet, rigidity);
    }

    pub(crate) fn into_groups(self) -> impl Iterator<Item = (Key, Vec<CreaseSpring>)> {
        let groups = self.groups.into_iter();
        groups.map(|(key, _, springs)| (key, springs))
    }
}

/// Edges of a crease pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum PatternEdges {
    /// All mountains and valleys; a positive angle folds each to its side.
    Assigned,
    /// The mountains. Their angles are negative.
    Mountains,
    /// The valleys.
    Valleys,
    /// The edges inside the sheet that the pattern names neither mountains nor valleys. A positive angle
    /// makes them valleys.
    Unassigned,
    /// The edges inside panels, which are meant to stay flat.
    Flat,
    /// The zigzag creases of `sheet.mesh.miura`; a positive angle folds each to its side.
    Zigzags,
}

/// Half a turn in radians, rounded up to as few digits as people give.
const HALF_TURN: f64 = 3.15;

/// Angles of creases that seem to be radians: none is larger than half a turn of them, and one is not zero.
pub(crate) fn in_radians(creases: &[Crease]) -> Option<Warning> {
    let sizes = creases.iter().enumerate().map(|(k, crease)| {
        let (_, angles) = crease.angle.numbers();
        (k, angles.into_iter().map(f64::abs).fold(0.0, f64::max))
    });
    let (k, largest) = sizes.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (largest > 0.0 && largest <= HALF_TURN).then(|| {
        let key = Key::root().name("crease").entry(k).name("angle");
        let message = format!(
            "no crease folds by more than {} degrees, the size of `{key}`: in radians that is {} degrees",
            brief(largest),
            brief(largest.to_degrees())
        );
        Warning::new(message, "give angles in degrees")
    })
}

impl Crease {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.not_negative(key.name("stiffness"), self.stiffness, Unit::Newton);
        if let ProfileKey::Constant(angle) = self.angle
            && angle.is_finite()
        {
            checks.within(key.name("angle"), angle, [-180.0, 180.0]);
        }
        if self.yields.is_some() {
            let (_, angles) = self.angle.numbers();
            if angles.iter().any(|angle| *angle != angles[0]) {
                let message = format!(
                    "`{}` is for moments, and a crease that folds by its own angle, `{}`, has hardly any: it yields little, \
                     and goes where its angle goes",
                    key.name("yield"),
                    key.name("angle")
                );
                let remedy = "leave the angle as it is at rest, and fold the sheet by supports, loads or obstacles";
                checks.doubts.push(Warning::new(message, remedy));
            }
        }
        match &self.at {
            CreaseEdges::Line { from, to } => checks.line(&key.name("at.line"), from, to),
            CreaseEdges::Drawn(lines) => drawing::check_lines(lines, &key.name("at.drawn"), checks),
            CreaseEdges::Ends(_) | CreaseEdges::Pattern(_) => {}
        }
    }

    /// Its name, or the lines of the drawing that it follows.
    pub fn called(&self) -> Option<String> {
        let lines = || match &self.at {
            CreaseEdges::Drawn(lines) => Some(lines.join(", ")),
            CreaseEdges::Ends(_) | CreaseEdges::Line { .. } | CreaseEdges::Pattern(_) => None,
        };
        self.name.clone().or_else(lines)
    }

    /// Whether the sheet folds along this crease, which may also be there to keep panels flat.
    pub(crate) fn folds(&self) -> EdgeFolds {
        match self.at {
            CreaseEdges::Pattern(PatternEdges::Flat) => EdgeFolds::No,
            _ => EdgeFolds::Yes,
        }
    }

    /// Refuses names that stand twice.
    pub(crate) fn check_names(creases: &[Self], checks: &mut Checks) {
        for (k, crease) in creases.iter().enumerate() {
            let others = &creases[..k];
            if crease.name.is_some() && others.iter().any(|other| other.name == crease.name) {
                checks.report(
                    Key::root().name("crease").entry(k).name("name"),
                    format!(
                        "another crease has the name `{}`",
                        crease.name.as_deref().unwrap_or_default()
                    ),
                    "give each crease a name of its own, or write both as one",
                );
            }
        }
    }

    /// The springs of the crease on a rest shape.
    pub(crate) fn springs(
        &self,
        key: &Key,
        refined: &Refined,
        roles: Option<&EdgeRoles>,
    ) -> Result<Vec<CreaseSpring>, Problem> {
        let at = key.name("at");
        let sheet = refined.sheet();
        let edges = match &self.at {
            CreaseEdges::Ends(ends) => by_ends(ends, &at.name("ends"), refined)?,
            CreaseEdges::Line { from, to } => on_line(sheet, from, to, &at)?,
            CreaseEdges::Drawn(lines) => drawn(lines, &at.name("drawn"), refined, roles)?,
            CreaseEdges::Pattern(wanted) => {
                let Some(roles) = roles else {
                    return Err(Problem::new(
                        at.name("pattern"),
                        "the mesh of the sheet is not a crease pattern",
                        "use `sheet.mesh.miura` or a FOLD file, or name the edges by `ends` or `line`",
                    ));
                };
                of_pattern(*wanted, roles)
            }
        };
        if edges.is_empty() {
            return Err(Problem::new(
                at,
                "no interior edge of the mesh is selected here",
                "choose edges between two faces",
            ));
        }
        let spring = |(edge, sign): (EdgeId, f64)| CreaseSpring {
            edge,
            stiffness: self.stiffness * sheet.lengths()[edge.index()],
            rest: self.angle.scaled(sign * 1.0_f64.to_radians()).into(),
            yields: self
                .yields
                .map(|y| y.of_edge(sheet.lengths()[edge.index()])),
            in_series: None,
        };
        Ok(edges.into_iter().map(spring).collect())
    }
}

fn by_ends(
    ends: &[[usize; 2]],
    key: &Key,
    refined: &Refined,
) -> Result<Vec<(EdgeId, f64)>, Problem> {
    let t = refined.mesh().topology();
    let edge = |(k, &[a, b]): (usize, &[usize; 2])| {
        let count = t.vertex_count();
        let found = (a < count && b < count && a != b)
            .then(|| t.find_edge(VertexId::from_index(a), VertexId::from_index(b)))
            .flatten()
            .filter(|&e| !t.is_boundary_edge(e));
        found.ok_or_else(|| {
            Problem::new(
                key.entry(k),
                format!("the mesh has no interior edge between the vertices {a} and {b}"),
                format!(
                    "name two neighbours; the vertices have the numbers 0 to {}",
                    count - 1
                ),
            )
        })
    };
    let edges: Vec<EdgeId> = ends
        .iter()
        .enumerate()
        .map(edge)
        .collect::<Result<_, _>>()?;
    let parts = edges.into_iter().flat_map(|e| refined.parts(e));
    Ok(parts.map(|e| (e, 1.0)).collect())
}

fn on_line(
    sheet: &Sheet,
    from: &[f64; 3],
    to: &[f64; 3],
    key: &Key,
) -> Result<Vec<(EdgeId, f64)>, Problem> {
    let t = sheet.topology();
    let tolerance = ON_LINE * size(sheet.positions().as_chunks::<3>().0);
    let distance = |e: EdgeId| {
        let ends = t.edges()[e.index()].map(|v| beside_line(&sheet.position(v), [from, to]).1);
        ends[0].max(ends[1])
    };
    let interior = || t.edge_ids().filter(|&e| !t.is_boundary_edge(e));
    let found: Vec<EdgeId> = interior().filter(|e| distance(*e) <= tolerance).collect();
    let nearest = || interior().min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    match found.is_empty().then(nearest).flatten() {
        Some(e) => {
            let ends = t.edges()[e.index()].map(|v| sheet.position(v));
            Err(Problem::new(
                key.name("line"),
                format!(
                    "no interior edge of the mesh is on this line: the nearest one, from {} to {}, has an end {} m \
                     away from it, of at most {} m",
                    place(&ends[0]),
                    place(&ends[1]),
                    brief(distance(e)),
                    brief(tolerance)
                ),
                "a crease follows edges of the mesh: compare the line with the mesh before it is placed, or select \
                 lines of a drawing by `at = { drawn = [...] }`",
            ))
        }
        None => Ok(found.into_iter().map(|e| (e, 1.0)).collect()),
    }
}

/// The edges inside the sheet along lines of its drawing.
fn drawn(
    lines: &[String],
    key: &Key,
    refined: &Refined,
    roles: Option<&EdgeRoles>,
) -> Result<Vec<(EdgeId, f64)>, Problem> {
    let Some(drawn) = roles.and_then(|roles| roles.drawn.as_ref()) else {
        return Err(Problem::new(
            key.clone(),
            "the mesh of the sheet is made of no drawing",
            "use `sheet.mesh.drawing`, a FOLD file that `isosheet mesh` made of a drawing, or an SVG file of a crease pattern, or \
             name the edges by `pattern`, `ends` or `line`",
        ));
    };
    let t = refined.mesh().topology();
    let mut found = BTreeSet::new();
    for (k, text) in lines.iter().enumerate() {
        // Selectors that cannot be read were refused.
        let Ok(selector) = text.parse::<Selector>() else {
            continue;
        };
        let edges = drawn.along(&selector);
        let edges = edges.map_err(|e| Problem::from_error(key.entry(k), &e))?;
        let edges = edges.into_iter().map(|ends| ends.map(VertexId));
        found.extend(edges.filter_map(|[a, b]| t.find_edge(a, b)));
    }
    let inside = found.into_iter().filter(|&e| !t.is_boundary_edge(e));
    let parts = inside.flat_map(|e| refined.parts(e));
    Ok(parts.map(|e| (e, 1.0)).collect())
}

fn of_pattern(wanted: PatternEdges, roles: &EdgeRoles) -> Vec<(EdgeId, f64)> {
    let sign = |e: EdgeId, a: FoldAssignment| match (wanted, a) {
        (PatternEdges::Zigzags, _) if !roles.zigzags.contains(&e) => None,
        (PatternEdges::Assigned | PatternEdges::Zigzags, FoldAssignment::Mountain) => Some(-1.0),
        (
            PatternEdges::Assigned | PatternEdges::Zigzags | PatternEdges::Valleys,
            FoldAssignment::Valley,
        )
        | (PatternEdges::Mountains, FoldAssignment::Mountain)
        | (PatternEdges::Flat, FoldAssignment::Flat) => Some(1.0),
        _ => None,
    };
    let edges = roles.assignments.iter().enumerate();
    let edges = edges.map(|(e, &a)| (EdgeId::from_index(e), a));
    let chosen = |(e, a): (EdgeId, Option<FoldAssignment>)| {
        let sign = match a {
            Some(a) => sign(e, a)?,
            None if wanted == PatternEdges::Unassigned => 1.0,
            None => return None,
        };
        Some((e, sign))
    };
    edges.filter_map(chosen).collect()
}
