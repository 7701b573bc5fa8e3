//! Function of the library, read from its source: what it computes, operation by operation.
//!
//! The order of the operations in a proof is that of the code, since it comes from there. A
//! construct that is not arithmetic is an error, unless the claim gives the name that it defines.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result, bail};
use syn::{BinOp, Block, Expr, ExprClosure, Local, Member, Pat, Stmt, UnOp};

use super::{
    expression::Expression,
    source::{Function, Source, number},
};

/// Computation of a script: definitions in their order.
#[derive(Clone, Debug, Default)]
pub(super) struct Definitions {
    /// Names with their expressions.
    pub(super) lines: Vec<(String, Expression)>,
    /// Numbers that the claim has to give.
    pub(super) inputs: Vec<String>,
}

/// Way in which a function is read.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reading<'a> {
    /// True if conditions hold: what is behind an `if` is computed.
    pub(super) conditions_hold: bool,
    /// Names that the claim gives a range, whatever the source defines them to be.
    pub(super) given: &'a [&'a str],
}

/// Results of a function by name: of a structure its fields, of an array `0`, `1` and so on, of
/// another expression `result`.
type Results = BTreeMap<String, Expression>;

/// Reads a function: its definitions, and its results.
///
/// # Errors
/// An error if a result that is wanted is not arithmetic.
pub(super) fn read(
    source: &Source,
    function: &str,
    reading: Reading<'_>,
    wanted: &[&str],
) -> Result<(Definitions, Results)> {
    let mut reader = Reader {
        source,
        reading,
        definitions: Definitions::default(),
        scope: Scope::default(),
    };
    let Function { body, .. } = source.function(function)?.clone();
    let results = reader
        .body(&body, wanted)
        .with_context(|| function.to_owned())?;
    Ok((reader.definitions, results))
}

/// Names of a function while it is read.
#[derive(Clone, Debug, Default)]
struct Scope {
    values: BTreeMap<String, Expression>,
    closures: BTreeMap<String, ExprClosure>,
    /// Names whose values could not be read, and why.
    unread: BTreeMap<String, String>,
}

impl Scope {
    fn set(&mut self, name: &str, value: Expression) {
        self.unread.remove(name);
        self.values.insert(name.to_owned(), value);
    }

    /// Takes the value of a name away, so that no earlier one stands for it.
    fn leave_unread(&mut self, name: &str, why: &anyhow::Error) {
        self.values.remove(name);
        self.unread.insert(name.to_owned(), format!("{why:#}"));
    }
}

struct Reader<'a> {
    source: &'a Source,
    reading: Reading<'a>,
    definitions: Definitions,
    scope: Scope,
}

impl Reader<'_> {
    fn body(&mut self, body: &Block, wanted: &[&str]) -> Result<Results> {
        let Some((last, statements)) = body.stmts.split_last() else {
            bail!("it is empty");
        };
        for statement in statements {
            self.statement(statement)?;
        }
        let Stmt::Expr(last, None) = last else {
            bail!("it ends without a result");
        };
        let is_wanted = |name: &str| wanted.contains(&name);
        let mut results = Results::new();
        match last {
            Expr::Struct(structure) => {
                for field in &structure.fields {
                    let name = member(&field.member);
                    if is_wanted(&name) {
                        let value = self.expression(&field.expr)?;
                        results.insert(name.clone(), self.define(&name, value));
                    }
                }
            }
            Expr::Array(array) => {
                for (index, element) in array.elems.iter().enumerate() {
                    let name = index.to_string();
                    if is_wanted(&name) {
                        let value = self.expression(element)?;
                        results.insert(name.clone(), self.define(&format!("at_{name}"), value));
                    }
                }
            }
            other => {
                let value = self.expression(other)?;
                results.insert("result".to_owned(), self.define("result", value));
            }
        }
        for name in wanted {
            if !results.contains_key(*name) {
                bail!("it has no result {name}");
            }
        }
        Ok(results)
    }

    fn statement(&mut self, statement: &Stmt) -> Result<()> {
        match statement {
            Stmt::Local(local) => self.local(local),
            Stmt::Expr(Expr::Assign(assign), _) => {
                let name = place(&assign.left)?;
                let value = self.expression(&assign.right)?;
                self.bind(&name, value);
                Ok(())
            }
            Stmt::Expr(Expr::Binary(binary), _) => {
                let Some((sign, true)) = sign(&binary.op) else {
                    bail!("a statement that is not arithmetic");
                };
                let name = place(&binary.left)?;
                let [left, right] = [
                    self.expression(&binary.left)?,
                    self.expression(&binary.right)?,
                ];
                self.bind(&name, operation(sign, left, right));
                Ok(())
            }
            Stmt::Expr(Expr::If(condition), _) if condition.else_branch.is_none() => {
                if self.reading.conditions_hold {
                    for statement in &condition.then_branch.stmts {
                        self.statement(statement)?;
                    }
                }
                Ok(())
            }
            _ => bail!("a statement that is not arithmetic"),
        }
    }

    fn local(&mut self, local: &Local) -> Result<()> {
        let Some(init) = &local.init else {
            bail!("a name without a value");
        };
        match (pattern(&local.pat), &*init.expr) {
            (Pat::Ident(name), Expr::Closure(closure)) => {
                let name = name.ident.to_string();
                self.scope.closures.insert(name, closure.clone());
            }
            (Pat::Ident(name), _) if self.is_given(&name.ident.to_string()) => {
                let name = name.ident.to_string();
                let input = self.input(&name);
                self.scope.set(&name, input);
            }
            (Pat::Ident(name), value) => {
                let name = name.ident.to_string();
                match self.expression(value) {
                    Ok(value) => self.bind(&name, value),
                    // A name that no result needs may stand for anything.
                    Err(error) => self.scope.leave_unread(&name, &error),
                }
            }
            (Pat::Tuple(names), Expr::Tuple(values)) => {
                for (name, value) in names.elems.iter().zip(&values.elems) {
                    let Pat::Ident(name) = name else {
                        bail!("a pattern of patterns");
                    };
                    let value = self.expression(value)?;
                    self.bind(&name.ident.to_string(), value);
                }
            }
            _ => bail!("a pattern that is not read"),
        }
        Ok(())
    }

    fn is_given(&self, name: &str) -> bool {
        self.reading.given.contains(&name)
    }

    /// Gives a name a value.
    fn bind(&mut self, name: &str, value: Expression) {
        let value = self.define(name, value);
        self.scope.set(name, value);
    }

    /// Adds a definition and returns what stands for it.
    fn define(&mut self, name: &str, value: Expression) -> Expression {
        if value.is_plain() {
            return value;
        }
        let lines = &mut self.definitions.lines;
        let mut unique = name.to_owned();
        while lines.iter().any(|(other, _)| *other == unique)
            || self.definitions.inputs.contains(&unique)
        {
            unique.push('_');
        }
        lines.push((unique.clone(), value));
        Expression::Name(unique)
    }

    fn input(&mut self, name: &str) -> Expression {
        let inputs = &mut self.definitions.inputs;
        if !inputs.iter().any(|input| input == name) {
            inputs.push(name.to_owned());
        }
        Expression::Name(name.to_owned())
    }

    fn expression(&mut self, expression: &Expr) -> Result<Expression> {
        match expression {
            Expr::Paren(inner) => self.expression(&inner.expr),
            Expr::Group(inner) => self.expression(&inner.expr),
            Expr::Lit(literal) => number(&literal.lit).map(Expression::Constant),
            Expr::Unary(unary) => match unary.op {
                UnOp::Neg(_) => {
                    let inner = self.expression(&unary.expr)?;
                    Ok(Expression::Negative(Box::new(inner)))
                }
                _ => bail!("a sign that is not read"),
            },
            Expr::Binary(binary) => {
                let Some((sign, false)) = sign(&binary.op) else {
                    bail!("an operation that is not arithmetic");
                };
                let [left, right] = [
                    self.expression(&binary.left)?,
                    self.expression(&binary.right)?,
                ];
                Ok(operation(sign, left, right))
            }
            Expr::Call(call) => self.call(call),
            Expr::MethodCall(call) if !call.args.is_empty() => {
                let arguments: Vec<_> = call.args.iter().collect();
                self.inlined(&call.method.to_string(), &arguments)
            }
            _ => self.named(expression),
        }
    }

    /// Reads a name: of this function, a constant of the source, or else a number from outside.
    fn named(&mut self, expression: &Expr) -> Result<Expression> {
        let name = path(expression).context("an expression that is not arithmetic")?;
        if let Some(value) = self.scope.values.get(&name) {
            return Ok(value.clone());
        }
        if let Some(why) = self.scope.unread.get(&name) {
            bail!("{name} was not read: {why}");
        }
        if let Some(constant) = self.source.constants.get(&name) {
            return self.expression(&constant.clone());
        }
        Ok(self.input(&name))
    }

    fn call(&mut self, call: &syn::ExprCall) -> Result<Expression> {
        let Expr::Path(called) = &*call.func else {
            bail!("a call of what is no name");
        };
        let name = called
            .path
            .segments
            .last()
            .map(|last| last.ident.to_string());
        let name = name.unwrap_or_default();
        let arguments: Vec<_> = call.args.iter().collect();
        if let Some(closure) = self.scope.closures.get(&name).cloned() {
            let inputs: Vec<_> = closure.inputs.iter().cloned().collect();
            let scope = self.scope_of(&inputs, &arguments)?;
            let outer = std::mem::replace(&mut self.scope, scope);
            let value = self.expression(&closure.body);
            self.scope = outer;
            return value;
        }
        match (name.as_str(), arguments.as_slice()) {
            ("sqrt" | "sqrtf", [of]) => {
                let inner = self.expression(of)?;
                Ok(Expression::Root(Box::new(inner)))
            }
            _ => self.inlined(&name, &arguments),
        }
    }

    /// Reads a function of the same source in the place of its call.
    fn inlined(&mut self, name: &str, arguments: &[&Expr]) -> Result<Expression> {
        let function = self.source.function(name)?.clone();
        let scope = self.scope_of(&function.arguments, arguments)?;
        let outer = std::mem::replace(&mut self.scope, scope);
        let results = self.body(&function.body, &["result"]);
        self.scope = outer;
        results?.remove("result").context("it has no result")
    }

    /// Returns the names inside a function that is called.
    fn scope_of(&mut self, inputs: &[Pat], arguments: &[&Expr]) -> Result<Scope> {
        let mut scope = Scope::default();
        for (input, argument) in inputs.iter().zip(arguments) {
            let Pat::Ident(name) = pattern(input) else {
                bail!("an argument that is no name");
            };
            let name = name.ident.to_string();
            let value = self.expression(argument)?;
            let value = self.define(&name, value);
            scope.set(&name, value);
        }
        Ok(scope)
    }
}

/// Returns the name to which a value is assigned.
fn place(place: &Expr) -> Result<String> {
    path(place).context("a value is assigned to what is no name")
}

fn operation(sign: char, left: Expression, right: Expression) -> Expression {
    Expression::Operation(sign, Box::new(left), Box::new(right))
}

/// Returns the sign of an operation, and whether it assigns its result.
fn sign(operation: &BinOp) -> Option<(char, bool)> {
    Some(match operation {
        BinOp::Add(_) => ('+', false),
        BinOp::Sub(_) => ('-', false),
        BinOp::Mul(_) => ('*', false),
        BinOp::Div(_) => ('/', false),
        BinOp::AddAssign(_) => ('+', true),
        BinOp::SubAssign(_) => ('-', true),
        BinOp::MulAssign(_) => ('*', true),
        _ => return None,
    })
}

/// Returns a pattern without its type.
fn pattern(pattern: &Pat) -> &Pat {
    match pattern {
        Pat::Type(typed) => &typed.pat,
        other => other,
    }
}

fn member(member: &Member) -> String {
    match member {
        Member::Named(name) => name.to_string(),
        Member::Unnamed(index) => index.index.to_string(),
    }
}

/// Returns the name of a value: `self.a.b()` is `a_b`.
fn path(expression: &Expr) -> Option<String> {
    let joined = |base: &Expr, name: String| {
        let base = path(base)?;
        Some(if base == "self" {
            name
        } else {
            format!("{base}_{name}")
        })
    };
    match expression {
        Expr::Path(name) => name.path.get_ident().map(ToString::to_string),
        Expr::Field(field) => joined(&field.base, member(&field.member)),
        Expr::MethodCall(call) if call.args.is_empty() => {
            joined(&call.receiver, call.method.to_string())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::expression::Arithmetic;
    use super::*;

    fn lines(text: &str, reading: Reading<'_>, wanted: &[&str]) -> Vec<String> {
        let source = Source::parse(text).unwrap();
        let (definitions, _) = read(&source, "of", reading, wanted).unwrap();
        let line = |(name, value): &(String, Expression)| {
            format!("{name} = {}", value.text(Arithmetic::Exact))
        };
        definitions.lines.iter().map(line).collect()
    }

    #[test]
    fn operations_keep_the_order_of_the_source() {
        let text = "
            const PART: f32 = 0.1;
            fn of(form: &Form, [x, y]: [f32; 2]) -> [f32; 2] {
                let r2 = x * x + y * y;
                let mut dx = x * form.k0 + form.gx * r2;
                if full { dx += PART; }
                [x - dx, y]
            }";
        let always = [
            "r2 = ((exact_x * exact_x) + (exact_y * exact_y))",
            "dx = ((exact_x * exact_form_k0) + (exact_form_gx * exact_r2))",
        ];
        let short = lines(text, Reading::default(), &["0"]);
        assert_eq!(short, [always[0], always[1], "at_0 = (exact_x - exact_dx)"]);
        let reading = Reading {
            conditions_hold: true,
            ..Reading::default()
        };
        let full = lines(text, reading, &["0"]);
        assert_eq!(
            full[2..],
            ["dx_ = (exact_dx + 0.1)", "at_0 = (exact_x - exact_dx_)"]
        );
    }

    #[test]
    fn functions_and_closures_are_read_where_they_are_called() {
        let text = "
            impl A {
                fn of(&self, x: f32) -> f32 {
                    let square = |value: f32| value * value;
                    self.gain(x, square(self.k.k1))
                }
                fn gain(&self, x: f32, r2: f32) -> f32 { self.k0 + r2 * x }
            }";
        let found = lines(text, Reading::default(), &["result"]);
        assert_eq!(
            found,
            [
                "r2 = (exact_k_k1 * exact_k_k1)",
                "result = (exact_k0 + (exact_r2 * exact_x))"
            ]
        );
    }

    #[test]
    fn what_is_not_arithmetic_is_an_error_unless_it_is_given() {
        let text = "fn of(x: f32) -> f32 { let n = x.floor_or(1.0); x / n }";
        let source = Source::parse(text).unwrap();
        // A result that the function does not have is an error.
        assert!(read(&source, "of", Reading::default(), &["other"]).is_err());
        let reading = Reading {
            given: &["n"],
            ..Reading::default()
        };
        let (definitions, _) = read(&source, "of", reading, &["result"]).unwrap();
        assert_eq!(definitions.inputs, ["n", "x"]);
        // Nor does the value before a redefinition stand for one that is not read.
        let again = "fn of(x: f32) -> f32 { let x = x.floor_or(1.0); x * x }";
        let again = Source::parse(again).unwrap();
        let error = read(&again, "of", Reading::default(), &["result"]).unwrap_err();
        assert!(format!("{error:#}").contains("x was not read"), "{error:#}");
        let bound = "fn of(x: f32) -> f32 { let y = x.f(1.0); let y = x * 2.0; y * y }";
        let bound = lines(bound, Reading::default(), &["result"]);
        assert_eq!(
            bound,
            ["y = (exact_x * 2.0)", "result = (exact_y * exact_y)"]
        );
        let loops = Source::parse("fn of() -> f32 { for i in 0..2 {} 1.0 }").unwrap();
        assert!(read(&loops, "of", Reading::default(), &["result"]).is_err());
    }
}
