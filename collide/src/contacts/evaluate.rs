//! Distances, normals and weights of pairs at given positions.

use super::body::ContactBody;
use super::features::Features;
use super::rolling::{edge_gradient, face_gradients};
use super::round::Rounds;
use super::thickness::{Clearance, Thickness};
use isosheet_dynamics::contact::{
    ActiveContact, BodyPlace, ContactKey, ContactKind, ParallelEdges, Rolling, Round,
};
use isosheet_geometry::ContactMesh;
use isosheet_geometry::distance::{Closest, edge_edge, point_triangle};
use isosheet_geometry::vectors::gather;
use nalgebra::Vector3;

/// The sheet at given positions.
#[derive(Debug, Clone, Copy)]
pub(super) struct SheetAt<'a> {
    pub(super) mesh: &'a ContactMesh,
    pub(super) rounds: &'a Rounds,
    pub(super) x: &'a [f64],
    /// Squared rest lengths of the edges.
    pub(super) lengths2: &'a [f64],
    pub(super) thickness: &'a Thickness,
    /// Gap below which the barrier acts, metres.
    pub(super) activation: f64,
}

/// A body in its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<'a> {
    pub(super) body: &'a ContactBody,
    pub(super) place: &'a BodyPlace,
}

impl SheetAt<'_> {
    /// The contact of a pair of the sheet with itself; `None` out of reach.
    pub(super) fn with_itself(&self, key: ContactKey) -> Option<ActiveContact> {
        if key.kind == ContactKind::EdgeEdge {
            let vertices = self.mesh.edge_edge(key.pair);
            let places = gather(self.x, vertices);
            let closest = edge_edge(&places);
            let contact = self.own_contact(key, vertices, &closest)?;
            let has_point = key.pair.iter().any(|e| self.mesh.is_point(*e));
            let lengths2 = key.pair.map(|e| self.lengths2[e as usize]);
            let [a, b, c, d] = places;
            let parallel = match has_point {
                true => None,
                false => ParallelEdges::new(b - a, d - c, lengths2),
            };
            let is_round = contact.round.iter().any(Option::is_some);
            let rolling = (is_round && parallel.is_none()).then(|| {
                let [wa, wb, wc, wd] = closest.weights;
                let first = edge_gradient([a, b], [c, d], closest.weights);
                let second = edge_gradient([c, d], [a, b], [-wc, -wd, -wa, -wb]);
                Rolling {
                    gradients: [-first, first, -second, second],
                    distance: closest.distance(),
                }
            });
            Some(ActiveContact {
                parallel,
                rolling,
                ..contact
            })
        } else {
            let vertices = self.mesh.vertex_face(key.pair);
            let places = gather(self.x, vertices);
            let closest = point_triangle(&places);
            let contact = self.own_contact(key, vertices, &closest)?;
            let rolling = contact.round[0].map(|_| {
                let [_, corners @ ..] = places;
                let [_, weights @ ..] = closest.weights;
                let [a, b, c] = face_gradients(corners, weights.map(|w| -w));
                Rolling {
                    gradients: [Vector3::zeros(), a, b, c],
                    distance: closest.distance(),
                }
            });
            Some(ActiveContact { rolling, ..contact })
        }
    }

    fn own_contact(
        &self,
        key: ContactKey,
        vertices: [u32; 4],
        closest: &Closest<4>,
    ) -> Option<ActiveContact> {
        let distance = closest.distance();
        let [first, .., last] = vertices;
        let ends = [first, last];
        let clearance = self.thickness.clearance(self.mesh, ends, self.activation);
        if distance >= clearance.reach {
            return None;
        }
        Some(ActiveContact {
            key,
            vertices,
            weights: closest.weights,
            normal: closest.difference / distance,
            gap: distance - clearance.thickness,
            closest: Vector3::zeros(),
            parallel: None,
            rolling: None,
            round: ends.map(|v| self.rounds.of(v)),
        })
    }

    /// The contact of a pair of the sheet and a body; `None` out of reach.
    pub(super) fn with_body(&self, key: ContactKey, placed: Placed<'_>) -> Option<ActiveContact> {
        if key.kind == ContactKind::Vertex {
            return self.vertex(key, placed);
        }
        let features = placed.body.features()?;
        match key.kind {
            ContactKind::Vertex => None,
            ContactKind::VertexFace => self.vertex_face(key, placed, features),
            ContactKind::FaceVertex => self.face_vertex(key, placed, features),
            ContactKind::EdgeEdge => self.edge_edge(key, placed, features),
        }
    }

    /// A vertex of the sheet in the frame of a body's surface.
    fn local(&self, place: &BodyPlace, v: u32) -> Vector3<f64> {
        let [p] = gather(self.x, [v]);
        place.to_local(&p)
    }

    /// What is round where a primitive with this vertex meets an obstacle.
    fn against(&self, vertex: u32) -> [Option<Round>; 2] {
        [self.rounds.of(vertex), None]
    }

    /// The gap for a distance of a primitive with this vertex from an obstacle; `None` out of reach, but not
    /// if it is not a number.
    fn gap(&self, vertex: u32, distance: f64) -> Option<f64> {
        let clearance = self
            .thickness
            .obstacle_clearance(self.mesh, vertex, self.activation);
        let Clearance { thickness, reach } = clearance;
        let gap = distance - thickness;
        (gap < reach - thickness || gap.is_nan()).then_some(gap)
    }

    fn vertex(&self, key: ContactKey, Placed { body, place }: Placed<'_>) -> Option<ActiveContact> {
        let [v, _] = key.pair;
        let p = self.local(place, v);
        let d = body.obstacle().shape().signed_distance(&p);
        let gap = self.gap(v, d.value)?;
        Some(ActiveContact {
            key,
            vertices: [v; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal: place.frame() * d.normal,
            gap,
            closest: place.to_space(&d.closest(&p)),
            parallel: None,
            rolling: None,
            round: self.against(v),
        })
    }

    fn vertex_face(
        &self,
        key: ContactKey,
        Placed { place, .. }: Placed<'_>,
        features: &Features,
    ) -> Option<ActiveContact> {
        let [v, f] = key.pair;
        let p = self.local(place, v);
        let [a, b, c] = features.face(f);
        let closest = point_triangle(&[p, a, b, c]);
        let distance = closest.distance();
        let gap = self.gap(v, distance - features.radius)?;
        let n = closest.difference / distance;
        let point = p - closest.difference;
        Some(ActiveContact {
            key,
            vertices: [v; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal: place.frame() * n,
            gap,
            closest: place.to_space(&(point + features.radius * n)),
            parallel: None,
            rolling: None,
            round: self.against(v),
        })
    }

    fn face_vertex(
        &self,
        key: ContactKey,
        Placed { place, .. }: Placed<'_>,
        features: &Features,
    ) -> Option<ActiveContact> {
        let [f, v] = key.pair;
        let face = self.mesh.faces()[f as usize];
        let ([p, q, r], b) = (face.map(|v| self.local(place, v)), features.vertex(v));
        let closest = point_triangle(&[b, p, q, r]);
        let distance = closest.distance();
        let gap = self.gap(face[0], distance - features.radius)?;
        let n = -closest.difference / distance;
        let [_, wp, wq, wr] = closest.weights;
        Some(ActiveContact {
            key,
            vertices: [face[0], face[1], face[2], face[0]],
            weights: [-wp, -wq, -wr, 0.0],
            normal: place.frame() * n,
            gap,
            closest: place.to_space(&(b + features.radius * n)),
            parallel: None,
            rolling: (features.radius > 0.0).then(|| {
                let gradients = face_gradients([p, q, r], [-wp, -wq, -wr]);
                let [gp, gq, gr] = gradients.map(|g| place.frame() * g);
                Rolling {
                    gradients: [gp, gq, gr, Vector3::zeros()],
                    distance,
                }
            }),
            round: [None; 2],
        })
    }

    fn edge_edge(
        &self,
        key: ContactKey,
        Placed { place, .. }: Placed<'_>,
        features: &Features,
    ) -> Option<ActiveContact> {
        let [e, g] = key.pair;
        let edge = self.mesh.edges()[e as usize];
        let ([p, q], [c, d]) = (edge.map(|v| self.local(place, v)), features.edge(g));
        let closest = edge_edge(&[p, q, c, d]);
        let distance = closest.distance();
        let gap = self.gap(edge[0], distance - features.radius)?;
        let n = closest.difference / distance;
        let [wp, wq, wc, wd] = closest.weights;
        let point = -wc * c - wd * d;
        let (u, v) = (place.frame() * (q - p), place.frame() * (d - c));
        let parallel = ParallelEdges::new(u, v, [self.lengths2[e as usize], v.norm_squared()]);
        let round = self.against(edge[0]);
        let is_round = features.radius > 0.0 || round[0].is_some();
        let rolling = (is_round && parallel.is_none()).then(|| {
            let gradient = edge_gradient([p, q], [c, d], closest.weights);
            let gradient = place.frame() * gradient;
            Rolling {
                gradients: [-gradient, gradient, Vector3::zeros(), Vector3::zeros()],
                distance,
            }
        });
        Some(ActiveContact {
            key,
            vertices: [edge[0], edge[1], edge[0], edge[0]],
            weights: [wp, wq, 0.0, 0.0],
            normal: place.frame() * n,
            gap,
            closest: place.to_space(&(point + features.radius * n)),
            parallel,
            rolling,
            round,
        })
    }
}
