//! Fields of a page, frame by frame.

use isosheet_collide::Obstacle;
use isosheet_dynamics::{ElasticDeformation, SheetModel};
use isosheet_files::DataError;
use isosheet_formats::{FrameQuantity, MotionFrame};
use isosheet_mesh::Sheet;
use isosheet_page::{Centering, Field, Scale, strains};
use isosheet_scenes::{FoldTargets, Origins, off_target};
use nalgebra::Point3;
use std::borrow::Cow;

/// A field whose values are made of each frame of a motion.
pub struct FrameField<'a> {
    /// The field without values.
    pub head: Field,
    values: Box<Values<'a>>,
}

/// The name of the field of the bends beside creases.
const CREASE_BEND: &str = "bend beside creases (valley +)";

/// The values in a frame.
type Values<'a> = dyn Fn(&MotionFrame<'_>) -> Vec<f64> + 'a;

impl<'a> FrameField<'a> {
    pub(super) fn new(head: Field, values: impl Fn(&MotionFrame<'_>) -> Vec<f64> + 'a) -> Self {
        Self {
            head,
            values: Box::new(values),
        }
    }

    /// The fields of a motion of a sheet among obstacles: the strain of the edges (none of obstacles that
    /// deform), the distance to obstacles, and of each quantity that `has` names what a page shows of it.
    pub(super) fn all(
        sheet: &Sheet,
        origins: &Origins,
        obstacles: &'a [Obstacle],
        has: impl Fn(FrameQuantity) -> bool,
    ) -> Vec<Self> {
        let strain = strains(sheet.topology(), sheet.positions());
        let driven = origins.driven_parts().map(|part| part.edges.clone());
        let driven: Vec<_> = driven.collect();
        let of_sheets = move |frame: &MotionFrame<'_>| {
            let mut strains = strain(frame.x);
            for edges in &driven {
                strains[edges.clone()].fill(0.0);
            }
            strains
        };
        let mut fields = vec![Self::new(Field::strain(), of_sheets)];
        if !obstacles.is_empty() {
            fields.push(Self::obstacle_distance(obstacles));
        }
        let shown = [
            (FrameQuantity::RodForces, Self::rod_force()),
            (FrameQuantity::ContactForces, Self::contact_force()),
            (FrameQuantity::Gaps, Self::gap()),
            (FrameQuantity::PlasticCurvatures, Self::plastic_curvature()),
            (FrameQuantity::PlasticAngles, Self::plastic_angle()),
            (FrameQuantity::CreaseBends, Self::crease_bend()),
        ];
        let shown = shown.into_iter().filter(|(quantity, _)| has(*quantity));
        fields.extend(shown.map(|(_, field)| field));
        fields
    }

    /// The values in a frame of a motion.
    pub fn values(&self, frame: &MotionFrame<'_>) -> Vec<f64> {
        (self.values)(frame)
    }

    /// The distance of each vertex from the nearest obstacle, metres. The thickness of the sheet is not
    /// subtracted, and a face or an edge may be nearer to an obstacle than its vertices are; the series
    /// "smallest gap" has both.
    fn obstacle_distance(obstacles: &'a [Obstacle]) -> Self {
        let head = Field {
            name: "distance to obstacles".into(),
            unit: "m".into(),
            place: Centering::Vertex,
            scale: Scale::Logarithmic,
            note: String::new(),
            values: Vec::new(),
        };
        Self::new(head, |frame| {
            let into_body: Vec<_> = obstacles
                .iter()
                .map(|body| (body.shape(), body.motion().pose(frame.t).inverse()))
                .collect();
            let distance = |p: &[f64; 3]| {
                let distances = into_body.iter().map(|(shape, pose)| {
                    let local = pose * Point3::from(*p);
                    shape.signed_distance(&local.coords).value.abs()
                });
                distances.fold(f64::INFINITY, f64::min)
            };
            frame.x.as_chunks::<3>().0.iter().map(distance).collect()
        })
    }

    /// The force of the rod along each edge, newtons, tension positive.
    fn rod_force() -> Self {
        let head = Field {
            name: "rod force (tension +)".into(),
            unit: "N".into(),
            place: Centering::Edge,
            scale: Scale::Signed,
            note: "Where rods depend on each other, as in a flat part of the sheet, their forces are not unique."
                .into(),
            values: Vec::new(),
        };
        Self::new(head, |frame| frame.data.rod_forces.to_vec())
    }

    /// The size of the force of contact on each vertex, newtons: of bodies and of the sheet on itself.
    fn contact_force() -> Self {
        let head = Field {
            name: "contact force".into(),
            unit: "N".into(),
            place: Centering::Vertex,
            scale: Scale::Magnitude,
            note: String::new(),
            values: Vec::new(),
        };
        let size = |f: &[f64; 3]| f[0].hypot(f[1]).hypot(f[2]);
        Self::new(head, move |frame| {
            let forces = frame.data.contact_forces.as_chunks::<3>().0;
            forces.iter().map(size).collect()
        })
    }

    /// The gap of each vertex, metres.
    fn gap() -> Self {
        let head = Field {
            name: "gap".into(),
            unit: "m".into(),
            place: Centering::Vertex,
            scale: Scale::Linear,
            note: String::new(),
            values: Vec::new(),
        };
        Self::new(head, |frame| frame.data.gaps.to_vec())
    }

    /// Of plates the principal value of the plastic curvature of each face that is larger in size, 1/m.
    fn plastic_curvature() -> Self {
        let head = plastic("curvature that stays (valley +)", "1/m", Centering::Face);
        Self::new(head, |frame| {
            let pairs = frame.data.plastic_curvatures.as_chunks::<2>().0;
            pairs.iter().map(|p| p[0]).collect()
        })
    }

    /// Of edges that yield the plastic angle, degrees.
    fn plastic_angle() -> Self {
        let head = plastic("angle that stays (valley +)", "°", Centering::Crease);
        Self::new(head, |frame| {
            let angles = frame.data.plastic_angles.iter();
            angles.map(|a| a.to_degrees()).collect()
        })
    }

    /// The bend of the faces beside each crease, degrees.
    fn crease_bend() -> Self {
        let head = Field {
            name: CREASE_BEND.into(),
            unit: "°".into(),
            place: Centering::Crease,
            scale: Scale::Signed,
            note: "The angle between the faces at a crease is its fold angle and this bend of the faces.".into(),
            values: Vec::new(),
        };
        Self::new(head, |frame| {
            let bends = frame.data.crease_bends.iter();
            bends.map(|bend| bend.to_degrees()).collect()
        })
    }

    /// The number of the field that has the bends beside creases.
    pub(super) fn of_bends(fields: &[Self]) -> Option<usize> {
        fields
            .iter()
            .position(|field| field.head.name == CREASE_BEND)
    }

    /// The difference of each crease from the angle that a scene folds it to, degrees; none of other edges.
    pub(super) fn open(sheet: &'a Sheet, targets: &'a FoldTargets) -> Self {
        let head = Field {
            name: "crease short of its angle".into(),
            unit: "°".into(),
            place: Centering::Crease,
            scale: Scale::Linear,
            note: "How far each crease is from the angle that it is folded to in the end.".into(),
            values: Vec::new(),
        };
        let topology = sheet.topology();
        Self::new(head, move |frame| {
            let mut values = vec![0.0; topology.edge_count()];
            for &(e, target) in &targets.creases {
                values[e.index()] = off_target(topology, frame.x, e, target);
            }
            values
        })
    }

    /// The strain of each face of an elastic sheet, and the part of stretching in its elastic energy, of so
    /// many faces of sheets and bodies; none for sheets of rods.
    pub(super) fn elastic(model: &'a SheetModel, faces: usize) -> Vec<Self> {
        if model.elastic_sheet().is_none() {
            return Vec::new();
        }
        let field = |name: &str, scale, note: &str| Field {
            name: name.into(),
            unit: String::new(),
            place: Centering::Face,
            scale,
            note: note.into(),
            values: Vec::new(),
        };
        let strain = field(
            "strain of faces",
            Scale::Logarithmic,
            "The norm of Green's strain of each face, which the limit of the sheet bounds.",
        );
        let share = field(
            "share of stretching",
            Scale::Linear,
            "The part of stretching in the elastic energy of each face; the rest is bending. Where a mesh is fine \
             enough, a sheet that carries no load in its plane has little of it.",
        );
        let shares = |d: ElasticDeformation| (0..d.strain.len()).map(|f| d.share(f)).collect();
        // Bodies do not deform.
        let of_all = move |mut values: Vec<f64>| {
            values.resize(faces, 0.0);
            values
        };
        // What is plastic, and the barrier at the limit, are not in the frames.
        let memories = model.memories();
        let deformed = move |frame: &MotionFrame<'_>| {
            let mut x = Cow::Borrowed(frame.x);
            if x.len() != model.coordinate_count() {
                // After the vertices of sheets the vertices of bodies, wherever they are.
                x.to_mut().resize(model.coordinate_count(), 0.0);
            }
            model.elastic_deformation(frame.t, &x, &memories)
        };
        let strains = deformed.clone();
        vec![
            Self::new(strain, move |frame| {
                let deformation = strains(frame);
                of_all(deformation.map(|d| d.strain).unwrap_or_default())
            }),
            Self::new(share, move |frame| {
                let deformation = deformed(frame);
                of_all(deformation.map(shares).unwrap_or_default())
            }),
        ]
    }
}

/// A field of what has yielded, without values.
fn plastic(name: &str, unit: &str, place: Centering) -> Field {
    Field {
        name: name.into(),
        unit: unit.into(),
        place,
        scale: Scale::Signed,
        note: "What has yielded, and stays where no moment acts.".into(),
        values: Vec::new(),
    }
}

/// Checks that a frame is one of a sheet.
pub(super) fn check_frame(frame: &MotionFrame<'_>, sheet: &Sheet) -> Result<(), DataError> {
    let (got, expected) = (frame.x.len(), sheet.positions().len());
    if got == expected {
        return Ok(());
    }
    let number = frame.number;
    let message =
        format!("the positions of frame {number}: the length is {got} and has to be {expected}");
    Err(DataError::plain(message).at(number))
}
