//! Which vertices are meant.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_formats::FaceGroups;
use isosheet_mesh::wording::{brief, place};
use isosheet_mesh::{FaceId, Topology, VertexId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Some vertices of the sheet. Points and regions are in space, where the sheet is at the start; regions
/// include their boundary, with an allowance of 1e-9 of the size of the sheet for round-off.
///
/// ```toml
/// [[support]]
/// at = { box = { min = [-0.01, -0.01, -0.01], max = [0.01, 1, 0.01] } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[checked]
pub enum Selection {
    /// All vertices.
    All,
    /// All vertices of the boundary.
    Boundary,
    /// Vertices by their numbers, from 0.
    Vertices(Vec<usize>),
    /// Faces by their numbers, from 0, and their vertices. The numbers are those after a refinement of the
    /// sheet, as in the frames of a run.
    Faces(Vec<usize>),
    /// The faces of a group that the mesh file of the sheet names, and their vertices. OBJ files name groups,
    /// objects and materials; PLY files integers of faces (`"label=3"`); glTF files nodes, meshes and
    /// materials; FOLD files entries of `faces_isosheet:group`. `isosheet info` lists the groups of a file.
    Group(String),
    /// For each point (metres) the vertex nearest to it.
    Nearest(Vec<[f64; 3]>),
    /// All vertices in a box with edges along the axes.
    Box {
        /// Smallest x, y and z, metres.
        min: [f64; 3],
        /// Largest x, y and z, metres.
        max: [f64; 3],
    },
    /// All vertices on the side of a plane that its normal points to.
    HalfSpace {
        /// A point of the plane, metres.
        point: [f64; 3],
        /// Normal of the plane, of any length.
        normal: [f64; 3],
    },
}

/// What selections choose from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InPlace<'a> {
    pub(crate) topology: &'a Topology,
    /// Positions (`3V`, metres).
    pub(crate) x: &'a [f64],
    /// The groups of its faces that files name.
    pub(crate) groups: &'a FaceGroups,
}

/// Most groups that an error lists.
const MOST_LISTED: usize = 12;

impl InPlace<'_> {
    /// The faces of a group.
    fn faces_of(&self, group: &str, key: &Key) -> Result<Vec<FaceId>, Problem> {
        let Some(faces) = self.groups.faces(group) else {
            let names: Vec<String> = self
                .groups
                .iter()
                .map(|(name, _)| format!("{name:?}"))
                .collect();
            let there_are = match names.len() {
                0 => "the sheet has none".to_owned(),
                count if count > MOST_LISTED => {
                    format!(
                        "there are {} and {} more",
                        names[..MOST_LISTED].join(", "),
                        count - MOST_LISTED
                    )
                }
                _ => format!("there are {}", names.join(", ")),
            };
            return Err(Problem::new(
                key.name("group"),
                format!("no group of faces has the name {group:?}: {there_are}"),
                "name a group of the mesh file of the sheet (`isosheet info` lists them)",
            ));
        };
        Ok(faces.iter().map(|&face| FaceId(face)).collect())
    }

    /// Faces by their numbers.
    fn numbered(&self, numbers: &[usize], key: &Key) -> Result<Vec<FaceId>, Problem> {
        let count = self.topology.face_count();
        check_numbers(numbers, &key.name("faces"), ("face", count))?;
        Ok(numbers.iter().map(|&n| FaceId::from_index(n)).collect())
    }
}

/// Allowance for round-off at the boundary of a region, as a part of the size of the sheet: far above the
/// round-off of coordinates (1e-16 of their size), far below the distance of vertices.
const ROUND_OFF: f64 = 1e-9;

impl Selection {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        match self {
            Self::All | Self::Boundary => {}
            Self::Vertices(_) | Self::Faces(_) | Self::Group(_) => {}
            Self::Nearest(points) => {
                checks.points(key.name("nearest"), points);
            }
            Self::Box { min, max } => {
                let key = key.name("box");
                checks.finite(key.name("min"), min, Unit::Metre);
                checks.finite(key.name("max"), max, Unit::Metre);
                if let Some(k) = (0..3).find(|&k| min[k] > max[k]) {
                    let message =
                        format!("the box begins at {} m and ends at {} m", min[k], max[k]);
                    checks.report(
                        key.name("min").entry(k),
                        message,
                        "give the smaller bound as `min`",
                    );
                }
            }
            Self::HalfSpace { point, normal } => {
                checks.finite(key.name("half_space.point"), point, Unit::Metre);
                checks.direction(key.name("half_space.normal"), normal);
            }
        }
    }

    /// The vertices that are meant of a sheet, ascending and without repetition.
    pub(crate) fn resolve(&self, key: &Key, sheet: &InPlace<'_>) -> Result<Vec<VertexId>, Problem> {
        let InPlace { topology, x, .. } = *sheet;
        let points = x.as_chunks::<3>().0;
        let slack = ROUND_OFF * size(points);
        let in_region = |inside: &dyn Fn(&[f64; 3]) -> bool| -> Vec<VertexId> {
            let ids = topology.vertex_ids().zip(points);
            ids.filter(|(_, p)| inside(p)).map(|(v, _)| v).collect()
        };
        let mut found = match self {
            Self::All => topology.vertex_ids().collect(),
            Self::Boundary => {
                let ids = topology.vertex_ids();
                ids.filter(|&v| topology.is_boundary_vertex(v)).collect()
            }
            Self::Vertices(numbers) => by_number(numbers, key, points.len())?,
            Self::Faces(_) | Self::Group(_) => {
                let faces = self.named_faces(key, sheet)?.unwrap_or_default();
                let corners = faces.into_iter().map(|f| topology.faces()[f.index()]);
                corners.flatten().collect()
            }
            Self::Nearest(wanted) => wanted.iter().map(|p| nearest(points, p).0).collect(),
            Self::Box { min, max } => {
                in_region(&|p| (0..3).all(|k| (min[k] - slack..=max[k] + slack).contains(&p[k])))
            }
            Self::HalfSpace { point, normal } => in_region(&|p| height(p, point, normal) >= -slack),
        };
        found.sort_unstable();
        found.dedup();
        if found.is_empty() {
            let [least, most] = bounds(points);
            return Err(Problem::new(
                key.clone(),
                format!(
                    "no vertex of the sheet is selected here{}",
                    nearest_in_words(points, |p| self.distance(p))
                ),
                format!(
                    "the sheet goes from {} to {}: change the region, or the unit of a mesh file, `scale = 0.001` \
                     for millimetres",
                    place(&least),
                    place(&most)
                ),
            ));
        }
        Ok(found)
    }

    /// How far a point is from a region, metres.
    fn distance(&self, p: &[f64; 3]) -> f64 {
        match self {
            Self::Box { min, max } => {
                let beyond = |k: usize| (min[k] - p[k]).max(p[k] - max[k]).max(0.0);
                (0..3).map(|k| beyond(k).powi(2)).sum::<f64>().sqrt()
            }
            Self::HalfSpace { point, normal } => (-height(p, point, normal)).max(0.0),
            _ => 0.0,
        }
    }

    /// Faces that are meant as such; nothing where vertices or a region are.
    fn named_faces(&self, key: &Key, sheet: &InPlace<'_>) -> Result<Option<Vec<FaceId>>, Problem> {
        Ok(match self {
            Self::Faces(numbers) => Some(sheet.numbered(numbers, key)?),
            Self::Group(group) => Some(sheet.faces_of(group, key)?),
            _ => None,
        })
    }

    /// The faces that are meant of a sheet, ascending: those by number or of the group, or those all corners
    /// of which are selected.
    pub(crate) fn faces(&self, key: &Key, sheet: &InPlace<'_>) -> Result<Vec<FaceId>, Problem> {
        if let Some(mut faces) = self.named_faces(key, sheet)? {
            faces.sort_unstable();
            faces.dedup();
            return match faces.is_empty() {
                false => Ok(faces),
                true => Err(Problem::new(
                    key.name("faces"),
                    "the list of faces is empty",
                    "give numbers of faces",
                )),
            };
        }
        let vertices = self.resolve(key, sheet)?;
        let is_inside = |v: &VertexId| vertices.binary_search(v).is_ok();
        let faces = sheet.topology.face_ids().zip(sheet.topology.faces());
        let faces = faces.filter(|(_, corners)| corners.iter().all(is_inside));
        let faces: Vec<FaceId> = faces.map(|(face, _)| face).collect();
        if faces.is_empty() {
            return Err(Problem::new(
                key.clone(),
                "no face of the sheet has all its corners here",
                "choose a larger region, or a finer mesh",
            ));
        }
        Ok(faces)
    }

    /// The distance of each point of [`Selection::Nearest`] from the vertex that it chooses, metres.
    pub(crate) fn distances(&self, points: &[[f64; 3]]) -> Vec<f64> {
        match self {
            Self::Nearest(wanted) => wanted.iter().map(|p| nearest(points, p).1).collect(),
            _ => Vec::new(),
        }
    }
}

pub(crate) fn by_number(
    numbers: &[usize],
    key: &Key,
    count: usize,
) -> Result<Vec<VertexId>, Problem> {
    check_numbers(numbers, &key.name("vertices"), ("vertex", count))?;
    Ok(numbers.iter().map(|&n| VertexId::from_index(n)).collect())
}

/// Whether all numbers are of what there is of a kind in the sheet.
fn check_numbers(
    numbers: &[usize],
    key: &Key,
    (kind, count): (&str, usize),
) -> Result<(), Problem> {
    match numbers.iter().position(|&n| n >= count) {
        None => Ok(()),
        Some(k) => Err(Problem::new(
            key.entry(k),
            format!("there is no {kind} {}: the sheet has {count}", numbers[k]),
            format!("give numbers from 0 to {}", count - 1),
        )),
    }
}

/// The vertex that is nearest to a point, and its distance.
pub(crate) fn nearest(points: &[[f64; 3]], wanted: &[f64; 3]) -> (VertexId, f64) {
    let distance2 = |p: &[f64; 3]| -> f64 { (0..3).map(|k| (p[k] - wanted[k]).powi(2)).sum() };
    let (mut best, mut least) = (0, f64::INFINITY);
    for (i, p) in points.iter().enumerate() {
        let d = distance2(p);
        if d < least {
            (best, least) = (i, d);
        }
    }
    (VertexId::from_index(best), least.sqrt())
}

/// How far a point is from a plane on the side that its normal points to, metres.
fn height(p: &[f64; 3], point: &[f64; 3], normal: &[f64; 3]) -> f64 {
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    (0..3).map(|k| normal[k] * (p[k] - point[k])).sum::<f64>() / length
}

/// The point that is nearest to what selects none, and by how much it misses, as the end of a message.
pub(crate) fn nearest_in_words(points: &[[f64; 3]], distance: impl Fn(&[f64; 3]) -> f64) -> String {
    let distances = points.iter().map(|p| (distance(p), p));
    match distances.min_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((distance, p)) => format!(
            ": the nearest one, at {}, is {} m away",
            place(p),
            brief(distance)
        ),
        None => String::new(),
    }
}

/// Largest distance of a vertex from a line that it is on, as a part of the size of the sheet: that within
/// which lines of a drawing are one. Programs that draw write hundredths of a point, which are 3.5
/// micrometres.
pub(crate) const ON_LINE: f64 = 1e-4;

/// The place of a point beside the line between two points, 0 where that begins and 1 where it ends, and its
/// distance from the line, metres.
pub(crate) fn beside_line(p: &[f64; 3], [from, to]: [&[f64; 3]; 2]) -> (f64, f64) {
    let along: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
    let length2: f64 = along.iter().map(|c| c * c).sum();
    let part: f64 = (0..3).map(|k| along[k] * (p[k] - from[k])).sum::<f64>() / length2;
    let nearest = part.clamp(0.0, 1.0);
    let distance2: f64 = (0..3)
        .map(|k| (from[k] + nearest * along[k] - p[k]).powi(2))
        .sum();
    (part, distance2.sqrt())
}

/// Largest extent of some points along an axis, metres.
pub fn size(points: &[[f64; 3]]) -> f64 {
    let [low, high] = bounds(points);
    (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max)
}

/// Smallest and largest coordinates of some points, metres.
pub fn bounds<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for p in points {
        for k in 0..3 {
            bounds[0][k] = bounds[0][k].min(p[k]);
            bounds[1][k] = bounds[1][k].max(p[k]);
        }
    }
    bounds
}
