//! Tags before, between and after sound: skipped by their size, whatever they contain.

/// Bytes of an ID3v1 tag, which is at a file's end.
const ID3V1_BYTES: usize = 128;

/// Bytes of an APE tag's header, and of its footer.
const APE_BYTES: usize = 32;

/// Length of the tag at the start of `bytes`; 0 without one.
pub(super) fn at_start(bytes: &[u8]) -> usize {
    id3v2(bytes).or_else(|| ape_header(bytes)).unwrap_or(0)
}

/// Length of all tags at the start of `bytes`.
pub(super) fn all_at_start(bytes: &[u8]) -> usize {
    let mut at = 0;
    loop {
        match at_start(&bytes[at..]) {
            0 => return at,
            length => at += length,
        }
    }
}

/// `bytes` without the tags at the end.
pub(super) fn without_trailing(mut bytes: &[u8]) -> &[u8] {
    while let Some(length) = id3v1(bytes).or_else(|| ape_footer(bytes)) {
        bytes = &bytes[..bytes.len() - length];
    }
    bytes
}

/// ID3v2: a size of four times seven bits after the ten bytes of the header, plus another ten if there is a footer.
/// None if it extends beyond the file, which makes the size useless.
fn id3v2(bytes: &[u8]) -> Option<usize> {
    let header = bytes.first_chunk::<10>().filter(|header| header.starts_with(b"ID3") && header[3] != 0xff)?;
    let size = header[6..10].iter().fold(0, |size, byte| size << 7 | usize::from(byte & 0x7f));
    let footer = if header[5] & 0x10 != 0 { 10 } else { 0 };
    Some(10 + size + footer).filter(|length| *length <= bytes.len())
}

/// An APE tag with a header states its size without it.
fn ape_header(bytes: &[u8]) -> Option<usize> {
    let size = ape_size(bytes.get(..APE_BYTES)?)?;
    Some(APE_BYTES + size).filter(|length| *length <= bytes.len())
}

/// An APE tag's footer states its size with the footer, but without a header.
fn ape_footer(bytes: &[u8]) -> Option<usize> {
    let footer = &bytes[bytes.len().checked_sub(APE_BYTES)?..];
    let has_header = footer[23] & 0x80 != 0;
    let length = ape_size(footer)? + if has_header { APE_BYTES } else { 0 };
    Some(length).filter(|length| (APE_BYTES..=bytes.len()).contains(length))
}

fn ape_size(mark: &[u8]) -> Option<usize> {
    mark.starts_with(b"APETAGEX").then(|| u32::from_le_bytes([mark[12], mark[13], mark[14], mark[15]]) as usize)
}

fn id3v1(bytes: &[u8]) -> Option<usize> {
    let start = bytes.len().checked_sub(ID3V1_BYTES)?;
    bytes[start..].starts_with(b"TAG").then_some(ID3V1_BYTES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tag_is_as_long_as_its_header_says() {
        let mut tag = b"ID3\x04\0\x10\0\0\x01\x02".to_vec();
        tag.resize(10 + 130 + 10, 7);
        assert_eq!(at_start(&tag), 150);
        assert_eq!(at_start(&tag[..149]), 0, "beyond the file");
        assert_eq!(at_start(b"ID4\x04\0\0\0\0\0\0"), 0);
    }

    #[test]
    fn tags_at_the_end_are_dropped_one_after_the_other() {
        let mut file = b"sound".to_vec();
        let mut ape = b"APETAGEX\xd0\x07\0\0\x28\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0".to_vec();
        file.extend(b"itemitem");
        file.append(&mut ape);
        file.extend(b"TAG");
        file.resize(5 + 40 + 128, 0);
        assert_eq!(without_trailing(&file), b"sound");
    }
}
