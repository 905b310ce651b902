//! The sheets of a scene in their places, and the union of them that is simulated.

use super::error::SceneError;
use super::mesh::RestMesh;
use super::pattern::EdgeRoles;
use super::problem::Problem;
use super::refined::Refined;
use super::resolution::check_shape;
use super::sheets::sheet_key;
use super::{Key, Selection, Sheet as SheetOfScene, Weight, sheets};
use crate::format::ReadingChanges;
use isosheet_mesh::{MassKind, MassMatrix, Part, Sheet, VertexId};
use std::path::Path;

/// The mesh of a sheet as it is simulated, not placed yet.
pub(super) struct RefinedMesh {
    pub(super) refined: Refined,
    /// What the edges of the refined mesh are meant to do.
    pub(super) roles: Option<EdgeRoles>,
    /// What reading its file changed.
    pub(super) changes: ReadingChanges,
}

impl SheetOfScene {
    /// Makes the mesh and divides its faces; files are relative to `folder`.
    pub(super) fn refined(&self, key: &Key, folder: &Path) -> Result<RefinedMesh, Problem> {
        let RestMesh {
            sheet,
            roles,
            changes,
        } = self.mesh.build(&key.name("mesh"), folder)?;
        let refined = Refined::new(sheet, self.refine, &key.name("refine"))?;
        Ok(RefinedMesh {
            roles: roles.map(|roles| refined.roles(roles)),
            refined,
            changes,
        })
    }
}

/// A sheet in its place.
pub(super) struct PlacedSheet<'a> {
    /// What the scene says of it.
    pub(super) of: &'a SheetOfScene,
    pub(super) key: Key,
    /// The rest shape, placed in space.
    pub(super) placed: Sheet,
    /// The rest shape as its mesh has it.
    pub(super) unplaced: Refined,
    pub(super) roles: Option<EdgeRoles>,
    /// Where it is in the union.
    pub(super) part: Part,
    pub(super) mass: MassMatrix,
    /// What reading its file changed.
    pub(super) changes: ReadingChanges,
}

/// All sheets.
pub(super) struct PlacedSheets<'a> {
    pub(super) list: Vec<PlacedSheet<'a>>,
    pub(super) union: Sheet,
    /// Positions at the start, `3V`.
    pub(super) start: Vec<f64>,
}

impl<'a> PlacedSheets<'a> {
    pub(super) fn new(sheets: &'a [SheetOfScene], folder: &Path) -> Result<Self, SceneError> {
        let (mut list, mut start) = (Vec::new(), Vec::new());
        for (k, of) in sheets.iter().enumerate() {
            let (placed, x) = PlacedSheet::new(of, sheet_key(sheets.len(), k), folder)?;
            list.push(placed);
            start.extend(x);
        }
        let placed: Vec<&Sheet> = list.iter().map(|sheet| &sheet.placed).collect();
        let union = match placed[..] {
            [sheet] => sheet.clone(),
            _ => Sheet::union(&placed)
                .map_err(|e| Problem::from_error(Key::root().name("sheet"), &e))?,
        };
        let parts = Part::of_union(&placed);
        for (sheet, part) in list.iter_mut().zip(parts) {
            sheet.part = part;
        }
        Ok(Self { list, union, start })
    }

    /// The masses of the sheets with weights.
    pub(super) fn mass(&self, weights: &[Weight]) -> Result<MassMatrix, Problem> {
        let masses: Vec<MassMatrix> = self.list.iter().map(|sheet| sheet.mass.clone()).collect();
        let mut mass = MassMatrix::union(&masses);
        for (k, weight) in weights.iter().enumerate() {
            let key = Key::root().name("weight").entry(k);
            let vertices = self.vertices(weight.sheet.as_deref(), &weight.at, &key)?;
            for v in &vertices {
                mass.vertex[v.index()] += weight.mass / vertices.len() as f64;
            }
        }
        Ok(mass)
    }

    /// The vertices of a selection in the sheet of a name, or in all sheets.
    pub(super) fn vertices(
        &self,
        name: Option<&str>,
        selection: &Selection,
        key: &Key,
    ) -> Result<Vec<VertexId>, Problem> {
        let all = self.list.iter().map(|sheet| sheet.of);
        let at = key.name("at");
        let number = match selection {
            Selection::Vertices(_) => Some(sheets::one_of(all, name, key, "the vertices")?),
            _ => sheets::number_of(all, name, &key.name("sheet"))?,
        };
        let Some(number) = number else {
            return selection.resolve(&at, self.union.topology(), &self.start);
        };
        let PlacedSheet { placed, part, .. } = &self.list[number];
        let own = &self.start[part.coordinates()];
        let found = selection.resolve(&at, placed.topology(), own)?;
        Ok(found.into_iter().map(|v| part.vertex(v)).collect())
    }

    /// The sheet of a name, which has to be given if there are several.
    pub(super) fn one(
        &self,
        name: Option<&str>,
        key: &Key,
        what: &str,
    ) -> Result<&PlacedSheet<'a>, Problem> {
        let all = self.list.iter().map(|sheet| sheet.of);
        sheets::one_of(all, name, key, what).map(|k| &self.list[k])
    }
}

impl<'a> PlacedSheet<'a> {
    /// With its positions at the start. Its part is not known yet.
    fn new(of: &'a SheetOfScene, key: Key, folder: &Path) -> Result<(Self, Vec<f64>), SceneError> {
        let RefinedMesh {
            refined: unplaced,
            roles,
            changes,
        } = of.refined(&key, folder)?;
        let mesh_key = key.name("mesh");
        let pose = &of.placement;
        let placed = unplaced
            .sheet()
            .map_positions(|p| pose.place(p))
            .map_err(|e| Problem::from_error(mesh_key.clone(), &e))?;
        check_shape(&placed, &mesh_key.name(of.mesh.name()))?;
        let x = match &of.start.file {
            None => placed.positions().to_vec(),
            Some(file) => {
                let key = key.name("start.file");
                let start = file.read(&key, folder)?;
                if triangles(&start.faces) != triangles(&unplaced.mesh().face_indices()) {
                    let message = "the file does not have the vertices and faces of `sheet.mesh`";
                    let remedy = "export both shapes from the same mesh, without reordering";
                    return Err(Problem::new(key.name("path"), message, remedy).into());
                }
                let x = unplaced.positions(start.positions);
                let points = x.as_chunks::<3>().0.iter();
                points.flat_map(|&p| pose.place(p)).collect()
            }
        };
        let by_area = of.areal_density() * placed.area();
        let mass = of.mass.unwrap_or(by_area);
        let mass = MassMatrix::from_total(&placed, mass, MassKind::Lumped)
            .map_err(|e| Problem::from_error(key.clone(), &e))?;
        let sheet = Self {
            of,
            key,
            placed,
            roles,
            unplaced,
            part: Part::default(),
            mass,
            changes,
        };
        Ok((sheet, x))
    }
}

/// The triangles without order and orientation: frames of a FOLD file may list the same faces in other ways.
fn triangles(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut triangles = faces.to_vec();
    for corners in &mut triangles {
        corners.sort_unstable();
    }
    triangles.sort_unstable();
    triangles
}
