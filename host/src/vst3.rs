//! VST3, through the bindings of the `vst3` crate.

mod description;
mod editor;
mod interfaces;
mod module;
mod processor;
pub(crate) mod validator;

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use ::vst3::Steinberg::Vst::{
    BusDirections_, BusInfo, IAudioProcessor, IAudioProcessorTrait, IComponent, IComponentHandler, IComponentTrait,
    IEditController, IEditControllerTrait, IHostApplication, MediaTypes_, ProcessModes_, ProcessSetup, SpeakerArr,
    SpeakerArrangement, String128, SymbolicSampleSizes_,
};
use ::vst3::Steinberg::{FUnknown, IBStream, IPluginBaseTrait, kResultOk};
use ::vst3::{ComPtr, ComWrapper};

use self::description::{arrangement, create_component, from_utf16, read_controllers, read_parameters};
use self::editor::Editor;
use self::interfaces::{Handler, HostApplication, MemoryStream};
use self::module::Module;
use self::processor::Vst3Processor;
use crate::buses::Buses;
use crate::lock::lock;
use crate::{BusLayout, Configuration, Event, Format, HostError, Parameter, Plugin, Processor, Requests};

static INSTANCES: AtomicU64 = AtomicU64::new(0);

const AUDIO: i32 = MediaTypes_::kAudio as i32;
const INPUT: i32 = BusDirections_::kInput as i32;
const OUTPUT: i32 = BusDirections_::kOutput as i32;

/// A VST3 instance on its main thread. Component and controller are one object, as nice-plug has them.
pub(crate) struct Vst3Plugin {
    component: ComPtr<IComponent>,
    processor: ComPtr<IAudioProcessor>,
    controller: ComPtr<IEditController>,
    handler: ComWrapper<Handler>,
    /// Kept because the plug-in may hold a pointer to it.
    _application: ComWrapper<HostApplication>,
    number: u64,
    name: String,
    parameters: Vec<Parameter>,
    pending: Arc<Mutex<Vec<Event>>>,
    /// Values in the plug-in's output.
    reported: Arc<Mutex<Vec<Event>>>,
    active: bool,
    editor: Option<Editor>,
}

impl Vst3Plugin {
    pub fn load(bundle: &Path) -> Result<Self, HostError> {
        let fail = |reason: &str| HostError::Load { path: bundle.to_owned(), reason: reason.to_owned() };
        let module = Module::load(bundle).map_err(|reason| fail(&reason))?;
        let (component, name) = create_component(&module).ok_or_else(|| fail("it holds no audio effect"))?;
        let application = ComWrapper::new(HostApplication);
        let context = application
            .as_com_ref::<IHostApplication>()
            .map_or(std::ptr::null_mut(), |host| host.as_ptr().cast::<FUnknown>());
        // SAFETY: a live component, initialised once; the context outlives it.
        if unsafe { component.initialize(context) } != kResultOk {
            return Err(fail("its plugin cannot be initialised"));
        }
        let processor = component.cast::<IAudioProcessor>().ok_or_else(|| fail("its plugin plays no audio"))?;
        let controller = component
            .cast::<IEditController>()
            .ok_or_else(|| fail("its controller is a separate object, which this host does not support"))?;
        let pending = Arc::default();
        let handler = ComWrapper::new(Handler::new(Arc::clone(&pending)));
        if let Some(interface) = handler.as_com_ref::<IComponentHandler>() {
            // SAFETY: a live controller; the handler lives as long as this instance.
            unsafe { controller.setComponentHandler(interface.as_ptr()) };
        }
        let parameters = read_parameters(&controller);
        Ok(Self {
            component,
            processor,
            controller,
            handler,
            _application: application,
            number: INSTANCES.fetch_add(1, Ordering::Relaxed),
            name,
            parameters,
            pending,
            reported: Arc::default(),
            active: false,
            editor: None,
        })
    }

    fn set_active(&mut self, active: bool) {
        self.active = active;
        self.handler.set_active(active);
    }

    fn known(&self, id: u32) -> Result<(), HostError> {
        if self.parameters.iter().any(|parameter| parameter.id == id) {
            Ok(())
        } else {
            Err(HostError::UnknownParameter { id })
        }
    }

    /// Arranges the buses and returns the plug-in's resulting layout.
    fn select_layout(&self, layout: BusLayout) -> Result<BusLayout, HostError> {
        let sidechains: &[u32] = if layout.sidechain == 0 { &[0, 2, 1] } else { &[layout.sidechain] };
        for &sidechain in sidechains {
            let wanted = BusLayout { sidechain, ..layout };
            let mut inputs = vec![arrangement(layout.input)];
            if sidechain > 0 {
                inputs.push(arrangement(sidechain));
            }
            let mut outputs = [arrangement(layout.output)];
            // SAFETY: a live processor, and arrays of the stated lengths.
            let result = unsafe {
                self.processor.setBusArrangements(inputs.as_mut_ptr(), inputs.len() as i32, outputs.as_mut_ptr(), 1)
            };
            if result == kResultOk && self.read_layout() == wanted && self.names_output(outputs[0]) {
                return Ok(wanted);
            }
        }
        Err(HostError::Layout(layout))
    }

    /// True if the output has the loudspeakers of an arrangement.
    fn names_output(&self, expected: SpeakerArrangement) -> bool {
        let mut found = SpeakerArr::kEmpty;
        // SAFETY: a live processor and a writable location.
        let result = unsafe { self.processor.getBusArrangement(OUTPUT, 0, &mut found) };
        result == kResultOk && found == expected
    }

    fn read_layout(&self) -> BusLayout {
        let channels = |direction, index| {
            // SAFETY: all fields are numbers, for which zero is a value.
            let mut info: BusInfo = unsafe { std::mem::zeroed() };
            // SAFETY: a live component and a writable location.
            let exists = unsafe {
                index < self.component.getBusCount(AUDIO, direction)
                    && self.component.getBusInfo(AUDIO, direction, index, &mut info) == kResultOk
            };
            if exists { u32::try_from(info.channelCount).unwrap_or(0) } else { 0 }
        };
        BusLayout { input: channels(INPUT, 0), sidechain: channels(INPUT, 1), output: channels(OUTPUT, 0) }
    }
}

impl Plugin for Vst3Plugin {
    fn format(&self) -> Format {
        Format::Vst3
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn value(&mut self, id: u32) -> Result<f64, HostError> {
        self.known(id)?;
        // SAFETY: a live controller.
        Ok(unsafe { self.controller.getParamNormalized(id) })
    }

    fn set_value(&mut self, id: u32, value: f64) -> Result<(), HostError> {
        self.known(id)?;
        let value = value.clamp(0.0, 1.0);
        if self.active {
            lock(&self.pending).push(Event { offset: 0, id, value });
        }
        // SAFETY: a live controller.
        unsafe { self.controller.setParamNormalized(id, value) };
        Ok(())
    }

    fn text(&mut self, id: u32, value: f64) -> Result<String, HostError> {
        self.known(id)?;
        let mut text: String128 = [0; 128];
        // SAFETY: a live controller and a writable location.
        let result = unsafe { self.controller.getParamStringByValue(id, value, &raw mut text) };
        if result == kResultOk { Ok(from_utf16(&text)) } else { Err(HostError::UnknownParameter { id }) }
    }

    fn parse(&mut self, id: u32, text: &str) -> Result<f64, HostError> {
        self.known(id)?;
        let mut wide: Vec<u16> = text.encode_utf16().chain([0]).collect();
        let mut value = 0.0;
        // SAFETY: a live controller, a text that ends with zero and a writable location.
        let result = unsafe { self.controller.getParamValueByString(id, wide.as_mut_ptr(), &mut value) };
        if result == kResultOk { Ok(value) } else { Err(HostError::Text { id, text: text.to_owned() }) }
    }

    fn state(&mut self) -> Result<Vec<u8>, HostError> {
        let stream = ComWrapper::new(MemoryStream::new(Vec::new()));
        // SAFETY: a live component; the stream outlives the call.
        let result = unsafe { self.component.getState(stream_pointer(&stream)) };
        if result == kResultOk { Ok(stream.bytes()) } else { Err(HostError::State { action: "save" }) }
    }

    fn set_state(&mut self, state: &[u8]) -> Result<(), HostError> {
        let stream = ComWrapper::new(MemoryStream::new(state.to_vec()));
        // SAFETY: a live component; the stream outlives the call.
        let result = unsafe { self.component.setState(stream_pointer(&stream)) };
        if result != kResultOk {
            return Err(HostError::State { action: "load" });
        }
        stream.rewind();
        // SAFETY: a live controller; the stream outlives the call.
        unsafe { self.controller.setComponentState(stream_pointer(&stream)) };
        Ok(())
    }

    fn activate(&mut self, configuration: &Configuration) -> Result<Box<dyn Processor>, HostError> {
        if self.active {
            return Err(HostError::Lifecycle { found: "active", needed: "inactive" });
        }
        let max_block = i32::try_from(configuration.max_block).ok().filter(|&frames| frames > 0).ok_or_else(|| {
            HostError::Activate(format!("blocks of at most {} frames; give 1 to {}", configuration.max_block, i32::MAX))
        })?;
        let layout = self.select_layout(configuration.layout)?;
        let mode = if configuration.offline { ProcessModes_::kOffline } else { ProcessModes_::kRealtime };
        let mut setup = ProcessSetup {
            processMode: mode as i32,
            symbolicSampleSize: SymbolicSampleSizes_::kSample32 as i32,
            maxSamplesPerBlock: max_block,
            sampleRate: configuration.sample_rate,
        };
        // Twice, because nice-plug 0.4.2 hands a new process mode to the plugin only with the setup after it.
        for _ in 0..2 {
            // SAFETY: a live processor that is not active.
            if unsafe { self.processor.setupProcessing(&mut setup) } != kResultOk {
                return Err(HostError::Activate(format!(
                    "it refuses {} Hz with blocks of at most {max_block} frames",
                    configuration.sample_rate
                )));
            }
        }
        // SAFETY: a live component that is not active, with the buses just arranged.
        let result = unsafe {
            self.component.activateBus(AUDIO, INPUT, 0, 1);
            self.component.activateBus(AUDIO, OUTPUT, 0, 1);
            if layout.sidechain > 0 {
                let connected = u8::from(configuration.layout.sidechain > 0);
                self.component.activateBus(AUDIO, INPUT, 1, connected);
            }
            self.component.setActive(1)
        };
        if result != kResultOk {
            return Err(HostError::Activate("it refuses".to_owned()));
        }
        self.set_active(true);
        let processor = Vst3Processor::new(
            self.processor.clone(),
            self.number,
            Buses::new(layout, configuration.max_block),
            setup,
            self.parameters.iter().map(|p| p.id).collect(),
            [&self.pending, &self.reported].map(Arc::clone),
        );
        Ok(Box::new(processor.with_controllers(read_controllers(&self.controller))))
    }

    fn deactivate(&mut self, mut processor: Box<dyn Processor>) -> Result<(), HostError> {
        if processor.instance() != self.number || !self.active {
            return Err(HostError::Lifecycle {
                found: "inactive, or the processor is of another instance",
                needed: "active",
            });
        }
        processor.stop();
        drop(processor);
        self.set_active(false);
        // SAFETY: a live component whose processor is gone.
        unsafe { self.component.setActive(0) };
        let unplayed = std::mem::take(&mut *lock(&self.pending));
        unplayed.iter().try_for_each(|event| self.set_value(event.id, event.value))
    }

    fn take_reported_values(&mut self) -> Vec<Event> {
        let reported = std::mem::take(&mut *lock(&self.reported));
        for event in &reported {
            // SAFETY: a live controller.
            unsafe { self.controller.setParamNormalized(event.id, event.value) };
        }
        reported
    }

    fn take_menu_choices(&mut self) -> Vec<(u32, i32)> {
        self.handler.take_chosen()
    }

    fn latency_samples(&mut self) -> u32 {
        // SAFETY: a live processor.
        unsafe { self.processor.getLatencySamples() }
    }

    fn run_callbacks(&mut self) -> Requests {
        if let Some(editor) = &self.editor {
            editor.run();
        }
        self.handler.take_requests()
    }

    fn open_editor(&mut self, window: u32) -> Result<(u32, u32), HostError> {
        if self.editor.is_some() {
            return Err(HostError::Unsupported("the editor is open already".to_owned()));
        }
        let (editor, size) = Editor::open(&self.controller, window)?;
        self.editor = Some(editor);
        Ok(size)
    }

    fn scale_editor(&mut self, scale: f64) -> Result<(u32, u32), HostError> {
        match &self.editor {
            Some(editor) => editor.scale(scale),
            None => Err(HostError::Unsupported("no editor is open".to_owned())),
        }
    }

    fn resize_editor(&mut self, size: (u32, u32)) -> Result<(u32, u32), HostError> {
        match &self.editor {
            Some(editor) => editor.resize(size),
            None => Err(HostError::Unsupported("no editor is open".to_owned())),
        }
    }

    fn take_wanted_editor_size(&mut self) -> Option<(u32, u32)> {
        self.editor.as_ref().and_then(Editor::take_wanted_size)
    }

    fn close_editor(&mut self) {
        self.editor = None;
    }

    fn forget_editor(&mut self) {
        if let Some(editor) = self.editor.take() {
            editor.forget();
        }
    }
}

impl Drop for Vst3Plugin {
    fn drop(&mut self) {
        self.close_editor();
        // SAFETY: live interfaces; a plug-in dropped while active is deactivated first, as the format requires.
        unsafe {
            if self.active {
                self.component.setActive(0);
            }
            self.controller.setComponentHandler(std::ptr::null_mut());
            self.component.terminate();
        }
    }
}

fn stream_pointer(stream: &ComWrapper<MemoryStream>) -> *mut IBStream {
    stream.as_com_ref::<IBStream>().map_or(std::ptr::null_mut(), |stream| stream.as_ptr())
}
