//! Periplus: an operator console for robots that map a room by touch.
pub mod console;
pub mod geometry;
pub mod mapping;
pub mod robot;
pub mod session;
