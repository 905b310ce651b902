//! Faces of bodies cut into pieces that are small in the picture.

use super::camera::{Camera, centre, normal};
use super::solid::{Skin, Triangles};
use isosheet_mesh::vec3::{dot, sub};
use std::collections::HashMap;

/// Largest distance in the picture between a curved surface and the pieces that stand for it, pixels.
const SAG: f64 = 0.2;

/// A face or a part of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) corners: [usize; 3],
    /// The number of the face that it is part of.
    pub(super) face: usize,
    /// Whether it is seen from behind.
    pub(super) back: bool,
}

/// The picture for which faces are cut.
pub(super) struct Cutter<'a> {
    pub(super) camera: &'a Camera,
    /// Width and height, pixels.
    pub(super) size: [f64; 2],
    /// Edges up to this length in the picture stay whole, pixels.
    pub(super) pixels: f64,
}

impl Cutter<'_> {
    /// The parts of all faces that the picture may show. Faces of the sheet stay whole. Faces of bodies are
    /// halved until they are small enough, and parts outside of the picture are left out on the way: the
    /// number of pieces is bounded by the picture, however large a body is. New points are added to the
    /// scene.
    pub(super) fn pieces(&self, scene: &mut Triangles) -> Vec<Piece> {
        let mut pieces = Vec::new();
        let mut halves = Halves::default();
        for face in 0..scene.faces.len() {
            let corners = scene.faces[face];
            let back = false;
            let piece = Piece {
                corners,
                face,
                back,
            };
            match scene.skin(face) {
                None => pieces.extend(self.seen(piece, &scene.x, None)),
                Some(skin) => {
                    let parts = self
                        .cut(piece, &skin, &mut scene.x, &mut halves)
                        .into_iter();
                    pieces.extend(parts.filter_map(|p| self.seen(p, &scene.x, Some(&skin))));
                }
            }
        }
        pieces
    }

    /// Smaller parts of some pieces of bodies.
    pub(super) fn finer(&self, pieces: &[Piece], scene: &mut Triangles) -> Vec<Piece> {
        let mut halves = Halves::default();
        let mut finer = Vec::new();
        for piece in pieces {
            if let Some(skin) = scene.skin(piece.face) {
                finer.extend(self.cut(*piece, &skin, &mut scene.x, &mut halves));
            }
        }
        finer
    }

    /// The parts of an edge of a body that the picture may show.
    pub(super) fn parts(&self, ends: [[f64; 3]; 2], skin: &Skin) -> Vec<[[f64; 3]; 2]> {
        let arc = self.arc(skin);
        let mut done = Vec::new();
        let mut open = vec![ends];
        while let Some([a, b]) = open.pop() {
            if self.is_outside(&[a, b, b], skin) {
                continue;
            }
            let is_behind = self.camera.is_behind(&a) || self.camera.is_behind(&b);
            let limit = if is_behind {
                self.camera.nearest()
            } else {
                arc
            };
            let is_long = !is_behind && self.pixels(&a, &b) > self.pixels;
            if distance(&a, &b) > limit || is_long {
                let middle = skin.middle(&a, &b, 0.5);
                open.extend([[middle, b], [a, middle]]);
            } else if !is_behind {
                done.push([a, b]);
            }
        }
        done
    }

    /// The piece with the side from which it is seen, unless that is never seen.
    fn seen(&self, piece: Piece, x: &[[f64; 3]], skin: Option<&Skin>) -> Option<Piece> {
        let points = piece.corners.map(|v| x[v]);
        let centre = centre(&points);
        let back = dot(normal(&points), self.camera.viewer(&centre)) < 0.0;
        let is_hidden = back && skin.is_some_and(Skin::hides_backs);
        (!is_hidden).then_some(Piece { back, ..piece })
    }

    /// Cuts a face in two ways, each of which depends on the edge alone so that pieces of faces that share
    /// one fit together: in space where the surface is curved or passes the viewer, then in the picture. The
    /// longest edge is halved each time, and its halves are shorter than it was by the same measure, so that
    /// cutting ends.
    fn cut(
        &self,
        piece: Piece,
        skin: &Skin,
        x: &mut Vec<[f64; 3]>,
        halves: &mut Halves,
    ) -> Vec<Piece> {
        let arc = self.arc(skin);
        let mut done = Vec::new();
        let mut open = vec![piece];
        while let Some(piece) = open.pop() {
            let points = piece.corners.map(|v| x[v]);
            if self.is_outside(&points, skin) || self.is_turned_away(&points, skin) {
                continue;
            }
            let is_behind = points.iter().any(|p| self.camera.is_behind(p));
            let limit = if is_behind {
                self.camera.nearest()
            } else {
                arc
            };
            let is_curved = (0..3).all(|k| skin.is_arc(&points[k], &points[(k + 1) % 3]));
            let in_space = |a: &[f64; 3], b: &[f64; 3]| {
                // The rim of a flat end matters where the picture shows it.
                let is_seen = || is_curved || !self.is_outside(&[*a, *b, *b], skin);
                if is_behind {
                    distance(a, b)
                } else if skin.is_arc(a, b) && is_seen() {
                    skin.across(a, b)
                } else {
                    0.0
                }
            };
            let (side, length) = longest(&points, in_space);
            if length > limit {
                let middle = middle(&mut halves.in_space, piece.corners, side, |a, b| {
                    x.push(skin.middle(&x[a], &x[b], 0.5));
                    x.len() - 1
                });
                open.extend(piece.halved(side, middle));
                continue;
            }
            if is_behind {
                continue;
            }
            let (side, length) = longest(&points, |a, b| self.pixels(a, b));
            if length > self.pixels {
                let middle = middle(&mut halves.in_picture, piece.corners, side, |a, b| {
                    let part = self.camera.middle(&x[a], &x[b]);
                    x.push(skin.middle(&x[a], &x[b], part));
                    x.len() - 1
                });
                open.extend(piece.halved(side, middle));
                continue;
            }
            done.push(piece);
        }
        done
    }

    /// The length of an edge in the picture, pixels.
    fn pixels(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        let [p, q] = [a, b].map(|p| self.camera.project(p));
        0.5 * self.size[1] * (q.x - p.x).hypot(q.y - p.y)
    }

    /// The largest chord of a curved surface that stays [`SAG`] from it where it is nearest to the viewer.
    fn arc(&self, skin: &Skin) -> f64 {
        match skin.radius() {
            // A chord of the length c is c^2 / (8 R) away from its arc.
            Some(radius) => {
                let away = skin.distance(&self.camera.eye()).max(self.camera.nearest());
                (8.0 * radius * SAG * self.camera.pixel(away, self.size[1])).sqrt()
            }
            None => f64::INFINITY,
        }
    }

    /// Whether a part of a surface with these corners is outside of the picture.
    fn is_outside(&self, points: &[[f64; 3]; 3], skin: &Skin) -> bool {
        let arc = |a: &[f64; 3], b: &[f64; 3]| {
            if skin.is_arc(a, b) {
                distance(a, b)
            } else {
                0.0
            }
        };
        let (_, size) = longest(points, arc);
        let sag = skin.radius().map_or(0.0, |r| size * size / (2.0 * r));
        let aspect = self.size[0] / self.size[1];
        self.camera.is_outside(points, sag, aspect)
    }

    /// Whether all of a part of a surface with these corners is seen from a side that is never seen.
    fn is_turned_away(&self, points: &[[f64; 3]; 3], skin: &Skin) -> bool {
        let flat = normal(points);
        let eye = self.camera.eye();
        // Between the corners the normal turns by no more than this, and its part towards the viewer grows by
        // no more than the square of it.
        let turn = skin
            .radius()
            .map_or(0.0, |r| longest(points, distance).1 / r);
        let turned = |p: &[f64; 3]| {
            let (d, n) = (sub(eye, p), skin.normal(&flat, p));
            let room = distance(&eye, p) + skin.radius().unwrap_or(0.0);
            turn < 1.0 && dot(d, n) < -turn * turn * room
        };
        skin.hides_backs() && points.iter().all(turned)
    }
}

impl Piece {
    /// The two parts on either side of the middle of a side.
    fn halved(self, side: usize, middle: usize) -> [Self; 2] {
        let [a, b, c] = [0, 1, 2].map(|k| self.corners[(side + k) % 3]);
        [[a, middle, c], [middle, b, c]].map(|corners| Self { corners, ..self })
    }
}

/// The middles of edges that were halved, so that pieces that share an edge share its middle.
type Middles = HashMap<[usize; 2], usize>;

#[derive(Default)]
struct Halves {
    in_space: Middles,
    in_picture: Middles,
}

/// The middle of a side, a new one if it was not halved yet.
fn middle(
    of: &mut Middles,
    corners: [usize; 3],
    side: usize,
    new: impl FnOnce(usize, usize) -> usize,
) -> usize {
    let [a, b] = ends(corners, side);
    *of.entry([a, b]).or_insert_with(|| new(a, b))
}

/// The ends of a side, the smaller number first.
fn ends(corners: [usize; 3], side: usize) -> [usize; 2] {
    let (a, b) = (corners[side], corners[(side + 1) % 3]);
    [a.min(b), a.max(b)]
}

/// The longest side by some measure, and its length.
fn longest(points: &[[f64; 3]; 3], measure: impl Fn(&[f64; 3], &[f64; 3]) -> f64) -> (usize, f64) {
    let lengths = [0, 1, 2].map(|k| measure(&points[k], &points[(k + 1) % 3]));
    let longest = (0..3).fold(0, |m, k| if lengths[k] > lengths[m] { k } else { m });
    (longest, lengths[longest])
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let d = sub(b, a);
    dot(d, d).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::solid::DrawnSolid;
    use super::*;
    use isosheet_collide::Obstacle;
    use isosheet_geometry::Shape;
    use isosheet_mesh::Topology;
    use isosheet_mesh::vec3::cross;
    use nalgebra::Isometry3;
    use std::collections::BTreeMap;

    /// The pieces of a body below a sheet of 0.2 m, as a picture of 640 x 480 pixels shows it from an
    /// elevation.
    fn pieces(shape: Shape, below: f64, elevation: f64) -> (Vec<Piece>, Triangles, Camera) {
        let camera = Camera::new([0.0; 3], -60.0, elevation, 0.25, 1.2);
        let body = Obstacle::fixed(shape, Isometry3::translation(0.0, 0.0, -below)).unwrap();
        let x = [0.0, 0.0, 0.1, 0.1, 0.0, 0.1, 0.0, 0.1, 0.1];
        let topology = Topology::from_faces(3, &[[0, 1, 2]]).unwrap();
        let solids = [DrawnSolid::of(&body, 0.0).unwrap()];
        let mut scene = Triangles::new(&topology, &x, &solids, &[0.0; 3], 0.25);
        let pieces = cutter(&camera).pieces(&mut scene);
        (pieces, scene, camera)
    }

    fn cutter(camera: &Camera) -> Cutter<'_> {
        Cutter {
            camera,
            size: [640.0, 480.0],
            pixels: 16.0,
        }
    }

    fn area(corners: &[[f64; 3]; 3]) -> f64 {
        let n = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        0.5 * dot(n, n).sqrt()
    }

    /// A box that is seen as a whole: its three visible sides are cut, covered once, and the pieces fit
    /// together.
    #[test]
    fn pieces_are_small_and_fit_together() {
        let half = [0.05, 0.04, 0.03];
        let (pieces, scene, camera) = pieces(Shape::Cuboid { half }, 0.0, 30.0);
        let mut sides: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let mut total = 0.0;
        for piece in pieces.iter().filter(|p| p.face >= scene.own) {
            total += area(&piece.corners.map(|v| scene.x[v]));
            let [a, b, c] = piece.corners;
            for [a, b] in [[a, b], [b, c], [c, a]] {
                assert!(cutter(&camera).pixels(&scene.x[a], &scene.x[b]) <= 16.0);
                *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        let seen = 4.0 * (half[0] * half[1] + half[1] * half[2] + half[2] * half[0]);
        assert!((total - seen).abs() < 1e-12, "{total} {seen}");
        // The rim of what is seen has six edges; every other side of a piece is shared.
        let rim = sides
            .iter()
            .filter(|(_, count)| **count == 1)
            .map(|(side, _)| side);
        let rim: f64 = rim
            .map(|side| {
                let d = sub(scene.x[side[1]], scene.x[side[0]]);
                dot(d, d).sqrt()
            })
            .sum();
        assert!(sides.values().all(|count| *count <= 2));
        assert!(
            (rim - 4.0 * half.iter().sum::<f64>()).abs() < 1e-12,
            "{rim}"
        );
    }

    /// The number of pieces is bounded by the picture, not by the body: a body of a hundred kilometres is cut
    /// into about as many as a body of ten metres that looks alike in the picture. A body that reaches to the
    /// horizon has some more rows of pieces whenever it is twice as large. The pieces cover all that is seen.
    #[test]
    fn huge_bodies_have_no_more_pieces_than_large_ones() {
        for elevation in [0.0, 3.0, 25.0, 90.0] {
            for size in [10.0, 1e3, 1e5] {
                let shapes = [
                    (
                        Shape::Cuboid {
                            half: [size, size, 0.5 * size],
                        },
                        0.5 * size,
                    ),
                    (Shape::Sphere { radius: size }, size),
                    (
                        Shape::Cylinder {
                            radius: size,
                            half_height: size,
                        },
                        size,
                    ),
                    (
                        Shape::Capsule {
                            radius: size,
                            half_length: size,
                        },
                        2.0 * size,
                    ),
                    (Shape::HalfSpace, 0.0),
                ];
                for (shape, below) in shapes {
                    let name = format!("{shape:?} from {elevation} degrees");
                    let (pieces, scene, camera) = pieces(shape, below + 0.01, elevation);
                    let points = scene.x.len();
                    assert!(pieces.len() < 40_000, "{name}: {} pieces", pieces.len());
                    assert!(points < 80_000, "{name}: {points} points");
                    let drawn: f64 = pieces[1..]
                        .iter()
                        .map(|piece| {
                            let places = piece.corners.map(|v| camera.project(&scene.x[v]));
                            area(&places.map(|p| [p.x, p.y, 0.0]))
                        })
                        .sum();
                    // All of the picture, which has 4 x 4 / 3, with little around it.
                    // A half-space is drawn around the middle alone.
                    let is_ground = name.starts_with("HalfSpace");
                    let expected = match elevation {
                        25.0 | 90.0 if !is_ground => 4.0 * 4.0 / 3.0..7.0,
                        _ => 0.0..7.0,
                    };
                    assert!(expected.contains(&drawn), "{name}: {drawn}");
                }
            }
        }
    }
}
