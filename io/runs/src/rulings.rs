//! Rulings and Gauss curvatures of recorded frames.

use super::Recording;
use super::frame_field::FrameField;
use isosheet_dynamics::FaceCurvature;
use isosheet_formats::{FrameData, FrameQuantity, MotionFrame, MotionFrames};
use isosheet_mesh::{EdgeId, Part, Sheet, Topology, VertexId};
use isosheet_page::{Centering, Field, Scale};
use isosheet_scenes::Facts;
use std::cell::OnceCell;
use std::ops::ControlFlow;
use std::rc::Rc;

/// The rulings of the frames of a run, one frame after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedRulings {
    /// Of each face the unit vector along its ruling, three numbers; zero where it has none
    /// ([`Ruling`](isosheet_mesh::Ruling)).
    pub directions: Vec<f64>,
    /// Of each face the principal curvature across its ruling, 1/m, positive for valleys; 0 where it has
    /// none.
    pub curvatures: Vec<f64>,
    /// Of each vertex the Gauss curvature besides that of the rest shape, 1/m2
    /// ([`GaussCurvature`](isosheet_mesh::GaussCurvature)).
    pub gauss_curvatures: Vec<f64>,
}

/// How the sheets of a run are curved. Bodies beside them have no values.
struct Curvatures<'a> {
    topology: &'a Topology,
    of_faces: FaceCurvature,
    /// Number of faces and of vertices of the sheets.
    sheets: [usize; 2],
}

impl<'a> Curvatures<'a> {
    /// Of the sheets of a run, so many.
    fn of(facts: &'a Facts, count: usize) -> Option<Self> {
        let held = (&facts.pins[..], &facts.creased[..]);
        Self::new(&facts.sheet, &facts.parts, count, held)
    }

    /// Of the first parts, so many, of the union of sheets and bodies, with pinned vertices and creases;
    /// nothing if their fits cannot be made, which no run asks for.
    fn new(
        sheet: &'a Sheet,
        parts: &[(String, Part)],
        count: usize,
        (pins, creases): (&[VertexId], &[EdgeId]),
    ) -> Option<Self> {
        let topology = sheet.topology();
        let sheets = match parts.get(count.wrapping_sub(1)) {
            Some((_, part)) => [part.faces.end, part.vertices.end],
            None => [topology.face_count(), topology.vertex_count()],
        };
        let pins: Vec<VertexId> = pins
            .iter()
            .copied()
            .filter(|v| v.index() < sheets[1])
            .collect();
        let of_faces = FaceCurvature::new(sheet, &pins, creases);
        Some(Self {
            topology,
            of_faces: of_faces.ok()?,
            sheets,
        })
    }

    /// The rulings of the faces, three numbers for each, and the curvatures across them.
    fn rulings(&self, x: &[f64]) -> [Vec<f64>; 2] {
        let (mut directions, mut curvatures) = (Vec::new(), Vec::new());
        for (face, ruling) in self.of_faces.rulings(x).into_iter().enumerate() {
            let own = ruling.filter(|_| face < self.sheets[0]);
            directions.extend(own.map_or([0.0; 3], |own| own.direction));
            curvatures.push(own.map_or(0.0, |own| own.curvature));
        }
        [directions, curvatures]
    }

    /// The Gauss curvatures of the vertices.
    fn gauss(&self, x: &[f64]) -> Vec<f64> {
        let mut values = self.of_faces.gauss().at(self.topology, x);
        values[self.sheets[1]..].fill(0.0);
        values
    }
}

/// The frames of a run with their rulings, which are made when a frame is shown.
pub(super) struct RuledFrames<'a, M> {
    frames: &'a M,
    curvatures: Curvatures<'a>,
}

impl<'a, M> RuledFrames<'a, M> {
    /// Of the frames of a run with so many sheets.
    pub(super) fn new(frames: &'a M, facts: &'a Facts, sheets: usize) -> Option<Self> {
        let curvatures = Curvatures::of(facts, sheets)?;
        Some(Self { frames, curvatures })
    }
}

impl<M: MotionFrames> MotionFrames for RuledFrames<'_, M> {
    type Error = M::Error;

    fn each(
        &self,
        show: &mut dyn FnMut(&MotionFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), M::Error> {
        self.frames.each(&mut |frame| {
            let [rulings, ruling_curvatures] = self.curvatures.rulings(frame.x);
            show(&MotionFrame {
                data: FrameData {
                    rulings: &rulings,
                    ruling_curvatures: &ruling_curvatures,
                    gauss_curvatures: &self.curvatures.gauss(frame.x),
                    ..frame.data
                },
                ..*frame
            })
        })
    }
}

impl Recording {
    /// How its sheets are curved.
    fn curvatures_of_sheets(&self) -> Option<Curvatures<'_>> {
        Curvatures::of(&self.facts, self.scene.scene().sheet.len())
    }

    /// The rulings of all frames, which are made of their positions; nothing if no curvatures can be fitted.
    pub fn rulings(&self) -> Option<RecordedRulings> {
        let of = self.curvatures_of_sheets()?;
        let mut all = RecordedRulings::default();
        for x in (0..self.trajectory.len()).filter_map(|k| self.trajectory.frame(k)) {
            let [directions, curvatures] = of.rulings(x);
            all.directions.extend(directions);
            all.curvatures.extend(curvatures);
            all.gauss_curvatures.extend(of.gauss(x));
        }
        Some(all)
    }

    /// Gives the frames of the trajectory their rulings
    /// ([`Trajectory::rulings`](isosheet_formats::Trajectory::rulings)), for files that have room for them.
    pub fn add_rulings(&mut self) {
        let Some(all) = self.rulings() else {
            return;
        };
        let trajectory = &mut self.trajectory;
        trajectory.set_all(FrameQuantity::Rulings, all.directions);
        trajectory.set_all(FrameQuantity::RulingCurvatures, all.curvatures);
        trajectory.set_all(FrameQuantity::GaussCurvatures, all.gauss_curvatures);
    }

    /// The curvature across the rulings, and the Gauss curvature, as fields. What they need is made when the
    /// first value is asked for.
    pub(super) fn curvature_fields(&self) -> [FrameField<'_>; 2] {
        let field = |name: &str, unit: &str, place, note: &str| Field {
            name: name.into(),
            unit: unit.into(),
            place,
            scale: Scale::Signed,
            note: note.into(),
            values: Vec::new(),
        };
        let across = field(
            "curvature (valley +)",
            "1/m",
            Centering::Face,
            "The principal curvature across the ruling of each face; 0 where it is not bent beyond noise.",
        );
        let gauss = field(
            "Gauss curvature",
            "1/m²",
            Centering::Vertex,
            "Besides that of the rest shape: how far the sheet is from developable.",
        );
        let known: Rc<OnceCell<Option<Curvatures<'_>>>> = Rc::default();
        let same = Rc::clone(&known);
        let (faces, vertices) = {
            let topology = self.sheet.topology();
            (topology.face_count(), topology.vertex_count())
        };
        [
            FrameField::new(across, move |frame| {
                let known = known.get_or_init(|| self.curvatures_of_sheets()).as_ref();
                known.map_or_else(|| vec![0.0; faces], |own| own.rulings(frame.x)[1].clone())
            }),
            FrameField::new(gauss, move |frame| {
                let known = same.get_or_init(|| self.curvatures_of_sheets()).as_ref();
                known.map_or_else(|| vec![0.0; vertices], |own| own.gauss(frame.x))
            }),
        ]
    }
}
