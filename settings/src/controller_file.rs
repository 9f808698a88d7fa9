//! The user's assignments of MIDI controllers to parameters, stored beside the presets for new instances.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::{Library, index_of, user_file};

/// Name of the file in the user's folder; not a preset's.
const NAME: &str = "midi-controllers.txt";
/// Controllers that can be assigned: those from 120 on are channel mode messages.
pub const CONTROLLERS: u8 = 120;

/// Numbers of controllers by the parameter's id.
pub type Assignments = BTreeMap<String, u8>;

/// A file with one line for each assignment: the parameter's id, and the controller's number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControllerFile {
    file: PathBuf,
}

impl ControllerFile {
    /// The user's file; none if the user has no home.
    pub fn of_user() -> Option<Self> {
        Some(Self::new(Library::of_user()?.folder()))
    }

    /// The file in `folder`, which need not exist yet.
    pub fn new(folder: &Path) -> Self {
        Self { file: folder.join(NAME) }
    }

    /// All assignments. Lines without an automatable parameter or a controller are skipped.
    pub fn read(&self) -> Assignments {
        let text = user_file::read(&self.file);
        text.lines().filter_map(assignment).collect()
    }

    /// Assigns a controller, or none, to the parameter `id`; all other lines stay.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn assign(&self, id: &str, controller: Option<u8>) -> std::io::Result<()> {
        let mut assignments = self.read();
        match controller {
            Some(number) => assignments.insert(id.to_owned(), number),
            None => assignments.remove(id),
        };
        let lines: String = assignments.iter().map(|(id, number)| format!("{id} {number}\n")).collect();
        user_file::write(&self.file, &lines)
    }

    /// Removes all assignments.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn clear(&self) -> std::io::Result<()> {
        user_file::write(&self.file, "")
    }
}

fn assignment(line: &str) -> Option<(String, u8)> {
    let (id, number) = line.split_once(' ')?;
    let number: u8 = number.trim().parse().ok()?;
    is_assignable(id, number).then(|| (id.to_owned(), number))
}

/// True if a controller of this number can move the parameter `id`.
pub fn is_assignable(id: &str, number: u8) -> bool {
    number < CONTROLLERS && index_of(id).is_ok_and(|index| crate::PARAMETERS[index].automatable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assignments_are_kept_line_by_line() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = ControllerFile::new(&folder.path().join("not yet"));
        assert_eq!(file.read(), Assignments::new());
        file.assign("macro_size", Some(21)).expect("written");
        file.assign("alpha", Some(21)).expect("written");
        file.assign("macro_size", Some(22)).expect("written");
        let expected = [("alpha", 21), ("macro_size", 22)].map(|(id, number)| (id.to_owned(), number));
        assert_eq!(file.read(), Assignments::from(expected));
        file.assign("alpha", None).expect("written");
        assert_eq!(file.read().into_keys().collect::<Vec<_>>(), ["macro_size"]);
        file.clear().expect("written");
        assert_eq!(file.read(), Assignments::new());
    }

    #[test]
    fn lines_that_assign_nothing_are_skipped() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let text = "macro_size 120\nmacro_fury -1\nlevels 3\nno_such 4\nalpha\n\nmacro_hiss 0\n";
        std::fs::write(folder.path().join(NAME), text).expect("written");
        let expected = Assignments::from([("macro_hiss".to_owned(), 0)]);
        assert_eq!(ControllerFile::new(folder.path()).read(), expected, "levels decides sizes and is not automatable");
    }
}
