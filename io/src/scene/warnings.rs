//! What of a scene may not do what was meant.

use super::placed::PlacedSheets;
use super::selection::{self, Selection};
use super::setup::Setup;
use super::warning::SceneWarning;
use super::{Key, Mesh, Quantity, Scene};
use isosheet_dynamics::Isometry;
use isosheet_mesh::{Sheet, VertexId};

/// Width from which the unit of lengths is questioned, metres: hardly a sheet is larger than a big tent, and
/// files in millimetres, points or pixels are.
const WIDE: f64 = 20.0;

impl SceneWarning {
    /// Closed parts of a sheet of rods.
    pub(crate) fn closed(sheet: &Sheet) -> Option<Self> {
        let t = sheet.topology();
        let parts = t.components();
        let is_closed = |part: &&Vec<VertexId>| !part.iter().any(|&v| t.is_boundary_vertex(v));
        let closed = parts.iter().filter(is_closed).count();
        (closed > 0).then_some(Self::Closed {
            closed,
            parts: parts.len(),
        })
    }

    /// A sheet of a file whose unit is not the metre, as it seems.
    pub(crate) fn wide_file(sheet: &Sheet) -> Option<Self> {
        let width = selection::size(sheet.positions().as_chunks::<3>().0);
        (width > WIDE).then_some(Self::WideFile { width })
    }
}

impl PlacedSheets<'_> {
    /// What to know of the sheets, and of how a scene names their vertices.
    pub(super) fn warnings(&self, scene: &Scene) -> Vec<SceneWarning> {
        let of_sheets = self.list.iter().flat_map(|sheet| {
            let wide = match &sheet.of.mesh {
                // A scale says that the unit was thought of.
                Mesh::File(file) if file.scale != 1.0 => None,
                Mesh::File(_) => SceneWarning::wide_file(&sheet.form.placed),
                _ => {
                    let width = selection::size(sheet.form.placed.positions().as_chunks::<3>().0);
                    let key = sheet.key.clone();
                    (width > WIDE).then_some(SceneWarning::Wide { key, width })
                }
            };
            let reversed = match (&sheet.of.mesh, sheet.form.changes.reversed_faces) {
                (Mesh::File(file), faces @ 1..) => Some(SceneWarning::ReversedFaces {
                    path: file.path.clone(),
                    faces,
                }),
                _ => None,
            };
            wide.into_iter().chain(reversed)
        });
        of_sheets.chain(self.far_points(scene)).collect()
    }

    /// Points that choose vertices which are far away.
    fn far_points(&self, scene: &Scene) -> Vec<SceneWarning> {
        let mut selections: Vec<(Key, Option<&String>, &Selection)> = Vec::new();
        let entry = |name: &str, k: usize| Key::root().name(name).entry(k);
        for (k, support) in scene.support.iter().enumerate() {
            let key = entry("support", k).name("at");
            selections.push((key, support.sheet.as_ref(), &support.at));
        }
        for (k, load) in scene.forces.load.iter().enumerate() {
            let key = entry("forces.load", k).name("at");
            selections.push((key, load.sheet.as_ref(), &load.at));
        }
        for (k, weight) in scene.weight.iter().enumerate() {
            let key = entry("weight", k).name("at");
            selections.push((key, weight.sheet.as_ref(), &weight.at));
        }
        for (k, measure) in scene.measure.iter().enumerate() {
            let (key, sheet) = (entry("measure", k), measure.sheet.as_ref());
            selections.push((key.name("at"), sheet, &measure.at));
            if let Quantity::DistanceTo(others) = &measure.quantity {
                selections.push((key.name("quantity.distance_to"), sheet, others));
            }
        }
        let far = selections.into_iter().flat_map(|(key, sheet, at)| {
            let points = self.start_of(sheet).as_chunks::<3>().0;
            let width = selection::size(points);
            let distances = at.distances(points).into_iter().enumerate();
            let far = distances.filter(move |(_, distance)| *distance > width);
            far.map(move |(k, distance)| SceneWarning::FarPoint {
                key: key.name("nearest").entry(k),
                distance,
                width,
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
    pub fn warnings(&self) -> Vec<SceneWarning> {
        let mut warnings = self.of_sheets.clone();
        if self.model.isometry() == Isometry::Rods {
            warnings.extend(SceneWarning::closed(&self.sheet));
        }
        for clamp in self.model.clamps_across_the_mesh(&self.start.x) {
            let pins = clamp.edge.iter().filter_map(|v| self.origins.pins.get(v));
            let mut supports: Vec<usize> = pins.copied().collect();
            supports.sort_unstable();
            supports.dedup();
            warnings.push(SceneWarning::ClampAcrossMesh {
                supports,
                edge: clamp.edge,
            });
        }
        warnings
    }
}
