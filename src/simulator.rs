//! The simulated room and the simulated robot body in it.
//!
//! Owns the truth: walls, objects and where the body really is. The mapping core never sees any of
//! it; all it gets is what [`body::Body`] would report through the firmware.

pub mod body;
pub mod noise;
pub mod reach;
pub mod world;

pub use body::Body;
pub use noise::NoiseProfile;
pub use world::{World, WorldError};
