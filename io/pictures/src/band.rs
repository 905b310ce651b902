//! Some rows of a picture: what is seen at several points of each of its pixels.

use super::canvas::Light;
use super::drawing::{Drawing, Facet, Stroke, bounds};
use std::ops::Range;

/// Samples for each pixel of the picture, each way.
const SAMPLES: usize = 3;

/// Rows of the picture that are drawn together: the memory for samples does not grow with the height.
pub(super) const BAND: usize = 32;

/// Bytes of the samples that a thread keeps for each column of a picture.
pub(super) const MEMORY_OF_COLUMN: usize = BAND
    * (SAMPLES * SAMPLES * (size_of::<f64>() + size_of::<Over>() + size_of::<u32>())
        + size_of::<bool>());

/// How far outside of a triangle a sample still counts as inside, as a part of the triangle.
const HAIR: f64 = 1e-7;

/// The number of no facet.
const NONE: u32 = u32::MAX;

/// What is over the facet at a sample.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Over {
    /// So much ink.
    Ink(f32),
    /// The mark of this number.
    Mark(u32),
}

/// Linear functions of the place in the picture: their values at the origin, and their changes by x and y.
type Linear = [f64; 3];

/// A facet as it is drawn.
pub(super) struct Plane {
    /// The weights of the corners.
    weights: [Linear; 3],
    nearness: Linear,
    light: [Linear; 3],
    /// From the left to the right, and from above to below.
    bounds: [[f64; 2]; 2],
}

/// Some rows of samples.
pub(super) struct Band {
    /// The first row, samples.
    top: usize,
    width: usize,
    height: usize,
    nearness: Vec<f64>,
    /// The facet that is seen, or [`NONE`].
    facet: Vec<u32>,
    over: Vec<Over>,
    /// Whether anything is over a pixel.
    is_covered: Vec<bool>,
}

/// Of each band the things with rows in it, in their order.
pub(super) fn bins(height: usize, rows: impl Iterator<Item = [f64; 2]>) -> Vec<Vec<u32>> {
    let mut bins = vec![Vec::new(); height.div_ceil(BAND)];
    for (number, [low, high]) in rows.enumerate() {
        let rows = range(low, high, 0, height * SAMPLES);
        if !rows.is_empty() {
            let band = |row: usize| row / (BAND * SAMPLES);
            for bin in &mut bins[band(rows.start)..=band(rows.end - 1)] {
                bin.push(number as u32);
            }
        }
    }
    bins
}

impl Plane {
    /// None for a triangle that is a line.
    pub(super) fn of(facet: &Facet) -> Option<Self> {
        let c = &facet.corners;
        let area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
        // A millionth of a sample.
        if area.abs() < 1e-7 {
            return None;
        }
        let weights = [0, 1, 2].map(|k| {
            let (p, q) = (&c[(k + 1) % 3], &c[(k + 2) % 3]);
            [p.x * q.y - q.x * p.y, p.y - q.y, q.x - p.x].map(|w| w / area)
        });
        let linear = |values: [f64; 3]| {
            [0, 1, 2].map(|i| (0..3).map(|k| weights[k][i] * values[k]).sum::<f64>())
        };
        Some(Self {
            weights,
            nearness: linear([0, 1, 2].map(|k| c[k].nearness)),
            light: [0, 1, 2].map(|i| linear([0, 1, 2].map(|k| f64::from(c[k].light[i])))),
            bounds: [bounds(c.map(|c| c.x)), bounds(c.map(|c| c.y))],
        })
    }

    /// From above to below; nothing where nothing is drawn.
    pub(super) fn rows(plane: &Option<Self>) -> [f64; 2] {
        plane.as_ref().map_or([0.0, -1.0], |plane| plane.bounds[1])
    }

    fn light(&self, x: f64, y: f64) -> Light {
        self.light.map(|[l, dx, dy]| (l + dx * x + dy * y) as f32)
    }
}

impl Band {
    pub(super) fn new(columns: usize) -> Self {
        let samples = columns * BAND * SAMPLES * SAMPLES;
        Self {
            top: 0,
            width: columns * SAMPLES,
            height: 0,
            nearness: vec![0.0; samples],
            facet: vec![NONE; samples],
            over: Vec::new(),
            is_covered: vec![false; columns * BAND],
        }
    }

    /// Becomes the empty band of a number, of a picture with a height (pixels).
    pub(super) fn begin(&mut self, number: usize, height: usize) {
        self.top = number * BAND * SAMPLES;
        self.height = (BAND * SAMPLES).min(height * SAMPLES - self.top);
        self.nearness.fill(f64::NEG_INFINITY);
        self.facet.fill(NONE);
        self.is_covered.fill(false);
    }

    /// The facets that are seen, each once or more.
    pub(super) fn seen(&self) -> impl Iterator<Item = u32> {
        let runs = self.facet.chunk_by(|a, b| a == b);
        runs.map(|run| run[0]).filter(|facet| *facet != NONE)
    }

    /// Columns whose centres are between two places, pixels.
    fn columns(&self, low: f64, high: f64) -> Range<usize> {
        range(low, high, 0, self.width)
    }

    /// Rows whose centres are between two places, pixels.
    fn rows(&self, low: f64, high: f64) -> Range<usize> {
        range(low, high, self.top, self.height)
    }

    pub(super) fn triangles(&mut self, numbers: &[u32], planes: &[Option<Plane>]) {
        for &number in numbers {
            if let Some(plane) = &planes[number as usize] {
                self.triangle(number, plane);
            }
        }
    }

    fn triangle(&mut self, number: u32, plane: &Plane) {
        let [[left, right], [low, high]] = plane.bounds;
        for row in self.rows(low, high) {
            let y = centre(self.top + row);
            let (mut low, mut high) = (left, right);
            for [w, dx, dy] in plane.weights {
                // A hair of overlap closes the cracks between neighbouring triangles.
                let w = w + dy * y + HAIR;
                if dx > 0.0 {
                    low = low.max(-w / dx);
                } else if dx < 0.0 {
                    high = high.min(-w / dx);
                } else if w < 0.0 {
                    high = f64::NEG_INFINITY;
                }
            }
            let columns = self.columns(low, high);
            let [n, dx, dy] = plane.nearness;
            let begin = n + dy * y + dx * centre(columns.start);
            let step = dx / SAMPLES as f64;
            let samples = row * self.width + columns.start..row * self.width + columns.end;
            let facets = &mut self.facet[samples.clone()];
            let samples = self.nearness[samples].iter_mut().zip(facets);
            for (k, (nearest, facet)) in (0i32..).zip(samples) {
                let nearness = begin + step * f64::from(k);
                // Without a branch, so that several samples are done at a time.
                let is_nearer = nearness > *nearest;
                *nearest = if is_nearer { nearness } else { *nearest };
                *facet = if is_nearer { number } else { *facet };
            }
        }
    }

    /// Changes what is over the samples where a stroke is not hidden. A face that the edge bounds does not
    /// hide it, and one that has a vertex with it in common does only where it is nearer by more than the
    /// lift.
    pub(super) fn stroke(
        &mut self,
        stroke: &Stroke,
        drawing: &Drawing<'_>,
        draw: impl Fn(Over) -> Over,
    ) {
        let [a, b] = &stroke.ends;
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let square = (dx * dx + dy * dy).max(1e-12);
        let radius = 0.5 * stroke.width;
        let [low, high] = stroke.rows();
        for row in self.rows(low, high) {
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
                let sample = row * self.width + column;
                let nearness = a.nearness + s * (b.nearness - a.nearness);
                let facet = drawing.facets.get(self.facet[sample] as usize);
                let common = facet.map_or(0, |facet| {
                    let face = &drawing.faces[facet.face as usize];
                    let has = stroke.vertices.map(|v| face.contains(&v));
                    usize::from(has[0]) + usize::from(has[1])
                });
                let lift = [-stroke.sink, stroke.lift, f64::INFINITY][common];
                if nearness + lift > self.nearness[sample] {
                    let columns = self.width / SAMPLES;
                    let pixel = row / SAMPLES * columns + column / SAMPLES;
                    self.over.resize(self.facet.len(), Over::Ink(0.0));
                    if !self.is_covered[pixel] {
                        self.is_covered[pixel] = true;
                        for of_pixel in self.of_pixel(pixel) {
                            self.over[of_pixel].fill(Over::Ink(0.0));
                        }
                    }
                    self.over[sample] = draw(self.over[sample]);
                }
            }
        }
    }

    /// The samples of a pixel, row by row.
    fn of_pixel(&self, pixel: usize) -> [Range<usize>; SAMPLES] {
        let columns = self.width / SAMPLES;
        let (x, y) = (pixel % columns * SAMPLES, pixel / columns * SAMPLES);
        std::array::from_fn(|row| {
            let first = (y + row) * self.width + x;
            first..first + SAMPLES
        })
    }

    /// The mean of the samples of each pixel, with what is over them.
    pub(super) fn reduce(
        &self,
        drawing: &Drawing<'_>,
        planes: &[Option<Plane>],
        pixels: &mut [Light],
    ) {
        let light = |facet: u32, x: f64, y: f64| match planes.get(facet as usize) {
            Some(Some(plane)) => plane.light(x, y),
            _ => [1.0; 3],
        };
        let first = self.top / SAMPLES;
        for (k, pixel) in pixels.iter_mut().enumerate() {
            let rows = self.of_pixel(k);
            let columns = self.width / SAMPLES;
            let (x, y) = (k % columns, k / columns + first);
            let facet = self.facet[rows[0].start];
            let is_one = |row: &Range<usize>| self.facet[row.clone()] == [facet; SAMPLES];
            if !self.is_covered[k] && rows.iter().all(is_one) {
                // The light is linear: its mean is that of the middle.
                *pixel = light(facet, x as f64 + 0.5, y as f64 + 0.5);
                continue;
            }
            let mut sum = [0.0; 3];
            for (row, samples) in rows.into_iter().enumerate() {
                for (column, sample) in samples.enumerate() {
                    let (x, y) = (centre(x * SAMPLES + column), centre(y * SAMPLES + row));
                    let below = || light(self.facet[sample], x, y);
                    let over = self.is_covered[k].then(|| self.over[sample]);
                    let seen = match over.unwrap_or(Over::Ink(0.0)) {
                        Over::Ink(ink) => {
                            let below = below();
                            [0, 1, 2].map(|i| below[i] + ink * (drawing.ink[i] - below[i]))
                        }
                        Over::Mark(number) => drawing.marks[number as usize].ends[0].light,
                    };
                    for i in 0..3 {
                        sum[i] += seen[i];
                    }
                }
            }
            *pixel = sum.map(|s| s / (SAMPLES * SAMPLES) as f32);
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
