//! A shaded picture of a sheet.

use super::camera::{Camera, normal};
use super::canvas::{Corner, Depth, Image, light};
use super::occlusion::openness;
use super::pieces::{Piece, cut};
use super::solid::Solid;
use crate::draw::spatial::{axpy, dot};
use isosheet_mesh::{Topology, VertexId};
use std::collections::BTreeMap;

/// Pixels rendered for each pixel of the picture, each way.
const SUPERSAMPLING: usize = 3;

/// How far faces darken each other, as part of the extent of the sheet.
const REACH: f64 = 0.35;

/// Largest edge over which the shade of a body is interpolated, as part of that reach.
const GRAIN: f64 = 0.15;

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetPicture<'a> {
    pub(crate) topology: &'a Topology,
    /// Positions, 3V.
    pub(crate) positions: &'a [f64],
    /// Vertices marked with a dot.
    pub(crate) pins: &'a [VertexId],
    /// Bodies that the sheet meets.
    pub(crate) solids: &'a [Solid],
}

/// How it is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// Size of the picture, pixels.
    pub(crate) size: [usize; 2],
    /// Colours of the upper and the lower side of the sheet as it lies flat.
    pub(crate) sides: [[u8; 3]; 2],
    /// Colour of bodies.
    pub(crate) body: [u8; 3],
    /// Width of the wires, pixels.
    pub(crate) wire: f64,
}

impl Default for Look {
    fn default() -> Self {
        // Paper white with a warm tint above, a blue that stays apart from it under any colour vision below.
        Self {
            size: [480, 480],
            sides: [[250, 240, 214], [120, 172, 214]],
            body: [186, 186, 182],
            wire: 0.7,
        }
    }
}

/// Renders a sheet on white.
pub(crate) fn render(picture: &SheetPicture<'_>, camera: &Camera, look: &Look) -> Image {
    let [width, height] = look.size.map(|s| s * SUPERSAMPLING);
    let mut depth = Depth::new(width, height);
    let mut x: Vec<[f64; 3]> = picture.positions.as_chunks::<3>().0.to_vec();
    let extent = extent(&x);
    let mut faces: Vec<[usize; 3]> = picture
        .topology
        .faces()
        .iter()
        .map(|f| f.map(VertexId::index))
        .collect();
    let own = faces.len();
    let mut ridges = Vec::new();
    for solid in picture.solids {
        let first = x.len();
        x.extend(&solid.points);
        faces.extend(solid.faces.iter().map(|f| f.map(|v| v + first)));
        ridges.extend(solid.edges.iter().map(|e| e.map(|v| v + first)));
    }
    let place = |p: &[f64; 3], shade: f64| {
        let q = camera.project(p);
        Corner {
            x: 0.5 * (width as f64 + q.x * height as f64),
            y: 0.5 * height as f64 * (1.0 - q.y),
            nearness: q.nearness,
            shade,
        }
    };
    // Whether some of the box around a piece is in the picture.
    let inside = |corners: &[Corner; 3]| {
        let meets = |of: fn(&Corner) -> f64, size: usize| {
            corners.iter().any(|c| of(c) >= 0.0) && corners.iter().any(|c| of(c) <= size as f64)
        };
        meets(|c| c.x, width) && meets(|c| c.y, height)
    };
    let reach = REACH * extent;
    // The faces of the sheet as they are; those of bodies are large, and their shade changes within.
    let mut pieces: Vec<Piece> = Vec::new();
    let mut halves = BTreeMap::new();
    for (face, corners) in faces.iter().enumerate() {
        let points = corners.map(|v| x[v]);
        let piece = Piece {
            corners: *corners,
            face,
            back: dot(&normal(&points), &camera.viewer(&centre(&points))) < 0.0,
        };
        if face < own {
            pieces.push(piece);
        } else {
            let mut parts = cut(piece, GRAIN * reach, &mut x, &mut halves);
            parts.retain(|part| inside(&part.corners.map(|v| place(&x[v], 1.0))));
            pieces.extend(parts);
        }
    }
    let mut open = openness(&pieces, &faces, &x, reach);
    smooth(&pieces[own..], &x, &mut open[own..]);
    // A key light from the upper left, and the surroundings, brighter from above.
    let key = camera.direction([-0.55, 0.75, 0.65]);
    for (k, piece) in pieces.iter().enumerate() {
        let corners = piece.corners.map(|v| x[v]);
        let n = normal(&corners);
        let n = if piece.back { n.map(|c| -c) } else { n };
        let sky = 0.56 + 0.10 * n[2] + 0.12 * dot(&n, &camera.viewer(&centre(&corners)));
        let sun = 0.42 * dot(&n, &key).max(0.0);
        let shaded = [0, 1, 2].map(|i| {
            let o = open[k][i];
            place(&corners[i], sky * o + sun * (0.4 + 0.6 * o))
        });
        let colour = if piece.face < own {
            look.sides[usize::from(piece.back)]
        } else {
            look.body
        };
        depth.triangle(&shaded, light(colour));
    }
    let ink = light([38, 42, 48]);
    // Wires lie a little nearer than the faces that they bound.
    let lift = 0.004 * extent;
    let wire = look.wire * SUPERSAMPLING as f64;
    let raised = |p: &[f64; 3]| place(&axpy(p, lift, &camera.viewer(p)), 1.0);
    for [a, b] in ridges {
        depth.line(&raised(&x[a]), &raised(&x[b]), wire, ink, 0.8);
    }
    for e in picture.topology.edge_ids() {
        let [a, b] = picture.topology.edges()[e.index()].map(|v| raised(&x[v.index()]));
        let (width, cover) = if picture.topology.is_boundary_edge(e) {
            (1.7 * wire, 0.9)
        } else {
            (wire, 0.55)
        };
        depth.line(&a, &b, width, ink, cover);
    }
    for pin in picture.pins {
        let p = x[pin.index()];
        let c = place(&axpy(&p, 3.0 * lift, &camera.viewer(&p)), 1.0);
        depth.line(&c, &c, 9.0 * SUPERSAMPLING as f64, ink, 1.0);
        let nearer = Corner {
            nearness: c.nearness + lift,
            ..c
        };
        depth.line(
            &nearer,
            &nearer,
            6.0 * SUPERSAMPLING as f64,
            light([213, 94, 0]),
            1.0,
        );
    }
    depth.image.reduced(SUPERSAMPLING)
}

/// Replaces the openness of the corners of coplanar pieces that meet in a point by its mean there.
fn smooth(pieces: &[Piece], x: &[[f64; 3]], open: &mut [[f64; 3]]) {
    let key = |piece: &Piece, corner: usize| {
        let n = normal(&piece.corners.map(|v| x[v]));
        let n = n.map(|c| (1e6 * c).round() as i64);
        (piece.corners[corner], n, piece.back)
    };
    let mut sums: BTreeMap<_, [f64; 2]> = BTreeMap::new();
    for (piece, open) in pieces.iter().zip(&*open) {
        for corner in 0..3 {
            let [sum, count] = sums.entry(key(piece, corner)).or_default();
            *sum += open[corner];
            *count += 1.0;
        }
    }
    for (piece, open) in pieces.iter().zip(open) {
        for corner in 0..3 {
            let [sum, count] = sums[&key(piece, corner)];
            open[corner] = sum / count;
        }
    }
}

fn centre(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0)
}

/// Largest side of the box around the points.
fn extent(x: &[[f64; 3]]) -> f64 {
    (0..3)
        .map(|k| {
            let low = x.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
            x.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max) - low
        })
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate::isotropic_square;

    #[test]
    fn the_two_sides_have_their_own_colours() {
        let sheet = isotropic_square(0, 1.0).unwrap();
        let look = Look {
            size: [64, 64],
            ..Look::default()
        };
        let picture = SheetPicture {
            topology: sheet.topology(),
            positions: sheet.positions(),
            pins: &[],
            solids: &[],
        };
        let middle = |elevation: f64| {
            let camera = Camera::new([0.5, 0.5, 0.0], -90.0, elevation, 1.5, 100.0);
            let image = render(&picture, &camera, &look);
            assert_eq!(image.pixels[0], [1.0; 3], "the background is white");
            image.pixels[28 * 64 + 36]
        };
        let (above, below) = (middle(80.0), middle(-80.0));
        assert!(above[0] > above[2], "warm above: {above:?}");
        assert!(below[2] > below[0], "blue below: {below:?}");
    }
}
