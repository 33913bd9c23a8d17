//! The mapping core.
pub mod event;
pub mod floor;
pub mod map;
pub mod settings;
