use super::super::tests::strip;
use super::*;
use isosheet_mesh::generate::Diagonals;
use nalgebra::Vector3;

/// Root of the mean square over the faces of the relative errors of the curvature and of the sines of the
/// angles to the exact rulings, of faces that are not at the rim. `map` takes a point of the flat sheet to
/// space with its ruling and its curvature, and `side` is that of the square sheet, whose lower left corner
/// is at `corner`.
fn errors(
    cells: usize,
    corner: [f64; 2],
    map: impl Fn([f64; 2]) -> (Vector3<f64>, Vector3<f64>, f64),
) -> [f64; 2] {
    let flat = strip([cells, cells], [1.0, 1.0], Diagonals::Rising, 0.2, f64::NAN);
    let t = flat.topology();
    let moved = |v: VertexId| {
        let p = flat.position(v);
        [p[0] + corner[0], p[1] + corner[1]]
    };
    let x: Vec<f64> = t
        .vertex_ids()
        .flat_map(|v| <[f64; 3]>::from(map(moved(v)).0))
        .collect();
    let found = FaceCurvature::new(&flat, &[], &[]).unwrap().rulings(&x);
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    for (f, ruling) in t.face_ids().zip(found) {
        let corners = t.faces()[f.index()];
        if corners.iter().any(|v| t.is_boundary_vertex(*v)) {
            continue;
        }
        let middle = corners
            .map(moved)
            .into_iter()
            .fold([0.0; 2], |m, p| [m[0] + p[0] / 3.0, m[1] + p[1] / 3.0]);
        let (_, exact, curvature) = map(middle);
        let ruling = ruling.expect("bent beyond noise");
        sums[0] += (ruling.curvature / curvature - 1.0).powi(2);
        sums[1] += Vector3::from(ruling.direction).cross(&exact).norm_squared();
        count += 1.0;
    }
    sums.map(|s: f64| (s / count).sqrt())
}

/// Errors of the meshes of 8, 16 and 32 cells go down in proportion to the cells at least. Of the finest one
/// the error of the curvature is less than `(k h)^2` with the curvature `k` and the longest edges `h`, and
/// the angle of the rulings, which lie in planes of faces that are tilted against the surface, less than
/// `k h / 2`.
fn check(
    what: &str,
    curvature: f64,
    corner: [f64; 2],
    map: impl Fn([f64; 2]) -> (Vector3<f64>, Vector3<f64>, f64),
) {
    let of = [8, 16, 32].map(|cells| errors(cells, corner, &map));
    let turned = curvature * std::f64::consts::SQRT_2 / 32.0;
    assert!(
        of[2][0] < turned * turned && of[2][1] < 0.5 * turned,
        "{what}: {of:?}"
    );
    for k in 0..2 {
        let e = of.map(|e| e[k]);
        assert!(e[0] > 1.7 * e[1] && e[1] > 1.7 * e[2], "{what}: {of:?}");
    }
}

/// Rolled to a cylinder across a direction that no edge has: the axis is the ruling, and the curvature `1/R`.
#[test]
fn the_ruling_of_a_cylinder_is_its_axis() {
    for radius in [0.8, -0.8_f64] {
        check("cylinder", 1.0 / 0.8, [0.0; 2], |[x, y]| {
            let (s, c) = 0.5_f64.sin_cos();
            let (along, across) = (c * y - s * x, c * x + s * y);
            let angle = across / radius;
            let place = |along: f64, out: f64, up: f64| {
                Vector3::new(c * out - s * along, s * out + c * along, up)
            };
            let at = place(along, radius * angle.sin(), radius * (1.0 - angle.cos()));
            (at, place(1.0, 0.0, 0.0), 1.0 / radius)
        });
    }
}

/// Rolled to a cone of the half angle `b`: rulings pass through the apex, and the curvature at the distance
/// `r` from it is `cot b / r`.
#[test]
fn the_rulings_of_a_cone_pass_through_its_apex() {
    let (half_angle, height) = (0.7_f64, 1.0);
    // A bowl that opens upwards, seen from inside.
    check(
        "cone",
        1.0 / (height * half_angle.tan()),
        [-0.5, height],
        |[x, y]| {
            let (r, angle) = (x.hypot(y), x.atan2(y) / half_angle.sin());
            let (s, c) = angle.sin_cos();
            let ruling = Vector3::new(half_angle.sin() * s, half_angle.sin() * c, half_angle.cos());
            (r * ruling, ruling, 1.0 / (r * half_angle.tan()))
        },
    );
}

/// A flat sheet, in any place, and a sphere have none.
#[test]
fn what_is_not_developable_or_not_bent_has_no_ruling() {
    let flat = strip([6, 6], [1.0, 1.0], Diagonals::UnionJack, 0.2, f64::NAN);
    let curvature = FaceCurvature::new(&flat, &[], &[]).unwrap();
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.0, -0.7);
    let points = flat.positions().as_chunks::<3>().0;
    let moved = points
        .iter()
        .flat_map(|p| <[f64; 3]>::from(turn * Vector3::from(*p) + Vector3::repeat(3.0)));
    let moved: Vec<f64> = moved.collect();
    for x in [flat.positions(), &moved] {
        assert!(curvature.rulings(x).iter().all(Option::is_none));
        assert!(
            curvature
                .gauss()
                .at(flat.topology(), x)
                .iter()
                .all(|k| *k == 0.0)
        );
    }
    // A cap that is stretched: its curvatures are alike in the middle.
    let cap = |p: &[f64; 3]| {
        let [u, v] = [p[0] - 0.5, p[1] - 0.5];
        [u, v, 0.25 * (u * u + v * v)]
    };
    let x: Vec<f64> = points.iter().flat_map(cap).collect();
    let found = curvature.rulings(&x);
    let t = flat.topology();
    let is_inside = |f: usize| {
        t.faces()[f].iter().all(|v| {
            Vector3::from(flat.position(*v))
                .xy()
                .add_scalar(-0.5)
                .norm()
                < 0.25
        })
    };
    let inside: Vec<_> = (0..t.face_count()).filter(|f| is_inside(*f)).collect();
    assert!(!inside.is_empty() && inside.iter().all(|f| found[*f].is_none()));
}

/// A sheet that is bent to both sides of a crease is not flat beside it: a roof of two quarter cylinders has
/// the curvature of both up to the crease, which a fit across would not.
#[test]
fn the_curvature_ends_at_creases() {
    let flat = strip([16, 8], [2.0, 1.0], Diagonals::Rising, 0.2, 1.0);
    let t = flat.topology();
    let on_line = |v: &VertexId| (flat.position(*v)[0] - 1.0).abs() < 1e-9;
    let is_crease =
        |e: &EdgeId| !t.is_boundary_edge(*e) && t.edges()[e.index()].iter().all(on_line);
    let creases: Vec<_> = t.edge_ids().filter(is_crease).collect();
    assert_eq!(creases.len(), 8);
    let at = |p: &[f64; 3]| {
        let side = p[0] - 1.0;
        [side.signum() * side.abs().sin(), p[1], side.abs().cos()]
    };
    // Both sides turn down from the line, at the slope of 45 degrees.
    let roof = |p: &[f64; 3]| {
        let [x, y, z] = at(p);
        let (s, c) = (x.signum() * std::f64::consts::FRAC_PI_4).sin_cos();
        [c * x - s * (1.0 - z), y, -s * x - c * (1.0 - z)]
    };
    let map = |p: &[f64; 3]| roof(p);
    let x: Vec<f64> = flat
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(map)
        .collect();
    let faces = creases.iter().flat_map(|e| t.edge_faces(*e)).flatten();
    let beside: Vec<FaceId> = faces.collect();
    // The largest relative error beside the crease, and the mean one.
    let error = |creases: &[EdgeId]| {
        let found = FaceCurvature::new(&flat, &[], creases).unwrap().forms(&x);
        let errors = beside.iter().map(|f| {
            let [first, _] = isosheet_mesh::principal_values(found[f.index()]);
            (first + 1.0).abs()
        });
        errors.fold(0.0, f64::max)
    };
    assert!(error(&creases) < 0.1, "{}", error(&creases));
    assert!(error(&[]) > 1.0, "{}", error(&[]));
}
