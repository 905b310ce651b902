//! A sheet laid out flat.

use isosheet_mesh::{FaceId, Topology};

/// How exactly the lengths of edges that close a ring of faces have to agree, as a part of the size of the
/// sheet: far above rounding, and far below what is seen of a printed picture.
const CLOSING: f64 = 1e-6;

/// Places of the vertices of the flat sheet with these rest lengths, from 0 to 1: scaled alike in both
/// directions so that the larger side is 1, and turned as the sheet lies at the positions `start` as seen
/// from its front.
///
/// Faces are laid down one after the other along shared edges. `None` if the ends do not meet, as on a closed
/// cylinder or around the tip of a cone.
pub(super) fn flat_coordinates(
    topology: &Topology,
    rest_lengths: &[f64],
    start: &[f64],
) -> Option<Vec<[f64; 2]>> {
    let mut places: Vec<Option<[f64; 2]>> = vec![None; topology.vertex_count()];
    let mut done = vec![false; topology.face_count()];
    for first in topology.face_ids() {
        if done[first.index()] {
            continue;
        }
        // One connected part of the sheet.
        let mut vertices = Vec::new();
        let mut open = vec![first];
        done[first.index()] = true;
        let mut next = 0;
        while next < open.len() {
            let face = open[next];
            next += 1;
            lay_down(topology, rest_lengths, face, &mut places, &mut vertices)?;
            for e in topology.face_edges(face) {
                for neighbour in topology.edge_faces(e).into_iter().flatten() {
                    if !std::mem::replace(&mut done[neighbour.index()], true) {
                        open.push(neighbour);
                    }
                }
            }
        }
        turn(&mut places, &vertices, &open, topology, start)?;
    }
    let size = extent(&places)?;
    for (e, rest) in topology.edges().iter().zip(rest_lengths) {
        let [a, b] = e.map(|v| places[v.index()]);
        let ([ax, ay], [bx, by]) = (a?, b?);
        if ((bx - ax).hypot(by - ay) - rest).abs() > CLOSING * size.1 {
            return None;
        }
    }
    // Vertices without faces are anywhere.
    let uv =
        |p: &Option<[f64; 2]>| p.map_or([0.0; 2], |p| [0, 1].map(|k| (p[k] - size.0[k]) / size.1));
    Some(places.iter().map(uv).collect())
}

/// Places the corners of a face that have no place yet: two corners of the first one, one of each other.
fn lay_down(
    topology: &Topology,
    rest_lengths: &[f64],
    face: FaceId,
    places: &mut [Option<[f64; 2]>],
    vertices: &mut Vec<usize>,
) -> Option<()> {
    let corners = topology.faces()[face.index()];
    let length = |i: usize, j: usize| {
        let e = topology.find_edge(corners[i], corners[j])?;
        Some(rest_lengths[e.index()])
    };
    let of = corners.map(|v| v.index());
    if of.iter().all(|v| places[*v].is_none()) {
        places[of[0]] = Some([0.0, 0.0]);
        places[of[1]] = Some([length(0, 1)?, 0.0]);
        vertices.extend([of[0], of[1]]);
    }
    let Some(new) = (0..3).find(|k| places[of[*k]].is_none()) else {
        return Some(());
    };
    let (i, j) = ((new + 1) % 3, (new + 2) % 3);
    let ([ax, ay], [bx, by]) = (places[of[i]]?, places[of[j]]?);
    let (c, a, b) = (length(i, j)?, length(j, new)?, length(new, i)?);
    // The corner is to the left of the way from i to j.
    let along = (b * b - a * a + c * c) / (2.0 * c);
    let aside = (b * b - along * along).max(0.0).sqrt();
    let (ux, uy) = ((bx - ax) / c, (by - ay) / c);
    let place = [ax + along * ux - aside * uy, ay + along * uy + aside * ux];
    if !place.iter().all(|c| c.is_finite()) {
        return None;
    }
    places[of[new]] = Some(place);
    vertices.push(of[new]);
    Some(())
}

/// Turns and shifts a part so that it fits the shadow that the sheet casts along its mean normal, in which
/// the x axis points to the right, or the y axis where the sheet faces along x.
fn turn(
    places: &mut [Option<[f64; 2]>],
    vertices: &[usize],
    faces: &[FaceId],
    topology: &Topology,
    start: &[f64],
) -> Option<()> {
    let points = start.as_chunks::<3>().0;
    let mut n = [0.0; 3];
    for f in faces {
        let [a, b, c] = topology.faces()[f.index()].map(|v| points[v.index()]);
        let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
        for k in 0..3 {
            n[k] += u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        }
    }
    let size = n.iter().map(|c| c * c).sum::<f64>().sqrt();
    let n = if size > 0.0 {
        n.map(|c| c / size)
    } else {
        [0.0, 0.0, 1.0]
    };
    let axis = if n[0].abs() < 0.9 { 0 } else { 1 };
    let right = [0, 1, 2].map(|k| f64::from(u8::from(k == axis)) - n[axis] * n[k]);
    let length = right.iter().map(|c| c * c).sum::<f64>().sqrt();
    let right = right.map(|c| c / length);
    let up = [0, 1, 2]
        .map(|k| n[(k + 1) % 3] * right[(k + 2) % 3] - n[(k + 2) % 3] * right[(k + 1) % 3]);
    let shadow = |v: usize| [right, up].map(|d| (0..3).map(|k| d[k] * points[v][k]).sum::<f64>());
    let count = vertices.len() as f64;
    let (mut from, mut to) = ([0.0; 2], [0.0; 2]);
    for &v in vertices {
        let (p, q) = (places[v]?, shadow(v));
        for k in 0..2 {
            from[k] += p[k] / count;
            to[k] += q[k] / count;
        }
    }
    let (mut cos, mut sin) = (0.0, 0.0);
    for &v in vertices {
        let (p, q) = (places[v]?, shadow(v));
        let [px, py] = [p[0] - from[0], p[1] - from[1]];
        let [qx, qy] = [q[0] - to[0], q[1] - to[1]];
        cos += px * qx + py * qy;
        sin += px * qy - py * qx;
    }
    let length = f64::hypot(cos, sin);
    let (cos, sin) = if length > 0.0 {
        (cos / length, sin / length)
    } else {
        (1.0, 0.0)
    };
    for &v in vertices {
        let [x, y] = places[v]?;
        let [x, y] = [x - from[0], y - from[1]];
        places[v] = Some([to[0] + cos * x - sin * y, to[1] + sin * x + cos * y]);
    }
    Some(())
}

/// The lower left corner and the larger side of the box around all places.
fn extent(places: &[Option<[f64; 2]>]) -> Option<([f64; 2], f64)> {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in places.iter().flatten() {
        for k in 0..2 {
            (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
        }
    }
    let size = f64::max(high[0] - low[0], high[1] - low[1]);
    (size > 0.0 && size.is_finite()).then_some((low, size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate::Diagonals;
    use isosheet_mesh::{Sheet, generate};

    /// A rolled strip is laid out as the flat one that it was.
    #[test]
    fn rolled_strips_are_laid_out() {
        let sheet = generate::grid(12, 3, 2.0, 0.5, Diagonals::Rising).unwrap();
        let points = sheet.positions().as_chunks::<3>().0;
        // Stood upright: the strip leans along y and is rolled about its short side.
        let rolled: Vec<f64> = points
            .iter()
            .flat_map(|p| [p[0].sin(), 1.0 - p[0].cos(), p[1]])
            .collect();
        for start in [sheet.positions(), &rolled] {
            let uv = flat_coordinates(sheet.topology(), sheet.lengths(), start).unwrap();
            for (uv, p) in uv.iter().zip(points) {
                for k in 0..2 {
                    assert!((uv[k] - 0.5 * p[k]).abs() < 1e-12, "{uv:?} at {p:?}");
                }
            }
        }
    }

    /// The lengths of a tetrahedron without its bottom fit no plane, and neither do the lengths of a ring.
    #[test]
    fn what_cannot_be_flat_has_no_places() {
        let x = [0., 0., 1., 1., 0., 0., -0.5, 0.8, 0., -0.5, -0.8, 0.];
        let tip = Sheet::new(x.to_vec(), &[[0, 1, 2], [0, 2, 3], [0, 3, 1]]).unwrap();
        assert_eq!(flat_coordinates(tip.topology(), tip.lengths(), &x), None);
        let mut x = Vec::new();
        let mut faces = Vec::new();
        for k in 0..6u32 {
            let (sin, cos) = f64::from(k).sin_cos();
            x.extend([cos, sin, 0.0, cos, sin, 1.0]);
            let [a, b] = [2 * k, (2 * k + 2) % 12];
            faces.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
        let ring = Sheet::new(x.clone(), &faces).unwrap();
        assert_eq!(flat_coordinates(ring.topology(), ring.lengths(), &x), None);
    }
}
