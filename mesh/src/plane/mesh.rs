//! Triangle meshes whose edges follow a drawing.

use super::error::PlaneError;
use super::graph::PlaneGraph;
use super::net::{Net, Place, Segment};
use super::outline::{Outline, Role};
use super::refine::Refiner;
use super::vec2::{Point, between, distance, foot};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use spade::{Point2, PositionInTriangulation, Triangulation};
use std::collections::{BTreeSet, HashMap};

/// How a mesh is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneOptions {
    /// Length of the edges, about, metres. No edge along a line is longer. Edges are shorter where lines are
    /// near to each other, or bent: chords of curves turn by 30 degrees at most, so that no chord is further
    /// from its curve than a fifteenth of its length.
    pub spacing: f64,
    /// Another number gives another triangulation.
    pub seed: u64,
}

impl PlaneOptions {
    /// Checks the values.
    ///
    /// # Errors
    /// [`PlaneError::Size`] for a spacing that is not positive.
    pub fn validate(&self) -> Result<(), PlaneError> {
        let (name, value) = ("the spacing", self.spacing);
        match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(PlaneError::Size { name, value }),
        }
    }
}

/// A triangle mesh in the plane whose edges follow the pieces of a graph.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlaneMesh {
    /// The vertices, metres. Cuts have one vertex, not yet two.
    pub points: Vec<[f64; 2]>,
    /// The triangles, counter-clockwise.
    pub faces: Vec<[u32; 3]>,
    /// The edges along pieces, with the number of the piece.
    pub edges: Vec<([u32; 2], usize)>,
    /// The pieces that lie outside of the sheet and were left out.
    pub outside: Vec<usize>,
    /// The pieces of creases that close the outline where cuts leave it open.
    pub closing: Vec<usize>,
}

/// As many triangles are made at most: some minutes of work, and more than any simulation bears.
const MOST_FACES: usize = 1 << 21;

/// Triangles of a lattice for each square of the spacing: 4 / sqrt 3.
const DENSITY: f64 = 2.31;

/// Points of the lattice are moved by up to this part of the spacing in x and in y.
const JITTER: f64 = 0.15;

/// They keep this part of the spacing from lines.
const CLEARANCE: f64 = 0.6;

impl PlaneMesh {
    /// The mesh of the sheet that cuts bound: what is separated from the outside by one line, by three, ...,
    /// so that outlines within outlines are holes. Where cuts leave the outline open and creases beside the
    /// outside close it, these are cuts.
    ///
    /// Triangles have angles of 25 degrees and more where the lines allow it: where they meet at 60 degrees
    /// or more. The same arguments give the same mesh.
    ///
    /// # Errors
    /// [`PlaneError`]
    pub fn new(
        graph: &PlaneGraph,
        roles: &[Role],
        options: &PlaneOptions,
    ) -> Result<Self, PlaneError> {
        options.validate()?;
        let spacing = options.spacing;
        let length: f64 = graph.pieces.iter().map(|p| p.length()).sum();
        check_faces(length / spacing)?;
        let Outline {
            roles,
            keep,
            closing,
            area,
        } = Outline::new(graph, roles)?;
        check_faces(DENSITY * area / spacing / spacing)?;
        let is_cut = |s: &Segment| roles[s.piece] == Role::Cut;
        let mut net = Net::new(graph, &keep, spacing)?;
        let inside: Vec<bool> = net.depths(is_cut).iter().map(|d| d % 2 == 1).collect();
        net.mark_sides(&inside);
        for p in lattice(&net, &inside, options) {
            net.add(p, Place::Free)?;
        }
        let inside: Vec<bool> = net.depths(is_cut).iter().map(|d| d % 2 == 1).collect();
        let most = MOST_FACES / 2;
        Refiner::new(&mut net, graph, spacing, most).refine(&inside)?;
        let inside = net.depths(is_cut).iter().map(|d| d % 2 == 1).collect();
        let outside = (0..keep.len()).filter(|&k| !keep[k]).collect();
        Ok(Self {
            outside,
            closing,
            ..Self::of(&net, inside)
        })
    }

    /// The part of a triangulation that belongs to the sheet.
    fn of(net: &Net, inside: Vec<bool>) -> Self {
        let faces = net.triangles.inner_faces();
        let faces: Vec<[u32; 3]> = faces
            .filter(|f| inside[f.fix().index()])
            .map(|f| f.vertices().map(|v| v.index() as u32))
            .collect();
        let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
        let number: HashMap<u32, u32> = used.iter().copied().zip(0..).collect();
        let edges = net.segments.values();
        Self {
            points: used.iter().map(|v| net.point(*v)).collect(),
            faces: faces.iter().map(|f| f.map(|v| number[&v])).collect(),
            edges: edges
                .filter(|s| s.inside.contains(&true))
                .map(|s| (s.ends.map(|v| number[&v]), s.piece))
                .collect(),
            outside: Vec::new(),
            closing: Vec::new(),
        }
    }
}

fn check_faces(faces: f64) -> Result<(), PlaneError> {
    let limit = MOST_FACES;
    match faces <= limit as f64 {
        true => Ok(()),
        false => Err(PlaneError::TooManyFaces { faces, limit }),
    }
}

/// Points of a triangular lattice, each a little moved, within the sheet and away from its lines.
fn lattice(net: &Net, inside: &[bool], options: &PlaneOptions) -> Vec<Point> {
    /// Of a wide and thin sheet most of the lattice would lie outside; it is left to the refinement.
    const MOST_POINTS: f64 = 3e7;
    let spacing = options.spacing;
    let vertices = || (0..net.places.len() as u32).map(|v| net.point(v));
    let [low, high] = [f64::min, f64::max]
        .map(|f| [0, 1].map(|k| vertices().map(|p| p[k]).reduce(f).unwrap_or(0.0)));
    let height = spacing * 0.75_f64.sqrt();
    let (columns, rows) = ((high[0] - low[0]) / spacing, (high[1] - low[1]) / height);
    if columns * rows > MOST_POINTS {
        return Vec::new();
    }
    // Segments by the cells of a grid in which their middles lie.
    let cell = |p: Point| p.map(|c| (c / (1.2 * spacing)).floor() as i64);
    let mut cells: HashMap<[i64; 2], Vec<[Point; 2]>> = HashMap::new();
    for segment in net.segments.values() {
        let ends = segment.ends.map(|v| net.point(v));
        let middle = between(ends[0], ends[1], 0.5);
        cells.entry(cell(middle)).or_default().push(ends);
    }
    let is_clear = |p: Point| {
        let [i, j] = cell(p);
        let around = (-1..=1).flat_map(|di| (-1..=1).map(move |dj| [i + di, j + dj]));
        let mut near = around.filter_map(|c| cells.get(&c)).flatten();
        near.all(|ends| {
            distance(p, between(ends[0], ends[1], foot(p, *ends))) > CLEARANCE * spacing
        })
    };
    let is_inside = |p: Point| match net.triangles.locate(Point2::new(p[0], p[1])) {
        PositionInTriangulation::OnFace(face) => inside[face.index()],
        _ => false,
    };
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let mut points = Vec::new();
    for j in 0..=rows as usize {
        for i in 0..=columns as usize {
            let shift = [(); 2].map(|()| spacing * rng.random_range(-JITTER..JITTER));
            let p = [
                low[0] + spacing * (i as f64 + 0.5 * (j % 2) as f64) + shift[0],
                low[1] + height * (j as f64 + 0.5) + shift[1],
            ];
            if is_clear(p) && is_inside(p) {
                points.push(p);
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::super::curve::{EllipticArc, PlaneCurve};
    use super::super::graph::Piece;
    use super::super::vec2::{cross, sub};
    use super::*;
    use std::f64::consts::TAU;

    const SNAP: f64 = 1e-6;

    fn lines(corners: &[Point]) -> Vec<PlaneCurve> {
        let next = |k: usize| corners[(k + 1) % corners.len()];
        (0..corners.len())
            .map(|k| PlaneCurve::Line([corners[k], next(k)]))
            .collect()
    }

    /// The graph of curves whose first ones are cuts, and its mesh.
    fn mesh(curves: &[PlaneCurve], cuts: usize, spacing: f64) -> (PlaneGraph, PlaneMesh) {
        let graph = PlaneGraph::new(curves, SNAP).unwrap();
        let roles = roles(&graph, cuts);
        let options = PlaneOptions { spacing, seed: 0 };
        let mesh = PlaneMesh::new(&graph, &roles, &options).unwrap();
        check(&graph, &mesh);
        (graph, mesh)
    }

    fn roles(graph: &PlaneGraph, cuts: usize) -> Vec<Role> {
        let is_cut = |p: &Piece| p.sources.iter().any(|s| *s < cuts);
        let role = |p| if is_cut(p) { Role::Cut } else { Role::Crease };
        graph.pieces.iter().map(role).collect()
    }

    /// Triangles are counter-clockwise, an edge has two at most, and every piece inside is covered by a chain
    /// of edges with its vertices on the curve.
    fn check(graph: &PlaneGraph, mesh: &PlaneMesh) {
        let mut sides: HashMap<[u32; 2], usize> = HashMap::new();
        for f in &mesh.faces {
            let p = f.map(|v| mesh.points[v as usize]);
            assert!(cross(sub(p[1], p[0]), sub(p[2], p[0])) > 0.0);
            for k in 0..3 {
                let (a, b) = (f[k], f[(k + 1) % 3]);
                *sides.entry([a, b]).or_default() += 1;
            }
        }
        assert!(sides.values().all(|n| *n == 1));
        for (number, piece) in graph.pieces.iter().enumerate() {
            let own = mesh.edges.iter().filter(|(_, p)| *p == number);
            let mut degree: HashMap<u32, usize> = HashMap::new();
            let mut length = 0.0;
            for ([a, b], _) in own {
                assert!(sides.contains_key(&[*a, *b]) || sides.contains_key(&[*b, *a]));
                let ends = [a, b].map(|v| mesh.points[*v as usize]);
                length += distance(ends[0], ends[1]);
                for (v, p) in [a, b].into_iter().zip(ends) {
                    *degree.entry(*v).or_default() += 1;
                    let on = piece.curve.point(piece.curve.nearest(p));
                    assert!(distance(on, p) < 2.0 * SNAP, "{p:?}");
                }
            }
            if mesh.outside.contains(&number) {
                assert!(degree.is_empty());
                continue;
            }
            let ends = degree.values().filter(|d| **d == 1).count();
            assert!(degree.values().all(|d| *d <= 2));
            assert_eq!(
                ends,
                if piece.nodes[0] == piece.nodes[1] {
                    0
                } else {
                    2
                }
            );
            // Chords that turn by 30 degrees are 1.2 % shorter than their arcs.
            let part = length / piece.length();
            assert!(part < 1.0001 && part > 0.985, "{part}");
        }
    }

    fn area(mesh: &PlaneMesh) -> f64 {
        let twice = |f: &[u32; 3]| {
            let p = f.map(|v| mesh.points[v as usize]);
            cross(sub(p[1], p[0]), sub(p[2], p[0]))
        };
        0.5 * mesh.faces.iter().map(twice).sum::<f64>()
    }

    fn polygon_area(corners: &[Point]) -> f64 {
        let n = corners.len();
        let twice: f64 = (0..n)
            .map(|k| cross(corners[k], corners[(k + 1) % n]))
            .sum();
        0.5 * twice.abs()
    }

    fn smallest_angle(mesh: &PlaneMesh) -> f64 {
        let mut least = f64::INFINITY;
        for f in &mesh.faces {
            let p = f.map(|v| mesh.points[v as usize]);
            for k in 0..3 {
                let (u, v) = (sub(p[(k + 1) % 3], p[k]), sub(p[(k + 2) % 3], p[k]));
                least = least.min(cross(u, v).atan2((u[0] * v[0] + u[1] * v[1]).abs()));
            }
        }
        least.to_degrees()
    }

    fn rectangle([x, y]: Point, [w, h]: Point) -> [Point; 4] {
        [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
    }

    /// Rows of panels, some with a hole or a slit, creases between them, turned by an angle: nothing meets at
    /// less than a right angle, and so no triangle has less than 25 degrees.
    #[test]
    fn a_hundred_drawings_with_right_angles() {
        for seed in 0..100 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let panels = rng.random_range(1..5);
            let (mut cuts, mut creases) = (Vec::new(), Vec::new());
            let (mut x, mut expected) = (0.0, 0.0);
            // The outline goes right along the bottoms of the panels and comes back along their tops.
            let (mut bottom, mut top): (Vec<Point>, Vec<Point>) = (Vec::new(), Vec::new());
            for k in 0..panels {
                let [w, h] = [(); 2].map(|()| rng.random_range(0.04..0.12));
                let low = rng.random_range(-0.01..0.01);
                bottom.extend([[x, low], [x + w, low]]);
                top.extend([[x, h], [x + w, h]]);
                expected += w * (h - low);
                if k > 0 {
                    let (l, r) = (2 * k - 1, 2 * k);
                    let from = f64::max(bottom[l][1], bottom[r][1]);
                    let to = f64::min(top[l][1], top[r][1]);
                    creases.push(PlaneCurve::Line([[x, from], [x, to]]));
                }
                let [u, v] = [w, h].map(|s| rng.random_range(0.2..0.4) * s);
                if rng.random_bool(0.5) {
                    cuts.extend(lines(&rectangle([x + 0.3 * w, 0.3 * h], [u, v])));
                    expected -= u * v;
                } else {
                    let at = [x + 0.3 * w, 0.5 * h];
                    cuts.push(PlaneCurve::Line([at, [at[0] + u, at[1]]]));
                }
                x += w;
            }
            top.reverse();
            let outline = [bottom, top].concat();
            cuts.extend(lines(&outline));
            let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
            let turn = [[cos, sin], [-sin, cos], [0.1, -0.2]];
            let count = cuts.len();
            cuts.extend(creases);
            let curves: Vec<PlaneCurve> = cuts.iter().map(|c| c.transformed(turn)).collect();
            let spacing = rng.random_range(0.004..0.03);
            let (_, mesh) = mesh(&curves, count, spacing);
            assert!(
                (area(&mesh) - expected).abs() < 1e-12 * expected,
                "seed {seed}"
            );
            let angle = smallest_angle(&mesh);
            assert!(angle > 20.7, "seed {seed}: {angle}");
        }
    }

    /// Stars with creases at random angles, which cross each other and the outline: small angles do not keep
    /// the refinement from ending, the area is exact, and what lies outside is left out.
    #[test]
    fn a_hundred_stars_with_creases_at_any_angle() {
        for seed in 0..100 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let corners = rng.random_range(3..12);
            let outline: Vec<Point> = (0..corners)
                .map(|k| {
                    let (sin, cos) = (TAU * f64::from(k) / f64::from(corners)).sin_cos();
                    let r = rng.random_range(0.05..0.2);
                    [r * cos, r * sin]
                })
                .collect();
            let mut curves = lines(&outline);
            let cuts = curves.len();
            for _ in 0..rng.random_range(0..5) {
                let mut end = || [(); 2].map(|()| rng.random_range(-0.2..0.2));
                curves.push(PlaneCurve::Line([end(), end()]));
            }
            let radius = rng.random_range(0.02..0.1);
            curves.push(PlaneCurve::Arc(EllipticArc::circle([0.01, 0.02], radius)));
            let (_, mesh) = mesh(&curves, cuts, 0.02);
            let expected = polygon_area(&outline);
            assert!(
                (area(&mesh) - expected).abs() < 1e-12 * expected,
                "seed {seed}"
            );
        }
    }

    /// Vertices of a curved crease lie on its circle, and so do vertices of a round hole.
    #[test]
    fn curves_keep_their_form() {
        let hole = PlaneCurve::Arc(EllipticArc::circle([0.1, 0.1], 0.01));
        let arc = EllipticArc::circular([0.1, -0.1], 0.15, [0.0, TAU]);
        let outline = rectangle([0.0, 0.0], [0.2, 0.2]);
        let mut curves = lines(&outline);
        curves.extend([hole, PlaneCurve::Arc(arc)]);
        let (graph, mesh) = mesh(&curves, 5, 0.01);
        let mut found = 0;
        for (edge, piece) in &mesh.edges {
            for v in edge {
                let p = mesh.points[*v as usize];
                match graph.pieces[*piece].sources[0] {
                    4 => assert!((distance(p, [0.1, 0.1]) - 0.01).abs() < 1e-12),
                    5 => assert!((distance(p, arc.centre) - 0.15).abs() < 1e-12),
                    _ => continue,
                }
                found += 1;
            }
        }
        assert!(found > 40, "{found}");
        // The circle of the crease meets the outline at 48 degrees; elsewhere nothing is sharper than 60.
        assert!(smallest_angle(&mesh) > 20.0, "{}", smallest_angle(&mesh));
        let polygon = 0.5 * 12.0 * 1e-4 * (TAU / 12.0).sin();
        let disk = TAU * 0.5e-4;
        let hole = 0.04 - area(&mesh);
        assert!(hole > polygon - 1e-15 && hole < disk, "{hole}");
    }

    /// Arcs that nearly touch, and an arc over its own chord.
    #[test]
    fn chords_of_near_curves_do_not_cross() {
        let mut curves = lines(&rectangle([-0.1, -0.1], [0.2, 0.2]));
        for k in 0..5 {
            let circle = EllipticArc::circle([0.0, 0.0], 0.05 + 1e-4 * f64::from(k));
            curves.push(PlaneCurve::Arc(circle));
        }
        let low = EllipticArc::circular([0.0, 1.0], 1.005, [-1.58, -1.56]);
        let ends = PlaneCurve::Arc(low).ends();
        curves.extend([PlaneCurve::Arc(low), PlaneCurve::Line(ends)]);
        mesh(&curves, 4, 0.05);
    }

    #[test]
    fn gaps_are_found_and_snapped() {
        let corners = rectangle([0.0, 0.0], [0.1, 0.1]);
        let mut curves = lines(&corners);
        curves[2] = PlaneCurve::Line([[0.1, 0.1], [1e-4, 0.1]]);
        curves.push(PlaneCurve::Line([[0.05, 0.0], [0.05, 0.10002]]));
        let options = PlaneOptions {
            spacing: 0.02,
            seed: 0,
        };
        let made = |snap: f64| {
            let graph = PlaneGraph::new(&curves, snap).unwrap();
            let mesh = PlaneMesh::new(&graph, &roles(&graph, 4), &options);
            (graph, mesh)
        };
        let Err(PlaneError::Open { gaps }) = made(1e-6).1 else {
            panic!("a gap");
        };
        assert_eq!(gaps.len(), 2);
        assert!((gaps[0].width - 1e-4).abs() < 1e-12);
        assert!((gaps[0].at[1] - 0.1).abs() < 1e-12);
        let (graph, mesh) = made(1.5e-4);
        let gaps: Vec<f64> = graph.joins.iter().map(|j| j.gap).collect();
        assert_eq!(gaps.len(), 2);
        assert!((gaps[0].max(gaps[1]) - 1e-4).abs() < 1e-12);
        assert!((area(&mesh.unwrap()) - 0.01).abs() < 1e-5);
    }

    #[test]
    fn what_has_no_area_or_too_much_is_refused() {
        let curves = lines(&rectangle([0.0, 0.0], [0.1, 0.1]));
        let graph = PlaneGraph::new(&curves, SNAP).unwrap();
        let made = |roles: &[Role], spacing| {
            PlaneMesh::new(&graph, roles, &PlaneOptions { spacing, seed: 0 })
        };
        assert_eq!(made(&[Role::Crease; 4], 0.01), Err(PlaneError::NoOutline));
        let fine = made(&[Role::Cut; 4], 5e-5);
        let Err(PlaneError::TooManyFaces { faces, .. }) = fine else {
            panic!("{fine:?}");
        };
        assert!((faces / (2.31 * 4e6) - 1.0).abs() < 1e-6, "{faces}");
        // More than any whole number holds.
        let Err(error) = made(&[Role::Cut; 4], 1e-30) else {
            panic!("a spacing of 1e-30 m is accepted");
        };
        assert!(
            error.to_string().contains("about 4e29 triangles"),
            "{error}"
        );
        for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                made(&[Role::Cut; 4], spacing),
                Err(PlaneError::Size { .. })
            ));
        }
        let wide = made(&[Role::Cut; 4], 10.0).unwrap();
        assert!((area(&wide) - 0.01).abs() < 1e-14);
    }
}
