#![doc = include_str!("../README.md")]

mod dimension;
mod node;
mod parser;
mod program;
mod unit;

pub use dimension::{Checked, Mismatch, Operand};
pub use parser::{FormulaError, LENGTH_MAX};
pub use unit::{Dimension, UnitError, parse_unit};

use node::Node;
use program::Program;

/// Parsed formula.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    root: Node,
    names: Vec<Name>,
    program: Program,
    divisors: Vec<Divisor>,
}

/// Divisor in a formula.
#[derive(Debug, Clone, PartialEq)]
struct Divisor {
    /// Position of its `/` in characters, from 1.
    position: usize,
    program: Program,
}

/// Name in a formula.
#[derive(Debug, Clone, PartialEq)]
struct Name {
    text: String,
    /// Position of its first use in characters, from 1.
    position: usize,
}

impl Formula {
    /// Parses a formula.
    ///
    /// # Errors
    /// Returns a [`FormulaError`] with the expected text and its position.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        let mut root = parser::parse(text)?;
        let mut names = Vec::new();
        root.place(&mut names);
        let program = Program::of(&root)?;
        let mut divisors = Vec::new();
        root.each_divisor(&mut |position, node| {
            divisors.push(Divisor {
                position,
                program: Program::of(node)?,
            });
            Ok(())
        })?;
        Ok(Self {
            root,
            names,
            program,
            divisors,
        })
    }

    /// Returns the names in the formula, each once, in the order of their first use.
    pub fn names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.names.iter().map(|name| name.text.as_str())
    }

    /// Returns the position of the first use of a name in characters, from 1; `None` if the formula does not use it.
    pub fn position(&self, name: &str) -> Option<usize> {
        let found = self.names.iter().find(|one| one.text == name);
        found.map(|name| name.position)
    }

    /// Returns the value for `values` of the names, in the order of [`Self::names`]. It is NaN or infinite where
    /// the formula has no finite value. It allocates nothing, and its work is bounded by the length of the text.
    ///
    /// # Panics
    /// Panics if there are fewer values than names.
    #[inline]
    pub fn value(&self, values: &[f64]) -> f64 {
        self.program.value(values)
    }

    /// Returns the position of each `/` in characters, from 1, and the value behind it for `values` of the names. Between
    /// two points at which a divisor has different signs it is 0 somewhere.
    pub fn divisors(&self, values: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        let divisors = self.divisors.iter();
        divisors.map(|one| (one.position, one.program.value(values)))
    }

    /// Returns the dimension of the value, where `dimension` gives that of each name; `None` is a name of unknown
    /// dimension. The parts that depend on one are not checked, and [`Checked::unchecked`] lists the reasons.
    ///
    /// # Errors
    /// Returns an error if the operands of an operator or a function do not fit each other.
    pub fn dimension(
        &self,
        dimension: impl Fn(&str) -> Option<Dimension>,
    ) -> Result<Checked, Mismatch> {
        dimension::check(&self.root, &dimension)
    }
}
