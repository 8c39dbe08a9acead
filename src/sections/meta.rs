//! Small values by serde and bincode: little-endian, integers of fixed size.

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::BakeError;

/// Appends a value to bytes.
pub(crate) fn encode<T: Serialize>(value: &T, to: &mut Vec<u8>) -> Result<(), BakeError> {
    let config = bincode::config::standard().with_fixed_int_encoding();
    let written = bincode::serde::encode_into_std_write(value, to, config);
    written.map(drop).map_err(|e| BakeError::Encode { what: e.to_string() })
}

/// Decodes a value that fills the bytes, under the smallest limit that fits them. There are few limits, since each is all decoders once more. Without a limit, bincode would reserve
/// a string's declared length. Serde reserves up to a mebibyte for a sequence and then grows it as it fills.
pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, BakeError> {
    macro_rules! under_limit {
        ($($bits:literal)*) => {
            match bytes.len() {
                $(n if n <= 1 << $bits => {
                    let config = bincode::config::standard().with_fixed_int_encoding().with_limit::<{ 1 << $bits }>();
                    bincode::serde::decode_from_slice(bytes, config)
                })*
                _ => {
                    let config = bincode::config::standard().with_fixed_int_encoding().with_limit::<{ usize::MAX / 4 }>();
                    bincode::serde::decode_from_slice(bytes, config)
                }
            }
        };
    }
    let decoded = under_limit!(10 14 18 22 26 30);
    let (value, used): (T, usize) = decoded.map_err(|e| BakeError::damaged(one_line(&e)))?;
    match bytes.len() - used {
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
