//! Folding to the angles of FOLD files.

use isosheet_mesh::generate::{FoldAssignment, FoldPattern, miura, miura_zigzags};
use isosheet_mesh::{VertexId, fold_angle, origami};
use isosheet_scenes::{FoldResidual, SceneFile, Setup};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const MIURA: origami::Miura = origami::Miura {
    straight: 0.05,
    zigzag: 0.05,
    angle: 1.0,
};

fn pattern() -> FoldPattern {
    miura(4, 4, MIURA.straight, MIURA.zigzag, MIURA.angle).unwrap()
}

/// A FOLD file of the pattern with the angles (degrees) of mountains and valleys that are given.
fn fold_file(pattern: &FoldPattern, angle: impl Fn(usize) -> f64) -> Value {
    let t = pattern.sheet.topology();
    let letter = |a: &FoldAssignment| match a {
        FoldAssignment::Boundary => "B",
        FoldAssignment::Mountain => "M",
        FoldAssignment::Valley => "V",
        FoldAssignment::Flat => "F",
    };
    let letters: Vec<&str> = pattern.assignments.iter().map(letter).collect();
    let angles: Vec<f64> = (0..letters.len())
        .map(|e| match letters[e] {
            "M" | "V" => angle(e),
            _ => 0.0,
        })
        .collect();
    let ends: Vec<[u32; 2]> = t.edges().iter().map(|e| e.map(|v| v.0)).collect();
    json!({
        "file_spec": 1.2, "frame_unit": "m", "frame_classes": ["creasePattern"],
        "vertices_coords": pattern.sheet.positions().as_chunks::<3>().0,
        "edges_vertices": ends, "edges_assignment": letters, "edges_foldAngle": angles,
        "faces_vertices": pattern.sheet.face_indices(),
    })
}

/// Fold angles of the rigid Miura sheet, degrees.
fn exact_angle(pattern: &FoldPattern, theta: f64, e: usize) -> f64 {
    let t = pattern.sheet.topology();
    let x = MIURA.positions(4, 4, theta);
    let edge = t.edge_ids().nth(e).unwrap();
    fold_angle(t, &x, edge).unwrap().to_degrees()
}

/// Writes the file, folds it with the keys of `[folding]`, and gives what is left.
fn folded(folder: &Path, fold: &Value, keys: &str) -> FoldResidual {
    folded_of(folder, fold, "", keys)
}

/// As [`folded`], with more keys of the sheet.
fn folded_of(folder: &Path, fold: &Value, of_sheet: &str, keys: &str) -> FoldResidual {
    folded_in_steps(folder, fold, of_sheet, keys, 1.0 / 60.0)
}

/// As [`folded_of`], in steps of other lengths, seconds.
fn folded_in_steps(
    folder: &Path,
    fold: &Value,
    of_sheet: &str,
    keys: &str,
    step: f64,
) -> FoldResidual {
    fs::write(folder.join("sheet.fold"), fold.to_string()).unwrap();
    let text = format!(
        "version = 1
        [sheet]
        mesh = {{ file = {{ path = \"sheet.fold\" }} }}
        density = 0.1
        damping = 5.0
        {of_sheet}
        [folding]
        time = 1.0
        stiffness = 0.01
        {keys}"
    );
    let scene = SceneFile::parse(text, &folder.join("scene.toml"), &[]).unwrap();
    let setup = scene.build().unwrap_or_else(|e| panic!("{e}"));
    let targets = setup.targets.folding.clone().unwrap();
    let mut simulation = setup.start().unwrap();
    for _ in 0..(3.0 / step).round() as usize {
        simulation.step(step).unwrap();
    }
    targets.residual(simulation.model().topology(), &simulation.state().x)
}

fn refused(folder: &Path, fold: &Value, keys: &str) -> String {
    fs::write(folder.join("sheet.fold"), fold.to_string()).unwrap();
    let text = format!(
        "version = 1
        [sheet]
        mesh = {{ file = {{ path = \"sheet.fold\" }} }}
        [folding]
        time = 1.0
        stiffness = 0.01
        {keys}"
    );
    let scene = SceneFile::parse(text, &folder.join("scene.toml"), &[]);
    match scene {
        Err(e) => e.to_string(),
        Ok(scene) => scene.build().unwrap_err().to_string(),
    }
}

/// Angles of a rigid folding are reached; so are half of them only as far as rigid panels allow.
#[test]
fn angles_that_close_are_reached() {
    let dir = tempfile::tempdir().unwrap();
    let pattern = pattern();
    let fold = fold_file(&pattern, |e| exact_angle(&pattern, 0.8, e));
    let residual = folded(dir.path(), &fold, "");
    assert_eq!(residual.creases, 24);
    // 1e-3 degrees are some 1e-5 rad; the sheet has come to rest up to exp(-5 * 2).
    assert!(
        residual.largest < 1e-3 && residual.rms <= residual.largest,
        "{residual:?}"
    );
    assert!(residual.largest_flat < 1e-3, "{residual:?}");
}

/// From flat the branch is that of the angles, whatever the step.
#[test]
fn folding_does_not_depend_on_the_step() {
    let dir = tempfile::tempdir().unwrap();
    let pattern = pattern();
    let fold = fold_file(&pattern, |e| exact_angle(&pattern, 0.8, e));
    for step in [0.05, 1.0 / 60.0, 0.002, 5e-4] {
        let residual = folded_in_steps(dir.path(), &fold, "", "", step);
        assert!(
            residual.largest < 1e-3 && residual.wrong_side == 0,
            "{step}: {residual:?}"
        );
    }
}

/// A mesh that is refined folds as it does without, and its creases have as many parts as it says.
#[test]
fn refined_panels_fold_as_whole_ones() {
    let dir = tempfile::tempdir().unwrap();
    let pattern = pattern();
    let fold = fold_file(&pattern, |e| exact_angle(&pattern, 0.8, e));
    let residual = folded_of(dir.path(), &fold, "refine = 1", "");
    assert_eq!(residual.creases, 48);
    assert!(residual.largest < 1e-3, "{residual:?}");
    assert!(residual.largest_flat < 1e-3, "{residual:?}");
}

/// Angles that no rigid panels have are approached the better the more easily panels bend; stiff panels of an
/// elastic sheet fold as far as panels of rods.
#[test]
fn panels_of_an_elastic_sheet_bend() {
    let dir = tempfile::tempdir().unwrap();
    let pattern = pattern();
    // All creases of the same size: the rigid Miura sheet has two different ones.
    let fold = fold_file(&pattern, |e| {
        60.0_f64.copysign(exact_angle(&pattern, 0.5, e))
    });
    let residual = |rigidity: f64| {
        let of = format!(
            "refine = 1
            isometry = {{ elastic = {{ stiffness = 3e5 }} }}
            bending = {{ plate = {{ rigidity = {rigidity} }} }}"
        );
        folded_of(dir.path(), &fold, &of, "")
    };
    let (stiff, medium, soft) = (residual(1e-1), residual(1e-3), residual(1e-4));
    assert!(
        soft.rms < 0.98 * medium.rms && medium.rms < 0.98 * stiff.rms,
        "{stiff:?}, {medium:?}, {soft:?}"
    );
    assert!(
        stiff.largest_flat < 1.0 && soft.largest_flat > 5.0,
        "{stiff:?}, {soft:?}"
    );
    let rods = folded(dir.path(), &fold, "");
    assert!(
        (rods.rms / stiff.rms - 1.0).abs() < 0.01,
        "{rods:?}, {stiff:?}"
    );
}

/// Angles that do not close end at the minimum of the energy of the creases over the rigid foldings, which
/// a search along the one degree of freedom finds as well.
#[test]
fn angles_that_do_not_close_are_approached() {
    let dir = tempfile::tempdir().unwrap();
    let pattern = pattern();
    let t = pattern.sheet.topology();
    let creases: Vec<usize> = (0..t.edge_count())
        .filter(|&e| {
            let a = pattern.assignments[e];
            a == FoldAssignment::Mountain || a == FoldAssignment::Valley
        })
        .collect();
    let target = |e: usize| 90.0_f64.copysign(exact_angle(&pattern, 0.5, e));
    let differences = |theta: f64| -> Vec<(f64, f64)> {
        let of = |&e: &usize| {
            let d = exact_angle(&pattern, theta, e) - target(e);
            (pattern.sheet.lengths()[e], d.abs())
        };
        creases.iter().map(of).collect()
    };
    let energy = |theta: f64| {
        differences(theta)
            .iter()
            .map(|(l, d)| l * d * d)
            .sum::<f64>()
    };
    let best = (1..1500).map(|k| 1e-3 * f64::from(k));
    let best = best
        .min_by(|a, b| energy(*a).total_cmp(&energy(*b)))
        .unwrap();
    let expected = differences(best);
    let largest = expected.iter().map(|d| d.1).fold(0.0, f64::max);
    let rms = (expected.iter().map(|d| d.1 * d.1).sum::<f64>() / creases.len() as f64).sqrt();
    assert!(rms > 5.0, "the angles do not close: {rms}");

    let fold = fold_file(&pattern, target);
    let residual = folded(dir.path(), &fold, "flat_stiffness = 100.0");
    // The search is by 1e-3 rad, which is 0.06 degrees; zigzags turn by twice as much.
    assert!(
        (residual.largest - largest).abs() < 0.12,
        "{residual:?}, {largest}"
    );
    assert!((residual.rms - rms).abs() < 0.12, "{residual:?}, {rms}");
    let zigzag = miura_zigzags(&pattern)[0].index();
    assert!(creases.contains(&zigzag));
}

/// The shape of another frame is a target as its angles are.
#[test]
fn a_frame_in_space_is_a_target() {
    let dir = tempfile::tempdir().unwrap();
    let pattern = pattern();
    let mut fold = fold_file(&pattern, |_| 0.0);
    let x = MIURA.positions(4, 4, 0.6);
    fold["file_frames"] = json!([{
        "frame_inherit": true, "frame_parent": 0, "frame_classes": ["foldedForm"],
        "vertices_coords": x.as_chunks::<3>().0,
    }]);
    let residual = folded(dir.path(), &fold, "frame = 1");
    assert!(residual.largest < 1e-3, "{residual:?}");
    assert_eq!(residual.creases, 24);
}

/// A sheet that starts folded stays at rest if its angles are the targets, and goes smoothly from there to
/// others.
#[test]
fn springs_begin_at_the_angles_of_the_start() {
    let dir = tempfile::tempdir().unwrap();
    let pattern = pattern();
    let shape = |theta: f64| {
        json!({
            "frame_inherit": true, "frame_parent": 0, "frame_classes": ["foldedForm"],
            "vertices_coords": MIURA.positions(4, 4, theta).as_chunks::<3>().0,
        })
    };
    let mut fold = fold_file(&pattern, |_| 0.0);
    fold["file_frames"] = json!([shape(0.6), shape(0.9)]);
    fs::write(dir.path().join("sheet.fold"), fold.to_string()).unwrap();
    let started = |target: &str| {
        let text = format!(
            "version = 1
            [sheet]
            mesh = {{ file = {{ path = \"sheet.fold\" }} }}
            start = {{ file = {{ path = \"sheet.fold\", frame = 1 }} }}
            density = 0.1
            damping = 5.0
            [folding]
            time = 1.0
            stiffness = 0.01
            {target}"
        );
        let scene = SceneFile::parse(text, &dir.path().join("scene.toml"), &[]).unwrap();
        let setup = scene.build().unwrap_or_else(|e| panic!("{e}"));
        (
            setup.targets.folding.clone().unwrap(),
            setup.start().unwrap(),
        )
    };
    let fastest = |v: &[f64]| v.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let (_, mut at_rest) = started("frame = 1");
    assert!(at_rest.energy().abs() < 1e-20, "{}", at_rest.energy());
    for _ in 0..60 {
        at_rest.step(1.0 / 60.0).unwrap();
        let speed = fastest(&at_rest.state().v);
        // Round-off of angles, 1e-15, times 0.01 N on a tenth of a gram for a second.
        assert!(speed < 1e-10, "{speed} m/s");
    }
    let (targets, mut moving) = started("frame = 2");
    let t = moving.model().topology().clone();
    let before = targets.residual(&t, &moving.state().x).largest;
    assert!(before > 10.0, "{before}");
    moving.step(1.0 / 60.0).unwrap();
    // The rest angles have changed by 1e-5 of the way, and nothing has snapped.
    let first = fastest(&moving.state().v);
    assert!(first < 1e-3, "{first} m/s");
    for _ in 1..180 {
        moving.step(1.0 / 60.0).unwrap();
    }
    let after = targets.residual(&t, &moving.state().x).largest;
    assert!(after < 1e-3, "{after}");
}

/// A file with a crease pattern of quads and its folded form. Each quad is a rectangle in the flat and a
/// rectangle in the folded frame, and the faces of the flat frame are clockwise, as some programs write them:
/// what is a mountain as seen from their front is a valley as seen from above.
fn bent_strip() -> Value {
    let (c, s) = (0.5, 0.75_f64.sqrt());
    json!({
        "file_spec": 1.1, "frame_title": "flat", "frame_classes": ["creasePattern"],
        "vertices_coords": [[0, 0], [0.2, 0], [0.4, 0], [0, 0.1], [0.2, 0.1], [0.4, 0.1]],
        "faces_vertices": [[3, 4, 1, 0], [4, 5, 2, 1]],
        "edges_vertices": [[0, 1], [1, 2], [2, 5], [5, 4], [4, 3], [3, 0], [1, 4]],
        "edges_assignment": ["B", "B", "B", "B", "B", "B", "M"],
        "edges_foldAngle": [0, 0, 0, 0, 0, 0, -30],
        "file_frames": [{
            "frame_title": "folded", "frame_classes": ["foldedForm"],
            "frame_inherit": true, "frame_parent": 0,
            "vertices_coords": [
                [0, 0, 0], [0.2, 0, 0], [0.2 + 0.2 * c, 0, 0.2 * s],
                [0, 0.1, 0], [0.2, 0.1, 0], [0.2 + 0.2 * c, 0.1, 0.2 * s],
            ],
        }],
    })
}

fn of_frames(folder: &Path, mesh: &str, start: &str, more: &str) -> Result<SceneFile, String> {
    fs::write(folder.join("strip.fold"), bent_strip().to_string()).unwrap();
    let file = "path = \"strip.fold\", polygons = \"triangulate\"";
    let text = format!(
        "version = 1
        [sheet]
        mesh = {{ file = {{ {file} {mesh} }} }}
        start = {{ file = {{ {file} {start} }} }}
        {more}"
    );
    SceneFile::parse(text, &folder.join("scene.toml"), &[]).map_err(|e| e.to_string())
}

/// One file has the rest shape in a frame and the start in another one, by number or by title.
#[test]
fn rest_shape_and_start_are_frames_of_one_file() {
    let dir = tempfile::tempdir().unwrap();
    let crease = |x: &[f64], t: &isosheet_mesh::Topology| {
        let e = t.find_edge(VertexId(1), VertexId(4)).unwrap();
        fold_angle(t, x, e).unwrap().to_degrees()
    };
    for (mesh, start) in [
        ("", ", frame = 1"),
        (", frame = 0", ", frame = \"folded\""),
        (", frame = \"flat\"", ", frame = \"folded\""),
    ] {
        let scene = of_frames(dir.path(), mesh, start, "").unwrap();
        let setup = scene.build().unwrap_or_else(|e| panic!("{e}"));
        let t = setup.sheet.topology();
        assert_eq!(crease(setup.sheet.positions(), t), 0.0);
        let angle = crease(&setup.start.x, t);
        assert!((angle - 60.0).abs() < 1e-9, "{angle}");
        setup.start().unwrap();
    }
    // The other way round: a sheet that is at rest in the folded form.
    let scene = of_frames(dir.path(), ", frame = 1", ", frame = 0", "").unwrap();
    let setup = scene.build().unwrap();
    let t = setup.sheet.topology();
    assert!((crease(setup.sheet.positions(), t).abs() - 60.0).abs() < 1e-9);
    assert_eq!(crease(&setup.start.x, t), 0.0);
}

/// A folded form in a file of six digits has the rest lengths up to rounding, and gets them; other lengths
/// are refused.
#[test]
fn rounded_starts_are_corrected_and_stretched_ones_refused() {
    let dir = tempfile::tempdir().unwrap();
    let scene = of_frames(dir.path(), "", ", frame = 1", "").unwrap();
    let built = |digits: f64| {
        let mut fold = bent_strip();
        let points = fold["file_frames"][0]["vertices_coords"].as_array_mut();
        for c in points
            .unwrap()
            .iter_mut()
            .flat_map(|p| p.as_array_mut().unwrap())
        {
            *c = json!((c.as_f64().unwrap() * digits).round() / digits);
        }
        fs::write(dir.path().join("strip.fold"), fold.to_string()).unwrap();
        scene.build().unwrap()
    };
    let strain = |setup: &Setup| {
        let (t, x) = (setup.sheet.topology(), &setup.start.x);
        let length = |[a, b]: [VertexId; 2]| {
            let d = |k: usize| x[3 * a.index() + k] - x[3 * b.index() + k];
            (d(0) * d(0) + d(1) * d(1) + d(2) * d(2)).sqrt()
        };
        let errors = t.edges().iter().zip(setup.sheet.lengths());
        errors
            .map(|(&e, l)| (length(e) / l - 1.0).abs())
            .fold(0.0, f64::max)
    };
    let setup = built(1e6);
    assert!(strain(&setup) < 1e-12, "{}", strain(&setup));
    // Vertices move by as much as they were rounded, about.
    let exact = 0.2 * 0.75_f64.sqrt();
    assert!((setup.start.x[3 * 2 + 2] - exact).abs() < 2e-6);
    setup.start().unwrap();
    let setup = built(1e2);
    assert!(strain(&setup) > 1e-3);
    let said = setup.start().err().unwrap().to_string();
    assert!(said.contains(" m too "), "{said}");
}

/// Without a frame of its own, folding takes the angles of the frame that is the mesh.
#[test]
fn folding_takes_the_frame_of_the_mesh() {
    let dir = tempfile::tempdir().unwrap();
    let folding = "[folding]\ntime = 1.0\nstiffness = 0.01\n";
    let angle = |mesh: &str, frame: &str| {
        let scene = of_frames(
            dir.path(),
            mesh,
            ", frame = 1",
            &format!("{folding}{frame}"),
        );
        let setup = scene.unwrap().build().unwrap_or_else(|e| panic!("{e}"));
        let targets = setup.targets.folding.clone().unwrap().creases;
        assert_eq!(targets.len(), 1);
        targets[0].1.to_degrees()
    };
    for (mesh, frame, expected) in [
        ("", "", 30.0),
        ("", "frame = \"flat\"", 30.0),
        ("", "frame = \"folded\"", 60.0),
        (", frame = \"flat\"", "", 30.0),
    ] {
        let angle = angle(mesh, frame);
        assert!((angle - expected).abs() < 1e-9, "{mesh} {frame}: {angle}");
    }
}

#[test]
fn frames_that_do_not_exist_are_answered_with_those_that_do() {
    let dir = tempfile::tempdir().unwrap();
    let frames = "the frames of the file are 0 \"flat\" (creasePattern), 1 \"folded\" (foldedForm)";
    let said = |mesh: &str, start: &str, more: &str| {
        let scene = of_frames(dir.path(), mesh, start, more);
        match scene.map(|scene| scene.build()) {
            Err(said) => (said, String::new()),
            Ok(Err(error)) => (error.to_string(), error.placed()[0].key.to_string()),
            Ok(Ok(_)) => panic!("{mesh} {start} {more} is accepted"),
        }
    };
    let folding = "[folding]\ntime = 1.0\nstiffness = 0.01\nframe = \"shut\"";
    for ((said, place), key, wanted) in [
        (
            said(", frame = 2", "", ""),
            "sheet.mesh.file.frame",
            "no frame 2",
        ),
        (
            said("", ", frame = \"Folded\"", ""),
            "sheet.start.file.frame",
            "no frame \"Folded\"",
        ),
        (said("", "", folding), "folding.frame", "no frame \"shut\""),
    ] {
        assert_eq!(place, key);
        assert!(said.contains(wanted) && said.contains(frames), "{said}");
    }
    for wrong in [", frame = -1", ", frame = true", ", frame = 0.5"] {
        let (said, _) = said(wrong, "", "");
        assert!(
            said.contains("the number of a frame of a FOLD file, from 0, or its title"),
            "{said}"
        );
    }
    let text = "version = 1\n[sheet]\nmesh = { file = { path = \"a.obj\", frame = 0 } }";
    fs::write(
        dir.path().join("a.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    )
    .unwrap();
    let scene = SceneFile::parse(text.into(), &dir.path().join("scene.toml"), &[]).unwrap();
    let error = scene.build().unwrap_err();
    assert_eq!(error.placed()[0].key, "sheet.mesh.file.frame");
    assert!(
        error.to_string().contains("only FOLD files have frames"),
        "{error}"
    );
}

#[test]
fn what_cannot_be_folded_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let pattern = pattern();
    let is_mountain = |e: usize| pattern.assignments[e] == FoldAssignment::Mountain;
    let mut fold = fold_file(&pattern, |e| if is_mountain(e) { -30.0 } else { 30.0 });
    let said = refused(dir.path(), &fold, "frame = 7");
    assert!(said.contains("no frame 7"), "{said}");
    let said = refused(dir.path(), &fold, "part = 1.5");
    assert!(said.contains("`folding.part` is 1.5"), "{said}");
    // Without angles mountains and valleys are folded by 180 degrees; without these nothing is.
    for key in ["edges_foldAngle", "edges_assignment"] {
        fold.as_object_mut().unwrap().remove(key);
    }
    let said = refused(dir.path(), &fold, "");
    assert!(said.contains("no crease"), "{said}");
    let text = "version = 1
        [sheet]
        mesh = { square = { side = 0.2, level = 1 } }
        [folding]
        time = 1.0
        stiffness = 0.01";
    let said = crate::parse(text).unwrap_err().to_string();
    assert!(said.contains("`sheet.mesh` is no file"), "{said}");
    let text = "version = 1
        [[sheet]]
        name = \"a\"
        mesh = { square = { side = 0.2, level = 1 } }
        [[sheet]]
        name = \"b\"
        mesh = { square = { side = 0.2, level = 1 } }
        [folding]
        time = 1.0
        stiffness = 0.01";
    let said = crate::parse(text).unwrap_err().to_string();
    assert!(
        said.contains("the creases may be of several sheets"),
        "{said}"
    );
}

/// The corner of a square that folds along its diagonal goes to the side that a valley leads to: that from
/// which the faces are counter-clockwise. The same drawing with clockwise faces folds into the mirror image.
#[test]
fn clockwise_faces_fold_to_the_other_side() {
    let dir = tempfile::tempdir().unwrap();
    let corner = |name: &str, faces: Value, second: Value| {
        let fold = json!({
            "file_spec": 1.2, "frame_unit": "m", "frame_classes": ["creasePattern"],
            "vertices_coords": [[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1]],
            "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]],
            "edges_assignment": ["B", "B", "B", "B", "V"],
            "edges_foldAngle": [0, 0, 0, 0, 90],
            "faces_vertices": faces,
            "file_frames": [second],
        });
        fs::write(dir.path().join(name), fold.to_string()).unwrap();
        let heights = [None, Some(1)].map(|frame| {
            let frame = frame.map_or(String::new(), |k| format!("frame = {k}"));
            let text = format!(
                "version = 1
                [sheet]
                mesh = {{ file = {{ path = \"{name}\" }} }}
                density = 0.1
                damping = 5.0
                [[support]]
                at = {{ vertices = [0, 1, 2] }}
                hold = \"pin\"
                [folding]
                time = 0.5
                stiffness = 0.01
                {frame}"
            );
            let scene = SceneFile::parse(text, &dir.path().join("scene.toml"), &[]).unwrap();
            let setup = scene.build().unwrap_or_else(|e| panic!("{e}"));
            let warnings: Vec<String> = setup.warnings().iter().map(ToString::to_string).collect();
            let mut simulation = setup.start().unwrap();
            for _ in 0..120 {
                simulation.step(1.0 / 60.0).unwrap();
            }
            (simulation.state().x[11], warnings)
        });
        let [(first, warnings), (second, _)] = heights;
        (first, second, warnings)
    };
    // A folded form that lies flat and says the same of the same faces.
    let folded = json!({
        "frame_inherit": true, "frame_classes": ["foldedForm"],
        "vertices_coords": [[0, 0], [0.1, 0], [0.1, 0.1], [0.1, 0]],
    });
    let height = 0.1 / 2_f64.sqrt();
    let (up, folded_up, warnings) =
        corner("up.fold", json!([[0, 1, 2], [0, 2, 3]]), folded.clone());
    assert!(
        (up - height).abs() < 1e-5 && (folded_up - height).abs() < 1e-5,
        "{up} {folded_up}"
    );
    assert!(warnings.is_empty(), "{warnings:?}");
    let (down, folded_down, warnings) = corner("down.fold", json!([[2, 1, 0], [3, 2, 0]]), folded);
    assert!(
        (down + height).abs() < 1e-5 && (folded_down + height).abs() < 1e-5,
        "{down} {folded_down}"
    );
    assert_eq!(
        warnings,
        [
            "2 faces of down.fold are clockwise: they were reversed, with the mountains and valleys at them"
        ]
    );
}

/// A drawing has mountains and valleys, too: a square that is folded along its diagonal by 90 degrees.
#[test]
fn a_drawing_is_folded() {
    let folder = tempfile::tempdir().unwrap();
    let drawing = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100' fill='none'>\
                   <rect width='100' height='100' stroke='black'/><path d='M0 0 L100 100' stroke='blue'/></svg>";
    fs::write(folder.path().join("a.svg"), drawing).unwrap();
    let scene = |more: &str| {
        format!(
            "version = 1\n[sheet]\nmesh = {{ drawing = {{ path = \"a.svg\", spacing = 0.05 }} }}\nmaterial = \"office paper\"\n\
             damping = 10\n[folding]\ntime = 1\nstiffness = 0.05\npart = 0.5\n{more}[method]\nstep = 0.03\n[stop]\ntime = 2\n"
        )
    };
    let parse = |text: String| SceneFile::parse(text, &folder.path().join("scene.toml"), &[]);
    let setup = parse(scene("")).unwrap().build().unwrap();
    let targets = setup.targets.folding.clone().unwrap();
    assert!(
        targets
            .creases
            .iter()
            .all(|(_, angle)| *angle == std::f64::consts::FRAC_PI_2)
    );
    let mut simulation = setup.start().unwrap();
    simulation.run(2.0, 0.03, &mut []).unwrap();
    let (topology, x) = (simulation.model().topology(), &simulation.state().x);
    let residual = targets.residual(topology, x);
    assert!(residual.largest < 2.0, "{residual:?}");
    let error = parse(scene("frame = 1\n")).unwrap_err().to_string();
    assert!(error.contains("a drawing has none"), "{error}");
}

/// The springs are at a part of the angles that is a function of time; the one that is taken by itself may be
/// written.
#[test]
fn the_course_of_a_folding_is_a_function_of_time() {
    let dir = tempfile::tempdir().unwrap();
    let square = json!({
        "vertices_coords": [[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1]], "faces_vertices": [[0, 1, 2], [0, 2, 3]],
        "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]], "edges_assignment": ["B", "B", "B", "B", "V"],
    });
    let folded = |keys: &str| folded(dir.path(), &square, keys);
    let half = folded("course = { ramp = { to = 0.5, end = 1 } }");
    assert!((half.largest - 90.0).abs() < 0.1, "{half:?}");
    let whole = folded("course = { smooth_step = { to = 1, end = 1 } }");
    assert_eq!(whole, folded(""));
    assert!(whole.largest < 0.1, "{whole:?}");
    let text = "version = 1\n[sheet]\nmesh = { file = { path = \"sheet.fold\" } }\ndensity = 0.1\n[folding]\ntime = 1\n\
                stiffness = 0.01\norder = [\"valleys\"]\ncourse = 0.5\n";
    let refused = SceneFile::parse(text.to_owned(), &dir.path().join("scene.toml"), &[]);
    let said = refused.unwrap_err().to_string();
    assert!(said.contains("leave out `course` or `order`"), "{said}");
}
