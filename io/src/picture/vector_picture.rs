//! A shaded picture of a sheet as a vector drawing.

use super::camera::{Camera, centre, normal};
use super::canvas::srgb;
use super::error::PictureError;
use super::joined::{Mark, Shape, bounds, elements, seen};
use super::pieces::Piece;
use super::sheet::{INK, LIFT, Look, Painter, SheetPicture, light_on};
use super::solid::{Skin, Triangles};
use super::vector::axpy;
use std::collections::HashSet;

/// Largest edge of a piece of a body, as a part of the height of the picture: pieces smaller than the faces
/// of a usual sheet are in the right order before and behind these.
const GRAIN: f64 = 0.025;

/// How much farther away bodies count than they are, as a part of what the picture shows: most of what
/// touches the sheet is behind it, and the faces of the sheet, whose mean depth counts, are larger than
/// pieces of bodies.
const BEHIND: f64 = 0.04;

/// Radius of the dot of a pin, pixels.
const DOT: f64 = 3.0;

/// Draws a sheet on white as an SVG document of the size that `look` says.
///
/// Faces are painted from the farthest to the nearest one (the painter's algorithm), by the mean depth of
/// their corners; faces of bodies are cut into pieces for this. Where faces penetrate or overlap in a circle,
/// no order is right. Pieces of a body of about the same colour, and the parts of its edges, are joined again
/// as far as nothing lies between them. Light falls as in [`render`](super::render()), without the shadows of
/// faces on each other.
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
    let painter = Painter::new(camera, look);
    let mut scene = painter.scene(picture);
    let mut marks = faces(&painter, &mut scene);
    for (number, (ridge, skin)) in scene.ridges.iter().enumerate() {
        let ends = ridge.map(|v| scene.x[v]);
        if scene.shows(number, &camera.eye()) {
            marks.extend(edge(&painter, ends, skin, scene.layer_of_ridge(number)));
        }
    }
    for (v, colour) in picture.dots() {
        let p = &scene.x[v.index()];
        if !camera.is_behind(p) {
            marks.push(dot(&painter, p, colour));
        }
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
    for element in elements(marks, &hex(INK)) {
        svg.push_str(&element);
        svg.push('\n');
    }
    svg.push_str("</g>\n</svg>\n");
    Ok(svg)
}

/// The faces of the sheet with their edges, and those of bodies in pieces without.
fn faces(painter: &Painter<'_>, scene: &mut Triangles) -> Vec<Mark> {
    let cutter = painter.cutter(GRAIN);
    let pieces = cutter.pieces(scene);
    let is_floor = |face: &usize| {
        matches!(scene.skin(*face), Some(Skin::Ground { .. }))
            && scene.is_floor(*face, LIFT * painter.scale)
    };
    let floors: HashSet<usize> = (scene.own..scene.faces.len()).filter(is_floor).collect();
    let mark = |piece: &Piece| {
        let points = piece.corners.map(|v| scene.x[v]);
        let skin = scene.skin(piece.face);
        let places = points.map(|p| painter.place(&p));
        if points.iter().any(|p| painter.camera.is_behind(p)) || !shows(painter, &places) {
            return None;
        }
        let flat = normal(&points);
        let flat = if piece.back { flat.map(|c| -c) } else { flat };
        let centre = centre(&points);
        let n = skin
            .as_ref()
            .map_or(flat, |skin| skin.normal(&flat, &centre));
        let [sky, sun] = light_on(painter.camera, &n, &centre);
        let colour = painter.colour(piece, scene, &centre, sky + sun).map(srgb);
        let behind = match &skin {
            None => 0.0,
            // What is above a floor is before it as seen from above.
            Some(_) if floors.contains(&piece.face) => f64::INFINITY,
            Some(_) => BEHIND * painter.scale,
        };
        let nearness = places.iter().map(|c| c[2]).sum::<f64>() / 3.0 - behind;
        let flat = places.map(|[x, y, _]| [x, y]);
        let shape = match skin {
            None => {
                let [[a, b], [c, d], [e, f]] = flat;
                let (fill, ink) = (hex(colour), hex(INK));
                Shape::Element(format!(
                    "<path d=\"M{a:.2} {b:.2} {c:.2} {d:.2} {e:.2} {f:.2}Z\" fill=\"{fill}\" stroke=\"{ink}\"/>"
                ))
            }
            Some(_) => {
                let corners = seen(piece);
                Shape::Area {
                    layer: scene.layer_of_face(piece.face),
                    corners,
                    places: corners.map(|v| {
                        let [x, y, _] = painter.place(&scene.x[v]);
                        [x, y]
                    }),
                    colour,
                }
            }
        };
        Some(Mark {
            nearness,
            bounds: bounds(&flat),
            shape,
        })
    };
    pieces.iter().filter_map(mark).collect()
}

/// Whether the box around some places meets the picture.
fn shows(painter: &Painter<'_>, places: &[[f64; 3]]) -> bool {
    [0, 1].into_iter().all(|k| {
        places.iter().any(|c| c[k] >= 0.0) && places.iter().any(|c| c[k] <= painter.size[k])
    })
}

/// An edge of a body in pieces, a little nearer than the faces that it bounds.
fn edge(painter: &Painter<'_>, ends: [[f64; 3]; 2], skin: &Skin, layer: usize) -> Vec<Mark> {
    let cutter = painter.cutter(GRAIN);
    let lift = LIFT * painter.scale;
    let raised = |p: &[f64; 3]| axpy(p, lift, &painter.camera.viewer(p));
    let mark = |ends: [[f64; 3]; 2]| {
        let [p, q] = ends.map(|p| painter.place(&raised(&p)));
        let ends = [p, q].map(|[x, y, _]| [x, y]);
        Mark {
            nearness: 0.5 * (p[2] + q[2]) - BEHIND * painter.scale,
            bounds: bounds(&ends),
            shape: Shape::Line { layer, ends },
        }
    };
    cutter.parts(ends, skin).into_iter().map(mark).collect()
}

/// A dot with a rim.
fn dot(painter: &Painter<'_>, p: &[f64; 3], colour: [u8; 3]) -> Mark {
    let raised = axpy(p, 3.0 * LIFT * painter.scale, &painter.camera.viewer(p));
    let [x, y, nearness] = painter.place(&raised);
    Mark {
        nearness,
        bounds: [[x - DOT, y - DOT], [x + DOT, y + DOT]],
        shape: Shape::Element(format!(
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{DOT}\" fill=\"{}\" stroke=\"{}\"/>",
            hex(colour),
            hex(INK)
        )),
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::super::vector_drawing::image;
    use super::*;
    use crate::picture::{Image, Solid, render};
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
            parts: &[],
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

    /// A box and a cylinder on a floor: few areas and lines, which look as the picture of pixels does.
    #[test]
    fn bodies_are_few_areas_and_lines() {
        let sheet = stacked([0.5, 0.4]);
        let at = |z: f64, shape: isosheet_collide::Shape| {
            let pose = nalgebra::Isometry3::translation(1.2, 0.3, z);
            let body = isosheet_collide::Obstacle::fixed(shape, pose).unwrap();
            Solid::of(&body, 0.0).unwrap()
        };
        let half = [0.3, 0.2, 0.2];
        let bodies = [
            at(0.2, isosheet_collide::Shape::Cuboid { half }),
            at(0.0, isosheet_collide::Shape::HalfSpace),
        ];
        let picture = |solids| SheetPicture {
            topology: sheet.topology(),
            positions: sheet.positions(),
            pins: &[],
            immobile: &[],
            solids,
            parts: &[],
        };
        let camera = Camera::new([0.8, 0.4, 0.2], -60.0, 30.0, 1.6, 20.0);
        let look = Look {
            size: [300, 200],
            ..Look::default()
        };
        let svg = render_svg(&picture(&bodies), &camera, &look).unwrap();
        let lines = svg.matches("fill=\"none\"").count();
        assert_eq!(lines, 1, "the edges of the box");
        let areas = svg.matches("<path").count() - lines - 2;
        assert!(areas < 60, "{areas} areas");
        // Three sides of the box are seen, with nine edges, and each has one colour or two.
        let outline = svg
            .lines()
            .find(|line| line.contains("fill=\"none\""))
            .unwrap();
        assert!(outline.matches('M').count() <= 5, "{outline}");
        let [vector, pixels] = [
            image(&svg).unwrap(),
            render(&picture(&bodies), &camera, &look).unwrap(),
        ];
        let near = |k: &usize| {
            let (a, b) = (vector.pixels[*k], pixels.pixels[*k]);
            (0..3).all(|c| (a[c] - b[c]).abs() < 0.25)
        };
        let same = (0..vector.pixels.len()).filter(near).count();
        assert!(same as f64 > 0.95 * vector.pixels.len() as f64, "{same}");
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
            parts: &[],
        };
        let camera = Camera::new([0.0; 3], 0.0, 0.0, 1.0, 2.0);
        let result = render_svg(&picture, &camera, &Look::default());
        assert!(matches!(result, Err(PictureError::NotFinite { .. })));
    }
}
