//! Grammar of formulas, with the position of a syntax error.

use winnow::ascii::{digit1, multispace0};
use winnow::combinator::{
    alt, cut_err, delimited, eof, fail, opt, preceded, repeat, separated, separated_foldl1,
    terminated,
};
use winnow::error::{ContextError, StrContext, StrContextValue};
use winnow::prelude::*;
use winnow::token::{none_of, one_of, take_while};

use crate::node::{Binary, Call, Function, Node, Operator, Reference};

/// Longest formula (characters).
pub const LENGTH_MAX: usize = 500;
/// Largest depth of nested parentheses.
const DEPTH_MAX: usize = 20;

/// Position and reason of a syntax error.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("character {position} of the formula: {problem}")]
pub struct FormulaError {
    /// Position in characters, from 1.
    pub position: usize,
    /// Expected text, and the text found.
    pub problem: String,
}

/// Parses a formula; its names have no index yet.
pub(crate) fn parse(text: &str) -> Result<Node, FormulaError> {
    check_size(text)?;
    let end = eof.context(expected("an operator"));
    let mut root = terminated(expression, end)
        .parse(text)
        .map_err(|error| FormulaError {
            position: position(text, text.len() - error.offset()),
            problem: sentence(error.inner(), &text[error.offset()..]),
        })?;
    locate(&mut root, text);
    Ok(root)
}

/// Returns the position of the character with `rest` bytes from it to the end, in characters, from 1.
fn position(text: &str, rest: usize) -> usize {
    1 + text[..text.len() - rest].chars().count()
}

/// Replaces the bytes that were left at each part by its position.
fn locate(node: &mut Node, text: &str) {
    match node {
        Node::Number(_) => {}
        Node::Name(reference) => reference.position = position(text, reference.position),
        Node::Negative(node) => locate(node, text),
        Node::Binary(binary) => {
            binary.position = position(text, binary.position);
            locate(&mut binary.left, text);
            locate(&mut binary.right, text);
        }
        Node::Call(call) => {
            call.position = position(text, call.position);
            for argument in &mut call.arguments {
                locate(argument, text);
            }
        }
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

const OPERAND: &str = "a number, a name, a function or a parenthesis";
const FUNCTIONS: &str = "abs, sqrt, exp, ln, sin, cos, tanh, min or max before a parenthesis";

fn expression(input: &mut &str) -> Parsed<Node> {
    let sign = operator([('+', Operator::Add), ('-', Operator::Subtract)]);
    separated_foldl1(term, sign, binary).parse_next(input)
}

fn term(input: &mut &str) -> Parsed<Node> {
    let sign = operator([('*', Operator::Multiply), ('/', Operator::Divide)]);
    separated_foldl1(factor, sign, binary).parse_next(input)
}

/// Parses one of two operators, and returns it with the bytes that were left.
fn operator<'a>(
    symbols: [(char, Operator); 2],
) -> impl FnMut(&mut &'a str) -> Parsed<(Operator, usize)> {
    move |input| {
        let rest = input.len();
        let symbol = one_of(symbols.map(|(symbol, _)| symbol)).parse_next(input)?;
        let [first, second] = symbols;
        let operator = if symbol == first.0 { first.1 } else { second.1 };
        Ok((operator, rest))
    }
}

fn binary(left: Node, (operator, position): (Operator, usize), right: Node) -> Node {
    Node::Binary(Binary {
        operator,
        position,
        left: Box::new(left),
        right: Box::new(right),
    })
}

/// Parses powers with a sign before each: `-a ^ -b ^ c` is -(a ^ (-(b ^ c))).
fn factor(input: &mut &str) -> Parsed<Node> {
    let mut chain = vec![signed(input)?];
    loop {
        let rest = input.len();
        if opt('^').parse_next(input)?.is_none() {
            break;
        }
        let next = signed(input)?;
        chain.push(Signed { rest, ..next });
    }
    let last = chain.pop().expect("a chain begins with an operand");
    let mut rest = last.rest;
    let mut node = with_sign(last.operand, last.is_negative);
    while let Some(base) = chain.pop() {
        let power = binary(base.operand, (Operator::Power, rest), node);
        rest = base.rest;
        node = with_sign(power, base.is_negative);
    }
    Ok(node)
}

/// Operand with its sign, and the bytes that were left at the `^` before it.
struct Signed {
    is_negative: bool,
    operand: Node,
    rest: usize,
}

/// Parses an operand with leading signs and white space around it.
fn signed(input: &mut &str) -> Parsed<Signed> {
    let sign = preceded(multispace0, one_of(['+', '-']));
    let signs = repeat(0.., sign).fold(|| false, |is_negative, sign| is_negative != (sign == '-'));
    let operand = delimited(
        multispace0,
        cut_err(operand.context(expected(OPERAND))),
        multispace0,
    );
    let (is_negative, operand) = (signs, operand).parse_next(input)?;
    Ok(Signed {
        is_negative,
        operand,
        rest: 0,
    })
}

fn with_sign(node: Node, is_negative: bool) -> Node {
    if is_negative {
        Node::Negative(Box::new(node))
    } else {
        node
    }
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
    let rest = input.len();
    let text = delimited('"', name, end).parse_next(input)?;
    Ok(name_at(text, rest))
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
        return Ok(name_at(name.to_owned(), begin.len()));
    }
    let Some(function) = Function::named(name) else {
        *input = begin;
        return refuse(input, FUNCTIONS);
    };
    let arguments: Vec<Node> = separated(1.., expression, ',').parse_next(input)?;
    let end = cut_err(')'.context(expected("an operator, a comma or a closing parenthesis")));
    terminated(multispace0, end).parse_next(input)?;
    if function.takes(arguments.len()) {
        Ok(Node::Call(Call {
            function,
            position: begin.len(),
            arguments,
        }))
    } else {
        *input = begin;
        refuse(
            input,
            "two or more values for min and max, one for each other function",
        )
    }
}

/// Creates the use of a name, with the bytes that were left at it.
fn name_at(text: String, rest: usize) -> Node {
    Node::Name(Reference {
        text,
        index: 0,
        position: rest,
    })
}

/// Ends the parser at this position.
fn refuse(input: &mut &str, what: &'static str) -> Parsed<Node> {
    cut_err(fail.context(expected(what))).parse_next(input)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Formula;

    /// Returns the value for a = 2, b = -3 and a missing c.
    fn value(text: &str) -> f64 {
        let formula = Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let of = |name: &str| match name {
            "a" => 2.0,
            "b" | "b \"quoted\" ü" => -3.0,
            _ => f64::NAN,
        };
        let values: Vec<f64> = formula.names().map(of).collect();
        formula.value(&values)
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
            ("a ^ 3 ^ 2", 512.0),
            ("-a ^ 2", -4.0),
            ("a ^ -1 * 4", 2.0),
            ("2 * a ^ 2 + 1", 9.0),
            ("exp(ln(a)) + tanh(0) + sin(0) + cos(0)", 3.0),
            ("1 + 2", 3.0),
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
    fn what_has_no_finite_value_is_not_finite() {
        for text in [
            "c",
            "a + c",
            "max(a, c)",
            "min(c, a)",
            "a / 0",
            "sqrt(b)",
            "b ^ 0.5",
            "ln(b)",
            "a*1e300*1e300",
        ] {
            assert!(!value(text).is_finite(), "{text}");
        }
    }

    #[test]
    fn an_error_names_its_position() {
        for (text, position) in [
            ("", 1),
            ("a +", 4),
            ("a + * b", 5),
            ("a b", 3),
            ("(a + b", 7),
            ("a)", 2),
            ("ü + sinus(a)", 5),
            ("a + abs(a, b)", 5),
            ("min(a)", 1),
            ("min(a, )", 8),
            ("abs()", 5),
            ("\"a", 3),
            ("a + \"\"", 5),
            ("2a + b", 2),
            ("a ^ ", 5),
            ("a ^ ^ 2", 5),
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
