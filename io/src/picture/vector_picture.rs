//! A shaded picture of a sheet as a vector drawing.

use super::camera::{Camera, normal};
use super::canvas::{light, srgb};
use super::error::PictureError;
use super::pieces::{Piece, cut};
use super::sheet::{INK, LIFT, Look, SheetPicture, Triangles, centre, extent, light_on};
use super::vector::{axpy, dot};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Largest edge of a piece of a body, as a part of the extent of the sheet: pieces as small as the faces of a
/// usual sheet are in the right order before and behind these.
const GRAIN: f64 = 0.05;

/// Radius of the dot of a pin, pixels.
const DOT: f64 = 3.0;

/// A part of the drawing.
struct Mark {
    /// Larger for what is nearer to the viewer.
    nearness: f64,
    element: String,
}

/// Draws a sheet on white as an SVG document of the size that `look` says.
///
/// Faces are painted from the farthest to the nearest one (the painter's algorithm), by the mean depth of
/// their corners; faces of bodies are cut into pieces for this. Where faces penetrate or overlap in a circle,
/// no order is right. Light falls as in [`render`](super::render()), without the shadows of faces on each other.
///
/// # Errors
/// Those of [`Look::validate`]; [`PictureError::Coordinates`], [`PictureError::NotFinite`] and
/// [`PictureError::Pin`] for a picture that does not fit together.
pub fn render_svg(
    picture: &SheetPicture<'_>,
    camera: &Camera,
    look: &Look,
) -> Result<String, PictureError> {
    look.validate()?;
    picture.validate()?;
    let extent = extent(picture.positions.as_chunks::<3>().0);
    let mut triangles = Triangles::of(picture);
    let painter = Painter { camera, look };
    let mut marks = painter.faces(&mut triangles, GRAIN * extent);
    let raised = |p: &[f64; 3], part: f64| axpy(p, part * extent, &camera.viewer(p));
    for ridge in &triangles.ridges {
        let ends = ridge.map(|v| triangles.x[v]);
        marks.extend(painter.ridge(&ends, GRAIN * extent, LIFT * extent));
    }
    for (v, colour) in picture.dots() {
        marks.push(painter.dot(&raised(&triangles.x[v.index()], 3.0 * LIFT), colour));
    }
    // The sort is stable: marks of equal depth stay in the order of the sheet.
    marks.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    let [width, height] = look.size;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
         <g stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke-width=\"{}\">\n",
        look.wire
    );
    for mark in &marks {
        svg.push_str(&mark.element);
        svg.push('\n');
    }
    svg.push_str("</g>\n</svg>\n");
    Ok(svg)
}

struct Painter<'a> {
    camera: &'a Camera,
    look: &'a Look,
}

impl Painter<'_> {
    /// Where a point is in the picture, pixels from the upper left corner, and its nearness.
    fn place(&self, p: &[f64; 3]) -> [f64; 3] {
        let q = self.camera.project(p);
        let [width, height] = self.look.size.map(|s| s as f64);
        [
            0.5 * (width + q.x * height),
            0.5 * height * (1.0 - q.y),
            q.nearness,
        ]
    }

    /// Whether the box around some points meets the picture.
    fn shows(&self, places: &[[f64; 3]]) -> bool {
        [0, 1].into_iter().all(|k| {
            let size = self.look.size[k] as f64;
            places.iter().any(|c| c[k] >= 0.0) && places.iter().any(|c| c[k] <= size)
        })
    }

    /// The faces of the sheet with their edges, and those of bodies in pieces without.
    fn faces(&self, triangles: &mut Triangles, grain: f64) -> Vec<Mark> {
        let mut marks = Vec::new();
        let mut halves = BTreeMap::new();
        for face in 0..triangles.faces.len() {
            let corners = triangles.faces[face];
            let points = corners.map(|v| triangles.x[v]);
            let n = normal(&points);
            let back = dot(&n, &self.camera.viewer(&centre(&points))) < 0.0;
            let is_sheet = face < triangles.own;
            let colour = if is_sheet {
                self.look.sides[usize::from(back)]
            } else {
                self.look.body
            };
            let fill = self.shaded(colour, &if back { n.map(|c| -c) } else { n }, &points);
            // Pieces of a body have an outline of their own colour, so that no gaps are seen between them.
            let stroke = if is_sheet { hex(INK) } else { fill.clone() };
            let whole = Piece {
                corners,
                face,
                back,
            };
            let limit = if is_sheet { f64::INFINITY } else { grain };
            for piece in cut(whole, limit, &mut triangles.x, &mut halves) {
                let places = piece.corners.map(|v| self.place(&triangles.x[v]));
                if !self.shows(&places) {
                    continue;
                }
                let mut element = String::from("<path d=\"M");
                for [x, y, _] in &places {
                    // Writing to a string cannot fail.
                    let _ = write!(element, "{x:.2} {y:.2} ");
                }
                let _ = write!(element, "Z\" fill=\"{fill}\" stroke=\"{stroke}\"/>");
                marks.push(Mark {
                    nearness: places.iter().map(|c| c[2]).sum::<f64>() / 3.0,
                    element,
                });
            }
        }
        marks
    }

    /// The colour of a face in its light.
    fn shaded(&self, colour: [u8; 3], n: &[f64; 3], corners: &[[f64; 3]; 3]) -> String {
        let [sky, sun] = light_on(self.camera, n, corners);
        hex(light(colour).map(|c| srgb(c * (sky + sun) as f32)))
    }

    /// An edge of a body in pieces, a little nearer than the faces that it bounds.
    fn ridge(&self, [a, b]: &[[f64; 3]; 2], grain: f64, lift: f64) -> Vec<Mark> {
        let d = [0, 1, 2].map(|k| b[k] - a[k]);
        let count = (dot(&d, &d).sqrt() / grain).ceil().max(1.0);
        let at = |k: f64| {
            let p = axpy(a, k / count, &d);
            self.place(&axpy(&p, lift, &self.camera.viewer(&p)))
        };
        let pieces = (0..count as usize).map(|k| [at(k as f64), at((k + 1) as f64)]);
        let mark = |[p, q]: [[f64; 3]; 2]| Mark {
            nearness: 0.5 * (p[2] + q[2]),
            element: format!(
                "<path d=\"M{:.2} {:.2} {:.2} {:.2}\" stroke=\"{}\"/>",
                p[0],
                p[1],
                q[0],
                q[1],
                hex(INK)
            ),
        };
        pieces.filter(|p| self.shows(p)).map(mark).collect()
    }

    /// A dot with a rim.
    fn dot(&self, p: &[f64; 3], colour: [u8; 3]) -> Mark {
        let [x, y, nearness] = self.place(p);
        Mark {
            nearness,
            element: format!(
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{DOT}\" fill=\"{}\" stroke=\"{}\"/>",
                hex(colour),
                hex(INK)
            ),
        }
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::super::vector_drawing::image;
    use super::*;
    use crate::picture::{Image, render};
    use isosheet_mesh::Sheet;

    /// Two triangles that lie over each other as seen from above, the first one higher.
    fn stacked(heights: [f64; 2]) -> Sheet {
        let triangle = |z: f64| [0.0, 0.0, z, 1.0, 0.0, z, 0.0, 1.0, z];
        let x = heights.map(triangle).concat();
        Sheet::new(x, &[[0, 1, 2], [3, 5, 4]]).unwrap()
    }

    fn both(sheet: &Sheet) -> [Image; 2] {
        let picture = SheetPicture {
            topology: sheet.topology(),
            positions: sheet.positions(),
            pins: &[],
            immobile: &[],
            solids: &[],
        };
        let camera = Camera::new([0.4, 0.4, 0.0], -60.0, 89.0, 1.4, 20.0);
        let look = Look {
            size: [90, 90],
            wire: 0.0,
            ..Look::default()
        };
        let svg = render_svg(&picture, &camera, &look).unwrap();
        [
            image(&svg).unwrap(),
            render(&picture, &camera, &look).unwrap(),
        ]
    }

    /// The upper of two faces hides the lower one whatever their order, as it does in pictures of pixels.
    #[test]
    fn near_faces_hide_far_ones() {
        let blue = |image: &Image| {
            let middle = image.pixels[image.width * 45 + 45];
            middle[2] > middle[0]
        };
        for heights in [[0.2, 0.0], [0.0, 0.2]] {
            let [vector, pixels] = both(&stacked(heights));
            assert_eq!(blue(&vector), heights[0] < heights[1], "{heights:?}");
            assert_eq!(blue(&vector), blue(&pixels), "{heights:?}");
            let covered = |image: &Image| image.pixels.iter().filter(|p| p[2] < 0.95).count();
            let [vector, pixels] = [covered(&vector) as f64, covered(&pixels) as f64];
            assert!(
                (vector / pixels - 1.0).abs() < 0.05,
                "{vector} and {pixels} pixels"
            );
        }
    }

    #[test]
    fn what_is_outside_of_the_values_is_refused() {
        let sheet = stacked([0.0, 1.0]);
        let picture = SheetPicture {
            topology: sheet.topology(),
            positions: &[f64::NAN; 18],
            pins: &[],
            immobile: &[],
            solids: &[],
        };
        let camera = Camera::new([0.0; 3], 0.0, 0.0, 1.0, 2.0);
        let result = render_svg(&picture, &camera, &Look::default());
        assert!(matches!(result, Err(PictureError::NotFinite { .. })));
    }
}
