//! The page in a browser without a window: it draws, turns, colours, answers, and decodes what was encoded.
//!
//! These tests run where Chromium or Chrome is installed, and say so where it is not.

use super::decoder::{checksum, document, field, positions, rows};
use super::scenes::{every_body, waving};
use crate::headless::self_test;
use isosheet_mesh::{Topology, fold_angle};
use isosheet_page::{BodyShape, Centering, Field, PageOptions, Replay, Scale};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// Checks that the page drew, reacted and made no mistakes.
fn check_pictures(result: &Value) {
    for list in ["exceptions", "glErrors", "requests"] {
        assert_eq!(result[list], serde_json::json!([]), "{list}");
    }
    let covered = number(&result["covered"]);
    assert!(covered > 0.01, "the emptiest picture covers {covered}");
    assert_eq!(number(&result["opened"]["outside"]), 0.0, "all is in view");
    let pictures = &result["pictures"];
    assert_eq!(number(&pictures["views"]), 4.0, "four directions of view");
    let modes = result["modes"].as_array().unwrap().len();
    assert_eq!(
        number(&pictures["colourings"]),
        modes as f64,
        "{modes} colourings"
    );
    // Plain, wireframe, with the rest shape, without edges (which a wireframe shows all the same).
    assert!(number(&pictures["styles"]) >= 3.0);
    assert!(
        number(&result["overflow"]) <= 0.0,
        "the page is wider than the window"
    );
}

/// Checks that the page decoded what the tests decode, and computed fold angles as `isosheet-mesh` does.
fn check_numbers(result: &Value, replay: &Replay, page: &str) {
    let data = document(page);
    let frames = data["frames"].as_u64().unwrap() as usize;
    assert_eq!(
        result["checksum"].as_u64(),
        Some(checksum(&rows(&data["positions"], frames)))
    );
    for (k, sum) in result["fieldChecksums"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        assert_eq!(
            sum.as_u64(),
            Some(checksum(&rows(&data["fields"][k]["values"], frames)))
        );
        let expected = field(&data, k)[frames - 1][0];
        assert!((number(&result["values"][k]) - expected).abs() <= 1e-14 * expected.abs());
    }
    let x = positions(&data).pop().unwrap();
    assert_eq!(numbers(&result["positions"]), x);

    let topology = Topology::from_faces(x.len() / 3, &replay.faces).unwrap();
    let interior = |e| !topology.is_boundary_edge(e);
    let mut ends = numbers(&result["edgeEnds"]).into_iter().map(|v| v as u32);
    let step = number(&data["step"]);
    let height = 1.0 / f64::from(result["edges"].as_u64().unwrap() as u32).sqrt() / 2.0;
    for e in topology.edge_ids() {
        let mut pair = topology.edges()[e.index()].map(|v| v.0);
        pair.sort_unstable();
        assert_eq!([ends.next().unwrap(), ends.next().unwrap()], pair);
        let angle = &result["folds"][e.index()];
        assert_eq!(angle.is_null(), !interior(e));
        if interior(e) {
            let decoded = fold_angle(&topology, &x, e).unwrap();
            assert!(
                (number(angle) - decoded).abs() < 1e-12,
                "{angle} of {decoded}"
            );
            let exact = fold_angle(&topology, replay.positions.last().unwrap(), e).unwrap();
            assert!(
                (decoded - exact).abs() < 2.0 * step / height,
                "{decoded} of {exact}"
            );
        }
    }
    assert_eq!(ends.next(), None);
}

/// A sheet that falls twenty times its size is in view in every frame.
#[test]
fn a_sheet_that_falls_far_is_followed() {
    let mut replay = waving(2, 20);
    for (k, x) in replay.positions.iter_mut().enumerate() {
        x.iter_mut().skip(2).step_by(3).for_each(|z| *z -= k as f64);
    }
    let page = replay.to_html().unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    for list in ["exceptions", "glErrors"] {
        assert_eq!(result[list], serde_json::json!([]), "{list}");
    }
    let covered = number(&result["covered"]);
    assert!(covered > 0.01, "the emptiest picture covers {covered}");
    let opened = &result["opened"];
    assert_eq!(number(&opened["outside"]), 0.0, "all is in view");
    assert_eq!(number(&opened["frame"]), 19.0, "it has fallen farthest");
}

/// A sheet that swells and turns over is in view in every frame, in windows of any shape.
#[test]
fn all_frames_are_in_view_in_windows_of_any_shape() {
    let mut replay = waving(2, 21);
    for (k, x) in replay.positions.iter_mut().enumerate() {
        let (s, c) = (k as f64 * 0.15).sin_cos();
        for p in x.chunks_exact_mut(3) {
            [p[0], p[2]] = [c * p[0] - s * p[2], s * p[0] + c * p[2]].map(|q| q * (1.0 + s));
        }
    }
    let page = replay.to_html().unwrap();
    for window in ["900,650", "390,800", "1600,400"] {
        let Some(result) = self_test(&page, window) else {
            return;
        };
        assert_eq!(number(&result["opened"]["outside"]), 0.0, "in {window}");
        let covered = number(&result["coveredAtStart"]);
        assert!(covered > 0.01, "covers {covered} of {window}");
    }
}

#[test]
fn every_body_is_drawn_and_moves() {
    let replay = every_body(5);
    let page = replay.to_html().unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    check_pictures(&result);
    check_numbers(&result, &replay, &page);
    let bodies = result["bodies"].as_array().unwrap();
    assert_eq!(bodies.len(), 6);
    for body in bodies {
        assert_eq!(body["shows"], true, "{body}");
    }
    assert_eq!(number(&result["looks"]), 3.0, "solid, see-through, hidden");
    assert_eq!(number(&result["pictures"]["frames"]), 5.0);
    let played =
        serde_json::json!({ "starts": true, "middle": 2, "end": 4, "ends": true, "again": 0 });
    assert_eq!(result["played"], played);
    assert!(
        number(&result["coveredFitted"]) > 0.2,
        "the sheet does not fill the view"
    );
    let keys = serde_json::json!({ "end": 4, "left": 3, "home": 0, "right": 1 });
    assert_eq!(result["keys"], keys);
    // A click at three quarters of a plot of 4/60 s shows the frame at 3/60 s.
    assert!((number(&result["clicked"]) - 0.05).abs() < 1e-12);
    // Kinetic and potential energy share a plot, the constant has its own; strains are zero so early.
    assert_eq!(result["plots"].as_u64(), Some(2));
}

/// The slider of a crease pattern is the part of the folding, and creases are coloured by how open they are
/// at first, on the two colours of the paper.
#[test]
fn the_slider_of_a_fold_is_the_part_of_the_folding() {
    let mut replay = waving(2, 5);
    let mut open = vec![0.0; replay.fields[0].values[0].len()];
    open[20] = 30.0;
    replay.fields.push(Field {
        name: "crease short of its angle".into(),
        unit: "°".into(),
        place: Centering::Crease,
        scale: Scale::Linear,
        note: String::new(),
        values: vec![open; 5],
    });
    replay.folded = vec![0.0, 0.1, 0.5, 0.9, 1.0];
    replay.colour = Some(replay.fields.len() - 1);
    let page = replay.to_html().unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    for list in ["exceptions", "glErrors", "requests"] {
        assert_eq!(result[list], serde_json::json!([]), "{list}");
    }
    let key = format!("field-{}", replay.fields.len() - 1);
    assert_eq!(result["startColour"], key.as_str());
    // Plain, the fold angle, the height, and the fields: fields of creases leave the sides as they are.
    let modes = result["modes"].as_array().unwrap().len();
    assert_eq!(number(&result["pictures"]["colourings"]), modes as f64);
    let sides = &result["sides"];
    assert_ne!(sides[0][0], sides[0][1]);
    assert!(sides[1] == sides[0] && sides[modes - 1] == sides[0]);
    // Strains and forces of edges are shown on pale faces.
    assert_eq!(sides[3][0], sides[3][1]);
    let slid = &result["slid"];
    assert_eq!(slid["label"], "Part of the folding");
    let said = [
        "0 % of the fold · 1/5",
        "50 % of the fold · 3/5",
        "100 % of the fold · 5/5",
    ];
    let mut pictures = Vec::new();
    for (k, (place, said)) in slid["places"]
        .as_array()
        .unwrap()
        .iter()
        .zip(said)
        .enumerate()
    {
        assert_eq!(place["frame"], 2 * k);
        assert_eq!(place["text"], said);
        assert!(!pictures.contains(&place["picture"]));
        pictures.push(place["picture"].clone());
    }
}

#[test]
fn texts_are_shown_as_they_are_and_the_pointer_finds_the_sheet() {
    let replay = waving(2, 12);
    let page = replay.to_html().unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    check_pictures(&result);
    assert_eq!(result["title"], replay.title.as_str());
    assert_eq!(result["scene"], replay.scene.as_str());
    let hover = &result["hover"];
    let face = replay.faces[hover["face"].as_u64().unwrap() as usize];
    assert!(
        face.contains(&(hover["vertex"].as_u64().unwrap() as u32)),
        "{hover}"
    );
    let edge = hover["edge"].as_u64().unwrap() as usize;
    let ends = [0, 1].map(|k| result["edgeEnds"][2 * edge + k].as_u64().unwrap() as u32);
    assert!(ends.iter().all(|end| face.contains(end)), "{hover}");
    assert_eq!(hover["shown"], true);
    let text = hover["lines"].to_string();
    for part in [
        "Vertex",
        "Edge",
        "Face",
        "strain (edge)",
        "depth <b>&\u{e4} (vertex)",
        "Forces <i>& are one choice.",
    ] {
        assert!(text.contains(part), "{text} lacks {part}");
    }
}

#[test]
fn one_frame_makes_a_page_on_a_narrow_screen() {
    let replay = waving(1, 1);
    let page = replay.to_html().unwrap();
    let Some(result) = self_test(&page, "390,800") else {
        return;
    };
    check_pictures(&result);
    check_numbers(&result, &replay, &page);
    assert_eq!(result["frames"].as_u64(), Some(1));
}

#[test]
fn a_sheet_and_nothing_else_makes_a_page() {
    let full = waving(1, 4);
    let replay = Replay {
        faces: full.faces,
        times: full.times,
        positions: full.positions,
        rest: full.rest,
        ..Replay::default()
    };
    let page = replay.to_html().unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    check_pictures(&result);
    check_numbers(&result, &replay, &page);
    assert_eq!(result["plots"].as_u64(), Some(0));
    assert_eq!(result["title"], "Run");
}

#[test]
fn small_sheets_far_from_the_origin_are_drawn() {
    let mut replay = every_body(5);
    // A thousandth of the size, a hundred metres away; the page has single precision on the graphics card.
    let change = |x: &mut Vec<f64>| x.iter_mut().for_each(|c| *c = 1e-3 * *c + 100.0);
    change(&mut replay.rest);
    replay.positions.iter_mut().for_each(change);
    for body in &mut replay.bodies {
        body.shape = smaller(&body.shape);
        for pose in &mut body.poses {
            pose.translation = pose.translation.map(|c| 1e-3 * c + 100.0);
        }
    }
    let page = replay.to_html().unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    check_pictures(&result);
    for body in result["bodies"].as_array().unwrap() {
        assert_eq!(body["shows"], true, "{body}");
    }
    let near = self_test(&every_body(5).to_html().unwrap(), "1200,800").unwrap();
    let (far, near) = (
        number(&result["coveredFitted"]),
        number(&near["coveredFitted"]),
    );
    assert!(
        (far - near).abs() < 0.01,
        "covers {far}, at the origin {near}"
    );
}

/// A thousandth of a body.
fn smaller(shape: &BodyShape) -> BodyShape {
    let part = 1e-3;
    match shape {
        BodyShape::HalfSpace => BodyShape::HalfSpace,
        BodyShape::Cuboid { half } => BodyShape::Cuboid {
            half: half.map(|h| part * h),
        },
        BodyShape::Sphere { radius } => BodyShape::Sphere {
            radius: part * radius,
        },
        BodyShape::Cylinder {
            radius,
            half_height,
        } => BodyShape::Cylinder {
            radius: part * radius,
            half_height: part * half_height,
        },
        BodyShape::Capsule {
            radius,
            half_length,
        } => BodyShape::Capsule {
            radius: part * radius,
            half_length: part * half_length,
        },
        BodyShape::Mesh { vertices, faces } => BodyShape::Mesh {
            vertices: vertices.iter().map(|v| part * v).collect(),
            faces: faces.clone(),
        },
    }
}

#[test]
fn six_hundred_frames_are_decoded_exactly() {
    let replay = waving(3, 600);
    let page = replay.to_html().unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    check_pictures(&result);
    check_numbers(&result, &replay, &page);
    assert_eq!(number(&result["pictures"]["frames"]), 5.0);
    check_ranges(&result, &replay, &positions(&document(&page)));
}

/// Checks the range of colours of fold angles, which has 98 % of those above a degree in bins of a tenth of a
/// degree, and the range of coordinates that the camera frames, which leaves out at most 5 % at either end.
fn check_ranges(result: &Value, replay: &Replay, decoded: &[Vec<f64>]) {
    let topology = Topology::from_faces(replay.rest.len() / 3, &replay.faces).unwrap();
    let mut angles: Vec<f64> = Vec::new();
    for x in decoded {
        let of_frame = topology
            .edge_ids()
            .filter_map(|e| fold_angle(&topology, x, e));
        angles.extend(of_frame.map(|a| a.to_degrees().abs()).filter(|&a| a > 1.0));
    }
    let share =
        |limit: f64| angles.iter().filter(|&&a| a <= limit).count() as f64 / angles.len() as f64;
    let range = numbers(&result["foldRange"]);
    assert_eq!(range[0], -range[1]);
    assert!(share(range[1] + 1e-9) >= 0.98, "{range:?}");
    assert!(share(range[1] - 0.1 - 1e-9) < 0.98, "{range:?}");

    for axis in 0..3 {
        let values = || {
            decoded
                .iter()
                .flat_map(move |x| x.iter().skip(axis).step_by(3).copied())
        };
        let ends = numbers(&result["usualRange"][axis]);
        let count = values().count() as f64;
        let (below, above) = (
            values().filter(|&v| v < ends[0]),
            values().filter(|&v| v > ends[1]),
        );
        let (below, above) = (below.count() as f64 / count, above.count() as f64 / count);
        assert!((0.04..=0.05).contains(&below), "{below} are below {ends:?}");
        assert!((0.04..=0.05).contains(&above), "{above} are above {ends:?}");
    }
}

#[test]
fn a_fine_mesh_with_frames_left_out_is_shown() {
    let replay = waving(5, 40);
    assert_eq!(replay.rest.len() / 3, 4225);
    let whole = replay.to_html().unwrap();
    let options = PageOptions {
        budget: whole.len() - 1000,
    };
    let page = replay.to_html_with(&options).unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    check_pictures(&result);
    check_numbers(&result, &replay, &page);
    assert_eq!(result["frames"].as_u64(), Some(21));
    let footer = result["footer"].as_str().unwrap();
    assert!(footer.contains("one in 2 of the 40 frames"), "{footer}");
}

/// A mountain that is pressed through itself by some degrees keeps the colour of mountains.
#[test]
fn a_fold_that_is_shut_keeps_its_side() {
    let positions = |degrees: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.5, 0.0, -c, 0.5, s]
    };
    for (last, expected) in [(-185.0, -180.0), (-170.0, -170.0), (-300.0, -180.0)] {
        let angles = [0.0, -90.0, -170.0, last];
        let replay = Replay {
            rest: positions(0.0),
            faces: vec![[0, 2, 1], [0, 1, 3]],
            positions: angles.map(positions).to_vec(),
            fields: Vec::new(),
            pins: Vec::new(),
            ..waving(0, angles.len())
        };
        let Some(result) = self_test(&replay.to_html().unwrap(), "800,600") else {
            return;
        };
        let folds = result["folds"].as_array().unwrap();
        let fold = folds.iter().find(|fold| !fold.is_null()).unwrap();
        assert!((number(fold).to_degrees() - expected).abs() < 0.1, "{fold}");
    }
}
