//! A flux, or rate of heat release, measured elsewhere: one number per step.

mod dialect;
mod table;
mod values;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use self::table::Table;
use self::values::MOST_ROWS;
use super::error::{Error, FormatFault};
use super::file::open;
use super::npy::Header;

pub use self::values::{Series, Timing};

impl Series {
    /// Reads a `.npy` array of one axis, or otherwise a table: columns `flux` and `frame` or `time_s` under a header in
    /// any order (others are ignored), or one column with or without a header.
    ///
    /// Columns are separated by commas, tabs, semicolons (numbers may then have a decimal comma) or spaces. Lines that
    /// begin with `#` are comments, except for one that names the columns. Units may be given on a line before or after
    /// the names, as FDS writes them, or in brackets beside them; times in milliseconds or minutes are converted to
    /// seconds.
    ///
    /// # Errors
    /// Names the line if a row lacks a finite number, if frames are not consecutive, if times do not ascend, and beyond
    /// 10 million rows.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let (file, size) = open(path)?;
        let is_array = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy"));
        if is_array {
            return array(file, size).map_err(Error::of_file(path));
        }
        Table::new(path).read(BufReader::new(file))
    }
}

fn array(file: File, size: u64) -> Result<Series, FormatFault> {
    let mut reader = BufReader::new(file);
    let header = Header::read(&mut reader)?;
    header.check_size(size)?;
    let [length] = *header.shape.as_slice() else {
        let advice = "save a series as an array of one axis";
        return Err(FormatFault::Unsupported { found: format!("an array of shape {:?}", header.shape), advice });
    };
    if length > MOST_ROWS {
        return Err(FormatFault::TooLarge { what: "values", found: length as u64, allowed: MOST_ROWS as u64 });
    }
    let mut values = Vec::with_capacity(length);
    header.values(&mut reader, |value| values.push(value))?;
    if let Some(index) = values.iter().position(|value| !value.is_finite()) {
        return Err(FormatFault::Damaged(format!("value {index} (counting from 0) is not a finite number")));
    }
    if values.is_empty() {
        return Err(FormatFault::Damaged("it holds no values".into()));
    }
    Ok(Series { timing: Timing::Frames(0), values, rate_hz: None })
}
