//! The settings' table as host parameters.
//!
//! Ids, ranges, defaults and texts are the table's. The host's values are 32-bit floats; they are rounded to the
//! table's grid where they are read, so the engines get exactly the numbers in a preset.

use std::collections::BTreeMap;
use std::sync::Arc;

use nice_plug::prelude::*;
use nice_plug_core::params::InternalParamMut;
use nice_plug_core::plugin::ParamValue;
use pyrophone_settings::{PARAMETERS, Parameter, ParameterKind, Values, host_order, index_of, session};

use crate::controllers::Controllers;
use crate::entry::indication::Indications;
use crate::host_menu::HostMenu;
use crate::persist::SessionStore;
use crate::takes::Takes;
use crate::window_size::WindowSize;

/// One host parameter.
pub enum Slot {
    /// A continuous value.
    Float(FloatParam),
    /// A whole number, or the index of a choice.
    Int(IntParam),
    /// Off or on.
    Toggle(BoolParam),
}

/// All host parameters, in the table's order, and the rest of the state.
pub struct EffectParams {
    /// Boxed, because hosts' wrappers keep pointers to the parameters.
    slots: Box<[Slot]>,
    /// The recording and the learned distribution.
    pub session: Arc<SessionStore>,
    /// The window's size.
    pub window: Arc<WindowSize>,
    /// The takes that were tried.
    pub takes: Takes,
    /// MIDI controllers assigned to them.
    pub controllers: Controllers,
    /// The host's own entries in their menus.
    pub host_menu: HostMenu,
    /// Their state as reported by the host.
    pub indications: Indications,
}

/// Keys of the window's size, of the takes and of the MIDI controllers in the state.
const WINDOW: &str = "window";
const TAKES: &str = "takes";
const CONTROLLERS: &str = "controllers";

impl EffectParams {
    /// Parameters at their defaults.
    pub fn new(session: Arc<SessionStore>) -> Self {
        Self {
            slots: PARAMETERS.iter().map(Slot::new).collect(),
            session,
            window: Arc::default(),
            takes: Takes::default(),
            controllers: Controllers::default(),
            host_menu: HostMenu::default(),
            indications: Indications::default(),
        }
    }

    /// The present values, rounded to the table's grid; real-time safe.
    pub fn values(&self) -> Values {
        let mut values = Values::default();
        for (index, slot) in self.slots.iter().enumerate() {
            values.set_nearest(index, slot.plain());
        }
        values
    }

    /// The present value of one parameter, as in [`values`](Self::values).
    pub fn value(&self, index: usize) -> f64 {
        PARAMETERS[index].snap(self.slots[index].plain())
    }

    /// The host parameter at an index of the table.
    pub fn slot(&self, index: usize) -> &Slot {
        &self.slots[index]
    }
}

impl Slot {
    fn new(parameter: &'static Parameter) -> Self {
        let text = move |plain: f64| parameter.to_text(plain);
        let parse = move |text: &str| parameter.parse(text).ok();
        match parameter.kind {
            ParameterKind::Float { low, high, default, skew, decimals, .. } => {
                let (min, max) = (low as f32, high as f32);
                let range = if skew == 1.0 {
                    FloatRange::Linear { min, max }
                } else {
                    FloatRange::Skewed { min, max, factor: skew as f32 }
                };
                let float = FloatParam::new(parameter.name, default as f32, range)
                    .with_step_size(maths::powi(10.0, -(decimals as i32)) as f32)
                    .with_value_to_string(Arc::new(move |plain| text(f64::from(plain))))
                    .with_string_to_value(Arc::new(move |text| parse(text).map(|plain| plain as f32)));
                Self::Float(if parameter.automatable { float } else { float.non_automatable() })
            }
            ParameterKind::Int { .. } | ParameterKind::Choice { .. } => {
                let range = IntRange::Linear { min: parameter.low() as i32, max: parameter.high() as i32 };
                let int = IntParam::new(parameter.name, parameter.default_value() as i32, range)
                    .with_value_to_string(Arc::new(move |plain| text(f64::from(plain))))
                    .with_string_to_value(Arc::new(move |text| parse(text).map(|plain| plain as i32)));
                Self::Int(if parameter.automatable { int } else { int.non_automatable() })
            }
            ParameterKind::Toggle { default } => {
                let toggle = BoolParam::new(parameter.name, default)
                    .with_value_to_string(Arc::new(move |on| text(f64::from(u8::from(on)))))
                    .with_string_to_value(Arc::new(move |text| parse(text).map(|plain| plain > 0.5)));
                Self::Toggle(if parameter.id == "bypass" { toggle.make_bypass() } else { toggle })
            }
        }
    }

    /// The host's current plain value; not yet on the table's grid.
    pub fn plain(&self) -> f64 {
        match self {
            Self::Float(float) => f64::from(float.value()),
            Self::Int(int) => f64::from(int.value()),
            Self::Toggle(toggle) => f64::from(u8::from(toggle.value())),
        }
    }

    /// Tells the host that the user begins a gesture on the parameter.
    pub fn begin(&self, setter: &ParamSetter) {
        match self {
            Self::Float(float) => setter.begin_set_parameter(float),
            Self::Int(int) => setter.begin_set_parameter(int),
            Self::Toggle(toggle) => setter.begin_set_parameter(toggle),
        }
    }

    /// Sets the plain value through the host; between [`begin`](Self::begin) and [`end`](Self::end).
    pub fn set(&self, setter: &ParamSetter, plain: f64) {
        match self {
            Self::Float(float) => setter.set_parameter(float, plain as f32),
            Self::Int(int) => setter.set_parameter(int, plain as i32),
            Self::Toggle(toggle) => setter.set_parameter(toggle, plain > 0.5),
        }
    }

    /// Tells the host that the user ends the gesture.
    pub fn end(&self, setter: &ParamSetter) {
        match self {
            Self::Float(float) => setter.end_set_parameter(float),
            Self::Int(int) => setter.end_set_parameter(int),
            Self::Toggle(toggle) => setter.end_set_parameter(toggle),
        }
    }

    /// Sets the plain value when the host itself has requested that and reads it again.
    pub fn set_without_host(&self, plain: f64) {
        // SAFETY: hosts' values are set like this by the framework; they are atomic.
        unsafe {
            match self {
                Self::Float(float) => float._internal_set_plain_value(plain as f32),
                Self::Int(int) => int._internal_set_plain_value(plain as i32),
                Self::Toggle(toggle) => toggle._internal_set_plain_value(plain > 0.5),
            };
        }
    }

    fn pointer(&self) -> ParamPtr {
        match self {
            Self::Float(float) => float.as_ptr(),
            Self::Int(int) => int.as_ptr(),
            Self::Toggle(toggle) => toggle.as_ptr(),
        }
    }
}

// SAFETY: the pointers are to elements of a boxed slice that is never replaced, so they are valid for as long as this
// object is; wrappers hold it in an `Arc`.
unsafe impl Params for EffectParams {
    fn param_map(&self) -> Vec<(String, ParamPtr, String)> {
        // The table's order is that of history; hosts show this one.
        let line = |index: usize| {
            let parameter = &PARAMETERS[index];
            (parameter.id.to_owned(), self.slots[index].pointer(), parameter.group.name().to_owned())
        };
        host_order().into_iter().map(line).collect()
    }

    fn serialize_fields(&self) -> BTreeMap<String, String> {
        BTreeMap::from([
            (session::FIELD.to_owned(), self.session.field().to_string()),
            (WINDOW.to_owned(), self.window.to_json()),
            (TAKES.to_owned(), self.takes.to_json()),
            (CONTROLLERS.to_owned(), self.controllers.to_json()),
        ])
    }

    fn deserialize_fields(&self, serialized: &BTreeMap<String, String>) {
        if let Some(field) = serialized.get(session::FIELD) {
            self.session.arrive(field.as_str().into());
        }
        if let Some(size) = serialized.get(WINDOW) {
            self.window.read_json(size);
        }
        if let Some(takes) = serialized.get(TAKES) {
            self.takes.read_json(takes);
        }
        // A state without them, from an earlier version or a preset, leaves them unchanged.
        if let Some(controllers) = serialized.get(CONTROLLERS) {
            self.controllers.read_json(controllers);
        }
    }
}

/// Clamps a state's values to their ranges, drops those that belong to no parameter or are of the wrong kind, and adds
/// those of parameters introduced later; wrappers apply the result without a check.
pub fn sanitize(state: &mut PluginState) {
    state.params.retain(|id, value| {
        let Ok(index) = index_of(id) else { return false };
        let parameter = &PARAMETERS[index];
        match (parameter.kind, value) {
            (ParameterKind::Float { .. }, ParamValue::F32(plain)) => *plain = parameter.snap(f64::from(*plain)) as f32,
            (ParameterKind::Int { .. } | ParameterKind::Choice { .. }, ParamValue::I32(plain)) => {
                *plain = parameter.snap(f64::from(*plain)) as i32;
            }
            (ParameterKind::Toggle { .. }, ParamValue::Bool(_)) => {}
            _ => return false,
        }
        true
    });
    for (id, plain) in session::EARLIER {
        let Ok(index) = index_of(id) else { continue };
        let value = match PARAMETERS[index].kind {
            ParameterKind::Float { .. } => ParamValue::F32(*plain as f32),
            ParameterKind::Int { .. } | ParameterKind::Choice { .. } => ParamValue::I32(*plain as i32),
            ParameterKind::Toggle { .. } => ParamValue::Bool(*plain > 0.5),
        };
        state.params.entry((*id).to_owned()).or_insert(value);
    }
}
