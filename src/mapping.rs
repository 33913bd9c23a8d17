//! The mapping core.
pub mod map;
pub mod settings;
