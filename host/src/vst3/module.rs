//! A VST3 bundle's code.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use ::vst3::ComPtr;
use ::vst3::Steinberg::IPluginFactory;
use libloading::Library;

/// Modules stay loaded, see [`load`](crate::load).
static MODULES: LazyLock<Mutex<HashMap<PathBuf, Arc<Module>>>> = LazyLock::new(Mutex::default);

type GetPluginFactory = unsafe extern "system" fn() -> *mut IPluginFactory;

pub(super) struct Module {
    factory: ComPtr<IPluginFactory>,
    _library: Library,
}

impl Module {
    pub fn load(bundle: &Path) -> Result<Arc<Self>, String> {
        let path = bundle.canonicalize().map_err(|error| error.to_string())?;
        let mut modules = MODULES.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(module) = modules.get(&path) {
            return Ok(Arc::clone(module));
        }
        let module = Arc::new(Self::open(&path)?);
        modules.insert(path, Arc::clone(&module));
        Ok(module)
    }

    fn open(bundle: &Path) -> Result<Self, String> {
        let text = |error: libloading::Error| error.to_string();
        let binary = binary_of(bundle)?;
        let library = enter(&binary)?;
        // SAFETY: this name has this signature in the VST3 SDK, and the module has been entered.
        let factory = unsafe {
            let get = library.get::<GetPluginFactory>(b"GetPluginFactory\0").map_err(text)?;
            ComPtr::from_raw(get())
        }
        .ok_or("it has no plugin factory")?;
        Ok(Self { factory, _library: library })
    }

    pub const fn factory(&self) -> &ComPtr<IPluginFactory> {
        &self.factory
    }
}

/// Loads a library and enters its module once, before its factory is used.
#[cfg(not(windows))]
fn enter(binary: &Path) -> Result<Library, String> {
    use std::ffi::c_void;

    use libloading::os::unix;

    type ModuleEntry = unsafe extern "system" fn(*mut c_void) -> bool;
    let text = |error: libloading::Error| error.to_string();
    // SAFETY: loading runs code of the bundle, as the caller requested.
    let handle = unsafe { unix::Library::new(binary) }.map_err(text)?.into_raw();
    // SAFETY: the handle was given out by the line above and is owned here again.
    let library = unsafe { unix::Library::from_raw(handle) };
    // SAFETY: this name has this signature in the VST3 SDK.
    let is_entered = unsafe { library.get::<ModuleEntry>(b"ModuleEntry\0").map_err(text)?(handle) };
    if is_entered { Ok(library.into()) } else { Err("its module cannot be entered".to_owned()) }
}

/// Loads a library and enters its module once, before its factory is used. On Windows, modules need not have an entry
/// function.
#[cfg(windows)]
fn enter(binary: &Path) -> Result<Library, String> {
    type InitDll = unsafe extern "system" fn() -> bool;
    // SAFETY: loading runs code of the bundle, as the caller requested.
    let library = unsafe { Library::new(binary) }.map_err(|error| error.to_string())?;
    // SAFETY: this name has this signature in the VST3 SDK.
    let is_entered = unsafe { library.get::<InitDll>(b"InitDll\0").map_or(true, |enter| enter()) };
    if is_entered { Ok(library) } else { Err("its module cannot be entered".to_owned()) }
}

/// Names of the system and of its libraries in a bundle.
const SYSTEM: &str = if cfg!(windows) { "win" } else { std::env::consts::OS };
const SUFFIX: &str = if cfg!(windows) { ".vst3" } else { ".so" };

/// `Name.vst3/Contents/<architecture>-linux/Name.so`, or `.../<architecture>-win/Name.vst3`; a bundle may also be the
/// library itself.
fn binary_of(bundle: &Path) -> Result<PathBuf, String> {
    if bundle.is_file() {
        return Ok(bundle.to_owned());
    }
    let stem = bundle.file_stem().ok_or("it has no name")?;
    let folder = format!("{}-{SYSTEM}", std::env::consts::ARCH);
    let mut library = stem.to_owned();
    library.push(SUFFIX);
    let binary = bundle.join("Contents").join(folder).join(library);
    if binary.is_file() { Ok(binary) } else { Err(format!("it has no {}", binary.display())) }
}
