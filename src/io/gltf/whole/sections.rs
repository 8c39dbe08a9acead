//! The top level of a document as text: what is not changed is written as it was read, byte for byte.

use std::fmt;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use serde_json::value::{RawValue, to_raw_value};

use crate::io::error::ReadError;

/// The members of a document, in its order.
#[derive(Debug, Clone, Default)]
pub(super) struct Sections(Vec<(String, Box<RawValue>)>);

impl<'de> Deserialize<'de> for Sections {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Members;

        impl<'de> Visitor<'de> for Members {
            type Value = Sections;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Sections, A::Error> {
                let mut sections = Sections::default();
                while let Some((name, text)) = map.next_entry::<String, Box<RawValue>>()? {
                    sections.put(&name, text);
                }
                Ok(sections)
            }
        }

        deserializer.deserialize_map(Members)
    }
}

impl Serialize for Sections {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, text) in &self.0 {
            map.serialize_entry(name, text)?;
        }
        map.end()
    }
}

/// Elements of an array; parsed where they are changed.
pub(super) type Elements = Vec<Box<RawValue>>;

impl Sections {
    pub fn parse(json: &[u8]) -> Result<Self, ReadError> {
        serde_json::from_slice(json).map_err(|e| ReadError::invalid(format!("the glTF document: {e}")))
    }

    fn put(&mut self, name: &str, text: Box<RawValue>) {
        match self.0.iter_mut().find(|section| section.0 == name) {
            Some(section) => section.1 = text,
            None => self.0.push((name.to_owned(), text)),
        }
    }

    /// Returns the names of all sections.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|section| section.0.as_str())
    }

    pub fn get(&self, name: &str) -> Option<&RawValue> {
        self.0.iter().find(|section| section.0 == name).map(|section| &*section.1)
    }

    /// Returns the elements of an array; none if it is not there.
    pub fn array(&self, name: &str) -> Elements {
        self.get(name).and_then(|text| serde_json::from_str(text.get()).ok()).unwrap_or_default()
    }

    /// Sets an array, or removes it if it has no elements.
    pub fn set_array(&mut self, name: &str, elements: &Elements) {
        match to_raw_value(elements) {
            Ok(text) if !elements.is_empty() => self.put(name, text),
            _ => self.0.retain(|section| section.0 != name),
        }
    }

    /// Sets an array of strings, or removes it if it has none.
    pub fn set_strings(&mut self, name: &str, strings: &[String]) {
        self.set_array(name, &strings.iter().map(|s| raw(&Value::from(s.as_str()))).collect());
    }

    /// Returns the strings of an array.
    pub fn strings(&self, name: &str) -> Vec<String> {
        self.get(name).and_then(|text| serde_json::from_str(text.get()).ok()).unwrap_or_default()
    }

    /// Returns the document as text.
    pub fn text(&self) -> Vec<u8> {
        serde_json::to_vec(self).unwrap_or_default()
    }
}

/// Parses an element; null if it is too deep to parse.
pub(super) fn value(text: &RawValue) -> Value {
    serde_json::from_str(text.get()).unwrap_or(Value::Null)
}

/// Returns a value as text.
pub(super) fn raw(value: &Value) -> Box<RawValue> {
    to_raw_value(value).unwrap_or_default()
}

/// Returns a number of a value as an index.
pub(super) fn index(value: Option<&Value>) -> Option<usize> {
    value.and_then(Value::as_u64).and_then(|n| usize::try_from(n).ok())
}

/// Returns the indices named by the members of an object.
pub(super) fn indices(value: Option<&Value>) -> impl Iterator<Item = (&str, usize)> {
    let members = value.and_then(Value::as_object).into_iter().flatten();
    members.filter_map(|(name, value)| Some((name.as_str(), index(Some(value))?)))
}

/// Returns the elements of an array within a value.
pub(super) fn elements(value: Option<&Value>) -> &[Value] {
    value.and_then(Value::as_array).map_or(&[], Vec::as_slice)
}
