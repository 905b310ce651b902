//! Modules inside a library crate use one another in no circle, and neither do its folders.
//!
//! The modules are the files that `lib.rs` reaches by `mod`, without those for tests. A file uses another one
//! if it names something that the other file defines: `modules/names.rs` finds the file in which a name is
//! defined, `modules/uses.rs` the paths that name something. A folder and the file of its name are one among
//! the files and folders beside them: it uses one of these if a file in it does.

mod names;
mod uses;

use names::Names;
use pathfinding::prelude::strongly_connected_components;
use std::fs;
use std::path::{Path, PathBuf};
use uses::Uses;

/// The circles among the files of a crate, each with a line `file -> file: names` for every use in it.
fn circles(root: &Path) -> Vec<String> {
    circles_among(&Uses::of(&Names::read(root)), root)
}

/// The circles among the folders of a crate, as [`circles`] has those of its files.
fn circles_of_folders(root: &Path) -> Vec<String> {
    circles_among(&Uses::of(&Names::read(root)).of_folders(root), root)
}

fn circles_among(uses: &Uses, root: &Path) -> Vec<String> {
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

/// The library crates, by their folders.
const LIBRARIES: [&str; 18] = [
    "mesh",
    "coords/linalg",
    "coords",
    "dynamics",
    "dynamics/attached-flow",
    "dynamics/charts",
    "collide/geometry",
    "collide",
    "io/files",
    "io/drawings",
    "io/formats",
    "io/scenes",
    "io/pictures",
    "io/page",
    "io/runs",
    "io/films",
    "io",
    "io/python",
];

fn sources(library: &str) -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.with_file_name(library).join("src")
}

#[test]
fn library_crates_have_no_circles_of_modules() {
    let mut message = String::new();
    for library in LIBRARIES {
        for circle in circles(&sources(library)) {
            message += &format!("\na circle in {library}/src:\n{circle}");
        }
    }
    assert!(message.is_empty(), "{message}");
}

#[test]
fn folders_of_library_crates_have_no_circles() {
    let mut message = String::new();
    for library in LIBRARIES {
        for circle in circles_of_folders(&sources(library)) {
            message += &format!("\na circle of folders in {library}/src:\n{circle}");
        }
    }
    assert!(message.is_empty(), "{message}");
}

/// The circles that `find` finds in a crate of these files.
fn circles_of(files: &[(&str, &str)], find: fn(&Path) -> Vec<String>) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    for (path, text) in files {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().expect("the folder of the file")).expect("a folder");
        fs::write(path, text).expect("a file");
    }
    find(folder.path())
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
    assert_eq!(circles_of(&files, circles), [circle]);
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
    assert_eq!(circles_of(&files, circles), [""; 0]);
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
        assert_eq!(circles_of(&files, circles).len(), 1, "{text}");
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
            circles_of(&files, circles),
            ["shape/area.rs -> shape.rs: Shape\nshape.rs -> shape/area.rs: area\n"]
        );
    }
}

/// Of two folders each uses a file of the other, although no files use one another in a circle.
#[test]
fn a_circle_of_folders_is_found() {
    let files = [
        ("lib.rs", "mod shape; mod solid;"),
        ("shape.rs", "mod area; mod round;"),
        ("shape/area.rs", "use crate::solid::Solid;"),
        ("shape/round.rs", "pub struct Disk;"),
        ("solid.rs", "mod body; pub struct Solid;"),
        ("solid/body.rs", "use crate::shape::round::Disk;"),
    ];
    let circle = "shape -> solid: Solid\nsolid -> shape: Disk\n";
    assert_eq!(circles_of(&files, circles_of_folders), [circle]);
    assert_eq!(circles_of(&files, circles), [""; 0]);
}
