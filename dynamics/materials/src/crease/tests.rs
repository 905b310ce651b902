use super::*;
use crate::hessian::HessianPart;
use crate::testing::product;
use isosheet_mesh::{fold_angle, generate};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A crumpled M^1 and springs on all its interior edges, some of them driven.
fn crumpled() -> (Sheet, Vec<f64>) {
    let sheet = generate::isotropic_square(1, 1.0).expect("valid");
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let x = sheet.positions().iter();
    let x = x.map(|p| p + rng.random_range(-0.08..0.08)).collect();
    (sheet, x)
}

fn interior(t: &Topology) -> Vec<EdgeId> {
    t.edge_ids().filter(|e| !t.is_boundary_edge(*e)).collect()
}

fn springs(t: &Topology, rest: impl Fn(EdgeId) -> f64) -> CreaseSprings {
    let springs = interior(t).into_iter().map(|edge| {
        let angle = rest(edge);
        CreaseSpring {
            edge,
            stiffness: 0.5 + 0.01 * edge.index() as f64,
            rest: if edge.index() % 2 == 0 {
                RestAngle::from(angle)
            } else {
                RestAngle::from(move |t| angle * t)
            },
            yields: None,
            in_series: None,
        }
    });
    CreaseSprings::new(t, springs.collect()).expect("interior edges")
}

fn gradient(p: &CreaseSprings, t: f64, x: &[f64]) -> Vec<f64> {
    let mut g = vec![0.0; x.len()];
    p.add_gradient(At::new(t, x), &mut g);
    g
}

#[test]
fn angles_are_those_of_the_mesh_in_sign_and_size() {
    let (sheet, x) = crumpled();
    let t = sheet.topology();
    for e in interior(t) {
        let spring = CreaseSpring {
            edge: e,
            stiffness: 1.0,
            rest: 0.0.into(),
            yields: None,
            in_series: None,
        };
        let own = CreaseSprings::new(t, vec![spring]).expect("interior");
        let moment = own.moments(At::new(0.0, &x))[0];
        let angle = fold_angle(t, &x, e).expect("interior");
        assert!(
            (moment + angle).abs() < 1e-13,
            "{e}: {moment} against {angle}"
        );
    }
}

#[test]
fn the_gradient_matches_differences_of_the_energy() {
    let (sheet, x) = crumpled();
    let p = springs(sheet.topology(), |e| 0.7 * (e.index() as f64).sin());
    let (time, h) = (1.3, 1e-5);
    let g = gradient(&p, time, &x);
    let largest = g.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    for i in 0..x.len() {
        let at = |s: f64| {
            let mut moved = x.clone();
            moved[i] += s * h;
            p.energy(At::new(time, &moved))
        };
        // Fourth order.
        let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
        assert!(
            (slope - g[i]).abs() < 1e-9 * largest,
            "coordinate {i}: {slope} against {}",
            g[i]
        );
    }
}

#[test]
fn the_hessian_matches_differences_of_the_gradient() {
    let (sheet, x) = crumpled();
    let t = sheet.topology();
    let p = springs(t, |e| 0.7 * (e.index() as f64).sin());
    // Driven angles are at their amplitude at t = 1.
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let d: Vec<f64> = x.iter().map(|_| rng.random_range(-1.0..1.0)).collect();
    let at = (At::new(1.0, &x), HessianPart::Full);
    let product = product(t, &p, at, &d);
    let h = 1e-5;
    let moved = |s: f64| {
        let moved: Vec<f64> = x.iter().zip(&d).map(|(x, d)| x + s * h * d).collect();
        gradient(&p, 1.0, &moved)
    };
    let (up, down) = (moved(1.0), moved(-1.0));
    let largest = product.iter().fold(0.0f64, |m, p| m.max(p.abs()));
    for i in 0..x.len() {
        let slope = (up[i] - down[i]) / (2.0 * h);
        assert!(
            (slope - product[i]).abs() < 1e-6 * largest,
            "coordinate {i}: {slope} against {}",
            product[i]
        );
    }
}

#[test]
fn a_fold_that_passes_shut_goes_on() {
    let sheet = generate::fan(2, 1.0, 1.0).expect("valid");
    let t = sheet.topology();
    let spring = CreaseSpring {
        edge: interior(t)[0],
        stiffness: 2.0,
        rest: 3.0.into(),
        yields: None,
        in_series: None,
    };
    let p = CreaseSprings::new(t, vec![spring]).expect("interior");
    let hinge = &p.hinges[0];
    assert!((hinge.excess(0.0, -3.1, 0.0) - (TAU - 6.1)).abs() < 1e-14);
    assert!((hinge.excess(0.0, 3.1, 0.0) - 0.1).abs() < 1e-14);
}

#[test]
fn what_makes_no_sense_is_named() {
    let sheet = generate::isotropic_square(0, 1.0).expect("valid");
    let t = sheet.topology();
    let make = |edge: EdgeId, stiffness: f64, angle: f64| {
        let rest = RestAngle::from(angle);
        let spring = CreaseSpring {
            edge,
            stiffness,
            rest,
            yields: None,
            in_series: None,
        };
        CreaseSprings::new(t, vec![spring]).map(|_| ())
    };
    let edge = interior(t)[0];
    let rim = t
        .edge_ids()
        .find(|e| t.is_boundary_edge(*e))
        .expect("a rim");
    assert_eq!(
        make(rim, 1.0, 0.0),
        Err(CreaseError::NotInterior { edge: rim })
    );
    let beyond = EdgeId(99);
    assert_eq!(
        make(beyond, 1.0, 0.0),
        Err(CreaseError::NotInterior { edge: beyond })
    );
    let stiffness = -1.0;
    assert_eq!(
        make(edge, stiffness, 0.0),
        Err(CreaseError::Stiffness { edge, stiffness })
    );
    assert_eq!(
        make(edge, 1.0, 4.0),
        Err(CreaseError::Angle { edge, angle: 4.0 })
    );
    assert!(CreaseSprings::bending(&sheet, f64::NAN).is_err());
    assert!(make(edge, 0.0, PI).is_ok());
}

#[test]
fn bending_along_grid_lines_has_the_energy_of_a_plate() {
    let (n, side, rigidity, radius) = (8, 0.8, 0.3, 0.5);
    let sheet = generate::grid(n, n, side, side, generate::Diagonals::UnionJack).expect("valid");
    let step = side / n as f64;
    // Chords of length `step` on a circle: lines along y, folds 2 asin(step / 2R).
    let turn = 2.0 * (0.5 * step / radius).asin();
    let mut place = vec![[0.0, 0.0]];
    for i in 0..n {
        let a = turn * (i as f64 + 0.5);
        let [u, w] = place[i];
        place.push([u + step * a.cos(), w + step * a.sin()]);
    }
    let x: Vec<f64> = sheet
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|p| {
            let [u, w] = place[(p[0] / step).round() as usize];
            [u, p[1], w]
        })
        .collect();
    let energy = CreaseSprings::bending(&sheet, rigidity)
        .expect("valid")
        .energy(At::new(0.0, &x));
    // n - 1 lines inside, each for a row of cells; the two outermost half-cells are not bent.
    let exact = 0.5 * rigidity * (turn / step).powi(2) * side * step * (n - 1) as f64;
    assert!((energy - exact).abs() < 1e-12 * exact, "{energy} {exact}");
}

/// What is left of the fold angle without the bend of the sheet is the angle by which the springs turn as
/// they were given: all of them at an edge, of the stiffness `k_i`, carry `sum k_i (kink - rest_i)` together.
#[test]
fn the_kink_is_the_fold_angle_without_the_bend_of_the_sheet() {
    let (sheet, x) = crumpled();
    let t = sheet.topology();
    let rigidity = 0.3;
    let given = |scale: f64, rest: f64| -> Vec<CreaseSpring> {
        let spring = |edge: EdgeId| CreaseSpring {
            edge,
            stiffness: scale * (0.5 + 0.01 * edge.index() as f64),
            rest: rest.into(),
            yields: None,
            in_series: None,
        };
        interior(t).into_iter().map(spring).collect()
    };
    let given = [given(1.0, 0.4), given(0.2, -1.0)];
    let mut put = given.iter().map(|springs| {
        let copy = |s: &CreaseSpring| CreaseSpring {
            rest: s.rest.clone(),
            ..*s
        };
        springs.iter().map(copy).collect::<Vec<_>>()
    });
    let mut put: [Vec<CreaseSpring>; 2] = [0, 1].map(|_| put.next().expect("two groups"));
    CreaseSpring::put_in_sheet(put.iter_mut().flatten(), &sheet, rigidity);
    let put = put.map(|springs| CreaseSprings::new(t, springs).expect("interior edges"));
    let at = At::new(0.0, &x);
    let moments = put.each_ref().map(|springs| springs.moments(at));
    let bends = put.each_ref().map(|springs| springs.bends_beside(at));
    for (k, e) in interior(t).into_iter().enumerate() {
        let bend: f64 = bends.iter().map(|b| b[k].1).sum();
        assert_eq!(bends.each_ref().map(|b| b[k].0), [e, e]);
        let kink = fold_angle(t, &x, e).expect("interior") - bend;
        let carried: f64 = moments.iter().map(|m| m[k]).sum();
        let wanted: f64 = [0.4, -1.0]
            .iter()
            .zip(&given)
            .map(|(rest, springs)| springs[k].stiffness * (rest - kink))
            .sum();
        assert!((carried - wanted).abs() < 1e-13, "{e}: {carried} {wanted}");
        // The sheet carries the same moment over the two faces.
        let [a, b] = t
            .edge_faces(e)
            .map(|f| sheet.face_areas()[f.expect("interior").index()]);
        let own = rigidity * sheet.lengths()[e.index()].powi(2) / (a + b) * bend;
        assert!((carried + own).abs() < 1e-13, "{e}: {carried} {own}");
    }
    let limp = CreaseSprings::new(t, given.into_iter().next().expect("two groups"));
    assert!(limp.expect("interior").bends_beside(at).is_empty());
}
