//! Bad input is an error that says what is wrong and where.

use super::scenes::every_body;
use isosheet_files::DataError;
use isosheet_mesh::Advice;
use isosheet_page::{BodyShape, Replay};

/// The error that a change of a good replay leads to.
fn error(change: impl FnOnce(&mut Replay)) -> DataError {
    let mut replay = every_body(4);
    replay.validate().unwrap();
    change(&mut replay);
    let error = replay.validate().unwrap_err();
    // Texts are compared, because NaN differs from itself.
    assert_eq!(error.to_string(), replay.to_html().unwrap_err().to_string());
    error
}

#[track_caller]
fn says(change: impl FnOnce(&mut Replay), parts: &[&str]) {
    let text = error(change).with_advice();
    for part in parts {
        assert!(text.contains(part), "{text:?} does not say {part:?}");
    }
}

#[test]
fn of_frames() {
    says(|r| r.positions.clear(), &["no frames"]);
    says(|r| r.faces.clear(), &["no faces"]);
    says(
        |r| r.times.truncate(3),
        &["the times of the frames", "3", "4"],
    );
    says(|r| r.times[2] = 0.0, &["entry 2", "0 s after 0.016"]);
    says(
        |r| r.times[1] = f64::NAN,
        &["the times of the frames", "entry 1", "NaN"],
    );
    says(
        |r| r.positions[3].truncate(10),
        &["frame 3", "0.05 s", "10", "243"],
    );
    says(
        |r| r.positions[3][17] = f64::INFINITY,
        &["frame 3", "0.05 s", "entry 17", "inf"],
    );
    says(
        |r| r.positions[0][1] = -1e301,
        &["frame 0", "entry 1", "1e300"],
    );
}

#[test]
fn of_the_mesh() {
    says(
        |r| r.sheets = vec![100, 27],
        &["the faces of all sheets", "127", "128"],
    );
    says(
        |r| r.rest.truncate(242),
        &["the rest positions", "242", "240"],
    );
    says(|r| r.rest[5] = f64::NAN, &["the rest positions", "entry 5"]);
    says(
        |r| r.faces[0][0] = 81,
        &["the triangles of the sheet: face 0"],
    );
    says(|r| r.faces[0].swap(0, 1), &["the triangles of the sheet: "]);
    let nan = error(|r| r.rest[5] = f64::NAN);
    assert_eq!(nan.index, Some(5));
    assert!(nan.value.is_some_and(f64::is_nan));
    says(
        |r| r.pins.push(81),
        &["the pins", "entry 2", "vertex 81", "81 vertices"],
    );
    says(
        |r| r.immobile.push(90),
        &[
            "the immobile vertices",
            "entry 0",
            "vertex 90",
            "81 vertices",
        ],
    );
}

#[test]
fn of_bodies() {
    says(
        |r| r.bodies[2].poses.truncate(2),
        &["body 2 (`ball`)", "2", "4"],
    );
    says(
        |r| r.bodies[1].poses.clear(),
        &["body 1 (`cuboid`)", "the poses", "0", "4"],
    );
    says(
        |r| r.bodies[2].poses[3].rotation = [0.0; 4],
        &["`ball`", "pose 3", "length 0"],
    );
    says(
        |r| r.bodies[2].poses[3].translation[1] = f64::NAN,
        &["translation of pose 3", "entry 1"],
    );
    says(
        |r| r.bodies[2].shape = BodyShape::Sphere { radius: 0.0 },
        &["`ball`", "the radius is 0 m"],
    );
    says(
        |r| {
            r.bodies[1].shape = BodyShape::Cuboid {
                half: [1.0, f64::NAN, 1.0],
            }
        },
        &["along y is NaN m"],
    );
    let mesh = |vertices: Vec<f64>, faces: Vec<[u32; 3]>| {
        move |r: &mut Replay| r.bodies[5].shape = BodyShape::Mesh { vertices, faces }
    };
    says(
        mesh(vec![0.0; 9], vec![[0, 1, 3]]),
        &["`tetrahedron`", "entry 2", "vertex 3", "3 vertices"],
    );
    says(
        mesh(vec![0.0; 8], vec![[0, 1, 1]]),
        &["the corners", "8", "6"],
    );
    says(
        mesh(vec![0.0; 9], vec![]),
        &["`tetrahedron`", "no triangles"],
    );
}

#[test]
fn of_fields_and_series() {
    says(|r| r.fields[1].values.truncate(1), &["field 1", "1", "4"]);
    says(
        |r| r.fields[0].values[2].truncate(5),
        &["field 0 (`strain`), frame 2", "5", "208"],
    );
    says(
        |r| r.fields[0].values[2][7] = -1e-9,
        &["`strain`", "frame 2", "entry 7", "no logarithm"],
    );
    says(
        |r| r.fields[1].values[3][0] = f64::NAN,
        &["field 1", "frame 3", "entry 0"],
    );
    says(
        |r| r.series[0].values.truncate(1),
        &["series 0 (`kinetic energy`)", "1", "4"],
    );
    says(
        |r| r.series[2].values[1] = -1.0,
        &["series 2", "entry 1 is -1"],
    );
    says(
        |r| r.series[1].times[3] = 0.0,
        &["series 1", "the times", "entry 3"],
    );
}
