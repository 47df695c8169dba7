//! Flat program of a formula: operations on a stack of fixed size.

use crate::node::{Function, Node, Operator};
use crate::parser::FormulaError;

/// Largest number of values on the stack.
const STACK_MAX: usize = 64;

/// Operations of a formula, operands before their operator.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Program {
    steps: Vec<Step>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Number(f64),
    Name(usize),
    Negate,
    Apply(Operator),
    Call(Function),
}

impl Program {
    /// Compiles a formula.
    ///
    /// # Errors
    /// Returns an error if the formula is nested too deeply.
    pub(crate) fn of(root: &Node) -> Result<Self, FormulaError> {
        let mut steps = Vec::new();
        let depth = append(root, &mut steps);
        if depth > STACK_MAX {
            return Err(FormulaError {
                position: 1,
                problem: format!(
                    "its parts wait for {depth} others, of at most {STACK_MAX}; shorten its chains of ^ and parentheses"
                ),
            });
        }
        Ok(Self { steps })
    }

    /// Returns the value for `values` of the names.
    #[inline]
    pub(crate) fn value(&self, values: &[f64]) -> f64 {
        let mut stack = [0.0; STACK_MAX];
        let mut top = 0;
        for step in &self.steps {
            match *step {
                Step::Number(value) => {
                    stack[top] = value;
                    top += 1;
                }
                Step::Name(index) => {
                    stack[top] = values[index];
                    top += 1;
                }
                Step::Negate => stack[top - 1] = -stack[top - 1],
                Step::Apply(operator) => {
                    top -= 1;
                    stack[top - 1] = apply(operator, stack[top - 1], stack[top]);
                }
                Step::Call(function @ (Function::Min | Function::Max)) => {
                    top -= 1;
                    stack[top - 1] = extreme(function, stack[top - 1], stack[top]);
                }
                Step::Call(function) => stack[top - 1] = of_one(function, stack[top - 1]),
            }
        }
        stack[0]
    }
}

/// Appends the steps of a node, and returns the number of values that they need on the stack.
fn append(node: &Node, steps: &mut Vec<Step>) -> usize {
    match node {
        Node::Number(value) => {
            steps.push(Step::Number(*value));
            1
        }
        Node::Name(reference) => {
            steps.push(Step::Name(reference.index));
            1
        }
        Node::Negative(node) => {
            let depth = append(node, steps);
            steps.push(Step::Negate);
            depth
        }
        Node::Binary(binary) => {
            let left = append(&binary.left, steps);
            let right = append(&binary.right, steps);
            steps.push(Step::Apply(binary.operator));
            left.max(right + 1)
        }
        Node::Call(call) => {
            let mut depth = 0;
            for (n, argument) in call.arguments.iter().enumerate() {
                depth = depth.max(usize::from(n > 0) + append(argument, steps));
                if n > 0 || call.arguments.len() == 1 {
                    steps.push(Step::Call(call.function));
                }
            }
            depth
        }
    }
}

fn apply(operator: Operator, left: f64, right: f64) -> f64 {
    match operator {
        Operator::Add => left + right,
        Operator::Subtract => left - right,
        Operator::Multiply => left * right,
        Operator::Divide => left / right,
        Operator::Power => left.powf(right),
    }
}

fn of_one(function: Function, value: f64) -> f64 {
    match function {
        Function::Abs => value.abs(),
        Function::Sqrt => value.sqrt(),
        Function::Exp => value.exp(),
        Function::Ln => value.ln(),
        Function::Sin => value.sin(),
        Function::Cos => value.cos(),
        Function::Tanh => value.tanh(),
        Function::Min | Function::Max => value,
    }
}

/// Returns the smaller or the larger value; missing if one of them is missing.
fn extreme(function: Function, one: f64, other: f64) -> f64 {
    if one.is_nan() || other.is_nan() {
        f64::NAN
    } else if function == Function::Min {
        one.min(other)
    } else {
        one.max(other)
    }
}
