//! The header of a PLY file: what the body holds, in which order and types.

use super::bytes::{ByteOrder, Scalar};
use super::error::{Fault, MeshReadError, Place};
use super::text::{Lines, words};

/// How the body is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Binary(ByteOrder),
}

/// One property of an element.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

/// What a property is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A sort of things, so many of them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
    /// The line that announces it.
    pub line: usize,
}

impl Element {
    /// The place of a property.
    pub fn position(&self, names: &[&str]) -> Option<usize> {
        let named = |p: &Property| names.contains(&p.name.as_str());
        self.properties.iter().position(named)
    }

    /// Fewest bytes of one of these in a binary file.
    pub fn least_bytes(&self) -> usize {
        let least = |p: &Property| match p.kind {
            Kind::One(scalar) => scalar.size(),
            Kind::List { count, .. } => count.size(),
        };
        self.properties.iter().map(least).sum()
    }
}

/// A header.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Where the body begins, in bytes.
    pub body: usize,
    /// Lines of the header.
    pub lines: usize,
}

/// More elements or properties than any PLY file has.
const MOST: usize = 1_000;

pub(super) fn read(bytes: &[u8]) -> Result<Header, MeshReadError> {
    let mut lines = Lines::new(bytes);
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some((line, text)) = lines.next() {
        let fail = |fault| MeshReadError::new(Place::Line(line), text.trim(), fault);
        let words: Vec<&str> = words(&text).take(MOST).collect();
        match words.as_slice() {
            [] | ["ply" | "comment" | "obj_info", ..] => {}
            ["format", name, ..] => {
                let found = encoding_named(name);
                encoding = Some(found.ok_or_else(|| fail(Fault::Header("unknown encoding")))?);
            }
            ["element", name, count, ..] if elements.len() < MOST => elements.push(Element {
                name: (*name).to_owned(),
                count: count.parse().map_err(|_| fail(Fault::NotANumber))?,
                properties: Vec::new(),
                line,
            }),
            ["property", rest @ ..] => {
                let property = property(rest);
                let property = property.ok_or_else(|| fail(Fault::Header("unknown property")))?;
                let element = elements.last_mut();
                let element = element.filter(|e| e.properties.len() < MOST);
                let early = || fail(Fault::Header("a property without an element"));
                element.ok_or_else(early)?.properties.push(property);
            }
            ["end_header"] => {
                return Ok(Header {
                    encoding: encoding.ok_or_else(|| fail(Fault::Header("no format line")))?,
                    elements,
                    body: lines.offset(),
                    lines: line,
                });
            }
            _ => return Err(fail(Fault::UnexpectedWord)),
        }
    }
    Err(MeshReadError::new(
        Place::Line(lines.number()),
        "",
        Fault::Header("the header has no end"),
    ))
}

fn encoding_named(name: &str) -> Option<Encoding> {
    match name {
        "ascii" => Some(Encoding::Text),
        "binary_little_endian" => Some(Encoding::Binary(ByteOrder::Little)),
        "binary_big_endian" => Some(Encoding::Binary(ByteOrder::Big)),
        _ => None,
    }
}

fn property(words: &[&str]) -> Option<Property> {
    let (kind, name) = match words {
        ["list", count, item, name] => {
            let (count, item) = (scalar(count)?, scalar(item)?);
            (Kind::List { count, item }, name)
        }
        [kind, name] => (Kind::One(scalar(kind)?), name),
        _ => return None,
    };
    Some(Property {
        name: (*name).to_owned(),
        kind,
    })
}

fn scalar(word: &str) -> Option<Scalar> {
    Some(match word {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}
