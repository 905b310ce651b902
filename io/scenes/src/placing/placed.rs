//! The sheets of a scene in their places, and the union of them that is simulated.

use crate::meshes::direction::{Direction, FaceTexture, gradients};
use crate::meshes::mesh::RestMesh;
use crate::meshes::mesh_file::{Files, MeshFileKey};
use crate::meshes::pattern::EdgeRoles;
use crate::meshes::selection::InPlace;
use crate::sheets::patched::patched;
use crate::sheets::refined::Refined;
use crate::sheets::several;
use crate::sheets::several::sheet_key;
use crate::words::error::SceneError;
use crate::words::problem::Problem;
use crate::words::resolution::check_shape;
use crate::{Key, Selection, SheetKey, Weight};
use isosheet_dynamics::Patched;
use isosheet_formats::{FaceGroups, ReadingChanges};
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{FaceId, MassKind, MassMatrix, MeshError, Part, Sheet, VertexId};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// What is made of the mesh of a sheet, its division, its place and its start.
#[derive(Debug)]
pub(crate) struct Form {
    /// The rest shape, placed in space.
    pub(crate) placed: Sheet,
    /// The rest shape as its mesh has it.
    pub(crate) unplaced: Refined,
    /// What the edges of the refined mesh are meant to do.
    pub(crate) roles: Option<EdgeRoles>,
    /// What reading its file changed.
    pub(crate) changes: ReadingChanges,
    /// The groups of its faces that its file names.
    groups: FaceGroups,
    /// The texture coordinates of the faces of its mesh, if that has any.
    texture: Vec<FaceTexture>,
    /// Positions at the start, `3V`.
    start: Vec<f64>,
    /// Velocities at the start beside the velocity of the sheet as a whole, `3V`.
    pub(crate) velocities: Option<Vec<f64>>,
    /// Positions of the shape whose curvature it has.
    pub(crate) curled: Option<Vec<f64>>,
}

/// A sheet in its place.
pub(crate) struct PlacedSheet<'a> {
    /// What the scene says of it.
    pub(crate) of: Cow<'a, SheetKey>,
    pub(crate) key: Key,
    pub(crate) form: Arc<Form>,
    /// Where it is in the union.
    pub(crate) part: Part,
    /// What it is, and what its patches are as sheets.
    pub(crate) patched: Patched<SheetKey>,
    mass: MassMatrix,
}

/// All sheets.
pub(crate) struct PlacedSheets<'a> {
    pub(crate) list: Vec<PlacedSheet<'a>>,
    pub(crate) union: Sheet,
    /// Positions at the start, `3V`.
    pub(crate) start: Vec<f64>,
    /// The groups of faces that files name.
    groups: FaceGroups,
}

impl<'a> PlacedSheets<'a> {
    /// Puts sheets in their places. Their forms are made where `forms` has none yet.
    pub(crate) fn new(
        sheets: &'a [SheetKey],
        forms: &mut Vec<Arc<Form>>,
        files: &mut Files,
    ) -> Result<Self, SceneError> {
        if forms.is_empty() {
            let numbered = sheets.iter().enumerate();
            let made = numbered.map(|(k, of)| {
                let form = Form::new(of, &sheet_key(sheets.len(), k), files)?;
                Ok(Arc::new(form))
            });
            *forms = made.collect::<Result<_, Problem>>()?;
        }
        let shapes: Vec<&Sheet> = forms.iter().map(|form| &form.placed).collect();
        let union = match shapes[..] {
            [sheet] => sheet.clone(),
            _ => Sheet::union(&shapes)
                .map_err(|e| Problem::from_error(Key::root().name("sheet"), &e))?,
        };
        let parts = Part::of_union(&shapes);
        let of_forms = forms.iter().zip(&parts);
        let groups =
            FaceGroups::union(of_forms.map(|(form, part)| (&form.groups, part.faces.start)));
        let numbered = sheets.iter().zip(&*forms).zip(parts).enumerate();
        let list = numbered.map(|(k, ((of, form), part))| {
            let key = sheet_key(sheets.len(), k);
            let of = with_texture(of, form, &key)?;
            let patched = patched(&of, &form.in_place(), &key)?;
            let mass = match (of.mass, &of.patch[..]) {
                (None, [_, ..]) => of_densities(form, &patched),
                (mass, _) => {
                    let by_area = of.areal_density() * form.placed.area();
                    let mass = mass.unwrap_or(by_area);
                    MassMatrix::from_total(&form.placed, mass, MassKind::Lumped)
                }
            };
            let mass = mass.map_err(|e| Problem::from_error(key.clone(), &e))?;
            Ok(PlacedSheet {
                of,
                key,
                form: form.clone(),
                part,
                patched,
                mass,
            })
        });
        let starts: Vec<&[f64]> = forms.iter().map(|form| &form.start[..]).collect();
        Ok(Self {
            list: list.collect::<Result<_, Problem>>()?,
            union,
            start: starts.concat(),
            groups,
        })
    }

    /// What each edge of the union is meant to do, if there is a crease pattern among the meshes; `None` for
    /// an edge of which the pattern does not say it.
    pub(crate) fn fold_assignments(&self) -> Option<Vec<Option<FoldAssignment>>> {
        let of_sheet = |sheet: &PlacedSheet<'_>| match &sheet.form.roles {
            Some(roles) => roles.assignments.clone(),
            None => vec![None; sheet.form.placed.topology().edge_count()],
        };
        let all: Vec<_> = self.list.iter().flat_map(of_sheet).collect();
        all.iter().any(Option::is_some).then_some(all)
    }

    /// The masses of the sheets with weights.
    pub(crate) fn mass(&self, weights: &[Weight]) -> Result<MassMatrix, Problem> {
        let masses: Vec<MassMatrix> = self.list.iter().map(|sheet| sheet.mass.clone()).collect();
        let mut mass = MassMatrix::union(&masses);
        for (key, weight) in Key::root().name("weight").entries(weights) {
            let vertices = self.vertices(weight.sheet.as_deref(), &weight.at, &key)?;
            for v in &vertices {
                mass.vertex[v.index()] += weight.mass / vertices.len() as f64;
            }
        }
        Ok(mass)
    }

    /// The rate of the velocity damping of each sheet, with its vertices.
    pub(crate) fn dampings(&self) -> impl Iterator<Item = (Range<usize>, f64)> {
        let sheets = self.list.iter();
        sheets.map(|sheet| (sheet.part.vertices.clone(), sheet.of.damping))
    }

    /// The vertices of a selection in the sheet of a name, or in all sheets.
    pub(crate) fn vertices(
        &self,
        name: Option<&str>,
        selection: &Selection,
        key: &Key,
    ) -> Result<Vec<VertexId>, Problem> {
        let all = self.list.iter().map(|sheet| &*sheet.of);
        let at = key.name("at");
        let number = match selection {
            Selection::Vertices(_) => Some(several::one_of(all, name, key, "the vertices")?),
            Selection::Faces(_) => Some(several::one_of(all, name, key, "the faces")?),
            _ => several::number_of(all, name, &key.name("sheet"))?,
        };
        let Some(number) = number else {
            let place = InPlace {
                topology: self.union.topology(),
                x: &self.start,
                groups: &self.groups,
            };
            return selection.resolve(&at, &place);
        };
        let PlacedSheet { form, part, .. } = &self.list[number];
        let found = selection.resolve(&at, &form.in_place())?;
        Ok(found.into_iter().map(|v| part.vertex(v)).collect())
    }

    /// The sheet of a name, which has to be given if there are several.
    pub(crate) fn one(
        &self,
        name: Option<&str>,
        key: &Key,
        what: &str,
    ) -> Result<&PlacedSheet<'a>, Problem> {
        let all = self.list.iter().map(|sheet| &*sheet.of);
        several::one_of(all, name, key, what).map(|k| &self.list[k])
    }
}

/// A sheet with the direction that the texture of its mesh gives to each face, if it is meant.
fn with_texture<'a>(
    of: &'a SheetKey,
    form: &Form,
    key: &Key,
) -> Result<Cow<'a, SheetKey>, Problem> {
    let Some(Direction::Texture(texture)) = of.direction else {
        return Ok(Cow::Borrowed(of));
    };
    let mesh = form.unplaced.mesh();
    let of_mesh = gradients(mesh, &form.texture, texture, &key.name("direction"))?;
    let faces = form.unplaced.faces_of_mesh().into_iter();
    let placed = faces.map(|face| of.placed(of_mesh[face as usize]));
    Ok(Cow::Owned(SheetKey {
        direction: Some(Direction::Faces(Arc::new(placed.collect()))),
        ..of.clone()
    }))
}

/// The masses of a sheet with patches.
fn of_densities(form: &Form, patched: &Patched<SheetKey>) -> Result<MassMatrix, MeshError> {
    let densities = patched.map(SheetKey::areal_density);
    let of_faces = densities.of_faces(form.placed.topology().face_count());
    let of_faces = of_faces.expect("patches have faces of their sheet");
    let density = |face: FaceId| *of_faces[face.index()];
    MassMatrix::from_densities(&form.placed, density, MassKind::Lumped)
}

impl Form {
    /// The sheet where it starts.
    fn in_place(&self) -> InPlace<'_> {
        InPlace {
            topology: self.placed.topology(),
            x: &self.start,
            groups: &self.groups,
        }
    }

    fn new(of: &SheetKey, key: &Key, files: &mut Files) -> Result<Self, Problem> {
        let mesh_key = key.name("mesh");
        let RestMesh {
            sheet,
            roles,
            groups,
            texture,
            changes,
        } = of.mesh.build(&mesh_key, files)?;
        let unplaced = Refined::new(sheet, of.refine, &key.name("refine"))?;
        let pose = &of.placement;
        let placed = unplaced
            .sheet()
            .map_positions(|p| pose.place(p))
            .map_err(|e| Problem::from_error(mesh_key.clone(), &e))?;
        check_shape(&placed, &mesh_key.name(of.mesh.name()))?;
        // Positions of a file with the same mesh, in space.
        let mut shape = |file: &MeshFileKey, key: Key| {
            let shape = files.read(file, &key)?;
            if triangles(&shape.faces) != triangles(&unplaced.mesh().face_indices()) {
                let message = "the file does not have the vertices and faces of `sheet.mesh`";
                let remedy = "export both shapes from the same mesh, without reordering";
                return Err(Problem::new(key.name("path"), message, remedy));
            }
            let x = unplaced.positions(shape.positions.clone());
            let points = x.as_chunks::<3>().0.iter();
            Ok(points.flat_map(|&p| pose.place(p)).collect())
        };
        // Values of the vertices of the mesh.
        let listed = |values: &[[f64; 3]], key: Key| {
            let (count, vertices) = (values.len(), unplaced.mesh().topology().vertex_count());
            if count == vertices {
                return Ok(unplaced.positions(values.as_flattened().to_vec()));
            }
            let message = format!("`{key}` has {count} entries, and the mesh {vertices} vertices");
            let remedy = "give one for each vertex, in the order of the mesh";
            Err(Problem::new(key, message, remedy))
        };
        let start = match (&of.start.file, &of.start.positions) {
            (Some(file), _) => shape(file, key.name("start.file"))?,
            (None, Some(positions)) => {
                let x = listed(positions, key.name("start.positions"))?;
                let points = x.as_chunks::<3>().0.iter();
                points.flat_map(|&p| pose.place(p)).collect()
            }
            (None, None) => placed.positions().to_vec(),
        };
        let velocities = of.start.velocities.as_ref();
        let velocities = velocities.map(|v| listed(v, key.name("start.velocities")));
        let velocities = velocities.transpose()?;
        let curled = of.curl.as_ref().and_then(|curl| curl.shape.as_ref());
        let curled = curled.map(|file| shape(file, key.name("curl.shape")));
        let curled = curled.transpose()?;
        Ok(Self {
            roles: roles.map(|roles| unplaced.roles(roles)),
            groups: groups.of_parts(&unplaced.faces_of_mesh()),
            texture,
            placed,
            unplaced,
            changes,
            start,
            velocities,
            curled,
        })
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
