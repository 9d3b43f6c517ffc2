//! Checks a JSON value against a schema of the service's own OpenAPI document,
//! so that what is documented and what is accepted cannot drift apart: every
//! bound, word list and required field is written once, at the DTO.
//!
//! All faults are collected, each with its JSON pointer, and an unknown field
//! is answered with the known name it resembles.
//!
//! Limits: the keywords that the DTOs use and no more (`$ref`, `allOf` of one,
//! `oneOf` of null and one, `type`, `enum`, bounds, lengths, counts, `items`,
//! `properties`, `required`, `additionalProperties: false`). A schema with
//! anything else does not compile, which a test would show.

use super::did_you_mean::{nearest, unknown};
use super::problem::{FieldError, MAX_LISTED_ERRORS};
use super::strict_json::{escape, excerpt};
use serde_json::{Map, Value};

/// A compiled schema.
#[derive(Debug, Clone)]
pub enum Rule {
    /// `null` or the inner rule.
    Nullable(Box<Rule>),
    /// An object without other fields than these.
    Object(Vec<Field>),
    /// A list with bounds on its length.
    List {
        /// The rule of each item.
        item: Box<Rule>,
        /// Least length.
        min: usize,
        /// Greatest length.
        max: usize,
    },
    /// A number within bounds.
    Number(Bounds),
    /// A string with bounds on its length in characters.
    Text {
        /// Least length.
        min: usize,
        /// Greatest length.
        max: usize,
    },
    /// One of these words.
    Word(Vec<String>),
    /// True or false.
    Flag,
}

/// A field of an object.
#[derive(Debug, Clone)]
pub struct Field {
    name: String,
    required: bool,
    rule: Rule,
}

/// Bounds of a number, and whether it must be whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    min: f64,
    max: f64,
    above: f64,
    below: f64,
    whole: bool,
}

/// Where a value is; linked, so that a million points cost no allocation.
#[derive(Debug, Clone, Copy)]
enum Place<'a> {
    Root,
    Key(&'a Place<'a>, &'a str),
    Index(&'a Place<'a>, usize),
}

impl Place<'_> {
    fn pointer(&self) -> String {
        match self {
            Place::Root => String::new(),
            Place::Key(parent, key) => format!("{}/{}", parent.pointer(), escape(key)),
            Place::Index(parent, index) => format!("{}/{index}", parent.pointer()),
        }
    }
}

impl Rule {
    /// Compiles `schema`, looking names up in `components` (the document's
    /// `components/schemas`).
    ///
    /// # Errors
    /// A sentence about the first keyword that is not understood.
    pub fn compile(schema: &Value, components: &Map<String, Value>) -> Result<Rule, String> {
        if let Some(name) = schema["$ref"].as_str() {
            let name = name.rsplit('/').next().unwrap_or_default();
            let target = components
                .get(name)
                .ok_or_else(|| format!("no schema {name}"))?;
            return Rule::compile(target, components);
        }
        if let Some([only]) = schema["allOf"].as_array().map(Vec::as_slice) {
            return Rule::compile(only, components);
        }
        if let Some(choices) = schema["oneOf"].as_array() {
            return Rule::compile_choice(choices, components);
        }
        match &schema["type"] {
            Value::String(kind) => Rule::compile_type(kind, schema, components),
            Value::Array(kinds) => {
                let kind = kinds
                    .iter()
                    .filter_map(Value::as_str)
                    .find(|k| *k != "null");
                let kind = kind.ok_or("a type list of null alone")?;
                let rule = Rule::compile_type(kind, schema, components)?;
                Ok(Rule::Nullable(Box::new(rule)))
            }
            _ => Err(format!("a schema without a type: {schema}")),
        }
    }

    fn compile_choice(choices: &[Value], components: &Map<String, Value>) -> Result<Rule, String> {
        match choices {
            [null, other] | [other, null] if null["type"] == "null" => {
                Ok(Rule::Nullable(Box::new(Rule::compile(other, components)?)))
            }
            _ => Err("oneOf other than null or one".into()),
        }
    }

    fn compile_type(
        kind: &str,
        schema: &Value,
        components: &Map<String, Value>,
    ) -> Result<Rule, String> {
        let count = |key: &str, otherwise: usize| {
            schema[key]
                .as_u64()
                .map_or(otherwise, |n| usize::try_from(n).unwrap_or(otherwise))
        };
        match kind {
            "object" => Rule::compile_object(schema, components),
            "array" => Ok(Rule::List {
                item: Box::new(Rule::compile(&schema["items"], components)?),
                min: count("minItems", 0),
                max: count("maxItems", usize::MAX),
            }),
            "number" => Ok(Rule::Number(Bounds::read(schema, false))),
            "integer" => Ok(Rule::Number(Bounds::read(schema, true))),
            "boolean" => Ok(Rule::Flag),
            "string" => Ok(match schema["enum"].as_array() {
                Some(words) => Rule::Word(
                    words
                        .iter()
                        .filter_map(Value::as_str)
                        .map(str::to_owned)
                        .collect(),
                ),
                None => Rule::Text {
                    min: count("minLength", 0),
                    max: count("maxLength", usize::MAX),
                },
            }),
            other => Err(format!("unknown type {other}")),
        }
    }

    fn compile_object(schema: &Value, components: &Map<String, Value>) -> Result<Rule, String> {
        let empty = Map::new();
        let properties = schema["properties"].as_object().unwrap_or(&empty);
        let required = schema["required"]
            .as_array()
            .map(Vec::as_slice)
            .unwrap_or_default();
        if schema["additionalProperties"] != false {
            return Err("an object that takes any field".into());
        }
        let fields = properties.iter().map(|(name, inner)| {
            Ok(Field {
                name: name.clone(),
                required: required.iter().any(|r| r == name),
                rule: Rule::compile(inner, components)?,
            })
        });
        Ok(Rule::Object(fields.collect::<Result<_, String>>()?))
    }

    /// Every fault of a value, in document order, at most 51 (fifty are shown).
    #[must_use]
    pub fn faults(&self, value: &Value) -> Vec<FieldError> {
        let mut faults = Vec::new();
        self.check(value, &Place::Root, &mut faults);
        faults
    }

    fn check(&self, value: &Value, at: &Place<'_>, faults: &mut Vec<FieldError>) {
        if faults.len() > MAX_LISTED_ERRORS {
            return;
        }
        match (self, value) {
            (Rule::Nullable(_), Value::Null) | (Rule::Flag, Value::Bool(_)) => {}
            (Rule::Nullable(inner), _) => inner.check(value, at, faults),
            (Rule::Object(fields), Value::Object(given)) => {
                check_object(fields, given, at, faults);
            }
            (Rule::List { item, min, max }, Value::Array(items)) => {
                check_count(items.len(), *min, *max, at, faults);
                for (i, inner) in items.iter().enumerate() {
                    item.check(inner, &Place::Index(at, i), faults);
                }
            }
            (Rule::Number(bounds), Value::Number(number)) => {
                if let Some((code, message)) = bounds.broken_by(number.as_f64()) {
                    faults.push(
                        FieldError::new(at.pointer(), code, message).value(number.to_string()),
                    );
                }
            }
            (Rule::Text { min, max }, Value::String(text)) => {
                check_text(text, *min, *max, at, faults);
            }
            (Rule::Word(words), Value::String(text)) => check_word(words, text, at, faults),
            _ => faults.push(self.wrong_type(value, at)),
        }
    }

    fn wrong_type(&self, value: &Value, at: &Place<'_>) -> FieldError {
        let wanted = match self {
            Rule::Nullable(inner) => return inner.wrong_type(value, at),
            Rule::Object(_) => "an object",
            Rule::List { .. } => "a list",
            Rule::Number(bounds) if bounds.whole => "a whole number",
            Rule::Number(_) => "a number",
            Rule::Text { .. } | Rule::Word(_) => "a string",
            Rule::Flag => "true or false",
        };
        FieldError::new(at.pointer(), "wrong-type", format!("this must be {wanted}"))
            .value(excerpt(value))
    }
}

impl Bounds {
    fn read(schema: &Value, whole: bool) -> Bounds {
        let bound = |key: &str, otherwise: f64| schema[key].as_f64().unwrap_or(otherwise);
        Bounds {
            min: bound("minimum", f64::NEG_INFINITY),
            max: bound("maximum", f64::INFINITY),
            above: bound("exclusiveMinimum", f64::NEG_INFINITY),
            below: bound("exclusiveMaximum", f64::INFINITY),
            whole,
        }
    }

    fn broken_by(&self, number: Option<f64>) -> Option<(&'static str, String)> {
        let Some(x) = number.filter(|x| x.is_finite()) else {
            return Some(("number-out-of-range", "this number is not finite".into()));
        };
        if self.whole && x.fract() != 0.0 {
            return Some(("wrong-type", "this must be a whole number".into()));
        }
        let broken = if x < self.min {
            format!("at least {}", self.min)
        } else if x > self.max {
            format!("at most {}", self.max)
        } else if x <= self.above {
            format!("greater than {}", self.above)
        } else if x >= self.below {
            format!("less than {}", self.below)
        } else {
            return None;
        };
        Some(("out-of-range", format!("this must be {broken}")))
    }
}

fn check_object(
    fields: &[Field],
    given: &Map<String, Value>,
    at: &Place<'_>,
    faults: &mut Vec<FieldError>,
) {
    for field in fields {
        match given.get(&field.name) {
            Some(value) => field
                .rule
                .check(value, &Place::Key(at, &field.name), faults),
            None if field.required => faults.push(FieldError::new(
                Place::Key(at, &field.name).pointer(),
                "missing",
                format!("the field \"{}\" is missing", field.name),
            )),
            None => {}
        }
    }
    let known: Vec<&str> = fields.iter().map(|f| f.name.as_str()).collect();
    for name in given.keys().filter(|name| !known.contains(&name.as_str())) {
        let pointer = Place::Key(at, name).pointer();
        faults.push(unknown(pointer, "unknown-field", name, &known));
    }
}

fn check_count(n: usize, min: usize, max: usize, at: &Place<'_>, faults: &mut Vec<FieldError>) {
    let (code, message) = if n < min {
        (
            "too-few",
            format!("this list needs at least {min} items, it has {n}"),
        )
    } else if n > max {
        (
            "too-many",
            format!("this list may have at most {max} items, it has {n}"),
        )
    } else {
        return;
    };
    faults.push(FieldError::new(at.pointer(), code, message));
}

fn check_text(text: &str, min: usize, max: usize, at: &Place<'_>, faults: &mut Vec<FieldError>) {
    let n = text.chars().count();
    if n < min || n > max {
        let message = format!("this text must have {min} to {max} characters, it has {n}");
        faults.push(FieldError::new(at.pointer(), "wrong-length", message));
    }
}

fn check_word(words: &[String], text: &str, at: &Place<'_>, faults: &mut Vec<FieldError>) {
    if words.iter().any(|word| word == text) {
        return;
    }
    let known: Vec<&str> = words.iter().map(String::as_str).collect();
    let message = format!("this must be one of {}", known.join(", "));
    let error =
        FieldError::new(at.pointer(), "not-one-of", message).value(excerpt(&Value::from(text)));
    faults.push(match nearest(text, &known) {
        Some(near) => error.hint(format!("did you mean \"{near}\"?")),
        None => error,
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn rule() -> Rule {
        let components = json!({
            "Mode": {"type": "string", "enum": ["exact", "auto"]},
            "Point": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
        });
        let schema = json!({
            "type": "object", "additionalProperties": false, "required": ["points", "mode"],
            "properties": {
                "mode": {"$ref": "#/components/schemas/Mode"},
                "points": {"type": "array", "minItems": 1,
                           "items": {"$ref": "#/components/schemas/Point"}},
                "limit": {"type": ["number", "null"], "exclusiveMinimum": 0, "maximum": 45},
                "n": {"type": "integer", "minimum": 1},
            }
        });
        Rule::compile(&schema, components.as_object().unwrap()).unwrap()
    }

    fn found(value: &Value) -> Vec<(String, String)> {
        rule()
            .faults(value)
            .into_iter()
            .map(|f| (f.pointer, f.code))
            .collect()
    }

    #[test]
    fn accepts_what_fits() {
        let good = json!({"mode": "exact", "points": [[0, 1.5, 2]], "limit": null, "n": 3.0});
        assert_eq!(found(&good), []);
    }

    #[test]
    fn names_every_fault() {
        let bad = json!({"mode": "exakt", "points": [[0, "x", 2], [1, 2]], "limit": 0, "n": 1.5,
                         "limt": 1});
        let pairs = found(&bad);
        for (pointer, code) in [
            ("/mode", "not-one-of"),
            ("/points/0/1", "wrong-type"),
            ("/points/1", "too-few"),
            ("/limit", "out-of-range"),
            ("/n", "wrong-type"),
            ("/limt", "unknown-field"),
        ] {
            assert!(
                pairs.contains(&(pointer.into(), code.into())),
                "{pointer} in {pairs:?}"
            );
        }
        assert_eq!(
            found(&json!({"mode": "auto"})),
            [("/points".into(), "missing".into())]
        );
    }
}
