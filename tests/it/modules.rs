//! The modules beside one another in a library crate use one another in no circle.
//!
//! A module is a file with the folder of its name. It uses another one where a path in it, or in a file
//! beneath it, leads there, directly or by re-exports. Tests are left out, and paths in macros and imports of
//! all names are not seen.

use pathfinding::prelude::strongly_connected_components;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemMod, ItemUse, UseTree};

/// The names on the way from the root of a crate to a module or to what it defines.
type Place = Vec<String>;

/// The paths of a crate.
#[derive(Default)]
struct Paths {
    /// The module that is visited.
    module: Place,
    modules: BTreeSet<Place>,
    /// Where a name is imported, and its path there.
    imports: BTreeMap<Place, (Place, Place)>,
    /// All paths, with the modules that they stand in.
    all: BTreeSet<(Place, Place)>,
}

fn is_for_tests(attributes: &[Attribute]) -> bool {
    let mut lists = attributes.iter().filter_map(|a| a.meta.require_list().ok());
    lists.any(|list| list.path.is_ident("cfg") && list.tokens.to_string() == "test")
}

impl Visit<'_> for Paths {
    fn visit_item(&mut self, item: &Item) {
        let attributes = match item {
            Item::Mod(item) => &item.attrs,
            Item::Use(item) => &item.attrs,
            Item::Impl(item) => &item.attrs,
            Item::Fn(item) => &item.attrs,
            _ => &Vec::new(),
        };
        if !is_for_tests(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &ItemMod) {
        self.module.push(item.ident.to_string());
        visit::visit_item_mod(self, item);
        self.module.pop();
    }

    fn visit_item_use(&mut self, item: &ItemUse) {
        self.import(&item.tree, Vec::new());
    }

    fn visit_path(&mut self, path: &syn::Path) {
        let names = path.segments.iter().map(|s| s.ident.to_string());
        self.all.insert((self.module.clone(), names.collect()));
        visit::visit_path(self, path);
    }
}

impl Paths {
    /// Visits the files of a folder, which are modules in that at `place`.
    fn read(&mut self, folder: &Path, place: &Place) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path
                .file_stem()
                .expect("a name")
                .to_string_lossy()
                .into_owned();
            let mut module = place.clone();
            match name.as_str() {
                "lib" | "mod" => {}
                "main" => continue,
                name if name.ends_with("tests") => continue,
                _ => module.push(name),
            }
            if path.is_dir() {
                self.read(&path, &module);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path).expect("a text");
                self.modules.insert(module.clone());
                self.module = module;
                self.visit_file(&syn::parse_file(&text).expect("a file of Rust"));
            }
        }
    }

    fn import(&mut self, tree: &UseTree, mut path: Place) {
        let name = match tree {
            UseTree::Path(next) => {
                path.push(next.ident.to_string());
                return self.import(&next.tree, path);
            }
            UseTree::Group(group) => {
                return group
                    .items
                    .iter()
                    .for_each(|tree| self.import(tree, path.clone()));
            }
            UseTree::Name(name) if name.ident == "self" => path.last().cloned().unwrap_or_default(),
            UseTree::Name(name) => {
                path.push(name.ident.to_string());
                name.ident.to_string()
            }
            UseTree::Rename(name) => {
                path.push(name.ident.to_string());
                name.rename.to_string()
            }
            UseTree::Glob(_) => return,
        };
        let here = self.module.clone();
        let place = [&here[..], &[name]].concat();
        self.all.insert((here.clone(), path.clone()));
        self.imports.insert(place, (here, path));
    }

    /// Where a path in a module leads, if it does not leave the crate.
    fn target(&self, module: &Place, path: &[String]) -> Option<Place> {
        let (first, rest) = path.split_first()?;
        let (start, rest) = match first.as_str() {
            "crate" => (Vec::new(), rest),
            "self" => (module.clone(), rest),
            "super" => (module.split_last()?.1.to_vec(), rest),
            _ => {
                let place = [&module[..], &path[..1]].concat();
                self.modules
                    .contains(&place)
                    .then(|| (module.clone(), path))?
            }
        };
        if rest.first().is_some_and(|next| next == "super") {
            return self.target(&start, rest);
        }
        let place = [&start[..], rest].concat();
        let imports = (1..=place.len()).filter(|&k| !self.modules.contains(&place[..k]));
        let import = imports
            .filter_map(|k| Some((k, self.imports.get(&place[..k])?)))
            .next();
        match import {
            Some((k, (from, path))) => {
                let path = [&path[..], &place[k..]].concat();
                self.target(from, &path)
            }
            None => Some(place),
        }
    }

    /// The circles of modules beside one another, each with who uses what.
    fn circles(&self) -> Vec<String> {
        let mut uses: BTreeMap<Place, BTreeMap<Place, String>> = BTreeMap::new();
        for (module, path) in &self.all {
            let Some(used) = self.target(module, path) else {
                continue;
            };
            let common = module.iter().zip(&used).take_while(|(a, b)| a == b).count();
            if common < module.len().min(used.len()) && self.modules.contains(&used[..=common]) {
                let users = uses.entry(module[..=common].to_vec()).or_default();
                users.insert(used[..=common].to_vec(), used.join("::"));
            }
        }
        let modules: Vec<Place> = uses.keys().cloned().collect();
        let next = |module: &Place| {
            uses.get(module)
                .into_iter()
                .flat_map(|of| of.keys().cloned())
        };
        let circles = strongly_connected_components(&modules, |m| next(m).collect::<Vec<_>>());
        let circles = circles.iter().filter(|circle| circle.len() > 1);
        let lines = circles.map(|circle| {
            let pairs = circle
                .iter()
                .flat_map(|m| uses[m].iter().map(move |used| (m, used)));
            let inside = pairs.filter(|(_, (used, _))| circle.contains(used));
            inside
                .map(|(m, (_, path))| format!("{} -> {path}\n", m.join("::")))
                .collect()
        });
        lines.collect()
    }
}

/// The circles of a crate, by its folder of sources.
fn circles(sources: &Path) -> Vec<String> {
    let mut paths = Paths::default();
    paths.read(sources, &Vec::new());
    paths.circles()
}

/// The library crates in and beneath a folder, by their folders of sources.
fn libraries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder)
        .expect("a folder")
        .flatten()
        .map(|e| e.path());
    let inner =
        entries.filter(|path| path.is_dir() && !path.ends_with("src") && !path.ends_with("target"));
    let mut found: Vec<PathBuf> = inner.flat_map(|path| libraries(&path)).collect();
    let own = folder.join("src");
    found.extend(own.join("lib.rs").is_file().then_some(own));
    found
}

#[test]
fn modules_of_library_crates_make_no_circle() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("");
    let mut count = 0;
    for group in ["mesh", "coords", "dynamics", "collide", "io"] {
        for sources in libraries(&root.join(group)) {
            let circles = circles(&sources);
            assert!(
                circles.is_empty(),
                "{}: {}",
                sources.display(),
                circles.concat()
            );
            count += 1;
        }
    }
    assert!(count > 15, "{count}");
}

#[test]
fn a_circle_over_a_re_export_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("shape")).expect("a folder");
    for (file, text) in [
        ("lib.rs", "mod shape; mod solid; pub use shape::Disk;"),
        ("shape.rs", "mod round; pub use round::Disk;"),
        (
            "shape/round.rs",
            "pub struct Disk; use super::super::solid::{self, Solid};",
        ),
        (
            "solid.rs",
            "pub struct Solid(crate::Disk); #[cfg(test)] mod t { use crate::t; }",
        ),
    ] {
        fs::write(folder.path().join(file), text).expect("a file");
    }
    let found = circles(folder.path()).concat();
    let lines = ["shape -> solid", "solid -> shape::round::Disk"];
    assert!(
        found.lines().count() == 2 && lines.iter().all(|l| found.contains(l)),
        "{found}"
    );
}
