//! A serializer that writes nothing and finds the first number that is not finite.
//!
//! JSON has no NaN, and `serde_json` silently writes `null` for it; this finds it first and says where.

use std::fmt::Display;

use serde::ser::{self, Serialize};

/// Where a value is not finite, or what another part of the value's serialization complained about.
#[derive(Debug)]
pub(crate) enum Finding {
    NotFinite { path: String, value: f64 },
    Other(String),
}

impl Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite { path, value } => write!(f, "{path} is {value}"),
            Self::Other(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for Finding {}

impl ser::Error for Finding {
    fn custom<T: Display>(message: T) -> Self {
        Self::Other(message.to_string())
    }
}

type Check = Result<(), Finding>;

/// Checks every number in `value`; a finding carries its path, as in `steps[3].energy`.
pub(crate) fn check_finite<T: Serialize + ?Sized>(value: &T) -> Check {
    value.serialize(Checker {
        path: &mut String::new(),
    })
}

struct Checker<'a> {
    path: &'a mut String,
}

impl Checker<'_> {
    /// Checks a part, with its name added to the path meanwhile.
    fn part<T: Serialize + ?Sized>(&mut self, name: &str, value: &T) -> Check {
        let length = self.path.len();
        self.path.push_str(name);
        value.serialize(Checker { path: self.path })?;
        self.path.truncate(length);
        Ok(())
    }

    fn field<T: Serialize + ?Sized>(&mut self, name: &str, value: &T) -> Check {
        if self.path.is_empty() {
            self.part(name, value)
        } else {
            self.part(&format!(".{name}"), value)
        }
    }
}

/// A sequence, map or struct being checked.
struct Compound<'a> {
    checker: Checker<'a>,
    index: usize,
    key: String,
}

impl<'a> Compound<'a> {
    fn new(checker: Checker<'a>) -> Self {
        Self {
            checker,
            index: 0,
            key: String::new(),
        }
    }

    fn element<T: Serialize + ?Sized>(&mut self, value: &T) -> Check {
        let name = format!("[{}]", self.index);
        self.index += 1;
        self.checker.part(&name, value)
    }
}

macro_rules! accept {
    ($($name:ident: $type:ty),*) => {
        $(fn $name(self, _: $type) -> Check {
            Ok(())
        })*
    };
}

impl<'a> ser::Serializer for Checker<'a> {
    type Ok = ();
    type Error = Finding;
    type SerializeSeq = Compound<'a>;
    type SerializeTuple = Compound<'a>;
    type SerializeTupleStruct = Compound<'a>;
    type SerializeTupleVariant = Compound<'a>;
    type SerializeMap = Compound<'a>;
    type SerializeStruct = Compound<'a>;
    type SerializeStructVariant = Compound<'a>;

    accept!(serialize_bool: bool, serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64,
        serialize_i128: i128, serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64,
        serialize_u128: u128, serialize_char: char, serialize_str: &str, serialize_bytes: &[u8],
        serialize_unit_struct: &'static str);

    fn serialize_f32(self, value: f32) -> Check {
        self.serialize_f64(f64::from(value))
    }

    fn serialize_f64(self, value: f64) -> Check {
        if value.is_finite() {
            Ok(())
        } else {
            Err(Finding::NotFinite {
                path: self.path.clone(),
                value,
            })
        }
    }

    fn serialize_none(self) -> Check {
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Check {
        value.serialize(self)
    }

    fn serialize_unit(self) -> Check {
        Ok(())
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, _: &'static str) -> Check {
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Check {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        mut self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        value: &T,
    ) -> Check {
        self.field(variant, value)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Compound<'a>, Finding> {
        Ok(Compound::new(self))
    }

    fn serialize_tuple(self, _: usize) -> Result<Compound<'a>, Finding> {
        Ok(Compound::new(self))
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Compound<'a>, Finding> {
        Ok(Compound::new(self))
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Compound<'a>, Finding> {
        Ok(Compound::new(self))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Compound<'a>, Finding> {
        Ok(Compound::new(self))
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Compound<'a>, Finding> {
        Ok(Compound::new(self))
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Compound<'a>, Finding> {
        Ok(Compound::new(self))
    }
}

macro_rules! elements {
    ($($trait:ident::$method:ident),*) => {
        $(impl ser::$trait for Compound<'_> {
            type Ok = ();
            type Error = Finding;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Check {
                self.element(value)
            }

            fn end(self) -> Check {
                Ok(())
            }
        })*
    };
}

elements!(
    SerializeSeq::serialize_element,
    SerializeTuple::serialize_element,
    SerializeTupleStruct::serialize_field,
    SerializeTupleVariant::serialize_field
);

macro_rules! fields {
    ($($trait:ident),*) => {
        $(impl ser::$trait for Compound<'_> {
            type Ok = ();
            type Error = Finding;

            fn serialize_field<T: Serialize + ?Sized>(&mut self, name: &'static str, value: &T) -> Check {
                self.checker.field(name, value)
            }

            fn end(self) -> Check {
                Ok(())
            }
        })*
    };
}

fields!(SerializeStruct, SerializeStructVariant);

impl ser::SerializeMap for Compound<'_> {
    type Ok = ();
    type Error = Finding;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Check {
        self.key = match serde_json::to_value(key) {
            Ok(serde_json::Value::String(s)) => s,
            Ok(other) => other.to_string(),
            Err(_) => "?".to_owned(),
        };
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Check {
        let key = std::mem::take(&mut self.key);
        self.checker.field(&key, value)
    }

    fn end(self) -> Check {
        Ok(())
    }
}
