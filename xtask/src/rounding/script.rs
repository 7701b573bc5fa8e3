//! Script for Gappa: a computation in single precision, the same without rounding, and a bound of
//! their difference.

use std::{collections::BTreeMap, fmt::Write as _};

use anyhow::{Result, ensure};

use super::{
    expression::{Arithmetic, Expression, binary},
    function::Definitions,
};

/// Value of a number from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Given {
    /// One number.
    Is(f32),
    /// Any number of single precision between two.
    Between(f64, f64),
}

/// Measure of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// Nanometres, of a result in millimetres.
    Nanometres,
    /// Part of the exact result.
    Part,
    /// The result's own.
    Own,
}

impl Unit {
    /// Returns the unit as the document writes it.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Nanometres => "nm",
            Self::Part => "of it",
            Self::Own => "1",
        }
    }

    fn error(self, result: &str) -> String {
        let exact = Arithmetic::Exact.name(result);
        match self {
            Self::Nanometres => format!("({result} - {exact}) * 1000000"),
            Self::Part => format!("{result} -/ {exact}"),
            Self::Own => format!("{result} - {exact}"),
        }
    }
}

/// Computation with the ranges of its numbers.
#[derive(Clone, Debug)]
pub(super) struct Script {
    pub(super) definitions: Definitions,
    pub(super) given: BTreeMap<String, Given>,
    pub(super) result: Expression,
    pub(super) unit: Unit,
}

impl Script {
    /// Returns the script that proves a bound, or asks for one.
    ///
    /// # Errors
    /// An error if a number has no range, or a range is that of no number.
    pub(super) fn text(&self, bound: Option<&str>) -> Result<String> {
        let mut text = "@rnd = float<ieee_32, ne>;\n".to_owned();
        let mut ranges = Vec::new();
        let inputs = &self.definitions.inputs;
        for input in inputs {
            let given = self.given.get(input);
            ensure!(given.is_some(), "{input} has no range");
            match given {
                Some(Given::Is(number)) => writeln!(text, "{input} = {};", binary(*number))?,
                Some(Given::Between(least, most)) => {
                    writeln!(text, "{input} = rnd(any_{input});")?;
                    ranges.push(format!("any_{input} in [{least:e}, {most:e}]"));
                }
                None => {}
            }
            let exact = Arithmetic::Exact.name(input);
            writeln!(text, "{exact} = {input};")?;
        }
        for name in self.given.keys() {
            ensure!(inputs.contains(name), "{name} has a range and is not used");
        }
        for (name, value) in &self.definitions.lines {
            writeln!(text, "{name} rnd= {};", value.text(Arithmetic::Rounded))?;
            let exact = Arithmetic::Exact.name(name);
            writeln!(text, "{exact} = {};", value.text(Arithmetic::Exact))?;
        }
        let Expression::Name(result) = &self.result else {
            anyhow::bail!("nothing is computed");
        };
        let error = self.unit.error(result);
        let goal = match bound {
            Some(bound) => format!("|{error}| <= {bound}"),
            None => format!("{error} in ?"),
        };
        let conditions = ranges.join(" /\\ ");
        writeln!(text, "{{ {conditions} -> {goal} }}")?;
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn script_has_both_computations_and_the_bound() {
        let product = Expression::Operation(
            '*',
            Box::new(Expression::Name("x".to_owned())),
            Box::new(Expression::Constant("0.1".to_owned())),
        );
        let script = Script {
            definitions: Definitions {
                lines: vec![("y".to_owned(), product)],
                inputs: vec!["x".to_owned()],
            },
            given: BTreeMap::from([("x".to_owned(), Given::Between(-1.0, 2.0))]),
            result: Expression::Name("y".to_owned()),
            unit: Unit::Nanometres,
        };
        let expected = "@rnd = float<ieee_32, ne>;
x = rnd(any_x);
exact_x = x;
y rnd= (x * 13421773b-27);
exact_y = (exact_x * 0.1);
{ any_x in [-1e0, 2e0] -> |(y - exact_y) * 1000000| <= 0.5 }
";
        assert_eq!(script.text(Some("0.5")).unwrap(), expected);
        let without = Script {
            given: BTreeMap::new(),
            ..script
        };
        assert!(without.text(None).is_err());
    }
}
