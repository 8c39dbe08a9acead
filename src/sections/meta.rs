//! Small values by serde and bincode: little-endian, integers of fixed size.

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::BakeError;
use super::decoder::Decoder;

/// Appends a value to bytes.
pub(crate) fn encode<T: Serialize>(value: &T, to: &mut Vec<u8>) -> Result<(), BakeError> {
    let config = bincode::config::standard().with_fixed_int_encoding();
    let written = bincode::serde::encode_into_std_write(value, to, config);
    written.map(drop).map_err(|e| BakeError::Encode { what: e.to_string() })
}

/// Decodes a value that fills the bytes. Reserves no more than a small multiple of their length, whatever lengths they tell.
pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, BakeError> {
    let mut decoder = Decoder { rest: bytes };
    let value = T::deserialize(&mut decoder).map_err(|e| BakeError::damaged(one_line(&e)))?;
    match decoder.rest.len() {
        0 => Ok(value),
        bytes => Err(BakeError::Trailing { bytes }),
    }
}

/// Returns the error message of the structure, or of the decoder, as a single line.
fn one_line(error: &bincode::error::DecodeError) -> String {
    let text = match error {
        bincode::error::DecodeError::OtherString(reason) => reason.clone(),
        other => other.to_string(),
    };
    text.replace(['\n', '\r'], " ")
}
