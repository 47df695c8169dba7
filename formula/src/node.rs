//! Tree of a formula.

use crate::Name;
use crate::parser::FormulaError;

/// Part of a formula.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Node {
    Number(f64),
    Name(Reference),
    Negative(Box<Self>),
    Binary(Binary),
    Call(Call),
}

/// Use of a name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reference {
    pub(crate) text: String,
    /// Index among the names of the formula.
    pub(crate) index: usize,
    /// Position in characters, from 1.
    pub(crate) position: usize,
}

/// Operator with its operands.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Binary {
    pub(crate) operator: Operator,
    /// Position of the operator in characters, from 1.
    pub(crate) position: usize,
    pub(crate) left: Box<Node>,
    pub(crate) right: Box<Node>,
}

/// Function with its arguments.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Call {
    pub(crate) function: Function,
    /// Position of the function in characters, from 1.
    pub(crate) position: usize,
    pub(crate) arguments: Vec<Node>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl Operator {
    pub(crate) fn symbol(self) -> char {
        match self {
            Self::Add => '+',
            Self::Subtract => '-',
            Self::Multiply => '*',
            Self::Divide => '/',
            Self::Power => '^',
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Function {
    Abs,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tanh,
    Min,
    Max,
}

/// Names of the functions.
const FUNCTIONS: [(&str, Function); 9] = [
    ("abs", Function::Abs),
    ("sqrt", Function::Sqrt),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tanh", Function::Tanh),
    ("min", Function::Min),
    ("max", Function::Max),
];

impl Function {
    pub(crate) fn named(name: &str) -> Option<Self> {
        let found = FUNCTIONS.iter().find(|(known, _)| *known == name);
        found.map(|(_, function)| *function)
    }

    pub(crate) fn name(self) -> &'static str {
        let found = FUNCTIONS.iter().find(|(_, function)| *function == self);
        found.map_or("", |(name, _)| name)
    }

    pub(crate) fn takes(self, arguments: usize) -> bool {
        match self {
            Self::Min | Self::Max => arguments >= 2,
            _ => arguments == 1,
        }
    }
}

impl Node {
    /// Calls `with` for each divisor, with the position of its `/`.
    pub(crate) fn each_divisor(
        &self,
        with: &mut impl FnMut(usize, &Self) -> Result<(), FormulaError>,
    ) -> Result<(), FormulaError> {
        match self {
            Self::Number(_) | Self::Name(_) => Ok(()),
            Self::Negative(node) => node.each_divisor(with),
            Self::Binary(binary) => {
                if binary.operator == Operator::Divide {
                    with(binary.position, &binary.right)?;
                }
                binary.left.each_divisor(with)?;
                binary.right.each_divisor(with)
            }
            Self::Call(call) => {
                let mut arguments = call.arguments.iter();
                arguments.try_for_each(|argument| argument.each_divisor(with))
            }
        }
    }

    /// Assigns each name its index.
    pub(crate) fn place(&mut self, names: &mut Vec<Name>) {
        match self {
            Self::Number(_) => {}
            Self::Name(reference) => {
                let known = names.iter().position(|one| one.text == reference.text);
                reference.index = known.unwrap_or_else(|| {
                    names.push(Name {
                        text: reference.text.clone(),
                        position: reference.position,
                    });
                    names.len() - 1
                });
            }
            Self::Negative(node) => node.place(names),
            Self::Binary(binary) => {
                binary.left.place(names);
                binary.right.place(names);
            }
            Self::Call(call) => {
                for argument in &mut call.arguments {
                    argument.place(names);
                }
            }
        }
    }
}
