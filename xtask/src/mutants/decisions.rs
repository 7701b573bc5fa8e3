//! Conditions of decisions that have several.

use anyhow::{Context as _, Result};
use syn::{
    Attribute, BinOp, Expr, ExprBinary, ImplItemFn, ItemFn, ItemImpl, ItemMod, MetaList,
    TraitItemFn,
    spanned::Spanned as _,
    visit::{self, Visit},
};

use super::{
    mutant::{Genre, Mutant},
    source_text::{SourceText, place_of},
};

/// Returns the conditions of decisions that have several, each with both constants.
///
/// A test that notices the constant has seen a case in which this condition alone decides.
///
/// # Errors
/// An error if the source is not Rust.
pub(super) fn conditions(name: &str, text: &str) -> Result<Vec<Mutant>> {
    let file = syn::parse_file(text).with_context(|| format!("{name}: not Rust"))?;
    let source = SourceText::new(text);
    let mut decisions = Decisions {
        source: &source,
        name,
        mutants: vec![],
        functions: vec![],
    };
    decisions.visit_file(&file);
    Ok(decisions.mutants)
}

/// Finds the conditions of decisions that have several.
struct Decisions<'a> {
    source: &'a SourceText<'a>,
    name: &'a str,
    mutants: Vec<Mutant>,
    functions: Vec<String>,
}

impl Decisions<'_> {
    fn function(&mut self, name: String, visit: impl FnOnce(&mut Self)) {
        self.functions.push(name);
        visit(self);
        self.functions.pop();
    }

    /// Takes the conditions of a decision apart.
    fn decision(&mut self, expression: &Expr) {
        match expression {
            Expr::Binary(binary) if is_junction(&binary.op) => {
                self.decision(&binary.left);
                self.decision(&binary.right);
            }
            Expr::Paren(inside) if is_decision(&inside.expr) => self.decision(&inside.expr),
            // The pattern of a chain.
            Expr::Let(pattern) => self.visit_expr(&pattern.expr),
            condition => {
                let Some(function) = self.functions.last() else {
                    return;
                };
                let span = place_of(condition.span());
                let range = self.source.range(span).unwrap_or_default();
                let text = self.source.get(&range);
                let text: Vec<_> = text.split_whitespace().collect();
                for constant in ["true", "false"] {
                    self.mutants.push(Mutant {
                        file: self.name.to_owned(),
                        genre: Genre::Condition,
                        span,
                        replacement: constant.to_owned(),
                        change: format!(
                            "replace condition {} with {constant} in {function}",
                            text.join(" ")
                        ),
                    });
                }
                self.visit_expr(condition);
            }
        }
    }
}

impl<'ast> Visit<'ast> for Decisions<'_> {
    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        if !is_left_out(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_impl(&mut self, implementation: &'ast ItemImpl) {
        if !is_left_out(&implementation.attrs) {
            visit::visit_item_impl(self, implementation);
        }
    }

    fn visit_item_fn(&mut self, function: &'ast ItemFn) {
        self.function(function.sig.ident.to_string(), |decisions| {
            visit::visit_item_fn(decisions, function);
        });
    }

    fn visit_impl_item_fn(&mut self, function: &'ast ImplItemFn) {
        self.function(function.sig.ident.to_string(), |decisions| {
            visit::visit_impl_item_fn(decisions, function);
        });
    }

    fn visit_trait_item_fn(&mut self, function: &'ast TraitItemFn) {
        self.function(function.sig.ident.to_string(), |decisions| {
            visit::visit_trait_item_fn(decisions, function);
        });
    }

    fn visit_expr_binary(&mut self, binary: &'ast ExprBinary) {
        if is_junction(&binary.op) {
            self.decision(&Expr::Binary(binary.clone()));
        } else {
            visit::visit_expr_binary(self, binary);
        }
    }
}

/// Returns true for an operator that joins conditions.
pub(super) fn is_junction(operator: &BinOp) -> bool {
    matches!(operator, BinOp::And(_) | BinOp::Or(_))
}

fn is_decision(expression: &Expr) -> bool {
    match expression {
        Expr::Binary(binary) => is_junction(&binary.op),
        Expr::Paren(inside) => is_decision(&inside.expr),
        _ => false,
    }
}

/// Returns true for code that the programs do not have: tests within sources, and what another
/// feature would add.
pub(super) fn is_left_out(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let is_left_out = |list: &MetaList| {
            let condition: String = list.tokens.to_string().split_whitespace().collect();
            ["test", "feature=\"defmt\""].contains(&condition.as_str())
        };
        attribute.path().is_ident("cfg") && attribute.meta.require_list().is_ok_and(is_left_out)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::schema;

    #[test]
    fn conditions_are_those_of_decisions_that_have_several() {
        let source = "fn f() { if a && (b || !c) && let Some(d) = e && g(h > 1) {} if i {} }
            mod m { fn g() -> bool { (a == b) | (c && d) } }
            #[cfg(feature = \"defmt\")] impl F for G { fn h() { j && k } }
            #[cfg(test)] mod tests { fn l() { j && k } }";
        let mutants = conditions("a.rs", source).unwrap();
        let changes: Vec<_> = mutants
            .iter()
            .map(|mutant| mutant.change.as_str())
            .collect();
        let both = |condition: &str, function: &str| {
            ["true", "false"].map(|constant| {
                format!("replace condition {condition} with {constant} in {function}")
            })
        };
        let expected = [
            both("a", "f"),
            both("b", "f"),
            both("!c", "f"),
            both("g(h > 1)", "f"),
            both("c", "g"),
            both("d", "g"),
        ];
        assert_eq!(changes, expected.concat());
        let numbered: Vec<_> = mutants.iter().enumerate().collect();
        let schema = schema::write(source, &numbered).unwrap();
        assert_eq!(schema.without_place, [0; 0]);
        assert!(syn::parse_file(&schema.text).is_ok(), "{}", schema.text);
    }
}
