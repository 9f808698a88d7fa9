#![doc = include_str!("../README.md")]

pub mod build;
pub mod key;
pub mod store;

pub use build::{Error, Stage, build};
pub use key::DictionaryKey;
pub use store::Store;
