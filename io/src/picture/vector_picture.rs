//! A shaded picture of a sheet as a vector drawing.

use super::camera::{Camera, centre, normal};
use super::canvas::srgb;
use super::error::PictureError;
use super::joined::{Mark, Shape, elements, hex, seen, step};
use super::pieces::Piece;
use super::sheet::{GRAIN, INK, LIFT, Look, Painter, SheetPicture, light_on};
use super::solid::Triangles;
use super::vector::axpy;

/// Radius of the dot of a pin, pixels.
const DOT: f64 = 3.0;

/// Draws a sheet on white as an SVG document of the size that `look` says.
///
/// Of two faces that overlap in the picture the farther one is painted first, as seen where they overlap. Where
/// faces penetrate or overlap in a circle, no order is right. Faces of bodies are cut into pieces of one colour each;
/// pieces of a body of about the same colour, and the parts of its edges, are joined again as far as nothing lies
/// between them. Light falls as in [`render`](super::render()), without the shadows of
/// faces on each other.
///
/// # Errors
/// Those of [`Look::validate`]; [`PictureError::Data`] for a picture that does not fit together.
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
    let cutter = painter.cutter(GRAIN);
    for (number, (ridge, skin)) in scene.ridges.iter().enumerate() {
        if scene.shows(number, &camera.eye()) {
            let shape = || Shape::Line {
                layer: scene.layer_of_ridge(number),
                lift: LIFT * painter.scale,
            };
            let parts = cutter.parts(ridge.map(|v| scene.x[v]), skin).into_iter();
            marks.extend(parts.map(|ends| Mark {
                corners: ends.map(|p| painter.place(&p)).to_vec(),
                shape: shape(),
            }));
        }
    }
    for (v, colour) in picture.dots() {
        let p = &scene.x[v.index()];
        if !camera.is_behind(p) {
            marks.push(dot(&painter, p, colour));
        }
    }
    let [width, height] = look.size;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
         <g stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke-width=\"{}\">\n",
        look.wire
    );
    for element in elements(&marks, &hex(INK)) {
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
    let mark = |piece: &Piece| {
        let numbers = seen(piece);
        let points = numbers.map(|v| scene.x[v]);
        let skin = scene.skin(piece.face);
        let places = points.map(|p| painter.place(&p));
        if points.iter().any(|p| painter.camera.is_behind(p)) || !shows(painter, &places) {
            return None;
        }
        let flat = normal(&points);
        let centre = centre(&points);
        let n = skin
            .as_ref()
            .map_or(flat, |skin| skin.normal(&flat, &centre));
        let [sky, sun] = light_on(painter.camera, &n, &centre);
        let colour = painter.colour(piece, scene, &centre, sky + sun).map(srgb);
        let shape = match skin {
            None => {
                let [[a, b, _], [c, d, _], [e, f, _]] = places;
                let (fill, ink) = (hex(colour), hex(INK));
                Shape::Element(format!(
                    "<path d=\"M{a:.2} {b:.2} {c:.2} {d:.2} {e:.2} {f:.2}Z\" fill=\"{fill}\" stroke=\"{ink}\"/>"
                ))
            }
            Some(_) => Shape::Area {
                layer: scene.layer_of_face(piece.face),
                numbers,
                colour: step(colour),
            },
        };
        Some(Mark {
            corners: places.to_vec(),
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

/// A dot with a rim.
fn dot(painter: &Painter<'_>, p: &[f64; 3], colour: [u8; 3]) -> Mark {
    let raised = axpy(p, 3.0 * LIFT * painter.scale, &painter.camera.viewer(p));
    let [x, y, nearness] = painter.place(&raised);
    Mark {
        corners: [[-DOT, -DOT], [DOT, -DOT], [DOT, DOT], [-DOT, DOT]]
            .map(|[dx, dy]| [x + dx, y + dy, nearness])
            .to_vec(),
        shape: Shape::Element(format!(
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{DOT}\" fill=\"{}\" stroke=\"{}\"/>",
            hex(colour),
            hex(INK)
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::super::vector_drawing::image;
    use super::*;
    use crate::picture::{Image, Solid, render};
    use isosheet_mesh::Sheet;
    use isosheet_mesh::generate::Diagonals;

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

    /// A sheet of two large faces that lies closely on one of many small ones: these are all hidden, although half of
    /// them are nearer to the viewer than the middle of the face above them. With a box below, which is hidden too.
    #[test]
    fn closely_stacked_sheets_hide_each_other() {
        let small = isosheet_mesh::generate::isotropic_square(3, 1.0).unwrap();
        let large = isosheet_mesh::generate::grid(1, 1, 1.0, 1.0, Diagonals::Rising).unwrap();
        let large = large.map_positions(|[x, y, _]| [x, y, 0.002]).unwrap();
        let sheet = Sheet::union(&[&small, &large]).unwrap();
        let shape = isosheet_collide::Shape::Cuboid {
            half: [0.3, 0.2, 0.1],
        };
        let pose = nalgebra::Isometry3::translation(0.5, 0.5, -0.102);
        let body = isosheet_collide::Obstacle::fixed(shape, pose).unwrap();
        let picture = SheetPicture {
            topology: sheet.topology(),
            positions: sheet.positions(),
            pins: &[],
            immobile: &[],
            solids: &[Solid::of(&body, 0.0).unwrap()],
            parts: &isosheet_mesh::Part::of_union(&[&small, &large]),
        };
        let sides = [[[255, 0, 0]; 2], [[0, 0, 255]; 2]].repeat(3);
        let look = Look {
            size: [200, 200],
            wire: 0.0,
            sides: sides.try_into().unwrap(),
            ..Look::default()
        };
        let red = |image: &Image| image.pixels.iter().filter(|p| p[0] > 2.0 * p[2]).count();
        let blue = |image: &Image| image.pixels.iter().filter(|p| p[2] > 2.0 * p[0]).count();
        for elevation in [20.0, 50.0, -35.0] {
            let camera = Camera::new([0.5, 0.5, 0.0], -60.0, elevation, 1.6, 3.0);
            let vector = image(&render_svg(&picture, &camera, &look).unwrap()).unwrap();
            let pixels = render(&picture, &camera, &look).unwrap();
            for (count, name) in [(red as fn(&Image) -> usize, "red"), (blue, "blue")] {
                let [vector, pixels] = [&vector, &pixels].map(count);
                assert!(
                    vector.abs_diff(pixels) < 400,
                    "{vector} and {pixels} {name} pixels from {elevation} degrees"
                );
            }
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
        assert!(matches!(result, Err(PictureError::Data(_))));
    }
}
