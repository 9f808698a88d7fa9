//! CLAP, through `clack-host`.

mod description;
mod handlers;
mod processor;
pub(crate) mod validator;

use std::collections::HashMap;
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, LazyLock, Mutex};

use clack_extensions::audio_ports::PluginAudioPorts;
use clack_extensions::audio_ports_config::{AudioPortsConfigBuffer, PluginAudioPortsConfig};
use clack_extensions::gui::{GuiApiType, GuiConfiguration, GuiSize, PluginGui, Window};
use clack_extensions::latency::PluginLatency;
use clack_extensions::params::PluginParams;
use clack_extensions::render::{PluginRender, RenderMode};
use clack_extensions::state::PluginState;
use clack_host::events::event_types::ParamValueEvent;
use clack_host::prelude::*;

use self::description::{Range, read_layout, read_parameters};
use self::handlers::{Flags, Handlers, MainThread, Shared};
use self::processor::ClapProcessor;
use crate::buses::Buses;
use crate::lock::lock;
use crate::{BusLayout, Configuration, Event, Format, HostError, Parameter, Plugin, Processor, Requests};

/// Entries stay loaded, see [`load`](crate::load).
static ENTRIES: LazyLock<Mutex<HashMap<PathBuf, PluginEntry>>> = LazyLock::new(Mutex::default);
static INSTANCES: AtomicU64 = AtomicU64::new(0);

/// A CLAP instance on its main thread.
pub(crate) struct ClapPlugin {
    instance: PluginInstance<Handlers>,
    number: u64,
    name: String,
    parameters: Vec<Parameter>,
    ranges: Arc<HashMap<u32, Range>>,
    flags: Arc<Flags>,
    pending: Arc<Mutex<Vec<Event>>>,
    reported: Arc<Mutex<Vec<Event>>>,
    editor_is_open: bool,
}

impl ClapPlugin {
    pub fn load(bundle: &Path) -> Result<Self, HostError> {
        let fail = |reason: String| HostError::Load { path: bundle.to_owned(), reason };
        let entry = load_entry(bundle).map_err(fail)?;
        let factory = entry.get_plugin_factory().ok_or_else(|| fail("it has no plugin factory".to_owned()))?;
        let descriptor = factory.plugin_descriptors().next().ok_or_else(|| fail("it holds no plugin".to_owned()))?;
        let plugin_id = descriptor.id().ok_or_else(|| fail("its plugin has no id".to_owned()))?;
        let name = descriptor.name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let host_info = HostInfo::new("pyrophone-host", "Pyrophone", "", env!("CARGO_PKG_VERSION"))
            .map_err(|error| fail(error.to_string()))?;
        let flags = Arc::new(Flags::default());
        let mut instance = PluginInstance::<Handlers>::new(
            |()| Shared(Arc::clone(&flags)),
            |shared| MainThread(Arc::clone(&shared.0)),
            &entry,
            plugin_id,
            &host_info,
        )
        .map_err(|error| fail(error.to_string()))?;
        let (parameters, ranges) = read_parameters(&mut instance);
        Ok(Self {
            instance,
            number: INSTANCES.fetch_add(1, Ordering::Relaxed),
            name,
            parameters,
            ranges: Arc::new(ranges),
            flags,
            pending: Arc::default(),
            reported: Arc::default(),
            editor_is_open: false,
        })
    }

    fn extension<E>(&mut self, name: &str) -> Result<E, HostError>
    where
        E: clack_host::extensions::Extension<ExtensionSide = clack_host::extensions::PluginExtensionSide>,
    {
        self.instance
            .plugin_handle()
            .get_extension()
            .ok_or_else(|| HostError::Unsupported(format!("the plugin has no {name} extension")))
    }

    fn range(&self, id: u32) -> Result<(ClapId, Range), HostError> {
        let range = self.ranges.get(&id);
        ClapId::from_raw(id).zip(range.copied()).ok_or(HostError::UnknownParameter { id })
    }

    /// Selects the ports and returns the plug-in's resulting layout.
    fn select_layout(&mut self, layout: BusLayout) -> Result<BusLayout, HostError> {
        let ports: PluginAudioPorts = self.extension("audio ports")?;
        let configurations: Option<PluginAudioPortsConfig> = self.instance.plugin_handle().get_extension();
        let fits = |have: BusLayout, unconnected: bool| {
            have.input == layout.input
                && have.output == layout.output
                && (have.sidechain == layout.sidechain || (unconnected && layout.sidechain == 0))
        };
        let handle = self.instance.plugin_handle();
        let Some(configurations) = configurations else {
            let have = read_layout(&ports, &handle);
            return fits(have, true).then_some(have).ok_or(HostError::Layout(layout));
        };
        for unconnected in [false, true] {
            for index in 0..configurations.count(&handle) {
                let mut buffer = AudioPortsConfigBuffer::new();
                let Some(configuration) = configurations.get(&handle, index, &mut buffer) else {
                    continue;
                };
                if configurations.select(&handle, configuration.id).is_err() {
                    continue;
                }
                let have = read_layout(&ports, &handle);
                if fits(have, unconnected) {
                    return Ok(have);
                }
            }
        }
        Err(HostError::Layout(layout))
    }
}

impl Plugin for ClapPlugin {
    fn format(&self) -> Format {
        Format::Clap
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn value(&mut self, id: u32) -> Result<f64, HostError> {
        let (clap_id, range) = self.range(id)?;
        let params: PluginParams = self.extension("parameters")?;
        params
            .get_value(&self.instance.plugin_handle(), clap_id)
            .map(|plain| range.normalized(plain))
            .ok_or(HostError::UnknownParameter { id })
    }

    fn set_value(&mut self, id: u32, value: f64) -> Result<(), HostError> {
        let (clap_id, range) = self.range(id)?;
        let params: PluginParams = self.extension("parameters")?;
        if let Some(mut handle) = self.instance.inactive_plugin_handle() {
            let events = [ParamValueEvent::new(0, clap_id, Pckn::match_all(), range.plain(value))];
            params.flush(&mut handle, &InputEvents::from_buffer(&events), &mut OutputEvents::void());
        } else {
            lock(&self.pending).push(Event { offset: 0, id, value });
        }
        Ok(())
    }

    fn text(&mut self, id: u32, value: f64) -> Result<String, HostError> {
        let (clap_id, range) = self.range(id)?;
        let params: PluginParams = self.extension("parameters")?;
        let mut buffer = [0; 256];
        params
            .value_to_text(&self.instance.plugin_handle(), clap_id, range.plain(value), &mut buffer)
            .map(|text| String::from_utf8_lossy(text).into_owned())
            .map_err(|_| HostError::UnknownParameter { id })
    }

    fn parse(&mut self, id: u32, text: &str) -> Result<f64, HostError> {
        let (clap_id, range) = self.range(id)?;
        let params: PluginParams = self.extension("parameters")?;
        let not_understood = || HostError::Text { id, text: text.to_owned() };
        let c_text = CString::new(text).map_err(|_| not_understood())?;
        params
            .text_to_value(&self.instance.plugin_handle(), clap_id, &c_text)
            .map(|plain| range.normalized(plain))
            .ok_or_else(not_understood)
    }

    fn state(&mut self) -> Result<Vec<u8>, HostError> {
        let state: PluginState = self.extension("state")?;
        let mut bytes = Vec::new();
        state.save(&self.instance.plugin_handle(), &mut bytes).map_err(|_| HostError::State { action: "save" })?;
        Ok(bytes)
    }

    fn set_state(&mut self, bytes: &[u8]) -> Result<(), HostError> {
        let state: PluginState = self.extension("state")?;
        state.load(&self.instance.plugin_handle(), &mut &bytes[..]).map_err(|_| HostError::State { action: "load" })
    }

    fn activate(&mut self, configuration: &Configuration) -> Result<Box<dyn Processor>, HostError> {
        if self.instance.is_active() {
            return Err(HostError::Lifecycle { found: "active", needed: "inactive" });
        }
        let max_frames_count =
            u32::try_from(configuration.max_block).ok().filter(|&frames| frames > 0).ok_or_else(|| {
                HostError::Activate(format!(
                    "blocks of at most {} frames; give 1 to {}",
                    configuration.max_block,
                    u32::MAX
                ))
            })?;
        let layout = self.select_layout(configuration.layout)?;
        if let Ok(render) = self.extension::<PluginRender>("render") {
            let mode = if configuration.offline { RenderMode::Offline } else { RenderMode::Realtime };
            render.set(&self.instance.plugin_handle(), mode).map_err(|error| HostError::Activate(error.to_string()))?;
        }
        let stopped = self
            .instance
            .activate(
                |_, _| (),
                PluginAudioConfiguration {
                    sample_rate: configuration.sample_rate,
                    min_frames_count: 1,
                    max_frames_count,
                },
            )
            .map_err(|error| HostError::Activate(error.to_string()))?;
        Ok(Box::new(ClapProcessor::new(
            stopped.into(),
            self.number,
            Buses::new(layout, configuration.max_block),
            configuration.sample_rate,
            Arc::clone(&self.ranges),
            Arc::clone(&self.pending),
            Arc::clone(&self.reported),
        )))
    }

    fn deactivate(&mut self, mut processor: Box<dyn Processor>) -> Result<(), HostError> {
        if processor.instance() != self.number || !self.instance.is_active() {
            return Err(HostError::Lifecycle {
                found: "inactive, or the processor is of another instance",
                needed: "active",
            });
        }
        processor.stop();
        drop(processor);
        self.instance.try_deactivate().map_err(|error| HostError::Activate(error.to_string()))?;
        let unplayed = std::mem::take(&mut *lock(&self.pending));
        unplayed.iter().try_for_each(|event| self.set_value(event.id, event.value))
    }

    fn take_reported_values(&mut self) -> Vec<Event> {
        std::mem::take(&mut *lock(&self.reported))
    }

    fn take_menu_choices(&mut self) -> Vec<(u32, i32)> {
        self.flags.take_chosen()
    }

    fn latency_samples(&mut self) -> u32 {
        self.extension::<PluginLatency>("latency").map_or(0, |latency| latency.get(&self.instance.plugin_handle()))
    }

    fn run_callbacks(&mut self) -> Requests {
        while self.flags.take_callback() {
            self.instance.call_on_main_thread_callback();
        }
        self.flags.take_requests()
    }

    fn open_editor(&mut self, window: u32) -> Result<(u32, u32), HostError> {
        let gui: PluginGui = self.extension("editor")?;
        let handle = self.instance.plugin_handle();
        let failed = |what: &str| HostError::Unsupported(format!("the editor cannot be {what}"));
        let api_type = if cfg!(windows) { GuiApiType::WIN32 } else { GuiApiType::X11 };
        let configuration = GuiConfiguration { api_type, is_floating: false };
        gui.create(&handle, configuration).map_err(|_| failed("created for this system's windows"))?;
        self.editor_is_open = true;
        let size = gui.get_size(&handle).ok_or_else(|| failed("asked for its size"))?;
        // SAFETY: the window is the caller's, and an id instead of memory; if it no longer exists, the system reports
        // that.
        unsafe {
            #[cfg(windows)]
            let parent = Window::from_win32_hwnd(window as usize as *mut std::ffi::c_void);
            #[cfg(not(windows))]
            let parent = Window::from_x11_handle(window.into());
            gui.set_parent(&handle, parent)
        }
        .map_err(|_| failed("embedded"))?;
        gui.show(&handle).map_err(|_| failed("shown"))?;
        Ok((size.width, size.height))
    }

    fn scale_editor(&mut self, scale: f64) -> Result<(u32, u32), HostError> {
        let failed = |what: &str| HostError::Unsupported(format!("the editor {what}"));
        if !self.editor_is_open {
            return Err(failed("is not open"));
        }
        let gui: PluginGui = self.extension("editor")?;
        let handle = self.instance.plugin_handle();
        gui.set_scale(&handle, scale).map_err(|_| failed("is not scaled"))?;
        let size = gui.get_size(&handle).ok_or_else(|| failed("does not tell its size"))?;
        Ok((size.width, size.height))
    }

    fn resize_editor(&mut self, (width, height): (u32, u32)) -> Result<(u32, u32), HostError> {
        let failed = |what: &str| HostError::Unsupported(format!("the editor {what}"));
        if !self.editor_is_open {
            return Err(failed("is not open"));
        }
        let gui: PluginGui = self.extension("editor")?;
        let handle = self.instance.plugin_handle();
        if !gui.can_resize(&handle) {
            return Err(failed("keeps its size"));
        }
        let size = gui.adjust_size(&handle, GuiSize { width, height }).ok_or_else(|| failed("takes no size"))?;
        gui.set_size(&handle, size).map_err(|_| failed("cannot be resized"))?;
        Ok((size.width, size.height))
    }

    fn take_wanted_editor_size(&mut self) -> Option<(u32, u32)> {
        self.flags.take_editor_size()
    }

    fn close_editor(&mut self) {
        if std::mem::take(&mut self.editor_is_open)
            && let Ok(gui) = self.extension::<PluginGui>("editor")
        {
            gui.destroy(&self.instance.plugin_handle());
        }
    }

    fn forget_editor(&mut self) {
        self.editor_is_open = false;
    }
}

impl Drop for ClapPlugin {
    fn drop(&mut self) {
        self.close_editor();
    }
}

fn load_entry(bundle: &Path) -> Result<PluginEntry, String> {
    let path = bundle.canonicalize().map_err(|error| error.to_string())?;
    let mut entries = lock(&ENTRIES);
    if let Some(entry) = entries.get(&path) {
        return Ok(entry.clone());
    }
    // SAFETY: loading runs code of the bundle, as the caller requested.
    let entry = unsafe { PluginEntry::load(&path) }.map_err(|error| error.to_string())?;
    entries.insert(path, entry.clone());
    Ok(entry)
}
