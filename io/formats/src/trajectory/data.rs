//! What frames have besides positions.

use isosheet_files::DataError;
use isosheet_mesh::wording::given;

/// What a frame has besides its positions. An empty slice says that there is nothing of its kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameData<'a> {
    /// Forces of the rods (length E, newtons, tension positive).
    pub rod_forces: &'a [f64],
    /// Force of contact on each vertex (length 3V, newtons).
    pub contact_forces: &'a [f64],
    /// Gap of each vertex (length V, metres).
    pub gaps: &'a [f64],
    /// Plastic angle of each edge (length E, radians, positive for valleys).
    pub plastic_angles: &'a [f64],
    /// Bend of the faces beside each crease, which the angle between them includes (length E, radians,
    /// positive for valleys, 0 at other edges).
    pub crease_bends: &'a [f64],
    /// Unit vector along the ruling of each face (length 3F), zero where there is none.
    pub rulings: &'a [f64],
    /// Principal curvature across the ruling of each face (length F, 1/m, positive for valleys), 0 where
    /// there is none.
    pub ruling_curvatures: &'a [f64],
    /// Gauss curvature at each vertex besides that of the rest shape (length V, 1/m2).
    pub gauss_curvatures: &'a [f64],
    /// Principal values of the plastic curvature of each face (length 2F, 1/m, the larger one in size first,
    /// positive for valleys).
    pub plastic_curvatures: &'a [f64],
}

impl<'a> FrameData<'a> {
    /// What a function has of each quantity.
    pub fn each(of: impl Fn(FrameQuantity) -> &'a [f64]) -> Self {
        Self {
            rod_forces: of(FrameQuantity::RodForces),
            contact_forces: of(FrameQuantity::ContactForces),
            gaps: of(FrameQuantity::Gaps),
            plastic_angles: of(FrameQuantity::PlasticAngles),
            plastic_curvatures: of(FrameQuantity::PlasticCurvatures),
            crease_bends: of(FrameQuantity::CreaseBends),
            rulings: of(FrameQuantity::Rulings),
            ruling_curvatures: of(FrameQuantity::RulingCurvatures),
            gauss_curvatures: of(FrameQuantity::GaussCurvatures),
        }
    }
}

/// How large a mesh is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshCounts {
    /// Vertices.
    pub vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Faces.
    pub faces: usize,
}

/// One kind of data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameQuantity {
    /// Axial force of each edge.
    RodForces,
    /// Force of contact at each vertex.
    ContactForces,
    /// Gap of each vertex.
    Gaps,
    /// Plastic angle of each edge.
    PlasticAngles,
    /// Plastic curvature of each face.
    PlasticCurvatures,
    /// Bend of the faces beside each crease.
    CreaseBends,
    /// Ruling of each face.
    Rulings,
    /// Curvature across the ruling of each face.
    RulingCurvatures,
    /// Gauss curvature at each vertex.
    GaussCurvatures,
}

impl FrameQuantity {
    /// How many there are.
    pub const COUNT: usize = 9;

    /// All, in the order of the enumeration.
    pub const ALL: [Self; Self::COUNT] = [
        Self::RodForces,
        Self::ContactForces,
        Self::Gaps,
        Self::PlasticAngles,
        Self::PlasticCurvatures,
        Self::CreaseBends,
        Self::Rulings,
        Self::RulingCurvatures,
        Self::GaussCurvatures,
    ];

    /// The name of its array in a file.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::RodForces => "rod_forces",
            Self::ContactForces => "contact_forces",
            Self::Gaps => "gaps",
            Self::PlasticAngles => "plastic_angles",
            Self::PlasticCurvatures => "plastic_curvatures",
            Self::CreaseBends => "crease_bends",
            Self::Rulings => "rulings",
            Self::RulingCurvatures => "ruling_curvatures",
            Self::GaussCurvatures => "gauss_curvatures",
        }
    }

    /// The shape of one frame of it on a mesh.
    pub(super) fn shape(self, mesh: MeshCounts) -> Vec<u64> {
        match self {
            Self::RodForces | Self::PlasticAngles | Self::CreaseBends => vec![mesh.edges as u64],
            Self::ContactForces => vec![mesh.vertices as u64, 3],
            Self::Gaps | Self::GaussCurvatures => vec![mesh.vertices as u64],
            Self::Rulings => vec![mesh.faces as u64, 3],
            Self::RulingCurvatures => vec![mesh.faces as u64],
            Self::PlasticCurvatures => vec![mesh.faces as u64, 2],
        }
    }

    /// The numbers in one frame of it.
    pub fn size(self, mesh: MeshCounts) -> usize {
        let shape = self.shape(mesh);
        shape.iter().product::<u64>() as usize
    }

    /// What a frame has of it.
    pub fn of<'a>(self, data: &FrameData<'a>) -> &'a [f64] {
        match self {
            Self::RodForces => data.rod_forces,
            Self::ContactForces => data.contact_forces,
            Self::Gaps => data.gaps,
            Self::PlasticAngles => data.plastic_angles,
            Self::PlasticCurvatures => data.plastic_curvatures,
            Self::CreaseBends => data.crease_bends,
            Self::Rulings => data.rulings,
            Self::RulingCurvatures => data.ruling_curvatures,
            Self::GaussCurvatures => data.gauss_curvatures,
        }
    }

    /// Checks the values of a frame that follows others: as many as these have, all finite.
    pub(super) fn check(
        self,
        values: &[f64],
        frame: usize,
        expected: usize,
    ) -> Result<(), DataError> {
        let (array, got) = (self.name(), values.len());
        if got != expected {
            let message =
                format!("frame {frame} has {got} values of `{array}` where {expected} are needed");
            let error = DataError::new(message, "give them in all frames or in none");
            return Err(error.at(frame));
        }
        match values.iter().position(|f| !f.is_finite()) {
            None => Ok(()),
            Some(index) => {
                let what = format!("value {index} of `{array}`");
                Err(not_finite(&what, frame, values[index]))
            }
        }
    }
}

/// A number of a frame that is not finite.
pub(super) fn not_finite(what: &str, frame: usize, value: f64) -> DataError {
    let value_in_words = given(value);
    let message =
        format!("{what} in frame {frame} is {value_in_words}, and the frame was not recorded");
    let error = DataError::new(message, "go back to the last state that was finite");
    error.at(frame).value(value)
}
