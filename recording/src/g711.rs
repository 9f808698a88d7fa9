//! Logarithmic coding of telephony (ITU-T G.711): eight bits for fourteen (mu-law) or thirteen (A-law).

/// A mu-law byte as a fraction of full scale.
pub(crate) fn from_mu_law(byte: u8) -> f32 {
    // Stored inverted, so that lines never idle on zeros.
    let byte = !byte;
    let (exponent, mantissa) = (u32::from(byte >> 4 & 7), i32::from(byte & 15));
    // The bias of 33 makes every segment start at a power of two.
    let magnitude = ((2 * mantissa + 33) << exponent) - 33;
    signed(byte & 0x80 != 0, magnitude as f32 / 8192.0)
}

/// An A-law byte as a fraction of full scale.
pub(crate) fn from_a_law(byte: u8) -> f32 {
    // Every second bit is stored inverted.
    let byte = byte ^ 0x55;
    let (exponent, mantissa) = (u32::from(byte >> 4 & 7), i32::from(byte & 15));
    let magnitude = match exponent {
        0 => 2 * mantissa + 1,
        _ => (2 * mantissa + 33) << (exponent - 1),
    };
    signed(byte & 0x80 == 0, magnitude as f32 / 4096.0)
}

fn signed(is_negative: bool, magnitude: f32) -> f32 {
    if is_negative { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mu_law_has_its_published_end_points() {
        assert_eq!(from_mu_law(0xff), 0.0);
        assert_eq!(from_mu_law(0x7f), 0.0);
        assert_eq!(from_mu_law(0x80), 8031.0 / 8192.0);
        assert_eq!(from_mu_law(0x00), -8031.0 / 8192.0);
        assert_eq!(from_mu_law(0xfe), 2.0 / 8192.0);
    }

    #[test]
    fn a_law_has_its_published_end_points() {
        assert_eq!(from_a_law(0xd5), 1.0 / 4096.0);
        assert_eq!(from_a_law(0x55), -1.0 / 4096.0);
        assert_eq!(from_a_law(0xaa), 4032.0 / 4096.0);
        assert_eq!(from_a_law(0x2a), -4032.0 / 4096.0);
    }

    #[test]
    fn both_laws_rise_with_their_codes() {
        let mu: Vec<f32> = (0x80..=0xffu8).rev().map(from_mu_law).collect();
        let a: Vec<f32> = (0..0x80u8).map(|code| from_a_law((code | 0x80) ^ 0x55)).collect();
        assert!(mu.is_sorted() && a.is_sorted());
    }
}
