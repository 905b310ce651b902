//! A shaded picture of a sheet.

use super::camera::{Camera, normal};
use super::canvas::{Corner, Depth, Image, light};
use super::error::PictureError;
use super::occlusion::openness;
use super::pieces::{Piece, cut};
use super::solid::Solid;
use super::vector::{axpy, dot};
use isosheet_mesh::{Topology, VertexId};
use std::collections::BTreeMap;

/// Pixels rendered for each pixel of the picture, each way.
const SUPERSAMPLING: usize = 3;

/// How far faces darken each other, as part of the extent of the sheet.
const REACH: f64 = 0.35;

/// Largest edge over which the shade of a body is interpolated, as part of that reach.
const GRAIN: f64 = 0.15;

/// How far lines are drawn in front of what they lie on, as part of the extent of the sheet.
pub(super) const LIFT: f64 = 0.004;

/// sRGB colours of lines, of pins and of immobile vertices.
pub(super) const INK: [u8; 3] = [38, 42, 48];
const PIN: [u8; 3] = [213, 94, 0];
const IMMOBILE: [u8; 3] = [240, 228, 66];

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct SheetPicture<'a> {
    /// The faces and edges of the sheet.
    pub topology: &'a Topology,
    /// Positions of its vertices (3V, metres).
    pub positions: &'a [f64],
    /// Vertices marked with a dot.
    pub pins: &'a [VertexId],
    /// Vertices marked with a dot of another colour.
    pub immobile: &'a [VertexId],
    /// Bodies that the sheet meets.
    pub solids: &'a [Solid],
}

impl SheetPicture<'_> {
    /// The vertices that are marked with dots, and their colours; pins come last, on top of the others.
    pub(super) fn dots(&self) -> impl Iterator<Item = (VertexId, [u8; 3])> {
        let immobile = self.immobile.iter().map(|&v| (v, IMMOBILE));
        immobile.chain(self.pins.iter().map(|&v| (v, PIN)))
    }

    pub(super) fn validate(&self) -> Result<(), PictureError> {
        let (count, vertices) = (self.positions.len(), self.topology.vertex_count());
        if count != 3 * vertices {
            return Err(PictureError::Coordinates { count, vertices });
        }
        if let Some(k) = self.positions.iter().position(|c| !c.is_finite()) {
            return Err(PictureError::NotFinite {
                vertex: VertexId((k / 3) as u32),
                value: self.positions[k],
            });
        }
        match self
            .pins
            .iter()
            .chain(self.immobile)
            .find(|v| v.index() >= vertices)
        {
            Some(&vertex) => Err(PictureError::Pin { vertex, vertices }),
            None => Ok(()),
        }
    }
}

/// How it is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Size of the picture, pixels; 480 x 480 by default.
    pub size: [usize; 2],
    /// sRGB colours of the upper and the lower side of the sheet as it lies flat. The default is paper white
    /// with a warm tint above, and below a blue that stays apart from it under any colour vision.
    pub sides: [[u8; 3]; 2],
    /// sRGB colour of bodies; a light grey by default.
    pub body: [u8; 3],
    /// Width of the wires, pixels; 0.7 by default. Edges of the boundary are 1.7 times as wide.
    pub wire: f64,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            size: [480, 480],
            sides: [[250, 240, 214], [120, 172, 214]],
            body: [186, 186, 182],
            wire: 0.7,
        }
    }
}

impl Look {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`PictureError::Size`] without pixels, [`PictureError::Wire`] for a width that is negative or not
    /// finite.
    pub fn validate(&self) -> Result<(), PictureError> {
        let [width, height] = self.size;
        if width == 0 || height == 0 {
            return Err(PictureError::Size { width, height });
        }
        if !(self.wire.is_finite() && self.wire >= 0.0) {
            return Err(PictureError::Wire { width: self.wire });
        }
        Ok(())
    }
}

/// Draws a sheet on white.
///
/// # Errors
/// Those of [`Look::validate`]; [`PictureError::Coordinates`], [`PictureError::NotFinite`] and
/// [`PictureError::Pin`] for a picture that does not fit together.
pub fn render(
    picture: &SheetPicture<'_>,
    camera: &Camera,
    look: &Look,
) -> Result<Image, PictureError> {
    look.validate()?;
    picture.validate()?;
    let [width, height] = look.size.map(|s| s * SUPERSAMPLING);
    let mut drawing = Drawing {
        camera,
        look,
        extent: extent(picture.positions.as_chunks::<3>().0),
        depth: Depth::new(width, height),
    };
    let mut scene = Triangles::of(picture);
    drawing.faces(&mut scene);
    drawing.wires(picture.topology, &scene);
    for (v, colour) in picture.dots() {
        drawing.dot(&scene.x[v.index()], colour);
    }
    Ok(drawing.depth.image.reduced(SUPERSAMPLING))
}

/// The triangles of the sheet and of bodies, the sheet first.
pub(super) struct Triangles {
    pub(super) x: Vec<[f64; 3]>,
    pub(super) faces: Vec<[usize; 3]>,
    /// Faces of the sheet.
    pub(super) own: usize,
    /// Edges of bodies.
    pub(super) ridges: Vec<[usize; 2]>,
}

impl Triangles {
    pub(super) fn of(picture: &SheetPicture<'_>) -> Self {
        let own = picture.topology.faces().iter();
        let mut scene = Self {
            x: picture.positions.as_chunks::<3>().0.to_vec(),
            faces: own.map(|f| f.map(VertexId::index)).collect(),
            own: picture.topology.face_count(),
            ridges: Vec::new(),
        };
        for solid in picture.solids {
            let first = scene.x.len();
            scene.x.extend(&solid.points);
            let faces = solid.faces.iter();
            scene.faces.extend(faces.map(|f| f.map(|v| v + first)));
            let edges = solid.edges.iter();
            scene.ridges.extend(edges.map(|e| e.map(|v| v + first)));
        }
        scene
    }
}

/// The light on a face with the unit normal `n` towards the viewer: that of the surroundings, which are
/// brighter above, and that of a key light at the upper left.
pub(super) fn light_on(camera: &Camera, n: &[f64; 3], corners: &[[f64; 3]; 3]) -> [f64; 2] {
    let facing = dot(n, &camera.viewer(&centre(corners)));
    let key = camera.direction([-0.55, 0.75, 0.65]);
    [
        0.56 + 0.10 * n[2] + 0.12 * facing,
        0.42 * dot(n, &key).max(0.0),
    ]
}

/// A picture in the making.
struct Drawing<'a> {
    camera: &'a Camera,
    look: &'a Look,
    /// Largest side of the box around the sheet, metres.
    extent: f64,
    depth: Depth,
}

impl Drawing<'_> {
    /// Where a point is in the picture.
    fn place(&self, p: &[f64; 3], shade: f64) -> Corner {
        let q = self.camera.project(p);
        let [width, height] = self.look.size.map(|s| (s * SUPERSAMPLING) as f64);
        Corner {
            x: 0.5 * (width + q.x * height),
            y: 0.5 * height * (1.0 - q.y),
            nearness: q.nearness,
            shade,
        }
    }

    /// Whether some of the box around a piece is in the picture.
    fn shows(&self, corners: &[Corner; 3]) -> bool {
        let [width, height] = self.look.size.map(|s| (s * SUPERSAMPLING) as f64);
        let meets = |of: fn(&Corner) -> f64, size: f64| {
            corners.iter().any(|c| of(c) >= 0.0) && corners.iter().any(|c| of(c) <= size)
        };
        meets(|c| c.x, width) && meets(|c| c.y, height)
    }

    /// The faces of the sheet as they are; those of bodies are large, and are cut as their shade changes
    /// within.
    fn pieces(&self, scene: &mut Triangles) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut halves = BTreeMap::new();
        for (face, corners) in scene.faces.iter().enumerate() {
            let points = corners.map(|v| scene.x[v]);
            let piece = Piece {
                corners: *corners,
                face,
                back: dot(&normal(&points), &self.camera.viewer(&centre(&points))) < 0.0,
            };
            if face < scene.own {
                pieces.push(piece);
                continue;
            }
            let grain = GRAIN * REACH * self.extent;
            let mut parts = cut(piece, grain, &mut scene.x, &mut halves);
            parts.retain(|p| self.shows(&p.corners.map(|v| self.place(&scene.x[v], 1.0))));
            pieces.extend(parts);
        }
        pieces
    }

    /// All faces.
    fn faces(&mut self, scene: &mut Triangles) {
        let pieces = self.pieces(scene);
        let mut open = openness(&pieces, &scene.faces, &scene.x, REACH * self.extent);
        smooth(&pieces[scene.own..], &scene.x, &mut open[scene.own..]);
        for (piece, open) in pieces.iter().zip(&open) {
            let corners = piece.corners.map(|v| scene.x[v]);
            let n = normal(&corners);
            let n = if piece.back { n.map(|c| -c) } else { n };
            let [sky, sun] = light_on(self.camera, &n, &corners);
            let shaded = [0, 1, 2].map(|i| {
                let o = open[i];
                self.place(&corners[i], sky * o + sun * (0.4 + 0.6 * o))
            });
            let colour = if piece.face < scene.own {
                self.look.sides[usize::from(piece.back)]
            } else {
                self.look.body
            };
            self.depth.triangle(&shaded, light(colour));
        }
    }

    /// Where a point is in the picture when it is lifted towards the viewer by this part of the extent.
    fn raised(&self, p: &[f64; 3], part: f64) -> Corner {
        self.place(&axpy(p, part * self.extent, &self.camera.viewer(p)), 1.0)
    }

    /// Edges of bodies and of the sheet, a little nearer than the faces that they bound.
    fn wires(&mut self, topology: &Topology, scene: &Triangles) {
        let wire = self.look.wire * SUPERSAMPLING as f64;
        let ends = |drawing: &Self, e: [usize; 2]| e.map(|v| drawing.raised(&scene.x[v], LIFT));
        for ridge in &scene.ridges {
            let [a, b] = ends(self, *ridge);
            self.depth.line(&a, &b, wire, light(INK), 0.8);
        }
        for e in topology.edge_ids() {
            let edge = topology.edges()[e.index()];
            let [a, b] = ends(self, edge.map(VertexId::index));
            let (width, cover) = if topology.is_boundary_edge(e) {
                (1.7 * wire, 0.9)
            } else {
                (wire, 0.55)
            };
            self.depth.line(&a, &b, width, light(INK), cover);
        }
    }

    /// A dot with a rim.
    fn dot(&mut self, p: &[f64; 3], colour: [u8; 3]) {
        let c = self.raised(p, 3.0 * LIFT);
        let nearer = Corner {
            nearness: c.nearness + LIFT * self.extent,
            ..c
        };
        for (at, width, colour) in [(c, 9.0, INK), (nearer, 6.0, colour)] {
            let width = width * SUPERSAMPLING as f64;
            self.depth.line(&at, &at, width, light(colour), 1.0);
        }
    }
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

/// The centre of gravity of a triangle.
pub(super) fn centre(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0)
}

/// Largest side of the box around the points.
pub(super) fn extent(x: &[[f64; 3]]) -> f64 {
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
            immobile: &[],
            solids: &[],
        };
        let middle = |elevation: f64| {
            let camera = Camera::new([0.5, 0.5, 0.0], -90.0, elevation, 1.5, 100.0);
            let image = render(&picture, &camera, &look).unwrap();
            assert_eq!(image.pixels[0], [1.0; 3], "the background is white");
            image.pixels[28 * 64 + 36]
        };
        let (above, below) = (middle(80.0), middle(-80.0));
        assert!(above[0] > above[2], "warm above: {above:?}");
        assert!(below[2] > below[0], "blue below: {below:?}");
    }

    #[test]
    fn what_does_not_fit_together_is_named() {
        let sheet = isotropic_square(0, 1.0).unwrap();
        let camera = Camera::new([0.0; 3], 0.0, 45.0, 1.0, 3.0);
        let with = |positions: &[f64], pins: &[VertexId], look: Look| {
            let picture = SheetPicture {
                topology: sheet.topology(),
                positions,
                pins,
                immobile: &[],
                solids: &[],
            };
            render(&picture, &camera, &look).map(|image| image.size())
        };
        let (look, x) = (Look::default(), sheet.positions());
        assert_eq!(with(x, &[VertexId(8)], look).unwrap(), look.size);
        let mut broken = x.to_vec();
        broken[4] = f64::NAN;
        let sizeless = Look {
            size: [0, 4],
            ..look
        };
        let errors = [
            with(&x[1..], &[], look),
            with(&broken, &[], look),
            with(x, &[VertexId(9)], look),
            with(x, &[], sizeless),
            with(x, &[], Look { wire: -1.0, ..look }),
        ]
        .map(|result| result.unwrap_err().to_string());
        for (error, words) in errors.iter().zip([
            "26 coordinates for 9 vertices",
            "vertex 1 is at NaN",
            "pin vertex 9",
            "0 x 4 pixels",
            "width -1",
        ]) {
            assert!(error.contains(words), "{error}");
        }
    }
}
