//! The mesh that a file has.

use super::assignment::EdgeAssignment;
use super::error::MeshFileError;
use super::face_groups::FaceGroups;
use isosheet_drawings::DrawnLines;
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::wording::counted;
use isosheet_mesh::{Sheet, Topology, VertexId};
use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::path::{Path, PathBuf};

/// An edge of a FOLD file, or a diagonal of one of its polygons.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FileCrease {
    /// The vertices at its ends, from 0.
    pub ends: [u32; 2],
    /// What it is meant to do; diagonals stay flat.
    pub assignment: EdgeAssignment,
    /// The fold angle that the file gives, in radians within [-pi, pi], positive for a valley.
    pub angle: Option<f64>,
    /// Where it follows lines of a drawing, which: see [`MeshFile::drawn`].
    pub drawn: Option<u32>,
}

impl FileCrease {
    /// An edge that follows no line of a drawing.
    pub fn new(ends: [u32; 2], assignment: EdgeAssignment, angle: Option<f64>) -> Self {
        Self {
            ends,
            assignment,
            angle,
            drawn: None,
        }
    }
}

/// What reading changed besides cutting polygons into triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadingChanges {
    /// Vertices that were welded to another one.
    pub welded_vertices: usize,
    /// Faces that were removed because two of their corners were welded.
    pub collapsed_faces: usize,
    /// Faces of flat crease patterns that were clockwise and have been reversed, with the mountains, valleys
    /// and fold angles at them.
    pub reversed_faces: usize,
    /// Faces of FOLD files that were left out because creases are sides of none of them. The faces that the
    /// edges enclose take their place.
    pub replaced_faces: usize,
    /// Vertices that were added because the sheet is cut there.
    pub vertices_at_cuts: usize,
    /// Lines of drawings that were divided where others cross them or end on them.
    pub divided_lines: usize,
    /// Lines of drawings that were left out because they lead nowhere.
    pub loose_lines: usize,
    /// Lines of drawings, inside the sheet, that are cuts or drawn as the outline and were left out because
    /// they lead nowhere.
    pub loose_cuts: usize,
    /// Lines of drawings that were left out because they lie on others.
    pub double_lines: usize,
    /// Edges of drawings where creases that are meant to do different things lie on each other, which fold
    /// freely.
    pub contradicting_lines: usize,
    /// Lines of drawings that were left out because their colours mean nothing in a crease pattern.
    pub other_lines: usize,
    /// Edges of FOLD files that are named boundary and have faces on both sides, which stay joined.
    pub inner_boundaries: usize,
}

impl ReadingChanges {
    /// Whether nothing was changed.
    pub fn is_nothing(&self) -> bool {
        *self == Self::default()
    }
}

/// What was changed, in words; nothing if nothing was.
impl fmt::Display for ReadingChanges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const VERTICES: [&str; 2] = ["vertex", "vertices"];
        const FACES: [&str; 2] = ["face", "faces"];
        const LINES: [&str; 2] = ["line", "lines"];
        let changes = [
            (self.welded_vertices, VERTICES, "welded"),
            (self.collapsed_faces, FACES, "without area removed"),
            (
                self.reversed_faces,
                FACES,
                "reversed, clockwise in the file, with the mountains and valleys at them",
            ),
            (
                self.replaced_faces,
                FACES,
                "of the file replaced by the faces that its edges enclose, as they leave out creases",
            ),
            (self.vertices_at_cuts, VERTICES, "added at cuts"),
            (self.divided_lines, LINES, "divided where others meet"),
            (
                self.loose_lines,
                ["line that leads nowhere", "lines that lead nowhere"],
                "left out",
            ),
            (
                self.loose_cuts,
                [
                    "of them is a cut inside the sheet",
                    "of them are cuts inside the sheet",
                ],
                "(`isosheet mesh` cuts slits)",
            ),
            (
                self.double_lines,
                ["line that lies on another", "lines that lie on others"],
                "left out",
            ),
            (
                self.contradicting_lines,
                ["edge folds", "edges fold"],
                "freely, with a mountain on a valley or with two angles",
            ),
            (
                self.other_lines,
                LINES,
                "left out, of colours that mean nothing in a crease pattern",
            ),
            (
                self.inner_boundaries,
                ["edge stays", "edges stay"],
                "joined that are named boundary inside the sheet (cuts are named C)",
            ),
        ];
        let made = changes.iter().filter(|(count, ..)| *count > 0);
        let made =
            made.map(|&(count, [one, more], what)| format!("{} {what}", counted(count, one, more)));
        f.write_str(&made.collect::<Vec<_>>().join(", "))
    }
}

/// The vertices and triangles of a mesh file, as numbered there (from 0), not yet checked to be a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Coordinates x0 y0 z0 x1 ..., in the file's unit and axes. Two formats say what these are, and are
    /// converted: FOLD files with a unit of length to metres; glTF files, which have y upwards, to z upwards.
    pub positions: Vec<f64>,
    /// Whether the file says how long its unit is: then the positions are in metres.
    pub in_metres: bool,
    /// Triangles, as wound in the file.
    pub faces: Vec<[u32; 3]>,
    /// How many faces had more than three corners and were cut.
    pub polygons: usize,
    /// The cuts of these: edges that are not in the file, inside of what was one flat panel.
    pub diagonals: Vec<[u32; 2]>,
    /// The edges of a FOLD file and the diagonals; empty for other formats.
    pub creases: Vec<FileCrease>,
    /// How the lines of the drawing are drawn that the edges follow, of drawings and of FOLD files that were
    /// made of one.
    pub drawn: DrawnLines,
    /// The groups of triangles that the file names: in OBJ files by groups, objects and materials; in PLY
    /// files by properties of faces, as `property=value`; in glTF files by nodes, meshes and materials; in
    /// FOLD files by the key `faces_isosheet:group`.
    pub groups: FaceGroups,
    /// Of each triangle the texture coordinates of its corners, where the file has them; empty if it has
    /// none.
    pub texture: Vec<Option<[[f64; 2]; 3]>>,
    /// What reading changed.
    pub changes: ReadingChanges,
    /// What of a drawing was left out because it is no line that is understood, with its number: texts,
    /// images, what is hidden, and shapes of colours that are not known.
    pub left_out: BTreeMap<String, usize>,
    pub(super) path: PathBuf,
    /// The time that a VTK file gives its polygons, in its unit.
    pub(super) time: Option<f64>,
}

impl MeshFile {
    /// A mesh that is in no file.
    pub fn of_frame(positions: Vec<f64>, faces: Vec<[u32; 3]>, creases: Vec<FileCrease>) -> Self {
        Self {
            positions,
            in_metres: true,
            faces,
            polygons: 0,
            diagonals: Vec::new(),
            creases,
            drawn: DrawnLines::default(),
            groups: FaceGroups::default(),
            texture: Vec::new(),
            changes: ReadingChanges::default(),
            left_out: BTreeMap::new(),
            path: PathBuf::new(),
            time: None,
        }
    }

    /// What reading changed and left out, in words; `None` if nothing.
    pub fn what_reading_did(&self) -> Option<String> {
        let changes = (!self.changes.is_nothing()).then(|| self.changes.to_string());
        let left_out = self.left_out.iter();
        let left_out = left_out.map(|(what, count)| format!("left out: {what} ({count})"));
        let told: Vec<String> = changes.into_iter().chain(left_out).collect();
        (!told.is_empty()).then(|| told.join(", "))
    }

    /// Makes the diagonals of polygons edges that stay flat.
    pub(super) fn add_diagonals(&mut self) {
        let diagonal = |&ends: &[u32; 2]| FileCrease {
            ends,
            assignment: EdgeAssignment::Flat,
            angle: Some(0.0),
            drawn: None,
        };
        self.creases.extend(self.diagonals.iter().map(diagonal));
    }

    /// The number of vertices, used or not.
    pub fn vertex_count(&self) -> usize {
        self.positions.len() / 3
    }

    /// The file that the mesh was read from; empty for a frame of a run.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The time that the file gives the mesh, in its unit.
    pub(crate) fn time(&self) -> Option<f64> {
        self.time
    }

    /// Removes vertices that belong to no face and renumbers the rest in order; returns how many were
    /// removed.
    pub fn drop_unreferenced(&mut self) -> usize {
        let mut used = vec![false; self.vertex_count()];
        for &v in self.faces.iter().flatten() {
            used[v as usize] = true;
        }
        let mut label = vec![0u32; used.len()];
        let mut kept = Vec::with_capacity(self.positions.len());
        for (v, _) in used.iter().enumerate().filter(|(_, u)| **u) {
            label[v] = (kept.len() / 3) as u32;
            kept.extend_from_slice(&self.positions[3 * v..3 * v + 3]);
        }
        self.diagonals
            .retain(|e| e.iter().all(|&v| used[v as usize]));
        self.creases
            .retain(|c| c.ends.iter().all(|&v| used[v as usize]));
        self.relabel(&label);
        let removed = used.len() - kept.len() / 3;
        self.positions = kept;
        removed
    }

    /// Keeps some of the faces, with what the file says of them; returns how many are removed.
    pub(super) fn retain_faces(&mut self, mut keep: impl FnMut(&[u32; 3]) -> bool) -> usize {
        let kept: Vec<bool> = self.faces.iter().map(&mut keep).collect();
        let numbers: Vec<u32> = (0..)
            .zip(&kept)
            .filter(|(_, kept)| **kept)
            .map(|(k, _)| k)
            .collect();
        let removed = self.faces.len() - numbers.len();
        if removed > 0 {
            let mut of_faces = kept.iter();
            self.faces.retain(|_| of_faces.next() == Some(&true));
            let mut of_texture = kept.iter();
            self.texture.retain(|_| of_texture.next() == Some(&true));
            self.groups = self.groups.of_parts(&numbers);
        }
        removed
    }

    /// Gives each vertex that faces and edges refer to a new number.
    pub(super) fn relabel(&mut self, label: &[u32]) {
        let edges = self.diagonals.iter_mut().flatten();
        let creases = self.creases.iter_mut().flat_map(|c| &mut c.ends);
        for v in self.faces.iter_mut().flatten().chain(edges).chain(creases) {
            *v = label[*v as usize];
        }
    }

    /// Unites creases between two vertices to one, which is unassigned where they are meant to do different
    /// things. Removes creases whose ends have become one vertex.
    pub(super) fn unite_creases(&mut self) {
        let mut first: HashMap<[u32; 2], usize> = HashMap::new();
        let mut united: Vec<FileCrease> = Vec::new();
        for crease in &self.creases {
            let [a, b] = crease.ends;
            if a == b {
                continue;
            }
            match first.entry([a.min(b), a.max(b)]) {
                Entry::Vacant(place) => {
                    place.insert(united.len());
                    united.push(*crease);
                }
                Entry::Occupied(place) => {
                    let other = &mut united[*place.get()];
                    if (other.assignment, other.angle) != (crease.assignment, crease.angle) {
                        (other.assignment, other.angle) = (EdgeAssignment::Unassigned, None);
                    }
                }
            }
        }
        self.creases = united;
    }

    /// Checks that the faces are an oriented surface of rigid triangles, and makes it a sheet.
    ///
    /// # Errors
    /// [`MeshFileProblem::Mesh`](super::MeshFileProblem::Mesh) with the file's name. Indices in it are
    /// counted from 0.
    pub fn into_sheet(self) -> Result<Sheet, MeshFileError> {
        let Self {
            positions,
            faces,
            path,
            ..
        } = self;
        Sheet::new(positions, &faces).map_err(|e| MeshFileError {
            path,
            place: None,
            problem: e.into(),
        })
    }

    /// What each edge of a topology of the faces is meant to do; `None` unless the file is a FOLD file with
    /// edges, and for an edge inside the sheet that the file leaves unassigned.
    pub fn fold_assignments(&self, t: &Topology) -> Option<Vec<Option<FoldAssignment>>> {
        if self.creases.is_empty() {
            return None;
        }
        let mut assignments = vec![None; t.edge_count()];
        for crease in &self.creases {
            let [a, b] = crease.ends.map(VertexId);
            let inside = a.index().max(b.index()) < t.vertex_count();
            if let Some(e) = inside.then(|| t.find_edge(a, b)).flatten() {
                assignments[e.index()] = match crease.assignment {
                    EdgeAssignment::Mountain => Some(FoldAssignment::Mountain),
                    EdgeAssignment::Valley => Some(FoldAssignment::Valley),
                    EdgeAssignment::Flat | EdgeAssignment::Join => Some(FoldAssignment::Flat),
                    EdgeAssignment::Boundary | EdgeAssignment::Unassigned | EdgeAssignment::Cut => {
                        None
                    }
                };
            }
        }
        for e in t.edge_ids().filter(|&e| t.is_boundary_edge(e)) {
            assignments[e.index()] = Some(FoldAssignment::Boundary);
        }
        Some(assignments)
    }
}
