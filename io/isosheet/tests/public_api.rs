//! The public items of the library crates are those of the lists in `docs/public-api`, so that a change of
//! them shows in a diff.
//!
//! The lists are made of the sources. As the lint `unreachable_pub` is on, whatever is `pub` can be reached.
//! Left out are hidden items, implementations of traits that are not derived, and what macros make.

use proc_macro2::{Delimiter, Group, Ident, TokenStream, TokenTree};
use quote::ToTokens;
use std::collections::BTreeSet;
use std::mem::take;
use std::path::Path;
use std::{env, fs};
use syn::punctuated::Punctuated;
use syn::{Attribute, Field, Fields, ImplItem, Item, ItemImpl, ItemMod, UseTree, Visibility};

#[test]
fn what_is_public_is_in_the_lists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut changed = String::new();
    for folder in [
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
        "io/page",
        "io/pictures",
        "io/runs",
        "io/films",
        "io",
        "io/isosheet",
    ] {
        let name = folder.replace('/', "-");
        let list = root.join("docs/public-api").join(name + ".txt");
        let found = Items::of_crate(&root.join(folder).join("src"));
        if env::var_os("RENEW_PUBLIC_API").is_some() {
            let text: String = found.iter().map(|line| format!("{line}\n")).collect();
            fs::write(&list, text).unwrap();
        }
        let listed = fs::read_to_string(&list).unwrap_or_default();
        let listed = listed.lines().map(str::to_owned).collect();
        for line in found.symmetric_difference(&listed) {
            let sign = if found.contains(line) { '+' } else { '-' };
            changed += &format!("{sign} {folder}: {line}\n");
        }
    }
    let remedy = "`RENEW_PUBLIC_API=1 cargo test -p isosheet --test public_api` renews the lists";
    assert!(
        changed.is_empty(),
        "public items have changed; {remedy}\n{changed}"
    );
}

/// What can grow may do so without a new major version.
#[test]
fn errors_and_reports_may_grow() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for folder in [
        "mesh",
        "coords/linalg",
        "coords",
        "dynamics",
        "collide/geometry",
        "collide",
    ] {
        for line in Items::of_crate(&root.join(folder).join("src")) {
            let mut words = line.split_whitespace().take(3);
            let kind = words.nth(1).zip(words.next());
            let grows = kind.is_some_and(|(kind, name)| match kind {
                "enum" => name.ends_with("Error") || name.ends_with("Event"),
                "struct" => name.ends_with("Report"),
                _ => false,
            });
            assert!(
                !grows || line.ends_with("non_exhaustive"),
                "{folder}: {line}"
            );
        }
    }
}

#[derive(Default)]
struct Items {
    /// Lines, each with the name of the item that it is about.
    lines: Vec<(String, String)>,
    hidden: BTreeSet<String>,
}

impl Items {
    fn of_crate(source: &Path) -> BTreeSet<String> {
        let mut all = Self::default();
        all.add_file(&source.join("lib.rs"), source, "crate");
        let lines = all.lines.into_iter();
        let lines = lines.filter(|(name, _)| !all.hidden.contains(name));
        lines.map(|(_, line)| line).collect()
    }

    /// Adds a file with the modules in `folder`; `path` is that of a public module, or empty.
    fn add_file(&mut self, file: &Path, folder: &Path, path: &str) {
        let text = fs::read_to_string(file).unwrap();
        let items = syn::parse_file(&text).unwrap().items;
        items
            .into_iter()
            .for_each(|item| self.add(item, folder, path));
    }

    fn add(&mut self, mut item: Item, folder: &Path, path: &str) {
        if let Item::Struct(item) = &mut item {
            match &mut item.fields {
                Fields::Named(f) => f.named = only_public(&mut f.named),
                Fields::Unnamed(f) => f.unnamed = only_public(&mut f.unnamed),
                Fields::Unit => {}
            }
        }
        let all = item.to_token_stream();
        let (visibility, attributes, name, braces) = match item {
            Item::Mod(i) => return self.add_module(i, folder, path),
            Item::Impl(i) => return self.add_impl(&i),
            Item::Use(i) if is_public(&i.vis) => {
                let known = |name: &String| (name.clone(), format!("{path}::{name}"));
                let names = leaves(&i.tree);
                match path {
                    _ if is_hidden(&i.attrs) => self.hidden.extend(names),
                    "" => {}
                    _ => self.lines.extend(names.iter().map(known)),
                }
                return;
            }
            Item::Struct(i) => (i.vis, i.attrs, i.ident, usize::MAX),
            Item::Enum(i) => (i.vis, i.attrs, i.ident, usize::MAX),
            Item::Trait(i) => (i.vis, i.attrs, i.ident, 1),
            Item::Type(i) => (i.vis, i.attrs, i.ident, 0),
            Item::Const(i) => (i.vis, i.attrs, i.ident, 0),
            Item::Fn(i) => (i.vis, i.attrs, i.sig.ident, 0),
            _ => return,
        };
        if is_hidden(&attributes) {
            self.hidden.insert(name.to_string());
        } else if is_public(&visibility) {
            let of_users = |a: &&Attribute| {
                ["derive", "non_exhaustive"]
                    .iter()
                    .any(|w| a.path().is_ident(w))
            };
            let kept = attributes
                .iter()
                .filter(of_users)
                .map(|a| text(a.meta.to_token_stream(), 0));
            let line = kept.fold(text(all, braces), |line, kept| line + " " + &kept);
            let known = (!path.is_empty()).then(|| format!("{path}::{name}"));
            let lines = known.into_iter().chain([line]);
            self.lines
                .extend(lines.map(|line| (name.to_string(), line)));
        }
    }

    fn add_module(&mut self, module: ItemMod, folder: &Path, path: &str) {
        let mut attributes = module.attrs.iter().map(|a| a.to_token_stream().to_string());
        if attributes.any(|a| a.contains("cfg") && a.contains("test")) {
            return;
        }
        let folder = folder.join(module.ident.to_string());
        let path = match is_public(&module.vis) && !path.is_empty() {
            true => format!("{path}::{}", module.ident),
            false => String::new(),
        };
        let mut inner = Self::default();
        match module.content {
            Some((_, items)) => items
                .into_iter()
                .for_each(|item| inner.add(item, &folder, &path)),
            None => {
                let (beside, within) = (folder.with_extension("rs"), folder.join("mod.rs"));
                let file = if beside.is_file() { beside } else { within };
                inner.add_file(&file, &folder, &path);
            }
        }
        self.hidden.append(&mut inner.hidden);
        match is_hidden(&module.attrs) {
            true => self
                .hidden
                .extend(inner.lines.into_iter().map(|(name, _)| name)),
            false => self.lines.append(&mut inner.lines),
        }
    }

    fn add_impl(&mut self, item: &ItemImpl) {
        let of = text(item.self_ty.to_token_stream(), 0);
        let name = of.split('<').next().unwrap_or(&of).to_owned();
        for part in &item.items {
            let (visibility, attributes, line) = match part {
                ImplItem::Fn(f) => (&f.vis, &f.attrs, f.sig.to_token_stream()),
                ImplItem::Const(c) => (&c.vis, &c.attrs, c.to_token_stream()),
                _ => continue,
            };
            if is_public(visibility) && !is_hidden(attributes) {
                let line = format!("{of}: {}", text(line, 0));
                self.lines.push((name.clone(), line));
            }
        }
    }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

fn only_public<P: Default>(fields: &mut Punctuated<Field, P>) -> Punctuated<Field, P> {
    let fields = take(fields).into_iter();
    fields.filter(|field| is_public(&field.vis)).collect()
}

fn is_hidden(attributes: &[Attribute]) -> bool {
    let mut all = attributes.iter().filter(|a| a.path().is_ident("doc"));
    all.any(|a| a.parse_args::<Ident>().is_ok_and(|word| word == "hidden"))
}

fn leaves(tree: &UseTree) -> Vec<String> {
    match tree {
        UseTree::Path(next) => leaves(&next.tree),
        UseTree::Group(group) => group.items.iter().flat_map(leaves).collect(),
        UseTree::Name(name) => vec![name.ident.to_string()],
        UseTree::Rename(name) => vec![name.rename.to_string()],
        UseTree::Glob(_) => vec!["*".to_owned()],
    }
}

/// The text of tokens without attributes, and without what stands in braces at a depth.
fn text(tokens: TokenStream, braces: usize) -> String {
    let tokens = shown(tokens, braces).to_string();
    let mut text = String::new();
    for word in tokens.split_whitespace() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '\'';
        let words = text.ends_with(is_word) && word.starts_with(is_word);
        let after = text.ends_with([',', '=', '+', '{', '}', ';']) || text.ends_with("->");
        let after_name = text.ends_with(':') && !text.ends_with("::");
        let before = ["->", "=", "+", "{", "}"].contains(&word);
        if words || before || (after || after_name) && ![",", ";"].contains(&word) {
            text.push(' ');
        }
        text += word;
    }
    text
}

fn shown(tokens: TokenStream, braces: usize) -> TokenStream {
    let mut tokens = tokens.into_iter();
    let mut kept = Vec::new();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(sign) if sign.as_char() == '#' => drop(tokens.next()),
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace && braces == 0 => {}
            TokenTree::Group(group) => {
                let inner = shown(group.stream(), braces.saturating_sub(1));
                kept.push(TokenTree::from(Group::new(group.delimiter(), inner)));
            }
            token => kept.push(token),
        }
    }
    kept.into_iter().collect()
}
