//! Checks of a VST3 bundle, see [`validator`](crate::validator).

mod states;

use std::path::Path;

use ::vst3::Steinberg::Vst::{
    AudioBusBuffers, AudioBusBuffers__type0, IAudioProcessor, IAudioProcessorTrait, IComponent, IComponentTrait,
    IEditController, IEditControllerTrait, IUnitInfo, IUnitInfoTrait, ParameterInfo, ParameterInfo_::ParameterFlags_,
    ProcessData, ProcessSetup, SpeakerArr, SpeakerArrangement, SymbolicSampleSizes_, UnitInfo, kRootUnitId,
};
use ::vst3::Steinberg::{
    IBStream, IPluginBaseTrait, IPluginFactory2, IPluginFactory2Trait, IPluginFactoryTrait, PClassInfo2, PFactoryInfo,
    kResultOk,
};
use ::vst3::{ComPtr, ComWrapper};

use super::description::{create_component, from_c, from_utf16};
use super::interfaces::MemoryStream;
use super::module::Module;
use super::{AUDIO, INPUT, OUTPUT};
use crate::numeric_id;
use crate::validator::{Check, ODD_RATES_HZ, duplicate, ensure};

const BLOCK: usize = 64;

/// All checks.
pub(crate) const CHECKS: &[Check] = &[
    Check { name: "null_and_missing_buffers_are_survived_and_silent", run: null_and_missing_buffers },
    Check { name: "layouts_it_was_not_told_of_are_survived", run: unannounced_layouts },
    Check { name: "a_value_set_while_processing_is_read_and_saved_at_once", run: states::value_is_saved_at_once },
    Check { name: "saved_bytes_do_not_change_by_load_and_save", run: states::bytes_stay },
    Check { name: "a_value_is_saved_the_same_before_and_after_it_arrives", run: states::saved_as_it_arrives },
    Check { name: "an_arrangement_that_is_accepted_is_reported", run: arrangements_are_reported },
    Check { name: "odd_rates_activate_and_pass_sound_through", run: odd_rates },
    Check { name: "indices_beyond_the_last_are_refused", run: indices_beyond },
    Check { name: "moduleinfo_says_what_the_factory_says", run: moduleinfo },
    Check { name: "names_units_and_flags_of_parameters_are_sound", run: parameters_are_sound },
];

/// An instance without a host's usual safeguards.
struct Raw {
    component: ComPtr<IComponent>,
    processor: ComPtr<IAudioProcessor>,
    controller: ComPtr<IEditController>,
    is_active: bool,
}

impl Raw {
    fn load(bundle: &Path) -> Result<Self, String> {
        let module = Module::load(bundle)?;
        let (component, _) = create_component(&module).ok_or("it holds no audio effect")?;
        // SAFETY: a live component; a context is optional.
        unsafe { component.initialize(std::ptr::null_mut()) };
        let processor = component.cast().ok_or("its plug-in plays no audio")?;
        let controller = component.cast().ok_or("its controller is a separate object")?;
        Ok(Self { component, processor, controller, is_active: false })
    }

    fn start(&mut self, sample_rate: f64) -> Result<(), String> {
        let mut setup = ProcessSetup {
            processMode: 0,
            symbolicSampleSize: SymbolicSampleSizes_::kSample32 as i32,
            maxSamplesPerBlock: BLOCK as i32,
            sampleRate: sample_rate,
        };
        // SAFETY: a live component that is not active.
        let results = unsafe {
            [self.processor.setupProcessing(&mut setup), self.component.setActive(1), self.processor.setProcessing(1)]
        };
        self.is_active = true;
        ensure(results == [kResultOk; 3], || format!("at {sample_rate} Hz it answers {results:?}"))
    }

    fn stop(&mut self) {
        // SAFETY: a live component.
        unsafe {
            self.processor.setProcessing(0);
            self.component.setActive(0);
        }
        self.is_active = false;
    }

    /// Plays a block with any kind of buses.
    fn process(&self, inputs: &mut [AudioBusBuffers], outputs: &mut [AudioBusBuffers]) -> i32 {
        let mut data = ProcessData {
            processMode: 0,
            symbolicSampleSize: SymbolicSampleSizes_::kSample32 as i32,
            numSamples: BLOCK as i32,
            numInputs: inputs.len() as i32,
            numOutputs: outputs.len() as i32,
            inputs: if inputs.is_empty() { std::ptr::null_mut() } else { inputs.as_mut_ptr() },
            outputs: if outputs.is_empty() { std::ptr::null_mut() } else { outputs.as_mut_ptr() },
            inputParameterChanges: std::ptr::null_mut(),
            outputParameterChanges: std::ptr::null_mut(),
            inputEvents: std::ptr::null_mut(),
            outputEvents: std::ptr::null_mut(),
            processContext: std::ptr::null_mut(),
        };
        // SAFETY: a live, active processor; pointers are null or to channels of a block's length.
        unsafe { self.processor.process(&mut data) }
    }

    fn arrange(&self, inputs: &mut [SpeakerArrangement], output: SpeakerArrangement) -> bool {
        let mut outputs = [output];
        // SAFETY: a live processor that is not active, and arrays of the stated lengths.
        let result = unsafe {
            self.processor.setBusArrangements(inputs.as_mut_ptr(), inputs.len() as i32, outputs.as_mut_ptr(), 1)
        };
        result == kResultOk
    }

    fn arrangement(&self, direction: i32, index: usize) -> Option<SpeakerArrangement> {
        let mut found = SpeakerArr::kEmpty;
        // SAFETY: a live processor and a writable location.
        let result = unsafe { self.processor.getBusArrangement(direction, index as i32, &mut found) };
        (result == kResultOk).then_some(found)
    }

    fn save(&self) -> Result<Vec<u8>, String> {
        let stream = ComWrapper::new(MemoryStream::new(Vec::new()));
        let pointer = stream.as_com_ref::<IBStream>().ok_or("no stream")?.as_ptr();
        // SAFETY: a live component and a live stream.
        let result = unsafe { self.component.getState(pointer) };
        ensure(result == kResultOk, || "it does not save".to_owned())?;
        Ok(stream.bytes())
    }

    fn load_state(&self, bytes: &[u8]) -> Result<(), String> {
        let stream = ComWrapper::new(MemoryStream::new(bytes.to_vec()));
        let pointer = stream.as_com_ref::<IBStream>().ok_or("no stream")?.as_ptr();
        // SAFETY: a live component and a live stream.
        let result = unsafe { self.component.setState(pointer) };
        ensure(result == kResultOk, || "it does not load what it saved".to_owned())
    }

    fn parameters(&self) -> Vec<ParameterInfo> {
        // SAFETY: a live controller, and writable locations whose fields are numbers.
        unsafe {
            let read = |index| {
                let mut info: ParameterInfo = std::mem::zeroed();
                (self.controller.getParameterInfo(index, &mut info) == kResultOk).then_some(info)
            };
            (0..self.controller.getParameterCount()).filter_map(read).collect()
        }
    }
}

impl Drop for Raw {
    fn drop(&mut self) {
        if self.is_active {
            self.stop();
        }
        // SAFETY: a live component, inactive.
        unsafe { self.component.terminate() };
    }
}

fn bus(channels: &mut [*mut f32]) -> AudioBusBuffers {
    AudioBusBuffers {
        numChannels: channels.len() as i32,
        silenceFlags: 0,
        __field0: AudioBusBuffers__type0 { channelBuffers32: channels.as_mut_ptr() },
    }
}

/// A bus that claims channels without even having pointers.
fn null_channels(channels: i32) -> AudioBusBuffers {
    AudioBusBuffers {
        numChannels: channels,
        silenceFlags: 0,
        __field0: AudioBusBuffers__type0 { channelBuffers32: std::ptr::null_mut() },
    }
}

fn are_silent(channels: &[Vec<f32>]) -> bool {
    channels.iter().flatten().all(|sample| *sample == 0.0)
}

/// Every mixture of input buses that are there, hollow, half there or left out.
fn null_and_missing_buffers(bundle: &Path) -> Result<(), String> {
    let mut raw = Raw::load(bundle)?;
    raw.start(48_000.0)?;
    let null = std::ptr::null_mut;
    for inputs in 0..4 {
        for kind in 0..3 {
            let mut output = vec![vec![f32::NAN; BLOCK]; 2];
            let mut out_pointers: Vec<*mut f32> = output.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
            let mut silence = vec![0.0f32; BLOCK];
            let mut pointers = [[null(), null()], [silence.as_mut_ptr(), null()], [null(), silence.as_mut_ptr()]];
            let mut buses: Vec<AudioBusBuffers> = pointers
                .iter_mut()
                .take(inputs)
                .map(|pointers| if kind == 0 { null_channels(2) } else { bus(&mut pointers[..kind]) })
                .collect();
            let result = raw.process(&mut buses, &mut [bus(&mut out_pointers)]);
            ensure(result == kResultOk && are_silent(&output), || {
                format!("with {inputs} input buses of kind {kind} it answers {result} and is not silent")
            })?;
        }
    }
    // Outputs that are not there either.
    for outputs in [vec![], vec![null_channels(2)], vec![null_channels(0)]] {
        let mut outputs = outputs;
        raw.process(&mut [], &mut outputs);
        raw.process(&mut [null_channels(2), null_channels(2)], &mut outputs);
    }
    Ok(())
}

/// Channels as JUCE's hosts provide them when they run out: a null pointer, followed by whatever is in memory.
fn dangling(bus: &mut [*mut f32]) -> &mut [*mut f32] {
    if let [first, rest @ ..] = bus {
        *first = std::ptr::null_mut();
        rest.fill(std::ptr::without_provenance_mut(0x7374_7261_7921));
    }
    bus
}

/// Hosts that continue with any number of channels, whatever the plug-in has stated.
fn unannounced_layouts(bundle: &Path) -> Result<(), String> {
    for channels in [0usize, 1, 6, 8] {
        let mut raw = Raw::load(bundle)?;
        raw.start(44_100.0)?;
        let mut input = vec![vec![0.25f32; BLOCK]; channels];
        let mut output = vec![vec![f32::NAN; BLOCK]; channels];
        let pointers =
            |channels: &mut Vec<Vec<f32>>| channels.iter_mut().map(|channel| channel.as_mut_ptr()).collect::<Vec<_>>();
        let (mut in_pointers, mut out_pointers) = (pointers(&mut input), pointers(&mut output));
        let result = raw.process(
            &mut [bus(&mut in_pointers), bus(dangling(&mut [std::ptr::null_mut(); 8][..channels]))],
            &mut [bus(&mut out_pointers)],
        );
        ensure(result == kResultOk && output.iter().flatten().all(|sample| sample.is_finite()), || {
            format!("with {channels} channels it answers {result}, or leaves channels unwritten")
        })?;
    }
    Ok(())
}

fn arrangements_are_reported(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    let known = [SpeakerArr::kMono, SpeakerArr::kStereo, SpeakerArr::k50, SpeakerArr::k51];
    let other = [SpeakerArr::k40Cine, SpeakerArr::k70Cine, SpeakerArr::k71Music, 0b11 << 20, 0];
    let mut accepted = 0;
    for input in known.into_iter().chain(other) {
        for output in known.into_iter().chain(other) {
            for sidechain in [None, Some(input), Some(SpeakerArr::kStereo)] {
                let mut inputs = vec![input];
                inputs.extend(sidechain);
                if !raw.arrange(&mut inputs, output) {
                    continue;
                }
                accepted += 1;
                let reported: Vec<_> = (0..inputs.len()).map(|index| raw.arrangement(INPUT, index)).collect();
                let wanted: Vec<_> = inputs.iter().copied().map(Some).collect();
                ensure(reported == wanted && raw.arrangement(OUTPUT, 0) == Some(output), || {
                    format!("it accepts {inputs:?} in and {output} out, and reports {reported:?}")
                })?;
            }
        }
    }
    ensure(accepted >= 12, || format!("it accepts {accepted} arrangements only"))
}

fn odd_rates(bundle: &Path) -> Result<(), String> {
    for sample_rate in ODD_RATES_HZ {
        let mut raw = Raw::load(bundle)?;
        raw.start(sample_rate)?;
        let mut input: Vec<Vec<f32>> = (0..2).map(|of| (0..BLOCK).map(|n| (n + of) as f32 / 100.0).collect()).collect();
        let mut output = vec![vec![f32::NAN; BLOCK]; 2];
        let mut in_pointers: Vec<*mut f32> = input.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
        let mut out_pointers: Vec<*mut f32> = output.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
        raw.process(&mut [bus(&mut in_pointers), null_channels(0)], &mut [bus(&mut out_pointers)]);
        ensure(output == input, || format!("at {sample_rate} Hz the input does not pass through"))?;
        // SAFETY: a live processor.
        let latency = unsafe { raw.processor.getLatencySamples() };
        ensure(latency == 0, || format!("at {sample_rate} Hz it reports a latency of {latency} samples"))?;
    }
    Ok(())
}

fn indices_beyond(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    // SAFETY: a live instance, and writable locations whose fields are numbers.
    unsafe {
        let count = raw.controller.getParameterCount();
        let mut info: ParameterInfo = std::mem::zeroed();
        for index in [-1, count, count + 1, i32::MAX] {
            ensure(raw.controller.getParameterInfo(index, &mut info) != kResultOk, || format!("parameter {index}"))?;
        }
        for direction in [INPUT, OUTPUT] {
            let buses = raw.component.getBusCount(AUDIO, direction);
            for index in [-1, buses, i32::MAX] {
                ensure(raw.arrangement(direction, index as usize).is_none(), || format!("bus {index}"))?;
            }
        }
        let units: ComPtr<IUnitInfo> = raw.component.cast().ok_or("it has no units")?;
        let mut unit: UnitInfo = std::mem::zeroed();
        for index in [-1, units.getUnitCount(), i32::MAX] {
            ensure(units.getUnitInfo(index, &mut unit) != kResultOk, || format!("unit {index}"))?;
        }
    }
    Ok(())
}

fn moduleinfo(bundle: &Path) -> Result<(), String> {
    let path = bundle.join("Contents/Resources/moduleinfo.json");
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let said: serde_json::Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    let module = Module::load(bundle)?;
    let factory2: ComPtr<IPluginFactory2> = module.factory().cast().ok_or("it has no second factory")?;
    // SAFETY: a live factory, and writable locations whose fields are numbers.
    let (factory, class) = unsafe {
        let (mut factory, mut class): (PFactoryInfo, PClassInfo2) = (std::mem::zeroed(), std::mem::zeroed());
        module.factory().getFactoryInfo(&mut factory);
        factory2.getClassInfo2(0, &mut class);
        (factory, class)
    };
    let id: String = class.cid.iter().map(|byte| format!("{:02X}", *byte as u8)).collect();
    let (about, of) = (&said["Factory Info"], &said["Classes"][0]);
    let words: Vec<&str> = of["Sub Categories"].as_array().into_iter().flatten().filter_map(|w| w.as_str()).collect();
    let pairs = [
        (about["Vendor"].as_str(), from_c(&factory.vendor)),
        (about["URL"].as_str(), from_c(&factory.url)),
        (about["E-Mail"].as_str(), from_c(&factory.email)),
        (of["CID"].as_str(), id),
        (of["Category"].as_str(), from_c(&class.category)),
        (of["Name"].as_str(), from_c(&class.name)),
        (of["Vendor"].as_str(), from_c(&class.vendor)),
        (of["Version"].as_str(), from_c(&class.version)),
        (of["SDKVersion"].as_str(), from_c(&class.sdkVersion)),
        (Some(&*words.join("|")), from_c(&class.subCategories)),
    ];
    match pairs.iter().find(|(said, found)| *said != Some(found.as_str())) {
        Some((said, found)) => Err(format!("moduleinfo.json has {said:?}, the factory {found:?}")),
        None => ensure(of["Class Flags"] == class.classFlags, || "class flags differ".to_owned()),
    }
}

fn parameters_are_sound(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    let parameters = raw.parameters();
    let names: Vec<String> = parameters.iter().map(|info| from_utf16(&info.title)).collect();
    if let Some(name) = duplicate(&names) {
        return Err(format!("two parameters are called {name:?}"));
    }
    let has = |info: &ParameterInfo, flag: i32| info.flags & flag != 0;
    let bypasses = parameters.iter().filter(|info| has(info, ParameterFlags_::kIsBypass)).count();
    ensure(bypasses == 1, || format!("{bypasses} bypass parameters"))?;
    let of = |id| parameters.iter().find(|info| info.id == numeric_id(id)).ok_or(format!("there is no {id}"));
    for id in ["drive_mode", "flame_scene", "quality", "dynamic_range"] {
        ensure(has(of(id)?, ParameterFlags_::kIsList), || format!("{id} is not flagged as a list"))?;
    }
    for (id, unit) in [("output_level", "dB"), ("cutoff", "Hz"), ("vortex_speed", "m/s")] {
        let found = from_utf16(&of(id)?.units);
        ensure(found == unit, || format!("the unit of {id} is {found:?}"))?;
    }
    let units: ComPtr<IUnitInfo> = raw.component.cast().ok_or("it has no units")?;
    // SAFETY: a live object, and writable locations whose fields are numbers.
    let ids: Vec<i32> = unsafe {
        (0..units.getUnitCount())
            .map(|index| {
                let mut unit: UnitInfo = std::mem::zeroed();
                units.getUnitInfo(index, &mut unit);
                unit.id
            })
            .collect()
    };
    ensure(ids.contains(&kRootUnitId) && ids.len() > 5, || format!("units {ids:?}"))?;
    match parameters.iter().find(|info| !ids.contains(&info.unitId)) {
        Some(info) => Err(format!("{} belongs to no unit", from_utf16(&info.title))),
        None => Ok(()),
    }
}
