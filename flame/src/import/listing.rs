//! The frames among the files of a folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::error::{Error, shown, shown_path};
use super::format::Format;
use super::numbering::{Name, Number, Numbering, Pattern, subframes};

/// The files of one frame, each with the part of its name before the number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FrameFiles {
    /// The step of the file's number, as [`Numbering`] counts them.
    pub number: i64,
    pub format: Format,
    /// One file, or for `.npy` one for each field: the field's name and the file.
    pub files: Vec<(String, PathBuf)>,
}

/// The frames of a folder in ascending order, and the number of files left out.
pub(super) struct Listing {
    pub frames: Vec<FrameFiles>,
    pub left_out: usize,
    pub numbering: Numbering,
}

/// Files that belong together: of the same format and, unless that has a file for each field, of the same name (the
/// part before and after the number).
type Sort = (Format, String);

struct Numbered {
    stem: String,
    number: Number,
    path: PathBuf,
}

/// The frames of a folder.
///
/// Files of one sort are used; stray files, the only ones of their sort, are left out. In Blender's cache folder,
/// `data` is read. Fails without frames, with several sorts of several frames each, and if two files claim the same
/// frame.
pub(super) fn of_folder(folder: &Path) -> Result<Listing, Error> {
    let (sorts, others) = sorts(folder, None)?;
    if sorts.is_empty() && folder.join("data").is_dir() {
        return of_folder(&folder.join("data"));
    }
    let main = sorts.iter().max_by_key(|(_, files)| files.len());
    let Some((main, files)) = main else {
        let found = match others {
            0 => "but it is empty".to_owned(),
            1 => "but it contains one other file or folder".to_owned(),
            _ => format!("but it contains {others} other files or folders"),
        };
        return Err(Error::NoFrames { path: shown_path(folder), found });
    };
    if sorts.iter().any(|(sort, stray)| sort != main && (stray.len() > 1 || files.len() < 2)) {
        let described = |((format, stem), files): (&Sort, &Vec<Numbered>)| {
            format!("{} {} {}", files.len(), format.name(), if stem.is_empty() { "by number" } else { stem })
        };
        let found: Vec<String> = sorts.iter().take(8).map(described).collect();
        return Err(Error::Mixed { path: shown_path(folder), found: shown(&found.join(", ")) });
    }
    let left_out = sorts.iter().filter(|(sort, _)| *sort != main).map(|(_, files)| files.len()).sum();
    listing(folder, main.0, files, left_out)
}

/// The frames whose names match a pattern; `path` is an existing folder and a name with a placeholder for the number.
pub(super) fn of_pattern(path: &Path, pattern: &Pattern) -> Result<Listing, Error> {
    let folder = folder_of(path);
    let (sorts, others) = sorts(folder, Some(pattern))?;
    let Some((sort, files)) = sorts.iter().max_by_key(|(_, files)| files.len()) else {
        let found = format!("but none of the {others} files there has that name");
        return Err(Error::NoFrames { path: shown_path(path), found });
    };
    listing(folder, sort.0, files, 0)
}

fn listing(folder: &Path, format: Format, files: &[Numbered], left_out: usize) -> Result<Listing, Error> {
    let numbering = Numbering::of_numbers(files.iter().map(|file| &file.number));
    Ok(Listing { frames: frames(folder, format, files, &numbering)?, left_out, numbering })
}

/// The frame that a file belongs to: the file itself, or for `.npy` all files beside it with the same number.
pub(super) fn of_file(path: &Path) -> Result<FrameFiles, Error> {
    let format = Format::of_path(path).ok_or_else(|| Error::Kind { path: shown_path(path) })?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let (stem, number) = match Name::of_name(&name) {
        Some(name) => (name.stem(), Some(name.number.whole)),
        None => (name.clone(), None),
    };
    if let (Format::Npy, Some(number)) = (format, number) {
        let folder = folder_of(path);
        let (sorts, _) = sorts(folder, None)?;
        let beside = sorts.into_iter().filter(|((format, _), _)| *format == Format::Npy).flat_map(|(_, files)| files);
        let of_number: Vec<Numbered> = beside.filter(|file| file.number.whole == number).collect();
        if let Some(frame) = frames(folder, format, &of_number, &Numbering::default())?.pop() {
            return Ok(frame);
        }
    }
    Ok(FrameFiles { number: number.unwrap_or(0), format, files: vec![(field(&stem), path.to_path_buf())] })
}

/// A single file as a sequence of one frame.
pub(super) fn of_single(path: &Path) -> Result<Listing, Error> {
    Ok(Listing { frames: vec![of_file(path)?], left_out: 0, numbering: Numbering::default() })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The numbered files of a folder by sort, and the number of other entries; with a pattern, only the files that match
/// it.
fn sorts(folder: &Path, pattern: Option<&Pattern>) -> Result<(BTreeMap<Sort, Vec<Numbered>>, usize), Error> {
    let mut found: Vec<(Format, Name, PathBuf)> = vec![];
    let mut others = 0;
    for entry in std::fs::read_dir(folder).map_err(Error::of_system(folder))? {
        let path = entry.map_err(Error::of_system(folder))?.path();
        if is_hidden(&path) {
            continue;
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let name = match pattern {
            None => Name::of_name(&name),
            Some(pattern) => pattern.name(&path.file_name().unwrap_or_default().to_string_lossy()),
        };
        match (Format::of_path(&path).filter(|_| path.is_file()), name) {
            (Some(format), Some(name)) => found.push((format, name, path)),
            _ => others += 1,
        }
    }
    // The order of directory entries depends on the system.
    found.sort_unstable_by(|a, b| a.2.cmp(&b.2));
    let with_fractions = subframes::stems(found.iter().map(|(format, name, _)| (*format, name)));
    let mut sorts: BTreeMap<Sort, Vec<Numbered>> = BTreeMap::new();
    for (format, name, path) in found {
        let name = match name.with_fraction() {
            Some(read) if with_fractions.contains(&(format, read.stem())) => read,
            _ => name,
        };
        let stem = name.stem();
        let sort = if format == Format::Npy { String::new() } else { stem.clone() };
        sorts.entry((format, sort)).or_default().push(Numbered { stem, number: name.number, path });
    }
    Ok((sorts, others))
}

fn frames(folder: &Path, format: Format, files: &[Numbered], numbering: &Numbering) -> Result<Vec<FrameFiles>, Error> {
    let mut frames: BTreeMap<i64, BTreeMap<String, PathBuf>> = BTreeMap::new();
    for file in files {
        let fields = frames.entry(numbering.step(&file.number)).or_default();
        if let Some(first) = fields.insert(field(&file.stem), file.path.clone()) {
            let name = |path: &Path| shown(&path.file_name().unwrap_or_default().to_string_lossy());
            let (first, second) = (name(&first), name(&file.path));
            return Err(Error::Twice { path: shown_path(folder), number: file.number.whole, first, second });
        }
    }
    let frame = |(number, fields): (i64, BTreeMap<String, PathBuf>)| FrameFiles {
        number,
        format,
        files: fields.into_iter().collect(),
    };
    Ok(frames.into_iter().map(frame).collect())
}

/// The field in a `.npy` file: its name without the separator before the number.
fn field(stem: &str) -> String {
    stem.trim_end_matches(['_', '.', '-', ' ']).to_owned()
}

/// True for names that begin with a dot; those are not the user's: systems leave `._name` beside every `name` that they
/// copy.
fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        folder
    }

    fn numbers(names: &[&str]) -> Result<Vec<i64>, Error> {
        let folder = folder(names);
        of_folder(folder.path()).map(|listing| listing.frames.iter().map(|frame| frame.number).collect())
    }

    #[test]
    fn frames_are_ordered_by_number() {
        assert_eq!(numbers(&["a_10.vdb", "a_9.vdb", "a_0011.VDB", "readme.txt", "b.vdb"]).unwrap(), [9, 10, 11]);
        assert_eq!(numbers(&["0002.npz", "0001.npz"]).unwrap(), [1, 2]);
        assert_eq!(numbers(&["fire.1.npy", "vel.1.npy", "fire.2.npy"]).unwrap(), [1, 2]);
    }

    #[test]
    fn a_minus_before_a_number_belongs_to_it() {
        assert_eq!(numbers(&["a.-2.vdb", "a.-0001.vdb", "a.0.vdb", "a.1.vdb"]).unwrap(), [-2, -1, 0, 1]);
        assert_eq!(numbers(&["-2.npz", "-1.npz"]).unwrap(), [-2, -1]);
        assert_eq!(numbers(&["a_-2.npz", "a_-1.npz"]).unwrap(), [-2, -1]);
        assert_eq!(numbers(&["a-2.npz", "a-1.npz"]).unwrap(), [1, 2], "here it parts the number from the name");
    }

    #[test]
    fn dot_files_are_ignored() {
        let folder = folder(&["._a.1.vdb", "._a.2.vdb", "a.1.vdb", "a.2.vdb", ".a.3.vdb", ".hidden"]);
        let listing = of_folder(folder.path()).unwrap();
        assert_eq!((listing.frames.len(), listing.left_out), (2, 0));
        let alone = tempfile::tempdir().unwrap();
        std::fs::write(alone.path().join("._a.1.vdb"), "").unwrap();
        assert!(matches!(of_folder(alone.path()), Err(Error::NoFrames { .. })));
    }

    fn labels(names: &[&str]) -> Vec<String> {
        let folder = folder(names);
        let listing = of_folder(folder.path()).unwrap_or_else(|error| panic!("{names:?}: {error}"));
        listing.frames.iter().map(|frame| listing.numbering.label(frame.number)).collect()
    }

    #[test]
    fn names_as_people_have_them() {
        for (names, expected) in [
            (&["a.1.25.vdb", "a.1.5.vdb", "a.1.75.vdb", "a.2.25.vdb"][..], &["1.25", "1.5", "1.75", "2.25"][..]),
            (&["a.0001.00.vdb", "a.0001.50.vdb", "a.0002.00.vdb"], &["1", "1.5", "2"]),
            (&["a.1.vdb", "a.1.5.vdb", "a.2.vdb", "a.2.5.vdb"], &["1", "1.5", "2", "2.5"]),
            (&["a.-1.5.vdb", "a.-1.vdb", "a.-0.5.vdb"], &["-1.5", "-1", "-0.5"]),
            (&["a.0001_cache.vdb", "a.0002_cache.vdb"], &["1", "2"]),
            (&["shot.2.0001.vdb", "shot.2.0002.vdb"], &["1", "2"]),
            (&["a.1001.vdb", "a.1003.vdb", "a.1005.vdb"], &["1001", "1003", "1005"]),
            (&["flame.1.5.npy", "flame.2.npy", "vel.1.5.npy", "vel.2.npy"], &["1.5", "2"]),
        ] {
            assert_eq!(labels(names), expected, "{names:?}");
        }
    }

    #[test]
    fn one_of_two_versions_is_chosen_by_a_pattern() {
        let folder = folder(&["a_v1.0001.vdb", "a_v1.0002.vdb", "a_v2.0001.vdb", "a_v2.0003.vdb", "a_v2.0003.txt"]);
        assert!(matches!(of_folder(folder.path()), Err(Error::Mixed { .. })));
        let pattern = Pattern::of_file_name("a_v2.####.vdb").unwrap();
        let listing = of_pattern(&folder.path().join("a_v2.####.vdb"), &pattern).unwrap();
        assert_eq!(listing.frames.iter().map(|frame| frame.number).collect::<Vec<_>>(), [1, 3]);
        let pattern = Pattern::of_file_name("b.####.vdb").unwrap();
        let message = of_pattern(&folder.path().join("b.####.vdb"), &pattern).err().unwrap().to_string();
        assert!(message.contains("b.####.vdb") && message.contains("none of the 5"), "{message}");
    }

    #[test]
    fn the_cache_folder_of_blender_holds_its_frames_in_data() {
        let folder = tempfile::tempdir().unwrap();
        for (sub, name) in
            [("config", "config_0001.uni"), ("data", "fluid_data_0001.vdb"), ("data", "fluid_data_0002.vdb")]
        {
            std::fs::create_dir_all(folder.path().join(sub)).unwrap();
            std::fs::write(folder.path().join(sub).join(name), "").unwrap();
        }
        assert_eq!(of_folder(folder.path()).unwrap().frames.len(), 2);
    }

    #[test]
    fn strays_are_left_out_and_mixtures_refused() {
        assert_eq!(numbers(&["a_1.vdb", "a_2.vdb", "test_1.vdb", "copy_7.npz"]).unwrap(), [1, 2]);
        for names in [
            &["a_1.vdb", "a_2.vdb", "b_1.vdb", "b_2.vdb"][..],
            &["a_1.vdb", "a_2.vdb", "a_3.vdb", "a_1.npz", "a_2.npz"],
            &["a_1.vdb", "b_1.vdb"],
        ] {
            let message = numbers(names).unwrap_err().to_string();
            assert!(message.contains("several sequences") && message.contains(".vdb a_"), "{message}");
        }
    }

    #[test]
    fn one_frame_twice() {
        let message = numbers(&["a_1.vdb", "a_01.vdb"]).unwrap_err().to_string();
        assert!(message.contains("frame 1") && message.contains("a_01.vdb"), "{message}");
        assert!(numbers(&["v_1.npy", "v.1.npy"]).is_err());
    }

    #[test]
    fn no_frames() {
        assert!(matches!(numbers(&["a.vdb", "b.txt"]), Err(Error::NoFrames { .. })));
        assert!(matches!(numbers(&["a_99999999999999999999.vdb"]), Err(Error::NoFrames { .. })));
        assert!(matches!(of_folder(Path::new("/nowhere/at/all")), Err(Error::Missing { .. })));
    }

    #[test]
    fn one_file() {
        let folder = folder(&["flame_3.npy", "vel_3.npy", "vel_4.npy", "alone.npy", "x_8.vdb", "x_9.vdb"]);
        let frame = |name: &str| of_file(&folder.path().join(name)).unwrap();
        let fields = |frame: &FrameFiles| frame.files.iter().map(|(field, _)| field.clone()).collect::<Vec<_>>();
        assert_eq!(
            (frame("flame_3.npy").number, fields(&frame("flame_3.npy"))),
            (3, vec!["flame".into(), "vel".into()])
        );
        assert_eq!((frame("alone.npy").number, fields(&frame("alone.npy"))), (0, vec!["alone".into()]));
        assert_eq!((frame("x_9.vdb").number, frame("x_9.vdb").files.len()), (9, 1));
        assert!(matches!(of_file(&folder.path().join("x_9.txt")), Err(Error::Kind { .. })));
    }
}
