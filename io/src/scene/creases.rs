//! Creases with rest angles.

use super::key::Key;
use super::pattern::EdgeRoles;
use super::problem::{Checks, Problem};
use super::profile::Profile;
use super::refined::Refined;
use super::selection::{ON_LINE, place_on_line, size};
use super::unit::Unit;
use super::yields::CreaseYield;
use isosheet_dynamics::CreaseSpring;
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{EdgeId, Sheet, VertexId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Torsion springs along some edges, with the same rest angle, which may be driven.
///
/// ```toml
/// [[crease]]
/// at = { line = { from = [0, 0.1, 0], to = [0.2, 0.1, 0] } }
/// stiffness = 0.01
/// angle = { ramp = { to = 90, end = 1 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Crease {
    /// The name of the sheet, if there are several.
    #[serde(default)]
    pub sheet: Option<String>,
    /// Which edges.
    pub at: CreaseEdges,
    /// Torsional stiffness of a metre of crease, N (newton metres per radian and metre). It takes the place
    /// of the bending stiffness of the sheet along the crease; springs `at = { pattern = "flat" }` act
    /// besides it.
    pub stiffness: f64,
    /// Fold angle at rest, degrees: 0 for flat, positive for a valley as seen from the side from which faces
    /// are counter-clockwise, negative for a mountain.
    #[serde(default)]
    pub angle: Profile,
    /// When it yields. If left out, never: it comes back to its angle.
    #[serde(default, rename = "yield")]
    pub yields: Option<CreaseYield>,
}

/// Which edges a crease consists of. Points are those of the rest shape before it is placed.
///
/// ```toml
/// [[crease]]
/// at = { line = { from = [0, 0.1, 0], to = [0.2, 0.1, 0] } }
/// stiffness = 0.01
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PatternEdges {
    /// All mountains and valleys; a positive angle folds each to its side.
    Assigned,
    /// The mountains. Their angles are negative.
    Mountains,
    /// The valleys.
    Valleys,
    /// The edges inside the sheet of which the pattern does not say whether they are mountains or valleys. A
    /// positive angle makes them valleys.
    Unassigned,
    /// The edges inside panels, which are meant to stay flat.
    Flat,
    /// The zigzag creases of `sheet.mesh.miura`; a positive angle folds each to its side.
    Zigzags,
}

impl Crease {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.not_negative(key.name("stiffness"), self.stiffness, Unit::Newton);
        self.angle.check(key.name("angle"), Unit::Degree, checks);
        if let Profile::Constant(angle) = self.angle
            && angle.is_finite()
        {
            checks.within(key.name("angle"), angle, [-180.0, 180.0]);
        }
        if let Some(yields) = &self.yields {
            yields.check(&key.name("yield"), checks);
        }
        if let CreaseEdges::Line { from, to } = &self.at {
            checks.line(&key.name("at.line"), from, to);
        }
    }

    /// Whether the sheet folds along this crease, which may also be there to keep panels flat.
    pub(crate) fn folds(&self) -> EdgeFolds {
        match self.at {
            CreaseEdges::Pattern(PatternEdges::Flat) => EdgeFolds::No,
            _ => EdgeFolds::Yes,
        }
    }

    /// The springs of the crease on a rest shape.
    pub(super) fn springs(
        &self,
        key: &Key,
        refined: &Refined,
        roles: Option<&EdgeRoles>,
    ) -> Result<Vec<CreaseSpring>, Problem> {
        let at = key.name("at");
        let sheet = refined.sheet();
        let edges = match &self.at {
            CreaseEdges::Ends(ends) => by_ends(ends, &at.name("ends"), refined)?,
            CreaseEdges::Line { from, to } => on_line(sheet, from, to),
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
                "a crease follows edges of the mesh: compare the line with the mesh before it is placed",
            ));
        }
        let spring = |(edge, sign): (EdgeId, f64)| CreaseSpring {
            edge,
            stiffness: self.stiffness * sheet.lengths()[edge.index()],
            rest: self.angle.scaled(sign * 1.0_f64.to_radians()).into(),
            yields: self
                .yields
                .map(|y| y.of_edge(sheet.lengths()[edge.index()])),
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

fn on_line(sheet: &Sheet, from: &[f64; 3], to: &[f64; 3]) -> Vec<(EdgeId, f64)> {
    let t = sheet.topology();
    let tolerance = ON_LINE * size(sheet.positions().as_chunks::<3>().0);
    let near = |v: VertexId| place_on_line(&sheet.position(v), [from, to], tolerance).is_some();
    let edges = t.edge_ids().filter(|&e| !t.is_boundary_edge(e));
    let edges = edges.filter(|e| t.edges()[e.index()].iter().all(|&v| near(v)));
    edges.map(|e| (e, 1.0)).collect()
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
