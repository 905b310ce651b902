//! Loads that follow the sheet, in scenes.

use crate::{parse, simulation};
use isosheet_dynamics::nalgebra::Vector3;
use isosheet_scenes::{LiveScene, StartingPoint};

/// A square of two faces above its lower left corner, which it is pinned by, with a load.
fn square(placement: &str, forces: &str) -> String {
    format!(
        "version = 1
        [sheet]
        mesh = {{ rectangle = {{ width = 0.1, height = 0.2, columns = 1, rows = 1 }} }}
        density = 2.0
        {placement}
        {forces}"
    )
}

/// Sum of the forces on all vertices at the start, turned by an angle about the x axis.
fn force(forces: &str, angle: f64) -> Vector3<f64> {
    let simulation = simulation(&square("", forces));
    let (sine, cosine) = angle.to_radians().sin_cos();
    let points = simulation.state().x.as_chunks::<3>().0.iter();
    let x: Vec<f64> = points
        .flat_map(|[x, y, z]| [*x, cosine * y - sine * z, sine * y + cosine * z])
        .collect();
    let mut sum = vec![0.0; x.len()];
    simulation
        .model()
        .applied_force(0.0, &x, &vec![0.0; x.len()], &mut sum);
    sum.as_chunks::<3>()
        .0
        .iter()
        .map(|f| Vector3::from(*f))
        .sum()
}

#[test]
fn loads_turn_with_the_sheet() {
    let close = |found: Vector3<f64>, want: [f64; 3]| {
        assert!((found - Vector3::from(want)).norm() < 1e-12, "{found}");
    };
    // 0.02 m2 of 50 Pa.
    let pressure = "[[forces.pressure]]\nsize = 50\n";
    close(force(pressure, 0.0), [0.0, 0.0, 1.0]);
    close(force(pressure, 90.0), [0.0, -1.0, 0.0]);
    let load = |frame: &str| {
        format!("[[forces.load]]\nat = \"all\"\ndirection = [0, 3, 4]\nsize = 5\n{frame}\n")
    };
    close(force(&load(""), 90.0), [0.0, 3.0, 4.0]);
    close(force(&load("frame = \"space\""), 90.0), [0.0, 3.0, 4.0]);
    close(force(&load("frame = \"sheet\""), 0.0), [0.0, 3.0, 4.0]);
    close(force(&load("frame = \"sheet\""), 90.0), [0.0, -4.0, 3.0]);
}

/// A moment on the lower edge turns the square about it.
#[test]
fn a_moment_turns_about_its_edges() {
    let moment = "[[forces.moment]]\nat = { vertices = [0, 1] }\naxis = [2, 0, 0]\nsize = 0.5\n";
    let run = simulation(&square("", moment));
    let x = &run.state().x;
    let mut forces = vec![0.0; x.len()];
    run.model()
        .applied_force(0.0, x, &vec![0.0; x.len()], &mut forces);
    let rows = x.as_chunks::<3>().0.iter().zip(forces.as_chunks::<3>().0);
    let torque: Vector3<f64> = rows
        .map(|(x, f)| Vector3::from(*x).cross(&Vector3::from(*f)))
        .sum();
    assert!(
        (torque - Vector3::new(0.5, 0.0, 0.0)).norm() < 1e-12,
        "{torque}"
    );
}

/// The volume between two sheets that lie above each other: that below the second less that below the first.
fn volume(faces: &[[u32; 3]], x: &[f64]) -> f64 {
    let at = |v: u32| Vector3::from_column_slice(&x[3 * v as usize..][..3]);
    let half = faces.len() / 2;
    let below = faces.iter().enumerate().map(|(f, &[a, b, c])| {
        let across = (at(b) - at(a)).cross(&(at(c) - at(a))).z / 2.0;
        let below = across * (at(a) + at(b) + at(c)).z / 3.0;
        if f < half { -below } else { below }
    });
    below.sum()
}

/// The pillow of `isosheet new` takes the air that is blown in, at a pressure hardly above that outside.
#[test]
fn a_pillow_takes_the_air_that_is_blown_in() {
    let scene = parse(StartingPoint::Pillow.text()).unwrap_or_else(|e| panic!("{e}"));
    let setup = scene.build().unwrap_or_else(|e| panic!("{e}"));
    let faces = setup.sheet.face_indices();
    let mut run = setup.start().unwrap_or_else(|e| panic!("{e}"));
    let first = volume(&faces, &run.state().x);
    assert!((first / (0.2 * 0.2 * 0.002) - 1.0).abs() < 1e-9, "{first}");
    for _ in 0..100 {
        run.step(0.01).unwrap_or_else(|e| panic!("{e}"));
    }
    let part = volume(&faces, &run.state().x) / (first + 5e-4);
    assert!((0.98..1.0).contains(&part), "{part}");
}

/// The size of a pressure is driven while it acts.
#[test]
fn a_pressure_is_driven_by_hand() {
    let text = square(
        "damping = 1.0",
        "[[forces.pressure]]\nsize = 0\n[method]\nstep = 0.01",
    );
    let file = parse(&text).unwrap_or_else(|e| panic!("{e}"));
    let mut live = LiveScene::start(file).unwrap_or_else(|e| panic!("{e}"));
    live.step(0.01).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(live.simulation().state().v, vec![0.0; 12]);
    let key = "forces.pressure[0].size".parse().expect("a key");
    live.drive(&[(key, 20.0.into())], 0.02)
        .unwrap_or_else(|e| panic!("{e}"));
    for _ in 0..10 {
        live.step(0.01).unwrap_or_else(|e| panic!("{e}"));
    }
    assert!(live.simulation().state().v[2] > 0.1);
}

#[test]
fn what_cannot_be_loaded_is_named() {
    let message = |forces: &str| {
        let result = parse(&square("", forces)).map(|file| file.build().map(|_| ()));
        match result {
            Err(error) => error.to_string(),
            Ok(Err(error)) => error.to_string(),
            Ok(Ok(())) => panic!("accepted: {forces}"),
        }
    };
    for (forces, words) in [
        (
            "[[forces.gas]]",
            "the surface around the gas is open at the edge",
        ),
        ("[[forces.gas]]\nexponent = 0", "exponent = 0"),
        (
            "[[forces.pressure]]\nat = { vertices = [0] }\nsize = 1",
            "no face has all of its corners",
        ),
        (
            "[[forces.pressure]]\nsheets = []\nsize = 1",
            "no sheet is named",
        ),
        (
            "[[forces.pressure]]\nsheets = [\"top\"]\nsize = 1",
            "sheets = [\"top\"]",
        ),
        (
            "[[forces.load]]\nat = \"all\"\ndirection = [0, 0, 1]\nsize = 1e18",
            "lost in round-off",
        ),
        ("[[forces.pressure]]\nsize = 1e15", "lost in round-off"),
        (
            "[[forces.moment]]\nat = { vertices = [0] }\naxis = [1, 0, 0]\nsize = 1",
            "no edge has both of its ends",
        ),
        (
            "[[forces.moment]]\nat = { vertices = [0, 1] }\naxis = [0, 1, 0]\nsize = 1",
            "is across the axis of the moment",
        ),
    ] {
        let found = message(forces);
        assert!(found.contains(words), "{found}\n{words}");
    }
}

/// More than is there is not let out in silence.
#[test]
fn a_gas_keeps_a_part_of_what_it_has() {
    let text = StartingPoint::Pillow.text();
    let volume = 0.2 * 0.2 * 0.002;
    let out = |part: f64| {
        let to = format!("to = {:e}", -part * volume);
        let text = text.replace("to = 5e-4", &to);
        assert!(text.contains(&to));
        parse(&text).unwrap().build().map(|_| ())
    };
    out(0.9).unwrap_or_else(|e| panic!("{e}"));
    let message = out(1.1).unwrap_err().to_string();
    assert!(message.contains("are let out"), "{message}");
}
