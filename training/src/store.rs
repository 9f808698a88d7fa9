//! Dictionaries on disk, so that a reopened session has its recording at once.
//!
//! A dictionary is stored under its inputs and the build that made it. A file begins with its magic number and ends
//! with a checksum of everything before; if that does not match, the file is deleted and made again. Files are written
//! under a temporary name and moved into place, so that a reader never sees half of one, and the oldest are deleted
//! when all of them together exceed a limit.

use std::fs::{self, File};
use std::io::{BufWriter, Read, Result, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crc32fast::Hasher;
use pyrophone_synthesis::recording::RecordingDictionary;

use crate::key::DictionaryKey;

/// Variable that names another folder; if it is empty, nothing is stored.
pub const FOLDER_VARIABLE: &str = "PYROPHONE_CACHE";

/// Fingerprint of the source that dictionaries depend on: files stored by a build with a different one are made again.
const BUILD: &str = env!("PYROPHONE_BUILD_FINGERPRINT");
/// First bytes of a file.
const MAGIC: &[u8; 8] = b"PYRODIC3";
/// Bytes of the checksum at the end.
const CHECKSUM_LEN: u64 = 4;
/// Bytes read and summed up in one go, while they are in the processor's cache.
const STRIDE: usize = 1 << 17;
/// Extension of complete files.
const EXTENSION: &str = "dictionary";
/// Most bytes of all files together: some ten recordings of two minutes, or a hundred of ten seconds.
const MOST_BYTES: u64 = 2 << 30;

/// A folder of dictionaries.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
    most_bytes: u64,
}

/// The user's cache folder: that in `PYROPHONE_CACHE`, otherwise `Pyrophone` in the system's cache folder. None if the
/// variable is empty or the user has no home.
pub fn user_folder() -> Option<PathBuf> {
    match std::env::var_os(FOLDER_VARIABLE) {
        Some(named) if named.is_empty() => None,
        Some(named) => Some(PathBuf::from(named)),
        None => Some(dirs::cache_dir()?.join("Pyrophone")),
    }
}

impl Store {
    /// The user's, in `dictionaries` of [`user_folder`].
    pub fn of_user() -> Option<Self> {
        Some(Self::new(user_folder()?.join("dictionaries"), MOST_BYTES))
    }

    /// A store in `folder`, which need not exist yet, of at most `most_bytes` in total.
    pub fn new(folder: PathBuf, most_bytes: u64) -> Self {
        Self { folder, most_bytes }
    }

    fn path(&self, key: &DictionaryKey) -> PathBuf {
        let name = blake3::hash(format!("{BUILD} {}", key.text()).as_bytes()).to_hex();
        self.folder.join(format!("{name}.{EXTENSION}"))
    }

    /// The dictionary of this key, if it is stored and complete. It counts as used now.
    pub fn read(&self, key: &DictionaryKey) -> Option<RecordingDictionary> {
        let path = self.path(key);
        let file = File::open(&path).ok()?;
        let dictionary = file.metadata().and_then(|about| read(file, about.len())).ok();
        match &dictionary {
            Some(_) => {
                // If the time cannot be set, the file merely counts as older than it is.
                let _ = File::options().append(true).open(&path).and_then(|file| file.set_modified(SystemTime::now()));
            }
            None => {
                let _ = fs::remove_file(&path);
            }
        }
        dictionary
    }

    /// Stores a dictionary, and deletes the oldest ones if the limit is exceeded; if writing fails, nothing is stored.
    ///
    /// # Errors
    /// If the folder or the file cannot be written.
    pub fn write(&self, key: &DictionaryKey, dictionary: &RecordingDictionary) -> Result<()> {
        let mut size = Summed { inner: std::io::sink(), checksum: Hasher::new(), len: 0 };
        write(dictionary, &mut size)?;
        if size.len > self.most_bytes {
            return Ok(());
        }
        fs::create_dir_all(&self.folder)?;
        self.make_room(size.len);
        let mut file = tempfile::NamedTempFile::new_in(&self.folder)?;
        let mut out = Summed { inner: BufWriter::new(&mut file), checksum: Hasher::new(), len: 0 };
        write(dictionary, &mut out)?;
        out.inner.flush()?;
        drop(out);
        file.persist(self.path(key)).map_err(|error| error.error)?;
        Ok(())
    }

    /// Deletes the oldest files until `wanted` more bytes fit.
    fn make_room(&self, wanted: u64) {
        let mut files = files(&self.folder);
        files.sort_by_key(|(used, ..)| *used);
        let mut total: u64 = files.iter().map(|(_, size, _)| size).sum();
        for (_, size, path) in files {
            if total + wanted <= self.most_bytes {
                return;
            }
            if fs::remove_file(path).is_ok() {
                total -= size;
            }
        }
    }
}

/// Time of last use, size and path of each stored file.
fn files(folder: &Path) -> Vec<(SystemTime, u64, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let described = entries.filter_map(|entry| {
        let (path, about) = (entry.path(), entry.metadata().ok()?);
        let is_ours = path.extension().is_some_and(|extension| extension == EXTENSION);
        is_ours.then(|| Some((about.modified().ok()?, about.len(), path)))?
    });
    described.collect()
}

/// A stream with a checksum and a count.
struct Summed<T> {
    inner: T,
    checksum: Hasher,
    len: u64,
}

impl<T: Write> Write for Summed<T> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let written = self.inner.write(bytes)?;
        self.checksum.update(&bytes[..written]);
        self.len += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> Result<()> {
        self.inner.flush()
    }
}

impl<T: Read> Read for Summed<T> {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        let wanted = bytes.len().min(STRIDE);
        let read = self.inner.read(&mut bytes[..wanted])?;
        self.checksum.update(&bytes[..read]);
        self.len += read as u64;
        Ok(read)
    }
}

fn write<T: Write>(dictionary: &RecordingDictionary, out: &mut Summed<T>) -> Result<()> {
    out.write_all(MAGIC)?;
    dictionary.write_to(out)?;
    let checksum = out.checksum.clone().finalize();
    out.write_all(&checksum.to_le_bytes())
}

/// Reads a file of `len` bytes. Fails if it is not exactly one that [`write`] wrote.
fn read(file: impl Read, len: u64) -> Result<RecordingDictionary> {
    let damaged = |what: &str| std::io::Error::new(std::io::ErrorKind::InvalidData, what);
    let mut file = Summed { inner: file, checksum: Hasher::new(), len: 0 };
    let mut magic = [0; MAGIC.len()];
    file.read_exact(&mut magic)?;
    if magic != *MAGIC {
        return Err(damaged("not a dictionary of this kind"));
    }
    let dictionary = RecordingDictionary::read_from(&mut file, len.saturating_sub(MAGIC.len() as u64 + CHECKSUM_LEN))?;
    let expected = file.checksum.clone().finalize();
    let mut checksum = [0; CHECKSUM_LEN as usize];
    file.read_exact(&mut checksum)?;
    if u32::from_le_bytes(checksum) != expected || file.len != len {
        return Err(damaged("the checksum does not match"));
    }
    Ok(dictionary)
}

#[cfg(test)]
mod tests {
    use pyrophone_recording::Cut;
    use pyrophone_synthesis::EngineConfig;
    use pyrophone_synthesis::structure::MatchingMode;
    use pyrophone_synthesis::texture::PyramidConfig;

    use super::*;

    fn key(hash: &str) -> DictionaryKey {
        DictionaryKey::new(hash, &Cut::default(), 44_100.0, &EngineConfig::default())
    }

    fn dictionary(seed: u32) -> RecordingDictionary {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state as i32) / f64::from(i32::MAX)
        };
        let channels: Vec<Vec<f64>> = (0..2).map(|_| (0..30_000).map(|_| next()).collect()).collect();
        let shape = PyramidConfig::at_rate(&EngineConfig::default(), 44_100.0);
        RecordingDictionary::new(MatchingMode::Companded, &channels, 44_100.0, &shape, &|_| true).unwrap()
    }

    fn bytes(dictionary: &RecordingDictionary) -> Vec<u8> {
        let mut out = Summed { inner: Vec::new(), checksum: Hasher::new(), len: 0 };
        write(dictionary, &mut out).unwrap();
        out.inner
    }

    #[test]
    fn stored_dictionary_equals_the_one_made() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path().join("not yet there"), MOST_BYTES);
        let made = dictionary(1);
        assert!(store.read(&key("a")).is_none());
        store.write(&key("a"), &made).unwrap();
        let read = store.read(&key("a")).expect("it was kept");
        assert_eq!(bytes(&read), bytes(&made));
        assert_eq!(format!("{read:?}"), format!("{made:?}"), "no field is left out");
        assert!(store.read(&key("b")).is_none(), "another recording's is not taken for it");
    }

    #[test]
    fn a_damaged_file_is_deleted_wherever_the_damage_is() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path().to_owned(), MOST_BYTES);
        store.write(&key("a"), &dictionary(1)).unwrap();
        let path = store.path(&key("a"));
        let good = fs::read(&path).unwrap();
        let flipped = |at: usize| {
            let mut bytes = good.clone();
            bytes[at] ^= 1;
            bytes
        };
        let bad =
            [flipped(0), flipped(20), flipped(good.len() / 2), good[..good.len() - 1].to_vec(), vec![], vec![7; 20]];
        for bytes in bad {
            fs::write(&path, &bytes).unwrap();
            assert!(store.read(&key("a")).is_none(), "{} bytes", bytes.len());
            assert!(!path.exists(), "it is made again");
        }
    }

    #[test]
    fn the_oldest_make_room() {
        let folder = tempfile::tempdir().unwrap();
        let made = dictionary(2);
        let size = bytes(&made).len() as u64;
        let store = Store::new(folder.path().to_owned(), 2 * size + size / 2);
        let old = |name: &str, hours: u64| {
            let file = File::options().append(true).open(store.path(&key(name))).unwrap();
            file.set_modified(SystemTime::now() - std::time::Duration::from_secs(3600 * hours)).unwrap();
        };
        store.write(&key("a"), &made).unwrap();
        old("a", 2);
        store.write(&key("b"), &made).unwrap();
        old("b", 1);
        assert!(store.read(&key("a")).is_some(), "which makes it the one used last");
        store.write(&key("c"), &made).unwrap();
        let kept = ["a", "b", "c"].map(|name| store.path(&key(name)).exists());
        assert_eq!(kept, [true, false, true]);
        let tiny = Store::new(folder.path().join("tiny"), size - 1);
        tiny.write(&key("a"), &made).unwrap();
        assert!(!tiny.path(&key("a")).exists(), "what does not fit at all is not kept");
    }
}
