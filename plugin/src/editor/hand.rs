//! What the user does to parameters: every change goes through the host as a gesture, and can be undone.

use std::collections::VecDeque;

use nice_plug::prelude::ParamSetter;
use pyrophone_settings::{COUNT, Id, Values};

use crate::entry::indication::Automation;
use crate::parameters::EffectParams;

/// Steps that can be undone.
const STEPS: usize = 200;

/// What was changed in this window, and the settings that are kept beside those that sound.
#[derive(Debug, Default)]
pub struct History {
    past: VecDeque<Values>,
    future: Vec<Values>,
    /// Before the gesture under way, and what it has made so far.
    gesture: Option<(Values, Values)>,
    /// A and B; the one that sounds is in the parameters.
    beside: Option<Values>,
    is_b: bool,
}

impl History {
    /// Whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is something to do again.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Whether B sounds.
    pub fn is_b(&self) -> bool {
        self.is_b
    }

    fn record(&mut self, before: Values) {
        self.past.push_back(before);
        if self.past.len() > STEPS {
            self.past.pop_front();
        }
        self.future.clear();
    }
}

/// A hand on the parameters.
pub struct Hand<'a> {
    /// The parameters.
    pub params: &'a EffectParams,
    /// The way to the host.
    pub setter: &'a ParamSetter<'a>,
    /// What was done.
    pub history: &'a mut History,
}

impl Hand<'_> {
    /// The present values, with what the gesture under way has changed: hosts take their time.
    pub fn values(&self) -> Values {
        self.history.gesture.map_or_else(|| self.params.values(), |(_, now)| now)
    }

    /// What the host says about a parameter: whether a controller is mapped to it, and how it is automated.
    pub fn indication(&self, index: usize) -> (bool, Automation) {
        let indications = &self.params.indications;
        (indications.is_mapped(index), indications.automation(index))
    }

    /// The present value of one parameter.
    pub fn value(&self, index: usize) -> f64 {
        self.history.gesture.as_ref().map_or_else(|| self.params.value(index), |(_, now)| now.as_slice()[index])
    }

    /// The present value of one parameter, by its id.
    pub fn get(&self, id: Id) -> f64 {
        self.value(id as usize)
    }

    /// Takes hold of a parameter.
    pub fn begin(&mut self, index: usize) {
        if self.history.gesture.is_none() {
            let values = self.params.values();
            self.history.gesture = Some((values, values));
        }
        self.params.slot(index).begin(self.setter);
    }

    /// Moves a parameter that is held.
    pub fn set(&mut self, index: usize, plain: f64) {
        if let Some((_, now)) = &mut self.history.gesture {
            now.set_nearest(index, plain);
        }
        self.params.slot(index).set(self.setter, plain);
    }

    /// Lets go of a parameter.
    pub fn end(&mut self, index: usize) {
        self.params.slot(index).end(self.setter);
        if let Some((before, now)) = self.history.gesture.take()
            && before != now
        {
            self.history.record(before);
        }
    }

    /// Sets a parameter in one gesture.
    pub fn set_once(&mut self, index: usize, plain: f64) {
        self.begin(index);
        self.set(index, plain);
        self.end(index);
    }

    /// Sets all parameters, as one step.
    pub fn set_all(&mut self, next: &Values) {
        let before = self.params.values();
        if before != *next {
            self.send(&before, next);
            self.history.record(before);
        }
    }

    /// Takes the last step back.
    pub fn undo(&mut self) {
        if let Some(earlier) = self.history.past.pop_back() {
            let now = self.params.values();
            self.send(&now, &earlier);
            self.history.future.push(now);
        }
    }

    /// Does again what was undone last.
    pub fn redo(&mut self) {
        if let Some(later) = self.history.future.pop() {
            let now = self.params.values();
            self.send(&now, &later);
            self.history.past.push_back(now);
        }
    }

    /// Exchanges A and B; at first they are equal.
    pub fn exchange(&mut self) {
        let now = self.params.values();
        let other = self.history.beside.replace(now).unwrap_or(now);
        self.history.is_b = !self.history.is_b;
        self.set_all(&other);
    }

    /// Makes the settings that do not sound equal to those that do.
    pub fn copy(&mut self) {
        self.history.beside = Some(self.params.values());
    }

    fn send(&self, before: &Values, next: &Values) {
        for index in 0..COUNT {
            let (old, new) = (before.as_slice()[index], next.as_slice()[index]);
            if old != new {
                let slot = self.params.slot(index);
                slot.begin(self.setter);
                slot.set(self.setter, new);
                slot.end(self.setter);
            }
        }
    }
}
