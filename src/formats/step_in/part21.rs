//! The exchange structure: ISO 10303-21, clear text, its data sections only.

use super::error::{StepFault, StepReadError};
use std::collections::BTreeMap;

/// A parameter of an entity.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// `#12`.
    Reference(u64),
    /// A whole number or a real.
    Number(f64),
    /// `'deck'`, escapes resolved.
    Text(String),
    /// `.T.`, without its points.
    Word(String),
    /// `(…)`.
    List(Vec<Value>),
    /// `LENGTH_MEASURE(…)`.
    Typed(String, Vec<Value>),
    /// `$`, `*` or a binary.
    Nothing,
}

/// A record: a keyword with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Record {
    pub(super) keyword: String,
    pub(super) parameters: Vec<Value>,
}

/// An entity: one record, or several where it is complex.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entity {
    pub(super) line: usize,
    pub(super) records: Vec<Record>,
}

impl Entity {
    /// The record with a keyword.
    pub(super) fn record(&self, keyword: &str) -> Option<&Record> {
        self.records.iter().find(|r| r.keyword == keyword)
    }
}

/// Lists in lists: a net of poles has two levels.
const DEEPEST: usize = 16;

/// All entities of all data sections.
pub(super) fn parse(bytes: &[u8]) -> Result<BTreeMap<u64, Entity>, StepReadError> {
    let mut reader = Reader {
        bytes,
        at: 0,
        line: 1,
    };
    reader.space()?;
    if !reader.bytes[reader.at..].starts_with(b"ISO-10303-21") {
        return Err(reader.error(StepFault::NotStep));
    }
    let mut entities = BTreeMap::new();
    // What is between the sections are header and keywords: skipped.
    loop {
        reader.space()?;
        match reader.peek() {
            None => return Err(reader.error(StepFault::EndsEarly)),
            Some(b'A'..=b'Z' | b'a'..=b'z' | b'!') => {
                let word = reader.keyword();
                if word == "DATA" {
                    reader.until_semicolon()?;
                    reader.data(&mut entities)?;
                } else if word == "END-ISO-10303-21" {
                    return Ok(entities);
                } else {
                    reader.until_semicolon()?;
                }
            }
            Some(_) => return Err(reader.error(StepFault::Unexpected)),
        }
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn next(&mut self) -> Option<u8> {
        let byte = self.peek()?;
        self.at += 1;
        self.line += usize::from(byte == b'\n');
        Some(byte)
    }

    fn error(&self, fault: StepFault) -> StepReadError {
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        let rest = &rest[..rest.len().min(80)];
        let text = String::from_utf8_lossy(rest);
        StepReadError::new(self.line, text.lines().next().unwrap_or_default(), fault)
    }

    /// Past white space and comments.
    fn space(&mut self) -> Result<(), StepReadError> {
        loop {
            match self.peek() {
                Some(b' ' | b'\t' | b'\r' | b'\n' | 0x0c) => {
                    self.next();
                }
                Some(b'/') if self.bytes.get(self.at + 1) == Some(&b'*') => {
                    self.at += 2;
                    loop {
                        match self.next() {
                            None => return Err(self.error(StepFault::EndsEarly)),
                            Some(b'*') if self.peek() == Some(b'/') => break,
                            Some(_) => {}
                        }
                    }
                    self.next();
                }
                _ => return Ok(()),
            }
        }
    }

    fn expect(&mut self, byte: u8) -> Result<(), StepReadError> {
        self.space()?;
        match self.peek() {
            Some(found) if found == byte => {
                self.next();
                Ok(())
            }
            Some(_) => Err(self.error(StepFault::Unexpected)),
            None => Err(self.error(StepFault::EndsEarly)),
        }
    }

    /// A keyword in capitals; empty where none stands.
    fn keyword(&mut self) -> String {
        let mut word = String::new();
        while let Some(b @ (b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'_' | b'-' | b'!')) =
            self.peek()
        {
            word.push(char::from(b.to_ascii_uppercase()));
            self.next();
        }
        word
    }

    fn until_semicolon(&mut self) -> Result<(), StepReadError> {
        loop {
            self.space()?;
            match self.peek() {
                None => return Err(self.error(StepFault::EndsEarly)),
                Some(b'\'') => {
                    self.text()?;
                }
                Some(b';') => {
                    self.next();
                    return Ok(());
                }
                Some(_) => {
                    self.next();
                }
            }
        }
    }

    /// The entities of a data section, to its end.
    fn data(&mut self, entities: &mut BTreeMap<u64, Entity>) -> Result<(), StepReadError> {
        loop {
            self.space()?;
            match self.peek() {
                Some(b'#') => {
                    let start = self.line;
                    let number = self.reference()?;
                    self.expect(b'=')?;
                    let records = self.records()?;
                    self.expect(b';')?;
                    let entity = Entity {
                        line: start,
                        records,
                    };
                    if entities.insert(number, entity).is_some() {
                        return Err(StepReadError::new(start, "", StepFault::Twice(number)));
                    }
                }
                Some(_) => {
                    let error = self.error(StepFault::Unexpected);
                    if self.keyword() != "ENDSEC" {
                        return Err(error);
                    }
                    return self.until_semicolon();
                }
                None => return Err(self.error(StepFault::EndsEarly)),
            }
        }
    }

    fn reference(&mut self) -> Result<u64, StepReadError> {
        let error = self.error(StepFault::Unexpected);
        self.expect(b'#')?;
        let start = self.at;
        while self.peek().is_some_and(|b| b.is_ascii_digit()) {
            self.next();
        }
        let digits = std::str::from_utf8(&self.bytes[start..self.at]);
        digits.ok().and_then(|d| d.parse().ok()).ok_or(error)
    }

    fn records(&mut self) -> Result<Vec<Record>, StepReadError> {
        self.space()?;
        if self.peek() != Some(b'(') {
            return Ok(vec![self.record()?]);
        }
        self.next();
        let mut records = Vec::new();
        loop {
            self.space()?;
            if self.peek() == Some(b')') {
                self.next();
                return Ok(records);
            }
            records.push(self.record()?);
        }
    }

    fn record(&mut self) -> Result<Record, StepReadError> {
        self.space()?;
        let error = self.error(StepFault::Unexpected);
        let keyword = self.keyword();
        if keyword.is_empty() {
            return Err(error);
        }
        Ok(Record {
            keyword,
            parameters: self.list(0)?,
        })
    }

    fn list(&mut self, depth: usize) -> Result<Vec<Value>, StepReadError> {
        if depth > DEEPEST {
            return Err(self.error(StepFault::TooDeep));
        }
        self.expect(b'(')?;
        let mut values = Vec::new();
        self.space()?;
        if self.peek() == Some(b')') {
            self.next();
            return Ok(values);
        }
        loop {
            values.push(self.value(depth)?);
            self.space()?;
            match self.peek() {
                Some(b',') => {
                    self.next();
                }
                Some(b')') => {
                    self.next();
                    return Ok(values);
                }
                Some(_) => return Err(self.error(StepFault::Unexpected)),
                None => return Err(self.error(StepFault::EndsEarly)),
            }
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, StepReadError> {
        self.space()?;
        match self.peek() {
            Some(b'#') => self.reference().map(Value::Reference),
            Some(b'(') => self.list(depth + 1).map(Value::List),
            Some(b'\'') => self.text().map(Value::Text),
            Some(b'$' | b'*') => {
                self.next();
                Ok(Value::Nothing)
            }
            Some(b'"') => {
                self.next();
                while self
                    .next()
                    .ok_or_else(|| self.error(StepFault::EndsEarly))?
                    != b'"'
                {}
                Ok(Value::Nothing)
            }
            Some(b'.') if !self.bytes.get(self.at + 1).is_some_and(u8::is_ascii_digit) => {
                self.next();
                let word = self.keyword();
                self.expect(b'.')?;
                Ok(Value::Word(word))
            }
            Some(b'0'..=b'9' | b'+' | b'-' | b'.') => self.number().map(Value::Number),
            Some(b'A'..=b'Z' | b'a'..=b'z' | b'!') => {
                let keyword = self.keyword();
                Ok(Value::Typed(keyword, self.list(depth + 1)?))
            }
            Some(_) => Err(self.error(StepFault::Unexpected)),
            None => Err(self.error(StepFault::EndsEarly)),
        }
    }

    fn number(&mut self) -> Result<f64, StepReadError> {
        let error = self.error(StepFault::Unexpected);
        let start = self.at;
        while matches!(
            self.peek(),
            Some(b'0'..=b'9' | b'+' | b'-' | b'.' | b'E' | b'e')
        ) {
            self.next();
        }
        let text = std::str::from_utf8(&self.bytes[start..self.at]);
        let number: Option<f64> = text.ok().and_then(|t| t.parse().ok());
        number.filter(|x| x.is_finite()).ok_or(error)
    }

    /// A string with its escapes resolved (6.4.3).
    fn text(&mut self) -> Result<String, StepReadError> {
        self.expect(b'\'')?;
        let mut raw = Vec::new();
        loop {
            match self.next() {
                None => return Err(self.error(StepFault::EndsEarly)),
                Some(b'\'') if self.peek() == Some(b'\'') => {
                    self.next();
                    raw.push(b'\'');
                }
                Some(b'\'') => break,
                // A string may go on in the next line.
                Some(b'\r' | b'\n') => {}
                Some(byte) => raw.push(byte),
            }
        }
        Ok(unescaped(&String::from_utf8_lossy(&raw)))
    }
}

/// `\X2\…\X0\`, `\X4\…\X0\`, `\X\hh`, `\S\c` and `\\`; anything else stays.
fn unescaped(raw: &str) -> String {
    let mut out = String::new();
    let mut rest = raw;
    while let Some(at) = rest.find('\\') {
        out.push_str(&rest[..at]);
        let escape = &rest[at..];
        let wide = [("\\X2\\", 4), ("\\X4\\", 8)];
        let wide = wide.iter().find(|(mark, _)| escape.starts_with(mark));
        if let Some((mark, digits)) = wide {
            let body = &escape[mark.len()..];
            let (hex, after) = body.split_once("\\X0\\").unwrap_or((body, ""));
            let codes: Vec<u32> = (hex.as_bytes().chunks(*digits))
                .filter_map(|c| u32::from_str_radix(std::str::from_utf8(c).ok()?, 16).ok())
                .collect();
            if *digits == 4 {
                let units: Vec<u16> = codes.iter().map(|c| *c as u16).collect();
                out.push_str(&String::from_utf16_lossy(&units));
            } else {
                out.extend(codes.iter().filter_map(|c| char::from_u32(*c)));
            }
            rest = after;
        } else if let Some(body) = escape.strip_prefix("\\X\\") {
            let code = body.get(..2).and_then(|h| u8::from_str_radix(h, 16).ok());
            out.extend(code.map(char::from));
            rest = if code.is_some() { &body[2..] } else { body };
        } else if let Some(body) = escape.strip_prefix("\\S\\") {
            let mut letters = body.chars();
            let letter = letters
                .next()
                .and_then(|c| char::from_u32(u32::from(c) + 128));
            out.extend(letter);
            rest = letters.as_str();
        } else {
            out.push('\\');
            rest = escape.strip_prefix("\\\\").unwrap_or(&escape[1..]);
        }
    }
    out.push_str(rest);
    out
}
