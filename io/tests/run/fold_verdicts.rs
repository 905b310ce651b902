//! What `isosheet fold` says of a folding: vertices that do not fold flat, lines that agree, sizes.

use crate::fold::{VERTEX, folded};
use crate::{code, run, stderr};
use isosheet_files::read_json;
use isosheet_mesh::FlatFoldingLaw;
use isosheet_runs::{FoldVerdict, Recording, Summary};
use std::fs;

/// A vertex of four creases for which Kawasaki's and Maekawa's theorems hold, with its smallest angle between
/// two mountains: it closes as panels pass through each other alone.
const BIG_LITTLE_BIG: &str = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100' \
    fill='none'><rect width='100' height='100' stroke='#000'/><path stroke='#f00' d='M50 50 H100 M50 50 L100 8.045 \
    M50 50 L8.045 0'/><path stroke='#00f' d='M50 50 V100'/></svg>";

#[test]
fn a_vertex_without_an_order_of_layers_is_told() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("blb.svg"), BIG_LITTLE_BIG).unwrap();
    for contact in [&[][..], &["--contact"]] {
        let words = [&["blb.svg", "--out", "out", "--force"], contact].concat();
        let (said, _, verdict) = folded(dir.path(), &words);
        let FlatFoldingLaw::Layers { angle, count, .. } = verdict.unfoldable[0].violates else {
            panic!("{:?}", verdict.unfoldable)
        };
        assert!((angle - 40.0).abs() < 0.01 && count == 1, "{angle}");
        assert!(
            said.contains("The vertex ") && said.contains("(big-little-big)"),
            "{said}"
        );
        assert!(!said.contains("in each other's way"), "{said}");
        assert!(
            !said.contains("every crease ends within 5 degrees of its angle, 0"),
            "{said}"
        );
    }
    // With its other small angle's mountain a valley it folds flat.
    let right = BIG_LITTLE_BIG
        .replace("M50 50 H100 ", "")
        .replace("d='M50 50 V100'", "d='M50 50 H100'");
    let right = right.replace("</svg>", "<path stroke='#f00' d='M50 50 V100'/></svg>");
    fs::write(dir.path().join("blb.svg"), right).unwrap();
    let (said, _, verdict) = folded(dir.path(), &["blb.svg", "--out", "out", "--force"]);
    assert_eq!((verdict.unfoldable.len(), verdict.open), (0, 0), "{said}");
    assert!(
        said.contains("folded: every crease ends within 5 degrees of its angle, 0"),
        "{said}"
    );
}

/// The last line has three sentences at most, and its numbers agree with the other lines.
#[test]
fn the_lines_of_a_folding_agree() {
    let dir = tempfile::tempdir().unwrap();
    let blocked =
        "1 0 0 2 0\n1 2 0 2 2\n1 2 2 0 2\n1 0 2 0 0\n3 0 0 2 2\n2 2 0 0 2\n2 1 0 1 2\n3 0 1 2 1\n";
    fs::write(dir.path().join("blocked.cp"), blocked).unwrap();
    fs::write(dir.path().join("blb.svg"), BIG_LITTLE_BIG).unwrap();
    fs::write(dir.path().join("vertex.fold"), VERTEX).unwrap();
    for words in [
        &["blocked.cp", "--out", "out", "--force"][..],
        &["blocked.cp", "--out", "out", "--force", "--contact"],
        &["blb.svg", "--out", "out", "--force", "--contact"],
        &[
            "vertex.fold",
            "--out",
            "out",
            "--force",
            "--order",
            "0; 1 2 3",
        ],
    ] {
        let (said, summary, verdict) = folded(dir.path(), words);
        let last = said.lines().last().unwrap();
        assert!(
            last.starts_with("folded: ") && last.split(". ").count() <= 3,
            "{said}"
        );
        let residual = summary.ending.residuals.folding.unwrap();
        assert!(
            (residual.rms - verdict.residual.rms).abs() < 1e-6,
            "{residual:?} {verdict:?}"
        );
        let rms = format!("{:.1} degrees rms", residual.rms);
        assert!(last.contains(&rms), "{rms}: {said}");
        let of_run = format!(
            "by {:.2} degrees at most and {:.2} rms",
            residual.largest, residual.rms
        );
        assert!(said.contains(&of_run), "{of_run}: {said}");
        // Panels have turned through each other where a crease is folded by more than 180 degrees alone.
        let through = verdict
            .furthest
            .is_some_and(|crease| crease.angle.abs() > 180.0 + FoldVerdict::OPEN);
        assert_eq!(
            said.contains("turned through"),
            verdict.open > 0 && through,
            "{said}"
        );
    }
}

/// Rigid panels fold this vertex flat with two creases to their wrong sides: these are 360 degrees from their
/// angles, not 0, in the summary as in the verdict.
#[test]
fn the_summary_follows_creases_as_the_verdict_does() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("blb.svg"), BIG_LITTLE_BIG).unwrap();
    let scene = "version = 1\n[sheet]\nmesh = { file = { path = \"blb.svg\", polygons = \"triangulate\" } }\n\
                 material = \"office paper\"\nisometry = \"rods\"\nbending = \"none\"\ndamping = 20.0\n\
                 [folding]\ntime = 1.0\nstiffness = 0.1\n[stop]\ntime = 2.0\n";
    fs::write(dir.path().join("scene.toml"), scene).unwrap();
    let output = run(dir.path(), &["simulate", "scene.toml", "-o", "out"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let out = dir.path().join("out");
    let summary: Summary = read_json(&out.join("summary.json")).unwrap();
    let residual = summary.ending.residuals.folding.unwrap();
    assert!((residual.largest - 360.0).abs() < 0.1, "{residual:?}");
    assert_eq!(residual.wrong_side, 2);
    // Two of four creases: 360 / 2^1/2.
    assert!(
        (residual.rms - 360.0 / 2.0_f64.sqrt()).abs() < 0.1,
        "{residual:?}"
    );
    let verdict = FoldVerdict::of(&Recording::read(&out).unwrap()).unwrap();
    assert!(
        (residual.rms - verdict.residual.rms).abs() < 1e-9,
        "{verdict:?}"
    );
    // They lie on each other on the other side, and have not turned through each other.
    let words = verdict.in_words(None).concat();
    assert!(words.contains("2 creases stay open"), "{words}");
    assert!(!words.contains("turned through"), "{words}");
}

/// A sheet has the size that its file says, and 0.2 m where it says none.
#[test]
fn the_size_of_a_file_with_a_unit_is_kept() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path();
    fs::write(path.join("blb.svg"), BIG_LITTLE_BIG).unwrap();
    let in_metres = VERTEX.replace(
        "\"vertices_coords\"",
        "\"frame_unit\": \"cm\", \"vertices_coords\"",
    );
    fs::write(path.join("cm.fold"), in_metres).unwrap();
    fs::write(path.join("vertex.fold"), VERTEX).unwrap();
    let made = run(
        path,
        &["mesh", "blb.svg", "-o", "made.fold", "--spacing", "50mm"],
    );
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    for (name, expected) in [
        ("blb.svg", 0.1),
        ("made.fold", 0.1),
        ("cm.fold", 0.1866),
        ("vertex.fold", 0.2),
    ] {
        let output = run(
            path,
            &["fold", name, "--out", "out", "--force", "--part", "0.1"],
        );
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        let recording = Recording::read(&path.join("out")).unwrap();
        let places = recording.sheet.positions().as_chunks::<3>().0;
        let side = |k: usize| {
            let along = || places.iter().map(|p| p[k]);
            along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
        };
        let longest = side(0).max(side(1));
        assert!((longest - expected).abs() < 1e-4, "{name}: {longest}");
        let is_told = stderr(&output).contains("the file has no unit of length");
        assert_eq!(is_told, name == "vertex.fold", "{}", stderr(&output));
    }
}
