//! Modules inside a library crate use one another in no circle.
//!
//! The modules are the files that `lib.rs` reaches by `mod`, without those for tests. A file uses another one
//! if it names something that the other file defines: `modules/names.rs` finds the file in which a name is
//! defined, `modules/uses.rs` the paths that name something.

mod names;
mod uses;

use names::Names;
use pathfinding::prelude::strongly_connected_components;
use std::fs;
use std::path::Path;
use uses::Uses;

/// The circles among the files of a crate, each with a line `file -> file: names` for every use in it.
fn circles(root: &Path) -> Vec<String> {
    let uses = Uses::of(&Names::read(root));
    let circles = strongly_connected_components(&uses.files(), |file| uses.by(file));
    let local = |file: &Path| {
        file.strip_prefix(root)
            .unwrap_or(file)
            .display()
            .to_string()
    };
    let circles = circles.iter().map(|files| {
        let lines = uses.among(files).map(|(file, used, names)| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            format!("{} -> {}: {}\n", local(file), local(used), names.join(", "))
        });
        lines.collect::<String>()
    });
    circles.filter(|lines| !lines.is_empty()).collect()
}

#[test]
fn library_crates_have_no_circles_of_modules() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut message = String::new();
    for library in ["mesh", "coords", "dynamics", "collide", "io"] {
        for circle in circles(&tests.with_file_name(library).join("src")) {
            message += &format!("\na circle in {library}/src:\n{circle}");
        }
    }
    assert!(message.is_empty(), "{message}");
}

/// The circles of a crate that has these files.
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    for (path, text) in files {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().expect("the folder of the file")).expect("a folder");
        fs::write(path, text).expect("a file");
    }
    circles(folder.path())
}

const ROOT: (&str, &str) = ("lib.rs", "mod shape; mod solid; pub use shape::Shape;");

/// A module with two children, which defines one name and re-exports another one.
const SHAPE: (&str, &str) = (
    "shape.rs",
    "mod area; mod round; #[cfg(test)] mod tests; pub use round::Disk; pub struct Shape;",
);

#[test]
fn a_circle_over_a_re_export_is_found() {
    let files = [
        ROOT,
        SHAPE,
        ("shape/area.rs", "pub fn area(_: super::Disk) {}"),
        (
            "shape/round.rs",
            "use super::area::{area as a}; pub struct Disk;",
        ),
        ("solid.rs", "use crate::{Shape, shape::Disk};"),
    ];
    let circle = "shape/area.rs -> shape/round.rs: Disk\nshape/round.rs -> shape/area.rs: area\n";
    assert_eq!(circles_of(&files), [circle]);
}

#[test]
fn re_exports_tests_and_other_crates_make_no_circle() {
    let files = [
        ROOT,
        SHAPE,
        (
            "shape/area.rs",
            "use crate::shape::Disk; impl Disk { #[cfg(test)] fn f() { crate::solid::f() } }",
        ),
        (
            "shape/round.rs",
            "use super::Shape; use std::fmt; pub struct Disk; impl fmt::Debug for Shape {}",
        ),
        ("shape/tests.rs", "use super::area; use crate::solid::f;"),
        (
            "solid.rs",
            "use crate::Shape; pub fn f() {} #[cfg(test)] use crate::shape::area; \
             mod inner { use super::f; }",
        ),
    ];
    assert_eq!(circles_of(&files), [""; 0]);
}

/// A path counts wherever it stands, also behind the name of an imported module and behind a re-export of all
/// names.
#[test]
fn every_kind_of_path_counts() {
    for text in [
        "fn g(_: crate::solid::Solid) {}",
        "fn g() { crate::solid::f(); }",
        "fn g() { use super::super::solid; solid::f(); }",
        "fn g() { assert!(1 == crate::solid::f(), \"{}\", 1); }",
        "macro_rules! m { () => { $crate::solid::f() }; }",
        "#[serde(with = \"crate::solid::f\")] struct S;",
        "use crate::solid as s; struct S(s::Solid);",
        "use crate::solid::*;",
        "use crate::all::f;",
        "mod inner { use super::super::super::solid::f; }",
        "mod inner { fn g() { self::f(); } use crate::solid::f; }",
    ] {
        let round = format!("pub struct Disk; {text}");
        let files = [
            (
                "lib.rs",
                "mod shape; mod solid; mod all { pub use crate::solid::*; }",
            ),
            ("shape.rs", "mod round; pub use round::Disk;"),
            ("shape/round.rs", &round),
            (
                "solid.rs",
                "use crate::shape::Disk; pub struct Solid; pub fn f() {}",
            ),
        ];
        assert_eq!(circles_of(&files).len(), 1, "{text}");
    }
}

/// A module that calls a function of its child uses the child.
#[test]
fn a_module_and_its_child_can_make_a_circle() {
    let child = ("shape/area.rs", "use super::Shape; pub fn area() {}");
    for text in [
        "fn f() { area::area(); }",
        "use area::area;",
        "use self::area::area;",
    ] {
        let shape = format!("mod area; pub struct Shape; {text}");
        let files = [("lib.rs", "mod shape;"), ("shape.rs", &shape), child];
        assert_eq!(
            circles_of(&files),
            ["shape/area.rs -> shape.rs: Shape\nshape.rs -> shape/area.rs: area\n"]
        );
    }
}
