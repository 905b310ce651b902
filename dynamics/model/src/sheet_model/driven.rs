//! Surfaces in prescribed motion among the vertices of a model.

use super::SheetModel;
use isosheet_mesh::{EdgeId, VertexId};

impl SheetModel {
    /// The mass of a vertex of a surface in prescribed motion, kilograms: the smallest there is, which no sum
    /// with masses of sheets notices.
    pub const DRIVEN_MASS: f64 = f64::MIN_POSITIVE;

    /// Says that the vertices from this one on belong to surfaces in prescribed motion, such as obstacles
    /// that deform: their edges have no length to keep, neither as rods nor in the strain of the sheets, and
    /// their [masses](SheetModel::DRIVEN_MASS) do not count in the mean of all. All of them have to be
    /// [pinned](SheetModel::with_moving_pin). Comes after [`SheetModel::with_bodies_from`], which is called
    /// with the same vertex where there are no bodies.
    ///
    /// # Panics
    /// If no vertex is before it.
    #[must_use]
    pub fn with_driven_from(mut self, first: VertexId) -> Self {
        assert!(first.index() > 0, "there are sheets before the surfaces");
        self.driven_from = first.index();
        let of_sheets = self.topology.edge_ids();
        let of_sheets: Vec<EdgeId> = of_sheets.filter(|e| !self.is_driven(*e)).collect();
        self.measured = Some(self.edges.of_edges(&of_sheets));
        self.mean_mass = self.mass.total() / first.index() as f64;
        let was_rod = std::mem::take(&mut self.rod_edges);
        self.set_rods(|edge| was_rod.binary_search(&edge).is_ok());
        self
    }

    /// Makes rods of the edges of sheets and bodies that are to be.
    pub(super) fn set_rods(&mut self, is_rod: impl Fn(EdgeId) -> bool) {
        let edges = self.topology.edge_ids();
        self.rod_edges = edges.filter(|&e| is_rod(e) && !self.is_driven(e)).collect();
        self.rods = self.edges.of_edges(&self.rod_edges);
    }

    /// Whether an edge is of a surface in prescribed motion.
    fn is_driven(&self, edge: EdgeId) -> bool {
        let ends = self.topology.edges()[edge.index()];
        ends.iter().any(|v| v.index() >= self.driven_from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_materials::ElasticSheet;
    use isosheet_mesh::{MassKind, MassMatrix, Sheet, generate};

    /// A square sheet, and after it a triangle that is twice as large as at rest.
    #[test]
    fn driven_edges_are_no_rods_and_have_no_strain_and_no_mass() {
        let own = generate::isotropic_square(1, 1.0).unwrap();
        let triangle = Sheet::new(
            vec![0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0],
            &[[0, 1, 2]],
        );
        let both = Sheet::union(&[&own, &triangle.unwrap()]).unwrap();
        let mass = MassMatrix::from_total(&own, 0.5, MassKind::Lumped).unwrap();
        let driven = MassMatrix {
            vertex: vec![SheetModel::DRIVEN_MASS; 3],
            edge: None,
        };
        let mass = MassMatrix::union(&[mass, driven]);
        let first = VertexId::from_index(own.topology().vertex_count());
        let model = SheetModel::with_mass(&both, mass).unwrap();
        let model = model.with_bodies_from(first).with_driven_from(first);
        let alone = SheetModel::new(&own, 0.5, MassKind::Lumped).unwrap();
        assert_eq!(model.rod_edges(), alone.rod_edges());
        assert_eq!(model.mass().total(), alone.mass().total());
        assert_eq!(
            (model.mean_mass(), model.mean_length()),
            (alone.mean_mass(), alone.mean_length())
        );
        let mut x = both.positions().to_vec();
        x[3 * first.index()..].iter_mut().for_each(|c| *c *= 2.0);
        assert_eq!(model.max_strain(&x), 0.0);
        assert_eq!(model.constrained_strain(&x), 0.0);
        let v = x.iter().map(|_| 3.0).collect::<Vec<_>>();
        let energy = alone.kinetic_energy(&v[..3 * first.index()]);
        assert_eq!(model.kinetic_energy(&v), energy);
        // Nor are they rods of an elastic sheet.
        let elastic = ElasticSheet::new(&own, 1e5, 0.3).unwrap();
        let t = own.topology();
        let part = isosheet_mesh::Part {
            vertices: 0..t.vertex_count(),
            edges: 0..t.edge_count(),
            faces: 0..t.face_count(),
        };
        let elastic = ElasticSheet::union(vec![(elastic, part)], both.topology().face_count());
        assert!(model.with_elastic_sheet(elastic).unwrap().rods().is_empty());
    }
}
