//! Which file of a crate names what other files define.

use super::names::{Import, Names, has_test_attribute, is_for_tests};
use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Attribute, ImplItemFn, Item, ItemUse, LitStr, Macro, Meta, VisRestricted, Visibility};

/// The names by which files use other files.
pub(super) struct Uses(BTreeMap<(PathBuf, PathBuf), BTreeSet<String>>);

impl Uses {
    /// All uses in a crate.
    pub(super) fn of(names: &Names) -> Self {
        let mut uses = Self(BTreeMap::new());
        for (path, module) in names.modules() {
            let mut visitor = PathVisitor {
                names,
                module: path,
                uses: &mut uses,
            };
            for item in &module.items {
                visitor.visit_item(item);
            }
        }
        uses
    }

    /// The uses between folders: a file or a folder, with the file of its name, uses those beside it that
    /// files in it use.
    pub(super) fn of_folders(&self, root: &Path) -> Self {
        let mut uses = Self(BTreeMap::new());
        for ((file, used), names) in &self.0 {
            let places = [file, used].map(|file| place(root, file));
            let [file, used] = &places;
            let common = file.iter().zip(used).take_while(|(a, b)| a == b).count();
            if file.len().min(used.len()) > common {
                let beside = places.map(|place| place[..=common].iter().collect());
                let [file, used]: [PathBuf; 2] = beside.map(|path: PathBuf| root.join(path));
                uses.0
                    .entry((file, used))
                    .or_default()
                    .extend(names.clone());
            }
        }
        uses
    }

    /// The files that use others.
    pub(super) fn files(&self) -> Vec<&Path> {
        self.0.keys().map(|(file, _)| file.as_path()).collect()
    }

    /// The files that a file uses.
    pub(super) fn by(&self, file: &Path) -> Vec<&Path> {
        let all = self.0.keys().filter(|(user, _)| user == file);
        all.map(|(_, used)| used.as_path()).collect()
    }

    /// The uses among some files: who uses whom, and by which names.
    pub(super) fn among(
        &self,
        files: &[&Path],
    ) -> impl Iterator<Item = (&Path, &Path, &BTreeSet<String>)> {
        self.0.iter().filter_map(move |((file, used), names)| {
            let both = files.contains(&file.as_path()) && files.contains(&used.as_path());
            both.then_some((file.as_path(), used.as_path(), names))
        })
    }
}

/// The way to a file in its crate: `[a, b]` for `a/b.rs` and `a/b/mod.rs`, and nothing for `lib.rs`.
fn place(root: &Path, file: &Path) -> Vec<OsString> {
    let file = file.strip_prefix(root).unwrap_or(file).with_extension("");
    let names = file.iter().filter(|name| *name != "mod" && *name != "lib");
    names.map(OsStr::to_owned).collect()
}

/// Follows all paths in the items of a module.
struct PathVisitor<'a> {
    names: &'a Names,
    module: &'a [String],
    uses: &'a mut Uses,
}

impl PathVisitor<'_> {
    /// Notes what a path leads to, if another file defines it.
    fn note(&mut self, path: &[String]) {
        if let Some(found) = self.names.find(self.module, path) {
            self.note_name(&found.module, found.name);
        }
    }

    fn note_name(&mut self, module: &[String], name: String) {
        let [file, used] = [self.module, module].map(|module| self.names.file(module).to_owned());
        if file != used {
            self.uses.0.entry((file, used)).or_default().insert(name);
        }
    }

    /// Notes the paths among the tokens that a macro or an attribute is given.
    fn note_tokens(&mut self, tokens: TokenStream) {
        let mut path = Vec::new();
        // Colons since the last segment of the path.
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.note_code_path(&path);
                        path.clear();
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                token => {
                    self.note_code_path(&path);
                    path.clear();
                    colons = 0;
                    if let TokenTree::Group(group) = token {
                        self.note_tokens(group.stream());
                    }
                }
            }
        }
        self.note_code_path(&path);
    }

    /// Notes a path in code, where a single name may be that of a variable.
    fn note_code_path(&mut self, path: &[String]) {
        if path.len() > 1 {
            self.note(path);
        }
    }

    /// Notes the paths in the strings of an attribute, as serde has them.
    fn note_strings(&mut self, tokens: TokenStream) {
        for token in tokens {
            match token {
                TokenTree::Group(group) => self.note_strings(group.stream()),
                token => {
                    let path = syn::parse2::<LitStr>(token.into())
                        .and_then(|text| text.parse_with(syn::Path::parse_mod_style));
                    if let Ok(path) = path {
                        self.note(&segments(&path));
                    }
                }
            }
        }
    }
}

/// The segments of a path; of one that begins with `::`, which leads to another crate, none.
fn segments(path: &syn::Path) -> Vec<String> {
    let own = path
        .segments
        .iter()
        .filter(|_| path.leading_colon.is_none());
    own.map(|segment| segment.ident.to_string()).collect()
}

impl<'ast> Visit<'ast> for PathVisitor<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if !is_for_tests(item) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        if !has_test_attribute(&item.attrs) {
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        for import in Import::all_of(item) {
            let Some(found) = self.names.find(self.module, &import.path) else {
                continue;
            };
            // A module that re-exports what its children define depends on them no more than by `mod child;`.
            let of_child = found.module.starts_with(self.module);
            if of_child && !matches!(item.vis, Visibility::Inherited) {
                continue;
            }
            let name = if import.is_of_all_names() {
                "*".to_owned()
            } else {
                found.name
            };
            self.note_name(&found.module, name);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.note_code_path(&segments(path));
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast Macro) {
        self.visit_path(&item.path);
        self.note_tokens(item.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let Meta::List(list) = &attribute.meta {
            self.note_tokens(list.tokens.clone());
            self.note_strings(list.tokens.clone());
        }
    }

    /// Who may use an item is no use.
    fn visit_vis_restricted(&mut self, _: &'ast VisRestricted) {}
}
