//! Places of the mutants in a source.

use std::{cmp::Reverse, collections::BTreeMap, ops::Range};

use anyhow::{Context as _, Result};
use syn::{
    Arm, Block, Expr, ExprBinary, ExprMatch, ExprStruct, ExprUnary, ImplItemFn, ItemFn, ItemImpl,
    ItemMod, Pat, ReturnType, TraitItemFn,
    spanned::Spanned as _,
    visit::{self, Visit},
};

use super::{
    decisions::{is_junction, is_left_out},
    edits::{Change, PlaceOfChange},
    mutant::{Genre, Mutant},
    source_text::SourceText,
};

/// Returns the changes of mutants, each of which is given with its number. Those for which there is
/// no place have none.
///
/// # Errors
/// An error if the source is not Rust.
pub(super) fn changes(text: &str, mutants: &[(usize, &Mutant)]) -> Result<Vec<Change>> {
    let file = syn::parse_file(text).context("not Rust")?;
    let source = SourceText::new(text);
    let mut search = Search {
        source: &source,
        wanted: BTreeMap::new(),
        found: vec![],
    };
    for (number, mutant) in mutants {
        if let Some(range) = source.range(mutant.span) {
            let wanted = search.wanted.entry(range.start).or_default();
            wanted.push((*number, *mutant, range));
        }
    }
    search.visit_file(&file);
    Ok(search.found)
}

/// A mutant with its number and its part of the source.
type Wanted<'a> = (usize, &'a Mutant, Range<usize>);

/// Finds the parts of a source that mutants change.
struct Search<'a> {
    source: &'a SourceText<'a>,
    /// Mutants by the offset of their beginning.
    wanted: BTreeMap<usize, Vec<Wanted<'a>>>,
    found: Vec<Change>,
}

impl Search<'_> {
    /// Changes an expression for all mutants of a genre at an offset.
    fn change(
        &mut self,
        genre: Genre,
        at: usize,
        around: Option<Range<usize>>,
        text: impl Fn(&Mutant, &Range<usize>) -> String,
    ) {
        let Some(around) = around else { return };
        for (number, mutant, range) in self.wanted.get(&at).into_iter().flatten() {
            if mutant.genre == genre {
                self.found.push(Change {
                    place: PlaceOfChange::Around(around.start, Reverse(around.end)),
                    number: *number,
                    text: text(mutant, range),
                });
            }
        }
    }

    fn arm(&mut self, arm: &Arm, has_rest: bool) {
        let source = self.source;
        let guard = arm.guard.as_ref().map(|(_, guard)| guard);
        let guard = guard.and_then(|guard| source.range_of(guard.span()));
        let whole = source.range_of(arm.span());
        let pattern = source.range_of(arm.pat.span());
        if has_rest && let (Some(whole), Some(pattern)) = (whole, pattern) {
            let place = match &guard {
                Some(guard) => PlaceOfChange::Around(guard.start, Reverse(guard.end)),
                None => PlaceOfChange::Guard(pattern.end),
            };
            for (number, mutant, _) in self.wanted.get(&whole.start).into_iter().flatten() {
                if mutant.genre == Genre::MatchArm {
                    self.found.push(Change {
                        place,
                        number: *number,
                        text: "false".to_owned(),
                    });
                }
            }
        }
        if let Some(range) = guard {
            let at = range.start;
            self.change(Genre::MatchArmGuard, at, Some(range), |mutant, _| {
                mutant.replacement.clone()
            });
        }
    }

    fn function(&mut self, output: &ReturnType, block: &Block, visit: impl FnOnce(&mut Self)) {
        let Some(body) = self.source.range_of(block.span()) else {
            return;
        };
        let output = self.source.range_of(output.span()).unwrap_or_default();
        // Its bodies cannot be of two types.
        let is_any_type = self.source.get(&output).contains("impl ");
        let wanted = self.wanted.range(body.clone());
        let of_function = wanted.flat_map(|(_, mutants)| mutants);
        for (number, mutant, range) in of_function {
            if mutant.genre == Genre::FnValue && range.end <= body.end {
                // A function within this one is visited later, and is the one that is meant.
                self.found.retain(|change| change.number != *number);
                if is_any_type {
                    continue;
                }
                self.found.push(Change {
                    place: PlaceOfChange::Before(body.start + 1),
                    number: *number,
                    text: format!("return {};", mutant.replacement),
                });
            }
        }
        visit(self);
    }
}

impl<'ast> Visit<'ast> for Search<'_> {
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
        self.function(&function.sig.output, &function.block, |search| {
            visit::visit_item_fn(search, function);
        });
    }

    fn visit_impl_item_fn(&mut self, function: &'ast ImplItemFn) {
        self.function(&function.sig.output, &function.block, |search| {
            visit::visit_impl_item_fn(search, function);
        });
    }

    fn visit_trait_item_fn(&mut self, function: &'ast TraitItemFn) {
        match &function.default {
            Some(block) => self.function(&function.sig.output, block, |search| {
                visit::visit_trait_item_fn(search, function);
            }),
            None => visit::visit_trait_item_fn(self, function),
        }
    }

    fn visit_expr_binary(&mut self, binary: &'ast ExprBinary) {
        let source = self.source;
        let operator = source.range_of(binary.op.span());
        let sides = [&binary.left, &binary.right].map(|side| source.range_of(side.span()));
        // A pattern of a chain is no operand of another operator.
        if let (Some(operator), [Some(left), Some(right)]) = (operator, sides)
            && !has_pattern(binary)
        {
            let around = source.range_of(binary.span());
            self.change(
                Genre::BinaryOperator,
                operator.start,
                around,
                |mutant, _| {
                    let [left, right] = [&left, &right].map(|side| source.get(side));
                    format!("({left}) {} ({right})", mutant.replacement)
                },
            );
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'ast ExprUnary) {
        let source = self.source;
        let around = source.range_of(unary.span());
        if let Some(Range { start, .. }) = around {
            self.change(
                Genre::UnaryOperator,
                start,
                around.clone(),
                |mutant, range| {
                    let end = around.clone().unwrap_or_default().end;
                    format!("{}{}", mutant.replacement, source.get(&(range.end..end)))
                },
            );
        }
        visit::visit_expr_unary(self, unary);
    }

    fn visit_expr_struct(&mut self, expression: &'ast ExprStruct) {
        let source = self.source;
        let around = source.range_of(expression.span());
        for field in &expression.fields {
            let Some(start) = source.range_of(field.span()).map(|range| range.start) else {
                continue;
            };
            self.change(Genre::StructField, start, around.clone(), |_, range| {
                let Range { start, end } = around.clone().unwrap_or_default();
                let before = source.get(&(start..range.start));
                let after = source.get(&(range.end..end)).trim_start();
                format!(
                    "{before}{}",
                    after.strip_prefix(',').unwrap_or(after).trim_start()
                )
            });
        }
        visit::visit_expr_struct(self, expression);
    }

    fn visit_expr_match(&mut self, expression: &'ast ExprMatch) {
        // Without an arm for the rest, a match without one of its arms is no program.
        let is_rest = |pattern: &Pat| match pattern {
            Pat::Wild(_) => true,
            // A name with a capital is that of a variant or of a constant.
            Pat::Ident(name) => name.ident.to_string().starts_with(char::is_lowercase),
            _ => false,
        };
        let mut arms = expression.arms.iter();
        let has_rest = arms.any(|arm| arm.guard.is_none() && is_rest(&arm.pat));
        for arm in &expression.arms {
            self.arm(arm, has_rest);
        }
        visit::visit_expr_match(self, expression);
    }

    fn visit_expr(&mut self, expression: &'ast Expr) {
        if let Some(range) = self.source.range_of(expression.span()) {
            let end = range.end;
            let at = range.start;
            for (number, mutant, wanted) in self.wanted.get(&at).into_iter().flatten() {
                if mutant.genre == Genre::Condition && wanted.end == end {
                    self.found.retain(|change| change.number != *number);
                    self.found.push(Change {
                        place: PlaceOfChange::Around(at, Reverse(end)),
                        number: *number,
                        text: mutant.replacement.clone(),
                    });
                }
            }
        }
        visit::visit_expr(self, expression);
    }
}

/// Returns true for a chain of conditions with a pattern among them.
fn has_pattern(binary: &ExprBinary) -> bool {
    [&binary.left, &binary.right]
        .into_iter()
        .any(|side| match &**side {
            Expr::Let(_) => true,
            Expr::Binary(side) if is_junction(&side.op) => has_pattern(side),
            _ => false,
        })
}
