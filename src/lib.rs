//! Periplus: an operator console for robots that map a room by touch.
pub mod firmware;
pub mod geometry;
pub mod link;
pub mod mapping;
pub mod robot;
pub mod session;
pub mod simulator;
