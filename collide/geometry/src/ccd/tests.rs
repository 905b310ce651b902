mod exact;

use super::*;
use crate::testing::{place, points, sizes};
use proptest::prelude::*;

type Stencil = [Vector3<f64>; 4];
type Query = fn(&CcdOptions, &Stencil, &Stencil, f64) -> f64;
type Distance = fn(&Stencil) -> f64;

const QUERIES: [(Query, Distance); 2] = [
    (CcdOptions::point_triangle, |x| point_triangle(x).distance()),
    (CcdOptions::edge_edge, |x| edge_edge(x).distance()),
];

fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

fn moved<const N: usize>(
    x: &[Vector3<f64>; N],
    dx: &[Vector3<f64>; N],
    t: f64,
) -> [Vector3<f64>; N] {
    std::array::from_fn(|i| x[i] + t * dx[i])
}

/// Side of the plane or of the other line on which the first primitive lies: its sign changes only
/// in a coplanar position. A smooth function of time that does not know about closest points.
fn volume(x: &Stencil) -> f64 {
    (x[1] - x[0]).cross(&(x[2] - x[0])).dot(&(x[3] - x[0]))
}

/// Asserts that the motion is safe up to the time returned, at many times, and returns it. That the
/// time is not needlessly short is checked by the closed forms below.
fn check(options: &CcdOptions, query: Query, distance: Distance, x: &Stencil, dx: &Stencil) -> f64 {
    const SAMPLES: usize = 200;
    let t = query(options, x, dx, 1.0);
    assert!((0.0..=1.0).contains(&t), "{t}");
    let start = distance(x);
    for k in 0..=SAMPLES {
        let d = distance(&moved(x, dx, t * k as f64 / SAMPLES as f64));
        // The distance is positive wherever the start was.
        assert!(
            d > options.separation || t == 0.0,
            "unsafe: {d} left of {start} at {k}/{SAMPLES} of {t}"
        );
    }
    t
}

/// Motions and the patterns in which published methods miss collisions or stall: near-parallel and
/// parallel edges, coplanar motion, zero-length motion, degenerate primitives, grazing.
fn motions() -> impl Strategy<Value = (Stencil, Stencil)> {
    (points::<4>(), points::<4>(), 0..10_u8, -12.0..0.0_f64).prop_map(|(mut x, mut dx, kind, p)| {
        let small = 10.0_f64.powf(p);
        let e = x[1] - x[0];
        match kind {
            1 => x[3] = x[2] + 0.9 * e + small * x[3],
            // Parallel all the time.
            2 => {
                x[3] = x[2] + 0.9 * e;
                dx[1] = dx[0];
                dx[3] = dx[2];
            }
            // Coplanar all the time.
            3 => x.iter_mut().chain(&mut dx).for_each(|p| p.z = 0.0),
            4 => dx.iter_mut().for_each(|p| *p *= small),
            // Sliding along each other at a small distance.
            5 => {
                x.iter_mut().chain(&mut dx).for_each(|p| p.z = 0.0);
                x[0].z = small;
                x[1].z += if small > 0.1 { 0.0 } else { small };
            }
            // Degenerate primitives.
            6 => {
                x[3] = x[2];
                dx[3] = dx[2];
            }
            // Aimed at each other: the closest points meet.
            7 => {
                let r = edge_edge(&x).difference;
                dx = [-1.5 * r, -1.5 * r, Vector3::zeros(), Vector3::zeros()];
            }
            8 => {
                let r = point_triangle(&x).difference;
                dx = dx.map(|d| small * d);
                dx[0] -= 1.5 * r;
            }
            // A rigid turn of the first edge, linearised.
            9 => {
                dx = [
                    Vector3::zeros(),
                    2.0 * dx[1],
                    Vector3::zeros(),
                    Vector3::zeros(),
                ];
            }
            _ => {}
        }
        (x, dx)
    })
}

proptest! {
    #![proptest_config(isosheet_random::cases(1500))]

    #[test]
    fn no_motion_is_unsafe((x, dx) in motions(), size in sizes(), pose in proptest::array::uniform6(-1.0..1.0_f64), thick in 0.0..0.9_f64) {
        let far = pose;
        let zero = [0.0; 6];
        let (x, dx) = (place(&x, size, &far), {
            // The displacement turns with the stencil but is not shifted.
            let mut turn = far;
            turn[3..].copy_from_slice(&zero[3..]);
            place(&dx, size, &turn)
        });
        for (query, distance) in QUERIES {
            check(&CcdOptions::default(), query, distance, &x, &dx);
            // A thickness up to most of the distance.
            let separation = thick * distance(&x);
            check(&CcdOptions { separation, ..CcdOptions::default() }, query, distance, &x, &dx);
        }
    }

    /// A motion that leads through is stopped before: the root is computed, not sampled.
    #[test]
    fn crossings_are_never_passed(
        (b, c, s, t) in (0.05..0.6_f64, 0.05..0.35_f64, 0.1..0.9_f64, 0.1..0.9_f64),
        x in points::<4>(), dx in points::<4>(),
        when in 0.01..0.99_f64, size in sizes(),
    ) {
        let at = moved(&x, &dx, when);
        // Shift the motion of one point such that the primitives meet exactly at `when`.
        let mut into = dx;
        into[0] += ((1.0 - b - c) * at[1] + b * at[2] + c * at[3] - at[0]) / when;
        let (y, dy) = (x.map(|p| size * p), into.map(|p| size * p));
        prop_assert!(CcdOptions::default().point_triangle(&y, &dy, 1.0) < when);
        let mut into = dx;
        let shift = ((1.0 - t) * at[2] + t * at[3] - (1.0 - s) * at[0] - s * at[1]) / when;
        into[0] += shift;
        into[1] += shift;
        let (y, dy) = (x.map(|p| size * p), into.map(|p| size * p));
        prop_assert!(CcdOptions::default().edge_edge(&y, &dy, 1.0) < when);
    }

    /// As long as the time returned the volume of the stencil changes sign only where the
    /// primitives pass beside each other: with the closest points inside, never.
    #[test]
    fn impacts_head_on_do_not_tunnel(x in points::<4>(), height in 1e-6..0.5_f64, speed in 0.0..5.0_f64, size in sizes()) {
        // A point above the middle of a triangle, falling fast.
        let n = (x[2] - x[1]).cross(&(x[3] - x[1])).normalize();
        prop_assume!(n.norm() > 0.5);
        let speed = 10.0_f64.powf(speed);
        let mut y = x;
        y[0] = (x[1] + x[2] + x[3]) / 3.0 + height * n;
        let y = y.map(|p| size * p);
        let dx = [-speed * size * n, Vector3::zeros(), Vector3::zeros(), Vector3::zeros()];
        let t = CcdOptions::default().point_triangle(&y, &dx, 1.0);
        prop_assert!(volume(&y) * volume(&moved(&y, &dx, t)) > 0.0);
        prop_assert!(t <= height / speed);
        // Close to the plane of a small triangle the distance is that to its inside, and at most
        // the remainder of it is lost.
        let used = t * speed / height;
        prop_assert!(speed < height || used > 0.85, "{used}");
    }
}

/// One step is enough where the primitives part, slide or rest, however close they are.
#[test]
fn sliding_parting_and_resting_cost_one_step() {
    let once = CcdOptions {
        max_iterations: 1,
        ..CcdOptions::default()
    };
    let triangle = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
    let x = [v(0.2, 0.2, 1e-9), triangle[0], triangle[1], triangle[2]];
    let zero = Vector3::zeros();
    for slide in [zero, v(5.0, -3.0, 0.0), v(1.0, 0.0, 2.0)] {
        assert_eq!(
            once.point_triangle(&x, &[slide, zero, zero, zero], 1.0),
            1.0
        );
    }
    // A common motion of any size.
    let common = v(3.0, 1e6, -2.0);
    assert_eq!(once.point_triangle(&x, &[common; 4], 1.0), {
        // The round-off of such large coordinates is more than this gap.
        0.0
    });
    assert_eq!(once.point_triangle(&x, &[v(3.0, 1.0, -2.0); 4], 1.0), 1.0);
    let edges = [
        v(-1.0, 0.0, 0.0),
        v(1.0, 0.0, 0.0),
        v(-1.0, 1e-8, 0.0),
        v(1.0, 1e-8, 0.0),
    ];
    let along = [v(0.7, 0.0, 0.0), v(0.7, 0.0, 0.0), zero, zero];
    assert_eq!(once.edge_edge(&edges, &along, 1.0), 1.0);
    assert_eq!(once.edge_edge(&edges, &[zero; 4], 1.0), 1.0);
}

/// Closed forms of the time of impact.
#[test]
fn times_of_impact_are_right_up_to_the_remainder() {
    let fine = CcdOptions {
        remainder: 1e-6,
        ..CcdOptions::default()
    };
    let zero = Vector3::zeros();
    for size in [1e-6, 1.0, 1e3] {
        // A 10 m/s punch through a gap of 1 mm within a sixtieth of a second.
        let x = [v(0.3, 0.3, 1e-3), zero, v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)].map(|p| size * p);
        let dx = [v(0.0, 0.0, -10.0 / 60.0), zero, zero, zero].map(|p: Vector3<f64>| size * p);
        let t = fine.point_triangle(&x, &dx, 1.0);
        assert!((t / 6e-3 - 1.0).abs() < 2e-6 && t < 6e-3, "{t}");
        // With a thickness of 0.4 mm.
        let thick = CcdOptions {
            separation: 4e-4 * size,
            ..fine
        };
        let t = thick.point_triangle(&x, &dx, 1.0);
        assert!((t / 3.6e-3 - 1.0).abs() < 2e-6 && t < 3.6e-3, "{t}");
        // Edges that cross at right angles.
        let x = [
            v(-1.0, 0.0, 0.5),
            v(1.0, 0.0, 0.5),
            v(0.0, -1.0, 0.0),
            v(0.0, 1.0, 0.0),
        ]
        .map(|p| size * p);
        let down = v(0.1, 0.0, -2.0) * size;
        let t = fine.edge_edge(&x, &[down, down, zero, zero], 1.0);
        assert!((t / 0.25 - 1.0).abs() < 2e-6 && t < 0.25, "{t}");
        // A turning edge that hits another with its tip; closest features change on the way.
        let x = [
            v(0.0, 0.0, 1.0),
            v(2.0, 0.0, 1.0),
            v(1.0, -1.0, 0.0),
            v(1.0, 1.0, 0.0),
        ]
        .map(|p| size * p);
        let t = fine.edge_edge(&x, &[zero, v(0.0, 0.0, -4.0) * size, zero, zero], 1.0);
        assert!((t / 0.5 - 1.0).abs() < 2e-6 && t < 0.5, "{t}");
        // Two points head on, as a point and a triangle without extent.
        let toward = v(-size, 0.0, 0.0);
        let t = fine.point_triangle(
            &[zero, -toward, -toward, -toward],
            &[-3.0 * toward, toward, toward, toward],
            1.0,
        );
        assert!((t / 0.25 - 1.0).abs() < 2e-6 && t < 0.25, "{t}");
        // A point and the end of an edge, a triangle without width, passed at a hair's breadth: no impact.
        let x = [
            v(-1.0, 0.0, 0.0),
            v(0.0, 1e-5, 0.0),
            v(0.0, 1.0, 0.0),
            v(0.0, 1.0, 0.0),
        ]
        .map(|p| size * p);
        let t = fine.point_triangle(&x, &[v(2.0 * size, 0.0, 0.0), zero, zero, zero], 1.0);
        assert_eq!(t, 1.0);
    }
}

#[test]
fn bad_input_is_stopped_at_once() {
    let options = CcdOptions::default();
    let x = [
        v(0.2, 0.2, 0.1),
        v(0.0, 0.0, 0.0),
        v(1.0, 0.0, 0.0),
        v(0.0, 1.0, 0.0),
    ];
    let zero = Vector3::zeros();
    let mut bad = x;
    bad[1].x = f64::NAN;
    assert_eq!(options.point_triangle(&bad, &[zero; 4], 1.0), 0.0);
    // Away from the closest feature too.
    let mut bad = x;
    bad[0].y = -1.0;
    bad[3].x = f64::NAN;
    assert_eq!(options.point_triangle(&bad, &[zero; 4], 1.0), 0.0);
    let mut dx = [zero; 4];
    dx[2].y = f64::NAN;
    assert_eq!(options.point_triangle(&x, &dx, 1.0), 0.0);
    dx[2].y = f64::INFINITY;
    assert_eq!(options.edge_edge(&x, &dx, 1.0), 0.0);
    // Touching and closer than the thickness.
    let mut touching = x;
    touching[0].z = 0.0;
    assert_eq!(
        options.point_triangle(&touching, &[v(0.0, 0.0, 1.0), zero, zero, zero], 1.0),
        0.0
    );
    let thick = CcdOptions {
        separation: 0.2,
        ..options
    };
    assert_eq!(thick.point_triangle(&x, &[zero; 4], 1.0), 0.0);
    // The limit is respected.
    assert_eq!(options.point_triangle(&x, &[zero; 4], 0.25), 0.25);
    assert_eq!(options.validate(), Ok(()));
    let with = |separation, remainder, max_iterations| {
        CcdOptions {
            separation,
            remainder,
            max_iterations,
            ..CcdOptions::default()
        }
        .validate()
    };
    assert_eq!(with(-1.0, 0.1, 1), Err(CcdOptionsError::Separation(-1.0)));
    assert_eq!(with(0.0, 1.0, 1), Err(CcdOptionsError::Remainder(1.0)));
    assert_eq!(with(0.0, 0.1, 0), Err(CcdOptionsError::Iterations));
    let approach = CcdOptions {
        approach: -1.0,
        ..CcdOptions::default()
    };
    assert_eq!(approach.validate(), Err(CcdOptionsError::Approach(-1.0)));
}

/// The gap left is that of the options or up to a tenth more, wherever the point starts and whatever its
/// speed.
#[test]
fn motions_leave_the_gap_that_is_asked_for() {
    let zero = Vector3::zeros();
    let triangle = [v(-1.0, -1.0, 0.0), v(2.0, -1.0, 0.0), v(-1.0, 2.0, 0.0)];
    for (gap, left) in [(1.0, 0.1), (0.1, 0.02), (0.041, 0.02), (0.03, 0.015)] {
        let options = CcdOptions {
            remainder: 0.1,
            approach: 0.02,
            ..CcdOptions::default()
        };
        for speed in [1.0_f64, 30.0, 1e4] {
            let start = [v(0.1, 0.2, gap), triangle[0], triangle[1], triangle[2]];
            let motion = [v(0.3, 0.0, -speed * gap), zero, zero, zero];
            let t = options.point_triangle(&start, &motion, 1.0);
            let rest = gap * (1.0 - t * speed);
            assert!(
                (left * (1.0 - 1e-9)..1.1 * left).contains(&rest),
                "{rest} of {gap}, {left} asked for"
            );
        }
    }
}

/// Offsets by which published tests graze a boundary: a single-precision unit to either side.
const HAIRS: [f64; 3] = [-1.2e-7, 0.0, 1.2e-7];

/// Faces and edges that meet, miss or just reach each other at the very end of the motion, and at
/// the very rim of the primitives.
#[test]
fn grazing_at_the_rim_and_at_the_end() {
    let options = CcdOptions::default();
    let zero = Vector3::zeros();
    for rim in HAIRS {
        for end in HAIRS {
            // A point that falls past the corner of a triangle rising towards it.
            let x = [
                v(1.0 + rim, 0.0, 1.0),
                v(0.0, -1.0, 0.0),
                v(0.0, 1.0, 0.0),
                v(1.0, 0.0, 0.0),
            ];
            let (fall, rise) = (v(0.0, 0.0, -0.5 - end), v(0.0, 0.0, 0.5));
            let t = check(
                &options,
                QUERIES[0].0,
                QUERIES[0].1,
                &x,
                &[fall, rise, rise, rise],
            );
            assert!(t < 1.0, "{rim} {end}");
            // Edges that cross at the end of one of them.
            let x = [
                v(-1.0, 0.0, 1.0),
                v(1.0, 0.0, 1.0),
                v(1.0 + rim, -1.0, 0.0),
                v(1.0 + rim, 1.0, 0.0),
            ];
            let t = check(
                &options,
                QUERIES[1].0,
                QUERIES[1].1,
                &x,
                &[fall, fall, rise, rise],
            );
            assert!(t < 1.0, "{rim} {end}");
        }
        // Resting in the plane of a triangle that moves off sideways: touching, or a hair apart.
        let x = [
            v(0.0, rim, 0.0),
            v(0.0, 0.5, 0.0),
            v(0.0, 1.0, 0.0),
            v(1.0, 0.5, 0.0),
        ];
        let off = v(0.0, 0.0, 1.0);
        assert_eq!(
            check(
                &options,
                QUERIES[0].0,
                QUERIES[0].1,
                &x,
                &[zero, off, off, off]
            ),
            1.0
        );
    }
}

/// Vertices on straight lines that make the four points coplanar twice: a root finder meets a
/// double root.
#[test]
fn double_roots_are_no_matter() {
    let options = CcdOptions {
        remainder: 1e-3,
        ..CcdOptions::default()
    };
    let zero = Vector3::zeros();
    // A rod that turns over while it drops across a post, ends on opposite sides afterwards.
    let x = [
        v(0.0, 0.0, 1.0),
        v(0.0, 1.0, 1.0),
        v(0.2, 0.3, 2.0),
        v(0.2, 0.3, -1.0),
    ];
    for part in [0.3, 0.5, 0.8, 0.95, 1.0] {
        let dx = [
            v(1.0, 1.0, -1.0) * part,
            v(0.0, -1.0, -1.0) * part,
            zero,
            zero,
        ];
        let t = check(&options, QUERIES[1].0, QUERIES[1].1, &x, &dx);
        // Dense sampling says whether they meet.
        let hits = (0..=100_000).any(|k| {
            let at = moved(&x, &dx, f64::from(k) / 1e5);
            edge_edge(&at).distance() < 1e-5
        });
        assert_eq!(hits, t < 1.0, "{part}: {t}");
    }
}

/// Motions on which the bound by the largest displacement makes tiny steps: the primitives shear at
/// a small distance while they approach slowly, or travel far together.
#[test]
fn shearing_at_a_small_distance_is_quick() {
    let few = CcdOptions {
        max_iterations: 30,
        ..CcdOptions::default()
    };
    for gap in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10] {
        let x = [
            v(-1.0, -0.5 * gap, 0.0),
            v(1.0, -0.5 * gap, 0.0),
            v(0.0, 0.5 * gap, -1.0),
            v(0.0, 0.5 * gap, 1.0),
        ];
        for shear in [1e-3, 1.0, 1e3] {
            let s = v(shear, 0.0, shear);
            let up = v(0.0, gap, 0.0);
            let dx = [up - s, up + s, s - up, -s - up];
            let t = few.edge_edge(&x, &dx, 1.0);
            // They meet in the middle of the motion. Round-off counts against the gap.
            let certain = 1.0 - 16.0 * f64::EPSILON * (1.0 + 2.0 * shear) / gap;
            assert!(
                t < 0.5 && (t > 0.4 * certain || certain < 0.1),
                "{gap} {shear}: {t}"
            );
        }
    }
    // A point close to a triangle, both carried along by a thousand gaps, with the last digits of
    // the displacements different.
    let x = [
        v(0.3, 0.3, 1e-4),
        v(0.0, 0.0, 0.0),
        v(1.0, 0.1, 0.0),
        v(0.1, 1.0, 0.0),
    ];
    let shift = v(0.1, -0.2, 0.1);
    let dx: Stencil = std::array::from_fn(|i| shift * (1.0 + 1e-12 * i as f64));
    assert_eq!(few.point_triangle(&x, &dx, 1.0), 1.0);
}

/// Edges that share their directions to a millionth, turning into each other.
#[test]
fn nearly_parallel_edges_turn_into_each_other() {
    let options = CcdOptions::default();
    for tilt in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        for gap in [1e-1, 1e-4, 1e-7] {
            let x = [
                v(-1.0, 0.0, gap),
                v(1.0, 0.0, gap),
                v(-1.0, -tilt, 0.0),
                v(1.0, tilt, 0.0),
            ];
            let zero = Vector3::zeros();
            let down = v(0.0, 0.0, -2.0 * gap);
            for dx in [
                [down, down, zero, zero],
                // One end down, one end up: they cross in the middle.
                [2.0 * down, zero, zero, zero],
                [down + v(0.0, 1.0, 0.0), down - v(0.0, 1.0, 0.0), zero, zero],
            ] {
                let t = check(&options, QUERIES[1].0, QUERIES[1].1, &x, &dx);
                assert!(t < 1.0, "{tilt} {gap}: {t}");
            }
        }
    }
}
