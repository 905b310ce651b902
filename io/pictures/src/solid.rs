//! Bodies in pictures of sheets.

use super::camera::normal;
use super::error::PictureError;
use isosheet_collide::Obstacle;
use isosheet_geometry::{self as geometry, Shape, Triangles as Mesh};
use isosheet_mesh::vec3::{axpy, dot, sub, unit};
use isosheet_mesh::{Topology, VertexId};
use nalgebra::{Isometry3, Point3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Sides of the circles of round bodies, before faces are cut as finely as the picture needs: enough for the
/// shadows that the bodies cast.
const SIDES: usize = 32;

/// Edges are drawn where the normals of two faces differ by more than this (cosine), which is more than two
/// faces beside each other on a round body differ.
const FLAT: f64 = 0.97;

/// A body as it is drawn, in a pose.
#[derive(Clone, Debug)]
pub struct DrawnSolid {
    form: Arc<SolidForm>,
    pose: Isometry3<f64>,
}

/// A body in its own frame.
#[derive(Debug)]
struct SolidForm {
    /// None for a half-space.
    mesh: Option<Mesh>,
    /// Edges where two faces meet at an angle.
    edges: Vec<[u32; 2]>,
    shape: Shape,
}

/// The surface that faces of a body approximate, in space.
#[derive(Clone, Copy, Debug)]
pub(super) enum Skin {
    /// The faces themselves; of a closed body the back sides are never seen.
    Flat { is_closed: bool },
    /// A ball or a capsule: all points at a distance from a segment.
    Round { ends: [[f64; 3]; 2], radius: f64 },
    /// A cylinder with flat ends about a segment.
    Tube { ends: [[f64; 3]; 2], radius: f64 },
    /// A half-space: its plane is drawn around a point, and fades out towards this radius.
    Ground { centre: [f64; 3], radius: f64 },
    /// A plane that is seen where there is a shadow on it, and fades out likewise.
    Shadow { centre: [f64; 3], radius: f64 },
}

/// What is drawn of a body: corners, faces and edges in space.
pub(super) struct Shell {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) faces: Vec<[usize; 3]>,
    pub(super) edges: Vec<[usize; 2]>,
    pub(super) skin: Skin,
}

impl DrawnSolid {
    /// A body in its place at time `t`, seconds.
    ///
    /// # Errors
    /// [`PictureError::Body`] if the body has no geometry.
    pub fn of(body: &Obstacle, t: f64) -> Result<Self, PictureError> {
        let mesh = body.shape().triangles(SIDES)?;
        let edges = mesh.as_ref().map(ridges).unwrap_or_default();
        let form = SolidForm {
            mesh,
            edges,
            shape: body.shape().clone(),
        };
        Ok(Self {
            form: Arc::new(form),
            pose: body.motion().pose(t),
        })
    }

    /// This body in another pose.
    pub fn moved_to(&self, pose: Isometry3<f64>) -> Self {
        Self {
            form: Arc::clone(&self.form),
            pose,
        }
    }

    /// Points on the body that bound it, metres; none for a half-space, which is unbounded.
    pub fn outline(&self) -> impl Iterator<Item = [f64; 3]> + Clone {
        let points = self.form.mesh.iter().flat_map(|mesh| &mesh.points);
        points.map(|p| place(&self.pose, p))
    }

    /// What is drawn; of a half-space the part that is at most `reach` metres from `centre`.
    pub(super) fn shell(&self, centre: &[f64; 3], reach: f64) -> Shell {
        let place = |p: &[f64; 3]| place(&self.pose, p);
        let ends = |half: f64| [-half, half].map(|z| place(&[0.0, 0.0, z]));
        let skin = match self.form.shape.skin() {
            geometry::Skin::Plane => {
                let foot = self.pose.inverse() * Point3::from(*centre);
                let foot = self.pose * Point3::new(foot.x, foot.y, 0.0);
                let (centre, radius) = (foot.coords.into(), reach);
                Skin::Ground { centre, radius }
            }
            geometry::Skin::Flat => Skin::Flat {
                is_closed: self.form.shape.is_solid(),
            },
            geometry::Skin::Round {
                half_length,
                radius,
            } => Skin::Round {
                ends: ends(half_length),
                radius,
            },
            geometry::Skin::Tube {
                half_length,
                radius,
            } => Skin::Tube {
                ends: ends(half_length),
                radius,
            },
        };
        let square = Mesh::square(reach);
        let mesh = self.form.mesh.as_ref().unwrap_or(&square);
        let mut points: Vec<[f64; 3]> = mesh.points.iter().map(place).collect();
        if let Skin::Ground { centre, .. } = skin {
            let shift = sub(centre, place(&[0.0; 3]));
            for p in &mut points {
                *p = axpy(*p, 1.0, shift);
            }
        }
        Shell {
            points,
            faces: mesh.faces.iter().map(|f| f.map(|v| v as usize)).collect(),
            edges: self
                .form
                .edges
                .iter()
                .map(|e| e.map(|v| v as usize))
                .collect(),
            skin,
        }
    }
}

fn place(pose: &Isometry3<f64>, p: &[f64; 3]) -> [f64; 3] {
    (pose * Point3::from(*p)).coords.into()
}

/// The edges between faces that meet at an angle, and those with one face or with more than two.
fn ridges(mesh: &Mesh) -> Vec<[u32; 2]> {
    let mut beside: BTreeMap<[u32; 2], Vec<[f64; 3]>> = BTreeMap::new();
    for face in &mesh.faces {
        let n = normal(&face.map(|v| mesh.points[v as usize]));
        let [a, b, c] = *face;
        for [a, b] in [[a, b], [b, c], [c, a]] {
            beside.entry([a.min(b), a.max(b)]).or_default().push(n);
        }
    }
    let is_ridge = |normals: &[[f64; 3]]| match normals {
        [f, g] => dot(f, g) < FLAT,
        _ => true,
    };
    let ridges = beside.into_iter().filter(|(_, normals)| is_ridge(normals));
    ridges.map(|(edge, _)| edge).collect()
}

impl Skin {
    /// The point of the surface at a part of an edge, from `a`.
    pub(super) fn middle(&self, a: &[f64; 3], b: &[f64; 3], part: f64) -> [f64; 3] {
        let middle = axpy(a, part, sub(b, a));
        match self {
            Self::Round { ends, radius } | Self::Tube { ends, radius } if self.is_arc(a, b) => {
                on(&nearest(ends, &middle), &middle, *radius)
            }
            _ => middle,
        }
    }

    /// Whether the surface between two points of it is curved; the flat ends of a cylinder are not.
    pub(super) fn is_arc(&self, a: &[f64; 3], b: &[f64; 3]) -> bool {
        match self {
            Self::Flat { .. } | Self::Ground { .. } | Self::Shadow { .. } => false,
            Self::Round { .. } => true,
            Self::Tube { ends, radius } => [a, b].into_iter().all(|p| {
                let d = sub(p, nearest(ends, p));
                dot(d, d) > (1.0 - 1e-6) * radius * radius
            }),
        }
    }

    /// The length of an edge in the direction in which the surface is curved, metres.
    pub(super) fn across(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        let d = sub(b, a);
        match self {
            Self::Tube { ends, .. } => {
                let axis = unit(sub(ends[1], ends[0]));
                length(&axpy(d, -dot(axis, d), axis))
            }
            _ => length(&d),
        }
    }

    /// How far a point outside of the body is from the curved part of its surface, metres.
    pub(super) fn distance(&self, p: &[f64; 3]) -> f64 {
        match self {
            Self::Flat { .. } | Self::Ground { .. } | Self::Shadow { .. } => 0.0,
            Self::Round { ends, radius } => length(&sub(p, nearest(ends, p))) - radius,
            Self::Tube { ends, radius } => {
                let axis = unit(sub(ends[1], ends[0]));
                let d = sub(p, ends[0]);
                let along = dot(axis, d);
                let aside = length(&axpy(d, -along, axis)) - radius;
                let beyond = (-along).max(along - length(&sub(ends[1], ends[0])));
                aside.hypot(beyond.max(0.0))
            }
        }
    }

    /// The outer unit normal of the surface at a corner of a face that has the normal `flat`.
    pub(super) fn normal(&self, flat: &[f64; 3], p: &[f64; 3]) -> [f64; 3] {
        match self {
            Self::Flat { .. } | Self::Ground { .. } | Self::Shadow { .. } => *flat,
            Self::Round { ends, .. } => unit(sub(p, nearest(ends, p))),
            Self::Tube { ends, .. } => {
                let axis = unit(sub(ends[1], ends[0]));
                // Faces of the mantle are at right angles to the ends.
                if dot(axis, flat).abs() > 0.7 {
                    *flat
                } else {
                    unit(sub(p, nearest(ends, p)))
                }
            }
        }
    }

    /// The radius of the surface, metres, if it is curved.
    pub(super) fn radius(&self) -> Option<f64> {
        match self {
            Self::Flat { .. } | Self::Ground { .. } | Self::Shadow { .. } => None,
            Self::Round { radius, .. } | Self::Tube { radius, .. } => Some(*radius),
        }
    }

    /// Whether faces that are seen from behind are left out.
    pub(super) fn hides_backs(&self) -> bool {
        !matches!(self, Self::Flat { is_closed: false })
    }

    /// Whether it is a plane, which has no ends.
    pub(super) fn is_plane(&self) -> bool {
        matches!(self, Self::Ground { .. } | Self::Shadow { .. })
    }

    /// How much of its colour a point of the surface has, from 0 to 1.
    pub(super) fn strength(&self, p: &[f64; 3]) -> f64 {
        match self {
            Self::Ground { centre, radius } | Self::Shadow { centre, radius } => {
                let d = sub(p, centre);
                // Full out to 0.35 of the radius, then fading smoothly.
                let s = ((1.0 - dot(d, d).sqrt() / radius) / 0.65).clamp(0.0, 1.0);
                s * s * (3.0 - 2.0 * s)
            }
            _ => 1.0,
        }
    }
}

fn length(a: &[f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// The point at a distance from `centre` in the direction of `p`.
fn on(centre: &[f64; 3], p: &[f64; 3], distance: f64) -> [f64; 3] {
    axpy(centre, distance, unit(sub(p, centre)))
}

/// The point of a segment that is nearest to `p`.
fn nearest([a, b]: &[[f64; 3]; 2], p: &[f64; 3]) -> [f64; 3] {
    let d = sub(b, a);
    let square = dot(d, d);
    if square == 0.0 {
        return *a;
    }
    axpy(a, (dot(sub(p, a), d) / square).clamp(0.0, 1.0), d)
}

/// The triangles of a sheet and of bodies, the sheet first.
pub(super) struct Triangles {
    pub(super) x: Vec<[f64; 3]>,
    pub(super) faces: Vec<[usize; 3]>,
    /// Faces of the sheet.
    pub(super) own: usize,
    /// Of several sheets the number of faces before the end of each.
    pub(super) sheets: Vec<usize>,
    /// Of each body its surface, and the number of faces before the end of its own.
    skins: Vec<(Skin, usize)>,
    /// Edges of bodies, with the surfaces that they follow.
    pub(super) ridges: Vec<([usize; 2], Skin)>,
}

impl Triangles {
    /// A sheet at positions and the bodies around it; of half-spaces the part that is at most `reach` metres
    /// from `centre`.
    pub(super) fn new(
        topology: &Topology,
        positions: &[f64],
        solids: &[DrawnSolid],
        centre: &[f64; 3],
        reach: f64,
    ) -> Self {
        let own = topology.faces().iter();
        let mut scene = Self {
            x: positions.as_chunks::<3>().0.to_vec(),
            faces: own.map(|f| f.map(VertexId::index)).collect(),
            own: topology.face_count(),
            sheets: Vec::new(),
            skins: Vec::new(),
            ridges: Vec::new(),
        };
        for solid in solids {
            let first = scene.x.len();
            let shell = solid.shell(centre, reach);
            scene.x.extend(shell.points);
            let faces = shell.faces.iter();
            scene.faces.extend(faces.map(|f| f.map(|v| v + first)));
            let edges = shell.edges.iter();
            let edges = edges.map(|e| (e.map(|v| v + first), shell.skin));
            scene.ridges.extend(edges);
            scene.skins.push((shell.skin, scene.faces.len()));
        }
        scene
    }

    /// Adds the level plane at a height that shows shadows, out to `reach` metres from below `centre`.
    pub(super) fn add_ground(&mut self, height: f64, centre: &[f64; 3], reach: f64) {
        let first = self.x.len();
        let centre = [centre[0], centre[1], height];
        let square = Mesh::square(reach);
        self.x
            .extend(square.points.iter().map(|p| axpy(p, 1.0, centre)));
        let faces = square.faces.iter();
        self.faces
            .extend(faces.map(|f| f.map(|v| first + v as usize)));
        let radius = reach;
        let skin = Skin::Shadow { centre, radius };
        self.skins.push((skin, self.faces.len()));
    }

    /// The number of the sheet that a face is of.
    pub(super) fn sheet(&self, face: usize) -> usize {
        self.sheets.partition_point(|end| *end <= face)
    }

    /// The surface of which a face is a part; none for the sheet.
    pub(super) fn skin(&self, face: usize) -> Option<Skin> {
        if face < self.own {
            return None;
        }
        let body = self.skins.partition_point(|(_, end)| *end <= face);
        self.skins.get(body).map(|(skin, _)| *skin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(shape: Shape) -> Shell {
        let body = Obstacle::fixed(shape, Isometry3::translation(0.0, 0.0, 5.0)).unwrap();
        DrawnSolid::of(&body, 0.0)
            .unwrap()
            .shell(&[1.0, 2.0, 7.0], 3.0)
    }

    #[test]
    fn a_box_has_twelve_edges_and_no_diagonals() {
        let half = [1.0, 2.0, 3.0];
        let shell = shell(Shape::Cuboid { half });
        assert_eq!(
            (shell.points.len(), shell.faces.len(), shell.edges.len()),
            (8, 12, 12)
        );
        assert!(shell.points.iter().all(|p| p[2] == 2.0 || p[2] == 8.0));
    }

    #[test]
    fn a_half_space_is_drawn_around_the_middle_of_the_picture() {
        let shell = shell(Shape::HalfSpace);
        assert_eq!(shell.faces.len(), 2);
        assert!(shell.points.iter().all(|p| p[2] == 5.0));
        assert!((shell.skin.strength(&[1.0, 2.0, 5.0]) - 1.0).abs() < 1e-12);
        assert_eq!(shell.skin.strength(&[4.1, 2.0, 5.0]), 0.0);
    }

    /// Corners and the middles of edges are on the round surface, whose rims alone are drawn as edges.
    #[test]
    fn round_bodies_are_round() {
        let (radius, half) = (0.5, 0.75);
        let shapes = [
            (Shape::Sphere { radius }, 0),
            (
                Shape::Capsule {
                    radius,
                    half_length: half,
                },
                0,
            ),
            (
                Shape::Cylinder {
                    radius,
                    half_height: half,
                },
                2 * SIDES,
            ),
        ];
        for (shape, edges) in shapes {
            let distance = |p: &[f64; 3]| {
                let p = [p[0], p[1], p[2] - 5.0];
                shape.signed_distance(&p.into()).value
            };
            let shell = shell(shape.clone());
            assert_eq!(shell.edges.len(), edges, "{shape:?}");
            for face in &shell.faces {
                let corners = face.map(|v| shell.points[v]);
                let flat = normal(&corners);
                for k in 0..3 {
                    let (a, b) = (&corners[k], &corners[(k + 1) % 3]);
                    let middle = shell.skin.middle(a, b, 0.5);
                    for p in [a, &middle] {
                        assert!(distance(p).abs() < 1e-12, "{shape:?}: {p:?}");
                    }
                    let n = shell.skin.normal(&flat, a);
                    assert!(dot(n, flat) > 0.9, "{shape:?}: {n:?} and {flat:?}");
                }
            }
        }
    }
}
