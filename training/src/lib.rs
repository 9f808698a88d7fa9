//! From a recording to the dictionary that texture learns from: the one way that plugin and command line take.
//!
//! | module | is |
//! |---|---|
//! | [`key`] | what a dictionary is made of |
//! | [`mod@build`] | part of the recording, level, sample rate, dictionary |
//! | [`store`] | dictionaries on disk, from one session to the next |

pub mod build;
pub mod key;
pub mod store;

pub use build::{Error, Stage, build};
pub use key::DictionaryKey;
pub use store::Store;
