//! UTF-16 texts of fixed length.

use vst3::Steinberg::Vst::String128;

/// Writes a text, truncated if necessary, with a terminating zero.
pub fn write(text: &str, to: &mut String128) {
    let room = to.len() - 1;
    let mut length = 0;
    for (place, unit) in to.iter_mut().zip(text.encode_utf16().take(room)) {
        *place = unit;
        length += 1;
    }
    to[length] = 0;
}

/// Reads a text up to its zero.
pub fn read(from: &String128) -> String {
    let units: Vec<u16> = from.iter().copied().take_while(|unit| *unit != 0).collect();
    String::from_utf16_lossy(&units)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_cut_and_ended() {
        let mut place: String128 = [1; 128];
        write("Höhe 90°", &mut place);
        assert_eq!(read(&place), "Höhe 90°");
        write(&"x".repeat(300), &mut place);
        assert_eq!(read(&place).len(), 127);
    }
}
