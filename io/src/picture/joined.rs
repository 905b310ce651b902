//! Marks of a vector drawing that are joined: the pieces of a body to areas of one colour, and its edges to
//! lines.

use super::pieces::Piece;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fmt::Write;

/// Side of the squares in which marks are looked for that cover each other, pixels.
const SQUARE: f64 = 2.0;

/// Steps of colours of bodies, of 255: neighbours that differ by less are hardly told apart, and are one
/// area.
const COLOUR_STEP: u8 = 4;

/// A point of the drawing, hundredths of a pixel.
type Point = [i64; 2];

/// A part of the drawing.
pub(super) struct Mark {
    /// Larger for what is nearer to the viewer.
    pub(super) nearness: f64,
    /// The corners of the box around it, pixels.
    pub(super) bounds: [[f64; 2]; 2],
    pub(super) shape: Shape,
}

/// What a mark draws.
pub(super) enum Shape {
    /// An element of SVG.
    Element(String),
    /// A piece of a body, one of a layer whose pieces do not cover each other.
    Area {
        layer: usize,
        corners: [usize; 3],
        places: [[f64; 2]; 3],
        colour: [u8; 3],
    },
    /// A part of an edge of a body, which is above the areas of its layer.
    Line { layer: usize, ends: [[f64; 2]; 2] },
}

/// The elements of marks from the farthest to the nearest one. The pieces and edges of a layer wait for
/// others of it until something nearer covers them.
pub(super) fn elements(marks: Vec<Mark>, ink: &str) -> Vec<String> {
    let mut waiting = Waiting::default();
    let mut done = Vec::new();
    for mark in marks {
        let squares = mark.squares();
        let own = match mark.shape {
            Shape::Element(_) => None,
            Shape::Area { layer, .. } | Shape::Line { layer, .. } => Some(layer),
        };
        let below = waiting.below(&squares, own);
        // Nothing of its own layer that something below the mark has to come after may wait for it.
        let ready = match own {
            None => below.clone(),
            Some(own) if below.iter().any(|&b| waiting.needed(b).contains(&own)) => vec![own],
            Some(_) => Vec::new(),
        };
        for number in ready {
            for layer in waiting.take(number) {
                layer.draw(ink, &mut done);
            }
        }
        match (mark.shape, own) {
            (Shape::Element(element), _) => done.push(element),
            (shape, Some(number)) => {
                let layer = waiting.layers.entry(number).or_default();
                layer.after.extend(below);
                layer.add(shape, squares);
            }
            _ => {}
        }
    }
    while let Some((&number, _)) = waiting.layers.first_key_value() {
        for layer in waiting.take(number) {
            layer.draw(ink, &mut done);
        }
    }
    done
}

impl Mark {
    /// The squares with their middle in the mark.
    fn squares(&self) -> Vec<[i32; 2]> {
        let [low, high] = &self.bounds;
        let [x, y] = [0, 1].map(|k| {
            let at = |c: f64| (c / SQUARE).floor() as i32;
            at(low[k])..=at(high[k])
        });
        let all = x.flat_map(|x| y.clone().map(move |y| [x, y]));
        let Shape::Area { places, .. } = &self.shape else {
            return all.collect();
        };
        let is_inside = |square: &[i32; 2]| {
            let p = square.map(|c| SQUARE * (f64::from(c) + 0.5));
            let side = |k: usize| {
                let (a, b) = (places[k], places[(k + 1) % 3]);
                (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
            };
            let sides = [side(0), side(1), side(2)];
            sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
        };
        all.filter(is_inside).collect()
    }
}

/// The layers that are not drawn yet.
#[derive(Default)]
struct Waiting {
    layers: BTreeMap<usize, Layer>,
}

impl Waiting {
    /// The layers besides its own that a mark which is nearer covers.
    fn below(&self, squares: &[[i32; 2]], own: Option<usize>) -> Vec<usize> {
        let is_below = |(number, layer): &(&usize, &Layer)| {
            own != Some(**number) && squares.iter().any(|square| layer.covered.contains(square))
        };
        let below = self.layers.iter().filter(is_below);
        below.map(|(number, _)| *number).collect()
    }

    /// The layers that have to be drawn before one, and it itself at the end.
    fn needed(&self, number: usize) -> Vec<usize> {
        let (mut order, mut seen, mut open) = (Vec::new(), HashSet::new(), vec![(number, false)]);
        while let Some((number, is_left)) = open.pop() {
            if is_left {
                order.push(number);
            } else if let Some(layer) = self.layers.get(&number)
                && seen.insert(number)
            {
                open.push((number, true));
                open.extend(layer.after.iter().map(|&before| (before, false)));
            }
        }
        order
    }

    /// Takes out a layer with those before it.
    fn take(&mut self, number: usize) -> Vec<Layer> {
        let order = self.needed(number).into_iter();
        order
            .filter_map(|number| self.layers.remove(&number))
            .collect()
    }
}

/// What waits of one layer.
#[derive(Default)]
struct Layer {
    covered: HashSet<[i32; 2]>,
    /// The layers that have to be drawn before.
    after: BTreeSet<usize>,
    /// The sides of pieces by the colour of these: which corner follows on which, with the place of the
    /// first. Sides that two pieces have in common are left out.
    areas: BTreeMap<[u8; 3], HashMap<[usize; 2], Point>>,
    lines: Vec<[Point; 2]>,
}

impl Layer {
    fn add(&mut self, shape: Shape, squares: Vec<[i32; 2]>) {
        self.covered.extend(squares);
        match shape {
            Shape::Element(_) => {}
            Shape::Area {
                corners,
                places,
                colour,
                ..
            } => {
                let colour = colour.map(|c| c / COLOUR_STEP * COLOUR_STEP + COLOUR_STEP / 2);
                let sides = self.areas.entry(colour).or_default();
                for k in 0..3 {
                    let (from, to) = (corners[k], corners[(k + 1) % 3]);
                    if sides.remove(&[to, from]).is_none() {
                        sides.insert([from, to], point(places[k]));
                    }
                }
            }
            Shape::Line { ends, .. } => self.lines.push(ends.map(point)),
        }
    }

    fn draw(self, ink: &str, done: &mut Vec<String>) {
        for ([r, g, b], sides) in self.areas {
            let path = outlines(sides);
            // Areas have a line of their own colour, so that no gaps are seen between them.
            let colour = format!("#{r:02x}{g:02x}{b:02x}");
            done.push(format!(
                "<path d=\"{path}\" fill=\"{colour}\" stroke=\"{colour}\"/>"
            ));
        }
        if !self.lines.is_empty() {
            let path = polylines(self.lines);
            done.push(format!(
                "<path d=\"{path}\" fill=\"none\" stroke=\"{ink}\"/>"
            ));
        }
    }
}

/// The closed lines of some sides, each of which ends where others begin.
fn outlines(sides: HashMap<[usize; 2], Point>) -> String {
    let mut next: BTreeMap<usize, Vec<(usize, Point)>> = BTreeMap::new();
    for ([from, to], place) in sides {
        next.entry(from).or_default().push((to, place));
    }
    next.values_mut().for_each(|sides| sides.sort_unstable());
    let mut path = String::new();
    while let Some((&start, _)) = next.first_key_value() {
        let mut at = start;
        let mut places = Vec::new();
        while let Some(sides) = next.get_mut(&at) {
            let Some((to, place)) = sides.pop() else {
                break;
            };
            if sides.is_empty() {
                next.remove(&at);
            }
            places.push(place);
            at = to;
        }
        add_line(&mut path, &places);
        path.push('Z');
    }
    path
}

/// Lines that are joined where one ends and another one begins or ends.
fn polylines(lines: Vec<[Point; 2]>) -> String {
    let mut at: HashMap<Point, Vec<usize>> = HashMap::new();
    for (k, ends) in lines.iter().enumerate() {
        for end in ends {
            at.entry(*end).or_default().push(k);
        }
    }
    let mut is_drawn = vec![false; lines.len()];
    let mut follow = |places: &mut Vec<Point>| {
        while let Some(&end) = places.last() {
            let next = at[&end].iter().find(|&&k| !is_drawn[k]);
            let Some(&k) = next else {
                return;
            };
            is_drawn[k] = true;
            let [a, b] = lines[k];
            places.push(if a == end { b } else { a });
        }
    };
    let mut path = String::new();
    for [a, _] in &lines {
        let mut places = vec![*a];
        follow(&mut places);
        if places.len() == 1 {
            continue;
        }
        // From the first end in the other direction.
        places.reverse();
        follow(&mut places);
        add_line(&mut path, &places);
    }
    path
}

fn add_line(path: &mut String, places: &[Point]) {
    path.push('M');
    for (k, [x, y]) in places.iter().enumerate() {
        let space = if k == 0 { "" } else { " " };
        // Writing to a string cannot fail.
        let _ = write!(path, "{space}{} {}", *x as f64 / 100.0, *y as f64 / 100.0);
    }
}

fn point(place: [f64; 2]) -> Point {
    place.map(|c| (100.0 * c).round() as i64)
}

/// The box around some places.
pub(super) fn bounds(places: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let pick = |take: fn(f64, f64) -> f64, start: f64| {
        [0, 1].map(|k| places.iter().map(|p| p[k]).fold(start, take))
    };
    [
        pick(f64::min, f64::INFINITY),
        pick(f64::max, f64::NEG_INFINITY),
    ]
}

/// The corners of a piece counter-clockwise as the viewer sees it.
pub(super) fn seen(piece: &Piece) -> [usize; 3] {
    let [a, b, c] = piece.corners;
    if piece.back { [a, c, b] } else { [a, b, c] }
}
