//! Formats need the mesh alone.

use std::process::Command;

#[test]
fn the_formats_alone_need_only_the_mesh() {
    let cargo = std::env::var_os("CARGO").expect("cargo runs the tests");
    let tree = Command::new(cargo)
        .args([
            "tree",
            "--offline",
            "--package",
            "isosheet-formats",
            "--edges",
            "normal",
        ])
        .args(["--prefix", "none", "--format", "{p}"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo tree starts");
    let text = String::from_utf8_lossy(&tree.stdout);
    assert!(
        tree.status.success(),
        "{}",
        String::from_utf8_lossy(&tree.stderr)
    );
    let names: Vec<&str> = text.lines().filter_map(|l| l.split(' ').next()).collect();
    assert!(names.contains(&"isosheet-mesh"), "{text}");
    for heavy in [
        "isosheet-coords",
        "isosheet-dynamics",
        "isosheet-collide",
        "toml",
        "schemars",
        "clap",
    ] {
        assert!(!names.contains(&heavy), "{heavy} in {text}");
    }
}
