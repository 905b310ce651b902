//! What edits make of the text of a document is what was asked for.

use super::*;
use proptest::prelude::*;
use proptest::sample::Index;
use std::collections::BTreeMap;
use std::fmt::Write;

/// A value and how it is laid out in a text.
#[derive(Clone, Debug)]
enum Node {
    Number(i32),
    Text(String),
    /// In brackets.
    List(Vec<Node>),
    /// In braces.
    Braces(BTreeMap<String, Node>),
    /// A table with a header, `[name]`.
    Header(BTreeMap<String, Node>),
    /// Tables with headers, `[[name]]`.
    Headers(Vec<BTreeMap<String, Node>>),
}

impl Node {
    /// As a value on the right of an equals sign.
    fn inline(&self) -> String {
        let entries = |table: &BTreeMap<String, Node>| {
            let pairs = table.iter().map(|(k, v)| format!("{k} = {}", v.inline()));
            format!("{{ {} }}", pairs.collect::<Vec<_>>().join(", "))
        };
        let list = |items: Vec<String>| format!("[{}]", items.join(", "));
        match self {
            Self::Number(n) => n.to_string(),
            Self::Text(text) => Value::from(text.as_str()).to_string(),
            Self::List(items) => list(items.iter().map(Self::inline).collect()),
            Self::Braces(table) | Self::Header(table) => entries(table),
            Self::Headers(tables) => list(tables.iter().map(entries).collect()),
        }
    }

    fn has_header(&self) -> bool {
        matches!(self, Self::Header(_) | Self::Headers(_))
    }
}

/// The lines of a table whose header is `name`, with a comment before each header.
fn write_table(text: &mut String, name: &str, table: &BTreeMap<String, Node>) {
    for (key, node) in table.iter().filter(|(_, node)| !node.has_header()) {
        writeln!(text, "{key} = {} # of {key}", node.inline()).unwrap();
    }
    for (key, node) in table {
        let name = match name {
            "" => key.clone(),
            name => format!("{name}.{key}"),
        };
        match node {
            Node::Header(inner) => {
                writeln!(text, "\n# about {key}\n[{name}]").unwrap();
                write_table(text, &name, inner);
            }
            Node::Headers(tables) => {
                for inner in tables {
                    writeln!(text, "\n# about {key}\n[[{name}]]").unwrap();
                    write_table(text, &name, inner);
                }
            }
            _ => {}
        }
    }
}

fn table(node: impl Strategy<Value = Node>) -> impl Strategy<Value = BTreeMap<String, Node>> {
    prop::collection::btree_map("[a-c]", node, 0..4)
}

fn node() -> impl Strategy<Value = Node> {
    let leaf = prop_oneof![
        any::<i32>().prop_map(Node::Number),
        "[a-z =\\[\\].\"'#]{0,6}".prop_map(Node::Text)
    ];
    leaf.prop_recursive(4, 24, 4, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..3).prop_map(Node::List),
            table(inner.clone()).prop_map(Node::Braces),
            table(inner.clone()).prop_map(Node::Header),
            prop::collection::vec(table(inner), 1..3).prop_map(Node::Headers),
        ]
    })
}

/// All places below a table, and whether each is an entry of a list of tables with headers.
fn places(table: &BTreeMap<String, Node>, at: &Key, found: &mut Vec<(Key, bool)>) {
    for (name, node) in table {
        let at = at.name(name);
        match node {
            Node::Header(inner) => places(inner, &at, found),
            Node::Headers(tables) => {
                for (k, inner) in tables.iter().enumerate() {
                    places(inner, &at.entry(k), found);
                    found.push((at.entry(k), true));
                }
            }
            value => places_inside(value, &at, found),
        }
        found.push((at, false));
    }
}

/// All places inside of a value, in which there are no headers.
fn places_inside(node: &Node, at: &Key, found: &mut Vec<(Key, bool)>) {
    let mut visit = |key: Key, node: &Node| {
        places_inside(node, &key, found);
        found.push((key, false));
    };
    match node {
        Node::Number(_) | Node::Text(_) => {}
        Node::List(items) => {
            for (k, item) in items.iter().enumerate() {
                visit(at.entry(k), item);
            }
        }
        Node::Braces(table) | Node::Header(table) => {
            for (name, inner) in table {
                visit(at.name(name), inner);
            }
        }
        Node::Headers(tables) => {
            let lists = tables.iter().cloned().map(Node::Braces);
            for (k, table) in lists.enumerate() {
                visit(at.entry(k), &table);
            }
        }
    }
}

/// The value at a place.
fn at<'a>(root: &'a mut toml::Value, key: &Key) -> &'a mut toml::Value {
    key.parts().iter().fold(root, |value, part| match part {
        KeyPart::Name(name) => &mut value[name.as_str()],
        KeyPart::Entry(k) => &mut value[*k],
    })
}

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    /// The text of an edited document, read anew, differs from what it was in the edited place alone. Only an
    /// entry of a list of tables with headers that would become something else is refused.
    #[test]
    fn the_text_has_what_was_asked_for(
        document in table(node()),
        place in any::<Index>(),
        value in node(),
        new_name in prop::option::of("[a-d]"),
    ) {
        let mut text = String::new();
        write_table(&mut text, "", &document);
        let mut expected: toml::Value = toml::from_str(&text).unwrap();
        let mut all = Vec::new();
        places(&document, &Key::root(), &mut all);
        prop_assume!(!all.is_empty());
        let (mut key, mut is_entry) = all[place.index(all.len())].clone();
        // Also keys that a table does not have yet.
        if let (Some(name), true) = (new_name, at(&mut expected, &key).is_table()) {
            let table = at(&mut expected, &key).as_table_mut().unwrap();
            table.entry(name.clone()).or_insert(toml::Value::Boolean(false));
            (key, is_entry) = (key.name(&name), false);
        }
        let edit = format!("{key}={}", value.inline());
        let value: toml::Table = toml::from_str(&format!("v = {}", value.inline())).unwrap();
        let is_table = value["v"].is_table();
        *at(&mut expected, &key) = value["v"].clone();
        let mut edited: DocumentMut = text.parse().unwrap();
        let done = apply(&mut edited, std::slice::from_ref(&edit));
        if is_entry && !is_table {
            let refused = done.as_ref().is_err_and(|e| e.to_string().contains("are tables"));
            prop_assert!(refused, "{edit}: {done:?}");
            prop_assert_eq!(edited.to_string(), text, "a refused edit changes nothing");
        } else {
            prop_assert!(done.is_ok(), "{edit}: {done:?}");
            let found: toml::Value = toml::from_str(&edited.to_string()).unwrap();
            prop_assert_eq!(found, expected, "{} in\n{}\nmakes\n{}", edit, text, edited);
        }
    }
}

/// A list of tables with headers is there, whatever stands between its headers.
const BODIES: &str = "[sheet]
a = 1
# the first
[[obstacle]]
shape = 1
[obstacle.pose]
x = 1
# the second
[[obstacle]]
shape = 2
[sheet.mesh]
b = 2
";

#[test]
fn entries_of_lists_of_tables_are_replaced_in_their_place() {
    let edit = |edit: &str| {
        let mut document: DocumentMut = BODIES.parse().unwrap();
        apply(&mut document, &[edit.to_owned()]).map(|()| document.to_string())
    };
    let (first, second) = BODIES.split_once("# the second").unwrap();
    assert_eq!(
        edit("obstacle[0]={shape=3, pose={y=1}}").unwrap(),
        format!(
            "{}shape = 3\npose = {{y=1}}\n# the second{second}",
            first.split_once("shape").unwrap().0
        )
    );
    assert_eq!(
        edit("obstacle[1]={}").unwrap(),
        BODIES.replace("shape = 2\n", "")
    );
    for wrong in ["1", "\"x\"", "[]", "[{shape=1}]", "{shape=..}"] {
        let error = edit(&format!("obstacle[1]={wrong}")).unwrap_err();
        assert!(error.problem.message.ends_with("are tables"), "{error}");
        assert!(error.advice().unwrap().contains("braces"));
    }
    for wrong in [
        "obstacle[2]={shape=1}",
        "obstacle.shape=1",
        "sheet[0]=1",
        "sheet.a.b=1",
        "new[0]=1",
    ] {
        let error = edit(wrong).unwrap_err();
        assert!(
            error.problem.message.starts_with("the scene has no place"),
            "{error}"
        );
    }
    for wrong in [
        "obstacle[0.shape=1",
        "obstacle[0]].shape=1",
        "=1",
        "sheet..a=1",
    ] {
        let error = edit(wrong).unwrap_err();
        assert!(error.problem.message.ends_with("is not a key"), "{error}");
        assert!(error.to_string().contains(wrong), "{error}");
    }
}

/// A list with one entry is named as its entry is.
#[test]
fn the_number_of_the_only_entry_may_be_left_out() {
    for (text, edit, expected) in [
        (
            "[[sheet]]\nmass = 1\n",
            "sheet.mass=2",
            "[[sheet]]\nmass = 2\n",
        ),
        (
            "sheet = [{ mass = 1 }]\n",
            "sheet.mass=2",
            "sheet = [{ mass = 2 }]\n",
        ),
        (
            "[[body]]\n[[body.part]]\na = 1\n",
            "body.part.a=2",
            "[[body]]\n[[body.part]]\na = 2\n",
        ),
    ] {
        let mut document: DocumentMut = text.parse().unwrap();
        apply(&mut document, &[edit.to_owned()]).unwrap();
        assert_eq!(document.to_string(), expected);
    }
    let mut two: DocumentMut = "[[sheet]]\n[[sheet]]\n".parse().unwrap();
    assert!(apply(&mut two, &["sheet.mass=2".to_owned()]).is_err());
}
