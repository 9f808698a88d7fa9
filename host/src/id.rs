/// The numeric id of a parameter in CLAP and VST3, from its string id.
///
/// nice-plug (`wrapper/util.rs`, `hash_param_id`) multiplies by 31 and adds, byte by byte, and clears the top bit,
/// which VST3 reserves for the host.
#[must_use]
pub const fn numeric_id(id: &str) -> u32 {
    let bytes = id.as_bytes();
    let mut hash = 0_u32;
    let mut i = 0;
    while i < bytes.len() {
        hash = hash.wrapping_mul(31).wrapping_add(bytes[i] as u32);
        i += 1;
    }
    hash & !(1 << 31)
}

#[cfg(test)]
mod tests {
    use super::numeric_id;

    #[test]
    fn hashes_as_the_wrapper_does() {
        assert_eq!(numeric_id(""), 0);
        assert_eq!(numeric_id("a"), 97);
        assert_eq!(numeric_id("ab"), 97 * 31 + 98);
        // Long enough to overflow 32 bits: the same recurrence in wider arithmetic.
        let wide = "scaling_alpha".bytes().fold(0_u64, |h, b| (h * 31 + u64::from(b)) % (1 << 32));
        assert_eq!(u64::from(numeric_id("scaling_alpha")), wide % (1 << 31));
    }
}
