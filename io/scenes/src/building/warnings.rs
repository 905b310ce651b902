//! What of a scene may not do what was meant.

use crate::building::setup::Setup;
use crate::meshes::selection;
use crate::placing::placed::{PlacedSheet, PlacedSheets};
use crate::whole::selections::Selected;
use crate::words::warning::Warning;
use crate::{IsometryKey, MaterialKey, Mesh, Scene};
use isosheet_mesh::wording::{brief, counted, given};
use isosheet_mesh::{Sheet, VertexId};

/// Width from which the unit of lengths is questioned, metres: hardly a sheet is larger than a big tent, and
/// files in millimetres, points or pixels are.
const WIDE: f64 = 20.0;

impl Warning {
    /// Closed parts of a sheet of rods, which is called by a name.
    pub fn closed(sheet: &Sheet, name: &str) -> Option<Self> {
        let t = sheet.topology();
        let parts = t.components();
        let is_closed = |part: &&Vec<VertexId>| !part.iter().any(|&v| t.is_boundary_vertex(v));
        let closed = parts.iter().filter(is_closed).count();
        (closed > 0).then(|| {
            let what = match closed == parts.len() {
                true => format!("{name} is closed"),
                false => format!(
                    "{closed} of the {} parts of {name} are closed surfaces",
                    parts.len()
                ),
            };
            let message = format!("{what}: a sheet of rigid rods without a boundary cannot bend");
            Self::new(
                message,
                "cut it open along some edges, or make it an obstacle",
            )
        })
    }

    /// A sheet of a file whose unit is not the metre, as it seems.
    pub fn wide_file(sheet: &Sheet) -> Option<Self> {
        let width = selection::size(sheet.positions().as_chunks::<3>().0);
        (width > WIDE).then(|| {
            let message = format!(
                "the sheet is {} m wide, as the numbers of a file are taken for metres",
                brief(width)
            );
            let remedy =
                "of a file in millimetres write `scale = 0.001` beside `path` in the scene";
            Self::new(message, remedy)
        })
    }
}

/// Part of the width of a sheet from which its thickness is questioned.
const THICK: f64 = 0.1;

/// A drawing whose mesh has edges that are longer than the sheet.
fn coarse(sheet: &PlacedSheet<'_>) -> Option<Warning> {
    let Mesh::Drawing(drawing) = &sheet.of.mesh else {
        return None;
    };
    let width = selection::size(sheet.form.placed.positions().as_chunks::<3>().0);
    (drawing.spacing > 2.0 * width).then(|| {
        let message = format!(
            "`{}` is {} m, and the sheet is {} m wide",
            sheet.key.name("mesh.drawing.spacing"),
            given(drawing.spacing),
            brief(width)
        );
        Warning::new(message, "give it in metres: 5 mm are 0.005")
    })
}

/// A thickness whose unit is not the metre, as it seems.
fn thick(sheet: &PlacedSheet<'_>) -> Option<Warning> {
    let of_material = match &sheet.of.material {
        Some(MaterialKey::Plate(plate)) => {
            Some((sheet.key.name("material.thickness"), plate.thickness))
        }
        _ => None,
    };
    let own = (sheet.key.name("thickness"), sheet.of.thickness);
    let width = selection::size(sheet.form.placed.positions().as_chunks::<3>().0);
    let mut all = of_material.into_iter().chain([own]);
    let (key, thickness) = all.find(|(_, thickness)| *thickness > THICK * width)?;
    let message = format!(
        "`{key}` is {} m, and the sheet is {} m wide",
        given(thickness),
        brief(width)
    );
    Some(Warning::new(message, "give it in metres: 0.5 mm are 5e-4"))
}

impl PlacedSheets<'_> {
    /// What to know of the sheets, and of how a scene names their vertices.
    pub(crate) fn warnings(&self, scene: &Scene) -> Vec<Warning> {
        let of_sheets = self.list.iter().flat_map(|sheet| {
            let wide = match &sheet.of.mesh {
                // A scale says that the unit was thought of.
                Mesh::File(file) if file.scale != 1.0 => None,
                Mesh::File(_) => Warning::wide_file(&sheet.form.placed),
                _ => {
                    let width = selection::size(sheet.form.placed.positions().as_chunks::<3>().0);
                    let message = format!("`{}` is {} m wide", sheet.key, brief(width));
                    (width > WIDE).then_some(Warning::new(message, "give lengths in metres"))
                }
            };
            let reversed = match (&sheet.of.mesh, sheet.form.changes.reversed_faces) {
                (Mesh::File(file), count @ 1..) => {
                    let message = format!(
                        "{} of {} are clockwise: they were reversed, with the mountains and valleys at them",
                        counted(count, "face", "faces"),
                        file.path.display()
                    );
                    let remedy = "a valley folds towards the side from which its faces are counter-clockwise in the \
                                  file: if the sheet folds the wrong way, list the faces counter-clockwise there";
                    Some(Warning::new(message, remedy))
                }
                _ => None,
            };
            let soft = match &sheet.of.material {
                Some(MaterialKey::Plate(plate)) => plate.warning(&sheet.key.name("material")),
                _ => None,
            };
            let changed = wide.into_iter().chain(reversed);
            let slips = soft.into_iter().chain(coarse(sheet)).chain(thick(sheet));
            changed.chain(slips)
        });
        let rods = self.list.iter();
        let rods = rods.filter(|sheet| sheet.of.isometry() == IsometryKey::Rods);
        let closed = rods.filter_map(|sheet| {
            let name = match &self.list[..] {
                [_] => "the surface".to_owned(),
                _ => format!("the surface of `{}`", sheet.key),
            };
            Warning::closed(&sheet.form.placed, &name)
        });
        of_sheets
            .chain(scene.doubts())
            .chain(self.far_points(scene))
            .chain(closed)
            .collect()
    }

    /// Points that choose vertices which are far away.
    fn far_points(&self, scene: &Scene) -> Vec<Warning> {
        let selections = scene.selections().into_iter();
        let far = selections.flat_map(|Selected { key, sheet, at }| {
            let points = self.start_of(sheet).as_chunks::<3>().0;
            let width = selection::size(points);
            let distances = at.distances(points).into_iter().enumerate();
            let far = distances.filter(move |(_, distance)| *distance > width);
            far.map(move |(k, distance)| {
                let message = format!(
                    "`{}` is {} m away from the nearest vertex, and the sheet is {} m wide",
                    key.name("nearest").entry(k),
                    brief(distance),
                    brief(width)
                );
                let remedy = "give coordinates in metres of where the sheet is at the start: `isosheet info` gives its \
                              bounds";
                Warning::new(message, remedy)
            })
        });
        far.collect()
    }

    /// The positions at the start of the sheet of a name, or of all.
    fn start_of(&self, name: Option<&String>) -> &[f64] {
        let named = self
            .list
            .iter()
            .find(|s| name.is_some() && s.of.name.as_ref() == name);
        named.map_or(&self.start, |sheet| &self.start[sheet.part.coordinates()])
    }
}

impl Setup {
    /// What to know before the scene is run.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = self.of_sheets.clone();
        for clamp in self.model.clamps_across_the_mesh(&self.start.x) {
            let pins = clamp.edge.iter().filter_map(|v| self.origins.pins.get(v));
            let mut supports: Vec<usize> = pins.copied().collect();
            supports.sort_unstable();
            supports.dedup();
            let keys = supports.iter().map(|k| format!("`support[{k}]`"));
            let message = format!(
                "no line of edges of the mesh runs along the clamp by {}: the {} beside its free part are on no line, \
                 so that the rods cannot fold there, and most such sheets lock",
                keys.collect::<Vec<_>>().join(" and "),
                counted(clamp.edge.len(), "vertex", "vertices")
            );
            let remedy = "name what the sheet is made of, `sheet.material`, which makes it elastic; or make a mesh with \
                          a line of edges along the clamp";
            warnings.push(Warning::new(message, remedy));
        }
        warnings
    }
}
