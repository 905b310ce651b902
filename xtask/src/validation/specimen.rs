//! Sheets of experiments: what they are made of, their meshes, how they are held and loaded.

use super::experiment::Job;
use crate::runs::meshes::{vertices, with_line};
use anyhow::Result;
use isosheet_dynamics::{
    AccelerationField, LineClamp, Material, PlateBending, PlateEdges, PlateLaw, Profile,
    RigidDisplacement, SheetModel,
};
use isosheet_mesh::{MassKind, Sheet, VertexId};

/// A sheet of one square metre that weighs 1 kg, of a rigidity (N m) and a Poisson's ratio, and of the
/// thickness (metres) that an isotropic plate has with its membrane stiffness.
pub(super) fn material(rigidity: f64, poisson: f64, thickness: f64) -> Material {
    let mut material = Material::office_paper();
    material.density = 1.0;
    material.rigidity = rigidity;
    material.poisson = poisson;
    material.stiffness = 12.0 * rigidity * (1.0 - poisson * poisson) / (thickness * thickness);
    material
}

/// A sheet and the vertices of its clamp.
pub(super) struct Clamped {
    pub(super) sheet: Sheet,
    pub(super) clamp: Vec<VertexId>,
}

impl Job {
    /// A rectangle from the origin.
    pub(super) fn rectangle(self, [length, width]: [f64; 2]) -> Result<Sheet> {
        let cell = width.min(length) / self.across as f64;
        self.mesh.rectangle([0.0; 2], [length, width], cell)
    }

    /// A rectangle from the origin with one more column of cells before it, which is the clamp.
    pub(super) fn cantilever(self, [length, width]: [f64; 2]) -> Result<Clamped> {
        let cell = width.min(length) / self.across as f64;
        let sheet = self.mesh.rectangle([-cell, 0.0], [length, width], cell)?;
        let sheet = with_line(&sheet, 0.0, cell)?;
        let clamp = vertices(&sheet, |[x, ..]| x < 1e-9 * length);
        Ok(Clamped { sheet, clamp })
    }

    /// A rectangle between two clamps, each of one column of cells.
    pub(super) fn between_clamps(self, [length, width]: [f64; 2]) -> Result<Clamped> {
        let cell = width.min(length) / self.across as f64;
        let sheet = self
            .mesh
            .rectangle([-cell, 0.0], [length + cell, width], cell)?;
        let sheet = with_line(&sheet, 0.0, cell)?;
        let sheet = with_line(&sheet, length, cell)?;
        let room = 1e-9 * length;
        let clamp = vertices(&sheet, |[x, ..]| x < room || x > length - room);
        Ok(Clamped { sheet, clamp })
    }
}

/// A line of mesh edges: the part of each vertex of its length.
pub(super) struct Line(Vec<f64>);

impl Line {
    /// The edges both of whose ends pass a test at their positions in the sheet.
    pub(super) fn new(sheet: &Sheet, test: impl Fn([f64; 3]) -> bool) -> Self {
        let topology = sheet.topology();
        let mut parts = vec![0.0; topology.vertex_count()];
        let mut whole = 0.0;
        for ends in topology.edges() {
            let places = ends.map(|v| sheet.position(v));
            if places.iter().all(|p| test(*p)) {
                let [a, b] = places;
                let length: f64 = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
                whole += length;
                for v in ends {
                    parts[v.index()] += 0.5 * length;
                }
            }
        }
        assert!(whole > 0.0, "no edge is on the line");
        Self(parts.into_iter().map(|part| part / whole).collect())
    }

    /// The edge of a sheet where a coordinate has a value.
    pub(super) fn at(sheet: &Sheet, k: usize, value: f64) -> Self {
        Self::new(sheet, |p| (p[k] - value).abs() < 1e-9 * (1.0 + value.abs()))
    }

    /// A force of so many newtons, spread evenly.
    pub(super) fn load(&self, force: f64, along: [f64; 3]) -> Result<AccelerationField> {
        self.load_of(Profile::Constant(force), along)
    }

    /// A force that follows a profile, newtons, spread evenly.
    pub(super) fn load_of(&self, force: Profile, along: [f64; 3]) -> Result<AccelerationField> {
        Ok(AccelerationField::new(self.0.clone(), along, force)?)
    }

    /// The mean of a coordinate of positions.
    pub(super) fn mean(&self, x: &[f64], k: usize) -> f64 {
        let places = x.as_chunks::<3>().0.iter();
        places.zip(&self.0).map(|(p, part)| part * p[k]).sum()
    }

    /// The mean displacement from the rest shape along a coordinate.
    pub(super) fn moved(&self, sheet: &Sheet, x: &[f64], k: usize) -> f64 {
        self.mean(x, k) - self.mean(sheet.positions(), k)
    }
}

/// The bending stiffness of a plate that lines of vertices clamp.
pub(super) fn clamped_along(
    sheet: &Sheet,
    law: impl Into<PlateLaw>,
    line: &[VertexId],
) -> Result<PlateBending> {
    let clamp = LineClamp {
        vertices: line.to_vec(),
        positions: sheet.positions().to_vec(),
        motion: RigidDisplacement::default().into(),
    };
    let edges = PlateEdges {
        clamps: &[clamp],
        ..PlateEdges::default()
    };
    Ok(PlateBending::held(sheet, law, &edges)?)
}

/// The model of a sheet whose material gives mass and stiffness in the plane, with pinned vertices and a
/// bending stiffness of its own.
pub(super) fn with_plate(
    sheet: &Sheet,
    material: &Material,
    pins: &[VertexId],
    plate: PlateBending,
) -> Result<SheetModel> {
    let mass = material.density * sheet.area();
    let model = SheetModel::new(sheet, mass, MassKind::Lumped)?.with_pins(pins)?;
    let model = model.with_elastic_sheet(material.elastic_sheet(sheet, &plate)?)?;
    Ok(model.with_potential(plate))
}

/// The vertices on the outline.
pub(super) fn boundary(sheet: &Sheet) -> Vec<VertexId> {
    sheet.topology().boundary_loops().concat()
}
