//! Check of the dimensions of a formula.

use core::fmt;

use crate::node::{Binary, Call, Function, Node, Operator};
use crate::unit::Dimension;

/// Dimension of a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// Dimension of the value; `None` if it is not determined: a name or an exponent is of unknown dimension, or the
    /// formula is a number, which takes any unit.
    pub dimension: Option<Dimension>,
    /// Reasons why parts were not checked, in words.
    pub unchecked: Vec<String>,
}

/// Operands that do not fit each other.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{operand} {left}, and {expected} {right}")]
pub struct Mismatch {
    /// Position in characters, from 1.
    pub position: usize,
    /// Operator or function.
    pub operand: Operand,
    /// Dimension on the left of an operator, or that of an argument.
    pub left: Dimension,
    /// Words before the dimension on the right: `on the right`, or `needs`.
    pub expected: &'static str,
    /// Dimension on the right, or the one that is needed.
    pub right: Dimension,
}

/// Place of a mismatch, in the words of its message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand {
    /// Operator between two operands.
    Operator(char),
    /// Exponent of a power.
    Exponent,
    /// Argument of a function.
    Argument(&'static str),
}

impl fmt::Display for Operand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Operator(symbol) => write!(f, "`{symbol}` has on its left"),
            Self::Exponent => f.write_str("the exponent of `^` is"),
            Self::Argument(function) => write!(f, "an argument of `{function}` is"),
        }
    }
}

/// Dimension of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// Number of the text, which takes the unit of what it is added to.
    Literal(f64),
    Known(Dimension),
    Unknown,
}

impl Part {
    /// Returns the dimension as a factor: a number of the text is a pure number there.
    fn as_factor(self) -> Option<Dimension> {
        match self {
            Self::Literal(_) => Some(Dimension::NUMBER),
            Self::Known(dimension) => Some(dimension),
            Self::Unknown => None,
        }
    }

    fn of(dimension: Option<Dimension>) -> Self {
        dimension.map_or(Self::Unknown, Self::Known)
    }
}

type Lookup<'a> = dyn Fn(&str) -> Option<Dimension> + 'a;

struct Check<'a> {
    of_name: &'a Lookup<'a>,
    unchecked: Vec<String>,
}

pub(crate) fn check(root: &Node, of_name: &Lookup) -> Result<Checked, Mismatch> {
    let mut check = Check {
        of_name,
        unchecked: Vec::new(),
    };
    let part = check.part(root)?;
    Ok(Checked {
        dimension: match part {
            Part::Known(dimension) => Some(dimension),
            Part::Literal(_) | Part::Unknown => None,
        },
        unchecked: check.unchecked,
    })
}

impl Check<'_> {
    fn leave(&mut self, reason: String) -> Part {
        if !self.unchecked.contains(&reason) {
            self.unchecked.push(reason);
        }
        Part::Unknown
    }

    fn part(&mut self, node: &Node) -> Result<Part, Mismatch> {
        match node {
            Node::Number(value) => Ok(Part::Literal(*value)),
            Node::Name(reference) => Ok(match (self.of_name)(&reference.text) {
                Some(dimension) => Part::Known(dimension),
                None => self.leave(format!("the unit of `{}` is not fixed", reference.text)),
            }),
            Node::Negative(node) => Ok(match self.part(node)? {
                Part::Literal(value) => Part::Literal(-value),
                part => part,
            }),
            Node::Binary(binary) => self.binary(binary),
            Node::Call(call) => self.call(call),
        }
    }

    fn binary(&mut self, binary: &Binary) -> Result<Part, Mismatch> {
        let left = self.part(&binary.left)?;
        let right = self.part(&binary.right)?;
        let both = left.as_factor().zip(right.as_factor());
        match binary.operator {
            Operator::Add | Operator::Subtract => {
                same(left, right).map_err(|[left, right]| Mismatch {
                    position: binary.position,
                    operand: Operand::Operator(binary.operator.symbol()),
                    left,
                    expected: "on its right",
                    right,
                })
            }
            Operator::Multiply => Ok(Part::of(both.map(|(left, right)| left * right))),
            Operator::Divide => Ok(Part::of(both.map(|(left, right)| left / right))),
            Operator::Power => self.power(binary, left, right),
        }
    }

    fn power(&mut self, binary: &Binary, base: Part, exponent: Part) -> Result<Part, Mismatch> {
        if let Some(found) = exponent.as_factor() {
            number(found).map_err(|left| Mismatch {
                position: binary.position,
                operand: Operand::Exponent,
                left,
                expected: "needs",
                right: Dimension::NUMBER,
            })?;
        }
        let Some(dimension) = base.as_factor() else {
            return Ok(Part::Unknown);
        };
        if dimension.is(Dimension::NUMBER) {
            return Ok(Part::Known(dimension));
        }
        Ok(match exponent {
            Part::Literal(value) => Part::Known(dimension.power(value)),
            _ => self.leave(format!(
                "the exponent at character {} is not a number",
                binary.position + 1
            )),
        })
    }

    fn call(&mut self, call: &Call) -> Result<Part, Mismatch> {
        let mismatch = |left, right| Mismatch {
            position: call.position,
            operand: Operand::Argument(call.function.name()),
            left,
            expected: match call.function {
                Function::Min | Function::Max => "another one is",
                _ => "needs",
            },
            right,
        };
        let mut together = self.part(&call.arguments[0])?;
        match call.function {
            Function::Abs => {}
            Function::Sqrt => {
                together = Part::of(together.as_factor().map(|one| one.power(0.5)));
            }
            Function::Min | Function::Max => {
                for argument in &call.arguments[1..] {
                    let next = self.part(argument)?;
                    together =
                        same(together, next).map_err(|[left, right]| mismatch(left, right))?;
                }
            }
            _ => {
                if let Some(found) = together.as_factor() {
                    number(found).map_err(|left| mismatch(left, Dimension::NUMBER))?;
                }
                together = Part::Known(Dimension::NUMBER);
            }
        }
        Ok(together)
    }
}

/// Returns the common dimension of two parts that are added or compared, or both dimensions if they differ.
fn same(left: Part, right: Part) -> Result<Part, [Dimension; 2]> {
    match (left, right) {
        (Part::Known(left), Part::Known(right)) if !left.is(right) => Err([left, right]),
        (Part::Known(known), _) | (_, Part::Known(known)) => Ok(Part::Known(known)),
        (Part::Unknown, _) | (_, Part::Unknown) => Ok(Part::Unknown),
        (Part::Literal(_), Part::Literal(_)) => Ok(left),
    }
}

/// Returns an error with the dimension if it is not that of a number.
fn number(found: Dimension) -> Result<(), Dimension> {
    if found.is(Dimension::NUMBER) {
        Ok(())
    } else {
        Err(found)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Dimension, Formula, parse_unit};

    fn of_name(name: &str) -> Option<Dimension> {
        let unit = match name {
            "p" => "Pa",
            "t" => "K",
            "k" => "kg/s/Pa^0.5",
            _ => return None,
        };
        parse_unit(unit).unwrap()
    }

    fn checked(text: &str) -> Result<String, String> {
        let found = Formula::parse(text).unwrap().dimension(of_name);
        let found = found.map_err(|error| format!("{}: {error}", error.position))?;
        let dimension = found.dimension.map(|one| one.to_string());
        let reasons = found.unchecked.join(", ");
        Ok(format!("{}{reasons}", dimension.unwrap_or_default()))
    }

    /// By hand: kg/s/Pa^0.5 times the root of a pressure is a mass flow.
    #[test]
    fn a_formula_has_the_dimension_that_its_names_give() {
        for (text, expected) in [
            ("k * sqrt(p)", "kg/s"),
            ("k * p ^ 0.5", "kg/s"),
            ("max(p - 1e5, 0)", "Pa"),
            ("exp(-p / p)", "a pure number"),
            ("p * exp(-t / t)", "Pa"),
            ("abs(p) / p", "a pure number"),
            ("5", ""),
        ] {
            assert_eq!(checked(text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn a_mismatch_names_its_place_and_both_sides() {
        for (text, expected) in [
            ("p + t", "3: `+` has on its left Pa, and on its right K"),
            (
                "2 * p - k",
                "7: `-` has on its left Pa, and on its right kg^0.5",
            ),
            (
                "max(p, t)",
                "1: an argument of `max` is Pa, and another one is K",
            ),
            (
                "1 + sin(p)",
                "5: an argument of `sin` is Pa, and needs a pure number",
            ),
            (
                "2 ^ p",
                "3: the exponent of `^` is Pa, and needs a pure number",
            ),
        ] {
            let found = checked(text).unwrap_err();
            assert!(found.starts_with(expected), "{text}: {found}");
        }
    }

    #[test]
    fn a_part_of_unknown_dimension_is_left_unchecked_and_said() {
        assert_eq!(
            checked("p ^ n").unwrap(),
            "the unit of `n` is not fixed, the exponent at character 4 is not a number"
        );
        assert!(checked("p ^ n + p + t").is_err());
    }
}
