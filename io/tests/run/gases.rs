//! Pressure and volume of gases and of closed surfaces as measures.

use crate::{code, run, stderr, summary};
use isosheet_formats::read_measures;
use isosheet_runs::Recording;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

/// Sides of the prism.
const SIDES: usize = 7;
/// Its radius and its height at the start, metres.
const RADIUS: f64 = 0.05;
const HEIGHT: f64 = 0.1;

/// A closed prism all vertices of which are held, and whose upper end is lowered to a tenth less of its
/// height.
fn scene(forces: &str) -> String {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for z in [0.0, HEIGHT] {
        for k in 0..SIDES {
            let (s, c) = (TAU * k as f64 / SIDES as f64).sin_cos();
            vertices.push([RADIUS * c, RADIUS * s, z]);
        }
    }
    for k in 0..SIDES {
        let next = (k + 1) % SIDES;
        faces.push([k, next, SIDES + next]);
        faces.push([k, SIDES + next, SIDES + k]);
        if (2..SIDES).contains(&k) {
            faces.push([0, k, k - 1]);
            faces.push([SIDES, SIDES + k - 1, SIDES + k]);
        }
    }
    let mut text = format!(
        "version = 1
[sheet]
mesh = {{ triangles = {{ vertices = {vertices:?}, faces = {faces:?} }} }}
mass = 0.01
isometry = {{ elastic = {{ stiffness = 10, limit = 0.49 }} }}
"
    );
    for (first, motion) in [(0, ""), (SIDES, "z")] {
        let own: Vec<usize> = (first..first + SIDES).collect();
        let hold = match motion {
            "" => "\"pin\"".to_owned(),
            _ => format!(
                "{{ moving_pin = {{ z = {{ ramp = {{ to = {}, end = 1 }} }} }} }}",
                -HEIGHT / 10.0
            ),
        };
        write!(
            text,
            "[[support]]\nat = {{ vertices = {own:?} }}\nhold = {hold}\n"
        )
        .unwrap();
    }
    text + forces + "[method]\nstep = 0.05\n[stop]\ntime = 1\n"
}

/// Volume at a time.
fn volume(t: f64) -> f64 {
    let area = 0.5 * SIDES as f64 * RADIUS.powi(2) * (TAU / SIDES as f64).sin();
    area * HEIGHT * (1.0 - 0.1 * t)
}

/// The gas follows `p = p1 ((V1 + a) / V)^n` by its own name, and without being asked for.
#[test]
fn pressure_and_volume_of_a_gas_are_recorded() {
    let (first, exponent) = (2e5, 1.4);
    for (name, called) in [("name = \"bag\"\n", "bag"), ("", "gas[0]")] {
        let forces = format!(
            "[[forces.gas]]
{name}pressure = {first}
exponent = {exponent}
added = {{ ramp = {{ to = 1e-4, end = 1 }} }}
"
        );
        let asked =
            "[[measure]]\nname = \"own\"\nenclosed = \"bag\"\nquantity = \"gauge_pressure\"\n";
        let is_asked = called == "bag";
        let dir = tempfile::tempdir().unwrap();
        let dir = dir.path();
        let text = scene(&(forces + if is_asked { asked } else { "" }));
        fs::write(dir.join("bag.toml"), text).unwrap();
        let done = run(dir, &["simulate", "bag.toml", "--out", "run"]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let rows = read_measures(&dir.join("run/measures.csv")).unwrap();
        assert_eq!(rows.len(), 21 * if is_asked { 4 } else { 3 });
        for row in &rows {
            let v = volume(row.t);
            let pressure = first * ((volume(0.0) + 1e-4 * row.t) / v).powf(exponent);
            let exact = match row.name.strip_prefix(called) {
                Some(".pressure") => pressure,
                Some(".volume") => v,
                _ => pressure - 101_325.0,
            };
            assert!((row.value / exact - 1.0).abs() < 1e-12, "{row:?}: {exact}");
        }
        let measured = &summary(&dir.join("run")).measures;
        let last = measured[&format!("{called}.volume")];
        assert!((last.last / volume(1.0) - 1.0).abs() < 1e-12);
        assert!((last.largest / volume(0.0) - 1.0).abs() < 1e-12);
        let recording = Recording::read(&dir.join("run")).unwrap();
        let facts = recording.facts();
        let shown = facts
            .iter()
            .find(|(name, _)| *name == format!("{called}.gauge_pressure"));
        assert!(shown.unwrap().1.contains("Pa at the end"), "{shown:?}");
        let series = recording.replay().unwrap().series;
        let plotted = series.iter().find(|s| s.name == format!("{called}.volume"));
        assert_eq!(plotted.unwrap().unit, "m3");
    }
}

/// A pressure that is prescribed on a closed surface has a volume, and its size.
#[test]
fn the_volume_inside_of_a_pressure_is_measured() {
    let forces = |quantity: &str, at: &str| {
        format!(
            "[[forces.pressure]]\nname = \"inside\"\nsize = {{ ramp = {{ to = 300, end = 1 }} }}\n{at}\
             [[measure]]\nname = \"own\"\nenclosed = \"inside\"\nquantity = \"{quantity}\"\n"
        )
    };
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let tried = |text: String| {
        fs::write(dir.join("bag.toml"), scene(&text)).unwrap();
        run(dir, &["simulate", "bag.toml", "--out", "run", "--force"])
    };
    for (quantity, exact) in [
        ("volume", volume as fn(f64) -> f64),
        ("gauge_pressure", |t| 300.0 * t),
    ] {
        let done = tried(forces(quantity, ""));
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let rows = read_measures(&dir.join("run/measures.csv")).unwrap();
        assert_eq!(rows.len(), 21);
        for row in rows {
            let exact = exact(row.t);
            assert!(
                (row.value - exact).abs() <= 1e-12 * exact,
                "{row:?}: {exact}"
            );
        }
    }
    for (text, expected) in [
        (
            forces("pressure", ""),
            "nothing that has this quantity has the name `inside`",
        ),
        (
            forces("z", ""),
            "this quantity is none of what a surface encloses",
        ),
        (
            forces("volume", "at = { vertices = [0, 1, 2, 3, 4, 5, 6] }\n"),
            "the faces of the pressure `inside` enclose no volume",
        ),
        (
            forces("volume", "[[forces.gas]]\nname = \"inside\"\n"),
            "another gas or pressure has the name `inside`",
        ),
        (
            forces("volume", "[[forces.gas]]\nname = \"a b\"\n"),
            "`a b` cannot be the name of a gas",
        ),
    ] {
        let done = tried(text);
        assert_eq!(code(&done), Some(3), "{}", stderr(&done));
        assert!(
            stderr(&done).contains(expected),
            "{expected}: {}",
            stderr(&done)
        );
    }
}
