//! The modules of a crate, and which of them defines what a path names.

use proc_macro2::Ident;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use syn::{Attribute, Expr, ExprLit, Item, ItemUse, Lit, UseTree};

/// What a `use` makes known.
pub(super) struct Import {
    /// The name by which it is known; `*` for all names of a module.
    name: String,
    /// The path as it is written, without a `*` at its end.
    pub(super) path: Vec<String>,
}

impl Import {
    pub(super) fn is_of_all_names(&self) -> bool {
        self.name == "*"
    }

    /// The imports of an item. Of a path that begins with `::`, which leads to another crate, the first
    /// segment is empty.
    pub(super) fn all_of(item: &ItemUse) -> Vec<Self> {
        let mut imports = Vec::new();
        let start = item.leading_colon.map(|_| String::new());
        Self::collect(&item.tree, start.into_iter().collect(), &mut imports);
        imports
    }

    fn collect(tree: &UseTree, mut path: Vec<String>, imports: &mut Vec<Self>) {
        let (ident, name) = match tree {
            UseTree::Path(next) => {
                path.push(next.ident.to_string());
                return Self::collect(&next.tree, path, imports);
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    Self::collect(tree, path.clone(), imports);
                }
                return;
            }
            UseTree::Glob(_) => {
                let name = "*".to_owned();
                return imports.push(Self { name, path });
            }
            UseTree::Name(name) => (&name.ident, &name.ident),
            UseTree::Rename(rename) => (&rename.ident, &rename.rename),
        };
        // `{self}` stands for the path before it.
        if ident != "self" {
            path.push(ident.to_string());
        }
        let name = match name == "self" {
            true => path.last().cloned().unwrap_or_default(),
            false => name.to_string(),
        };
        imports.push(Self { name, path });
    }
}

/// A module: a file, or a part of one between braces.
pub(super) struct Module {
    pub(super) file: PathBuf,
    /// What it contains but for the modules in it.
    pub(super) items: Vec<Item>,
    defined: BTreeSet<String>,
    imports: Vec<Import>,
}

/// What a path leads to: a name in the module that defines it, or a module.
pub(super) struct Found {
    pub(super) module: Vec<String>,
    pub(super) name: String,
}

/// All modules of a crate but for those for tests, by their paths from the root.
pub(super) struct Names(BTreeMap<Vec<String>, Module>);

impl Names {
    /// More modules and re-exports than any path leads over. Following a path ends there, since imports can
    /// lead in a circle.
    const MOST_STEPS: usize = 16;

    /// Reads `lib.rs` in a folder and all modules that it reaches.
    pub(super) fn read(root: &Path) -> Self {
        let mut names = Self(BTreeMap::new());
        names.add_file(Vec::new(), root.join("lib.rs"), root);
        names
    }

    fn add_file(&mut self, path: Vec<String>, file: PathBuf, folder: &Path) {
        let parsed = fs::read_to_string(&file)
            .map_err(|e| e.to_string())
            .and_then(|text| syn::parse_file(&text).map_err(|e| e.to_string()));
        match parsed {
            Ok(parsed) => self.add(path, file, folder, parsed.items),
            Err(error) => panic!("{}: {error}", file.display()),
        }
    }

    /// Adds a module and those in it, of which the files lie in `folder`.
    fn add(&mut self, path: Vec<String>, file: PathBuf, folder: &Path, items: Vec<Item>) {
        let mut module = Module {
            file,
            items: Vec::new(),
            defined: BTreeSet::new(),
            imports: Vec::new(),
        };
        for item in items.into_iter().filter(|item| !is_for_tests(item)) {
            match item {
                Item::Mod(child) => {
                    let name = child.ident.to_string();
                    let folder = folder.join(&name);
                    let path = [&path[..], &[name]].concat();
                    match child.content {
                        Some((_, items)) => self.add(path, module.file.clone(), &folder, items),
                        None => {
                            let named = named_path(&child.attrs);
                            let named = named.map(|path| module.file.with_file_name(path));
                            let (beside, within) =
                                (folder.with_extension("rs"), folder.join("mod.rs"));
                            let usual = if beside.is_file() { beside } else { within };
                            self.add_file(path, named.unwrap_or(usual), &folder);
                        }
                    }
                    continue;
                }
                Item::Use(ref item) => module.imports.extend(Import::all_of(item)),
                ref item => module.defined.extend(head(item).1.map(Ident::to_string)),
            }
            module.items.push(item);
        }
        self.0.insert(path, module);
    }

    /// All modules with their paths.
    pub(super) fn modules(&self) -> impl Iterator<Item = (&[String], &Module)> {
        self.0.iter().map(|(path, module)| (&path[..], module))
    }

    /// The file of a module.
    pub(super) fn file(&self, path: &[String]) -> &Path {
        &self.0[path].file
    }

    /// What a path in a module leads to; `None` if that is in another crate, or known without a `use`.
    pub(super) fn find(&self, module: &[String], path: &[String]) -> Option<Found> {
        self.find_within(module, path, Self::MOST_STEPS)
    }

    fn find_within(&self, module: &[String], path: &[String], steps: usize) -> Option<Found> {
        match path.first()?.as_str() {
            "crate" => self.walk(&[], &path[1..], steps),
            "self" => self.walk(module, &path[1..], steps),
            "super" => {
                let above = path
                    .iter()
                    .take_while(|segment| *segment == "super")
                    .count();
                let base = module.len().checked_sub(above)?;
                self.walk(&module[..base], &path[above..], steps)
            }
            first => {
                let known =
                    self.child(module, first).is_some() || self.import(module, first).is_some();
                known.then(|| self.walk(module, path, steps))?
            }
        }
    }

    /// What a path leads to that begins with a name in the module `at`.
    fn walk(&self, at: &[String], path: &[String], steps: usize) -> Option<Found> {
        let steps = steps.checked_sub(1)?;
        let found = |name: &str| {
            Some(Found {
                module: at.to_owned(),
                name: name.to_owned(),
            })
        };
        let Some((name, rest)) = path.split_first() else {
            return found(at.last().map_or("crate", String::as_str));
        };
        if let Some(child) = self.child(at, name) {
            return self.walk(&child, rest, steps);
        }
        if let Some(import) = self.import(at, name) {
            return self.find_within(at, &[&import.path, rest].concat(), steps);
        }
        match self.behind_all_names(at, name, steps) {
            Some(module) => self.walk(&module, path, steps),
            // Defined here, maybe by a macro.
            None => found(name),
        }
    }

    fn child(&self, at: &[String], name: &str) -> Option<Vec<String>> {
        let child = [at, &[name.to_owned()]].concat();
        self.0.contains_key(&child).then_some(child)
    }

    fn import(&self, at: &[String], name: &str) -> Option<&Import> {
        let mut imports = self.0[at].imports.iter();
        imports.find(|import| import.name == name && !import.is_of_all_names())
    }

    /// The module that has a name which `at` knows by importing all names of that module.
    fn behind_all_names(&self, at: &[String], name: &str, steps: usize) -> Option<Vec<String>> {
        let steps = steps.checked_sub(1)?;
        if self.0[at].defined.contains(name) {
            return None;
        }
        let imports = self.0[at]
            .imports
            .iter()
            .filter(|import| import.is_of_all_names());
        imports
            .filter_map(|import| self.find_within(at, &import.path, steps))
            .find_map(|found| {
                let module = found.module;
                let has = self.0[&module].defined.contains(name)
                    || self.child(&module, name).is_some()
                    || self.import(&module, name).is_some();
                if has {
                    Some(module)
                } else {
                    self.behind_all_names(&module, name, steps)
                }
            })
    }
}

/// The file that an attribute `#[path = "..."]` of a module names.
fn named_path(attributes: &[Attribute]) -> Option<String> {
    let path = attributes.iter().find(|a| a.path().is_ident("path"))?;
    let Expr::Lit(ExprLit {
        lit: Lit::Str(text),
        ..
    }) = &path.meta.require_name_value().ok()?.value
    else {
        return None;
    };
    Some(text.value())
}

/// Whether an item is compiled for tests only.
pub(super) fn is_for_tests(item: &Item) -> bool {
    has_test_attribute(head(item).0)
}

/// Whether one of the attributes is `#[cfg(test)]`.
pub(super) fn has_test_attribute(attributes: &[Attribute]) -> bool {
    let mut conditions = attributes.iter().filter(|a| a.path().is_ident("cfg"));
    conditions.any(|a| {
        a.parse_args::<Ident>()
            .is_ok_and(|condition| condition == "test")
    })
}

/// The attributes of an item and the name that it defines.
fn head(item: &Item) -> (&[Attribute], Option<&Ident>) {
    match item {
        Item::Const(item) => (&item.attrs, Some(&item.ident)),
        Item::Enum(item) => (&item.attrs, Some(&item.ident)),
        Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
        Item::Impl(item) => (&item.attrs, None),
        Item::Macro(item) => (&item.attrs, item.ident.as_ref()),
        Item::Mod(item) => (&item.attrs, None),
        Item::Static(item) => (&item.attrs, Some(&item.ident)),
        Item::Struct(item) => (&item.attrs, Some(&item.ident)),
        Item::Trait(item) => (&item.attrs, Some(&item.ident)),
        Item::TraitAlias(item) => (&item.attrs, Some(&item.ident)),
        Item::Type(item) => (&item.attrs, Some(&item.ident)),
        Item::Union(item) => (&item.attrs, Some(&item.ident)),
        Item::Use(item) => (&item.attrs, None),
        _ => (&[], None),
    }
}
