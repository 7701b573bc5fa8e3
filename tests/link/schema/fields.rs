//! Units and meaning of fields and variants, from the documentation of their types.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::{Map, Value, json};
use serde_reflection::{ContainerFormat, Registry, VariantFormat};
use syn::{Attribute, Expr, ExprLit, Fields, Item, Lit, Meta};

/// Endings of names that state a unit, with the unit; longer ones first.
const UNITS: [(&str, &str); 30] = [
    ("_per_mm_s2", "s²/mm"),
    ("_per_mm_s", "s/mm"),
    ("_percent", "%"),
    ("_mm_s3", "mm/s³"),
    ("_mm_s2", "mm/s²"),
    ("_deg_s", "°/s"),
    ("_deg_per_s", "°/s"),
    ("_mm_s", "mm/s"),
    ("_m_s", "m/s"),
    ("_per_s", "1/s"),
    ("_mm2", "mm²"),
    ("_mm3", "mm³"),
    ("_mm4", "mm⁴"),
    ("_ppm", "ppm"),
    ("_deg", "°"),
    ("_rad", "rad"),
    ("_baud", "Bd"),
    ("_bytes", "bytes"),
    ("_px", "px"),
    ("_hz", "Hz"),
    ("_nm", "nm"),
    ("_um", "µm"),
    ("_mm", "mm"),
    ("_us", "µs"),
    ("_ms", "ms"),
    ("_ns", "ns"),
    ("_m", "m"),
    ("_s", "s"),
    ("_n", "N"),
    ("_c", "°C"),
];

/// Units that documentation states in place of the name, behind a comma.
const STATED: [&str; 13] = [
    "mm", "mm⁻¹", "mm⁻²", "mm⁻⁴", "mm⁻⁶", "µm", "µs", "ppm", "bytes", "px", "1/s", "s", "°C",
];

/// Documentation of a type's fields or variants, by their names.
type Docs = BTreeMap<String, String>;

/// Returns the note of each field and variant of the types that has one, under `Type.field`,
/// `Type.Variant` or `Type.Variant.field`.
pub(super) fn notes(registry: &Registry) -> Map<String, Value> {
    let mut sources = Vec::new();
    for folder in ["src", "crates/kernel/src"] {
        read(Path::new(folder), &mut sources);
    }
    let mut notes = Map::new();
    for (name, format) in registry {
        let members = members(format);
        // Types of one name are told apart by their members.
        let mut docs = sources
            .iter()
            .filter(|(one, docs)| one == name && members.iter().all(|it| docs.contains_key(it)));
        let found = docs.next();
        if members.is_empty() || name == "Result" {
            continue;
        }
        // The quantities are made by a macro, and have no more than their names.
        let Some((_, docs)) = found else {
            assert_eq!(name, "Quantity", "its source has not been found");
            continue;
        };
        for member in members {
            if let Some(note) = note(&member, &docs[&member]) {
                notes.insert(format!("{name}.{member}"), note);
            }
        }
    }
    notes
}

fn note(member: &str, doc: &str) -> Option<Value> {
    let name = member.rsplit('.').next()?;
    let named = UNITS.iter().find(|(ending, _)| name.ends_with(ending));
    let stated = STATED.into_iter().find(|unit| {
        doc.split(", ").skip(1).any(|part| {
            part.strip_prefix(*unit)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with([' ', '.', ',', ';', ':']))
        })
    });
    let counted = doc.starts_with("Number of bytes").then_some("bytes");
    let unit = named.map(|(_, unit)| *unit).or(stated).or(counted);
    match (unit, doc) {
        (None, "") => None,
        (None, doc) => Some(json!({ "meaning": doc })),
        (Some(unit), "") => Some(json!({ "unit": unit })),
        (Some(unit), doc) => Some(json!({ "unit": unit, "meaning": doc })),
    }
}

/// Names of a container's fields and variants, and of its variants' fields.
fn members(format: &ContainerFormat) -> Vec<String> {
    match format {
        ContainerFormat::Struct(fields) => fields.iter().map(|field| field.name.clone()).collect(),
        ContainerFormat::Enum(variants) => variants
            .values()
            .flat_map(|variant| {
                let fields: Vec<String> = match &variant.value {
                    VariantFormat::Struct(fields) => fields
                        .iter()
                        .map(|field| format!("{}.{}", variant.name, field.name))
                        .collect(),
                    _ => Vec::new(),
                };
                std::iter::once(variant.name.clone()).chain(fields)
            })
            .collect(),
        _ => Vec::new(),
    }
}

/// Reads the types of all sources below a folder, in the order of their paths.
fn read(folder: &Path, types: &mut Vec<(String, Docs)>) {
    let mut paths: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|it| it.unwrap().path())
        .collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            read(&path, types);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let file = syn::parse_file(&fs::read_to_string(&path).unwrap()).unwrap();
            types.extend(file.items.iter().filter_map(docs));
        }
    }
}

fn docs(item: &Item) -> Option<(String, Docs)> {
    let mut docs = Docs::new();
    let name = match item {
        Item::Struct(item) => {
            insert("", &item.fields, &mut docs);
            &item.ident
        }
        Item::Enum(item) => {
            for variant in &item.variants {
                docs.insert(variant.ident.to_string(), doc(&variant.attrs));
                insert(&format!("{}.", variant.ident), &variant.fields, &mut docs);
            }
            &item.ident
        }
        _ => return None,
    };
    Some((name.to_string(), docs))
}

fn insert(before: &str, fields: &Fields, docs: &mut Docs) {
    for field in fields {
        if let Some(name) = &field.ident {
            docs.insert(format!("{before}{name}"), doc(&field.attrs));
        }
    }
}

/// The first paragraph of a documentation, without links.
fn doc(attributes: &[Attribute]) -> String {
    let lines = attributes
        .iter()
        .filter_map(|attribute| match &attribute.meta {
            Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
                Expr::Lit(ExprLit {
                    lit: Lit::Str(text),
                    ..
                }) => Some(text.value().trim().to_owned()),
                _ => None,
            },
            _ => None,
        });
    let lines: Vec<String> = lines.take_while(|line| !line.is_empty()).collect();
    without_links(&lines.join(" "))
}

/// Replaces `[text](target)` and `[text]` by `text`.
fn without_links(text: &str) -> String {
    let mut found = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("[`") {
        found.push_str(before);
        let (name, after) = after.split_once("`]").unwrap_or((after, ""));
        found.push('`');
        found.push_str(name);
        found.push('`');
        rest = match after.strip_prefix('(') {
            Some(target) => target.split_once(')').map_or("", |(_, after)| after),
            None => after,
        };
    }
    found.push_str(rest);
    found
}
