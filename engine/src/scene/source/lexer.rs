//! The words of RON: space and comments, names, numbers, strings.

use std::ops::Range;

use super::tree::Scalar;

/// What is wrong with the text, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// Bytes of the text at fault; empty where something is missing.
    pub span: Range<usize>,
    /// What is wrong, in words.
    pub message: String,
}

impl SyntaxError {
    /// An error at a range of the text.
    pub(super) fn at(span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            span,
            message: message.into(),
        }
    }
}

/// A place in the text that moves forward.
pub(super) struct Lexer<'a> {
    text: &'a str,
    at: usize,
}

/// True for the characters that `ron` skips between words.
fn is_space(c: char) -> bool {
    matches!(
        c,
        ' ' | '\t' | '\n' | '\r' | '\x0B' | '\x0C' | '\u{85}' | '\u{200E}' | '\u{200F}'
    ) || matches!(c, '\u{2028}' | '\u{2029}')
}

fn starts_name(c: char) -> bool {
    c == '_' || c.is_alphabetic()
}

/// True inside a name; combining accents are part of it.
fn continues_name(c: char) -> bool {
    c == '_' || c.is_alphanumeric() || ('\u{300}'..='\u{36F}').contains(&c)
}

/// True inside a raw name `r#..`.
fn continues_raw_name(c: char) -> bool {
    matches!(c, '.' | '+' | '-') || continues_name(c)
}

/// True if a text is a name that may be written for a field.
pub(super) fn is_name(text: &str) -> bool {
    text.starts_with(starts_name) && text.chars().all(continues_name)
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }

    pub(super) fn offset(&self) -> usize {
        self.at
    }

    pub(super) fn back_to(&mut self, offset: usize) {
        self.at = offset;
    }

    pub(super) fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or_default()
    }

    pub(super) fn slice(&self, span: Range<usize>) -> &'a str {
        self.text.get(span).unwrap_or_default()
    }

    pub(super) fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Range of the next character; empty at the end of the text.
    pub(super) fn next_char_span(&self) -> Range<usize> {
        self.at..self.at + self.peek().map_or(0, char::len_utf8)
    }

    /// Line and column of an offset, from 1, in characters, for a message.
    pub(super) fn line_column(&self, offset: usize) -> (usize, usize) {
        let before = self.slice(0..offset);
        let line = 1 + before.matches('\n').count();
        let column = 1 + before.chars().rev().take_while(|&c| c != '\n').count();
        (line, column)
    }

    pub(super) fn eat(&mut self, c: char) -> bool {
        let found = self.peek() == Some(c);
        if found {
            self.at += c.len_utf8();
        }
        found
    }

    fn eat_while(&mut self, accept: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.at += rest.find(|c| !accept(c)).unwrap_or(rest.len());
    }

    /// Skips space, `// ..` and nested `/* .. */`.
    pub(super) fn skip_space(&mut self) -> Result<(), SyntaxError> {
        loop {
            self.eat_while(is_space);
            if self.rest().starts_with("//") {
                self.eat_while(|c| c != '\n');
            } else if self.rest().starts_with("/*") {
                self.block_comment()?;
            } else {
                return Ok(());
            }
        }
    }

    fn block_comment(&mut self) -> Result<(), SyntaxError> {
        let open = self.at..self.at + 2;
        let mut depth = 0_usize;
        loop {
            let rest = self.rest();
            if rest.starts_with("/*") {
                depth += 1;
                self.at += 2;
            } else if rest.starts_with("*/") {
                depth -= 1;
                self.at += 2;
                if depth == 0 {
                    return Ok(());
                }
            } else if rest.is_empty() {
                return Err(SyntaxError::at(open, "this comment is never closed"));
            } else {
                self.at = self.next_char_span().end;
            }
        }
    }

    /// Skips the attributes `#![..]` before the value.
    pub(super) fn skip_attributes(&mut self) -> Result<(), SyntaxError> {
        self.skip_space()?;
        while self.peek() == Some('#') {
            let open = self.next_char_span();
            let bad = || SyntaxError::at(open.clone(), "expected an attribute `#![enable(..)]`");
            for c in ['#', '!', '['] {
                if !self.eat(c) {
                    return Err(bad());
                }
                self.skip_space()?;
            }
            while !self.eat(']') {
                match self.peek() {
                    Some('"') => self.quoted('"').map(drop)?,
                    Some(_) => self.at = self.next_char_span().end,
                    None => return Err(SyntaxError::at(open, "this `#![..]` is never closed")),
                }
                self.skip_space()?;
            }
            self.skip_space()?;
        }
        Ok(())
    }

    /// A name at this place, without the `r#` of a raw one, and its whole range.
    pub(super) fn name(&mut self) -> Option<(&'a str, Range<usize>)> {
        let start = self.at;
        if self.raw_string_hashes().is_some() || self.rest().starts_with("b'") {
            return None;
        }
        let raw = self.rest().strip_prefix("r#");
        if raw.is_some_and(|r| r.starts_with(continues_raw_name)) {
            self.at += 2;
            self.eat_while(continues_raw_name);
            return Some((self.slice(start + 2..self.at), start..self.at));
        }
        if !self.peek().is_some_and(starts_name) {
            return None;
        }
        self.eat_while(continues_name);
        Some((self.slice(start..self.at), start..self.at))
    }

    /// If a string with a prefix (`r".."`, `r#".."#`, `b".."`, `br".."`) starts here: the length
    /// of the prefix, the number of `#`, and whether it is raw.
    fn raw_string_hashes(&self) -> Option<(usize, usize, bool)> {
        let rest = self.rest();
        let after_b = rest.strip_prefix('b').unwrap_or(rest);
        let after_r = after_b.strip_prefix('r').unwrap_or(after_b);
        let raw = after_r.len() < after_b.len();
        let hashes = if raw {
            after_r.len() - after_r.trim_start_matches('#').len()
        } else {
            0
        };
        let prefix = rest.len() - after_r.len() + hashes;
        let found = prefix > 0 && after_r.get(hashes..)?.starts_with('"');
        found.then_some((prefix, hashes, raw))
    }

    /// A value without brackets that is not a bare name.
    pub(super) fn literal(&mut self) -> Option<Result<Scalar, SyntaxError>> {
        if let Some((prefix, hashes, raw)) = self.raw_string_hashes() {
            self.at += prefix;
            return Some(if raw {
                self.raw_string(hashes)
            } else {
                self.quoted('"')
            });
        }
        if self.rest().starts_with("b'") {
            self.at += 1;
            return Some(self.quoted('\'').map(|_| Scalar::Number));
        }
        match self.peek()? {
            '"' => Some(self.quoted('"')),
            '\'' => Some(self.quoted('\'')),
            '0'..='9' | '+' | '-' | '.' => Some(self.number()),
            _ => None,
        }
    }

    /// A string or a character with escapes, from its opening quote.
    fn quoted(&mut self, quote: char) -> Result<Scalar, SyntaxError> {
        let open = self.at..self.at + 1;
        self.at += 1;
        while let Some(c) = self.peek() {
            self.at += c.len_utf8();
            match c {
                '\\' => self.at = self.next_char_span().end,
                '\n' if quote == '\'' => break,
                c if c == quote && quote == '"' => return Ok(Scalar::Text),
                // the character itself may be a quote: '''
                c if c == quote && (self.at > open.end + 1 || self.peek() != Some(quote)) => {
                    return Ok(Scalar::Character);
                }
                _ => {}
            }
        }
        let what = if quote == '"' { "string" } else { "character" };
        Err(SyntaxError::at(
            open,
            format!("this {what} is never closed"),
        ))
    }

    fn raw_string(&mut self, hashes: usize) -> Result<Scalar, SyntaxError> {
        let open = self.at..self.at + 1;
        self.at += 1;
        let end = format!("\"{}", "#".repeat(hashes));
        match self.rest().find(&end) {
            Some(found) => {
                self.at += found + end.len();
                Ok(Scalar::Text)
            }
            None => Err(SyntaxError::at(
                open,
                format!("this string is never closed: `{end}` is missing"),
            )),
        }
    }

    /// A number from its sign or first digit on.
    fn number(&mut self) -> Result<Scalar, SyntaxError> {
        let start = self.at;
        if matches!(self.peek(), Some('+' | '-')) {
            self.at += 1;
        }
        let mut before = ' ';
        let based = ["0x", "0b", "0o"]
            .iter()
            .any(|b| self.rest().starts_with(b));
        while let Some(c) = self.peek() {
            let exponent = matches!(before, 'e' | 'E') && !based;
            let sign = matches!(c, '+' | '-') && exponent;
            if !(continues_name(c) || c == '.' || sign) {
                break;
            }
            before = c;
            self.at += c.len_utf8();
        }
        let span = start..self.at;
        let found = self.slice(span.clone());
        if is_number(found) {
            Ok(Scalar::Number)
        } else {
            let message = format!("`{found}` is not a number");
            Err(SyntaxError::at(span, message))
        }
    }
}

/// True if a text reads as a RON number.
fn is_number(text: &str) -> bool {
    let digits = text.trim_start_matches(['+', '-']);
    for (prefix, radix) in [("0x", 16), ("0b", 2), ("0o", 8)] {
        if let Some(digits) = digits.strip_prefix(prefix) {
            let digits = without_suffix(digits, &INTEGER_SUFFIXES);
            return digits.contains(|c: char| c.is_digit(radix))
                && digits.chars().all(|c| c == '_' || c.is_digit(radix));
        }
    }
    value_of(text).is_some()
}

const INTEGER_SUFFIXES: [&str; 10] = [
    "i8", "i16", "i32", "i64", "i128", "u8", "u16", "u32", "u64", "u128",
];

fn without_suffix<'a>(digits: &'a str, suffixes: &[&str]) -> &'a str {
    (suffixes.iter())
        .find_map(|s| digits.strip_suffix(s))
        .unwrap_or(digits)
}

/// The value of a decimal number, `inf` or `NaN` as RON writes it; `None` if it is none.
pub(super) fn value_of(text: &str) -> Option<f64> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => (-1.0, digits),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    let single = digits.ends_with("f32");
    let digits = without_suffix(digits, &["f32", "f64"]);
    let value = match digits {
        "inf" => f64::INFINITY,
        "NaN" => f64::NAN,
        _ => {
            let digits = without_suffix(digits, &INTEGER_SUFFIXES);
            if !digits.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
                return None;
            }
            let plain = digits.replace('_', "");
            match single {
                true => plain.parse::<f32>().ok().map(f64::from)?,
                false => plain.parse::<f64>().ok()?,
            }
        }
    };
    Some(sign * value)
}

#[cfg(test)]
mod tests;
