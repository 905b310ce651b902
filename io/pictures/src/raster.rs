//! Triangles, lines and dots as pixels: what is nearer hides what is farther.

use super::band::{BAND, Band, Over, Plane, bins};
use super::canvas::Image;
use super::drawing::{Drawing, Facet, Stroke};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Which facets are seen in a picture of this size (pixels), each by itself.
pub(super) fn seen(size: [usize; 2], facets: &[Facet]) -> Vec<bool> {
    let seen: Vec<AtomicBool> = facets.iter().map(|_| AtomicBool::new(false)).collect();
    let planes: Vec<Option<Plane>> = facets.par_iter().map(Plane::of).collect();
    let bins = bins(size[1], planes.iter().map(Plane::rows));
    let bands = bins.par_iter().enumerate();
    bands.for_each_init(
        || Band::new(size[0]),
        |band, (k, bin)| {
            band.begin(k, size[1]);
            band.triangles(bin, &planes);
            for facet in band.seen() {
                seen[facet as usize].store(true, Ordering::Relaxed);
            }
        },
    );
    seen.into_iter().map(AtomicBool::into_inner).collect()
}

impl Drawing<'_> {
    /// The picture, on white.
    pub(super) fn picture(&self) -> Image {
        let [width, height] = self.size;
        let mut image = Image::white(width, height);
        let planes: Vec<Option<Plane>> = self.facets.par_iter().map(Plane::of).collect();
        let facets = bins(height, planes.iter().map(Plane::rows));
        let [strokes, marks] =
            [&self.strokes, &self.marks].map(|s| bins(height, s.iter().map(Stroke::rows)));
        let bands = image.pixels.par_chunks_mut(width * BAND).enumerate();
        bands.for_each_init(
            || Band::new(width),
            |band, (k, pixels)| {
                band.begin(k, height);
                band.triangles(&facets[k], &planes);
                for &number in &strokes[k] {
                    let stroke = &self.strokes[number as usize];
                    band.stroke(stroke, self, |over| match over {
                        Over::Ink(ink) => Over::Ink(ink.max(stroke.cover)),
                        Over::Mark(_) => over,
                    });
                }
                for &number in &marks[k] {
                    let mark = &self.marks[number as usize];
                    band.stroke(mark, self, |_| Over::Mark(number));
                }
                band.reduce(self, &planes, pixels);
            },
        );
        image
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::Light;
    use super::super::drawing::Corner;
    use super::*;

    fn corner(x: f64, y: f64, nearness: f64, light: Light) -> Corner {
        Corner {
            x,
            y,
            nearness,
            light,
        }
    }

    fn facet(face: u32, points: [[f64; 3]; 3], light: Light) -> Facet {
        let corners = points.map(|[x, y, z]| corner(x, y, z, light));
        Facet { corners, face }
    }

    fn drawing(size: [usize; 2], facets: Vec<Facet>) -> Drawing<'static> {
        Drawing {
            size,
            faces: &[[0, 1, 2], [3, 4, 5]],
            facets,
            strokes: Vec::new(),
            ink: [0.0; 3],
            marks: Vec::new(),
        }
    }

    /// Whether two colours are equal but for rounding.
    fn is_like(a: &Light, b: &Light) -> bool {
        (0..3).all(|k| (a[k] - b[k]).abs() < 1e-6)
    }

    const BIG: [[f64; 2]; 3] = [[-10.0, -10.0], [90.0, -10.0], [-10.0, 90.0]];

    fn big(face: u32, z: f64) -> Facet {
        let light = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][face as usize];
        facet(face, BIG.map(|[x, y]| [x, y, z]), light)
    }

    #[test]
    fn the_nearer_triangle_hides_the_farther_in_either_order() {
        for facets in [[big(0, 1.0), big(1, 2.0)], [big(1, 2.0), big(0, 1.0)]] {
            // More rows than a band has.
            let image = drawing([8, 40], facets.to_vec()).picture();
            assert!(image.pixels.iter().all(|p| is_like(p, &[0.0, 1.0, 0.0])));
        }
    }

    /// What another facet hides is not seen, nor what is outside or is a line; a corner that looks out is.
    #[test]
    fn hidden_facets_are_not_seen() {
        let at = |x: f64, size: f64, z: f64| {
            facet(
                0,
                [[0.0, 0.0], [size, 0.0], [0.0, size]].map(|[a, b]| [a + x, b, z]),
                [0.0; 3],
            )
        };
        let cover = at(0.0, 100.0, 1.0);
        let facets = [
            at(2.0, 5.0, 0.0),
            cover,
            at(60.0, 41.0, 0.0),
            at(-9.0, 8.0, 2.0),
            at(5.0, 0.0, 2.0),
        ];
        assert_eq!(seen([80, 80], &facets), [false, true, true, false, false]);
        assert_eq!(seen([8, 40], &facets), [false, true, false, false, false]);
    }

    #[test]
    fn neighbouring_triangles_leave_no_crack() {
        let [a, b, c, e] = [[3.0, 5.0], [60.0, 9.0], [7.0, 58.0], [55.0, 61.0]];
        let black = |points: [[f64; 2]; 3]| facet(0, points.map(|[x, y]| [x, y, 0.0]), [0.0; 3]);
        let image = drawing([64, 64], vec![black([a, b, c]), black([b, e, c])]).picture();
        for k in 14..50 {
            // Across the common side.
            assert_eq!(image.pixels[k * 64 + k], [0.0; 3], "pixel {k}");
        }
    }

    /// A line on the farther of two layers is hidden however close they are, and one on the nearer is seen.
    #[test]
    fn lines_behind_a_layer_are_hidden() {
        for (vertices, nearness, is_seen) in [([0, 1], 1.0, false), ([3, 4], 1.0 + 1e-9, true)] {
            let mut drawing = drawing([8, 8], vec![big(0, 1.0), big(1, 1.0 + 1e-9)]);
            let end = |x: f64| corner(x, 4.5, nearness, [0.0; 3]);
            drawing.strokes.push(Stroke {
                ends: [end(0.0), end(8.0)],
                vertices,
                width: 1.0,
                cover: 1.0,
                lift: 0.5,
                sink: 0.0,
            });
            let image = drawing.picture();
            let expected = if is_seen { [0.0; 3] } else { [0.0, 1.0, 0.0] };
            assert!(is_like(&image.pixels[4 * 8 + 4], &expected));
        }
    }

    /// A face that lies on an edge of a body hides it, however little it is in front; the faces of the body
    /// do not.
    #[test]
    fn what_lies_on_an_edge_hides_it() {
        for (vertices, is_seen) in [([3, 4], false), ([0, 1], true)] {
            let mut drawing = drawing([8, 8], vec![big(0, 1.0)]);
            let end = |x: f64| corner(x, 4.5, 1.0 + 1e-9, [0.0; 3]);
            drawing.strokes.push(Stroke {
                ends: [end(0.0), end(8.0)],
                vertices,
                width: 1.0,
                cover: 1.0,
                lift: 0.0,
                sink: 0.01,
            });
            let is_drawn = drawing.picture().pixels[4 * 8 + 4] == [0.0; 3];
            assert_eq!(is_drawn, is_seen, "{vertices:?}");
        }
    }

    /// Lines that cross are no darker where they do.
    #[test]
    fn ink_does_not_add_up() {
        let mut drawing = drawing([9, 9], Vec::new());
        for ends in [[[0.0, 4.5], [9.0, 4.5]], [[4.5, 0.0], [4.5, 9.0]]] {
            drawing.strokes.push(Stroke {
                ends: ends.map(|[x, y]| corner(x, y, 0.0, [0.0; 3])),
                vertices: [0, 1],
                width: 1.0,
                cover: 0.5,
                lift: 0.0,
                sink: 0.0,
            });
        }
        let image = drawing.picture();
        assert_eq!(image.pixels[4 * 9 + 4], [0.5; 3]);
        assert_eq!(image.pixels[4 * 9 + 7], [0.5; 3]);
        assert_eq!(image.pixels[0], [1.0; 3]);
    }
}
