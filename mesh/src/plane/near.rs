//! Which of many lines come near each other: a tree of boxes, each of which is turned as what is in it.
//!
//! Boxes along the axes would not part lines that run aslant beside each other.

use super::error::PlaneError;
use super::vec2::{Point, cross, distance, dot, sub};
use std::ops::Range;

/// Lines may meet so often in any drawing: a grid of 256 lines each way and more.
const LEAST: usize = 1 << 17;

/// They may meet so often for each line: where eight lines end in a point, each of them meets fourteen
/// others, at both ends, and each pair is one.
const TIMES: usize = 8;

/// A leaf of the tree has at most so many shapes.
const LEAF: usize = 16;

/// Some shapes, and which of them are near a place.
struct Nearby {
    shapes: Vec<Turned>,
    /// The shapes of each node stand together.
    order: Vec<usize>,
    /// The first is the root, and the one after a node is its first child.
    nodes: Vec<Node>,
    /// By so much round-off may part what touches.
    slack: f64,
}

struct Node {
    bounds: Turned,
    /// Its shapes, by their places in the order.
    range: Range<usize>,
    /// The largest number of a shape in it.
    last: usize,
    /// The number of its second child; `None` of a leaf.
    second: Option<usize>,
}

/// A box, turned.
#[derive(Clone, Copy, Debug)]
struct Turned {
    centre: Point,
    /// Of length one.
    direction: Point,
    /// Half of its length along the direction, and across.
    half: [f64; 2],
}

fn across([x, y]: Point) -> Point {
    [-y, x]
}

impl Turned {
    /// The smallest box of a direction around points.
    fn around(points: impl Iterator<Item = Point> + Clone, direction: Point) -> Self {
        let axes = [direction, across(direction)];
        let bounds = axes.map(|axis| {
            let along = points.clone().map(|p| dot(p, axis));
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| {
                [low.min(c), high.max(c)]
            })
        });
        let middle = bounds.map(|[low, high]| 0.5 * (low + high));
        Self {
            centre: [0, 1].map(|k| middle[0] * axes[0][k] + middle[1] * axes[1][k]),
            direction,
            half: bounds.map(|[low, high]| 0.5 * (high - low)),
        }
    }

    /// The box of a shape along its first side.
    fn of(shape: &[Point; 3]) -> Self {
        let side = sub(shape[1], shape[0]);
        Self::around(shape.iter().copied(), unit(side))
    }

    fn corners(&self) -> [Point; 4] {
        let [u, v] = [self.direction, across(self.direction)];
        let [h, w] = self.half;
        [[h, w], [h, -w], [-h, w], [-h, -w]]
            .map(|[a, b]| [0, 1].map(|k| self.centre[k] + a * u[k] + b * v[k]))
    }

    /// Whether a line parts it from another one with a gap wider than the reach. (Numbers that are not finite
    /// part nothing.)
    fn is_apart(&self, other: &Self, reach: f64) -> bool {
        let away = sub(other.centre, self.centre);
        let parts = |axis: Point| {
            let extent = |b: &Self| {
                let [h, w] = b.half;
                h * dot(axis, b.direction).abs() + w * cross(axis, b.direction).abs()
            };
            dot(away, axis).abs() - extent(self) - extent(other) > reach
        };
        let axes = |b: &Self| [b.direction, across(b.direction)];
        [axes(self), axes(other)].concat().into_iter().any(parts)
    }
}

/// The direction of a vector; that of x where it has none.
fn unit(v: Point) -> Point {
    let length = v[0].hypot(v[1]);
    match length > 0.0 && length.is_finite() {
        true => v.map(|c| c / length),
        false => [1.0, 0.0],
    }
}

/// The direction that boxes have in the mean, by their lengths; opposite directions are one.
fn mean(boxes: impl Iterator<Item = Turned>) -> Point {
    let doubled = boxes.fold([0.0; 2], |sum, b| {
        let [x, y] = b.direction;
        [
            sum[0] + b.half[0] * (x * x - y * y),
            sum[1] + b.half[0] * 2.0 * x * y,
        ]
    });
    let [c, s] = unit(doubled);
    unit([
        ((1.0 + c) / 2.0).max(0.0).sqrt(),
        ((1.0 - c) / 2.0).max(0.0).sqrt().copysign(s),
    ])
}

impl Nearby {
    fn new(shapes: &[[Point; 3]]) -> Self {
        let largest = shapes
            .iter()
            .flatten()
            .flatten()
            .fold(0.0, |m: f64, c| m.max(c.abs()));
        let mut tree = Self {
            shapes: shapes.iter().map(Turned::of).collect(),
            order: (0..shapes.len()).collect(),
            nodes: Vec::new(),
            // A projection rounds some ten times.
            slack: 16.0 * f64::EPSILON * largest,
        };
        if !shapes.is_empty() {
            tree.add(0..shapes.len());
        }
        tree
    }

    /// Adds the node of some shapes, and all below it.
    fn add(&mut self, range: Range<usize>) {
        let own = &self.order[range.clone()];
        let boxes = own.iter().map(|&k| self.shapes[k]);
        let direction = mean(boxes.clone());
        let node = Node {
            bounds: Turned::around(boxes.clone().flat_map(|b| b.corners()), direction),
            range: range.clone(),
            last: own.iter().copied().max().unwrap_or(0),
            second: None,
        };
        let number = self.nodes.len();
        self.nodes.push(node);
        if range.len() <= LEAF {
            return;
        }
        // What spreads its shapes most: their places along and across, or how they are turned.
        let aslant = |b: &Turned| {
            let turn = cross(direction, b.direction);
            turn * dot(direction, b.direction).signum()
        };
        let length = boxes.clone().map(|b| b.half[0]).fold(0.0, f64::max);
        let keys: [&dyn Fn(&Turned) -> f64; 3] = [
            &|b| dot(b.centre, direction),
            &|b| cross(direction, b.centre),
            &|b| length * aslant(b),
        ];
        let spread = |key: &dyn Fn(&Turned) -> f64| {
            let values = boxes.clone().map(|b| key(&b));
            let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], c| {
                [l.min(c), h.max(c)]
            });
            high - low
        };
        let widest = keys
            .into_iter()
            .max_by(|a, b| spread(a).total_cmp(&spread(b)));
        let key = widest.unwrap_or(keys[0]);
        let middle = range.len() / 2;
        let shapes = &self.shapes;
        self.order[range.clone()].select_nth_unstable_by(middle, |&a, &b| {
            key(&shapes[a]).total_cmp(&key(&shapes[b])).then(a.cmp(&b))
        });
        let middle = range.start + middle;
        self.add(range.start..middle);
        self.nodes[number].second = Some(self.nodes.len());
        self.add(middle..range.end);
    }

    /// Puts the numbers of the shapes after one that are near it into a list, in their order.
    fn after(&self, shape: usize, reach: f64, near: &mut Vec<usize>) {
        near.clear();
        let reach = reach + self.slack;
        let own = &self.shapes[shape];
        let mut open = vec![0];
        while let Some(number) = open.pop() {
            let node = &self.nodes[number];
            if node.last <= shape || node.bounds.is_apart(own, reach) {
                continue;
            }
            match node.second {
                Some(second) => open.extend([number + 1, second]),
                None => {
                    let shapes = self.order[node.range.clone()].iter().copied();
                    near.extend(
                        shapes.filter(|&k| k > shape && !self.shapes[k].is_apart(own, reach)),
                    );
                }
            }
        }
        near.sort_unstable();
    }
}

/// Calls `visit` for all pairs of shapes whose boxes are at most `reach` apart, each pair once and in order.
/// The corners of a shape that is a line are its ends, and a point between them.
///
/// # Errors
/// [`PlaneError::TooManyMeetings`] for more pairs than a drawing of so many lines has.
pub fn near_pairs(
    shapes: &[[[f64; 2]; 3]],
    reach: f64,
    mut visit: impl FnMut(usize, usize),
) -> Result<(), PlaneError> {
    let tree = Nearby::new(shapes);
    let limit = LEAST + TIMES * shapes.len();
    let (mut near, mut count) = (Vec::new(), 0);
    for shape in 0..shapes.len() {
        tree.after(shape, reach, &mut near);
        count += near.len();
        if count > limit {
            return Err(PlaneError::TooManyMeetings { limit });
        }
        near.iter().for_each(|&other| visit(shape, other));
    }
    Ok(())
}

/// Of each point the distance to the next one; infinite of a single one.
pub fn gaps(points: &[[f64; 2]]) -> Vec<f64> {
    // Points of drawings stand in rows along the axes, and hardly along this direction.
    let axis = unit([1.0, 0.5 * (5.0_f64.sqrt() - 1.0)]);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| dot(points[a], axis).total_cmp(&dot(points[b], axis)));
    let mut gaps = vec![f64::INFINITY; points.len()];
    for (place, &a) in order.iter().enumerate() {
        let (before, after) = (order[..place].iter().rev(), &order[place + 1..]);
        let mut look = |others: &mut dyn Iterator<Item = &usize>| {
            for &b in others {
                if dot(sub(points[b], points[a]), axis).abs() >= gaps[a] {
                    break;
                }
                gaps[a] = gaps[a].min(distance(points[a], points[b]));
            }
        };
        look(&mut after.iter());
        look(&mut before.into_iter());
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn line([a, b]: [Point; 2]) -> [Point; 3] {
        [a, b, a]
    }

    fn pairs(shapes: &[[Point; 3]], reach: f64) -> Vec<[usize; 2]> {
        let mut found = Vec::new();
        near_pairs(shapes, reach, |i, j| found.push([i, j])).unwrap();
        found
    }

    /// All pairs that cross are found, and hardly others.
    #[test]
    fn lines_that_cross_are_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut point = || [0, 1].map(|_| rng.random_range(0.0..1.0));
        let shapes: Vec<[Point; 3]> = (0..200).map(|_| line([point(), point()])).collect();
        let found = pairs(&shapes, 0.0);
        let side = |[a, b, _]: [Point; 3], p| cross(sub(b, a), sub(p, a));
        let cross = |s: [Point; 3], t: [Point; 3]| {
            side(s, t[0]) * side(s, t[1]) < 0.0 && side(t, s[0]) * side(t, s[1]) < 0.0
        };
        let all = (0..200).flat_map(|i| (i + 1..200).map(move |j| [i, j]));
        let crossing: Vec<_> = all.filter(|[i, j]| cross(shapes[*i], shapes[*j])).collect();
        assert_eq!(found, crossing);
    }

    /// Parallel lines beside each other are near their neighbours alone, in any direction.
    #[test]
    fn parallel_lines_have_two_neighbours() {
        for turn in [0.0, 0.3, 0.8, 1.6] {
            let (sin, cos) = f64::sin_cos(turn);
            let place = |along: f64, off: f64| [along * cos - off * sin, along * sin + off * cos];
            let count = 3000;
            let lines = (0..count).map(|k| [0.0, 9000.0].map(|along| place(along, f64::from(k))));
            let shapes: Vec<[Point; 3]> = lines.map(line).collect();
            assert_eq!(pairs(&shapes, 1.5).len(), 2999, "{turn}");
            let tree = Nearby::new(&shapes);
            let visited = |shape: usize| {
                let near = |n: &&Node| !n.bounds.is_apart(&tree.shapes[shape], 1.5);
                tree.nodes.iter().filter(near).count()
            };
            // Two ways from the root to the leaves, of eight levels each.
            let most = (0..3000).map(visited).max().unwrap();
            assert!(most < 50, "{most} nodes at {turn}");
        }
    }

    #[test]
    fn meetings_are_counted() {
        let count = 400;
        let far = f64::from(count);
        let lines = (1..count).map(f64::from);
        let grid = lines.flat_map(|k| [[[0.0, k], [far, k]], [[k, 0.0], [k, far]]]);
        let shapes: Vec<[Point; 3]> = grid.map(line).collect();
        // 399 times 399 crossings, where 2^17 and eight for each line are allowed.
        let error = near_pairs(&shapes, 0.0, |_, _| {}).unwrap_err();
        let limit = (1 << 17) + 8 * 798;
        assert!(limit < 399 * 399);
        assert_eq!(error, PlaneError::TooManyMeetings { limit });
    }

    #[test]
    fn gaps_are_those_to_the_next() {
        let points = [[0.0, 0.0], [3.0, 4.0], [0.0, 1.0], [10.0, 4.0]];
        assert_eq!(gaps(&points), [1.0, 18.0_f64.sqrt(), 1.0, 7.0]);
        assert_eq!(gaps(&points[..1]), [f64::INFINITY]);
    }
}
