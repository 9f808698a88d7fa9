//! The host's own entries in the menu of a parameter: automation, links, whatever the host has.
//!
//! Hosts are asked for them, and told what was chosen, on their main thread; the window has a thread of its own where
//! the system lets it. So the window leaves an order and has the framework call [`HostMenu::work`] on the main thread.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// A line of a menu, in the order in which they are shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Line {
    /// Something to choose.
    Entry {
        /// Its words.
        label: String,
        /// Whether it can be chosen.
        is_enabled: bool,
        /// Whether it is ticked.
        is_checked: bool,
        /// The number by which the host knows it.
        action: i32,
    },
    /// A line across.
    Separator,
    /// Words above the lines that follow.
    Title(String),
    /// A menu within the menu begins.
    Begin(String),
    /// It ends.
    End,
}

/// A host, as a format has it. Everything is called on the host's main thread.
pub trait Provider: Send {
    /// What the host offers for the parameter at a place of the table.
    fn lines(&mut self, index: usize) -> Vec<Line>;

    /// Does what was chosen of it.
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
    /// What the host has offered last, and for which parameter.
    offered: Mutex<Option<(usize, Vec<Line>)>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl HostMenu {
    /// Takes a host, or takes it away; on the main thread.
    pub fn set_provider(&self, provider: Option<Box<dyn Provider>>) {
        *lock(&self.offered) = None;
        *lock(&self.provider) = provider;
    }

    /// Takes the way to the main thread.
    pub fn set_caller(&self, caller: impl Fn() + Send + 'static) {
        *lock(&self.caller) = Some(Box::new(caller));
    }

    /// Has the host asked what it offers for the parameter at `index` of the table; nothing until it has answered.
    pub fn ask(&self, index: usize) {
        *lock(&self.offered) = None;
        self.order(Order::Ask(index));
    }

    /// What the host offers for a parameter, once it has answered.
    pub fn offered(&self, index: usize) -> Vec<Line> {
        lock(&self.offered).as_ref().filter(|(of, _)| *of == index).map(|(_, lines)| lines.clone()).unwrap_or_default()
    }

    /// Has the host do what was chosen of it.
    pub fn perform(&self, index: usize, action: i32) {
        self.order(Order::Perform(index, action));
    }

    fn order(&self, order: Order) {
        lock(&self.orders).push(order);
        if let Some(call) = lock(&self.caller).as_ref() {
            call();
        }
    }

    /// Does what was ordered; on the main thread. Whether something is to be shown that was not.
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
