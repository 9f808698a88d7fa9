//! The host's own entries in the menu of a parameter: automation, links, and others.
//!
//! Hosts must be called on their main thread, both for the entries and for the user's choice; the window may have a
//! separate thread. So the window leaves an order and has the framework call [`HostMenu::work`] on the main thread.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// A line of a menu, in order of display.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Line {
    /// A menu entry.
    Entry {
        /// Its text.
        label: String,
        /// True if it can be chosen.
        is_enabled: bool,
        /// True if it is ticked.
        is_checked: bool,
        /// The host's number for it.
        action: i32,
    },
    /// A line across.
    Separator,
    /// Words above the lines that follow.
    Title(String),
    /// Start of a submenu.
    Begin(String),
    /// End of a submenu.
    End,
}

/// A host, as a format has it. Everything is called on the host's main thread.
pub trait Provider: Send {
    /// The host's lines for the parameter at an index of the table.
    fn lines(&mut self, index: usize) -> Vec<Line>;

    /// Performs the action of a chosen entry.
    fn perform(&mut self, index: usize, action: i32);
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Ask(usize),
    Perform(usize, i32),
}

/// Calls [`HostMenu::work`] on the main thread, sooner or later.
type Caller = Box<dyn Fn() + Send>;

/// The host's menu of one instance.
#[derive(Default)]
pub struct HostMenu {
    provider: Mutex<Option<Box<dyn Provider>>>,
    caller: Mutex<Option<Caller>>,
    orders: Mutex<Vec<Order>>,
    /// The host's last answer, and the parameter it is for.
    offered: Mutex<Option<(usize, Vec<Line>)>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl HostMenu {
    /// Sets or removes a host; on the main thread.
    pub fn set_provider(&self, provider: Option<Box<dyn Provider>>) {
        *lock(&self.offered) = None;
        *lock(&self.provider) = provider;
    }

    /// Sets the function that calls the main thread.
    pub fn set_caller(&self, caller: impl Fn() + Send + 'static) {
        *lock(&self.caller) = Some(Box::new(caller));
    }

    /// Requests the lines for the parameter at `index` of the table; none are available until the host has answered.
    pub fn ask(&self, index: usize) {
        *lock(&self.offered) = None;
        self.order(Order::Ask(index));
    }

    /// The host's lines for a parameter, once it has answered.
    pub fn offered(&self, index: usize) -> Vec<Line> {
        lock(&self.offered).as_ref().filter(|(of, _)| *of == index).map(|(_, lines)| lines.clone()).unwrap_or_default()
    }

    /// Has the host perform the action of a chosen entry.
    pub fn perform(&self, index: usize, action: i32) {
        self.order(Order::Perform(index, action));
    }

    fn order(&self, order: Order) {
        lock(&self.orders).push(order);
        if let Some(call) = lock(&self.caller).as_ref() {
            call();
        }
    }

    /// Carries out pending orders; on the main thread. Returns true if there are new lines to show.
    pub fn work(&self) -> bool {
        let orders = std::mem::take(&mut *lock(&self.orders));
        let mut provider = lock(&self.provider);
        let Some(provider) = provider.as_mut() else { return false };
        let mut is_new = false;
        for order in orders {
            match order {
                Order::Ask(index) => {
                    let lines = provider.lines(index);
                    *lock(&self.offered) = Some((index, lines));
                    is_new = true;
                }
                Order::Perform(index, action) => provider.perform(index, action),
            }
        }
        is_new
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    struct Host(Arc<Mutex<Vec<(usize, i32)>>>);

    impl Provider for Host {
        fn lines(&mut self, index: usize) -> Vec<Line> {
            vec![Line::Title(format!("parameter {index}")), Line::Separator]
        }

        fn perform(&mut self, index: usize, action: i32) {
            lock(&self.0).push((index, action));
        }
    }

    #[test]
    fn orders_are_carried_out_by_whoever_calls_work() {
        let (menu, calls, done) = (HostMenu::default(), Arc::new(AtomicUsize::new(0)), Arc::default());
        menu.ask(1);
        assert!(!menu.work(), "there is no host");
        let counted = calls.clone();
        menu.set_caller(move || {
            counted.fetch_add(1, Ordering::Relaxed);
        });
        menu.set_provider(Some(Box::new(Host(Arc::clone(&done)))));
        menu.ask(3);
        menu.perform(3, 7);
        assert_eq!((calls.load(Ordering::Relaxed), menu.offered(3).len()), (2, 0), "nothing was done yet");
        assert!(menu.work() && !menu.work());
        assert_eq!(menu.offered(3), [Line::Title("parameter 3".to_owned()), Line::Separator]);
        assert_eq!((menu.offered(4).len(), lock(&done).clone()), (0, vec![(3, 7)]));
        menu.set_provider(None);
        assert!(menu.offered(3).is_empty());
    }
}
