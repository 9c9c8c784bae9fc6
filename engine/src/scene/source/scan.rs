//! From the text to the tree: brackets, commas and colons.

use std::ops::Range;

use super::lexer::{Lexer, SyntaxError, value_of};
use super::tree::{Entry, Field, Kind, Node, Scalar};

/// Brackets within brackets are refused beyond this depth, so that no text can exhaust the stack.
const MAX_DEPTH: usize = 100;

/// Reads a RON text into a tree. Leading `#![..]` attributes are skipped.
///
/// # Errors
/// The first thing that is wrong with the brackets, commas, colons or words.
pub fn scan(text: &str) -> Result<Node, SyntaxError> {
    let mut scanner = Scanner {
        lexer: Lexer::new(text),
        open: Vec::new(),
    };
    scanner.lexer.skip_attributes()?;
    let root = scanner.value()?;
    scanner.lexer.skip_space()?;
    if scanner.lexer.rest().is_empty() {
        return Ok(root);
    }
    let found = scanner.found();
    let message = format!("expected the end of the text after the value, found {found}");
    Err(SyntaxError::at(scanner.lexer.next_char_span(), message))
}

struct Scanner<'a> {
    lexer: Lexer<'a>,
    /// Where the brackets stand that are open here, outermost first.
    open: Vec<Range<usize>>,
}

/// What stands between parentheses, as it grows.
#[derive(Default)]
struct Parens {
    fields: Vec<Field>,
    items: Vec<Node>,
}

impl Scanner<'_> {
    fn value(&mut self) -> Result<Node, SyntaxError> {
        self.lexer.skip_space()?;
        let start = self.lexer.offset();
        let kind = match self.lexer.peek() {
            Some('(') => self.parens(None)?,
            Some('[') => self.list()?,
            Some('{') => self.map()?,
            _ => match self.lexer.literal() {
                Some(scalar) => Kind::Scalar(scalar?),
                None => match self.lexer.name() {
                    Some((name, span)) => self.named(name, span)?,
                    None => return Err(self.no_value()),
                },
            },
        };
        let span = start..self.lexer.offset();
        Ok(Node { span, kind })
    }

    /// A bare name, or a name with parentheses.
    fn named(&mut self, name: &str, span: Range<usize>) -> Result<Kind, SyntaxError> {
        self.lexer.skip_space()?;
        if self.lexer.peek() == Some('(') {
            return self.parens(Some(span));
        }
        self.lexer.back_to(span.end);
        Ok(Kind::Scalar(match name {
            "true" | "false" => Scalar::Boolean,
            _ if value_of(name).is_some() => Scalar::Number,
            _ => Scalar::Word,
        }))
    }

    fn no_value(&self) -> SyntaxError {
        match (self.lexer.peek(), self.open.last()) {
            (None, Some(_)) => self.unclosed(),
            (Some(')' | ']' | '}'), Some(_)) if !self.at_own_close() => self.unclosed(),
            _ => self.unexpected("a value"),
        }
    }

    /// What stands at this place, for a message.
    fn found(&self) -> String {
        match self.lexer.peek() {
            Some(c) => format!("`{c}`"),
            None => "the end of the text".to_owned(),
        }
    }

    fn unexpected(&self, wanted: &str) -> SyntaxError {
        let message = format!("expected {wanted}, found {}", self.found());
        SyntaxError::at(self.lexer.next_char_span(), message)
    }

    /// The innermost open bracket is never closed: the text ends, or another bracket closes.
    fn unclosed(&self) -> SyntaxError {
        let open = self.open.last().cloned().unwrap_or_default();
        let bracket = self.lexer.slice(open.clone());
        let message = match self.lexer.peek() {
            Some(c) => {
                let (line, column) = self.lexer.line_column(self.lexer.offset());
                format!(
                    "this `{bracket}` is not closed: `{c}` at line {line}, column {column} stands \
                     where its `{}` should",
                    closing(bracket)
                )
            }
            None => format!("this `{bracket}` is never closed"),
        };
        SyntaxError::at(open, message)
    }

    /// A quoted name among fields: a map goes on in which the innermost open bracket stands.
    fn key_inside(&self) -> SyntaxError {
        let open = self.open.last().cloned().unwrap_or_default();
        let (line, column) = self.lexer.line_column(self.lexer.offset());
        let message = format!(
            "this `{}` is not closed before the key at line {line}, column {column}",
            self.lexer.slice(open.clone())
        );
        SyntaxError::at(open, message)
    }

    fn at_own_close(&self) -> bool {
        let open = self.open.last().cloned().unwrap_or_default();
        self.lexer.peek() == Some(closing(self.lexer.slice(open)))
    }

    /// Enters the bracket at this place.
    fn enter(&mut self) -> Result<(), SyntaxError> {
        let span = self.lexer.next_char_span();
        if self.open.len() == MAX_DEPTH {
            let message = format!("brackets are nested deeper than {MAX_DEPTH} levels");
            return Err(SyntaxError::at(span, message));
        }
        self.lexer.back_to(span.end);
        self.open.push(span);
        self.lexer.skip_space()
    }

    /// True, and the bracket left, if it closes here.
    fn leave(&mut self) -> Result<bool, SyntaxError> {
        self.lexer.skip_space()?;
        let close = self.at_own_close();
        if close {
            self.lexer.back_to(self.lexer.next_char_span().end);
            self.open.pop();
        }
        Ok(close)
    }

    /// After a value: a comma, or the end of the brackets (which is left to [`Self::leave`]).
    fn separator(&mut self, value: &Range<usize>) -> Result<(), SyntaxError> {
        self.lexer.skip_space()?;
        match self.lexer.peek() {
            _ if self.lexer.eat(',') || self.at_own_close() => Ok(()),
            None | Some(')' | ']' | '}') => Err(self.unclosed()),
            Some(':' | ';' | '=') => Err(self.unexpected("a comma")),
            Some(_) => Err(self.no_comma(value)),
        }
    }

    /// A string that goes on over lines up to the first quote of another has lost its own.
    fn no_comma(&self, value: &Range<usize>) -> SyntaxError {
        let text = self.lexer.slice(value.clone());
        match text.find('\n') {
            Some(line) if text.starts_with('"') => SyntaxError::at(
                value.start..value.start + line,
                "this string is not closed in its line: a `\"` is missing",
            ),
            _ => SyntaxError::at(value.end..value.end, "a comma is missing here"),
        }
    }

    fn list(&mut self) -> Result<Kind, SyntaxError> {
        self.enter()?;
        let mut items = Vec::new();
        while !self.leave()? {
            let item = self.value()?;
            self.separator(&item.span)?;
            items.push(item);
        }
        Ok(Kind::List(items))
    }

    fn map(&mut self) -> Result<Kind, SyntaxError> {
        self.enter()?;
        let mut entries = Vec::new();
        while !self.leave()? {
            let key = self.value()?;
            self.colon(&key.span, "key")?;
            let value = self.value()?;
            self.separator(&value.span)?;
            let name = key_name(self.lexer.slice(key.span.clone()), &key.kind);
            entries.push(Entry { name, key, value });
        }
        Ok(Kind::Map { entries })
    }

    /// The colon after a field's name or a key.
    fn colon(&mut self, name: &Range<usize>, what: &str) -> Result<(), SyntaxError> {
        self.lexer.skip_space()?;
        if self.lexer.eat(':') {
            return Ok(());
        }
        let text = self.lexer.slice(name.clone());
        match self.lexer.peek() {
            None => Err(self.unclosed()),
            Some(',' | ')' | ']' | '}') => {
                let message = format!("the {what} `{text}` has no value: expected `{text}: value`");
                Err(SyntaxError::at(name.clone(), message))
            }
            Some(_) => Err(SyntaxError::at(
                name.end..name.end,
                format!("a colon is missing after the {what} `{text}`"),
            )),
        }
    }

    fn parens(&mut self, name: Option<Range<usize>>) -> Result<Kind, SyntaxError> {
        self.enter()?;
        let mut inside = Parens::default();
        while !self.leave()? {
            match self.field_name(&inside)? {
                Some((field, name_span)) => self.field(&mut inside, field, name_span)?,
                None => inside.items.push(self.value()?),
            }
            let last = inside.items.last();
            let last = last.or(inside.fields.last().map(|field| &field.value));
            let span = last.map_or(0..0, |value| value.span.clone());
            self.separator(&span)?;
        }
        let Parens { fields, items } = inside;
        Ok(if items.is_empty() {
            Kind::Struct { name, fields }
        } else {
            Kind::Tuple { name, items }
        })
    }

    fn field(
        &mut self,
        inside: &mut Parens,
        name: String,
        name_span: Range<usize>,
    ) -> Result<(), SyntaxError> {
        self.colon(&name_span, "field")?;
        if let Some(item) = inside.items.first() {
            let (line, _) = self.lexer.line_column(item.span.start);
            let message =
                format!("the field `{name}` stands among values without names (line {line})");
            return Err(SyntaxError::at(name_span, message));
        }
        let value = self.value()?;
        inside.fields.push(Field {
            name,
            name_span,
            value,
        });
        Ok(())
    }

    /// The name of a field at this place; `None`, and nothing read, before a value without name.
    fn field_name(
        &mut self,
        inside: &Parens,
    ) -> Result<Option<(String, Range<usize>)>, SyntaxError> {
        let start = self.lexer.offset();
        let found = self.lexer.name().map(|(n, span)| (n.to_owned(), span));
        let named = match &found {
            None => false,
            Some(_) if !inside.fields.is_empty() => true,
            Some(_) => {
                self.lexer.skip_space()?;
                // `(a 1)` lacks a colon; `(a, 1)`, `(a)` and `(A(1), 1)` are values
                let colon = self.lexer.peek() == Some(':');
                colon || inside.items.is_empty() && self.starts_value()
            }
        };
        self.lexer.back_to(if named {
            found.as_ref().map_or(start, |(_, span)| span.end)
        } else {
            start
        });
        match (named, inside.fields.is_empty()) {
            (true, _) => Ok(found),
            (false, true) => Ok(None),
            (false, false) => match self.lexer.peek() {
                None | Some(']' | '}') => Err(self.unclosed()),
                Some('"') => Err(self.key_inside()),
                Some(_) => Err(self.unexpected("the name of a field")),
            },
        }
    }

    /// True before a value that cannot continue a name: not `(`.
    fn starts_value(&self) -> bool {
        self.lexer.peek().is_some_and(|c| {
            matches!(c, '[' | '{' | '"' | '\'' | '+' | '-' | '.') || c.is_alphanumeric()
        })
    }
}

fn closing(open: &str) -> char {
    match open {
        "(" => ')',
        "[" => ']',
        _ => '}',
    }
}

/// What a map key says: a string's contents, otherwise the key's text.
fn key_name(text: &str, kind: &Kind) -> String {
    let plain = (text.strip_prefix('"'))
        .and_then(|t| t.strip_suffix('"'))
        .filter(|t| !t.contains('\\'));
    match (kind, plain) {
        (_, Some(contents)) => contents.to_owned(),
        (Kind::Scalar(Scalar::Text), None) => {
            ron::from_str::<String>(text).unwrap_or_else(|_| text.to_owned())
        }
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests;
