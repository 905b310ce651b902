//! The bodies of a scene in their places.

use crate::bodies::body::BodyKey;
use crate::bodies::carried::CarriedBody;
use crate::bodies::guides::{self, Guide};
use crate::bodies::obstacles::ShapeKey;
use crate::bodies::round_bodies;
use crate::meshes::mesh_file::Files;
use crate::meshes::selection::{InPlace, Selection};
use crate::placing::driven::DrivenObstacles;
use crate::placing::placed::PlacedSheets;
use crate::sheets::start::velocities;
use crate::words::key::Key;
use crate::words::problem::Problem;
use crate::words::resolution::check_shape;
use isosheet_collide as collide;
use isosheet_collide::RoundBody;
use isosheet_dynamics::contact::SurfacePoints;
use isosheet_dynamics::{
    BodyForce, BodyTorque, JointCoordinate, Profile, RigidBody, Solid, SolidError,
};
use isosheet_formats::FaceGroups;
use isosheet_geometry as geometry;
use isosheet_geometry::{BroadPhase, ContactMesh};
use isosheet_mesh::{MassMatrix, Part, Sheet, VertexId};
use nalgebra::{Point3, Vector3};

/// A body in its place.
pub(crate) struct PlacedBody<'a> {
    /// What the scene says of it.
    pub(crate) of: &'a BodyKey,
    pub(crate) key: Key,
    pub(crate) solid: Solid,
    pub(crate) body: RigidBody,
    /// The surface by which it touches, if that is round.
    round: Option<RoundBody>,
    /// The four vertices that carry it.
    tetrahedron: Sheet,
    /// Its first vertex in the model.
    pub(crate) first: VertexId,
    /// Where its surface is among the sheets and the surfaces of all bodies.
    pub(crate) part: Part,
}

/// All bodies.
pub(crate) struct PlacedBodies<'a> {
    pub(crate) list: Vec<PlacedBody<'a>>,
}

/// What is seen of sheets and bodies, and what touches: the sheets, and after them the surfaces of the bodies
/// and of obstacles that deform, whose vertices are points that the model carries.
pub(crate) struct Surface {
    pub(crate) sheet: Sheet,
    pub(crate) points: SurfacePoints,
}

impl<'a> PlacedBodies<'a> {
    /// Puts bodies in their places beside sheets.
    pub(crate) fn new(
        bodies: &'a [BodyKey],
        sheets: &PlacedSheets<'_>,
        files: &mut Files,
    ) -> Result<Self, Problem> {
        let t = sheets.union.topology();
        let mut end = [t.vertex_count(), t.edge_count(), t.face_count()];
        let mut list = Vec::new();
        for (k, (key, of)) in Key::root().name("body").entries(bodies).enumerate() {
            let shape = of.shape.build(&key.name("shape"), files)?;
            let solid = of.solid(&shape, &key)?;
            let moments = round_bodies::true_moments(&shape);
            let volume = moments.map_or_else(|| solid.volume(), |moments| moments.volume);
            let mass = of.mass.unwrap_or(of.density.unwrap_or_default() * volume);
            let body = match moments {
                Some(moments) => round_bodies::body(&moments, mass, &of.pose),
                None => RigidBody::of_solid(&solid, mass),
            };
            let body = body.map_err(|e| Problem::from_error(key.clone(), &e))?;
            let body = of.guided(body, &key)?;
            let own = solid.surface().topology();
            let counts = [own.vertex_count(), own.edge_count(), own.face_count()];
            let [vertices, edges, faces] = [0, 1, 2].map(|i| end[i]..end[i] + counts[i]);
            end = [vertices.end, edges.end, faces.end];
            list.push(PlacedBody {
                of,
                key,
                tetrahedron: body.tetrahedron(),
                body,
                round: round_bodies::surface(&shape, &of.pose),
                solid,
                first: VertexId::from_index(t.vertex_count() + 4 * k),
                part: Part {
                    vertices,
                    edges,
                    faces,
                },
            });
        }
        Ok(Self { list })
    }

    /// The mesh of the model: the sheets, after them what carries the bodies, and after that obstacles that
    /// deform.
    pub(crate) fn mesh(&self, sheets: &Sheet, driven: &DrivenObstacles) -> Result<Sheet, Problem> {
        self.beside(sheets, |body| &body.tetrahedron, driven)
    }

    /// The sheets, after them something of each body, and after that obstacles that deform.
    fn beside(
        &self,
        sheets: &Sheet,
        of: impl for<'b> Fn(&'b PlacedBody<'a>) -> &'b Sheet,
        driven: &DrivenObstacles,
    ) -> Result<Sheet, Problem> {
        if self.list.is_empty() && driven.list.is_empty() {
            return Ok(sheets.clone());
        }
        let all: Vec<&Sheet> = [sheets]
            .into_iter()
            .chain(self.list.iter().map(of))
            .chain(driven.sheets())
            .collect();
        let what = match self.list.is_empty() {
            true => "obstacle",
            false => "body",
        };
        Sheet::union(&all).map_err(|e| Problem::from_error(Key::root().name(what), &e))
    }

    /// The numbers of vertices, edges and faces of the sheets and the surfaces of the bodies, and of the
    /// vertices of the model.
    pub(crate) fn counts(&self, sheets: &Sheet) -> ([usize; 3], usize) {
        let t = sheets.topology();
        let of_sheets = [t.vertex_count(), t.edge_count(), t.face_count()];
        let last = self.list.last().map(|body| &body.part);
        let all =
            last.map(|part| [&part.vertices, &part.edges, &part.faces].map(|range| range.end));
        (
            all.unwrap_or(of_sheets),
            t.vertex_count() + 4 * self.list.len(),
        )
    }

    /// The masses of the model, given the masses of the sheets.
    pub(crate) fn mass(&self, sheets: &Sheet, of_sheets: MassMatrix) -> MassMatrix {
        if self.list.is_empty() {
            return of_sheets;
        }
        let bodies = self.list.iter().map(|body| body.body.mass_matrix());
        let mut all: Vec<MassMatrix> = [of_sheets].into_iter().chain(bodies).collect();
        if all.iter().any(|mass| mass.edge.is_some()) {
            // The others have couplings of zero.
            let own = self.list.iter().map(|body| &body.tetrahedron);
            let meshes = [sheets].into_iter().chain(own);
            for (mass, mesh) in all.iter_mut().zip(meshes) {
                let count = mesh.topology().edge_count();
                mass.edge.get_or_insert_with(|| vec![0.0; count]);
            }
        }
        MassMatrix::union(&all)
    }

    /// The positions at the start of the vertices of the model, after the sheets.
    pub(crate) fn start(&self) -> impl Iterator<Item = f64> {
        let bodies = self.list.iter();
        bodies.flat_map(|body| body.tetrahedron.positions().iter().copied())
    }

    /// What is seen and touches; none if that is the sheets alone.
    pub(crate) fn surface(
        &self,
        sheets: &Sheet,
        driven: &DrivenObstacles,
    ) -> Result<Option<Surface>, Problem> {
        if self.list.is_empty() && driven.list.is_empty() {
            return Ok(None);
        }
        let sheet = self.beside(sheets, |body| body.solid.surface(), driven)?;
        let own = sheets.topology().vertex_count();
        let carried = self.list.iter().flat_map(|body| {
            let points = body.solid.surface().positions().as_chunks::<3>().0.iter();
            points.map(|p| body.body.carried(*p, body.first))
        });
        let carried: Vec<_> = carried.chain(driven.points()).collect();
        let of_driven = driven
            .list
            .iter()
            .map(|obstacle| obstacle.surface.vertices.len());
        let vertices = own + 4 * self.list.len() + of_driven.sum::<usize>();
        let points = SurfacePoints::new(vertices, own, carried);
        let points = points.map_err(|e| Problem::from_error(Key::root().name("body"), &e))?;
        Ok(Some(Surface { sheet, points }))
    }

    /// The positions at the start of the vertices of their surfaces.
    pub(crate) fn surface_positions(&self) -> Vec<f64> {
        let bodies = self.list.iter();
        bodies
            .flat_map(|body| body.solid.surface().positions().iter().copied())
            .collect()
    }

    /// The body of a name.
    pub(crate) fn named(&self, name: &str) -> Option<&PlacedBody<'a>> {
        let mut numbered = self.list.iter().enumerate();
        let found = numbered.find(|(k, body)| body.of.name(*k) == name);
        found.map(|(_, body)| body)
    }

    /// As the model carries them.
    pub(crate) fn carried(&self) -> Vec<CarriedBody> {
        let bodies = self.list.iter().map(|body| CarriedBody {
            vertices: body.vertices(),
            centre: body.body.carried(body.body.centre(), body.first),
            pivot: body.of.guide.as_ref().map(|guide| {
                let centre = body.body.centre();
                body.body
                    .carried(guide.point().unwrap_or(centre), body.first)
            }),
            part: body.part.clone(),
            is_round: body.round().is_some(),
        });
        bodies.collect()
    }

    /// Refuses bodies in which something else is at the start. (What passes through their surface is found
    /// with the gaps of contact.)
    pub(crate) fn check_empty(
        &self,
        sheets: &PlacedSheets<'_>,
        obstacles: &[collide::Obstacle],
    ) -> Result<(), Problem> {
        let point_of_part = |mesh: &Sheet, x: &[f64]| -> Vec<[f64; 3]> {
            let parts = mesh.topology().components();
            let firsts = parts.iter().filter_map(|part| part.first());
            firsts.map(|v| x.as_chunks::<3>().0[v.index()]).collect()
        };
        let of_sheets = point_of_part(&sheets.union, &sheets.start).into_iter();
        let mut points: Vec<(Key, [f64; 3])> =
            of_sheets.map(|p| (Key::root().name("sheet"), p)).collect();
        for body in &self.list {
            let surface = body.solid.surface();
            let own = point_of_part(surface, surface.positions()).into_iter();
            points.extend(own.map(|p| (body.key.clone(), p)));
        }
        for (k, obstacle) in obstacles.iter().enumerate() {
            let mesh = obstacle.shape().triangles(4).ok().flatten();
            let corner = mesh.and_then(|mesh| mesh.points.first().copied());
            if let Some(p) = corner {
                let place = obstacle.motion().pose(0.0) * Point3::from(p);
                points.push((Key::root().name("obstacle").entry(k), place.coords.into()));
            }
        }
        for body in &self.list {
            let others = points.iter().filter(|(key, _)| *key != body.key);
            for (key, point) in others {
                if body.solid.contains(*point) {
                    let message = format!("`{key}` is inside of this body at the start");
                    let remedy = "move one of them: bodies are solid, and nothing passes through their surfaces";
                    return Err(Problem::new(body.key.name("pose"), message, remedy));
                }
            }
        }
        Ok(())
    }
}

/// What a joint leaves free, with its spring and its damper.
pub(crate) struct JointMotion {
    pub(crate) coordinate: JointCoordinate,
    pub(crate) stiffness: f64,
    pub(crate) rest: Profile,
    pub(crate) damping: f64,
}

/// Part of the largest speed of a corner that a guide may not let it have, and that is round-off.
const ROUND_OFF: f64 = 1e-9;

impl PlacedBody<'_> {
    /// What its guide leaves free, with the vertices at positions `x`; nothing of a ball joint.
    ///
    /// # Errors
    /// If it starts with a velocity that the guide does not allow.
    pub(crate) fn guided_motion(
        &self,
        guide: &Guide,
        x: &[f64],
    ) -> Result<Option<JointMotion>, Problem> {
        let velocities = self.velocities().into_iter().map(Vector3::from);
        let velocities: Vec<Vector3<f64>> = velocities.collect();
        let largest = velocities.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let (forbidden, motion) = match guide {
            Guide::Ball { .. } => (velocities[..1].to_vec(), None),
            Guide::Hinge {
                stiffness,
                rest,
                damping,
                ..
            } => {
                let motion = JointMotion {
                    coordinate: JointCoordinate::angle(self.vertices(), x),
                    stiffness: *stiffness,
                    rest: rest.as_angle(),
                    damping: *damping,
                };
                (velocities[..2].to_vec(), Some(motion))
            }
            Guide::Slider {
                direction,
                stiffness,
                rest,
                damping,
            } => {
                let along = Vector3::from(*direction).normalize();
                let motion = JointMotion {
                    coordinate: JointCoordinate::distance(self.first, along.into(), x),
                    stiffness: *stiffness,
                    rest: rest.as_given(),
                    damping: *damping,
                };
                let across = velocities.iter().map(|v| v - v.dot(&along) * along);
                (across.collect(), Some(motion))
            }
        };
        if forbidden.iter().any(|v| v.norm() > ROUND_OFF * largest) {
            let key = match self.of.spin.is_some() {
                true => self.key.name("spin"),
                false => self.key.name("velocity"),
            };
            let message = format!(
                "the body starts with a velocity that its {} does not allow",
                guide.name()
            );
            let remedy = "on a hinge give a `spin` about its axis alone, on a ball joint any `spin`, and on a slider a \
                          `velocity` along its direction";
            return Err(Problem::new(key, message, remedy));
        }
        Ok(motion)
    }

    /// One of the forces on it, with its key.
    pub(crate) fn force(
        &self,
        number: usize,
        force: &guides::BodyForceKey,
    ) -> Result<(Key, BodyForce), Problem> {
        let key = self.key.name("force").entry(number);
        let at = force.at.unwrap_or_else(|| self.body.centre());
        let at = self.body.carried(at, self.first);
        match BodyForce::new(at, force.direction, force.size.as_given()) {
            Ok(made) => Ok((key, made)),
            Err(error) => Err(Problem::from_error(key, &error)),
        }
    }

    /// One of the torques on it, with its key.
    pub(crate) fn torque(
        &self,
        number: usize,
        torque: &guides::BodyTorqueKey,
    ) -> Result<(Key, BodyTorque), Problem> {
        let key = self.key.name("torque").entry(number);
        match BodyTorque::new(self.vertices(), torque.axis, torque.size.as_given()) {
            Ok(made) => Ok((key, made)),
            Err(error) => Err(Problem::from_error(key, &error)),
        }
    }

    /// The surface by which it touches, if that is round.
    pub(crate) fn round(&self) -> Option<RoundBody> {
        self.round
    }

    /// The vertices of the model that carry it.
    pub(crate) fn vertices(&self) -> [VertexId; 4] {
        [0, 1, 2, 3].map(|k| VertexId::from_index(self.first.index() + k))
    }

    /// The vertices of its surface at a selection, by their numbers among the vertices of all surfaces.
    pub(crate) fn vertices_at(
        &self,
        selection: &Selection,
        at: &Key,
    ) -> Result<Vec<VertexId>, Problem> {
        let surface = self.solid.surface();
        let place = InPlace {
            topology: surface.topology(),
            x: surface.positions(),
            groups: &FaceGroups::default(),
        };
        let found = selection.resolve(at, &place)?;
        Ok(found.into_iter().map(|v| self.part.vertex(v)).collect())
    }

    /// The velocities of these at the start, m/s.
    pub(crate) fn velocities(&self) -> Vec<[f64; 3]> {
        let points = self.tetrahedron.positions().as_chunks::<3>().0;
        let pivot = self.of.guide.as_ref().and_then(Guide::point);
        let centre = pivot.unwrap_or_else(|| self.body.centre());
        velocities(points, self.of.velocity, self.of.spin, centre.into())
    }
}

impl BodyKey {
    /// A rigid body whose corners its guide can hold.
    fn guided(&self, body: RigidBody, key: &Key) -> Result<RigidBody, Problem> {
        let guided = match &self.guide {
            None => Ok(body),
            Some(Guide::Ball { point }) => body.with_corner(*point),
            Some(Guide::Hinge { point, axis, .. }) => body.with_edge(*point, *axis),
            Some(Guide::Slider { direction, .. }) => {
                let centre = body.centre();
                body.with_edge(centre, *direction)
            }
        };
        guided.map_err(|e| Problem::from_error(key.name("guide"), &e))
    }

    /// What its surface encloses, in its place.
    fn solid(&self, shape: &geometry::Shape, key: &Key) -> Result<Solid, Problem> {
        let key = key.name("shape");
        let at = match self.shape {
            ShapeKey::File(_) => key.name("file.path"),
            _ => key.name(self.shape.name()),
        };
        let mesh = shape.triangles(self.sides());
        let mesh = mesh.map_err(|e| Problem::from_error(at.clone(), &e))?;
        let mesh = mesh.ok_or_else(|| {
            let message = "the shape encloses no volume";
            Problem::new(at.clone(), message, "choose another one")
        })?;
        let positions = mesh.points.iter().flat_map(|p| self.pose.place(*p));
        let surface = Sheet::new(positions.collect(), &mesh.faces);
        let surface = surface.map_err(|e| Problem::from_error(at.clone(), &e))?;
        check_shape(&surface, &at)?;
        let touching = ContactMesh::from_topology(surface.topology());
        let x = surface.positions();
        if let Some([edge, face]) = BroadPhase::new(touching, x).self_crossing(x, 0.0) {
            let message = format!("edge {edge} of the surface passes through its face {face}");
            let remedy = "make a surface that does not cut itself, or several bodies";
            return Err(Problem::new(at, message, remedy));
        }
        Solid::new(surface).map_err(|e: SolidError| Problem::from_error(at.clone(), &e))
    }
}
