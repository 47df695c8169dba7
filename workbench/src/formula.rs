//! Formulas over signals: numbers, names, `+ - * /`, parentheses, `abs`, `sqrt`, `min` and `max`.
//!
//! A name of letters, digits, `_` and `.` that begins with a letter or `_` needs no quotes. Any other name stands in
//! double quotes, with a quote within it doubled: `"p ch" - p_supply`.

use winnow::ascii::{digit1, multispace0};
use winnow::combinator::{
    alt, cut_err, delimited, eof, fail, opt, preceded, repeat, separated, separated_foldl1,
    terminated,
};
use winnow::error::{ContextError, StrContext, StrContextValue};
use winnow::prelude::*;
use winnow::token::{none_of, one_of, take_while};

/// Longest formula (characters).
pub(crate) const LENGTH_MAX: usize = 500;
/// Largest depth of nested parentheses.
const DEPTH_MAX: usize = 20;

/// Parsed formula.
#[derive(Debug, PartialEq)]
pub(crate) struct Formula {
    root: Node,
    signals: Vec<String>,
}

/// Position and reason of a syntax error.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("character {position} of the formula: {problem}")]
pub(crate) struct FormulaError {
    /// Position in characters, from 1.
    pub(crate) position: usize,
    pub(crate) problem: String,
}

#[derive(Debug, PartialEq)]
enum Node {
    Number(f64),
    /// Name, and index among the formula's signals.
    Signal(String, usize),
    Negative(Box<Node>),
    Binary(char, Box<Node>, Box<Node>),
    Call(Function, Vec<Node>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Function {
    Abs,
    Sqrt,
    Min,
    Max,
}

impl Function {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "abs" => Self::Abs,
            "sqrt" => Self::Sqrt,
            "min" => Self::Min,
            "max" => Self::Max,
            _ => return None,
        })
    }

    fn takes(self, arguments: usize) -> bool {
        match self {
            Self::Abs | Self::Sqrt => arguments == 1,
            Self::Min | Self::Max => arguments >= 2,
        }
    }
}

impl Formula {
    /// # Errors
    /// Returns a [`FormulaError`] with the expected text and its position.
    pub(crate) fn parse(text: &str) -> Result<Self, FormulaError> {
        check_size(text)?;
        let mut root = terminated(expression, eof.context(expected("an operator")))
            .parse(text)
            .map_err(|error| FormulaError {
                position: 1 + text[..error.offset()].chars().count(),
                problem: sentence(error.inner(), &text[error.offset()..]),
            })?;
        let mut signals = Vec::new();
        root.place(&mut signals);
        if signals.is_empty() {
            return Err(FormulaError {
                position: 1,
                problem: "there is no signal in it; a constant is no channel".to_owned(),
            });
        }
        Ok(Self { root, signals })
    }

    /// Returns the names of the signals, each once.
    pub(crate) fn signals(&self) -> &[String] {
        &self.signals
    }

    /// Returns the value in `row` of the signals' values; NaN if a sample is missing or the value is not finite.
    pub(crate) fn value(&self, signals: &[&[f64]], row: usize) -> f64 {
        let value = self.root.value(signals, row);
        if value.is_finite() { value } else { f64::NAN }
    }
}

impl Node {
    /// Assigns each signal its index.
    fn place(&mut self, names: &mut Vec<String>) {
        match self {
            Self::Number(_) => {}
            Self::Signal(name, place) => {
                *place = names.iter().position(|one| one == name).unwrap_or_else(|| {
                    names.push(name.clone());
                    names.len() - 1
                });
            }
            Self::Negative(node) => node.place(names),
            Self::Binary(_, left, right) => {
                left.place(names);
                right.place(names);
            }
            Self::Call(_, arguments) => {
                for argument in arguments {
                    argument.place(names);
                }
            }
        }
    }

    fn value(&self, signals: &[&[f64]], row: usize) -> f64 {
        let of = |node: &Self| node.value(signals, row);
        match self {
            Self::Number(value) => *value,
            Self::Signal(_, place) => signals[*place][row],
            Self::Negative(node) => -of(node),
            Self::Binary(operator, left, right) => {
                let (left, right) = (of(left), of(right));
                match operator {
                    '+' => left + right,
                    '-' => left - right,
                    '*' => left * right,
                    _ => left / right,
                }
            }
            Self::Call(function, arguments) => {
                let first = of(&arguments[0]);
                let rest = arguments[1..].iter().map(of);
                match function {
                    Function::Abs => first.abs(),
                    Function::Sqrt => first.sqrt(),
                    Function::Min => rest.fold(first, |one, other| known(one, other, f64::min)),
                    Function::Max => rest.fold(first, |one, other| known(one, other, f64::max)),
                }
            }
        }
    }
}

/// Returns the extreme of two values; missing if one of them is missing.
fn known(one: f64, other: f64, extreme: fn(f64, f64) -> f64) -> f64 {
    if one.is_nan() || other.is_nan() {
        f64::NAN
    } else {
        extreme(one, other)
    }
}

/// Limits the size of the parser's input.
fn check_size(text: &str) -> Result<(), FormulaError> {
    let at = |position, problem: String| Err(FormulaError { position, problem });
    let mut depth = 0_usize;
    for (index, character) in text.chars().enumerate() {
        if index >= LENGTH_MAX {
            return at(
                index + 1,
                format!("a formula has at most {LENGTH_MAX} characters"),
            );
        }
        match character {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > DEPTH_MAX {
            let problem = format!("at most {DEPTH_MAX} parentheses may lie within each other");
            return at(index + 1, problem);
        }
    }
    Ok(())
}

/// Returns the parser's message as a sentence.
fn sentence(error: &ContextError, rest: &str) -> String {
    let expected = error.context().find_map(|context| match context {
        StrContext::Expected(StrContextValue::Description(text)) => Some(*text),
        _ => None,
    });
    let found = rest.chars().next().map_or_else(
        || "its end".to_owned(),
        |character| format!("{character:?}"),
    );
    format!(
        "expected {}, found {found}",
        expected.unwrap_or("something else")
    )
}

const fn expected(what: &'static str) -> StrContext {
    StrContext::Expected(StrContextValue::Description(what))
}

type Parsed<T> = ModalResult<T>;

const OPERAND: &str = "a number, a signal, abs, sqrt, min, max or a parenthesis";

fn expression(input: &mut &str) -> Parsed<Node> {
    separated_foldl1(term, one_of(['+', '-']), binary).parse_next(input)
}

fn term(input: &mut &str) -> Parsed<Node> {
    separated_foldl1(factor, one_of(['*', '/']), binary).parse_next(input)
}

fn binary(left: Node, operator: char, right: Node) -> Node {
    Node::Binary(operator, Box::new(left), Box::new(right))
}

/// Parses an operand with leading signs and white space around it.
fn factor(input: &mut &str) -> Parsed<Node> {
    let sign = preceded(multispace0, one_of(['+', '-']));
    let signs = repeat(0.., sign).fold(|| false, |is_negative, sign| is_negative != (sign == '-'));
    let operand = delimited(
        multispace0,
        cut_err(operand.context(expected(OPERAND))),
        multispace0,
    );
    let (is_negative, node) = (signs, operand).parse_next(input)?;
    Ok(if is_negative {
        Node::Negative(Box::new(node))
    } else {
        node
    })
}

fn operand(input: &mut &str) -> Parsed<Node> {
    alt((number, grouped, quoted, named)).parse_next(input)
}

fn number(input: &mut &str) -> Parsed<Node> {
    let exponent = (one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1);
    (digit1, opt(('.', digit1)), opt(exponent))
        .take()
        .verify_map(|text: &str| text.parse().ok().filter(|value: &f64| value.is_finite()))
        .map(Node::Number)
        .parse_next(input)
}

fn grouped(input: &mut &str) -> Parsed<Node> {
    delimited('(', expression, close).parse_next(input)
}

fn close(input: &mut &str) -> Parsed<char> {
    cut_err(')'.context(expected("an operator or a closing parenthesis"))).parse_next(input)
}

/// Parses a name in quotes.
fn quoted(input: &mut &str) -> Parsed<Node> {
    let character = alt(("\"\"".value('"'), none_of('"')));
    let name = repeat(1.., character).fold(String::new, |mut name, character| {
        name.push(character);
        name
    });
    let end = cut_err('"'.context(expected("a closing quote")));
    delimited('"', name, end)
        .map(|name| Node::Signal(name, 0))
        .parse_next(input)
}

/// Parses a plain name, or a call if a parenthesis follows.
fn named(input: &mut &str) -> Parsed<Node> {
    let begin = *input;
    let first = one_of(|character: char| character.is_alphabetic() || character == '_');
    let more = take_while(0.., |character: char| {
        character.is_alphanumeric() || matches!(character, '_' | '.')
    });
    let name = (first, more).take().parse_next(input)?;
    let call = (multispace0, '(');
    if opt(call).parse_next(input)?.is_none() {
        return Ok(Node::Signal(name.to_owned(), 0));
    }
    let Some(function) = Function::named(name) else {
        *input = begin;
        return refuse(input, "abs, sqrt, min or max before a parenthesis");
    };
    let arguments: Vec<Node> = separated(1.., expression, ',').parse_next(input)?;
    let end = cut_err(')'.context(expected("an operator, a comma or a closing parenthesis")));
    terminated(multispace0, end).parse_next(input)?;
    if function.takes(arguments.len()) {
        Ok(Node::Call(function, arguments))
    } else {
        *input = begin;
        refuse(
            input,
            "one value for abs and sqrt, two or more for min and max",
        )
    }
}

/// Ends the parser at this position.
fn refuse(input: &mut &str, what: &'static str) -> Parsed<Node> {
    cut_err(fail.context(expected(what))).parse_next(input)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the value for a = 2, b = -3 and a missing c.
    fn value(text: &str) -> f64 {
        let formula = Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let of = |name: &String| match name.as_str() {
            "a" => [2.0],
            "b" | "b \"quoted\" ü" => [-3.0],
            _ => [f64::NAN],
        };
        let values: Vec<[f64; 1]> = formula.signals().iter().map(of).collect();
        let values: Vec<&[f64]> = values.iter().map(<[f64; 1]>::as_slice).collect();
        formula.value(&values, 0)
    }

    #[test]
    fn formulas_mean_what_they_mean_on_paper() {
        for (text, expected) in [
            ("a", 2.0),
            (" 1 + a * 3 ", 7.0),
            ("(1+a)*3", 9.0),
            ("a - 1 - 1", 0.0),
            ("12 / a / 3", 2.0),
            ("-a*b", 6.0),
            ("--a", 2.0),
            ("a - -b", -1.0),
            ("abs(b) + sqrt(a + 2)", 5.0),
            ("min(a, b, 1) * max( a , b )", -6.0),
            ("1.5e1 * a + 2E-1", 30.2),
            ("\"b \"\"quoted\"\" ü\" * 2", -6.0),
        ] {
            assert!(
                (value(text) - expected).abs() < 1e-12,
                "{text}: {}",
                value(text)
            );
        }
    }

    #[test]
    fn what_has_no_finite_value_is_missing() {
        for text in [
            "c",
            "a + c",
            "max(a, c)",
            "min(c, a)",
            "a / 0",
            "sqrt(b)",
            "a*1e300*1e300",
        ] {
            assert!(value(text).is_nan(), "{text}");
        }
    }

    #[test]
    fn an_error_names_its_position() {
        for (text, position) in [
            ("", 1),
            ("1 + 2", 1),
            ("a +", 4),
            ("a + * b", 5),
            ("a b", 3),
            ("(a + b", 7),
            ("a)", 2),
            ("ü + sin(a)", 5),
            ("a + abs(a, b)", 5),
            ("min(a)", 1),
            ("min(a, )", 8),
            ("abs()", 5),
            ("\"a", 3),
            ("a + \"\"", 5),
            ("2a + b", 2),
            ("a ^ 2", 3),
            (".5*a", 1),
            ("a + 1e999", 5),
            ("<img src=x onerror=alert(1)>", 1),
        ] {
            let error = Formula::parse(text).unwrap_err();
            assert_eq!(error.position, position, "{text}: {error}");
            assert!(error.problem.len() > 10, "{text}: {error}");
        }
    }

    #[test]
    fn length_and_depth_are_bounded() {
        let deep = |depth: usize| format!("{}a{}", "(".repeat(depth), ")".repeat(depth));
        assert!(Formula::parse(&deep(DEPTH_MAX)).is_ok());
        assert_eq!(
            Formula::parse(&deep(DEPTH_MAX + 1)).unwrap_err().position,
            DEPTH_MAX + 1
        );
        let long = |length: usize| format!("{}a", "-".repeat(length - 1));
        assert!(Formula::parse(&long(LENGTH_MAX)).is_ok());
        assert!(Formula::parse(&long(LENGTH_MAX + 1)).is_err());
        let sum = vec!["a"; LENGTH_MAX / 2].join("+");
        assert!((value(&sum) - LENGTH_MAX as f64).abs() < 1e-9);
    }
}
