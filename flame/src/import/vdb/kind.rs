//! Types of values and trees.

use half::f16;

/// Storage of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Half,
    Float,
    Double,
    Int32,
    /// One byte in a branch, one bit in a leaf.
    Bool,
    /// One byte in a branch; a leaf has only its mask.
    Mask,
    /// A number of this many bytes; it can be skipped but not read.
    Other(usize),
}

/// The type of a tree's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct GridKind {
    pub number: Number,
    pub components: usize,
    /// True if it may be stored as binary16.
    pub has_half_form: bool,
}

impl GridKind {
    fn named(name: &str) -> Option<Self> {
        let (number, components, has_half_form) = match name {
            "float" => (Number::Float, 1, true),
            "double" => (Number::Double, 1, true),
            "half" => (Number::Half, 1, false),
            "int32" => (Number::Int32, 1, false),
            "uint32" => (Number::Other(4), 1, false),
            "int64" => (Number::Other(8), 1, false),
            "bool" => (Number::Bool, 1, false),
            "mask" => (Number::Mask, 1, false),
            "vec2s" => (Number::Float, 2, true),
            "vec2d" => (Number::Double, 2, true),
            "vec2i" => (Number::Int32, 2, false),
            "vec3s" => (Number::Float, 3, true),
            "vec3d" => (Number::Double, 3, true),
            "vec3i" => (Number::Int32, 3, false),
            "vec4s" => (Number::Float, 4, false),
            "vec4d" => (Number::Double, 4, false),
            "vec4i" => (Number::Int32, 4, false),
            _ => return None,
        };
        Some(Self { number, components, has_half_form })
    }

    /// Bytes of one value in full width.
    pub fn bytes(&self) -> usize {
        self.components * self.number.bytes()
    }

    /// True if a leaf stores its values as bits, outside the compressed arrays.
    pub fn is_bits(&self) -> bool {
        matches!(self.number, Number::Bool | Number::Mask)
    }

    /// Numbers per voxel if the grid can be read, otherwise 0.
    pub fn readable_components(&self) -> usize {
        match (self.number, self.components) {
            (Number::Other(_) | Number::Mask, _) => 0,
            (_, 1) => 1,
            (_, 3) => 3,
            _ => 0,
        }
    }
}

impl Number {
    pub fn bytes(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Float | Self::Int32 => 4,
            Self::Double => 8,
            Self::Bool | Self::Mask => 1,
            Self::Other(bytes) => bytes,
        }
    }

    /// Appends all numbers in `bytes`; unreadable types are skipped.
    pub fn decode(self, bytes: &[u8], numbers: &mut Vec<f32>) {
        match self {
            Self::Half => extend(bytes, numbers, |two| f16::from_le_bytes(two).to_f32()),
            Self::Float => extend(bytes, numbers, f32::from_le_bytes),
            Self::Double => extend(bytes, numbers, |eight| f64::from_le_bytes(eight) as f32),
            Self::Int32 => extend(bytes, numbers, |four| i32::from_le_bytes(four) as f32),
            Self::Bool => extend(bytes, numbers, |[one]| if one == 0 { 0.0 } else { 1.0 }),
            Self::Mask | Self::Other(_) => {}
        }
    }

    /// Negative of a value, as the format defines it.
    pub fn negative(self, value: f32) -> f32 {
        if self == Self::Bool { 1.0 - value } else { -value }
    }
}

fn extend<const N: usize>(bytes: &[u8], numbers: &mut Vec<f32>, convert: impl Fn([u8; N]) -> f32) {
    let (chunks, _) = bytes.as_chunks::<N>();
    numbers.extend(chunks.iter().map(|chunk| convert(*chunk)));
}

/// Parses a tree's type: the name of its values, and their kind if the tree is of a known kind.
///
/// `Tree_vec3s_5_4_3_HalfFloat` is `vec3s`; the suffix only repeats the grid's metadata.
pub(super) fn of_tree(name: &str) -> (String, Option<GridKind>) {
    let plain = name.strip_suffix("_HalfFloat").unwrap_or(name);
    match plain.strip_prefix("Tree_").and_then(|tree| tree.strip_suffix("_5_4_3")) {
        Some(value) => (value.to_owned(), GridKind::named(value)),
        None => (name.to_owned(), None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_usual_tree_is_taken() {
        for (name, value, components) in [
            ("Tree_float_5_4_3", "float", Some(1)),
            ("Tree_vec3s_5_4_3_HalfFloat", "vec3s", Some(3)),
            ("Tree_vec2d_5_4_3", "vec2d", Some(0)),
            ("Tree_float_3_4_5", "Tree_float_3_4_5", None),
            ("Tree_float_20_20_20", "Tree_float_20_20_20", None),
            ("Tree_ptdataidx32_5_4_3", "ptdataidx32", None),
            ("", "", None),
        ] {
            let (found, kind) = of_tree(name);
            assert_eq!((found.as_str(), kind.map(|kind| kind.readable_components())), (value, components), "{name}");
        }
    }

    #[test]
    fn every_half_is_exact() {
        for bits in 0..=u16::MAX {
            let mut numbers = vec![];
            Number::Half.decode(&bits.to_le_bytes(), &mut numbers);
            let (sign, exponent, fraction) = (bits >> 15, i32::from(bits >> 10 & 31), f64::from(bits & 1023));
            let magnitude = match exponent {
                0 => fraction * 2f64.powi(-24),
                31 if fraction == 0.0 => f64::INFINITY,
                31 => f64::NAN,
                _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
            };
            let expected = if sign == 1 { -magnitude } else { magnitude };
            let found = f64::from(numbers[0]);
            assert!(found == expected || (found.is_nan() && expected.is_nan()), "{bits:#x}: {found}, not {expected}");
        }
    }
}
