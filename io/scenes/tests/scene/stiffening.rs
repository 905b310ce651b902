//! Sheets whose stiffness changes.

use crate::{parse, simulation};

/// A strip that is clamped at one end and hangs by its weight, as a beam for small deflections.
fn strip(lines: &str) -> String {
    format!(
        "version = 1\n[sheet]\nmesh = {{ rectangle = {{ width = 0.2, height = 0.02, columns = 20, rows = 2 }} }}\n\
         density = 0.1\nbending = {{ plate = {{ rigidity = 0.02, poisson = 0 }} }}\n\
         isometry = {{ elastic = {{ stiffness = 3e5, poisson = 0 }} }}\ndamping = 20\n{lines}\n\
         [[support]]\nat = {{ half_space = {{ point = [1e-6, 0, 0], normal = [-1, 0, 0] }} }}\nhold = \"clamp\"\n\
         [forces]\ngravity = [0, 0, -9.81]\n"
    )
}

/// `g w L^4 / (8 D)`, with its rigidity at first and four times as much at the end.
#[test]
fn a_strip_that_stiffens_rises() {
    let text = strip("stiffening = { smooth_step = { from = 1, to = 4, begin = 1, end = 2 } }");
    let mut simulation = simulation(&text);
    for factor in [1.0, 4.0] {
        for _ in 0..60 * factor as usize {
            simulation.step(1.0 / 60.0).unwrap();
        }
        let expected = -0.1 * 9.81 * 0.2_f64.powi(4) / (8.0 * 0.02 * factor);
        let points = simulation.state().x.as_chunks::<3>().0;
        let tip = points.iter().map(|p| p[2]).fold(0.0, f64::min);
        assert!((tip / expected - 1.0).abs() < 0.01, "{tip} {expected}");
    }
}

#[test]
fn what_cannot_stiffen_is_refused() {
    for (lines, reason) in [
        ("stiffening = 0", "stiffening"),
        (
            "stiffening = { ramp = { from = 1, to = -1, end = 1 } }",
            "stiffening",
        ),
    ] {
        let error = parse(&strip(lines)).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
    let error = parse(&strip("stiffening = 1e4")).unwrap_err();
    assert!(!format!("{error:?}").contains("friction"), "{error:?}");
    let text = "version = 1\n[sheet]\nmesh = { square = { side = 0.2, level = 1 } }\ndensity = 0.1\nstiffening = 2\n";
    let error = parse(text).unwrap_err().to_string();
    assert!(error.contains("nothing resists bending"), "{error}");
}
