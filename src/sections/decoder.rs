//! Serde's side of bincode: little-endian, integers of fixed size, lengths of 64 bits.
//!
//! Reads what bincode writes, and reports its errors. bincode's own decoder bounds what it reserves by a constant of its type: for
//! limits near the length of the bytes it had to be compiled once for each, 1 kB to 1 GB. Here the limit is the bytes that are left.

use bincode::error::DecodeError;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, IntoDeserializer, MapAccess, SeqAccess, VariantAccess,
    Visitor,
};

/// Decodes values from the front of bytes. Reserves for sequences at most as many elements as bytes are left.
pub(super) struct Decoder<'de> {
    /// What is left.
    pub rest: &'de [u8],
}

impl<'de> Decoder<'de> {
    fn take(&mut self, bytes: usize) -> Result<&'de [u8], DecodeError> {
        let missing = || DecodeError::UnexpectedEnd { additional: bytes - self.rest.len() };
        let (taken, rest) = self.rest.split_at_checked(bytes).ok_or_else(missing)?;
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn length(&mut self) -> Result<usize, DecodeError> {
        let length = u64::from_le_bytes(self.array()?);
        length.try_into().map_err(|_| DecodeError::OutsideUsizeRange(length))
    }

    fn bytes(&mut self) -> Result<&'de [u8], DecodeError> {
        let length = self.length()?;
        self.take(length)
    }

    fn str(&mut self) -> Result<&'de str, DecodeError> {
        std::str::from_utf8(self.bytes()?).map_err(|inner| DecodeError::Utf8 { inner })
    }

    /// Returns whether a byte is 1, if it is 0 or 1.
    fn bit(&mut self) -> Result<bool, DecodeError> {
        match self.array()? {
            [0] => Ok(false),
            [1] => Ok(true),
            [other] => Err(DecodeError::InvalidBooleanValue(other)),
        }
    }
}

macro_rules! numbers {
    ($($method:ident $visit:ident $number:ty),+) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
            visitor.$visit(<$number>::from_le_bytes(self.array()?))
        })+
    };
}

impl<'de> Deserializer<'de> for &mut Decoder<'de> {
    type Error = DecodeError;

    numbers! {
        deserialize_u8 visit_u8 u8, deserialize_u16 visit_u16 u16, deserialize_u32 visit_u32 u32, deserialize_u64 visit_u64 u64,
        deserialize_i8 visit_i8 i8, deserialize_i16 visit_i16 i16, deserialize_i32 visit_i32 i32, deserialize_i64 visit_i64 i64,
        deserialize_u128 visit_u128 u128, deserialize_i128 visit_i128 i128,
        deserialize_f32 visit_f32 f32, deserialize_f64 visit_f64 f64
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_bool(self.bit()?)
    }

    /// UTF-8, without a length.
    fn deserialize_char<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        let first = *self.rest.first().ok_or(DecodeError::UnexpectedEnd { additional: 1 })?;
        let bytes = self.take((first.leading_ones() as usize).clamp(1, 4))?;
        let text = std::str::from_utf8(bytes).map_err(|inner| DecodeError::Utf8 { inner })?;
        visitor.visit_char(text.chars().next().unwrap_or_default())
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_borrowed_str(self.str()?)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_borrowed_str(self.str()?)
    }

    fn deserialize_bytes<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_borrowed_bytes(self.bytes()?)
    }

    fn deserialize_byte_buf<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_borrowed_bytes(self.bytes()?)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        if self.bit()? { visitor.visit_some(self) } else { visitor.visit_none() }
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_unit()
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        visitor.visit_unit()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        let left = self.length()?;
        visitor.visit_seq(Items { decoder: self, left })
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, left: usize, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_seq(Items { decoder: self, left })
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        left: usize,
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        self.deserialize_tuple(left, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        let left = self.length()?;
        visitor.visit_map(Items { decoder: self, left })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        self.deserialize_tuple(fields.len(), visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        visitor.visit_enum(self)
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, DecodeError> {
        Err(DecodeError::custom("bincode does not say of what type a value is"))
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, _: V) -> Result<V::Value, DecodeError> {
        Err(DecodeError::custom("bincode has no names of fields"))
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, DecodeError> {
        Err(DecodeError::custom("bincode does not say how long a value is"))
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

/// Elements of a sequence, or entries of a map.
struct Items<'a, 'de> {
    decoder: &'a mut Decoder<'de>,
    left: usize,
}

impl<'de> SeqAccess<'de> for Items<'_, 'de> {
    type Error = DecodeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, DecodeError> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(&mut *self.decoder).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.left.min(self.decoder.rest.len()))
    }
}

impl<'de> MapAccess<'de> for Items<'_, 'de> {
    type Error = DecodeError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, DecodeError> {
        self.next_element_seed(seed)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, DecodeError> {
        seed.deserialize(&mut *self.decoder)
    }

    fn size_hint(&self) -> Option<usize> {
        SeqAccess::size_hint(self)
    }
}

impl<'de> EnumAccess<'de> for &mut Decoder<'de> {
    type Error = DecodeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), DecodeError> {
        let variant = u32::from_le_bytes(self.array()?);
        Ok((seed.deserialize(variant.into_deserializer())?, self))
    }
}

impl<'de> VariantAccess<'de> for &mut Decoder<'de> {
    type Error = DecodeError;

    fn unit_variant(self) -> Result<(), DecodeError> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, DecodeError> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, left: usize, visitor: V) -> Result<V::Value, DecodeError> {
        self.deserialize_tuple(left, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        self.deserialize_tuple(fields.len(), visitor)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::{Deserialize, Serialize};

    use super::super::meta::{decode, encode};

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    enum Choice {
        Unit,
        New(char),
        Tuple(u8, i16),
        Struct { wide: u128, narrow: f32 },
    }

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct Nothing;

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct All {
        flag: bool,
        numbers: (u16, u32, u64, i8, i32, i64, i128, f64),
        text: String,
        nested: Vec<Option<[u8; 3]>>,
        map: BTreeMap<String, Choice>,
        choices: Vec<Choice>,
        nothing: (Nothing, ()),
    }

    fn all() -> All {
        let choices = ['a', 'ä', '€', '𝄞'].map(Choice::New).into_iter().chain([
            Choice::Unit,
            Choice::Tuple(7, -300),
            Choice::Struct { wide: u128::MAX - 1, narrow: 0.25 },
        ]);
        let choices: Vec<Choice> = choices.collect();
        All {
            flag: true,
            numbers: (1, 2, u64::MAX, -4, -5, i64::MIN, -7, 1e-300),
            text: "läßt".to_owned(),
            nested: vec![None, Some([1, 2, 3])],
            map: choices.iter().map(|choice| (format!("{choice:?}"), choice.clone())).collect(),
            choices,
            nothing: (Nothing, ()),
        }
    }

    #[test]
    fn what_bincode_writes_comes_back() {
        let mut bytes = Vec::new();
        encode(&all(), &mut bytes).unwrap();
        assert_eq!(decode::<All>(&bytes).unwrap(), all());
        for end in 0..bytes.len() {
            assert!(decode::<All>(&bytes[..end]).is_err(), "cut off at {end}");
        }
    }

    #[test]
    fn damage_is_refused_as_bincode_refuses_it() {
        let refused = |bytes: &[u8]| {
            let config = bincode::config::standard().with_fixed_int_encoding();
            let theirs = bincode::serde::decode_from_slice::<(bool, Choice), _>(bytes, config);
            let ours = decode::<(bool, Choice)>(bytes);
            assert!(theirs.is_err() && ours.is_err(), "{bytes:?}: {theirs:?}, {ours:?}");
        };
        refused(&[2, 0, 0, 0, 0]);
        refused(&[1, 4, 0, 0, 0]);
        refused(&[1, 1, 0, 0, 0, 0x80]);
        refused(&[1, 1, 0, 0, 0, 0xF0, 0x9D]);
        refused(&[1, 1, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF]);
    }

    #[test]
    fn lengths_beyond_the_end_reserve_nothing() {
        let bytes = u64::MAX.to_le_bytes();
        assert!(decode::<String>(&bytes).is_err());
        assert!(decode::<Vec<u64>>(&bytes).is_err());
        assert!(decode::<BTreeMap<u8, u8>>(&bytes).is_err());
    }
}
