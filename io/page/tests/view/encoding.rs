//! What a page holds is what the replay holds, to the precision that the documentation states.

use super::decoder;
use super::decoder::{document, doubles, field, frames, indices, positions};
use super::scenes::{every_body, scattered, waving};
use isosheet_mesh::{Topology, generate};
use isosheet_page::{Centering, Field, PageOptions, Replay, Scale};
use serde_json::Value;

/// The page's program, style and template: what a page has besides its data.
fn frame_size(page: &str) -> usize {
    page.len() - document(page).to_string().len()
}

/// The length of the longest side of the box of all positions.
fn longest_side(replay: &Replay) -> f64 {
    let side = |axis: usize| {
        let values = || {
            replay
                .positions
                .iter()
                .flat_map(move |x| x.iter().skip(axis).step_by(3).copied())
        };
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    (0..3).map(side).fold(0.0, f64::max)
}

/// The largest difference between tables of the same shape.
fn largest_difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    let mut largest = 0.0_f64;
    for (a, b) in a.iter().zip(b) {
        assert_eq!(a.len(), b.len());
        largest = a
            .iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(largest, f64::max);
    }
    largest
}

#[test]
fn positions_are_exact_to_half_a_step_of_the_box() {
    let smooth = waving(2, 40);
    // Positions that jump at random use every difference that integers of 16 bits can have.
    let mut random = smooth.clone();
    for (k, x) in random.positions.iter_mut().flatten().enumerate() {
        *x = 1e3 + [0.0, 1.0, scattered(k)][k % 3];
    }
    for k in 0..random.positions.len() {
        random.positions[k][0] = 1e3 + (k % 2) as f64;
    }
    for replay in [smooth, random] {
        let data = document(&replay.to_html().unwrap());
        let step = longest_side(&replay) / 65535.0;
        let error = largest_difference(&positions(&data), &replay.positions);
        let round_off = 2.0 * f64::EPSILON * 1e3;
        assert!(
            error <= step / 2.0 * (1.0 + 1e-9) + round_off,
            "{error:e} for steps of {step:e}"
        );
        // The bound is sharp: coordinates that fill the box meet errors close to it.
        assert!(error > 0.4 * step, "{error:e} for steps of {step:e}");
    }
}

#[test]
fn fields_are_exact_to_their_stated_precision() {
    let mut replay = waving(2, 30);
    let decades = |k: usize, e: usize| match (k + e) % 9 {
        0 => 0.0,
        _ => 10_f64.powf(-17.0 + 8.0 * scattered(31 * k + e)),
    };
    let sizes = |row: &Vec<f64>| row.iter().map(|f| f.abs()).collect();
    replay.fields.push(Field {
        name: "size of the force".into(),
        scale: Scale::Magnitude,
        values: replay.fields[2].values.iter().map(sizes).collect(),
        ..replay.fields[2].clone()
    });
    let edges = replay.fields[0].values[0].len();
    replay.fields[0].values = (0..30)
        .map(|k| (0..edges).map(|e| decades(k, e)).collect())
        .collect();
    let data = document(&replay.to_html().unwrap());

    let linear = &replay.fields[1].values;
    let all = || linear.iter().flatten().copied();
    let range = all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min);
    let error = largest_difference(&field(&data, 1), linear);
    assert!(error <= range / 65535.0 / 2.0 * (1.0 + 1e-9), "{error:e}");

    let positive = || {
        replay.fields[0]
            .values
            .iter()
            .flatten()
            .copied()
            .filter(|&v| v > 0.0)
    };
    let ratio = positive().fold(f64::MIN, f64::max) / positive().fold(f64::MAX, f64::min);
    let factor = ratio.powf(1.0 / 508.0) * (1.0 + 1e-9);
    for (read, given) in field(&data, 0)
        .iter()
        .flatten()
        .zip(replay.fields[0].values.iter().flatten())
    {
        match *given == 0.0 {
            true => assert_eq!(*read, 0.0),
            false => assert!(
                (1.0 / factor..=factor).contains(&(read / given)),
                "{read:e} of {given:e}"
            ),
        }
    }

    for (index, has_negative) in [(2, true), (3, false)] {
        let given = &replay.fields[index].values;
        let size = |l: f64, v: &f64| l.max(v.abs());
        let largest = given.iter().flatten().fold(0.0, size);
        let mut kept = [0, 0, 0];
        let read = field(&data, index);
        for (read, given) in read.iter().flatten().zip(given.iter().flatten()) {
            if given.abs() <= 1e-6 * largest {
                assert_eq!(*read, 0.0);
                kept[0] += 1;
            } else {
                let error = (read / given - 1.0).abs();
                assert!(error < 2.2e-4, "{read:e} of {given:e}");
                kept[if *given < 0.0 { 1 } else { 2 }] += 1;
            }
        }
        assert!(kept[0] > 100 && kept[2] > 100, "{kept:?}");
        assert_eq!(kept[1] > 100, has_negative, "{kept:?}");
    }
}

#[test]
fn what_is_stored_as_doubles_comes_back_to_the_bit() {
    let replay = every_body(12);
    let data = document(&replay.to_html().unwrap());
    assert_eq!(doubles(&data["times"]), replay.times);
    assert_eq!(doubles(&data["rest"]), replay.rest);
    assert_eq!(indices(&data["faces"]), replay.faces.as_flattened());
    for (series, given) in data["series"]
        .as_array()
        .unwrap()
        .iter()
        .zip(&replay.series)
    {
        assert_eq!(doubles(&series["times"]), given.times);
        assert_eq!(doubles(&series["values"]), given.values);
    }
    for (body, given) in data["bodies"]
        .as_array()
        .unwrap()
        .iter()
        .zip(&replay.bodies)
    {
        let numbers = given
            .poses
            .iter()
            .flat_map(|p| p.rotation.into_iter().chain(p.translation));
        assert_eq!(doubles(&body["poses"]), numbers.collect::<Vec<_>>());
    }
    assert_eq!(data["title"], replay.title.as_str());
    assert_eq!(data["scene"], replay.scene.as_str());
}

#[test]
fn no_text_ends_an_element_of_the_page() {
    let page = waving(1, 3).to_html().unwrap();
    assert_eq!(page.matches("</script").count(), 3);
    assert_eq!(page.matches("</title").count(), 1);
    assert_eq!(
        page.matches("<title>A waving sheet &lt;/title&gt;&lt;/script&gt; &amp; more</title>")
            .count(),
        1
    );
}

#[test]
fn the_page_asks_for_nothing_from_elsewhere() {
    let page = waving(1, 3).to_html().unwrap();
    let data = document(&page).to_string();
    let shell = page.replace(&data, "");
    for attribute in ["src=\"", "href=\"http", "@import", "url(http"] {
        assert!(!shell.contains(attribute), "{attribute}");
    }
}

#[test]
fn the_licences_of_the_libraries_are_in_the_page() {
    let page = waving(1, 3).to_html().unwrap();
    for holder in ["three.js authors", "Leon Sorokin"] {
        assert!(page.contains(holder), "{holder}");
    }
    assert_eq!(
        page.matches("Permission is hereby granted, free of charge")
            .count(),
        2
    );
}

#[test]
fn equal_replays_make_equal_pages() {
    assert_eq!(waving(2, 20).to_html(), waving(2, 20).to_html());
}

#[test]
fn sizes_are_those_that_the_documentation_states() {
    let page = waving(3, 600).to_html().unwrap();
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    assert!(frame_size(&page) < 300_000, "{} bytes", frame_size(&page));
    assert_eq!(frames(&document(&page)), 600);
}

#[test]
fn above_the_budget_every_second_frame_is_kept_and_the_last_one() {
    let replay = waving(3, 60);
    let whole = replay.to_html().unwrap();
    let budget = whole.len() - 1000;
    let page = replay.to_html_with(&PageOptions { budget }).unwrap();
    let data = document(&page);
    assert!(page.len() <= budget);
    assert_eq!(
        (data["stride"].as_u64(), data["frames_of_run"].as_u64()),
        (Some(2), Some(60))
    );
    let times = doubles(&data["times"]);
    let mut expected: Vec<f64> = replay.times.iter().copied().step_by(2).collect();
    expected.push(replay.times[59]);
    assert_eq!(times, expected);
    let last = positions(&data).pop().unwrap();
    let step = data["step"].as_f64().unwrap();
    assert!(largest_difference(&[last], &replay.positions[59..]) <= step / 2.0 * (1.0 + 1e-9));
    assert_eq!(field(&data, 0).len(), expected.len());
    // The box of the frames that are left is not larger than that of the run.
    assert!(step <= longest_side(&replay) / 65535.0 * (1.0 + 1e-12));
}

#[test]
fn budgets_that_cannot_be_met_are_errors() {
    let replay = waving(3, 9);
    let shell = frame_size(&replay.to_html().unwrap());
    let result = replay.to_html_with(&PageOptions {
        budget: shell + 1000,
    });
    let error = result.unwrap_err().to_string();
    assert!(error.contains("bytes with 2 frames left"), "{error}");
    let result = replay.to_html_with(&PageOptions { budget: 1000 });
    let error = result.unwrap_err().to_string();
    assert!(error.starts_with("the budget is 1000 bytes"), "{error}");
}

#[test]
fn a_sheet_that_does_not_move_and_constant_fields_are_kept() {
    let mut replay = waving(1, 3);
    replay.positions = vec![vec![7.5; replay.rest.len()]; 3];
    let count = replay.faces.len();
    for (scale, value) in [
        (Scale::Linear, -2.5),
        (Scale::Logarithmic, 1e-12),
        (Scale::Logarithmic, 0.0),
    ] {
        replay.fields = vec![Field {
            name: "constant".into(),
            unit: String::new(),
            place: Centering::Face,
            scale,
            note: String::new(),
            values: vec![vec![value; count]; 3],
        }];
        let data = document(&replay.to_html().unwrap());
        assert_eq!(positions(&data), replay.positions);
        let read = field(&data, 0)[2][0];
        assert!(
            (read - value).abs() <= 1e-12 * value.abs(),
            "{read:e} of {value:e}"
        );
    }
}

#[test]
fn edge_strain_is_the_relative_change_of_length() {
    let sheet = generate::isotropic_square(1, 2.0).unwrap();
    let faces = sheet.face_indices();
    // Stretched along x by a thousandth: an edge with the angle a to x by cos^2 a thousandth, to first order.
    let mut x = sheet.positions().to_vec();
    for p in x.chunks_exact_mut(3) {
        p[0] *= 1.001;
    }
    let strain = Field::edge_strain(&faces, sheet.positions(), &[x]).unwrap();
    let topology = Topology::from_faces(sheet.positions().len() / 3, &faces).unwrap();
    for (e, ends) in topology.edges().iter().enumerate() {
        let [a, b] = ends.map(|v| sheet.position(v));
        let cosine = (a[0] - b[0]).abs() / sheet.lengths()[e];
        let expected = (1.0 + cosine * cosine * (1.001_f64.powi(2) - 1.0)).sqrt() - 1.0;
        assert!((strain.values[0][e] - expected).abs() < 1e-14);
    }
}

#[test]
fn the_decoder_of_the_tests_undoes_known_differences() {
    // Second differences of 0, 1, 4, 9 are 0, 1, 2, 2, in zigzag form 0, 2, 4, 4; low bytes before high
    // bytes.
    let planes = [0, 2, 4, 4, 0, 0, 0, 0];
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, &planes).unwrap();
    let data = base64::Engine::encode(
        &base64::engine::general_purpose::STANDARD,
        encoder.finish().unwrap(),
    );
    let packed: Value = serde_json::json!({ "bytes": 2, "order": 2, "data": data });
    assert_eq!(decoder::rows(&packed, 4), [[0], [1], [4], [9]]);
}
