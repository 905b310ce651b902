//! Seams that resist bending.

use crate::bodies::problem;
use crate::simulation;

const RIGIDITY: f64 = 1e-3;
const WIDTH: f64 = 0.02;
const LENGTH: f64 = 0.1;
/// The length of the clamp at the beginning of the first strip.
const CLAMP: f64 = 0.01;

/// Two strips that are glued end to end, the first one clamped, with a load at the end of the second one,
/// newtons.
fn cantilever(bend: &str, load: f64) -> String {
    let strip = |name: &str, x: f64| {
        format!(
            "[[sheet]]\nname = \"{name}\"\ndensity = 0.1\ndamping = 20\n\
             mesh = {{ rectangle = {{ width = {LENGTH:?}, height = {WIDTH:?}, columns = 10, rows = 2 }} }}\n\
             isometry = {{ elastic = {{ stiffness = 1e5, poisson = 0.0 }} }}\n\
             bending = {{ plate = {{ rigidity = {RIGIDITY:?}, poisson = 0.0 }} }}\n\
             placement = {{ position = [{x:?}, 0, 0] }}\n"
        )
    };
    format!(
        "version = 1\n{}{}\
         [[support]]\nsheet = \"first\"\nat = {{ vertices = [0, 1, 11, 12, 22, 23] }}\n\
         [[glue]]\nsheets = [\"first\", \"second\"]\n{bend}\n\
         first = {{ vertices = [10, 21, 32] }}\nsecond = {{ vertices = [0, 11, 22] }}\n\
         [[forces.load]]\nsheet = \"second\"\nat = {{ vertices = [10, 21, 32] }}\ndirection = [0, 0, 1]\nsize = {load:?}\n",
        strip("first", 0.0),
        strip("second", LENGTH)
    )
}

/// Where the middle of the loaded end comes to rest, metres.
fn tip(scene: &str) -> [f64; 3] {
    let mut run = simulation(scene);
    for _ in 0..300 {
        run.step(1.0 / 60.0).unwrap();
    }
    run.state().vertex_positions()[33 + 21]
}

/// The deflection of a beam with a torsion spring: `F L^3 / (3 D w)`, and the turn `F s / (k w)` of the
/// spring, over its distance `s` from the end.
#[test]
fn a_cantilever_of_two_strips_deflects_by_its_seam_besides() {
    let (force, arm, free) = (2e-5, LENGTH, 2.0 * LENGTH - CLAMP);
    for stiffness in [0.01, 0.03] {
        let [.., z] = tip(&cantilever(
            &format!("bend = {{ stiffness = {stiffness:?} }}"),
            force,
        ));
        let beam = force * free.powi(3) / (3.0 * RIGIDITY * WIDTH);
        let seam = force * arm * arm / (stiffness * WIDTH);
        assert!(
            (z / (beam + seam) - 1.0).abs() < 0.03,
            "{z} and {beam} + {seam}"
        );
    }
}

/// Without a load both strips are flat, and the second one is turned by the angle of the seam.
#[test]
fn a_seam_rests_at_its_angle() {
    let [x, y, z] = tip(&cantilever("bend = { stiffness = 0.05, angle = 20 }", 0.0));
    let (sin, cos) = 20.0_f64.to_radians().sin_cos();
    let expected = [LENGTH * (1.0 + cos), 0.5 * WIDTH, LENGTH * sin];
    for (found, expected) in [x, y, z].into_iter().zip(expected) {
        assert!((found - expected).abs() < 0.01 * LENGTH, "{x} {y} {z}");
    }
}

#[test]
fn bends_of_seams_without_a_common_edge_are_refused() {
    let said = |from: &str, to: &str| {
        let scene = cantilever("bend = { stiffness = 0.05 }", 0.0);
        assert!(scene.contains(from));
        problem(&scene.replace(from, to))
    };
    // Single points, far from each other.
    let apart = said(
        "[10, 21, 32] }\nsecond = { vertices = [0, 11, 22] }",
        "[10, 32] }\nsecond = { vertices = [0, 22] }",
    );
    assert!(apart.contains("glue[0].bend"), "{apart}");
    let closing = said(
        "bend = {",
        "closing = { ramp = { to = 1, end = 1 } }\nbend = {",
    );
    assert!(closing.contains("closed at all times"), "{closing}");
    let angle = said("0.05 }", "0.05, angle = 200 }");
    assert!(angle.contains("glue[0].bend.angle"), "{angle}");
}
