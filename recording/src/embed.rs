//! A file's bytes as text in a session: compressed without loss, so that the recording and its hash do not change.

use std::io::{Read, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use crate::Error;

/// Largest file that can be embedded, in bytes before compression.
pub const MAX_EMBEDDED_BYTES: usize = 10_000_000;

/// Packs a file's bytes into text: zlib (RFC 1950), then base64 (RFC 4648).
///
/// # Errors
/// [`Error::EmbedTooLarge`] beyond [`MAX_EMBEDDED_BYTES`].
pub fn embed(bytes: &[u8]) -> Result<String, Error> {
    if bytes.len() > MAX_EMBEDDED_BYTES {
        return Err(Error::EmbedTooLarge { found_bytes: bytes.len() });
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish());
    Ok(STANDARD.encode(packed.map_err(|error| damaged(error.to_string()))?))
}

/// Unpacks the output of [`embed`].
///
/// # Errors
/// [`Error::EmbedDamaged`] for any other text, and before more than [`MAX_EMBEDDED_BYTES`] have been unpacked.
pub fn unembed(text: &str) -> Result<Vec<u8>, Error> {
    let packed = STANDARD.decode(text).map_err(|error| damaged(error.to_string()))?;
    let mut bytes = Vec::new();
    let mut decoder = ZlibDecoder::new(packed.as_slice()).take(MAX_EMBEDDED_BYTES as u64 + 1);
    decoder.read_to_end(&mut bytes).map_err(|error| damaged(error.to_string()))?;
    if bytes.len() > MAX_EMBEDDED_BYTES {
        return Err(damaged(format!("it unpacks to more than {MAX_EMBEDDED_BYTES} bytes")));
    }
    Ok(bytes)
}

fn damaged(reason: String) -> Error {
    Error::EmbedDamaged { reason: crate::error::clean(&reason) }
}
