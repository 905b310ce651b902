//! A shaded picture of a sheet.

use super::camera::Camera;
use super::canvas::{Image, light};
use super::colours::Colours;
use super::drawing::Drawing;
use super::error::PictureError;
use super::pieces::Cutter;
use super::solid::{DrawnSolid, Triangles};
use isosheet_files::DataError;
use isosheet_mesh::wording::{brief, counted, given};
use isosheet_mesh::{EdgeId, Part, Topology, VertexId};

/// How far half-spaces are drawn around the middle, as part of what the picture shows.
pub(super) const GROUND: f64 = 0.8;

/// Largest edge over which the light on a body is interpolated, as part of the height of the picture.
pub(super) const GRAIN: f64 = 0.035;

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
    pub solids: &'a [DrawnSolid],
    /// Of several sheets where each is in the topology, in their order; empty for one.
    pub parts: &'a [Part],
    /// What the sheet is coloured by instead of its sides.
    pub colours: Option<&'a Colours>,
    /// The height of a ground that shows nothing but soft shadows, metres; none by default.
    pub ground: Option<f64>,
}

impl<'a> SheetPicture<'a> {
    /// One sheet at positions (3V, metres) by itself, in the colours of its sides, without ground.
    #[must_use]
    pub fn of(topology: &'a Topology, positions: &'a [f64]) -> Self {
        Self {
            topology,
            positions,
            pins: &[],
            immobile: &[],
            solids: &[],
            parts: &[],
            colours: None,
            ground: None,
        }
    }
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
            let vertices = counted(vertices, "vertex", "vertices");
            let message = format!("there are {count} coordinates for {vertices}");
            let error = DataError::new(message, "give three for each vertex");
            return Err(PictureError::Data(error));
        }
        if let Some(k) = self.positions.iter().position(|c| !c.is_finite()) {
            let (vertex, value) = (k / 3, self.positions[k]);
            let message = format!("{} is at {}", VertexId(vertex as u32), given(value));
            let error = DataError::new(message, "draw finite positions");
            return Err(PictureError::Data(error.at(vertex).value(value)));
        }
        if let Some(colours) = self.colours {
            colours.validate(self.topology)?;
        }
        match self
            .pins
            .iter()
            .chain(self.immobile)
            .find(|v| v.index() >= vertices)
        {
            Some(&vertex) => {
                let vertices = counted(vertices, "vertex", "vertices");
                let message =
                    format!("the pin {vertex} is no vertex of the sheet, which has {vertices}");
                let error = DataError::new(message, "name one of them").at(vertex.index());
                Err(PictureError::Data(error))
            }
            None => Ok(()),
        }
    }
}

/// How it is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Size of the picture, pixels; 480 x 480 by default.
    pub size: [usize; 2],
    /// sRGB colours of the upper and the lower side of the sheet as it lies flat; several sheets take them by
    /// turns. By default the first one is paper white with a warm tint above, and below a blue that stays
    /// apart from it under any colour vision; the others are tints above that stay apart from each other,
    /// with a darker side below.
    pub sides: [[[u8; 3]; 2]; 6],
    /// sRGB colour of bodies; a light grey by default.
    pub body: [u8; 3],
    /// Width of the wires, pixels; 0.7 by default. Edges of the boundary are 1.7 times as wide, and creases
    /// 1.4 times.
    pub wire: f64,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            size: [480, 480],
            sides: [
                [[250, 240, 214], [120, 172, 214]],
                [[160, 206, 222], [66, 122, 146]],
                [[246, 190, 140], [190, 106, 52]],
                [[188, 216, 150], [98, 140, 62]],
                [[214, 186, 222], [136, 92, 152]],
                [[244, 222, 112], [178, 146, 30]],
            ],
            body: [186, 186, 182],
            wire: 0.7,
        }
    }
}

impl Look {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`PictureError::Options`] without pixels, and for a width that is negative or not finite.
    pub fn validate(&self) -> Result<(), PictureError> {
        let [width, height] = self.size;
        if width == 0 || height == 0 || width.checked_mul(height).is_none() {
            return Err(PictureError::size(width, height));
        }
        if !(self.wire.is_finite() && self.wire >= 0.0) {
            let message = format!("wires have the width {}", brief(self.wire));
            let error = DataError::new(message, "give a finite one of at least 0 pixels");
            return Err(PictureError::Options(error.value(self.wire)));
        }
        Ok(())
    }
}

/// Draws a sheet on white.
///
/// # Errors
/// Errors of [`Look::validate`]; [`PictureError::Data`] for a picture that does not fit together.
pub fn render(
    picture: &SheetPicture<'_>,
    camera: &Camera,
    look: &Look,
) -> Result<Image, PictureError> {
    render_folded(picture, &[], camera, look)
}

/// Draws a sheet on white with lines along some of its edges, where it folds, however fine its mesh is.
///
/// # Errors
/// Errors of [`render`].
pub fn render_folded(
    picture: &SheetPicture<'_>,
    creases: &[EdgeId],
    camera: &Camera,
    look: &Look,
) -> Result<Image, PictureError> {
    look.validate()?;
    picture.validate()?;
    if let Some(crease) = creases
        .iter()
        .find(|e| e.index() >= picture.topology.edge_count())
    {
        let message = format!("the crease {crease} is none of the edges of the sheet");
        let error = DataError::new(message, "name one of them").at(crease.index());
        return Err(PictureError::Data(error));
    }
    let painter = Painter {
        colours: picture.colours,
        ..Painter::new(camera, look)
    };
    let mut scene = painter.scene(picture);
    let pieces = painter.cutter(GRAIN).pieces(&mut scene);
    let facets = painter.facets(&pieces, &mut scene);
    let drawing = Drawing {
        size: look.size,
        facets,
        strokes: painter.wires(picture.topology, creases, &scene),
        ink: light(INK),
        marks: painter.marks(picture, &scene),
        faces: &scene.faces,
    };
    Ok(drawing.picture())
}

/// A viewer, and how things look.
pub(super) struct Painter<'a> {
    pub(super) camera: &'a Camera,
    pub(super) look: &'a Look,
    /// Width and height, pixels.
    pub(super) size: [f64; 2],
    /// The larger side of what the picture shows, metres.
    pub(super) scale: f64,
    /// What the sheet is coloured by instead of its sides.
    pub(super) colours: Option<&'a Colours>,
}

impl<'a> Painter<'a> {
    pub(super) fn new(camera: &'a Camera, look: &'a Look) -> Self {
        let size = look.size.map(|s| s as f64);
        let scale = camera.scale(size[0] / size[1]);
        Self {
            camera,
            look,
            size,
            scale,
            colours: None,
        }
    }

    /// The triangles of a picture.
    pub(super) fn scene(&self, picture: &SheetPicture<'_>) -> Triangles {
        let (target, reach) = (self.camera.target(), GROUND * self.scale);
        let SheetPicture {
            topology,
            positions,
            solids,
            parts,
            ..
        } = *picture;
        let mut scene = Triangles::new(topology, positions, solids, &target, reach);
        if let Some(height) = picture.ground {
            scene.add_ground(height, &target, reach);
        }
        scene.sheets = parts.iter().map(|part| part.faces.end).collect();
        scene
    }

    /// What cuts faces of bodies until edges are at most so long, as a part of the height of the picture.
    pub(super) fn cutter(&self, grain: f64) -> Cutter<'a> {
        Cutter {
            camera: self.camera,
            size: self.size,
            pixels: grain * self.size[1],
        }
    }

    /// Where a point is in the picture, pixels from the upper left corner, and its nearness.
    pub(super) fn place(&self, p: &[f64; 3]) -> [f64; 3] {
        let q = self.camera.project(p);
        let [width, height] = self.size;
        [
            0.5 * (width + q.x * height),
            0.5 * height * (1.0 - q.y),
            q.nearness,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::Light;
    use super::super::shading::CONTRAST;
    use super::*;
    use isosheet_mesh::Sheet;
    use isosheet_mesh::generate::isotropic_square;

    /// Two squares side by side, each in the colour that it has as the first or the second sheet.
    #[test]
    fn every_sheet_has_its_own_colour() {
        let sheet = isotropic_square(0, 1.0).unwrap();
        let beside = sheet.map_positions(|[x, y, z]| [x + 1.5, y, z]).unwrap();
        let sheets = [&sheet, &beside];
        let union = Sheet::union(&sheets).unwrap();
        let look = Look {
            size: [128, 64],
            wire: 0.0,
            ..Look::default()
        };
        let colours = |parts: &[Part]| {
            let picture = SheetPicture {
                parts,
                ..SheetPicture::of(union.topology(), union.positions())
            };
            let camera = Camera::new([1.25, 0.5, 0.0], -90.0, 90.0, 1.5, 100.0);
            let image = render(&picture, &camera, &look).unwrap();
            // 0.75 to either side of the middle are 32 pixels.
            [32, 96].map(|x| image.pixels[32 * 128 + x])
        };
        let [first, second] = colours(&Part::of_union(&sheets));
        assert!(
            first[0] > first[2] && second[2] > second[0],
            "{first:?} {second:?}"
        );
        let alike = colours(&[]);
        assert!(alike.iter().all(|c| c[0] > c[2]), "{alike:?}");
    }

    #[test]
    fn the_two_sides_have_their_own_colours() {
        let sheet = isotropic_square(0, 1.0).unwrap();
        let look = Look {
            size: [64, 64],
            ..Look::default()
        };
        let picture = SheetPicture::of(sheet.topology(), sheet.positions());
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

    /// A floor ends nowhere at the border of a picture, whatever the shape of that, and is there in its
    /// middle.
    #[test]
    fn floors_fade_out_before_the_picture_ends() {
        use isosheet_collide::Obstacle;
        use isosheet_geometry::Shape;
        let sheet = isotropic_square(0, 0.1).unwrap();
        let floor = Obstacle::at(Shape::HalfSpace, [0.0, 0.0, -0.1]).unwrap();
        let floor = DrawnSolid::of(&floor, 0.0).unwrap();
        for size in [[96, 64], [64, 96], [80, 80]] {
            let look = Look {
                size,
                ..Look::default()
            };
            let picture = SheetPicture {
                solids: std::slice::from_ref(&floor),
                ..SheetPicture::of(sheet.topology(), sheet.positions())
            };
            let camera = Camera::new([0.0; 3], -60.0, 30.0, 1.0, 6.0);
            let image = render(&picture, &camera, &look).unwrap();
            let [width, height] = size;
            let dark = |x: usize, y: usize| 1.0 - image.pixels[y * width + x][1];
            let is_border = |x, y| x == 0 || y == 0 || x == width - 1 || y == height - 1;
            let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let border = all.filter(|(x, y)| is_border(*x, *y));
            let darkest = border.map(|(x, y)| dark(x, y)).fold(0.0, f32::max);
            // Pieces are a few pixels large, over which the light is linear.
            assert!(f64::from(darkest) < 0.5 * CONTRAST, "{size:?}: {darkest}");
            assert!(dark(width / 2, 2 * height / 3) > 0.2, "{size:?}");
        }
    }

    /// Colours of vertices, faces and edges are where they belong, on both sides; edges that show nothing
    /// leave the sides as they are.
    #[test]
    fn sheets_are_coloured_by_values() {
        let sheet = isotropic_square(1, 1.0).unwrap();
        let (t, red) = (sheet.topology(), [220, 0, 0]);
        let look = Look {
            size: [96, 96],
            wire: 0.0,
            ..Look::default()
        };
        let seen = |colours: &Colours, elevation: f64| {
            let picture = SheetPicture {
                colours: Some(colours),
                ..SheetPicture::of(t, sheet.positions())
            };
            let camera = Camera::new([0.5, 0.5, 0.0], -90.0, elevation, 1.5, 100.0);
            render(&picture, &camera, &look).unwrap()
        };
        // The square has 64 x 64 pixels.
        let red_part = |image: &Image| {
            let is_red = |p: &&Light| p[0] > 0.2 && p[1] < 0.75 * p[0];
            image.pixels.iter().filter(is_red).count() as f64 / (64.0 * 64.0)
        };
        let faces = Colours::Faces(vec![red; t.face_count()]);
        let vertices = Colours::Vertices(vec![red; t.vertex_count()]);
        for elevation in [85.0, -85.0] {
            for colours in [&faces, &vertices] {
                assert!(red_part(&seen(colours, elevation)) > 0.95);
            }
        }
        let half = (0..t.face_count()).map(|f| if f % 2 == 0 { red } else { [0, 0, 220] });
        let part = red_part(&seen(&Colours::Faces(half.collect()), 85.0));
        assert!((part - 0.5).abs() < 0.05, "{part}");
        let all = red_part(&seen(&Colours::Edges(vec![red; t.edge_count()]), 85.0));
        let mut one = vec![None; t.edge_count()];
        let none = seen(&Colours::Creases(one.clone()), 85.0);
        one[0] = Some(red);
        let crease = red_part(&seen(&Colours::Creases(one), 85.0));
        assert!(0.0 < crease && 5.0 * crease < all, "{crease} and {all}");
        assert_eq!(red_part(&none), 0.0);
        let middle = none.pixels[40 * 96 + 55];
        assert!(middle[0] > middle[2], "paper: {middle:?}");
    }

    /// A ground is dark below the sheet and white elsewhere, as the border of the picture is; from below it
    /// is not seen.
    #[test]
    fn a_ground_shows_shadows_alone() {
        let sheet = isotropic_square(0, 0.1).unwrap();
        let look = Look {
            size: [96, 96],
            ..Look::default()
        };
        let seen = |elevation: f64, ground: Option<f64>| {
            let picture = SheetPicture {
                ground,
                ..SheetPicture::of(sheet.topology(), sheet.positions())
            };
            let camera = Camera::new([0.05, 0.05, 0.0], -90.0, elevation, 0.4, 6.0);
            render(&picture, &camera, &look).unwrap().pixels
        };
        let (with, without) = (seen(30.0, Some(-0.05)), seen(30.0, None));
        // 0.05 m below the sheet are ten pixels, from its near side on.
        let below = 64 * 96 + 48;
        assert_eq!(without[below], [1.0; 3]);
        assert!(with[below][0] < 0.95, "{:?}", with[below]);
        for corner in [0, 95, 96 * 95, 96 * 96 - 1] {
            assert!(with[corner].iter().all(|c| *c > 0.999), "{corner}");
        }
        let changed = with
            .iter()
            .zip(&without)
            .filter(|(a, b)| a[0] > b[0] + 1e-3);
        assert_eq!(changed.count(), 0, "nothing is brighter");
        let is_white = |pixels: &[Light]| pixels.iter().filter(|p| **p == [1.0; 3]).count();
        assert_eq!(
            is_white(&seen(-30.0, Some(-0.05))),
            is_white(&seen(-30.0, None))
        );
    }

    #[test]
    fn what_does_not_fit_together_is_named() {
        let sheet = isotropic_square(0, 1.0).unwrap();
        let camera = Camera::new([0.0; 3], 0.0, 45.0, 1.0, 3.0);
        let with = |positions: &[f64], pins: &[VertexId], look: Look| {
            let picture = SheetPicture {
                pins,
                ..SheetPicture::of(sheet.topology(), positions)
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
