//! Triangles, lines and dots as pixels: what is nearer hides what is farther.

use super::canvas::{Image, Light};
use rayon::prelude::*;
use std::ops::Range;

/// Samples for each pixel of the picture, each way.
const SAMPLES: usize = 3;

/// Rows of the picture that are drawn together: the memory for samples does not grow with the height.
const BAND: usize = 32;

/// A corner of something drawn: pixels (y downwards), nearness and light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) nearness: f64,
    pub(super) light: Light,
}

/// A triangle that is part of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) corners: [Corner; 3],
    pub(super) face: u32,
}

/// A line or, of no length, a dot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) ends: [Corner; 2],
    /// Vertices at the ends of the edge that is drawn.
    pub(super) vertices: [usize; 2],
    /// Pixels.
    pub(super) width: f64,
    /// How much of what is below it hides, from 0 to 1.
    pub(super) cover: f32,
    /// How much nearer the line counts than it is, where a face is seen that has a vertex with it in common.
    pub(super) lift: f64,
    /// How much farther the line counts than it is, where another face is seen: what lies on it hides all of
    /// its width.
    pub(super) sink: f64,
}

/// All that a picture shows, in pixels.
pub(super) struct Drawing<'a> {
    /// Width and height, pixels.
    pub(super) size: [usize; 2],
    /// The corners of each face: an edge is not hidden by faces that it bounds.
    pub(super) faces: &'a [[usize; 3]],
    pub(super) facets: Vec<Facet>,
    /// Lines of the colour of ink. Where several meet the darkest counts.
    pub(super) strokes: Vec<Stroke>,
    pub(super) ink: Light,
    /// Dots and lines on top of all others, in their order, each of the light of its first end.
    pub(super) marks: Vec<Stroke>,
}

/// What is seen at a point of the picture.
#[derive(Clone, Copy)]
struct Sample {
    nearness: f64,
    light: Light,
    /// The face, or [`NONE`].
    face: u32,
    /// How much ink is over it.
    ink: f32,
}

/// Bytes of the samples that a thread keeps for each column of a picture.
pub(super) const MEMORY_OF_COLUMN: usize = BAND * SAMPLES * SAMPLES * size_of::<Sample>();

/// How far outside of a triangle a sample still counts as inside, as a part of the triangle.
const HAIR: f64 = 1e-7;

/// The number of no face.
const NONE: u32 = u32::MAX;

/// Some rows of samples.
struct Band {
    /// The first row, samples.
    top: usize,
    width: usize,
    height: usize,
    samples: Vec<Sample>,
}

impl Drawing<'_> {
    /// The picture, on white.
    pub(super) fn picture(&self) -> Image {
        let [width, height] = self.size;
        let mut image = Image::white(width, height);
        let bands = image.pixels.par_chunks_mut(width * BAND).enumerate();
        bands.for_each(|(k, pixels)| {
            let rows = pixels.len() / width;
            let mut band = Band::new(k * BAND * SAMPLES, width * SAMPLES, rows * SAMPLES);
            for facet in &self.facets {
                band.triangle(facet);
            }
            for stroke in &self.strokes {
                band.stroke(stroke, self.faces, |sample| {
                    sample.ink = sample.ink.max(stroke.cover);
                });
            }
            for mark in &self.marks {
                band.stroke(mark, self.faces, |sample| {
                    (sample.light, sample.ink) = (mark.ends[0].light, 0.0);
                });
            }
            band.reduce(self.ink, pixels);
        });
        image
    }
}

impl Band {
    fn new(top: usize, width: usize, height: usize) -> Self {
        let empty = Sample {
            nearness: f64::NEG_INFINITY,
            light: [1.0; 3],
            face: NONE,
            ink: 0.0,
        };
        Self {
            top,
            width,
            height,
            samples: vec![empty; width * height],
        }
    }

    /// Columns whose centres are between two places, pixels.
    fn columns(&self, low: f64, high: f64) -> Range<usize> {
        range(low, high, 0, self.width)
    }

    /// Rows whose centres are between two places, pixels.
    fn rows(&self, low: f64, high: f64) -> Range<usize> {
        range(low, high, self.top, self.height)
    }

    /// A triangle whose light is interpolated between its corners.
    fn triangle(&mut self, facet: &Facet) {
        let c = &facet.corners;
        let [low, high] = bounds(c.map(|c| c.y));
        let rows = self.rows(low, high);
        let area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
        // A millionth of a sample: such a triangle is a line.
        if rows.is_empty() || area.abs() < 1e-7 {
            return;
        }
        let [left, right] = bounds(c.map(|c| c.x));
        // The weights of the corners are linear: their values at the origin, and their changes by x and y.
        let weights = [0, 1, 2].map(|k| {
            let (p, q) = (&c[(k + 1) % 3], &c[(k + 2) % 3]);
            [p.x * q.y - q.x * p.y, p.y - q.y, q.x - p.x].map(|w| w / area)
        });
        for row in rows {
            let y = centre(self.top + row);
            let at_row = weights.map(|[w, dx, dy]| [w + dy * y, dx]);
            let (mut low, mut high) = (left, right);
            for [w, dx] in at_row {
                // A hair of overlap closes the cracks between neighbouring triangles.
                let end = -(w + HAIR) / dx;
                if dx > 0.0 {
                    low = low.max(end);
                } else if dx < 0.0 {
                    high = high.min(end);
                } else if w < -HAIR {
                    high = f64::NEG_INFINITY;
                }
            }
            let columns = self.columns(low, high);
            for column in columns {
                let x = centre(column);
                let b = at_row.map(|[w, dx]| w + dx * x);
                let nearness = (0..3).map(|k| b[k] * c[k].nearness).sum::<f64>();
                let sample = &mut self.samples[row * self.width + column];
                if nearness > sample.nearness {
                    let light = |k: usize| (0..3).map(|i| b[i] as f32 * c[i].light[k]).sum();
                    *sample = Sample {
                        nearness,
                        light: [0, 1, 2].map(light),
                        face: facet.face,
                        ink: 0.0,
                    };
                }
            }
        }
    }

    /// Draws where a stroke is not hidden. A face that the edge bounds does not hide it, and one that has a
    /// vertex with it in common does only where it is nearer by more than the lift.
    fn stroke(&mut self, stroke: &Stroke, faces: &[[usize; 3]], draw: impl Fn(&mut Sample)) {
        let [a, b] = &stroke.ends;
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let square = (dx * dx + dy * dy).max(1e-12);
        let radius = 0.5 * stroke.width;
        let [low, high] = bounds([a.y, b.y]);
        for row in self.rows(low - radius, high + radius) {
            let y = centre(self.top + row) - a.y;
            // The part of the line that is near this row.
            let part = |y: f64, otherwise: f64| if dy == 0.0 { otherwise } else { y / dy };
            let ends = [part(y - radius, 0.0), part(y + radius, 1.0)];
            let [left, right] = bounds(ends.map(|s| a.x + s.clamp(0.0, 1.0) * dx));
            for column in self.columns(left - radius, right + radius) {
                let x = centre(column) - a.x;
                let s = ((x * dx + y * dy) / square).clamp(0.0, 1.0);
                let aside = [x - s * dx, y - s * dy];
                if aside[0] * aside[0] + aside[1] * aside[1] > radius * radius {
                    continue;
                }
                let sample = &mut self.samples[row * self.width + column];
                let nearness = a.nearness + s * (b.nearness - a.nearness);
                let corners = faces.get(sample.face as usize);
                let common = corners.map_or(0, |face| {
                    let has = stroke.vertices.map(|v| face.contains(&v));
                    usize::from(has[0]) + usize::from(has[1])
                });
                let lift = [-stroke.sink, stroke.lift, f64::INFINITY][common];
                if nearness + lift > sample.nearness {
                    draw(sample);
                }
            }
        }
    }

    /// The mean of the samples of each pixel, with their ink.
    fn reduce(&self, ink: Light, pixels: &mut [Light]) {
        let weight = 1.0 / (SAMPLES * SAMPLES) as f32;
        let width = self.width / SAMPLES;
        for (k, pixel) in pixels.iter_mut().enumerate() {
            let (x, y) = (k % width * SAMPLES, k / width * SAMPLES);
            let mut sum = [0.0; 3];
            for row in y..y + SAMPLES {
                for sample in &self.samples[row * self.width + x..][..SAMPLES] {
                    for i in 0..3 {
                        sum[i] += sample.light[i] + sample.ink * (ink[i] - sample.light[i]);
                    }
                }
            }
            *pixel = sum.map(|s| s * weight);
        }
    }
}

/// The place of the centre of a sample, pixels.
fn centre(number: usize) -> f64 {
    (number as f64 + 0.5) / SAMPLES as f64
}

/// Samples whose centres are between two places (pixels), of `count` that begin with `first`.
fn range(low: f64, high: f64, first: usize, count: usize) -> Range<usize> {
    let at = |c: f64| c * SAMPLES as f64 - 0.5 - first as f64;
    // Conversion from floats saturates.
    let end = (at(high).floor() + 1.0).max(0.0) as usize;
    let end = end.min(count);
    (at(low).ceil().max(0.0) as usize).min(end)..end
}

/// The smallest and the largest one.
fn bounds<const N: usize>(values: [f64; N]) -> [f64; 2] {
    let low = values.into_iter().fold(f64::INFINITY, f64::min);
    [low, values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

#[cfg(test)]
mod tests {
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
