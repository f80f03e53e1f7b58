//! Conditions: the little language of `when`.
//!
//! ```text
//! condition  = conjunction { "or" conjunction }
//! conjunction= negation { "and" negation }
//! negation   = "not" negation | "(" condition ")" | comparison
//! comparison = feature [ ("==" | "!=" | "<" | "<=" | ">" | ">=") operand
//!                      | ["not"] "in" "[" literal { "," literal } "]" ]
//! operand    = [ number "*" ] feature | literal
//! literal    = number | 'name' | true | false
//! ```
//! A feature alone means that it is true. `always` is the condition that always holds. Numbers are in the unit of
//! the feature. Every part knows its place in the text.

use super::value::Value;
use std::fmt;
use std::ops::Range;

/// Place in the condition's text \[bytes\].
pub type Span = Range<usize>;

/// A condition.
#[derive(Debug, Clone, PartialEq)]
pub enum Expr {
    /// Holds always.
    Always,
    /// Both hold.
    And(Box<Expr>, Box<Expr>),
    /// At least one holds.
    Or(Box<Expr>, Box<Expr>),
    /// Does not hold.
    Not(Box<Expr>),
    /// A comparison.
    Test(Test),
}

/// A comparison of a feature.
#[derive(Debug, Clone, PartialEq)]
pub struct Test {
    /// The feature and its place.
    pub feature: (String, Span),
    /// How it is compared.
    pub relation: Relation,
    /// What it is compared with.
    pub operands: Vec<(Operand, Span)>,
    /// Place of the whole comparison.
    pub span: Span,
}

/// How a feature is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// `==`, or `in` a list.
    Equal,
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
}

/// What a feature is compared with.
#[derive(Debug, Clone, PartialEq)]
pub enum Operand {
    /// A fixed value.
    Literal(Value),
    /// A factor times another feature.
    Feature(f64, String),
}

/// Where and why a text is no condition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SyntaxError {
    /// Place in the text.
    pub span: Span,
    /// What was expected.
    pub message: String,
}

/// Reads a condition.
///
/// # Errors
/// The first place where the text is no condition.
pub fn parse(text: &str) -> Result<Expr, SyntaxError> {
    let tokens = tokens(text)?;
    let mut parser = Parser { tokens: &tokens, next: 0, end: text.len(), depth: 0, comparisons: 0 };
    let expr = parser.condition()?;
    match parser.peek() {
        None => Ok(expr),
        Some(token) => {
            Err(error(&token.span, format!("expected `and`, `or` or the end, found {}", token.kind)))
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Word(String),
    Number(f64),
    Name(String),
    Symbol(&'static str),
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Word(word) => write!(f, "`{word}`"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => write!(f, "'{name}'"),
            Self::Symbol(symbol) => write!(f, "`{symbol}`"),
        }
    }
}

#[derive(Debug)]
struct Token {
    kind: Kind,
    span: Span,
}

fn error(span: &Span, message: String) -> SyntaxError {
    SyntaxError { span: span.clone(), message }
}

const SYMBOLS: [&str; 12] = ["==", "!=", "<=", ">=", "<", ">", "(", ")", "[", "]", ",", "*"];
const RESERVED: [&str; 7] = ["and", "or", "not", "in", "true", "false", "always"];
/// Deepest nesting of parentheses and `not`; deeper conditions are nobody's.
const DEPTH_LIMIT: usize = 32;
/// Most comparisons of a condition, each value of a list counted: the search for conflicts and gaps looks at their combinations, and a
/// chain of `and` or `or` is as deep as it is long.
const COMPARISONS_LIMIT: usize = 256;

fn tokens(text: &str) -> Result<Vec<Token>, SyntaxError> {
    let bytes = text.as_bytes();
    let run = |from: usize, accept: fn(u8) -> bool| {
        bytes[from..].iter().position(|b| !accept(*b)).map_or(bytes.len(), |n| from + n)
    };
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let first = bytes[at];
        let end;
        let kind = if first.is_ascii_whitespace() {
            at += 1;
            continue;
        } else if first.is_ascii_alphabetic() {
            end = run(at, |b| b.is_ascii_alphanumeric() || b == b'_' || b == b'.');
            Kind::Word(text[at..end].to_string())
        } else if first == b'\'' || first == b'"' {
            let close = bytes[at + 1..].iter().position(|b| *b == first);
            let length = close
                .ok_or_else(|| error(&(at..bytes.len()), "this name has no closing quote".to_string()))?;
            end = at + length + 2;
            Kind::Name(text[at + 1..end - 1].to_string())
        } else if first.is_ascii_digit() || first == b'.' || first == b'-' {
            end = number_end(bytes, at);
            let number = text[at..end].parse::<f64>().ok().filter(|x| x.is_finite());
            Kind::Number(
                number.ok_or_else(|| error(&(at..end), format!("`{}` is no number", &text[at..end])))?,
            )
        } else if let Some(symbol) = SYMBOLS.iter().find(|s| text[at..].starts_with(**s)) {
            end = at + symbol.len();
            Kind::Symbol(symbol)
        } else {
            let c = text[at..].chars().next().unwrap_or(' ');
            let hint = if c == '=' { "; equality is written `==`" } else { "" };
            return Err(error(&(at..at + c.len_utf8()), format!("unexpected `{c}`{hint}")));
        };
        found.push(Token { kind, span: at..end });
        at = end;
    }
    Ok(found)
}

/// Where a number that begins at `at` ends: digits, points, and an exponent with its sign.
fn number_end(bytes: &[u8], at: usize) -> usize {
    let mut end = at + 1;
    while let Some(&b) = bytes.get(end) {
        let sign_of_exponent = matches!(b, b'+' | b'-') && matches!(bytes[end - 1], b'e' | b'E');
        if !(b.is_ascii_alphanumeric() || b == b'.' || b == b'_' || sign_of_exponent) {
            break;
        }
        end += 1;
    }
    end
}

struct Parser<'a> {
    tokens: &'a [Token],
    next: usize,
    end: usize,
    depth: usize,
    /// How many were read so far.
    comparisons: usize,
}

impl<'a> Parser<'a> {
    fn peek(&self) -> Option<&'a Token> {
        self.tokens.get(self.next)
    }

    fn take(&mut self, expected: &str) -> Result<&'a Token, SyntaxError> {
        let token = self
            .peek()
            .ok_or_else(|| error(&(self.end..self.end), format!("expected {expected}, found the end")))?;
        self.next += 1;
        Ok(token)
    }

    fn eat(&mut self, kind: &Kind) -> bool {
        let hit = self.peek().is_some_and(|token| token.kind == *kind);
        self.next += usize::from(hit);
        hit
    }

    fn eat_word(&mut self, word: &str) -> bool {
        self.eat(&Kind::Word(word.to_string()))
    }

    fn expect(&mut self, symbol: &'static str) -> Result<(), SyntaxError> {
        let token = self.take(&format!("`{symbol}`"))?;
        if token.kind == Kind::Symbol(symbol) {
            Ok(())
        } else {
            Err(error(&token.span, format!("expected `{symbol}`, found {}", token.kind)))
        }
    }

    fn condition(&mut self) -> Result<Expr, SyntaxError> {
        let mut left = self.conjunction()?;
        while self.eat_word("or") {
            left = Expr::Or(Box::new(left), Box::new(self.conjunction()?));
        }
        Ok(left)
    }

    fn conjunction(&mut self) -> Result<Expr, SyntaxError> {
        let mut left = self.negation()?;
        while self.eat_word("and") {
            left = Expr::And(Box::new(left), Box::new(self.negation()?));
        }
        Ok(left)
    }

    fn negation(&mut self) -> Result<Expr, SyntaxError> {
        let span = self.peek().map_or(self.end..self.end, |t| t.span.clone());
        if self.depth >= DEPTH_LIMIT {
            return Err(error(&span, format!("nested deeper than {DEPTH_LIMIT}")));
        }
        self.depth += 1;
        let expr = if self.eat_word("not") {
            Expr::Not(Box::new(self.negation()?))
        } else if self.eat(&Kind::Symbol("(")) {
            let inner = self.condition()?;
            self.expect(")")?;
            inner
        } else if self.eat_word("always") {
            Expr::Always
        } else {
            self.comparison()?
        };
        self.depth -= 1;
        Ok(expr)
    }

    fn comparison(&mut self) -> Result<Expr, SyntaxError> {
        let feature = self.feature()?;
        let start = feature.1.start;
        let (relation, negated, operands) = match self.peek().map(|t| t.kind.clone()) {
            Some(Kind::Symbol(symbol @ ("==" | "!=" | "<" | "<=" | ">" | ">="))) => {
                self.next += 1;
                let relation = match symbol {
                    "<" => Relation::Less,
                    "<=" => Relation::AtMost,
                    ">" => Relation::Greater,
                    ">=" => Relation::AtLeast,
                    _ => Relation::Equal,
                };
                (relation, symbol == "!=", vec![self.operand()?])
            }
            Some(Kind::Word(word)) if word == "in" => {
                self.next += 1;
                (Relation::Equal, false, self.list()?)
            }
            Some(Kind::Word(word)) if word == "not" => {
                self.next += 1;
                let token = self.take("`in`")?;
                if token.kind != Kind::Word("in".to_string()) {
                    return Err(error(&token.span, format!("expected `in`, found {}", token.kind)));
                }
                (Relation::Equal, true, self.list()?)
            }
            _ => (Relation::Equal, false, vec![(Operand::Literal(Value::Flag(true)), feature.1.clone())]),
        };
        let span = start..self.tokens[self.next - 1].span.end;
        self.count(&operands)?;
        let test = Expr::Test(Test { feature, relation, operands, span });
        Ok(if negated { Expr::Not(Box::new(test)) } else { test })
    }

    /// Counts comparisons with these.
    fn count(&mut self, operands: &[(Operand, Span)]) -> Result<(), SyntaxError> {
        let left = COMPARISONS_LIMIT - self.comparisons;
        self.comparisons += operands.len();
        match operands.get(left) {
            None => Ok(()),
            Some((_, span)) => Err(error(
                span,
                format!(
                    "comparison {} of a condition, which has at most {COMPARISONS_LIMIT}; make several rules of it, one for each part of an `or`",
                    COMPARISONS_LIMIT + 1
                ),
            )),
        }
    }

    fn feature(&mut self) -> Result<(String, Span), SyntaxError> {
        let token = self.take("a feature")?;
        match &token.kind {
            Kind::Word(word) if !RESERVED.contains(&word.as_str()) => Ok((word.clone(), token.span.clone())),
            other => Err(error(&token.span, format!("expected a feature, found {other}"))),
        }
    }

    fn operand(&mut self) -> Result<(Operand, Span), SyntaxError> {
        let token = self.take("a value or a feature")?;
        let literal = |value| (Operand::Literal(value), token.span.clone());
        Ok(match &token.kind {
            Kind::Number(factor) if self.eat(&Kind::Symbol("*")) => {
                let (name, span) = self.feature()?;
                (Operand::Feature(*factor, name), token.span.start..span.end)
            }
            Kind::Number(number) => literal(Value::Number(*number)),
            Kind::Name(name) => literal(Value::Name(name.clone())),
            Kind::Word(word) if word == "true" || word == "false" => literal(Value::Flag(word == "true")),
            Kind::Word(word) if !RESERVED.contains(&word.as_str()) => {
                (Operand::Feature(1.0, word.clone()), token.span.clone())
            }
            other => return Err(error(&token.span, format!("expected a value or a feature, found {other}"))),
        })
    }

    fn list(&mut self) -> Result<Vec<(Operand, Span)>, SyntaxError> {
        self.expect("[")?;
        let mut items = vec![self.operand()?];
        while self.eat(&Kind::Symbol(",")) {
            items.push(self.operand()?);
        }
        self.expect("]")?;
        Ok(items)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn and_binds_tighter_than_or() {
        let parsed = parse("a or b and not c").unwrap();
        let Expr::Or(left, right) = parsed else { panic!("{parsed:?}") };
        assert!(matches!(*left, Expr::Test(_)));
        assert!(matches!(*right, Expr::And(_, ref c) if matches!(**c, Expr::Not(_))));
    }

    #[test]
    fn spans_point_at_the_text() {
        let text = "  member.kind in ['column', 'beam'] and x <= 1.5 * y";
        let Expr::And(left, right) = parse(text).unwrap() else { panic!() };
        let (Expr::Test(left), Expr::Test(right)) = (*left, *right) else { panic!() };
        assert_eq!(&text[left.span], "member.kind in ['column', 'beam']");
        assert_eq!(&text[left.operands[1].1.clone()], "'beam'");
        assert_eq!(right.operands[0].0, Operand::Feature(1.5, "y".into()));
        assert_eq!(&text[right.operands[0].1.clone()], "1.5 * y");
    }

    #[test]
    fn faults_are_placed() {
        for (text, at, words) in [
            ("", 0..0, "expected a feature, found the end"),
            ("a = 1", 2..3, "equality is written `==`"),
            ("a == ", 5..5, "expected a value or a feature, found the end"),
            ("a == 'x", 5..7, "no closing quote"),
            ("a in 'x'", 5..8, "expected `[`"),
            ("(a", 2..2, "expected `)`"),
            ("a b", 2..3, "expected `and`, `or` or the end, found `b`"),
            ("a < 1e", 4..6, "`1e` is no number"),
            ("a < 12kN", 4..8, "`12kN` is no number"),
            ("and", 0..3, "expected a feature, found `and`"),
            ("a == ü", 5..7, "unexpected `ü`"),
        ] {
            let found = parse(text).unwrap_err();
            assert_eq!(found.span, at, "{text}");
            assert!(found.message.contains(words), "{text}: {}", found.message);
        }
        assert!(parse(&"(".repeat(100_000)).unwrap_err().message.contains("nested deeper"));
    }

    #[test]
    fn long_conditions_are_refused_at_the_place_where_they_are_too_long() {
        for word in ["and", "or"] {
            let chain = |count: usize| vec!["a > 1"; count].join(&format!(" {word} "));
            assert!(parse(&chain(256)).is_ok());
            let found = parse(&chain(30_000)).unwrap_err();
            let at = 256 * (chain(2).len() - 5) + 4;
            assert_eq!(found.span, at..at + 1);
            assert!(
                found
                    .message
                    .contains("comparison 257 of a condition, which has at most 256; make several rules")
            );
        }
        let list = |count: usize| format!("b and a in [{}]", vec!["1"; count].join(","));
        assert!(parse(&list(255)).is_ok());
        assert_eq!(parse(&list(256)).unwrap_err().span, 12 + 2 * 255..13 + 2 * 255);
    }
}
