//! Preset discovery and loading.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;

use clap_sys::ext::preset_load::{CLAP_EXT_PRESET_LOAD, clap_plugin_preset_load};
use clap_sys::factory::preset_discovery::{
    CLAP_PRESET_DISCOVERY_FACTORY_ID, CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN, clap_preset_discovery_factory,
    clap_preset_discovery_filetype, clap_preset_discovery_indexer, clap_preset_discovery_location,
    clap_preset_discovery_metadata_receiver,
};
use clap_sys::version::CLAP_VERSION;

use crate::validator::ensure;

use super::raw::Raw;

/// A preset: its name, the kind and path of its location, and its key there.
type Found = (String, u32, Option<CString>, Option<CString>);

#[derive(Default)]
struct Discovered {
    locations: RefCell<Vec<(u32, Option<CString>)>>,
    filetypes: Cell<usize>,
    /// Location of the presets that are being announced.
    at: RefCell<(u32, Option<CString>)>,
    presets: RefCell<Vec<Found>>,
    plugins: Cell<usize>,
    errors: RefCell<Vec<String>>,
}

/// Paths of the preset files in a folder.
fn files_in(folder: &CStr) -> Vec<CString> {
    let entries = std::fs::read_dir(folder.to_string_lossy().as_ref()).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|end| end == "toml"));
    paths.filter_map(|path| CString::new(path.into_os_string().into_encoded_bytes()).ok()).collect()
}

unsafe extern "C" fn filetype(
    indexer: *const clap_preset_discovery_indexer,
    _filetype: *const clap_preset_discovery_filetype,
) -> bool {
    // SAFETY: made below.
    let found = unsafe { &*(*indexer).indexer_data.cast::<Discovered>() };
    found.filetypes.set(found.filetypes.get() + 1);
    true
}

unsafe extern "C" fn location(
    indexer: *const clap_preset_discovery_indexer,
    location: *const clap_preset_discovery_location,
) -> bool {
    // SAFETY: made below; a live location.
    unsafe {
        let found = &*(*indexer).indexer_data.cast::<Discovered>();
        let path = (*location).location;
        let path = (!path.is_null()).then(|| CStr::from_ptr(path).to_owned());
        found.locations.borrow_mut().push(((*location).kind, path));
    }
    true
}

unsafe extern "C" fn failed(
    receiver: *const clap_preset_discovery_metadata_receiver,
    _os_error: i32,
    message: *const c_char,
) {
    // SAFETY: made below; a live text.
    unsafe {
        let found = &*(*receiver).receiver_data.cast::<Discovered>();
        found.errors.borrow_mut().push(CStr::from_ptr(message).to_string_lossy().into_owned());
    }
}

unsafe extern "C" fn begin(
    receiver: *const clap_preset_discovery_metadata_receiver,
    name: *const c_char,
    key: *const c_char,
) -> bool {
    // SAFETY: made below; live texts.
    unsafe {
        let found = &*(*receiver).receiver_data.cast::<Discovered>();
        let key = (!key.is_null()).then(|| CStr::from_ptr(key).to_owned());
        let name = CStr::from_ptr(name).to_string_lossy().into_owned();
        let (kind, path) = found.at.borrow().clone();
        found.presets.borrow_mut().push((name, kind, path, key));
    }
    true
}

unsafe extern "C" fn plugin(
    receiver: *const clap_preset_discovery_metadata_receiver,
    _id: *const clap_sys::universal_plugin_id::clap_universal_plugin_id,
) {
    // SAFETY: made below.
    let found = unsafe { &*(*receiver).receiver_data.cast::<Discovered>() };
    found.plugins.set(found.plugins.get() + 1);
}

/// An indexer that fills a [`Discovered`].
fn indexer(data: *mut c_void) -> clap_preset_discovery_indexer {
    clap_preset_discovery_indexer {
        clap_version: CLAP_VERSION,
        name: c"pyrophone-validator".as_ptr(),
        vendor: std::ptr::null(),
        url: std::ptr::null(),
        version: std::ptr::null(),
        indexer_data: data,
        declare_filetype: Some(filetype),
        declare_location: Some(location),
        declare_soundpack: None,
        get_extension: None,
    }
}

/// A receiver that fills a [`Discovered`].
fn receiver(data: *mut c_void) -> clap_preset_discovery_metadata_receiver {
    clap_preset_discovery_metadata_receiver {
        receiver_data: data,
        on_error: Some(failed),
        begin_preset: Some(begin),
        add_plugin_id: Some(plugin),
        set_soundpack_id: None,
        set_flags: None,
        add_creator: None,
        set_description: None,
        set_timestamps: None,
        add_feature: None,
        add_extra_info: None,
    }
}

/// Requests all presets that the bundle's provider knows.
fn discover(raw: &Raw) -> Result<Discovered, String> {
    let found = Discovered::default();
    let data = std::ptr::from_ref(&found).cast_mut().cast::<c_void>();
    let (indexer, receiver) = (indexer(data), receiver(data));
    // SAFETY: a live entry; all arguments live as long as the provider.
    unsafe {
        let factory = ((*raw.entry).get_factory.ok_or("no get_factory")?)(CLAP_PRESET_DISCOVERY_FACTORY_ID.as_ptr());
        let factory = factory.cast::<clap_preset_discovery_factory>().as_ref().ok_or("no preset discovery")?;
        let descriptor = (factory.get_descriptor.ok_or("no descriptor")?)(factory, 0);
        let id = descriptor.as_ref().ok_or("no provider")?.id;
        let provider = (factory.create.ok_or("no create")?)(factory, &indexer, id);
        let provider_ref = provider.as_ref().ok_or("it makes no provider")?;
        ensure((provider_ref.init.ok_or("no init")?)(provider), || "the provider does not initialise".to_owned())?;
        let get = provider_ref.get_metadata.ok_or("no metadata")?;
        let locations = found.locations.borrow().clone();
        for (kind, path) in locations {
            // A folder is processed file by file, as in hosts.
            let paths: Vec<Option<CString>> = match &path {
                Some(folder) => files_in(folder).into_iter().map(Some).collect(),
                None => vec![None],
            };
            for path in paths {
                let location = path.as_ref().map_or(std::ptr::null(), |path| path.as_ptr());
                found.at.replace((kind, path.clone()));
                ensure(get(provider, kind, location, &receiver), || format!("nothing is reported about {path:?}"))?;
            }
        }
        (provider_ref.destroy.ok_or("no destroy")?)(provider);
    }
    Ok(found)
}

/// The check `presets_are_discovered_and_loaded`.
pub(super) fn presets(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    let found = discover(&raw)?;
    let presets = found.presets.borrow();
    ensure(found.errors.borrow().is_empty(), || format!("{:?}", found.errors.borrow()))?;
    ensure(found.filetypes.get() == 1 && presets.len() >= 10 && found.plugins.get() == presets.len(), || {
        format!("{} file types, {} presets for {} plug-ins", found.filetypes.get(), presets.len(), found.plugins.get())
    })?;
    // SAFETY: the id's type.
    let load: &clap_plugin_preset_load = unsafe { raw.extension(CLAP_EXT_PRESET_LOAD)? };
    let load = load.from_location.ok_or("no from_location")?;
    let mut states = BTreeSet::new();
    for (name, kind, path, key) in presets.iter() {
        let text = |text: &Option<CString>| text.as_ref().map_or(std::ptr::null(), |text| text.as_ptr());
        // SAFETY: a live plug-in and live texts.
        let is_loaded = unsafe { load(raw.plugin, *kind, text(path), text(key)) };
        ensure(is_loaded, || format!("{name} is not loaded"))?;
        states.insert(raw.save()?);
    }
    ensure(states.len() > presets.len() / 2, || "most presets leave the same state".to_owned())?;
    // SAFETY: a live plug-in and a live text.
    let is_loaded = unsafe {
        load(raw.plugin, CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN, std::ptr::null(), c"no such preset".as_ptr())
    };
    ensure(!is_loaded, || "it loads a preset that does not exist".to_owned())
}
