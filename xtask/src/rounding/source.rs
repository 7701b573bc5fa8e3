//! Source of the library: its functions and constants.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

use anyhow::{Context as _, Result, bail, ensure};
use syn::{Block, Expr, Item, ItemFn, Lit, Pat};

/// Source file with its functions and constants.
#[derive(Debug)]
pub(super) struct Source {
    functions: BTreeMap<String, Function>,
    /// Names of several functions each.
    ambiguous: BTreeSet<String>,
    pub(super) constants: BTreeMap<String, Expr>,
}

/// Arguments and body of a function.
#[derive(Clone, Debug)]
pub(super) struct Function {
    pub(super) arguments: Vec<Pat>,
    pub(super) body: Block,
}

impl Source {
    /// Reads a source.
    ///
    /// # Errors
    /// An error if it is absent or is not Rust.
    pub(super) fn read(root: &Path, path: &str) -> Result<Self> {
        let text = fs::read_to_string(root.join(path)).with_context(|| path.to_owned())?;
        Self::parse(&text).with_context(|| path.to_owned())
    }

    pub(super) fn parse(text: &str) -> Result<Self> {
        let mut source = Self {
            functions: BTreeMap::new(),
            ambiguous: BTreeSet::new(),
            constants: BTreeMap::new(),
        };
        for item in syn::parse_file(text)?.items {
            match item {
                Item::Fn(ItemFn { sig, block, .. }) => source.add(&sig, *block),
                Item::Const(constant) => {
                    let name = constant.ident.to_string();
                    source.constants.insert(name, *constant.expr);
                }
                Item::Impl(implementation) => {
                    for item in implementation.items {
                        if let syn::ImplItem::Fn(function) = item {
                            source.add(&function.sig, function.block);
                        }
                    }
                }
                _ => {}
            }
        }
        Ok(source)
    }

    fn add(&mut self, signature: &syn::Signature, body: Block) {
        let typed = |argument: &syn::FnArg| match argument {
            syn::FnArg::Typed(typed) => Some((*typed.pat).clone()),
            syn::FnArg::Receiver(_) => None,
        };
        let arguments = signature.inputs.iter().filter_map(typed).collect();
        let name = signature.ident.to_string();
        let function = Function { arguments, body };
        if self.functions.insert(name.clone(), function).is_some() {
            self.ambiguous.insert(name);
        }
    }

    /// Returns a function.
    ///
    /// # Errors
    /// An error if there is none of that name, or more than one.
    pub(super) fn function(&self, name: &str) -> Result<&Function> {
        ensure!(
            !self.ambiguous.contains(name),
            "there are several functions {name}"
        );
        self.functions
            .get(name)
            .with_context(|| format!("there is no function {name}"))
    }

    /// Returns the value of a constant.
    ///
    /// # Errors
    /// An error if there is none, or it is not a number.
    pub(super) fn constant(&self, name: &str) -> Result<f32> {
        match self.constants.get(name) {
            Some(Expr::Lit(literal)) => number(&literal.lit)?.parse().context("no number"),
            _ => bail!("{name} is not a constant number"),
        }
    }
}

/// Returns the digits of a number without its type.
pub(super) fn number(literal: &Lit) -> Result<String> {
    match literal {
        Lit::Float(float) => Ok(float.base10_digits().to_owned()),
        _ => bail!("a constant that is no number"),
    }
}

#[cfg(test)]
mod tests {
    use super::Source;

    #[test]
    fn function_of_which_there_are_two_is_an_error() {
        let text = "impl A { fn f() {} fn g() {} } impl B { fn f() {} }";
        let source = Source::parse(text).unwrap();
        assert!(source.function("g").is_ok());
        let error = source.function("f").unwrap_err().to_string();
        assert_eq!(error, "there are several functions f");
    }
}
