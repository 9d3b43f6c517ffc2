//! JSON as strictly as the standard allows: no duplicate keys, no deep
//! nesting, no numbers beyond `f64`, no byte-order mark, nothing after the end,
//! and a bound on the number of values, so that a small compressed body cannot
//! fill the memory.
//!
//! serde_json reads the text; the visitor here builds the tree and keeps the
//! path, so that every refusal, syntax included, names its place as a JSON
//! pointer beside line and column.

use super::problem::FieldError;
use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};
use std::cell::RefCell;
use std::fmt;

/// Deepest nesting that is read. A job needs eight levels.
pub const MAX_DEPTH: usize = 64;

/// Most points in a body.
pub const MAX_POINTS: usize = 1_000_000;

/// Most JSON values in a body: three numbers and their list for each point,
/// and as many again for knots and weights.
const MAX_VALUES: usize = 6 * MAX_POINTS;

/// The longest excerpt of a value that an error shows, in characters.
const EXCERPT: usize = 60;

/// Reads one JSON document.
///
/// # Errors
/// The first fault, with pointer, code and a sentence with line and column.
/// The code is `syntax`, `duplicate-key`, `too-deep`, `too-many-values`,
/// `number-out-of-range`, `byte-order-mark` or `empty-body`.
pub fn parse(bytes: &[u8]) -> Result<Value, FieldError> {
    if bytes.starts_with(b"\xef\xbb\xbf") {
        return Err(FieldError::new(
            "",
            "byte-order-mark",
            "the body begins with a byte-order mark",
        )
        .hint("save the file as UTF-8 without BOM"));
    }
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(FieldError::new("", "empty-body", "the body is empty")
            .hint("post a job as JSON; GET /v1/examples has some"));
    }
    let walk = RefCell::new(Walk::default());
    let mut reader = serde_json::Deserializer::from_slice(bytes);
    let read = Seed {
        walk: &walk,
        depth: 0,
    }
    .deserialize(&mut reader)
    .and_then(|value| reader.end().map(|()| value));
    read.map_err(|error| walk.into_inner().fault(&error))
}

/// A value, shortened for an error message.
#[must_use]
pub fn excerpt(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(fields) => format!("an object of {}", fields.len()),
        Value::String(text) if text.chars().count() > EXCERPT => {
            format!("\"{}…\"", text.chars().take(EXCERPT).collect::<String>())
        }
        other => other.to_string(),
    }
}

/// One JSON pointer segment, escaped as RFC 6901 asks.
#[must_use]
pub fn escape(segment: &str) -> String {
    segment.replace('~', "~0").replace('/', "~1")
}

#[derive(Debug)]
enum Step {
    Key(String),
    Index(usize),
}

/// Where the reader is, and what it refused.
#[derive(Debug, Default)]
struct Walk {
    path: Vec<Step>,
    values: usize,
    refused: Option<&'static str>,
}

impl Walk {
    fn pointer(&self) -> String {
        self.path
            .iter()
            .map(|step| match step {
                Step::Key(key) => format!("/{}", escape(key)),
                Step::Index(index) => format!("/{index}"),
            })
            .collect()
    }

    fn fault(&self, error: &serde_json::Error) -> FieldError {
        let text = error.to_string();
        let code = match self.refused {
            Some(code) => code,
            None if text.starts_with("number out of range") => "number-out-of-range",
            None => "syntax",
        };
        FieldError::new(self.pointer(), code, text)
    }
}

/// Reads one value at a known depth.
struct Seed<'w> {
    walk: &'w RefCell<Walk>,
    depth: usize,
}

impl Seed<'_> {
    fn refuse<E: serde::de::Error>(&self, code: &'static str, message: String) -> E {
        self.walk.borrow_mut().refused = Some(code);
        E::custom(message)
    }

    /// The seed for a value inside this one.
    fn inner<E: serde::de::Error>(&self) -> Result<Self, E> {
        if self.depth >= MAX_DEPTH {
            let message = format!("lists and objects are nested deeper than {MAX_DEPTH}");
            return Err(self.refuse("too-deep", message));
        }
        Ok(Seed {
            walk: self.walk,
            depth: self.depth + 1,
        })
    }
}

impl<'de> DeserializeSeed<'de> for Seed<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, reader: D) -> Result<Value, D::Error> {
        let values = {
            let mut walk = self.walk.borrow_mut();
            walk.values += 1;
            walk.values
        };
        if values > MAX_VALUES {
            let message = format!("the body has more than {MAX_VALUES} values");
            return Err(self.refuse("too-many-values", message));
        }
        reader.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Seed<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(Value::from(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::from(value))
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Value, E> {
        Number::from_f64(value)
            .map(Value::Number)
            .ok_or_else(|| self.refuse("number-out-of-range", "number out of range".into()))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(Value::from(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let mut items = Vec::new();
        loop {
            self.walk.borrow_mut().path.push(Step::Index(items.len()));
            let item = list.next_element_seed(self.inner::<A::Error>()?)?;
            self.walk.borrow_mut().path.pop();
            match item {
                Some(item) => items.push(item),
                None => return Ok(Value::Array(items)),
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut fields = Map::new();
        while let Some(key) = map.next_key::<String>()? {
            self.walk.borrow_mut().path.push(Step::Key(key.clone()));
            if fields.contains_key(&key) {
                let message = format!("the key {key:?} appears twice in one object");
                return Err(self.refuse("duplicate-key", message));
            }
            let value = map.next_value_seed(self.inner::<A::Error>()?)?;
            self.walk.borrow_mut().path.pop();
            fields.insert(key, value);
        }
        Ok(Value::Object(fields))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &[u8]) -> (String, String) {
        let error = parse(text).unwrap_err();
        (error.code, error.pointer)
    }

    #[test]
    fn reads_what_serde_json_reads() {
        let text = br#"{"a":[1,-2,0.5,1e300,null,true,"x\u00e9"],"b":{}}"#;
        assert_eq!(
            parse(text).unwrap(),
            serde_json::from_slice::<Value>(text).unwrap()
        );
    }

    #[test]
    fn refuses_with_code_and_pointer() {
        let pairs: &[(&[u8], &str, &str)] = &[
            (b"", "empty-body", ""),
            (b" \n", "empty-body", ""),
            (b"\xef\xbb\xbf{}", "byte-order-mark", ""),
            (b"{\"a\":1,\"a\":2}", "duplicate-key", "/a"),
            (
                b"{\"a\":[{\"b\":0},{\"b\":1,\"b\":2}]}",
                "duplicate-key",
                "/a/1/b",
            ),
            (b"{\"a/b\":[0,1e999]}", "number-out-of-range", "/a~1b/1"),
            (b"{\"a\":[0,-1e999]}", "number-out-of-range", "/a/1"),
            (b"{\"a\":NaN}", "syntax", "/a"),
            (b"[1,]", "syntax", "/1"),
            (b"{} x", "syntax", ""),
            (b"{\"a\":\"\xff\"}", "syntax", "/a"),
            (b"\xff\xfe{\x00}\x00", "syntax", ""),
            (b"{\"a\":\"\\ud800\"}", "syntax", "/a"),
        ];
        for (text, code, pointer) in pairs {
            let found = fault(text);
            assert_eq!(found, ((*code).into(), (*pointer).into()), "{text:?}");
        }
    }

    #[test]
    fn depth_is_bounded() {
        let nest = |n: usize| [b"[".repeat(n), b"]".repeat(n)].concat();
        assert!(parse(&nest(MAX_DEPTH)).is_ok());
        assert_eq!(fault(&nest(MAX_DEPTH + 2)).0, "too-deep");
        assert_eq!(fault(&b"[".repeat(100_000)).0, "too-deep");
    }

    #[test]
    fn the_sentence_has_line_and_column() {
        let error = parse(b"{\n  \"a\": ,\n}").unwrap_err();
        assert!(
            error.message.contains("line 2 column 8"),
            "{}",
            error.message
        );
    }
}
