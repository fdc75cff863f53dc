//! A type's name means one thing in the whole workspace: no two types share one, be they of different rooms or of tests.

use super::{File, files};
use std::collections::BTreeMap;
use syn::visit::{self, Visit};
use syn::{Ident, Item, ItemMacro};

/// Names of the types that a file defines: structs, enums, unions, traits and aliases, those within functions too. A
/// trait's own types are not among them, since they are called by the trait's name.
#[derive(Default)]
struct DefinedTypes(Vec<String>);

impl Visit<'_> for DefinedTypes {
    fn visit_item(&mut self, item: &Item) {
        let name: Option<&Ident> = match item {
            Item::Struct(of) => Some(&of.ident),
            Item::Enum(of) => Some(&of.ident),
            Item::Union(of) => Some(&of.ident),
            Item::Trait(of) => Some(&of.ident),
            Item::TraitAlias(of) => Some(&of.ident),
            Item::Type(of) => Some(&of.ident),
            _ => None,
        };
        self.0.extend(name.map(ToString::to_string));
        visit::visit_item(self, item);
    }

    /// What is in a macro is words to the parser. Names that the macro makes from its arguments are not seen.
    fn visit_item_macro(&mut self, item: &ItemMacro) {
        let text = item.mac.tokens.to_string();
        let words: Vec<&str> = text.split_whitespace().collect();
        let named = words.windows(2).filter(|pair| ["struct", "enum", "union", "trait"].contains(&pair[0]));
        self.0
            .extend(named.filter(|pair| syn::parse_str::<Ident>(pair[1]).is_ok()).map(|pair| pair[1].into()));
    }
}

/// Names that several types share, with the files that define them.
fn shared_names(files: &[File]) -> Vec<String> {
    let mut places: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for file in files {
        let parsed = syn::parse_file(&file.text).unwrap_or_else(|error| panic!("{}: {error}", file.path));
        let mut defined = DefinedTypes::default();
        defined.visit_file(&parsed);
        for name in defined.0 {
            places.entry(name).or_default().push(&file.path);
        }
    }
    places.retain(|_, places| places.len() > 1);
    places.iter().map(|(name, places)| format!("{name} is in {}", places.join(" and "))).collect()
}

#[test]
fn a_types_name_means_one_thing() {
    let all: Vec<File> = ["benches", "crates", "src", "tests"]
        .into_iter()
        .flat_map(|folder| files(folder, &[".rs"]))
        .collect();
    assert!(all.len() > 200, "the sources were not found");
    let shared = shared_names(&all);
    assert!(shared.is_empty(), "call one of them by another name, or make them one type: {shared:#?}");
}

#[test]
fn types_of_one_name_are_found_wherever_they_are() {
    let shared = |texts: &[&str]| {
        let file = |(at, text): (usize, &&str)| File { path: format!("{at}.rs"), text: text.to_string() };
        shared_names(&texts.iter().enumerate().map(file).collect::<Vec<_>>())
    };
    for other in [
        "enum Corner {}",
        "pub trait Corner {}",
        "type Corner = [f32; 3];",
        "#[cfg(test)]\nmod tests {\n    pub(super) struct Corner;\n}",
        "fn lay() {\n    union Corner { a: u32 }\n}",
        "shapes! { pub struct Corner { x: f32 } }",
    ] {
        assert_eq!(shared(&["pub struct Corner<T>(T);", other]), ["Corner is in 0.rs and 1.rs"], "{other}");
    }
    assert_eq!(
        shared(&["struct Corner;\nmod mesh {\n    struct Corner;\n}"]),
        ["Corner is in 0.rs and 0.rs"]
    );
    let others = [
        "struct Corner;",
        "impl Iterator for Corners { type Corner = u32; }\n// struct Corner;",
        "trait Shape { type Corner; }\nuse mesh::Corner;",
        "const TEXT: &str = \"struct Corner;\";\nfn corner<Corner>(of: Corner) {}",
        "shapes! { struct $Corner; enum Edge {} }",
    ];
    assert_eq!(shared(&others), [""; 0]);
}
