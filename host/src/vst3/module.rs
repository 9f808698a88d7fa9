//! A VST3 bundle's code.

use std::collections::HashMap;
use std::ffi::c_void;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use ::vst3::ComPtr;
use ::vst3::Steinberg::IPluginFactory;
use libloading::os::unix::Library;

/// Modules stay loaded, see [`load`](crate::load).
static MODULES: LazyLock<Mutex<HashMap<PathBuf, Arc<Module>>>> = LazyLock::new(Mutex::default);

type ModuleEntry = unsafe extern "system" fn(*mut c_void) -> bool;
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
        // SAFETY: loading runs code of the bundle, which is what the caller asked for.
        let handle = unsafe { Library::new(&binary) }.map_err(text)?.into_raw();
        // SAFETY: the handle was given out by the line above and is owned here again.
        let library = unsafe { Library::from_raw(handle) };
        // SAFETY: these names have these signatures in the VST3 SDK; the module is entered once, before its factory is used.
        let factory = unsafe {
            let enter = library.get::<ModuleEntry>(b"ModuleEntry\0").map_err(text)?;
            if !enter(handle) {
                return Err("its module cannot be entered".to_owned());
            }
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

/// `Name.vst3/Contents/<architecture>-linux/Name.so`; a bundle may also be the library itself.
fn binary_of(bundle: &Path) -> Result<PathBuf, String> {
    if bundle.is_file() {
        return Ok(bundle.to_owned());
    }
    let stem = bundle.file_stem().ok_or("it has no name")?;
    let folder = format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS);
    let mut library = stem.to_owned();
    library.push(".so");
    let binary = bundle.join("Contents").join(folder).join(library);
    if binary.is_file() { Ok(binary) } else { Err(format!("it has no {}", binary.display())) }
}
