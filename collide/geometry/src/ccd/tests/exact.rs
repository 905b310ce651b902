//! Queries that are decided exactly, with rational numbers, and not a single collision that is missed.
//!
//! Two primitives meet at a time if some polynomials of it are zero and others are not negative there. These
//! can only begin to hold at 0 or at a root of one of them, so that it is enough to look there.

mod polynomial;

use super::*;
use polynomial::{Polynomial, Root};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::cmp::Ordering;

type Stencil = [Vector3<f64>; 4];
type Query = fn(&CcdOptions, &Stencil, &Stencil, f64) -> f64;

/// A point or a direction that moves.
type Moving = [Polynomial; 3];

fn difference(a: &Moving, b: &Moving) -> Moving {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn dot(a: &Moving, b: &Moving) -> Polynomial {
    let [x, y, z] = std::array::from_fn(|i| &a[i] * &b[i]);
    &(&x + &y) + &z
}

fn cross(a: &Moving, b: &Moving) -> Moving {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &(&a[j] * &b[k]) - &(&a[k] * &b[j])
    })
}

/// A condition on the time.
#[derive(Debug)]
enum Condition {
    Zero(Polynomial),
    NotNegative(Polynomial),
    Not(Box<Self>),
    All(Vec<Self>),
    Any(Vec<Self>),
}

use Condition::{All, Any, Not, NotNegative, Zero};

impl Condition {
    fn holds(&self, t: &Root) -> bool {
        match self {
            Zero(of) => t.sign(of) == Ordering::Equal,
            NotNegative(of) => t.sign(of) != Ordering::Less,
            Not(other) => !other.holds(t),
            All(parts) => parts.iter().all(|part| part.holds(t)),
            Any(parts) => parts.iter().any(|part| part.holds(t)),
        }
    }

    /// A polynomial that is not zero at all times and has to be zero.
    fn equation(&self) -> Option<&Polynomial> {
        match self {
            Zero(of) => Some(of).filter(|of| !of.is_zero()),
            All(parts) => parts.iter().find_map(Self::equation),
            _ => None,
        }
    }

    /// The times from 0 to 1 at which it may begin to hold, but for 0.
    fn begins(&self) -> Vec<Root> {
        if let Some(equation) = self.equation() {
            return equation.roots();
        }
        match self {
            Zero(of) | NotNegative(of) if of.is_zero() => Vec::new(),
            Zero(of) | NotNegative(of) => of.roots(),
            Not(other) => other.begins(),
            All(parts) | Any(parts) => parts.iter().flat_map(Self::begins).collect(),
        }
    }
}

fn vanishes(direction: &Moving) -> Condition {
    All(direction.iter().cloned().map(Zero).collect())
}

/// A point is on a segment, also on one without length.
fn on_segment(p: &Moving, [a, b]: [&Moving; 2]) -> Condition {
    let (from_a, to_b) = (difference(p, a), difference(b, p));
    let between = NotNegative(dot(&from_a, &to_b));
    All(vec![vanishes(&cross(&difference(b, a), &from_a)), between])
}

/// A point is on a triangle, also on one without area.
fn on_triangle([p, a, b, c]: &[Moving; 4]) -> Condition {
    let sides = [[a, b], [b, c], [c, a]];
    let normal = cross(&difference(b, a), &difference(c, a));
    let inside = sides.map(|[from, to]| {
        let turned = cross(&difference(to, from), &difference(p, from));
        NotNegative(dot(&normal, &turned))
    });
    let mut on_face = vec![Zero(dot(&normal, &difference(p, a)))];
    on_face.extend(inside);
    on_face.push(Not(vanishes(&normal).into()));
    let on_sides = Any(sides.map(|side| on_segment(p, side)).into());
    Any(vec![All(on_face), All(vec![vanishes(&normal), on_sides])])
}

/// Two segments have a point in common, also where they are parallel or have no length.
fn segments_meet([a, b, c, d]: &[Moving; 4]) -> Condition {
    let (first, second, apart) = (difference(b, a), difference(d, c), difference(c, a));
    let normal = cross(&first, &second);
    let mut cross_inside = vec![Zero(dot(&normal, &apart))];
    // The lines meet at a + s first = c + t second.
    for other in [&second, &first] {
        let part = dot(&normal, &cross(&apart, other));
        let rest = &dot(&normal, &normal) - &part;
        cross_inside.extend([part, rest].map(NotNegative));
    }
    cross_inside.push(Not(vanishes(&normal).into()));
    let ends = Any(vec![
        on_segment(a, [c, d]),
        on_segment(b, [c, d]),
        on_segment(c, [a, b]),
        on_segment(d, [a, b]),
    ]);
    Any(vec![All(cross_inside), All(vec![vanishes(&normal), ends])])
}

type Meet = fn(&[Moving; 4]) -> Condition;

/// The queries with what decides them and the number of corners of the first primitive.
const QUERIES: [(Query, Meet, usize); 2] = [
    (CcdOptions::point_triangle, on_triangle, 1),
    (CcdOptions::edge_edge, segments_meet, 2),
];

/// Times at which the primitives meet, the first one among them.
fn meetings(meet: Meet, x: &Stencil, dx: &Stencil) -> Vec<Root> {
    let moving = |i: usize| std::array::from_fn(|k| Polynomial::motion(x[i][k], dx[i][k]));
    let meet = meet(&std::array::from_fn(moving));
    let mut times = meet.begins();
    times.push(Root::zero());
    times.retain(|t| meet.holds(t));
    times
}

/// Corners at the start and at the end.
type Ends = [Stencil; 2];

/// What is special of a pair of primitives.
type Shape = fn(&mut Ends, usize, &mut ChaCha8Rng);

const SHAPES: [(&str, Shape); 7] = [
    ("general", |_, _, _| {}),
    ("in a plane", |ends, _, _| {
        ends.iter_mut().flatten().for_each(|p| p.z = 0.0);
    }),
    ("parallel to a plane", |ends, split, rng| {
        let heights = [rng.random_range(-1..=1), rng.random_range(-1..=1)].map(f64::from);
        for (end, height) in ends.iter_mut().zip(heights) {
            end[..split].iter_mut().for_each(|p| p.z = height);
            end[split..].iter_mut().for_each(|p| p.z = 0.0);
        }
    }),
    ("parallel edges", |ends, _, rng| {
        for end in ends {
            let times = f64::from(rng.random_range(-2..=2));
            end[3] = end[2] + times * (end[1] - end[0]);
        }
    }),
    ("without extent", |ends, _, _| {
        ends.iter_mut().for_each(|end| end[3] = end[2]);
    }),
    ("rigid", |[start, end], split, _| {
        let shift = end[0] - start[0];
        *end = *start;
        end[..split].iter_mut().for_each(|p| *p += shift);
    }),
    // All corners are on an axis at half-time, and the volume has a double root there.
    ("turned by half a turn", |[start, end], _, _| {
        *end = start.map(|p| v(-p.x, -p.y, p.z));
    }),
];

fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

/// A random point of a primitive: a corner, on a side, or inside.
fn point_of(corners: &[Vector3<f64>], rng: &mut ChaCha8Rng) -> Vector3<f64> {
    let mut corner = || corners[rng.random_range(0..corners.len())];
    0.25 * (corner() + corner() + corner() + corner())
}

/// A motion whose numbers have few digits, so that every one is exact.
fn motion(shape: Shape, split: usize, rng: &mut ChaCha8Rng) -> [Stencil; 2] {
    let size = [1, 2, 4, 500][rng.random_range(0..4)];
    let mut random = || {
        std::array::from_fn(|_| {
            let [x, y, z] = std::array::from_fn(|_| f64::from(rng.random_range(-size..=size)));
            v(x, y, z)
        })
    };
    let mut ends = [random(), random()];
    shape(&mut ends, split, rng);
    // Many meet exactly at some time, at its corners or elsewhere, or there but for a hair.
    let meet = [Some(0.0), Some(0.25), Some(0.5), Some(1.0), None, None][rng.random_range(0..6)];
    if let Some(t) = meet {
        let at: Stencil = std::array::from_fn(|i| (1.0 - t) * ends[0][i] + t * ends[1][i]);
        let (first, second) = at.split_at(split);
        let shift = point_of(second, rng) - point_of(first, rng);
        for end in &mut ends {
            let hair = [0.0, 0.0, 1.0, -1.0][rng.random_range(0..4)] * 2.0_f64.powi(-30);
            let moved = end[..split].iter_mut();
            moved.for_each(|p| *p += shift + hair * Vector3::z());
        }
    }
    let scale = 2.0_f64.powi([-20, 0, 0, 20][rng.random_range(0..4)]);
    let [start, end] = ends.map(|end| end.map(|p| scale * p));
    [start, std::array::from_fn(|i| end[i] - start[i])]
}

/// Every collision of so many random motions of each shape comes after the time that the query returns.
fn check((query, meet, split): (Query, Meet, usize), seed: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for (name, shape) in SHAPES {
        let (mut met, mut missed) = (0, 0);
        for _ in 0..300 {
            let [x, dx] = motion(shape, split, &mut rng);
            let t = query(&CcdOptions::default(), &x, &dx, 1.0);
            let times = meetings(meet, &x, &dx);
            for time in &times {
                let is_before = time.is_above(t) || (t == 0.0 && !time.is_above(0.0));
                let at = time.rounded();
                assert!(is_before, "{name}: {t}, they meet at {at}: {x:?} {dx:?}");
            }
            *if times.is_empty() {
                &mut missed
            } else {
                &mut met
            } += 1;
        }
        assert!(met > 0 && missed > 0, "{name}: {met} meet, {missed} do not");
    }
}

#[test]
fn no_collision_of_a_point_and_a_triangle_is_missed() {
    check(QUERIES[0], 1);
}

#[test]
fn no_collision_of_two_edges_is_missed() {
    check(QUERIES[1], 2);
}

/// Where the exact decision says that primitives meet, their distance is zero.
#[test]
fn meetings_are_at_distance_zero() {
    let distances: [fn(&Stencil) -> f64; 2] = [
        |x| point_triangle(x).distance(),
        |x| edge_edge(x).distance(),
    ];
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for ((_, meet, split), distance) in QUERIES.into_iter().zip(distances) {
        for (name, shape) in SHAPES {
            for _ in 0..20 {
                let [x, dx] = motion(shape, split, &mut rng);
                let size = x.iter().chain(&dx).map(Vector3::amax).fold(0.0, f64::max);
                for time in meetings(meet, &x, &dx) {
                    let t = time.rounded();
                    let d = distance(&std::array::from_fn(|i| x[i] + t * dx[i]));
                    assert!(d < 1e-9 * size, "{name} at {t}: {d} of {size}");
                }
            }
        }
    }
}

/// Cases that are decided by hand.
#[test]
fn decisions_are_right_in_closed_forms() {
    const NEVER: [f64; 0] = [];
    let zero = Vector3::zeros();
    let triangle = [v(0.0, 0.0, 0.0), v(4.0, 0.0, 0.0), v(0.0, 4.0, 0.0)];
    let times = |k: usize, x: Stencil, dx: Stencil| {
        let mut times: Vec<f64> = meetings(QUERIES[k].1, &x, &dx)
            .iter()
            .map(Root::rounded)
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    };
    let falls = |p: Vector3<f64>, by: Vector3<f64>| {
        let [a, b, c] = triangle;
        times(0, [p, a, b, c], [by, zero, zero, zero])
    };
    let down = v(0.0, 0.0, -2.0);
    // Inside, on a side, at a corner, beside it by a hair, too short by a hair, and just long enough.
    assert_eq!(falls(v(1.0, 1.0, 1.0), down), [0.5]);
    assert_eq!(falls(v(2.0, 2.0, 1.0), down), [0.5]);
    assert_eq!(falls(v(0.0, 4.0, 1.0), down), [0.5]);
    assert_eq!(falls(v(2.0, 2.0 + 2.0_f64.powi(-40), 1.0), down), NEVER);
    assert_eq!(falls(v(1.0, 1.0, 2.0 + 2.0_f64.powi(-40)), down), NEVER);
    assert_eq!(falls(v(1.0, 1.0, 2.0), down), [1.0]);
    // In the plane: past a corner, which it grazes, and through.
    assert_eq!(falls(v(-2.0, 6.0, 0.0), v(4.0, -4.0, 0.0)), [0.5]);
    assert_eq!(falls(v(-1.0, 1.0, 0.0), v(8.0, 0.0, 0.0))[0], 0.125);
    assert_eq!(falls(v(-1.0, 6.0, 0.0), v(8.0, 0.0, 0.0)), NEVER);
    // Edges that cross, that meet end to end, and that slide along each other.
    let edge = |c: Vector3<f64>, d: Vector3<f64>, by: Vector3<f64>| {
        times(
            1,
            [v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0), c, d],
            [zero, zero, by, by],
        )
    };
    assert_eq!(edge(v(0.0, -1.0, 1.0), v(0.0, 1.0, 1.0), down), [0.5]);
    assert_eq!(edge(v(1.0, 0.0, 1.0), v(2.0, 1.0, 1.0), down), [0.5]);
    assert_eq!(edge(v(2.0, 0.0, 1.0), v(2.0, 1.0, 1.0), down), NEVER);
    assert_eq!(
        edge(v(3.0, 0.0, 0.0), v(5.0, 0.0, 0.0), v(-4.0, 0.0, 0.0))[0],
        0.5
    );
    assert_eq!(
        edge(v(3.0, 1.0, 0.0), v(5.0, 1.0, 0.0), v(-4.0, 0.0, 0.0)),
        NEVER
    );
}
