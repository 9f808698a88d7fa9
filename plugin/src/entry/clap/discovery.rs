//! Presets for a host's browser: the factory's and the user's.

use std::ffi::{CStr, CString, c_char, c_void};
use std::io::Write;
use std::path::{Path, PathBuf};

use clap_sys::factory::preset_discovery::{
    CLAP_PRESET_DISCOVERY_IS_FACTORY_CONTENT, CLAP_PRESET_DISCOVERY_IS_USER_CONTENT,
    CLAP_PRESET_DISCOVERY_LOCATION_FILE, CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN, clap_preset_discovery_factory,
    clap_preset_discovery_filetype, clap_preset_discovery_indexer, clap_preset_discovery_location,
    clap_preset_discovery_location_kind, clap_preset_discovery_metadata_receiver, clap_preset_discovery_provider,
    clap_preset_discovery_provider_descriptor,
};
use clap_sys::universal_plugin_id::clap_universal_plugin_id;
use clap_sys::version::CLAP_VERSION;
use pyrophone_settings::preset::FACTORY;
use pyrophone_settings::{Library, Preset};
use pyrophone_training::store;

/// Factory of the only provider.
pub static PROVIDERS: clap_preset_discovery_factory =
    clap_preset_discovery_factory { count: Some(count), get_descriptor: Some(descriptor_at), create: Some(create) };

static DESCRIPTOR: clap_preset_discovery_provider_descriptor = clap_preset_discovery_provider_descriptor {
    clap_version: CLAP_VERSION,
    id: c"org.pyrophone.pyrophone.presets".as_ptr(),
    name: c"Pyrophone presets".as_ptr(),
    vendor: c"Pyrophone".as_ptr(),
};

/// The ending of preset files.
const EXTENSION: &CStr = c"toml";

unsafe extern "C" fn count(_factory: *const clap_preset_discovery_factory) -> u32 {
    1
}

unsafe extern "C" fn descriptor_at(
    _factory: *const clap_preset_discovery_factory,
    index: u32,
) -> *const clap_preset_discovery_provider_descriptor {
    if index == 0 { &DESCRIPTOR } else { std::ptr::null() }
}

unsafe extern "C" fn create(
    _factory: *const clap_preset_discovery_factory,
    indexer: *const clap_preset_discovery_indexer,
    id: *const c_char,
) -> *const clap_preset_discovery_provider {
    // SAFETY: texts of the host's and of this library.
    if indexer.is_null() || id.is_null() || unsafe { CStr::from_ptr(id) != CStr::from_ptr(DESCRIPTOR.id) } {
        return std::ptr::null();
    }
    Box::into_raw(Box::new(clap_preset_discovery_provider {
        desc: &DESCRIPTOR,
        // The indexer outlives its providers.
        provider_data: indexer.cast_mut().cast::<c_void>(),
        init: Some(init),
        destroy: Some(destroy),
        get_metadata: Some(metadata),
        get_extension: Some(get_extension),
    }))
}

unsafe extern "C" fn init(provider: *const clap_preset_discovery_provider) -> bool {
    // SAFETY: a live provider, whose data is the host's indexer.
    let Some(indexer) = (unsafe { (*provider).provider_data.cast::<clap_preset_discovery_indexer>().as_ref() }) else {
        return false;
    };
    let (Some(declare_filetype), Some(declare_location)) = (indexer.declare_filetype, indexer.declare_location) else {
        return false;
    };
    let filetype = clap_preset_discovery_filetype {
        name: c"Pyrophone preset".as_ptr(),
        description: c"Readable settings of Pyrophone".as_ptr(),
        file_extension: EXTENSION.as_ptr(),
    };
    // SAFETY: a live indexer, which copies its arguments.
    if !unsafe { declare_filetype(indexer, &filetype) } {
        return false;
    }
    let declare = |flags, name: &CStr, folder: Option<PathBuf>| {
        let folder = folder.and_then(|folder| CString::new(folder.into_os_string().into_encoded_bytes()).ok());
        let (kind, location) = match &folder {
            Some(folder) => (CLAP_PRESET_DISCOVERY_LOCATION_FILE, folder.as_ptr()),
            None => (CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN, std::ptr::null()),
        };
        let place = clap_preset_discovery_location { flags, name: name.as_ptr(), kind, location };
        // SAFETY: a live indexer, which copies its arguments.
        unsafe { declare_location(indexer, &place) }
    };
    if !declare(CLAP_PRESET_DISCOVERY_IS_FACTORY_CONTENT, c"Pyrophone factory presets", factory_folder()) {
        return false;
    }
    // Hosts reject folders that do not exist, and there is none until something was saved.
    match Library::of_user().map(|library| library.folder().to_owned()).filter(|folder| folder.is_dir()) {
        Some(folder) => declare(CLAP_PRESET_DISCOVERY_IS_USER_CONTENT, c"Pyrophone user presets", Some(folder)),
        None => true,
    }
}

/// The factory's presets as files, one each, in the system's cache folder: hosts handle files better than many presets in
/// one location, at the second of which clap-validator 0.4.1 waits for itself for ever. `None` if they cannot be written;
/// the plug-in's library then offers them itself.
fn factory_folder() -> Option<PathBuf> {
    let folder = store::user_folder()?.join("factory-presets");
    std::fs::create_dir_all(&folder).ok()?;
    for (name, text) in FACTORY {
        let path = folder.join(format!("{name}.toml"));
        if std::fs::read_to_string(&path).is_ok_and(|found| found == *text) {
            continue;
        }
        // Replaced atomically, because another host may be reading it.
        let mut file = tempfile::NamedTempFile::new_in(&folder).ok()?;
        file.write_all(text.as_bytes()).ok()?;
        file.persist(&path).ok()?;
    }
    Some(folder)
}

unsafe extern "C" fn destroy(provider: *const clap_preset_discovery_provider) {
    // SAFETY: made by `Box` in `create`, destroyed once.
    drop(unsafe { Box::from_raw(provider.cast_mut()) });
}

unsafe extern "C" fn get_extension(
    _provider: *const clap_preset_discovery_provider,
    _id: *const c_char,
) -> *const c_void {
    std::ptr::null()
}

/// Reports a preset to the host; returns false if the host wants no more.
///
/// # Safety
/// `receiver` is the host's, and live.
unsafe fn report(
    receiver: &clap_preset_discovery_metadata_receiver,
    preset: &Preset,
    key: Option<&str>,
    flags: u32,
) -> bool {
    let text = |text: &str| CString::new(text.replace('\0', " ")).unwrap_or_default();
    let name = text(preset.title());
    let key = key.map(text);
    let key = key.as_ref().map_or(std::ptr::null(), |key| key.as_ptr());
    let plugin = clap_universal_plugin_id { abi: c"clap".as_ptr(), id: super::descriptor().clap_id().as_ptr() };
    // SAFETY: a live receiver, which copies its arguments.
    unsafe {
        if !receiver.begin_preset.is_some_and(|begin| begin(receiver, name.as_ptr(), key)) {
            return false;
        }
        if let Some(add) = receiver.add_plugin_id {
            add(receiver, &plugin);
        }
        if let Some(set) = receiver.set_flags {
            set(receiver, flags);
        }
        if let (Some(add), true) = (receiver.add_creator, flags == CLAP_PRESET_DISCOVERY_IS_FACTORY_CONTENT) {
            add(receiver, c"Pyrophone".as_ptr());
        }
        if let (Some(set), false) = (receiver.set_description, preset.description.is_empty()) {
            set(receiver, text(&preset.description).as_ptr());
        }
        if let Some(add) = receiver.add_feature {
            for tag in &preset.tags {
                add(receiver, text(tag).as_ptr());
            }
        }
    }
    true
}

unsafe extern "C" fn metadata(
    _provider: *const clap_preset_discovery_provider,
    kind: clap_preset_discovery_location_kind,
    location: *const c_char,
    receiver: *const clap_preset_discovery_metadata_receiver,
) -> bool {
    // SAFETY: null or a live receiver of the host.
    let Some(receiver) = (unsafe { receiver.as_ref() }) else { return false };
    let failed = |reason: String| {
        let reason = CString::new(reason).unwrap_or_default();
        if let Some(on_error) = receiver.on_error {
            // SAFETY: a live receiver, and a text that lives as long as the call.
            unsafe { on_error(receiver, 0, reason.as_ptr()) };
        }
        false
    };
    match kind {
        CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN => match Preset::factory() {
            Ok(presets) => presets.iter().all(|preset| {
                // SAFETY: a live receiver.
                unsafe { report(receiver, preset, Some(&preset.name), CLAP_PRESET_DISCOVERY_IS_FACTORY_CONTENT) }
            }),
            Err(error) => failed(error.to_string()),
        },
        CLAP_PRESET_DISCOVERY_LOCATION_FILE if !location.is_null() => {
            // SAFETY: a text of the host's.
            let path = unsafe { CStr::from_ptr(location) }.to_string_lossy();
            match Preset::load(Path::new(&*path)) {
                Ok(preset) => {
                    let is_factory = FACTORY.iter().any(|(name, _)| *name == preset.name)
                        && Path::new(&*path).parent().is_some_and(|folder| folder.ends_with("factory-presets"));
                    let flags = if is_factory {
                        CLAP_PRESET_DISCOVERY_IS_FACTORY_CONTENT
                    } else {
                        CLAP_PRESET_DISCOVERY_IS_USER_CONTENT
                    };
                    // SAFETY: a live receiver.
                    unsafe { report(receiver, &preset, None, flags) }
                }
                Err(error) => failed(error.to_string()),
            }
        }
        _ => failed("there are presets in the plug-in and in files".to_owned()),
    }
}
