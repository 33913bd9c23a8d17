//! The mapping core.
pub mod event;
pub mod map;
pub mod settings;
pub mod shape;
