//! Insertion of values into a TOML document, whose comments and order stay.

use std::str::FromStr;

use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// Returns the table of a name; inserts it if there is none.
pub(crate) fn table<'a>(
    document: &'a mut DocumentMut,
    name: &str,
) -> Option<&'a mut dyn TableLike> {
    let item = document.entry(name).or_insert_with(|| {
        let mut table = Table::new();
        table.decor_mut().set_prefix("\n");
        Item::Table(table)
    });
    item.as_table_like_mut()
}

/// Replaces a value and keeps the comment after it, or adds the value.
pub(crate) fn put(table: &mut dyn TableLike, key: &str, mut value: Value) {
    if let Some(old) = table.get_mut(key).and_then(Item::as_value_mut) {
        *value.decor_mut() = old.decor().clone();
        *old = value;
    } else {
        table.insert(key, Item::Value(value));
    }
}

/// Formats a number to its last bit, with an exponent if it is small.
pub(crate) fn float(number: f64) -> Value {
    Value::from_str(&format!("{number:e}"))
        .ok()
        .filter(Value::is_float)
        .unwrap_or_else(|| Value::from(number))
}
